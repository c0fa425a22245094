/* A hand that is moved by keys or a gamepad: from what is pressed to angles. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "hand/sensor.h"
#include "window/viewport/virtual_hand.h"

#include <math.h>
#include <string.h>

static virtual_hand_intent intent_of(virtual_hand_key key)
{
    bool is_down[VIRTUAL_KEYS] = {false};
    virtual_hand_intent intent;
    memset(&intent, 0, sizeof intent);
    is_down[key] = true;
    virtual_hand_add_keys(&intent, is_down);
    return intent;
}

static window_gamepad quiet_pad(void)
{
    window_gamepad pad;
    memset(&pad, 0, sizeof pad);
    pad.axis[4] = pad.axis[5] = -1.0f; /* triggers rest there */
    return pad;
}

/* How far a sensor's goal is from rest, rad. */
static float way_of(virtual_hand_key key, int sensor)
{
    float rest[MRT_ANGLES], goal[MRT_ANGLES];
    virtual_hand_intent intent = intent_of(key);
    virtual_hand_rest(rest);
    virtual_hand_goal(goal, &intent, 1.0f);
    return goal[sensor] - rest[sensor];
}

static void each_key_moves_its_own_finger(void **state)
{
    (void)state;
    static const int knuckle[4] = {SENSOR_INDEX_MPJ, SENSOR_MIDDLE_MPJ, SENSOR_RING_MPJ,
                                   SENSOR_LITTLE_MPJ};
    for (int finger = 0; finger < 4; ++finger)
        for (int other = 0; other < 4; ++other) {
            float down = way_of((virtual_hand_key)(VIRTUAL_INDEX_DOWN + finger), knuckle[other]);
            float up = way_of((virtual_hand_key)(VIRTUAL_INDEX_UP + finger), knuckle[other]);
            assert_true(finger == other ? down > 0.5f && up < -0.3f : down == 0.0f && up == 0.0f);
        }
}

static void the_thumb_drops_as_a_puppets_jaw_does(void **state)
{
    (void)state;
    /* one_hand: a thumb that is stretched by 46 degrees opens the mouth by 30. */
    float drop =
        -way_of(VIRTUAL_THUMB_DOWN, SENSOR_THUMB_MPJ) - way_of(VIRTUAL_THUMB_DOWN, SENSOR_THUMB_IJ);
    assert_true(drop > 0.6f && drop < 1.0f);
    assert_true(way_of(VIRTUAL_THUMB_UP, SENSOR_THUMB_MPJ) > 0.2f);
}

static void both_keys_of_a_finger_leave_it_where_it_is(void **state)
{
    (void)state;
    bool is_down[VIRTUAL_KEYS];
    for (int i = 0; i < VIRTUAL_KEYS; ++i)
        is_down[i] = true;
    virtual_hand_intent intent;
    float rest[MRT_ANGLES], goal[MRT_ANGLES];
    memset(&intent, 0, sizeof intent);
    virtual_hand_add_keys(&intent, is_down);
    virtual_hand_rest(rest);
    virtual_hand_goal(goal, &intent, 1.0f);
    assert_memory_equal(rest, goal, sizeof rest);
}

static void right_is_to_the_right_whatever_the_hand(void **state)
{
    (void)state;
    float to_thumb[MRT_ANGLES], from_thumb[MRT_ANGLES];
    virtual_hand_intent intent = intent_of(VIRTUAL_WRIST_RIGHT);
    virtual_hand_goal(to_thumb, &intent, 1.0f);
    virtual_hand_goal(from_thumb, &intent, -1.0f);
    assert_true(to_thumb[SENSOR_WRIST_YAW] > 0.2f); /* radial is positive */
    assert_true(from_thumb[SENSOR_WRIST_YAW] < -0.2f);
    assert_true(way_of(VIRTUAL_WRIST_DOWN, SENSOR_WRIST_PITCH) > 0.3f);
    assert_true(way_of(VIRTUAL_WRIST_UP, SENSOR_WRIST_PITCH) < -0.3f);
}

static void every_goal_is_within_what_a_hand_can_do(void **state)
{
    (void)state;
    for (int key = 0; key < VIRTUAL_KEYS; ++key) {
        float goal[MRT_ANGLES];
        virtual_hand_intent intent = intent_of((virtual_hand_key)key);
        virtual_hand_goal(goal, &intent, 1.0f);
        for (int i = 0; i < MRT_ANGLES; ++i) {
            const sensor_facts *f = &sensor_table[i];
            float slack = 0.6f; /* a relaxed thumb is beyond its clinical range already */
            assert_true(goal[i] > f->low_deg * 0.01745f - slack);
            assert_true(goal[i] < f->high_deg * 0.01745f + slack);
        }
    }
}

