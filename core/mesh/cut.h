/* mesh/cut.h - a mouth for a head that has none: the surface is opened along a chain of edges
 * between the lips, and a dark bag hangs behind them. Leaves out where the lips are (rig_draft.h).
 * [main] */
#ifndef MAROTTE_MESH_CUT_H
#define MAROTTE_MESH_CUT_H
#include "mesh/mesh.h"

enum { MESH_CUT_MAX = 4096 }; /* vertices of a chain */

/* chain: at least four vertices, each joined to the next by an edge of two triangles, none twice,
 * from one corner of the mouth to the other. What the mesh has keeps its number; the lower lip's
 * vertices and the bag's come behind, a part and a material "mouth" too. It is no longer what its
 * file holds: m->path becomes NULL. On error nothing has changed but the note. */
CHECKED mrt_result mesh_cut_mouth(mesh *m, const uint32_t *chain, uint32_t count, error *err);

#endif
