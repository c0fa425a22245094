/* hand/filter.h: the One-Euro filter against steps written out by hand. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/filter.h"

#include <math.h>

static const float TOLERANCE = 2e-6f;
enum { JAW_SENSOR = 3, FINGER_SENSOR = 5, WRIST_SENSOR = 21 };
static const float RADIAN = 0.017453293f; /* of a degree */

/* dt 0.1 s, min cutoff 1 Hz, beta 0.5, derivative cutoff 1 Hz.
 * alpha(fc) = 1 / (1 + 1 / (2 pi fc dt)); alpha(1) = 1 / (1 + 1 / 0.628319) = 0.385870.
 *   x 0: the first value: 0
 *   x 1: slope (1 - 0) / 0.1 = 10; derivative 0.385870 * 10 = 3.858695;
 *        fc 1 + 0.5 * 3.858695 = 2.929348; alpha 0.647957; value 0.647957
 *   x 1: slope (1 - 0.647957) / 0.1 = 3.520428;
 *        derivative 3.858695 + 0.385870 * (3.520428 - 3.858695) = 3.728168; fc 2.864084;
 *        alpha 0.642801; value 0.647957 + 0.642801 * 0.352043 = 0.874251
 *   x 0: slope -8.742506; derivative 3.728168 + 0.385870 * (-8.742506 - 3.728168) = -1.083885;
 *        fc 1.541942; alpha 0.492084; value 0.874251 * (1 - 0.492084) = 0.444045 */
static void step_follows_the_equations(void **state)
{
    (void)state;
    static const filter_settings settings = {1.0f, 0.5f, 1.0f};
    filter_state filter = {0};
    assert_float_equal(filter_step(&filter, &settings, 0.0f, 0.1), 0.0f, TOLERANCE);
    assert_float_equal(filter_step(&filter, &settings, 1.0f, 0.1), 0.647957f, TOLERANCE);
    assert_float_equal(filter_step(&filter, &settings, 1.0f, 0.1), 0.874251f, TOLERANCE);
    assert_float_equal(filter_step(&filter, &settings, 0.0f, 0.1), 0.444045f, TOLERANCE);
}

static void first_value_passes_unchanged(void **state)
{
    (void)state;
    static const filter_settings settings = {1.0f, 0.0f, 1.0f};
    filter_state filter = {0};
    assert_float_equal(filter_step(&filter, &settings, 0.75f, 0.01), 0.75f, 0.0f);
    assert_true(filter.running);
}

static void no_time_or_no_number_resets(void **state)
{
    (void)state;
    static const filter_settings settings = {1.0f, 0.5f, 1.0f};
    filter_state filter = {0};
    filter_step(&filter, &settings, 0.0f, 0.1);
    filter_step(&filter, &settings, 1.0f, 0.1);
    assert_float_equal(filter_step(&filter, &settings, 5.0f, 0.0), 5.0f, 0.0f);
    assert_float_equal(filter.derivative, 0.0f, 0.0f);
    assert_float_equal(filter_step(&filter, &settings, 6.0f, -0.1), 6.0f, 0.0f);
    assert_float_equal(filter_step(&filter, &settings, 7.0f, (double)NAN), 7.0f, 0.0f);
    assert_float_equal(filter_step(&filter, &settings, NAN, 0.1), 7.0f, 0.0f);
    assert_false(filter.running);
    assert_float_equal(filter_step(&filter, &settings, 2.0f, 0.1), 2.0f, 0.0f);
}

static float second_output(int sensor)
{
    hand_filter filter;
    hand_filter_init(&filter);
    float angle[MRT_ANGLES] = {0};
    hand_filter_apply(&filter, angle, 0);
    angle[sensor] = RADIAN;
    hand_filter_apply(&filter, angle, 10000000);
    return angle[sensor] / RADIAN;
}

/* One degree in 10 ms is a slope of 100 deg/s.
 * Jaw: derivative 100 / (1 + 1 / (0.04 pi)) = 11.163521 deg/s; fc 2 + 0.1 * 11.163521 = 3.116352;
 *      alpha 1 / (1 + 1 / (0.02 pi 3.116352)) = 0.163744
 * Finger: fc 2 + 0.05 * 11.163521 = 2.558176; alpha 0.138477
 * Wrist: derivative 100 / (1 + 1 / (0.02 pi)) = 5.911740; fc 1.295587; alpha 0.075276 */
