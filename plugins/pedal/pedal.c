/* The plugin "org.marotte.pedal": opens, lists, learns and reads foot pedals. */
#include "address.h"
#include "descriptor.h"
#include "device_io.h"
#include "layouts.h"
#include "learn.h"
#include "system.h"
#include "trace.h"
#include "usb.h"

#include <marotte/plugin.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In the order of the table of parameters. */
enum {
    PARAM_FIRST = 0,
    PARAM_SWITCH, /* LAYOUT_SWITCHES of them */
    PARAM_INVERT = PARAM_SWITCH + LAYOUT_SWITCHES,
    PARAM_DEBOUNCE,
    PARAM_LEARN,
    PARAM_COUNT
};

enum { PEDAL_ADDRESS = 192, PEDAL_TEXT = 512 };

struct mrt_plugin {
    const mrt_host *host;
    usb *usb; /* NULL until first used */
    trace trace;

    char address[PEDAL_ADDRESS]; /* as passed to open, also "" */
    address_binding binding;     /* device that this address was bound to */
    usb_device device;           /* the open device, or the last one */
    char name[LAYOUT_NAME];

    bool is_open, has_lesson_due; /* the button was pressed when opening */
    double opened_with[PARAM_COUNT];
    layout layout;
    uint32_t analogue; /* bit n: switch n */
    descriptor fields; /* field_count 0: not known */
    uint32_t channel_count;
    mrt_channel channels[LAYOUT_SWITCHES];
    char channel_names[LAYOUT_SWITCHES][LAYOUT_SWITCH_NAME];

    float value[LAYOUT_SWITCHES]; /* last reported state */
    debounce debounce;
    usb_report report; /* report that waits for earlier changes */
    bool has_report;
    bool is_lost, has_released, has_told_loss, has_asked_to_restart;
    int64_t last_time_ns, repeat_due_ns;
    uint32_t sequence;

    learn learn;
};

/* ---- opening ---- */

enum { TRIES = 10 };
static const int64_t try_again_ns = 100000000;

/* Result of an attempt, with its message. */
typedef struct attempt {
    mrt_result result;
    bool may_pass; /* a new device: its permissions or driver may still be set */
    char text[PEDAL_TEXT];
} attempt;

/* ---- layout of a device ---- */

static layout known_layout(const usb_device *device, char *complaint)
{
    char reason[LAYOUT_FILE_REASON] = "";
    layout learnt;
    mrt_result result = layout_file_load(&learnt, device->vendor, device->product, reason);
    if (complaint)
        snprintf(complaint, LAYOUT_FILE_REASON, "%s", result < 0 ? reason : "");
    if (result == MRT_OK)
        return learnt;
    const layout *listed = layouts_find(device->vendor, device->product);
    if (listed)
        return *listed;
    return (layout){
        .vendor = device->vendor, .product = device->product, .interface_number = LAYOUT_ANY};
}

static const usb_endpoint *endpoint_of(const layout *known, const usb_device *device)
{
    const usb_endpoint *first = NULL;
    for (uint32_t i = 0; i < device->endpoint_count; ++i) {
        const usb_endpoint *endpoint = &device->endpoint[i];
        if (!endpoint->is_hid || (known->interface_number != LAYOUT_ANY &&
                                  known->interface_number != endpoint->interface_number))
            continue;
        if (known->endpoint == endpoint->address)
            return endpoint;
        if (!first)
            first = endpoint;
    }
    return first;
}

static void name_device(mrt_plugin *self)
{
    char product[SYSTEM_NAME];
    system_product(product, self->device.path);
    if (self->layout.name[0] == '\0')
        snprintf(self->layout.name, sizeof self->layout.name, "%s",
                 product[0] ? product : "USB device");
    memcpy(self->name, self->layout.name, sizeof self->name);
}

