#include "mesh/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of the diagonal of the mesh's box. */
static const double reach_part = 1e-6;
/* Triangles that face each other at less than 60 degrees belong to two surfaces that touch. */
static const double facing_cosine = -0.5, flat_sine = 1e-3;
static const float smooth_cosine = 0.94f;

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to join the seams of the mesh");
}

static const float *position_of(const mesh *m, uint32_t vertex)
{
    return m->position + (size_t)vertex * 3;
}

/* ---- coincident vertices ---- */

typedef struct grid { /* cells with sides of four reaches, hashed; each has a chain of vertices */
    const mesh *m;
    double low[3], reach;
    uint32_t *first, *next; /* slot_count; vertex_count: UINT32_MAX ends a chain */
    uint32_t slot_count;    /* a power of two */
} grid;

static uint64_t cell_along(const grid *g, double at, size_t axis)
{
    return (uint64_t)(int64_t)floor((at - g->low[axis]) / (4.0 * g->reach));
}

static uint32_t slot_of(const grid *g, const uint64_t cell[3])
{
    uint64_t hash = cell[0] * 0x9e3779b97f4a7c15u + cell[1] * 0xc2b2ae3d27d4eb4fu +
                    cell[2] * 0x165667b19e3779f9u;
    return (uint32_t)((hash ^ hash >> 29) * 0xbf58476d1ce4e5b9u >> 32) & (g->slot_count - 1);
}

static bool are_near(const grid *g, uint32_t a, uint32_t b)
{
    const float *p = position_of(g->m, a), *q = position_of(g->m, b);
    for (int i = 0; i < 3; ++i)
        if (!(fabs((double)p[i] - (double)q[i]) <= g->reach))
            return false;
    return true;
}

/* Returns the lowest vertex in the grid within reach; UINT32_MAX: none. Searches a neighbouring
 * cell only if its wall is within reach. */
static uint32_t find_near(const grid *g, uint32_t vertex)
{
    uint64_t cell[3][2];
    uint32_t found = UINT32_MAX;
    for (size_t i = 0; i < 3; ++i) {
        double at = (double)position_of(g->m, vertex)[i];
        cell[i][0] = cell_along(g, at - g->reach, i);
        cell[i][1] = cell_along(g, at + g->reach, i);
    }
    for (unsigned corner = 0; corner < 8; ++corner) {
        uint64_t at[3];
        bool is_again = false;
        for (unsigned i = 0; i < 3; ++i) {
            at[i] = cell[i][corner >> i & 1u];
            is_again = is_again || ((corner >> i & 1u) && cell[i][0] == cell[i][1]);
        }
        if (is_again)
            continue;
        for (uint32_t v = g->first[slot_of(g, at)]; v != UINT32_MAX; v = g->next[v])
            if (v < found && are_near(g, v, vertex))
                found = v;
    }
    return found;
}

static void grid_add(grid *g, uint32_t vertex)
{
    uint64_t cell[3];
    for (size_t i = 0; i < 3; ++i)
        cell[i] = cell_along(g, (double)position_of(g->m, vertex)[i], i);
    uint32_t slot = slot_of(g, cell);
    g->next[vertex] = g->first[slot];
    g->first[slot] = vertex;
}

/* coincident: vertex_count: the first vertex at the same position, within reach. out_twice: number
 * of vertices with an earlier one there. */
static mrt_result find_coincident(uint32_t *coincident, uint32_t *out_twice, const mesh *m,
                                  error *err)
{
    float low[3], high[3];
    double square = 0.0;
    grid g = {.m = m, .slot_count = 1};
    mesh_bounds(m, low, high);
    for (size_t i = 0; i < 3; ++i) {
        g.low[i] = (double)low[i];
        square += ((double)high[i] - (double)low[i]) * ((double)high[i] - (double)low[i]);
    }
    g.reach = fmax(reach_part * sqrt(square), 1e-30);
    while (g.slot_count < m->vertex_count && g.slot_count < 1u << 30)
        g.slot_count *= 2;
    g.first = malloc((size_t)g.slot_count * sizeof *g.first);
    g.next = malloc(((size_t)m->vertex_count + 1) * sizeof *g.next);
    bool has_memory = g.first && g.next;
    *out_twice = 0;
    if (has_memory)
        memset(g.first, 0xff, (size_t)g.slot_count * sizeof *g.first);
    for (uint32_t v = 0; has_memory && v < m->vertex_count; ++v) {
        uint32_t near = find_near(&g, v);
        coincident[v] = near == UINT32_MAX ? v : near;
        if (near == UINT32_MAX)
            grid_add(&g, v);
        else
            *out_twice += 1;
    }
    free(g.first);
    free(g.next);
    return has_memory ? MRT_OK : no_memory(err);
}

