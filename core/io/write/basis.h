/* io/write/basis.h - an orthonormal basis that grows: from candidate directions in the order of
 * their strength and, when they are used up, from whatever residual is still too large. Rows are
 * float32, inner products float64 in a fixed order: same bits everywhere. Any thread. */
#ifndef MAROTTE_IO_BASIS_H
#define MAROTTE_IO_BASIS_H
#include <stdbool.h>
#include <stddef.h>

typedef struct basis {
    float *axis; /* capacity by length; owned: rows 0..count-1 are orthonormal */
    size_t count, capacity;
    float *candidate; /* candidate_count by length; owned: of any length and direction */
    size_t candidate_count, next; /* the first that has not been tried */
    size_t cap;                   /* greatest count */
    size_t length;
} basis;

double basis_dot(const float *a, const float *b, size_t length);
/* out -= weight * axis */
void basis_subtract(float *out, float weight, const float *axis, size_t length);

/* One more axis: the next candidate that is not spanned yet. False: the cap is reached, no
 * candidate is left, or no memory. To take axes back, set count and next to what they were. */
bool basis_add_candidate(basis *b);
/* One more axis: the direction of `residual`. False: the cap is reached, it is spanned, or no
 * memory. */
bool basis_add(basis *b, const float *residual);
void basis_finish(basis *b);

#endif
