/* io/mesh_child.h - reads a mesh file in another process, marotte-meshload, which may crash, hang
 * or eat its memory without harm. The program is found in $MAROTTE_MESHLOAD, beside the running
 * program, or in the build folder. [main], waits up to 10 s. */
#ifndef MAROTTE_IO_MESH_CHILD_H
#define MAROTTE_IO_MESH_CHILD_H
#include "mesh/mesh.h"

CHECKED mrt_result mesh_child_read(mesh *out, const char *path, error *err);

#endif
