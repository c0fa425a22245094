#include "mesh/surface_meter.h"

#include "base/arrays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Share of the mean edge. Shorter edges are at pinched places of a mesh, and do not describe the
 * skin. */
static const double shortest = 1e-3;

typedef struct surface_edge {
    uint32_t end[2];      /* vertices */
    uint32_t triangle[2]; /* on both sides; equal at a border */
    float inverse_square; /* of its length at rest; 0: too short to be measured */
    float cosine, sine;   /* of its bend angle at rest */
} surface_edge;

typedef struct surface_normal { /* unit, or 0 for a collapsed triangle */
    float x, y, z;
    float area; /* twice the area of the triangle */
} surface_normal;

typedef struct surface_made { /* of an edge, over all learnt shapes and rest */
    float inverse_square, cosine, sine;
} surface_made;

/* Items in spans of SPAN, and for each span the blocks of vertices that they touch. */
enum { SPAN = 32 };
typedef struct surface_spans {
    uint32_t count;
    uint32_t *first; /* for each span, and the end: its beginning in `block` */
    uint32_t *block;
} surface_spans;

struct surface_meter {
    arrays arrays; /* the arrays below */
    uint32_t vertex_count, triangle_count, edge_count;
    uint32_t *corner; /* triangle_count by 3 */
    surface_edge *edge;
    surface_made *made;     /* edge_count; NULL: no shape was learnt */
    uint32_t *number;       /* for each given triangle: its index; UINT32_MAX: left out */
    uint32_t (*edge_of)[3]; /* triangle_count */
    float *sharpest;        /* triangle_count: the least cosine of its edges at rest */
    float *inverse_area;    /* triangle_count: 1 over twice the area at rest */
    surface_normal *normal; /* scratch: for each triangle */
    uint8_t *against; /* scratch: for each triangle, the number of edges where it points against its
                         neighbour */
    surface_spans triangle_spans, edge_spans; /* an edge has the corners of both its triangles */
};

/* ---- creation ---- */

typedef struct half_edge {
    uint32_t low, high, triangle;
} half_edge;

