/* window/script_random.h - somebody who does not know the program: clicks, drags, keys, words, in
 * an order that a seed decides. Never ends the program, and never saves a rig. [main] */
#ifndef MAROTTE_UI_WINDOW_SCRIPT_RANDOM_H
#define MAROTTE_UI_WINDOW_SCRIPT_RANDOM_H
#include "window/ui.h"

typedef struct script_random {
    uint64_t state;
    float x, y, to_x, to_y; /* of a drag */
    uint32_t steps, button;
    uint32_t asked_count; /* steps with a question over everything */
} script_random;

void script_random_begin(script_random *self, uint64_t seed);
/* Once a frame, when the ui has handed everything over. */
void script_random_step(script_random *self, ui *on, float width, float height);
/* Lets go of what it holds. */
void script_random_end(script_random *self, ui *on);

#endif
