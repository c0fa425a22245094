/* rigs/moai/remesh.h - turns any skin near a shape given as a function into a skin of good
 * triangles of the wanted sizes. Creases of the shape become edges. Pure. [any] */
#ifndef MAROTTE_RIGS_MOAI_REMESH_H
#define MAROTTE_RIGS_MOAI_REMESH_H
#include "skin.h"

/* The target of a remesh: a shape given as a function, and the wanted sizes of triangles on it. */
typedef struct form {
    double (*distance)(vec3); /* mm, below 0 inside; must be accurate only near the surface */
    double (*edge_mm)(vec3);  /* wanted length of edges at a point */
    double edge_scale;        /* factor of edge_mm */
} form;

/* Cuts a level line into the skin: from x = 0 to line_end.x at the height line_end.y, where z is at
 * least line_end.z. Its points then hold SKIN_LEVEL. */
CHECKED mrt_result remesh_cut_level(skin *s, vec3 line_end, error *err);

/* Splits, collapses, flips and moves until sizes, angles and creases are as wanted. */
CHECKED mrt_result remesh_adapt(skin *s, const form *shape, int32_t rounds, error *err);

/* Collapses the shortest edges, relative to the wanted sizes, until triangle_count are left, and
 * smooths. Returns an error if there are already fewer, or if no more edges can collapse. */
CHECKED mrt_result remesh_reduce(skin *s, const form *shape, int32_t triangle_count, error *err);

#endif
