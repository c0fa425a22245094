/* window/dialogs.h - modal dialogs: open and save (with the file dialog of the desktop, or a list
 * in this window), export (export_page.h), unsaved work and running exports before the program
 * quits or opens another face. [main] */
#ifndef MAROTTE_UI_WINDOW_DIALOGS_H
#define MAROTTE_UI_WINDOW_DIALOGS_H
#include "window/export_page.h"
#include "window/open_any.h"
#include "window/portal.h"
#include "window/gui/ui.h"
#include "window/app/app.h"

typedef struct dialogs_desktop { /* the desktop's own dialog, beside one of ours */
    portal *asked;               /* NULL: it is not asked */
    bool asks, is_shown;         /* the dialog of the desktop is open; ours is not */
} dialogs_desktop;

typedef struct dialogs_opening { /* the dialog that opens any file */
    open_kind kind;              /* of which it lists files; OPEN_ANY: all */
    open_folder at[OPEN_KINDS];
    char name[OPEN_PATH];
    error trouble; /* error of the last attempt; "" */
    bool is_asked_first;
    dialogs_desktop desktop; /* asks instead of the list */
} dialogs_opening;

typedef struct dialogs_saving { /* the show or the rig under another name */
    bool is_rig;
    char file[OPEN_PATH];
    char replaced[OPEN_PATH]; /* the existing file that the user was warned about */
    error trouble;            /* error of the last attempt; "" */
    bool is_asked_first;
    dialogs_desktop desktop; /* asks too */
} dialogs_saving;

typedef enum dialogs_leaving { /* what waits for the answer about unsaved work, and exports */
                               DIALOGS_STAYS = 0,
                               DIALOGS_QUITS,
                               DIALOGS_CHANGES_FACE
} dialogs_leaving;

typedef struct dialogs {
    app *app;
    ui *ui;
    dialogs_opening opening;
    dialogs_saving saving;
    export_page exports;
    dialogs_leaving leaving;
    char next_face[OPEN_PATH]; /* DIALOGS_CHANGES_FACE */
    bool asks, asks_exports;   /* the question is on the screen */
    bool waits_for_exports;    /* it was answered: then the program ends */
    uint32_t failed_exports;   /* when it was asked */
    bool is_over;              /* the program is to end */
} dialogs;

void dialogs_init(dialogs *out, app *of, ui *on);
void dialogs_finish(dialogs *self);
/* Each frame, over all panels. */
void dialogs_draw(dialogs *self);

void dialogs_ask_open(dialogs *self, open_kind kind);
/* A file that was dropped: opened, after the question about what is not saved; a folder is shown.
 */
void dialogs_drop(dialogs *self, const char *path);
void dialogs_ask_save_as(dialogs *self);
/* Quits immediately, or after the questions about unsaved work and running exports; then is_over is
 * set. */
void dialogs_quit(dialogs *self);

#endif
