/* Reads and writes the objects of a rig file: a table for each, and the functions of the fields
 * that no type of rig_fields.h describes. */
#include "face/rig/rig_fields.h"

#include "base/angle.h"
#include "base/file.h"
#include "base/text.h"
#include "mesh/cut.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- rows of the tables ---- */

#define AT(type, field)           .offset = offsetof(type, field)
#define RANGE(least, most)        .low = (least), .high = (most)
#define CUSTOM(name, from, to)    .key = (name), .read = (from), .write = (to)
#define ELSEWHERE(name)           .key = (name) /* another function reads and writes it */
#define OF(name, type, field, is) .key = (name), .kind = (is), AT(type, field)
#define NUMBER(name, type, field, least, most)                                                     \
    OF(name, type, field, FIELD_NUMBER), RANGE(least, most)
#define NUMBER_OR(name, type, field, least, most, how, value)                                      \
    NUMBER(name, type, field, least, most), .use = (how), .usual = (value)
#define TEXT(name, type, field, most, what)                                                        \
    OF(name, type, field, FIELD_TEXT), RANGE(1, most), .expected = (what)
#define WORD_OR(name, type, field, least, most, words, how, value, what)                           \
    OF(name, type, field, FIELD_WORD), RANGE(least, most), .word = (words), .use = (how),          \
                                                           .usual = (value), .expected = (what)
#define VERTICES(name, how, type, field, least, most, what)                                        \
    OF(name, type, field, FIELD_VERTICES), .count_offset = offsetof(type, field##_count),          \
                                           .use = (how), RANGE(least, most), .expected = (what)
#define OBJECT(name, fields, what, checks)                                                         \
    .key = (name), .kind = FIELD_OBJECT, .inner = (fields), .expected = (what), .check = (checks)

static const double radian_per_degree = ANGLE_PI / 180.0;

/* ---- selectors ---- */

enum {
    DEPTH_MAX = 12,
    NODES_MAX = 4096,
    CHILDREN_MAX = 256,
    RANGES_MAX = INT32_MAX,
    GROUP_MAX = 255
};

static const char kind_list[] = "one of vertices, group, attribute, box, ellipsoid, half_space, "
                                "within, all, any, not, painted, piece, pieces_inside, joint";

static mrt_result read_select(rig_select *out, const json_node *at, rig_reading *in, error *err);
static json_t *select_to_json(const rig_select *select, rig_writing *w);

/* ---- vertices ---- */

static mrt_result read_vertex_range(uint32_t *first, uint32_t *last, const json_node *at,
                                    error *err)
{
    if (!json_is_string(at->value)) {
        mrt_result result = rig_json_vertex(first, at, err);
        *last = *first;
        return result;
    }
    text_view rest = text_view_of(json_string_value(at->value), json_string_length(at->value));
    text_view word[2], more;
    int64_t number[2];
    bool is_range = text_next_field(&rest, '-', &word[0]) &&
                    text_next_field(&rest, '-', &word[1]) && !text_next_field(&rest, '-', &more) &&
                    text_int(word[0], &number[0]) && text_int(word[1], &number[1]);
    if (!is_range || number[0] < 0 || number[1] < number[0] || number[1] >= INT32_MAX)
        return json_node_unexpected(err, at, "a vertex number, or a range like \"120-180\"");
    *first = (uint32_t)number[0];
    *last = (uint32_t)number[1];
    return MRT_OK;
}

static mrt_result read_vertices(void *to, const json_node *of, rig_reading *in, error *err)
{
    (void)in;
    rig_select *out = to;
    json_node list = json_node_member(of, "vertices"), *at = &list;
    mrt_result result =
        json_node_array(at, "a list of vertices like [204, \"120-180\"]", RANGES_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(at->value);
    out->first = calloc(count + 1, sizeof *out->first);
    out->last = calloc(count + 1, sizeof *out->last);
    if (!out->first || !out->last)
        return rig_no_memory(err);
    out->range_count = (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node item = json_node_item(at, i);
        result = read_vertex_range(&out->first[i], &out->last[i], &item, err);
    }
    return result;
}

static void write_vertices(json_t *to, const void *of, rig_writing *w)
{
    const rig_select *select = of;
    json_t *out = json_array();
    for (uint32_t i = 0; i < select->range_count; ++i) {
        char range[32];
        (void)snprintf(range, sizeof range, "%u-%u", select->first[i], select->last[i]);
        json_array_append_new(out, select->first[i] == select->last[i]
                                       ? json_integer((json_int_t)select->first[i])
                                       : json_string(range));
    }
    rig_set(to, "vertices", out, w);
}

/* ---- other selectors inside ---- */

static mrt_result read_children(void *to, const json_node *of, rig_reading *in, error *err)
{
    rig_select *out = to;
    json_node list = json_node_member(of, rig_select_key(out->kind));
    mrt_result result = json_node_array(&list, "a list of selectors", CHILDREN_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(list.value);
    if (count == 0)
        return json_node_unexpected(err, &list, "at least one selector");
    out->child = calloc(count, sizeof *out->child);
    if (!out->child)
        return rig_no_memory(err);
    out->child_count = (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node item = json_node_item(&list, i);
        result = read_select(&out->child[i], &item, in, err);
    }
    return result;
}

static void write_children(json_t *to, const void *of, rig_writing *w)
{
    const rig_select *select = of;
    json_t *list = json_array();
    for (uint32_t i = 0; i < select->child_count; ++i)
        json_array_append_new(list, select_to_json(&select->child[i], w));
    rig_set(to, rig_select_key(select->kind), list, w);
}

static mrt_result read_inner(void *to, const json_node *of, rig_reading *in, error *err)
{
    rig_select *out = to;
    json_node inner = json_node_member(of, rig_select_key(out->kind));
    out->child = calloc(1, sizeof *out->child);
    if (!out->child)
        return rig_no_memory(err);
    out->child_count = 1;
    return read_select(&out->child[0], &inner, in, err);
}

static void write_inner(json_t *to, const void *of, rig_writing *w)
{
    const rig_select *select = of;
    rig_set(to, rig_select_key(select->kind), select_to_json(&select->child[0], w), w);
}

/* ---- paints, boxes ---- */

static mrt_result read_painted(void *to, const json_node *of, rig_reading *in, error *err)
{
    rig_select *out = to;
    json_node at = json_node_member(of, "painted");
    mrt_result result = rig_json_text(&out->name, &at, "the name of a paint", RIG_NAME_MAX, err);
    if (result < 0 || !in->document)
        return result;
    uint32_t file;
    json_node paint = rig_document_paint(in->document, out->name, &file);
    if (paint.value)
        return rig_paint_parse(out, &paint, &in->document->budget, err);
    json_words word = json_shown(out->name);
    return error_set(err, MRT_ERR_FORMAT, "%s: the rig has no paint \"%s\"; add it to $.paints",
                     at.path.text, word.text);
}

static void write_painted(json_t *to, const void *of, rig_writing *w)
{
    rig_set_text(to, "painted", ((const rig_select *)of)->name, w);
}

static mrt_result check_box(const void *of, const json_node *at, error *err)
{
    const rig_select *box = of;
    if (box->a.x > box->b.x || box->a.y > box->b.y || box->a.z > box->b.z)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: \"low\" must not exceed \"high\" in x, y or z; exchange them",
                         at->path.text);
    return MRT_OK;
}

/* ---- any selector ---- */

static const rig_field box_fields[] = {{OF("low", rig_select, a, FIELD_POINT)},
                                       {OF("high", rig_select, b, FIELD_POINT)},
                                       {.key = NULL}};
static const rig_field ellipsoid_fields[] = {{OF("centre", rig_select, a, FIELD_POINT)},
                                             {OF("radii", rig_select, b, FIELD_RADII)},
                                             {.key = NULL}};
static const rig_field half_space_fields[] = {{OF("point", rig_select, a, FIELD_POINT)},
                                              {OF("normal", rig_select, b, FIELD_DIRECTION)},
                                              {.key = NULL}};
static const rig_field within_fields[] = {{NUMBER("mm", rig_select, within_mm, 0.0, 1e6)},
                                          {OF("of", rig_select, vertex, FIELD_VERTEX)},
                                          {.key = NULL}};

#define NAME(key, what) TEXT(key, rig_select, name, GROUP_MAX, what)
static const rig_field select_fields[] = {
    [SELECT_VERTICES] = {CUSTOM("vertices", read_vertices, write_vertices)},
    [SELECT_GROUP] = {NAME("group", "the name of a part or material")},
    [SELECT_ATTRIBUTE] = {NAME("attribute", "the name of a vertex attribute like \"_SKULL\"")},
    [SELECT_BOX] = {OBJECT("box", box_fields, "an object", check_box)},
    [SELECT_ELLIPSOID] = {OBJECT("ellipsoid", ellipsoid_fields, "an object", NULL)},
    [SELECT_HALF_SPACE] = {OBJECT("half_space", half_space_fields, "an object", NULL)},
    [SELECT_WITHIN] = {OBJECT("within", within_fields, "an object like {\"mm\": 12, \"of\": 4275}",
                              NULL)},
    [SELECT_ALL] = {CUSTOM("all", read_children, write_children)},
    [SELECT_ANY] = {CUSTOM("any", read_children, write_children)},
    [SELECT_NOT] = {CUSTOM("not", read_inner, write_inner)},
    [SELECT_PAINTED] = {CUSTOM("painted", read_painted, write_painted)},
    [SELECT_PIECE] = {OF("piece", rig_select, vertex, FIELD_VERTEX)},
    [SELECT_PIECES_INSIDE] = {CUSTOM("pieces_inside", read_inner, write_inner)},
    [SELECT_JOINT] = {NAME("joint", "the name of a joint like \"Head\"")},
    [SELECT_JOINT + 1] = {.key = NULL}};

const char *rig_select_key(rig_select_kind kind)
{
    return select_fields[kind].key;
}

static mrt_result find_select_kind(rig_select *out, const json_node *at, rig_reading *in,
                                   error *err)
{
    mrt_result result = json_node_object(at, "an object", err);
    if (result < 0)
        return result;
    for (rig_select_kind kind = SELECT_NOTHING + 1; select_fields[kind].key; ++kind) {
        if (!json_object_get(at->value, select_fields[kind].key))
            continue;
        if (out->kind != SELECT_NOTHING)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: has both \"%s\" and \"%s\"; combine them with \"all\" or \"any\"",
                             at->path.text, rig_select_key(out->kind), select_fields[kind].key);
        out->kind = kind;
    }
    if (out->kind == SELECT_NOTHING)
        return json_node_unexpected(err, at, kind_list);
    rig_fields_note_unknown(&select_fields[SELECT_NOTHING + 1], at, in);
    return MRT_OK;
}

static mrt_result read_select(rig_select *out, const json_node *at, rig_reading *in, error *err)
{
    *out = (rig_select){0};
    if (in->depth >= DEPTH_MAX || in->select_count >= NODES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: selectors can be nested %d deep, and a rig can have %d of them; use "
                         "groups or attributes instead",
                         at->path.text, DEPTH_MAX, NODES_MAX);
    in->select_count += 1;
    mrt_result result = find_select_kind(out, at, in, err);
    if (result < 0)
        return result;
    out->path = strdup(at->path.text);
    if (!out->path)
        return rig_no_memory(err);
    in->depth += 1;
    result = rig_field_read(out, &select_fields[out->kind], at, in, err);
    in->depth -= 1;
    return result;
}

static json_t *select_to_json(const rig_select *select, rig_writing *w)
{
    json_t *out = json_object();
    rig_field_write(out, &select_fields[select->kind], select, w);
    return out;
}

/* ---- bones ---- */

#define JAW_OPEN_RAD   (32.0 * ANGLE_PI / 180.0)
#define JAW_LATERAL_MM 10.0
#define JAW_FORWARD_MM 8.0
#define JAW_SLIDE_MM   12.0
/* Limits of an adult (Ferrario 2005, Travers 2000). */
const rig_bone rig_adult_jaw = {.kind = BONE_JAW,
                                .open_max_rad = JAW_OPEN_RAD,
                                .lateral_mm = JAW_LATERAL_MM,
                                .forward_mm = JAW_FORWARD_MM,
                                .slide_mm = JAW_SLIDE_MM};

/* ---- parents ---- */

static mrt_result read_parent(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig_bone *bone = out;
    json_node parent = json_node_member(at, "parent");
    const char *name = parent.value ? json_string_value(parent.value) : "skull";
    bone->parent = RIG_NONE;
    if (json_is_null(parent.value))
        return MRT_OK;
    if (!name)
        return json_node_unexpected(err, &parent, "the name of a bone, or null for none");
    bone->parent = rig_find_bone(in->r, name); /* finds only bones that were read before this one */
    if (parent.value && bone->parent == RIG_NONE) {
        json_words word = json_shown(name);
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: no bone before this one is called \"%s\"; list parents first",
                         parent.path.text, word.text);
    }
    return MRT_OK;
}