/* Uses the kernel's copy of the descriptor, unless another program used the device before. */
static void read_fields(mrt_plugin *self, uint8_t *bytes, size_t size)
{
    char reason[DESCRIPTOR_REASON];
    if (size == 0)
        size = usb_read_descriptor(self->usb, bytes, DESCRIPTOR_BYTES);
    int64_t now_ns = self->host->now_ns(self->host);
    trace_note(&self->trace, now_ns, "report descriptor:");
    trace_received(&self->trace, now_ns, bytes, size);
    if (descriptor_parse(&self->fields, bytes, size, reason) < 0)
        device_log(self->host, MRT_LOG_WARNING, "%.60s at usb:%s: %s", self->name,
                   self->device.path, reason);
}

static void invert_axes(layout *of)
{
    for (uint32_t i = 0; i < of->switch_count; ++i) {
        layout_switch *s = &of->switches[i];
        if (!layout_is_analogue(s))
            continue;
        int32_t up = s->up;
        s->up = s->down;
        s->down = up;
    }
}

static void find_analogue(mrt_plugin *self)
{
    self->analogue = 0;
    for (uint32_t i = 0; i < self->layout.switch_count; ++i)
        if (layout_is_analogue(&self->layout.switches[i]))
            self->analogue |= 1u << i;
}

/* Completes the layout with switches, if a source is available. */
static void complete_layout(mrt_plugin *self, const usb_endpoint *endpoint, const double *params)
{
    layout *of = &self->layout;
    if (of->interface_number == LAYOUT_ANY)
        of->interface_number = endpoint->interface_number;
    of->endpoint = endpoint->address;
    if (of->source == LAYOUT_OF_NOTHING || of->source == LAYOUT_OF_DESCRIPTOR)
        (void)describe_switches(of, &self->fields);
    if (params[PARAM_INVERT] > 0.5)
        invert_axes(of);
    find_analogue(self);
}

/* ---- channels ---- */

/* Returns 0..3; MRT_MAX_PEDALS: none. */
static uint32_t pedal_of(uint32_t index, const double *params)
{
    double wanted = params[PARAM_SWITCH + index];
    double number = wanted >= 1.0 ? wanted : params[PARAM_FIRST] + (double)index;
    return number >= 1.0 && number <= MRT_MAX_PEDALS ? (uint32_t)number - 1 : MRT_MAX_PEDALS;
}

static void make_channels(mrt_plugin *self, const double *params)
{
    bool taken[MRT_MAX_PEDALS + 1] = {false};
    uint32_t count = self->layout.switch_count;
    self->channel_count = count > 0 ? count : 1; /* a pedal without switches until it is learned */
    for (uint32_t i = 0; i < self->channel_count; ++i) {
        uint32_t pedal = i < count ? pedal_of(i, params) : MRT_MAX_PEDALS;
        bool is_pedal = pedal < MRT_MAX_PEDALS && !taken[pedal];
        taken[pedal] = true;
        snprintf(self->channel_names[i], LAYOUT_SWITCH_NAME, "%s",
                 i < count ? self->layout.switches[i].name : "not taught yet");
        self->channels[i] = (mrt_channel){self->channel_names[i],
                                          "",
                                          is_pedal ? MRT_CH_PEDAL + pedal : MRT_CH_OTHER,
                                          MRT_NO_HAND,
                                          0.0f,
                                          1.0f};
        if (i < count && !is_pedal)
            device_log(self->host, MRT_LOG_WARNING,
                       "switch %u (%s) of %.60s has no pedal: the number is above 4 or already "
                       "used. Set switch_%u",
                       i + 1, self->channel_names[i], self->name, i + 1);
    }
}

/* ---- opening one device ---- */

