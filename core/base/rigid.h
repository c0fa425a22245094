/* base/rigid.h - small vectors and rigid motions in double precision. Right-handed; a rigid motion
 * maps x to R x + t. Uses only +, -, *, / and sqrt, also for rotations (angle.h), so results have
 * the same bits everywhere. Pure. [any] */
#ifndef MAROTTE_BASE_RIGID_H
#define MAROTTE_BASE_RIGID_H
#include <math.h>

typedef struct vec3 {
    double x, y, z;
} vec3;

typedef struct rigid {
    double r[3][3]; /* rows of an orthonormal matrix, determinant 1 */
    vec3 t;
} rigid;

static inline vec3 vec3_add(vec3 a, vec3 b)
{
    return (vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline vec3 vec3_sub(vec3 a, vec3 b)
{
    return (vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline vec3 vec3_scale(vec3 a, double s)
{
    return (vec3){a.x * s, a.y * s, a.z * s};
}

static inline double vec3_dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vec3 vec3_cross(vec3 a, vec3 b)
{
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double vec3_length(vec3 a)
{
    return sqrt(vec3_dot(a, a));
}

/* Returns `fallback` if a is shorter than 1e-300. */
static inline vec3 vec3_normalised(vec3 a, vec3 fallback)
{
    double length = vec3_length(a);
    return length > 1e-300 ? vec3_scale(a, 1.0 / length) : fallback;
}

static inline vec3 rigid_rotate(const rigid *m, vec3 a)
{
    return (vec3){m->r[0][0] * a.x + m->r[0][1] * a.y + m->r[0][2] * a.z,
                  m->r[1][0] * a.x + m->r[1][1] * a.y + m->r[1][2] * a.z,
                  m->r[2][0] * a.x + m->r[2][1] * a.y + m->r[2][2] * a.z};
}

static inline vec3 rigid_apply(const rigid *m, vec3 a)
{
    return vec3_add(rigid_rotate(m, a), m->t);
}

/* Applies b first, then a. */
static inline rigid rigid_compose(const rigid *a, const rigid *b)
{
    rigid out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.r[i][j] =
                a->r[i][0] * b->r[0][j] + a->r[i][1] * b->r[1][j] + a->r[i][2] * b->r[2][j];
    out.t = rigid_apply(a, b->t);
    return out;
}

rigid rigid_identity(void);
rigid rigid_inverse(const rigid *m);
/* Returns a right-handed rotation by angle_rad about the unit direction `axis` through `point`
 * (Rodrigues). */
rigid rigid_turn(vec3 point, vec3 axis, double angle_rad);
/* Return a rotation about a coordinate axis through the origin: the same bits in a fraction of the
 * time. */
rigid rigid_turn_x(double angle_rad);
rigid rigid_turn_y(double angle_rad);
rigid rigid_turn_z(double angle_rad);
/* Converts a quaternion x, y, z, w of any non-zero length (otherwise identity) and a
 * translation. */
rigid rigid_from_quaternion(const double xyzw[4], vec3 t);
/* Returns the unit quaternion x, y, z, w of the rotation; w >= 0. */
void rigid_to_quaternion(const rigid *m, double out_xyzw[4]);

#endif