static void write_parent(json_t *to, const void *of, rig_writing *w)
{
    const rig_bone *bone = of, *all = w->r->bone;
    uint32_t usual = RIG_NONE, parent = bone->parent;
    for (uint32_t i = 0; &all[i] < bone; ++i)
        if (strcmp(all[i].name, "skull") == 0)
            usual = i;
    if (parent == RIG_NONE && usual != RIG_NONE)
        rig_set(to, "parent", json_null(), w);
    else if (parent != RIG_NONE && (parent != usual || json_object_get(to, "parent")))
        rig_set_text(to, "parent", all[parent].name, w);
    else if (parent == RIG_NONE)
        json_object_del(to, "parent");
}

/* ---- jaw ---- */

static mrt_result check_hinge(const void *of, const json_node *at, error *err)
{
    const rig_bone *bone = of;
    double length_mm = vec3_length(vec3_sub(bone->hinge_left, bone->hinge_right));
    if (!(length_mm > 1.0))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: left and right are only %.3g mm apart, so they give no axis; use the "
                         "two jaw joints, just in front of the ears",
                         at->path.text, length_mm);
    return MRT_OK;
}

static mrt_result read_incisor(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig_bone *bone = out;
    json_node point = json_node_member(at, "incisor");
    bone->has_incisor = point.value != NULL;
    return point.value ? rig_json_point(&bone->incisor, &point, in->mm_per_unit, err) : MRT_OK;
}

static void write_incisor(json_t *to, const void *of, rig_writing *w)
{
    const rig_bone *bone = of;
    if (bone->has_incisor)
        rig_set_point(to, "incisor", bone->incisor, w);
    else
        json_object_del(to, "incisor");
}

/* ---- ball: a turn that follows another ---- */

/* The bone that is read is the next entry of the rig: it is not counted in bone_count yet. */
static mrt_result read_followed(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig_follow *follows = out;
    json_node dof = json_node_member(at, "dof");
    const char *name = json_string_value(dof.value);
    if (!name)
        return json_node_unexpected(err, &dof, "a degree of freedom like \"eye.l.pitch\"");
    in->r->bone_count += 1; /* include its own turns in the search */
    bool is_found = rig_find_turn(in->r, name, &follows->bone, &follows->turn);
    in->r->bone_count -= 1;
    if (is_found)
        return MRT_OK;
    json_words word = json_shown(name);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: \"%s\" is not a turn of a ball that is listed before it", dof.path.text,
                     word.text);
}

