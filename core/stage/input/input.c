#include "stage/input/input.h"
#include "base/clock.h"
#include "base/installed.h"
#include "base/ring.h"
#include "base/text.h"
#include "base/trace.h"
#include "stage/input/channel_table.h"
#include "stage/mapping/plugins.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { INPUT_VERSIONS = 8, INPUT_RING = 1024, INPUT_INCIDENTS = 64 };

typedef struct input_record {
    mrt_sample sample;
    uint32_t version, number;
} input_record;

/* State of a lost device. Owned by the reading thread. */
typedef struct input_outage {
    int64_t lost_ns, next_try_ns;
    uint32_t tries;
    log_once logged; /* logs each text of this loss only once */
} input_outage;

struct input {
    instance plugin;
    const mrt_input *functions;
    bool is_recording; /* its clock may be virtual, and it cannot be lost */
    char *address, name[INPUT_NAME];
    bool open; /* the plugin is open. Owned by [main] until input_start and after input_stop,
                  otherwise by the thread */
    bool has_thread;
    pthread_t thread;
    ring *samples, *incidents; /* elements: input_record, input_incident */
    wake *signal;
    pthread_mutex_t keeper_lock;
    input_keeper keeper;                 /* GUARDED_BY(keeper_lock) */
    channel_table table[INPUT_VERSIONS]; /* entries below version_count never change */
    uint32_t version_count;              /* owned by the reading thread */
    _Atomic uint32_t version;            /* of the newest samples */
    _Atomic int32_t state;
    _Atomic bool stopping;
    _Atomic uint32_t refused, dropped;
    /* Owned by the frame thread. */
    bool has_pending; /* virtual clock: one sample is read ahead */
    input_record pending;
    uint32_t peeked_version, peeked_number, taken_count;
    /* Owned by the reading thread (on a virtual clock: the frame thread). */
    bool has_last, has_unsent, has_warned_of_time;
    uint32_t delivered_count;
    mrt_sample last;     /* last delivered sample since the device was opened */
    input_record unsent; /* the newest sample while the ring is full */
    int64_t opened_ns, posted_ns;
    int64_t patience_first_ns, patience_later_ns;
    uint32_t hasty_reads; /* consecutive reads that returned immediately without a sample */
    input_outage outage;
    health_meter meter;
    health_board board;
};

/* The first half of this file runs on the thread that reads the plugin: the thread of the input, or
 * the frame thread on a virtual clock. The second half, below "the functions of input.h", runs on
 * [main] and the frame thread. */

/* Maximum blocking time of a read before the thread checks whether it must stop. */
static const int64_t read_span_ns = 100 * NS_PER_MS;

/* Interval between attempts to write a sample to the full ring. */
static const int64_t unsent_span_ns = 5 * NS_PER_MS;

/* Samples of a device are refused if their time stamp is outside these limits around now. */
static const int64_t past_max_ns = 10 * NS_PER_S, future_max_ns = 1 * NS_PER_S;

/* After HASTY_READS consecutive reads that returned immediately without a sample, a pause follows
 * each further one. */
enum { HASTY_READS = 16, FRUITLESS_READS = 100000, TRIES_AT_FIRST = 8 };
static const int64_t hasty_ns = NS_PER_MS / 10, pause_ns = 1 * NS_PER_MS;

static const int64_t post_span_ns = 20 * NS_PER_MS;

static bool is_device(const input *self)
{
    return self->plugin.clock == CLOCK_REAL && !self->is_recording;
}

static bool is_stopping(const input *self)
{
    return atomic_load(&self->stopping);
}

static bool is_lost(const input *self)
{
    return atomic_load(&self->state) == INPUT_LOST;
}

static void signal_player(const input *self)
{
    if (self->signal)
        wake_signal(self->signal);
}

static void log_plugin_text(const input *self, const error *why, int32_t level)
{
    if (why->text[0])
        log_push(self->plugin.log, level, self->plugin.type->id, why->text);
}

static const channel_table *newest_table(const input *self)
{
    return &self->table[atomic_load(&self->version)];
}

/* ---- health ---- */

static void post_health(input *self, int64_t now_ns)
{
    health_report report;
    health_measure(&self->meter, now_ns, &report);
    health_post(&self->board, &report);
    self->posted_ns = now_ns;
}

