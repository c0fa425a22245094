/* take/sound_render.h - the sound of a take as its timeline has it: frames at the sound's own rate,
 * frame n at n / rate seconds of the timeline, silence where there is none. A recorded sound ran on
 * its device's clock (sound_map.h): single frames are left out or repeated, cross-faded over 5 ms,
 * so that it keeps within half a frame of its times; it is never resampled. What a frame is does
 * not depend on where one began to ask. Leaves out the device that plays it. One thread at a time.
 */
#ifndef MAROTTE_TAKE_SOUND_RENDER_H
#define MAROTTE_TAKE_SOUND_RENDER_H
#include "take/sound_map.h"

typedef struct sound_render sound_render;

/* The show must outlive it. */
CHECKED mrt_result sound_render_create(sound_render **out, show *s, const take_audio *audio,
                                       error *err);
void sound_render_destroy(sound_render *self); /* NULL is fine */
const show_audio *sound_render_audio(const sound_render *self);
const sound_map *sound_render_map(const sound_render *self);

/* Frames first..first + count - 1 of the timeline, interleaved, with the gain; not cut to -1..1.
 * < 0: some of them are damaged in the show and silent here (and up to 256 behind);
 * the others are as they should be. */
CHECKED mrt_result sound_render_frames(sound_render *self, int64_t first, float *out, size_t count,
                                       error *err);
/* Frames left out or repeated in what was rendered so far; parts without sound count nothing. */
uint64_t sound_render_splice_count(const sound_render *self);

/* The frame of the timeline that is nearest to a time. */
int64_t sound_render_frame(uint32_t rate_hz, int64_t at_ns);

#endif
