/* face/weights/weights_laplace.h - the fill: values given at some vertices of a surface, spread
 * over the others so that they bend least: minimises  sum_v (L u)_v^2 / a_v + tension u'L u, L the
 * cotangent Laplacian, a_v the area of a vertex (Botsch and Kobbelt 2004, An intuitive framework
 * for real-time freeform modeling, equation 6, of order 2). From a few marks that gives smooth
 * hills where the harmonic fill has spikes; the tension keeps it from shooting out where nothing is
 * marked. Never crosses a slit: only the surface counts. Inside the room. [main] */
#ifndef MAROTTE_FACE_WEIGHTS_LAPLACE_H
#define MAROTTE_FACE_WEIGHTS_LAPLACE_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* Vertices that are filled: time and memory grow faster than they, 5 s and 0.3 GB for 109 000. */
#define LAPLACE_FREE_MOST 250000u

typedef struct laplace {
    const topology *topology; /* must outlive it */
    double *edge_weight;      /* like topology->neighbour: cotangent weights, bounded */
    double *stiffness;        /* vertex_count: mean area of a vertex over its own, bounded */
    double tension;
} laplace;

CHECKED mrt_result laplace_create(laplace *out, const mesh *m, const topology *t, error *err);
void laplace_destroy(laplace *l); /* accepts zeroed */

/* value: column_count by vertex_count; where is_free, they are overwritten by the fill of those
 * where is_given; each connected piece of free and given vertices must have one given. Vertices
 * that are neither are left alone and count as absent. Not clamped. */
CHECKED mrt_result laplace_fill(const laplace *l, float *value, uint32_t column_count,
                                const uint8_t *is_free, const uint8_t *is_given, error *err);

/* The same of changes: those given fade out to 0 within a few edges, where nothing is given too:
 * minimises  u'L u + sum_v a_v u_v^2 / mean a, with the cotangents below 0 cut, so that no change
 * is larger than those around it or has another sign. */
CHECKED mrt_result laplace_fade(const laplace *l, float *change, uint32_t column_count,
                                const uint8_t *is_free, const uint8_t *is_given, error *err);

#endif
