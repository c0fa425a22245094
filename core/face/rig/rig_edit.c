#include "face/rig_edit.h"

#include "base/angle.h"
#include "face/rig/rig_document.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ENTRIES_MAX = 1024 }; /* the limit of the reader */

/* ---- rounding to what a person can set by hand: 0.01 mm, 0.01 degrees, shares of 0.001 ---- */

static const double steps_per_mm = 100.0, steps_per_degree = 100.0, steps_per_share = 1000.0,
                    steps_per_unit = 1e6;
static const double degree = ANGLE_PI / 180.0;

static const vec3 nowhere = {(double)NAN, (double)NAN, (double)NAN};

static bool is_same_number(double a, double b)
{
    return a >= b && a <= b;
}

static double round_to(double value, double steps, double before)
{
    return is_same_number(value, before) ? before : floor(value * steps + 0.5) / steps;
}

/* Rounds so that files stay readable. A value equal to `before` (NaN: none) is not rounded,
 * since another program may have written it. */
static double round_mm(double mm, double before)
{
    return round_to(mm, steps_per_mm, before);
}

static double round_rad(double rad, double before)
{
    return is_same_number(rad, before)
               ? before
               : degree * round_to(rad / degree, steps_per_degree, (double)NAN);
}

static double round_share(double share, double before)
{
    return isnan(share) ? share : round_to(share, steps_per_share, before);
}

static vec3 round_position(vec3 mm, vec3 before)
{
    return (vec3){round_mm(mm.x, before.x), round_mm(mm.y, before.y), round_mm(mm.z, before.z)};
}

vec3 rig_round_axis(vec3 axis)
{
    return (vec3){floor(axis.x * steps_per_unit + 0.5) / steps_per_unit,
                  floor(axis.y * steps_per_unit + 0.5) / steps_per_unit,
                  floor(axis.z * steps_per_unit + 0.5) / steps_per_unit};
}

/* ---- regions ---- */

enum { PATH_TEXT = 512 };

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to change the rig");
}

/* Removes item `index`, which is already finished, and moves the later items up. */
static void close_array(void *item, uint32_t *count, uint32_t index, size_t size)
{
    char *at = (char *)item + index * size;
    memmove(at, at + size, (*count - index - 1) * size);
    *count -= 1;
}

/* Frees *out, which owns its text, and sets it to a copy of `name`. On error *out is unchanged. */
static mrt_result replace_name(char **out, const char *name, error *err)
{
    char *copy = strdup(name);
    if (!copy)
        return no_memory(err);
    free(*out);
    *out = copy;
    return MRT_OK;
}

/* Checks that a file can use this name. */
static mrt_result check_name(const char *name, error *err)
{
    size_t length = name ? strlen(name) : 0;
    for (size_t i = 0; i < length; ++i)
        if ((unsigned char)name[i] < 0x20 || name[i] == 0x7f)
            return error_set(err, MRT_ERR_ARGUMENT, "a name cannot contain control characters");
    if (length < 1 || length > RIG_NAME_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "a name must have 1 to %d characters",
                         RIG_NAME_MAX);
    return MRT_OK;
}

/* ---- paths of selectors, for messages ---- */

static void set_select_path(rig_select *select, const char *path)
{
    char *copy = strdup(path);
    if (copy) {
        free(select->path);
        select->path = copy;
    }
    const char *key = rig_select_key(select->kind);
    const bool is_list = select->kind == SELECT_ALL || select->kind == SELECT_ANY;
    for (uint32_t i = 0; i < select->child_count; ++i) {
        char child[PATH_TEXT];
        if (is_list)
            (void)snprintf(child, sizeof child, "%.400s.%s[%u]", path, key, i);
        else
            (void)snprintf(child, sizeof child, "%.400s.%s", path, key);
        set_select_path(&select->child[i], child);
    }
}

static void set_region_paths(rig *r)
{
    for (uint32_t i = 0; i < r->region_count; ++i) {
        json_path region = rig_entry_path(r, RIG_REGIONS, i);
        char path[PATH_TEXT];
        (void)snprintf(path, sizeof path, "%s.select", region.text);
        set_select_path(&r->region[i].select, path);
    }
}

/* ---- regions ---- */

static mrt_result check_index(uint32_t index, uint32_t count, const char *what, error *err)
{
    return index < count ? MRT_OK
                         : error_set(err, MRT_ERR_ARGUMENT, "the rig has no %s %u", what, index);
}

static bool is_share(double value)
{
    return isnan(value) || (value >= 0.0 && value <= 1.0);
}

static mrt_result check_region_values(const rig *r, const rig_edit_region_values *says, error *err)
{
    bool has_weight = !isnan(says->weight), has_mobility = !isnan(says->mobility);
    if (says->bone != RIG_NONE && says->bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "the rig has no bone %u", says->bone);
    if (!is_share(says->weight) || !is_share(says->mobility))
        return error_set(err, MRT_ERR_ARGUMENT, "weight and mobility must be from 0 to 1");
    if (says->is_rigid && (has_weight || has_mobility))
        return error_set(err, MRT_ERR_ARGUMENT, "a rigid region cannot set weight or mobility");
    if (!says->is_rigid && !has_weight && !has_mobility)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a region must set at least one of rigid, weight and mobility");
    if (says->bone == RIG_NONE && (says->is_rigid || has_weight))
        return error_set(err, MRT_ERR_ARGUMENT, "choose the bone that moves these vertices");
    return MRT_OK;
}

/* `other`: the entry that has the name; index: the entry that is to get it. */
static mrt_result check_free(uint32_t other, uint32_t index, const char *what, const char *name,
                             error *err)
{
    return other == RIG_NONE || other == index
               ? MRT_OK
               : error_set(err, MRT_ERR_ARGUMENT,
                           "another %s is already called \"%s\"; choose another name", what, name);
}

static mrt_result check_region_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_name(name, err);
    return result < 0 ? result
                      : check_free(rig_edit_find_region(r, name), index, "region", name, err);
}

uint32_t rig_edit_find_region(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (r->region[i].name && strcmp(r->region[i].name, name) == 0)
            return i;
    return RIG_NONE;
}

static void set_region_values(rig_region *region, const rig_edit_region_values *says)
{
    region->bone = says->bone;
    region->is_rigid = says->is_rigid;
    region->weight = round_share(says->weight, region->weight);
    region->mobility = round_share(says->mobility, region->mobility);
}

