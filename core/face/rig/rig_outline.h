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

/* Finds the disc of the head. The head is a large part of the outline in front of another one, and
 * a thinner neck joins the two. Legs, tails and ears are thinner than a head. Uses only the
 * vertices of is_head; low and high are their bounds. Returns false: the mesh is not long enough
 * for an animal, no head stands out, or no memory. */
CHECKED bool rig_outline_find_head(outline_head *out, const mesh *m, const uint8_t *is_head,
                                   vec3 low, vec3 high);

#endif