static int by_ends(const void *a, const void *b)
{
    const half_edge *p = a, *q = b;
    if (p->low != q->low)
        return p->low < q->low ? -1 : 1;
    if (p->high != q->high)
        return p->high < q->high ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

static surface_normal normal_of(const float *const at[3], const uint32_t *corner)
{
    uint32_t a = corner[0], b = corner[1], c = corner[2];
    float ux = at[0][b] - at[0][a], uy = at[1][b] - at[1][a], uz = at[2][b] - at[2][a];
    float vx = at[0][c] - at[0][a], vy = at[1][c] - at[1][a], vz = at[2][c] - at[2][a];
    float x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    float square = x * x + y * y + z * z;
    bool is_good = square > 1e-30f;
    float inverse = is_good ? 1.0f / sqrtf(square) : 0.0f;
    return (surface_normal){x * inverse, y * inverse, z * inverse, square * inverse};
}

static float square_of(const float *const at[3], const uint32_t *end)
{
    float x = at[0][end[1]] - at[0][end[0]], y = at[1][end[1]] - at[1][end[0]],
          z = at[2][end[1]] - at[2][end[0]];
    return x * x + y * y + z * z;
}

static float cosine_of(const surface_meter *self, const surface_edge *e)
{
    const surface_normal *a = &self->normal[e->triangle[0]], *b = &self->normal[e->triangle[1]];
    return a->x * b->x + a->y * b->y + a->z * b->z;
}

static void list_triangles(surface_meter *self, const float *const rest[3],
                           const uint32_t *triangle, uint32_t triangle_count)
{
    for (uint32_t t = 0; t < triangle_count; ++t) {
        const uint32_t *corner = triangle + (size_t)3 * t;
        surface_normal n = normal_of(rest, corner);
        self->number[t] = UINT32_MAX;
        if (n.x == 0.0f && n.y == 0.0f && n.z == 0.0f)
            continue;
        self->number[t] = self->triangle_count;
        memcpy(self->corner + (size_t)3 * self->triangle_count, corner, 3 * sizeof *corner);
        self->inverse_area[self->triangle_count] = 1.0f / n.area;
        self->normal[self->triangle_count++] = n;
    }
}

/* Returns which edge of a triangle has these ends; edge i begins at corner i. */
static size_t side_of(const surface_meter *self, uint32_t triangle, uint32_t a, uint32_t b)
{
    const uint32_t *corner = self->corner + (size_t)3 * triangle;
    for (size_t i = 0; i < 2; ++i) {
        uint32_t from = corner[i], to = corner[i + 1];
        if ((from == a && to == b) || (from == b && to == a))
            return i;
    }
    return 2;
}

/* Lists each edge once, with its two triangles; with one at a border, or where more than two
 * meet. */
static void list_edges(surface_meter *self, half_edge *half)
{
    uint32_t count = 0, total = 3 * self->triangle_count;
    for (uint32_t i = 0; i < total; ++i) {
        uint32_t a = self->corner[i], b = self->corner[i % 3 == 2 ? i - 2 : i + 1];
        half[i] = (half_edge){a < b ? a : b, a < b ? b : a, i / 3};
    }
    qsort(half, total, sizeof *half, by_ends);
    for (uint32_t i = 0; i < total;) {
        uint32_t end = i + 1;
        while (end < total && half[end].low == half[i].low && half[end].high == half[i].high)
            ++end;
        surface_edge *e = &self->edge[count++];
        *e =
            (surface_edge){.end = {half[i].low, half[i].high},
                           .triangle = {half[i].triangle, half[end - i == 2 ? i + 1 : i].triangle}};
        for (uint32_t k = i; k < end; ++k)
            self->edge_of[half[k].triangle]
                         [side_of(self, half[k].triangle, half[k].low, half[k].high)] = count - 1;
        i = end;
    }
    self->edge_count = count;
}

static void measure_rest(surface_meter *self, const float *const rest[3])
{
    double mean = 0.0;
    for (uint32_t t = 0; t < self->triangle_count; ++t)
        self->sharpest[t] = 1.0f;
    for (uint32_t i = 0; i < self->edge_count; ++i)
        mean += sqrt((double)square_of(rest, self->edge[i].end)) / self->edge_count;
    for (uint32_t i = 0; i < self->edge_count; ++i) {
        surface_edge *e = &self->edge[i];
        float square = square_of(rest, e->end);
        bool is_long = sqrt((double)square) > shortest * mean;
        e->inverse_square = is_long ? 1.0f / square : 0.0f;
        e->cosine = fminf(fmaxf(cosine_of(self, e), -1.0f), 1.0f);
        e->sine = sqrtf(1.0f - e->cosine * e->cosine);
        for (int side = 0; side < 2; ++side) {
            float *sharpest = &self->sharpest[e->triangle[side]];
            *sharpest = fminf(*sharpest, e->cosine);
        }
    }
}

/* Adds a block to the span that is being listed, if it is not there yet. */
static void add_block(surface_spans *s, uint32_t vertex)
{
    uint32_t block = vertex / SURFACE_BLOCK, at = s->first[s->count], end = s->first[s->count + 1];
    while (at < end && s->block[at] != block)
        ++at;
    if (at < end)
        return;
    s->block[at] = block;
    s->first[s->count + 1] += 1;
}

static void list_spans(surface_meter *self)
{
    surface_spans *of_triangles = &self->triangle_spans, *of_edges = &self->edge_spans;
    for (uint32_t t = 0; t < self->triangle_count; ++t) {
        of_triangles->first[of_triangles->count + 1] =
            t % SPAN == 0 ? of_triangles->first[of_triangles->count]
                          : of_triangles->first[of_triangles->count + 1];
        for (size_t i = 0; i < 3; ++i)
            add_block(of_triangles, self->corner[(size_t)3 * t + i]);
        of_triangles->count += t % SPAN == SPAN - 1 || t + 1 == self->triangle_count;
    }
    for (uint32_t i = 0; i < self->edge_count; ++i) {
        of_edges->first[of_edges->count + 1] =
            i % SPAN == 0 ? of_edges->first[of_edges->count] : of_edges->first[of_edges->count + 1];
        for (size_t k = 0; k < 6; ++k)
            add_block(of_edges, self->corner[(size_t)3 * self->edge[i].triangle[k / 3] + k % 3]);
        of_edges->count += i % SPAN == SPAN - 1 || i + 1 == self->edge_count;
    }
}

static void make_spans(surface_spans *out, arrays *a, size_t count, size_t touched)
{
    out->first = arrays_add(a, count / SPAN + 2, sizeof *out->first);
    out->block = arrays_add(a, touched * count, sizeof *out->block);
}

/* Returns whether the span touches one of these blocks. */
static bool span_has(const surface_spans *s, uint32_t span, const uint8_t *is_of)
{
    uint32_t any = 0;
    for (uint32_t i = s->first[span]; i < s->first[span + 1]; ++i)
        any |= is_of[s->block[i]];
    return any != 0;
}

double surface_meter_bent_at_rest(const surface_meter *self, uint32_t triangle)
{
    uint32_t t = self->number[triangle];
    return t == UINT32_MAX ? 0.0 : acos((double)self->sharpest[t]) * 180.0 / 3.14159265358979323846;
}

mrt_result surface_meter_create(surface_meter **out, const float *const rest[3],
                                uint32_t vertex_count, const uint32_t *triangle,
                                uint32_t triangle_count, error *err)
{
    size_t count = triangle_count;
    surface_meter *self = *out = calloc(1, sizeof *self);
    half_edge *half = malloc((3 * count + 1) * sizeof *half);
    arrays *a = self ? &self->arrays : NULL;
    if (self) {
        self->corner = arrays_add(a, 3 * count, sizeof *self->corner);
        self->edge = arrays_add(a, 3 * count, sizeof *self->edge);
        self->normal = arrays_add(a, count, sizeof *self->normal);
        self->number = arrays_add(a, count, sizeof *self->number);
        self->sharpest = arrays_add(a, count, sizeof *self->sharpest);
        self->edge_of = arrays_add(a, count, sizeof *self->edge_of);
        self->inverse_area = arrays_add(a, count, sizeof *self->inverse_area);
        self->against = arrays_add(a, count, 1);
        make_spans(&self->triangle_spans, a, count, 3);
        make_spans(&self->edge_spans, a, 3 * count, 6);
    }
    if (!self || !half || a->failed) {
        free(half);
        surface_meter_destroy(self);
        *out = NULL;
        return error_set(err, MRT_ERR_MEMORY, "no memory for a surface of %u vertices",
                         vertex_count);
    }
    self->vertex_count = vertex_count;
    list_triangles(self, rest, triangle, triangle_count);
    list_edges(self, half);
    measure_rest(self, rest);
    list_spans(self);
    free(half);
    return MRT_OK;
}

mrt_result surface_meter_learn(surface_meter *self, const float *const at[3], error *err)
{
    if (!self->made) {
        self->made = arrays_add(&self->arrays, self->edge_count, sizeof *self->made);
        if (!self->made)
            return error_set(err, MRT_ERR_MEMORY, "no memory for %u edges", self->edge_count);
        for (uint32_t i = 0; i < self->edge_count; ++i) {
            const surface_edge *e = &self->edge[i];
            self->made[i] = (surface_made){e->inverse_square, e->cosine, e->sine};
        }
    }
    for (uint32_t t = 0; t < self->triangle_count; ++t)
        self->normal[t] = normal_of(at, self->corner + (size_t)3 * t);
    for (uint32_t i = 0; i < self->edge_count; ++i) {
        surface_made *made = &self->made[i];
        float square = square_of(at, self->edge[i].end);
        float cosine = fmaxf(cosine_of(self, &self->edge[i]), -1.0f);
        if (square * made->inverse_square > 1.0f)
            made->inverse_square = 1.0f / square;
        if (cosine < made->cosine) {
            made->cosine = cosine;
            made->sine = sqrtf(1.0f - cosine * cosine);
        }
    }
    return MRT_OK;
}

void surface_meter_destroy(surface_meter *self)
{
    if (!self)
        return;
    arrays_free(&self->arrays);
    free(self);
}

/* ---- measurement ---- */

/* Returns the cosine of the bend of an edge beyond an angle; 1 if it is not bent further. */
static float cosine_beyond(float angle_cosine, float angle_sine, float cosine)
{
    float c = cosine > 1.0f ? 1.0f : cosine < -1.0f ? -1.0f : cosine;
    float beyond = c * angle_cosine + sqrtf(1.0f - c * c) * angle_sine;
    return c < angle_cosine ? beyond : 1.0f;
}

void surface_meter_measure(surface_meter *self, surface_state *out, const float *const at[3])
{
    const double pi = 3.14159265358979323846;
    const float bent = (float)cos(SURFACE_BENT_DEG * pi / 180.0);
    const float crease = (float)cos(SURFACE_CREASE_DEG * pi / 180.0);
    float longest = 1.0f, sharpest = 1.0f;
    *out = (surface_state){0};
    for (uint32_t t = 0; t < self->triangle_count; ++t)
        self->normal[t] = normal_of(at, self->corner + (size_t)3 * t);
    memset(self->against, 0, self->triangle_count);
    for (uint32_t i = 0; i < self->edge_count; ++i) {
        const surface_edge *e = &self->edge[i];
        const surface_made rest = {e->inverse_square, e->cosine, e->sine};
        const surface_made *made = self->made ? &self->made[i] : &rest;
        float stretched = square_of(at, e->end) * made->inverse_square;
        float cosine = cosine_of(self, e);
        float beyond = cosine_beyond(made->cosine, made->sine, cosine);
        bool is_against = (cosine < 0.0f) & (made->cosine >= 0.0f);
        longest = stretched > longest ? stretched : longest;
        sharpest = beyond < sharpest ? beyond : sharpest;
        out->bent_count += (cosine < bent) & (made->cosine >= bent) & (beyond < crease);
        self->against[e->triangle[0]] += is_against;
        self->against[e->triangle[1]] += is_against;
    }
    for (uint32_t t = 0; t < self->triangle_count; ++t)
        out->inside_out_count += self->against[t] >= 2;
    out->stretch = sqrt((double)longest);
    out->bend_deg = acos(fmax((double)sharpest, -1.0)) * 180.0 / pi;
}

/* ---- limiting a step ---- */

/* Share of the remaining distance to a limit that one step may use. */
static const float room_taken = 0.5f;

/* Returns the allowed share of a step that brings a value from `before` to `after`; the limit is
 * 1. */
static float share_of(float before, float after)
{
    float room = before < 1.0f ? room_taken * (1.0f - before) : 0.0f;
    float gain = after - before;
    return gain > room ? room / gain : 1.0f;
}

static void lower(float *share, const uint32_t *vertex, uint32_t count, float to)
{
    for (uint32_t i = 0; i < count; ++i)
        share[vertex[i]] = to < share[vertex[i]] ? to : share[vertex[i]];
}

typedef struct yield_limits {
    float stretch, area, bend, crease; /* 1 / allowed increase */
    float near_square;   /* squared length, relative to rest, below which an edge is far from its
                            limit */
    float crease_cosine; /* edges that are bent further at rest are creases: their bend is measured
                            relative to rest */
} yield_limits;

static yield_limits yield_of(const surface_limits *l)
{
    const double pi = 3.14159265358979323846;
    double bend = l->bend_deg * pi / 180.0, crease = SURFACE_CREASE_DEG * pi / 180.0;
    double near = 1.0 + (double)room_taken * (l->stretch - 1.0);
    return (yield_limits){.near_square = (float)(0.9999 * near * near),
                          .stretch = (float)(1.0 / (l->stretch - 1.0)),
                          .area = (float)(1.0 / (1.0 - l->area)),
                          .bend = (float)(1.0 / (1.0 - cos(bend))),
                          .crease = (float)(1.0 / (1.0 - cos(crease))),
                          .crease_cosine = (float)cos(bend - crease)};
}

/* Values up to room_taken cannot be limited, see share_of. */
static bool may_count(float after)
{
    return after > room_taken;
}

static float yield_triangle(const surface_meter *self, const yield_limits *l, uint32_t t,
                            const float *const before[3])
{
    float after = (1.0f - self->normal[t].area * self->inverse_area[t]) * l->area;
    if (!may_count(after))
        return 1.0f;
    float area = normal_of(before, self->corner + (size_t)3 * t).area;
    return share_of((1.0f - area * self->inverse_area[t]) * l->area, after);
}

static float yield_stretch(const surface_edge *e, const yield_limits *l,
                           const float *const before[3], const float *const after[3])
{
    float now = square_of(after, e->end) * e->inverse_square;
    if (!(now > l->near_square))
        return 1.0f;
    now = (sqrtf(now) - 1.0f) * l->stretch;
    if (!may_count(now))
        return 1.0f;
    float was = sqrtf(square_of(before, e->end) * e->inverse_square);
    return share_of((was - 1.0f) * l->stretch, now);
}

/* Returns the bend of an edge, relative to its limit: 1 at the limit. */
static float bend_of(const surface_edge *e, const yield_limits *l, float cosine)
{
    return e->cosine < l->crease_cosine
               ? (1.0f - cosine_beyond(e->cosine, e->sine, cosine)) * l->crease
               : (1.0f - cosine) * l->bend;
}

static float yield_bend(const surface_meter *self, const surface_edge *e, const yield_limits *l,
                        const float *const before[3])
{
    float now = bend_of(e, l, cosine_of(self, e));
    if (!may_count(now))
        return 1.0f;
    surface_normal a = normal_of(before, self->corner + (size_t)3 * e->triangle[0]);
    surface_normal b = normal_of(before, self->corner + (size_t)3 * e->triangle[1]);
    return share_of(bend_of(e, l, a.x * b.x + a.y * b.y + a.z * b.z), now);
}

/* Judges triangle t, if one of its corners may have moved. */
static float yield_moved(surface_meter *self, const yield_limits *l, uint32_t t,
                         const float *const before[3], const float *const after[3],
                         const uint8_t *is_changed, float *share)
{
    const uint32_t *corner = self->corner + (size_t)3 * t;
    self->against[t] = is_changed[corner[0] / SURFACE_BLOCK] |
                       is_changed[corner[1] / SURFACE_BLOCK] |
                       is_changed[corner[2] / SURFACE_BLOCK];
    if (!self->against[t])
        return 1.0f;
    self->normal[t] = normal_of(after, corner);
    float to = yield_triangle(self, l, t, before);
    lower(share, corner, to < 1.0f ? 3 : 0, to);
    return to;
}

static float yield_edge(surface_meter *self, const yield_limits *l, const surface_edge *e,
                        const float *const before[3], const float *const after[3], float *share)
{
    uint32_t p = e->triangle[0], q = e->triangle[1];
    if (!self->against[p] && !self->against[q])
        return 1.0f;
    if (!self->against[p])
        self->normal[p] = normal_of(after, self->corner + (size_t)3 * p);
    if (!self->against[q])
        self->normal[q] = normal_of(after, self->corner + (size_t)3 * q);
    float stretch = yield_stretch(e, l, before, after);
    float bend = yield_bend(self, e, l, before);
    float to = bend < stretch ? bend : stretch;
    lower(share, e->end, to < 1.0f ? 2 : 0, to);
    return to;
}

static uint32_t end_of(uint32_t span, uint32_t count)
{
    return (span + 1) * SPAN < count ? (span + 1) * SPAN : count;
}

float surface_meter_yield(surface_meter *self, const surface_limits *limits,
                          const float *const before[3], const float *const after[3],
                          const uint8_t *is_changed, float *share)
{
    const yield_limits l = yield_of(limits);
    float least = 1.0f;
    for (uint32_t v = 0; v < self->vertex_count; ++v)
        share[v] = 1.0f;
    memset(self->against, 0, self->triangle_count);
    for (uint32_t span = 0; span < self->triangle_spans.count; ++span) {
        if (!span_has(&self->triangle_spans, span, is_changed))
            continue;
        for (uint32_t t = span * SPAN; t < end_of(span, self->triangle_count); ++t) {
            float to = yield_moved(self, &l, t, before, after, is_changed, share);
            least = to < least ? to : least;
        }
    }
    for (uint32_t span = 0; span < self->edge_spans.count; ++span) {
        if (!span_has(&self->edge_spans, span, is_changed))
            continue;
        for (uint32_t i = span * SPAN; i < end_of(span, self->edge_count); ++i) {
            float to = yield_edge(self, &l, &self->edge[i], before, after, share);
            least = to < least ? to : least;
        }
    }
    return least;
}

void surface_meter_reads(const surface_meter *self, const uint8_t *is_changed, uint8_t *out)
{
    const surface_spans *const all[2] = {&self->triangle_spans, &self->edge_spans};
    for (int k = 0; k < 2; ++k)
        for (uint32_t span = 0; span < all[k]->count; ++span)
            if (span_has(all[k], span, is_changed))
                for (uint32_t i = all[k]->first[span]; i < all[k]->first[span + 1]; ++i)
                    out[all[k]->block[i]] = 1;
}

bool surface_meter_around(const surface_meter *self, uint32_t triangle, uint32_t out[6])
{
    uint32_t t = self->number[triangle];
    if (t == UINT32_MAX)
        return false;
    memcpy(out, self->corner + (size_t)3 * t, 3 * sizeof *out);
    for (size_t i = 0; i < 3; ++i) {
        const surface_edge *e = &self->edge[self->edge_of[t][i]];
        const uint32_t *c = self->corner + (size_t)3 * e->triangle[e->triangle[0] == t ? 1 : 0];
        for (size_t k = 0; k < 3; ++k)
            if (c[k] != e->end[0] && c[k] != e->end[1])
                out[3 + i] = c[k];
    }
    return true;
}

static float bend_at(const surface_meter *self, const surface_edge *e, const yield_limits *l,
                     const float *const at[3])
{
    surface_normal a = normal_of(at, self->corner + (size_t)3 * e->triangle[0]);
    surface_normal b = normal_of(at, self->corner + (size_t)3 * e->triangle[1]);
    return bend_of(e, l, a.x * b.x + a.y * b.y + a.z * b.z);
}

double surface_meter_bend(const surface_meter *self, const surface_limits *limits,
                          const uint32_t *triangle, uint32_t count, const float *const before[3],
                          const float *const after[3])
{
    const yield_limits l = yield_of(limits);
    float most = 0.0f;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t t = self->number[triangle[i]];
        for (size_t k = 0; k < 3 && t != UINT32_MAX; ++k) {
            const surface_edge *e = &self->edge[self->edge_of[t][k]];
            float bend = bend_at(self, e, &l, after);
            if (!(bend > 1.0f && bend > most))
                continue;
            float was = bend_at(self, e, &l, before);
            bend /= was > 1.0f ? was : 1.0f;
            most = bend > most ? bend : most;
        }
    }
    return (double)most;
}
