#include "window/rig/brush.h"

#include "face/rig/rig_head.h"
#include "face/bind.h"
#include "face/rig_edit.h"
#include "mesh/normals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Maximum ratio of the distance along edges to the straight distance on a plane surface. */
static const double detour = 1.3;
enum { STEPS_MAX = 64, NONE = -1 };

struct brush {
    const mesh *m;
    const topology *t;
    brush_shape shape;
    float *normal;     /* vertex_count by 3 */
    double *distance;  /* vertex_count, scratch */
    bind_start *start; /* scratch: a vertex and its neighbours */
    float *touch[2];   /* vertex_count */
    uint32_t *touched; /* vertex_count */
    uint32_t touched_count;
    int64_t last_vertex; /* last vertex of the stroke; NONE: none yet */
    float last_position[3];
    double middle_mm, near_mm; /* near_mm: maximum distance of a mirror image from its vertex */
};

/* ---- properties of the mesh ---- */

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

void brush_find_normals(float *out, const mesh *m, const float *position, float *scratch)
{
    const size_t count = m->vertex_count;
    float *normal = scratch, *at = scratch + 3 * count;
    for (size_t v = 0; v < count; ++v)
        for (size_t i = 0; i < 3; ++i)
            at[i * count + v] = position[v * 3 + i];
    normals_smooth(normal, normal + count, normal + 2 * count, at, at + count, at + 2 * count,
                   m->vertex_count, m->triangle, m->triangle_count);
    for (size_t v = 0; v < count; ++v)
        for (size_t i = 0; i < 3; ++i)
            out[v * 3 + i] = normal[i * count + v];
}

static bool take_normals(brush *self)
{
    const mesh *m = self->m;
    const size_t count = m->vertex_count;
    if (m->normal) {
        memcpy(self->normal, m->normal, count * 3 * sizeof *self->normal);
        return true;
    }
    float *scratch = malloc((count * 6 + 1) * sizeof *scratch);
    if (scratch)
        brush_find_normals(self->normal, m, m->position, scratch);
    free(scratch);
    return scratch != NULL;
}

/* Finds the plane of symmetry of the head, or of the whole mesh if that fits better or no head is
 * found. */
