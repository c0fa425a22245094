#include "csrbf/gradient.h"

#include "csrbf/kernel.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <string.h>

matrix3 gradient_polynomial(const field *f)
{
    matrix3 out = {{{0.0}}};
    for (uint32_t term = 1; term < f->term_count; ++term)
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out.at[a][b] +=
                    f->beta[term][a] * f->hull.axis.at[term - 1][b] / f->settings.radius;
    return out;
}

/* Adds alpha (x) step, step the gradient of one phi. */
static void add_outer(matrix3 *out, const double alpha[3], const double step[3])
{
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            out->at[a][b] += alpha[a] * step[b];
}

/* grad d at one place. */
static matrix3 gradient_at(const field *f, const double x[3])
{
    matrix3 out = {{{0.0}}};
    double radius = f->settings.radius, outside = 1.0, outside_step[3] = {0.0};
    for (size_t i = 0; i < f->centre_count; ++i) {
        const double *c = f->centre + 3 * i;
        double d[3] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
        double q = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (q >= field_limit(f))
            continue;
        double weight = kernel_value(f->settings.kernel, sqrt(q) / radius);
        double slope = kernel_slope(f->settings.kernel, sqrt(q) / radius) / radius / radius;
        double step[3] = {slope * d[0], slope * d[1], slope * d[2]};
        add_outer(&out, f->alpha + 3 * i, step);
        for (int axis = 0; axis < 3; ++axis)
            outside_step[axis] = outside_step[axis] * (1.0 - weight) - outside * step[axis];
        outside *= 1.0 - weight;
    }
    if (f->term_count == 0)
        return out;
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED;
    const matrix3 slope = gradient_polynomial(f);
    double p[3], window_step[3] = {0.0}, window = windowed ? 1.0 - outside : 1.0;
    field_polynomial(f, p, x);
    for (int axis = 0; axis < 3 && windowed; ++axis)
        window_step[axis] = -outside_step[axis];
    add_outer(&out, p, window_step);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            out.at[a][b] += window * slope.at[a][b];
    return out;
}

static bool gradient_f64(const field *f, gradient *out, const points *at, uint32_t block)
{
    memset(out, 0, sizeof *out);
    if (!field_touches(f, &at->block[block]))
        return false;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3];
        points_at(x, at, (size_t)block * POINTS_BLOCK + i);
        const matrix3 m = gradient_at(f, x);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out->row[a][b][i] = (float)m.at[a][b];
    }
    return true;
}

bool gradient_of(const field *f, gradient *out, const points *at, uint32_t block)
{
    return f->needs_double ? gradient_f64(f, out, at, block)
                           : f->lanes->gradient_block(f, out, at, block);
}
