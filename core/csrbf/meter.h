/* csrbf/meter.h - how hard a field bends space: at the vertices exactly, anywhere as a bound.
 * Inside the room. [frame] */
#ifndef MAROTTE_CSRBF_METER_H
#define MAROTTE_CSRBF_METER_H
#include "csrbf/field.h"

/* Smallest det(I + grad d) over the vertices; 1 without vertices. */
double meter_min_determinant(const field *f, const points *at);
/* Largest spectral norm of grad d over the vertices. */
double meter_max_slope(const field *f, const points *at);
/* Both in one pass; the same values. */
void meter_measure(const field *f, const points *at, double *out_slope, double *out_determinant);
/* Upper bound of that norm over all of space: of all centres whose supports may meet at a point
 * the steepest slopes are added up. With a windowed polynomial: over the union of supports. */
double meter_slope_bound(const field *f);

#endif
