#include "pose.h"

#include <string.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof *(array)))

/* ---- names ---- */

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
    "lid_lower.r.close",
};

int pose_layer(int index)
{
    if (index < POSE_DOFS) {
        int landmark = index / 3;
        return landmark < LANDMARK_CHEEK || landmark == LANDMARK_FOREHEAD_MID ? LAYER_BROWS
                                                                              : LAYER_MOUTH;
    }
    int dof = index - POSE_DOFS;
    if (dof <= DOF_JAW_FORWARD)
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
    for (int pair = DOF_EYE_YAW; pair < DOF_COUNT; pair += 2)
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

void pose_add_left(pose *p, const pose_part *parts, int count, double amount)
{
    for (int i = 0; i < count; ++i)
        add_at(p, parts[i].landmark, 1.0, &parts[i], amount);
}

void pose_add_right(pose *p, const pose_part *parts, int count, double amount)
{
    for (int i = 0; i < count; ++i)
        add_at(p, parts[i].landmark + 1, -1.0, &parts[i], amount);
}

/* On the midline nothing goes out. */
void pose_add(pose *p, const pose_part *parts, int count, double amount)
{
    for (int i = 0; i < count; ++i) {
        if (parts[i].landmark >= LANDMARK_FIRST_MID) {
            add_at(p, parts[i].landmark, 0.0, &parts[i], amount);
            continue;
        }
        pose_add_left(p, &parts[i], 1, amount);
        pose_add_right(p, &parts[i], 1, amount);
    }
}

/* ---- what an axis does, per mm: the muscles' directions, with their neighbours in part, for a
 * contact that is not pulled along holds its place ---- */

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
    pose_add_left(out, smirk_parts, COUNT_OF(smirk_parts), axes->smirk);
    pose_add_right(out, smirk_parts, COUNT_OF(smirk_parts), -axes->smirk);
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

void pose_from_axes(pose *out, const pose_axes *axes, const double *params)
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
