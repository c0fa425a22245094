/* Copies a damaged show into a new one, row by row. It copies only rows that prove to be undamaged.
 * */
#include "base/budget.h"
#include "base/cancel.h"
#include "base/file.h"
#include "show/chunk.h"
#include "show/show_file.h"
#include "show/show_schema.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

/* ---- reading rows from pages: sqlite.org/fileformat2.html, sections 1.6, 2.1 ---- */

/* The rows may be old or invalid, so only rows with their own CRC are used. Accepts any bytes. */

enum { COLUMNS_MAX = 8 };

typedef struct salvaged_value {
    int64_t number; /* 0 for NULL, texts and blobs */
    const uint8_t *bytes;
    size_t size;
    bool is_blob;
} salvaged_value;
typedef struct salvaged_row {
    int64_t id; /* id of the row; the column of the id is NULL */
    uint32_t column_count;
    salvaged_value column[COLUMNS_MAX];
} salvaged_row;

enum {
    PAGE_BYTES = 4096, /* page size of every show */
    LEAF_OF_TABLE = 13,
    LEAF_HEAD = 8,
    PAYLOAD_MAX = 64 * 1024 * 1024,
    STEPS_A_PAGE = 200, /* budget steps for reading one page (base/budget.h) */
    STEPS_A_CELL = 50
};

typedef struct pages {
    FILE *file;
    uint32_t count;
    uint8_t *payload; /* PAYLOAD_MAX at most; grown as needed */
    size_t payload_capacity;
    uint32_t *visited_by; /* per page: the last chain that contained it; count + 1 */
    uint32_t chain_count;
    budget *left;
} pages;

static bool read_page(const pages *in, uint32_t number, uint8_t out[PAGE_BYTES])
{
    return number >= 1 && number <= in->count &&
           fseek(in->file, (long)(number - 1) * PAGE_BYTES, SEEK_SET) == 0 &&
           fread(out, 1, PAGE_BYTES, in->file) == PAGE_BYTES;
}

/* Reads a varint: big-endian, 7 bits a byte, all bits of a ninth byte. False: it does not end
 * before `end`. */
static bool get_varint(const uint8_t **at, const uint8_t *end, uint64_t *out)
{
    *out = 0;
    for (int i = 0; i < 9 && *at < end; ++i) {
        uint8_t byte = *(*at)++;
        if (i == 8) {
            *out = *out << 8 | byte;
            return true;
        }
        *out = *out << 7 | (byte & 127);
        if (byte < 128)
            return true;
    }
    return false;
}

static uint32_t big_endian(const uint8_t *at, int byte_count)
{
    uint32_t value = 0;
    for (int i = 0; i < byte_count; ++i)
        value = value << 8 | at[i];
    return value;
}

static bool reserve_payload(pages *in, size_t size)
{
    if (size <= in->payload_capacity)
        return true;
    uint8_t *larger = realloc(in->payload, size);
    if (!larger)
        return false;
    in->payload = larger;
    in->payload_capacity = size;
    return true;
}

/* Returns the bytes of a payload in the cell; the rest is in a chain of overflow pages. */
static size_t local_size(size_t size)
{
    const size_t most = PAGE_BYTES - 35, least = (PAGE_BYTES - 12) * 32 / 255 - 23;
    if (size <= most)
        return size;
    size_t local = least + (size - least) % (PAGE_BYTES - 4);
    return local <= most ? local : least;
}

