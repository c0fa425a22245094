/* mesh/copy.h - meshes and their topology, copied: for whoever works on one beside the stage. Deep.
 * [any] */
#ifndef MAROTTE_MESH_COPY_H
#define MAROTTE_MESH_COPY_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* On error `out` is zeroed. */
CHECKED mrt_result mesh_copy(mesh *out, const mesh *m, error *err);
CHECKED mrt_result topology_copy(topology *out, const topology *t, error *err);

#endif
