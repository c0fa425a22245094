#include "csrbf/response.h"

#include "csrbf/kernel.h"

#include <string.h>

/* Some of the centres' responses, solved together. */
typedef struct batch {
    uint32_t first, count;
    const double *alpha; /* centre_count by ENVELOPE_MANY */
    double beta[4][ENVELOPE_MANY];
} batch;

static void values_in_block(const field *f, double *out, uint32_t centre, const points *in,
                            uint32_t block)
{
    const double *c = f->centre + (size_t)3 * centre;
    const double cx = c[0], cy = c[1], cz = c[2];
    const float *x = in->x + (size_t)block * POINTS_BLOCK;
    const float *y = in->y + (size_t)block * POINTS_BLOCK;
    const float *z = in->z + (size_t)block * POINTS_BLOCK;
    double q[POINTS_BLOCK];
    for (int i = 0; i < POINTS_BLOCK; ++i) {
        double dx = (double)x[i] - cx, dy = (double)y[i] - cy, dz = (double)z[i] - cz;
        q[i] = dx * dx + dy * dy + dz * dz;
    }
    double radius = f->settings.radius;
    kernel_values_f64(f->settings.kernel, out, q, 1.0 / radius, field_limit(f));
}

static void add_polynomial(const field *f, const batch *b, double sum[][POINTS_BLOCK],
                           const double *window, const points *in, uint32_t block)
{
    for (size_t i = 0; i < POINTS_BLOCK; ++i) {
        double x[3], term[4];
        points_at(x, in, (size_t)block * POINTS_BLOCK + i);
        field_terms(f, term, x);
        for (uint32_t column = 0; column < b->count; ++column) {
            double p = 0.0;
            for (uint32_t a = 0; a < f->term_count; ++a)
                p += b->beta[a][column] * term[a];
            sum[column][i] += window[i] * p;
        }
    }
}

static void responses_in_block(const field *f, const batch *b, double sum[][POINTS_BLOCK],
                               const points *in, uint32_t block)
{
    double value[POINTS_BLOCK], outside[POINTS_BLOCK], window[POINTS_BLOCK];
    memset(sum, 0, b->count * sizeof *sum);
    for (int i = 0; i < POINTS_BLOCK; ++i)
        outside[i] = 1.0;
    for (uint32_t centre = 0; centre < f->centre_count; ++centre) {
        if (!field_reaches(f, centre, &in->block[block]))
            continue;
        values_in_block(f, value, centre, in, block);
        for (int i = 0; i < POINTS_BLOCK; ++i)
            outside[i] *= 1.0 - value[i];
        const double *alpha = b->alpha + (size_t)ENVELOPE_MANY * centre;
        for (uint32_t column = 0; column < b->count; ++column) {
            const double weight = alpha[column];
            for (int i = 0; i < POINTS_BLOCK; ++i)
                sum[column][i] += value[i] * weight;
        }
    }
    if (f->term_count == 0)
        return;
    bool windowed = f->settings.polynomial == CSRBF_WINDOWED;
    for (int i = 0; i < POINTS_BLOCK; ++i)
        window[i] = windowed ? 1.0 - outside[i] : 1.0;
    add_polynomial(f, b, sum, window, in, block);
}

static void store_block(const merge *m, const batch *b, double sum[][POINTS_BLOCK], float *out,
                        size_t stride, uint32_t block)
{
    for (uint32_t control = 0; control < m->control_count; ++control) {
        uint32_t column = m->group[control] - b->first;
        if (m->group[control] < b->first || column >= b->count)
            continue;
        float *row = out + control * stride + (size_t)block * POINTS_BLOCK;
        for (int i = 0; i < POINTS_BLOCK; ++i)
            row[i] = (float)(sum[column][i] * m->share[control]);
    }
}

void response_fill(const saddle *s, double *alpha, float *out, size_t stride, const points *in,
                   const uint8_t *wanted)
{
    uint32_t centres = s->field.centre_count;
    for (uint32_t first = 0; first < centres; first += ENVELOPE_MANY) {
        batch b = {.first = first, .alpha = alpha};
        b.count = centres - first < ENVELOPE_MANY ? centres - first : ENVELOPE_MANY;
        saddle_solve_units(s, first, alpha, b.beta);
        for (uint32_t block = 0; block < in->block_count; ++block) {
            double sum[ENVELOPE_MANY][POINTS_BLOCK];
            if (!wanted || wanted[block])
                responses_in_block(&s->field, &b, sum, in, block);
            else
                memset(sum, 0, sizeof sum);
            store_block(&s->merge, &b, sum, out, stride, block);
        }
    }
}
