#include "window/timeline_worker_state.h"

#include "base/clock.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#define PUBLISH_NS (80 * NS_PER_MS)  /* while it is being computed */
#define AGAIN_NS   (400 * NS_PER_MS) /* a recording may go on */
enum { NICENESS = 10 };

/* ---- wishes ---- */

void timeline_wish_clear(timeline_wish *wish)
{
    memset(wish, 0, sizeof *wish);
}

bool timeline_wish_strip(timeline_wish *wish, const timeline_strip *strip)
{
    if (wish->strip_count >= TIMELINE_STRIPS_MAX || strip->bin_count == 0 ||
        strip->bin_count > TIMELINE_BINS_MAX - wish->bin_count)
        return false;
    wish->strip[wish->strip_count] = *strip;
    wish->strip[wish->strip_count++].first_bin = wish->bin_count;
    wish->bin_count += strip->bin_count;
    return true;
}

const timeline_strip *timeline_seen_strip(const timeline_seen *seen, uint32_t owner, uint32_t clip)
{
    for (uint32_t i = 0; i < seen->strip_count; ++i)
        if (seen->strip[i].clip == clip && seen->strip[i].owner == owner)
            return &seen->strip[i];
    return NULL;
}

void timeline_comps_free(timeline_comps *comps)
{
    for (uint32_t i = 0; comps && i < comps->count; ++i)
        take_finish(&comps->take[i]);
    free(comps);
}

/* ---- the thread ---- */

typedef struct order { /* what main last said */
    uint64_t show_number, wish_number;
    char *show_path, *face_path; /* copies, when the show is another one */
    bool is_other_show, ends;
} order;

static char *copy_of(const char *text)
{
    return text ? strdup(text) : NULL;
}

static void wait_until(timeline_worker *self, int64_t from_now_ns)
{
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_nsec += (long)from_now_ns;
    until.tv_sec += until.tv_nsec / 1000000000L;
    until.tv_nsec %= 1000000000L;
    (void)pthread_cond_timedwait(&self->wake, &self->lock, &until);
}

/* Waits while nothing is to be done: until something is said, or a recording may have gone on. */
static order take_order(timeline_worker *self, const order *last, bool is_idle, timeline_wish *wish)
{
    order out = *last;
    pthread_mutex_lock(&self->lock);
    if (is_idle && !self->ends && self->wish_number == last->wish_number &&
        self->show_number == last->show_number)
        wait_until(self, AGAIN_NS);
    out.ends = self->ends;
    out.is_other_show = self->show_number != last->show_number;
    out.show_path = out.is_other_show ? copy_of(self->show_path) : NULL;
    out.face_path = out.is_other_show ? copy_of(self->face_path) : NULL;
    out.show_number = self->show_number;
    out.wish_number = self->wish_number;
    if (self->wish_number != last->wish_number)
        *wish = self->wish;
    pthread_mutex_unlock(&self->lock);
    return out;
}

static void publish(timeline_worker *self, const timeline_wish *wish, bool is_complete)
{
    worker_desk_fill(&self->desk, wish, self->back);
    self->back->is_complete = is_complete;
    pthread_mutex_lock(&self->lock);
    timeline_seen *seen = self->ready;
    self->ready = self->back;
    self->is_fresh = true;
    pthread_mutex_unlock(&self->lock);
    self->back = seen;
}

static void publish_comps(timeline_worker *self, timeline_comps *comps)
{
    if (!comps)
        return;
    pthread_mutex_lock(&self->lock);
    timeline_comps *old = self->comps_ready;
    self->comps_ready = comps;
    self->has_comps = true;
    pthread_mutex_unlock(&self->lock);
    timeline_comps_free(old);
}

static void obey(timeline_worker *self, order *now)
{
    if (!now->is_other_show)
        return;
    worker_desk_close(&self->desk);
    worker_desk_open(&self->desk, now->show_path, now->face_path);
    free(now->show_path);
    free(now->face_path);
    now->show_path = now->face_path = NULL;
}

