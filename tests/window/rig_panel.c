/* The rig panel by hand: painted, undone, saved; contacts and the jaw taken hold of on the face.
 * Pictures of each are written to the build folder's out/. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/file.h"
#include "rig_stand.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PUPPET SOURCE_DIR "/rigs/puppet/puppet.rig.json"
#define MOAI   SOURCE_DIR "/rigs/moai/moai.rig.json"
#define STONE  SOURCE_DIR "/rigs/moai/moai.glb"

static rig_stand s;

static uint32_t vertex_of(const char *contact)
{
    return s.of.file.rig->contact[stand_contact(&s.of, contact)].vertex;
}

static void stroke_over(const char *from, const char *to)
{
    float x0, y0, x1, y1;
    rig_stand_place(&s, vertex_of(from), &x0, &y0);
    rig_stand_place(&s, vertex_of(to), &x1, &y1);
    rig_stand_move(&s, x0, y0);
    rig_stand_button(&s, true);
    for (int i = 1; i <= 8; ++i)
        rig_stand_move(&s, x0 + (x1 - x0) * (float)i / 8.0f, y0 + (y1 - y0) * (float)i / 8.0f);
}

static uint32_t find_region(const char *name)
{
    const rig *r = s.of.file.rig;
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (r->region[i].name && strcmp(r->region[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

static void a_stroke_is_painted_and_undone(void **state)
{
    (void)state;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 40);
    rig_stand_picture(&s, "rig_regions");
    rig_stand_check_words(&s);
    print_message("opened: update %.2f ms, draw %.2f ms at most\n", s.update_ms, s.draw_ms);
    s.update_ms = s.draw_ms = 0.0;
    rig_stand_click_on(&s, "Paint");
    rig_stand_frames(&s, 3);
    stroke_over("cheek.l", "cheek.lower.l");
    print_message("painting: update %.2f ms, draw %.2f ms at most\n", s.update_ms, s.draw_ms);
    rig_stand_picture(&s, "rig_painting");
    rig_stand_check_words(&s);
    assert_int_equal(s.step_count, 0);
    rig_stand_button(&s, false);
    rig_stand_frames(&s, 2);
    assert_int_equal(s.step_count, 1); /* a stroke is one step */
    assert_string_equal(s.step[0].words, "rig: paint skull");
    assert_in_range(s.step[0].bytes, 20000, 200000); /* of what undo may keep: the rig */
    assert_true(s.has_unsaved);
    rig_stand_wait_for_change(&s, 1);
    uint32_t region = find_region("painted skull");
    assert_true(region != RIG_NONE);
    assert_int_equal(s.of.file.rig->region[region].select.kind, SELECT_PAINTED);
    rig_stand_picture(&s, "rig_painted");
    (void)s.step[0].set(s.step[0].owner, s.step[0].before);
    rig_stand_wait_for_change(&s, 2);
    assert_int_equal(find_region("painted skull"), RIG_NONE);
    rig_stand_frames(&s, 2);
    assert_false(s.has_unsaved);
    print_message("with the stage's change: update %.2f ms, draw %.2f ms at most\n", s.update_ms,
                  s.draw_ms);
    rig_stand_close(&s);
}

static void a_region_that_is_chosen_is_shown_alone(void **state)
{
    (void)state;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 40);
    rig_stand_click_on(&s, "mobile");
    rig_stand_picture(&s, "rig_region");
    rig_stand_check_words(&s);
    rig_stand_click_on(&s, "Remove");
    assert_int_equal(s.step_count, 1);
    rig_stand_frames(&s, 2);
    rig_stand_wait_for_change(&s, 1);
    rig_stand_close(&s);
}

static void a_contact_is_dragged_with_its_mirror(void **state)
{
    (void)state;
    float x, y;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_click_on(&s, "Contacts");
    rig_stand_frames(&s, 3);
    uint32_t before = vertex_of("cheek.l"), other = vertex_of("cheek.r");
    rig_stand_place(&s, before, &x, &y);
    rig_stand_move(&s, x, y);
    rig_stand_button(&s, true);
    rig_stand_move(&s, x + 9.0f, y + 6.0f);
    rig_stand_move(&s, x + 18.0f, y + 12.0f);
    rig_stand_picture(&s, "rig_contacts");
    rig_stand_check_words(&s);
    assert_int_equal(s.step_count, 0);
    rig_stand_button(&s, false);
    rig_stand_frames(&s, 2);
    assert_int_equal(s.step_count, 1);
    rig_stand_wait_for_change(&s, 1);
    assert_int_not_equal(vertex_of("cheek.l"), before);
    assert_int_not_equal(vertex_of("cheek.r"), other);
    const float *l = s.of.file.mesh.position + (size_t)vertex_of("cheek.l") * 3;
    const float *r = s.of.file.mesh.position + (size_t)vertex_of("cheek.r") * 3;
    assert_true(fabsf(l[0] + r[0]) < 0.01f && fabsf(l[1] - r[1]) < 0.01f);
    rig_stand_close(&s);
}

