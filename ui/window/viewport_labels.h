/* window/viewport_labels.h - names beside dots: where each has room, and which are left out because
 * they have none. Lengths in points. Pure; any thread. */
#ifndef MAROTTE_UI_WINDOW_VIEWPORT_LABELS_H
#define MAROTTE_UI_WINDOW_VIEWPORT_LABELS_H
#include "window/ui.h"

enum { VIEWPORT_LABELS_MAX = 256 };
typedef struct viewport_label {
    float x, y;          /* of the dot */
    float width, height; /* of the name */
    float at_x, at_y;    /* out: the top left of the name */
    bool is_placed;      /* out */
} viewport_label;

/* The first come first: none covers another's name or dot, or leaves the rectangle. dot: radius of
 * each dot. */
void viewport_labels_place(viewport_label *label, uint32_t count, ui_rectangle within, float dot);

#endif
