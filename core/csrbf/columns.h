/* csrbf/columns.h - computes an anchored frame: out = base + sum_j column_j weight_j. A column is
 * one number per vertex, and a weight is a vector. By blocks of 64 vertices, columns ascending, in
 * float32. A frame costs only what it moves: a column that is zero in a block costs nothing there,
 * and a column whose weight is zero costs nothing, however many exist. A vertex that is not moved
 * keeps the bits of its base. [frame] all except create/destroy: no allocation. */
#ifndef MAROTTE_CSRBF_COLUMNS_H
#define MAROTTE_CSRBF_COLUMNS_H
#include "csrbf/points.h"

enum { COLUMNS_CAPACITY = 65535, COLUMNS_WORD = 64 };

/* The weights of a frame, and the columns with a weight. Bits are in words of COLUMNS_WORD
 * columns. */
typedef struct columns_weights {
    float *value;   /* capacity by 3 */
    uint64_t *live; /* bits: columns whose weight is not zero */
    uint16_t *word; /* indices of the words of `live` that are not zero, ascending */
    uint32_t word_count;
    size_t bytes; /* number that the frame reads and writes */
} columns_weights;

typedef struct columns {
    float *value; /* capacity rows of `stride`, in the order of the points */
    size_t stride;
    uint32_t capacity, count, block_count;
    uint32_t mark_words; /* number of words of marks in a block */
    uint64_t *mark;      /* block_count by mark_words: columns that are not zero in the block */
    uint32_t *filled;    /* for each column: number of blocks where it is not zero */
    columns_weights weights;
    size_t far_from_bytes; /* frames with more bytes bypass the caches when writing */
    const struct lanes *lanes;
} columns;

/* Allocates `capacity` columns for the points `like`. */
CHECKED mrt_result columns_create(columns *out, const points *like, uint32_t capacity, error *err);
void columns_destroy(columns *c);

float *columns_row(const columns *c, uint32_t column);
/* Call it after writing rows 0 .. count - 1: they become the columns, and the blocks where they are
 * zero are recorded. */
void columns_note(columns *c, uint32_t count);
/* The same, but the rows before `first` are unchanged since the last call. Starting at `first`,
 * each `group` consecutive columns are non-zero only where the last of them is. Changes of the
 * other columns of a group need no new call. count - first: a multiple of group. */
void columns_note_groups(columns *c, uint32_t first, uint32_t count, uint32_t group);

/* Computes the frame. weight: count by 3, finite as float. out must not be base. */
void columns_move(columns *c, points *out, const points *base, const double *weight);

/* ---- the same in steps ---- */

/* Sets the weights, the first step of a frame. weight: `count` by 3; the columns from `count` on
 * get the weight 0. */
void columns_weigh(columns *c, const double *weight, uint32_t count);
/* Does columns_move for the blocks first .. end - 1 with the last set weights. [any] Several
 * threads may do this for different blocks. */
void columns_move_blocks(const columns *c, points *out, const points *base, uint32_t first,
                         uint32_t end);
/* sum: 3 by POINTS_BLOCK += sum over the columns from `first` on of column_j weight_j in one
 * block, with the last set weights. Summing in parts gives the same bits as summing all columns
 * at once. */
void columns_sum(const columns *c, float sum[3][POINTS_BLOCK], uint32_t first, uint32_t block);
/* out = base + sum; where sum is zero, out gets the bits of base. Updates the bounds of out. out
 * may be base. */
void columns_add(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block);

#endif
