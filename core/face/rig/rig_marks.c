#include "face/bind.h"

#include "face/rig/rig_document.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct marking {
    bind_marks *marks;
    const rig *r;
    const mesh *m;
    const topology *t;
    float *selected;        /* vertex_count: the region's own weights */
    uint32_t *rigid_region; /* vertex_count: which region made it rigid */
} marking;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to lay the rig on the mesh");
}

static float *weight_at(const marking *k, uint32_t bone, uint32_t vertex)
{
    return &k->marks->weight[(size_t)bone * k->m->vertex_count + vertex];
}

/* ---- what one region says of one vertex ---- */

/* Others keep their shares as far as there is room beside the new one; a whole share leaves
 * nothing open. */
static void mark_weight(const marking *k, uint32_t vertex, uint32_t bone, float weight)
{
    float others = 0.0f, room = 1.0f - weight;
    *weight_at(k, bone, vertex) = weight;
    for (uint32_t b = 0; b < k->r->bone_count; ++b)
        if (b != bone && !isnan(*weight_at(k, b, vertex)))
            others += *weight_at(k, b, vertex);
    for (uint32_t b = 0; b < k->r->bone_count; ++b) {
        float *other = weight_at(k, b, vertex);
        if (b == bone)
            continue;
        if (room <= 0.0f)
            *other = 0.0f;
        else if (!isnan(*other) && others > room)
            *other *= room / others;
    }
}

static mrt_result refuse_overlap(const marking *k, uint32_t region, uint32_t vertex, error *err)
{
    uint32_t first = k->rigid_region[vertex];
    rig_place a = rig_where(k->r, RIG_REGIONS, first), b = rig_where(k->r, RIG_REGIONS, region);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: overlaps %s: vertex %u would be rigid on \"%s\" and on \"%s\"; take it "
                     "out of one of them",
                     b.text, a.text, vertex, k->r->bone[k->r->region[region].bone].name,
                     k->r->bone[k->r->region[first].bone].name);
}

static mrt_result mark_rigid(const marking *k, uint32_t region, uint32_t vertex, error *err)
{
    uint32_t bone = k->r->region[region].bone;
    uint32_t *rigid_bone = &k->marks->rigid_bone[vertex];
    if (*rigid_bone != RIG_NONE && *rigid_bone != bone)
        return refuse_overlap(k, region, vertex, err);
    if (*rigid_bone == RIG_NONE)
        k->rigid_region[vertex] = region;
    *rigid_bone = bone;
    return MRT_OK;
}

static mrt_result mark_region(const marking *k, uint32_t index, error *err)
{
    const rig_region *region = &k->r->region[index];
    mrt_result result = bind_select(k->selected, &region->select, k->m, k->t, err);
    for (uint32_t v = 0; result >= 0 && v < k->m->vertex_count; ++v) {
        float share = k->selected[v];
        if (region->is_rigid) {
            if (share >= 0.5f)
                result = mark_rigid(k, index, v, err);
            continue;
        }
        if (!(share > 0.0f))
            continue;
        if (!isnan(region->weight))
            mark_weight(k, v, region->bone, share * (float)region->weight);
        if (!isnan(region->mobility))
            k->marks->mobility[v] = share * (float)region->mobility;
    }
    return result;
}

/* ---- all of them ---- */

static void put_rigid_over_all(const marking *k)
{
    for (uint32_t v = 0; v < k->m->vertex_count; ++v) {
        if (k->marks->rigid_bone[v] == RIG_NONE)
            continue;
        mark_weight(k, v, k->marks->rigid_bone[v], 1.0f);
        k->marks->mobility[v] = 0.0f;
    }
}

static mrt_result check_bones_have_vertices(const marking *k, error *err)
{
    for (uint32_t b = 0; k->r->bone_count > 1 && b < k->r->bone_count; ++b) {
        bool found = false;
        for (uint32_t v = 0; !found && v < k->m->vertex_count; ++v)
            found = *weight_at(k, b, v) > 0.0f;
        if (found)
            continue;
        rig_place place = rig_where(k->r, RIG_BONES, b);
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: no vertex belongs to the bone \"%s\"; add a region for it to "
                         "$.regions, or take the bone out",
                         place.text, k->r->bone[b].name);
    }
    return MRT_OK;
}

static mrt_result check_vertices(const rig *r, const mesh *m, error *err)
{
    if (r->mesh_vertex_count != 0 && r->mesh_vertex_count != m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "$.mesh_vertices: the rig was made for a mesh of %u vertices, this one "
                         "has %u; use that mesh again, or draft a rig with marotte rig new",
                         r->mesh_vertex_count, m->vertex_count);
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        if (r->contact[i].vertex < m->vertex_count)
            continue;
        rig_place place = rig_where(r, RIG_CONTACTS, i);
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s.vertex: vertex %u of a mesh of %u vertices; choose again", place.text,
                         r->contact[i].vertex, m->vertex_count);
    }
    return MRT_OK;
}

static mrt_result allocate(marking *k, error *err)
{
    size_t count = (size_t)k->m->vertex_count + 1;
    bind_marks *marks = k->marks;
    marks->rigid_bone = malloc(count * sizeof *marks->rigid_bone);
    marks->weight = malloc(count * k->r->bone_count * sizeof *marks->weight);
    marks->mobility = malloc(count * sizeof *marks->mobility);
    k->selected = malloc(count * sizeof *k->selected);
    k->rigid_region = malloc(count * sizeof *k->rigid_region);
    if (!marks->rigid_bone || !marks->weight || !marks->mobility || !k->selected ||
        !k->rigid_region)
        return no_memory(err);
    for (size_t i = 0; i < (size_t)k->m->vertex_count * k->r->bone_count; ++i)
        marks->weight[i] = NAN;
    for (uint32_t v = 0; v < k->m->vertex_count; ++v) {
        marks->rigid_bone[v] = RIG_NONE;
        marks->mobility[v] = NAN;
    }
    return MRT_OK;
}

typedef enum marks_of { OF_ALL = 0, OF_BARE } marks_of;

static mrt_result create(bind_marks *out, marks_of which, const rig *r, const mesh *m,
                         const topology *t, error *err)
{
    marking k = {.marks = out, .r = r, .m = m, .t = t};
    *out = (bind_marks){0};
    mrt_result result = check_vertices(r, m, err);
    if (result >= 0)
        result = allocate(&k, err);
    for (uint32_t i = 0; result >= 0 && i < r->region_count; ++i)
        if (which == OF_ALL || !rig_region_is_paint(&r->region[i]))
            result = mark_region(&k, i, err);
    if (result >= 0)
        put_rigid_over_all(&k);
    if (result >= 0 && which == OF_ALL)
        result = check_bones_have_vertices(&k, err);
    free(k.selected);
    free(k.rigid_region);
    if (result < 0)
        bind_marks_destroy(out);
    return result;
}

mrt_result bind_marks_create(bind_marks *out, const rig *r, const mesh *m, const topology *t,
                             error *err)
{
    return create(out, OF_ALL, r, m, t, err);
}

mrt_result bind_marks_create_bare(bind_marks *out, const rig *r, const mesh *m, const topology *t,
                                  error *err)
{
    return create(out, OF_BARE, r, m, t, err);
}

void bind_marks_destroy(bind_marks *marks)
{
    if (!marks)
        return;
    free(marks->rigid_bone);
    free(marks->weight);
    free(marks->mobility);
    *marks = (bind_marks){0};
}
