/* rigs/moai/mouth.h - opens the half skin along the line between the lips and adds a bag behind the
 * slit. The lips meet in the same points, so a closed mouth has no gap. Pure. [any] */
#ifndef MAROTTE_RIGS_MOAI_MOUTH_H
#define MAROTTE_RIGS_MOAI_MOUTH_H
#include "skin.h"

/* Fixes the points of the line, so that their number cannot change. */
void mouth_hold_line(skin *half);
/* Computes the number of triangles of the bag behind the line. */
CHECKED mrt_result mouth_triangle_count(int32_t *out, const skin *half, error *err);
/* Creates `out`: all triangles of the half, then those of the mouth from *out_first_triangle on.
 * Returns an error if the result is not a surface. */
CHECKED mrt_result mouth_open(skin *out, const skin *half, int32_t *out_first_triangle, error *err);

#endif
