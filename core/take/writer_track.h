/* take/writer_track.h - the samples of one track on their way: those of the chunk that is growing,
 * and how many of them the show has already. For the writer. */
#ifndef MAROTTE_TAKE_WRITER_TRACK_H
#define MAROTTE_TAKE_WRITER_TRACK_H
#include "take/writer_job.h"

enum { WRITER_CHUNK_SAMPLES = 512 }; /* and at most one second, whichever is less */

typedef struct writer_track {
    int64_t id; /* 0: not in use */
    uint32_t channel_count;
    int64_t last_ns; /* host clock, of the newest sample taken */
    bool has_last;
    uint32_t count, committed_count; /* of the chunk's samples */
    int64_t chunk_id;                /* 0: none yet */
    uint32_t ordinal;
    uint32_t lost_count; /* not yet told as an event */
    mrt_sample *sample;  /* WRITER_CHUNK_SAMPLES, show time; owned */
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

#endif
