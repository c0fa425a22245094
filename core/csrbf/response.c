#include "csrbf/response.h"

#include "csrbf/lanes.h"

#include <string.h>

/* Columns first .. first + count - 1 of the centres: each control's that is among them. */
static void store_block(const merge *m, uint32_t first, uint32_t count, double sum[][POINTS_BLOCK],
                        float *out, size_t stride, uint32_t block)
{
    for (uint32_t control = 0; control < m->control_count; ++control) {
        uint32_t column = m->group[control] - first;
        if (m->group[control] < first || column >= count)
            continue;
        float *restrict row = out + control * stride + (size_t)block * POINTS_BLOCK;
        const double *restrict from = sum[column];
        const double share = m->share[control];
        for (int i = 0; i < POINTS_BLOCK; ++i)
            row[i] = (float)(from[i] * share);
    }
}

/* alpha and beta (4 by LANES_RESPONSES) of `count` unit displacements, from centre `first` on. */
static void solve_columns(const saddle *s, uint32_t first, uint32_t count, double *alpha,
                          double *half, double beta[4][LANES_RESPONSES])
{
    for (uint32_t done = 0; done < count; done += ENVELOPE_MANY) {
        double some[4][ENVELOPE_MANY];
        saddle_solve_units(s, first + done, half, some);
        for (size_t i = 0; i < s->field.centre_count; ++i)
            memcpy(alpha + i * LANES_RESPONSES + done, half + i * ENVELOPE_MANY,
                   ENVELOPE_MANY * sizeof *alpha);
        for (int term = 0; term < 4; ++term)
            memcpy(beta[term] + done, some[term], sizeof some[term]);
    }
}

/* Unit responses of all centres, or their derivatives along `direction`, some at a time. */
static void fill(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                 const points *direction, const uint8_t *wanted)
{
    uint32_t centres = s->field.centre_count;
    double *alpha = scratch, *half = scratch + (size_t)centres * LANES_RESPONSES;
    for (uint32_t first = 0; first < centres; first += LANES_RESPONSES) {
        uint32_t left = centres - first, count = left < LANES_RESPONSES ? left : LANES_RESPONSES;
        double beta[4][LANES_RESPONSES];
        solve_columns(s, first, count, alpha, half, beta);
        const lanes_responses r = {
            .alpha = alpha, .stride = LANES_RESPONSES, .count = count, .beta = beta[0]};
        for (uint32_t block = 0; block < in->block_count; ++block) {
            _Alignas(64) double sum[LANES_RESPONSES][POINTS_BLOCK];
            if (wanted && !wanted[block])
                memset(sum, 0, sizeof sum);
            else if (direction)
                s->field.lanes->derivatives_block(&s->field, &r, sum, in, direction, block);
            else
                s->field.lanes->responses_block(&s->field, &r, sum, in, block);
            store_block(&s->merge, first, count, sum, out, stride, block);
        }
    }
}

void response_fill(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                   const uint8_t *wanted)
{
    fill(s, scratch, out, stride, in, NULL, wanted);
}

void response_derive(const saddle *s, double *scratch, columns *out, const points *in,
                     const points *direction)
{
    fill(s, scratch, out->value, out->stride, in, direction, NULL);
}
