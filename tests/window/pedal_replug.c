/* A foot pedal that is pulled out while somebody performs in the window, and plugged in again: the
 * real plugin and the real libusb beside a double of the machine's USB (tests/device). */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "pedal_bench.h"
#include "scene.h"

#include <errno.h>

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";

static uint64_t samples_now(const scene *s)
{
    return app_status(s->app)->sample_count;
}

static bool has_both_inputs(scene *s, void *data)
{
    (void)data;
    return live_input_count(app_live(s->app)) == 2 && samples_now(s) > 30;
}

static bool is_held(scene *s, void *data)
{
    const float *wanted = data;
    return app_view(s->app)->pedal[0] == *wanted;
}

static bool has_performed_on(scene *s, void *data)
{
    const uint64_t *from = data;
    return samples_now(s) > *from + 60;
}

static bool shows_words(scene *s, void *data)
{
    return scene_word_with(s, data) != NULL;
}

static bool was_said(const scene *s, const char *part, int32_t *out_level)
{
    const news_list *news = app_news(s->app);
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strstr(news_list_at(news, i)->text, part)) {
            *out_level = news_list_at(news, i)->level;
            return true;
        }
    return false;
}

static void wait_for_pedal(scene *s, float value)
{
    if (!scene_until(s, is_held, &value))
        fail_msg("pedal 1 is %g, not %g", (double)app_view(s->app)->pedal[0], (double)value);
}

static void wait_for_words(scene *s, char *part)
{
    if (!scene_until(s, shows_words, part))
        fail_msg("\"%s\" is not on the screen", part);
}

static void perform_on(scene *s)
{
    uint64_t from = samples_now(s);
    assert_true(scene_until(s, has_performed_on, &from));
}

static void open_with_pedal(scene *s, uint32_t width_px, uint32_t height_px, float scale)
{
    static const char *const inputs[] = {demo, "pedal:usb:1-2"};
    const scene_options options = {.width_px = width_px,
                                   .height_px = height_px,
                                   .scale = scale,
                                   .inputs = inputs,
                                   .input_count = 2};
    scene_open_with(s, &options);
    scene_let_cut(s, "demo_hand");
    assert_true(scene_until(s, has_both_inputs, NULL));
    scene_do(s, ACTION_PANEL_DEVICES);
}

static void check_looks(scene *s, const char *name)
{
    scene_frames(s, 2);
    scene_look(s, name);
    scene_check_words(s);
}

static bool is_back(scene *s, void *data)
{
    int32_t level;
    (void)data;
    return was_said(s, "is back after", &level) && !scene_word_with(s, "disconnected for");
}

static void tell_all(scene *s)
{
    const news_list *news = app_news(s->app);
    const ui_word *words;
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        print_message("%s: %s\n", news_list_at(news, i)->source, news_list_at(news, i)->text);
    for (uint32_t i = 0; i < ui_words(s->ui, &words); ++i)
        print_message("\"%s\"\n", words[i].text);
    fail_msg("the pedal is not back");
}

/* Pressed, pulled out in that state, plugged in again, pressed. */
static void replug(scene *s, pedal_double *machine, pedal_unit *unit, const char *picture)
{
    char away[] = "disconnected for", name[64];
    int32_t level = -1;
    REPORT(unit, 1, 0);
    wait_for_pedal(s, 1.0f);
    pedal_unit_unplug(unit, EPROTO);
    wait_for_pedal(s, 0.0f);
    wait_for_words(s, away);
    (void)snprintf(name, sizeof name, "%s_away", picture);
    check_looks(s, name);
    assert_true(was_said(s, "was disconnected", &level));
    assert_int_equal(level, MRT_LOG_WARNING);
    perform_on(s);
    unit = pedal_double_plug(machine, "1-2", 3, &VEC);
    if (!scene_until(s, is_back, NULL))
        tell_all(s);
    (void)snprintf(name, sizeof name, "%s_back", picture);
    check_looks(s, name);
    REPORT(unit, 1, 0);
    wait_for_pedal(s, 1.0f);
    REPORT(unit, 0, 0);
    wait_for_pedal(s, 0.0f);
    perform_on(s);
}

static void a_pedal_that_is_pulled_out_is_up_and_works_when_it_is_back(void **state)
{
    scene s;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    open_with_pedal(&s, 1280, 720, 1.0f);
    replug(&s, *state, unit, "pedal_1x");
    scene_close(&s);
}

static bool is_recording(scene *s, void *data)
{
    (void)data;
    return app_status(s->app)->is_recording;
}

static bool is_chosen(scene *s, void *data)
{
    (void)data;
    return !app_status(s->app)->is_recording && app_take(s->app);
}

static void a_take_goes_on_while_a_pedal_is_away(void **state)
{
    scene s;
    pedal_unit *unit = pedal_double_plug(*state, "1-2", 2, &VEC);
    open_with_pedal(&s, 2560, 1440, 2.0f);
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_recording, NULL));
    replug(&s, *state, unit, "pedal_2x");
    assert_true(app_status(s.app)->is_recording);
    const int64_t recorded_ns = app_status(s.app)->recorded_ns;
    scene_do(&s, ACTION_RECORD);
    assert_true(scene_until(&s, is_chosen, NULL));
    assert_true(app_take(s.app)->duration_ns >= recorded_ns);
    scene_close(&s);
}

int main(int argc, char **argv)
{
    (void)argc;
    int left_out = pedal_double_enter(argv);
    if (left_out != 0)
        return left_out;
#define TEST(name) cmocka_unit_test_setup_teardown(name, bench_set_up, bench_tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_pedal_that_is_pulled_out_is_up_and_works_when_it_is_back),
        TEST(a_take_goes_on_while_a_pedal_is_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
