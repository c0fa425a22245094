/* devices.h - the parts of `marotte devices`: what is plugged in (devices.c, devices_list.c), how
 * it is doing and passing it on (devices_watch.c), learning a switch (devices_learn.c). [main] */
#ifndef MAROTTE_UI_DEVICES_H
#define MAROTTE_UI_DEVICES_H
#include "command.h"
#include "spec.h"
#include "stage/input.h"
#include "stage/plugins.h"

enum { DEVICES_INPUTS_MAX = 8, DEVICES_FOUND_MAX = 32 };

typedef struct devices_options {
    plugin_spec input[DEVICES_INPUTS_MAX];
    uint32_t input_count;
    const char *forward; /* "HOST:PORT" or NULL */
    plugin_spec learn;
    double seconds; /* 0: until stopped */
    bool is_json, is_watch, is_learn;
} devices_options;

typedef struct device_found {
    const mrt_plugin_type *type;
    mrt_device device; /* texts printable */
} device_found;

typedef struct devices_found {
    device_found one[DEVICES_FOUND_MAX];
    uint32_t count, beyond; /* beyond: there was no room for so many */
} devices_found;

/* Asks every input plugin that knows of devices. hush: what was said when it was asked before, and
 * is not said again; NULL: nothing. */
CHECKED mrt_result devices_look(devices_found *out, const plugin_list *plugins, log_queue *log,
                                said *hush, error *err);
void devices_print(const devices_found *found, const plugin_list *plugins);
void devices_print_json(const devices_found *found, const plugin_list *plugins);
/* "cyberglove" of "org.marotte.cyberglove": what --input wants. */
const char *devices_plugin_name(const mrt_plugin_type *type);

/* Until *stop, the time is over, or every input is. */
CHECKED mrt_result devices_watch(const devices_options *options, plugin_list *plugins,
                                 log_queue *log, wake *signal, const _Atomic bool *stop,
                                 error *err);
CHECKED mrt_result devices_learn(const devices_options *options, plugin_list *plugins,
                                 log_queue *log, wake *signal, const _Atomic bool *stop,
                                 error *err);

#endif
