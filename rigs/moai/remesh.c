#include "remesh.h"
#include "relax.h"

#include <math.h>
#include <stdlib.h>

/* Split edges longer than, and collapse edges shorter than, this many times the length wanted. */
static const double LONG = 4.0 / 3.0, SHORT = 4.0 / 5.0;
/* A triangle of less quality than this is not made. */
static const double POOR = 0.08;

enum { SMOOTHING_ROUNDS = 12 };

/* The length of an edge, 1 being the length wanted. */
static double relative_length(const skin *s, const form *shape, int32_t h)
{
    vec3 a = s->point[s->origin[h]], b = s->point[skin_target(s, h)];
    return vec3_length(vec3_sub(b, a)) / form_wanted_mm(shape, form_middle(a, b));
}

/* ---- the level line ---- */

static int crosses_level(const skin *s, int32_t h, vec3 line_end)
{
    vec3 a = s->point[s->origin[h]], b = s->point[skin_target(s, h)];
    if (a.z < line_end.z || b.z < line_end.z || (a.x > line_end.x && b.x > line_end.x))
        return 0;
    return (a.y < line_end.y && b.y > line_end.y) || (a.y > line_end.y && b.y < line_end.y);
}

/* The end of the line, where it has one neighbour only, is a corner. */
static void mark_line_ends(skin *s)
{
    for (int32_t v = 0; v < s->vertex_count; ++v) {
        int32_t around[SKIN_RING];
        if (!(s->hold[v] & SKIN_LEVEL) || s->hold[v] & SKIN_MIDDLE)
            continue;
        int32_t count = skin_neighbours(s, v, around), line_count = 0;
        for (int32_t i = 0; i < count && i < SKIN_RING; ++i)
            line_count += (skin_common_line(s, v, around[i]) & SKIN_LEVEL) != 0;
        if (line_count < 2)
            s->hold[v] |= SKIN_CORNER;
    }
}

mrt_result remesh_cut_level(skin *s, vec3 line_end, error *err)
{
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h) {
        if (!skin_is_edge(s, h) || !crosses_level(s, h, line_end))
            continue;
        vec3 a = s->point[s->origin[h]], b = s->point[skin_target(s, h)];
        double at = (line_end.y - a.y) / (b.y - a.y);
        vec3 p = vec3_add(a, vec3_scale(vec3_sub(b, a), at));
        p.y = line_end.y;
        int32_t vertex = skin_split(s, h, p);
        if (vertex == SKIN_NONE)
            return error_set(err, MRT_ERR_ARGUMENT, "the skin is full: it cannot be cut");
        s->hold[vertex] |= SKIN_LEVEL;
    }
    mark_line_ends(s);
    return MRT_OK;
}

/* ---- split and collapse ---- */

/* Only the longest edge of both its triangles is split: any other order can go on without end. */
static int is_longest(const skin *s, const form *shape, int32_t h, double length)
{
    const int32_t side[2] = {h, s->twin[h]};
    for (int k = 0; k < 2; ++k)
        if (side[k] != SKIN_NONE && (relative_length(s, shape, skin_next(side[k])) > length ||
                                     relative_length(s, shape, skin_previous(side[k])) > length))
            return 0;
    return 1;
}

/* Returns how many were split; SKIN_NONE: the skin is full. */
static int32_t split_sweep(skin *s, const form *shape)
{
    int32_t split_count = 0;
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h) {
        if (!skin_is_edge(s, h))
            continue;
        double length = relative_length(s, shape, h);
        if (!(length > LONG) || !is_longest(s, shape, h, length))
            continue;
        vec3 p = form_middle(s->point[s->origin[h]], s->point[skin_target(s, h)]);
        if (skin_split(s, h, p) == SKIN_NONE)
            return SKIN_NONE;
        ++split_count;
    }
    return split_count;
}

static mrt_result split_long(skin *s, const form *shape, error *err)
{
    int32_t split_count;
    do {
        split_count = split_sweep(s, shape);
    } while (split_count > 0);
    if (split_count == SKIN_NONE)
        return error_set(err, MRT_ERR_ARGUMENT, "the skin is full: ask for edges longer than %g",
                         shape->edge_scale);
    return MRT_OK;
}

/* Of a triangle: its area against its edges; 0.29 when they are equal, 0 when it is flat. */
static double quality_of(vec3 a, vec3 b, vec3 c)
{
    vec3 ab = vec3_sub(b, a), bc = vec3_sub(c, b), ca = vec3_sub(a, c);
    double squares = vec3_dot(ab, ab) + vec3_dot(bc, bc) + vec3_dot(ca, ca);
    return vec3_length(vec3_cross(ab, bc)) / (squares + 1e-300);
}

