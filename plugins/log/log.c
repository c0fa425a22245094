/* log.c - the input plugin "org.marotte.log": plays a recorded hand as a live input. */
#include <marotte/plugin.h>

#include "log_parse.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In the order of the table of parameters. */
enum { PARAM_SPEED = 0, PARAM_LOOP, PARAM_START, PARAM_END, PARAM_HAND, PARAM_MIRROR, PARAM_COUNT };

static const double SPEED_MIN = 0.1, SPEED_MAX = 8.0;
static const double SECONDS_MAX = 100000.0;
static const int64_t NS_PER_SECOND = 1000000000;

struct mrt_plugin {
    const mrt_host *host;
    log_data data;
    bool is_open, is_mirrored;
    bool asked_to_restart, told_empty;

    /* The record of time anchor_record_ns is due at anchor_host_ns; `speed` applies after it. */
    bool is_playing;
    double speed;
    int64_t anchor_host_ns, anchor_record_ns;
    size_t next;         /* record */
    int64_t last_due_ns; /* of the last record returned */
    uint32_t sequence;
};

static void say(const mrt_plugin *self, int32_t level, const char *text)
{
    self->host->log(self->host, level, text);
}

/* ---- opening ---- */

static void log_damage_count(const mrt_plugin *self, const char *path)
{
    const log_data *data = &self->data;
    char text[LOG_REASON + 256];
    snprintf(text, sizeof text, "%.120s: skipped %zu of %zu records as damaged, first line %zu: %s",
             path, data->damaged_count, data->damaged_count + data->record_count,
             data->first_damaged_line, data->first_damage);
    say(self, MRT_LOG_WARNING, text);
}

static mrt_result read_log(mrt_plugin *self, const char *path, uint32_t hand)
{
    char reason[LOG_REASON];
    log_file file;
    mrt_result result = log_file_read(&file, path, reason);
    if (result >= 0)
        result = log_parse(&self->data, file.data, file.size, hand, reason);
    free(file.data);
    if (result < 0) {
        char text[LOG_REASON + 256];
        snprintf(text, sizeof text, "cannot play %.120s: %s", path, reason);
        say(self, MRT_LOG_ERROR, text);
        return result;
    }
    if (self->data.damaged_count > 0)
        log_damage_count(self, path);
    return MRT_OK;
}

static void log_close(mrt_plugin *self)
{
    if (self->is_open)
        log_data_finish(&self->data);
    self->is_open = false;
    self->is_playing = false;
}

/* Returns the hand of a log that does not name it. */
static uint32_t hand_of(const double *params)
{
    return (uint32_t)(params[PARAM_HAND] < 0.5 ? MRT_LEFT : MRT_RIGHT);
}

static bool wants_mirror(const double *params)
{
    return params[PARAM_MIRROR] >= 0.5;
}

/* Warns if raw values are mirrored, because the calibration converts raw values for the original
 * hand. */
static void warn_if_counts_are_mirrored(const mrt_plugin *self)
{
    for (uint32_t i = 0; i < self->data.channel_count; ++i)
        if (strcmp(self->data.unit[i], "count") == 0) {
            say(self, MRT_LOG_WARNING,
                "mirror=1: this log has raw glove values, which do not fit the other hand's "
                "calibration: mirror a log in rad or deg");
            return;
        }
}

static mrt_result log_open(mrt_plugin *self, const char *address, const double *params)
{
    log_close(self);
    if (!address || address[0] == '\0') {
        say(self, MRT_LOG_ERROR, "expected the path of a log, as in log:performance.csv");
        return MRT_ERR_ARGUMENT;
    }
    mrt_result result = read_log(self, address, hand_of(params));
    if (result < 0)
        return result;
    self->is_mirrored = wants_mirror(params);
    if (self->is_mirrored) {
        log_mirror(&self->data);
        warn_if_counts_are_mirrored(self);
    }
    self->is_open = true;
    self->asked_to_restart = false;
    self->told_empty = false;
    self->sequence = 0;
    return MRT_OK;
}

static const mrt_channel *log_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->data.channel_count;
    return self->data.channel;
}

