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
    static const float raw_end[2] = {1.0f, 255.0f}; /* of a sensor byte */
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

/* Half a turn either way is more than any joint has: what a damaged table or sensor says beyond it
 * stays there. */
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

/* As VirtualHand does for gloves of 18 sensors (hardware.md 2.2); 90 degrees give 30. A middle
 * joint bent backwards, on the parabola's other branch, bends no end joint. */
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

/* The paper's linked structure: a Parent (the wrist), one PalmJoint per finger, which the palm
 * carries, and Joints down to the fingertip. A node stores only where it stands in its parent in
 * the default shape: a flat right hand, fingers straight and parallel, thumb in the plane of the
 * palm. Poses are computed from there and stored nowhere. */
typedef enum node_kind { NODE_PARENT = 0, NODE_PALM_JOINT, NODE_JOINT, NODE_THUMB } node_kind;

enum { JOINT_NONE = -1, NODE_MAX = 32, FINGER_COUNT = 5, PALM_POINTS = MRT_PALM };

typedef struct node {
    node_kind kind;
    vec3 offset_mm;     /* from the parent's origin, in the parent's axes */
    int flexion_sensor; /* about x, towards the palm; SENSOR_NONE: stiff */
    double arch_share;  /* PalmJoint: part of the arch that turns it about the hand's long axis */
    double spread[3];   /* Joint: share of each spread sensor in its turn towards the thumb */
    int joint;          /* which of MRT_JOINTS stands at its origin, or JOINT_NONE */
    const struct node *first_child, *next_sibling;
} node;

typedef struct palm_point {
    const node *carrier; /* the node whose frame it moves with */
    vec3 offset_mm;
} palm_point;

struct hand_skeleton {
    uint32_t side;
    uint32_t node_count;
    node node[NODE_MAX]; /* node[0] is the Parent */
    palm_point palm[PALM_POINTS];
};

/* ---- the default shape ---- */

/* research/hardware.md 2.3, mm, of a hand whose middle fingertip is 206.39 mm from the wrist: the
 * wrist stands 100 mm behind the middle knuckle, where the table leaves it open. Everything is
 * scaled by hand length / 206.39, so lengths are those of the hand asked for. */
static const double TABLE_LENGTH_MM = 206.39;

/* The thumb's base is a compromise: the table's (10, -23, 5) has inferred axes, the planar skeleton
 * of the recordings (data/README.md) has (27, 0, 31). */
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

/* Palm points on the palmar skin. carrier: 0 the Parent, 1..5 the PalmJoint of thumb .. little,
 * whose arch they follow; positions are of the default shape, in the same table's mm. */
static const struct palm_place {
    int carrier;
    vec3 position;
} palm_places[PALM_POINTS] = {
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

/* PalmJoint, then MCP, PIP, DIP, tip; for the thumb CMC, MCP, IP, tip. Returns the PalmJoint. */
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
    /* The thumb's base turns by roll and abduction; its flexion sensors start one bone later. */
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
        const struct palm_place *place = &palm_places[i];
        s->palm[i].carrier = carrier[place->carrier];
        vec3 position_mm = vec3_scale(place->position, scale);
        s->palm[i].offset_mm = vec3_sub(position_mm, carrier[place->carrier]->offset_mm);
    }
    return s;
}

void hand_skeleton_destroy(hand_skeleton *skeleton)
{
    free(skeleton);
}

/* ---- a pose ---- */

static const vec3 ORIGIN = {0, 0, 0};
static const vec3 AXIS_X = {1, 0, 0}, AXIS_Y = {0, 1, 0}, AXIS_Z = {0, 0, 1};

/* Half a turn of the flexion axis away from the plane of the roll's cone: the thumb bends as much
 * towards the index finger as across the palm. */
static const double THUMB_TWIST_RAD = -0.25 * ANGLE_PI;
/* A closed thumb still lies this far off the index finger's direction. */
static const double THUMB_REST_RAD = 0.15;

