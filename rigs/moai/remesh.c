#include "remesh.h"

#include <math.h>
#include <stdlib.h>

/* Edges longer than LONG times the wanted length are split, edges shorter than SHORT times it are
 * collapsed. */
static const double LONG = 4.0 / 3.0, SHORT = 4.0 / 5.0;
/* Least quality of a new triangle. */
static const double POOR = 0.08;
/* Greatest turn of a triangle by an edit: the least cosine between its old and new normal. */
static const double TURN_COSINE = 0.2;

enum { SMOOTHING_ROUNDS = 12 };

/* ---- the form ---- */

/* Returns the wanted length of edges at a point. */
static double wanted_mm(const form *shape, vec3 p)
{
    return shape->edge_scale * shape->edge_mm(p);
}

/* Returns the gradient of the distance, by central differences. */
static vec3 gradient(const form *shape, vec3 p)
{
    const double step = 0.02;
    vec3 plus[3] = {{p.x + step, p.y, p.z}, {p.x, p.y + step, p.z}, {p.x, p.y, p.z + step}};
    vec3 minus[3] = {{p.x - step, p.y, p.z}, {p.x, p.y - step, p.z}, {p.x, p.y, p.z - step}};
    double slope[3];
    for (int k = 0; k < 3; ++k)
        slope[k] = (shape->distance(plus[k]) - shape->distance(minus[k])) / (2.0 * step);
    return (vec3){slope[0], slope[1], slope[2]};
}

/* Returns the part of a move that the constraints of a vertex (skin.h) allow. */
static vec3 masked(vec3 move, int hold)
{
    if (hold & (SKIN_MIDDLE | SKIN_CORNER))
        move.x = 0.0;
    if (hold & (SKIN_LEVEL | SKIN_CORNER))
        move.y = 0.0;
    return move;
}

/* Projects p to the surface by Newton steps of at most reach_mm, in the allowed directions. */
static vec3 projected(const form *shape, vec3 p, int hold, double reach_mm)
{
    for (int turn = 0; turn < 3; ++turn) {
        vec3 slope = masked(gradient(shape, p), hold);
        double square = vec3_dot(slope, slope);
        if (square < 0.01)
            break;
        double step = shape->distance(p) / square;
        double length = fabs(step) * sqrt(square);
        if (length > reach_mm)
            step *= reach_mm / length;
        p = vec3_sub(p, vec3_scale(slope, step));
    }
    return p;
}

static vec3 middle(vec3 a, vec3 b)
{
    return vec3_scale(vec3_add(a, b), 0.5);
}

/* Returns the length of an edge over the wanted length. */
static double relative_length(const skin *s, const form *shape, int32_t h)
{
    vec3 a = s->point[s->origin[h]], b = s->point[skin_target(s, h)];
    return vec3_length(vec3_sub(b, a)) / wanted_mm(shape, middle(a, b));
}

/* ---- the level line ---- */

static int crosses_level(const skin *s, int32_t h, vec3 line_end)
{
    vec3 a = s->point[s->origin[h]], b = s->point[skin_target(s, h)];
    if (a.z < line_end.z || b.z < line_end.z || (a.x > line_end.x && b.x > line_end.x))
        return 0;
    return (a.y < line_end.y && b.y > line_end.y) || (a.y > line_end.y && b.y < line_end.y);
}

/* Makes the ends of the line corners: points with only one neighbour on it. */
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
            return error_set(err, MRT_ERR_ARGUMENT, "the skin is full and cannot be cut");
        s->hold[vertex] |= SKIN_LEVEL;
    }
    mark_line_ends(s);
    return MRT_OK;
}

/* ---- split and collapse ---- */

/* Only an edge that is the longest of both its triangles is split. Any other order may never
 * end. */
static int is_longest(const skin *s, const form *shape, int32_t h, double length)
{
    const int32_t side[2] = {h, s->twin[h]};
    for (int k = 0; k < 2; ++k)
        if (side[k] != SKIN_NONE && (relative_length(s, shape, skin_next(side[k])) > length ||
                                     relative_length(s, shape, skin_previous(side[k])) > length))
            return 0;
    return 1;
}