static bool read_payload(pages *in, const uint8_t *at, const uint8_t *end, size_t size)
{
    uint8_t page[PAGE_BYTES];
    size_t got = local_size(size);
    size_t chained = got < size ? 4 : 0;
    if (size == 0 || size > PAYLOAD_MAX || size > (size_t)in->count * PAGE_BYTES ||
        (size_t)(end - at) < got + chained || !reserve_payload(in, size))
        return false;
    memcpy(in->payload, at, got);
    uint32_t next = chained ? big_endian(at + got, 4) : 0;
    in->chain_count += 1;
    while (got < size) {
        if (next > in->count || in->visited_by[next] == in->chain_count ||
            !read_page(in, next, page) || budget_spend_work(in->left, STEPS_A_PAGE, NULL) < 0)
            return false; /* the chain ends, forms a loop, or exceeds the budget */
        in->visited_by[next] = in->chain_count;
        size_t part = size - got < PAGE_BYTES - 4 ? size - got : PAGE_BYTES - 4;
        memcpy(in->payload + got, page + 4, part);
        next = big_endian(page, 4);
        got += part;
    }
    return true;
}

/* Sizes of whole numbers by their serial type 0..9. */
static bool get_value(salvaged_value *out, uint64_t type, const uint8_t **at, const uint8_t *end)
{
    static const uint8_t number_bytes[10] = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
    *out = (salvaged_value){.number = type == 9};
    size_t size = type < 10 ? number_bytes[type] : (size_t)((type - 12) / 2);
    if (type == 10 || type == 11 || (size_t)(end - *at) < size)
        return false;
    if (type >= 12) {
        out->bytes = *at;
        out->size = size;
        out->is_blob = type % 2 == 0;
    } else if (size > 0) {
        uint64_t value = **at & 128 ? UINT64_MAX : 0;
        for (size_t i = 0; i < size; ++i)
            value = value << 8 | (*at)[i];
        out->number = (int64_t)value;
    }
    *at += size;
    return true;
}

static bool get_row(salvaged_row *out, const uint8_t *payload, size_t size)
{
    const uint8_t *head = payload, *end = payload + size;
    uint64_t head_size, type;
    if (!get_varint(&head, end, &head_size) || head_size > size)
        return false;
    const uint8_t *body = payload + head_size, *head_end = body;
    out->column_count = 0;
    while (head < head_end) {
        if (out->column_count == COLUMNS_MAX || !get_varint(&head, head_end, &type) ||
            !get_value(&out->column[out->column_count], type, &body, end))
            return false;
        ++out->column_count;
    }
    return true;
}

/* MRT_END: the budget is spent. */
static mrt_result salvage_page(pages *in, const uint8_t page[PAGE_BYTES],
                               mrt_result (*each)(void *data, const salvaged_row *row), void *data)
{
    mrt_result result = MRT_OK;
    uint32_t cell_count = big_endian(page + 3, 2);
    if (page[0] != LEAF_OF_TABLE || LEAF_HEAD + 2 * cell_count > PAGE_BYTES)
        return MRT_OK;
    for (uint32_t i = 0; i < cell_count && result >= 0; ++i) {
        if (cancel_is_requested() || budget_spend_work(in->left, STEPS_A_CELL, NULL) < 0)
            return MRT_END;
        salvaged_row row;
        uint64_t size, id;
        const uint8_t *at = page + big_endian(page + LEAF_HEAD + 2 * i, 2);
        const uint8_t *end = page + PAGE_BYTES;
        if (at > end || !get_varint(&at, end, &size) || !get_varint(&at, end, &id) ||
            size > PAYLOAD_MAX || !read_payload(in, at, end, (size_t)size) ||
            !get_row(&row, in->payload, (size_t)size))
            continue;
        row.id = (int64_t)id;
        result = each(data, &row);
    }
    return result;
}

static mrt_result salvage_pages(pages *in, uint64_t begin, uint64_t end,
                                mrt_result (*each)(void *data, const salvaged_row *row), void *data)
{
    mrt_result result = MRT_OK;
    for (uint64_t at = begin / PAGE_BYTES; at < end / PAGE_BYTES && result == MRT_OK; ++at) {
        uint8_t page[PAGE_BYTES];
        if (read_page(in, (uint32_t)at + 1, page))
            result = salvage_page(in, page, each, data);
    }
    return result;
}

/* Calls `each` for each row of at most COLUMNS_MAX columns, until it fails. MRT_END: the budget was
 * spent before the end of the file. */
