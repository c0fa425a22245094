/* `marotte devices`: lists the connected devices, watches their samples, forwards them, and teaches
 * a switch. */
#include "cli/command.h"
#include "cli/terminal.h"

#include "base/json.h"
#include "base/cancel.h"
#include "base/clock.h"
#include "base/program.h"
#include "base/text.h"
#include "stage/input/device_list.h"
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

#include <jansson.h>

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { DEVICES_INPUTS_MAX = 8 };

typedef struct devices_options {
    plugin_spec input[DEVICES_INPUTS_MAX];
    uint32_t input_count;
    const char *forward; /* "HOST:PORT" or NULL */
    plugin_spec learn;   /* zeroed: none */
    double seconds;      /* 0: until stopped */
    bool is_json, is_watch;
} devices_options;

/* ---- connected devices ---- */

static const char *state_name(int32_t state)
{
    return state == MRT_DEVICE_READY    ? "ready"
           : state == MRT_DEVICE_BUSY   ? "busy"
           : state == MRT_DEVICE_DENIED ? "denied"
                                        : "unsure";
}

/* ---- output ---- */

static void print_looked_for(const plugin_list *plugins)
{
    bool any = false;
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (!device_list_can_list(type))
            continue;
        if (!any)
            puts("no device was found; looked for:");
        printf("  %-12s %s\n", plugin_short_name(type), type->about);
        any = true;
    }
    if (!any)
        puts("no device was found: no plugin is loaded that knows devices (marotte plugin list)");
}

enum { SPEC_TEXT = 256 };

/* Writes the value for --input. */
static void write_spec(char out[SPEC_TEXT], const device_found *of)
{
    (void)snprintf(out, SPEC_TEXT, "%.48s:%s", plugin_short_name(of->type), of->device.address);
}

static void devices_print(const device_list *found, const plugin_list *plugins)
{
    if (found->count == 0)
        print_looked_for(plugins);
    for (uint32_t i = 0; i < found->count; ++i) {
        const device_found *one = &found->one[i];
        printf("%-8s %s\n", state_name(one->device.state), one->device.name);
        char spec[SPEC_TEXT], word[4 * SPEC_TEXT];
        write_spec(spec, one);
        program_quote(word, sizeof word, spec);
        printf("         --input %s\n", word);
        if (one->device.advice[0])
            printf("         %s\n", one->device.advice);
    }
    if (found->beyond)
        printf("and %u more\n", found->beyond);
}

static json_t *device_to_json(const device_found *one)
{
    char spec[SPEC_TEXT];
    write_spec(spec, one);
    return json_pack("{s:o, s:o, s:o, s:o, s:s, s:o}", "plugin", json_text(one->type->id), "name",
                     json_text(one->device.name), "address", json_text(one->device.address),
                     "input", json_text(spec), "state", state_name(one->device.state), "advice",
                     json_text(one->device.advice));
}

static void devices_print_json(const device_list *found, const plugin_list *plugins)
{
    json_t *devices = json_array(), *looked_for = json_array();
    for (uint32_t i = 0; i < found->count; ++i)
        json_array_append_new(devices, device_to_json(&found->one[i]));
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (device_list_can_list(type))
            json_array_append_new(looked_for, json_pack("{s:o, s:o}", "plugin", json_text(type->id),
                                                        "about", json_text(type->about)));
    }
    json_t *all = json_pack("{s:o, s:o}", "devices", devices, "looked_for", looked_for);
    facts_print_json(all, JSON_INDENT(2));
}

/* ---- wake-up: by inputs, and by the signal to stop ---- */

static wake news;

static void wake_up(void)
{
    wake_signal(&news);
}

/* ---- watching: state ---- */

enum { LINE_LENGTH = 512, WIDTH_LEAST = 40 };

/* Interval between updates: in place on a terminal, otherwise one line for each input. */
static const int64_t terminal_span_ns = 250 * NS_PER_MS, line_span_ns = NS_PER_S;

/* Minimum share of samples at an end of the channel's range that is reported. */
static const float saturated_least = 0.02f;

static const double silent_least_s = 1.0;

/* Interval between searches for devices that were plugged in later. */
static const int64_t look_span_ns = 2 * NS_PER_S;

typedef struct forwarding {
    instance plugin;
    const mrt_output *functions;
    bool open;
    uint64_t sent, failed;
} forwarding;