mrt_result rig_edit_add_region(rig *r, const char *name, const rig_edit_region_values *says,
                               uint32_t *out_index, error *err)
{
    bool has_name = name && name[0];
    mrt_result result = check_region_values(r, says, err);
    if (result >= 0 && has_name)
        result = check_region_name(r, RIG_NONE, name, err);
    if (result < 0)
        return result;
    if (r->region_count >= ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig can have at most %d regions",
                         ENTRIES_MAX);
    rig_region *grown = realloc(r->region, (r->region_count + 2u) * sizeof *grown);
    if (!grown)
        return no_memory(err);
    r->region = grown;
    rig_region made = {.select = {.kind = SELECT_VERTICES}};
    made.name = has_name ? strdup(name) : NULL;
    if (has_name && !made.name)
        return no_memory(err);
    set_region_values(&made, says);
    r->region[r->region_count] = made;
    *out_index = r->region_count;
    r->region_count += 1;
    set_region_paths(r);
    return MRT_OK;
}

mrt_result rig_edit_remove_region(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(index, r->region_count, "region", err);
    if (result < 0)
        return result;
    rig_select_finish(&r->region[index].select);
    free(r->region[index].name);
    close_array(r->region, &r->region_count, index, sizeof *r->region);
    set_region_paths(r);
    return MRT_OK;
}

mrt_result rig_edit_move_region(rig *r, uint32_t index, uint32_t to, error *err)
{
    mrt_result result = check_index(index, r->region_count, "region", err);
    if (result >= 0)
        result = check_index(to, r->region_count, "region", err);
    if (result < 0)
        return result;
    rig_region moved = r->region[index];
    if (to > index)
        memmove(&r->region[index], &r->region[index + 1], (to - index) * sizeof moved);
    else
        memmove(&r->region[to + 1], &r->region[to], (index - to) * sizeof moved);
    r->region[to] = moved;
    set_region_paths(r);
    return MRT_OK;
}

mrt_result rig_edit_name_region(rig *r, uint32_t index, const char *name, error *err)
{
    bool has_name = name && name[0];
    mrt_result result = check_index(index, r->region_count, "region", err);
    if (result >= 0 && has_name)
        result = check_region_name(r, index, name, err);
    if (result < 0)
        return result;
    char *copy = has_name ? strdup(name) : NULL;
    if (has_name && !copy)
        return no_memory(err);
    free(r->region[index].name);
    r->region[index].name = copy;
    return MRT_OK;
}

mrt_result rig_edit_set_region(rig *r, uint32_t index, const rig_edit_region_values *says,
                               error *err)
{
    mrt_result result = check_index(index, r->region_count, "region", err);
    if (result >= 0)
        result = check_region_values(r, says, err);
    if (result >= 0)
        set_region_values(&r->region[index], says);
    return result;
}

/* ---- painting ---- */

bool rig_edit_can_paint(const rig *r, uint32_t index)
{
    rig_select_kind kind = r->region[index].select.kind;
    return kind == SELECT_VERTICES || kind == SELECT_PAINTED;
}

void rig_edit_values(uint8_t *out, const rig *r, uint32_t index, uint32_t vertex_count)
{
    const rig_select *select = &r->region[index].select;
    memset(out, 0, vertex_count);
    for (uint32_t i = 0; i < select->range_count; ++i)
        for (uint32_t v = select->first[i]; v <= select->last[i] && v < vertex_count; ++v)
            out[v] = select->kind == SELECT_PAINTED ? select->value[i] : 255;
}

static bool is_soft(const uint8_t *value, uint32_t vertex_count)
{
    for (uint32_t v = 0; v < vertex_count; ++v)
        if (value[v] != 0 && value[v] != 255)
            return true;
    return false;
}

static bool is_paint_taken(const rig *r, uint32_t index, const char *name)
{
    uint32_t file;
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (i != index && rig_select_uses_paint(&r->region[i].select, name))
            return true;
    return r->document && rig_document_paint(r->document, name, &file).value;
}

/* Keeps the region's paint if no other region uses it. Otherwise names a new paint after the
 * region, with a number if that name is taken. */
static void choose_paint_name(const rig *r, uint32_t index, char out[RIG_NAME_MAX + 1])
{
    const rig_region *region = &r->region[index];
    bool is_own = region->select.kind == SELECT_PAINTED;
    for (uint32_t i = 0; is_own && i < r->region_count; ++i)
        is_own = i == index || !rig_select_uses_paint(&r->region[i].select, region->select.name);
    const char *base = is_own                     ? region->select.name
                       : region->name             ? region->name
                       : region->bone != RIG_NONE ? r->bone[region->bone].name
                                                  : "mobility";
    (void)snprintf(out, RIG_NAME_MAX + 1, "%.*s", RIG_NAME_MAX - 8, base);
    if (is_own)
        (void)snprintf(out, RIG_NAME_MAX + 1, "%s", base);
    for (uint32_t number = 2; !is_own && is_paint_taken(r, index, out); ++number)
        (void)snprintf(out, RIG_NAME_MAX + 1, "%.*s %u", RIG_NAME_MAX - 8, base, number);
}

mrt_result rig_edit_paint(rig *r, uint32_t index, const uint8_t *value, uint32_t vertex_count,
                          error *err)
{
    char name[RIG_NAME_MAX + 1];
    mrt_result result = check_index(index, r->region_count, "region", err);
    rig_select made = {.kind = SELECT_VERTICES};
    if (result >= 0)
        result = rig_paint_set(&made, value, vertex_count, err);
    if (result < 0)
        return result;
    if (is_soft(value, vertex_count)) {
        choose_paint_name(r, index, name);
        made.kind = SELECT_PAINTED;
        made.name = strdup(name);
        if (!made.name) {
            rig_select_finish(&made);
            return no_memory(err);
        }
    } else {
        free(made.value);
        made.value = NULL;
    }
    rig_select_finish(&r->region[index].select);
    r->region[index].select = made;
    set_region_paths(r);
    return MRT_OK;
}

/* ---- the jaw ---- */

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

/* True within the range that a file allows. */
static bool is_position(vec3 p)
{
    return fabs(p.x) <= coordinate_cap && fabs(p.y) <= coordinate_cap &&
           fabs(p.z) <= coordinate_cap;
}

static bool is_way(double mm)
{
    return mm >= 0.0 && mm <= farthest_mm;
}

