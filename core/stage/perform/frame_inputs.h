/* stage/perform/frame_inputs.h - the raw channels of all inputs, as a mapping sees them in
 * mrt_frame: the values of the newest sample of each input. Does not cover hands and pedals
 * (hands.h). A function of the samples alone. [frame]; no allocation. */
#ifndef MAROTTE_STAGE_FRAME_INPUTS_H
#define MAROTTE_STAGE_FRAME_INPUTS_H
#include "stage/perform/hands.h"

/* Must not move in memory: `shown` points into its arrays. */
typedef struct frame_inputs {
    uint32_t count;
    mrt_channels shown[MRT_MAX_INPUTS]; /* pointers into the arrays below */
    char name[MRT_MAX_INPUTS][ROUTE_NAME];
    channel_table table[MRT_MAX_INPUTS];
    float value[MRT_MAX_INPUTS][MRT_MAX_CHANNELS];
} frame_inputs;

void frame_inputs_reset(frame_inputs *self);
/* Call for every step, in time order. An input is recognised by its name, or by its channels if it
 * has no name. Beyond MRT_MAX_INPUTS a new input replaces the input that has been silent
 * longest. The pointer does not count as an input. */
void frame_inputs_read(frame_inputs *self, const sample_step *s, int64_t time_ns);

/* Same contracts as hands_save, hands_load and hands_shift_time. */
size_t frame_inputs_save(const frame_inputs *self, void *bytes, size_t capacity);
bool frame_inputs_load(frame_inputs *self, const void *bytes, size_t size);
void frame_inputs_shift_time(frame_inputs *self, int64_t by_ns);

#endif
