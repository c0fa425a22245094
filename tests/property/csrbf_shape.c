/* What must hold for a shape that is pulled from its base, for the gate and for the leak. Lengths
 * are in units in which the shape is 3 wide. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "property/csrbf_slab.h"

#include <stdlib.h>

/* ---- anchored ---- */

static void pulls_do_not_depend_on_the_pulls_before(void **state)
{
    (void)state;
    for (uint32_t number = 0; number < 40; ++number) {
        error err = {""};
        scene s = make_scene(number, scene_polynomials[number % 4]);
        shape a, b;
        make_shape(&a, &s);
        make_shape(&b, &s);
        must(shape_engage(&a, &s.settings, s.tip[0], s.tip_count, &err), &err);
        must(shape_engage(&b, &s.settings, s.tip[0], s.tip_count, &err), &err);
        for (int k = 0; k < 5; ++k) {
            scene way = make_scene(number + 100 + (uint32_t)k, CSRBF_NONE);
            must(shape_pull(&a, way.g[0], &err), &err);
        }
        must(shape_pull(&a, s.g[0], &err), &err);
        must(shape_pull(&b, s.g[0], &err), &err);
        expect_same_bits(&a.shown, &b.shown);
        assert_true(largest_difference(&a.shown, &a.base) > 0.01);
        shape_destroy(&a);
        shape_destroy(&b);
    }
}

static void rest_pose_gives_zero_offsets_and_commit_does_not_jump(void **state)
{
    (void)state;
    for (uint32_t number = 0; number < 40; ++number) {
        error err = {""};
        double zero[TIPS][3] = {{0.0}}, now[TIPS][3];
        scene s = make_scene(number, scene_polynomials[number % 4]);
        shape a;
        make_shape(&a, &s);
        must(shape_engage(&a, &s.settings, s.tip[0], s.tip_count, &err), &err);
        must(shape_pull(&a, zero[0], &err), &err);
        expect_same_bits(&a.shown, &a.rest);
        must(shape_pull(&a, s.g[0], &err), &err);
        keep(&a, &a.before);
        shape_commit(&a);
        expect_same_bits(&a.shown, &a.before);
        ends(now, &s, 1.0);
        must(shape_engage(&a, &s.settings, now[0], s.tip_count, &err), &err);
        expect_same_bits(&a.shown, &a.before);
        must(shape_pull(&a, zero[0], &err), &err);
        expect_same_bits(&a.shown, &a.before);
        shape_reset(&a);
        expect_same_bits(&a.shown, &a.rest);
        shape_destroy(&a);
    }
}

static void a_pull_is_the_direct_field_within_rounding(void **state)
{
    (void)state;
    for (uint32_t number = 0; number < 40; ++number) {
        error err = {""};
        scene s = make_scene(number, scene_polynomials[number / 4 % 4]);
        shape a;
        make_shape(&a, &s);
        must(shape_engage(&a, &s.settings, s.tip[0], s.tip_count, &err), &err);
        must(shape_pull(&a, s.g[0], &err), &err);
        must(csrbf_solve(a.solver, s.g[0], &err), &err);
        double limit = 1e-5 * (csrbf_diagnose(a.solver).alpha_sum + s.largest_g) + 1e-6;
        (void)csrbf_move(a.solver, &a.before, &a.base);
        assert_true(largest_difference(&a.shown, &a.before) <= limit);
        shape_destroy(&a);
    }
}

static void refused_pulls_and_engagements_change_nothing(void **state)
{
    (void)state;
    error err = {""};
    scene s = make_scene(3, CSRBF_NONE);
    shape a;
    make_shape(&a, &s);
    must(shape_engage(&a, &s.settings, s.tip[0], s.tip_count, &err), &err);
    must(shape_pull(&a, s.g[0], &err), &err);
    keep(&a, &a.before);
    double bad[TIPS][3];
    memcpy(bad, s.g, sizeof bad);
    bad[2][1] = (double)NAN;
    assert_int_equal(shape_pull(&a, bad[0], &err), MRT_ERR_ARGUMENT);
    assert_string_equal(err.text, "control 2: displacement nan is not within +-1e+15");
    expect_same_bits(&a.shown, &a.before);
    assert_int_equal(shape_engage(&a, &s.settings, bad[0], s.tip_count, &err), MRT_ERR_ARGUMENT);
    csrbf_settings wrong = s.settings;
    wrong.radius = -1.0;
    assert_int_equal(shape_engage(&a, &wrong, s.tip[0], s.tip_count, &err), MRT_ERR_ARGUMENT);
    assert_int_equal(shape_engage(&a, &s.settings, s.tip[0], TIPS + 1, &err), MRT_ERR_ARGUMENT);
    expect_same_bits(&a.shown, &a.before);
    must(shape_pull(&a, s.g[0], &err), &err);
    expect_same_bits(&a.shown, &a.before);
    shape_destroy(&a);
}

