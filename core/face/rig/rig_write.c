#include "face/rig.h"

#include "base/file.h"
#include "face/rig/rig_document.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DUMP_FLAGS = JSON_ENCODE_ANY | JSON_REAL_PRECISION(15) };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to write the rig");
}

/* ---- paths ---- */

/* The absolute directory of a file that need not exist, with its final '/'; to be freed. */
static char *real_directory(const char *path)
{
    char *directory = file_directory(path);
    char *real = directory ? realpath(directory[0] ? directory : ".", NULL) : NULL;
    free(directory);
    if (!real)
        return NULL;
    size_t size = strlen(real) + 2;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s/", strcmp(real, "/") == 0 ? "" : real);
    free(real);
    return out;
}

/* `to` as seen from the directory `from`; both absolute. */
static char *relative_path(const char *from, const char *to)
{
    size_t common = 0;
    for (size_t i = 0; from[i] && from[i] == to[i]; ++i)
        if (from[i] == '/')
            common = i + 1;
    uint32_t up_count = 0;
    for (const char *at = from + common; *at; ++at)
        up_count += *at == '/';
    size_t size = 3 * (size_t)up_count + strlen(to + common) + 1;
    char *out = malloc(size);
    if (!out)
        return NULL;
    for (uint32_t i = 0; i < up_count; ++i)
        memcpy(out + 3 * (size_t)i, "../", 3);
    (void)snprintf(out + 3 * (size_t)up_count, size - 3 * (size_t)up_count, "%s", to + common);
    return out;
}

/* How a rig file at `path` names its mesh; to be freed. */
static char *mesh_name_for(const rig *r, const char *path)
{
    char *from = real_directory(path), *to = real_directory(r->mesh_path);
    const char *slash = strrchr(r->mesh_path, '/');
    const char *base = slash ? slash + 1 : r->mesh_path;
    char *out = NULL;
    if (from && to) {
        size_t size = strlen(to) + strlen(base) + 1;
        char *mesh = malloc(size);
        if (mesh)
            (void)snprintf(mesh, size, "%s%s", to, base);
        out = mesh ? relative_path(from, mesh) : NULL;
        free(mesh);
    } else {
        out = strdup(r->mesh_path);
    }
    free(from);
    free(to);
    return out;
}

static bool is_same_directory(const char *a, const char *b)
{
    char *first = real_directory(a), *second = real_directory(b);
    bool same = first && second && strcmp(first, second) == 0;
    free(first);
    free(second);
    return same;
}

/* ---- entries and where they came from ---- */

static uint32_t entry_count_of(const rig *r, rig_section section)
{
    const uint32_t count[RIG_SECTIONS] = {
        [RIG_BONES] = r->bone_count,       [RIG_REGIONS] = r->region_count,
        [RIG_CONTACTS] = r->contact_count, [RIG_PROXIES] = r->proxy_count,
        [RIG_POSES] = r->pose_count,       [RIG_SETS] = r->contact_set_count};
    return count[section];
}

static const char *entry_name(const rig *r, rig_section section, uint32_t index)
{
    switch (section) {
    case RIG_BONES:
        return r->bone[index].name;
    case RIG_CONTACTS:
        return r->contact[index].name;
    case RIG_POSES:
        return r->pose[index].name;
    case RIG_SETS:
        return r->contact_set[index].name;
    default:
        return NULL;
    }
}

static json_t *entry_to_json(const rig *r, rig_section section, uint32_t index, double mm_per_unit)
{
    const rig_document *d = r->document;
    const rig_entry *source = rig_source(r, section, index);
    return rig_entry_to_json(r, section, index, source ? source->node.value : NULL,
                             source ? d->file[source->file].mm_per_unit : mm_per_unit, mm_per_unit);
}

/* ---- the whole ---- */

static mrt_result put_section(json_t *root, const rig *r, rig_section section, error *err)
{
    const char *key = rig_section_key[section];
    json_t *all = section == RIG_SETS ? json_object() : json_array();
    int failed = all == NULL;
    for (uint32_t i = 0; !failed && i < entry_count_of(r, section); ++i) {
        json_t *entry = entry_to_json(r, section, i, r->mm_per_unit);
        failed = section == RIG_SETS ? json_object_set_new(all, entry_name(r, section, i), entry)
                                     : json_array_append_new(all, entry);
    }
    bool is_empty = json_object_size(all) + json_array_size(all) == 0;
    if (!failed && (!is_empty || json_object_get(root, key)))
        failed = json_object_set(root, key, all);
    json_decref(all);
    return failed ? no_memory(err) : MRT_OK;
}

static void update_solver(json_t *solver, const csrbf_settings *settings)
{
    csrbf_kernel kernel = CSRBF_WENDLAND_C2;
    csrbf_polynomial polynomial = CSRBF_NONE;
    const char *word = json_string_value(json_object_get(solver, "kernel"));
    if ((word && !csrbf_kernel_named(word, &kernel)) || kernel != settings->kernel)
        json_object_set_new(solver, "kernel", json_string(csrbf_kernel_name(settings->kernel)));
    word = json_string_value(json_object_get(solver, "polynomial"));
    if ((word && !csrbf_polynomial_named(word, &polynomial)) || polynomial != settings->polynomial)
        json_object_set_new(solver, "polynomial",
                            json_string(csrbf_polynomial_name(settings->polynomial)));
    const double value[] = {settings->radius, settings->ridge};
    static const char *const key[] = {"radius_mm", "ridge"};
    for (int i = 0; i < 2; ++i) {
        double before = json_number_value(json_object_get(solver, key[i]));
        if (value[i] < before || value[i] > before)
            json_object_set_new(solver, key[i], rig_number_to_json(value[i]));
    }
}

