/* property/csrbf_check.h - runs a check over the random scenes that have a wanted polynomial, with
 * one solver for all of them. After <cmocka.h>. */
#ifndef MAROTTE_TESTS_CSRBF_CHECK_H
#define MAROTTE_TESTS_CSRBF_CHECK_H
#include "property/csrbf_scene.h"

typedef struct positions {
    double at[SCENE_POINTS][3];
} positions;

static csrbf_solver *solver; /* between set_up and tear_down */

static inline int set_up(void **state)
{
    (void)state;
    solver = csrbf_solver_create(2 * SCENE_TIPS);
    return solver ? 0 : -1;
}

static inline int tear_down(void **state)
{
    (void)state;
    csrbf_solver_destroy(solver);
    return 0;
}

static inline void solve(const scene *s)
{
    error err = {""};
    if (csrbf_factor(solver, &s->settings, s->tip[0], NULL, s->tip_count, &err) < 0 ||
        csrbf_solve(solver, s->g[0], &err) < 0)
        fail_msg("%s", err.text);
}

static inline positions displacements(const scene *s)
{
    positions out;
    solve(s);
    memcpy(out.at, s->point, sizeof out.at);
    csrbf_move_f64(solver, out.at[0], SCENE_POINTS);
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            out.at[i][axis] -= s->point[i][axis];
    return out;
}

static inline double largest_difference(const positions *a, const positions *b)
{
    double largest = 0.0;
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            double d = fabs(a->at[i][axis] - b->at[i][axis]);
            assert_true(isfinite(d));
            largest = d > largest ? d : largest;
        }
    return largest;
}

static inline void expect_close(const positions *a, const positions *b, double limit)
{
    double difference = largest_difference(a, b);
    if (!(difference <= limit))
        fail_msg("differs by %g, limit %g", difference, limit);
}

typedef void check(const scene *s, uint64_t *seed);

static inline void for_scenes(check *one, bool none, bool constant, bool linear, bool windowed)
{
    const bool wanted[] = {none, constant, linear, windowed};
    for (uint32_t number = 0; number < SCENE_COUNT; ++number) {
        csrbf_polynomial polynomial = scene_polynomials[number / 4 % 4];
        if (!wanted[polynomial])
            continue;
        uint64_t seed = number;
        scene s = scene_make(number, scene_kernels[number % 4], polynomial);
        one(&s, &seed);
    }
}

#endif
