#include "mouth.h"
#include "sculpt.h"

#include <math.h>
#include <stdlib.h>

/* A ring of the bag: half an ellipse, from the middle above around the corner to the middle below.
 * Its depth behind the slit is the same everywhere. */
typedef struct ring {
    double half_width_mm, above_mm, below_mm, depth_mm;
    double edge_mm; /* 0: same number of points as the slit */
} ring;

static const ring RINGS[] = {
    {27.4, 0.5, 0.5, 2.2, 0.0},   {28.2, 1.7, 1.8, 4.6, 2.9},    {29.5, 5.0, 5.4, 7.6, 3.8},
    {30.5, 9.5, 10.0, 12.0, 5.0}, {30.0, 12.5, 13.5, 18.5, 6.4}, {27.0, 11.5, 12.5, 25.5, 7.6},
    {18.0, 7.5, 8.0, 30.5, 7.6},
};
enum {
    RING_COUNT = sizeof RINGS / sizeof *RINGS,
    INNER_LIP_RINGS = 1, /* rings up to this one are stone, then the mouth begins */
    LINE_CAP = 64,
    RING_CAP = 2 * LINE_CAP + 1,
    QUARTER_STEPS = 256
};

/* The points between the lips, from the middle to the corner. */
typedef struct line {
    int32_t vertex[LINE_CAP], count;
} line;

/* One ring of vertices, from the middle above to the middle below. */
typedef struct loop {
    int32_t vertex[RING_CAP], count;
} loop;

static int is_on_line(const skin *s, int32_t v)
{
    vec3 end = SCULPT_LINE_END[SCULPT_LIP_LINE];
    return s->edge[v] != SKIN_NONE && s->hold[v] & SKIN_LEVEL && s->point[v].y == end.y &&
           s->point[v].z > end.z;
}

static mrt_result find_line(line *out, const skin *s, error *err)
{
    out->count = 0;
    for (int32_t v = 0; v < s->vertex_count; ++v) {
        if (!is_on_line(s, v))
            continue;
        if (out->count == LINE_CAP)
            return error_set(err, MRT_ERR_ARGUMENT,
                             "the line between the lips has more than %d points", LINE_CAP);
        int32_t i = out->count++;
        for (; i > 0 && s->point[out->vertex[i - 1]].x > s->point[v].x; --i)
            out->vertex[i] = out->vertex[i - 1];
        out->vertex[i] = v;
    }
    if (out->count < 3 || s->point[out->vertex[0]].x != 0.0)
        return error_set(err, MRT_ERR_FORMAT,
                         "the line between the lips does not begin at the middle");
    return MRT_OK;
}

void mouth_hold_line(skin *half)
{
    for (int32_t v = 0; v < half->vertex_count; ++v)
        if (is_on_line(half, v))
            half->hold[v] |= SKIN_CORNER;
}

/* ---- the rings ---- */

/* Computes a point of the quarter of the unit ellipse, t from its top (0) to its tip (1). */
static void quarter_point(double t, double *out_across, double *out_up)
{
    double square = (1.0 - t) * (1.0 - t);
    *out_across = (1.0 - square) / (1.0 + square);
    *out_up = 2.0 * (1.0 - t) / (1.0 + square);
}

/* Returns a point of the ring seen from the front; t from 0 (middle above) over 1 (tip) to 2
 * (middle below). */
static vec3 ring_outline(const ring *r, double t)
{
    double across, up;
    quarter_point(t <= 1.0 ? t : 2.0 - t, &across, &up);
    double y = t <= 1.0 ? up * r->above_mm : -up * r->below_mm;
    return (vec3){across * r->half_width_mm, y, 0.0};
}

static double outline_length(const ring *r)
{
    double length = 0.0;
    for (int i = 0; i < 2 * QUARTER_STEPS; ++i)
        length += vec3_length(vec3_sub(ring_outline(r, (double)(i + 1) / QUARTER_STEPS),
                                       ring_outline(r, (double)i / QUARTER_STEPS)));
    return length;
}

/* Returns an odd number, so that the upper and the lower half of the ring have the same number. */
static int32_t ring_point_count(const ring *r, int32_t line_count)
{
    if (r->edge_mm <= 0.0)
        return 2 * line_count - 1;
    return 2 * (int32_t)(0.5 * outline_length(r) / r->edge_mm + 0.5) + 1;
}

