/* Recorded data: tracks, samples, performances, events, checkpoints, audio. */
#include "show/chunk.h"
#include "show/hash.h"
#include "show/show_file.h"
#include "show/sound_pcm.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* ---- tracks: descriptions of the inputs ---- */

static const char *or_empty(const char *text)
{
    return text ? text : "";
}

static mrt_result insert_calibration(sqlite *db, const char *json, char out_hash[TAKE_HASH],
                                     error *err)
{
    hash_bytes(out_hash, json, strlen(json));
    return sqlite_change(db, err, "INSERT OR IGNORE INTO calibration(hash, json) VALUES(?, ?)",
                         "tt", out_hash, json);
}

static mrt_result insert_channels(sqlite *db, const take_track *track, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t n = 0; n < track->channel_count && result >= 0; ++n) {
        const take_channel *channel = &track->channel[n];
        result = sqlite_change(db, err,
                               "INSERT INTO channel(track, n, name, unit, semantic, hand, min, max)"
                               "VALUES(?, ?, ?, ?, ?, ?, ?, ?)",
                               "iittiidd", track->id, (int64_t)n, channel->name, channel->unit,
                               (int64_t)channel->semantic, (int64_t)channel->hand,
                               (double)channel->min, (double)channel->max);
    }
    return result;
}

static mrt_result insert_plugin(sqlite *db, const char *identity, error *err)
{
    return sqlite_change(db, err, "INSERT OR IGNORE INTO plugin(identity) VALUES(?)", "t",
                         or_empty(identity));
}

mrt_result show_track_insert(sqlite *db, int64_t session, const take_track *track, error *err)
{
    char hash[2][TAKE_HASH];
    mrt_result result = insert_plugin(db, track->plugin, err);
    for (int side = 0; side < 2 && result >= 0; ++side)
        if (track->calibration[side])
            result = insert_calibration(db, track->calibration[side], hash[side], err);
    if (result >= 0)
        result = sqlite_change(
            db, err,
            "INSERT INTO track(id, session, plugin, input, device, left_calibration,"
            "  right_calibration)"
            "VALUES(?, ?, (SELECT id FROM plugin WHERE identity = ?), ?, ?, ?, ?)",
            "iittttt", track->id, session, or_empty(track->plugin), or_empty(track->input),
            or_empty(track->device), track->calibration[0] ? hash[0] : NULL,
            track->calibration[1] ? hash[1] : NULL);
    return result < 0 ? result : insert_channels(db, track, err);
}

static mrt_result read_channels(sqlite *db, take_track *out, error *err)
{
    sqlite_statement *rows = sqlite_query(db,
                                          "SELECT n, name, unit, semantic, hand, min, max FROM "
                                          "channel WHERE track = ? ORDER BY n",
                                          "ittuudd", "i", out->id);
    mrt_result result;
    while ((result = sqlite_step(rows, err)) == MRT_OK) {
        if (out->channel_count == MRT_MAX_CHANNELS || sqlite_int(rows, 0) != out->channel_count) {
            result = error_set(err, MRT_ERR_FORMAT, "track %lld is damaged: channel %lld",
                               (long long)out->id, (long long)sqlite_int(rows, 0));
            break;
        }
        take_channel *channel = &out->channel[out->channel_count++];
        int64_t n;
        double min, max;
        result = sqlite_get(rows, err, &n, channel->name, sizeof channel->name, channel->unit,
                            sizeof channel->unit, &channel->semantic, &channel->hand, &min, &max);
        if (result < 0)
            break;
        channel->min = (float)min;
        channel->max = (float)max;
    }
    return sqlite_finish_rows(rows, result);
}

#define TRACK_QUERY                                                                                \
    "SELECT input, device, identity,"                                                              \
    "  (SELECT json FROM calibration WHERE hash = left_calibration),"                              \
    "  (SELECT json FROM calibration WHERE hash = right_calibration),"                             \
    "  (SELECT from_ns FROM chunk WHERE track = t.id ORDER BY from_ns LIMIT 1),"                   \
    "  (SELECT to_ns FROM chunk WHERE track = t.id ORDER BY from_ns DESC, chunk.id DESC LIMIT 1)"  \
    " FROM track t JOIN plugin ON plugin.id = t.plugin WHERE t.id = ?"

mrt_result show_track_read(show *self, int64_t id, show_track *out, error *err)
{
    *out = (show_track){.track.id = id};
    take_track *track = &out->track;
    sqlite_statement *row = sqlite_query(self->db, TRACK_QUERY, "sssXXNN", "i", id);
    mrt_result result = sqlite_step_one(row, "track", id, err);
    if (result >= 0)
        result =
            sqlite_get(row, err, &track->input, &track->device, &track->plugin,
                       &track->calibration[0], &track->calibration[1], &out->from_ns, &out->to_ns);
    result = sqlite_finish_rows(row, result);
    if (result >= 0)
        result = read_channels(self->db, track, err);
    if (result < 0)
        show_track_finish(out);
    return result;
}

void show_track_finish(show_track *track)
{
    if (!track)
        return;
    take_track_finish(&track->track);
    *track = (show_track){0};
}

