#include "take/journal.h"

#include <stdio.h>

enum {
    CHUNKS_A_STEP = 256,
    CHECKPOINTS_A_STEP = 4,
    PAGES_A_STEP = 64,
    PAGES_KEPT = 1024 /* free, to be used again by what is recorded next */
};

/* The ring reaches back to the last checkpoint before its length: a take of all of it can be
 * replayed from its start. */
static mrt_result limit_of(const journal *self, sqlite *db, int64_t now_ns, int64_t *out,
                           error *err)
{
    *out = now_ns - self->length_ns;
    sqlite_statement *row = sqlite_query(db,
                                         "SELECT MAX(c.time_ns) FROM performance p JOIN checkpoint "
                                         "c  ON c.performance = p.id WHERE c.time_ns <= ?1"
                                         "  AND COALESCE(p.to_ns, ?1) >= ?1",
                                         "I", "i", *out);
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK && !sqlite_is_null(row, 0))
        *out = sqlite_int(row, 0);
    return sqlite_finish_rows(row, result);
}

/* The last of the next chunks that are all older than the limit; what was looked at before if there
 * is none. */
static mrt_result next_chunks(const journal *self, sqlite *db, int64_t limit_ns, int64_t *out_last,
                              bool *out_is_done, error *err)
{
    sqlite_statement *rows =
        sqlite_query(db, "SELECT id, to_ns FROM chunk WHERE id > ? ORDER BY id LIMIT ?", "ii", "ii",
                     self->looked_at_id, (int64_t)CHUNKS_A_STEP);
    int count = 0;
    *out_last = self->looked_at_id;
    mrt_result result;
    while ((result = sqlite_step(rows, err)) == MRT_OK && sqlite_int(rows, 1) < limit_ns) {
        *out_last = sqlite_int(rows, 0);
        ++count;
    }
    *out_is_done = count < CHUNKS_A_STEP;
    return sqlite_finish_rows(rows, result);
}

/* What is let go leaves lawful gaps: pruned_until_ns tells readers. A span that begins or ends
 * where a hand was away holds on to the chunk before and the one behind, so that no gap touches it.
 */
static mrt_result delete_chunks(const journal *self, sqlite *db, int64_t last_id, error *err)
{
    int64_t until_ns = INT64_MIN;
    sqlite_statement *gone = sqlite_query(
        db,
        "DELETE FROM chunk WHERE id > ? AND id <= ? AND NOT EXISTS("
        "  SELECT 1 FROM span WHERE need_ns < COALESCE((SELECT MIN(n.from_ns)"
        "      FROM chunk n WHERE n.track = chunk.track AND n.from_ns > chunk.from_ns),"
        "      chunk.to_ns + 1)"
        "    AND (to_ns IS NULL OR to_ns > COALESCE((SELECT p.to_ns FROM chunk p"
        "      WHERE p.track = chunk.track AND p.from_ns < chunk.from_ns"
        "      ORDER BY p.from_ns DESC LIMIT 1), chunk.from_ns - 1))"
        "    AND (performance IS NULL OR EXISTS(SELECT 1 FROM performance_track p"
        "      WHERE p.performance = span.performance AND p.track = chunk.track)))"
        " RETURNING to_ns",
        "i", "ii", self->looked_at_id, last_id);
    mrt_result result;
    while ((result = sqlite_step(gone, err)) == MRT_OK)
        if (sqlite_int(gone, 0) > until_ns)
            until_ns = sqlite_int(gone, 0);
    result = sqlite_finish_rows(gone, result);
    if (result < 0 || until_ns == INT64_MIN)
        return result;
    return sqlite_change(db, err,
                         "INSERT INTO meta(key, value) VALUES('pruned_until_ns', ?)"
                         " ON CONFLICT(key) DO UPDATE SET value = MAX(value, excluded.value)",
                         "i", until_ns);
}

static mrt_result delete_checkpoints(sqlite *db, int64_t limit_ns, error *err)
{
    return sqlite_change(db, err,
                         "DELETE FROM checkpoint WHERE id IN (SELECT id FROM checkpoint c"
                         "  WHERE time_ns < ?1 AND NOT EXISTS(SELECT 1 FROM span"
                         "    WHERE span.performance = c.performance AND need_ns <= c.time_ns"
                         "    AND (to_ns IS NULL OR to_ns >= c.time_ns)) LIMIT ?2)",
                         "ii", limit_ns, (int64_t)CHECKPOINTS_A_STEP);
}

mrt_result journal_step(journal *self, sqlite *db, int64_t now_ns, bool *out_is_done, error *err)
{
    int64_t limit_ns, last_id;
    *out_is_done = true;
    mrt_result result = limit_of(self, db, now_ns, &limit_ns, err);
    if (result >= 0)
        result = next_chunks(self, db, limit_ns, &last_id, out_is_done, err);
    if (result >= 0 && last_id > self->looked_at_id)
        result = delete_chunks(self, db, last_id, err);
    if (result >= 0)
        result = delete_checkpoints(db, limit_ns, err);
    if (result >= 0)
        self->looked_at_id = last_id;
    return result;
}

mrt_result journal_shrink(sqlite *db, error *err)
{
    int64_t free_count, page_count;
    mrt_result result = sqlite_number(db, "PRAGMA freelist_count", 0, &free_count, err);
    if (result >= 0)
        result = sqlite_number(db, "PRAGMA page_count", 0, &page_count, err);
    if (result < 0 || free_count < PAGES_KEPT || free_count < page_count / 4)
        return result;
    char sql[64];
    (void)snprintf(sql, sizeof sql, "PRAGMA incremental_vacuum(%d)", PAGES_A_STEP);
    return sqlite_run(db, sql, err);
}
