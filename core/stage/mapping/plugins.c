#include "stage/mapping/plugins.h"

#include "stage/mapping/library_file.h"

#include <dirent.h>
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_LENGTH = 4096, PARAM_COUNT_MAX = 1024 };

const void *plugin_interface(const mrt_plugin_type *type, const char *interface_id)
{
    for (const mrt_interface *i = type->interfaces; i && i->id; ++i)
        if (strcmp(i->id, interface_id) == 0)
            return i->functions;
    return NULL;
}

static mrt_result check_param(const mrt_plugin_type *type, uint32_t index, error *err)
{
    const mrt_param *p = &type->params[index];
    if (!p->name || !p->name[0] || !p->group || !p->unit || !p->help)
        return error_set(err, MRT_ERR_FORMAT, "%s: parameter %u lacks a text", type->id, index);
    if (!isfinite(p->min) || !isfinite(p->max) || !isfinite(p->initial) || !(p->min < p->max) ||
        p->initial < p->min || p->initial > p->max)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: parameter \"%s\" needs finite min < max and min <= initial <= max",
                         type->id, p->name);
    for (uint32_t other = 0; other < index; ++other)
        if (type->params[other].id == p->id)
            return error_set(err, MRT_ERR_FORMAT, "%s: parameters \"%s\" and \"%s\" share id %u",
                             type->id, type->params[other].name, p->name, p->id);
    if (!p->labels)
        return MRT_OK;
    if (!(p->flags & MRT_PARAM_STEPPED))
        return error_set(err, MRT_ERR_FORMAT, "%s: parameter \"%s\" has labels but no steps",
                         type->id, p->name);
    double count = 0;
    while (count <= p->max - p->min && p->labels[(size_t)count])
        count += 1;
    if (count < p->max - p->min + 1)
        return error_set(err, MRT_ERR_FORMAT, "%s: parameter \"%s\" has %g labels for %g values",
                         type->id, p->name, count, p->max - p->min + 1);
    return MRT_OK;
}

static mrt_result check_interfaces(const mrt_plugin_type *type, error *err)
{
    const mrt_input *input = plugin_interface(type, MRT_INPUT);
    const mrt_mapping *mapping = plugin_interface(type, MRT_MAPPING);
    const mrt_state *state = plugin_interface(type, MRT_STATE);
    const mrt_devices *devices = plugin_interface(type, MRT_DEVICES);
    const mrt_output *output = plugin_interface(type, MRT_OUTPUT);
    if (!input && !mapping && !output)
        return error_set(err, MRT_ERR_FORMAT, "%s: answers none of %s, %s, %s", type->id, MRT_INPUT,
                         MRT_MAPPING, MRT_OUTPUT);
    if (input && (!input->open || !input->channels || !input->read || !input->close))
        return error_set(err, MRT_ERR_FORMAT, "%s: %s lacks a function", type->id, MRT_INPUT);
    if (mapping &&
        (!mapping->activate || !mapping->deactivate || !mapping->reset || !mapping->process))
        return error_set(err, MRT_ERR_FORMAT, "%s: %s lacks a function", type->id, MRT_MAPPING);
    if (state && (!state->save || !state->load))
        return error_set(err, MRT_ERR_FORMAT, "%s: %s lacks a function", type->id, MRT_STATE);
    if (devices && (!devices->list || !devices->current))
        return error_set(err, MRT_ERR_FORMAT, "%s: %s lacks a function", type->id, MRT_DEVICES);
    if (output && (!output->open || !output->write || !output->close))
        return error_set(err, MRT_ERR_FORMAT, "%s: %s lacks a function", type->id, MRT_OUTPUT);
    return MRT_OK;
}

mrt_result plugin_type_check(const mrt_plugin_type *type, error *err)
{
    if (type->abi != MRT_ABI)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "made for plugin ABI %u, this program speaks ABI %u: rebuild it",
                         type->abi, MRT_ABI);
    if (!type->id || !type->id[0] || !type->name || !type->version || !type->about)
        return error_set(err, MRT_ERR_FORMAT, "a type lacks its id, name, version or about");
    if (!type->create || !type->destroy)
        return error_set(err, MRT_ERR_FORMAT, "%s: lacks create or destroy", type->id);
    if (type->param_count > PARAM_COUNT_MAX || (type->param_count && !type->params))
        return error_set(err, MRT_ERR_FORMAT, "%s: has a bad parameter table", type->id);
    for (uint32_t i = 0; i < type->param_count; ++i) {
        mrt_result result = check_param(type, i, err);
        if (result < 0)
            return result;
    }
    return check_interfaces(type, err);
}

static void *grown(void *array, uint32_t count, size_t size)
{
    /* Room for one more, in steps of eight. */
    return count % 8 == 0 ? realloc(array, ((size_t)count + 8) * size) : array;
}

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the list of plugins");
}

