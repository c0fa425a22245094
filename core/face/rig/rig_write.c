#include "face/rig/rig_fields.h"

#include "base/os.h"
#include "base/file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to write the rig");
}

/* ---- paints as JSON ---- */

typedef struct painting { /* the file to write */
    json_t *paints;
    const rig *r;
    int failed;
} painting;

/* ---- use of paints ---- */

static bool rig_names(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (rig_select_uses_paint(&r->region[i].select, name))
            return true;
    return false;
}

/* The parser limits the depth of everything that was read, so recursion is safe. */
static bool json_names(const json_t *select, const char *name)
{
    const char *painted = json_string_value(json_object_get(select, "painted"));
    if (painted && strcmp(painted, name) == 0)
        return true;
    const json_t *list[] = {json_object_get(select, "all"), json_object_get(select, "any")};
    for (int k = 0; k < 2; ++k)
        for (size_t i = 0; i < json_array_size(list[k]); ++i)
            if (json_names(json_array_get(list[k], i), name))
                return true;
    const json_t *inner[] = {json_object_get(select, "not"),
                             json_object_get(select, "pieces_inside")};
    for (int k = 0; k < 2; ++k)
        if (inner[k] && json_names(inner[k], name))
            return true;
    return false;
}

static bool file_names(const rig_document *d, const char *name)
{
    for (uint32_t i = 0; i < d->entry_count[RIG_REGIONS]; ++i)
        if (json_names(json_object_get(d->entry[RIG_REGIONS][i].node.value, "select"), name))
            return true;
    return false;
}

/* ---- the table of paints ---- */

static bool equals_paint(const json_node *paint, const rig_select *select)
{
    rig_select before = {0};
    bool same =
        rig_paint_parse(&before, paint, NULL, NULL) >= 0 && rig_paint_equals(&before, select);
    rig_select_finish(&before);
    return same;
}

static void write_paint(painting *p, const rig_select *select)
{
    const rig_document *d = p->r->document;
    uint32_t file = 0;
    json_node before = {0};
    if (d)
        before = rig_document_paint(d, select->name, &file);
    if (before.value && equals_paint(&before, select)) {
        if (!json_object_get(p->paints, select->name))
            p->failed |= json_object_set_new(p->paints, select->name, json_deep_copy(before.value));
        return;
    }
    p->failed |= json_object_set_new(p->paints, select->name, rig_paint_to_json(select));
}

static void write_paints_of(painting *p, const rig_select *select)
{
    if (select->kind == SELECT_PAINTED)
        write_paint(p, select);
    for (uint32_t i = 0; i < select->child_count; ++i)
        write_paints_of(p, &select->child[i]);
}

/* Deletes paints whose regions are gone. Paints that no region ever used belong to another program
 * and stay. */
static void delete_unused(painting *p)
{
    const rig_document *d = p->r->document;
    void *at = json_object_iter(p->paints);
    while (d && at) {
        const char *name = json_object_iter_key(at);
        bool is_forgotten = !rig_names(p->r, name) && file_names(d, name);
        void *next = json_object_iter_next(p->paints, at);
        if (is_forgotten)
            json_object_del(p->paints, name);
        at = next;
    }
}

/* Copies the paints, also those of included files. */
static json_t *start_paints(const rig *r, const json_t *root)
{
    const rig_document *d = r->document;
    const json_t *own = json_object_get(root, "paints");
    json_t *paints = json_is_object(own) ? json_deep_copy(own) : json_object();
    for (uint32_t i = d ? d->file_count : 0; i-- > 0;) {
        json_t *theirs = json_deep_copy(json_object_get(d->file[i].root, "paints"));
        json_object_update_missing(paints, theirs);
        json_decref(theirs);
    }
    return paints;
}

/* Sets "paints" in the root from the rig's selectors. */
void rig_write_paints(json_t *to, const void *of, rig_writing *w)
{
    const rig *r = of;
    painting p = {start_paints(r, to), r, 0};
    p.failed = p.paints == NULL;
    delete_unused(&p);
    for (uint32_t i = 0; i < r->region_count; ++i)
        write_paints_of(&p, &r->region[i].select);
    if (json_object_size(p.paints) > 0)
        p.failed |= json_object_set(to, "paints", p.paints);
    else if (json_is_object(json_object_get(to, "paints")))
        (void)json_object_del(to, "paints");
    json_decref(p.paints);
    w->failed |= p.failed != 0;
}

/* ---- the file ---- */

enum { DUMP_FLAGS = JSON_ENCODE_ANY | JSON_REAL_PRECISION(15) };

/* ---- paths ---- */

/* Returns the absolute directory of a file that need not exist, with the final '/'. The caller
 * frees it. */
static char *real_directory(const char *path)
{
    char *directory = file_directory(path);
    char *real = directory ? os_real_path(directory[0] ? directory : ".") : NULL;
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

/* Returns `to` relative to the directory `from`; both are absolute. */
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

/* Returns the name of the mesh for a rig file at `path`. The caller frees it. */
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

static const char *unit_name(double mm_per_unit)
{
    return mm_per_unit > 100.0 ? "m" : mm_per_unit > 5.0 ? "cm" : "mm";
}

/* Sets the keys that a new file needs, if no file or another file set them before. */
static void write_identity(json_t *root, const char *path, rig_writing *w)
{
    char *mesh = mesh_name_for(w->r, path);
    rig_set(root, "marotte_rig", json_integer(1), w);
    rig_set(root, "name", json_string(w->r->name), w);
    rig_set(root, "mesh", mesh ? json_string(mesh) : NULL, w);
    rig_set(root, "unit", json_string(unit_name(w->mm_per_unit)), w);
    free(mesh);
}

/* Copies this file's keys, and those of the files that it includes. */
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
    rig_writing w = {r, r->mm_per_unit, r->mm_per_unit, false};
    if (!stays_alone)
        write_identity(root, path, &w);
    rig_fields_write(root, rig_root_fields, r, &w);
    return w.failed ? no_memory(err) : MRT_OK;
}

/* ---- the text: one line per entry ---- */

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