static void write_followed(json_t *to, const void *of, rig_writing *w)
{
    const rig_follow *follows = of;
    const rig_bone *bone = &w->r->bone[follows->bone];
    char dof[2 * RIG_NAME_MAX + 2];
    (void)snprintf(dof, sizeof dof, "%s.%s", bone->name, bone->turn[follows->turn].name);
    rig_set_text(to, "dof", dof, w);
}

static const rig_field follow_fields[] = {{CUSTOM("dof", read_followed, write_followed)},
                                          {NUMBER("share", rig_follow, share, -1.0, 1.0)},
                                          {.key = NULL}};

static mrt_result read_follows(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig_turn *turn = out;
    uint32_t bone = in->r->bone_count;
    json_node follows = json_node_member(at, "follows");
    if (!follows.value)
        return MRT_OK;
    mrt_result result = json_node_object(&follows, "an object with dof and share", err);
    if (result >= 0)
        result = rig_fields_read(&turn->follows, follow_fields, &follows, in, err);
    if (result < 0)
        return result;
    const char *fault = rig_follow_fault(in->r, bone, (uint32_t)(turn - in->r->bone[bone].turn));
    if (!fault)
        return MRT_OK;
    json_node dof = json_node_member(&follows, "dof");
    json_words word = json_shown(json_string_value(dof.value));
    return error_set(err, MRT_ERR_FORMAT, "%s: \"%s\" %s", dof.path.text, word.text, fault);
}

static void write_follows(json_t *to, const void *of, rig_writing *w)
{
    const rig_turn *turn = of;
    if (turn->follows.share == 0.0)
        json_object_del(to, "follows");
    else
        rig_fields_write(rig_set_object(to, "follows", w), follow_fields, &turn->follows, w);
}

/* ---- ball: turns ---- */

static const rig_field turn_fields[] = {
    {TEXT("name", rig_turn, name, RIG_NAME_MAX, "a name like \"yaw\"")},
    {OF("axis", rig_turn, axis, FIELD_AXIS)},
    {.key = "deg", .kind = FIELD_RANGE, AT(rig_turn, min_rad), RANGE(-180.0, 180.0)},
    {CUSTOM("follows", read_follows, write_follows)},
    {.key = NULL}};

static mrt_result check_turn_name(const rig_bone *bone, uint32_t index, const json_node *at,
                                  error *err)
{
    const char *name = bone->turn[index].name;
    if (strlen(bone->name) + 1 + strlen(name) > RIG_NAME_MAX)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.name: \"%s.%s\" is longer than %d characters; shorten it",
                         at->path.text, bone->name, name, RIG_NAME_MAX);
    for (uint32_t i = 0; i < index; ++i)
        if (strcmp(bone->turn[i].name, name) == 0)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s.name: the ball already has a turn \"%s\"; choose another name",
                             at->path.text, name);
    return MRT_OK;
}

static mrt_result read_turns(void *out, const json_node *at, rig_reading *in, error *err)
{
    static const char expected[] = "a list of one to three turns";
    rig_bone *bone = out;
    json_node turns = json_node_member(at, "turns");
    mrt_result result = json_node_array(&turns, expected, RIG_TURNS_MAX, err);
    if (result >= 0 && json_array_size(turns.value) == 0)
        result = json_node_unexpected(err, &turns, expected);
    for (uint32_t i = 0; result >= 0 && i < json_array_size(turns.value); ++i) {
        json_node item = json_node_item(&turns, i);
        result = json_node_object(&item, "an object with name, axis and deg", err);
        if (result < 0)
            return result;
        bone->turn_count = i + 1;
        result = rig_fields_read(&bone->turn[i], turn_fields, &item, in, err);
        if (result >= 0)
            result = check_turn_name(bone, i, &item, err);
    }
    return result;
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

static void write_turns(json_t *to, const void *of, rig_writing *w)
{
    const rig_bone *bone = of;
    json_t *turns = json_array();
    const json_t *before = json_object_get(to, "turns");
    for (uint32_t i = 0; i < bone->turn_count; ++i) {
        const json_t *source = source_of_turn(before, bone, i);
        json_t *turn = json_is_object(source) ? json_deep_copy(source) : json_object();
        rig_fields_write(turn, turn_fields, &bone->turn[i], w);
        json_array_append_new(turns, turn);
    }
    rig_set(to, "turns", turns, w);
}

/* ---- ball: a spring ---- */

static const rig_field spring_fields[] = {
    {OF("tip", rig_spring, tip, FIELD_POINT)},
    {NUMBER("frequency_hz", rig_spring, frequency_hz, RIG_SPRING_LEAST_HZ, RIG_SPRING_MOST_HZ)},
    {NUMBER_OR("damping", rig_spring, damping, RIG_SPRING_LEAST_DAMPED, RIG_SPRING_MOST_DAMPED,
               FIELD_OPTIONAL, RIG_SPRING_DAMPING)},
    {NUMBER_OR("inertia", rig_spring, inertia, 0.0, 1.0, FIELD_OPTIONAL, 1.0)},
    {NUMBER_OR("gravity", rig_spring, gravity, 0.0, 1.0, FIELD_OPTIONAL, 0.0)},
    {NUMBER_OR("radius_mm", rig_spring, radius_mm, 0.0, 1e4, FIELD_OPTIONAL, 0.0)},
    {.key = NULL}};

static mrt_result read_spring(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig_bone *bone = out;
    json_node spring = json_node_member(at, "spring");
    if (!spring.value)
        return MRT_OK;
    bone->spring.damping = RIG_SPRING_DAMPING;
    bone->spring.inertia = 1.0;
    mrt_result result = json_node_object(&spring, "an object with tip and frequency_hz", err);
    if (result >= 0)
        result = rig_fields_read(&bone->spring, spring_fields, &spring, in, err);
    if (result < 0)
        return result;
    double arm_mm = vec3_length(vec3_sub(bone->spring.tip, bone->centre));
    if (!(arm_mm >= RIG_SPRING_LEAST_MM))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.tip: it is %.3g mm from the centre of the ball, so the part has no "
                         "length that can swing; place it in the middle of the loose part",
                         spring.path.text, arm_mm);
    return MRT_OK;
}

static void write_spring(json_t *to, const void *of, rig_writing *w)
{
    const rig_bone *bone = of;
    if (bone->spring.frequency_hz > 0.0)
        rig_fields_write(rig_set_object(to, "spring", w), spring_fields, &bone->spring, w);
    else
        json_object_del(to, "spring");
}

/* ---- bones of any kind ---- */

static const rig_field hinge_fields[] = {{OF("left", rig_bone, hinge_left, FIELD_POINT)},
                                         {OF("right", rig_bone, hinge_right, FIELD_POINT)},
                                         {.key = NULL}};
static const rig_field ball_fields[] = {
    {OF("centre", rig_bone, centre, FIELD_POINT)},
    {NUMBER_OR("radius_mm", rig_bone, radius_mm, 0.0, 1e6, FIELD_OPTIONAL, 0.0)},
    {.key = NULL}};

