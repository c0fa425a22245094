#include "pedal_double.h"

#include <linux/usbdevice_fs.h>

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdio.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <umockdev.h>
#include <unistd.h>

enum { UNITS = 512, REPORTS = 64, REPORT_BYTES = 64, STANZA = 16384, PATH = 320 };
enum { CONFIGURATION_BYTES = 34, CONTROL_SETUP_BYTES = 8, HID_REPORT_DESCRIPTOR = 0x22 };

typedef struct urb_slot {
    UMockdevIoctlData *data; /* NULL: none; umockdev's thread alone looks inside */
    bool is_done, is_discarded;
    int status;           /* done: how it ended */
    const uint8_t *bytes; /* done: what came; of the report or of the model */
    size_t size;
} urb_slot;

typedef struct pending_report {
    size_t size;
    uint8_t bytes[REPORT_BYTES];
} pending_report;

struct pedal_unit {
    pedal_double *owner;
    pedal_model model;
    char path[32], system_path[64], node[32], node_file[PATH];
    UMockdevIoctlBase *handler;
    int fifo; /* full: libusb, which waits until it can write, sleeps; -1: not there */
    bool is_plugged, is_dead, is_detached;
    int client_count;       /* that have the node open */
    char driver_folder[32]; /* of the kernel's HID driver, "" without */
    int death_error, fail_error;
    pedal_death death;
    pedal_state state;
    urb_slot interrupt, control;
    pending_report report[REPORTS];
    uint32_t report_first, report_count;
    pending_report reported; /* of the transfer that is done */
};

struct pedal_double {
    UMockdevTestbed *testbed;
    char *root;
    pthread_mutex_t mutex;
    pedal_unit *unit[UNITS];
    uint32_t unit_count;
};

/* Adds to the options of a sanitizer, if the program was built with one. */
static void add_option(const char *variable, const char *option)
{
    const char *options = getenv(variable);
    char joined[512];
    snprintf(joined, sizeof joined, "%s%s%s", options ? options : "", options ? ":" : "", option);
    setenv(variable, joined, 1);
}

int pedal_double_enter(char **arguments)
{
    const char *preloaded = getenv("LD_PRELOAD");
    if (preloaded && strstr(preloaded, "libumockdev-preload"))
        return 0;
    add_option("ASAN_OPTIONS", "verify_asan_link_order=0");
    /* of umockdev, GLib and libudev TSan knows neither locks nor atomics */
    add_option("TSAN_OPTIONS", "ignore_noninstrumented_modules=1");
    size_t count = 0;
    while (arguments[count])
        ++count;
    char **wrapped = calloc(count + 2, sizeof *wrapped);
    if (wrapped) {
        static char wrapper[] = "umockdev-wrapper";
        wrapped[0] = wrapper;
        memcpy(wrapped + 1, arguments, count * sizeof *wrapped);
        execvp(wrapper, wrapped);
        free(wrapped);
    }
    printf("SKIPPED: umockdev-wrapper is not installed\n");
    return 77;
}

/* ---- when libusb wakes ---- */

/* A pipe is writable while it has a free page, and not when it is full. The system is asked itself:
 * umockdev stands before the C library's functions, and when another thread closes a node it may
 * take our file for that one. */
static void let_sleep(const pedal_unit *unit)
{
    static const char page[4096];
    while (syscall(SYS_write, unit->fifo, page, sizeof page) > 0)
        ;
}

static void wake(const pedal_unit *unit)
{
    char page[4096];
    (void)syscall(SYS_read, unit->fifo, page, sizeof page);
}

/* ---- transfers ---- */

static struct usbdevfs_urb *urb_of(const urb_slot *slot)
{
    return (struct usbdevfs_urb *)(void *)slot->data->data;
}

static void finish_urb(urb_slot *slot, int status, const uint8_t *bytes, size_t size)
{
    slot->status = status;
    slot->bytes = bytes;
    slot->size = size;
    slot->is_done = true;
}

static void write_result(const urb_slot *slot)
{
    struct usbdevfs_urb *urb = urb_of(slot);
    size_t offset = urb->type == USBDEVFS_URB_TYPE_CONTROL ? CONTROL_SETUP_BYTES : 0;
    size_t room = (size_t)urb->buffer_length - offset;
    size_t size = slot->size < room ? slot->size : room;
    if (size > 0)
        memcpy((uint8_t *)urb->buffer + offset, slot->bytes, size);
    urb->actual_length = (int)size;
    urb->status = size < slot->size && offset == 0 ? -EOVERFLOW : slot->status;
}

