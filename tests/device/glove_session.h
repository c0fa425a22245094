/* device/glove_session.h - a test's session with an emulated glove: the emulator as a child, the
 * plugin cyberglove as loaded from the build, an input of the stage that reads it by a thread of
 * its own. Fails the test where something is not as asked; skips it where there are no pseudo
 * terminals. Included by tests after cmocka.h. */
#ifndef MAROTTE_TESTS_DEVICE_GLOVE_SESSION_H
#define MAROTTE_TESTS_DEVICE_GLOVE_SESSION_H
#include "base/clock.h"
#include "glove_child.h"
#include "glove_motion.h"
#include "glove_truth.h"
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GLOVE_EMULATOR BUILD_DIR "/tests/device/glove_emulator"
#define GLOVE_PLUGIN   BUILD_DIR "/plugins/cyberglove.so"
/* An emulator's options as a list. */
#define OPTIONS(...) ((const char *const[]){__VA_ARGS__, NULL})

enum { SESSION_SAMPLES = 4096 };

typedef struct glove_session {
    glove_child child;
    plugin_list plugins;
    const mrt_plugin_type *type;
    log_queue *log;
    input *input;
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

/* The emulator and the plugin, but no input yet. */
static inline void session_begin(glove_session *s, const char *const *options)
{
    error err = {""};
    *s = (glove_session){0};
    mrt_result result = glove_child_start(&s->child, GLOVE_EMULATOR, options, &err);
    if (result == MRT_ERR_UNSUPPORTED) {
        print_message("SKIPPED: there are no pseudo terminals here\n");
        skip();
    }
    if (result < 0 || plugin_list_add(&s->plugins, GLOVE_PLUGIN, &err) < 0 ||
        plugin_list_find(&s->plugins, "cyberglove", MRT_INPUT, &s->type, &err) < 0)
        fail_msg("%s", err.text);
    s->log = log_queue_create();
    s->sample = calloc(SESSION_SAMPLES, sizeof *s->sample);
    assert_non_null(s->log);
    assert_non_null(s->sample);
}

static inline mrt_result session_try_open(glove_session *s, const char *params, error *err)
{
    mrt_result result =
        input_create(&s->input, s->type, s->child.address, params, CLOCK_REAL, s->log, err);
    if (result < 0)
        return result;
    const mrt_channel *channel = input_channels(s->input, &s->channel_count);
    memcpy(s->channel, channel, s->channel_count * sizeof *channel);
    return result;
}

static inline void session_open(glove_session *s, const char *params)
{
    error err = {""};
    if (session_try_open(s, params, &err) < 0 || input_start(s->input, &err) < 0) {
        session_say_log(s);
        fail_msg("%s", err.text);
    }
}

/* Takes samples until there are `count` in all, or time_s have passed; true: there are. */
static inline bool session_take(glove_session *s, uint32_t count, double time_s)
{
    int64_t end_ns = clock_now_ns() + (int64_t)(time_s * 1e9);
    assert_true(count <= SESSION_SAMPLES);
    while (s->count < count && clock_now_ns() < end_ns) {
        if (input_peek(s->input, &s->sample[s->count])) {
            input_take(s->input);
            s->count += 1;
        } else {
            clock_sleep_until_ns(clock_now_ns() + 2 * NS_PER_MS);
        }
    }
    return s->count == count;
}

static inline void session_close(glove_session *s)
{
    input_destroy(s->input);
    s->input = NULL;
}

static inline void session_end(glove_session *s)
{
    session_close(s);
    if (s->log)
        session_say_log(s);
    log_queue_destroy(s->log);
    plugin_list_destroy(&s->plugins);
    glove_child_finish(&s->child);
    free(s->sample);
    *s = (glove_session){0};
}

/* The input is closed, the emulator ends, and says what was true. */
static inline void session_read_truth(glove_session *s, glove_truth *out)
{
    error err = {""};
    session_close(s);
    assert_true(glove_child_stop(&s->child));
    if (glove_truth_read(out, s->child.truth, &err) < 0)
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
