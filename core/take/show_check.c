/* Whether everything in a show is whole. */
#include "take/show_file.h"

#include <stdlib.h>
#include <string.h>

/* What SQLite says of its pages, and of rows that refer to none. */
static mrt_result check_pages(show *self, error *err)
{
    sqlite_statement *row;
    mrt_result result = sqlite_query(self->db, &row, err, "PRAGMA integrity_check(1)", "");
    if (result < 0)
        return result;
    result = sqlite_step(row, err);
    if (result == MRT_OK && strcmp(sqlite_text(row, 0), "ok") != 0)
        result =
            error_set(err, MRT_ERR_FORMAT, "%s: is damaged: %s", self->path, sqlite_text(row, 0));
    sqlite_finish(row);
    return result < 0 ? result : MRT_OK;
}

static mrt_result check_references(show *self, error *err)
{
    sqlite_statement *row;
    mrt_result result = sqlite_query(self->db, &row, err, "PRAGMA foreign_key_check", "");
    if (result < 0)
        return result;
    result = sqlite_step(row, err);
    if (result == MRT_OK)
        result = error_set(err, MRT_ERR_FORMAT,
                           "%s: is damaged: a row of table %s refers to one of %s that is missing",
                           self->path, sqlite_text(row, 0), sqlite_text(row, 2));
    sqlite_finish(row);
    return result < 0 ? result : MRT_OK;
}

static mrt_result check_track(show *self, int64_t id, error *err)
{
    show_reader *reader;
    mrt_sample sample;
    mrt_result result = show_reader_open(&reader, self, id, INT64_MIN, INT64_MAX, err);
    if (result < 0)
        return result;
    while ((result = show_reader_next(reader, &sample, err)) == MRT_OK)
        ;
    show_reader_close(reader);
    return result < 0 ? result : MRT_OK;
}

static mrt_result check_edits(show *self, int64_t take_id, error *err)
{
    show_edits edits;
    mrt_result result = show_edits_read(self, take_id, &edits, err);
    if (result >= 0)
        show_edits_finish(&edits);
    return result;
}

/* From the last checkpoint back to the first. */
static mrt_result check_checkpoints(show *self, int64_t performance, error *err)
{
    int64_t before_ns = INT64_MAX;
    for (;;) {
        show_checkpoint got;
        mrt_result result = show_checkpoint_before(self, performance, before_ns, &got, err);
        if (result < 0 || !got.bytes)
            return result;
        before_ns = got.time_ns - 1;
        show_checkpoint_finish(&got);
    }
}

static mrt_result check_each(show *self, const char *ids_sql,
                             mrt_result (*check)(show *self, int64_t id, error *err), error *err)
{
    int64_t *ids;
    size_t count;
    mrt_result result = show_read_ids(self, ids_sql, &ids, &count, err);
    for (size_t i = 0; i < count && result >= 0; ++i)
        result = check(self, ids[i], err);
    free(ids);
    return result;
}

mrt_result show_check(show *self, error *err)
{
    mrt_result result = check_pages(self, err);
    if (result >= 0)
        result = check_references(self, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM track", check_track, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM take", check_edits, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM performance", check_checkpoints, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM audio", show_audio_check, err);
    return result;
}