/* Ends the transfer in flight if there is a reason to. */
static void work(pedal_unit *unit)
{
    urb_slot *slot = &unit->interrupt;
    if (slot->data && !slot->is_done) {
        if (slot->is_discarded) {
            finish_urb(slot, -ENOENT, NULL, 0);
        } else if (unit->is_dead) {
            finish_urb(slot, -unit->death_error, NULL, 0);
        } else if (unit->fail_error != 0) {
            finish_urb(slot, -unit->fail_error, NULL, 0);
            unit->fail_error = 0;
        } else if (unit->report_count > 0) {
            unit->reported = unit->report[unit->report_first];
            finish_urb(slot, 0, unit->reported.bytes, unit->reported.size);
            unit->report_first = (unit->report_first + 1) % REPORTS;
            unit->report_count -= 1;
        }
    }
    slot = &unit->control;
    if (slot->data && !slot->is_done && (slot->is_discarded || unit->is_dead))
        finish_urb(slot, slot->is_discarded ? -ENOENT : -unit->death_error, NULL, 0);
    if (unit->interrupt.is_done || unit->control.is_done)
        wake(unit);
    else
        let_sleep(unit);
}

static void answer_control(pedal_unit *unit)
{
    const uint8_t *setup = urb_of(&unit->control)->buffer;
    bool is_report_descriptor = setup[1] == 6 && setup[3] == HID_REPORT_DESCRIPTOR;
    if (unit->model.is_mute_to_control)
        return;
    if (is_report_descriptor && unit->model.report_descriptor_bytes > 0)
        finish_urb(&unit->control, 0, unit->model.report_descriptor,
                   unit->model.report_descriptor_bytes);
    else
        finish_urb(&unit->control, -EPIPE, NULL, 0);
}

static void reply(UMockdevIoctlClient *client, int error)
{
    umockdev_ioctl_client_complete(client, error ? -1 : 0, error);
}

static int submit(pedal_unit *unit, UMockdevIoctlData *argument)
{
    UMockdevIoctlData *data =
        umockdev_ioctl_data_resolve(argument, 0, sizeof(struct usbdevfs_urb), NULL);
    if (!data)
        return EFAULT;
    struct usbdevfs_urb *urb = (struct usbdevfs_urb *)(void *)data->data;
    urb_slot *slot = urb->type == USBDEVFS_URB_TYPE_CONTROL ? &unit->control : &unit->interrupt;
    UMockdevIoctlData *buffer = umockdev_ioctl_data_resolve(
        data, offsetof(struct usbdevfs_urb, buffer), (size_t)urb->buffer_length, NULL);
    bool is_good = buffer && !slot->data &&
                   (slot == &unit->control ||
                    (urb->endpoint == unit->model.endpoint && unit->state.is_claimed));
    if (buffer)
        umockdev_ioctl_data_unref(buffer);
    if (!is_good) {
        umockdev_ioctl_data_unref(data);
        return EINVAL;
    }
    *slot = (urb_slot){.data = data};
    unit->state.submitted += 1;
    unit->state.flying += 1;
    if (slot == &unit->control)
        answer_control(unit);
    return 0;
}

static bool reap_slot(pedal_unit *unit, urb_slot *slot, UMockdevIoctlData *argument)
{
    if (!slot->data || !slot->is_done)
        return false;
    UMockdevIoctlData *pointer = umockdev_ioctl_data_resolve(argument, 0, sizeof(gpointer), NULL);
    write_result(slot);
    umockdev_ioctl_data_set_ptr(pointer, 0, slot->data);
    umockdev_ioctl_data_unref(pointer);
    umockdev_ioctl_data_unref(slot->data);
    *slot = (urb_slot){0};
    unit->state.flying -= 1;
    unit->state.reaped += 1;
    return true;
}

static int reap(pedal_unit *unit, UMockdevIoctlData *argument)
{
    if (reap_slot(unit, &unit->control, argument) || reap_slot(unit, &unit->interrupt, argument))
        return 0;
    return unit->is_dead ? ENODEV : EAGAIN;
}

