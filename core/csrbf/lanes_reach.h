/* csrbf/lanes_reach.h - which centres reach a block of vertices, many asked at a time. Inline: each
 * file that includes it gets it for its own instruction set. Inside the room. Pure; any thread. */
#ifndef MAROTTE_CSRBF_LANES_REACH_H
#define MAROTTE_CSRBF_LANES_REACH_H
#include "csrbf/field.h"

enum { REACH_BATCH = 64 };

typedef struct reach {
    uint32_t centre[REACH_BATCH]; /* those that reach the block, ascending */
    uint32_t count;
    uint32_t next; /* the centre to ask next */
} reach;

/* Squares of what a centre lacks along one axis to lie between low and high. */
static inline double reach_gap(double low, double high, double at)
{
    double below = low - at, above = at - high;
    double outside = below > above ? below : above;
    outside = outside > 0.0 ? outside : 0.0;
    return outside * outside;
}

/* The next centres that reach the block: field_reaches of each. False: all have been asked, and
 * none is left. Start with next = 0; the rest is better not set, it is large. */
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

#endif
