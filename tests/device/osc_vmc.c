/* osc_event.h: quaternions of VMC's finger bones, worked out by hand from the VRM T-pose, give the
 * angles that a glove would. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "osc_event.h"

#include <math.h>
#include <string.h>

static const float tolerance_rad = 1e-6f;
/* sin and cos of half of 30, 60, 90 and 110 degrees. */
static const float s15 = 0.25881905f, c15 = 0.96592583f, s30 = 0.5f, c30 = 0.8660254f,
                   s45 = 0.70710678f, c45 = 0.70710678f, s55 = 0.81915204f, c55 = 0.57357644f;
static const float deg_rad = 0.017453293f;

static void apply(osc_vmc_pose *pose, const char *name, float x, float y, float z, float w,
                  float *angle_rad)
{
    osc_vmc_bone bone;
    float xyzw[4] = {x, y, z, w};
    assert_true(osc_vmc_bone_find(&bone, name));
    osc_vmc_apply(pose, &bone, xyzw, angle_rad);
}

static void a_right_knuckle_bends_about_minus_z_and_a_left_one_about_z(void **state)
{
    (void)state;
    osc_vmc_pose pose = {.is_vrm1 = false};
    float angle[MRT_ANGLES] = {0};
    apply(&pose, "RightIndexProximal", 0, 0, -s45, c45, angle);
    assert_float_equal(angle[4], 90 * deg_rad, tolerance_rad);
    apply(&pose, "LeftIndexProximal", 0, 0, s45, c45, angle);
    assert_float_equal(angle[4], 90 * deg_rad, tolerance_rad);
    apply(&pose, "LeftIndexProximal", 0, 0, -s15, c15, angle);
    assert_float_equal(angle[4], -30 * deg_rad, tolerance_rad);
}

static void every_joint_of_every_finger_has_its_sensor(void **state)
{
    (void)state;
    static const char *const name[12] = {
        "RightIndexProximal",  "RightIndexIntermediate",  "RightIndexDistal",
        "RightMiddleProximal", "RightMiddleIntermediate", "RightMiddleDistal",
        "RightRingProximal",   "RightRingIntermediate",   "RightRingDistal",
        "RightLittleProximal", "RightLittleIntermediate", "RightLittleDistal"};
    static const int sensor[12] = {4, 5, 6, 7, 8, 9, 11, 12, 13, 15, 16, 17};
    for (int i = 0; i < 12; ++i) {
        osc_vmc_pose pose = {.is_vrm1 = false};
        float angle[MRT_ANGLES] = {0};
        apply(&pose, name[i], 0, 0, -s30, c30, angle);
        for (int k = 0; k < MRT_ANGLES; ++k)
            assert_float_equal(angle[k], k == sensor[i] ? 60 * deg_rad : 0, tolerance_rad);
    }
}

static void a_joint_may_bend_beyond_a_right_angle(void **state)
{
    (void)state;
    osc_vmc_pose pose = {.is_vrm1 = false};
    float angle[MRT_ANGLES] = {0};
    apply(&pose, "RightMiddleIntermediate", 0, 0, -s55, c55, angle);
    assert_float_equal(angle[8], 110 * deg_rad, tolerance_rad);
    /* q and -q are the same turn. */
    apply(&pose, "RightMiddleIntermediate", 0, 0, s55, -c55, angle);
    assert_float_equal(angle[8], 110 * deg_rad, tolerance_rad);
}

/* Bent by 60 and turned aside by 30 degrees, in either order, for the right index finger: about -z
 * and about -y (towards the thumb). */
static void bending_and_spreading_do_not_disturb_each_other(void **state)
{
    (void)state;
    for (int order = 0; order < 2; ++order) {
        osc_vmc_pose pose = {.is_vrm1 = false};
        float angle[MRT_ANGLES] = {0};
        float x = (order == 0 ? 1.0f : -1.0f) * s15 * s30;
        apply(&pose, "RightIndexProximal", x, -s15 * c30, -c15 * s30, c15 * c30, angle);
        assert_float_equal(angle[4], 60 * deg_rad, tolerance_rad);
        assert_float_equal(angle[10], 30 * deg_rad, tolerance_rad);
    }
}

/* Index to the thumb's side, little away from it: apart, all three positive where they should be.
 */
