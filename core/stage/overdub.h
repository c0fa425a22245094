/* stage/overdub.h - somebody performs over a take that plays, and it becomes a part of the take:
 * as a layer of its own, or in place of what a layer showed between two instants (punch-in), once
 * or again and again (a loop: each pass another layer, of which the last whole one is heard).
 * Everything that is performed is recorded as takes of its own too, whatever becomes of it. The raw
 * material never changes: what is made here is edits. Leaves out the clock's thread: it is a stage
 * for player.h, which may run live or on a virtual clock. [main] but what player.h calls [frame].
 */
#ifndef MAROTTE_STAGE_OVERDUB_H
#define MAROTTE_STAGE_OVERDUB_H
#include "stage/player.h"
#include "stage/recorder.h"
#include "stage/sequencer.h"
#include "stage/transport.h"
#include "take/edit_store.h"

typedef struct overdub overdub;

typedef struct overdub_settings {
    show *show; /* writable */
    const plugin_list *plugins;
    log_queue *log;
    int64_t take;
    const face_file *face;
    const char *face_path;
    double unit_mm;
    instance_clock clock;
    /* who performs */
    input *const *inputs;
    const char *const *input_text;
    uint32_t input_count;
    const char *calibration[2];
    instance *mapping;
    double hand_length_mm, side_length_mm[2];
    uint32_t rezero_pedal;
    /* what is made of it */
    char name[TAKE_NAME];   /* of the layer; "": of the mapping */
    char (*own)[TAKE_NAME]; /* what the layer moves; own_count 0: everything */
    uint32_t own_count;
    uint32_t into_layer;   /* punch: its id; 0: a new layer */
    int64_t in_ns, out_ns; /* of the timeline; out 0: until it is ended */
    int64_t fade_ns;       /* at both ends; as much as fits of what was ended early */
    int64_t count_in_ns;   /* the take stands still at its start for that long */
    int64_t preroll_ns;    /* it plays so much before `in` */
    uint32_t passes;       /* 1; more: in..out is played again and again, a layer each; the last
                              that was performed to its end is heard, the others are muted */
    double speed;          /* of the timeline, 0.1..4; 1 */
} overdub_settings;

/* The face rests on the instant at which it will start. */
CHECKED mrt_result overdub_create(overdub **out, const overdub_settings *settings, error *err);
void overdub_destroy(overdub *self); /* NULL is fine; what was recorded stays */

/* For player_run. It ends by itself at the end of the last pass. */
player_stage overdub_stage(overdub *self);
composer *overdub_composer(overdub *self);
recorder *overdub_recorder(overdub *self);
/* Where the timeline is now, and whether what is performed is kept. */
int64_t overdub_at_ns(const overdub *self);
bool overdub_is_recording(const overdub *self);
/* What the timeline does, by the inputs' clock; NULL: it has not begun. */
const transport *overdub_transport(const overdub *self);
/* As sequencer_check, of the take that plays. */
CHECKED mrt_result overdub_check(const overdub *self, error *err);
const take *overdub_take(const overdub *self); /* that is performed over, as it was before */

typedef struct overdub_result {
    uint32_t layer_count;   /* made or punched */
    uint32_t last_layer;    /* that is heard: its id */
    uint32_t edit_count;    /* of the take's list: so many steps of undo take all of it back */
    int64_t raw_take;       /* of the pass that is heard, by itself */
    int64_t from_ns, to_ns; /* of the timeline */
} overdub_result;
/* After the player: what was performed becomes a part of the take. */
CHECKED mrt_result overdub_finish(overdub *self, overdub_result *out, error *err);

#endif