static bool find_middle(brush *self)
{
    const double reach_mm = 0.5;
    float low[3], high[3];
    mesh_bounds(self->m, low, high);
    self->near_mm = 0.03 * distance_between(low, high);
    self->middle_mm = 0.5 * ((double)low[0] + (double)high[0]);
    rig_head head;
    uint32_t alone, alone_in_head, example;
    if (!rig_mirror_count_alone(&alone, &example, self->m, NULL, self->middle_mm, reach_mm))
        return false;
    if (alone == 0 || rig_head_measure(&head, self->m, NULL, NULL) < 0)
        return true;
    if (!rig_mirror_count_alone(&alone_in_head, &example, self->m, NULL, head.middle_x, reach_mm))
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
    self->distance = calloc(count, sizeof *self->distance);
    self->start = calloc(most_neighbours(self->t) + 1u, sizeof *self->start);
    self->touch[BRUSH_HERE] = calloc(count, sizeof(float));
    self->touch[BRUSH_THERE] = calloc(count, sizeof(float));
    self->touched = calloc(count, sizeof *self->touched);
    return self->normal && self->distance && self->start && self->touch[BRUSH_HERE] &&
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
    if (allocate(self) && find_middle(self) && take_normals(self))
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

/* Computes distances along the surface from a point near `vertex`. */
static mrt_result spread(brush *self, uint32_t vertex, const float position[3], double reach_mm,
                         error *err)
{
    const topology *t = self->t;
    uint32_t count = 0;
    vertex = mesh_point(self->m, vertex);
    self->start[count++] =
        (bind_start){vertex, distance_between(position_of(self, vertex), position)};
    for (uint32_t i = t->neighbour_start[vertex]; i < t->neighbour_start[vertex + 1]; ++i) {
        uint32_t next = t->neighbour[i];
        self->start[count++] =
            (bind_start){next, distance_between(position_of(self, next), position)};
    }
    return bind_distances(self->distance, self->start, count, reach_mm, self->m, t)
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

/* Uses the straight distance unless the distance along edges is much longer. So the brush is round
 * on any mesh, but does not cross a slit. */
static mrt_result dab(brush *self, uint32_t side, uint32_t vertex, const float position[3],
                      error *err)
{
    mrt_result result = spread(self, vertex, position, detour * self->shape.radius_mm, err);
    for (uint32_t v = 0; result >= 0 && v < self->m->vertex_count; ++v) {
        if (!isfinite(self->distance[v]))
            continue;
        double straight_mm = distance_between(position_of(self, v), position);
        double away_mm = fmax(straight_mm, self->distance[v] / detour);
        touch(self, side, v, strength_at(&self->shape, away_mm));
    }
    return result;
}

static mrt_result dab_sides(brush *self, uint32_t vertex, const float position[3], error *err)
{
    mrt_result result = dab(self, BRUSH_HERE, vertex, position, err);
    if (result < 0 || self->shape.sides == BRUSH_ONE_SIDE)
        return result;
    uint32_t image = brush_mirror_of(self, vertex);
    if (image == UINT32_MAX)
        return result;
    const float image_position[3] = {(float)(2.0 * self->middle_mm - (double)position[0]),
                                     position[1], position[2]};
    return dab(self, BRUSH_THERE, image, image_position, err);
}

/* ---- between two points ---- */

/* Returns the nearest vertex among those that the last spread reached. */
static uint32_t nearest_reached(const brush *self, const float position[3])
{
    uint32_t best = (uint32_t)self->last_vertex;
    double best_mm = (double)INFINITY;
    for (uint32_t v = 0; v < self->m->vertex_count; ++v) {
        if (!isfinite(self->distance[v]))
            continue;
        double away_mm = distance_between(position_of(self, v), position);
        if (away_mm < best_mm) {
            best = v;
            best_mm = away_mm;
        }
    }
    return best;
}

typedef struct brush_way {
    uint32_t vertex[STEPS_MAX];
    float position[STEPS_MAX][3];
    uint32_t count;
} brush_way;

/* Finds points along the surface, less than half a radius apart. Returns none if no surface
 * connects the ends. */
static mrt_result find_way(brush *self, brush_way *out, uint32_t vertex, const float position[3],
                           error *err)
{
    out->count = 0;
    double length_mm = distance_between(self->last_position, position);
    double steps = ceil(length_mm / (0.5 * self->shape.radius_mm));
    if (self->last_vertex == NONE || !(steps > 1.0))
        return MRT_OK;
    mrt_result result = spread(self, (uint32_t)self->last_vertex, self->last_position,
                               1.5 * length_mm + 0.5 * self->shape.radius_mm, err);
    if (result < 0 || !isfinite(self->distance[vertex]))
        return result;
    out->count = (uint32_t)fmin(steps, STEPS_MAX) - 1;
    for (uint32_t k = 0; k < out->count; ++k) {
        float share = (float)(k + 1) / (float)(out->count + 1);
        for (int i = 0; i < 3; ++i)
            out->position[k][i] =
                self->last_position[i] + share * (position[i] - self->last_position[i]);
        out->vertex[k] = nearest_reached(self, out->position[k]);
        memcpy(out->position[k], position_of(self, out->vertex[k]), sizeof out->position[k]);
    }
    return result;
}

mrt_result brush_move(brush *self, uint32_t vertex, const float position[3], error *err)
{
    brush_way way;
    if (vertex >= self->m->vertex_count)
        return error_set(err, MRT_ERR_ARGUMENT, "the mesh has no vertex %u", vertex);
    mrt_result result = find_way(self, &way, vertex, position, err);
    for (uint32_t k = 0; result >= 0 && k < way.count; ++k)
        result = dab_sides(self, way.vertex[k], way.position[k], err);
    if (result >= 0)
        result = dab_sides(self, vertex, position, err);
    self->last_vertex = vertex;
    memcpy(self->last_position, position, sizeof self->last_position);
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

/* ---- a stroke ---- */

enum { NAME = 64, LAYERS_MAX = 2 * RIG_BONES_MAX + 4, SIDES = 2, FULL = 255, HALF = 128 };

typedef struct layer { /* region that an ink writes to */
    char name[NAME];
    uint32_t region; /* RIG_NONE: find by name, or create */
    rig_edit_region_values says;
    bool is_binary; /* values are 0 or 255 only */
    bool is_mobility;
    uint8_t *before, *start, *now; /* vertex_count; start: values at the first touch */
} layer;

struct rig_stroke {
    uint32_t vertex_count;
    rig_stroke_ink ink;
    layer layer[LAYERS_MAX];
    uint32_t layer_count;
    uint32_t target[SIDES], bone[SIDES]; /* index of a layer; of a bone */
};

/* ---- names ---- */

/* The same prefixes as in rig_region_is_paint. */
static const char paint_prefix[] = "painted ", rigid_prefix[] = "rigid ";
static const char free_name[] = "painted free", still_name[] = "painted still";

static void says_of_ink(layer *out, const rig *r, rig_ink ink, uint32_t bone)
{
    out->says = (rig_edit_region_values){RIG_NONE, false, (double)NAN, (double)NAN};
    switch (ink) {
    case RIG_INK_RIGID:
        (void)snprintf(out->name, sizeof out->name, "%s%.55s", rigid_prefix, r->bone[bone].name);
        out->says.bone = bone;
        out->says.is_rigid = true;
        break;
    case RIG_INK_FREE:
        (void)snprintf(out->name, sizeof out->name, "%s", free_name);
        out->says.mobility = 1.0;
        break;
    case RIG_INK_STILL:
        (void)snprintf(out->name, sizeof out->name, "%s", still_name);
        out->says.mobility = 0.0;
        break;
    default:
        (void)snprintf(out->name, sizeof out->name, "%s%.55s", paint_prefix, r->bone[bone].name);
        out->says.bone = bone;
        out->says.weight = 1.0;
        break;
    }
}

/* ---- layers ---- */

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to paint");
}

static void settle(layer *l)
{
    l->is_mobility = !l->says.is_rigid && isnan(l->says.weight);
    l->is_binary = l->says.is_rigid || (l->is_mobility && !(l->says.mobility > 0.0));
}

static mrt_result allocate_layer(layer *l, const rig *r, uint32_t vertex_count, error *err)
{
    l->before = calloc((size_t)vertex_count + 1, 1);
    l->start = calloc((size_t)vertex_count + 1, 1);
    l->now = calloc((size_t)vertex_count + 1, 1);
    if (!l->before || !l->start || !l->now)
        return no_memory(err);
    if (l->region != RIG_NONE)
        rig_edit_values(l->before, r, l->region, vertex_count);
    memcpy(l->start, l->before, vertex_count);
    memcpy(l->now, l->before, vertex_count);
    return MRT_OK;
}

static mrt_result add_region_layer(rig_stroke *self, const rig *r, uint32_t region, error *err)
{
    if (self->layer_count == LAYERS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "too many painted regions for one stroke");
    const rig_region *from = &r->region[region];
    layer *l = &self->layer[self->layer_count++];
    *l = (layer){.region = region,
                 .says = {from->bone, from->is_rigid, from->weight, from->mobility}};
    (void)snprintf(l->name, sizeof l->name, "%s", from->name ? from->name : "");
    settle(l);
    return allocate_layer(l, r, self->vertex_count, err);
}

/* Finds the layer of an ink, or creates it. */
static mrt_result find_target(rig_stroke *self, const rig *r, rig_ink ink, uint32_t bone,
                              uint32_t *out, error *err)
{
    layer made = {.region = RIG_NONE};
    says_of_ink(&made, r, ink, bone);
    settle(&made);
    for (uint32_t i = 0; i < self->layer_count; ++i) {
        if (strcmp(self->layer[i].name, made.name) != 0)
            continue;
        *out = i;
        return MRT_OK;
    }
    if (rig_edit_find_region(r, made.name) != RIG_NONE)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the region \"%s\" is not a vertex list and cannot be painted; rename it",
                         made.name);
    if (self->layer_count == LAYERS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "too many painted regions for one stroke");
    *out = self->layer_count;
    self->layer[self->layer_count++] = made;
    return allocate_layer(&self->layer[*out], r, self->vertex_count, err);
}

static mrt_result add_paint_layers(rig_stroke *self, const rig *r, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < r->region_count; ++i)
        if (rig_region_is_paint(&r->region[i]))
            result = add_region_layer(self, r, i, err);
    return result;
}

