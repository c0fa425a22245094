#include "csrbf/field.h"

#include "base/pool.h"
#include "csrbf/kernel.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Of the largest displacement: rounding noise that float evaluation may have. */
static const double noise_ratio = 1e-4;

static size_t up_to_lanes(size_t count)
{
    return (count + FIELD_LANES - 1) / FIELD_LANES * FIELD_LANES;
}

bool field_create(field *out, uint32_t centre_capacity)
{
    size_t room = (size_t)3 * centre_capacity + 1, stride = up_to_lanes(centre_capacity);
    *out = (field){.settings = {.radius = 1.0}, .lanes = lanes_now()};
    out->centre = calloc(room, sizeof *out->centre);
    out->alpha = calloc(room, sizeof *out->alpha);
    out->local_centre = calloc(room, sizeof *out->local_centre);
    out->local_alpha = calloc(room, sizeof *out->local_alpha);
    out->along[0] = calloc(3 * stride + 1, sizeof *out->along[0]);
    out->along[1] = out->along[0] ? out->along[0] + stride : NULL;
    out->along[2] = out->along[1] ? out->along[1] + stride : NULL;
    if (out->centre && out->alpha && out->along[0] && out->local_centre && out->local_alpha)
        return true;
    field_destroy(out);
    return false;
}

void field_destroy(field *f)
{
    if (!f)
        return;
    free(f->centre);
    free(f->alpha);
    free(f->along[0]);
    free(f->local_centre);
    free(f->local_alpha);
    *f = (field){0};
}

/* R^2 less what rounding to float may take off a squared distance when the centres are up to
 * `reach` from the origin: 8 roundings of reach + R. phi is below 1e-7 in what is cut off. */
static float float_limit(double radius, double reach)
{
    double margin = 8.0 / 16777216.0 * (1.0 + reach / radius);
    double inner = radius * (1.0 - (margin < 0.01 ? margin : 0.01));
    return (float)(inner * inner);
}

void field_begin(field *f)
{
    double reach = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        f->origin[axis] = (float)f->hull.centre[axis];
    for (size_t i = 0; i < f->centre_count; ++i)
        for (size_t axis = 0; axis < 3; ++axis) {
            f->along[axis][i] = f->centre[3 * i + axis];
            double local = f->centre[3 * i + axis] - (double)f->origin[axis];
            f->local_centre[3 * i + axis] = (float)local;
            reach = fabs(local) > reach ? fabs(local) : reach;
        }
    for (size_t i = f->centre_count; i < up_to_lanes(f->centre_count); ++i)
        f->along[0][i] = f->along[1][i] = f->along[2][i] = 1e300;
    f->local_limit = float_limit(f->settings.radius, reach);
    f->needs_double = false;
    memset(f->beta, 0, sizeof f->beta);
    memset(f->alpha, 0, (size_t)3 * f->centre_count * sizeof *f->alpha);
    memset(f->local_alpha, 0, (size_t)3 * f->centre_count * sizeof *f->local_alpha);
}

void field_set_alpha(field *f, const double *alpha, uint32_t stride, double largest_g)
{
    double sum = 0.0;
    for (size_t i = 0; i < f->centre_count; ++i)
        for (size_t axis = 0; axis < 3; ++axis) {
            double value = alpha[i * stride + axis];
            f->alpha[3 * i + axis] = value;
            f->local_alpha[3 * i + axis] = (float)value;
            sum += fabs(value);
        }
    f->needs_double = sum * 0x1p-24 > noise_ratio * largest_g;
}

void field_terms(const field *f, double out_term[4], const double x[3])
{
    double d[3];
    for (int axis = 0; axis < 3; ++axis)
        d[axis] = x[axis] - f->hull.centre[axis];
    out_term[0] = 1.0;
    for (uint32_t a = 1; a < f->term_count; ++a) {
        const double *u = f->hull.axis.at[a - 1];
        out_term[a] = (u[0] * d[0] + u[1] * d[1] + u[2] * d[2]) / f->settings.radius;
    }
}

void field_polynomial(const field *f, double out[3], const double x[3])
{
    double term[4];
    field_terms(f, term, x);
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = 0.0;
        for (uint32_t a = 0; a < f->term_count; ++a)
            out[axis] += f->beta[a][axis] * term[a];
    }
}

double field_limit(const field *f)
{
    return f->settings.radius * f->settings.radius * (1.0 - 0x1p-48);
}

