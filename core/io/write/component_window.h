/* io/component_window.h - the components of one window of frames. Private to the search for
 * components. */
#ifndef MAROTTE_IO_COMPONENT_WINDOW_H
#define MAROTTE_IO_COMPONENT_WINDOW_H
#include "io/write/components.h"
#include "io/write/window_frames.h"

typedef struct window_request {
    uint32_t first_frame, frame_count; /* of the free frames, at least 1 */
    window_base base;
    double tolerance_m;
    uint32_t cap; /* of targets, the base among them; 1 is taken as 2 */
    const export_progress *progress;
    double done_before, done_share; /* of all there is to do */
} window_request;

/* out_error_m: the greatest distance of a vertex from where it should be. */
CHECKED mrt_result component_window_find(component_window *out, double *out_error_m,
                                         component_frames *frames, const window_request *wanted,
                                         error *err);
uint32_t component_window_target_count(const component_window *w);
void component_window_finish(component_window *w);

#endif
