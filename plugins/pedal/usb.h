/* pedal/usb.h - the one place that knows libusb: which devices are plugged in, and one of them
 * opened for its interrupt reports. Leaves out what the reports mean and which device is wanted.
 * One thread at a time; waits never longer than the deadlines that are given, or 2 s to close. */
#ifndef MAROTTE_PLUGINS_PEDAL_USB_H
#define MAROTTE_PLUGINS_PEDAL_USB_H
#include "address.h"

#include <marotte/plugin.h>

enum { USB_DEVICES = 64, USB_ENDPOINTS = 16, USB_REPORT = 1024 };

/* An interrupt IN endpoint, by which a device can report. */
typedef struct usb_endpoint {
    uint8_t interface_number, address;
    bool is_hid;
    uint8_t boot_protocol; /* 0 none, 1 keyboard, 2 mouse */
    uint16_t packet_bytes; /* 1..USB_REPORT; what the device says if that is possible */
} usb_endpoint;

typedef struct usb_device { /* a device that is plugged in */
    uint16_t vendor, product;
    uint8_t bus, number;
    char path[ADDRESS_PATH]; /* of its socket: "1-2.3" */
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
    USB_DENIED, /* this user may not */
    USB_BUSY,   /* another program has claimed it */
    USB_GONE,   /* no longer plugged in, or not answering */
    USB_NO_MEMORY,
    USB_BROKEN /* anything else: usb_failure_text */
} usb_failure;

typedef enum usb_event { USB_NOTHING = 0, USB_REPORTED, USB_LOST } usb_event;

typedef struct usb usb;

/* NULL: no memory, or a system without USB. */
usb *usb_create(const mrt_host *host);
void usb_destroy(usb *self); /* closes; NULL is fine */

/* Writes up to `capacity` devices in the order of their sockets, hubs left out; returns how many
 * there are. Asks no device anything. */
uint32_t usb_look(usb *self, usb_device *out, uint32_t capacity);
/* It was not there at the looks of more than a second and a half ago: rights may follow. */
bool usb_came_lately(const usb *self, const usb_device *device);

/* Takes the interface from the kernel's driver, claims it and begins to listen. */
usb_failure usb_open(usb *self, const usb_device *device, const usb_endpoint *endpoint);
/* Stops listening and gives the interface back to the kernel's driver; accepts a closed one. */
void usb_close(usb *self);
/* In libusb's words, of the last failure. */
const char *usb_failure_text(const usb *self);

/* The report descriptor of the interface that is open; 0: it gives none. Waits half a second at
 * most. */
size_t usb_read_descriptor(usb *self, uint8_t *out, size_t capacity);

/* The next report, in order of arrival. USB_LOST only after the last of them. */
usb_event usb_wait(usb *self, int64_t deadline_ns, usb_report *out);

#endif
