/* stage/mapping/isolate_fallback.h - the mapping that goes on while the person's own is away: it
 * keeps the last control vectors and moves each end as the nearest fingertip moves, so that nothing
 * jumps and the face still follows a little. A function of its frames. [frame]; no allocation. */
#ifndef MAROTTE_STAGE_ISOLATE_FALLBACK_H
#define MAROTTE_STAGE_ISOLATE_FALLBACK_H
#include <marotte/plugin.h>

#define ISOLATE_FALLBACK_GAIN     0.5f
#define ISOLATE_FALLBACK_REACH_MM 15.0f /* of each end from where it was */
#define ISOLATE_FALLBACK_STEP_MM  3.0f  /* of a fingertip, in one frame */

enum { ISOLATE_TIPS = 10 };
typedef struct isolate_fallback {
    mrt_pull from;                     /* held when it began */
    mrt_vec3 moved[ISOLATE_TIPS];      /* each fingertip's way since */
    mrt_vec3 tip[ISOLATE_TIPS];        /* in the frame before */
    bool has_tip[2];                   /* by hand */
    uint32_t nearest[MRT_MAX_VECTORS]; /* tip of each vector; ISOLATE_TIPS: none */
} isolate_fallback;

/* frame: the last one that was answered, or that was not. */
void isolate_fallback_begin(isolate_fallback *self, const mrt_frame *frame, const mrt_pull *held);
void isolate_fallback_process(isolate_fallback *self, const mrt_frame *frame, mrt_pull *pull);

#endif
