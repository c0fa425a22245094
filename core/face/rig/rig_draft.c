#include "face/rig_draft.h"

#include "base/text.h"
#include "face/rig/rig_anatomy.h"
#include "face/rig/rig_document.h"
#include "face/rig/rig_rims.h"
#include "face/rig/rig_teeth.h"
#include "face/weights/weights_laplace.h"
#include "face/face.h"
#include "face/rig_check.h"
#include "face/rig_edit.h"
#include "mesh/position.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REGIONS_MAX = 200 };
/* Greatest number of vertices. At least an eighth of a head is its face. */
#define DRAFT_MOST (8u * LAPLACE_FREE_MOST)
#define NECK       0.6  /* of the reach: depth below the chin to which pulls draw the skin along */
#define EYE_REACH  1.28 /* of an eyeball's radius: inside this sphere the skin cannot be pulled */
#define EYE_FREE   1.6  /* of an eyeball's radius: outside this sphere the mobility is 1 */
#define LIPS_DEEP  0.15 /* of the reach: depth behind other skin up to which the mobility is 1 */
#define MOUTH_DEEP 0.45 /* of the reach: depth behind other skin from which the mobility is 0 */
#define LID_REACH  1.22 /* of an eyeball's radius: greatest distance of a lid from the centre */

typedef enum ambition { /* contents of a draft; reduced if a draft cannot be loaded */
                        ALL = 0,
                        WITHOUT_LIDS,
                        WITHOUT_PIECES,
                        WITHOUT_BONES, /* the skull alone: the head is clay */
                        AMBITIONS
} ambition;

typedef struct patch { /* a patch of skin that must not bend: the end of a slit */
    vec3 at;
    double radius_mm;
} patch;

enum { PATCHES_MAX = 12 };

typedef struct drafting {
    const mesh *m;
    const topology *t;
    rig_anatomy a;
    rig_head head;
    ambition ambition;
    bool has_jaw, has_body; /* a bone moves at least one vertex */
    patch patch[PATCHES_MAX];
    uint32_t patch_count;
    double reach_mm; /* height from the nose down to the chin: the unit of measure of a face */
    json_t *bones, *regions, *contacts;
    uint8_t *is_loose; /* piece_count: the piece swings, so it is not rigid */
    rig_mouth mouth;
    char no_mouth[BIND_FAULT]; /* why no mouth was found; "" if one was */
    char *confirm;             /* lines */
} drafting;

static const char *const doubted[] = {
    [HEAD_NO_DOUBT] = "by its shape (likely)",
    [HEAD_PLAIN] =
        "by the proportions of heads, since the shape shows no nose and no mouth (unsure)",
    [HEAD_UNEVEN] = "by its shape, but its left and right side differ much (unsure)",
    [HEAD_UNUSUAL] = "by its shape, but the chin is unusually near to the nose or far from it "
                     "(unsure)"};
static const char *const sure[] = {[BY_SHAPE] = "by its shape (likely)",
                                   [BY_NAME] = "by its name (certain)",
                                   [BY_SKELETON] = "by the skeleton (certain)"};

static const double degree_per_radian = 57.29577951308232;

#define HEAD_LEAST_MM 10.0 /* positions are written to 0.1 mm */

/* Rounds to 0.1 mm. */
static json_t *point_of(vec3 p)
{
    return rig_point_to_json((vec3){round(10.0 * p.x), round(10.0 * p.y), round(10.0 * p.z)}, 10.0);
}

/* ---- contacts ---- */

typedef enum level { FROM_NOSE, FROM_MOUTH, FROM_CHIN } level;

#define CORNER_ACROSS 0.362
#define CORNER_UP     (-0.020)

/* Places of contacts on the ICT face. Across is in half widths of the face; up is in reaches
 * (nose to chin), measured from one of three levels. */
static const struct {
    const char *name;
    double across, up;
    level from;
} standard[] = {{"brow.inner", 0.168, 0.708, FROM_NOSE},
                {"brow.mid", 0.543, 0.750, FROM_NOSE},
                {"brow.outer", 0.834, 0.622, FROM_NOSE},
                {"cheek", 0.645, 0.113, FROM_NOSE},
                {"cheek.lower", 0.645, -0.311, FROM_NOSE},
                {"nasolabial", 0.387, -0.227, FROM_NOSE},
                {"nose.wing", 0.215, -0.070, FROM_NOSE},
                {"mouth.corner", CORNER_ACROSS, CORNER_UP, FROM_MOUTH},
                {"lip.upper.side", 0.179, 0.070, FROM_MOUTH},
                {"lip.lower.side", 0.179, -0.090, FROM_MOUTH},
                {"jaw.angle", 0.817, 0.446, FROM_CHIN},
                {"lip.upper.mid", 0.0, 0.080, FROM_MOUTH},
                {"lip.lower.mid", 0.0, -0.095, FROM_MOUTH},
                {"chin", 0.0, 0.190, FROM_CHIN},
                {"nose.tip", 0.0, 0.0, FROM_NOSE},
                {"forehead.mid", 0.0, 1.020, FROM_NOSE}};
enum { STANDARD_COUNT = sizeof standard / sizeof *standard };

static bool snap(uint32_t *out_vertex, const drafting *d, int index)
{
    const rig_head *head = &d->head;
    const double level_y[] = {head->nose.y, head->mouth_y, head->chin.y};
    double across = standard[index].across * head->half_width;
    double reach = d->reach_mm;
    if (standard[index].from == FROM_NOSE && standard[index].up > 0.5) /* for low foreheads */
        reach = fmin(reach, 0.6 * (head->top_y - head->nose.y));
    double y = level_y[standard[index].from] + standard[index].up * reach;
    if (standard[index].from == FROM_MOUTH) {
        if (head->corner_x > 0.0)
            across *= head->corner_x / (CORNER_ACROSS * head->half_width);
        if (standard[index].up > 0.0)
            y = fmax(y, head->lip_upper_y);
        else if (standard[index].up < CORNER_UP)
            y = fmin(y, head->lip_lower_y);
    }
    vec3 hit;
    return rig_head_hit(&hit, out_vertex, d->m, d->a.is_face, head->middle_x + across, y) &&
           hit.z > head->nose.z - 0.55 * (head->nose.z - head->back_z);
}

static void add_contact(drafting *d, const char *name, uint32_t vertex, const char *mirror)
{
    json_t *contact = json_pack("{ss, si}", "name", name, "vertex", (int)vertex);
    if (mirror)
        json_object_set_new(contact, "mirror", json_string(mirror));
    json_array_append_new(d->contacts, contact);
}

static void add_pair(drafting *d, int index, uint32_t vertex)
{
    char left[RIG_NAME_MAX + 1], right[RIG_NAME_MAX + 1];
    (void)snprintf(left, sizeof left, "%.32s.l", standard[index].name);
    (void)snprintf(right, sizeof right, "%.32s.r", standard[index].name);
    double off_mm;
    uint32_t other = rig_mirror_of(d->m, d->a.is_face, vertex, d->head.middle_x, &off_mm);
    if (other == vertex) {
        rig_note(&d->confirm, "contacts %s and %s: left out, because the mesh is too coarse there",
                 left, right);
        return;
    }
    if (off_mm > 2.0)
        rig_note(&d->confirm,
                 "contact %s: the mesh has no mirror image of vertex %u; the nearest vertex is "
                 "%.1f mm off",
                 right, vertex, off_mm);
    add_contact(d, left, vertex, right);
    add_contact(d, right, other, left);
}

static bool is_taken(const drafting *d, uint32_t vertex)
{
    for (size_t i = 0; i < json_array_size(d->contacts); ++i)
        if (json_integer_value(json_object_get(json_array_get(d->contacts, i), "vertex")) ==
            (json_int_t)vertex)
            return true;
    return false;
}

/* Places the 27 standard contacts, as far as the face has room for them. */
static void draft_contacts(drafting *d)
{
    for (int i = 0; i < STANDARD_COUNT; ++i) {
        uint32_t vertex;
        bool is_pair = standard[i].across > 0.0;
        if (!snap(&vertex, d, i) || is_taken(d, vertex))
            rig_note(&d->confirm, "contact %s%s: left out, because no free place was found for it",
                     standard[i].name, is_pair ? " (.l and .r)" : "");
        else if (is_pair)
            add_pair(d, i, vertex);
        else
            add_contact(d, standard[i].name, vertex, NULL);
    }
    rig_note(&d->confirm,
             "contacts: %zu contacts were placed on the front of the face by its proportions "
             "(likely). Check them with marotte rig show, above all at the lips (upper above, "
             "lower below the slit) and the corners of the mouth",
             json_array_size(d->contacts));
}

/* Returns the vertex of a contact in the draft, or RIG_NONE. */
static uint32_t contact_vertex(const drafting *d, const char *name)
{
    for (size_t i = 0; i < json_array_size(d->contacts); ++i) {
        const json_t *contact = json_array_get(d->contacts, i);
        const char *found = json_string_value(json_object_get(contact, "name"));
        if (found && strcmp(found, name) == 0)
            return (uint32_t)json_integer_value(json_object_get(contact, "vertex"));
    }
    return RIG_NONE;
}

/* ---- pieces ---- */

static json_t *piece_select(const anatomy_piece *p)
{
    return json_pack("{sI}", "piece", (json_int_t)p->vertex);
}

/* Joins the selectors of a list with "any". A list of one becomes that selector. */
static json_t *any_of(json_t *list)
{
    json_t *only = json_array_size(list) == 1 ? json_incref(json_array_get(list, 0)) : NULL;
    if (!only)
        return json_pack("{so}", "any", list);
    json_decref(list);
    return only;
}

/* Restricts `select` to the piece that is the face. */
static json_t *of_face(const drafting *d, json_t *select)
{
    return d->a.piece_count < 2
               ? select
               : json_pack("{s[oo]}", "all", piece_select(&d->a.piece[d->a.face]), select);
}

static const char *part_name(const drafting *d, uint32_t part)
{
    return part < d->m->part_count ? d->m->part[part].name : "";
}

