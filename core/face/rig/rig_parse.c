#include "face/rig/rig_document.h"

#include "base/angle.h"
#include "base/file.h"
#include "base/text.h"
#include "mesh/cut.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- selectors ---- */

typedef struct selecting {
    double mm_per_unit; /* unit of the file with the selector */
    char **note;
    uint32_t depth;               /* nesting of the current selector; limited */
    uint32_t node_count;          /* of all selectors so far; limited */
    const rig_document *document; /* source of the paints; NULL: only their names are read */
    budget *budget;
} selecting;

static mrt_result parse_select(rig_select *out, const json_node *at, selecting *s, error *err);

enum {
    DEPTH_MAX = 12,
    NODES_MAX = 4096,
    CHILDREN_MAX = 256,
    RANGES_MAX = INT32_MAX,
    GROUP_MAX = 255
};

static const rig_select_words words[] = {[SELECT_VERTICES] = {"vertices", NULL, NULL},
                                         [SELECT_GROUP] = {"group", NULL, NULL},
                                         [SELECT_ATTRIBUTE] = {"attribute", NULL, NULL},
                                         [SELECT_BOX] = {"box", "low", "high"},
                                         [SELECT_ELLIPSOID] = {"ellipsoid", "centre", "radii"},
                                         [SELECT_HALF_SPACE] = {"half_space", "point", "normal"},
                                         [SELECT_WITHIN] = {"within", NULL, NULL},
                                         [SELECT_ALL] = {"all", NULL, NULL},
                                         [SELECT_ANY] = {"any", NULL, NULL},
                                         [SELECT_NOT] = {"not", NULL, NULL},
                                         [SELECT_PAINTED] = {"painted", NULL, NULL},
                                         [SELECT_PIECE] = {"piece", NULL, NULL},
                                         [SELECT_PIECES_INSIDE] = {"pieces_inside", NULL, NULL},
                                         [SELECT_JOINT] = {"joint", NULL, NULL}};
enum { KIND_COUNT = sizeof words / sizeof *words };
static const char kind_list[] = "one of vertices, group, attribute, box, ellipsoid, half_space, "
                                "within, all, any, not, painted, piece, pieces_inside, joint";

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the rig");
}

const rig_select_words *rig_select_words_of(rig_select_kind kind)
{
    return &words[kind];
}

/* ---- vertices ---- */

