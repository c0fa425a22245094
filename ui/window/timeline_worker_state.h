/* window/timeline_worker_state.h - the inside of the worker: what lies between the threads, and
 * what is the thread's own. */
#ifndef MAROTTE_UI_WINDOW_TIMELINE_WORKER_STATE_H
#define MAROTTE_UI_WINDOW_TIMELINE_WORKER_STATE_H
#include "window/timeline_worker.h"

#include <pthread.h>

enum { WORKER_CURVES_MAX = 32, WORKER_SAMPLES = 512, WORKER_FRAMES = 1 << 18 };

typedef struct worker_curve { /* of a performance */
    int64_t performance, from_ns;
    activity *curve; /* NULL: it cannot be performed */
    bool is_done;
    uint64_t used; /* when it was last wished */
} worker_curve;

typedef struct worker_desk { /* [thread] */
    plugin_list *plugins;
    log_queue *log; /* what recordings have to say was said when they were made */
    show *show;
    face_file face;
    bool has_face;
    composer *scratch;
    source_world world;
    worker_curve curve[WORKER_CURVES_MAX];
    uint32_t curve_count;
    uint64_t uses;
    waveform *wave;
    int64_t wave_of;
    show_audio about;
    bool is_wave_done;
    int64_t comps_of;
    uint64_t comps_edition, spans_edition;
    uint32_t span_count;
    timeline_span span[TIMELINE_SPANS_MAX];
    char note[256];
} worker_desk;

/* Of all that is known: a number that changes when more is. */
int64_t worker_desk_known(const worker_desk *self);
/* Opens what the paths name; what fails is noted. */
void worker_desk_open(worker_desk *self, const char *show_path, const char *face_path);
void worker_desk_close(worker_desk *self);
/* A piece of what is wished; false: there is nothing left to do now. */
bool worker_desk_step(worker_desk *self, const timeline_wish *wish);
void worker_desk_fill(worker_desk *self, const timeline_wish *wish, timeline_seen *out);
/* The other takes, if they are to be looked for anew: to be freed by timeline_comps_free. */
timeline_comps *worker_desk_comps(worker_desk *self, const timeline_wish *wish);
void timeline_comps_free(timeline_comps *comps); /* NULL is fine */

struct timeline_worker {
    pthread_mutex_t lock; /* held for copies and swaps only */
    pthread_cond_t wake;
    pthread_t thread;
    bool has_thread, ends;
    /* from main; under the lock */
    char *show_path, *face_path;
    uint64_t show_number, wish_number;
    timeline_wish wish;
    /* to main; under the lock */
    timeline_seen *ready;
    bool is_fresh;
    timeline_comps *comps_ready;
    bool has_comps;
    /* [main] */
    timeline_seen *front;
    timeline_comps *comps;
    timeline_wish wished;
    /* [thread] */
    timeline_seen *back;
    worker_desk desk;
};

#endif
