/* stage/mapping/reload_library.h - a library file that is watched, and copies of it that are
 * loaded: a rebuilt file of the same name would not be loaded again, and would change under the
 * program. One thread that may block. */
#ifndef MAROTTE_STAGE_RELOAD_LIBRARY_H
#define MAROTTE_STAGE_RELOAD_LIBRARY_H
#include "take/take.h"

#include <limits.h>

typedef struct reload_stamp { /* zeroed: no such file */
    int64_t time_ns, size;
    uint64_t file;
} reload_stamp;

reload_stamp reload_stamp_of(const char *path);
bool reload_stamp_equal(const reload_stamp *a, const reload_stamp *b);

/* A folder for copies, which nobody else may enter. */
CHECKED mrt_result reload_folder_make(char out[PATH_MAX], error *err);
/* Copies the file as number `n`; its SHA-256 goes to out_hash. */
CHECKED mrt_result reload_copy(const char *library, const char *folder, uint32_t n,
                               char out_path[PATH_MAX], char out_hash[TAKE_HASH], error *err);
/* The mapping of that id in a library, loaded and its tables checked. */
CHECKED mrt_result reload_open(const char *path, const char *type_id,
                               const mrt_plugin_type **out_type, error *err);

#endif
