#include "base/angle.h"

#include <math.h>
#include <stdint.h>

/* pi/2 as a sum of two parts. The first has 33 bits, so that its product with an integer below 2^20
 * is exact. */
static const double QUARTER_HIGH = 1.57079632673412561417e+00;
static const double QUARTER_LOW = 6.07710050650619224932e-11;

/* Taylor series. For |x| <= pi/4 the first omitted term is below 5e-17. */
static double sine_near_zero(double x)
{
    double q = x * x;
    double p = -1.0 / 1307674368000.0; /* 15! */
    p = p * q + 1.0 / 6227020800.0;
    p = p * q - 1.0 / 39916800.0;
    p = p * q + 1.0 / 362880.0;
    p = p * q - 1.0 / 5040.0;
    p = p * q + 1.0 / 120.0;
    p = p * q - 1.0 / 6.0;
    return x + x * (q * p);
}

static double cosine_near_zero(double x)
{
    double q = x * x;
    double p = 1.0 / 20922789888000.0; /* 16! */
    p = p * q - 1.0 / 87178291200.0;
    p = p * q + 1.0 / 479001600.0;
    p = p * q - 1.0 / 3628800.0;
    p = p * q + 1.0 / 40320.0;
    p = p * q - 1.0 / 720.0;
    p = p * q + 1.0 / 24.0;
    p = p * q - 0.5;
    return 1.0 + q * p;
}

/* Reduces a finite angle to a quarter turn. Returns the rest, and the number of quarters (modulo
 * 4). */
static double within_quarter(double angle_rad, int *out_quarter)
{
    if (angle_rad > 1e4 || angle_rad < -1e4)
        angle_rad = fmod(angle_rad, 2.0 * ANGLE_PI); /* exact by definition in every libm */
    double quarters = angle_rad * (2.0 / ANGLE_PI);
    int32_t quarter = (int32_t)(quarters < 0.0 ? quarters - 0.5 : quarters + 0.5);
    *out_quarter = quarter & 3;
    return angle_rad - quarter * QUARTER_HIGH - quarter * QUARTER_LOW;
}

angle_sincos angle_sincos_of(double angle_rad)
{
    int quarter;
    if (!isfinite(angle_rad))
        return (angle_sincos){0.0, 1.0};
    double x = within_quarter(angle_rad, &quarter);
    double s = sine_near_zero(x), c = cosine_near_zero(x);
    switch (quarter) {
    case 0:
        return (angle_sincos){s, c};
    case 1:
        return (angle_sincos){c, -s};
    case 2:
        return (angle_sincos){-s, -c};
    default:
        return (angle_sincos){-c, s};
    }
}

double angle_sine_of(double angle_rad)
{
    int quarter;
    if (!isfinite(angle_rad))
        return 0.0;
    double x = within_quarter(angle_rad, &quarter);
    double sine = quarter % 2 ? cosine_near_zero(x) : sine_near_zero(x);
    return quarter < 2 ? sine : -sine;
}