static mrt_result salvage_file(const char *path,
                               mrt_result (*each)(void *data, const salvaged_row *row), void *data,
                               budget *left, error *err)
{
    pages in = {.file = fopen(path, "rb"), .left = left};
    const int holes = os_open(
        path, OS_READ); /* separate descriptor, because the search for holes moves its position */
    if (!in.file || holes < 0) {
        if (in.file)
            (void)fclose(in.file);
        return error_set(err, MRT_ERR_IO, "%s: cannot be read", path);
    }
    const long size = fseek(in.file, 0, SEEK_END) == 0 ? ftell(in.file) : 0;
    uint64_t begin, end = PAGE_BYTES;
    in.count = size > 0 ? (uint32_t)(size / PAGE_BYTES) : 0;
    in.visited_by = calloc((size_t)in.count + 1, sizeof *in.visited_by);
    mrt_result result = in.visited_by
                            ? MRT_OK
                            : error_set(err, MRT_ERR_MEMORY, "%s: no memory to recover it", path);
    while (result == MRT_OK && file_next_data(holes, end, &begin, &end))
        result = salvage_pages(&in, begin, end, each, data);
    close(holes);
    (void)fclose(in.file);
    free(in.visited_by);
    free(in.payload);
    return result;
}

/* ---- into a new show ---- */

enum {
    PROBES_MAX = 4000000,
    EDITS_LOST_BRANCH = 1 << 20,
    STEPS_A_ROW = 400 /* budget steps for a row */
};

/* ---- checking rows for damage ---- */

typedef struct recovery {
    sqlite *from, *to;
    budget left; /* a file with loops exhausts it */
    show_recovery *out;
    mrt_sample *sample; /* CHUNK_SAMPLES_MAX */
    bool has_lost;      /* a table could not be read to its end */
    error *err;
} recovery;

/* Pays from the budget. False: the work exceeds what a file of this size can need, or the user
 * cancelled. Rows that were already copied count. */
static bool pay(recovery *self, uint64_t steps)
{
    self->out->is_cut |= budget_spend_work(&self->left, steps, NULL) < 0;
    return !self->out->is_cut && !cancel_is_requested();
}

static bool is_whole_chunk(recovery *self, sqlite_statement *row)
{
    chunk_head head;
    size_t size;
    const uint8_t *bytes = sqlite_blob(row, 4, &size);
    return chunk_decode(self->sample, &head, bytes, size, NULL) >= 0 &&
           pay(self, (uint64_t)head.sample_count * head.channel_count) &&
           head.track == sqlite_int(row, 1) && head.from_ns == sqlite_int(row, 2) &&
           self->sample[head.sample_count - 1].time_ns == sqlite_int(row, 3);
}

static bool is_whole_edit(recovery *self, sqlite_statement *row)
{
    (void)self;
    return show_edit_crc(sqlite_int(row, 0), (int32_t)sqlite_int(row, 2),
                         sqlite_exact_text(row, 5)) == sqlite_int(row, 4);
}

/* Checks the CRC of a checkpoint or a piece of audio. */
static bool is_whole_blob(recovery *self, sqlite_statement *row)
{
    size_t size;
    const uint8_t *bytes = sqlite_blob(row, 6, &size);
    (void)self;
    return (int64_t)crc32_z(0, bytes, size) == sqlite_int(row, 5);
}

/* Returns the additional check for rows of that table; NULL: none. */
static bool (*proof_of(const char *table))(recovery *self, sqlite_statement *row)
{
    static const struct proof {
        const char *table;
        bool (*is_whole)(recovery *self, sqlite_statement *row);
    } proofs[] = {{"edit", is_whole_edit},
                  {"chunk", is_whole_chunk},
                  {"checkpoint", is_whole_blob},
                  {"audio_chunk", is_whole_blob}};
    for (size_t i = 0; i < sizeof proofs / sizeof proofs[0]; ++i)
        if (strcmp(proofs[i].table, table) == 0)
            return proofs[i].is_whole;
    return NULL;
}

