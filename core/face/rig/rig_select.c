#include "face/bind.h"

#include "face/rig/rig_within.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIST_TEXT = 400 };

static const char *path_of(const rig_select *select)
{
    return select->path ? select->path : "select";
}

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to lay the rig on the mesh");
}

static vec3 position_of(const mesh *m, uint32_t vertex)
{
    const float *p = m->position + (size_t)vertex * 3;
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

/* ---- by number ---- */

static mrt_result select_vertices(float *out, const rig_select *select, const mesh *m, error *err)
{
    for (uint32_t i = 0; i < select->range_count; ++i) {
        if (select->last[i] >= m->vertex_count)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s.vertices[%u]: vertex %u of a mesh of %u vertices; choose again",
                             path_of(select), i, select->last[i], m->vertex_count);
        for (uint32_t v = select->first[i]; v <= select->last[i]; ++v)
            out[v] = 1.0f;
    }
    return MRT_OK;
}

static mrt_result select_painted(float *out, const rig_select *select, const mesh *m, error *err)
{
    for (uint32_t i = 0; i < select->range_count; ++i) {
        if (select->last[i] >= m->vertex_count)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s.painted: \"%s\" is painted at vertex %u of a mesh of %u vertices; "
                             "use the mesh it was painted on, or paint again",
                             path_of(select), select->name, select->last[i], m->vertex_count);
        for (uint32_t v = select->first[i]; v <= select->last[i]; ++v)
            out[v] = (float)select->value[i] / 255.0f;
    }
    return MRT_OK;
}

/* ---- by name ---- */

/* A '*' at the end of the pattern matches any rest. */
static bool matches(const char *pattern, const char *name)
{
    size_t length = strlen(pattern);
    if (length > 0 && pattern[length - 1] == '*')
        return strncmp(pattern, name, length - 1) == 0;
    return strcmp(pattern, name) == 0;
}

static void list_name(char list[LIST_TEXT], const char *name)
{
    size_t used = strlen(list);
    if (name[0] && used + strlen(name) + 8 < LIST_TEXT)
        (void)snprintf(list + used, LIST_TEXT - used, "%s%s", used ? ", " : "", name);
}

static mrt_result select_group(float *out, const rig_select *select, const mesh *m, error *err)
{
    bool found = false;
    for (uint32_t i = 0; i < m->part_count; ++i) {
        const mesh_part *part = &m->part[i];
        if (!matches(select->name, part->name) &&
            !matches(select->name, m->material[part->material].name))
            continue;
        found = true;
        const uint32_t *corner = m->triangle + (size_t)part->first_triangle * 3;
        for (size_t k = 0; k < (size_t)part->triangle_count * 3; ++k)
            out[corner[k]] = 1.0f;
    }
    if (found)
        return MRT_OK;
    char list[LIST_TEXT] = "";
    for (uint32_t i = 0; i < m->part_count; ++i)
        list_name(list, m->part[i].name);
    for (uint32_t i = 0; i < m->material_count; ++i)
        list_name(list, m->material[i].name);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s.group: the mesh has no part or material \"%s\"; "
                     "it has: %s",
                     path_of(select), select->name, list[0] ? list : "no names");
}

static mrt_result select_attribute(float *out, const rig_select *select, const mesh *m, error *err)
{
    for (uint32_t i = 0; i < m->attribute_count; ++i) {
        const mesh_attribute *attribute = &m->attribute[i];
        if (strcmp(attribute->name, select->name) != 0)
            continue;
        for (uint32_t v = 0; v < m->vertex_count; ++v) {
            float value = attribute->value[(size_t)v * attribute->component_count];
            out[v] = value > 0.0f ? fminf(value, 1.0f) : 0.0f;
        }
        return MRT_OK;
    }
    char list[LIST_TEXT] = "";
    for (uint32_t i = 0; i < m->attribute_count; ++i)
        list_name(list, m->attribute[i].name);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s.attribute: the mesh has no vertex attribute \"%s\" (it has: %s); glTF "
                     "files carry painted weights under names that begin with _",
                     path_of(select), select->name, list[0] ? list : "none");
}

/* ---- by place ---- */

static bool is_in_box(vec3 p, vec3 low, vec3 high)
{
    return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z &&
           p.z <= high.z;
}

static bool is_in_ellipsoid(vec3 p, vec3 centre, vec3 radii)
{
    vec3 d = vec3_sub(p, centre);
    vec3 q = {d.x / radii.x, d.y / radii.y, d.z / radii.z};
    return vec3_dot(q, q) <= 1.0;
}

static void select_shape(float *out, const rig_select *select, const mesh *m)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        vec3 p = position_of(m, v);
        bool is_in = select->kind == SELECT_BOX ? is_in_box(p, select->a, select->b)
                     : select->kind == SELECT_ELLIPSOID
                         ? is_in_ellipsoid(p, select->a, select->b)
                         : vec3_dot(vec3_sub(p, select->a), select->b) >= 0.0;
        out[v] = is_in ? 1.0f : 0.0f;
    }
}

static mrt_result select_within(float *out, const rig_select *select, const mesh *m,
                                const topology *t, error *err)
{
    if (select->vertex >= m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s.within.of: vertex %u of a mesh of %u vertices; choose again",
                         path_of(select), select->vertex, m->vertex_count);
    double *distance = malloc(((size_t)m->vertex_count + 1) * sizeof *distance);
    if (!distance || !rig_within(distance, select->vertex, select->within_mm, m, t)) {
        free(distance);
        return no_memory(err);
    }
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        out[v] = distance[v] <= select->within_mm ? 1.0f : 0.0f;
    free(distance);
    return MRT_OK;
}

/* ---- joined ---- */

static mrt_result select_joined(float *out, const rig_select *select, const mesh *m,
                                const topology *t, error *err)
{
    bool is_all = select->kind == SELECT_ALL;
    float *one = malloc(((size_t)m->vertex_count + 1) * sizeof *one);
    if (!one)
        return no_memory(err);
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        out[v] = is_all ? 1.0f : 0.0f;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < select->child_count; ++i) {
        result = bind_select(one, &select->child[i], m, t, err);
        for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v)
            out[v] = is_all ? fminf(out[v], one[v]) : fmaxf(out[v], one[v]);
    }
    free(one);
    return result;
}

static mrt_result select_not(float *out, const rig_select *select, const mesh *m, const topology *t,
                             error *err)
{
    mrt_result result = bind_select(out, &select->child[0], m, t, err);
    for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v)
        out[v] = 1.0f - out[v];
    return result;
}

mrt_result bind_select(float *out, const rig_select *select, const mesh *m, const topology *t,
                       error *err)
{
    memset(out, 0, (size_t)m->vertex_count * sizeof *out);
    switch (select->kind) {
    case SELECT_NOTHING:
        break;
    case SELECT_VERTICES:
        return select_vertices(out, select, m, err);
    case SELECT_GROUP:
        return select_group(out, select, m, err);
    case SELECT_ATTRIBUTE:
        return select_attribute(out, select, m, err);
    case SELECT_BOX:
    case SELECT_ELLIPSOID:
    case SELECT_HALF_SPACE:
        select_shape(out, select, m);
        break;
    case SELECT_WITHIN:
        return select_within(out, select, m, t, err);
    case SELECT_ALL:
    case SELECT_ANY:
        return select_joined(out, select, m, t, err);
    case SELECT_PAINTED:
        return select_painted(out, select, m, err);
    case SELECT_NOT:
        return select_not(out, select, m, t, err);
    }
    return MRT_OK;
}
