/* show/writer_store.h - what the writer puts into the show, and how: jobs, the growing chunk of a
 * track, what a killed writer had been given; and what it lets go. Running a job changes only the
 * database: a transaction that failed runs its jobs again. For the writer and show_open.c. */
#ifndef MAROTTE_TAKE_WRITER_STORE_H
#define MAROTTE_TAKE_WRITER_STORE_H
#include "show/chunk.h"
#include "show/show_file.h"
#include "show/spool.h"

/* ---- what is given while it happens; a spool keeps it ---- */

typedef enum writer_record_kind {
    WRITER_RECORD_SAMPLE,
    WRITER_RECORD_EVENT,
    WRITER_RECORD_CHECKPOINT
} writer_record_kind;
typedef struct writer_record { /* of the ring */
    writer_record_kind kind;
    int64_t id; /* of the track or performance */
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

/* What an input measured, from when it arrives: as long as nobody has performed it, it is nowhere
 * else. Of a lane of the spool. */
typedef struct writer_arrival {
    uint32_t number, version; /* of the input's samples, +1 each; of its channels */
    mrt_sample sample;
} writer_arrival;
/* Whose a lane is: a track, and the version of the input's channels that are the track's. */
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
    WRITER_JOB_SESSION_END /* from_ns; ends all that goes on */
} writer_job_kind;

typedef struct writer_job {
    struct writer_job *next;
    writer_job_kind kind;
    _Atomic bool *lent;     /* of a pool of writer.c's: false gives it back; NULL: allocated */
    take_texts *texts;      /* of the track or performance; held */
    size_t held_bytes;      /* of memory */
    int64_t id;             /* of the track, performance, take, chunk or audio */
    int64_t from_ns, to_ns; /* show time; to_ns of take, keep and chunk */
    union {
        take_track *track; /* these two owned, but if lent: most jobs are far smaller */
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
            int64_t newest_ns; /* of the host's clock */
        } chunk;
        int64_t chunk_count;
    } of;
    char mapping[TAKE_IDENTITY]; /* of a performance, in place of that of its texts; "" as there */
    size_t byte_count;
    uint8_t *bytes; /* of a chunk or of audio; owned */
} writer_job;

/* NULL: no memory. A track's or a performance's has room for it. */
writer_job *writer_job_create(writer_job_kind kind);
/* One that is lent goes back to its pool. */
void writer_job_destroy(writer_job *job);
/* Of one that is lent, which goes back to its pool; NULL: no memory, and it stays as it is. */
writer_job *writer_job_own(writer_job *lent);
/* Into the job's room; whoever made the texts may let go of them then. */
void writer_job_put_track(writer_job *job, const take_track *track, take_texts *texts);
void writer_job_put_performance(writer_job *job, const take_performance *performance,
                                take_texts *texts);
CHECKED mrt_result writer_job_copy_bytes(writer_job *job, const void *bytes, size_t size,
                                         error *err);

typedef struct writer_store { /* where to */
    sqlite *db;
    int64_t session;
    sqlite_statement *put_chunk; /* prepared once: it is the one that runs all the time */
} writer_store;
CHECKED mrt_result writer_store_open(writer_store *out, const show *s, int64_t session, error *err);
void writer_store_close(writer_store *store);

CHECKED mrt_result writer_job_run(const writer_job *job, writer_store *store, error *err);

/* ---- the samples of one track on their way: those of the chunk that is growing ---- */

enum { WRITER_CHUNK_SAMPLES = 512 }; /* and at most one second, whichever is less */

typedef struct writer_track {
    int64_t id; /* 0: not in use */
    uint32_t channel_count;
    int64_t last_ns; /* host clock, of the newest sample taken */
    bool has_last;
    uint32_t count, committed_count; /* of the chunk's samples */
    int64_t chunk_id;                /* 0: none yet */
    uint32_t ordinal;
    uint32_t lost_count;  /* not yet told as an event */
    mrt_sample *sample;   /* WRITER_CHUNK_SAMPLES, show time; owned */
    chunk_packer *packer; /* likewise */
} writer_track;

CHECKED mrt_result writer_track_init(writer_track *out, int64_t id, uint32_t channel_count,
                                     error *err);
void writer_track_finish(writer_track *track);

/* Times that the show can keep: 73 years, either way of the host's 0. */
bool writer_track_is_time(int64_t time_ns);
/* Whether the sample is one of this track's: shape, order and numbers. */
bool writer_track_accepts(const writer_track *track, const mrt_sample *sample);
/* The chunk is as long as chunks get: seal it before the next sample. */
bool writer_track_is_full(const writer_track *track, int64_t next_show_ns);
/* A job that writes the chunk as it is; NULL: everything of it is written, or there is no memory
 * and *out_failed says so. The id is used if it has none yet. */
writer_job *writer_track_seal(const writer_track *track, int64_t chunk_id, bool *out_failed);
/* The next sample starts a chunk. `was_kept`: the show has, or will have, some of this one. */
void writer_track_next_chunk(writer_track *track, bool was_kept);
/* Writes what is there of the chunk. */
CHECKED mrt_result writer_track_put(const writer_track *track, writer_store *store, error *err);

/* ---- what a killed writer had been given, and had not committed ---- */

/* In a transaction of its own. Nothing left is no error. */
CHECKED mrt_result writer_leftover_commit(show *s, error *err);

/* ---- the journal: what was recorded, is old, and no take holds on to is let go ---- */

/* In small steps, so that nobody waits for it, and giving the space back to the disk. Left is
 * everything that a span of a take needs, that of deleted takes too, what a replay needs to start
 * there, and the next samples on both sides of it. */
typedef struct journal {
    int64_t length_ns;
    int64_t looked_at_id; /* chunks up to this one were looked at: takes never need less later */
} journal;

/* One step, in the caller's transaction. now_ns: show time of the newest sample. *out_is_done:
 * there is nothing more to look at now. */
CHECKED mrt_result journal_step(journal *self, sqlite *db, int64_t now_ns, bool *out_is_done,
                                error *err);
/* One step, outside of a transaction: gives free pages back where there are many. */
CHECKED mrt_result journal_shrink(sqlite *db, error *err);

#endif
