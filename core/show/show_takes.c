/* Takes, their spans and edits, and notes. */
#include "base/clock.h"
#include "show/hash.h"
#include "show/chunk.h"
#include "show/show_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* ---- edits, as rows of text ---- */

int64_t show_edit_crc(int64_t take_id, int32_t n, const char *json)
{
    uint8_t key[12];
    for (int i = 0; i < 8; ++i)
        key[i] = (uint8_t)((uint64_t)take_id >> (8 * i));
    for (int i = 0; i < 4; ++i)
        key[8 + i] = (uint8_t)((uint32_t)n >> (8 * i));
    uLong crc = crc32(0, key, sizeof key);
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

/* ---- writing rows ---- */

mrt_result show_take_insert(sqlite *db, const show_take_row *row, error *err)
{
    return sqlite_change(
        db, err,
        "INSERT INTO take(id, created_ns, start_ns, end_ns, scene, shot, origin, number)"
        "VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7, CASE WHEN ?8 > 0 THEN ?8 ELSE"
        "  (SELECT COALESCE(MAX(number), 0) + 1 FROM take WHERE scene = ?5 AND shot = ?6) END)",
        "iiiottti", row->id, row->created_ns, row->start_ns, row->end_ns, row->scene, row->shot,
        row->origin, (int64_t)row->number);
}

/* Inserts a span. Data before from_ns is needed too, back to where a replay can start. */
mrt_result show_span_insert(sqlite *db, int64_t take_id, int64_t performance, int64_t from_ns,
                            const int64_t *to_ns, bool is_shown, error *err)
{
    return sqlite_change(
        db, err,
        "INSERT INTO span(take, n, performance, from_ns, to_ns, is_shown, need_ns)"
        "VALUES(?1, (SELECT COALESCE(MAX(n), 0) + 1 FROM span WHERE take = ?1), ?2, ?3, ?4, ?5,"
        "  MIN(?3, COALESCE("
        "    (SELECT MAX(time_ns) FROM checkpoint WHERE performance = ?2 AND time_ns <= ?3),"
        "    (SELECT from_ns FROM performance WHERE id = ?2), ?3)))",
        "ioioi", take_id, performance ? &performance : NULL, from_ns, to_ns, (int64_t)is_shown);
}

static mrt_result check_span(const show_span *span, int64_t take_id, error *err)
{
    if (span->performance >= 0 && span->to_ns >= span->from_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "take %lld: a span from %lld to %lld ns is invalid",
                     (long long)take_id, (long long)span->from_ns, (long long)span->to_ns);
}

/* Checks and inserts the spans, each with its own is_shown. */
static mrt_result insert_spans(sqlite *db, int64_t take_id, const show_span *spans, size_t count,
                               error *err)
{
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < count && result >= 0; ++i) {
        const show_span *span = &spans[i];
        result = check_span(span, take_id, err);
        if (result >= 0)
            result = show_span_insert(db, take_id, span->performance, span->from_ns, &span->to_ns,
                                      span->is_shown, err);
    }
    return result;
}

static mrt_result insert_new(show *self, int64_t id, const show_new_take *made, error *err)
{
    show_take_row row = {.id = id,
                         .created_ns = made->created_ns,
                         .start_ns = made->start_ns,
                         .end_ns = &made->end_ns,
                         .scene = made->scene,
                         .shot = made->shot,
                         .origin = made->origin,
                         .number = made->number};
    mrt_result result = show_take_insert(self->db, &row, err);
    if (result >= 0)
        result = insert_spans(self->db, id, made->spans, made->span_count, err);
    for (size_t i = 0; i < made->base_edit_count && result >= 0; ++i) {
        int32_t n = (int32_t)i + 1 - (int32_t)made->base_edit_count;
        result = show_edit_insert(self->db, id, n, made->utc_ms, made->base_edits[i], err);
    }
    return result;
}

mrt_result show_take_create(show *self, const show_new_take *made, int64_t *out_id, error *err)
{
    *out_id = 0;
    mrt_result result = show_check_writable(self, err);
    if (result < 0)
        return result;
    if (made->end_ns < made->start_ns || made->base_edit_count > INT32_MAX / 2)
        return error_set(err, MRT_ERR_ARGUMENT, "a take cannot end before it starts");
    result = sqlite_begin(self->db, err);
    if (result < 0)
        return result;
    int64_t id = show_next_id(self, SHOW_ID_TAKE);
    result = sqlite_end(self->db, insert_new(self, id, made, err), err);
    if (result >= 0)
        *out_id = id;
    return result;
}

