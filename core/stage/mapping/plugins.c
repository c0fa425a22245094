#include "stage/mapping/plugins.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/suggest.h"
#include "base/text.h"
#include "base/trace.h"

#include <dirent.h>
#include <dlfcn.h>
#include <limits.h>
#include <link.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PARAM_COUNT_MAX = 1024 };

const void *plugin_interface(const mrt_plugin_type *type, const char *interface_id)
{
    for (const mrt_interface *i = type->interfaces; i && i->id; ++i)
        if (strcmp(i->id, interface_id) == 0)
            return i->functions;
    return NULL;
}

const char *plugin_short_name(const mrt_plugin_type *type)
{
    const char *dot = strrchr(type->id, '.');
    return dot ? dot + 1 : type->id;
}

/* Printable texts only: they appear in the window, in errors, in shows and in names of folders. */
static bool is_shown_well(const char *text)
{
    return !text || text_is_printable(text_view_of(text, strlen(text)));
}

static bool is_id(const char *text)
{
    return text[0] && strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                   "0123456789._-") == strlen(text);
}

static mrt_result check_param(const mrt_plugin_type *type, uint32_t index, error *err)
{
    const mrt_param *p = &type->params[index];
    if (!p->name || !p->name[0] || !p->group || !p->unit || !p->help)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: parameter %u lacks a name, group, unit or help text", type->id,
                         index);
    if (!is_shown_well(p->name) || !is_shown_well(p->group) || !is_shown_well(p->unit) ||
        !is_shown_well(p->help))
        return error_set(err, MRT_ERR_FORMAT, "%s: a text of parameter %u cannot be printed",
                         type->id, index);
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
    while (count <= p->max - p->min && p->labels[(size_t)count]) {
        if (!is_shown_well(p->labels[(size_t)count]))
            return error_set(err, MRT_ERR_FORMAT, "%s: a label of \"%s\" cannot be printed",
                             type->id, p->name);
        count += 1;
    }
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
    const mrt_taught_poses *poses = plugin_interface(type, MRT_TAUGHT_POSES);
    const mrt_rig_poses *rig_poses = plugin_interface(type, MRT_RIG_POSES);
    const mrt_hand_card *card = plugin_interface(type, MRT_HAND_CARD);
    const mrt_devices *devices = plugin_interface(type, MRT_DEVICES);
    const mrt_output *output = plugin_interface(type, MRT_OUTPUT);
    const mrt_face_output *face = plugin_interface(type, MRT_FACE_OUTPUT);
    if (!input && !mapping && !output && !face)
        return error_set(err, MRT_ERR_FORMAT, "%s: has none of the interfaces %s, %s, %s, %s",
                         type->id, MRT_INPUT, MRT_MAPPING, MRT_OUTPUT, MRT_FACE_OUTPUT);
    const char *lacking = NULL;
    if (input && (!input->open || !input->channels || !input->read || !input->close))
        lacking = MRT_INPUT;
    else if (mapping &&
             (!mapping->activate || !mapping->deactivate || !mapping->reset || !mapping->process))
        lacking = MRT_MAPPING;
    else if (state && (!state->save || !state->load))
        lacking = MRT_STATE;
    else if (poses && !poses->pose)
        lacking = MRT_TAUGHT_POSES;
    else if (rig_poses && !rig_poses->set)
        lacking = MRT_RIG_POSES;
    else if (card && !card->lines)
        lacking = MRT_HAND_CARD;
    else if (devices && (!devices->list || !devices->current))
        lacking = MRT_DEVICES;
    else if (output && (!output->open || !output->write || !output->close))
        lacking = MRT_OUTPUT;
    else if (face && (!face->open || !face->begin || !face->send || !face->close))
        lacking = MRT_FACE_OUTPUT;
    if (lacking)
        return error_set(err, MRT_ERR_FORMAT, "%s: %s lacks a function", type->id, lacking);
    return MRT_OK;
}

mrt_result plugin_type_check(const mrt_plugin_type *type, error *err)
{
    if (type->abi != MRT_ABI)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "made for plugin ABI %u, but this program uses ABI %u: rebuild it",
                         type->abi, MRT_ABI);
    if (!type->id || !type->id[0] || !type->name || !type->version || !type->about)
        return error_set(err, MRT_ERR_FORMAT, "a type lacks its id, name, version or about");
    if (!is_id(type->id))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: an id may contain only letters, digits, '.', '_' and '-'", type->id);
    if (!is_shown_well(type->name) || !is_shown_well(type->version) || !is_shown_well(type->about))
        return error_set(err, MRT_ERR_FORMAT, "%s: name, version or about cannot be printed",
                         type->id);
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