static bool is_whole(recovery *self, const show_table *of, sqlite_statement *row)
{
    for (int i = 0; of->kinds[i]; ++i)
        if (!sqlite_is(row, i, of->kinds[i]))
            return false;
    bool (*proof)(recovery *, sqlite_statement *) = proof_of(of->name);
    return !proof || proof(self, row);
}

/* ---- copying ---- */

/* Copies a row. A row that the new show refuses also counts as damaged: a duplicate key, or a
 * missing value. */
static mrt_result copy_row(recovery *self, const show_table *of, sqlite_statement *row,
                           sqlite_statement *insert, error *err)
{
    if (!is_whole(self, of, row)) {
        ++self->out->damaged_count;
        return MRT_OK;
    }
    sqlite_bind_row(insert, row);
    mrt_result result = sqlite_execute(insert, err);
    if (result == MRT_ERR_ARGUMENT) {
        ++self->out->damaged_count;
        return MRT_OK;
    }
    if (result >= 0)
        self->out->row_count += sqlite_changes(self->to);
    return result;
}

/* Copies rows in this order until the end or until a row cannot be read: *out_last_id is the last
 * one. Only a failure of the new show is an error. */
static mrt_result copy_run(recovery *self, const show_table *of, const char *order,
                           sqlite_statement *insert, int64_t *out_last_id, bool *out_is_whole,
                           error *err)
{
    char sql[160];
    const char *comma = strchr(of->key, ',');
    if (comma && order[0])
        (void)snprintf(sql, sizeof sql, "SELECT * FROM %s ORDER BY %.*s DESC%s DESC", of->name,
                       (int)(comma - of->key), of->key, comma);
    else
        (void)snprintf(sql, sizeof sql, "SELECT * FROM %s ORDER BY %s%s", of->name, of->key, order);
    sqlite_statement *rows;
    *out_is_whole = false;
    if (sqlite_prepare(self->from, &rows, sql, "*", NULL) < 0)
        return MRT_OK;
    mrt_result result = MRT_OK, step;
    bool has_last = false, goes_on = true;
    while ((step = sqlite_step(rows, NULL)) == MRT_OK && result >= 0 && goes_on) {
        int64_t id = of->has_id ? sqlite_int(rows, 0) : 0;
        goes_on =
            (!has_last || !of->has_id || (order[0] ? id < *out_last_id : id > *out_last_id)) &&
            pay(self, STEPS_A_ROW);
        if (!goes_on)
            break;
        *out_last_id = id;
        has_last = true;
        result = copy_row(self, of, rows, insert, err);
    }
    *out_is_whole = step == MRT_END;
    sqlite_finish(rows);
    return result < 0 ? result : cancel_check(err);
}

static mrt_result probe(recovery *self, const show_table *of, int64_t from_id, int64_t to_id,
                        sqlite_statement *insert, error *err)
{
    char sql[96];
    sqlite_statement *row;
    (void)snprintf(sql, sizeof sql, "SELECT * FROM %s WHERE id = ?", of->name);
    if (to_id - from_id > PROBES_MAX || sqlite_prepare(self->from, &row, sql, "*", NULL) < 0)
        return MRT_OK;
    mrt_result result = MRT_OK;
    for (int64_t id = from_id; id < to_id && result >= 0 && pay(self, STEPS_A_ROW); ++id) {
        sqlite_bind(row, "i", id);
        if (sqlite_step(row, NULL) == MRT_OK)
            result = copy_row(self, of, row, insert, err);
    }
    sqlite_finish(row);
    return result < 0 ? result : cancel_check(err);
}

/* Copies from the front up to the damage, from the back up to the damage, and the rows between one
 * by one. */
