/* plugins/devices/bare_hand.h: how a hand is turned, beside how it was first seen. Hands are posed
 * and read back by marotte's own skeleton, so that the two angles are those of a glove's wrist. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "bare_hand.h"
#include "base/rigid.h"
#include "hand/hand.h"

#include <math.h>
#include <string.h>

enum { FLAT, FIST, SPREAD, POSES };
enum { PITCH = 20, YAW = 21 };
static const double degree = 0.017453292519943295;
static const double params[BARE_HAND_PARAMS] = {BARE_HAND_EITHER, 1.0};
static int64_t now_ns(const mrt_host *host)
{
    (void)host;
    return 0;
}
static const mrt_host nobody = {.now_ns = now_ns};

/* What a camera at `seen_from` sees of a hand whose wrist is bent so. */
static mrt_hand_reading see(uint32_t side, int pose, double pitch_deg, double yaw_deg,
                            const rigid *seen_from)
{
    static const int knuckle[4] = {4, 7, 11, 15}, spread[3] = {10, 14, 18};
    float angle_rad[MRT_ANGLES] = {0.6f, 0.1f, 0.1f, 0.3f};
    mrt_vec3 palm[MRT_PALM];
    hand_landmarks seen = {.doubtful = 0};
    hand_reading read = {0};
    mrt_hand_reading out = {.confidence = 1.0f};
    double xyzw[4];
    for (int finger = 0; finger < 4 && pose == FIST; ++finger)
        for (int joint = 0; joint < 3; ++joint)
            angle_rad[knuckle[finger] + joint] = 1.2f;
    for (int i = 0; i < 3 && pose == SPREAD; ++i)
        angle_rad[spread[i]] = 0.25f;
    angle_rad[PITCH] = (float)(pitch_deg * degree);
    angle_rad[YAW] = (float)(yaw_deg * degree);
    hand_skeleton *skeleton = hand_skeleton_create(side, 190.0);
    assert_non_null(skeleton);
    hand_pose(skeleton, angle_rad, seen_from, seen.at, palm);
    hand_read(skeleton, &seen, &read);
    hand_skeleton_destroy(skeleton);
    assert_true(read.confidence > 0.5);
    memcpy(out.angle, read.angle_rad, sizeof out.angle);
    rigid_to_quaternion(&read.wrist, xyzw);
    for (int i = 0; i < 4; ++i)
        out.wrist[3 + i] = (float)xyzw[i];
    return out;
}

static rigid somewhere(int n)
{
    const double xyzw[4] = {sin(1.0 + n), cos(2.0 * n), sin(3.0 * n), 0.3};
    return rigid_from_quaternion(xyzw, (vec3){20.0 * n, -30, 400});
}

static void a_turned_hand_is_a_bent_wrist_whoever_sees_it(void **state)
{
    (void)state;
    for (int n = 0; n < 24; ++n) {
        const uint32_t side = n % 2 ? MRT_RIGHT : MRT_LEFT;
        const rigid from = somewhere(n);
        const double pitch_deg = 50.0 * sin(n), yaw_deg = 18.0 * cos(n);
        bare_hand hand = {.host = &nobody};
        bare_hand_begin(&hand, params);
        bare_hand_follow(&hand, params);
        mrt_hand_reading now = see(side, n % POSES, 0, 0, &from);
        bare_hand_turn(&hand, side, &now);
        assert_float_equal(now.angle[PITCH], 0.0f, 1e-3f);
        assert_float_equal(now.angle[YAW], 0.0f, 1e-3f);
        now = see(side, (n + 1) % POSES, pitch_deg, yaw_deg, &from);
        bare_hand_turn(&hand, side, &now);
        assert_float_equal(now.angle[PITCH], (float)(pitch_deg * degree), 0.01f);
        assert_float_equal(now.angle[YAW], (float)(yaw_deg * degree), 0.01f);
    }
}

static void each_hand_counts_from_its_own(void **state)
{
    (void)state;
    const rigid from[2] = {somewhere(1), somewhere(5)};
    bare_hand hand = {.host = &nobody};
    bare_hand_begin(&hand, params);
    bare_hand_follow(&hand, params);
    for (int n = 0; n < 4; ++n) {
        const uint32_t side = n % 2 ? MRT_RIGHT : MRT_LEFT;
        mrt_hand_reading now = see(side, FLAT, n < 2 ? 0 : 20, 0, &from[side]);
        bare_hand_turn(&hand, side, &now);
        assert_float_equal(now.angle[PITCH], n < 2 ? 0.0f : (float)(20 * degree), 0.01f);
    }
}

static void a_still_wrist_stays(void **state)
{
    (void)state;
    static const double still[BARE_HAND_PARAMS] = {BARE_HAND_EITHER, 0.0};
    const rigid from[2] = {somewhere(1), somewhere(5)};
    bare_hand hand = {.host = &nobody};
    bare_hand_begin(&hand, still);
    bare_hand_follow(&hand, still);
    for (int n = 0; n < 2; ++n) {
        mrt_hand_reading now = see(MRT_RIGHT, FLAT, 0, 0, &from[n]);
        now.angle[PITCH] = 1.0f; /* whatever was there */
        bare_hand_turn(&hand, MRT_RIGHT, &now);
        assert_float_equal(now.angle[PITCH], 0.0f, 0.0f);
        assert_float_equal(now.angle[YAW], 0.0f, 0.0f);
    }
}

/* Upside down is no wrist: its joints end somewhere. */
static void no_wrist_bends_further_than_joints_do(void **state)
{
    (void)state;
    bare_hand hand = {.host = &nobody};
    bare_hand_begin(&hand, params);
    bare_hand_follow(&hand, params);
    for (int n = 0; n < 40; ++n) {
        const rigid from = somewhere(n);
        mrt_hand_reading now = see(MRT_RIGHT, FLAT, 0, 0, &from);
        bare_hand_turn(&hand, MRT_RIGHT, &now);
        assert_true(fabsf(now.angle[PITCH]) <= 1.2f && fabsf(now.angle[YAW]) <= 1.2f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_turned_hand_is_a_bent_wrist_whoever_sees_it),
        cmocka_unit_test(each_hand_counts_from_its_own),
        cmocka_unit_test(a_still_wrist_stays),
        cmocka_unit_test(no_wrist_bends_further_than_joints_do),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
