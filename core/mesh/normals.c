#include "mesh/normals.h"

#include <math.h>
#include <string.h>

void normals_smooth(float *nx, float *ny, float *nz, const float *x, const float *y, const float *z,
                    uint32_t vertex_count, const uint32_t *triangle, uint32_t triangle_count)
{
    memset(nx, 0, vertex_count * sizeof *nx);
    memset(ny, 0, vertex_count * sizeof *ny);
    memset(nz, 0, vertex_count * sizeof *nz);
    for (uint32_t i = 0; i < triangle_count; ++i) {
        const uint32_t *corner = triangle + (size_t)i * 3;
        uint32_t a = corner[0], b = corner[1], c = corner[2];
        float ux = x[b] - x[a], uy = y[b] - y[a], uz = z[b] - z[a];
        float vx = x[c] - x[a], vy = y[c] - y[a], vz = z[c] - z[a];
        float cx = uy * vz - uz * vy;
        float cy = uz * vx - ux * vz;
        float cz = ux * vy - uy * vx;
        for (int k = 0; k < 3; ++k) {
            nx[corner[k]] += cx;
            ny[corner[k]] += cy;
            nz[corner[k]] += cz;
        }
    }
    for (uint32_t v = 0; v < vertex_count; ++v) {
        float square = nx[v] * nx[v] + ny[v] * ny[v] + nz[v] * nz[v];
        if (square > 1e-30f && isfinite(square)) {
            float inverse = 1.0f / sqrtf(square);
            nx[v] *= inverse;
            ny[v] *= inverse;
            nz[v] *= inverse;
        } else {
            nx[v] = 0.0f;
            ny[v] = 0.0f;
            nz[v] = 1.0f;
        }
    }
}
