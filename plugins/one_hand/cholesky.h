/* one_hand/cholesky.h - small symmetric positive definite systems. Pure; any thread. */
#ifndef MAROTTE_PLUGINS_ONE_HAND_CHOLESKY_H
#define MAROTTE_PLUGINS_ONE_HAND_CHOLESKY_H
#include <stdbool.h>

enum { CHOLESKY_MAX = 70 };
typedef struct cholesky {
    double at[CHOLESKY_MAX][CHOLESKY_MAX]; /* lower triangle: the matrix, then its factor */
} cholesky;

/* Factors the matrix in place. Returns false if it is not positive definite. */
bool cholesky_factor(cholesky *self, int count);
/* Solves in place. x: the right-hand side, then the solution. */
void cholesky_solve(const cholesky *self, int count, double *x);

#endif
