#include "csrbf/field.h"

#include "base/pool.h"
#include "csrbf/kernel.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* tolerated rounding noise of float evaluation, as a share of the largest displacement */
static const double noise_ratio = 1e-4;

static size_t up_to_lanes(size_t count)
{
    return (count + FIELD_LANES - 1) / FIELD_LANES * FIELD_LANES;
}

bool field_create(field *out, uint32_t centre_capacity)
{
    size_t room = (size_t)3 * centre_capacity + 1, stride = up_to_lanes(centre_capacity);
    *out = (field){.settings = {.radius = 1.0}, .lanes = lanes_now()};
    out->centre = calloc(room, sizeof *out->centre);
    out->alpha = calloc(room, sizeof *out->alpha);
    out->local_centre = calloc(room, sizeof *out->local_centre);
    out->local_alpha = calloc(room, sizeof *out->local_alpha);
    out->along[0] = calloc(3 * stride + 1, sizeof *out->along[0]);
    out->along[1] = out->along[0] ? out->along[0] + stride : NULL;
    out->along[2] = out->along[1] ? out->along[1] + stride : NULL;
    if (out->centre && out->alpha && out->along[0] && out->local_centre && out->local_alpha)
        return true;
    field_destroy(out);
    return false;
}

void field_destroy(field *f)
{
    if (!f)
        return;
    free(f->centre);
    free(f->alpha);
    free(f->along[0]);
    free(f->local_centre);
    free(f->local_alpha);
    *f = (field){0};
}

/* Returns R^2 minus the error that rounding to float may cause in a squared distance, if the
 * centres are up to `reach` from the origin: 8 roundings of reach + R. phi is below 1e-7 in the
 * part that is cut off. */
static float float_limit(double radius, double reach)
{
    double margin = 8.0 / 16777216.0 * (1.0 + reach / radius);
    double inner = radius * (1.0 - (margin < 0.01 ? margin : 0.01));
    return (float)(inner * inner);
}

void field_begin(field *f)
{
    double reach = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        f->origin[axis] = (float)f->hull.centre[axis];
    for (size_t i = 0; i < f->centre_count; ++i)
        for (size_t axis = 0; axis < 3; ++axis) {
            f->along[axis][i] = f->centre[3 * i + axis];
            double local = f->centre[3 * i + axis] - (double)f->origin[axis];
            f->local_centre[3 * i + axis] = (float)local;
            reach = fabs(local) > reach ? fabs(local) : reach;
        }
    for (size_t i = f->centre_count; i < up_to_lanes(f->centre_count); ++i)
        f->along[0][i] = f->along[1][i] = f->along[2][i] = 1e300;
    f->local_limit = float_limit(f->settings.radius, reach);
    f->needs_double = false;
    memset(f->beta, 0, sizeof f->beta);
    memset(f->alpha, 0, (size_t)3 * f->centre_count * sizeof *f->alpha);
    memset(f->local_alpha, 0, (size_t)3 * f->centre_count * sizeof *f->local_alpha);
}

void field_set_alpha(field *f, const double *alpha, uint32_t stride, double largest_g)
{
    double sum = 0.0;
    for (size_t i = 0; i < f->centre_count; ++i)
        for (size_t axis = 0; axis < 3; ++axis) {
            double value = alpha[i * stride + axis];
            f->alpha[3 * i + axis] = value;
            f->local_alpha[3 * i + axis] = (float)value;
            sum += fabs(value);
        }
    f->needs_double = sum * 0x1p-24 > noise_ratio * largest_g;
}

void field_terms(const field *f, double out_term[4], const double x[3])
{
    double d[3];
    for (int axis = 0; axis < 3; ++axis)
        d[axis] = x[axis] - f->hull.centre[axis];
    out_term[0] = 1.0;
    for (uint32_t a = 1; a < f->term_count; ++a) {
        const double *u = f->hull.axis.at[a - 1];
        out_term[a] = (u[0] * d[0] + u[1] * d[1] + u[2] * d[2]) / f->settings.radius;
    }
}

void field_polynomial(const field *f, double out[3], const double x[3])
{
    double term[4];
    field_terms(f, term, x);
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = 0.0;
        for (uint32_t a = 0; a < f->term_count; ++a)
            out[axis] += f->beta[a][axis] * term[a];
    }
}

double field_limit(const field *f)
{
    return f->settings.radius * f->settings.radius * (1.0 - 0x1p-48);
}

