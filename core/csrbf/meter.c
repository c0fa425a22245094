#include "csrbf/meter.h"

#include "base/pool.h"
#include "csrbf/gradient.h"
#include "csrbf/kernel.h"
#include "csrbf/lanes.h"

#include <math.h>
#include <stdatomic.h>

static const double rounding = 1e-9; /* far more than that of norm_squared */

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

/* Square of the largest singular value. */
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

/* The larger of `largest` and the squared norms of grad d at the block's vertices. The sum of
 * squares bounds a norm from above, but for rounding, so only those are looked at that may have
 * more of it, the most first: the result depends on no order. */
static double larger_norm(const field *f, const gradient *slopes, uint32_t count, double largest)
{
    double square[POINTS_BLOCK];
    uint32_t most = 0;
    f->lanes->squares(square, slopes);
    for (uint32_t lane = 1; lane < count; ++lane)
        most = square[lane] > square[most] ? lane : most;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t lane = (most + i) % count;
        if (square[lane] * (1.0 + rounding) <= largest)
            continue;
        matrix3 g = lane_of(slopes, lane);
        double squared = norm_squared(&g);
        largest = squared > largest ? squared : largest;
    }
    return largest;
}

/* C0 is steepest at its tip, where a vertex usually is and the gradient does not exist. */
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
    _Atomic double largest, smallest; /* squared norm; determinant */
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
        bool bent = gradient_of(w->f, &slopes, w->at, block);
        if (bent && w->wants_norm)
            largest = larger_norm(w->f, &slopes, count, largest);
        if (bent && w->wants_determinant)
            determinant = determinant_in_block(w->f, &slopes, count);
        smallest = determinant < smallest ? determinant : smallest;
    }
    keep_larger(&w->largest, largest);
    keep_smaller(&w->smallest, smallest);
}

void meter_measure(const field *f, const points *at, double *out_slope, double *out_determinant)
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

double meter_min_determinant(const field *f, const points *at)
{
    double determinant = 1.0;
    meter_measure(f, at, NULL, &determinant);
    return determinant;
}

double meter_max_slope(const field *f, const points *at)
{
    double slope = 0.0;
    meter_measure(f, at, &slope, NULL);
    return slope;
}

/* Largest sum, over the centres that can meet the support of one, of what `weigh` gives each. */
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

/* sum over the terms of |beta_a| / R, of the linear terms. */
static double polynomial_slope(const field *f)
{
    double sum = 0.0;
    for (uint32_t term = 1; term < f->term_count; ++term)
        sum += length(f->beta[term]) / f->settings.radius;
    return sum;
}

/* Upper bound of |p| in the union of supports. */
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

double meter_slope_bound(const field *f)
{
    double steepest = kernel_steepest(f->settings.kernel) / f->settings.radius;
    double bound = steepest * largest_company(f, weigh_alpha) + polynomial_slope(f);
    if (f->settings.polynomial == CSRBF_WINDOWED)
        bound += polynomial_size(f) * steepest * largest_company(f, weigh_one);
    return bound;
}
