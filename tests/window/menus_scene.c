/* The menu of the window, the search for a command, and the keyboard's way through the controls, in
 * the real window. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "scene.h"

static double mapping_number(const scene *s, const char *key)
{
    const instance *mapping = live_mapping(app_live(s->app));
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        if (strcmp(mapping->type->params[i].name, key) == 0)
            return instance_value(mapping, i);
    fail_msg("no parameter %s", key);
    return 0.0;
}

static void a_key_opens_the_menu(void **state)
{
    scene s;
    char before[512];
    (void)state;
    scene_open(&s, 800, 500, 1.0f);
    (void)snprintf(before, sizeof before, "%s", show_path(app_show(s.app)));
    assert_null(scene_word(&s, "About marotte"));
    scene_key(&s, UI_KEY_F1 + 9, 0);
    assert_non_null(scene_word(&s, "New show"));
    assert_non_null(scene_word(&s, "Find a command"));
    scene_check_words(&s);
    scene_look(&s, "menu");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_null(scene_word(&s, "New show"));
    scene_key(&s, UI_KEY_F1 + 9, 0);
    scene_key(&s, UI_KEY_UP, 0); /* to the last one, Quit, then back to About */
    scene_key(&s, UI_KEY_UP, 0);
    assert_string_equal(ui_ringed(s.ui), "About marotte");
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_non_null(scene_word(&s, "marotte " MAROTTE_VERSION));
    scene_look(&s, "about");
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_string_equal(before, show_path(app_show(s.app)));
    scene_close(&s);
}

static void a_new_show_has_a_new_name(void **state)
{
    scene s;
    char home[96], first[512];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    (void)snprintf(home, sizeof home, "%s/documents", s.folder);
    assert_int_equal(mkdir(home, 0755), 0);
    setenv("XDG_DOCUMENTS_DIR", home, 1);
    scene_key(&s, 'N', UI_CONTROL);
    (void)snprintf(first, sizeof first, "%s", show_path(app_show(s.app)));
    assert_non_null(strstr(first, "/documents/marotte/"));
    scene_key(&s, 'N', UI_CONTROL);
    assert_string_not_equal(first, show_path(app_show(s.app)));
    assert_int_equal(access(first, F_OK), 0);
    scene_close(&s);
}

static void a_command_is_found_by_its_name(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 800, 500, 1.0f);
    const app_looks *looks = app_looks_of(s.app);
    const bool was_mirrored = looks->is_mirrored;
    scene_key(&s, 'P', UI_CONTROL | UI_SHIFT);
    scene_type(&s, "mirror face");
    assert_non_null(scene_word_with(&s, "View: Mirror"));
    scene_check_words(&s);
    scene_look(&s, "find_a_command");
    scene_key(&s, UI_KEY_ENTER, 0);
    assert_int_equal(looks->is_mirrored, !was_mirrored);
    assert_null(scene_word_with(&s, "View: Mirror"));

    scene_key(&s, 'P', UI_CONTROL | UI_SHIFT); /* what cannot be done says why */
    scene_type(&s, "split");
    assert_non_null(scene_word_with(&s, "Not now"));
    scene_key(&s, UI_KEY_ESCAPE, 0);

    scene_key(&s, 'P', UI_CONTROL | UI_SHIFT); /* the arrows choose */
    scene_type(&s, "view show");
    const bool had_hands = looks->shows_hands, had_vectors = looks->shows_vectors;
    while (!scene_word_with(&s, "View: Hands"))
        scene_key(&s, UI_KEY_DOWN, 0);
    scene_key(&s, UI_KEY_UP, 0);
    scene_key(&s, UI_KEY_DOWN, 0);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_int_equal(looks->shows_hands, had_hands);
    assert_int_equal(looks->shows_vectors, had_vectors);

    scene_key(&s, 'P', UI_CONTROL | UI_SHIFT);
    scene_type(&s, "nonsense of words");
    assert_non_null(scene_word(&s, "No command has these words."));
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_close(&s);
}

/* Presses Tab until the ring is around the control. */
static void tab_to(scene *s, const char *label)
{
    for (int i = 0; i < 200; ++i) {
        if (strstr(ui_ringed(s->ui), label) == ui_ringed(s->ui) && ui_ringed(s->ui)[0])
            return;
        scene_key(s, UI_KEY_TAB, 0);
        scene_frame(s);
    }
    fail_msg("Tab never comes to %s", label);
}