static void change_state(input *self, input_state state, const char *words, int64_t now_ns)
{
    static const char *const names[] = {[INPUT_RUNNING] = "runs",
                                        [INPUT_ENDED] = "ended",
                                        [INPUT_FAILED] = "failed",
                                        [INPUT_LOST] = "lost its device"};
    TRACE(TRACE_INPUT, "%s: %s%s%s", self->name, names[state], words[0] ? ": " : "", words);
    health_state(&self->meter, (int32_t)state, words, now_ns);
    post_health(self, now_ns);
    atomic_store(&self->state, (int32_t)state);
    signal_player(self);
}

/* ---- delivery ---- */

static bool push_unsent(input *self)
{
    if (self->has_unsent && ring_push(self->samples, &self->unsent))
        self->has_unsent = false;
    return !self->has_unsent;
}

static void keep(input *self, const input_record *record)
{
    pthread_mutex_lock(&self->keeper_lock);
    if (self->keeper.keep)
        self->keeper.keep(self->keeper.data, record->number, record->version, &record->sample);
    pthread_mutex_unlock(&self->keeper_lock);
}

/* While the ring is full, the newest sample stays in `unsent` and older ones are dropped. The last
 * sample of a pedal must arrive, because it releases the pedal. */
static void deliver(input *self, const mrt_sample *sample)
{
    input_record record = {*sample, atomic_load(&self->version), self->delivered_count++};
    keep(self, &record);
    bool had_unsent = !push_unsent(self);
    if (had_unsent || !ring_push(self->samples, &record)) {
        if (had_unsent) {
            atomic_fetch_add(&self->dropped, 1);
            health_dropped(&self->meter);
        }
        self->unsent = record;
        self->has_unsent = true;
    }
    self->last = *sample;
    self->has_last = true;
    signal_player(self);
}

static void deliver_unsent(input *self)
{
    while (!push_unsent(self) && !is_stopping(self))
        instance_wait_until_ns(&self->plugin, clock_now_ns() + unsent_span_ns);
    signal_player(self);
}

/* Called before a device is closed: repeats its last sample with all pedals released. */
static void release_pedals(input *self, int64_t now_ns)
{
    const channel_table *table = newest_table(self);
    bool any_down = false;
    if (!self->has_last)
        return;
    mrt_sample up = self->last;
    for (uint32_t i = 0; i < table->count; ++i) {
        if (!channel_is_pedal(&table->channel[i]))
            continue;
        any_down |= up.value[i] > 0.0f;
        up.value[i] = 0.0f;
    }
    if (!any_down)
        return;
    up.sequence += 1;
    up.time_ns = now_ns > up.time_ns ? now_ns : up.time_ns;
    deliver(self, &up);
}

static void push_incident(input *self, input_incident_kind kind, int64_t now_ns, int64_t away_ns,
                          const char *text)
{
    input_incident incident = {.kind = kind, .time_ns = now_ns, .away_ns = away_ns};
    snprintf(incident.text, sizeof incident.text, "%.*s", (int)sizeof incident.text - 1, text);
    (void)ring_push(self->incidents, &incident);
    signal_player(self);
}

/* ---- opening ---- */

static void close_plugin(input *self)
{
    if (self->open)
        self->functions->close(self->plugin.self);
    self->open = false;
    self->has_last = false;
}

/* Opens the plugin and copies its channels. On failure the plugin is closed, and err is the error
 * that it logged, or "". */
static mrt_result open_plugin(input *self, log_once *already_logged, channel_table *out, error *err)
{
    error why = {""};
    close_plugin(self);
    instance_latch(&self->plugin);
    instance_listen(&self->plugin, &why, already_logged);
    mrt_result result =
        self->functions->open(self->plugin.self, self->address, self->plugin.params);
    instance_listen_end(&self->plugin);
    self->opened_ns = clock_now_ns();
    if (result < 0)
        return error_set(err, result, "%s", why.text);
    log_plugin_text(self, &why, MRT_LOG_ERROR);
    self->open = true;
    self->has_warned_of_time = false;
    uint32_t count = 0;
    const mrt_channel *channels = self->functions->channels(self->plugin.self, &count);
    TRACE(TRACE_INPUT, "%s: opened with %u channels", self->name, count);
    result = channel_table_init(out, channels, count, self->name, err);
    if (result < 0)
        close_plugin(self);
    return result;
}