/* ---- a library ---- */

typedef ElfW(Ehdr) elf_header;
typedef ElfW(Phdr) elf_segment;

static bool is_native_elf(const elf_header *header)
{
    unsigned char native = sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32;
    return memcmp(header->e_ident, ELFMAG, SELFMAG) == 0 && header->e_ident[EI_CLASS] == native &&
           header->e_phentsize == sizeof(elf_segment);
}

static bool lies_within(uint64_t offset, uint64_t length, uint64_t size)
{
    return length <= size && offset <= size - length;
}

static mrt_result cut_short(uint64_t size, error *err)
{
    return error_set(err, MRT_ERR_FORMAT, "is truncated at %ju bytes: copy or build it again",
                     (uintmax_t)size);
}

static mrt_result check_segments(FILE *file, uint64_t size, error *err)
{
    elf_header header;
    if (fread(&header, sizeof header, 1, file) != 1 || !is_native_elf(&header))
        return MRT_OK;
    uint64_t table_size = (uint64_t)header.e_phnum * sizeof(elf_segment);
    if (!lies_within(header.e_phoff, table_size, size) ||
        fseek(file, (long)header.e_phoff, SEEK_SET) != 0)
        return cut_short(size, err);
    for (unsigned i = 0; i < header.e_phnum; ++i) {
        elf_segment segment;
        if (fread(&segment, sizeof segment, 1, file) != 1)
            return cut_short(size, err);
        if (segment.p_type == PT_LOAD && !lies_within(segment.p_offset, segment.p_filesz, size))
            return cut_short(size, err);
    }
    return MRT_OK;
}

mrt_result plugin_library_check(const char *path, error *err)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return MRT_OK;
    if (!S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_FORMAT, "is not a regular file");
    FILE *file = fopen(path, "rb");
    if (!file)
        return MRT_OK;
    mrt_result result = check_segments(file, (uint64_t)status.st_size, err);
    (void)fclose(file);
    return result;
}

/* Adds "./", because dlopen searches the system folders for a name without a slash. */
static bool as_path(char out[PATH_MAX], const char *path)
{
    int length = snprintf(out, PATH_MAX, "%s%s", strchr(path, '/') ? "" : "./", path);
    return length > 0 && length < PATH_MAX;
}

const mrt_plugin_type *const *plugin_library_open(const char *path, error *err)
{
    char name[PATH_MAX];
    if (!as_path(name, path)) {
        (void)error_set(err, MRT_ERR_ARGUMENT, "the path is too long");
        return NULL;
    }
    if (plugin_library_check(name, err) < 0)
        return NULL;
    dlerror();
    void *library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        const char *reason = dlerror();
        (void)error_set(err, MRT_ERR_FORMAT, "%s", reason ? reason : "cannot be loaded");
        return NULL;
    }
    const mrt_plugin_type *const *types = dlsym(library, "marotte_plugins");
    if (types && types[0])
        return types;
    (void)error_set(err, MRT_ERR_FORMAT,
                    types ? "its marotte_plugins is empty"
                          : "has no symbol marotte_plugins: not a marotte plugin");
    return NULL;
}

plugin_library_stamp plugin_library_stamp_of(const char *path)
{
    struct stat status;
    if (!path || stat(path, &status) != 0)
        return (plugin_library_stamp){0};
    return (plugin_library_stamp){.time_ns = (int64_t)status.st_mtim.tv_sec * NS_PER_S +
                                             status.st_mtim.tv_nsec,
                                  .size = (int64_t)status.st_size,
                                  .file = (uint64_t)status.st_ino};
}

bool plugin_library_is_same(const plugin_library_stamp *a, const plugin_library_stamp *b)
{
    return a->time_ns == b->time_ns && a->size == b->size && a->file == b->file;
}

/* ---- the list ---- */

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the list of plugins");
}

/* Allocates all memory once, so that entries never move while other threads read them. */
static mrt_result make_room(plugin_list *list, error *err)
{
    if (list->entry)
        return MRT_OK;
    list->entry = calloc(PLUGIN_LIST_MAX, sizeof *list->entry);
    list->hidden = calloc(PLUGIN_LIST_MAX, sizeof *list->hidden);
    list->refusal = calloc(PLUGIN_LIST_MAX, sizeof *list->refusal);
    if (list->entry && list->hidden && list->refusal)
        return MRT_OK;
    plugin_list_destroy(list);
    return no_memory(err);
}

