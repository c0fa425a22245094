/* The real recordings, and the demo: all records are read, and a hand moved by them stays a hand.
 */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/filter.h"
#include "hand/hand.h"
#include "log_parse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct recording {
    const char *name;
    size_t record_count;
    double length_s;
} recordings[] = {
    {"00_calib-rad-su01.txt", 6674, 111.2},
    {"02_i_r_ex02-rad-021-grasp-su01.txt", 2131, 35.5},
    {"10_ex01-rad-003-grasp-su04.txt", 1145, 19.1},
};
enum { RECORDING_COUNT = sizeof recordings / sizeof recordings[0] };

static const float HAND_LENGTH = 190.0f;

/* False when the shared data are absent. */
static bool load_recording(log_data *out, size_t index)
{
    char path[1024], reason[LOG_REASON];
    const char *shared = getenv("MAROTTE_SHARED");
    snprintf(path, sizeof path, "%s/data/hands/%s", shared ? shared : SOURCE_DIR "/../shared",
             recordings[index].name);
    log_file file;
    if (log_file_read(&file, path, reason) < 0) {
        print_message("SKIPPED: %s: %s\n", path, reason);
        return false;
    }
    mrt_result result = log_parse(out, file.data, file.size, MRT_RIGHT, reason);
    free(file.data);
    if (result < 0)
        fail_msg("%s: %s", path, reason);
    return true;
}

static void load_demo(log_data *out)
{
    char reason[LOG_REASON];
    log_file file;
    if (log_file_read(&file, SOURCE_DIR "/plugins/log/demo_hand.csv", reason) < 0)
        fail_msg("demo_hand.csv: %s", reason);
    mrt_result result = log_parse(out, file.data, file.size, MRT_RIGHT, reason);
    free(file.data);
    if (result < 0)
        fail_msg("demo_hand.csv: %s", reason);
}

/* ---- a log as joints ---- */

typedef struct hand {
    float angle_rad[MRT_ANGLES];
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
} hand;

static void calibration_of(hand_calibration *out, const log_data *log)
{
    static const uint32_t distal[4] = {6, 9, 13, 17};
    hand_calibration_identity(out);
    for (int finger = 0; finger < 4; ++finger) {
        out->has_distal[finger] = false;
        for (uint32_t i = 0; i < log->channel_count; ++i)
            if (log->channel[i].semantic == MRT_CH_ANGLE + distal[finger])
                out->has_distal[finger] = true;
    }
}

static void hand_at(const hand_skeleton *skeleton, const hand_calibration *calibration,
                    const log_data *log, size_t record, hand *out)
{
    float raw[MRT_ANGLES] = {0};
    rigid wrist = rigid_identity();
    for (uint32_t i = 0; i < log->channel_count; ++i)
        raw[log->channel[i].semantic - MRT_CH_ANGLE] = log->value[record * log->channel_count + i];
    hand_calibrate(calibration, raw, out->angle_rad);
    hand_pose(skeleton, out->angle_rad, &wrist, out->joint, out->palm);
}

static hand hand_at_time(const log_data *log, double time_s)
{
    hand out;
    hand_calibration calibration;
    calibration_of(&calibration, log);
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, (double)HAND_LENGTH);
    assert_non_null(skeleton);
    size_t record = 0;
    while (record + 1 < log->record_count && (double)log->time_ns[record] < time_s * 1e9)
        ++record;
    hand_at(skeleton, &calibration, log, record, &out);
    hand_skeleton_destroy(skeleton);
    return out;
}

