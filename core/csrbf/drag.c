/* The unanchored half of shape.h: a sample's way in substeps that do not fold. With the slope
 * L = 1.2 max |grad d| of what is left of the way, the next substep is that way over ceil(L / 0.5);
 * then the rest is looked at again. Theory: a step with L < 1 is a homeomorphism, and so is any
 * number of them. */
#include "csrbf/shape.h"

#include <math.h>
#include <string.h>

static const double safety = 1.2; /* the slope is sampled at the vertices only */
static const double slope_per_step = 0.5;

/* Number of equal substeps that the way in s->step asks for. The solver is factored at s->tip. */
static mrt_result steps_wanted(shape *s, double *out_steps, double *out_slope, error *err)
{
    mrt_result result = csrbf_solve(s->solver, s->step, err);
    if (result < 0)
        return result;
    *out_slope = csrbf_max_slope(s->solver, &s->shown);
    double steps = ceil(safety * *out_slope / slope_per_step);
    *out_steps = steps > 1.0 ? steps : 1.0;
    return MRT_OK;
}

/* s->step := from the tips to the next ones on their way, 1 / steps of what is left. */
static void shorten_step(shape *s, const double *to, size_t count, double steps)
{
    for (size_t i = 0; i < count; ++i) {
        double next = steps > 1.0 ? s->tip[i] + (to[i] - s->tip[i]) / steps : to[i];
        s->step[i] = next - s->tip[i];
    }
}

static void advance_tips(shape *s, const double *to, size_t count, double steps)
{
    for (size_t i = 0; i < count; ++i)
        s->tip[i] = steps > 1.0 ? s->tip[i] + (to[i] - s->tip[i]) / steps : to[i];
}

/* Adds up what the substeps of one sample do. */
typedef struct tally {
    shape_step step;
    uint64_t touched; /* blocks */
} tally;

static mrt_result move_shown(shape *s, tally *t, error *err)
{
    double determinant = csrbf_min_determinant(s->solver, &s->shown);
    if (t->step.substeps == 0 || determinant < t->step.min_determinant)
        t->step.min_determinant = determinant;
    t->touched += csrbf_move(s->solver, &s->shown, &s->shown);
    ++t->step.substeps;
    if (!points_are_usable(&s->shown))
        return error_set(err, MRT_ERR_UNSUPPORTED, "the shape would leave +-%g",
                         (double)POINTS_REACH);
    return MRT_OK;
}

static mrt_result take_substep(shape *s, const csrbf_settings *settings, const double *to,
                               uint32_t count, tally *t, double *out_steps, error *err)
{
    double slope = 0.0;
    mrt_result result = csrbf_factor(s->solver, settings, s->tip, NULL, count, err);
    if (result < 0)
        return result;
    csrbf_limit_gain(s->solver, &s->shown, SHAPE_GAIN_LIMIT);
    shorten_step(s, to, (size_t)3 * count, 1.0);
    result = steps_wanted(s, out_steps, &slope, err);
    if (result >= 0 && *out_steps > 1.0) {
        shorten_step(s, to, (size_t)3 * count, *out_steps);
        result = csrbf_solve(s->solver, s->step, err);
    }
    if (t->step.substeps == 0)
        t->step.max_slope = slope;
    if (result >= 0)
        result = move_shown(s, t, err);
    advance_tips(s, to, (size_t)3 * count, *out_steps);
    return result;
}

static mrt_result take_way(shape *s, const csrbf_settings *settings, const double *to,
                           uint32_t count, tally *t, error *err)
{
    double steps = 2.0;
    while (steps > 1.0 && t->step.substeps < SHAPE_SUBSTEP_CAP) {
        mrt_result result = take_substep(s, settings, to, count, t, &steps, err);
        if (result < 0)
            return result;
    }
    t->step.limited = steps > 1.0;
    return MRT_OK;
}

static mrt_result check_way(const shape *s, const double *from, const double *to, uint32_t count,
                            error *err)
{
    if (count > s->control_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "%u controls: the shape has room for %u", count,
                         s->control_capacity);
    for (size_t i = 0; i < (size_t)3 * count; ++i)
        if (!(fabs(from[i]) <= (double)POINTS_REACH && fabs(to[i]) <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "control %u: its way from %g to %g is not within +-%g",
                             (uint32_t)(i / 3), from[i], to[i], (double)POINTS_REACH);
    return MRT_OK;
}

static bool stays(const double *from, const double *to, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (from[i] != to[i])
            return false;
    return true;
}

mrt_result shape_drag(shape *s, const csrbf_settings *settings, const double *from,
                      const double *to, uint32_t count, double *out_reached, shape_step *out_step,
                      error *err)
{
    size_t numbers = (size_t)3 * count;
    tally t = {.step = {.min_determinant = 1.0}};
    *out_step = t.step;
    mrt_result result = check_way(s, from, to, count, err);
    if (result < 0)
        return result;
    s->control_count = 0;
    for (size_t i = 0; i < numbers; ++i)
        s->tip[i] = from[i];
    if (!stays(from, to, numbers)) {
        points_copy(&s->before, &s->shown);
        result = take_way(s, settings, to, count, &t, err);
    }
    if (result < 0) {
        points_copy(&s->shown, &s->before);
        return result;
    }
    *out_step = t.step;
    if (t.touched == 0)
        out_step->substeps = 0;
    if (out_reached && count > 0)
        memcpy(out_reached, s->tip, numbers * sizeof *out_reached);
    return MRT_OK;
}