static mrt_result check_jaw(const rig *r, uint32_t bone, const rig_edit_jaw *jaw, error *err)
{
    if (bone >= r->bone_count || r->bone[bone].kind != BONE_JAW)
        return error_set(err, MRT_ERR_ARGUMENT, "the rig has no jaw");
    if (!is_position(jaw->left) || !is_position(jaw->right) || !is_position(jaw->incisor))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the jaw is too far away: expected coordinates within 1000000 mm");
    if (!(jaw->left.x - jaw->right.x >= least_width_mm))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "the left end of the jaw's axis must be at least %.0f mm to the left of the right end",
            least_width_mm);
    if (!(jaw->open_min_rad <= 0.0 && jaw->open_min_rad >= -widest_rad) ||
        !(jaw->open_max_rad > 0.0 && jaw->open_max_rad <= widest_rad) || !is_way(jaw->lateral_mm) ||
        !is_way(jaw->forward_mm) || !is_way(jaw->slide_mm))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "the limits of the jaw are out of range: expected at most 90 degrees and 10000 mm");
    return MRT_OK;
}

mrt_result rig_edit_set_jaw(rig *r, uint32_t bone, const rig_edit_jaw *jaw, error *err)
{
    mrt_result result = check_jaw(r, bone, jaw, err);
    if (result < 0)
        return result;
    rig_bone *to = &r->bone[bone];
    to->hinge_left = round_position(jaw->left, to->hinge_left);
    to->hinge_right = round_position(jaw->right, to->hinge_right);
    to->incisor = round_position(jaw->incisor, to->has_incisor ? to->incisor : nowhere);
    to->has_incisor = jaw->has_incisor;
    to->open_min_rad = round_rad(jaw->open_min_rad, to->open_min_rad);
    to->open_max_rad = round_rad(jaw->open_max_rad, to->open_max_rad);
    to->lateral_mm = round_mm(jaw->lateral_mm, to->lateral_mm);
    to->forward_mm = round_mm(jaw->forward_mm, to->forward_mm);
    to->slide_mm = round_mm(jaw->slide_mm, to->slide_mm);
    return MRT_OK;
}

/* ---- bones ---- */

enum { BONE_NAME_MAX = RIG_NAME_MAX - 8 }; /* with ".lateral" appended it is still a valid name */
static const double least_half_mm = 1.0, most_half_mm = 1e6;
static const double up_and_down_rad = 25.0 * ANGLE_PI / 180.0,
                    to_the_sides_rad = 35.0 * ANGLE_PI / 180.0;

static mrt_result check_bone_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_name(name, err);
    if (result >= 0 && strlen(name) > BONE_NAME_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "the name of a bone can have at most %d characters",
                         BONE_NAME_MAX);
    return result < 0 ? result : check_free(rig_find_bone(r, name), index, "bone", name, err);
}

/* ---- adding bones ---- */

/* Counts those of all bones and of the mouth. */
static uint32_t count_dofs(const rig *r)
{
    uint32_t count = r->mouth.upper != NULL;
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

static mrt_result check_new_bone(const rig *r, rig_bone_kind kind, vec3 at, double half_mm,
                                 error *err)
{
    const uint32_t moves = kind == BONE_JAW ? 3 : kind == BONE_BALL ? 2 : 0;
    if (r->bone_count >= RIG_BONES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig can have at most %d bones",
                         RIG_BONES_MAX);
    if (kind == BONE_JAW && has_jaw(r))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the rig already has a jaw; a face has only one");
    if (count_dofs(r) + moves > MRT_MAX_DOFS)
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "the bones of a rig can have at most %d degrees of freedom; remove one first",
            MRT_MAX_DOFS);
    if (!is_position(at) || !(half_mm >= least_half_mm && half_mm <= most_half_mm))
        return error_set(err, MRT_ERR_ARGUMENT, "the bone is too far away or too small");
    return MRT_OK;
}

static void make_jaw(rig_bone *out, vec3 at, double half_mm)
{
    const vec3 half = {half_mm, 0.0, 0.0};
    out->hinge_left = round_position(vec3_add(at, half), nowhere);
    out->hinge_right = round_position(vec3_sub(at, half), nowhere);
}

static void make_ball(rig_bone *out, vec3 at, double half_mm)
{
    out->centre = round_position(at, nowhere);
    out->radius_mm = round_mm(half_mm, nowhere.x);
    out->turn[0] =
        (rig_turn){strdup("yaw"), {0.0, 1.0, 0.0}, -to_the_sides_rad, to_the_sides_rad, {0}};
    out->turn[1] =
        (rig_turn){strdup("pitch"), {-1.0, 0.0, 0.0}, -up_and_down_rad, up_and_down_rad, {0}};
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
    mrt_result result = check_bone_name(r, RIG_NONE, name, err);
    if (result >= 0)
        result = check_new_bone(r, kind, at, half_mm, err);
    if (result < 0)
        return result;
    rig_bone made = kind == BONE_JAW ? rig_adult_jaw : (rig_bone){.kind = kind};
    made.name = strdup(name);
    if (kind == BONE_JAW)
        make_jaw(&made, at, half_mm);
    if (kind == BONE_BALL)
        make_ball(&made, at, half_mm);
    bool has_names = made.name && (kind != BONE_BALL || (made.turn[0].name && made.turn[1].name));
    if (!has_names) {
        finish_bone(&made);
        return no_memory(err);
    }
    *out_index = r->bone_count;
    r->bone[r->bone_count++] = made; /* the array has room for RIG_BONES_MAX */
    return MRT_OK;
}

/* ---- degrees of freedom in poses ---- */

/* True if `dof` belongs to the bone. With a turn, true only for that turn. */
static bool is_dof(const char *dof, const char *bone, const char *turn)
{
    const size_t length = strlen(bone);
    return strncmp(dof, bone, length) == 0 && dof[length] == '.' &&
           (!turn || strcmp(dof + length + 1, turn) == 0);
}

static void remove_from_poses(rig *r, const char *bone, const char *turn)
{
    for (uint32_t i = 0; i < r->pose_count; ++i) {
        rig_pose *pose = &r->pose[i];
        uint32_t kept = 0;
        for (uint32_t k = 0; k < pose->dof_count; ++k) {
            if (is_dof(pose->dof_name[k], bone, turn)) {
                free(pose->dof_name[k]);
                continue;
            }
            pose->dof_name[kept] = pose->dof_name[k];
            pose->dof_value[kept++] = pose->dof_value[k];
        }
        pose->dof_count = kept;
    }
}

/* Renames the degrees of freedom of a bone, or of one of its turns. turn NULL: all turns, whose
 * own names stay. All new names are allocated first, so that an error changes nothing. */