#define BONE_NAME         TEXT("name", rig_bone, name, RIG_NAME_MAX - 8, "a name like \"jaw\"")
#define BONE_PARENT       CUSTOM("parent", read_parent, write_parent)
#define LENGTH(field, mm) NUMBER_OR(#field, rig_bone, field, 0.0, 1e4, FIELD_OPTIONAL, mm)
static const rig_field bone_fields[][9] = {
    [BONE_FIXED] = {{BONE_NAME}, {BONE_PARENT}},
    [BONE_JAW] = {{BONE_NAME},
                  {BONE_PARENT},
                  {OBJECT("hinge", hinge_fields,
                          "an object {\"left\": [x,y,z], \"right\": [x,y,z]}", check_hinge)},
                  {.key = "open_deg",
                   .kind = FIELD_RANGE,
                   .use = FIELD_OPTIONAL,
                   AT(rig_bone, open_min_rad),
                   RANGE(-90.0, 90.0),
                   .usual = JAW_OPEN_RAD},
                  {LENGTH(lateral_mm, JAW_LATERAL_MM)},
                  {LENGTH(forward_mm, JAW_FORWARD_MM)},
                  {LENGTH(slide_mm, JAW_SLIDE_MM)},
                  {CUSTOM("incisor", read_incisor, write_incisor)}},
    [BONE_BALL] = {{BONE_NAME},
                   {BONE_PARENT},
                   {OBJECT("ball", ball_fields, "an object {\"centre\": [x,y,z]}", NULL)},
                   {CUSTOM("turns", read_turns, write_turns)},
                   {CUSTOM("spring", read_spring, write_spring)}}};

static mrt_result check_dofs(const rig *r, const json_node *last, error *err)
{
    uint32_t dof_count = 0, jaw_count = 0;
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        jaw_count += r->bone[i].kind == BONE_JAW;
        dof_count += r->bone[i].kind == BONE_JAW ? 3 : r->bone[i].turn_count;
    }
    dof_count += r->mouth.upper != NULL;
    if (jaw_count > 1)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: a second bone has a hinge; a face has only one jaw", last->path.text);
    if (dof_count > MRT_MAX_DOFS)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: the rig has %u degrees of freedom, but at most %d are supported",
                         last->path.text, dof_count, MRT_MAX_DOFS);
    return MRT_OK;
}

static mrt_result read_bone(rig *r, uint32_t index, const json_node *at, rig_reading *in,
                            error *err)
{
    rig_bone *bone = &r->bone[index];
    bool has_hinge = json_object_get(at->value, "hinge") != NULL;
    bool has_ball = json_object_get(at->value, "ball") != NULL;
    *bone = has_hinge ? rig_adult_jaw : (rig_bone){.kind = has_ball ? BONE_BALL : BONE_FIXED};
    bone->parent = RIG_NONE;
    if (has_hinge && has_ball)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: has both a hinge and a ball; a bone can have only one of them",
                         at->path.text);
    if (!has_ball && json_object_get(at->value, "spring"))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.spring: only a bone with a ball can swing; give it a \"ball\" at its "
                         "root and \"turns\" with its limits",
                         at->path.text);
    mrt_result result = rig_fields_read(bone, bone_fields[bone->kind], at, in, err);
    r->bone_count = index + 1; /* can be a parent of the bones that follow */
    return result < 0 ? result : check_dofs(r, at, err);
}

static void write_bone(json_t *to, const void *of, rig_writing *w)
{
    const rig_bone *bone = of;
    rig_fields_write(to, bone_fields[bone->kind], bone, w);
    for (rig_bone_kind kind = BONE_JAW; kind <= BONE_BALL; ++kind)
        for (const rig_field *f = &bone_fields[kind][2]; kind != bone->kind && f->key; ++f)
            json_object_del(to, f->key);
}

static mrt_result add_default_skull(rig *r, error *err)
{
    r->bone[0] = (rig_bone){.name = strdup("skull"), .parent = RIG_NONE};
    r->bone_count = 1;
    return r->bone[0].name ? MRT_OK : rig_no_memory(err);
}

rig_dof_unit rig_dof_unit_of(const rig *r, const char *name)
{
    if (r->mouth.upper && strcmp(name, RIG_LIPS_SEAL) == 0)
        return RIG_DOF_SHARE;
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

/* ---- regions ---- */

/* Names are for display only. A name that cannot be shown is dropped here, but kept in the
 * file. */
static mrt_result read_region_name(void *out, const json_node *at, rig_reading *in, error *err)
{
    (void)in;
    (void)err;
    rig_region *region = out;
    json_node name = json_node_member(at, "name");
    if (name.value && rig_json_text(&region->name, &name, "a name", RIG_NAME_MAX, NULL) < 0)
        region->name = NULL;
    return MRT_OK;
}

static void write_region_name(json_t *to, const void *of, rig_writing *w)
{
    const rig_region *region = of;
    json_node at = {to, {"$"}}, name = json_node_member(&at, "name");
    char *before = NULL;
    if (region->name)
        rig_set_text(to, "name", region->name, w);
    else if (name.value && rig_json_text(&before, &name, "a name", RIG_NAME_MAX, NULL) >= 0)
        json_object_del(to, "name");
    free(before);
}

static mrt_result check_region(const rig_region *region, const json_node *at, error *err)
{
    bool has_weight = !isnan(region->weight), has_mobility = !isnan(region->mobility);
    if (region->is_rigid && (has_weight || has_mobility))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: a rigid region cannot set \"weight\" or \"mobility\"; remove them",
                         at->path.text);
    if (!region->is_rigid && !has_weight && !has_mobility)
        return error_set(
            err, MRT_ERR_FORMAT,
            "%s: expected \"rigid\": true, \"weight\" or \"mobility\": this region sets nothing",
            at->path.text);
    if (region->bone == RIG_NONE && (region->is_rigid || has_weight))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.bone: expected the name of the bone that moves these vertices",
                         at->path.text);
    return MRT_OK;
}

static mrt_result read_region_select(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig_region *region = out;
    json_node select = json_node_member(at, "select");
    mrt_result result = check_region(region, at, err);
    return result < 0 ? result : read_select(&region->select, &select, in, err);
}

/* True if the text in the file means the same. So it keeps its form. */
static bool source_selects_the_same(const json_t *source, const json_t *select,
                                    const rig_writing *w)
{
    char *note = NULL;
    json_node node = {source, {"$"}};
    rig_select before = {0};
    rig_reading in = {.mm_per_unit = w->source_mm_per_unit, .note = &note};
    rig_writing same = {.mm_per_unit = w->source_mm_per_unit};
    json_t *text = NULL;
    if (source && read_select(&before, &node, &in, NULL) >= 0)
        text = select_to_json(&before, &same);
    bool is_same = text && json_equal(text, select);
    json_decref(text);
    rig_select_finish(&before);
    free(note);
    return is_same;
}

static void write_region_select(json_t *to, const void *of, rig_writing *w)
{
    const rig_region *region = of;
    if (region->select.kind == SELECT_NOTHING)
        return;
    json_t *select = select_to_json(&region->select, w);
    bool same_unit =
        !(w->source_mm_per_unit < w->mm_per_unit) && !(w->source_mm_per_unit > w->mm_per_unit);
    if (!same_unit || !source_selects_the_same(json_object_get(to, "select"), select, w))
        rig_set(to, "select", json_incref(select), w);
    json_decref(select);
}

#define SHARE(field) NUMBER_OR(#field, rig_region, field, 0.0, 1.0, FIELD_OMITTED, (double)NAN)
static const rig_field region_fields[] = {
    {CUSTOM("name", read_region_name, write_region_name)},
    {.key = "bone", .kind = FIELD_BONE, .use = FIELD_OMITTED, AT(rig_region, bone)},
    {.key = "rigid", .kind = FIELD_FLAG, .use = FIELD_OPTIONAL, AT(rig_region, is_rigid)},
    {SHARE(weight)},
    {SHARE(mobility)},
    {CUSTOM("select", read_region_select, write_region_select)},
    {.key = NULL}};

