/* From the recording thread and the main one, to jobs and tracks. */
#include "take/writer_state.h"

#include <stdlib.h>

/* ---- lists of jobs ---- */

void writer_jobs_init(writer_jobs *list)
{
    *list = (writer_jobs){.first = NULL, .end = NULL};
}

void writer_jobs_add(writer_jobs *list, writer_job *job)
{
    job->next = NULL;
    if (list->first)
        *list->end = job;
    else
        list->first = job;
    list->end = &job->next;
}

void writer_jobs_destroy(writer_jobs *list)
{
    while (list->first) {
        writer_job *job = list->first;
        list->first = job->next;
        writer_job_destroy(job);
    }
    writer_jobs_init(list);
}

writer_job *writer_jobs_take(writer_jobs *list)
{
    writer_job *job = list->first;
    if (job)
        list->first = job->next;
    return job;
}

/* ---- records and requests ---- */

static void hold(writer *self, writer_job *job)
{
    writer_jobs_add(&self->pending, job);
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

void writer_in_lose(writer *self, writer_track *track, uint32_t count)
{
    if (track)
        track->lost_count += count;
    atomic_fetch_add(&self->lost_count, count);
    atomic_fetch_add(&self->taken_samples, count);
}

/* What of the chunk is not written waits as a job from now on; where memory has run out it is lost.
 */
static void seal(writer *self, writer_track *track)
{
    bool failed = !has_memory(self);
    uint32_t open_count = track->count - track->committed_count;
    writer_job *job = failed ? NULL : writer_track_seal(track, self->next_chunk_id, &failed);
    if (job) {
        self->next_chunk_id += job->id == self->next_chunk_id;
        hold(self, job);
    }
    if (failed)
        writer_in_lose(self, track, open_count);
    writer_track_next_chunk(track, job || track->committed_count > 0);
}

static void take_sample(writer *self, int64_t id, const mrt_sample *sample)
{
    writer_track *track = id > 0 ? find_track(self, id) : NULL;
    if (!track || !writer_track_accepts(track, sample)) {
        writer_in_lose(self, track, 1);
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

/* A free one; NULL: no memory. Tracks that end go later than those that begin, so there may be more
 * of them than WRITER_TRACKS_MAX. */
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

/* A track is known from when it was asked for, and ends when the ring is empty. Without memory for
 * one its samples count as lost. */
static void take_job(writer *self, writer_job *job)
{
    if (job->kind == WRITER_JOB_TRACK_END) {
        writer_jobs_add(&self->ending, job);
        return;
    }
    writer_track *track = job->kind == WRITER_JOB_TRACK ? free_track(self) : NULL;
    if (track && writer_track_init(track, job->id, job->of.track.channel_count, NULL) < 0)
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
    writer_in_lose(self, NULL, lost - self->ring_lost_seen);
    self->ring_lost_seen = lost;
    lost = atomic_load(&self->ring_lost_events);
    lose_events(self, lost - self->events_lost_seen);
    self->events_lost_seen = lost;
}

/* What is asked is looked at after the records were staged: so a track, asked for before its first
 * sample was given, is known when that is looked at. */
void writer_in(writer *self)
{
    uint32_t count;
    do {
        for (count = 0; count < WRITER_STAGED && spool_pop(self->ring, &self->staged[count]);
             ++count)
            ;
        pthread_mutex_lock(&self->lock);
        writer_jobs asked = self->asked;
        writer_jobs_init(&self->asked);
        pthread_mutex_unlock(&self->lock);
        for (writer_job *job = writer_jobs_take(&asked); job; job = writer_jobs_take(&asked))
            take_job(self, job);
        for (uint32_t i = 0; i < count; ++i)
            take_record(self, &self->staged[i]);
    } while (count == WRITER_STAGED);
    for (writer_job *job = writer_jobs_take(&self->ending); job;
         job = writer_jobs_take(&self->ending))
        end_track(self, job);
    count_ring_losses(self);
}

void writer_in_end(writer *self)
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
