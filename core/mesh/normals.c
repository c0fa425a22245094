#include "mesh/normals.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Without branches, so that it runs on whole vectors. */
static void normalise(float *restrict nx, float *restrict ny, float *restrict nz,
                      uint32_t vertex_count)
{
    for (uint32_t v = 0; v < vertex_count; ++v) {
        float x = nx[v], y = ny[v], z = nz[v];
        float square = x * x + y * y + z * z;
        bool good = (square > 1e-30f) & (square <= FLT_MAX);
        float inverse = 1.0f / sqrtf(good ? square : 1.0f);
        nx[v] = good ? x * inverse : 0.0f;
        ny[v] = good ? y * inverse : 0.0f;
        nz[v] = good ? z * inverse : 1.0f;
    }
}

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
    normalise(nx, ny, nz, vertex_count);
}