static void displacement_at(const field *f, double out[3], const double x[3])
{
    double radius = f->settings.radius, outside = 1.0, limit = field_limit(f);
    memset(out, 0, 3 * sizeof *out);
    for (size_t i = 0; i < f->centre_count; ++i) {
        const double *c = f->centre + 3 * i, *alpha = f->alpha + 3 * i;
        double dx = x[0] - c[0], dy = x[1] - c[1], dz = x[2] - c[2];
        double q = dx * dx + dy * dy + dz * dz;
        if (q >= limit)
            continue;
        double weight = kernel_value(f->settings.kernel, sqrt(q) / radius);
        outside *= 1.0 - weight;
        for (int axis = 0; axis < 3; ++axis)
            out[axis] += weight * alpha[axis];
    }
    if (f->term_count == 0)
        return;
    double p[3], window = f->settings.polynomial == CSRBF_WINDOWED ? 1.0 - outside : 1.0;
    field_polynomial(f, p, x);
    for (int axis = 0; axis < 3; ++axis)
        out[axis] += window * p[axis];
}

void field_move_f64(const field *f, double *x, uint32_t count)
{
    for (size_t i = 0; i < count; ++i) {
        double d[3];
        displacement_at(f, d, x + 3 * i);
        for (size_t axis = 0; axis < 3; ++axis)
            if (d[axis] != 0.0)
                x[3 * i + axis] += d[axis];
    }
}

/* Returns false if the block is outside of the centre's support, or only touches it. */
static bool field_reaches(const field *f, uint32_t centre, const points_bounds *block)
{
    double radius = f->settings.radius;
    return points_bounds_distance_squared(block, f->centre + (size_t)3 * centre) < radius * radius;
}

static void copy_block(points *out, const points *in, uint32_t block)
{
    size_t first = (size_t)block * POINTS_BLOCK;
    memcpy(out->x + first, in->x + first, POINTS_BLOCK * sizeof(float));
    memcpy(out->y + first, in->y + first, POINTS_BLOCK * sizeof(float));
    memcpy(out->z + first, in->z + first, POINTS_BLOCK * sizeof(float));
    out->block[block] = in->block[block];
}

/* Returns false if d is zero in the whole block. */
static bool field_touches(const field *f, const points_bounds *block)
{
    bool global = f->term_count > 0 && f->settings.polynomial != CSRBF_WINDOWED;
    for (uint32_t centre = 0; centre < f->centre_count; ++centre)
        if (global || field_reaches(f, centre, block))
            return true;
    return false;
}

static bool block_displacement_f64(const field *f, float sum[3][POINTS_BLOCK], const points *in,
                                   uint32_t block)
{
    if (!field_touches(f, &in->block[block]))
        return false;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], d[3];
        points_at(x, in, (size_t)block * POINTS_BLOCK + i);
        displacement_at(f, d, x);
        for (int axis = 0; axis < 3; ++axis)
            sum[axis][i] = (float)d[axis];
    }
    return true;
}

bool field_in_block(const field *f, float sum[3][POINTS_BLOCK], const points *in, uint32_t block)
{
    return f->needs_double ? block_displacement_f64(f, sum, in, block)
                           : f->lanes->field_block(f, sum, in, block);
}

typedef struct move_work {
    const field *f;
    points *out;
    const points *in;
    _Atomic uint32_t moved; /* number of moved blocks */
} move_work;

static void move_blocks(void *data, uint32_t first, uint32_t end)
{
    move_work *w = data;
    uint32_t moved = 0;
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) float sum[3][POINTS_BLOCK];
        if (field_in_block(w->f, sum, w->in, block)) {
            w->f->lanes->columns_add(w->out, w->in, sum, block);
            ++moved;
        } else if (w->out->x != w->in->x) {
            copy_block(w->out, w->in, block);
        }
    }
    atomic_fetch_add_explicit(&w->moved, moved, memory_order_relaxed);
}

double field_cost_ns(const field *f, uint32_t block_count)
{
    double each_ns = f->needs_double ? 6.0 : 0.3;
    return each_ns * POINTS_BLOCK * block_count * f->centre_count;
}

uint32_t field_move(const field *f, points *out, const points *in)
{
    move_work w = {.f = f, .out = out, .in = in};
    const pool_work work = {.run = move_blocks,
                            .data = &w,
                            .part_count = in->block_count,
                            .grain = FIELD_GRAIN,
                            .cost_ns = field_cost_ns(f, in->block_count)};
    pool_run(&work);
    return atomic_load(&w.moved);
}

/* ---- derivative ---- */

matrix3 field_polynomial_gradient(const field *f)
{
    matrix3 out = {{{0.0}}};
    for (uint32_t term = 1; term < f->term_count; ++term)
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out.at[a][b] +=
                    f->beta[term][a] * f->hull.axis.at[term - 1][b] / f->settings.radius;
    return out;
}

/* Adds alpha (x) step, where step is the gradient of one phi. */
static void add_outer(matrix3 *out, const double alpha[3], const double step[3])
{
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            out->at[a][b] += alpha[a] * step[b];
}

