#include "window/brush.h"

#include "face/rig/rig_head.h"
#include "face/rig/rig_mirror.h"
#include "face/rig/rig_within.h"
#include "mesh/normals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How much longer than the straight way the way along edges may be on a plain piece of surface. */
static const double detour = 1.3;
enum { STEPS_MAX = 64, NONE = -1 };

struct brush {
    const mesh *m;
    const topology *t;
    brush_shape shape;
    float *normal;     /* vertex_count by 3 */
    uint32_t *twin;    /* vertex_count, see rig_within_starts */
    double *distance;  /* vertex_count, scratch */
    rig_start *start;  /* scratch: a vertex and its neighbours */
    float *touch[2];   /* vertex_count */
    uint32_t *touched; /* vertex_count */
    uint32_t touched_count;
    int64_t last_vertex; /* of the stroke; NONE: it has none yet */
    float last_place[3];
    double middle_mm, near_mm; /* near: how far an image may be from its vertex */
};

/* ---- what is known of the mesh ---- */

static const float *position_of(const brush *self, uint32_t vertex)
{
    return self->m->position + (size_t)vertex * 3;
}

static double distance_between(const float *a, const float *b)
{
    double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1];
    double z = (double)a[2] - (double)b[2];
    return sqrt(x * x + y * y + z * z);
}

