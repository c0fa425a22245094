/* take/sound_rate.h - sound at another rate, when somebody asks for that: a windowed sinc (Kaiser),
 * flat to 0.89 of the lower Nyquist frequency, 90 dB down beyond it. The same bits on every
 * machine. Pure but for create. */
#ifndef MAROTTE_TAKE_SOUND_RATE_H
#define MAROTTE_TAKE_SOUND_RATE_H
#include "base/error.h"

typedef struct sound_rate sound_rate;

CHECKED mrt_result sound_rate_create(sound_rate **out, uint32_t from_hz, uint32_t to_hz,
                                     uint32_t channel_count, error *err);
void sound_rate_destroy(sound_rate *self); /* NULL is fine */
/* Which frames at from_hz frames first..first + count - 1 at to_hz are made of; frame 0 of both are
 * at the same time. */
void sound_rate_needs(const sound_rate *self, int64_t first, size_t count, int64_t *out_first,
                      size_t *out_count);
/* `in`: what it needs. */
void sound_rate_convert(const sound_rate *self, float *out, int64_t first, size_t count,
                        const float *in);

#endif
