/* show/sound_pcm.h - converts sound samples between the formats of a show and numbers. s16 and s24
 * are integers of the range -1..1 - 1 unit; s24 has 3 bytes. All are little-endian, like this
 * machine. Leaves out files and rates (sound_file.h, sound_rate.h). Pure. */
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

sound_pcm sound_pcm_of(const char *name); /* SOUND_PCM_NONE: unknown format */
const char *sound_pcm_name(sound_pcm format);
uint32_t sound_pcm_bytes(sound_pcm format); /* bytes per sample */

/* Returns the narrowest format that keeps every sample and is not narrower than `at_least`.
 * SOUND_PCM_NONE: no format does, and *out_at is the first sample that does not fit. */
sound_pcm sound_pcm_narrowest(const double *samples, size_t count, sound_pcm at_least,
                              size_t *out_at);

/* Converts exactly; a value that is not finite becomes 0. */
void sound_pcm_unpack(float *out, const void *bytes, size_t count, sound_pcm format);
/* Rounds to nearest. Returns the number of samples that were out of range and clipped. */
size_t sound_pcm_pack(void *out, const float *samples, size_t count, sound_pcm format);

#endif
