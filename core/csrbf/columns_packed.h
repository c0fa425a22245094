/* csrbf/columns_packed.h - a smaller copy of columns for frames that are shown and not kept: whole
 * numbers of 16 bits with one scale for each column. It differs from columns_move by at most half a
 * step of each column: sum_j max|column_j| |weight_j| / 65534 along an axis. Worth it where the
 * columns come from memory: a frame reads 2 bytes for each vertex and active column instead of 4,
 * besides 12 of the base and 12 written. The same bits on every instruction set. [frame] all but
 * create/destroy: no allocation. */
#ifndef MAROTTE_CSRBF_COLUMNS_PACKED_H
#define MAROTTE_CSRBF_COLUMNS_PACKED_H
#include "csrbf/columns.h"

typedef struct columns_packed {
    int16_t *value; /* capacity rows of `stride` */
    size_t stride;
    float *scale; /* capacity */
    columns_weights weights;
} columns_packed;

CHECKED mrt_result columns_packed_create(columns_packed *out, const columns *like, error *err);
void columns_packed_destroy(columns_packed *p);

/* Takes the columns over as they are noted. c: the one that it was created like. */
void columns_packed_take(columns_packed *p, const columns *c);
/* The frame of the columns taken last; weight: count by 3, finite as float. out is not base. */
void columns_packed_move(columns_packed *p, const columns *c, points *out, const points *base,
                         const double *weight);
/* What a frame begins with: p->weights of these weights. */
void columns_packed_weigh(columns_packed *p, const columns *c, const double *weight);

#endif
