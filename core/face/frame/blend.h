/* face/frame/blend.h - the motion of a point of the face: the motions of several bones, each
 * weighted by its share, as one affine map. Private to this folder. Pure. */
#ifndef MAROTTE_FACE_BLEND_H
#define MAROTTE_FACE_BLEND_H
#include "base/rigid.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct matrix3x3 {
    double at[3][3]; /* rows */
} matrix3x3;

/* x -> x + sum_b share_b (R_b x + t_b - x) */
typedef struct blend {
    matrix3x3 rotation; /* sum_b share_b (R_b - I) */
    vec3 shift;         /* sum_b share_b t_b */
} blend;

static inline blend blend_of(const double *share, const rigid *pose, const bool *moves,
                             uint32_t bone_count)
{
    blend out = {.rotation = {{{0}}}};
    for (uint32_t b = 0; b < bone_count; ++b) {
        if (!moves[b] || share[b] == 0.0)
            continue;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                out.rotation.at[i][j] += share[b] * (pose[b].r[i][j] - (i == j ? 1.0 : 0.0));
        out.shift = vec3_add(out.shift, vec3_scale(pose[b].t, share[b]));
    }
    return out;
}

static inline vec3 matrix3x3_apply(const matrix3x3 *m, vec3 x)
{
    return (vec3){m->at[0][0] * x.x + m->at[0][1] * x.y + m->at[0][2] * x.z,
                  m->at[1][0] * x.x + m->at[1][1] * x.y + m->at[1][2] * x.z,
                  m->at[2][0] * x.x + m->at[2][1] * x.y + m->at[2][2] * x.z};
}

/* Returns row k of an array of rows of three. */
static inline vec3 vec3_row(const double *rows, size_t k)
{
    return (vec3){rows[3 * k], rows[3 * k + 1], rows[3 * k + 2]};
}

static inline void vec3_set_row(double *rows, size_t k, vec3 value)
{
    rows[3 * k] = value.x;
    rows[3 * k + 1] = value.y;
    rows[3 * k + 2] = value.z;
}

/* Returns the displacement of x. */
static inline vec3 blend_moves(const blend *b, vec3 x)
{
    return vec3_add(matrix3x3_apply(&b->rotation, x), b->shift);
}

vec3 blend_apply(const blend *b, vec3 x);
/* Returns x from its moved position. Treats a singular blend as a translation. */
vec3 blend_undo(const blend *b, vec3 moved);
/* The same for a direction by which x was moved before the blend. */
vec3 blend_undo_direction(const blend *b, vec3 direction);

/* Returns false, without setting out, if m is nearly singular: |det| < 1e-6. */
bool matrix3x3_invert(matrix3x3 *out, const matrix3x3 *m);

#endif
