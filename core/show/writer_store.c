#include "show/writer_store.h"

#include "base/clock.h"
#include "show/chunk.h"
#include "show/edit.h"
#include "show/step_rule.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const spool_shape writer_spool_shape = {
    .record_size = sizeof(writer_record),
    .record_count = 32768, /* 100 s of two gloves, if the writer's thread is blocked */
    .lane_record_size = sizeof(writer_arrival),
    .lane_record_count = 1024}; /* the queue of an input to the frame thread has the same length */

enum { VERSIONS_MAX = 256 };

int64_t writer_arrivals_mark(int64_t track, uint32_t version)
{
    return track < INT64_MAX / VERSIONS_MAX ? track * VERSIONS_MAX + version % VERSIONS_MAX : 0;
}

/* ---- jobs in memory ---- */

writer_job *writer_job_create(writer_job_kind kind)
{
    writer_job *job = calloc(1, sizeof *job);
    if (!job)
        return NULL;
    job->kind = kind;
    job->held_bytes = sizeof *job;
    if (kind == WRITER_JOB_TRACK) {
        job->held_bytes += sizeof *job->of.track;
        job->of.track = calloc(1, sizeof *job->of.track);
        if (!job->of.track)
            goto fail;
    }
    if (kind == WRITER_JOB_PERFORMANCE) {
        job->held_bytes += sizeof *job->of.performance;
        job->of.performance = calloc(1, sizeof *job->of.performance);
        if (!job->of.performance)
            goto fail;
    }
    return job;
fail:
    free(job);
    return NULL;
}

void writer_job_destroy(writer_job *job)
{
    if (!job)
        return;
    take_texts_drop(job->texts);
    if (job->lent) {
        atomic_store_explicit(job->lent, false, memory_order_release);
        return;
    }
    if (job->kind == WRITER_JOB_TRACK)
        free(job->of.track);
    if (job->kind == WRITER_JOB_PERFORMANCE)
        free(job->of.performance);
    if (job->kind == WRITER_JOB_CHECKPOINT)
        free(job->of.checkpoint.bytes);
    free(job->bytes);
    free(job);
}

writer_job *writer_job_own(writer_job *lent)
{
    writer_job *job = writer_job_create(lent->kind);
    if (!job)
        return NULL;
    const writer_job made = *job;
    *job = *lent;
    job->lent = NULL;
    job->held_bytes = made.held_bytes;
    if (job->kind == WRITER_JOB_TRACK) {
        job->of.track = made.of.track;
        *job->of.track = *lent->of.track;
    }
    if (job->kind == WRITER_JOB_PERFORMANCE) {
        job->of.performance = made.of.performance;
        *job->of.performance = *lent->of.performance;
    }
    lent->texts = NULL; /* they moved */
    writer_job_destroy(lent);
    return job;
}

void writer_job_set_track(writer_job *job, const take_track *track, take_texts *texts)
{
    *job->of.track = *track;
    job->texts = take_texts_hold(texts);
    job->id = track->id;
}

void writer_job_set_performance(writer_job *job, const take_performance *performance,
                                take_texts *texts)
{
    *job->of.performance = *performance;
    job->texts = take_texts_hold(texts);
    job->id = performance->id;
    const char *mapping = performance->mapping ? performance->mapping : "";
    if (strlen(mapping) < sizeof job->mapping)
        memcpy(job->mapping, mapping, strlen(mapping) + 1);
}

mrt_result writer_job_copy_bytes(writer_job *job, const void *bytes, size_t size, error *err)
{
    job->bytes = malloc(size ? size : 1);
    if (!job->bytes)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record %zu bytes", size);
    memcpy(job->bytes, bytes, size);
    job->byte_count = size;
    job->held_bytes += size;
    return MRT_OK;
}

/* ---- destination of the jobs ---- */

mrt_result writer_store_borrow(writer_store *out, sqlite *db, int64_t session, error *err)
{
    *out = (writer_store){.db = db, .session = session};
    return sqlite_prepare(db, &out->put_chunk,
                          "INSERT INTO chunk(id, track, from_ns, to_ns, bytes)"
                          "VALUES(?, ?, ?, ?, ?) ON CONFLICT(id) DO UPDATE"
                          " SET to_ns = excluded.to_ns, bytes = excluded.bytes",
                          "", err);
}

void writer_store_give_back(writer_store *store)
{
    sqlite_finish(store->put_chunk);
    *store = (writer_store){0};
}

