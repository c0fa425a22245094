/* Direct evaluation of a field in one block of vertices, in float. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"
#include "csrbf/lanes_place.h"
#include "csrbf/lanes_reach.h"

#include <string.h>

/* Some centres: their places, their alphas, and by what distances are measured. */
enum { TOGETHER = 2 };
typedef struct pulls {
    const float *at[TOGETHER], *alpha[TOGETHER]; /* 3 each */
    float inverse_radius, limit;
} pulls;

/* COUNT centres, one kernel, in their order: sum := START + phi alpha, where phi is 0 from the
 * radius on. Two in one pass: square roots take long, and nothing need wait for them. */
#define ADD_CENTRES(HOW, NAME, COUNT, START)                                                       \
    static void HOW##_##NAME##_##COUNT(float *restrict sx, float *restrict sy, float *restrict sz, \
                                       const block_place *restrict place, const pulls *restrict c) \
    {                                                                                              \
        const float inverse_radius = c->inverse_radius, limit = c->limit;                          \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float x = START(sx[i]), y = START(sy[i]), z = START(sz[i]);                            \
            for (int k = 0; k < COUNT; ++k) {                                                      \
                float dx = place->x[i] - c->at[k][0], dy = place->y[i] - c->at[k][1];              \
                float dz = place->z[i] - c->at[k][2];                                              \
                float q = dx * dx + dy * dy + dz * dz;                                             \
                float inside = sqrtf(q) * inverse_radius;                                          \
                float value = value_##NAME##_f32(q < limit ? inside : 1.0f);                       \
                x += value * c->alpha[k][0];                                                       \
                y += value * c->alpha[k][1];                                                       \
                z += value * c->alpha[k][2];                                                       \
            }                                                                                      \
            sx[i] = x;                                                                             \
            sy[i] = y;                                                                             \
            sz[i] = z;                                                                             \
        }                                                                                          \
    }
#define FROM_ZERO(sum) 0.0f
#define FROM_SUM(sum)  (sum)
#define ADD_SOME_CENTRES(NAME)                                                                     \
    ADD_CENTRES(begin, NAME, 1, FROM_ZERO)                                                         \
    ADD_CENTRES(begin, NAME, 2, FROM_ZERO)                                                         \
    ADD_CENTRES(add, NAME, 1, FROM_SUM)                                                            \
    ADD_CENTRES(add, NAME, 2, FROM_SUM)
ADD_SOME_CENTRES(c0)
ADD_SOME_CENTRES(c2)
ADD_SOME_CENTRES(c4)
ADD_SOME_CENTRES(c6)

typedef void add_function(float *restrict sx, float *restrict sy, float *restrict sz,
                          const block_place *restrict place, const pulls *restrict c);
#define SOME_CENTRES(NAME)                                                                         \
    {                                                                                              \
        {begin_##NAME##_1, begin_##NAME##_2},                                                      \
        {                                                                                          \
            add_##NAME##_1, add_##NAME##_2                                                         \
        }                                                                                          \
    }
static add_function *const adders[][2][TOGETHER] = {
    [CSRBF_WENDLAND_C0] = SOME_CENTRES(c0),
    [CSRBF_WENDLAND_C2] = SOME_CENTRES(c2),
    [CSRBF_WENDLAND_C4] = SOME_CENTRES(c4),
    [CSRBF_WENDLAND_C6] = SOME_CENTRES(c6),
};

/* The centres' shares, in their order; sum need not be set before the first of them. */
static void add_centres(float sum[3][POINTS_BLOCK], bool is_begun, const block_place *place,
                        const field *f, const reach *near)
{
    pulls c = {.inverse_radius = (float)(1.0 / f->settings.radius), .limit = f->local_limit};
    for (uint32_t done = 0, count; done < near->count; done += count) {
        uint32_t left = near->count - done;
        count = left < TOGETHER ? left : TOGETHER;
        for (uint32_t k = 0; k < count; ++k) {
            c.at[k] = f->local_centre + (size_t)3 * near->centre[done + k];
            c.alpha[k] = f->local_alpha + (size_t)3 * near->centre[done + k];
        }
        add_function *const *add = adders[f->settings.kernel][is_begun || done > 0];
        add[count - 1](sum[0], sum[1], sum[2], place, &c);
    }
}

/* window *= 1 - phi of each centre */
static void narrow_window(float *restrict window, const block_place *place, const field *f,
                          const reach *near)
{
    for (uint32_t k = 0; k < near->count; ++k) {
        const pull_of_centre c = pull_of(f, near->centre[k]);
        float r[POINTS_BLOCK], weight[POINTS_BLOCK];
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            float dx = place->x[i] - c.at[0], dy = place->y[i] - c.at[1];
            float dz = place->z[i] - c.at[2];
            float q = dx * dx + dy * dy + dz * dz;
            float inside = sqrtf(q) * c.inverse_radius;
            r[i] = q < c.limit ? inside : 1.0f;
        }
        kernel_values_at_f32(f->settings.kernel, weight, r);
        for (int i = 0; i < POINTS_BLOCK; ++i)
            window[i] *= 1.0f - weight[i];
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
    reach near;
    float window[POINTS_BLOCK];
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    near.next = 0;
    for (int i = 0; windowed && i < POINTS_BLOCK; ++i)
        window[i] = 1.0f;
    while (reach_more(&near, f, &in->block[block])) {
        if (!reached)
            place_block(&place, f, in, block);
        add_centres(sum, reached, &place, f, &near);
        reached = true;
        if (windowed)
            narrow_window(window, &place, f, &near);
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
