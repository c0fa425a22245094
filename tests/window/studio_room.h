/* studio_room.h - a studio without a window: a fresh show in a folder of its own, the puppet, no
 * settings but those that are asked for; waits until something holds. Include after cmocka.h; link
 * marotte_window and depend on the plugins log, one_hand, anchored. */
#ifndef TESTS_WINDOW_STUDIO_ROOM_H
#define TESTS_WINDOW_STUDIO_ROOM_H
#include "base/clock.h"
#include "window/studio.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATIENCE_S = 30 };

typedef struct room {
    char folder[64], show[96], settings[96];
    studio *studio;
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

static inline mrt_result open_with(room *r, const studio_options *with, error *err)
{
    studio_options options = *with;
    if (!options.settings_path)
        options.settings_path = "";
    if (!options.inputs)
        options.inputs = no_inputs;
    return studio_create(&r->studio, &options, err);
}

static inline void open_room(room *r, bool has_hand)
{
    error err = {0};
    make_room(r);
    const studio_options with = {.show_path = r->show,
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
    studio_destroy(r->studio);
    (void)snprintf(command, sizeof command, "rm -rf %s", r->folder);
    assert_int_equal(system(command), 0);
}

typedef bool condition(studio *of);
static inline bool until(room *r, condition *holds)
{
    const int64_t end_ns = clock_now_ns() + PATIENCE_S * NS_PER_S;
    do {
        studio_update(r->studio, 0.005);
        if (holds(r->studio))
            return true;
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    } while (clock_now_ns() < end_ns);
    return false;
}

static inline bool has_samples(studio *of)
{
    return studio_status(of)->sample_count > 100;
}

static inline bool is_recording(studio *of)
{
    return studio_status(of)->is_recording;
}

static inline bool is_recorded(studio *of)
{
    return studio_status(of)->is_recording && studio_status(of)->recorded_ns > 300 * NS_PER_MS;
}

static inline bool has_ended(studio *of)
{
    return !studio_status(of)->is_recording && studio_take_id(of) != 0;
}

static inline bool shows_take(studio *of)
{
    return studio_view(of)->mode == LIVE_SHOWS;
}

static inline uint32_t count_takes(studio *of)
{
    const studio_take_line *line;
    return studio_takes(of, &line);
}

static inline bool was_said(studio *of, const char *part)
{
    const news_list *news = studio_news(of);
    for (uint32_t i = 0; i < news_list_count(news); ++i)
        if (strstr(news_list_at(news, i)->text, part))
            return true;
    return false;
}

static inline void record_a_take(room *r)
{
    assert_true(until(r, has_samples));
    studio_do(r->studio, ACTION_RECORD);
    assert_true(until(r, is_recorded));
    studio_do(r->studio, ACTION_RECORD);
    assert_true(until(r, has_ended));
}

#endif
