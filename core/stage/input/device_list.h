/* stage/input/device_list.h - lists the connected devices. It asks every input plugin that can list
 * devices (MRT_DEVICES), with an own instance that opens nothing. A scan takes some milliseconds
 * and may read the disk. One thread at a time, any, also while inputs are being read. */
#ifndef MAROTTE_STAGE_DEVICE_LIST_H
#define MAROTTE_STAGE_DEVICE_LIST_H
#include "stage/mapping/instance.h"
#include "stage/mapping/plugins.h"

enum { DEVICE_LIST_MAX = 32 };

typedef struct device_found {
    const mrt_plugin_type *type;
    mrt_device device; /* its texts are printable */
} device_found;

typedef struct device_list {
    device_found one[DEVICE_LIST_MAX];
    uint32_t count, beyond; /* beyond: devices for which there was no room */
} device_list;

/* already_logged: texts of earlier scans, which are not logged again; NULL: none. A plugin that
 * fails is logged. The devices of the other plugins are still listed. */
CHECKED mrt_result device_list_scan(device_list *out, const plugin_list *plugins, log_queue *log,
                                    log_once *already_logged, error *err);
/* Returns whether an input type can list devices. */
bool device_list_can_list(const mrt_plugin_type *type);

#endif
