#include "show/writer.h"

#include "base/clock.h"
#include "base/condition.h"
#include "base/trace.h"
#include "show/writer_store.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- syncing: a separate thread waits for the disk. Once a second it syncs the commits to the
 * disk, moves a long write-ahead log into the show, and checks that the file still exists ---- */

enum { LOG_BYTES_LONG = 8 * 1024 * 1024 };

typedef struct writer_sync {
    const show *of;
    sqlite *db;
    char *log_path;
    int log_fd; /* -1: does not exist yet */
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t wake;
    bool is_stopping;        /* GUARDED_BY(lock) */
    _Atomic bool is_missing; /* the file at the show's path is not the open one */
} writer_sync;

/* The log stays one file while a connection is open. It is not locked, so closing its descriptor
 * releases no lock of SQLite. Closing a descriptor of the show itself would. */
static off_t log_size(writer_sync *self)
{
    struct stat status;
    if (self->log_fd < 0)
        self->log_fd = os_open(self->log_path, OS_READ);
    return self->log_fd >= 0 && fstat(self->log_fd, &status) == 0 ? status.st_size : 0;
}

/* Ignores failures: the writer's thread meets them too, because it writes to the same disk. */
static void bring_to_disk(writer_sync *self)
{
    off_t size = log_size(self);
    if (size > 0)
        (void)os_sync(self->log_fd);
    if (size > LOG_BYTES_LONG && sqlite_checkpoint(self->db, NULL) < 0)
        return;
}

static bool wait_a_second(writer_sync *self)
{
    const int64_t until_ns = clock_now_ns() + NS_PER_S;
    pthread_mutex_lock(&self->lock);
    while (!self->is_stopping && condition_wait(&self->wake, &self->lock, until_ns))
        continue;
    bool goes_on = !self->is_stopping;
    pthread_mutex_unlock(&self->lock);
    return goes_on;
}

static void *run_sync(void *data)
{
    writer_sync *self = data;
    while (wait_a_second(self)) {
        bring_to_disk(self);
        atomic_store(&self->is_missing, show_is_missing(self->of));
    }
    return NULL;
}

static void destroy_sync(writer_sync *self)
{
    sqlite_close(self->db);
    if (self->log_fd >= 0)
        close(self->log_fd);
    pthread_cond_destroy(&self->wake);
    pthread_mutex_destroy(&self->lock);
    free(self->log_path);
    free(self);
}

