#include "usb.h"

#include <libusb.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { QUEUE = 16, PACKET_UNKNOWN = 64, DESCRIPTOR_TIMEOUT_MS = 500 };
enum { HID_REPORT_DESCRIPTOR = 0x22 };

static const int64_t lately_ns = 1500000000;
static const int64_t close_patience_ns = 2000000000;

/* A device found in the last search. Another device number at the same USB port is another
 * device. */
typedef struct present_device {
    char path[ADDRESS_PATH];
    uint8_t number;
    int64_t since_ns; /* INT64_MIN: present before the first search */
} present_device;

struct usb {
    const mrt_host *host;
    libusb_context *context;
    libusb_hotplug_callback_handle hotplug;
    bool has_hotplug;
    present_device last_look[USB_DEVICES];
    uint32_t last_count;
    bool has_looked;
    int last_error;

    libusb_device_handle *handle; /* NULL: closed */
    int interface_number;
    bool is_claimed, took_driver;
    struct libusb_transfer *transfer;
    uint8_t buffer[USB_REPORT];
    bool is_flying; /* libusb owns the transfer until its callback */
    bool is_lost, is_closing;
    int woken; /* for libusb_handle_events: an event needs attention */

    usb_report queue[QUEUE];
    uint32_t queue_first, queue_count;
};

/* ---- results ---- */

static usb_failure failure_of(usb *self, int error)
{
    self->last_error = error;
    switch (error) {
    case LIBUSB_SUCCESS:
        return USB_FINE;
    case LIBUSB_ERROR_ACCESS:
        return USB_DENIED;
    case LIBUSB_ERROR_BUSY:
        return USB_BUSY;
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
    case LIBUSB_ERROR_IO:
        return USB_GONE;
    case LIBUSB_ERROR_NO_MEM:
        return USB_NO_MEMORY;
    default:
        return USB_BROKEN;
    }
}

const char *usb_failure_text(const usb *self)
{
    return libusb_strerror(self->last_error);
}

/* ---- sockets ---- */

/* Returns false for a root hub, which has no USB port. */
static bool path_of(libusb_device *device, char out[ADDRESS_PATH])
{
    uint8_t port[7];
    int count = libusb_get_port_numbers(device, port, (int)sizeof port);
    if (count <= 0)
        return false;
    int used = snprintf(out, ADDRESS_PATH, "%u", libusb_get_bus_number(device));
    for (int i = 0; i < count; ++i)
        used +=
            snprintf(out + used, ADDRESS_PATH - (size_t)used, "%c%u", i == 0 ? '-' : '.', port[i]);
    return true;
}

/* Disconnections are reported late, perhaps when another device at the same port is already open.
 * So only the same libusb device counts. */
static int LIBUSB_CALL on_departure(libusb_context *context, libusb_device *device,
                                    libusb_hotplug_event event, void *data)
{
    (void)context;
    (void)event;
    usb *self = data;
    if (self->handle && device == libusb_get_device(self->handle)) {
        self->is_lost = true;
        self->woken = 1;
    }
    return 0;
}

/* ---- the library ---- */

usb *usb_create(const mrt_host *host)
{
    usb *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->host = host;
    if (libusb_init(&self->context) != LIBUSB_SUCCESS) {
        free(self);
        return NULL;
    }
    self->has_hotplug =
        libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) &&
        libusb_hotplug_register_callback(self->context, LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT,
                                         LIBUSB_HOTPLUG_NO_FLAGS, LIBUSB_HOTPLUG_MATCH_ANY,
                                         LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
                                         on_departure, self, &self->hotplug) == LIBUSB_SUCCESS;
    return self;
}

void usb_destroy(usb *self)
{
    if (!self)
        return;
    usb_close(self);
    if (self->has_hotplug)
        libusb_hotplug_deregister_callback(self->context, self->hotplug);
    libusb_exit(self->context);
    free(self);
}

