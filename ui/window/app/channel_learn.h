/* window/app/channel_learn.h - the channels of all inputs as a patch sees them, and which of them a
 * person moves: so a fader, a pad or a button is chosen by moving it. Leaves out what the channel
 * then does (the panels Patch and Poses). [main] */
#ifndef MAROTTE_UI_WINDOW_APP_CHANNEL_LEARN_H
#define MAROTTE_UI_WINDOW_APP_CHANNEL_LEARN_H
#include "stage/perform/patch.h"

enum { CHANNELS_INPUTS = 8 };

struct app;
/* The newest values, as a mapping would receive them. Points into the inputs and into `sample`, so
 * it must not move. */
typedef struct channels_now {
    mrt_frame frame;
    mrt_channels inputs[CHANNELS_INPUTS];
    mrt_sample sample[CHANNELS_INPUTS];
    bool is_lost[CHANNELS_INPUTS]; /* the device is disconnected */
} channels_now;
void channels_read(channels_now *out, struct app *of);
/* Writes input and channel of a connection. Sensors and pedals are named as calibrated channels of
 * the performer, all others as raw channels of their input. */
void channels_name(const channels_now *now, uint32_t which, uint32_t channel,
                   patch_connection *out);

typedef struct channel_learner { /* zeroed: begins with the next values */
    uint32_t count;              /* values seen */
    bool is_known[CHANNELS_INPUTS];
    float was[CHANNELS_INPUTS][MRT_MAX_CHANNELS]; /* value at the start of learning */
    float last[CHANNELS_INPUTS][MRT_MAX_CHANNELS];
    bool has_jumped; /* the channel that was found moved in one step, as a pad does */
} channel_learner;
/* Call in each frame. Returns true when a channel has moved by at least a fifth of its range
 * since the start, and names the one that moved most. */
bool channel_learn(channel_learner *self, const channels_now *now, patch_connection *out);

#endif
