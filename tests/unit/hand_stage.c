/* stage/perform/hands.h: samples become hands: calibrated, re-zeroed, eased back after a gap. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/landmark_filter.h"
#include "hand/sensor.h"
#include "stage/perform/hands.h"

#include <math.h>
#include <string.h>

static const int64_t PERIOD_NS = 6666667; /* 150 Hz */

/* A right glove of 18 or 22 sensors and one pedal. */
typedef struct scene {
    hands *hands;
    mrt_channel channel[MRT_ANGLES + 1];
    uint32_t count;
    channel_route route;
    mrt_frame frame;
    mrt_sample sample;
    float value[MRT_ANGLES]; /* by sensor */
    float pedal;
} scene;

static void begin(scene *s, const char *unit, bool has_distal, uint32_t rezero_pedal)
{
    memset(s, 0, sizeof *s);
    for (uint32_t i = 0; i < MRT_ANGLES; ++i) {
        bool is_distal = i == 6 || i == 9 || i == 13 || i == 17;
        if (has_distal || !is_distal)
            s->channel[s->count++] = (mrt_channel){"x", unit, MRT_CH_ANGLE + i, MRT_RIGHT, 0, 255};
    }
    s->channel[s->count++] = (mrt_channel){"p", "1", MRT_CH_PEDAL + 1, MRT_NO_HAND, 0, 1};
    error err = {""};
    hands_settings settings = {.rezero_pedal = rezero_pedal};
    assert_int_equal(hands_create(&s->hands, &settings, &err), MRT_OK);
    channel_route_init(&s->route, s->channel, s->count);
    s->sample.count = s->count;
}

static void give(scene *s)
{
    for (uint32_t i = 0; i + 1 < s->count; ++i)
        s->sample.value[i] = s->value[s->channel[i].semantic - MRT_CH_ANGLE];
    s->sample.value[s->count - 1] = s->pedal;
    s->frame.time_ns = s->sample.time_ns;
    const sample_step next = sample_step_of(&s->route, &s->sample);
    hands_read(s->hands, &next, &s->frame);
    s->sample.time_ns += PERIOD_NS;
}

static void give_for(scene *s, double seconds)
{
    for (int i = 0; i < (int)(seconds * 150.0); ++i)
        give(s);
}

static const float *angles(const scene *s)
{
    return s->frame.hand[MRT_RIGHT].angle;
}

/* ---- calibrations ---- */

static void a_calibration_counts_for_counts_and_not_for_rad(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_default(&calibration);
    calibration.sensor[4] = (hand_table){.count = 2, .raw = {0, 100}, .rad = {0.0f, 1.0f}};
    scene s;
    begin(&s, "count", true, 0);
    channel_route_calibrate(&s.route, MRT_LEFT, &calibration); /* another hand's */
    s.value[4] = 50;
    give(&s);
    assert_float_equal(angles(&s)[4], -0.8f, 1e-5f); /* shipped: 0.020 * (50 - 90) */
    hands_destroy(s.hands);

    begin(&s, "count", true, 0);
    channel_route_calibrate(&s.route, MRT_RIGHT, &calibration);
    channel_route_calibrate(&s.route, MRT_RIGHT, NULL);
    s.value[4] = 50;
    give(&s);
    assert_float_equal(angles(&s)[4], 0.5f, 1e-5f);
    hands_destroy(s.hands);

    begin(&s, "rad", true, 0);
    channel_route_calibrate(&s.route, MRT_RIGHT, &calibration);
    s.value[4] = 0.7f;
    give(&s);
    assert_float_equal(angles(&s)[4], 0.7f, 1e-6f);
    hands_destroy(s.hands);
}

static void end_joints_that_the_glove_or_the_calibration_lacks_are_estimated(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_default(&calibration);
    calibration.sensor[5] = (hand_table){.count = 2, .raw = {0, 100}, .rad = {0.0f, 1.5f}};
    for (int lacks = 0; lacks < 2; ++lacks) {
        scene s;
        begin(&s, "count", lacks == 1, 0);
        calibration.has_distal[0] = lacks == 0;
        channel_route_calibrate(&s.route, MRT_RIGHT, &calibration);
        s.value[5] = 100;
        s.value[6] = 200;
        give(&s);
        assert_float_equal(angles(&s)[6], 0.465f, 1e-5f); /* of 1.5 rad */
        hands_destroy(s.hands);
    }
}