mrt_result show_track_ids(show *self, int64_t **out, size_t *out_count, error *err)
{
    return show_read_ids(self, "SELECT id FROM track ORDER BY id", out, out_count, err);
}

/* ---- samples of one track, chunk by chunk ---- */

struct show_reader {
    show *owner;
    sqlite_statement *before, *after, *again, *lawful, *chunk_count;
    int64_t track, from_ns, to_ns, skip_until_ns;
    bool is_over;      /* SQLite itself cannot read further */
    bool has_told_end; /* true if missing chunks at the end were reported */

    /* The position in the track: the chunk whose samples are in memory. The last chunk of a track
     * grows during recording. */
    bool has_chunk;
    int64_t chunk_id, chunk_from_ns, chunk_to_ns, next_ordinal; /* ordinal -1: unknown */
    mrt_sample *sample; /* allocated for `capacity`, the longest chunk so far */
    uint32_t capacity, count, at;
    size_t chunk_size; /* stored size in bytes */
};

#define CHUNK_COLUMNS "SELECT id, from_ns, to_ns, bytes FROM chunk WHERE track = ?1 "
static const char before_sql[] =
    CHUNK_COLUMNS "AND from_ns <= ?2 ORDER BY from_ns DESC, id DESC LIMIT 1";
static const char after_sql[] =
    CHUNK_COLUMNS "AND from_ns >= ?2 AND (from_ns > ?2 OR id > ?3) ORDER BY from_ns, id LIMIT 1";
static const char again_sql[] =
    CHUNK_COLUMNS "AND id = ?2 AND (to_ns <> ?3 OR length(bytes) <> ?4)";
/* A gap is valid where the journal deleted chunks and no span of a take covers it. A span may begin
 * in a gap: it was created after the journal had deleted up to there. */
static const char lawful_sql[] =
    "SELECT COALESCE((SELECT value FROM meta WHERE key = 'pruned_until_ns'), ?2) > ?2 AND NOT "
    "EXISTS(SELECT 1 FROM span WHERE from_ns <= ?2 AND COALESCE(to_ns, ?3) > ?2 AND"
    "  (performance IS NULL OR EXISTS(SELECT 1 FROM performance_track p"
    "     WHERE p.performance = span.performance AND p.track = ?1)))";

static mrt_result prepare_all(show_reader *self, error *err)
{
    const char *count_sql = self->owner->version < 2
                                ? "SELECT NULL FROM track WHERE id = ?1"
                                : "SELECT chunk_count FROM track WHERE id = ?1";
    const struct {
        sqlite_statement **out;
        const char *sql, *columns;
    } statements[] = {{&self->before, before_sql, "ii**"},
                      {&self->after, after_sql, "ii**"},
                      {&self->again, again_sql, "iiib"},
                      {&self->lawful, lawful_sql, "i"},
                      {&self->chunk_count, count_sql, "I"}};
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < sizeof statements / sizeof *statements && result >= 0; ++i)
        result = sqlite_prepare(self->owner->db, statements[i].out, statements[i].sql,
                                statements[i].columns, err);
    return result;
}

