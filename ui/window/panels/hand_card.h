/* window/panels/hand_card.h - the card of a mapping, drawn: a hand, and beside it, with a thin
 * leader to its joint, each line of what the hand does and what the face does. Lines that are lit
 * have the accent's colour. Where there is no room for the hand it is a list with lights. Leaves
 * out which lines are lit (hand_lights.h). [main] */
#ifndef MAROTTE_UI_WINDOW_PANELS_HAND_CARD_H
#define MAROTTE_UI_WINDOW_PANELS_HAND_CARD_H
#include "hand/hand.h"
#include "window/gui/ui.h"

typedef struct hand_card {
    const mrt_card_line *line;
    uint32_t count;     /* at most HAND_LIGHTS_MAX are drawn */
    const float *level; /* count: 0 dark .. 1 lit */
    const hand_skeleton *skeleton;
    const float *rest_rad;  /* MRT_ANGLES: orders the lines, so that they keep their places while
                               the hand moves */
    const float *angle_rad; /* MRT_ANGLES: the hand as it is now */
    uint32_t colour;        /* of the hand */
    bool is_dense;          /* one row where what the hand and the face do fit in it */
} hand_card;

/* How high the drawn card is at that width; 0: no room for the hand beside the lines. */
float hand_card_height(const ui *on, const hand_card *card, float width);
/* How many pairs of leaders cross there. None of a hand that is as `rest_rad`. */
uint32_t hand_card_crossings(const ui *on, ui_rectangle where, const hand_card *card);
/* On the panel or canvas that is open. */
void hand_card_draw(ui *on, ui_rectangle where, const hand_card *card);
/* Rows that flow downwards in the panel. */
void hand_card_list(ui *on, const hand_card *card);

#endif
