/* face/fit_candidates.h - where on a face a contact could be: vertices of skin that are seen from
 * outside, spread evenly, in mirrored pairs or on the midline. Inside the room. [main] */
#ifndef MAROTTE_FACE_FIT_CANDIDATES_H
#define MAROTTE_FACE_FIT_CANDIDATES_H
#include "mesh/mesh.h"

typedef struct fit_candidates {
    uint32_t *vertex; /* vertex_count */
    uint32_t *first;  /* unit_count + 1: unit u is vertex[first[u]] .. vertex[first[u + 1] - 1]: one
                         on the midline, or two that mirror each other */
    uint32_t vertex_count, unit_count;
} fit_candidates;

/* is_skin: vertex_count of m: where a contact may be. interest: vertex_count, > 0: where it is
 * twice as great they lie twice as close. At most unit_capacity units. The plane of symmetry is x =
 * the middle of the skin. A vertex hides when something of the mesh lies less than reach_mm in
 * front of it, along its normal: inside of a mouth, a nostril, a lid. */
CHECKED mrt_result fit_candidates_create(fit_candidates *out, const mesh *m, const uint8_t *is_skin,
                                         const double *interest, uint32_t unit_capacity,
                                         double reach_mm, error *err);
void fit_candidates_destroy(fit_candidates *c); /* accepts zeroed */

#endif
