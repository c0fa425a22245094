/* io/read/mesh_frame.h - the unit and the axes of a mesh file: found out where nobody says them,
 * said in the mesh's note, and the mesh put into mm, up +y, forward +z. Pure. */
#ifndef MAROTTE_IO_MESH_FRAME_H
#define MAROTTE_IO_MESH_FRAME_H
#include "mesh/mesh.h"

/* `given`: what a person says, zeros where nothing. format_mm: the unit that the format has (glTF:
 * 1000); 0: it has none. m->up and m->forward: what the file says, or MESH_AXIS_AUTO. */
CHECKED mrt_result mesh_frame_apply(mesh *m, const mesh_frame *given, double format_mm, error *err);

#endif
