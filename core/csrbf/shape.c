#include "csrbf/shape.h"

#include "base/pool.h"
#include "csrbf/field.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- the unanchored way: drags ---- */

/* Divides the way of a sample into substeps that do not fold. Let the slope L = 1.2 max |grad d| of
 * the remaining way. The next substep is that way divided by ceil(L / 0.5). Then the rest is
 * examined again. Theory: a step with L < 1 is a homeomorphism, and so is any sequence of them. */

static const double safety = 1.2; /* the slope is sampled at the vertices only */
static const double slope_per_step = 0.5;

/* Totals over the substeps of one sample. */
typedef struct tally {
    shape_step step;
    uint64_t touched; /* number of blocks */
} tally;

/* d->pull := the layer's rows of `row` (control capacity by 3). */
static void gather(const drag *d, const drag_layer *layer, const double *row)
{
    for (size_t i = 0; i < layer->control_count; ++i) {
        size_t from = layer->control ? layer->control[i] : i;
        memcpy(d->pull + 3 * i, row + 3 * from, 3 * sizeof *row);
    }
}

static mrt_result factor_at_tips(const drag *d, const csrbf_settings *settings, error *err)
{
    for (uint32_t i = 0; i < d->layer_count; ++i) {
        const drag_layer *layer = &d->layer[i];
        gather(d, layer, d->tip);
        mrt_result result =
            csrbf_factor(layer->solver, settings, d->pull, NULL, layer->control_count, err);
        if (result < 0)
            return result;
        csrbf_limit_gain(layer->solver, d->moved, SHAPE_GAIN_LIMIT);
    }
    return MRT_OK;
}

