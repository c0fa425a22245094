#include "face/rig_draft.h"

#include "base/file.h"
#include "face/rig/rig_document.h"
#include "face/rig/rig_head.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct drafting {
    const mesh *m;
    rig_head head;
    double reach_mm; /* from the nose down to the chin: what a face is measured in */
    json_t *bones, *regions, *contacts;
    char *confirm; /* lines */
} drafting;

/* To 0.1 mm. */
static json_t *point_of(vec3 p)
{
    return rig_point_to_json((vec3){round(10.0 * p.x), round(10.0 * p.y), round(10.0 * p.z)}, 10.0);
}

/* ---- contacts ---- */

typedef enum level { FROM_NOSE, FROM_MOUTH, FROM_CHIN } level;

/* Where contacts are on the ICT face: across in half widths of the face, up in reaches (nose to
 * chin) from one of three levels. */
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
                {"mouth.corner", 0.362, -0.020, FROM_MOUTH},
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
    double x = head->middle_x + standard[index].across * head->half_width;
    double y = level_y[standard[index].from] + standard[index].up * d->reach_mm;
    vec3 hit;
    return rig_head_hit(&hit, out_vertex, d->m, x, y);
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
    uint32_t other = rig_mirror_of(d->m, vertex, d->head.middle_x, &off_mm);
    if (other == vertex) {
        rig_note(&d->confirm, "contacts %s and %s: the mesh is too coarse there; left out", left,
                 right);
        return;
    }
    if (off_mm > 2.0)
        rig_note(&d->confirm,
                 "contact %s: the mesh has no mirror image of vertex %u; the nearest "
                 "is %.1f mm off",
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

/* The 27 standard contacts, as far as the face has room for them. */
static void draft_contacts(drafting *d)
{
    for (int i = 0; i < STANDARD_COUNT; ++i) {
        uint32_t vertex;
        bool is_pair = standard[i].across > 0.0;
        if (!snap(&vertex, d, i) || is_taken(d, vertex))
            rig_note(&d->confirm, "contact %s%s: no place of its own was found; left out",
                     standard[i].name, is_pair ? " (.l and .r)" : "");
        else if (is_pair)
            add_pair(d, i, vertex);
        else
            add_contact(d, standard[i].name, vertex, NULL);
    }
    rig_note(&d->confirm,
             "contacts: %zu were laid on the front of the face by its proportions; look at them "
             "with marotte rig show, above all at the lips (upper above, lower below the slit) and "
             "the corners of the mouth",
             json_array_size(d->contacts));
}

/* The vertex of a contact that is there; RIG_NONE: it is not. */
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

/* ---- by name ---- */

static bool has_word(const char *name, const char *word)
{
    size_t length = strlen(word);
    for (; *name; ++name) {
        size_t i = 0;
        while (i < length && tolower((unsigned char)name[i]) == word[i])
            ++i;
        if (i == length)
            return true;
    }
    return false;
}

static void part_box(vec3 *out_low, vec3 *out_high, const mesh *m, const mesh_part *part)
{
    const uint32_t *corner = m->triangle + (size_t)part->first_triangle * 3;
    *out_low = *out_high = rig_mirror_position(m, corner[0]);
    for (size_t i = 1; i < (size_t)part->triangle_count * 3; ++i) {
        vec3 p = rig_mirror_position(m, corner[i]);
        *out_low = (vec3){fmin(out_low->x, p.x), fmin(out_low->y, p.y), fmin(out_low->z, p.z)};
        *out_high = (vec3){fmax(out_high->x, p.x), fmax(out_high->y, p.y), fmax(out_high->z, p.z)};
    }
}

static vec3 part_centre(const mesh *m, const mesh_part *part)
{
    vec3 low, high;
    part_box(&low, &high, m, part);
    return vec3_scale(vec3_add(low, high), 0.5);
}

static void add_rigid_part(drafting *d, const char *bone, const char *group)
{
    json_array_append_new(d->regions, json_pack("{ss, sb, s{ss}}", "bone", bone, "rigid", 1,
                                                "select", "group", group));
    rig_note(&d->confirm, "part %s: rigid on %s, by its name", group, bone);
}

static bool is_eye(const char *name)
{
    return has_word(name, "eye") && !has_word(name, "brow") && !has_word(name, "lash") &&
           !has_word(name, "lid") && !has_word(name, "socket") && !has_word(name, "extra");
}

static bool has_bone(const drafting *d, const char *name)
{
    for (size_t i = 0; i < json_array_size(d->bones); ++i) {
        const char *found = json_string_value(json_object_get(json_array_get(d->bones, i), "name"));
        if (found && strcmp(found, name) == 0)
            return true;
    }
    return false;
}

/* The first part of an eye says where it turns. */
static void add_eye(drafting *d, const mesh_part *part)
{
    vec3 low, high;
    part_box(&low, &high, d->m, part);
    vec3 centre = vec3_scale(vec3_add(low, high), 0.5);
    const char *bone = centre.x > d->head.middle_x ? "eye.l" : "eye.r";
    if (!has_bone(d, bone)) {
        json_array_append_new(
            d->bones,
            json_pack("{ss, s{so, sf}, s[{ss, s[iii], s[ii]}, {ss, s[iii], s[ii]}]}", "name", bone,
                      "ball", "centre", point_of(centre), "radius_mm",
                      round(5.0 * (high.y - low.y)) / 10.0, "turns", "name", "yaw", "axis", 0, 1, 0,
                      "deg", -35, 35, "name", "pitch", "axis", -1, 0, 0, "deg", -25, 25));
        rig_note(&d->confirm, "bone %s: turns about the middle of part %s, (%.1f, %.1f, %.1f) mm",
                 bone, part->name, centre.x, centre.y, centre.z);
    }
    add_rigid_part(d, bone, part->name);
}

static bool is_lower(const drafting *d, const mesh_part *part)
{
    if (has_word(part->name, "upper") || has_word(part->name, "lower"))
        return has_word(part->name, "lower");
    return part_centre(d->m, part).y < d->head.mouth_y;
}

static bool comes_again(const mesh *m, uint32_t index)
{
    for (uint32_t i = 0; i < index; ++i)
        if (strcmp(m->part[i].name, m->part[index].name) == 0)
            return true;
    return false;
}

/* Teeth, tongue, eyes; eyes become bones. */
static void draft_regions_by_name(drafting *d)
{
    for (uint32_t i = 0; i < d->m->part_count; ++i) {
        const mesh_part *part = &d->m->part[i];
        if (part->triangle_count == 0 || comes_again(d->m, i) || strlen(part->name) > RIG_NAME_MAX)
            continue;
        if (is_eye(part->name))
            add_eye(d, part);
        else if (has_word(part->name, "teeth") || has_word(part->name, "tooth") ||
                 has_word(part->name, "gum"))
            add_rigid_part(d, is_lower(d, part) ? "jaw" : "skull", part->name);
        else if (has_word(part->name, "tongue"))
            add_rigid_part(d, "jaw", part->name);
    }
}

/* ---- by place ---- */

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

static void add_region(drafting *d, const char *bone, const char *key, json_t *value,
                       json_t *select)
{
    json_t *region = bone ? json_pack("{ss}", "bone", bone) : json_object();
    json_object_set_new(region, key, value);
    json_object_set_new(region, "select", select);
    json_array_append_new(d->regions, region);
}

static void add_cranium(drafting *d)
{
    const rig_head *head = &d->head;
    double x = head->middle_x, depth = head->nose.z - head->back_z;
    vec3 top = {x, head->nose.y + 1.3 * d->reach_mm, 0.0};
    vec3 back = {x, head->nose.y, head->back_z + 0.42 * depth};
    vec3 neck = {x, head->chin.y - 0.3 * d->reach_mm, 0.0};
    add_region(d, "skull", "rigid", json_true(),
               json_pack("{s[ooo]}", "any", half_space(top, (vec3){0, 1, 0}),
                         half_space(back, (vec3){0, 0, -1}), half_space(neck, (vec3){0, -1, 0})));
    rig_note(&d->confirm,
             "region skull: rigid above y = %.0f mm, behind z = %.0f mm and below y = %.0f mm "
             "(neck)",
             top.y, back.z, neck.y);
}

static void add_mobile_face(drafting *d)
{
    const rig_head *head = &d->head;
    double depth = head->nose.z - head->back_z, reach = d->reach_mm;
    vec3 low = {head->middle_x - 0.8 * head->half_width, head->chin.y + 0.1 * reach,
                head->nose.z - 0.3 * depth};
    vec3 high = {head->middle_x + 0.8 * head->half_width, head->nose.y + 0.75 * reach,
                 head->nose.z + 0.1 * depth};
    add_region(d, NULL, "mobility", json_integer(1),
               json_pack("{s{so, so}}", "box", "low", point_of(low), "high", point_of(high)));
}

/* What rides on a bone whole, around a contact and on one side of the mouth. */
static void add_lip(drafting *d, const char *bone, const char *contact, double up)
{
    uint32_t vertex = contact_vertex(d, contact);
    if (vertex == RIG_NONE)
        return;
    vec3 slit = {d->head.middle_x, d->head.mouth_y, 0.0};
    json_t *within = json_pack("{s{sf, si}}", "within", "mm", round(1.5 * d->reach_mm) / 10.0, "of",
                               (int)vertex);
    add_region(d, bone, "weight", json_integer(1),
               json_pack("{s[oo]}", "all", within, half_space(slit, (vec3){0, up, 0})));
}

static void add_jaw(drafting *d)
{
    const rig_head *head = &d->head;
    double reach = d->reach_mm;
    vec3 chin = {head->middle_x, head->chin.y + 0.12 * reach, head->chin.z};
    vec3 radii = {0.4 * head->half_width, 0.25 * reach, 0.35 * reach};
    add_region(d, "jaw", "weight", json_integer(1), ellipsoid(chin, radii));
    add_lip(d, "skull", "lip.upper.mid", 1.0);
    add_lip(d, "jaw", "lip.lower.mid", -1.0);
    rig_note(&d->confirm,
             "regions jaw: the chin (an ellipsoid) and the lower lip below y = %.1f mm ride on the "
             "jaw, the upper lip above it on the skull; if the mouth has a slit, is it there?",
             head->mouth_y);
}

static void draft_regions_by_place(drafting *d)
{
    add_mobile_face(d);
    add_jaw(d);
    add_cranium(d);
}

/* ---- all of it ---- */

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to draft a rig");
}

