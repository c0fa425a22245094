/* midi.c - the plugin "org.marotte.midi": faders, knobs, pads and keys of a MIDI device or program
 * as named channels (midi_table.h), from a port, a device or a pipe (midi_port.h). Sends values
 * back to motor faders. README.md is the user's guide. */
#include "device_io.h"
#include "midi_port.h"
#include "midi_table.h"
#include "trace.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PARAM_FINE, PARAM_MOTOR, PARAM_PEDALS, PARAM_FORGET, PARAM_COUNT };
enum { ADDRESS = 192, CHUNK = 512, FOLDER = 4000, NOWHERE = -1 };

/* Delay after a new control, so that several new controls change the channels only once. After this
 * number of changes, the channels change only when the user opens the input. */
static const int64_t learn_ns = 300000000;
enum { LEARN_TIMES = 5 };
/* A sender of active sensing messages repeats them every 300 ms. */
static const int64_t sensing_ns = 420000000;
/* An unchanged state is repeated at this interval, so that silence shows a fault. */
static const int64_t repeat_ns = 1000000000;
static const int64_t motor_ns = 10000000;
/* Up to a thousand messages per second each become a sample, even in bunches. Of more messages only
 * the newest values are used. */
enum { BUDGET_MOST = 1000, BUDGET_PER_MS = 2 };

struct mrt_plugin {
    const mrt_host *host;
    bool is_open, is_restarting; /* restarting: the port stays open, so that no message is lost */
    char address[ADDRESS];       /* as opened */
    char found[MIDI_PORT_NAME];  /* device found at the address ""; "": none yet */
    char name[MIDI_PORT_NAME];   /* name of the device; "" for a pipe */
    midi_port port;
    bool is_lost, has_told_loss;
    trace trace;

    midi_parser parser;
    midi_table table;
    float value[MRT_MAX_CHANNELS];       /* of the channels */
    float heard_value[MRT_MAX_CHANNELS]; /* of table.heard */
    float sent_value[MRT_MAX_CHANNELS];  /* back, of table.heard */
    bool is_owed[MRT_MAX_CHANNELS]; /* values sent to the motors, in the order of table.heard */
    int64_t motor_due_ns;
    uint32_t learn_count;
    int64_t learn_due_ns; /* INT64_MAX: no new control */
    bool has_told_full, is_unsaved;

    uint8_t chunk[CHUNK];
    size_t chunk_size, chunk_at;
    midi_event event; /* event that waits until a sample was returned */
    bool has_event;
    int64_t chunk_ns;                /* time of arrival */
    bool is_touched;                 /* something changed since the last sample */
    bool is_moved[MRT_MAX_CHANNELS]; /* of the channels, since the last sample */
    int64_t sensing_due_ns;          /* INT64_MAX: the device sends no active sensing messages */
    bool has_given;
    int64_t last_ns, repeat_due_ns;
    uint32_t sequence, missed;
    int64_t budget, budget_ns;
    bool opened_fine, opened_pedals;
};

/* ---- storing the controls of a device ---- */