static void refuse(plugin_list *list, const char *path, const char *reason)
{
    plugin_refusal *refusal = grown(list->refusal, list->refusal_count, sizeof *refusal);
    if (!refusal)
        return;
    list->refusal = refusal;
    refusal += list->refusal_count;
    refusal->path = strdup(path);
    refusal->reason = strdup(reason);
    if (refusal->path && refusal->reason) {
        list->refusal_count += 1;
    } else {
        free(refusal->path);
        free(refusal->reason);
    }
}

static mrt_result add_type(plugin_list *list, const mrt_plugin_type *type, const char *path,
                           error *err)
{
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        if (strcmp(list->entry[i].type->id, type->id) != 0)
            continue;
        char reason[512];
        snprintf(reason, sizeof reason, "%s is already loaded from %s", type->id,
                 list->entry[i].path);
        if (list->entry[i].type != type)
            refuse(list, path, reason);
        return MRT_OK;
    }
    plugin_entry *entry = grown(list->entry, list->entry_count, sizeof *entry);
    if (!entry)
        return no_memory(err);
    list->entry = entry;
    list->entry[list->entry_count++] = (plugin_entry){type, path};
    return MRT_OK;
}

/* The types of a library, or NULL and why. */
static const mrt_plugin_type *const *open_library(const char *path, error *err)
{
    if (library_file_check(path, err) < 0)
        return NULL;
    dlerror();
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *reason = dlerror();
        error_set(err, MRT_ERR_FORMAT, "%s", reason ? reason : "cannot be loaded");
        return NULL;
    }
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    if (!types)
        error_set(err, MRT_ERR_FORMAT, "has no symbol marotte_plugins: not a marotte plugin");
    else if (!types[0])
        error_set(err, MRT_ERR_FORMAT, "its marotte_plugins is empty");
    else
        return types;
    return NULL; /* the library stays: what has run is never unloaded */
}

mrt_result plugin_list_add(plugin_list *list, const char *path, error *err)
{
    error reason = {""};
    const mrt_plugin_type *const *types = open_library(path, &reason);
    if (!types) {
        refuse(list, path, reason.text);
        return error_set(err, MRT_ERR_FORMAT, "plugin %s: %s", path, reason.text);
    }
    char **library = grown(list->library_path, list->library_count, sizeof *library);
    char *kept_path = strdup(path);
    if (library)
        list->library_path = library;
    if (!library || !kept_path) {
        free(kept_path);
        return no_memory(err);
    }
    list->library_path[list->library_count++] = kept_path;
    mrt_result result = MRT_OK;
    for (; *types; ++types) {
        mrt_result one = plugin_type_check(*types, &reason);
        if (one < 0) {
            refuse(list, path, reason.text);
            result = error_set(err, one, "plugin %s: %s", path, reason.text);
            if ((*types)->abi != MRT_ABI)
                break; /* the table's other entries are of that ABI too */
        } else {
            one = add_type(list, *types, kept_path, err);
            if (one < 0)
                return one;
        }
    }
    return result;
}

static int is_library(const struct dirent *entry)
{
    size_t length = strlen(entry->d_name);
    return length > 3 && entry->d_name[0] != '.' && strcmp(entry->d_name + length - 3, ".so") == 0;
}

static int by_bytes(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static void add_folder(plugin_list *list, const char *folder)
{
    struct dirent **entries = NULL;
    int count = scandir(folder, &entries, is_library, by_bytes);
    for (int i = 0; i < count; ++i) {
        char path[PATH_LENGTH];
        int length = snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        error err;
        if (length > 0 && (size_t)length < sizeof path && plugin_list_add(list, path, &err) < 0)
            continue; /* kept as a refusal, which says why */
    }
    for (int i = 0; i < count; ++i)
        free(entries[i]);
    free(entries);
}

static void add_path_list(plugin_list *list, const char *folders)
{
    while (folders && *folders) {
        size_t length = strcspn(folders, ":");
        char folder[PATH_LENGTH];
        if (length > 0 && length < sizeof folder) {
            memcpy(folder, folders, length);
            folder[length] = '\0';
            add_folder(list, folder);
        }
        folders += length + (folders[length] == ':');
    }
}

static void add_user_folder(plugin_list *list)
{
    char folder[PATH_LENGTH];
    const char *data = getenv("XDG_DATA_HOME");
    const char *home = getenv("HOME");
    int length = -1;
    if (data && data[0] == '/')
        length = snprintf(folder, sizeof folder, "%s/marotte/plugins", data);
    else if (home && home[0] == '/')
        length = snprintf(folder, sizeof folder, "%s/.local/share/marotte/plugins", home);
    if (length > 0 && (size_t)length < sizeof folder)
        add_folder(list, folder);
}

/* `from_program`: as seen from the running program's folder, so that it all may be moved. To be
 * freed; NULL: there is no such folder. */
static char *program_folder(const char *from_program)
{
    char folder[PATH_LENGTH];
    size_t name_length = strlen(from_program);
    ssize_t length = readlink("/proc/self/exe", folder, sizeof folder - name_length - 1);
    if (length <= 0)
        return NULL;
    while (length > 0 && folder[length - 1] != '/')
        length -= 1;
    memcpy(folder + length, from_program, name_length + 1);
    return realpath(folder, NULL);
}

static void add_program_folder(plugin_list *list, const char *from_program)
{
    char *folder = program_folder(from_program);
    if (folder)
        add_folder(list, folder);
    free(folder);
}

static bool lies_in(const char *path, const char *from_program)
{
    char *folder = program_folder(from_program);
    size_t length = folder ? strlen(folder) : 0;
    bool lies = length > 0 && strncmp(path, folder, length) == 0 && path[length] == '/' &&
                !strchr(path + length + 1, '/');
    free(folder);
    return lies;
}

bool plugin_is_shipped(const char *library)
{
    char *real = realpath(library, NULL);
    bool is_shipped =
        real && (lies_in(real, MAROTTE_PLUGINS_FROM_PROGRAM) || lies_in(real, "plugins"));
    free(real);
    return is_shipped;
}

const char *plugin_list_path_of(const plugin_list *list, const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < list->entry_count; ++i)
        if (list->entry[i].type == type)
            return list->entry[i].path;
    return NULL;
}

