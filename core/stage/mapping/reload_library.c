#include "stage/mapping/reload_library.h"
#include "base/clock.h"
#include "base/file.h"
#include "stage/mapping/library_file.h"
#include "stage/mapping/plugins.h"
#include "take/hash.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const size_t library_bytes_max = (size_t)256 << 20;

reload_stamp reload_stamp_of(const char *path)
{
    struct stat status;
    if (stat(path, &status) != 0)
        return (reload_stamp){0};
    return (reload_stamp){.time_ns =
                              (int64_t)status.st_mtim.tv_sec * NS_PER_S + status.st_mtim.tv_nsec,
                          .size = (int64_t)status.st_size,
                          .file = (uint64_t)status.st_ino};
}

bool reload_stamp_equal(const reload_stamp *a, const reload_stamp *b)
{
    return a->time_ns == b->time_ns && a->size == b->size && a->file == b->file;
}

mrt_result reload_folder_make(char out[PATH_MAX], error *err)
{
    const char *chosen = getenv("TMPDIR");
    int length =
        snprintf(out, PATH_MAX, "%s/marotte-XXXXXX", chosen && chosen[0] == '/' ? chosen : "/tmp");
    if (length > 0 && length < PATH_MAX && mkdtemp(out))
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "no folder for rebuilt plugins: %s", strerror(errno));
}

mrt_result reload_copy(const char *library, const char *folder, uint32_t n, char out_path[PATH_MAX],
                       char out_hash[TAKE_HASH], error *err)
{
    file_bytes bytes;
    const char *slash = strrchr(library, '/');
    mrt_result result = library_file_check(library, err);
    if (result >= 0)
        result = file_read(&bytes, library, library_bytes_max, err);
    if (result < 0)
        return result;
    int length =
        snprintf(out_path, PATH_MAX, "%s/%u-%.200s", folder, n, slash ? slash + 1 : library);
    hash_bytes(out_hash, bytes.data, bytes.size);
    if (length <= 0 || length >= PATH_MAX)
        result = error_set(err, MRT_ERR_IO, "%s: too long a name", library);
    FILE *copy = result >= 0 ? fopen(out_path, "wbx") : NULL;
    if (copy) { /* not file_write: it need not survive a power cut */
        bool is_written = fwrite(bytes.data, bytes.size, 1, copy) == 1;
        is_written &= fclose(copy) == 0;
        if (!is_written)
            result =
                error_set(err, MRT_ERR_IO, "%s cannot be written: %s", out_path, strerror(errno));
    } else if (result >= 0) {
        result = error_set(err, MRT_ERR_IO, "%s cannot be made: %s", out_path, strerror(errno));
    }
    file_bytes_finish(&bytes);
    return result;
}

mrt_result reload_open(const char *path, const char *type_id, const mrt_plugin_type **out_type,
                       error *err)
{
    *out_type = NULL;
    dlerror();
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const mrt_plugin_type *const *types = library ? dlsym(library, "marotte_plugins") : NULL;
    if (!types) {
        const char *reason = dlerror();
        return error_set(err, MRT_ERR_FORMAT, "%s", reason ? reason : "cannot be loaded");
    }
    for (; *types; ++types) {
        mrt_result result = plugin_type_check(*types, err);
        if (result < 0)
            return result;
        if (strcmp((*types)->id, type_id) != 0 || !plugin_interface(*types, MRT_MAPPING))
            continue;
        *out_type = *types;
        return MRT_OK;
    }
    return error_set(err, MRT_ERR_FORMAT, "has no mapping %s any more", type_id);
}
