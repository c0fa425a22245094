/* window/app/input_opener.h - opens inputs on threads, so that the window keeps running: a glove
 * needs a second to answer, and a device may hang. Leaves out the use of opened inputs. [main]; it
 * owns its threads. */
#ifndef MAROTTE_UI_WINDOW_APP_INPUT_OPENER_H
#define MAROTTE_UI_WINDOW_APP_INPUT_OPENER_H
#include "stage/input/input.h"
#include "stage/mapping/plugins.h"

enum { INPUT_OPENER_MAX = 8, INPUT_OPENINGS_MAX = 8, INPUT_OPENER_TEXT = 512 };

typedef struct input_opener input_opener;

input_opener *input_opener_create(const plugin_list *plugins, log_queue *log); /* NULL: no memory */
/* Cancels pending inputs, waits for them, and closes opened ones that nobody has popped. Accepts
 * NULL. */
void input_opener_destroy(input_opener *self);

/* Begins to open these, one after the other: at most INPUT_OPENER_MAX; texts: copied. When none
 * could be opened and looks_further: every device that is ready. */
CHECKED mrt_result input_opener_open(input_opener *self, const char *const *texts, uint32_t count,
                                     bool looks_further, error *err);

typedef struct input_opened {
    input *input; /* NULL: opening failed, see err; owned by the caller */
    char text[INPUT_OPENER_TEXT];
    error err;
} input_opened;
/* Pops an opened input; false: none. Cancelled ones are not returned. */
bool input_opener_take(input_opener *self, input_opened *out);
bool input_opener_are_done(input_opener *self); /* no pending and no unpopped inputs */

typedef struct input_opening {
    uint64_t id;
    char text[INPUT_OPENER_TEXT], name[INPUT_NAME];
    bool is_open; /* only to be taken yet */
} input_opening;
/* What is on its way; those of one input_opener_open that wait for their turn are left out. */
uint32_t input_opener_going(input_opener *self, input_opening out[INPUT_OPENINGS_MAX]);
/* Cancels an input immediately, even if the device hangs. Accepts an unknown id. */
void input_opener_give_up(input_opener *self, uint64_t id);

#endif