/* Returns grad d at one point. */
static matrix3 gradient_at(const field *f, const double x[3])
{
    matrix3 out = {{{0.0}}};
    double radius = f->settings.radius, outside = 1.0, outside_step[3] = {0.0};
    for (size_t i = 0; i < f->centre_count; ++i) {
        const double *c = f->centre + 3 * i;
        double d[3] = {x[0] - c[0], x[1] - c[1], x[2] - c[2]};
        double q = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (q >= field_limit(f))
            continue;
        double weight = kernel_value(f->settings.kernel, sqrt(q) / radius);
        double slope = kernel_slope(f->settings.kernel, sqrt(q) / radius) / radius / radius;
        double step[3] = {slope * d[0], slope * d[1], slope * d[2]};
        add_outer(&out, f->alpha + 3 * i, step);
        for (int axis = 0; axis < 3; ++axis)
            outside_step[axis] = outside_step[axis] * (1.0 - weight) - outside * step[axis];
        outside *= 1.0 - weight;
    }
    if (f->term_count == 0)
        return out;
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED;
    const matrix3 slope = field_polynomial_gradient(f);
    double p[3], window_step[3] = {0.0}, window = windowed ? 1.0 - outside : 1.0;
    field_polynomial(f, p, x);
    for (int axis = 0; axis < 3 && windowed; ++axis)
        window_step[axis] = -outside_step[axis];
    add_outer(&out, p, window_step);
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            out.at[a][b] += window * slope.at[a][b];
    return out;
}

static bool gradient_f64(const field *f, gradient *out, const points *at, uint32_t block)
{
    memset(out, 0, sizeof *out);
    if (!field_touches(f, &at->block[block]))
        return false;
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3];
        points_at(x, at, (size_t)block * POINTS_BLOCK + i);
        const matrix3 m = gradient_at(f, x);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
                out->row[a][b][i] = (float)m.at[a][b];
    }
    return true;
}

/* Returns false if grad d is zero in the whole block; then it is set to zero. */
static bool field_gradient(const field *f, gradient *out, const points *at, uint32_t block)
{
    return f->needs_double ? gradient_f64(f, out, at, block)
                           : f->lanes->gradient_block(f, out, at, block);
}

/* ---- distortion of space ---- */

static const double norm_rounding = 1e-9; /* much more than the rounding of norm_squared */

static uint32_t lanes_of_block(const points *at, uint32_t block)
{
    uint32_t left = at->count - block * POINTS_BLOCK;
    return left < POINTS_BLOCK ? left : POINTS_BLOCK;
}

static matrix3 lane_of(const gradient *from, uint32_t lane)
{
    matrix3 out;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            out.at[a][b] = (double)from->row[a][b][lane];
    return out;
}

/* Returns the square of the largest singular value. */
static double norm_squared(const matrix3 *m)
{
    matrix3 gram;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            gram.at[a][b] =
                m->at[0][a] * m->at[0][b] + m->at[1][a] * m->at[1][b] + m->at[2][a] * m->at[2][b];
    return symmetric3_largest(&gram);
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double smallest_of(const double *value, uint32_t count)
{
    double smallest = value[0];
    for (uint32_t lane = 1; lane < count; ++lane)
        smallest = value[lane] < smallest ? value[lane] : smallest;
    return smallest;
}

/* Returns the larger of `largest` and the squared norms of grad d at the vertices of the block. The
 * sum of squares is an upper bound of a norm, except for norm_rounding. So only vertices with a
 * greater sum are examined, the greatest first: the result does not depend on the order. */
static double larger_norm(const field *f, const gradient *slopes, uint32_t count, double largest)
{
    double square[POINTS_BLOCK];
    uint32_t most = 0;
    f->lanes->squares(square, slopes);
    for (uint32_t lane = 1; lane < count; ++lane)
        most = square[lane] > square[most] ? lane : most;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t lane = (most + i) % count;
        if (square[lane] * (1.0 + norm_rounding) <= largest)
            continue;
        matrix3 g = lane_of(slopes, lane);
        double squared = norm_squared(&g);
        largest = squared > largest ? squared : largest;
    }
    return largest;
}

/* C0 is steepest at its centre, where there is usually a vertex and the gradient does not exist. */
static double cone_slope(const field *f, const points *at)
{
    double largest = 0.0;
    for (uint32_t centre = 0; centre < f->centre_count; ++centre) {
        double slope = 2.0 * length(f->alpha + (size_t)3 * centre) / f->settings.radius;
        bool reached = false;
        for (uint32_t block = 0; !reached && slope > largest && block < at->block_count; ++block)
            reached = field_reaches(f, centre, &at->block[block]);
        largest = reached ? slope : largest;
    }
    return largest;
}

static double determinant_in_block(const field *f, const gradient *slopes, uint32_t count)
{
    double determinant[POINTS_BLOCK];
    f->lanes->determinants(determinant, slopes);
    return smallest_of(determinant, count);
}