/* Returns the depth of the slit at x; beyond the corner, the depth of the corner. */
static double slit_z(const skin *s, const line *l, double x)
{
    int32_t i = 1;
    while (i < l->count - 1 && s->point[l->vertex[i]].x < x)
        ++i;
    vec3 a = s->point[l->vertex[i - 1]], b = s->point[l->vertex[i]];
    double t = (x - a.x) / (b.x - a.x);
    return a.z + (t < 1.0 ? t : 1.0) * (b.z - a.z);
}

/* Adds the ring's points at even distances. */
static mrt_result add_ring(loop *out, skin *s, const ring *r, const line *l, error *err)
{
    out->count = ring_point_count(r, l->count);
    if (out->count > RING_CAP)
        return error_set(err, MRT_ERR_ARGUMENT, "a ring of the mouth has %d points", out->count);
    double step = outline_length(r) / (out->count - 1), passed = 0.0;
    int32_t k = 0;
    for (int i = 0; i <= 2 * QUARTER_STEPS && k < out->count; ++i) {
        vec3 p = ring_outline(r, (double)i / QUARTER_STEPS);
        if (i > 0)
            passed += vec3_length(vec3_sub(p, ring_outline(r, (double)(i - 1) / QUARTER_STEPS)));
        if (passed + 1e-6 < step * k && i < 2 * QUARTER_STEPS)
            continue;
        int is_end = k == 0 || k == out->count - 1;
        vec3 at = {is_end ? 0.0 : p.x, p.y + s->point[l->vertex[0]].y,
                   slit_z(s, l, p.x) - r->depth_mm};
        out->vertex[k++] = s->vertex_count;
        mrt_result result = skin_add_point(s, at, is_end ? SKIN_MIDDLE : SKIN_FREE, err);
        if (result < 0)
            return result;
    }
    return k == out->count ? MRT_OK
                           : error_set(err, MRT_ERR_FORMAT, "a ring of the mouth has a gap");
}

/* ---- connecting rings ---- */

static double distance_between(const skin *s, int32_t a, int32_t b)
{
    return vec3_length(vec3_sub(s->point[a], s->point[b]));
}

/* Fills the strip between two rings, b behind a. Prefers the shorter diagonal. */
static mrt_result fill_strip(skin *s, const loop *a, const loop *b, error *err)
{
    int32_t i = 0, k = 0;
    while (i < a->count - 1 || k < b->count - 1) {
        int goes_along_a = k == b->count - 1;
        if (i < a->count - 1 && !goes_along_a)
            goes_along_a = distance_between(s, a->vertex[i + 1], b->vertex[k]) <=
                           distance_between(s, a->vertex[i], b->vertex[k + 1]);
        mrt_result result =
            goes_along_a ? skin_add_triangle(s, a->vertex[i + 1], a->vertex[i], b->vertex[k], err)
                         : skin_add_triangle(s, a->vertex[i], b->vertex[k], b->vertex[k + 1], err);
        if (result < 0)
            return result;
        goes_along_a ? ++i : ++k;
    }
    return MRT_OK;
}

/* Closes the last ring by connecting its upper half to its lower half. */
static mrt_result close_bag(skin *s, const loop *a, error *err)
{
    int32_t tip = (a->count - 1) / 2, last = a->count - 1, above = 0, below = 0;
    while (above < tip || below < tip - 1) {
        int goes_above = below == tip - 1;
        if (above < tip && !goes_above)
            goes_above = above <= below;
        int32_t top = a->vertex[above], bottom = a->vertex[last - below];
        mrt_result result =
            goes_above ? skin_add_triangle(s, a->vertex[above + 1], top, bottom, err)
                       : skin_add_triangle(s, bottom, a->vertex[last - below - 1], top, err);
        if (result < 0)
            return result;
        goes_above ? ++above : ++below;
    }
    return MRT_OK;
}

mrt_result mouth_triangle_count(int32_t *out, const skin *half, error *err)
{
    line l;
    mrt_result result = find_line(&l, half, err);
    if (result < 0)
        return result;
    int32_t before = 2 * l.count - 1;
    *out = 0;
    for (int i = 0; i < RING_COUNT; ++i) {
        int32_t count = ring_point_count(&RINGS[i], l.count);
        *out += before + count - 2;
        before = count;
    }
    *out += before - 2;
    return MRT_OK;
}