/* Adds one region for all pieces of a kind that belong to one part of the mesh. */
static void add_rigid_pieces(drafting *d, const char *bone, piece_kind kind, uint32_t first)
{
    const anatomy_piece *like = &d->a.piece[first];
    const char *name = part_name(d, like->part);
    json_t *list = json_array();
    anatomy_source source = like->source;
    for (uint32_t i = first; i < d->a.piece_count; ++i) {
        const anatomy_piece *p = &d->a.piece[i];
        if (p->kind != kind || strcmp(part_name(d, p->part), name) != 0 || d->is_loose[i])
            continue;
        json_array_append_new(list, piece_select(p));
        source = p->source < source ? p->source : source;
    }
    size_t count = json_array_size(list);
    json_array_append_new(
        d->regions, json_pack("{ss, sb, so}", "bone", bone, "rigid", 1, "select", any_of(list)));
    if (count == 1 && name[0])
        rig_note(&d->confirm, "part %s: rigid on %s, %s", name, bone, sure[source]);
    else if (count == 1)
        rig_note(&d->confirm, "the piece of vertex %u: rigid on %s, %s", like->vertex, bone,
                 sure[source]);
    else
        rig_note(&d->confirm, "%zu pieces%s%s: rigid on %s, %s", count, name[0] ? " of part " : "",
                 name, bone, sure[source]);
}

static bool is_same_as_earlier(const drafting *d, uint32_t piece)
{
    for (uint32_t i = 0; i < piece; ++i)
        if (!d->is_loose[i] && d->a.piece[i].kind == d->a.piece[piece].kind &&
            strcmp(part_name(d, d->a.piece[i].part), part_name(d, d->a.piece[piece].part)) == 0)
            return true;
    return false;
}

/* Makes pieces rigid on the bone of their kind. A body with a skin is left out, because its
 * skin gives the weights. */
static void draft_pieces(drafting *d)
{
    static const char *const bone_of[] = {
        [PIECE_RIDES] = "skull",     [PIECE_BEARD] = "jaw",  [PIECE_TEETH_UPPER] = "skull",
        [PIECE_TEETH_LOWER] = "jaw", [PIECE_TONGUE] = "jaw", [PIECE_EYE_LEFT] = "eye.l",
        [PIECE_EYE_RIGHT] = "eye.r"};
    for (uint32_t i = 0; i < d->a.piece_count && json_array_size(d->regions) < REGIONS_MAX; ++i) {
        piece_kind kind = d->a.piece[i].kind;
        const char *bone = bone_of[kind];
        if (kind == PIECE_BODY && d->a.head_joint == MESH_NO_JOINT)
            bone = d->has_body ? "body" : "skull";
        if (bone && strcmp(bone, "jaw") == 0 && !d->has_jaw)
            bone = "skull";
        if (!d->a.has_face && kind == PIECE_RIDES && d->a.head_joint != MESH_NO_JOINT)
            bone = NULL;
        if (bone && !d->is_loose[i] && !is_same_as_earlier(d, i))
            add_rigid_pieces(d, bone, kind, i);
    }
}

/* ---- by position ---- */

static json_t *half_space(vec3 point, vec3 normal)
{
    return json_pack("{s{so, so}}", "half_space", "point", point_of(point), "normal",
                     point_of(normal));
}

static json_t *ellipsoid(vec3 centre, vec3 radii)
{
    return json_pack("{s{so, so}}", "ellipsoid", "centre", point_of(centre), "radii",
                     point_of(radii));
}

static json_t *box(vec3 low, vec3 high)
{
    return json_pack("{s{so, so}}", "box", "low", point_of(low), "high", point_of(high));
}

static void add_region(drafting *d, const char *bone, const char *key, json_t *value,
                       json_t *select)
{
    json_t *region = bone ? json_pack("{ss}", "bone", bone) : json_object();
    json_object_set_new(region, key, value);
    json_object_set_new(region, "select", select);
    json_array_append_new(d->regions, region);
}

/* Adds the region that cannot be pulled, for a head without a body. */
static void add_cranium(drafting *d)
{
    const rig_head *head = &d->head;
    double x = head->middle_x, depth = head->nose.z - head->back_z;
    vec3 top = {x, head->nose.y + 1.3 * d->reach_mm, 0.0};
    vec3 back = {x, head->nose.y, head->back_z + 0.42 * depth};
    vec3 neck = {x, head->chin.y - NECK * d->reach_mm, 0.0};
    add_region(d, "skull", "rigid", json_true(),
               of_face(d, json_pack("{s[ooo]}", "any", half_space(top, (vec3){0, 1, 0}),
                                    half_space(back, (vec3){0, 0, -1}),
                                    half_space(neck, (vec3){0, -1, 0}))));
    rig_note(&d->confirm,
             "region skull: rigid above y = %.0f mm, behind z = %.0f mm and below y = %.0f mm "
             "(neck)",
             top.y, back.z, neck.y);
}

/* Selects where the fill must be smooth: the front of the face, and pieces that follow it. */
static json_t *free_part(const drafting *d)
{
    const rig_head *head = &d->head;
    double depth = head->nose.z - head->back_z, reach = d->reach_mm, wide = 1.2 * head->half_width;
    json_t *list = json_array();
    if (d->a.has_face) {
        vec3 low = {head->middle_x - wide, head->chin.y - NECK * reach,
                    head->nose.z - 0.62 * depth};
        vec3 high = {head->middle_x + wide, head->nose.y + 1.1 * reach, head->nose.z + depth};
        json_array_append_new(list, of_face(d, box(low, high)));
    }
    for (uint32_t i = 0; i < d->a.piece_count && json_array_size(list) < REGIONS_MAX; ++i)
        if (d->a.piece[i].kind == PIECE_UNKNOWN)
            json_array_append_new(list, piece_select(&d->a.piece[i]));
    return any_of(list);
}

static json_t *beside(const drafting *d, json_t *select)
{
    return d->a.has_face ? json_pack("{s[o{so}]}", "all", select, "not", free_part(d)) : select;
}

/* Adds a region that moves wholly with a bone. On the skull, a head without a face can be
 * pulled like clay; otherwise the region cannot be pulled. */
static void add_held(drafting *d, const char *bone, json_t *select)
{
    bool is_clay = !d->a.has_face && strcmp(bone, "skull") == 0;
    json_array_append_new(d->regions, json_pack("{ss, si, si, so}", "bone", bone, "weight", 1,
                                                "mobility", is_clay, "select", select));
}

static double neck_softness(const drafting *d)
{
    const vec3 top = {d->a.neck.x, d->head.top_y, d->a.neck.z};
    return d->a.is_on_four_legs ? 0.3 * (d->head.top_y - d->a.legs_y)
           : d->a.has_face      ? 0.2 * vec3_dot(vec3_sub(top, d->a.neck), d->a.neck_up)
                                : 0.0;
}

/* Returns a point on the neck's axis, mm above the neck. */
static vec3 along_neck(const drafting *d, double mm)
{
    return vec3_add(d->a.neck, vec3_scale(d->a.neck_up, mm));
}

static bool is_of_body(const drafting *d, vec3 p)
{
    const vec3 from = along_neck(d, -neck_softness(d));
    return vec3_dot(vec3_sub(p, from), d->a.neck_up) < 0.0 ||
           (d->a.is_on_four_legs && p.y < d->a.legs_y);
}

/* Selects what is_of_body() accepts. */
static json_t *body_select(const drafting *d)
{
    json_t *list = json_array();
    json_array_append_new(
        list, half_space(along_neck(d, -neck_softness(d)), vec3_scale(d->a.neck_up, -1.0)));
    if (d->a.is_on_four_legs)
        json_array_append_new(list,
                              half_space((vec3){0.0, d->a.legs_y, 0.0}, (vec3){0.0, -1.0, 0.0}));
    return any_of(list);
}

/* Adds the regions of a head on a body. The file's skin decides which vertices turn with the head;
 * without a skin their place decides. */
static void add_body(drafting *d)
{
    if (d->a.head_joint != MESH_NO_JOINT) {
        const char *joint = d->m->joint[d->a.head_joint].name;
        add_held(d, "skull", beside(d, json_pack("{ss}", "joint", joint)));
        add_held(d, "body", beside(d, json_pack("{s{ss}}", "not", "joint", joint)));
        rig_note(&d->confirm,
                 "bones body and skull: vertices that follow the joint %s in the file's skin turn "
                 "with the head, %s",
                 joint, sure[BY_SKELETON]);
        return;
    }
    json_t *head = half_space(along_neck(d, neck_softness(d)), d->a.neck_up);
    if (d->a.is_on_four_legs) { /* leaves out the chest, which is below the head */
        const vec3 chest = {0.0, d->a.legs_y + neck_softness(d), 0.0};
        head = json_pack("{s[oo]}", "all", head, half_space(chest, (vec3){0.0, 1.0, 0.0}));
    }
    add_held(d, "skull", beside(d, of_face(d, head)));
    add_held(d, "body", of_face(d, body_select(d)));
    if (d->a.is_on_four_legs)
        rig_note(&d->confirm, "bones body and skull: the head ends behind z = %.0f mm, %s",
                 d->a.neck.z, sure[BY_SHAPE]);
    else
        rig_note(&d->confirm, "bones body and skull: the head ends at y = %.0f mm, %s", d->a.neck.y,
                 sure[BY_SHAPE]);
}

/* Selects vertices behind the lips that are deeper than deep_mm. */
static json_t *hidden_vertices(const drafting *d, double deep_mm)
{
    const uint32_t count = d->m->vertex_count;
    json_t *list = json_array();
    for (uint32_t v = 0; v < count; ++v) {
        uint32_t first = v;
        while (v < count && (double)d->a.hidden_mm[v] > deep_mm &&
               mesh_position(d->m, v).y < d->head.lip_upper_y + 0.3 * d->reach_mm)
            ++v;
        if (v > first)
            json_array_append_new(list, v == first + 1 ? json_integer((json_int_t)first)
                                                       : json_sprintf("%u-%u", first, v - 1));
    }
    return json_pack("{so}", "vertices", list);
}

/* Selects the skin around the eyes that were found, up to a number of eye radii. */
static json_t *around_eyes(const drafting *d, double radii)
{
    json_t *list = json_array();
    for (int i = 0; i < 2; ++i) {
        double r = radii * d->a.eye[i].radius_mm;
        if (d->a.eye[i].is_found)
            json_array_append_new(list, ellipsoid(d->a.eye[i].centre, (vec3){r, r, r}));
    }
    return json_pack("{so}", "any", list);
}

/* Adds the mobility of the face: 1 on the front, 0 deep in the mouth, on the lids and on the
 * neck. Vertices between these are filled, since the skin would fold if the mobility jumped
 * from one vertex to the next. */
