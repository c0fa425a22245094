/* io/write/morph.h - change of the normals of a surface, to first order, when a morph target moves
 * it. Pure. [any] */
#ifndef MAROTTE_IO_MORPH_H
#define MAROTTE_IO_MORPH_H
#include <stdint.h>

/* A surface at rest. position: V by 3; normal: V by 3, unit; area: V by 3, the sum of twice the
 * area vectors of the triangles around each vertex. */
typedef struct morph_surface {
    const float *position, *normal;
    const double *area;
    const uint32_t *triangle;
    uint32_t vertex_count, triangle_count;
} morph_surface;

void morph_area(double *out_area, const float *position, uint32_t vertex_count,
                const uint32_t *triangle, uint32_t triangle_count);

/* Computes the change of the normals per unit of weight of a target that moves the vertices by
 * offset (V by 3). out: V by 3; 0 where the surface has no area. work: V by 3. */
void morph_normal_offset(float *out, double *work, const morph_surface *surface,
                         const float *offset);

#endif
