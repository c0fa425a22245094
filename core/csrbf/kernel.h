/* csrbf/kernel.h - Wendland's compactly supported functions for three dimensions (Wendland 1995),
 * for single values and for rows of a block. r is the distance divided by the radius. The rows are
 * inline, so each file that includes this compiles them for its own instruction set. Internal to
 * csrbf. Pure. [any] */
#ifndef MAROTTE_CSRBF_KERNEL_H
#define MAROTTE_CSRBF_KERNEL_H
#include "csrbf/settings.h"

#include <math.h>

/* Returns phi(r); 0 for r >= 1. */
double kernel_value(csrbf_kernel kernel, double r);
/* Returns phi'(r) / r, so that grad phi = slope (x - c) / R^2. C0 has a kink at 0; its value there
 * is 0. */
double kernel_slope(csrbf_kernel kernel, double r);
/* Returns the largest |phi'|, rounded up in its last digits. */
double kernel_steepest(csrbf_kernel kernel);

/* The closed forms, for r < 1, in the precision of REAL. t = 1 - r. */
#define KERNEL_FORMS(REAL, SUFFIX)                                                                 \
    static inline REAL value_c0_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r;                                                                            \
        return t * t;                                                                              \
    }                                                                                              \
    static inline REAL value_c2_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r, t2 = t * t;                                                                \
        return (t2 * t2) * (4 * r + 1);                                                            \
    }                                                                                              \
    static inline REAL value_c4_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r, t2 = t * t;                                                                \
        return (t2 * t2 * t2) * (((35 * r + 18) * r + 3) / 3);                                     \
    }                                                                                              \
    static inline REAL value_c6_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r, t2 = t * t, t4 = t2 * t2;                                                  \
        return (t4 * t4) * (((32 * r + 25) * r + 8) * r + 1);                                      \
    }                                                                                              \
    static inline REAL slope_c0_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        return r > 0 ? -2 * (1 - r) / r : 0;                                                       \
    }                                                                                              \
    static inline REAL slope_c2_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r;                                                                            \
        return -20 * (t * t * t);                                                                  \
    }                                                                                              \
    static inline REAL slope_c4_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r, t2 = t * t;                                                                \
        return ((REAL)(-56.0 / 3.0)) * ((5 * r + 1) * (t2 * t2 * t));                              \
    }                                                                                              \
    static inline REAL slope_c6_##SUFFIX(REAL r)                                                   \
    {                                                                                              \
        REAL t = 1 - r, t2 = t * t;                                                                \
        return -22 * (((16 * r + 7) * r + 1) * (t2 * t2 * t2 * t));                                \
    }

KERNEL_FORMS(float, f32)
KERNEL_FORMS(double, f64)

/* Rows of POINTS_BLOCK: phi at squared distances q; 0 where q >= q_limit. */

/* Evaluates one form for one row. The form is also evaluated beyond r = 1; the comparison discards
 * that result. */
#define KERNEL_ROW(FORM, REAL, ROOT)                                                               \
    for (int i = 0; i < POINTS_BLOCK; ++i) {                                                       \
        REAL value = FORM(ROOT(q[i]) * inverse_radius);                                            \
        out[i] = q[i] < q_limit ? value : 0;                                                       \
    }                                                                                              \
    return

static inline void kernel_values_f32(csrbf_kernel kernel, float *restrict out,
                                     const float *restrict q, float inverse_radius, float q_limit)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        KERNEL_ROW(value_c0_f32, float, sqrtf);
    case CSRBF_WENDLAND_C4:
        KERNEL_ROW(value_c4_f32, float, sqrtf);
    case CSRBF_WENDLAND_C6:
        KERNEL_ROW(value_c6_f32, float, sqrtf);
    case CSRBF_WENDLAND_C2:
        KERNEL_ROW(value_c2_f32, float, sqrtf);
    }
}

static inline void kernel_values_f64(csrbf_kernel kernel, double *restrict out,
                                     const double *restrict q, double inverse_radius,
                                     double q_limit)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        KERNEL_ROW(value_c0_f64, double, sqrt);
    case CSRBF_WENDLAND_C4:
        KERNEL_ROW(value_c4_f64, double, sqrt);
    case CSRBF_WENDLAND_C6:
        KERNEL_ROW(value_c6_f64, double, sqrt);
    case CSRBF_WENDLAND_C2:
        KERNEL_ROW(value_c2_f64, double, sqrt);
    }
}

/* phi for distances over the radius up to 1. */
#define KERNEL_ROW_AT(FORM)                                                                        \
    for (int i = 0; i < POINTS_BLOCK; ++i)                                                         \
        out[i] = FORM(r[i]);                                                                       \
    return

static inline void kernel_values_at_f32(csrbf_kernel kernel, float *restrict out,
                                        const float *restrict r)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        KERNEL_ROW_AT(value_c0_f32);
    case CSRBF_WENDLAND_C4:
        KERNEL_ROW_AT(value_c4_f32);
    case CSRBF_WENDLAND_C6:
        KERNEL_ROW_AT(value_c6_f32);
    case CSRBF_WENDLAND_C2:
        KERNEL_ROW_AT(value_c2_f32);
    }
}

#endif
