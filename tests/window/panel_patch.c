/* The patch panel, as a person sees and uses it: learning by moving and clicking, a list with live
 * meters, changes that are steps of undo. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "panel_stand.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const mrt_contact contact[2] = {{"mouth.corner.l", "skull", {25, 90, 65}, {0, 0, 1}},
                                       {"mouth.corner.r", "skull", {-25, 90, 65}, {0, 0, 1}}};
static const mrt_dof dof[1] = {{"jaw.open", "rad", 0, 0.5f}};
static const mrt_face about = {contact, dof, 2, 1, {-75, 0, -75}, {75, 300, 75}};

static const char *write_faders(void)
{
    static char path[] = BUILD_DIR "/out/panel_patch_faders.csv";
    (void)mkdir(BUILD_DIR "/out", 0777);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("time_s,cc.0,cc.1,lefty\nunit,0..1,0..1,-1..1\n0,0,0,0\n60,0,0,0\n", file);
    assert_int_equal(fclose(file), 0);
    return path;
}

static void fader(stand *s, uint32_t channel, float value)
{
    s->sample[0].count = 3;
    s->sample[0].value[channel] = value;
    s->has_sample[0] = true;
    stand_settle(s);
}

static void open_with(stand *s, float scale)
{
    char text[600];
    stand_open(s, &panel_patch, scale);
    stand_plugin(s, "plugins/log");
    stand_plugin(s, "plugins/one_hand");
    stand_face(s, &about);
    stand_mapping(s, "one_hand");
    (void)snprintf(text, sizeof text, "log:%s", write_faders());
    stand_input(s, text);
    fader(s, 0, 0.0f);
}

static void with_nothing_it_says_what_it_is_for(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, 1.0f);
    assert_true(stand_shows(&s, "Connect faders, sticks, tracked shapes"));
    stand_check_words(&s, NULL);
    stand_picture(&s, "panel_patch_none");
    stand_close(&s);
}

static void a_fader_is_moved_and_a_dot_is_clicked(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, 1.0f);
    stand_click(&s, "Learn");
    assert_true(s.aim.is_learning);
    assert_true(s.looks.shows_contacts);
    assert_true(stand_shows(&s, "Move one fader"));
    s.stroke = (viewport_stroke){.is_pressed = true, .contact = 2};
    stand_settle(&s); /* too early: nothing was moved */
    assert_int_equal(s.patch.count, 0);
    s.stroke = (viewport_stroke){.contact = 0};
    fader(&s, 1, 0.1f); /* noise */
    assert_true(stand_shows(&s, "Move one fader"));
    fader(&s, 1, 0.6f);
    assert_true(stand_shows(&s, "cc.1. Now click its target"));
    stand_picture(&s, "panel_patch_learn");
    s.stroke = (viewport_stroke){.is_pressed = true, .contact = 2};
    stand_frame(&s);
    s.stroke = (viewport_stroke){.contact = 0};
    stand_settle(&s);
    assert_false(s.aim.is_learning);
    assert_false(s.looks.shows_contacts);
    assert_int_equal(s.patch.count, 1);
    const patch_connection *c = &s.patch.connection[0];
    assert_int_equal(c->kind, PATCH_CONTACT);
    assert_string_equal(c->target, "mouth.corner.r");
    assert_string_equal(c->channel, "cc.1");
    assert_string_equal(c->input, "log");
    assert_int_equal(s.step_count, 1);
    (void)s.step[0].set(s.step[0].owner, s.step[0].before);
    assert_int_equal(s.patch.count, 0);
    (void)s.step[0].set(s.step[0].owner, s.step[0].after);
    assert_int_equal(s.patch.count, 1);
    stand_close(&s);
}

static void a_slider_elsewhere_can_be_pointed_at(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, 1.0f);
    stand_click(&s, "Learn");
    fader(&s, 0, 0.9f);
    s.aim.kind = PATCH_PARAM; /* as the mapping panel does */
    (void)snprintf(s.aim.target, sizeof s.aim.target, "smile");
    stand_settle(&s);
    assert_int_equal(s.patch.count, 1);
    assert_int_equal(s.patch.connection[0].kind, PATCH_PARAM);
    assert_string_equal(s.patch.connection[0].target, "smile");
    stand_close(&s);
}

static void a_list_is_readable_and_a_connection_can_be_changed_and_deleted(void **state)
{
    (void)state;
    static const float scales[] = {1.0f, 2.0f};
    for (int i = 0; i < 2; ++i) {
        stand s = {.input_count = 0};
        open_with(&s, scales[i]);
        s.patch.count = 3;
        s.patch.connection[0] = patch_connection_of(PATCH_DOF);
        s.patch.connection[1] = patch_connection_of(PATCH_CONTACT);
        s.patch.connection[2] = patch_connection_of(PATCH_ACTION);
        static const char *const channels[] = {"cc.0", "lefty", "button.a"};
        static const char *const targets[] = {"jaw.open", "mouth.corner.*", "record"};
        for (int k = 0; k < 3; ++k) {
            (void)snprintf(s.patch.connection[k].channel, PATCH_NAME, "%s", channels[k]);
            (void)snprintf(s.patch.connection[k].target, PATCH_NAME, "%s", targets[k]);
        }
        s.patch.connection[0].bend = 0.4;
        s.status.patch_speaks = 1;
        fader(&s, 0, 0.7f);
        assert_true(stand_shows(&s, "cc.0 \xe2\x86\x92 jaw.open"));
        stand_check_words(&s, NULL);
        stand_picture(&s, i == 0 ? "panel_patch" : "panel_patch_2x");
        const ui_word *row = stand_word(&s, "cc.0 \xe2\x86\x92 jaw.open");
        assert_non_null(row);
        stand_click_at(&s, row->where.x + 20.0f, row->where.y + 6.0f);
        assert_true(stand_shows(&s, "Input"));
        assert_true(stand_shows(&s, "28.6 \xc2\xb0")); /* of 0.5 rad */
        assert_false(stand_shows(&s, " rad"));
        stand_picture(&s, i == 0 ? "panel_patch_chosen" : "panel_patch_chosen_2x");
        stand_click(&s, "Pick up");
        assert_true(s.patch.connection[0].picks_up);
        assert_int_equal(s.step_count, 1);
        stand_click(&s, "Delete");
        assert_int_equal(s.patch.count, 2);
        assert_string_equal(s.patch.connection[0].target, "mouth.corner.*");
        (void)s.step[1].set(s.step[1].owner, s.step[1].before);
        assert_int_equal(s.patch.count, 3);
        stand_close(&s);
    }
}

static void while_a_take_is_recorded_nothing_is_changed(void **state)
{
    (void)state;
    stand s = {.input_count = 0};
    open_with(&s, 1.0f);
    s.status.is_recording = true;
    stand_settle(&s);
    assert_true(stand_shows(&s, "End the take to change the patch"));
    stand_click(&s, "Learn");
    assert_false(s.aim.is_learning);
    stand_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(with_nothing_it_says_what_it_is_for),
        cmocka_unit_test(a_fader_is_moved_and_a_dot_is_clicked),
        cmocka_unit_test(a_slider_elsewhere_can_be_pointed_at),
        cmocka_unit_test(a_list_is_readable_and_a_connection_can_be_changed_and_deleted),
        cmocka_unit_test(while_a_take_is_recorded_nothing_is_changed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
