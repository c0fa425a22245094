#include "face/frame/shape_solve.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double settled = 1e-7; /* step of a weight below which the solve ends */
static const double pivot_least = 1e-12;

static double clamped(double value, double low, double high)
{
    return value < low ? low : (value > high ? high : value);
}

/* Adds `by` times row i of H to slope. */
static void add_row(double *restrict slope, const shape_problem *p, uint32_t i, double by)
{
    const double *restrict row = p->h + (size_t)i * p->count;
    for (uint32_t j = 0; j < p->count; ++j)
        slope[j] += by * row[j];
}

/* Computes the gradient H w - b. */
static void find_slope(double *slope, const double *w, const shape_problem *p)
{
    for (uint32_t i = 0; i < p->count; ++i)
        slope[i] = -p->b[i];
    for (uint32_t i = 0; i < p->count; ++i)
        if (w[i] != 0.0)
            add_row(slope, p, i, w[i]);
}

/* Sets each weight in turn to its own optimum. Returns the greatest step. */
static double sweep(double *w, double *slope, const shape_problem *p)
{
    double greatest = 0.0;
    for (uint32_t i = 0; i < p->count; ++i) {
        double curve = p->h[(size_t)i * p->count + i];
        double to = curve > 0.0 ? clamped(w[i] - slope[i] / curve, p->low[i], p->high[i]) : w[i];
        double step = to - w[i];
        if (step == 0.0)
            continue;
        w[i] = to;
        add_row(slope, p, i, step);
        greatest = fmax(greatest, fabs(step));
    }
    return greatest;
}

/* Factors the free rows and columns of H by Cholesky. Computes the step -H^-1 slope for them. */
static bool newton(double *step, double *factor, const uint32_t *free, uint32_t count,
                   const double *slope, const shape_problem *p)
{
    for (uint32_t i = 0; i < count; ++i) {
        double *row = factor + (size_t)i * SHAPE_SOLVE_FREE_MAX;
        for (uint32_t j = 0; j <= i; ++j) {
            const double *other = factor + (size_t)j * SHAPE_SOLVE_FREE_MAX;
            double sum = p->h[(size_t)free[i] * p->count + free[j]];
            for (uint32_t k = 0; k < j; ++k)
                sum -= row[k] * other[k];
            if (j < i)
                row[j] = sum / other[j];
            else if (sum > pivot_least * p->h[(size_t)free[i] * p->count + free[i]])
                row[i] = sqrt(sum);
            else
                return false;
        }
        double sum = -slope[free[i]];
        for (uint32_t k = 0; k < i; ++k)
            sum -= row[k] * step[k];
        step[i] = sum / row[i];
    }
    for (uint32_t i = count; i-- > 0;) {
        double sum = step[i];
        for (uint32_t k = i + 1; k < count; ++k)
            sum -= factor[(size_t)k * SHAPE_SOLVE_FREE_MAX + i] * step[k];
        step[i] = sum / factor[(size_t)i * SHAPE_SOLVE_FREE_MAX + i];
    }
    return true;
}

/* Moves all free weights together, up to the first bound on the way. */
static void step_free(double *w, double *slope, const shape_problem *p, double *scratch)
{
    uint32_t free[SHAPE_SOLVE_FREE_MAX], count = 0;
    double *step = scratch, *factor = scratch + SHAPE_SOLVE_FREE_MAX, part = 1.0;
    for (uint32_t i = 0; i < p->count; ++i) {
        if (!(w[i] > p->low[i] && w[i] < p->high[i]))
            continue;
        if (count == SHAPE_SOLVE_FREE_MAX)
            return;
        free[count++] = i;
    }
    if (count < 2 || !newton(step, factor, free, count, slope, p))
        return;
    uint32_t first = count; /* the first weight that reaches a bound */
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t at = free[i];
        double room = step[i] > 0.0 ? p->high[at] - w[at] : w[at] - p->low[at];
        if (fabs(step[i]) * part <= room)
            continue;
        part = room / fabs(step[i]);
        first = i;
    }
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t at = free[i];
        double to = clamped(w[at] + part * step[i], p->low[at], p->high[at]);
        if (i == first)
            to = step[i] > 0.0 ? p->high[at] : p->low[at];
        add_row(slope, p, at, to - w[at]);
        w[at] = to;
    }
}

uint32_t shape_solve(double *w, const shape_problem *p, double *scratch)
{
    double *slope = scratch;
    for (uint32_t i = 0; i < p->count; ++i)
        w[i] = clamped(isfinite(w[i]) ? w[i] : 0.0, p->low[i], p->high[i]);
    find_slope(slope, w, p);
    for (uint32_t round = 0; round < SHAPE_SOLVE_ROUNDS; ++round) {
        if (sweep(w, slope, p) < settled)
            return round;
        step_free(w, slope, p, scratch + p->count);
    }
    return SHAPE_SOLVE_ROUNDS;
}