static void refuse(plugin_list *list, const char *path, const char *reason)
{
    uint32_t count = list->refusal_count;
    if (count == PLUGIN_LIST_MAX)
        return;
    plugin_refusal made = {.path = strdup(path), .reason = strdup(reason)};
    if (!made.path || !made.reason) {
        free(made.path);
        free(made.reason);
        return;
    }
    list->refusal[count] = made;
    list->refusal_count = count + 1;
}

static const plugin_entry *entry_of(const plugin_list *list, const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < list->entry_count; ++i)
        if (list->entry[i].type == type)
            return &list->entry[i];
    for (uint32_t i = 0; i < list->hidden_count; ++i)
        if (list->hidden[i].type == type)
            return &list->hidden[i];
    return NULL;
}

static const plugin_entry *entry_with_id(const plugin_list *list, const char *id)
{
    for (uint32_t i = 0; i < list->entry_count; ++i)
        if (strcmp(list->entry[i].type->id, id) == 0)
            return &list->entry[i];
    return NULL;
}

static mrt_result add_type(plugin_list *list, const mrt_plugin_type *type, const char *path,
                           error *err)
{
    char reason[512];
    if (entry_of(list, type))
        return MRT_OK;
    const plugin_entry *first = entry_with_id(list, type->id);
    uint32_t count = first ? list->hidden_count : list->entry_count;
    char *kept_path = count < PLUGIN_LIST_MAX ? strdup(path) : NULL;
    if (count == PLUGIN_LIST_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "plugin %s: the limit of loaded plugins is reached", path);
    if (!kept_path)
        return no_memory(err);
    if (first) {
        (void)snprintf(reason, sizeof reason, "%s is already loaded from %s", type->id,
                       first->path);
        refuse(list, path, reason);
        list->hidden[count] = (plugin_entry){type, kept_path};
        list->hidden_count = count + 1;
    } else {
        list->entry[count] = (plugin_entry){type, kept_path};
        list->entry_count = count + 1;
    }
    return MRT_OK;
}

/* out_types: the types in the library. */
static mrt_result add(plugin_list *list, const char *path, const mrt_plugin_type *const **out_types,
                      error *err)
{
    error reason = {""};
    mrt_result result = make_room(list, err);
    if (result < 0)
        return result;
    const mrt_plugin_type *const *types = plugin_library_open(path, &reason);
    *out_types = types;
    TRACE(TRACE_MAPPING, "%s: %s", path, types ? "loaded" : reason.text);
    if (!types) {
        refuse(list, path, reason.text);
        return error_set(err, MRT_ERR_FORMAT, "plugin %s: %s", path, reason.text);
    }
    for (; *types; ++types) {
        mrt_result one = plugin_type_check(*types, &reason);
        if (one >= 0) {
            one = add_type(list, *types, path, err);
            if (one < 0)
                return one;
            continue;
        }
        refuse(list, path, reason.text);
        result = error_set(err, one, "plugin %s: %s", path, reason.text);
        if ((*types)->abi != MRT_ABI)
            break; /* the other types have the same ABI */
    }
    return result;
}

mrt_result plugin_list_add(plugin_list *list, const char *path, error *err)
{
    const mrt_plugin_type *const *types;
    return add(list, path, &types, err);
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
        char path[PATH_MAX];
        int length = snprintf(path, sizeof path, "%s/%s", folder, entries[i]->d_name);
        error err;
        if (length > 0 && (size_t)length < sizeof path && plugin_list_add(list, path, &err) < 0)
            continue; /* stored as a refusal with its reason */
    }
    for (int i = 0; i < count; ++i)
        free(entries[i]);
    free(entries);
}

