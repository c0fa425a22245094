/* stage/input/device_list.h - what is plugged in: every input plugin that knows devices
 * (MRT_DEVICES) is asked, on an instance of its own that opens nothing. Looks take some
 * milliseconds and may look at the disk. Any one thread at a time, also beside inputs that are
 * read. */
#ifndef MAROTTE_STAGE_DEVICE_LIST_H
#define MAROTTE_STAGE_DEVICE_LIST_H
#include "stage/mapping/instance.h"
#include "stage/mapping/plugins.h"

enum { DEVICE_LIST_MAX = 32 };

typedef struct device_found {
    const mrt_plugin_type *type;
    mrt_device device; /* texts printable */
} device_found;

typedef struct device_list {
    device_found one[DEVICE_LIST_MAX];
    uint32_t count, beyond; /* beyond: there was no room for so many */
} device_list;

/* already_logged: what was logged when it was asked before, and is not said again; NULL: nothing. A
 * plugin that cannot be used is said in the log and hides no device of another. */
CHECKED mrt_result device_list_look(device_list *out, const plugin_list *plugins, log_queue *log,
                                    log_once *already_logged, error *err);
/* Whether an input type knows devices. */
bool device_list_knows(const mrt_plugin_type *type);

#endif
