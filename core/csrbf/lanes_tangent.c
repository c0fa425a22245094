/* Derivatives of unit responses along tangents, in double. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"
#include "csrbf/lanes_reach.h"

#include <string.h>

/* out := grad phi of one centre along the direction. */
static void measure(double *restrict out, const field *f, uint32_t centre, const points *in,
                    const points *direction, uint32_t block)
{
    const double cx = f->along[0][centre], cy = f->along[1][centre], cz = f->along[2][centre];
    const double over_radius = 1.0 / f->settings.radius;
    size_t first = (size_t)block * POINTS_BLOCK;
    const float *x = in->x + first, *y = in->y + first, *z = in->z + first;
    const float *tx = direction->x + first, *ty = direction->y + first, *tz = direction->z + first;
    double q[POINTS_BLOCK], way[POINTS_BLOCK], slope[POINTS_BLOCK];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        double dx = (double)x[i] - cx, dy = (double)y[i] - cy, dz = (double)z[i] - cz;
        q[i] = dx * dx + dy * dy + dz * dz;
        way[i] = dx * (double)tx[i] + dy * (double)ty[i] + dz * (double)tz[i];
    }
    kernel_slopes_f64(f->settings.kernel, slope, q, over_radius, field_limit(f));
    for (int i = 0; i < POINTS_BLOCK; ++i)
        out[i] = slope[i] * over_radius * over_radius * way[i];
}

static void add_row(double *restrict sum, const double *restrict value, double weight)
{
    for (int i = 0; i < POINTS_BLOCK; ++i)
        sum[i] += value[i] * weight;
}

/* The linear terms of the polynomial: their derivatives are those of the coordinates. */
static void add_polynomial(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
                           const points *direction, uint32_t block)
{
    for (uint32_t term = 1; term < f->term_count; ++term) {
        const double *u = f->hull.axis.at[term - 1];
        double way[POINTS_BLOCK];
        for (size_t i = 0; i < POINTS_BLOCK; ++i) {
            double t[3];
            points_at(t, direction, (size_t)block * POINTS_BLOCK + i);
            way[i] = (u[0] * t[0] + u[1] * t[1] + u[2] * t[2]) / f->settings.radius;
        }
        for (uint32_t column = 0; column < r->count; ++column)
            add_row(sum[column], way, r->beta[term * r->stride + column]);
    }
}

void LANES(derivatives_block)(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
                              const points *in, const points *direction, uint32_t block)
{
    reach near;
    double value[POINTS_BLOCK];
    near.next = 0;
    memset(sum, 0, r->count * sizeof *sum);
    while (reach_more(&near, f, &in->block[block]))
        for (uint32_t k = 0; k < near.count; ++k) {
            measure(value, f, near.centre[k], in, direction, block);
            for (uint32_t column = 0; column < r->count; ++column)
                add_row(sum[column], value, r->alpha[near.centre[k] * r->stride + column]);
        }
    add_polynomial(f, r, sum, direction, block);
}