/* Synchronous NORMAL: a commit does not wait for the disk. writer.c syncs separately. */
mrt_result writer_store_open(writer_store *out, const show *s, int64_t session, error *err)
{
    sqlite *db = NULL;
    *out = (writer_store){.session = session};
    mrt_result result = show_connect(s, &db, err);
    if (result >= 0)
        result = sqlite_run(db, "PRAGMA synchronous = NORMAL; PRAGMA wal_autocheckpoint = 0", err);
    out->db = db;
    if (result >= 0)
        result = writer_store_borrow(out, db, session, err);
    if (result < 0)
        writer_store_close(out);
    return result;
}

void writer_store_close(writer_store *store)
{
    sqlite *db = store->db;
    writer_store_give_back(store);
    sqlite_close(db);
}

/* Inserts the chunk, or replaces it by a longer one that begins with the same samples. */
static mrt_result writer_put_chunk(writer_store *store, int64_t id, int64_t track, int64_t from_ns,
                                   int64_t to_ns, const uint8_t *bytes, size_t size, error *err)
{
    sqlite_bind(store->put_chunk, "iiiib", id, track, from_ns, to_ns, (const void *)bytes, size);
    return sqlite_execute(store->put_chunk, err);
}

/* ---- performances ---- */

static mrt_result end_performance(sqlite *db, int64_t time_ns, error *err)
{
    mrt_result result = sqlite_change(
        db, err, "UPDATE span SET to_ns = MAX(from_ns, ?) WHERE to_ns IS NULL", "i", time_ns);
    if (result < 0)
        return result;
    return sqlite_change(db, err,
                         "UPDATE performance SET to_ns = MAX(from_ns, ?) WHERE to_ns IS NULL", "i",
                         time_ns);
}

static mrt_result show_in_open_takes(sqlite *db, int64_t performance, int64_t from_ns, error *err)
{
    sqlite_statement *takes =
        sqlite_query(db, "SELECT id, start_ns FROM take WHERE end_ns IS NULL", "in", "");
    mrt_result result;
    while ((result = sqlite_step(takes, err)) == MRT_OK) {
        int64_t start_ns = sqlite_time(takes, 1);
        result = show_span_insert(db, sqlite_int(takes, 0), performance,
                                  start_ns > from_ns ? start_ns : from_ns, NULL, true, err);
        if (result < 0)
            break;
    }
    return sqlite_finish_rows(takes, result);
}

static mrt_result run_performance(const writer_job *job, writer_store *store, error *err)
{
    take_performance performance = *job->of.performance;
    char mapping[TAKE_IDENTITY];
    if (job->mapping[0]) {
        memcpy(mapping, job->mapping, sizeof mapping);
        performance.mapping = mapping;
    }
    mrt_result result = end_performance(store->db, job->from_ns, err);
    if (result >= 0)
        result =
            show_performance_insert(store->db, store->session, &performance, job->from_ns, err);
    return result < 0 ? result : show_in_open_takes(store->db, job->id, job->from_ns, err);
}

/* ---- takes ---- */

static mrt_result insert_edit(const writer_job *job, int32_t n, const edit *e, sqlite *db,
                              error *err)
{
    char *json = NULL;
    mrt_result result = edit_write(&json, e, err);
    if (result >= 0)
        result = show_edit_insert(db, job->id, n, job->from_ns / NS_PER_MS, json, err);
    free(json);
    return result;
}

/* Inserts the time code as a base edit, which undo does not remove. */
static mrt_result insert_timecode(const writer_job *job, sqlite *db, error *err)
{
    edit fps, code;
    edit_init(&fps, EDIT_TAKE_FPS);
    edit_init(&code, EDIT_TAKE_TIMECODE);
    fps.fps = job->of.slate.fps;
    code.frame = job->of.slate.timecode_frame;
    code.is_drop = job->of.slate.is_drop_frame;
    const mrt_result result = insert_edit(job, -1, &fps, db, err);
    return result < 0 ? result : insert_edit(job, 0, &code, db, err);
}

static mrt_result insert_take(const writer_job *job, int64_t start_ns, const int64_t *end_ns,
                              const char *origin, sqlite *db, error *err)
{
    show_take_row row = {.id = job->id,
                         .created_ns = end_ns ? *end_ns : start_ns,
                         .start_ns = start_ns,
                         .end_ns = end_ns,
                         .scene = job->of.slate.scene,
                         .shot = job->of.slate.shot,
                         .number = job->of.slate.number,
                         .origin = origin};
    const mrt_result result = show_take_insert(db, &row, err);
    return result < 0 || job->of.slate.fps == 0.0 ? result : insert_timecode(job, db, err);
}

