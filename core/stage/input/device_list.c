#include "stage/input/device_list.h"

#include "base/text.h"

#include <stdlib.h>
#include <string.h>

static const mrt_devices *knows_devices(const mrt_plugin_type *type)
{
    return plugin_interface(type, MRT_INPUT) ? plugin_interface(type, MRT_DEVICES) : NULL;
}

/* ---- scan ---- */

/* The texts come from the device, so they may contain control characters for the terminal. */
static void make_printable(char *text, size_t capacity)
{
    text[capacity - 1] = '\0';
    text_make_printable(text);
}

static void keep(device_list *out, const mrt_plugin_type *type, const mrt_device *device)
{
    if (out->count == DEVICE_LIST_MAX) {
        out->beyond += 1;
        return;
    }
    device_found *one = &out->one[out->count++];
    *one = (device_found){type, *device};
    make_printable(one->device.address, sizeof one->device.address);
    make_printable(one->device.name, sizeof one->device.name);
    make_printable(one->device.advice, sizeof one->device.advice);
}

static mrt_result look_with(device_list *out, const mrt_plugin_type *type, log_queue *log,
                            log_once *already_logged, error *err)
{
    instance plugin;
    mrt_result result = instance_create(&plugin, type, CLOCK_REAL, log, err);
    if (result < 0)
        return result;
    mrt_device *list = calloc(DEVICE_LIST_MAX, sizeof *list);
    if (list) {
        instance_listen(&plugin, NULL, already_logged);
        uint32_t count = knows_devices(type)->list(plugin.self, list, DEVICE_LIST_MAX);
        instance_listen_end(&plugin);
        for (uint32_t i = 0; i < count && i < DEVICE_LIST_MAX; ++i)
            keep(out, type, &list[i]);
        if (count > DEVICE_LIST_MAX)
            out->beyond += count - DEVICE_LIST_MAX;
    } else {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the list of devices");
    }
    free(list);
    instance_destroy(&plugin);
    return result;
}

bool device_list_can_list(const mrt_plugin_type *type)
{
    return knows_devices(type) != NULL;
}

mrt_result device_list_scan(device_list *out, const plugin_list *plugins, log_queue *log,
                            log_once *already_logged, error *err)
{
    *out = (device_list){.count = 0};
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (!device_list_can_list(type))
            continue;
        mrt_result result = look_with(out, type, log, already_logged, err);
        if (result == MRT_ERR_MEMORY)
            return result;
        if (result < 0 && !(already_logged && log_once_repeats(already_logged, err->text)))
            log_push(log, MRT_LOG_WARNING, type->id, err->text);
    }
    return MRT_OK;
}
