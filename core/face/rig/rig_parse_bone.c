#include "face/rig/rig_document.h"

#include "base/angle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double radian_per_degree = ANGLE_PI / 180.0;
/* Of an adult (Ferrario 2005, Travers 2000). */
const rig_bone rig_adult_jaw = {.open_max_rad = 32.0 * ANGLE_PI / 180.0,
                                .lateral_mm = 10.0,
                                .forward_mm = 8.0,
                                .slide_mm = 12.0};

typedef struct reading {
    rig *r;
    rig_node node; /* of the bone */
    double mm_per_unit;
} reading;

/* [least, greatest], in degrees, around the rest at 0. */
static mrt_result read_range(double *out_min_rad, double *out_max_rad, const rig_node *at,
                             double reach_deg, error *err)
{
    double deg[2];
    if (!json_is_array(at->value) || json_array_size(at->value) != 2)
        return rig_json_unexpected(err, at, "two angles [least, greatest] in degrees");
    for (size_t i = 0; i < 2; ++i) {
        rig_node item = rig_json_item(at, i);
        mrt_result result = rig_json_number(&deg[i], &item, -reach_deg, reach_deg, err);
        if (result < 0)
            return result;
    }
    if (deg[0] >= deg[1])
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: [%g, %g] is reversed or empty; write the smaller angle first",
                         at->place.text, deg[0], deg[1]);
    if (deg[0] > 0.0 || deg[1] < 0.0)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: [%g, %g] leaves out 0, which is the pose of the mesh; widen it",
                         at->place.text, deg[0], deg[1]);
    *out_min_rad = deg[0] * radian_per_degree;
    *out_max_rad = deg[1] * radian_per_degree;
    return MRT_OK;
}

/* ---- jaw ---- */

static mrt_result read_hinge(rig_bone *bone, const reading *in, error *err)
{
    static const char *const known[] = {"left", "right", NULL};
    rig_node hinge = rig_json_member(&in->node, "hinge");
    mrt_result result =
        rig_json_object(&hinge, "an object {\"left\": [x,y,z], \"right\": [x,y,z]}", err);
    if (result < 0)
        return result;
    rig_node left = rig_json_member(&hinge, "left"), right = rig_json_member(&hinge, "right");
    result = rig_json_point(&bone->hinge_left, &left, in->mm_per_unit, err);
    if (result >= 0)
        result = rig_json_point(&bone->hinge_right, &right, in->mm_per_unit, err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&in->r->note, &hinge, known);
    double length_mm = vec3_length(vec3_sub(bone->hinge_left, bone->hinge_right));
    if (!(length_mm > 1.0))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: left and right are %.3g mm apart, so there is no axis; they are the "
                         "two jaw joints, just before the ears",
                         hinge.place.text, length_mm);
    return MRT_OK;
}

static mrt_result read_jaw(rig_bone *bone, const reading *in, error *err)
{
    bone->kind = BONE_JAW;
    bone->open_max_rad = rig_adult_jaw.open_max_rad;
    bone->lateral_mm = rig_adult_jaw.lateral_mm;
    bone->forward_mm = rig_adult_jaw.forward_mm;
    bone->slide_mm = rig_adult_jaw.slide_mm;
    mrt_result result = read_hinge(bone, in, err);
    rig_node open = rig_json_member(&in->node, "open_deg");
    if (result >= 0 && open.value)
        result = read_range(&bone->open_min_rad, &bone->open_max_rad, &open, 90.0, err);
    if (result >= 0)
        result =
            rig_json_optional_number(&bone->lateral_mm, &in->node, "lateral_mm", 0.0, 1e4, err);
    if (result >= 0)
        result =
            rig_json_optional_number(&bone->forward_mm, &in->node, "forward_mm", 0.0, 1e4, err);
    if (result >= 0)
        result = rig_json_optional_number(&bone->slide_mm, &in->node, "slide_mm", 0.0, 1e4, err);
    if (result >= 0)
        result = rig_json_optional_point(&bone->incisor, &bone->has_incisor, &in->node, "incisor",
                                         in->mm_per_unit, err);
    return result;
}

