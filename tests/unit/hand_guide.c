/* hand/guide.h: ten poses of a glove become a calibration; what cannot be a pose is refused. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand_guide_bench.h"

/* ---- the main path ---- */

static void ten_poses_give_the_glove_s_own_gains(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_LEFT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_STEPS);
    calibration_file file;
    error err = {""};
    assert_int_equal(guide_result(g.guide, &file, &err), MRT_OK);
    assert_int_equal(file.side, MRT_LEFT);
    assert_int_equal(calibration_file_sensor_count(&file), 22);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const calibration_sensor *sensor = &file.sensor[i];
        sensor_kind kind = sensor_table[i].kind;
        bool is_measured = kind != SENSOR_PALM && kind != SENSOR_WRIST;
        assert_int_equal(sensor->source, is_measured ? CALIBRATION_MEASURED : CALIBRATION_ZEROED);
        /* At 10 degrees it reads 10 degrees; a count of rounding at either end is within 2. */
        double ten = hand_table_value(&sensor->table, g.zero[i] + 10.0 * g.counts[i]);
        if (is_measured)
            assert_float_equal((float)ten, 0.174533f, 0.035f);
        assert_float_equal((float)hand_table_value(&sensor->table, g.zero[i]), 0.0f, 0.025f);
        assert_true(sensor->has_range && sensor->raw_range[0] <= sensor->raw_range[1]);
        if (is_measured && kind != SENSOR_ROLL) /* the thumb is back in the plane only once */
            assert_true(sensor->has_residual && sensor->residual_rad < 0.03f);
    }
    assert_float_equal(file.sensor[SENSOR_INDEX_MPJ].neutral_rad, 0.5236f, 0.03f);
    assert_float_equal(file.sensor[SENSOR_THUMB_ROLL].neutral_rad, 0.6981f, 0.03f);
    assert_float_equal(file.sensor[SENSOR_MIDDLE_MPJ].cross_talk[SENSOR_RING_MPJ], 0.5f, 0.03f);
    assert_true(fabsf(file.sensor[SENSOR_MIDDLE_MPJ].cross_talk[SENSOR_LITTLE_MPJ]) < 0.04f);
    guide_destroy(g.guide);
}

static void shipped_gains_hold_where_poses_tell_only_the_zero(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_18);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_STEPS);
    calibration_file file;
    error err = {""};
    assert_int_equal(guide_result(g.guide, &file, &err), MRT_OK);
    assert_int_equal(calibration_file_sensor_count(&file), 18);
    assert_int_equal(file.sensor[6].table.count, 0);
    const hand_table *pitch = &file.sensor[SENSOR_WRIST_PITCH].table;
    double zero = g.zero[SENSOR_WRIST_PITCH];
    double ten_counts = hand_table_value(pitch, zero + 10.0) - hand_table_value(pitch, zero);
    assert_float_equal((float)ten_counts, 0.148f, 1e-4f);
    guide_destroy(g.guide);
}

/* A spread sensor that the cloth pulls when the fingers next to it bend reads spreads that are not
 * there; only the poses that do not bend them count, and there it is off by 5 degrees. */
static void residual_is_what_a_known_pose_is_misread_by(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_THUMB_ALONE);
    for (guide_step step = GUIDE_THUMB_ALONE; step < GUIDE_STEPS; ++step) {
        double pose[MRT_ANGLES];
        pose_of(pose, step);
        pose[5] += step == GUIDE_INDEX_ALONE ? 0.0 : 5.0; /* the index finger's middle joint */
        go(&g, pose, 1.5);
        assert_int_equal(g.news, GUIDE_TAKEN);
    }
    calibration_file file;
    error err = {""};
    assert_int_equal(guide_result(g.guide, &file, &err), MRT_OK);
    /* 0 in the spread, 5 with the thumb, the ring and the little finger: 5 * sqrt(3 / 4). */
    assert_float_equal(file.sensor[5].residual_rad, 0.0756f, 0.01f);
    guide_destroy(g.guide);
}

/* ---- when a pose is taken ---- */

static void a_pose_is_not_taken_before_the_hand_has_moved(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform(&g, GUIDE_RELAXED);
    assert_int_equal(guide_current(g.guide), GUIDE_FLAT);
    assert_int_equal(guide_waiting(g.guide), GUIDE_WAITS_FOR_MOVEMENT);
    go(&g, g.pose, 10.0);
    assert_int_equal(guide_current(g.guide), GUIDE_FLAT);
    assert_false(guide_has(g.guide, GUIDE_FLAT));
    guide_destroy(g.guide);
}

