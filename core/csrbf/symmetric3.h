/* csrbf/symmetric3.h - eigenvalues of symmetric 3 by 3 matrices by Jacobi rotations in a fixed
 * order: only + - * / and sqrt, so the same bits everywhere. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_SYMMETRIC3_H
#define MAROTTE_CSRBF_SYMMETRIC3_H

typedef struct matrix3 {
    double at[3][3];
} matrix3;

/* value: descending; vector->at[k]: unit, of value[k], its component of largest size positive. a
 * must be finite; its whole is read. */
void symmetric3_eigen(double value[3], matrix3 *vector, const matrix3 *a);
double symmetric3_largest(const matrix3 *a);

#endif
