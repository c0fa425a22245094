/* stage/record/overdub.h - overdub: the puppeteer performs over a take that plays, and the
 * performance becomes part of the take. It becomes a new layer, or it replaces one span of a layer
 * (punch-in). In a loop each pass becomes a layer, and only the last complete one stays unmuted.
 * Every pass is also recorded as a separate take, whatever happens to the edits. Recorded data
 * never changes: an overdub only adds edits. Leaves out the thread of the clock: the overdub is a
 * stage for player.h, which runs live or with a virtual clock. [main] except for the functions that
 * player.h calls [frame]. */
#ifndef MAROTTE_STAGE_OVERDUB_H
#define MAROTTE_STAGE_OVERDUB_H
#include "stage/perform/player.h"
#include "stage/record/recorder.h"
#include "stage/playback/sequencer.h"
#include "stage/playback/transport.h"
#include "show/edit_store.h"

/* ---- one run: count-in, pre-roll, passes, and the edits that add the result to the take. Used by
 * struct overdub (below) and by live.h. [frame] without allocation except for the recorder's takes;
 * edits on [main] ---- */

enum { OVERDUB_PASSES_MAX = 99 };

typedef struct overdub_plan {
    char name[TAKE_NAME];   /* of the layer; "": the name of the mapping */
    char (*own)[TAKE_NAME]; /* borrowed: names that the layer owns; own_count 0: everything */
    uint32_t own_count;
    uint32_t into_layer;   /* punch-in: id of the layer; 0: a new layer */
    int64_t in_ns, out_ns; /* on the timeline; out 0: until overdub_run_end */
    int64_t fade_ns;       /* at both ends; shortened for a pass that was ended early */
    int64_t count_in_ns;   /* the take stays at its start for this time */
    int64_t preroll_ns;    /* playback before `in` */
    uint32_t passes; /* 1; more: in..out repeats and each pass becomes a layer. All but the last
                        complete pass are muted. */
    double speed;    /* of the timeline, 0.1..4; default 1 */
} overdub_plan;

typedef struct overdub_pass { /* samples of one pass */
    int64_t performance, raw_take;
    int64_t from_ns;           /* show time: start of the performance */
    int64_t first_ns, last_ns; /* show time: first and last sample within in..out */
    int64_t start_ns, end_ns;  /* on the timeline: of these two samples */
    uint64_t sample_count;
    bool has_own[TAKE_OWN_PARTS]; /* samples of these parts (take_own_part_of) */
    bool has_others;              /* samples of other inputs than the pointer */
} overdub_pass;

typedef enum overdub_state {
    OVERDUB_WAITS = 0, /* for the first step or drawn frame */
    OVERDUB_RUNS,      /* counts in, plays, records */
    OVERDUB_OVER
} overdub_state;

typedef struct overdub_run {
    overdub_plan plan;
    char scene[TAKE_NAME], shot[TAKE_NAME];
    int64_t take; /* take that is overdubbed */
    transport transport;
    overdub_state state;
    int64_t rolling_ns; /* clock: end of the count-in */
    int64_t played_ns;  /* clock: latest time that was played to */
    int64_t start_ns;   /* on the timeline: in minus the pre-roll */
    int64_t duration_ns, at_ns;
    uint32_t pass_now;
    int64_t performance_from_ns; /* show time of the first sample */
    overdub_pass pass[OVERDUB_PASSES_MAX];
} overdub_run;

CHECKED mrt_result overdub_plan_check(const overdub_plan *plan, const take *t, error *err);
/* Marks the contacts and degrees of freedom that the new layer owns, as for sequencer_set_live:
 * those of the punched layer, or those of the plan. The caller frees *out, also after an error.
 * Refuses a layer that would move nothing. */
CHECKED mrt_result overdub_plan_own(const overdub_plan *plan, const take *t, const composer *shown,
                                    uint8_t **out, bool *out_is_additive, error *err);
void overdub_run_init(overdub_run *out, const overdub_plan *plan, const take *t);

/* Plays the take to a time of the clock and sets at_ns. An earlier time than the last one counts as
 * the last one, because playback never moves back for late samples. At the end of a pass its
 * recording ends, and the next pass is recorded as another take. Returns < 0 if the recorder
 * failed. */
CHECKED mrt_result overdub_run_play_to(overdub_run *self, sequencer *of, recorder *into,
                                       int64_t clock_ns, error *err);
/* From stage_frame.record, after recorder_step: plays the take to the instant of the step, and lets
 * its performer perform the step. MRT_END: the step came after the end and is not performed. */
CHECKED mrt_result overdub_run_step(overdub_run *self, sequencer *of, recorder *into,
                                    stage_frame *f, error *err);
/* Ends the overdub at the current position. */
CHECKED mrt_result overdub_run_end(overdub_run *self, recorder *into, error *err);
/* Sets the slate of the next pass in the recorder. */
void overdub_run_slate(const overdub_run *self, recorder *into);
bool overdub_run_is_recording(const overdub_run *self);
uint32_t overdub_run_pass(const overdub_run *self);

typedef struct overdub_made {
    uint32_t layer_count;   /* created or punched */
    uint32_t last_layer;    /* id of the unmuted layer */
    int64_t raw_take;       /* separate take of the unmuted pass */
    int64_t from_ns, to_ns; /* on the timeline */
    uint32_t edit_count;    /* number of edits, which is also the number of undo steps */
} overdub_made;
/* Returns the edits that add the overdub to the take. *out has out_made->edit_count edits. The
 * caller finishes each and frees the array. `name` is used for the layer if the plan has no
 * name. */
CHECKED mrt_result overdub_run_edits(const overdub_run *self, const take *before, const char *name,
                                     edit **out, overdub_made *out_made, error *err);

/* ---- overdub without a window ---- */

typedef struct overdub overdub;

typedef struct overdub_settings {
    /* mapping, face, show and inputs; the members layer, performer and state_bytes are ignored */
    recorder_settings recorder;
    double side_length_mm[2];
    int64_t take;
    overdub_plan plan; /* span, passes and target layer of the overdub */
} overdub_settings;

/* The face shows the first instant of the overdub. */
CHECKED mrt_result overdub_create(overdub **out, const overdub_settings *settings, error *err);
void overdub_destroy(overdub *self); /* accepts NULL; recordings stay in the show */

/* The frame for player_run_stage. The performance ends after the last pass. */
stage_frame *overdub_frame(overdub *self);
performer *overdub_performer(overdub *self); /* for tests */
recorder *overdub_recorder(overdub *self);
/* Position on the timeline, and whether the performance is recorded into a layer now. */
int64_t overdub_at_ns(const overdub *self);
bool overdub_is_recording(const overdub *self);
/* Returns the motion of the timeline, in the clock of the inputs. NULL before it begins and after
 * it ends. */
const transport *overdub_transport(const overdub *self);
/* Same as sequencer_check for the take that plays. */
CHECKED mrt_result overdub_check(const overdub *self, error *err);
const take *overdub_take(const overdub *self); /* the take before the overdub */

/* Call after the player has ended: adds the overdub to the take. */
CHECKED mrt_result overdub_finish(overdub *self, overdub_made *out, error *err);

#endif
