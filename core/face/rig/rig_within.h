/* face/rig_within.h - how far vertices are from one of them along the edges of the surface
 * (Dijkstra 1959). Pure but for scratch memory; any thread. */
#ifndef MAROTTE_FACE_RIG_WITHIN_H
#define MAROTTE_FACE_RIG_WITHIN_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

typedef struct rig_start { /* a vertex, and how far it is already, mm */
    uint32_t vertex;
    double distance_mm;
} rig_start;
/* From the nearest of several. twin: vertex_count, for each vertex the next one of a ring that is
 * the same place of the surface (itself: none is); NULL: edges only. Otherwise as rig_within. */
CHECKED bool rig_within_starts(double *out_distance, const rig_start *start, uint32_t start_count,
                               double reach_mm, const mesh *m, const topology *t,
                               const uint32_t *twin);
/* out_distance: vertex_count, mm; infinite beyond reach_mm and where no edges lead. false: no
 * memory. */
CHECKED bool rig_within(double *out_distance, uint32_t from, double reach_mm, const mesh *m,
                        const topology *t);

#endif
