#include "relax.h"

#include <stdlib.h>
#include <string.h>

typedef struct links { /* neighbours of each point, one row each */
    int32_t *start;    /* point_count + 1 */
    int32_t *to;
} links;

static void links_finish(links *l)
{
    free(l->start);
    free(l->to);
    *l = (links){0};
}

static int is_linked(const links *l, int32_t row, int32_t end, int32_t to)
{
    for (int32_t i = l->start[row]; i < end; ++i)
        if (l->to[i] == to)
            return 1;
    return 0;
}

static void add_link(const links *l, int32_t *end, int32_t from, int32_t to)
{
    if (!is_linked(l, from, end[from], to))
        l->to[end[from]++] = to;
}

/* Rows have room for two links per quad; out_end says where each really ends. */
static mrt_result links_init(links *out, const sheet *s, int32_t **out_end, error *err)
{
    size_t points = (size_t)s->point_count, quads = (size_t)s->quad_count;
    *out = (links){.start = calloc(points + 1, sizeof(int32_t)),
                   .to = calloc(8 * quads + 1, sizeof(int32_t))};
    *out_end = calloc(points + 1, sizeof(int32_t));
    if (!out->start || !out->to || !*out_end) {
        links_finish(out);
        free(*out_end);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the links of %d points",
                         s->point_count);
    }
    for (int32_t q = 0; q < s->quad_count; ++q)
        for (int k = 0; k < 4; ++k)
            out->start[s->quad[q].corner[k] + 1] += 2;
    for (int32_t v = 0; v < s->point_count; ++v)
        out->start[v + 1] += out->start[v];
    memcpy(*out_end, out->start, points * sizeof(int32_t));
    for (int32_t q = 0; q < s->quad_count; ++q)
        for (int k = 0; k < 4; ++k) {
            int32_t a = s->quad[q].corner[k], b = s->quad[q].corner[(k + 1) % 4];
            add_link(out, *out_end, a, b);
            add_link(out, *out_end, b, a);
        }
    return MRT_OK;
}

static vec3 mean_of_neighbours(const sheet *s, const int32_t *first, const int32_t *end,
                               int is_middle)
{
    vec3 sum = {0, 0, 0};
    double weight = 0.0;
    for (const int32_t *to = first; to < end; ++to) {
        /* A neighbour off the middle of a point on it has an image on the other side. */
        double share = is_middle && !(s->hold[*to] & SHEET_MIDDLE) ? 2.0 : 1.0;
        sum = vec3_add(sum, vec3_scale(s->point[*to], share));
        weight += share;
    }
    sum = vec3_scale(sum, 1.0 / weight);
    if (is_middle)
        sum.x = 0.0;
    return sum;
}

static void relax_point(sheet *s, int32_t v, vec3 wanted, double boldness, relax_projection project)
{
    vec3 old = s->point[v], step = vec3_sub(wanted, old);
    vec3 moved = vec3_add(old, vec3_scale(step, boldness));
    if (project)
        moved = project(moved);
    if (s->hold[v] & SHEET_MIDDLE)
        moved.x = 0.0;
    if (s->hold[v] & SHEET_LEVEL)
        moved.y = old.y;
    s->point[v] = moved;
}

mrt_result relax_points(sheet *s, int32_t first_point, int32_t round_count, double boldness,
                        relax_projection project, error *err)
{
    links l;
    int32_t *end;
    mrt_result result = links_init(&l, s, &end, err);
    if (result < 0)
        return result;
    for (int32_t round = 0; round < round_count; ++round)
        for (int32_t v = first_point; v < s->point_count; ++v) {
            if (s->hold[v] & SHEET_FIXED || end[v] == l.start[v])
                continue;
            vec3 wanted =
                mean_of_neighbours(s, l.to + l.start[v], l.to + end[v], s->hold[v] & SHEET_MIDDLE);
            relax_point(s, v, wanted, boldness, project);
        }
    links_finish(&l);
    free(end);
    return MRT_OK;
}
