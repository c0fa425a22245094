/* window/timeline/worker.h - what the timeline shows of recordings, read beside everything else:
 * how much each clip moves the face, the outline of the sound, and other takes to comp from. A
 * thread with a show of its own, that only reads; nobody waits for it: what is known so far is
 * given, the rest comes. Leaves out drawing. [main] but what runs on the thread. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_WORKER_H
#define MAROTTE_UI_WINDOW_TIMELINE_WORKER_H
#include "stage/playback/activity.h"
#include "show/waveform.h"
#include "window/timeline/layout.h"

typedef struct timeline_worker timeline_worker;

/* The thread begins with the first request. NULL: no memory. The list outlives it. */
timeline_worker *timeline_worker_create(const plugin_list *plugins);
void timeline_worker_destroy(timeline_worker *self); /* NULL is fine */
/* Where it reads, and a face to perform on; what was of another show is forgotten. NULL: nothing.
 */
void timeline_worker_set_show(timeline_worker *self, const char *show_path, const char *face_path);

/* ---- what is requested ---- */

enum { TIMELINE_STRIPS_MAX = 512, TIMELINE_BINS_MAX = 65536 };
typedef struct timeline_strip { /* of a performance, as a curve */
    uint32_t owner, clip;       /* 0: the take, 1 + n: the n-th other one; id */
    int64_t performance;
    int64_t from_ns, to_ns; /* show time */
    uint32_t lanes;         /* bits of activity's lanes: the greatest of them counts */
    uint32_t bin_count, first_bin;
} timeline_strip;

typedef struct timeline_request {
    uint32_t strip_count, bin_count;
    timeline_strip strip[TIMELINE_STRIPS_MAX];
    int64_t audio;                /* 0: none */
    int64_t audio_from, audio_to; /* frames */
    uint32_t audio_pairs;
    int64_t comps_of;       /* takes of the same slate as this one's; 0: none */
    uint64_t comps_edition; /* another one: they are looked for anew */
    char scene[TAKE_NAME], shot[TAKE_NAME];
    uint64_t spans_edition; /* the same, when takes were made; 0: not requested */
} timeline_request;
void timeline_request_clear(timeline_request *request);
/* False: there is no room for it. bin_count at least 1. */
bool timeline_request_add(timeline_request *request, const timeline_strip *strip);
/* Copied; the same as last time costs nothing. */
void timeline_worker_request(timeline_worker *self, const timeline_request *request);

/* ---- parts of the application ---- */

enum { TIMELINE_SPANS_MAX = 256 };
typedef struct timeline_span { /* when a take was made; show time */
    int64_t take, start_ns, end_ns;
} timeline_span;

typedef struct timeline_result {
    uint32_t strip_count; /* as requested some time before; by owner and clip */
    timeline_strip strip[TIMELINE_STRIPS_MAX];
    activity_bin bin[TIMELINE_BINS_MAX]; /* least > greatest: not known yet */
    int64_t audio;
    show_audio about; /* of the sound */
    bool has_wave;
    waveform_view wave;
    uint32_t span_count; /* of the newest takes, newest first */
    timeline_span span[TIMELINE_SPANS_MAX];
    uint64_t number;  /* of the request that it answers */
    bool is_complete; /* nothing more comes unless something is recorded */
    char note[256];   /* why there is no curve; "" */
} timeline_result;
/* The newest; until the next call. Never NULL. */
const timeline_result *timeline_worker_look(timeline_worker *self);
const timeline_strip *timeline_result_strip(const timeline_result *result, uint32_t owner,
                                            uint32_t clip);

typedef struct timeline_comps { /* other takes, newest first */
    int64_t of;
    uint32_t count;
    take take[TIMELINE_COMPS_MAX];
} timeline_comps;
/* Until the next call; NULL: none are known. */
const timeline_comps *timeline_worker_comps(timeline_worker *self);
/* More of what was asked for is to come. */
bool timeline_worker_is_busy(const timeline_worker *self);

#endif
