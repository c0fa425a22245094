#include "face/rig/rig_document.h"

#include "base/angle.h"
#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to write the rig");
}

/* ---- selectors as JSON ---- */

static json_t *pair_to_json(const char *first, json_t *a, const char *second, json_t *b)
{
    json_t *out = json_object();
    int failed = json_object_set_new(out, first, a);
    failed |= json_object_set_new(out, second, b);
    if (!failed)
        return out;
    json_decref(out);
    return NULL;
}

static json_t *vertices_to_json(const rig_select *select)
{
    json_t *out = json_array();
    for (uint32_t i = 0; i < select->range_count; ++i) {
        char range[32];
        (void)snprintf(range, sizeof range, "%u-%u", select->first[i], select->last[i]);
        json_array_append_new(out, select->first[i] == select->last[i]
                                       ? json_integer((json_int_t)select->first[i])
                                       : json_string(range));
    }
    return out;
}

static json_t *select_to_json(const rig_select *select, double mm_per_unit);

static json_t *children_to_json(const rig_select *select, double mm_per_unit)
{
    json_t *out = json_array();
    for (uint32_t i = 0; i < select->child_count; ++i)
        json_array_append_new(out, select_to_json(&select->child[i], mm_per_unit));
    return out;
}

static json_t *points_to_json(const rig_select *select, double a_unit, double b_unit)
{
    const rig_select_words *word = rig_select_words_of(select->kind);
    return pair_to_json(word->first, rig_point_to_json(select->a, a_unit), word->second,
                        rig_point_to_json(select->b, b_unit));
}

/* Returns the JSON value for the key of this kind of selector. */
static json_t *select_value_to_json(const rig_select *select, double mm_per_unit)
{
    switch (select->kind) {
    case SELECT_VERTICES:
        return vertices_to_json(select);
    case SELECT_GROUP:
    case SELECT_ATTRIBUTE:
    case SELECT_PAINTED:
    case SELECT_JOINT:
        return json_string(select->name);
    case SELECT_BOX:
    case SELECT_ELLIPSOID:
        return points_to_json(select, mm_per_unit, mm_per_unit);
    case SELECT_HALF_SPACE:
        return points_to_json(select, mm_per_unit, 1.0);
    case SELECT_WITHIN:
        return pair_to_json("mm", rig_number_to_json(select->within_mm), "of",
                            json_integer((json_int_t)select->vertex));
    case SELECT_ALL:
    case SELECT_ANY:
        return children_to_json(select, mm_per_unit);
    case SELECT_NOT:
    case SELECT_PIECES_INSIDE:
        return select_to_json(&select->child[0], mm_per_unit);
    case SELECT_PIECE:
        return json_integer((json_int_t)select->vertex);
    case SELECT_NOTHING:
        break;
    }
    return NULL;
}

static json_t *select_to_json(const rig_select *select, double mm_per_unit)
{
    json_t *value = select_value_to_json(select, mm_per_unit);
    return value ? json_pack("{so}", rig_select_words_of(select->kind)->key, value) : NULL;
}

/* ---- selectors compared ---- */

static bool points_equal(vec3 a, vec3 b)
{
    return !(a.x < b.x) && !(a.x > b.x) && !(a.y < b.y) && !(a.y > b.y) && !(a.z < b.z) &&
           !(a.z > b.z);
}

static bool ranges_equal(const rig_select *a, const rig_select *b)
{
    if (a->kind == SELECT_PAINTED) /* paints are stored in the table */
        return true;
    if (a->range_count != b->range_count)
        return false;
    size_t size = a->range_count * sizeof *a->first;
    return size == 0 ||
           (memcmp(a->first, b->first, size) == 0 && memcmp(a->last, b->last, size) == 0);
}

/* Compares paints by name only. */
static bool select_equals(const rig_select *a, const rig_select *b)
{
    if (a->kind != b->kind || a->child_count != b->child_count || !a->name != !b->name ||
        (a->name && strcmp(a->name, b->name) != 0) || !ranges_equal(a, b) ||
        !points_equal(a->a, b->a) || !points_equal(a->b, b->b) || a->vertex != b->vertex ||
        a->within_mm < b->within_mm || a->within_mm > b->within_mm)
        return false;
    for (uint32_t i = 0; i < a->child_count; ++i)
        if (!select_equals(&a->child[i], &b->child[i]))
            return false;
    return true;
}

/* ---- entries as JSON ---- */

static const double radian_per_degree = ANGLE_PI / 180.0;

