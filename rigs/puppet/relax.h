/* rigs/puppet/relax.h - spreads the free points of a sheet over a surface. Pure; any thread. */
#ifndef MAROTTE_RIGS_PUPPET_RELAX_H
#define MAROTTE_RIGS_PUPPET_RELAX_H
#include "sheet.h"

typedef vec3 (*relax_projection)(vec3);

/* EVEN settles far and fast, but folds over sharp bends of fixed lines; AREA has each point drawn
 * by the quads around it, the more the larger they are: it undoes folds, step by step. */
typedef enum relax_pull { RELAX_EVEN = 0, RELAX_AREA } relax_pull;

/* Every free point from `first_point` on goes towards the mean of the middles of its quads, those
 * of the mirrored half too, then is projected (NULL: stays there), `round_count` times in the order
 * of the points. */
CHECKED mrt_result relax_points(sheet *s, int32_t first_point, int32_t round_count, relax_pull pull,
                                relax_projection project, error *err);

#endif
