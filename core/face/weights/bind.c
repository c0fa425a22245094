#include "face/bind.h"

#include <stdlib.h>
#include <string.h>

static mrt_result allocate(binding *out, uint32_t bone_count, uint32_t vertex_count,
                           uint32_t contact_count, error *err)
{
    *out = (binding){
        .vertex_count = vertex_count,
        .bone_count = bone_count,
        .weight = calloc((size_t)bone_count * vertex_count + 1, sizeof(float)),
        .mobility = calloc(vertex_count + (size_t)1, sizeof(float)),
        .contact_position = calloc(contact_count + (size_t)1, sizeof(vec3)),
        .contact_normal = calloc(contact_count + (size_t)1, sizeof(vec3)),
    };
    if (out->weight != NULL && out->mobility != NULL && out->contact_position != NULL &&
        out->contact_normal != NULL)
        return MRT_OK;
    binding_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory to bind %u bones to %u vertices", bone_count,
                     vertex_count);
}

static vec3 position_of(const mesh *m, uint32_t vertex)
{
    const float *p = m->position + 3 * (size_t)vertex;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static bool is_corner(const mesh *m, const uint32_t *corner, uint32_t point)
{
    return mesh_point(m, corner[0]) == point || mesh_point(m, corner[1]) == point ||
           mesh_point(m, corner[2]) == point;
}

/* Of the triangles at the vertex's point, weighted by area. */
static vec3 normal_at(const mesh *m, uint32_t vertex)
{
    vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *corner = m->triangle + 3 * (size_t)i;
        if (!is_corner(m, corner, mesh_point(m, vertex)))
            continue;
        vec3 a = position_of(m, corner[0]);
        sum = vec3_add(sum, vec3_cross(vec3_sub(position_of(m, corner[1]), a),
                                       vec3_sub(position_of(m, corner[2]), a)));
    }
    return vec3_normalised(sum, (vec3){0, 0, 1});
}

static mrt_result place_contacts(binding *out, const rig *r, const mesh *m, error *err)
{
    for (uint32_t c = 0; c < r->contact_count; c++) {
        uint32_t vertex = r->contact[c].vertex;
        if (vertex >= m->vertex_count)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s: $.contacts[%u].vertex: %u, but the mesh has %u vertices: choose "
                             "another vertex for \"%s\"",
                             r->path != NULL ? r->path : "rig", c, vertex, m->vertex_count,
                             r->contact[c].name);
        out->contact_position[c] = position_of(m, vertex);
        out->contact_normal[c] = normal_at(m, vertex);
    }
    return MRT_OK;
}

/* A contact that names its bone rides on it alone. */
static void hold_contacts(bind_marks *marks, const rig *r, const mesh *m)
{
    for (uint32_t c = 0; c < r->contact_count; c++) {
        const rig_contact *contact = &r->contact[c];
        if (contact->bone == RIG_NONE || marks->rigid_bone[contact->vertex] != RIG_NONE)
            continue;
        uint32_t point = mesh_point(m, contact->vertex);
        for (uint32_t v = point; v < (m->point ? m->vertex_count : point + 1); v++)
            for (uint32_t b = 0; b < r->bone_count && mesh_point(m, v) == point; b++)
                marks->weight[(size_t)b * m->vertex_count + v] = b == contact->bone ? 1 : 0;
    }
}

static bool is_painted(const rig *r)
{
    for (uint32_t i = 0; i < r->region_count; i++)
        if (rig_region_is_paint(&r->region[i]))
            return true;
    return false;
}

static mrt_result bind_everything_free(binding *out, const mesh *m, error *err)
{
    mrt_result result = allocate(out, 1, m->vertex_count, 0, err);
    for (uint32_t v = 0; result == MRT_OK && v < m->vertex_count; v++)
        out->weight[v] = out->mobility[v] = 1;
    return result;
}

mrt_result binding_create(binding *out, const rig *r, const mesh *m, const topology *t, error *err)
{
    *out = (binding){0};
    if (r == NULL)
        return bind_everything_free(out, m, err);
    mrt_result result = allocate(out, r->bone_count, m->vertex_count, r->contact_count, err);
    if (result != MRT_OK)
        return result;
    bind_marks marks = {0}, bare = {0};
    const bool paints = is_painted(r);
    result = place_contacts(out, r, m, err);
    if (result == MRT_OK)
        result = bind_marks_create(&marks, r, m, t, err);
    if (result == MRT_OK && paints)
        result = bind_marks_create_bare(&bare, r, m, t, err);
    if (result == MRT_OK)
        hold_contacts(&marks, r, m);
    if (result == MRT_OK && paints)
        hold_contacts(&bare, r, m);
    if (result == MRT_OK)
        result = binding_fill(out, paints ? &bare : &marks, paints ? &marks : NULL, r, m, t, err);
    bind_marks_destroy(&marks);
    bind_marks_destroy(&bare);
    if (result != MRT_OK)
        binding_destroy(out);
    return result;
}

static void *copy_of(const void *from, size_t size)
{
    void *out = from ? malloc(size + 1) : NULL;
    if (out)
        memcpy(out, from, size);
    return out;
}

mrt_result binding_copy(binding *out, const binding *b, uint32_t contact_count, error *err)
{
    size_t count = b->vertex_count, contacts = contact_count * sizeof(vec3);
    *out = *b;
    out->weight = copy_of(b->weight, count * b->bone_count * sizeof *b->weight);
    out->mobility = copy_of(b->mobility, count * sizeof *b->mobility);
    out->contact_position = copy_of(b->contact_position, contacts);
    out->contact_normal = copy_of(b->contact_normal, contacts);
    if (out->weight && out->mobility && (out->contact_position || !b->contact_position) &&
        (out->contact_normal || !b->contact_normal))
        return MRT_OK;
    binding_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory to bind %u bones to %u vertices",
                     b->bone_count, b->vertex_count);
}

void binding_destroy(binding *b)
{
    free(b->weight);
    free(b->mobility);
    free(b->contact_position);
    free(b->contact_normal);
    *b = (binding){0};
}
