#include "stage/sound/sound_feed.h"
#include "base/clock.h"
#include "stage/input/wake.h"
#include "show/sound_render.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* interval between rounds; the ring holds a third of a second */
static const int64_t tick_ns = 20 * NS_PER_MS;
/* length of the fade out and in at the end of a loop */
static const double seam_s = 0.0025;
static const int64_t loop_least_ns = 20 * NS_PER_MS;

typedef struct order {
    take_audio audio;
    uint32_t edition;
} order;

struct sound_feed {
    ring *packets;
    const sound_board *board;
    const sound_follow *follow;
    char *show_path;
    sound_threads threads;
    pthread_t thread;
    wake wake;
    _Atomic bool is_stopping;
    pthread_mutex_t lock; /* guards `order` and `trouble` */
    order order;
    error trouble;
    /* owned by the feeder */
    show *show;
    sound_render *render;
    uint32_t edition, rate_hz; /* of the render */
    bool has_damage;
    sound_motion motion;
    int64_t next; /* next frame of the stream */
    unsigned char *record;
    bool is_owed; /* `record` waits for room in the ring */
};

/* ---- sound to play ---- */

static void note(sound_feed *self, const error *why)
{
    pthread_mutex_lock(&self->lock);
    self->trouble = *why;
    pthread_mutex_unlock(&self->lock);
}

static mrt_result load(sound_feed *self, const take_audio *wanted, error *err)
{
    mrt_result result = MRT_OK;
    if (!self->show)
        result = show_open(&self->show, self->show_path, SHOW_READ, err);
    if (result >= 0)
        result = sound_render_create(&self->render, self->show, wanted, self->rate_hz, err);
    if (result < 0)
        return result;
    if (sound_render_audio(self->render)->channel_count == self->follow->channel_count)
        return MRT_OK;
    sound_render_destroy(self->render);
    self->render = NULL;
    return error_set(err, MRT_ERR_FORMAT, "sound %lld: its number of channels has changed",
                     (long long)wanted->audio);
}

static void read_order(sound_feed *self)
{
    error why = {""};
    pthread_mutex_lock(&self->lock);
    order wanted = self->order;
    pthread_mutex_unlock(&self->lock);
    uint32_t rate_hz = atomic_load(&self->follow->rate_hz);
    if (wanted.edition == self->edition && rate_hz == self->rate_hz)
        return;
    self->edition = wanted.edition;
    self->rate_hz = rate_hz;
    self->next = 0;
    self->is_owed = false;
    self->has_damage = false;
    sound_render_destroy(self->render);
    self->render = NULL;
    if (wanted.audio.audio != 0)
        (void)load(self, &wanted.audio, &why); /* the error is stored in `trouble` */
    note(self, &why);
}

/* ---- the stream ---- */

static bool is_loop(const sound_motion *motion)
{
    return motion->loop_to_ns > motion->loop_from_ns && motion->at_ns < motion->loop_to_ns;
}

/* Position of a frame of the stream on the timeline, and its distance to the loop ends before and
 * after it. */
typedef struct cursor {
    int64_t frame, from_seam, to_seam;
} cursor;

static int64_t seam_of(const sound_motion *motion, uint32_t rate_hz, int64_t lap)
{
    double ns = (double)(motion->loop_to_ns - motion->at_ns) +
                (double)lap * (double)(motion->loop_to_ns - motion->loop_from_ns);
    return (int64_t)floor(ns * (double)rate_hz / 1e9 + 0.5);
}

static cursor cursor_of(const sound_motion *motion, uint32_t rate_hz, int64_t s)
{
    int64_t at = sound_render_frame(rate_hz, motion->at_ns);
    cursor out = {.frame = at + s, .from_seam = INT64_MAX, .to_seam = INT64_MAX};
    if (!is_loop(motion))
        return out;
    int64_t first = seam_of(motion, rate_hz, 0);
    out.to_seam = first - s;
    if (s < first)
        return out;
    double length = (double)(motion->loop_to_ns - motion->loop_from_ns) * (double)rate_hz / 1e9;
    int64_t lap = (int64_t)((double)(s - first) / length);
    while (seam_of(motion, rate_hz, lap) > s)
        lap -= 1;
    while (seam_of(motion, rate_hz, lap + 1) <= s)
        lap += 1;
    out.from_seam = s - seam_of(motion, rate_hz, lap);
    out.to_seam = seam_of(motion, rate_hz, lap + 1) - s;
    out.frame = sound_render_frame(rate_hz, motion->loop_from_ns) + out.from_seam;
    return out;
}

static void fade_seams(float *samples, uint32_t count, uint32_t channels, const cursor *at,
                       uint32_t rate_hz)
{
    int64_t length = (int64_t)(seam_s * (double)rate_hz) + 1;
    for (uint32_t i = 0; i < count; ++i) {
        int64_t to = at->to_seam - (int64_t)i;
        int64_t from = at->from_seam == INT64_MAX ? length : at->from_seam + (int64_t)i;
        int64_t near = from < to ? from : to;
        if (near >= length)
            continue;
        for (uint32_t c = 0; c < channels; ++c)
            samples[(size_t)i * channels + c] *= (float)near / (float)length;
    }
}

