/* window/help.h - the help behind `?`: all actions with their keys, mouse and pedals; and settings
 * of keys (click a line, then press the key), text size, light theme and colours for colour-blind
 * users. [main] */
#ifndef MAROTTE_UI_WINDOW_HELP_H
#define MAROTTE_UI_WINDOW_HELP_H
#include "window/gui/ui.h"
#include "window/app/app.h"

typedef struct help {
    action waiting;    /* the action that waits for its new key; ACTION_NONE: none */
    key_chord offered; /* another action has this key; pressing it again reassigns it */
    char says[160];
} help;

/* True: it has taken the keys of this frame. */
bool help_takes_keys(help *self, app *of, ui *on);
/* zoom: how much larger than usual everything is drawn in truth. */
void help_draw(help *self, app *of, ui *on, ui_rectangle where, float zoom);

#endif
