/* The parts of the deformation engine: kernels, envelope factor, hull, canonical order. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "csrbf/csrbf.h"
#include "csrbf/hull.h"
#include "csrbf/kernel.h"
#include "csrbf/saddle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const csrbf_kernel kernels[] = {CSRBF_WENDLAND_C0, CSRBF_WENDLAND_C2, CSRBF_WENDLAND_C4,
                                       CSRBF_WENDLAND_C6};

static void expect_near(double got, double expected, double limit)
{
    if (!(fabs(got - expected) <= limit))
        fail_msg("%.17g instead of %.17g (+-%g)", got, expected, limit);
}

/* ---- kernels ---- */

static void kernels_are_one_at_the_centre_and_zero_from_the_radius_on(void **state)
{
    (void)state;
    for (int k = 0; k < 4; ++k) {
        expect_near(kernel_value(kernels[k], 0.0), 1.0, 0.0);
        expect_near(kernel_value(kernels[k], 1.0), 0.0, 0.0);
        expect_near(kernel_value(kernels[k], 7.0), 0.0, 0.0);
        expect_near(kernel_slope(kernels[k], 1.0), 0.0, 0.0);
        assert_true(kernel_value(kernels[k], 0.99) > 0.0);
    }
}

/* At r = 1/2, by hand: (1/2)^2; (1/2)^4 3; (1/2)^6 (35/4 + 9 + 3) / 3; (1/2)^8 (4 + 25/4 + 5). */
static void kernels_have_the_published_values(void **state)
{
    (void)state;
    expect_near(kernel_value(CSRBF_WENDLAND_C0, 0.5), 0.25, 1e-16);
    expect_near(kernel_value(CSRBF_WENDLAND_C2, 0.5), 0.1875, 1e-16);
    expect_near(kernel_value(CSRBF_WENDLAND_C4, 0.5), 20.75 / 192.0, 1e-16);
    expect_near(kernel_value(CSRBF_WENDLAND_C6, 0.5), 15.25 / 256.0, 1e-16);
    /* The C2 one, multiplied out: 1 - 10 r^2 + 20 r^3 - 15 r^4 + 4 r^5. */
    for (double r = 0.0; r < 1.0; r += 0.0625)
        expect_near(kernel_value(CSRBF_WENDLAND_C2, r),
                    1 - 10 * r * r + 20 * r * r * r - 15 * r * r * r * r + 4 * r * r * r * r * r,
                    1e-14);
}

static void slopes_are_the_derivatives(void **state)
{
    (void)state;
    const double h = 1e-5;
    for (int k = 0; k < 4; ++k)
        for (double r = 0.0625; r < 1.0; r += 0.0625) {
            double difference =
                (kernel_value(kernels[k], r + h) - kernel_value(kernels[k], r - h)) / (2 * h);
            expect_near(kernel_slope(kernels[k], r) * r, difference, 1e-7);
        }
    expect_near(kernel_slope(CSRBF_WENDLAND_C2, 0.0), -20.0, 0.0); /* phi''(0) */
    expect_near(kernel_slope(CSRBF_WENDLAND_C0, 0.0), 0.0, 0.0);
}

static void the_steepest_slope_bounds_and_is_reached(void **state)
{
    (void)state;
    for (int k = 0; k < 4; ++k) {
        double largest = 0.0;
        for (int i = 1; i < 20000; ++i) {
            double r = i / 20000.0, slope = fabs(kernel_slope(kernels[k], r) * r);
            largest = slope > largest ? slope : largest;
        }
        assert_true(largest <= kernel_steepest(kernels[k]));
        expect_near(largest, kernel_steepest(kernels[k]), 2e-4);
    }
}

static void rows_agree_with_single_values(void **state)
{
    (void)state;
    const double radius = 1.25;
    float q32[POINTS_BLOCK], value32[POINTS_BLOCK];
    double q64[POINTS_BLOCK], value64[POINTS_BLOCK];
    for (int k = 0; k < 4; ++k) {
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            double distance = 1.5 * i / (POINTS_BLOCK - 1);
            q64[i] = distance * distance;
            q32[i] = (float)q64[i];
        }
        kernel_values_f64(kernels[k], value64, q64, 1.0 / radius, radius * radius);
        kernel_values_f32(kernels[k], value32, q32, (float)(1.0 / radius),
                          (float)(radius * radius));
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            double r = sqrt(q64[i]) / radius;
            expect_near(value64[i], kernel_value(kernels[k], r), 1e-15);
            expect_near((double)value32[i], kernel_value(kernels[k], r), 1e-6);
        }
    }
}

