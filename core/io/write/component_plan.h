/* io/component_plan.h - where the windows of a long motion begin. Looks at some frames and some
 * vertices only: an estimate, the same on every run. Private to the search for components. */
#ifndef MAROTTE_IO_COMPONENT_PLAN_H
#define MAROTTE_IO_COMPONENT_PLAN_H
#include "io/write/component_frames.h"

typedef struct component_plan {
    uint32_t count;
    uint32_t *first; /* count + 1: the first frame of each window, and the end */
    uint32_t *need;  /* count: about how many targets each needs, at least 1 */
} component_plan;

/* Windows that make bytes and work together small. cap: of targets in all. */
CHECKED mrt_result component_plan_make(component_plan *out, component_frames *frames,
                                       double tolerance_m, uint32_t cap, error *err);
void component_plan_finish(component_plan *p);

#endif
