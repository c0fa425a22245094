/* show/sound_pcm.h - samples of sound as a show keeps them, and as numbers. s16 and s24 are
 * integers of the range -1..1 - 1 unit, s24 in 3 bytes; all are little-endian, as this machine is.
 * Pure. */
#ifndef MAROTTE_TAKE_SOUND_PCM_H
#define MAROTTE_TAKE_SOUND_PCM_H
#include <stddef.h>
#include <stdint.h>

typedef enum sound_pcm {
    SOUND_PCM_NONE = 0,
    SOUND_PCM_S16,
    SOUND_PCM_S24,
    SOUND_PCM_F32
} sound_pcm;

sound_pcm sound_pcm_of(const char *name); /* NONE: no such format */
const char *sound_pcm_name(sound_pcm format);
uint32_t sound_pcm_bytes(sound_pcm format); /* of a sample */

/* The narrowest format that is not narrower than `at_least` and keeps every sample as it is; NONE:
 * there is none, *out_at is the first sample that does not fit. */
sound_pcm sound_pcm_narrowest(const double *samples, size_t count, sound_pcm at_least,
                              size_t *out_at);

/* Exact but for what is not finite, which becomes 0. */
void sound_pcm_unpack(float *out, const void *bytes, size_t count, sound_pcm format);
/* Rounds to nearest; returns how many samples were out of range and had to be cut. */
size_t sound_pcm_pack(void *out, const float *samples, size_t count, sound_pcm format);

#endif
