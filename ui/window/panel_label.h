/* window/panel_label.h - a text that stands in a line with widgets: in the middle of its height, as
 * wide as it is told, cut where it does not fit. [main] */
#ifndef MAROTTE_UI_WINDOW_PANEL_LABEL_H
#define MAROTTE_UI_WINDOW_PANEL_LABEL_H
#include "window/ui.h"

/* The next thing comes behind it, on the same line. id: its own in the panel. */
void panel_label(ui *on, const char *id, float width, uint32_t colour, const char *text);

#endif