typedef struct writing {
    const rig *r;
    double source_mm_per_unit, mm_per_unit;
} writing;

/* ---- values: set only if they differ from the file ---- */

static bool is_same(double a, double b)
{
    return !(a < b) && !(a > b);
}

json_t *rig_number_to_json(double value)
{
    double whole =
        floor(value + 0.5); /* 30 degrees converted to radians and back are not exactly 30 */
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

/* `usual`: the meaning of an absent key; NaN if the key is required. The file stores value /
 * scale. */
static void set_number(json_t *object, const char *key, double value, double scale, double usual)
{
    json_t *there = json_object_get(object, key);
    double before = there ? json_number_value(there) * scale : usual;
    if (!isnan(before) && is_same(before, value))
        return;
    json_object_set_new(object, key, rig_number_to_json(value / scale));
}

/* NaN means not set. */
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

/* usual_max_rad: an absent key means 0 to this; NaN if the key is required. */
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

/* Returns the object at `key`. Creates it if it does not exist. */
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
    set_range(out, "open_deg", bone->open_min_rad, bone->open_max_rad, rig_adult_jaw.open_max_rad);
    set_number(out, "lateral_mm", bone->lateral_mm, 1.0, rig_adult_jaw.lateral_mm);
    set_number(out, "forward_mm", bone->forward_mm, 1.0, rig_adult_jaw.forward_mm);
    set_number(out, "slide_mm", bone->slide_mm, 1.0, rig_adult_jaw.slide_mm);
    if (bone->has_incisor)
        set_point(out, "incisor", bone->incisor, w);
    else
        json_object_del(out, "incisor");
}

/* Axes are unit vectors in memory, but need not be in the file. */
static bool holds_axis(const json_t *there, vec3 axis)
{
    vec3 found = {json_number_value(json_array_get(there, 0)),
                  json_number_value(json_array_get(there, 1)),
                  json_number_value(json_array_get(there, 2))};
    found = vec3_normalised(found, (vec3){0.0, 0.0, 0.0});
    return json_array_size(there) == 3 && is_same(found.x, axis.x) && is_same(found.y, axis.y) &&
           is_same(found.z, axis.z);
}

static void write_follows(json_t *out, const rig *r, const rig_follow *follows)
{
    char dof[2 * RIG_NAME_MAX + 2];
    if (follows->share == 0.0) {
        json_object_del(out, "follows");
        return;
    }
    const rig_bone *bone = &r->bone[follows->bone];
    (void)snprintf(dof, sizeof dof, "%s.%s", bone->name, bone->turn[follows->turn].name);
    json_t *to = get_object(out, "follows");
    set_text(to, "dof", dof);
    set_number(to, "share", follows->share, 1.0, (double)NAN);
}

static json_t *turn_to_json(const rig *r, const rig_turn *turn, const json_t *source)
{
    json_t *out = json_is_object(source) ? json_deep_copy(source) : json_object();
    set_text(out, "name", turn->name);
    if (!holds_axis(json_object_get(out, "axis"), turn->axis))
        json_object_set_new(out, "axis", rig_point_to_json(rig_round_axis(turn->axis), 1.0));
    set_range(out, "deg", turn->min_rad, turn->max_rad, (double)NAN);
    write_follows(out, r, &turn->follows);
    return out;
}

/* Returns the turn's entry in the file, by its name. For a new name returns the entry at its index,
 * unless another turn has that entry's name. */
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
        json_array_append_new(turns,
                              turn_to_json(w->r, &bone->turn[i], source_of_turn(before, bone, i)));
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
    json_node node = {source, {"$"}};
    rig_select before;
    bool same = rig_select_parse(&before, &node, w->source_mm_per_unit, NULL) >= 0 &&
                select_equals(&before, select);
    rig_select_finish(&before);
    return same;
}

static void write_region_name(json_t *out, const rig_region *region)
{
    json_node at = {out, {"$"}}, name = json_node_member(&at, "name");
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
        json_object_set_new(out, "select", select_to_json(&region->select, w->mm_per_unit));
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
    json_object_del(out, proxy->kind == PROXY_TEETH ? "ellipsoid" : "teeth");
    json_t *ellipsoid = get_object(out, proxy->kind == PROXY_TEETH ? "teeth" : "ellipsoid");
    set_point(ellipsoid, "centre", proxy->centre, w);
    set_point(ellipsoid, "radii", proxy->radii, w);
    set_text(ellipsoid, "bone", w->r->bone[proxy->bone].name);
}

