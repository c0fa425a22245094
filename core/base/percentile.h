/* base/percentile.h - which value a share of all values stays below: medians, worst hundredths.
 * Pure. */
#ifndef MAROTTE_BASE_PERCENTILE_H
#define MAROTTE_BASE_PERCENTILE_H
#include <stdint.h>

/* share: 0 to 1; 0.5 is the median, of an even count the upper of the middle two. Sorts `value`.
 * 0 when there are no values. */
double percentile(double *value, uint32_t count, double share);

#endif
