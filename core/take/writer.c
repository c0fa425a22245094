#include "take/writer.h"

#include "base/clock.h"
#include "take/writer_state.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
    RING_RECORDS = 32768, /* 100 s of two gloves, should the writer's thread stand still */
    DEFAULT_MEMORY_BYTES = 64 * 1024 * 1024,
    DEFAULT_JOURNAL_S = 30 * 60
};
static const int64_t commit_ns = 40 * NS_PER_MS;
static const int64_t retry_ns = 250 * NS_PER_MS;

/* ---- [frame] ---- */

int64_t writer_show_ns(const writer *self, int64_t time_ns)
{
    return time_ns + self->to_show_ns;
}

void writer_sample(writer *self, int64_t track, const mrt_sample *sample)
{
    writer_record r = {.kind = WRITER_RECORD_SAMPLE, .id = track, .of.sample = *sample};
    atomic_fetch_add_explicit(&self->given_samples, 1, memory_order_relaxed);
    if (!spool_push(self->ring, &r))
        atomic_fetch_add_explicit(&self->ring_lost_samples, 1, memory_order_relaxed);
}

void writer_event(writer *self, const take_event *event)
{
    writer_record r = {.kind = WRITER_RECORD_EVENT, .of.event = *event};
    if (!spool_push(self->ring, &r))
        atomic_fetch_add_explicit(&self->ring_lost_events, 1, memory_order_relaxed);
}

void *writer_checkpoint_buffer(writer *self)
{
    for (uint32_t i = 0; i < WRITER_CHECKPOINTS; ++i)
        if (self->checkpoint[i] &&
            !atomic_load_explicit(&self->is_taken[i], memory_order_acquire)) {
            atomic_store_explicit(&self->is_taken[i], true, memory_order_relaxed);
            return self->checkpoint[i];
        }
    return NULL;
}

void writer_checkpoint(writer *self, int64_t performance, int64_t time_ns, uint32_t version,
                       void *buffer, size_t size)
{
    uint32_t index = 0;
    while (index < WRITER_CHECKPOINTS && self->checkpoint[index] != buffer)
        ++index;
    if (index == WRITER_CHECKPOINTS)
        return;
    writer_record r = {.kind = WRITER_RECORD_CHECKPOINT, .id = performance};
    r.of.checkpoint.time_ns = time_ns;
    r.of.checkpoint.version = version;
    r.of.checkpoint.buffer = index;
    r.of.checkpoint.size = size;
    if (size > self->checkpoint_bytes || !spool_push(self->ring, &r))
        atomic_store_explicit(&self->is_taken[index], false, memory_order_release);
}

/* ---- the thread ---- */

static bool wait_for_work(writer *self, int64_t until_ns, uint64_t *out_flush)
{
    struct timespec until = {.tv_sec = (time_t)(until_ns / NS_PER_S),
                             .tv_nsec = (long)(until_ns % NS_PER_S)};
    pthread_mutex_lock(&self->lock);
    int woken = 0;
    while (!self->is_stopping && self->flush_asked == self->flush_done && woken != ETIMEDOUT)
        woken = pthread_cond_timedwait(&self->wake, &self->lock, &until);
    bool goes_on = !self->is_stopping;
    *out_flush = self->flush_asked;
    pthread_mutex_unlock(&self->lock);
    return goes_on;
}

static void answer(writer *self, uint64_t flush)
{
    pthread_mutex_lock(&self->lock);
    self->flush_done = flush;
    pthread_cond_broadcast(&self->done);
    pthread_mutex_unlock(&self->lock);
}

static void *run(void *data)
{
    writer *self = data;
    uint64_t flush;
    int64_t next_ns = clock_now_ns() + commit_ns;
    while (wait_for_work(self, next_ns, &flush)) {
        writer_in(self);
        mrt_result result = writer_commit(self);
        if (result >= 0)
            writer_commit_journal(self);
        next_ns = clock_now_ns() + (result < 0 ? retry_ns : commit_ns);
        answer(self, flush);
    }
    writer_in(self);
    writer_in_end(self);
    (void)writer_commit(self); /* writer_stop tells its result */
    return NULL;
}

/* ---- starting and stopping ---- */

