/* face/frame/shape_solve.h: the weights that explain what is asked for, between their bounds. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "face/frame/shape_solve.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 120, ROWS = 60, PROBLEMS = 200, PATH = 400 };

static uint64_t state;

static double next_random(void) /* -1..1 */
{
    uint64_t z = (state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1.0;
}

typedef struct problem {
    double a[MOST][ROWS], h[MOST * MOST], b[MOST], low[MOST], high[MOST];
    double scratch[SHAPE_SOLVE_SCRATCH(MOST)];
    shape_problem given;
} problem;

/* Shapes that are alike, as those of faces are: each is a mixture of a few. */
static void draw(problem *p, uint32_t count, double ridge)
{
    double few[8][ROWS];
    for (int i = 0; i < 8; ++i)
        for (int r = 0; r < ROWS; ++r)
            few[i][r] = next_random();
    for (uint32_t i = 0; i < count; ++i)
        for (int r = 0; r < ROWS; ++r)
            p->a[i][r] = few[i % 8][r] + 0.2 * next_random();
    for (uint32_t i = 0; i < count; ++i) {
        p->low[i] = 0.0;
        p->high[i] = 1.0;
        for (uint32_t j = 0; j < count; ++j) {
            double sum = i == j ? ridge : 0.0;
            for (int r = 0; r < ROWS; ++r)
                sum += p->a[i][r] * p->a[j][r];
            p->h[i * count + j] = sum;
        }
    }
    p->given = (shape_problem){p->h, p->b, p->low, p->high, count};
}

static void ask(problem *p, const double *y)
{
    for (uint32_t i = 0; i < p->given.count; ++i) {
        p->b[i] = 0.0;
        for (int r = 0; r < ROWS; ++r)
            p->b[i] += p->a[i][r] * y[r];
    }
}

static double cost(const problem *p, const double *w)
{
    double sum = 0.0;
    uint32_t n = p->given.count;
    for (uint32_t i = 0; i < n; ++i) {
        sum -= p->b[i] * w[i];
        for (uint32_t j = 0; j < n; ++j)
            sum += 0.5 * w[i] * p->h[i * n + j] * w[j];
    }
    return sum;
}

/* Slow and plain: a step down the slope, back between the bounds, until nothing moves. */
static void solve_slowly(double *w, const problem *p)
{
    uint32_t n = p->given.count;
    double steepest = 0.0;
    for (uint32_t i = 0; i < n; ++i) {
        double row = 0.0;
        for (uint32_t j = 0; j < n; ++j)
            row += fabs(p->h[i * n + j]);
        steepest = fmax(steepest, row);
        w[i] = 0.0;
    }
    for (int round = 0; round < 20000; ++round) {
        double slope[MOST];
        for (uint32_t i = 0; i < n; ++i) {
            slope[i] = -p->b[i];
            for (uint32_t j = 0; j < n; ++j)
                slope[i] += p->h[i * n + j] * w[j];
        }
        for (uint32_t i = 0; i < n; ++i)
            w[i] = fmin(fmax(w[i] - slope[i] / steepest, p->low[i]), p->high[i]);
    }
}

/* Of the conditions of an optimum the greatest that is not met, in weights. */
static double violation(const problem *p, const double *w)
{
    double most = 0.0;
    uint32_t n = p->given.count;
    for (uint32_t i = 0; i < n; ++i) {
        double slope = -p->b[i];
        for (uint32_t j = 0; j < n; ++j)
            slope += p->h[i * n + j] * w[j];
        double to = fmin(fmax(w[i] - slope / p->h[i * n + i], p->low[i]), p->high[i]);
        assert_true(w[i] >= p->low[i] && w[i] <= p->high[i]);
        most = fmax(most, fabs(to - w[i]));
    }
    return most;
}

static void draw_ask(problem *p)
{
    double y[ROWS];
    for (int r = 0; r < ROWS; ++r)
        y[r] = 2.0 * next_random();
    ask(p, y);
}

static void solution_meets_the_conditions_of_an_optimum(void **unused)
{
    static problem p;
    double w[MOST];
    (void)unused;
    state = 1;
    for (int i = 0; i < PROBLEMS; ++i) {
        draw(&p, 1 + (uint32_t)(i % 52), 0.5);
        draw_ask(&p);
        for (uint32_t k = 0; k < p.given.count; ++k) {
            w[k] = 0.0;
            p.high[k] = i % 3 == 0 ? 0.5 + 0.5 * next_random() : 1.0;
            p.low[k] = i % 5 == 0 && k % 7 == 0 ? p.high[k] : 0.0; /* some are said */
        }
        assert_true(shape_solve(w, &p.given, p.scratch) < SHAPE_SOLVE_ROUNDS);
        assert_true(violation(&p, w) < 1e-6);
    }
}

static void solution_costs_no_more_than_a_slow_reference(void **unused)
{
    static problem p;
    double w[MOST], slow[MOST];
    (void)unused;
    state = 2;
    for (int i = 0; i < 6; ++i) {
        draw(&p, 24, 0.5);
        draw_ask(&p);
        memset(w, 0, sizeof w);
        (void)shape_solve(w, &p.given, p.scratch);
        solve_slowly(slow, &p);
        assert_true(cost(&p, w) <= cost(&p, slow) + 1e-9);
        for (uint32_t k = 0; k < p.given.count; ++k)
            assert_true(fabs(w[k] - slow[k]) < 1e-3);
    }
}

static void same_input_gives_the_same_bits(void **unused)
{
    static problem p;
    double a[MOST], b[MOST];
    (void)unused;
    state = 3;
    draw(&p, 69, 0.1);
    draw_ask(&p);
    for (uint32_t k = 0; k < p.given.count; ++k)
        a[k] = b[k] = 0.5;
    (void)shape_solve(a, &p.given, p.scratch);
    for (size_t i = 0; i < sizeof p.scratch / sizeof p.scratch[0]; ++i)
        p.scratch[i] = (double)NAN;
    (void)shape_solve(b, &p.given, p.scratch);
    assert_memory_equal(a, b, p.given.count * sizeof *a);
}

/* Where a frame begins does not matter for where it ends. */
static void start_does_not_matter(void **unused)
{
    static problem p;
    double a[MOST], b[MOST];
    (void)unused;
    state = 4;
    for (int i = 0; i < 20; ++i) {
        draw(&p, 52, 0.5);
        draw_ask(&p);
        for (uint32_t k = 0; k < p.given.count; ++k) {
            a[k] = 0.0;
            b[k] = k % 2 == 0 ? 7.0 : -(double)NAN;
        }
        (void)shape_solve(a, &p.given, p.scratch);
        (void)shape_solve(b, &p.given, p.scratch);
        for (uint32_t k = 0; k < p.given.count; ++k)
            assert_true(fabs(a[k] - b[k]) < 1e-5);
    }
}

/* A way that goes on smoothly gives weights that do: no step is longer than the least curve of H
 * lets it be, |dw| <= |db| / ridge, and none is near that. */
static void weights_go_on_smoothly(void **unused)
{
    static problem p;
    double w[MOST] = {0}, before[MOST], from[ROWS], to[ROWS], y[ROWS];
    (void)unused;
    state = 5;
    draw(&p, 40, 2.0);
    for (int r = 0; r < ROWS; ++r) {
        from[r] = 2.0 * next_random();
        to[r] = 2.0 * next_random();
    }
    for (int i = 0; i <= PATH; ++i) {
        for (int r = 0; r < ROWS; ++r)
            y[r] = from[r] + (to[r] - from[r]) * i / PATH;
        ask(&p, y);
        memcpy(before, w, sizeof before);
        assert_true(shape_solve(w, &p.given, p.scratch) < SHAPE_SOLVE_ROUNDS);
        for (uint32_t k = 0; i > 0 && k < p.given.count; ++k)
            assert_true(fabs(w[k] - before[k]) < 0.02);
    }
}

/* More than Newton steps take: still between the bounds, and better than nothing. */
static void many_shapes_stay_within_their_bounds(void **unused)
{
    static problem p;
    double w[MOST] = {0}, none[MOST] = {0};
    (void)unused;
    state = 6;
    draw(&p, MOST, 0.05);
    draw_ask(&p);
    (void)shape_solve(w, &p.given, p.scratch);
    for (uint32_t k = 0; k < MOST; ++k)
        assert_true(w[k] >= 0.0 && w[k] <= 1.0);
    assert_true(cost(&p, w) < cost(&p, none));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solution_meets_the_conditions_of_an_optimum),
        cmocka_unit_test(solution_costs_no_more_than_a_slow_reference),
        cmocka_unit_test(same_input_gives_the_same_bits),
        cmocka_unit_test(start_does_not_matter),
        cmocka_unit_test(weights_go_on_smoothly),
        cmocka_unit_test(many_shapes_stay_within_their_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
