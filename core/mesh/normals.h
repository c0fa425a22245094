/* mesh/normals.h - smooth vertex normals of a deformed surface. Pure; any thread. */
#ifndef MAROTTE_MESH_NORMALS_H
#define MAROTTE_MESH_NORMALS_H
#include <stdint.h>

/* Computes area-weighted vertex normals of unit length; +z if no triangle with area touches the
 * vertex. nx, ny, nz, x, y, z: vertex_count each, structure of arrays; triangle: triangle_count by
 * 3. The summation order is fixed (triangle order): same bits everywhere. */
void normals_smooth(float *nx, float *ny, float *nz, const float *x, const float *y, const float *z,
                    uint32_t vertex_count, const uint32_t *triangle, uint32_t triangle_count);

#endif
