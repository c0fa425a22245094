#include "face/rig/rig_edit_parts.h"

#include "base/angle.h"
#include "face/rig/rig_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double least_axis = 1e-6, farthest_rad = ANGLE_PI;

/* ---- what may be ---- */

static mrt_result check_ball(const rig *r, uint32_t bone, error *err)
{
    mrt_result result = rig_edit_check_bone(r, bone, err);
    if (result >= 0 && r->bone[bone].kind != BONE_BALL)
        return error_set(err, MRT_ERR_ARGUMENT, "the bone \"%s\" is no ball", r->bone[bone].name);
    return result;
}

static mrt_result check_turn_index(const rig *r, uint32_t bone, uint32_t turn, error *err)
{
    mrt_result result = check_ball(r, bone, err);
    if (result >= 0 && turn >= r->bone[bone].turn_count)
        return error_set(err, MRT_ERR_ARGUMENT, "the ball \"%s\" has no turn %u",
                         r->bone[bone].name, turn);
    return result;
}

static mrt_result check_name(const rig_bone *ball, uint32_t turn, const char *name, error *err)
{
    mrt_result result = rig_edit_check_name(name, err);
    if (result < 0)
        return result;
    if (strlen(ball->name) + 1 + strlen(name) > RIG_NAME_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "\"%s.%s\" is longer than %d letters; choose a shorter name", ball->name,
                         name, RIG_NAME_MAX);
    for (uint32_t i = 0; i < ball->turn_count; ++i)
        if (i != turn && strcmp(ball->turn[i].name, name) == 0)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "another turn is called \"%s\"; choose another name", name);
    return MRT_OK;
}

/* Around the rest, and some way: as the reader has it. */
static mrt_result check_way(const rig_turn *turn, error *err)
{
    const double length = vec3_length(turn->axis);
    if (!(length > least_axis && length <= 1e6))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the turn needs an axis: a direction that is not 0");
    if (!(turn->min_rad >= -farthest_rad && turn->min_rad <= 0.0 && turn->max_rad >= 0.0 &&
          turn->max_rad <= farthest_rad))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a turn goes from -180..0 to 0..180 degrees: 0 is the pose of the mesh");
    if (!(turn->min_rad < turn->max_rad))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the turn goes nowhere; give one of its limits some degrees");
    return MRT_OK;
}

static vec3 axis_of(vec3 axis)
{
    const vec3 unit = vec3_normalised(axis, (vec3){1.0, 0.0, 0.0});
    return vec3_normalised(rig_round_axis(unit), unit);
}

static bool is_same(vec3 a, vec3 b)
{
    return !(vec3_length(vec3_sub(a, b)) > 1e-12);
}

/* As it will be read again. */
static mrt_result round_turn(rig_turn *out, const rig_turn *turn, const rig_turn *before,
                             error *err)
{
    mrt_result result = check_way(turn, err);
    if (result < 0)
        return result;
    *out = *turn;
    out->axis = is_same(turn->axis, before->axis) ? before->axis : axis_of(turn->axis);
    out->min_rad = rig_edit_round_rad(turn->min_rad, before->min_rad);
    out->max_rad = rig_edit_round_rad(turn->max_rad, before->max_rad);
    return check_way(out, err);
}

/* ---- names in poses ---- */

static bool is_dof(const char *dof, const char *bone, const char *turn)
{
    const size_t length = strlen(bone);
    return strncmp(dof, bone, length) == 0 && dof[length] == '.' &&
           strcmp(dof + length + 1, turn) == 0;
}

static uint32_t place_in(const rig_pose *pose, const char *bone, const char *turn)
{
    uint32_t i = 0;
    while (i < pose->dof_count && !is_dof(pose->dof_name[i], bone, turn))
        i += 1;
    return i;
}