static uint32_t bone_of_other_side(const rig *r, uint32_t bone)
{
    char name[NAME];
    uint32_t other = RIG_NONE;
    if (rig_edit_other_side(r->bone[bone].name, name, sizeof name))
        other = rig_find_bone(r, name);
    return other == RIG_NONE ? bone : other;
}

static mrt_result find_targets(rig_stroke *self, const rig *r, error *err)
{
    rig_ink ink = self->ink.ink;
    bool is_of_bone = ink == RIG_INK_RIDES || ink == RIG_INK_RIGID;
    if (is_of_bone && self->ink.bone >= r->bone_count)
        return error_set(err, MRT_ERR_ARGUMENT, "choose a bone to paint");
    if (is_of_bone) {
        self->bone[BRUSH_HERE] = self->ink.bone;
        self->bone[BRUSH_THERE] = bone_of_other_side(r, self->ink.bone);
    }
    mrt_result result = add_paint_layers(self, r, err);
    for (uint32_t side = 0; result >= 0 && side < SIDES && ink != RIG_INK_ERASER; ++side)
        result = find_target(self, r, ink, self->bone[side], &self->target[side], err);
    return result;
}

static mrt_result find_region(rig_stroke *self, const rig *r, error *err)
{
    uint32_t region = self->ink.region;
    if (region >= r->region_count || !rig_edit_can_paint(r, region))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "this region is not a vertex list; press \"Make paintable\" first");
    self->target[BRUSH_HERE] = self->target[BRUSH_THERE] = 0;
    self->bone[BRUSH_HERE] = self->bone[BRUSH_THERE] = r->region[region].bone;
    return add_region_layer(self, r, region, err);
}

