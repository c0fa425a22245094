/* Anchored frames: out = base + sum of columns by weights. */
#include "csrbf/lanes_variant.h"

#include "csrbf/points_range.h"

#include <string.h>

/* sum += COUNT columns by their weights, in their order. column: which; value: the first column's
 * row, at the block. */
#define ADD_COLUMNS(COUNT)                                                                         \
    static void add_##COUNT(float sum[3][POINTS_BLOCK], const float *value, size_t stride,         \
                            const float *weight, const uint16_t *column)                           \
    {                                                                                              \
        float *restrict x = sum[0], *restrict y = sum[1], *restrict z = sum[2];                    \
        const float *row[COUNT];                                                                   \
        float gx[COUNT], gy[COUNT], gz[COUNT];                                                     \
        for (size_t k = 0; k < COUNT; ++k) {                                                       \
            const float *g = weight + (size_t)3 * column[k];                                       \
            row[k] = value + column[k] * stride;                                                   \
            gx[k] = g[0];                                                                          \
            gy[k] = g[1];                                                                          \
            gz[k] = g[2];                                                                          \
        }                                                                                          \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float sx = x[i], sy = y[i], sz = z[i];                                                 \
            for (size_t k = 0; k < COUNT; ++k) {                                                   \
                sx += row[k][i] * gx[k];                                                           \
                sy += row[k][i] * gy[k];                                                           \
                sz += row[k][i] * gz[k];                                                           \
            }                                                                                      \
            x[i] = sx;                                                                             \
            y[i] = sy;                                                                             \
            z[i] = sz;                                                                             \
        }                                                                                          \
    }
ADD_COLUMNS(1)
ADD_COLUMNS(2)
ADD_COLUMNS(4)
ADD_COLUMNS(8)

static void add_columns(float sum[3][POINTS_BLOCK], const float *value, size_t stride,
                        const float *weight, const uint16_t *column, uint32_t count)
{
    for (; count >= 8; count -= 8, column += 8)
        add_8(sum, value, stride, weight, column);
    if (count & 4u) {
        add_4(sum, value, stride, weight, column);
        column += 4;
    }
    if (count & 2u) {
        add_2(sum, value, stride, weight, column);
        column += 2;
    }
    if (count & 1u)
        add_1(sum, value, stride, weight, column);
}

enum { CHOSEN = 64 };

/* Of the block's columns those from first to end - 1 whose weight is not zero. */
void LANES(columns_sum)(const columns *c, float sum[3][POINTS_BLOCK], const float *weight,
                        uint32_t block, uint32_t first, uint32_t end)
{
    const uint16_t *active = c->active + (size_t)block * c->capacity;
    const float *value = c->value + (size_t)block * POINTS_BLOCK;
    uint32_t count = c->active_count[block], chosen = 0;
    uint16_t column[CHOSEN + 1];
    memset(sum, 0, 3 * sizeof *sum);
    for (uint32_t i = 0; i < count; ++i) {
        const float *g = weight + (size_t)3 * active[i];
        bool counts = (g[0] != 0.0f) | (g[1] != 0.0f) | (g[2] != 0.0f);
        column[chosen] = active[i];
        chosen += counts & (active[i] >= first) & (active[i] < end);
        if (chosen == CHOSEN) {
            add_columns(sum, value, c->stride, weight, column, chosen);
            chosen = 0;
        }
    }
    add_columns(sum, value, c->stride, weight, column, chosen);
}

static void add_row(float *out, const float *base, const float *restrict sum)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float moved = base[i] + sum[i];
        out[i] = sum[i] == 0.0f ? base[i] : moved;
    }
}

void LANES(columns_add)(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    add_row(out->x + first, base->x + first, sum[0]);
    add_row(out->y + first, base->y + first, sum[1]);
    add_row(out->z + first, base->z + first, sum[2]);
    points_range_of_block(out, block);
}