/* Makes `table` the version of the next samples: an equal earlier version, or a new one. */
static mrt_result adopt_channels(input *self, const channel_table *table, error *err)
{
    uint32_t at = 0;
    while (at < self->version_count && !channel_table_equal(&self->table[at], table, NULL))
        at += 1;
    if (at == INPUT_VERSIONS)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: the channels changed %d times, which is the limit: close this "
                         "input and open it again",
                         self->name, INPUT_VERSIONS - 1);
    if (at == self->version_count) {
        channel_table_copy(&self->table[at], table->channel, table->count);
        self->version_count += 1;
    }
    atomic_store(&self->version, at);
    return MRT_OK;
}

/* Called by [main] before the thread starts, by the reading thread afterwards. */
static mrt_result open_input(input *self, error *err)
{
    channel_table table;
    mrt_result result = open_plugin(self, NULL, &table, err);
    if (result < 0 && !err->text[0])
        return error_set(err, result, "%s: cannot open the input", self->name);
    if (result < 0)
        return result;
    bool is_first = self->version_count == 0;
    result = adopt_channels(self, &table, err);
    if (result < 0) {
        close_plugin(self);
        return result;
    }
    if (is_first)
        health_init(&self->meter, table.channel, table.count, self->opened_ns);
    else
        health_reopened(&self->meter, table.channel, table.count);
    post_health(self, self->opened_ns);
    return MRT_OK;
}

/* ---- reading ---- */

static bool is_current(input *self, const mrt_sample *sample, int64_t now_ns)
{
    if (!is_device(self) ||
        (sample->time_ns >= now_ns - past_max_ns && sample->time_ns <= now_ns + future_max_ns))
        return true;
    if (!self->has_warned_of_time)
        log_pushf(self->plugin.log, MRT_LOG_WARNING, self->plugin.type->id,
                  "%s: samples are refused: their time stamps are %.3g s away from now", self->name,
                  ((double)sample->time_ns - (double)now_ns) / 1e9);
    self->has_warned_of_time = true;
    return false;
}

static bool is_good(input *self, const mrt_sample *sample, int64_t now_ns)
{
    if (sample->count != newest_table(self)->count)
        return false;
    for (uint32_t i = 0; i < sample->count; ++i)
        if (!isfinite(sample->value[i]))
            return false;
    return is_current(self, sample, now_ns);
}

/* MRT_OK: a valid sample. MRT_TIMEOUT: no sample, or a refused one. < 0: out_why is the error that
 * the plugin logged. */
static mrt_result read_plugin(input *self, int64_t deadline_ns, mrt_sample *out, int64_t *out_now,
                              error *out_why)
{
    memset(out, 0, sizeof *out);
    instance_latch(&self->plugin);
    instance_listen(&self->plugin, out_why, NULL);
    mrt_result result =
        self->functions->read(self->plugin.self, self->plugin.params, deadline_ns, out);
    instance_listen_end(&self->plugin);
    *out_now = clock_now_ns();
    if (result >= 0)
        log_plugin_text(self, out_why, MRT_LOG_ERROR);
    if (result != MRT_OK || is_good(self, out, *out_now))
        return result;
    atomic_fetch_add(&self->refused, 1);
    health_refused(&self->meter);
    return MRT_TIMEOUT;
}

/* ---- the end ---- */

static void end(input *self)
{
    deliver_unsent(self);
    change_state(self, INPUT_ENDED, "", clock_now_ns());
}

static void fail(input *self, const error *why)
{
    int64_t now_ns = clock_now_ns();
    log_plugin_text(self, why, MRT_LOG_ERROR);
    if (is_device(self)) {
        release_pedals(self, now_ns);
        deliver_unsent(self);
    }
    change_state(self, INPUT_FAILED, why->text, now_ns);
}

/* ---- a lost device ---- */

static void schedule_retry(input *self)
{
    int64_t patience_ns =
        self->outage.tries < TRIES_AT_FIRST ? self->patience_first_ns : self->patience_later_ns;
    self->outage.tries += 1;
    self->outage.next_try_ns = clock_now_ns() + patience_ns;
}

