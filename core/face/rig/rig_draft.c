#include "face/rig_draft.h"

#include "base/file.h"
#include "face/rig/rig_document.h"
#include "face/rig/rig_draft_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to draft a rig");
}

json_t *rig_draft_point(vec3 p)
{
    return rig_point_to_json((vec3){round(10.0 * p.x), round(10.0 * p.y), round(10.0 * p.z)}, 10.0);
}

/* Where jaw joints are in heads (theory 4.2): 0.44 of the way from chin to top and 0.55 from back
 * to front, somewhat inside the sides of the face. */
static void draft_skeleton(rig_drafting *d)
{
    const rig_head *head = &d->head;
    double y = head->chin.y + 0.44 * (head->top_y - head->chin.y);
    double z = head->back_z + 0.55 * (head->nose.z - head->back_z);
    double half = 0.78 * head->half_width;
    vec3 left = {head->middle_x + half, y, z}, right = {head->middle_x - half, y, z};
    vec3 incisor = {head->middle_x, head->mouth_y, head->mouth_z - 0.08 * d->reach_mm};
    json_array_append_new(d->bones, json_pack("{ss}", "name", "skull"));
    json_array_append_new(d->bones,
                          json_pack("{ss, s{so, so}, s[ii], so}", "name", "jaw", "hinge", "left",
                                    rig_draft_point(left), "right", rig_draft_point(right),
                                    "open_deg", 0, 32, "incisor", rig_draft_point(incisor)));
    rig_note(&d->confirm,
             "bone jaw: turns about the line through (%.1f, %.1f, %.1f) and its mirror image, mm, "
             "by the proportions of heads; puppets often look better with it a little lower",
             left.x, left.y, left.z);
    rig_note(&d->confirm,
             "bone jaw: the edge of the lower front teeth is taken to be at (%.1f, "
             "%.1f, %.1f) mm",
             incisor.x, incisor.y, incisor.z);
}

static json_t *draft_proxy(rig_drafting *d)
{
    const rig_head *head = &d->head;
    double height = head->top_y - head->chin.y, depth = head->nose.z - head->back_z;
    vec3 centre = {head->middle_x, head->chin.y + 0.6 * height, head->back_z + 0.45 * depth};
    vec3 radii = {0.85 * head->half_width, 0.36 * height, 0.36 * depth};
    rig_note(&d->confirm, "skull_proxy: one ellipsoid that the skin will not enter; see that it "
                          "lies under the skin");
    return json_pack("[{s{so, so, ss}}]", "ellipsoid", "centre", rig_draft_point(centre), "radii",
                     rig_draft_point(radii), "bone", "skull");
}

static json_t *draft_document(rig_drafting *d, const char *mesh_name)
{
    d->bones = json_array();
    d->regions = json_array();
    d->contacts = json_array();
    draft_skeleton(d);
    rig_draft_contacts(d);
    rig_draft_regions_by_name(d);
    rig_draft_regions_by_place(d);
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

static void say_what_it_is(rig_drafting *d)
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
    rig_drafting d = {.m = m};
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
