/* What must hold for a shape that is dragged, sample by sample. Lengths are in units in which the
 * shape is 3 wide. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "property/csrbf_slab.h"

#include <stdlib.h>

static void one_small_drag_is_one_direct_frame(void **state)
{
    (void)state;
    for (uint32_t number = 0; number < 40; ++number) {
        error err = {""};
        double to[TIPS][3], g[TIPS][3], reached[TIPS][3];
        shape_step step;
        scene s = make_scene(number, scene_polynomials[number / 4 % 4]);
        shape a;
        make_shape(&a, &s);
        ends(to, &s, 0.0625);
        for (uint32_t i = 0; i < s.tip_count; ++i)
            for (int axis = 0; axis < 3; ++axis)
                g[i][axis] = to[i][axis] - s.tip[i][axis];
        must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, reached[0], &step, &err),
             &err);
        assert_int_equal(step.substeps, 1);
        assert_false(step.limited);
        assert_memory_equal(reached, to, (size_t)3 * s.tip_count * sizeof(double));
        must(csrbf_factor(a.solver, &s.settings, s.tip[0], NULL, s.tip_count, &err), &err);
        csrbf_limit_gain(a.solver, &a.rest, SHAPE_GAIN_LIMIT);
        must(csrbf_solve(a.solver, g[0], &err), &err);
        (void)csrbf_move(a.solver, &a.before, &a.rest);
        expect_same_bits(&a.shown, &a.before);
        assert_true(largest_difference(&a.shown, &a.rest) > 0.0);
        shape_destroy(&a);
    }
}

static void fastest_to(scene *s, double length)
{
    double fastest = 0.0;
    for (uint32_t i = 0; i < s->tip_count; ++i) {
        double size = scene_distance(s->g[i], (const double[3]){0.0, 0.0, 0.0});
        fastest = size > fastest ? size : fastest;
    }
    for (uint32_t i = 0; i < s->tip_count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            s->g[i][axis] *= length / fastest;
}

/* The vertices at the tips are the last ones of the file. */
static double largest_miss(const shape *a, const scene *s, double at[TIPS][3])
{
    double largest = 0.0;
    for (uint32_t i = 0; i < s->tip_count; ++i) {
        uint32_t slot = a->order.slot_of_file[VERTICES - TIPS + i];
        double x[3] = {(double)a->shown.x[slot], (double)a->shown.y[slot],
                       (double)a->shown.z[slot]};
        double miss = scene_distance(x, at[i]);
        largest = miss > largest ? miss : largest;
    }
    return largest;
}

static void drags_never_fold_and_the_tips_take_their_vertices_along(void **state)
{
    (void)state;
    static const double speeds[] = {0.05, 0.1, 0.2, 0.5, 1.0}; /* radii per sample */
    static const double substeps_least[] = {1, 1, 1, 2, 3};
    for (uint32_t speed = 0; speed < 5; ++speed) {
        uint32_t most = 0, limited = 0;
        double worst = 1.0;
        for (uint32_t number = 0; number < 60; ++number) {
            error err = {""};
            double to[TIPS][3], reached[TIPS][3];
            shape_step step;
            scene s = make_scene(number, number % 3 ? CSRBF_NONE : CSRBF_WINDOWED);
            shape a;
            fastest_to(&s, speeds[speed] * s.settings.radius);
            make_shape(&a, &s);
            ends(to, &s, 1.0);
            must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, reached[0], &step, &err),
                 &err);
            if (!(step.min_determinant > 0.0))
                fail_msg("scene %u folds: %g", number, step.min_determinant);
            if (!step.limited)
                assert_memory_equal(reached, to, (size_t)3 * s.tip_count * sizeof(double));
            assert_true(largest_miss(&a, &s, reached) <= 1e-4);
            worst = step.min_determinant < worst ? step.min_determinant : worst;
            most = step.substeps > most ? step.substeps : most;
            limited += step.limited;
            shape_destroy(&a);
        }
        print_message("%.2f R per sample: at most %u substeps, smallest determinant %.3f, "
                      "%u of 60 limited\n",
                      speeds[speed], most, worst, limited);
        assert_true(most >= substeps_least[speed] && most <= SHAPE_SUBSTEP_CAP);
    }
}

