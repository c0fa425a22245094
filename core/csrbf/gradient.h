/* csrbf/gradient.h - the derivative of a field at the vertices of a block. Inside the room.
 * [frame] */
#ifndef MAROTTE_CSRBF_GRADIENT_H
#define MAROTTE_CSRBF_GRADIENT_H
#include "csrbf/field.h"

typedef struct gradient {
    float row[3][3][POINTS_BLOCK]; /* [a][b]: derivative of d_a by x_b */
} gradient;

/* False when grad d is zero all over the block; it is set to zero then. */
bool gradient_of(const field *f, gradient *out, const points *at, uint32_t block);
/* grad p: [a][b] is the derivative of p_a by x_b. */
matrix3 gradient_polynomial(const field *f);

#endif