static mrt_result run_take(const writer_job *job, writer_store *store, error *err)
{
    char origin[96] = "recorded";
    if (job->of.slate.over)
        (void)snprintf(origin, sizeof origin, SHOW_ORIGIN_OVER, (long long)job->of.slate.over,
                       (long long)(job->of.slate.over_at_ns / NS_PER_MS));
    mrt_result result = insert_take(job, job->from_ns, NULL, origin, store->db, err);
    if (result < 0)
        return result;
    int64_t performance;
    result = sqlite_number(store->db, "SELECT MAX(id) FROM performance WHERE to_ns IS NULL", 0,
                           &performance, err);
    if (result < 0 || performance == 0)
        return result;
    return show_span_insert(store->db, job->id, performance, job->from_ns, NULL, true, err);
}

static mrt_result run_take_end(const writer_job *job, writer_store *store, error *err)
{
    mrt_result result = sqlite_change(store->db, err,
                                      "UPDATE take SET end_ns = MAX(start_ns, ?2)"
                                      " WHERE id = ?1 AND end_ns IS NULL",
                                      "ii", job->id, job->to_ns);
    if (result < 0)
        return result;
    return sqlite_change(store->db, err,
                         "UPDATE span SET to_ns = MAX(from_ns, ?2)"
                         " WHERE take = ?1 AND to_ns IS NULL",
                         "ii", job->id, job->to_ns);
}

/* Inserts a span for each performance of that time, or for all tracks if there was none. */
static mrt_result insert_kept_spans(sqlite *db, int64_t id, int64_t from_ns, int64_t to_ns,
                                    error *err)
{
    sqlite_statement *performances =
        sqlite_query(db,
                     "SELECT id, MAX(from_ns, ?1), MIN(COALESCE(to_ns, ?2), ?2)"
                     " FROM performance WHERE from_ns < ?2"
                     " AND COALESCE(to_ns, ?2) > ?1 ORDER BY from_ns",
                     "iii", "ii", from_ns, to_ns);
    int count = 0;
    mrt_result result;
    while ((result = sqlite_step(performances, err)) == MRT_OK) {
        int64_t end_ns = sqlite_time(performances, 2);
        ++count;
        result = show_span_insert(db, id, sqlite_int(performances, 0), sqlite_int(performances, 1),
                                  &end_ns, true, err);
        if (result < 0)
            break;
    }
    result = sqlite_finish_rows(performances, result);
    if (result >= 0 && count == 0)
        result = show_span_insert(db, id, 0, from_ns, &to_ns, true, err);
    return result;
}

static mrt_result run_keep(const writer_job *job, writer_store *store, error *err)
{
    int64_t pruned_ns;
    mrt_result result =
        sqlite_number(store->db, "SELECT value FROM meta WHERE key = 'pruned_until_ns'", INT64_MIN,
                      &pruned_ns, err);
    if (result < 0)
        return result;
    int64_t from_ns = pruned_ns > job->from_ns ? pruned_ns + 1 : job->from_ns;
    int64_t to_ns = job->to_ns > from_ns ? job->to_ns : from_ns;
    result = insert_take(job, from_ns, &to_ns, "kept from the journal", store->db, err);
    return result < 0 ? result : insert_kept_spans(store->db, job->id, from_ns, to_ns, err);
}

/* ---- running any job ---- */

static mrt_result run_track_end(const writer_job *job, writer_store *store, error *err)
{
    return sqlite_change(store->db, err, "UPDATE track SET chunk_count = ? WHERE id = ?", "ii",
                         job->of.chunk_count, job->id);
}

static mrt_result run_session_end(const writer_job *job, writer_store *store, error *err)
{
    mrt_result result = sqlite_change(store->db, err,
                                      "UPDATE take SET end_ns = MAX(start_ns, ?)"
                                      " WHERE end_ns IS NULL",
                                      "i", job->from_ns);
    if (result >= 0)
        result = end_performance(store->db, job->from_ns, err);
    if (result < 0)
        return result;
    return sqlite_change(store->db, err, "UPDATE session SET ended_ns = ? WHERE id = ?", "ii",
                         job->from_ns, store->session);
}

mrt_result writer_job_run(const writer_job *job, writer_store *store, error *err)
{
    switch (job->kind) {
    case WRITER_JOB_TRACK:
        return show_track_insert(store->db, store->session, job->of.track, err);
    case WRITER_JOB_TRACK_END:
        return run_track_end(job, store, err);
    case WRITER_JOB_PERFORMANCE:
        return run_performance(job, store, err);
    case WRITER_JOB_PERFORMANCE_END:
        return end_performance(store->db, job->from_ns, err);
    case WRITER_JOB_TAKE:
        return run_take(job, store, err);
    case WRITER_JOB_TAKE_END:
        return run_take_end(job, store, err);
    case WRITER_JOB_KEEP:
        return run_keep(job, store, err);
    case WRITER_JOB_EVENT:
        return show_event_insert(store->db, &job->of.event, err);
    case WRITER_JOB_CHECKPOINT:
        return show_checkpoint_insert(store->db, &job->of.checkpoint, err);
    case WRITER_JOB_CHUNK:
        return writer_put_chunk(store, job->id, job->of.chunk.track, job->from_ns, job->to_ns,
                                job->bytes, job->byte_count, err);
    case WRITER_JOB_AUDIO:
        return show_audio_append(store->db, job->id, job->from_ns, job->bytes, job->byte_count,
                                 err);
    case WRITER_JOB_SESSION_END:
        return run_session_end(job, store, err);
    case WRITER_JOB_NONE:
    default:
        return MRT_OK;
    }
}

