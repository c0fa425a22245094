#include "hand/hand.h"
#include "base/angle.h"
#include "io/write/export_stream.h"

#include <math.h>

/* The five bones at the wrist have a separate position in each frame, because the palm's arch moves
 * them. All other bones have a fixed length. Rotations are the smallest ones that give each bone
 * its direction, as in a hand that flexes. */

static const char *const joint_names[MRT_JOINTS] = {
    "Hand",      "ThumbMetacarpal", "ThumbProximal",      "ThumbDistal",
    "ThumbTip",  "IndexProximal",   "IndexIntermediate",  "IndexDistal",
    "IndexTip",  "MiddleProximal",  "MiddleIntermediate", "MiddleDistal",
    "MiddleTip", "RingProximal",    "RingIntermediate",   "RingDistal",
    "RingTip",   "LittleProximal",  "LittleIntermediate", "LittleDistal",
    "LittleTip"};
static const char *const side_names[2] = {"Left", "Right"};

enum { BONES_A_FINGER = 4 };

typedef struct bvh_hand {
    bool is_there;                  /* present in some frame */
    vec3 rest[MRT_JOINTS];          /* mm, from the wrist: a flat hand of the same length */
    double last_zxy[MRT_JOINTS][3]; /* of the previous frame */
    vec3 aside;                     /* mm: position of an untracked wrist */
} bvh_hand;

static vec3 joint_at(const double *hand, int joint)
{
    const double *at = hand + (size_t)joint * 3;
    return (vec3){at[0], at[1], at[2]};
}

static bool is_base(int joint)
{
    return joint % BONES_A_FINGER == 1;
}

static bool is_tip(int joint)
{
    return joint > 0 && joint % BONES_A_FINGER == 0;
}

/* Returns the smallest rotation from one direction to another. */
static rigid rotation_between(vec3 from, vec3 to)
{
    const vec3 x = {1, 0, 0};
    vec3 a = vec3_normalised(from, x), b = vec3_normalised(to, x);
    vec3 axis = vec3_cross(a, b);
    double q[4] = {axis.x, axis.y, axis.z, 1.0 + vec3_dot(a, b)};
    if (q[3] < 1e-9) { /* opposite directions: any perpendicular axis */
        vec3 across = vec3_cross(a, fabs(a.x) < 0.9 ? x : (vec3){0, 1, 0});
        q[0] = across.x, q[1] = across.y, q[2] = across.z, q[3] = 0.0;
    }
    return rigid_from_quaternion(q, (vec3){0, 0, 0});
}

/* Returns a frame of the wrist and two knuckles that the arch of the palm does not move. Columns:
 * along the fingers, out of the palm, and perpendicular to both. */
static rigid palm_of(vec3 wrist, vec3 index, vec3 middle)
{
    vec3 along = vec3_normalised(vec3_sub(middle, wrist), (vec3){0, 0, 1});
    vec3 out = vec3_normalised(vec3_cross(along, vec3_sub(index, wrist)), (vec3){0, 1, 0});
    vec3 across = vec3_cross(out, along);
    return (rigid){
        .r = {{along.x, out.x, across.x}, {along.y, out.y, across.y}, {along.z, out.z, across.z}}};
}

static rigid wrist_rotation(const bvh_hand *of, const double *hand)
{
    rigid now = palm_of(joint_at(hand, 0), joint_at(hand, 5), joint_at(hand, 9));
    rigid rest = palm_of((vec3){0, 0, 0}, of->rest[5], of->rest[9]);
    rigid back = rigid_inverse(&rest);
    return rigid_compose(&now, &back);
}

/* Computes the angles in the order of the channels, degrees: R = Rz Rx Ry. */
static void euler_of(const rigid *m, double out_zxy[3])
{
    const double degrees = 180.0 / ANGLE_PI;
    double sine = fmin(fmax(m->r[2][1], -1.0), 1.0);
    out_zxy[1] = asin(sine) * degrees;
    if (fabs(sine) > 1.0 - 1e-12) { /* gimbal lock: y and z rotate about the same axis */
        out_zxy[0] = atan2(m->r[1][0], m->r[0][0]) * degrees;
        out_zxy[2] = 0.0;
        return;
    }
    out_zxy[0] = atan2(-m->r[0][1], m->r[1][1]) * degrees;
    out_zxy[2] = atan2(-m->r[2][0], m->r[2][2]) * degrees;
}

