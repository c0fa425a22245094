/* Samples of one track, chunk by chunk. */
#include "take/show_file.h"

#include "take/chunk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct show_reader {
    show *owner;
    sqlite_statement *before, *after, *again, *lawful, *chunk_count;
    int64_t track, from_ns, to_ns, skip_until_ns;
    bool is_over;      /* SQLite itself cannot read on */
    bool has_told_end; /* that chunks are missing at the end */

    /* Where in the track it is: the chunk whose samples are in memory; the last one of a track
     * grows while it is recorded. */
    bool has_chunk;
    int64_t chunk_id, chunk_from_ns, chunk_to_ns, next_ordinal; /* ordinal -1: not known */
    mrt_sample sample[CHUNK_SAMPLES_MAX];
    uint32_t count, at;
    size_t chunk_size; /* in bytes, as stored */
};

#define CHUNK_COLUMNS "SELECT id, from_ns, to_ns, bytes FROM chunk WHERE track = ?1 "
static const char before_sql[] =
    CHUNK_COLUMNS "AND from_ns <= ?2 ORDER BY from_ns DESC, id DESC LIMIT 1";
static const char after_sql[] =
    CHUNK_COLUMNS "AND from_ns >= ?2 AND (from_ns > ?2 OR id > ?3) ORDER BY from_ns, id LIMIT 1";
static const char again_sql[] =
    CHUNK_COLUMNS "AND id = ?2 AND (to_ns <> ?3 OR length(bytes) <> ?4)";
/* A gap is lawful where the journal has let go, and no take goes on into it. One that begins in it
 * was kept when the journal had let go up to there. */
static const char lawful_sql[] =
    "SELECT COALESCE((SELECT value FROM meta WHERE key = 'pruned_until_ns'), ?2) > ?2 AND NOT "
    "EXISTS(SELECT 1 FROM span WHERE from_ns <= ?2 AND COALESCE(to_ns, ?3) > ?2 AND"
    "  (performance IS NULL OR EXISTS(SELECT 1 FROM performance_track p"
    "     WHERE p.performance = span.performance AND p.track = ?1)))";

static mrt_result prepare_all(show_reader *self, error *err)
{
    sqlite *db = self->owner->db;
    mrt_result result = sqlite_prepare(db, &self->before, before_sql, "ii**", err);
    if (result >= 0)
        result = sqlite_prepare(db, &self->after, after_sql, "ii**", err);
    if (result >= 0)
        result = sqlite_prepare(db, &self->again, again_sql, "iiib", err);
    if (result >= 0)
        result = sqlite_prepare(db, &self->lawful, lawful_sql, "i", err);
    if (result >= 0)
        result =
            sqlite_prepare(db, &self->chunk_count,
                           self->owner->version < 2 ? "SELECT NULL FROM track WHERE id = ?1"
                                                    : "SELECT chunk_count FROM track WHERE id = ?1",
                           "I", err);
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
        result = sqlite_step(self->chunk_count, err);
        if (result == MRT_END)
            result = error_set(err, MRT_ERR_ARGUMENT, "%s: has no track %lld", s->path,
                               (long long)track);
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

/* Time goes on from chunk to chunk, whatever a broken index says. */
static bool goes_on(const show_reader *self, sqlite_statement *row)
{
    int64_t id = sqlite_int(row, 0), from_ns = sqlite_int(row, 1);
    return from_ns > self->chunk_from_ns || (from_ns == self->chunk_from_ns && id > self->chunk_id);
}

/* Takes the chunk of the row in; the first `given` samples of it were given already. Where it
 * cannot be read, or others before it are missing, that is an error once. */
static mrt_result take_in(show_reader *self, sqlite_statement *row, uint32_t given, error *err)
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
    mrt_result result =
        is_typed ? chunk_decode(self->sample, &head, bytes, size, err)
                 : error_set(err, MRT_ERR_FORMAT, "a chunk of samples is damaged: it is no blob");
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

/* The chunk in memory may have grown since; then its new samples come first. */
static mrt_result load_rest(show_reader *self, error *err)
{
    if (!self->has_chunk || self->count == 0)
        return MRT_END;
    sqlite_bind(self->again, "iiii", self->track, self->chunk_id, self->chunk_to_ns,
                (int64_t)self->chunk_size);
    mrt_result result = step_over(self, self->again, err);
    if (result == MRT_OK) {
        --self->next_ordinal;
        result = take_in(self, self->again, self->count, err);
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
        result = take_in(self, self->before, 0, err);
    }
    sqlite_reset(self->before);
    if (result != MRT_END)
        return result;
    self->next_ordinal = 0;
    sqlite_bind(self->after, "iii", self->track, start_ns, (int64_t)0);
    result = step_over(self, self->after, err);
    if (result == MRT_OK)
        result = take_in(self, self->after, 0, err);
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
        result = next == MRT_OK ? take_in(self, self->after, 0, err) : check_end(self, err);
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
    if (time_ns < self->from_ns || time_ns > self->to_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "track %lld: %lld ns is outside of what is read, %lld to %lld ns",
                         (long long)self->track, (long long)time_ns, (long long)self->from_ns,
                         (long long)self->to_ns);
    self->skip_until_ns = time_ns;
    self->has_chunk = self->is_over = self->has_told_end = false;
    self->count = self->at = 0;
    return MRT_OK;
}