/* ---- values at the first touch ---- */

static bool is_share(const layer *l)
{
    return !l->is_binary && !l->is_mobility;
}

static uint8_t in_255ths(float share)
{
    return (uint8_t)lrintf(fminf(fmaxf(share, 0.0f), 1.0f) * (float)FULL);
}

/* Returns whether the vertex has ink of this kind. */
static bool is_painted(const rig_stroke *self, bool is_mobility, uint32_t vertex)
{
    for (uint32_t i = 0; i < self->layer_count; ++i)
        if (self->layer[i].is_mobility == is_mobility && self->layer[i].before[vertex] > 0)
            return true;
    return false;
}

static void start_from(rig_stroke *self, layer *l, const float *filled)
{
    for (uint32_t v = 0; v < self->vertex_count; ++v)
        if (!is_painted(self, l->is_mobility, v))
            l->start[v] = in_255ths(filled[v]);
}

/* Makes one layer for each bone, so that the other bones keep their weights. */
static mrt_result find_all_shares(rig_stroke *self, const rig *r, const binding *filled, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t b = 0; result >= 0 && b < r->bone_count; ++b) {
        uint32_t at;
        result = find_target(self, r, RIG_INK_RIDES, b, &at, err);
        if (result >= 0 && is_share(&self->layer[at]))
            start_from(self, &self->layer[at], filled->weight + (size_t)b * self->vertex_count);
    }
    return result;
}