mrt_result show_reader_open(show_reader **out, show *s, int64_t track, int64_t from_ns,
                            int64_t to_ns, error *err)
{
    *out = NULL;
    show_reader *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to read track %lld", (long long)track);
    self->owner = s;
    self->track = track;
    self->from_ns = self->skip_until_ns = from_ns;
    self->to_ns = to_ns;
    mrt_result result = prepare_all(self, err);
    if (result >= 0) {
        sqlite_bind(self->chunk_count, "i", track);
        result = sqlite_step_one(self->chunk_count, "track", track, err);
        sqlite_reset(self->chunk_count);
    }
    if (result < 0) {
        show_reader_close(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void show_reader_close(show_reader *self)
{
    if (!self)
        return;
    sqlite_finish(self->before);
    sqlite_finish(self->after);
    sqlite_finish(self->again);
    sqlite_finish(self->lawful);
    sqlite_finish(self->chunk_count);
    free(self->sample);
    free(self);
}

/* ---- one chunk ---- */

static mrt_result check_against_row(const show_reader *self, const chunk_head *head, error *err)
{
    if (head->track != self->track || self->sample[0].time_ns != self->chunk_from_ns ||
        self->sample[head->sample_count - 1].time_ns != self->chunk_to_ns)
        return error_set(err, MRT_ERR_FORMAT,
                         "a chunk of samples is damaged: it belongs to track %lld at %lld ns",
                         (long long)head->track, (long long)head->from_ns);
    if (self->next_ordinal >= 0 && head->ordinal < self->next_ordinal)
        return error_set(err, MRT_ERR_FORMAT,
                         "a chunk of samples is damaged: it is number %u, at least %lld was "
                         "expected",
                         head->ordinal, (long long)self->next_ordinal);
    return MRT_OK;
}

static mrt_result check_gap(show_reader *self, int64_t from_ns, int64_t to_ns, int64_t count,
                            error *err)
{
    sqlite_bind(self->lawful, "iii", self->track, from_ns, to_ns);
    mrt_result result = sqlite_step(self->lawful, err);
    bool lawful = result == MRT_OK && sqlite_int(self->lawful, 0);
    sqlite_reset(self->lawful);
    if (result < 0 || lawful)
        return result;
    return error_set(
        err, MRT_ERR_FORMAT,
        "%s: track %lld: %lld chunk(s) of samples between %lld and %lld ns are missing",
        self->owner->path, (long long)self->track, (long long)count, (long long)from_ns,
        (long long)to_ns);
}

/* Checks that times ascend from chunk to chunk, in case of a broken index. */
static bool goes_on(const show_reader *self, sqlite_statement *row)
{
    int64_t id = sqlite_int(row, 0), from_ns = sqlite_int(row, 1);
    return from_ns > self->chunk_from_ns || (from_ns == self->chunk_from_ns && id > self->chunk_id);
}

static mrt_result decode(show_reader *self, chunk_head *out, const uint8_t *bytes, size_t size,
                         error *err)
{
    mrt_result result = chunk_read_head(out, bytes, size, err);
    if (result >= 0 && out->sample_count > self->capacity) {
        free(self->sample);
        self->sample = malloc(out->sample_count * sizeof *self->sample);
        self->capacity = self->sample ? out->sample_count : 0;
        if (!self->sample)
            return error_set(err, MRT_ERR_MEMORY, "no memory for %u samples", out->sample_count);
    }
    return result < 0 ? result : chunk_decode(self->sample, out, bytes, size, err);
}

/* Loads the chunk of the row. Its first `given` samples were returned before. If it is unreadable,
 * or chunks before it are missing, this returns an error once. */
static mrt_result load_chunk(show_reader *self, sqlite_statement *row, uint32_t given, error *err)
{
    chunk_head head;
    size_t size = 0;
    bool is_typed = sqlite_is(row, 2, 'i') && sqlite_is(row, 3, 'b');
    const uint8_t *bytes = is_typed ? sqlite_blob(row, 3, &size) : NULL;
    int64_t gap_from_ns = self->has_chunk ? self->chunk_to_ns : INT64_MIN;
    self->has_chunk = true;
    self->chunk_id = sqlite_int(row, 0);
    self->chunk_from_ns = sqlite_int(row, 1);
    self->chunk_to_ns = is_typed ? sqlite_int(row, 2) : self->chunk_from_ns;
    self->chunk_size = size;
    self->count = self->at = 0;
    mrt_result result = is_typed ? decode(self, &head, bytes, size, err)
                                 : error_set(err, MRT_ERR_FORMAT,
                                             "a chunk of samples is damaged: it is not a blob");
    if (result >= 0)
        result = check_against_row(self, &head, err);
    if (result < 0) {
        char where[256];
        snprintf(where, sizeof where, "track %lld from %lld to %lld ns", (long long)self->track,
                 (long long)self->chunk_from_ns, (long long)self->chunk_to_ns);
        error_prefix(err, where);
        error_prefix(err, self->owner->path);
        self->next_ordinal += self->next_ordinal >= 0;
        return result;
    }
    int64_t missing = self->next_ordinal < 0 ? 0 : head.ordinal - self->next_ordinal;
    self->next_ordinal = (int64_t)head.ordinal + 1;
    self->count = head.sample_count;
    self->at = given < self->count ? given : self->count;
    return missing > 0 ? check_gap(self, gap_from_ns, self->chunk_from_ns, missing, err) : MRT_OK;
}

/* ---- from chunk to chunk ---- */

static mrt_result step_over(show_reader *self, sqlite_statement *query, error *err)
{
    mrt_result result = sqlite_step(query, err);
    self->is_over |= result < 0;
    return result;
}

/* Loads the rest of the track. The chunk in memory may have grown since; then its new samples come
 * first. */
static mrt_result load_rest(show_reader *self, error *err)
{
    if (!self->has_chunk || self->count == 0)
        return MRT_END;
    sqlite_bind(self->again, "iiii", self->track, self->chunk_id, self->chunk_to_ns,
                (int64_t)self->chunk_size);
    mrt_result result = step_over(self, self->again, err);
    if (result == MRT_OK) {
        --self->next_ordinal;
        result = load_chunk(self, self->again, self->count, err);
    }
    sqlite_reset(self->again);
    return result;
}

static mrt_result load_first(show_reader *self, error *err)
{
    int64_t start_ns = self->skip_until_ns;
    sqlite_bind(self->before, "ii", self->track, start_ns);
    mrt_result result = step_over(self, self->before, err);
    if (result == MRT_OK) {
        self->next_ordinal = -1;
        result = load_chunk(self, self->before, 0, err);
    }
    sqlite_reset(self->before);
    if (result != MRT_END)
        return result;
    self->next_ordinal = 0;
    sqlite_bind(self->after, "iii", self->track, start_ns, (int64_t)0);
    result = step_over(self, self->after, err);
    if (result == MRT_OK)
        result = load_chunk(self, self->after, 0, err);
    sqlite_reset(self->after);
    return result;
}

static mrt_result check_end(show_reader *self, error *err)
{
    if (self->has_told_end || self->next_ordinal < 0)
        return MRT_END;
    sqlite_bind(self->chunk_count, "i", self->track);
    mrt_result result = step_over(self, self->chunk_count, err);
    int64_t count = result == MRT_OK ? sqlite_int(self->chunk_count, 0) : 0; /* NULL: 0 */
    sqlite_reset(self->chunk_count);
    if (result < 0 || count <= self->next_ordinal)
        return result < 0 ? result : MRT_END;
    self->has_told_end = true;
    int64_t end_ns = self->has_chunk ? self->chunk_to_ns : INT64_MIN;
    result = check_gap(self, end_ns, INT64_MAX, count - self->next_ordinal, err);
    return result < 0 ? result : MRT_END;
}

static mrt_result load_next(show_reader *self, error *err)
{
    if (self->is_over)
        return MRT_END;
    if (!self->has_chunk) {
        mrt_result result = load_first(self, err);
        return result == MRT_END ? check_end(self, err) : result;
    }
    if (self->chunk_to_ns > self->to_ns)
        return MRT_END;
    sqlite_bind(self->after, "iii", self->track, self->chunk_from_ns, self->chunk_id);
    mrt_result next = step_over(self, self->after, err);
    if (next == MRT_OK && !goes_on(self, self->after)) {
        self->is_over = true;
        next = error_set(err, MRT_ERR_FORMAT,
                         "%s: track %lld is damaged at %lld ns: its chunks are out of order",
                         self->owner->path, (long long)self->track, (long long)self->chunk_from_ns);
    }
    mrt_result result = next < 0 ? next : load_rest(self, err);
    if (result == MRT_END)
        result = next == MRT_OK ? load_chunk(self, self->after, 0, err) : check_end(self, err);
    sqlite_reset(self->after);
    return result;
}

mrt_result show_reader_next(show_reader *self, mrt_sample *out, error *err)
{
    for (;;) {
        while (self->at < self->count) {
            const mrt_sample *sample = &self->sample[self->at];
            if (sample->time_ns > self->to_ns)
                return MRT_END;
            ++self->at;
            if (sample->time_ns >= self->skip_until_ns) {
                *out = *sample;
                return MRT_OK;
            }
        }
        mrt_result result = load_next(self, err);
        if (result != MRT_OK)
            return result;
    }
}

mrt_result show_reader_seek(show_reader *self, int64_t time_ns, error *err)
{
    if (time_ns < self->from_ns)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "track %lld: %lld ns is before the range of the reader, which starts at %lld ns",
            (long long)self->track, (long long)time_ns, (long long)self->from_ns);
    self->skip_until_ns = time_ns;
    self->has_chunk = self->is_over = self->has_told_end = false;
    self->count = self->at = 0;
    return MRT_OK;
}

/* ---- performances ---- */

static mrt_result insert_rig(sqlite *db, const take_performance *p, error *err)
{
    return sqlite_change(db, err,
                         "INSERT OR IGNORE INTO rig(path, hash, mesh_hash, unit_mm, json)"
                         "VALUES(?, ?, ?, ?, ?)",
                         "tttdt", or_empty(p->rig), p->rig_hash, p->mesh_hash, p->unit_mm,
                         p->rig_json);
}

static mrt_result insert_lists(sqlite *db, const take_performance *p, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t n = 0; n < p->track_count && result >= 0; ++n)
        result = sqlite_change(db, err,
                               "INSERT INTO performance_track(performance, n, track)"
                               "VALUES(?, ?, ?)",
                               "iii", p->id, (int64_t)n, p->track[n]);
    for (uint32_t n = 0; n < p->param_count && result >= 0; ++n)
        result =
            sqlite_change(db, err,
                          "INSERT INTO performance_param(performance, n, param, value)"
                          "VALUES(?, ?, ?, ?)",
                          "iiid", p->id, (int64_t)n, (int64_t)p->param[n].id, p->param[n].value);
    return result;
}

mrt_result show_performance_insert(sqlite *db, int64_t session, const take_performance *p,
                                   int64_t from_ns, error *err)
{
    const char *mapping = or_empty(p->mapping);
    mrt_result result = insert_plugin(db, mapping, err);
    if (result >= 0)
        result = insert_rig(db, p, err);
    if (result >= 0)
        result = sqlite_change(
            db, err,
            "INSERT INTO performance(id, session, hand_length_mm, rezero_pedal, from_ns, plugin,"
            "  rig)"
            "VALUES(?, ?, ?, ?, ?, (SELECT id FROM plugin WHERE identity = ?),"
            "  (SELECT id FROM rig WHERE path = ? AND hash = ? AND mesh_hash = ? AND unit_mm = ?))",
            "iidiittttd", p->id, session, p->hand_length_mm, (int64_t)p->rezero_pedal, from_ns,
            mapping, or_empty(p->rig), p->rig_hash, p->mesh_hash, p->unit_mm);
    if (result >= 0 && p->patch)
        result = sqlite_change(db, err, "INSERT INTO patch(performance, json) VALUES(?, ?)", "it",
                               p->id, p->patch);
    return result < 0 ? result : insert_lists(db, p, err);
}

#define PERFORMANCE_QUERY                                                                          \
    "SELECT identity, path, hash, mesh_hash, json, unit_mm, hand_length_mm, rezero_pedal, "        \
    "from_ns,"                                                                                     \
    "  MAX(from_ns, COALESCE(to_ns,"                                                               \
    "    (SELECT MAX((SELECT to_ns FROM chunk WHERE chunk.track = p.track"                         \
    "                 ORDER BY from_ns DESC, chunk.id DESC LIMIT 1))"                              \
    "     FROM performance_track p WHERE p.performance = f.id), from_ns))"                         \
    " FROM performance f JOIN plugin ON plugin.id = f.plugin JOIN rig ON rig.id = f.rig"           \
    " WHERE f.id = ?"

static mrt_result read_performance(show_performance *out, sqlite_statement *row, error *err)
{
    take_performance *p = &out->performance;
    return sqlite_get(row, err, &p->mapping, &p->rig, p->rig_hash, sizeof p->rig_hash, p->mesh_hash,
                      sizeof p->mesh_hash, &p->rig_json, &p->unit_mm, &p->hand_length_mm,
                      &p->rezero_pedal, &out->from_ns, &out->to_ns);
}

static mrt_result read_tracks(sqlite *db, take_performance *p, error *err)
{
    sqlite_statement *rows = sqlite_query(db,
                                          "SELECT track FROM performance_track WHERE "
                                          "performance = ? ORDER BY n LIMIT ?",
                                          "i", "ii", p->id, (int64_t)TAKE_TRACKS_MAX);
    mrt_result result;
    while ((result = sqlite_step(rows, err)) == MRT_OK)
        p->track[p->track_count++] = sqlite_int(rows, 0);
    return sqlite_finish_rows(rows, result);
}

static mrt_result read_params(sqlite *db, take_performance *p, error *err)
{
    sqlite_statement *rows = sqlite_query(db,
                                          "SELECT param, value FROM performance_param WHERE "
                                          "performance = ? ORDER BY n LIMIT ?",
                                          "uf", "ii", p->id, (int64_t)TAKE_PARAMS_MAX);
    mrt_result result;
    while ((result = sqlite_step(rows, err)) == MRT_OK) {
        take_param *param = &p->param[p->param_count++];
        result = sqlite_get(rows, err, &param->id, &param->value);
        if (result < 0)
            break;
    }
    return sqlite_finish_rows(rows, result);
}

/* ---- performances of recorded tracks ---- */

static mrt_result insert_again(sqlite *db, const take_performance *p, error *err)
{
    const take_again *again = &p->again;
    return sqlite_change(
        db, err,
        "INSERT INTO again(performance, of, ignores_params, left_calibration, right_calibration,"
        "  min_cutoff_hz, beta) VALUES(?, ?, ?, ?, ?, ?, ?)",
        "iiittdd", p->id, again->of, (int64_t)again->ignores_params, again->calibration[0],
        again->calibration[1], again->min_cutoff_hz, again->has_beta ? again->beta : -1.0);
}

static mrt_result insert_anew(show *self, const take_performance *p, error *err)
{
    int64_t session, from_ns;
    char sql[96];
    show_performance then;
    mrt_result result = show_performance_read(self, p->again.of, &then, err);
    if (result < 0)
        return result;
    from_ns = then.from_ns;
    int64_t to_ns = then.to_ns;
    show_performance_finish(&then);
    snprintf(sql, sizeof sql, "SELECT session FROM performance WHERE id = %lld",
             (long long)p->again.of);
    result = sqlite_number(self->db, sql, 0, &session, err);
    if (result >= 0)
        result = show_performance_insert(self->db, session, p, from_ns, err);
    if (result >= 0)
        result = sqlite_change(self->db, err, "UPDATE performance SET to_ns = ? WHERE id = ?", "ii",
                               to_ns, p->id);
    return result < 0 ? result : insert_again(self->db, p, err);
}

mrt_result show_performance_create(show *self, take_performance *p, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = sqlite_begin(self->db, err);
    if (result < 0)
        return result;
    p->id = show_next_id(self, SHOW_ID_PERFORMANCE);
    return sqlite_end(self->db, insert_anew(self, p, err), err);
}

static mrt_result read_again(sqlite *db, take_performance *p, error *err)
{
    take_again *again = &p->again;
    sqlite_statement *row = sqlite_query(db,
                                         "SELECT of, ignores_params, left_calibration,"
                                         "  right_calibration, min_cutoff_hz, beta FROM again "
                                         "WHERE performance = ?",
                                         "izXXff", "i", p->id);
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK) {
        result = sqlite_get(row, err, &again->of, &again->ignores_params, &again->calibration[0],
                            &again->calibration[1], &again->min_cutoff_hz, &again->beta);
        again->has_beta = again->beta >= 0.0;
    }
    return sqlite_finish_rows(row, result);
}

