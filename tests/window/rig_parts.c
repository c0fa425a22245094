/* The parts of a rig by hand: bones, ellipsoids and poses are added, changed, named, taken out and
 * undone. Pictures of each are written to the build folder's out/. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "rig_stand.h"

#include <math.h>
#include <string.h>

#define PUPPET SOURCE_DIR "/rigs/puppet/puppet.rig.json"

static rig_stand s;

static const rig *rig_now(void)
{
    return s.of.file.rig;
}

static void open_parts(uint32_t width, uint32_t height, float scale)
{
    rig_stand_open(&s, PUPPET, "", width, height, scale);
    rig_stand_frames(&s, 40);
    rig_stand_click_on(&s, "Parts");
    rig_stand_frames(&s, 3);
}

static void fold(const char *section)
{
    rig_stand_click_on(&s, section);
    rig_stand_frames(&s, 2);
}

static void undo_last(void)
{
    const undo_change *step = &s.step[s.step_count - 1];
    const uint32_t before = s.change_count;
    (void)step->set(step->owner, step->before);
    rig_stand_wait_for_change(&s, before + 1);
}

static void everything_can_be_read(void **state)
{
    static const uint32_t size[2][2] = {{1280, 720}, {2560, 1440}};
    (void)state;
    for (uint32_t k = 0; k < 2; ++k) {
        open_parts(size[k][0], size[k][1], (float)(k + 1));
        rig_stand_picture(&s, k == 0 ? "rig_parts" : "rig_parts_2x");
        rig_stand_check_words(&s);
        rig_stand_close(&s);
    }
}

static void a_ball_is_added_and_taken_back(void **state)
{
    (void)state;
    open_parts(1280, 720, 1.0f);
    rig_stand_click_on(&s, "a rigid part");
    rig_stand_frames(&s, 3);
    rig_stand_click_on(&s, "a ball, like an eye");
    rig_stand_frames(&s, 3);
    rig_stand_click_on(&s, "Add");
    rig_stand_frames(&s, 3);
    assert_string_equal(s.step[0].words, "rig: add a bone");
    assert_true(rig_stand_says(&s, "Radius"));
    assert_true(rig_stand_says(&s, "No region moves with this bone")); /* nobody rides on it yet */
    rig_stand_picture(&s, "rig_parts_ball");
    rig_stand_check_words(&s);
    (void)s.step[0].set(s.step[0].owner, s.step[0].before);
    rig_stand_frames(&s, 3);
    assert_false(rig_stand_says(&s, "Radius"));
    (void)s.step[0].set(s.step[0].owner, s.step[0].after);
    rig_stand_frames(&s, 3);
    assert_int_equal(s.step_count, 1);
    rig_stand_click_on(&s, "lid_lower.r"); /* the one behind it in the list is the new one */
    rig_stand_frames(&s, 2);
    assert_false(rig_stand_says(&s, "No region moves with this bone"));
    rig_stand_close(&s);
}

/* Each change is a step, and what is tried changes nothing. */
static void a_ball_s_turns_are_edited_by_hand(void **state)
{
    (void)state;
    open_parts(1280, 1100, 1.0f); /* all of it is seen */
    const uint32_t eye = rig_find_bone(rig_now(), "eye.l");
    fold("Collision shapes");
    fold("Poses");
    rig_stand_click_on(&s, "eye.l");
    rig_stand_frames(&s, 3);
    rig_stand_click_on(&s, "yaw, -35");
    rig_stand_frames(&s, 3);
    assert_true(rig_stand_says(&s, "to the subject's left"));
    assert_true(rig_stand_says(&s, "Try"));
    rig_stand_picture(&s, "rig_parts_turn");
    rig_stand_check_words(&s);
    assert_int_equal(s.step_count, 0);
    rig_stand_click_on(&s, "to the subject's left");
    rig_stand_frames(&s, 3);
    rig_stand_click_on(&s, "rolls, its left side up");
    rig_stand_wait_for_change(&s, 1);
    assert_string_equal(s.step[0].words, "rig: change a turn");
    assert_float_equal(rig_now()->bone[eye].turn[0].axis.z, 1.0, 1e-9);
    undo_last();
    assert_float_equal(rig_now()->bone[eye].turn[0].axis.y, 1.0, 1e-9);
    rig_stand_click_on(&s, "Add a turn");
    rig_stand_wait_for_change(&s, 3);
    assert_int_equal(rig_now()->bone[eye].turn_count, 3);
    assert_string_equal(rig_now()->bone[eye].turn[2].name, "roll");
    rig_stand_frames(&s, 3);
    assert_false(rig_stand_says(&s, "Add a turn")); /* there are three at most */
    undo_last();
    assert_int_equal(rig_now()->bone[eye].turn_count, 2);
    rig_stand_close(&s);
}

