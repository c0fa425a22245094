/* base/angle.h - sine and cosine with the same bits on every machine: a fixed polynomial in double
 * precision that uses only +, - and *. libm does not guarantee that. Leaves out other functions of
 * angles. Pure. [any] */
#ifndef MAROTTE_BASE_ANGLE_H
#define MAROTTE_BASE_ANGLE_H

#define ANGLE_PI 3.14159265358979323846

typedef struct angle_sincos {
    double sin, cos;
} angle_sincos;

/* Error below 1e-15 for |angle_rad| <= 1e4. A larger angle is first reduced modulo the double
 * nearest to 2 pi. A non-finite angle counts as 0. */
angle_sincos angle_sincos_of(double angle_rad);
/* Returns only the sine, with the same bits, in half the time. */
double angle_sine_of(double angle_rad);

#endif
