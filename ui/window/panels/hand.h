/* window/panels/hand.h - what the panel Hand shows on the stage too: the card of the mapping over
 * the face. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_H
#include "window/panels/panels.h"

/* The card at the left of the face, where app_looks.shows_card and a mapping has one. */
void hand_panel_draw_card(panel *self, ui *on, ui_rectangle over);

#endif
