/* window/panels/hand.h - what the panel Hand shows on the stage too: the card of the mapping
 * beside the face. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_H
#include "window/panels/panels.h"

/* How much of the stage's width, from the left, the card takes while app_looks.shows_card; 0: none,
 * the mapping has no card, or there is no room. */
float hand_panel_card_width(panel *self, const ui *on, ui_rectangle stage);
void hand_panel_draw_card(panel *self, ui *on, ui_rectangle where);

#endif
