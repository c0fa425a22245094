#include "face/rig/rig_document.h"

#include "base/os.h"
#include "base/file.h"
#include "base/json.h"
#include "base/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- values and their JSON paths ---- */

enum { NOTE_CAP = 8192, LINE_TEXT = 512 };

/* Estimates the memory, in bytes, of the parsed values of a text. */
static size_t rig_json_memory(const void *data, size_t size)
{
    enum { OBJECT_BYTES = 256, ARRAY_BYTES = 128, VALUE_BYTES = 64 }; /* sizes in jansson 2.14 */
    const char *text = data;
    size_t out = VALUE_BYTES;
    bool is_quoted = false;
    for (size_t i = 0; i < size; ++i) {
        if (is_quoted && text[i] == '\\')
            ++i;
        else if (text[i] == '"')
            is_quoted = !is_quoted;
        else if (!is_quoted)
            out += text[i] == '{'   ? OBJECT_BYTES
                   : text[i] == '[' ? ARRAY_BYTES
                   : text[i] == ',' ? VALUE_BYTES
                                    : 0;
    }
    return out;
}

mrt_result rig_json_text(char **out, const json_node *at, const char *expected, size_t length_max,
                         error *err)
{
    const char *text = json_string_value(at->value);
    size_t length = json_string_length(at->value);
    if (!text || length == 0)
        return json_node_unexpected(err, at, expected);
    if (length > length_max || !text_is_printable(text_view_of(text, length)))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: expected at most %zu characters and no control characters",
                         at->path.text, length_max);
    *out = strdup(text);
    return *out ? MRT_OK : rig_no_memory(err);
}

void rig_note(char **note, const char *format, ...)
{
    char line[LINE_TEXT];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    size_t old = *note ? strlen(*note) : 0, added = strlen(line);
    if (old > NOTE_CAP)
        return;
    char *grown = realloc(*note, old + added + 2);
    if (!grown)
        return; /* a note that cannot be added is dropped */
    memcpy(grown + old, line, added);
    memcpy(grown + old + added, "\n", 2);
    *note = grown;
}

/* ---- files ---- */

enum { FILE_SIZE_CAP = 16 << 20, CHAIN_TEXT = 800 };

const char *const rig_section_key[RIG_SECTIONS] = {"bones",       "regions", "contacts",
                                                   "skull_proxy", "poses",   "contact_sets"};
static const uint32_t section_cap[RIG_SECTIONS] = {RIG_BONES_MAX, 1024, 1024, 64, 1024, 64};

typedef struct loading { /* files being read, outermost first */
    rig_document *document;
    const char *folder; /* as in rig_document_read */
    const char *path[RIG_INCLUDE_DEPTH_MAX + 1];
    uint32_t depth;
} loading;

mrt_result rig_no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

/* ---- one file ---- */

static mrt_result parse_root(json_t **out, const void *data, size_t size, budget *b, error *err)
{
    mrt_result result = budget_spend_bytes(b, size + rig_json_memory(data, size), err);
    return result < 0 ? result : json_parse(out, data, size, err);
}

static mrt_result check_version(const json_node *root, error *err)
{
    mrt_result result = json_node_object(root, "an object with \"marotte_rig\": 1", err);
    if (result < 0)
        return result;
    json_node version = json_node_member(root, "marotte_rig");
    if (!version.value)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: expected 1, the version of the format; this is not a rig file",
                         version.path.text);
    return json_node_version(root, "marotte_rig", err);
}

static mrt_result read_unit(rig_file *file, const json_node *root, error *err)
{
    static const struct {
        const char *name;
        double mm;
    } units[] = {{"mm", 1.0}, {"cm", 10.0}, {"m", 1000.0}};
    json_node unit = json_node_member(root, "unit");
    if (!unit.value)
        return MRT_OK;
    const char *name = json_string_value(unit.value);
    for (size_t i = 0; name && i < sizeof units / sizeof *units; ++i)
        if (strcmp(units[i].name, name) == 0)
            file->mm_per_unit = units[i].mm;
    return file->mm_per_unit > 0.0 ? MRT_OK
                                   : json_node_unexpected(err, &unit, "\"mm\", \"cm\" or \"m\"");
}

/* Takes ownership of `root`, also on error. `shown` names an included file in messages; NULL for
 * the rig itself. */
