/* take/sound_whole.h - whether a file of sound is all there: readers of sound take what a cut file
 * has and say nothing. RIFF (WAV), RF64 and FORM (AIFF) say how long they are, Ogg how it ends;
 * others are found short while they are decoded. Any thread that may block. */
#ifndef MAROTTE_TAKE_SOUND_WHOLE_H
#define MAROTTE_TAKE_SOUND_WHOLE_H
#include <stdbool.h>
#include <stdint.h>

/* `fd` stands at the start of a regular file, and does so again afterwards. False: it was cut;
 * *out_promised of *out_there bytes are there, *out_promised 0: it does not say. */
bool sound_whole(int fd, int64_t *out_promised, int64_t *out_there);

#endif