typedef struct measure_work {
    const field *f;
    const points *at;
    bool wants_norm, wants_determinant;
    _Atomic double largest, smallest; /* of the norm; of the determinant */
} measure_work;

static void keep_larger(_Atomic double *kept, double value)
{
    double old = atomic_load(kept);
    while (value > old && !atomic_compare_exchange_weak(kept, &old, value))
        continue;
}

static void keep_smaller(_Atomic double *kept, double value)
{
    double old = atomic_load(kept);
    while (value < old && !atomic_compare_exchange_weak(kept, &old, value))
        continue;
}

static void measure_blocks(void *data, uint32_t first, uint32_t end)
{
    measure_work *w = data;
    double smallest = (double)INFINITY, largest = atomic_load(&w->largest);
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) gradient slopes;
        uint32_t count = lanes_of_block(w->at, block);
        double determinant = 1.0;
        bool bent = field_gradient(w->f, &slopes, w->at, block);
        if (bent && w->wants_norm)
            largest = larger_norm(w->f, &slopes, count, largest);
        if (bent && w->wants_determinant)
            determinant = determinant_in_block(w->f, &slopes, count);
        smallest = determinant < smallest ? determinant : smallest;
    }
    keep_larger(&w->largest, largest);
    keep_smaller(&w->smallest, smallest);
}

void field_measure(const field *f, const points *at, double *out_slope, double *out_determinant)
{
    measure_work w = {.f = f,
                      .at = at,
                      .wants_norm = out_slope != NULL,
                      .wants_determinant = out_determinant != NULL,
                      .smallest = (double)INFINITY};
    const pool_work work = {.run = measure_blocks,
                            .data = &w,
                            .part_count = at->block_count,
                            .grain = FIELD_GRAIN,
                            .cost_ns = 2.0 * field_cost_ns(f, at->block_count)};
    pool_run(&work);
    if (out_determinant)
        *out_determinant = at->block_count > 0 ? atomic_load(&w.smallest) : 1.0;
    if (!out_slope)
        return;
    double cone = f->settings.kernel == CSRBF_WENDLAND_C0 ? cone_slope(f, at) : 0.0;
    double slope = sqrt(atomic_load(&w.largest));
    *out_slope = cone > slope ? cone : slope;
}

double field_min_determinant(const field *f, const points *at)
{
    double determinant = 1.0;
    field_measure(f, at, NULL, &determinant);
    return determinant;
}

double field_max_slope(const field *f, const points *at)
{
    double slope = 0.0;
    field_measure(f, at, &slope, NULL);
    return slope;
}

/* For each centre, adds up `weigh` over the centres whose supports can meet its own. Returns the
 * largest sum. */
static double largest_company(const field *f, double (*weigh)(const field *, uint32_t))
{
    double reach = 2.0 * f->settings.radius, largest = 0.0;
    for (uint32_t i = 0; i < f->centre_count; ++i) {
        const double *a = f->centre + (size_t)3 * i;
        double sum = 0.0;
        for (uint32_t j = 0; j < f->centre_count; ++j) {
            const double *b = f->centre + (size_t)3 * j;
            double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
            if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach)
                sum += weigh(f, j);
        }
        largest = sum > largest ? sum : largest;
    }
    return largest;
}

static double weigh_alpha(const field *f, uint32_t centre)
{
    return length(f->alpha + (size_t)3 * centre);
}

static double weigh_one(const field *f, uint32_t centre)
{
    (void)f;
    (void)centre;
    return 1.0;
}

/* Returns the sum of |beta_a| / R over the linear terms. */
static double polynomial_slope(const field *f)
{
    double sum = 0.0;
    for (uint32_t term = 1; term < f->term_count; ++term)
        sum += length(f->beta[term]) / f->settings.radius;
    return sum;
}

/* Returns an upper bound of |p| in the union of supports. */
static double polynomial_size(const field *f)
{
    double reach = 0.0;
    for (uint32_t i = 0; i < f->centre_count; ++i) {
        const double *c = f->centre + (size_t)3 * i, *o = f->hull.centre;
        double d[3] = {c[0] - o[0], c[1] - o[1], c[2] - o[2]};
        reach = length(d) > reach ? length(d) : reach;
    }
    return length(f->beta[0]) + polynomial_slope(f) * (reach + f->settings.radius);
}

double field_slope_bound(const field *f)
{
    double steepest = kernel_steepest(f->settings.kernel) / f->settings.radius;
    double bound = steepest * largest_company(f, weigh_alpha) + polynomial_slope(f);
    if (f->settings.polynomial == CSRBF_WINDOWED)
        bound += polynomial_size(f) * steepest * largest_company(f, weigh_one);
    return bound;
}
