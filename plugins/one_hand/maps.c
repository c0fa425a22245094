#include "maps.h"

#include "mapping.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof *(array)))

static const double rad_per_deg = 0.017453292519943295, deg_per_rad = 57.295779513082321;

/* ---- shapes of the response curves ---- */

static double with_sign(double magnitude, double sign)
{
    return sign < 0.0 ? -magnitude : magnitude;
}

double curve_dead_zone(double x, double dead)
{
    double beyond = fabs(x) - dead;
    if (!(beyond > 0.0))
        return 0.0;
    double out = beyond < dead ? 0.5 * beyond * beyond / dead : beyond - 0.5 * dead;
    return with_sign(out, x);
}

static double limited(double x, double limit)
{
    if (!(x > 0.0) || !(limit > 0.0))
        return 0.0;
    double bend = x - 0.5 * limit;
    if (bend <= 0.0)
        return x;
    return bend >= limit ? limit : x - 0.5 * bend * bend / limit;
}

double curve_limit(double x, double up, double down)
{
    return x < 0.0 ? -limited(-x, down) : limited(x, up);
}

/* Cubic Hermite from (0, from) to (width, to). */
static double hermite(double x, double width, double from, double slope_from, double to,
                      double slope_to)
{
    double t = x / width, t2 = t * t, t3 = t2 * t;
    return from * (2.0 * t3 - 3.0 * t2 + 1.0) + to * (3.0 * t2 - 2.0 * t3) +
           width * (slope_from * (t3 - 2.0 * t2 + t) + slope_to * (t3 - t2));
}

/* Odd, monotone, C1: 0 -> 0, knee_x -> knee_y, 1 and more -> 1 (knees within 0 .. 1). */
static double knee(double x, double knee_x, double knee_y)
{
    double u = fabs(x);
    if (u >= 1.0)
        return with_sign(1.0, x);
    double before = knee_y / knee_x, behind = (1.0 - knee_y) / (1.0 - knee_x);
    double slope = 2.0 * before * behind / (before + behind); /* Fritsch and Carlson: monotone */
    double out = u < knee_x ? hermite(u, knee_x, 0.0, before, knee_y, slope)
                            : hermite(u - knee_x, 1.0 - knee_x, knee_y, slope, 1.0, 0.0);
    return with_sign(out, x);
}

/* ---- reading a hand ---- */

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

static const double angle_max_deg = 720.0, distance_max_mm = 2000.0;

typedef struct palm_axes {
    double x[3], y[3], z[3];
} palm_axes;

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

/* Frame of the palm: z from the wrist to the middle knuckle, x to the index knuckle. Both knuckles
 * keep their place in the palm whatever the fingers do. For a hand of size 0, the axes of the hand
 * frame. */
