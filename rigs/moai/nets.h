/* rigs/moai/nets.h - the first, even mesh of a shape given as a function, by surface nets: one
 * vertex per cell of a grid that the surface passes, one quad per crossed edge of the grid. */
#ifndef MAROTTE_RIGS_MOAI_NETS_H
#define MAROTTE_RIGS_MOAI_NETS_H
#include "skin.h"

/* Meshes the half x >= 0 of a shape that is symmetric in x and lies within low..high; its border
 * lies at x = 0 exactly and holds SKIN_MIDDLE. Creates `out` with room for four times as much. */
CHECKED mrt_result nets_half(skin *out, double (*distance)(vec3), vec3 low, vec3 high,
                             double cell_mm, error *err);

#endif
