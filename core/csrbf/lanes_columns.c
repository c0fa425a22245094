/* Anchored frames: out = base + sum of columns by weights. */
#include "csrbf/lanes_variant.h"

#include "csrbf/points_range.h"

#include <string.h>

enum { TOGETHER = 8 };

/* Columns of a block that are added together: so the sums are read and written less often. */
typedef struct bundle {
    const float *row[TOGETHER];
    float weight[TOGETHER][3];
    uint32_t count;
} bundle;

static inline float lane_sum(float sum, const bundle *b, int axis, uint32_t count, int lane)
{
    for (uint32_t k = 0; k < count; ++k)
        sum += b->row[k][lane] * b->weight[k][axis];
    return sum;
}

#define ADD_ROWS(COUNT)                                                                            \
    static void add_##COUNT(float *restrict x, float *restrict y, float *restrict z,               \
                            const bundle *from)                                                    \
    {                                                                                              \
        const bundle b = *from;                                                                    \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            x[i] = lane_sum(x[i], &b, 0, COUNT, i);                                                \
            y[i] = lane_sum(y[i], &b, 1, COUNT, i);                                                \
            z[i] = lane_sum(z[i], &b, 2, COUNT, i);                                                \
        }                                                                                          \
    }
ADD_ROWS(1)
ADD_ROWS(2)
ADD_ROWS(4)
ADD_ROWS(8)

/* Adds them in their order, and forgets them. */
static void add_bundle(float sum[3][POINTS_BLOCK], bundle *b)
{
    bundle left = *b;
    while (left.count > 0) {
        uint32_t taken = left.count >= 8 ? 8 : left.count >= 4 ? 4 : left.count >= 2 ? 2 : 1;
        if (taken == 8)
            add_8(sum[0], sum[1], sum[2], &left);
        else if (taken == 4)
            add_4(sum[0], sum[1], sum[2], &left);
        else if (taken == 2)
            add_2(sum[0], sum[1], sum[2], &left);
        else
            add_1(sum[0], sum[1], sum[2], &left);
        left.count -= taken;
        memmove(left.row, left.row + taken, left.count * sizeof left.row[0]);
        memmove(left.weight, left.weight + taken, left.count * sizeof left.weight[0]);
    }
    b->count = 0;
}

static inline void take_column(float sum[3][POINTS_BLOCK], bundle *b, const float *row,
                               const float *g)
{
    if (g[0] == 0.0f && g[1] == 0.0f && g[2] == 0.0f)
        return;
    b->row[b->count] = row;
    memcpy(b->weight[b->count], g, sizeof b->weight[0]);
    if (++b->count == TOGETHER)
        add_bundle(sum, b);
}

void LANES(columns_sum)(const columns *c, float sum[3][POINTS_BLOCK], const float *weight,
                        uint32_t block, uint32_t first, uint32_t end)
{
    const uint16_t *active = c->active + (size_t)block * c->capacity;
    const float *value = c->value + (size_t)block * POINTS_BLOCK;
    bundle b = {.count = 0};
    memset(sum, 0, 3 * sizeof *sum);
    for (uint32_t i = 0; i < c->active_count[block]; ++i) {
        uint32_t column = active[i];
        if (column >= first && column < end)
            take_column(sum, &b, value + column * c->stride, weight + (size_t)3 * column);
    }
    add_bundle(sum, &b);
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

void LANES(columns_move)(const columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end)
{
    for (uint32_t block = first; block < end; ++block) {
        float sum[3][POINTS_BLOCK];
        LANES(columns_sum)(c, sum, c->weight, block, 0, c->count);
        LANES(columns_add)(out, base, sum, block);
    }
}

void LANES(add_weighted)(float total[3][POINTS_BLOCK], const float *weight,
                         float sum[3][POINTS_BLOCK])
{
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < POINTS_BLOCK; ++i)
            total[axis][i] += weight[i] * sum[axis][i];
}