static void explain(mrt_plugin *self, usb_failure failure, attempt *out)
{
    char advice[ADVICE_TEXT];
    switch (failure) {
    case USB_DENIED:
        advice_denied(advice, &self->device);
        break;
    case USB_BUSY:
        advice_busy(advice, &self->device);
        break;
    case USB_GONE:
        snprintf(advice, sizeof advice, "disconnected while opening: plug it in again");
        break;
    case USB_NO_MEMORY:
        snprintf(advice, sizeof advice, "no memory");
        break;
    default:
        snprintf(advice, sizeof advice, "cannot open it (%s): use another USB port",
                 usb_failure_text(self->usb));
    }
    out->result = failure == USB_NO_MEMORY ? MRT_ERR_MEMORY : MRT_ERR_IO;
    out->may_pass = failure != USB_BROKEN && usb_is_new(self->usb, &self->device);
    snprintf(out->text, sizeof out->text, "%.40s at usb:%s: %s", self->name, self->device.path,
             advice);
}

static void forget_the_past(mrt_plugin *self)
{
    memset(self->value, 0, sizeof self->value);
    debounce_reset(&self->debounce);
    self->has_report = self->is_lost = self->has_released = self->has_told_loss = false;
    self->has_asked_to_restart = false;
    self->learn.stage = LEARN_OFF;
    self->repeat_due_ns = INT64_MIN; /* the first sample is due immediately */
}

static void open_device(mrt_plugin *self, const usb_device *device, const layout *known,
                        const double *params, attempt *out)
{
    static const size_t capacity = DESCRIPTOR_BYTES;
    uint8_t bytes[DESCRIPTOR_BYTES];
    self->device = *device;
    self->layout = *known;
    name_device(self);
    const usb_endpoint *endpoint = endpoint_of(known, device);
    if (!endpoint) {
        out->result = MRT_ERR_UNSUPPORTED;
        advice_no_endpoint(out->text, device);
        return;
    }
    size_t size = system_descriptor(device->path, endpoint->interface_number, bytes, capacity);
    usb_failure failure = usb_open(self->usb, device, endpoint);
    if (failure != USB_FINE) {
        explain(self, failure, out);
        return;
    }
    read_fields(self, bytes, size);
    complete_layout(self, endpoint, params);
    make_channels(self, params);
    forget_the_past(self);
    out->result = MRT_OK;
}

static void report_opened(const mrt_plugin *self)
{
    char advice[ADVICE_TEXT];
    if (self->layout.switch_count > 0) {
        device_log(self->host, MRT_LOG_INFO, "%.60s at usb:%s: %u switches", self->name,
                   self->device.path, self->layout.switch_count);
        return;
    }
    advice_unknown(advice, &self->device);
    device_log(self->host, MRT_LOG_WARNING, "%.60s at usb:%s: %s", self->name, self->device.path,
               advice);
}

/* ---- finding the device ---- */

static void explain_absence(const mrt_plugin *self, const address *wanted, attempt *out)
{
    const char *again = "plug it in, or list the devices with: marotte devices";
    out->result = MRT_ERR_IO;
    out->may_pass = false;
    if (self->binding.is_bound)
        snprintf(out->text, sizeof out->text,
                 "the pedal %04x:%04x is not connected to usb:%s: plug it in there again",
                 self->binding.vendor, self->binding.product, self->binding.path);
    else if (wanted->kind == ADDRESS_PORT)
        snprintf(out->text, sizeof out->text, "no device found at usb:%s: %s", wanted->path, again);
    else if (wanted->kind == ADDRESS_KIND)
        snprintf(out->text, sizeof out->text, "no device usb:%04x:%04x found: %s", wanted->vendor,
                 wanted->product, again);
    else
        snprintf(out->text, sizeof out->text,
                 "no known pedal found: plug one in, or name another device by usb:VENDOR:PRODUCT "
                 "as lsusb shows it");
}

