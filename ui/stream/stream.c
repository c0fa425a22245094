#include "stream/stream.h"

#include "base/clock.h"
#include "base/slot.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PICTURES = 3 };
static const int64_t retry_ns = 2 * NS_PER_S;

struct stream_target {
    const stream_way *way;
    char target[STREAM_TARGET];
    stream_look look;
    publish_slot slot;
    uint8_t *picture[PICTURES];
    pthread_t thread;
    bool has_thread, has_mutex;
    pthread_mutex_t mutex; /* guards what follows */
    pthread_cond_t wake;
    bool is_new, stop;
    stream_status status;
};

/* ---- the thread ---- */

static bool wait_for_picture(stream_target *self)
{
    pthread_mutex_lock(&self->mutex);
    while (!self->is_new && !self->stop)
        pthread_cond_wait(&self->wake, &self->mutex);
    self->is_new = false;
    const bool goes_on = !self->stop;
    pthread_mutex_unlock(&self->mutex);
    return goes_on;
}

static void note(stream_target *self, bool is_open, const char *says)
{
    pthread_mutex_lock(&self->mutex);
    self->status.is_open = is_open;
    self->status.given += is_open;
    (void)snprintf(self->status.says, sizeof self->status.says, "%.*s", STREAM_SAYS - 1, says);
    pthread_mutex_unlock(&self->mutex);
}

static void *run(void *data)
{
    stream_target *self = data;
    void *way = NULL;
    int64_t again_ns = 0;
    while (wait_for_picture(self)) {
        error err = {""};
        if (!slot_take(&self->slot) || (!way && clock_now_ns() < again_ns))
            continue;
        mrt_result result = way ? MRT_OK : self->way->open(&way, self->target, &self->look, &err);
        if (result >= 0)
            result = self->way->give(way, self->picture[slot_front(&self->slot)], &err);
        note(self, result >= 0, result < 0 ? err.text : "");
        if (result >= 0)
            continue;
        if (way)
            self->way->close(way);
        way = NULL;
        again_ns = clock_now_ns() + retry_ns;
    }
    if (way)
        self->way->close(way);
    return NULL;
}

/* ---- [main] ---- */

static const stream_way *way_of(const char *target, error *err)
{
    if (strncmp(target, "srt://", 6) == 0 || strncmp(target, "udp://", 6) == 0)
        return &stream_ffmpeg;
    if (strncmp(target, "/dev/video", 10) == 0)
        return &stream_v4l2;
    if (strcmp(target, "pipewire") == 0 || strncmp(target, "pipewire:", 9) == 0) {
#ifdef MAROTTE_HAS_PIPEWIRE
        return &stream_pipewire;
#else
        error_set(
            err, MRT_ERR_UNSUPPORTED,
            "marotte was built without PipeWire (libpipewire-0.3-dev): take srt://, udp:// or "
            "/dev/videoN");
        return NULL;
#endif
    }
    error_set(err, MRT_ERR_ARGUMENT,
              "\"%.80s\" is no place for pictures: expected pipewire, /dev/videoN, "
              "srt://HOST:PORT or udp://HOST:PORT",
              target);
    return NULL;
}

static bool has_pictures(stream_target *self)
{
    bool has_all = true;
    for (int i = 0; i < PICTURES; ++i) {
        self->picture[i] = calloc((size_t)self->look.width * self->look.height, 4);
        has_all &= self->picture[i] != NULL;
    }
    return has_all;
}

mrt_result stream_open(stream_target **out, const char *target, const stream_look *look, error *err)
{
    const stream_way *way = way_of(target, err);
    *out = NULL;
    if (!way)
        return MRT_ERR_ARGUMENT;
    if (strlen(target) >= STREAM_TARGET)
        return error_set(err, MRT_ERR_ARGUMENT, "the address of a stream is too long");
    stream_target *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a stream");
    self->way = way;
    self->look = *look;
    (void)snprintf(self->target, sizeof self->target, "%s", target);
    slot_init(&self->slot);
    self->has_mutex = has_pictures(self) && pthread_mutex_init(&self->mutex, NULL) == 0 &&
                      pthread_cond_init(&self->wake, NULL) == 0;
    self->has_thread = self->has_mutex && pthread_create(&self->thread, NULL, run, self) == 0;
    if (!self->has_thread) {
        stream_close(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory, or no thread, for a stream");
    }
    *out = self;
    return MRT_OK;
}

void stream_close(stream_target *self)
{
    if (!self)
        return;
    if (self->has_thread) {
        pthread_mutex_lock(&self->mutex);
        self->stop = true;
        pthread_cond_signal(&self->wake);
        pthread_mutex_unlock(&self->mutex);
        (void)pthread_join(self->thread, NULL);
    }
    if (self->has_mutex) {
        pthread_cond_destroy(&self->wake);
        pthread_mutex_destroy(&self->mutex);
    }
    for (int i = 0; i < PICTURES; ++i)
        free(self->picture[i]);
    free(self);
}

uint8_t *stream_picture(stream_target *self)
{
    return self->picture[slot_back(&self->slot)];
}

void stream_give(stream_target *self)
{
    slot_publish(&self->slot);
    pthread_mutex_lock(&self->mutex);
    self->is_new = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->mutex);
}

stream_status stream_status_of(stream_target *self)
{
    pthread_mutex_lock(&self->mutex);
    const stream_status out = self->status;
    pthread_mutex_unlock(&self->mutex);
    return out;
}