/* Whether the triangles that leave `vertex` keep their side, and no edge becomes too long, when it
 * moves to `to`; the triangles at `gone` vanish. */
static int fan_survives(const skin *s, const form *shape, int32_t vertex, int32_t gone, vec3 to)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    for (int32_t i = 0; i < count; ++i) {
        int32_t b = skin_target(s, edge[i]), c = s->origin[skin_previous(edge[i])];
        if (b == gone || c == gone)
            continue;
        vec3 pb = s->point[b], pc = s->point[c];
        vec3 before = skin_triangle_normal(s, edge[i] / 3);
        vec3 after = vec3_cross(vec3_sub(pb, to), vec3_sub(pc, to));
        double lengths = vec3_length(before) * vec3_length(after);
        double quality = quality_of(to, pb, pc);
        int degrades = quality < POOR && quality < quality_of(s->point[vertex], pb, pc);
        if (vec3_dot(before, after) < RELAX_TURN_COSINE * lengths || degrades ||
            vec3_length(vec3_sub(pb, to)) > LONG * form_wanted_mm(shape, form_middle(pb, to)))
            return 0;
    }
    return 1;
}

/* Where the end of a collapsed edge goes: the middle, unless its target holds more. */
static vec3 collapse_point(const skin *s, int32_t h)
{
    int32_t a = s->origin[h], b = skin_target(s, h);
    if (s->hold[a] == s->hold[b])
        return form_middle(s->point[a], s->point[b]);
    return s->point[b];
}

static int try_collapse(skin *s, const form *shape, int32_t h)
{
    int32_t a = s->origin[h], b = skin_target(s, h);
    if (!skin_may_collapse(s, h))
        return 0;
    vec3 to = collapse_point(s, h);
    if (!fan_survives(s, shape, a, b, to) || !fan_survives(s, shape, b, a, to))
        return 0;
    skin_collapse(s, h);
    s->point[b] = to;
    return 1;
}

static int collapse_edge(skin *s, const form *shape, int32_t h)
{
    int32_t g = s->twin[h];
    if (try_collapse(s, shape, h))
        return 1;
    if (g != SKIN_NONE)
        return try_collapse(s, shape, g);
    return 0;
}

static void collapse_short(skin *s, const form *shape)
{
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h)
        if (skin_is_edge(s, h) && relative_length(s, shape, h) < SHORT)
            (void)collapse_edge(s, shape, h);
}

/* ---- flip ---- */

static double pair_quality(vec3 a, vec3 b, vec3 c, vec3 d)
{
    double one = quality_of(a, b, c), other = quality_of(b, a, d);
    return one < other ? one : other;
}

/* How far the valences are from 6, or from 4 on a border, in squares. */
static int32_t valence_error(const skin *s, int32_t vertex, int32_t change)
{
    int32_t around[SKIN_RING];
    int32_t count = skin_neighbours(s, vertex, around) + change;
    int32_t wrong = count - (s->hold[vertex] & SKIN_MIDDLE ? 4 : 6);
    return wrong * wrong;
}

static int flip_turns_over(const skin *s, int32_t h, vec3 a, vec3 b, vec3 c, vec3 d)
{
    vec3 old = vec3_add(skin_triangle_normal(s, h / 3), skin_triangle_normal(s, s->twin[h] / 3));
    vec3 one = vec3_cross(vec3_sub(d, a), vec3_sub(c, a));
    vec3 other = vec3_cross(vec3_sub(c, b), vec3_sub(d, b));
    double length = vec3_length(old);
    return vec3_dot(one, old) < RELAX_TURN_COSINE * length * vec3_length(one) ||
           vec3_dot(other, old) < RELAX_TURN_COSINE * length * vec3_length(other);
}

/* An edge off the surface is turned along a crease; on the surface, valence decides. */
static int wants_flip(const skin *s, const form *shape, int32_t h)
{
    int32_t g = s->twin[h];
    int32_t ia = s->origin[h], ib = s->origin[g];
    int32_t ic = s->origin[skin_previous(h)], id = s->origin[skin_previous(g)];
    vec3 a = s->point[ia], b = s->point[ib], c = s->point[ic], d = s->point[id];
    if (flip_turns_over(s, h, a, b, c, d))
        return 0;
    double now = pair_quality(a, b, c, d), then = pair_quality(d, c, a, b);
    double off_now = fabs(shape->distance(form_middle(a, b)));
    double off_then = fabs(shape->distance(form_middle(c, d)));
    double tolerance = 0.06 * form_wanted_mm(shape, form_middle(a, b));
    if (off_now > tolerance || off_then > tolerance)
        return off_then < 0.8 * off_now && then > POOR;
    int32_t valence_now = valence_error(s, ia, 0) + valence_error(s, ib, 0) +
                          valence_error(s, ic, 0) + valence_error(s, id, 0);
    int32_t valence_then = valence_error(s, ia, -1) + valence_error(s, ib, -1) +
                           valence_error(s, ic, 1) + valence_error(s, id, 1);
    if (valence_then != valence_now)
        return valence_then < valence_now && then > 0.5 * now;
    return then > 1.05 * now;
}

