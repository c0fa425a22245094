/* marotte plugin list: which plugins there are. */
#include "plugin.h"

#include "stage/mapping/plugins.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

static const char *kind_of(const mrt_plugin_type *type)
{
    static const char *const kinds[8] = {"none",
                                         "input",
                                         "mapping",
                                         "input and mapping",
                                         "output",
                                         "input and output",
                                         "mapping and output",
                                         "input, mapping and output"};
    unsigned kind = plugin_interface(type, MRT_INPUT) ? 1u : 0u;
    kind |= plugin_interface(type, MRT_MAPPING) ? 2u : 0u;
    kind |= plugin_interface(type, MRT_OUTPUT) ? 4u : 0u;
    return kinds[kind];
}

static void print_params(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i) {
        const mrt_param *p = &type->params[i];
        if (p->flags & MRT_PARAM_HIDDEN)
            continue;
        printf("    %-14s %-14s %g .. %g %s%s(%g)  %s\n", p->group, p->name, p->min, p->max,
               p->unit, p->unit[0] ? " " : "", p->initial, p->help);
        for (size_t k = 0; p->labels && p->labels[k] && (double)k <= p->max - p->min; ++k)
            printf("    %-14s %-14s   %g = %s\n", "", "", p->min + (double)k, p->labels[k]);
    }
}

static void print_list(const plugin_list *list, bool with_params)
{
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        printf("%-24s %-16s %-6s %s\n", type->id, kind_of(type), type->version, type->about);
        printf("    from %s\n", list->entry[i].path);
        if (with_params)
            print_params(type);
    }
    for (uint32_t i = 0; i < list->refusal_count; ++i)
        printf("not used: %s: %s\n", list->refusal[i].path, list->refusal[i].reason);
}

static json_t *param_to_json(const mrt_param *p)
{
    json_t *out = json_pack("{s:i, s:s, s:s, s:s, s:s, s:f, s:f, s:f}", "id", (int)p->id, "name",
                            p->name, "group", p->group, "unit", p->unit, "help", p->help, "min",
                            p->min, "max", p->max, "initial", p->initial);
    if (p->labels) {
        json_t *labels = json_array();
        for (size_t k = 0; p->labels[k] && (double)k <= p->max - p->min; ++k)
            json_array_append_new(labels, json_string(p->labels[k]));
        json_object_set_new(out, "labels", labels);
    }
    return out;
}

static void print_json(const plugin_list *list)
{
    json_t *plugins = json_array();
    json_t *refused = json_array();
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        json_t *params = json_array();
        for (uint32_t k = 0; k < type->param_count; ++k)
            json_array_append_new(params, param_to_json(&type->params[k]));
        json_array_append_new(
            plugins, json_pack("{s:s, s:s, s:s, s:s, s:s, s:s, s:o}", "id", type->id, "name",
                               type->name, "kind", kind_of(type), "version", type->version, "about",
                               type->about, "path", list->entry[i].path, "params", params));
    }
    for (uint32_t i = 0; i < list->refusal_count; ++i)
        json_array_append_new(refused, json_pack("{s:s, s:s}", "path", list->refusal[i].path,
                                                 "reason", list->refusal[i].reason));
    json_t *all = json_pack("{s:o, s:o}", "plugins", plugins, "refused", refused);
    json_dumpf(all, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(all);
}

int plugin_list_run(int argc, char **argv)
{
    bool as_json = false, with_params = false;
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--json") == 0)
            as_json = true;
        else if (strcmp(argv[i], "--params") == 0)
            with_params = true;
        else
            return command_usage(&command_plugin, "\"%s\" is not expected here", argv[i]);
    }
    plugin_list list = {0};
    error err = {""};
    if (plugin_list_load(&list, &err) < 0)
        return command_failed(&command_plugin, &err);
    if (as_json)
        print_json(&list);
    else
        print_list(&list, with_params);
    plugin_list_destroy(&list);
    return COMMAND_DONE;
}