static void log_outage_once(input *self, const error *why)
{
    if (!why->text[0])
        return;
    if (!log_once_repeats(&self->outage.logged, why->text))
        log_plugin_text(self, why, MRT_LOG_WARNING);
    health_state(&self->meter, INPUT_LOST, why->text, clock_now_ns());
}

static void lose_device(input *self, const error *why, int64_t now_ns)
{
    release_pedals(self, now_ns);
    self->outage = (input_outage){.lost_ns = now_ns};
    (void)log_once_repeats(&self->outage.logged, why->text);
    /* try immediately, unless the device was opened just before */
    self->outage.next_try_ns = self->opened_ns + self->patience_first_ns;
    health_lost(&self->meter);
    push_incident(self, INPUT_WAS_LOST, now_ns, 0, why->text);
    change_state(self, INPUT_LOST, why->text, now_ns);
    close_plugin(self);
}

/* Called at the first successful read. A successful open alone does not prove that the device
 * works. */
static void device_is_back(input *self, int64_t now_ns)
{
    const channel_table *table = newest_table(self);
    health_reopened(&self->meter, table->channel, table->count);
    push_incident(self, INPUT_IS_BACK, now_ns, now_ns - self->outage.lost_ns, "");
    change_state(self, INPUT_RUNNING, "", now_ns);
}

/* Another device at the same address may have other channels, or the plugin detected them shortly
 * before the loss. */
static mrt_result open_device_again(input *self, error *err)
{
    channel_table table;
    error what = {""};
    mrt_result result = open_plugin(self, &self->outage.logged, &table, err);
    if (result < 0 || channel_table_equal(newest_table(self), &table, &what))
        return result;
    result = adopt_channels(self, &table, err);
    if (result < 0)
        close_plugin(self);
    else
        log_pushf(self->plugin.log, MRT_LOG_WARNING, self->plugin.type->id,
                  "%s: reconnected with %.200s. The new channels are recorded.", self->name,
                  what.text);
    return result;
}

static void reopen_device(input *self)
{
    int64_t now_ns = clock_now_ns();
    if (now_ns < self->outage.next_try_ns) {
        int64_t until_ns = self->outage.next_try_ns;
        if (self->has_unsent && now_ns + unsent_span_ns < until_ns)
            until_ns = now_ns + unsent_span_ns;
        instance_wait_until_ns(&self->plugin, until_ns);
        return;
    }
    error why = {""};
    (void)instance_pop_restart(&self->plugin); /* it is opened now anyway */
    mrt_result result = open_device_again(self, &why);
    if (result >= 0 || is_stopping(self))
        return;
    log_outage_once(self, &why);
    schedule_retry(self);
}

/* ---- restart ---- */

static void restart(input *self)
{
    error why = {""};
    release_pedals(self, clock_now_ns());
    mrt_result result = open_input(self, &why);
    if (result >= 0 || is_stopping(self))
        return;
    if (is_device(self))
        lose_device(self, &why, clock_now_ns());
    else
        fail(self, &why);
}

static bool may_restart(input *self)
{
    if (!instance_pop_restart(&self->plugin))
        return false;
    if (clock_now_ns() >= self->opened_ns + self->patience_first_ns)
        return true;
    atomic_store(&self->plugin.restart_asked, true); /* opened just now: restart later */
    return false;
}

/* ---- live ---- */

static void slow_down(input *self, int64_t began_ns, int64_t now_ns)
{
    self->hasty_reads = now_ns - began_ns < hasty_ns ? self->hasty_reads + 1 : 0;
    if (self->hasty_reads > HASTY_READS)
        instance_wait_until_ns(&self->plugin, now_ns + pause_ns);
}

static void read_live(input *self)
{
    mrt_sample sample;
    error why = {""};
    int64_t began_ns = clock_now_ns(), now_ns;
    int64_t deadline_ns = began_ns + (self->has_unsent ? unsent_span_ns : read_span_ns);
    mrt_result result = read_plugin(self, deadline_ns, &sample, &now_ns, &why);
    if (is_stopping(self) && result < 0)
        return;
    if (is_lost(self) && (result == MRT_OK || result == MRT_TIMEOUT))
        device_is_back(self, now_ns);
    if (result == MRT_OK) {
        self->hasty_reads = 0;
        health_sample(&self->meter, &sample, now_ns);
        deliver(self, &sample);
    } else if (result == MRT_END) {
        end(self);
    } else if (result >= 0) {
        slow_down(self, began_ns, now_ns);
    } else if (is_lost(self)) {
        close_plugin(self);
        log_outage_once(self, &why);
        schedule_retry(self);
    } else if (result == MRT_ERR_IO && is_device(self)) {
        lose_device(self, &why, now_ns);
    } else {
        fail(self, &why);
    }
}

