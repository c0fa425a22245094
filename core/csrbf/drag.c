/* A sample's way in substeps that do not fold. With the slope L = 1.2 max |grad d| of what is left
 * of the way, the next substep is that way over ceil(L / 0.5); then the rest is looked at again.
 * Theory: a step with L < 1 is a homeomorphism, and so is any number of them. */
#include "csrbf/drag.h"

#include "base/pool.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

static const double safety = 1.2; /* the slope is sampled at the vertices only */
static const double slope_per_step = 0.5;

/* Adds up what the substeps of one sample do. */
typedef struct tally {
    shape_step step;
    uint64_t touched; /* blocks */
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

/* How hard the fields bend space: the worst of all layers. */
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

/* Number of equal substeps that a way with this slope asks for. */
static double steps_wanted(double slope)
{
    double steps = ceil(safety * slope / slope_per_step);
    return steps > 1.0 ? steps : 1.0;
}

/* d->step := what is solved for on the way to the next tips, 1 / steps of what is left. */
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
    _Atomic uint32_t touched; /* blocks */
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

static mrt_result take_substep(const drag *d, const csrbf_settings *settings, const drag_way *way,
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

static mrt_result take_way(const drag *d, const csrbf_settings *settings, const drag_way *way,
                           tally *t, error *err)
{
    double steps = 2.0;
    while (steps > 1.0 && t->step.substeps < SHAPE_SUBSTEP_CAP) {
        mrt_result result = take_substep(d, settings, way, t, &steps, err);
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
        result = take_way(d, settings, way, &t, err);
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