static mrt_result parse_range(uint32_t *first, uint32_t *last, const json_node *at, error *err)
{
    if (!json_is_string(at->value)) {
        mrt_result result = rig_json_index(first, at, err);
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

static mrt_result parse_vertices(rig_select *out, const json_node *at, error *err)
{
    mrt_result result =
        json_node_array(at, "a list of vertices like [204, \"120-180\"]", RANGES_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(at->value);
    out->first = calloc(count + 1, sizeof *out->first);
    out->last = calloc(count + 1, sizeof *out->last);
    if (!out->first || !out->last)
        return no_memory(err);
    out->range_count = (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node item = json_node_item(at, i);
        result = parse_range(&out->first[i], &out->last[i], &item, err);
    }
    return result;
}

/* ---- shapes ---- */

static mrt_result parse_two_points(rig_select *out, const json_node *at, const selecting *s,
                                   error *err)
{
    const rig_select_words *word = &words[out->kind];
    mrt_result result = json_node_object(at, "an object", err);
    if (result < 0)
        return result;
    json_node a = json_node_member(at, word->first), b = json_node_member(at, word->second);
    const char *const known[] = {word->first, word->second, NULL};
    rig_json_note_unknown(s->note, at, known);
    result = rig_json_point(&out->a, &a, s->mm_per_unit, err);
    double scale = out->kind == SELECT_HALF_SPACE ? 1.0 : s->mm_per_unit;
    return result < 0 ? result : rig_json_point(&out->b, &b, scale, err);
}

static mrt_result parse_box(rig_select *out, const json_node *at, const selecting *s, error *err)
{
    mrt_result result = parse_two_points(out, at, s, err);
    if (result < 0)
        return result;
    if (out->a.x > out->b.x || out->a.y > out->b.y || out->a.z > out->b.z)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: \"low\" must not exceed \"high\" in x, y or z; exchange them",
                         at->path.text);
    return MRT_OK;
}

static mrt_result parse_ellipsoid(rig_select *out, const json_node *at, const selecting *s,
                                  error *err)
{
    mrt_result result = parse_two_points(out, at, s, err);
    if (result < 0)
        return result;
    if (!(out->b.x > 0.0 && out->b.y > 0.0 && out->b.z > 0.0))
        return error_set(err, MRT_ERR_FORMAT, "%s.radii: expected three radii greater than 0",
                         at->path.text);
    return MRT_OK;
}

static mrt_result parse_half_space(rig_select *out, const json_node *at, const selecting *s,
                                   error *err)
{
    mrt_result result = parse_two_points(out, at, s, err);
    if (result < 0)
        return result;
    if (!(vec3_length(out->b) > 1e-9))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s.normal: expected a direction, found a vector of length 0",
                         at->path.text);
    return MRT_OK;
}

static mrt_result parse_within(rig_select *out, const json_node *at, const selecting *s, error *err)
{
    static const char *const known[] = {"mm", "of", NULL};
    mrt_result result = json_node_object(at, "an object like {\"mm\": 12, \"of\": 4275}", err);
    if (result < 0)
        return result;
    json_node mm = json_node_member(at, "mm"), of = json_node_member(at, "of");
    rig_json_note_unknown(s->note, at, known);
    result = json_node_number(&out->within_mm, &mm, 0.0, 1e6, err);
    return result < 0 ? result : rig_json_index(&out->vertex, &of, err);
}

/* ---- combined ---- */

static mrt_result parse_children(rig_select *out, const json_node *at, selecting *s, error *err)
{
    mrt_result result = json_node_array(at, "a list of selectors", CHILDREN_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(at->value);
    if (count == 0)
        return json_node_unexpected(err, at, "at least one selector");
    out->child = calloc(count, sizeof *out->child);
    if (!out->child)
        return no_memory(err);
    out->child_count = (uint32_t)count;
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node item = json_node_item(at, i);
        result = parse_select(&out->child[i], &item, s, err);
    }
    return result;
}

static mrt_result parse_inner(rig_select *out, const json_node *at, selecting *s, error *err)
{
    out->child = calloc(1, sizeof *out->child);
    if (!out->child)
        return no_memory(err);
    out->child_count = 1;
    return parse_select(&out->child[0], at, s, err);
}

/* ---- painted ---- */

static mrt_result parse_painted(rig_select *out, const json_node *at, selecting *s, error *err)
{
    mrt_result result = rig_json_text(&out->name, at, "the name of a paint", RIG_NAME_MAX, err);
    if (result < 0 || !s->document)
        return result;
    uint32_t file;
    json_node paint = rig_document_paint(s->document, out->name, &file);
    if (paint.value)
        return rig_paint_parse(out, &paint, s->budget, err);
    json_words word = json_shown(out->name);
    return error_set(err, MRT_ERR_FORMAT, "%s: the rig has no paint \"%s\"; add it to $.paints",
                     at->path.text, word.text);
}

/* ---- any selector ---- */

static mrt_result parse_select_kind(rig_select *out, const json_node *at, selecting *s, error *err)
{
    switch (out->kind) {
    case SELECT_VERTICES:
        return parse_vertices(out, at, err);
    case SELECT_GROUP:
        return rig_json_text(&out->name, at, "the name of a part or material", GROUP_MAX, err);
    case SELECT_ATTRIBUTE:
        return rig_json_text(&out->name, at, "the name of a vertex attribute like \"_SKULL\"",
                             GROUP_MAX, err);
    case SELECT_BOX:
        return parse_box(out, at, s, err);
    case SELECT_ELLIPSOID:
        return parse_ellipsoid(out, at, s, err);
    case SELECT_HALF_SPACE:
        return parse_half_space(out, at, s, err);
    case SELECT_WITHIN:
        return parse_within(out, at, s, err);
    case SELECT_ALL:
    case SELECT_ANY:
        return parse_children(out, at, s, err);
    case SELECT_NOT:
    case SELECT_PIECES_INSIDE:
        return parse_inner(out, at, s, err);
    case SELECT_PIECE:
        return rig_json_index(&out->vertex, at, err);
    case SELECT_JOINT:
        return rig_json_text(&out->name, at, "the name of a joint like \"Head\"", GROUP_MAX, err);
    case SELECT_PAINTED:
        return parse_painted(out, at, s, err);
    case SELECT_NOTHING:
        break;
    }
    return json_node_unexpected(err, at, kind_list);
}

static mrt_result find_select_kind(rig_select *out, const json_node *at, const selecting *s,
                                   error *err)
{
    const char *known[KIND_COUNT] = {NULL};
    mrt_result result = json_node_object(at, "an object", err);
    if (result < 0)
        return result;
    for (int kind = SELECT_NOTHING + 1; kind < KIND_COUNT; ++kind) {
        known[kind - 1] = words[kind].key;
        if (!json_object_get(at->value, words[kind].key))
            continue;
        if (out->kind != SELECT_NOTHING)
            return error_set(err, MRT_ERR_FORMAT,
                             "%s: has both \"%s\" and \"%s\"; combine them with \"all\" or \"any\"",
                             at->path.text, words[out->kind].key, words[kind].key);
        out->kind = (rig_select_kind)kind;
    }
    if (out->kind == SELECT_NOTHING)
        return json_node_unexpected(err, at, kind_list);
    rig_json_note_unknown(s->note, at, known);
    return MRT_OK;
}

static mrt_result parse_select(rig_select *out, const json_node *at, selecting *s, error *err)
{
    *out = (rig_select){0};
    if (s->depth >= DEPTH_MAX || s->node_count >= NODES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: selectors can be nested %d deep, and a rig can have %d of them; use "
                         "groups or attributes instead",
                         at->path.text, DEPTH_MAX, NODES_MAX);
    s->node_count += 1;
    mrt_result result = find_select_kind(out, at, s, err);
    if (result < 0)
        return result;
    out->path = strdup(at->path.text);
    if (!out->path)
        return no_memory(err);
    json_node value = json_node_member(at, words[out->kind].key);
    s->depth += 1;
    result = parse_select_kind(out, &value, s, err);
    s->depth -= 1;
    return result;
}

mrt_result rig_select_parse(rig_select *out, const json_node *at, double mm_per_unit, error *err)
{
    char *note = NULL;
    selecting s = {.mm_per_unit = mm_per_unit, .note = &note};
    mrt_result result = parse_select(out, at, &s, err);
    free(note);
    return result;
}

/* ---- bones ---- */

static const double radian_per_degree = ANGLE_PI / 180.0;
/* Limits of an adult (Ferrario 2005, Travers 2000). */
const rig_bone rig_adult_jaw = {.kind = BONE_JAW,
                                .open_max_rad = 32.0 * ANGLE_PI / 180.0,
                                .lateral_mm = 10.0,
                                .forward_mm = 8.0,
                                .slide_mm = 12.0};

typedef struct reading {
    rig *r;
    json_node node; /* JSON of the bone */
    double mm_per_unit;
} reading;

/* Reads [least, greatest] in degrees. The range must include 0, the pose at rest. */
static mrt_result read_range(double *out_min_rad, double *out_max_rad, const json_node *at,
                             double reach_deg, error *err)
{
    double deg[2];
    if (!json_is_array(at->value) || json_array_size(at->value) != 2)
        return json_node_unexpected(err, at, "two angles [least, greatest] in degrees");
    for (size_t i = 0; i < 2; ++i) {
        json_node item = json_node_item(at, i);
        mrt_result result = json_node_number(&deg[i], &item, -reach_deg, reach_deg, err);
        if (result < 0)
            return result;
    }
    if (deg[0] >= deg[1])
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: [%g, %g] is reversed or empty; write the smaller angle first",
                         at->path.text, deg[0], deg[1]);
    if (deg[0] > 0.0 || deg[1] < 0.0)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: [%g, %g] does not include 0, the pose of the mesh; widen the range",
                         at->path.text, deg[0], deg[1]);
    *out_min_rad = deg[0] * radian_per_degree;
    *out_max_rad = deg[1] * radian_per_degree;
    return MRT_OK;
}

