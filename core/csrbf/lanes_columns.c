/* Anchored frames of columns, and what else is done to blocks of them. */
#include "csrbf/lanes_variant.h"

typedef float column_value;
#include "csrbf/lanes_move.h"

static source source_of(const columns *c)
{
    return (source){.value = c->value, .stride = c->stride, .weights = &c->weights, .marked = c};
}

void LANES(columns_sum)(const columns *c, float sum[3][POINTS_BLOCK], uint32_t block)
{
    const source s = source_of(c);
    sum_block(&s, sum, block);
}

void LANES(columns_add)(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block)
{
    add_block(out, base, sum, block);
}

uint32_t LANES(columns_move)(const columns *c, points *out, const points *base, uint8_t *moved,
                             uint32_t first, uint32_t end)
{
    const source s = source_of(c);
    return move_blocks(&s, out, base, moved, first, end);
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
