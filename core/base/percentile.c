#include "base/percentile.h"

#include <stdlib.h>

static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double percentile(double *value, uint32_t count, double share)
{
    if (count == 0)
        return 0.0;
    qsort(value, count, sizeof *value, by_size);
    uint32_t index = (uint32_t)((double)count * share);
    return value[index < count ? index : count - 1];
}