/* ---- the cut ---- */

/* Returns the half-edge from a to b, or SKIN_NONE if they are not neighbours. */
static int32_t edge_between(const skin *s, int32_t a, int32_t b)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, a, edge);
    for (int32_t i = 0; i < count && i < SKIN_RING; ++i)
        if (skin_target(s, edge[i]) == b)
            return edge[i];
    return SKIN_NONE;
}

/* Gives the triangles below the line their own copy of the line's point i. The line runs towards
 * +x, so they are on its right: from the edge to the next point, clockwise to the edge to the
 * previous one, or to the border. */
static mrt_result split_point(skin *out, const skin *half, const line *l, int32_t i,
                              int32_t *out_lower, error *err)
{
    int32_t v = l->vertex[i], h = edge_between(half, v, l->vertex[i + 1]);
    int32_t before = i > 0 ? l->vertex[i - 1] : SKIN_NONE;
    if (h == SKIN_NONE)
        return error_set(err, MRT_ERR_FORMAT, "the line between the lips has a gap");
    *out_lower = out->vertex_count;
    mrt_result result =
        skin_add_point(out, half->point[v], (uint8_t)(half->hold[v] & SKIN_MIDDLE), err);
    while (result >= 0 && half->twin[h] != SKIN_NONE) {
        h = skin_next(half->twin[h]);
        out->origin[h] = *out_lower;
        if (skin_target(half, h) == before)
            break;
    }
    return result;
}

static mrt_result cut_slit(skin *out, const skin *half, const line *l, loop *slit, error *err)
{
    mrt_result result = MRT_OK;
    slit->count = 2 * l->count - 1;
    for (int32_t i = 0; i < l->count; ++i)
        slit->vertex[i] = l->vertex[i];
    for (int32_t i = 0; i < l->count - 1 && result >= 0; ++i)
        result = split_point(out, half, l, i, &slit->vertex[slit->count - 1 - i], err);
    return result;
}

static mrt_result copy_half(skin *out, const skin *half, error *err)
{
    mrt_result result = MRT_OK;
    for (int32_t v = 0; v < half->vertex_count && result >= 0; ++v)
        result = skin_add_point(out, half->point[v], half->hold[v], err);
    for (int32_t t = 0; t < half->triangle_count && result >= 0; ++t) {
        const int32_t *corner = half->origin + 3 * (size_t)t;
        result = skin_add_triangle(out, corner[0], corner[1], corner[2], err);
    }
    return result;
}

static mrt_result add_bag(skin *out, const line *l, const loop *slit, int32_t *out_first_triangle,
                          error *err)
{
    loop pair[2] = {*slit};
    mrt_result result = MRT_OK;
    for (int i = 0; i < RING_COUNT && result >= 0; ++i) {
        if (i == INNER_LIP_RINGS)
            *out_first_triangle = out->triangle_count;
        result = add_ring(&pair[(i + 1) % 2], out, &RINGS[i], l, err);
        if (result >= 0)
            result = fill_strip(out, &pair[i % 2], &pair[(i + 1) % 2], err);
    }
    return result < 0 ? result : close_bag(out, &pair[RING_COUNT % 2], err);
}

mrt_result mouth_open(skin *out, const skin *half, int32_t *out_first_triangle, error *err)
{
    line l;
    loop slit;
    int32_t bag;
    *out = (skin){0};
    mrt_result result = find_line(&l, half, err);
    if (result >= 0)
        result = mouth_triangle_count(&bag, half, err);
    if (result >= 0)
        result =
            skin_create(out, half->vertex_count + bag + RING_CAP, half->triangle_count + bag, err);
    if (result >= 0)
        result = copy_half(out, half, err);
    if (result >= 0)
        result = cut_slit(out, half, &l, &slit, err);
    if (result >= 0)
        result = add_bag(out, &l, &slit, out_first_triangle, err);
    for (int32_t h = 0; h < 3 * out->triangle_count && result >= 0; ++h)
        out->edge[out->origin[h]] = h;
    if (result >= 0)
        result = skin_join(out, err);
    if (result < 0)
        skin_destroy(out);
    return result;
}