/* ---- reading rows ---- */

/* Time of the last sample of the tracks that a take records. */
#define LAST_OF_TAKE                                                                               \
    "(SELECT MAX((SELECT to_ns FROM chunk WHERE chunk.track = p.track"                             \
    "             ORDER BY from_ns DESC, chunk.id DESC LIMIT 1))"                                  \
    " FROM span JOIN performance_track p ON p.performance = span.performance"                      \
    " WHERE span.take = take.id)"
#define TAKE_COLUMNS                                                                               \
    "id, created_ns, start_ns, MAX(start_ns, COALESCE(end_ns, " LAST_OF_TAKE ", start_ns)),"       \
    " end_ns IS NULL, is_recovered, scene, shot, number, origin, edit_head,"                       \
    " (SELECT COUNT(*) FROM edit WHERE edit.take = take.id AND branch = 0 AND n > 0),"             \
    " (SELECT COUNT(*) FROM edit WHERE edit.take = take.id AND branch = 0 AND n <= 0)"

#define TAKE_KINDS "innnzzttutwww"

/* Reads the take that this one was performed over. In an untrusted file its id must be lower than
 * that of this take. */
static void read_over(show_take *out)
{
    long long over, at_ms;
    if (sscanf(out->origin, SHOW_ORIGIN_OVER, &over, &at_ms) != 2 || over <= 0 || over >= out->id ||
        at_ms < 0 || at_ms > INT64_MAX / NS_PER_MS)
        return;
    out->over = over;
    out->over_at_ns = at_ms * NS_PER_MS;
}

static mrt_result read_take(void *item, sqlite_statement *row, error *err)
{
    show_take *out = item;
    *out = (show_take){0};
    mrt_result result =
        sqlite_get(row, err, &out->id, &out->created_ns, &out->start_ns, &out->end_ns,
                   &out->is_recording, &out->is_recovered, out->scene, sizeof out->scene, out->shot,
                   sizeof out->shot, &out->number, out->origin, sizeof out->origin, &out->edit_head,
                   &out->edit_count, &out->base_edit_count);
    read_over(out);
    return result;
}

