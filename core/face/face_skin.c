/* The exact meter of a face with a rig: is any skin turned over? See face_min_determinant. */
#include "face/face_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double bent_at_rest = 0.5; /* cosine: edges bent by more do not count */

/* An edge of one triangle, its ends in ascending order. */
typedef struct half_edge {
    uint32_t end[2], triangle;
} half_edge;

static int by_ends(const void *a, const void *b)
{
    const half_edge *x = a, *y = b;
    if (x->end[0] != y->end[0])
        return x->end[0] < y->end[0] ? -1 : 1;
    if (x->end[1] != y->end[1])
        return x->end[1] < y->end[1] ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static vec3 vertex_at(const points *p, uint32_t slot)
{
    return (vec3){(double)p->x[slot], (double)p->y[slot], (double)p->z[slot]};
}

/* Its unit normal, (0, 0, 0) without an area; returns twice the area. */
static double measure_triangle(const points *p, const uint32_t *corner, vec3 *out_normal)
{
    vec3 a = vertex_at(p, corner[0]);
    vec3 n = vec3_cross(vec3_sub(vertex_at(p, corner[1]), a), vec3_sub(vertex_at(p, corner[2]), a));
    double size = vec3_length(n);
    *out_normal = size > 0.0 ? vec3_scale(n, 1.0 / size) : (vec3){0, 0, 0};
    return size;
}

/* Triangles with an area at rest and a vertex that is free to move. */
static void list_skin(face *f, const mesh *m)
{
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        uint32_t *corner = f->skin + (size_t)3 * f->skin_count;
        bool is_mobile = false;
        for (size_t c = 0; c < 3; ++c) {
            corner[c] = f->order.slot_of_file[m->triangle[(size_t)3 * t + c]];
            is_mobile = is_mobile || f->mobility[corner[c]] > 0.0f;
        }
        double area = measure_triangle(&f->rest, corner, &f->normal[f->skin_count]);
        if (!is_mobile || !(area > 0.0))
            continue;
        f->rest_area[f->skin_count++] = area;
    }
}

static void pair_edges(face *f, half_edge *half, uint32_t half_count)
{
    qsort(half, half_count, sizeof *half, by_ends);
    for (uint32_t i = 0; i + 1 < half_count; ++i) {
        const half_edge *a = &half[i], *b = &half[i + 1];
        if (a->end[0] != b->end[0] || a->end[1] != b->end[1])
            continue;
        double cosine = vec3_dot(f->normal[a->triangle], f->normal[b->triangle]);
        if (cosine > bent_at_rest)
            f->edge[f->edge_count++] =
                (face_edge){.triangle = {a->triangle, b->triangle}, .cosine = cosine};
    }
}

static uint32_t list_halves(const face *f, half_edge *out)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < f->skin_count; ++t)
        for (size_t c = 0; c < 3; ++c) {
            uint32_t a = f->skin[(size_t)3 * t + c], b = f->skin[(size_t)3 * t + (c + 1) % 3];
            out[count++] = (half_edge){.end = {a < b ? a : b, a < b ? b : a}, .triangle = t};
        }
    return count;
}

mrt_result face_skin_create(face *f, const mesh *m, error *err)
{
    size_t triangles = (size_t)m->triangle_count + 1;
    if (!f->rig)
        return MRT_OK;
    half_edge *half = malloc(3 * triangles * sizeof *half);
    f->skin = malloc(3 * triangles * sizeof *f->skin);
    f->rest_area = malloc(triangles * sizeof *f->rest_area);
    f->area = malloc(triangles * sizeof *f->area);
    f->bend = malloc(triangles * sizeof *f->bend);
    f->normal = malloc(triangles * sizeof *f->normal);
    f->edge = malloc(3 * triangles * sizeof *f->edge);
    if (!half || !f->skin || !f->rest_area || !f->area || !f->bend || !f->normal || !f->edge) {
        free(half);
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u triangles", m->triangle_count);
    }
    list_skin(f, m);
    pair_edges(f, half, list_halves(f, half));
    free(half);
    return MRT_OK;
}

void face_skin_destroy(face *f)
{
    free(f->skin);
    free(f->rest_area);
    free(f->area);
    free(f->bend);
    free(f->normal);
    free(f->edge);
}

static double skin_determinant(const face *f)
{
    double smallest = 1.0;
    for (uint32_t t = 0; t < f->skin_count; ++t) {
        f->area[t] = measure_triangle(&f->shown, f->skin + (size_t)3 * t, &f->normal[t]);
        f->bend[t] = 1.0;
    }
    for (uint32_t i = 0; i < f->edge_count; ++i) {
        const face_edge *e = &f->edge[i];
        double now = vec3_dot(f->normal[e->triangle[0]], f->normal[e->triangle[1]]);
        double agreement = (1.0 + 2.0 * now) / (1.0 + 2.0 * e->cosine);
        for (int side = 0; side < 2; ++side)
            f->bend[e->triangle[side]] = fmin(f->bend[e->triangle[side]], agreement);
    }
    for (uint32_t t = 0; t < f->skin_count; ++t) {
        double determinant = f->area[t] / f->rest_area[t] * f->bend[t];
        smallest = t == 0 || determinant < smallest ? determinant : smallest;
    }
    return smallest;
}

double face_min_determinant(const face *f)
{
    if (f->rig)
        return skin_determinant(f);
    return f->control_count > 0 ? csrbf_min_determinant(f->field[0].solver, f->origin) : 1.0;
}
