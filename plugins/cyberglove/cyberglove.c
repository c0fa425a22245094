/* cyberglove.c - the input plugin "org.marotte.cyberglove": a CyberGlove of 18 or 22 sensors, over
 * a serial port or the network. Returns raw values; the calibration converts them. */
#include <marotte/plugin.h>

#include "device_io.h"
#include "glove_drive.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In the order of the table of parameters. */
enum {
    PARAM_BAUD = 0,
    PARAM_RATE,
    PARAM_MODE,
    PARAM_STREAM,
    PARAM_STAMPS,
    PARAM_HAND,
    PARAM_SWITCH,
    PARAM_FILTER,
    PARAM_PATIENCE,
    PARAM_COUNT
};

enum { NAME_LENGTH = 32 };
/* Words have 12 bits, bytes 8. This scales both to the same "count". */
static const float count_per_word = 1.0f / 16.0f;
static const uint32_t bauds[] = {115200, 57600, 38400, 19200, 9600, 4800};
static const int64_t lost_pause_ns = 100000000;

struct mrt_plugin {
    const mrt_host *host;
    glove_drive drive;
    glove_memory memory;
    bool is_open, asked_to_restart, has_told_loss;
    double opened_with[PARAM_COUNT];
    uint32_t sensor_count, channel_count; /* the switch, if it is a channel, is the last one */
    mrt_channel channel[MRT_MAX_CHANNELS];
    char name[MRT_MAX_CHANNELS][NAME_LENGTH];
    mrt_sample last;
    bool has_last;
};

/* ---- channels ---- */

static void add_channel(mrt_plugin *self, const char *name, const char *unit, uint32_t semantic,
                        float min, float max)
{
    uint32_t hand = self->drive.unit.hand, i = self->channel_count++;
    snprintf(self->name[i], NAME_LENGTH, "%s.%s", hand == MRT_LEFT ? "left" : "right", name);
    self->channel[i] = (mrt_channel){self->name[i], unit, semantic, hand, min, max};
}

static void describe_channels(mrt_plugin *self)
{
    const glove_unit *unit = &self->drive.unit;
    bool is_words = unit->layout.form == GLOVE_WORDS;
    uint32_t pedal = (uint32_t)self->opened_with[PARAM_SWITCH];
    self->channel_count = 0;
    for (uint32_t i = 0; i < unit->sensors.count; ++i)
        add_channel(self, glove_sensor_name(unit->sensors.semantic[i]), "count",
                    unit->sensors.semantic[i], is_words ? count_per_word : 1.0f, 255.0f);
    self->sensor_count = unit->sensors.count;
    if (pedal > 0 && unit->layout.has_status)
        add_channel(self, "switch", "1", MRT_CH_PEDAL + pedal - 1, 0.0f, 1.0f);
}

static const mrt_channel *glove_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->channel_count;
    return self->channel;
}

/* ---- opening ---- */

static int choice(const double *params, int index, int most)
{
    double value = params[index];
    return value > 0 ? (value < most ? (int)value : most) : 0;
}

static double within(double value, double low, double high)
{
    if (!(value > low))
        return low;
    return value < high ? value : high;
}

/* The period of a glove has two words, so the slowest rate is once per second. */
static double rate_of(double hz)
{
    return hz > 0 ? within(hz, 1.0, 400.0) : 0.0;
}

static glove_settings settings_of(const double *params)
{
    return (glove_settings){
        .baud = bauds[choice(params, PARAM_BAUD, (int)(sizeof bauds / sizeof *bauds) - 1)],
        .rate_hz = rate_of(params[PARAM_RATE]),
        .mode = choice(params, PARAM_MODE, GLOVE_MODE_POLLED),
        .form = choice(params, PARAM_STREAM, 1) ? GLOVE_WORDS : GLOVE_BYTES,
        .stamps = choice(params, PARAM_STAMPS, GLOVE_STAMPS_OFF),
        .hand = choice(params, PARAM_HAND, GLOVE_HAND_RIGHT),
        .filter = choice(params, PARAM_FILTER, GLOVE_FILTER_ON),
        .patience = within(params[PARAM_PATIENCE], 0.02, 1.0)};
}