static bool some_weigh_nothing(const columns *c)
{
    bool some = false;
    for (size_t i = 0; i < c->count; ++i) {
        const float *g = c->weight + 3 * i;
        some = some | ((g[0] == 0.0f) & (g[1] == 0.0f) & (g[2] == 0.0f));
    }
    return some;
}

void LANES(columns_move)(const columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end)
{
    bool choose = some_weigh_nothing(c);
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float sum[3][POINTS_BLOCK];
        if (choose) {
            LANES(columns_sum)(c, sum, c->weight, block, 0, c->count);
        } else {
            memset(sum, 0, sizeof sum);
            add_columns(sum, c->value + (size_t)block * POINTS_BLOCK, c->stride, c->weight,
                        c->active + (size_t)block * c->capacity, c->active_count[block]);
        }
        LANES(columns_add)(out, base, sum, block);
    }
}

/* ---- packed ---- */

/* As ADD_COLUMNS. */
#define ADD_PACKED(COUNT)                                                                          \
    static void add_packed_##COUNT(float sum[3][POINTS_BLOCK], const int16_t *value,               \
                                   size_t stride, const float *weight, const uint16_t *column)     \
    {                                                                                              \
        float *restrict x = sum[0], *restrict y = sum[1], *restrict z = sum[2];                    \
        const int16_t *row[COUNT];                                                                 \
        float gx[COUNT], gy[COUNT], gz[COUNT];                                                     \
        for (size_t k = 0; k < COUNT; ++k) {                                                       \
            const float *g = weight + (size_t)3 * column[k];                                       \
            row[k] = value + column[k] * stride;                                                   \
            gx[k] = g[0];                                                                          \
            gy[k] = g[1];                                                                          \
            gz[k] = g[2];                                                                          \
        }                                                                                          \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float sx = x[i], sy = y[i], sz = z[i];                                                 \
            for (size_t k = 0; k < COUNT; ++k) {                                                   \
                float one = (float)row[k][i];                                                      \
                sx += one * gx[k];                                                                 \
                sy += one * gy[k];                                                                 \
                sz += one * gz[k];                                                                 \
            }                                                                                      \
            x[i] = sx;                                                                             \
            y[i] = sy;                                                                             \
            z[i] = sz;                                                                             \
        }                                                                                          \
    }
ADD_PACKED(1)
ADD_PACKED(2)
ADD_PACKED(8)

void LANES(packed_sum)(const columns_packed *p, const columns *c, float sum[3][POINTS_BLOCK],
                       uint32_t block)
{
    const int16_t *value = p->value + (size_t)block * POINTS_BLOCK;
    const uint16_t *column = c->active + (size_t)block * c->capacity;
    uint32_t left = c->active_count[block];
    memset(sum, 0, 3 * sizeof *sum);
    for (; left >= 8; left -= 8, column += 8)
        add_packed_8(sum, value, p->stride, p->weight, column);
    for (; left >= 2; left -= 2, column += 2)
        add_packed_2(sum, value, p->stride, p->weight, column);
    if (left > 0)
        add_packed_1(sum, value, p->stride, p->weight, column);
}

void LANES(packed_move)(const columns_packed *p, const columns *c, points *out, const points *base,
                        uint32_t first, uint32_t end)
{
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float sum[3][POINTS_BLOCK];
        LANES(packed_sum)(p, c, sum, block);
        LANES(columns_add)(out, base, sum, block);
    }
}

bool LANES(is_zero)(const float value[POINTS_BLOCK])
{
    int other = 0; /* counted, not asked one by one: so it runs on whole vectors */
    for (int i = 0; i < POINTS_BLOCK; ++i)
        other += value[i] != 0.0f;
    return other == 0;
}

void LANES(add_weighted)(float total[3][POINTS_BLOCK], const float *weight,
                         float sum[3][POINTS_BLOCK])
{
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < POINTS_BLOCK; ++i)
            total[axis][i] += weight[i] * sum[axis][i];
}