static void another_input_with_a_tracker_does_not_undo_the_calibration(void **state)
{
    (void)state;
    scene s;
    begin(&s, "count", true, 0);
    s.value[4] = 140;
    give(&s);
    float before = angles(&s)[4];
    mrt_channel tracker = {"x", "mm", MRT_CH_WRIST, MRT_RIGHT, -1000, 1000};
    channel_route route;
    channel_route_init(&route, &tracker, 1);
    mrt_sample sample = {.time_ns = s.sample.time_ns, .count = 1, .value = {50}};
    s.frame.time_ns = sample.time_ns;
    const sample_step next = sample_step_of(&route, &sample);
    hands_read(s.hands, &next, &s.frame);
    assert_true(angles(&s)[4] == before);
    assert_float_equal(s.frame.hand[MRT_RIGHT].joint[0].x, 50.0f, 1e-5f);
    hands_destroy(s.hands);
}

/* ---- gaps ---- */

/* A device that is away for 2 s comes back with the index finger bent by 60 degrees: at 150 Hz no
 * step is greater than the ease's steepest, 60 * 1.5 / 0.25 / 150 = 2.4 degrees. */
static void no_step_is_greater_than_the_ease_allows_after_a_gap(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 0);
    give_for(&s, 1.0);
    s.sample.time_ns += 2000000000;
    s.value[4] = 1.0471976f;
    double greatest = 0, before = (double)angles(&s)[4];
    mrt_vec3 tip_before = s.frame.hand[MRT_RIGHT].joint[8];
    double greatest_mm = 0;
    for (int i = 0; i < 60; ++i) {
        give(&s);
        greatest = fmax(greatest, fabs((double)angles(&s)[4] - before));
        before = (double)angles(&s)[4];
        mrt_vec3 tip = s.frame.hand[MRT_RIGHT].joint[8];
        double dy = (double)tip.y - (double)tip_before.y, dz = (double)tip.z - (double)tip_before.z;
        greatest_mm = fmax(greatest_mm, sqrt(dy * dy + dz * dz));
        tip_before = tip;
    }
    assert_true(greatest * 57.29578 <= 2.41);
    assert_true(greatest_mm < 5.0); /* 90 mm of finger by 2.4 degrees: 3.8 */
    assert_float_equal(angles(&s)[4], 1.0471976f, 1e-4f);
    hands_destroy(s.hands);
}

/* The tracker goes on while the glove is away: that does not hide the gap. */
static void each_device_has_its_own_gap(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 0);
    give_for(&s, 1.0);
    mrt_channel tracker = {"x", "mm", MRT_CH_WRIST, MRT_RIGHT, -1000, 1000};
    channel_route route;
    channel_route_init(&route, &tracker, 1);
    for (int i = 0; i < 300; ++i, s.sample.time_ns += PERIOD_NS) {
        mrt_sample sample = {.time_ns = s.sample.time_ns, .count = 1, .value = {1}};
        s.frame.time_ns = sample.time_ns;
        const sample_step next = sample_step_of(&route, &sample);
        hands_read(s.hands, &next, &s.frame);
    }
    s.value[4] = 1.0f;
    give(&s);
    assert_float_equal(angles(&s)[4], 0.0f, 1e-6f);
    give_for(&s, 0.5);
    assert_float_equal(angles(&s)[4], 1.0f, 1e-4f);
    hands_destroy(s.hands);
}

/* ---- re-zero ---- */

static void set_all(scene *s, float value)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        s->value[i] = value;
}

static void a_rezero_leads_to_the_neutral_pose_without_a_jump(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 0);
    set_all(&s, 0.3f);
    give_for(&s, 1.0);
    error why = {""};
    assert_int_equal(hands_rezero(s.hands, MRT_RIGHT, s.frame.time_ns, &why), MRT_OK);
    assert_float_equal(angles(&s)[0], 0.3f, 1e-4f); /* from the next sample on */
    double greatest = 0, before = (double)angles(&s)[0];
    for (int i = 0; i < 45; ++i) {
        give(&s);
        greatest = fmax(greatest, fabs((double)angles(&s)[0] - before));
        before = (double)angles(&s)[0];
    }
    /* 1.44 - 0.3 rad at 1.5 / 0.25 s / 150 Hz */
    assert_true(greatest <= 1.14 * 0.04 + 1e-4 && greatest > 0.04);
    for (int i = 0; i < MRT_ANGLES; ++i)
        assert_float_equal(angles(&s)[i], sensor_table[i].neutral_rad, 1e-4f);
    hands_destroy(s.hands);
}

