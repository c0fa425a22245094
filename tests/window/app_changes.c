/* What is opened, ended and closed in the middle of something else: nothing of it is lost. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>

#include <cmocka.h>

#include "base/clock.h"
#include "take/sound_help.h"
#include "window/app/app.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MANY = 8 };
static const int64_t patience_ns = 600 * NS_PER_S;

typedef struct room {
    char folder[64], show[96], other[96];
    app *app;
    int64_t take;
    fake_host host; /* its microphone, once it is there */
    sound_backend backend;
} room;

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";

static void open_room(room *r, uint32_t input_count)
{
    const char *inputs[MANY];
    error err = {0};
    for (uint32_t i = 0; i < MANY; ++i)
        inputs[i] = demo;
    const app_options with = {.show_path = r->show,
                              .face_path = SOURCE_DIR "/rigs/puppet/puppet.rig.json",
                              .mapping = "one_hand",
                              .settings_path = "",
                              .sound = r->backend.open ? &r->backend : NULL,
                              .inputs = inputs,
                              .input_count = input_count};
    if (app_create(&r->app, &with, &err) < 0)
        fail_msg("%s", err.text);
}

static void make_room(room *r, uint32_t input_count)
{
    (void)unsetenv("MAROTTE_PLUGIN_PATH"); /* they lie beside the test, as beside the program */
    (void)snprintf(r->folder, sizeof r->folder, "/tmp/marotte_studio_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    (void)setenv("XDG_DATA_HOME", r->folder, 1);
    (void)snprintf(r->show, sizeof r->show, "%s/night.marotte", r->folder);
    (void)snprintf(r->other, sizeof r->other, "%s/other.marotte", r->folder);
    open_room(r, input_count);
}

static void close_room(room *r)
{
    char command[96];
    app_destroy(r->app);
    (void)snprintf(command, sizeof command, "rm -rf %s", r->folder);
    assert_int_equal(system(command), 0);
}

static void plug_in_a_microphone(room *r)
{
    r->host.device[SOUND_IN] =
        (fake_device){.is_there = true,
                      .rate_hz = 48000,
                      .channel_count = 1,
                      .clock = {.start_ns = clock_now_ns(), .rate_hz = 48000}};
    r->backend = fake_backend(&r->host);
}

static void speak(room *r)
{
    fake_device *in = &r->host.device[SOUND_IN];
    while (r->backend.open && fake_told_ns(&in->clock, in->frame) < clock_now_ns())
        fake_run(in, SOUND_IN);
}

typedef bool condition(room *r);
static void until(room *r, condition *holds)
{
    const int64_t end_ns = clock_now_ns() + patience_ns;
    do {
        speak(r);
        app_update(r->app, 0.005);
        if (holds(r))
            return;
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    } while (clock_now_ns() < end_ns);
    fail_msg("it did not come about in %d s", (int)(patience_ns / NS_PER_S));
}

static bool has_samples(room *r)
{
    return app_status(r->app)->sample_count > 100;
}

static bool is_recorded(room *r)
{
    const live_status *now = app_status(r->app);
    return now->is_recording && now->recorded_ns > 300 * NS_PER_MS;
}

static bool is_chosen(room *r)
{
    r->take = app_take_id(r->app);
    return !app_status(r->app)->is_recording && r->take != 0;
}

static bool is_shown(room *r)
{
    return app_view(r->app)->mode == LIVE_SHOWS;
}

static bool is_performed_over(room *r)
{
    const live_view *seen = app_view(r->app);
    return seen->mode == LIVE_OVERDUBS && seen->is_recording_over && seen->at_ns > 200 * NS_PER_MS;
}

static bool has_one_input(room *r)
{
    return live_input_count(app_live(r->app)) == 1;
}

static bool was_said(room *r, const char *part)
{
    const news_list *news = app_news(r->app);
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strstr(news_list_at(news, i)->text, part))
            return true;
    return false;
}

static bool is_refused(room *r)
{
    return was_said(r, "inputs is reached");
}

static void perform_over_a_take(room *r)
{
    until(r, has_samples);
    app_do(r->app, ACTION_RECORD);
    until(r, is_recorded);
    app_do(r->app, ACTION_RECORD);
    until(r, is_chosen);
    assert_int_equal(app_choose_take(r->app, r->take), MRT_OK);
    until(r, is_shown);
    assert_int_equal(app_take(r->app)->layer_count, 1);
    app_do(r->app, ACTION_RECORD);
    until(r, is_performed_over);
}

static void the_take_has_another_layer(room *r)
{
    assert_int_equal(app_choose_take(r->app, r->take), MRT_OK);
    assert_int_equal(app_take(r->app)->layer_count, 2);
}

static void another_show_opened_while_performing_over_keeps_the_layer(void **state)
{
    const app_take_line *line;
    room r = {0};
    (void)state;
    make_room(&r, 1);
    perform_over_a_take(&r);
    assert_int_equal(app_open_show(r.app, r.other), MRT_OK);
    app_update(r.app, 0.01);
    assert_int_equal(app_takes(r.app, &line), 0);
    assert_false(app_status(r.app)->is_recording);
    assert_int_equal(app_open_show(r.app, r.show), MRT_OK);
    the_take_has_another_layer(&r);
    close_room(&r);
}

