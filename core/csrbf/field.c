#include "csrbf/field.h"

#include "csrbf/columns.h"
#include "csrbf/kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the largest displacement: rounding noise that float evaluation may have. */
static const double noise_ratio = 1e-4;

bool field_create(field *out, uint32_t centre_capacity)
{
    size_t room = (size_t)3 * centre_capacity + 1;
    *out = (field){.settings = {.radius = 1.0}};
    out->centre = calloc(room, sizeof *out->centre);
    out->alpha = calloc(room, sizeof *out->alpha);
    out->local_centre = calloc(room, sizeof *out->local_centre);
    out->local_alpha = calloc(room, sizeof *out->local_alpha);
    if (out->centre && out->alpha && out->local_centre && out->local_alpha)
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
            double local = f->centre[3 * i + axis] - (double)f->origin[axis];
            f->local_centre[3 * i + axis] = (float)local;
            reach = fabs(local) > reach ? fabs(local) : reach;
        }
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

void field_rows_load(const field *f, field_rows *rows, const points *in, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    const float *x = in->x + first, *y = in->y + first, *z = in->z + first;
    const float ox = f->origin[0], oy = f->origin[1], oz = f->origin[2];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        rows->x[i] = x[i] - ox;
        rows->y[i] = y[i] - oy;
        rows->z[i] = z[i] - oz;
    }
}

void field_rows_from(const field *f, field_rows *rows, uint32_t centre)
{
    const float *c = f->local_centre + (size_t)3 * centre;
    const float cx = c[0], cy = c[1], cz = c[2];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float dx = rows->x[i] - cx, dy = rows->y[i] - cy, dz = rows->z[i] - cz;
        rows->dx[i] = dx;
        rows->dy[i] = dy;
        rows->dz[i] = dz;
        rows->q[i] = dx * dx + dy * dy + dz * dz;
    }
}

/* sum: 3 by POINTS_BLOCK. Adds window times p, which may be beyond float where window is 0. */
static void add_polynomial(const field *f, float sum[3][POINTS_BLOCK], const float *window,
                           const points *in, uint32_t block)
{
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], p[3];
        if (window[i] == 0.0f)
            continue;
        points_at(x, in, (size_t)block * POINTS_BLOCK + i);
        field_polynomial(f, p, x);
        for (int axis = 0; axis < 3; ++axis)
            sum[axis][i] += window[i] * (float)p[axis];
    }
}

/* False when d is zero all over the block; sum is set then, too. */
static bool block_displacement(const field *f, float sum[3][POINTS_BLOCK], const points *in,
                               uint32_t block)
{
    field_rows rows;
    float weight[POINTS_BLOCK], window[POINTS_BLOCK];
    float inverse_radius = (float)(1.0 / f->settings.radius);
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    memset(sum, 0, 3 * sizeof *sum);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window[i] = 1.0f;
    for (uint32_t centre = 0; centre < f->centre_count; ++centre) {
        if (!field_reaches(f, centre, &in->block[block]))
            continue;
        if (!reached)
            field_rows_load(f, &rows, in, block);
        reached = true;
        field_rows_from(f, &rows, centre);
        kernel_values_f32(f->settings.kernel, weight, rows.q, inverse_radius, f->local_limit);
        const float *alpha = f->local_alpha + (size_t)3 * centre;
        const float ax = alpha[0], ay = alpha[1], az = alpha[2];
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            sum[0][i] += weight[i] * ax;
            sum[1][i] += weight[i] * ay;
            sum[2][i] += weight[i] * az;
        }
        for (int i = 0; windowed && i < POINTS_BLOCK; ++i)
            window[i] *= 1.0f - weight[i];
    }
    if (f->term_count == 0 || (windowed && !reached))
        return reached;
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window[i] = windowed ? 1.0f - window[i] : 1.0f;
    add_polynomial(f, sum, window, in, block);
    return true;
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
                           : block_displacement(f, sum, in, block);
}

uint32_t field_move(const field *f, points *out, const points *in)
{
    uint32_t moved = 0;
    for (uint32_t block = 0; block < in->block_count; ++block) {
        float sum[3][POINTS_BLOCK];
        if (field_in_block(f, sum, in, block)) {
            columns_add(out, in, sum, block);
            ++moved;
        } else if (out->x != in->x) {
            copy_block(out, in, block);
        }
    }
    return moved;
}
