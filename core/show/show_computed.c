/* Performances whose samples were computed. */
#include "show/writer_store.h"
#include "base/clock.h"
#include "base/os.h"

#include <stdio.h>
#include <unistd.h>

static mrt_result insert_session(show *self, const char *program, int64_t *out_id, error *err)
{
    char host[128];
    const int64_t now_ns = clock_utc_ms() * NS_PER_MS;
    os_host_name(host, sizeof host);
    mrt_result result =
        sqlite_change(self->db, err,
                      "INSERT INTO session(utc_ns, monotonic_ns, ended_ns, program, host, process)"
                      "VALUES(?1, ?1, ?1, ?2, ?3, ?4)",
                      "itti", now_ns, program, host, (int64_t)getpid());
    *out_id = result < 0 ? 0 : sqlite_last_id(self->db);
    return result;
}

static mrt_result write_chunk(show *self, writer_track *track, writer_store *store, error *err)
{
    track->chunk_id = show_next_id(self, SHOW_ID_CHUNK);
    const mrt_result result = writer_track_write(track, store, err);
    writer_track_next_chunk(track, true);
    return result;
}

static mrt_result write_samples(show *self, const show_computed *made, writer_store *store,
                                error *err)
{
    writer_track track;
    mrt_sample sample;
    mrt_result result = writer_track_init(&track, made->track->id, made->track->channel_count, err);
    while (result >= 0 && made->next(made->data, &sample)) {
        if (!writer_track_accepts(&track, &sample)) {
            result = error_set(err, MRT_ERR_ARGUMENT, "%s: a computed sample at %lld ns is invalid",
                               self->path, (long long)sample.time_ns);
            break;
        }
        track.last_ns = sample.time_ns;
        track.has_last = true;
        sample.time_ns += SHOW_COMPUTED_NS;
        if (writer_track_is_full(&track, sample.time_ns))
            result = write_chunk(self, &track, store, err);
        track.sample[track.count++] = sample;
    }
    if (result >= 0 && track.count > 0)
        result = write_chunk(self, &track, store, err);
    if (result >= 0)
        result = sqlite_change(self->db, err, "UPDATE track SET chunk_count = ? WHERE id = ?", "ii",
                               (int64_t)track.ordinal, track.id);
    writer_track_finish(&track);
    return result;
}

static mrt_result insert_all(show *self, const show_computed *made, error *err)
{
    writer_store store = {0};
    int64_t session;
    const int64_t to_ns = SHOW_COMPUTED_NS + made->length_ns;
    mrt_result result = insert_session(self, made->program, &session, err);
    if (result >= 0)
        result = writer_store_borrow(&store, self->db, session, err);
    if (result >= 0)
        result = show_track_insert(self->db, session, made->track, err);
    if (result >= 0)
        result = write_samples(self, made, &store, err);
    if (result >= 0)
        result =
            show_performance_insert(self->db, session, made->performance, SHOW_COMPUTED_NS, err);
    if (result >= 0)
        result = sqlite_change(self->db, err, "UPDATE performance SET to_ns = ? WHERE id = ?", "ii",
                               to_ns, made->performance->id);
    if (result >= 0)
        result = show_span_insert(self->db, made->take, made->performance->id, SHOW_COMPUTED_NS,
                                  &to_ns, false, err);
    writer_store_give_back(&store);
    return result;
}

mrt_result show_computed_create(show *self, const show_computed *made, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = sqlite_begin(self->db, err);
    if (result < 0)
        return result;
    made->track->id = show_next_id(self, SHOW_ID_TRACK);
    made->performance->id = show_next_id(self, SHOW_ID_PERFORMANCE);
    made->performance->track[0] = made->track->id;
    made->performance->track_count = 1;
    return sqlite_end(self->db, insert_all(self, made, err), err);
}
