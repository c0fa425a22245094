#include "stage/take/identity.h"

#include "base/file.h"
#include "stage/mapping/isolate.h"
#include "take/hash.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RIG_BYTES_MAX = 16 << 20 };

char *identity_of_plugin(const plugin_list *plugins, const mrt_plugin_type *type)
{
    char hash[TAKE_HASH] = "-";
    error ignored = {""};
    type = isolate_inner(type);
    const char *path = plugin_list_path_of(plugins, type);
    if (path && hash_file(hash, path, &ignored) < 0)
        snprintf(hash, sizeof hash, "-");
    size_t size = strlen(type->id) + strlen(type->version) + sizeof hash + 3;
    char *out = malloc(size);
    if (out)
        snprintf(out, size, "%s %s %s", type->id, type->version, hash);
    return out;
}

static mrt_result keep_rig(take_performance *out, const char *path, error *err)
{
    file_bytes text;
    mrt_result result = file_read(&text, path, RIG_BYTES_MAX, err);
    if (result < 0)
        return result;
    hash_bytes(out->rig_hash, text.data, text.size);
    out->rig_json = strdup((const char *)text.data);
    file_bytes_finish(&text);
    return out->rig_json ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
}

mrt_result identity_of_face(take_performance *out, const face_file *file, const char *path,
                            double unit_mm, error *err)
{
    char absolute[PATH_MAX];
    const char *whole = realpath(path, absolute);
    free(out->rig);
    free(out->rig_json);
    out->rig_json = NULL;
    out->rig_hash[0] = '\0';
    out->unit_mm = unit_mm;
    out->rig = strdup(whole ? whole : path);
    if (!out->rig)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %s", path);
    mrt_result result = hash_file(out->mesh_hash, file->rig ? file->rig->mesh_path : path, err);
    return result < 0 || !file->rig ? result : keep_rig(out, path, err);
}

void identity_of_params(take_performance *out, const instance *mapping)
{
    const mrt_plugin_type *type = mapping->type;
    out->param_count = 0;
    for (uint32_t i = 0; i < type->param_count && i < TAKE_PARAMS_MAX; ++i)
        if (!(type->params[i].flags & MRT_PARAM_TRIGGER))
            out->param[out->param_count++] =
                (take_param){type->params[i].id, atomic_load(&mapping->wanted[i])};
}
