/* Keeps the tongue behind closed lips. Bones, pulls and the seal leave a gap between the rims in
 * the middle of the mouth. Up to free_rad the tip of the tongue is behind the lips in any case.
 * Beyond that the tongue may turn out in proportion to the gap. It may turn out fully if the gap is
 * as high as the part of the tongue that is outside. meter.dof contains the reduced turn, so
 * recordings and exports contain it, too. */
#include "face/frame/frame.h"

#include <math.h>
#include <string.h>

enum { STEPS = 64 };
static const double behind_mm = 2.0; /* behind the edge of the lips */
static const float of_tongue = 0.99f;

typedef struct tongue_reach {
    double before_mm;       /* distance of its foremost point in front of the lips */
    double low_mm, high_mm; /* of the part in front of the lips, along `up` */
} tongue_reach;

static tongue_reach reach_of(const face *f, double angle_rad)
{
    const rig_bone *bone = &f->rig->bone[f->tongue.bone];
    const bind_lips *slit = &f->binding.lips;
    const rigid turned = rigid_turn(bone->centre, bone->turn[0].axis, angle_rad);
    const vec3 forward = vec3_cross(slit->across, slit->up);
    const vec3 lips = vec3_row(f->lips.rest, f->lips.middle);
    tongue_reach out = {-INFINITY, INFINITY, -INFINITY};
    for (uint32_t slot = 0; slot < f->rest.count; ++slot) {
        if (!(f->field[f->tongue.bone].weight[slot] > of_tongue))
            continue;
        vec3 way = vec3_sub(rigid_apply(&turned, points_position(&f->rest, slot)), lips);
        double before = vec3_dot(way, forward), up = vec3_dot(way, slit->up);
        out.before_mm = fmax(out.before_mm, before);
        out.low_mm = before > -behind_mm ? fmin(out.low_mm, up) : out.low_mm;
        out.high_mm = before > -behind_mm ? fmax(out.high_mm, up) : out.high_mm;
    }
    return out;
}

void face_tongue_create(face *f)
{
    face_tongue *t = &f->tongue;
    t->bone = f->rig && f->lips.count > 0 ? rig_find_bone(f->rig, "tongue") : RIG_NONE;
    if (t->bone == RIG_NONE)
        return;
    const rig_bone *bone = &f->rig->bone[t->bone];
    const rig_turn *turn = &bone->turn[0];
    if (bone->kind != BONE_BALL || bone->turn_count != 1 || !(turn->max_rad > 0.0)) {
        t->bone = RIG_NONE;
        return;
    }
    t->free_rad = 0.0;
    for (int i = 1; i <= STEPS; ++i) {
        double angle_rad = turn->max_rad * i / STEPS;
        if (reach_of(f, angle_rad).before_mm > -behind_mm)
            break;
        t->free_rad = angle_rad;
    }
    const tongue_reach out = reach_of(f, turn->max_rad);
    t->height_mm = fmax(out.high_mm - out.low_mm, 1.0);
}

void face_tongue_limit(face *f)
{
    const face_tongue *t = &f->tongue;
    if (t->bone == RIG_NONE)
        return;
    const rig_turn *turn = &f->rig->bone[t->bone].turn[0];
    const uint32_t at = f->bones.first_dof[t->bone];
    if (!((double)f->meter.dof[at] > t->free_rad))
        return;
    double open = fmin(fmax(face_lips_open_mm(f) / t->height_mm, 0.0), 1.0);
    double most_rad = t->free_rad + open * (turn->max_rad - t->free_rad);
    if (!((double)f->meter.dof[at] > most_rad))
        return;
    float dof[MRT_MAX_DOFS];
    rigid pose[RIG_BONES_MAX];
    memcpy(dof, f->dof, sizeof dof);
    dof[at] = (float)bones_soft_limit_inverse(most_rad, turn->min_rad, turn->max_rad);
    face_pose_bones(f, pose, dof);
    face_note_dofs(f, dof);
    f->pose[t->bone] = pose[t->bone];
    face_weigh_bone(f, f->weight, t->bone, f->pose);
    face_weigh_bone(f, f->given, t->bone, f->pose);
}
