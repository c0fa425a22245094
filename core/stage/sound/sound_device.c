#include "stage/sound/sound_device.h"
#include "base/clock.h"
#include "base/condition.h"
#include "base/log.h"
#include "base/slot.h"
#include "base/trace.h"
#include "stage/input/wake.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A device that delivers no block for this time has stopped, even if it reports otherwise. */
static const int64_t silent_max_ns = 3 * NS_PER_S;
static const int64_t watch_span_ns = 100 * NS_PER_MS, patience_ns = 2 * NS_PER_S;
/* Maximum time to wait for a device that does not answer when the program is closed. */
enum { DESTROY_WAIT_S = 3 };

typedef struct want {
    bool is_wanted;
    sound_request request;
} want;

struct sound_device {
    sound_direction direction;
    sound_backend backend;
    sound_user user;
    log_queue *log;
    sound_threads threads;
    pthread_t thread;
    wake wake;
    publish_slot want_slot, status_slot;
    want wants[3];
    sound_device_status statuses[3];
    /* owned by the opener */
    want want;
    sound_device_status status;
    bool is_open;
    void *handle;
    int64_t next_try_ns, last_block_ns;
    uint64_t last_block;
    log_once logged;
    /* shared by the threads */
    _Atomic bool is_stopping, is_closed; /* is_closed: blocks do not reach the user any more */
    _Atomic uint32_t inside;             /* number of blocks that the user is processing */
    _Atomic uint64_t block_count;
    pthread_mutex_t lock; /* guards the following members, the log and user.opened */
    pthread_cond_t done;
    bool is_abandoned, is_done;
};

/* ---- blocks [device] ---- */

/* Sequentially consistent: either the block sees is_closed, or the closing thread sees `inside`. */
static void pass_block(void *data, const sound_block *block)
{
    sound_device *self = data;
    atomic_fetch_add(&self->inside, 1);
    if (!atomic_load(&self->is_closed)) {
        self->user.block(self->user.data, block);
        atomic_fetch_add_explicit(&self->block_count, 1, memory_order_relaxed);
    } else if (block->out) {
        memset(block->out, 0,
               (size_t)block->frame_count * self->status.stream.channel_count * sizeof *block->out);
    }
    atomic_fetch_sub(&self->inside, 1);
}

/* ---- the opener ---- */

static void publish(sound_device *self)
{
    sound_device_status *out = &self->statuses[slot_back(&self->status_slot)];
    *out = self->status;
    out->stream.handle = NULL;
    slot_publish(&self->status_slot);
}

static void close_stream(sound_device *self)
{
    if (self->is_open) {
        TRACE(TRACE_SOUND, "a device is closed");
        self->backend.close(self->backend.self, self->handle);
    }
    self->is_open = false;
    self->handle = NULL;
}

/* After is_abandoned is set, the log and the user may not exist any more. */
static void log_error(sound_device *self, const error *why)
{
    pthread_mutex_lock(&self->lock);
    if (!self->is_abandoned && self->log)
        log_push(self->log, MRT_LOG_WARNING, "sound", why->text);
    pthread_mutex_unlock(&self->lock);
}

static mrt_result call_opened(sound_device *self, error *err)
{
    mrt_result result = MRT_ERR_IO;
    pthread_mutex_lock(&self->lock);
    if (!self->is_abandoned)
        result = self->user.opened(self->user.data, &self->status.stream, err);
    pthread_mutex_unlock(&self->lock);
    return result;
}

static void go_away(sound_device *self, const error *why, int64_t now_ns)
{
    close_stream(self);
    self->status.state = SOUND_DEVICE_AWAY;
    snprintf(self->status.text, sizeof self->status.text, "%.*s", (int)sizeof self->status.text - 1,
             why->text);
    self->next_try_ns = now_ns + patience_ns;
    if (!log_once_repeats(&self->logged, why->text))
        log_error(self, why);
    publish(self);
}

static void open_stream(sound_device *self, int64_t now_ns)
{
    error why = {""};
    sound_stream stream = {0};
    mrt_result result = self->backend.open(self->backend.self, self->direction, &self->want.request,
                                           pass_block, self, &stream, &why);
    if (result < 0) {
        go_away(self, &why, now_ns);
        return;
    }
    self->is_open = true;
    self->handle = stream.handle;
    self->status.stream = stream;
    TRACE(TRACE_SOUND, "a device is open: %u channels at %u Hz",
          (unsigned)self->status.stream.channel_count, (unsigned)self->status.stream.rate_hz);
    result = call_opened(self, &why);
    if (result >= 0)
        result = self->backend.start(self->backend.self, self->handle, &why);
    if (result < 0) {
        go_away(self, &why, now_ns);
        return;
    }
    self->last_block_ns = now_ns;
    self->last_block = atomic_load(&self->block_count);
    self->status.state = SOUND_DEVICE_RUNNING;
    self->status.text[0] = '\0';
    log_once_reset(&self->logged);
    publish(self);
}

static bool is_silent(sound_device *self, int64_t now_ns)
{
    uint64_t count = atomic_load(&self->block_count);
    if (count != self->last_block) {
        self->last_block = count;
        self->last_block_ns = now_ns;
    }
    return now_ns - self->last_block_ns > silent_max_ns;
}

