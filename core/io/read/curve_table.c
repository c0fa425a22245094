#include "io/curves.h"

#include "base/file.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_CAP = 1 << 30, COLUMNS_MAX = 4096 };

typedef struct reading {
    text_view rest;
    const char *path;
    uint32_t line;
    char separator;
} reading;

static mrt_result no_memory(const reading *r, error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "%s: no memory for the table", r->path);
}

/* Finds the next line with content; false: no more lines. */
static bool next_line(reading *r, text_view *out)
{
    while (text_next_line(&r->rest, out)) {
        r->line += 1;
        *out = text_trim(*out);
        if (out->at < out->end && *out->at != '#')
            return true;
    }
    return false;
}

/* Reads the next cell of a line, without its quotes; false: no more cells. */
static bool next_cell(const reading *r, text_view *line, text_view *out)
{
    if (!text_next_field(line, r->separator, out))
        return false;
    if (out->end - out->at >= 2 && out->at[0] == '"' && out->end[-1] == '"')
        *out = (text_view){out->at + 1, out->end - 1};
    return true;
}

static uint32_t count_cells(const reading *r, text_view line)
{
    uint32_t count = 0;
    text_view cell;
    while (next_cell(r, &line, &cell))
        ++count;
    return count;
}

static mrt_result read_head(curve_table *out, reading *r, error *err)
{
    text_view line, cell;
    if (!next_line(r, &line))
        return error_set(err, MRT_ERR_FORMAT, "%s: no line with the names of its columns", r->path);
    r->separator = memchr(line.at, ',', (size_t)(line.end - line.at)) ? ',' : ';';
    uint32_t count = count_cells(r, line);
    if (count > COLUMNS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s:%u: %u columns; at most %d are possible",
                         r->path, r->line, count, COLUMNS_MAX);
    out->name = calloc(count, sizeof *out->name);
    out->bad_row = calloc(count, sizeof *out->bad_row);
    if (!out->name || !out->bad_row)
        return no_memory(r, err);
    while (next_cell(r, &line, &cell)) {
        size_t size = (size_t)(cell.end - cell.at) + 1;
        char *name = malloc(size);
        if (!name)
            return no_memory(r, err);
        text_copy(name, size, cell);
        if (name[0] && curve_table_find(out, name) != CURVE_TABLE_NONE) {
            mrt_result result =
                error_set(err, MRT_ERR_FORMAT, "%s:%u: two columns have the name \"%s\"", r->path,
                          r->line, name);
            free(name);
            return result;
        }
        out->name[out->column_count++] = name;
    }
    return MRT_OK;
}

static bool reserve_row(curve_table *out, uint32_t *capacity)
{
    if (out->row_count < *capacity)
        return true;
    uint32_t wanted = *capacity ? *capacity * 2 : 256;
    double *value = realloc(out->value, (size_t)wanted * out->column_count * sizeof *value);
    if (value)
        out->value = value;
    uint32_t *line = realloc(out->line, wanted * sizeof *line);
    if (line)
        out->line = line;
    if (value && line)
        *capacity = wanted;
    return value && line;
}

static mrt_result read_row(curve_table *out, const reading *r, text_view line, uint32_t *capacity,
                           error *err)
{
    uint32_t count = count_cells(r, line), timecode = curve_table_find(out, "timecode"),
             shape = curve_table_find(out, "shape");
    if (count != out->column_count)
        return error_set(err, MRT_ERR_FORMAT, "%s:%u: %u cells, the line of names has %u", r->path,
                         r->line, count, out->column_count);
    if (!reserve_row(out, capacity))
        return no_memory(r, err);
    double *row = out->value + (size_t)out->row_count * count;
    text_view cell;
    for (uint32_t i = 0; next_cell(r, &line, &cell); ++i) {
        row[i] = (double)NAN;
        if (i == timecode && out->row_count == 0)
            text_copy(out->timecode, sizeof out->timecode, cell);
        out->other_shapes += i == shape && !text_equals(cell, "anchored");
        if (cell.at == cell.end || text_double(cell, &row[i]))
            continue;
        row[i] = (double)NAN;
        if (out->bad_row[i] == 0)
            out->bad_row[i] = out->row_count + 1;
    }
    out->line[out->row_count++] = r->line;
    return MRT_OK;
}

uint32_t curve_table_find(const curve_table *t, const char *column)
{
    for (uint32_t i = 0; i < t->column_count; ++i)
        if (strcmp(t->name[i], column) == 0)
            return i;
    return CURVE_TABLE_NONE;
}

void curve_table_finish(curve_table *t)
{
    for (uint32_t i = 0; i < t->column_count; ++i)
        free(t->name[i]);
    free(t->name);
    free(t->value);
    free(t->bad_row);
    free(t->line);
    *t = (curve_table){0};
}

mrt_result curve_table_parse(curve_table *out, const void *data, size_t size, const char *path,
                             error *err)
{
    static const char mark[] =
        "\xEF\xBB\xBF"; /* byte order mark of UTF-8, which spreadsheets write */
    reading r = {.path = path};
    uint32_t capacity = 0;
    text_view line;
    *out = (curve_table){0};
    size_t marked = size >= 3 && memcmp(data, mark, 3) == 0 ? 3 : 0;
    r.rest = text_view_of((const char *)data + marked, size - marked);
    mrt_result result = read_head(out, &r, err);
    while (result >= 0 && next_line(&r, &line))
        result = read_row(out, &r, line, &capacity, err);
    if (result >= 0 && out->row_count == 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: no rows below the names of its columns", path);
    if (result < 0)
        curve_table_finish(out);
    return result;
}

mrt_result curve_table_read(curve_table *out, const char *path, error *err)
{
    file_bytes bytes;
    *out = (curve_table){0};
    mrt_result result = file_read(&bytes, path, FILE_CAP, err);
    if (result < 0)
        return result;
    result = curve_table_parse(out, bytes.data, bytes.size, path, err);
    file_bytes_finish(&bytes);
    return result;
}