static void add_mobile_face(drafting *d)
{
    const rig_head *head = &d->head;
    double depth = head->nose.z - head->back_z, reach = d->reach_mm;
    vec3 low = {head->middle_x - 0.8 * head->half_width, head->chin.y + 0.1 * reach,
                head->nose.z - 0.3 * depth};
    vec3 high = {head->middle_x + 0.8 * head->half_width, head->nose.y + 0.75 * reach,
                 head->nose.z + 0.1 * depth};
    vec3 neck = {head->middle_x, head->chin.y - 0.1 * reach, 0.0};
    bool has_eyes = d->a.eye[0].is_found || d->a.eye[1].is_found;
    json_t *front =
        json_pack("[o{so}]", box(low, high), "not", hidden_vertices(d, LIPS_DEEP * reach));
    if (has_eyes)
        json_array_append_new(front, json_pack("{so}", "not", around_eyes(d, EYE_FREE)));
    add_region(d, NULL, "mobility", json_integer(0),
               of_face(d, half_space(neck, (vec3){0, -1, 0})));
    add_region(d, NULL, "mobility", json_integer(1), of_face(d, json_pack("{so}", "all", front)));
    add_region(d, NULL, "mobility", json_integer(0), hidden_vertices(d, MOUTH_DEEP * reach));
    if (has_eyes)
        add_region(d, NULL, "mobility", json_integer(0), of_face(d, around_eyes(d, EYE_REACH)));
}

/* Adds a region that moves wholly with a bone, around a contact and on one side of the mouth. */
static void add_lip(drafting *d, const char *bone, const char *contact, double up)
{
    uint32_t vertex = contact_vertex(d, contact);
    if (vertex == RIG_NONE)
        return;
    /* Lips that are one surface at the back of an open mouth must be able to bend there. */
    double mm = fmin(0.15 * d->reach_mm, 0.3 * d->a.lips_mm);
    vec3 slit = {d->head.middle_x, 0.5 * (d->head.lip_upper_y + d->head.lip_lower_y), 0.0};
    json_t *within =
        json_pack("{s{sf, si}}", "within", "mm", round(10.0 * mm) / 10.0, "of", (int)vertex);
    add_region(d, bone, "weight", json_integer(1),
               json_pack("{s[oo]}", "all", within, half_space(slit, (vec3){0, up, 0})));
}

/* Adds the region that no jaw moves: from the nose upwards, and the middle of the upper lip. */
static void add_upper_face(drafting *d)
{
    const rig_head *head = &d->head;
    vec3 nose = {head->middle_x, head->nose.y, 0.0};
    vec3 lip = {head->middle_x, 0.5 * (head->nose.y + head->lip_upper_y), head->nose.z};
    vec3 radii = {0.25 * head->half_width, 0.4 * (head->nose.y - head->lip_upper_y),
                  0.5 * d->reach_mm};
    add_region(d, "skull", "weight", json_integer(1),
               of_face(d, json_pack("{s[oo]}", "any", half_space(nose, (vec3){0, 1, 0}),
                                    ellipsoid(lip, radii))));
}

static void note_mouth(drafting *d)
{
    if (d->no_mouth[0])
        rig_note(&d->confirm, "mouth: the lips cannot be sealed, since %s (likely)", d->no_mouth);
    else
        rig_note(&d->confirm,
                 "mouth: lips.seal brings its rims together, %u vertices of the upper lip and %u "
                 "of the lower one (likely)",
                 d->mouth.upper_count, d->mouth.lower_count);
}

/* Selects the skin of the chin: inside an ellipsoid and below the lips. A coarse mesh may have no
 * vertex there: then the vertex below the lips that is nearest to the chin. */
static json_t *select_chin(const drafting *d, vec3 chin, vec3 radii, vec3 lip)
{
    uint32_t nearest = RIG_NONE;
    double nearest_mm = (double)INFINITY;
    for (uint32_t v = 0; v < d->m->vertex_count; ++v) {
        const vec3 p = mesh_position(d->m, v), way = vec3_sub(p, chin);
        const vec3 part = {way.x / radii.x, way.y / radii.y, way.z / radii.z};
        if (!d->a.is_face[v] || !(p.y < lip.y))
            continue;
        if (vec3_length(part) < 1.0)
            return json_pack("{s[oo]}", "all", ellipsoid(chin, radii),
                             half_space(lip, (vec3){0, -1, 0}));
        if (vec3_length(way) < nearest_mm) {
            nearest_mm = vec3_length(way);
            nearest = v;
        }
    }
    return json_pack("{s[i]}", "vertices", (int)nearest);
}

static void add_jaw(drafting *d)
{
    const rig_head *head = &d->head;
    double reach = d->reach_mm;
    vec3 chin = {head->middle_x, head->chin.y + 0.12 * reach, head->chin.z};
    vec3 radii = {0.4 * head->half_width, 0.25 * reach, 0.35 * reach};
    vec3 lip = {head->middle_x, head->lip_lower_y - 0.05 * reach, 0.0};
    add_region(d, "jaw", "weight", json_integer(1), of_face(d, select_chin(d, chin, radii, lip)));
    if (!d->a.has_slit && d->a.has_parted_lips) {
        rig_note(&d->confirm,
                 "mouth: the skin between the lips would fold if they parted (certain). The face "
                 "is performed as clay, and the jaw only stretches the skin");
        return;
    }
    if (!d->a.has_slit) {
        rig_note(&d->confirm, "mouth: there is no slit between the lips (likely). The face is "
                              "performed as clay, and the jaw only stretches the skin. A mouth can "
                              "be cut (on the command line: marotte rig new --cut-mouth): this "
                              "opens the edges between the lips and adds a dark bag behind them");
        return;
    }
    add_lip(d, "skull", "lip.upper.mid", 1.0);
    add_lip(d, "jaw", "lip.lower.mid", -1.0);
    rig_note(&d->confirm,
             "regions jaw: the chin (an ellipsoid) and the lower lip below y = %.1f mm move with "
             "the jaw, the upper lip above it with the skull (likely)",
             head->mouth_y);
}

/* ---- lids ---- */

typedef struct lid_edges { /* angles above the eye's middle, seen from its centre, rad */
    double upper, lower;
} lid_edges;

/* Finds the upper and the lower edge of the skin in front of an eyeball. */
static bool find_lids(lid_edges *out, const drafting *d, const anatomy_eye *eye)
{
    bool has_upper = false, has_lower = false;
    double from = -1.2, to = 1.2;
    for (uint32_t v = 0; v < d->m->vertex_count; ++v) {
        vec3 p = vec3_sub(mesh_position(d->m, v), eye->centre);
        if (!d->a.is_face[v] || fabs(p.x) > 0.35 * eye->radius_mm || p.z < 0.25 * eye->radius_mm ||
            vec3_length(p) > LID_REACH * eye->radius_mm)
            continue;
        double up = atan2(p.y, p.z);
        if (up > 0.0 && up < to) {
            to = up;
            has_upper = true;
        }
        if (up <= 0.0 && up > from) {
            from = up;
            has_lower = true;
        }
    }
    *out = (lid_edges){to, from};
    return has_upper && has_lower && to - from > 0.12 && to - from < 1.7;
}

static void add_lid(drafting *d, const char *side, const char *which, const anatomy_eye *eye,
                    double sign, double edge, double close_rad)
{
    char name[RIG_NAME_MAX + 1];
    double r = eye->radius_mm;
    (void)snprintf(name, sizeof name, "lid_%s.%s", which, side);
    json_array_append_new(
        d->bones, json_pack("{ss, s{so, sf}, s[{ss, s[fii], s[ii]}]}", "name", name, "ball",
                            "centre", point_of(eye->centre), "radius_mm", round(10.0 * r) / 10.0,
                            "turns", "name", "close", "axis", sign, 0, 0, "deg",
                            sign > 0.0 ? -12 : -8, (int)floor(close_rad * degree_per_radian)));
    /* A plane through the axis of the ball, a little beyond the corners of the eye. */
    vec3 up = {0.0, sign * cos(0.5 * edge), -sign * sin(0.5 * edge)};
    vec3 front = {eye->centre.x, eye->centre.y, eye->centre.z + 0.25 * r};
    vec3 radii = {LID_REACH * r, LID_REACH * r, LID_REACH * r};
    add_region(
        d, name, "weight", json_integer(1),
        of_face(d, json_pack("{s[ooo]}", "all", ellipsoid(eye->centre, radii),
                             half_space(front, (vec3){0, 0, 1}), half_space(eye->centre, up))));
}

/* Adds lids that are part of the skin: a band around the ball that moves with the lid, and the
 * skin beyond it, which stays on the skull. */
static void draft_lids(drafting *d)
{
    static const char *const sides[] = {"l", "r"};
    for (int i = 0; i < 2; ++i) {
        const anatomy_eye *eye = &d->a.eye[i];
        lid_edges edges;
        if (!eye->is_found || !find_lids(&edges, d, eye))
            continue;
        double r = eye->radius_mm, gap = edges.upper - edges.lower;
        vec3 far = {1.8 * r, 1.7 * r, 1.8 * r}, wide = {2.6 * r, 2.2 * r, 2.5 * r};
        vec3 low = vec3_sub(eye->centre, wide), high = vec3_add(eye->centre, wide);
        add_region(d, "skull", "weight", json_integer(1),
                   of_face(d, json_pack("{s[o{so}]}", "all", box(low, high), "not",
                                        ellipsoid(eye->centre, far))));
        add_lid(d, sides[i], "upper", eye, 1.0, edges.upper, 0.75 * gap);
        add_lid(d, sides[i], "lower", eye, -1.0, -edges.lower, 0.25 * gap);
        rig_note(&d->confirm,
                 "bones lid_upper.%s and lid_lower.%s: the skin around the eyeball, %.0f degrees "
                 "open (a guess)",
                 sides[i], sides[i], gap * degree_per_radian);
    }
}

static void add_patches(drafting *d)
{
    for (uint32_t i = 0; i < d->patch_count; ++i) {
        double r = d->patch[i].radius_mm;
        add_region(d, "jaw", "weight", json_real(0.5),
                   of_face(d, ellipsoid(d->patch[i].at, (vec3){r, r, r})));
    }
}

/* ---- the whole rig ---- */

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to draft a rig");
}

