/* csrbf/lanes_place.h - where the vertices of a block are as seen from a field, in float, and what
 * one of its centres brings to them. Inline: each file that includes it gets it for its own
 * instruction set. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_LANES_PLACE_H
#define MAROTTE_CSRBF_LANES_PLACE_H
#include "csrbf/field.h"

typedef struct block_place {
    float x[POINTS_BLOCK], y[POINTS_BLOCK], z[POINTS_BLOCK]; /* from the field's origin */
} block_place;

static inline void place_block(block_place *p, const field *f, const points *in, uint32_t block)
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

/* What a centre adds: its place, its alpha, and by what distances are measured. */
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

#endif
