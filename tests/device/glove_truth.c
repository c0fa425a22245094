#include "glove_truth.h"

#include "base/file.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_MAX = 64 << 20 };

static int nibble(char c)
{
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

static bool read_bytes(text_view text, glove_truth_row *out)
{
    for (const char *at = text.at; at + 1 < text.end && out->size < GLOVE_RECORD_MAX; at += 2) {
        int high = nibble(at[0]), low = nibble(at[1]);
        if (high < 0 || low < 0)
            return false;
        out->record[out->size++] = (uint8_t)(high << 4 | low);
    }
    return out->size > 0;
}

static bool read_row(text_view line, glove_truth_row *out)
{
    text_view field[5];
    int64_t number;
    *out = (glove_truth_row){0};
    for (int i = 0; i < 5; ++i)
        if (!text_next_field(&line, ',', &field[i]))
            return false;
    if (!text_int(field[0], &number) || !text_int(field[1], &out->sample_ns) ||
        !text_int(field[2], &out->written_ns))
        return false;
    out->number = (uint32_t)number;
    out->is_spoiled = !text_equals(field[3], "sent");
    return read_bytes(field[4], out);
}

mrt_result glove_truth_read(glove_truth *out, const char *path, error *err)
{
    file_bytes file;
    *out = (glove_truth){0};
    mrt_result result = file_read(&file, path, FILE_MAX, err);
    if (result < 0)
        return result;
    text_view rest = text_view_of(file.data, file.size), line;
    size_t line_count = 0;
    for (size_t i = 0; i < file.size; ++i)
        line_count += file.data[i] == '\n';
    out->row = calloc(line_count + 1, sizeof *out->row);
    if (!out->row)
        result = error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    (void)text_next_line(&rest, &line); /* its head */
    while (result >= 0 && text_next_line(&rest, &line))
        if (out->count == line_count || !read_row(line, &out->row[out->count++]))
            result = error_set(err, MRT_ERR_FORMAT, "%s: line %zu is no row", path, out->count + 1);
    file_bytes_finish(&file);
    if (result < 0)
        glove_truth_finish(out);
    return result;
}

void glove_truth_finish(glove_truth *truth)
{
    free(truth->row);
    *truth = (glove_truth){0};
}

const glove_truth_row *glove_truth_find(const glove_truth *truth, uint32_t number)
{
    size_t low = 0, high = truth->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (truth->row[middle].number < number)
            low = middle + 1;
        else
            high = middle;
    }
    return low < truth->count && truth->row[low].number == number ? &truth->row[low] : NULL;
}

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

glove_spread glove_spread_of(double *value, size_t count)
{
    if (count == 0)
        return (glove_spread){0};
    qsort(value, count, sizeof *value, by_size);
    double sum = 0, squares = 0;
    for (size_t i = 0; i < count; ++i)
        sum += value[i];
    double mean = sum / (double)count;
    for (size_t i = 0; i < count; ++i)
        squares += (value[i] - mean) * (value[i] - mean);
    return (glove_spread){mean,
                          sqrt(squares / (double)count),
                          value[count / 2],
                          value[(count - 1) * 99 / 100],
                          value[0],
                          value[count - 1]};
}
