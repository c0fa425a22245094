/* Rules that can be checked without running a plugin. */
#include "check/child/cases.h"
#include "base/hash.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/rules.h"
#include "check/wire.h"

#include <ctype.h>
#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* ---- loading ---- */

static const void *open_library(const char *path)
{
    struct stat status;
    char whole[PATH_MAX]; /* dlopen would search the system's folders for a name without a slash */
    if (!realpath(path, whole) || stat(whole, &status) != 0 || !S_ISREG(status.st_mode)) {
        tell_failed(RULE_LIBRARY_LOAD, "%s: not a file. Name the .so file that the build made",
                    path);
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
    call_stack_set_library(whole);
    const void *table = dlsym(library, "marotte_plugins");
    if (!table)
        tell_failed(RULE_LIBRARY_SYMBOL,
                    "it does not export marotte_plugins. Write MRT_EXPORT const mrt_plugin_type "
                    "*const marotte_plugins[] = {&type, NULL}; (in C++ within extern \"C\")");
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
            tell_failed(RULE_LIBRARY_ABI,
                        "it was built for abi %u, but this is %u: build it "
                        "again",
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

/* Returns the CONCERNS_* of rules.h for a type. */
static uint32_t types_concerns(const mrt_plugin_type *type)
{
    static const struct {
        const char *id;
        uint32_t concerns;
    } known[] = {{MRT_MAPPING, CONCERNS_MAPPING},         {MRT_INPUT, CONCERNS_INPUT},
                 {MRT_OUTPUT, CONCERNS_OUTPUT},           {MRT_STATE, CONCERNS_STATE},
                 {MRT_RESUME, CONCERNS_RESUME},           {MRT_DEVICES, CONCERNS_DEVICES},
                 {MRT_FACE_OUTPUT, CONCERNS_FACE_OUTPUT}, {MRT_TAUGHT_POSES, CONCERNS_TAUGHT_POSES},
                 {MRT_RIG_POSES, CONCERNS_RIG_POSES}};
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

/* ---- checksum of the tables ---- */

static uint64_t sum_words(uint64_t sum, const char *words)
{
    return words ? hash_bytes(sum, words, strlen(words) + 1) : hash_bytes(sum, "", 1);
}

static uint64_t sum_param(uint64_t sum, const mrt_param *p)
{
    sum = hash_bytes(sum, &p->id, sizeof p->id);
    sum = hash_bytes(sum, &p->flags, sizeof p->flags);
    sum = sum_words(sum_words(sum, p->name), p->group);
    sum = sum_words(sum_words(sum, p->unit), p->help);
    const double range[3] = {p->min, p->max, p->initial};
    sum = hash_bytes(sum, range, sizeof range);
    for (size_t i = 0; p->labels && p->labels[i]; ++i)
        sum = sum_words(sum, p->labels[i]);
    return sum;
}

uint64_t types_sum(const mrt_plugin_type *type)
{
    uint64_t sum = HASH_START;
    sum = hash_bytes(sum, type, sizeof *type);
    sum = sum_words(sum_words(sum, type->id), type->name);
    sum = sum_words(sum_words(sum, type->version), type->about);
    for (uint32_t i = 0; i < type->param_count; ++i)
        sum = sum_param(sum, &type->params[i]);
    for (int i = 0; type->interfaces && type->interfaces[i].id; ++i) {
        sum = sum_words(sum, type->interfaces[i].id);
        sum = hash_bytes(sum, &type->interfaces[i], sizeof type->interfaces[i]);
    }
    return sum;
}

/* ---- tables ---- */

static bool is_empty(const char *words)
{
    return !words || words[0] == '\0';
}

/* ---- the type ---- */

static void judge_words(const mrt_plugin_type *type)
{
    const char *missing = is_empty(type->id)        ? "id"
                          : is_empty(type->name)    ? "name"
                          : is_empty(type->version) ? "version"
                          : is_empty(type->about)   ? "about"
                                                    : NULL;
    if (missing)
        tell_failed(RULE_TYPE_WORDS, "its %s is empty", missing);
}

/* Accepts names with dots between them: "org.marotte.one_hand". */
static bool is_well_formed(const char *id)
{
    int dots = 0;
    for (const char *c = id; *c; ++c) {
        bool is_edge = c == id || c[1] == '\0' || c[1] == '.';
        if (*c == '.' && is_edge)
            return false;
        dots += *c == '.';
        if (*c != '.' && *c != '_' && *c != '-' && !islower((unsigned char)*c) &&
            !isdigit((unsigned char)*c))
            return false;
    }
    return dots >= 1 && strlen(id) < 96;
}

static void judge_id(const mrt_plugin_type *type)
{
    if (!is_empty(type->id) && !is_well_formed(type->id))
        tell_failed(RULE_TYPE_ID,
                    "\"%.100s\": small letters, digits, '_' and '-', with a '.' between names, as "
                    "in \"org.example.wave\"",
                    type->id);
}

/* ---- interfaces ---- */

typedef void any_function(void);

/* Returns whether one of the functions at the head of the struct is missing. */
static bool lacks(const void *functions, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        any_function *f;
        memcpy(&f, (const char *)functions + i * sizeof f, sizeof f);
        if (!f)
            return true;
    }
    return false;
}

static bool is_versioned(const char *id)
{
    const char *slash = strrchr(id, '/');
    const char *dot = strchr(id, '.');
    if (!slash || !dot || dot > slash || dot == id || !slash[1])
        return false;
    return strspn(slash + 1, "0123456789") == strlen(slash + 1);
}

static bool is_known(const char *id, size_t *out_functions)
{
    static const struct {
        const char *id;
        size_t functions;
    } known[] = {{MRT_INPUT, 4},    {MRT_DEVICES, 2},   {MRT_OUTPUT, 3},      {MRT_MAPPING, 4},
                 {MRT_STATE, 2},    {MRT_RESUME, 2},    {MRT_FACE_OUTPUT, 4}, {MRT_TAUGHT_POSES, 1},
                 {MRT_DURATION, 1}, {MRT_RIG_POSES, 1}, {MRT_HAND_CARD, 1}};
    for (size_t i = 0; i < sizeof known / sizeof *known; ++i) {
        *out_functions = known[i].functions;
        if (strcmp(known[i].id, id) == 0)
            return true;
    }
    return false;
}

static void judge_interface(const mrt_interface *all, int i)
{
    size_t functions;
    const mrt_interface *interface = &all[i];
    if (!is_versioned(interface->id))
        tell_failed(RULE_TYPE_INTERFACES, "\"%.80s\" is not \"domain.name/revision\"",
                    interface->id);
    for (int k = 0; k < i; ++k)
        if (strcmp(all[k].id, interface->id) == 0)
            tell_failed(RULE_TYPE_INTERFACES, "\"%.80s\" is listed twice", interface->id);
    if (!interface->functions)
        tell_failed(RULE_TYPE_FUNCTIONS, "%.80s has no functions", interface->id);
    else if (is_known(interface->id, &functions) && lacks(interface->functions, functions))
        tell_failed(RULE_TYPE_FUNCTIONS, "one of the %zu functions of %.80s is NULL", functions,
                    interface->id);
}

static void judge_interfaces(const mrt_plugin_type *type)
{
    int count = 0;
    while (type->interfaces && count < TYPES_INTERFACES_MAX && type->interfaces[count].id)
        judge_interface(type->interfaces, count++);
    if (count == TYPES_INTERFACES_MAX)
        tell_failed(RULE_TYPE_INTERFACES,
                    "none of the first %d ids is NULL: the table has no "
                    "end",
                    TYPES_INTERFACES_MAX);
    if (!types_interface(type, MRT_INPUT) && !types_interface(type, MRT_MAPPING) &&
        !types_interface(type, MRT_OUTPUT) && !types_interface(type, MRT_FACE_OUTPUT))
        tell_failed(RULE_TYPE_INTERFACES, "it has none of %s, %s, %s, %s", MRT_INPUT, MRT_MAPPING,
                    MRT_OUTPUT, MRT_FACE_OUTPUT);
}

/* ---- parameters ---- */

static const char *name_of(const mrt_param *p)
{
    return is_empty(p->name) ? "(without a name)" : p->name;
}

static void judge_param_words(const mrt_param *p)
{
    const char *missing = is_empty(p->name)   ? "name"
                          : !p->group         ? "group (\"\" is fine)"
                          : !p->unit          ? "unit (\"\" is fine)"
                          : is_empty(p->help) ? "help"
                                              : NULL;
    if (missing)
        tell_failed(RULE_PARAM_WORDS, "parameter %u \"%.60s\" has no %s", p->id, name_of(p),
                    missing);
}

static void judge_range(const mrt_param *p)
{
    bool is_good = isfinite(p->min) && isfinite(p->max) && isfinite(p->initial) &&
                   p->min < p->max && p->min <= p->initial && p->initial <= p->max;
    if (!is_good)
        tell_failed(RULE_PARAM_RANGE, "\"%.60s\" has the range %g to %g and the initial value %g",
                    name_of(p), p->min, p->max, p->initial);
}

static bool is_whole(double value)
{
    return floor(value) >= value;
}

static void judge_flags(const mrt_param *p)
{
    const uint32_t known =
        MRT_PARAM_STEPPED | MRT_PARAM_TRIGGER | MRT_PARAM_HIDDEN | MRT_PARAM_POSE;
    if (p->flags & ~known)
        tell_failed(RULE_PARAM_FLAGS, "\"%.60s\" has the flags 0x%x, of which 0x%x are unknown",
                    name_of(p), p->flags, p->flags & ~known);
    if ((p->flags & MRT_PARAM_STEPPED) &&
        (!is_whole(p->min) || !is_whole(p->max) || !is_whole(p->initial)))
        tell_failed(RULE_PARAM_FLAGS, "\"%.60s\" is stepped, and %g, %g, %g are not all whole",
                    name_of(p), p->min, p->max, p->initial);
    if ((p->flags & MRT_PARAM_POSE) &&
        (!(p->flags & MRT_PARAM_STEPPED) || p->min < 0 || p->min > 0 || p->initial > 0 ||
         p->max < MRT_POSE_VALUES || p->max > MRT_POSE_VALUES))
        tell_failed(RULE_PARAM_FLAGS,
                    "\"%.60s\" chooses a pose: stepped, min 0, max %.0f, initial 0, not %g, %g, %g",
                    name_of(p), MRT_POSE_VALUES, p->min, p->max, p->initial);
    if ((p->flags & MRT_PARAM_TRIGGER) &&
        (p->min < 0 || p->min > 0 || p->initial > 0 || p->max < 1 || p->max > 1))
        tell_failed(RULE_PARAM_FLAGS,
                    "\"%.60s\" is a trigger: min 0, max 1, initial 0, not %g, %g, %g", name_of(p),
                    p->min, p->max, p->initial);
}

static void judge_labels(const mrt_param *p)
{
    if (!p->labels)
        return;
    if (!(p->flags & MRT_PARAM_STEPPED)) {
        tell_failed(RULE_PARAM_LABELS, "\"%.60s\" has labels, but is not MRT_PARAM_STEPPED",
                    name_of(p));
        return;
    }
    double wanted = p->max - p->min + 1;
    double count = 0;
    while (count <= wanted && p->labels[(size_t)count])
        count += 1;
    if (count < wanted || count > wanted) {
        tell_failed(RULE_PARAM_LABELS, "\"%.60s\" has %s labels before NULL for its %g values",
                    name_of(p), count < wanted ? "too few" : "too many", wanted);
        return;
    }
    for (size_t i = 0; (double)i < wanted; ++i)
        for (size_t k = 0; k <= i; ++k)
            if (is_empty(p->labels[i]) || (k < i && strcmp(p->labels[k], p->labels[i]) == 0)) {
                tell_failed(RULE_PARAM_LABELS, "label %zu of \"%.60s\" is empty or duplicate", i,
                            name_of(p));
                return;
            }
}

static bool is_same_key(const char *a, const char *b)
{
    for (; *a && *b; ++a, ++b) {
        int x = isspace((unsigned char)*a) ? '_' : tolower((unsigned char)*a);
        int y = isspace((unsigned char)*b) ? '_' : tolower((unsigned char)*b);
        if (x != y)
            return false;
    }
    return *a == *b;
}

static void judge_keys(const mrt_plugin_type *type, uint32_t index)
{
    const mrt_param *p = &type->params[index];
    if (is_empty(p->name) || !p->group)
        return;
    if (strpbrk(p->name, ",=") || strpbrk(p->group, ",="))
        tell_failed(RULE_PARAM_KEYS,
                    "\"%.60s\" in \"%.60s\" contains ',' or '=', which \"group.name=value,...\" "
                    "cannot express",
                    p->name, p->group);
    for (uint32_t k = 0; k < index; ++k) {
        const mrt_param *other = &type->params[k];
        if (other->id == p->id)
            tell_failed(RULE_PARAM_IDS, "\"%.60s\" and \"%.60s\" share the id %u", name_of(other),
                        name_of(p), p->id);
        if (!is_empty(other->name) && other->group && is_same_key(other->name, p->name) &&
            is_same_key(other->group, p->group))
            tell_failed(RULE_PARAM_KEYS,
                        "\"%.60s\" exists twice in \"%.60s\": keys must differ by more than "
                        "case and blanks",
                        p->name, p->group);
    }
}

static void judge_params(const mrt_plugin_type *type)
{
    static const check_rule rules[] = {RULE_PARAM_WORDS, RULE_PARAM_RANGE, RULE_PARAM_IDS,
                                       RULE_PARAM_KEYS,  RULE_PARAM_FLAGS, RULE_PARAM_LABELS};
    for (uint32_t i = 0; i < type->param_count; ++i) {
        const mrt_param *p = &type->params[i];
        tell_doing(RULE_PARAM_WORDS, "reading parameter %u of %u", i + 1, type->param_count);
        judge_param_words(p);
        judge_range(p);
        judge_flags(p);
        if (!tell_has_failed(RULE_PARAM_RANGE) && !tell_has_failed(RULE_PARAM_FLAGS)) {
            tell_doing(RULE_PARAM_LABELS, "reading the labels of \"%.60s\"", name_of(p));
            judge_labels(p);
        }
        judge_keys(type, i);
    }
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%s", "");
}

/* ---- the library ---- */

static void judge_ids(const types *all)
{
    for (uint32_t i = 0; i < all->count; ++i)
        for (uint32_t k = 0; k < i; ++k)
            if (all->type[i]->id && all->type[k]->id &&
                strcmp(all->type[i]->id, all->type[k]->id) == 0)
                tell_failed(RULE_LIBRARY_IDS, "two types have the id \"%.80s\"", all->type[i]->id);
}

void cases_type(const examination *e)
{
    const mrt_plugin_type *type = e->type;
    static const check_rule rules[] = {RULE_TYPE_WORDS, RULE_TYPE_ID, RULE_TYPE_FUNCTIONS,
                                       RULE_TYPE_INTERFACES};
    tell_doing(RULE_TYPE_WORDS, "reading the type's words");
    judge_words(type);
    judge_id(type);
    if (!type->create || !type->destroy)
        tell_failed(RULE_TYPE_FUNCTIONS, "%s is NULL", type->create ? "destroy" : "create");
    tell_doing(RULE_TYPE_INTERFACES, "reading the type's interfaces");
    judge_interfaces(type);
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%s", "");
    if (type->param_count > TYPES_PARAMS_MAX || (type->param_count > 0 && !type->params))
        tell_failed(RULE_PARAM_WORDS, "the table has %u parameters, but %d is the maximum",
                    type->param_count, type->params ? TYPES_PARAMS_MAX : 0);
    else if (type->param_count > 0)
        judge_params(type);
}

void cases_tables(const types *all)
{
    tell_ok(RULE_LIBRARY_SYMBOL, "%s", "");
    tell_ok(RULE_LIBRARY_ABI, "%s", "");
    judge_ids(all);
    tell_ok(RULE_LIBRARY_IDS, "%s", "");
    for (uint32_t i = 0; i < all->count; ++i) {
        const mrt_plugin_type *type = all->type[i];
        tell_fact(WIRE_TYPE, "%u %u %s", i, types_concerns(type),
                  is_empty(type->id) ? "(without an id)" : type->id);
    }
}
