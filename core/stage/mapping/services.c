#include "stage/mapping/services.h"
#include "base/file.h"

#include <stdio.h>

static mrt_result make(file_home below, const char *type_id, char *out, size_t capacity, error *err)
{
    char rest[256];
    int length = snprintf(rest, sizeof rest, "plugins/%s", type_id);
    if (capacity > 0)
        out[0] = '\0';
    if (length <= 0 || (size_t)length >= sizeof rest)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: too long an id for a folder", type_id);
    mrt_result result = file_home_path(out, capacity, below, rest, err);
    if (result >= 0)
        result = file_make_folders(out, err);
    if (result < 0 && capacity > 0)
        out[0] = '\0';
    return result;
}

mrt_result services_settings_folder(const char *type_id, char *out, size_t capacity, error *err)
{
    return make(FILE_HOME_CONFIG, type_id, out, capacity, err);
}

mrt_result services_cache_folder(const char *type_id, char *out, size_t capacity, error *err)
{
    return make(FILE_HOME_CACHE, type_id, out, capacity, err);
}
