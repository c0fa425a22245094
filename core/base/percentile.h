/* base/percentile.h - percentiles of values: medians, the worst hundredth. Pure. */
#ifndef MAROTTE_BASE_PERCENTILE_H
#define MAROTTE_BASE_PERCENTILE_H
#include <stdint.h>

/* share: 0 to 1; 0.5 is the median (the upper of the middle two for an even count). Sorts `value`.
 * Returns 0 if count is 0. */
double percentile(double *value, uint32_t count, double share);

#endif