static void add_ball(drafting *d, const char *name, const char *parent, vec3 centre,
                     double radius_mm, json_t *turns)
{
    json_t *bone = json_pack("{ss, s{so}, so}", "name", name, "ball", "centre", point_of(centre),
                             "turns", turns);
    if (radius_mm > 0.0)
        json_object_set_new(json_object_get(bone, "ball"), "radius_mm",
                            rig_number_to_json(round(10.0 * radius_mm) / 10.0));
    if (parent)
        json_object_set_new(bone, "parent", json_string(parent));
    json_array_append_new(d->bones, bone);
}

static json_t *turn_of(const char *name, vec3 axis, int most)
{
    return json_pack("{ss, s[iii], s[ii]}", "name", name, "axis", (int)axis.x, (int)axis.y,
                     (int)axis.z, "deg", -most, most);
}

static void draft_skull(drafting *d)
{
    if (!d->has_body) {
        json_array_append_new(d->bones, json_pack("{ss}", "name", "skull"));
        return;
    }
    json_array_append_new(d->bones, json_pack("{ss, sn}", "name", "body", "parent"));
    add_ball(d, "skull", "body", d->a.neck, 0.0,
             json_pack("[ooo]", turn_of("turn", (vec3){0, 1, 0}, 60),
                       turn_of("nod", (vec3){1, 0, 0}, 30), turn_of("tilt", (vec3){0, 0, 1}, 25)));
    rig_note(&d->confirm, "bone skull: turns about (%.1f, %.1f, %.1f) mm on the body, %s",
             d->a.neck.x, d->a.neck.y, d->a.neck.z, sure[d->a.source]);
}

static void draft_eyes(drafting *d)
{
    static const char *const names[] = {"eye.l", "eye.r"};
    for (int i = 0; i < 2; ++i) {
        const anatomy_eye *eye = &d->a.eye[i];
        if (!eye->is_found)
            continue;
        add_ball(d, names[i], NULL, eye->centre, eye->radius_mm,
                 json_pack("[oo]", turn_of("yaw", (vec3){0, 1, 0}, 35),
                           turn_of("pitch", (vec3){-1, 0, 0}, 25)));
        rig_note(
            &d->confirm,
            "bone %s: turns about (%.1f, %.1f, %.1f) mm, the centre of a ball of %.1f mm (likely)",
            names[i], eye->centre.x, eye->centre.y, eye->centre.z, eye->radius_mm);
    }
}

/* Jaw joints of human heads (theory 4.2) are 0.44 of the way from chin to top and 0.55 of the way
 * from back to front. They are a little inside the sides of the face. A skeleton or ears give a
 * better place. */
enum { CLAY_OPEN_DEG = 10 }; /* for a jaw that only stretches the skin */

static void draft_jaw(drafting *d)
{
    const rig_head *head = &d->head;
    vec3 left = {head->middle_x + 0.78 * head->half_width,
                 head->chin.y + 0.44 * (head->top_y - head->chin.y),
                 head->back_z + 0.55 * (head->nose.z - head->back_z)};
    anatomy_source source = BY_SHAPE;
    if (d->a.has_ears) {
        left.y = d->a.ear.y;
        left.z = d->a.ear.z;
    }
    if (d->a.jaw_joint != MESH_NO_JOINT) {
        const float *rest = d->m->joint[d->a.jaw_joint].rest;
        left.y = (double)rest[7];
        left.z = (double)rest[11];
        source = BY_SKELETON;
    }
    vec3 right = {2.0 * head->middle_x - left.x, left.y, left.z};
    vec3 incisor = {head->middle_x, head->mouth_y, head->mouth_z - 0.08 * d->reach_mm};
    double turn_mm = hypot(incisor.y - left.y, incisor.z - left.z);
    /* Open far enough that the incisors part by 50 mm on a head of 225 mm (theory 4.2). Without
     * a slit the jaw only stretches the skin. */
    double gap_mm = 50.0 / 225.0 * (head->top_y - head->chin.y);
    double open =
        2.0 * asin(fmin(0.5 * gap_mm / fmax(turn_mm, 0.5 * gap_mm), 1.0)) * degree_per_radian;
    int open_deg = (int)fmin(fmax(round(open), 16.0), 32.0);
    double size = (head->top_y - head->chin.y) / 225.0; /* scale of an adult's numbers */
    json_array_append_new(
        d->bones, json_pack("{ss, s{so, so}, s[ii], so, so, so, so}", "name", "jaw", "hinge",
                            "left", point_of(left), "right", point_of(right), "open_deg", 0,
                            d->a.has_slit ? open_deg : CLAY_OPEN_DEG, "lateral_mm",
                            rig_number_to_json(round(100.0 * size) / 10.0), "forward_mm",
                            rig_number_to_json(round(80.0 * size) / 10.0), "slide_mm",
                            rig_number_to_json(d->a.has_slit ? round(60.0 * size) / 10.0 : 0.0),
                            "incisor", point_of(incisor)));
    rig_note(
        &d->confirm,
        "bone jaw: turns about the line through (%.1f, %.1f, %.1f) and its mirror image, mm, %s",
        left.x, left.y, left.z,
        source != BY_SHAPE ? sure[source]
        : d->a.has_ears    ? "beside the holes of the ears (likely)"
                           : "by the proportions of heads (likely)");
    rig_note(
        &d->confirm,
        "bone jaw: the edge of the lower front teeth is assumed at (%.1f, %.1f, %.1f) mm (a guess)",
        incisor.x, incisor.y, incisor.z);
}

static void find_skull(const drafting *d, vec3 *out_centre, vec3 *out_radii)
{
    const rig_head *head = &d->head;
    double height = head->top_y - head->chin.y, depth = head->nose.z - head->back_z;
    *out_centre = (vec3){head->middle_x, head->chin.y + 0.6 * height, head->back_z + 0.45 * depth};
    *out_radii = (vec3){0.85 * head->half_width, 0.36 * height, 0.36 * depth};
}

static json_t *draft_proxy(drafting *d)
{
    vec3 centre, radii;
    find_skull(d, &centre, &radii);
    rig_note(
        &d->confirm,
        "skull_proxy: one ellipsoid that the skin cannot enter; check that it is below the skin");
    return json_pack("[{s{so, so, ss}}]", "ellipsoid", "centre", point_of(centre), "radii",
                     point_of(radii), "bone", "skull");
}

/* ---- loose parts ----
 *
 * Hair, ears and hats that hang on the head swing: chains of joints that VRM swings or that are
 * named so, and pieces of such a name that stick out. */

typedef struct loose_kind {
    const char *word; /* in the name of the joint or part; also the name of the bone */
    double frequency_hz, damping;
    int most_deg;
    double out; /* least length of a piece from its root, in heights of the head */
} loose_kind;

static const loose_kind loose_kinds[] = {
    {"ponytail", 2.2, 0.3, 20, 0.25}, {"pigtail", 2.2, 0.3, 20, 0.25},
    {"braid", 2.2, 0.3, 20, 0.25},    {"antenna", 3.0, 0.15, 20, 0.15},
    {"feather", 3.0, 0.2, 20, 0.15},  {"tassel", 2.5, 0.2, 25, 0.1},
    {"ribbon", 2.5, 0.3, 20, 0.1},    {"earring", 3.0, 0.2, 25, 0.05},
    {"ear", 4.0, 0.25, 14, 0.12},     {"tuft", 3.0, 0.25, 18, 0.1},
    {"hair", 2.5, 0.3, 12, 0.35},     {"hat", 3.0, 0.35, 8, 0.35}};
enum { LOOSE_KINDS = sizeof loose_kinds / sizeof *loose_kinds, LOOSE_MOST = 6 };
static const loose_kind loose_joint = {"spring", 2.5, 0.3, 15, 0.05}; /* of VRM, without a word */
#define LOOSE_HELD 0.25 /* of a piece's way out of the skull: up to here it rides on the skull */
#define LOOSE_FREE 0.7  /* from here it rides on its own bone */

typedef struct loose_part {
    const loose_kind *kind;
    vec3 root, tip;      /* mm */
    json_t *free, *held; /* selectors; held NULL: the file's skin gives the shares */
    const char *name;    /* of the joint or part */
    anatomy_source source;
} loose_part;

/* True if the word stands alone: "Hair_01", "ear.l", "frontHair", but not "gear". */
static bool has_word(const char *name, const char *word)
{
    for (const char *at = name; *at; ++at) {
        size_t i = 0;
        while (word[i] && tolower((unsigned char)at[i]) == word[i])
            ++i;
        bool begins = at == name || !isalpha((unsigned char)at[-1]) ||
                      (islower((unsigned char)at[-1]) && isupper((unsigned char)at[0]));
        const char *end = at[i] == 's' ? at + i + 1 : at + i;
        if (!word[i] && begins && !islower((unsigned char)*end))
            return true;
    }
    return false;
}

static const loose_kind *loose_kind_of(const char *name)
{
    for (int i = 0; i < LOOSE_KINDS; ++i)
        if (has_word(name, loose_kinds[i].word))
            return &loose_kinds[i];
    return NULL;
}

static bool has_bone(const drafting *d, const char *name)
{
    size_t i;
    json_t *bone;
    json_array_foreach(d->bones, i, bone)
    {
        if (strcmp(json_string_value(json_object_get(bone, "name")), name) == 0)
            return true;
    }
    return false;
}

/* Rounds to 0.01. */
static json_t *axis_of(vec3 axis)
{
    return json_pack("[ooo]", rig_number_to_json(round(100.0 * axis.x) / 100.0),
                     rig_number_to_json(round(100.0 * axis.y) / 100.0),
                     rig_number_to_json(round(100.0 * axis.z) / 100.0));
}

static json_t *swing_of(const char *name, vec3 axis, int most_deg)
{
    return json_pack("{ss, so, s[ii]}", "name", name, "axis", axis_of(axis), "deg", -most_deg,
                     most_deg);
}

static void add_loose_region(drafting *d, const char *bone, json_t *select)
{
    json_array_append_new(d->regions, json_pack("{ss, si, si, so}", "bone", bone, "weight", 1,
                                                "mobility", 0, "select", select));
}

