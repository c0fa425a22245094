/* window/timeline/record_menu.h - the context menu of recording: count-in, pre-roll, the click and
 * its tempo, external timecode. It is drawn in the current panel. [main] */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_RECORD_MENU_H
#define MAROTTE_UI_WINDOW_TIMELINE_RECORD_MENU_H
#include "window/app/app.h"
#include "window/gui/ui.h"

/* Opens it at a place on the screen; in the same panel as record_menu_draw. */
void record_menu_open(ui *on, float x, float y);
void record_menu_draw(app *of, ui *on);
/* Draws the tempo dialog over all panels. */
void record_menu_tempo(app *of, ui *on);

#endif
