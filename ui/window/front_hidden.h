/* window/front_hidden.h - what a test and a script can do to a stage with no window. [main] */
#ifndef MAROTTE_UI_WINDOW_FRONT_HIDDEN_H
#define MAROTTE_UI_WINDOW_FRONT_HIDDEN_H
#include "window/front.h"

/* What the gamepad says from now on; NULL: there is none. */
void front_hidden_gamepad(front *self, const front_gamepad *now);
CHECKED mrt_result front_hidden_output_picture(front *self, const char *png_path, error *err);

#endif
