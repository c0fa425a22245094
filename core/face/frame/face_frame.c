#include "face/frame/frame.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 5 };

/* ---- the pose ---- */

static bool jaw_is_driven(const bones *b, const float *dof)
{
    const float *jaw = dof + b->first_dof[b->jaw];
    return !(isnan(jaw[0]) && isnan(jaw[1]) && isnan(jaw[2]));
}

/* Computes the target of the jaw alone for each control that rides on it, in the frame of the jaw's
 * parent. */
static void find_jaw_targets(face *f, const rigid *pose, const double *end, double *target)
{
    const bones *b = &f->bones;
    uint32_t parent = f->rig->bone[b->jaw].parent;
    rigid out = parent != RIG_NONE ? rigid_inverse(&pose[parent]) : rigid_identity();
    for (uint32_t k = 0; k < f->control_count; ++k) {
        face_grip others = f->grip[k];
        double jaw_share = 0.0;
        f->scratch[k] = others.riding;
        if (!(others.riding > 0.0))
            continue;
        for (uint32_t bone = 0; bone < f->bone_count; ++bone) {
            uint32_t on = bone;
            while (on != RIG_NONE && on != b->jaw)
                on = f->rig->bone[on].parent;
            if (on == RIG_NONE)
                continue;
            jaw_share += others.share[bone];
            others.share[bone] = 0.0;
        }
        blend other = face_blend_at(f, &others, pose);
        vec3 way = vec3_sub(vec3_row(end, k), others.start);
        way = vec3_scale(vec3_sub(way, blend_moves(&other, others.start)), 1.0 / jaw_share);
        vec3 to = rigid_apply(&out, vec3_add(others.start, way));
        vec3_set_row(target, k, to);
        vec3_set_row(f->position, k, others.start);
    }
}

mrt_result face_resolve_dofs(face *f, float *out, const float *dof, const double *end, error *err)
{
    const bones *b = &f->bones;
    memset(out, 0, MRT_MAX_DOFS * sizeof *out);
    for (uint32_t i = 0; i < b->dof_count; ++i) {
        if (dof && isinf(dof[i]))
            return error_set(err, MRT_ERR_ARGUMENT, "%s is not a number", b->dof[i].name);
        out[i] = !dof || isnan(dof[i]) ? 0.0f : dof[i];
    }
    if (b->jaw == RIG_NONE || (dof && jaw_is_driven(b, dof)))
        return MRT_OK;
    float *jaw = out + b->first_dof[b->jaw];
    memcpy(jaw, f->dof + b->first_dof[b->jaw], 3 * sizeof *jaw);
    if (!end || f->control_count == 0)
        return MRT_OK;
    rigid pose[RIG_BONES_MAX];
    face_pose_bones(f, pose, out);
    find_jaw_targets(f, pose, end, f->g);
    bones_derive_jaw(jaw, b, f->position, f->g, f->scratch, f->control_count);
    return MRT_OK;
}

/* ---- displacement by the controls ---- */

/* Sets f->position to the distance of each control from its end after the bones have moved, divided
 * by its mobility. Sets f->rotation to (sum of share_b R_b over its own bones)^-1. */
static void measure_rest(face *f, const double *end, const rigid *pose)
{
    for (uint32_t k = 0; k < f->control_count; ++k) {
        const face_grip *grip = &f->grip[k];
        blend posed = face_blend_at(f, grip, pose);
        vec3 moved = blend_moves(&posed, grip->start), shaped = face_shapes_at(f, k);
        moved = vec3_add(moved, vec3_add(shaped, matrix3x3_apply(&posed.rotation, shaped)));
        face_grip own = *grip;
        for (uint32_t b = 0; b < f->bone_count; ++b)
            own.share[b] = grip->belongs[b] ? grip->share[b] : 0.0;
        matrix3x3 whole = face_blend_at(f, &own, pose).rotation;
        for (int i = 0; i < 3; ++i)
            whole.at[i][i] += face_share_held(f, grip);
        if (grip->is_dropped || !matrix3x3_invert(&f->rotation[k], &whole))
            f->rotation[k] = (matrix3x3){{{0}}};
        f->position[3 * k] = (end[3 * k] - grip->start.x - moved.x) / grip->mobility;
        f->position[3 * k + 1] = (end[3 * k + 1] - grip->start.y - moved.y) / grip->mobility;
        f->position[3 * k + 2] = (end[3 * k + 2] - grip->start.z - moved.z) / grip->mobility;
    }
}

/* Returns the displacement of a control by fields that it does not belong to. Its share of those
 * bones is too small for their fields, but they still move it a little. */
static vec3 stray(const face *f, uint32_t k, const rigid *pose)
{
    vec3 sum = {0, 0, 0};
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        const face_grip *grip = &f->grip[k];
        const float *row =
            f->cross + (size_t)field->first_column * f->grip_position.padded_count + k;
        vec3 here = {0, 0, 0};
        if (grip->belongs[b] || grip->share[b] == 0.0)
            continue;
        for (uint32_t i = 0; i < field->control_count; ++i, row += f->grip_position.padded_count) {
            const double *g = f->g + (size_t)3 * field->control[i];
            here = vec3_add(here, vec3_scale(vec3_row(g, 0), (double)*row));
        }
        sum = vec3_add(sum, vec3_scale(rigid_rotate(&pose[b], here), grip->share[b]));
    }
    return sum;
}

