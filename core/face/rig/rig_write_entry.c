#include "face/rig/rig_document.h"

#include "base/angle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double radian_per_degree = ANGLE_PI / 180.0;

typedef struct writing {
    const rig *r;
    double source_mm_per_unit, mm_per_unit;
} writing;

/* ---- values: set only where they differ from what is there ---- */

static bool is_same(double a, double b)
{
    return !(a < b) && !(a > b);
}

json_t *rig_number_to_json(double value)
{
    double whole = floor(value + 0.5); /* 30 degrees come back from radians as nearly 30 */
    bool is_whole = fabs(value) < 1e9 && fabs(value - whole) <= 1e-13 * fabs(value);
    return is_whole ? json_integer((json_int_t)whole) : json_real(value);
}

json_t *rig_point_to_json(vec3 point, double mm_per_unit)
{
    json_t *out = json_array();
    json_array_append_new(out, rig_number_to_json(point.x / mm_per_unit));
    json_array_append_new(out, rig_number_to_json(point.y / mm_per_unit));
    json_array_append_new(out, rig_number_to_json(point.z / mm_per_unit));
    return out;
}

/* `usual`: what an absent key means; NaN: it must be there. The file has value / scale. */
static void set_number(json_t *object, const char *key, double value, double scale, double usual)
{
    json_t *there = json_object_get(object, key);
    double before = there ? json_number_value(there) * scale : usual;
    if (!isnan(before) && is_same(before, value))
        return;
    json_object_set_new(object, key, rig_number_to_json(value / scale));
}

/* A NaN means: says nothing. */
static void set_optional_number(json_t *object, const char *key, double value)
{
    if (isnan(value))
        json_object_del(object, key);
    else
        set_number(object, key, value, 1.0, (double)NAN);
}

static bool holds_point(const json_t *there, vec3 point, double scale)
{
    return json_array_size(there) == 3 &&
           is_same(json_number_value(json_array_get(there, 0)) * scale, point.x) &&
           is_same(json_number_value(json_array_get(there, 1)) * scale, point.y) &&
           is_same(json_number_value(json_array_get(there, 2)) * scale, point.z);
}

static void set_point(json_t *object, const char *key, vec3 point, const writing *w)
{
    bool same_unit = is_same(w->source_mm_per_unit, w->mm_per_unit);
    if (!same_unit || !holds_point(json_object_get(object, key), point, w->source_mm_per_unit))
        json_object_set_new(object, key, rig_point_to_json(point, w->mm_per_unit));
}

static void set_text(json_t *object, const char *key, const char *value)
{
    const char *there = json_string_value(json_object_get(object, key));
    if (!there || strcmp(there, value) != 0)
        json_object_set_new(object, key, json_string(value));
}

/* usual_max_rad: from 0 to there, where nothing is said; NaN: it must be there. */
static void set_range(json_t *object, const char *key, double min_rad, double max_rad,
                      double usual_max_rad)
{
    json_t *there = json_object_get(object, key);
    double low = there ? json_number_value(json_array_get(there, 0)) * radian_per_degree : 0.0;
    double high =
        there ? json_number_value(json_array_get(there, 1)) * radian_per_degree : usual_max_rad;
    if (!isnan(high) && is_same(low, min_rad) && is_same(high, max_rad))
        return;
    json_t *range = json_array();
    json_array_append_new(range, rig_number_to_json(min_rad / radian_per_degree));
    json_array_append_new(range, rig_number_to_json(max_rad / radian_per_degree));
    json_object_set_new(object, key, range);
}

/* The object at `key`, made when it is not there. */
static json_t *get_object(json_t *object, const char *key)
{
    json_t *there = json_object_get(object, key);
    if (json_is_object(there))
        return there;
    json_object_set_new(object, key, json_object());
    return json_object_get(object, key);
}

/* ---- bones ---- */

static void write_parent(json_t *out, const rig *r, uint32_t index)
{
    uint32_t usual = RIG_NONE;
    for (uint32_t i = 0; i < index; ++i)
        if (strcmp(r->bone[i].name, "skull") == 0)
            usual = i;
    uint32_t parent = r->bone[index].parent;
    if (parent == RIG_NONE && usual != RIG_NONE)
        json_object_set_new(out, "parent", json_null());
    else if (parent != RIG_NONE && (parent != usual || json_object_get(out, "parent")))
        set_text(out, "parent", r->bone[parent].name);
    else if (parent == RIG_NONE)
        json_object_del(out, "parent");
}

