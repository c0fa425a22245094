/* hand/hand.h: where the joints are. Flat hands against numbers worked out by hand; bends, mirror
 * and lengths in any pose. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand/hand.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of this length the bones are those of the table in hardware.md 2.3, unscaled. */
static const double TABLE_LENGTH_MM = 206.39;
static const float TOLERANCE_MM = 2e-3f;
static const uint64_t POSE_HASH = UINT64_C(0xf4cad72ecc2fb246);

enum {
    ROLL = 0,
    THUMB_MPJ = 1,
    THUMB_IJ = 2,
    THUMB_ABD = 3,
    MIDDLE_INDEX = 10,
    RING_MIDDLE = 14,
    LITTLE_RING = 18,
    ARCH = 19,
    PITCH = 20,
    YAW = 21
};
static const int mpj[4] = {4, 7, 11, 15}; /* index to little; PIJ and DIJ follow */
static const int tip[5] = {4, 8, 12, 16, 20};

typedef struct hand {
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
} hand;

static hand posed(uint32_t side, double length_mm, const float *angle_rad, const rigid *wrist)
{
    hand out;
    rigid identity = rigid_identity();
    hand_skeleton *skeleton = hand_skeleton_create(side, length_mm);
    assert_non_null(skeleton);
    hand_pose(skeleton, angle_rad, wrist ? wrist : &identity, out.joint, out.palm);
    hand_skeleton_destroy(skeleton);
    return out;
}

static hand right_hand(const float *angle_rad)
{
    return posed(MRT_RIGHT, TABLE_LENGTH_MM, angle_rad, NULL);
}

/* One sensor at an angle, the others at zero. */
static hand with(int sensor, float angle_rad)
{
    float angle[MRT_ANGLES] = {0};
    angle[sensor] = angle_rad;
    return right_hand(angle);
}

