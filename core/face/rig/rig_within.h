/* face/rig_within.h - how far vertices are from one of them along the edges of the surface
 * (Dijkstra 1959). Inside the room. Pure but for scratch memory; any thread. */
#ifndef MAROTTE_FACE_RIG_WITHIN_H
#define MAROTTE_FACE_RIG_WITHIN_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* out_distance: vertex_count, mm; infinite beyond reach_mm and where no edges lead. false: no
 * memory. */
CHECKED bool rig_within(double *out_distance, uint32_t from, double reach_mm, const mesh *m,
                        const topology *t);

#endif
