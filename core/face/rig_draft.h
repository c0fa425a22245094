/* face/rig_draft.h - a first rig for a mesh that has none, guessed from its shape and the names of
 * its parts. It is for a person to look at and correct: every guess is said. [main] */
#ifndef MAROTTE_FACE_RIG_DRAFT_H
#define MAROTTE_FACE_RIG_DRAFT_H
#include "face/rig.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* mesh_path: as it can be opened. out_confirm: lines ended by \n, each a thing to confirm, with how
 * sure it is; to be freed. Write it with rig_write: it loads, what would keep it from loading is
 * left out and said. Unsupported where no head is found. */
CHECKED mrt_result rig_draft_make(rig *out, char **out_confirm, const mesh *m, const topology *t,
                                  const char *mesh_path, error *err);

#endif