/* ---- jaw ---- */

static mrt_result read_hinge(rig_bone *bone, const reading *in, error *err)
{
    static const char *const known[] = {"left", "right", NULL};
    json_node hinge = json_node_member(&in->node, "hinge");
    mrt_result result =
        json_node_object(&hinge, "an object {\"left\": [x,y,z], \"right\": [x,y,z]}", err);
    if (result < 0)
        return result;
    json_node left = json_node_member(&hinge, "left"), right = json_node_member(&hinge, "right");
    result = rig_json_point(&bone->hinge_left, &left, in->mm_per_unit, err);
    if (result >= 0)
        result = rig_json_point(&bone->hinge_right, &right, in->mm_per_unit, err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&in->r->note, &hinge, known);
    double length_mm = vec3_length(vec3_sub(bone->hinge_left, bone->hinge_right));
    if (!(length_mm > 1.0))
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: left and right are only %.3g mm apart, so they give no axis; use the "
                         "two jaw joints, just in front of the ears",
                         hinge.path.text, length_mm);
    return MRT_OK;
}

static mrt_result read_jaw(rig_bone *bone, const reading *in, error *err)
{
    rig_bone jaw = rig_adult_jaw;
    jaw.name = bone->name;
    jaw.parent = bone->parent;
    *bone = jaw;
    mrt_result result = read_hinge(bone, in, err);
    json_node open = json_node_member(&in->node, "open_deg");
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

/* `bone` is the next entry of the rig: it is not counted in bone_count yet. */
static mrt_result read_follows(rig_bone *bone, uint32_t index, const json_node *at, rig *r,
                               error *err)
{
    static const char *const known[] = {"dof", "share", NULL};
    json_node follows = json_node_member(at, "follows");
    if (!follows.value)
        return MRT_OK;
    rig_follow *out = &bone->turn[index].follows;
    mrt_result result = json_node_object(&follows, "an object with dof and share", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, &follows, known);
    json_node dof = json_node_member(&follows, "dof"), share = json_node_member(&follows, "share");
    const char *name = json_string_value(dof.value), *fault = NULL;
    if (!name)
        return json_node_unexpected(err, &dof, "a degree of freedom like \"eye.l.pitch\"");
    result = json_node_number(&out->share, &share, -1.0, 1.0, err);
    if (result < 0)
        return result;
    uint32_t before = r->bone_count;
    r->bone_count += 1; /* include its own turns in the search */
    if (!rig_find_turn(r, name, &out->bone, &out->turn))
        fault = "is not a turn of a ball that is listed before it";
    r->bone_count = before;
    if (!fault)
        fault = rig_follow_fault(r, before, index);
    if (!fault)
        return MRT_OK;
    json_words word = json_shown(name);
    return error_set(err, MRT_ERR_FORMAT, "%s: \"%s\" %s", dof.path.text, word.text, fault);
}

static mrt_result read_turn(rig_bone *bone, const json_node *at, rig *r, error *err)
{
    static const char *const known[] = {"name", "axis", "deg", "follows", NULL};
    uint32_t index = bone->turn_count;
    rig_turn *turn = &bone->turn[index];
    mrt_result result = json_node_object(at, "an object with name, axis and deg", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, at, known);
    json_node name = json_node_member(at, "name"), axis = json_node_member(at, "axis");
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
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: expected a direction, found a vector of length 0", axis.path.text);
    turn->axis = vec3_normalised(turn->axis, (vec3){1.0, 0.0, 0.0});
    json_node deg = json_node_member(at, "deg");
    result = read_range(&turn->min_rad, &turn->max_rad, &deg, 180.0, err);
    return result < 0 ? result : read_follows(bone, index, at, r, err);
}

static mrt_result read_ball(rig_bone *bone, const reading *in, error *err)
{
    static const char *const known[] = {"centre", "radius_mm", NULL};
    bone->kind = BONE_BALL;
    json_node ball = json_node_member(&in->node, "ball");
    json_node turns = json_node_member(&in->node, "turns");
    mrt_result result = json_node_object(&ball, "an object {\"centre\": [x,y,z]}", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&in->r->note, &ball, known);
    json_node centre = json_node_member(&ball, "centre");
    result = rig_json_point(&bone->centre, &centre, in->mm_per_unit, err);
    if (result >= 0)
        result = rig_json_optional_number(&bone->radius_mm, &ball, "radius_mm", 0.0, 1e6, err);
    if (result >= 0)
        result = json_node_array(&turns, "a list of one to three turns", RIG_TURNS_MAX, err);
    if (result >= 0 && json_array_size(turns.value) == 0)
        result = json_node_unexpected(err, &turns, "a list of one to three turns");
    for (size_t i = 0; result >= 0 && i < json_array_size(turns.value); ++i) {
        json_node item = json_node_item(&turns, i);
        result = read_turn(bone, &item, in->r, err);
    }
    return result;
}

/* ---- bones of any kind ---- */

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
                         "%s: has both a hinge and a ball; a bone can have only one of them",
                         in->node.path.text);
    const char *const *keys = has_hinge ? jaw_keys : has_ball ? ball_keys : fixed_keys;
    rig_json_note_unknown(&in->r->note, &in->node, keys);
    return has_hinge ? read_jaw(bone, in, err) : has_ball ? read_ball(bone, in, err) : MRT_OK;
}

