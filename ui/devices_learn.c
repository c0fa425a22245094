/* Teaching a plugin what a device's switches are: it says what to do, the person does it. */
#include "base/clock.h"
#include "devices.h"
#include "news.h"

#include <stdio.h>
#include <string.h>

static const int64_t look_span_ns = 100 * NS_PER_MS;

typedef enum lesson { LESSON_GOES_ON = 0, LESSON_DONE, LESSON_GIVEN_UP } lesson;

/* Plugins begin what they say of it with "learn:", and end with "learn: done" or "learn: given up".
 */
static lesson listen(log_queue *log)
{
    lesson so_far = LESSON_GOES_ON;
    log_record record;
    while (log_pop(log, &record)) {
        if (strncmp(record.text, "learn: ", 7) != 0) {
            news_print_record(&record);
            continue;
        }
        puts(record.text + 7);
        fflush(stdout);
        if (strncmp(record.text, "learn: done", 11) == 0)
            so_far = LESSON_DONE;
        else if (strncmp(record.text, "learn: given up", 15) == 0)
            so_far = LESSON_GIVEN_UP;
    }
    return so_far;
}

/* What is measured meanwhile is of no use here. */
static void drain(input *in)
{
    mrt_sample sample;
    input_incident incident;
    while (input_peek(in, &sample))
        input_take(in);
    while (input_take_incident(in, &incident))
        if (incident.kind == INPUT_WENT)
            fprintf(stderr, "note: %s went away\n", input_name(in));
}

static mrt_result attend(input *in, const devices_options *options, log_queue *log, wake *signal,
                         const _Atomic bool *stop, error *err)
{
    int64_t end_ns =
        options->seconds > 0 ? clock_now_ns() + (int64_t)(options->seconds * 1e9) : INT64_MAX;
    while (!atomic_load(stop) && clock_now_ns() < end_ns) {
        uint32_t seen = wake_seen(signal);
        input_state state = input_state_of(in);
        drain(in);
        lesson so_far = listen(log);
        if (so_far == LESSON_DONE)
            return MRT_OK;
        if (so_far == LESSON_GIVEN_UP)
            return error_set(err, MRT_ERR_IO, "%s: nothing was learnt", input_name(in));
        if (state == INPUT_ENDED || state == INPUT_FAILED)
            return error_set(err, MRT_ERR_IO, "%s: has ended; nothing was learnt", input_name(in));
        wake_wait_until_ns(signal, seen, clock_now_ns() + look_span_ns);
    }
    return error_set(err, MRT_ERR_IO, "%s: stopped before it was done: nothing was learnt",
                     input_name(in));
}

mrt_result devices_learn(const devices_options *options, plugin_list *plugins, log_queue *log,
                         wake *signal, const _Atomic bool *stop, error *err)
{
    const mrt_plugin_type *type;
    input *in = NULL;
    const plugin_spec *spec = &options->learn;
    mrt_result result = plugin_list_choose(plugins, spec->plugin, MRT_INPUT, &type, err);
    if (result >= 0)
        result = input_create_stoppable(&in, type, spec->address, spec->params, CLOCK_REAL, log,
                                        stop, err);
    if (result >= 0) {
        input_set_wake(in, signal);
        result = input_set(in, "learn", "1", err);
    }
    if (result >= 0)
        result = input_start(in, err);
    if (result >= 0)
        result = attend(in, options, log, signal, stop, err);
    input_destroy(in);
    return result;
}