static bool is_live(const input *self)
{
    int32_t state = atomic_load(&self->state);
    return state == INPUT_RUNNING || state == INPUT_LOST;
}

static void *run(void *data)
{
    input *self = data;
    while (!is_stopping(self) && is_live(self)) {
        (void)push_unsent(self);
        if (!self->open)
            reopen_device(self);
        else if (may_restart(self))
            restart(self);
        else
            read_live(self);
        int64_t now_ns = clock_now_ns();
        if (now_ns - self->posted_ns >= post_span_ns)
            post_health(self, now_ns);
    }
    return NULL;
}

/* [frame] Virtual clock: reads until a sample arrives. False: the input has ended. */
static bool read_virtual(input *self, input_record *out)
{
    for (uint32_t fruitless = 0; atomic_load(&self->state) == INPUT_RUNNING; ++fruitless) {
        error why = {""};
        int64_t now_ns;
        if (instance_pop_restart(&self->plugin)) {
            restart(self);
            fruitless += FRUITLESS_READS / 100;
        }
        if (!self->open)
            break;
        mrt_result result = read_plugin(self, INT64_MAX, &out->sample, &now_ns, &why);
        out->version = atomic_load(&self->version);
        if (result == MRT_OK)
            return true;
        if (result >= 0 && result != MRT_END && fruitless >= FRUITLESS_READS)
            result = error_set(&why, MRT_ERR_FORMAT,
                               "%s: too many reads in a row returned no sample", self->name);
        if (result == MRT_END)
            end(self);
        else if (result < 0)
            fail(self, &why);
    }
    return false;
}

/* ==== the functions of input.h ==== */

static const int64_t patience_first_ns = 250 * NS_PER_MS, patience_later_ns = 500 * NS_PER_MS;

bool input_is_recording(const mrt_plugin_type *type, const char *address)
{
    const mrt_input *functions = plugin_interface(type, MRT_INPUT);
    struct stat about;
    return functions->flags & MRT_INPUT_RECORDED ||
           (functions->flags & MRT_INPUT_FILES && stat(address, &about) == 0 &&
            S_ISREG(about.st_mode));
}

void input_name_of(char out[INPUT_NAME], const mrt_plugin_type *type, const char *address)
{
    const char *slash = strrchr(address, '/');
    snprintf(out, INPUT_NAME, "%.31s%s%.63s", plugin_short_name(type), address[0] ? " " : "",
             slash ? slash + 1 : address);
    text_make_printable(out); /* addresses also come from devices */
}

/* If the address is "", the plugin has chosen a device: adds it to the name. */
static void name_found(input *self)
{
    const mrt_devices *devices = plugin_interface(self->plugin.type, MRT_DEVICES);
    mrt_device found = {.address = ""};
    if (self->address[0] || !devices || !devices->current(self->plugin.self, &found))
        return;
    found.address[sizeof found.address - 1] = '\0';
    input_name_of(self->name, self->plugin.type, found.address);
}

/* Appends a suggestion to the plugin's error, because the plugin does not know the installed
 * recordings. */
static void suggest_recording(const char *address, error *err)
{
    const size_t used = err ? strlen(err->text) : 0;
    if (!err || !address[0] || access(address, F_OK) == 0)
        return;
    (void)snprintf(err->text + used, sizeof err->text - used, "%s",
                   installed_suggest(INSTALLED_RECORDING, address).text);
    text_make_printable(err->text);
}

static mrt_result allocate(input *self, error *err)
{
    self->samples = ring_create(sizeof(input_record), INPUT_RING);
    self->incidents = ring_create(sizeof(input_incident), INPUT_INCIDENTS);
    if (!self->samples || !self->incidents)
        return error_set(err, MRT_ERR_MEMORY, "no memory for input %s", self->name);
    return MRT_OK;
}

