/* io/write/frame_block.h - the two products of the search for components, on sixteen frames
 * together: inner products of basis rows with each frame, and their subtraction. A block holds one
 * frame per lane: value[d * FRAME_BLOCK + lane], d < length. Sums run over d (or over rows) in
 * ascending order within fixed panels, so the bits are the same on all machines. Pure. [any]
 * */
#ifndef MAROTTE_IO_FRAME_BLOCK_H
#define MAROTTE_IO_FRAME_BLOCK_H
#include <stddef.h>
#include <stdint.h>

enum { FRAME_BLOCK = 16 };

/* Copy one frame into or out of its lane. */
void frame_block_set(float *block, uint32_t lane, const float *frame, size_t length);
void frame_block_get(float *out, const float *block, uint32_t lane, size_t length);
/* out_dot: row_count by FRAME_BLOCK, the inner products of each row with each frame.
 * row: row_count by length. */
void frame_block_dot(double *out_dot, const float *row, size_t row_count, const float *block,
                     size_t length);
/* block -= sum over rows of weight * row. weight: row_count by FRAME_BLOCK. */
void frame_block_subtract(float *block, const float *row, size_t row_count, const float *weight,
                          size_t length);
/* Finds the greatest x^2 + y^2 + z^2 of each frame. length: 3 per vertex. */
void frame_block_peak(float out_peak[FRAME_BLOCK], const float *block, size_t length);

/* The two products for one instruction set (base/isa.h): frame_block_loops.c. */
typedef void frame_block_dot_loop(double *, const float *, size_t, const float *, size_t);
typedef void frame_block_subtract_loop(float *, const float *, size_t, const float *, size_t);
#define FRAME_BLOCK_JOIN(loop, variant) frame_block_##loop##_##variant
#define FRAME_BLOCK_LOOP(loop, variant) FRAME_BLOCK_JOIN(loop, variant)
#define FRAME_BLOCK_DECLARE(variant)                                                               \
    frame_block_dot_loop FRAME_BLOCK_LOOP(dot, variant);                                           \
    frame_block_subtract_loop FRAME_BLOCK_LOOP(subtract, variant)
FRAME_BLOCK_DECLARE(generic);
FRAME_BLOCK_DECLARE(v2);
FRAME_BLOCK_DECLARE(v3);
FRAME_BLOCK_DECLARE(v4);

#endif
