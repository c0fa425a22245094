/* pedal.c - the input plugin "org.marotte.pedal": foot pedals on USB, read without the kernel's
 * keyboard or joystick driver in between. */
#include "pedal.h"
#include "decode.h"
#include "listing.h"
#include "opening.h"
#include "teach.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What has not changed is said again so often that silence means trouble. */
static const int64_t repeat_ns = 1000000000;

void pedal_say(const mrt_plugin *self, int32_t level, const char *format, ...)
{
    char text[PEDAL_TEXT];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    self->host->log(self->host, level, text);
}

bool pedal_has_usb(mrt_plugin *self)
{
    if (!self->usb)
        self->usb = usb_create(self->host);
    if (!self->usb)
        pedal_say(self, MRT_LOG_ERROR,
                  "USB cannot be used: is /dev/bus/usb there, and is there memory?");
    return self->usb != NULL;
}

static const mrt_channel *pedal_channels(mrt_plugin *self, uint32_t *out_count)
{
    *out_count = self->channel_count;
    return self->channels;
}

/* ---- samples ---- */

static mrt_result give(mrt_plugin *self, int64_t time_ns, mrt_sample *out)
{
    if (time_ns > self->last_time_ns)
        self->last_time_ns = time_ns;
    self->repeat_due_ns = time_ns + repeat_ns;
    memset(out, 0, sizeof *out);
    out->time_ns = self->last_time_ns;
    out->sequence = self->sequence++;
    out->count = self->channel_count;
    for (uint32_t i = 0; i < self->layout.switch_count; ++i)
        out->value[i] = self->debounce.shown[i];
    return MRT_OK;
}

/* First the release of whatever was held; then the news. */
static mrt_result give_loss(mrt_plugin *self, mrt_sample *out)
{
    if (!self->has_released) {
        self->has_released = true;
        teach_lose(self);
        memset(self->value, 0, sizeof self->value);
        debounce_reset(&self->debounce);
        return give(self, self->host->now_ns(self->host), out);
    }
    if (!self->has_told_loss) {
        self->has_told_loss = true;
        trace_note(&self->trace, self->host->now_ns(self->host), "gone");
        pedal_say(self, MRT_LOG_ERROR, "%.60s at usb:%s went away (%s): plug it in again",
                  self->name, self->device.path, usb_failure_text(self->usb));
    }
    return MRT_ERR_IO;
}

static int64_t window_ns(const double *params)
{
    double ms = params[PARAM_DEBOUNCE];
    ms = ms > 5.0 ? ms : 5.0;
    return (int64_t)((ms < 15.0 ? ms : 15.0) * 1e6);
}

/* True: something changed. While switches are taught, they do nothing else. */
static bool take_report(mrt_plugin *self, const double *params)
{
    const usb_report *report = &self->report;
    self->has_report = false;
    trace_received(&self->trace, report->time_ns, report->bytes, report->size);
    if (learn_is_running(&self->learn)) {
        teach_report(self, report);
        return false;
    }
    return decode_report(&self->layout, report->bytes, report->size, self->value) &&
           debounce_take(&self->debounce, self->value, self->analogue, report->time_ns,
                         window_ns(params));
}

/* Gives what was held back until a time that has come; true: a sample was written. */
static bool give_settled(mrt_plugin *self, const double *params, int64_t time_ns, mrt_sample *out)
{
    int64_t due_ns = debounce_due_ns(&self->debounce);
    if (due_ns > time_ns || !debounce_settle(&self->debounce, due_ns, window_ns(params)))
        return false;
    (void)give(self, due_ns, out);
    return true;
}

