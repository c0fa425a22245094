#include "hand/hand.h"

#include "base/angle.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- from counts to angles ---- */

static void expect_all_distal(hand_calibration *out)
{
    for (int i = 0; i < SENSOR_DISTAL_COUNT; ++i)
        out->has_distal[i] = true;
}

static void expect_usual_neutral(hand_calibration *out)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        out->neutral_rad[i] = sensor_table[i].neutral_rad;
}

void hand_calibration_identity(hand_calibration *out)
{
    memset(out, 0, sizeof *out);
    expect_all_distal(out);
    expect_usual_neutral(out);
}

void hand_calibration_default(hand_calibration *out)
{
    static const float raw_end[2] = {1.0f, 255.0f}; /* range of a sensor byte */
    memset(out, 0, sizeof *out);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const sensor_facts *g = &sensor_table[i];
        hand_table *table = &out->sensor[i];
        table->count = 2;
        for (int k = 0; k < 2; ++k) {
            table->raw[k] = raw_end[k];
            table->rad[k] = g->gain * (raw_end[k] - g->zero) + g->rad_at_zero;
        }
    }
    expect_all_distal(out);
    expect_usual_neutral(out);
}

/* Joints cannot turn by more than half a turn. Larger angles of a damaged table or sensor are
 * clamped to that. */
static double within_half_turn(double angle_rad)
{
    return fmin(fmax(angle_rad, -ANGLE_PI), ANGLE_PI);
}

double hand_table_value(const hand_table *table, double raw)
{
    uint32_t count = table->count < HAND_TABLE_MAX ? table->count : HAND_TABLE_MAX;
    if (count == 0)
        return raw;
    if (count == 1)
        return (double)table->rad[0];
    uint32_t k = 0;
    while (k + 2 < count && raw >= (double)table->raw[k + 1])
        ++k;
    double raw_0 = (double)table->raw[k], raw_1 = (double)table->raw[k + 1];
    double rad_0 = (double)table->rad[k], rad_1 = (double)table->rad[k + 1];
    double width = raw_1 - raw_0;
    return width > 0.0 ? rad_0 + (raw - raw_0) * ((rad_1 - rad_0) / width) : rad_0;
}

static double middle_raw(const hand_table *table)
{
    uint32_t count = table->count < HAND_TABLE_MAX ? table->count : HAND_TABLE_MAX;
    return count == 0 ? 0.0 : 0.5 * ((double)table->raw[0] + (double)table->raw[count - 1]);
}

/* The same formula as in VirtualHand for gloves of 18 sensors (hardware.md 2.2); 90 degrees give
 * 30. A middle joint that is bent backwards, on the other branch of the parabola, does not bend the
 * end joint. */
float hand_distal_from_middle(float middle_rad)
{
    double middle = fmax((double)middle_rad, 0.0);
    return (float)fmax(0.32 * middle * middle - 0.17 * middle, 0.0);
}

void hand_calibrate(const hand_calibration *calibration, const float *raw, float *out_rad)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const hand_table *table = &calibration->sensor[i];
        double value = isfinite(raw[i]) ? (double)raw[i] : middle_raw(table);
        double rad = hand_table_value(table, value);
        out_rad[i] = isfinite(rad) ? (float)within_half_turn(rad) : 0.0f;
    }
    for (int i = 0; i < SENSOR_DISTAL_COUNT; ++i)
        if (!calibration->has_distal[i])
            out_rad[sensor_distal[i]] = hand_distal_from_middle(out_rad[sensor_middle[i]]);
}

/* ---- from angles to fingertips ---- */

/* The linked structure of the paper: a Parent (the wrist), one PalmJoint per finger, which the palm
 * carries, and Joints down to the fingertip. A node only stores its place in its parent in the
 * default shape. The default shape is a flat right hand, with straight, parallel fingers and the
 * thumb in the plane of the palm. Poses are computed from it, and not stored. */
typedef enum node_kind { NODE_PARENT = 0, NODE_PALM_JOINT, NODE_JOINT, NODE_THUMB } node_kind;

enum { JOINT_NONE = -1, NODE_MAX = 32, FINGER_COUNT = 5, PALM_POINTS = MRT_PALM };

