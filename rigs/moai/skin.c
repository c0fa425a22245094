#include "skin.h"

#include <stdlib.h>

mrt_result skin_create(skin *out, int32_t vertex_capacity, int32_t triangle_capacity, error *err)
{
    size_t vertices = (size_t)vertex_capacity, half_edges = (size_t)triangle_capacity * 3;
    *out = (skin){.vertex_capacity = vertex_capacity, .triangle_capacity = triangle_capacity};
    out->point = calloc(vertices, sizeof *out->point);
    out->hold = calloc(vertices, sizeof *out->hold);
    out->edge = calloc(vertices, sizeof *out->edge);
    out->origin = calloc(half_edges, sizeof *out->origin);
    out->twin = calloc(half_edges, sizeof *out->twin);
    if (out->point && out->hold && out->edge && out->origin && out->twin)
        return MRT_OK;
    skin_destroy(out);
    return error_set(err, MRT_ERR_MEMORY, "no memory for a skin of %d vertices", vertex_capacity);
}

void skin_destroy(skin *s)
{
    if (!s)
        return;
    free(s->point);
    free(s->hold);
    free(s->edge);
    free(s->origin);
    free(s->twin);
    *s = (skin){0};
}

static int32_t append_vertex(skin *s, vec3 point, uint8_t hold)
{
    if (s->vertex_count == s->vertex_capacity)
        return SKIN_NONE;
    int32_t vertex = s->vertex_count++;
    s->point[vertex] = point;
    s->hold[vertex] = hold;
    s->edge[vertex] = SKIN_NONE;
    return vertex;
}

static void set_triangle(skin *s, int32_t triangle, int32_t a, int32_t b, int32_t c)
{
    const int32_t corner[3] = {a, b, c};
    for (int32_t k = 0; k < 3; ++k) {
        s->origin[3 * triangle + k] = corner[k];
        s->edge[corner[k]] = 3 * triangle + k;
    }
}

static void link_twins(skin *s, int32_t h, int32_t g)
{
    if (h != SKIN_NONE)
        s->twin[h] = g;
    if (g != SKIN_NONE)
        s->twin[g] = h;
}

mrt_result skin_add_point(skin *s, vec3 point, uint8_t hold, error *err)
{
    if (append_vertex(s, point, hold) == SKIN_NONE)
        return error_set(err, MRT_ERR_ARGUMENT, "the skin has room for only %d vertices",
                         s->vertex_capacity);
    return MRT_OK;
}

mrt_result skin_add_triangle(skin *s, int32_t a, int32_t b, int32_t c, error *err)
{
    if (s->triangle_count == s->triangle_capacity)
        return error_set(err, MRT_ERR_ARGUMENT, "the skin has room for only %d triangles",
                         s->triangle_capacity);
    for (int32_t k = 0; k < 3; ++k)
        s->twin[3 * s->triangle_count + k] = SKIN_NONE;
    set_triangle(s, s->triangle_count++, a, b, c);
    s->live_triangle_count++;
    return MRT_OK;
}

typedef struct edge_key {
    int32_t low, high, h;
} edge_key;

static int compare_keys(const void *a, const void *b)
{
    const edge_key *p = a, *q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return (p->h > q->h) - (p->h < q->h);
}

/* Links half-edges between the same two vertices, which are adjacent in `key`. */
static mrt_result join_sorted(skin *s, const edge_key *key, int32_t count, error *err)
{
    for (int32_t i = 0, run; i < count; i += run) {
        for (run = 1;
             i + run < count && key[i + run].low == key[i].low && key[i + run].high == key[i].high;)
            ++run;
        if (run > 2 || (run == 2 && s->origin[key[i].h] == s->origin[key[i + 1].h]))
            return error_set(err, MRT_ERR_FORMAT, "the edge at (%.1f, %.1f, %.1f) is not manifold",
                             s->point[key[i].low].x, s->point[key[i].low].y,
                             s->point[key[i].low].z);
        if (run == 2)
            link_twins(s, key[i].h, key[i + 1].h);
    }
    return MRT_OK;
}

