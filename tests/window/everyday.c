/* Small things of a day of work, in the whole window: what a click opens, what stays until the
 * next start, what the check of a rig says, where a loop begins. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

static scene s;
static const char *const demo_hand[] = {"log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1"};

static void press_twice(float x, float y)
{
    scene_move(&s, x, y);
    scene_settle(&s);
    for (int i = 0; i < 2; ++i) {
        scene_button(&s, 0, true);
        scene_button(&s, 0, false);
    }
    scene_settle(&s);
}

/* The second half of a double click falls on what was behind the question. */
static void one_click_chooses_a_file_and_two_open_it_and_no_more(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_click_word(&s, "puppet");
    scene_click_word(&s, "../");
    scene_click_word(&s, "moai/");
    scene_click_word(&s, "moai.rig.json");
    assert_true(ui_has_dialog(s.ui));
    assert_non_null(strstr(app_face_path(s.app), "puppet.rig.json"));
    const ui_word *file = scene_word(&s, "moai.rig.json");
    assert_non_null(file);
    press_twice(file->where.x + 10.0f, file->where.y + 5.0f);
    assert_non_null(strstr(app_face_path(s.app), "moai.rig.json"));
    assert_int_equal(app_pull_count(s.app), 0);
    assert_false(app_is_held(s.app));
    scene_close(&s);
}

static bool says_held(scene *of, void *data)
{
    (void)data;
    return scene_word(of, "Held pulls. Press N to clear them") != NULL;
}

static bool says_nothing_held(scene *of, void *data)
{
    (void)data;
    return scene_word_with(of, "Held pulls") == NULL;
}

static void a_chip_says_that_something_is_held_until_neutral(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    assert_null(scene_word_with(&s, "Held pulls"));
    scene_modifiers(&s, UI_SHIFT, true);
    scene_drag(&s, 440.0f, 260.0f, 460.0f, 285.0f, 8);
    scene_modifiers(&s, UI_SHIFT, false);
    assert_true(scene_until(&s, says_held, NULL));
    assert_true(app_is_held(s.app));
    scene_do(&s, ACTION_NEUTRAL);
    assert_true(scene_until(&s, says_nothing_held, NULL));
    scene_do(&s, ACTION_UNDO);
    assert_true(scene_until(&s, says_held, NULL));
    scene_close(&s);
}

static bool has_judged(scene *of, void *data)
{
    (void)data;
    return scene_word(of, "Ready, no problems found.") || scene_word_with(of, "Ready, ");
}

static void the_check_of_the_puppet_says_one_thing(void **state)
{
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_PANEL_RIG);
    scene_frames(&s, 30);
    scene_click_word(&s, "Check");
    assert_true(scene_until(&s, has_judged, NULL));
    const bool has_findings = scene_word(&s, "Mesh") != NULL;
    assert_null(scene_word_with(&s, "was made for")); /* the shipped mesh is the rig's own */
    assert_true(!scene_word(&s, "Ready, no problems found.") == has_findings);
    scene_close(&s);
}

static double value_of(const char *name)
{
    const instance *mapping = live_mapping(app_live(s.app));
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].name, name) == 0)
            return instance_value(mapping, i);
    fail_msg("there is no %s", name);
    return 0.0;
}

static void a_parameter_is_what_it_was_at_the_next_start(void **state)
{
    char kept[128];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    (void)snprintf(kept, sizeof kept, "%s/window.json", s.folder);
    const scene_options with = {.settings_path = kept, .mapping = ""};
    scene_open_again(&s, &with);
    scene_do(&s, ACTION_PANEL_MAPPING);
    const double before = value_of("Jaw gain");
    scene_click_word(&s, "Find a parameter");
    scene_type(&s, "jaw gain");
    scene_key(&s, UI_KEY_ENTER, 0);
    const ui_word *label = scene_word(&s, "Jaw gain");
    assert_non_null(label);
    const float x = label->where.x + 160.0f, y = label->where.y + 6.0f;
    scene_drag(&s, x, y, x + 50.0f, y, 4);
    const double after = value_of("Jaw gain");
    assert_true(after != before);
    scene_open_again(&s, &with);
    assert_float_equal(value_of("Jaw gain"), after, 1e-9);
    scene_close(&s);
}

static bool has_recorded(scene *of, void *data)
{
    (void)data;
    return app_status(of->app)->recorded_ns > NS_PER_S;
}

static bool has_take(scene *of, void *data)
{
    (void)data;
    return app_take(of->app) && !app_status(of->app)->is_recording;
}

static bool is_shown(scene *of, void *data)
{
    (void)data;
    return app_view(of->app)->mode == LIVE_SHOWS;
}

static bool is_in_range(scene *of, void *data)
{
    const transport_position now = live_position(app_live(of->app));
    (void)data;
    assert_true(now.at_ns <= NS_PER_S / 2);
    return now.at_ns < 2 * NS_PER_S / 5;
}

static void a_loop_that_is_played_from_its_end_begins_at_its_start(void **state)
{
    (void)state;
    const scene_options with = {
        .width_px = 1280, .height_px = 720, .scale = 1.0f, .inputs = demo_hand, .input_count = 1};
    scene_open_with(&s, &with);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_recorded, NULL));
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_take, NULL));
    app_set_range(s.app, NS_PER_S / 5, NS_PER_S / 2);
    assert_true(scene_until(&s, is_shown, NULL));
    app_seek(s.app, NS_PER_S / 2);
    scene_do(&s, ACTION_PLAY);
    assert_true(live_transport(app_live(s.app))->is_playing);
    assert_true(scene_until(&s, is_in_range, NULL));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_click_chooses_a_file_and_two_open_it_and_no_more),
        cmocka_unit_test(a_chip_says_that_something_is_held_until_neutral),
        cmocka_unit_test(the_check_of_the_puppet_says_one_thing),
        cmocka_unit_test(a_parameter_is_what_it_was_at_the_next_start),
        cmocka_unit_test(a_loop_that_is_played_from_its_end_begins_at_its_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
