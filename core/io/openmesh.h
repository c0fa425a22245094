/* io/openmesh.h - OpenMesh behind a C header: the half-edge mesh built from our arrays in file
 * order, for topology. No exception leaves it. [main] */
#ifndef MAROTTE_IO_OPENMESH_H
#define MAROTTE_IO_OPENMESH_H
#include "mesh/mesh.h"
#include "mesh/topology.h"

CHECKED mrt_result openmesh_topology(topology *out, const mesh *m, error *err);

/* OpenMesh's own readers, for formats that mesh_file.h does not read itself. They abort, hang or
 * allocate without end on damaged files: call only in a process that may die (marotte-meshload). */
CHECKED mrt_result openmesh_read_unsafe(mesh *out, const char *path, error *err);

#endif
