#include "window/rig_keep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to keep the rig");
}

/* FNV-1a of the rig's folder: rigs of one name in several folders are kept side by side. */
static uint32_t hash_of(const char *text, size_t length)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < length; ++i)
        hash = (hash ^ (unsigned char)text[i]) * 16777619u;
    return hash;
}

static char *join(const char *folder, const char *rig_path)
{
    char *real = realpath(rig_path, NULL);
    const char *whole = real ? real : rig_path;
    const char *slash = strrchr(whole, '/'), *name = slash ? slash + 1 : whole;
    size_t size = strlen(folder) + strlen(name) + 32;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s%s.%08x.unsaved", folder, name,
                       hash_of(whole, (size_t)(name - whole)));
    free(real);
    return out;
}

static char *with_ending(const char *path, const char *ending)
{
    size_t size = strlen(path) + strlen(ending) + 1;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s%s", path, ending);
    return out;
}

static bool is_there(const char *path)
{
    return path && access(path, F_OK) == 0;
}

mrt_result rig_keep_open(rig_keep *out, const char *folder, const char *rig_path, error *err)
{
    *out = (rig_keep){0};
    if (!folder[0])
        return MRT_OK;
    out->path = join(folder, rig_path);
    char *moved = out->path ? with_ending(out->path, ".before") : NULL;
    if (!moved) {
        rig_keep_close(out);
        return no_memory(err);
    }
    if (is_there(out->path)) {
        out->old_path = strdup(out->path);
    } else if (is_there(moved)) {
        out->old_path = moved;
        moved = NULL;
    }
    free(moved);
    return MRT_OK;
}

void rig_keep_close(rig_keep *self)
{
    free(self->path);
    free(self->old_path);
    free(self->taken_path);
    *self = (rig_keep){0};
}

/* The old file may lie where the new one is to be. */
static void make_way(rig_keep *self)
{
    if (!self->old_path || strcmp(self->old_path, self->path) != 0)
        return;
    char *moved = with_ending(self->path, ".before");
    if (!moved || rename(self->path, moved) != 0) {
        free(moved);
        return;
    }
    free(self->old_path);
    self->old_path = moved;
}

const char *rig_keep_begin(rig_keep *self)
{
    if (!self->path)
        return NULL;
    make_way(self);
    self->is_begun = true;
    return self->path;
}

void rig_keep_end(rig_keep *self)
{
    if (self->is_begun)
        (void)unlink(self->path);
    if (self->taken_path)
        (void)unlink(self->taken_path);
    free(self->taken_path);
    self->taken_path = NULL;
    self->is_begun = false;
}

void rig_keep_drop_old(rig_keep *self)
{
    if (self->old_path)
        (void)unlink(self->old_path);
    free(self->old_path);
    self->old_path = NULL;
}

bool rig_keep_has_old(const rig_keep *self)
{
    return self->old_path != NULL;
}

mrt_result rig_keep_read(rig_keep *self, rig *out, const mesh *m, error *err)
{
    if (!self->old_path)
        return error_set(err, MRT_ERR_ARGUMENT, "nothing is kept of this rig");
    mrt_result result = rig_read(out, self->old_path, err);
    if (result >= 0 && out->mesh_vertex_count != 0 && out->mesh_vertex_count != m->vertex_count) {
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%s: it was made for a mesh of %u vertices, this one has %u",
                           self->old_path, out->mesh_vertex_count, m->vertex_count);
        rig_destroy(out);
    }
    if (result < 0)
        return result;
    free(self->taken_path);
    self->taken_path = self->old_path;
    self->old_path = NULL;
    return result;
}