/* ---- coincident edges ---- */

typedef struct edge {     /* of a triangle, from a to b */
    uint32_t low, high;   /* its ends as coincident vertices */
    uint32_t a, b, other; /* one in the file; other: the third vertex */
    uint32_t looks[2]; /* the triangle's own vertices for a and b, with their texture coordinates */
    bool is_down;      /* from `high` to `low` */
    bool is_paired;
    uint32_t part; /* index of the part */
} edge;

/* Two edges that continue as one surface and have the same attributes: a slit, or vertices that
 * were never shared. */
typedef struct edge_pair {
    uint32_t a[2], b[2]; /* vertices at both ends: of the first triangle, of the second */
} edge_pair;

typedef struct joining {
    const mesh *m;
    uint32_t *point;
    edge_pair *alike;
    size_t alike_count;
} joining;

static int by_ends(const void *left, const void *right)
{
    const edge *p = left, *q = right;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    if (p->a != q->a)
        return p->a < q->a ? -1 : 1;
    if (p->b != q->b)
        return p->b < q->b ? -1 : 1;
    return (p->other > q->other) - (p->other < q->other);
}

static void subtract(double out[3], const float *a, const float *b)
{
    for (int i = 0; i < 3; ++i)
        out[i] = (double)a[i] - (double)b[i];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Computes the unit normal of the triangle at an edge; 0 if it has no area. */
static void normal_of(double out[3], const mesh *m, const edge *e)
{
    double u[3], v[3];
    subtract(u, position_of(m, e->b), position_of(m, e->a));
    subtract(v, position_of(m, e->other), position_of(m, e->a));
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
    double length = sqrt(dot(out, out));
    for (int i = 0; i < 3; ++i)
        out[i] = length > 0.0 ? out[i] / length : 0.0;
}

/* Returns how straight the surface continues from one edge to another, 1 to -1; -2: it does not
 * continue. */
static double goes_on(const mesh *m, const edge *p, const edge *q)
{
    double n[3], k[3], across[3];
    if (p->is_down == q->is_down)
        return -2.0;
    normal_of(n, m, p);
    normal_of(k, m, q);
    double cosine = dot(n, k);
    subtract(across, position_of(m, q->other), position_of(m, q->a));
    double above = dot(n, across), length = sqrt(dot(across, across));
    bool is_facing = cosine < facing_cosine && above > -flat_sine * length;
    return is_facing ? -2.0 : cosine;
}

/* Edges that two triangles share in the file are not open. */
static void pair_shared(edge *e, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count && !e[i].is_paired; ++j)
            if (!e[j].is_paired && e[i].a == e[j].b && e[i].b == e[j].a)
                e[i].is_paired = e[j].is_paired = true;
}

static uint32_t root_of(uint32_t *point, uint32_t v)
{
    while (point[v] != v) {
        point[v] = point[point[v]];
        v = point[v];
    }
    return v;
}

static void join(uint32_t *point, uint32_t a, uint32_t b)
{
    a = root_of(point, a);
    b = root_of(point, b);
    if (a != b)
        point[a > b ? a : b] = a > b ? b : a;
}

static void join_pair(uint32_t *point, const edge_pair *pair)
{
    join(point, pair->a[0], pair->a[1]);
    join(point, pair->b[0], pair->b[1]);
}

static bool are_smooth(const mesh *m, uint32_t a, uint32_t b)
{
    if (!m->normal)
        return true;
    const float *p = m->normal + (size_t)a * 3, *q = m->normal + (size_t)b * 3;
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2] > smooth_cosine;
}

static bool are_alike(const mesh *m, uint32_t a, uint32_t b)
{
    const float near = 1e-5f;
    for (size_t i = 0; m->uv && i < 2; ++i)
        if (!(fabsf(m->uv[2 * (size_t)a + i] - m->uv[2 * (size_t)b + i]) <= near))
            return false;
    return are_smooth(m, a, b);
}

enum { CROWD = 8 }; /* coincident edges; more are not a surface, and are not joined */

