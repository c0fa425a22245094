/* window/studio_inputs.h - opens inputs beside the window, which goes on: a glove takes a second to
 * answer, a device that hangs takes as long as it likes. Leaves out what becomes of them. [main];
 * its threads are its own. */
#ifndef MAROTTE_UI_WINDOW_STUDIO_INPUTS_H
#define MAROTTE_UI_WINDOW_STUDIO_INPUTS_H
#include "stage/input.h"
#include "stage/mapping/plugins.h"

enum { STUDIO_INPUTS_MAX = 8, STUDIO_OPENINGS_MAX = 8, STUDIO_INPUT_TEXT = 512 };

typedef struct studio_inputs studio_inputs;

studio_inputs *studio_inputs_create(const plugin_list *plugins,
                                    log_queue *log); /* NULL: no memory */
/* Gives up what is being opened, and waits until it is; what was not taken is closed. NULL is fine.
 */
void studio_inputs_destroy(studio_inputs *self);

/* Begins to open these, one after the other: at most STUDIO_INPUTS_MAX; texts: copied. When none
 * could be opened and looks_further: every device that is ready. */
CHECKED mrt_result studio_inputs_open(studio_inputs *self, const char *const *texts, uint32_t count,
                                      bool looks_further, error *err);

typedef struct studio_input_opened {
    input *input; /* NULL: it could not be opened, and err says why; the taker's */
    char text[STUDIO_INPUT_TEXT];
    error err;
} studio_input_opened;
/* False: none now. What was given up does not come. */
bool studio_inputs_take(studio_inputs *self, studio_input_opened *out);
bool studio_inputs_are_done(studio_inputs *self); /* nothing is being opened, and all were taken */

typedef struct studio_opening {
    uint64_t id;
    char text[STUDIO_INPUT_TEXT], name[INPUT_NAME];
    bool is_open; /* only to be taken yet */
} studio_opening;
/* What is on its way; those of one studio_inputs_open that wait for their turn are left out. */
uint32_t studio_inputs_going(studio_inputs *self, studio_opening out[STUDIO_OPENINGS_MAX]);
/* It does not come; at once, also when the device hangs. One that is none any more is fine. */
void studio_inputs_give_up(studio_inputs *self, uint64_t id);

#endif
