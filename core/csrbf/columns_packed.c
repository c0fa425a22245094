#include "csrbf/columns_packed.h"

#include "base/large.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STAGGER = 32 }; /* numbers between two rows: no power of two */
static const float steps = 32767.0f;

mrt_result columns_packed_create(columns_packed *out, const columns *like, error *err)
{
    size_t rows = like->capacity;
    *out = (columns_packed){.stride = (size_t)like->block_count * POINTS_BLOCK + STAGGER};
    if (rows < SIZE_MAX / out->stride / sizeof *out->value - 1) {
        out->value = large_alloc((rows + 1) * out->stride * sizeof *out->value);
        out->scale = calloc(rows + 1, sizeof *out->scale);
    }
    if (out->value && out->scale && columns_weights_create(&out->weights, like->capacity))
        return MRT_OK;
    columns_packed_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory to pack %u columns", like->capacity);
}

void columns_packed_destroy(columns_packed *p)
{
    if (!p)
        return;
    free(p->value);
    free(p->scale);
    columns_weights_destroy(&p->weights);
    *p = (columns_packed){0};
}

static float largest_size(const columns *c, uint32_t column)
{
    const float *row = columns_row(c, column);
    float largest = 0.0f;
    for (size_t i = 0; i < (size_t)c->block_count * POINTS_BLOCK; ++i)
        largest = fabsf(row[i]) > largest ? fabsf(row[i]) : largest;
    return largest;
}

/* Nearest whole number of steps; halves go away from zero. */
static void pack_row(int16_t *restrict out, const float *restrict row, size_t count,
                     float steps_per_unit)
{
    for (size_t i = 0; i < count; ++i) {
        float value = row[i] * steps_per_unit;
        float rounded = value < 0.0f ? value - 0.5f : value + 0.5f;
        rounded = rounded > steps ? steps : rounded;
        out[i] = (int16_t)(rounded < -steps ? -steps : rounded);
    }
}

void columns_packed_take(columns_packed *p, const columns *c)
{
    for (uint32_t column = 0; column < c->count; ++column) {
        float scale = largest_size(c, column) / steps;
        p->scale[column] = scale;
        pack_row(p->value + column * p->stride, columns_row(c, column),
                 (size_t)c->block_count * POINTS_BLOCK, scale > 0.0f ? 1.0f / scale : 0.0f);
    }
}

void columns_packed_weigh(columns_packed *p, const columns *c, const double *weight)
{
    for (size_t i = 0; i < (size_t)3 * c->count; ++i)
        p->weights.value[i] = (float)(weight[i] * (double)p->scale[i / 3]);
    columns_weights_note(&p->weights, c, c->count, sizeof *p->value);
}

void columns_packed_move(columns_packed *p, const columns *c, points *out, const points *base,
                         const double *weight)
{
    columns_packed_weigh(p, c, weight);
    c->lanes->packed_move(p, c, out, base, 0, c->block_count);
}
