/* face/rig/rig_teeth.h - the collision shape of a row of teeth (rig_proxy, PROXY_TEETH), fitted
 * around the points of its teeth and gums. Inside the room. Pure; any thread. */
#ifndef MAROTTE_FACE_RIG_TEETH_H
#define MAROTTE_FACE_RIG_TEETH_H
#include "face/rig.h"

/* The least row that has the teeth in it, as far back as lips can reach, mm to 0.1. Leaves the bone
 * out. False: too few points, or too flat. */
bool rig_teeth_fit(rig_proxy *out, const vec3 *tooth, uint32_t tooth_count);

#endif