/* Takes the selectors. */
static void add_loose_part(drafting *d, const loose_part *p)
{
    const vec3 arm = vec3_normalised(vec3_sub(p->tip, p->root), (vec3){0, 1, 0});
    const double side = p->tip.x - d->head.middle_x, height = d->head.top_y - d->head.chin.y;
    const char *suffix = side > 0.12 * height ? ".l" : side < -0.12 * height ? ".r" : "";
    char name[32];
    (void)snprintf(name, sizeof name, "%s%s", p->kind->word, suffix);
    for (int n = 2; has_bone(d, name); ++n)
        (void)snprintf(name, sizeof name, "%s%d%s", p->kind->word, n, suffix);
    json_t *turns;
    if (fabs(arm.x) < 0.7) {
        const vec3 x = {1, 0, 0}, aside = vec3_normalised(vec3_cross(arm, x), (vec3){0, 0, 1});
        turns = json_pack("[oo]", swing_of("nod", x, p->kind->most_deg),
                          swing_of("sway", aside, p->kind->most_deg));
    } else { /* both sides swing forwards and up in the same sense */
        const double to = arm.x > 0.0 ? 1.0 : -1.0;
        turns = json_pack("[oo]", swing_of("flap", (vec3){0, -to, 0}, p->kind->most_deg),
                          swing_of("lift", (vec3){0, 0, to}, p->kind->most_deg));
    }
    add_ball(d, name, NULL, p->root, 0.0, turns);
    json_object_set_new(json_array_get(d->bones, json_array_size(d->bones) - 1), "spring",
                        json_pack("{so, so, so, so, so}", "tip", point_of(p->tip), "frequency_hz",
                                  rig_number_to_json(p->kind->frequency_hz), "damping",
                                  rig_number_to_json(p->kind->damping), "inertia",
                                  rig_number_to_json(0.5), "gravity", rig_number_to_json(0.1)));
    if (p->held)
        add_loose_region(d, "skull", p->held);
    add_loose_region(d, name, p->free);
    rig_note(&d->confirm, "bone %s: \"%s\" swings when the head moves, %s", name, p->name,
             sure[p->source]);
}

/* ---- chains of joints ---- */

static bool is_below(const mesh *m, uint32_t joint, uint32_t above)
{
    while (joint != MESH_NO_JOINT && joint != above)
        joint = m->joint[joint].parent;
    return joint == above;
}

static bool is_loose_joint(const mesh_joint *joint)
{
    const bool is_of_vrm = joint->role && strcmp(joint->role, "spring") == 0;
    return is_of_vrm || (!(joint->role && joint->role[0]) && loose_kind_of(joint->name));
}

/* Computes the middle of the vertices that follow the joint and those below it. Returns their
 * number, in whole shares. */
static double measure_joint(const drafting *d, uint32_t joint, vec3 *out_middle)
{
    const mesh *m = d->m;
    vec3 sum = {0, 0, 0};
    double shares = 0.0;
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        for (uint32_t k = 0; k < MESH_SKIN_WIDTH; ++k) {
            const size_t at = (size_t)v * MESH_SKIN_WIDTH + k;
            const double share = (double)m->skin_weight[at];
            if (!(share > 0.0) || !is_below(m, m->skin_joint[at], joint))
                continue;
            sum = vec3_add(sum, vec3_scale(mesh_position(m, v), share));
            shares += share;
        }
    *out_middle = vec3_scale(sum, 1.0 / fmax(shares, 1.0));
    return shares;
}

/* Marks the pieces that mostly follow the joint: they must not be rigid. */
static void mark_loose_pieces(drafting *d, uint32_t joint)
{
    for (uint32_t i = 0; i < d->a.piece_count; ++i) {
        const anatomy_piece *p = &d->a.piece[i];
        uint32_t count = 0;
        for (uint32_t k = 0; p->kind == PIECE_RIDES && k < p->point_count; ++k) {
            const uint32_t v = d->a.member[p->first_member + k];
            count += is_below(d->m, d->m->skin_joint[(size_t)v * MESH_SKIN_WIDTH], joint);
        }
        d->is_loose[i] |= count > 0;
    }
}

static uint32_t draft_loose_joints(drafting *d)
{
    const mesh *m = d->m;
    const double height = d->head.top_y - d->head.chin.y;
    uint32_t count = 0;
    for (uint32_t j = 0; d->a.head_joint != MESH_NO_JOINT && m->skin_joint && j < m->joint_count &&
                         count < LOOSE_MOST;
         ++j) {
        const mesh_joint *joint = &m->joint[j];
        const loose_kind *kind = loose_kind_of(joint->name);
        if (j == d->a.head_joint || !is_loose_joint(joint) || !joint->name[0] ||
            !is_below(m, j, d->a.head_joint) || is_loose_joint(&m->joint[joint->parent]))
            continue;
        loose_part part = {
            .kind = kind ? kind : &loose_joint,
            .root = {(double)joint->rest[3], (double)joint->rest[7], (double)joint->rest[11]},
            .name = joint->name,
            .source = BY_SKELETON};
        const double shares = measure_joint(d, j, &part.tip);
        if (shares < 12.0 || shares > 0.5 * d->m->vertex_count ||
            vec3_length(vec3_sub(part.tip, part.root)) < 0.04 * height)
            continue;
        part.free = json_pack("{ss}", "joint", joint->name);
        mark_loose_pieces(d, j);
        add_loose_part(d, &part);
        count += 1;
    }
    return count;
}

/* ---- pieces that stick out ---- */

static double out_of_skull(vec3 p, vec3 centre, vec3 radii)
{
    const vec3 way = vec3_sub(p, centre);
    return vec3_length((vec3){way.x / radii.x, way.y / radii.y, way.z / radii.z});
}

/* Of the pieces of one part, on one side for ears: the ends of the way out of the skull. */
typedef struct loose_pieces {
    const loose_kind *kind;
    uint32_t part;
    int side;
} loose_pieces;

static int side_of(const drafting *d, const anatomy_piece *p, const loose_kind *kind)
{
    const bool is_pair = strcmp(kind->word, "ear") == 0 || strcmp(kind->word, "earring") == 0;
    return !is_pair ? 0 : p->mean.x > d->head.middle_x ? 1 : -1;
}

static bool is_among(const drafting *d, uint32_t piece, const loose_pieces *of)
{
    const anatomy_piece *p = &d->a.piece[piece];
    return p->kind == PIECE_RIDES && p->part == of->part && !d->is_loose[piece] &&
           side_of(d, p, of->kind) == of->side;
}

/* Returns the middle of their points between two places on the way out. */
static vec3 middle_of(const drafting *d, const loose_pieces *of, double from, double to,
                      uint32_t *out_count)
{
    vec3 centre, radii, sum = {0, 0, 0};
    find_skull(d, &centre, &radii);
    *out_count = 0;
    for (uint32_t i = 0; i < d->a.piece_count; ++i)
        for (uint32_t k = 0; is_among(d, i, of) && k < d->a.piece[i].point_count; ++k) {
            const vec3 p = mesh_position(d->m, d->a.member[d->a.piece[i].first_member + k]);
            const double out = out_of_skull(p, centre, radii);
            if (out < from || out > to)
                continue;
            sum = vec3_add(sum, p);
            *out_count += 1;
        }
    return vec3_scale(sum, 1.0 / fmax(*out_count, 1.0));
}

static bool draft_loose_pieces_of(drafting *d, const loose_pieces *of)
{
    vec3 centre, radii;
    double low = INFINITY, high = 0.0;
    const double height = d->head.top_y - d->head.chin.y;
    find_skull(d, &centre, &radii);
    for (uint32_t i = 0; i < d->a.piece_count; ++i)
        for (uint32_t k = 0; is_among(d, i, of) && k < d->a.piece[i].point_count; ++k) {
            const vec3 p = mesh_position(d->m, d->a.member[d->a.piece[i].first_member + k]);
            low = fmin(low, out_of_skull(p, centre, radii));
            high = fmax(high, out_of_skull(p, centre, radii));
        }
    const double held = low + LOOSE_HELD * (high - low),
                 free_from = low + LOOSE_FREE * (high - low);
    uint32_t held_count, free_count;
    loose_part part = {.kind = of->kind, .name = part_name(d, of->part), .source = BY_NAME};
    part.root = middle_of(d, of, 0.0, held, &held_count);
    part.tip = middle_of(d, of, free_from, INFINITY, &free_count);
    if (held_count < 6 || free_count < 6 ||
        vec3_length(vec3_sub(part.tip, part.root)) < of->kind->out * height)
        return false;
    const vec3 arm = vec3_normalised(vec3_sub(part.tip, part.root), (vec3){0, 1, 0});
    if (strcmp(of->kind->word, "hat") == 0 && arm.y < 0.7)
        return false; /* a brim is wide, but holds still */
    json_t *list = json_array();
    for (uint32_t i = 0; i < d->a.piece_count; ++i)
        if (is_among(d, i, of))
            json_array_append_new(list, piece_select(&d->a.piece[i]));
    json_t *all = any_of(list);
    part.held = json_pack("{s[Oo]}", "all", all, ellipsoid(centre, vec3_scale(radii, held)));
    part.free =
        json_pack("{s[o{so}]}", "all", all, "not", ellipsoid(centre, vec3_scale(radii, free_from)));
    for (uint32_t i = 0; i < d->a.piece_count; ++i)
        d->is_loose[i] |= is_among(d, i, of);
    add_loose_part(d, &part);
    return true;
}

static void draft_loose_parts(drafting *d)
{
    uint32_t count = draft_loose_joints(d);
    for (uint32_t i = 0; i < d->a.piece_count && count < LOOSE_MOST; ++i) {
        const anatomy_piece *p = &d->a.piece[i];
        const loose_kind *kind =
            p->kind == PIECE_RIDES ? loose_kind_of(part_name(d, p->part)) : NULL;
        if (!kind || d->is_loose[i])
            continue;
        bool is_known = false;
        const loose_pieces of = {kind, p->part, side_of(d, p, kind)};
        for (uint32_t k = 0; k < i; ++k)
            is_known |= is_among(d, k, &of);
        count += !is_known && draft_loose_pieces_of(d, &of);
    }
}