static mrt_result rename_in_poses(rig *r, const char *bone, const char *new_bone, const char *turn,
                                  const char *new_turn, error *err)
{
    uint32_t wanted = 0, count = 0;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        for (uint32_t k = 0; k < r->pose[i].dof_count; ++k)
            wanted += is_dof(r->pose[i].dof_name[k], bone, turn);
    char **made = calloc(wanted + 1u, sizeof *made);
    bool has_all = made != NULL;
    for (uint32_t i = 0; i < r->pose_count; ++i)
        for (uint32_t k = 0; has_all && k < r->pose[i].dof_count; ++k) {
            char text[2 * RIG_NAME_MAX + 2];
            const char *dof = r->pose[i].dof_name[k];
            if (!is_dof(dof, bone, turn))
                continue;
            (void)snprintf(text, sizeof text, "%s.%s", new_bone,
                           turn ? new_turn : dof + strlen(bone) + 1);
            made[count] = strdup(text);
            has_all = made[count++] != NULL;
        }
    for (uint32_t i = 0, next = 0; has_all && i < r->pose_count; ++i)
        for (uint32_t k = 0; k < r->pose[i].dof_count; ++k) {
            char **dof = &r->pose[i].dof_name[k];
            if (!is_dof(*dof, bone, turn))
                continue;
            free(*dof);
            *dof = made[next++];
        }
    for (uint32_t i = 0; !has_all && i < count; ++i)
        free(made[i]);
    free(made);
    return has_all ? MRT_OK : no_memory(err);
}

/* ---- removing bones ---- */

static uint32_t heir_of(uint32_t bone, uint32_t removed, uint32_t heir)
{
    if (bone == RIG_NONE)
        return RIG_NONE;
    if (bone == removed)
        bone = heir;
    return bone > removed ? bone - 1 : bone;
}

/* Called when a bone, or one of its turns, is removed (turn RIG_NONE: the whole bone). Turns
 * that follow it stop following; the indices of later bones or turns move down by one. */
static void unlink_followers(rig *r, uint32_t bone, uint32_t turn)
{
    for (uint32_t i = 0; i < r->bone_count; ++i)
        for (uint32_t k = 0; k < r->bone[i].turn_count; ++k) {
            rig_follow *follows = &r->bone[i].turn[k].follows;
            if (follows->bone == bone && (turn == RIG_NONE || follows->turn == turn))
                *follows = (rig_follow){0};
            else if (turn == RIG_NONE && follows->bone > bone)
                follows->bone -= 1;
            else if (follows->bone == bone && follows->turn > turn)
                follows->turn -= 1;
        }
}

static void reassign_bone(rig *r, uint32_t removed, uint32_t heir)
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

static mrt_result check_removable(const rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(index, r->bone_count, "bone", err);
    if (result >= 0 && (index == 0 || strcmp(r->bone[index].name, "skull") == 0))
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the bone \"%s\" carries the face and cannot be removed, renamed or "
                         "attached to another bone",
                         r->bone[index].name);
    return result;
}

mrt_result rig_edit_remove_bone(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_removable(r, index, err);
    if (result < 0)
        return result;
    const uint32_t parent = r->bone[index].parent;
    remove_from_poses(r, r->bone[index].name, NULL);
    unlink_followers(r, index, RIG_NONE);
    reassign_bone(r, index, parent == RIG_NONE ? 0 : parent);
    finish_bone(&r->bone[index]);
    close_array(r->bone, &r->bone_count, index, sizeof *r->bone);
    r->bone[r->bone_count] = (rig_bone){0};
    return MRT_OK;
}

/* ---- changing one bone ---- */

static mrt_result check_turn_names(const rig_bone *bone, const char *name, error *err)
{
    for (uint32_t i = 0; i < bone->turn_count; ++i)
        if (strlen(name) + 1 + strlen(bone->turn[i].name) > RIG_NAME_MAX)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "\"%s.%s\" is longer than %d characters; choose a shorter name", name,
                             bone->turn[i].name, RIG_NAME_MAX);
    return MRT_OK;
}

mrt_result rig_edit_name_bone(rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_removable(r, index, err);
    if (result >= 0)
        result = check_bone_name(r, index, name, err);
    if (result >= 0)
        result = check_turn_names(&r->bone[index], name, err);
    char *copy = result < 0 ? NULL : strdup(name);
    if (result >= 0 && !copy)
        return no_memory(err);
    if (result >= 0)
        result = rename_in_poses(r, r->bone[index].name, name, NULL, NULL, err);
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
    mrt_result result = check_index(index, r->bone_count, "bone", err);
    if (result < 0)
        return result;
    if (r->bone[index].kind != BONE_BALL)
        return error_set(err, MRT_ERR_ARGUMENT, "the bone \"%s\" is not a ball",
                         r->bone[index].name);
    if (!is_position(centre) || !(radius_mm >= 0.0 && radius_mm <= most_half_mm))
        return error_set(err, MRT_ERR_ARGUMENT, "the ball is too far away or too large");
    rig_bone *to = &r->bone[index];
    to->centre = round_position(centre, to->centre);
    to->radius_mm = round_mm(radius_mm, to->radius_mm);
    return MRT_OK;
}

mrt_result rig_edit_set_spring(rig *r, uint32_t bone, const rig_spring *spring, error *err)
{
    mrt_result result = check_index(bone, r->bone_count, "bone", err);
    if (result < 0)
        return result;
    rig_bone *to = &r->bone[bone];
    if (spring->frequency_hz == 0.0) {
        to->spring = (rig_spring){.frequency_hz = 0.0};
        return MRT_OK;
    }
    if (to->kind != BONE_BALL)
        return error_set(err, MRT_ERR_ARGUMENT, "the bone \"%s\" is not a ball, so it cannot swing",
                         to->name);
    if (!(spring->frequency_hz >= RIG_SPRING_LEAST_HZ &&
          spring->frequency_hz <= RIG_SPRING_MOST_HZ) ||
        !(spring->damping >= RIG_SPRING_LEAST_DAMPED &&
          spring->damping <= RIG_SPRING_MOST_DAMPED) ||
        !(spring->inertia >= 0.0 && spring->inertia <= 1.0) ||
        !(spring->gravity >= 0.0 && spring->gravity <= 1.0) ||
        !(spring->radius_mm >= 0.0 && spring->radius_mm <= farthest_mm))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "the spring of \"%s\" needs %g to %g Hz, a damping of %g to %g, and shares "
            "from 0 to 1",
            to->name, RIG_SPRING_LEAST_HZ, RIG_SPRING_MOST_HZ, RIG_SPRING_LEAST_DAMPED,
            RIG_SPRING_MOST_DAMPED);
    if (!is_position(spring->tip) ||
        !(vec3_length(vec3_sub(spring->tip, to->centre)) >= RIG_SPRING_LEAST_MM))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "the tip of \"%s\" must lie away from its centre: place it in the middle of "
            "the loose part",
            to->name);
    const rig_spring before = to->spring;
    to->spring =
        (rig_spring){.tip = round_position(spring->tip, before.tip),
                     .frequency_hz = round_share(spring->frequency_hz, before.frequency_hz),
                     .damping = round_share(spring->damping, before.damping),
                     .inertia = round_share(spring->inertia, before.inertia),
                     .gravity = round_share(spring->gravity, before.gravity),
                     .radius_mm = round_mm(spring->radius_mm, before.radius_mm)};
    return MRT_OK;
}