/* Returns the number of splits, or SKIN_NONE if the skin is full. */
static int32_t split_sweep(skin *s, const form *shape)
{
    int32_t split_count = 0;
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h) {
        if (!skin_is_edge(s, h))
            continue;
        double length = relative_length(s, shape, h);
        if (!(length > LONG) || !is_longest(s, shape, h, length))
            continue;
        vec3 p = middle(s->point[s->origin[h]], s->point[skin_target(s, h)]);
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
        return error_set(err, MRT_ERR_ARGUMENT, "the skin is full; use edges longer than %g",
                         shape->edge_scale);
    return MRT_OK;
}

/* Returns the area of a triangle relative to its edges: 0.29 if they are equal, 0 if it is flat. */
static double quality_of(vec3 a, vec3 b, vec3 c)
{
    vec3 ab = vec3_sub(b, a), bc = vec3_sub(c, b), ca = vec3_sub(a, c);
    double squares = vec3_dot(ab, ab) + vec3_dot(bc, bc) + vec3_dot(ca, ca);
    return vec3_length(vec3_cross(ab, bc)) / (squares + 1e-300);
}

/* Tests a move of `vertex` to `to`. Returns 1 if the triangles at it keep their side and no edge
 * becomes too long. The triangles at `gone` vanish. */
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
        if (vec3_dot(before, after) < TURN_COSINE * lengths || degrades ||
            vec3_length(vec3_sub(pb, to)) > LONG * wanted_mm(shape, middle(pb, to)))
            return 0;
    }
    return 1;
}

/* Returns the position of a collapsed edge: its middle, unless its target has more constraints. */
static vec3 collapse_point(const skin *s, int32_t h)
{
    int32_t a = s->origin[h], b = skin_target(s, h);
    if (s->hold[a] == s->hold[b])
        return middle(s->point[a], s->point[b]);
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

/* Returns the squared difference of the valence from 6, or from 4 on a border. */
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
    return vec3_dot(one, old) < TURN_COSINE * length * vec3_length(one) ||
           vec3_dot(other, old) < TURN_COSINE * length * vec3_length(other);
}

