/* window/virtual_hand.h - a hand for whom no glove is at hand: the keyboard (while
 * studio_has_hand_keys) or a gamepad moves it, and it performs and is recorded as any other input.
 * It joins the stage when it is first used. Leaves out how it moves (virtual_hand_motion.h). [main]
 */
#ifndef MAROTTE_UI_WINDOW_VIRTUAL_HAND_H
#define MAROTTE_UI_WINDOW_VIRTUAL_HAND_H
#include "window/front.h"
#include "window/studio.h"

typedef struct virtual_hand virtual_hand;

/* The window's setting "virtual_hand.side" says which hand it is: 0 left, 1 right (the usual one);
 * Shift+Y changes it. */
virtual_hand *virtual_hand_create(studio *of); /* NULL: no memory */
/* Takes it off the stage: a take that is being recorded ends and is kept. NULL is fine. */
void virtual_hand_destroy(virtual_hand *self);
/* Each frame. pad NULL: there is none. */
void virtual_hand_update(virtual_hand *self, const ui *keys, const front_gamepad *pad, double dt_s);

bool virtual_hand_has_keys(const virtual_hand *self); /* show which key does what */
uint32_t virtual_hand_side(const virtual_hand *self); /* MRT_LEFT, MRT_RIGHT */
/* How far down each finger is wished now, for the legend: -1 .. 1. */
const float *virtual_hand_fingers(const virtual_hand *self);

#endif
