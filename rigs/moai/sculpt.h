/* rigs/moai/sculpt.h - the stone as a function: the shape of a Moai's head, and the wanted fineness
 * of its mesh. Symmetric in x. In mm: x towards the subject's left, y up, z out of the face; y
 * ranges from -150 to 150. Uses only sqrt from libm, so that all machines give the same bits. Pure.
 * [any] */
#ifndef MAROTTE_RIGS_MOAI_SCULPT_H
#define MAROTTE_RIGS_MOAI_SCULPT_H
#include "base/rigid.h"

/* Bounding box of the stone. */
extern const vec3 SCULPT_LOW, SCULPT_HIGH;
/* Ends of the level lines that the mesh should follow (remesh_cut_level). */
enum { SCULPT_LIP_LINE = 0, SCULPT_LINES = 6 };
extern const vec3 SCULPT_LINE_END[SCULPT_LINES];

/* Returns a value below 0 inside the stone; near its surface, about the distance to it. */
double sculpt_distance(vec3 p);
/* The same without the nostrils, which are too fine for a coarse grid. */
double sculpt_rough_distance(vec3 p);
/* Returns the wanted length of edges at p, up to a common factor. */
double sculpt_edge_mm(vec3 p);

#endif
