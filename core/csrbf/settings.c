#include "csrbf/settings.h"

#include <string.h>

static const char *const kernel_names[] = {"wendland_c2", "wendland_c0", "wendland_c4",
                                           "wendland_c6"};
static const char *const polynomial_names[] = {"none", "constant", "linear", "windowed"};

static bool find_name(const char *const *names, uint32_t count, const char *name, uint32_t *out)
{
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(names[i], name) == 0) {
            *out = i;
            return true;
        }
    return false;
}

bool csrbf_kernel_named(const char *name, csrbf_kernel *out)
{
    uint32_t index;
    if (!find_name(kernel_names, 4, name, &index))
        return false;
    *out = (csrbf_kernel)index;
    return true;
}

bool csrbf_polynomial_named(const char *name, csrbf_polynomial *out)
{
    uint32_t index;
    if (!find_name(polynomial_names, 4, name, &index))
        return false;
    *out = (csrbf_polynomial)index;
    return true;
}

const char *csrbf_kernel_name(csrbf_kernel of)
{
    return kernel_names[of];
}

const char *csrbf_polynomial_name(csrbf_polynomial of)
{
    return polynomial_names[of];
}

mrt_result csrbf_settings_check(const csrbf_settings *settings, error *err)
{
    const double reach = (double)POINTS_REACH;
    if ((unsigned)settings->kernel > CSRBF_WENDLAND_C6)
        return error_set(err, MRT_ERR_ARGUMENT, "kernel %d is unknown", (int)settings->kernel);
    if ((unsigned)settings->polynomial > CSRBF_WINDOWED)
        return error_set(err, MRT_ERR_ARGUMENT, "polynomial %d is unknown",
                         (int)settings->polynomial);
    if (!(settings->radius >= 1.0 / reach && settings->radius <= reach))
        return error_set(err, MRT_ERR_ARGUMENT, "radius %g: expected a number from %g to %g",
                         settings->radius, 1.0 / reach, reach);
    if (!(settings->ridge >= 0.0 && settings->ridge <= reach))
        return error_set(err, MRT_ERR_ARGUMENT, "ridge %g: expected a number from 0 to %g",
                         settings->ridge, reach);
    return MRT_OK;
}
