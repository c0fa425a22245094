#include "face/rig.h"

#include "base/file.h"
#include "face/rig/rig_document.h"

#include <stdlib.h>
#include <string.h>

static const uint64_t fnv_offset = 14695981039346656037u, fnv_prime = 1099511628211u;

static mrt_result finish_reading(rig *out, rig_document *d, const char *path, error *err)
{
    out->document = d;
    out->path = strdup(path);
    mrt_result result =
        out->path ? rig_fill(out, d, err) : error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
    if (result < 0)
        rig_destroy(out);
    return result;
}

static mrt_result read_within(rig *out, const char *path, const char *folder, error *err)
{
    rig_document *d = NULL;
    mrt_result result = rig_document_read(&d, path, folder, err);
    if (result >= 0)
        result = finish_reading(out, d, path, err);
    if (result < 0 && err && strncmp(err->text, path, strlen(path)) != 0)
        error_prefix(err, path);
    return result;
}

mrt_result rig_read(rig *out, const char *path, error *err)
{
    *out = (rig){0};
    char *folder = file_directory(path);
    if (!folder)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
    mrt_result result = read_within(out, path, folder, err);
    free(folder);
    return result;
}

mrt_result rig_read_trusted(rig *out, const char *path, error *err)
{
    *out = (rig){0};
    return read_within(out, path, NULL, err);
}

mrt_result rig_parse(rig *out, const void *data, size_t size, const char *path, error *err)
{
    *out = (rig){0};
    rig_document *d = NULL;
    mrt_result result = rig_document_parse(&d, data, size, path, err);
    if (result >= 0)
        result = finish_reading(out, d, path, err);
    if (result < 0)
        error_prefix(err, path);
    return result;
}

static void free_bones(rig *r)
{
    for (uint32_t i = 0; r->bone && i < r->bone_count; ++i) {
        for (uint32_t k = 0; k < RIG_TURNS_MAX; ++k)
            free(r->bone[i].turn[k].name);
        free(r->bone[i].name);
    }
    free(r->bone);
}

static void free_pose(rig_pose *pose)
{
    for (uint32_t i = 0; pose->dof_name && i < pose->dof_count; ++i)
        free(pose->dof_name[i]);
    free(pose->dof_name);
    free(pose->dof_value);
    free(pose->pull_contact);
    free(pose->pull_mm);
    free(pose->name);
}

void rig_destroy(rig *r)
{
    if (!r)
        return;
    free_bones(r);
    for (uint32_t i = 0; r->region && i < r->region_count; ++i) {
        rig_select_finish(&r->region[i].select);
        free(r->region[i].name);
    }
    for (uint32_t i = 0; r->contact && i < r->contact_count; ++i)
        free(r->contact[i].name);
    for (uint32_t i = 0; r->pose && i < r->pose_count; ++i)
        free_pose(&r->pose[i]);
    for (uint32_t i = 0; r->contact_set && i < r->contact_set_count; ++i) {
        free(r->contact_set[i].name);
        free(r->contact_set[i].contact);
    }
    free(r->region);
    free(r->contact);
    free(r->proxy);
    free(r->pose);
    free(r->contact_set);
    rig_document_destroy(r->document);
    free(r->path);
    free(r->name);
    free(r->mesh_path);
    free(r->note);
    *r = (rig){0};
}

uint32_t rig_find_bone(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (strcmp(r->bone[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

uint32_t rig_find_contact(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->contact_count; ++i)
        if (strcmp(r->contact[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

const rig_contact_set *rig_find_contact_set(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->contact_set_count; ++i)
        if (strcmp(r->contact_set[i].name, name) == 0)
            return &r->contact_set[i];
    return NULL;
}

bool rig_region_is_paint(const rig_region *region)
{
    static const char *const prefixes[] = {"painted ", "rigid "};
    const rig_select_kind kind = region->select.kind;
    if (!region->name || (kind != SELECT_VERTICES && kind != SELECT_PAINTED))
        return false;
    for (int i = 0; i < 2; ++i)
        if (strncmp(region->name, prefixes[i], strlen(prefixes[i])) == 0)
            return true;
    return false;
}

static uint64_t hash_word(uint64_t hash, uint32_t word)
{
    for (int byte = 0; byte < 4; ++byte)
        hash = (hash ^ ((word >> (8 * byte)) & 0xffu)) * fnv_prime;
    return hash;
}

uint64_t rig_mesh_hash(uint32_t vertex_count, const uint32_t *triangle, uint32_t triangle_count)
{
    uint64_t hash = hash_word(fnv_offset, vertex_count);
    for (size_t i = 0; i < (size_t)triangle_count * 3; ++i)
        hash = hash_word(hash, triangle[i]);
    return hash;
}
