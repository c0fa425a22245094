/* csrbf/shape.h - a deforming shape: rest, base and shown vertices, and the paper's two ways to
 * move them.
 * Anchored: engaging fixes the starts. A frame is shown = base + sum_k B_k (e_k - s_k), and does
 * not depend on the previous frame. Committing makes the shown shape the base.
 * Unanchored: every sample moves the shown shape from the previous tips to the new ones, in enough
 * substeps to prevent folds. The result depends on the path: every sample counts.
 * Vertices are in the engine's order (points.h), mm. [frame] all except create/destroy: no
 * allocation; same input, same bits. */
#ifndef MAROTTE_CSRBF_SHAPE_H
#define MAROTTE_CSRBF_SHAPE_H
#include "csrbf/columns.h"
#include "csrbf/csrbf.h"

/* ---- the unanchored way, through one displacement field, or through several that each move a
 * share of every vertex ---- */

/* Limit of the gain of a linear or windowed polynomial: the motion of a corner of the shape's box,
 * divided by that of the tips. Above it, the polynomial loses its flattest direction
 * (csrbf_limit_gain). */
#define SHAPE_GAIN_LIMIT 64.0

typedef struct shape_step {
    uint32_t substeps;      /* 0: nothing moved */
    double min_determinant; /* over all vertices and substeps; 1 if nothing moved */
    double max_slope;       /* norm of grad d of the whole way, over the vertices; for tests */
    bool limited; /* the maximum of substeps was reached: the tips moved less than requested */
} shape_step;

/* Maximum of substeps per sample. In each, 1.2 times the largest slope is at most 0.5. */
enum { SHAPE_SUBSTEP_CAP = 32 };

/* One field, which moves each vertex by weight times d. */
typedef struct drag_layer {
    csrbf_solver *solver;
    const float *weight;     /* for each vertex (padded_count), 0..1; NULL: 1 */
    const uint8_t *wanted;   /* for each block: 0 if weight is 0 in the whole block; NULL: 1 */
    const uint32_t *control; /* control_count indices of its tips; NULL: all */
    uint32_t control_count;
} drag_layer;

typedef struct drag {       /* all members are borrowed */
    points *moved, *before; /* before: copy to restore after an error */
    const drag_layer *layer;
    uint32_t layer_count, control_capacity;
    double *tip, *step, *pull; /* control_capacity by 3 each */
} drag;

typedef struct drag_way {
    const double *from, *to; /* count by 3 each */
    const double *gain;      /* count factors of the displacements; NULL: 1 */
    uint32_t count;
} drag_way;

/* Moves `moved` along the way. out_reached (count by 3, may be NULL): current places of the tips
 * (== to unless limited). Slopes and determinants in out_step are those of the fields themselves,
 * the worst of all layers. On error nothing has moved. */
CHECKED mrt_result drag_along(const drag *d, const csrbf_settings *settings, const drag_way *way,
                              double *out_reached, shape_step *out_step, error *err);

/* ---- a shape ---- */

typedef struct shape {
    points_order order;
    points rest;  /* as in the file; constant */
    points base;  /* start of anchored frames */
    points shown; /* the result */
    csrbf_solver *solver;
    columns response;                         /* B_k at base */
    double *start;                            /* control_count by 3: starts of the engagement */
    uint32_t control_capacity, control_count; /* control_count > 0: engaged */
    csrbf_settings settings;                  /* of the engagement */
    points before;                            /* drag: copy to restore after an error */
    double *tip, *step, *pull;                /* drag: control_capacity by 3 each */
} shape;

CHECKED mrt_result shape_create(shape *out, const float *xyz, uint32_t vertex_count,
                                uint32_t control_capacity, error *err);
void shape_destroy(shape *s);

/* Returns whether one of the points (count by 3) is closer than radius to a vertex of `p`. Uses the
 * block bounds of `p`. */
bool shape_is_near(const points *p, const double *point, uint32_t count, double radius);

/* base := shown; starts := start (count by 3). Factors, and computes the responses. The shown shape
 * does not change. On error nothing has changed. count 0 ends the engagement. */
CHECKED mrt_result shape_engage(shape *s, const csrbf_settings *settings, const double *start,
                                uint32_t count, error *err);
/* shown := base + B (displacement, control_count by 3), without a solve: controls that do not move
 * cost nothing. Non-finite displacements are an error, and shown is kept. Does nothing without an
 * engagement. */
CHECKED mrt_result shape_pull(shape *s, const double *displacement, error *err);
/* base := shown; ends the engagement. Tests compare a face with this function and with shape_leak;
 * a face does the same with its own points. */
void shape_commit(shape *s);
/* shown := base := rest; ends the engagement. */
void shape_reset(shape *s);

/* Performs one unanchored sample: moves shown along from -> to (count by 3 each). out_reached
 * (count by 3, may be NULL): current places of the tips (== to unless limited). On error nothing
 * has moved. Ends an anchored engagement. */
CHECKED mrt_result shape_drag(shape *s, const csrbf_settings *settings, const double *from,
                              const double *to, uint32_t count, double *out_reached,
                              shape_step *out_step, error *err);
/* shown := shown + (1 - 1 / (1 + rate_per_s dt_s)) (base - shown): eases back to the base. */
void shape_leak(shape *s, double rate_per_s, double dt_s);
/* The same for any points with the same count; updates the bounds of p. */
void shape_ease(points *p, const points *towards, double rate_per_s, double dt_s);

/* Returns the smallest determinant of an anchored pull, over the vertices of base. It is exact, but
 * too slow for every frame; shape_slope_bound is a fast bound. -INFINITY for invalid displacements;
 * 1 without an engagement. The solver then holds their field. Tests compare face_min_determinant
 * and the face_meter with this and with shape_slope_bound. */
double shape_min_determinant(const shape *s, const double *displacement);
/* Returns an upper bound of the norm of grad d for these displacements (theory B2), without reading
 * vertices: < 1 means that nothing folds. INFINITY for invalid displacements; 0 without an
 * engagement. The solver then holds their field. */
double shape_slope_bound(const shape *s, const double *displacement);

#endif