/* Chooses the equal rotation nearest to that of the previous frame, so that interpolation between
 * frames does not jump. */
static void stay_near(double zxy[3], const double last[3])
{
    const double other[3] = {zxy[0] + 180.0, 180.0 - zxy[1], zxy[2] + 180.0};
    double near[2][3], off[2] = {0.0, 0.0};
    for (int k = 0; k < 3; ++k) {
        near[0][k] = zxy[k] - 360.0 * floor((zxy[k] - last[k]) / 360.0 + 0.5);
        near[1][k] = other[k] - 360.0 * floor((other[k] - last[k]) / 360.0 + 0.5);
        off[0] += fabs(near[0][k] - last[k]);
        off[1] += fabs(near[1][k] - last[k]);
    }
    const double *best = near[off[1] < off[0]];
    for (int k = 0; k < 3; ++k)
        zxy[k] = best[k];
}

/* ---- the hands of a clip ---- */

static mrt_result measure(bvh_hand *out, const clip *c, uint32_t side, error *err)
{
    bool is_tracked = false;
    *out = (bvh_hand){0};
    double length_mm = HAND_LENGTH_MM;
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        const double *hand = clip_hand(c, frame, side);
        if (!hand)
            continue;
        vec3 wrist = joint_at(hand, 0);
        if (!out->is_there)
            length_mm = vec3_length(vec3_sub(joint_at(hand, 9), wrist));
        out->is_there = true;
        is_tracked = is_tracked || vec3_dot(wrist, wrist) > 0.0;
    }
    if (!out->is_there)
        return MRT_OK;
    /* All hands have the same proportions, so the flat hand is scaled to this length. */
    const float flat[MRT_ANGLES] = {0};
    mrt_vec3 joint[MRT_JOINTS], palm[MRT_PALM];
    const rigid origin = rigid_identity();
    hand_skeleton *usual = hand_skeleton_create(side, HAND_LENGTH_MM);
    if (!usual)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a hand");
    hand_pose(usual, flat, &origin, joint, palm);
    hand_skeleton_destroy(usual);
    const mrt_vec3 *knuckle = &joint[9];
    double scale =
        length_mm / vec3_length((vec3){(double)knuckle->x, (double)knuckle->y, (double)knuckle->z});
    for (int i = 0; i < MRT_JOINTS; ++i)
        out->rest[i] =
            vec3_scale((vec3){(double)joint[i].x, (double)joint[i].y, (double)joint[i].z}, scale);
    if (!is_tracked)
        out->aside.x = (side == MRT_LEFT ? 1.0 : -1.0) * 120.0;
    return MRT_OK;
}

/* ---- text ---- */

static vec3 bone_at_rest(const bvh_hand *of, int joint)
{
    vec3 from = joint == 0 || is_base(joint) ? of->rest[0] : of->rest[joint - 1];
    return vec3_sub(of->rest[joint], from);
}

static void put_offset(FILE *out, int depth, vec3 mm, double per_mm)
{
    fprintf(out, "%*sOFFSET %.6f %.6f %.6f\n", 2 * depth, "", mm.x * per_mm, mm.y * per_mm,
            mm.z * per_mm);
}

static void open_joint(FILE *out, int depth, const char *side, int joint, vec3 offset_mm,
                       double per_mm)
{
    fprintf(out, "%*sJOINT %s%s\n%*s{\n", 2 * depth, "", side, joint_names[joint], 2 * depth, "");
    put_offset(out, depth + 1, offset_mm, per_mm);
    fprintf(out, "%*sCHANNELS %sZrotation Xrotation Yrotation\n", 2 * depth + 2, "",
            joint == 0 || is_base(joint) ? "6 Xposition Yposition Zposition " : "3 ");
}

static void put_hand(FILE *out, const bvh_hand *of, const char *side, double per_mm)
{
    open_joint(out, 1, side, 0, of->aside, per_mm);
    for (int base = 1; base < MRT_JOINTS; base += BONES_A_FINGER) {
        for (int k = 0; k < BONES_A_FINGER; ++k)
            open_joint(out, 2 + k, side, base + k, bone_at_rest(of, base + k), per_mm);
        int tip = base + BONES_A_FINGER - 1;
        fprintf(out, "%*sEnd Site\n%*s{\n", 12, "", 12, "");
        put_offset(out, 7, vec3_scale(bone_at_rest(of, tip), 0.25), per_mm);
        fprintf(out, "%*s}\n", 12, "");
        for (int k = BONES_A_FINGER - 1; k >= 0; --k)
            fprintf(out, "%*s}\n", 2 * (2 + k), "");
    }
    fprintf(out, "  }\n");
}

