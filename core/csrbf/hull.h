/* csrbf/hull.h - the affine hull of a set of centres: a point, a line, a plane or space. It limits
 * a linear polynomial to the directions that the centres determine. Eigenvalues by Jacobi rotations
 * in a fixed order with + - * / and sqrt only, so the bits are the same everywhere. Internal to
 * csrbf. Pure. [any] */
#ifndef MAROTTE_CSRBF_HULL_H
#define MAROTTE_CSRBF_HULL_H
#include <stdint.h>

typedef struct matrix3 {
    double at[3][3];
} matrix3;

/* value: descending; vector->at[k]: unit, of value[k], its component of largest size positive. a
 * must be finite; all of it is read. */
double symmetric3_largest(const matrix3 *a);

typedef struct hull {
    uint32_t dimension; /* 0..3; the first `dimension` axes span the hull */
    double centre[3];   /* mean of the points */
    matrix3 axis;       /* rows: unit vectors, by descending extent */
} hull;

/* Fits a hull. point: count by 3, count > 0. An extent of at most 1/1000 of the largest counts as
 * flat, and so does one within the rounding of float32 input. */
void hull_fit(hull *out, const double *point, uint32_t count);

#endif