static mrt_result read_region(rig *r, uint32_t index, const json_node *at, rig_reading *in,
                              error *err)
{
    r->region[index] = (rig_region){
        .bone = RIG_NONE, .source = index + 1, .weight = (double)NAN, .mobility = (double)NAN};
    return rig_fields_read(&r->region[index], region_fields, at, in, err);
}

/* ---- contacts ---- */

static void write_mirror(json_t *to, const void *of, rig_writing *w)
{
    const rig_contact *contact = of;
    if (contact->mirror != RIG_NONE)
        rig_set_text(to, "mirror", w->r->contact[contact->mirror].name, w);
    else
        json_object_del(to, "mirror");
}

static const rig_field contact_fields[] = {
    {TEXT("name", rig_contact, name, RIG_NAME_MAX, "a name like \"chin\"")},
    {.key = "bone", .kind = FIELD_BONE, .use = FIELD_OPTIONAL, AT(rig_contact, bone)},
    {OF("vertex", rig_contact, vertex, FIELD_VERTEX)},
    {CUSTOM("mirror", NULL, write_mirror)}, /* find_mirror reads it */
    {.key = NULL}};

static mrt_result read_contact(rig *r, uint32_t index, const json_node *at, rig_reading *in,
                               error *err)
{
    r->contact[index] = (rig_contact){.bone = RIG_NONE, .mirror = RIG_NONE, .source = index + 1};
    return rig_fields_read(&r->contact[index], contact_fields, at, in, err);
}

static mrt_result find_mirror(rig *r, uint32_t index, const json_node *contact, error *err)
{
    json_node at = json_node_member(contact, "mirror");
    if (!at.value)
        return MRT_OK;
    const char *name = json_string_value(at.value);
    if (!name)
        return json_node_unexpected(err, &at, "the name of a contact");
    r->contact[index].mirror = rig_find_contact(r, name);
    if (r->contact[index].mirror != RIG_NONE)
        return MRT_OK;
    json_words word = json_shown(name);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: the rig has no contact \"%s\"; add it to $.contacts or remove \"mirror\"",
                     at.path.text, word.text);
}

static mrt_result check_mirrors(const rig *r, error *err)
{
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        uint32_t other = r->contact[i].mirror;
        if (other == RIG_NONE || r->contact[other].mirror == i)
            continue;
        json_path path = rig_entry_path(r, RIG_CONTACTS, i);
        json_path other_path = rig_entry_path(r, RIG_CONTACTS, other);
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.mirror: \"%s\" does not point back; write \"mirror\": \"%s\" at %s",
                         path.text, r->contact[other].name, r->contact[i].name, other_path.text);
    }
    return MRT_OK;
}

/* ---- skull proxy ---- */

static const rig_field shape_fields[] = {{OF("centre", rig_proxy, centre, FIELD_POINT)},
                                         {OF("radii", rig_proxy, radii, FIELD_RADII)},
                                         {OF("bone", rig_proxy, bone, FIELD_BONE)},
                                         {.key = NULL}};
static const char shape_expected[] = "an object with centre, radii and bone";
static const rig_field proxy_fields[] = {
    [PROXY_ELLIPSOID] = {OBJECT("ellipsoid", shape_fields, shape_expected, NULL)},
    [PROXY_TEETH] = {OBJECT("teeth", shape_fields, shape_expected, NULL)},
    {.key = NULL}};

static mrt_result read_proxy(rig *r, uint32_t index, const json_node *at, rig_reading *in,
                             error *err)
{
    rig_proxy *proxy = &r->proxy[index];
    bool has_teeth = json_object_get(at->value, "teeth") != NULL;
    *proxy = (rig_proxy){.kind = has_teeth ? PROXY_TEETH : PROXY_ELLIPSOID, .source = index + 1};
    if (has_teeth && json_object_get(at->value, "ellipsoid"))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: has both \"ellipsoid\" and \"teeth\"; split it into two entries",
                         at->path.text);
    rig_fields_note_unknown(proxy_fields, at, in);
    return rig_field_read(proxy, &proxy_fields[proxy->kind], at, in, err);
}

static void write_proxy(json_t *to, const void *of, rig_writing *w)
{
    const rig_proxy *proxy = of;
    json_object_del(to,
                    proxy_fields[proxy->kind == PROXY_TEETH ? PROXY_ELLIPSOID : PROXY_TEETH].key);
    rig_field_write(to, &proxy_fields[proxy->kind], proxy, w);
}

/* ---- poses ---- */

enum { PULLS_MAX = 1024 };

/* Finds the contact `name`; `at` is the JSON value or key that names it. */
static mrt_result find_contact(uint32_t *out, const rig *r, const char *name, const json_node *at,
                               error *err)
{
    *out = rig_find_contact(r, name);
    if (*out != RIG_NONE)
        return MRT_OK;
    json_words word = json_shown(name);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: the rig has no contact \"%s\"; add it to $.contacts or remove it here",
                     at->path.text, word.text);
}

static mrt_result add_dof(rig_pose *pose, const rig *r, const char *name, const json_node *at,
                          error *err)
{
    rig_dof_unit unit = rig_dof_unit_of(r, name);
    if (unit == RIG_DOF_UNKNOWN)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: unknown degree of freedom; a hinge has open, lateral and "
                         "forward (\"jaw.open\"), a ball has its turns (\"eye.l.yaw\"), a mouth "
                         "has " RIG_LIPS_SEAL,
                         at->path.text);
    double value = 0.0;
    mrt_result result = json_node_number(&value, at, -1e4, 1e4, err);
    if (result < 0)
        return result;
    uint32_t index = pose->dof_count;
    pose->dof_name[index] = strdup(name);
    pose->dof_value[index] = unit == RIG_DOF_RAD ? value * radian_per_degree : value;
    pose->dof_count = index + 1;
    return pose->dof_name[index] ? MRT_OK : rig_no_memory(err);
}

/* Opens an optional object whose keys are names. The value stays NULL if it is absent. */
static mrt_result open_names(json_node *out, const json_node *of, const char *key,
                             const char *expected, size_t most, error *err)
{
    *out = json_node_member(of, key);
    mrt_result result = out->value ? json_node_object(out, expected, err) : MRT_OK;
    if (result >= 0 && json_object_size(out->value) > most)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: has more than %zu entries; remove some",
                         out->path.text, most);
    return result;
}

static mrt_result read_dofs(void *out, const json_node *of, rig_reading *in, error *err)
{
    rig_pose *pose = out;
    json_node dofs;
    mrt_result result =
        open_names(&dofs, of, "dofs", "an object like {\"jaw.open\": 20}", MRT_MAX_DOFS, err);
    if (result < 0 || !dofs.value)
        return result;
    json_t *value = (json_t *)(uintptr_t)dofs.value;
    pose->dof_name = calloc(json_object_size(value) + 1, sizeof *pose->dof_name);
    pose->dof_value = calloc(json_object_size(value) + 1, sizeof *pose->dof_value);
    if (!pose->dof_name || !pose->dof_value)
        return rig_no_memory(err);
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        json_node member = json_node_member(&dofs, json_object_iter_key(at));
        result = add_dof(pose, in->r, json_object_iter_key(at), &member, err);
    }
    return result;
}

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

