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
    binding *bound; /* ready made by whoever had the time; NULL: made when it is needed */
    char *note;     /* what a person should know of all three, lines ended by \n; NULL: nothing */
} face_file;

typedef enum face_file_strictness {
    FACE_FILE_USABLE = 0, /* a rig that does not fit its mesh is an error (rig_validate) */
    FACE_FILE_ANY         /* for whoever reports the errors: only files that cannot be read are */
} face_file_strictness;

/* The mesh gets the rig's focus (bind_focus).
 * NAME.rig.json, or a mesh in any format of io/mesh_file.h. `frame` is of a mesh alone (NULL: found
 * out); a rig says its own. Errors name the file, and what in it. */
CHECKED mrt_result face_file_read(face_file *out, const char *path, const mesh_frame *frame,
                                  face_file_strictness strictness, error *err);
void face_file_destroy(face_file *f); /* accepts NULL and zeroed */

/* Opens the mouth of a mesh alone (mesh_cut_mouth). */
CHECKED mrt_result face_file_cut_mouth(face_file *f, const uint32_t *chain, uint32_t count,
                                       error *err);

/* A first rig for a mesh alone (rig_draft_make), which says how its file is read, and has the
 * puppet's expressions and poses that are called as other programs know them, or a line to confirm
 * that says why it has none. Any thread, while nobody changes the mesh. */
CHECKED mrt_result face_file_draft(rig *out, char **out_confirm, const mesh *m, const topology *t,
                                   const char *mesh_path, const uint32_t *cut_mouth,
                                   uint32_t cut_count, error *err);
struct face_weights; /* face/face_weights.h */
/* The names that the face can be said in, found on a face of its own: some 100 ms. What neither its
 * shapes nor its poses say is carried over from the puppet. The file must outlive them. [main], or
 * a worker. */
CHECKED mrt_result face_file_weights(struct face_weights **out, const face_file *f, error *err);

#endif
