/* face/frame/shape_solve.h - how much of each shape explains what is asked for: least squares
 * between bounds. Minimises 1/2 w' H w - b' w over low <= w <= high by coordinate descent and
 * Newton steps on the weights that are free, from the weights of the frame before on. Leaves out
 * where H and b come from (face_shapes.c). Inside the room. Pure: a fixed order of sums and a fixed
 * bound of rounds, so the same input gives the same bits. [frame] */
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

/* More free weights than that are left to coordinate descent alone. */
enum { SHAPE_SOLVE_FREE_MAX = 64, SHAPE_SOLVE_ROUNDS = 24 };
#define SHAPE_SOLVE_SCRATCH(count)                                                                 \
    (2 * (size_t)(count) + (size_t)SHAPE_SOLVE_FREE_MAX * (SHAPE_SOLVE_FREE_MAX + 2))

/* w: count, in and out; what is beyond the bounds is brought within them first. scratch:
 * SHAPE_SOLVE_SCRATCH. Returns how many rounds it took; SHAPE_SOLVE_ROUNDS: it may not be the
 * least yet. */
uint32_t shape_solve(double *w, const shape_problem *p, double *scratch);

#endif