/* ---- the growing chunk of a track ---- */

static const int64_t chunk_span_ns = NS_PER_S;

mrt_result writer_track_init(writer_track *out, int64_t id, uint32_t channel_count, error *err)
{
    *out = (writer_track){0};
    mrt_sample *sample = calloc(WRITER_CHUNK_SAMPLES, sizeof *sample);
    chunk_packer *packer = chunk_packer_create();
    *out = (writer_track){
        .id = id, .channel_count = channel_count, .sample = sample, .packer = packer};
    if (!sample || !packer) {
        writer_track_finish(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory to record track %lld", (long long)id);
    }
    return MRT_OK;
}

void writer_track_finish(writer_track *track)
{
    free(track->sample);
    chunk_packer_destroy(track->packer);
    *track = (writer_track){0};
}

bool writer_track_is_time(int64_t time_ns)
{
    const int64_t limit_ns = (int64_t)1 << 61;
    return time_ns > -limit_ns && time_ns < limit_ns;
}

bool writer_track_accepts(const writer_track *track, const mrt_sample *sample)
{
    if (sample->count != track->channel_count || !writer_track_is_time(sample->time_ns) ||
        (track->has_last && sample->time_ns < track->last_ns))
        return false;
    for (uint32_t i = 0; i < sample->count; ++i)
        if (!isfinite(sample->value[i]))
            return false;
    return true;
}

bool writer_track_is_full(const writer_track *track, int64_t next_show_ns)
{
    return track->count == WRITER_CHUNK_SAMPLES ||
           (track->count > 0 && next_show_ns - track->sample[0].time_ns >= chunk_span_ns);
}

static mrt_result encode(const writer_track *track, uint8_t **out, size_t *out_size, error *err)
{
    *out_size = 0;
    *out = malloc(chunk_bound(track->count, track->channel_count));
    if (!*out)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record track %lld",
                         (long long)track->id);
    mrt_result result = chunk_pack(track->packer, *out, out_size, track->id, track->ordinal,
                                   track->sample, track->count, err);
    if (result < 0) {
        free(*out);
        *out = NULL;
    }
    return result;
}

writer_job *writer_track_seal(const writer_track *track, int64_t chunk_id, bool *out_failed)
{
    *out_failed = false;
    if (track->count == track->committed_count)
        return NULL;
    writer_job *job = writer_job_create(WRITER_JOB_CHUNK);
    if (!job || encode(track, &job->bytes, &job->byte_count, NULL) < 0) {
        writer_job_destroy(job);
        *out_failed = true;
        return NULL;
    }
    job->id = track->chunk_id ? track->chunk_id : chunk_id;
    job->held_bytes += job->byte_count;
    job->from_ns = track->sample[0].time_ns;
    job->to_ns = track->sample[track->count - 1].time_ns;
    job->of.chunk.track = track->id;
    job->of.chunk.sample_count = track->count - track->committed_count;
    job->of.chunk.newest_ns = track->last_ns;
    return job;
}

void writer_track_next_chunk(writer_track *track, bool was_kept)
{
    track->ordinal += was_kept;
    track->count = track->committed_count = 0;
    track->chunk_id = 0;
}

mrt_result writer_track_write(const writer_track *track, writer_store *store, error *err)
{
    uint8_t *bytes;
    size_t size;
    mrt_result result = encode(track, &bytes, &size, err);
    if (result < 0)
        return result;
    result = writer_put_chunk(store, track->chunk_id, track->id, track->sample[0].time_ns,
                              track->sample[track->count - 1].time_ns, bytes, size, err);
    free(bytes);
    return result;
}

/* ---- data that a killed writer left uncommitted ---- */

typedef struct leftover_track {
    writer_track track;
    bool is_known; /* in the show */
    bool has_last; /* last sample in the show */
    int64_t last_ns;
    uint32_t last_sequence;
    mrt_sample newest; /* last sample including the added ones, show time; count 0: none */
    uint32_t measures; /* step_rule.h */
} leftover_track;

/* A lane with samples that were not performed. */
typedef struct waiting_lane {
    leftover_track *track;
    uint32_t index, next; /* index of the lane in the spool; index of its next record */
    spool_lane of;
    step_rhythm rhythm;
    bool is_there, is_chosen; /* `now` */
    writer_arrival now;
} waiting_lane;