static void watch(sound_device *self, int64_t now_ns)
{
    error why = {""};
    if (self->backend.is_alive(self->backend.self, self->handle) && !is_silent(self, now_ns))
        return;
    (void)error_set(&why, MRT_ERR_IO,
                    "sound: '%.80s' has stopped, maybe it was unplugged. It is used again when it "
                    "is connected.",
                    self->status.stream.name);
    self->status.lost_count += 1;
    go_away(self, &why, now_ns);
}

static bool is_same(const want *a, const want *b)
{
    return a->is_wanted == b->is_wanted && a->request.rate_hz == b->request.rate_hz &&
           a->request.channel_count == b->request.channel_count &&
           a->request.number == b->request.number && strcmp(a->request.name, b->request.name) == 0;
}

static void read_want(sound_device *self)
{
    if (!slot_receive(&self->want_slot))
        return;
    want newest = self->wants[slot_front(&self->want_slot)];
    if (is_same(&newest, &self->want))
        return;
    self->want = newest;
    close_stream(self);
    self->status.state = SOUND_DEVICE_OFF;
    self->status.text[0] = '\0';
    self->next_try_ns = INT64_MIN;
    log_once_reset(&self->logged);
    publish(self);
}

int64_t sound_device_work(sound_device *self, int64_t now_ns)
{
    if (atomic_load(&self->is_stopping)) {
        close_stream(self);
        return INT64_MAX;
    }
    read_want(self);
    if (self->is_open)
        watch(self, now_ns);
    else if (self->want.is_wanted && now_ns >= self->next_try_ns)
        open_stream(self, now_ns);
    return now_ns + watch_span_ns;
}

static void *run(void *data)
{
    sound_device *self = data;
    while (!atomic_load(&self->is_stopping)) {
        uint32_t seen = wake_seen(&self->wake);
        int64_t until_ns = sound_device_work(self, clock_now_ns());
        if (!atomic_load(&self->is_stopping))
            wake_wait_until_ns(&self->wake, seen, until_ns);
    }
    close_stream(self);
    pthread_mutex_lock(&self->lock);
    self->is_done = true;
    pthread_cond_signal(&self->done);
    pthread_mutex_unlock(&self->lock);
    return NULL;
}

/* ---- [main] ---- */

void sound_device_want(sound_device *self, const sound_request *request)
{
    want *out = &self->wants[slot_back(&self->want_slot)];
    *out = (want){.is_wanted = true, .request = *request};
    slot_publish(&self->want_slot);
    wake_signal(&self->wake);
}

void sound_device_leave(sound_device *self)
{
    atomic_store(&self->is_stopping, true);
    wake_signal(&self->wake);
}

bool sound_device_has_left(sound_device *self)
{
    if (self->threads == SOUND_BY_CALLER)
        return atomic_load(&self->is_stopping) && !self->is_open;
    pthread_mutex_lock(&self->lock);
    bool has = self->is_done;
    pthread_mutex_unlock(&self->lock);
    return has;
}

const sound_device_status *sound_device_read_status(sound_device *self)
{
    (void)slot_receive(&self->status_slot);
    return &self->statuses[slot_front(&self->status_slot)];
}

static void free_device(sound_device *self)
{
    pthread_cond_destroy(&self->done);
    pthread_mutex_destroy(&self->lock);
    free(self);
}

mrt_result sound_device_create(sound_device **out, sound_direction direction,
                               const sound_backend *backend, const sound_user *user, log_queue *log,
                               sound_threads threads, error *err)
{
    *out = NULL;
    sound_device *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for sound");
    self->direction = direction;
    self->backend = *backend;
    self->user = *user;
    self->log = log;
    self->threads = threads;
    wake_init(&self->wake);
    slot_init(&self->want_slot);
    slot_init(&self->status_slot);
    pthread_mutex_init(&self->lock, NULL);
    condition_init(&self->done);
    if (threads == SOUND_OWN_THREADS && pthread_create(&self->thread, NULL, run, self) != 0) {
        free_device(self);
        return error_set(err, MRT_ERR_MEMORY, "cannot create the thread for sound");
    }
    *out = self;
    return MRT_OK;
}

static bool wait_until_done(sound_device *self)
{
    const int64_t until_ns = clock_now_ns() + DESTROY_WAIT_S * NS_PER_S;
    pthread_mutex_lock(&self->lock);
    while (!self->is_done && condition_wait(&self->done, &self->lock, until_ns))
        continue;
    self->is_abandoned = !self->is_done;
    bool is_done = self->is_done;
    pthread_mutex_unlock(&self->lock);
    return is_done;
}

bool sound_device_destroy(sound_device *self)
{
    if (!self)
        return true;
    atomic_store(&self->is_closed, true);
    while (atomic_load(&self->inside) > 0)
        continue; /* a block takes microseconds */
    if (self->threads == SOUND_BY_CALLER) {
        close_stream(self);
        free_device(self);
        return true;
    }
    atomic_store(&self->is_stopping, true);
    wake_signal(&self->wake);
    if (!wait_until_done(self)) {
        pthread_detach(self->thread);
        return false;
    }
    pthread_join(self->thread, NULL);
    free_device(self);
    return true;
}
