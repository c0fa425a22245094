#include "csrbf/columns.h"

#include "csrbf/lanes.h"

#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, STAGGER = 16 }; /* floats between two rows: no power of two */

mrt_result columns_create(columns *out, const points *like, uint32_t capacity, error *err)
{
    *out = (columns){.capacity = capacity, .block_count = like->block_count, .lanes = lanes_now()};
    size_t rows = capacity;
    out->stride = (size_t)like->padded_count + STAGGER;
    if (capacity <= COLUMNS_CAPACITY && rows < SIZE_MAX / sizeof(float) / out->stride - 1) {
        size_t marks = rows * out->block_count + 1;
        out->value = aligned_alloc(ALIGNMENT, (rows + 1) * out->stride * sizeof *out->value);
        out->active = malloc(marks * sizeof *out->active);
        out->active_count = calloc((size_t)out->block_count + 1, sizeof *out->active_count);
        out->weight = calloc(3 * rows + 1, sizeof *out->weight);
    }
    if (out->value && out->active && out->active_count && out->weight)
        return MRT_OK;
    columns_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for %u columns of %u vertices", capacity,
                     like->count);
}

void columns_destroy(columns *c)
{
    if (!c)
        return;
    free(c->value);
    free(c->active);
    free(c->active_count);
    free(c->weight);
    *c = (columns){0};
}

float *columns_row(const columns *c, uint32_t column)
{
    return c->value + column * c->stride;
}

void columns_note(columns *c, uint32_t count)
{
    columns_note_groups(c, count, 1);
}

void columns_note_groups(columns *c, uint32_t count, uint32_t group)
{
    c->count = count;
    memset(c->active_count, 0, c->block_count * sizeof *c->active_count);
    for (uint32_t column = 0; column < count; ++column) {
        const float *last = columns_row(c, column - column % group + group - 1);
        for (uint32_t block = 0; block < c->block_count; ++block)
            if (!c->lanes->is_zero(last + (size_t)block * POINTS_BLOCK)) {
                size_t slot = (size_t)block * c->capacity + c->active_count[block]++;
                c->active[slot] = (uint16_t)column;
            }
    }
}

void columns_sum(const columns *c, float sum[3][POINTS_BLOCK], const float *weight, uint32_t block,
                 uint32_t first, uint32_t end)
{
    c->lanes->columns_sum(c, sum, weight, block, first, end);
}

void columns_add(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block)
{
    lanes_of(ISA_GENERIC)->columns_add(out, base, sum, block);
}

void columns_move(columns *c, points *out, const points *base, const double *weight)
{
    for (size_t i = 0; i < (size_t)3 * c->count; ++i)
        c->weight[i] = (float)weight[i];
    c->lanes->columns_move(c, out, base, 0, c->block_count);
}
