#include "io/write/frame_block.h"

#include "base/isa.h"

#include <string.h>

#ifdef MAROTTE_LANES_X86
#define EACH(loop)                                                                                 \
    {                                                                                              \
        FRAME_BLOCK_LOOP(loop, generic), FRAME_BLOCK_LOOP(loop, v2), FRAME_BLOCK_LOOP(loop, v3),   \
            FRAME_BLOCK_LOOP(loop, v4)                                                             \
    }
#else
#define EACH(loop)                                                                                 \
    {                                                                                              \
        FRAME_BLOCK_LOOP(loop, generic)                                                            \
    }
#endif

void frame_block_set(float *block, uint32_t lane, const float *frame, size_t length)
{
    for (size_t d = 0; d < length; ++d)
        block[d * FRAME_BLOCK + lane] = frame[d];
}

void frame_block_get(float *out, const float *block, uint32_t lane, size_t length)
{
    for (size_t d = 0; d < length; ++d)
        out[d] = block[d * FRAME_BLOCK + lane];
}

void frame_block_dot(double *out_dot, const float *row, size_t row_count, const float *block,
                     size_t length)
{
    static frame_block_dot_loop *const loop[ISA_COUNT] = EACH(dot);
    loop[isa_now()](out_dot, row, row_count, block, length);
}

void frame_block_subtract(float *block, const float *row, size_t row_count, const float *weight,
                          size_t length)
{
    static frame_block_subtract_loop *const loop[ISA_COUNT] = EACH(subtract);
    loop[isa_now()](block, row, row_count, weight, length);
}

void frame_block_peak(float out_peak[FRAME_BLOCK], const float *block, size_t length)
{
    float peak[FRAME_BLOCK] = {0};
    for (size_t d = 0; d + 3 <= length; d += 3) {
        const float *x = block + d * FRAME_BLOCK, *y = x + FRAME_BLOCK, *z = y + FRAME_BLOCK;
        for (int lane = 0; lane < FRAME_BLOCK; ++lane) {
            float square = x[lane] * x[lane] + y[lane] * y[lane] + z[lane] * z[lane];
            peak[lane] = square > peak[lane] ? square : peak[lane];
        }
    }
    memcpy(out_peak, peak, sizeof peak);
}