/* ---- poses and sets ---- */

/* Deletes members that are not among the names. */
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
    if (pose->part == POSE_WHOLE)
        json_object_del(out, "part");
    else
        set_text(out, "part", rig_pose_part_name[pose->part]);
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

/* ---- any entry ---- */

/* Returns entry `index` of a section as JSON for a file of `mm_per_unit`. It is a copy of its
 * source entry, if there is one, with only the differences changed. NULL without memory. */
static json_t *entry_to_json(const rig *r, rig_section section, uint32_t index, double mm_per_unit)
{
    static void (*const write[])(json_t *, const writing *,
                                 uint32_t) = {[RIG_BONES] = write_bone,
                                              [RIG_REGIONS] = write_region,
                                              [RIG_CONTACTS] = write_contact,
                                              [RIG_PROXIES] = write_proxy,
                                              [RIG_POSES] = write_pose};
    if (section == RIG_SETS)
        return set_to_json(r, index);
    const rig_document *d = r->document;
    const rig_entry *source = rig_source(r, section, index);
    writing w = {r, source ? d->file[source->file].mm_per_unit : mm_per_unit, mm_per_unit};
    json_t *out = source ? json_deep_copy(source->node.value) : json_object();
    if (out)
        write[section](out, &w, index);
    return out;
}

/* ---- paints as JSON ---- */

typedef struct painting { /* the file to write */
    json_t *paints;
    const rig *r;
    int failed;
} painting;

/* ---- use of paints ---- */

static bool rig_names(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->region_count; ++i)
        if (rig_select_uses_paint(&r->region[i].select, name))
            return true;
    return false;
}

/* The parser limits the depth of everything that was read, so recursion is safe. */
static bool json_names(const json_t *select, const char *name)
{
    const char *painted = json_string_value(json_object_get(select, "painted"));
    if (painted && strcmp(painted, name) == 0)
        return true;
    const json_t *list[] = {json_object_get(select, "all"), json_object_get(select, "any")};
    for (int k = 0; k < 2; ++k)
        for (size_t i = 0; i < json_array_size(list[k]); ++i)
            if (json_names(json_array_get(list[k], i), name))
                return true;
    const json_t *inner[] = {json_object_get(select, "not"),
                             json_object_get(select, "pieces_inside")};
    for (int k = 0; k < 2; ++k)
        if (inner[k] && json_names(inner[k], name))
            return true;
    return false;
}

static bool file_names(const rig_document *d, const char *name)
{
    for (uint32_t i = 0; i < d->entry_count[RIG_REGIONS]; ++i)
        if (json_names(json_object_get(d->entry[RIG_REGIONS][i].node.value, "select"), name))
            return true;
    return false;
}

/* ---- the table of paints ---- */

static bool equals_paint(const json_node *paint, const rig_select *select)
{
    rig_select before = {0};
    bool same =
        rig_paint_parse(&before, paint, NULL, NULL) >= 0 && rig_paint_equals(&before, select);
    rig_select_finish(&before);
    return same;
}

static void write_paint(painting *p, const rig_select *select)
{
    const rig_document *d = p->r->document;
    uint32_t file = 0;
    json_node before = {0};
    if (d)
        before = rig_document_paint(d, select->name, &file);
    if (before.value && equals_paint(&before, select)) {
        if (!json_object_get(p->paints, select->name))
            p->failed |= json_object_set_new(p->paints, select->name, json_deep_copy(before.value));
        return;
    }
    p->failed |= json_object_set_new(p->paints, select->name, rig_paint_to_json(select));
}

static void write_paints_of(painting *p, const rig_select *select)
{
    if (select->kind == SELECT_PAINTED)
        write_paint(p, select);
    for (uint32_t i = 0; i < select->child_count; ++i)
        write_paints_of(p, &select->child[i]);
}

/* Deletes paints whose regions are gone. Paints that no region ever used belong to another program
 * and stay. */
static void delete_unused(painting *p)
{
    const rig_document *d = p->r->document;
    void *at = json_object_iter(p->paints);
    while (d && at) {
        const char *name = json_object_iter_key(at);
        bool is_forgotten = !rig_names(p->r, name) && file_names(d, name);
        void *next = json_object_iter_next(p->paints, at);
        if (is_forgotten)
            json_object_del(p->paints, name);
        at = next;
    }
}

