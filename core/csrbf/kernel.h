/* csrbf/kernel.h - Wendland's compactly supported functions for three dimensions (Wendland 1995),
 * one value at a time; rows of a block: kernel_rows.h. r is the distance divided by the radius.
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

#endif
