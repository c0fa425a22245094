#include "io/write/morph.h"

#include "base/rigid.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

static vec3 at(const float *value, uint32_t vertex)
{
    const float *v = value + (size_t)vertex * 3;
    return (vec3){(double)v[0], (double)v[1], (double)v[2]};
}

static vec3 edge(const float *value, uint32_t from, uint32_t to)
{
    return vec3_sub(at(value, to), at(value, from));
}

static void add_to_corners(double *sum, const uint32_t *corner, vec3 a)
{
    for (int k = 0; k < 3; ++k) {
        double *out = sum + (size_t)corner[k] * 3;
        out[0] += a.x;
        out[1] += a.y;
        out[2] += a.z;
    }
}

void morph_area(double *out_area, const float *position, uint32_t vertex_count,
                const uint32_t *triangle, uint32_t triangle_count)
{
    memset(out_area, 0, (size_t)vertex_count * 3 * sizeof *out_area);
    for (uint32_t i = 0; i < triangle_count; ++i) {
        const uint32_t *t = triangle + (size_t)i * 3;
        add_to_corners(out_area, t,
                       vec3_cross(edge(position, t[0], t[1]), edge(position, t[0], t[2])));
    }
}

static bool moves(const float *offset, const uint32_t *corner)
{
    for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
            if (offset[(size_t)corner[k] * 3 + (size_t)axis] != 0.0f)
                return true;
    return false;
}

/* Computes the derivative of the area vectors: d(u x v) = du x v + u x dv. */
static void area_change(double *out, const morph_surface *s, const float *offset)
{
    memset(out, 0, (size_t)s->vertex_count * 3 * sizeof *out);
    for (uint32_t i = 0; i < s->triangle_count; ++i) {
        const uint32_t *t = s->triangle + (size_t)i * 3;
        if (!moves(offset, t))
            continue;
        vec3 u = edge(s->position, t[0], t[1]), v = edge(s->position, t[0], t[2]);
        vec3 du = edge(offset, t[0], t[1]), dv = edge(offset, t[0], t[2]);
        add_to_corners(out, t, vec3_add(vec3_cross(du, v), vec3_cross(u, dv)));
    }
}

void morph_normal_offset(float *out, double *work, const morph_surface *s, const float *offset)
{
    area_change(work, s, offset);
    for (size_t v = 0; v < s->vertex_count; ++v) {
        const double *change = work + v * 3, *area = s->area + v * 3;
        vec3 n = at(s->normal, (uint32_t)v);
        double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
        double along = change[0] * n.x + change[1] * n.y + change[2] * n.z;
        const double normal[3] = {n.x, n.y, n.z};
        for (int axis = 0; axis < 3; ++axis) {
            float bend = (float)((change[axis] - along * normal[axis]) / size);
            out[v * 3 + (size_t)axis] = isfinite(bend) ? bend : 0.0f;
        }
    }
}
