/* window/portal.h - the desktop's own file dialog: org.freedesktop.portal.FileChooser on the
 * session bus (https://flatpak.github.io/xdg-desktop-portal). A question is asked, and looked at
 * each frame until it is answered; nothing here waits. portal.c is the only file that knows sd-bus;
 * built without it no desktop has a dialog. Leaves out what is done with the file. [main] */
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
    bool is_saving; /* a new file, which the desktop asks about if it is there; else
                       one to open */
    const char *title, *folder, *name; /* where it begins; the name of a new file, or "" */
    const portal_filter *filter;       /* the first is chosen */
    uint32_t filter_count;
    double patience_s; /* until the desktop says that it has begun to ask */
} portal_question;

typedef enum portal_answer {
    PORTAL_WAITS = 0, /* for the desktop */
    PORTAL_ASKS,      /* the dialog is there, and not answered yet */
    PORTAL_CHOSEN,
    PORTAL_CANCELLED,
    PORTAL_ABSENT /* no portal, or it does not answer, or it went away: ask otherwise */
} portal_answer;

typedef struct portal portal;

/* NULL: there is no session bus. Texts are copied. */
portal *portal_ask(const portal_question *question);
/* Each frame. The path is absolute, and of nothing that was looked at: there may be no such file.
 */
portal_answer portal_look(portal *self, char out_path[PORTAL_PATH]);
void portal_close(portal *self); /* a dialog that is still open goes; NULL is fine */

#endif
