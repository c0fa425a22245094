/* mesh/shading.h - the normals of a surface that moves by blocks of vertices: those of
 * normals_smooth, found anew only at vertices that share a triangle with a block that was written.
 * Where a bone carries a vertex and all its triangles rigidly, its normal may be the one at rest,
 * turned: it differs from that of normals_smooth by what float rounds, far less than a degree;
 * elsewhere, and where nothing moves, the bits are the same. Either way they follow from
 * the shape now, and never from the frames before. [frame] all but create and destroy: no
 * allocation. */
#ifndef MAROTTE_MESH_SHADING_H
#define MAROTTE_MESH_SHADING_H
#include "base/rigid.h"
#include "base/stamps.h"

enum { SHADING_BLOCK = 64, SHADING_LOOSE = 255 };

typedef struct shading shading;

/* x, y, z: vertex_count each, at rest, in blocks of SHADING_BLOCK; triangle: triangle_count by 3,
 * in the order in which their areas are added up. smooth: vertex_count: of the vertices that have
 * one normal, being at one position, the one that stands for all; NULL: each has its own. Nothing
 * of it is needed any more. */
CHECKED mrt_result shading_create(shading **out, const float *const rest[3], uint32_t vertex_count,
                                  const uint32_t *triangle, uint32_t triangle_count,
                                  const uint32_t *smooth, error *err);
void shading_destroy(shading *self); /* NULL is fine */

typedef struct shading_shape {
    const float *at[3];    /* x, y, z: whole blocks; what is beyond vertex_count is not looked at */
    const stamps *written; /* blocks of it that have changed */
    const uint8_t *carrier; /* of each block: the bone that moves it as it is at rest, or
                               SHADING_LOOSE; a block where that changes has been written */
    const rigid *pose;      /* of each bone */
} shading_shape;
/* The normals become those of the shape. */
void shading_update(shading *self, const shading_shape *now);

/* Unit; +z where no triangle with area touches the vertex. axis: 0 to 2. Until destroy. */
const float *shading_normal(const shading *self, uint32_t axis);
/* Which blocks of the normals have been written. */
const stamps *shading_written(const shading *self);

#endif