static mrt_result read_parent(rig_bone *bone, const reading *in, error *err)
{
    json_node parent = json_node_member(&in->node, "parent");
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

static mrt_result read_bone(rig_bone *bone, const reading *in, error *err)
{
    mrt_result result = read_parent(bone, in, err);
    return result < 0 ? result : read_kind(bone, in, err);
}

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

static mrt_result add_default_skull(rig *r, error *err)
{
    r->bone[0] = (rig_bone){.name = strdup("skull"), .parent = RIG_NONE};
    r->bone_count = 1;
    return r->bone[0].name ? MRT_OK : no_memory(err);
}

static mrt_result fill_bones(rig *r, rig_document *d, error *err)
{
    uint32_t count = d->entry_count[RIG_BONES];
    mrt_result result = count == 0 ? add_default_skull(r, err) : MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        const rig_entry *entry = &d->entry[RIG_BONES][i];
        reading in = {r, entry->node, d->file[entry->file].mm_per_unit};
        json_node name = json_node_member(&in.node, "name");
        rig_bone *bone = &r->bone[i];
        bone->parent = RIG_NONE;
        result = rig_json_text(&bone->name, &name, "a name like \"jaw\"", RIG_NAME_MAX - 8, err);
        if (result < 0)
            return result;
        result = read_bone(bone, &in, err);
        r->bone_count = i + 1; /* can be a parent of the bones that follow */
        if (result >= 0)
            result = check_dofs(r, &in.node, err);
    }
    return result;
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

/* ---- degrees of freedom: degrees or mm in the file ---- */

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
    return pose->dof_name[index] ? MRT_OK : no_memory(err);
}

static mrt_result read_dofs(rig_pose *pose, const rig *r, const json_node *dofs, error *err)
{
    if (!dofs->value)
        return MRT_OK;
    mrt_result result = json_node_object(dofs, "an object like {\"jaw.open\": 20}", err);
    if (result < 0)
        return result;
    size_t count = json_object_size(dofs->value);
    if (count > MRT_MAX_DOFS)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: has more than %d entries; remove some",
                         dofs->path.text, MRT_MAX_DOFS);
    pose->dof_name = calloc(count + 1, sizeof *pose->dof_name);
    pose->dof_value = calloc(count + 1, sizeof *pose->dof_value);
    if (!pose->dof_name || !pose->dof_value)
        return no_memory(err);
    json_t *value = (json_t *)(uintptr_t)dofs->value;
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        json_node member = json_node_member(dofs, json_object_iter_key(at));
        result = add_dof(pose, r, json_object_iter_key(at), &member, err);
    }
    return result;
}

/* ---- pulls ---- */

static mrt_result read_pulls(rig_pose *pose, const rig *r, const json_node *pulls,
                             double mm_per_unit, error *err)
{
    if (!pulls->value)
        return MRT_OK;
    mrt_result result = json_node_object(pulls, "an object like {\"chin\": [0, -4, 1]}", err);
    if (result < 0)
        return result;
    size_t count = json_object_size(pulls->value);
    if (count > PULLS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: has more than %d entries; remove some",
                         pulls->path.text, PULLS_MAX);
    pose->pull_contact = calloc(count + 1, sizeof *pose->pull_contact);
    pose->pull_mm = calloc(count + 1, sizeof *pose->pull_mm);
    if (!pose->pull_contact || !pose->pull_mm)
        return no_memory(err);
    json_t *value = (json_t *)(uintptr_t)pulls->value;
    for (void *at = json_object_iter(value); result >= 0 && at;
         at = json_object_iter_next(value, at)) {
        const char *name = json_object_iter_key(at);
        json_node member = json_node_member(pulls, name);
        uint32_t index = pose->pull_count;
        pose->pull_count += 1;
        result = find_contact(&pose->pull_contact[index], r, name, &member, err);
        if (result >= 0)
            result = rig_json_point(&pose->pull_mm[index], &member, mm_per_unit, err);
    }
    return result;
}

