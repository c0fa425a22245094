/* window/open_any.h - decides what kind of file the stage opens, by its extension or by its first
 * bytes; lists the files of a folder when requested. Leaves out the dialog (dialogs.h). [main] */
#ifndef MAROTTE_UI_WINDOW_OPEN_ANY_H
#define MAROTTE_UI_WINDOW_OPEN_ANY_H
#include "window/app/app.h"
#include "window/app/open_recent.h"

typedef enum open_kind {
    OPEN_ANY = 0, /* of a file: unknown */
    OPEN_SHOW,
    OPEN_FACE,
    OPEN_HANDS,   /* recorded */
    OPEN_VOICE,   /* for the take that is chosen */
    OPEN_PICTURE, /* behind the face */
    OPEN_KINDS
} open_kind;

/* Kind of an existing file or, by its extension, of a missing one. */
open_kind open_kind_of(const char *path);
const char *const *open_endings(open_kind kind); /* ended by NULL; OPEN_ANY: all of them */
/* Opens a file. Reports errors as messages and returns them. Opens a face without asking about
 * unsaved work. */
CHECKED mrt_result open_any(app *of, const char *path);

/* ---- folders: other folders, and files of some kinds ---- */

enum { OPEN_PATH = 4096, OPEN_NAME = 256, OPEN_ENTRIES = 2000 };

typedef struct open_entry {
    char name[OPEN_NAME];
    bool is_folder;
    uint64_t bytes;    /* of a file */
    int64_t changed_s; /* since 1970 */
} open_entry;

typedef struct open_folder {
    char path[OPEN_PATH]; /* absolute, without a '/' at its end but "/" itself */
    open_entry *entry;    /* folders first, then by name; with ".." except at the root */
    uint32_t count;
    bool has_more; /* than OPEN_ENTRIES */
} open_folder;

/* endings: ".marotte", ... ended by NULL. On an error `self` stays what it was. */
CHECKED mrt_result open_folder_go(open_folder *self, const char *path, const char *const *endings,
                                  error *err);
void open_folder_finish(open_folder *self); /* accepts zeroed */
/* Writes the path of an entry or of a typed name, which may be absolute. False: too long. */
bool open_folder_join(const open_folder *self, const char *name, char out[OPEN_PATH]);
bool open_name_ends(const char *name, const char *const *endings);

#endif