/* Runs libusb until an event or the end of the time. Returns false on failure. */
static bool pump(usb *self, int64_t span_ns)
{
    struct timeval span = {.tv_sec = (time_t)(span_ns / 1000000000),
                           .tv_usec = (suseconds_t)(span_ns % 1000000000 / 1000)};
    int result = libusb_handle_events_timeout_completed(self->context, &span, &self->woken);
    if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_INTERRUPTED)
        self->last_error = result;
    return result == LIBUSB_SUCCESS || result == LIBUSB_ERROR_INTERRUPTED;
}

/* ---- looking ---- */

static uint16_t packet_of(const struct libusb_endpoint_descriptor *endpoint)
{
    uint16_t bytes = endpoint->wMaxPacketSize & 0x7ff;
    if (bytes == 0)
        return PACKET_UNKNOWN;
    return bytes < USB_REPORT ? bytes : USB_REPORT;
}

static void see_endpoint(usb_device *out, const struct libusb_interface_descriptor *setting,
                         const struct libusb_endpoint_descriptor *endpoint)
{
    bool is_in = (endpoint->bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN;
    bool is_interrupt =
        (endpoint->bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_INTERRUPT;
    if (!is_in || !is_interrupt || out->endpoint_count == USB_ENDPOINTS)
        return;
    bool is_hid = setting->bInterfaceClass == LIBUSB_CLASS_HID;
    bool is_boot = is_hid && setting->bInterfaceSubClass == 1;
    out->endpoint[out->endpoint_count++] =
        (usb_endpoint){.interface_number = setting->bInterfaceNumber,
                       .address = endpoint->bEndpointAddress,
                       .is_hid = is_hid,
                       .boot_protocol = is_boot ? setting->bInterfaceProtocol : 0,
                       .packet_bytes = packet_of(endpoint)};
}

/* Uses the first alternate setting of each interface, the default one. */
static void see_endpoints(usb_device *out, libusb_device *device)
{
    struct libusb_config_descriptor *config = NULL;
    if (libusb_get_active_config_descriptor(device, &config) != LIBUSB_SUCCESS)
        return;
    for (int i = 0; i < config->bNumInterfaces; ++i) {
        if (config->interface[i].num_altsetting < 1)
            continue;
        const struct libusb_interface_descriptor *setting = &config->interface[i].altsetting[0];
        for (int k = 0; setting->endpoint && k < setting->bNumEndpoints; ++k)
            see_endpoint(out, setting, &setting->endpoint[k]);
    }
    libusb_free_config_descriptor(config);
}

static bool see(usb_device *out, libusb_device *device)
{
    struct libusb_device_descriptor descriptor;
    *out = (usb_device){0};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS ||
        descriptor.bDeviceClass == LIBUSB_CLASS_HUB || !path_of(device, out->path))
        return false;
    out->vendor = descriptor.idVendor;
    out->product = descriptor.idProduct;
    out->bus = libusb_get_bus_number(device);
    out->number = libusb_get_device_address(device);
    see_endpoints(out, device);
    return true;
}

/* Keeps the first `capacity` devices of the order. */
static void insert(usb_device *out, uint32_t capacity, uint32_t count, const usb_device *device)
{
    uint32_t at = count < capacity ? count : capacity;
    while (at > 0 && address_compare_paths(device->path, out[at - 1].path) < 0) {
        if (at < capacity)
            out[at] = out[at - 1];
        --at;
    }
    if (at < capacity)
        out[at] = *device;
}

static const present_device *find_present(const present_device *last_look, uint32_t count,
                                          const char *path, uint8_t number)
{
    for (uint32_t i = 0; i < count; ++i)
        if (last_look[i].number == number && strcmp(last_look[i].path, path) == 0)
            return &last_look[i];
    return NULL;
}

static void remember_look(usb *self, const usb_device *device, uint32_t count)
{
    present_device now[USB_DEVICES];
    int64_t now_ns = self->host->now_ns(self->host);
    uint32_t kept = count < USB_DEVICES ? count : USB_DEVICES;
    for (uint32_t i = 0; i < kept; ++i) {
        const present_device *known =
            find_present(self->last_look, self->last_count, device[i].path, device[i].number);
        now[i] = (present_device){.number = device[i].number,
                                  .since_ns = self->has_looked ? now_ns : INT64_MIN};
        if (known)
            now[i].since_ns = known->since_ns;
        memcpy(now[i].path, device[i].path, sizeof now[i].path);
    }
    memcpy(self->last_look, now, kept * sizeof *now);
    self->last_count = kept;
    self->has_looked = true;
}

bool usb_is_new(const usb *self, const usb_device *device)
{
    const present_device *known =
        find_present(self->last_look, self->last_count, device->path, device->number);
    return known && known->since_ns > self->host->now_ns(self->host) - lately_ns;
}

uint32_t usb_list(usb *self, usb_device *out, uint32_t capacity)
{
    libusb_device **list = NULL;
    uint32_t count = 0;
    (void)pump(self, 0); /* process pending disconnections */
    ssize_t listed = libusb_get_device_list(self->context, &list);
    for (ssize_t i = 0; i < listed; ++i) {
        usb_device device;
        if (see(&device, list[i]))
            insert(out, capacity, count++, &device);
    }
    if (listed >= 0)
        libusb_free_device_list(list, 1);
    remember_look(self, out, count < capacity ? count : capacity);
    return count;
}

/* ---- listening ---- */

static void submit(usb *self)
{
    int result = libusb_submit_transfer(self->transfer);
    self->is_flying = result == LIBUSB_SUCCESS;
    if (self->is_flying)
        return;
    self->last_error = result;
    self->is_lost = true;
}

/* A zero-length transfer ends a report that fills a packet: not a report. */
static void keep_report(usb *self, const struct libusb_transfer *transfer)
{
    if (transfer->actual_length <= 0 || transfer->actual_length > transfer->length)
        return;
    usb_report *report = &self->queue[(self->queue_first + self->queue_count) % QUEUE];
    report->time_ns = self->host->now_ns(self->host);
    report->size = (size_t)transfer->actual_length;
    memcpy(report->bytes, self->buffer, report->size);
    self->queue_count += 1;
    self->woken = 1;
}

/* While the queue is full, submits no new transfer, so the device waits. usb_wait continues. */
static void LIBUSB_CALL on_transfer(struct libusb_transfer *transfer)
{
    usb *self = transfer->user_data;
    self->is_flying = false;
    if (self->is_closing)
        return;
    switch (transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
        keep_report(self, transfer);
        if (self->queue_count < QUEUE)
            submit(self);
        break;
    case LIBUSB_TRANSFER_TIMED_OUT:
        submit(self);
        break;
    case LIBUSB_TRANSFER_CANCELLED:
        break;
    case LIBUSB_TRANSFER_OVERFLOW:
        self->last_error = LIBUSB_ERROR_OVERFLOW;
        self->is_lost = true;
        break;
    default:
        self->last_error = LIBUSB_ERROR_NO_DEVICE;
        self->is_lost = true;
    }
    if (self->is_lost)
        self->woken = 1;
}

static int claim(usb *self, int interface_number)
{
    if (libusb_kernel_driver_active(self->handle, interface_number) == 1) {
        int result = libusb_detach_kernel_driver(self->handle, interface_number);
        if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_NOT_FOUND)
            return result;
        self->took_driver = result == LIBUSB_SUCCESS;
    }
    int result = libusb_claim_interface(self->handle, interface_number);
    self->is_claimed = result == LIBUSB_SUCCESS;
    return result;
}