/* Tiny tetrahedra keep their orientation: another measure than the engine's own. */
static void drags_turn_no_tetrahedron_inside_out(void **state)
{
    (void)state;
    enum { TETRAHEDRA = 200 };
    static const double corner[4][3] = {{0, 0, 0}, {0x1p-7, 0, 0}, {0, 0x1p-7, 0}, {0, 0, 0x1p-7}};
    for (uint32_t number = 0; number < 20; ++number) {
        static float row[4 * TETRAHEDRA][3];
        uint64_t seed = number;
        error err = {""};
        double to[TIPS][3];
        shape_step step;
        shape a;
        scene s = make_scene(number, CSRBF_NONE);
        fastest_to(&s, 0.4 * s.settings.radius);
        ends(to, &s, 1.0);
        for (uint32_t t = 0; t < TETRAHEDRA; ++t)
            for (int axis = 0; axis < 3; ++axis) {
                double at = s.tip[t % s.tip_count][axis] + scene_number(&seed, 0.5);
                for (uint32_t c = 0; c < 4; ++c)
                    row[4 * t + c][axis] = (float)(at + corner[c][axis]);
            }
        must(shape_create(&a, row[0], 4 * TETRAHEDRA, TIPS, &err), &err);
        must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, NULL, &step, &err), &err);
        points_to_rows(row[0], &a.shown, &a.order);
        for (uint32_t t = 0; t < TETRAHEDRA; ++t) {
            double e[3][3];
            for (uint32_t c = 0; c < 3; ++c)
                for (int axis = 0; axis < 3; ++axis)
                    e[c][axis] = (double)row[4 * t + c + 1][axis] - (double)row[4 * t][axis];
            double volume = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                            e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
            assert_true(volume > 0.0);
        }
        shape_destroy(&a);
    }
}

static void an_endless_drag_is_limited_and_says_how_far_it_came(void **state)
{
    (void)state;
    error err = {""};
    double to[TIPS][3], reached[TIPS][3];
    shape_step step;
    scene s = scene_make(2, CSRBF_WENDLAND_C2, CSRBF_NONE);
    shape a;
    make_shape(&a, &s);
    fastest_to(&s, 1000.0 * s.settings.radius);
    ends(to, &s, 1.0);
    must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, reached[0], &step, &err), &err);
    assert_true(step.limited);
    assert_int_equal(step.substeps, SHAPE_SUBSTEP_CAP);
    assert_true(step.min_determinant > 0.0);
    for (uint32_t i = 0; i < s.tip_count; ++i)
        assert_true(scene_distance(reached[i], s.tip[i]) < scene_distance(to[i], s.tip[i]));
    assert_true(largest_miss(&a, &s, reached) <= 1e-4);
    shape_destroy(&a);
}

static void drags_out_of_reach_or_without_a_way_move_nothing(void **state)
{
    (void)state;
    error err = {""};
    double to[TIPS][3], reached[TIPS][3];
    shape_step step;
    scene s = make_scene(0, CSRBF_NONE);
    shape a;
    make_shape(&a, &s);
    must(shape_drag(&a, &s.settings, s.tip[0], s.tip[0], s.tip_count, reached[0], &step, &err),
         &err);
    assert_int_equal(step.substeps, 0);
    assert_true(step.min_determinant == 1.0);
    for (uint32_t i = 0; i < s.tip_count; ++i)
        s.tip[i][2] += 100.0;
    ends(to, &s, 1.0);
    must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, reached[0], &step, &err), &err);
    assert_int_equal(step.substeps, 0);
    assert_memory_equal(reached, to, (size_t)3 * s.tip_count * sizeof(double));
    must(shape_drag(&a, &s.settings, NULL, NULL, 0, NULL, &step, &err), &err);
    assert_int_equal(step.substeps, 0);
    expect_same_bits(&a.shown, &a.rest);
    shape_destroy(&a);
}

static void a_refused_drag_moves_nothing(void **state)
{
    (void)state;
    error err = {""};
    double to[TIPS][3];
    shape_step step;
    scene s = make_scene(1, CSRBF_NONE);
    shape a;
    make_shape(&a, &s);
    ends(to, &s, 1.0);
    to[1][0] = (double)NAN;
    assert_int_equal(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, NULL, &step, &err),
                     MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "control 1"));
    assert_int_equal(step.substeps, 0);
    ends(to, &s, 1.0);
    assert_int_equal(shape_drag(&a, &s.settings, s.tip[0], to[0], TIPS + 1, NULL, &step, &err),
                     MRT_ERR_ARGUMENT);
    s.settings.radius = 0.0;
    assert_int_equal(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, NULL, &step, &err),
                     MRT_ERR_ARGUMENT);
    expect_same_bits(&a.shown, &a.rest);
    shape_destroy(&a);
}

static void a_shape_that_leaves_the_range_is_held(void **state)
{
    (void)state;
    static const float vertex[1][3] = {{1.0f, 2.0f, 3.0f}};
    static const double from[3] = {0.0, 0.0, 0.0}, to[3] = {0.0, 4e14, 0.0};
    csrbf_settings settings = {.polynomial = CSRBF_CONSTANT, .radius = 1.0};
    error err = {""};
    shape_step step;
    shape a;
    must(shape_create(&a, vertex[0], 1, 1, &err), &err);
    must(shape_drag(&a, &settings, from, to, 1, NULL, &step, &err), &err);
    must(shape_drag(&a, &settings, from, to, 1, NULL, &step, &err), &err);
    keep(&a, &a.base);
    assert_int_equal(shape_drag(&a, &settings, from, to, 1, NULL, &step, &err),
                     MRT_ERR_UNSUPPORTED);
    expect_same_bits(&a.shown, &a.base);
    shape_destroy(&a);
}

