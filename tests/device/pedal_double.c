#include "pedal_double.h"
#include "pedal_requests.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { STANZA = 16384, CONFIGURATION_BYTES = 34 };

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
    pedal_requests_work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
}

static void attach(pedal_unit *unit)
{
    GError *error = NULL;
    unit->handler = umockdev_ioctl_base_new();
    g_signal_connect(unit->handler, "handle-ioctl", G_CALLBACK(pedal_requests_answer), unit);
    if (!umockdev_testbed_attach_ioctl(unit->owner->testbed, unit->node, unit->handler, &error)) {
        fprintf(stderr, "%s\n", error->message);
        abort();
    }
    /* umockdev goes there before it knows whether the node may be opened */
    char socket[PEDAL_PATH];
    snprintf(socket, sizeof socket, "%s/ioctl%s", unit->owner->root, unit->node);
    chmod(socket, 0777);
}

pedal_unit *pedal_double_plug(pedal_double *self, const char *path, uint32_t number,
                              const pedal_model *model)
{
    static text stanza;
    uint8_t descriptors[128];
    pedal_unit *unit = calloc(1, sizeof *unit);
    if (!unit || self->unit_count == PEDAL_UNITS)
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
        pedal_requests_die(unit, error);
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
    if (size > PEDAL_REPORT_BYTES || unit->report_count == PEDAL_REPORTS)
        abort();
    pending_report *report =
        &unit->report[(unit->report_first + unit->report_count) % PEDAL_REPORTS];
    report->size = size;
    if (size > 0)
        memcpy(report->bytes, bytes, size);
    unit->report_count += 1;
    pedal_requests_work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
}

void pedal_unit_fail(pedal_unit *unit, int error)
{
    pthread_mutex_lock(&unit->owner->mutex);
    unit->fail_error = error;
    pedal_requests_work(unit);
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