static mrt_result read_part(rig_pose_part *out, const json_node *at, error *err)
{
    const char *name = json_string_value(at->value);
    if (!at->value)
        return MRT_OK;
    for (rig_pose_part part = POSE_MOUTH; name && part <= POSE_UPPER; ++part)
        if (strcmp(name, rig_pose_part_name[part]) == 0) {
            *out = part;
            return MRT_OK;
        }
    return json_node_unexpected(err, at, "\"mouth\" or \"upper\" (without it: the whole face)");
}

static mrt_result read_pose(rig *r, rig_pose *pose, const json_node *at, double mm_per_unit,
                            error *err)
{
    static const char *const known[] = {"name", "part", "dofs", "pulls", NULL};
    rig_json_note_unknown(&r->note, at, known);
    json_node name = json_node_member(at, "name"), dofs = json_node_member(at, "dofs");
    json_node pulls = json_node_member(at, "pulls"), part = json_node_member(at, "part");
    mrt_result result = rig_json_text(&pose->name, &name, "a name", RIG_NAME_MAX, err);
    if (result >= 0)
        result = read_part(&pose->part, &part, err);
    if (result >= 0)
        result = read_dofs(pose, r, &dofs, err);
    return result < 0 ? result : read_pulls(pose, r, &pulls, mm_per_unit, err);
}

/* Charges the budget for the search of each name among all contacts. */
static mrt_result charge_names(rig_document *d, const rig *r, uint32_t name_count, error *err)
{
    return budget_spend_work(&d->budget, (uint64_t)name_count * r->contact_count, err);
}

static mrt_result fill_poses(rig *r, rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_POSES]; ++i) {
        const rig_entry *entry = &d->entry[RIG_POSES][i];
        r->pose_count = i + 1;
        result = read_pose(r, &r->pose[i], &entry->node, d->file[entry->file].mm_per_unit, err);
        if (result >= 0)
            result = charge_names(d, r, r->pose[i].pull_count, err);
    }
    return result;
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

static mrt_result read_set(rig_contact_set *set, const rig *r, const rig_entry *entry, error *err)
{
    set->name = strdup(entry->name);
    if (!set->name)
        return no_memory(err);
    mrt_result result = json_node_array(&entry->node, "a list of contacts", PULLS_MAX, err);
    if (result < 0)
        return result;
    size_t count = json_array_size(entry->node.value);
    set->contact = calloc(count + 1, sizeof *set->contact);
    if (!set->contact)
        return no_memory(err);
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node item = json_node_item(&entry->node, i);
        result = add_to_set(set, r, &item, err);
    }
    return result;
}

static mrt_result fill_contact_sets(rig *r, rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_SETS]; ++i) {
        r->contact_set_count = i + 1;
        result = read_set(&r->contact_set[i], r, &d->entry[RIG_SETS][i], err);
        if (result >= 0)
            result = charge_names(d, r, r->contact_set[i].contact_count, err);
    }
    return result;
}

enum { MESH_NAME_MAX = 1024, HASH_DIGITS = 16 };

/* ---- name, mesh and solver ---- */

static const char *const root_keys[] = {
    "marotte_rig",  "name",      "mesh",    "unit",      "mesh_vertices", "mesh_hash",
    "include",      "bones",     "regions", "contacts",  "skull_proxy",   "poses",
    "contact_sets", "solver",    "paints",  "mesh_unit", "mesh_up",       "mesh_forward",
    "shapes",       "cut_mouth", "mouth",   NULL};

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

static mrt_result fill_name(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    json_node name = rig_document_scalar(d, "name", &file);
    if (name.value)
        return rig_json_text(&r->name, &name, "a name", RIG_NAME_MAX, err);
    r->name = name_from_path(r->path);
    return r->name ? MRT_OK : no_memory(err);
}

static mrt_result check_name(const rig *r, error *err)
{
    char *folder = file_directory(r->path);
    mrt_result result = folder ? file_check_below(folder, r->mesh_path, err) : no_memory(err);
    free(folder);
    return result;
}

static mrt_result fill_mesh_path(rig *r, const rig_document *d, error *err)
{
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
        return no_memory(err);
    if (!d->is_trusted)
        result = check_name(r, err);
    if (result < 0)
        error_prefix(err, named.path.text);
    return result;
}

static mrt_result fill_hash(rig *r, const json_node *at, error *err)
{
    const char *text = json_string_value(at->value);
    if (!text || strlen(text) != HASH_DIGITS || strspn(text, "0123456789abcdef") != HASH_DIGITS)
        return json_node_unexpected(err, at, "16 digits 0-9a-f, as written by marotte rig new");
    r->mesh_hash = strtoull(text, NULL, 16);
    return MRT_OK;
}