static void names_are_those_of_the_case_files(void **state)
{
    (void)state;
    csrbf_kernel kernel = CSRBF_WENDLAND_C0;
    csrbf_polynomial polynomial = CSRBF_LINEAR;
    assert_true(csrbf_kernel_named("wendland_c2", &kernel) && kernel == CSRBF_WENDLAND_C2);
    assert_true(csrbf_kernel_named("wendland_c0", &kernel) && kernel == CSRBF_WENDLAND_C0);
    assert_true(csrbf_kernel_named("wendland_c4", &kernel) && kernel == CSRBF_WENDLAND_C4);
    assert_true(csrbf_kernel_named("wendland_c6", &kernel) && kernel == CSRBF_WENDLAND_C6);
    assert_false(csrbf_kernel_named("Wendland_C2", &kernel));
    assert_true(kernel == CSRBF_WENDLAND_C6);
    assert_true(csrbf_polynomial_named("none", &polynomial) && polynomial == CSRBF_NONE);
    assert_true(csrbf_polynomial_named("constant", &polynomial) && polynomial == CSRBF_CONSTANT);
    assert_true(csrbf_polynomial_named("linear", &polynomial) && polynomial == CSRBF_LINEAR);
    assert_true(csrbf_polynomial_named("windowed", &polynomial) && polynomial == CSRBF_WINDOWED);
    assert_false(csrbf_polynomial_named("", &polynomial));
}

/* ---- envelope ---- */

enum { ROWS = 101 };

/* A symmetric, diagonally dominant matrix whose rows begin at uneven columns. */
static double matrix_entry(uint32_t i, uint32_t j)
{
    uint32_t high = i > j ? i : j, low = i > j ? j : i;
    if (high - low > (high * 7) % 40)
        return 0.0;
    return i == j ? 10.0 : sin((double)(high * 31 + low)) / 4.0;
}

static void fill(envelope *e, uint32_t rows)
{
    envelope_keep(e, 0);
    for (uint32_t i = 0; i < rows; ++i) {
        uint32_t first = 0;
        while (first < i && matrix_entry(i, first) == 0.0)
            ++first;
        double *row = envelope_add_row(e, first);
        for (uint32_t j = first; j <= i; ++j)
            *row++ = matrix_entry(i, j);
    }
}

