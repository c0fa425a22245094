/* hand/filter.h - the One-Euro filter (Casiez, Roussel, Vogel, CHI 2012) on angles: still when the
 * hand rests, without lag when it moves. One filter per sensor, parameters per group of sensors, in
 * Hz and Hz per (deg/s). The derivative is taken from the last filtered value, as in the authors'
 * reference since 2023. [frame]; no allocation; a function of its samples alone. */
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

/* One step of one channel, in the channel's unit. dt_s <= 0 or non-finite x: resets. */
float filter_step(filter_state *state, const filter_settings *settings, float x, double dt_s);

/* All sensors of a hand. */
typedef struct hand_filter {
    filter_settings jaw, finger, wrist; /* thumb and spread; other fingers; wrist and arch */
    filter_state state[MRT_ANGLES];
    int64_t last_ns;
    bool running;
} hand_filter;

void hand_filter_init(hand_filter *filter); /* default settings */
void hand_filter_reset(hand_filter *filter);
/* Resets itself when time runs backwards or a gap of more than 0.25 s opens. angle_rad: MRT_ANGLES,
 * in place. A second sample with the same time is ignored
 * and the last output is repeated. */
void hand_filter_apply(hand_filter *filter, float *angle_rad, int64_t time_ns);

#endif