/* Finds out whether the jaw and the body have vertices. */
static void find_bones(drafting *d)
{
    const rig_anatomy *a = &d->a;
    const double lip_y = d->head.lip_lower_y - 0.05 * d->reach_mm;
    bool is_bare = d->ambition >= WITHOUT_BONES;
    d->has_jaw = d->has_body = false;
    for (uint32_t v = 0; !is_bare && v < d->m->vertex_count; ++v) {
        const vec3 p = mesh_position(d->m, v);
        const bool has_skin = a->head_joint != MESH_NO_JOINT;
        d->has_jaw = d->has_jaw || (a->has_face && a->is_face[v] && p.y < lip_y);
        d->has_body =
            d->has_body || (a->has_body && (has_skin ? !a->is_head[v]
                                            : a->of_vertex[v] == a->face
                                                ? is_of_body(d, p)
                                                : a->piece[a->of_vertex[v]].kind == PIECE_BODY));
    }
    if (a->has_face && !d->has_jaw)
        rig_note(&d->confirm, "bone jaw: left out, since no skin lies below the mouth");
}

static json_t *draft_document(drafting *d, const char *mesh_name)
{
    d->bones = json_array();
    d->regions = json_array();
    d->contacts = json_array();
    find_bones(d);
    draft_skull(d);
    double size_mm = d->a.has_face ? d->head.top_y - d->head.chin.y : 200.0;
    if (d->a.has_face && d->has_jaw)
        draft_jaw(d);
    if (d->a.has_face) {
        if (d->ambition < WITHOUT_PIECES)
            draft_eyes(d);
        draft_contacts(d);
        add_mobile_face(d);
        add_upper_face(d);
        if (d->ambition < WITHOUT_LIDS)
            draft_lids(d);
        note_mouth(d);
    }
    if (d->a.has_face && d->has_jaw) {
        add_jaw(d);
        add_patches(d);
    }
    if (d->has_body)
        add_body(d);
    else if (d->a.has_face)
        add_cranium(d);
    else
        add_held(d, "skull",
                 half_space((vec3){0.0, d->a.piece[d->a.face].low.y - 1.0, 0.0}, (vec3){0, 1, 0}));
    memset(d->is_loose, 0, d->a.piece_count);
    if (d->ambition < WITHOUT_LIDS && d->has_body && d->a.has_face)
        draft_loose_parts(d);
    if (d->ambition < WITHOUT_PIECES)
        draft_pieces(d);
    double radius_mm = round(0.27 * size_mm);
    rig_note(&d->confirm, "solver: radius %.0f mm, a quarter of the head", radius_mm);
    return json_pack("{si, ss, ss, si, so, so, so, so, s{ss, so, ss}}", "marotte_rig", 1, "mesh",
                     mesh_name, "unit", "mm", "mesh_vertices", (int)d->m->vertex_count, "bones",
                     d->bones, "regions", d->regions, "contacts", d->contacts, "skull_proxy",
                     d->a.has_face ? draft_proxy(d) : json_array(), "solver", "kernel",
                     "wendland_c2", "radius_mm", rig_number_to_json(radius_mm), "polynomial",
                     "none");
}

/* Serialises the draft and parses it again, so that it goes through the same checks as any rig
 * file. */
static mrt_result parse_draft(rig *out, const json_t *document, const char *mesh_path,
                              const char *mesh_name, error *err)
{
    char *text = document ? json_dumps(document, 0) : NULL;
    if (!text)
        return no_memory(err);
    mrt_result result = rig_parse(out, text, strlen(text), "draft", err);
    free(text);
    if (result < 0)
        return result;
    rig_document_destroy(out->document);
    out->document = NULL;
    free(out->name);
    free(out->mesh_path);
    size_t length = strcspn(mesh_name, ".");
    out->name = text_duplicate(mesh_name, length < RIG_NAME_MAX ? length : RIG_NAME_MAX);
    out->mesh_path = strdup(mesh_path);
    if (out->name && out->mesh_path)
        return MRT_OK;
    rig_destroy(out);
    return no_memory(err);
}

static void note_assumptions(drafting *d)
{
    const rig_head *head = &d->head;
    if (d->a.head_count > 1)
        rig_note(&d->confirm, "heads: the mesh has %u heads; only the one in front is performed",
                 d->a.head_count);
    if (!d->a.has_face) {
        rig_note(&d->confirm,
                 "face: no face was found; the head can turn, and is pulled like clay");
        return;
    }
    rig_note(&d->confirm,
             "unit: the head is %.0f mm from chin to top; is this the size of the puppet?",
             head->top_y - head->chin.y);
    rig_note(&d->confirm, "symmetry: left and right are mirror images across x = %.2f mm",
             head->middle_x);
    rig_note(&d->confirm,
             "face: the tip of the nose is at y = %.1f mm, the mouth at %.1f mm, the end of the "
             "chin at %.1f mm, %s. All places below are derived from these",
             head->nose.y, head->mouth_y, head->chin.y,
             d->a.is_mouth_of_shape
                 ? "by its shape, and the mouth by the file's shape that opens it (certain)"
                 : doubted[head->doubt]);
    if (head->doubt != HEAD_NO_DOUBT)
        rig_note(&d->confirm, "face: look at it with marotte rig show. If the face is elsewhere, "
                              "turn the mesh with --up and --forward, or draft its head alone");
}

static mrt_result draft_once(rig *out, drafting *d, const char *mesh_path, error *err)
{
    const char *slash = strrchr(mesh_path, '/'), *mesh_name = slash ? slash + 1 : mesh_path;
    free(d->confirm);
    d->confirm = NULL;
    note_assumptions(d);
    json_t *document = draft_document(d, mesh_name);
    mrt_result result = parse_draft(out, document, mesh_path, mesh_name, err);
    json_decref(document);
    if (result < 0)
        return result;
    out->mm_per_unit = d->m->mm_per_unit;
    out->mesh_vertex_count = d->m->vertex_count;
    out->mesh_hash = rig_mesh_hash(d->m->vertex_count, d->m->triangle, d->m->triangle_count);
    result = rig_validate(out, d->m, d->t, err);
    if (result < 0)
        rig_destroy(out);
    return result;
}

/* ---- tested for folds ---- */

/* Finds where an open jaw folds the skin at the end of the slit. There the weights of two bones
 * meet within one triangle. A small patch with one weight bends as a whole instead. */
static mrt_result find_patch(drafting *d, const rig *r, bool *out_found, error *err)
{
    face *f = NULL;
    float dof[MRT_MAX_DOFS] = {0};
    vec3 at = {0, 0, 0};
    mrt_result result = face_create(&f, r, d->m, d->t, 0, err);
    *out_found = false;
    if (result < 0)
        return result;
    const bones *b = face_bones(f);
    if (b->jaw != RIG_NONE && d->a.has_slit && d->patch_count + 2 <= PATCHES_MAX) {
        dof[b->first_dof[b->jaw]] = (float)r->bone[b->jaw].open_max_rad;
        result = face_pull(f, NULL, dof, err);
        double determinant = result < 0 ? 1.0 : face_worst_triangle(f, &at);
        double size = d->patch_count < 4 ? 0.05 : d->patch_count < 8 ? 0.08 : 0.12;
        *out_found = determinant < 0.3 && fabs(at.y - d->head.mouth_y) < 0.25 * d->reach_mm &&
                     fabs(at.x - d->head.middle_x) > 0.1 * d->head.half_width;
        for (int side = 0; *out_found && side < 2; ++side) {
            d->patch[d->patch_count++] = (patch){at, size * d->reach_mm};
            at.x = 2.0 * d->head.middle_x - at.x;
        }
    }
    face_destroy(f);
    return result;
}

/* One direction of a degree of freedom: from rest to one end of its range in the rig. */
typedef struct freedom {
    double *end;
    uint32_t dof;
    bool is_lid, is_lower_lid, is_eye, is_jaw_open;
    bool is_mirrored; /* the other side has the same limit */
} freedom;

enum { FREEDOMS_MAX = 2 * MRT_MAX_DOFS, TRIES = 48, BISECTIONS = 6 };
static const double determinant_least = 0.12;

static uint32_t list_freedoms(freedom *out, rig *r, const bones *b)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < r->bone_count; ++i) {
        rig_bone *bone = &r->bone[i];
        uint32_t first = b->first_dof[i];
        bool is_lid = strncmp(bone->name, "lid_", 4) == 0;
        bool is_lower = strncmp(bone->name, "lid_lower", 9) == 0;
        bool is_eye = strncmp(bone->name, "eye.", 4) == 0;
        if (bone->kind == BONE_JAW) {
            out[count++] = (freedom){&bone->open_max_rad, first, .is_jaw_open = true};
            out[count++] = (freedom){&bone->lateral_mm, first + 1, .is_mirrored = true};
            out[count++] = (freedom){&bone->forward_mm, first + 2, .is_mirrored = false};
        }
        for (uint32_t k = 0; k < bone->turn_count; ++k) {
            double *const end[2] = {&bone->turn[k].max_rad, &bone->turn[k].min_rad};
            for (int e = 0; e < 2; ++e)
                out[count++] = (freedom){.end = end[e],
                                         .dof = first + k,
                                         .is_lid = is_lid,
                                         .is_lower_lid = is_lower,
                                         .is_eye = is_eye};
        }
    }
    return count;
}

static double determinant_of(face *f, const float *dof)
{
    return face_pull(f, NULL, dof, NULL) < 0 ? -1.0 : face_min_determinant(f);
}

/* Tests one freedom alone, at a part of the way to its end. If one limit holds for both sides,
 * tests the other side too, since heads are not always mirror images. */
static bool folds_alone(face *f, const freedom *one, double part)
{
    float dof[MRT_MAX_DOFS] = {0};
    dof[one->dof] = (float)(part * *one->end);
    if (determinant_of(f, dof) < determinant_least)
        return true;
    dof[one->dof] = -dof[one->dof];
    return one->is_mirrored && determinant_of(f, dof) < determinant_least;
}

static double part_without_fold(face *f, const freedom *one)
{
    double low = 0.0, high = 1.0;
    if (!folds_alone(f, one, 1.0))
        return 1.0;
    for (int i = 0; i < BISECTIONS; ++i) {
        double part = 0.5 * (low + high);
        if (!folds_alone(f, one, part))
            low = part;
        else
            high = part;
    }
    return low;
}

static bool lids_fold(face *f, const freedom *all, uint32_t count, double lower, double upper)
{
    float dof[MRT_MAX_DOFS] = {0};
    for (uint32_t i = 0; i < count; ++i)
        if (all[i].is_lid && *all[i].end > 0.0)
            dof[all[i].dof] = (float)((all[i].is_lower_lid ? lower : upper) * *all[i].end);
    return determinant_of(f, dof) < 0.5 * determinant_least;
}

/* Closes all lids. Where that folds the skin between them, the lower ones close less, then the
 * upper ones, too: a blink is the upper lid's motion. */
