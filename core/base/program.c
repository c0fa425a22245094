#include "base/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static bool is_program(const char *path)
{
    return access(path, X_OK) == 0;
}

static bool is_beside(char out[PATH_MAX], const char *name)
{
    size_t size = strlen(name) + 1;
    ssize_t length = size < PATH_MAX ? readlink("/proc/self/exe", out, PATH_MAX - size) : -1;
    if (length <= 0)
        return false;
    out[length] = '\0';
    char *slash = strrchr(out, '/');
    if (!slash)
        return false;
    memcpy(slash + 1, name, size);
    return is_program(out);
}

mrt_result program_find(char out[PATH_MAX], const char *name, const char *variable,
                        const char *build_dir, const char *purpose, error *err)
{
    const char *chosen = getenv(variable);
    if (chosen && *chosen) {
        if (strlen(chosen) < PATH_MAX && is_program(chosen)) {
            memcpy(out, chosen, strlen(chosen) + 1);
            return MRT_OK;
        }
        return error_set(err, MRT_ERR_IO, "%s names \"%s\", which cannot be run", variable, chosen);
    }
    if (is_beside(out, name))
        return MRT_OK;
    int written = snprintf(out, PATH_MAX, "%s/%s", build_dir, name);
    if (written > 0 && written < PATH_MAX && is_program(out))
        return MRT_OK;
    return error_set(err, MRT_ERR_IO,
                     "%s is not beside the program: %s; install it there or name it in %s", name,
                     purpose, variable);
}
