/* csrbf/shape.h - a shape that is performed: rest, base and shown vertices, and the two ways of the
 * paper to move them.
 * Anchored: starts are fixed at engage; a frame is shown = base + sum_k B_k (e_k - s_k), never from
 * the frame before. Commit makes the shape shown the base.
 * Unanchored: every sample moves the shown shape from the previous tips to the new ones, in as many
 * substeps as keep the map from folding. Path-dependent: every sample counts.
 * Vertices are in the engine's order (points.h), mm. [frame] all but create/destroy: no
 * allocation; same input, same bits. */
#ifndef MAROTTE_CSRBF_SHAPE_H
#define MAROTTE_CSRBF_SHAPE_H
#include "csrbf/columns.h"
#include "csrbf/csrbf.h"

/* ---- the unanchored way, through one displacement field or through several that each move their
 * share of every vertex ---- */

/* A linear or windowed polynomial that would move some corner of the shape's box more than this
 * many times further than the tips loses its flattest direction (csrbf_limit_gain). */
#define SHAPE_GAIN_LIMIT 64.0

typedef struct shape_step {
    uint32_t substeps;      /* 0: nothing moved */
    double min_determinant; /* over all vertices and substeps; 1 when nothing moved */
    double max_slope;       /* norm of grad d of the whole way, over the vertices; for tests */
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

/* ---- a shape ---- */

typedef struct shape {
    points_order order;
    points rest;  /* as in the file; never changes */
    points base;  /* anchored frames start from it */
    points shown; /* the result */
    csrbf_solver *solver;
    columns response;                         /* B_k at base */
    double *start;                            /* control_count by 3: starts of the engagement */
    uint32_t control_capacity, control_count; /* control_count > 0: engaged */
    csrbf_settings settings;                  /* of the engagement */
    points before;                            /* drag: what is restored on an error */
    double *tip, *step, *pull;                /* drag: control_capacity by 3 each */
} shape;

CHECKED mrt_result shape_create(shape *out, const float *xyz, uint32_t vertex_count,
                                uint32_t control_capacity, error *err);
void shape_destroy(shape *s);

/* True when some of the points (count by 3) is closer than radius to a vertex of `p`. Uses the
 * block bounds of `p`. */
bool shape_is_near(const points *p, const double *point, uint32_t count, double radius);

/* Base := shown; starts := start (count by 3); factors and computes the responses. The shape shown
 * does not change. On error nothing has changed. count 0 ends the engagement. */
CHECKED mrt_result shape_engage(shape *s, const csrbf_settings *settings, const double *start,
                                uint32_t count, error *err);
/* shown := base + B (displacement, control_count by 3): no solve, so what it costs does not depend
 * on controls that are held. Non-finite: error, shown is kept. Without an engagement nothing
 * happens. */
CHECKED mrt_result shape_pull(shape *s, const double *displacement, error *err);
/* Base := shown; the engagement ends. This and shape_leak are what tests hold a face to, which does
 * the same to its own points. */
void shape_commit(shape *s);
/* shown := base := rest; the engagement ends. */
void shape_reset(shape *s);

/* One unanchored sample: moves shown along from -> to (count by 3 each). `out_reached` (count by 3,
 * may be NULL): where the tips are now (== to unless limited). On error nothing has moved. An
 * anchored engagement ends. */
CHECKED mrt_result shape_drag(shape *s, const csrbf_settings *settings, const double *from,
                              const double *to, uint32_t count, double *out_reached,
                              shape_step *out_step, error *err);
/* shown := shown + (1 - 1 / (1 + rate_per_s dt_s)) (base - shown): eases back to the base. */
void shape_leak(shape *s, double rate_per_s, double dt_s);
/* The same for any points of one count; keeps the bounds of p. */
void shape_ease(points *p, const points *towards, double rate_per_s, double dt_s);

/* Smallest determinant of an anchored pull, over the vertices of base; the exact meter, not for
 * every frame. The cheap bound is shape_slope_bound. -INFINITY when the
 * displacements are refused; 1 without an engagement. The solver then holds their field.
 * Tests hold face_min_determinant and the face_meter to this and to shape_slope_bound. */
double shape_min_determinant(const shape *s, const double *displacement);
/* Upper bound of the norm of grad d for these displacements (theory B2), without touching a vertex:
 * < 1 means that nothing folds. INFINITY when they are refused; 0 without an engagement. The solver
 * then holds their field. */
double shape_slope_bound(const shape *s, const double *displacement);

#endif
