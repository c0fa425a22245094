/* face/weights/weights_nearest.h - search for the nearest of some vertices of a mesh. Private to
 * this folder. [main] */
#ifndef MAROTTE_FACE_WEIGHTS_NEAREST_H
#define MAROTTE_FACE_WEIGHTS_NEAREST_H
#include "mesh/mesh.h"

typedef struct nearest nearest;

/* Searches the vertices with is_member. position (vertex_count by 3) must outlive the search.
 * Returns NULL without memory. */
nearest *nearest_create(const float *position, const uint8_t *is_member, uint32_t vertex_count);
void nearest_destroy(nearest *n); /* accepts NULL */
/* Returns the member nearest to `at`, the one with the smallest index among equals, or UINT32_MAX
 * if there are none. */
uint32_t nearest_find(const nearest *n, const float at[3]);

#endif