static float distance(mrt_vec3 a, mrt_vec3 b)
{
    return sqrtf((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/* The straight reach of a finger: wrist to its base, and its three bones. */
static float straight_reach(const hand *h, int finger)
{
    int base = 1 + 4 * finger;
    float reach = distance(h->joint[0], h->joint[base]);
    for (int i = base; i < base + 3; ++i)
        reach += distance(h->joint[i], h->joint[i + 1]);
    return reach;
}

static void assert_plausible(const log_data *log)
{
    hand_calibration calibration;
    calibration_of(&calibration, log);
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, (double)HAND_LENGTH);
    assert_non_null(skeleton);
    hand flat;
    float zero[MRT_ANGLES] = {0};
    rigid wrist = rigid_identity();
    hand_pose(skeleton, zero, &wrist, flat.joint, flat.palm);
    for (size_t k = 0; k < log->record_count; ++k) {
        hand h;
        hand_at(skeleton, &calibration, log, k, &h);
        for (int i = 0; i < MRT_JOINTS; ++i)
            assert_true(isfinite(h.joint[i].x + h.joint[i].y + h.joint[i].z));
        for (int i = 0; i < MRT_PALM; ++i)
            assert_true(isfinite(h.palm[i].x + h.palm[i].y + h.palm[i].z));
        for (int finger = 0; finger < 5; ++finger) {
            mrt_vec3 tip = h.joint[4 + 4 * finger];
            assert_true(distance(h.joint[0], tip) <= straight_reach(&flat, finger) + 0.01f);
        }
        /* No finger bends backwards over the hand by more than a quarter of its length. */
        for (int finger = 1; finger < 5; ++finger)
            assert_true(h.joint[4 + 4 * finger].y < 0.25f * HAND_LENGTH);
    }
    hand_skeleton_destroy(skeleton);
}

/* ---- the recordings ---- */

static void every_record_is_read(void **state)
{
    (void)state;
    for (size_t k = 0; k < RECORDING_COUNT; ++k) {
        log_data log;
        if (!load_recording(&log, k))
            skip();
        assert_int_equal(log.record_count, recordings[k].record_count);
        assert_int_equal(log.damaged_count, 0);
        double length_s = (double)log.time_ns[log.record_count - 1] * 1e-9;
        assert_true(fabs(length_s - recordings[k].length_s) < 0.1);
        log_data_finish(&log);
    }
}

static void every_pose_is_plausible(void **state)
{
    (void)state;
    for (size_t k = 0; k < RECORDING_COUNT; ++k) {
        log_data log;
        if (!load_recording(&log, k))
            skip();
        assert_plausible(&log);
        log_data_finish(&log);
    }
}

/* The spread sensors are recovered from the deviations of the fingers: only then do their values
 * lie on the sensor's own grid of steps. */
static void spreads_lie_on_the_grid_of_one_sensor(void **state)
{
    (void)state;
    static const struct {
        uint32_t channel;
        double step_rad;
    } spreads[3] = {{10, 0.00449}, {14, 0.00612}, {18, 0.00596}};
    log_data log;
    if (!load_recording(&log, 0))
        skip();
    for (int i = 0; i < 3; ++i) {
        double first = (double)log.value[spreads[i].channel];
        for (size_t k = 0; k < log.record_count; ++k) {
            double value = (double)log.value[k * log.channel_count + spreads[i].channel];
            double steps = (value - first) / spreads[i].step_rad;
            assert_true(fabs(steps - nearbyint(steps)) < 0.01);
        }
    }
    log_data_finish(&log);
}

/* Times found by eye in the calibration movements: flat 5 s, spread 10.5 s, fist 15 s, knuckles
 * bent 21 s, index aside 35 s, thumb to little finger 101 s, to ring finger 105 s. */
static void calibration_movements_are_what_they_show(void **state)
{
    (void)state;
    log_data log;
    if (!load_recording(&log, 0))
        skip();
    hand flat = hand_at_time(&log, 5.0), spread = hand_at_time(&log, 10.5);
    hand fist = hand_at_time(&log, 15.0), bent = hand_at_time(&log, 21.0);
    hand aside = hand_at_time(&log, 35.0), little = hand_at_time(&log, 101.0);
    for (int tip = 8; tip <= 16; tip += 4)
        assert_true(distance(spread.joint[tip], spread.joint[tip + 4]) >
                    distance(flat.joint[tip], flat.joint[tip + 4]) + 15.0f);
    assert_true(distance(spread.joint[4], spread.joint[6]) >
                distance(flat.joint[4], flat.joint[6]) + 15.0f);
    for (int tip = 8; tip <= 20; tip += 4) {
        assert_true(distance(flat.joint[0], flat.joint[tip]) > 0.7f * HAND_LENGTH);
        assert_true(distance(fist.joint[0], fist.joint[tip]) < 0.6f * HAND_LENGTH);
        assert_true(bent.joint[tip].y < bent.joint[tip - 3].y - 45.0f);
    }
    assert_true(fist.joint[4].x < flat.joint[4].x - 40.0f); /* thumb across the palm */
    assert_true(distance(aside.joint[8], aside.joint[12]) >
                distance(flat.joint[8], flat.joint[12]) + 20.0f);
    assert_true(distance(little.joint[4], little.joint[20]) < 40.0f);
    assert_true(distance(little.joint[4], little.joint[20]) <
                distance(little.joint[4], little.joint[8]));
    log_data_finish(&log);
}

/* At its end subject 1 touches the thumb with one fingertip after the other. With the sign of the
 * roll, the abduction or the arch turned round, the tips do not meet. */
static void thumb_meets_each_fingertip_in_turn(void **state)
{
    (void)state;
    log_data log;
    if (!load_recording(&log, 0))
        skip();
    float nearest[4] = {1e9f, 1e9f, 1e9f, 1e9f};
    int64_t when_ns[4] = {0};
    hand_calibration calibration;
    calibration_of(&calibration, &log);
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, (double)HAND_LENGTH);
    assert_non_null(skeleton);
    for (size_t k = 0; k < log.record_count; ++k) {
        hand h;
        if (log.time_ns[k] < INT64_C(95000000000) || log.time_ns[k] > INT64_C(102000000000))
            continue;
        hand_at(skeleton, &calibration, &log, k, &h);
        for (int finger = 0; finger < 4; ++finger) {
            float now = distance(h.joint[4], h.joint[8 + 4 * finger]);
            if (now >= nearest[finger])
                continue;
            nearest[finger] = now;
            when_ns[finger] = log.time_ns[k];
        }
    }
    hand_skeleton_destroy(skeleton);
    for (int finger = 0; finger < 4; ++finger) {
        assert_true(nearest[finger] < 25.0f); /* mm, between joint centres of the pads */
        assert_true(finger == 0 || when_ns[finger] > when_ns[finger - 1]);
    }
    log_data_finish(&log);
}

/* ---- the demo ---- */

static void demo_is_a_plausible_right_hand_of_20_s(void **state)
{
    (void)state;
    log_data log;
    load_demo(&log);
    assert_int_equal(log.record_count, 2000);
    assert_int_equal(log.damaged_count, 0);
    assert_int_equal(log.time_ns[1999], INT64_C(19990000000));
    for (uint32_t i = 0; i < log.channel_count; ++i)
        assert_int_equal(log.channel[i].hand, MRT_RIGHT);
    assert_plausible(&log);
    log_data_finish(&log);
}

/* How often the thumb tip turns from opening to closing, after the filter. */
static int syllables_between(const log_data *log, double from_s, double to_s)
{
    hand_filter filter;
    hand_calibration calibration;
    calibration_of(&calibration, log);
    hand_filter_init(&filter);
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, (double)HAND_LENGTH);
    assert_non_null(skeleton);
    int count = 0;
    bool is_opening = false;
    float extreme = 0.0f;
    for (size_t k = 0; k < log->record_count; ++k) {
        hand h;
        hand_at(skeleton, &calibration, log, k, &h);
        hand_filter_apply(&filter, h.angle_rad, log->time_ns[k]);
        rigid wrist = rigid_identity();
        hand_pose(skeleton, h.angle_rad, &wrist, h.joint, h.palm);
        double time_s = (double)log->time_ns[k] * 1e-9;
        float y = h.joint[4].y;
        if (time_s < from_s || time_s > to_s) {
            extreme = y;
            continue;
        }
        extreme = is_opening ? fminf(extreme, y) : fmaxf(extreme, y);
        if (fabsf(y - extreme) < 4.0f) /* mm */
            continue;
        is_opening = !is_opening;
        extreme = y;
        count += is_opening;
    }
    hand_skeleton_destroy(skeleton);
    return count;
}