static mrt_result copy_table(recovery *self, const show_table *of, error *err)
{
    char sql[160] = "";
    sqlite_statement *insert;
    int length = snprintf(sql, sizeof sql, "INSERT OR IGNORE INTO %s VALUES(?", of->name);
    for (size_t i = 1; i < strlen(of->kinds); ++i)
        length += snprintf(sql + length, sizeof sql - (size_t)length, ", ?");
    (void)snprintf(sql + length, sizeof sql - (size_t)length, ")");
    mrt_result result = sqlite_prepare(self->to, &insert, sql, "", err);
    if (result < 0)
        return result;
    bool is_whole;
    int64_t first_id = 0, last_id = 0;
    result = copy_run(self, of, "", insert, &first_id, &is_whole, err);
    if (result >= 0 && !is_whole) {
        result = copy_run(self, of, " DESC", insert, &last_id, &is_whole, err);
        self->has_lost |= !is_whole;
        if (result >= 0 && of->has_id && last_id > first_id)
            result = probe(self, of, first_id + 1, last_id, insert, err);
    }
    sqlite_finish(insert);
    return result;
}

/* ---- rows that no table reaches any more ---- */

static bool is_blob_of_crc(const salvaged_row *row)
{
    return row->column_count == 7 && row->column[6].is_blob &&
           (int64_t)crc32_z(0, row->column[6].bytes, row->column[6].size) == row->column[5].number;
}

static bool is_packed(const salvaged_row *row)
{
    const uint8_t *bytes = row->column[6].bytes;
    return row->column[6].size > 2 && bytes[0] == 0x78 && (bytes[0] * 256 + bytes[1]) % 31 == 0;
}

/* A chunk that grew may exist twice; the longer one is used. */
static mrt_result salvage_chunk(recovery *self, const salvaged_row *row)
{
    chunk_head head;
    const salvaged_value *bytes = &row->column[4];
    if (row->column_count != 5 || !bytes->is_blob ||
        chunk_decode(self->sample, &head, bytes->bytes, bytes->size, NULL) < 0)
        return MRT_OK;
    if (!pay(self, (uint64_t)head.sample_count * head.channel_count))
        return MRT_END;
    int64_t to_ns = self->sample[head.sample_count - 1].time_ns;
    mrt_result result = sqlite_change(
        self->to, self->err,
        "INSERT INTO chunk(id, track, from_ns, to_ns, bytes) VALUES(?1, ?2, ?3, ?4, ?5)"
        " ON CONFLICT(id) DO UPDATE SET to_ns = ?4, bytes = ?5"
        "  WHERE track = ?2 AND from_ns = ?3 AND to_ns < ?4",
        "iiiib", row->id, head.track, head.from_ns, to_ns, (const void *)bytes->bytes, bytes->size);
    self->out->row_count += result >= 0 ? sqlite_changes(self->to) : 0;
    return result == MRT_ERR_ARGUMENT ? MRT_OK : result;
}

/* Checkpoints are compressed, audio is not. */
static mrt_result salvage_blob(recovery *self, const salvaged_row *row)
{
    const salvaged_value *column = row->column;
    if (!is_blob_of_crc(row))
        return MRT_OK;
    if (!pay(self, STEPS_A_ROW + column[6].size / 8))
        return MRT_END;
    mrt_result result = sqlite_change(
        self->to, self->err,
        is_packed(row) ? "INSERT OR IGNORE INTO checkpoint VALUES(?, ?, ?, ?, ?, ?, ?)"
                       : "INSERT OR IGNORE INTO audio_chunk VALUES(?, ?, ?, ?, ?, ?,"
                         "  ?)",
        "iiiiiib", row->id, column[1].number, column[2].number, column[3].number, column[4].number,
        column[5].number, (const void *)column[6].bytes, column[6].size);
    self->out->row_count += result >= 0 ? sqlite_changes(self->to) : 0;
    return result == MRT_ERR_ARGUMENT ? MRT_OK : result;
}

static mrt_result salvage_row(void *data, const salvaged_row *row)
{
    recovery *self = data;
    mrt_result result = salvage_chunk(self, row);
    return result == MRT_OK ? salvage_blob(self, row) : result;
}

