/* face/rig_draft.h - a first rig for a mesh that has none, guessed from its shape and the names of
 * its parts. A person must check and correct it, so every guess is reported. */
#ifndef MAROTTE_FACE_RIG_DRAFT_H
#define MAROTTE_FACE_RIG_DRAFT_H
#include "face/bind.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"

/* Finds the edges between lips that are one surface, for mesh_cut_mouth: a chain of vertices, to be
 * freed; NULL where there is a slit already. *out_is_clear (may be NULL): the lips show a groove,
 * and the edges follow it closely. Unsupported where no face or no such chain is found. */
CHECKED mrt_result rig_draft_mouth(uint32_t **out_chain, uint32_t *out_count, bool *out_is_clear,
                                   const mesh *m, const topology *t, error *err);

/* mesh_path: usable for opening. cut_mouth: the chain that is already cut in the mesh, or NULL.
 * out_confirm: lines that end in \n, each a guess to confirm with its certainty; the caller frees
 * it. Write the draft with rig_write; it can always be loaded. Parts that would prevent this are
 * left out and reported. Unsupported if no head is found. Can take seconds. [any], while no other
 * thread changes the mesh. */
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
bool rig_draft_is_clay(
    const rig *drafted); /* true if the jaw only stretches the skin: the lips do not part */

#endif
