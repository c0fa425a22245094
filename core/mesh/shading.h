/* mesh/shading.h - the normals of a surface that moves by blocks of vertices. They equal those of
 * normals_smooth, but are computed only at vertices that share a triangle with a written block. If
 * a bone carries a vertex and all its triangles rigidly, its normal may be the rotated one at rest.
 * It then differs from that of normals_smooth by float rounding, much less than a degree.
 * Elsewhere, and if nothing moves, the bits are the same. Normals depend only on the current shape,
 * never on earlier frames. [frame] all except create and destroy: no allocation. */
#ifndef MAROTTE_MESH_SHADING_H
#define MAROTTE_MESH_SHADING_H
#include "base/rigid.h"
#include "base/stamps.h"

enum { SHADING_BLOCK = 64, SHADING_LOOSE = 255 };

typedef struct shading shading;

/* x, y, z: vertex_count each, at rest, in blocks of SHADING_BLOCK; triangle: triangle_count by 3,
 * in the order of summation. smooth (vertex_count): for vertices at one position with one normal,
 * the vertex that represents them; NULL: each has its own. The arguments may be freed after
 * creation. */
CHECKED mrt_result shading_create(shading **out, const float *const rest[3], uint32_t vertex_count,
                                  const uint32_t *triangle, uint32_t triangle_count,
                                  const uint32_t *smooth, error *err);
void shading_destroy(shading *self); /* accepts NULL */

typedef struct shading_shape {
    const float *at[3];     /* x, y, z: whole blocks; values after vertex_count are ignored */
    const stamps *written;  /* blocks that have changed */
    const uint8_t *carrier; /* for each block: the bone that moves its rest shape rigidly, or
                               SHADING_LOOSE; a block where that changes must be written */
    const rigid *pose;      /* for each bone */
} shading_shape;
/* Updates the normals to the shape. */
void shading_update(shading *self, const shading_shape *now);

/* Returns unit normals; +z if no triangle with area touches the vertex. axis: 0 to 2. Valid until
 * destroy. */
const float *shading_normal(const shading *self, uint32_t axis);
/* Returns which blocks of the normals were written. */
const stamps *shading_written(const shading *self);

#endif