/* Joins the straightest of the remaining pairs repeatedly. */
static void join_open(joining *j, edge *e, size_t count)
{
    const mesh *m = j->m;
    pair_shared(e, count);
    for (;;) {
        double best = -2.0;
        size_t first = 0, second = 0;
        for (size_t i = 0; i < count; ++i)
            for (size_t k = i + 1; k < count && !e[i].is_paired; ++k) {
                double cosine = e[k].is_paired ? -2.0 : goes_on(m, &e[i], &e[k]);
                if (cosine > best) {
                    best = cosine;
                    first = i;
                    second = k;
                }
            }
        if (!(best > -2.0))
            return;
        const edge *p = &e[first], *q = &e[second];
        const edge_pair pair = {{p->a, q->b}, {p->b, q->a}};
        e[first].is_paired = e[second].is_paired = true;
        if ((m->uv || m->normal) && p->part == q->part && are_alike(m, p->looks[0], q->looks[1]) &&
            are_alike(m, p->looks[1], q->looks[0]))
            j->alike[j->alike_count++] = pair;
        else
            join_pair(j->point, &pair);
    }
}

/* ---- slits ---- Files with texture coordinates or normals normally do not repeat a vertex with
 * the same values in one part. Two exceptions exist: files that share no vertices at all, and
 * surfaces that are open on purpose, such as a mouth with nothing behind it. Such edges are a
 * slit if they form one chain of at least SLIT_LEAST edges. Both ends of the chain must be
 * vertices that its two sides share. */

enum { SLIT_LEAST = 6 }; /* edges */

static uint32_t coincident_of(const uint32_t *coincident, const edge_pair *pair, int end)
{
    return coincident[end == 0 ? pair->a[0] : pair->b[0]];
}

/* chain: for each place another place of the same chain, or itself at the last one. ends: for the
 * last place of each chain, the number of its ends that both sides share, plus 4 for each place
 * where it branches or is open. */
static void join_alike(joining *j, const uint32_t *coincident, uint32_t *chain, uint32_t *used,
                       uint32_t *ends)
{
    const uint32_t count = j->m->vertex_count;
    for (uint32_t v = 0; v < count; ++v) {
        chain[v] = v;
        used[v] = ends[v] = 0;
    }
    for (size_t i = 0; i < j->alike_count; ++i) {
        join(chain, coincident_of(coincident, &j->alike[i], 0),
             coincident_of(coincident, &j->alike[i], 1));
        used[coincident_of(coincident, &j->alike[i], 0)] += 1;
        used[coincident_of(coincident, &j->alike[i], 1)] += 1;
    }
    for (size_t i = 0; i < j->alike_count; ++i)
        for (int end = 0; end < 2; ++end) {
            const edge_pair *pair = &j->alike[i];
            uint32_t at = coincident_of(coincident, pair, end), last = root_of(chain, at);
            const uint32_t *vertex = end == 0 ? pair->a : pair->b;
            bool is_shared = vertex[0] == vertex[1];
            ends[last] += used[at] == 2 && !is_shared ? 0 : used[at] == 1 && is_shared ? 1 : 4;
        }
    for (uint32_t v = 0; v < count; ++v)
        used[v] = 0; /* now the number of edges of a chain */
    for (size_t i = 0; i < j->alike_count; ++i)
        used[root_of(chain, coincident_of(coincident, &j->alike[i], 0))] += 1;
    for (size_t i = 0; i < j->alike_count; ++i) {
        uint32_t last = root_of(chain, coincident_of(coincident, &j->alike[i], 0));
        if (ends[last] != 2 || used[last] < SLIT_LEAST)
            join_pair(j->point, &j->alike[i]);
    }
}

/* one: for each vertex, its representative in the file. */
static size_t list_edges(edge *out, const mesh *m, const uint32_t *coincident, const uint32_t *one,
                         const uint8_t *is_twice)
{
    size_t count = 0;
    uint32_t part = 0;
    for (size_t t = 0; t < m->triangle_count; ++t) {
        while (part + 1 < m->part_count && t >= m->part[part + 1].first_triangle)
            ++part;
        for (size_t i = 0; i < 3; ++i) {
            const uint32_t *corner = m->triangle + 3 * t;
            uint32_t a = one[corner[i]], b = one[corner[(i + 1) % 3]];
            uint32_t from = coincident[a], to = coincident[b];
            if (from == to || (!is_twice[from] && !is_twice[to]))
                continue;
            if (out)
                out[count] = (edge){.low = from < to ? from : to,
                                    .high = from < to ? to : from,
                                    .a = a,
                                    .b = b,
                                    .other = one[corner[(i + 2) % 3]],
                                    .looks = {corner[i], corner[(i + 1) % 3]},
                                    .is_down = from > to,
                                    .part = part};
            count += 1;
        }
    }
    return count;
}