/* Where jaw joints are in heads (theory 4.2): 0.44 of the way from chin to top and 0.55 from back
 * to front, somewhat inside the sides of the face. */
static void draft_skeleton(drafting *d)
{
    const rig_head *head = &d->head;
    double y = head->chin.y + 0.44 * (head->top_y - head->chin.y);
    double z = head->back_z + 0.55 * (head->nose.z - head->back_z);
    double half = 0.78 * head->half_width;
    vec3 left = {head->middle_x + half, y, z}, right = {head->middle_x - half, y, z};
    vec3 incisor = {head->middle_x, head->mouth_y, head->mouth_z - 0.08 * d->reach_mm};
    json_array_append_new(d->bones, json_pack("{ss}", "name", "skull"));
    json_array_append_new(d->bones, json_pack("{ss, s{so, so}, s[ii], so}", "name", "jaw", "hinge",
                                              "left", point_of(left), "right", point_of(right),
                                              "open_deg", 0, 32, "incisor", point_of(incisor)));
    rig_note(&d->confirm,
             "bone jaw: turns about the line through (%.1f, %.1f, %.1f) and its mirror image, mm, "
             "by the proportions of heads; puppets often look better with it a little lower",
             left.x, left.y, left.z);
    rig_note(&d->confirm,
             "bone jaw: the edge of the lower front teeth is taken to be at (%.1f, "
             "%.1f, %.1f) mm",
             incisor.x, incisor.y, incisor.z);
}

