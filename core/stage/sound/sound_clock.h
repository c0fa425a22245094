/* stage/sound/sound_clock.h - a sound device's own clock against the host's: which frame is heard
 * (or was at the microphone) when. The device tells the time of each block, too early or too late
 * by milliseconds, and runs some parts per million off; a Kalman filter of two states (when, how
 * fast) knows it to some hundredths of a millisecond after a few seconds, and follows as it drifts.
 * Pure functions on one struct; no allocation. */
#ifndef MAROTTE_STAGE_SOUND_CLOCK_H
#define MAROTTE_STAGE_SOUND_CLOCK_H
#include <stdbool.h>
#include <stdint.h>

typedef struct sound_clock {
    double nominal_ns;         /* per frame */
    int64_t base_ns;           /* of the times below */
    int64_t frame;             /* that came last */
    double time_ns, stretch;   /* when it is; ns per frame = nominal * (1 + stretch) */
    double when, both, rate;   /* covariance: ns^2, ns, 1 */
    double jitter;             /* ns^2, of what the device tells */
    uint32_t count, odd_count; /* blocks; in a row far off on the same side: + late, - early */
    int32_t odd_side;
    uint32_t jump_count; /* times that it had to be set anew */
} sound_clock;

void sound_clock_init(sound_clock *self, double rate_hz);
/* Frame `frame`, later than the last one, is at time_ns of the host's clock. 1: the device has
 * jumped (frames were lost, it stood still), and the clock with it; else 0. */
int sound_clock_block(sound_clock *self, int64_t frame, int64_t time_ns);
/* Frames before this one were lost: when it is is as good as unknown, how fast is not. */
void sound_clock_break(sound_clock *self, int64_t frame, int64_t time_ns);
int64_t sound_clock_time_ns(const sound_clock *self, int64_t frame);
/* When it is is known to a third of a millisecond, or as well as it soon will be. */
bool sound_clock_is_settled(const sound_clock *self);
/* How much faster than it says the device runs; 0 until it has run for a second. */
double sound_clock_drift_ppm(const sound_clock *self);

#endif