mrt_result rig_edit_set_springs(rig *r, double share, error *err)
{
    if (!is_share(share))
        return error_set(err, MRT_ERR_ARGUMENT, "the share of the swing must be from 0 to 1");
    r->springs = round_share(share, r->springs);
    return MRT_OK;
}

mrt_result rig_edit_set_parent(rig *r, uint32_t index, uint32_t parent, error *err)
{
    mrt_result result = check_removable(r, index, err);
    if (result < 0)
        return result;
    if (parent != RIG_NONE && parent >= index)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the parent of the bone \"%s\" must be listed before it",
                         r->bone[index].name);
    r->bone[index].parent = parent;
    return MRT_OK;
}

/* ---- turns of balls ---- */

static const double least_axis = 1e-6, farthest_rad = ANGLE_PI;

/* ---- checks ---- */

static mrt_result check_ball(const rig *r, uint32_t bone, error *err)
{
    mrt_result result = check_index(bone, r->bone_count, "bone", err);
    if (result >= 0 && r->bone[bone].kind != BONE_BALL)
        return error_set(err, MRT_ERR_ARGUMENT, "the bone \"%s\" is not a ball",
                         r->bone[bone].name);
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

static mrt_result check_turn_name(const rig_bone *ball, uint32_t turn, const char *name, error *err)
{
    mrt_result result = check_name(name, err);
    if (result < 0)
        return result;
    if (strlen(ball->name) + 1 + strlen(name) > RIG_NAME_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "\"%s.%s\" is longer than %d characters; choose a shorter name",
                         ball->name, name, RIG_NAME_MAX);
    for (uint32_t i = 0; i < ball->turn_count; ++i)
        if (i != turn && strcmp(ball->turn[i].name, name) == 0)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "another turn is already called \"%s\"; choose another name", name);
    return MRT_OK;
}

/* Requires a range around 0 that is not empty, as the reader does. */
static mrt_result check_way(const rig_turn *turn, error *err)
{
    const double length = vec3_length(turn->axis);
    if (!(length > least_axis && length <= 1e6))
        return error_set(err, MRT_ERR_ARGUMENT, "the turn needs an axis that is not 0");
    if (!(turn->min_rad >= -farthest_rad && turn->min_rad <= 0.0 && turn->max_rad >= 0.0 &&
          turn->max_rad <= farthest_rad))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "a turn ranges from -180..0 to 0..180 degrees; 0 is the pose of the mesh");
    if (!(turn->min_rad < turn->max_rad))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "both limits of the turn are 0; set one of them to some degrees");
    return MRT_OK;
}

static vec3 axis_of(vec3 axis)
{
    const vec3 unit = vec3_normalised(axis, (vec3){1.0, 0.0, 0.0});
    return vec3_normalised(rig_round_axis(unit), unit);
}

static bool is_same_axis(vec3 a, vec3 b)
{
    return !(vec3_length(vec3_sub(a, b)) > 1e-12);
}

/* Rounds a turn to the values that a reader of the file gets. */
static mrt_result round_turn(rig_turn *out, const rig_turn *turn, const rig_turn *before,
                             error *err)
{
    mrt_result result = check_way(turn, err);
    if (result < 0)
        return result;
    *out = *turn;
    out->axis = is_same_axis(turn->axis, before->axis) ? before->axis : axis_of(turn->axis);
    out->min_rad = round_rad(turn->min_rad, before->min_rad);
    out->max_rad = round_rad(turn->max_rad, before->max_rad);
    return check_way(out, err);
}

/* Checks all followers with this one changed, since other turns may follow it. */
static mrt_result check_follows(rig *r, uint32_t bone, uint32_t turn, const rig_follow *to,
                                error *err)
{
    rig_follow *there = &r->bone[bone].turn[turn].follows, before = *there;
    const char *fault = NULL;
    *there = *to;
    for (uint32_t i = 0; i < r->bone_count; ++i)
        for (uint32_t k = 0; k < r->bone[i].turn_count && !fault; ++k)
            fault = rig_follow_fault(r, i, k);
    *there = before;
    return fault ? error_set(err, MRT_ERR_ARGUMENT, "the turn to follow %s", fault) : MRT_OK;
}

/* ---- changes ---- */

mrt_result rig_edit_add_turn(rig *r, uint32_t bone, const rig_turn *turn, uint32_t *out_index,
                             error *err)
{
    const rig_turn none = {NULL, {0.0, 0.0, 0.0}, (double)NAN, (double)NAN, {0}};
    rig_turn made;
    mrt_result result = check_ball(r, bone, err);
    if (result < 0)
        return result;
    rig_bone *ball = &r->bone[bone];
    if (ball->turn_count >= RIG_TURNS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a ball can have at most %d turns",
                         RIG_TURNS_MAX);
    if (count_dofs(r) >= MRT_MAX_DOFS)
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "the bones of a rig can have at most %d degrees of freedom; remove one first",
            MRT_MAX_DOFS);
    result = check_turn_name(ball, RIG_NONE, turn->name, err);
    if (result >= 0 && turn->follows.share != 0.0)
        result =
            error_set(err, MRT_ERR_ARGUMENT, "a new turn cannot follow another turn; add it first");
    if (result >= 0)
        result = round_turn(&made, turn, &none, err);
    if (result < 0)
        return result;
    made.name = strdup(turn->name);
    if (!made.name)
        return no_memory(err);
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
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "a ball needs at least one turn; this one cannot be removed");
    remove_from_poses(r, ball->name, ball->turn[turn].name);
    unlink_followers(r, bone, turn);
    free(ball->turn[turn].name);
    close_array(ball->turn, &ball->turn_count, turn, sizeof *ball->turn);
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
    result = check_turn_name(ball, turn, to->name, err);
    if (result >= 0)
        result = check_follows(r, bone, turn, &to->follows, err);
    if (result >= 0)
        result = round_turn(&made, to, there, err);
    if (result < 0)
        return result;
    made.name = strdup(to->name);
    result = made.name ? rename_in_poses(r, ball->name, ball->name, there->name, made.name, err)
                       : no_memory(err);
    if (result < 0) {
        free(made.name);
        return result;
    }
    free(there->name);
    *there = made;
    return MRT_OK;
}

