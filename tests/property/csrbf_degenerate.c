/* Controls as nobody would place them: never NaN, never a wild field, an error or a sound result.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/csrbf.h"
#include "property/csrbf_scene.h"

#include <stdlib.h>

enum { CAPACITY = 3000 };
static csrbf_solver *solver;

static int set_up(void **state)
{
    (void)state;
    solver = csrbf_solver_create(CAPACITY);
    return solver ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    csrbf_solver_destroy(solver);
    return 0;
}

static void solve(const csrbf_settings *settings, const double *tip, const csrbf_class *class,
                  const double *g, uint32_t count)
{
    error err = {""};
    if (csrbf_factor(solver, settings, tip, class, count, &err) < 0 ||
        csrbf_solve(solver, g, &err) < 0)
        fail_msg("%s", err.text);
}

static void displacement(double out[3], double x, double y, double z)
{
    const double at[3] = {x, y, z};
    memcpy(out, at, sizeof at);
    csrbf_move_f64(solver, out, 1);
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] -= at[axis];
        assert_true(isfinite(out[axis]));
    }
}

static void expect_displacement(const double at[3], double x, double y, double z, double limit)
{
    double d[3];
    displacement(d, at[0], at[1], at[2]);
    if (!(fabs(d[0] - x) <= limit && fabs(d[1] - y) <= limit && fabs(d[2] - z) <= limit))
        fail_msg("(%g, %g, %g) instead of (%g, %g, %g)", d[0], d[1], d[2], x, y, z);
}

static void coincident_controls_move_by_their_mean(void **state)
{
    (void)state;
    static const double tip[3][3] = {{1, 2, 3}, {1, 2, 3}, {1.5, 2, 3}};
    static const double g[3][3] = {{0.5, 0, 0}, {-0.25, 0.5, 0}, {0, 0, 1}};
    csrbf_settings settings = {.radius = 1.0};
    solve(&settings, tip[0], NULL, g[0], 3);
    assert_int_equal(csrbf_diagnose(solver).centre_count, 2);
    assert_true(csrbf_diagnose(solver).merged_apart);
    expect_displacement(tip[0], 0.125, 0.25, 0.0, 1e-14);
    expect_displacement(tip[2], 0.0, 0.0, 1.0, 1e-14);
}

static void controls_closer_than_a_thousandth_of_the_radius_are_one(void **state)
{
    (void)state;
    static const double g[2][3] = {{0.5, 0, 0}, {-0.5, 0, 0}};
    csrbf_settings settings = {.radius = 2.0};
    double tip[2][3] = {{0, 0, 0}, {0.00199, 0, 0}};
    solve(&settings, tip[0], NULL, g[0], 2);
    assert_int_equal(csrbf_diagnose(solver).centre_count, 1);
    assert_true(csrbf_diagnose(solver).alpha_sum == 0.0);
    tip[1][0] = 0.00201;
    solve(&settings, tip[0], NULL, g[0], 2);
    assert_int_equal(csrbf_diagnose(solver).centre_count, 2);
    expect_displacement(tip[0], 0.5, 0.0, 0.0, 1e-9);
    expect_displacement(tip[1], -0.5, 0.0, 0.0, 1e-9);
}

static void merged_controls_that_part_are_reported(void **state)
{
    (void)state;
    static const double tip[2][3] = {{0, 0, 0}, {0, 0, 0}};
    csrbf_settings settings = {.radius = 2.0};
    double g[2][3] = {{1, 0, 0}, {1, 0.0019, 0}};
    solve(&settings, tip[0], NULL, g[0], 2);
    assert_false(csrbf_diagnose(solver).merged_apart);
    g[1][1] = 0.0021;
    solve(&settings, tip[0], NULL, g[0], 2);
    assert_true(csrbf_diagnose(solver).merged_apart);
}

static void a_chain_of_close_controls_is_one(void **state)
{
    (void)state;
    static double tip[CAPACITY][3], g[CAPACITY][3];
    csrbf_settings settings = {.radius = 1.0};
    for (int i = 0; i < CAPACITY; ++i) {
        tip[i][0] = 0.0009 * ((i * 1009) % CAPACITY); /* every place once, out of order */
        g[i][1] = 1.0;
    }
    solve(&settings, tip[0], NULL, g[0], CAPACITY);
    assert_int_equal(csrbf_diagnose(solver).centre_count, 1);
    assert_false(csrbf_diagnose(solver).merged_apart);
    expect_displacement((const double[3]){0.0009 * (CAPACITY - 1) / 2.0, 0, 0}, 0, 1, 0, 1e-10);
}

