/* face/fit/fit_side.h - one way of deforming a mesh that is to be fitted: a face with its contacts
 * engaged, and its columns summed up for least squares. The rig's way and the paper's (no rig) are
 * two of these. Inside the room. [main] */
#ifndef MAROTTE_FACE_FIT_SIDE_H
#define MAROTTE_FACE_FIT_SIDE_H
#include "face/face.h"
#include "face/fit/fit_solve.h"
#include "mesh/mesh.h"

typedef struct fit_side {
    face *face;
    const binding *binding; /* the face's */
    uint32_t contact_count;
    const uint32_t *vertex; /* contact_count: where they are */
    vec3 *start;            /* contact_count */
    fit_gram gram;
    fit_solver solver;
    double *pull, *end; /* contact_count by 3 */
} fit_side;

/* What a control needs to be in a bone's field, as in face_engage. */
#define FIT_SHARE_LEAST    0.02f
#define FIT_MOBILITY_LEAST 0.01f

/* The rig's solver settings where `asked` says no radius. */
csrbf_settings fit_side_settings(const rig *r, const csrbf_settings *asked);

/* r NULL: the paper's way. b: taken over, on errors too. contact: indices into the rig, vertex:
 * where they are; vertex must outlive it. is_skin: vertex_count of m, in file order: what the sums
 * are over. */
CHECKED mrt_result fit_side_create(fit_side *out, const rig *r, const mesh *m, binding *b,
                                   const uint32_t *contact, const uint32_t *vertex,
                                   uint32_t contact_count, const csrbf_settings *settings,
                                   const uint8_t *is_skin, const mesh *targets, double ridge,
                                   error *err);
void fit_side_destroy(fit_side *s); /* accepts zeroed */

/* Fits one target and poses the face with it. out_dof: dof_count of the face's bones. */
CHECKED mrt_result fit_side_solve(fit_side *s, float *out_dof, uint32_t target, error *err);

#endif