static mrt_result find_starts(rig_stroke *self, const rig *r, const binding *filled, error *err)
{
    if (!filled || filled->vertex_count != self->vertex_count ||
        filled->bone_count != r->bone_count)
        return MRT_OK;
    if (self->ink.ink == RIG_INK_RIDES)
        return find_all_shares(self, r, filled, err);
    if (self->ink.ink == RIG_INK_FREE)
        start_from(self, &self->layer[self->target[BRUSH_HERE]], filled->mobility);
    return MRT_OK;
}

mrt_result rig_stroke_begin(rig_stroke **out, const rig *r, uint32_t vertex_count,
                            const rig_stroke_ink *ink, const binding *filled, error *err)
{
    rig_stroke *self = calloc(1, sizeof *self);
    *out = self;
    if (!self)
        return no_memory(err);
    self->vertex_count = vertex_count;
    self->ink = *ink;
    for (uint32_t side = 0; side < SIDES; ++side)
        self->target[side] = self->bone[side] = RIG_NONE;
    mrt_result result =
        ink->ink == RIG_INK_REGION ? find_region(self, r, err) : find_targets(self, r, err);
    if (result >= 0)
        result = find_starts(self, r, filled, err);
    if (result >= 0)
        return result;
    rig_stroke_destroy(self);
    *out = NULL;
    return result;
}

void rig_stroke_destroy(rig_stroke *self)
{
    for (uint32_t i = 0; self && i < self->layer_count; ++i) {
        free(self->layer[i].before);
        free(self->layer[i].start);
        free(self->layer[i].now);
    }
    free(self);
}

/* ---- effect of a touch on a vertex ---- */

static uint8_t blend(uint8_t before, double to, float touch)
{
    double value = (double)before + (to - (double)before) * (double)touch;
    return (uint8_t)fmin(fmax(floor(value + 0.5), 0.0), (double)FULL);
}

static uint8_t gain(const layer *l, uint32_t vertex, double strength, float touch)
{
    if (l->is_binary)
        return strength * (double)touch >= 0.5 ? FULL : l->before[vertex];
    return blend(l->start[vertex], strength * (double)FULL, touch);
}

static uint8_t lose(const layer *l, uint32_t vertex, double strength, float touch)
{
    uint8_t before = l->before[vertex];
    if (l->is_binary)
        return strength * (double)touch >= 0.5 ? 0 : before;
    return blend(before, 0.0, (float)strength * touch);
}

static bool theirs_is_new(const layer *winner, uint32_t vertex)
{
    return winner->now[vertex] > 0 && winner->before[vertex] == 0;
}

/* Returns the reduced value of a layer at a vertex where another layer gains. The weights of all
 * bones sum to at most 1, and mobility has one value. */
static uint8_t make_room(const layer *l, const layer *winner, uint32_t vertex)
{
    bool begins = is_share(l) && is_share(winner) && theirs_is_new(winner, vertex);
    uint8_t before = begins ? l->start[vertex] : l->before[vertex], theirs = winner->now[vertex];
    if (l->is_mobility != winner->is_mobility)
        return before;
    if (l->is_mobility || winner->is_binary)
        return theirs > 0 ? 0 : before;
    if (l->is_binary)
        return theirs >= HALF ? 0 : before;
    return before > FULL - theirs ? (uint8_t)(FULL - theirs) : before;
}

static bool is_target(const rig_stroke *self, uint32_t index)
{
    return index == self->target[BRUSH_HERE] || index == self->target[BRUSH_THERE];
}

