/* stage/record/overdub.h - somebody performs over a take that plays, and it becomes a part of the
 * take: as a layer of its own, or in place of what a layer showed between two instants (punch-in),
 * once or again and again (a loop: each pass another layer, of which the last whole one is heard).
 * Everything that is performed is recorded as takes of its own too, whatever becomes of it. The raw
 * material never changes: what is made here is edits. Leaves out the clock's thread: it is a stage
 * for player.h, which may run live or on a virtual clock. [main] but what player.h calls [frame].
 */
#ifndef MAROTTE_STAGE_OVERDUB_H
#define MAROTTE_STAGE_OVERDUB_H
#include "stage/perform/player.h"
#include "stage/record/recorder.h"
#include "stage/playback/sequencer.h"
#include "stage/playback/transport.h"
#include "show/edit_store.h"

/* ---- what happens to the take: count-in, pre-roll, passes; which of what is performed counts, and
 * the edits that make it a part of the take. The one way for whoever performs over a take: overdub,
 * and live.h. [frame] no allocation, but recorder's takes; edits [main] ---- */

enum { OVERDUB_PASSES_MAX = 99 };

typedef struct overdub_plan {
    char name[TAKE_NAME];   /* of the layer; "": of the mapping */
    char (*own)[TAKE_NAME]; /* the caller's: what the layer moves; own_count 0: everything */
    uint32_t own_count;
    uint32_t into_layer;   /* punch: its id; 0: a new layer */
    int64_t in_ns, out_ns; /* of the timeline; out 0: until it is ended */
    int64_t fade_ns;       /* at both ends; as much as fits of what was ended early */
    int64_t count_in_ns;   /* the take stands still at its start for that long */
    int64_t preroll_ns;    /* it plays so much before `in` */
    uint32_t passes;       /* 1; more: in..out is played again and again, a layer each; the last
                              that was performed to its end is heard, the others are muted */
    double speed;          /* of the timeline, 0.1..4; 1 */
} overdub_plan;

typedef struct overdub_pass { /* what was performed in one */
    int64_t performance, raw_take;
    int64_t from_ns;           /* show time: the performance's start */
    int64_t first_ns, last_ns; /* show time: of its samples within in..out */
    int64_t start_ns, end_ns;  /* of the timeline: the same */
    uint64_t sample_count;
} overdub_pass;

typedef struct overdub_run {
    overdub_plan plan;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    int64_t take; /* that is performed over */
    transport transport;
    bool has_begun, is_over;
    int64_t rolling_ns; /* clock: when the count-in ends */
    int64_t played_ns;  /* clock: as far as it has come */
    int64_t start_ns;   /* of the timeline: in, less the pre-roll */
    int64_t duration_ns, at_ns;
    uint32_t pass_now;
    int64_t performance_from_ns; /* show time of the first sample */
    overdub_pass pass[OVERDUB_PASSES_MAX];
} overdub_run;

CHECKED mrt_result overdub_plan_check(const overdub_plan *plan, const take *t, error *err);
/* What the layer that is performed owns of a face, as for sequencer_set_live: what the layer that
 * is punched does, or as the plan says. *out: to be freed, also after an error. Refuses a layer
 * that would move nothing. */
CHECKED mrt_result overdub_plan_own(const overdub_plan *plan, const take *t, const composer *shown,
                                    uint8_t **out, bool *out_is_additive, error *err);
void overdub_run_init(overdub_run *out, const overdub_plan *plan, const take *t);

/* The take as it is at a time of the clock, at_ns; a time before one that was played to counts as
 * that: what was shown does not go back for samples that come late. What was performed in a pass
 * that ends is a take by itself; the next pass is another. < 0: what could not be recorded. */
CHECKED mrt_result overdub_run_play_to(overdub_run *self, sequencer *of, recorder *into,
                                       int64_t clock_ns, error *err);
/* From frame.record, after recorder_step: the take is brought to the instant of the step, which
 * will be performed over it. MRT_END: the step came behind the end, and is not performed. */
CHECKED mrt_result overdub_run_step(overdub_run *self, sequencer *of, recorder *into,
                                    stage_frame *f, error *err);
/* It ends here. */
CHECKED mrt_result overdub_run_end(overdub_run *self, recorder *into, error *err);
/* A take for the pass that comes. */
void overdub_run_slate(const overdub_run *self, recorder *into);
bool overdub_run_is_recording(const overdub_run *self);
uint32_t overdub_run_pass(const overdub_run *self);

typedef struct overdub_made {
    uint32_t layer_count;   /* made or punched */
    uint32_t last_layer;    /* that is heard: its id */
    int64_t raw_take;       /* of the pass that is heard, by itself */
    int64_t from_ns, to_ns; /* of the timeline */
    uint32_t edit_count;    /* of the take's list: so many steps of undo take all of it back */
} overdub_made;
/* The edits that make of the take what was performed: *out is out_made->edit_count of them, each to
 * be finished, and to be freed. name: of the layer when the plan has none. */
CHECKED mrt_result overdub_run_edits(const overdub_run *self, const take *before, const char *name,
                                     edit **out, overdub_made *out_made, error *err);

/* ---- without a window ---- */

typedef struct overdub overdub;

typedef struct overdub_settings {
    /* Who performs, on which face, into which show; layer, performer and state_bytes are not said
     * here. */
    recorder_settings recorder;
    double side_length_mm[2];
    int64_t take;
    overdub_plan plan; /* what is made of it */
} overdub_settings;

/* The face rests on the instant at which it will start. */
CHECKED mrt_result overdub_create(overdub **out, const overdub_settings *settings, error *err);
void overdub_destroy(overdub *self); /* NULL is fine; what was recorded stays */

/* For player_run_stage. It ends by itself at the end of the last pass. */
stage_frame *overdub_frame(overdub *self);
performer *overdub_performer(overdub *self); /* whose face tests look at */
recorder *overdub_recorder(overdub *self);
/* Where the timeline is now, and whether what is performed is kept. */
int64_t overdub_at_ns(const overdub *self);
bool overdub_is_recording(const overdub *self);
/* What the timeline does, by the inputs' clock; NULL: it has not begun. */
const transport *overdub_transport(const overdub *self);
/* As sequencer_check, of the take that plays. */
CHECKED mrt_result overdub_check(const overdub *self, error *err);
const take *overdub_take(const overdub *self); /* that is performed over, as it was before */

/* After the player: what was performed becomes a part of the take. */
CHECKED mrt_result overdub_finish(overdub *self, overdub_made *out, error *err);

#endif