static void tab_goes_round_and_enter_presses(void **state)
{
    scene s;
    char first[128];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_PANEL_MAPPING);
    assert_string_equal(ui_ringed(s.ui), "");
    scene_key(&s, UI_KEY_TAB, 0);
    scene_frame(&s);
    (void)snprintf(first, sizeof first, "%s", ui_ringed(s.ui));
    assert_true(first[0] != '\0');
    scene_look(&s, "ring");
    scene_key(&s, UI_KEY_TAB, 0);
    scene_frame(&s);
    assert_string_not_equal(ui_ringed(s.ui), first);
    scene_key(&s, UI_KEY_TAB, UI_SHIFT);
    scene_frame(&s);
    assert_string_equal(ui_ringed(s.ui), first);

    tab_to(&s, "Keep the clay"); /* Space is the control's, not Play */
    scene_key(&s, ' ', 0);
    assert_true(live_keeps_clay(app_live(s.app)));

    tab_to(&s, "Hand##"); /* a drop-down: Enter opens, the arrows choose, Enter takes, Esc leaves */
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_frame(&s);
    scene_key(&s, UI_KEY_DOWN, 0);
    scene_frame(&s);
    scene_key(&s, UI_KEY_ENTER, 0);
    const double hand = mapping_number(&s, "Hand");
    assert_true(hand > 0.0);
    scene_key(&s, UI_KEY_ENTER, 0);
    scene_frame(&s);
    scene_key(&s, UI_KEY_DOWN, 0);
    scene_key(&s, UI_KEY_ESCAPE, 0);
    assert_true(mapping_number(&s, "Hand") == hand);

    tab_to(&s, "Size"); /* a slider */
    const double before = mapping_number(&s, "Size");
    scene_key(&s, UI_KEY_RIGHT, 0);
    assert_true(mapping_number(&s, "Size") > before);

    scene_key(&s, UI_KEY_ESCAPE, 0); /* the ring goes, and nothing else does */
    assert_string_equal(ui_ringed(s.ui), "");
    assert_true(app_looks_of(s.app)->layouts.now.current == APP_MAPPING);
    scene_close(&s);
}

static void hold(scene *s, uint32_t key, uint32_t frames)
{
    scene_hold_key(s, key, true);
    scene_frames(s, frames);
    scene_hold_key(s, key, false);
    scene_settle(s);
}

static void a_held_arrow_goes_on_and_is_one_step_of_undo(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_PANEL_MAPPING);
    tab_to(&s, "Size");
    const double before = mapping_number(&s, "Size");
    scene_key(&s, UI_KEY_RIGHT, 0);
    const double step = mapping_number(&s, "Size") - before;
    assert_true(step > 0.0);
    hold(&s, UI_KEY_RIGHT, 60);
    assert_true(mapping_number(&s, "Size") > before + 4.0 * step);
    scene_do(&s, ACTION_UNDO);
    assert_true(fabs(mapping_number(&s, "Size") - before - step) < 1e-6);
    scene_do(&s, ACTION_UNDO);
    assert_true(fabs(mapping_number(&s, "Size") - before) < 1e-6);
    scene_close(&s);
}

/* Held in this frame, for an action. */
static bool is_of_actions(scene *s, uint32_t key)
{
    scene_hold_key(s, key, true);
    scene_frame(s);
    const bool is_pressed = ui_pressed(s->ui, key, 0), is_down = ui_is_down(s->ui, key);
    assert_int_equal(is_pressed, is_down);
    scene_hold_key(s, key, false);
    scene_settle(s);
    return is_pressed;
}

static void keys_are_of_actions_again_when_the_control_is_gone(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_PANEL_MAPPING);
    tab_to(&s, "Size");
    assert_false(is_of_actions(&s, ' '));
    assert_false(is_of_actions(&s, UI_KEY_RIGHT));
    scene_do(&s, ACTION_PANEL_ENGINE); /* another panel covers it */
    assert_string_equal(ui_ringed(s.ui), "");
    assert_true(is_of_actions(&s, ' '));
    assert_true(is_of_actions(&s, UI_KEY_RIGHT));
    scene_close(&s);
}

static void tab_goes_on_from_where_one_clicked(void **state)
{
    scene s;
    char next[128];
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_PANEL_MAPPING);
    tab_to(&s, "Keep the clay");
    scene_key(&s, UI_KEY_TAB, 0);
    (void)snprintf(next, sizeof next, "%s", ui_ringed(s.ui));
    scene_key(&s, UI_KEY_ESCAPE, 0);
    scene_click_word(&s, "Keep the clay");
    assert_string_equal(ui_ringed(s.ui), "");
    scene_key(&s, UI_KEY_TAB, 0);
    assert_string_equal(ui_ringed(s.ui), next);
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_key_opens_the_menu),
        cmocka_unit_test(a_new_show_has_a_new_name),
        cmocka_unit_test(a_command_is_found_by_its_name),
        cmocka_unit_test(tab_goes_round_and_enter_presses),
        cmocka_unit_test(a_held_arrow_goes_on_and_is_one_step_of_undo),
        cmocka_unit_test(keys_are_of_actions_again_when_the_control_is_gone),
        cmocka_unit_test(tab_goes_on_from_where_one_clicked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