static void a_pose_is_not_taken_while_the_hand_moves(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    for (int k = 0; k < 1500; ++k) { /* 10 s of 20 degrees to and fro */
        g.pose[SENSOR_INDEX_MPJ] = k % 150 < 75 ? k % 75 * 0.27 : 20.0 - k % 75 * 0.27;
        sample(&g);
    }
    assert_int_equal(g.news, GUIDE_NOTHING);
    assert_int_equal(guide_waiting(g.guide), GUIDE_WAITS_FOR_STILLNESS);
    guide_destroy(g.guide);
}

static void next_takes_the_pose_at_once(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    assert_int_equal(guide_next(g.guide), GUIDE_REFUSED);
    assert_string_equal(guide_reason(g.guide), "the glove gives no samples");
    sample(&g);
    assert_int_equal(guide_next(g.guide), GUIDE_TAKEN);
    assert_int_equal(guide_next(g.guide), GUIDE_TAKEN);
    assert_int_equal(guide_current(g.guide), GUIDE_FIST);
    guide_destroy(g.guide);
}

/* ---- what is refused ---- */

static void a_fist_like_the_flat_hand_is_refused_and_names_the_sensors(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_FIST);
    double pose[MRT_ANGLES];
    pose_of(pose, GUIDE_FLAT);
    pose[SENSOR_THUMB_MPJ] = 30;                         /* something moved, but no finger */
    pose[SENSOR_INDEX_MPJ] = pose[SENSOR_RING_MPJ] = 90; /* and two knuckles */
    go(&g, pose, 1.5);
    assert_int_equal(g.news, GUIDE_REFUSED);
    assert_int_equal(guide_current(g.guide), GUIDE_FIST);
    assert_non_null(strstr(g.reason, "10 of 12 sensors hardly moved"));
    assert_non_null(strstr(g.reason, "middle knuckle by "));
    assert_non_null(strstr(g.reason, "middle finger, middle joint by "));
    assert_null(strstr(g.reason, "index knuckle"));
    perform(&g, GUIDE_FIST); /* and can be done right then */
    assert_int_equal(g.news, GUIDE_TAKEN);
    guide_destroy(g.guide);
}

static void one_dead_sensor_is_said_and_keeps_the_shipped_gain(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    g.counts[SENSOR_RING_MPJ] = 0;
    perform_until(&g, GUIDE_FIST);
    perform(&g, GUIDE_FIST);
    assert_int_equal(g.news, GUIDE_TAKEN);
    assert_non_null(strstr(g.reason, "1 of 12 sensors hardly moved"));
    assert_non_null(strstr(g.reason, "ring knuckle by 0"));
    perform_until(&g, GUIDE_STEPS);
    calibration_file file;
    error err = {""};
    assert_int_equal(guide_result(g.guide, &file, &err), MRT_OK);
    assert_int_equal(file.sensor[SENSOR_RING_MPJ].source, CALIBRATION_ZEROED);
    guide_destroy(g.guide);
}

static void the_wrong_finger_is_refused_by_name(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_INDEX_ALONE);
    perform(&g, GUIDE_RING_ALONE);
    assert_int_equal(g.news, GUIDE_REFUSED);
    assert_string_equal(g.reason, "the ring finger is bent more than the index finger");
    double pose[MRT_ANGLES];
    pose_of(pose, GUIDE_FLAT);
    pose[SENSOR_INDEX_MPJ] = 20;
    go(&g, pose, 1.5);
    assert_int_equal(g.news, GUIDE_REFUSED);
    assert_non_null(strstr(g.reason, "the index finger is bent by only"));
    guide_destroy(g.guide);
}

static void the_flat_hand_cannot_be_skipped_the_others_can(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    calibration_file file;
    error err = {""};
    assert_int_equal(guide_skip(g.guide), GUIDE_SKIPPED);
    assert_int_equal(guide_skip(g.guide), GUIDE_REFUSED);
    assert_int_equal(guide_current(g.guide), GUIDE_FLAT);
    assert_true(guide_result(g.guide, &file, &err) < 0);
    perform(&g, GUIDE_FLAT);
    while (guide_current(g.guide) < GUIDE_STEPS)
        assert_int_equal(guide_skip(g.guide), GUIDE_SKIPPED);
    assert_int_equal(guide_skip(g.guide), GUIDE_NOTHING);
    assert_int_equal(guide_result(g.guide, &file, &err), MRT_OK);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        assert_int_equal(file.sensor[i].source, CALIBRATION_ZEROED);
        assert_true(file.sensor[i].neutral_rad == sensor_table[i].neutral_rad);
        assert_false(file.sensor[i].has_residual);
    }
    guide_destroy(g.guide);
}

