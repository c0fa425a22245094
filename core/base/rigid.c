#include "base/rigid.h"

#include "base/angle.h"

#include <math.h>

rigid rigid_identity(void)
{
    return (rigid){.r = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

rigid rigid_inverse(const rigid *m)
{
    rigid out;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.r[i][j] = m->r[j][i];
    out.t = vec3_scale(rigid_rotate(&out, m->t), -1.0);
    return out;
}

/* Exact for small angles. */
static double one_minus_cosine(double angle_rad)
{
    double half = angle_sine_of(0.5 * angle_rad);
    return 2.0 * half * half;
}

rigid rigid_turn(vec3 point, vec3 axis, double angle_rad)
{
    double s = angle_sine_of(angle_rad), c1 = one_minus_cosine(angle_rad);
    double u[3] = {axis.x, axis.y, axis.z};
    rigid out = rigid_identity();
    double k[3][3] = {{0, -u[2], u[1]}, {u[2], 0, -u[0]}, {-u[1], u[0], 0}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out.r[i][j] += s * k[i][j] + c1 * (u[i] * u[j] - (i == j ? 1.0 : 0.0));
    out.t = vec3_sub(point, rigid_rotate(&out, point));
    return out;
}

/* 0 + s and 0 - s avoid negative zeros, as in rigid_turn. */
rigid rigid_turn_x(double angle_rad)
{
    double s = angle_sine_of(angle_rad), c = 1.0 - one_minus_cosine(angle_rad);
    return (rigid){.r = {{1, 0, 0}, {0, c, 0.0 - s}, {0, 0.0 + s, c}}};
}

rigid rigid_turn_y(double angle_rad)
{
    double s = angle_sine_of(angle_rad), c = 1.0 - one_minus_cosine(angle_rad);
    return (rigid){.r = {{c, 0, 0.0 + s}, {0, 1, 0}, {0.0 - s, 0, c}}};
}

rigid rigid_turn_z(double angle_rad)
{
    double s = angle_sine_of(angle_rad), c = 1.0 - one_minus_cosine(angle_rad);
    return (rigid){.r = {{c, 0.0 - s, 0}, {0.0 + s, c, 0}, {0, 0, 1}}};
}

rigid rigid_from_quaternion(const double xyzw[4], vec3 t)
{
    double x = xyzw[0], y = xyzw[1], z = xyzw[2], w = xyzw[3];
    double n = x * x + y * y + z * z + w * w;
    rigid out = rigid_identity();
    out.t = t;
    if (!(n > 1e-30))
        return out;
    double s = 2.0 / n;
    out.r[0][0] = 1 - s * (y * y + z * z);
    out.r[0][1] = s * (x * y - z * w);
    out.r[0][2] = s * (x * z + y * w);
    out.r[1][0] = s * (x * y + z * w);
    out.r[1][1] = 1 - s * (x * x + z * z);
    out.r[1][2] = s * (y * z - x * w);
    out.r[2][0] = s * (x * z - y * w);
    out.r[2][1] = s * (y * z + x * w);
    out.r[2][2] = 1 - s * (x * x + y * y);
    return out;
}

/* Shepperd, "Quaternion from rotation matrix" (1978): from the largest of the four. */
void rigid_to_quaternion(const rigid *m, double out_xyzw[4])
{
    const double trace = m->r[0][0] + m->r[1][1] + m->r[2][2];
    double square[4] = {m->r[0][0], m->r[1][1], m->r[2][2], trace};
    int largest = 3;
    for (int i = 0; i < 3; ++i)
        largest = square[i] > square[largest] ? i : largest;
    double q[4];
    if (largest == 3) {
        q[0] = m->r[2][1] - m->r[1][2];
        q[1] = m->r[0][2] - m->r[2][0];
        q[2] = m->r[1][0] - m->r[0][1];
        q[3] = 1.0 + trace;
    } else {
        const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
        q[i] = 1.0 + 2.0 * m->r[i][i] - trace;
        q[j] = m->r[j][i] + m->r[i][j];
        q[k] = m->r[k][i] + m->r[i][k];
        q[3] = m->r[k][j] - m->r[j][k];
    }
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double scale = (q[3] < 0.0 ? -1.0 : 1.0) / length;
    for (int i = 0; i < 4; ++i)
        out_xyzw[i] = scale * q[i];
}