static int discard(pedal_unit *unit, const UMockdevIoctlData *argument)
{
    gulong address;
    memcpy(&address, argument->data, sizeof address);
    urb_slot *slots[] = {&unit->interrupt, &unit->control};
    for (int i = 0; i < 2; ++i) {
        if (!slots[i]->data || slots[i]->data->client_addr != address || slots[i]->is_done)
            continue;
        slots[i]->is_discarded = true;
        return 0;
    }
    return EINVAL;
}

/* ---- the interface and its driver ---- */

static int get_driver(pedal_unit *unit, UMockdevIoctlData *argument)
{
    if (!unit->state.has_kernel_driver && !unit->state.is_claimed && !unit->model.is_held)
        return ENODATA;
    UMockdevIoctlData *data =
        umockdev_ioctl_data_resolve(argument, 0, sizeof(struct usbdevfs_getdriver), NULL);
    struct usbdevfs_getdriver *driver = (struct usbdevfs_getdriver *)(void *)data->data;
    snprintf(driver->driver, sizeof driver->driver, "%s",
             unit->state.has_kernel_driver ? "usbhid" : "usbfs");
    umockdev_ioctl_data_unref(data);
    return 0;
}

static int drive(pedal_unit *unit, UMockdevIoctlData *argument)
{
    UMockdevIoctlData *data =
        umockdev_ioctl_data_resolve(argument, 0, sizeof(struct usbdevfs_ioctl), NULL);
    int code = ((struct usbdevfs_ioctl *)(void *)data->data)->ioctl_code;
    umockdev_ioctl_data_unref(data);
    if (code == USBDEVFS_DISCONNECT) {
        if (!unit->state.has_kernel_driver)
            return ENODATA;
        unit->state.has_kernel_driver = false;
        return 0;
    }
    if (code != USBDEVFS_CONNECT)
        return ENOTTY;
    if (unit->state.is_claimed || unit->state.has_kernel_driver)
        return EBUSY;
    unit->state.has_kernel_driver = true;
    return 0;
}

static int claim(pedal_unit *unit)
{
    if (unit->state.has_kernel_driver || unit->state.is_claimed || unit->model.is_held)
        return EBUSY;
    unit->state.is_claimed = true;
    return 0;
}

static int get_capabilities(UMockdevIoctlData *argument)
{
    UMockdevIoctlData *data = umockdev_ioctl_data_resolve(argument, 0, sizeof(guint32), NULL);
    guint32 capabilities = USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
    memcpy(data->data, &capabilities, sizeof capabilities);
    umockdev_ioctl_data_unref(data);
    return 0;
}

/* ---- requests ---- */

static void die(pedal_unit *unit, int error)
{
    unit->is_dead = true;
    unit->death_error = error;
    unit->report_count = 0;
    work(unit);
}

static bool is_control_submit(gulong request, UMockdevIoctlData *argument)
{
    if (request != USBDEVFS_SUBMITURB)
        return false;
    UMockdevIoctlData *data =
        umockdev_ioctl_data_resolve(argument, 0, sizeof(struct usbdevfs_urb), NULL);
    bool is_control =
        ((struct usbdevfs_urb *)(void *)data->data)->type == USBDEVFS_URB_TYPE_CONTROL;
    umockdev_ioctl_data_unref(data);
    return is_control;
}

static void die_if_it_is_time(pedal_unit *unit, gulong request, UMockdevIoctlData *argument)
{
    static const gulong at[] = {[PEDAL_DIES_AT_OPEN] = USBDEVFS_GET_CAPABILITIES,
                                [PEDAL_DIES_AT_DETACH] = USBDEVFS_IOCTL,
                                [PEDAL_DIES_AT_CLAIM] = USBDEVFS_CLAIMINTERFACE,
                                [PEDAL_DIES_AT_CONTROL] = USBDEVFS_SUBMITURB,
                                [PEDAL_DIES_AT_SUBMIT] = USBDEVFS_SUBMITURB};
    if (unit->death == PEDAL_LIVES || unit->is_dead || request != at[unit->death] ||
        (request == USBDEVFS_SUBMITURB &&
         is_control_submit(request, argument) != (unit->death == PEDAL_DIES_AT_CONTROL)))
        return;
    die(unit, ESHUTDOWN);
}