static float distance(mrt_vec3 a, mrt_vec3 b)
{
    return sqrtf((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/* A small generator of its own: the same poses everywhere. -1 .. 1. */
static float next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 8388608.0f - 1.0f;
}

static void random_angles(uint32_t *random, float *angle_rad, float reach_rad)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        angle_rad[i] = reach_rad * next_random(random);
}

/* Bones along +z from the knuckles of hardware.md 2.3, wrist 100 mm behind the middle one. The
 * thumb leaves (20, -12, 12) at 0.15 rad from +z towards +x: sin 0.149438, cos 0.988771, after
 * 52.12, 92.88 and 122.88 mm. */
static void flat_right_hand_is_where_the_table_says(void **state)
{
    (void)state;
    static const mrt_vec3 expected[MRT_JOINTS] = {
        {0, 0, 0},
        {20, -12, 12},
        {27.7887f, -12, 63.5347f},
        {33.8798f, -12, 103.8370f},
        {38.3630f, -12, 133.5002f},
        {28, 0, 94.4f},
        {28, 0, 137.59f},
        {28, 0, 167.15f},
        {28, 0, 192.50f},
        {0, 0, 100},
        {0, 0, 146.20f},
        {0, 0, 177.19f},
        {0, 0, 206.39f},
        {-28, -5.6f, 100},
        {-28, -5.6f, 139.12f},
        {-28, -5.6f, 167.43f},
        {-28, -5.6f, 191.91f},
        {-50.4f, -19.6f, 88.8f},
        {-50.4f, -19.6f, 118.71f},
        {-50.4f, -19.6f, 139.81f},
        {-50.4f, -19.6f, 162.97f},
    };
    hand flat = with(0, 0.0f);
    for (int i = 0; i < MRT_JOINTS; ++i) {
        assert_float_equal(flat.joint[i].x, expected[i].x, TOLERANCE_MM);
        assert_float_equal(flat.joint[i].y, expected[i].y, TOLERANCE_MM);
        assert_float_equal(flat.joint[i].z, expected[i].z, TOLERANCE_MM);
    }
}

static void hand_length_scales_everything(void **state)
{
    (void)state;
    float angle[MRT_ANGLES] = {0};
    hand usual = posed(MRT_RIGHT, HAND_LENGTH_MM, angle, NULL);
    assert_float_equal(usual.joint[12].z, 190.0f, TOLERANCE_MM);
    hand small = posed(MRT_RIGHT, 95.0, angle, NULL);
    for (int i = 0; i < MRT_JOINTS; ++i)
        assert_float_equal(small.joint[i].z, 0.5f * usual.joint[i].z, TOLERANCE_MM);
    for (int i = 0; i < MRT_PALM; ++i)
        assert_float_equal(small.palm[i].y, 0.5f * usual.palm[i].y, TOLERANCE_MM);
}

static void no_skeleton_for_lengths_and_sides_that_are_none(void **state)
{
    (void)state;
    assert_null(hand_skeleton_create(MRT_RIGHT, 0.0));
    assert_null(hand_skeleton_create(MRT_RIGHT, (double)NAN));
    assert_null(hand_skeleton_create(MRT_RIGHT, 1e9));
    assert_null(hand_skeleton_create(MRT_NO_HAND, 190.0));
    hand_skeleton_destroy(NULL);
}

static void left_hand_is_the_exact_mirror_image(void **state)
{
    (void)state;
    uint32_t random = 7;
    for (int n = 0; n < 200; ++n) {
        float angle[MRT_ANGLES];
        random_angles(&random, angle, 1.8f);
        /* A tracked wrist, and its mirror image. */
        double turn = 0.01 * n;
        rigid right_wrist = rigid_turn((vec3){10, -20, 30}, (vec3){0, 0.6, 0.8}, turn);
        rigid left_wrist = right_wrist;
        left_wrist.r[0][1] = -left_wrist.r[0][1];
        left_wrist.r[0][2] = -left_wrist.r[0][2];
        left_wrist.r[1][0] = -left_wrist.r[1][0];
        left_wrist.r[2][0] = -left_wrist.r[2][0];
        left_wrist.t.x = -left_wrist.t.x;
        hand right = posed(MRT_RIGHT, HAND_LENGTH_MM, angle, &right_wrist);
        hand left = posed(MRT_LEFT, HAND_LENGTH_MM, angle, &left_wrist);
        for (int i = 0; i < MRT_JOINTS; ++i) {
            mrt_vec3 mirrored = {-left.joint[i].x, left.joint[i].y, left.joint[i].z};
            /* + 0.0f: no sign on a zero */
            assert_true(mirrored.x + 0.0f == right.joint[i].x + 0.0f);
            assert_true(mirrored.y == right.joint[i].y && mirrored.z == right.joint[i].z);
        }
        for (int i = 0; i < MRT_PALM; ++i) {
            assert_true(-left.palm[i].x == right.palm[i].x);
            assert_true(left.palm[i].y == right.palm[i].y && left.palm[i].z == right.palm[i].z);
        }
    }
}

static void bones_keep_their_lengths_in_any_pose(void **state)
{
    (void)state;
    hand flat = with(0, 0.0f);
    uint32_t random = 1;
    for (int n = 0; n < 500; ++n) {
        float angle[MRT_ANGLES];
        random_angles(&random, angle, 3.1f);
        hand any = right_hand(angle);
        for (int finger = 0; finger < 5; ++finger) {
            int base = 1 + 4 * finger;
            assert_float_equal(distance(any.joint[0], any.joint[base]),
                               distance(flat.joint[0], flat.joint[base]), TOLERANCE_MM);
            for (int i = base; i < base + 3; ++i)
                assert_float_equal(distance(any.joint[i], any.joint[i + 1]),
                                   distance(flat.joint[i], flat.joint[i + 1]), TOLERANCE_MM);
        }
    }
}

/* The default shape is never overwritten: whatever was posed before, the same angles give the same
 * bits. */
static void a_pose_leaves_no_trace(void **state)
{
    (void)state;
    hand_skeleton *skeleton = hand_skeleton_create(MRT_RIGHT, HAND_LENGTH_MM);
    assert_non_null(skeleton);
    rigid wrist = rigid_identity();
    float zero[MRT_ANGLES] = {0};
    hand before, after, between;
    memset(&before, 0, sizeof before);
    memset(&after, 0, sizeof after);
    hand_pose(skeleton, zero, &wrist, before.joint, before.palm);
    uint32_t random = 3;
    for (int n = 0; n < 1000; ++n) {
        float angle[MRT_ANGLES];
        random_angles(&random, angle, 3.0f);
        hand_pose(skeleton, angle, &wrist, between.joint, between.palm);
    }
    hand_pose(skeleton, zero, &wrist, after.joint, after.palm);
    assert_memory_equal(&before, &after, sizeof before);
    hand_skeleton_destroy(skeleton);
}

static void flexion_brings_tips_to_the_palm_then_back_to_the_wrist(void **state)
{
    (void)state;
    for (int finger = 0; finger < 4; ++finger) {
        int end = tip[finger + 1];
        float y = 1e9f, z = 1e9f;
        for (int step = 0; step <= 15; ++step) {
            float angle[MRT_ANGLES] = {0};
            angle[mpj[finger]] = 0.1f * (float)step;
            hand bent = right_hand(angle);
            assert_true(bent.joint[end].y < y);
            y = bent.joint[end].y;
        }
        for (int step = 0; step <= 10; ++step) {
            float angle[MRT_ANGLES] = {0};
            for (int k = 0; k < 3; ++k)
                angle[mpj[finger] + k] = 0.1f * (float)step;
            hand bent = right_hand(angle);
            assert_true(bent.joint[end].z < z);
            z = bent.joint[end].z;
        }
    }
}

static void each_flexion_sensor_bends_its_own_joint(void **state)
{
    (void)state;
    hand flat = with(0, 0.0f);
    for (int finger = 0; finger < 4; ++finger)
        for (int k = 0; k < 3; ++k) {
            hand bent = with(mpj[finger] + k, 0.5f);
            for (int i = 0; i < MRT_JOINTS; ++i) {
                bool is_beyond = i > 5 + 4 * finger + k && i <= tip[finger + 1];
                float moved = distance(bent.joint[i], flat.joint[i]);
                assert_true(is_beyond ? moved > 1.0f : moved == 0.0f);
            }
        }
}

static void spread_separates_neighbouring_tips(void **state)
{
    (void)state;
    static const struct {
        int sensor, a, b;
    } spreads[3] = {{MIDDLE_INDEX, 8, 12}, {RING_MIDDLE, 12, 16}, {LITTLE_RING, 16, 20}};
    hand flat = with(0, 0.0f);
    for (int i = 0; i < 3; ++i) {
        hand spread = with(spreads[i].sensor, 0.3f), crossed = with(spreads[i].sensor, -0.3f);
        float at_rest = distance(flat.joint[spreads[i].a], flat.joint[spreads[i].b]);
        assert_true(distance(spread.joint[spreads[i].a], spread.joint[spreads[i].b]) >
                    at_rest + 10.0f);
        assert_true(distance(crossed.joint[spreads[i].a], crossed.joint[spreads[i].b]) < at_rest);
    }
    /* Spreading ring from middle takes the little finger along. */
    assert_true(with(RING_MIDDLE, 0.3f).joint[20].x < flat.joint[20].x - 10.0f);
    assert_true(with(MIDDLE_INDEX, 0.3f).joint[8].x > flat.joint[8].x + 10.0f);
}

static void spread_means_nothing_at_a_right_angle(void **state)
{
    (void)state;
    float angle[MRT_ANGLES] = {0}, spread[MRT_ANGLES];
    angle[4] = 1.5707964f;
    memcpy(spread, angle, sizeof spread);
    spread[MIDDLE_INDEX] = 0.4f;
    assert_true(distance(right_hand(angle).joint[8], right_hand(spread).joint[8]) < 0.01f);
}

static void thumb_roll_goes_from_the_thumb_side_across_the_palm(void **state)
{
    (void)state;
    float angle[MRT_ANGLES] = {0};
    angle[THUMB_ABD] = 0.6f;
    float x = 1e9f;
    for (int step = 0; step <= 20; ++step) {
        angle[ROLL] = 0.1f * (float)step;
        hand rolled = right_hand(angle);
        assert_true(rolled.joint[4].x < x);
        x = rolled.joint[4].x;
        if (step > 0)
            assert_true(rolled.joint[4].y < rolled.joint[1].y); /* in front of the palm */
    }
    assert_true(x < 0.0f); /* beyond the middle finger */
}

static void thumb_abduction_leaves_the_index_finger(void **state)
{
    (void)state;
    float reach = 0.0f;
    for (int step = 0; step <= 8; ++step) {
        hand open = with(THUMB_ABD, 0.1f * (float)step);
        float now = distance(open.joint[4], open.joint[6]);
        assert_true(now > reach);
        reach = now;
    }
}

static void thumb_flexion_bends_towards_fingers_and_palm(void **state)
{
    (void)state;
    float angle[MRT_ANGLES] = {0};
    angle[ROLL] = 1.5f;
    angle[THUMB_ABD] = 0.5f;
    hand straight = right_hand(angle);
    angle[THUMB_MPJ] = 0.5f;
    angle[THUMB_IJ] = 0.7f;
    hand bent = right_hand(angle);
    assert_true(bent.joint[4].x < straight.joint[4].x - 10.0f); /* across */
    assert_true(bent.joint[4].y > straight.joint[4].y + 10.0f); /* back to the palm */
}

static void arch_folds_the_little_side_to_the_palm_and_leaves_the_rest(void **state)
{
    (void)state;
    hand flat = with(0, 0.0f), arched = with(ARCH, 0.5f);
    assert_true(arched.joint[17].y < flat.joint[17].y - 8.0f);
    assert_true(arched.joint[17].x > flat.joint[17].x);
    assert_true(arched.joint[13].y < flat.joint[13].y - 2.0f);
    assert_true(arched.palm[2].y < flat.palm[2].y); /* hypothenar eminence */
    for (int i = 0; i < 13; ++i)
        assert_true(distance(arched.joint[i], flat.joint[i]) == 0.0f);
}

static void wrist_pitch_flexes_and_yaw_goes_to_the_thumb_side(void **state)
{
    (void)state;
    hand pitched = with(PITCH, 0.5f), yawed = with(YAW, 0.3f);
    /* The middle tip, 206.39 mm out: -206.39 sin 0.5, 206.39 cos 0.5; 206.39 sin 0.3 */
    assert_float_equal(pitched.joint[12].y, -98.9486f, TOLERANCE_MM);
    assert_float_equal(pitched.joint[12].z, 181.1244f, TOLERANCE_MM);
    assert_float_equal(yawed.joint[12].x, 60.9924f, TOLERANCE_MM);
    assert_true(pitched.joint[0].x == 0.0f && pitched.joint[0].y == 0.0f);
}

static void fist_brings_all_tips_near_the_palm(void **state)
{
    (void)state;
    float angle[MRT_ANGLES] = {0};
    for (int finger = 0; finger < 4; ++finger) {
        angle[mpj[finger]] = 1.4f;
        angle[mpj[finger] + 1] = 1.6f;
        angle[mpj[finger] + 2] = 0.9f;
    }
    angle[ROLL] = 1.9f;
    angle[THUMB_ABD] = 0.6f;
    angle[THUMB_MPJ] = 0.3f;
    angle[THUMB_IJ] = 0.6f;
    hand fist = right_hand(angle);
    for (int finger = 0; finger < 4; ++finger) {
        mrt_vec3 end = fist.joint[tip[finger + 1]];
        float nearest = 1e9f;
        for (int i = 0; i < MRT_PALM; ++i)
            nearest = fminf(nearest, distance(end, fist.palm[i]));
        assert_true(nearest < 35.0f);
        assert_true(end.z < 80.0f);
    }
    /* The thumb lies across the fingers, in front of them. */
    assert_true(fist.joint[4].x < 10.0f);
    assert_true(fist.joint[4].y < fist.joint[9].y - 30.0f);
}

/* FNV-1a over the bytes of 200 poses: what every compiler and machine must give, since takes are
 * replayed from angles. */
static void poses_have_the_stated_bits(void **state)
{
    (void)state;
    uint64_t hash = UINT64_C(14695981039346656037);
    uint32_t random = 20;
    for (int n = 0; n < 200; ++n) {
        float angle[MRT_ANGLES];
        random_angles(&random, angle, 3.1f);
        hand any = right_hand(angle);
        unsigned char bytes[sizeof any];
        memcpy(bytes, &any, sizeof bytes);
        for (size_t i = 0; i < sizeof bytes; ++i)
            hash = (hash ^ bytes[i]) * UINT64_C(1099511628211);
    }
    if (hash != POSE_HASH)
        fail_msg("the poses hash to %016llx", (unsigned long long)hash);
}

static void palm_points_lie_on_the_palmar_side(void **state)
{
    (void)state;
    hand flat = with(0, 0.0f);
    for (int i = 0; i < MRT_PALM; ++i) {
        assert_true(flat.palm[i].y <= -14.0f);
        assert_true(flat.palm[i].z > 0.0f && flat.palm[i].z < 100.0f);
    }
    assert_true(flat.palm[1].x > 0.0f && flat.palm[2].x < 0.0f); /* thenar, hypothenar */
}

static void tracked_wrist_moves_the_whole_hand(void **state)
{
    (void)state;
    float angle[MRT_ANGLES] = {0};
    rigid wrist = rigid_turn((vec3){0, 0, 0}, (vec3){1, 0, 0}, 1.5707963267948966);
    wrist.t = (vec3){5, 6, 7};
    hand moved = posed(MRT_LEFT, TABLE_LENGTH_MM, angle, &wrist);
    assert_float_equal(moved.joint[0].x, 5.0f, TOLERANCE_MM);
    /* +z turned about +x by a quarter is -y. */
    assert_float_equal(moved.joint[12].y, 6.0f - 206.39f, TOLERANCE_MM);
    assert_float_equal(moved.joint[12].z, 7.0f, TOLERANCE_MM);
    assert_float_equal(moved.joint[8].x, 5.0f - 28.0f, TOLERANCE_MM);
}

static void wild_angles_give_finite_joints(void **state)
{
    (void)state;
    static const float wild[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-40f};
    hand flat = with(0, 0.0f);
    for (size_t k = 0; k < sizeof wild / sizeof wild[0]; ++k) {
        float angle[MRT_ANGLES];
        for (int i = 0; i < MRT_ANGLES; ++i)
            angle[i] = wild[k];
        hand any = right_hand(angle);
        for (int i = 0; i < MRT_JOINTS; ++i)
            assert_true(isfinite(any.joint[i].x + any.joint[i].y + any.joint[i].z));
        if (!isfinite(wild[k]))
            assert_memory_equal(&any, &flat, sizeof any);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flat_right_hand_is_where_the_table_says),
        cmocka_unit_test(hand_length_scales_everything),
        cmocka_unit_test(no_skeleton_for_lengths_and_sides_that_are_none),
        cmocka_unit_test(left_hand_is_the_exact_mirror_image),
        cmocka_unit_test(bones_keep_their_lengths_in_any_pose),
        cmocka_unit_test(a_pose_leaves_no_trace),
        cmocka_unit_test(flexion_brings_tips_to_the_palm_then_back_to_the_wrist),
        cmocka_unit_test(each_flexion_sensor_bends_its_own_joint),
        cmocka_unit_test(spread_separates_neighbouring_tips),
        cmocka_unit_test(spread_means_nothing_at_a_right_angle),
        cmocka_unit_test(thumb_roll_goes_from_the_thumb_side_across_the_palm),
        cmocka_unit_test(thumb_abduction_leaves_the_index_finger),
        cmocka_unit_test(thumb_flexion_bends_towards_fingers_and_palm),
        cmocka_unit_test(arch_folds_the_little_side_to_the_palm_and_leaves_the_rest),
        cmocka_unit_test(wrist_pitch_flexes_and_yaw_goes_to_the_thumb_side),
        cmocka_unit_test(fist_brings_all_tips_near_the_palm),
        cmocka_unit_test(poses_have_the_stated_bits),
        cmocka_unit_test(palm_points_lie_on_the_palmar_side),
        cmocka_unit_test(tracked_wrist_moves_the_whole_hand),
        cmocka_unit_test(wild_angles_give_finite_joints),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