static void write_dofs(json_t *to, const void *of, rig_writing *w)
{
    const rig_pose *pose = of;
    if (pose->dof_count == 0 && !json_object_get(to, "dofs"))
        return;
    json_t *dofs = rig_set_object(to, "dofs", w);
    keep_only(dofs, (const char *const *)pose->dof_name, pose->dof_count);
    for (uint32_t i = 0; i < pose->dof_count; ++i) {
        const char *name = pose->dof_name[i];
        bool is_angle = rig_dof_unit_of(w->r, name) == RIG_DOF_RAD;
        rig_set_number(dofs, name, pose->dof_value[i], is_angle ? radian_per_degree : 1.0,
                       (double)NAN, w);
    }
}

static mrt_result read_pulls(void *out, const json_node *of, rig_reading *in, error *err)
{
    rig_pose *pose = out;
    json_node pulls;
    mrt_result result =
        open_names(&pulls, of, "pulls", "an object like {\"chin\": [0, -4, 1]}", PULLS_MAX, err);
    if (result < 0 || !pulls.value)
        return result;
    json_t *value = (json_t *)(uintptr_t)pulls.value;
    pose->pull_contact = calloc(json_object_size(value) + 1, sizeof *pose->pull_contact);
    pose->pull_mm = calloc(json_object_size(value) + 1, sizeof *pose->pull_mm);
    if (!pose->pull_contact || !pose->pull_mm)
        return rig_no_memory(err);
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        const char *name = json_object_iter_key(at);
        json_node member = json_node_member(&pulls, name);
        uint32_t index = pose->pull_count++;
        result = find_contact(&pose->pull_contact[index], in->r, name, &member, err);
        if (result >= 0)
            result = rig_json_point(&pose->pull_mm[index], &member, in->mm_per_unit, err);
    }
    return result;
}

static void write_pulls(json_t *to, const void *of, rig_writing *w)
{
    const rig_pose *pose = of;
    if (pose->pull_count == 0 && !json_object_get(to, "pulls"))
        return;
    const char **name = calloc(pose->pull_count + 1u, sizeof *name);
    w->failed |= !name;
    if (!name)
        return;
    json_t *pulls = rig_set_object(to, "pulls", w);
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        name[i] = w->r->contact[pose->pull_contact[i]].name;
    keep_only(pulls, name, pose->pull_count);
    for (uint32_t i = 0; i < pose->pull_count; ++i)
        rig_set_point(pulls, name[i], pose->pull_mm[i], w);
    free(name);
}

static const char *part_word(int part)
{
    return rig_pose_part_name[part];
}

static const rig_field pose_fields[] = {
    {TEXT("name", rig_pose, name, RIG_NAME_MAX, "a name")},
    {WORD_OR("part", rig_pose, part, POSE_MOUTH, POSE_UPPER, part_word, FIELD_OMITTED, POSE_WHOLE,
             "\"mouth\" or \"upper\" (without it: the whole face)")},
    {CUSTOM("dofs", read_dofs, write_dofs)},
    {CUSTOM("pulls", read_pulls, write_pulls)},
    {.key = NULL}};

/* Charges the budget for the search of each name among all contacts. */
static mrt_result charge_names(const rig_reading *in, uint32_t name_count, error *err)
{
    return budget_spend_work(&in->document->budget, (uint64_t)name_count * in->r->contact_count,
                             err);
}

static mrt_result read_pose(rig *r, uint32_t index, const json_node *at, rig_reading *in,
                            error *err)
{
    mrt_result result = rig_fields_read(&r->pose[index], pose_fields, at, in, err);
    return result < 0 ? result : charge_names(in, r->pose[index].pull_count, err);
}

/* ---- contact sets ---- */

static mrt_result add_to_set(rig_contact_set *set, const rig *r, const json_node *item, error *err)
{
    const char *name = json_string_value(item->value);
    if (!name)
        return json_node_unexpected(err, item, "the name of a contact");
    uint32_t contact = RIG_NONE;
    mrt_result result = find_contact(&contact, r, name, item, err);
    for (uint32_t i = 0; result >= 0 && i < set->contact_count; ++i)
        if (set->contact[i] == contact)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: \"%s\" is already in this set; remove one of them",
                             item->path.text, r->contact[contact].name);
    if (result >= 0)
        set->contact[set->contact_count++] = contact;
    return result;
}

static mrt_result read_set(rig *r, uint32_t index, const json_node *at, rig_reading *in, error *err)
{
    rig_contact_set *set = &r->contact_set[index];
    set->name = strdup(in->document->entry[RIG_SETS][index].name);
    if (!set->name)
        return rig_no_memory(err);
    mrt_result result = json_node_array(at, "a list of contacts", PULLS_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(at->value);
    set->contact = calloc(count + 1, sizeof *set->contact);
    if (!set->contact)
        return rig_no_memory(err);
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node item = json_node_item(at, i);
        result = add_to_set(set, r, &item, err);
    }
    return result < 0 ? result : charge_names(in, set->contact_count, err);
}

static json_t *set_to_json(const rig *r, uint32_t index)
{
    const rig_contact_set *set = &r->contact_set[index];
    json_t *out = json_array();
    for (uint32_t i = 0; i < set->contact_count; ++i)
        json_array_append_new(out, json_string(r->contact[set->contact[i]].name));
    return out;
}

/* ---- all entries ---- */

typedef struct entry_kind {
    mrt_result (*read)(rig *r, uint32_t index, const json_node *at, rig_reading *in, error *err);
    const rig_field *fields;                                      /* to write; NULL: with `write` */
    void (*write)(json_t *to, const void *entry, rig_writing *w); /* NULL for a set: set_to_json */
    size_t array, count, item_size;                               /* offsets in the rig */
} entry_kind;

#define ARRAY(field) offsetof(rig, field), offsetof(rig, field##_count), sizeof *((rig *)0)->field
static const entry_kind entry_kinds[RIG_SECTIONS] = {
    [RIG_BONES] = {read_bone, NULL, write_bone, ARRAY(bone)},
    [RIG_REGIONS] = {read_region, region_fields, NULL, ARRAY(region)},
    [RIG_CONTACTS] = {read_contact, contact_fields, NULL, ARRAY(contact)},
    [RIG_PROXIES] = {read_proxy, NULL, write_proxy, ARRAY(proxy)},
    [RIG_POSES] = {read_pose, pose_fields, NULL, ARRAY(pose)},
    [RIG_SETS] = {read_set, NULL, NULL, ARRAY(contact_set)}};

static mrt_result read_section(rig *r, rig_section section, rig_reading *in, error *err)
{
    const rig_document *d = in->document;
    const entry_kind *kind = &entry_kinds[section];
    uint32_t *count = (uint32_t *)(void *)((char *)r + kind->count);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[section]; ++i) {
        const rig_entry *entry = &d->entry[section][i];
        in->mm_per_unit = d->file[entry->file].mm_per_unit;
        result = kind->read(r, i, &entry->node, in, err);
        *count = i + 1;
    }
    return result;
}

static mrt_result allocate(rig *r, const rig_document *d, error *err)
{
    bool has_all = true;
    for (int section = 0; section < RIG_SECTIONS; ++section) {
        uint32_t count = section == RIG_BONES ? RIG_BONES_MAX : d->entry_count[section] + 1u;
        void *array = calloc(count, entry_kinds[section].item_size);
        memcpy((char *)r + entry_kinds[section].array, &array, sizeof array);
        has_all = has_all && array;
    }
    return has_all ? MRT_OK : rig_no_memory(err);
}

static mrt_result read_mirrors(rig *r, const rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < r->contact_count; ++i)
        result = find_mirror(r, i, &d->entry[RIG_CONTACTS][i].node, err);
    return result < 0 ? result : check_mirrors(r, err);
}

