/* rigs/moai/nets.h - the first, even mesh of a shape given as a function, by surface nets: one
 * vertex per grid cell that the surface passes through, one quad per crossed grid edge. */
#ifndef MAROTTE_RIGS_MOAI_NETS_H
#define MAROTTE_RIGS_MOAI_NETS_H
#include "skin.h"

/* Meshes the half x >= 0 of a shape that is symmetric in x and within low..high. Its border is
 * exactly at x = 0 and holds SKIN_MIDDLE. Creates `out` with room for four times as many
 * elements. */
CHECKED mrt_result nets_half(skin *out, double (*distance)(vec3), vec3 low, vec3 high,
                             double cell_mm, error *err);

#endif
