#include "face/rig/rig_edit_parts.h"

#include "face/rig/rig_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mrt_result check_index(const rig *r, uint32_t index, error *err)
{
    return index < r->contact_count
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT, "there is no contact %u", index);
}

static mrt_result check_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = rig_edit_check_name(name, err);
    uint32_t other = result < 0 ? RIG_NONE : rig_find_contact(r, name);
    if (other != RIG_NONE && other != index)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "another contact is called \"%s\"; choose another name", name);
    return result;
}

mrt_result rig_edit_add_contact(rig *r, const char *name, uint32_t vertex, uint32_t *out_index,
                                error *err)
{
    mrt_result result = check_name(r, RIG_NONE, name, err);
    if (result < 0)
        return result;
    if (r->contact_count >= RIG_EDIT_ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig has at most %d contacts",
                         RIG_EDIT_ENTRIES_MAX);
    rig_contact *grown = realloc(r->contact, (r->contact_count + 2u) * sizeof *grown);
    if (!grown)
        return rig_edit_no_memory(err);
    r->contact = grown;
    char *copy = strdup(name);
    if (!copy)
        return rig_edit_no_memory(err);
    r->contact[r->contact_count] =
        (rig_contact){.name = copy, .bone = RIG_NONE, .vertex = vertex, .mirror = RIG_NONE};
    *out_index = r->contact_count;
    r->contact_count += 1;
    return MRT_OK;
}

/* ---- taken out ---- */

static void close_gap(uint32_t *contact, uint32_t removed)
{
    if (*contact != RIG_NONE && *contact > removed)
        *contact -= 1;
}

static void take_out_of_set(rig_contact_set *set, uint32_t removed)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < set->contact_count; ++i)
        if (set->contact[i] != removed)
            set->contact[kept++] = set->contact[i];
    set->contact_count = kept;
    for (uint32_t i = 0; i < kept; ++i)
        close_gap(&set->contact[i], removed);
}

static void take_out_of_pose(rig_pose *pose, uint32_t removed)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < pose->pull_count; ++i) {
        if (pose->pull_contact[i] == removed)
            continue;
        pose->pull_contact[kept] = pose->pull_contact[i];
        pose->pull_mm[kept] = pose->pull_mm[i];
        close_gap(&pose->pull_contact[kept], removed);
        kept += 1;
    }
    pose->pull_count = kept;
}

mrt_result rig_edit_remove_contact(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result < 0)
        return result;
    free(r->contact[index].name);
    memmove(&r->contact[index], &r->contact[index + 1],
            (r->contact_count - index - 1) * sizeof *r->contact);
    r->contact_count -= 1;
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        if (r->contact[i].mirror == index)
            r->contact[i].mirror = RIG_NONE;
        close_gap(&r->contact[i].mirror, index);
    }
    for (uint32_t i = 0; i < r->contact_set_count; ++i)
        take_out_of_set(&r->contact_set[i], index);
    for (uint32_t i = 0; i < r->pose_count; ++i)
        take_out_of_pose(&r->pose[i], index);
    return MRT_OK;
}

/* ---- one of them ---- */

mrt_result rig_edit_name_contact(rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result >= 0)
        result = check_name(r, index, name, err);
    return result < 0 ? result : rig_edit_rename(&r->contact[index].name, name, err);
}

mrt_result rig_edit_move_contact(rig *r, uint32_t index, uint32_t vertex, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result >= 0)
        r->contact[index].vertex = vertex;
    return result;
}

mrt_result rig_edit_ride(rig *r, uint32_t index, uint32_t bone, error *err)
{
    mrt_result result = check_index(r, index, err);
    if (result < 0)
        return result;
    if (bone != RIG_NONE && bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no bone %u", bone);
    r->contact[index].bone = bone;
    return MRT_OK;
}

/* ---- the other side ---- */

bool rig_edit_other_side(const char *name, char *out, size_t capacity)
{
    size_t length = strlen(name);
    if (length < 3 || length >= capacity || name[length - 2] != '.' ||
        (name[length - 1] != 'l' && name[length - 1] != 'r'))
        return false;
    (void)snprintf(out, capacity, "%s", name);
    out[length - 1] = name[length - 1] == 'l' ? 'r' : 'l';
    return true;
}

static void part_from_mirror(rig *r, uint32_t index)
{
    uint32_t other = r->contact[index].mirror;
    if (other != RIG_NONE)
        r->contact[other].mirror = RIG_NONE;
    r->contact[index].mirror = RIG_NONE;
}

/* Of the bones too: what rides on eye.l is mirrored to eye.r. */
static uint32_t mirrored_bone(const rig *r, uint32_t bone)
{
    char name[RIG_NAME_MAX + 1];
    if (bone == RIG_NONE || !rig_edit_other_side(r->bone[bone].name, name, sizeof name))
        return bone;
    uint32_t other = rig_find_bone(r, name);
    return other == RIG_NONE ? bone : other;
}

mrt_result rig_edit_mirror_contact(rig *r, uint32_t index, uint32_t vertex, error *err)
{
    char name[RIG_NAME_MAX + 1];
    mrt_result result = check_index(r, index, err);
    if (result < 0)
        return result;
    uint32_t other = r->contact[index].mirror;
    if (other == RIG_NONE) {
        if (!rig_edit_other_side(r->contact[index].name, name, sizeof name))
            return error_set(
                err, MRT_ERR_ARGUMENT, "\"%s\" has no side; call it \"%s.l\" or \"%s.r\" first",
                r->contact[index].name, r->contact[index].name, r->contact[index].name);
        other = rig_find_contact(r, name);
        if (other == RIG_NONE)
            result = rig_edit_add_contact(r, name, vertex, &other, err);
        if (result < 0)
            return result;
    }
    part_from_mirror(r, index);
    part_from_mirror(r, other);
    r->contact[index].mirror = other;
    r->contact[other].mirror = index;
    r->contact[other].vertex = vertex;
    r->contact[other].bone = mirrored_bone(r, r->contact[index].bone);
    return MRT_OK;
}