static mrt_result fill_mesh(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    mrt_result result = fill_mesh_path(r, d, err);
    json_node count = rig_document_scalar(d, "mesh_vertices", &file);
    if (result >= 0 && count.value)
        result = rig_json_index(&r->mesh_vertex_count, &count, err);
    json_node hash = rig_document_scalar(d, "mesh_hash", &file);
    if (result >= 0 && hash.value)
        result = fill_hash(r, &hash, err);
    return result;
}

static mrt_result fill_solver_word(rig *r, const json_node *solver, const char *key, error *err)
{
    json_node at = json_node_member(solver, key);
    const char *word = json_string_value(at.value);
    bool is_kernel = strcmp(key, "kernel") == 0;
    if (!at.value || (word && (is_kernel ? csrbf_kernel_named(word, &r->solver.kernel)
                                         : csrbf_polynomial_named(word, &r->solver.polynomial))))
        return MRT_OK;
    return json_node_unexpected(err, &at,
                                is_kernel
                                    ? "one of wendland_c2, wendland_c0, wendland_c4, wendland_c6"
                                    : "one of none, constant, linear, windowed");
}

static mrt_result fill_solver(rig *r, rig_document *d, error *err)
{
    static const char *const known[] = {"kernel", "polynomial", "radius_mm", "ridge", NULL};
    uint32_t file;
    json_node solver = rig_document_scalar(d, "solver", &file);
    if (!solver.value)
        return MRT_OK;
    mrt_result result = json_node_object(&solver, "an object with kernel and radius_mm", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, &solver, known);
    result = fill_solver_word(r, &solver, "kernel", err);
    if (result >= 0)
        result = fill_solver_word(r, &solver, "polynomial", err);
    if (result >= 0)
        result = rig_json_optional_number(&r->solver.radius, &solver, "radius_mm", 0.01, 1e6, err);
    if (result >= 0)
        result = rig_json_optional_number(&r->solver.ridge, &solver, "ridge", 0.0, 1e3, err);
    return result;
}

static mrt_result fill_shapes(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    json_node shapes = rig_document_scalar(d, "shapes", &file);
    r->shapes = 1.0;
    return shapes.value ? json_node_number(&r->shapes, &shapes, 0.0, 1.0, err) : MRT_OK;
}

/* ---- regions ---- */

static mrt_result find_bone(uint32_t *out, const rig *r, const json_node *at, error *err)
{
    const char *name = json_string_value(at->value);
    if (!name)
        return json_node_unexpected(err, at, "the name of a bone");
    *out = rig_find_bone(r, name);
    if (*out != RIG_NONE)
        return MRT_OK;
    json_words word = json_shown(name);
    return error_set(err, MRT_ERR_FORMAT, "%s: the rig has no bone \"%s\"; add it to $.bones",
                     at->path.text, word.text);
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

/* Names are for display only. A name that cannot be shown is dropped here, but kept in the
 * file. */
static void fill_region_name(rig_region *region, const json_node *at)
{
    json_node name = json_node_member(at, "name");
    if (name.value && rig_json_text(&region->name, &name, "a name", RIG_NAME_MAX, NULL) < 0)
        region->name = NULL;
}

static mrt_result fill_region(rig *r, rig_region *region, const json_node *at, selecting *s,
                              error *err)
{
    static const char *const known[] = {"name",     "bone",   "rigid", "weight",
                                        "mobility", "select", NULL};
    *region = (rig_region){.bone = RIG_NONE, .weight = (double)NAN, .mobility = (double)NAN};
    rig_json_note_unknown(&r->note, at, known);
    fill_region_name(region, at);
    json_node bone = json_node_member(at, "bone"), is_rigid = json_node_member(at, "rigid");
    mrt_result result = bone.value ? find_bone(&region->bone, r, &bone, err) : MRT_OK;
    if (result >= 0 && is_rigid.value)
        result = json_node_flag(&region->is_rigid, &is_rigid, err);
    if (result >= 0)
        result = rig_json_optional_number(&region->weight, at, "weight", 0.0, 1.0, err);
    if (result >= 0)
        result = rig_json_optional_number(&region->mobility, at, "mobility", 0.0, 1.0, err);
    if (result >= 0)
        result = check_region(region, at, err);
    json_node select = json_node_member(at, "select");
    return result < 0 ? result : parse_select(&region->select, &select, s, err);
}

static mrt_result fill_regions(rig *r, rig_document *d, error *err)
{
    selecting s = {.note = &r->note, .document = d, .budget = &d->budget};
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_REGIONS]; ++i) {
        const rig_entry *entry = &d->entry[RIG_REGIONS][i];
        s.mm_per_unit = d->file[entry->file].mm_per_unit;
        r->region_count = i + 1;
        result = fill_region(r, &r->region[i], &entry->node, &s, err);
        r->region[i].source = i + 1;
    }
    return result;
}

/* ---- contacts ---- */

