/* hand/filter.h - the One-Euro filter (Casiez, Roussel, Vogel, CHI 2012) for angles: no jitter when
 * the hand rests, and little lag when it moves. One filter per sensor, with parameters per group of
 * sensors, in Hz and Hz per (deg/s). The derivative is computed from the last filtered value, as in
 * the authors' reference since 2023. [frame]; no allocation; a function of its samples alone. */
#ifndef MAROTTE_HAND_FILTER_H
#define MAROTTE_HAND_FILTER_H
#include <marotte/plugin.h>

typedef struct filter_settings {
    float min_cutoff_hz;        /* > 0 */
    float beta;                 /* Hz per unit/s, >= 0 */
    float derivative_cutoff_hz; /* > 0 */
} filter_settings;

typedef struct filter_state {
    float value, derivative;
    bool running;
} filter_state;

/* Filters one sample of one channel, in the unit of the channel. dt_s <= 0 or non-finite x resets
 * it. */
float filter_step(filter_state *state, const filter_settings *settings, float x, double dt_s);

/* All sensors of a hand. */
typedef struct hand_filter {
    filter_settings jaw, finger, wrist; /* thumb, spread; other fingers; wrist, arch */
    filter_state state[MRT_ANGLES];
    int64_t last_ns;
    bool running;
} hand_filter;

void hand_filter_init(hand_filter *filter); /* with default settings */
void hand_filter_reset(hand_filter *filter);
/* Filters angle_rad (MRT_ANGLES) in place. Resets itself if time runs backwards, or after a gap of
 * more than 0.25 s. Ignores a second sample with the same time, and repeats the last output. */
void hand_filter_apply(hand_filter *filter, float *angle_rad, int64_t time_ns);

#endif
