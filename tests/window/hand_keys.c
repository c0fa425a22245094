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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gamepad_is_a_hand_that_moves_the_face),
        cmocka_unit_test(a_hand_that_comes_during_a_take_is_refused_once_and_joins_behind_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
