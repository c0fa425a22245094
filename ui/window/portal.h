/* window/portal.h - the file dialog of the desktop: org.freedesktop.portal.FileChooser on the
 * session bus (https://flatpak.github.io/xdg-desktop-portal). A request is sent, and polled in each
 * frame; nothing blocks. Only portal.c uses sd-bus; built without it, the list in the window is
 * used. Leaves out the use of the file. [main] */
#ifndef MAROTTE_UI_WINDOW_PORTAL_H
#define MAROTTE_UI_WINDOW_PORTAL_H
#include "base/error.h"

#include <stdint.h>

enum { PORTAL_PATH = 4096 };

typedef struct portal_filter {
    const char *name;           /* "Shows" */
    const char *const *endings; /* ".marotte", ... ended by NULL; of letters in any case */
} portal_filter;

typedef struct portal_question {
    bool
        is_saving; /* save a file (the desktop asks before it overwrites one); otherwise open one */
    const char *title, *folder, *name; /* title, initial folder, and name of a new file or "" */
    const portal_filter *filter;       /* the first is chosen */
    uint32_t filter_count;
    double patience_s; /* until the desktop has confirmed the request */
} portal_question;

typedef enum portal_answer {
    PORTAL_WAITS = 0, /* for the desktop */
    PORTAL_ASKS,      /* the dialog is there, and not answered yet */
    PORTAL_CHOSEN,
    PORTAL_CANCELLED,
    PORTAL_ABSENT /* no portal, or it does not answer, or it went away: ask otherwise */
} portal_answer;

typedef struct portal portal;

/* NULL: no session bus. Texts are copied. */
portal *portal_ask(const portal_question *question);
/* Each frame. The path is absolute, and of nothing that was looked at: there may be no such file.
 */
portal_answer portal_look(portal *self, char out_path[PORTAL_PATH]);
void portal_close(portal *self); /* a dialog that is still open goes; NULL is fine */

#endif
