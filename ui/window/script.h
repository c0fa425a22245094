/* window/script.h - scripts of user input: a text file with one command in each line, performed
 * frame by frame; or random clicks, drags, keys and words from a seed, which never quit the program
 * or save a rig. A script runs with and without a window. script_help() lists the commands. [main]
 */
#ifndef MAROTTE_UI_WINDOW_SCRIPT_H
#define MAROTTE_UI_WINDOW_SCRIPT_H
#include "window/app/app.h"
#include "window/gui/ui.h"
#include "window/gui/window.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct script_random {
    uint64_t state;
    float x, y, to_x, to_y; /* of a drag */
    uint32_t steps, button;
    uint32_t asked_count; /* steps with a question over everything */
} script_random;

void script_random_begin(script_random *self, uint64_t seed);
/* Once a frame, when the ui has handed everything over. */
void script_random_step(script_random *self, ui *on, float width, float height);
/* Lets go of what it holds. */
void script_random_end(script_random *self, ui *on);

typedef struct script script;

/* Errors name the file, the line and what was expected. */
CHECKED mrt_result script_read(script **out, const char *path, error *err);
void script_destroy(script *self); /* NULL is fine */

typedef struct script_stage { /* what it acts on */
    ui *ui;
    app *app;
    window *window;
    ui_screen screen;
} script_stage;
/* Once before each frame. MRT_OK: it goes on; MRT_END: all was done; < 0: what could not be. */
CHECKED mrt_result script_step(script *self, const script_stage *on, error *err);

const char *script_help(void); /* lines ended by \n */

#endif