static json_t *draft_proxy(drafting *d)
{
    const rig_head *head = &d->head;
    double height = head->top_y - head->chin.y, depth = head->nose.z - head->back_z;
    vec3 centre = {head->middle_x, head->chin.y + 0.6 * height, head->back_z + 0.45 * depth};
    vec3 radii = {0.85 * head->half_width, 0.36 * height, 0.36 * depth};
    rig_note(&d->confirm, "skull_proxy: one ellipsoid that the skin will not enter; see that it "
                          "lies under the skin");
    return json_pack("[{s{so, so, ss}}]", "ellipsoid", "centre", point_of(centre), "radii",
                     point_of(radii), "bone", "skull");
}

static json_t *draft_document(drafting *d, const char *mesh_name)
{
    d->bones = json_array();
    d->regions = json_array();
    d->contacts = json_array();
    draft_skeleton(d);
    draft_contacts(d);
    draft_regions_by_name(d);
    draft_regions_by_place(d);
    double radius_mm = round(0.27 * (d->head.top_y - d->head.chin.y));
    rig_note(&d->confirm, "solver: radius %.0f mm, a quarter of the head", radius_mm);
    return json_pack("{si, ss, ss, si, so, so, so, so, s{ss, so, ss}}", "marotte_rig", 1, "mesh",
                     mesh_name, "unit", "mm", "mesh_vertices", (int)d->m->vertex_count, "bones",
                     d->bones, "regions", d->regions, "contacts", d->contacts, "skull_proxy",
                     draft_proxy(d), "solver", "kernel", "wendland_c2", "radius_mm",
                     rig_number_to_json(radius_mm), "polynomial", "none");
}

