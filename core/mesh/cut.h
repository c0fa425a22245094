/* mesh/cut.h - cuts a mouth into a head without one: opens the surface along a chain of edges
 * between the lips, and adds a dark bag behind them. Leaves out finding the lips (rig_draft.h).
 * [main] */
#ifndef MAROTTE_MESH_CUT_H
#define MAROTTE_MESH_CUT_H
#include "mesh/mesh.h"

enum { MESH_CUT_MAX = 4096 }; /* maximum of vertices in a chain */

/* chain: at least four vertices, each joined to the next by an edge of two triangles, without
 * repetition, from one corner of the mouth to the other. Existing vertices keep their numbers;
 * those of the chain move along the surface by less than an edge, so that the lips do not zigzag.
 * The vertices of the lower lip and the bag are appended, with a part and a material "mouth".
 * The mesh no longer equals its file, so m->path becomes NULL. On error nothing has changed
 * except the note. */
CHECKED mrt_result mesh_cut_mouth(mesh *m, const uint32_t *chain, uint32_t count, error *err);

#endif
