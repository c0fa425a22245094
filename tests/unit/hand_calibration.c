/* hand/hand.h: raw sensor values become angles. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/hand.h"

#include <math.h>

static const float TOLERANCE_RAD = 1e-6f;

static void calibrate_one(const hand_calibration *calibration, int sensor, float raw,
                          float expected_rad)
{
    float in[MRT_ANGLES] = {0}, out[MRT_ANGLES];
    in[sensor] = raw;
    hand_calibrate(calibration, in, out);
    assert_float_equal(out[sensor], expected_rad, TOLERANCE_RAD);
}

static void identity_passes_radians_through(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_identity(&calibration);
    for (int i = 0; i < MRT_ANGLES; ++i)
        calibrate_one(&calibration, i, 0.01f * (float)i - 0.07f, 0.01f * (float)i - 0.07f);
}

static void table_is_linear_between_and_beyond_its_points(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_identity(&calibration);
    calibration.sensor[4] =
        (hand_table){.count = 3, .raw = {50, 100, 200}, .rad = {0.0f, 0.5f, 2.0f}};
    calibrate_one(&calibration, 4, 50, 0.0f);
    calibrate_one(&calibration, 4, 75, 0.25f);
    calibrate_one(&calibration, 4, 100, 0.5f);
    calibrate_one(&calibration, 4, 150, 1.25f);
    calibrate_one(&calibration, 4, 0, -0.5f);  /* 0.01 rad per count below */
    calibrate_one(&calibration, 4, 220, 2.3f); /* 0.015 rad per count above */
}

static void non_finite_raw_gives_the_middle_of_the_table(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_identity(&calibration);
    calibration.sensor[4] = (hand_table){.count = 2, .raw = {50, 150}, .rad = {0.2f, 1.0f}};
    calibrate_one(&calibration, 4, NAN, 0.6f);
    calibrate_one(&calibration, 4, INFINITY, 0.6f);
    calibrate_one(&calibration, 5, NAN, 0.0f);
}

static void angles_stay_within_half_a_turn(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_identity(&calibration);
    calibrate_one(&calibration, 4, 1e30f, 3.1415927f);
    calibrate_one(&calibration, 4, -7.0f, -3.1415927f);
    calibration.sensor[4] = (hand_table){.count = 2, .raw = {0, 1e-30f}, .rad = {0.0f, 1e30f}};
    calibrate_one(&calibration, 4, 1e30f, 3.1415927f);
}

static void damaged_tables_give_finite_angles(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_identity(&calibration);
    calibration.sensor[0] = (hand_table){.count = 1, .raw = {50}, .rad = {0.3f}};
    calibration.sensor[1] = (hand_table){.count = 2, .raw = {50, 50}, .rad = {0.3f, 0.4f}};
    calibration.sensor[2] = (hand_table){.count = 4000000000u, .raw = {1}, .rad = {0.1f}};
    calibration.sensor[3] = (hand_table){.count = 2, .raw = {NAN, 1}, .rad = {NAN, NAN}};
    float raw[MRT_ANGLES] = {50, 50, 50, 50}, out[MRT_ANGLES];
    hand_calibrate(&calibration, raw, out);
    for (int i = 0; i < MRT_ANGLES; ++i)
        assert_true(isfinite(out[i]));
    assert_float_equal(out[0], 0.3f, TOLERANCE_RAD);
}

/* DIP = 0.32 PIP^2 - 0.17 PIP, never below 0: at PIP 1.5, 0.72 - 0.255 = 0.465. */
static void missing_distal_joints_follow_the_middle_ones(void **state)
{
    (void)state;
    static const int middle[4] = {5, 8, 12, 16}, distal[4] = {6, 9, 13, 17};
    for (int finger = 0; finger < 4; ++finger) {
        hand_calibration calibration;
        hand_calibration_identity(&calibration);
        float raw[MRT_ANGLES] = {0}, out[MRT_ANGLES];
        raw[middle[finger]] = 1.5f;
        raw[distal[finger]] = -0.8f;
        hand_calibrate(&calibration, raw, out);
        assert_float_equal(out[distal[finger]], -0.8f, TOLERANCE_RAD);
        calibration.has_distal[finger] = false;
        hand_calibrate(&calibration, raw, out);
        assert_float_equal(out[distal[finger]], 0.465f, TOLERANCE_RAD);
        raw[middle[finger]] = -3.0f;
        hand_calibrate(&calibration, raw, out);
        assert_float_equal(out[distal[finger]], 0.0f, TOLERANCE_RAD);
        raw[middle[finger]] = 0.3f; /* 0.0288 - 0.051 is below 0 */
        hand_calibrate(&calibration, raw, out);
        assert_float_equal(out[distal[finger]], 0.0f, TOLERANCE_RAD);
    }
}

/* By hardware.md 2.1: index MPJ 0.020 rad a count from 90; spread -0.006 from 150; and raw counts
 * go up as the wrist bends towards the palm. */
static void default_turns_counts_into_a_hand(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_default(&calibration);
    calibrate_one(&calibration, 4, 90, 0.0f);
    calibrate_one(&calibration, 4, 140, 1.0f);
    calibrate_one(&calibration, 5, 165, 1.4f);
    calibrate_one(&calibration, 10, 100, 0.3f);
    calibrate_one(&calibration, 3, 120, 0.72f);
    calibrate_one(&calibration, 0, 74, 0.6f);
    calibrate_one(&calibration, 20, 181, 0.6956f);
    calibrate_one(&calibration, 21, 46, 0.2992f);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        assert_int_equal(calibration.sensor[i].count, 2);
        assert_true(calibration.sensor[i].raw[0] < calibration.sensor[i].raw[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(identity_passes_radians_through),
        cmocka_unit_test(table_is_linear_between_and_beyond_its_points),
        cmocka_unit_test(non_finite_raw_gives_the_middle_of_the_table),
        cmocka_unit_test(angles_stay_within_half_a_turn),
        cmocka_unit_test(damaged_tables_give_finite_angles),
        cmocka_unit_test(missing_distal_joints_follow_the_middle_ones),
        cmocka_unit_test(default_turns_counts_into_a_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
