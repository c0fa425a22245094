/* A naive deformation: the paper's formula in float, one vertex after the other. Built with -O2 and
 * no other options (ui/CMakeLists.txt). */
#include "bench/bench.h"

#include <math.h>

/* Gauss elimination without pivoting: the matrix of a positive definite kernel needs none. */
static void solve(double matrix[BENCH_CONTROLS][BENCH_CONTROLS], double rhs[BENCH_CONTROLS][3])
{
    for (int row = 0; row < BENCH_CONTROLS; ++row)
        for (int below = row + 1; below < BENCH_CONTROLS; ++below) {
            double factor = matrix[below][row] / matrix[row][row];
            for (int i = row; i < BENCH_CONTROLS; ++i)
                matrix[below][i] -= factor * matrix[row][i];
            for (int axis = 0; axis < 3; ++axis)
                rhs[below][axis] -= factor * rhs[row][axis];
        }
    for (int row = BENCH_CONTROLS - 1; row >= 0; --row)
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = row + 1; i < BENCH_CONTROLS; ++i)
                rhs[row][axis] -= matrix[row][i] * rhs[i][axis];
            rhs[row][axis] /= matrix[row][row];
        }
}

static double wendland_c2(double r)
{
    double t = r < 1.0 ? 1.0 - r : 0.0;
    return t * t * t * t * (4.0 * r + 1.0);
}

void bench_naive_init(bench_naive *out, const bench_plane *plane, double radius_mm)
{
    double matrix[BENCH_CONTROLS][BENCH_CONTROLS], rhs[BENCH_CONTROLS][3];
    *out = (bench_naive){.plane = plane, .radius_mm = (float)radius_mm};
    for (int i = 0; i < BENCH_CONTROLS; ++i)
        for (int j = 0; j < BENCH_CONTROLS; ++j) {
            double dx = bench_control[3 * i] - bench_control[3 * j];
            double dy = bench_control[3 * i + 1] - bench_control[3 * j + 1];
            matrix[i][j] = wendland_c2(sqrt(dx * dx + dy * dy) / radius_mm);
        }
    for (int i = 0; i < BENCH_CONTROLS; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            rhs[i][axis] = bench_pull[3 * i + axis];
            out->centre[3 * i + axis] = (float)bench_control[3 * i + axis];
        }
    solve(matrix, rhs);
    for (int i = 0; i < BENCH_CONTROLS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            out->alpha[3 * i + axis] = (float)rhs[i][axis];
}

void bench_naive_run(void *naive)
{
    const bench_naive *self = naive;
    for (size_t v = 0; v < self->plane->vertex_count; ++v) {
        const float *at = self->plane->xyz + 3 * v;
        float *out = self->plane->moved + 3 * v;
        float moved[3] = {at[0], at[1], at[2]};
        for (size_t k = 0; k < BENCH_CONTROLS; ++k) {
            const float *c = self->centre + 3 * k, *a = self->alpha + 3 * k;
            float dx = at[0] - c[0], dy = at[1] - c[1], dz = at[2] - c[2];
            float r = sqrtf(dx * dx + dy * dy + dz * dz) / self->radius_mm;
            if (r >= 1.0f)
                continue;
            float t = 1.0f - r;
            float phi = t * t * t * t * (4.0f * r + 1.0f);
            moved[0] += phi * a[0];
            moved[1] += phi * a[1];
            moved[2] += phi * a[2];
        }
        out[0] = moved[0];
        out[1] = moved[1];
        out[2] = moved[2];
    }
}
