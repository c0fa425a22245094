/* From jobs and tracks to the show: all of it in one transaction, or none. */
#include "take/writer_state.h"

#include "base/clock.h"

#include <stdio.h>

static const int64_t journal_step_ns = NS_PER_S;

bool writer_commit_is_due(const writer *self)
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

/* *out_failed: the track that failed, where it was one. */
static mrt_result put_tracks(writer *self, writer_track **out_failed, error *err)
{
    mrt_result result = tell_loss(self, 0, self->ring_lost_untold, "", err);
    if (result >= 0)
        result = tell_loss(self, 0, self->events_lost_untold, "events", err);
    for (uint32_t i = 0; i < self->track_slots && result >= 0; ++i) {
        writer_track *track = &self->track[i];
        if (track->count > track->committed_count) {
            if (track->chunk_id == 0)
                track->chunk_id = self->next_chunk_id++;
            result = writer_track_put(track, &self->store, err);
        }
        if (result >= 0)
            result = tell_loss(self, track->id, track->lost_count, "", err);
        *out_failed = result < 0 ? track : NULL;
    }
    return result;
}

/* *out_failed, *out_failed_track: the job or the track that failed, where it was one. */
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
    for (writer_job *job = writer_jobs_take(&self->pending); job;
         job = writer_jobs_take(&self->pending)) {
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

/* A job that can never be done (a track that is none, frames of no size) must not keep the others.
 */
static void drop_job(writer *self, writer_job *bad)
{
    writer_jobs kept;
    writer_jobs_init(&kept);
    for (writer_job *job = writer_jobs_take(&self->pending); job;
         job = writer_jobs_take(&self->pending)) {
        if (job != bad) {
            writer_jobs_add(&kept, job);
            continue;
        }
        if (job->kind == WRITER_JOB_CHUNK)
            writer_in_lose(self, NULL, job->of.chunk.sample_count);
        forget(self, job);
    }
    self->pending = kept;
}

/* Neither must a track that the show has no row of. */
static void drop_track(writer *self, writer_track *bad)
{
    writer_in_lose(self, NULL, bad->count - bad->committed_count);
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

mrt_result writer_commit(writer *self)
{
    error err = {""}, refused = {""};
    mrt_result result = MRT_OK, refusal = MRT_OK;
    while (writer_commit_is_due(self)) {
        writer_job *failed;
        writer_track *failed_track;
        result = put_all(self, &failed, &failed_track, &err);
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

/* Its failures keep nobody from recording: what is old stays. */
void writer_commit_journal(writer *self)
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