static mrt_result add_file(rig_document *d, const char *path, const char *real_path, json_t *root,
                           const char *shown, error *err)
{
    rig_file *file = &d->file[d->file_count];
    json_node node = json_node_root(root, shown);
    *file = (rig_file){.root = root, .path = strdup(path), .root_path = node.path};
    d->file_count += 1;
    file->real_path = real_path ? strdup(real_path) : NULL;
    if (!file->path || (real_path && !file->real_path))
        return rig_no_memory(err);
    mrt_result result = check_version(&node, err);
    return result < 0 ? result : read_unit(file, &node, err);
}

/* ---- includes ---- */

static mrt_result load_file(loading *l, const char *path, const char *shown, error *err);

static mrt_result refuse_chain(const loading *l, const char *last, const char *why, error *err)
{
    char chain[CHAIN_TEXT] = "";
    for (uint32_t i = 0; i <= l->depth; ++i) {
        size_t used = strlen(chain);
        const char *path = i < l->depth ? l->path[i] : last;
        const char *slash = strrchr(path, '/');
        json_words word = json_shown(slash ? slash + 1 : path);
        (void)snprintf(chain + used, sizeof chain - used, "%s%s", i ? " includes " : "", word.text);
    }
    return error_set(err, MRT_ERR_FORMAT, "$.include: %s: %s", why, chain);
}

static char *join_path(const char *directory, const char *name)
{
    size_t size = strlen(directory) + strlen(name) + 1;
    char *path = malloc(size);
    if (path)
        (void)snprintf(path, size, "%s%s", name[0] == '/' ? "" : directory, name);
    return path;
}

static mrt_result include_one(loading *l, const json_node *at, const char *directory, error *err)
{
    char *name = NULL;
    mrt_result result = rig_json_text(&name, at, "the name of a rig file", 1024, err);
    if (result < 0)
        return result;
    char *path = join_path(directory, name);
    result = path ? MRT_OK : rig_no_memory(err);
    if (result >= 0 && l->folder)
        result = file_check_below(l->folder, path, err);
    if (result < 0)
        error_prefix(err, at->path.text);
    else
        result = load_file(l, path, name, err);
    free(path);
    free(name);
    return result;
}

static mrt_result include_all(loading *l, const json_node *root, const char *path, error *err)
{
    json_node include = json_node_member(root, "include");
    if (!include.value)
        return MRT_OK;
    char *directory = file_directory(path);
    if (!directory)
        return rig_no_memory(err);
    mrt_result result = MRT_OK;
    if (json_is_string(include.value))
        result = include_one(l, &include, directory, err);
    else
        result = json_node_array(&include, "the name of a rig file, or a list of names",
                                 RIG_FILES_MAX, err);
    for (size_t i = 0; result >= 0 && i < json_array_size(include.value); ++i) {
        json_node item = json_node_item(&include, i);
        result = include_one(l, &item, directory, err);
    }
    free(directory);
    return result;
}

static mrt_result check_chain(const loading *l, const char *real_path, error *err)
{
    for (uint32_t i = 0; i < l->depth; ++i)
        if (strcmp(l->path[i], real_path) == 0)
            return refuse_chain(l, real_path,
                                "a file includes itself; remove one of these includes", err);
    if (l->depth > RIG_INCLUDE_DEPTH_MAX)
        return refuse_chain(l, real_path, "more than 8 levels of includes; merge some of the files",
                            err);
    if (l->document->file_count + l->depth >= RIG_FILES_MAX)
        return refuse_chain(l, real_path, "more than 64 files in all; merge some of them", err);
    return MRT_OK;
}

static mrt_result read_root(json_t **out, loading *l, const char *path, error *err)
{
    file_bytes bytes;
    mrt_result result = file_read(&bytes, path, FILE_SIZE_CAP, err);
    if (result < 0)
        return result;
    if (l->depth == 1)
        l->document->budget = budget_of(BUDGET_RIG, bytes.size);
    result = parse_root(out, bytes.data, bytes.size, &l->document->budget, err);
    if (result < 0)
        error_prefix(err, path);
    file_bytes_finish(&bytes);
    return result;
}

/* Adds the included files, then the file itself. */
static mrt_result load_chained(loading *l, const char *path, const char *shown, error *err)
{
    json_t *root = NULL;
    const char *real_path = l->path[l->depth - 1];
    mrt_result result = read_root(&root, l, path, err);
    if (result < 0 && shown)
        error_prefix(err, "$.include");
    if (result < 0)
        return result;
    json_node node = json_node_root(root, NULL);
    result = include_all(l, &node, path, err);
    if (result < 0) {
        json_decref(root);
        return result;
    }
    return add_file(l->document, path, real_path, root, shown, err);
}