static void a_step_can_be_repeated_and_the_later_pose_counts(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_FIST);
    double half[MRT_ANGLES];
    pose_of(half, GUIDE_FIST);
    for (int i = 0; i < MRT_ANGLES; ++i)
        half[i] *= 0.6;
    go(&g, half, 1.5);
    assert_int_equal(g.news, GUIDE_TAKEN);
    guide_repeat(g.guide);
    assert_int_equal(guide_current(g.guide), GUIDE_FIST);
    assert_false(guide_has(g.guide, GUIDE_FIST));
    perform_until(&g, GUIDE_STEPS);
    calibration_file file;
    error err = {""};
    assert_int_equal(guide_result(g.guide, &file, &err), MRT_OK);
    double fist = g.zero[SENSOR_INDEX_MPJ] + 90.0 * g.counts[SENSOR_INDEX_MPJ];
    assert_float_equal((float)hand_table_value(&file.sensor[SENSOR_INDEX_MPJ].table, fist), 1.5708f,
                       0.03f);
    guide_repeat(g.guide); /* also when all was done */
    assert_int_equal(guide_current(g.guide), GUIDE_LITTLE_ALONE);
    guide_destroy(g.guide);
}

static void a_pose_made_again_may_be_skipped_and_the_old_one_counts(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_STEPS);
    for (guide_step step = GUIDE_RELAXED; step < GUIDE_STEPS; ++step) {
        guide_again(g.guide, step);
        assert_int_equal(guide_current(g.guide), step);
        assert_int_equal(guide_waiting(g.guide), GUIDE_WAITS_FOR_MOVEMENT);
        assert_int_equal(guide_skip(g.guide), GUIDE_SKIPPED);
        assert_int_equal(guide_current(g.guide), GUIDE_STEPS);
        assert_true(guide_has(g.guide, step));
    }
    guide_again(g.guide, GUIDE_FIST);
    guide_repeat(g.guide); /* further back: from there all the way */
    assert_int_equal(guide_current(g.guide), GUIDE_FLAT);
    perform(&g, GUIDE_FLAT);
    assert_int_equal(guide_current(g.guide), GUIDE_FIST);
    guide_destroy(g.guide);
}

/* ---- time ---- */

static void a_step_without_a_pose_times_out_and_says_why(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    settings.timeout_s = 5.0;
    glove g = put_on(&settings);
    perform(&g, GUIDE_RELAXED);
    go(&g, g.pose, 6.0);
    assert_int_equal(g.news, GUIDE_TIMED_OUT);
    assert_string_equal(g.reason, "flat hand: nothing was taken within 5 s: the hand did not move "
                                  "into another pose");
    guide_destroy(g.guide);
}

static void a_device_that_is_away_costs_no_time_and_no_pose(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    settings.timeout_s = 5.0;
    glove g = put_on(&settings);
    perform(&g, GUIDE_RELAXED);
    g.time_ns += 3600000000000;
    perform(&g, GUIDE_FLAT);
    assert_int_equal(g.news, GUIDE_TAKEN);
    assert_int_equal(guide_current(g.guide), GUIDE_FIST);
    guide_destroy(g.guide);
}

static void values_that_are_no_numbers_are_ignored(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_18);
    guide *self = guide_create(&settings);
    float raw[MRT_ANGLES] = {0}, low[MRT_ANGLES], high[MRT_ANGLES];
    raw[6] = NAN; /* the glove lacks it */
    assert_int_equal(guide_sample(self, raw, 0), GUIDE_NOTHING);
    raw[0] = NAN;
    assert_int_equal(guide_sample(self, raw, 10000000), GUIDE_NOTHING);
    raw[0] = INFINITY;
    assert_int_equal(guide_sample(self, raw, INT64_MAX), GUIDE_NOTHING);
    raw[0] = 1;
    assert_int_equal(guide_sample(self, raw, INT64_MIN), GUIDE_NOTHING);
    guide_range(self, low, high);
    assert_true(low[0] == 0.0f && high[0] == 1.0f && high[6] == 0.0f);
    guide_destroy(self);
    guide_destroy(NULL);
}