static void skull_holds_jaw_and_jaw_holds_tips(void **state)
{
    (void)state;
    static const double tip[5][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {3, 0, 0}, {3, 0, 0}};
    static const double g[5][3] = {{1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0.5, 0}};
    static const csrbf_class class[5] = {CSRBF_TIP, CSRBF_SKULL, CSRBF_JAW, CSRBF_TIP, CSRBF_JAW};
    csrbf_settings settings = {.radius = 1.0};
    solve(&settings, tip[0], class, g[0], 5);
    expect_displacement(tip[0], 0.0, 0.0, 0.0, 0.0);
    expect_displacement(tip[3], 0.0, 0.5, 0.0, 1e-15);
    assert_true(csrbf_diagnose(solver).merged_apart);
}

static void merged_controls_share_a_response(void **state)
{
    (void)state;
    static const double tip[4][3] = {{0, 0, 0}, {0, 0, 0}, {1.5, 0, 0}, {1.5, 0, 0}};
    static const csrbf_class class[4] = {CSRBF_TIP, CSRBF_TIP, CSRBF_SKULL, CSRBF_TIP};
    static const double g[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 1}};
    static const float vertex[2][3] = {{0, 0, 0}, {1.5f, 0, 0}};
    float response[4][POINTS_BLOCK];
    csrbf_settings settings = {.radius = 1.0};
    error err = {""};
    points_order order;
    points p;
    assert_int_equal(points_order_create(&order, vertex[0], 2, &err), MRT_OK);
    assert_int_equal(points_create(&p, &order, vertex[0], &err), MRT_OK);
    solve(&settings, tip[0], class, g[0], 4);
    csrbf_responses(solver, response[0], POINTS_BLOCK, &p);
    uint32_t first = order.slot_of_file[0], second = order.slot_of_file[1];
    assert_true(response[0][first] == 0.5f && response[1][first] == 0.5f);
    assert_true(response[2][second] == 1.0f && response[3][second] == 0.0f);
    assert_true(response[2][first] == 0.0f && response[0][second] == 0.0f);
    points_destroy(&p);
    points_order_destroy(&order);
}

/* d of affine data must be that affine map within the hull of the controls, and not change along
 * its normals. */
static void flat_controls_restrict_the_polynomial(void **state)
{
    (void)state;
    static const double offset[] = {0.0, 1e4};
    static const double limit[] = {1e-4, 0.05}; /* float steps at 1e4 tilt the plane by 1e-3 */
    for (uint32_t dimension = 0; dimension <= 3; ++dimension)
        for (int place = 0; place < 2; ++place) {
            double tip[9][3], g[9][3], axis[3][3] = {{0.6, 0.8, 0}, {0, 0, 1}, {0.8, -0.6, 0}};
            uint64_t seed = 7;
            csrbf_settings settings = {.polynomial = CSRBF_LINEAR, .radius = 1.5};
            for (int i = 0; i < 9; ++i) {
                double along[3] = {scene_number(&seed, 1.0), scene_number(&seed, 1.0),
                                   scene_number(&seed, 1.0)};
                for (int k = 0; k < 3; ++k) {
                    tip[i][k] = offset[place];
                    for (uint32_t a = 0; a < dimension; ++a)
                        tip[i][k] += along[a] * axis[a][k];
                    tip[i][k] = (double)(float)tip[i][k]; /* as it comes from a mesh */
                    g[i][k] = 0.125 + 0.25 * (tip[i][k] - offset[place]);
                }
            }
            solve(&settings, tip[0], NULL, g[0], 9);
            if (csrbf_diagnose(solver).polynomial_terms != 1 + dimension)
                fail_msg("dimension %u at %g: %u terms", dimension, offset[place],
                         csrbf_diagnose(solver).polynomial_terms);
            double inside[3], beside[3];
            displacement(inside, tip[0][0], tip[0][1], tip[0][2]);
            displacement(beside, tip[0][0] + 50 * axis[2][0], tip[0][1] + 50 * axis[2][1],
                         tip[0][2] + 50 * axis[2][2]);
            for (int k = 0; k < 3; ++k) {
                assert_true(fabs(inside[k] - g[0][k]) <= 1e-3);
                if (dimension < 3)
                    assert_true(fabs(beside[k] - inside[k]) <= limit[place]);
            }
        }
}