typedef struct node {
    node_kind kind;
    vec3 offset_mm;     /* from the parent's origin, in the parent's axes */
    int flexion_sensor; /* about x, towards the palm; SENSOR_NONE: does not bend */
    double arch_share;  /* PalmJoint: share of the arch that turns it */
    double spread[3];   /* Joint: share of each spread sensor in its rotation towards the thumb */
    int joint;          /* index of the MRT_JOINTS at its origin, or JOINT_NONE */
    const struct node *first_child, *next_sibling;
} node;

typedef struct palm_point {
    const node *carrier; /* the node in whose frame it moves */
    vec3 offset_mm;
} palm_point;

struct hand_skeleton {
    uint32_t side;
    uint32_t node_count;
    node node[NODE_MAX]; /* node[0] is the Parent */
    palm_point palm[PALM_POINTS];
};

/* ---- the default shape ---- */

/* research/hardware.md 2.3, mm, for a hand of 206.39 mm from wrist to middle fingertip. The table
 * does not give the place of the wrist; it is 100 mm behind the middle knuckle. All lengths are
 * scaled by hand length / 206.39. */
static const double TABLE_LENGTH_MM = 206.39;

/* The place of the thumb's base is a compromise. The table has (10, -23, 5), with inferred axes.
 * The planar skeleton of the recordings (data/README.md) has (27, 0, 31). */
static const struct finger {
    vec3 base;
    double bone_mm[3];
    int mpj_sensor;
    double arch_share;
    double spread[3]; /* of middle-index, ring-middle, little-ring; + turns towards the thumb */
} fingers[FINGER_COUNT] = {
    {{20.0, -12.0, 12.0}, {52.12, 40.76, 30.0}, SENSOR_THUMB_MPJ, 0, {0, 0, 0}},
    {{28.0, 0.0, 94.4}, {43.19, 29.56, 25.35}, SENSOR_INDEX_MPJ, 0, {1, 0, 0}},
    {{0.0, 0.0, 100.0}, {46.20, 30.99, 29.20}, SENSOR_MIDDLE_MPJ, 0, {0, 0, 0}},
    {{-28.0, -5.6, 100.0}, {39.12, 28.31, 24.48}, SENSOR_RING_MPJ, 0.3, {0, -1, 0}},
    {{-50.4, -19.6, 88.8}, {29.91, 21.10, 23.16}, SENSOR_LITTLE_MPJ, 0.6, {0, -1, -1}},
};

/* Points on the skin of the palm. carrier: 0 the Parent, 1..5 the PalmJoint of thumb .. little,
 * whose arch the point follows. Positions are for the default shape, in the mm of the same
 * table. */
static const struct palm_position {
    int carrier;
    vec3 position;
} palm_positions[PALM_POINTS] = {
    {0, {0.0, -22.0, 14.0}},   /* heel of the hand */
    {0, {24.0, -30.0, 38.0}},  /* thenar eminence */
    {5, {-34.0, -32.0, 40.0}}, /* hypothenar eminence */
    {0, {-4.0, -20.0, 62.0}},  /* hollow of the palm */
    {2, {28.0, -14.0, 92.0}},  /* pad below the index finger */
    {3, {0.0, -14.0, 97.0}},   /* pad below the middle finger */
    {4, {-28.0, -19.0, 96.0}}, /* pad below the ring finger */
    {5, {-50.0, -32.0, 85.0}}, /* pad below the little finger */
};

static node *add_node(hand_skeleton *s, node *parent, node_kind kind, vec3 offset_mm, int joint)
{
    node *added = &s->node[s->node_count++];
    *added = (node){.kind = kind, .offset_mm = offset_mm, .joint = joint};
    added->flexion_sensor = SENSOR_NONE;
    if (parent) {
        added->next_sibling = parent->first_child;
        parent->first_child = added;
    }
    return added;
}

/* Adds PalmJoint, then MCP, PIP, DIP, tip; for the thumb CMC, MCP, IP, tip. Returns the
 * PalmJoint. */
