#include "csrbf/kernel.h"

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