/* Inserts placeholders for missing rows that other rows refer to. Edits after a missing one move to
 * another branch. */
static mrt_result mend(sqlite *db, error *err)
{
    char sql[3000];
    (void)snprintf(
        sql, sizeof sql,
        "INSERT OR IGNORE INTO track(id, session, plugin, input, device)"
        "  SELECT track, 1, 1, 'lost', '' FROM chunk"
        "  UNION SELECT track, 1, 1, 'lost', '' FROM performance_track;"
        "INSERT OR IGNORE INTO session SELECT session, 0, 0, NULL, 'lost', '', 0 FROM track"
        "  UNION SELECT session, 0, 0, NULL, 'lost', '', 0 FROM performance;"
        "INSERT OR IGNORE INTO plugin SELECT plugin, 'lost ' || plugin FROM track"
        "  UNION SELECT plugin, 'lost ' || plugin FROM performance;"
        "INSERT OR IGNORE INTO rig SELECT rig, 'lost', '', '', rig, NULL FROM performance;"
        "UPDATE track SET left_calibration = NULL WHERE left_calibration NOT IN"
        "  (SELECT hash FROM calibration);"
        "UPDATE track SET right_calibration = NULL WHERE right_calibration NOT IN"
        "  (SELECT hash FROM calibration);"
        "UPDATE edit SET branch = %d WHERE branch = 0 AND (take, n) IN (SELECT take, n FROM"
        "  (SELECT take, n, ROW_NUMBER() OVER (PARTITION BY take ORDER BY n) AS row FROM edit"
        "   WHERE branch = 0 AND n > 0) WHERE n <> row);"
        "UPDATE take SET edit_head = MAX(0, MIN(edit_head, (SELECT COALESCE(MAX(n), 0) FROM edit"
        "  WHERE edit.take = take.id AND branch = 0)));"
        "INSERT OR IGNORE INTO take(id, created_ns, start_ns, end_ns, is_recovered, scene, shot,"
        "  number, origin, edit_head) SELECT take, MIN(from_ns), MIN(from_ns),"
        "  MAX(COALESCE(to_ns, from_ns)), 1, '', '', take, 'lost', (SELECT COALESCE(MAX(n), 0)"
        "    FROM edit WHERE edit.take = span.take AND branch = 0)"
        "  FROM span WHERE is_shown GROUP BY take;"
        "DELETE FROM performance_track WHERE performance NOT IN (SELECT id FROM performance);"
        "DELETE FROM performance_param WHERE performance NOT IN (SELECT id FROM performance);"
        "DELETE FROM again WHERE performance NOT IN (SELECT id FROM performance);"
        "DELETE FROM patch WHERE performance NOT IN (SELECT id FROM performance);"
        "DELETE FROM span WHERE take NOT IN (SELECT id FROM take)"
        "  OR performance NOT IN (SELECT id FROM performance);"
        "DELETE FROM edit WHERE take NOT IN (SELECT id FROM take);"
        "DELETE FROM checkpoint WHERE performance NOT IN (SELECT id FROM performance);"
        "DELETE FROM channel WHERE track NOT IN (SELECT id FROM track)",
        EDITS_LOST_BRANCH);
    return sqlite_run(db, sql, err);
}

static mrt_result copy_all(recovery *self, const char *path, error *err)
{
    /* Parent rows may be missing until mend() inserts them. */
    mrt_result result = sqlite_run(self->to, "PRAGMA foreign_keys = OFF", err);
    if (result >= 0)
        result = sqlite_begin(self->to, err);
    if (result < 0)
        return result;
    for (int i = 0; i < SHOW_TABLES && result >= 0; ++i)
        result = copy_table(self, &show_tables[i], err);
    if (result >= 0 && self->has_lost)
        result = salvage_file(path, salvage_row, self, &self->left, err);
    if (result == MRT_END) {
        self->out->is_cut = true;
        result = MRT_OK;
    }
    if (result >= 0)
        result = mend(self->to, err);
    return sqlite_end(self->to, result, err);
}

