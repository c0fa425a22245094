/* window/timeline/worker.h - background reader for the timeline: movement curves of clips, the
 * waveform of the sound, and other takes to comp from. A thread opens the show again, read-only.
 * Callers never wait: they receive the results so far, and more later. Leaves out drawing. [main],
 * except for the thread. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_WORKER_H
#define MAROTTE_UI_WINDOW_TIMELINE_WORKER_H
#include "stage/playback/activity.h"
#include "show/waveform.h"
#include "window/timeline/layout.h"

typedef struct timeline_worker timeline_worker;

/* Creates the worker. The thread starts with the first request. plugins must outlive the worker.
 * NULL: no memory. */
timeline_worker *timeline_worker_create(const plugin_list *plugins);
void timeline_worker_destroy(timeline_worker *self); /* NULL is fine */
/* Sets the show to read and the face to perform on. Drops the results of another show. NULL: none.
 */
void timeline_worker_set_show(timeline_worker *self, const char *show_path, const char *face_path);

/* ---- requests ---- */

enum { TIMELINE_STRIPS_MAX = 512, TIMELINE_BINS_MAX = 65536 };
typedef struct timeline_strip { /* curve of a part of a performance */
    uint32_t owner, clip;       /* owner: 0: the take, 1 + n: the n-th other take; clip: id */
    int64_t performance;
    int64_t from_ns, to_ns; /* show time */
    uint32_t lanes;         /* bits of activity lanes; the curve is their maximum */
    take_part part;
    uint32_t bin_count, first_bin;
} timeline_strip;

typedef struct timeline_request {
    uint32_t strip_count, bin_count;
    timeline_strip strip[TIMELINE_STRIPS_MAX];
    int64_t audio;                /* 0: none */
    int64_t audio_from, audio_to; /* frames */
    uint32_t audio_pairs;
    int64_t comps_of;       /* requests takes of the same slate as this take; 0: none */
    uint64_t comps_edition; /* a new number repeats the search */
    char scene[TAKE_NAME], shot[TAKE_NAME];
    uint64_t spans_edition; /* likewise for the times of takes; 0: not requested */
} timeline_request;
void timeline_request_clear(timeline_request *request);
/* Adds a curve to the request. bin_count: at least 1. Returns false if the request is full. */
bool timeline_request_add(timeline_request *request, const timeline_strip *strip);
/* Sends a request, which is copied. An unchanged request costs nothing. */
void timeline_worker_request(timeline_worker *self, const timeline_request *request);

/* ---- results ---- */

enum { TIMELINE_SPANS_MAX = 256 };
typedef struct timeline_span { /* recording time of a take; show time */
    int64_t take, start_ns, end_ns;
} timeline_span;

typedef struct timeline_result {
    uint32_t strip_count; /* strips of an earlier request; identified by owner and clip */
    timeline_strip strip[TIMELINE_STRIPS_MAX];
    activity_bin bin[TIMELINE_BINS_MAX]; /* minimum > maximum: not known yet */
    int64_t audio;
    show_audio about; /* of the sound */
    bool has_wave;
    waveform_view wave;
    uint32_t span_count; /* of the newest takes, newest first */
    timeline_span span[TIMELINE_SPANS_MAX];
    uint64_t number;  /* number of the answered request */
    bool is_complete; /* complete, unless the recording grows */
    char note[256];   /* why a curve is missing; may be "" */
} timeline_result;
/* Returns the newest result, never NULL. Valid until the next call. */
const timeline_result *timeline_worker_result(timeline_worker *self);
const timeline_strip *timeline_result_strip(const timeline_result *result, uint32_t owner,
                                            uint32_t clip);

typedef struct timeline_comps { /* other takes, newest first */
    int64_t of;
    uint32_t count;
    take take[TIMELINE_COMPS_MAX];
} timeline_comps;
/* Returns the other takes, or NULL. Valid until the next call. */
const timeline_comps *timeline_worker_comps(timeline_worker *self);
/* Returns whether the current request is not complete. */
bool timeline_worker_is_busy(const timeline_worker *self);

#endif
