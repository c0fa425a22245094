/* window/open_any.h - what a file is to the stage, decided here alone, by how it ends and, where
 * that says nothing, by how it begins; what a folder has to open, looked at when it is asked for
 * and only then; what was opened lately. Leaves out asking (dialogs.h). [main] */
#ifndef MAROTTE_UI_WINDOW_OPEN_ANY_H
#define MAROTTE_UI_WINDOW_OPEN_ANY_H
#include "window/app/app.h"

typedef enum open_kind {
    OPEN_ANY = 0, /* of a file: nothing that is known */
    OPEN_SHOW,
    OPEN_FACE,
    OPEN_HANDS,   /* recorded */
    OPEN_VOICE,   /* for the take that is chosen */
    OPEN_PICTURE, /* behind the face */
    OPEN_KINDS
} open_kind;

/* Of a file that is there or, by its ending, of one that is not. */
open_kind open_kind_of(const char *path);
const char *const *open_endings(open_kind kind); /* ended by NULL; OPEN_ANY: all of them */
/* An error is said in the news, and comes back. A face is opened whatever is not saved. */
CHECKED mrt_result open_any(app *of, const char *path);

enum { OPEN_RECENT_MAX = 6 };
/* The newest first; the settings'. */
uint32_t open_recent(const settings *from, const char *out[OPEN_RECENT_MAX]);

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
    open_entry *entry;    /* folders first, then by name; ".." where there is one */
    uint32_t count;
    bool has_more; /* than OPEN_ENTRIES */
} open_folder;

/* endings: ".marotte", ... ended by NULL. On an error `self` stays what it was. */
CHECKED mrt_result open_folder_go(open_folder *self, const char *path, const char *const *endings,
                                  error *err);
void open_folder_finish(open_folder *self); /* accepts zeroed */
/* path of an entry, or of a name that is typed: absolute ones stand for themselves. False: too
 * long. */
bool open_folder_join(const open_folder *self, const char *name, char out[OPEN_PATH]);
bool open_name_ends(const char *name, const char *const *endings);

#endif
