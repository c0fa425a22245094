/* window/folder.h - what a folder has to open: other folders, and files of some kinds. Looks
 * at the disk when it is asked to, and only then. [main] */
#ifndef MAROTTE_UI_WINDOW_FOLDER_H
#define MAROTTE_UI_WINDOW_FOLDER_H
#include "base/error.h"

#include <stdint.h>

enum { FOLDER_PATH = 4096, FOLDER_NAME = 256, FOLDER_ENTRIES = 2000 };

typedef struct folder_entry {
    char name[FOLDER_NAME];
    bool is_folder;
    uint64_t bytes;    /* of a file */
    int64_t changed_s; /* since 1970 */
} folder_entry;

typedef struct folder {
    char path[FOLDER_PATH]; /* absolute, without a '/' at its end but "/" itself */
    folder_entry *entry;    /* folders first, then by name; ".." where there is one */
    uint32_t count;
    bool has_more; /* than FOLDER_ENTRIES */
} folder;

/* endings: ".marotte", ... ended by NULL. On an error `self` stays what it was. */
CHECKED mrt_result folder_go(folder *self, const char *path, const char *const *endings,
                             error *err);
void folder_finish(folder *self); /* accepts zeroed */
/* path of an entry, or of a name that is typed: absolute ones stand for themselves. False: too
 * long. */
bool folder_join(const folder *self, const char *name, char out[FOLDER_PATH]);
bool folder_name_ends(const char *name, const char *const *endings);

#endif
