#include "csrbf/soften.h"

#include "csrbf/kernel.h"

#include <math.h>
#include <string.h>

static const double least_pivot = 1e-9; /* for two centres at one point */

static double distance(const double *a, const double *b)
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z);
}

/* Computes the lower Cholesky factor in place, row by row. */
static void factor(double *matrix, uint32_t count)
{
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j <= i; ++j) {
            double sum = matrix[i * count + j];
            for (size_t k = 0; k < j; ++k)
                sum -= matrix[i * count + k] * matrix[j * count + k];
            matrix[i * count + j] =
                i > j ? sum / matrix[j * count + j] : sqrt(sum > least_pivot ? sum : least_pivot);
        }
}

static void solve(double *x, const double *matrix, uint32_t count)
{
    for (size_t i = 0; i < count; ++i)
        for (size_t axis = 0; axis < 3; ++axis) {
            for (size_t k = 0; k < i; ++k)
                x[3 * i + axis] -= matrix[i * count + k] * x[3 * k + axis];
            x[3 * i + axis] /= matrix[i * count + i];
        }
    for (size_t i = count; i-- > 0;)
        for (size_t axis = 0; axis < 3; ++axis) {
            for (size_t k = i + 1; k < count; ++k)
                x[3 * i + axis] -= matrix[k * count + i] * x[3 * k + axis];
            x[3 * i + axis] /= matrix[i * count + i];
        }
}

void csrbf_soften(double *g, const csrbf_settings *settings, const double *centre,
                  const double *likeness, const double *ridge, uint32_t count, double *scratch)
{
    double *matrix = scratch, *x = scratch + (size_t)count * count;
    for (size_t i = 0; i < count; ++i) {
        for (size_t j = 0; j < i; ++j)
            matrix[i * count + j] =
                likeness[i * count + j] *
                kernel_value(settings->kernel,
                             distance(centre + 3 * i, centre + 3 * j) / settings->radius);
        matrix[i * count + i] = 1.0 + ridge[i];
    }
    memcpy(x, g, (size_t)3 * count * sizeof *g);
    factor(matrix, count);
    solve(x, matrix, count);
    for (size_t i = 0; i < count; ++i)
        for (size_t axis = 0; axis < 3; ++axis)
            if (ridge[i] > 0.0)
                g[3 * i + axis] -= ridge[i] * x[3 * i + axis];
}