/* ---- a damaged schema table ---- */

static mrt_result copy_file(const char *path, FILE *out, error *err)
{
    char piece[65536];
    uint64_t begin, end = 0;
    const int in = os_open(path, OS_READ);
    if (in < 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot be read", path);
    bool good = true;
    while (good && file_next_data(in, end, &begin, &end)) {
        good = fseek(out, (long)begin, SEEK_SET) == 0;
        while (good && begin < end) {
            const uint64_t left = end - begin;
            const ssize_t got =
                os_read_at(in, piece, left < sizeof piece ? left : sizeof piece, (int64_t)begin);
            good = got > 0 && fwrite(piece, 1, (size_t)got, out) == (size_t)got &&
                   !cancel_is_requested();
            begin += good ? (uint64_t)got : 0;
        }
    }
    close(in);
    return good ? MRT_OK : error_set(err, MRT_ERR_IO, "%s: cannot be copied", path);
}

static void put_big_endian(uint8_t *at, uint64_t value)
{
    for (int i = 0; i < 4; ++i)
        at[i] = (uint8_t)(value >> (24 - 8 * i));
}

/* Builds a copy of the file with the schema table of a new show. All shows are created by the same
 * steps, so their schema table is in the same pages: page 1, and the pages that are not the root of
 * a table. Page 2 maps pages to their parents, and reading does not need it. */
static mrt_result lend_contents(FILE *out, const file_bytes *fresh, sqlite *fresh_db, error *err)
{
    size_t page_bytes = (size_t)fresh->data[16] << 8 | fresh->data[17];
    sqlite_statement *is_root;
    mrt_result result = sqlite_prepare(fresh_db, &is_root,
                                       "SELECT 1 FROM sqlite_schema WHERE rootpage = ?", "i", err);
    if (result < 0)
        return result;
    bool good = fseek(out, 0, SEEK_END) == 0;
    long size = ftell(out);
    put_big_endian(fresh->data + 28, good && size > 0 ? (size_t)size / page_bytes : 0);
    put_big_endian(fresh->data + 32, 0); /* no free pages */
    put_big_endian(fresh->data + 36, 0);
    memcpy(fresh->data + 92, fresh->data + 24, 4); /* the size is valid for this version */
    for (size_t page = 1; good && page <= fresh->size / page_bytes; ++page) {
        sqlite_bind(is_root, "i", (int64_t)page);
        if (page == 2 || sqlite_step(is_root, NULL) == MRT_OK)
            continue;
        good = fseek(out, (long)((page - 1) * page_bytes), SEEK_SET) == 0 &&
               fwrite(fresh->data + (page - 1) * page_bytes, 1, page_bytes, out) == page_bytes;
    }
    sqlite_finish(is_root);
    return good ? MRT_OK : error_set(err, MRT_ERR_IO, "a copy cannot be written");
}

/* Opens a copy of the damaged file, at copy_path, with the schema table of a new show. */
static mrt_result open_with_lent_contents(sqlite **out, const char *path, char *copy_path,
                                          show *fresh, error *err)
{
    file_bytes contents = {0};
    int fd = mkstemp(copy_path); /* the name is new, so no other file can be there */
    FILE *copy = fd < 0 ? NULL : fdopen(fd, "wb+");
    if (!copy) {
        if (fd >= 0)
            close(fd);
        return error_set(err, MRT_ERR_IO, "%s: cannot be written", copy_path);
    }
    mrt_result result = copy_file(path, copy, err);
    if (result >= 0) /* moves its log into the file */
        result = sqlite_checkpoint(fresh->db, err);
    if (result >= 0)
        result = file_read(&contents, fresh->path, 1 << 24, err);
    if (result >= 0 && contents.size < 1024)
        result = error_set(err, MRT_ERR_FORMAT, "%s: is too short", fresh->path);
    if (result >= 0)
        result = lend_contents(copy, &contents, fresh->db, err);
    file_bytes_finish(&contents);
    if (fclose(copy) != 0 && result >= 0)
        result = error_set(err, MRT_ERR_IO, "%s: cannot be written", copy_path);
    return result < 0 ? result : sqlite_open(out, copy_path, SQLITE_MODE_READ_FROZEN, err);
}

/* ---- the complete recovery ---- */

static bool has_contents(sqlite *db)
{
    int64_t application, count;
    return sqlite_number(db, "PRAGMA application_id", 0, &application, NULL) >= 0 &&
           application == SQLITE_APPLICATION &&
           sqlite_number(db,
                         "SELECT COUNT(*) FROM sqlite_schema WHERE name IN ('chunk', 'track',"
                         "'take', 'performance', 'span', 'edit', 'meta')",
                         0, &count, NULL) >= 0 &&
           count == 7 && sqlite_number(db, "SELECT id FROM chunk LIMIT 1", 0, &count, NULL) >= 0;
}

/* Returns true if the schema is valid for any version, also for another one than the file states. A
 * generated column would be computed for each row, so it is refused. */
static bool is_known_schema(sqlite *db)
{
    int64_t version, oldest_reader;
    if (sqlite_number(db, "PRAGMA user_version", 0, &version, NULL) >= 0 &&
        version > SHOW_VERSION && show_schema_check(db, version, &oldest_reader, NULL) >= 0)
        return true;
    for (version = SHOW_VERSION; version > 0; --version)
        if (show_schema_check(db, version, &oldest_reader, NULL) >= 0)
            return true;
    return false;
}

static mrt_result open_damaged(sqlite **out, const char *path, char *copy_path, show *fresh,
                               error *err)
{
    static const sqlite_mode modes[] = {SQLITE_MODE_READ, SQLITE_MODE_READ_FROZEN};
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; ++i) {
        if (sqlite_open(out, path, modes[i], NULL) >= 0 && has_contents(*out) &&
            is_known_schema(*out))
            return MRT_OK;
        sqlite_close(*out);
        *out = NULL;
    }
    return open_with_lent_contents(out, path, copy_path, fresh, err);
}

