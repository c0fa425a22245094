/* window/brush.h - a brush on the surface of a mesh at rest: how strongly a stroke has touched each
 * vertex. Its reach is measured along the surface, so that a stroke over the lower lip leaves the
 * upper one alone. Leaves out what is painted (rig_stroke.h). mm; pure but for its own memory.
 * [main] */
#ifndef MAROTTE_UI_WINDOW_BRUSH_H
#define MAROTTE_UI_WINDOW_BRUSH_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

typedef struct brush brush;

typedef enum brush_falloff { BRUSH_SMOOTH = 0, BRUSH_HARD } brush_falloff;
typedef enum brush_sides { BRUSH_ONE_SIDE = 0, BRUSH_BOTH_SIDES } brush_sides;
typedef struct brush_shape {
    double radius_mm;
    brush_falloff falloff;
    brush_sides sides; /* the mirror image of the stroke too */
} brush_shape;

/* The mesh and its topology must outlive it. */
CHECKED mrt_result brush_create(brush **out, const mesh *m, const topology *t, error *err);
void brush_destroy(brush *self); /* NULL is fine */

/* A stroke: nothing is touched yet. */
void brush_begin(brush *self, const brush_shape *shape);
/* On to `place`, which is nearest to `vertex`; also over what lies between there and the place
 * before, where one surface joins them. */
CHECKED mrt_result brush_move(brush *self, uint32_t vertex, const float place[3], error *err);

enum { BRUSH_HERE = 0, BRUSH_THERE = 1 }; /* where the pointer was; its mirror image */
/* vertex_count: 0 not touched .. 1. Until the next stroke. */
const float *brush_touch(const brush *self, uint32_t side);
/* Which vertices any of the two is above 0 at, in the order in which they were touched. */
const uint32_t *brush_touched(const brush *self, uint32_t *out_count);

/* The vertex that is the mirror image, or nearest to it; where two lie there, the one that faces
 * alike. UINT32_MAX: none is near. */
uint32_t brush_mirror_of(const brush *self, uint32_t vertex);
const float *brush_normals(const brush *self); /* vertex_count by 3: of the mesh at rest */
double brush_middle_mm(const brush *self);     /* x of the plane of symmetry */

#endif
