/* show/sound_render.h - renders the sound of a take on its timeline, at the rate of the sound or at
 * another one (sound_rate.h). Frame n is at n / rate seconds of the timeline. Parts without sound
 * are silent. A recorded sound ran on the clock of its device (the map). Single frames are skipped
 * or repeated, cross-faded over 5 ms, so that it stays within half a frame of its times. A frame is
 * the same wherever rendering began, except for rounding when it is resampled. Leaves out playback
 * on a device. One thread at a time. */
#ifndef MAROTTE_TAKE_SOUND_RENDER_H
#define MAROTTE_TAKE_SOUND_RENDER_H
#include "show/show.h"

/* ---- the map: the time of each frame of a sound, on the clock of the samples ---- */

/* A recorded sound ran on the clock of its device. Its anchors show how that clock ran, but they
 * are noisy. So the map fits a line through the anchors around every tenth second. Where the
 * anchors jump, frames were lost: the sound then has several pieces with gaps between them. A sound
 * from a file runs at its nominal rate. Times are local: 0 is show_audio.start_ns. Any thread; read
 * only after init. */

typedef struct sound_knot { /* valid from `frame` up to the next knot */
    int64_t frame;
    double time_ns, ns_per_frame;
    int64_t piece_first, piece_end; /* the uninterrupted recording around it */
} sound_knot;

typedef struct sound_map {
    uint32_t rate_hz;
    int64_t frame_count;
    sound_knot *knot; /* sorted by time and by frame; at least 1 */
    size_t knot_count;
} sound_map;

/* `anchors` are sorted by frame. Impossible ones are skipped (descending times, or days away). */
CHECKED mrt_result sound_map_init(sound_map *out, const show_audio *audio,
                                  const show_audio_anchor *anchors, size_t anchor_count,
                                  error *err);
void sound_map_finish(sound_map *map); /* accepts zeroed */

/* Returns true if every frame is at its nominal time, so that no correction is needed. */
bool sound_map_is_plain(const sound_map *map);
/* Returns the knot that applies at a time; before the first knot it is the first. */
const sound_knot *sound_map_knot_at(const sound_map *map, double time_ns);

/* ---- the sound on the timeline ---- */

typedef struct sound_render sound_render;

/* Creates a renderer. The show must outlive it. rate_hz 0: the rate of the sound. */
CHECKED mrt_result sound_render_create(sound_render **out, show *s, const take_audio *audio,
                                       uint32_t rate_hz, error *err);
void sound_render_destroy(sound_render *self); /* NULL is fine */
const show_audio *sound_render_audio(const sound_render *self);
const sound_map *sound_render_map(const sound_render *self);

/* Renders the frames first..first + count - 1 of the timeline, interleaved, with the gain, not
 * clipped to -1..1. < 0: some frames are damaged in the show; these, and up to 256 after them, are
 * silent here. All other frames are correct. */
CHECKED mrt_result sound_render_frames(sound_render *self, int64_t first, float *out, size_t count,
                                       error *err);
/* Returns the number of frames that were skipped or repeated so far. Parts without sound do not
 * count. */
uint64_t sound_render_splice_count(const sound_render *self);

/* Returns the frame of the timeline nearest to a time. */
int64_t sound_render_frame(uint32_t rate_hz, int64_t at_ns);

#endif