static void put_channels(FILE *out, const vec3 *position, double per_mm, const rigid *rotation,
                         double last_zxy[3])
{
    double zxy[3];
    euler_of(rotation, zxy);
    stay_near(zxy, last_zxy);
    for (int k = 0; k < 3; ++k)
        last_zxy[k] = zxy[k];
    if (position)
        fprintf(out, "%.6f %.6f %.6f ", position->x * per_mm, position->y * per_mm,
                position->z * per_mm);
    fprintf(out, "%.6f %.6f %.6f ", zxy[0], zxy[1], zxy[2]);
}

/* Writes a pose. hand: 3 numbers for each joint; NULL: the rest pose. */
static void write_pose(FILE *out, bvh_hand *of, const double *hand, double per_mm)
{
    const rigid still = rigid_identity();
    rigid palm = hand ? wrist_rotation(of, hand) : still;
    vec3 wrist = hand ? vec3_add(joint_at(hand, 0), of->aside) : of->aside;
    put_channels(out, &wrist, per_mm, &palm, of->last_zxy[0]);
    rigid back = rigid_inverse(&palm);
    for (int base = 1; base < MRT_JOINTS; base += BONES_A_FINGER) {
        rigid to_joint = back; /* from the axes of the hand to those of the joint's parent */
        for (int joint = base; joint < base + BONES_A_FINGER; ++joint) {
            vec3 root = of->rest[joint];
            rigid rotation = still;
            if (hand && is_base(joint))
                root = rigid_rotate(&back, vec3_sub(joint_at(hand, joint), joint_at(hand, 0)));
            if (hand && !is_tip(joint)) {
                vec3 along = vec3_sub(joint_at(hand, joint + 1), joint_at(hand, joint));
                rotation =
                    rotation_between(bone_at_rest(of, joint + 1), rigid_rotate(&to_joint, along));
            }
            put_channels(out, is_base(joint) ? &root : NULL, per_mm, &rotation,
                         of->last_zxy[joint]);
            rigid undo = rigid_inverse(&rotation);
            to_joint = rigid_compose(&undo, &to_joint);
        }
    }
}

static void put_all(FILE *out, const clip *c, bvh_hand *hands, double per_mm,
                    const export_progress *progress)
{
    const double *last[2] = {NULL, NULL};
    fputs("HIERARCHY\nROOT Hands\n{\n  OFFSET 0 0 0\n"
          "  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n",
          out);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        if (hands[side].is_there)
            put_hand(out, &hands[side], side_names[side], per_mm);
    fprintf(out, "}\nMOTION\nFrames: %u\nFrame Time: %.9f\n", clip_frame_count(c),
            1.0 / clip_fps(c));
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        fputs("0 0 0 0 0 0 ", out);
        for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
            const double *hand = clip_hand(c, frame, side);
            last[side] = hand ? hand : last[side]; /* a missing hand keeps its last pose */
            if (hands[side].is_there)
                write_pose(out, &hands[side], last[side], per_mm);
        }
        fputc('\n', out);
        export_step(progress, (double)(frame + 1) / (double)clip_frame_count(c));
    }
}

mrt_result bvh_write(const char *path, const clip *c, double mm_per_unit,
                     const export_progress *progress, error *err)
{
    bvh_hand hands[2];
    mrt_result result = measure(&hands[MRT_LEFT], c, MRT_LEFT, err);
    if (result >= 0)
        result = measure(&hands[MRT_RIGHT], c, MRT_RIGHT, err);
    if (result < 0)
        return result;
    if (!hands[MRT_LEFT].is_there && !hands[MRT_RIGHT].is_there)
        return error_set(err, MRT_ERR_ARGUMENT, "%s: the performance has no hand to write", path);
    export_text text;
    result = export_text_open(&text, path, err);
    if (result < 0)
        return result;
    put_all(text.writer.stream, c, hands, 1.0 / mm_per_unit, progress);
    return export_text_close(&text, MRT_OK, err);
}