static mrt_result fill_contact(rig *r, rig_contact *contact, const json_node *at, error *err)
{
    static const char *const known[] = {"name", "bone", "vertex", "mirror", NULL};
    *contact = (rig_contact){.bone = RIG_NONE, .mirror = RIG_NONE};
    rig_json_note_unknown(&r->note, at, known);
    json_node name = json_node_member(at, "name"), bone = json_node_member(at, "bone");
    json_node vertex = json_node_member(at, "vertex");
    mrt_result result =
        rig_json_text(&contact->name, &name, "a name like \"chin\"", RIG_NAME_MAX, err);
    if (result >= 0)
        result = rig_json_index(&contact->vertex, &vertex, err);
    const char *word = json_string_value(bone.value);
    bool is_auto = !bone.value || (word && strcmp(word, "auto") == 0);
    return result < 0 || is_auto ? result : find_bone(&contact->bone, r, &bone, err);
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

static mrt_result fill_contacts(rig *r, rig_document *d, error *err)
{
    const rig_entry *entry = d->entry[RIG_CONTACTS];
    uint32_t count = d->entry_count[RIG_CONTACTS];
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < count; ++i) {
        result = fill_contact(r, &r->contact[i], &entry[i].node, err);
        r->contact[i].source = i + 1;
        r->contact_count = i + 1;
    }
    for (uint32_t i = 0; result >= 0 && i < count; ++i)
        result = find_mirror(r, i, &entry[i].node, err);
    return result < 0 ? result : check_mirrors(r, err);
}

/* ---- skull proxy ---- */

static mrt_result fill_proxy(rig *r, rig_proxy *proxy, const json_node *at, double mm_per_unit,
                             error *err)
{
    static const char *const known[] = {"ellipsoid", "teeth", NULL};
    static const char *const known_inside[] = {"centre", "radii", "bone", NULL};
    json_node ellipsoid = json_node_member(at, "ellipsoid"), teeth = json_node_member(at, "teeth");
    if (teeth.value && ellipsoid.value)
        return error_set(err, MRT_ERR_FORMAT,
                         "%s: has both \"ellipsoid\" and \"teeth\"; split it into two entries",
                         at->path.text);
    if (teeth.value) {
        proxy->kind = PROXY_TEETH;
        ellipsoid = teeth;
    }
    mrt_result result = json_node_object(&ellipsoid, "an object with centre, radii and bone", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(&r->note, at, known);
    rig_json_note_unknown(&r->note, &ellipsoid, known_inside);
    json_node centre = json_node_member(&ellipsoid, "centre");
    json_node radii = json_node_member(&ellipsoid, "radii");
    json_node bone = json_node_member(&ellipsoid, "bone");
    result = rig_json_point(&proxy->centre, &centre, mm_per_unit, err);
    if (result >= 0)
        result = rig_json_point(&proxy->radii, &radii, mm_per_unit, err);
    if (result < 0)
        return result;
    if (!(proxy->radii.x > 0.0 && proxy->radii.y > 0.0 && proxy->radii.z > 0.0))
        return error_set(err, MRT_ERR_FORMAT, "%s: expected three radii greater than 0",
                         radii.path.text);
    return find_bone(&proxy->bone, r, &bone, err);
}

static mrt_result fill_proxies(rig *r, rig_document *d, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < d->entry_count[RIG_PROXIES]; ++i) {
        const rig_entry *entry = &d->entry[RIG_PROXIES][i];
        r->proxy_count = i + 1;
        r->proxy[i].source = i + 1;
        result = fill_proxy(r, &r->proxy[i], &entry->node, d->file[entry->file].mm_per_unit, err);
    }
    return result;
}

/* ---- the whole rig ---- */

static mrt_result fill_axis(mesh_axis *out, rig_document *d, const char *key, error *err)
{
    uint32_t file;
    json_node node = rig_document_scalar(d, key, &file);
    const char *word = json_string_value(node.value);
    if (!node.value || (word && mesh_axis_parse(out, word)))
        return MRT_OK;
    return json_node_unexpected(err, &node, "\"x\", \"y\", \"z\", \"-x\", \"-y\" or \"-z\"");
}

static mrt_result fill_frame(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    json_node unit = rig_document_scalar(d, "mesh_unit", &file);
    const char *word = json_string_value(unit.value);
    if (json_is_number(unit.value))
        r->frame.mm_per_unit = json_number_value(unit.value);
    if (unit.value && !(word ? mesh_unit_parse(&r->frame.mm_per_unit, word)
                             : r->frame.mm_per_unit >= 1e-9 && r->frame.mm_per_unit <= 1e9))
        return json_node_unexpected(err, &unit, "\"mm\", \"cm\", \"m\" or a number of mm");
    mrt_result result = fill_axis(&r->frame.up, d, "mesh_up", err);
    return result < 0 ? result : fill_axis(&r->frame.forward, d, "mesh_forward", err);
}

static mrt_result fill_cut_mouth(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    json_node list = rig_document_scalar(d, "cut_mouth", &file);
    size_t count = json_array_size(list.value);
    if (!list.value)
        return MRT_OK;
    if (count < 4 || count > MESH_CUT_MAX)
        return json_node_unexpected(
            err, &list, "a list of 4 vertices or more, as written by marotte rig new --cut-mouth");
    r->cut_mouth = malloc(count * sizeof *r->cut_mouth);
    mrt_result result = r->cut_mouth ? MRT_OK : no_memory(err);
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node vertex = json_node_item(&list, i);
        result = rig_json_index(&r->cut_mouth[i], &vertex, err);
        r->cut_mouth_count += 1;
    }
    return result;
}