/* An edge off the surface is flipped along a crease. On the surface the valence decides. */
static int wants_flip(const skin *s, const form *shape, int32_t h)
{
    int32_t g = s->twin[h];
    int32_t ia = s->origin[h], ib = s->origin[g];
    int32_t ic = s->origin[skin_previous(h)], id = s->origin[skin_previous(g)];
    vec3 a = s->point[ia], b = s->point[ib], c = s->point[ic], d = s->point[id];
    if (flip_turns_over(s, h, a, b, c, d))
        return 0;
    double now = pair_quality(a, b, c, d), then = pair_quality(d, c, a, b);
    double off_now = fabs(shape->distance(middle(a, b)));
    double off_then = fabs(shape->distance(middle(c, d)));
    double tolerance = 0.06 * wanted_mm(shape, middle(a, b));
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

/* ---- relax: moves vertices, without changing edges ---- */

/* Weight of even spacing, relative to that of the planes of the form. */
static const double SMOOTHING = 0.1;

typedef struct plane { /* a tangent plane of the form, and the area of skin that it represents */
    vec3 point, normal;
    double area;
} plane;

/* Returns the tangent plane of the shape at the foot of a nearby point. */
static plane plane_at(const form *shape, vec3 p, double area)
{
    vec3 slope = gradient(shape, p);
    double square = vec3_dot(slope, slope);
    double step = square > 0.01 ? shape->distance(p) / square : 0.0;
    return (plane){.point = vec3_sub(p, vec3_scale(slope, step)),
                   .normal = vec3_normalised(slope, (vec3){0, 0, 1}),
                   .area = area};
}

/* Computes three planes for each live triangle, towards its corners. Half-edge h has the plane at
 * its origin. */
static void measure_planes(plane *out, const skin *s, const form *shape)
{
    for (int32_t h = 0; h < 3 * s->triangle_count; ++h) {
        if (s->origin[h] == SKIN_NONE)
            continue;
        vec3 near = s->point[s->origin[h]];
        vec3 far = middle(s->point[skin_target(s, h)], s->point[s->origin[skin_previous(h)]]);
        vec3 p = vec3_add(vec3_scale(near, 2.0 / 3.0), vec3_scale(far, 1.0 / 3.0));
        out[h] = plane_at(shape, p, vec3_length(skin_triangle_normal(s, h / 3)) / 6.0);
    }
}

/* Computes the mean of the neighbours on the vertex's own line. Returns 0 if it is not an inner
 * point of a line. */
static int line_middle(const skin *s, int32_t vertex, vec3 *out)
{
    int32_t around[SKIN_RING];
    int32_t count = skin_neighbours(s, vertex, around), found = 0;
    vec3 sum = {0, 0, 0};
    for (int32_t i = 0; i < count; ++i)
        if (skin_common_line(s, around[i], vertex)) {
            sum = vec3_add(sum, s->point[around[i]]);
            ++found;
        }
    *out = vec3_scale(sum, 0.5);
    return found == 2;
}

/* Returns the mean of the triangles around a vertex, weighted by how much they exceed their wanted
 * size. */
static vec3 fan_middle(const skin *s, const form *shape, const plane *planes, int32_t vertex)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    vec3 sum = {0, 0, 0};
    double weights = 0.0;
    for (int32_t i = 0; i < count; ++i) {
        const plane *p = &planes[edge[i] - edge[i] % 3];
        vec3 centre = vec3_scale(vec3_add(vec3_add(p[0].point, p[1].point), p[2].point), 1.0 / 3.0);
        double size = wanted_mm(shape, centre);
        double weight = p->area / (size * size) + 1e-6;
        sum = vec3_add(sum, vec3_scale(centre, weight));
        weights += weight;
    }
    return vec3_scale(sum, 1.0 / weights);
}

static vec3 smoothing_target(const skin *s, const form *shape, const plane *planes, int32_t vertex)
{
    vec3 out;
    int hold = s->hold[vertex];
    if (hold & SKIN_CORNER || (hold & SKIN_LINES) == SKIN_LINES)
        return s->point[vertex];
    if (hold & SKIN_LINES)
        return line_middle(s, vertex, &out) ? out : s->point[vertex];
    return fan_middle(s, shape, planes, vertex);
}

/* Solves a symmetric positive definite 3 by 3 system in place, without pivoting. */
static vec3 solve3(double m[3][3], double r[3])
{
    for (int i = 0; i < 3; ++i)
        for (int k = i + 1; k < 3; ++k) {
            double factor = m[k][i] / m[i][i];
            for (int j = i; j < 3; ++j)
                m[k][j] -= factor * m[i][j];
            r[k] -= factor * r[i];
        }
    double z = r[2] / m[2][2];
    double y = (r[1] - m[1][2] * z) / m[1][1];
    return (vec3){(r[0] - m[0][1] * y - m[0][2] * z) / m[0][0], y, z};
}

static void hold_axis(double m[3][3], double r[3], int axis)
{
    for (int k = 0; k < 3; ++k)
        m[axis][k] = m[k][axis] = 0.0;
    m[axis][axis] = 1.0;
    r[axis] = 0.0;
}

/* Adds the squared distance to a plane to the least squares for a move from `at`. */
static void add_plane(double m[3][3], double r[3], const plane *p, vec3 at)
{
    const double n[3] = {p->normal.x, p->normal.y, p->normal.z};
    double offset = vec3_dot(vec3_sub(p->point, at), p->normal);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            m[row][column] += p->area * n[row] * n[column];
        r[row] += p->area * n[row] * offset;
    }
}

/* Returns the move that brings the vertex closest to the planes around it, and so into a crease if
 * there is one. In directions that the planes leave free it moves to the smoothing target. */
