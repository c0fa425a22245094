/* bench/bench_plane.h - the planar models of the paper's Table 1 and larger ones, with ten controls
 * laid out such that the pairs of vertex and control within reach match the paper's counts within 2
 * % (research: performance.md A; the paper gives no layout). And the deformation as anybody would
 * write it first, to compare with. */
#ifndef MAROTTE_UI_BENCH_PLANE_H
#define MAROTTE_UI_BENCH_PLANE_H
#include "base/error.h"

enum { BENCH_CONTROLS = 10, BENCH_RADII = 5 };
extern const double bench_radius_mm[BENCH_RADII];
extern const double bench_control[BENCH_CONTROLS * 3]; /* mm */
extern const double bench_pull[BENCH_CONTROLS * 3];    /* mm: displacements */

typedef struct bench_plane {
    float *xyz, *moved; /* vertex_count by 3 */
    uint32_t *triangle; /* triangle_count by 3 */
    uint32_t vertex_count, triangle_count;
} bench_plane;
/* quads a side; has_centres: each quad with a vertex in its middle. */
CHECKED mrt_result bench_plane_create(bench_plane *out, uint32_t quads, bool has_centres,
                                      error *err);
void bench_plane_destroy(bench_plane *self);

uint64_t bench_plane_pairs(const bench_plane *self, double radius_mm);

typedef struct bench_naive { /* one vertex after the other, one control after the other */
    const bench_plane *plane;
    float centre[BENCH_CONTROLS * 3], alpha[BENCH_CONTROLS * 3], radius_mm;
} bench_naive;
void bench_naive_init(bench_naive *out, const bench_plane *plane, double radius_mm); /* solves */
void bench_naive_run(void *naive); /* into plane->moved */

#endif