mrt_result show_takes(show *self, show_take **out, size_t *out_count, error *err)
{
    show_rows rows;
    mrt_result result = show_read_rows(
        &rows,
        sqlite_query(self->db, "SELECT " TAKE_COLUMNS " FROM take ORDER BY id", TAKE_KINDS, ""),
        sizeof **out, read_take, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}

mrt_result show_take_read(show *self, int64_t id, show_take *out, error *err)
{
    *out = (show_take){0};
    sqlite_statement *row = sqlite_query(self->db, "SELECT " TAKE_COLUMNS " FROM take WHERE id = ?",
                                         TAKE_KINDS, "i", id);
    mrt_result result = sqlite_step_one(row, "take", id, err);
    if (result >= 0)
        result = read_take(out, row, err);
    return sqlite_finish_rows(row, result);
}

static mrt_result read_span(void *item, sqlite_statement *row, error *err)
{
    show_span *out = item;
    return sqlite_get(row, err, &out->performance, &out->from_ns, &out->to_ns, &out->is_shown);
}

static mrt_result read_spans(show *self, const show_take *of, show_span **out, size_t *out_count,
                             error *err)
{
    show_rows rows;
    mrt_result result = show_read_rows(
        &rows,
        sqlite_query(self->db,
                     "SELECT performance, from_ns, MAX(from_ns, COALESCE(to_ns, ?2)),"
                     "  is_shown FROM span WHERE take = ?1 ORDER BY n",
                     "Innz", "ii", of->id, of->end_ns),
        sizeof **out, read_span, err);
    *out = rows.item;
    *out_count = rows.count;
    return result;
}

mrt_result show_take_spans(show *self, int64_t id, show_span **out, size_t *out_count, error *err)
{
    show_take of;
    *out = NULL;
    *out_count = 0;
    mrt_result result = show_take_read(self, id, &of, err);
    return result < 0 ? result : read_spans(self, &of, out, out_count, err);
}

/* ---- the take before its edits ---- */

/* Whether the span has samples of a part, or data before it that the span needs. Such data is never
 * removed, so the answer stays. A palette or life at rest has one sample, when it is opened. */
static mrt_result has_part(show *self, int64_t take_id, const show_span *span,
                           const take_own_part *part, bool *out, error *err)
{
    sqlite_statement *row = sqlite_query(
        self->db,
        "SELECT 1 FROM span JOIN performance_track p ON p.performance = span.performance"
        "  JOIN track t ON t.id = p.track JOIN plugin ON plugin.id = t.plugin"
        "  JOIN chunk c ON c.track = t.id"
        " WHERE span.take = ?1 AND span.performance = ?2 AND span.is_shown"
        "  AND plugin.identity LIKE ?4 || ' %'"
        "  AND c.from_ns <= ?3 AND c.to_ns >= span.need_ns AND c.to_ns > c.from_ns LIMIT 1",
        "i", "iiit", take_id, span->performance, span->to_ns, part->plugin);
    const mrt_result result = sqlite_step(row, err);
    *out = result == MRT_OK;
    return sqlite_finish_rows(row, result);
}

static mrt_result add_clip(take *t, take_layer *layer, const show_span *span, take_part part,
                           error *err)
{
    void *clips = layer->clip;
    mrt_result result = show_grow(&clips, layer->clip_count, sizeof *layer->clip, err);
    layer->clip = clips;
    if (result < 0)
        return result;
    take_clip *clip = &layer->clip[layer->clip_count];
    *clip = (take_clip){.id = ++t->id_count,
                        .performance = span->performance,
                        .part = part,
                        .from_ns = span->from_ns,
                        .to_ns = span->to_ns,
                        .start_ns = span->from_ns - t->start_ns,
                        .end_ns = span->to_ns - t->start_ns,
                        .warp_count = 1,
                        .warp = calloc(1, sizeof *clip->warp),
                        .gain = 1};
    if (!clip->warp)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a clip");
    clip->warp[0] = (take_warp_point){.at_ns = clip->start_ns, .source_ns = 0};
    ++layer->clip_count;
    return MRT_OK;
}

static bool is_clip(const show_span *span)
{
    return span->is_shown && span->performance && span->to_ns > span->from_ns;
}

/* Which parts of a span have layers of their own. */
typedef struct own_parts {
    bool has[TAKE_OWN_PARTS];
} own_parts;

static bool has_any(const own_parts *of)
{
    bool any = false;
    for (int i = 0; i < TAKE_OWN_PARTS; ++i)
        any |= of->has[i];
    return any;
}

/* Adds a part, such as the poses of the palette, as a layer above the others, as it was performed.
 * Nothing if no span has it. */
static mrt_result add_part(take *out, const show_span *spans, size_t count, const own_parts *parts,
                           int which, error *err)
{
    take_layer *layer = &out->layer[out->layer_count];
    mrt_result result = MRT_OK;
    for (size_t i = 0; i < count && result >= 0; ++i) {
        if (!parts[i].has[which])
            continue;
        if (layer->id == 0) {
            *layer = (take_layer){.id = ++out->id_count, .is_additive = true, .gain = 1};
            snprintf(layer->name, sizeof layer->name, "%s", take_own_part_of[which].layer);
            out->layer_count += 1;
        }
        result = add_clip(out, layer, &spans[i], take_own_part_of[which].part, err);
    }
    return result;
}

static mrt_result fill_layers(show *self, take *out, const show_span *spans, size_t count,
                              error *err)
{
    own_parts *parts = calloc(count, sizeof *parts);
    out->layer = calloc(1 + TAKE_OWN_PARTS, sizeof *out->layer);
    mrt_result result = MRT_OK;
    if (!out->layer || !parts)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a layer");
    for (size_t i = 0; i < count && result >= 0; ++i)
        for (int k = 0; k < TAKE_OWN_PARTS && is_clip(&spans[i]) && result >= 0; ++k)
            result =
                has_part(self, out->id, &spans[i], &take_own_part_of[k], &parts[i].has[k], err);
    if (result < 0)
        goto done;
    take_layer *layer = &out->layer[out->layer_count++];
    *layer = (take_layer){.id = ++out->id_count, .gain = 1};
    snprintf(layer->name, sizeof layer->name, "performance");
    for (size_t i = 0; i < count && result >= 0; ++i)
        if (is_clip(&spans[i]))
            result =
                add_clip(out, layer, &spans[i], has_any(&parts[i]) ? TAKE_HANDS : TAKE_WHOLE, err);
    for (int k = 0; k < TAKE_OWN_PARTS && result >= 0; ++k)
        result = add_part(out, spans, count, parts, k, err);
done:
    free(parts);
    return result;
}

mrt_result show_take_base(show *self, int64_t id, take *out, error *err)
{
    show_take row;
    *out = (take){0};
    mrt_result result = show_take_read(self, id, &row, err);
    return result < 0 ? result : show_take_base_of(self, &row, out, err);
}

mrt_result show_take_base_of(show *self, const show_take *row, take *out, error *err)
{
    *out = (take){0};
    show_span *spans;
    size_t span_count;
    mrt_result result = read_spans(self, row, &spans, &span_count, err);
    if (result < 0)
        return result;
    *out = (take){.id = row->id,
                  .created_ns = row->created_ns,
                  .start_ns = row->start_ns,
                  .duration_ns = row->end_ns - row->start_ns,
                  .is_recording = row->is_recording,
                  .number = row->number};
    memcpy(out->scene, row->scene, sizeof out->scene);
    memcpy(out->shot, row->shot, sizeof out->shot);
    memcpy(out->origin, row->origin, sizeof out->origin);
    if (row->is_recovered)
        snprintf(out->origin, sizeof out->origin, "%.80s, recovered", row->origin);
    size_t shown = 0;
    for (size_t i = 0; i < span_count; ++i)
        shown += spans[i].is_shown;
    if (shown > 0)
        result = fill_layers(self, out, spans, span_count, err);
    free(spans);
    if (result < 0)
        take_finish(out);
    return result;
}

/* ---- closing takes after a kill ---- */

static mrt_result count_chunks_of(sqlite *db, int64_t track, error *err)
{
    sqlite_statement *last = sqlite_query(db,
                                          "SELECT bytes FROM chunk WHERE track = ? "
                                          "ORDER BY from_ns DESC, id DESC LIMIT 1",
                                          "b", "i", track);
    int64_t count = 0;
    mrt_result result = sqlite_step(last, err);
    if (result == MRT_OK) {
        chunk_head head;
        size_t size;
        const uint8_t *bytes = sqlite_blob(last, 0, &size);
        count = chunk_read_head(&head, bytes, size, NULL) < 0 ? -1 : (int64_t)head.ordinal + 1;
    }
    result = sqlite_finish_rows(last, result);
    if (result < 0 || count < 0) /* the last chunk is damaged, so the number of chunks is unknown */
        return result;
    return sqlite_change(db, err, "UPDATE track SET chunk_count = ? WHERE id = ?", "ii", count,
                         track);
}

static mrt_result count_chunks(sqlite *db, error *err)
{
    sqlite_statement *tracks =
        sqlite_query(db, "SELECT id FROM track WHERE chunk_count IS NULL", "i", "");
    mrt_result result;
    while ((result = sqlite_step(tracks, err)) == MRT_OK) {
        result = count_chunks_of(db, sqlite_int(tracks, 0), err);
        if (result < 0)
            break;
    }
    return sqlite_finish_rows(tracks, result);
}

static mrt_result close_all(sqlite *db, int64_t *out_take_count, error *err)
{
    mrt_result result =
        sqlite_change(db, err,
                      "UPDATE take SET is_recovered = 1, end_ns = MAX(start_ns,"
                      "  COALESCE(" LAST_OF_TAKE ", start_ns)) WHERE end_ns IS NULL",
                      "");
    *out_take_count = result < 0 ? 0 : sqlite_changes(db);
    if (result >= 0)
        result = sqlite_run(
            db,
            "UPDATE span SET to_ns = MAX(from_ns, (SELECT end_ns FROM take WHERE id = span.take))"
            "  WHERE to_ns IS NULL;"
            "UPDATE performance SET to_ns = MAX(from_ns, COALESCE("
            "  (SELECT MAX((SELECT to_ns FROM chunk WHERE chunk.track = p.track"
            "               ORDER BY from_ns DESC, chunk.id DESC LIMIT 1))"
            "   FROM performance_track p WHERE p.performance = performance.id), from_ns))"
            "  WHERE to_ns IS NULL",
            err);
    return result < 0 ? result : count_chunks(db, err);
}

mrt_result show_close_open_ends(sqlite *db, int64_t *out_take_count, error *err)
{
    int64_t is_open;
    *out_take_count = 0;
    mrt_result result = sqlite_number(db,
                                      "SELECT EXISTS(SELECT 1 FROM take WHERE end_ns IS NULL)"
                                      "OR EXISTS(SELECT 1 FROM performance WHERE to_ns IS NULL)"
                                      "OR EXISTS(SELECT 1 FROM track WHERE chunk_count IS NULL)",
                                      0, &is_open, err);
    if (result < 0 || !is_open)
        return result;
    result = sqlite_begin(db, err);
    return result < 0 ? result : sqlite_end(db, close_all(db, out_take_count, err), err);
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
                         "%s: edit %d of take %lld is damaged: its checksum (CRC-32) is wrong",
                         path, edit->n, (long long)take_id);
    bool is_next = out->count > 1 ? edit->n == out->edit[out->count - 2].n + 1 : edit->n <= 1;
    if (!is_next)
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
    sqlite_statement *rows = sqlite_query(self->db,
                                          "SELECT n, utc_ms, crc, json FROM edit "
                                          "WHERE take = ? AND branch = 0 ORDER BY n",
                                          "iiit", "i", take_id);
    mrt_result result;
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
        result = insert_spans(self->db, take_id, spans, span_count, err);
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
                         "take %lld: %d edits cannot be in effect: it has %d", (long long)take_id,
                         head, of.edit_count);
    return set_head(self->db, take_id, head, err);
}

