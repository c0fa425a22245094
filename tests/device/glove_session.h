/* device/glove_session.h - a test's session with an emulated glove: the emulator, the plugin
 * cyberglove as loaded from the build, and what it has read. Both live on the test's thread by the
 * virtual clock, so that no test waits and each run is the same. Fails the test where something is
 * not as asked; skips it where there are no pseudo terminals. Included by tests after cmocka.h. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_SESSION_H
#define MAROTTE_TESTS_DEVICE_GLOVE_SESSION_H
#include "base/clock.h"
#include "glove_child.h"
#include "glove_motion.h"
#include "glove_options.h"
#include "glove_truth.h"
#include "stage/mapping/instance.h"
#include "stage/mapping/plugins.h"
#include "virtual_clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLOVE_PLUGIN BUILD_DIR "/plugins/cyberglove.so"
/* An emulator's options as a list. */
#define OPTIONS(...) ((const char *const[]){__VA_ARGS__, NULL})

enum { SESSION_SAMPLES = 4096 };

typedef struct glove_session {
    glove_child place; /* a folder alone: nothing runs in it */
    glove_settings settings;
    glove_emulator *emulator;
    virtual_device device;
    plugin_list plugins;
    const mrt_plugin_type *type;
    log_queue *log;
    instance plugin;
    const mrt_input *functions;
    mrt_channel channel[MRT_MAX_CHANNELS]; /* outlive the input, but their names do not */
    uint32_t channel_count;
    mrt_sample *sample; /* SESSION_SAMPLES: those that were taken */
    uint32_t count;
} glove_session;

static inline void session_say_log(glove_session *s)
{
    log_record record;
    while (log_pop(s->log, &record))
        print_message("  [%d] %s: %s\n", (int)record.level, record.source, record.text);
}

/* ---- the emulator, as the virtual clock calls it ---- */

static inline int64_t session_due_ns(void *data)
{
    return glove_emulator_due_ns(((glove_session *)data)->emulator);
}

static inline void session_run(void *data, int64_t now_ns)
{
    error err = {""};
    if (glove_emulator_live(((glove_session *)data)->emulator, now_ns, &err) < 0)
        fail_msg("%s", err.text);
}

static inline void session_written(void *data, int64_t now_ns, int file, size_t size)
{
    glove_emulator_written(((glove_session *)data)->emulator, now_ns, file, size);
}

/* The plugin's host waits as the system does: by the virtual clock. */
static inline int64_t session_wait_until_ns(const mrt_host *host, int64_t time_ns)
{
    (void)host;
    clock_sleep_until_ns(time_ns);
    return clock_now_ns();
}

/* ---- a session ---- */

/* The emulator and the plugin, but no input yet. */
static inline void session_begin(glove_session *s, const char *const *options)
{
    error err = {""};
    *s = (glove_session){.settings = glove_settings_default()};
    s->device = (virtual_device){session_due_ns, session_run, session_written, s};
    virtual_clock_take(&s->device, 1000 * NS_PER_S);
    mrt_result result = glove_child_prepare(&s->place, &err);
    if (result >= 0)
        result = glove_options_read(options, &s->settings, &err);
    s->settings.line.link = s->place.link;
    s->settings.line.is_awaited = true;
    s->settings.truth = s->place.truth;
    if (result >= 0)
        result = glove_emulator_create(&s->emulator, &s->settings, &err);
    if (result == MRT_ERR_UNSUPPORTED) {
        glove_child_finish(&s->place);
        virtual_clock_give_back();
        print_message("SKIPPED: there are no pseudo terminals here\n");
        skip();
    }
    if (result < 0 || plugin_list_add(&s->plugins, GLOVE_PLUGIN, &err) < 0 ||
        plugin_list_find(&s->plugins, "cyberglove", MRT_INPUT, &s->type, &err) < 0)
        fail_msg("%s", err.text);
    s->functions = plugin_interface(s->type, MRT_INPUT);
    s->log = log_queue_create();
    s->sample = calloc(SESSION_SAMPLES, sizeof *s->sample);
    assert_non_null(s->log);
    assert_non_null(s->sample);
}

/* An instance that has opened the glove, with the plugin's error where it could not. */
static inline mrt_result session_open_instance(glove_session *s, instance *out, const char *params,
                                               error *err)
{
    mrt_result result = instance_create(out, s->type, CLOCK_REAL, s->log, err);
    if (result < 0)
        return result;
    out->host.wait_until_ns = session_wait_until_ns;
    result = instance_set_list(out, params, err);
    if (result < 0)
        return result;
    instance_latch(out);
    instance_listen(out, err, NULL);
    result = s->functions->open(out->self, s->place.address, out->params);
    instance_listen_end(out);
    return result;
}

static inline mrt_result session_try_open(glove_session *s, const char *params, error *err)
{
    mrt_result result = session_open_instance(s, &s->plugin, params, err);
    if (result < 0)
        return result;
    const mrt_channel *channel = s->functions->channels(s->plugin.self, &s->channel_count);
    memcpy(s->channel, channel, s->channel_count * sizeof *channel);
    return result;
}

