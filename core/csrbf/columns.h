/* csrbf/columns.h - what an anchored frame is made of: out = base + sum_j column_j weight_j, a
 * column being one number per vertex and a weight a vector. By blocks of 64 vertices, columns
 * ascending, in float32; a column that is zero all over a block costs nothing there, a column whose
 * weight is zero costs nothing at all, and a vertex that nothing moves keeps the bits of its base.
 * [frame] all but create/destroy: no allocation. */
#ifndef MAROTTE_CSRBF_COLUMNS_H
#define MAROTTE_CSRBF_COLUMNS_H
#include "csrbf/points.h"

typedef struct columns {
    float *value; /* capacity rows of `stride`, in the order of the points */
    size_t stride;
    uint32_t capacity, count, block_count;
    uint16_t *active;       /* block_count by capacity: columns that are not zero in the block */
    uint16_t *active_count; /* block_count */
    float *weight;          /* capacity by 3: scratch of a frame */
    const struct lanes *lanes;
} columns;

enum { COLUMNS_CAPACITY = 65535 };

/* Room for `capacity` columns over the points `like`. */
CHECKED mrt_result columns_create(columns *out, const points *like, uint32_t capacity, error *err);
void columns_destroy(columns *c);

float *columns_row(const columns *c, uint32_t column);
/* After rows 0 .. count - 1 have been written: they are the columns, and this notes where they are
 * zero. */
void columns_note(columns *c, uint32_t count);
/* The same where `group` columns in a row have values only where the last of them has: it need not
 * be said again when only the others change. count: a multiple of group. */
void columns_note_groups(columns *c, uint32_t count, uint32_t group);

/* sum: 3 by POINTS_BLOCK := sum over the columns first .. end - 1 of column_j weight_j in one
 * block. weight: 3 floats for each column from 0 on. */
void columns_sum(const columns *c, float sum[3][POINTS_BLOCK], const float *weight, uint32_t block,
                 uint32_t first, uint32_t end);
/* out = base + sum; where sum is zero the bits of base. Keeps the bounds of out. out may be base.
 */
void columns_add(points *out, const points *base, float sum[3][POINTS_BLOCK], uint32_t block);

/* The frame. weight: count by 3, finite as float. out is not base. */
void columns_move(columns *c, points *out, const points *base, const double *weight);

#endif
