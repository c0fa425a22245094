/* The matrix of a field: the kernel between all pairs of centres, in double. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"

enum { BATCH = 64 };

/* Distances over the radius from centre `row` to `count` others. */
static void measure(double *restrict out, const field *f, uint32_t row, uint32_t first,
                    uint32_t count)
{
    const double *restrict x = f->along[0] + first, *restrict y = f->along[1] + first;
    const double *restrict z = f->along[2] + first;
    const double cx = f->along[0][row], cy = f->along[1][row], cz = f->along[2][row];
    const double radius = f->settings.radius;
    for (uint32_t i = 0; i < count; ++i) {
        double dx = cx - x[i], dy = cy - y[i], dz = cz - z[i];
        out[i] = sqrt(dx * dx + dy * dy + dz * dz) / radius;
    }
}

/* Cheaper than to measure: true whenever one of them is in the support of `row`, and seldom when
 * none is. */
static bool may_reach(const field *f, uint32_t row, uint32_t first, uint32_t count)
{
    const double *restrict x = f->along[0] + first, *restrict y = f->along[1] + first;
    const double *restrict z = f->along[2] + first;
    const double cx = f->along[0][row], cy = f->along[1][row], cz = f->along[2][row];
    const double limit = f->settings.radius * f->settings.radius * (1.0 + 0x1p-40);
    int within = 0;
    for (uint32_t i = 0; i < count; ++i) {
        double dx = cx - x[i], dy = cy - y[i], dz = cz - z[i];
        within |= dx * dx + dy * dy + dz * dz < limit;
    }
    return within != 0;
}

uint32_t LANES(first_neighbour)(const field *f, uint32_t row)
{
    double r[BATCH];
    for (uint32_t first = 0; first < row; first += BATCH) {
        uint32_t count = row - first < BATCH ? row - first : BATCH;
        if (!may_reach(f, row, first, count))
            continue;
        measure(r, f, row, first, count);
        for (uint32_t i = 0; i < count; ++i)
            if (r[i] < 1.0)
                return first + i;
    }
    return row;
}

#define FILL(FORM)                                                                                 \
    for (uint32_t i = 0; i < count; ++i) {                                                         \
        double value = FORM(r[i]);                                                                 \
        out[i] = r[i] < 1.0 ? value : 0.0;                                                         \
    }                                                                                              \
    return

static void fill(double *restrict out, const double *restrict r, csrbf_kernel kernel,
                 uint32_t count)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        FILL(value_c0_f64);
    case CSRBF_WENDLAND_C4:
        FILL(value_c4_f64);
    case CSRBF_WENDLAND_C6:
        FILL(value_c6_f64);
    case CSRBF_WENDLAND_C2:
        FILL(value_c2_f64);
    }
}

void LANES(kernel_row)(const field *f, double *out, uint32_t row, uint32_t first)
{
    double r[BATCH];
    for (; first < row; first += BATCH, out += BATCH) {
        uint32_t count = row - first < BATCH ? row - first : BATCH;
        measure(r, f, row, first, count);
        fill(out, r, f->settings.kernel, count);
    }
}
