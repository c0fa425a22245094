/* hand/guide.h: a calibration that a person would not perform with is called so, with the
 * pose to repeat. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "hand_guide_bench.h"

#include "hand/guide.h"

/* The judgement of what the guide has now. */
static guide_judgement judge(const glove *g)
{
    calibration_file file;
    guide_judgement out;
    error err = {""};
    assert_int_equal(guide_result(g->guide, &file, &err), MRT_OK);
    guide_judge(&out, g->guide, &file);
    return out;
}

static void a_glove_that_fits_has_no_flaw(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    char text[128];
    perform_until(&g, GUIDE_STEPS);
    guide_judgement judged = judge(&g);
    assert_int_equal(judged.flaw_count, 0);
    assert_int_equal(judged.left_out, 0);
    guide_judgement_text(&judged, text, sizeof text);
    assert_string_equal(text, "All poses are done.");
    guide_destroy(g.guide);
}

static void a_finger_bent_where_it_should_be_straight_names_the_pose_to_repeat(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    char text[256];
    perform_until(&g, GUIDE_LITTLE_ALONE);
    double pose[MRT_ANGLES];
    pose_of(pose, GUIDE_LITTLE_ALONE);
    pose[8] = 70; /* the middle finger's middle joint */
    go(&g, pose, 1.5);
    assert_int_equal(g.news, GUIDE_TAKEN);
    guide_judgement judged = judge(&g);
    assert_int_equal(judged.flaw_count, 1);
    assert_int_equal(judged.flaw[0].kind, GUIDE_FLAW_OFF);
    assert_int_equal(judged.flaw[0].step, GUIDE_LITTLE_ALONE);
    assert_true(guide_flaw_is_wrong(&judged.flaw[0]));
    guide_flaw_text(&judged.flaw[0], text, sizeof text);
    assert_non_null(strstr(text, "middle finger, middle joint: reads "));
    assert_non_null(strstr(text, "where it should be straight. Repeat: little alone."));
    guide_judgement_text(&judged, text, sizeof text);
    assert_string_equal(text, "All poses are done, but 1 sensor is not right.");
    guide_again(g.guide, GUIDE_LITTLE_ALONE);
    perform(&g, GUIDE_FLAT); /* the other hand went to the mouse: this one is not in the pose */
    perform(&g, GUIDE_LITTLE_ALONE);
    assert_int_equal(guide_current(g.guide), GUIDE_STEPS);
    assert_int_equal(judge(&g).flaw_count, 0);
    guide_destroy(g.guide);
}

static void a_flat_hand_that_was_not_flat_is_what_to_repeat(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    perform_until(&g, GUIDE_FLAT);
    double pose[MRT_ANGLES];
    pose_of(pose, GUIDE_FLAT);
    pose[8] = 30;
    go(&g, pose, 1.5);
    perform_until(&g, GUIDE_STEPS);
    guide_judgement judged = judge(&g);
    assert_int_equal(judged.flaw_count, 1);
    assert_int_equal(judged.flaw[0].sensor, 8);
    assert_int_equal(judged.flaw[0].step, GUIDE_FLAT);
    guide_again(g.guide, judged.flaw[0].step);
    perform(&g, GUIDE_FLAT);
    assert_int_equal(guide_current(g.guide), GUIDE_STEPS);
    assert_int_equal(judge(&g).flaw_count, 0);
    guide_destroy(g.guide);
}

static void half_a_fist_and_a_dead_sensor_are_flaws_of_the_fist(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    g.counts[SENSOR_RING_MPJ] = 0;
    perform_until(&g, GUIDE_FIST);
    double half[MRT_ANGLES];
    pose_of(half, GUIDE_FIST);
    half[5] = 60; /* of 100 */
    go(&g, half, 1.5);
    perform_until(&g, GUIDE_STEPS);
    guide_judgement judged = judge(&g);
    assert_int_equal(judged.flaw_count, 2);
    assert_int_equal(judged.flaw[0].kind, GUIDE_FLAW_BEYOND);
    assert_int_equal(judged.flaw[0].sensor, 5);
    assert_int_equal(judged.flaw[0].step, GUIDE_FIST);
    assert_int_equal(judged.flaw[1].kind, GUIDE_FLAW_DEAD);
    assert_int_equal(judged.flaw[1].sensor, SENSOR_RING_MPJ);
    assert_int_equal(judged.flaw[1].step, GUIDE_FIST);
    guide_destroy(g.guide);
}

static void cloth_that_slips_is_loose_and_no_more(void **state)
{
    (void)state;
    guide_settings settings = guide_settings_default(MRT_RIGHT, ALL_22);
    glove g = put_on(&settings);
    char text[256];
    perform_until(&g, GUIDE_RING_ALONE);
    double pose[MRT_ANGLES];
    pose_of(pose, GUIDE_RING_ALONE);
    pose[5] = 8;
    go(&g, pose, 1.5);
    perform_until(&g, GUIDE_STEPS);
    guide_judgement judged = judge(&g);
    assert_int_equal(judged.flaw_count, 1);
    assert_int_equal(judged.flaw[0].kind, GUIDE_FLAW_LOOSE);
    assert_false(guide_flaw_is_wrong(&judged.flaw[0]));
    guide_judgement_text(&judged, text, sizeof text);
    assert_string_equal(text, "All poses are done, but 1 sensor fits loosely.");
    guide_destroy(g.guide);
}

static void a_file_alone_is_judged_by_its_residuals(void **state)
{
    (void)state;
    calibration_file file;
    guide_judgement judged;
    char text[256];
    calibration_file_init(&file, MRT_RIGHT);
    file.sensor[8] =
        (calibration_sensor){.table = {.count = 2}, .has_residual = true, .residual_rad = 1.71f};
    guide_judge(&judged, NULL, &file);
    assert_int_equal(judged.flaw_count, 1);
    assert_int_equal(judged.flaw[0].step, GUIDE_STEPS);
    guide_flaw_text(&judged.flaw[0], text, sizeof text);
    assert_string_equal(text, "middle finger, middle joint: reads 98 degrees where it should be "
                              "straight. Calibrate again.");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_glove_that_fits_has_no_flaw),
        cmocka_unit_test(a_finger_bent_where_it_should_be_straight_names_the_pose_to_repeat),
        cmocka_unit_test(a_flat_hand_that_was_not_flat_is_what_to_repeat),
        cmocka_unit_test(half_a_fist_and_a_dead_sensor_are_flaws_of_the_fist),
        cmocka_unit_test(cloth_that_slips_is_loose_and_no_more),
        cmocka_unit_test(a_file_alone_is_judged_by_its_residuals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
