/* io/write/basis.h - a growing orthonormal basis: from candidate directions in order of their
 * strength, then from any residual that is still too large. Rows are float32, inner products
 * float64 in a fixed order, so the bits are the same on all machines. Does not cover the choice of
 * candidates. [any] */
#ifndef MAROTTE_IO_BASIS_H
#define MAROTTE_IO_BASIS_H
#include <stdbool.h>
#include <stddef.h>

typedef struct basis {
    float *axis; /* capacity by length; owned: rows 0..count-1 are orthonormal */
    size_t count, capacity;
    float *candidate; /* candidate_count by length; owned: of any length and direction */
    size_t candidate_count, next; /* next: first untried candidate */
    size_t cap;                   /* maximum of count */
    size_t length;
} basis;

double basis_dot(const float *a, const float *b, size_t length);
/* out -= weight * axis */
void basis_subtract(float *out, float weight, const float *axis, size_t length);

/* Adds the next candidate that is not spanned yet. Returns false if the cap is reached, all
 * candidates are used, or memory ran out. To remove axes, restore count and next. */
bool basis_add_candidate(basis *b);
/* Adds the direction of `residual`. Returns false if the cap is reached, it is already spanned, or
 * memory ran out. */
bool basis_add(basis *b, const float *residual);
void basis_finish(basis *b);

#endif
