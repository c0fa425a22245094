/* stage/perform/face_file.h - a face from a file: a rig with its mesh, or a mesh alone, ready for
 * face/face.h. [main] */
#ifndef MAROTTE_STAGE_FACE_FILE_H
#define MAROTTE_STAGE_FACE_FILE_H
#include "face/bind.h"
#include "face/rig.h"
#include "io/mesh_file.h"
#include "mesh/topology.h"

typedef struct face_file {
    rig *rig; /* NULL: a mesh alone, which is a valid face */
    mesh mesh;
    topology topology;
    binding *bound; /* binding prepared in advance, for example by a worker thread; NULL: created
                       when needed */
    char *note;     /* notes for the user on all three, lines that end with \n; NULL: none */
} face_file;

typedef enum face_file_strictness {
    FACE_FILE_USABLE = 0, /* a rig that does not fit its mesh is an error (rig_validate) */
    FACE_FILE_ANY /* for callers that report rig errors themselves: only a file that cannot be read
                     is an error */
} face_file_strictness;

/* Reads NAME.rig.json, or a mesh in any format of io/mesh_file.h. The mesh gets the rig's focus
 * (bind_focus). `frame` applies to a mesh without a rig (NULL: detected); a rig contains its own.
 * Errors name the file and the place in it. */
CHECKED mrt_result face_file_read(face_file *out, const char *path, const mesh_frame *frame,
                                  face_file_strictness strictness, error *err);
void face_file_destroy(face_file *f); /* accepts NULL and zeroed */

/* Opens the mouth of a mesh alone (mesh_cut_mouth). */
CHECKED mrt_result face_file_cut_mouth(face_file *f, const uint32_t *chain, uint32_t count,
                                       error *err);

/* Creates a first rig for a mesh alone (rig_draft_make). The rig contains the unit and axes of the
 * mesh file, and the puppet's poses with the names that other programs use (rig_poses_transfer). If
 * the poses cannot be added, a line of out_confirm gives the reason. [any] while no thread changes
 * the mesh. */
CHECKED mrt_result face_file_draft(rig *out, char **out_confirm, const mesh *m, const topology *t,
                                   const char *mesh_path, const uint32_t *cut_mouth,
                                   uint32_t cut_count, error *err);
struct face_weights; /* face/face_weights.h */
/* Finds the named weights that can describe the face (ARKit shapes, visemes). Uses a separate face
 * and takes about 0.3 s. Names that the face has neither as a shape nor as a pose are carried over
 * from the puppet. The file must outlive the result. [main] or a worker thread. */
CHECKED mrt_result face_file_weights(struct face_weights **out, const face_file *f, error *err);

#endif