static void try_to_open(mrt_plugin *self, const address *wanted, const double *params, attempt *out)
{
    usb_device found[USB_DEVICES];
    uint32_t count = usb_list(self->usb, found, USB_DEVICES);
    explain_absence(self, wanted, out);
    bool was_found = false;
    for (uint32_t i = 0; i < count && i < USB_DEVICES; ++i) {
        char complaint[LAYOUT_FILE_REASON];
        layout known = known_layout(&found[i], complaint);
        if (!address_matches(wanted, &self->binding, found[i].path, found[i].vendor,
                             found[i].product, known.source != LAYOUT_OF_NOTHING)) {
            /* an unreadable layout may be of the wanted device */
            if (complaint[0] && wanted->kind == ADDRESS_ANY && !was_found)
                snprintf(out->text, sizeof out->text, "%.*s", PEDAL_TEXT - 1, complaint);
            continue;
        }
        attempt one = {0};
        open_device(self, &found[i], &known, params, &one);
        if (one.result == MRT_OK || !was_found)
            *out = one;
        if (one.result == MRT_OK && complaint[0])
            device_log(self->host, MRT_LOG_WARNING, "%s", complaint);
        if (one.result == MRT_OK)
            return;
        was_found = true;
    }
}

/* Waits a moment. Returns false if the host is stopping. */
static bool wait_a_little(const mrt_plugin *self)
{
    int64_t until_ns = self->host->now_ns(self->host) + try_again_ns;
    return self->host->wait_until_ns(self->host, until_ns) >= until_ns;
}

static void remember_address(mrt_plugin *self, const char *text)
{
    if (strcmp(self->address, text) != 0)
        self->binding = (address_binding){0};
    snprintf(self->address, sizeof self->address, "%s", text);
}

static void bind_to_socket(mrt_plugin *self)
{
    self->binding = (address_binding){
        .is_bound = true, .vendor = self->device.vendor, .product = self->device.product};
    memcpy(self->binding.path, self->device.path, sizeof self->binding.path);
}

/* Returns false, after logging, if out of memory or without USB. */
static bool has_usb(mrt_plugin *self)
{
    if (!self->usb)
        self->usb = usb_create(self->host);
    if (!self->usb)
        device_log(self->host, MRT_LOG_ERROR,
                   "cannot use USB: check that /dev/bus/usb exists and memory is available");
    return self->usb != NULL;
}

static void pedal_close(mrt_plugin *self)
{
    if (self->usb)
        usb_close(self->usb);
    trace_close(&self->trace);
    self->is_open = false;
}

static mrt_result pedal_open(mrt_plugin *self, const char *text, const double *params)
{
    address wanted;
    pedal_close(self);
    if (!address_parse(&wanted, text)) {
        device_log(self->host, MRT_LOG_ERROR,
                   "\"%.60s\" is not the address of a pedal: write usb:1-2.3 (a USB port), "
                   "usb:05f3:00ff (vendor and product), or nothing for the first pedal",
                   text);
        return MRT_ERR_ARGUMENT;
    }
    if (!has_usb(self))
        return MRT_ERR_IO;
    remember_address(self, text ? text : "");
    trace_open(&self->trace, self->host, "pedal");
    attempt last;
    for (int tries = 1;; ++tries) {
        last = (attempt){0};
        try_to_open(self, &wanted, params, &last);
        if (last.result == MRT_OK || !last.may_pass || tries == TRIES || !wait_a_little(self))
            break;
    }
    if (last.result < 0) {
        trace_close(&self->trace);
        device_log(self->host, MRT_LOG_ERROR, "%s", last.text);
        return last.result;
    }
    bind_to_socket(self);
    memcpy(self->opened_with, params, sizeof self->opened_with);
    self->is_open = true;
    self->has_lesson_due = params[PARAM_LEARN] > 0.5;
    report_opened(self);
    return MRT_OK;
}

/* ---- list of pedals ---- */

/* Returns true for a device with buttons or axes, except keyboards and mice: users do not want
 * those listed as pedals. */
static bool may_be_pedal(const usb_device *device)
{
    uint8_t bytes[DESCRIPTOR_BYTES];
    char reason[DESCRIPTOR_REASON];
    descriptor fields;
    for (uint32_t i = 0; i < device->endpoint_count; ++i)
        if (device->endpoint[i].boot_protocol != 0)
            return false;
    for (uint32_t i = 0; i < device->endpoint_count; ++i) {
        const usb_endpoint *endpoint = &device->endpoint[i];
        size_t size = endpoint->is_hid ? system_descriptor(device->path, endpoint->interface_number,
                                                           bytes, sizeof bytes)
                                       : 0;
        if (size > 0 && descriptor_parse(&fields, bytes, size, reason) >= 0 &&
            describe_may_be_pedal(&fields))
            return true;
    }
    return false;
}

