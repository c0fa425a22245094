/* draw/thumbnails.h - which frames of a performance show it best: in each eighth of the clip the
 * one that is furthest from rest. Of a long clip a few dozen of each eighth are looked at. [main]
 * or a worker. */
#ifndef MAROTTE_UI_DRAW_THUMBNAILS_H
#define MAROTTE_UI_DRAW_THUMBNAILS_H
#include "io/clip.h"

enum { THUMBNAILS_MAX = 8 };

typedef struct thumbnail {
    uint32_t frame;
    double distance_mm; /* from rest: root of the mean square over the vertices */
} thumbnail;

/* In time order, one per eighth that has a frame: fewer than eight for clips of fewer frames. The
 * earliest of equals. */
CHECKED mrt_result thumbnails_choose(thumbnail out[THUMBNAILS_MAX], uint32_t *out_count,
                                     const clip *c, error *err);

#endif
