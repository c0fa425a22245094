/* Performances, and the events and checkpoints that belong to their time. */
#include "take/show_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum {
    CHECKPOINT_BYTES_MAX = 256 * 1024 * 1024,
    BYTES_A_STEP = 1 /* unpacked in a step of work: fetching fresh memory is most of it */
};

/* ---- performances ---- */

static mrt_result insert_rig(sqlite *db, const take_performance *p, error *err)
{
    return sqlite_change(db, err,
                         "INSERT OR IGNORE INTO rig(path, hash, mesh_hash, unit_mm, json)"
                         "VALUES(?, ?, ?, ?, ?)",
                         "tttdt", p->rig ? p->rig : "", p->rig_hash, p->mesh_hash, p->unit_mm,
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
    const char *mapping = p->mapping ? p->mapping : "";
    mrt_result result = show_plugin_insert(db, mapping, err);
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
            mapping, p->rig ? p->rig : "", p->rig_hash, p->mesh_hash, p->unit_mm);
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

static bool read_performance(show_performance *out, sqlite_statement *row)
{
    take_performance *p = &out->performance;
    p->mapping = sqlite_text_copy(row, 0);
    p->rig = sqlite_text_copy(row, 1);
    sqlite_text(row, 2, p->rig_hash, sizeof p->rig_hash);
    sqlite_text(row, 3, p->mesh_hash, sizeof p->mesh_hash);
    bool has_json = !sqlite_is_null(row, 4);
    p->rig_json = has_json ? strdup(sqlite_exact_text(row, 4)) : NULL;
    p->unit_mm = sqlite_double(row, 5);
    p->hand_length_mm = sqlite_double(row, 6);
    p->rezero_pedal = (uint32_t)sqlite_int(row, 7);
    out->from_ns = sqlite_int(row, 8);
    out->to_ns = sqlite_int(row, 9);
    return p->mapping && p->rig && (p->rig_json || !has_json);
}

static mrt_result read_tracks(sqlite *db, take_performance *p, error *err)
{
    sqlite_statement *rows;
    mrt_result result = sqlite_query(db, &rows, err,
                                     "SELECT track FROM performance_track WHERE performance = ? "
                                     "ORDER BY n LIMIT ?",
                                     "i", "ii", p->id, (int64_t)TAKE_TRACKS_MAX);
    if (result < 0)
        return result;
    while ((result = sqlite_step(rows, err)) == MRT_OK)
        p->track[p->track_count++] = sqlite_int(rows, 0);
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

static mrt_result read_params(sqlite *db, take_performance *p, error *err)
{
    sqlite_statement *rows;
    mrt_result result =
        sqlite_query(db, &rows, err,
                     "SELECT param, value FROM performance_param WHERE performance = ? "
                     "ORDER BY n LIMIT ?",
                     "if", "ii", p->id, (int64_t)TAKE_PARAMS_MAX);
    if (result < 0)
        return result;
    while ((result = sqlite_step(rows, err)) == MRT_OK)
        p->param[p->param_count++] =
            (take_param){.id = (uint32_t)sqlite_int(rows, 0), .value = sqlite_double(rows, 1)};
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

/* ---- performed anew ---- */

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

static bool read_again_row(take_again *out, sqlite_statement *row)
{
    out->of = sqlite_int(row, 0);
    out->ignores_params = sqlite_int(row, 1) != 0;
    for (int side = 0; side < 2; ++side)
        if (!sqlite_is_null(row, 2 + side)) {
            out->calibration[side] = strdup(sqlite_exact_text(row, 2 + side));
            if (!out->calibration[side])
                return false;
        }
    out->min_cutoff_hz = sqlite_double(row, 4);
    out->beta = sqlite_double(row, 5);
    out->has_beta = out->beta >= 0.0;
    return true;
}

static mrt_result read_again(sqlite *db, take_performance *p, error *err)
{
    sqlite_statement *rows;
    mrt_result result =
        sqlite_query(db, &rows, err,
                     "SELECT of, ignores_params, left_calibration, right_calibration,"
                     "  min_cutoff_hz, beta FROM again WHERE performance = ?",
                     "iiTTff", "i", p->id);
    if (result < 0)
        return result;
    result = sqlite_step(rows, err);
    if (result == MRT_OK && !read_again_row(&p->again, rows))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for performance %lld", (long long)p->id);
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

mrt_result show_performance_read(show *self, int64_t id, show_performance *out, error *err)
{
    *out = (show_performance){.performance.id = id};
    sqlite_statement *rows;
    mrt_result result =
        sqlite_query(self->db, &rows, err, PERFORMANCE_QUERY, "ttttTffiii", "i", id);
    if (result < 0)
        return result;
    result = sqlite_step(rows, err);
    if (result == MRT_END)
        result = error_set(err, MRT_ERR_ARGUMENT, "%s: has no performance %lld", self->path,
                           (long long)id);
    else if (result == MRT_OK && !read_performance(out, rows))
        result = error_set(err, MRT_ERR_MEMORY, "no memory for performance %lld", (long long)id);
    sqlite_finish(rows);
    if (result >= 0)
        result = read_tracks(self->db, &out->performance, err);
    if (result >= 0)
        result = read_params(self->db, &out->performance, err);
    if (result >= 0)
        result = self->version < 2 ? MRT_OK : read_again(self->db, &out->performance, err);
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

static void read_event(void *item, sqlite_statement *row)
{
    take_event *out = item;
    *out = (take_event){.time_ns = sqlite_int(row, 0),
                        .kind = (uint32_t)sqlite_int(row, 1),
                        .track = sqlite_int(row, 2),
                        .param = (uint32_t)sqlite_int(row, 3),
                        .hand = (uint32_t)sqlite_int(row, 4),
                        .value = sqlite_double(row, 5)};
    sqlite_text(row, 6, out->text, sizeof out->text);
}

mrt_result show_events(show *self, int64_t from_ns, int64_t to_ns, take_event **out,
                       size_t *out_count, error *err)
{
    sqlite_statement *query;
    show_rows rows = {0};
    mrt_result result = sqlite_query(self->db, &query, err,
                                     "SELECT time_ns, kind, track, param, hand, value, text "
                                     "FROM event WHERE time_ns BETWEEN ? AND ? "
                                     "ORDER BY time_ns, id",
                                     "iiiiidt", "ii", from_ns, to_ns);
    if (result >= 0)
        result = show_read_rows(&rows, query, sizeof **out, read_event, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}

/* ---- checkpoints ---- */

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
        return error_set(err, MRT_ERR_FORMAT, "a checkpoint is damaged: its CRC-32 differs");
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
    sqlite_statement *rows;
    mrt_result result = sqlite_query(self->db, &rows, err,
                                     "SELECT time_ns, version, size, crc, bytes FROM checkpoint "
                                     "WHERE performance = ? AND time_ns <= ? "
                                     "ORDER BY time_ns DESC, id DESC LIMIT 1",
                                     "iiiib", "ii", performance, time_ns);
    if (result < 0)
        return result;
    result = sqlite_step(rows, err);
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
    sqlite_finish(rows);
    return result < 0 ? result : MRT_OK;
}

void show_checkpoint_finish(show_checkpoint *checkpoint)
{
    if (!checkpoint)
        return;
    free(checkpoint->bytes);
    *checkpoint = (show_checkpoint){0};
}
