/* face/weights_follow.h - whom the pieces of surface follow that no region speaks of: lashes,
 * brows, the film of tears. Inside the room. [main] */
#ifndef MAROTTE_FACE_WEIGHTS_FOLLOW_H
#define MAROTTE_FACE_WEIGHTS_FOLLOW_H
#include "base/error.h"

typedef struct follow_scene {
    const float *position; /* vertex_count by 3, mm */
    uint32_t vertex_count;
    const uint32_t *component; /* vertex_count: the piece of surface; component_count: no surface */
    uint32_t component_count;
    const uint32_t *rigid_bone; /* vertex_count: UINT32_MAX: not rigid */
    const uint8_t *is_settled;  /* vertex_count: can be followed; the others follow */
} follow_scene;

/* A piece follows what is rigid or what is not, whichever more of its vertices are nearer to: a
 * lash must not hang on the eyeball with one end and on the lid with the other. out_leader
 * (vertex_count): the nearest settled vertex of that kind; UINT32_MAX for settled ones, and where
 * nothing is settled. out_is_root (vertex_count): 1 for the vertices close to their leaders; the
 * rest of the piece hangs on these: the tip of a lash goes with the lid, not with the brow that it
 * points at. */
CHECKED mrt_result follow_find(uint32_t *out_leader, uint8_t *out_is_root,
                               const follow_scene *scene, error *err);

#endif
