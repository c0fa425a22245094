/* show/pack.h - copies the faces of a show into a folder beside it, NAME.pack, so that both can be
 * moved together. The pack has a folder for each performed face, identified by its hashes. That
 * folder holds all files of the face, under the names by which they refer to each other, and
 * files.json with their SHA-256. Leaves out sounds, calibrations and mappings: they are in the show
 * itself.
 *
 * A pack may come from an untrusted source: its content is not extracted, executed or followed as a
 * link. Refused are a folder that is a link, a name that leads out of it, a file that is not
 * regular, and a file that differs from files.json. All other files are read like any rig or mesh.
 * Any thread that may block. */
#ifndef MAROTTE_TAKE_PACK_H
#define MAROTTE_TAKE_PACK_H
#include "show/take.h"

#include <limits.h>

enum { PACK_FILES_MAX = 256, PACK_BYTES_MAX = 1 << 30 }; /* files per face; bytes per file */

/* Finds the packed face that p was performed on, and checks its files. MRT_END: the show has no
 * pack. */
CHECKED mrt_result pack_find(char out_face[PATH_MAX], const char *show_path,
                             const take_performance *p, error *err);
/* Adds the face of p to the pack, from p->rig. Fails if that face has changed since, or names files
 * outside its folder. MRT_END: the pack already has it. */
CHECKED mrt_result pack_add(const char *show_path, const take_performance *p, error *err);
/* Hashes the names and bytes of all files of a face. As long as this sum is the same, the face is
 * the same. */
CHECKED mrt_result pack_sum(char out[TAKE_HASH], const char *face_path, error *err);
/* Copies the face of p from one show's pack into another's. MRT_END: the first show has no pack, or
 * the second already has the face. */
CHECKED mrt_result pack_copy(const char *from_show, const char *to_show, const take_performance *p,
                             error *err);

#endif