static void report_limits(glove_drive *drive)
{
    const glove_unit *unit = &drive->unit;
    const glove_settings *settings = &drive->settings;
    const char *name = drive->port.name;
    if (drive->port.latency_ms > 1)
        glove_drive_log_once(
            drive, GLOVE_LOGGED_LATENCY, MRT_LOG_WARNING,
            "%.60s: the serial adapter delays bytes by %u ms: run \"echo 1 | sudo tee %.100s\"",
            name, drive->port.latency_ms, drive->port.latency_file);
    if (unit->refused[0])
        glove_drive_log_once(
            drive, GLOVE_LOGGED_REFUSED, MRT_LOG_INFO,
            "%.60s: this glove does not support the commands %s: continues without "
            "them (D time stamps, U switch, T rate, F filter)",
            name, unit->refused);
    if (unit->readiness != 3)
        glove_drive_log_once(drive,
                             unit->readiness & 2 ? GLOVE_LOGGED_READINESS
                                                 : GLOVE_LOGGED_READINESS | GLOVE_LOGGED_UNPLUGGED,
                             MRT_LOG_WARNING, "%.60s: the box reports that its glove is %s", name,
                             unit->readiness & 2 ? "not ready" : "not plugged in");
    if (!unit->reported_hand && settings->hand == GLOVE_HAND_AUTO)
        glove_drive_log_once(
            drive, GLOVE_LOGGED_HAND, MRT_LOG_WARNING,
            "%.60s: the glove does not report its hand: a right hand is assumed. For "
            "a left one set hand=left",
            name);
    if (unit->asked_hz > 0 && unit->asked_hz < settings->rate_hz - 0.5)
        glove_drive_log_once(drive, GLOVE_LOGGED_LINE, MRT_LOG_WARNING,
                             "%.60s: at %u baud it can send only %.0f records per second, not %.0f",
                             name, settings->baud, unit->asked_hz, settings->rate_hz);
}

static void report_model(glove_drive *drive)
{
    const glove_unit *unit = &drive->unit;
    char rate[40] = "its own rate";
    if (unit->period_ns > 0)
        snprintf(rate, sizeof rate, "%.1f Hz", 1e9 / (double)unit->period_ns);
    glove_drive_log_once(drive, 0, MRT_LOG_INFO, "%.60s: CyberGlove, %s hand, %u sensors, %s%s, %s",
                         drive->port.name, unit->hand == MRT_LEFT ? "left" : "right",
                         unit->sensors.count, rate, unit->is_polled ? " (polled)" : "",
                         unit->layout.has_time ? "its own time stamps" : "times of arrival");
    report_limits(drive);
}

static void glove_close(mrt_plugin *self)
{
    if (!self->is_open)
        return;
    glove_drive_end(&self->drive);
    trace_close(&self->drive.trace);
    self->is_open = false;
}

static mrt_result plugin_open(mrt_plugin *self, const char *address, const double *params)
{
    glove_close(self);
    glove_error why = {""};
    memcpy(self->opened_with, params, sizeof self->opened_with);
    self->drive.settings = settings_of(params);
    trace_open(&self->drive.trace, self->host, "cyberglove");
    mrt_result result =
        glove_drive_open(&self->drive, address ? address : "", "", &self->memory, &why);
    if (result < 0) {
        trace_note(&self->drive.trace, device_clock_ns(), why.text);
        trace_close(&self->drive.trace);
        self->host->log(self->host, MRT_LOG_ERROR, why.text);
        return result;
    }
    self->is_open = true;
    self->asked_to_restart = false;
    self->has_told_loss = false;
    self->has_last = false;
    describe_channels(self);
    report_model(&self->drive);
    return MRT_OK;
}

/* ---- reading ---- */

