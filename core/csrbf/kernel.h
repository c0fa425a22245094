/* csrbf/kernel.h - Wendland's compactly supported functions for three dimensions (Wendland 1995),
 * one value at a time and by rows of a block. r is the distance divided by the radius.
 * Inside the room. Pure functions; any thread. */
#ifndef MAROTTE_CSRBF_KERNEL_H
#define MAROTTE_CSRBF_KERNEL_H
#include "csrbf/csrbf.h"

/* phi(r); 0 from r = 1 on. */
double kernel_value(csrbf_kernel kernel, double r);
/* phi'(r) / r, so that grad phi = slope (x - c) / R^2; C0 has a kink at 0 and gives 0 there. */
double kernel_slope(csrbf_kernel kernel, double r);
/* Largest |phi'|, rounded up in its last digits. */
double kernel_steepest(csrbf_kernel kernel);

/* Rows of POINTS_BLOCK: phi and phi'/r at squared distances q; 0 where q >= q_limit. */
void kernel_values_f32(csrbf_kernel kernel, float *out, const float *q, float inverse_radius,
                       float q_limit);
void kernel_slopes_f32(csrbf_kernel kernel, float *out, const float *q, float inverse_radius,
                       float q_limit);
void kernel_values_f64(csrbf_kernel kernel, double *out, const double *q, double inverse_radius,
                       double q_limit);

#endif
