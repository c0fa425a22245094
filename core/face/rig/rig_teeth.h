/* face/rig/rig_teeth.h - the collision shape of a row of teeth (rig_proxy, PROXY_TEETH), fitted
 * around the points of its teeth and gums. Private to this folder. Pure. [any] */
#ifndef MAROTTE_FACE_RIG_TEETH_H
#define MAROTTE_FACE_RIG_TEETH_H
#include "face/rig.h"

/* Fits the smallest row that contains the teeth, as far back as lips can reach, to 0.1 mm. Does not
 * set the bone. Returns false for too few points, or a flat row. */
bool rig_teeth_fit(rig_proxy *out, const vec3 *tooth, uint32_t tooth_count);

#endif