static bool is_read(const rig_document *d, const char *real_path)
{
    for (uint32_t i = 0; i < d->file_count; ++i)
        if (strcmp(d->file[i].real_path, real_path) == 0)
            return true;
    return false;
}

static mrt_result load_file(loading *l, const char *path, const char *shown, error *err)
{
    char *real_path = os_real_path(path);
    const char *known_as = real_path ? real_path : path;
    mrt_result result = check_chain(l, known_as, err);
    if (result >= 0 && !is_read(l->document, known_as)) {
        l->path[l->depth] = known_as;
        l->depth += 1;
        result = load_chained(l, path, shown, err);
        l->depth -= 1;
    }
    free(real_path);
    return result;
}

/* ---- entries ---- */

/* An entry of a later file replaces an entry of the same name from an earlier file. */
static mrt_result add_entry(rig_document *d, rig_section section, const rig_entry *entry,
                            error *err)
{
    rig_entry *all = d->entry[section];
    uint32_t count = d->entry_count[section];
    mrt_result result = budget_spend_work(&d->budget, count, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; entry->name[0] && i < count; ++i) {
        if (strcmp(all[i].name, entry->name) != 0)
            continue;
        if (all[i].file == entry->file) {
            json_words word = json_shown(entry->name);
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: the name \"%s\" is already used by %s; choose another name",
                             entry->node.path.text, word.text, all[i].node.path.text);
        }
        all[i] = *entry;
        return MRT_OK;
    }
    if (count >= section_cap[section])
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: more than %u entries are not supported; remove some",
                         entry->node.path.text, section_cap[section]);
    all[count] = *entry;
    d->entry_count[section] = count + 1;
    return MRT_OK;
}

static mrt_result add_list(rig_document *d, rig_section section, const json_node *list,
                           uint32_t file, error *err)
{
    mrt_result result = json_node_array(list, "an array", section_cap[section], err);
    for (size_t i = 0; result >= 0 && i < json_array_size(list->value); ++i) {
        rig_entry entry = {.node = json_node_item(list, i), .name = "", .file = file};
        result = json_node_object(&entry.node, "an object", err);
        const char *name = json_string_value(json_object_get(entry.node.value, "name"));
        if (name)
            entry.name = name;
        if (result >= 0)
            result = add_entry(d, section, &entry, err);
    }
    return result;
}

static mrt_result add_members(rig_document *d, rig_section section, const json_node *object,
                              uint32_t file, error *err)
{
    mrt_result result = json_node_object(object, "an object with lists of contacts", err);
    json_t *value = result < 0 ? NULL : (json_t *)(uintptr_t)object->value;
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        const char *key = json_object_iter_key(at);
        rig_entry entry = {.node = json_node_member(object, key), .name = key, .file = file};
        if (key[0] == '\0' || strlen(key) > RIG_NAME_MAX ||
            !text_is_printable(text_view_of(key, strlen(key))))
            return error_set(err, MRT_ERR_FORMAT, "%s: expected a key of 1 to %d characters",
                             entry.node.path.text, RIG_NAME_MAX);
        result = add_entry(d, section, &entry, err);
    }
    return result;
}

static mrt_result collect_section(rig_document *d, rig_section section, error *err)
{
    d->entry[section] = calloc(section_cap[section], sizeof *d->entry[section]);
    if (!d->entry[section])
        return rig_no_memory(err);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->file_count; ++i) {
        json_node root = {d->file[i].root, d->file[i].root_path};
        json_node list = json_node_member(&root, rig_section_key[section]);
        if (!list.value)
            continue;
        result = section == RIG_SETS ? add_members(d, section, &list, i, err)
                                     : add_list(d, section, &list, i, err);
    }
    return result;
}

/* A file without a unit uses that of the rig: the last unit that a file sets, else mm. */
static void settle_units(rig_document *d)
{
    double unit = 1.0;
    for (uint32_t i = 0; i < d->file_count; ++i)
        if (d->file[i].mm_per_unit > 0.0)
            unit = d->file[i].mm_per_unit;
    for (uint32_t i = 0; i < d->file_count; ++i)
        if (!(d->file[i].mm_per_unit > 0.0))
            d->file[i].mm_per_unit = unit;
}