/* Copies the paints, also those of included files. */
static json_t *start_paints(const rig *r, const json_t *root)
{
    const rig_document *d = r->document;
    const json_t *own = json_object_get(root, "paints");
    json_t *paints = json_is_object(own) ? json_deep_copy(own) : json_object();
    for (uint32_t i = d ? d->file_count : 0; i-- > 0;) {
        json_t *theirs = json_deep_copy(json_object_get(d->file[i].root, "paints"));
        json_object_update_missing(paints, theirs);
        json_decref(theirs);
    }
    return paints;
}

/* Sets "paints" in the root from the rig's selectors. */
static mrt_result write_paints(json_t *root, const rig *r, error *err)
{
    painting p = {start_paints(r, root), r, 0};
    p.failed = p.paints == NULL;
    delete_unused(&p);
    for (uint32_t i = 0; i < r->region_count; ++i)
        write_paints_of(&p, &r->region[i].select);
    if (json_object_size(p.paints) > 0)
        p.failed |= json_object_set(root, "paints", p.paints);
    else if (json_is_object(json_object_get(root, "paints")))
        (void)json_object_del(root, "paints");
    json_decref(p.paints);
    return p.failed ? no_memory(err) : MRT_OK;
}

/* ---- the file ---- */

enum { DUMP_FLAGS = JSON_ENCODE_ANY | JSON_REAL_PRECISION(15) };

/* ---- paths ---- */

/* Returns the absolute directory of a file that need not exist, with the final '/'. The caller
 * frees it. */
static char *real_directory(const char *path)
{
    char *directory = file_directory(path);
    char *real = directory ? realpath(directory[0] ? directory : ".", NULL) : NULL;
    free(directory);
    if (!real)
        return NULL;
    size_t size = strlen(real) + 2;
    char *out = malloc(size);
    if (out)
        (void)snprintf(out, size, "%s/", strcmp(real, "/") == 0 ? "" : real);
    free(real);
    return out;
}

/* Returns `to` relative to the directory `from`; both are absolute. */
static char *relative_path(const char *from, const char *to)
{
    size_t common = 0;
    for (size_t i = 0; from[i] && from[i] == to[i]; ++i)
        if (from[i] == '/')
            common = i + 1;
    uint32_t up_count = 0;
    for (const char *at = from + common; *at; ++at)
        up_count += *at == '/';
    size_t size = 3 * (size_t)up_count + strlen(to + common) + 1;
    char *out = malloc(size);
    if (!out)
        return NULL;
    for (uint32_t i = 0; i < up_count; ++i)
        memcpy(out + 3 * (size_t)i, "../", 3);
    (void)snprintf(out + 3 * (size_t)up_count, size - 3 * (size_t)up_count, "%s", to + common);
    return out;
}

/* Returns the name of the mesh for a rig file at `path`. The caller frees it. */
static char *mesh_name_for(const rig *r, const char *path)
{
    char *from = real_directory(path), *to = real_directory(r->mesh_path);
    const char *slash = strrchr(r->mesh_path, '/');
    const char *base = slash ? slash + 1 : r->mesh_path;
    char *out = NULL;
    if (from && to) {
        size_t size = strlen(to) + strlen(base) + 1;
        char *mesh = malloc(size);
        if (mesh)
            (void)snprintf(mesh, size, "%s%s", to, base);
        out = mesh ? relative_path(from, mesh) : NULL;
        free(mesh);
    } else {
        out = strdup(r->mesh_path);
    }
    free(from);
    free(to);
    return out;
}

static bool is_same_directory(const char *a, const char *b)
{
    char *first = real_directory(a), *second = real_directory(b);
    bool same = first && second && strcmp(first, second) == 0;
    free(first);
    free(second);
    return same;
}

static uint32_t entry_count_of(const rig *r, rig_section section)
{
    const uint32_t count[RIG_SECTIONS] = {
        [RIG_BONES] = r->bone_count,       [RIG_REGIONS] = r->region_count,
        [RIG_CONTACTS] = r->contact_count, [RIG_PROXIES] = r->proxy_count,
        [RIG_POSES] = r->pose_count,       [RIG_SETS] = r->contact_set_count};
    return count[section];
}

/* ---- the whole file ---- */

static mrt_result write_section(json_t *root, const rig *r, rig_section section, error *err)
{
    const char *key = rig_section_key[section];
    json_t *all = section == RIG_SETS ? json_object() : json_array();
    int failed = all == NULL;
    for (uint32_t i = 0; !failed && i < entry_count_of(r, section); ++i) {
        json_t *entry = entry_to_json(r, section, i, r->mm_per_unit);
        failed = section == RIG_SETS ? json_object_set_new(all, r->contact_set[i].name, entry)
                                     : json_array_append_new(all, entry);
    }
    bool is_empty = json_object_size(all) + json_array_size(all) == 0;
    if (!failed && (!is_empty || json_object_get(root, key)))
        failed = json_object_set(root, key, all);
    json_decref(all);
    return failed ? no_memory(err) : MRT_OK;
}