static mrt_result read_sections(void *out, const json_node *at, rig_reading *in, error *err)
{
    (void)at;
    rig *r = out;
    const rig_document *d = in->document;
    mrt_result result = allocate(r, d, err);
    if (result >= 0 && d->entry_count[RIG_BONES] == 0)
        result = add_default_skull(r, err);
    for (int section = 0; result >= 0 && section < RIG_SECTIONS; ++section) {
        result = read_section(r, (rig_section)section, in, err);
        if (result >= 0 && section == RIG_CONTACTS)
            result = read_mirrors(r, d, err);
    }
    return result;
}

/* Returns entry `index` of a section as JSON: a copy of its source entry in which only the
 * differences are changed, or a new one. NULL without memory. */
static json_t *entry_to_json(rig_section section, uint32_t index, rig_writing *w)
{
    if (section == RIG_SETS)
        return set_to_json(w->r, index);
    const rig_document *d = w->r->document;
    const rig_entry *source = rig_source(w->r, section, index);
    w->source_mm_per_unit = source ? d->file[source->file].mm_per_unit : w->mm_per_unit;
    json_t *out = source ? json_deep_copy(source->node.value) : json_object();
    const entry_kind *kind = &entry_kinds[section];
    const char *array;
    memcpy(&array, (const char *)w->r + kind->array, sizeof array);
    if (kind->fields)
        rig_fields_write(out, kind->fields, array + index * kind->item_size, w);
    else
        kind->write(out, array + index * kind->item_size, w);
    return out;
}

static void write_section(json_t *root, rig_section section, rig_writing *w)
{
    const char *key = rig_section_key[section];
    json_t *all = section == RIG_SETS ? json_object() : json_array();
    uint32_t count;
    memcpy(&count, (const char *)w->r + entry_kinds[section].count, sizeof count);
    for (uint32_t i = 0; i < count; ++i) {
        json_t *entry = entry_to_json(section, i, w);
        if (section == RIG_SETS)
            rig_set(all, w->r->contact_set[i].name, entry, w);
        else
            w->failed |= json_array_append_new(all, entry) != 0;
    }
    if (count > 0 || json_object_get(root, key))
        rig_set(root, key, all, w);
    else
        json_decref(all);
}

static void write_sections(json_t *to, const void *of, rig_writing *w)
{
    (void)of;
    for (int section = 0; section < RIG_SECTIONS; ++section)
        write_section(to, (rig_section)section, w);
}

/* ---- name and mesh ---- */

enum { MESH_NAME_MAX = 1024, HASH_DIGITS = 16 };

/* Derives the name from the file: "rigs/moai/moai.rig.json" becomes "moai". */
static char *name_from_path(const char *path)
{
    const char *slash = strrchr(path, '/');
    const char *base = slash ? slash + 1 : path;
    size_t length = strcspn(base, ".");
    char *name = malloc(length + 1);
    if (!name)
        return NULL;
    memcpy(name, base, length);
    name[length] = '\0';
    text_make_printable(name);
    return name;
}

static mrt_result read_name(void *out, const json_node *at, rig_reading *in, error *err)
{
    rig *r = out;
    json_node name = rig_field_member(at, "name", in);
    if (name.value)
        return rig_json_text(&r->name, &name, "a name", RIG_NAME_MAX, err);
    r->name = name_from_path(r->path);
    return r->name ? MRT_OK : rig_no_memory(err);
}

static mrt_result check_name(const rig *r, error *err)
{
    char *folder = file_directory(r->path);
    mrt_result result = folder ? file_check_below(folder, r->mesh_path, err) : rig_no_memory(err);
    free(folder);
    return result;
}

static mrt_result read_mesh_path(void *out, const json_node *at, rig_reading *in, error *err)
{
    (void)at;
    rig *r = out;
    const rig_document *d = in->document;
    uint32_t file;
    char *name = NULL;
    json_node named = rig_document_scalar(d, "mesh", &file);
    if (!named.value)
        return error_set(err, MRT_ERR_FORMAT,
                         "$.mesh: expected the file name of the mesh, found nothing; write "
                         "\"mesh\": \"head.glb\"");
    mrt_result result =
        rig_json_text(&name, &named, "the file name of the mesh", MESH_NAME_MAX, err);
    if (result < 0)
        return result;
    char *directory = file_directory(d->file[file].path);
    size_t size = strlen(name) + (directory ? strlen(directory) : 0) + 1;
    r->mesh_path = directory ? malloc(size) : NULL;
    if (r->mesh_path)
        (void)snprintf(r->mesh_path, size, "%s%s", name[0] == '/' ? "" : directory, name);
    free(directory);
    free(name);
    if (!r->mesh_path)
        return rig_no_memory(err);
    if (!d->is_trusted)
        result = check_name(r, err);
    if (result < 0)
        error_prefix(err, named.path.text);
    return result;
}

static mrt_result read_hash(void *out, const json_node *at, rig_reading *in, error *err)
{
    json_node hash = rig_field_member(at, "mesh_hash", in);
    const char *text = json_string_value(hash.value);
    if (!hash.value)
        return MRT_OK;
    if (!text || strlen(text) != HASH_DIGITS || strspn(text, "0123456789abcdef") != HASH_DIGITS)
        return json_node_unexpected(err, &hash, "16 digits 0-9a-f, as written by marotte rig new");
    ((rig *)out)->mesh_hash = strtoull(text, NULL, 16);
    return MRT_OK;
}

static void write_hash(json_t *to, const void *of, rig_writing *w)
{
    const rig *r = of;
    char hash[HASH_DIGITS + 1];
    (void)snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->mesh_hash);
    if (r->mesh_hash != 0)
        rig_set_text(to, "mesh_hash", hash, w);
}

static mrt_result read_axis(mesh_axis *out, const json_node *at, const char *key,
                            const rig_reading *in, error *err)
{
    json_node node = rig_field_member(at, key, in);
    const char *word = json_string_value(node.value);
    if (!node.value || (word && mesh_axis_parse(out, word)))
        return MRT_OK;
    return json_node_unexpected(err, &node, "\"x\", \"y\", \"z\", \"-x\", \"-y\" or \"-z\"");
}

/* Reads mesh_unit, mesh_up and mesh_forward. */
static mrt_result read_frame(void *out, const json_node *at, rig_reading *in, error *err)
{
    mesh_frame *frame = &((rig *)out)->frame;
    json_node unit = rig_field_member(at, "mesh_unit", in);
    const char *word = json_string_value(unit.value);
    if (json_is_number(unit.value))
        frame->mm_per_unit = json_number_value(unit.value);
    if (unit.value && !(word ? mesh_unit_parse(&frame->mm_per_unit, word)
                             : frame->mm_per_unit >= 1e-9 && frame->mm_per_unit <= 1e9))
        return json_node_unexpected(err, &unit, "\"mm\", \"cm\", \"m\" or a number of mm");
    mrt_result result = read_axis(&frame->up, at, "mesh_up", in, err);
    return result < 0 ? result : read_axis(&frame->forward, at, "mesh_forward", in, err);
}

static void write_frame(json_t *to, const void *of, rig_writing *w)
{
    const mesh_frame *frame = &((const rig *)of)->frame;
    if (frame->mm_per_unit > 0.0)
        rig_set(to, "mesh_unit", rig_number_to_json(frame->mm_per_unit), w);
    if (frame->up != MESH_AXIS_AUTO)
        rig_set_text(to, "mesh_up", mesh_axis_name(frame->up), w);
    if (frame->forward != MESH_AXIS_AUTO)
        rig_set_text(to, "mesh_forward", mesh_axis_name(frame->forward), w);
}

/* ---- mouth ---- */

static const char *seal_word(int from)
{
    return from == SEAL_FROM_MIDDLE ? "middle" : "corners";
}

