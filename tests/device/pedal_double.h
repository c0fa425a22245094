/* device/pedal_double.h - USB sockets and foot pedals without hardware: libumockdev stands in for
 * the kernel's usbfs, sysfs and hot-plug events, so that the real libusb is what runs. A pedal has
 * a kernel driver that must be detached, answers for its descriptors (truly or not), reports when
 * told to, and can be pulled out. For programs that run under umockdev-wrapper. The functions may
 * be called from one thread; what they stand for is answered from another. */
#ifndef MAROTTE_TESTS_PEDAL_DOUBLE_H
#define MAROTTE_TESTS_PEDAL_DOUBLE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct pedal_model {
    uint16_t vendor, product;
    const char *name;
    uint8_t boot_protocol; /* 0 none, 1 keyboard, 2 mouse */
    uint8_t endpoint;
    uint16_t packet_bytes;
    const uint8_t *report_descriptor;
    size_t report_descriptor_bytes;
    bool is_unread;          /* the kernel does not have the report descriptor: ask the device */
    bool is_held;            /* another program has claimed it */
    uint8_t told_endpoints;  /* 0: the truth, 1 */
    uint16_t told_bytes;     /* of the configuration; 0: the truth */
    uint16_t cut_bytes;      /* so many of the configuration's bytes are missing */
    bool is_mute_to_control; /* does not answer control requests at all */
} pedal_model;

/* Where a pedal is pulled out while it is opened. */
typedef enum pedal_death {
    PEDAL_LIVES = 0,
    PEDAL_DIES_AT_OPEN, /* the first thing that libusb asks of the node */
    PEDAL_DIES_AT_DETACH,
    PEDAL_DIES_AT_CLAIM,
    PEDAL_DIES_AT_CONTROL,
    PEDAL_DIES_AT_SUBMIT
} pedal_death;

typedef struct pedal_state {
    bool has_kernel_driver, is_claimed;
    uint32_t flying, submitted, reaped, asked; /* transfers; all requests */
} pedal_state;

typedef struct pedal_double pedal_double;
typedef struct pedal_unit pedal_unit;

/* Goes on in the mock environment, starting this program again in it if need be. 77: it cannot. */
int pedal_double_enter(char **arguments);

pedal_double *pedal_double_create(void);
void pedal_double_destroy(pedal_double *self); /* and its units */
/* A hub in a socket, so that "1-4.2" can be used after it. */
void pedal_double_plug_hub(pedal_double *self, const char *path, uint32_t number);
/* The unit lives until the double is destroyed, and is of no use once unplugged. */
pedal_unit *pedal_double_plug(pedal_double *self, const char *path, uint32_t number,
                              const pedal_model *model);
/* Transfers in flight come back with this error (EPROTO, ESHUTDOWN); then there is no device. */
void pedal_unit_unplug(pedal_unit *unit, int error);
/* As above, but the news of it does not come: the cable is out, the system has not noticed. */
void pedal_unit_die(pedal_unit *unit, int error);

/* What the pedal reports next: delivered when a transfer is there to take it. 0 bytes: a transfer
 * of zero length. More than the transfer has room for: an overflow. */
void pedal_unit_report(pedal_unit *unit, const uint8_t *bytes, size_t size);
/* The transfer in flight, or the next, ends with this error; the device stays. */
void pedal_unit_fail(pedal_unit *unit, int error);
void pedal_unit_dies_at(pedal_unit *unit, pedal_death death);
pedal_state pedal_unit_state(pedal_unit *unit);
/* The node's file mode: 0600 keeps other users out. */
void pedal_unit_set_mode(pedal_unit *unit, unsigned mode);

#endif
