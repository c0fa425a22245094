/* io/read/mesh_frame.h - detects the unit and the axes of a mesh file if they are unknown, and
 * reports them in the mesh's note. Converts the mesh to mm, up +y, forward +z. Does not cover the
 * file formats. Pure. */
#ifndef MAROTTE_IO_MESH_FRAME_H
#define MAROTTE_IO_MESH_FRAME_H
#include "mesh/mesh.h"

/* `given`: the values that the user set; zero: not set. `usual`: those of the format, zero: it has
 * none. Its up axis is y where the format prescribes axes (glTF), z where its files usually have
 * them so (STL). m->up and m->forward: the axes that the file names, or MESH_AXIS_AUTO. */
CHECKED mrt_result mesh_frame_apply(mesh *m, const mesh_frame *given, const mesh_frame *usual,
                                    error *err);

#endif
