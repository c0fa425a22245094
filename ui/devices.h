/* devices.h - the parts of `marotte devices`: what is plugged in (devices.c, devices_list.c), how
 * it is doing and passing it on (devices_watch.c), learning a switch (devices_learn.c). [main] */
#ifndef MAROTTE_UI_DEVICES_H
#define MAROTTE_UI_DEVICES_H
#include "command.h"
#include "stage/spec.h"
#include "stage/device_list.h"
#include "stage/input.h"

enum { DEVICES_INPUTS_MAX = 8 };

typedef struct devices_options {
    plugin_spec input[DEVICES_INPUTS_MAX];
    uint32_t input_count;
    const char *forward; /* "HOST:PORT" or NULL */
    plugin_spec learn;
    double seconds; /* 0: until stopped */
    bool is_json, is_watch, is_learn;
} devices_options;

void devices_print(const device_list *found, const plugin_list *plugins);
void devices_print_json(const device_list *found, const plugin_list *plugins);

/* Until *stop, the time is over, or every input is. */
CHECKED mrt_result devices_watch(const devices_options *options, plugin_list *plugins,
                                 log_queue *log, wake *signal, const _Atomic bool *stop,
                                 error *err);
CHECKED mrt_result devices_learn(const devices_options *options, plugin_list *plugins,
                                 log_queue *log, wake *signal, const _Atomic bool *stop,
                                 error *err);

#endif
