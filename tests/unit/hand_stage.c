/* stage/perform/hands.h: samples become hands: calibrated, re-zeroed, eased back after a gap. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

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

int main(void)
{
    const struct CMUnitTest tests[] = {
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