static void make_packet(sound_feed *self)
{
    uint32_t rate_hz = self->rate_hz, channels = self->follow->channel_count;
    float *samples = (float *)(void *)(self->record + sizeof(sound_packet));
    cursor at = cursor_of(&self->motion, rate_hz, self->next);
    sound_packet packet = {.revision = self->motion.revision,
                           .edition = self->motion.edition,
                           .first = self->next,
                           .count = SOUND_PACKET_FRAMES,
                           .rate_hz = rate_hz};
    error why = {""};
    if (at.to_seam < SOUND_PACKET_FRAMES)
        packet.count = (uint32_t)at.to_seam;
    if (sound_render_frames(self->render, at.frame, samples, packet.count, &why) < 0 &&
        !self->has_damage) {
        self->has_damage = true; /* the frames are silent; reported once */
        note(self, &why);
    }
    fade_seams(samples, packet.count, channels, &at, rate_hz);
    memcpy(self->record, &packet, sizeof packet);
    self->next += packet.count;
    self->is_owed = true;
}

/* ---- [feeder] ---- */

static void read_motion(sound_feed *self)
{
    sound_motion newest;
    if (!sound_board_read(self->board, &newest) ||
        sound_motion_key(&newest) == sound_motion_key(&self->motion))
        return;
    self->motion = newest;
    self->next = 0;
    self->is_owed = false;
}

/* Skips frames if the player is already further ahead because it started in the middle. */
static void catch_up(sound_feed *self)
{
    uint64_t key = atomic_load_explicit(&self->follow->wanted_key, memory_order_acquire);
    int64_t wanted = atomic_load_explicit(&self->follow->wanted, memory_order_relaxed);
    if (key != sound_motion_key(&self->motion) || wanted <= self->next + SOUND_PACKET_FRAMES)
        return;
    self->next = wanted;
    self->is_owed = false;
}

static bool is_to_play(const sound_feed *self)
{
    const sound_motion *motion = &self->motion;
    bool is_short = is_loop(motion) && motion->loop_to_ns - motion->loop_from_ns < loop_least_ns;
    return self->render && sound_motion_is_heard(motion) && !is_short &&
           motion->edition == self->edition;
}

void sound_feed_work(sound_feed *self)
{
    read_order(self);
    read_motion(self);
    if (!is_to_play(self))
        return;
    catch_up(self);
    for (int i = 0; i < SOUND_PACKETS + 1; ++i) {
        if (!self->is_owed)
            make_packet(self);
        if (!ring_push(self->packets, self->record))
            return;
        self->is_owed = false;
    }
}

static void *run(void *data)
{
    sound_feed *self = data;
    while (!atomic_load(&self->is_stopping)) {
        uint32_t seen = wake_seen(&self->wake);
        sound_feed_work(self);
        if (!atomic_load(&self->is_stopping))
            wake_wait_until_ns(&self->wake, seen, clock_now_ns() + tick_ns);
    }
    return NULL;
}

/* ---- [main] ---- */

void sound_feed_load(sound_feed *self, const take_audio *audio, uint32_t edition)
{
    pthread_mutex_lock(&self->lock);
    self->order = (order){*audio, edition};
    pthread_mutex_unlock(&self->lock);
    wake_signal(&self->wake);
}

void sound_feed_trouble(sound_feed *self, error *out)
{
    pthread_mutex_lock(&self->lock);
    *out = self->trouble;
    pthread_mutex_unlock(&self->lock);
}

static void free_feed(sound_feed *self)
{
    sound_render_destroy(self->render);
    show_close(self->show);
    pthread_mutex_destroy(&self->lock);
    free(self->record);
    free(self->show_path);
    free(self);
}

mrt_result sound_feed_create(sound_feed **out, const char *show_path, ring *packets,
                             const sound_board *board, const sound_follow *follow,
                             sound_threads threads, error *err)
{
    *out = NULL;
    sound_feed *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to play sound");
    self->packets = packets;
    self->board = board;
    self->follow = follow;
    self->threads = threads;
    pthread_mutex_init(&self->lock, NULL);
    wake_init(&self->wake);
    self->show_path = strdup(show_path);
    self->record = calloc(1, sound_follow_record_size(follow->channel_count));
    if (!self->show_path || !self->record ||
        (threads == SOUND_OWN_THREADS && pthread_create(&self->thread, NULL, run, self) != 0)) {
        free_feed(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory to play sound");
    }
    *out = self;
    return MRT_OK;
}

void sound_feed_destroy(sound_feed *self)
{
    if (!self)
        return;
    atomic_store(&self->is_stopping, true);
    wake_signal(&self->wake);
    if (self->threads == SOUND_OWN_THREADS)
        pthread_join(self->thread, NULL);
    free_feed(self);
}
