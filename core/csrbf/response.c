#include "csrbf/response.h"

#include "base/pool.h"
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

/* Unit responses of the centres first .. r->count - 1 in all blocks, or their derivatives along
 * `direction`. */
typedef struct fill_work {
    const saddle *s;
    lanes_responses responses;
    uint32_t first;
    float *out;
    size_t stride;
    const points *in, *direction;
    const uint8_t *wanted;
} fill_work;

static void fill_blocks(void *data, uint32_t first, uint32_t end)
{
    const fill_work *w = data;
    const field *f = &w->s->field;
    for (uint32_t block = first; block < end; ++block) {
        _Alignas(64) double sum[LANES_RESPONSES][POINTS_BLOCK];
        if (w->wanted && !w->wanted[block])
            memset(sum, 0, sizeof sum);
        else if (w->direction)
            f->lanes->derivatives_block(f, &w->responses, sum, w->in, w->direction, block);
        else
            f->lanes->responses_block(f, &w->responses, sum, w->in, block);
        store_block(&w->s->merge, w->first, w->responses.count, sum, w->out, w->stride, block);
    }
}

/* Each centre's kernel at each vertex, and what it adds to each column. */
static double cost_ns(const fill_work *w)
{
    double each_ns = 1.0 + 0.15 * w->responses.count;
    return each_ns * POINTS_BLOCK * w->in->block_count * w->s->field.centre_count;
}

/* All centres, some at a time. */
static void fill(fill_work *w, double *scratch)
{
    uint32_t centres = w->s->field.centre_count;
    double *alpha = scratch, *half = scratch + (size_t)centres * LANES_RESPONSES;
    for (w->first = 0; w->first < centres; w->first += LANES_RESPONSES) {
        uint32_t left = centres - w->first, count = left < LANES_RESPONSES ? left : LANES_RESPONSES;
        double beta[4][LANES_RESPONSES];
        solve_columns(w->s, w->first, count, alpha, half, beta);
        w->responses = (lanes_responses){
            .alpha = alpha, .stride = LANES_RESPONSES, .count = count, .beta = beta[0]};
        const pool_work work = {.run = fill_blocks,
                                .data = w,
                                .part_count = w->in->block_count,
                                .grain = FIELD_GRAIN,
                                .cost_ns = cost_ns(w)};
        pool_run(&work);
    }
}

void response_fill(const saddle *s, double *scratch, float *out, size_t stride, const points *in,
                   const uint8_t *wanted)
{
    fill(&(fill_work){.s = s, .out = out, .stride = stride, .in = in, .wanted = wanted}, scratch);
}

void response_derive(const saddle *s, double *scratch, columns *out, const points *in,
                     const points *direction)
{
    fill(
        &(fill_work){
            .s = s, .out = out->value, .stride = out->stride, .in = in, .direction = direction},
        scratch);
}
