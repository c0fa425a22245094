/* Evaluation of a field in one block of vertices: its value and gradient in float, its unit
 * responses in double. Also the matrix of its centres. */
#include "csrbf/field.h"
#include "csrbf/kernel.h"
#include "csrbf/lanes.h"

#include <string.h>

/* ---- the centres that reach a block, tested in batches ---- */

enum { REACH_BATCH = 64 };

typedef struct reach {
    uint32_t centre[REACH_BATCH]; /* those that reach the block, ascending */
    uint32_t count;
    uint32_t next; /* next centre to test */
} reach;

/* Returns the squared distance along one axis from a centre to the interval from low to high. */
static inline double reach_gap(double low, double high, double at)
{
    double below = low - at, above = at - high;
    double outside = below > above ? below : above;
    outside = outside > 0.0 ? outside : 0.0;
    return outside * outside;
}

/* Collects the next centres that reach the block (field_reaches). Returns false if none are left.
 * Start with next = 0, and leave the rest unset, because it is large. */
static inline bool reach_more(reach *r, const field *f, const points_bounds *block)
{
    const double limit = f->settings.radius * f->settings.radius;
    const double lx = (double)block->low[0], hx = (double)block->high[0];
    const double ly = (double)block->low[1], hy = (double)block->high[1];
    const double lz = (double)block->low[2], hz = (double)block->high[2];
    r->count = 0;
    while (r->count == 0 && r->next < f->centre_count) {
        uint32_t left = f->centre_count - r->next;
        uint32_t asked = left < REACH_BATCH ? left : REACH_BATCH;
        const double *x = f->along[0] + r->next, *y = f->along[1] + r->next;
        const double *z = f->along[2] + r->next;
        double square[REACH_BATCH]; /* of the distance to the block */
        for (uint32_t first = 0; first < asked; first += FIELD_LANES)
            for (uint32_t i = first; i < first + FIELD_LANES; ++i) {
                double across = reach_gap(lx, hx, x[i]) + reach_gap(ly, hy, y[i]);
                square[i] = across + reach_gap(lz, hz, z[i]);
            }
        for (uint32_t i = 0; i < asked; ++i) {
            r->centre[r->count] = r->next + i;
            r->count += square[i] < limit;
        }
        r->next += asked;
    }
    return r->count > 0;
}

/* ---- positions of the vertices relative to the field, and contributions of a centre ---- */

typedef struct block_positions {
    float x[POINTS_BLOCK], y[POINTS_BLOCK], z[POINTS_BLOCK]; /* from the field's origin */
} block_positions;

static inline void read_positions(block_positions *p, const field *f, const points *in,
                                  uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    const float *x = in->x + first, *y = in->y + first, *z = in->z + first;
    const float ox = f->origin[0], oy = f->origin[1], oz = f->origin[2];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        p->x[i] = x[i] - ox;
        p->y[i] = y[i] - oy;
        p->z[i] = z[i] - oz;
    }
}

/* The data of one centre: its position, its alpha, and the scale and limit of distances. */
typedef struct pull_of_centre {
    float at[3], alpha[3], inverse_radius, limit;
} pull_of_centre;

static inline pull_of_centre pull_of(const field *f, uint32_t centre)
{
    const float *at = f->local_centre + (size_t)3 * centre;
    const float *alpha = f->local_alpha + (size_t)3 * centre;
    return (pull_of_centre){.at = {at[0], at[1], at[2]},
                            .alpha = {alpha[0], alpha[1], alpha[2]},
                            .inverse_radius = (float)(1.0 / f->settings.radius),
                            .limit = f->local_limit};
}

/* ---- the value, in float ---- */

/* The same for up to TOGETHER centres. */
enum { TOGETHER = 2 };
typedef struct pulls {
    const float *at[TOGETHER], *alpha[TOGETHER]; /* 3 each */
    float inverse_radius, limit;
} pulls;

/* Adds COUNT centres of one kernel, in their order: sum := START + phi alpha, where phi is 0 from
 * the radius on. Two centres per pass: square roots take long, and the two do not depend on each
 * other. */
#define ADD_CENTRES(HOW, NAME, COUNT, START)                                                       \
    static void HOW##_##NAME##_##COUNT(float *restrict sx, float *restrict sy, float *restrict sz, \
                                       const block_positions *restrict position,                   \
                                       const pulls *restrict c)                                    \
    {                                                                                              \
        const float inverse_radius = c->inverse_radius, limit = c->limit;                          \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float x = START(sx[i]), y = START(sy[i]), z = START(sz[i]);                            \
            for (int k = 0; k < COUNT; ++k) {                                                      \
                float dx = position->x[i] - c->at[k][0], dy = position->y[i] - c->at[k][1];        \
                float dz = position->z[i] - c->at[k][2];                                           \
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
                          const block_positions *restrict position, const pulls *restrict c);
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

/* Adds the contributions of the centres in their order. sum may be unset before the first of
 * them. */
static void add_centres(float sum[3][POINTS_BLOCK], bool is_begun, const block_positions *position,
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
        add[count - 1](sum[0], sum[1], sum[2], position, &c);
    }
}