/* By way of its text, so that a draft is what any rig file is. */
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
    out->name = strndup(mesh_name, length < RIG_NAME_MAX ? length : RIG_NAME_MAX);
    out->mesh_path = strdup(mesh_path);
    if (out->name && out->mesh_path)
        return MRT_OK;
    rig_destroy(out);
    return no_memory(err);
}

static void say_what_it_is(drafting *d)
{
    const rig_head *head = &d->head;
    rig_note(&d->confirm, "unit: the head is %.0f mm from chin to top; is that the puppet's size?",
             head->top_y - head->chin.y);
    rig_note(&d->confirm, "symmetry: left and right are mirrored in x = %.2f mm", head->middle_x);
    rig_note(&d->confirm,
             "face: the nose's tip is at y = %.1f mm, the mouth at %.1f mm, the chin ends at %.1f "
             "mm; all places below follow from these",
             head->nose.y, head->mouth_y, head->chin.y);
}

mrt_result rig_draft_make(rig *out, char **out_confirm, const mesh *m, const char *mesh_path,
                          error *err)
{
    drafting d = {.m = m};
    *out = (rig){0};
    *out_confirm = NULL;
    mrt_result result = rig_head_measure(&d.head, m, err);
    if (result < 0)
        return result;
    d.reach_mm = d.head.nose.y - d.head.chin.y;
    say_what_it_is(&d);
    const char *slash = strrchr(mesh_path, '/'), *mesh_name = slash ? slash + 1 : mesh_path;
    json_t *document = draft_document(&d, mesh_name);
    result = parse_draft(out, document, mesh_path, mesh_name, err);
    json_decref(document);
    if (result < 0) {
        free(d.confirm);
        return result;
    }
    out->mm_per_unit = m->mm_per_unit;
    out->mesh_vertex_count = m->vertex_count;
    out->mesh_hash = rig_mesh_hash(m->vertex_count, m->triangle, m->triangle_count);
    *out_confirm = d.confirm;
    return MRT_OK;
}
