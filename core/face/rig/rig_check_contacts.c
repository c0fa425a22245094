#include "face/rig/rig_check_parts.h"

#include "face/rig/rig_mirror.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FEW_CONTACTS = 8 }; /* fewer stand apart on purpose */
static const double twin_reach_mm = 1e-4, mirror_reach_mm = 2.0, still = 0.02;

/* ---- seams ---- */

/* Marks: a vertex that is left free goes another way than one that is marked. */
static bool marks_differ(const bind_marks *marks, const rig *r, const mesh *m, uint32_t a,
                         uint32_t b)
{
    if (marks->rigid_bone[a] != marks->rigid_bone[b])
        return true;
    for (uint32_t bone = 0; bone < r->bone_count; ++bone) {
        const float *row = marks->weight + (size_t)bone * m->vertex_count;
        if (isnan(row[a]) != isnan(row[b]) || (!isnan(row[a]) && fabsf(row[a] - row[b]) > 0.02f))
            return true;
    }
    return false;
}

static bool weights_differ(const binding *b, uint32_t first, uint32_t second)
{
    for (uint32_t bone = 0; bone < b->bone_count; ++bone) {
        const float *row = b->weight + (size_t)bone * b->vertex_count;
        if (fabsf(row[first] - row[second]) > 0.02f)
            return true;
    }
    return false;
}

static bool are_twins(const mesh *m, uint32_t a, uint32_t b)
{
    vec3 d = vec3_sub(rig_mirror_position(m, a), rig_mirror_position(m, b));
    return vec3_dot(d, d) < twin_reach_mm * twin_reach_mm;
}

mrt_result rig_check_seams(const rig *r, const mesh *m, const bind_marks *marks, const binding *b,
                           error *err)
{
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        const rig_contact *contact = &r->contact[i];
        for (uint32_t v = 0; contact->bone == RIG_NONE && v < m->vertex_count; ++v) {
            if (v == contact->vertex || !are_twins(m, v, contact->vertex))
                continue;
            if (b ? !weights_differ(b, v, contact->vertex)
                  : !marks_differ(marks, r, m, v, contact->vertex))
                continue;
            rig_place place = rig_where(r, RIG_CONTACTS, i);
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s.vertex: the contact \"%s\" is on a seam: vertices %u and %u are "
                             "at one place and ride on different bones; choose a vertex away from "
                             "the seam, or name its bone",
                             place.text, contact->name, contact->vertex, v);
        }
    }
    return MRT_OK;
}

/* ---- mirrors ---- */

static void check_side(rig_checking *c, uint32_t index, const rig_place *place)
{
    const rig_contact *contact = &c->r->contact[index];
    size_t length = strlen(contact->name);
    const char *end = length > 2 ? contact->name + length - 2 : "";
    double x = rig_mirror_position(c->m, contact->vertex).x;
    x -= c->head ? c->head->middle_x : 0.0;
    bool is_left = strcmp(end, ".l") == 0, is_right = strcmp(end, ".r") == 0;
    if ((is_left && x < 0.0) || (is_right && x > 0.0))
        rig_find(c, RIG_WARNING, place->text,
                 "\"%s\" lies at x = %.1f mm, on the other side: +x is the subject's left",
                 contact->name, x);
    if ((is_left || is_right) && contact->mirror == RIG_NONE)
        rig_find(c, RIG_NOTE, place->text, "\"%s\" has no mirror", contact->name);
}

static void check_mirror(rig_checking *c, uint32_t index, const rig_place *place)
{
    const rig_contact *contact = &c->r->contact[index];
    if (contact->mirror == RIG_NONE || contact->mirror < index)
        return;
    const rig_contact *other = &c->r->contact[contact->mirror];
    double middle_x = c->head ? c->head->middle_x : 0.0, distance_mm;
    vec3 image = rig_mirror_position(c->m, contact->vertex);
    image.x = 2.0 * middle_x - image.x;
    double off_mm = vec3_length(vec3_sub(image, rig_mirror_position(c->m, other->vertex)));
    if (off_mm <= mirror_reach_mm)
        return;
    uint32_t better = rig_mirror_of(c->m, contact->vertex, middle_x, &distance_mm);
    rig_find(c, RIG_WARNING, place->text,
             "\"%s\" and \"%s\" are %.1f mm from being mirror images; vertex %u is %.1f mm from it",
             contact->name, other->name, off_mm, better, distance_mm);
}

/* ---- reach ---- */

static void check_mobility(rig_checking *c, uint32_t index, const rig_place *place)
{
    const rig_contact *contact = &c->r->contact[index];
    uint32_t rigid_bone = c->marks->rigid_bone[contact->vertex];
    if (rigid_bone != RIG_NONE) {
        rig_find(c, RIG_WARNING, place->text,
                 "\"%s\" cannot be pulled: vertex %u is rigid on \"%s\"; choose one on the skin",
                 contact->name, contact->vertex, c->r->bone[rigid_bone].name);
        return;
    }
    float mobility =
        c->binding ? c->binding->mobility[contact->vertex] : c->marks->mobility[contact->vertex];
    if ((double)mobility < still)
        rig_find(c, RIG_WARNING, place->text,
                 "\"%s\" can hardly be pulled: the mobility of vertex %u is %.3f; choose one "
                 "further from what is rigid",
                 contact->name, contact->vertex, (double)mobility);
}

static double distance_between(const rig_checking *c, uint32_t a, uint32_t b)
{
    return vec3_length(vec3_sub(rig_mirror_position(c->m, c->r->contact[a].vertex),
                                rig_mirror_position(c->m, c->r->contact[b].vertex)));
}

static void check_spacing(rig_checking *c)
{
    double sum = 0.0;
    uint32_t count = c->r->contact_count;
    for (uint32_t i = 0; i < count; ++i) {
        double nearest = (double)INFINITY;
        for (uint32_t j = 0; j < count; ++j) {
            if (j == i)
                continue;
            double mm = distance_between(c, i, j);
            nearest = fmin(nearest, mm);
            if (j < i || mm >= 1e-3 * c->radius_mm)
                continue;
            rig_place place = rig_where(c->r, RIG_CONTACTS, j);
            rig_find(c, RIG_WARNING, place.text,
                     "\"%s\" is %.3g mm from \"%s\": below 1/1000 of the radius they count as one",
                     c->r->contact[j].name, mm, c->r->contact[i].name);
        }
        sum += nearest;
    }
    if (count < FEW_CONTACTS || c->radius_mm >= 2.0 * sum / count)
        return;
    rig_find(c, RIG_WARNING, "$.solver.radius_mm",
             "a radius of %.1f mm is less than twice the %.1f mm between contacts: the skin dips "
             "between them; %.0f mm would do",
             c->radius_mm, sum / count, ceil(2.0 * sum / count));
}

void rig_check_contacts(rig_checking *c)
{
    for (uint32_t i = 0; i < c->r->contact_count; ++i) {
        rig_place place = rig_where(c->r, RIG_CONTACTS, i);
        check_side(c, i, &place);
        check_mirror(c, i, &place);
        check_mobility(c, i, &place);
    }
    check_spacing(c);
    if (c->r->contact_count == 0)
        rig_find(c, RIG_WARNING, "$.contacts", "there are none: nothing can be pulled by name");
}