/* ---- contacts ---- */

static mrt_result check_contact_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_name(name, err);
    return result < 0 ? result : check_free(rig_find_contact(r, name), index, "contact", name, err);
}

mrt_result rig_edit_add_contact(rig *r, const char *name, uint32_t vertex, uint32_t *out_index,
                                error *err)
{
    mrt_result result = check_contact_name(r, RIG_NONE, name, err);
    if (result < 0)
        return result;
    if (r->contact_count >= ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig can have at most %d contacts",
                         ENTRIES_MAX);
    rig_contact *grown = realloc(r->contact, (r->contact_count + 2u) * sizeof *grown);
    if (!grown)
        return no_memory(err);
    r->contact = grown;
    char *copy = strdup(name);
    if (!copy)
        return no_memory(err);
    r->contact[r->contact_count] =
        (rig_contact){.name = copy, .bone = RIG_NONE, .vertex = vertex, .mirror = RIG_NONE};
    *out_index = r->contact_count;
    r->contact_count += 1;
    return MRT_OK;
}

/* ---- removing contacts ---- */

static void close_gap(uint32_t *contact, uint32_t removed)
{
    if (*contact != RIG_NONE && *contact > removed)
        *contact -= 1;
}

static void remove_from_set(rig_contact_set *set, uint32_t removed)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < set->contact_count; ++i)
        if (set->contact[i] != removed)
            set->contact[kept++] = set->contact[i];
    set->contact_count = kept;
    for (uint32_t i = 0; i < kept; ++i)
        close_gap(&set->contact[i], removed);
}

static void remove_contact_from_pose(rig_pose *pose, uint32_t removed)
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
    pose->follow_count = 0;
}

mrt_result rig_edit_remove_contact(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(index, r->contact_count, "contact", err);
    if (result < 0)
        return result;
    free(r->contact[index].name);
    close_array(r->contact, &r->contact_count, index, sizeof *r->contact);
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        if (r->contact[i].mirror == index)
            r->contact[i].mirror = RIG_NONE;
        close_gap(&r->contact[i].mirror, index);
    }
    for (uint32_t i = 0; i < r->contact_set_count; ++i)
        remove_from_set(&r->contact_set[i], index);
    for (uint32_t i = 0; i < r->pose_count; ++i)
        remove_contact_from_pose(&r->pose[i], index);
    return MRT_OK;
}

/* ---- changing one contact ---- */

mrt_result rig_edit_name_contact(rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_index(index, r->contact_count, "contact", err);
    if (result >= 0)
        result = check_contact_name(r, index, name, err);
    return result < 0 ? result : replace_name(&r->contact[index].name, name, err);
}

mrt_result rig_edit_move_contact(rig *r, uint32_t index, uint32_t vertex, error *err)
{
    mrt_result result = check_index(index, r->contact_count, "contact", err);
    if (result >= 0)
        r->contact[index].vertex = vertex;
    return result;
}

mrt_result rig_edit_set_contact_bone(rig *r, uint32_t index, uint32_t bone, error *err)
{
    mrt_result result = check_index(index, r->contact_count, "contact", err);
    if (result < 0)
        return result;
    if (bone != RIG_NONE && bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "the rig has no bone %u", bone);
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

static void unlink_mirror(rig *r, uint32_t index)
{
    uint32_t other = r->contact[index].mirror;
    if (other != RIG_NONE)
        r->contact[other].mirror = RIG_NONE;
    r->contact[index].mirror = RIG_NONE;
}

/* Mirrors bones, too: a contact on eye.l gets a mirror on eye.r. */
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
    mrt_result result = check_index(index, r->contact_count, "contact", err);
    if (result < 0)
        return result;
    uint32_t other = r->contact[index].mirror;
    if (other == RIG_NONE) {
        if (!rig_edit_other_side(r->contact[index].name, name, sizeof name))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "\"%s\" has no side; rename it to \"%s.l\" or \"%s.r\" first",
                             r->contact[index].name, r->contact[index].name,
                             r->contact[index].name);
        other = rig_find_contact(r, name);
        if (other == RIG_NONE)
            result = rig_edit_add_contact(r, name, vertex, &other, err);
        if (result < 0)
            return result;
    }
    unlink_mirror(r, index);
    unlink_mirror(r, other);
    r->contact[index].mirror = other;
    r->contact[other].mirror = index;
    r->contact[other].vertex = vertex;
    r->contact[other].bone = mirrored_bone(r, r->contact[index].bone);
    return MRT_OK;
}

/* ---- collision shapes ---- */

static mrt_result check_proxy(const rig *r, const rig_proxy *proxy, error *err)
{
    if (proxy->bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "the rig has no bone %u", proxy->bone);
    if (!is_position(proxy->centre) || !is_position(proxy->radii))
        return error_set(err, MRT_ERR_ARGUMENT, "the ellipsoid is too far away or too large");
    if (!(proxy->radii.x > 0.0 && proxy->radii.y > 0.0 && proxy->radii.z > 0.0))
        return error_set(err, MRT_ERR_ARGUMENT, "an ellipsoid needs three radii greater than 0");
    return MRT_OK;
}

/* Rounds, but keeps the radius greater than 0. */
static double round_radius(double mm, double before)
{
    const double rounded_proxy = round_mm(mm, before);
    return rounded_proxy > 0.0 ? rounded_proxy : mm;
}

static rig_proxy rounded_proxy(const rig_proxy *proxy, const rig_proxy *before)
{
    rig_proxy out = *proxy;
    out.centre = round_position(proxy->centre, before->centre);
    out.radii = (vec3){round_radius(proxy->radii.x, before->radii.x),
                       round_radius(proxy->radii.y, before->radii.y),
                       round_radius(proxy->radii.z, before->radii.z)};
    out.source = before->source;
    return out;
}

mrt_result rig_edit_add_proxy(rig *r, const rig_proxy *proxy, uint32_t *out_index, error *err)
{
    mrt_result result = check_proxy(r, proxy, err);
    if (result < 0)
        return result;
    if (r->proxy_count >= ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig can have at most %d ellipsoids",
                         ENTRIES_MAX);
    rig_proxy *grown = realloc(r->proxy, (r->proxy_count + 2u) * sizeof *grown);
    if (!grown)
        return no_memory(err);
    r->proxy = grown;
    r->proxy[r->proxy_count] = rounded_proxy(proxy, &(rig_proxy){.source = 0});
    *out_index = r->proxy_count;
    r->proxy_count += 1;
    return MRT_OK;
}

