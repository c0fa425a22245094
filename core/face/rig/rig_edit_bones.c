#include "face/rig/rig_edit_parts.h"

#include "base/angle.h"
#include "face/rig/rig_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BONE_NAME_MAX = RIG_NAME_MAX - 8 }; /* with ".lateral" behind it a name of its own */
static const double least_half_mm = 1.0, most_half_mm = 1e6;
static const double up_and_down_rad = 25.0 * ANGLE_PI / 180.0,
                    to_the_sides_rad = 35.0 * ANGLE_PI / 180.0;

mrt_result rig_edit_check_bone(const rig *r, uint32_t index, error *err)
{
    return index < r->bone_count ? MRT_OK
                                 : error_set(err, MRT_ERR_ARGUMENT, "there is no bone %u", index);
}

static mrt_result check_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = rig_edit_check_name(name, err);
    if (result >= 0 && strlen(name) > BONE_NAME_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "the name of a bone has at most %d letters",
                         BONE_NAME_MAX);
    uint32_t other = result < 0 ? RIG_NONE : rig_find_bone(r, name);
    if (other != RIG_NONE && other != index)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "another bone is called \"%s\"; choose another name", name);
    return result;
}

/* ---- added ---- */

uint32_t rig_edit_dof_count(const rig *r)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->bone_count; ++i)
        count += r->bone[i].kind == BONE_JAW ? 3 : r->bone[i].turn_count;
    return count;
}

static bool has_jaw(const rig *r)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        if (r->bone[i].kind == BONE_JAW)
            return true;
    return false;
}

static mrt_result check_new(const rig *r, rig_bone_kind kind, vec3 at, double half_mm, error *err)
{
    const uint32_t moves = kind == BONE_JAW ? 3 : kind == BONE_BALL ? 2 : 0;
    if (r->bone_count >= RIG_BONES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig has at most %d bones", RIG_BONES_MAX);
    if (kind == BONE_JAW && has_jaw(r))
        return error_set(err, MRT_ERR_UNSUPPORTED, "there is a jaw already; a face has one");
    if (rig_edit_dof_count(r) + moves > MRT_MAX_DOFS)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the bones of a rig move in at most %d ways; take one out first",
                         MRT_MAX_DOFS);
    if (!rig_edit_is_place(at) || !(half_mm >= least_half_mm && half_mm <= most_half_mm))
        return error_set(err, MRT_ERR_ARGUMENT, "the bone is too far away, or too small");
    return MRT_OK;
}

static void make_jaw(rig_bone *out, vec3 at, double half_mm)
{
    const vec3 half = {half_mm, 0.0, 0.0};
    out->hinge_left = rig_edit_round_place(vec3_add(at, half), rig_edit_nowhere);
    out->hinge_right = rig_edit_round_place(vec3_sub(at, half), rig_edit_nowhere);
    out->open_max_rad = rig_adult_jaw.open_max_rad;
    out->lateral_mm = rig_adult_jaw.lateral_mm;
    out->forward_mm = rig_adult_jaw.forward_mm;
    out->slide_mm = rig_adult_jaw.slide_mm;
}

static void make_ball(rig_bone *out, vec3 at, double half_mm)
{
    out->centre = rig_edit_round_place(at, rig_edit_nowhere);
    out->radius_mm = rig_edit_round_mm(half_mm, rig_edit_nowhere.x);
    out->turn[0] = (rig_turn){strdup("yaw"), {0.0, 1.0, 0.0}, -to_the_sides_rad, to_the_sides_rad};
    out->turn[1] = (rig_turn){strdup("pitch"), {-1.0, 0.0, 0.0}, -up_and_down_rad, up_and_down_rad};
    out->turn_count = 2;
}

static void finish_bone(rig_bone *bone)
{
    free(bone->name);
    for (uint32_t k = 0; k < RIG_TURNS_MAX; ++k)
        free(bone->turn[k].name);
    *bone = (rig_bone){0};
}

mrt_result rig_edit_add_bone(rig *r, const char *name, rig_bone_kind kind, vec3 at, double half_mm,
                             uint32_t *out_index, error *err)
{
    mrt_result result = check_name(r, RIG_NONE, name, err);
    if (result >= 0)
        result = check_new(r, kind, at, half_mm, err);
    if (result < 0)
        return result;
    rig_bone made = {.name = strdup(name), .kind = kind, .parent = 0};
    if (kind == BONE_JAW)
        make_jaw(&made, at, half_mm);
    if (kind == BONE_BALL)
        make_ball(&made, at, half_mm);
    bool has_names = made.name && (kind != BONE_BALL || (made.turn[0].name && made.turn[1].name));
    if (!has_names) {
        finish_bone(&made);
        return rig_edit_no_memory(err);
    }
    *out_index = r->bone_count;
    r->bone[r->bone_count++] = made; /* there is room for RIG_BONES_MAX */
    return MRT_OK;
}

/* ---- taken out ---- */

static uint32_t heir_of(uint32_t bone, uint32_t removed, uint32_t heir)
{
    if (bone == RIG_NONE)
        return RIG_NONE;
    if (bone == removed)
        bone = heir;
    return bone > removed ? bone - 1 : bone;
}

static void give_to_heir(rig *r, uint32_t removed, uint32_t heir)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        r->region[i].bone = heir_of(r->region[i].bone, removed, heir);
    for (uint32_t i = 0; i < r->contact_count; ++i)
        r->contact[i].bone = heir_of(r->contact[i].bone, removed, heir);
    for (uint32_t i = 0; i < r->proxy_count; ++i)
        r->proxy[i].bone = heir_of(r->proxy[i].bone, removed, heir);
    for (uint32_t i = 0; i < r->bone_count; ++i)
        r->bone[i].parent = heir_of(r->bone[i].parent, removed, heir);
}

