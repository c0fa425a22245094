#include "take/writer_track.h"

#include "base/clock.h"
#include "take/chunk.h"

#include <math.h>
#include <stdlib.h>

static const int64_t chunk_span_ns = NS_PER_S;

mrt_result writer_track_init(writer_track *out, int64_t id, uint32_t channel_count, error *err)
{
    *out = (writer_track){0};
    mrt_sample *sample = calloc(WRITER_CHUNK_SAMPLES, sizeof *sample);
    if (!sample)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record track %lld", (long long)id);
    *out = (writer_track){.id = id, .channel_count = channel_count, .sample = sample};
    return MRT_OK;
}

void writer_track_finish(writer_track *track)
{
    free(track->sample);
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
    mrt_result result =
        chunk_encode(*out, out_size, track->id, track->ordinal, track->sample, track->count, err);
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

mrt_result writer_track_put(const writer_track *track, writer_store *store, error *err)
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
