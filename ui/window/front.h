/* window/front.h - the two ways in which the stage is seen: a real window (GLFW) with its events,
 * gamepad and second monitor, or no window at all: a framebuffer, scripted events, pictures. What
 * is drawn is the same. Leaves out what is drawn (desk.h). [main] */
#ifndef MAROTTE_UI_WINDOW_FRONT_H
#define MAROTTE_UI_WINDOW_FRONT_H
#include "window/ui.h"

typedef struct front front;

CHECKED mrt_result front_open_window(front **out, uint32_t width, uint32_t height,
                                     const char *title, error *err);
/* Time goes on by dt_s with each frame; 0: as the clock goes. scale: pixels a point. */
CHECKED mrt_result front_open_hidden(front **out, uint32_t width, uint32_t height, float scale,
                                     double dt_s, error *err);
void front_close(front *self); /* NULL is fine */

/* Hands events over to the ui; false: the person wants to close the window. */
bool front_begin(front *self, ui *to, ui_screen *out_screen);
/* Shows what was drawn. */
void front_end(front *self, ui *from);
/* RGBA, rows from the top, of what was shown last; to be freed. */
CHECKED mrt_result front_picture(front *self, const char *png_path, error *err);
void front_set_title(front *self, const char *title);
uint32_t front_width_px(const front *self);
uint32_t front_height_px(const front *self);

/* Gamepad axes -1..1 (left x y, right x y, left trigger, right trigger) and buttons; false: none.
 */
typedef struct front_gamepad {
    float axis[6];
    bool button[16];
    char name[64];
} front_gamepad;
bool front_read_gamepad(front *self, front_gamepad *out);

/* The face alone, borderless, full screen on the second monitor (or a window where there is one
 * monitor), at its own refresh: `texture` is drawn to fill it. */
CHECKED mrt_result front_open_output(front *self, error *err);
void front_close_output(front *self);
bool front_has_output(const front *self);
void front_output_size(const front *self, uint32_t *out_width, uint32_t *out_height);
void front_show_output(front *self, uint32_t texture, bool is_mirrored);

#endif
