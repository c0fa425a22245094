#include "mesh/copy.h"

#include "base/arrays.h"

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

mrt_result topology_copy(topology *out, const topology *t, error *err)
{
    copying c = {0};
    size_t count = t->vertex_count, loops = t->border_loop_count;
    *out = *t;
    out->neighbour_start =
        copy_array(&c, t->neighbour_start, count + 1, sizeof *t->neighbour_start);
    size_t links = t->neighbour_start ? t->neighbour_start[count] : 0;
    out->neighbour = copy_array(&c, t->neighbour, links, sizeof *t->neighbour);
    out->on_border = copy_array(&c, t->on_border, count, sizeof *t->on_border);
    out->border_loop_start =
        copy_array(&c, t->border_loop_start, loops + 1, sizeof *t->border_loop_start);
    size_t border = t->border_loop_start ? t->border_loop_start[loops] : 0;
    out->border_vertex = copy_array(&c, t->border_vertex, border, sizeof *t->border_vertex);
    out->rejected_triangle =
        copy_array(&c, t->rejected_triangle, t->rejected_count, sizeof *t->rejected_triangle);
    if (!c.failed)
        return MRT_OK;
    topology_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for a copy of the mesh");
}
