#include "window/desk_figures.h"

#include <stdlib.h>
#include <string.h>

void figures_add(figures *self, double value)
{
    self->value[self->count++ % FIGURES_KEPT] = value;
    if (self->count == 2 * FIGURES_KEPT) /* the ring starts where it was */
        self->count = FIGURES_KEPT;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

void figures_look(const figures *self, double *out_p50, double *out_p99)
{
    double sorted[FIGURES_KEPT];
    const uint32_t count = self->count < FIGURES_KEPT ? self->count : FIGURES_KEPT;
    *out_p50 = *out_p99 = 0.0;
    if (count == 0)
        return;
    memcpy(sorted, self->value, count * sizeof sorted[0]);
    qsort(sorted, count, sizeof sorted[0], by_size);
    *out_p50 = sorted[(count - 1) / 2];
    *out_p99 = sorted[(uint32_t)(0.99 * (double)(count - 1) + 0.5)];
}