typedef struct watch {
    const devices_options *options;
    plugin_list *plugins;
    log_queue *log;
    input *inputs[DEVICES_INPUTS_MAX];
    mrt_device opened[DEVICES_INPUTS_MAX]; /* of inputs that were found, not named */
    uint32_t input_count;
    forwarding forward;
    int64_t start_ns, shown_ns, looked_ns;
    log_once logged; /* messages already printed while searching for devices */
    bool is_terminal;
    uint32_t lines; /* number of lines printed last, to overwrite */
} watch;

/* ---- opening ---- */

static mrt_result open_input(watch *self, const mrt_plugin_type *type, const char *address,
                             const char *params, error *err)
{
    input *in;
    mrt_result result = input_create_stoppable(&in, type, address, params, CLOCK_REAL, self->log,
                                               cancel_flag(), err);
    if (result < 0)
        return result;
    self->inputs[self->input_count++] = in;
    input_set_wake(in, &news);
    return input_start(in, err);
}

static mrt_result open_named(watch *self, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < self->options->input_count && result >= 0; ++i) {
        const plugin_spec *spec = &self->options->input[i];
        const mrt_plugin_type *type;
        result = plugin_list_choose(self->plugins, spec->plugin, MRT_INPUT, &type, err);
        if (result >= 0)
            result = open_input(self, type, spec->address, spec->params, err);
    }
    return result;
}

static bool is_open(const watch *self, const mrt_device *device)
{
    for (uint32_t i = 0; i < self->input_count; ++i)
        if (strcmp(self->opened[i].address, device->address) == 0)
            return true;
    return false;
}

static bool looks_for_devices(const watch *self)
{
    return self->options->input_count == 0;
}

/* Opens every ready device that is not open yet. Reports one that cannot be opened, and skips
 * it. */
static mrt_result open_ready(watch *self, error *err)
{
    device_list found;
    mrt_result result = device_list_scan(&found, self->plugins, self->log, &self->logged, err);
    for (uint32_t i = 0; result >= 0 && i < found.count; ++i) {
        const device_found *one = &found.one[i];
        if (one->device.state != MRT_DEVICE_READY || is_open(self, &one->device) ||
            self->input_count == DEVICES_INPUTS_MAX)
            continue;
        self->opened[self->input_count] = one->device;
        error why = {""};
        if (open_input(self, one->type, one->device.address, "", &why) < 0 &&
            !log_once_repeats(&self->logged, why.text))
            log_push(self->log, MRT_LOG_WARNING, one->type->id, why.text);
    }
    self->looked_ns = clock_now_ns();
    return result;
}

static mrt_result open_inputs(watch *self, error *err)
{
    if (!looks_for_devices(self))
        return open_named(self, err);
    mrt_result result = open_ready(self, err);
    if (result >= 0 && self->input_count == 0)
        fprintf(stderr, "note: no device is ready: waiting for one (marotte devices shows what to "
                        "do)\n");
    return result;
}

static mrt_result open_forward(watch *self, error *err)
{
    const mrt_plugin_type *type;
    forwarding *forward = &self->forward;
    if (!self->options->forward)
        return MRT_OK;
    mrt_result result = plugin_list_find(self->plugins, "osc", MRT_OUTPUT, &type, err);
    if (result >= 0)
        result = instance_create(&forward->plugin, type, CLOCK_REAL, self->log, err);
    if (result < 0)
        return result;
    error why = {""};
    forward->functions = plugin_interface(type, MRT_OUTPUT);
    instance_latch(&forward->plugin);
    instance_listen(&forward->plugin, &why, NULL);
    result = forward->functions->open(forward->plugin.self, self->options->forward,
                                      forward->plugin.params);
    instance_listen_end(&forward->plugin);
    forward->open = result >= 0;
    if (result < 0)
        return error_set(err, result, "%s",
                         why.text[0] ? why.text : "the output could not be opened");
    return MRT_OK;
}

static void finish(watch *self)
{
    for (uint32_t i = 0; i < self->input_count; ++i)
        input_destroy(self->inputs[i]);
    if (self->forward.open)
        self->forward.functions->close(self->forward.plugin.self);
    instance_destroy(&self->forward.plugin);
}

/* ---- lines ---- */