static void paint_vertex(rig_stroke *self, uint32_t vertex, const float touch[SIDES])
{
    double strength = self->ink.strength;
    bool is_one_ink = self->target[BRUSH_HERE] == self->target[BRUSH_THERE];
    uint32_t side = touch[BRUSH_THERE] > touch[BRUSH_HERE] ? BRUSH_THERE : BRUSH_HERE;
    layer *target = &self->layer[self->target[side]];
    target->now[vertex] = self->ink.takes_away ? lose(target, vertex, strength, touch[side])
                                               : gain(target, vertex, strength, touch[side]);
    for (uint32_t i = 0; i < self->layer_count; ++i)
        if (&self->layer[i] != target && (!is_target(self, i) || !is_one_ink))
            self->layer[i].now[vertex] = make_room(&self->layer[i], target, vertex);
}

static void erase_vertex(rig_stroke *self, uint32_t vertex, const float touch[SIDES])
{
    float most = fmaxf(touch[BRUSH_HERE], touch[BRUSH_THERE]);
    for (uint32_t i = 0; i < self->layer_count; ++i)
        self->layer[i].now[vertex] = lose(&self->layer[i], vertex, self->ink.strength, most);
}

void rig_stroke_update(rig_stroke *self, const brush *b)
{
    uint32_t count;
    const uint32_t *touched = brush_touched(b, &count);
    const float *here = brush_touch(b, BRUSH_HERE), *there = brush_touch(b, BRUSH_THERE);
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t vertex = touched[i];
        const float touch[SIDES] = {here[vertex], there[vertex]};
        if (vertex >= self->vertex_count)
            continue;
        if (self->ink.ink == RIG_INK_ERASER)
            erase_vertex(self, vertex, touch);
        else
            paint_vertex(self, vertex, touch);
    }
}

uint8_t rig_stroke_value(const rig_stroke *self, uint32_t vertex)
{
    uint8_t most = 0;
    for (uint32_t i = 0; i < self->layer_count; ++i)
        if ((self->ink.ink == RIG_INK_ERASER || is_target(self, i)) &&
            self->layer[i].now[vertex] > most)
            most = self->layer[i].now[vertex];
    return most;
}

uint32_t rig_stroke_bone(const rig_stroke *self, uint32_t side)
{
    return self->bone[side];
}

/* ---- result in the rig ---- */

static uint32_t count_changed(const layer *l, uint32_t vertex_count)
{
    uint32_t count = 0;
    for (uint32_t v = 0; v < vertex_count; ++v)
        count += l->before[v] != l->now[v];
    return count;
}

static mrt_result put_layer(const layer *l, rig *changed, uint32_t vertex_count, error *err)
{
    uint32_t region = l->region;
    mrt_result result = MRT_OK;
    if (region == RIG_NONE)
        result = rig_edit_add_region(changed, l->name, &l->says, &region, err);
    return result < 0 ? result : rig_edit_paint(changed, region, l->now, vertex_count, err);
}

typedef enum which_layers { THE_OTHERS = 0, THE_TARGETS } which_layers;

static mrt_result put_layers(rig_stroke *self, which_layers which, rig *changed,
                             uint32_t *out_changed, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < self->layer_count; ++i) {
        uint32_t count = count_changed(&self->layer[i], self->vertex_count);
        if (count == 0 || is_target(self, i) != (which == THE_TARGETS))
            continue;
        result = put_layer(&self->layer[i], changed, self->vertex_count, err);
        *out_changed = count > *out_changed ? count : *out_changed;
    }
    return result;
}

mrt_result rig_stroke_end(rig_stroke *self, rig *changed, uint32_t *out_changed, error *err)
{
    *out_changed = 0;
    mrt_result result = put_layers(self, THE_OTHERS, changed, out_changed, err);
    if (result >= 0) /* appended as last region, so that the newest paint wins */
        result = put_layers(self, THE_TARGETS, changed, out_changed, err);
    return result;
}
