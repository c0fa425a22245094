/* io/write/components.h - the free frames of a clip as weighted sums of a few shapes: principal
 * components with a guaranteed maximum vertex error. A long motion is split into windows of time,
 * each with its own base shape and components. Frames are streamed from the clip, and memory is
 * bounded for any length. Does not cover anchored frames. [main] or a worker. */
#ifndef MAROTTE_IO_COMPONENTS_H
#define MAROTTE_IO_COMPONENTS_H
#include "io/clip.h"
#include "io/export.h"

/* Limits if no count is requested: number of targets, and their bytes if each target moved all
 * vertices. */
enum { COMPONENTS_MAX = 2048, COMPONENTS_MAX_BYTES = 192 << 20 };

/* Frames with a common base and components. `moved` lists the vertices that the components move;
 * all others keep their position in the base. */
typedef struct component_window {
    uint32_t first_frame, frame_count; /* range in components.frame */
    uint32_t count, moved_count;
    float *base;     /* vertex_count by 3: metres from base_m; NULL: none, the base is base_m */
    uint32_t *moved; /* moved_count: vertices, ascending */
    float *axis;     /* count by moved_count by 3: metres per unit of weight */
    float *weight;   /* frame_count by count: within 0..1 */
} component_window;

typedef struct components {
    uint32_t vertex_count, frame_count, window_count;
    uint32_t target_count; /* components of all windows, and their bases */
    uint32_t *frame;       /* frame_count: the free frames of the clip, ascending */
    component_window *window;
    /* Maximum error over all free frames and vertices, for base_m + base + sum of weight * axis.
     * Excludes rounding errors of that sum in float32. */
    double max_error_mm;
} components;

typedef struct components_request {
    const float *base_m; /* vertex_count by 3: the shape that bases and components are added to */
    double tolerance_mm; /* maximum vertex error, > 0 */
    uint32_t max_count; /* number of targets; 0: no limit except those above; with few targets there
                           are few windows */
} components_request;

/* Finds for each window the fewest leading principal components that keep the tolerance in every
 * frame. If those of the picked frames are not enough, it adds the residual of the worst frames. If
 * a limit is reached first, out->max_error_mm exceeds the tolerance. */
CHECKED mrt_result components_find(components *out, const clip *c, const components_request *wanted,
                                   const export_progress *progress, error *err);
void components_finish(components *c); /* accepts NULL and zeroed */

/* Expands a component of a window. out: vertex_count by 3, metres per unit of weight. */
void components_offset(float *out, const components *c, const component_window *window,
                       uint32_t component);

#endif
