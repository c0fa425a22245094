#include "face/frame/blend.h"

static const double singular = 1e-6;

bool matrix3x3_invert(matrix3x3 *out, const matrix3x3 *m)
{
    double cofactor[3][3];
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
            cofactor[i][j] = m->at[a][c] * m->at[b][d] - m->at[a][d] * m->at[b][c];
        }
    double determinant =
        m->at[0][0] * cofactor[0][0] + m->at[0][1] * cofactor[0][1] + m->at[0][2] * cofactor[0][2];
    if (!(determinant > singular || determinant < -singular))
        return false;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out->at[i][j] = cofactor[j][i] / determinant;
    return true;
}

vec3 blend_apply(const blend *b, vec3 x)
{
    return vec3_add(x, blend_moves(b, x));
}

vec3 blend_undo_direction(const blend *b, vec3 direction)
{
    matrix3x3 whole = b->rotation, inverse;
    for (int i = 0; i < 3; ++i)
        whole.at[i][i] += 1.0;
    return matrix3x3_invert(&inverse, &whole) ? matrix3x3_apply(&inverse, direction) : direction;
}

vec3 blend_undo(const blend *b, vec3 moved)
{
    return blend_undo_direction(b, vec3_sub(moved, b->shift));
}