/* A hundred presses in the same pose are one: measured from the tables, not from the last. */
static void rezeros_do_not_accumulate(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 0);
    set_all(&s, 0.3f);
    give_for(&s, 1.0);
    error why = {""};
    for (int press = 0; press < 100; ++press) {
        assert_int_equal(hands_rezero(s.hands, MRT_RIGHT, s.frame.time_ns, &why), MRT_OK);
        give_for(&s, 0.1);
    }
    give_for(&s, 0.5);
    for (int i = 0; i < MRT_ANGLES; ++i)
        assert_float_equal(angles(&s)[i], sensor_table[i].neutral_rad, 1e-4f);
    assert_int_equal(hands_rezeros(s.hands)->done, 100);
    hands_destroy(s.hands);
}

static void refused(scene *s, const char *words)
{
    error why = {""};
    assert_int_equal(hands_rezero(s->hands, MRT_RIGHT, s->frame.time_ns, &why), MRT_HOLD);
    if (!strstr(why.text, words))
        print_message("%s\n", why.text);
    assert_non_null(strstr(why.text, words));
}

static void a_rezero_is_refused_unless_the_hand_is_still(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 0);
    refused(&s, "the right hand gives no samples");
    give_for(&s, 0.2);
    refused(&s, "less than half a second");
    for (int i = 0; i < 150; ++i) {
        s.value[SENSOR_RING_MPJ] += 0.004f; /* 34 degrees a second: 5 of deviation in half one */
        give(&s);
    }
    refused(&s, "is not still: its ring knuckle moves by");
    give_for(&s, 1.0);
    error why = {""};
    assert_int_equal(hands_rezero(s.hands, MRT_RIGHT, s.frame.time_ns, &why), MRT_OK);
    s.frame.time_ns += 300000000;
    refused(&s, "gives no samples");
    assert_int_equal(hands_rezeros(s.hands)->refused, 4);
    assert_int_equal(hands_rezero(s.hands, 7, s.frame.time_ns, &why), MRT_ERR_ARGUMENT);
    hands_destroy(s.hands);
}

/* In the samples, so that a replay does the same; held down it presses once; mappings do not see
 * it. */
static void the_pedal_s_press_rezeroes_once(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 2);
    set_all(&s, 0.3f);
    give_for(&s, 1.0);
    s.pedal = 1.0f;
    give_for(&s, 0.5);
    assert_int_equal(hands_rezeros(s.hands)->done, 1);
    assert_true(s.frame.pedal[1] == 0.0f);
    assert_float_equal(angles(&s)[4], sensor_table[4].neutral_rad, 1e-4f);
    s.pedal = 0.0f;
    give_for(&s, 0.1);
    set_all(&s, 0.5f);
    give_for(&s, 0.1);
    s.pedal = 1.0f;
    give(&s); /* still on its way */
    assert_int_equal(hands_rezeros(s.hands)->done, 1);
    assert_int_equal(hands_rezeros(s.hands)->refused, 1);
    hands_destroy(s.hands);
}

static void other_pedals_stay_the_mapping_s(void **state)
{
    (void)state;
    scene s;
    begin(&s, "rad", true, 1);
    s.pedal = 1.0f; /* pedal 2 */
    give(&s);
    assert_true(s.frame.pedal[1] == 1.0f);
    assert_int_equal(hands_rezeros(s.hands)->done + hands_rezeros(s.hands)->refused, 0);
    hands_destroy(s.hands);
    error err = {""};
    hands_settings settings = {.rezero_pedal = 5};
    assert_true(hands_create(&s.hands, &settings, &err) < 0);
}

/* The glove's calibration has its own neutral pose. */
static void a_rezero_leads_to_the_calibration_s_neutral_pose(void **state)
{
    (void)state;
    hand_calibration calibration;
    hand_calibration_default(&calibration);
    for (int i = 0; i < MRT_ANGLES; ++i)
        calibration.neutral_rad[i] = 0.01f * (float)i;
    scene s;
    begin(&s, "count", true, 0);
    channel_route_calibrate(&s.route, MRT_RIGHT, &calibration);
    set_all(&s, 120);
    give_for(&s, 1.0);
    error why = {""};
    assert_int_equal(hands_rezero(s.hands, MRT_RIGHT, s.frame.time_ns, &why), MRT_OK);
    give_for(&s, 0.5);
    for (int i = 0; i < MRT_ANGLES; ++i)
        assert_float_equal(angles(&s)[i], 0.01f * (float)i, 1e-4f);
    hands_destroy(s.hands);
}

