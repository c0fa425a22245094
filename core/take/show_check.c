/* Whether everything in a show is whole. */
#include "take/show_file.h"

#include "take/show_schema.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What SQLite says of its pages, and of rows that refer to none. */
static mrt_result check_pages(show *self, error *err)
{
    sqlite_statement *row;
    mrt_result result = sqlite_query(self->db, &row, err, "PRAGMA integrity_check(1)", "t", "");
    if (result < 0)
        return result;
    result = sqlite_step(row, err);
    char what[200] = "ok";
    if (result == MRT_OK)
        sqlite_text(row, 0, what, sizeof what);
    if (result == MRT_OK && strcmp(what, "ok") != 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: is damaged: %s", self->path, what);
    sqlite_finish(row);
    return result < 0 ? result : MRT_OK;
}

static mrt_result check_references(show *self, error *err)
{
    sqlite_statement *row;
    mrt_result result = sqlite_query(self->db, &row, err, "PRAGMA foreign_key_check", "*", "");
    if (result < 0)
        return result;
    result = sqlite_step(row, err);
    if (result == MRT_OK) {
        char from[64], to[64];
        sqlite_text(row, 0, from, sizeof from);
        sqlite_text(row, 2, to, sizeof to);
        result = error_set(err, MRT_ERR_FORMAT,
                           "%s: is damaged: a row of table %s refers to one of %s that is missing",
                           self->path, from, to);
    }
    sqlite_finish(row);
    return result < 0 ? result : MRT_OK;
}

/* Every value is of the kind of its column; blobs are looked at by those who read them. */
static mrt_result check_kinds(show *self, const show_table *of, error *err)
{
    char sql[128];
    sqlite_statement *rows;
    (void)snprintf(sql, sizeof sql, "SELECT %s FROM %s", of->light, of->name);
    mrt_result result = sqlite_query(self->db, &rows, err, sql, of->kinds, "");
    if (result < 0)
        return result;
    while ((result = sqlite_step(rows, err)) == MRT_OK)
        ;
    sqlite_finish(rows);
    return result < 0 ? error_prefix(err, of->name), result : MRT_OK;
}

static mrt_result check_all_kinds(show *self, error *err)
{
    mrt_result result = MRT_OK;
    for (int i = 0; i < SHOW_TABLES && result >= 0; ++i)
        if (self->version >= 2 || strcmp(show_tables[i].name, "again") != 0)
            result = check_kinds(self, &show_tables[i], err);
    return result;
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
        mrt_result result = show_checkpoint_before(self, performance, before_ns, 0, &got, err);
        if (result < 0 || !got.bytes)
            return result;
        bool is_first = got.time_ns == INT64_MIN;
        before_ns = is_first ? INT64_MIN : got.time_ns - 1;
        show_checkpoint_finish(&got);
        if (is_first)
            return MRT_OK;
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
        result = check_all_kinds(self, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM track", check_track, err);
    if (result >= 0)
        result = check_each(
            self, "SELECT id FROM take WHERE edit_head <> 0 OR id IN (SELECT take FROM edit)",
            check_edits, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM performance", check_checkpoints, err);
    if (result >= 0)
        result = check_each(self, "SELECT id FROM audio", show_audio_check, err);
    return result;
}