static void demo_speaks_three_to_five_syllables_a_second(void **state)
{
    (void)state;
    log_data log;
    load_demo(&log);
    assert_int_equal(syllables_between(&log, 1.2, 4.5), 11);
    assert_int_equal(syllables_between(&log, 4.5, 4.9), 0); /* the pause */
    assert_int_equal(syllables_between(&log, 4.9, 8.2), 12);
    log_data_finish(&log);
}

static void demo_rests_at_both_ends(void **state)
{
    (void)state;
    log_data log;
    load_demo(&log);
    hand first = hand_at_time(&log, 0.0);
    static const double rests_s[] = {0.6, 1.2, 18.9, 19.99};
    for (size_t i = 0; i < sizeof rests_s / sizeof rests_s[0]; ++i) {
        hand later = hand_at_time(&log, rests_s[i]);
        for (int k = 0; k < MRT_JOINTS; ++k)
            assert_true(distance(first.joint[k], later.joint[k]) < 6.0f);
    }
    log_data_finish(&log);
}

static void demo_lifts_spreads_and_makes_a_fist(void **state)
{
    (void)state;
    log_data log;
    load_demo(&log);
    hand rest = hand_at_time(&log, 0.5), lift = hand_at_time(&log, 8.75);
    hand spread = hand_at_time(&log, 11.2), fist = hand_at_time(&log, 13.3);
    assert_true(lift.joint[8].y > rest.joint[8].y + 35.0f);
    assert_true(lift.joint[20].y < rest.joint[20].y + 8.0f);
    for (int tip = 8; tip <= 16; tip += 4)
        assert_true(distance(spread.joint[tip], spread.joint[tip + 4]) >
                    distance(rest.joint[tip], rest.joint[tip + 4]) + 10.0f);
    for (int tip = 8; tip <= 20; tip += 4)
        assert_true(fist.joint[tip].z < fist.joint[tip - 3].z);
    log_data_finish(&log);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_record_is_read),
        cmocka_unit_test(every_pose_is_plausible),
        cmocka_unit_test(spreads_lie_on_the_grid_of_one_sensor),
        cmocka_unit_test(calibration_movements_are_what_they_show),
        cmocka_unit_test(thumb_meets_each_fingertip_in_turn),
        cmocka_unit_test(demo_is_a_plausible_right_hand_of_20_s),
        cmocka_unit_test(demo_speaks_three_to_five_syllables_a_second),
        cmocka_unit_test(demo_rests_at_both_ends),
        cmocka_unit_test(demo_lifts_spreads_and_makes_a_fist),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
