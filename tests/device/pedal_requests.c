#include "pedal_requests.h"

#include <linux/usbdevice_fs.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { CONTROL_SETUP_BYTES = 8, HID_REPORT_DESCRIPTOR = 0x22 };

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

void pedal_requests_work(pedal_unit *unit)
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
            unit->report_first = (unit->report_first + 1) % PEDAL_REPORTS;
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

void pedal_requests_die(pedal_unit *unit, int error)
{
    unit->is_dead = true;
    unit->death_error = error;
    unit->report_count = 0;
    pedal_requests_work(unit);
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
    pedal_requests_die(unit, ESHUTDOWN);
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

gboolean pedal_requests_answer(UMockdevIoctlBase *handler, UMockdevIoctlClient *client,
                               gpointer data)
{
    (void)handler;
    pedal_unit *unit = data;
    pthread_mutex_lock(&unit->owner->mutex);
    unit->state.asked += 1;
    int error = answer(unit, umockdev_ioctl_client_get_request(client),
                       umockdev_ioctl_client_get_arg(client));
    pedal_requests_work(unit);
    pthread_mutex_unlock(&unit->owner->mutex);
    if (error < 0)
        return FALSE;
    reply(client, error);
    return TRUE;
}