static void let_lids_close(drafting *d, face *f, const freedom *all, uint32_t count)
{
    double lower = 1.0, upper = 1.0;
    while (lower > 0.05 && lids_fold(f, all, count, lower, upper))
        lower *= 0.85;
    while (upper > 0.2 && lids_fold(f, all, count, lower, upper))
        upper *= 0.92;
    for (uint32_t i = 0; i < count; ++i)
        if (all[i].is_lid && *all[i].end > 0.0)
            *all[i].end *= all[i].is_lower_lid ? lower : upper;
    if (lower < 1.0)
        rig_note(
            &d->confirm,
            "lids: the lower ones close by %.0f %% of their range, the upper ones by %.0f %%, so "
            "that the skin between them does not fold (certain)",
            100.0 * lower, 100.0 * upper);
}

static double drawn(uint64_t *seed) /* 0..1, xorshift (Marsaglia 2003) */
{
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return (double)(*seed >> 11) * 0x1p-53;
}

/* Tests random combinations. Returns the factor by which all ranges must shrink until nothing
 * folds. */
static double part_together(face *f, const freedom *all, uint32_t count)
{
    double part = 1.0;
    uint64_t seed = 88172645463325252u;
    for (int i = 0; i < TRIES; ++i) {
        float dof[MRT_MAX_DOFS] = {0}, scaled[MRT_MAX_DOFS];
        for (uint32_t k = 0; k < count; ++k) {
            double way = drawn(&seed);
            if (drawn(&seed) < 0.7)
                dof[all[k].dof] = (float)(way * *all[k].end);
        }
        for (;; part *= 0.92) {
            memcpy(scaled, dof, sizeof scaled);
            for (uint32_t k = 0; k < count; ++k)
                if (!all[k].is_eye)
                    scaled[all[k].dof] = (float)part * dof[all[k].dof];
            if (part < 0.2 || determinant_of(f, scaled) >= 0.5 * determinant_least)
                break;
        }
    }
    return part;
}

/* shares of the eye's pitch, which is positive upwards */
static const double upper_lid_follows = -0.6, lower_lid_follows = 0.25;

/* Makes the lids follow the gaze. The tests for folds run without this: a lid that follows
 * stays within its limits, so it adds no fold, and no eye is held back because of its lid. */
static void add_follows(rig *r, drafting *d)
{
    const struct {
        const char *lid, *eye;
        double share;
    } all[] = {{"lid_upper.l", "eye.l.pitch", upper_lid_follows},
               {"lid_upper.r", "eye.r.pitch", upper_lid_follows},
               {"lid_lower.l", "eye.l.pitch", lower_lid_follows},
               {"lid_lower.r", "eye.r.pitch", lower_lid_follows}};
    bool any = false;
    for (size_t i = 0; i < sizeof all / sizeof *all; ++i) {
        rig_follow follows = {.share = all[i].share};
        uint32_t lid = rig_find_bone(r, all[i].lid);
        if (lid == RIG_NONE || !rig_find_turn(r, all[i].eye, &follows.bone, &follows.turn))
            continue;
        r->bone[lid].turn[0].follows = follows;
        any = true;
    }
    if (any)
        rig_note(&d->confirm,
                 "lids follow the gaze up and down, the upper ones by %.0f %%, the lower ones by "
                 "%.0f %% (likely)",
                 -100.0 * upper_lid_follows, 100.0 * lower_lid_follows);
}

/* ---- teeth ---- */

/* Added to the height of a row on the side of the gums, as a share of its radius. There the
 * inside of the mouth covers the teeth, and the skin must stop in front of it. */
static const double beside_gums = 0.45;

static uint32_t list_teeth(vec3 *out, const mesh *m, const rig_anatomy *a, piece_kind kind)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < a->piece_count; ++i)
        for (uint32_t k = 0; k < a->piece[i].point_count && a->piece[i].kind == kind; ++k)
            out[count++] = mesh_position(m, a->member[a->piece[i].first_member + k]);
    return count;
}

static mrt_result fit_teeth(rig *r, const mesh *m, const rig_anatomy *a, error *err)
{
    static const struct {
        piece_kind kind;
        const char *bone;
        double gums; /* 1: above the teeth; -1: below */
    } row[] = {{PIECE_TEETH_UPPER, "skull", 1.0}, {PIECE_TEETH_LOWER, "jaw", -1.0}};
    vec3 *tooth = malloc(((size_t)m->vertex_count + 1) * sizeof *tooth);
    mrt_result result = tooth ? MRT_OK : no_memory(err);
    for (uint32_t i = r->proxy_count; result >= 0 && i-- > 0;)
        if (r->proxy[i].kind == PROXY_TEETH)
            result = rig_edit_remove_proxy(r, i, err);
    for (size_t i = 0; result >= 0 && a->has_face && i < sizeof row / sizeof *row; ++i) {
        rig_proxy made;
        uint32_t bone = rig_find_bone(r, row[i].bone), index;
        uint32_t count = list_teeth(tooth, m, a, row[i].kind);
        if (bone == RIG_NONE || !rig_teeth_fit(&made, tooth, count))
            continue;
        made.bone = bone;
        const double more_mm = round(10.0 * beside_gums * made.radii.y) / 10.0;
        made.centre.y += row[i].gums * more_mm;
        made.radii.y += more_mm;
        result = rig_edit_add_proxy(r, &made, &index, err);
    }
    free(tooth);
    return result;
}

mrt_result rig_draft_teeth(rig *r, const mesh *m, const topology *t, error *err)
{
    rig_anatomy a;
    mrt_result result = rig_anatomy_find(&a, m, t, err);
    if (result < 0)
        return result;
    result = fit_teeth(r, m, &a, err);
    rig_anatomy_finish(&a);
    return result;
}

typedef struct trial {
    bool has_lids; /* false: the lids can hardly close, and are better left out */
    bool opens;    /* the jaw opens by at least CLAY_OPEN_DEG */
} trial;

/* Moves every bone to its ends, and shortens its range where the skin would fold. */
static mrt_result try_bones(rig *r, drafting *d, trial *out, error *err)
{
    freedom all[FREEDOMS_MAX];
    face *f = NULL;
    mrt_result result = face_create(&f, r, d->m, d->t, 0, err);
    if (result < 0)
        return result;
    uint32_t count = list_freedoms(all, r, face_bones(f));
    *out = (trial){true, true};
    for (uint32_t i = 0; i < count; ++i) {
        double wanted = *all[i].end, part = part_without_fold(f, &all[i]);
        const char *name = face_bones(f)->dof[all[i].dof].name;
        *all[i].end = part * wanted;
        if (all[i].is_lid && wanted > 0.0 && part < 0.5)
            out->has_lids = false;
        if (all[i].is_jaw_open && *all[i].end < CLAY_OPEN_DEG / degree_per_radian)
            out->opens = false;
        if (part < 1.0)
            rig_note(&d->confirm,
                     "%s: limited to %.0f %% of the usual range, because the skin would fold "
                     "beyond (certain)",
                     name, 100.0 * part);
    }
    let_lids_close(d, f, all, count);
    double part = part_together(f, all, count);
    for (uint32_t i = 0; i < count; ++i)
        *all[i].end *= all[i].is_eye ? 1.0 : part;
    if (part < 1.0)
        rig_note(&d->confirm,
                 "all bones except the eyes: limited to %.0f %%, so that no combination folds the "
                 "skin (certain)",
                 100.0 * part);
    face_destroy(f);
    return MRT_OK;
}

/* ---- the rims of the mouth ---- */

static void drop_mouth(rig_mouth *mouth)
{
    free(mouth->upper);
    free(mouth->lower);
    *mouth = (rig_mouth){0};
}

/* Keeps the rims only if they can be sealed. Otherwise writes the reason to `why_not`. */
static mrt_result check_mouth(rig_mouth *mouth, char why_not[BIND_FAULT], const mesh *m,
                              const topology *t, error *err)
{
    const rig bare = {.mouth = *mouth};
    mrt_result result = mouth->upper ? bind_lips_fault(why_not, &bare, m, t, err) : MRT_OK;
    if (result < 0 || why_not[0])
        drop_mouth(mouth);
    return result;
}

/* Sets d->mouth, or d->no_mouth. cut: the chain of mesh_cut_mouth, or NULL. */
static mrt_result find_mouth(drafting *d, const uint32_t *cut, uint32_t cut_count, error *err)
{
    if (!d->a.has_face)
        return MRT_OK;
    mrt_result result = cut ? rig_rims_of_cut(&d->mouth, cut, cut_count, d->m, err)
                            : rig_rims_find(&d->mouth, d->no_mouth, &d->a, d->m, d->t, err);
    return result < 0 ? result : check_mouth(&d->mouth, d->no_mouth, d->m, d->t, err);
}

/* Gives the rig the mouth that was found, unless its seal folds the skin. */
static mrt_result add_mouth(rig *r, drafting *d, error *err)
{
    static const double jaw_deg[] = {0.0, 6.0};
    face *f = NULL;
    if (!d->mouth.upper)
        return MRT_OK;
    r->mouth = d->mouth;
    d->mouth = (rig_mouth){0};
    mrt_result result = face_create(&f, r, d->m, d->t, 0, err);
    for (size_t i = 0; result >= 0 && i < sizeof jaw_deg / sizeof *jaw_deg && r->mouth.upper; ++i) {
        const bones *b = face_bones(f);
        float dof[MRT_MAX_DOFS] = {0};
        dof[b->seal] = 1.0f;
        if (b->jaw != RIG_NONE)
            dof[b->first_dof[b->jaw]] =
                (float)fmin(jaw_deg[i] / degree_per_radian, r->bone[b->jaw].open_max_rad);
        if (determinant_of(f, dof) > 0.0)
            continue;
        rig_note(&d->confirm, "mouth: the lips cannot be sealed, since the skin would fold");
        drop_mouth(&r->mouth);
    }
    face_destroy(f);
    return result;
}

/* ---- cutting a mouth ---- */

typedef struct mouth_line { /* runs along the groove between the lips, in front */
    const rig_head *head;
    double corner_x, reach_mm;
} mouth_line;

static double line_y(const mouth_line *l, double x)
{
    const rig_head *head = l->head;
    double at = fmin(fabs(x - head->middle_x) / l->corner_x, 1.0) * (RIG_GROOVE - 1);
    int from = (int)at, to = from < RIG_GROOVE - 1 ? from + 1 : from;
    if (!(head->corner_x > 0.0))
        return head->mouth_y;
    return head->groove_y[from] + (at - from) * (head->groove_y[to] - head->groove_y[from]);
}

