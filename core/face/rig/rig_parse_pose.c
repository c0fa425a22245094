#include "face/rig/rig_document.h"

#include "base/angle.h"

#include <stdlib.h>
#include <string.h>

enum { PULLS_MAX = 1024 };
static const double radian_per_degree = ANGLE_PI / 180.0;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

/* The contact called `name`, which the value or key at `at` says. */
static mrt_result find_contact(uint32_t *out, const rig *r, const char *name, const rig_node *at,
                               error *err)
{
    *out = rig_find_contact(r, name);
    if (*out != RIG_NONE)
        return MRT_OK;
    rig_word word = rig_word_of(name);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: there is no contact \"%s\"; add it to $.contacts or take it out here",
                     at->place.text, word.text);
}

/* ---- degrees of freedom: degrees or mm in the file ---- */

static mrt_result add_dof(rig_pose *pose, const rig *r, const char *name, const rig_node *at,
                          error *err)
{
    rig_dof_unit unit = rig_dof_unit_of(r, name);
    if (unit == RIG_DOF_UNKNOWN)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: there is no such degree of freedom; a hinge has open, lateral and "
                         "forward (\"jaw.open\"), a ball has its turns (\"eye.l.yaw\")",
                         at->place.text);
    double value = 0.0;
    mrt_result result = rig_json_number(&value, at, -1e4, 1e4, err);
    if (result < 0)
        return result;
    uint32_t index = pose->dof_count;
    pose->dof_name[index] = strdup(name);
    pose->dof_value[index] = unit == RIG_DOF_RAD ? value * radian_per_degree : value;
    pose->dof_count = index + 1;
    return pose->dof_name[index] ? MRT_OK : no_memory(err);
}

static mrt_result read_dofs(rig_pose *pose, const rig *r, const rig_node *dofs, error *err)
{
    if (!dofs->value)
        return MRT_OK;
    mrt_result result = rig_json_object(dofs, "an object like {\"jaw.open\": 20}", err);
    if (result < 0)
        return result;
    size_t count = json_object_size(dofs->value);
    if (count > MRT_MAX_DOFS)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: at most %d", dofs->place.text,
                         MRT_MAX_DOFS);
    pose->dof_name = calloc(count + 1, sizeof *pose->dof_name);
    pose->dof_value = calloc(count + 1, sizeof *pose->dof_value);
    if (!pose->dof_name || !pose->dof_value)
        return no_memory(err);
    json_t *value = (json_t *)(uintptr_t)dofs->value;
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        rig_node member = rig_json_member(dofs, json_object_iter_key(at));
        result = add_dof(pose, r, json_object_iter_key(at), &member, err);
    }
    return result;
}

/* ---- pulls ---- */

static mrt_result read_pulls(rig_pose *pose, const rig *r, const rig_node *pulls,
                             double mm_per_unit, error *err)
{
    if (!pulls->value)
        return MRT_OK;
    mrt_result result = rig_json_object(pulls, "an object like {\"chin\": [0, -4, 1]}", err);
    if (result < 0)
        return result;
    size_t count = json_object_size(pulls->value);
    if (count > PULLS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: at most %d", pulls->place.text, PULLS_MAX);
    pose->pull_contact = calloc(count + 1, sizeof *pose->pull_contact);
    pose->pull_mm = calloc(count + 1, sizeof *pose->pull_mm);
    if (!pose->pull_contact || !pose->pull_mm)
        return no_memory(err);
    json_t *value = (json_t *)(uintptr_t)pulls->value;
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        const char *name = json_object_iter_key(at);
        rig_node member = rig_json_member(pulls, name);
        uint32_t index = pose->pull_count;
        pose->pull_count += 1;
        result = find_contact(&pose->pull_contact[index], r, name, &member, err);
        if (result >= 0)
            result = rig_json_point(&pose->pull_mm[index], &member, mm_per_unit, err);
    }
    return result;
}

static mrt_result read_pose(rig *r, rig_pose *pose, const rig_node *at, double mm_per_unit,
                            error *err)
{
    static const char *const known[] = {"name", "dofs", "pulls", NULL};
    rig_json_note_unknown(&r->note, at, known);
    rig_node name = rig_json_member(at, "name"), dofs = rig_json_member(at, "dofs");
    rig_node pulls = rig_json_member(at, "pulls");
    mrt_result result = rig_json_text(&pose->name, &name, "a name", RIG_NAME_MAX, err);
    if (result >= 0)
        result = read_dofs(pose, r, &dofs, err);
    return result < 0 ? result : read_pulls(pose, r, &pulls, mm_per_unit, err);
}

/* Each name is looked for among all contacts. */
static mrt_result pay_for_names(rig_document *d, const rig *r, uint32_t name_count, error *err)
{
    return budget_spend_work(&d->budget, (uint64_t)name_count * r->contact_count, err);
}

mrt_result rig_fill_poses(rig *r, rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_POSES]; ++i) {
        const rig_entry *entry = &d->entry[RIG_POSES][i];
        r->pose_count = i + 1;
        result = read_pose(r, &r->pose[i], &entry->node, d->file[entry->file].mm_per_unit, err);
        if (result >= 0)
            result = pay_for_names(d, r, r->pose[i].pull_count, err);
    }
    return result;
}

/* ---- contact sets ---- */

static mrt_result add_to_set(rig_contact_set *set, const rig *r, const rig_node *item, error *err)
{
    const char *name = json_string_value(item->value);
    if (!name)
        return rig_json_unexpected(err, item, "the name of a contact");
    uint32_t contact = RIG_NONE;
    mrt_result result = find_contact(&contact, r, name, item, err);
    for (uint32_t i = 0; result >= 0 && i < set->contact_count; ++i)
        if (set->contact[i] == contact)
            return error_set(err, MRT_ERR_FORMAT, "%s: \"%s\" is in this set already; take it out",
                             item->place.text, r->contact[contact].name);
    if (result >= 0)
        set->contact[set->contact_count++] = contact;
    return result;
}

static mrt_result read_set(rig_contact_set *set, const rig *r, const rig_entry *entry, error *err)
{
    set->name = strdup(entry->name);
    if (!set->name)
        return no_memory(err);
    mrt_result result = rig_json_array(&entry->node, "a list of contacts", PULLS_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(entry->node.value);
    set->contact = calloc(count + 1, sizeof *set->contact);
    if (!set->contact)
        return no_memory(err);
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        rig_node item = rig_json_item(&entry->node, i);
        result = add_to_set(set, r, &item, err);
    }
    return result;
}

mrt_result rig_fill_contact_sets(rig *r, rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_SETS]; ++i) {
        r->contact_set_count = i + 1;
        result = read_set(&r->contact_set[i], r, &d->entry[RIG_SETS][i], err);
        if (result >= 0)
            result = pay_for_names(d, r, r->contact_set[i].contact_count, err);
    }
    return result;
}
