/* Direct evaluation of a field in one block of vertices, in float. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"
#include "csrbf/lanes_place.h"
#include "csrbf/lanes_reach.h"

#include <string.h>

/* Distances over the radius; 1 from the radius on, where every kernel is exactly 0. */
static void measure(float *restrict r, const block_place *restrict place, pull_of_centre c)
{
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float dx = place->x[i] - c.at[0], dy = place->y[i] - c.at[1];
        float dz = place->z[i] - c.at[2];
        float q = dx * dx + dy * dy + dz * dz;
        float inside = sqrtf(q) * c.inverse_radius;
        r[i] = q < c.limit ? inside : 1.0f;
    }
}

/* One centre, one kernel: sum += phi alpha. */
#define ADD_CENTRE(NAME)                                                                           \
    static void add_##NAME(float *restrict x, float *restrict y, float *restrict z,                \
                           const float *restrict r, pull_of_centre c)                              \
    {                                                                                              \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float value = value_##NAME##_f32(r[i]);                                                \
            x[i] += value * c.alpha[0];                                                            \
            y[i] += value * c.alpha[1];                                                            \
            z[i] += value * c.alpha[2];                                                            \
        }                                                                                          \
    }
ADD_CENTRE(c0)
ADD_CENTRE(c2)
ADD_CENTRE(c4)
ADD_CENTRE(c6)

static void add_centre(float sum[3][POINTS_BLOCK], const float *r, csrbf_kernel kernel,
                       pull_of_centre c)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        add_c0(sum[0], sum[1], sum[2], r, c);
        return;
    case CSRBF_WENDLAND_C4:
        add_c4(sum[0], sum[1], sum[2], r, c);
        return;
    case CSRBF_WENDLAND_C6:
        add_c6(sum[0], sum[1], sum[2], r, c);
        return;
    case CSRBF_WENDLAND_C2:
        break;
    }
    add_c2(sum[0], sum[1], sum[2], r, c);
}

/* window *= 1 - phi */
static void narrow_window(float *restrict window, const float *restrict r, csrbf_kernel kernel)
{
    float weight[POINTS_BLOCK];
    kernel_values_at_f32(kernel, weight, r);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window[i] *= 1.0f - weight[i];
}

/* The centres' shares, in their order. The next one's distances are begun before this one is added:
 * square roots take long, and nothing need wait for them. */
static void add_centres(float sum[3][POINTS_BLOCK], float *window, const block_place *place,
                        const field *f, const reach *near)
{
    _Alignas(64) float r[2][POINTS_BLOCK];
    pull_of_centre next = pull_of(f, near->centre[0]);
    measure(r[0], place, next);
    for (uint32_t k = 0; k < near->count; ++k) {
        const pull_of_centre now = next;
        if (k + 1 < near->count) {
            next = pull_of(f, near->centre[k + 1]);
            measure(r[(k + 1) % 2], place, next);
        }
        add_centre(sum, r[k % 2], f->settings.kernel, now);
        if (window)
            narrow_window(window, r[k % 2], f->settings.kernel);
    }
}

/* Adds window times p, which may be beyond float where window is 0. */
static void add_polynomial(const field *f, float sum[3][POINTS_BLOCK], const float *window,
                           const points *in, uint32_t block)
{
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], p[3];
        if (window[i] == 0.0f)
            continue;
        points_at(x, in, (size_t)block * POINTS_BLOCK + i);
        field_polynomial(f, p, x);
        for (int axis = 0; axis < 3; ++axis)
            sum[axis][i] += window[i] * (float)p[axis];
    }
}

bool LANES(field_block)(const field *f, float sum[3][POINTS_BLOCK], const points *in,
                        uint32_t block)
{
    _Alignas(64) block_place place;
    reach near = {.next = 0};
    float window[POINTS_BLOCK];
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    for (int i = 0; windowed && i < POINTS_BLOCK; ++i)
        window[i] = 1.0f;
    while (reach_more(&near, f, &in->block[block])) {
        if (!reached) {
            memset(sum, 0, 3 * sizeof *sum);
            place_block(&place, f, in, block);
        }
        reached = true;
        add_centres(sum, windowed ? window : NULL, &place, f, &near);
    }
    if (f->term_count == 0 || (windowed && !reached))
        return reached;
    if (!reached)
        memset(sum, 0, 3 * sizeof *sum);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window[i] = windowed ? 1.0f - window[i] : 1.0f;
    add_polynomial(f, sum, window, in, block);
    return true;
}
