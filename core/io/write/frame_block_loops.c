/* The inner loops of frame_block.c, compiled once for each instruction set. All give the same bits.
 */
#include "base/isa.h"
#include "io/write/frame_block.h"

#include <string.h>

/* Elements of a frame in one panel. The panels of sixteen frames fit in the first-level cache. Sums
 * within a panel are float32, sums of panels float64. */
enum { PANEL = 256 };
enum { TILE_ROWS = 32, TILE_COLUMNS = 64 };

static void dot_two_rows(double *out_dot, const float *row, size_t stride, const float *block,
                         size_t length)
{
    float sum_a[FRAME_BLOCK] = {0}, sum_b[FRAME_BLOCK] = {0};
    const float *end = block + length * FRAME_BLOCK;
    for (; block < end; block += FRAME_BLOCK, ++row) {
        float at_a = row[0], at_b = row[stride];
        for (int lane = 0; lane < FRAME_BLOCK; ++lane) {
            sum_a[lane] += at_a * block[lane];
            sum_b[lane] += at_b * block[lane];
        }
    }
    for (int lane = 0; lane < FRAME_BLOCK; ++lane) {
        out_dot[lane] += (double)sum_a[lane];
        out_dot[FRAME_BLOCK + lane] += (double)sum_b[lane];
    }
}

static void dot_row(double *out_dot, const float *a, const float *block, size_t length)
{
    float sum[FRAME_BLOCK] = {0};
    for (size_t d = 0; d < length; ++d) {
        const float *frame = block + d * FRAME_BLOCK;
        float at = a[d];
        for (int lane = 0; lane < FRAME_BLOCK; ++lane)
            sum[lane] += at * frame[lane];
    }
    for (int lane = 0; lane < FRAME_BLOCK; ++lane)
        out_dot[lane] += (double)sum[lane];
}

void FRAME_BLOCK_LOOP(dot, MAROTTE_VARIANT)(double *out_dot, const float *row, size_t row_count,
                                            const float *block, size_t length)
{
    memset(out_dot, 0, row_count * FRAME_BLOCK * sizeof *out_dot);
    for (size_t first = 0; first < length; first += PANEL) {
        size_t size = length - first < PANEL ? length - first : PANEL;
        const float *panel = block + first * FRAME_BLOCK;
        size_t r = 0;
        for (; r + 2 <= row_count; r += 2)
            dot_two_rows(out_dot + r * FRAME_BLOCK, row + r * length + first, length, panel, size);
        if (r < row_count)
            dot_row(out_dot + r * FRAME_BLOCK, row + r * length + first, panel, size);
    }
}

static void subtract_at_two(float *frame, const float *row, size_t row_count, const float *weight,
                            size_t length)
{
    float sum_a[FRAME_BLOCK] = {0}, sum_b[FRAME_BLOCK] = {0};
    for (size_t r = 0; r < row_count; ++r) {
        const float *w = weight + r * FRAME_BLOCK;
        float at_a = row[r * length], at_b = row[r * length + 1];
        for (int lane = 0; lane < FRAME_BLOCK; ++lane) {
            sum_a[lane] += at_a * w[lane];
            sum_b[lane] += at_b * w[lane];
        }
    }
    for (int lane = 0; lane < FRAME_BLOCK; ++lane) {
        frame[lane] -= sum_a[lane];
        frame[FRAME_BLOCK + lane] -= sum_b[lane];
    }
}

static void subtract_at(float *frame, const float *row, size_t row_count, const float *weight,
                        size_t length)
{
    float sum[FRAME_BLOCK] = {0};
    for (size_t r = 0; r < row_count; ++r)
        for (int lane = 0; lane < FRAME_BLOCK; ++lane)
            sum[lane] += row[r * length] * weight[r * FRAME_BLOCK + (size_t)lane];
    for (int lane = 0; lane < FRAME_BLOCK; ++lane)
        frame[lane] -= sum[lane];
}

/* Processes a tile of rows by columns that fits in the first-level cache and uses few pages. */
static void subtract_tile(float *block, const float *row, size_t row_count, const float *weight,
                          size_t length, size_t size)
{
    size_t d = 0;
    for (; d + 2 <= size; d += 2)
        subtract_at_two(block + d * FRAME_BLOCK, row + d, row_count, weight, length);
    if (d < size)
        subtract_at(block + d * FRAME_BLOCK, row + d, row_count, weight, length);
}

void FRAME_BLOCK_LOOP(subtract, MAROTTE_VARIANT)(float *block, const float *row, size_t row_count,
                                                 const float *weight, size_t length)
{
    for (size_t d = 0; d < length; d += TILE_COLUMNS)
        for (size_t r = 0; r < row_count; r += TILE_ROWS)
            subtract_tile(block + d * FRAME_BLOCK, row + r * length + d,
                          row_count - r < TILE_ROWS ? row_count - r : TILE_ROWS,
                          weight + r * FRAME_BLOCK, length,
                          length - d < TILE_COLUMNS ? length - d : TILE_COLUMNS);
}
