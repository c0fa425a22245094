/* face/weights/weights_laplace.h - the fill: spreads values given at some vertices of a surface
 * over the others with the least bending. Minimises  sum_v (L u)_v^2 / a_v + tension u'L u, where L
 * is the cotangent Laplacian and a_v the area of a vertex (Botsch and Kobbelt 2004, An intuitive
 * framework for real-time freeform modeling, equation 6, of order 2). A few marks give smooth
 * hills, while a harmonic fill gives spikes. The tension prevents overshoot where nothing is
 * marked. The fill follows only the surface, so it never crosses a slit. Private to this folder.
 * [main] */
#ifndef MAROTTE_FACE_WEIGHTS_LAPLACE_H
#define MAROTTE_FACE_WEIGHTS_LAPLACE_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* Greatest number of vertices to fill. Time and memory grow faster than this number: 5 s and 0.3 GB
 * for 109 000. */
#define LAPLACE_FREE_MOST 250000u

typedef struct laplace {
    const topology *topology; /* must outlive it */
    double *edge_weight;      /* in the order of topology->neighbour: cotangent weights, bounded */
    double *stiffness;        /* vertex_count: mean area of a vertex over its own area, bounded */
    double tension;
} laplace;

CHECKED mrt_result laplace_create(laplace *out, const mesh *m, const topology *t, error *err);
void laplace_destroy(laplace *l); /* accepts zeroed */

/* Fills `value` (column_count by vertex_count) where is_free, from the values where is_given. Each
 * connected piece of free and given vertices must contain a given one. Vertices that are neither
 * are ignored. The result is not clamped. */
CHECKED mrt_result laplace_fill(const laplace *l, float *value, uint32_t column_count,
                                const uint8_t *is_free, const uint8_t *is_given, error *err);

/* The same for changes. The given ones fade to 0 within a few edges, also where nothing is given.
 * Minimises  u'L u + sum_v a_v u_v^2 / mean a, with negative cotangents set to 0. So no change is
 * larger than those around it or has another sign. */
CHECKED mrt_result laplace_fade(const laplace *l, float *change, uint32_t column_count,
                                const uint8_t *is_free, const uint8_t *is_given, error *err);

#endif