static node *add_finger(hand_skeleton *s, node *wrist, int index, double scale)
{
    const struct finger *f = &fingers[index];
    node *palm_joint = add_node(s, wrist, NODE_PALM_JOINT, vec3_scale(f->base, scale), JOINT_NONE);
    palm_joint->arch_share = f->arch_share;
    int joint = 1 + 4 * index;
    bool is_thumb = index == 0;
    node *at = add_node(s, palm_joint, is_thumb ? NODE_THUMB : NODE_JOINT, (vec3){0, 0, 0}, joint);
    for (int k = 0; k < 3; ++k)
        at->spread[k] = f->spread[k];
    /* The base of the thumb turns by roll and abduction. Its flexion sensors start one bone
     * later. */
    int sensor = f->mpj_sensor;
    if (!is_thumb)
        at->flexion_sensor = sensor++;
    for (int bone = 0; bone < 3; ++bone) {
        vec3 along = {0, 0, f->bone_mm[bone] * scale};
        at = add_node(s, at, NODE_JOINT, along, joint + 1 + bone);
        if (bone < 2)
            at->flexion_sensor = sensor++;
    }
    return palm_joint;
}

hand_skeleton *hand_skeleton_create(uint32_t side, double hand_length_mm)
{
    if (side > MRT_RIGHT || !(hand_length_mm >= HAND_LENGTH_MIN_MM) ||
        !(hand_length_mm <= HAND_LENGTH_MAX_MM))
        return NULL;
    hand_skeleton *s = calloc(1, sizeof *s);
    if (!s)
        return NULL;
    s->side = side;
    double scale = hand_length_mm / TABLE_LENGTH_MM;
    node *wrist = add_node(s, NULL, NODE_PARENT, (vec3){0, 0, 0}, 0);
    const node *carrier[1 + FINGER_COUNT] = {wrist};
    for (int i = 0; i < FINGER_COUNT; ++i)
        carrier[1 + i] = add_finger(s, wrist, i, scale);
    for (int i = 0; i < PALM_POINTS; ++i) {
        const struct palm_position *at = &palm_positions[i];
        s->palm[i].carrier = carrier[at->carrier];
        vec3 position_mm = vec3_scale(at->position, scale);
        s->palm[i].offset_mm = vec3_sub(position_mm, carrier[at->carrier]->offset_mm);
    }
    return s;
}

void hand_skeleton_destroy(hand_skeleton *skeleton)
{
    free(skeleton);
}

/* ---- a pose ---- */

static const vec3 ORIGIN = {0, 0, 0};
static const vec3 AXIS_X = {1, 0, 0}, AXIS_Z = {0, 0, 1};

/* Turns the flexion axis away from the plane of the roll's cone by an eighth of a turn: the thumb
 * bends as much towards the index finger as across the palm. */
static const double THUMB_TWIST_RAD = -0.25 * ANGLE_PI;
/* Angle between a closed thumb and the direction of the index finger */
static const double THUMB_REST_RAD = 0.15;

static double angle_of(const float *angle_rad, int sensor)
{
    return isfinite(angle_rad[sensor]) ? (double)angle_rad[sensor] : 0.0;
}

/* First yaw towards the thumb, then pitch towards the palm, both about axes of the forearm. */
static rigid wrist_rotation(const float *angle_rad)
{
    rigid yaw = rigid_turn_y(angle_of(angle_rad, SENSOR_WRIST_YAW));
    rigid pitch = rigid_turn_x(angle_of(angle_rad, SENSOR_WRIST_PITCH));
    return rigid_compose(&pitch, &yaw);
}

/* The metacarpal moves on a cone about the direction of the fingers. Abduction opens the cone.
 * Roll moves around it: from the plane of the palm (0), to straight in front of it (pi/2), to
 * across it. */
static rigid thumb_turn(const float *angle_rad)
{
    double abduction_rad = THUMB_REST_RAD + angle_of(angle_rad, SENSOR_THUMB_ABDUCTION);
    rigid roll = rigid_turn_z(-angle_of(angle_rad, SENSOR_THUMB_ROLL));
    rigid abduction = rigid_turn_y(abduction_rad);
    rigid twist = rigid_turn_z(THUMB_TWIST_RAD);
    rigid opened = rigid_compose(&abduction, &twist);
    return rigid_compose(&roll, &opened);
}