__attribute__((format(printf, 3, 4))) static void add(char *line, size_t *length,
                                                      const char *format, ...)
{
    va_list arguments;
    if (*length + 1 >= LINE_LENGTH)
        return;
    va_start(arguments, format);
    int added = vsnprintf(line + *length, LINE_LENGTH - *length, format, arguments);
    va_end(arguments);
    *length += added > 0 ? (size_t)added : 0;
    if (*length >= LINE_LENGTH)
        *length = LINE_LENGTH - 1;
}

static void add_saturated(char *line, size_t *length, const input *in, const health_report *health)
{
    uint32_t count, told = 0;
    const mrt_channel *channels = input_channels(in, &count);
    for (uint32_t i = 0; i < health->channel_count && i < count; ++i)
        if (health->saturated[i] >= saturated_least)
            add(line, length, "%s%s %.0f %%",
                told++ ? ", " : "  at the end of its range: ", channels[i].name,
                100.0 * (double)health->saturated[i]);
}

static void describe(char *line, const input *in, const health_report *health)
{
    size_t length = 0;
    add(line, &length, "%-28s %-7s", input_name(in), input_state_name((input_state)health->state));
    if (health->state == INPUT_RUNNING) {
        add(line, &length, " %6.1f Hz  jitter %.2f ms  late %.1f ms (worst %.1f)", health->rate_hz,
            health->jitter_ms, health->lateness_ms, health->lateness_worst_ms);
        if (health->has_drift)
            add(line, &length, "  drift %+.0f ppm", health->drift_ppm);
        if (health->silence_s >= silent_least_s)
            add(line, &length, "  silent for %.1f s", health->silence_s);
    } else {
        add(line, &length, " for %.1f s", health->state_s);
    }
    add(line, &length, "  lost %ju", (uintmax_t)(health->gap_count + health->dropped_count));
    if (health->refused_count)
        add(line, &length, "  refused %ju", (uintmax_t)health->refused_count);
    if (health->loss_count)
        add(line, &length, "  went away %ux", health->loss_count);
    if (health->state == INPUT_RUNNING)
        add_saturated(line, &length, in, health);
    else if (health->words[0])
        add(line, &length, "  %s", health->words);
}

static size_t terminal_width(void)
{
    struct winsize size = {0};
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < WIDTH_LEAST)
        return LINE_LENGTH;
    return size.ws_col;
}

/* Removes the lines printed last, so that other output can be printed above them. */
static void clear_lines(watch *self)
{
    if (self->lines)
        printf("\033[%uA\033[J", self->lines);
    self->lines = 0;
    fflush(stdout);
}

static void show_line(watch *self, char *line)
{
    if (self->is_terminal) {
        size_t width = terminal_width();
        if (strlen(line) >= width)
            line[width - 1] = '\0';
        self->lines += 1;
    }
    puts(line);
}

static void show_lines(watch *self)
{
    char line[LINE_LENGTH];
    size_t length = 0;
    clear_lines(self);
    for (uint32_t i = 0; i < self->input_count; ++i) {
        health_report health;
        input_health(self->inputs[i], &health);
        describe(line, self->inputs[i], &health);
        show_line(self, line);
    }
    if (self->forward.open) {
        add(line, &length, "forwarded to %s: %ju samples", self->options->forward,
            (uintmax_t)self->forward.sent);
        if (self->forward.failed)
            add(line, &length, ", %ju could not be sent", (uintmax_t)self->forward.failed);
        show_line(self, line);
    }
    fflush(stdout);
}

static json_t *health_to_json(const input *in, const health_report *health)
{
    json_t *saturated = json_object();
    uint32_t count;
    const mrt_channel *channels = input_channels(in, &count);
    for (uint32_t i = 0; i < health->channel_count && i < count; ++i)
        if (health->saturated[i] >= saturated_least)
            json_object_set_new(saturated, channels[i].name,
                                json_real((double)health->saturated[i]));
    json_t *out = json_pack(
        "{s:o, s:s, s:f, s:o, s:f, s:f, s:f, s:f, s:f, s:I, s:I, s:I, s:I, s:i, s:o}", "input",
        json_text(input_name(in)), "state", input_state_name((input_state)health->state), "state_s",
        health->state_s, "words", json_text(health->words), "rate_hz", health->rate_hz, "jitter_ms",
        health->jitter_ms, "lateness_ms", health->lateness_ms, "lateness_worst_ms",
        health->lateness_worst_ms, "silence_s", health->silence_s, "samples",
        (json_int_t)health->sample_count, "lost", (json_int_t)health->gap_count, "dropped",
        (json_int_t)health->dropped_count, "refused", (json_int_t)health->refused_count,
        "went_away", (int)health->loss_count, "saturated", saturated);
    json_object_set_new(out, "drift_ppm",
                        health->has_drift ? json_real(health->drift_ppm) : json_null());
    return out;
}

