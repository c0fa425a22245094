/* take/writer_job.h - one thing to be written, as it waits for it, and how it is written. Running a
 * job changes only the database: a transaction that failed runs its jobs again. For the writer. */
#ifndef MAROTTE_TAKE_WRITER_JOB_H
#define MAROTTE_TAKE_WRITER_JOB_H
#include "take/show_file.h"
#include "take/writer.h"

typedef enum writer_job_kind {
    WRITER_JOB_NONE = 0,
    WRITER_JOB_TRACK,
    WRITER_JOB_TRACK_END,
    WRITER_JOB_PERFORMANCE,
    WRITER_JOB_PERFORMANCE_END,
    WRITER_JOB_TAKE,
    WRITER_JOB_TAKE_END,
    WRITER_JOB_KEEP,
    WRITER_JOB_EVENT,
    WRITER_JOB_CHECKPOINT,
    WRITER_JOB_CHUNK,
    WRITER_JOB_AUDIO,
    WRITER_JOB_SESSION_END /* from_ns; ends all that goes on */
} writer_job_kind;

typedef struct writer_job {
    struct writer_job *next;
    writer_job_kind kind;
    size_t held_bytes;      /* of memory */
    int64_t id;             /* of the track, performance, take, chunk or audio */
    int64_t from_ns, to_ns; /* show time; to_ns of take, keep and chunk */
    union {
        take_track track;
        take_performance performance;
        take_event event;
        show_packed checkpoint;
        struct {
            char scene[TAKE_NAME], shot[TAKE_NAME];
            uint32_t number;
        } slate;
        struct {
            int64_t track;
            uint32_t sample_count;
            int64_t newest_ns; /* of the host's clock */
        } chunk;
        int64_t chunk_count;
    } of;
    size_t byte_count;
    uint8_t *bytes; /* of a chunk or of audio; owned */
} writer_job;

/* NULL: no memory. */
writer_job *writer_job_create(writer_job_kind kind);
void writer_job_destroy(writer_job *job);
CHECKED mrt_result writer_job_copy_track(writer_job *job, const take_track *track, error *err);
CHECKED mrt_result writer_job_copy_performance(writer_job *job, const take_performance *performance,
                                               error *err);
CHECKED mrt_result writer_job_copy_bytes(writer_job *job, const void *bytes, size_t size,
                                         error *err);

typedef struct writer_store { /* where to */
    sqlite *db;
    const char *path;
    int64_t session;
    sqlite_statement *put_chunk; /* prepared once: it is the one that runs all the time */
} writer_store;
CHECKED mrt_result writer_store_open(writer_store *out, const show *s, int64_t session, error *err);
void writer_store_close(writer_store *store);

CHECKED mrt_result writer_job_run(const writer_job *job, writer_store *store, error *err);
/* Makes the chunk, or makes it longer: the samples that it had are the first of those it has now.
 */
CHECKED mrt_result writer_put_chunk(writer_store *store, int64_t id, int64_t track, int64_t from_ns,
                                    int64_t to_ns, const uint8_t *bytes, size_t size, error *err);

#endif
