#include "mesh/mesh.h"

#include "base/arrays.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory for the mesh");
}

mesh_material mesh_material_grey(void)
{
    static const mesh_texture none = {.uv_transform = {1, 0, 0, 0, 1, 0}};
    return (mesh_material){.base_colour = {0.6f, 0.6f, 0.6f, 1.0f},
                           .roughness = 0.7f,
                           .alpha_cutoff = 0.5f,
                           .base = none,
                           .normal = none,
                           .emission = none,
                           .surface = none,
                           .normal_scale = 1.0f,
                           .shade_toony = 0.9f};
}

mrt_result mesh_create(mesh *out, uint32_t vertex_count, uint32_t triangle_count, error *err)
{
    *out = (mesh){.vertex_count = vertex_count,
                  .triangle_count = triangle_count,
                  .material_count = 1,
                  .part_count = 1,
                  .mm_per_unit = 1.0};
    out->position = calloc((size_t)vertex_count * 3 + 1, sizeof *out->position);
    out->triangle = calloc((size_t)triangle_count * 3 + 1, sizeof *out->triangle);
    out->material = calloc(1, sizeof *out->material);
    out->part = calloc(1, sizeof *out->part);
    if (!out->position || !out->triangle || !out->material || !out->part)
        goto fail;
    out->material[0] = mesh_material_grey();
    out->material[0].name = strdup("");
    out->part[0] = (mesh_part){
        .name = strdup(""), .triangle_count = triangle_count, .vertex_count = vertex_count};
    if (!out->material[0].name || !out->part[0].name)
        goto fail;
    return MRT_OK;
fail:
    mesh_destroy(out);
    return no_memory(err);
}

void mesh_destroy(mesh *m)
{
    if (!m)
        return;
    for (uint32_t i = 0; m->material && i < m->material_count; ++i)
        free(m->material[i].name);
    for (uint32_t i = 0; m->part && i < m->part_count; ++i)
        free(m->part[i].name);
    for (uint32_t i = 0; m->attribute && i < m->attribute_count; ++i) {
        free(m->attribute[i].name);
        free(m->attribute[i].value);
    }
    for (uint32_t i = 0; m->target && i < m->target_count; ++i) {
        free(m->target[i].name);
        free(m->target[i].offset);
    }
    for (uint32_t i = 0; m->expression && i < m->expression_count; ++i)
        free(m->expression[i].name);
    free(m->expression);
    for (uint32_t i = 0; m->image && i < m->image_count; ++i) {
        free(m->image[i].name);
        free(m->image[i].encoded);
        free(m->image[i].rgba);
    }
    free(m->image);
    free(m->uv);
    free(m->colour);
    for (uint32_t i = 0; m->joint && i < m->joint_count; ++i) {
        free(m->joint[i].name);
        free(m->joint[i].role);
    }
    free(m->joint);
    free(m->skin_joint);
    free(m->skin_weight);
    free(m->position);
    free(m->triangle);
    free(m->normal);
    free(m->point);
    free(m->smooth);
    free(m->material);
    free(m->part);
    free(m->attribute);
    free(m->target);
    free(m->path);
    free(m->note);
    *m = (mesh){0};
}

void mesh_note(mesh *m, const char *format, ...)
{
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    size_t old = m->note ? strlen(m->note) : 0;
    size_t added = strlen(line);
    char *note = realloc(m->note, old + added + 2);
    if (!note)
        return; /* the note is optional: a failure is ignored */
    memcpy(note + old, line, added);
    memcpy(note + old + added, "\n", 2);
    m->note = note;
}

void mesh_bounds(const mesh *m, float out_low[3], float out_high[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        out_low[axis] = out_high[axis] = m->vertex_count ? m->position[axis] : 0.0f;
        for (uint32_t v = 1; v < m->vertex_count; ++v) {
            float value = m->position[(size_t)v * 3 + (size_t)axis];
            if (value < out_low[axis])
                out_low[axis] = value;
            if (value > out_high[axis])
                out_high[axis] = value;
        }
    }
}

void mesh_focus(const mesh *m, float out_low[3], float out_high[3])
{
    if (!m->has_focus) {
        mesh_bounds(m, out_low, out_high);
        return;
    }
    memcpy(out_low, m->focus_low, sizeof m->focus_low);
    memcpy(out_high, m->focus_high, sizeof m->focus_high);
}

static bool all_finite(const float *value, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (!isfinite(value[i]))
            return false;
    return true;
}