/* Of the rims only the numbers are checked here. Whether the vertices form rims is checked on the
 * mesh (bind_lips). */
#define RIM(rim)                                                                                   \
    VERTICES(#rim, FIELD_NEEDED, rig_mouth, rim, RIG_RIM_LEAST, RIG_RIM_MOST,                      \
             "a list of 3 vertices or more, from the right corner of the mouth to the left one")
static const rig_field mouth_fields[] = {
    {RIM(upper)},
    {RIM(lower)},
    {NUMBER_OR("upper_share", rig_mouth, upper_share, 0.0, 1.0, FIELD_OPTIONAL, RIG_UPPER_SHARE)},
    {NUMBER_OR("stickiness_mm", rig_mouth, stickiness_mm, 0.0, RIG_STICKINESS_MOST_MM,
               FIELD_OMITTED, 0.0)},
    {WORD_OR("seal_from", rig_mouth, seal_from, SEAL_FROM_CORNERS, SEAL_FROM_MIDDLE, seal_word,
             FIELD_OMITTED, SEAL_FROM_CORNERS, "\"corners\" or \"middle\"")},
    {.key = NULL}};

/* An invalid mouth is still declared, but without rims. So poses that name its seal stay valid,
 * and the face can be performed. */
static mrt_result read_mouth(void *to, const json_node *at, rig_reading *in, error *err)
{
    rig_mouth *out = &((rig *)to)->mouth;
    json_node mouth = rig_field_member(at, "mouth", in);
    error why = {""};
    if (!mouth.value)
        return MRT_OK;
    out->upper_share = RIG_UPPER_SHARE;
    mrt_result result = json_node_object(&mouth, "an object with \"upper\" and \"lower\"", &why);
    if (result >= 0)
        result = rig_fields_read(out, mouth_fields, &mouth, in, &why);
    if (result >= 0)
        return MRT_OK;
    free(out->upper);
    free(out->lower);
    *out = (rig_mouth){.upper = calloc(1, sizeof *out->upper), .fault = strdup(why.text)};
    return result != MRT_ERR_MEMORY && out->upper && out->fault ? MRT_OK : rig_no_memory(err);
}

static void write_mouth(json_t *to, const void *of, rig_writing *w)
{
    const rig_mouth *mouth = &((const rig *)of)->mouth;
    if (!mouth->upper)
        json_object_del(to, "mouth");
    else if (!mouth->fault) /* else the text of the file stays */
        rig_fields_write(rig_set_object(to, "mouth", w), mouth_fields, mouth, w);
}

/* ---- solver ---- */

static const char *kernel_word(int kernel)
{
    return csrbf_kernel_name((csrbf_kernel)kernel);
}

static const char *polynomial_word(int polynomial)
{
    return csrbf_polynomial_name((csrbf_polynomial)polynomial);
}

static const rig_field solver_fields[] = {
    {WORD_OR("kernel", csrbf_settings, kernel, CSRBF_WENDLAND_C2, CSRBF_WENDLAND_C6, kernel_word,
             FIELD_OPTIONAL, CSRBF_WENDLAND_C2,
             "one of wendland_c2, wendland_c0, wendland_c4, wendland_c6")},
    {WORD_OR("polynomial", csrbf_settings, polynomial, CSRBF_NONE, CSRBF_WINDOWED, polynomial_word,
             FIELD_OPTIONAL, CSRBF_NONE, "one of none, constant, linear, windowed")},
    {NUMBER_OR("radius_mm", csrbf_settings, radius, 0.01, 1e6, FIELD_OPTIONAL, 0.0)},
    {NUMBER_OR("ridge", csrbf_settings, ridge, 0.0, 1e3, FIELD_OPTIONAL, 0.0)},
    {.key = NULL}};

/* ---- the whole file ---- */

/* In the order of a new file. */
const rig_field rig_root_fields[] = {
    {ELSEWHERE("marotte_rig")},
    {ELSEWHERE("include")},
    {ELSEWHERE("unit")},
    {CUSTOM("name", read_name, NULL)},
    {CUSTOM("mesh", read_mesh_path, NULL)},
    {.key = "mesh_vertices",
     .kind = FIELD_VERTEX,
     .use = FIELD_OPTIONAL,
     AT(rig, mesh_vertex_count)},
    {CUSTOM("mesh_hash", read_hash, write_hash)},
    {CUSTOM("mesh_unit", read_frame, write_frame)},
    {ELSEWHERE("mesh_up")},
    {ELSEWHERE("mesh_forward")},
    {VERTICES("cut_mouth", FIELD_OPTIONAL, rig, cut_mouth, 4, MESH_CUT_MAX,
              "a list of 4 vertices or more, as written by marotte rig new --cut-mouth")},
    {CUSTOM("mouth", read_mouth, write_mouth)},
    {CUSTOM("bones", NULL, write_sections)}, /* and the other sections */
    {ELSEWHERE("contacts")},
    {ELSEWHERE("skull_proxy")},
    {ELSEWHERE("poses")},
    {ELSEWHERE("contact_sets")},
    {CUSTOM("paints", NULL, rig_write_paints)},
    {.key = "solver",
     .kind = FIELD_OBJECT,
     .use = FIELD_OPTIONAL,
     AT(rig, solver),
     .inner = solver_fields,
     .expected = "an object with kernel and radius_mm"},
    {NUMBER_OR("shapes", rig, shapes, 0.0, 1.0, FIELD_OPTIONAL, 1.0)},
    {NUMBER_OR("springs", rig, springs, 0.0, 1.0, FIELD_OPTIONAL, 1.0)},
    {CUSTOM("regions", read_sections, NULL)}, /* and the other sections, which need the mouth */
    {.key = NULL}};

/* Takes the document. On error destroys the rig. */
static mrt_result finish_reading(rig *out, rig_document *d, const char *path, error *err)
{
    rig_reading in = {.r = out, .document = d, .note = &out->note};
    out->document = d;
    out->path = strdup(path);
    out->mm_per_unit = d->file[d->file_count - 1].mm_per_unit;
    out->shapes = 1.0;
    out->springs = 1.0;
    for (uint32_t i = 0; i < d->file_count; ++i) {
        json_node root = {d->file[i].root, d->file[i].root_path};
        rig_fields_note_unknown(rig_root_fields, &root, &in);
    }
    mrt_result result =
        out->path ? rig_fields_read(out, rig_root_fields, NULL, &in, err) : rig_no_memory(err);
    if (result < 0)
        rig_destroy(out);
    return result;
}

static mrt_result read_within(rig *out, const char *path, const char *folder, error *err)
{
    rig_document *d = NULL;
    mrt_result result = rig_document_read(&d, path, folder, err);
    if (result >= 0)
        result = finish_reading(out, d, path, err);
    if (result < 0 && err && strncmp(err->text, path, strlen(path)) != 0)
        error_prefix(err, path);
    return result;
}

mrt_result rig_read(rig *out, const char *path, error *err)
{
    *out = (rig){0};
    char *folder = file_directory(path);
    if (!folder)
        return rig_no_memory(err);
    mrt_result result = read_within(out, path, folder, err);
    free(folder);
    return result;
}

mrt_result rig_read_trusted(rig *out, const char *path, error *err)
{
    *out = (rig){0};
    return read_within(out, path, NULL, err);
}

mrt_result rig_parse(rig *out, const void *data, size_t size, const char *path, error *err)
{
    *out = (rig){0};
    rig_document *d = NULL;
    mrt_result result = rig_document_parse(&d, data, size, path, err);
    if (result >= 0)
        result = finish_reading(out, d, path, err);
    if (result < 0)
        error_prefix(err, path);
    return result;
}