static mrt_result collect(rig_document *d, error *err)
{
    settle_units(d);
    mrt_result result = MRT_OK;
    for (int section = 0; result >= 0 && section < RIG_SECTIONS; ++section)
        result = collect_section(d, (rig_section)section, err);
    return result;
}

/* ---- reading and freeing ---- */

/* Collects the entries if reading succeeded. On an error frees the document. */
static mrt_result finish_reading(rig_document **out, mrt_result result, error *err)
{
    if (result >= 0)
        result = collect(*out, err);
    if (result >= 0)
        return result;
    rig_document_destroy(*out);
    *out = NULL;
    return result;
}

mrt_result rig_document_read(rig_document **out, const char *path, const char *folder, error *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return rig_no_memory(err);
    (*out)->is_trusted = folder == NULL;
    loading l = {.document = *out, .folder = folder};
    return finish_reading(out, load_file(&l, path, NULL, err), err);
}

mrt_result rig_document_parse(rig_document **out, const void *data, size_t size, const char *path,
                              error *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out)
        return rig_no_memory(err);
    json_t *root = NULL;
    (*out)->budget = budget_of(BUDGET_RIG, size);
    mrt_result result = parse_root(&root, data, size, &(*out)->budget, err);
    if (result >= 0)
        result = add_file(*out, path, NULL, root, NULL, err);
    if (result >= 0 && json_object_get(root, "include"))
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "$.include: a rig that is not a file cannot include one");
    return finish_reading(out, result, err);
}

void rig_document_retain(rig_document *d)
{
    d->holder_count += 1;
}

void rig_document_destroy(rig_document *d)
{
    if (!d || atomic_fetch_sub(&d->holder_count, 1) > 0)
        return;
    for (uint32_t i = 0; i < d->file_count; ++i) {
        json_decref(d->file[i].root);
        free(d->file[i].path);
        free(d->file[i].real_path);
    }
    for (int section = 0; section < RIG_SECTIONS; ++section)
        free(d->entry[section]);
    free(d);
}

json_node rig_document_scalar(const rig_document *d, const char *key, uint32_t *out_file)
{
    for (uint32_t i = d->file_count; i-- > 0;) {
        json_node root = {d->file[i].root, d->file[i].root_path};
        json_node member = json_node_member(&root, key);
        *out_file = i;
        if (member.value)
            return member;
    }
    return (json_node){NULL, {"$"}};
}

json_node rig_document_paint(const rig_document *d, const char *name, uint32_t *out_file)
{
    for (uint32_t i = d->file_count; i-- > 0;) {
        json_node root = {d->file[i].root, d->file[i].root_path};
        json_node paints = json_node_member(&root, "paints");
        json_node paint = json_node_member(&paints, name);
        *out_file = i;
        if (paint.value)
            return paint;
    }
    return (json_node){NULL, {"$.paints"}};
}

/* ---- entries of the rig and of the file ---- */

/* Returns the name that identifies an entry, or NULL for entries that store their source or have
 * only an index. */
static const char *matched_name(const rig *r, rig_section section, uint32_t index)
{
    switch (section) {
    case RIG_BONES:
        return r->bone[index].name;
    case RIG_POSES:
        return r->pose[index].name;
    case RIG_SETS:
        return r->contact_set[index].name;
    default:
        return NULL;
    }
}

const rig_entry *rig_source(const rig *r, rig_section section, uint32_t index)
{
    const rig_document *d = r->document;
    const char *name = matched_name(r, section, index);
    if (!d)
        return NULL;
    uint32_t source = section == RIG_REGIONS    ? r->region[index].source
                      : section == RIG_CONTACTS ? r->contact[index].source
                      : section == RIG_PROXIES  ? r->proxy[index].source
                                                : 0;
    if (!name)
        return source > 0 && source <= d->entry_count[section] ? &d->entry[section][source - 1]
                                                               : NULL;
    for (uint32_t i = 0; i < d->entry_count[section]; ++i)
        if (strcmp(d->entry[section][i].name, name) == 0)
            return &d->entry[section][i];
    return NULL;
}

json_path rig_entry_path(const rig *r, rig_section section, uint32_t index)
{
    const rig_document *d = r->document;
    const rig_entry *source = rig_source(r, section, index);
    bool may_have_moved = section != RIG_SETS;
    if (source && (!may_have_moved || d->file_count > 1))
        return source->node.path;
    json_path out;
    (void)snprintf(out.text, sizeof out.text, "$.%s[%u]", rig_section_key[section], index);
    return out;
}
