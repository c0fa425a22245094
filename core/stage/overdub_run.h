/* stage/overdub_run.h - what happens to a take that is performed over: count-in, pre-roll, passes;
 * which of what is performed counts, and the edits that make it a part of the take. The one way for
 * whoever performs over a take: overdub.h, and live.h. Leaves out who moves the face (sequencer.h)
 * and who makes the edits. [frame] no allocation, but recorder's takes; edits [main]. */
#ifndef MAROTTE_STAGE_OVERDUB_RUN_H
#define MAROTTE_STAGE_OVERDUB_RUN_H
#include "stage/recorder.h"
#include "stage/transport.h"
#include "take/edit.h"

enum { OVERDUB_PASSES_MAX = 99 };

typedef struct overdub_plan { /* overdub.h says what each is */
    char name[TAKE_NAME];
    char (*own)[TAKE_NAME];
    uint32_t own_count;
    uint32_t into_layer;
    int64_t in_ns, out_ns, fade_ns, count_in_ns, preroll_ns;
    uint32_t passes;
    double speed;
} overdub_plan;

typedef struct overdub_pass { /* what was performed in one */
    int64_t performance, raw_take;
    int64_t from_ns;           /* show time: the performance's start */
    int64_t first_ns, last_ns; /* show time: of its samples within in..out */
    int64_t start_ns, end_ns;  /* of the timeline: the same */
    uint64_t sample_count;
} overdub_pass;

typedef struct overdub_run {
    overdub_plan plan; /* its patterns are the caller's */
    char scene[TAKE_NAME], shot[TAKE_NAME];
    transport transport;
    bool has_begun, is_over;
    int64_t rolling_ns; /* clock: when the count-in ends */
    int64_t start_ns;   /* of the timeline: in, less the pre-roll */
    int64_t duration_ns, at_ns;
    uint32_t pass_now;
    int64_t performance_from_ns; /* show time of the first sample */
    overdub_pass pass[OVERDUB_PASSES_MAX];
} overdub_run;

CHECKED mrt_result overdub_plan_check(const overdub_plan *plan, const take *t, error *err);
/* What moves, of the layer that is punched: NULL: the plan says it itself. */
const take_layer *overdub_punched(const overdub_plan *plan, const take *t);
void overdub_run_init(overdub_run *out, const overdub_plan *plan, const take *t);

/* The timeline as it is at a time of the clock, at_ns. What was performed in a pass that ends is a
 * take by itself; the next pass is another. < 0: what could not be recorded. */
CHECKED mrt_result overdub_run_go_to(overdub_run *self, recorder *into, int64_t clock_ns,
                                     error *err);
/* It ends here. */
CHECKED mrt_result overdub_run_end(overdub_run *self, recorder *into, error *err);
/* A take for the pass that comes. */
void overdub_run_slate(const overdub_run *self, recorder *into);
/* A step is performed, after overdub_run_go_to and recorder_step of its time. */
void overdub_run_note(overdub_run *self, const recorder *into, int64_t clock_ns);
bool overdub_run_is_recording(const overdub_run *self);
uint32_t overdub_run_pass(const overdub_run *self);
double overdub_run_weight(const overdub_run *self); /* as the clip will be shown: 0..1 */

typedef struct overdub_made {
    uint32_t layer_count;   /* made or punched */
    uint32_t last_layer;    /* that is heard: its id */
    int64_t raw_take;       /* of the pass that is heard, by itself */
    int64_t from_ns, to_ns; /* of the timeline */
} overdub_made;
/* The edits that make of the take what was performed: *out is one of them each, to be finished and
 * freed. name: of the layer when the plan has none. */
CHECKED mrt_result overdub_run_edits(const overdub_run *self, const take *before, const char *name,
                                     edit **out, uint32_t *out_count, overdub_made *out_made,
                                     error *err);
void overdub_edits_destroy(edit *edits, uint32_t count);

#endif