static mrt_result begin_session(show *s, const writer_options *options, int64_t *out_id, error *err)
{
    char host[128] = "";
    if (gethostname(host, sizeof host - 1) != 0)
        host[0] = '\0';
    mrt_result result =
        sqlite_change(s->db, err,
                      "INSERT INTO session(utc_ns, monotonic_ns, program, host, process)"
                      "VALUES(?, ?, ?, ?, ?)",
                      "iitti", options->utc_ns, options->monotonic_ns,
                      options->program ? options->program : "", host, (int64_t)getpid());
    *out_id = result < 0 ? 0 : sqlite_last_id(s->db);
    return result;
}

static mrt_result allocate(writer *self, const writer_options *options, error *err)
{
    struct stat of = {.st_dev = self->of->device, .st_ino = self->of->inode};
    self->ring = spool_create(&of, sizeof(writer_record), RING_RECORDS, self->to_show_ns);
    bool good = self->ring != NULL;
    self->checkpoint_bytes = options->checkpoint_bytes;
    for (int i = 0; i < WRITER_CHECKPOINTS && good && options->checkpoint_bytes > 0; ++i) {
        self->checkpoint[i] = malloc(options->checkpoint_bytes);
        good = self->checkpoint[i] != NULL;
        if (good)
            memset(self->checkpoint[i], 0, options->checkpoint_bytes); /* its pages are there */
    }
    return good ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to record");
}

static void init_waiting(writer *self)
{
    pthread_condattr_t monotonic;
    pthread_condattr_init(&monotonic);
    pthread_condattr_setclock(&monotonic, CLOCK_MONOTONIC);
    pthread_cond_init(&self->wake, &monotonic);
    pthread_cond_init(&self->done, &monotonic);
    pthread_condattr_destroy(&monotonic);
    pthread_mutex_init(&self->lock, NULL);
}

static void destroy(writer *self)
{
    writer_sync_stop(self->sync);
    writer_store_close(&self->store);
    for (uint32_t i = 0; i < self->track_slots; ++i)
        writer_track_finish(&self->track[i]);
    free(self->track);
    writer_jobs_destroy(&self->pending);
    writer_jobs_destroy(&self->asked);
    for (int i = 0; i < WRITER_CHECKPOINTS; ++i)
        free(self->checkpoint[i]);
    spool_destroy(self->ring);
    pthread_cond_destroy(&self->wake);
    pthread_cond_destroy(&self->done);
    pthread_mutex_destroy(&self->lock);
    free(self);
}