/* Nearly flat: the paper's plane with controls that stand out of it by a jitter. */
static void nearly_flat_controls_do_not_throw_what_is_far_from_them(void **state)
{
    (void)state;
    static const double jitters[] = {0.0, 1e-3, 1e-2, 0.1, 1.0, 5.0};
    static const float corner[2][3] = {{-33, -33, -50}, {33, 33, 50}};
    error err = {""};
    points_order order;
    points box;
    assert_int_equal(points_order_create(&order, corner[0], 2, &err), MRT_OK);
    assert_int_equal(points_create(&box, &order, corner[0], &err), MRT_OK);
    for (int polynomial = CSRBF_LINEAR; polynomial <= CSRBF_WINDOWED; ++polynomial)
        for (int j = 0; j < 6; ++j) {
            double tip[10][3], g[10][3], d[3];
            uint64_t seed = 11;
            csrbf_settings settings = {.polynomial = (csrbf_polynomial)polynomial, .radius = 40.0};
            for (int i = 0; i < 10; ++i)
                for (int axis = 0; axis < 3; ++axis) {
                    tip[i][axis] = scene_number(&seed, axis == 2 ? 1.0 : 30.0);
                    tip[i][axis] *= axis == 2 ? jitters[j] : 1.0;
                    g[i][axis] = scene_number(&seed, 1.0);
                }
            solve(&settings, tip[0], NULL, g[0], 10);
            csrbf_limit_gain(solver, &box, 64.0);
            displacement(d, 0.0, 0.0, 0.0);
            assert_true(d[0] == 0.0); /* the field is cleared */
            assert_int_equal(csrbf_solve(solver, g[0], &err), MRT_OK);
            assert_true(csrbf_diagnose(solver).polynomial_gain <= 64.0);
            for (int i = 0; i < 10; ++i)
                expect_displacement(tip[i], g[i][0], g[i][1], g[i][2], 1e-10);
            for (int z = -50; z <= 50; z += 100) {
                displacement(d, 10.0, -10.0, z);
                for (int axis = 0; axis < 3; ++axis)
                    assert_true(fabs(d[axis]) <= 64.0);
            }
        }
    points_destroy(&box);
    points_order_destroy(&order);
}

static void no_controls_are_a_field_of_zero(void **state)
{
    (void)state;
    error err = {""};
    for (int polynomial = CSRBF_NONE; polynomial <= CSRBF_WINDOWED; ++polynomial) {
        csrbf_settings settings = {.polynomial = (csrbf_polynomial)polynomial, .radius = 1.0};
        assert_int_equal(csrbf_factor(solver, &settings, NULL, NULL, 0, &err), MRT_OK);
        assert_int_equal(csrbf_solve(solver, NULL, &err), MRT_OK);
        expect_displacement((const double[3]){1, 2, 3}, 0, 0, 0, 0.0);
        assert_int_equal(csrbf_diagnose(solver).centre_count, 0);
        assert_int_equal(csrbf_diagnose(solver).envelope_count, 0);
    }
}

