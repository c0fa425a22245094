/* show/waveform.h - the outline of a sound: the least and the greatest sample of each stretch, over
 * all channels, at every zoom from at most 4096 of them. It is computed in pieces, beside other
 * work, and goes on when the sound does. What it gives is exact. At most 8 MiB whatever the
 * length; at zooms finer than it keeps it reads the sound itself. One thread at a time, any that
 * may read the show. */
#ifndef MAROTTE_TAKE_WAVEFORM_H
#define MAROTTE_TAKE_WAVEFORM_H
#include "show/show.h"

typedef struct waveform waveform;

typedef struct waveform_pair {
    float least, greatest;
} waveform_pair;

CHECKED mrt_result waveform_create(waveform **out, show *s, int64_t audio, error *err);
void waveform_destroy(waveform *self); /* NULL is fine */
/* Before the first step: how many pairs are kept; 2^20 is the most, and what it is unless a test
 * says fewer. */
void waveform_limit(waveform *self, size_t pairs_max);

/* Looks at up to so many further frames. MRT_OK: there are more; MRT_END: all that is recorded by
 * now was looked at; < 0: a stretch is damaged, counts as silence, and the next call goes on behind
 * it. */
CHECKED mrt_result waveform_step(waveform *self, show *s, int64_t frames_max, error *err);
int64_t waveform_known_frames(const waveform *self);

enum { WAVEFORM_PAIRS_MAX = 4096 };
typedef struct waveform_view {
    int64_t first_frame;     /* of pair 0: a multiple of frames_per_pair, <= what was asked for */
    int64_t frames_per_pair; /* a power of two; the last pair may have fewer */
    size_t count;
    waveform_pair pair[WAVEFORM_PAIRS_MAX];
} waveform_view;

/* Frames from..to - 1 by at most `pairs_max` (1..4096) pairs, the finest for which they suffice.
 * Pairs are of what is known by now. < 0: at a fine zoom the sound cannot be read there. */
CHECKED mrt_result waveform_read(waveform *self, show *s, int64_t from, int64_t to,
                                 size_t pairs_max, waveform_view *out, error *err);

#endif
