/* csrbf/drag.h - the unanchored way to move vertices: a sample's way from tips to tips in as many
 * substeps as keep the map from folding, through one displacement field or through several that
 * each move their share of every vertex. shape.h and the face use it. [frame] no
 * allocation. */
#ifndef MAROTTE_CSRBF_DRAG_H
#define MAROTTE_CSRBF_DRAG_H
#include "csrbf/csrbf.h"

/* A linear or windowed polynomial that would move some corner of the shape's box more than this
 * many times further than the tips loses its flattest direction (csrbf_limit_gain). */
#define SHAPE_GAIN_LIMIT 64.0

typedef struct shape_step {
    uint32_t substeps;      /* 0: nothing moved */
    double min_determinant; /* over all vertices and substeps; 1 when nothing moved */
    double max_slope;       /* norm of grad d of the whole way, over the vertices */
    bool limited; /* the cap of substeps was reached: the tips moved less far than asked */
} shape_step;

/* At most so many substeps per sample, each with 1.2 times its largest slope at most 0.5. */
enum { SHAPE_SUBSTEP_CAP = 32 };

/* One field: it moves each vertex by weight times d. */
typedef struct drag_layer {
    csrbf_solver *solver;
    const float *weight;     /* of each vertex (padded_count), 0..1; NULL: 1 */
    const uint8_t *wanted;   /* of each block: 0 where weight is 0 all over it; NULL: 1 */
    const uint32_t *control; /* control_count indices of the tips that it holds; NULL: all */
    uint32_t control_count;
} drag_layer;

typedef struct drag {       /* borrowed */
    points *moved, *before; /* before: what is restored on an error */
    const drag_layer *layer;
    uint32_t layer_count, control_capacity;
    double *tip, *step, *pull; /* control_capacity by 3 each */
} drag;

typedef struct drag_way {
    const double *from, *to; /* count by 3 each */
    const double *gain;      /* count: a tip's displacement times this is solved for; NULL: 1 */
    uint32_t count;
} drag_way;

/* Moves `moved` along. out_reached (count by 3, may be NULL): where the tips are now (== to unless
 * limited). The slopes and determinants of out_step are those of the fields themselves, the worst
 * of all layers. On error nothing has moved. */
CHECKED mrt_result drag_along(const drag *d, const csrbf_settings *settings, const drag_way *way,
                              double *out_reached, shape_step *out_step, error *err);

#endif