static void without_an_engagement_a_pull_moves_nothing(void **state)
{
    (void)state;
    error err = {""};
    scene s = make_scene(5, CSRBF_NONE);
    shape_step step;
    double to[TIPS][3];
    shape a;
    make_shape(&a, &s);
    must(shape_engage(&a, &s.settings, s.tip[0], s.tip_count, &err), &err);
    ends(to, &s, 0.5);
    must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, NULL, &step, &err), &err);
    keep(&a, &a.before);
    assert_int_equal(a.control_count, 0);
    must(shape_pull(&a, s.g[0], &err), &err);
    expect_same_bits(&a.shown, &a.before);
    assert_true(shape_slope_bound(&a, s.g[0]) == 0.0);
    shape_destroy(&a);
}

static void the_meters_of_a_pull_agree(void **state)
{
    (void)state;
    error err = {""};
    for (uint32_t number = 0; number < 40; ++number) {
        scene s = scene_make(number, CSRBF_WENDLAND_C2, CSRBF_NONE);
        shape a;
        make_shape(&a, &s);
        must(shape_engage(&a, &s.settings, s.tip[0], s.tip_count, &err), &err);
        double bound = shape_slope_bound(&a, s.g[0]);
        double determinant = shape_min_determinant(&a, s.g[0]);
        assert_true(bound > 0.0 && determinant < 1.0);
        if (bound < 1.0)
            assert_true(determinant >= (1.0 - bound) * (1.0 - bound) * (1.0 - bound) - 1e-5);
        s.g[0][0] = (double)INFINITY;
        assert_true(shape_slope_bound(&a, s.g[0]) == (double)INFINITY);
        assert_true(shape_min_determinant(&a, s.g[0]) == -(double)INFINITY);
        shape_destroy(&a);
    }
}

/* ---- the gate and the leak ---- */

static void near_is_closer_than_the_radius_to_a_vertex(void **state)
{
    (void)state;
    static const float vertex[2][3] = {{0.0f, 0.0f, 0.0f}, {8.0f, 0.0f, 0.0f}};
    error err = {""};
    shape a;
    must(shape_create(&a, vertex[0], 2, 1, &err), &err);
    static const double at[3][3] = {{4.0, 0.0, 0.0}, {8.0, 3.0, 4.0}, {(double)NAN, 0.0, 0.0}};
    assert_true(shape_is_near(&a.shown, at[0], 1, 4.0 + 1e-9));
    assert_false(shape_is_near(&a.shown, at[0], 1, 4.0)); /* between them, inside their box */
    assert_true(shape_is_near(&a.shown, at[1], 1, 5.0 + 1e-9));
    assert_false(shape_is_near(&a.shown, at[1], 1, 5.0));
    assert_false(shape_is_near(&a.shown, at[2], 1, 100.0));
    assert_true(shape_is_near(&a.shown, at[0], 2, 4.5));
    assert_false(shape_is_near(&a.shown, at[0], 0, 100.0));
    shape_destroy(&a);
}

static void the_gate_looks_at_the_shape_that_is_shown(void **state)
{
    (void)state;
    static const float vertex[1][3] = {{0.0f, 0.0f, 0.0f}};
    static const double start[3] = {0.0, 0.0, 0.0}, g[3] = {0.0, 5.0, 0.0}, above[3] = {0, 5.5, 0};
    csrbf_settings settings = {.radius = 1.0};
    error err = {""};
    shape a;
    must(shape_create(&a, vertex[0], 1, 1, &err), &err);
    must(shape_engage(&a, &settings, start, 1, &err), &err);
    assert_false(shape_is_near(&a.shown, above, 1, 1.0));
    must(shape_pull(&a, g, &err), &err);
    assert_true(shape_is_near(&a.shown, above, 1, 1.0));
    shape_destroy(&a);
}

static void a_leak_eases_back_to_rest_and_stays_there(void **state)
{
    (void)state;
    error err = {""};
    double to[TIPS][3];
    shape_step step;
    scene s = make_scene(4, CSRBF_NONE);
    shape a;
    make_shape(&a, &s);
    shape_leak(&a, 10.0, 0.1);
    expect_same_bits(&a.shown, &a.rest);
    ends(to, &s, 1.0);
    must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, NULL, &step, &err), &err);
    double before = largest_difference(&a.shown, &a.rest);
    shape_leak(&a, 10.0, 0.1); /* half the way */
    assert_true(fabs(largest_difference(&a.shown, &a.rest) - 0.5 * before) <= 1e-6);
    keep(&a, &a.before);
    shape_leak(&a, -1.0, 0.1);
    shape_leak(&a, (double)NAN, 0.1);
    shape_leak(&a, 1.0, 0.0);
    expect_same_bits(&a.shown, &a.before);
    shape_leak(&a, 1e200, 1.0);
    assert_true(largest_difference(&a.shown, &a.rest) <= 1e-6);
    shape_destroy(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pulls_do_not_depend_on_the_pulls_before),
        cmocka_unit_test(rest_pose_gives_zero_offsets_and_commit_does_not_jump),
        cmocka_unit_test(a_pull_is_the_direct_field_within_rounding),
        cmocka_unit_test(refused_pulls_and_engagements_change_nothing),
        cmocka_unit_test(without_an_engagement_a_pull_moves_nothing),
        cmocka_unit_test(the_meters_of_a_pull_agree),
        cmocka_unit_test(near_is_closer_than_the_radius_to_a_vertex),
        cmocka_unit_test(the_gate_looks_at_the_shape_that_is_shown),
        cmocka_unit_test(a_leak_eases_back_to_rest_and_stays_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
