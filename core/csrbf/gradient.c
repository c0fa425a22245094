#include "csrbf/gradient.h"

#include "csrbf/kernel.h"

#include <math.h>
#include <string.h>

/* grad p: [a][b] is the derivative of p_a by x_b. */
static matrix3 polynomial_gradient(const field *f)
{
    matrix3 out = {{{0.0}}};
    for (uint32_t term = 1; term < f->term_count; ++term)
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out.at[a][b] +=
                    f->beta[term][a] * f->hull.axis.at[term - 1][b] / f->settings.radius;
    return out;
}

static void add_global_gradient(const field *f, gradient *out)
{
    const matrix3 slope = polynomial_gradient(f);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int i = 0; i < POINTS_BLOCK; ++i)
                out->row[a][b][i] += (float)slope.at[a][b];
}

/* The window and its gradient, for one block: starts as prod = 1, gradient 0. */
typedef struct window_rows {
    float outside[POINTS_BLOCK];     /* prod_i (1 - phi_i) */
    float gradient[3][POINTS_BLOCK]; /* of that product */
} window_rows;

static void window_times(window_rows *w, const float *weight, float step[3][POINTS_BLOCK])
{
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < POINTS_BLOCK; ++i)
            w->gradient[axis][i] =
                w->gradient[axis][i] * (1.0f - weight[i]) - w->outside[i] * step[axis][i];
    for (int i = 0; i < POINTS_BLOCK; ++i)
        w->outside[i] *= 1.0f - weight[i];
}

/* grad (W p) = W grad p + p grad W; p may be beyond float where W is 0. */
static void add_windowed_gradient(const field *f, gradient *out, const window_rows *w,
                                  const points *at, uint32_t block)
{
    const matrix3 slope = polynomial_gradient(f);
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], p[3];
        if (w->outside[i] == 1.0f)
            continue;
        points_at(x, at, (size_t)block * POINTS_BLOCK + i);
        field_polynomial(f, p, x);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out->row[a][b][i] += (1.0f - w->outside[i]) * (float)slope.at[a][b] -
                                     (float)p[a] * w->gradient[b][i];
    }
}

static bool gradient_f32(const field *f, gradient *out, const points *at, uint32_t block)
{
    field_rows rows;
    window_rows window = {{0}, {{0}}};
    float slope[POINTS_BLOCK], weight[POINTS_BLOCK], step[3][POINTS_BLOCK];
    float inverse_radius = (float)(1.0 / f->settings.radius);
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window.outside[i] = 1.0f;
    for (uint32_t centre = 0; centre < f->centre_count; ++centre) {
        if (!field_reaches(f, centre, &at->block[block]))
            continue;
        if (!reached)
            field_rows_load(f, &rows, at, block);
        reached = true;
        field_rows_from(f, &rows, centre);
        kernel_slopes_f32(f->settings.kernel, slope, rows.q, inverse_radius, f->local_limit);
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            float scaled = slope[i] * inverse_radius * inverse_radius;
            step[0][i] = scaled * rows.dx[i];
            step[1][i] = scaled * rows.dy[i];
            step[2][i] = scaled * rows.dz[i];
        }
        const float *alpha = f->local_alpha + (size_t)3 * centre;
        for (int a = 0; a < 3; ++a) {
            const float pull = alpha[a];
            for (int b = 0; b < 3; ++b)
                for (int i = 0; i < POINTS_BLOCK; ++i)
                    out->row[a][b][i] += pull * step[b][i];
        }
        if (!windowed)
            continue;
        kernel_values_f32(f->settings.kernel, weight, rows.q, inverse_radius, f->local_limit);
        window_times(&window, weight, step);
    }
    if (f->term_count == 0 || (windowed && !reached))
        return reached;
    if (windowed)
        add_windowed_gradient(f, out, &window, at, block);
    else
        add_global_gradient(f, out);
    return true;
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
    const matrix3 slope = polynomial_gradient(f);
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
    return f->needs_double ? gradient_f64(f, out, at, block) : gradient_f32(f, out, at, block);
}