typedef struct leftover {
    writer_store store;
    int64_t to_show_ns, next_chunk_id;
    leftover_track track[WRITER_TRACKS_MAX];
    uint32_t track_count;
    mrt_sample *sample; /* CHUNK_SAMPLES_MAX */
    waiting_lane lane[SPOOL_LANES];
    uint32_t lane_count;
} leftover;

/* ---- the end of each track ---- */

static mrt_result read_end_of(leftover *self, leftover_track *out, int64_t id, error *err)
{
    sqlite_statement *last = sqlite_query(self->store.db,
                                          "SELECT bytes FROM chunk WHERE track = ? "
                                          "ORDER BY from_ns DESC, id DESC LIMIT 1",
                                          "b", "i", id);
    mrt_result result = sqlite_step(last, err);
    if (result == MRT_OK) {
        chunk_head head;
        size_t size;
        const uint8_t *bytes = sqlite_blob(last, 0, &size);
        if (chunk_decode(self->sample, &head, bytes, size, NULL) < 0) {
            out->is_known = false; /* the last chunk is damaged, so its number is unknown */
        } else {
            out->track.ordinal = head.ordinal + 1;
            out->has_last = true;
            out->newest = self->sample[head.sample_count - 1];
            out->last_ns = out->newest.time_ns;
            out->last_sequence = out->newest.sequence;
        }
    }
    return sqlite_finish_rows(last, result);
}

static mrt_result read_channels(leftover *self, int64_t id, uint32_t *out_count,
                                uint32_t *out_measures, error *err)
{
    sqlite_statement *channels = sqlite_query(
        self->store.db, "SELECT semantic, hand FROM channel WHERE track = ?", "ii", "i", id);
    mrt_result result;
    *out_count = *out_measures = 0;
    while ((result = sqlite_step(channels, err)) == MRT_OK && *out_count <= MRT_MAX_CHANNELS) {
        const int64_t semantic = sqlite_int(channels, 0), hand = sqlite_int(channels, 1);
        *out_count += 1;
        if (semantic >= 0 && semantic <= UINT32_MAX && hand >= 0 && hand <= MRT_RIGHT)
            *out_measures |= step_measures((uint32_t)semantic, (uint32_t)hand);
    }
    return sqlite_finish_rows(channels, result == MRT_OK ? MRT_END : result);
}

/* Adds a track. A track without a committed row is kept, but its samples are dropped. */
static mrt_result add_track(leftover *self, int64_t id, leftover_track **out, error *err)
{
    *out = NULL;
    if (self->track_count == WRITER_TRACKS_MAX)
        return MRT_OK;
    uint32_t count;
    leftover_track *track = &self->track[self->track_count];
    mrt_result result = read_channels(self, id, &count, &track->measures, err);
    if (result >= 0)
        result = writer_track_init(&track->track, id, count, err);
    if (result < 0)
        return result;
    ++self->track_count;
    track->is_known = count > 0 && count <= MRT_MAX_CHANNELS;
    *out = track;
    return track->is_known ? read_end_of(self, track, id, err) : MRT_OK;
}

static mrt_result find_track(leftover *self, int64_t id, leftover_track **out, error *err)
{
    for (uint32_t i = 0; i < self->track_count; ++i)
        if (self->track[i].track.id == id) {
            *out = &self->track[i];
            return MRT_OK;
        }
    return add_track(self, id, out, err);
}

/* ---- record by record ---- */

static mrt_result put_chunk(leftover *self, leftover_track *track, error *err)
{
    if (track->track.count == 0)
        return MRT_OK;
    track->track.chunk_id = self->next_chunk_id++;
    mrt_result result = writer_track_write(&track->track, &self->store, err);
    writer_track_next_chunk(&track->track, true);
    return result;
}

static bool is_new(const leftover_track *track, int64_t show_ns, uint32_t sequence)
{
    return !track->has_last || show_ns > track->last_ns ||
           (show_ns == track->last_ns && (int32_t)(sequence - track->last_sequence) > 0);
}

static mrt_result take_sample(leftover *self, int64_t id, const mrt_sample *sample, error *err)
{
    leftover_track *track;
    mrt_result result = id > 0 ? find_track(self, id, &track, err) : MRT_END;
    if (result != MRT_OK || !track || !track->is_known)
        return result < 0 ? result : MRT_OK;
    int64_t show_ns = sample->time_ns + self->to_show_ns;
    if (!writer_track_accepts(&track->track, sample) || !is_new(track, show_ns, sample->sequence))
        return MRT_OK;
    if (writer_track_is_full(&track->track, show_ns))
        result = put_chunk(self, track, err);
    track->track.sample[track->track.count] = *sample;
    track->track.sample[track->track.count++].time_ns = show_ns;
    track->track.last_ns = sample->time_ns;
    track->track.has_last = true;
    track->newest = track->track.sample[track->track.count - 1];
    return result;
}