static void write_jaw(json_t *out, const rig_bone *bone, const writing *w)
{
    json_t *hinge = get_object(out, "hinge");
    set_point(hinge, "left", bone->hinge_left, w);
    set_point(hinge, "right", bone->hinge_right, w);
    set_range(out, "open_deg", bone->open_min_rad, bone->open_max_rad, 32.0 * radian_per_degree);
    set_number(out, "lateral_mm", bone->lateral_mm, 1.0, 10.0);
    set_number(out, "forward_mm", bone->forward_mm, 1.0, 8.0);
    set_number(out, "slide_mm", bone->slide_mm, 1.0, 12.0);
    if (bone->has_incisor)
        set_point(out, "incisor", bone->incisor, w);
    else
        json_object_del(out, "incisor");
}

/* Axes are unit in memory and need not be so in the file. */
static bool holds_axis(const json_t *there, vec3 axis)
{
    vec3 found = {json_number_value(json_array_get(there, 0)),
                  json_number_value(json_array_get(there, 1)),
                  json_number_value(json_array_get(there, 2))};
    found = vec3_normalised(found, (vec3){0.0, 0.0, 0.0});
    return json_array_size(there) == 3 && is_same(found.x, axis.x) && is_same(found.y, axis.y) &&
           is_same(found.z, axis.z);
}

static json_t *turn_to_json(const rig_turn *turn, const json_t *source)
{
    json_t *out = json_is_object(source) ? json_deep_copy(source) : json_object();
    set_text(out, "name", turn->name);
    if (!holds_axis(json_object_get(out, "axis"), turn->axis))
        json_object_set_new(out, "axis", rig_point_to_json(rig_round_axis(turn->axis), 1.0));
    set_range(out, "deg", turn->min_rad, turn->max_rad, (double)NAN);
    return out;
}

/* The turn's entry before: by its name, or, when it has a new one, the one in its place. */
static const json_t *source_of_turn(const json_t *before, const rig_bone *bone, uint32_t index)
{
    size_t i;
    json_t *entry;
    json_array_foreach(before, i, entry)
    {
        const char *name = json_string_value(json_object_get(entry, "name"));
        if (name && strcmp(name, bone->turn[index].name) == 0)
            return entry;
    }
    const json_t *there = json_array_get(before, index);
    const char *name = json_string_value(json_object_get(there, "name"));
    for (uint32_t k = 0; name && k < bone->turn_count; ++k)
        if (strcmp(bone->turn[k].name, name) == 0)
            return NULL;
    return there;
}

static void write_ball(json_t *out, const rig_bone *bone, const writing *w)
{
    json_t *ball = get_object(out, "ball");
    set_point(ball, "centre", bone->centre, w);
    set_number(ball, "radius_mm", bone->radius_mm, 1.0, 0.0);
    json_t *turns = json_array();
    json_t *before = json_object_get(out, "turns");
    for (uint32_t i = 0; i < bone->turn_count; ++i)
        json_array_append_new(turns, turn_to_json(&bone->turn[i], source_of_turn(before, bone, i)));
    json_object_set_new(out, "turns", turns);
}

static void write_bone(json_t *out, const writing *w, uint32_t index)
{
    static const char *const jaw_keys[] = {"hinge",      "open_deg", "lateral_mm",
                                           "forward_mm", "slide_mm", "incisor"};
    const rig_bone *bone = &w->r->bone[index];
    set_text(out, "name", bone->name);
    write_parent(out, w->r, index);
    if (bone->kind == BONE_JAW)
        write_jaw(out, bone, w);
    for (size_t i = 0; bone->kind != BONE_JAW && i < sizeof jaw_keys / sizeof *jaw_keys; ++i)
        json_object_del(out, jaw_keys[i]);
    if (bone->kind == BONE_BALL) {
        write_ball(out, bone, w);
        return;
    }
    json_object_del(out, "ball");
    json_object_del(out, "turns");
}

/* ---- regions, contacts, proxies ---- */

static bool source_selects_the_same(const json_t *source, const rig_select *select,
                                    const writing *w)
{
    if (!source || !is_same(w->source_mm_per_unit, w->mm_per_unit))
        return false;
    rig_node node = {source, {"$"}};
    char *note = NULL;
    rig_selecting s = {.mm_per_unit = w->source_mm_per_unit, .note = &note};
    rig_select before;
    bool same =
        rig_select_parse(&before, &node, &s, NULL) >= 0 && rig_select_equals(&before, select);
    rig_select_finish(&before);
    free(note);
    return same;
}

static void write_region_name(json_t *out, const rig_region *region)
{
    rig_node at = {out, {"$"}}, name = rig_json_member(&at, "name");
    char *before = NULL;
    if (region->name)
        set_text(out, "name", region->name);
    else if (name.value && rig_json_text(&before, &name, "a name", RIG_NAME_MAX, NULL) >= 0)
        json_object_del(out, "name");
    free(before);
}