static void one_control_is_a_bump_or_a_shift(void **state)
{
    (void)state;
    static const double tip[3] = {1, 1, 1}, g[3] = {0.25, -0.5, 1}, far[3] = {1e3, 0, 0};
    for (int polynomial = CSRBF_NONE; polynomial <= CSRBF_WINDOWED; ++polynomial) {
        csrbf_settings settings = {.polynomial = (csrbf_polynomial)polynomial, .radius = 0.5};
        bool global = polynomial == CSRBF_CONSTANT || polynomial == CSRBF_LINEAR;
        solve(&settings, tip, NULL, g, 1);
        assert_int_equal(csrbf_diagnose(solver).polynomial_terms, polynomial == CSRBF_NONE ? 0 : 1);
        expect_displacement(tip, g[0], g[1], g[2], 1e-15);
        expect_displacement(far, global ? g[0] : 0, global ? g[1] : 0, global ? g[2] : 0, 1e-12);
    }
}

/* Interpolates (where no controls are merged), or says that it cannot. */
static bool interpolates(const csrbf_settings *settings, const scene *s, double limit)
{
    error err = {""};
    if (csrbf_factor(solver, settings, s->tip[0], NULL, s->tip_count, &err) < 0 ||
        csrbf_solve(solver, s->g[0], &err) < 0) {
        assert_true(err.text[0] != '\0');
        return false;
    }
    bool merged = csrbf_diagnose(solver).centre_count < s->tip_count;
    for (uint32_t i = 0; i < s->tip_count; ++i)
        expect_displacement(s->tip[i], s->g[i][0], s->g[i][1], s->g[i][2], merged ? 1.0 : limit);
    return true;
}

static void any_radius_interpolates_or_is_refused(void **state)
{
    (void)state;
    for (uint32_t number = 0; number < 16; ++number) {
        scene s = scene_make(number, scene_kernels[number % 4], scene_polynomials[number / 4]);
        for (double radius = 1e-6; radius < 1e9; radius *= 10.0) {
            s.settings.radius = radius;
            bool done = interpolates(&s.settings, &s, 1e-7);
            if (radius >= 1e-2 && radius <= 10.0)
                assert_true(done);
        }
    }
}

/* The float path against double: alpha of a cluster may be a million times its displacements. */
static void expect_float_like_double(const scene *s)
{
    float row[SCENE_POINTS][3];
    double x[SCENE_POINTS][3];
    error err = {""};
    points_order order;
    points p;
    for (uint32_t i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            x[i][axis] = s->tip[i % s->tip_count][axis] + 0.25 * s->point[i][axis];
            row[i][axis] = (float)x[i][axis];
            x[i][axis] = (double)row[i][axis];
        }
    assert_int_equal(points_order_create(&order, row[0], SCENE_POINTS, &err), MRT_OK);
    assert_int_equal(points_create(&p, &order, row[0], &err), MRT_OK);
    (void)csrbf_move(solver, &p, &p);
    points_to_rows(row[0], &p, &order);
    csrbf_move_f64(solver, x[0], SCENE_POINTS);
    double limit = 1e-3 * s->largest_g + 1e-6;
    for (int i = 0; i < SCENE_POINTS; ++i)
        for (int axis = 0; axis < 3; ++axis)
            assert_true(fabs((double)row[i][axis] - x[i][axis]) <= limit + 1e-6 * fabs(x[i][axis]));
    points_destroy(&p);
    points_order_destroy(&order);
}

static void clusters_interpolate_or_are_refused(void **state)
{
    (void)state;
    for (double size = 1.0; size > 1e-5; size *= 0.5)
        for (uint32_t number = 0; number < 16; ++number) {
            scene s = scene_make(number, scene_kernels[number % 4], scene_polynomials[number / 4]);
            s.settings.radius = 1.0;
            for (uint32_t i = 0; i < s.tip_count; ++i)
                for (int axis = 0; axis < 3; ++axis) {
                    s.tip[i][axis] *= size;
                    s.g[i][axis] *= size;
                }
            s.largest_g *= size;
            if (interpolates(&s.settings, &s, 1e-4 * size))
                expect_float_like_double(&s);
        }
}

static void refuses(const char *words, csrbf_settings settings, const double *tip, uint32_t count)
{
    static const double held_tip[3] = {0, 0, 0}, held_g[3] = {1, 2, 3};
    csrbf_settings good = {.radius = 1.0};
    error err = {""};
    solve(&good, held_tip, NULL, held_g, 1);
    assert_true(csrbf_factor(solver, &settings, tip, NULL, count, &err) < 0);
    if (!strstr(err.text, words))
        fail_msg("\"%s\" does not say \"%s\"", err.text, words);
    expect_displacement(held_tip, 1, 2, 3, 0.0); /* the last field is still there */
}

