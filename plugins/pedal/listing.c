#include "listing.h"
#include "advice.h"
#include "describe.h"
#include "layout_file.h"
#include "opening.h"
#include "system.h"

#include <stdio.h>
#include <string.h>

/* Something with buttons or axes that the kernel's driver has read, and neither keyboard nor mouse:
 * nobody wants those listed as pedals. */
static bool may_be_pedal(const usb_seen *device)
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

static bool is_ours(const mrt_plugin *self, const usb_seen *device)
{
    return self->is_open && !self->is_lost && strcmp(self->device.path, device->path) == 0;
}

static void judge(const mrt_plugin *self, const usb_seen *device, const layout *known,
                  mrt_device *out)
{
    const usb_endpoint *endpoint = opening_endpoint(known, device);
    if (!endpoint) {
        out->state = MRT_DEVICE_UNSURE;
        advice_no_endpoint(out->advice, device);
    } else if (!system_may_open(device)) {
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

static void describe_device(const mrt_plugin *self, const usb_seen *device, const layout *known,
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

uint32_t listing_list(mrt_plugin *self, mrt_device *out, uint32_t capacity)
{
    usb_seen seen[USB_SEEN];
    if (!pedal_has_usb(self))
        return 0;
    uint32_t seen_count = usb_look(self->usb, seen, USB_SEEN);
    uint32_t count = 0;
    for (uint32_t i = 0; i < seen_count && i < USB_SEEN; ++i) {
        char complaint[LAYOUT_FILE_REASON];
        layout known = opening_known_layout(&seen[i], complaint);
        if (known.source == LAYOUT_OF_NOTHING && !complaint[0] && !may_be_pedal(&seen[i]))
            continue;
        if (count < capacity)
            describe_device(self, &seen[i], &known, complaint, &out[count]);
        count += 1;
    }
    return count;
}

bool listing_current(mrt_plugin *self, mrt_device *out)
{
    *out = (mrt_device){.state = MRT_DEVICE_READY};
    if (!self->is_open || self->is_lost)
        return false;
    snprintf(out->address, sizeof out->address, "usb:%s", self->device.path);
    snprintf(out->name, sizeof out->name, "%s", self->name);
    return true;
}
