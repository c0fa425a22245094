/* stage/perform/frame_inputs.h - all channels of all inputs, raw, as a mrt_frame shows them to a
 * mapping: what each input's newest sample said. Leaves out what hands and pedals make of them
 * (hands.h). A function of the samples alone. [frame]; no allocation. */
#ifndef MAROTTE_STAGE_FRAME_INPUTS_H
#define MAROTTE_STAGE_FRAME_INPUTS_H
#include "stage/perform/hands.h"

/* It must not move. */
typedef struct frame_inputs {
    uint32_t count;
    mrt_channels shown[MRT_MAX_INPUTS]; /* into the arrays below */
    char name[MRT_MAX_INPUTS][ROUTE_NAME];
    channel_table table[MRT_MAX_INPUTS];
    float value[MRT_MAX_INPUTS][MRT_MAX_CHANNELS];
} frame_inputs;

void frame_inputs_reset(frame_inputs *self);
/* Every step, in time order. An input is known again by its name, one without a name by its
 * channels. One more than fit takes the place of that which has been silent for longest. The
 * pointer is none. */
void frame_inputs_read(frame_inputs *self, const sample_step *s, int64_t time_ns);

/* As hands_save, hands_load and hands_shift_time. */
size_t frame_inputs_save(const frame_inputs *self, void *bytes, size_t capacity);
bool frame_inputs_load(frame_inputs *self, const void *bytes, size_t size);
void frame_inputs_shift_time(frame_inputs *self, int64_t by_ns);

#endif