static void show_json(const watch *self)
{
    json_t *inputs = json_array();
    for (uint32_t i = 0; i < self->input_count; ++i) {
        health_report health;
        input_health(self->inputs[i], &health);
        json_array_append_new(inputs, health_to_json(self->inputs[i], &health));
    }
    json_t *all = json_pack("{s:f, s:o}", "time_s", (double)(self->shown_ns - self->start_ns) / 1e9,
                            "inputs", inputs);
    if (self->forward.open) {
        json_object_set_new(all, "sent", json_integer((json_int_t)self->forward.sent));
        json_object_set_new(all, "not_sent", json_integer((json_int_t)self->forward.failed));
    }
    facts_print_json(all, JSON_COMPACT | JSON_REAL_PRECISION(9));
    fflush(stdout);
}

static void show(watch *self, int64_t now_ns)
{
    self->shown_ns = now_ns;
    if (self->options->is_json)
        show_json(self);
    else
        show_lines(self);
}

/* ---- watching ---- */

static void pass_on(watch *self, const input *in, const mrt_sample *sample)
{
    forwarding *forward = &self->forward;
    uint32_t count;
    const mrt_channel *channels = input_channels_of(in, input_version(in), &count);
    if (!forward->open)
        return;
    if (forward->functions->write(forward->plugin.self, input_name(in), channels, sample) < 0)
        forward->failed += 1;
    else
        forward->sent += 1;
}

static void report_incident(watch *self, const input *in, const input_incident *what)
{
    double time_s = (double)(what->time_ns - self->start_ns) / 1e9;
    clear_lines(self);
    if (what->kind == INPUT_WAS_LOST)
        fprintf(stderr, "note: %s went away at %.1f s%s%s%s\n", input_name(in), time_s,
                what->text[0] ? " (" : "", what->text, what->text[0] ? ")" : "");
    else
        fprintf(stderr, "note: %s came back at %.1f s, after %.1f s\n", input_name(in), time_s,
                (double)what->away_ns / 1e9);
}

static void report_news(watch *self)
{
    log_record record;
    while (log_pop(self->log, &record)) {
        if (record.level > MRT_LOG_DEBUG)
            clear_lines(self);
        news_print_record(&record);
    }
}

/* Reads all samples that are ready. Returns false if no input will deliver any more. */
static bool read_all(watch *self)
{
    bool is_any_alive = false;
    for (uint32_t i = 0; i < self->input_count; ++i) {
        input *in = self->inputs[i];
        input_state state = input_state_of(in); /* read first: samples from before the end count */
        mrt_sample sample;
        input_incident incident;
        is_any_alive |= state == INPUT_RUNNING || state == INPUT_LOST;
        for (; input_peek(in, &sample); input_pop(in))
            pass_on(self, in, &sample);
        while (input_pop_incident(in, &incident))
            report_incident(self, in, &incident);
    }
    return is_any_alive;
}

static int64_t end_ns_of(const watch *self)
{
    double seconds = self->options->seconds;
    return seconds > 0 ? self->start_ns + (int64_t)(seconds * 1e9) : INT64_MAX;
}

static mrt_result look_again(watch *self, error *err)
{
    if (!looks_for_devices(self) || clock_now_ns() < self->looked_ns + look_span_ns)
        return MRT_OK;
    return open_ready(self, err);
}

static mrt_result follow(watch *self, error *err)
{
    bool redraws = self->is_terminal && !self->options->is_json;
    int64_t span_ns = redraws ? terminal_span_ns : line_span_ns;
    int64_t end_ns = end_ns_of(self);
    for (;;) {
        uint32_t seen = wake_seen(&news);
        mrt_result result = look_again(self, err);
        if (result < 0)
            return result;
        bool goes_on = (read_all(self) || looks_for_devices(self)) && !cancel_is_requested();
        int64_t now_ns = clock_now_ns();
        report_news(self);
        goes_on &= now_ns < end_ns;
        if (now_ns >= self->shown_ns + span_ns || !goes_on || (redraws && self->lines == 0))
            show(self, now_ns);
        if (!goes_on)
            break;
        int64_t next_ns = self->shown_ns + span_ns;
        wake_wait_until_ns(&news, seen, next_ns < end_ns ? next_ns : end_ns);
    }
    if (self->input_count == 0)
        return error_set(err, MRT_ERR_IO,
                         "no device is ready. marotte devices shows why. --input opens a chosen "
                         "one");
    return MRT_OK;
}

