/* window/studio_inputs.h - opens inputs beside the window, one after the other: a glove takes a
 * second to answer. Leaves out what becomes of them. [main]; its thread is its own. */
#ifndef MAROTTE_UI_WINDOW_STUDIO_INPUTS_H
#define MAROTTE_UI_WINDOW_STUDIO_INPUTS_H
#include "stage/input.h"
#include "stage/plugins.h"

enum { STUDIO_INPUTS_MAX = 8, STUDIO_INPUT_TEXT = 512 };

typedef struct studio_inputs studio_inputs;

/* texts: copied. Without any that can be opened and looks_further: every device that is ready. */
studio_inputs *studio_inputs_start(plugin_list *plugins, log_queue *log, const char *const *texts,
                                   uint32_t count, bool looks_further); /* NULL: it cannot be */
/* Waits for what is being opened; what was not taken is closed. NULL is fine. */
void studio_inputs_destroy(studio_inputs *self);

typedef struct studio_input_opened {
    input *input; /* NULL: it could not be opened, and err says why; the taker's */
    char text[STUDIO_INPUT_TEXT];
    error err;
} studio_input_opened;
/* False: none now. */
bool studio_inputs_take(studio_inputs *self, studio_input_opened *out);
bool studio_inputs_are_done(studio_inputs *self); /* and all were taken */

#endif