static mrt_result validate_looks(const mesh *m, error *err)
{
    if ((m->uv && !all_finite(m->uv, (size_t)m->vertex_count * 2)) ||
        (m->colour && !all_finite(m->colour, (size_t)m->vertex_count * 4)))
        return error_set(err, MRT_ERR_FORMAT, "a texture coordinate or colour is not finite");
    for (uint32_t i = 0; i < m->material_count; ++i) {
        const mesh_material *look = &m->material[i];
        const mesh_texture *texture[] = {&look->base, &look->normal, &look->emission,
                                         &look->surface};
        for (size_t t = 0; t < sizeof texture / sizeof *texture; ++t)
            if (texture[t]->image > m->image_count || !all_finite(texture[t]->uv_transform, 6))
                return error_set(err, MRT_ERR_FORMAT, "material \"%s\" uses picture %u of %u",
                                 look->name, texture[t]->image, m->image_count);
    }
    return MRT_OK;
}

static mrt_result validate_skin(const mesh *m, error *err)
{
    for (uint32_t i = 0; i < m->joint_count; ++i) {
        const mesh_joint *joint = &m->joint[i];
        if (joint->parent != MESH_NO_JOINT && joint->parent >= i)
            return error_set(err, MRT_ERR_FORMAT, "joint \"%s\" comes before its parent",
                             joint->name);
        if (!all_finite(joint->rest, 12))
            return error_set(err, MRT_ERR_FORMAT, "joint \"%s\" has no finite position",
                             joint->name);
    }
    size_t count = m->skin_joint ? (size_t)m->vertex_count * MESH_SKIN_WIDTH : 0;
    for (size_t i = 0; i < count; ++i)
        if (m->skin_joint[i] >= m->joint_count || !isfinite(m->skin_weight[i]))
            return error_set(err, MRT_ERR_FORMAT, "vertex %zu follows joint %u of %u",
                             i / MESH_SKIN_WIDTH, m->skin_joint[i], m->joint_count);
    return MRT_OK;
}

mrt_result mesh_validate(const mesh *m, error *err)
{
    size_t v3 = (size_t)m->vertex_count * 3;
    if (m->vertex_count == 0)
        return error_set(err, MRT_ERR_FORMAT, "the mesh has no vertices");
    for (size_t i = 0; i < v3; ++i)
        if (!isfinite(m->position[i]))
            return error_set(err, MRT_ERR_FORMAT, "vertex %zu is not finite", i / 3);
    for (size_t i = 0; i < (size_t)m->triangle_count * 3; ++i)
        if (m->triangle[i] >= m->vertex_count)
            return error_set(err, MRT_ERR_FORMAT, "triangle %zu uses vertex %u of %u", i / 3,
                             m->triangle[i], m->vertex_count);
    if (m->normal && !all_finite(m->normal, v3))
        return error_set(err, MRT_ERR_FORMAT, "a normal is not finite");
    uint32_t next = 0;
    for (uint32_t i = 0; i < m->part_count; ++i) {
        const mesh_part *part = &m->part[i];
        if (part->first_triangle != next || part->triangle_count > m->triangle_count - next)
            return error_set(err, MRT_ERR_FORMAT, "part %u \"%s\" does not follow the one before",
                             i, part->name);
        if (part->material >= m->material_count)
            return error_set(err, MRT_ERR_FORMAT, "part \"%s\" uses material %u of %u", part->name,
                             part->material, m->material_count);
        next += part->triangle_count;
    }
    if (next != m->triangle_count)
        return error_set(err, MRT_ERR_FORMAT, "the parts cover %u of %u triangles", next,
                         m->triangle_count);
    for (uint32_t i = 0; i < m->target_count; ++i)
        if (!all_finite(m->target[i].offset, v3))
            return error_set(err, MRT_ERR_FORMAT, "morph target \"%s\" is not finite",
                             m->target[i].name);
    for (uint32_t i = 0; i < m->attribute_count; ++i)
        if (!all_finite(m->attribute[i].value,
                        (size_t)m->vertex_count * m->attribute[i].component_count))
            return error_set(err, MRT_ERR_FORMAT, "attribute \"%s\" is not finite",
                             m->attribute[i].name);
    mrt_result result = validate_looks(m, err);
    return result < 0 ? result : validate_skin(m, err);
}

/* ---- a copy ---- */

