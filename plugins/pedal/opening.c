#include "opening.h"
#include "advice.h"
#include "describe.h"
#include "layout_file.h"
#include "system.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIES = 10 };
static const int64_t try_again_ns = 100000000;

/* How an attempt ended, and what to say about it. */
typedef struct attempt {
    mrt_result result;
    bool may_pass; /* a device that has just come: its rights or its driver may follow */
    char text[PEDAL_TEXT];
} attempt;

/* ---- what is known of a device ---- */

layout opening_known_layout(const usb_seen *device, char *complaint)
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

const usb_endpoint *opening_endpoint(const layout *known, const usb_seen *device)
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

/* The kernel has read it already, unless another program had the device before us. */
static void read_fields(mrt_plugin *self, uint8_t *bytes, size_t size)
{
    char reason[DESCRIPTOR_REASON];
    if (size == 0)
        size = usb_read_descriptor(self->usb, bytes, DESCRIPTOR_BYTES);
    int64_t now_ns = self->host->now_ns(self->host);
    trace_note(&self->trace, now_ns, "report descriptor:");
    trace_received(&self->trace, now_ns, bytes, size);
    if (descriptor_parse(&self->fields, bytes, size, reason) < 0)
        pedal_say(self, MRT_LOG_WARNING, "%.60s at usb:%s: %s", self->name, self->device.path,
                  reason);
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

/* The layout with its switches, if anything says which they are. */
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
    self->analogue = 0;
    for (uint32_t i = 0; i < of->switch_count; ++i)
        if (layout_is_analogue(&of->switches[i]))
            self->analogue |= 1u << i;
}

/* ---- channels ---- */

/* 0..3, or MRT_MAX_PEDALS: none. */
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
    self->channel_count = count > 0 ? count : 1; /* one that says nothing until it is taught */
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
            pedal_say(self, MRT_LOG_WARNING,
                      "switch %u (%s) of %.60s is no pedal: its number is above 4 or taken: set "
                      "switch_%u",
                      i + 1, self->channel_names[i], self->name, i + 1);
    }
}

/* ---- one device ---- */

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
        snprintf(advice, sizeof advice, "went away while it was opened: plug it in again");
        break;
    case USB_NO_MEMORY:
        snprintf(advice, sizeof advice, "no memory");
        break;
    default:
        snprintf(advice, sizeof advice, "cannot be opened (%s): plug it into another socket",
                 usb_failure_text(self->usb));
    }
    out->result = failure == USB_NO_MEMORY ? MRT_ERR_MEMORY : MRT_ERR_IO;
    out->may_pass = failure != USB_BROKEN && usb_came_lately(self->usb, &self->device);
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
    self->repeat_due_ns = INT64_MIN; /* the first sample is due at once */
}

static void open_device(mrt_plugin *self, const usb_seen *device, const layout *known,
                        const double *params, attempt *out)
{
    static const size_t capacity = DESCRIPTOR_BYTES;
    uint8_t bytes[DESCRIPTOR_BYTES];
    self->device = *device;
    self->layout = *known;
    name_device(self);
    const usb_endpoint *endpoint = opening_endpoint(known, device);
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

static void say_opened(const mrt_plugin *self)
{
    char advice[ADVICE_TEXT];
    if (self->layout.switch_count > 0) {
        pedal_say(self, MRT_LOG_INFO, "%.60s at usb:%s: %u switches", self->name, self->device.path,
                  self->layout.switch_count);
        return;
    }
    advice_unknown(advice, &self->device);
    pedal_say(self, MRT_LOG_WARNING, "%.60s at usb:%s: %s", self->name, self->device.path, advice);
}

/* ---- the device that is meant ---- */

static void explain_absence(const mrt_plugin *self, const address *wanted, attempt *out)
{
    const char *again = "plug it in, or see what there is with: marotte devices";
    out->result = MRT_ERR_IO;
    out->may_pass = false;
    if (self->binding.is_bound)
        snprintf(out->text, sizeof out->text,
                 "the pedal %04x:%04x is not in its socket usb:%s: plug it in there again",
                 self->binding.vendor, self->binding.product, self->binding.path);
    else if (wanted->kind == ADDRESS_PORT)
        snprintf(out->text, sizeof out->text, "no device is in socket usb:%s: %s", wanted->path,
                 again);
    else if (wanted->kind == ADDRESS_KIND)
        snprintf(out->text, sizeof out->text, "no device usb:%04x:%04x is plugged in: %s",
                 wanted->vendor, wanted->product, again);
    else
        snprintf(out->text, sizeof out->text,
                 "no pedal that is known is plugged in: plug one in, or name another device by "
                 "usb:VENDOR:PRODUCT as lsusb shows it");
}

static void try_to_open(mrt_plugin *self, const address *wanted, const double *params, attempt *out)
{
    usb_seen seen[USB_SEEN];
    uint32_t count = usb_look(self->usb, seen, USB_SEEN);
    explain_absence(self, wanted, out);
    bool was_found = false;
    for (uint32_t i = 0; i < count && i < USB_SEEN; ++i) {
        char complaint[LAYOUT_FILE_REASON];
        layout known = opening_known_layout(&seen[i], complaint);
        if (!address_matches(wanted, &self->binding, seen[i].path, seen[i].vendor, seen[i].product,
                             known.source != LAYOUT_OF_NOTHING)) {
            /* what was taught, and cannot be read any more, may be what is looked for */
            if (complaint[0] && wanted->kind == ADDRESS_ANY && !was_found)
                snprintf(out->text, sizeof out->text, "%.*s", PEDAL_TEXT - 1, complaint);
            continue;
        }
        attempt one = {0};
        open_device(self, &seen[i], &known, params, &one);
        if (one.result == MRT_OK || !was_found)
            *out = one;
        if (one.result == MRT_OK && complaint[0])
            pedal_say(self, MRT_LOG_WARNING, "%s", complaint);
        if (one.result == MRT_OK)
            return;
        was_found = true;
    }
}

/* False: the host is stopping. */
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

mrt_result opening_open(mrt_plugin *self, const char *text, const double *params)
{
    address wanted;
    opening_close(self);
    if (!address_parse(&wanted, text)) {
        pedal_say(self, MRT_LOG_ERROR,
                  "\"%.60s\" is no address of a pedal: write usb:1-2.3 (a socket), usb:05f3:00ff "
                  "(a kind), or nothing for the first pedal",
                  text);
        return MRT_ERR_ARGUMENT;
    }
    if (!pedal_has_usb(self))
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
        pedal_say(self, MRT_LOG_ERROR, "%s", last.text);
        return last.result;
    }
    bind_to_socket(self);
    memcpy(self->opened_with, params, sizeof self->opened_with);
    self->is_open = true;
    self->has_lesson_due = params[PARAM_LEARN] > 0.5;
    say_opened(self);
    return MRT_OK;
}

void opening_close(mrt_plugin *self)
{
    if (self->usb)
        usb_close(self->usb);
    trace_close(&self->trace);
    self->is_open = false;
}