/* ---- ball ---- */

static mrt_result check_turn_name(const rig_bone *bone, uint32_t index, const rig_node *at,
                                  error *err)
{
    const char *name = bone->turn[index].name;
    if (strlen(bone->name) + 1 + strlen(name) > RIG_NAME_MAX)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.name: \"%s.%s\" is longer than %d letters; shorten it", at->place.text,
                         bone->name, name, RIG_NAME_MAX);
    for (uint32_t i = 0; i < index; ++i)
        if (strcmp(bone->turn[i].name, name) == 0)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s.name: there is already a turn \"%s\"; choose another name",
                             at->place.text, name);
    return MRT_OK;
}

static mrt_result read_turn(rig_bone *bone, const rig_node *at, rig *r, error *err)
{
    static const char *const known[] = {"name", "axis", "deg", NULL};
    uint32_t index = bone->turn_count;
    rig_turn *turn = &bone->turn[index];
    mrt_result result = rig_json_object(at, "an object with name, axis and deg", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, at, known);
    rig_node name = rig_json_member(at, "name"), axis = rig_json_member(at, "axis");
    result = rig_json_text(&turn->name, &name, "a name like \"yaw\"", RIG_NAME_MAX, err);
    if (result < 0)
        return result;
    bone->turn_count += 1;
    result = check_turn_name(bone, index, at, err);
    if (result >= 0)
        result = rig_json_point(&turn->axis, &axis, 1.0, err);
    if (result < 0)
        return result;
    if (!(vec3_length(turn->axis) > 1e-9))
        return error_set(err, MRT_ERR_FORMAT, "%s: expected a direction, found one of length 0",
                         axis.place.text);
    turn->axis = vec3_normalised(turn->axis, (vec3){1.0, 0.0, 0.0});
    rig_node deg = rig_json_member(at, "deg");
    return read_range(&turn->min_rad, &turn->max_rad, &deg, 180.0, err);
}

static mrt_result read_ball(rig_bone *bone, const reading *in, error *err)
{
    static const char *const known[] = {"centre", "radius_mm", NULL};
    bone->kind = BONE_BALL;
    rig_node ball = rig_json_member(&in->node, "ball");
    rig_node turns = rig_json_member(&in->node, "turns");
    mrt_result result = rig_json_object(&ball, "an object {\"centre\": [x,y,z]}", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&in->r->note, &ball, known);
    rig_node centre = rig_json_member(&ball, "centre");
    result = rig_json_point(&bone->centre, &centre, in->mm_per_unit, err);
    if (result >= 0)
        result = rig_json_optional_number(&bone->radius_mm, &ball, "radius_mm", 0.0, 1e6, err);
    if (result >= 0)
        result = rig_json_array(&turns, "a list of one to three turns", RIG_TURNS_MAX, err);
    if (result >= 0 && json_array_size(turns.value) == 0)
        result = rig_json_unexpected(err, &turns, "a list of one to three turns");
    for (size_t i = 0; result >= 0 && i < json_array_size(turns.value); ++i) {
        rig_node item = rig_json_item(&turns, i);
        result = read_turn(bone, &item, in->r, err);
    }
    return result;
}

/* ---- any bone ---- */

static const char *const fixed_keys[] = {"name", "parent", NULL};
static const char *const jaw_keys[] = {
    "name", "parent", "hinge", "open_deg", "lateral_mm", "forward_mm", "slide_mm", "incisor", NULL};
static const char *const ball_keys[] = {"name", "parent", "ball", "turns", NULL};

