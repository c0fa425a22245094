/* window/gui/hand_figure.h - a hand in a pose, drawn with the ui's own strokes: the skeleton of
 * core/hand as a person sees the back of the own hand, turning a little to and fro so that its
 * depth is seen. Leaves out which pose (hand/guide.h). [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_HAND_FIGURE_H
#define MAROTTE_UI_WINDOW_GUI_HAND_FIGURE_H
#include "hand/hand.h"
#include "window/gui/ui.h"

/* angle_rad: MRT_ANGLES; at_s: when, for the turning. On the canvas that is open. */
void hand_figure_draw(ui *on, ui_rectangle where, const hand_skeleton *of, const float *angle_rad,
                      double at_s, uint32_t colour);

#endif