static mrt_result take_event_once(leftover *self, const take_event *given, error *err)
{
    take_event event = *given;
    event.time_ns += self->to_show_ns;
    sqlite_statement *same = sqlite_query(self->store.db,
                                          "SELECT 1 FROM event WHERE time_ns = ? AND kind = ?"
                                          " AND track = ? AND param = ? AND value = ?",
                                          "i", "iiiid", event.time_ns, (int64_t)event.kind,
                                          event.track, (int64_t)event.param, event.value);
    mrt_result result = sqlite_step(same, err);
    sqlite_finish(same);
    return result == MRT_END ? show_event_insert(self->store.db, &event, err) : result;
}

/* ---- samples that had arrived but were not performed: appended as steps ---- */

static bool is_waiting(const waiting_lane *lane)
{
    return (int32_t)(lane->now.number - lane->of.done) >= 0;
}

/* Returns true if the sample was recorded but not yet marked as performed, because the kill came
 * between the two calls. */
static bool was_given(const waiting_lane *lane)
{
    const mrt_sample *given = &lane->track->newest, *now = &lane->now.sample;
    return lane->now.number == lane->of.done && given->count == now->count &&
           given->sequence == now->sequence &&
           memcmp(given->value, now->value, now->count * sizeof *now->value) == 0;
}

/* Moves to the next arrival. Performed samples are read too, to find the rhythm. A sample with
 * other channels has no track yet, and ends the lane. */
static void next_arrival(waiting_lane *lane, const spool *left)
{
    const leftover_track *track = lane->track;
    for (lane->is_there = false; !lane->is_there && lane->next < lane->of.count;) {
        spool_lane_read(left, lane->index, lane->next++, &lane->now);
        const bool is_of_track =
            writer_arrivals_mark(track->track.id, lane->now.version) == lane->of.whose;
        if (!is_of_track && is_waiting(lane))
            lane->next = lane->of.count;
        lane->is_there = is_of_track && lane->now.sample.count == track->track.channel_count &&
                         writer_track_is_time(lane->now.sample.time_ns) && !was_given(lane);
    }
}

static mrt_result add_lanes(leftover *self, const spool *left, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; i < SPOOL_LANES && result >= 0; ++i) {
        waiting_lane *lane = &self->lane[self->lane_count];
        *lane = (waiting_lane){.index = i, .of = spool_lane_of(left, i)};
        const int64_t id = lane->of.whose / VERSIONS_MAX;
        if (id <= 0 || lane->of.count == 0)
            continue;
        result = find_track(self, id, &lane->track, err);
        if (result < 0 || !lane->track || !lane->track->is_known)
            continue;
        lane->rhythm.measures = lane->track->measures;
        next_arrival(lane, left);
        self->lane_count += 1;
    }
    return result;
}

/* Chooses the next step; false: no more steps. */
static bool choose_step(leftover *self, int64_t *out_time_ns)
{
    waiting_lane *first = NULL, *end = self->lane + self->lane_count;
    for (waiting_lane *l = self->lane; l < end; ++l)
        if (l->is_there && (!first || l->now.sample.time_ns < first->now.sample.time_ns))
            first = l;
    if (!first)
        return false;
    step_choice choice = step_choice_of(&first->rhythm, first->now.sample.time_ns);
    for (waiting_lane *l = self->lane; l < end; ++l)
        l->is_chosen = l == first || (l->is_there && step_choice_pairs(&choice, &l->rhythm,
                                                                       l->now.sample.time_ns));
    for (waiting_lane *l = self->lane; l < end; ++l)
        l->is_chosen |=
            l->is_there && step_choice_covers(&choice, &l->rhythm, l->now.sample.time_ns);
    *out_time_ns = choice.until_ns;
    return true;
}

static int64_t newest_given_ns(const leftover *self)
{
    int64_t out = INT64_MIN;
    for (uint32_t i = 0; i < self->lane_count; ++i) {
        const mrt_sample *newest = &self->lane[i].track->newest;
        if (newest->count > 0 && writer_track_is_time(newest->time_ns) &&
            newest->time_ns - self->to_show_ns > out)
            out = newest->time_ns - self->to_show_ns;
    }
    return out;
}

