/* window/open_any.h - what a file is to the stage, decided here alone, by how it ends and, where
 * that says nothing, by how it begins; what was opened lately. Leaves out asking (dialogs.h).
 * [main] */
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

#endif
