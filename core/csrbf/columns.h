/* csrbf/columns.h - what an anchored frame is made of: out = base + sum_j column_j weight_j, a
 * column being one number per vertex and a weight a vector. By blocks of 64 vertices, columns
 * ascending, in float32. A frame costs what it moves: a column that is zero all over a block costs
 * nothing there, a column whose weight is zero costs nothing at all, however many there are, and a
 * vertex that nothing moves keeps the bits of its base.
 * [frame] all but create/destroy: no allocation. */
#ifndef MAROTTE_CSRBF_COLUMNS_H
#define MAROTTE_CSRBF_COLUMNS_H
#include "csrbf/points.h"

enum { COLUMNS_CAPACITY = 65535, COLUMNS_WORD = 64 };

/* The weights of a frame, and which of them count. Bits are in words of COLUMNS_WORD columns. */
typedef struct columns_weights {
    float *value;   /* capacity by 3 */
    uint64_t *live; /* words: columns whose weight is not zero */
    uint16_t *word; /* the words of `live` that are not zero, ascending */
    uint32_t word_count;
    size_t bytes; /* that the frame reads and writes */
} columns_weights;

typedef struct columns {
    float *value; /* capacity rows of `stride`, in the order of the points */
    size_t stride;
    uint32_t capacity, count, block_count;
    uint32_t mark_words; /* of a block */
    uint64_t *mark;      /* block_count by mark_words: columns that are not zero in the block */
    uint32_t *filled;    /* capacity: blocks in which the column is not zero */
    columns_weights weights;
    size_t far_from_bytes; /* frames of more than that are written around the caches */
    const struct lanes *lanes;
} columns;

/* Room for `capacity` columns over the points `like`. */
CHECKED mrt_result columns_create(columns *out, const points *like, uint32_t capacity, error *err);
void columns_destroy(columns *c);

float *columns_row(const columns *c, uint32_t column);
/* After rows 0 .. count - 1 have been written: they are the columns, and this notes where they are
 * zero. */
void columns_note(columns *c, uint32_t count);
/* The same where the rows before `first` stay as they were noted, and from there on `group` columns
 * in a row have values only where the last of them has: it need not be said again when only the
 * others change. count - first: a multiple of group. */
void columns_note_groups(columns *c, uint32_t first, uint32_t count, uint32_t group);

/* The frame. weight: count by 3, finite as float. out is not base. */
void columns_move(columns *c, points *out, const points *base, const double *weight);

/* ---- the same in parts ---- */

/* What a frame begins with. weight: `count` by 3; the columns from `count` on weigh nothing. */
void columns_weigh(columns *c, const double *weight, uint32_t count);
/* columns_move in the blocks first .. end - 1 with the weights taken last. [any] at the same time
 * for parts that share no block. */
void columns_move_blocks(const columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end);
/* sum: 3 by POINTS_BLOCK += sum over the columns from `first` on of column_j weight_j in one block,
 * with the weights taken last: of all of them at once it has the same bits as in parts. */
void columns_sum(const columns *c, float sum[3][POINTS_BLOCK], uint32_t first, uint32_t block);
/* out = base + sum; where sum is zero the bits of base. Keeps the bounds of out. out may be base.
 */
void columns_add(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block);

#endif