/* Checks that all triangles at a vertex form one fan. */
static mrt_result check_fans(const skin *s, error *err)
{
    int32_t total = 0;
    for (int32_t v = 0; v < s->vertex_count; ++v) {
        int32_t edge[SKIN_RING];
        int32_t count = s->edge[v] == SKIN_NONE ? 0 : skin_leaving(s, v, edge);
        if (count > SKIN_RING)
            return error_set(err, MRT_ERR_FORMAT, "vertex %d has more than %d triangles", v,
                             SKIN_RING);
        total += count;
    }
    if (total != 3 * s->triangle_count)
        return error_set(err, MRT_ERR_FORMAT, "a vertex joins several fans of triangles");
    return MRT_OK;
}

mrt_result skin_join(skin *s, error *err)
{
    int32_t count = 3 * s->triangle_count;
    edge_key *key = malloc(((size_t)count + 1) * sizeof *key);
    if (!key)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %d half-edges", count);
    for (int32_t h = 0; h < count; ++h) {
        int32_t a = s->origin[h], b = skin_target(s, h);
        key[h] = (edge_key){a < b ? a : b, a < b ? b : a, h};
    }
    qsort(key, (size_t)count, sizeof *key, compare_keys);
    mrt_result result = join_sorted(s, key, count, err);
    free(key);
    return result < 0 ? result : check_fans(s, err);
}

int32_t skin_leaving(const skin *s, int32_t vertex, int32_t out_edge[SKIN_RING])
{
    int32_t first = s->edge[vertex];
    for (int32_t h = s->twin[first], turns = 0; h != SKIN_NONE && turns < SKIN_RING; ++turns) {
        int32_t clockwise = skin_next(h);
        if (clockwise == s->edge[vertex])
            break;
        first = clockwise;
        h = s->twin[first];
    }
    int32_t count = 0;
    for (int32_t h = first; h != SKIN_NONE;) {
        if (count == SKIN_RING)
            return SKIN_RING + 1;
        out_edge[count++] = h;
        h = s->twin[skin_previous(h)];
        if (h == first)
            break;
    }
    return count;
}

int32_t skin_neighbours(const skin *s, int32_t vertex, int32_t out_vertex[SKIN_RING])
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    if (count > SKIN_RING)
        return count;
    for (int32_t i = 0; i < count; ++i)
        out_vertex[i] = skin_target(s, edge[i]);
    int32_t last = skin_previous(edge[count - 1]);
    if (s->twin[last] != SKIN_NONE)
        return count;
    if (count == SKIN_RING)
        return SKIN_RING + 1;
    out_vertex[count] = s->origin[last];
    return count + 1;
}

static int is_on_border(const skin *s, int32_t vertex)
{
    int32_t edge[SKIN_RING];
    int32_t count = skin_leaving(s, vertex, edge);
    return count <= SKIN_RING && s->twin[skin_previous(edge[count - 1])] == SKIN_NONE;
}

/* Returns the kind of line that the edge is part of. */
static int line_of(const skin *s, int32_t h)
{
    return skin_common_line(s, s->origin[h], skin_target(s, h));
}