static mrt_result read_kind(rig_bone *bone, const reading *in, error *err)
{
    bool has_hinge = json_object_get(in->node.value, "hinge") != NULL;
    bool has_ball = json_object_get(in->node.value, "ball") != NULL;
    if (has_hinge && has_ball)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: has both a hinge and a ball; a bone moves in one way",
                         in->node.place.text);
    const char *const *keys = has_hinge ? jaw_keys : has_ball ? ball_keys : fixed_keys;
    rig_json_note_unknown(&in->r->note, &in->node, keys);
    return has_hinge ? read_jaw(bone, in, err) : has_ball ? read_ball(bone, in, err) : MRT_OK;
}

static mrt_result read_parent(rig_bone *bone, const reading *in, error *err)
{
    rig_node parent = rig_json_member(&in->node, "parent");
    const char *name = parent.value ? json_string_value(parent.value) : "skull";
    bone->parent = RIG_NONE;
    if (json_is_null(parent.value))
        return MRT_OK;
    if (!name)
        return rig_json_unexpected(err, &parent, "the name of a bone, or null for none");
    bone->parent = rig_find_bone(in->r, name); /* only among those read so far */
    if (parent.value && bone->parent == RIG_NONE) {
        rig_word word = rig_word_of(name);
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: there is no bone \"%s\" before this one; list parents first",
                         parent.place.text, word.text);
    }
    return MRT_OK;
}

static mrt_result read_bone(rig_bone *bone, const reading *in, error *err)
{
    mrt_result result = read_parent(bone, in, err);
    return result < 0 ? result : read_kind(bone, in, err);
}

static mrt_result check_dofs(const rig *r, const rig_node *last, error *err)
{
    uint32_t dof_count = 0, jaw_count = 0;
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        jaw_count += r->bone[i].kind == BONE_JAW;
        dof_count += r->bone[i].kind == BONE_JAW ? 3 : r->bone[i].turn_count;
    }
    if (jaw_count > 1)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: a second bone with a hinge; a face has one jaw", last->place.text);
    if (dof_count > MRT_MAX_DOFS)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: %u degrees of freedom are too many, at most %d", last->place.text,
                         dof_count, MRT_MAX_DOFS);
    return MRT_OK;
}

static mrt_result add_default_skull(rig *r, error *err)
{
    r->bone[0] = (rig_bone){.name = strdup("skull"), .parent = RIG_NONE};
    r->bone_count = 1;
    return r->bone[0].name ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

mrt_result rig_fill_bones(rig *r, rig_document *d, error *err)
{
    uint32_t count = d->entry_count[RIG_BONES];
    mrt_result result = count == 0 ? add_default_skull(r, err) : MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        const rig_entry *entry = &d->entry[RIG_BONES][i];
        reading in = {r, entry->node, d->file[entry->file].mm_per_unit};
        rig_node name = rig_json_member(&in.node, "name");
        rig_bone *bone = &r->bone[i];
        bone->parent = RIG_NONE;
        result = rig_json_text(&bone->name, &name, "a name like \"jaw\"", RIG_NAME_MAX - 8, err);
        if (result < 0)
            return result;
        result = read_bone(bone, &in, err);
        r->bone_count = i + 1; /* from here on it can be a parent */
        if (result >= 0)
            result = check_dofs(r, &in.node, err);
    }
    return result;
}

rig_dof_unit rig_dof_unit_of(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        const rig_bone *bone = &r->bone[i];
        size_t length = strlen(bone->name);
        if (strncmp(name, bone->name, length) != 0 || name[length] != '.')
            continue;
        const char *rest = name + length + 1;
        if (bone->kind == BONE_JAW && strcmp(rest, "open") == 0)
            return RIG_DOF_RAD;
        if (bone->kind == BONE_JAW &&
            (strcmp(rest, "lateral") == 0 || strcmp(rest, "forward") == 0))
            return RIG_DOF_MM;
        for (uint32_t k = 0; k < bone->turn_count; ++k)
            if (strcmp(rest, bone->turn[k].name) == 0)
                return RIG_DOF_RAD;
    }
    return RIG_DOF_UNKNOWN;
}
