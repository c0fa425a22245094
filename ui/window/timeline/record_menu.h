/* window/timeline/record_menu.h - what comes before a recording, and what is heard meanwhile:
 * count-in, pre-roll, the click and its tempo, time code from outside. The menu of a right click,
 * of whichever panel it is drawn in. [main] */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_RECORD_MENU_H
#define MAROTTE_UI_WINDOW_TIMELINE_RECORD_MENU_H
#include "window/app/app.h"
#include "window/gui/ui.h"

void record_menu_draw(app *of, ui *on);
/* The question that it asks, over everything else. */
void record_menu_tempo(app *of, ui *on);

#endif