static void fill_sample(mrt_plugin *self, const glove_record *record, int64_t time_ns,
                        mrt_sample *out)
{
    float scale = self->drive.unit.layout.form == GLOVE_WORDS ? count_per_word : 1.0f;
    memset(out, 0, sizeof *out);
    out->time_ns = time_ns;
    out->sequence = self->has_last ? self->last.sequence + 1 + record->lost : 0;
    out->count = self->channel_count;
    for (uint32_t i = 0; i < self->sensor_count; ++i)
        out->value[i] = scale * (float)record->sensor[i];
    if (self->channel_count > self->sensor_count)
        out->value[self->sensor_count] = glove_drive_switch(&self->drive) ? 1.0f : 0.0f;
    self->last = *out;
    self->has_last = true;
}

/* Releases the switch, so that it does not stay down after the glove is lost. */
static bool release_switch(mrt_plugin *self, mrt_sample *out)
{
    if (!self->has_last || self->channel_count == self->sensor_count ||
        !(self->last.value[self->sensor_count] > 0.5f))
        return false;
    int64_t now_ns = self->host->now_ns(self->host);
    self->last.value[self->sensor_count] = 0.0f;
    self->last.sequence += 1;
    self->last.time_ns = now_ns > self->last.time_ns ? now_ns : self->last.time_ns;
    *out = self->last;
    return true;
}

/* Returns an error while the glove is lost. The error may come one read after the loss. Waits, so
 * that a host that keeps reading does not spin. */
static mrt_result stay_lost(mrt_plugin *self, int64_t deadline_ns)
{
    if (!self->has_told_loss) {
        self->has_told_loss = true;
        self->host->log(self->host, MRT_LOG_ERROR, self->drive.loss.text);
        return MRT_ERR_IO;
    }
    int64_t pause_ns = self->host->now_ns(self->host) + lost_pause_ns;
    self->host->wait_until_ns(self->host, deadline_ns < pause_ns ? deadline_ns : pause_ns);
    return MRT_ERR_IO;
}

static void follow_params(mrt_plugin *self, const double *params)
{
    if (self->asked_to_restart || memcmp(params, self->opened_with, sizeof self->opened_with) == 0)
        return;
    self->asked_to_restart = true;
    self->host->request_restart(self->host);
}

static mrt_result glove_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (!self->is_open)
        return MRT_END;
    if (self->drive.is_lost)
        return stay_lost(self, deadline_ns);
    follow_params(self, params);
    glove_record record;
    int64_t time_ns = 0;
    mrt_result result = glove_drive_read(&self->drive, deadline_ns, &record, &time_ns);
    if (result < 0)
        return release_switch(self, out_sample) ? MRT_OK : stay_lost(self, deadline_ns);
    if (result == MRT_OK)
        fill_sample(self, &record, time_ns, out_sample);
    return result;
}

/* ---- devices ---- */

static void describe_device(const glove_found *port, mrt_device *out)
{
    char holder[128];
    *out = (mrt_device){.state = MRT_DEVICE_UNSURE};
    glove_drive_address(port, out->address, sizeof out->address);
    snprintf(out->name, sizeof out->name, "%.50s",
             port->product[0] ? port->product : "serial port");
    if (!glove_find_can_open(port->path)) {
        out->state = MRT_DEVICE_DENIED;
        glove_find_advice(port->path, out->advice, sizeof out->advice);
    } else if (glove_find_holder(port->path, holder, sizeof holder)) {
        out->state = MRT_DEVICE_BUSY;
        snprintf(out->advice, sizeof out->advice, "%s is in use by %s: close that program first",
                 port->path, holder);
    } else {
        snprintf(out->advice, sizeof out->advice,
                 "a glove may be connected to %s: to test it, open cyberglove:%s", port->path,
                 out->address);
    }
}

