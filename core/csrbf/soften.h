/* csrbf/soften.h - compromises between contradicting pulls: evaluates a field with the matrix A +
 * diag(ridge) at its own centres. Pulls that agree hardly change. Pulls that are far from any ridge
 * do not change. [frame] no allocation. */
#ifndef MAROTTE_CSRBF_SOFTEN_H
#define MAROTTE_CSRBF_SOFTEN_H
#include "csrbf/csrbf.h"

/* Number of doubles of scratch for `count` centres. */
#define CSRBF_SOFTEN_SCRATCH(count) ((size_t)(count) * (count) + (size_t)3 * (count))

/* g (count by 3) := A (A + diag(ridge))^-1 g, A_ij = likeness_ij phi(|c_i - c_j| / R). likeness:
 * count by count, symmetric, positive semidefinite, 1 on its diagonal; ridge: count, >= 0. A pull
 * without a ridge keeps its bits. */
void csrbf_soften(double *g, const csrbf_settings *settings, const double *centre,
                  const double *likeness, const double *ridge, uint32_t count, double *scratch);

#endif
