/* app_fixture.h - an application without a window: a fresh show in a folder of its own, the puppet,
 * no settings but those that are asked for; waits until something holds. Include after cmocka.h;
 * link marotte_window and depend on the plugins log, one_hand, anchored. */
#ifndef TESTS_WINDOW_APP_FIXTURE_H
#define TESTS_WINDOW_APP_FIXTURE_H
#include "base/clock.h"
#include "window/app/app.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATIENCE_S = 600 }; /* exports run at a low priority, beside whatever else runs */

typedef struct room {
    char folder[64], show[96], settings[96];
    app *app;
} room;

static const char demo[] = "log:" SOURCE_DIR "/plugins/log/demo_hand.csv,loop=1";
static const char *const demo_inputs[] = {demo}, *const no_inputs[] = {NULL};
static const char puppet[] = SOURCE_DIR "/rigs/puppet/puppet.rig.json";

static inline void make_room(room *r)
{
    (void)unsetenv("MAROTTE_PLUGIN_PATH"); /* they lie beside the test, as beside the program */
    (void)snprintf(r->folder, sizeof r->folder, "/tmp/marotte_studio_XXXXXX");
    assert_non_null(mkdtemp(r->folder));
    (void)setenv("XDG_DATA_HOME", r->folder, 1);
    (void)snprintf(r->show, sizeof r->show, "%s/night.marotte", r->folder);
    (void)snprintf(r->settings, sizeof r->settings, "%s/window.json", r->folder);
}

static inline mrt_result open_with(room *r, const app_options *with, error *err)
{
    app_options options = *with;
    if (!options.settings_path)
        options.settings_path = "";
    if (!options.inputs)
        options.inputs = no_inputs;
    return app_create(&r->app, &options, err);
}

static inline void open_room(room *r, bool has_hand)
{
    error err = {0};
    make_room(r);
    const app_options with = {.show_path = r->show,
                              .face_path = puppet,
                              .mapping = "one_hand",
                              .inputs = has_hand ? demo_inputs : NULL,
                              .input_count = has_hand ? 1 : 0};
    if (open_with(r, &with, &err) < 0)
        fail_msg("%s", err.text);
}

static inline void close_room(room *r)
{
    char command[96];
    app_destroy(r->app);
    (void)snprintf(command, sizeof command, "rm -rf %s", r->folder);
    assert_int_equal(system(command), 0);
}

typedef bool condition(app *of);
static inline bool until(room *r, condition *holds)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    do {
        app_update(r->app, 0.005);
        if (holds(r->app))
            return true;
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    } while (clock_now_ns() < end_ns);
    return false;
}

static inline bool has_samples(app *of)
{
    return app_status(of)->sample_count > 100;
}

static inline bool is_recording(app *of)
{
    return app_status(of)->is_recording;
}

static inline bool is_recorded(app *of)
{
    return app_status(of)->is_recording && app_status(of)->recorded_ns > 300 * NS_PER_MS;
}

static inline bool has_ended(app *of)
{
    return !app_status(of)->is_recording && app_take_id(of) != 0;
}

static inline bool shows_take(app *of)
{
    return app_view(of)->mode == LIVE_SHOWS;
}

static inline uint32_t count_takes(app *of)
{
    const app_take_line *line;
    return app_takes(of, &line);
}

static inline bool was_said(app *of, const char *part)
{
    const news_list *news = app_news(of);
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strstr(news_list_at(news, i)->text, part))
            return true;
    return false;
}

static inline void record_a_take(room *r)
{
    assert_true(until(r, has_samples));
    app_do(r->app, ACTION_RECORD);
    assert_true(until(r, is_recorded));
    app_do(r->app, ACTION_RECORD);
    assert_true(until(r, has_ended));
}

#endif