mrt_result writer_start(writer **out, show *s, const writer_options *options, error *err)
{
    *out = NULL;
    mrt_result result = show_check_writable(s, err);
    if (result < 0)
        return result;
    writer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to record", s->path);
    self->of = s;
    self->to_show_ns = options->utc_ns - options->monotonic_ns;
    self->newest_ns = options->monotonic_ns;
    self->committed_ns = options->monotonic_ns;
    self->memory_bytes = options->memory_bytes ? options->memory_bytes : DEFAULT_MEMORY_BYTES;
    self->old.length_ns =
        options->journal_ns > 0 ? options->journal_ns : DEFAULT_JOURNAL_S * NS_PER_S;
    init_waiting(self);
    int64_t session, last_chunk;
    result = allocate(self, options, err);
    if (result >= 0)
        result = sqlite_number(s->db, "SELECT MAX(id) FROM chunk", 0, &last_chunk, err);
    if (result >= 0)
        result = begin_session(s, options, &session, err);
    if (result >= 0)
        result = writer_store_open(&self->store, s, session, err);
    if (result >= 0)
        result = writer_sync_start(&self->sync, s, err);
    if (result >= 0) {
        self->next_chunk_id = last_chunk + 1;
        if (pthread_create(&self->thread, NULL, run, self) != 0)
            result = error_set(err, MRT_ERR_MEMORY, "%s: no thread to record with", s->path);
    }
    if (result < 0) {
        destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

/* What could not be written is found again by the next one who opens the show, as after a kill. */
static void tell_left(const writer *self, error *err)
{
    uint32_t count = writer_status_of(self).backlog, left = spool_left_count(self->ring);
    if (left == 0)
        error_set(err, self->last_result, "%u samples could not be written: %s", count,
                  self->last_error.text);
    else
        error_set(err, self->last_result,
                  "%u samples could not be written: %s; %s of them are kept in this computer's "
                  "memory until it is switched off, and are written when the show is next changed",
                  count, self->last_error.text, left >= count ? "all" : "the newest");
}

mrt_result writer_stop(writer *self, error *err)
{
    if (!self)
        return MRT_OK;
    pthread_mutex_lock(&self->lock);
    self->is_stopping = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
    pthread_join(self->thread, NULL);
    mrt_result result = MRT_OK;
    if (writer_commit_is_due(self)) {
        result = self->last_result;
        tell_left(self, err);
        spool_abandon(self->ring);
        self->ring = NULL;
    }
    destroy(self);
    return result;
}

/* ---- [main] ---- */

static mrt_result ask(writer *self, writer_job *job, mrt_result result, error *err)
{
    if (!job)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record what happened");
    if (result < 0) {
        writer_job_destroy(job);
        return result;
    }
    pthread_mutex_lock(&self->lock);
    writer_jobs_add(&self->asked, job);
    pthread_mutex_unlock(&self->lock);
    return MRT_OK;
}

mrt_result writer_add_track(writer *self, take_track *track, error *err)
{
    if (track->channel_count == 0 || track->channel_count > MRT_MAX_CHANNELS)
        return error_set(err, MRT_ERR_ARGUMENT, "a track of %u channels, 1 to %d are possible",
                         track->channel_count, MRT_MAX_CHANNELS);
    if (self->track_count == WRITER_TRACKS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%d tracks are recorded at a time, not more",
                         WRITER_TRACKS_MAX);
    track->id = show_next_id(self->of, SHOW_ID_TRACK);
    writer_job *job = writer_job_create(WRITER_JOB_TRACK);
    mrt_result result = job ? writer_job_copy_track(job, track, err) : MRT_OK;
    result = ask(self, job, result, err);
    self->track_count += result >= 0;
    return result;
}

mrt_result writer_end_track(writer *self, int64_t track, error *err)
{
    writer_job *job = writer_job_create(WRITER_JOB_TRACK_END);
    if (job)
        job->id = track;
    mrt_result result = ask(self, job, MRT_OK, err);
    self->track_count -= result >= 0 && self->track_count > 0;
    return result;
}

mrt_result writer_begin_performance(writer *self, take_performance *performance, int64_t time_ns,
                                    error *err)
{
    if (performance->track_count > TAKE_TRACKS_MAX || performance->param_count > TAKE_PARAMS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a performance of %u tracks and %u parameters, %d and %d are possible",
                         performance->track_count, performance->param_count, TAKE_TRACKS_MAX,
                         TAKE_PARAMS_MAX);
    performance->id = show_next_id(self->of, SHOW_ID_PERFORMANCE);
    writer_job *job = writer_job_create(WRITER_JOB_PERFORMANCE);
    mrt_result result = job ? writer_job_copy_performance(job, performance, err) : MRT_OK;
    if (job)
        job->from_ns = writer_show_ns(self, time_ns);
    return ask(self, job, result, err);
}

mrt_result writer_end_performance(writer *self, int64_t time_ns, error *err)
{
    writer_job *job = writer_job_create(WRITER_JOB_PERFORMANCE_END);
    if (job)
        job->from_ns = writer_show_ns(self, time_ns);
    return ask(self, job, MRT_OK, err);
}

static writer_job *slated_job(writer *self, writer_job_kind kind, const writer_slate *slate,
                              int64_t from_ns, int64_t to_ns)
{
    writer_job *job = writer_job_create(kind);
    if (!job)
        return NULL;
    job->id = show_next_id(self->of, SHOW_ID_TAKE);
    job->from_ns = writer_show_ns(self, from_ns);
    job->to_ns = writer_show_ns(self, to_ns);
    job->of.slate.number = slate->number;
    snprintf(job->of.slate.scene, sizeof job->of.slate.scene, "%s",
             slate->scene ? slate->scene : "");
    snprintf(job->of.slate.shot, sizeof job->of.slate.shot, "%s", slate->shot ? slate->shot : "");
    return job;
}

mrt_result writer_take_begin(writer *self, int64_t time_ns, const writer_slate *slate,
                             int64_t *out_take, error *err)
{
    writer_job *job = slated_job(self, WRITER_JOB_TAKE, slate, time_ns, time_ns);
    *out_take = job ? job->id : 0;
    return ask(self, job, MRT_OK, err);
}

mrt_result writer_take_end(writer *self, int64_t take_id, int64_t time_ns, error *err)
{
    writer_job *job = writer_job_create(WRITER_JOB_TAKE_END);
    if (job) {
        job->id = take_id;
        job->to_ns = writer_show_ns(self, time_ns);
    }
    return ask(self, job, MRT_OK, err);
}

mrt_result writer_keep(writer *self, int64_t from_ns, int64_t to_ns, const writer_slate *slate,
                       int64_t *out_take, error *err)
{
    *out_take = 0;
    if (to_ns <= from_ns)
        return error_set(err, MRT_ERR_ARGUMENT, "what is to be kept ends before it starts");
    writer_job *job = slated_job(self, WRITER_JOB_KEEP, slate, from_ns, to_ns);
    *out_take = job ? job->id : 0;
    return ask(self, job, MRT_OK, err);
}

mrt_result writer_mark(writer *self, int64_t time_ns, const char *text, error *err)
{
    writer_job *job = writer_job_create(WRITER_JOB_EVENT);
    if (job) {
        job->of.event =
            (take_event){.time_ns = writer_show_ns(self, time_ns), .kind = TAKE_EVENT_MARK};
        snprintf(job->of.event.text, sizeof job->of.event.text, "%s", text);
    }
    return ask(self, job, MRT_OK, err);
}

mrt_result writer_audio(writer *self, int64_t audio, int64_t time_ns, const void *frames,
                        size_t size, error *err)
{
    if (atomic_load(&self->held_bytes) >= self->memory_bytes)
        return error_set(err, MRT_ERR_MEMORY,
                         "audio is lost: the disk is full and so is what is held in memory");
    writer_job *job = writer_job_create(WRITER_JOB_AUDIO);
    mrt_result result = job ? writer_job_copy_bytes(job, frames, size, err) : MRT_OK;
    if (job) {
        job->id = audio;
        job->from_ns = time_ns != 0 ? writer_show_ns(self, time_ns) : 0;
    }
    return ask(self, job, result, err);
}

mrt_result writer_flush(writer *self, error *err)
{
    pthread_mutex_lock(&self->lock);
    uint64_t mine = ++self->flush_asked;
    pthread_cond_signal(&self->wake);
    while (self->flush_done < mine)
        pthread_cond_wait(&self->done, &self->lock);
    mrt_result result = self->last_result;
    if (result < 0)
        error_set(err, result, "%s", self->last_error.text);
    pthread_mutex_unlock(&self->lock);
    return result;
}

/* ---- [any] ---- */

writer_status writer_status_of(const writer *self)
{
    return (writer_status){
        .state = (writer_state)atomic_load(&self->state),
        .is_missing = writer_sync_is_missing(self->sync),
        .backlog = atomic_load(&self->given_samples) - atomic_load(&self->taken_samples),
        .committed_count = atomic_load(&self->committed_count),
        .lost_count = atomic_load(&self->lost_count),
        .lost_event_count = atomic_load(&self->lost_event_count),
        .held_bytes = atomic_load(&self->held_bytes),
        .committed_ns = atomic_load(&self->committed_ns),
    };
}

void writer_message(writer *self, char *out, size_t capacity)
{
    writer_status status = writer_status_of(self);
    pthread_mutex_lock(&self->lock);
    if (self->last_result < 0)
        (void)snprintf(out, capacity, "%s (%u samples are held in memory, %llu are lost)",
                       self->last_error.text, status.backlog,
                       (unsigned long long)status.lost_count);
    else if (status.is_missing)
        (void)snprintf(out, capacity,
                       "%s: was deleted, moved or replaced while it is open; recording goes on, "
                       "and a copy will be made when it ends",
                       show_path(self->of));
    else if (status.lost_count > 0)
        (void)snprintf(out, capacity, "%s: %llu samples were lost", show_path(self->of),
                       (unsigned long long)status.lost_count);
    else if (status.lost_event_count > 0)
        (void)snprintf(out, capacity,
                       "%s: %llu changes of parameters were lost: what follows them is performed "
                       "otherwise than it was seen",
                       show_path(self->of), (unsigned long long)status.lost_event_count);
    else
        (void)snprintf(out, capacity, "%s", "");
    pthread_mutex_unlock(&self->lock);
}
