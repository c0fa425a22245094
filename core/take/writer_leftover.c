#include "take/writer_leftover.h"

#include "take/chunk.h"
#include "take/writer_state.h"

#include <stdlib.h>
#include <string.h>

typedef struct leftover_track {
    writer_track track;
    bool is_known; /* in the show */
    bool has_last; /* of the samples that the show has */
    int64_t last_ns;
    uint32_t last_sequence;
} leftover_track;

typedef struct leftover {
    writer_store store;
    int64_t to_show_ns, next_chunk_id;
    leftover_track track[WRITER_TRACKS_MAX];
    uint32_t track_count;
    mrt_sample *sample; /* CHUNK_SAMPLES_MAX */
} leftover;

/* ---- where each track stands ---- */

static mrt_result read_end_of(leftover *self, leftover_track *out, int64_t id, error *err)
{
    sqlite_statement *last;
    mrt_result result = sqlite_query(self->store.db, &last, err,
                                     "SELECT bytes FROM chunk WHERE track = ? "
                                     "ORDER BY from_ns DESC, id DESC LIMIT 1",
                                     "b", "i", id);
    if (result < 0)
        return result;
    result = sqlite_step(last, err);
    if (result == MRT_OK) {
        chunk_head head;
        size_t size;
        const uint8_t *bytes = sqlite_blob(last, 0, &size);
        if (chunk_decode(self->sample, &head, bytes, size, NULL) < 0) {
            out->is_known = false; /* a damaged end: its chunk's number is not known */
        } else {
            out->track.ordinal = head.ordinal + 1;
            out->has_last = true;
            out->last_ns = self->sample[head.sample_count - 1].time_ns;
            out->last_sequence = self->sample[head.sample_count - 1].sequence;
        }
    }
    sqlite_finish(last);
    return result < 0 ? result : MRT_OK;
}

/* A track whose row was not committed has nowhere to go: known, but of no use. */
static mrt_result add_track(leftover *self, int64_t id, leftover_track **out, error *err)
{
    sqlite_statement *channels;
    *out = NULL;
    if (self->track_count == WRITER_TRACKS_MAX)
        return MRT_OK;
    mrt_result result = sqlite_query(self->store.db, &channels, err,
                                     "SELECT COUNT(*) FROM channel WHERE track = ?", "i", "i", id);
    if (result < 0)
        return result;
    result = sqlite_step(channels, err);
    int64_t count = result == MRT_OK ? sqlite_int(channels, 0) : 0;
    sqlite_finish(channels);
    leftover_track *track = &self->track[self->track_count];
    if (result >= 0)
        result = writer_track_init(&track->track, id, (uint32_t)count, err);
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
    mrt_result result = writer_track_put(&track->track, &self->store, err);
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
    return result;
}

static mrt_result take_event_once(leftover *self, const take_event *given, error *err)
{
    sqlite_statement *same;
    take_event event = *given;
    event.time_ns += self->to_show_ns;
    mrt_result result = sqlite_query(self->store.db, &same, err,
                                     "SELECT 1 FROM event WHERE time_ns = ? AND kind = ?"
                                     " AND track = ? AND param = ? AND value = ?",
                                     "i", "iiiid", event.time_ns, (int64_t)event.kind, event.track,
                                     (int64_t)event.param, event.value);
    if (result < 0)
        return result;
    result = sqlite_step(same, err);
    sqlite_finish(same);
    return result == MRT_END ? show_event_insert(self->store.db, &event, err) : result;
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
    for (uint32_t i = 0; i < self->track_count && result >= 0; ++i)
        result = put_chunk(self, &self->track[i], err);
    return result;
}

/* ---- the whole ---- */

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

/* The file may be another one by now, at the same place on the disk: then its last session is not
 * the one that was killed. */
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
    struct stat of = {.st_dev = s->device, .st_ino = s->inode};
    spool *left = spool_find(&of, sizeof(writer_record), &to_show_ns);
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
        error_set(err, result, "%s: no memory to read what is left of the last recording", s->path);
    return result;
}
