/* Points in blocks, fields over them, and the meters of a field. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/csrbf.h"
#include "csrbf/kernel.h"

#include <math.h>
#include <string.h>

static const csrbf_kernel kernels[] = {CSRBF_WENDLAND_C0, CSRBF_WENDLAND_C2, CSRBF_WENDLAND_C4,
                                       CSRBF_WENDLAND_C6};

static void expect_near(double got, double expected, double limit)
{
    if (!(fabs(got - expected) <= limit))
        fail_msg("%.17g instead of %.17g (+-%g)", got, expected, limit);
}

static void make_points(points *out, points_order *order, const float *row, uint32_t count)
{
    error err = {""};
    if (points_order_create(order, row, count, &err) < 0 ||
        points_create(out, order, row, &err) < 0)
        fail_msg("%s", err.text);
}

static csrbf_solver *solved(const csrbf_settings *settings, const double *tip, const double *g,
                            uint32_t count)
{
    error err = {""};
    csrbf_solver *solver = csrbf_solver_create(count);
    assert_non_null(solver);
    if (csrbf_factor(solver, settings, tip, NULL, count, &err) < 0 ||
        csrbf_solve(solver, g, &err) < 0)
        fail_msg("%s", err.text);
    return solver;
}

/* A single centre folds if and only if |g| > R / max|phi'|: 64/135 R for C2. */
static void one_centre_folds_at_the_known_length(void **state)
{
    (void)state;
    enum { SAMPLES = 4001 };
    static float row[SAMPLES][3];
    points_order order;
    points p;
    for (int i = 0; i < SAMPLES; ++i)
        row[i][0] = (float)(-2.0 + 4.0 * i / (SAMPLES - 1));
    make_points(&p, &order, row[0], SAMPLES);
    for (int k = 1; k < 4; ++k) {
        csrbf_settings settings = {.kernel = kernels[k], .radius = 2.0};
        double fold = settings.radius / kernel_steepest(kernels[k]);
        const double tip[3] = {0, 0, 0};
        for (int step = 1; step <= 30; ++step) {
            const double g[3] = {fold * step / 20.0, 0, 0};
            csrbf_solver *solver = solved(&settings, tip, g, 1);
            double expected = 1.0 - step / 20.0;
            expect_near(csrbf_min_determinant(solver, &p), expected, 1e-4);
            expect_near(csrbf_max_slope(solver, &p), step / 20.0, 1e-4);
            expect_near(csrbf_diagnose(solver).slope_bound, step / 20.0, 1e-8);
            csrbf_solver_destroy(solver);
        }
    }
    csrbf_settings settings = {.radius = 1.0};
    assert_true(fabs(settings.radius / kernel_steepest(CSRBF_WENDLAND_C2) - 64.0 / 135.0) < 1e-15);
    points_destroy(&p);
    points_order_destroy(&order);
}

static const double four_tips[4][3] = {{0, 0, 0}, {0.75, 0, 0.25}, {0, 0.5, 0}, {0.25, 0.25, 1}};
static const double four_pulls[4][3] = {
    {0.125, 0, 0.25}, {0, -0.25, 0}, {0.25, 0.125, 0}, {0, 0, -0.25}};

/* grad d by central differences of the field itself. */
static void measure(double out[3][3], const csrbf_solver *solver, const double at[3])
{
    const double h = 1e-5;
    for (int b = 0; b < 3; ++b) {
        double low[3], high[3];
        memcpy(low, at, sizeof low);
        memcpy(high, at, sizeof high);
        low[b] -= h;
        high[b] += h;
        csrbf_move_f64(solver, low, 1);
        csrbf_move_f64(solver, high, 1);
        for (int a = 0; a < 3; ++a)
            out[a][b] = (high[a] - low[a]) / (2 * h) - (a == b ? 1.0 : 0.0);
    }
}