static void bad_settings_and_positions_leave_the_last_field(void **state)
{
    (void)state;
    double tip[2][3] = {{0, 0, 0}, {1, 0, 0}};
    csrbf_settings good = {.radius = 1.0}, bad = good;
    bad.radius = 0.0;
    refuses("radius 0: expected a number from", bad, tip[0], 2);
    bad.radius = -1.0;
    refuses("radius -1", bad, tip[0], 2);
    bad.radius = (double)NAN;
    refuses("radius nan", bad, tip[0], 2);
    bad.radius = 1e30;
    refuses("radius 1e+30", bad, tip[0], 2);
    bad = good;
    bad.ridge = -1e-3;
    refuses("ridge -0.001", bad, tip[0], 2);
    bad = good;
    bad.kernel = (csrbf_kernel)9;
    refuses("kernel 9", bad, tip[0], 2);
    bad = good;
    bad.polynomial = (csrbf_polynomial)7;
    refuses("polynomial 7", bad, tip[0], 2);
    refuses("3001 controls: the solver has room for 3000", good, tip[0], 3001);
    tip[1][2] = (double)INFINITY;
    refuses("control 1: position inf", good, tip[0], 2);
    tip[1][2] = 1e16;
    refuses("control 1: position 1e+16", good, tip[0], 2);
}

/* 64 controls just too far apart to be one: the matrix is singular in double. */
static void a_singular_system_is_refused(void **state)
{
    (void)state;
    double tip[64][3];
    for (int i = 0; i < 64; ++i) {
        tip[i][0] = 1.1e-3 * (i % 4);
        tip[i][1] = 1.1e-3 * (i / 4 % 4);
        tip[i][2] = 1.1e-3 * (i / 16);
    }
    csrbf_settings settings = {.kernel = CSRBF_WENDLAND_C6, .radius = 1.0};
    refuses("too close to the others for radius 1", settings, tip[0], 64);
    settings.ridge = 1e-3;
    error err = {""};
    assert_int_equal(csrbf_factor(solver, &settings, tip[0], NULL, 64, &err), MRT_OK);
}

static void bad_displacements_leave_the_last_field(void **state)
{
    (void)state;
    static const double tip[2][3] = {{0, 0, 0}, {1, 0, 0}};
    double g[2][3] = {{1, 2, 3}, {0, 0, 0}};
    csrbf_settings settings = {.radius = 1.0};
    error err = {""};
    solve(&settings, tip[0], NULL, g[0], 2);
    g[1][2] = (double)NAN;
    assert_int_equal(csrbf_solve(solver, g[0], &err), MRT_ERR_ARGUMENT);
    assert_non_null(strstr(err.text, "control 1: displacement nan"));
    expect_displacement(tip[0], 1, 2, 3, 0.0);
}

