/* base/angle.h - sine and cosine that have the same bits on every machine: a fixed polynomial in
 * double precision, of +, - and * alone. libm promises no such thing. Leaves out every other
 * function of angles. Pure; any thread. */
#ifndef MAROTTE_BASE_ANGLE_H
#define MAROTTE_BASE_ANGLE_H

#define ANGLE_PI 3.14159265358979323846

typedef struct angle_sincos {
    double sin, cos;
} angle_sincos;

/* Error below 1e-15 for |angle_rad| <= 1e4, which is far more than +-2 pi. Beyond that (1e4 to any
 * finite value) the angle is first taken modulo the double nearest to 2 pi; a non-finite angle
 * counts as 0. */
angle_sincos angle_sincos_of(double angle_rad);
/* Its sine alone, the same bits in half of the time. */
double angle_sine_of(double angle_rad);

#endif