static void groups_have_their_settings_in_degrees(void **state)
{
    (void)state;
    assert_float_equal(second_output(JAW_SENSOR), 0.163744f, 2e-6f);
    assert_float_equal(second_output(0), 0.163744f, 2e-6f);
    assert_float_equal(second_output(14), 0.163744f, 2e-6f);
    assert_float_equal(second_output(FINGER_SENSOR), 0.138477f, 2e-6f);
    assert_float_equal(second_output(17), 0.138477f, 2e-6f);
    assert_float_equal(second_output(19), 0.075276f, 2e-6f);
    assert_float_equal(second_output(WRIST_SENSOR), 0.075276f, 2e-6f);
}

/* Applies x at 0 ms to a running filter at 0, then y at time_ns; returns the output. */
static float after(float y, int64_t time_ns)
{
    hand_filter filter;
    hand_filter_init(&filter);
    float angle[MRT_ANGLES] = {0};
    hand_filter_apply(&filter, angle, 1000000000);
    angle[JAW_SENSOR] = y;
    hand_filter_apply(&filter, angle, time_ns);
    return angle[JAW_SENSOR];
}

static void gap_resets_and_just_less_does_not(void **state)
{
    (void)state;
    assert_float_equal(after(1.0f, 1250000001), 1.0f, 0.0f);
    assert_true(after(1.0f, 1250000000) < 1.0f);
}

static void time_backwards_resets(void **state)
{
    (void)state;
    assert_float_equal(after(1.0f, 999999999), 1.0f, 0.0f);
    assert_float_equal(after(1.0f, INT64_MIN), 1.0f, 0.0f);
    assert_float_equal(after(1.0f, INT64_MAX), 1.0f, 0.0f);
}

static void same_time_repeats_the_last_output_and_changes_nothing(void **state)
{
    (void)state;
    hand_filter filter, undisturbed;
    hand_filter_init(&filter);
    hand_filter_init(&undisturbed);
    float a[MRT_ANGLES] = {0}, b[MRT_ANGLES] = {0};
    hand_filter_apply(&filter, a, 0);
    hand_filter_apply(&undisturbed, b, 0);
    a[JAW_SENSOR] = 3.0f;
    hand_filter_apply(&filter, a, 0);
    assert_float_equal(a[JAW_SENSOR], 0.0f, 0.0f);
    a[JAW_SENSOR] = b[JAW_SENSOR] = 1.0f;
    hand_filter_apply(&filter, a, 10000000);
    hand_filter_apply(&undisturbed, b, 10000000);
    assert_float_equal(a[JAW_SENSOR], b[JAW_SENSOR], 0.0f);
}

static void rest_noise_shrinks_and_a_ramp_is_followed(void **state)
{
    (void)state;
    hand_filter filter;
    hand_filter_init(&filter);
    float angle[MRT_ANGLES] = {0}, widest = 0.0f;
    for (int i = 0; i < 200; ++i) {
        angle[FINGER_SENSOR] = i % 2 ? 0.5f * RADIAN : -0.5f * RADIAN;
        hand_filter_apply(&filter, angle, i * INT64_C(10000000));
        if (i > 100)
            widest = fmaxf(widest, fabsf(angle[FINGER_SENSOR]));
    }
    assert_true(widest < 0.1f * RADIAN);
    for (int i = 0; i < 100; ++i) { /* 100 degrees a second */
        angle[FINGER_SENSOR] = (float)i * RADIAN;
        hand_filter_apply(&filter, angle, (200 + i) * INT64_C(10000000));
    }
    assert_true(99.0f * RADIAN - angle[FINGER_SENSOR] < 4.0f * RADIAN); /* under 40 ms behind */
}

static void reset_forgets(void **state)
{
    (void)state;
    hand_filter filter;
    hand_filter_init(&filter);
    float angle[MRT_ANGLES] = {0};
    hand_filter_apply(&filter, angle, 0);
    hand_filter_reset(&filter);
    angle[0] = 1.0f;
    hand_filter_apply(&filter, angle, 10000000);
    assert_float_equal(angle[0], 1.0f, 0.0f);
    assert_float_equal(filter.jaw.beta, 0.1f, 0.0f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(step_follows_the_equations),
        cmocka_unit_test(first_value_passes_unchanged),
        cmocka_unit_test(no_time_or_no_number_resets),
        cmocka_unit_test(groups_have_their_settings_in_degrees),
        cmocka_unit_test(gap_resets_and_just_less_does_not),
        cmocka_unit_test(time_backwards_resets),
        cmocka_unit_test(same_time_repeats_the_last_output_and_changes_nothing),
        cmocka_unit_test(rest_noise_shrinks_and_a_ramp_is_followed),
        cmocka_unit_test(reset_forgets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
