/* show/writer_store.h - how the writer changes the show: its jobs, the growing chunk of a track,
 * data that a killed writer left, and the journal's deletions. Leaves out threads and queues
 * (writer.c). A job changes only the database, so after a failed transaction its jobs run again.
 * For the writer's thread and show_open.c. */
#ifndef MAROTTE_TAKE_WRITER_STORE_H
#define MAROTTE_TAKE_WRITER_STORE_H
#include "show/chunk.h"
#include "show/show_file.h"
#include "show/spool.h"

/* ---- records in the spool ---- */

typedef enum writer_record_kind {
    WRITER_RECORD_SAMPLE,
    WRITER_RECORD_EVENT,
    WRITER_RECORD_CHECKPOINT
} writer_record_kind;
typedef struct writer_record { /* a record of the ring */
    writer_record_kind kind;
    int64_t id; /* id of the track or performance */
    union {
        mrt_sample sample;
        take_event event;
        struct {
            int64_t time_ns;
            uint32_t version, buffer;
            size_t size;
        } checkpoint;
    } of;
} writer_record;

/* A sample that has arrived, in a lane of the spool. Until it is performed it is stored nowhere
 * else. */
typedef struct writer_arrival {
    uint32_t number,
        version; /* number: of the input's samples, +1 each; version: of its channels */
    mrt_sample sample;
} writer_arrival;
/* Returns the mark of a lane: a track, and the version of the input's channels of that track. */
int64_t writer_arrivals_mark(int64_t track, uint32_t version);

extern const spool_shape writer_spool_shape;

enum { WRITER_TRACKS_MAX = 64 };

/* ---- jobs ---- */

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
    WRITER_JOB_SESSION_END /* from_ns; ends everything that is open */
} writer_job_kind;

typedef struct writer_job {
    struct writer_job *next;
    writer_job_kind kind;
    _Atomic bool
        *lent; /* flag of a pool of writer.c; false returns the job. NULL: the job is allocated */
    take_texts *texts;      /* texts of the track or performance; held */
    size_t held_bytes;      /* size in memory */
    int64_t id;             /* id of the track, performance, take, chunk or audio */
    int64_t from_ns, to_ns; /* show time; to_ns of take, keep and chunk */
    union {
        take_track
            *track; /* owned, except in a lent job; pointers, since most jobs are far smaller */
        take_performance *performance;
        take_event event;
        show_packed checkpoint;
        struct {
            char scene[TAKE_NAME], shot[TAKE_NAME];
            uint32_t number;
            int64_t over, over_at_ns;
            double fps;
            int64_t timecode_frame;
            bool is_drop_frame;
        } slate;
        struct {
            int64_t track;
            uint32_t sample_count;
            int64_t newest_ns; /* host clock */
        } chunk;
        int64_t chunk_count;
    } of;
    char mapping[TAKE_IDENTITY]; /* mapping of a performance, replaces that of its texts; "": not
                                    replaced */
    size_t byte_count;
    uint8_t *bytes; /* chunk or audio data; owned */
} writer_job;

/* Creates a job, with space for a track or a performance if it is for one. NULL: no memory. */
writer_job *writer_job_create(writer_job_kind kind);
/* Frees a job, or returns a lent one to its pool. */
void writer_job_destroy(writer_job *job);
/* Copies a lent job to an allocated one, and returns the lent one to its pool. NULL: no memory, and
 * the lent job is unchanged. */
writer_job *writer_job_own(writer_job *lent);
/* Copies the description into the job, and holds the texts. The caller may then drop them. */
void writer_job_set_track(writer_job *job, const take_track *track, take_texts *texts);
void writer_job_set_performance(writer_job *job, const take_performance *performance,
                                take_texts *texts);
CHECKED mrt_result writer_job_copy_bytes(writer_job *job, const void *bytes, size_t size,
                                         error *err);

typedef struct writer_store { /* destination of jobs */
    sqlite *db;
    int64_t session;
    sqlite_statement *put_chunk; /* prepared once, because it runs most often */
} writer_store;
CHECKED mrt_result writer_store_open(writer_store *out, const show *s, int64_t session, error *err);
void writer_store_close(writer_store *store);
/* As writer_store_open, on a connection and in a transaction of the caller. */
CHECKED mrt_result writer_store_borrow(writer_store *out, sqlite *db, int64_t session, error *err);
void writer_store_give_back(writer_store *store); /* accepts zeroed */

CHECKED mrt_result writer_job_run(const writer_job *job, writer_store *store, error *err);

/* ---- the growing chunk of a track ---- */

enum {
    WRITER_CHUNK_SAMPLES = 512
}; /* a chunk ends after this number or after one second, whichever comes first */

typedef struct writer_track {
    int64_t id; /* 0: not in use */
    uint32_t channel_count;
    int64_t last_ns; /* host clock of the newest accepted sample */
    bool has_last;
    uint32_t count, committed_count; /* samples in the chunk; those of them that are committed */
    int64_t chunk_id;                /* 0: none yet */
    uint32_t ordinal;
    uint32_t lost_count;  /* lost samples that no event reports yet */
    mrt_sample *sample;   /* WRITER_CHUNK_SAMPLES, show time; owned */
    chunk_packer *packer; /* owned */
} writer_track;

CHECKED mrt_result writer_track_init(writer_track *out, int64_t id, uint32_t channel_count,
                                     error *err);
void writer_track_finish(writer_track *track);

/* Returns true for a time that the show can store: within 73 years of the host's 0. */
bool writer_track_is_time(int64_t time_ns);
/* Returns true if the sample fits the track: number of channels, order of times, finite values. */
bool writer_track_accepts(const writer_track *track, const mrt_sample *sample);
/* Returns true if the chunk has its full length; seal it before the next sample. */
bool writer_track_is_full(const writer_track *track, int64_t next_show_ns);
/* Returns a job that writes the current chunk. NULL: the chunk is already written, or memory ran
 * out and *out_failed is true. A chunk without an id gets chunk_id. */
writer_job *writer_track_seal(const writer_track *track, int64_t chunk_id, bool *out_failed);
/* Makes the next sample start a new chunk. `was_kept`: the show has, or will have, samples of this
 * chunk. */
void writer_track_next_chunk(writer_track *track, bool was_kept);
/* Writes the current chunk. */
CHECKED mrt_result writer_track_write(const writer_track *track, writer_store *store, error *err);

/* ---- data that a killed writer left uncommitted ---- */

/* Commits the leftover data in a separate transaction. MRT_OK if there is none. */
CHECKED mrt_result writer_leftover_commit(show *s, error *err);

/* ---- the journal: deletes old recordings that no take needs ---- */

/* Deletes in small steps, so that other work is not delayed, and returns the space to the disk. It
 * keeps everything that a span of a take needs, also of a deleted take. That includes the data for
 * a replay from its start, and the nearest samples before and after it. */
typedef struct journal {
    int64_t length_ns;
    int64_t looked_at_id; /* chunks up to this one were checked; takes never need less later */
} journal;

/* Runs one step in the caller's transaction. now_ns: show time of the newest sample. *out_is_done:
 * nothing more can be deleted now. */
CHECKED mrt_result journal_step(journal *self, sqlite *db, int64_t now_ns, bool *out_is_done,
                                error *err);
/* Runs one step outside a transaction: returns free pages to the disk if there are many. */
CHECKED mrt_result journal_shrink(sqlite *db, error *err);

#endif
