/* take/writer_state.h - what the writer's files share. writer_in.c takes in what was given, and
 * writer_commit.c commits it: both on the writer's thread. writer.c is what everybody else calls.
 */
#ifndef MAROTTE_TAKE_WRITER_STATE_H
#define MAROTTE_TAKE_WRITER_STATE_H
#include "take/journal.h"
#include "take/spool.h"
#include "take/writer_job.h"
#include "take/writer_sync.h"
#include "take/writer_track.h"

#include <pthread.h>
#include <stdatomic.h>

enum { WRITER_STAGED = 512 };

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

typedef struct writer_jobs {
    writer_job *first, **end; /* `end`: where the next one goes */
} writer_jobs;

struct writer {
    show *of;
    int64_t to_show_ns; /* show time - host clock */
    size_t memory_bytes, checkpoint_bytes;
    pthread_t thread;
    writer_sync *sync;

    /* [frame] to the thread */
    spool *ring;
    uint8_t *checkpoint[WRITER_CHECKPOINTS];
    _Atomic bool is_taken[WRITER_CHECKPOINTS];
    _Atomic uint32_t ring_lost_samples, ring_lost_events, given_samples;

    _Atomic uint32_t track_count; /* [main], and who records */

    /* [main] to the thread and back */
    pthread_mutex_t lock;
    pthread_cond_t wake, done;
    writer_jobs asked;      /* GUARDED_BY(lock) */
    uint64_t flush_asked;   /* GUARDED_BY(lock) */
    uint64_t flush_done;    /* GUARDED_BY(lock) */
    bool is_stopping;       /* GUARDED_BY(lock) */
    mrt_result last_result; /* GUARDED_BY(lock): of the last commit */
    error last_error;       /* GUARDED_BY(lock) */

    /* the thread's own */
    writer_store store;
    writer_jobs pending;
    writer_track *track; /* track_slots of them; id 0: free */
    uint32_t track_slots;
    int64_t next_chunk_id;
    journal old;
    int64_t next_journal_ns; /* show time */
    int64_t newest_ns;       /* host clock, of the newest sample taken */
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

/* Lists of jobs. */
void writer_jobs_init(writer_jobs *list);
void writer_jobs_add(writer_jobs *list, writer_job *job);
writer_job *writer_jobs_take(writer_jobs *list); /* the first; NULL: empty */
void writer_jobs_destroy(writer_jobs *list);

/* [thread] Takes in what was given and asked for. */
void writer_in(writer *self);
/* [thread] Ends the tracks and the session, when nothing more comes. */
void writer_in_end(writer *self);
/* [thread] Samples that will not be in the show; `track` NULL: of none that is known. */
void writer_in_lose(writer *self, writer_track *track, uint32_t count);

/* [thread] Commits all that was taken in; < 0: it waits, and the status says so. */
mrt_result writer_commit(writer *self);
/* [thread] There is something that is not committed. */
bool writer_commit_is_due(const writer *self);
/* [thread] A step of the journal, once a second. */
void writer_commit_journal(writer *self);

#endif
