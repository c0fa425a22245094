#include "csrbf/kernel.h"

#include <math.h>

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

double kernel_value(csrbf_kernel kernel, double r)
{
    if (!(r < 1.0))
        return 0.0;
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        return value_c0_f64(r);
    case CSRBF_WENDLAND_C4:
        return value_c4_f64(r);
    case CSRBF_WENDLAND_C6:
        return value_c6_f64(r);
    case CSRBF_WENDLAND_C2:
        break;
    }
    return value_c2_f64(r);
}

double kernel_slope(csrbf_kernel kernel, double r)
{
    if (!(r < 1.0))
        return 0.0;
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        return slope_c0_f64(r);
    case CSRBF_WENDLAND_C4:
        return slope_c4_f64(r);
    case CSRBF_WENDLAND_C6:
        return slope_c6_f64(r);
    case CSRBF_WENDLAND_C2:
        break;
    }
    return slope_c2_f64(r);
}

double kernel_steepest(csrbf_kernel kernel)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        return 2.0; /* at r = 0 */
    case CSRBF_WENDLAND_C4:
        return 2.499788878; /* at r = (4 + sqrt 156) / 70 */
    case CSRBF_WENDLAND_C6:
        return 2.819101011; /* at r = 0.215286 */
    case CSRBF_WENDLAND_C2:
        break;
    }
    return 135.0 / 64.0; /* at r = 1/4 */
}

/* One row by one form. The form runs beyond r = 1 too; the comparison discards what it gives. */
#define KERNEL_ROW(FORM, REAL, ROOT)                                                               \
    for (int i = 0; i < POINTS_BLOCK; ++i) {                                                       \
        REAL value = FORM(ROOT(q[i]) * inverse_radius);                                            \
        out[i] = q[i] < q_limit ? value : 0;                                                       \
    }                                                                                              \
    return

void kernel_values_f32(csrbf_kernel kernel, float *restrict out, const float *restrict q,
                       float inverse_radius, float q_limit)
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

void kernel_slopes_f32(csrbf_kernel kernel, float *restrict out, const float *restrict q,
                       float inverse_radius, float q_limit)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        KERNEL_ROW(slope_c0_f32, float, sqrtf);
    case CSRBF_WENDLAND_C4:
        KERNEL_ROW(slope_c4_f32, float, sqrtf);
    case CSRBF_WENDLAND_C6:
        KERNEL_ROW(slope_c6_f32, float, sqrtf);
    case CSRBF_WENDLAND_C2:
        KERNEL_ROW(slope_c2_f32, float, sqrtf);
    }
}

void kernel_values_f64(csrbf_kernel kernel, double *restrict out, const double *restrict q,
                       double inverse_radius, double q_limit)
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