/* Solves for f->g, with which each control lands on its end. The fields interact only through
 * shares below 2 % (stray), so a few sweeps of Gauss-Seidel are enough. */
static void solve_grips(face *f, const double *end, const rigid *pose)
{
    measure_rest(f, end, pose);
    memset(f->g, 0, (size_t)3 * f->control_count * sizeof *f->g);
    for (int sweep = 0; sweep < (f->bone_count > 1 ? SWEEPS : 1); ++sweep)
        for (uint32_t k = 0; k < f->control_count; ++k) {
            if (f->grip[k].is_dropped) /* in no field; with one bone it has no cross values */
                continue;
            vec3 rest = {f->position[3 * k], f->position[3 * k + 1], f->position[3 * k + 2]};
            vec3 g = matrix3x3_apply(&f->rotation[k], vec3_sub(rest, stray(f, k, pose)));
            vec3_set_row(f->g, k, g);
        }
}

/* Writes the weights of the columns to next_weight, and the greatest slope bound of the fields to
 * out_slope. */
static mrt_result weigh_controls(face *f, const rigid *pose, double *out_slope, error *err)
{
    *out_slope = 0.0;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const face_field *field = &f->field[b];
        double *weight = f->next_weight + (size_t)3 * field->first_column;
        if (field->control_count == 0)
            continue;
        for (uint32_t i = 0; i < field->control_count; ++i) {
            const double *g = f->g + (size_t)3 * field->control[i];
            vec3 turned = vec3_row(g, 0);
            memcpy(f->scratch + 3 * i, g, 3 * sizeof *g);
            if (f->bones.moves[b])
                turned = rigid_rotate(&pose[b], turned);
            vec3_set_row(weight, i, turned);
        }
        mrt_result result = csrbf_solve(field->solver, f->scratch, err);
        if (result < 0)
            return result;
        *out_slope = fmax(*out_slope, csrbf_diagnose(field->solver).slope_bound);
    }
    return MRT_OK;
}

static mrt_result check_ends(const face *f, const double *end, error *err)
{
    for (size_t i = 0; i < (size_t)3 * f->control_count; ++i)
        if (!(fabs(end[i]) <= (double)POINTS_REACH))
            return error_set(err, MRT_ERR_ARGUMENT, "control %u: its end %g is not within +-%g",
                             (uint32_t)(i / 3), end[i], (double)POINTS_REACH);
    return MRT_OK;
}

mrt_result face_aim(face *f, const double *end, const float *dof, error *err)
{
    float resolved[MRT_MAX_DOFS];
    rigid pose[RIG_BONES_MAX];
    double slope = 0.0;
    mrt_result result = check_ends(f, end, err);
    if (result >= 0)
        result = face_resolve_dofs(f, resolved, dof, end, err);
    if (result < 0)
        return result;
    if (f->shapes.count > 0 && f->shapes.amount > 0.0)
        face_shapes_solve(f, resolved, dof, end);
    face_pose_bones(f, pose, resolved);
    solve_grips(f, end, pose);
    result = weigh_controls(f, pose, &slope, err);
    if (result < 0)
        return result;
    face_pose_weights(f, f->next_weight, pose);
    memcpy(f->weight, f->next_weight, (size_t)3 * f->columns.count * sizeof *f->weight);
    face_set_pose(f, resolved, pose);
    f->meter.slope_bound = slope;
    return MRT_OK;
}

mrt_result face_pull(face *f, const double *end, const float *dof, error *err)
{
    mrt_result result = face_aim(f, end, dof, err);
    if (result >= 0)
        face_show(f);
    return result;
}

/* Poses the bones that `dof` drives, and lets loose parts swing. The others are at rest. */
static void pose_driven(const face *f, rigid *pose, float driven[MRT_MAX_DOFS], const float *dof)
{
    memset(driven, 0, MRT_MAX_DOFS * sizeof *driven);
    for (uint32_t i = 0; i < f->bones.dof_count; ++i)
        driven[i] = dof && isfinite(dof[i]) ? dof[i] : 0.0f;
    face_pose_bones(f, pose, driven);
}

void face_ride(const face *f, double *end, const uint8_t *rides, const float *dof)
{
    rigid pose[RIG_BONES_MAX];
    float driven[MRT_MAX_DOFS];
    pose_driven(f, pose, driven, dof);
    for (uint32_t k = 0; k < f->control_count; ++k) {
        if (!rides[k])
            continue;
        const face_grip *grip = &f->grip[k];
        blend posed = face_blend_at(f, grip, pose);
        vec3 pulled = vec3_add(grip->start, vec3_row(end, k));
        vec3 to = blend_apply(&posed, vec3_add(pulled, face_shapes_led_at(f, k, driven)));
        vec3_set_row(end, k, to);
    }
}

void face_unride(const face *f, double *end, const float *dof)
{
    rigid pose[RIG_BONES_MAX];
    float driven[MRT_MAX_DOFS];
    pose_driven(f, pose, driven, dof);
    for (uint32_t k = 0; k < f->control_count; ++k) {
        const face_grip *grip = &f->grip[k];
        blend posed = face_blend_at(f, grip, pose);
        vec3 at_rest = blend_undo(&posed, vec3_row(end, k));
        vec3 pull = vec3_sub(vec3_sub(at_rest, grip->start), face_shapes_led_at(f, k, driven));
        vec3_set_row(end, k, pull);
    }
}