static inline void session_open(glove_session *s, const char *params)
{
    error err = {""};
    if (session_try_open(s, params, &err) < 0) {
        session_say_log(s);
        fail_msg("%s", err.text);
    }
}

/* Takes samples until there are `count` in all, or time_s have passed, or the plugin says another
 * thing, which it returns. */
static inline mrt_result session_read(glove_session *s, uint32_t count, double time_s, error *err)
{
    int64_t end_ns = clock_now_ns() + (int64_t)(time_s * 1e9);
    mrt_result result = MRT_OK;
    assert_true(count <= SESSION_SAMPLES);
    instance_latch(&s->plugin);
    instance_listen(&s->plugin, err, NULL);
    while (s->count < count && result >= 0 && clock_now_ns() < end_ns) {
        result = s->functions->read(s->plugin.self, s->plugin.params,
                                    clock_now_ns() + 100 * NS_PER_MS, &s->sample[s->count]);
        s->count += result == MRT_OK;
    }
    instance_listen_end(&s->plugin);
    return result;
}

/* True: there are so many. */
static inline bool session_take(glove_session *s, uint32_t count, double time_s)
{
    error err = {""};
    if (session_read(s, count, time_s, &err) < 0)
        print_message("  %s\n", err.text);
    return s->count == count;
}

static inline void session_close(glove_session *s)
{
    instance_destroy(&s->plugin);
}

static inline void session_stop_emulator(glove_session *s)
{
    error err = {""};
    mrt_result result = glove_emulator_destroy(s->emulator, &err);
    s->emulator = NULL;
    virtual_clock_give_back();
    if (result < 0)
        fail_msg("%s", err.text);
}

static inline void session_end(glove_session *s)
{
    session_close(s);
    session_say_log(s);
    log_queue_destroy(s->log);
    plugin_list_destroy(&s->plugins);
    session_stop_emulator(s);
    glove_child_finish(&s->place);
    free(s->sample);
    *s = (glove_session){0};
}

/* The input is closed, the emulator ends, and says what was true. */
static inline void session_read_truth(glove_session *s, glove_truth *out)
{
    error err = {""};
    session_close(s);
    session_stop_emulator(s);
    if (glove_truth_read(out, s->place.truth, &err) < 0)
        fail_msg("%s", err.text);
}

/* Each sample against the record of its number: the same raw values, and the number is where the
 * sequence says. `gap_count`: how many the sequence says are missing between the first and the
 * last. */
static inline void session_check_values(const glove_session *s, const glove_truth *truth,
                                        uint32_t sensor_count, uint32_t *out_gap_count)
{
    static const uint32_t sent_18[] = {0,  1,  2,  3,  4,  5,  7,  8,  10,
                                       11, 12, 14, 15, 16, 18, 19, 20, 21};
    *out_gap_count = 0;
    for (uint32_t i = 0; i < s->count; ++i) {
        const mrt_sample *sample = &s->sample[i];
        int32_t number = glove_motion_number_in(s->channel, sample);
        const glove_truth_row *row = number < 0 ? NULL : glove_truth_find(truth, (uint32_t)number);
        if (!row)
            fail_msg("sample %u shows record %d, which was not sent", i, (int)number);
        assert_false(row->is_spoiled);
        for (uint32_t k = 0; k < sensor_count; ++k) {
            uint32_t semantic = MRT_CH_ANGLE + (sensor_count == 18 ? sent_18[k] : k);
            uint32_t c = 0;
            while (c < s->channel_count && s->channel[c].semantic != semantic)
                ++c;
            assert_true(c < s->channel_count);
            assert_int_equal((int)sample->value[c], row->record[1 + k]);
        }
        if (i == 0)
            continue;
        int32_t before = glove_motion_number_in(s->channel, sample - 1);
        uint32_t step = sample->sequence - sample[-1].sequence;
        assert_int_equal((int)step, number - before);
        *out_gap_count += step - 1;
    }
}

/* Sample times against the glove's own, ms, of the samples from `first` on. */
static inline glove_spread session_time_error(const glove_session *s, const glove_truth *truth,
                                              uint32_t first)
{
    double *error_ms = calloc(SESSION_SAMPLES, sizeof *error_ms);
    size_t count = 0;
    assert_non_null(error_ms);
    for (uint32_t i = first; i < s->count; ++i) {
        int32_t number = glove_motion_number_in(s->channel, &s->sample[i]);
        const glove_truth_row *row = glove_truth_find(truth, (uint32_t)number);
        assert_non_null(row);
        error_ms[count++] = (double)(s->sample[i].time_ns - row->sample_ns) * 1e-6;
    }
    glove_spread spread = glove_spread_of(error_ms, count);
    free(error_ms);
    return spread;
}

#endif