/* ---- filters ---- */

/* A hand that trembles at rest and moves: by +-0.05 rad, and from `n` = 100 to 110 by 0.5. */
static float trembling(int n, int sensor)
{
    return 0.2f + 0.05f * fminf(fmaxf((float)(n - 100), 0.0f), 10.0f) +
           ((n * 7 + sensor * 3) % 5 < 2 ? 0.05f : -0.05f);
}

static void give_trembling(scene *s, int n)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        s->value[i] = trembling(n, i);
    give(s);
}

typedef enum expected_filter { EXPECT_ONE_EURO = 0, EXPECT_LANDMARKS } expected_filter;

static void assert_filtered_by(scene *s, const hand_filter *settings, expected_filter expected)
{
    hand_filter one_euro = *settings;
    landmark_filter landmarks = {.count = 0};
    for (int n = 0; n < 200; ++n) {
        float angle_rad[MRT_ANGLES];
        const int64_t time_ns = s->sample.time_ns;
        give_trembling(s, n);
        for (int i = 0; i < MRT_ANGLES; ++i)
            angle_rad[i] = trembling(n, i);
        if (expected == EXPECT_LANDMARKS)
            landmark_filter_apply(&landmarks, angle_rad, time_ns);
        else
            hand_filter_apply(&one_euro, angle_rad, time_ns);
        assert_memory_equal(angle_rad, angles(s), sizeof angle_rad);
    }
}

/* Those in rad to the bit as ever: tracks of cameras that earlier versions recorded say "rad". */
static void the_unit_of_angles_chooses_their_filter(void **state)
{
    (void)state;
    scene s;
    hand_filter settings;
    hand_filter_init(&settings);
    begin(&s, "rad", true, 0);
    assert_false(s.route.is_of_landmarks[MRT_RIGHT]);
    assert_filtered_by(&s, &settings, EXPECT_ONE_EURO);
    hands_destroy(s.hands);
    begin(&s, MRT_UNIT_LANDMARKS, true, 0);
    assert_true(s.route.is_of_landmarks[MRT_RIGHT]);
    assert_false(s.route.is_of_landmarks[MRT_LEFT]);
    assert_false(s.route.in_counts[MRT_RIGHT]);
    assert_filtered_by(&s, &settings, EXPECT_LANDMARKS);
    hands_reset(s.hands);
    assert_filtered_by(&s, &settings, EXPECT_LANDMARKS);
    hands_destroy(s.hands);
}

static void a_one_euro_filter_that_is_asked_for_filters_landmarks_too(void **state)
{
    (void)state;
    scene s;
    hand_filter settings;
    const hands_settings asked = {.min_cutoff_hz = 0.5, .has_beta = true, .beta = 0.0};
    error err = {""};
    begin(&s, MRT_UNIT_LANDMARKS, true, 0);
    hands_destroy(s.hands);
    assert_int_equal(hands_create(&s.hands, &asked, &err), MRT_OK);
    hand_filter_init(&settings);
    settings.jaw.min_cutoff_hz = settings.finger.min_cutoff_hz = 0.5f;
    settings.wrist.min_cutoff_hz = 0.5f;
    settings.jaw.beta = settings.finger.beta = settings.wrist.beta = 0.0f;
    assert_filtered_by(&s, &settings, EXPECT_ONE_EURO);
    hands_destroy(s.hands);
}

/* ---- jumps ---- */

/* In every joint of the fingers, in one sample or as quickly as fingers go. How far the angle of a
 * joint goes from one sample to the next, at most. */
static double furthest_step_deg(scene *s, float by_rad, int samples)
{
    double most = 0.0;
    float from[MRT_ANGLES], before = angles(s)[4];
    memcpy(from, s->value, sizeof from);
    for (int n = 1; n <= 60; ++n) {
        for (int i = 0; i < 20; ++i)
            s->value[i] = from[i] + by_rad * fminf((float)n / (float)samples, 1.0f);
        give(s);
        most = fmax(most, 57.29578 * fabs((double)(angles(s)[4] - before)));
        before = angles(s)[4];
    }
    assert_float_equal(angles(s)[4], s->value[4], 0.01f);
    return most;
}