static mrt_result solve_step(const drag *d, error *err)
{
    for (uint32_t i = 0; i < d->layer_count; ++i) {
        gather(d, &d->layer[i], d->step);
        mrt_result result = csrbf_solve(d->layer[i].solver, d->pull, err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

/* Distortion of space by the fields: the worst of all layers. */
typedef struct bend {
    double slope, determinant;
} bend;

static bend measure_fields(const drag *d)
{
    bend worst = {.slope = 0.0, .determinant = 1.0};
    for (uint32_t i = 0; i < d->layer_count; ++i) {
        bend own;
        csrbf_measure(d->layer[i].solver, d->moved, &own.slope, &own.determinant);
        worst.slope = fmax(worst.slope, own.slope);
        if (i == 0 || own.determinant < worst.determinant)
            worst.determinant = own.determinant;
    }
    return worst;
}

static double measure_determinant(const drag *d)
{
    double smallest = 1.0;
    for (uint32_t i = 0; i < d->layer_count; ++i) {
        double own = csrbf_min_determinant(d->layer[i].solver, d->moved);
        smallest = i == 0 || own < smallest ? own : smallest;
    }
    return smallest;
}

/* Returns the number of equal substeps that a way with this slope needs. */
static double steps_wanted(double slope)
{
    double steps = ceil(safety * slope / slope_per_step);
    return steps > 1.0 ? steps : 1.0;
}

/* d->step := displacements to solve for, on the way to the next tips: 1 / steps of the remaining
 * way. */
static void shorten_step(const drag *d, const drag_way *way, double steps)
{
    for (size_t i = 0; i < (size_t)3 * way->count; ++i) {
        double tip = d->tip[i], to = way->to[i];
        double next = steps > 1.0 ? tip + (to - tip) / steps : to;
        d->step[i] = way->gain ? (next - tip) * way->gain[i / 3] : next - tip;
    }
}

static void advance_tips(const drag *d, const drag_way *way, double steps)
{
    for (size_t i = 0; i < (size_t)3 * way->count; ++i) {
        double tip = d->tip[i], to = way->to[i];
        d->tip[i] = steps > 1.0 ? tip + (to - tip) / steps : to;
    }
}

/* total += weight times the layer's field in one block. */
static bool add_layer(const drag *d, const lanes *l, const drag_layer *layer,
                      float total[3][POINTS_BLOCK], uint32_t block)
{
    _Alignas(64) float sum[3][POINTS_BLOCK];
    if ((layer->wanted && !layer->wanted[block]) ||
        !csrbf_in_block(layer->solver, sum, d->moved, block))
        return false;
    l->add_weighted(total, layer->weight + (size_t)block * POINTS_BLOCK, sum);
    return true;
}

typedef struct layers_work {
    const drag *d;
    _Atomic uint32_t touched; /* number of blocks */
} layers_work;

static void move_blocks(void *data, uint32_t first, uint32_t end)
{
    layers_work *w = data;
    const drag *d = w->d;
    const lanes *l = lanes_now();
    uint32_t touched = 0;
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float total[3][POINTS_BLOCK] = {{0.0f}};
        bool reached = false;
        for (uint32_t i = 0; i < d->layer_count; ++i)
            reached = add_layer(d, l, &d->layer[i], total, block) || reached;
        if (!reached)
            continue;
        l->columns_add(d->moved, d->moved, total, block);
        ++touched;
    }
    atomic_fetch_add_explicit(&w->touched, touched, memory_order_relaxed);
}

static uint32_t move_by_layers(const drag *d)
{
    layers_work w = {.d = d};
    pool_work work = {
        .run = move_blocks, .data = &w, .part_count = d->moved->block_count, .grain = FIELD_GRAIN};
    for (uint32_t i = 0; i < d->layer_count; ++i)
        work.cost_ns += csrbf_cost_ns(d->layer[i].solver, d->moved);
    pool_run(&work);
    return atomic_load(&w.touched);
}

static mrt_result move_vertices(const drag *d, tally *t, double determinant, error *err)
{
    if (t->step.substeps == 0 || determinant < t->step.min_determinant)
        t->step.min_determinant = determinant;
    t->touched += d->layer_count == 1 && !d->layer[0].weight
                      ? csrbf_move(d->layer[0].solver, d->moved, d->moved)
                      : move_by_layers(d);
    ++t->step.substeps;
    if (!points_are_usable(d->moved))
        return error_set(err, MRT_ERR_UNSUPPORTED, "the shape would leave +-%g",
                         (double)POINTS_REACH);
    return MRT_OK;
}

static mrt_result move_substep(const drag *d, const csrbf_settings *settings, const drag_way *way,
                               tally *t, double *out_steps, error *err)
{
    mrt_result result = factor_at_tips(d, settings, err);
    if (result < 0)
        return result;
    shorten_step(d, way, 1.0);
    result = solve_step(d, err);
    if (result < 0)
        return result;
    bend whole = measure_fields(d);
    *out_steps = settings->is_one_step ? 1.0 : steps_wanted(whole.slope);
    if (t->step.substeps == 0)
        t->step.max_slope = whole.slope;
    if (*out_steps > 1.0) {
        shorten_step(d, way, *out_steps);
        result = solve_step(d, err);
        if (result < 0)
            return result;
        whole.determinant = measure_determinant(d);
    }
    result = move_vertices(d, t, whole.determinant, err);
    advance_tips(d, way, *out_steps);
    return result;
}

static mrt_result follow_way(const drag *d, const csrbf_settings *settings, const drag_way *way,
                             tally *t, error *err)
{
    double steps = 2.0;
    while (steps > 1.0 && t->step.substeps < SHAPE_SUBSTEP_CAP) {
        mrt_result result = move_substep(d, settings, way, t, &steps, err);
        if (result < 0)
            return result;
    }
    t->step.limited = steps > 1.0;
    return MRT_OK;
}

static mrt_result check_way(const drag *d, const drag_way *way, error *err)
{
    if (way->count > d->control_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "%u controls: the shape has room for %u",
                         way->count, d->control_capacity);
    for (size_t i = 0; i < (size_t)3 * way->count; ++i) {
        double from = way->from[i], to = way->to[i];
        if (!(fabs(from) <= (double)POINTS_REACH && fabs(to) <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "control %u: its way from %g to %g is not within +-%g",
                             (uint32_t)(i / 3), from, to, (double)POINTS_REACH);
    }
    return MRT_OK;
}

static bool stays(const drag_way *way)
{
    for (size_t i = 0; i < (size_t)3 * way->count; ++i)
        if (way->from[i] != way->to[i])
            return false;
    return true;
}

mrt_result drag_along(const drag *d, const csrbf_settings *settings, const drag_way *way,
                      double *out_reached, shape_step *out_step, error *err)
{
    tally t = {.step = {.min_determinant = 1.0}};
    *out_step = t.step;
    mrt_result result = check_way(d, way, err);
    if (result < 0)
        return result;
    for (size_t i = 0; i < (size_t)3 * way->count; ++i)
        d->tip[i] = way->from[i];
    if (!stays(way)) {
        points_copy(d->before, d->moved);
        result = follow_way(d, settings, way, &t, err);
    }
    if (result < 0) {
        points_copy(d->moved, d->before);
        return result;
    }
    *out_step = t.step;
    if (t.touched == 0)
        out_step->substeps = 0;
    if (out_reached && way->count > 0)
        memcpy(out_reached, d->tip, (size_t)3 * way->count * sizeof *out_reached);
    return MRT_OK;
}

/* ---- a shape ---- */

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