static mrt_result read_patch(sqlite *db, take_performance *p, error *err)
{
    sqlite_statement *row =
        sqlite_query(db, "SELECT json FROM patch WHERE performance = ?", "x", "i", p->id);
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK)
        result = sqlite_get(row, err, &p->patch);
    return sqlite_finish_rows(row, result);
}

mrt_result show_performance_read(show *self, int64_t id, show_performance *out, error *err)
{
    *out = (show_performance){.performance.id = id};
    sqlite_statement *row = sqlite_query(self->db, PERFORMANCE_QUERY, "ssttXffunn", "i", id);
    mrt_result result = sqlite_step_one(row, "performance", id, err);
    if (result >= 0)
        result = read_performance(out, row, err);
    result = sqlite_finish_rows(row, result);
    if (result >= 0)
        result = read_tracks(self->db, &out->performance, err);
    if (result >= 0)
        result = read_params(self->db, &out->performance, err);
    if (result >= 0)
        result = self->version < 2 ? MRT_OK : read_again(self->db, &out->performance, err);
    if (result >= 0)
        result = self->version < 3 ? MRT_OK : read_patch(self->db, &out->performance, err);
    if (result < 0)
        show_performance_finish(out);
    return result;
}

void show_performance_finish(show_performance *performance)
{
    if (!performance)
        return;
    take_performance_finish(&performance->performance);
    *performance = (show_performance){0};
}

