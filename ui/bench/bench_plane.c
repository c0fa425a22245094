#include "bench/bench_plane.h"

#include <stdlib.h>

static const double side_mm = 66.12;

const double bench_radius_mm[BENCH_RADII] = {10.0, 20.0, 40.0, 60.0, 80.0};

const double bench_control[BENCH_CONTROLS * 3] = {
    3.01,   19.56, 0.0, -3.01, 19.56, 0.0, 8.19,  9.01, 0.0, -8.19, 9.01,  0.0, 26.86,  9.52,  0.0,
    -26.86, 9.52,  0.0, 8.97,  0.71,  0.0, -8.97, 0.71, 0.0, 26.94, 29.64, 0.0, -26.94, 29.64, 0.0};

const double bench_pull[BENCH_CONTROLS * 3] = {
    0.4,  -0.3, 1.0, -0.4, -0.3, 1.0, 0.2, 0.5,  -1.2, -0.2, 0.5, -1.2, 0.6, 0.1, 1.4,
    -0.6, 0.1,  1.4, 0.0,  -0.6, 0.8, 0.0, -0.6, 0.8,  -0.3, 0.2, -1.0, 0.3, 0.2, -1.0};

static float coordinate(uint32_t half_steps, uint32_t quads)
{
    return (float)(((double)half_steps - (double)quads) * side_mm / (2.0 * (double)quads));
}

static void put_vertex(float *row, uint32_t half_column, uint32_t half_row, uint32_t quads)
{
    row[0] = coordinate(half_column, quads);
    row[1] = coordinate(half_row, quads);
    row[2] = 0.0f;
}

static void put_vertices(bench_plane *self, uint32_t quads, bool has_centres)
{
    float *row = self->xyz;
    for (uint32_t y = 0; y <= quads; ++y)
        for (uint32_t x = 0; x <= quads; ++x, row += 3)
            put_vertex(row, 2 * x, 2 * y, quads);
    for (uint32_t y = 0; has_centres && y < quads; ++y)
        for (uint32_t x = 0; x < quads; ++x, row += 3)
            put_vertex(row, 2 * x + 1, 2 * y + 1, quads);
}

static uint32_t *put_triangle(uint32_t *at, uint32_t a, uint32_t b, uint32_t c)
{
    at[0] = a;
    at[1] = b;
    at[2] = c;
    return at + 3;
}

static void put_triangles(bench_plane *self, uint32_t quads, bool has_centres)
{
    uint32_t *at = self->triangle, stride = quads + 1;
    for (uint32_t y = 0; y < quads; ++y)
        for (uint32_t x = 0; x < quads; ++x) {
            uint32_t a = y * stride + x, b = a + 1, c = b + stride, d = a + stride;
            uint32_t middle = stride * stride + y * quads + x;
            if (!has_centres) {
                at = put_triangle(at, a, b, c);
                at = put_triangle(at, a, c, d);
                continue;
            }
            at = put_triangle(at, a, b, middle);
            at = put_triangle(at, b, c, middle);
            at = put_triangle(at, c, d, middle);
            at = put_triangle(at, d, a, middle);
        }
}

mrt_result bench_plane_create(bench_plane *out, uint32_t quads, bool has_centres, error *err)
{
    uint32_t row = quads + 1, per_quad = has_centres ? 4 : 2;
    *out = (bench_plane){.vertex_count = row * row + (has_centres ? quads * quads : 0),
                         .triangle_count = quads * quads * per_quad};
    out->xyz = malloc((size_t)out->vertex_count * 3 * sizeof *out->xyz);
    out->moved = calloc((size_t)out->vertex_count * 3, sizeof *out->moved);
    out->triangle = malloc((size_t)out->triangle_count * 3 * sizeof *out->triangle);
    if (!out->xyz || !out->moved || !out->triangle) {
        bench_plane_destroy(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a plane of %u quads a side", quads);
    }
    put_vertices(out, quads, has_centres);
    put_triangles(out, quads, has_centres);
    return MRT_OK;
}

void bench_plane_destroy(bench_plane *self)
{
    free(self->xyz);
    free(self->moved);
    free(self->triangle);
    *self = (bench_plane){0};
}

uint64_t bench_plane_pairs(const bench_plane *self, double radius_mm)
{
    uint64_t pairs = 0;
    for (size_t v = 0; v < self->vertex_count; ++v)
        for (size_t k = 0; k < BENCH_CONTROLS; ++k) {
            double dx = (double)self->xyz[3 * v] - bench_control[3 * k];
            double dy = (double)self->xyz[3 * v + 1] - bench_control[3 * k + 1];
            pairs += dx * dx + dy * dy <= radius_mm * radius_mm;
        }
    return pairs;
}
