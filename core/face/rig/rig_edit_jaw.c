#include "face/rig/rig_edit_parts.h"

#include "base/angle.h"

#include <math.h>

static const double coordinate_cap = 1e6, least_width_mm = 2.0, farthest_mm = 1e4,
                    widest_rad = ANGLE_PI / 2.0;

void rig_edit_jaw_of(rig_edit_jaw *out, const rig *r, uint32_t bone)
{
    const rig_bone *jaw = &r->bone[bone];
    *out = (rig_edit_jaw){.left = jaw->hinge_left,
                          .right = jaw->hinge_right,
                          .incisor = jaw->incisor,
                          .has_incisor = jaw->has_incisor,
                          .open_min_rad = jaw->open_min_rad,
                          .open_max_rad = jaw->open_max_rad,
                          .lateral_mm = jaw->lateral_mm,
                          .forward_mm = jaw->forward_mm,
                          .slide_mm = jaw->slide_mm};
}

bool rig_edit_is_place(vec3 p)
{
    return fabs(p.x) <= coordinate_cap && fabs(p.y) <= coordinate_cap &&
           fabs(p.z) <= coordinate_cap;
}

static bool is_way(double mm)
{
    return mm >= 0.0 && mm <= farthest_mm;
}

static mrt_result check(const rig *r, uint32_t bone, const rig_edit_jaw *jaw, error *err)
{
    if (bone >= r->bone_count || r->bone[bone].kind != BONE_JAW)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no jaw to change");
    if (!rig_edit_is_place(jaw->left) || !rig_edit_is_place(jaw->right) ||
        !rig_edit_is_place(jaw->incisor))
        return error_set(err, MRT_ERR_ARGUMENT, "the jaw's axis is too far away");
    if (!(jaw->left.x - jaw->right.x >= least_width_mm))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the left end of the jaw's axis must be %.0f mm or more to the left of "
                         "the right one",
                         least_width_mm);
    if (!(jaw->open_min_rad <= 0.0 && jaw->open_min_rad >= -widest_rad) ||
        !(jaw->open_max_rad > 0.0 && jaw->open_max_rad <= widest_rad) || !is_way(jaw->lateral_mm) ||
        !is_way(jaw->forward_mm) || !is_way(jaw->slide_mm))
        return error_set(err, MRT_ERR_ARGUMENT, "the jaw's limits are not possible");
    return MRT_OK;
}

mrt_result rig_edit_set_jaw(rig *r, uint32_t bone, const rig_edit_jaw *jaw, error *err)
{
    mrt_result result = check(r, bone, jaw, err);
    if (result < 0)
        return result;
    rig_bone *to = &r->bone[bone];
    to->hinge_left = rig_edit_round_place(jaw->left, to->hinge_left);
    to->hinge_right = rig_edit_round_place(jaw->right, to->hinge_right);
    to->incisor =
        rig_edit_round_place(jaw->incisor, to->has_incisor ? to->incisor : rig_edit_nowhere);
    to->has_incisor = jaw->has_incisor;
    to->open_min_rad = rig_edit_round_rad(jaw->open_min_rad, to->open_min_rad);
    to->open_max_rad = rig_edit_round_rad(jaw->open_max_rad, to->open_max_rad);
    to->lateral_mm = rig_edit_round_mm(jaw->lateral_mm, to->lateral_mm);
    to->forward_mm = rig_edit_round_mm(jaw->forward_mm, to->forward_mm);
    to->slide_mm = rig_edit_round_mm(jaw->slide_mm, to->slide_mm);
    return MRT_OK;
}
