#include "csrbf/shape.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    mrt_result result = columns_create(&s->response, &s->rest, control_capacity, err);
    if (result < 0)
        return result;
    s->solver = csrbf_solver_create(control_capacity);
    s->start = calloc(3 * controls + 1, sizeof *s->start);
    s->tip = calloc(3 * controls + 1, sizeof *s->tip);
    s->step = calloc(3 * controls + 1, sizeof *s->step);
    s->pull = calloc(3 * controls + 1, sizeof *s->pull);
    if (s->solver && s->start && s->tip && s->step && s->pull)
        return MRT_OK;
    return error_set(err, MRT_ERR_MEMORY, "no memory for %u controls", control_capacity);
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
    columns_destroy(&s->response);
    free(s->start);
    free(s->tip);
    free(s->step);
    free(s->pull);
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
    csrbf_responses(s->solver, s->response.value, s->response.stride, &s->base);
    columns_note(&s->response, count);
    if (count > 0)
        memcpy(s->start, start, (size_t)3 * count * sizeof *start);
    s->control_count = count;
    s->settings = *settings;
    return MRT_OK;
}

mrt_result shape_pull(shape *s, const double *displacement, error *err)
{
    if (s->control_count == 0)
        return MRT_OK;
    mrt_result result = csrbf_check(s->solver, displacement, err);
    if (result < 0)
        return result;
    columns_move(&s->response, &s->shown, &s->base, displacement);
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

static void leak_stream(float *restrict p, const float *restrict towards, uint32_t count,
                        float part)
{
    for (uint32_t i = 0; i < count; ++i) {
        float moved = p[i] + part * (towards[i] - p[i]);
        p[i] = towards[i] == p[i] ? p[i] : moved;
    }
}

void shape_ease(points *p, const points *towards, double rate_per_s, double dt_s)
{
    double amount = rate_per_s * dt_s;
    if (!(amount > 0.0 && amount <= 1e300))
        return;
    float part = (float)(1.0 - 1.0 / (1.0 + amount));
    leak_stream(p->x, towards->x, p->padded_count, part);
    leak_stream(p->y, towards->y, p->padded_count, part);
    leak_stream(p->z, towards->z, p->padded_count, part);
    points_update_bounds(p);
}

void shape_leak(shape *s, double rate_per_s, double dt_s)
{
    shape_ease(&s->shown, &s->base, rate_per_s, dt_s);
}

mrt_result shape_drag(shape *s, const csrbf_settings *settings, const double *from,
                      const double *to, uint32_t count, double *out_reached, shape_step *out_step,
                      error *err)
{
    const drag_layer layer = {.solver = s->solver, .control_count = count};
    const drag d = {.moved = &s->shown,
                    .before = &s->before,
                    .layer = &layer,
                    .layer_count = 1,
                    .control_capacity = s->control_capacity,
                    .tip = s->tip,
                    .step = s->step,
                    .pull = s->pull};
    const drag_way way = {.from = from, .to = to, .count = count};
    s->control_count = 0;
    return drag_along(&d, settings, &way, out_reached, out_step, err);
}

double shape_min_determinant(const shape *s, const double *displacement)
{
    if (s->control_count == 0)
        return 1.0;
    if (csrbf_solve(s->solver, displacement, NULL) < 0)
        return -(double)INFINITY;
    return csrbf_min_determinant(s->solver, &s->base);
}

double shape_slope_bound(const shape *s, const double *displacement)
{
    if (s->control_count == 0)
        return 0.0;
    if (csrbf_solve(s->solver, displacement, NULL) < 0)
        return (double)INFINITY;
    return csrbf_diagnose(s->solver).slope_bound;
}