/* Returns false if the controls cannot be stored. */
static bool find_file(const mrt_plugin *self, char *out, size_t capacity)
{
    const mrt_folders *folders = self->host->service(self->host, MRT_FOLDERS);
    char folder[FOLDER], name[MIDI_PORT_NAME];
    if (self->name[0] == '\0' || !folders ||
        folders->settings(self->host, folder, sizeof folder) < 0)
        return false;
    (void)snprintf(name, sizeof name, "%s", self->name);
    for (char *c = name; *c; ++c)
        if (!((*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9')))
            *c = '_';
    (void)snprintf(out, capacity, "%s/%s.controls", folder, name);
    return true;
}

static void load_table(mrt_plugin *self)
{
    char path[FOLDER + 96], text[MIDI_TABLE_TEXT];
    if (!find_file(self, path, sizeof path))
        return;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (file < 0)
        return;
    ssize_t size = read(file, text, sizeof text);
    close(file);
    if (size > 0)
        midi_table_read(&self->table, text, (size_t)size);
}

static void save_table(mrt_plugin *self)
{
    char path[FOLDER + 96], fresh[FOLDER + 100], text[MIDI_TABLE_TEXT];
    if (!self->is_unsaved || !find_file(self, path, sizeof path))
        return;
    self->is_unsaved = false;
    (void)snprintf(fresh, sizeof fresh, "%s.new", path);
    size_t size = midi_table_write(&self->table, text, sizeof text);
    int file = open(fresh, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0644);
    bool is_written = file >= 0 && write(file, text, size) == (ssize_t)size;
    if (file >= 0)
        is_written &= close(file) == 0;
    if (!is_written || rename(fresh, path) != 0)
        device_log(
            self->host, MRT_LOG_WARNING,
            "cannot write %.200s (%s): move each control once in the next session to find it again",
            path, strerror(errno));
}

/* ---- opening ---- */

static void close_port(mrt_plugin *self)
{
    midi_port_close(&self->port);
    trace_close(&self->trace);
}

static void input_close(mrt_plugin *self)
{
    save_table(self);
    if (!self->is_restarting)
        close_port(self);
    self->is_open = false;
}

static void build_channels(mrt_plugin *self)
{
    midi_table_build(&self->table, self->opened_pedals);
    for (uint32_t i = 0; i < self->table.count; ++i) {
        int heard = midi_table_find_received(&self->table, self->table.control[i]);
        self->value[i] = heard >= 0 ? self->heard_value[heard] : 0.0f;
        self->is_moved[i] = false;
    }
    self->learn_due_ns = INT64_MAX;
}

static void forget(mrt_plugin *self)
{
    self->table.heard_count = 0;
    self->learn_count = 0;
    self->has_told_full = self->has_given = false;
    memset(self->heard_value, 0, sizeof self->heard_value);
    memset(self->sent_value, 0, sizeof self->sent_value);
    memset(self->is_owed, 0, sizeof self->is_owed);
}

/* Opens another device; the table of the previous one does not apply. */
static mrt_result open_afresh(mrt_plugin *self, const char *address)
{
    char reason[MIDI_REASON] = "", before[MIDI_PORT_NAME];
    const bool is_same = strcmp(self->address, address) == 0;
    close_port(self);
    (void)snprintf(before, sizeof before, "%s", self->name);
    if (!is_same)
        self->found[0] = '\0';
    (void)snprintf(self->address, sizeof self->address, "%s", address);
    trace_open(&self->trace, self->host, "midi");
    if (!midi_port_open(&self->port, address[0] ? address : self->found, self->name, reason)) {
        close_port(self);
        device_log(self->host, MRT_LOG_ERROR, "%s", reason);
        return MRT_ERR_IO;
    }
    if (address[0] == '\0')
        (void)snprintf(self->found, sizeof self->found, "%s", self->name);
    if (!is_same || strcmp(before, self->name) != 0) {
        forget(self);
        load_table(self);
    }
    if (self->port.seq && self->name[0] == '\0')
        device_log(
            self->host, MRT_LOG_INFO,
            "no MIDI device found: plug one in, or connect a program to the port \"marotte\"");
    self->chunk_size = self->chunk_at = 0;
    self->has_event = false;
    midi_parser_init(&self->parser, self->opened_fine);
    return MRT_OK;
}

static mrt_result input_open(mrt_plugin *self, const char *address, const double *params)
{
    const bool goes_on =
        self->is_restarting && strcmp(self->address, address) == 0 && self->port.descriptor >= 0;
    self->is_restarting = false;
    self->opened_fine = self->parser.is_fine = params[PARAM_FINE] > 0.5;
    self->opened_pedals = params[PARAM_PEDALS] > 0.5;
    if (!goes_on) {
        mrt_result result = open_afresh(self, address);
        if (result < 0)
            return result;
    }
    build_channels(self);
    self->is_open = true;
    self->is_touched = self->has_given;
    self->is_lost = self->has_told_loss = false;
    self->sensing_due_ns = INT64_MAX;
    self->last_ns = self->budget_ns = self->host->now_ns(self->host);
    self->repeat_due_ns = self->last_ns + repeat_ns;
    self->budget = BUDGET_MOST;
    self->chunk_ns = self->last_ns;
    return MRT_OK;
}

static const mrt_channel *input_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->is_open ? self->table.count : 0;
    return self->table.channel;
}

static void restart(mrt_plugin *self)
{
    self->is_restarting = true;
    self->learn_due_ns = INT64_MAX;
    self->host->request_restart(self->host);
}

/* ---- events ---- */

/* Returns true if the pending changes must become a sample before this event. */
static bool is_next_move(const mrt_plugin *self, const midi_event *event)
{
    const int channel = event->kind < MIDI_RELEASE
                            ? midi_table_find(&self->table, midi_control_of(event))
                            : NOWHERE;
    return event->kind == MIDI_RELEASE ? self->is_touched : channel >= 0 && self->is_moved[channel];
}

static void set_channel(mrt_plugin *self, int channel, float value)
{
    self->value[channel] = value;
    self->is_moved[channel] = true;
    self->is_touched = true;
}

static void learn(mrt_plugin *self, midi_control control)
{
    char name[MIDI_NAME];
    midi_control_name(control, name);
    if (self->learn_count == LEARN_TIMES) {
        device_log(self->host, MRT_LOG_WARNING,
                   "%s is a new control. It becomes a channel when the input is opened again",
                   name);
        return;
    }
    self->learn_due_ns = self->chunk_ns + learn_ns;
    device_log(self->host, MRT_LOG_DEBUG, "new control: %s", name);
}

static void move(mrt_plugin *self, const midi_event *event)
{
    const midi_control control = midi_control_of(event);
    const int channel = midi_table_find(&self->table, control);
    int heard = midi_table_find_received(&self->table, control);
    if (heard < 0 && midi_table_add(&self->table, control)) {
        heard = (int)self->table.heard_count - 1;
        self->sent_value[heard] = NAN;
        self->is_unsaved = true;
        if (channel < 0)
            learn(self, control);
    } else if (heard < 0 && !self->has_told_full) {
        self->has_told_full = true;
        device_log(self->host, MRT_LOG_WARNING,
                   "the limit of %u controls is reached: set forget=1 to start again",
                   self->table.heard_count);
    }
    if (heard >= 0) {
        self->heard_value[heard] = event->value;
        self->is_owed[heard] = event->kind == MIDI_CONTROLLER || event->kind == MIDI_BEND;
    }
    if (channel >= 0)
        set_channel(self, channel, event->value);
}

/* Releases notes and pedals of one MIDI channel or of all. */
static void release(mrt_plugin *self, uint8_t midi_channel)
{
    for (uint32_t i = 0; i < self->table.count; ++i) {
        const midi_kind kind = (midi_kind)(self->table.control[i] >> 24);
        const uint8_t of = self->table.control[i] >> 16 & 15;
        const uint32_t semantic = self->table.channel[i].semantic;
        const bool is_pedal = semantic >= MRT_CH_PEDAL && semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS;
        const int heard = midi_table_find_received(&self->table, self->table.control[i]);
        if ((kind != MIDI_NOTE && !is_pedal) || self->value[i] == 0.0f ||
            (midi_channel != MIDI_ALL_CHANNELS && midi_channel != of))
            continue;
        set_channel(self, (int)i, 0.0f);
        if (heard >= 0)
            self->heard_value[heard] = 0.0f;
    }
}

static void take_event(mrt_plugin *self, const midi_event *event)
{
    const midi_event rate = {.kind = MIDI_TIMECODE_RATE, .value = event->rate};
    if (event->kind == MIDI_TIMECODE)
        move(self, &rate);
    if (event->kind == MIDI_SENSING)
        self->sensing_due_ns = self->chunk_ns + sensing_ns;
    else if (event->kind == MIDI_RELEASE)
        release(self, event->channel);
    else
        move(self, event);
}

/* ---- samples ---- */

static mrt_result give(mrt_plugin *self, int64_t time_ns, mrt_sample *out)
{
    memset(out, 0, sizeof *out);
    self->last_ns = out->time_ns = time_ns > self->last_ns ? time_ns : self->last_ns;
    self->repeat_due_ns = self->last_ns + repeat_ns;
    self->sequence += self->missed + self->has_given;
    self->missed = 0;
    self->has_given = true;
    self->is_touched = false;
    memset(self->is_moved, 0, sizeof self->is_moved);
    out->sequence = self->sequence;
    out->count = self->table.count;
    memcpy(out->value, self->value, out->count * sizeof *out->value);
    return MRT_OK;
}

/* Returns the number of samples allowed now, to limit a flood of messages. */
static int64_t budget_at(mrt_plugin *self, int64_t now_ns)
{
    const int64_t gained = (now_ns - self->budget_ns) / 1000000 * BUDGET_PER_MS;
    if (gained > 0) {
        self->budget = self->budget + gained < BUDGET_MOST ? self->budget + gained : BUDGET_MOST;
        self->budget_ns = now_ns;
    }
    return self->budget;
}

static bool afford(mrt_plugin *self)
{
    if (budget_at(self, self->chunk_ns) <= 0) {
        self->missed += 1;
        return false;
    }
    self->budget -= 1;
    return true;
}

/* Finds the next event in the received bytes. Returns false if there are no more. */
static bool find_event(mrt_plugin *self)
{
    while (!self->has_event && self->chunk_at < self->chunk_size)
        self->has_event =
            midi_parser_add_byte(&self->parser, self->chunk[self->chunk_at++], &self->event);
    return self->has_event;
}

/* Processes the received bytes. Returns true if a sample is due; the rest follows later. */
static bool take_chunk(mrt_plugin *self)
{
    while (find_event(self)) {
        if (is_next_move(self, &self->event) && afford(self))
            return true;
        self->has_event = false;
        take_event(self, &self->event);
    }
    return self->is_touched && afford(self);
}

/* ---- motors ---- */

static size_t write_message(midi_control control, float value, bool is_fine, uint8_t *out)
{
    const uint8_t channel = control >> 16 & 15, number = control & 127;
    if (control >> 24 == MIDI_BEND) {
        const long bits = lroundf((value + 1.0f) * 0.5f * 16383.0f);
        out[0] = 0xe0 | channel;
        out[1] = (uint8_t)(bits & 127);
        out[2] = (uint8_t)(bits >> 7 & 127);
        return 3;
    }
    const long bits = lroundf(value * (is_fine && number < 32 ? 16383.0f : 127.0f));
    out[0] = 0xb0 | channel;
    out[1] = number;
    out[2] = (uint8_t)(is_fine && number < 32 ? bits >> 7 & 127 : bits & 127);
    if (!is_fine || number >= 32)
        return 3;
    out[3] = out[0];
    out[4] = number + 32;
    out[5] = (uint8_t)(bits & 127);
    return 6;
}

/* Sends the newest value of each fader back, because otherwise its motor pulls it to its old
 * position. An echo of the same value is not sent again, so that two programs do not answer each
 * other forever. */
static void drive_motors(mrt_plugin *self, int64_t now_ns)
{
    if (!self->port.can_write || now_ns < self->motor_due_ns)
        return;
    self->motor_due_ns = now_ns + motor_ns;
    for (uint32_t i = 0; i < self->table.heard_count; ++i) {
        uint8_t message[6];
        if (!self->is_owed[i])
            continue;
        if (self->heard_value[i] != self->sent_value[i]) {
            size_t size = write_message(self->table.heard[i], self->heard_value[i],
                                        self->opened_fine, message);
            if (!midi_port_write(&self->port, message, size))
                return; /* not ready: try again later */
            trace_sent(&self->trace, now_ns, message, size);
            self->sent_value[i] = self->heard_value[i];
        }
        self->is_owed[i] = false;
    }
}

static bool has_motor_due(const mrt_plugin *self, const double *params)
{
    if (params[PARAM_MOTOR] < 0.5 || !self->port.can_write)
        return false;
    for (uint32_t i = 0; i < self->table.heard_count; ++i)
        if (self->is_owed[i])
            return true;
    return false;
}

/* ---- reading ---- */

static mrt_result lose(mrt_plugin *self, mrt_sample *out)
{
    self->is_lost = true;
    self->is_restarting = false; /* do not store values of a lost device */
    release(self, MIDI_ALL_CHANNELS);
    if (self->is_touched)
        return give(self, self->host->now_ns(self->host), out);
    if (!self->has_told_loss)
        device_log(self->host, MRT_LOG_ERROR, "%.100s was disconnected: plug it in again",
                   self->name[0] ? self->name : self->address);
    self->has_told_loss = true;
    return MRT_ERR_IO;
}

/* Returns false if the device was lost. */
static bool receive(mrt_plugin *self)
{
    int size = midi_port_read(&self->port, self->chunk, sizeof self->chunk);
    self->chunk_at = 0;
    self->chunk_size = size > 0 ? (size_t)size : 0;
    if (size <= 0)
        return size == 0;
    self->chunk_ns = self->host->now_ns(self->host);
    trace_received(&self->trace, self->chunk_ns, self->chunk, self->chunk_size);
    if (self->sensing_due_ns != INT64_MAX)
        self->sensing_due_ns = self->chunk_ns + sensing_ns;
    return true;
}

static void follow_params(mrt_plugin *self, const double *params)
{
    if (params[PARAM_FORGET] > 0.5) {
        forget(self);
        self->is_unsaved = true;
        restart(self);
    }
    if ((params[PARAM_FINE] > 0.5) != self->opened_fine ||
        (params[PARAM_PEDALS] > 0.5) != self->opened_pedals)
        restart(self);
}

/* Returns true if a sample was returned or reading ended; out_result has the result. */
static bool act(mrt_plugin *self, int64_t now_ns, mrt_sample *out)
{
    if (now_ns >= self->sensing_due_ns) {
        self->sensing_due_ns = INT64_MAX;
        device_log(self->host, MRT_LOG_WARNING,
                   "%.100s stopped its active sensing messages: its notes and pedals are released",
                   self->name[0] ? self->name : self->address);
        release(self, MIDI_ALL_CHANNELS);
    }
    if (now_ns >= self->learn_due_ns) {
        self->learn_count += 1;
        restart(self);
    }
    bool is_due = self->is_touched ? budget_at(self, now_ns) > 0
                                   : self->has_given && now_ns >= self->repeat_due_ns;
    if (is_due) {
        self->budget -= self->is_touched;
        (void)give(self, now_ns, out);
    }
    return is_due;
}

static int64_t next_due_ns(const mrt_plugin *self, const double *params)
{
    int64_t due_ns = device_earlier_ns(self->sensing_due_ns, self->learn_due_ns);
    if (self->is_touched) /* but not yet allowed by the budget */
        due_ns = device_earlier_ns(due_ns, self->budget_ns + 1000000);
    if (self->has_given)
        due_ns = device_earlier_ns(due_ns, self->repeat_due_ns);
    return has_motor_due(self, params) ? device_earlier_ns(due_ns, self->motor_due_ns) : due_ns;
}

static mrt_result input_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (!self->is_open)
        return MRT_ERR_IO;
    if (!self->is_restarting)
        follow_params(self, params);
    for (;;) {
        if (self->is_lost)
            return lose(self, out_sample);
        if (take_chunk(self))
            return give(self, self->chunk_ns, out_sample);
        if (!receive(self)) {
            self->is_lost = true;
            continue;
        }
        int64_t now_ns = self->host->now_ns(self->host);
        if (has_motor_due(self, params))
            drive_motors(self, now_ns);
        if (self->chunk_size > 0) {
            if (now_ns >= deadline_ns) /* a flood: let the host do other work */
                return MRT_TIMEOUT;
            continue;
        }
        if (act(self, now_ns, out_sample))
            return MRT_OK;
        if (now_ns >= deadline_ns)
            return MRT_TIMEOUT;
        const int64_t until_ns = device_earlier_ns(deadline_ns, next_due_ns(self, params));
        if (device_wait(self->port.descriptor, device_earlier_ns(until_ns - now_ns, repeat_ns)) < 0)
            self->is_lost = true;
    }
}

/* ---- devices ---- */

static uint32_t list_devices(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    (void)self;
    return midi_port_list(out, capacity);
}

static bool current_device(mrt_plugin *self, mrt_device *out)
{
    if (!self->is_open || self->is_lost)
        return false;
    *out = (mrt_device){.state = MRT_DEVICE_READY};
    (void)snprintf(out->address, sizeof out->address, "%s",
                   self->address[0] ? self->address : self->found);
    (void)snprintf(out->name, sizeof out->name, "%s", self->name[0] ? self->name : "MIDI");
    return true;
}

/* ---- the type ---- */

static mrt_plugin *create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    midi_port_init(&self->port);
    self->trace.file = -1;
    return self;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    self->is_restarting = false;
    input_close(self);
    free(self);
}