static mrt_result put_solver(json_t *root, const rig *r, error *err)
{
    uint32_t file;
    rig_node before = {0};
    if (r->document)
        before = rig_document_scalar(r->document, "solver", &file);
    json_t *solver = before.value ? json_deep_copy(before.value) : json_object();
    if (!solver)
        return no_memory(err);
    update_solver(solver, &r->solver);
    bool is_news = before.value ? !json_equal(solver, before.value) : json_object_size(solver) > 0;
    if (is_news)
        json_object_set(root, "solver", solver);
    json_decref(solver);
    return MRT_OK;
}

static const char *unit_name(double mm_per_unit)
{
    return mm_per_unit > 100.0 ? "m" : mm_per_unit > 5.0 ? "cm" : "mm";
}

/* What a file must say when nothing, or another file, said it before. */
static mrt_result put_identity(json_t *root, const rig *r, const char *path, error *err)
{
    char *mesh = mesh_name_for(r, path);
    if (!mesh)
        return no_memory(err);
    int failed = json_object_set_new(root, "marotte_rig", json_integer(1));
    failed |= json_object_set_new(root, "name", json_string(r->name));
    failed |= json_object_set_new(root, "mesh", json_string(mesh));
    failed |= json_object_set_new(root, "unit", json_string(unit_name(r->mm_per_unit)));
    free(mesh);
    return failed ? no_memory(err) : MRT_OK;
}

static void put_mesh_facts(json_t *root, const rig *r)
{
    char hash[20];
    (void)snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->mesh_hash);
    if (r->mesh_vertex_count > 0)
        json_object_set_new(root, "mesh_vertices", json_integer((json_int_t)r->mesh_vertex_count));
    if (r->mesh_hash != 0)
        json_object_set_new(root, "mesh_hash", json_string(hash));
}

/* This file's keys, and those of the files that it includes. */
static json_t *start_root(const rig *r)
{
    const rig_document *d = r->document;
    if (!d)
        return json_object();
    json_t *root = json_deep_copy(d->file[d->file_count - 1].root);
    for (uint32_t i = d->file_count - 1; i-- > 0;) {
        json_t *included = json_deep_copy(d->file[i].root);
        json_object_update_missing(root, included);
        json_decref(included);
    }
    if (root)
        json_object_del(root, "include");
    return root;
}

static mrt_result fill_root(json_t *root, const rig *r, const char *path, error *err)
{
    const rig_document *d = r->document;
    bool stays_alone = d && d->file_count == 1 && is_same_directory(path, r->path);
    mrt_result result = MRT_OK;
    if (!stays_alone)
        result = put_identity(root, r, path, err);
    put_mesh_facts(root, r);
    for (int section = 0; result >= 0 && section < RIG_SECTIONS; ++section)
        result = put_section(root, r, (rig_section)section, err);
    if (result >= 0)
        result = rig_write_paints(root, r, err);
    return result < 0 ? result : put_solver(root, r, err);
}

/* ---- the text: one entry a line ---- */

static bool is_long(const json_t *value)
{
    return json_is_object(json_array_get(value, 0)) ||
           json_is_array(json_object_iter_value(json_object_iter((json_t *)(uintptr_t)value)));
}

static void print_long(FILE *stream, const json_t *value)
{
    json_t *changeable = (json_t *)(uintptr_t)value;
    bool is_array = json_is_array(value);
    fputs(is_array ? "[" : "{", stream);
    for (size_t i = 0; i < json_array_size(value); ++i) {
        fputs(i ? ",\n    " : "\n    ", stream);
        json_dumpf(json_array_get(value, i), stream, DUMP_FLAGS);
    }
    void *first = json_object_iter(changeable);
    for (void *at = first; at; at = json_object_iter_next(changeable, at)) {
        json_t *key = json_string(json_object_iter_key(at));
        fputs(at == first ? "\n    " : ",\n    ", stream);
        json_dumpf(key, stream, DUMP_FLAGS);
        fputs(": ", stream);
        json_dumpf(json_object_iter_value(at), stream, DUMP_FLAGS);
        json_decref(key);
    }
    fputs(is_array ? "\n  ]" : "\n  }", stream);
}

static void print_root(FILE *stream, json_t *root)
{
    void *first = json_object_iter(root);
    fputs("{", stream);
    for (void *at = first; at; at = json_object_iter_next(root, at)) {
        json_t *key = json_string(json_object_iter_key(at));
        const json_t *value = json_object_iter_value(at);
        fputs(at == first ? "\n  " : ",\n  ", stream);
        json_dumpf(key, stream, DUMP_FLAGS);
        fputs(": ", stream);
        if (is_long(value))
            print_long(stream, value);
        else
            json_dumpf(value, stream, DUMP_FLAGS);
        json_decref(key);
    }
    fputs("\n}\n", stream);
}

mrt_result rig_write(const rig *r, const char *path, error *err)
{
    json_t *root = start_root(r);
    if (!root)
        return no_memory(err);
    file_writer writer = {0};
    mrt_result result = fill_root(root, r, path, err);
    if (result >= 0)
        result = file_writer_open(&writer, path, err);
    if (result >= 0) {
        print_root(writer.stream, root);
        result = file_writer_commit(&writer, err);
    }
    json_decref(root);
    return result;
}
