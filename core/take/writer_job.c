#include "take/writer_job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- jobs in memory ---- */

writer_job *writer_job_create(writer_job_kind kind)
{
    writer_job *job = calloc(1, sizeof *job);
    if (!job)
        return NULL;
    job->kind = kind;
    job->held_bytes = sizeof *job;
    return job;
}

void writer_job_destroy(writer_job *job)
{
    if (!job)
        return;
    if (job->kind == WRITER_JOB_TRACK)
        take_track_finish(&job->of.track);
    if (job->kind == WRITER_JOB_PERFORMANCE)
        take_performance_finish(&job->of.performance);
    if (job->kind == WRITER_JOB_CHECKPOINT)
        free(job->of.checkpoint.bytes);
    free(job->bytes);
    free(job);
}

/* Replaces the text by a copy of it. */
static bool own_text(char **text)
{
    if (!*text)
        return true;
    *text = strdup(*text);
    return *text != NULL;
}

mrt_result writer_job_copy_track(writer_job *job, const take_track *track, error *err)
{
    take_track *copy = &job->of.track;
    *copy = *track;
    bool good = own_text(&copy->input);
    good &= own_text(&copy->device);
    good &= own_text(&copy->plugin);
    good &= own_text(&copy->calibration[0]);
    good &= own_text(&copy->calibration[1]);
    job->id = track->id;
    return good ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to record a track");
}

mrt_result writer_job_copy_performance(writer_job *job, const take_performance *performance,
                                       error *err)
{
    take_performance *copy = &job->of.performance;
    *copy = *performance;
    bool good = own_text(&copy->mapping);
    good &= own_text(&copy->rig);
    good &= own_text(&copy->rig_json);
    good &= own_text(&copy->again.calibration[0]);
    good &= own_text(&copy->again.calibration[1]);
    job->id = performance->id;
    return good ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory to record a performance");
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

/* ---- where they go ---- */

/* Synchronous NORMAL: a commit does not wait for the disk; writer_sync.h sees to it. */
mrt_result writer_store_open(writer_store *out, const show *s, int64_t session, error *err)
{
    *out = (writer_store){.path = show_path(s), .session = session};
    mrt_result result = show_connect(s, &out->db, err);
    if (result >= 0)
        result =
            sqlite_run(out->db, "PRAGMA synchronous = NORMAL; PRAGMA wal_autocheckpoint = 0", err);
    if (result >= 0)
        result = sqlite_prepare(out->db, &out->put_chunk,
                                "INSERT INTO chunk(id, track, from_ns, to_ns, bytes)"
                                "VALUES(?, ?, ?, ?, ?) ON CONFLICT(id) DO UPDATE"
                                " SET to_ns = excluded.to_ns, bytes = excluded.bytes",
                                "", err);
    if (result < 0)
        writer_store_close(out);
    return result;
}

void writer_store_close(writer_store *store)
{
    sqlite_finish(store->put_chunk);
    sqlite_close(store->db);
    *store = (writer_store){0};
}

mrt_result writer_put_chunk(writer_store *store, int64_t id, int64_t track, int64_t from_ns,
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
    sqlite_statement *takes;
    mrt_result result = sqlite_query(
        db, &takes, err, "SELECT id, start_ns FROM take WHERE end_ns IS NULL", "ii", "");
    if (result < 0)
        return result;
    while ((result = sqlite_step(takes, err)) == MRT_OK) {
        int64_t start_ns = sqlite_int(takes, 1);
        result = show_span_insert(db, sqlite_int(takes, 0), performance,
                                  start_ns > from_ns ? start_ns : from_ns, NULL, true, err);
        if (result < 0)
            break;
    }
    sqlite_finish(takes);
    return result < 0 ? result : MRT_OK;
}

static mrt_result run_performance(const writer_job *job, writer_store *store, error *err)
{
    mrt_result result = end_performance(store->db, job->from_ns, err);
    if (result >= 0)
        result = show_performance_insert(store->db, store->session, &job->of.performance,
                                         job->from_ns, err);
    return result < 0 ? result : show_in_open_takes(store->db, job->id, job->from_ns, err);
}

/* ---- takes ---- */

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
    return show_take_insert(db, &row, err);
}

static mrt_result run_take(const writer_job *job, writer_store *store, error *err)
{
    mrt_result result = insert_take(job, job->from_ns, NULL, "recorded", store->db, err);
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

/* The performances of that time; where there was none, all tracks. */
static mrt_result insert_kept_spans(sqlite *db, int64_t id, int64_t from_ns, int64_t to_ns,
                                    error *err)
{
    sqlite_statement *performances;
    int count = 0;
    mrt_result result = sqlite_query(db, &performances, err,
                                     "SELECT id, MAX(from_ns, ?1), MIN(COALESCE(to_ns, ?2), ?2)"
                                     " FROM performance WHERE from_ns < ?2"
                                     " AND COALESCE(to_ns, ?2) > ?1 ORDER BY from_ns",
                                     "iii", "ii", from_ns, to_ns);
    if (result < 0)
        return result;
    while ((result = sqlite_step(performances, err)) == MRT_OK) {
        int64_t end_ns = sqlite_int(performances, 2);
        ++count;
        result = show_span_insert(db, id, sqlite_int(performances, 0), sqlite_int(performances, 1),
                                  &end_ns, true, err);
        if (result < 0)
            break;
    }
    sqlite_finish(performances);
    if (result >= 0 && count == 0)
        result = show_span_insert(db, id, 0, from_ns, &to_ns, true, err);
    return result < 0 ? result : MRT_OK;
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

/* ---- all of them ---- */

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
        return show_track_insert(store->db, store->session, &job->of.track, err);
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
        return show_audio_append(store->db, store->path, job->id, job->from_ns, job->bytes,
                                 job->byte_count, err);
    case WRITER_JOB_SESSION_END:
        return run_session_end(job, store, err);
    case WRITER_JOB_NONE:
    default:
        return MRT_OK;
    }
}
