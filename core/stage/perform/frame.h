/* stage/perform/frame.h - one frame, from the samples of a step to the published face. Start here
 * to learn how marotte performs. The two functions of frame.c list all phases in order, with the
 * data that each phase passes to the next. Live, offline, a played take, an exported take and an
 * overdub call the same functions. They differ in the clock (when they call), the sources (the
 * scheduler) and the sinks (the hooks of the frame).
 *
 * Phases 1 to 8 run once for each step of samples, in time order, so a performance is a function of
 * its samples alone. Phases 9 and 10 run once for each drawn frame. [frame] No allocation, lock,
 * I/O or process. */
#ifndef MAROTTE_STAGE_FRAME_H
#define MAROTTE_STAGE_FRAME_H
#include "stage/perform/performer.h"
#include "stage/perform/scheduler.h"

typedef enum frame_phase {
    FRAME_SCHEDULE = 0, /* sources -> sample_step: samples performed together */
    FRAME_RECORD,       /* sample_step -> the show file */
    FRAME_HANDS,        /* sample_step -> mrt_frame: hands, pedals, channels */
    FRAME_PATCH,        /* mrt_frame.inputs -> mrt_frame.params, patch_bay.pull */
    FRAME_MAPPING,      /* mrt_frame -> mrt_pull */
    FRAME_GUARD,        /* mrt_pull -> layer.good: the last valid pull */
    FRAME_COMPOSE,      /* performer.voice -> performer_parts: the pulls of all voices */
    FRAME_SOLVE,        /* performer_parts -> the fields of the face */
    FRAME_DEFORM,       /* fields -> positions and normals */
    FRAME_PUBLISH,      /* positions -> window, outputs, files */
    FRAME_PHASES
} frame_phase;

typedef struct stage_frame {
    performer *performer; /* performs the step; its face is drawn. The hooks may set it */
    scheduler *sources;   /* sources of the step; NULL: the caller made the step */
    bool is_pull_only;    /* a step ends after the guard: the face does not move */

    /* Hooks: the sinks of the frame. Each may be NULL. */
    void *self;
    /* Runs before any phase reads the samples. MRT_END: the step is not performed. */
    CHECKED mrt_result (*record)(void *self, struct stage_frame *f, error *err);
    void (*performed)(void *self, const struct stage_frame *f); /* after the solve */
    /* Runs before the face is drawn: brings it to time_ns, or sets `performer` to NULL if nothing
     * changed. MRT_END: the performance ends with this frame. */
    CHECKED mrt_result (*show)(void *self, struct stage_frame *f, int64_t time_ns, error *err);
    CHECKED mrt_result (*publish)(void *self, const struct stage_frame *f, error *err);

    sample_step step;              /* the step that is performed now */
    int64_t (*now_ns)(void);       /* clock that times the phases; NULL: they are not timed */
    int64_t took_ns[FRAME_PHASES]; /* summed until the owner clears it */
} stage_frame;

/* Performs `step`: phases 1 to 8. The caller has set the step, with scheduler_next of `sources` or
 * directly. */
CHECKED mrt_result frame_step(stage_frame *f, error *err);
/* Draws the face: phases 9 and 10. Returns MRT_END where `show` does. */
CHECKED mrt_result frame_draw(stage_frame *f, int64_t time_ns, error *err);
/* Phases 7 and 8 alone, after the voices of a performer changed without a step. now_ns: see
 * sample_step.due_ns. */
void frame_recompose(performer *p, int64_t now_ns);

#endif
