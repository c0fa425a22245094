/* show/waveform.h - the outline of a sound: minimum and maximum sample of each stretch over all
 * channels, at every zoom, in at most 4096 pairs. It is computed in pieces beside other work, and
 * continues while the sound grows. Its values are exact. It uses at most 8 MiB for any length; for
 * finer zooms it reads the sound itself. Leaves out drawing. One thread at a time, any that may
 * read the show. */
#ifndef MAROTTE_TAKE_WAVEFORM_H
#define MAROTTE_TAKE_WAVEFORM_H
#include "show/show.h"

typedef struct waveform waveform;

typedef struct waveform_pair {
    float least, greatest;
} waveform_pair;

CHECKED mrt_result waveform_create(waveform **out, show *s, int64_t audio, error *err);
void waveform_destroy(waveform *self); /* NULL is fine */
/* Sets the number of pairs that are kept, before the first step. Default and maximum are 2^20;
 * tests use fewer. */
void waveform_limit(waveform *self, size_t pairs_max);

/* Processes up to frames_max more frames. MRT_OK: there are more. MRT_END: all frames recorded so
 * far are processed. < 0: a stretch is damaged and counts as silence; the next call continues after
 * it. */
CHECKED mrt_result waveform_step(waveform *self, show *s, int64_t frames_max, error *err);
int64_t waveform_known_frames(const waveform *self);

enum { WAVEFORM_PAIRS_MAX = 4096 };
typedef struct waveform_view {
    int64_t
        first_frame; /* first frame of pair 0: a multiple of frames_per_pair, at or before `from` */
    int64_t frames_per_pair; /* a power of two; the last pair may have fewer */
    size_t count;
    waveform_pair pair[WAVEFORM_PAIRS_MAX];
} waveform_view;

/* Describes the frames from..to - 1 by at most `pairs_max` (1..4096) pairs, at the finest zoom that
 * fits. Only processed frames are included. < 0: at a fine zoom the sound cannot be read there. */
CHECKED mrt_result waveform_read(waveform *self, show *s, int64_t from, int64_t to,
                                 size_t pairs_max, waveform_view *out, error *err);

#endif