/* ---- a bare hand, as a camera sees it: 30 times a second, in rad ---- */

static const double rad_per_degree = 0.017453292519943295;

typedef struct seen {
    guide *guide;
    int64_t time_ns;
    uint32_t noise;
    double pose[MRT_ANGLES]; /* degrees, where the hand is */
    guide_news news;         /* the last that was not GUIDE_NOTHING */
} seen;

/* Flexions as 6 degrees and 0.75 of what they are, spreads as 2 degrees and 0.6. */
static double as_seen(int sensor, double degrees)
{
    bool is_spread = sensor_table[sensor].kind == SENSOR_SPREAD;
    return rad_per_degree * (is_spread ? 2.0 + 0.6 * degrees : 6.0 + 0.75 * degrees);
}

static void look(seen *s)
{
    float raw[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i) {
        s->noise = s->noise * 1664525u + 1013904223u;
        double jitter = (double)(s->noise >> 24) / 256.0 - 0.5; /* within 2.5 degrees */
        raw[i] = (float)(as_seen(i, s->pose[i]) + 5.0 * rad_per_degree * jitter);
    }
    guide_news news = guide_sample(s->guide, raw, s->time_ns);
    s->time_ns += 33333333;
    s->news = news == GUIDE_NOTHING ? s->news : news;
}

/* Half a second of moving there, then until that is taken or refused; at most 4 s. */
static guide_news show(seen *s, const double *to)
{
    double from[MRT_ANGLES];
    memcpy(from, s->pose, sizeof from);
    s->news = GUIDE_NOTHING;
    for (int k = 1; k <= 120 && s->news == GUIDE_NOTHING; ++k) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            s->pose[i] = from[i] + (to[i] - from[i]) * (k < 15 ? k : 15) / 15.0;
        look(s);
    }
    return s->news;
}

static seen bare(void)
{
    guide_settings settings = guide_settings_bare(MRT_RIGHT, ALL_22, "camera");
    seen out = {.guide = guide_create(&settings), .noise = 1, .time_ns = 7000000000};
    assert_non_null(out.guide);
    return out;
}

static void a_bare_hand_takes_three_poses_and_ten_seconds(void **state)
{
    (void)state;
    static const guide_step steps[] = {GUIDE_FLAT, GUIDE_FIST, GUIDE_SPREAD};
    seen s = bare();
    double pose[MRT_ANGLES];
    calibration_file file;
    hand_calibration use;
    guide_judgement judgement;
    error err = {""};
    int of, asked = 0;
    for (guide_step step = 0; step < GUIDE_STEPS; ++step)
        asked += guide_is_requested(s.guide, step);
    assert_int_equal(asked, 3);
    for (int k = 0; k < 3; ++k) {
        assert_int_equal(guide_current(s.guide), steps[k]);
        assert_int_equal(guide_number(s.guide, &of), k + 1);
        assert_int_equal(of, 3);
        assert_true(strlen(guide_instruction(s.guide)) > 20);
        pose_of(pose, steps[k]);
        assert_int_equal(show(&s, pose), GUIDE_TAKEN);
    }
    assert_true(s.time_ns - 7000000000 < 10000000000);
    assert_string_equal(guide_instruction(s.guide), "");
    assert_int_equal(guide_result(s.guide, &file, &err), MRT_OK);
    guide_judge(&judgement, s.guide, &file);
    assert_int_equal(judgement.flaw_count, 0);
    assert_int_equal(judgement.left_out, 0);
    assert_string_equal(file.input, "camera");
    calibration_file_use(&file, &use);
    assert_string_equal(use.input, "camera");
    float raw[MRT_ANGLES], angle_rad[MRT_ANGLES];
    for (int i = 0; i < MRT_ANGLES; ++i)
        raw[i] = (float)as_seen(i, 40.0);
    hand_calibrate(&use, raw, angle_rad);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const sensor_facts *facts = &sensor_table[i];
        bool is_measured =
            facts->kind == SENSOR_SPREAD || (facts->finger > 0 && facts->kind != SENSOR_ROLL);
        const float end_deg = fminf(facts->high_deg + 15.0f, 40.0f);
        const float read_deg = angle_rad[i] / (float)rad_per_degree;
        if (is_measured) /* seen as 36 degrees, it is 40 again */
            assert_float_equal(read_deg, end_deg, 4.0f);
        else if (i == SENSOR_THUMB_ROLL || facts->kind == SENSOR_WRIST)
            assert_true(angle_rad[i] == raw[i]);
        else /* its zero is known */
            assert_float_equal(read_deg, 30.0f, 2.5f);
    }
    guide_destroy(s.guide);
}