static void update_solver(json_t *solver, const csrbf_settings *settings)
{
    csrbf_kernel kernel = CSRBF_WENDLAND_C2;
    csrbf_polynomial polynomial = CSRBF_NONE;
    const char *word = json_string_value(json_object_get(solver, "kernel"));
    if ((word && !csrbf_kernel_named(word, &kernel)) || kernel != settings->kernel)
        json_object_set_new(solver, "kernel", json_string(csrbf_kernel_name(settings->kernel)));
    word = json_string_value(json_object_get(solver, "polynomial"));
    if ((word && !csrbf_polynomial_named(word, &polynomial)) || polynomial != settings->polynomial)
        json_object_set_new(solver, "polynomial",
                            json_string(csrbf_polynomial_name(settings->polynomial)));
    const double value[] = {settings->radius, settings->ridge};
    static const char *const key[] = {"radius_mm", "ridge"};
    for (int i = 0; i < 2; ++i) {
        double before = json_number_value(json_object_get(solver, key[i]));
        if (value[i] < before || value[i] > before)
            json_object_set_new(solver, key[i], rig_number_to_json(value[i]));
    }
}

static mrt_result write_solver(json_t *root, const rig *r, error *err)
{
    uint32_t file;
    json_node before = {0};
    if (r->document)
        before = rig_document_scalar(r->document, "solver", &file);
    json_t *solver = before.value ? json_deep_copy(before.value) : json_object();
    if (!solver)
        return no_memory(err);
    update_solver(solver, &r->solver);
    bool is_news = before.value ? !json_equal(solver, before.value) : json_object_size(solver) > 0;
    if (is_news)
        json_object_set(root, "solver", solver);
    json_decref(solver);
    return MRT_OK;
}

static const char *unit_name(double mm_per_unit)
{
    return mm_per_unit > 100.0 ? "m" : mm_per_unit > 5.0 ? "cm" : "mm";
}

/* Sets the keys that a new file needs, if no file or another file set them before. */
static mrt_result write_identity(json_t *root, const rig *r, const char *path, error *err)
{
    char *mesh = mesh_name_for(r, path);
    if (!mesh)
        return no_memory(err);
    int failed = json_object_set_new(root, "marotte_rig", json_integer(1));
    failed |= json_object_set_new(root, "name", json_string(r->name));
    failed |= json_object_set_new(root, "mesh", json_string(mesh));
    failed |= json_object_set_new(root, "unit", json_string(unit_name(r->mm_per_unit)));
    free(mesh);
    return failed ? no_memory(err) : MRT_OK;
}

static void write_mesh_facts(json_t *root, const rig *r)
{
    char hash[20];
    (void)snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->mesh_hash);
    if (r->mesh_vertex_count > 0)
        json_object_set_new(root, "mesh_vertices", json_integer((json_int_t)r->mesh_vertex_count));
    if (r->mesh_hash != 0)
        json_object_set_new(root, "mesh_hash", json_string(hash));
    if (r->frame.mm_per_unit > 0.0)
        json_object_set_new(root, "mesh_unit", rig_number_to_json(r->frame.mm_per_unit));
    if (r->frame.up != MESH_AXIS_AUTO)
        json_object_set_new(root, "mesh_up", json_string(mesh_axis_name(r->frame.up)));
    if (r->frame.forward != MESH_AXIS_AUTO)
        json_object_set_new(root, "mesh_forward", json_string(mesh_axis_name(r->frame.forward)));
    json_t *cut = r->cut_mouth ? json_array() : NULL;
    for (uint32_t i = 0; i < r->cut_mouth_count; ++i)
        json_array_append_new(cut, json_integer((json_int_t)r->cut_mouth[i]));
    if (cut)
        json_object_set_new(root, "cut_mouth", cut);
}

static json_t *rim_to_json(const uint32_t *rim, uint32_t count)
{
    json_t *list = json_array();
    for (uint32_t i = 0; i < count; ++i)
        json_array_append_new(list, json_integer((json_int_t)rim[i]));
    return list;
}

