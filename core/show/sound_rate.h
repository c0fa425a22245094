/* show/sound_rate.h - resamples sound with libsamplerate: flat to 0.9 of the lower Nyquist
 * frequency, images at -100 dB, in phase with its source. Leaves out the source of the sound. One
 * thread at a time. */
#ifndef MAROTTE_TAKE_SOUND_RATE_H
#define MAROTTE_TAKE_SOUND_RATE_H
#include "base/error.h"

typedef struct sound_rate sound_rate;

/* Callback that delivers the frames first..first + count - 1 at from_hz, interleaved. `first` may
 * be negative. */
typedef void sound_rate_source(void *data, int64_t first, float *out, size_t count);

CHECKED mrt_result sound_rate_create(sound_rate **out, uint32_t from_hz, uint32_t to_hz,
                                     uint32_t channel_count, sound_rate_source *source, void *data,
                                     error *err);
void sound_rate_destroy(sound_rate *self); /* accepts NULL */
/* Renders frames at to_hz. Frame 0 of the source and of the output have the same time. Continuing
 * where the last call ended is fastest. Any other position restarts the resampler, at most a second
 * before it. */
void sound_rate_frames(sound_rate *self, int64_t first, float *out, size_t count);

#endif