static double angle_of(const float *angle_rad, int sensor)
{
    return isfinite(angle_rad[sensor]) ? (double)angle_rad[sensor] : 0.0;
}

/* First yaw towards the thumb, then pitch towards the palm, both in the forearm's axes. */
static rigid wrist_turn(const float *angle_rad)
{
    rigid yaw = rigid_turn(ORIGIN, AXIS_Y, angle_of(angle_rad, SENSOR_WRIST_YAW));
    rigid pitch = rigid_turn(ORIGIN, AXIS_X, angle_of(angle_rad, SENSOR_WRIST_PITCH));
    return rigid_compose(&pitch, &yaw);
}

/* The metacarpal moves on a cone about the fingers' direction: abduction opens the cone, roll goes
 * round it, from the plane of the palm (0) over straight in front of it (pi/2) to across it. */
static rigid thumb_turn(const float *angle_rad)
{
    double abduction_rad = THUMB_REST_RAD + angle_of(angle_rad, SENSOR_THUMB_ABDUCTION);
    rigid roll = rigid_turn(ORIGIN, AXIS_Z, -angle_of(angle_rad, SENSOR_THUMB_ROLL));
    rigid abduction = rigid_turn(ORIGIN, AXIS_Y, abduction_rad);
    rigid twist = rigid_turn(ORIGIN, AXIS_Z, THUMB_TWIST_RAD);
    rigid opened = rigid_compose(&abduction, &twist);
    return rigid_compose(&roll, &opened);
}

/* Spread at a knuckle fades as it bends, as the collateral ligaments tighten (and as the spread
 * sensors of a glove read nonsense there). */
static rigid joint_turn(const node *n, const float *angle_rad)
{
    if (n->flexion_sensor == SENSOR_NONE)
        return rigid_identity();
    double flexion_rad = angle_of(angle_rad, n->flexion_sensor);
    rigid flexion = rigid_turn(ORIGIN, AXIS_X, flexion_rad);
    double spread_rad = n->spread[0] * angle_of(angle_rad, SENSOR_MIDDLE_INDEX_SPREAD) +
                        n->spread[1] * angle_of(angle_rad, SENSOR_RING_MIDDLE_SPREAD) +
                        n->spread[2] * angle_of(angle_rad, SENSOR_LITTLE_RING_SPREAD);
    if (spread_rad == 0.0)
        return flexion;
    double looseness = fmax(angle_turn_of(flexion_rad).cos, 0.0);
    rigid spread = rigid_turn(ORIGIN, AXIS_Y, spread_rad * looseness);
    return rigid_compose(&spread, &flexion);
}

static rigid arch_turn(const node *n, const float *angle_rad)
{
    double arch_rad = n->arch_share * angle_of(angle_rad, SENSOR_ARCH);
    return rigid_turn(ORIGIN, AXIS_Z, arch_rad);
}

/* Where a node stands in the hand, given where its parent stands. */
static rigid node_frame(const node *n, const rigid *parent, const float *angle_rad)
{
    rigid turn;
    vec3 offset_mm = n->offset_mm;
    switch (n->kind) {
    case NODE_PARENT:
        turn = wrist_turn(angle_rad);
        break;
    case NODE_PALM_JOINT:
        turn = arch_turn(n, angle_rad);
        offset_mm = rigid_rotate(&turn, offset_mm); /* the metacarpal swings about the long axis */
        break;
    case NODE_THUMB:
        turn = thumb_turn(angle_rad);
        break;
    default:
        turn = joint_turn(n, angle_rad);
        break;
    }
    turn.t = offset_mm;
    return rigid_compose(parent, &turn);
}

typedef struct pose {
    const hand_skeleton *skeleton;
    const float *angle_rad;
    const rigid *wrist;
    mrt_vec3 *joint, *palm;
} pose;

/* A right hand's point becomes this side's, then goes where the tracked wrist is. */
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
