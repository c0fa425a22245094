/* show/sound_render.h - the sound of a take as its timeline has it: frames at the sound's own rate,
 * or at another that is asked for (sound_rate.h), frame n at n / rate seconds of the timeline,
 * silence where there is none. A recorded sound ran on its device's clock (the map): single frames
 * are left out or repeated, cross-faded over 5 ms, so that it keeps within half a frame of its
 * times. What a frame is does not depend on where one began to ask (but for rounding, where it is
 * resampled). Leaves out the device that plays it. One thread at a time. */
#ifndef MAROTTE_TAKE_SOUND_RENDER_H
#define MAROTTE_TAKE_SOUND_RENDER_H
#include "show/show.h"

/* ---- the map: when each frame of a sound was heard, on the clock of the samples ---- */

/* A recorded sound ran on its device's own clock, and its anchors say how that one went. They are
 * noisy, so a line is laid through those around every tenth second; where they jump, frames were
 * lost, and the sound is in pieces with nothing between. A sound from a file runs at its rate.
 * Times are local: 0 is show_audio.start_ns. Any thread; read only once made. */

typedef struct sound_knot { /* from `frame` on, up to the next knot */
    int64_t frame;
    double time_ns, ns_per_frame;
    int64_t piece_first, piece_end; /* the frames recorded without a break around it */
} sound_knot;

typedef struct sound_map {
    uint32_t rate_hz;
    int64_t frame_count;
    sound_knot *knot; /* by time, and by frame; at least 1 */
    size_t knot_count;
} sound_map;

/* `anchors` by frame; those that cannot be (times that descend, days away) are passed over. */
CHECKED mrt_result sound_map_init(sound_map *out, const show_audio *audio,
                                  const show_audio_anchor *anchors, size_t anchor_count,
                                  error *err);
void sound_map_finish(sound_map *map); /* accepts zeroed */

/* Every frame at its nominal time: nothing is to be corrected. */
bool sound_map_is_plain(const sound_map *map);
/* The knot that holds for a time, the first one before it. */
const sound_knot *sound_map_knot_at(const sound_map *map, double time_ns);

/* ---- the sound on the timeline ---- */

typedef struct sound_render sound_render;

/* The show must outlive it. rate_hz 0: the sound's own. */
CHECKED mrt_result sound_render_create(sound_render **out, show *s, const take_audio *audio,
                                       uint32_t rate_hz, error *err);
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
