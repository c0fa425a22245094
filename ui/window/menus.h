/* window/menus.h - the menu of the window, the search for a command, and what is about marotte. All
 * list actions of app/action.h. Guides are shown in the browser. [main] */
#ifndef MAROTTE_UI_WINDOW_MENUS_H
#define MAROTTE_UI_WINDOW_MENUS_H
#include "window/dialogs.h"

#include <sys/types.h>

typedef struct menus {
    app *app;
    ui *ui;
    dialogs *dialogs;
    char sought[80];  /* typed into the search */
    uint32_t at;      /* row of the search that Enter runs */
    pid_t browser;    /* started for the guides; 0: none */
    char guides[600]; /* their address */
} menus;

/* dialogs: opens recent files. */
void menus_init(menus *out, app *of, ui *on, dialogs *with);
/* Each frame, over all panels. x, y: where the menu opens. */
void menus_draw(menus *self, float x, float y);

#endif
