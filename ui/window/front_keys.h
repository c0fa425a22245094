/* window/front_keys.h - GLFW's keys as ui.h's: by what is written on them, not by where they lie,
 * as far as that can be said in ASCII. [main] */
#ifndef MAROTTE_UI_WINDOW_FRONT_KEYS_H
#define MAROTTE_UI_WINDOW_FRONT_KEYS_H
#include <stdint.h>

uint32_t front_key_of(int key, int scancode); /* UI_KEY_NONE: none of ours */

#endif