/* The spread at a knuckle decreases as it bends, because the collateral ligaments tighten. The
 * spread sensors of a glove are also wrong there. */
static rigid joint_turn(const node *n, const float *angle_rad)
{
    if (n->flexion_sensor == SENSOR_NONE)
        return rigid_identity();
    double flexion_rad = angle_of(angle_rad, n->flexion_sensor);
    rigid flexion = rigid_turn_x(flexion_rad);
    double spread_rad = n->spread[0] * angle_of(angle_rad, SENSOR_MIDDLE_INDEX_SPREAD) +
                        n->spread[1] * angle_of(angle_rad, SENSOR_RING_MIDDLE_SPREAD) +
                        n->spread[2] * angle_of(angle_rad, SENSOR_LITTLE_RING_SPREAD);
    if (spread_rad == 0.0)
        return flexion;
    double looseness = fmax(angle_sincos_of(flexion_rad).cos, 0.0);
    rigid spread = rigid_turn_y(spread_rad * looseness);
    return rigid_compose(&spread, &flexion);
}

static rigid arch_rotation(const node *n, const float *angle_rad)
{
    double arch_rad = n->arch_share * angle_of(angle_rad, SENSOR_ARCH);
    return rigid_turn_z(arch_rad);
}

/* Returns the frame of a node in the hand, given that of its parent. */
static rigid node_frame(const node *n, const rigid *parent, const float *angle_rad)
{
    rigid rotation;
    vec3 offset_mm = n->offset_mm;
    switch (n->kind) {
    case NODE_PARENT:
        rotation = wrist_rotation(angle_rad);
        break;
    case NODE_PALM_JOINT:
        rotation = arch_rotation(n, angle_rad);
        offset_mm =
            rigid_rotate(&rotation, offset_mm); /* the metacarpal rotates about the long axis */
        break;
    case NODE_THUMB:
        rotation = thumb_turn(angle_rad);
        break;
    default:
        rotation = joint_turn(n, angle_rad);
        break;
    }
    rotation.t = offset_mm;
    return rigid_compose(parent, &rotation);
}

typedef struct pose {
    const hand_skeleton *skeleton;
    const float *angle_rad;
    const rigid *wrist;
    mrt_vec3 *joint, *palm;
} pose;

/* Converts a point of a right hand to this side, and moves it to the tracked wrist. */
static mrt_vec3 placed(const pose *p, vec3 right)
{
    vec3 own = {p->skeleton->side == MRT_LEFT ? -right.x : right.x, right.y, right.z};
    vec3 at = rigid_apply(p->wrist, own);
    return (mrt_vec3){(float)at.x, (float)at.y, (float)at.z};
}

static void pose_node(const pose *p, const node *n, const rigid *parent)
{
    rigid frame = node_frame(n, parent, p->angle_rad);
    if (n->joint != JOINT_NONE)
        p->joint[n->joint] = placed(p, frame.t);
    for (int i = 0; i < PALM_POINTS; ++i)
        if (p->skeleton->palm[i].carrier == n)
            p->palm[i] = placed(p, rigid_apply(&frame, p->skeleton->palm[i].offset_mm));
    for (const node *child = n->first_child; child; child = child->next_sibling)
        pose_node(p, child, &frame);
}

void hand_pose(const hand_skeleton *skeleton, const float *angle_rad, const rigid *wrist,
               mrt_vec3 *out_joint, mrt_vec3 *out_palm)
{
    pose p = {skeleton, angle_rad, wrist, out_joint, out_palm};
    rigid origin = rigid_identity();
    pose_node(&p, &skeleton->node[0], &origin);
}

/* ---- from landmarks to angles ---- */

enum { PALM_JOINTS = 6 };
static const int palm_joint[PALM_JOINTS] = {0, 1, 5, 9, 13, 17}; /* of MRT_JOINTS */
/* The base of the thumb is the least visible, and its place in the table is a compromise. */
static const double palm_weight[PALM_JOINTS] = {1, 0.5, 1, 1, 1, 1};
static const double arch_low_rad = -0.2, arch_high_rad = 0.8;
static const double arch_usual_rad = 0.12, arch_usual_spread_rad = 0.3;
/* Cosines of a knuckle's bend. From the first (70 degrees) to the second (55), the confidence in
 * its spread rises from 0 to 1. */
