#include "face/rig/rig_draft_parts.h"

#include "face/rig/rig_mirror.h"

#include <stdio.h>
#include <string.h>

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

static bool snap(uint32_t *out_vertex, const rig_drafting *d, int index)
{
    const rig_head *head = &d->head;
    const double level_y[] = {head->nose.y, head->mouth_y, head->chin.y};
    double x = head->middle_x + standard[index].across * head->half_width;
    double y = level_y[standard[index].from] + standard[index].up * d->reach_mm;
    vec3 hit;
    return rig_head_hit(&hit, out_vertex, d->m, x, y);
}

static void add_contact(rig_drafting *d, const char *name, uint32_t vertex, const char *mirror)
{
    json_t *contact = json_pack("{ss, si}", "name", name, "vertex", (int)vertex);
    if (mirror)
        json_object_set_new(contact, "mirror", json_string(mirror));
    json_array_append_new(d->contacts, contact);
}

static void add_pair(rig_drafting *d, int index, uint32_t vertex)
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

static bool is_taken(const rig_drafting *d, uint32_t vertex)
{
    for (size_t i = 0; i < json_array_size(d->contacts); ++i)
        if (json_integer_value(json_object_get(json_array_get(d->contacts, i), "vertex")) ==
            (json_int_t)vertex)
            return true;
    return false;
}

void rig_draft_contacts(rig_drafting *d)
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

uint32_t rig_draft_contact_vertex(const rig_drafting *d, const char *name)
{
    for (size_t i = 0; i < json_array_size(d->contacts); ++i) {
        const json_t *contact = json_array_get(d->contacts, i);
        const char *found = json_string_value(json_object_get(contact, "name"));
        if (found && strcmp(found, name) == 0)
            return (uint32_t)json_integer_value(json_object_get(contact, "vertex"));
    }
    return RIG_NONE;
}