static bool is_ours(const mrt_plugin *self, const usb_device *device)
{
    return self->is_open && !self->is_lost && strcmp(self->device.path, device->path) == 0;
}

static void judge(const mrt_plugin *self, const usb_device *device, const layout *known,
                  mrt_device *out)
{
    const usb_endpoint *endpoint = endpoint_of(known, device);
    if (!endpoint) {
        out->state = MRT_DEVICE_UNSURE;
        advice_no_endpoint(out->advice, device);
    } else if (!system_can_open(device)) {
        out->state = MRT_DEVICE_DENIED;
        advice_denied(out->advice, device);
    } else if (!is_ours(self, device) &&
               system_is_claimed(device->path, endpoint->interface_number)) {
        out->state = MRT_DEVICE_BUSY;
        advice_busy(out->advice, device);
    } else if (known->source == LAYOUT_OF_NOTHING) {
        out->state = MRT_DEVICE_UNSURE;
        advice_unknown(out->advice, device);
    }
}

static void describe_device(const mrt_plugin *self, const usb_device *device, const layout *known,
                            const char *complaint, mrt_device *out)
{
    *out = (mrt_device){.state = MRT_DEVICE_READY};
    snprintf(out->address, sizeof out->address, "usb:%s", device->path);
    system_product(out->name, device->path);
    if (out->name[0] == '\0')
        snprintf(out->name, sizeof out->name, "%s", known->name[0] ? known->name : "USB device");
    judge(self, device, known, out);
    if (complaint[0] && (out->state == MRT_DEVICE_READY || out->state == MRT_DEVICE_UNSURE))
        snprintf(out->advice, sizeof out->advice, "%.*s", (int)sizeof out->advice - 1, complaint);
}

static uint32_t pedal_list(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    usb_device found[USB_DEVICES];
    if (!has_usb(self))
        return 0;
    uint32_t device_count = usb_list(self->usb, found, USB_DEVICES);
    uint32_t count = 0;
    for (uint32_t i = 0; i < device_count && i < USB_DEVICES; ++i) {
        char complaint[LAYOUT_FILE_REASON];
        layout known = known_layout(&found[i], complaint);
        if (known.source == LAYOUT_OF_NOTHING && !complaint[0] && !may_be_pedal(&found[i]))
            continue;
        if (count < capacity)
            describe_device(self, &found[i], &known, complaint, &out[count]);
        count += 1;
    }
    return count;
}

static bool pedal_current(mrt_plugin *self, mrt_device *out)
{
    *out = (mrt_device){.state = MRT_DEVICE_READY};
    if (!self->is_open || self->is_lost)
        return false;
    snprintf(out->address, sizeof out->address, "usb:%s", self->device.path);
    snprintf(out->name, sizeof out->name, "%s", self->name);
    return true;
}

/* ---- learning, messages to the user ---- */

static void ask(const mrt_plugin *self)
{
    uint32_t found = self->learn.found.switch_count;
    if (found == 0)
        device_log(self->host, MRT_LOG_INFO, "learn: press and release switch 1");
    else
        device_log(self->host, MRT_LOG_INFO,
                   "learn: switch %u is learned: press and release switch %u, or an earlier one "
                   "again to finish",
                   found, found + 1);
}

/* The channels do not change until the input is opened again. */
static void adopt(mrt_plugin *self)
{
    if (self->layout.switch_count != self->learn.found.switch_count) {
        self->host->request_restart(self->host);
        return;
    }
    self->layout = self->learn.found;
    find_analogue(self);
    memset(self->value, 0, sizeof self->value);
}

