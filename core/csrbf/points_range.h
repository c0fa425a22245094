/* csrbf/points_range.h - the bounds of a block of vertices. Each file that includes it gets it
 * for its own instruction set. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_POINTS_RANGE_H
#define MAROTTE_CSRBF_POINTS_RANGE_H
#include "csrbf/points.h"

static inline float range_lesser(float a, float b)
{
    return a < b ? a : b;
}

static inline float range_greater(float a, float b)
{
    return a > b ? a : b;
}

/* By halves, so that the loops run on whole vectors; minimum and maximum depend on no order. Not
 * inline: within a loop over blocks gcc 12 takes it to pieces, which takes five times as long. */
__attribute__((noinline)) static void range_of(float *out_low, float *out_high, const float *value)
{
    enum { HALF = POINTS_BLOCK / 2, QUARTER = HALF / 2, EIGHTH = HALF / 4, LANES = HALF / 8 };
    float low[HALF], high[HALF];
    for (int i = 0; i < HALF; ++i) {
        low[i] = range_lesser(value[i], value[i + HALF]);
        high[i] = range_greater(value[i], value[i + HALF]);
    }
    for (int i = 0; i < QUARTER; ++i) {
        low[i] = range_lesser(low[i], low[i + QUARTER]);
        high[i] = range_greater(high[i], high[i + QUARTER]);
    }
    for (int i = 0; i < EIGHTH; ++i) {
        low[i] = range_lesser(low[i], low[i + EIGHTH]);
        high[i] = range_greater(high[i], high[i + EIGHTH]);
    }
    for (int i = 0; i < LANES; ++i) {
        low[i] = range_lesser(low[i], low[i + LANES]);
        high[i] = range_greater(high[i], high[i + LANES]);
    }
    *out_low = range_lesser(range_lesser(low[0], low[1]), range_lesser(low[2], low[3]));
    *out_high = range_greater(range_greater(high[0], high[1]), range_greater(high[2], high[3]));
}

static inline void points_range_of_block(points *p, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    points_bounds *bounds = &p->block[block];
    range_of(&bounds->low[0], &bounds->high[0], p->x + first);
    range_of(&bounds->low[1], &bounds->high[1], p->y + first);
    range_of(&bounds->low[2], &bounds->high[2], p->z + first);
}

#endif
