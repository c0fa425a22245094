/* stage/input/glove_channels.h - finds the channels with the raw sensors of one hand, for a
 * calibration. They are counts of a glove or angles of a bare hand. Pure. */
#ifndef MAROTTE_STAGE_GLOVE_CHANNELS_H
#define MAROTTE_STAGE_GLOVE_CHANNELS_H
#include "base/error.h"
#include "hand/hand.h"

typedef struct glove_channels {
    uint32_t side, sensors; /* bit i of sensors: the glove has sensor i */
    char input[HAND_INPUT]; /* kind of input of a bare hand, see hand_calibration; "": a glove */
    int channel_of[MRT_ANGLES]; /* -1: none */
    float low, high;            /* widest range of the raw values of all channels */
} glove_channels;

/* side MRT_NO_HAND: the only hand that the input measures. name: name of the input. */
CHECKED mrt_result glove_channels_find(glove_channels *out, const mrt_channel *channel,
                                       uint32_t count, uint32_t side, const char *name, error *err);
typedef enum glove_channels_kind {
    GLOVE_CHANNELS_NONE = 0, /* the input does not measure this hand */
    GLOVE_CHANNELS_COUNT,    /* a glove, which needs a calibration */
    GLOVE_CHANNELS_RAD       /* a bare hand with angles, which a calibration improves */
} glove_channels_kind;
glove_channels_kind glove_channels_of(const mrt_channel *channel, uint32_t count, uint32_t side);
/* Writes the kind of input, see hand_calibration. */
void glove_channels_input(char out[HAND_INPUT], const char *name);
/* Copies the hand's sensors from a sample to raw. Other elements stay. raw: MRT_ANGLES elements. */
void glove_channels_read(const glove_channels *self, const mrt_sample *sample, float *raw);

#endif
