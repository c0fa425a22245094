/* face/rig/rig_outline.h - the head of an animal on four legs, found in its outline from the side.
 * The animal looks along +z, with +y up. Pure except for scratch memory. Private to this folder.
 * [any] */
#ifndef MAROTTE_FACE_RIG_OUTLINE_H
#define MAROTTE_FACE_RIG_OUTLINE_H
#include "base/rigid.h"
#include "mesh/mesh.h"

typedef struct outline_head {
    double y, z, radius_mm; /* the largest disc that fits into the head's outline, mm */
    double up_y, up_z;      /* unit vector from the body to the head */
} outline_head;

/* Finds the disc of the head: it lies in front of another large part of the outline, a thinner neck
 * joins the two, and legs, tails and ears are too thin for it. Looks at the vertices of is_head
 * only, which lie between low and high. False: the mesh is not long enough for an animal, no head
 * stands out, or no memory. */
CHECKED bool rig_outline_find_head(outline_head *out, const mesh *m, const uint8_t *is_head,
                                   vec3 low, vec3 high);

#endif