/* Numbers from a nasty set, everywhere: an error, or finite results on every path. */
static void nasty_numbers_never_give_nan(void **state)
{
    (void)state;
    static const double nasty[] = {0.0,    -0.0,   1.0, -1.0,       1e-3, 1e-15,  1e15, -9e14,
                                   5e-324, 1e-300, 1e7, 16777217.0, 0.5,  2.5e-6, 1e-8, 3.0};
    static const double radii[] = {1e-14, 1e-3, 0.5, 1.0, 2.0, 1e3, 1e8, 1e14};
    uint64_t seed = 99;
    uint32_t solved = 0;
    for (uint32_t round = 0; round < 3000; ++round) {
        double tip[8][3], g[8][3], x[16][3];
        float row[16][3], response[8][POINTS_BLOCK];
        uint32_t count = (uint32_t)(scene_next(&seed) % 8 + 1);
        csrbf_settings settings = {.kernel = scene_kernels[round % 4],
                                   .polynomial = scene_polynomials[round / 4 % 4],
                                   .radius = radii[scene_next(&seed) % 8]};
        for (int i = 0; i < 16; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                x[i][axis] = nasty[scene_next(&seed) % 16];
                x[i][axis] = fabs(x[i][axis]) > 1e14 ? 1e14 : x[i][axis];
                row[i][axis] = (float)x[i][axis];
                if (i < 8) {
                    tip[i][axis] = nasty[scene_next(&seed) % 16];
                    tip[i][axis] = fabs(tip[i][axis]) > 1e14 ? 1e14 : tip[i][axis];
                    g[i][axis] = nasty[scene_next(&seed) % 16];
                    g[i][axis] = fabs(g[i][axis]) > 1e14 ? 1e14 : g[i][axis];
                }
            }
        error err = {""};
        points_order order;
        points p;
        if (csrbf_factor(solver, &settings, tip[0], NULL, count, &err) < 0 ||
            csrbf_solve(solver, g[0], &err) < 0)
            continue;
        ++solved;
        assert_int_equal(points_order_create(&order, row[0], 16, &err), MRT_OK);
        assert_int_equal(points_create(&p, &order, row[0], &err), MRT_OK);
        csrbf_responses(solver, response[0], POINTS_BLOCK, &p);
        double slope = csrbf_max_slope(solver, &p);
        double determinant = csrbf_min_determinant(solver, &p);
        (void)csrbf_move(solver, &p, &p);
        points_to_rows(row[0], &p, &order);
        csrbf_move_f64(solver, x[0], 16);
        assert_true(slope >= 0.0 && determinant == determinant);
        assert_true(csrbf_diagnose(solver).slope_bound >= 0.0);
        for (int i = 0; i < 16; ++i)
            for (int axis = 0; axis < 3; ++axis)
                assert_true(isfinite(x[i][axis]) && isfinite((double)row[i][axis]));
        for (uint32_t k = 0; k < count; ++k)
            for (int i = 0; i < 16; ++i)
                assert_true(isfinite((double)response[k][i]));
        points_destroy(&p);
        points_order_destroy(&order);
    }
    assert_true(solved > 1500);
}

static void thousands_of_controls_interpolate(void **state)
{
    (void)state;
    static double tip[CAPACITY][3], g[CAPACITY][3];
    csrbf_settings settings = {.radius = 0.25};
    uint64_t seed = 5;
    for (int i = 0; i < CAPACITY; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            tip[i][axis] = scene_number(&seed, 1.5);
            g[i][axis] = 0.25 * tip[i][axis] * tip[i][(axis + 1) % 3];
        }
    solve(&settings, tip[0], NULL, g[0], CAPACITY);
    csrbf_diagnostics d = csrbf_diagnose(solver);
    assert_true(d.envelope_count < 3000 * 3001 / 2);
    for (int i = 0; i < CAPACITY; i += 37)
        expect_displacement(tip[i], g[i][0], g[i][1], g[i][2], 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coincident_controls_move_by_their_mean),
        cmocka_unit_test(controls_closer_than_a_thousandth_of_the_radius_are_one),
        cmocka_unit_test(merged_controls_that_part_are_reported),
        cmocka_unit_test(a_chain_of_close_controls_is_one),
        cmocka_unit_test(skull_holds_jaw_and_jaw_holds_tips),
        cmocka_unit_test(merged_controls_share_a_response),
        cmocka_unit_test(flat_controls_restrict_the_polynomial),
        cmocka_unit_test(nearly_flat_controls_do_not_throw_what_is_far_from_them),
        cmocka_unit_test(no_controls_are_a_field_of_zero),
        cmocka_unit_test(one_control_is_a_bump_or_a_shift),
        cmocka_unit_test(any_radius_interpolates_or_is_refused),
        cmocka_unit_test(clusters_interpolate_or_are_refused),
        cmocka_unit_test(bad_settings_and_positions_leave_the_last_field),
        cmocka_unit_test(a_singular_system_is_refused),
        cmocka_unit_test(bad_displacements_leave_the_last_field),
        cmocka_unit_test(nasty_numbers_never_give_nan),
        cmocka_unit_test(thousands_of_controls_interpolate),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
