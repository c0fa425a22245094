/* window/gui/window_icon.h - reads the icon that is installed with the program, for the window's
 * bar and the list of windows. Leaves out other pictures: those are decoded in a child
 * (core/io/decode/image.c). [main] */
#ifndef MAROTTE_UI_WINDOW_ICON_H
#define MAROTTE_UI_WINDOW_ICON_H
#include <stdint.h>

enum { WINDOW_ICONS = 4 };

typedef struct window_icon {
    uint32_t size_px; /* of each side */
    uint8_t
        *rgba; /* size_px by size_px, from the top left, not premultiplied; the owner frees it */
} window_icon;

/* Reads the installed sizes. Returns their number, 0 if there are none. */
uint32_t window_icons_read(window_icon out[WINDOW_ICONS]);
void window_icons_finish(window_icon *icon, uint32_t count);

#endif