static void write_mouth(json_t *root, const rig *r)
{
    const rig_mouth *mouth = &r->mouth;
    if (!mouth->upper) {
        json_object_del(root, "mouth");
        return;
    }
    if (mouth->fault)
        return; /* keep the text of the file */
    json_t *out = get_object(root, "mouth");
    json_object_set_new(out, "upper", rim_to_json(mouth->upper, mouth->upper_count));
    json_object_set_new(out, "lower", rim_to_json(mouth->lower, mouth->lower_count));
    set_number(out, "upper_share", mouth->upper_share, 1.0, RIG_UPPER_SHARE);
    if (mouth->stickiness_mm > 0.0)
        json_object_set_new(out, "stickiness_mm", rig_number_to_json(mouth->stickiness_mm));
    else
        json_object_del(out, "stickiness_mm");
    if (mouth->seal_from == SEAL_FROM_MIDDLE)
        json_object_set_new(out, "seal_from", json_string("middle"));
    else
        json_object_del(out, "seal_from");
}

/* Copies this file's keys, and those of the files that it includes. */
static json_t *start_root(const rig *r)
{
    const rig_document *d = r->document;
    if (!d)
        return json_object();
    json_t *root = json_deep_copy(d->file[d->file_count - 1].root);
    for (uint32_t i = d->file_count - 1; i-- > 0;) {
        json_t *included = json_deep_copy(d->file[i].root);
        json_object_update_missing(root, included);
        json_decref(included);
    }
    if (root)
        json_object_del(root, "include");
    return root;
}

static mrt_result fill_root(json_t *root, const rig *r, const char *path, error *err)
{
    const rig_document *d = r->document;
    bool stays_alone = d && d->file_count == 1 && is_same_directory(path, r->path);
    mrt_result result = MRT_OK;
    if (!stays_alone)
        result = write_identity(root, r, path, err);
    write_mesh_facts(root, r);
    write_mouth(root, r);
    for (int section = 0; result >= 0 && section < RIG_SECTIONS; ++section)
        result = write_section(root, r, (rig_section)section, err);
    if (result >= 0)
        result = write_paints(root, r, err);
    return result < 0 ? result : write_solver(root, r, err);
}

/* ---- the text: one line per entry ---- */

static bool is_long(const json_t *value)
{
    return json_is_object(json_array_get(value, 0)) ||
           json_is_array(json_object_iter_value(json_object_iter((json_t *)(uintptr_t)value)));
}

static void print_long(FILE *stream, const json_t *value)
{
    json_t *changeable = (json_t *)(uintptr_t)value;
    bool is_array = json_is_array(value);
    fputs(is_array ? "[" : "{", stream);
    for (size_t i = 0; i < json_array_size(value); ++i) {
        fputs(i ? ",\n    " : "\n    ", stream);
        json_dumpf(json_array_get(value, i), stream, DUMP_FLAGS);
    }
    void *first = json_object_iter(changeable);
    for (void *at = first; at; at = json_object_iter_next(changeable, at)) {
        json_t *key = json_string(json_object_iter_key(at));
        fputs(at == first ? "\n    " : ",\n    ", stream);
        json_dumpf(key, stream, DUMP_FLAGS);
        fputs(": ", stream);
        json_dumpf(json_object_iter_value(at), stream, DUMP_FLAGS);
        json_decref(key);
    }
    fputs(is_array ? "\n  ]" : "\n  }", stream);
}

static void print_root(FILE *stream, json_t *root)
{
    void *first = json_object_iter(root);
    fputs("{", stream);
    for (void *at = first; at; at = json_object_iter_next(root, at)) {
        json_t *key = json_string(json_object_iter_key(at));
        const json_t *value = json_object_iter_value(at);
        fputs(at == first ? "\n  " : ",\n  ", stream);
        json_dumpf(key, stream, DUMP_FLAGS);
        fputs(": ", stream);
        if (is_long(value))
            print_long(stream, value);
        else
            json_dumpf(value, stream, DUMP_FLAGS);
        json_decref(key);
    }
    fputs("\n}\n", stream);
}

mrt_result rig_write(const rig *r, const char *path, error *err)
{
    json_t *root = start_root(r);
    if (!root)
        return no_memory(err);
    file_writer writer = {0};
    mrt_result result = fill_root(root, r, path, err);
    if (result >= 0)
        result = file_writer_open(&writer, path, err);
    if (result >= 0) {
        print_root(writer.stream, root);
        result = file_writer_commit(&writer, err);
    }
    json_decref(root);
    return result;
}