static void write_region(json_t *out, const writing *w, uint32_t index)
{
    const rig_region *region = &w->r->region[index];
    write_region_name(out, region);
    if (region->bone != RIG_NONE)
        set_text(out, "bone", w->r->bone[region->bone].name);
    else
        json_object_del(out, "bone");
    if (region->is_rigid)
        json_object_set_new(out, "rigid", json_true());
    else if (json_is_true(json_object_get(out, "rigid")))
        json_object_del(out, "rigid");
    set_optional_number(out, "weight", region->weight);
    set_optional_number(out, "mobility", region->mobility);
    if (!source_selects_the_same(json_object_get(out, "select"), &region->select, w))
        json_object_set_new(out, "select", rig_select_to_json(&region->select, w->mm_per_unit));
}

static void write_contact(json_t *out, const writing *w, uint32_t index)
{
    const rig_contact *contact = &w->r->contact[index];
    set_text(out, "name", contact->name);
    if (contact->bone != RIG_NONE)
        set_text(out, "bone", w->r->bone[contact->bone].name);
    else if (json_object_get(out, "bone"))
        set_text(out, "bone", "auto");
    set_number(out, "vertex", contact->vertex, 1.0, (double)NAN);
    if (contact->mirror != RIG_NONE)
        set_text(out, "mirror", w->r->contact[contact->mirror].name);
    else
        json_object_del(out, "mirror");
}

static void write_proxy(json_t *out, const writing *w, uint32_t index)
{
    const rig_proxy *proxy = &w->r->proxy[index];
    json_t *ellipsoid = get_object(out, "ellipsoid");
    set_point(ellipsoid, "centre", proxy->centre, w);
    set_point(ellipsoid, "radii", proxy->radii, w);
    set_text(ellipsoid, "bone", w->r->bone[proxy->bone].name);
}

/* ---- poses and sets ---- */

/* Drops members that are not among the names. */
static void keep_only(json_t *object, const char *const *name, uint32_t count)
{
    void *at = json_object_iter(object);
    while (at) {
        const char *key = json_object_iter_key(at);
        bool is_wanted = false;
        for (uint32_t i = 0; i < count; ++i)
            is_wanted = is_wanted || strcmp(name[i], key) == 0;
        void *next = json_object_iter_next(object, at);
        if (!is_wanted)
            json_object_del(object, key);
        at = next;
    }
}

static void write_dofs(json_t *out, const rig *r, const rig_pose *pose)
{
    if (pose->dof_count == 0 && !json_object_get(out, "dofs"))
        return;
    json_t *dofs = get_object(out, "dofs");
    keep_only(dofs, (const char *const *)pose->dof_name, pose->dof_count);
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        const char *name = pose->dof_name[i];
        bool is_angle = rig_dof_unit_of(r, name) == RIG_DOF_RAD;
        set_number(dofs, name, pose->dof_value[i], is_angle ? radian_per_degree : 1.0, (double)NAN);
    }
}

static void write_pulls(json_t *out, const writing *w, const rig_pose *pose)
{
    if (pose->pull_count == 0 && !json_object_get(out, "pulls"))
        return;
    const char **name = calloc(pose->pull_count + 1u, sizeof *name);
    if (!name)
        return;
    json_t *pulls = get_object(out, "pulls");
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        name[i] = w->r->contact[pose->pull_contact[i]].name;
    keep_only(pulls, name, pose->pull_count);
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        set_point(pulls, name[i], pose->pull_mm[i], w);
    free(name);
}

static void write_pose(json_t *out, const writing *w, uint32_t index)
{
    const rig_pose *pose = &w->r->pose[index];
    set_text(out, "name", pose->name);
    write_dofs(out, w->r, pose);
    write_pulls(out, w, pose);
}

static json_t *set_to_json(const rig *r, uint32_t index)
{
    const rig_contact_set *set = &r->contact_set[index];
    json_t *out = json_array();
    for (uint32_t i = 0; i < set->contact_count; ++i)
        json_array_append_new(out, json_string(r->contact[set->contact[i]].name));
    return out;
}

/* ---- the room's ---- */

json_t *rig_entry_to_json(const rig *r, rig_section section, uint32_t index, const json_t *source,
                          double source_mm_per_unit, double mm_per_unit)
{
    static void (*const write[])(json_t *, const writing *,
                                 uint32_t) = {[RIG_BONES] = write_bone,
                                              [RIG_REGIONS] = write_region,
                                              [RIG_CONTACTS] = write_contact,
                                              [RIG_PROXIES] = write_proxy,
                                              [RIG_POSES] = write_pose};
    if (section == RIG_SETS)
        return set_to_json(r, index);
    writing w = {r, source_mm_per_unit, mm_per_unit};
    json_t *out = source ? json_deep_copy(source) : json_object();
    if (out)
        write[section](out, &w, index);
    return out;
}