static int listen(usb *self, const usb_endpoint *endpoint)
{
    self->transfer = libusb_alloc_transfer(0);
    if (!self->transfer)
        return LIBUSB_ERROR_NO_MEM;
    libusb_fill_interrupt_transfer(self->transfer, self->handle, endpoint->address, self->buffer,
                                   endpoint->packet_bytes, on_transfer, self, 0);
    submit(self);
    return self->is_lost ? self->last_error : LIBUSB_SUCCESS;
}

/* Opens the same device, if it is still present. */
static int open_device(usb *self, const usb_device *device)
{
    libusb_device **list = NULL;
    int result = LIBUSB_ERROR_NO_DEVICE;
    ssize_t listed = libusb_get_device_list(self->context, &list);
    for (ssize_t i = 0; i < listed; ++i) {
        if (libusb_get_bus_number(list[i]) != device->bus ||
            libusb_get_device_address(list[i]) != device->number)
            continue;
        result = libusb_open(list[i], &self->handle);
        if (result != LIBUSB_SUCCESS)
            self->handle = NULL;
        break;
    }
    if (listed >= 0)
        libusb_free_device_list(list, 1);
    return result;
}

usb_failure usb_open(usb *self, const usb_device *device, const usb_endpoint *endpoint)
{
    usb_close(self);
    self->is_lost = false;
    self->queue_first = self->queue_count = 0;
    int result = open_device(self, device);
    if (result != LIBUSB_SUCCESS)
        return failure_of(self, result);
    self->interface_number = endpoint->interface_number;
    result = claim(self, self->interface_number);
    if (result == LIBUSB_SUCCESS)
        result = listen(self, endpoint);
    if (result != LIBUSB_SUCCESS)
        usb_close(self);
    return failure_of(self, result);
}