/* ---- notes about the whole show ---- */

mrt_result show_note_read(show *self, const char *key, char *out, size_t capacity, error *err)
{
    out[0] = '\0';
    sqlite_statement *row =
        sqlite_query(self->db, "SELECT value FROM meta WHERE key = 'note.' || ?", "t", "t", key);
    mrt_result result = sqlite_step(row, err);
    if (result == MRT_OK && strlen(sqlite_exact_text(row, 0)) >= capacity)
        result = error_set(err, MRT_ERR_FORMAT, "%s: the note '%s' is too long", self->path, key);
    else if (result == MRT_OK)
        sqlite_text(row, 0, out, capacity);
    return sqlite_finish_rows(row, result);
}

mrt_result show_note_write(show *self, const char *key, const char *text, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result < 0)
        return result;
    if (!text[0])
        return sqlite_change(self->db, err, "DELETE FROM meta WHERE key = 'note.' || ?", "t", key);
    return sqlite_change(self->db, err,
                         "INSERT INTO meta(key, value) VALUES('note.' || ?, ?)"
                         "ON CONFLICT(key) DO UPDATE SET value = excluded.value",
                         "tt", key, text);
}

/* ---- pictures ---- */

mrt_result show_picture_read(show *self, const char *hash, void **out, size_t *out_size, error *err)
{
    char found[TAKE_HASH];
    *out = NULL;
    *out_size = 0;
    sqlite_statement *rows = sqlite_query(
        self->db, "SELECT value FROM meta WHERE key = 'picture.' || ?", "b", "t", hash);
    mrt_result result = sqlite_step(rows, err);
    if (result == MRT_OK) {
        const uint8_t *bytes = sqlite_blob(rows, 0, out_size);
        hash_bytes(found, bytes, *out_size);
        if (*out_size > SHOW_PICTURE_BYTES || strcmp(found, hash) != 0)
            result = error_set(err, MRT_ERR_FORMAT, "%s: a picture in it is damaged", self->path);
        else if (!(*out = malloc(*out_size + 1)))
            result = error_set(err, MRT_ERR_MEMORY, "no memory for a picture");
        else
            memcpy(*out, bytes, *out_size);
    }
    sqlite_finish(rows);
    return result;
}

mrt_result show_picture_write(show *self, const char *hash, const void *bytes, size_t size,
                              error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result < 0)
        return result;
    return sqlite_change(self->db, err,
                         "INSERT OR IGNORE INTO meta(key, value) VALUES('picture.' || ?, ?)", "tb",
                         hash, bytes, size);
}

mrt_result show_pictures_forget(show *self, const char *but, error *err)
{
    mrt_result result = show_check_writable(self, err);
    if (result < 0)
        return result;
    return sqlite_change(self->db, err,
                         "DELETE FROM meta WHERE key GLOB 'picture.*' AND key <> 'picture.' || ?",
                         "t", but);
}