static void a_contact_that_is_chosen_on_the_face_comes_into_sight_in_the_list(void **state)
{
    (void)state;
    float x, y;
    char vertex[32];
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_click_on(&s, "Contacts");
    rig_stand_frames(&s, 3);
    const rig *r = s.of.file.rig;
    const uint32_t last = r->contact[r->contact_count - 1].vertex;
    (void)snprintf(vertex, sizeof vertex, "%u", last);
    assert_false(rig_stand_says(&s, vertex));
    rig_stand_place(&s, last, &x, &y);
    rig_stand_click(&s, x, y);
    rig_stand_frames(&s, 3);
    rig_stand_picture(&s, "rig_contact_followed");
    assert_true(rig_stand_says(&s, vertex));
    rig_stand_close(&s);
}

static void regions_that_say_the_same_are_told_apart(void **state)
{
    (void)state;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 40);
    assert_false(rig_stand_says(&s, "mobile (2)"));
    rig_stand_click_on(&s, "Add a region");
    rig_stand_wait_for_change(&s, 1);
    rig_stand_click_on(&s, "Add a region");
    rig_stand_wait_for_change(&s, 2);
    rig_stand_frames(&s, 3);
    rig_stand_picture(&s, "rig_regions_alike");
    assert_true(rig_stand_says(&s, "skull (6)"));
    rig_stand_close(&s);
}

static void a_contact_is_added_where_the_face_is_clicked(void **state)
{
    (void)state;
    float x, y;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_click_on(&s, "Contacts");
    rig_stand_click_on(&s, "Add a contact");
    rig_stand_place(&s, vertex_of("nose.tip"), &x, &y);
    uint32_t count = s.of.file.rig->contact_count;
    rig_stand_click(&s, x, y - 60.0f);
    rig_stand_wait_for_change(&s, 1);
    assert_int_equal(s.of.file.rig->contact_count, count + 1);
    assert_true(rig_stand_says(&s, "Mirror it"));
    rig_stand_close(&s);
}

static void the_axis_of_the_jaw_is_dragged_and_the_jaw_tried(void **state)
{
    (void)state;
    float x, y;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 60);
    rig_stand_click_on(&s, "Jaw");
    rig_stand_frames(&s, 3);
    const rig_bone *jaw = &s.of.file.rig->bone[1];
    vec3 left = jaw->hinge_left;
    rig_stand_place_at(&s, left, &x, &y);
    rig_stand_move(&s, x, y);
    rig_stand_button(&s, true);
    rig_stand_move(&s, x, y - 8.0f);
    rig_stand_move(&s, x + 4.0f, y - 16.0f);
    rig_stand_picture(&s, "rig_jaw_dragged");
    rig_stand_button(&s, false);
    rig_stand_frames(&s, 2);
    assert_int_equal(s.step_count, 1);
    rig_stand_wait_for_change(&s, 1);
    jaw = &s.of.file.rig->bone[1];
    assert_true(jaw->hinge_left.y > left.y + 2.0);
    assert_true(fabs(jaw->hinge_left.z - left.z) < 1.0); /* in the plane that faces the eye */
    assert_true(fabs(jaw->hinge_left.x + jaw->hinge_right.x) < 1e-6);
    rig_stand_move(&s, s.dock.x + 220.0f, s.dock.y + 112.0f); /* the slider of "Open" */
    rig_stand_button(&s, true);
    rig_stand_move(&s, s.dock.x + 270.0f, s.dock.y + 112.0f);
    rig_stand_button(&s, false);
    rig_stand_picture(&s, "rig_jaw");
    rig_stand_check_words(&s);
    assert_int_equal(s.step_count, 1); /* trying is no change */
    rig_stand_close(&s);
}

static void undo_last(void)
{
    const undo_change *step = &s.step[s.step_count - 1];
    const uint32_t before = s.change_count;
    (void)step->set(step->owner, step->before);
    rig_stand_wait_for_change(&s, before + 1);
}

