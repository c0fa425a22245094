/* rigs/moai/remesh.h - makes a skin of good triangles, of the sizes wanted, out of any skin that
 * lies near a shape given as a function. Creases of the shape become edges. Pure; any thread. */
#ifndef MAROTTE_RIGS_MOAI_REMESH_H
#define MAROTTE_RIGS_MOAI_REMESH_H
#include "skin.h"

/* What a skin is fitted to: a shape given as a function, and the sizes of triangles wanted on it.
 */
typedef struct form {
    double (*distance)(vec3); /* mm, below 0 inside; need only be good near the surface */
    double (*edge_mm)(vec3);  /* the length of edges wanted at a point */
    double edge_scale;        /* times this */
} form;

/* Cuts a level line into the skin: from x = 0 to line_end.x at the height line_end.y, where z is at
 * least line_end.z. Its points hold SKIN_LEVEL from now on. */
CHECKED mrt_result remesh_cut_level(skin *s, vec3 line_end, error *err);

/* Splits, collapses, flips and moves until sizes, angles and creases are as wanted. */
CHECKED mrt_result remesh_adapt(skin *s, const form *shape, int32_t rounds, error *err);

/* Collapses the shortest edges (by the sizes wanted) until triangle_count are left, and smooths.
 * Refuses when fewer are there already, or when no more edges can go. */
CHECKED mrt_result remesh_reduce(skin *s, const form *shape, int32_t triangle_count, error *err);

#endif