/* The textbook's Cholesky, dense, row by row, sums over ascending columns. */
static void factor_dense(double l[ROWS][ROWS], uint32_t rows)
{
    memset(l, 0, sizeof(double[ROWS][ROWS]));
    for (uint32_t i = 0; i < rows; ++i)
        for (uint32_t j = 0; j <= i; ++j) {
            double sum = matrix_entry(i, j);
            for (uint32_t k = 0; k < j; ++k)
                sum -= l[i][k] * l[j][k];
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
}

static void the_envelope_factor_has_the_bits_of_the_dense_one(void **state)
{
    (void)state;
    static double dense[ROWS][ROWS];
    static const uint32_t sizes[] = {1, 2, 31, 32, 33, 64, 65, ROWS};
    envelope e;
    assert_true(envelope_create(&e, ROWS));
    for (int size = 0; size < 8; ++size) {
        uint32_t row = 0, rows = sizes[size];
        fill(&e, rows);
        assert_true(envelope_factor(&e, 1e-12, &row));
        factor_dense(dense, rows);
        for (uint32_t i = 0; i < rows; ++i)
            for (uint32_t j = 0; j <= i; ++j) {
                double got = j < e.first[i] ? 0.0 : e.value[e.start[i] + (j - e.first[i])];
                assert_true(got == dense[i][j]);
            }
    }
    assert_true(e.start[ROWS] < ROWS * (ROWS + 1) / 2);
    envelope_destroy(&e);
}

static void the_envelope_solves_its_system(void **state)
{
    (void)state;
    static double few[ROWS][ENVELOPE_FEW], many[ROWS][ENVELOPE_MANY];
    uint32_t row = 0;
    envelope e;
    assert_true(envelope_create(&e, ROWS));
    fill(&e, ROWS);
    for (uint32_t i = 0; i < ROWS; ++i)
        for (uint32_t k = 0; k < ENVELOPE_MANY; ++k) {
            many[i][k] = cos((double)(i + 3 * k));
            if (k < ENVELOPE_FEW)
                few[i][k] = many[i][k];
        }
    assert_true(envelope_factor(&e, 1e-12, &row));
    envelope_solve_few(&e, few[0]);
    envelope_solve_many(&e, many[0]);
    for (uint32_t i = 0; i < ROWS; ++i)
        for (uint32_t k = 0; k < ENVELOPE_MANY; ++k) {
            double sum = 0.0;
            for (uint32_t j = 0; j < ROWS; ++j)
                sum += matrix_entry(i, j) * many[j][k];
            expect_near(sum, cos((double)(i + 3 * k)), 1e-13);
            if (k < ENVELOPE_FEW)
                assert_true(few[i][k] == many[i][k]);
        }
    envelope_destroy(&e);
}

static void an_indefinite_matrix_is_refused_at_its_row(void **state)
{
    (void)state;
    envelope e;
    assert_true(envelope_create(&e, 40));
    uint32_t row = 0;
    envelope_keep(&e, 0);
    for (uint32_t i = 0; i < 40; ++i) {
        double *entry = envelope_add_row(&e, i == 37 ? 35 : i);
        if (i == 37) {
            *entry++ = 1.0; /* as long as the diagonal of row 35 */
            *entry++ = 0.0;
        }
        *entry = 1.0;
    }
    assert_false(envelope_factor(&e, 1e-12, &row));
    assert_int_equal(row, 37);
    envelope_destroy(&e);
}

/* ---- hull, order ---- */

static void a_hull_is_as_flat_as_its_points(void **state)
{
    (void)state;
    double row[4][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    hull h;
    hull_fit(&h, row[0], 4);
    assert_int_equal(h.dimension, 0);
    expect_near(h.centre[1], 2.0, 0.0);
    row[1][0] = 5;
    hull_fit(&h, row[0], 4);
    assert_int_equal(h.dimension, 1);
    expect_near(h.axis.at[0][0], 1.0, 1e-15);
    row[2][1] = 2.0 + 0.0042; /* off the line by a spread of 0.00343, 3.464 along it */
    hull_fit(&h, row[0], 4);
    assert_int_equal(h.dimension, 1);
    row[2][1] = 2.0 + 0.0043;
    hull_fit(&h, row[0], 4);
    assert_int_equal(h.dimension, 2);
    row[2][1] = 6;
    row[3][2] = 7;
    hull_fit(&h, row[0], 4);
    assert_int_equal(h.dimension, 3);
}

static void float_steps_far_from_the_origin_count_as_flat(void **state)
{
    (void)state;
    /* On a slanted line at 1e6, where floats are 0.0625 apart: off it by up to 0.5 % of it. */
    double row[9][3];
    for (int i = 0; i < 9; ++i)
        for (int axis = 0; axis < 3; ++axis)
            row[i][axis] = (double)(float)(1e6 + 0.37 * i * (axis + 1));
    hull h;
    hull_fit(&h, row[0], 9);
    assert_int_equal(h.dimension, 1);
}

static void the_canonical_order_does_not_depend_on_the_numbering(void **state)
{
    (void)state;
    enum { COUNT = 500 };
    static order_item a[COUNT], b[COUNT], scratch[COUNT];
    for (uint32_t i = 0; i < COUNT; ++i) {
        uint32_t from = (i * 7 + 3) % COUNT;
        a[i] = (order_item){.at = {sin((double)i), i % 10, i / 100}, .row = i};
        b[i] = (order_item){.at = {sin((double)from), from % 10, from / 100}, .row = from};
    }
    order_sort(a, scratch, COUNT);
    order_sort(b, scratch, COUNT);
    for (uint32_t i = 0; i < COUNT; ++i) {
        assert_memory_equal(a[i].at, b[i].at, sizeof a[i].at);
        assert_true(i == 0 || a[i - 1].key <= a[i].key);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_are_one_at_the_centre_and_zero_from_the_radius_on),
        cmocka_unit_test(kernels_have_the_published_values),
        cmocka_unit_test(slopes_are_the_derivatives),
        cmocka_unit_test(the_steepest_slope_bounds_and_is_reached),
        cmocka_unit_test(rows_agree_with_single_values),
        cmocka_unit_test(names_are_those_of_the_case_files),
        cmocka_unit_test(the_envelope_factor_has_the_bits_of_the_dense_one),
        cmocka_unit_test(the_envelope_solves_its_system),
        cmocka_unit_test(an_indefinite_matrix_is_refused_at_its_row),
        cmocka_unit_test(a_hull_is_as_flat_as_its_points),
        cmocka_unit_test(float_steps_far_from_the_origin_count_as_flat),
        cmocka_unit_test(the_canonical_order_does_not_depend_on_the_numbering),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
