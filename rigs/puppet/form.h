/* rigs/puppet/form.h - the head without openings, as a distance: what the skin is relaxed on, and
 * what lips, sockets, brows and ears are set on. x is mirrored. Pure; any thread. */
#ifndef MAROTTE_RIGS_PUPPET_FORM_H
#define MAROTTE_RIGS_PUPPET_FORM_H
#include "base/rigid.h"

/* mm, below 0 inside; good near the surface. */
double form_distance(vec3 p);
/* Unit, outward. */
vec3 form_normal(vec3 p);
/* The surface near p, by steps along the gradient. */
vec3 form_projected(vec3 p);
/* The surface along the line through p; unit direction, outward. */
vec3 form_along(vec3 p, vec3 direction);
/* form_projected, then `lift_mm` outwards. */
vec3 form_lifted(vec3 p, double lift_mm);

static inline vec3 form_mixed(vec3 a, vec3 b, double t)
{
    return vec3_add(vec3_scale(a, 1.0 - t), vec3_scale(b, t));
}

#endif
