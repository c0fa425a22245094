#include "relax.h"

#include <stdlib.h>
#include <string.h>

/* Of the way to the mean. EVEN's goes beyond it: that settles sooner. */
static const double EVEN_STEP = 1.9, AREA_STEP = 1.0;

typedef struct fans { /* the quads around each point, one row each */
    int32_t *start;   /* point_count + 1 */
    int32_t *quad;
} fans;

static void fans_finish(fans *f)
{
    free(f->start);
    free(f->quad);
    *f = (fans){0};
}

static mrt_result fans_init(fans *out, const sheet *s, error *err)
{
    size_t points = (size_t)s->point_count, quads = (size_t)s->quad_count;
    *out = (fans){.start = calloc(points + 2, sizeof(int32_t)),
                  .quad = calloc(4 * quads + 1, sizeof(int32_t))};
    if (!out->start || !out->quad) {
        fans_finish(out);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the fans of %d points",
                         s->point_count);
    }
    /* Filled one row late: when all are placed, each start has moved to where it belongs. */
    int32_t *end = out->start + 1;
    for (int32_t q = 0; q < s->quad_count; ++q)
        for (int k = 0; k < 4; ++k)
            end[s->quad[q].corner[k] + 1]++;
    for (int32_t v = 0; v < s->point_count; ++v)
        end[v + 1] += end[v];
    for (int32_t q = 0; q < s->quad_count; ++q)
        for (int k = 0; k < 4; ++k)
            out->quad[end[s->quad[q].corner[k]]++] = q;
    return MRT_OK;
}

static double area_mm2(const sheet *s, const sheet_quad *q)
{
    vec3 across = vec3_sub(s->point[q->corner[2]], s->point[q->corner[0]]);
    vec3 other = vec3_sub(s->point[q->corner[3]], s->point[q->corner[1]]);
    return 0.5 * vec3_length(vec3_cross(across, other));
}

static vec3 centre_of(const sheet *s, const sheet_quad *q)
{
    vec3 sum = {0, 0, 0};
    for (int k = 0; k < 4; ++k)
        sum = vec3_add(sum, s->point[q->corner[k]]);
    return vec3_scale(sum, 0.25);
}

/* A point on the middle has the mirrored quads too: they take its x back to 0. */
static vec3 wanted_point(const sheet *s, const fans *f, int32_t v, relax_pull pull)
{
    vec3 sum = {0, 0, 0};
    double weight = 0.0;
    for (int32_t i = f->start[v]; i < f->start[v + 1]; ++i) {
        const sheet_quad *q = &s->quad[f->quad[i]];
        double share = pull == RELAX_AREA ? area_mm2(s, q) + 1e-6 : 1.0;
        sum = vec3_add(sum, vec3_scale(centre_of(s, q), share));
        weight += share;
    }
    return vec3_scale(sum, 1.0 / weight);
}

static void relax_point(sheet *s, int32_t v, vec3 wanted, double step, relax_projection project)
{
    vec3 old = s->point[v];
    if (s->hold[v] & SHEET_MIDDLE)
        wanted.x = 0.0;
    vec3 moved = vec3_add(old, vec3_scale(vec3_sub(wanted, old), step));
    if (project)
        moved = project(moved);
    if (s->hold[v] & SHEET_MIDDLE)
        moved.x = 0.0;
    s->point[v] = moved;
}

mrt_result relax_points(sheet *s, int32_t first_point, int32_t round_count, relax_pull pull,
                        relax_projection project, error *err)
{
    fans f;
    mrt_result result = fans_init(&f, s, err);
    if (result < 0)
        return result;
    double step = pull == RELAX_AREA ? AREA_STEP : EVEN_STEP;
    for (int32_t round = 0; round < round_count; ++round)
        for (int32_t v = first_point; v < s->point_count; ++v) {
            if (s->hold[v] & SHEET_FIXED || f.start[v] == f.start[v + 1])
                continue;
            relax_point(s, v, wanted_point(s, &f, v, pull), step, project);
        }
    fans_finish(&f);
    return MRT_OK;
}