/* Freeing a transfer that libusb still owns would end the program. So a transfer whose callback
 * never comes is leaked. */
static void stop_listening(usb *self)
{
    if (!self->transfer)
        return;
    int64_t until_ns = self->host->now_ns(self->host) + close_patience_ns;
    if (self->is_flying)
        (void)libusb_cancel_transfer(self->transfer); /* its callback may be pending already */
    while (self->is_flying) {
        int64_t left_ns = until_ns - self->host->now_ns(self->host);
        self->woken = 0;
        if (left_ns <= 0 || !pump(self, left_ns < 100000000 ? left_ns : 100000000))
            break;
    }
    if (!self->is_flying)
        libusb_free_transfer(self->transfer);
    self->transfer = NULL;
}

void usb_close(usb *self)
{
    if (!self->handle)
        return;
    self->is_closing = true;
    stop_listening(self);
    self->is_closing = false;
    if (self->is_claimed)
        (void)libusb_release_interface(self->handle, self->interface_number);
    if (self->took_driver)
        (void)libusb_attach_kernel_driver(self->handle, self->interface_number);
    libusb_close(self->handle);
    self->handle = NULL;
    self->is_claimed = self->took_driver = self->is_flying = false;
    self->queue_first = self->queue_count = 0;
}

size_t usb_read_descriptor(usb *self, uint8_t *out, size_t capacity)
{
    uint16_t asked = (uint16_t)(capacity < UINT16_MAX ? capacity : UINT16_MAX);
    int got = libusb_control_transfer(
        self->handle, (uint8_t)LIBUSB_ENDPOINT_IN | (uint8_t)LIBUSB_RECIPIENT_INTERFACE,
        LIBUSB_REQUEST_GET_DESCRIPTOR, HID_REPORT_DESCRIPTOR << 8, (uint16_t)self->interface_number,
        out, asked, DESCRIPTOR_TIMEOUT_MS);
    return got > 0 ? (size_t)got : 0;
}

static bool take_report(usb *self, usb_report *out)
{
    if (self->queue_count == 0)
        return false;
    *out = self->queue[self->queue_first];
    self->queue_first = (self->queue_first + 1) % QUEUE;
    self->queue_count -= 1;
    if (!self->is_flying && !self->is_lost)
        submit(self);
    return true;
}

usb_event usb_wait(usb *self, int64_t deadline_ns, usb_report *out)
{
    for (;;) {
        if (take_report(self, out))
            return USB_REPORTED;
        if (self->is_lost || !self->handle)
            return USB_LOST;
        int64_t now_ns = self->host->now_ns(self->host);
        int64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;
        self->woken = 0;
        if (!pump(self, left_ns))
            self->is_lost = true;
        if (left_ns == 0 && self->queue_count == 0 && !self->is_lost)
            return USB_NOTHING;
    }
}