/* Checks only the numbers. Whether the vertices form rims is checked on the mesh (bind_lips). */
static mrt_result read_rim(uint32_t **out, uint32_t *out_count, const json_node *mouth,
                           const char *key, error *err)
{
    json_node list = json_node_member(mouth, key);
    size_t count = json_array_size(list.value);
    if (count < RIG_RIM_LEAST || count > RIG_RIM_MOST)
        return json_node_unexpected(
            err, &list,
            "a list of 3 vertices or more, from the right corner of the mouth to the left one");
    *out = malloc(count * sizeof **out);
    mrt_result result = *out ? MRT_OK : no_memory(err);
    for (size_t i = 0; result >= 0 && i < count; ++i) {
        json_node vertex = json_node_item(&list, i);
        result = rig_json_index(*out + i, &vertex, err);
    }
    *out_count = (uint32_t)count;
    return result;
}

static mrt_result read_mouth(rig_mouth *out, char **note, const json_node *mouth, error *err)
{
    static const char *const known[] = {"upper",         "lower",     "upper_share",
                                        "stickiness_mm", "seal_from", NULL};
    mrt_result result = json_node_object(mouth, "an object with \"upper\" and \"lower\"", err);
    if (result < 0)
        return result;
    rig_json_note_unknown(note, mouth, known);
    json_node from = json_node_member(mouth, "seal_from");
    const char *word = json_string_value(from.value);
    out->upper_share = RIG_UPPER_SHARE;
    out->seal_from = word && strcmp(word, "middle") == 0 ? SEAL_FROM_MIDDLE : SEAL_FROM_CORNERS;
    if (from.value && !(word && (strcmp(word, "middle") == 0 || strcmp(word, "corners") == 0)))
        return json_node_unexpected(err, &from, "\"corners\" or \"middle\"");
    result = read_rim(&out->upper, &out->upper_count, mouth, "upper", err);
    if (result >= 0)
        result = read_rim(&out->lower, &out->lower_count, mouth, "lower", err);
    if (result >= 0)
        result = rig_json_optional_number(&out->upper_share, mouth, "upper_share", 0.0, 1.0, err);
    return result < 0 ? result
                      : rig_json_optional_number(&out->stickiness_mm, mouth, "stickiness_mm", 0.0,
                                                 RIG_STICKINESS_MOST_MM, err);
}

/* An invalid mouth is still declared, but without rims. So poses that name its seal stay valid,
 * and the face can be performed. */
static mrt_result fill_mouth(rig *r, rig_document *d, error *err)
{
    uint32_t file;
    json_node mouth = rig_document_scalar(d, "mouth", &file);
    error why = {""};
    rig_mouth *out = &r->mouth;
    if (!mouth.value)
        return MRT_OK;
    mrt_result result = read_mouth(out, &r->note, &mouth, &why);
    if (result >= 0)
        return MRT_OK;
    free(out->upper);
    free(out->lower);
    *out = (rig_mouth){.upper = calloc(1, sizeof *out->upper), .fault = strdup(why.text)};
    return result != MRT_ERR_MEMORY && out->upper && out->fault ? MRT_OK : no_memory(err);
}

static mrt_result allocate(rig *r, rig_document *d, error *err)
{
    r->bone = calloc(RIG_BONES_MAX, sizeof *r->bone);
    r->region = calloc(d->entry_count[RIG_REGIONS] + 1u, sizeof *r->region);
    r->contact = calloc(d->entry_count[RIG_CONTACTS] + 1u, sizeof *r->contact);
    r->proxy = calloc(d->entry_count[RIG_PROXIES] + 1u, sizeof *r->proxy);
    r->pose = calloc(d->entry_count[RIG_POSES] + 1u, sizeof *r->pose);
    r->contact_set = calloc(d->entry_count[RIG_SETS] + 1u, sizeof *r->contact_set);
    return r->bone && r->region && r->contact && r->proxy && r->pose && r->contact_set
               ? MRT_OK
               : no_memory(err);
}

static void note_unknown_roots(rig *r, const rig_document *d)
{
    for (uint32_t i = 0; i < d->file_count; ++i) {
        json_node root = {d->file[i].root, d->file[i].root_path};
        rig_json_note_unknown(&r->note, &root, root_keys);
    }
}

/* Fills all of `r`. On error `r` can still be passed to rig_destroy. */
static mrt_result fill(rig *r, rig_document *d, error *err)
{
    static mrt_result (*const steps[])(rig *, rig_document *, error *) = {
        allocate,      fill_name,    fill_mesh,   fill_frame,       fill_cut_mouth,
        fill_mouth,    fill_solver,  fill_shapes, fill_bones,       fill_regions,
        fill_contacts, fill_proxies, fill_poses,  fill_contact_sets};
    r->mm_per_unit = d->file[d->file_count - 1].mm_per_unit;
    note_unknown_roots(r, d);
    mrt_result result = MRT_OK;
    for (size_t i = 0; result >= 0 && i < sizeof steps / sizeof *steps; ++i)
        result = steps[i](r, d, err);
    return result;
}

/* ---- files ---- */

static mrt_result finish_reading(rig *out, rig_document *d, const char *path, error *err)
{
    out->document = d;
    out->path = strdup(path);
    mrt_result result = out->path ? fill(out, d, err) : no_memory(err);
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
        return no_memory(err);
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
