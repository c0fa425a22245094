/* hand/landmark_filter.h - the filter for angles from landmarks (hand_read): the output of a camera
 * or a headset at 30 to 90 Hz, with white noise of several degrees in every joint. Leaves out
 * gloves, whose noise is small: filter.h.
 *
 * A low pass whose cutoff rises when the hand moves. Unlike the One-Euro filter it measures the
 * noise of each channel and compares deviations with it. It decides for a whole finger and the
 * hand. So white noise of any amplitude is reduced to less than a third at 30 Hz, and a moving hand
 * has less than 30 ms of delay. The output is between the last output and the measurement, so it
 * never overshoots a step. tests/unit/hand_landmark_filter.c measures both.
 *
 * [frame]; no allocation; a function of its samples alone. */
#ifndef MAROTTE_HAND_LANDMARK_FILTER_H
#define MAROTTE_HAND_LANDMARK_FILTER_H
#include <marotte/plugin.h>

typedef struct landmark_channel {
    float value;       /* last output, rad */
    float deviation;   /* measurement minus output, in units of the noise, averaged over 0.1 s */
    float variance;    /* of the noise, rad^2 */
    float measured[2]; /* rad, the last measurement and the one before it */
} landmark_channel;

/* Zeroed: no sample yet. */
typedef struct landmark_filter {
    landmark_channel channel[MRT_ANGLES];
    uint32_t count; /* number of samples since the last reset; stops at LANDMARK_FILTER_SETTLED */
    int64_t last_ns;
    double last_dt_s; /* time between the last two samples; 0 after a reset */
} landmark_filter;

enum { LANDMARK_FILTER_SETTLED = 10000 };

void landmark_filter_reset(landmark_filter *filter);
/* Filters angle_rad (MRT_ANGLES) in place. The first sample passes unchanged. Resets itself if time
 * runs backwards, or after a gap of more than 0.25 s. Ignores a second sample with the same time,
 * and repeats the last output. A non-finite angle counts as the last finite one of its channel, or
 * 0. */
void landmark_filter_apply(landmark_filter *filter, float *angle_rad, int64_t time_ns);

#endif
