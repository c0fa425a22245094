#include "reading.h"

#include "curve.h"
#include "settings.h"

#include <math.h>
#include <stddef.h>

enum { /* sensor order of plugin.h */
       THUMB_ROLL = 0,
       THUMB_MPJ = 1,
       THUMB_IJ = 2,
       THUMB_ABDUCTION = 3,
       INDEX_MPJ = 4,
       INDEX_PIJ = 5,
       MIDDLE_MPJ = 7,
       MIDDLE_PIJ = 8,
       MIDDLE_INDEX_SPREAD = 10,
       RING_MPJ = 11,
       RING_PIJ = 12,
       RING_MIDDLE_SPREAD = 14,
       LITTLE_MPJ = 15,
       LITTLE_PIJ = 16,
       LITTLE_RING_SPREAD = 18,
       PALM_ARCH = 19,
       WRIST_PITCH = 20,
       WRIST_YAW = 21
};
enum { JOINT_WRIST = 0, JOINT_THUMB_TIP = 4, JOINT_INDEX_KNUCKLE = 5, JOINT_MIDDLE_KNUCKLE = 9 };
enum { PALM_HYPOTHENAR = 2, PALM_LITTLE_PAD = 7 };

static const double deg_per_rad = 57.295779513082321;
static const double angle_max_deg = 720.0, distance_max_mm = 2000.0;

typedef struct axes {
    double x[3], y[3], z[3];
} axes;

/* ---- the palm ---- */

static void point_of(double out[3], mrt_vec3 p, uint32_t side)
{
    out[0] = side == MRT_LEFT ? -(double)p.x : (double)p.x;
    out[1] = (double)p.y;
    out[2] = (double)p.z;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool normalise(double a[3])
{
    double length = sqrt(dot(a, a));
    if (!(length > 1e-6))
        return false;
    for (int i = 0; i < 3; ++i)
        a[i] /= length;
    return true;
}

/* z from the wrist to the middle knuckle, x towards the index knuckle; both knuckles stay where
 * they are in the palm whatever the fingers do. A hand of no size: the hand frame's own axes. */
static axes axes_of_palm(const mrt_hand *hand, uint32_t side)
{
    static const axes own = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double wrist[3], index[3], middle[3];
    axes out;
    point_of(wrist, hand->joint[JOINT_WRIST], side);
    point_of(index, hand->joint[JOINT_INDEX_KNUCKLE], side);
    point_of(middle, hand->joint[JOINT_MIDDLE_KNUCKLE], side);
    for (int i = 0; i < 3; ++i)
        out.z[i] = middle[i] - wrist[i];
    if (!normalise(out.z))
        return own;
    for (int i = 0; i < 3; ++i)
        out.x[i] = index[i] - middle[i];
    double along = dot(out.x, out.z);
    for (int i = 0; i < 3; ++i)
        out.x[i] -= along * out.z[i];
    if (!normalise(out.x))
        return own;
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out.y[i] = out.z[j] * out.x[k] - out.z[k] * out.x[j];
    }
    return out;
}

static void seen_from_palm(double out[3], const axes *palm, const double wrist[3], mrt_vec3 p,
                           uint32_t side)
{
    double at[3];
    point_of(at, p, side);
    for (int i = 0; i < 3; ++i)
        at[i] -= wrist[i];
    out[0] = dot(palm->x, at);
    out[1] = dot(palm->y, at);
    out[2] = dot(palm->z, at);
}

bool reading_take(reading *out, const mrt_hand *hand, uint32_t side)
{
    axes palm = axes_of_palm(hand, side);
    double wrist[3], outer[2][3];
    point_of(wrist, hand->joint[JOINT_WRIST], side);
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->value[READING_ANGLES + i] = (double)hand->angle[i] * deg_per_rad;
    for (int finger = 0; finger < 5; ++finger)
        seen_from_palm(out->value + READING_TIPS + 3 * finger, &palm, wrist,
                       hand->joint[JOINT_THUMB_TIP + 4 * finger], side);
    seen_from_palm(outer[0], &palm, wrist, hand->palm[PALM_HYPOTHENAR], side);
    seen_from_palm(outer[1], &palm, wrist, hand->palm[PALM_LITTLE_PAD], side);
    for (int i = 0; i < 3; ++i)
        out->value[READING_PALM + i] = 0.5 * (outer[0][i] + outer[1][i]);
    for (int i = 0; i < READING_COUNT; ++i)
        if (!isfinite(out->value[i]))
            return false;
    return true;
}

void reading_average(reading *mean, const reading *sample, uint32_t count)
{
    for (int i = 0; i < READING_COUNT; ++i)
        mean->value[i] += (sample->value[i] - mean->value[i]) / (double)count;
}

reading reading_difference(const reading *a, const reading *b)
{
    reading out;
    for (int i = 0; i < READING_COUNT; ++i)
        out.value[i] = a->value[i] - b->value[i];
    return out;
}

bool reading_is_plausible(const reading *r)
{
    for (int i = 0; i < READING_COUNT; ++i) {
        double most = i < READING_TIPS ? angle_max_deg : distance_max_mm;
        if (!(r->value[i] >= -most && r->value[i] <= most))
            return false;
    }
    return true;
}

reading_signals reading_signals_of(const reading *difference, const double *params)
{
    const double *a = difference->value + READING_ANGLES;
    reading_signals s;
    s.thumb_drop = params[SET_JAW_ROLL] * a[THUMB_ROLL] - params[SET_JAW_MPJ] * a[THUMB_MPJ] -
                   params[SET_JAW_IJ] * a[THUMB_IJ];
    double along = params[SET_ASIDE_FOLLOW] * s.thumb_drop;
    double explained =
        curve_clamp(a[THUMB_ABDUCTION], along < 0.0 ? along : 0.0, along > 0.0 ? along : 0.0);
    s.thumb_aside = a[THUMB_ABDUCTION] - explained;
    s.index_lift = -a[INDEX_MPJ];
    s.index_middle = a[MIDDLE_MPJ] - a[INDEX_MPJ];
    s.middle_bend = a[MIDDLE_MPJ];
    s.little_lift = -0.5 * (a[RING_MPJ] + a[LITTLE_MPJ]);
    s.ring_little = a[LITTLE_MPJ] - a[RING_MPJ];
    s.spread =
        (a[MIDDLE_INDEX_SPREAD] + a[RING_MIDDLE_SPREAD] + a[LITTLE_RING_SPREAD]) * (1.0 / 3.0);
    s.arch = a[PALM_ARCH];
    s.reach = -0.25 * (a[INDEX_PIJ] + a[MIDDLE_PIJ] + a[RING_PIJ] + a[LITTLE_PIJ]);
    s.wrist_pitch = a[WRIST_PITCH];
    s.wrist_yaw = a[WRIST_YAW];
    return s;
}
