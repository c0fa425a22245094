/* take/sound_map.h - when each frame of a sound was heard, on the clock of the samples: a recorded
 * sound ran on its device's own clock, and its anchors say how that one went. They are noisy, so a
 * line is laid through those around every tenth second; where they jump, frames were lost, and the
 * sound is in pieces with nothing between. A sound from a file runs at its rate. Times are local:
 * 0 is show_audio.start_ns. Any thread; read only once made. */
#ifndef MAROTTE_TAKE_SOUND_MAP_H
#define MAROTTE_TAKE_SOUND_MAP_H
#include "take/show.h"

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
CHECKED mrt_result sound_map_read(sound_map *out, show *s, const show_audio *audio, error *err);
void sound_map_finish(sound_map *map); /* accepts zeroed */

/* Every frame at its nominal time: nothing is to be corrected. */
bool sound_map_is_plain(const sound_map *map);
/* The knot that holds for a time, the first one before it. */
const sound_knot *sound_map_knot_at(const sound_map *map, double time_ns);
double sound_map_time_ns(const sound_map *map, int64_t frame);
/* How much faster than it says its device ran, on the whole; 0 when not known. */
double sound_map_drift_ppm(const sound_map *map);

#endif
