#include "csrbf/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, STAGGER = 16 }; /* floats between two rows of responses */

static mrt_result create_points(shape *s, const float *xyz, error *err)
{
    points *const all[] = {&s->rest, &s->base, &s->shown, &s->before};
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        mrt_result result = points_create(all[i], &s->order, xyz, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static mrt_result create_controls(shape *s, uint32_t control_capacity, error *err)
{
    size_t controls = control_capacity;
    s->control_capacity = control_capacity;
    s->response_stride = (size_t)s->rest.padded_count + STAGGER;
    if (controls < SIZE_MAX / sizeof(float) / s->response_stride - 1)
        s->response =
            aligned_alloc(ALIGNMENT, (controls + 1) * s->response_stride * sizeof *s->response);
    s->solver = csrbf_solver_create(control_capacity);
    s->start = calloc(3 * controls + 1, sizeof *s->start);
    s->tip = calloc(3 * controls + 1, sizeof *s->tip);
    s->step = calloc(3 * controls + 1, sizeof *s->step);
    if (s->response && s->solver && s->start && s->tip && s->step)
        return MRT_OK;
    return error_set(err, MRT_ERR_MEMORY, "no memory for %u controls on %u vertices",
                     control_capacity, s->rest.count);
}

mrt_result shape_create(shape *out, const float *xyz, uint32_t vertex_count,
                        uint32_t control_capacity, error *err)
{
    *out = (shape){0};
    mrt_result result = points_order_create(&out->order, xyz, vertex_count, err);
    if (result >= 0)
        result = create_points(out, xyz, err);
    if (result >= 0)
        result = create_controls(out, control_capacity, err);
    if (result < 0)
        shape_destroy(out);
    return result;
}

void shape_destroy(shape *s)
{
    if (!s)
        return;
    points_order_destroy(&s->order);
    points_destroy(&s->rest);
    points_destroy(&s->base);
    points_destroy(&s->shown);
    points_destroy(&s->before);
    csrbf_solver_destroy(s->solver);
    free(s->response);
    free(s->start);
    free(s->tip);
    free(s->step);
    *s = (shape){0};
}

static bool block_is_near(const points *p, uint32_t block, const double point[3], double limit)
{
    uint32_t first = block * POINTS_BLOCK;
    for (uint32_t i = first; i < first + POINTS_BLOCK && i < p->count; ++i) {
        double dx = (double)p->x[i] - point[0];
        double dy = (double)p->y[i] - point[1];
        double dz = (double)p->z[i] - point[2];
        if (dx * dx + dy * dy + dz * dz < limit)
            return true;
    }
    return false;
}

bool shape_is_near(const points *p, const double *point, uint32_t count, double radius)
{
    double limit = radius * radius;
    for (uint32_t i = 0; i < count; ++i)
        for (uint32_t block = 0; block < p->block_count; ++block) {
            const double *at = point + (size_t)3 * i;
            if (points_bounds_distance_squared(&p->block[block], at) < limit &&
                block_is_near(p, block, at, limit))
                return true;
        }
    return false;
}

mrt_result shape_engage(shape *s, const csrbf_settings *settings, const double *start,
                        uint32_t count, error *err)
{
    if (!points_are_usable(&s->shown))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the shape has left +-%g: reset it before engaging", (double)POINTS_REACH);
    mrt_result result = csrbf_factor(s->solver, settings, start, NULL, count, err);
    if (result < 0)
        return result;
    points_copy(&s->base, &s->shown);
    csrbf_limit_gain(s->solver, &s->base, SHAPE_GAIN_LIMIT);
    csrbf_responses(s->solver, s->response, s->response_stride, &s->base);
    if (count > 0)
        memcpy(s->start, start, (size_t)3 * count * sizeof *start);
    s->control_count = count;
    s->settings = *settings;
    return MRT_OK;
}

/* out = base + sum; where sum is zero the bits of base. */
static void add_row(float *restrict out, const float *restrict base, const float *restrict sum)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float moved = base[i] + sum[i];
        out[i] = sum[i] == 0.0f ? base[i] : moved;
    }
}

/* shown = base + sum_k B_k g_k for one block, k ascending. */
static void pull_block(shape *s, uint32_t block, const double *displacement)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    const float *response = s->response + first;
    float sum[3][POINTS_BLOCK] = {{0.0f}};
    for (size_t k = 0; k < s->control_count; ++k, response += s->response_stride) {
        const float gx = (float)displacement[3 * k];
        const float gy = (float)displacement[3 * k + 1];
        const float gz = (float)displacement[3 * k + 2];
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            sum[0][i] += response[i] * gx;
            sum[1][i] += response[i] * gy;
            sum[2][i] += response[i] * gz;
        }
    }
    add_row(s->shown.x + first, s->base.x + first, sum[0]);
    add_row(s->shown.y + first, s->base.y + first, sum[1]);
    add_row(s->shown.z + first, s->base.z + first, sum[2]);
}

mrt_result shape_pull(shape *s, const double *displacement, error *err)
{
    if (s->control_count == 0)
        return MRT_OK;
    mrt_result result = csrbf_solve(s->solver, displacement, err);
    if (result < 0)
        return result;
    for (uint32_t block = 0; block < s->base.block_count; ++block) {
        pull_block(s, block, displacement);
        points_update_block(&s->shown, block);
    }
    return MRT_OK;
}

void shape_commit(shape *s)
{
    points_copy(&s->base, &s->shown);
    s->control_count = 0;
}

void shape_reset(shape *s)
{
    points_copy(&s->base, &s->rest);
    points_copy(&s->shown, &s->rest);
    s->control_count = 0;
}

static void leak_stream(float *restrict shown, const float *restrict rest, uint32_t count,
                        float part)
{
    for (uint32_t i = 0; i < count; ++i) {
        float moved = shown[i] + part * (rest[i] - shown[i]);
        shown[i] = rest[i] == shown[i] ? shown[i] : moved;
    }
}

void shape_leak(shape *s, double rate_per_s, double dt_s)
{
    double amount = rate_per_s * dt_s;
    if (!(amount > 0.0 && amount <= 1e300))
        return;
    float part = (float)(1.0 - 1.0 / (1.0 + amount));
    leak_stream(s->shown.x, s->rest.x, s->shown.padded_count, part);
    leak_stream(s->shown.y, s->rest.y, s->shown.padded_count, part);
    leak_stream(s->shown.z, s->rest.z, s->shown.padded_count, part);
    points_update_bounds(&s->shown);
}

double shape_min_determinant(const shape *s, const double *displacement)
{
    if (s->control_count == 0)
        return 1.0;
    if (csrbf_solve(s->solver, displacement, NULL) < 0)
        return -INFINITY;
    return csrbf_min_determinant(s->solver, &s->base);
}

double shape_slope_bound(const shape *s, const double *displacement)
{
    if (s->control_count == 0)
        return 0.0;
    if (csrbf_solve(s->solver, displacement, NULL) < 0)
        return INFINITY;
    return csrbf_diagnose(s->solver).slope_bound;
}
