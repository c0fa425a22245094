/* csrbf/hull.h - the affine hull of a set of centres: a point, a line, a plane or space. What a
 * linear polynomial may use without being undetermined. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_HULL_H
#define MAROTTE_CSRBF_HULL_H
#include "csrbf/symmetric3.h"

#include <stdint.h>

typedef struct hull {
    uint32_t dimension; /* 0..3; the first `dimension` axes span the hull */
    double centre[3];   /* mean of the points */
    matrix3 axis;       /* rows: unit, by falling extent */
} hull;

/* point: count by 3, count > 0. An extent of at most 1/1000 of the largest counts as flat; so does
 * one within the rounding of float32 input. */
void hull_fit(hull *out, const double *point, uint32_t count);

#endif
