/* The keyboard and the gamepad as a hand, in the whole window. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

static uint32_t input_count(const scene *s)
{
    return live_input_count(app_live(s->app));
}

static bool has_hand(scene *s, void *data)
{
    (void)data;
    return input_count(s) == 1 && app_view(s->app)->hand[MRT_RIGHT].present;
}

static bool is_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_status(s->app)->recorded_ns > 100 * NS_PER_MS;
}

static bool has_moved(scene *s, void *data)
{
    const float *rest = data;
    const live_view *view = app_view(s->app);
    for (size_t i = 0; i < (size_t)view->vertex_count * 3; ++i)
        if (fabsf(view->position[i] - rest[i]) > 3.0f)
            return true;
    return false;
}

static void a_gamepad_is_a_hand_that_moves_the_face(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    const live_view *view = app_view(s.app);
    const size_t size = (size_t)view->vertex_count * 3 * sizeof *view->position;
    float *rest = malloc(size);
    assert_non_null(rest);
    memcpy(rest, view->position, size);
    window_gamepad pad = {.axis = {0.0f, 0.9f}, .name = "a pad"};
    window_hidden_gamepad(s.window, &pad);
    assert_true(scene_until(&s, has_hand, NULL));
    for (int i = 0; i < 6; ++i)
        pad.axis[i] = 0.9f;
    window_hidden_gamepad(s.window, &pad);
    assert_true(scene_until(&s, has_moved, rest));
    scene_look(&s, "hand_keys_gamepad");
    window_hidden_gamepad(s.window, NULL);
    scene_frames(&s, 3);
    free(rest);
    scene_close(&s);
}

static uint32_t times_said(const scene *s, const char *part)
{
    const news_list *news = app_news(s->app);
    uint32_t count = 0;
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        count += strstr(news_list_at(news, i)->text, part) != NULL;
    return count;
}

static void a_hand_that_comes_during_a_take_is_refused_once_and_joins_behind_it(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recorded, NULL));
    scene_do(&s, ACTION_HAND_KEYS);
    scene_frames(&s, 20);
    assert_int_equal(times_said(&s, "stop it first"), 1);
    assert_int_equal(input_count(&s), 0);
    app_do(s.app, ACTION_RECORD);
    assert_true(scene_until(&s, has_hand, NULL));
    scene_close(&s);
}

/* ---- the strip of keys ---- */

static uint32_t ground_of(scene *s, const char *text)
{
    const ui_word *word = scene_word(s, text);
    if (!word)
        fail_msg("\"%s\" is not on the screen", text);
    return word ? word->ground : 0;
}

static bool shows_effects(scene *s, void *data)
{
    (void)data;
    return scene_word_with(s, "jaw opens") != NULL;
}

static void each_key_says_what_it_moves_and_is_lit_while_it_is_pressed(void **state)
{
    static const struct {
        uint32_t key;
        const char *cap;
    } of[] = {{'J', "J"},
              {'N', "N"},
              {'M', "M"},
              {' ', "Space"},
              {'P', "P"},
              {UI_KEY_UP, "\u2191"},
              {UI_KEY_RIGHT, "\u2192"}};
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_HAND_KEYS);
    assert_true(scene_until(&s, has_hand, NULL));
    assert_true(scene_until(&s, shows_effects, NULL));
    assert_non_null(scene_word_with(&s, "brows up"));
    assert_non_null(scene_word_with(&s, "head nods"));
    scene_check_words(&s);
    for (size_t i = 0; i < sizeof of / sizeof *of; ++i) {
        const uint32_t dark = ground_of(&s, of[i].cap);
        scene_hold_key(&s, of[i].key, true);
        scene_settle(&s);
        assert_int_not_equal(ground_of(&s, of[i].cap), dark);
        scene_look(&s, "hand_keys_strip");
        scene_hold_key(&s, of[i].key, false);
        scene_settle(&s);
        assert_int_equal(ground_of(&s, of[i].cap), dark);
    }
    scene_close(&s);
}

/* The picture begins below the strip. */
static void the_strip_does_not_cover_the_face(void **state)
{
    static const uint32_t size[2][2] = {{1280, 720}, {800, 500}};
    (void)state;
    for (int i = 0; i < 2; ++i) {
        scene s;
        scene_open(&s, size[i][0], size[i][1], 1.0f);
        const ui_word *before = scene_word(&s, "Mirrored");
        assert_non_null(before);
        const float y = before->where.y;
        scene_do(&s, ACTION_HAND_KEYS);
        assert_true(scene_until(&s, has_hand, NULL));
        scene_settle(&s);
        const ui_word *after = scene_word(&s, "Mirrored"), *esc = scene_word(&s, "Esc");
        assert_true(after && esc);
        assert_true(after->where.y > y + 30.0f);
        assert_true(esc->where.y + esc->where.height < after->where.y);
        scene_look(&s, i ? "hand_keys_small" : "hand_keys");
        scene_check_words(&s);
        scene_close(&s);
    }
}

static void a_key_of_the_hand_is_learned_by_the_patch(void **state)
{
    scene s;
    (void)state;
    scene_open(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_HAND_KEYS);
    assert_true(scene_until(&s, has_hand, NULL));
    scene_do(&s, ACTION_PANEL_PATCH);
    scene_frames(&s, 90); /* the hand has joined */
    scene_click_word(&s, "Learn");
    assert_non_null(scene_word_with(&s, "Move one fader"));
    scene_hold_key(&s, 'J', true);
    scene_frames(&s, 60);
    scene_hold_key(&s, 'J', false);
    scene_settle(&s);
    assert_non_null(scene_word_with(&s, "index"));
    assert_non_null(scene_word_with(&s, "Now click its target"));
    scene_look(&s, "hand_keys_learn");
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gamepad_is_a_hand_that_moves_the_face),
        cmocka_unit_test(a_hand_that_comes_during_a_take_is_refused_once_and_joins_behind_it),
        cmocka_unit_test(each_key_says_what_it_moves_and_is_lit_while_it_is_pressed),
        cmocka_unit_test(the_strip_does_not_cover_the_face),
        cmocka_unit_test(a_key_of_the_hand_is_learned_by_the_patch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
