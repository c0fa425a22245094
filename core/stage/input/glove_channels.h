/* stage/input/glove_channels.h - which channels of an input are the raw sensors of one hand, a
 * glove's counts or the angles of a bare hand: what a calibration is made from. Pure. */
#ifndef MAROTTE_STAGE_GLOVE_CHANNELS_H
#define MAROTTE_STAGE_GLOVE_CHANNELS_H
#include "base/error.h"
#include "hand/hand.h"

typedef struct glove_channels {
    uint32_t side, sensors;     /* bit i: the glove has sensor i */
    char input[HAND_INPUT];     /* of a bare hand: as in hand_calibration; "": a glove */
    int channel_of[MRT_ANGLES]; /* -1: none */
    float low, high;            /* of the raw values: the widest range of a channel */
} glove_channels;

/* side: MRT_NO_HAND: whichever hand it is. name: the input's. */
CHECKED mrt_result glove_channels_find(glove_channels *out, const mrt_channel *channel,
                                       uint32_t count, uint32_t side, const char *name, error *err);
typedef enum glove_channels_kind {
    GLOVE_CHANNELS_NONE = 0, /* this hand is not measured */
    GLOVE_CHANNELS_COUNT,    /* by a glove, that needs a calibration */
    GLOVE_CHANNELS_RAD       /* as angles already: a bare hand, which one makes better */
} glove_channels_kind;
glove_channels_kind glove_channels_of(const mrt_channel *channel, uint32_t count, uint32_t side);
/* The kind of input, as in hand_calibration. */
void glove_channels_input(char out[HAND_INPUT], const char *name);
/* Takes what the sample says of the hand's sensors over; the others stay. raw: MRT_ANGLES. */
void glove_channels_read(const glove_channels *self, const mrt_sample *sample, float *raw);

#endif