/* What is behind the bone's name in that of one of its ways to move; NULL: another bone's. */
static const char *motion_of(const char *dof, const char *bone)
{
    const size_t length = strlen(bone);
    return strncmp(dof, bone, length) == 0 && dof[length] == '.' ? dof + length + 1 : NULL;
}

static void take_out_of_pose(rig_pose *pose, const char *bone)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        if (motion_of(pose->dof_name[i], bone)) {
            free(pose->dof_name[i]);
            continue;
        }
        pose->dof_name[kept] = pose->dof_name[i];
        pose->dof_value[kept++] = pose->dof_value[i];
    }
    pose->dof_count = kept;
}

static mrt_result check_stays(const rig *r, uint32_t index, error *err)
{
    mrt_result result = rig_edit_check_bone(r, index, err);
    if (result >= 0 && (index == 0 || strcmp(r->bone[index].name, "skull") == 0))
        return error_set(err, MRT_ERR_UNSUPPORTED, "the bone \"%s\" carries the face: it stays",
                         r->bone[index].name);
    return result;
}

mrt_result rig_edit_remove_bone(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_stays(r, index, err);
    if (result < 0)
        return result;
    const uint32_t parent = r->bone[index].parent;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        take_out_of_pose(&r->pose[i], r->bone[index].name);
    give_to_heir(r, index, parent == RIG_NONE ? 0 : parent);
    finish_bone(&r->bone[index]);
    memmove(&r->bone[index], &r->bone[index + 1], (r->bone_count - index - 1) * sizeof *r->bone);
    r->bone_count -= 1;
    r->bone[r->bone_count] = (rig_bone){0};
    return MRT_OK;
}

/* ---- one of them ---- */

static uint32_t count_moves(const rig *r, const char *bone)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        for (uint32_t k = 0; k < r->pose[i].dof_count; ++k)
            count += motion_of(r->pose[i].dof_name[k], bone) != NULL;
    return count;
}

/* Makes the new names, or puts those that were made into the poses, in the same order. Returns how
 * many. */
static uint32_t visit_moves(rig *r, const char *before, const char *name, char **made, bool is_made)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        for (uint32_t k = 0; k < r->pose[i].dof_count; ++k) {
            char text[2 * RIG_NAME_MAX + 2];
            const char *motion = motion_of(r->pose[i].dof_name[k], before);
            if (!motion)
                continue;
            if (is_made) {
                free(r->pose[i].dof_name[k]);
                r->pose[i].dof_name[k] = made[count++];
                continue;
            }
            (void)snprintf(text, sizeof text, "%s.%s", name, motion);
            made[count] = strdup(text);
            if (!made[count++])
                return count - 1;
        }
    return count;
}

/* All names are made before any is put in: on error nothing has changed. */
static mrt_result rename_in_poses(rig *r, const char *before, const char *name, error *err)
{
    const uint32_t wanted = count_moves(r, before);
    char **made = calloc(wanted + 1u, sizeof *made);
    uint32_t count = made ? visit_moves(r, before, name, made, false) : 0;
    mrt_result result = made && count == wanted ? MRT_OK : rig_edit_no_memory(err);
    if (result >= 0)
        (void)visit_moves(r, before, name, made, true);
    for (uint32_t i = 0; result < 0 && i < count; ++i)
        free(made[i]);
    free(made);
    return result;
}

static mrt_result check_turn_names(const rig_bone *bone, const char *name, error *err)
{
    for (uint32_t i = 0; i < bone->turn_count; ++i)
        if (strlen(name) + 1 + strlen(bone->turn[i].name) > RIG_NAME_MAX)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "\"%s.%s\" is longer than %d letters; choose a shorter name", name,
                             bone->turn[i].name, RIG_NAME_MAX);
    return MRT_OK;
}

mrt_result rig_edit_name_bone(rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_stays(r, index, err);
    if (result >= 0)
        result = check_name(r, index, name, err);
    if (result >= 0)
        result = check_turn_names(&r->bone[index], name, err);
    char *copy = result < 0 ? NULL : strdup(name);
    if (result >= 0 && !copy)
        return rig_edit_no_memory(err);
    if (result >= 0)
        result = rename_in_poses(r, r->bone[index].name, name, err);
    if (result < 0) {
        free(copy);
        return result;
    }
    free(r->bone[index].name);
    r->bone[index].name = copy;
    return MRT_OK;
}

mrt_result rig_edit_set_ball(rig *r, uint32_t index, vec3 centre, double radius_mm, error *err)
{
    mrt_result result = rig_edit_check_bone(r, index, err);
    if (result < 0)
        return result;
    if (r->bone[index].kind != BONE_BALL)
        return error_set(err, MRT_ERR_ARGUMENT, "the bone \"%s\" is no ball", r->bone[index].name);
    if (!rig_edit_is_place(centre) || !(radius_mm >= 0.0 && radius_mm <= most_half_mm))
        return error_set(err, MRT_ERR_ARGUMENT, "the ball is too far away, or too large");
    rig_bone *to = &r->bone[index];
    to->centre = rig_edit_round_place(centre, to->centre);
    to->radius_mm = rig_edit_round_mm(radius_mm, to->radius_mm);
    return MRT_OK;
}

mrt_result rig_edit_ride_bone(rig *r, uint32_t index, uint32_t parent, error *err)
{
    mrt_result result = check_stays(r, index, err);
    if (result < 0)
        return result;
    if (parent != RIG_NONE && parent >= index)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the bone \"%s\" can ride on one that is listed before it",
                         r->bone[index].name);
    r->bone[index].parent = parent;
    return MRT_OK;
}