static void *run(void *data)
{
    timeline_worker *self = data;
    timeline_wish *wish = calloc(1, sizeof *wish);
    order last = {0};
    bool is_idle = false, was_idle = false;
    int64_t published_ns = 0, known_then = -1;
    (void)setpriority(PRIO_PROCESS, 0, NICENESS); /* on Linux: of this thread */
    while (wish) {
        order told = take_order(self, &last, is_idle, wish);
        bool is_new = told.wish_number != last.wish_number || told.is_other_show;
        last = told;
        if (told.ends) {
            free(told.show_path);
            free(told.face_path);
            break;
        }
        obey(self, &told);
        publish_comps(self, worker_desk_comps(&self->desk, wish));
        is_idle = !worker_desk_step(&self->desk, wish);
        int64_t now_ns = clock_now_ns(), known = worker_desk_known(&self->desk);
        bool is_due = is_idle || now_ns - published_ns > PUBLISH_NS;
        if (is_new || (is_due && (known != known_then || is_idle != was_idle))) {
            publish(self, wish, is_idle);
            published_ns = now_ns;
            known_then = known;
            was_idle = is_idle;
        }
    }
    free(wish);
    worker_desk_close(&self->desk);
    return NULL;
}

/* ---- [main] ---- */

timeline_worker *timeline_worker_create(plugin_list *plugins)
{
    timeline_worker *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->front = calloc(1, sizeof *self->front);
    self->ready = calloc(1, sizeof *self->ready);
    self->back = calloc(1, sizeof *self->back);
    self->desk.log = log_queue_create();
    self->desk.plugins = plugins;
    (void)pthread_mutex_init(&self->lock, NULL);
    (void)pthread_cond_init(&self->wake, NULL);
    if (self->front && self->ready && self->back && self->desk.log)
        return self;
    timeline_worker_destroy(self);
    return NULL;
}

void timeline_worker_destroy(timeline_worker *self)
{
    if (!self)
        return;
    pthread_mutex_lock(&self->lock);
    self->ends = true;
    (void)pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
    if (self->has_thread)
        (void)pthread_join(self->thread, NULL);
    (void)pthread_cond_destroy(&self->wake);
    (void)pthread_mutex_destroy(&self->lock);
    timeline_comps_free(self->comps);
    timeline_comps_free(self->comps_ready);
    if (self->desk.log)
        log_queue_destroy(self->desk.log);
    free(self->front);
    free(self->ready);
    free(self->back);
    free(self->show_path);
    free(self->face_path);
    free(self);
}

static bool is_same(const char *a, const char *b)
{
    return (!a && !b) || (a && b && strcmp(a, b) == 0);
}

void timeline_worker_set_show(timeline_worker *self, const char *show_path, const char *face_path)
{
    if (is_same(self->show_path, show_path) && is_same(self->face_path, face_path))
        return;
    char *show_copy = copy_of(show_path), *face_copy = copy_of(face_path);
    pthread_mutex_lock(&self->lock);
    free(self->show_path);
    free(self->face_path);
    self->show_path = show_copy;
    self->face_path = face_copy;
    self->show_number += 1;
    (void)pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
}

static bool is_same_strips(const timeline_wish *a, const timeline_wish *b)
{
    return a->strip_count == b->strip_count &&
           memcmp(a->strip, b->strip, a->strip_count * sizeof *a->strip) == 0;
}

static bool is_same_wish(const timeline_wish *a, const timeline_wish *b)
{
    return is_same_strips(a, b) && a->audio == b->audio && a->audio_from == b->audio_from &&
           a->audio_to == b->audio_to && a->audio_pairs == b->audio_pairs &&
           a->comps_of == b->comps_of && a->comps_edition == b->comps_edition &&
           a->spans_edition == b->spans_edition && strcmp(a->scene, b->scene) == 0 &&
           strcmp(a->shot, b->shot) == 0;
}

void timeline_worker_wish(timeline_worker *self, const timeline_wish *wish)
{
    if (is_same_wish(wish, &self->wished))
        return;
    self->wished = *wish;
    pthread_mutex_lock(&self->lock);
    self->wish = *wish;
    self->wish_number += 1;
    (void)pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
    if (!self->has_thread)
        self->has_thread = pthread_create(&self->thread, NULL, run, self) == 0;
}

const timeline_seen *timeline_worker_look(timeline_worker *self)
{
    pthread_mutex_lock(&self->lock);
    if (self->is_fresh) {
        timeline_seen *seen = self->front;
        self->front = self->ready;
        self->ready = seen;
        self->is_fresh = false;
    }
    pthread_mutex_unlock(&self->lock);
    return self->front;
}

const timeline_comps *timeline_worker_comps(timeline_worker *self)
{
    timeline_comps *old = NULL;
    pthread_mutex_lock(&self->lock);
    if (self->has_comps) {
        old = self->comps;
        self->comps = self->comps_ready;
        self->comps_ready = NULL;
        self->has_comps = false;
    }
    pthread_mutex_unlock(&self->lock);
    timeline_comps_free(old);
    return self->comps;
}
