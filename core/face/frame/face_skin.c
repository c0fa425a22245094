/* The exact meter of a face with a rig, which finds skin that is turned over. See
 * face_min_determinant. */
#include "face/frame/frame.h"

#include <math.h>
#include <stdlib.h>

vec3 face_skin_area(const points *p, const uint32_t *corner)
{
    vec3 a = points_position(p, corner[0]);
    return vec3_cross(vec3_sub(points_position(p, corner[1]), a),
                      vec3_sub(points_position(p, corner[2]), a));
}

/* Twice a triangle's area over the square of its longest edge. Flatter triangles are needles, as in
 * scans and quantised files. They turn over with the least motion, so they are not measured. */
static const double flattest = 1e-4;

static bool is_needle(const points *p, const uint32_t *corner)
{
    double longest = 0.0;
    for (int i = 0; i < 3; ++i) {
        vec3 edge =
            vec3_sub(points_position(p, corner[i]), points_position(p, corner[(i + 1) % 3]));
        longest = fmax(longest, vec3_dot(edge, edge));
    }
    return !(vec3_length(face_skin_area(p, corner)) > flattest * longest);
}

/* Lists triangles with an area at rest and a mobile vertex. */
static void list_skin(face *f, const mesh *m)
{
    for (uint32_t t = 0; t < m->triangle_count; ++t) {
        uint32_t *corner = f->skin + (size_t)3 * f->skin_count;
        bool is_mobile = false;
        for (size_t c = 0; c < 3; ++c) {
            corner[c] = f->order.slot_of_file[mesh_point(m, m->triangle[(size_t)3 * t + c])];
            is_mobile = is_mobile || f->mobility[corner[c]] > 0.0f;
        }
        if (is_mobile && !is_needle(&f->rest, corner))
            f->skin_count += 1;
    }
}

static int by_slot(const void *a, const void *b)
{
    const uint32_t *p = a, *q = b;
    for (int i = 0; i < 3; ++i)
        if (p[i] != q[i])
            return p[i] < q[i] ? -1 : 1;
    return 0;
}

mrt_result face_skin_create(face *f, const mesh *m, error *err)
{
    f->skin = arrays_add(&f->arrays, 3 * ((size_t)m->triangle_count + 1), sizeof *f->skin);
    if (!f->skin)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u triangles", m->triangle_count);
    list_skin(f, m);
    qsort(f->skin, f->skin_count, 3 * sizeof *f->skin,
          by_slot); /* neighbours are near each other in memory */
    const float *const rest[3] = {f->rest.x, f->rest.y, f->rest.z};
    return surface_meter_create(&f->surface_meter, rest, f->rest.count, f->skin, f->skin_count,
                                err);
}

vec3 face_skin_along(const face *f, const uint32_t *corner)
{
    vec3 normal = face_skin_area(&f->rest, corner);
    double share[RIG_BONES_MAX];
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        const float *weight = f->field[b].weight;
        share[b] =
            ((double)weight[corner[0]] + (double)weight[corner[1]] + (double)weight[corner[2]]) /
            3.0;
    }
    blend here = blend_of(share, f->pose, f->bones.moves, f->bone_count);
    return vec3_add(normal, matrix3x3_apply(&here.rotation, normal));
}

/* Returns true if a / (|b| c) is certainly more than `least`. Avoids a square root. */
static bool is_above(double a, double b_squared, double c_squared, double least)
{
    const double margin = 1.0 + 1e-9; /* cases that rounding could decide are computed exactly */
    return a > 0.0 && (least <= 0.0 || a * a > margin * least * least * b_squared * c_squared);
}

/* The part of face_skin_along that all triangles of a pose share: the moving bones and their
 * rotations. */
typedef struct skin_turns {
    uint32_t count;
    const float *weight[RIG_BONES_MAX];
    matrix3x3 turn[RIG_BONES_MAX]; /* R_b - I */
} skin_turns;

static void skin_turns_of(skin_turns *out, const face *f)
{
    out->count = 0;
    for (uint32_t b = 0; b < f->bone_count; ++b) {
        if (!f->bones.moves[b])
            continue;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                out->turn[out->count].at[i][j] = f->pose[b].r[i][j] - (i == j ? 1.0 : 0.0);
        out->weight[out->count++] = f->field[b].weight;
    }
}

/* Same bits as face_skin_along; rest: face_skin_area of the triangle. */
static vec3 skin_along(const skin_turns *turns, vec3 rest, const uint32_t *corner)
{
    matrix3x3 sum = {{{0}}};
    for (uint32_t b = 0; b < turns->count; ++b) {
        const float *weight = turns->weight[b];
        double share =
            ((double)weight[corner[0]] + (double)weight[corner[1]] + (double)weight[corner[2]]) /
            3.0;
        if (share == 0.0)
            continue;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                sum.at[i][j] += share * turns->turn[b].at[i][j];
    }
    return vec3_add(rest, matrix3x3_apply(&sum, rest));
}

static double skin_determinant(const face *f, uint32_t *out_triangle)
{
    double smallest = 1.0;
    skin_turns turns;
    *out_triangle = 0;
    skin_turns_of(&turns, f);
    for (uint32_t t = 0; t < f->skin_count; ++t) {
        const uint32_t *corner = f->skin + (size_t)3 * t;
        vec3 rest = face_skin_area(&f->rest, corner), shown = face_skin_area(&f->shown, corner);
        vec3 along = skin_along(&turns, rest, corner);
        if (t > 0 && is_above(vec3_dot(shown, along), vec3_dot(along, along), vec3_dot(rest, rest),
                              smallest))
            continue;
        double determinant = vec3_dot(shown, vec3_normalised(along, rest)) / vec3_length(rest);
        if (t > 0 && determinant >= smallest)
            continue;
        smallest = determinant;
        *out_triangle = t;
    }
    return smallest;
}

double face_min_determinant(const face *f)
{
    uint32_t triangle;
    if (f->rig)
        return skin_determinant(f, &triangle);
    return f->control_count > 0 ? csrbf_min_determinant(f->field[0].solver, f->origin) : 1.0;
}

double face_worst_triangle(const face *f, vec3 *out_rest)
{
    uint32_t triangle;
    double determinant = skin_determinant(f, &triangle);
    const uint32_t *corner = f->skin + (size_t)3 * triangle;
    *out_rest = (vec3){0, 0, 0};
    for (int i = 0; i < 3 && f->skin_count > 0; ++i)
        *out_rest =
            vec3_add(*out_rest, vec3_scale(points_position(&f->rest, corner[i]), 1.0 / 3.0));
    return determinant;
}

face_surface face_measure_surface(const face *f)
{
    const float *const at[3] = {f->shown.x, f->shown.y, f->shown.z};
    face_surface out = {.min_determinant = face_min_determinant(f),
                        .held_back_mm = f->meter.held_back_mm};
    surface_meter_measure(f->surface_meter, &out.skin, at);
    return out;
}
