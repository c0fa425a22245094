/* csrbf/tangents.h - normals of an anchored frame without its triangles: two tangents of the
 * surface at each vertex, moved by the derivatives of the unit responses along them; t' = t + sum_k
 * (dB_k / dt) g_k for both, n = t1' x t2', made unit. Those are the normals of the smooth surface
 * that the field makes of the one at rest, whatever the tessellation. All of it is packed
 * (columns_packed.h), which turns a normal by a few thousandths of a degree: a frame reads 4 bytes
 * for each vertex and active control and 12 of the tangents, and writes 12. For the kernels but C0
 * (no derivative at its tip) and all polynomials but the windowed one. The same bits on every
 * instruction set. [frame] all but create/destroy: no allocation. */
#ifndef MAROTTE_CSRBF_TANGENTS_H
#define MAROTTE_CSRBF_TANGENTS_H
#include "csrbf/columns_packed.h"
#include "csrbf/csrbf.h"

#define TANGENTS_UNIT 32767.0f /* in rest: 1 */

typedef struct tangents {
    points first, second;   /* t1, t2 at each vertex of the base: unit, across the normal */
    int16_t *rest;          /* of each block: rows t1.x, t1.y, t1.z, t2.x, t2.y, t2.z */
    columns along1, along2; /* dB_k / dt1, dB_k / dt2 */
    columns_packed packed1, packed2;
} tangents;

CHECKED mrt_result tangents_create(tangents *out, const points *like, uint32_t capacity,
                                   error *err);
void tangents_destroy(tangents *t);

/* False, and nothing has changed: this kernel or polynomial has no such normals. Otherwise takes
 * the derivatives of the factored field at `base` (count controls), whose normals are n
 * (padded_count of each, unit). */
bool tangents_engage(tangents *t, const csrbf_solver *solver, const points *base,
                     const float *const n[3], uint32_t count);
/* n (padded_count each) := the normals of the frame with these displacements (count by 3). +z where
 * the frame squashes the surface. */
void tangents_normals(tangents *t, float *const n[3], const double *displacement);

/* ---- the same in parts ---- */

/* What a frame begins with. displacement: count by 3. */
void tangents_weigh(tangents *t, const double *displacement);
/* tangents_normals in the blocks first .. end - 1 with the displacements taken last; wanted
 * (block_count; NULL: all are): where it is 0 n is left alone. What columns_move_live says of
 * blocks can be given as it is: n is then kept beside `out`, once a call for all blocks has begun
 * it. [any] at the same time for parts that share no block. */
void tangents_normals_blocks(const tangents *t, float *const n[3], const uint8_t *wanted,
                             uint32_t first, uint32_t end);

#endif
