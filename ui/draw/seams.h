/* draw/seams.h - vertices that are one point of one smooth surface although the file has them twice
 * (along seams of texture or material): their normals are joined, so that no seam shows when the
 * surface deforms. Points that merely touch, like closed lips, stay apart. [main] */
#ifndef MAROTTE_UI_DRAW_SEAMS_H
#define MAROTTE_UI_DRAW_SEAMS_H
#include "base/error.h"

typedef struct seams {
    uint32_t *vertex, *leader; /* pair_count each: vertex takes the normal of leader */
    uint32_t pair_count;
} seams;

/* position, normal: vertex_count by 3, at rest; the normals may differ by angles up to that of the
 * cosine. */
CHECKED mrt_result seams_init(seams *out, const float *position, const float *normal,
                              uint32_t vertex_count, float least_cosine, error *err);
void seams_finish(seams *s);
/* Normals as a structure of arrays, unit. */
void seams_join(const seams *s, float *nx, float *ny, float *nz);

#endif