/* Returns the cost of an edge: its length, weighted by its distance from the line. */
static double line_cost(const mouth_line *l, vec3 a, vec3 b)
{
    vec3 middle = vec3_scale(vec3_add(a, b), 0.5);
    double off = (middle.y - line_y(l, middle.x)) / (0.03 * l->reach_mm);
    return vec3_length(vec3_sub(a, b)) * (1.0 + off * off);
}

/* Finds the shortest path from one corner of the mouth to the other over the skin in front
 * (Dijkstra). A linear search for the next vertex is fast enough, since few vertices are near
 * the mouth. */
static mrt_result find_mouth_line(uint32_t **out, uint32_t *out_count, const rig_anatomy *a,
                                  const mouth_line *l, const mesh *m, const topology *t, error *err)
{
    const rig_head *head = &a->head;
    const double far = (double)INFINITY;
    uint32_t *near = malloc(((size_t)m->vertex_count + 1) * sizeof *near), count = 0;
    uint32_t *before = malloc(((size_t)m->vertex_count + 1) * sizeof *before), end[2] = {0, 0};
    double *way = malloc(((size_t)m->vertex_count + 1) * sizeof *way), off[2] = {far, far};
    bool has_memory = near && before && way;
    for (uint32_t v = 0; has_memory && v < m->vertex_count; ++v) {
        vec3 p = mesh_position(m, v);
        before[v] = RIG_NONE;
        way[v] = -1.0; /* not near the mouth, or done */
        if (!a->is_face[v] || mesh_point(m, v) != v ||
            (double)a->hidden_mm[v] > 0.1 * l->reach_mm ||
            fabs(p.x - head->middle_x) > 1.15 * l->corner_x || p.y > head->nose.y ||
            p.y < head->chin.y || p.z < head->mouth_z - l->reach_mm)
            continue;
        near[count++] = v;
        way[v] = far;
        for (int side = 0; side < 2; ++side) {
            double x = head->middle_x + (side ? l->corner_x : -l->corner_x);
            double mm = hypot(p.x - x, p.y - line_y(l, x));
            if (mm < off[side]) {
                off[side] = mm;
                end[side] = v;
            }
        }
    }
    bool found = has_memory && count > 0 && end[0] != end[1];
    if (found)
        way[end[0]] = 0.0;
    for (bool is_done = !found; !is_done;) {
        uint32_t next = RIG_NONE;
        for (uint32_t i = 0; i < count; ++i)
            if (way[near[i]] >= 0.0 && way[near[i]] < far &&
                (next == RIG_NONE || way[near[i]] < way[next]))
                next = near[i];
        found = next != RIG_NONE;
        is_done = !found || next == end[1];
        for (uint32_t k = 0;
             !is_done && k < t->neighbour_start[next + 1] - t->neighbour_start[next]; ++k) {
            uint32_t to = t->neighbour[t->neighbour_start[next] + k];
            double through = way[next] + line_cost(l, mesh_position(m, next), mesh_position(m, to));
            if (way[to] >= 0.0 && through < way[to]) {
                way[to] = through;
                before[to] = next;
            }
        }
        if (found && !is_done)
            way[next] = -1.0;
    }
    *out_count = 0;
    for (uint32_t v = found ? end[1] : RIG_NONE; v != RIG_NONE; v = before[v])
        near[(*out_count)++] = v;
    free(before);
    free(way);
    *out = near;
    if (found && *out_count >= 4)
        return MRT_OK;
    free(near);
    *out = NULL;
    return has_memory ? error_set(err, MRT_ERR_UNSUPPORTED,
                                  "the mesh is too coarse to cut a mouth: no edges lead from one "
                                  "corner of the mouth to the other")
                      : no_memory(err);
}

/* Whether the lips show a groove, and the chain follows it within 2 % of the reach. A coarse mesh
 * would get a zigzag for a mouth. */
static bool is_clear_mouth(const rig_head *head, const mouth_line *l, const uint32_t *chain,
                           uint32_t count, const mesh *m)
{
    enum { LEAST = 8 };
    double off = 0.0;
    for (uint32_t i = 0; i < count; ++i) {
        const vec3 p = mesh_position(m, chain[i]);
        off += fabs(p.y - line_y(l, p.x)) / count;
    }
    return count >= LEAST && head->doubt == HEAD_NO_DOUBT && head->corner_x > 0.0 &&
           head->mouth_depth > 0.015 * l->reach_mm && off < 0.02 * l->reach_mm;
}

mrt_result rig_draft_mouth(uint32_t **out_chain, uint32_t *out_count, bool *out_is_clear,
                           const mesh *m, const topology *t, error *err)
{
    rig_anatomy a;
    *out_chain = NULL;
    *out_count = 0;
    mrt_result result = rig_anatomy_find(&a, m, t, err);
    if (result < 0)
        return result;
    mouth_line l = {.head = &a.head,
                    .corner_x =
                        a.head.corner_x > 0.0 ? a.head.corner_x : CORNER_ACROSS * a.head.half_width,
                    .reach_mm = a.head.nose.y - a.head.chin.y};
    if (!a.has_face)
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "no face was found in the mesh, so no mouth can be cut");
    else if (!a.has_parted_lips)
        result = find_mouth_line(out_chain, out_count, &a, &l, m, t, err);
    if (out_is_clear)
        *out_is_clear =
            result >= 0 && *out_chain && is_clear_mouth(&a.head, &l, *out_chain, *out_count, m);
    rig_anatomy_finish(&a);
    return result;
}

mrt_result rig_draft_rims(rig_mouth *out, char why_not[BIND_FAULT], const mesh *m,
                          const topology *t, error *err)
{
    rig_anatomy a;
    *out = (rig_mouth){0};
    (void)snprintf(why_not, BIND_FAULT, "no face was found in the mesh");
    mrt_result result = rig_anatomy_find(&a, m, t, err);
    if (result < 0)
        return result;
    if (a.has_face)
        result = rig_rims_find(out, why_not, &a, m, t, err);
    rig_anatomy_finish(&a);
    return result < 0 ? result : check_mouth(out, why_not, m, t, err);
}

bool rig_draft_is_clay(const rig *drafted)
{
    const uint32_t jaw = rig_find_bone(drafted, "jaw");
    return jaw != RIG_NONE && drafted->bone[jaw].slide_mm == 0.0;
}

/* d->ambition is the one after that of the draft. */
static void note_left_out(drafting *d)
{
    if (d->ambition == WITHOUT_PIECES)
        rig_note(&d->confirm, "lids: left out, since the skin around the eyes would fold");
    else if (d->ambition == WITHOUT_BONES)
        rig_note(&d->confirm, "lids, eyes, teeth and accessories: left out, since the rig could "
                              "not be loaded with them");
    else
        rig_note(&d->confirm, "bones: all but the skull are left out, since the rig could not be "
                              "loaded with them. The head is performed as clay");
}

mrt_result rig_draft_make(rig *out, char **out_confirm, const mesh *m, const topology *t,
                          const char *mesh_path, const uint32_t *cut_mouth, uint32_t cut_count,
                          error *err)
{
    drafting d = {.m = m, .t = t};
    *out = (rig){0};
    *out_confirm = NULL;
    if (m->vertex_count > DRAFT_MOST)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: has %u vertices, but a face can have at most %u; use a coarser mesh",
                         mesh_path, m->vertex_count, DRAFT_MOST);
    mrt_result result = rig_anatomy_find(&d.a, m, t, err);
    if (result < 0)
        return result;
    d.head = d.a.head;
    d.a.has_slit = d.a.has_slit || cut_mouth;
    d.reach_mm = d.head.nose.y - d.head.chin.y;
    if (d.a.has_face && d.head.top_y - d.head.chin.y < HEAD_LEAST_MM) {
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "the head would be %.1f mm high; set the unit of the mesh with --unit "
                           "(cm, m, or a number of mm)",
                           d.head.top_y - d.head.chin.y);
        rig_anatomy_finish(&d.a);
        return result;
    }
    d.is_loose = calloc((size_t)d.a.piece_count + 1, 1);
    result = d.is_loose ? find_mouth(&d, cut_mouth, cut_count, err) : no_memory(err);
    for (bool is_done = result < 0; !is_done && d.ambition < AMBITIONS;) {
        bool is_clay = false;
        trial tried = {true, true};
        result = draft_once(out, &d, mesh_path, err);
        for (bool is_found = true; result >= 0 && is_found;) {
            result = find_patch(&d, out, &is_found, err);
            if (result < 0 || is_found)
                rig_destroy(out);
            if (result >= 0 && is_found)
                result = draft_once(out, &d, mesh_path, err);
        }
        if (result < 0 && m->vertex_count > LAPLACE_FREE_MOST)
            d.ambition = WITHOUT_PIECES; /* other drafts take as long */
        if (result >= 0) {
            result = try_bones(out, &d, &tried, err);
            is_done = result >= 0 && (tried.has_lids || d.ambition > ALL);
            is_clay =
                is_done && !tried.opens && d.a.has_slit && !cut_mouth && !d.head.has_touching_lips;
            if (!is_done || is_clay)
                rig_destroy(out);
            if (is_clay) {
                d.a.has_slit = is_done = false;
                d.patch_count = 0;
            }
        }
        d.ambition += is_clay ? 0 : 1;
    }
    if (result >= 0 && d.ambition > WITHOUT_LIDS)
        note_left_out(&d);
    if (result >= 0)
        add_follows(out, &d);
    if (result >= 0 && (result = add_mouth(out, &d, err)) < 0)
        rig_destroy(out);
    drop_mouth(&d.mouth);
    free(d.is_loose);
    rig_anatomy_finish(&d.a);
    if (result >= 0 && cut_mouth) {
        out->cut_mouth = malloc(cut_count * sizeof *cut_mouth);
        out->cut_mouth_count = cut_count;
        result = out->cut_mouth ? MRT_OK : no_memory(err);
        if (result >= 0)
            memcpy(out->cut_mouth, cut_mouth, cut_count * sizeof *cut_mouth);
        else
            rig_destroy(out);
    }
    if (result < 0)
        free(d.confirm);
    else
        *out_confirm = d.confirm;
    return result;
}
