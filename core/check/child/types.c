#include "check/child/types.h"
#include "check/child/place.h"
#include "check/child/tell.h"
#include "check/rules.h"

#include <dlfcn.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const void *open_library(const char *path)
{
    struct stat status;
    char whole[PATH_MAX]; /* dlopen looks for a name without a slash in the system's folders */
    if (!realpath(path, whole) || stat(whole, &status) != 0 || !S_ISREG(status.st_mode)) {
        tell_failed(RULE_LIBRARY_LOAD, "%s is no file: name the .so that the build made", path);
        return NULL;
    }
    tell_doing(RULE_LIBRARY_LOAD, "loading the library");
    void *library = dlopen(whole, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *why = dlerror();
        tell_failed(RULE_LIBRARY_LOAD, "%s", why ? why : "it cannot be loaded");
        return NULL;
    }
    tell_ok(RULE_LIBRARY_LOAD, "%s", "");
    place_learn(whole);
    const void *table = dlsym(library, "marotte_plugins");
    if (!table)
        tell_failed(RULE_LIBRARY_SYMBOL,
                    "it exports no marotte_plugins: write MRT_EXPORT const mrt_plugin_type *const "
                    "marotte_plugins[] = {&type, NULL}; (in C++ within extern \"C\")");
    return table;
}

bool types_load(types *out, const char *path)
{
    *out = (types){0};
    const mrt_plugin_type *const *table = open_library(path);
    if (!table)
        return false;
    tell_doing(RULE_LIBRARY_SYMBOL, "reading marotte_plugins");
    for (; table[out->count]; ++out->count) {
        if (out->count == TYPES_MAX) {
            tell_failed(RULE_LIBRARY_SYMBOL, "marotte_plugins has no NULL among its first %d types",
                        TYPES_MAX + 1);
            return false;
        }
        const mrt_plugin_type *type = table[out->count];
        if (type->abi != MRT_ABI) {
            tell_failed(RULE_LIBRARY_ABI, "it is built for abi %u, this is %u: build it again",
                        type->abi, MRT_ABI);
            return false;
        }
        out->type[out->count] = type;
    }
    if (out->count == 0)
        tell_failed(RULE_LIBRARY_SYMBOL, "marotte_plugins has no type before its NULL");
    return out->count > 0;
}

const void *types_interface(const mrt_plugin_type *type, const char *id)
{
    for (int i = 0; type->interfaces && i < TYPES_INTERFACES_MAX && type->interfaces[i].id; ++i)
        if (strcmp(type->interfaces[i].id, id) == 0)
            return type->interfaces[i].functions;
    return NULL;
}

uint32_t types_concerns(const mrt_plugin_type *type)
{
    static const struct {
        const char *id;
        uint32_t concerns;
    } known[] = {{MRT_MAPPING, CONCERNS_MAPPING}, {MRT_INPUT, CONCERNS_INPUT},
                 {MRT_OUTPUT, CONCERNS_OUTPUT},   {MRT_STATE, CONCERNS_STATE},
                 {MRT_RESUME, CONCERNS_RESUME},   {MRT_DEVICES, CONCERNS_DEVICES}};
    uint32_t concerns = CONCERNS_TYPE;
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i)
        if (types_interface(type, known[i].id))
            concerns |= known[i].concerns;
    const mrt_input *input = types_interface(type, MRT_INPUT);
    if (input && (input->flags & MRT_INPUT_RECORDED))
        concerns |= CONCERNS_RECORDED;
    if (type->param_count > 0)
        concerns |= CONCERNS_PARAMS;
    return concerns;
}

/* ---- the tables as a number ---- */

static uint64_t sum_on(uint64_t sum, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; ++i)
        sum = (sum ^ at[i]) * UINT64_C(0x100000001b3);
    return sum;
}

static uint64_t sum_words(uint64_t sum, const char *words)
{
    return words ? sum_on(sum, words, strlen(words) + 1) : sum_on(sum, "", 1);
}

static uint64_t sum_param(uint64_t sum, const mrt_param *p)
{
    sum = sum_on(sum, &p->id, sizeof p->id);
    sum = sum_on(sum, &p->flags, sizeof p->flags);
    sum = sum_words(sum_words(sum, p->name), p->group);
    sum = sum_words(sum_words(sum, p->unit), p->help);
    const double range[3] = {p->min, p->max, p->initial};
    sum = sum_on(sum, range, sizeof range);
    for (size_t i = 0; p->labels && p->labels[i]; ++i)
        sum = sum_words(sum, p->labels[i]);
    return sum;
}

uint64_t types_sum(const mrt_plugin_type *type)
{
    uint64_t sum = UINT64_C(0xcbf29ce484222325);
    sum = sum_on(sum, type, sizeof *type);
    sum = sum_words(sum_words(sum, type->id), type->name);
    sum = sum_words(sum_words(sum, type->version), type->about);
    for (uint32_t i = 0; i < type->param_count; ++i)
        sum = sum_param(sum, &type->params[i]);
    for (int i = 0; type->interfaces && type->interfaces[i].id; ++i) {
        sum = sum_words(sum, type->interfaces[i].id);
        sum = sum_on(sum, &type->interfaces[i], sizeof type->interfaces[i]);
    }
    return sum;
}
