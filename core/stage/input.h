/* stage/input.h - an input plugin as a source of samples in time order: read by a thread of its own
 * through a ring (live), or called directly on a virtual clock (as fast as possible). [main] unless
 * marked. */
#ifndef MAROTTE_STAGE_INPUT_H
#define MAROTTE_STAGE_INPUT_H
#include "stage/instance.h"

typedef struct input input;

typedef enum input_state {
    INPUT_RUNNING = 0,
    INPUT_ENDED, /* the take is over */
    INPUT_FAILED /* the device went away */
} input_state;

/* Opens the address with the parameters "key=value,..."; the log must outlive it. */
CHECKED mrt_result input_create(input **out, const mrt_plugin_type *type, const char *address,
                                const char *params, instance_clock clock, log_queue *log,
                                error *err);
void input_destroy(input *self); /* stops its thread first; NULL is fine */

const char *input_name(const input *self); /* "log demo_hand.csv"; until destroy */
const mrt_channel *input_channels(const input *self, uint32_t *out_count);

/* CLOCK_REAL: starts the thread. CLOCK_VIRTUAL: nothing to do. */
CHECKED mrt_result input_start(input *self, error *err);
void input_stop(input *self);

/* [frame] The oldest sample that has not been taken; false: none now. On a virtual clock this
 * reads the plugin, and false means that the input is over. */
bool input_peek(input *self, mrt_sample *out_sample);
void input_take(input *self); /* [frame] drops what input_peek gave */
/* [any] When not running and input_peek gives nothing, the input is over. */
input_state input_state_of(const input *self);
uint32_t input_dropped(const input *self); /* [any] samples lost in the ring */
uint32_t input_refused(const input *self); /* [any] samples that were not finite or misshapen */

#endif
