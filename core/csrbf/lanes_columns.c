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

/* ---- which columns count in a block ---- */

typedef struct chosen {
    uint16_t column[2 * COLUMNS_WORD];
    uint32_t count;
} chosen;

static void choose_word(chosen *to, uint64_t bits, uint32_t word)
{
    for (; bits != 0; bits &= bits - 1)
        to->column[to->count++] = (uint16_t)(word * COLUMNS_WORD + (uint32_t)__builtin_ctzll(bits));
}

/* Goes on until there may be no more room. False: all words of the weights have been asked. */
static bool choose_more(chosen *to, uint32_t *next_word, const columns_weights *w,
                        const uint64_t *mark)
{
    to->count = 0;
    while (*next_word < w->word_count && to->count <= COLUMNS_WORD) {
        uint32_t word = w->word[(*next_word)++];
        choose_word(to, mark[word] & w->live[word], word);
    }
    return to->count > 0;
}

static bool is_reached(const columns *c, const columns_weights *w, uint32_t block)
{
    const uint64_t *mark = c->mark + (size_t)block * c->mark_words;
    for (uint32_t i = 0; i < w->word_count; ++i)
        if ((mark[w->word[i]] & w->live[w->word[i]]) != 0)
            return true;
    return false;
}

void LANES(columns_sum)(const columns *c, float sum[3][POINTS_BLOCK], uint32_t block)
{
    const float *value = c->value + (size_t)block * POINTS_BLOCK;
    const uint64_t *mark = c->mark + (size_t)block * c->mark_words;
    uint32_t next_word = 0;
    chosen some;
    memset(sum, 0, 3 * sizeof *sum);
    while (choose_more(&some, &next_word, &c->weights, mark))
        add_columns(sum, value, c->stride, c->weights.value, some.column, some.count);
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

static void restore_block(points *out, const points *base, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK, size = POINTS_BLOCK * sizeof(float);
    memcpy(out->x + first, base->x + first, size);
    memcpy(out->y + first, base->y + first, size);
    memcpy(out->z + first, base->z + first, size);
    out->block[block] = base->block[block];
}

uint32_t LANES(columns_move)(const columns *c, points *out, const points *base, uint8_t *moved,
                             uint32_t first, uint32_t end)
{
    uint32_t written = 0;
    for (uint32_t block = first; block < end; ++block) {
        columns_block now = COLUMNS_STILL;
        if (is_reached(c, &c->weights, block)) {
            _Alignas(64) float sum[3][POINTS_BLOCK];
            LANES(columns_sum)(c, sum, block);
            LANES(columns_add)(out, base, sum, block);
            now = COLUMNS_MOVED;
        } else if (!moved || moved[block] == COLUMNS_MOVED) {
            restore_block(out, base, block);
            now = COLUMNS_RESTORED;
        }
        if (moved)
            moved[block] = (uint8_t)now;
        written += now != COLUMNS_STILL;
    }
    return written;
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

static void add_packed(float sum[3][POINTS_BLOCK], const columns_packed *p, uint32_t block,
                       const chosen *some)
{
    const int16_t *value = p->value + (size_t)block * POINTS_BLOCK;
    const uint16_t *column = some->column;
    uint32_t left = some->count;
    for (; left >= 8; left -= 8, column += 8)
        add_packed_8(sum, value, p->stride, p->weights.value, column);
    for (; left >= 2; left -= 2, column += 2)
        add_packed_2(sum, value, p->stride, p->weights.value, column);
    if (left > 0)
        add_packed_1(sum, value, p->stride, p->weights.value, column);
}

void LANES(packed_sum)(const columns_packed *p, const columns *c, float sum[3][POINTS_BLOCK],
                       uint32_t block)
{
    const uint64_t *mark = c->mark + (size_t)block * c->mark_words;
    uint32_t next_word = 0;
    chosen some;
    memset(sum, 0, 3 * sizeof *sum);
    while (choose_more(&some, &next_word, &p->weights, mark))
        add_packed(sum, p, block, &some);
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