mrt_result rig_edit_remove_proxy(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(index, r->proxy_count, "ellipsoid", err);
    if (result < 0)
        return result;
    close_array(r->proxy, &r->proxy_count, index, sizeof *r->proxy);
    return MRT_OK;
}

mrt_result rig_edit_set_proxy(rig *r, uint32_t index, const rig_proxy *proxy, error *err)
{
    mrt_result result = check_index(index, r->proxy_count, "ellipsoid", err);
    if (result >= 0)
        result = check_proxy(r, proxy, err);
    if (result < 0)
        return result;
    r->proxy[index] = rounded_proxy(proxy, &r->proxy[index]);
    return MRT_OK;
}

/* ---- poses ---- */

static mrt_result check_pose_name(const rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_name(name, err);
    for (uint32_t i = 0; result >= 0 && i < r->pose_count; ++i)
        if (i != index && strcmp(r->pose[i].name, name) == 0)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "another pose is already called \"%s\"; choose another name", name);
    return result;
}

static mrt_result check_pose(const rig *r, const rig_pose *pose, error *err)
{
    static const double most = 100.0; /* rad or mm: more than any bone can move */
    mrt_result result = check_pose_name(r, RIG_NONE, pose->name, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        if (rig_dof_unit_of(r, pose->dof_name[i]) == RIG_DOF_UNKNOWN)
            return error_set(err, MRT_ERR_ARGUMENT, "no bone has the degree of freedom \"%s\"",
                             pose->dof_name[i]);
        if (!(fabs(pose->dof_value[i]) <= most))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "the pose moves a bone too far: expected values within 100 rad or mm");
    }
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        if (pose->pull_contact[i] >= r->contact_count || !is_position(pose->pull_mm[i]))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "the pose pulls a contact that does not exist, or pulls it too far");
    return MRT_OK;
}

static double rounded_dof(const rig *r, const char *dof, double value)
{
    return rig_dof_unit_of(r, dof) == RIG_DOF_RAD ? round_rad(value, (double)NAN)
                                                  : round_mm(value, (double)NAN);
}

static bool copy_pose(rig_pose *out, const rig_pose *from, const rig *r)
{
    *out = (rig_pose){.name = strdup(from->name),
                      .part = from->part,
                      .dof_name = calloc(from->dof_count + 1u, sizeof *out->dof_name),
                      .dof_value = calloc(from->dof_count + 1u, sizeof *out->dof_value),
                      .pull_contact = calloc(from->pull_count + 1u, sizeof *out->pull_contact),
                      .pull_mm = calloc(from->pull_count + 1u, sizeof *out->pull_mm)};
    if (!out->name || !out->dof_name || !out->dof_value || !out->pull_contact || !out->pull_mm)
        return false;
    for (uint32_t i = 0; i < from->dof_count; ++i) {
        out->dof_name[i] = strdup(from->dof_name[i]);
        out->dof_value[i] = rounded_dof(r, from->dof_name[i], from->dof_value[i]);
        out->dof_count = i + 1;
        if (!out->dof_name[i])
            return false;
    }
    for (uint32_t i = 0; i < from->pull_count; ++i) {
        out->pull_contact[i] = from->pull_contact[i];
        out->pull_mm[i] = round_position(from->pull_mm[i], nowhere);
    }
    out->pull_count = from->pull_count;
    return true;
}

mrt_result rig_edit_add_pose(rig *r, const rig_pose *pose, uint32_t *out_index, error *err)
{
    rig_pose made;
    mrt_result result = check_pose(r, pose, err);
    if (result < 0)
        return result;
    if (r->pose_count >= ENTRIES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "a rig can have at most %d poses", ENTRIES_MAX);
    rig_pose *grown = realloc(r->pose, (r->pose_count + 2u) * sizeof *grown);
    if (!grown)
        return no_memory(err);
    r->pose = grown;
    if (!copy_pose(&made, pose, r)) {
        rig_pose_finish(&made);
        return no_memory(err);
    }
    r->pose[r->pose_count] = made;
    *out_index = r->pose_count;
    r->pose_count += 1;
    return MRT_OK;
}

mrt_result rig_edit_remove_pose(rig *r, uint32_t index, error *err)
{
    mrt_result result = check_index(index, r->pose_count, "pose", err);
    if (result < 0)
        return result;
    rig_pose_finish(&r->pose[index]);
    close_array(r->pose, &r->pose_count, index, sizeof *r->pose);
    return MRT_OK;
}

mrt_result rig_edit_name_pose(rig *r, uint32_t index, const char *name, error *err)
{
    mrt_result result = check_index(index, r->pose_count, "pose", err);
    if (result >= 0)
        result = check_pose_name(r, index, name, err);
    return result < 0 ? result : replace_name(&r->pose[index].name, name, err);
}

/* ---- the mouth ---- */

static uint32_t *copy_rim(const uint32_t *rim, uint32_t count)
{
    uint32_t *out = malloc(count * sizeof *out);
    if (out)
        memcpy(out, rim, count * sizeof *out);
    return out;
}

static void free_mouth(rig_mouth *mouth)
{
    free(mouth->upper);
    free(mouth->lower);
    free(mouth->fault);
    *mouth = (rig_mouth){0};
}

mrt_result rig_edit_set_mouth(rig *r, const rig_mouth *mouth, error *err)
{
    const uint32_t count[] = {mouth->upper_count, mouth->lower_count};
    for (int i = 0; i < 2; ++i)
        if (count[i] < RIG_RIM_LEAST || count[i] > RIG_RIM_MOST)
            return error_set(err, MRT_ERR_ARGUMENT, "a rim must have %d to %d vertices",
                             RIG_RIM_LEAST, RIG_RIM_MOST);
    if (!(mouth->upper_share >= 0.0 && mouth->upper_share <= 1.0) ||
        !(mouth->stickiness_mm >= 0.0 && mouth->stickiness_mm <= RIG_STICKINESS_MOST_MM))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "the share of the upper lip must be 0 to 1, and the stickiness 0 to %.0f mm",
            RIG_STICKINESS_MOST_MM);
    if (!r->mouth.upper && count_dofs(r) >= MRT_MAX_DOFS)
        return error_set(
            err, MRT_ERR_UNSUPPORTED,
            "a rig can have at most %d degrees of freedom; remove a bone or a turn first",
            MRT_MAX_DOFS);
    rig_mouth made = *mouth;
    made.upper = copy_rim(mouth->upper, mouth->upper_count);
    made.lower = copy_rim(mouth->lower, mouth->lower_count);
    made.fault = NULL;
    made.upper_share = round_share(mouth->upper_share, r->mouth.upper_share);
    made.stickiness_mm = round_mm(mouth->stickiness_mm, r->mouth.stickiness_mm);
    if (!made.upper || !made.lower) {
        free_mouth(&made);
        return no_memory(err);
    }
    free_mouth(&r->mouth);
    r->mouth = made;
    return MRT_OK;
}

