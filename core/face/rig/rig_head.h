/* face/rig_head.h - where a head's nose, mouth and chin are, found in its profile: the measures
 * that drafting and checking a rig start from. Right for heads that look along +z with a nose and a
 * chin; a person confirms. Pure but for scratch memory; any thread. */
#ifndef MAROTTE_FACE_RIG_HEAD_H
#define MAROTTE_FACE_RIG_HEAD_H
#include "base/rigid.h"
#include "mesh/mesh.h"

typedef struct rig_head { /* mm */
    double middle_x;      /* the symmetry plane */
    vec3 nose, chin;      /* the tip; the lowest point of the front that is still face */
    double mouth_y, mouth_z;
    double top_y, back_z; /* of what is above the chin */
    double half_width;    /* of the face's front, at the height of the nose */
} rig_head;

/* Unsupported where there is no profile to read. */
CHECKED mrt_result rig_head_measure(rig_head *out, const mesh *m, error *err);

/* Where a ray along -z at x, y meets the mesh first, and the corner nearest to it; false: nowhere.
 */
bool rig_head_hit(vec3 *out_point, uint32_t *out_vertex, const mesh *m, double x, double y);

#endif
