/* window/dialogs.h - the questions over everything else: what is opened, and under which name
 * a show or a rig is saved (by the desktop's own file dialog, or the list of this window where it
 * has none or is not wanted), how takes are exported (export_page.h), and what becomes of work that
 * is not saved, and of exports that go on, before the program ends or another face comes. [main] */
#ifndef MAROTTE_UI_WINDOW_DIALOGS_H
#define MAROTTE_UI_WINDOW_DIALOGS_H
#include "window/export_page.h"
#include "window/open_any.h"
#include "window/portal.h"
#include "window/gui/ui.h"
#include "window/app/app.h"

typedef struct dialogs_desktop { /* the desktop's own dialog, beside one of ours */
    portal *asked;               /* NULL: it is not asked */
    bool asks, is_shown;         /* it is there to be answered; ours is */
} dialogs_desktop;

typedef struct dialogs_opening { /* the dialog that opens whatever there is */
    open_kind kind;              /* of which it lists files; OPEN_ANY: all */
    open_folder at[OPEN_KINDS];
    char name[OPEN_PATH];
    error trouble; /* why it was not done; "" */
    bool is_asked_first;
    dialogs_desktop desktop; /* asks instead of the list */
} dialogs_opening;

typedef struct dialogs_saving { /* the show or the rig under another name */
    bool is_rig;
    char file[OPEN_PATH];
    char replaced[OPEN_PATH]; /* the file that the person was told is there already */
    error trouble;            /* why it was not done; "" */
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
/* At once, or after the questions about what is not saved and what goes on: is_over then. */
void dialogs_quit(dialogs *self);

#endif
