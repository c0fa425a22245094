/* stage/sound/sound_clock.h - estimates the clock of a sound device relative to the host's clock:
 * the time at which a frame is played, or was at the microphone. The device reports the time of
 * each block with an error of milliseconds, and its rate is off by some parts per million. A Kalman
 * filter with two states (time and rate) is exact to some hundredths of a millisecond after a few
 * seconds, and follows the drift. Pure functions on one struct; no allocation. */
#ifndef MAROTTE_STAGE_SOUND_CLOCK_H
#define MAROTTE_STAGE_SOUND_CLOCK_H
#include <stdbool.h>
#include <stdint.h>

typedef struct sound_clock {
    double nominal_ns;       /* duration of a frame */
    int64_t base_ns;         /* offset of the times below */
    int64_t frame;           /* last frame */
    double time_ns, stretch; /* time of the last frame; ns per frame = nominal * (1 + stretch) */
    double when, both, rate; /* covariance of time and rate: ns^2, ns, 1 */
    double jitter;           /* variance of the reported times, ns^2 */
    /* blocks; consecutive outliers on the same side (odd_side: + late, - early) */
    uint32_t count, odd_count;
    int32_t odd_side;
    uint32_t jump_count; /* number of restarts after a jump */
} sound_clock;

void sound_clock_init(sound_clock *self, double rate_hz);
/* Updates the clock: `frame`, later than the last one, is at time_ns of the host's clock. Returns 1
 * if the device has jumped (frames were lost, or it paused). The clock is restarted then. Otherwise
 * 0. */
int sound_clock_block(sound_clock *self, int64_t frame, int64_t time_ns);
/* Call after lost frames: the time of this frame is uncertain again, the rate is kept. */
void sound_clock_break(sound_clock *self, int64_t frame, int64_t time_ns);
int64_t sound_clock_time_ns(const sound_clock *self, int64_t frame);
/* Returns whether the time is known to a third of a millisecond, or enough blocks have been
 * measured. */
bool sound_clock_is_settled(const sound_clock *self);
/* Returns how much faster than its nominal rate the device runs. 0 until it has run for a
 * second. */
double sound_clock_drift_ppm(const sound_clock *self);

#endif