/* ---- playing ---- */

/* NaN becomes `low`. */
static double within(double value, double low, double high)
{
    if (!(value > low))
        return low;
    return value < high ? value : high;
}

static int64_t ns_of_seconds(double seconds)
{
    return (int64_t)(within(seconds, 0.0, SECONDS_MAX) * 1e9 + 0.5);
}

/* Part of the recording to play: [start, end]; end 0 means all of it. */
typedef struct section {
    int64_t start_ns, end_ns;
} section;

static section section_of(const mrt_plugin *self, const double *params)
{
    section out = {ns_of_seconds(params[PARAM_START]), ns_of_seconds(params[PARAM_END])};
    int64_t last_ns = self->data.time_ns[self->data.record_count - 1];
    if (out.end_ns == 0 || out.end_ns > last_ns)
        out.end_ns = last_ns;
    return out;
}

/* Returns the first record that is not before time_ns; record_count: none. */
static size_t first_record_from(const log_data *data, int64_t time_ns)
{
    size_t low = 0, high = data->record_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (data->time_ns[middle] < time_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* Returns the time from the last record of one pass to the first of the next: the interval of
 * records. */
static int64_t record_interval_ns(const log_data *data)
{
    int64_t mean_ns = NS_PER_SECOND / 100;
    if (data->record_count > 1)
        mean_ns = data->time_ns[data->record_count - 1] / (int64_t)(data->record_count - 1);
    return mean_ns > NS_PER_SECOND / 1000 ? mean_ns : NS_PER_SECOND / 1000;
}

static int64_t due_ns(const mrt_plugin *self, int64_t record_ns)
{
    int64_t since_ns = record_ns - self->anchor_record_ns;
    if (self->speed == 1.0)
        return self->anchor_host_ns + since_ns;
    return self->anchor_host_ns + (int64_t)((double)since_ns / self->speed + 0.5);
}

static void start_pass(mrt_plugin *self, const section *played, int64_t host_ns)
{
    self->anchor_host_ns = host_ns;
    self->anchor_record_ns = played->start_ns;
    self->next = first_record_from(&self->data, played->start_ns);
}

static void begin_playing(mrt_plugin *self, const double *params, const section *played)
{
    self->is_playing = true;
    self->speed = within(params[PARAM_SPEED], SPEED_MIN, SPEED_MAX);
    int64_t origin_ns = self->host->now_ns(self->host);
    self->last_due_ns = origin_ns;
    start_pass(self, played, origin_ns);
}

/* Applies a new speed from the last record on, without a jump in time. */
static void follow_speed(mrt_plugin *self, const double *params)
{
    double speed = within(params[PARAM_SPEED], SPEED_MIN, SPEED_MAX);
    if (speed == self->speed)
        return;
    int64_t elapsed_ns = self->last_due_ns - self->anchor_host_ns;
    self->anchor_record_ns += (int64_t)((double)elapsed_ns * self->speed + 0.5);
    self->anchor_host_ns = self->last_due_ns;
    self->speed = speed;
}

/* Returns true if the log was opened with these parameters. */
static bool shows_hand(const mrt_plugin *self, const double *params)
{
    if (self->is_mirrored != wants_mirror(params))
        return false;
    bool is_asked_for = self->data.channel[0].hand == hand_of(params);
    return !self->data.is_hand_assumed || is_asked_for != self->is_mirrored;
}

/* Channels are fixed while the log is open, so a change of the hand requests a restart. */
static void follow_hand(mrt_plugin *self, const double *params)
{
    if (self->asked_to_restart || shows_hand(self, params))
        return;
    self->asked_to_restart = true;
    self->host->request_restart(self->host);
}

static bool is_over(const mrt_plugin *self, const section *played)
{
    return self->next >= self->data.record_count || self->data.time_ns[self->next] > played->end_ns;
}

/* Returns to the start if looping. Returns false if playback is over. */
static bool turn_around(mrt_plugin *self, const double *params, const section *played)
{
    if (!(params[PARAM_LOOP] >= 0.5))
        return false;
    int64_t interval_ns = record_interval_ns(&self->data);
    start_pass(self, played, self->last_due_ns + (int64_t)((double)interval_ns / self->speed));
    /* The next pass begins with its first record, without the silence before it. */
    if (!is_over(self, played)) {
        self->anchor_record_ns = self->data.time_ns[self->next];
        return true;
    }
    return false;
}

static void warn_once_if_empty(mrt_plugin *self)
{
    if (self->sequence > 0 || self->told_empty)
        return;
    self->told_empty = true;
    say(self, MRT_LOG_WARNING, "the log has no records between start and end");
}

static void fill_sample(mrt_plugin *self, int64_t time_ns, mrt_sample *out)
{
    const log_data *data = &self->data;
    memset(out, 0, sizeof *out);
    out->time_ns = time_ns;
    out->sequence = self->sequence++;
    out->count = data->channel_count;
    memcpy(out->value, data->value + self->next * data->channel_count,
           data->channel_count * sizeof *out->value);
}

static mrt_result log_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                           mrt_sample *out_sample)
{
    if (!self->is_open)
        return MRT_END;
    section played = section_of(self, params);
    if (!self->is_playing)
        begin_playing(self, params, &played);
    follow_speed(self, params);
    follow_hand(self, params);
    if (is_over(self, &played) && !turn_around(self, params, &played)) {
        warn_once_if_empty(self);
        return MRT_END;
    }
    int64_t due = due_ns(self, self->data.time_ns[self->next]);
    if (due > deadline_ns) {
        self->host->wait_until_ns(self->host, deadline_ns);
        return MRT_TIMEOUT;
    }
    self->host->wait_until_ns(self->host, due);
    fill_sample(self, due, out_sample);
    self->last_due_ns = due;
    self->next += 1;
    return MRT_OK;
}

static int64_t log_duration_ns(mrt_plugin *self, const double *params)
{
    if (params[PARAM_LOOP] >= 0.5)
        return -1;
    const section played = section_of(self, params);
    if (played.start_ns >= played.end_ns)
        return 0;
    const double speed = within(params[PARAM_SPEED], SPEED_MIN, SPEED_MAX);
    return (int64_t)((double)(played.end_ns - played.start_ns) / speed);
}

/* ---- the type ---- */

static mrt_plugin *log_create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    return self;
}