int32_t skin_split(skin *s, int32_t h, vec3 point)
{
    int32_t g = s->twin[h];
    int32_t needed = g == SKIN_NONE ? 1 : 2;
    if (s->triangle_count + needed > s->triangle_capacity)
        return SKIN_NONE;
    int32_t m = append_vertex(s, point, (uint8_t)line_of(s, h));
    if (m == SKIN_NONE)
        return SKIN_NONE;
    /* a-b-c becomes a-m-c and m-b-c; on the other side b-a-d becomes b-m-d and m-a-d. */
    int32_t h1 = skin_next(h), h2 = skin_previous(h);
    int32_t a = s->origin[h], b = s->origin[h1], c = s->origin[h2];
    int32_t n = 3 * s->triangle_count++;
    int32_t beyond_b_c = s->twin[h1];
    set_triangle(s, n / 3, m, b, c);
    s->origin[h1] = m;
    s->edge[m] = n;
    s->edge[b] = n + 1;
    s->edge[a] = h;
    link_twins(s, n + 1, beyond_b_c);
    link_twins(s, n + 2, h1);
    s->twin[h] = s->twin[n] = SKIN_NONE;
    s->live_triangle_count += needed;
    if (g == SKIN_NONE)
        return m;
    int32_t g1 = skin_next(g), d = s->origin[skin_previous(g)];
    int32_t k = 3 * s->triangle_count++;
    int32_t beyond_a_d = s->twin[g1];
    set_triangle(s, k / 3, m, a, d);
    s->origin[g1] = m;
    s->edge[d] = k + 2;
    link_twins(s, k + 1, beyond_a_d);
    link_twins(s, k + 2, g1);
    link_twins(s, h, k);
    link_twins(s, n, g);
    return m;
}

static int contains(const int32_t *vertex, int32_t count, int32_t wanted)
{
    for (int32_t i = 0; i < count; ++i)
        if (vertex[i] == wanted)
            return 1;
    return 0;
}

static int are_joined(const skin *s, int32_t a, int32_t b)
{
    int32_t around[SKIN_RING];
    int32_t count = skin_neighbours(s, a, around);
    return count > SKIN_RING || contains(around, count, b);
}

static int32_t valence(const skin *s, int32_t vertex)
{
    int32_t around[SKIN_RING];
    return skin_neighbours(s, vertex, around);
}

int skin_flip(skin *s, int32_t h)
{
    int32_t g = s->twin[h];
    if (g == SKIN_NONE || line_of(s, h))
        return 0;
    int32_t h1 = skin_next(h), h2 = skin_previous(h), g1 = skin_next(g), g2 = skin_previous(g);
    int32_t a = s->origin[h], b = s->origin[g], c = s->origin[h2], d = s->origin[g2];
    int new_line = skin_common_line(s, c, d);
    if (c == d || new_line || valence(s, a) <= 3 || valence(s, b) <= 3 || are_joined(s, c, d))
        return 0;
    int32_t b_c = s->twin[h1], c_a = s->twin[h2], a_d = s->twin[g1], d_b = s->twin[g2];
    s->origin[h] = d, s->origin[h1] = c, s->origin[h2] = a;
    s->origin[g] = c, s->origin[g1] = d, s->origin[g2] = b;
    link_twins(s, h1, c_a);
    link_twins(s, h2, a_d);
    link_twins(s, g1, d_b);
    link_twins(s, g2, b_c);
    s->edge[a] = h2, s->edge[b] = g2, s->edge[c] = g, s->edge[d] = h;
    return 1;
}

/* Returns 1 if the vertex that dies holds no line and no corner that the remaining vertex does not
 * hold. */
static int keeps_lines(const skin *s, int32_t h)
{
    int32_t a = s->origin[h], b = skin_target(s, h);
    int held = s->hold[a] & (SKIN_LINES | SKIN_CORNER);
    if (held & SKIN_CORNER || held != (skin_common_line(s, a, b) & held))
        return 0;
    int is_border_edge = s->twin[h] == SKIN_NONE;
    return is_border_edge || !(is_on_border(s, a) && is_on_border(s, b));
}

/* Tests the link condition: the ends share the opposite corners and no other neighbour. Also, no
 * new neighbour of b may form a second line with it. */
static int closes_cleanly(const skin *s, int32_t a, int32_t b, int32_t corner_count)
{
    int32_t around_a[SKIN_RING] = {0}, around_b[SKIN_RING] = {0};
    int32_t count_a = skin_neighbours(s, a, around_a), count_b = skin_neighbours(s, b, around_b);
    if (count_a + count_b > SKIN_RING)
        return 0;
    int32_t shared = 0;
    for (int32_t i = 0; i < count_a; ++i) {
        int is_shared = contains(around_b, count_b, around_a[i]);
        shared += is_shared;
        int line = skin_common_line(s, around_a[i], b);
        int follows = s->hold[a] & line; /* the line passes through a, and b takes its place */
        if (line && !follows && !is_shared && around_a[i] != b)
            return 0;
    }
    return shared == corner_count;
}

