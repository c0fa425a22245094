/* face/frame/shape_solve.h - the weights of shapes that explain given motions: least squares with
 * bounds. Minimises 1/2 w' H w - b' w over low <= w <= high. The method is coordinate descent with
 * Newton steps on the free weights, starting at the weights of the frame before. Leaves out how H
 * and b are made (face_shapes.c). Private to this folder. Pure: a fixed order of sums and a fixed
 * maximum of rounds, so that the same input gives the same bits. [frame] */
#ifndef MAROTTE_FACE_SHAPE_SOLVE_H
#define MAROTTE_FACE_SHAPE_SOLVE_H
#include <stddef.h>
#include <stdint.h>

typedef struct shape_problem {
    const double *h;          /* count by count, symmetric positive definite */
    const double *b;          /* count */
    const double *low, *high; /* count; low <= high */
    uint32_t count;
} shape_problem;

/* Above this number of free weights only coordinate descent is used. */
enum { SHAPE_SOLVE_FREE_MAX = 64, SHAPE_SOLVE_ROUNDS = 24 };
#define SHAPE_SOLVE_SCRATCH(count)                                                                 \
    (2 * (size_t)(count) + (size_t)SHAPE_SOLVE_FREE_MAX * (SHAPE_SOLVE_FREE_MAX + 2))

/* w: count, in and out; values outside the bounds are first clamped. scratch: SHAPE_SOLVE_SCRATCH.
 * Returns the number of rounds; with SHAPE_SOLVE_ROUNDS the minimum may not be reached. */
uint32_t shape_solve(double *w, const shape_problem *p, double *scratch);

#endif
