/* A device that takes long to open: the window goes on meanwhile, says what it opens, and lets go
 * of it when it is told to. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "scene.h"

#define FLAKY BUILD_DIR "/tests/plugin/flaky.so"
static const char slow[] = FLAKY ":port:1-2,first=0.7", endless[] = FLAKY ":port:1-3,first=90";

static uint32_t input_count(const scene *s)
{
    return live_input_count(app_live(s->app));
}

static uint32_t opening_count(const scene *s)
{
    input_opening going[INPUT_OPENINGS_MAX];
    return app_openings(s->app, going);
}

static bool has_input(scene *s, void *data)
{
    (void)data;
    return input_count(s) == 1;
}

static bool runs(scene *s, void *data)
{
    (void)data;
    return scene_word(s, "running") != NULL;
}

static bool is_recorded(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording && app_status(s->app)->recorded_ns > 100 * NS_PER_MS;
}

static bool waits_for_the_take(scene *s, void *data)
{
    (void)data;
    return scene_word_with(s, "used after the current take ends") != NULL;
}

static void open_scene(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    scene_open(s, width_px, height_px, scale);
    scene_let_cut(s, "flaky");
    scene_do(s, ACTION_PANEL_DEVICES);
}

static void the_window_goes_on_while_a_device_is_opened(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    assert_int_equal(app_open_input(s.app, slow), MRT_OK);
    scene_frame(&s);
    assert_int_equal(opening_count(&s), 1);
    assert_int_equal(input_count(&s), 0);
    assert_non_null(scene_word_with(&s, "opening"));
    scene_look(&s, "slow_device_opens");
    scene_check_words(&s);
    assert_true(scene_until(&s, has_input, NULL));
    assert_true(scene_until(&s, runs, NULL));
    assert_int_equal(opening_count(&s), 0);
    scene_close(&s);
}

static void cancel_lets_go_of_it_at_once(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 2560, 1440, 2.0f);
    assert_int_equal(app_open_input(s.app, endless), MRT_OK);
    scene_frames(&s, 2);
    scene_look(&s, "slow_device_opens_2x");
    scene_check_words(&s);
    scene_click_word(&s, "Cancel");
    assert_int_equal(opening_count(&s), 0);
    assert_null(scene_word_with(&s, "opening"));
    assert_int_equal(app_open_input(s.app, slow), MRT_OK); /* another one, beside it */
    assert_true(scene_until(&s, has_input, NULL));
    scene_frames(&s, 3);
    /* kept by its id: what is stored never names a library */
    assert_string_equal(live_input_text(app_live(s.app), 0),
                        "org.example.flaky:port:1-2,first=0.7");
    assert_string_equal(app_opening_trouble(s.app), "");
    scene_close(&s);
}

static void closing_the_window_does_not_wait_for_it(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    assert_int_equal(app_open_input(s.app, endless), MRT_OK);
    scene_frames(&s, 2);
    const int64_t from_ns = clock_now_ns();
    scene_close(&s);
    assert_true(clock_now_ns() - from_ns < 60 * NS_PER_S); /* of the 90 s that it would take */
}

static bool has_trouble(scene *s, void *data)
{
    (void)data;
    return app_opening_trouble(s->app)[0] != '\0';
}

static void what_cannot_be_opened_is_said_in_the_panel(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    assert_int_equal(app_open_input(s.app, FLAKY ":port:1-2,fail=1"), MRT_OK);
    assert_true(scene_until(&s, has_trouble, NULL));
    assert_non_null(strstr(app_opening_trouble(s.app), "plug it in"));
    assert_int_equal(app_open_input(s.app, "no_such_plugin"), MRT_OK);
    assert_string_equal(app_opening_trouble(s.app), "");
    assert_true(scene_until(&s, has_trouble, NULL));
    assert_non_null(strstr(app_opening_trouble(s.app), "no_such_plugin"));
    assert_int_equal(input_count(&s), 0);
    scene_close(&s);
}

static void what_opens_during_a_take_joins_behind_it(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recorded, NULL));
    assert_int_equal(app_open_input(s.app, slow), MRT_OK);
    assert_true(scene_until(&s, waits_for_the_take, NULL));
    assert_int_equal(input_count(&s), 0);
    scene_look(&s, "slow_device_waits");
    scene_check_words(&s);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, has_input, NULL));
    scene_close(&s);
}

static void more_than_can_be_opened_at_a_time_are_refused(void **state)
{
    scene s;
    (void)state;
    open_scene(&s, 1280, 720, 1.0f);
    for (int i = 0; i < INPUT_OPENINGS_MAX; ++i)
        assert_int_equal(app_open_input(s.app, endless), MRT_OK);
    assert_true(app_open_input(s.app, endless) < 0);
    assert_non_null(strstr(app_opening_trouble(s.app), "wait for one of them"));
    scene_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_window_goes_on_while_a_device_is_opened),
        cmocka_unit_test(cancel_lets_go_of_it_at_once),
        cmocka_unit_test(closing_the_window_does_not_wait_for_it),
        cmocka_unit_test(what_cannot_be_opened_is_said_in_the_panel),
        cmocka_unit_test(what_opens_during_a_take_joins_behind_it),
        cmocka_unit_test(more_than_can_be_opened_at_a_time_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
