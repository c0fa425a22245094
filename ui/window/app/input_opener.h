/* window/app/input_opener.h - opens inputs beside the window, which goes on: a glove takes a second
 * to answer, a device that hangs takes as long as it likes. Leaves out what becomes of them.
 * [main]; its threads are its own. */
#ifndef MAROTTE_UI_WINDOW_APP_INPUT_OPENER_H
#define MAROTTE_UI_WINDOW_APP_INPUT_OPENER_H
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

enum { INPUT_OPENER_MAX = 8, INPUT_OPENINGS_MAX = 8, INPUT_OPENER_TEXT = 512 };

typedef struct input_opener input_opener;

input_opener *input_opener_create(const plugin_list *plugins, log_queue *log); /* NULL: no memory */
/* Gives up what is being opened, and waits until it is; what was not taken is closed. NULL is fine.
 */
void input_opener_destroy(input_opener *self);

/* Begins to open these, one after the other: at most INPUT_OPENER_MAX; texts: copied. When none
 * could be opened and looks_further: every device that is ready. */
CHECKED mrt_result input_opener_open(input_opener *self, const char *const *texts, uint32_t count,
                                     bool looks_further, error *err);

typedef struct input_opened {
    input *input; /* NULL: it could not be opened, and err says why; the taker's */
    char text[INPUT_OPENER_TEXT];
    error err;
} input_opened;
/* False: none now. What was given up does not come. */
bool input_opener_take(input_opener *self, input_opened *out);
bool input_opener_are_done(input_opener *self); /* nothing is being opened, and all were taken */

typedef struct input_opening {
    uint64_t id;
    char text[INPUT_OPENER_TEXT], name[INPUT_NAME];
    bool is_open; /* only to be taken yet */
} input_opening;
/* What is on its way; those of one input_opener_open that wait for their turn are left out. */
uint32_t input_opener_going(input_opener *self, input_opening out[INPUT_OPENINGS_MAX]);
/* It does not come; at once, also when the device hangs. One that is none any more is fine. */
void input_opener_give_up(input_opener *self, uint64_t id);

#endif