/* A tracker that finds another pose for a hand from one sample to the next. */
static void a_hand_that_jumps_is_eased(void **state)
{
    (void)state;
    scene s;
    begin(&s, MRT_UNIT_LANDMARKS, true, 0);
    give_for(&s, 0.5);
    assert_true(furthest_step_deg(&s, 0.35f, 1) < 1.0); /* 20 degrees, in 37 samples */
    give_for(&s, 0.5);
    /* a quick hand is not late: 20 degrees at 400 a second are 2.7 a sample */
    assert_true(furthest_step_deg(&s, -0.35f, 8) > 2.0);
    hands_destroy(s.hands);
    begin(&s, "rad", true, 0); /* takes of earlier versions: as they were */
    give_for(&s, 0.5);
    assert_true(furthest_step_deg(&s, 0.35f, 1) > 2.0);
    hands_destroy(s.hands);
}

/* ---- state ---- */

/* In the middle of a movement. Bytes that are cut or damaged are refused. */
static void state_goes_on_to_the_bit(void **state)
{
    (void)state;
    static const char *const unit[] = {"rad", MRT_UNIT_LANDMARKS};
    static unsigned char bytes[200000];
    for (int u = 0; u < 2; ++u) {
        scene whole, resumed;
        begin(&whole, unit[u], true, 0);
        begin(&resumed, unit[u], true, 0);
        for (int n = 0; n < 102; ++n)
            give_trembling(&whole, n);
        const size_t size = hands_save(whole.hands, bytes, sizeof bytes);
        assert_true(size < sizeof bytes);
        assert_int_equal(bytes[0], u == 0 ? 1 : 2); /* the format: 1 is what older versions read */
        assert_true(hands_load(resumed.hands, bytes, size));
        resumed.frame = whole.frame;
        resumed.sample = whole.sample;
        for (int n = 102; n < 160; ++n) {
            give_trembling(&whole, n);
            give_trembling(&resumed, n);
            assert_memory_equal(angles(&whole), angles(&resumed), MRT_ANGLES * sizeof(float));
        }
        assert_false(hands_load(resumed.hands, bytes, size - 1));
        memset(bytes + size - 8, 0xff, 8); /* of the last hand's filter: no number */
        assert_true(u == 0 || !hands_load(resumed.hands, bytes, size));
        bytes[0] = 3;
        assert_false(hands_load(resumed.hands, bytes, size));
        hands_destroy(whole.hands);
        hands_destroy(resumed.hands);
    }
}

/* As when a replay begins elsewhere on its clock. */
static void another_clock_changes_no_angle(void **state)
{
    (void)state;
    scene here, there;
    begin(&here, MRT_UNIT_LANDMARKS, true, 0);
    begin(&there, MRT_UNIT_LANDMARKS, true, 0);
    for (int n = 0; n < 150; ++n) {
        if (n == 50) {
            hands_shift_time(there.hands, 7000000000);
            there.sample.time_ns += 7000000000;
        }
        give_trembling(&here, n);
        give_trembling(&there, n);
        assert_memory_equal(angles(&here), angles(&there), MRT_ANGLES * sizeof(float));
    }
    hands_destroy(here.hands);
    hands_destroy(there.hands);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_unit_of_angles_chooses_their_filter),
        cmocka_unit_test(a_hand_that_jumps_is_eased),
        cmocka_unit_test(a_one_euro_filter_that_is_asked_for_filters_landmarks_too),
        cmocka_unit_test(state_goes_on_to_the_bit),
        cmocka_unit_test(another_clock_changes_no_angle),
        cmocka_unit_test(a_calibration_counts_for_counts_and_not_for_rad),
        cmocka_unit_test(end_joints_that_the_glove_or_the_calibration_lacks_are_estimated),
        cmocka_unit_test(another_input_with_a_tracker_does_not_undo_the_calibration),
        cmocka_unit_test(no_step_is_greater_than_the_ease_allows_after_a_gap),
        cmocka_unit_test(each_device_has_its_own_gap),
        cmocka_unit_test(a_rezero_leads_to_the_neutral_pose_without_a_jump),
        cmocka_unit_test(rezeros_do_not_accumulate),
        cmocka_unit_test(a_rezero_is_refused_unless_the_hand_is_still),
        cmocka_unit_test(the_pedal_s_press_rezeroes_once),
        cmocka_unit_test(other_pedals_stay_the_mapping_s),
        cmocka_unit_test(a_rezero_leads_to_the_calibration_s_neutral_pose),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
