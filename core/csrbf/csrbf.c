#include "csrbf/csrbf.h"

#include "base/pool.h"
#include "csrbf/saddle.h"

#include <math.h>
#include <stdlib.h>

struct csrbf_solver {
    uint32_t centre_capacity;
    saddle saddle[2]; /* the current one, and one to factor into */
    uint32_t current;
    order_item *order_scratch; /* 3 by centre_capacity */
    double *rhs;               /* centre_capacity by SADDLE_SCRATCH */
};

csrbf_solver *csrbf_solver_create(uint32_t centre_capacity)
{
    csrbf_solver *solver = calloc(1, sizeof *solver);
    if (!solver)
        return NULL;
    pool_hold();
    size_t room = centre_capacity;
    solver->centre_capacity = centre_capacity;
    solver->order_scratch = calloc(3 * room + 1, sizeof *solver->order_scratch);
    solver->rhs = calloc(room * SADDLE_SCRATCH + 1, sizeof *solver->rhs);
    bool first_made = saddle_create(&solver->saddle[0], centre_capacity);
    bool second_made = saddle_create(&solver->saddle[1], centre_capacity);
    if (first_made && second_made && solver->order_scratch && solver->rhs)
        return solver;
    csrbf_solver_destroy(solver);
    return NULL;
}

void csrbf_solver_destroy(csrbf_solver *solver)
{
    if (!solver)
        return;
    saddle_destroy(&solver->saddle[0]);
    saddle_destroy(&solver->saddle[1]);
    free(solver->order_scratch);
    free(solver->rhs);
    free(solver);
    pool_release();
}

static saddle *in_use(csrbf_solver *solver)
{
    return &solver->saddle[solver->current];
}

static const field *field_of(const csrbf_solver *solver)
{
    return &solver->saddle[solver->current].field;
}

/* row: count by 3. */
static mrt_result check_rows(const char *what, const double *row, uint32_t count, error *err)
{
    for (uint32_t i = 0; i < count; ++i)
        for (size_t axis = 0; axis < 3; ++axis)
            if (!(fabs(row[(size_t)3 * i + axis]) <= (double)POINTS_REACH))
                return error_set(err, MRT_ERR_ARGUMENT, "control %u: %s %g is not within +-%g", i,
                                 what, row[(size_t)3 * i + axis], (double)POINTS_REACH);
    return MRT_OK;
}

mrt_result csrbf_factor(csrbf_solver *solver, const csrbf_settings *settings, const double *centre,
                        const csrbf_class *class, uint32_t count, error *err)
{
    if (count > solver->centre_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "%u controls: the solver has room for %u", count,
                         solver->centre_capacity);
    mrt_result result = csrbf_settings_check(settings, err);
    if (result >= 0)
        result = check_rows("position", centre, count, err);
    for (uint32_t i = 0; result >= 0 && class && i < count; ++i)
        if ((unsigned)class[i] > CSRBF_SKULL)
            result = error_set(err, MRT_ERR_ARGUMENT, "control %u: class %d is unknown", i,
                               (int)class[i]);
    if (result >= 0)
        result = saddle_factor(&solver->saddle[1 - solver->current], in_use(solver),
                               solver->order_scratch, settings, centre, class, count, err);
    if (result >= 0)
        solver->current = 1 - solver->current;
    return result;
}

mrt_result csrbf_check(const csrbf_solver *solver, const double *g, error *err)
{
    const saddle *s = &solver->saddle[solver->current];
    return check_rows("displacement", g, s->merge.control_count, err);
}

mrt_result csrbf_solve(csrbf_solver *solver, const double *g, error *err)
{
    mrt_result result = csrbf_check(solver, g, err);
    return result < 0 ? result : saddle_solve(in_use(solver), solver->rhs, g, err);
}

void csrbf_limit_gain(csrbf_solver *solver, const points *at, double limit)
{
    points_bounds box = points_extent(at);
    saddle_limit_gain(in_use(solver), &box, limit);
}

csrbf_diagnostics csrbf_diagnose(const csrbf_solver *solver)
{
    const saddle *s = &solver->saddle[solver->current];
    csrbf_diagnostics out = {.centre_count = s->field.centre_count,
                             .polynomial_terms = s->field.term_count,
                             .slope_bound = field_slope_bound(&s->field),
                             .polynomial_gain = s->gain,
                             .merged_apart = s->merged_apart};
    if (s->matrix.row_count > 0)
        out.envelope_count = (uint32_t)s->matrix.start[s->matrix.row_count];
    for (size_t i = 0; i < s->field.centre_count; ++i) {
        const double *a = s->field.alpha + 3 * i;
        out.alpha_sum += sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    }
    return out;
}

void csrbf_move_f64(const csrbf_solver *solver, double *x, uint32_t count)
{
    field_move_f64(field_of(solver), x, count);
}

uint32_t csrbf_move(const csrbf_solver *solver, points *out, const points *in)
{
    return field_move(field_of(solver), out, in);
}

double csrbf_min_determinant(const csrbf_solver *solver, const points *at)
{
    return field_min_determinant(field_of(solver), at);
}

double csrbf_max_slope(const csrbf_solver *solver, const points *at)
{
    return field_max_slope(field_of(solver), at);
}

void csrbf_measure(const csrbf_solver *solver, const points *at, double *out_slope,
                   double *out_determinant)
{
    field_measure(field_of(solver), at, out_slope, out_determinant);
}

bool csrbf_in_block(const csrbf_solver *solver, float sum[3][POINTS_BLOCK], const points *in,
                    uint32_t block)
{
    return field_in_block(field_of(solver), sum, in, block);
}

double csrbf_cost_ns(const csrbf_solver *solver, const points *in)
{
    return field_cost_ns(field_of(solver), in->block_count);
}

void csrbf_responses(const csrbf_solver *solver, float *out_response, size_t stride,
                     const points *in)
{
    csrbf_responses_in(solver, out_response, stride, in, NULL);
}

void csrbf_responses_in(const csrbf_solver *solver, float *out_response, size_t stride,
                        const points *in, const uint8_t *wanted)
{
    saddle_responses(&solver->saddle[solver->current], solver->rhs, out_response, stride, in,
                     wanted);
}