int skin_may_collapse(const skin *s, int32_t h)
{
    int32_t a = s->origin[h], b = skin_target(s, h), c = s->origin[skin_previous(h)];
    int32_t g = s->twin[h];
    if (!keeps_lines(s, h) || valence(s, c) <= 3)
        return 0;
    if (g != SKIN_NONE && valence(s, s->origin[skin_previous(g)]) <= 3)
        return 0;
    return closes_cleanly(s, a, b, g == SKIN_NONE ? 1 : 2);
}

/* Removes the triangle of h from the surface: its two other edges become one. */
static void close_triangle(skin *s, int32_t h)
{
    int32_t one = s->twin[skin_next(h)], other = s->twin[skin_previous(h)];
    int32_t kept = skin_target(s, h), corner = s->origin[skin_previous(h)];
    link_twins(s, one, other);
    s->edge[corner] = one != SKIN_NONE ? one : skin_next(other);
    s->edge[kept] = one != SKIN_NONE ? skin_next(one) : other;
    for (int32_t k = 0; k < 3; ++k)
        s->origin[h - h % 3 + k] = SKIN_NONE;
    s->live_triangle_count--;
}

void skin_collapse(skin *s, int32_t h)
{
    int32_t leaving[SKIN_RING];
    int32_t a = s->origin[h], b = skin_target(s, h), g = s->twin[h];
    int32_t count = skin_leaving(s, a, leaving);
    for (int32_t i = 0; i < count; ++i)
        s->origin[leaving[i]] = b;
    close_triangle(s, h);
    if (g != SKIN_NONE)
        close_triangle(s, g);
    s->edge[a] = SKIN_NONE;
}

static int32_t compact_vertices(skin *s, int32_t *renumber)
{
    int32_t count = 0;
    for (int32_t v = 0; v < s->vertex_count; ++v) {
        if (s->edge[v] == SKIN_NONE)
            continue;
        renumber[v] = count;
        s->point[count] = s->point[v];
        s->hold[count] = s->hold[v];
        s->edge[count++] = s->edge[v];
    }
    return count;
}

void skin_compact(skin *s)
{
    int32_t *vertex_now = malloc(((size_t)s->vertex_count + 1) * sizeof *vertex_now);
    int32_t *triangle_now = malloc(((size_t)s->triangle_count + 1) * sizeof *triangle_now);
    if (!vertex_now || !triangle_now)
        goto done; /* without compaction the skin is still valid */
    s->vertex_count = compact_vertices(s, vertex_now);
    int32_t count = 0;
    for (int32_t t = 0; t < s->triangle_count; ++t)
        triangle_now[t] = s->origin[3 * t] == SKIN_NONE ? SKIN_NONE : count++;
    for (int32_t t = 0; t < s->triangle_count; ++t) {
        if (triangle_now[t] == SKIN_NONE)
            continue;
        for (int32_t k = 0; k < 3; ++k) {
            int32_t twin = s->twin[3 * t + k];
            int32_t h = 3 * triangle_now[t] + k;
            s->origin[h] = vertex_now[s->origin[3 * t + k]];
            s->twin[h] = twin == SKIN_NONE ? SKIN_NONE : 3 * triangle_now[twin / 3] + twin % 3;
            s->edge[s->origin[h]] = h;
        }
    }
    s->triangle_count = count;
done:
    free(vertex_now);
    free(triangle_now);
}

vec3 skin_triangle_normal(const skin *s, int32_t triangle)
{
    const int32_t *corner = s->origin + 3 * (size_t)triangle;
    vec3 a = s->point[corner[0]];
    return vec3_cross(vec3_sub(s->point[corner[1]], a), vec3_sub(s->point[corner[2]], a));
}