/* window *= 1 - phi of each centre */
static void narrow_window(float *restrict window, const block_positions *position, const field *f,
                          const reach *near)
{
    for (uint32_t k = 0; k < near->count; ++k) {
        const pull_of_centre c = pull_of(f, near->centre[k]);
        float r[POINTS_BLOCK], weight[POINTS_BLOCK];
        for (int i = 0; i < POINTS_BLOCK; ++i) {
            float dx = position->x[i] - c.at[0], dy = position->y[i] - c.at[1];
            float dz = position->z[i] - c.at[2];
            float q = dx * dx + dy * dy + dz * dz;
            float inside = sqrtf(q) * c.inverse_radius;
            r[i] = q < c.limit ? inside : 1.0f;
        }
        kernel_values_at_f32(f->settings.kernel, weight, r);
        for (int i = 0; i < POINTS_BLOCK; ++i)
            window[i] *= 1.0f - weight[i];
    }
}

/* Adds window times p. p may overflow float where window is 0. */
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
    _Alignas(64) block_positions position;
    reach near;
    float window[POINTS_BLOCK];
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED, reached = false;
    near.next = 0;
    for (int i = 0; windowed && i < POINTS_BLOCK; ++i)
        window[i] = 1.0f;
    while (reach_more(&near, f, &in->block[block])) {
        if (!reached)
            read_positions(&position, f, in, block);
        add_centres(sum, reached, &position, f, &near);
        reached = true;
        if (windowed)
            narrow_window(window, &position, f, &near);
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

/* ---- the gradient, in float ---- */

static void add_global_gradient(const field *f, gradient *out)
{
    const matrix3 slope = field_polynomial_gradient(f);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int i = 0; i < POINTS_BLOCK; ++i)
                out->row[a][b][i] += (float)slope.at[a][b];
}

/* The window and its gradient for one block; starts as prod = 1, gradient 0. */
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

/* grad (W p) = W grad p + p grad W. p may overflow float where W is 0. */
static void add_windowed_gradient(const field *f, gradient *out, const window_rows *w,
                                  const points *at, uint32_t block)
{
    const matrix3 slope = field_polynomial_gradient(f);
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

/* step := grad phi of one centre, for one kernel. All lanes are computed; the comparison discards
 * those outside of the support. */
#define STEP_OF(NAME)                                                                              \
    static void step_##NAME(float *restrict x, float *restrict y, float *restrict z,               \
                            const block_positions *restrict position, pull_of_centre c)            \
    {                                                                                              \
        for (int i = 0; i < POINTS_BLOCK; ++i) {                                                   \
            float dx = position->x[i] - c.at[0], dy = position->y[i] - c.at[1];                    \
            float dz = position->z[i] - c.at[2];                                                   \
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

static void step_of(float step[3][POINTS_BLOCK], const block_positions *position,
                    csrbf_kernel kernel, pull_of_centre c)
{
    switch (kernel) {
    case CSRBF_WENDLAND_C0:
        step_c0(step[0], step[1], step[2], position, c);
        return;
    case CSRBF_WENDLAND_C4:
        step_c4(step[0], step[1], step[2], position, c);
        return;
    case CSRBF_WENDLAND_C6:
        step_c6(step[0], step[1], step[2], position, c);
        return;
    case CSRBF_WENDLAND_C2:
        break;
    }
    step_c2(step[0], step[1], step[2], position, c);
}

/* Computes phi of one centre. */
static void weigh_block(float *weight, const block_positions *position, csrbf_kernel kernel,
                        pull_of_centre c)
{
    float q[POINTS_BLOCK];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        float dx = position->x[i] - c.at[0], dy = position->y[i] - c.at[1];
        float dz = position->z[i] - c.at[2];
        q[i] = dx * dx + dy * dy + dz * dz;
    }
    kernel_values_f32(kernel, weight, q, c.inverse_radius, c.limit);
}

/* Adds pull times step to three rows. */
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
    _Alignas(64) block_positions position;
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
            read_positions(&position, f, at, block);
        reached = true;
        for (uint32_t k = 0; k < r.count; ++k) {
            const pull_of_centre c = pull_of(f, r.centre[k]);
            step_of(step, &position, f->settings.kernel, c);
            for (int a = 0; a < 3; ++a)
                add_step(out->row[a], step, c.alpha[a]);
            if (!windowed)
                continue;
            weigh_block(weight, &position, f->settings.kernel, c);
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

/* ---- determinants and norms ---- */

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

/* ---- unit responses, in double ---- */

enum { BUNDLE = 4 };

/* Values of some kernels at the vertices, and the indices of their centres. */
typedef struct bundle {
    double value[BUNDLE][POINTS_BLOCK];
    uint32_t centre[BUNDLE];
    uint32_t count;
} bundle;

static void value_of_centre(double *restrict out, const field *f, uint32_t centre, const points *in,
                            uint32_t block)
{
    const double cx = f->along[0][centre], cy = f->along[1][centre], cz = f->along[2][centre];
    const float *x = in->x + (size_t)block * POINTS_BLOCK;
    const float *y = in->y + (size_t)block * POINTS_BLOCK;
    const float *z = in->z + (size_t)block * POINTS_BLOCK;
    double q[POINTS_BLOCK];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        double dx = (double)x[i] - cx, dy = (double)y[i] - cy, dz = (double)z[i] - cz;
        q[i] = dx * dx + dy * dy + dz * dz;
    }
    kernel_values_f64(f->settings.kernel, out, q, 1.0 / f->settings.radius, field_limit(f));
}

static void add_four(double *restrict sum, const bundle *restrict b, const double *weight)
{
    const double w0 = weight[0], w1 = weight[1], w2 = weight[2], w3 = weight[3];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        double more = sum[i] + b->value[0][i] * w0;
        more = more + b->value[1][i] * w1;
        more = more + b->value[2][i] * w2;
        sum[i] = more + b->value[3][i] * w3;
    }
}

