/* What is plugged in, for a person and for machines. */
#include "base/text.h"
#include "devices.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *state_name(int32_t state)
{
    switch (state) {
    case MRT_DEVICE_READY:
        return "ready";
    case MRT_DEVICE_BUSY:
        return "busy";
    case MRT_DEVICE_DENIED:
        return "denied";
    default:
        return "unsure";
    }
}

const char *devices_plugin_name(const mrt_plugin_type *type)
{
    const char *dot = strrchr(type->id, '.');
    return dot ? dot + 1 : type->id;
}

static const mrt_devices *knows_devices(const mrt_plugin_type *type)
{
    return plugin_interface(type, MRT_INPUT) ? plugin_interface(type, MRT_DEVICES) : NULL;
}

/* ---- looking ---- */

/* A device's name comes from the device: nothing of it may steer a terminal. */
static void make_printable(char *text, size_t capacity)
{
    char copy[512];
    text_copy(copy, capacity < sizeof copy ? capacity : sizeof copy,
              text_view_of(text, strnlen(text, capacity)));
    memcpy(text, copy, strlen(copy) + 1);
}

static void keep(devices_found *out, const mrt_plugin_type *type, const mrt_device *device)
{
    if (out->count == DEVICES_FOUND_MAX) {
        out->beyond += 1;
        return;
    }
    device_found *one = &out->one[out->count++];
    *one = (device_found){type, *device};
    make_printable(one->device.address, sizeof one->device.address);
    make_printable(one->device.name, sizeof one->device.name);
    make_printable(one->device.advice, sizeof one->device.advice);
}

static mrt_result look_with(devices_found *out, const mrt_plugin_type *type, log_queue *log,
                            said *hush, error *err)
{
    instance plugin;
    mrt_result result = instance_create(&plugin, type, CLOCK_REAL, log, err);
    if (result < 0)
        return result;
    mrt_device *list = calloc(DEVICES_FOUND_MAX, sizeof *list);
    if (list) {
        instance_listen(&plugin, NULL, hush);
        uint32_t count = knows_devices(type)->list(plugin.self, list, DEVICES_FOUND_MAX);
        instance_listen_end(&plugin);
        for (uint32_t i = 0; i < count && i < DEVICES_FOUND_MAX; ++i)
            keep(out, type, &list[i]);
        if (count > DEVICES_FOUND_MAX)
            out->beyond += count - DEVICES_FOUND_MAX;
    } else {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the list of devices");
    }
    free(list);
    instance_destroy(&plugin);
    return result;
}

/* A plugin that cannot be used hides no device of another. */
mrt_result devices_look(devices_found *out, const plugin_list *plugins, log_queue *log, said *hush,
                        error *err)
{
    *out = (devices_found){.count = 0};
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (!knows_devices(type))
            continue;
        mrt_result result = look_with(out, type, log, hush, err);
        if (result == MRT_ERR_MEMORY)
            return result;
        if (result < 0 && !(hush && said_before(hush, err->text)))
            log_push(log, MRT_LOG_WARNING, type->id, err->text);
    }
    return MRT_OK;
}

/* ---- telling ---- */

static void print_looked_for(const plugin_list *plugins)
{
    bool any = false;
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (!knows_devices(type))
            continue;
        if (!any)
            puts("no device was found; looked for:");
        printf("  %-12s %s\n", devices_plugin_name(type), type->about);
        any = true;
    }
    if (!any)
        puts("no device was found: no plugin is loaded that knows devices (marotte plugin list)");
}

void devices_print(const devices_found *found, const plugin_list *plugins)
{
    if (found->count == 0)
        print_looked_for(plugins);
    for (uint32_t i = 0; i < found->count; ++i) {
        const device_found *one = &found->one[i];
        printf("%-8s %s\n", state_name(one->device.state), one->device.name);
        printf("         --input %s:%s\n", devices_plugin_name(one->type), one->device.address);
        if (one->device.advice[0])
            printf("         %s\n", one->device.advice);
    }
    if (found->beyond)
        printf("and %u more\n", found->beyond);
}

static json_t *device_to_json(const device_found *one)
{
    char spec[256];
    snprintf(spec, sizeof spec, "%.48s:%s", devices_plugin_name(one->type), one->device.address);
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s}", "plugin", one->type->id, "name",
                     one->device.name, "address", one->device.address, "input", spec, "state",
                     state_name(one->device.state), "advice", one->device.advice);
}

void devices_print_json(const devices_found *found, const plugin_list *plugins)
{
    json_t *devices = json_array(), *looked_for = json_array();
    for (uint32_t i = 0; i < found->count; ++i)
        json_array_append_new(devices, device_to_json(&found->one[i]));
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (knows_devices(type))
            json_array_append_new(
                looked_for, json_pack("{s:s, s:s}", "plugin", type->id, "about", type->about));
    }
    json_t *all = json_pack("{s:o, s:o}", "devices", devices, "looked_for", looked_for);
    json_dumpf(all, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(all);
}
