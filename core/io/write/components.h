/* io/write/components.h - the free frames of a clip as weighted sums of few shapes: principal
 * components with a guaranteed greatest vertex error. A long motion that wanders is split into
 * windows of time with a base shape and components of their own. The frames are streamed from the
 * clip; memory is bounded whatever the clip's length. Leaves out anchored frames. [main] or a
 * worker. */
#ifndef MAROTTE_IO_COMPONENTS_H
#define MAROTTE_IO_COMPONENTS_H
#include "io/clip.h"
#include "io/export.h"

/* Where no count is asked for: at most so many targets in all, and so many bytes if each moved
 * every vertex. */
enum { COMPONENTS_MAX = 2048, COMPONENTS_MAX_BYTES = 192 << 20 };

/* Frames that share a base and components. What its components move is listed; every other vertex
 * stays where the base has it. */
typedef struct component_window {
    uint32_t first_frame, frame_count; /* of components.frame */
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
    /* Over all free frames and vertices, of base_m + base + sum of weight * axis, but for what
     * their sum in float32 loses. */
    double max_error_mm;
} components;

typedef struct components_request {
    const float *base_m; /* vertex_count by 3: the shape that bases and components are added to */
    double tolerance_mm; /* greatest vertex error wanted, > 0 */
    uint32_t max_count;  /* of targets; 0: as many as the tolerance needs, within the limits above;
                            few targets make few windows */
} components_request;

/* In each window the fewest leading principal components that hold the tolerance in every frame;
 * where those of the frames looked at do not suffice, what is missing in the worst ones is added.
 * When a limit comes first, out->max_error_mm is above the tolerance. */
CHECKED mrt_result components_find(components *out, const clip *c, const components_request *wanted,
                                   const export_progress *progress, error *err);
void components_finish(components *c); /* accepts NULL and zeroed */

/* out: vertex_count by 3: metres per unit of weight of a window's component. */
void components_offset(float *out, const components *c, const component_window *window,
                       uint32_t component);

#endif