static void forget_in_poses(rig *r, const char *bone, const char *turn)
{
    for (uint32_t i = 0; i < r->pose_count; ++i) {
        rig_pose *pose = &r->pose[i];
        const uint32_t at = place_in(pose, bone, turn);
        if (at == pose->dof_count)
            continue;
        free(pose->dof_name[at]);
        pose->dof_count -= 1;
        for (uint32_t k = at; k < pose->dof_count; ++k) {
            pose->dof_name[k] = pose->dof_name[k + 1];
            pose->dof_value[k] = pose->dof_value[k + 1];
        }
    }
}

/* All names are made before any is put in: on error nothing has changed. */
static mrt_result rename_in_poses(rig *r, const char *bone, const char *turn, const char *name,
                                  error *err)
{
    char text[2 * RIG_NAME_MAX + 2];
    char **made = calloc(r->pose_count + 1u, sizeof *made);
    bool has_all = made != NULL;
    (void)snprintf(text, sizeof text, "%s.%s", bone, name);
    for (uint32_t i = 0; has_all && i < r->pose_count; ++i) {
        if (place_in(&r->pose[i], bone, turn) == r->pose[i].dof_count)
            continue;
        made[i] = strdup(text);
        has_all = made[i] != NULL;
    }
    for (uint32_t i = 0; made && i < r->pose_count; ++i) {
        if (has_all && made[i]) {
            char **dof = &r->pose[i].dof_name[place_in(&r->pose[i], bone, turn)];
            char *old = *dof;
            *dof = made[i];
            made[i] = old;
        }
        free(made[i]);
    }
    free(made);
    return has_all ? MRT_OK : rig_edit_no_memory(err);
}

/* ---- changes ---- */

mrt_result rig_edit_add_turn(rig *r, uint32_t bone, const rig_turn *turn, uint32_t *out_index,
                             error *err)
{
    const rig_turn none = {NULL, {0.0, 0.0, 0.0}, (double)NAN, (double)NAN};
    rig_turn made;
    mrt_result result = check_ball(r, bone, err);
    if (result < 0)
        return result;
    rig_bone *ball = &r->bone[bone];
    if (ball->turn_count >= RIG_TURNS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a ball has at most %d turns", RIG_TURNS_MAX);
    if (rig_edit_dof_count(r) >= MRT_MAX_DOFS)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the bones of a rig move in at most %d ways; take one out first",
                         MRT_MAX_DOFS);
    result = check_name(ball, RIG_NONE, turn->name, err);
    if (result >= 0)
        result = round_turn(&made, turn, &none, err);
    if (result < 0)
        return result;
    made.name = strdup(turn->name);
    if (!made.name)
        return rig_edit_no_memory(err);
    *out_index = ball->turn_count;
    ball->turn[ball->turn_count++] = made;
    return MRT_OK;
}

mrt_result rig_edit_remove_turn(rig *r, uint32_t bone, uint32_t turn, error *err)
{
    mrt_result result = check_turn_index(r, bone, turn, err);
    if (result < 0)
        return result;
    rig_bone *ball = &r->bone[bone];
    if (ball->turn_count == 1)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a ball has one turn at least: this one stays");
    forget_in_poses(r, ball->name, ball->turn[turn].name);
    free(ball->turn[turn].name);
    memmove(&ball->turn[turn], &ball->turn[turn + 1],
            (ball->turn_count - turn - 1) * sizeof *ball->turn);
    ball->turn_count -= 1;
    ball->turn[ball->turn_count] = (rig_turn){0};
    return MRT_OK;
}

mrt_result rig_edit_set_turn(rig *r, uint32_t bone, uint32_t turn, const rig_turn *to, error *err)
{
    rig_turn made;
    mrt_result result = check_turn_index(r, bone, turn, err);
    if (result < 0)
        return result;
    rig_bone *ball = &r->bone[bone];
    rig_turn *there = &ball->turn[turn];
    result = check_name(ball, turn, to->name, err);
    if (result >= 0)
        result = round_turn(&made, to, there, err);
    if (result < 0)
        return result;
    made.name = strdup(to->name);
    result = made.name ? rename_in_poses(r, ball->name, there->name, made.name, err)
                       : rig_edit_no_memory(err);
    if (result < 0) {
        free(made.name);
        return result;
    }
    free(there->name);
    *there = made;
    return MRT_OK;
}