static void add_path_list(plugin_list *list, const char *folders)
{
    while (folders && *folders) {
        size_t length = strcspn(folders, ":");
        char folder[PATH_MAX];
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
    char folder[PATH_MAX];
    if (file_home_path(folder, sizeof folder, FILE_HOME_DATA, "plugins", NULL) >= 0)
        add_folder(list, folder);
}

/* Returns a folder relative to the folder of the running program, so that an installation can be
 * moved. The caller frees it. NULL: it does not exist. */
static char *program_folder(const char *from_program)
{
    char folder[PATH_MAX];
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
    const plugin_entry *entry = entry_of(list, type);
    return entry ? entry->path : NULL;
}

mrt_result plugin_list_load(plugin_list *list, error *err)
{
    mrt_result result = make_room(list, err);
    if (result < 0)
        return result;
    add_path_list(list, getenv("MAROTTE_PLUGIN_PATH"));
    add_user_folder(list);
    add_program_folder(list, MAROTTE_PLUGINS_FROM_PROGRAM);
    add_program_folder(list, "plugins");
    return MRT_OK;
}

static void free_paths(plugin_entry *entry, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        free(entry[i].path);
}

void plugin_list_destroy(plugin_list *list)
{
    if (!list)
        return;
    for (uint32_t i = 0; i < list->refusal_count; ++i) {
        free(list->refusal[i].path);
        free(list->refusal[i].reason);
    }
    free_paths(list->entry, list->entry_count);
    free_paths(list->hidden, list->hidden_count);
    free(list->entry);
    free(list->hidden);
    free(list->refusal);
    *list = (plugin_list){0};
}

bool plugin_is_offered(const mrt_plugin_type *type)
{
    static const char *const replaced[] = {"org.marotte.poses"}; /* replaced by one_hand */
    for (size_t i = 0; i < sizeof replaced / sizeof *replaced; ++i)
        if (strcmp(type->id, replaced[i]) == 0)
            return false;
    return true;
}

static bool is_named(const mrt_plugin_type *type, const char *name)
{
    return strcmp(type->id, name) == 0 || strcmp(plugin_short_name(type), name) == 0;
}

/* Lists the plugins with this interface, such as "log, pedal". */
static void name_all(const plugin_list *list, const char *interface_id, char *out, size_t capacity)
{
    size_t used = 0;
    out[0] = '\0';
    for (uint32_t i = 0; i < list->entry_count && used < capacity; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        if (!plugin_interface(type, interface_id) || !plugin_is_offered(type))
            continue;
        int length = snprintf(out + used, capacity - used, "%s%s", used ? ", " : "",
                              plugin_short_name(type));
        used += length > 0 ? (size_t)length : 0;
    }
}

static const char *kind_of(const char *interface_id)
{
    return strcmp(interface_id, MRT_INPUT) == 0         ? "input"
           : strcmp(interface_id, MRT_OUTPUT) == 0      ? "output"
           : strcmp(interface_id, MRT_FACE_OUTPUT) == 0 ? "face output"
                                                        : "mapping";
}

static mrt_result no_such_plugin(const plugin_list *list, const char *name,
                                 const char *interface_id, error *err)
{
    char names[256];
    suggest near;
    suggest_begin(&near, name);
    for (uint32_t i = 0; i < list->entry_count; ++i) {
        const mrt_plugin_type *type = list->entry[i].type;
        if (plugin_interface(type, interface_id) && plugin_is_offered(type))
            suggest_consider(&near, plugin_short_name(type));
        else if (is_named(type, name))
            return error_set(
                err, MRT_ERR_UNSUPPORTED,
                "there is no %s plugin \"%s\": the plugin of this name is of another kind "
                "(marotte plugin list)",
                kind_of(interface_id), name);
    }
    if (near.best[0])
        return error_set(err, MRT_ERR_UNSUPPORTED, "there is no %s plugin \"%s\"%s",
                         kind_of(interface_id), name, suggest_question(&near).text);
    name_all(list, interface_id, names, sizeof names);
    return error_set(err, MRT_ERR_UNSUPPORTED,
                     "there is no %s plugin \"%s\". Loaded: %s. Set MAROTTE_PLUGIN_PATH to the "
                     "folders of other plugins",
                     kind_of(interface_id), name, names[0] ? names : "none");
}

mrt_result plugin_list_find(const plugin_list *list, const char *name, const char *interface_id,
                            const mrt_plugin_type **out_type, error *err)
{
    *out_type = NULL;
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
    return no_such_plugin(list, name, interface_id, err);
}

/* ---- text that the user wrote ---- */

/* True for "./wave.so", and for "wave.so" in the current folder. */
static bool is_path(const char *words)
{
    size_t length = strlen(words);
    return strchr(words, '/') || (length > 3 && strcmp(words + length - 3, ".so") == 0);
}

/* Splits "./two.so/tide" into the library "./two.so" and out_name "tide". out_name "": the text
 * does not name a type. */
static bool split_path(const char *words, char out_path[PATH_MAX], const char **out_name)
{
    const char *end = words + strlen(words), *slash = strrchr(words, '/');
    bool is_within = slash && slash - words > 3 && strncmp(slash - 3, ".so", 3) == 0;
    size_t length = (size_t)((is_within ? slash : end) - words);
    *out_name = is_within ? slash + 1 : "";
    if (length >= PATH_MAX)
        return false;
    memcpy(out_path, words, length);
    out_path[length] = '\0';
    return true;
}

/* Selects the named type of a library, or its only type with the interface. */
static mrt_result pick(const mrt_plugin_type *const *types, const char *path, const char *name,
                       const char *interface_id, const mrt_plugin_type **out_type, error *err)
{
    char names[256] = "";
    size_t used = 0;
    uint32_t count = 0;
    for (; *types; ++types) {
        if (!plugin_interface(*types, interface_id))
            continue;
        int length = used < sizeof names
                         ? snprintf(names + used, sizeof names - used, "%s%s/%s", used ? ", " : "",
                                    path, plugin_short_name(*types))
                         : 0;
        used += length > 0 ? (size_t)length : 0;
        if (name[0] && !is_named(*types, name))
            continue;
        *out_type = *types;
        count += 1;
    }
    if (count == 1)
        return MRT_OK;
    *out_type = NULL;
    if (!names[0])
        return error_set(err, MRT_ERR_UNSUPPORTED, "plugin %s: has no %s", path,
                         kind_of(interface_id));
    return error_set(err, MRT_ERR_UNSUPPORTED, "plugin %s: %s: %s", path,
                     name[0] ? "unknown type, choose one of" : "choose one of its types", names);
}

mrt_result plugin_list_choose(plugin_list *list, const char *words, const char *interface_id,
                              const mrt_plugin_type **out_type, error *err)
{
    char path[PATH_MAX];
    const char *name;
    const mrt_plugin_type *const *types;
    if (!is_path(words))
        return plugin_list_find(list, words, interface_id, out_type, err);
    *out_type = NULL;
    if (!split_path(words, path, &name))
        return error_set(err, MRT_ERR_ARGUMENT, "the path \"%.200s...\" is too long", words);
    mrt_result result = add(list, path, &types, err);
    return result < 0 ? result : pick(types, path, name, interface_id, out_type, err);
}

mrt_result plugin_list_choose_spec(plugin_list *list, const char *spec, const char *interface_id,
                                   char **out_spec, error *err)
{
    const mrt_plugin_type *type;
    const size_t length = strcspn(spec, ":,");
    *out_spec = NULL;
    char *words = text_duplicate(spec, length);
    if (!words)
        return no_memory(err);
    const bool is_library = is_path(words);
    mrt_result result = MRT_OK;
    if (is_library)
        result = plugin_list_choose(list, words, interface_id, &type, err);
    if (result >= 0 && is_library && entry_with_id(list, type->id)->type != type)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "plugin %s: %s is already loaded from %s: remove that library, or add "
                           "the folder of yours to MAROTTE_PLUGIN_PATH",
                           words, type->id, entry_with_id(list, type->id)->path);
    if (result >= 0) {
        const char *id = is_library ? type->id : words;
        size_t size = strlen(id) + strlen(spec + length) + 1;
        *out_spec = malloc(size);
        if (*out_spec)
            (void)snprintf(*out_spec, size, "%s%s", id, spec + length);
        else
            result = no_memory(err);
    }
    free(words);
    return result;
}

/* The plugin may be the path of a library ("./x.so:..."). */
bool plugin_spec_read(plugin_spec *out, const char *text)
{
    size_t plugin_length = strcspn(text, ":,");
    const char *rest = text + plugin_length;
    const char *address = *rest == ':' ? rest + 1 : "";
    size_t address_length = strcspn(address, ",");
    const char *params = *rest == ':' ? address + address_length : rest;
    if (*params == ',')
        params += 1;
    out->plugin = text_duplicate(text, plugin_length);
    out->address = text_duplicate(address, address_length);
    out->params = strdup(params);
    return out->plugin && out->address && out->params && plugin_length > 0;
}

void plugin_spec_finish(plugin_spec *spec)
{
    free(spec->plugin);
    free(spec->address);
    free(spec->params);
}