static void a_gamepad_moves_the_same_hand(void **state)
{
    (void)state;
    window_gamepad pad = quiet_pad();
    virtual_hand_intent intent;
    memset(&intent, 0, sizeof intent);
    assert_false(virtual_hand_pad_is_used(&pad));
    pad.axis[0] = 0.1f; /* a worn stick */
    assert_false(virtual_hand_pad_is_used(&pad));
    pad.axis[5] = 1.0f;  /* right trigger */
    pad.axis[4] = 1.0f;  /* left trigger */
    pad.axis[1] = -1.0f; /* left stick up */
    pad.axis[2] = 1.0f;  /* right stick to the right */
    pad.button[1] = true;
    assert_true(virtual_hand_pad_is_used(&pad));
    virtual_hand_add_pad(&intent, &pad);
    assert_true(intent.finger[0] == 1.0f);
    assert_true(intent.finger[3] == -1.0f && intent.finger[4] == -1.0f);
    assert_true(intent.finger[1] == -1.0f);
    assert_true(intent.yaw == 1.0f);
    assert_false(intent.pedal[0]);
    assert_true(intent.pedal[1]);
    pad = quiet_pad();
    pad.axis[3] = NAN;
    assert_false(virtual_hand_pad_is_used(&pad));
}

static void most_of_a_bend_is_done_in_80_ms_and_of_a_lift_in_120(void **state)
{
    (void)state;
    virtual_hand_motion m;
    float goal[MRT_ANGLES];
    virtual_hand_motion_begin(&m);
    memcpy(goal, m.angle_rad, sizeof goal);
    goal[SENSOR_INDEX_MPJ] += 1.0f;
    goal[SENSOR_RING_MPJ] -= 1.0f;
    float bend = m.angle_rad[SENSOR_INDEX_MPJ], lift = m.angle_rad[SENSOR_RING_MPJ];
    virtual_hand_motion_step(&m, goal, 0.080);
    assert_true(fabsf(m.angle_rad[SENSOR_INDEX_MPJ] - bend - 0.63f) < 0.01f);
    assert_true(lift - m.angle_rad[SENSOR_RING_MPJ] < 0.5f);
    virtual_hand_motion_step(&m, goal, 0.040);
    assert_true(fabsf(lift - m.angle_rad[SENSOR_RING_MPJ] - 0.63f) < 0.01f);
}

static void motion_does_not_depend_on_the_frame_rate(void **state)
{
    (void)state;
    virtual_hand_motion once, often;
    float goal[MRT_ANGLES];
    virtual_hand_intent intent = intent_of(VIRTUAL_THUMB_DOWN);
    virtual_hand_goal(goal, &intent, 1.0f);
    virtual_hand_motion_begin(&once);
    often = once;
    virtual_hand_motion_step(&once, goal, 0.1);
    for (int i = 0; i < 20; ++i)
        virtual_hand_motion_step(&often, goal, 0.005);
    for (int i = 0; i < MRT_ANGLES; ++i)
        assert_true(fabsf(once.angle_rad[i] - often.angle_rad[i]) < 1e-4f);
}

static void it_never_overshoots_and_comes_to_rest(void **state)
{
    (void)state;
    virtual_hand_motion m;
    float goal[MRT_ANGLES];
    virtual_hand_motion_begin(&m);
    memcpy(goal, m.angle_rad, sizeof goal);
    assert_true(virtual_hand_motion_is_still(&m, goal));
    goal[SENSOR_INDEX_MPJ] += 0.8f;
    float last = m.angle_rad[SENSOR_INDEX_MPJ];
    assert_false(virtual_hand_motion_is_still(&m, goal));
    for (int i = 0; i < 60; ++i) {
        virtual_hand_motion_step(&m, goal, 1.0 / 60.0);
        assert_true(m.angle_rad[SENSOR_INDEX_MPJ] >= last - 1e-6f);
        assert_true(m.angle_rad[SENSOR_INDEX_MPJ] <= goal[SENSOR_INDEX_MPJ] + 1e-5f);
        last = m.angle_rad[SENSOR_INDEX_MPJ];
    }
    assert_true(virtual_hand_motion_is_still(&m, goal));
    virtual_hand_motion before = m;
    virtual_hand_motion_step(&m, goal, 0.0);
    virtual_hand_motion_step(&m, goal, NAN);
    assert_memory_equal(&before, &m, sizeof m);
    virtual_hand_motion_step(&m, goal, 3600.0); /* the lid of the laptop was closed */
    assert_true(virtual_hand_motion_is_still(&m, goal));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_key_moves_its_own_finger),
        cmocka_unit_test(the_thumb_drops_as_a_puppets_jaw_does),
        cmocka_unit_test(both_keys_of_a_finger_leave_it_where_it_is),
        cmocka_unit_test(right_is_to_the_right_whatever_the_hand),
        cmocka_unit_test(every_goal_is_within_what_a_hand_can_do),
        cmocka_unit_test(a_gamepad_moves_the_same_hand),
        cmocka_unit_test(most_of_a_bend_is_done_in_80_ms_and_of_a_lift_in_120),
        cmocka_unit_test(motion_does_not_depend_on_the_frame_rate),
        cmocka_unit_test(it_never_overshoots_and_comes_to_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
