/* io/basis.h - an orthonormal basis that grows: from candidate directions in the order of their
 * strength and, when they are used up, from whatever residual is still too large. Rows are float32,
 * inner products float64 in a fixed order: same bits everywhere. Any thread. */
#ifndef MAROTTE_IO_BASIS_H
#define MAROTTE_IO_BASIS_H
#include <stdbool.h>
#include <stddef.h>

typedef struct basis {
    float *axis; /* capacity by length; owned. Rows 0..count-1 are orthonormal; rows
                    next..candidate_end-1 are candidates, of any length and direction */
    size_t count, next, candidate_end, capacity;
    size_t cap; /* greatest count */
    size_t length;
} basis;

double basis_dot(const float *a, const float *b, size_t length);
/* out -= weight * axis */
void basis_subtract(float *out, float weight, const float *axis, size_t length);

/* Room for so many rows (at most cap); false: no memory. */
bool basis_reserve(basis *b, size_t row_count);
/* One more axis: the next candidate that is not spanned yet or, without any, the direction of
 * `residual` (NULL: none). False: the cap is reached, nothing new is left, or no memory. */
bool basis_add(basis *b, const float *residual);
void basis_finish(basis *b);

#endif