/* Each sample a linear polynomial grows the shape by 3/8, till the guard takes it away. */
static void a_polynomial_that_throws_far_is_restricted(void **state)
{
    (void)state;
    error err = {""};
    shape_step step;
    scene s = scene_make(6, CSRBF_WENDLAND_C2, CSRBF_LINEAR);
    double to[TIPS][3];
    shape a;
    make_shape(&a, &s);
    for (int sample = 0; sample < 100; ++sample) {
        for (uint32_t i = 0; i < s.tip_count; ++i)
            for (int axis = 0; axis < 3; ++axis)
                to[i][axis] = 1.375 * s.tip[i][axis];
        must(shape_drag(&a, &s.settings, s.tip[0], to[0], s.tip_count, NULL, &step, &err), &err);
        assert_true(csrbf_diagnose(a.solver).polynomial_gain <= SHAPE_GAIN_LIMIT);
    }
    assert_int_equal(csrbf_diagnose(a.solver).polynomial_terms, 1);
    points_bounds box = points_extent(&a.shown);
    for (int axis = 0; axis < 3; ++axis)
        assert_true(fabsf(box.low[axis]) < 1e4f && fabsf(box.high[axis]) < 1e4f);
    shape_destroy(&a);
}

/* The way from `from` to `to` in n equal steps, in double. */
static void flow(csrbf_solver *solver, const scene *s, double from, double to, int n,
                 double x[SCENE_POINTS][3])
{
    error err = {""};
    double tip[TIPS][3], g[TIPS][3];
    for (int step = 0; step < n; ++step) {
        ends(tip, s, from + (to - from) * step / n);
        for (uint32_t i = 0; i < s->tip_count; ++i)
            for (int axis = 0; axis < 3; ++axis)
                g[i][axis] = (to - from) / n * s->g[i][axis];
        must(csrbf_factor(solver, &s->settings, tip[0], NULL, s->tip_count, &err), &err);
        must(csrbf_solve(solver, g[0], &err), &err);
        csrbf_move_f64(solver, x[0], SCENE_POINTS);
    }
}

static double distance_of(double a[SCENE_POINTS][3], double b[SCENE_POINTS][3])
{
    double sum = 0.0;
    for (int i = 0; i < SCENE_POINTS; ++i)
        sum += scene_distance(a[i], b[i]) * scene_distance(a[i], b[i]);
    return sqrt(sum);
}

static void twice_the_substeps_halve_the_error_and_the_residual(void **state)
{
    (void)state;
    csrbf_solver *solver = csrbf_solver_create(TIPS);
    assert_non_null(solver);
    for (uint32_t number = 0; number < 12; ++number) {
        scene s = scene_make(number, scene_kernels[number % 2 ? 2 : 0], CSRBF_NONE);
        double reference[SCENE_POINTS][3], x[SCENE_POINTS][3], error_of[3], residual[3];
        fastest_to(&s, 0.4 * s.settings.radius);
        memcpy(reference, s.point, sizeof reference);
        flow(solver, &s, 0.0, 1.0, 2048, reference);
        for (int level = 0; level < 3; ++level) {
            memcpy(x, s.point, sizeof x);
            flow(solver, &s, 0.0, 1.0, 16 << level, x);
            error_of[level] = distance_of(x, reference);
            flow(solver, &s, 1.0, 0.0, 16 << level, x);
            residual[level] = distance_of(x, s.point);
        }
        for (int level = 0; level < 2; ++level) {
            double ratio = error_of[level] / error_of[level + 1];
            double back = residual[level] / residual[level + 1];
            if (!(ratio > 1.6 && ratio < 2.4 && back > 1.6 && back < 2.4))
                fail_msg("scene %u: error ratio %g, residual ratio %g", number, ratio, back);
        }
    }
    csrbf_solver_destroy(solver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_small_drag_is_one_direct_frame),
        cmocka_unit_test(drags_never_fold_and_the_tips_take_their_vertices_along),
        cmocka_unit_test(drags_turn_no_tetrahedron_inside_out),
        cmocka_unit_test(an_endless_drag_is_limited_and_says_how_far_it_came),
        cmocka_unit_test(drags_out_of_reach_or_without_a_way_move_nothing),
        cmocka_unit_test(a_refused_drag_moves_nothing),
        cmocka_unit_test(a_shape_that_leaves_the_range_is_held),
        cmocka_unit_test(a_polynomial_that_throws_far_is_restricted),
        cmocka_unit_test(twice_the_substeps_halve_the_error_and_the_residual),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
