#include "osc_vmc.h"

#include <math.h>
#include <string.h>

/* Sensor order of plugin.h. */
enum {
    THUMB_ROLL = 0,
    THUMB_MPJ = 1,
    THUMB_IJ = 2,
    THUMB_ABDUCTION = 3,
    MIDDLE_INDEX_SPREAD = 10,
    RING_MIDDLE_SPREAD = 14,
    LITTLE_RING_SPREAD = 18,
    WRIST_PITCH = 20,
    WRIST_YAW = 21
};
static const int finger_mpj[4] = {4, 7, 11, 15}; /* index..little; PIJ and DIJ follow */
static const char *const finger_name[5] = {"Thumb", "Index", "Middle", "Ring", "Little"};
static const char *const joint_name[3] = {"Proximal", "Intermediate", "Distal"};

static const double half_turn_rad = 3.14159265358979323846;
/* The T-pose's thumb stands off the fingers by 45 degrees; a hand whose thumb abduction is 0 by
 * 0.15 rad, as core/hand's skeleton has it. */
static const double thumb_rest_rad = 3.14159265358979323846 / 4 - 0.15;

/* Takes the word off the front of the text. */
static bool skip_word(const char **text, const char *word)
{
    size_t length = strlen(word);
    if (strncmp(*text, word, length) != 0)
        return false;
    *text += length;
    return true;
}

bool osc_vmc_bone_find(osc_vmc_bone *out, const char *name)
{
    if (skip_word(&name, "Left"))
        out->side = MRT_LEFT;
    else if (skip_word(&name, "Right"))
        out->side = MRT_RIGHT;
    else
        return false;
    out->joint = 0;
    out->finger = OSC_VMC_HAND;
    if (strcmp(name, "Hand") == 0)
        return true;
    for (out->finger = 0; out->finger < 5; ++out->finger)
        if (skip_word(&name, finger_name[out->finger]))
            break;
    if (out->finger == 5)
        return false;
    out->joint = OSC_VMC_METACARPAL;
    if (out->finger == OSC_VMC_THUMB && strcmp(name, "Metacarpal") == 0)
        return true;
    for (out->joint = 0; out->joint < 3; ++out->joint)
        if (strcmp(name, joint_name[out->joint]) == 0)
            return true;
    return false;
}

void osc_vmc_settle(osc_vmc_pose *pose, osc_vmc_bone *bone)
{
    if (bone->finger != OSC_VMC_THUMB)
        return;
    if (bone->joint == OSC_VMC_METACARPAL)
        pose->is_vrm1 = true;
    else if (bone->joint == 1)
        pose->is_vrm1 = false;
    if (bone->joint == OSC_VMC_METACARPAL)
        bone->joint = 0;
    else if (bone->joint == 0 && pose->is_vrm1)
        bone->joint = 1;
}

/* The turn about one axis that is in a quaternion, -pi..pi: twice the angle of its part along the
 * axis against w. In a product of a turn about this axis and one about another it is the former,
 * whatever their order. */
static double turn_about(double along, double w)
{
    double turn_rad = 2 * atan2(along, w);
    if (turn_rad > half_turn_rad)
        turn_rad -= 2 * half_turn_rad;
    if (turn_rad < -half_turn_rad)
        turn_rad += 2 * half_turn_rad;
    return turn_rad;
}

/* A bone's turns as a right hand would make them. */
typedef struct turns {
    double flexion_rad;      /* fingers and wrist, towards the palm */
    double aside_rad;        /* to the thumb's side */
    double across_rad;       /* the thumb's base, towards the palm */
    double thumb_inward_rad; /* the thumb, towards the fingers: how it bends */
} turns;

static turns turns_of(uint32_t side, const float *xyzw)
{
    double mirror = side == MRT_RIGHT ? 1 : -1, w = (double)xyzw[3];
    double x = (double)xyzw[0], y = mirror * (double)xyzw[1], z = mirror * (double)xyzw[2];
    return (turns){.flexion_rad = -turn_about(z, w),
                   .aside_rad = -turn_about(y, w),
                   .across_rad = turn_about(x, w),
                   .thumb_inward_rad = turn_about(y, w)};
}

static void apply_thumb(uint32_t joint, const turns *made, float *angle_rad)
{
    if (joint == 0) {
        angle_rad[THUMB_ROLL] = (float)made->across_rad;
        angle_rad[THUMB_ABDUCTION] = (float)(thumb_rest_rad - made->thumb_inward_rad);
    } else {
        angle_rad[joint == 1 ? THUMB_MPJ : THUMB_IJ] = (float)made->thumb_inward_rad;
    }
}

static void apply_spreads(const osc_vmc_pose *pose, float *angle_rad)
{
    const double *aside_rad = pose->aside_rad;
    angle_rad[MIDDLE_INDEX_SPREAD] = (float)(aside_rad[0] - aside_rad[1]);
    angle_rad[RING_MIDDLE_SPREAD] = (float)(aside_rad[1] - aside_rad[2]);
    angle_rad[LITTLE_RING_SPREAD] = (float)(aside_rad[2] - aside_rad[3]);
}

void osc_vmc_apply(osc_vmc_pose *pose, const osc_vmc_bone *bone, const float *xyzw,
                   float *angle_rad)
{
    turns made = turns_of(bone->side, xyzw);
    if (bone->finger == OSC_VMC_HAND) {
        angle_rad[WRIST_PITCH] = (float)made.flexion_rad;
        angle_rad[WRIST_YAW] = (float)made.aside_rad;
        return;
    }
    if (bone->finger == OSC_VMC_THUMB) {
        apply_thumb(bone->joint, &made, angle_rad);
        return;
    }
    uint32_t finger = bone->finger - OSC_VMC_INDEX;
    angle_rad[finger_mpj[finger] + (int)bone->joint] = (float)made.flexion_rad;
    if (bone->joint > 0)
        return;
    pose->aside_rad[finger] = made.aside_rad;
    apply_spreads(pose, angle_rad);
}
