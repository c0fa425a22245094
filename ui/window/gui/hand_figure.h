/* window/gui/hand_figure.h - draws a hand in a pose: the skeleton of core/hand seen from the back
 * of the hand, slowly turning to show its depth; and a hand as a camera sees it. Leaves out which
 * pose (hand/guide.h). [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_HAND_FIGURE_H
#define MAROTTE_UI_WINDOW_GUI_HAND_FIGURE_H
#include "hand/hand.h"
#include "window/gui/ui.h"

/* angle_rad: MRT_ANGLES; at_s: when, for the turning. On the canvas that is open. */
void hand_figure_draw(ui *on, ui_rectangle where, const hand_skeleton *of, const float *angle_rad,
                      double at_s, uint32_t colour);
/* The same without turning, as large as fits; and where its joints are then, on the screen. */
void hand_figure_draw_still(ui *on, ui_rectangle where, const hand_skeleton *of,
                            const float *angle_rad, uint32_t colour);
void hand_figure_joints(ui_rectangle where, const hand_skeleton *of, const float *angle_rad,
                        float out_xy[MRT_JOINTS][2]);
/* Draws landmarks of a hand (mrt_landmarks, y up, z towards the eye) as in a mirror, in their own
 * proportion and direction, as large as fits however the hand turns. */
void hand_figure_draw_seen(ui *on, ui_rectangle where, const mrt_vec3 at[MRT_JOINTS],
                           uint32_t colour);

#endif
