/* window/panels/hand_card.h - draws the hand card of a mapping: a hand with one line for each
 * movement. A line names the movement of the hand and of the face, and a leader connects it with
 * its joint. Lit lines have the accent colour. If the hand does not fit, the card is a list with
 * lights. Leaves out which lines are lit (hand_lights.h). [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_CARD_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_CARD_H
#include "hand/hand.h"
#include "window/gui/ui.h"

typedef struct hand_card {
    const mrt_card_line *line;
    uint32_t count;     /* at most HAND_LIGHTS_MAX are drawn */
    const float *level; /* count: 0 dark .. 1 lit */
    const hand_skeleton *skeleton;
    const float *rest_rad;  /* MRT_ANGLES; fixed hand that determines the order of the lines */
    const float *angle_rad; /* MRT_ANGLES; current hand */
    uint32_t colour;        /* of the hand */
    bool is_dense;          /* put both texts in one row if they fit */
} hand_card;

/* Returns the height of the card at this width, or 0 if the hand does not fit beside the lines. */
float hand_card_height(const ui *on, const hand_card *card, float width);
/* Returns the number of crossing pairs of leaders. It is 0 if the hand is at `rest_rad`. */
uint32_t hand_card_crossings(const ui *on, ui_rectangle where, const hand_card *card);
/* Draws the card on the open panel or canvas. */
void hand_card_draw(ui *on, ui_rectangle where, const hand_card *card);
/* Draws the card as a list of rows. */
void hand_card_list(ui *on, const hand_card *card);

#endif
