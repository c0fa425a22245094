/* voice/wav.h - reads the frames of a WAV file in order, mixed to one channel. Mono or stereo; 16
 * or 24 bit, or float of 32 bit; any rate from 8 to 192 kHz. Leaves out other formats. One thread
 * at a time. */
#ifndef PLUGINS_VOICE_WAV_H
#define PLUGINS_VOICE_WAV_H
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

enum { WAV_REASON = 240, WAV_FRAMES = 1024 };

typedef struct wav {
    FILE *file;       /* NULL: closed */
    uint32_t rate_hz; /* frames per second */
    uint32_t channel_count, sample_bytes;
    bool is_float;
    int64_t frame_count, next;               /* of the file; the next one that is returned */
    unsigned char bytes[WAV_FRAMES * 2 * 4]; /* frames that were read ahead */
    uint32_t at, size;
} wav;

/* Returns false with one sentence in out_reason. */
bool wav_open(wav *self, const char *path, char out_reason[WAV_REASON]);
/* Reads the next frame, full scale being 1. Returns false at the end, also of a file that was cut
 * short. */
bool wav_read(wav *self, float *out);
void wav_close(wav *self); /* accepts zeroed */

#endif