static const double spread_from = 0.34, spread_full = 0.57;
static const double spread_most_rad = 0.9;
/* Sines of the angle between thumb and fingers, likewise for the confidence in its roll (6, 17
 * degrees). */
static const double roll_from = 0.1, roll_full = 0.3;
/* Misfits of the palm with full confidence, and with none. */
static const double misfit_sure = 0.22, misfit_none = 0.40;
/* Margins beyond the clinical range: some joints go further, and many thumbs much further. */
static const float beyond_deg = 8.0f, thumb_beyond_deg = 20.0f;
static const double bent_from_rad = 0.25, bent_full_rad = 0.7;
static const double backwards_most_rad = 0.6; /* in sum; more: a hand of the other side */

/* The transformation from one palm to another. */
typedef struct palm_fit {
    rigid rotation; /* R and t: seen = scale R p + t */
    double scale;
    double off;  /* weighted sum of the squared residuals */
    double size; /* weighted sum of squares about the centre of the seen palm */
} palm_fit;

static vec3 vec3_of(mrt_vec3 a)
{
    return (vec3){(double)a.x, (double)a.y, (double)a.z};
}

static bool is_seen(const hand_landmarks *seen, int joint)
{
    mrt_vec3 at = seen->at[joint];
    return !(seen->doubtful >> joint & 1u) && isfinite(at.x) && isfinite(at.y) && isfinite(at.z);
}

/* Computes the eigenvector of the largest eigenvalue of a symmetric matrix, by Jacobi rotations. */
static void largest_eigenvector(double m[4][4], double out[4])
{
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    double apart = 1.0, size = m[0][0] * m[0][0] + 1e-300;
    for (int sweep = 0; sweep < 12 && apart > 1e-28 * size; ++sweep) {
        apart = 0.0;
        for (int p = 0; p < 3; ++p)
            for (int q = p + 1; q < 4; ++q) {
                apart += m[p][q] * m[p][q];
                size += m[q][q] * m[q][q];
                if (m[p][q] == 0.0)
                    continue;
                double theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
                double t = 1.0 / (fabs(theta) + sqrt(theta * theta + 1.0));
                t = theta < 0.0 ? -t : t;
                double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
                for (int k = 0; k < 4; ++k) {
                    double kp = m[k][p], kq = m[k][q];
                    m[k][p] = c * kp - s * kq;
                    m[k][q] = s * kp + c * kq;
                }
                for (int k = 0; k < 4; ++k) {
                    double pk = m[p][k], qk = m[q][k];
                    m[p][k] = c * pk - s * qk;
                    m[q][k] = s * pk + c * qk;
                    double vp = v[k][p], vq = v[k][q];
                    v[k][p] = c * vp - s * vq;
                    v[k][q] = s * vp + c * vq;
                }
            }
    }
    int largest = 0;
    for (int i = 1; i < 4; ++i)
        largest = m[i][i] > m[largest][largest] ? i : largest;
    for (int k = 0; k < 4; ++k)
        out[k] = v[k][largest];
}

/* Horn, "Closed-form solution of absolute orientation using unit quaternions" (1987), section 4.
 * weight 0 excludes a pair. */