static palm_axes axes_of_palm(const mrt_hand *hand, uint32_t side)
{
    static const palm_axes own = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double wrist[3], index[3], middle[3];
    palm_axes out;
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

static void seen_from_palm(double out[3], const palm_axes *palm, const double wrist[3], mrt_vec3 p,
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

bool reading_from_hand(reading *out, const mrt_hand *hand, uint32_t side)
{
    palm_axes palm = axes_of_palm(hand, side);
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

/* Combined movements of the fingers, deg, from the difference to the neutral reading. */
typedef struct signals {
    double thumb_drop;   /* stretched and rotated: away from the fingers of a talking hand */
    double thumb_aside;  /* abduction without the part that follows the drop */
    double index_lift;   /* knuckle stretched */
    double index_middle; /* index lifted more than middle */
    double little_lift;  /* ring and little finger, mean */
    double ring_little;  /* ring lifted more than little */
    double spread;       /* mean of the three */
    double arch;
    double reach; /* middle joints stretched, mean of four */
    double wrist_pitch, wrist_yaw;
} signals;
/* params: mrt_frame.params. thumb_aside: the thumb's abduction minus the part that may follow its
 * drop. */
static signals signals_of(const reading *difference, const double *params)
{
    const double *a = difference->value + READING_ANGLES;
    signals s;
    s.thumb_drop = params[SET_JAW_ROLL] * a[THUMB_ROLL] - params[SET_JAW_MPJ] * a[THUMB_MPJ] -
                   params[SET_JAW_IJ] * a[THUMB_IJ];
    double along = params[SET_ASIDE_FOLLOW] * s.thumb_drop;
    double explained =
        clamp(a[THUMB_ABDUCTION], along < 0.0 ? along : 0.0, along > 0.0 ? along : 0.0);
    s.thumb_aside = a[THUMB_ABDUCTION] - explained;
    s.index_lift = -a[INDEX_MPJ];
    s.index_middle = a[MIDDLE_MPJ] - a[INDEX_MPJ];
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

/* ---- the names of a face's parts ---- */

const char *const pose_landmark_names[LANDMARK_COUNT] = {
    "brow.inner.l",
    "brow.inner.r",
    "brow.mid.l",
    "brow.mid.r",
    "brow.outer.l",
    "brow.outer.r",
    "cheek.l",
    "cheek.r",
    "cheek.lower.l",
    "cheek.lower.r",
    "nasolabial.l",
    "nasolabial.r",
    "nose.wing.l",
    "nose.wing.r",
    "mouth.corner.l",
    "mouth.corner.r",
    "lip.upper.side.l",
    "lip.upper.side.r",
    "lip.lower.side.l",
    "lip.lower.side.r",
    "jaw.angle.l",
    "jaw.angle.r",
    "lip.upper.mid",
    "lip.lower.mid",
    "chin",
    "nose.tip",
    "forehead.mid",
};
const char *const pose_dof_names[DOF_COUNT] = {
    "jaw.open",          "jaw.lateral",       "jaw.forward",       "skull.nod",
    "skull.turn",        "eye.l.yaw",         "eye.r.yaw",         "eye.l.pitch",
    "eye.r.pitch",       "lid_upper.l.close", "lid_upper.r.close", "lid_lower.l.close",
    "lid_lower.r.close", "lips.seal",         "tongue.out",
};

int pose_layer(int index)
{
    if (index < POSE_DOFS) {
        int landmark = index / 3;
        return landmark < LANDMARK_CHEEK || landmark == LANDMARK_FOREHEAD_MID ? LAYER_BROWS
                                                                              : LAYER_MOUTH;
    }
    int dof = index - POSE_DOFS;
    if (dof <= DOF_JAW_FORWARD || dof >= DOF_SEAL)
        return LAYER_MOUTH;
    return dof <= DOF_TURN ? LAYER_HEAD : LAYER_BROWS;
}

/* ---- left and right ---- */

static void swap(double *a, double *b)
{
    double kept = *a;
    *a = *b;
    *b = kept;
}

void pose_mirror(pose *p)
{
    for (int landmark = 0; landmark < LANDMARK_FIRST_MID; landmark += 2)
        for (int axis = 0; axis < 3; ++axis)
            swap(&p->value[3 * landmark + axis], &p->value[3 * landmark + 3 + axis]);
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark)
        p->value[3 * landmark] = -p->value[3 * landmark];
    double *dof = p->value + POSE_DOFS;
    for (int pair = DOF_EYE_YAW; pair < DOF_SEAL; pair += 2)
        swap(&dof[pair], &dof[pair + 1]);
    static const int aside[] = {DOF_JAW_LATERAL, DOF_TURN, DOF_EYE_YAW, DOF_EYE_YAW + 1};
    for (int i = 0; i < COUNT_OF(aside); ++i)
        dof[aside[i]] = -dof[aside[i]];
}

static void add_at(pose *p, int landmark, double side, const pose_part *part, double amount)
{
    double *pull = p->value + 3 * landmark;
    pull[0] += side * amount * part->out;
    pull[1] += amount * part->up;
    pull[2] += amount * part->front;
}

static void add_left(pose *p, const pose_part *parts, int count, double amount)
{
    for (int i = 0; i < count; ++i)
        add_at(p, parts[i].landmark, 1.0, &parts[i], amount);
}

static void add_right(pose *p, const pose_part *parts, int count, double amount)
{
    for (int i = 0; i < count; ++i)
        add_at(p, parts[i].landmark + 1, -1.0, &parts[i], amount);
}

/* Points on the midline do not move outwards. */
void pose_add(pose *p, const pose_part *parts, int count, double amount)
{
    for (int i = 0; i < count; ++i) {
        if (parts[i].landmark >= LANDMARK_FIRST_MID) {
            add_at(p, parts[i].landmark, 0.0, &parts[i], amount);
            continue;
        }
        add_left(p, &parts[i], 1, amount);
        add_right(p, &parts[i], 1, amount);
    }
}

/* Coordinates of a face. */
typedef struct pose_axes {
    double jaw_open, jaw_lateral, jaw_forward; /* rad, mm, mm */
    double brow, tilt;                         /* mm up, mm inner up and outer down */
    double lid, squint;                        /* 0 .. 1 */
    double corner, smirk;                      /* mm smile, mm left up and right down */
    double width, sneer, lip;                  /* mm out per side, mm up, mm up */
    double nod, turn, gaze_yaw, gaze_pitch;    /* rad */
} pose_axes;

/* ---- effect of each axis, per mm: directions of the muscles. Neighbouring contacts follow in
 * part, because a contact that is not pulled holds its place ---- */

static const pose_part brow_parts[] = {{LANDMARK_BROW_INNER, 0, 0.85, 0},
                                       {LANDMARK_BROW_MID, 0, 1, 0},
                                       {LANDMARK_BROW_OUTER, 0, 0.75, 0}};
static const pose_part forehead_parts[] = {{LANDMARK_FOREHEAD_MID, 0, 1, 0}};
static const pose_part tilt_parts[] = {{LANDMARK_BROW_INNER, 0, 1, 0},
                                       {LANDMARK_BROW_OUTER, 0, -1, 0}};
static const pose_part smile_parts[] = {
    {LANDMARK_MOUTH_CORNER, 0.55, 0.75, -0.37}, {LANDMARK_NASOLABIAL, 0.25, 0.5, 0.05},
    {LANDMARK_CHEEK_LOWER, 0.3, 0.4, 0},        {LANDMARK_LIP_UPPER_SIDE, 0.3, 0.35, -0.12},
    {LANDMARK_LIP_LOWER_SIDE, 0.3, 0.3, -0.12},
};
static const pose_part smile_cheek_parts[] = {{LANDMARK_CHEEK, 0.2, 0.95, 0.25}};
static const pose_part frown_parts[] = {
    {LANDMARK_MOUTH_CORNER, 0.12, -0.98, -0.15}, {LANDMARK_NASOLABIAL, 0, -0.3, 0},
    {LANDMARK_CHEEK_LOWER, 0, -0.3, 0},          {LANDMARK_LIP_UPPER_SIDE, 0.05, -0.3, 0},
    {LANDMARK_LIP_LOWER_SIDE, 0.05, -0.45, 0},
};
static const pose_part frown_cheek_parts[] = {{LANDMARK_CHEEK, 0, -0.5, 0}};
static const pose_part smirk_parts[] = {
    {LANDMARK_MOUTH_CORNER, 0.3, 0.93, -0.2}, {LANDMARK_NASOLABIAL, 0.1, 0.4, 0},
    {LANDMARK_CHEEK_LOWER, 0.1, 0.35, 0},     {LANDMARK_LIP_UPPER_SIDE, 0.1, 0.4, 0},
    {LANDMARK_LIP_LOWER_SIDE, 0.1, 0.35, 0},
};
static const pose_part wide_parts[] = {
    {LANDMARK_MOUTH_CORNER, 1, 0, -0.35},     {LANDMARK_LIP_UPPER_SIDE, 0.5, 0, -0.15},
    {LANDMARK_LIP_LOWER_SIDE, 0.5, 0, -0.15}, {LANDMARK_NASOLABIAL, 0.3, 0, 0},
    {LANDMARK_CHEEK_LOWER, 0.35, 0, 0},
};
static const pose_part narrow_parts[] = {
    {LANDMARK_MOUTH_CORNER, -1, 0, 0},      {LANDMARK_LIP_UPPER_SIDE, -0.55, 0, 0},
    {LANDMARK_LIP_LOWER_SIDE, -0.55, 0, 0}, {LANDMARK_NASOLABIAL, -0.2, 0, 0},
    {LANDMARK_CHEEK_LOWER, -0.35, 0, 0},
};
static const pose_part protrusion_parts[] = {
    {LANDMARK_LIP_UPPER_MID, 0, 0, 1},    {LANDMARK_LIP_LOWER_MID, 0, 0, 1},
    {LANDMARK_LIP_UPPER_SIDE, 0, 0, 0.8}, {LANDMARK_LIP_LOWER_SIDE, 0, 0, 0.8},
    {LANDMARK_MOUTH_CORNER, 0, 0, 0.6},   {LANDMARK_NASOLABIAL, 0, 0, 0.2},
    {LANDMARK_CHEEK_LOWER, 0, 0, 0.15},
};
static const pose_part sneer_parts[] = {
    {LANDMARK_NOSE_WING, 0.15, 0.7, 0},   {LANDMARK_NASOLABIAL, 0.1, 0.8, 0.1},
    {LANDMARK_LIP_UPPER_SIDE, 0, 0.8, 0}, {LANDMARK_CHEEK, 0.05, 0.6, 0.25},
    {LANDMARK_LIP_UPPER_MID, 0, 0.4, 0},
};
static const pose_part lip_parts[] = {{LANDMARK_LIP_UPPER_MID, 0, 1, 0.1},
                                      {LANDMARK_LIP_UPPER_SIDE, 0, 0.7, 0.05}};

#define ADD(parts, amount) pose_add(out, parts, COUNT_OF(parts), amount)

static void add_corners(pose *out, const pose_axes *axes, const double *params)
{
    double cheek = params[SET_CORNER_CHEEK];
    if (axes->corner >= 0.0) {
        ADD(smile_parts, axes->corner);
        ADD(smile_cheek_parts, cheek * axes->corner);
    } else {
        ADD(frown_parts, -axes->corner);
        ADD(frown_cheek_parts, cheek * -axes->corner);
    }
    add_left(out, smirk_parts, COUNT_OF(smirk_parts), axes->smirk);
    add_right(out, smirk_parts, COUNT_OF(smirk_parts), -axes->smirk);
}

static void add_width(pose *out, const pose_axes *axes, const double *params)
{
    if (axes->width >= 0.0) {
        ADD(wide_parts, axes->width);
    } else {
        ADD(narrow_parts, -axes->width);
        ADD(protrusion_parts, params[SET_PROTRUSION] * -axes->width);
    }
}

static void from_axes(pose *out, const pose_axes *axes, const double *params)
{
    memset(out, 0, sizeof *out);
    ADD(brow_parts, axes->brow);
    ADD(forehead_parts, params[SET_BROW_FOREHEAD] * axes->brow);
    ADD(tilt_parts, axes->tilt);
    add_corners(out, axes, params);
    add_width(out, axes, params);
    ADD(sneer_parts, axes->sneer);
    ADD(lip_parts, axes->lip);
    double *dof = out->value + POSE_DOFS;
    double lower = 0.01 * params[SET_LOWER_LID] * axes->lid + axes->squint;
    dof[DOF_JAW_OPEN] = axes->jaw_open;
    dof[DOF_JAW_LATERAL] = axes->jaw_lateral;
    dof[DOF_JAW_FORWARD] = axes->jaw_forward;
    dof[DOF_NOD] = axes->nod;
    dof[DOF_TURN] = axes->turn;
    for (int side = 0; side < 2; ++side) {
        dof[DOF_EYE_YAW + side] = axes->gaze_yaw;
        dof[DOF_EYE_PITCH + side] = axes->gaze_pitch;
        dof[DOF_LID_UPPER + side] = axes->lid;
        dof[DOF_LID_LOWER + side] = lower;
    }
}

/* ---- muppet+ ---- */

/* params: gain, dead zone, range, starting at `first`. */
static double channel(double signal, const double *params, int first)
{
    double range = params[first + 2];
    return curve_limit(params[first] * curve_dead_zone(signal, params[first + 1]), range, range);
}

/* One-sided channels: on the other side of the dead zone they stay at rest. */
static double upward(double x)
{
    return x > 0.0 ? x : 0.0;
}

static double jaw_open(double drop, const double *params)
{
    double range = params[SET_JAW_RANGE];
    double travel = params[SET_JAW_GAIN] * curve_dead_zone(drop, params[SET_JAW_DEAD]) / range;
    double knee_x = 0.01 * params[SET_JAW_KNEE_TRAVEL], knee_y = 0.01 * params[SET_JAW_KNEE_GAPE];
    return rad_per_deg * range * knee(travel, knee_x, knee_y);
}

static double brow(double lift, const double *params)
{
    return curve_limit(params[SET_BROW_GAIN] * curve_dead_zone(lift, params[SET_BROW_DEAD]),
                       params[SET_BROW_UP], params[SET_BROW_DOWN]);
}

static double corner(double lift, const double *params)
{
    return curve_limit(params[SET_CORNER_GAIN] * curve_dead_zone(lift, params[SET_CORNER_DEAD]),
                       params[SET_CORNER_SMILE], params[SET_CORNER_FROWN]);
}

static double width(double spread, const double *params)
{
    double moved = curve_dead_zone(spread, params[SET_WIDTH_DEAD]);
    double gain = moved < 0.0 ? params[SET_NARROW_GAIN] : params[SET_WIDE_GAIN];
    return curve_limit(gain * moved, params[SET_WIDE_RANGE], params[SET_NARROW_RANGE]);
}

static double head(double wrist, double range_deg, const double *params)
{
    double turned = params[SET_HEAD_GAIN] * curve_dead_zone(wrist, params[SET_HEAD_DEAD]);
    return curve_limit(turned, range_deg, range_deg);
}

double maps_droop(const reading *difference, double intensity, const double *params)
{
    double bend = difference->value[READING_MIDDLE_KNUCKLE];
    double range = params[SET_DROOP_RANGE];
    double percent = curve_limit(
        params[SET_DROOP_GAIN] * curve_dead_zone(bend, params[SET_DROOP_DEAD]), range, range);
    return intensity * 0.01 * percent;
}

void maps_muppet(pose *out, const reading *difference, double intensity, double droop,
                 const double *params)
{
    signals s = signals_of(difference, params);
    double head_up = params[SET_LIP_HEAD] * upward(curve_dead_zone(s.reach, params[SET_LIP_DEAD]));
    double nod_deg = head(s.wrist_pitch, params[SET_HEAD_NOD], params);
    double turn_deg = head(s.wrist_yaw, params[SET_HEAD_TURN], params);
    nod_deg = clamp(nod_deg - head_up, -params[SET_HEAD_NOD], params[SET_HEAD_NOD]);
    double eyes = 0.01 * params[SET_HEAD_EYES] * rad_per_deg;
    pose_axes axes = {
        .jaw_open = jaw_open(s.thumb_drop, params),
        .jaw_lateral = channel(s.thumb_aside, params, SET_ASIDE_GAIN),
        .brow = intensity * brow(s.index_lift, params),
        .tilt = intensity * channel(s.index_middle, params, SET_TILT_GAIN),
        .lid = droop,
        .corner = intensity * corner(s.little_lift, params),
        .smirk = intensity * channel(s.ring_little, params, SET_SMIRK_GAIN),
        .width = intensity * width(s.spread, params),
        .sneer = intensity * upward(channel(s.arch, params, SET_SNEER_GAIN)),
        .lip = upward(channel(s.reach, params, SET_LIP_GAIN)),
        .nod = rad_per_deg * nod_deg,
        .turn = rad_per_deg * turn_deg,
        .gaze_yaw = eyes * turn_deg,
        .gaze_pitch = -eyes * nod_deg,
    };
    from_axes(out, &axes, params);
}

/* ---- mask ---- */

/* Out: across the face, to the subject's left for both sides. */
typedef struct follower {
    int landmark;
    double share;
} follower;

static const follower brow_followers[] = {
    {LANDMARK_BROW_INNER, 0.8}, {LANDMARK_BROW_MID, 1}, {LANDMARK_BROW_OUTER, 0.8}};
static const follower corner_followers[] = {{LANDMARK_MOUTH_CORNER, 1},
                                            {LANDMARK_NASOLABIAL, 0.4},
                                            {LANDMARK_CHEEK_LOWER, 0.4},
                                            {LANDMARK_LIP_UPPER_SIDE, 0.45},
                                            {LANDMARK_LIP_LOWER_SIDE, 0.45}};
static const follower cheek_followers[] = {{LANDMARK_CHEEK, 1}};
static const follower chin_followers[] = {{LANDMARK_CHIN, 1}, {LANDMARK_LIP_LOWER_MID, 0.8}};

static void follow(pose *p, const follower *followers, int count, int side, const double pull[3])
{
    for (int i = 0; i < count; ++i)
        for (int axis = 0; axis < 3; ++axis)
            p->value[3 * (followers[i].landmark + side) + axis] += followers[i].share * pull[axis];
}

/* Scales a point's movement, with a ball as dead zone and a soft limit. */
static void scaled(double out[3], const double *moved, double gain, double most_mm,
                   const double *params)
{
    double length = sqrt(moved[0] * moved[0] + moved[1] * moved[1] + moved[2] * moved[2]);
    double pulled =
        curve_limit(gain * curve_dead_zone(length, params[SET_MASK_DEAD]), most_mm, most_mm);
    for (int axis = 0; axis < 3; ++axis)
        out[axis] = length > 0.0 ? pulled * (moved[axis] / length) : 0.0;
}

/* Limited to the range of brows: beyond it the skin between them and the sockets folds. */
static void pull_brow(pose *p, int side, const double pull[3], const double *params)
{
    double aside_mm = params[SET_MASK_BROW_ASIDE];
    double kept[3] = {curve_limit(pull[0], aside_mm, aside_mm),
                      curve_limit(pull[1], params[SET_BROW_UP], params[SET_BROW_DOWN]),
                      curve_limit(pull[2], aside_mm, aside_mm)};
    follow(p, brow_followers, COUNT_OF(brow_followers), side, kept);
}

/* The thumb holds the jaw by the chin. The jaw makes every movement it can; only the movement up
 * remains for the skin. */
static void pull_jaw(pose *p, const double pull[3], const double *params)
{
    double *dof = p->value + POSE_DOFS;
    double range = rad_per_deg * params[SET_JAW_RANGE];
    double up_mm = curve_limit(upward(pull[1]), params[SET_REACH], params[SET_REACH]);
    double up[3] = {0.0, up_mm, 0.0};
    dof[DOF_JAW_OPEN] = curve_limit(upward(-pull[1]) / params[SET_LEVER], range, range);
    dof[DOF_JAW_LATERAL] = curve_limit(pull[0], params[SET_ASIDE_RANGE], params[SET_ASIDE_RANGE]);
    dof[DOF_JAW_FORWARD] = curve_limit(pull[2], params[SET_ARC_FORWARD], params[SET_ARC_FORWARD]);
    follow(p, chin_followers, COUNT_OF(chin_followers), 0, up);
}

void maps_mask(pose *out, const reading *difference, const double *params)
{
    enum { THUMB, INDEX, MIDDLE, RING, LITTLE };
    enum { LEFT, RIGHT };
    double pull[5][3], palm[3], reach_mm = params[SET_REACH];
    double jaw_mm = rad_per_deg * params[SET_JAW_RANGE] * params[SET_LEVER];
    memset(out, 0, sizeof *out);
    for (int finger = THUMB; finger <= LITTLE; ++finger)
        scaled(pull[finger], difference->value + READING_TIPS + 3 * finger,
               params[SET_MASK_THUMB + finger], finger == THUMB ? 1.5 * jaw_mm : reach_mm, params);
    scaled(palm, difference->value + READING_PALM, params[SET_MASK_PALM], reach_mm, params);
    pull_jaw(out, pull[THUMB], params);
    pull_brow(out, LEFT, pull[INDEX], params);
    pull_brow(out, RIGHT, pull[MIDDLE], params);
    follow(out, corner_followers, COUNT_OF(corner_followers), LEFT, pull[RING]);
    follow(out, corner_followers, COUNT_OF(corner_followers), RIGHT, pull[LITTLE]);
    follow(out, cheek_followers, COUNT_OF(cheek_followers), RIGHT, palm);
    palm[0] = -palm[0];
    follow(out, cheek_followers, COUNT_OF(cheek_followers), LEFT, palm);
}

/* ---- layered waldo ---- */

/* -1 .. 1 over the arc. */
static double along_arc(double signal, int arc, const double *params)
{
    return curve_limit(curve_dead_zone(signal, params[SET_ARC_DEAD]) / params[arc], 1.0, 1.0);
}

/* -1 .. 1 to -down .. up. */
static double spanned(double part, double up, double down)
{
    return part < 0.0 ? part * down : part * up;
}

void maps_waldo(pose *out, const reading *difference, int layer, const double *params)
{
    signals s = signals_of(difference, params);
    double thumb = along_arc(s.thumb_drop, SET_ARC_THUMB, params);
    double index = along_arc(s.index_lift, SET_ARC_INDEX, params);
    double spread = along_arc(s.spread, SET_ARC_SPREAD, params);
    double little = along_arc(s.little_lift, SET_ARC_LITTLE, params);
    double pitch = along_arc(s.wrist_pitch, SET_ARC_WRIST, params);
    double yaw = along_arc(s.wrist_yaw, SET_ARC_WRIST, params);
    pose_axes axes = {0};
    if (layer == LAYER_MOUTH) {
        axes.jaw_open = thumb * rad_per_deg * params[SET_JAW_RANGE];
        axes.lip = upward(index) * params[SET_LIP_RANGE];
        axes.sneer = upward(-index) * params[SET_SNEER_RANGE];
        axes.width = spanned(spread, params[SET_WIDE_RANGE], params[SET_NARROW_RANGE]);
        axes.corner = spanned(little, params[SET_CORNER_SMILE], params[SET_CORNER_FROWN]);
        axes.jaw_lateral = yaw * params[SET_ASIDE_RANGE];
        axes.jaw_forward = pitch * params[SET_ARC_FORWARD];
    } else if (layer == LAYER_BROWS) {
        axes.lid = thumb;
        axes.brow = spanned(index, params[SET_BROW_UP], params[SET_BROW_DOWN]);
        axes.tilt = spread * params[SET_TILT_RANGE];
        axes.squint = upward(little);
        axes.gaze_yaw = yaw * rad_per_deg * params[SET_ARC_GAZE_YAW];
        axes.gaze_pitch = -pitch * rad_per_deg * params[SET_ARC_GAZE_PITCH];
    } else {
        double both = curve_limit(pitch - index, 1.0, 1.0);
        axes.nod = both * rad_per_deg * params[SET_HEAD_NOD];
        axes.turn = yaw * rad_per_deg * params[SET_HEAD_TURN];
    }
    from_axes(out, &axes, params);
}