static void displacement_at(const field *f, double out[3], const double x[3])
{
    double radius = f->settings.radius, outside = 1.0, limit = field_limit(f);
    memset(out, 0, 3 * sizeof *out);
    for (size_t i = 0; i < f->centre_count; ++i) {
        const double *c = f->centre + 3 * i, *alpha = f->alpha + 3 * i;
        double dx = x[0] - c[0], dy = x[1] - c[1], dz = x[2] - c[2];
        double q = dx * dx + dy * dy + dz * dz;
        if (q >= limit)
            continue;
        double weight = kernel_value(f->settings.kernel, sqrt(q) / radius);
        outside *= 1.0 - weight;
        for (int axis = 0; axis < 3; ++axis)
            out[axis] += weight * alpha[axis];
    }
    if (f->term_count == 0)
        return;
    double p[3], window = f->settings.polynomial == CSRBF_WINDOWED ? 1.0 - outside : 1.0;
    field_polynomial(f, p, x);
    for (int axis = 0; axis < 3; ++axis)
        out[axis] += window * p[axis];
}

void field_move_f64(const field *f, double *x, uint32_t count)
{
    for (size_t i = 0; i < count; ++i) {
        double d[3];
        displacement_at(f, d, x + 3 * i);
        for (size_t axis = 0; axis < 3; ++axis)
            if (d[axis] != 0.0)
                x[3 * i + axis] += d[axis];
    }
}

bool field_reaches(const field *f, uint32_t centre, const points_bounds *block)
{
    double radius = f->settings.radius;
    return points_bounds_distance_squared(block, f->centre + (size_t)3 * centre) < radius * radius;
}

static void copy_block(points *out, const points *in, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    memcpy(out->x + first, in->x + first, POINTS_BLOCK * sizeof(float));
    memcpy(out->y + first, in->y + first, POINTS_BLOCK * sizeof(float));
    memcpy(out->z + first, in->z + first, POINTS_BLOCK * sizeof(float));
    out->block[block] = in->block[block];
}

bool field_touches(const field *f, const points_bounds *block)
{
    bool global = f->term_count > 0 && f->settings.polynomial != CSRBF_WINDOWED;
    for (uint32_t centre = 0; centre < f->centre_count; ++centre)
        if (global || field_reaches(f, centre, block))
            return true;
    return false;
}

static bool block_displacement_f64(const field *f, float sum[3][POINTS_BLOCK], const points *in,
                                   uint32_t block)
{
    if (!field_touches(f, &in->block[block]))
        return false;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], d[3];
        points_at(x, in, (size_t)block * POINTS_BLOCK + i);
        displacement_at(f, d, x);
        for (int axis = 0; axis < 3; ++axis)
            sum[axis][i] = (float)d[axis];
    }
    return true;
}

bool field_in_block(const field *f, float sum[3][POINTS_BLOCK], const points *in, uint32_t block)
{
    return f->needs_double ? block_displacement_f64(f, sum, in, block)
                           : f->lanes->field_block(f, sum, in, block);
}

typedef struct move_work {
    const field *f;
    points *out;
    const points *in;
    _Atomic uint32_t moved; /* blocks */
} move_work;

static void move_blocks(void *data, uint32_t first, uint32_t end)
{
    move_work *w = data;
    uint32_t moved = 0;
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float sum[3][POINTS_BLOCK];
        if (field_in_block(w->f, sum, w->in, block)) {
            w->f->lanes->columns_add(w->out, w->in, sum, block);
            ++moved;
        } else if (w->out->x != w->in->x) {
            copy_block(w->out, w->in, block);
        }
    }
    atomic_fetch_add_explicit(&w->moved, moved, memory_order_relaxed);
}

double field_cost_ns(const field *f, uint32_t block_count)
{
    double each_ns = f->needs_double ? 6.0 : 0.3;
    return each_ns * POINTS_BLOCK * block_count * f->centre_count;
}

uint32_t field_move(const field *f, points *out, const points *in)
{
    move_work w = {.f = f, .out = out, .in = in};
    const pool_work work = {.run = move_blocks,
                            .data = &w,
                            .part_count = in->block_count,
                            .grain = FIELD_GRAIN,
                            .cost_ns = field_cost_ns(f, in->block_count)};
    pool_run(&work);
    return atomic_load(&w.moved);
}