static void a_bent_hand_is_not_taken_for_a_flat_one(void **state)
{
    (void)state;
    seen s = bare();
    double pose[MRT_ANGLES];
    pose_of(pose, GUIDE_RELAXED); /* on the mouse */
    set_finger(pose, 2, 40, 40, 20);
    assert_int_equal(show(&s, pose), GUIDE_REFUSED);
    assert_int_equal(guide_current(s.guide), GUIDE_FLAT);
    pose_of(pose, GUIDE_FLAT);
    assert_int_equal(show(&s, pose), GUIDE_TAKEN);
    pose_of(pose, GUIDE_INDEX_ALONE); /* no fist */
    assert_int_equal(show(&s, pose), GUIDE_REFUSED);
    pose_of(pose, GUIDE_FIST);
    assert_int_equal(show(&s, pose), GUIDE_TAKEN);
    pose_of(pose, GUIDE_FLAT); /* open, but not spread */
    assert_int_equal(show(&s, pose), GUIDE_REFUSED);
    guide_repeat(s.guide);
    assert_int_equal(guide_current(s.guide), GUIDE_FIST);
    guide_repeat(s.guide);
    assert_int_equal(guide_current(s.guide), GUIDE_FLAT);
    guide_repeat(s.guide);
    assert_int_equal(guide_current(s.guide), GUIDE_FLAT);
    guide_destroy(s.guide);
}

static void a_joint_that_is_not_seen_stays_as_it_is(void **state)
{
    (void)state;
    seen s = bare();
    double pose[MRT_ANGLES];
    calibration_file file;
    guide_judgement judgement;
    char words[200];
    error err = {""};
    static const guide_step steps[] = {GUIDE_FLAT, GUIDE_FIST, GUIDE_SPREAD};
    for (int k = 0; k < 3; ++k) {
        pose_of(pose, steps[k]);
        pose[17] = steps[k] == GUIDE_FIST ? 5 : pose[17]; /* the little finger's end joint */
        assert_int_equal(show(&s, pose), GUIDE_TAKEN);
    }
    assert_int_equal(guide_result(s.guide, &file, &err), MRT_OK);
    assert_int_equal(file.sensor[17].source, CALIBRATION_ZEROED);
    guide_judge(&judgement, s.guide, &file);
    assert_int_equal(judgement.flaw_count, 1);
    guide_flaw_text(&judgement.flaw[0], words, sizeof words);
    assert_non_null(strstr(words, "little finger, end joint: hardly moved, so it is used as seen"));
    guide_destroy(s.guide);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ten_poses_give_the_glove_s_own_gains),
        cmocka_unit_test(shipped_gains_hold_where_poses_tell_only_the_zero),
        cmocka_unit_test(residual_is_what_a_known_pose_is_misread_by),
        cmocka_unit_test(a_pose_is_not_taken_before_the_hand_has_moved),
        cmocka_unit_test(a_pose_is_not_taken_while_the_hand_moves),
        cmocka_unit_test(next_takes_the_pose_at_once),
        cmocka_unit_test(a_fist_like_the_flat_hand_is_refused_and_names_the_sensors),
        cmocka_unit_test(one_dead_sensor_is_said_and_keeps_the_shipped_gain),
        cmocka_unit_test(the_wrong_finger_is_refused_by_name),
        cmocka_unit_test(the_flat_hand_cannot_be_skipped_the_others_can),
        cmocka_unit_test(a_step_can_be_repeated_and_the_later_pose_counts),
        cmocka_unit_test(a_pose_made_again_may_be_skipped_and_the_old_one_counts),
        cmocka_unit_test(a_step_without_a_pose_times_out_and_says_why),
        cmocka_unit_test(a_device_that_is_away_costs_no_time_and_no_pose),
        cmocka_unit_test(values_that_are_no_numbers_are_ignored),
        cmocka_unit_test(a_bare_hand_takes_three_poses_and_ten_seconds),
        cmocka_unit_test(a_bent_hand_is_not_taken_for_a_flat_one),
        cmocka_unit_test(a_joint_that_is_not_seen_stays_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
