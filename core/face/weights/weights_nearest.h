/* face/weights/weights_nearest.h - the nearest of some of a mesh's vertices. Inside the room.
 * [main] */
#ifndef MAROTTE_FACE_WEIGHTS_NEAREST_H
#define MAROTTE_FACE_WEIGHTS_NEAREST_H
#include "mesh/mesh.h"

typedef struct nearest nearest;

/* Over the vertices with is_member; position (vertex_count by 3) must outlive it. NULL: no memory.
 */
nearest *nearest_create(const float *position, const uint8_t *is_member, uint32_t vertex_count);
void nearest_destroy(nearest *n); /* NULL is fine */
/* The member nearest to `at`, of several the one with the smallest index; UINT32_MAX: none. */
uint32_t nearest_find(const nearest *n, const float at[3]);

#endif