static void log_destroy(mrt_plugin *self)
{
    if (!self)
        return;
    log_close(self);
    free(self);
}

static const char *const hand_label[] = {"left", "right", NULL};
static const char *const mirror_label[] = {"as recorded", "the other hand", NULL};
static const char *const loop_label[] = {"once", "again and again", NULL};

static const mrt_param params[PARAM_COUNT] = {
    [PARAM_SPEED] = {1, 0, "speed", "Playback", "times", "Playback speed", 0.1, 8.0, 1.0, NULL},
    [PARAM_LOOP] = {2, MRT_PARAM_STEPPED, "loop", "Playback", "", "Repeat the log at its end", 0, 1,
                    0, loop_label},
    [PARAM_START] = {3, 0, "start", "Playback", "s", "Start position in the log", 0, 100000, 0,
                     NULL},
    [PARAM_END] = {4, 0, "end", "Playback", "s", "End position in the log; 0: its end", 0, 100000,
                   0, NULL},
    [PARAM_HAND] = {5, MRT_PARAM_STEPPED, "hand", "Playback", "",
                    "Hand of the log, if the log does not name it", MRT_LEFT, MRT_RIGHT, MRT_RIGHT,
                    hand_label},
    [PARAM_MIRROR] = {6, MRT_PARAM_STEPPED, "mirror", "Playback", "",
                      "Mirror the recording: play it as the other hand", 0, 1, 0, mirror_label},
};

static const mrt_input input = {log_open, log_channels, log_read, log_close, MRT_INPUT_RECORDED};

static const mrt_duration duration = {log_duration_ns};

static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DURATION, &duration}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.log",
    "Log",
    MAROTTE_VERSION,
    "Plays a recorded hand: marotte logs and GraspDB14 recordings",
    log_create,
    log_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
