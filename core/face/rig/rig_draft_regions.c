#include "face/rig/rig_draft_parts.h"

#include "face/rig/rig_mirror.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

static void add_rigid_part(rig_drafting *d, const char *bone, const char *group)
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

static bool has_bone(const rig_drafting *d, const char *name)
{
    for (size_t i = 0; i < json_array_size(d->bones); ++i) {
        const char *found = json_string_value(json_object_get(json_array_get(d->bones, i), "name"));
        if (found && strcmp(found, name) == 0)
            return true;
    }
    return false;
}

/* The first part of an eye says where it turns. */
static void add_eye(rig_drafting *d, const mesh_part *part)
{
    vec3 low, high;
    part_box(&low, &high, d->m, part);
    vec3 centre = vec3_scale(vec3_add(low, high), 0.5);
    const char *bone = centre.x > d->head.middle_x ? "eye.l" : "eye.r";
    if (!has_bone(d, bone)) {
        json_array_append_new(
            d->bones,
            json_pack("{ss, s{so, sf}, s[{ss, s[iii], s[ii]}, {ss, s[iii], s[ii]}]}", "name", bone,
                      "ball", "centre", rig_draft_point(centre), "radius_mm",
                      round(5.0 * (high.y - low.y)) / 10.0, "turns", "name", "yaw", "axis", 0, 1, 0,
                      "deg", -35, 35, "name", "pitch", "axis", -1, 0, 0, "deg", -25, 25));
        rig_note(&d->confirm, "bone %s: turns about the middle of part %s, (%.1f, %.1f, %.1f) mm",
                 bone, part->name, centre.x, centre.y, centre.z);
    }
    add_rigid_part(d, bone, part->name);
}

static bool is_lower(const rig_drafting *d, const mesh_part *part)
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

void rig_draft_regions_by_name(rig_drafting *d)
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
    return json_pack("{s{so, so}}", "half_space", "point", rig_draft_point(point), "normal",
                     rig_draft_point(normal));
}

static json_t *ellipsoid(vec3 centre, vec3 radii)
{
    return json_pack("{s{so, so}}", "ellipsoid", "centre", rig_draft_point(centre), "radii",
                     rig_draft_point(radii));
}

static void add_region(rig_drafting *d, const char *bone, const char *key, json_t *value,
                       json_t *select)
{
    json_t *region = bone ? json_pack("{ss}", "bone", bone) : json_object();
    json_object_set_new(region, key, value);
    json_object_set_new(region, "select", select);
    json_array_append_new(d->regions, region);
}

static void add_cranium(rig_drafting *d)
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

static void add_mobile_face(rig_drafting *d)
{
    const rig_head *head = &d->head;
    double depth = head->nose.z - head->back_z, reach = d->reach_mm;
    vec3 low = {head->middle_x - 0.8 * head->half_width, head->chin.y + 0.1 * reach,
                head->nose.z - 0.3 * depth};
    vec3 high = {head->middle_x + 0.8 * head->half_width, head->nose.y + 0.75 * reach,
                 head->nose.z + 0.1 * depth};
    add_region(d, NULL, "mobility", json_integer(1),
               json_pack("{s{so, so}}", "box", "low", rig_draft_point(low), "high",
                         rig_draft_point(high)));
}

/* What rides on a bone whole, around a contact and on one side of the mouth. */
static void add_lip(rig_drafting *d, const char *bone, const char *contact, double up)
{
    uint32_t vertex = rig_draft_contact_vertex(d, contact);
    if (vertex == RIG_NONE)
        return;
    vec3 slit = {d->head.middle_x, d->head.mouth_y, 0.0};
    json_t *within = json_pack("{s{sf, si}}", "within", "mm", round(1.5 * d->reach_mm) / 10.0, "of",
                               (int)vertex);
    add_region(d, bone, "weight", json_integer(1),
               json_pack("{s[oo]}", "all", within, half_space(slit, (vec3){0, up, 0})));
}

static void add_jaw(rig_drafting *d)
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

void rig_draft_regions_by_place(rig_drafting *d)
{
    add_mobile_face(d);
    add_jaw(d);
    add_cranium(d);
}