static bool glove_current(mrt_plugin *self, mrt_device *out)
{
    if (!self->is_open)
        return false;
    const glove_found *port = &self->memory.port;
    *out = (mrt_device){.state = MRT_DEVICE_READY};
    if (self->drive.port.baud == 0)
        snprintf(out->address, sizeof out->address, "%s", self->memory.address);
    else
        glove_drive_address(port, out->address, sizeof out->address);
    snprintf(out->name, sizeof out->name, "CyberGlove, %s hand, %u sensors",
             self->drive.unit.hand == MRT_LEFT ? "left" : "right", self->sensor_count);
    return true;
}

static uint32_t glove_list(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    glove_found ports[GLOVE_PORTS_MAX];
    uint32_t count = glove_find_ports("", ports, GLOVE_PORTS_MAX);
    for (uint32_t i = 0; i < count && i < capacity; ++i) {
        bool is_mine = self->is_open && strcmp(ports[i].path, self->memory.port.path) == 0;
        if (!is_mine || !glove_current(self, &out[i]))
            describe_device(&ports[i], &out[i]);
    }
    return count;
}

/* ---- the type ---- */

static mrt_plugin *glove_create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->drive.host = host;
    self->drive.port.file = -1;
    self->drive.trace.file = -1;
    return self;
}

static void glove_destroy(mrt_plugin *self)
{
    if (!self)
        return;
    glove_close(self);
    free(self);
}

static const char *const baud_label[] = {"115200", "57600", "38400", "19200", "9600", "4800", NULL};
static const char *const mode_label[] = {"auto", "stream", "polled", NULL};
static const char *const stream_label[] = {"8 bit", "16 bit", NULL};
static const char *const stamps_label[] = {"auto", "on", "off", NULL};
static const char *const hand_label[] = {"auto", "left", "right", NULL};
static const char *const switch_label[] = {"none",    "pedal 1", "pedal 2",
                                           "pedal 3", "pedal 4", NULL};
static const char *const filter_label[] = {"as it is", "off", "on", NULL};

static const mrt_param params[PARAM_COUNT] = {
    [PARAM_BAUD] = {1, MRT_PARAM_STEPPED, "baud", "Line", "",
                    "Speed of the serial line; old boxes are often set to 38400", 0, 5, 0,
                    baud_label},
    [PARAM_RATE] = {2, 0, "rate", "Glove", "Hz",
                    "Measurements per second, at least 1; 0: the glove's own rate", 0, 400, 150,
                    NULL},
    [PARAM_MODE] = {3, MRT_PARAM_STEPPED, "mode", "Glove", "",
                    "Whether the glove streams records or is polled for each", 0, 2, 0, mode_label},
    [PARAM_STREAM] = {4, MRT_PARAM_STEPPED, "stream", "Glove", "",
                      "Format of the records; 16 bit is the CyberGlove III's own stream", 0, 1, 0,
                      stream_label},
    [PARAM_STAMPS] = {5, MRT_PARAM_STEPPED, "time stamps", "Glove", "",
                      "Use the times of the glove's clock", 0, 2, 0, stamps_label},
    [PARAM_HAND] =
        {6, MRT_PARAM_STEPPED, "hand", "Glove", "",
         "Hand of the glove to look for, or of the named glove; auto: as the glove reports", 0, 2,
         0, hand_label},
    [PARAM_SWITCH] = {7, MRT_PARAM_STEPPED, "switch", "Glove", "",
                      "Pedal number of the switch at the wrist", 0, 4, 0, switch_label},
    [PARAM_FILTER] = {8, MRT_PARAM_STEPPED, "filter", "Glove", "",
                      "The glove's own low-pass filter", 0, 2, 0, filter_label},
    [PARAM_PATIENCE] = {9, MRT_PARAM_HIDDEN, "patience", "Line", "times", "Factor for all timeouts",
                        0.02, 1, 1, NULL},
};

static const mrt_input input = {plugin_open, glove_channels, glove_read, glove_close, 0};
static const mrt_devices devices = {glove_list, glove_current};

static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params,
    interfaces,
    "org.marotte.cyberglove",
    "CyberGlove",
    MAROTTE_VERSION,
    "CyberGloves of 18 or 22 sensors, over a serial port or the network",
    glove_create,
    glove_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
