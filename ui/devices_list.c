/* What is plugged in, for a person and for machines. */
#include "devices.h"

#include "base/program.h"

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

/* ---- telling ---- */

static void print_looked_for(const plugin_list *plugins)
{
    bool any = false;
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (!device_list_knows(type))
            continue;
        if (!any)
            puts("no device was found; looked for:");
        printf("  %-12s %s\n", device_list_plugin_name(type), type->about);
        any = true;
    }
    if (!any)
        puts("no device was found: no plugin is loaded that knows devices (marotte plugin list)");
}

void devices_print(const device_list *found, const plugin_list *plugins)
{
    if (found->count == 0)
        print_looked_for(plugins);
    for (uint32_t i = 0; i < found->count; ++i) {
        const device_found *one = &found->one[i];
        printf("%-8s %s\n", state_name(one->device.state), one->device.name);
        char spec[256], word[4 * sizeof spec];
        (void)snprintf(spec, sizeof spec, "%.48s:%s", device_list_plugin_name(one->type),
                       one->device.address);
        program_quote(word, sizeof word, spec);
        printf("         --input %s\n", word);
        if (one->device.advice[0])
            printf("         %s\n", one->device.advice);
    }
    if (found->beyond)
        printf("and %u more\n", found->beyond);
}

static json_t *device_to_json(const device_found *one)
{
    char spec[256];
    snprintf(spec, sizeof spec, "%.48s:%s", device_list_plugin_name(one->type),
             one->device.address);
    return json_pack("{s:s, s:s, s:s, s:s, s:s, s:s}", "plugin", one->type->id, "name",
                     one->device.name, "address", one->device.address, "input", spec, "state",
                     state_name(one->device.state), "advice", one->device.advice);
}

void devices_print_json(const device_list *found, const plugin_list *plugins)
{
    json_t *devices = json_array(), *looked_for = json_array();
    for (uint32_t i = 0; i < found->count; ++i)
        json_array_append_new(devices, device_to_json(&found->one[i]));
    for (uint32_t i = 0; i < plugins->entry_count; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (device_list_knows(type))
            json_array_append_new(
                looked_for, json_pack("{s:s, s:s}", "plugin", type->id, "about", type->about));
    }
    json_t *all = json_pack("{s:o, s:o}", "devices", devices, "looked_for", looked_for);
    json_dumpf(all, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(all);
}
