/* show/pack.h - the faces of a show in a folder beside it, so that it travels: NAME.marotte has
 * NAME.pack, and in it a folder for each face that was performed on, known by its hashes, with
 * every file that the face is read from, under the names that these have for each other, and their
 * SHA-256 in files.json. Sounds, calibrations and what a mapping was are in the show itself.
 *
 * Anybody may have made a pack: nothing in it is unpacked, run or followed. A folder that is a
 * link, a name that leads out of it, a file that is not regular or not what files.json says is
 * refused; what remains is read as any rig or mesh. Any thread that may block. */
#ifndef MAROTTE_TAKE_PACK_H
#define MAROTTE_TAKE_PACK_H
#include "show/take.h"

#include <limits.h>

enum { PACK_FILES_MAX = 256, PACK_BYTES_MAX = 1 << 30 }; /* of a face; of one file of it */

/* The packed face that p was performed on, its files read and compared; MRT_END: the show has no
 * pack. */
CHECKED mrt_result pack_find(char out_face[PATH_MAX], const char *show_path,
                             const take_performance *p, error *err);
/* Puts p's face there, from p->rig. Refused when that is not what it was then, or names files
 * outside of its folder. MRT_END: it is there already. */
CHECKED mrt_result pack_add(const char *show_path, const take_performance *p, error *err);
/* Of all files that a face is read from, by their names and bytes: what is made of it is the same
 * as long as this is. */
CHECKED mrt_result pack_sum(char out[TAKE_HASH], const char *face_path, error *err);
/* p's face from one show's pack into another's. MRT_END: the first has no pack, or the second has
 * it. */
CHECKED mrt_result pack_copy(const char *from_show, const char *to_show, const take_performance *p,
                             error *err);

#endif