void rig_edit_remove_mouth(rig *r)
{
    free_mouth(&r->mouth);
    remove_from_poses(r, "lips", "seal");
}

/* ---- descriptions for people ---- */

typedef struct words {
    char *at;
    size_t capacity;
} words;

__attribute__((format(printf, 2, 3))) static void append_text(words *w, const char *format, ...)
{
    size_t used = strlen(w->at);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(w->at + used, w->capacity - used, format, arguments);
    va_end(arguments);
}

static uint32_t vertex_count_of(const rig_select *select)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < select->range_count; ++i)
        count += select->last[i] - select->first[i] + 1;
    return count;
}

static void describe(words *w, const rig_select *select);

static void describe_joined(words *w, const rig_select *select)
{
    const char *between = select->kind == SELECT_ALL ? ", " : " or ";
    for (uint32_t i = 0; i < select->child_count; ++i) {
        bool is_group = select->child[i].kind == SELECT_ALL || select->child[i].kind == SELECT_ANY;
        append_text(w, "%s%s", i ? between : "", is_group ? "(" : "");
        describe(w, &select->child[i]);
        append_text(w, "%s", is_group ? ")" : "");
    }
}

static void describe(words *w, const rig_select *select)
{
    switch (select->kind) {
    case SELECT_VERTICES:
        append_text(w, "%u vertices", vertex_count_of(select));
        break;
    case SELECT_GROUP:
        append_text(w, "part %s", select->name);
        break;
    case SELECT_ATTRIBUTE:
        append_text(w, "attribute %s", select->name);
        break;
    case SELECT_BOX:
        append_text(w, "in a box");
        break;
    case SELECT_ELLIPSOID:
        append_text(w, "in an ellipsoid");
        break;
    case SELECT_HALF_SPACE:
        append_text(w, "beyond a plane");
        break;
    case SELECT_WITHIN:
        append_text(w, "within %.0f mm of vertex %u", select->within_mm, select->vertex);
        break;
    case SELECT_ALL:
    case SELECT_ANY:
        describe_joined(w, select);
        break;
    case SELECT_NOT:
        append_text(w, "not ");
        describe(w, &select->child[0]);
        break;
    case SELECT_PAINTED:
        append_text(w, "painted, %u vertices", vertex_count_of(select));
        break;
    case SELECT_PIECE:
        append_text(w, "the piece of vertex %u", select->vertex);
        break;
    case SELECT_PIECES_INSIDE:
        append_text(w, "pieces ");
        describe(w, &select->child[0]);
        break;
    case SELECT_JOINT:
        append_text(w, "joint %s", select->name);
        break;
    case SELECT_NOTHING:
        append_text(w, "nothing");
        break;
    }
}

void rig_edit_describe(const rig_select *select, char *out, size_t capacity)
{
    words w = {out, capacity};
    out[0] = '\0';
    describe(&w, select);
}

/* ---- from a JSON path ---- */

/* "$.regions[1].select" belongs to "$.regions[1]" but not to "$.regions[12]". */
static bool is_below(const char *path, const json_path *entry)
{
    size_t length = strlen(entry->text);
    return strncmp(path, entry->text, length) == 0 &&
           (path[length] == '\0' || path[length] == '.' || path[length] == '[');
}

static bool find_in(const rig *r, rig_section section, uint32_t count, const char *path,
                    uint32_t *out_index)
{
    for (uint32_t i = 0; i < count; ++i) {
        json_path entry = rig_entry_path(r, section, i);
        *out_index = i;
        if (is_below(path, &entry))
            return true;
    }
    return false;
}

rig_edit_kind rig_edit_kind_at(const rig *r, const char *path, uint32_t *out_index)
{
    if (find_in(r, RIG_REGIONS, r->region_count, path, out_index))
        return RIG_EDIT_REGION;
    if (find_in(r, RIG_CONTACTS, r->contact_count, path, out_index))
        return RIG_EDIT_CONTACT;
    return find_in(r, RIG_BONES, r->bone_count, path, out_index) ? RIG_EDIT_BONE : RIG_EDIT_OTHER;
}

/* ---- undo and redo ---- */

struct rig_history {
    rig state[RIG_HISTORY_MAX]; /* state n is at index n % RIG_HISTORY_MAX */
    uint64_t first, now, last;  /* first..last are kept */
};

static rig *state_of(rig_history *self, uint64_t number)
{
    return &self->state[number % RIG_HISTORY_MAX];
}

mrt_result rig_history_create(rig_history **out, rig *first, error *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out) {
        rig_destroy(first);
        return error_set(err, MRT_ERR_MEMORY, "no memory to edit the rig");
    }
    (*out)->state[0] = *first;
    *first = (rig){0};
    return MRT_OK;
}

void rig_history_destroy(rig_history *self)
{
    for (uint64_t i = 0; self && i < RIG_HISTORY_MAX; ++i)
        rig_destroy(&self->state[i]);
    free(self);
}

const rig *rig_history_current(const rig_history *self)
{
    return &self->state[self->now % RIG_HISTORY_MAX];
}

uint64_t rig_history_number(const rig_history *self)
{
    return self->now;
}

void rig_history_push(rig_history *self, rig *changed)
{
    for (uint64_t undone = self->now + 1; undone <= self->last; ++undone)
        rig_destroy(state_of(self, undone));
    self->now += 1;
    self->last = self->now;
    rig_destroy(state_of(self, self->now)); /* the oldest state, if all slots are in use */
    if (self->last - self->first >= RIG_HISTORY_MAX)
        self->first = self->last - RIG_HISTORY_MAX + 1;
    *state_of(self, self->now) = *changed;
    *changed = (rig){0};
}

bool rig_history_restore(rig_history *self, uint64_t number)
{
    if (number < self->first || number > self->last)
        return false;
    self->now = number;
    return true;
}