static mrt_result recover_into(show *fresh, const char *path, char *copy_path, uint64_t file_size,
                               show_recovery *out, error *err)
{
    recovery self = {
        .to = fresh->db, .left = budget_of(BUDGET_SALVAGE, file_size), .out = out, .err = err};
    sqlite_expect(fresh->db, file_size);
    self.sample = malloc(CHUNK_SAMPLES_MAX * sizeof *self.sample);
    if (!self.sample)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to recover it", path);
    mrt_result result = open_damaged(&self.from, path, copy_path, fresh, err);
    if (result >= 0)
        result = copy_all(&self, path, err);
    if (result >= 0 && out->row_count == 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: no part of a show can be read", path);
    sqlite_close(self.from);
    free(self.sample);
    return result;
}

mrt_result show_recover(show_recovery *out, const char *path, const char *out_path, error *err)
{
    *out = (show_recovery){0};
    struct stat status;
    if (stat(path, &status) != 0)
        return error_set(err, MRT_ERR_IO, "%s: cannot be opened: %s", path, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return error_set(err, MRT_ERR_IO, "%s: is a folder or a device, not a damaged show", path);
    char *copy_path = show_beside(out_path, ".damaged-XXXXXX");
    if (!copy_path)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to recover it", path);
    show *fresh;
    mrt_result result = show_create(&fresh, out_path, err);
    if (result >= 0) {
        result = recover_into(fresh, path, copy_path, file_data_size(path), out, err);
        show_close(fresh);
        if (result < 0)
            (void)unlink(out_path);
        if (!strstr(copy_path, "XXXXXX"))
            (void)unlink(copy_path);
    }
    free(copy_path);
    return result;
}