/* point: initially, vertices that are one in the file. */
static mrt_result join_edges(uint32_t *point, const mesh *m, const uint32_t *coincident, error *err)
{
    uint8_t *is_twice = calloc((size_t)m->vertex_count + 1, 1);
    if (!is_twice)
        return no_memory(err);
    for (uint32_t v = 0; v < m->vertex_count; ++v)
        if (coincident[v] != v)
            is_twice[coincident[v]] = 1;
    size_t count = list_edges(NULL, m, coincident, point, is_twice);
    edge *all = malloc((count + 1) * sizeof *all);
    joining j = {.m = m, .point = point, .alike = malloc((count + 1) * sizeof *j.alike)};
    uint32_t *scratch = malloc(3 * ((size_t)m->vertex_count + 1) * sizeof *scratch);
    bool has_memory = all && j.alike && scratch;
    if (has_memory) {
        (void)list_edges(all, m, coincident, point, is_twice);
        qsort(all, count, sizeof *all, by_ends);
        for (size_t first = 0, end; first < count; first = end) {
            for (end = first + 1;
                 end < count && all[end].low == all[first].low && all[end].high == all[first].high;)
                ++end;
            if (end - first > 1 && end - first <= CROWD)
                join_open(&j, all + first, end - first);
        }
        join_alike(&j, coincident, scratch, scratch + m->vertex_count,
                   scratch + 2 * (size_t)m->vertex_count);
    }
    free(scratch);
    free(j.alike);
    free(all);
    free(is_twice);
    return has_memory ? MRT_OK : no_memory(err);
}

/* ---- one point ---- */

enum { LEADERS_MAX = 32 };

/* Assigns each vertex to the first vertex of its point that faces the same way, among the first few
 * that differ. */
static mrt_result find_smooth(mesh *m, error *err)
{
    uint32_t *next = malloc(((size_t)m->vertex_count + 1) * sizeof *next); /* leaders of a point */
    for (uint32_t v = 0; next && v < m->vertex_count; ++v) {
        uint32_t leader = m->point[v];
        next[v] = UINT32_MAX;
        m->smooth[v] = v;
        for (int i = 0; leader != v && i < LEADERS_MAX; ++i) {
            if (are_smooth(m, v, leader)) {
                m->smooth[v] = leader;
                break;
            }
            if (next[leader] == UINT32_MAX)
                next[leader] = v;
            leader = next[leader];
        }
    }
    bool has_memory = next != NULL;
    free(next);
    return has_memory ? MRT_OK : no_memory(err);
}

static void share_places(mesh *m)
{
    for (uint32_t v = 0; v < m->vertex_count; ++v) {
        size_t to = (size_t)v * 3, from = (size_t)m->point[v] * 3;
        if (to == from)
            continue;
        memcpy(m->position + to, m->position + from, 3 * sizeof *m->position);
        for (uint32_t i = 0; i < m->target_count; ++i)
            memcpy(m->target[i].offset + to, m->target[i].offset + from,
                   3 * sizeof *m->target[i].offset);
    }
}

static void forget(mesh *m)
{
    free(m->point);
    free(m->smooth);
    m->point = m->smooth = NULL;
}

mrt_result mesh_weld(mesh *m, error *err)
{
    size_t count = (size_t)m->vertex_count + 1;
    uint32_t twice = 0, *coincident = malloc(count * sizeof *coincident);
    uint32_t *one = m->smooth ? NULL : m->point;
    m->point = one ? NULL : m->point;
    forget(m);
    mrt_result result = coincident ? find_coincident(coincident, &twice, m, err) : no_memory(err);
    if (result >= 0 && twice > 0) {
        m->point = malloc(count * sizeof *m->point);
        m->smooth = malloc(count * sizeof *m->smooth);
        result = m->point && m->smooth ? MRT_OK : no_memory(err);
        for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v)
            m->point[v] = one ? one[v] : v;
        if (result >= 0)
            result = join_edges(m->point, m, coincident, err);
        for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v)
            m->point[v] = root_of(m->point, v);
        if (result >= 0)
            result = find_smooth(m, err);
        if (result >= 0)
            share_places(m);
    }
    free(one);
    free(coincident);
    if (result < 0)
        forget(m);
    return result;
}