static void the_rims_of_the_mouth_are_found_and_taken_out(void **state)
{
    (void)state;
    rig_stand_open(&s, PUPPET, "", 1280, 1000, 1.0f);
    rig_stand_frames(&s, 60);
    rig_stand_click_on(&s, "Jaw");
    rig_stand_frames(&s, 3);
    const uint32_t count = s.of.file.rig->mouth.upper_count;
    assert_true(rig_stand_says(&s, "37 and 37 vertices"));
    rig_stand_picture(&s, "rig_mouth");
    rig_stand_check_words(&s);
    rig_stand_click_on(&s, "Remove");
    rig_stand_wait_for_change(&s, 1);
    assert_string_equal(s.step[0].words, "rig: remove the mouth");
    assert_null(s.of.file.rig->mouth.upper);
    assert_true(rig_stand_says(&s, "The mouth has no rims"));
    for (uint32_t i = 0; i < s.of.file.rig->pose_count; ++i)
        for (uint32_t k = 0; k < s.of.file.rig->pose[i].dof_count; ++k)
            assert_string_not_equal(s.of.file.rig->pose[i].dof_name[k], RIG_LIPS_SEAL);
    rig_stand_click_on(&s, "Find the rims");
    rig_stand_wait_for_change(&s, 2);
    assert_int_equal(s.of.file.rig->mouth.upper_count, count);
    assert_string_equal(s.step[1].words, "rig: find the rims of the mouth");
    rig_stand_picture(&s, "rig_mouth_found");
    undo_last();
    assert_null(s.of.file.rig->mouth.upper);
    rig_stand_close(&s);
}

static void findings_lead_to_what_they_speak_of(void **state)
{
    (void)state;
    rig_stand_open(&s, MOAI, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 60);
    rig_stand_click_on(&s, "Check");
    rig_stand_picture(&s, "rig_check");
    rig_stand_check_words(&s);
    rig_stand_close(&s);
}

static void a_mesh_alone_can_be_drafted(void **state)
{
    (void)state;
    rig_stand_open(&s, STONE, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 5);
    rig_stand_picture(&s, "rig_none");
    rig_stand_check_words(&s);
    rig_stand_click_on(&s, "Open moai.rig.json");
    assert_string_equal(s.opened, MOAI);
    rig_stand_click_on(&s, "Draft a rig");
    rig_stand_wait_for_change(&s, 1);
    assert_non_null(s.of.file.rig);
    rig_stand_picture(&s, "rig_draft");
    rig_stand_check_words(&s);
    rig_stand_click_on(&s, "Regions");
    rig_stand_picture(&s, "rig_draft_regions");
    (void)s.step[0].set(s.step[0].owner, s.step[0].before);
    rig_stand_wait_for_change(&s, 2);
    assert_null(s.of.file.rig);
    rig_stand_picture(&s, "rig_draft_undone");
    rig_stand_close(&s);
}

static void everything_fits_at_scale_two(void **state)
{
    (void)state;
    rig_stand_open(&s, PUPPET, "", 2560, 1440, 2.0f);
    rig_stand_frames(&s, 40);
    rig_stand_click_on(&s, "mobile");
    rig_stand_picture(&s, "rig_scale_two");
    rig_stand_check_words(&s);
    rig_stand_close(&s);
}

static void it_lets_go_of_the_face_when_it_is_not_seen(void **state)
{
    (void)state;
    rig_stand_open(&s, PUPPET, "", 1280, 720, 1.0f);
    rig_stand_frames(&s, 40);
    rig_stand_click_on(&s, "Paint");
    stroke_over("cheek.l", "cheek.lower.l");
    s.is_panel_seen = false;
    rig_stand_frames(&s, 3);
    assert_int_equal(s.step_count, 1); /* the stroke is not lost */
    rig_stand_button(&s, false);
    rig_stand_picture(&s, "rig_away");
    rig_stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_stroke_is_painted_and_undone),
        cmocka_unit_test(a_region_that_is_chosen_is_shown_alone),
        cmocka_unit_test(a_contact_is_dragged_with_its_mirror),
        cmocka_unit_test(a_contact_that_is_chosen_on_the_face_comes_into_sight_in_the_list),
        cmocka_unit_test(regions_that_say_the_same_are_told_apart),
        cmocka_unit_test(a_contact_is_added_where_the_face_is_clicked),
        cmocka_unit_test(the_axis_of_the_jaw_is_dragged_and_the_jaw_tried),
        cmocka_unit_test(the_rims_of_the_mouth_are_found_and_taken_out),
        cmocka_unit_test(findings_lead_to_what_they_speak_of),
        cmocka_unit_test(a_mesh_alone_can_be_drafted),
        cmocka_unit_test(everything_fits_at_scale_two),
        cmocka_unit_test(it_lets_go_of_the_face_when_it_is_not_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
