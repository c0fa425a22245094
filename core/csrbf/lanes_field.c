/* Direct evaluation of a field in one block of vertices, in float. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"
#include "csrbf/lanes_place.h"
#include "csrbf/lanes_reach.h"

#include <string.h>

/* One centre, one kernel: sum += phi alpha, weight := phi. Every lane is computed; the comparison
 * discards what lies beyond. */
#define ADD_CENTRE(NAME)                                                                           \
    static void add_##NAME(float *restrict x, float *restrict y, float *restrict z,                \
                           float *restrict weight, const block_place *restrict place,              \
                           pull_of_centre c)                                                       \
    {                                                                                              \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float dx = place->x[i] - c.at[0], dy = place->y[i] - c.at[1];                          \
            float dz = place->z[i] - c.at[2];                                                      \
            float q = dx * dx + dy * dy + dz * dz;                                                 \
            float inside = value_##NAME##_f32(sqrtf(q) * c.inverse_radius);                        \
            float value = q < c.limit ? inside : 0.0f;                                             \
            weight[i] = value;                                                                     \
            x[i] += value * c.alpha[0];                                                            \
            y[i] += value * c.alpha[1];                                                            \
            z[i] += value * c.alpha[2];                                                            \
        }                                                                                          \
    }
ADD_CENTRE(c0)
ADD_CENTRE(c2)
ADD_CENTRE(c4)
ADD_CENTRE(c6)

static void add_centre(float sum[3][POINTS_BLOCK], float *weight, const block_place *place,
                       const field *f, uint32_t centre)
{
    const pull_of_centre c = pull_of(f, centre);
    switch (f->settings.kernel) {
    case CSRBF_WENDLAND_C0:
        add_c0(sum[0], sum[1], sum[2], weight, place, c);
        return;
    case CSRBF_WENDLAND_C4:
        add_c4(sum[0], sum[1], sum[2], weight, place, c);
        return;
    case CSRBF_WENDLAND_C6:
        add_c6(sum[0], sum[1], sum[2], weight, place, c);
        return;
    case CSRBF_WENDLAND_C2:
        break;
    }
    add_c2(sum[0], sum[1], sum[2], weight, place, c);
}

static void narrow_window(float *restrict window, const float *restrict weight)
{
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window[i] *= 1.0f - weight[i];
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
    block_place place;
    reach r = {.next = 0};
    float weight[POINTS_BLOCK], window[POINTS_BLOCK];
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    for (int i = 0; windowed && i < POINTS_BLOCK; ++i)
        window[i] = 1.0f;
    while (reach_more(&r, f, &in->block[block])) {
        if (!reached) {
            memset(sum, 0, 3 * sizeof *sum);
            place_block(&place, f, in, block);
        }
        reached = true;
        for (uint32_t k = 0; k < r.count; ++k) {
            add_centre(sum, weight, &place, f, r.centre[k]);
            if (windowed)
                narrow_window(window, weight);
        }
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