static double determinant(double g[3][3])
{
    double m[3][3];
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            m[a][b] = g[a][b] + (a == b ? 1.0 : 0.0);
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* The spectral norm by power iteration on g^T g. */
static double norm(double g[3][3])
{
    double v[3] = {0.6, -0.5, 0.62}, size = 0.0;
    for (int round = 0; round < 2000; ++round) {
        double w[3] = {0}, u[3] = {0};
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                w[a] += g[a][b] * v[b];
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                u[b] += g[a][b] * w[a];
        size = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        for (int b = 0; b < 3 && size > 0.0; ++b)
            v[b] = u[b] / size;
    }
    return sqrt(size);
}

static void meters_agree_with_differences_of_the_field(void **state)
{
    (void)state;
    static const float position[4][3] = {
        {0.3f, 0.2f, 0.1f}, {0.7f, 0.1f, 0.6f}, {-0.4f, 0.3f, 0.2f}, {1.6f, 0.2f, 0.3f}};
    for (int polynomial = CSRBF_NONE; polynomial <= CSRBF_WINDOWED; ++polynomial)
        for (int k = 0; k < 4; ++k)
            for (int i = 0; i < 4; ++i) {
                csrbf_settings settings = {.kernel = kernels[k],
                                           .polynomial = (csrbf_polynomial)polynomial,
                                           .radius = 1.125};
                csrbf_solver *solver = solved(&settings, four_tips[0], four_pulls[0], 4);
                points_order order;
                points p;
                make_points(&p, &order, position[i], 1);
                double g[3][3], at[3] = {(double)position[i][0], (double)position[i][1],
                                         (double)position[i][2]};
                measure(g, solver, at);
                expect_near(csrbf_min_determinant(solver, &p), determinant(g), 2e-5);
                /* C0 counts the tips of its cones, too. */
                if (kernels[k] == CSRBF_WENDLAND_C0)
                    assert_true(csrbf_max_slope(solver, &p) >= norm(g) - 2e-5);
                else
                    expect_near(csrbf_max_slope(solver, &p), norm(g), 2e-5);
                points_destroy(&p);
                points_order_destroy(&order);
                csrbf_solver_destroy(solver);
            }
}

static void a_cone_is_steepest_at_its_tip(void **state)
{
    (void)state;
    static const float vertex[3] = {0.5f, 0, 0};
    static const double tip[3] = {0.5, 0, 0}, g[3] = {0, 0.75, 1.0};
    csrbf_settings settings = {.kernel = CSRBF_WENDLAND_C0, .radius = 2.0};
    points_order order;
    points p;
    make_points(&p, &order, vertex, 1);
    csrbf_solver *solver = solved(&settings, tip, g, 1);
    expect_near(csrbf_max_slope(solver, &p), 2.0 * 1.25 / 2.0, 1e-15);
    csrbf_solver_destroy(solver);
    points_destroy(&p);
    points_order_destroy(&order);
}

/* On the rim of a support, to the last bits: what is not inside must keep its bits in float, too,
 * also a coordinate that is 0 and would show the smallest push. */
static void nothing_on_the_rim_of_a_support_is_touched(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    static float row[COUNT][3], back[COUNT][3];
    /* The second one takes the field's origin away from the first. */
    static const double tip[2][3] = {{33.3, 0.2, 0.0}, {-20.1, 7.7, 0.0}};
    static const double g[2][3] = {{0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}};
    for (int round = 0; round < 8; ++round) {
        csrbf_settings settings = {.radius = 0.7 + 0.4 * round};
        points_order order;
        points p;
        int outside = 0;
        for (int i = 0; i < COUNT; ++i) {
            row[i][0] = (float)(tip[0][0] + settings.radius * cos(i * 0.01));
            row[i][1] = (float)(tip[0][1] + settings.radius * sin(i * 0.01));
            row[i][2] = -0.0f;
        }
        make_points(&p, &order, row[0], COUNT);
        csrbf_solver *solver = solved(&settings, tip[0], g[0], 2);
        assert_true(csrbf_move(solver, &p, &p) > 0);
        points_to_rows(back[0], &p, &order);
        for (int i = 0; i < COUNT; ++i) {
            double dx = (double)row[i][0] - tip[0][0], dy = (double)row[i][1] - tip[0][1];
            if (sqrt(dx * dx + dy * dy) < settings.radius)
                continue;
            ++outside;
            assert_memory_equal(row[i], back[i], sizeof row[i]);
        }
        assert_true(outside > COUNT / 4);
        csrbf_solver_destroy(solver);
        points_destroy(&p);
        points_order_destroy(&order);
    }
}

static void a_ridge_gives_way(void **state)
{
    (void)state;
    static const double tip[3] = {0, 0, 0}, g[3] = {1, 0, 0};
    csrbf_settings settings = {.radius = 1.0, .ridge = 0.25};
    csrbf_solver *solver = solved(&settings, tip, g, 1);
    double x[3] = {0, 0, 0};
    csrbf_move_f64(solver, x, 1);
    expect_near(x[0], 0.8, 1e-15); /* 1 / (1 + ridge) */
    csrbf_solver_destroy(solver);
}

static void points_go_to_blocks_and_back(void **state)
{
    (void)state;
    enum { COUNT = 131 };
    static float row[COUNT][3], back[COUNT][3];
    points_order order;
    points p;
    for (int i = 0; i < COUNT; ++i)
        for (int axis = 0; axis < 3; ++axis)
            row[i][axis] = (float)((i * (axis + 3) * 37) % 101) - 50.0f;
    make_points(&p, &order, row[0], COUNT);
    assert_int_equal(p.block_count, 3);
    assert_int_equal(p.padded_count, 192);
    assert_int_equal((uintptr_t)p.x % 64, 0);
    assert_int_equal((uintptr_t)p.y % 64, 0);
    assert_int_equal((uintptr_t)p.z % 64, 0);
    for (uint32_t i = 0; i < COUNT; ++i)
        assert_int_equal(order.slot_of_file[order.file_of_slot[i]], i);
    for (uint32_t i = COUNT; i < p.padded_count; ++i)
        assert_true(p.x[i] == p.x[COUNT - 1] && p.z[i] == p.z[COUNT - 1]);
    for (uint32_t i = 0; i < p.padded_count; ++i) {
        const points_bounds *block = &p.block[i / POINTS_BLOCK];
        assert_true(block->low[1] <= p.y[i] && p.y[i] <= block->high[1]);
    }
    points_to_rows(back[0], &p, &order);
    assert_memory_equal(row, back, sizeof row);
    points_destroy(&p);
    points_order_destroy(&order);
    make_points(&p, &order, row[0], 0);
    assert_int_equal(p.block_count, 0);
    points_update_bounds(&p);
    points_destroy(&p);
    points_order_destroy(&order);
}

static void bad_coordinates_are_refused_by_their_vertex(void **state)
{
    (void)state;
    float row[3][3] = {{0}};
    error err = {""};
    points_order order;
    row[2][1] = NAN;
    assert_int_equal(points_order_create(&order, row[0], 3, &err), MRT_ERR_ARGUMENT);
    assert_string_equal(err.text, "vertex 2: coordinate nan is not within +-1e+15");
    row[2][1] = 2e15f;
    assert_int_equal(points_order_create(&order, row[0], 3, &err), MRT_ERR_ARGUMENT);
}

static void culled_blocks_change_no_bit(void **state)
{
    (void)state;
    enum { COUNT = 2000 };
    static float row[COUNT][3], culled[COUNT][3], dense[COUNT][3];
    csrbf_settings settings = {.radius = 0.5};
    points_order order;
    points p;
    for (int i = 0; i < COUNT; ++i)
        for (int axis = 0; axis < 3; ++axis)
            row[i][axis] = (float)(2.0 * sin(i * (1.0 + axis) * 0.7));
    make_points(&p, &order, row[0], COUNT);
    csrbf_solver *solver = solved(&settings, four_tips[0], four_pulls[0], 4);
    points out;
    error err = {""};
    assert_int_equal(points_create(&out, &order, row[0], &err), MRT_OK);
    uint32_t moved = csrbf_move(solver, &out, &p);
    assert_true(moved > 0 && moved < p.block_count);
    points_to_rows(culled[0], &out, &order);
    for (uint32_t block = 0; block < p.block_count; ++block) /* bounds that cull nothing */
        p.block[block] = (points_bounds){{-9, -9, -9}, {9, 9, 9}};
    assert_int_equal(csrbf_move(solver, &p, &p), p.block_count);
    points_to_rows(dense[0], &p, &order);
    assert_memory_equal(culled, dense, sizeof dense);
    points_destroy(&out);
    points_destroy(&p);
    points_order_destroy(&order);
    csrbf_solver_destroy(solver);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_centre_folds_at_the_known_length),
        cmocka_unit_test(meters_agree_with_differences_of_the_field),
        cmocka_unit_test(a_cone_is_steepest_at_its_tip),
        cmocka_unit_test(nothing_on_the_rim_of_a_support_is_touched),
        cmocka_unit_test(a_ridge_gives_way),
        cmocka_unit_test(points_go_to_blocks_and_back),
        cmocka_unit_test(bad_coordinates_are_refused_by_their_vertex),
        cmocka_unit_test(culled_blocks_change_no_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
