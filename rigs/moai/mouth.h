/* rigs/moai/mouth.h - opens the half skin along the line between the lips and sews a bag behind the
 * slit. The lips meet in the same points, so a closed mouth has no gap. Pure; any thread. */
#ifndef MAROTTE_RIGS_MOAI_MOUTH_H
#define MAROTTE_RIGS_MOAI_MOUTH_H
#include "skin.h"

/* Holds the points of the line where they are, so that their number stays. */
void mouth_hold_line(skin *half);
/* The triangles that the bag behind the line will have. */
CHECKED mrt_result mouth_triangle_count(int32_t *out, const skin *half, error *err);
/* `out`: all of the half, its triangles first, then those of the mouth from *out_first_triangle on.
 * Refuses what is no surface. */
CHECKED mrt_result mouth_open(skin *out, const skin *half, int32_t *out_first_triangle, error *err);

#endif
