/* rigs/moai/sculpt.h - the stone as a function: the shape of a Moai's head, and how fine a mesh it
 * needs where. Symmetric in x. In mm: x the subject's left, y up, z out of the face; y runs from
 * -150 to 150. No libm but sqrt: the same bits everywhere. Pure; any thread. */
#ifndef MAROTTE_RIGS_MOAI_SCULPT_H
#define MAROTTE_RIGS_MOAI_SCULPT_H
#include "base/rigid.h"

/* The box that holds the stone. */
extern const vec3 SCULPT_LOW, SCULPT_HIGH;
/* Where the level lines end that the mesh should follow (remesh_cut_level). */
enum { SCULPT_LIP_LINE = 0, SCULPT_LINES = 6 };
extern const vec3 SCULPT_LINE_END[SCULPT_LINES];

/* Below 0 inside the stone; near its surface, about the distance to it. */
double sculpt_distance(vec3 p);
/* The same without the nostrils: what a coarse grid can hold. */
double sculpt_rough_distance(vec3 p);
/* The length of edge that the mesh should have at p, up to a common factor. */
double sculpt_edge_mm(vec3 p);

#endif
