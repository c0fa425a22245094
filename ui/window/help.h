/* window/help.h - `?`: every action with its key, what the mouse and the pedals do, over the stage;
 * and what suits the person: another key (a click on a line, then the key), text size, light or
 * dark, colours that are told apart without red and green. [main] */
#ifndef MAROTTE_UI_WINDOW_HELP_H
#define MAROTTE_UI_WINDOW_HELP_H
#include "window/gui/ui.h"
#include "window/app/app.h"

typedef struct help {
    action waiting;    /* for its new key; ACTION_NONE: none does */
    key_chord offered; /* another action has it: once more takes it away from that one */
    char says[160];
} help;

/* True: it has taken the keys of this frame. */
bool help_takes_keys(help *self, app *of, ui *on);
/* zoom: how much larger than usual everything is drawn in truth. */
void help_draw(help *self, app *of, ui *on, ui_rectangle where, float zoom);

#endif