static mrt_result take_arrivals(leftover *self, spool *left, error *err)
{
    mrt_result result = add_lanes(self, left, err);
    int64_t time_ns, last_ns = newest_given_ns(self);
    for (uint64_t n = 1; result >= 0 && choose_step(self, &time_ns); ++n) {
        time_ns = time_ns > last_ns ? time_ns : last_ns + 1;
        for (uint32_t i = 0; i < self->lane_count && result >= 0; ++i) {
            waiting_lane *lane = &self->lane[i];
            if (!lane->is_chosen)
                continue;
            step_rhythm_record(&lane->rhythm, lane->now.sample.time_ns, n);
            lane->now.sample.time_ns = time_ns;
            if (is_waiting(lane)) {
                result = take_sample(self, lane->track->track.id, &lane->now.sample, err);
                last_ns = time_ns;
            }
            next_arrival(lane, left);
        }
    }
    return result;
}

static mrt_result take_all(leftover *self, spool *left, error *err)
{
    writer_record record;
    mrt_result result = MRT_OK;
    while (result >= 0 && spool_pop(left, &record)) {
        if (record.kind == WRITER_RECORD_SAMPLE)
            result = take_sample(self, record.id, &record.of.sample, err);
        else if (record.kind == WRITER_RECORD_EVENT &&
                 writer_track_is_time(record.of.event.time_ns))
            result = take_event_once(self, &record.of.event, err);
    }
    if (result >= 0)
        result = take_arrivals(self, left, err);
    for (uint32_t i = 0; i < self->track_count && result >= 0; ++i)
        result = put_chunk(self, &self->track[i], err);
    return result;
}

/* ---- the complete restore ---- */

static mrt_result commit(leftover *self, spool *left, error *err)
{
    int64_t last_id;
    mrt_result result = sqlite_begin(self->store.db, err);
    if (result < 0)
        return result;
    result = sqlite_number(self->store.db, "SELECT MAX(id) FROM chunk", 0, &last_id, err);
    self->next_chunk_id = last_id + 1;
    if (result >= 0)
        result = take_all(self, left, err);
    return sqlite_end(self->store.db, result, err);
}

/* Checks that the last session of the show is the killed one. Another file may have got the same
 * place on the disk. */
static mrt_result check_session(show *s, int64_t to_show_ns, bool *out_is_ours, error *err)
{
    int64_t offset_ns;
    mrt_result result = sqlite_number(s->db,
                                      "SELECT CASE WHEN ended_ns IS NULL THEN utc_ns - monotonic_ns"
                                      " END FROM session ORDER BY id DESC LIMIT 1",
                                      INT64_MIN, &offset_ns, err);
    *out_is_ours = result >= 0 && offset_ns == to_show_ns;
    return result;
}

mrt_result writer_leftover_commit(show *s, error *err)
{
    bool is_ours;
    int64_t to_show_ns;
    spool *left = spool_find(&s->file, &writer_spool_shape, &to_show_ns);
    if (!left)
        return MRT_OK;
    mrt_result result = check_session(s, to_show_ns, &is_ours, err);
    if (result < 0 || !is_ours) {
        spool_destroy(left);
        return result;
    }
    leftover *self = calloc(1, sizeof *self);
    result = MRT_ERR_MEMORY;
    if (!self)
        goto done;
    self->to_show_ns = to_show_ns;
    self->sample = malloc(CHUNK_SAMPLES_MAX * sizeof *self->sample);
    if (!self->sample)
        goto done;
    result = writer_store_open(&self->store, s, 0, err);
    if (result >= 0)
        result = commit(self, left, err);
    writer_store_close(&self->store);
done:
    for (uint32_t i = 0; self && i < self->track_count; ++i)
        writer_track_finish(&self->track[i].track);
    if (self)
        free(self->sample);
    free(self);
    if (result >= 0)
        spool_destroy(left);
    else
        spool_abandon(left);
    if (result == MRT_ERR_MEMORY)
        error_set(err, result, "%s: out of memory while restoring the last recording", s->path);
    return result;
}

/* ---- the journal ---- */

enum {
    CHUNKS_A_STEP = 256,
    CHECKPOINTS_A_STEP = 4,
    PAGES_A_STEP = 64,
    PAGES_KEPT = 1024 /* free pages, reused by new recordings */
};

/* Keeps data back to the last checkpoint before the journal's length, so that a take of the whole
 * journal can be replayed from its start. */
static mrt_result limit_of(const journal *self, sqlite *db, int64_t now_ns, int64_t *out,
                           error *err)
{
    *out = now_ns - self->length_ns;
    sqlite_statement *row = sqlite_query(db,
                                         "SELECT MAX(c.time_ns) FROM performance p JOIN checkpoint "
                                         "c  ON c.performance = p.id WHERE c.time_ns <= ?1"
                                         "  AND COALESCE(p.to_ns, ?1) >= ?1",
                                         "I", "i", *out);
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK && !sqlite_is_null(row, 0))
        *out = sqlite_int(row, 0);
    return sqlite_finish_rows(row, result);
}