mrt_result show_performance_ids(show *self, int64_t **out, size_t *out_count, error *err)
{
    return show_read_ids(self, "SELECT id FROM performance ORDER BY id", out, out_count, err);
}

/* ---- events ---- */

mrt_result show_event_insert(sqlite *db, const take_event *event, error *err)
{
    char text[sizeof event->text];
    snprintf(text, sizeof text, "%.*s", (int)sizeof text - 1, event->text);
    return sqlite_change(db, err,
                         "INSERT INTO event(time_ns, kind, track, param, hand, value, text)"
                         "VALUES(?, ?, ?, ?, ?, ?, ?)",
                         "iiiiidt", event->time_ns, (int64_t)event->kind, event->track,
                         (int64_t)event->param, (int64_t)event->hand, event->value, text);
}

static mrt_result read_event(void *item, sqlite_statement *row, error *err)
{
    take_event *out = item;
    return sqlite_get(row, err, &out->time_ns, &out->kind, &out->track, &out->param, &out->hand,
                      &out->value, out->text, sizeof out->text);
}

mrt_result show_events(show *self, int64_t from_ns, int64_t to_ns, take_event **out,
                       size_t *out_count, error *err)
{
    show_rows rows;
    mrt_result result =
        show_read_rows(&rows,
                       sqlite_query(self->db,
                                    "SELECT time_ns, kind, track, param, hand, value, text "
                                    "FROM event WHERE time_ns BETWEEN ? AND ? "
                                    "ORDER BY time_ns, id",
                                    "nuiuudt", "ii", from_ns, to_ns),
                       sizeof **out, read_event, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}

/* ---- checkpoints ---- */

enum {
    CHECKPOINT_BYTES_MAX = 256 * 1024 * 1024,
    BYTES_A_STEP = 1 /* bytes unpacked per budget step; most of the time goes into page faults of
                        fresh memory */
};

mrt_result show_checkpoint_pack(show_packed *out, const void *bytes, size_t size, error *err)
{
    uLongf packed_size = compressBound((uLong)size);
    out->bytes = malloc(packed_size);
    if (!out->bytes || compress2(out->bytes, &packed_size, bytes, (uLong)size, 1) != Z_OK) {
        free(out->bytes);
        out->bytes = NULL;
        return error_set(err, MRT_ERR_MEMORY, "no memory to pack a checkpoint of %zu bytes", size);
    }
    out->plain_size = size;
    out->size = packed_size;
    return MRT_OK;
}

mrt_result show_checkpoint_insert(sqlite *db, const show_packed *packed, error *err)
{
    return sqlite_change(db, err,
                         "INSERT INTO checkpoint(performance, time_ns, version, size, crc, bytes)"
                         "VALUES(?, ?, ?, ?, ?, ?)",
                         "iiiiib", packed->performance, packed->time_ns, (int64_t)packed->version,
                         (int64_t)packed->plain_size,
                         (int64_t)crc32_z(0, packed->bytes, packed->size),
                         (const void *)packed->bytes, packed->size);
}

static mrt_result unpack(show_checkpoint *out, sqlite_statement *row, size_t most, error *err)
{
    size_t packed_size;
    const uint8_t *packed = sqlite_blob(row, 4, &packed_size);
    int64_t size = sqlite_int(row, 2);
    if (size < 0 || (uint64_t)size > most)
        return error_set(err, MRT_ERR_FORMAT,
                         "a checkpoint is damaged: it would unpack to %lld bytes", (long long)size);
    if ((int64_t)crc32_z(0, packed, packed_size) != sqlite_int(row, 3))
        return error_set(err, MRT_ERR_FORMAT,
                         "a checkpoint is damaged: its checksum (CRC-32) is wrong");
    out->time_ns = sqlite_int(row, 0);
    out->version = (uint32_t)sqlite_int(row, 1);
    out->size = (size_t)size;
    out->bytes = malloc(out->size + 1);
    if (!out->bytes)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a checkpoint of %zu bytes", out->size);
    uLongf got = (uLongf)out->size;
    if (uncompress(out->bytes, &got, packed, (uLong)packed_size) != Z_OK || got != out->size) {
        show_checkpoint_finish(out);
        return error_set(err, MRT_ERR_FORMAT, "a checkpoint is damaged: it cannot be unpacked");
    }
    return MRT_OK;
}

mrt_result show_checkpoint_before(show *self, int64_t performance, int64_t time_ns, size_t most,
                                  show_checkpoint *out, error *err)
{
    *out = (show_checkpoint){0};
    sqlite_statement *rows = sqlite_query(self->db,
                                          "SELECT time_ns, version, size, crc, bytes FROM "
                                          "checkpoint WHERE performance = ? AND time_ns <= ? "
                                          "ORDER BY time_ns DESC, id DESC LIMIT 1",
                                          "iiiib", "ii", performance, time_ns);
    mrt_result result = sqlite_step(rows, err);
    if (result == MRT_OK && sqlite_int(rows, 0) > time_ns)
        result = error_set(err, MRT_ERR_FORMAT,
                           "%s: is damaged: checkpoints of performance %lld are out of order",
                           self->path, (long long)performance);
    if (result == MRT_OK && most == 0 && sqlite_int(rows, 2) > 0)
        result = sqlite_spend(self->db, (uint64_t)sqlite_int(rows, 2) / BYTES_A_STEP, err);
    if (result == MRT_OK) {
        result = unpack(out, rows, most ? most : CHECKPOINT_BYTES_MAX, err);
        if (result < 0)
            error_prefix(err, self->path);
    }
    return sqlite_finish_rows(rows, result);
}

void show_checkpoint_finish(show_checkpoint *checkpoint)
{
    if (!checkpoint)
        return;
    free(checkpoint->bytes);
    *checkpoint = (show_checkpoint){0};
}

/* ---- audio: interleaved frames in pieces ---- */

enum { RATE_MAX = 768000, CHANNELS_MAX = 64, PIECE_BYTES_MAX = 1024 * 1024 };

/* Checks the description. On success *out_frame_bytes is not 0. */
static mrt_result check(const show_audio *audio, uint32_t *out_frame_bytes, mrt_result code,
                        error *err)
{
    *out_frame_bytes =
        sound_pcm_bytes(sound_pcm_of(audio->format)) * (audio->channel_count % (CHANNELS_MAX + 1));
    if (audio->rate_hz == 0 || audio->rate_hz > RATE_MAX || audio->channel_count > CHANNELS_MAX ||
        *out_frame_bytes == 0)
        return error_set(err, code, "audio '%s': %u Hz, %u channels of '%s' are not supported",
                         audio->name, audio->rate_hz, audio->channel_count, audio->format);
    return MRT_OK;
}

mrt_result show_audio_create(show *self, const show_audio *audio, int64_t *out_id, error *err)
{
    uint32_t frame_size;
    *out_id = 0;
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = check(audio, &frame_size, MRT_ERR_ARGUMENT, err);
    if (result >= 0)
        result = sqlite_change(self->db, err,
                               "INSERT INTO audio(name, start_ns, rate_hz, channel_count, format)"
                               "VALUES(?, ?, ?, ?, ?)",
                               "tiiit", audio->name, audio->start_ns, (int64_t)audio->rate_hz,
                               (int64_t)audio->channel_count, audio->format);
    if (result >= 0)
        *out_id = sqlite_last_id(self->db);
    return result;
}

static mrt_result read_info(sqlite *db, int64_t id, show_audio *out, uint32_t *out_frame_bytes,
                            error *err)
{
    *out = (show_audio){0};
    *out_frame_bytes = 1;
    sqlite_statement *row =
        sqlite_query(db,
                     "SELECT id, name, start_ns, rate_hz, channel_count, format, COALESCE("
                     "  (SELECT first_frame + frame_count FROM audio_chunk WHERE audio = audio.id"
                     "   ORDER BY first_frame DESC LIMIT 1), 0)"
                     " FROM audio WHERE id = ?",
                     "itnuuti", "i", id);
    mrt_result result = sqlite_step_one(row, "audio", id, err);
    if (result >= 0)
        result = sqlite_get(row, err, &out->id, out->name, sizeof out->name, &out->start_ns,
                            &out->rate_hz, &out->channel_count, out->format, sizeof out->format,
                            &out->frame_count);
    if (result >= 0)
        result = check(out, out_frame_bytes, MRT_ERR_FORMAT, err);
    return sqlite_finish_rows(row, result);
}

mrt_result show_audio_info(show *self, int64_t id, show_audio *out, error *err)
{
    uint32_t frame_size;
    return read_info(self->db, id, out, &frame_size, err);
}

mrt_result show_audio_append(sqlite *db, int64_t id, int64_t time_ns, const void *frames,
                             size_t size, error *err)
{
    show_audio audio;
    uint32_t frame_size;
    mrt_result result = read_info(db, id, &audio, &frame_size, err);
    if (result < 0)
        return result;
    if (size == 0 || size > PIECE_BYTES_MAX || size % frame_size != 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "audio %lld: a piece of %zu bytes; expected 1 to %d, in frames of %u",
                         (long long)id, size, PIECE_BYTES_MAX, frame_size);
    return sqlite_change(
        db, err,
        "INSERT INTO audio_chunk(audio, first_frame, frame_count, time_ns, crc, bytes)"
        "VALUES(?, ?, ?, ?, ?, ?)",
        "iiiiib", id, audio.frame_count, (int64_t)(size / frame_size), time_ns,
        (int64_t)crc32_z(0, frames, size), frames, size);
}

mrt_result show_audio_write(show *self, int64_t id, int64_t time_ns, const void *frames,
                            size_t size, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = sqlite_begin(self->db, err);
    if (result < 0)
        return result;
    result = show_audio_append(self->db, id, time_ns, frames, size, err);
    return sqlite_end(self->db, result, err);
}

mrt_result show_audio_ids(show *self, int64_t **out, size_t *out_count, error *err)
{
    return show_read_ids(self, "SELECT id FROM audio ORDER BY id", out, out_count, err);
}

/* Copies the frames of the piece from `frame` on. Returns 0 at its end. */
static mrt_result copy_piece(sqlite_statement *row, int64_t id, int64_t frame, uint32_t frame_size,
                             uint8_t *out, size_t capacity, size_t *out_size, error *err)
{
    size_t size;
    const uint8_t *bytes = sqlite_blob(row, 3, &size);
    int64_t first = sqlite_int(row, 0), count = sqlite_int(row, 1);
    if (size > PIECE_BYTES_MAX || first > frame || count < 0 || first > INT64_MAX - count ||
        first + count <= frame || (uint64_t)count != size / frame_size || size % frame_size != 0 ||
        (int64_t)crc32_z(0, bytes, size) != sqlite_int(row, 2))
        return error_set(err, MRT_ERR_FORMAT, "audio %lld is damaged or missing at frame %lld",
                         (long long)id, (long long)frame);
    size_t skipped = (size_t)(frame - first) * frame_size;
    size_t left = capacity / frame_size * frame_size;
    *out_size = size - skipped < left ? size - skipped : left;
    memcpy(out, bytes + skipped, *out_size);
    return MRT_OK;
}

mrt_result show_audio_read(show *self, int64_t id, int64_t first_frame, void *out, size_t capacity,
                           size_t *out_size, error *err)
{
    *out_size = 0;
    show_audio audio;
    uint32_t frame_size;
    mrt_result result = read_info(self->db, id, &audio, &frame_size, err);
    if (result < 0)
        return result;
    int64_t frame = first_frame < 0 ? 0 : first_frame;
    sqlite_statement *rows =
        sqlite_query(self->db,
                     "SELECT first_frame, frame_count, crc, bytes FROM audio_chunk "
                     "WHERE audio = ?1 AND first_frame >= COALESCE("
                     "  (SELECT MAX(first_frame) FROM audio_chunk"
                     "   WHERE audio = ?1 AND first_frame <= ?2), 0) ORDER BY first_frame",
                     "iiib", "ii", id, frame);
    while (frame < audio.frame_count && capacity - *out_size >= frame_size &&
           (result = sqlite_step(rows, err)) == MRT_OK) {
        size_t got = 0;
        result = copy_piece(rows, id, frame, frame_size, (uint8_t *)out + *out_size,
                            capacity - *out_size, &got, err);
        if (result < 0)
            break;
        *out_size += got;
        frame += (int64_t)(got / frame_size);
    }
    return sqlite_finish_rows(rows, result);
}

mrt_result show_audio_check(show *self, int64_t id, error *err)
{
    enum { PIECE_BYTES = 65536 };
    show_audio audio;
    uint8_t *piece = malloc(PIECE_BYTES);
    if (!piece)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to check it", self->path);
    uint32_t frame_size;
    mrt_result result = read_info(self->db, id, &audio, &frame_size, err);
    size_t size = 1;
    for (int64_t frame = 0; result >= 0 && size > 0; frame += (int64_t)(size / frame_size))
        result = show_audio_read(self, id, frame, piece, PIECE_BYTES, &size, err);
    free(piece);
    return result;
}

static mrt_result read_anchor(void *item, sqlite_statement *row, error *err)
{
    show_audio_anchor *out = item;
    return sqlite_get(row, err, &out->frame, &out->time_ns);
}

mrt_result show_audio_anchors(show *self, int64_t id, show_audio_anchor **out, size_t *out_count,
                              error *err)
{
    show_rows rows;
    mrt_result result =
        show_read_rows(&rows,
                       sqlite_query(self->db,
                                    "SELECT first_frame, time_ns FROM audio_chunk "
                                    "WHERE audio = ? AND time_ns <> 0 ORDER BY first_frame",
                                    "in", "i", id),
                       sizeof **out, read_anchor, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}