/* An errno, or -1: no such request. */
static int answer(pedal_unit *unit, gulong request, UMockdevIoctlData *argument)
{
    die_if_it_is_time(unit, request, argument);
    if (request == USBDEVFS_REAPURBNDELAY || request == USBDEVFS_REAPURB)
        return reap(unit, argument);
    if (request == (gulong)USBDEVFS_DISCARDURB)
        return discard(unit, argument);
    if (unit->is_dead)
        return ENODEV;
    switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
        return get_capabilities(argument);
    case USBDEVFS_GETDRIVER:
        return get_driver(unit, argument);
    case USBDEVFS_IOCTL:
        return drive(unit, argument);
    case USBDEVFS_CLAIMINTERFACE:
        return claim(unit);
    case USBDEVFS_RELEASEINTERFACE:
        unit->state.is_claimed = false;
        return 0;
    case USBDEVFS_SUBMITURB:
        return submit(unit, argument);
    default:
        return -1;
    }
}

static gboolean on_ioctl(UMockdevIoctlBase *handler, UMockdevIoctlClient *client, gpointer data)
{
    (void)handler;
    pedal_unit *unit = data;
    pthread_mutex_lock(&unit->owner->mutex);
    unit->state.asked += 1;
    int error = answer(unit, umockdev_ioctl_client_get_request(client),
                       umockdev_ioctl_client_get_arg(client));
    work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
    if (error < 0)
        return FALSE;
    reply(client, error);
    return TRUE;
}

/* ---- sockets ---- */

typedef struct text {
    char bytes[STANZA];
    size_t used;
} text;

__attribute__((format(printf, 2, 3))) static void put(text *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    out->used += (size_t)vsnprintf(out->bytes + out->used, STANZA - out->used, format, arguments);
    va_end(arguments);
    if (out->used >= STANZA)
        abort();
}

static void put_hex(text *out, const uint8_t *bytes, size_t size)
{
    for (size_t i = 0; i < size; ++i)
        put(out, "%02x", bytes[i]);
}

/* "1-4.2" is below "1-4" is below usb1. */
static void system_path_of(char out[64], const char *path)
{
    size_t used = (size_t)snprintf(out, 64, "/devices/usb%.*s", (int)strcspn(path, "-"), path);
    for (size_t end = strcspn(path, "-"); path[end];) {
        end += 1 + strcspn(path + end + 1, ".");
        used += (size_t)snprintf(out + used, 64 - used, "/%.*s", (int)end, path);
    }
}

static void put_device(text *out, const char *system_path, uint32_t bus, uint32_t number,
                       const uint8_t *descriptors, size_t size)
{
    put(out, "P: %s\nN: bus/usb/%03u/%03u\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\n", system_path,
        bus, number);
    put(out, "E: BUSNUM=%03u\nE: DEVNUM=%03u\nE: DEVNAME=/dev/bus/usb/%03u/%03u\n", bus, number,
        bus, number);
    put(out, "A: busnum=%u\\n\nA: devnum=%u\\n\nA: speed=12\\n\nA: bConfigurationValue=1\\n\n", bus,
        number);
    put(out, "H: descriptors=");
    put_hex(out, descriptors, size);
    put(out, "\n");
}

static void add(pedal_double *self, const text *stanza)
{
    GError *error = NULL;
    if (umockdev_testbed_add_from_string(self->testbed, stanza->bytes, &error))
        return;
    fprintf(stderr, "%s\n", error->message);
    abort();
}

void pedal_double_plug_hub(pedal_double *self, const char *path, uint32_t number)
{
    static const uint8_t hub[] = {18, 1, 0, 2, 9, 0,  1, 64, 0x6b, 0x1d, 2,    0, 0, 1, 0,
                                  0,  0, 1, 9, 2, 25, 0, 1,  1,    0,    0xe0, 0, 9, 4, 0,
                                  0,  1, 9, 0, 0, 0,  7, 5,  0x81, 3,    4,    0, 12};
    char system_path[64];
    static text stanza;
    stanza.used = 0;
    system_path_of(system_path, path);
    put_device(&stanza, system_path, (uint32_t)strtoul(path, NULL, 10), number, hub, sizeof hub);
    put(&stanza, "\n");
    add(self, &stanza);
}

