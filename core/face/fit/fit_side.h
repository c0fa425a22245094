/* face/fit/fit_side.h - one way to deform a mesh in a fit: a face with engaged contacts, and its
 * columns summed for least squares. One instance uses the rig, another the paper's method (no rig).
 * Private to this folder. [main] */
#ifndef MAROTTE_FACE_FIT_SIDE_H
#define MAROTTE_FACE_FIT_SIDE_H
#include "face/face.h"
#include "face/fit/fit_solve.h"
#include "mesh/mesh.h"

typedef struct fit_side {
    face *face;
    const binding *binding; /* owned by the face */
    uint32_t contact_count;
    const uint32_t *vertex; /* contact_count: vertices of the contacts */
    vec3 *start;            /* contact_count */
    fit_gram gram;
    fit_solver solver;
    double *pull, *end; /* contact_count by 3 */
} fit_side;

/* Conditions for a control to belong to a bone's field, as in face_engage. */
#define FIT_SHARE_LEAST    0.02f
#define FIT_MOBILITY_LEAST 0.01f

/* Returns `asked`, or the rig's solver settings if `asked` has no radius. */
csrbf_settings fit_side_settings(const rig *r, const csrbf_settings *asked);

/* r NULL: the paper's method. b: ownership passes to the side, on errors too. contact: indices in
 * the rig; vertex: their vertices, must outlive the side. is_skin: vertex_count of m, in file
 * order: the vertices that the sums include. */
CHECKED mrt_result fit_side_create(fit_side *out, const rig *r, const mesh *m, binding *b,
                                   const uint32_t *contact, const uint32_t *vertex,
                                   uint32_t contact_count, const csrbf_settings *settings,
                                   const uint8_t *is_skin, const mesh *targets, double ridge,
                                   error *err);
void fit_side_destroy(fit_side *s); /* accepts zeroed */

/* Fits one target and poses the face with it. out_dof: dof_count of the face's bones. */
CHECKED mrt_result fit_side_solve(fit_side *s, float *out_dof, uint32_t target, error *err);

#endif
