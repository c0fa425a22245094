/* hand/landmark_filter.h - the filter of angles that are read from landmarks (hand_read): what a
 * camera or a headset sees at 30 to 90 Hz, with white noise of degrees in every joint. Leaves out
 * gloves, whose noise is small: filter.h.
 *
 * A low pass whose cutoff rises when the hand moves. Unlike the One-Euro filter it measures the
 * noise of each channel and compares deviations with it, and it decides for a whole finger and the
 * hand. So white noise of any amplitude is reduced alike, to less than a third at 30 Hz, and a hand
 * that moves is less than 30 ms late. The output lies between the last output and the measurement,
 * therefore a step is never overshot. tests/unit/hand_landmark_filter.c measures both.
 *
 * [frame]; no allocation; a function of its samples alone. */
#ifndef MAROTTE_HAND_LANDMARK_FILTER_H
#define MAROTTE_HAND_LANDMARK_FILTER_H
#include <marotte/plugin.h>

typedef struct landmark_channel {
    float value;       /* rad, the last output */
    float deviation;   /* measured minus output, in units of its noise, averaged over 0.1 s */
    float variance;    /* rad^2, of the noise */
    float measured[2]; /* rad, the last one and the one before it */
} landmark_channel;

/* All zero: no sample was seen yet. */
typedef struct landmark_filter {
    landmark_channel channel[MRT_ANGLES];
    uint32_t count; /* of samples since the last reset; stops at LANDMARK_FILTER_SETTLED */
    int64_t last_ns;
    double last_dt_s; /* from the sample before the last one; 0 after a reset */
} landmark_filter;

enum { LANDMARK_FILTER_SETTLED = 10000 };

void landmark_filter_reset(landmark_filter *filter);
/* angle_rad: MRT_ANGLES, in place. The first sample passes unchanged. The filter resets itself when
 * time runs backwards or a gap of more than 0.25 s opens. A second sample with the same time is
 * ignored and the last output is repeated. A non-finite angle counts as the last finite one of its
 * channel, 0 before the first. */
void landmark_filter_apply(landmark_filter *filter, float *angle_rad, int64_t time_ns);

#endif