static double dot(const float *a, const float *b)
{
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

static bool find_normals(brush *self)
{
    const mesh *m = self->m;
    size_t count = m->vertex_count;
    if (m->normal) {
        memcpy(self->normal, m->normal, count * 3 * sizeof *self->normal);
        return true;
    }
    float *soa = malloc((count * 6 + 1) * sizeof *soa);
    if (!soa)
        return false;
    for (size_t v = 0; v < count; ++v)
        for (size_t i = 0; i < 3; ++i)
            soa[(3 + i) * count + v] = m->position[v * 3 + i];
    normals_smooth(soa, soa + count, soa + 2 * count, soa + 3 * count, soa + 4 * count,
                   soa + 5 * count, m->vertex_count, m->triangle, m->triangle_count);
    for (size_t v = 0; v < count; ++v)
        for (size_t i = 0; i < 3; ++i)
            self->normal[v * 3 + i] = soa[i * count + v];
    free(soa);
    return true;
}

typedef struct placed {
    float at[3];
    uint32_t vertex;
} placed;

static int compare_placed(const void *left, const void *right)
{
    const placed *a = left, *b = right;
    for (int i = 0; i < 3; ++i)
        if (a->at[i] < b->at[i] || a->at[i] > b->at[i])
            return a->at[i] < b->at[i] ? -1 : 1;
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

/* Vertices at one place that face alike are one place of the surface (a seam of a texture); lips
 * that touch face otherwise. Only a file's own normals tell: those of a seam computed from either
 * side differ. */
static bool are_twins(const brush *self, const placed *a, const placed *b)
{
    return distance_between(a->at, b->at) <= 0.0 &&
           dot(self->m->normal + (size_t)a->vertex * 3, self->m->normal + (size_t)b->vertex * 3) >
               0.999;
}

static bool find_twins(brush *self)
{
    uint32_t count = self->m->vertex_count;
    for (uint32_t v = 0; v < count; ++v)
        self->twin[v] = v;
    if (!self->m->normal)
        return true;
    placed *sorted = malloc(((size_t)count + 1) * sizeof *sorted);
    if (!sorted)
        return false;
    for (uint32_t v = 0; v < count; ++v) {
        memcpy(sorted[v].at, position_of(self, v), sizeof sorted[v].at);
        sorted[v].vertex = v;
    }
    qsort(sorted, count, sizeof *sorted, compare_placed);
    for (uint32_t i = 1; i < count; ++i) { /* rings: each new twin is put in behind the last */
        uint32_t before = sorted[i - 1].vertex, vertex = sorted[i].vertex;
        if (!are_twins(self, &sorted[i - 1], &sorted[i]))
            continue;
        self->twin[vertex] = self->twin[before];
        self->twin[before] = vertex;
    }
    free(sorted);
    return true;
}

/* The middle of the head; of all that there is where that fits better or no head is found. */
static bool find_middle(brush *self)
{
    const double reach_mm = 0.5;
    float low[3], high[3];
    mesh_bounds(self->m, low, high);
    self->near_mm = 0.03 * distance_between(low, high);
    self->middle_mm = 0.5 * ((double)low[0] + (double)high[0]);
    rig_head head;
    uint32_t alone, alone_in_head, example;
    if (!rig_mirror_count_alone(&alone, &example, self->m, self->middle_mm, reach_mm))
        return false;
    if (alone == 0 || rig_head_measure(&head, self->m, NULL) < 0)
        return true;
    if (!rig_mirror_count_alone(&alone_in_head, &example, self->m, head.middle_x, reach_mm))
        return false;
    if (alone_in_head < alone)
        self->middle_mm = head.middle_x;
    return true;
}

static uint32_t most_neighbours(const topology *t)
{
    uint32_t most = 0;
    for (uint32_t v = 0; v < t->vertex_count; ++v) {
        uint32_t count = t->neighbour_start[v + 1] - t->neighbour_start[v];
        most = count > most ? count : most;
    }
    return most;
}

static bool allocate(brush *self)
{
    size_t count = (size_t)self->m->vertex_count + 1;
    self->normal = calloc(count * 3, sizeof *self->normal);
    self->twin = calloc(count, sizeof *self->twin);
    self->distance = calloc(count, sizeof *self->distance);
    self->start = calloc(most_neighbours(self->t) + 1u, sizeof *self->start);
    self->touch[BRUSH_HERE] = calloc(count, sizeof(float));
    self->touch[BRUSH_THERE] = calloc(count, sizeof(float));
    self->touched = calloc(count, sizeof *self->touched);
    return self->normal && self->twin && self->distance && self->start && self->touch[BRUSH_HERE] &&
           self->touch[BRUSH_THERE] && self->touched;
}

mrt_result brush_create(brush **out, const mesh *m, const topology *t, error *err)
{
    brush *self = calloc(1, sizeof *self);
    *out = self;
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a brush");
    self->m = m;
    self->t = t;
    self->last_vertex = NONE;
    if (allocate(self) && find_middle(self) && find_normals(self) && find_twins(self))
        return MRT_OK;
    brush_destroy(self);
    *out = NULL;
    return error_set(err, MRT_ERR_MEMORY, "no memory for a brush");
}

void brush_destroy(brush *self)
{
    if (!self)
        return;
    free(self->normal);
    free(self->twin);
    free(self->distance);
    free(self->start);
    free(self->touch[BRUSH_HERE]);
    free(self->touch[BRUSH_THERE]);
    free(self->touched);
    free(self);
}

/* ---- symmetry ---- */

uint32_t brush_mirror_of(const brush *self, uint32_t vertex)
{
    const float *p = position_of(self, vertex), *n = self->normal + (size_t)vertex * 3;
    const float image[3] = {(float)(2.0 * self->middle_mm - (double)p[0]), p[1], p[2]};
    const float facing[3] = {-n[0], n[1], n[2]};
    uint32_t best = UINT32_MAX;
    double best_mm = self->near_mm, best_facing = -2.0;
    for (uint32_t v = 0; v < self->m->vertex_count; ++v) {
        double away_mm = distance_between(position_of(self, v), image);
        if (away_mm > best_mm)
            continue;
        double alike = dot(self->normal + (size_t)v * 3, facing);
        if (!(away_mm < best_mm) && alike <= best_facing)
            continue;
        best = v;
        best_mm = away_mm;
        best_facing = alike;
    }
    return best;
}

double brush_middle_mm(const brush *self)
{
    return self->middle_mm;
}

const float *brush_normals(const brush *self)
{
    return self->normal;
}

/* ---- a stroke ---- */

void brush_begin(brush *self, const brush_shape *shape)
{
    self->shape = *shape;
    for (uint32_t i = 0; i < self->touched_count; ++i) {
        self->touch[BRUSH_HERE][self->touched[i]] = 0.0f;
        self->touch[BRUSH_THERE][self->touched[i]] = 0.0f;
    }
    self->touched_count = 0;
    self->last_vertex = NONE;
}

/* Distances along the surface from a place beside `vertex`. */
static mrt_result spread(brush *self, uint32_t vertex, const float place[3], double reach_mm,
                         error *err)
{
    const topology *t = self->t;
    uint32_t count = 0;
    self->start[count++] = (rig_start){vertex, distance_between(position_of(self, vertex), place)};
    for (uint32_t i = t->neighbour_start[vertex]; i < t->neighbour_start[vertex + 1]; ++i) {
        uint32_t next = t->neighbour[i];
        self->start[count++] = (rig_start){next, distance_between(position_of(self, next), place)};
    }
    return rig_within_starts(self->distance, self->start, count, reach_mm, self->m, t, self->twin)
               ? MRT_OK
               : error_set(err, MRT_ERR_MEMORY, "no memory to paint");
}

static float strength_at(const brush_shape *shape, double away_mm)
{
    double near = 1.0 - away_mm / shape->radius_mm;
    if (!(near > 0.0))
        return 0.0f;
    return shape->falloff == BRUSH_HARD ? 1.0f : (float)(near * near * (3.0 - 2.0 * near));
}

static void touch(brush *self, uint32_t side, uint32_t vertex, float strength)
{
    float *there = &self->touch[side][vertex];
    if (!(strength > *there))
        return;
    if (!(self->touch[BRUSH_HERE][vertex] > 0.0f) && !(self->touch[BRUSH_THERE][vertex] > 0.0f))
        self->touched[self->touched_count++] = vertex;
    *there = strength;
}

/* The straight distance, as long as the way along the edges is not much longer: so a brush is
 * round, whatever the edges, and still does not cross a slit. */
static mrt_result dab(brush *self, uint32_t side, uint32_t vertex, const float place[3], error *err)
{
    mrt_result result = spread(self, vertex, place, detour * self->shape.radius_mm, err);
    for (uint32_t v = 0; result >= 0 && v < self->m->vertex_count; ++v) {
        if (!isfinite(self->distance[v]))
            continue;
        double straight_mm = distance_between(position_of(self, v), place);
        double away_mm = fmax(straight_mm, self->distance[v] / detour);
        touch(self, side, v, strength_at(&self->shape, away_mm));
    }
    return result;
}

static mrt_result dab_sides(brush *self, uint32_t vertex, const float place[3], error *err)
{
    mrt_result result = dab(self, BRUSH_HERE, vertex, place, err);
    if (result < 0 || self->shape.sides == BRUSH_ONE_SIDE)
        return result;
    uint32_t image = brush_mirror_of(self, vertex);
    if (image == UINT32_MAX)
        return result;
    const float image_place[3] = {(float)(2.0 * self->middle_mm - (double)place[0]), place[1],
                                  place[2]};
    return dab(self, BRUSH_THERE, image, image_place, err);
}

/* ---- between two places ---- */

/* Of the vertices that the last spread has reached. */
static uint32_t nearest_reached(const brush *self, const float place[3])
{
    uint32_t best = (uint32_t)self->last_vertex;
    double best_mm = (double)INFINITY;
    for (uint32_t v = 0; v < self->m->vertex_count; ++v) {
        if (!isfinite(self->distance[v]))
            continue;
        double away_mm = distance_between(position_of(self, v), place);
        if (away_mm < best_mm) {
            best = v;
            best_mm = away_mm;
        }
    }
    return best;
}

typedef struct brush_way {
    uint32_t vertex[STEPS_MAX];
    float place[STEPS_MAX][3];
    uint32_t count;
} brush_way;

/* Places on the way, less than half a radius apart; none where the surface does not lead there. */
static mrt_result find_way(brush *self, brush_way *out, uint32_t vertex, const float place[3],
                           error *err)
{
    out->count = 0;
    double length_mm = distance_between(self->last_place, place);
    double steps = ceil(length_mm / (0.5 * self->shape.radius_mm));
    if (self->last_vertex == NONE || !(steps > 1.0))
        return MRT_OK;
    mrt_result result = spread(self, (uint32_t)self->last_vertex, self->last_place,
                               1.5 * length_mm + 0.5 * self->shape.radius_mm, err);
    if (result < 0 || !isfinite(self->distance[vertex]))
        return result;
    out->count = (uint32_t)fmin(steps, STEPS_MAX) - 1;
    for (uint32_t k = 0; k < out->count; ++k) {
        float share = (float)(k + 1) / (float)(out->count + 1);
        for (int i = 0; i < 3; ++i)
            out->place[k][i] = self->last_place[i] + share * (place[i] - self->last_place[i]);
        out->vertex[k] = nearest_reached(self, out->place[k]);
        memcpy(out->place[k], position_of(self, out->vertex[k]), sizeof out->place[k]);
    }
    return result;
}

mrt_result brush_move(brush *self, uint32_t vertex, const float place[3], error *err)
{
    brush_way way;
    if (vertex >= self->m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT, "there is no vertex %u", vertex);
    mrt_result result = find_way(self, &way, vertex, place, err);
    for (uint32_t k = 0; result >= 0 && k < way.count; ++k)
        result = dab_sides(self, way.vertex[k], way.place[k], err);
    if (result >= 0)
        result = dab_sides(self, vertex, place, err);
    self->last_vertex = vertex;
    memcpy(self->last_place, place, sizeof self->last_place);
    return result;
}

const float *brush_touch(const brush *self, uint32_t side)
{
    return self->touch[side];
}

const uint32_t *brush_touched(const brush *self, uint32_t *out_count)
{
    *out_count = self->touched_count;
    return self->touched;
}
