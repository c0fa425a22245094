/* rigs/puppet/relax.h - spreads the free points of a sheet evenly over the form. Pure; any thread.
 */
#ifndef MAROTTE_RIGS_PUPPET_RELAX_H
#define MAROTTE_RIGS_PUPPET_RELAX_H
#include "sheet.h"

typedef vec3 (*relax_projection)(vec3);

/* Every free point from `first_point` on goes to the mean of its neighbours in the full, mirrored
 * sheet, then is projected (NULL: stays there), `round_count` times in the order of the points.
 * `boldness` 1: to the mean; up to 1.9: beyond it, which settles sooner. */
CHECKED mrt_result relax_points(sheet *s, int32_t first_point, int32_t round_count, double boldness,
                                relax_projection project, error *err);

#endif