static void a_new_bone_gets_a_region_of_its_own(void **state)
{
    (void)state;
    open_parts(1280, 720, 1.0f);
    rig_stand_click_on(&s, "Add");
    rig_stand_frames(&s, 3);
    rig_stand_click_on(&s, "Add a region for it");
    rig_stand_frames(&s, 3);
    assert_int_equal(s.step_count, 2);
    assert_string_equal(s.step[1].words, "rig: add a region");
    assert_true(rig_stand_says(&s, "Add a region")); /* of the list that is open now */
    assert_true(rig_stand_says(&s, "part"));
    rig_stand_close(&s);
}

static void a_bone_is_taken_out_and_the_skull_stays(void **state)
{
    (void)state;
    open_parts(1280, 1000, 1.0f);
    const uint32_t count = rig_now()->bone_count;
    fold("Collision shapes");
    fold("Poses");
    rig_stand_click_on(&s, "skull");
    rig_stand_frames(&s, 2);
    rig_stand_click_on(&s, "Remove");
    rig_stand_frames(&s, 20);
    assert_int_equal(s.step_count, 0);
    rig_stand_click_on(&s, "jaw");
    rig_stand_frames(&s, 2);
    rig_stand_click_on(&s, "Remove");
    rig_stand_wait_for_change(&s, 1);
    assert_int_equal(rig_now()->bone_count, count - 1);
    assert_int_equal(rig_find_bone(rig_now(), "jaw"), RIG_NONE);
    undo_last();
    assert_int_equal(rig_find_bone(rig_now(), "jaw"), 1);
    rig_stand_close(&s);
}

static void an_ellipsoid_is_added_and_taken_out(void **state)
{
    (void)state;
    open_parts(1280, 720, 1.0f);
    const uint32_t count = rig_now()->proxy_count;
    fold("Bones");
    rig_stand_click_on(&s, "Add an ellipsoid");
    rig_stand_wait_for_change(&s, 1);
    assert_int_equal(rig_now()->proxy_count, count + 1);
    rig_stand_frames(&s, 3);
    rig_stand_picture(&s, "rig_parts_ellipsoid");
    rig_stand_check_words(&s);
    rig_stand_click_on(&s, "Remove");
    rig_stand_wait_for_change(&s, 2);
    assert_int_equal(rig_now()->proxy_count, count);
    undo_last();
    assert_int_equal(rig_now()->proxy_count, count + 1);
    rig_stand_close(&s);
}

/* It can be once the rig is laid on the face. */
static void add_shape(void)
{
    const int64_t end_ns = clock_now_ns() + 600 * NS_PER_S;
    while (s.step_count == 0 && clock_now_ns() < end_ns) {
        rig_stand_click_on(&s, "Add current shape");
        rig_stand_frames(&s, 5);
    }
    assert_int_equal(s.step_count, 1);
}

static void the_shape_on_the_stage_becomes_a_pose(void **state)
{
    (void)state;
    open_parts(1280, 720, 1.0f);
    const uint32_t count = rig_now()->pose_count, tip = stand_contact(&s.of, "nose.tip");
    fold("Bones");
    fold("Collision shapes");
    s.of.view.contact[tip].z += 7.0;
    add_shape();
    rig_stand_wait_for_change(&s, 1);
    assert_int_equal(rig_now()->pose_count, count + 1);
    const rig_pose *made = &rig_now()->pose[count];
    assert_string_equal(made->name, "pose 1");
    for (uint32_t i = 0; i < made->pull_count; ++i) /* the others stay: those beside it are named */
        assert_true(fabs(made->pull_mm[i].z - (made->pull_contact[i] == tip ? 7.0 : 0.0)) < 0.3);
    assert_true(made->pull_count > 1 && made->pull_contact[0] == tip);
    rig_stand_frames(&s, 20);
    rig_stand_picture(&s, "rig_parts_pose");
    rig_stand_check_words(&s);
    rig_stand_click_on(&s, "Remove");
    rig_stand_wait_for_change(&s, 2);
    assert_int_equal(rig_now()->pose_count, count);
    undo_last();
    assert_int_equal(rig_now()->pose_count, count + 1);
    rig_stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_can_be_read),
        cmocka_unit_test(a_ball_is_added_and_taken_back),
        cmocka_unit_test(a_ball_s_turns_are_edited_by_hand),
        cmocka_unit_test(a_new_bone_gets_a_region_of_its_own),
        cmocka_unit_test(a_bone_is_taken_out_and_the_skull_stays),
        cmocka_unit_test(an_ellipsoid_is_added_and_taken_out),
        cmocka_unit_test(the_shape_on_the_stage_becomes_a_pose),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