mrt_result plugin_list_load(plugin_list *out, error *err)
{
    (void)err;
    *out = (plugin_list){0};
    add_path_list(out, getenv("MAROTTE_PLUGIN_PATH"));
    add_user_folder(out);
    add_program_folder(out, MAROTTE_PLUGINS_FROM_PROGRAM);
    add_program_folder(out, "plugins");
    return MRT_OK;
}

void plugin_list_destroy(plugin_list *list)
{
    if (!list)
        return;
    for (uint32_t i = 0; i < list->refusal_count; ++i) {
        free(list->refusal[i].path);
        free(list->refusal[i].reason);
    }
    for (uint32_t i = 0; i < list->library_count; ++i)
        free(list->library_path[i]);
    free(list->entry);
    free(list->refusal);
    free(list->library_path);
    *list = (plugin_list){0};
}

static bool is_named(const mrt_plugin_type *type, const char *name)
{
    const char *dot = strrchr(type->id, '.');
    return strcmp(type->id, name) == 0 || (dot && strcmp(dot + 1, name) == 0);
}

/* "log, pedal": the plugins with this interface. */
static void name_all(const plugin_list *list, const char *interface_id, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < list->entry_count && used < capacity; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        if (!plugin_interface(type, interface_id))
            continue;
        const char *dot = strrchr(type->id, '.');
        int length = snprintf(out + used, capacity - used, "%s%s", used ? ", " : "",
                              dot ? dot + 1 : type->id);
        used += length > 0 ? (size_t)length : 0;
    }
}

static mrt_result find_in_library(plugin_list *list, const char *path, const char *interface_id,
                                  const mrt_plugin_type **out_type, error *err)
{
    mrt_result result = plugin_list_add(list, path, err);
    if (result < 0)
        return result;
    const mrt_plugin_type *const *types = open_library(path, err);
    for (; types && *types; ++types) {
        if (!plugin_interface(*types, interface_id))
            continue;
        *out_type = *types;
        return MRT_OK;
    }
    return error_set(err, MRT_ERR_UNSUPPORTED, "plugin %s: has no %s", path, interface_id);
}

mrt_result plugin_list_find(plugin_list *list, const char *name, const char *interface_id,
                            const mrt_plugin_type **out_type, error *err)
{
    *out_type = NULL;
    if (strchr(name, '/'))
        return find_in_library(list, name, interface_id, out_type, err);
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        if (is_named(type, name) && plugin_interface(type, interface_id)) {
            *out_type = type;
            return MRT_OK;
        }
    }
    for (uint32_t i = 0; i < list->refusal_count; ++i) {
        const char *slash = strrchr(list->refusal[i].path, '/');
        const char *file = slash ? slash + 1 : list->refusal[i].path;
        size_t length = strlen(name);
        if (strncmp(file, name, length) == 0 && strcmp(file + length, ".so") == 0)
            return error_set(err, MRT_ERR_UNSUPPORTED, "plugin %s: %s", list->refusal[i].path,
                             list->refusal[i].reason);
    }
    char names[256];
    name_all(list, interface_id, names, sizeof names);
    const char *kind = strcmp(interface_id, MRT_INPUT) == 0    ? "input"
                       : strcmp(interface_id, MRT_OUTPUT) == 0 ? "output"
                                                               : "mapping";
    return error_set(err, MRT_ERR_UNSUPPORTED, "there is no %s plugin \"%s\" (there are: %s)", kind,
                     name, names[0] ? names : "none");
}
