/* window/script.h - a person at the window, written down: a text file of events, one command a
 * line, given to the window frame by frame. The same file works in a window and without one.
 * script_help() lists the commands. Leaves out opening either. [main] */
#ifndef MAROTTE_UI_WINDOW_SCRIPT_H
#define MAROTTE_UI_WINDOW_SCRIPT_H
#include "window/front.h"
#include "window/studio.h"

typedef struct script script;

/* Errors name the file, the line and what was expected. */
CHECKED mrt_result script_read(script **out, const char *path, error *err);
void script_destroy(script *self); /* NULL is fine */

typedef struct script_stage { /* what it acts on */
    ui *ui;
    studio *studio;
    front *front;
    ui_screen screen;
} script_stage;
/* Once before each frame. MRT_OK: it goes on; MRT_END: all was done; < 0: what could not be. */
CHECKED mrt_result script_step(script *self, const script_stage *on, error *err);

const char *script_help(void); /* lines ended by \n */

#endif