/* Runs until the signal to stop, until the time is over, or until every input has ended. */
static mrt_result devices_watch(const devices_options *options, plugin_list *plugins,
                                log_queue *log, error *err)
{
    watch self = {.options = options, .plugins = plugins, .log = log};
    self.is_terminal = isatty(STDOUT_FILENO) == 1;
    self.start_ns = self.shown_ns = clock_now_ns();
    mrt_result result = open_forward(&self, err);
    if (result >= 0)
        result = open_inputs(&self, err);
    if (result >= 0)
        result = follow(&self, err);
    finish(&self);
    return result;
}

/* ---- learning a switch ---- */

static const int64_t learn_span_ns = 100 * NS_PER_MS;

typedef enum lesson { LESSON_GOES_ON = 0, LESSON_DONE, LESSON_GIVEN_UP } lesson;

/* Prints the plugin's messages about learning, which begin with "learn:". The last one is "learn:
 * done" or "learn: given up". */
static lesson read_lesson(log_queue *log)
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

/* Discards samples that arrive during learning. */
static void drain(input *in)
{
    mrt_sample sample;
    input_incident incident;
    while (input_peek(in, &sample))
        input_pop(in);
    while (input_pop_incident(in, &incident))
        if (incident.kind == INPUT_WAS_LOST)
            fprintf(stderr, "note: %s went away\n", input_name(in));
}

static mrt_result attend(input *in, const devices_options *options, log_queue *log, error *err)
{
    int64_t end_ns =
        options->seconds > 0 ? clock_now_ns() + (int64_t)(options->seconds * 1e9) : INT64_MAX;
    while (!cancel_is_requested() && clock_now_ns() < end_ns) {
        uint32_t seen = wake_seen(&news);
        input_state state = input_state_of(in);
        drain(in);
        lesson so_far = read_lesson(log);
        if (so_far == LESSON_DONE)
            return MRT_OK;
        if (so_far == LESSON_GIVEN_UP)
            return error_set(err, MRT_ERR_IO, "%s: no switch was learnt", input_name(in));
        if (state == INPUT_ENDED || state == INPUT_FAILED)
            return error_set(err, MRT_ERR_IO, "%s: the input ended; no switch was learnt",
                             input_name(in));
        wake_wait_until_ns(&news, seen, clock_now_ns() + learn_span_ns);
    }
    return error_set(err, MRT_ERR_IO, "%s: stopped early: no switch was learnt", input_name(in));
}

static mrt_result devices_learn(const devices_options *options, plugin_list *plugins,
                                log_queue *log, error *err)
{
    const mrt_plugin_type *type;
    input *in = NULL;
    const plugin_spec *spec = &options->learn;
    mrt_result result = plugin_list_choose(plugins, spec->plugin, MRT_INPUT, &type, err);
    if (result >= 0)
        result = input_create_stoppable(&in, type, spec->address, spec->params, CLOCK_REAL, log,
                                        cancel_flag(), err);
    if (result >= 0) {
        input_set_wake(in, &news);
        result = input_set(in, "learn", "1", err);
    }
    if (result >= 0)
        result = input_start(in, err);
    if (result >= 0)
        result = attend(in, options, log, err);
    input_destroy(in);
    return result;
}

/* ---- the command ---- */

static int add_input(void *to, const command *self, const char *name, const char *text)
{
    devices_options *out = to;
    if (out->input_count == DEVICES_INPUTS_MAX)
        return command_usage(self, "--input is given more than %d times", DEVICES_INPUTS_MAX);
    return command_read_spec(&out->input[out->input_count++], self, name, text);
}