static size_t write_descriptors(const pedal_model *model, uint8_t *out)
{
    uint16_t total = model->told_bytes ? model->told_bytes : CONFIGURATION_BYTES;
    uint16_t report = (uint16_t)model->report_descriptor_bytes;
    uint8_t endpoints = model->told_endpoints ? model->told_endpoints : 1;
    const uint8_t bytes[] = {
        18, 1, 0, 2, 0, 0, 0, 8, (uint8_t)model->vendor, (uint8_t)(model->vendor >> 8),
        (uint8_t)model->product, (uint8_t)(model->product >> 8), 0x20, 0x01, 1, 2, 0, 1,
        /* configuration */
        9, 2, (uint8_t)total, (uint8_t)(total >> 8), 1, 1, 0, 0x80, 50,
        /* interface */
        9, 4, 0, 0, endpoints, 3, model->boot_protocol ? 1 : 0, model->boot_protocol, 0,
        /* HID */
        9, 0x21, 0x11, 1, 0, 1, 0x22, (uint8_t)report, (uint8_t)(report >> 8),
        /* endpoint */
        7, 5, model->endpoint, 3, (uint8_t)model->packet_bytes, (uint8_t)(model->packet_bytes >> 8),
        8};
    size_t size = sizeof bytes - model->cut_bytes;
    memcpy(out, bytes, size);
    return size;
}

static void put_interface(text *out, pedal_unit *unit)
{
    const pedal_model *model = &unit->model;
    put(out, "P: %s/%s:1.0\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\n", unit->system_path,
        unit->path);
    put(out, "L: driver=../../../../bus/usb/drivers/%s\n\n", model->is_held ? "usbfs" : "usbhid");
    if (model->is_held || model->is_unread || model->report_descriptor_bytes == 0)
        return;
    snprintf(unit->driver_folder, sizeof unit->driver_folder, "0003:%04X:%04X.%04X", model->vendor,
             model->product, unit->owner->unit_count + 1);
    put(out, "P: %s/%s:1.0/%s\nE: SUBSYSTEM=hid\nH: report_descriptor=", unit->system_path,
        unit->path, unit->driver_folder);
    put_hex(out, model->report_descriptor, model->report_descriptor_bytes);
    put(out, "\n\n");
}

/* umockdev's node is a file, always writable, at which libusb would spin. */
static void make_fifo(pedal_unit *unit)
{
    unlink(unit->node_file);
    if (mkfifo(unit->node_file, 0666) != 0)
        abort();
    chmod(unit->node_file, 0666);
    int fifo = (int)syscall(SYS_openat, AT_FDCWD, unit->node_file, O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fifo < 0)
        abort();
    pthread_mutex_lock(&unit->owner->mutex);
    unit->fifo = fifo;
    work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
}

static void attach(pedal_unit *unit)
{
    GError *error = NULL;
    unit->handler = umockdev_ioctl_base_new();
    g_signal_connect(unit->handler, "handle-ioctl", G_CALLBACK(on_ioctl), unit);
    if (!umockdev_testbed_attach_ioctl(unit->owner->testbed, unit->node, unit->handler, &error)) {
        fprintf(stderr, "%s\n", error->message);
        abort();
    }
    /* umockdev goes there before it knows whether the node may be opened */
    char socket[PATH];
    snprintf(socket, sizeof socket, "%s/ioctl%s", unit->owner->root, unit->node);
    chmod(socket, 0777);
}

pedal_unit *pedal_double_plug(pedal_double *self, const char *path, uint32_t number,
                              const pedal_model *model)
{
    static text stanza;
    uint8_t descriptors[128];
    pedal_unit *unit = calloc(1, sizeof *unit);
    if (!unit || self->unit_count == UNITS)
        abort();
    uint32_t bus = (uint32_t)strtoul(path, NULL, 10);
    *unit = (pedal_unit){.owner = self, .model = *model, .fifo = -1, .is_plugged = true};
    unit->state.has_kernel_driver = !model->is_held;
    snprintf(unit->path, sizeof unit->path, "%s", path);
    system_path_of(unit->system_path, path);
    snprintf(unit->node, sizeof unit->node, "/dev/bus/usb/%03u/%03u", bus, number);
    snprintf(unit->node_file, sizeof unit->node_file, "%s%s", self->root, unit->node);
    attach(unit);
    stanza.used = 0;
    put_device(&stanza, unit->system_path, bus, number, descriptors,
               write_descriptors(model, descriptors));
    if (model->name)
        put(&stanza, "A: product=%s\\n\n", model->name);
    put(&stanza, "\n");
    put_interface(&stanza, unit);
    add(self, &stanza);
    make_fifo(unit);
    self->unit[self->unit_count++] = unit;
    return unit;
}

