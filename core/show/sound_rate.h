/* show/sound_rate.h - sound at another rate, by libsamplerate: flat to 0.9 of the lower Nyquist
 * frequency, images 100 dB down, in phase with what it is made of. Leaves out where the sound
 * comes from. One thread at a time. */
#ifndef MAROTTE_TAKE_SOUND_RATE_H
#define MAROTTE_TAKE_SOUND_RATE_H
#include "base/error.h"

typedef struct sound_rate sound_rate;

/* Frames first..first + count - 1 at from_hz, interleaved; first may be negative. */
typedef void sound_rate_source(void *data, int64_t first, float *out, size_t count);

CHECKED mrt_result sound_rate_create(sound_rate **out, uint32_t from_hz, uint32_t to_hz,
                                     uint32_t channel_count, sound_rate_source *source, void *data,
                                     error *err);
void sound_rate_destroy(sound_rate *self); /* NULL is fine */
/* Frames at to_hz; frame 0 of both is at the same time. Going on where the last call ended costs
 * least; elsewhere it begins anew, at most a second before. */
void sound_rate_frames(sound_rate *self, int64_t first, float *out, size_t count);

#endif
