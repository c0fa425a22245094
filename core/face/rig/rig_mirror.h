/* face/rig_mirror.h - which vertices of a mesh are mirror images of each other in a plane x = c.
 * Pure but for scratch memory; any thread. */
#ifndef MAROTTE_FACE_RIG_MIRROR_H
#define MAROTTE_FACE_RIG_MIRROR_H
#include "base/rigid.h"
#include "mesh/mesh.h"

/* How many vertices have no other one (or themselves) within reach_mm of their mirror image;
 * out_example: one of them. false: no memory. */
CHECKED bool rig_mirror_count_alone(uint32_t *out_count, uint32_t *out_example, const mesh *m,
                                    double middle_x, double reach_mm);

/* The vertex nearest to the mirror image of `vertex`, and how far it is from it, mm. Looks at
 * every vertex. */
uint32_t rig_mirror_of(const mesh *m, uint32_t vertex, double middle_x, double *out_distance_mm);

vec3 rig_mirror_position(const mesh *m, uint32_t vertex);

#endif
