#include "face/rig/rig_edit_parts.h"

#include "face/rig/rig_document.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static mrt_result check_index(const rig *r, uint32_t index, error *err)
{
    return index < r->pose_count ? MRT_OK
                                 : error_set(err, MRT_ERR_ARGUMENT, "there is no pose %u", index);
}

static mrt_result check_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = rig_edit_check_name(name, err);
    for (uint32_t i = 0; result >= 0 && i < r->pose_count; ++i)
        if (i != index && strcmp(r->pose[i].name, name) == 0)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "another pose is called \"%s\"; choose another name", name);
    return result;
}

static mrt_result check(const rig *r, const rig_pose *pose, error *err)
{
    static const double most = 100.0; /* rad or mm: more than any bone moves */
    mrt_result result = check_name(r, RIG_NONE, pose->name, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        if (rig_dof_unit_of(r, pose->dof_name[i]) == RIG_DOF_UNKNOWN)
            return error_set(err, MRT_ERR_ARGUMENT, "no bone moves by \"%s\"", pose->dof_name[i]);
        if (!(fabs(pose->dof_value[i]) <= most))
            return error_set(err, MRT_ERR_ARGUMENT, "the pose turns a bone too far");
    }
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        if (pose->pull_contact[i] >= r->contact_count || !rig_edit_is_place(pose->pull_mm[i]))
            return error_set(err, MRT_ERR_ARGUMENT, "the pose pulls at what is not there");
    return MRT_OK;
}

static void finish_pose(rig_pose *pose)
{
    free(pose->name);
    for (uint32_t i = 0; i < pose->dof_count; ++i)
        free(pose->dof_name[i]);
    free(pose->dof_name);
    free(pose->dof_value);
    free(pose->pull_contact);
    free(pose->pull_mm);
    *pose = (rig_pose){0};
}

static double rounded(const rig *r, const char *dof, double value)
{
    return rig_dof_unit_of(r, dof) == RIG_DOF_RAD ? rig_edit_round_rad(value, (double)NAN)
                                                  : rig_edit_round_mm(value, (double)NAN);
}

static bool copy_pose(rig_pose *out, const rig_pose *from, const rig *r)
{
    *out = (rig_pose){.name = strdup(from->name),
                      .dof_name = calloc(from->dof_count + 1u, sizeof *out->dof_name),
                      .dof_value = calloc(from->dof_count + 1u, sizeof *out->dof_value),
                      .pull_contact = calloc(from->pull_count + 1u, sizeof *out->pull_contact),
                      .pull_mm = calloc(from->pull_count + 1u, sizeof *out->pull_mm)};
    if (!out->name || !out->dof_name || !out->dof_value || !out->pull_contact || !out->pull_mm)
        return false;
    for (uint32_t i = 0; i < from->dof_count; ++i) {
        out->dof_name[i] = strdup(from->dof_name[i]);
        out->dof_value[i] = rounded(r, from->dof_name[i], from->dof_value[i]);
        out->dof_count = i + 1;
        if (!out->dof_name[i])
            return false;
    }
    for (uint32_t i = 0; i < from->pull_count; ++i) {
        out->pull_contact[i] = from->pull_contact[i];
        out->pull_mm[i] = rig_edit_round_place(from->pull_mm[i], rig_edit_nowhere);
    }
    out->pull_count = from->pull_count;
    return true;
}

mrt_result rig_edit_add_pose(rig *r, const rig_pose *pose, uint32_t *out_index, error *err)
{
    rig_pose made;
    mrt_result result = check(r, pose, err);
    if (result < 0)
        return result;
    if (r->pose_count >= RIG_EDIT_ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig has at most %d poses",
                         RIG_EDIT_ENTRIES_MAX);
    rig_pose *grown = realloc(r->pose, (r->pose_count + 2u) * sizeof *grown);
    if (!grown)
        return rig_edit_no_memory(err);
    r->pose = grown;
    if (!copy_pose(&made, pose, r)) {
        finish_pose(&made);
        return rig_edit_no_memory(err);
    }
    r->pose[r->pose_count] = made;
    *out_index = r->pose_count;
    r->pose_count += 1;
    return MRT_OK;
}

mrt_result rig_edit_remove_pose(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result < 0)
        return result;
    finish_pose(&r->pose[index]);
    memmove(&r->pose[index], &r->pose[index + 1], (r->pose_count - index - 1) * sizeof *r->pose);
    r->pose_count -= 1;
    return MRT_OK;
}

mrt_result rig_edit_name_pose(rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result >= 0)
        result = check_name(r, index, name, err);
    return result < 0 ? result : rig_edit_rename(&r->pose[index].name, name, err);
}