static palm_fit lay_palm(const vec3 *from, const vec3 *to, const double *weight)
{
    palm_fit fit = {.rotation = rigid_identity()};
    vec3 from_centre = ORIGIN, to_centre = ORIGIN;
    double all = 0.0, from_size = 0.0, along = 0.0, s[3][3] = {{0}};
    for (int i = 0; i < PALM_JOINTS; ++i) {
        from_centre = vec3_add(from_centre, vec3_scale(from[i], weight[i]));
        to_centre = vec3_add(to_centre, vec3_scale(to[i], weight[i]));
        all += weight[i];
    }
    from_centre = vec3_scale(from_centre, 1.0 / all);
    to_centre = vec3_scale(to_centre, 1.0 / all);
    for (int i = 0; i < PALM_JOINTS; ++i) {
        vec3 a = vec3_sub(from[i], from_centre), b = vec3_sub(to[i], to_centre);
        const double a_of[3] = {a.x, a.y, a.z}, b_of[3] = {b.x, b.y, b.z};
        from_size += weight[i] * vec3_dot(a, a);
        fit.size += weight[i] * vec3_dot(b, b);
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                s[j][k] += weight[i] * a_of[j] * b_of[k];
    }
    double n[4][4] = {
        {s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
        {s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
        {s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]},
        {s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]}};
    double q[4];
    largest_eigenvector(n, q);
    const double xyzw[4] = {q[1], q[2], q[3], q[0]};
    fit.rotation = rigid_from_quaternion(xyzw, ORIGIN);
    for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
            along += fit.rotation.r[k][j] * s[j][k];
    fit.scale = from_size > 0.0 ? along / from_size : 0.0;
    fit.off = fmax(fit.size - fit.scale * along, 0.0);
    fit.rotation.t =
        vec3_sub(to_centre, vec3_scale(rigid_rotate(&fit.rotation, from_centre), fit.scale));
    return fit;
}

static palm_fit lay_arched_palm(const hand_skeleton *skeleton, const vec3 *to, const double *weight,
                                double arch_rad)
{
    float angle_rad[MRT_ANGLES] = {0};
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
    vec3 from[PALM_JOINTS];
    const rigid still = rigid_identity();
    angle_rad[SENSOR_ARCH] = (float)arch_rad;
    hand_pose(skeleton, angle_rad, &still, joint, palm);
    for (int i = 0; i < PALM_JOINTS; ++i)
        from[i] = vec3_of(joint[palm_joint[i]]);
    return lay_palm(from, to, weight);
}

/* Returns the arch with the least residual, by parabolas through three arches that converge. The
 * less the palm determines the arch, the nearer the result is to the typical arch. */
static double find_arch(const hand_skeleton *skeleton, const vec3 *to, const double *weight)
{
    const double middle = 0.5 * (arch_low_rad + arch_high_rad);
    double arch = middle, curve = 0.0, off = 0.0;
    for (double step = arch_high_rad - middle; step > 0.01; step *= 0.2) {
        double below = lay_arched_palm(skeleton, to, weight, arch - step).off;
        double above = lay_arched_palm(skeleton, to, weight, arch + step).off;
        off = lay_arched_palm(skeleton, to, weight, arch).off;
        curve = fmax((below + above - 2.0 * off) / (step * step), 0.0);
        if (curve > 0.0)
            arch -= fmin(fmax((above - below) / (2.0 * step * curve), -step), step);
        arch = fmin(fmax(arch, arch_low_rad), arch_high_rad);
    }
    double known = 0.5 * curve;
    double unknown = off / PALM_JOINTS / (arch_usual_spread_rad * arch_usual_spread_rad);
    return known + unknown > 0.0 ? (known * arch + unknown * arch_usual_rad) / (known + unknown)
                                 : arch_usual_rad;
}

/* Converts a direction from the frame of the landmarks to the hand frame of a right hand. */
static vec3 own_direction(const hand_skeleton *skeleton, const rigid *wrist, vec3 way)
{
    rigid back = rigid_inverse(wrist);
    vec3 own = rigid_rotate(&back, way);
    if (skeleton->side == MRT_LEFT)
        own.x = -own.x;
    return vec3_normalised(own, AXIS_Z);
}

/* Computes the bones of a finger as directions of a right hand, in a frame. */
static bool finger_bones(const hand_skeleton *skeleton, const hand_landmarks *seen,
                         const rigid *wrist, const rigid *frame, int finger, vec3 out[3])
{
    const rigid back = rigid_inverse(frame);
    int joint = 1 + 4 * finger;
    for (int bone = 0; bone < 3; ++bone) {
        if (!is_seen(seen, joint + bone) || !is_seen(seen, joint + bone + 1))
            return false;
        vec3 way = vec3_sub(vec3_of(seen->at[joint + bone + 1]), vec3_of(seen->at[joint + bone]));
        out[bone] = rigid_rotate(&back, own_direction(skeleton, wrist, way));
    }
    return true;
}