mrt_result input_create_stoppable(input **out, const mrt_plugin_type *type, const char *address,
                                  const char *params, instance_clock clock, log_queue *log,
                                  const _Atomic bool *stop, error *err)
{
    *out = NULL;
    input *self = calloc(1, sizeof *self);
    const mrt_input *functions = plugin_interface(type, MRT_INPUT);
    const bool is_recording = input_is_recording(type, address);
    char *own_address =
        is_recording ? installed_path(INSTALLED_RECORDING, address) : strdup(address);
    if (!self || !own_address) {
        free(self);
        free(own_address);
        return error_set(err, MRT_ERR_MEMORY, "no memory for input %s", type->id);
    }
    self->address = own_address;
    self->functions = functions;
    self->is_recording = is_recording;
    self->patience_first_ns = patience_first_ns;
    self->patience_later_ns = patience_later_ns;
    health_board_init(&self->board);
    pthread_mutex_init(&self->keeper_lock, NULL);
    mrt_result result = instance_create(&self->plugin, type, clock, log, err);
    if (result < 0)
        goto fail;
    self->plugin.can_restart = true;
    input_name_of(self->name, type, address);
    result = instance_set_list(&self->plugin, params, err);
    if (result >= 0)
        result = allocate(self, err);
    self->plugin.stop = stop;
    if (result >= 0)
        result = open_input(self, err);
    if (result < 0 && is_recording)
        suggest_recording(self->address, err);
    self->plugin.stop = NULL;
    if (result < 0)
        goto fail;
    name_found(self);
    *out = self;
    return MRT_OK;
fail:
    input_destroy(self);
    return result;
}

mrt_result input_create(input **out, const mrt_plugin_type *type, const char *address,
                        const char *params, instance_clock clock, log_queue *log, error *err)
{
    return input_create_stoppable(out, type, address, params, clock, log, NULL, err);
}

void input_destroy(input *self)
{
    if (!self)
        return;
    input_stop(self);
    if (self->open)
        self->functions->close(self->plugin.self);
    instance_destroy(&self->plugin);
    ring_destroy(self->samples);
    ring_destroy(self->incidents);
    pthread_mutex_destroy(&self->keeper_lock);
    free(self->address);
    free(self);
}

const char *input_name(const input *self)
{
    return self->name;
}

const mrt_channel *input_channels_of(const input *self, uint32_t version, uint32_t *out_count)
{
    const channel_table *table = &self->table[version % INPUT_VERSIONS];
    *out_count = table->count;
    return table->channel;
}

const mrt_plugin_type *input_plugin(const input *self)
{
    return self->plugin.type;
}

const mrt_channel *input_channels(const input *self, uint32_t *out_count)
{
    return input_channels_of(self, atomic_load(&self->version), out_count);
}

void input_set_wake(input *self, wake *signal)
{
    self->signal = signal;
}

void input_set_keeper(input *self, input_keeper keeper)
{
    pthread_mutex_lock(&self->keeper_lock);
    self->keeper = keeper;
    pthread_mutex_unlock(&self->keeper_lock);
}

uint32_t input_popped_count(const input *self)
{
    return self->taken_count;
}

void input_set_patience_ns(input *self, int64_t first_ns, int64_t later_ns)
{
    self->patience_first_ns = first_ns;
    self->patience_later_ns = later_ns;
}

mrt_result input_set(input *self, const char *key, const char *value, error *err)
{
    return instance_set_text(&self->plugin, key, value, err);
}

double input_value(const input *self, uint32_t index)
{
    return instance_value(&self->plugin, index);
}

double input_duration_s(input *self)
{
    const mrt_duration *duration = plugin_interface(self->plugin.type, MRT_DURATION);
    if (!self->is_recording || !duration || !self->open)
        return -1.0;
    instance_latch(&self->plugin);
    return 1e-9 * (double)duration->get_ns(self->plugin.self, self->plugin.params);
}

/* Returns the value of a parameter of a recorded input by its name, or `otherwise`. */
static double value_named(const input *self, const char *name, double otherwise)
{
    const mrt_plugin_type *type = self->plugin.type;
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (strcmp(type->params[i].name, name) == 0)
            return instance_value(&self->plugin, i);
    return otherwise;
}

