/* io/mesh_file.h - any mesh file into one mesh type, in mm. .obj .ply .off .glb .gltf are read here
 * strictly (malformed input is refused with a message that names file, line or element and cause);
 * other formats go through OpenMesh's reader in a limited child process. Non-manifold and
 * degenerate input is accepted with a note. Each parser takes (bytes, size) and is fuzzed. [main]
 */
#ifndef MAROTTE_IO_MESH_FILE_H
#define MAROTTE_IO_MESH_FILE_H
#include "mesh/mesh.h"

/* In mm, up +y, forward +z. `frame`: what a person says of the file's coordinates; NULL, or what it
 * leaves out, is found out and said in the note. glTF is metres, up +y, forward +z (VRM 0: -z),
 * unless no head or body is so tall, or its skeleton or shape clearly says otherwise. Pictures are
 * decoded (in the child process). */
CHECKED mrt_result mesh_file_read(mesh *out, const char *path, const mesh_frame *frame, error *err);

/* The parsers, coordinates as written in the file (mm_per_unit = 1). Messages without file name. */
/* `directory` (with its last '/') is where materials and pictures may be; NULL: none allowed. */
CHECKED mrt_result obj_parse(mesh *out, const void *data, size_t size, const char *directory,
                             mesh_vertices vertices, error *err);
CHECKED mrt_result ply_parse(mesh *out, const void *data, size_t size, error *err);
CHECKED mrt_result off_parse(mesh *out, const void *data, size_t size, error *err);
/* glTF 2.0, .glb or .gltf, VRM 0 and 1; `directory` (with its last '/') is where external buffers
 * may be; NULL: none allowed. Node transforms and skins applied, Draco and meshopt decoded (in the
 * child process). One part per primitive, named by its extras.name when that is a text (as
 * gltf_write_mesh leaves it), else by the node, else by the mesh. */
CHECKED mrt_result gltf_parse(mesh *out, const void *data, size_t size, const char *directory,
                              error *err);

/* Tells each file that an OBJ names and that is there, as its reader finds it: materials, and the
 * pictures of these, named from its folder (with its last '/', or ""); some more than once. */
typedef mrt_result obj_file(void *self, const char *name, error *err);
CHECKED mrt_result obj_files(const void *data, size_t size, const char *directory, obj_file *found,
                             void *self, error *err);

#endif
