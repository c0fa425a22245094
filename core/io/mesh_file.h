/* io/mesh_file.h - reads any mesh file into one mesh type, in mm. .obj .ply .off .glb .gltf have
 * strict readers here: malformed input is refused with an error that names file, line or element,
 * and cause. OpenMesh reads other formats in a limited child process. Non-manifold and degenerate
 * input is accepted with a note. Each parser takes (bytes, size) and is fuzzed. Leaves out writing
 * (export.h). [main] */
#ifndef MAROTTE_IO_MESH_FILE_H
#define MAROTTE_IO_MESH_FILE_H
#include "mesh/mesh.h"

/* Reads a mesh: mm, up +y, forward +z. `frame`: the unit and axes that the user set. Unset ones (or
 * all if NULL) are detected and reported in the note. glTF is in metres, up +y, forward +z (VRM 0:
 * -z), unless no head or body has that height, or the skeleton or shape clearly shows other axes.
 * Pictures are decoded (in the child process). */
CHECKED mrt_result mesh_file_read(mesh *out, const char *path, const mesh_frame *frame, error *err);

/* Parsers. Coordinates are unchanged (mm_per_unit = 1). Errors do not contain the file name. */
/* `directory` (with its last '/'): folder of materials and pictures; NULL: they are skipped. */
CHECKED mrt_result obj_parse(mesh *out, const void *data, size_t size, const char *directory,
                             mesh_vertices vertices, error *err);
CHECKED mrt_result ply_parse(mesh *out, const void *data, size_t size, error *err);
CHECKED mrt_result off_parse(mesh *out, const void *data, size_t size, error *err);
/* glTF 2.0, .glb or .gltf, VRM 0 and 1; `directory` (with its last '/') is the folder of external
 * buffers; NULL: they are refused. Applies node transforms and skins. Decodes Draco and meshopt (in
 * the child process). One part per primitive, named by its extras.name if it is a string
 * (gltf_write_mesh writes it), else by the node, else by the mesh. */
CHECKED mrt_result gltf_parse(mesh *out, const void *data, size_t size, const char *directory,
                              error *err);

/* Calls `found` for each existing file that an OBJ names: materials and their pictures, relative to
 * its folder (with its last '/', or ""). Some are reported more than once. */
typedef mrt_result obj_file(void *self, const char *name, error *err);
CHECKED mrt_result obj_files(const void *data, size_t size, const char *directory, obj_file *found,
                             void *self, error *err);

#endif