static int64_t earliest(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* When there is something to do even if the device stays silent. */
static int64_t next_due_ns(const mrt_plugin *self)
{
    int64_t due = earliest(debounce_due_ns(&self->debounce), self->repeat_due_ns);
    return learn_is_running(&self->learn) ? earliest(due, self->learn.until_ns) : due;
}

/* The report that has come; MRT_TIMEOUT: it changes nothing. What was due before goes first. */
static mrt_result read_report(mrt_plugin *self, const double *params, mrt_sample *out)
{
    int64_t time_ns = self->report.time_ns;
    if (give_settled(self, params, time_ns, out))
        return MRT_OK;
    bool changed = take_report(self, params);
    teach_tick(self, time_ns);
    return changed || self->repeat_due_ns <= time_ns ? give(self, time_ns, out) : MRT_TIMEOUT;
}

/* No report has come until now. */
static mrt_result read_silence(mrt_plugin *self, const double *params, mrt_sample *out)
{
    int64_t now_ns = self->host->now_ns(self->host);
    teach_tick(self, now_ns);
    if (give_settled(self, params, now_ns, out))
        return MRT_OK;
    return self->repeat_due_ns <= now_ns ? give(self, now_ns, out) : MRT_TIMEOUT;
}

/* ---- parameters ---- */

/* All switches count as up while they are taught. */
static void begin_learning(mrt_plugin *self)
{
    int64_t now_ns = self->host->now_ns(self->host);
    teach_begin(self, now_ns);
    memset(self->value, 0, sizeof self->value);
    debounce_reset(&self->debounce);
    self->repeat_due_ns = now_ns;
}

/* Which pedal a switch is holds until the input is opened again. */
static void follow_params(mrt_plugin *self, const double *params)
{
    bool is_same = true;
    for (int i = 0; i < PARAM_DEBOUNCE; ++i)
        is_same = is_same && self->opened_with[i] == params[i];
    if (!is_same && !self->has_asked_to_restart) {
        self->has_asked_to_restart = true;
        self->host->request_restart(self->host);
    }
    bool has_lesson_due = params[PARAM_LEARN] > 0.5 || self->has_lesson_due;
    self->has_lesson_due = false;
    if (has_lesson_due && !self->is_lost)
        begin_learning(self);
}

/* ---- the input ---- */

static mrt_result pedal_read(mrt_plugin *self, const double *params, int64_t deadline_ns,
                             mrt_sample *out_sample)
{
    if (!self->is_open)
        return MRT_ERR_IO;
    follow_params(self, params);
    for (;;) {
        mrt_result result = MRT_TIMEOUT;
        if (self->is_lost)
            return give_loss(self, out_sample);
        if (self->has_report) {
            result = read_report(self, params, out_sample);
        } else {
            usb_event event =
                usb_wait(self->usb, earliest(deadline_ns, next_due_ns(self)), &self->report);
            self->has_report = event == USB_REPORTED;
            self->is_lost = event == USB_LOST;
            if (event != USB_NOTHING)
                continue;
            result = read_silence(self, params, out_sample);
        }
        if (result != MRT_TIMEOUT || self->host->now_ns(self->host) >= deadline_ns)
            return result;
    }
}

static mrt_plugin *pedal_create(const mrt_host *host)
{
    mrt_plugin *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    self->trace.file = -1;
    return self;
}

static void pedal_destroy(mrt_plugin *self)
{
    if (!self)
        return;
    opening_close(self);
    usb_destroy(self->usb);
    free(self);
}

/* ---- the type ---- */

static const char *const switch_label[] = {"as it comes", "1", "2", "3", "4", NULL};
static const char *const invert_label[] = {"no", "yes", NULL};

#define SWITCH(number, text)                                                                       \
    {                                                                                              \
        1 + (number), MRT_PARAM_STEPPED, "switch " text, "Pedal", "",                              \
            "Which pedal the device's switch " text " is, if not the next in order", 0,            \
            MRT_MAX_PEDALS, 0, switch_label                                                        \
    }

static const mrt_param params_table[PARAM_COUNT] = {
    [PARAM_FIRST] = {1, MRT_PARAM_STEPPED, "first", "Pedal", "",
                     "Which pedal the first switch is: 4 for a second device beside one of three",
                     1, MRT_MAX_PEDALS, 1, NULL},
    [PARAM_SWITCH] = SWITCH(1, "1"),
    [PARAM_SWITCH + 1] = SWITCH(2, "2"),
    [PARAM_SWITCH + 2] = SWITCH(3, "3"),
    [PARAM_SWITCH + 3] = SWITCH(4, "4"),
    [PARAM_INVERT] = {6, MRT_PARAM_STEPPED, "invert", "Pedal", "",
                      "Whether axes are down where the device says they are up", 0, 1, 0,
                      invert_label},
    [PARAM_DEBOUNCE] = {7, 0, "debounce", "Pedal", "ms",
                        "How long a switch that has just moved may chatter; the first edge is "
                        "never delayed",
                        5, 15, 8, NULL},
    [PARAM_LEARN] = {8, MRT_PARAM_TRIGGER, "learn", "Pedal", "",
                     "Learns the switches of a device: press each once, as it is said", 0, 1, 0,
                     NULL},
};

static const mrt_input input = {opening_open, pedal_channels, pedal_read, opening_close, 0};
static const mrt_devices devices = {listing_list, listing_current};

static const mrt_interface interfaces[] = {
    {MRT_INPUT, &input}, {MRT_DEVICES, &devices}, {NULL, NULL}};

static const mrt_plugin_type type = {
    MRT_ABI,
    PARAM_COUNT,
    params_table,
    interfaces,
    "org.marotte.pedal",
    "Pedal",
    MAROTTE_VERSION,
    "Reads foot pedals on USB; address usb:1-2 (a socket), usb:05f3:00ff (a kind) or none",
    pedal_create,
    pedal_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