static double share_between(double value, double from, double full)
{
    return fmin(fmax((value - from) / (full - from), 0.0), 1.0);
}

/* Returns the frame, rotated by the smallest angle that turns its z to a unit direction in it. */
static rigid turned_onto(const rigid *frame, vec3 along)
{
    vec3 axis = vec3_cross(AXIS_Z, along);
    double sine = vec3_length(axis);
    rigid rotation = rigid_turn(ORIGIN, vec3_normalised(axis, AXIS_X), atan2(sine, along.z));
    return rigid_compose(frame, &rotation);
}

/* Returns how far a bone is bent towards the palm, relative to the previous bone, and turns the
 * frame onto the bone. A small bend is measured about x, because noise hides the plane of the
 * finger. A large bend is measured as the whole angle between the bones, even if the finger seems
 * to lean: joints hardly bend to the sides. out_about_x_rad: the angle about x, unchanged, for
 * plausibility checks. */
static double bend_in(rigid *frame, vec3 bone, double *out_about_x_rad)
{
    const rigid back = rigid_inverse(frame);
    vec3 own = rigid_rotate(&back, bone);
    double whole = atan2(hypot(own.x, own.y), own.z);
    *out_about_x_rad = atan2(-own.y, own.z);
    double bent = share_between(whole, bent_from_rad, bent_full_rad);
    *frame = turned_onto(frame, own);
    return *out_about_x_rad + bent * (whole - *out_about_x_rad);
}

/* Results of reading a finger, besides its bends. */
typedef struct finger_reading {
    double spread_rad, sure; /* towards the thumb; confidence 0..1 */
    double backwards_rad;    /* measured bend of its middle joint towards the back of the hand */
} finger_reading;

static finger_reading read_finger(const hand_skeleton *skeleton, const hand_landmarks *seen,
                                  const rigid *wrist, int finger, float *angle_rad)
{
    const double arch_rad = fingers[finger].arch_share * (double)angle_rad[SENSOR_ARCH];
    rigid frame = rigid_turn_z(arch_rad);
    finger_reading out = {.sure = 0.0};
    vec3 bone[3];
    if (!finger_bones(skeleton, seen, wrist, &frame, finger, bone))
        return out;
    double aside = bone[0].z > 0.0 ? atan2(bone[0].x, bone[0].z) : 0.0;
    aside = fmin(fmax(aside, -spread_most_rad), spread_most_rad);
    double bend_rad = atan2(-bone[0].y, bone[0].z / cos(aside)), looseness = cos(bend_rad);
    out.sure = share_between(looseness, spread_from, spread_full);
    out.spread_rad = looseness > spread_from ? aside / looseness : 0.0;
    float *bend = &angle_rad[fingers[finger].mpj_sensor];
    rigid first = rigid_turn_y(aside);
    rigid second = rigid_turn_x(bend_rad);
    frame = rigid_compose(&first, &second);
    double about_x_rad;
    bend[0] = (float)bend_rad;
    bend[1] = (float)bend_in(&frame, bone[1], &about_x_rad);
    out.backwards_rad = -about_x_rad;
    bend[2] = (float)bend_in(&frame, bone[2], &about_x_rad);
    return out;
}

static void read_thumb(const hand_skeleton *skeleton, const hand_landmarks *seen,
                       const rigid *wrist, float *angle_rad)
{
    const rigid palm = rigid_identity();
    vec3 bone[3];
    if (!finger_bones(skeleton, seen, wrist, &palm, 0, bone))
        return;
    double aside = sqrt(bone[0].x * bone[0].x + bone[0].y * bone[0].y);
    double sure = share_between(aside, roll_from, roll_full);
    double roll_rad = atan2(-bone[0].y, bone[0].x);
    if (roll_rad < -0.5 * ANGLE_PI) /* roll goes from the palm's plane to across it */
        roll_rad += 2.0 * ANGLE_PI;
    double last_rad = (double)angle_rad[SENSOR_THUMB_ROLL];
    angle_rad[SENSOR_THUMB_ROLL] = (float)(last_rad + sure * (roll_rad - last_rad));
    angle_rad[SENSOR_THUMB_ABDUCTION] = (float)(atan2(aside, bone[0].z) - THUMB_REST_RAD);
    rigid frame = thumb_turn(angle_rad);
    double about_x_rad;
    angle_rad[SENSOR_THUMB_MPJ] = (float)bend_in(&frame, bone[1], &about_x_rad);
    angle_rad[SENSOR_THUMB_IJ] = (float)bend_in(&frame, bone[2], &about_x_rad);
}