void pedal_unit_die(pedal_unit *unit, int error)
{
    pthread_mutex_lock(&unit->owner->mutex);
    if (!unit->is_dead)
        die(unit, error);
    pthread_mutex_unlock(&unit->owner->mutex);
}

/* Children first: umockdev leaves links of theirs behind otherwise. */
static void remove_folders(const pedal_unit *unit)
{
    char device[96], interface[160], driver[224];
    UMockdevTestbed *testbed = unit->owner->testbed;
    snprintf(device, sizeof device, "/sys%s", unit->system_path);
    snprintf(interface, sizeof interface, "%s/%s:1.0", device, unit->path);
    snprintf(driver, sizeof driver, "%s/%s", interface, unit->driver_folder);
    umockdev_testbed_uevent(testbed, device, "remove");
    if (unit->driver_folder[0])
        umockdev_testbed_remove_device(testbed, driver);
    umockdev_testbed_remove_device(testbed, interface);
    umockdev_testbed_remove_device(testbed, device);
}

void pedal_unit_unplug(pedal_unit *unit, int error)
{
    pedal_unit_die(unit, error);
    remove_folders(unit);
    unlink(unit->node_file);
    pthread_mutex_lock(&unit->owner->mutex);
    (void)syscall(SYS_close, unit->fifo);
    unit->fifo = -1;
    pthread_mutex_unlock(&unit->owner->mutex);
    umockdev_testbed_detach_ioctl(unit->owner->testbed, unit->node, NULL);
    unit->is_plugged = false;
}

/* ---- what it does ---- */

void pedal_unit_report(pedal_unit *unit, const uint8_t *bytes, size_t size)
{
    pthread_mutex_lock(&unit->owner->mutex);
    if (size > REPORT_BYTES || unit->report_count == REPORTS)
        abort();
    pending_report *report = &unit->report[(unit->report_first + unit->report_count) % REPORTS];
    report->size = size;
    if (size > 0)
        memcpy(report->bytes, bytes, size);
    unit->report_count += 1;
    work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
}

void pedal_unit_fail(pedal_unit *unit, int error)
{
    pthread_mutex_lock(&unit->owner->mutex);
    unit->fail_error = error;
    work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
}

void pedal_unit_dies_at(pedal_unit *unit, pedal_death death)
{
    pthread_mutex_lock(&unit->owner->mutex);
    unit->death = death;
    pthread_mutex_unlock(&unit->owner->mutex);
}

pedal_state pedal_unit_state(pedal_unit *unit)
{
    pthread_mutex_lock(&unit->owner->mutex);
    pedal_state state = unit->state;
    pthread_mutex_unlock(&unit->owner->mutex);
    return state;
}

void pedal_unit_set_mode(pedal_unit *unit, unsigned mode)
{
    if (chmod(unit->node_file, (mode_t)mode) != 0)
        abort();
}

/* ---- the machine ---- */

pedal_double *pedal_double_create(void)
{
    pedal_double *self = calloc(1, sizeof *self);
    if (!self)
        abort();
    pthread_mutex_init(&self->mutex, NULL);
    self->testbed = umockdev_testbed_new();
    self->root = umockdev_testbed_get_root_dir(self->testbed);
    chmod(self->root, 0755); /* for users other than the one who runs the test */
    pedal_double_plug_hub(self, "1", 1);
    return self;
}

static void finish_unit(pedal_unit *unit)
{
    if (unit->is_plugged)
        pedal_unit_unplug(unit, ESHUTDOWN);
    g_object_unref(unit->handler);
    if (unit->interrupt.data)
        umockdev_ioctl_data_unref(unit->interrupt.data);
    if (unit->control.data)
        umockdev_ioctl_data_unref(unit->control.data);
    free(unit);
}

void pedal_double_destroy(pedal_double *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < self->unit_count; ++i)
        finish_unit(self->unit[i]);
    g_object_unref(self->testbed);
    g_free(self->root);
    pthread_mutex_destroy(&self->mutex);
    free(self);
}
