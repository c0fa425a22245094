/* window/panels/hand.h - the hand card of the mapping beside the face, as the panel Hand draws it
 * on the stage. [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_H
#include "window/panels/panels.h"

/* Returns the width of the card at the left of the stage while app_looks.shows_card is set. Returns
 * 0 if the mapping has no card or the stage is too narrow. */
float hand_panel_card_width(panel *self, const ui *on, ui_rectangle stage);
void hand_panel_draw_card(panel *self, ui *on, ui_rectangle where);

#endif