/* Finds the last of the next chunks that are all older than the limit; returns the last checked
 * chunk if there is none. */
static mrt_result next_chunks(const journal *self, sqlite *db, int64_t limit_ns, int64_t *out_last,
                              bool *out_is_done, error *err)
{
    sqlite_statement *rows =
        sqlite_query(db, "SELECT id, to_ns FROM chunk WHERE id > ? ORDER BY id LIMIT ?", "ii", "ii",
                     self->looked_at_id, (int64_t)CHUNKS_A_STEP);
    int count = 0;
    *out_last = self->looked_at_id;
    mrt_result result;
    while ((result = sqlite_step(rows, err)) == MRT_OK && sqlite_int(rows, 1) < limit_ns) {
        *out_last = sqlite_int(rows, 0);
        ++count;
    }
    *out_is_done = count < CHUNKS_A_STEP;
    return sqlite_finish_rows(rows, result);
}

/* Deletes chunks. pruned_until_ns marks the gaps as valid for readers. A span that begins or ends
 * in a pause of a hand also keeps the chunk before and after it, so that no gap touches the span.
 * */
static mrt_result delete_chunks(const journal *self, sqlite *db, int64_t last_id, error *err)
{
    int64_t until_ns = INT64_MIN;
    sqlite_statement *gone = sqlite_query(
        db,
        "DELETE FROM chunk WHERE id > ? AND id <= ? AND NOT EXISTS("
        "  SELECT 1 FROM span WHERE need_ns < COALESCE((SELECT MIN(n.from_ns)"
        "      FROM chunk n WHERE n.track = chunk.track AND n.from_ns > chunk.from_ns),"
        "      chunk.to_ns + 1)"
        "    AND (to_ns IS NULL OR to_ns > COALESCE((SELECT p.to_ns FROM chunk p"
        "      WHERE p.track = chunk.track AND p.from_ns < chunk.from_ns"
        "      ORDER BY p.from_ns DESC LIMIT 1), chunk.from_ns - 1))"
        "    AND (performance IS NULL OR EXISTS(SELECT 1 FROM performance_track p"
        "      WHERE p.performance = span.performance AND p.track = chunk.track)))"
        " RETURNING to_ns",
        "i", "ii", self->looked_at_id, last_id);
    mrt_result result;
    while ((result = sqlite_step(gone, err)) == MRT_OK)
        if (sqlite_int(gone, 0) > until_ns)
            until_ns = sqlite_int(gone, 0);
    result = sqlite_finish_rows(gone, result);
    if (result < 0 || until_ns == INT64_MIN)
        return result;
    return sqlite_change(db, err,
                         "INSERT INTO meta(key, value) VALUES('pruned_until_ns', ?)"
                         " ON CONFLICT(key) DO UPDATE SET value = MAX(value, excluded.value)",
                         "i", until_ns);
}

static mrt_result delete_checkpoints(sqlite *db, int64_t limit_ns, error *err)
{
    return sqlite_change(db, err,
                         "DELETE FROM checkpoint WHERE id IN (SELECT id FROM checkpoint c"
                         "  WHERE time_ns < ?1 AND NOT EXISTS(SELECT 1 FROM span"
                         "    WHERE span.performance = c.performance AND need_ns <= c.time_ns"
                         "    AND (to_ns IS NULL OR to_ns >= c.time_ns)) LIMIT ?2)",
                         "ii", limit_ns, (int64_t)CHECKPOINTS_A_STEP);
}

mrt_result journal_step(journal *self, sqlite *db, int64_t now_ns, bool *out_is_done, error *err)
{
    int64_t limit_ns, last_id;
    *out_is_done = true;
    mrt_result result = limit_of(self, db, now_ns, &limit_ns, err);
    if (result >= 0)
        result = next_chunks(self, db, limit_ns, &last_id, out_is_done, err);
    if (result >= 0 && last_id > self->looked_at_id)
        result = delete_chunks(self, db, last_id, err);
    if (result >= 0)
        result = delete_checkpoints(db, limit_ns, err);
    if (result >= 0)
        self->looked_at_id = last_id;
    return result;
}

mrt_result journal_shrink(sqlite *db, error *err)
{
    int64_t free_count, page_count;
    mrt_result result = sqlite_number(db, "PRAGMA freelist_count", 0, &free_count, err);
    if (result >= 0)
        result = sqlite_number(db, "PRAGMA page_count", 0, &page_count, err);
    if (result < 0 || free_count < PAGES_KEPT || free_count < page_count / 4)
        return result;
    char sql[64];
    (void)snprintf(sql, sizeof sql, "PRAGMA incremental_vacuum(%d)", PAGES_A_STEP);
    return sqlite_run(db, sql, err);
}