static mrt_result writer_sync_start(writer_sync **out, const show *s, error *err)
{
    *out = NULL;
    writer_sync *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", show_path(s));
    self->of = s;
    self->log_fd = -1;
    condition_init(&self->wake);
    pthread_mutex_init(&self->lock, NULL);
    mrt_result result = show_connect(s, &self->db, err);
    self->log_path = show_beside(show_path(s), "-wal");
    if (result >= 0 && !self->log_path)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", show_path(s));
    if (result >= 0 && pthread_create(&self->thread, NULL, run_sync, self) != 0)
        result =
            error_set(err, MRT_ERR_MEMORY, "%s: cannot start a thread for recording", show_path(s));
    if (result < 0) {
        destroy_sync(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static void writer_sync_stop(writer_sync *self)
{
    if (!self)
        return;
    pthread_mutex_lock(&self->lock);
    self->is_stopping = true;
    pthread_cond_signal(&self->wake);
    pthread_mutex_unlock(&self->lock);
    pthread_join(self->thread, NULL);
    destroy_sync(self);
}

/* ---- the writer ---- */

enum { WRITER_STAGED = 512 };

typedef struct writer_jobs {
    writer_job *first, **end; /* a list; `end` points to where the next job is linked */
} writer_jobs;

/* A preallocated job for a thread that may not allocate. */
typedef struct writer_lent {
    writer_job job;
    _Atomic bool is_taken;
} writer_lent;

typedef union writer_room { /* track or performance of a job with texts */
    take_track track;
    take_performance performance;
} writer_room;

struct writer {
    show *of;
    int64_t to_show_ns; /* show time - host clock */
    size_t memory_bytes, checkpoint_bytes;
    pthread_t thread;
    writer_sync *sync;

    /* from [frame] to the writer's thread */
    spool *ring;
    uint8_t *checkpoint[WRITER_CHECKPOINTS];
    _Atomic bool is_taken[WRITER_CHECKPOINTS];
    _Atomic uint32_t ring_lost_samples, ring_lost_events, given_samples;

    bool has_place[SPOOL_LANES]; /* [main] adds an input */

    _Atomic uint32_t track_count; /* [main], and who records */

    /* from [any] to the writer's thread: a lock-free stack, so no caller waits */
    _Atomic(writer_job *) asked; /* the newest; `next` is the one pushed before it */
    writer_lent *lent;           /* WRITER_WAITING_MAX; the first ones have space for texts */
    writer_room *room;           /* WRITER_WAITING_TEXTS_MAX */

    /* shared by [main] and the writer's thread */
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    uint64_t flush_asked;   /* GUARDED_BY(lock) */
    uint64_t flush_done;    /* GUARDED_BY(lock) */
    bool is_stopping;       /* GUARDED_BY(lock) */
    mrt_result last_result; /* GUARDED_BY(lock): of the last commit */
    error last_error;       /* GUARDED_BY(lock) */

    /* used only by the writer's thread */
    writer_store store;
    writer_jobs pending;
    writer_track *track; /* track_slots of them; id 0: free */
    uint32_t track_slots;
    int64_t next_chunk_id;
    journal old;
    int64_t next_journal_ns; /* show time */
    int64_t newest_ns;       /* host clock of the newest accepted sample */
    bool has_newest;
    writer_jobs ending;                        /* tracks that end once the ring is empty */
    uint32_t ring_lost_seen, ring_lost_untold; /* of ring_lost_samples */
    uint32_t events_lost_seen, events_lost_untold;
    writer_record staged[WRITER_STAGED];

    /* [any] */
    _Atomic int32_t state;
    _Atomic uint64_t committed_count, lost_count, lost_event_count;
    _Atomic uint32_t taken_samples; /* committed or lost */
    _Atomic size_t held_bytes;
    _Atomic int64_t committed_ns;
};

/* ---- lists of jobs ---- */

static void jobs_init(writer_jobs *list)
{
    *list = (writer_jobs){.first = NULL, .end = NULL};
}

static void jobs_add(writer_jobs *list, writer_job *job)
{
    job->next = NULL;
    if (list->first)
        *list->end = job;
    else
        list->first = job;
    list->end = &job->next;
}

static void jobs_destroy(writer_jobs *list)
{
    while (list->first) {
        writer_job *job = list->first;
        list->first = job->next;
        writer_job_destroy(job);
    }
    jobs_init(list);
}

static writer_job *jobs_take(writer_jobs *list)
{
    writer_job *job = list->first;
    if (job)
        list->first = job->next;
    return job;
}

/* ---- input: from the recording thread and the main thread to jobs and tracks ---- */

static void hold(writer *self, writer_job *job)
{
    jobs_add(&self->pending, job);
    atomic_fetch_add(&self->held_bytes, job->held_bytes);
}

static bool has_memory(const writer *self)
{
    return atomic_load(&self->held_bytes) < self->memory_bytes;
}

static writer_track *find_track(writer *self, int64_t id)
{
    for (uint32_t i = 0; i < self->track_slots; ++i)
        if (self->track[i].id == id)
            return &self->track[i];
    return NULL;
}

static void lose_samples(writer *self, writer_track *track, uint32_t count)
{
    if (track)
        track->lost_count += count;
    atomic_fetch_add(&self->lost_count, count);
    atomic_fetch_add(&self->taken_samples, count);
}

/* Queues the unwritten part of the chunk as a job. If memory runs out, that part is lost. */
static void seal(writer *self, writer_track *track)
{
    bool failed = !has_memory(self);
    uint32_t open_count = track->count - track->committed_count;
    writer_job *job = failed ? NULL : writer_track_seal(track, self->next_chunk_id, &failed);
    if (job) {
        if (job->id == self->next_chunk_id)
            self->next_chunk_id = show_next_id(self->of, SHOW_ID_CHUNK);
        hold(self, job);
    }
    if (failed)
        lose_samples(self, track, open_count);
    writer_track_next_chunk(track, job || track->committed_count > 0);
}

static void take_sample(writer *self, int64_t id, const mrt_sample *sample)
{
    writer_track *track = id > 0 ? find_track(self, id) : NULL;
    if (!track || !writer_track_accepts(track, sample)) {
        lose_samples(self, track, 1);
        return;
    }
    int64_t show_ns = writer_show_ns(self, sample->time_ns);
    if (writer_track_is_full(track, show_ns))
        seal(self, track);
    track->sample[track->count] = *sample;
    track->sample[track->count++].time_ns = show_ns;
    track->last_ns = sample->time_ns;
    track->has_last = true;
    if (!self->has_newest || sample->time_ns > self->newest_ns)
        self->newest_ns = sample->time_ns;
    self->has_newest = true;
}

static void lose_events(writer *self, uint32_t count)
{
    self->events_lost_untold += count;
    atomic_fetch_add(&self->lost_event_count, count);
}

static void take_event_in(writer *self, const take_event *event)
{
    bool is_fit = has_memory(self) && writer_track_is_time(event->time_ns);
    writer_job *job = is_fit ? writer_job_create(WRITER_JOB_EVENT) : NULL;
    if (!job) {
        lose_events(self, 1);
        return;
    }
    job->of.event = *event;
    job->of.event.time_ns = writer_show_ns(self, event->time_ns);
    hold(self, job);
}

static void take_checkpoint(writer *self, const writer_record *r)
{
    uint32_t index = r->of.checkpoint.buffer;
    bool may_hold = atomic_load(&self->held_bytes) < self->memory_bytes / 2 &&
                    writer_track_is_time(r->of.checkpoint.time_ns);
    writer_job *job = may_hold ? writer_job_create(WRITER_JOB_CHECKPOINT) : NULL;
    if (job && show_checkpoint_pack(&job->of.checkpoint, self->checkpoint[index],
                                    r->of.checkpoint.size, NULL) < 0) {
        writer_job_destroy(job);
        job = NULL;
    }
    atomic_store_explicit(&self->is_taken[index], false, memory_order_release);
    if (!job)
        return;
    job->of.checkpoint.performance = r->id;
    job->of.checkpoint.time_ns = writer_show_ns(self, r->of.checkpoint.time_ns);
    job->of.checkpoint.version = r->of.checkpoint.version;
    job->held_bytes += job->of.checkpoint.size;
    hold(self, job);
}

static void take_record(writer *self, const writer_record *r)
{
    switch (r->kind) {
    case WRITER_RECORD_SAMPLE:
        take_sample(self, r->id, &r->of.sample);
        break;
    case WRITER_RECORD_EVENT:
        take_event_in(self, &r->of.event);
        break;
    case WRITER_RECORD_CHECKPOINT:
        take_checkpoint(self, r);
        break;
    }
}

/* Returns a free track; NULL: no memory. Tracks end later than new ones begin, so there can be more
 * than WRITER_TRACKS_MAX. */
static writer_track *free_track(writer *self)
{
    writer_track *found = find_track(self, 0);
    if (found)
        return found;
    uint32_t count = self->track_slots ? 2 * self->track_slots : 8;
    writer_track *larger = realloc(self->track, count * sizeof *larger);
    if (!larger)
        return NULL;
    self->track = larger;
    for (uint32_t i = self->track_slots; i < count; ++i)
        self->track[i] = (writer_track){0};
    found = &self->track[self->track_slots];
    self->track_slots = count;
    return found;
}

/* Processes a queued job. A track exists from its job on, and ends when the ring is empty. If there
 * is no memory for a track, its samples count as lost. */
static void accept_job(writer *self, writer_job *asked)
{
    /* A lent job must be returned immediately. Without memory for a copy it is kept until it is
     * written. */
    writer_job *job = asked->lent ? writer_job_own(asked) : asked;
    if (!job)
        job = asked;
    if (job->kind == WRITER_JOB_TRACK_END) {
        jobs_add(&self->ending, job);
        return;
    }
    writer_track *track = job->kind == WRITER_JOB_TRACK ? free_track(self) : NULL;
    if (track && writer_track_init(track, job->id, job->of.track->channel_count, NULL) < 0)
        *track = (writer_track){0};
    hold(self, job);
}

static void end_track(writer *self, writer_job *job)
{
    writer_track *track = find_track(self, job->id);
    if (track) {
        seal(self, track);
        job->of.chunk_count = track->ordinal;
        writer_track_finish(track);
    }
    hold(self, job);
}

static void count_ring_losses(writer *self)
{
    uint32_t lost = atomic_load(&self->ring_lost_samples);
    self->ring_lost_untold += lost - self->ring_lost_seen;
    lose_samples(self, NULL, lost - self->ring_lost_seen);
    self->ring_lost_seen = lost;
    lost = atomic_load(&self->ring_lost_events);
    lose_events(self, lost - self->events_lost_seen);
    self->events_lost_seen = lost;
}

/* Pops all queued jobs, in the order of their calls. */
static writer_job *pop_queued(writer *self)
{
    writer_job *newest = atomic_exchange_explicit(&self->asked, NULL, memory_order_acquire);
    writer_job *first = NULL;
    while (newest) {
        writer_job *before = newest->next;
        newest->next = first;
        first = newest;
        newest = before;
    }
    return first;
}

/* Reads the ring first and the jobs afterwards. A track is queued before its first sample, so it is
 * always known when that sample is processed. */
static void receive(writer *self)
{
    uint32_t count;
    do {
        for (count = 0; count < WRITER_STAGED && spool_pop(self->ring, &self->staged[count]);
             ++count)
            ;
        for (writer_job *job = pop_queued(self), *next; job; job = next) {
            next = job->next;
            accept_job(self, job);
        }
        for (uint32_t i = 0; i < count; ++i)
            take_record(self, &self->staged[i]);
    } while (count == WRITER_STAGED);
    for (writer_job *job = jobs_take(&self->ending); job; job = jobs_take(&self->ending))
        end_track(self, job);
    count_ring_losses(self);
}

static void end_all(writer *self)
{
    for (uint32_t i = 0; i < self->track_slots; ++i) {
        writer_job *job = self->track[i].id ? writer_job_create(WRITER_JOB_TRACK_END) : NULL;
        if (job) {
            job->id = self->track[i].id;
            end_track(self, job);
        }
    }
    writer_job *job = writer_job_create(WRITER_JOB_SESSION_END);
    if (!job)
        return;
    job->from_ns = writer_show_ns(self, self->newest_ns);
    hold(self, job);
}

/* ---- committing: all jobs and tracks in one transaction, or none ---- */

static const int64_t journal_step_ns = NS_PER_S;

static bool commit_is_due(const writer *self)
{
    if (self->pending.first || self->ring_lost_untold > 0 || self->events_lost_untold > 0)
        return true;
    for (uint32_t i = 0; i < self->track_slots; ++i)
        if (self->track[i].count > self->track[i].committed_count || self->track[i].lost_count > 0)
            return true;
    return false;
}

static mrt_result tell_loss(writer *self, int64_t track, uint32_t count, const char *of, error *err)
{
    if (count == 0)
        return MRT_OK;
    take_event event = {.kind = TAKE_EVENT_LOST, .track = track, .value = (double)count};
    event.time_ns = writer_show_ns(self, self->newest_ns);
    (void)snprintf(event.text, sizeof event.text, "%s", of);
    return show_event_insert(self->store.db, &event, err);
}

/* *out_failed: the track that failed, if a track caused the failure. */
static mrt_result put_tracks(writer *self, writer_track **out_failed, error *err)
{
    mrt_result result = tell_loss(self, 0, self->ring_lost_untold, "", err);
    if (result >= 0)
        result = tell_loss(self, 0, self->events_lost_untold, "events", err);
    for (uint32_t i = 0; i < self->track_slots && result >= 0; ++i) {
        writer_track *track = &self->track[i];
        if (track->count > track->committed_count) {
            if (track->chunk_id == 0) {
                track->chunk_id = self->next_chunk_id;
                self->next_chunk_id = show_next_id(self->of, SHOW_ID_CHUNK);
            }
            result = writer_track_write(track, &self->store, err);
        }
        if (result >= 0)
            result = tell_loss(self, track->id, track->lost_count, "", err);
        *out_failed = result < 0 ? track : NULL;
    }
    return result;
}

/* *out_failed, *out_failed_track: the job or the track that caused the failure, if any. */
static mrt_result put_all(writer *self, writer_job **out_failed, writer_track **out_failed_track,
                          error *err)
{
    *out_failed = NULL;
    *out_failed_track = NULL;
    mrt_result result = sqlite_begin(self->store.db, err);
    if (result < 0)
        return result;
    for (writer_job *job = self->pending.first; job && result >= 0; job = job->next) {
        result = writer_job_run(job, &self->store, err);
        *out_failed = result < 0 ? job : NULL;
    }
    if (result >= 0)
        result = put_tracks(self, out_failed_track, err);
    return sqlite_end(self->store.db, result, err);
}

static void note_committed(writer *self, uint32_t count, int64_t newest_ns)
{
    atomic_fetch_add(&self->committed_count, count);
    atomic_fetch_add(&self->taken_samples, count);
    if (newest_ns > atomic_load(&self->committed_ns))
        atomic_store(&self->committed_ns, newest_ns);
}

static void forget(writer *self, writer_job *job)
{
    atomic_fetch_sub(&self->held_bytes, job->held_bytes);
    writer_job_destroy(job);
}

static void settle(writer *self)
{
    for (writer_job *job = jobs_take(&self->pending); job; job = jobs_take(&self->pending)) {
        if (job->kind == WRITER_JOB_CHUNK)
            note_committed(self, job->of.chunk.sample_count, job->of.chunk.newest_ns);
        forget(self, job);
    }
    for (uint32_t i = 0; i < self->track_slots; ++i) {
        writer_track *track = &self->track[i];
        if (track->count > track->committed_count)
            note_committed(self, track->count - track->committed_count, track->last_ns);
        track->committed_count = track->count;
        track->lost_count = 0;
    }
    self->ring_lost_untold = self->events_lost_untold = 0;
    spool_settle(self->ring);
}

/* Drops a job that can never succeed (an invalid track, frames of size 0), so that it does not
 * block the others. */
static void drop_job(writer *self, writer_job *bad)
{
    writer_jobs kept;
    jobs_init(&kept);
    for (writer_job *job = jobs_take(&self->pending); job; job = jobs_take(&self->pending)) {
        if (job != bad) {
            jobs_add(&kept, job);
            continue;
        }
        if (job->kind == WRITER_JOB_CHUNK)
            lose_samples(self, NULL, job->of.chunk.sample_count);
        forget(self, job);
    }
    self->pending = kept;
}

/* Drops a track without a row in the show, for the same reason. */
static void drop_track(writer *self, writer_track *bad)
{
    lose_samples(self, NULL, bad->count - bad->committed_count);
    writer_track_finish(bad);
}

static void report(writer *self, mrt_result result, const error *err)
{
    writer_state state = WRITER_OK;
    if (result < 0) {
        sqlite_trouble trouble = sqlite_trouble_of(self->store.db);
        bool may_pass = trouble == SQLITE_TROUBLE_FULL || trouble == SQLITE_TROUBLE_BUSY ||
                        trouble == SQLITE_TROUBLE_OPEN || result == MRT_ERR_MEMORY;
        state = may_pass ? WRITER_WAITING : WRITER_FAILED;
    }
    atomic_store(&self->state, (int32_t)state);
    pthread_mutex_lock(&self->lock);
    self->last_result = result;
    self->last_error = *err;
    pthread_mutex_unlock(&self->lock);
}

static mrt_result commit(writer *self)
{
    error err = {""}, refused = {""};
    mrt_result result = MRT_OK, refusal = MRT_OK;
    while (commit_is_due(self)) {
        writer_job *failed;
        writer_track *failed_track;
        result = put_all(self, &failed, &failed_track, &err);
        TRACE(TRACE_SHOW, "commit: %s", result < 0 ? err.text : "done");
        if (result >= 0) {
            settle(self);
        } else if (result == MRT_ERR_ARGUMENT && (failed || failed_track)) {
            refusal = result;
            refused = err;
            if (failed)
                drop_job(self, failed);
            else
                drop_track(self, failed_track);
        } else {
            break;
        }
    }
    report(self, result, &err);
    if (result < 0 || refusal == MRT_OK)
        return result;
    pthread_mutex_lock(&self->lock);
    self->last_result = refusal;
    self->last_error = refused;
    pthread_mutex_unlock(&self->lock);
    return result;
}

/* Ignores failures, so that recording continues; old data then stays in the show. */
static void commit_journal(writer *self)
{
    int64_t now_ns = writer_show_ns(self, self->newest_ns);
    if (!self->has_newest || now_ns < self->next_journal_ns)
        return;
    journal next = self->old;
    bool is_done = true;
    mrt_result result = sqlite_begin(self->store.db, NULL);
    if (result >= 0)
        result = sqlite_end(self->store.db,
                            journal_step(&next, self->store.db, now_ns, &is_done, NULL), NULL);
    if (result >= 0) {
        self->old = next;
        result = journal_shrink(self->store.db, NULL);
    }
    self->next_journal_ns = result >= 0 && !is_done ? now_ns : now_ns + journal_step_ns;
}

/* ---- public functions ---- */

enum { DEFAULT_MEMORY_BYTES = 64 * 1024 * 1024, DEFAULT_JOURNAL_S = 30 * 60 };
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

/* ---- arrivals ---- */

uint32_t writer_arrivals_open(writer *self)
{
    for (uint32_t i = 0; i < SPOOL_LANES; ++i)
        if (!self->has_place[i]) {
            self->has_place[i] = true;
            return i;
        }
    return WRITER_NO_PLACE;
}

void writer_arrivals_close(writer *self, uint32_t place)
{
    if (place == WRITER_NO_PLACE)
        return;
    spool_lane_clear(self->ring, place);
    self->has_place[place] = false;
}

void writer_arrived(writer *self, uint32_t place, uint32_t number, uint32_t version,
                    const mrt_sample *sample)
{
    const writer_arrival arrival = {.number = number, .version = version, .sample = *sample};
    if (place != WRITER_NO_PLACE)
        spool_lane_push(self->ring, place, &arrival);
}

void writer_arrivals_follow(writer *self, uint32_t place, int64_t track, uint32_t version)
{
    if (place != WRITER_NO_PLACE)
        spool_lane_mark(self->ring, place, writer_arrivals_mark(track, version));
}

void writer_arrivals_performed(writer *self, uint32_t place, uint32_t number)
{
    if (place != WRITER_NO_PLACE)
        spool_lane_done(self->ring, place, number);
}

/* ---- the writer's thread ---- */

static bool wait_for_work(writer *self, int64_t until_ns, uint64_t *out_flush)
{
    pthread_mutex_lock(&self->lock);
    while (!self->is_stopping && self->flush_asked == self->flush_done &&
           condition_wait(&self->wake, &self->lock, until_ns))
        continue;
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
        receive(self);
        mrt_result result = commit(self);
        if (result >= 0)
            commit_journal(self);
        next_ns = clock_now_ns() + (result < 0 ? retry_ns : commit_ns);
        answer(self, flush);
    }
    receive(self);
    end_all(self);
    (void)commit(self); /* writer_stop returns its result */
    return NULL;
}

/* ---- starting and stopping ---- */

static mrt_result begin_session(show *s, const writer_options *options, int64_t *out_id, error *err)
{
    char host[128];
    os_host_name(host, sizeof host);
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
    self->ring =
        spool_create(&self->of->file, self->of->path, &writer_spool_shape, self->to_show_ns);
    bool good = self->ring != NULL;
    self->lent = malloc(WRITER_WAITING_MAX * sizeof *self->lent);
    self->room = malloc(WRITER_WAITING_TEXTS_MAX * sizeof *self->room);
    good = good && self->lent && self->room;
    if (good) { /* touches their pages before recording */
        memset(self->lent, 0, WRITER_WAITING_MAX * sizeof *self->lent);
        memset(self->room, 0, WRITER_WAITING_TEXTS_MAX * sizeof *self->room);
    }
    self->checkpoint_bytes = options->checkpoint_bytes;
    for (int i = 0; i < WRITER_CHECKPOINTS && good && options->checkpoint_bytes > 0; ++i) {
        self->checkpoint[i] = malloc(options->checkpoint_bytes);
        good = self->checkpoint[i] != NULL;
        if (good)
            memset(self->checkpoint[i], 0,
                   options->checkpoint_bytes); /* touches its pages before recording */
    }
    return good ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to record");
}

static void destroy(writer *self)
{
    writer_sync_stop(self->sync);
    writer_store_close(&self->store);
    for (uint32_t i = 0; i < self->track_slots; ++i)
        writer_track_finish(&self->track[i]);
    free(self->track);
    jobs_destroy(&self->pending);
    writer_jobs asked = {.first = pop_queued(self)};
    jobs_destroy(&asked);
    free(self->lent);
    free(self->room);
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
    condition_init(&self->wake);
    condition_init(&self->done);
    pthread_mutex_init(&self->lock, NULL);
    int64_t session;
    result = allocate(self, options, err);
    if (result >= 0)
        result = begin_session(s, options, &session, err);
    if (result >= 0)
        result = writer_store_open(&self->store, s, session, err);
    if (result >= 0)
        result = writer_sync_start(&self->sync, s, err);
    if (result >= 0) {
        self->next_chunk_id = show_next_id(s, SHOW_ID_CHUNK);
        if (pthread_create(&self->thread, NULL, run, self) != 0)
            result =
                error_set(err, MRT_ERR_MEMORY, "%s: cannot start a thread for recording", s->path);
    }
    if (result < 0) {
        destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

/* Reports the unwritten samples. The next program that opens the show restores them, as after a
 * kill. */
static void report_unwritten(const writer *self, error *err)
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
    if (commit_is_due(self)) {
        result = self->last_result;
        report_unwritten(self, err);
        spool_abandon(self->ring);
        self->ring = NULL;
    }
    destroy(self);
    return result;
}

/* ---- occasional calls ---- */

/* Returns a free job of the pool; NULL: all are in use. */
static writer_job *lend(writer *self, writer_job_kind kind)
{
    const bool has_room = kind == WRITER_JOB_TRACK || kind == WRITER_JOB_PERFORMANCE;
    const uint32_t end = has_room ? WRITER_WAITING_TEXTS_MAX : WRITER_WAITING_MAX;
    for (uint32_t i = has_room ? 0 : WRITER_WAITING_TEXTS_MAX; i < end; ++i) {
        writer_lent *lent = &self->lent[i];
        if (atomic_exchange_explicit(&lent->is_taken, true, memory_order_acquire))
            continue;
        lent->job =
            (writer_job){.kind = kind, .lent = &lent->is_taken, .held_bytes = sizeof lent->job};
        if (kind == WRITER_JOB_TRACK)
            lent->job.of.track = &self->room[i].track;
        if (kind == WRITER_JOB_PERFORMANCE)
            lent->job.of.performance = &self->room[i].performance;
        return &lent->job;
    }
    return NULL;
}

/* Times are of the host clock. NULL: no job is free; queue_job() then returns the error. */
static writer_job *new_job(writer *self, writer_job_kind kind, int64_t id, int64_t from_ns,
                           int64_t to_ns)
{
    writer_job *job = lend(self, kind);
    if (job) {
        job->id = id;
        job->from_ns = writer_show_ns(self, from_ns);
        job->to_ns = writer_show_ns(self, to_ns);
    }
    return job;
}

/* [any] Queues the job; the writer's thread processes it at its next iteration. */
static mrt_result queue_job(writer *self, writer_job *job, error *err)
{
    if (!job)
        return error_set(err, MRT_ERR_MEMORY,
                         "too many changes at once: the disk cannot keep up with recording");
    job->next = atomic_load_explicit(&self->asked, memory_order_relaxed);
    while (!atomic_compare_exchange_weak_explicit(&self->asked, &job->next, job,
                                                  memory_order_release, memory_order_relaxed))
        ;
    return MRT_OK;
}

/* ---- tracks ---- */

static mrt_result check_track(const writer *self, const take_track *track, error *err)
{
    if (track->channel_count == 0 || track->channel_count > MRT_MAX_CHANNELS)
        return error_set(err, MRT_ERR_ARGUMENT, "a track of %u channels; expected 1 to %d",
                         track->channel_count, MRT_MAX_CHANNELS);
    if (self->track_count == WRITER_TRACKS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "at most %d tracks can be recorded at a time",
                         WRITER_TRACKS_MAX);
    return MRT_OK;
}

static mrt_result add_track(writer *self, writer_job *job, take_track *track, take_texts *texts,
                            error *err)
{
    track->id = show_next_id(self->of, SHOW_ID_TRACK);
    if (job)
        writer_job_set_track(job, track, texts);
    mrt_result result = queue_job(self, job, err);
    self->track_count += result >= 0;
    return result;
}

mrt_result writer_follow_track(writer *self, take_track *track, take_texts *texts, error *err)
{
    mrt_result result = check_track(self, track, err);
    return result < 0 ? result : add_track(self, lend(self, WRITER_JOB_TRACK), track, texts, err);
}

/* Replaces the text by a copy. */
static bool own_text(char **text)
{
    if (!*text)
        return true;
    *text = strdup(*text);
    return *text != NULL;
}

mrt_result writer_add_track(writer *self, take_track *track, error *err)
{
    mrt_result result = check_track(self, track, err);
    if (result < 0)
        return result;
    take_track copy = *track;
    bool good = own_text(&copy.input);
    good &= own_text(&copy.device);
    good &= own_text(&copy.plugin);
    good &= own_text(&copy.calibration[0]);
    good &= own_text(&copy.calibration[1]);
    take_texts *texts = good ? take_track_texts(&copy) : NULL;
    writer_job *job = texts ? writer_job_create(WRITER_JOB_TRACK) : NULL;
    if (!texts)
        take_track_finish(&copy);
    if (job)
        result = add_track(self, job, &copy, texts, err);
    else
        result = error_set(err, MRT_ERR_MEMORY, "no memory to record a track");
    track->id = copy.id;
    take_texts_drop(texts);
    return result;
}

mrt_result writer_end_track(writer *self, int64_t track, error *err)
{
    mrt_result result = queue_job(self, new_job(self, WRITER_JOB_TRACK_END, track, 0, 0), err);
    self->track_count -= result >= 0 && self->track_count > 0;
    return result;
}

/* ---- performances ---- */

static mrt_result check_performance(const take_performance *performance, error *err)
{
    if (performance->track_count > TAKE_TRACKS_MAX || performance->param_count > TAKE_PARAMS_MAX)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "a performance of %u tracks and %u parameters; at most %d and %d are possible",
            performance->track_count, performance->param_count, TAKE_TRACKS_MAX, TAKE_PARAMS_MAX);
    return MRT_OK;
}

static mrt_result begin_performance(writer *self, writer_job *job, take_performance *performance,
                                    take_texts *texts, int64_t time_ns, error *err)
{
    if (job) {
        performance->id = show_next_id(self->of, SHOW_ID_PERFORMANCE);
        writer_job_set_performance(job, performance, texts);
        job->from_ns = job->to_ns = writer_show_ns(self, time_ns);
    }
    return queue_job(self, job, err);
}

mrt_result writer_follow_performance(writer *self, take_performance *performance, take_texts *texts,
                                     int64_t time_ns, error *err)
{
    mrt_result result = check_performance(performance, err);
    return result < 0 ? result
                      : begin_performance(self, lend(self, WRITER_JOB_PERFORMANCE), performance,
                                          texts, time_ns, err);
}

mrt_result writer_begin_performance(writer *self, take_performance *performance, int64_t time_ns,
                                    error *err)
{
    mrt_result result = check_performance(performance, err);
    if (result < 0)
        return result;
    take_performance copy = *performance;
    bool good = own_text(&copy.mapping);
    good &= own_text(&copy.rig);
    good &= own_text(&copy.rig_json);
    good &= own_text(&copy.patch);
    good &= own_text(&copy.again.calibration[0]);
    good &= own_text(&copy.again.calibration[1]);
    take_texts *texts = good ? take_performance_texts(&copy) : NULL;
    writer_job *job = texts ? writer_job_create(WRITER_JOB_PERFORMANCE) : NULL;
    if (!texts)
        take_performance_finish(&copy);
    if (job)
        result = begin_performance(self, job, &copy, texts, time_ns, err);
    else
        result = error_set(err, MRT_ERR_MEMORY, "no memory to record a performance");
    performance->id = copy.id;
    take_texts_drop(texts);
    return result;
}

mrt_result writer_end_performance(writer *self, int64_t time_ns, error *err)
{
    return queue_job(self, new_job(self, WRITER_JOB_PERFORMANCE_END, 0, time_ns, time_ns), err);
}

/* ---- takes, marks, sound ---- */

static writer_job *slated_job(writer *self, writer_job_kind kind, const writer_slate *slate,
                              int64_t from_ns, int64_t to_ns)
{
    writer_job *job = new_job(self, kind, show_next_id(self->of, SHOW_ID_TAKE), from_ns, to_ns);
    if (!job)
        return NULL;
    job->of.slate.number = slate->number;
    job->of.slate.over = slate->over;
    job->of.slate.over_at_ns = slate->over_at_ns;
    job->of.slate.fps = slate->fps;
    job->of.slate.timecode_frame = slate->timecode_frame;
    job->of.slate.is_drop_frame = slate->is_drop_frame;
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
    return queue_job(self, job, err);
}

mrt_result writer_take_end(writer *self, int64_t take_id, int64_t time_ns, error *err)
{
    return queue_job(self, new_job(self, WRITER_JOB_TAKE_END, take_id, time_ns, time_ns), err);
}

mrt_result writer_keep(writer *self, int64_t from_ns, int64_t to_ns, const writer_slate *slate,
                       int64_t *out_take, error *err)
{
    *out_take = 0;
    if (to_ns <= from_ns)
        return error_set(err, MRT_ERR_ARGUMENT, "the range to keep ends before it starts");
    writer_job *job = slated_job(self, WRITER_JOB_KEEP, slate, from_ns, to_ns);
    *out_take = job ? job->id : 0;
    return queue_job(self, job, err);
}

mrt_result writer_mark(writer *self, int64_t time_ns, const char *text, error *err)
{
    writer_job *job = lend(self, WRITER_JOB_EVENT);
    if (job) {
        job->of.event =
            (take_event){.time_ns = writer_show_ns(self, time_ns), .kind = TAKE_EVENT_MARK};
        snprintf(job->of.event.text, sizeof job->of.event.text, "%s", text);
    }
    return queue_job(self, job, err);
}

mrt_result writer_audio(writer *self, int64_t audio, int64_t time_ns, const void *frames,
                        size_t size, error *err)
{
    if (atomic_load(&self->held_bytes) >= self->memory_bytes)
        return error_set(
            err, MRT_ERR_MEMORY,
            "audio is lost: the disk is full, and so is the memory that holds unwritten data");
    writer_job *job = writer_job_create(WRITER_JOB_AUDIO);
    if (!job)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record sound");
    mrt_result result = writer_job_copy_bytes(job, frames, size, err);
    if (result < 0) {
        writer_job_destroy(job);
        return result;
    }
    job->id = audio;
    job->from_ns = time_ns != 0 ? writer_show_ns(self, time_ns) : 0;
    return queue_job(self, job, err);
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
        .is_missing = atomic_load(&self->sync->is_missing),
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
                       "%s: was deleted, moved or replaced while it is open; recording continues, "
                       "and a copy will be made when the program ends",
                       show_path(self->of));
    else if (status.lost_count > 0)
        (void)snprintf(out, capacity, "%s: %llu samples were lost", show_path(self->of),
                       (unsigned long long)status.lost_count);
    else if (status.lost_event_count > 0)
        (void)snprintf(out, capacity,
                       "%s: %llu changes of parameters were lost: a replay after them differs from "
                       "the live performance",
                       show_path(self->of), (unsigned long long)status.lost_event_count);
    else
        (void)snprintf(out, capacity, "%s", "");
    pthread_mutex_unlock(&self->lock);
}