static const char *const switch_label[] = {"off", "on", NULL};
static const mrt_param params_table[PARAM_COUNT] = {
    [PARAM_FINE] = {1, MRT_PARAM_STEPPED, "fine", "MIDI", "",
                    "Use controllers 32 to 63 as the low bits of 0 to 31, for 14-bit faders", 0, 1,
                    0, switch_label},
    [PARAM_MOTOR] = {2, MRT_PARAM_STEPPED, "motor", "MIDI", "",
                     "Send values back to the faders, for motor faders", 0, 1, 0, switch_label},
    [PARAM_PEDALS] = {3, MRT_PARAM_STEPPED, "pedals", "MIDI", "",
                      "Use the pedals of a piano (controllers 64, 66, 67) as pedals 1 to 3", 0, 1,
                      0, switch_label},
    [PARAM_FORGET] = {4, MRT_PARAM_TRIGGER, "forget", "MIDI", "",
                      "Forget the controls found on this device", 0, 1, 0, NULL},
};

static const mrt_input input = {input_open, input_channels, input_read, input_close, 0};
static const mrt_devices devices = {list_devices, current_device};
static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params_table,
    interfaces,
    "org.marotte.midi",
    "MIDI",
    MAROTTE_VERSION,
    "Faders, knobs, pads and keys: a MIDI port by name, a device (midi:/dev/snd/midiC1D0), a pipe",
    create,
    destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