static void spread_fingers_are_positive_on_both_hands(void **state)
{
    (void)state;
    for (int side = 0; side < 2; ++side) {
        float to_thumb = side == 0 ? s15 : -s15; /* left hand: about +y */
        const char *const *name =
            side == 0 ? (const char *const[]){"LeftIndexProximal", "LeftMiddleProximal",
                                              "LeftRingProximal", "LeftLittleProximal"}
                      : (const char *const[]){"RightIndexProximal", "RightMiddleProximal",
                                              "RightRingProximal", "RightLittleProximal"};
        osc_vmc_pose pose = {.is_vrm1 = false};
        float angle[MRT_ANGLES] = {0};
        apply(&pose, name[0], 0, to_thumb, 0, c15, angle);
        apply(&pose, name[1], 0, 0, 0, 1, angle);
        apply(&pose, name[2], 0, 0, 0, 1, angle);
        apply(&pose, name[3], 0, -to_thumb, 0, c15, angle);
        assert_float_equal(angle[10], 30 * deg_rad, tolerance_rad);
        assert_float_equal(angle[14], 0, tolerance_rad);
        assert_float_equal(angle[18], 30 * deg_rad, tolerance_rad);
    }
}

/* A right thumb points to +x +z, its nail to -x +z: it bends about +y, its base goes down about +x.
 */
static void the_thumb_bends_level_and_goes_across_by_its_base(void **state)
{
    (void)state;
    osc_vmc_pose pose = {.is_vrm1 = false};
    float angle[MRT_ANGLES] = {0};
    apply(&pose, "RightThumbIntermediate", 0, s15, 0, c15, angle);
    apply(&pose, "RightThumbDistal", 0, s30, 0, c30, angle);
    assert_float_equal(angle[1], 30 * deg_rad, tolerance_rad);
    assert_float_equal(angle[2], 60 * deg_rad, tolerance_rad);
    apply(&pose, "RightThumbProximal", s15, 0, 0, c15, angle);
    assert_float_equal(angle[0], 30 * deg_rad, tolerance_rad);
    assert_float_equal(angle[3], 45 * deg_rad - 0.15f, tolerance_rad);
    apply(&pose, "RightThumbProximal", 0, s15, 0, c15, angle); /* to the index finger */
    assert_float_equal(angle[0], 0, tolerance_rad);
    assert_float_equal(angle[3], 15 * deg_rad - 0.15f, tolerance_rad);
    apply(&pose, "LeftThumbProximal", s15, 0, 0, c15, angle);
    assert_float_equal(angle[0], 30 * deg_rad, tolerance_rad);
    apply(&pose, "LeftThumbDistal", 0, -s30, 0, c30, angle);
    assert_float_equal(angle[2], 60 * deg_rad, tolerance_rad);
}

static void the_hand_gives_the_wrist(void **state)
{
    (void)state;
    osc_vmc_pose pose = {.is_vrm1 = false};
    float angle[MRT_ANGLES] = {0};
    apply(&pose, "RightHand", 0, 0, -s15, c15, angle);
    assert_float_equal(angle[20], 30 * deg_rad, tolerance_rad);
    apply(&pose, "LeftHand", 0, s15, 0, c15, angle);
    assert_float_equal(angle[20], 0, tolerance_rad);
    assert_float_equal(angle[21], 30 * deg_rad, tolerance_rad);
}

static void other_bones_are_not_of_a_hand(void **state)
{
    (void)state;
    static const char *const name[] = {
        "Hips",         "LeftUpperArm",       "LeftHandX", "Left",
        "LeftIndex",    "leftIndexProximal",  "",          "Right",
        "RightEye",     "LeftIndexProximal ", "RightToes", "LeftThumb",
        "RightThumbTip"};
    for (size_t i = 0; i < sizeof name / sizeof *name; ++i) {
        osc_vmc_bone bone;
        assert_false(osc_vmc_bone_find(&bone, name[i]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_right_knuckle_bends_about_minus_z_and_a_left_one_about_z),
        cmocka_unit_test(every_joint_of_every_finger_has_its_sensor),
        cmocka_unit_test(a_joint_may_bend_beyond_a_right_angle),
        cmocka_unit_test(bending_and_spreading_do_not_disturb_each_other),
        cmocka_unit_test(spread_fingers_are_positive_on_both_hands),
        cmocka_unit_test(the_thumb_bends_level_and_goes_across_by_its_base),
        cmocka_unit_test(the_hand_gives_the_wrist),
        cmocka_unit_test(other_bones_are_not_of_a_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
