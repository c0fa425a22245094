/* window/gui/window.h - a real window (GLFW) with events, gamepad and second monitor, or a hidden
 * one with a framebuffer, scripted events and pictures. Both draw the same. Leaves out what is
 * drawn (workspace.h). [main] */
#ifndef MAROTTE_UI_WINDOW_GUI_WINDOW_H
#define MAROTTE_UI_WINDOW_GUI_WINDOW_H
#include "window/gui/pace.h"
#include "window/gui/ui.h"

typedef struct window window;

CHECKED mrt_result window_open_window(window **out, uint32_t width, uint32_t height,
                                      const char *title, error *err);
/* dt_s: time step of each frame; 0: real time. scale: pixels in a point. */
CHECKED mrt_result window_open_hidden(window **out, uint32_t width, uint32_t height, float scale,
                                      double dt_s, error *err);
void window_close(window *self); /* NULL is fine */
/* Zoom on top of the scale of the screen, 0.5 to 3. Limited so that the window keeps at least 800 x
 * 500 points. */
void window_set_zoom(window *self, float zoom);
/* Pixels a point without it. */
float window_scale(const window *self);
bool window_is_maximised(const window *self);
void window_maximise(window *self);

/* Waits until a frame is due (pace.h), but where each frame takes dt_s. Hands events over to the
 * ui; false: the person wants to close the window. */
bool window_begin(window *self, ui *to, ui_screen *out_screen);
/* Shows what was drawn, if anything of it is new. */
void window_end(window *self, ui *from);
/* RGBA, rows from the top, of what was shown last; to be freed. */
CHECKED mrt_result window_picture(window *self, const char *png_path, error *err);
/* The next file or folder that was dropped on it; until the next call. NULL: none. */
const char *window_take_drop(window *self);
/* One is dropped, by the desktop or a test. A few wait; those beyond are forgotten. */
void window_drop(window *self, const char *path);
void window_set_title(window *self, const char *title);
/* Requests a frame in at most that time; 0: the next frame. The request holds for one frame. */
void window_want_frame(window *self, double in_s);
const pace *window_pace(const window *self);
wake *window_signal(window *self); /* [any] signal it when a new frame must be drawn */
/* Whether frames come at their full rate while it is put away: somebody afar waits for them. */
void window_stay_awake(window *self, bool is_awaited);
uint32_t window_width_px(const window *self);
uint32_t window_height_px(const window *self);

/* Gamepad axes -1..1 (left x y, right x y, left trigger, right trigger) and buttons; false: none.
 */
typedef struct window_gamepad {
    float axis[6];
    bool button[16];
    char name[64];
} window_gamepad;
bool window_read_gamepad(window *self, window_gamepad *out);

/* The face alone, borderless and without the pointer, full screen on the second monitor (or in a
 * window), at the refresh rate of that monitor. `texture` has straight alpha and fills it. */
typedef struct window_output_look {
    bool is_clear; /* the background is transparent: premultiplied alpha */
    bool is_on_top, is_window;
} window_output_look;
CHECKED mrt_result window_open_output(window *self, const window_output_look *look, error *err);
void window_close_output(window *self);
bool window_has_output(const window *self);
void window_output_size(const window *self, uint32_t *out_width, uint32_t *out_height);
/* is_new: it differs from what is shown there; else it may be shown again all the same. */
void window_show_output(window *self, uint32_t texture, bool is_mirrored, bool is_new);

/* ---- without a window: what a script and a test do to it ---- */

/* Frames are not drawn while it is away, as those of a window that is put away. */
void window_hidden_put_away(window *self, bool is_away);
/* The last frame is drawn again, all of it: nothing changes, if no part of it was stale. */
void window_hidden_draw_again(window *self, ui *from);
/* Sets the state of the gamepad; NULL: none. */
void window_hidden_gamepad(window *self, const window_gamepad *now);
CHECKED mrt_result window_hidden_output_picture(window *self, const char *png_path, error *err);

#endif
