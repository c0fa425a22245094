/* csrbf/block_range.h - minimum and maximum of the numbers of a block of 64 vertices. Each file
 * that includes it compiles it for its own instruction set. Internal to csrbf. Pure. [any] */
#ifndef MAROTTE_CSRBF_BLOCK_RANGE_H
#define MAROTTE_CSRBF_BLOCK_RANGE_H

enum { BLOCK_RANGE = 64 }; /* POINTS_BLOCK */

static inline float range_lesser(float a, float b)
{
    return a < b ? a : b;
}

static inline float range_greater(float a, float b)
{
    return a > b ? a : b;
}

/* Works by halves, so that the loops run on whole vectors; minimum and maximum do not depend on the
 * order. Not inline: inside a loop over blocks gcc 12 splits it up, and it takes five times as
 * long. */
__attribute__((noinline)) static void range_of(float *out_low, float *out_high, const float *value)
{
    enum { HALF = BLOCK_RANGE / 2, QUARTER = HALF / 2, EIGHTH = HALF / 4, LANES = HALF / 8 };
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

static inline void block_range(float out_low[3], float out_high[3], const float *x, const float *y,
                               const float *z)
{
    range_of(&out_low[0], &out_high[0], x);
    range_of(&out_low[1], &out_high[1], y);
    range_of(&out_low[2], &out_high[2], z);
}

#endif