bool input_find_sound(const input *self, input_sound *out)
{
    static const char *const endings[] = {".flac", ".ogg", ".wav"};
    const char *slash = strrchr(self->address, '/'), *dot = strrchr(self->address, '.');
    const bool is_in_time =
        value_named(self, "speed", 1.0) == 1.0 && value_named(self, "loop", 0.0) < 0.5;
    *out = (input_sound){.start_s = value_named(self, "start", 0.0)};
    if (!self->is_recording || !is_in_time || !dot || dot < slash)
        return false;
    for (size_t i = 0; i < sizeof endings / sizeof *endings; ++i) {
        const int length = snprintf(out->path, sizeof out->path, "%.*s%s",
                                    (int)(dot - self->address), self->address, endings[i]);
        if (length > 0 && (size_t)length < sizeof out->path && access(out->path, F_OK) == 0)
            return true;
    }
    return false;
}

mrt_result input_start(input *self, error *err)
{
    if (self->plugin.clock == CLOCK_VIRTUAL || self->has_thread)
        return MRT_OK;
    if (pthread_create(&self->thread, NULL, run, self) != 0)
        return error_set(err, MRT_ERR_MEMORY, "%s: cannot create its thread", self->name);
    self->has_thread = true;
    return MRT_OK;
}

void input_stop(input *self)
{
    if (!self->has_thread)
        return;
    atomic_store(&self->stopping, true);
    instance_stop_waiting(&self->plugin);
    pthread_join(self->thread, NULL);
    self->has_thread = false;
}

bool input_peek(input *self, mrt_sample *out_sample)
{
    input_record record;
    if (self->plugin.clock == CLOCK_REAL) {
        if (!ring_peek(self->samples, &record))
            return false;
    } else {
        if (!self->has_pending)
            self->has_pending = read_virtual(self, &self->pending);
        if (!self->has_pending)
            return false;
        record = self->pending;
    }
    *out_sample = record.sample;
    self->peeked_version = record.version;
    self->peeked_number = record.number;
    return true;
}

void input_pop(input *self)
{
    input_record dropped;
    if (self->plugin.clock == CLOCK_REAL)
        (void)ring_pop(self->samples, &dropped);
    self->has_pending = false;
    self->taken_count = self->peeked_number + 1;
}

uint32_t input_newest_version(const input *self)
{
    return atomic_load(&self->version);
}

uint32_t input_version(const input *self)
{
    return self->peeked_version;
}

/* Reads the state first, because samples from before the end are still in the ring. */
static mrt_result peek_source(void *self, mrt_sample *out, uint32_t *out_version, error *err)
{
    (void)err;
    input *in = self;
    input_state state = input_state_of(in);
    if (input_peek(in, out)) {
        *out_version = in->peeked_version;
        return MRT_OK;
    }
    if (in->plugin.clock == CLOCK_REAL && (state == INPUT_RUNNING || state == INPUT_LOST))
        return MRT_TIMEOUT;
    return MRT_END;
}

static void pop_source(void *self)
{
    input_pop(self);
}

static const mrt_channel *source_channels(void *self, uint32_t version, uint32_t *out_count)
{
    return input_channels_of(self, version, out_count);
}

sample_source input_source(input *self)
{
    return (sample_source){.self = self,
                           .name = self->name,
                           .peek = peek_source,
                           .take = pop_source,
                           .channels = source_channels};
}

bool input_pop_incident(input *self, input_incident *out)
{
    return ring_pop(self->incidents, out);
}

input_state input_state_of(const input *self)
{
    return (input_state)atomic_load(&self->state);
}

uint32_t input_dropped(const input *self)
{
    return atomic_load(&self->dropped);
}

uint32_t input_refused(const input *self)
{
    return atomic_load(&self->refused);
}

void input_health(const input *self, health_report *out)
{
    if (self->plugin.clock == CLOCK_VIRTUAL) {
        *out = (health_report){.state = atomic_load(&self->state)};
        return;
    }
    health_read(&self->board, out);
    health_age(out, clock_now_ns());
}

const char *input_state_name(input_state state)
{
    switch (state) {
    case INPUT_RUNNING:
        return "running";
    case INPUT_ENDED:
        return "over";
    case INPUT_FAILED:
        return "failed";
    case INPUT_LOST:
        return "away";
    }
    return "unknown";
}

bool input_sight(input *self, hand_sight *out)
{
    return instance_sight(&self->plugin, out);
}
