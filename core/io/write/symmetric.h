/* io/write/symmetric.h - eigenvalues and eigenvectors of a real symmetric matrix, by Householder
 * reduction and implicit QL. Uses only + - * / and sqrt in a fixed order, so the bits are the same
 * on all machines. [any] */
#ifndef MAROTTE_IO_SYMMETRIC_H
#define MAROTTE_IO_SYMMETRIC_H
#include "base/error.h"

/* matrix: n by n, finite, symmetric; replaced by the eigenvectors, one per row, unit length.
 * out_value: n, descending. work: n by (n + 3) doubles. MRT_ERR_ARGUMENT: no convergence. */
CHECKED mrt_result symmetric_eigen(double *matrix, double *out_value, double *work, uint32_t n,
                                   error *err);

#endif