static void finish(mrt_plugin *self)
{
    char reason[LAYOUT_FILE_REASON], path[LAYOUT_FILE_PATH];
    const layout *found = &self->learn.found;
    if (layout_file_store(found, reason) < 0) {
        device_log(self->host, MRT_LOG_ERROR, "learn: given up: %s", reason);
        return;
    }
    (void)layout_file_path(path, found->vendor, found->product);
    device_log(self->host, MRT_LOG_INFO, "learn: done: %u switches of %.60s are stored in %s",
               found->switch_count, found->name, path);
    adopt(self);
}

static void say_progress(mrt_plugin *self)
{
    switch (self->learn.stage) {
    case LEARN_WAIT:
        ask(self);
        break;
    case LEARN_DONE:
        finish(self);
        break;
    case LEARN_FAILED:
        device_log(self->host, MRT_LOG_WARNING,
                   "learn: given up: no switch was pressed and released within 15 s: start again");
        break;
    default:
        break;
    }
}

static void go_on_learning(mrt_plugin *self, int64_t now_ns)
{
    if (learn_tick(&self->learn, now_ns))
        say_progress(self);
}

static void give_up_learning(mrt_plugin *self)
{
    if (!learn_is_running(&self->learn))
        return;
    self->learn.stage = LEARN_FAILED;
    device_log(self->host, MRT_LOG_WARNING,
               "learn: given up: the device was disconnected: start again");
}

/* ---- the plugin ---- */

/* An unchanged state is repeated at this interval, so that silence shows a fault. */
static const int64_t repeat_ns = 1000000000;

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

/* Returns the release of all switches first, then the error. */
static mrt_result give_loss(mrt_plugin *self, mrt_sample *out)
{
    if (!self->has_released) {
        self->has_released = true;
        give_up_learning(self);
        memset(self->value, 0, sizeof self->value);
        debounce_reset(&self->debounce);
        return give(self, self->host->now_ns(self->host), out);
    }
    if (!self->has_told_loss) {
        self->has_told_loss = true;
        trace_note(&self->trace, self->host->now_ns(self->host), "gone");
        device_log(self->host, MRT_LOG_ERROR,
                   "%.60s at usb:%s was disconnected (%s): plug it in again", self->name,
                   self->device.path, usb_failure_text(self->usb));
    }
    return MRT_ERR_IO;
}

static int64_t window_ns(const double *params)
{
    double ms = params[PARAM_DEBOUNCE];
    ms = ms > 5.0 ? ms : 5.0;
    return (int64_t)((ms < 15.0 ? ms : 15.0) * 1e6);
}

/* Returns true if something changed. While switches are learned, they have no other effect. */
static bool take_report(mrt_plugin *self, const double *params)
{
    const usb_report *report = &self->report;
    self->has_report = false;
    trace_received(&self->trace, report->time_ns, report->bytes, report->size);
    if (learn_is_running(&self->learn)) {
        if (learn_report(&self->learn, report->bytes, report->size, report->time_ns))
            say_progress(self);
        return false;
    }
    return decode_report(&self->layout, report->bytes, report->size, self->value) &&
           debounce_update(&self->debounce, self->value, self->analogue, report->time_ns,
                           window_ns(params));
}

/* Applies held-back changes that are due. Returns true if a sample was written. */
static bool give_settled(mrt_plugin *self, const double *params, int64_t time_ns, mrt_sample *out)
{
    int64_t due_ns = debounce_due_ns(&self->debounce);
    if (due_ns > time_ns || !debounce_settle(&self->debounce, due_ns, window_ns(params)))
        return false;
    (void)give(self, due_ns, out);
    return true;
}

/* Returns the time of the next action if the device stays silent. */
static int64_t next_due_ns(const mrt_plugin *self)
{
    int64_t due = device_earlier_ns(debounce_due_ns(&self->debounce), self->repeat_due_ns);
    return learn_is_running(&self->learn) ? device_earlier_ns(due, self->learn.until_ns) : due;
}

/* Processes the waiting report, after changes that were due before it. Returns MRT_TIMEOUT if it
 * changes nothing. */
