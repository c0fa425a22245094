/* Edits of takes, as rows of text. */
#include "take/show_file.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int64_t show_edit_crc(int64_t take_id, int32_t n, const char *json)
{
    uint8_t place[12];
    for (int i = 0; i < 8; ++i)
        place[i] = (uint8_t)((uint64_t)take_id >> (8 * i));
    for (int i = 0; i < 4; ++i)
        place[8 + i] = (uint8_t)((uint32_t)n >> (8 * i));
    uLong crc = crc32(0, place, sizeof place);
    return (int64_t)crc32_z(crc, (const uint8_t *)json, strlen(json));
}

mrt_result show_edit_insert(sqlite *db, int64_t take_id, int32_t n, int64_t utc_ms,
                            const char *json, error *err)
{
    return sqlite_change(db, err,
                         "INSERT INTO edit(take, branch, n, utc_ms, crc, json)"
                         "VALUES(?, 0, ?, ?, ?, ?)",
                         "iiiit", take_id, (int64_t)n, utc_ms, show_edit_crc(take_id, n, json),
                         json);
}

/* ---- reading ---- */

static mrt_result add_edit(show_edits *out, sqlite_statement *row, int64_t take_id,
                           const char *path, error *err)
{
    void *list = out->edit;
    mrt_result result = show_grow(&list, out->count, sizeof *out->edit, err);
    out->edit = list;
    if (result < 0)
        return result;
    show_edit *edit = &out->edit[out->count];
    *edit = (show_edit){.n = (int32_t)sqlite_int(row, 0),
                        .utc_ms = sqlite_int(row, 1),
                        .json = strdup(sqlite_exact_text(row, 3))};
    if (!edit->json)
        return error_set(err, MRT_ERR_MEMORY, "no memory for an edit");
    ++out->count;
    if (show_edit_crc(take_id, edit->n, edit->json) != sqlite_int(row, 2))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: edit %d of take %lld is damaged: its CRC-32 differs", path, edit->n,
                         (long long)take_id);
    if (out->count > 1 && edit->n != out->edit[out->count - 2].n + 1)
        return error_set(err, MRT_ERR_FORMAT, "%s: the edits of take %lld before %d are missing",
                         path, (long long)take_id, edit->n);
    return MRT_OK;
}

mrt_result show_edits_read(show *self, int64_t take_id, show_edits *out, error *err)
{
    show_take row;
    *out = (show_edits){0};
    mrt_result result = show_take_read(self, take_id, &row, err);
    return result < 0 ? result : show_edits_of(self, &row, out, err);
}

mrt_result show_edits_of(show *self, const show_take *row, show_edits *out, error *err)
{
    const int64_t take_id = row->id;
    *out = (show_edits){0};
    if (row->edit_head == 0 && row->edit_count == 0 && row->base_edit_count == 0)
        return MRT_OK;
    sqlite_statement *rows;
    mrt_result result = sqlite_query(self->db, &rows, err,
                                     "SELECT n, utc_ms, crc, json FROM edit "
                                     "WHERE take = ? AND branch = 0 ORDER BY n",
                                     "iiit", "i", take_id);
    if (result < 0)
        return result;
    while ((result = sqlite_step(rows, err)) == MRT_OK) {
        result = add_edit(out, rows, take_id, self->path, err);
        if (result < 0)
            break;
    }
    sqlite_finish(rows);
    out->head = row->edit_head;
    int32_t last = out->count ? out->edit[out->count - 1].n : 0;
    if (result >= 0 && (row->edit_head < 0 || row->edit_head > (last > 0 ? last : 0)))
        result = error_set(err, MRT_ERR_FORMAT, "%s: take %lld is damaged: %d edits are missing",
                           self->path, (long long)take_id, row->edit_head - last);
    if (result >= 0)
        return MRT_OK;
    show_edits_finish(out);
    return result;
}

void show_edits_finish(show_edits *edits)
{
    if (!edits)
        return;
    for (size_t i = 0; i < edits->count; ++i)
        free(edits->edit[i].json);
    free(edits->edit);
    *edits = (show_edits){0};
}

/* ---- writing ---- */

static mrt_result abandon_later(sqlite *db, int64_t take_id, int32_t head, error *err)
{
    return sqlite_change(db, err,
                         "UPDATE edit SET branch ="
                         "  (SELECT MAX(branch) + 1 FROM edit WHERE take = ?1)"
                         " WHERE take = ?1 AND branch = 0 AND n > ?2",
                         "ii", take_id, (int64_t)head);
}

static mrt_result set_head(sqlite *db, int64_t take_id, int32_t head, error *err)
{
    return sqlite_change(db, err, "UPDATE take SET edit_head = ?2 WHERE id = ?1", "ii", take_id,
                         (int64_t)head);
}

mrt_result show_edit_append(show *self, int64_t take_id, const char *json, int64_t utc_ms,
                            const show_span *spans, size_t span_count, error *err)
{
    show_take of;
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = sqlite_begin(self->db, err);
    if (result < 0)
        return result;
    result = show_take_read(self, take_id, &of, err);
    if (result >= 0 && of.edit_head == INT32_MAX)
        result = error_set(err, MRT_ERR_ARGUMENT, "take %lld: too many edits", (long long)take_id);
    if (result >= 0 && of.edit_head < of.edit_count)
        result = abandon_later(self->db, take_id, of.edit_head, err);
    if (result >= 0)
        result = show_edit_insert(self->db, take_id, of.edit_head + 1, utc_ms, json, err);
    if (result >= 0)
        result = set_head(self->db, take_id, of.edit_head + 1, err);
    if (result >= 0)
        result = show_spans_insert(self->db, take_id, spans, span_count, err);
    return sqlite_end(self->db, result, err);
}

mrt_result show_edit_head(show *self, int64_t take_id, int32_t head, error *err)
{
    show_take of;
    mrt_result result = show_check_writable(self, err);
    if (result >= 0)
        result = show_take_read(self, take_id, &of, err);
    if (result < 0)
        return result;
    if (head < 0 || head > of.edit_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld: %d edits cannot be in force, there are %d", (long long)take_id,
                         head, of.edit_count);
    return set_head(self->db, take_id, head, err);
}