/* Returns the sum of the backward bends of their middle joints. */
static double read_fingers(const hand_skeleton *skeleton, const hand_landmarks *seen,
                           const rigid *wrist, float *angle_rad)
{
    static const int between[3] = {SENSOR_MIDDLE_INDEX_SPREAD, SENSOR_RING_MIDDLE_SPREAD,
                                   SENSOR_LITTLE_RING_SPREAD};
    finger_reading of[FINGER_COUNT];
    double backwards_rad = 0.0;
    for (int finger = 1; finger < FINGER_COUNT; ++finger) {
        of[finger] = read_finger(skeleton, seen, wrist, finger, angle_rad);
        backwards_rad += of[finger].backwards_rad;
    }
    for (int i = 0; i < 3; ++i) {
        const finger_reading *a = &of[i + 1], *b = &of[i + 2];
        double last_rad = (double)angle_rad[between[i]];
        double apart_rad = a->spread_rad - b->spread_rad;
        angle_rad[between[i]] = (float)(last_rad + fmin(a->sure, b->sure) * (apart_rad - last_rad));
    }
    return backwards_rad;
}

/* Clamps the angles to the possible range; values beyond it are noise. */
static void limit_to_joints(float *angle_rad)
{
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const float beyond = i <= SENSOR_THUMB_IJ ? thumb_beyond_deg : beyond_deg;
        const float least = (sensor_table[i].low_deg - beyond) * (float)(ANGLE_PI / 180.0);
        const float most = (sensor_table[i].high_deg + beyond) * (float)(ANGLE_PI / 180.0);
        angle_rad[i] = fminf(fmaxf(angle_rad[i], least), most);
    }
}

void hand_read(const hand_skeleton *skeleton, const hand_landmarks *seen, hand_reading *reading)
{
    hand_reading now = *reading;
    vec3 to[PALM_JOINTS];
    double weight[PALM_JOINTS];
    int count = 0;
    reading->confidence = 0.0;
    for (int i = 0; i < PALM_JOINTS; ++i) {
        bool is_there = is_seen(seen, palm_joint[i]);
        to[i] = is_there ? vec3_of(seen->at[palm_joint[i]]) : ORIGIN;
        weight[i] = is_there ? palm_weight[i] : 0.0;
        count += is_there;
    }
    if (count < 4)
        return;
    double arch_rad =
        count == PALM_JOINTS ? find_arch(skeleton, to, weight) : (double)now.angle_rad[SENSOR_ARCH];
    palm_fit fit = lay_arched_palm(skeleton, to, weight, arch_rad);
    if (!(fit.scale > 0.0) || !(fit.size > 0.0))
        return;
    now.wrist = fit.rotation;
    now.wrist.t = is_seen(seen, 0) ? to[0] : fit.rotation.t;
    now.size = fit.scale;
    now.misfit = sqrt(fit.off / fit.size);
    now.angle_rad[SENSOR_ARCH] = (float)arch_rad;
    now.angle_rad[SENSOR_WRIST_PITCH] = now.angle_rad[SENSOR_WRIST_YAW] = 0.0f;
    read_thumb(skeleton, seen, &now.wrist, now.angle_rad);
    double backwards_rad = read_fingers(skeleton, seen, &now.wrist, now.angle_rad);
    now.confidence = share_between(now.misfit, misfit_none, misfit_sure);
    if (!(now.confidence > 0.0) || backwards_rad > backwards_most_rad)
        return;
    limit_to_joints(now.angle_rad);
    *reading = now;
}