static void flip_edges(skin *s, const form *shape)
{
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h)
        if (skin_is_edge(s, h) && s->twin[h] != SKIN_NONE && wants_flip(s, shape, h))
            (void)skin_flip(s, h);
}

static relax_plane *planes_create(const skin *s, error *err)
{
    relax_plane *planes = malloc(((size_t)s->triangle_capacity * 3 + 1) * sizeof *planes);
    if (!planes)
        (void)error_set(err, MRT_ERR_MEMORY, "no memory for the planes of %d triangles",
                        s->triangle_capacity);
    return planes;
}

mrt_result remesh_adapt(skin *s, const form *shape, int32_t rounds, error *err)
{
    relax_plane *planes = planes_create(s, err);
    if (!planes)
        return MRT_ERR_MEMORY;
    mrt_result result = MRT_OK;
    for (int32_t round = 0; round < rounds && result >= 0; ++round) {
        result = split_long(s, shape, err);
        if (result < 0)
            break;
        collapse_short(s, shape);
        skin_compact(s);
        flip_edges(s, shape);
        relax_round(s, shape, planes);
    }
    free(planes);
    return result;
}

/* ---- the exact number of triangles ---- */

typedef struct candidate {
    double length;
    int32_t h;
} candidate;

static int compare_candidates(const void *a, const void *b)
{
    const candidate *p = a, *q = b;
    if (p->length != q->length)
        return p->length < q->length ? -1 : 1;
    return (p->h > q->h) - (p->h < q->h);
}

static int touches_corner(const skin *s, int32_t h)
{
    return (s->hold[s->origin[h]] | s->hold[skin_target(s, h)]) & SKIN_CORNER;
}

/* Collapses edges, the shortest first, until triangle_count are left or the candidates are used up:
 * one edge on the border if an odd number is to go, then inner edges; none at a corner, which could
 * not give way. */
static void collapse_shortest(skin *s, const form *shape, int32_t triangle_count, candidate *list)
{
    int32_t count = 0;
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h)
        if (skin_is_edge(s, h) && !touches_corner(s, h))
            list[count++] = (candidate){relative_length(s, shape, h), h};
    qsort(list, (size_t)count, sizeof *list, compare_candidates);
    int is_odd = (s->live_triangle_count - triangle_count) % 2;
    for (int32_t i = 0; i < count && is_odd; ++i)
        if (s->twin[list[i].h] == SKIN_NONE)
            is_odd = !collapse_edge(s, shape, list[i].h);
    for (int32_t i = 0; i < count && s->live_triangle_count > triangle_count; ++i) {
        int32_t h = list[i].h;
        if (s->origin[h] != SKIN_NONE && s->twin[h] != SKIN_NONE && !touches_corner(s, h))
            (void)collapse_edge(s, shape, h);
    }
}

mrt_result remesh_reduce(skin *s, const form *shape, int32_t triangle_count, error *err)
{
    if (s->live_triangle_count < triangle_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%d triangles are there, %d are wanted: ask for shorter edges",
                         s->live_triangle_count, triangle_count);
    relax_plane *planes = planes_create(s, err);
    candidate *list = malloc(((size_t)s->triangle_count * 3 + 1) * sizeof *list);
    mrt_result result = planes && list ? MRT_OK : MRT_ERR_MEMORY;
    if (result < 0) {
        (void)error_set(err, result, "no memory for %d edges", 3 * s->triangle_count);
        goto done;
    }
    collapse_shortest(s, shape, triangle_count, list);
    skin_compact(s);
    if (s->live_triangle_count > triangle_count) {
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%d triangles are left, %d are wanted: ask for longer edges",
                           s->live_triangle_count, triangle_count);
        goto done;
    }
    for (int round = 0; round < SMOOTHING_ROUNDS; ++round) {
        flip_edges(s, shape);
        relax_round(s, shape, planes);
    }
done:
    free(list);
    free(planes);
    return result;
}