#define AT(member) .offset = offsetof(devices_options, member)
static const command_option option_table[] = {
    {"json", COMMAND_FLAG, AT(is_json)},
    {"watch", COMMAND_FLAG, AT(is_watch)},
    {"input", COMMAND_READ, .read = add_input},
    {"seconds", COMMAND_NUMBER, AT(seconds), .least = 0.001, .most = 1e6},
    {"forward", COMMAND_TEXT, AT(forward)},
    {"learn", COMMAND_READ, AT(learn), .read = command_read_spec},
    {.name = NULL},
};

static int check_options(const devices_options *options)
{
    if (options->learn.plugin && (options->is_watch || options->input_count > 0))
        return command_usage(&command_devices,
                             "--learn cannot be combined with --input, --watch or --forward");
    if (!options->is_watch && options->input_count > 0)
        return command_usage(&command_devices, "--input needs --watch or --forward");
    if (!options->is_watch && !options->learn.plugin && options->seconds > 0)
        return command_usage(&command_devices, "--seconds needs --watch, --forward or --learn");
    return COMMAND_DONE;
}

static int read_options(devices_options *out, int argc, char **argv)
{
    int code = command_options(out, &command_devices, option_table, argc, argv);
    out->is_watch |= out->forward != NULL;
    return code == COMMAND_DONE ? check_options(out) : code;
}

static void finish_options(devices_options *options)
{
    for (uint32_t i = 0; i < options->input_count; ++i)
        plugin_spec_finish(&options->input[i]);
    plugin_spec_finish(&options->learn);
}

static mrt_result list_devices(const devices_options *options, const plugin_list *plugins,
                               log_queue *log, error *err)
{
    device_list found;
    mrt_result result = device_list_scan(&found, plugins, log, NULL, err);
    if (result < 0)
        return result;
    if (options->is_json)
        devices_print_json(&found, plugins);
    else
        devices_print(&found, plugins);
    return MRT_OK;
}

static mrt_result run_with(const devices_options *options, plugin_list *plugins, log_queue *log,
                           error *err)
{
    if (options->learn.plugin)
        return devices_learn(options, plugins, log, err);
    if (options->is_watch)
        return devices_watch(options, plugins, log, err);
    return list_devices(options, plugins, log, err);
}

static int run(int argc, char **argv)
{
    devices_options options = {.input_count = 0};
    plugin_list plugins = {0};
    error err = {""};
    int code = read_options(&options, argc, argv);
    if (code != COMMAND_DONE) {
        finish_options(&options);
        return code;
    }
    wake_init(&news);
    cancel_on_signals(CANCEL_WAITS, wake_up);
    log_queue *log = log_queue_create();
    mrt_result result =
        log ? plugin_list_load(&plugins, &err) : error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = run_with(&options, &plugins, log, &err);
    plugin_list_destroy(&plugins);
    news_print(log);
    log_queue_destroy(log);
    finish_options(&options);
    return result < 0 ? command_failed(&command_devices, &err) : COMMAND_DONE;
}

const command command_devices = {
    .name = "devices",
    .summary = "list, watch, forward or teach connected devices",
    .help =
        "marotte devices [--json]\n"
        "marotte devices --watch [--input SPEC]... [--seconds N] [--json]\n"
        "marotte devices --forward HOST:PORT [--input SPEC]... [--seconds N]\n"
        "marotte devices --learn PLUGIN[:ADDRESS] [--seconds N]\n"
        "\n"
        "Lists the connected gloves and pedals: what to write after --input, and how to repair a\n"
        "device that cannot be used.\n"
        "\n"
        "  --watch          open all ready devices and print their rate, jitter, latency, lost\n"
        "                   samples, clock drift and sensors at the end of their range. Waits\n"
        "                   for devices that are unplugged, or plugged in later\n"
        "  --input SPEC     only this input: PLUGIN[:ADDRESS][,key=value]...; up to 8 times\n"
        "  --seconds N      end after N seconds (at Ctrl-C)\n"
        "  --forward H:P    watch, and send every sample to the marotte that listens on host H\n"
        "                   with --input osc:0.0.0.0:PORT/SOURCE\n"
        "  --learn SPEC     teach an unknown pedal: press its switches in turn\n"
        "  --json           print the facts as JSON; with --watch one line per second\n",
    .examples = "devices\n"
                "devices --watch --input log:demo_hand.csv --seconds 1\n"
                "devices --forward 127.0.0.1:9105 --input log:demo_hand.csv --seconds 1\n",
    .run = run,
    .options = option_table,
};