static mrt_result read_report(mrt_plugin *self, const double *params, mrt_sample *out)
{
    int64_t time_ns = self->report.time_ns;
    if (give_settled(self, params, time_ns, out))
        return MRT_OK;
    bool changed = take_report(self, params);
    go_on_learning(self, time_ns);
    return changed || self->repeat_due_ns <= time_ns ? give(self, time_ns, out) : MRT_TIMEOUT;
}

/* Handles the time without a report. */
static mrt_result read_silence(mrt_plugin *self, const double *params, mrt_sample *out)
{
    int64_t now_ns = self->host->now_ns(self->host);
    go_on_learning(self, now_ns);
    if (give_settled(self, params, now_ns, out))
        return MRT_OK;
    return self->repeat_due_ns <= now_ns ? give(self, now_ns, out) : MRT_TIMEOUT;
}

/* ---- parameters ---- */

/* All switches count as up while they are learned. */
static void begin_learning(mrt_plugin *self)
{
    int64_t now_ns = self->host->now_ns(self->host);
    if (!learn_is_running(&self->learn)) {
        learn_start(&self->learn, &self->layout,
                    self->fields.field_count > 0 ? &self->fields : NULL, now_ns);
        device_log(self->host, MRT_LOG_INFO, "learn: take your feet off %.60s at usb:%s",
                   self->name, self->device.path);
    }
    memset(self->value, 0, sizeof self->value);
    debounce_reset(&self->debounce);
    self->repeat_due_ns = now_ns;
}

/* The assignment of pedals does not change until the input is opened again. */
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
            usb_event event = usb_wait(self->usb, device_earlier_ns(deadline_ns, next_due_ns(self)),
                                       &self->report);
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
    pedal_close(self);
    usb_destroy(self->usb);
    free(self);
}

/* ---- the type ---- */

static const char *const switch_label[] = {"as it comes", "1", "2", "3", "4", NULL};
static const char *const invert_label[] = {"no", "yes", NULL};

#define SWITCH(number, text)                                                                       \
    {                                                                                              \
        1 + (number), MRT_PARAM_STEPPED, "switch " text, "Pedal", "",                              \
            "Pedal number of the device's switch " text ", if not the next in order", 0,           \
            MRT_MAX_PEDALS, 0, switch_label                                                        \
    }

static const mrt_param params_table[PARAM_COUNT] = {
    [PARAM_FIRST] =
        {1, MRT_PARAM_STEPPED, "first", "Pedal", "",
         "Pedal number of the first switch: 4 for a second device next to one with three switches",
         1, MRT_MAX_PEDALS, 1, NULL},
    [PARAM_SWITCH] = SWITCH(1, "1"),
    [PARAM_SWITCH + 1] = SWITCH(2, "2"),
    [PARAM_SWITCH + 2] = SWITCH(3, "3"),
    [PARAM_SWITCH + 3] = SWITCH(4, "4"),
    [PARAM_INVERT] = {6, MRT_PARAM_STEPPED, "invert", "Pedal", "",
                      "Invert the axes, for a device that reports up as down", 0, 1, 0,
                      invert_label},
    [PARAM_DEBOUNCE] = {7, 0, "debounce", "Pedal", "ms",
                        "Debounce time after a switch moves; the first edge is never delayed", 5,
                        15, 8, NULL},
    [PARAM_LEARN] = {8, MRT_PARAM_TRIGGER, "learn", "Pedal", "",
                     "Learn the switches of a device: press each one when asked", 0, 1, 0, NULL},
};

static const mrt_input input = {pedal_open, pedal_channels, pedal_read, pedal_close, 0};
static const mrt_devices devices = {pedal_list, pedal_current};

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
    "Reads USB foot pedals; address usb:1-2 (a USB port), usb:05f3:00ff (vendor and product) or "
    "none",
    pedal_create,
    pedal_destroy,
};

MRT_EXPORT const mrt_plugin_type *const marotte_plugins[] = {&type, NULL};
