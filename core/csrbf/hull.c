#include "csrbf/hull.h"

#include <math.h>

static const double flat_ratio = 1e-3;
static const double float_steps = 16.0 / 16777216.0; /* 16 x 2^-24 */

static void mean_of(double out[3], const double *point, uint32_t count)
{
    for (int axis = 0; axis < 3; ++axis) {
        double sum = 0.0;
        for (uint32_t i = 0; i < count; ++i)
            sum += point[3 * i + (uint32_t)axis];
        out[axis] = sum / (double)count;
    }
}

static void scatter_of(matrix3 *out, const double centre[3], const double *point, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        double d[3];
        for (int axis = 0; axis < 3; ++axis)
            d[axis] = point[3 * i + (uint32_t)axis] - centre[axis];
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out->at[a][b] += d[a] * d[b];
    }
}

static double largest_size(const double *value, uint32_t count)
{
    double largest = 0.0;
    for (uint32_t i = 0; i < count; ++i)
        largest = fabs(value[i]) > largest ? fabs(value[i]) : largest;
    return largest;
}

void hull_fit(hull *out, const double *point, uint32_t count)
{
    matrix3 scatter = {{{0}}};
    double spread[3];
    mean_of(out->centre, point, count);
    scatter_of(&scatter, out->centre, point, count);
    symmetric3_eigen(spread, &out->axis, &scatter);
    double extent = sqrt(spread[0] > 0.0 ? spread[0] : 0.0);
    double input_step = float_steps * largest_size(point, 3 * count);
    double flat = flat_ratio * extent > input_step ? flat_ratio * extent : input_step;
    out->dimension = 0;
    while (out->dimension < 3 && spread[out->dimension] > flat * flat)
        ++out->dimension;
}
