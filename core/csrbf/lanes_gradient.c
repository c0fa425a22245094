/* The derivative of a field in one block of vertices, in float, and what is measured of it. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"
#include "csrbf/lanes_place.h"
#include "csrbf/lanes_reach.h"

#include <string.h>

static void add_global_gradient(const field *f, gradient *out)
{
    const matrix3 slope = gradient_polynomial(f);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int i = 0; i < POINTS_BLOCK; ++i)
                out->row[a][b][i] += (float)slope.at[a][b];
}

/* The window and its gradient, for one block: starts as prod = 1, gradient 0. */
typedef struct window_rows {
    float outside[POINTS_BLOCK];     /* prod_i (1 - phi_i) */
    float gradient[3][POINTS_BLOCK]; /* of that product */
} window_rows;

static void window_open(window_rows *w)
{
    memset(w->gradient, 0, sizeof w->gradient);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        w->outside[i] = 1.0f;
}

static void window_times(window_rows *w, const float *weight, float step[3][POINTS_BLOCK])
{
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < POINTS_BLOCK; ++i)
            w->gradient[axis][i] =
                w->gradient[axis][i] * (1.0f - weight[i]) - w->outside[i] * step[axis][i];
    for (int i = 0; i < POINTS_BLOCK; ++i)
        w->outside[i] *= 1.0f - weight[i];
}

/* grad (W p) = W grad p + p grad W; p may be beyond float where W is 0. */
static void add_windowed_gradient(const field *f, gradient *out, const window_rows *w,
                                  const points *at, uint32_t block)
{
    const matrix3 slope = gradient_polynomial(f);
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], p[3];
        if (w->outside[i] == 1.0f)
            continue;
        points_at(x, at, (size_t)block * POINTS_BLOCK + i);
        field_polynomial(f, p, x);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out->row[a][b][i] += (1.0f - w->outside[i]) * (float)slope.at[a][b] -
                                     (float)p[a] * w->gradient[b][i];
    }
}

/* step := grad phi of one centre, for one kernel. Every lane is computed; the comparison discards
 * what lies beyond. */
#define STEP_OF(NAME)                                                                              \
    static void step_##NAME(float *restrict x, float *restrict y, float *restrict z,               \
                            const block_place *restrict place, pull_of_centre c)                   \
    {                                                                                              \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float dx = place->x[i] - c.at[0], dy = place->y[i] - c.at[1];                          \
            float dz = place->z[i] - c.at[2];                                                      \
            float q = dx * dx + dy * dy + dz * dz;                                                 \
            float inside = slope_##NAME##_f32(sqrtf(q) * c.inverse_radius);                        \
            float slope = q < c.limit ? inside : 0.0f;                                             \
            float scaled = slope * c.inverse_radius * c.inverse_radius;                            \
            x[i] = scaled * dx;                                                                    \
            y[i] = scaled * dy;                                                                    \
            z[i] = scaled * dz;                                                                    \
        }                                                                                          \
    }
STEP_OF(c0)
STEP_OF(c2)
STEP_OF(c4)
STEP_OF(c6)

static void step_of(float step[3][POINTS_BLOCK], const block_place *place, csrbf_kernel kernel,
                    pull_of_centre c)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        step_c0(step[0], step[1], step[2], place, c);
        return;
    case CSRBF_WENDLAND_C4:
        step_c4(step[0], step[1], step[2], place, c);
        return;
    case CSRBF_WENDLAND_C6:
        step_c6(step[0], step[1], step[2], place, c);
        return;
    case CSRBF_WENDLAND_C2:
        break;
    }
    step_c2(step[0], step[1], step[2], place, c);
}

/* phi of one centre */
static void weigh_block(float *weight, const block_place *place, csrbf_kernel kernel,
                        pull_of_centre c)
{
    float q[POINTS_BLOCK];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float dx = place->x[i] - c.at[0], dy = place->y[i] - c.at[1];
        float dz = place->z[i] - c.at[2];
        q[i] = dx * dx + dy * dy + dz * dz;
    }
    kernel_values_f32(kernel, weight, q, c.inverse_radius, c.limit);
}

/* Three rows += pull times step. */
static void add_step(float row[3][POINTS_BLOCK], float step[3][POINTS_BLOCK], float pull)
{
    float *restrict x = row[0], *restrict y = row[1], *restrict z = row[2];
    const float *restrict sx = step[0], *restrict sy = step[1], *restrict sz = step[2];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        x[i] += pull * sx[i];
        y[i] += pull * sy[i];
        z[i] += pull * sz[i];
    }
}

bool LANES(gradient_block)(const field *f, gradient *out, const points *at, uint32_t block)
{
    _Alignas(64) block_place place;
    reach r;
    r.next = 0;
    window_rows window;
    _Alignas(64) float weight[POINTS_BLOCK], step[3][POINTS_BLOCK];
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    memset(out, 0, sizeof *out);
    if (windowed)
        window_open(&window);
    while (reach_more(&r, f, &at->block[block])) {
        if (!reached)
            place_block(&place, f, at, block);
        reached = true;
        for (uint32_t k = 0; k < r.count; ++k) {
            const pull_of_centre c = pull_of(f, r.centre[k]);
            step_of(step, &place, f->settings.kernel, c);
            for (int a = 0; a < 3; ++a)
                add_step(out->row[a], step, c.alpha[a]);
            if (!windowed)
                continue;
            weigh_block(weight, &place, f->settings.kernel, c);
            window_times(&window, weight, step);
        }
    }
    if (f->term_count == 0 || (windowed && !reached))
        return reached;
    if (windowed)
        add_windowed_gradient(f, out, &window, at, block);
    else
        add_global_gradient(f, out);
    return true;
}

/* ---- measures ---- */

void LANES(determinants)(double out[POINTS_BLOCK], const gradient *g)
{
    for (int lane = 0; lane < POINTS_BLOCK; ++lane) {
        double a = 1.0 + (double)g->row[0][0][lane], b = (double)g->row[0][1][lane];
        double c = (double)g->row[0][2][lane], d = (double)g->row[1][0][lane];
        double e = 1.0 + (double)g->row[1][1][lane], f = (double)g->row[1][2][lane];
        double p = (double)g->row[2][0][lane], h = (double)g->row[2][1][lane];
        double i = 1.0 + (double)g->row[2][2][lane];
        out[lane] = a * (e * i - f * h) - b * (d * i - f * p) + c * (d * h - e * p);
    }
}

void LANES(squares)(double out[POINTS_BLOCK], const gradient *g)
{
    for (int lane = 0; lane < POINTS_BLOCK; ++lane) {
        double sum = 0.0;
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                sum += (double)g->row[a][b][lane] * (double)g->row[a][b][lane];
        out[lane] = sum;
    }
}
