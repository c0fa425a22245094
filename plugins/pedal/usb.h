/* pedal/usb.h - the only file that uses libusb: lists the devices, and opens one for its interrupt
 * reports. Leaves out the meaning of the reports and the choice of a device. One thread at a time.
 * Never waits longer than the given deadlines, or 2 s to close. */
#ifndef MAROTTE_PLUGINS_PEDAL_USB_H
#define MAROTTE_PLUGINS_PEDAL_USB_H
#include "address.h"

#include <marotte/plugin.h>

enum { USB_DEVICES = 64, USB_ENDPOINTS = 16, USB_REPORT = 1024 };

/* An interrupt IN endpoint, for a device's reports. */
typedef struct usb_endpoint {
    uint8_t interface_number, address;
    bool is_hid;
    uint8_t boot_protocol; /* 0 none, 1 keyboard, 2 mouse */
    uint16_t packet_bytes; /* 1..USB_REPORT; the device's value if it is in range */
} usb_endpoint;

typedef struct usb_device { /* a device that is plugged in */
    uint16_t vendor, product;
    uint8_t bus, number;
    char path[ADDRESS_PATH]; /* USB port: "1-2.3" */
    uint32_t endpoint_count;
    usb_endpoint endpoint[USB_ENDPOINTS];
} usb_device;

typedef struct usb_report {
    int64_t time_ns; /* host clock at which it arrived */
    size_t size;     /* 1..USB_REPORT */
    uint8_t bytes[USB_REPORT];
} usb_report;

typedef enum usb_failure {
    USB_FINE = 0,
    USB_DENIED, /* no permission */
    USB_BUSY,   /* claimed by another program */
    USB_GONE,   /* unplugged, or not answering */
    USB_NO_MEMORY,
    USB_BROKEN /* other failures: see usb_failure_text */
} usb_failure;

typedef enum usb_event { USB_NOTHING = 0, USB_REPORTED, USB_LOST } usb_event;

typedef struct usb usb;

/* Returns NULL if out of memory, or on a system without USB. */
usb *usb_create(const mrt_host *host);
void usb_destroy(usb *self); /* closes; accepts NULL */

/* Writes up to `capacity` devices in the order of their USB ports, without hubs. Returns the number
 * present. Does not communicate with the devices. */
uint32_t usb_list(usb *self, usb_device *out, uint32_t capacity);
/* Returns true if the device appeared within the last 1.5 s: its permissions may still be set. */
bool usb_is_new(const usb *self, const usb_device *device);

/* Detaches the kernel's driver, claims the interface and begins to receive. */
usb_failure usb_open(usb *self, const usb_device *device, const usb_endpoint *endpoint);
/* Stops receiving and attaches the kernel's driver again. Accepts a closed device. */
void usb_close(usb *self);
/* Returns libusb's text for the last failure. */
const char *usb_failure_text(const usb *self);

/* Reads the report descriptor of the open interface. Returns 0 if the device sends none. Waits at
 * most half a second. */
size_t usb_read_descriptor(usb *self, uint8_t *out, size_t capacity);

/* Returns the next report, in order of arrival. USB_LOST only after the last report. */
usb_event usb_wait(usb *self, int64_t deadline_ns, usb_report *out);

#endif
