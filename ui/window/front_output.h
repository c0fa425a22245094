/* window/front_output.h - the face alone in a second window, drawn by a thread of its own at its
 * own refresh: whoever gives a picture does not wait for that monitor. [main] unless marked */
#ifndef MAROTTE_UI_WINDOW_FRONT_OUTPUT_H
#define MAROTTE_UI_WINDOW_FRONT_OUTPUT_H
#include "base/error.h"

struct GLFWwindow;
typedef struct front_output front_output;

/* Full screen on a monitor that `main` is not on; a borderless window that can be moved where there
 * is none. The context of `main` is current, and shared. */
CHECKED mrt_result front_output_create(front_output **out, struct GLFWwindow *main_window,
                                       error *err);
void front_output_destroy(front_output *self); /* NULL is fine */
struct GLFWwindow *front_output_window(const front_output *self);
/* The person wants it to be closed, or it could not be drawn. */
bool front_output_is_over(front_output *self);
void front_output_measure(front_output *self, uint32_t *out_width, uint32_t *out_height);
/* The texture is copied, with the commands that are already on their way. */
void front_output_give(front_output *self, uint32_t texture, uint32_t width, uint32_t height,
                       bool is_mirrored);

#endif
