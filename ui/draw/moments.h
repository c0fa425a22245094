/* draw/moments.h - which frames of a performance show it best: in each eighth of the clip the one
 * that is furthest from rest. [main] or a worker. */
#ifndef MAROTTE_UI_DRAW_MOMENTS_H
#define MAROTTE_UI_DRAW_MOMENTS_H
#include "io/clip.h"

enum { MOMENTS_MAX = 8 };

typedef struct moment {
    uint32_t frame;
    double distance_mm; /* from rest: root of the mean square over the vertices */
} moment;

/* In time order, one per eighth that has a frame: fewer than eight for clips of fewer frames. The
 * earliest of equals. */
CHECKED mrt_result moments_choose(moment out[MOMENTS_MAX], uint32_t *out_count, const clip *c,
                                  error *err);

#endif
