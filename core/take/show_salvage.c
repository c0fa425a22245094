/* The format of pages, cells and records: sqlite.org/fileformat2.html, sections 1.6, 2.1. */
#include "take/show_salvage.h"

#include "base/cancel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    PAGE_BYTES = 4096, /* of every show */
    LEAF_OF_TABLE = 13,
    LEAF_HEAD = 8,
    PAYLOAD_MAX = 64 * 1024 * 1024,
    STEPS_A_PAGE = 200, /* of work, as base/budget.h counts it: reading one */
    STEPS_A_CELL = 50
};

typedef struct pages {
    FILE *file;
    uint32_t count;
    uint8_t *payload; /* PAYLOAD_MAX at most; grown as needed */
    size_t payload_capacity;
    uint32_t *seen; /* by page: the last chain that it was a part of; count + 1 */
    uint32_t chain_count;
    budget *left;
} pages;

static bool read_page(const pages *in, uint32_t number, uint8_t out[PAGE_BYTES])
{
    return number >= 1 && number <= in->count &&
           fseek(in->file, (long)(number - 1) * PAGE_BYTES, SEEK_SET) == 0 &&
           fread(out, 1, PAGE_BYTES, in->file) == PAGE_BYTES;
}

/* Big-endian, 7 bits a byte, a ninth byte whole; false: it does not end before `end`. */
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

/* Bytes of a payload that lie in the cell; the rest is in a chain of pages. */
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
        if (next > in->count || in->seen[next] == in->chain_count || !read_page(in, next, page) ||
            budget_spend_work(in->left, STEPS_A_PAGE, NULL) < 0)
            return false; /* it ends, leads in a circle, or costs too much */
        in->seen[next] = in->chain_count;
        size_t part = size - got < PAGE_BYTES - 4 ? size - got : PAGE_BYTES - 4;
        memcpy(in->payload + got, page + 4, part);
        next = big_endian(page, 4);
        got += part;
    }
    return true;
}

/* Sizes of whole numbers by their serial type 0..9. */
static bool get_value(show_salvage_value *out, uint64_t type, const uint8_t **at,
                      const uint8_t *end)
{
    static const uint8_t number_bytes[10] = {0, 1, 2, 3, 4, 6, 8, 8, 0, 0};
    *out = (show_salvage_value){.number = type == 9};
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

static bool get_row(show_salvage_row *out, const uint8_t *payload, size_t size)
{
    const uint8_t *head = payload, *end = payload + size;
    uint64_t head_size, type;
    if (!get_varint(&head, end, &head_size) || head_size > size)
        return false;
    const uint8_t *body = payload + head_size, *head_end = body;
    out->column_count = 0;
    while (head < head_end) {
        if (out->column_count == SHOW_SALVAGE_COLUMNS_MAX || !get_varint(&head, head_end, &type) ||
            !get_value(&out->column[out->column_count], type, &body, end))
            return false;
        ++out->column_count;
    }
    return true;
}

/* MRT_END: nothing more may be spent. */
static mrt_result salvage_page(pages *in, const uint8_t page[PAGE_BYTES],
                               mrt_result (*each)(void *data, const show_salvage_row *row),
                               void *data)
{
    mrt_result result = MRT_OK;
    uint32_t cell_count = big_endian(page + 3, 2);
    if (page[0] != LEAF_OF_TABLE || LEAF_HEAD + 2 * cell_count > PAGE_BYTES)
        return MRT_OK;
    for (uint32_t i = 0; i < cell_count && result >= 0; ++i) {
        if (cancel_is_asked() || budget_spend_work(in->left, STEPS_A_CELL, NULL) < 0)
            return MRT_END;
        show_salvage_row row;
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

mrt_result show_salvage(const char *path,
                        mrt_result (*each)(void *data, const show_salvage_row *row), void *data,
                        budget *left, error *err)
{
    pages in = {.file = fopen(path, "rb"), .left = left};
    if (!in.file)
        return error_set(err, MRT_ERR_IO, "%s: cannot be read", path);
    long size = fseek(in.file, 0, SEEK_END) == 0 ? ftell(in.file) : 0;
    in.count = size > 0 ? (uint32_t)(size / PAGE_BYTES) : 0;
    in.seen = calloc((size_t)in.count + 1, sizeof *in.seen);
    mrt_result result =
        in.seen ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "%s: no memory to recover it", path);
    for (uint32_t number = 2; number <= in.count && result == MRT_OK; ++number) {
        uint8_t page[PAGE_BYTES];
        if (read_page(&in, number, page))
            result = salvage_page(&in, page, each, data);
    }
    (void)fclose(in.file);
    free(in.seen);
    free(in.payload);
    return result;
}
