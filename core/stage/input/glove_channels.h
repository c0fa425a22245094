/* stage/input/glove_channels.h - which channels of an input are the raw sensors of one hand: what a
 * calibration is made from. Pure. */
#ifndef MAROTTE_STAGE_GLOVE_CHANNELS_H
#define MAROTTE_STAGE_GLOVE_CHANNELS_H
#include "base/error.h"

typedef struct glove_channels {
    uint32_t side, sensors;     /* bit i: the glove has sensor i */
    int channel_of[MRT_ANGLES]; /* -1: none */
    float low, high;            /* of the raw values: the widest range of a channel */
} glove_channels;

/* side: MRT_NO_HAND: whichever hand it is. `name` begins the error's text. */
CHECKED mrt_result glove_channels_find(glove_channels *out, const mrt_channel *channel,
                                       uint32_t count, uint32_t side, const char *name, error *err);
/* Whether this hand of the input is measured in counts: can be calibrated. */
bool glove_channels_has(const mrt_channel *channel, uint32_t count, uint32_t side);
/* Takes what the sample says of the hand's sensors over; the others stay. raw: MRT_ANGLES. */
void glove_channels_read(const glove_channels *self, const mrt_sample *sample, float *raw);

#endif