static void copy_materials(copying *c, mesh *out, const mesh *m)
{
    out->material = copy_array(c, m->material, m->material_count, sizeof *m->material);
    for (uint32_t i = 0; out->material && i < m->material_count; ++i)
        out->material[i].name = copy_text(c, m->material[i].name);
}

static void copy_images(copying *c, mesh *out, const mesh *m)
{
    out->image = copy_array(c, m->image, m->image_count, sizeof *m->image);
    for (uint32_t i = 0; out->image && i < m->image_count; ++i) {
        const mesh_image *from = &m->image[i];
        out->image[i].name = copy_text(c, from->name);
        out->image[i].encoded = copy_array(c, from->encoded, from->encoded_size, 1);
        out->image[i].rgba = copy_array(c, from->rgba, (size_t)from->width * from->height, 4);
    }
}

static void copy_parts(copying *c, mesh *out, const mesh *m)
{
    out->part = copy_array(c, m->part, m->part_count, sizeof *m->part);
    for (uint32_t i = 0; out->part && i < m->part_count; ++i)
        out->part[i].name = copy_text(c, m->part[i].name);
}

static void copy_attributes(copying *c, mesh *out, const mesh *m)
{
    out->attribute = copy_array(c, m->attribute, m->attribute_count, sizeof *m->attribute);
    for (uint32_t i = 0; out->attribute && i < m->attribute_count; ++i) {
        const mesh_attribute *from = &m->attribute[i];
        size_t count = (size_t)m->vertex_count * from->component_count;
        out->attribute[i].name = copy_text(c, from->name);
        out->attribute[i].value = copy_array(c, from->value, count, sizeof *from->value);
    }
}

static void copy_targets(copying *c, mesh *out, const mesh *m)
{
    out->target = copy_array(c, m->target, m->target_count, sizeof *m->target);
    for (uint32_t i = 0; out->target && i < m->target_count; ++i) {
        const mesh_target *from = &m->target[i];
        out->target[i].name = copy_text(c, from->name);
        out->target[i].offset =
            copy_array(c, from->offset, (size_t)m->vertex_count * 3, sizeof *from->offset);
    }
}

static void copy_expressions(copying *c, mesh *out, const mesh *m)
{
    out->expression = copy_array(c, m->expression, m->expression_count, sizeof *m->expression);
    for (uint32_t i = 0; out->expression && i < m->expression_count; ++i)
        out->expression[i].name = copy_text(c, m->expression[i].name);
}

static void copy_skin(copying *c, mesh *out, const mesh *m)
{
    out->joint = copy_array(c, m->joint, m->joint_count, sizeof *m->joint);
    for (uint32_t i = 0; out->joint && i < m->joint_count; ++i) {
        out->joint[i].name = copy_text(c, m->joint[i].name);
        out->joint[i].role = copy_text(c, m->joint[i].role);
    }
    size_t count = (size_t)m->vertex_count * MESH_SKIN_WIDTH;
    out->skin_joint = copy_array(c, m->skin_joint, count, sizeof *m->skin_joint);
    out->skin_weight = copy_array(c, m->skin_weight, count, sizeof *m->skin_weight);
}

mrt_result mesh_copy(mesh *out, const mesh *m, error *err)
{
    copying c = {0};
    size_t vertices = (size_t)m->vertex_count * 3, corners = (size_t)m->triangle_count * 3;
    *out = *m;
    out->position = copy_array(&c, m->position, vertices, sizeof *m->position);
    out->triangle = copy_array(&c, m->triangle, corners, sizeof *m->triangle);
    out->normal = copy_array(&c, m->normal, vertices, sizeof *m->normal);
    out->point = copy_array(&c, m->point, m->vertex_count, sizeof *m->point);
    out->smooth = copy_array(&c, m->smooth, m->vertex_count, sizeof *m->smooth);
    out->uv = copy_array(&c, m->uv, (size_t)m->vertex_count * 2, sizeof *m->uv);
    out->colour = copy_array(&c, m->colour, (size_t)m->vertex_count * 4, sizeof *m->colour);
    copy_images(&c, out, m);
    copy_materials(&c, out, m);
    copy_parts(&c, out, m);
    copy_attributes(&c, out, m);
    copy_targets(&c, out, m);
    copy_expressions(&c, out, m);
    copy_skin(&c, out, m);
    out->path = copy_text(&c, m->path);
    out->note = copy_text(&c, m->note);
    if (!c.failed)
        return MRT_OK;
    mesh_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for a copy of the mesh");
}
