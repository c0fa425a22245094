/* io/components.h - the free frames of a clip as weighted sums of few shapes: principal components
 * with a guaranteed greatest vertex error. The frames are streamed from the clip in blocks; memory
 * is bounded whatever the clip's length. Leaves out anchored frames. [main] or a worker. */
#ifndef MAROTTE_IO_COMPONENTS_H
#define MAROTTE_IO_COMPONENTS_H
#include "io/clip.h"
#include "io/export.h"

/* Where no count is asked for: at most so many components, and so many bytes of them. */
enum { COMPONENTS_MAX = 1024, COMPONENTS_MAX_BYTES = 192 << 20 };

typedef struct components {
    uint32_t vertex_count, count, frame_count;
    uint32_t *frame; /* frame_count: the free frames of the clip, ascending */
    float *axis;     /* count by vertex_count by 3: metres per unit of weight */
    float *weight;   /* frame_count by count: within -1..1 */
    /* Over all free frames and vertices, of base_m + sum of weight * axis as float32 holds them. */
    double max_error_mm;
} components;

typedef struct components_request {
    const float *base_m; /* vertex_count by 3: the shape that the components are added to */
    double tolerance_mm; /* greatest vertex error wanted, > 0 */
    uint32_t max_count;  /* 0: as many as the tolerance needs, within the limits above */
} components_request;

/* The fewest leading principal components that hold the tolerance in every frame; where those of
 * the frames looked at do not suffice, what is missing in the worst ones is added. When a limit
 * comes first, out->max_error_mm is above the tolerance. */
CHECKED mrt_result components_find(components *out, const clip *c, const components_request *wanted,
                                   const export_progress *progress, error *err);
void components_finish(components *c); /* accepts NULL and zeroed */

#endif
