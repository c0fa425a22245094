/* face/rig_draft.h - a first rig for a mesh that has none, guessed from its shape and the names of
 * its parts. It is for a person to look at and correct: every guess is said. */
#ifndef MAROTTE_FACE_RIG_DRAFT_H
#define MAROTTE_FACE_RIG_DRAFT_H
#include "face/bind.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* The edges between lips that are one surface, for mesh_cut_mouth: a chain of vertices, to be
 * freed; NULL where there is a slit already. Unsupported where no face or no such chain is found.
 */
CHECKED mrt_result rig_draft_mouth(uint32_t **out_chain, uint32_t *out_count, const mesh *m,
                                   const topology *t, error *err);

/* mesh_path: as it can be opened. cut_mouth: what has been opened in the mesh already, or NULL.
 * out_confirm: lines ended by \n, each a thing to confirm, with how sure it is; to be freed. Write
 * it with rig_write: it loads, what would keep it from loading is left out and said. Unsupported
 * where no head is found. It can take seconds; any thread, while nobody changes the mesh. */
CHECKED mrt_result rig_draft_make(rig *out, char **out_confirm, const mesh *m, const topology *t,
                                  const char *mesh_path, const uint32_t *cut_mouth,
                                  uint32_t cut_count, error *err);
/* Replaces the rig's rows of teeth with rows fitted to the upper and lower teeth of the mesh. Adds
 * no row where the mesh has no such teeth, or the rig no skull or jaw. */
CHECKED mrt_result rig_draft_teeth(rig *r, const mesh *m, const topology *t, error *err);
/* Finds the rims of the slit between the lips, for an existing rig. The caller frees the arrays of
 * `out`. A mesh without a slit leaves them NULL and sets why_not to a message. */
CHECKED mrt_result rig_draft_rims(rig_mouth *out, char why_not[BIND_FAULT], const mesh *m,
                                  const topology *t, error *err);
bool rig_draft_is_clay(const rig *drafted); /* its jaw only stretches the skin: no lips part */

#endif
