/* device/pedal_requests.h - a pedal's state, and what it answers when libusb asks its node:
 * transfers, the interface and its driver. For the files of pedal_double.h alone. Threads: behind
 * the double's mutex. */
#ifndef MAROTTE_TESTS_PEDAL_REQUESTS_H
#define MAROTTE_TESTS_PEDAL_REQUESTS_H
#include "pedal_double.h"

#include <pthread.h>
#include <umockdev.h>

enum { PEDAL_UNITS = 512, PEDAL_REPORTS = 64, PEDAL_REPORT_BYTES = 64, PEDAL_PATH = 320 };

typedef struct urb_slot {
    UMockdevIoctlData *data; /* NULL: none; umockdev's thread alone looks inside */
    bool is_done, is_discarded;
    int status;           /* done: how it ended */
    const uint8_t *bytes; /* done: what came; of the report or of the model */
    size_t size;
} urb_slot;

typedef struct pending_report {
    size_t size;
    uint8_t bytes[PEDAL_REPORT_BYTES];
} pending_report;

struct pedal_unit {
    pedal_double *owner;
    pedal_model model;
    char path[32], system_path[64], node[32], node_file[PEDAL_PATH];
    UMockdevIoctlBase *handler;
    int fifo; /* full: libusb, which waits until it can write, sleeps; -1: not there */
    bool is_plugged, is_dead, is_detached;
    int client_count;       /* that have the node open */
    char driver_folder[32]; /* of the kernel's HID driver, "" without */
    int death_error, fail_error;
    pedal_death death;
    pedal_state state;
    urb_slot interrupt, control;
    pending_report report[PEDAL_REPORTS];
    uint32_t report_first, report_count;
    pending_report reported; /* of the transfer that is done */
};

struct pedal_double {
    UMockdevTestbed *testbed;
    char *root;
    pthread_mutex_t mutex;
    pedal_unit *unit[PEDAL_UNITS];
    uint32_t unit_count;
};

/* Ends the transfer in flight if there is a reason to. */
void pedal_requests_work(pedal_unit *unit);
void pedal_requests_die(pedal_unit *unit, int error);
/* Of umockdev's thread; data: the unit. */
gboolean pedal_requests_answer(UMockdevIoctlBase *handler, UMockdevIoctlClient *client,
                               gpointer data);

#endif
