/* Unit responses in one block of vertices, in double. */
#include "csrbf/lanes_variant.h"

#include "csrbf/kernel_rows.h"
#include "csrbf/lanes_reach.h"

#include <string.h>

enum { TOGETHER = 4 };

/* Some centres' kernels at the vertices, and which centres they are. */
typedef struct bundle {
    double value[TOGETHER][POINTS_BLOCK];
    uint32_t centre[TOGETHER];
    uint32_t count;
} bundle;

static void measure(double *restrict out, const field *f, uint32_t centre, const points *in,
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
        double weight[TOGETHER];
        for (uint32_t k = 0; k < b->count; ++k)
            weight[k] = r->alpha[b->centre[k] * r->stride + column];
        if (b->count == TOGETHER)
            add_four(sum[column], b, weight);
        else
            for (uint32_t k = 0; k < b->count; ++k)
                add_one(sum[column], b->value[k], weight[k]);
    }
    b->count = 0;
}

static void narrow_window(double *restrict outside, const double *restrict value)
{
    for (int i = 0; i < POINTS_BLOCK; ++i)
        outside[i] *= 1.0 - value[i];
}

static void add_polynomial(const field *f, const lanes_responses *r, double sum[][POINTS_BLOCK],
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
            measure(value, f, near.centre[k], in, block);
            if (windowed)
                narrow_window(outside, value);
            b.centre[b.count++] = near.centre[k];
            if (b.count == TOGETHER)
                add_bundle(sum, &b, r);
        }
    add_bundle(sum, &b, r);
    if (f->term_count == 0)
        return;
    for (int i = 0; i < POINTS_BLOCK; ++i)
        outside[i] = 1.0 - outside[i];
    add_polynomial(f, r, sum, outside, in, block);
}