static void add_one(double *restrict sum, const double *restrict value, double weight)
{
    for (int i = 0; i < POINTS_BLOCK; ++i)
        sum[i] += value[i] * weight;
}

/* Adds the bundle to all columns, its centres in their order, and empties it. */
static void add_bundle(double sum[][POINTS_BLOCK], bundle *b, const lanes_responses *r)
{
    for (uint32_t column = 0; column < r->count; ++column) {
        double weight[BUNDLE];
        for (uint32_t k = 0; k < b->count; ++k)
            weight[k] = r->alpha[b->centre[k] * r->stride + column];
        if (b->count == BUNDLE)
            add_four(sum[column], b, weight);
        else
            for (uint32_t k = 0; k < b->count; ++k)
                add_one(sum[column], b->value[k], weight[k]);
    }
    b->count = 0;
}

static void narrow_window_f64(double *restrict outside, const double *restrict value)
{
    for (int i = 0; i < POINTS_BLOCK; ++i)
        outside[i] *= 1.0 - value[i];
}

static void add_polynomials(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
                            const double *window, const points *in, uint32_t block)
{
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], term[4];
        points_at(x, in, (size_t)block * POINTS_BLOCK + i);
        field_terms(f, term, x);
        for (uint32_t column = 0; column < r->count; ++column) {
            double p = 0.0;
            for (uint32_t a = 0; a < f->term_count; ++a)
                p += r->beta[a * r->stride + column] * term[a];
            sum[column][i] += window[i] * p;
        }
    }
}

void LANES(responses_block)(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
                            const points *in, uint32_t block)
{
    double outside[POINTS_BLOCK];
    bundle b;
    reach near;
    near.next = 0;
    b.count = 0;
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED;
    memset(sum, 0, r->count * sizeof *sum);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        outside[i] = windowed ? 1.0 : 0.0;
    while (reach_more(&near, f, &in->block[block]))
        for (uint32_t k = 0; k < near.count; ++k) {
            double *value = b.value[b.count];
            value_of_centre(value, f, near.centre[k], in, block);
            if (windowed)
                narrow_window_f64(outside, value);
            b.centre[b.count++] = near.centre[k];
            if (b.count == BUNDLE)
                add_bundle(sum, &b, r);
        }
    add_bundle(sum, &b, r);
    if (f->term_count == 0)
        return;
    for (int i = 0; i < POINTS_BLOCK; ++i)
        outside[i] = 1.0 - outside[i];
    add_polynomials(f, r, sum, outside, in, block);
}

/* ---- the matrix: kernels between all pairs of centres, in double ---- */

enum { BATCH = 64 };

/* Computes distances over the radius from centre `row` to `count` others. */
static void measure_row(double *restrict out, const field *f, uint32_t row, uint32_t first,
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

/* A cheaper test than measure_row: true if any of them is in the support of `row`, and rarely true
 * if none is. */
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
        measure_row(r, f, row, first, count);
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

static void fill_row(double *restrict out, const double *restrict r, csrbf_kernel kernel,
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
        measure_row(r, f, row, first, count);
        fill_row(out, r, f->settings.kernel, count);
    }
}