static vec3 best_move(const skin *s, const form *shape, const plane *planes, int32_t vertex)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    vec3 at = s->point[vertex];
    double m[3][3] = {{0}}, r[3] = {0}, weights = 0.0;
    for (int32_t i = 0; i < 3 * count; ++i) {
        const plane *p = &planes[edge[i / 3] - edge[i / 3] % 3 + i % 3];
        add_plane(m, r, p, at);
        weights += p->area;
    }
    vec3 pull = vec3_sub(smoothing_target(s, shape, planes, vertex), at);
    const double wish[3] = {pull.x, pull.y, pull.z};
    double share = SMOOTHING * weights + 1e-12;
    for (int k = 0; k < 3; ++k) {
        m[k][k] += share;
        r[k] += share * wish[k];
    }
    vec3 allowed = masked((vec3){1, 1, 1}, s->hold[vertex]);
    if (allowed.x == 0.0)
        hold_axis(m, r, 0);
    if (allowed.y == 0.0)
        hold_axis(m, r, 1);
    return solve3(m, r);
}

/* Returns 1 if all triangles around the vertex keep their side when it moves. */
static int move_is_safe(const skin *s, int32_t vertex, vec3 to)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    for (int32_t i = 0; i < count; ++i) {
        vec3 b = s->point[skin_target(s, edge[i])];
        vec3 c = s->point[s->origin[skin_previous(edge[i])]];
        vec3 before = skin_triangle_normal(s, edge[i] / 3);
        vec3 after = vec3_cross(vec3_sub(b, to), vec3_sub(c, to));
        double lengths = vec3_length(before) * vec3_length(after);
        if (vec3_dot(before, after) < TURN_COSINE * lengths)
            return 0;
    }
    return 1;
}

/* Runs one round: vertices move onto the form, into its creases, and to even distances. planes:
 * room for three per triangle of the skin, including dead ones. */
static void relax(skin *s, const form *shape, plane *planes)
{
    measure_planes(planes, s, shape);
    for (int32_t v = 0; v < s->vertex_count; ++v) {
        if (s->edge[v] == SKIN_NONE)
            continue;
        double reach = 0.5 * wanted_mm(shape, s->point[v]);
        vec3 move = best_move(s, shape, planes, v);
        double length = vec3_length(move);
        if (length > reach)
            move = vec3_scale(move, reach / length);
        vec3 to = projected(shape, vec3_add(s->point[v], move), s->hold[v], reach);
        for (int turn = 0; turn < 3 && !move_is_safe(s, v, to); ++turn)
            to = middle(s->point[v], to);
        if (move_is_safe(s, v, to))
            s->point[v] = to;
    }
}

/* ---- adapting ---- */

static plane *planes_create(const skin *s, error *err)
{
    plane *planes = malloc(((size_t)s->triangle_capacity * 3 + 1) * sizeof *planes);
    if (!planes)
        (void)error_set(err, MRT_ERR_MEMORY, "no memory for the planes of %d triangles",
                        s->triangle_capacity);
    return planes;
}

mrt_result remesh_adapt(skin *s, const form *shape, int32_t rounds, error *err)
{
    plane *planes = planes_create(s, err);
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
        relax(s, shape, planes);
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

/* Collapses edges, shortest first, until triangle_count are left or no candidates remain. If the
 * difference is odd, collapses one edge on the border first, then inner edges. Edges at a corner
 * cannot move, so they are left out. */
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
                         "the skin has %d triangles, but needs %d; use shorter edges",
                         s->live_triangle_count, triangle_count);
    plane *planes = planes_create(s, err);
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
                           "%d triangles are left instead of %d; use longer edges",
                           s->live_triangle_count, triangle_count);
        goto done;
    }
    for (int round = 0; round < SMOOTHING_ROUNDS; ++round) {
        flip_edges(s, shape);
        relax(s, shape, planes);
    }
done:
    free(list);
    free(planes);
    return result;
}