static void closing_while_performing_over_keeps_the_layer(void **state)
{
    room r = {0};
    (void)state;
    make_room(&r, 1);
    perform_over_a_take(&r);
    app_destroy(r.app);
    open_room(&r, 0);
    the_take_has_another_layer(&r);
    close_room(&r);
}

static void more_inputs_than_are_possible_are_said(void **state)
{
    room r = {0};
    (void)state;
    make_room(&r, MANY);
    until(&r, is_refused);
    assert_int_equal(live_input_count(app_live(r.app)), MANY - 1);
    close_room(&r);
}

/* Devices open slowly; somebody may record before. */
static void an_input_that_opens_during_a_take_joins_behind_it(void **state)
{
    room r = {0};
    (void)state;
    make_room(&r, 1);
    app_do(r.app, ACTION_RECORD);
    until(&r, is_recorded);
    app_do(r.app, ACTION_RECORD);
    until(&r, has_one_input);
    assert_false(was_said(&r, "stop it first"));
    close_room(&r);
}

static bool listens(room *r)
{
    return app_status(r->app)->is_sound_armed;
}

static bool has_its_sound(room *r)
{
    const take *t = app_take(r->app);
    return t && t->audio.audio != 0;
}

/* It is written after the take has ended, and chosen. */
static void the_sound_of_a_take_is_in_it_when_it_came(void **state)
{
    room r = {0};
    (void)state;
    plug_in_a_microphone(&r);
    make_room(&r, 1);
    until(&r, has_samples);
    app_do(r.app, ACTION_SOUND_ARM);
    until(&r, listens);
    app_do(r.app, ACTION_RECORD);
    until(&r, is_recorded);
    app_do(r.app, ACTION_RECORD);
    until(&r, is_chosen);
    until(&r, has_its_sound);
    assert_int_equal(app_take_id(r.app), r.take);
    close_room(&r);
}

static mrt_result open_no_microphone(void *self, sound_direction direction,
                                     const sound_request *request, sound_callback *block,
                                     void *data, sound_stream *out, error *err)
{
    (void)self, (void)direction, (void)request, (void)block, (void)data, (void)out;
    return error_set(err, MRT_ERR_IO, "sound: there is no microphone");
}

static bool was_told_of_none(room *r)
{
    return was_said(r, "there is no microphone");
}

static bool listens_no_more(room *r)
{
    return !app_status(r->app)->is_sound_armed;
}

static void a_microphone_that_is_not_there_is_not_armed(void **state)
{
    room r = {0};
    (void)state;
    plug_in_a_microphone(&r);
    r.backend.open = open_no_microphone;
    make_room(&r, 1);
    until(&r, has_samples);
    app_do(r.app, ACTION_SOUND_ARM);
    until(&r, was_told_of_none);
    until(&r, listens_no_more);
    close_room(&r);
}

static uint32_t outputs_now(const room *r)
{
    return outputs_count(live_outputs(app_live(r->app)));
}

static void an_output_is_added_and_closed_by_one_step_of_undo_each(void **state)
{
    room r = {0};
    output_status now;
    (void)state;
    make_room(&r, 0);
    assert_int_equal(app_add_output(r.app, "vmc:127.0.0.1:39547"), MRT_OK);
    assert_int_equal(app_add_output(r.app, "vmc:127.0.0.1:39548"), MRT_OK);
    assert_non_null(strstr(app_undo_words(r.app), "add output"));
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(outputs_now(&r), 1);
    app_do(r.app, ACTION_REDO);
    assert_int_equal(outputs_now(&r), 2);
    app_remove_output(r.app, 0);
    assert_non_null(strstr(app_undo_words(r.app), "remove output"));
    outputs_status(live_outputs(app_live(r.app)), 0, &now);
    assert_non_null(strstr(now.text, "39548"));
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(outputs_now(&r), 2);
    outputs_status(live_outputs(app_live(r.app)), 1, &now);
    assert_non_null(strstr(now.text, "39547"));
    app_do(r.app, ACTION_UNDO);
    app_do(r.app, ACTION_UNDO);
    assert_int_equal(outputs_now(&r), 0);
    close_room(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_show_opened_while_performing_over_keeps_the_layer),
        cmocka_unit_test(closing_while_performing_over_keeps_the_layer),
        cmocka_unit_test(more_inputs_than_are_possible_are_said),
        cmocka_unit_test(an_input_that_opens_during_a_take_joins_behind_it),
        cmocka_unit_test(a_microphone_that_is_not_there_is_not_armed),
        cmocka_unit_test(an_output_is_added_and_closed_by_one_step_of_undo_each),
        cmocka_unit_test(the_sound_of_a_take_is_in_it_when_it_came),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
