#include "stage/perform/composer.h"
#include "base/arrays.h"
#include "base/bytes.h"
#include "face/face_weights.h"
#include "face/rig/rig_poses.h"
#include "mesh/arkit.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One source of pulls: its current pull, and its share of the current shape. */
typedef struct part_state {
    bool is_present;  /* in this step */
    bool was_present; /* in the previous step */
    composer_part part;
    bool has_pull; /* `last_pull` is valid: its last anchored pull */
    mrt_pull last_pull;
    uint32_t commit; /* of the previous step */
    /* in the engagement: the pull with which the part holds the face */
    bool is_joined;
    mrt_pull joined;
    double share; /* weight times gain */
    double weight;
    uint32_t control[MRT_MAX_VECTORS]; /* control of each vector; COMPOSER_NO_CONTROL: none */
    /* unanchored */
    bool was_near, is_dragging;
    double tip[MRT_MAX_VECTORS * 3]; /* mm: reached positions of the tips */
    uint32_t tip_count;
} part_state;

enum { COMPOSER_NO_CONTROL = UINT32_MAX };

/* A control of the engagement: a contact, which several parts may pull, or a free point of one
 * part. */
typedef struct joined_control {
    uint32_t contact;      /* 1 + index; 0: a free point */
    uint32_t slot, vector; /* of the free point */
    vec3 start;            /* mm: position when it was gripped */
    vec3 rest;             /* of a pointer's free point: position on the rest face */
    bool is_pointer;       /* only pointers pull it */
    vec3 held; /* mm, bones at rest: offset from `start` that the other parts gave it when a pointer
                  gripped it */
} joined_control;

struct composer {
    face *face;
    rig rig; /* copy of the face file's rig, with completed poses */
    mapped_face mapped;
    mrt_dof dof[MRT_MAX_DOFS];
    arrays poses; /* memory that mapped.pose points to */
    csrbf_settings solver;
    double reach_mm;
    vec3 centre;
    shading *shading;

    part_state state[COMPOSER_PARTS_MAX];
    uint32_t order[COMPOSER_PARTS_MAX]; /* slots of the parts of this step, bottom first */
    uint32_t order_count;
    uint32_t joined_order[COMPOSER_PARTS_MAX]; /* slots in the engagement, bottom first */
    uint32_t joined_count;

    bool is_mixed; /* in this step some parts drag the shape and others are anchored */
    bool engaged;  /* anchored: the face is engaged at `control` */
    bool stale;    /* anchored: the shown shape is older than the last step */
    joined_control control[MRT_MAX_VECTORS];
    uint32_t control_count;
    float engaged_radius_mm;
    double aimed[MRT_MAX_VECTORS * 3]; /* mm: last targets of the controls */
    mrt_pull pulled;                   /* of the last step */
    float watched[MRT_MAX_DOFS];       /* of the last step, without life */
    composer_counts counts;
};

static double to_double(float v)
{
    return (double)v;
}

static vec3 vec3_of(mrt_vec3 p)
{
    return (vec3){(double)p.x, (double)p.y, (double)p.z};
}

/* Returns weight times gain. */
static double share_of(const part_state *v)
{
    return v->part.weight * v->part.gain;
}

/* Filter for functions that select parts: accepts none. */
static bool accepts_none(const part_state *v)
{
    (void)v;
    return false;
}

static bool has_joined_part(const composer *self)
{
    for (uint32_t i = 0; i < self->joined_count; ++i)
        if (self->state[self->joined_order[i]].is_joined)
            return true;
    return false;
}

static void note_problem(composer *self, const char *text)
{
    if (!self->counts.first_problem.text[0])
        error_set(&self->counts.first_problem, MRT_ERR_FORMAT, "%s", text);
}

/* Updates the shown shape to the last step. */
static void show(composer *self)
{
    if (self->stale)
        face_show(self->face);
    self->stale = false;
}

/* how: the pull with the solver options; NULL: the settings of the face. */
static csrbf_settings settings_of(const composer *self, float radius_mm, const mrt_pull *how)
{
    csrbf_settings settings = self->solver;
    if (radius_mm > 0.0f)
        settings.radius = to_double(radius_mm);
    if (!how)
        return settings;
    if (how->solve & MRT_SOLVE_LINEAR)
        settings.polynomial = CSRBF_LINEAR;
    settings.is_one_step = (how->solve & MRT_SOLVE_ONCE) != 0;
    if (how->stretch_most > 0.0f || how->stretch_most < 0.0f)
        settings.stretch_most = to_double(how->stretch_most);
    return settings;
}

/* ---- blending the pulls of all parts, layer by layer ---- */

static bool is_one(double share)
{
    return !(fabs(share - 1.0) > 0.0);
}

typedef struct blended {
    double value[3];
    double cover;  /* sum of the weights in the current layer */
    double sum[3]; /* of the current layer */
    bool is_additive;
    uint32_t layer;
    uint32_t parts;
} blended;

static void close_layer(blended *b)
{
    double below = b->is_additive ? 1.0 : 1.0 - fmin(b->cover, 1.0);
    if (b->cover > 0.0)
        for (int axis = 0; axis < 3; ++axis)
            b->value[axis] = below > 0.0 ? b->sum[axis] + below * b->value[axis] : b->sum[axis];
    b->cover = 0.0;
    memset(b->sum, 0, sizeof b->sum);
}

static void add_part(blended *b, const part_state *v, double weight, const double *added)
{
    if (b->layer != v->part.layer)
        close_layer(b);
    b->parts += 1;
    b->layer = v->part.layer;
    b->is_additive = v->part.is_additive;
    if (b->cover > 0.0)
        for (int axis = 0; axis < 3; ++axis)
            b->sum[axis] += added[axis];
    else
        memcpy(b->sum, added, sizeof b->sum);
    b->cover += weight;
}

/* Returns whether `accepts` accepts at least one part that holds the face. True for NULL. */
static bool accepts_any_joined(const composer *self, bool (*accepts)(const part_state *v))
{
    for (uint32_t i = 0; accepts && i < self->joined_count; ++i) {
        const part_state *v = &self->state[self->joined_order[i]];
        if (v->is_joined && accepts(v))
            return true;
    }
    return !accepts;
}

static bool is_at(vec3 a, vec3 b)
{
    return a.x >= b.x && a.x <= b.x && a.y >= b.y && a.y <= b.y && a.z >= b.z && a.z <= b.z;
}

/* Computes the target of each control of the engagement: 3 * control_count values, mm. The target
 * is an offset from the start where rides[k], as face_ride then adds the motion of the bones.
 * Otherwise it is a position. `accepts` selects the parts whose pulls are blended; NULL: all. */
static void blend_ends(const composer *self, bool (*accepts)(const part_state *v), double *end,
                       uint8_t *rides)
{
    blended at[MRT_MAX_VECTORS];
    memset(at, 0, sizeof at);
    bool is_held = accepts_any_joined(self, accepts);
    for (uint32_t k = 0; is_held && k < self->control_count; ++k) {
        const vec3 *held = &self->control[k].held;
        at[k].value[0] = held->x;
        at[k].value[1] = held->y;
        at[k].value[2] = held->z;
    }
    for (uint32_t i = 0; i < COMPOSER_PARTS_MAX; ++i) {
        const part_state *v = &self->state[self->joined_order[i]];
        for (uint32_t j = 0; i < self->joined_count && v->is_joined && j < v->joined.count; ++j) {
            uint32_t k = v->control[j];
            if (k == COMPOSER_NO_CONTROL || (accepts && !accepts(v)))
                continue;
            vec3 start = vec3_of(v->joined.vector[j].start), to = vec3_of(v->joined.vector[j].end);
            const double added[3] = {v->share * (to.x - start.x), v->share * (to.y - start.y),
                                     v->share * (to.z - start.z)};
            add_part(&at[k], v, v->weight, added);
        }
    }
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const joined_control *c = &self->control[k];
        close_layer(&at[k]);
        rides[k] = c->contact != 0;
        memcpy(end + 3 * k, at[k].value, sizeof at[k].value);
        if (rides[k])
            continue;
        const part_state *v = &self->state[c->slot];
        vec3 position = c->start;
        if (v->is_joined && !v->part.is_pointer && at[k].parts == 1 && is_one(v->share) &&
            (!accepts || accepts(v)) &&
            is_at(position, vec3_of(v->joined.vector[c->vector].start))) {
            /* use the end itself, because start + (end - start) would round */
            position = vec3_of(v->joined.vector[c->vector].end);
            memset(end + 3 * k, 0, 3 * sizeof *end);
        }
        end[3 * k] += position.x;
        end[3 * k + 1] += position.y;
        end[3 * k + 2] += position.z;
    }
}

static bool is_not_life(const part_state *v)
{
    return !v->part.is_life;
}

/* Blends the degrees of freedom of the parts that `accepts` accepts; NULL: all. NaN: no part drives
 * it. */
static void blend_dofs(const composer *self, bool (*accepts)(const part_state *v), float *out)
{
    for (uint32_t d = 0; d < MRT_MAX_DOFS; ++d) {
        blended at = {.cover = 0};
        bool is_driven = false;
        for (uint32_t i = 0; i < self->order_count; ++i) {
            const part_state *v = &self->state[self->order[i]];
            const mrt_pull *pull =
                v->part.pull->mode == MRT_UNANCHORED ? v->part.pull : &v->last_pull;
            bool has_value = v->has_pull || v->part.pull->mode == MRT_UNANCHORED;
            if (!has_value || isnan(pull->dof[d]) || d >= self->mapped.about.dof_count ||
                (accepts && !accepts(v)) ||
                (v->part.owns && !v->part.owns[self->mapped.about.contact_count + d]))
                continue;
            const double added[3] = {share_of(v) * (double)pull->dof[d], 0, 0};
            add_part(&at, v, v->part.weight, added);
            is_driven = true;
        }
        close_layer(&at);
        out[d] = is_driven ? (float)at.value[0] : NAN;
    }
}

/* Blends the weights of the head's own shapes of all parts and requests them for the next frame. */
static void request_shapes(composer *self)
{
    uint32_t free_points = self->mapped.about.contact_count + self->mapped.about.dof_count;
    uint32_t count = face_shape_count(self->face);
    float weight[FACE_SHAPES_MAX];
    for (uint32_t s = 0; s < count; ++s) {
        blended at = {.cover = 0};
        for (uint32_t i = 0; i < self->order_count; ++i) {
            const part_state *v = &self->state[self->order[i]];
            if (!v->part.shapes || isnan(v->part.shapes[s]) ||
                (v->part.owns && !v->part.owns[free_points]))
                continue;
            const double added[3] = {share_of(v) * (double)v->part.shapes[s], 0, 0};
            add_part(&at, v, v->part.weight, added);
        }
        close_layer(&at);
        weight[s] = (float)at.value[0];
    }
    face_set_least_weights(self->face, weight);
}

/* ---- the anchored pulls of all parts in one solve ---- */

static bool owns(const composer *self, const part_state *v, uint32_t contact)
{
    if (!v->part.owns)
        return true;
    uint32_t free_points = self->mapped.about.contact_count + self->mapped.about.dof_count;
    return v->part.owns[contact > 0 ? contact - 1 : free_points] != 0;
}

/* ---- which part holds which control ---- */

static uint32_t find_contact(const joined_control *control, uint32_t count, uint32_t contact)
{
    for (uint32_t k = 0; k < count; ++k)
        if (control[k].contact == contact)
            return k;
    return COMPOSER_NO_CONTROL;
}

/* All parts of a layer that pull the same free point share one control, so both sides of a
 * cross-fade hold the same one. */
static uint32_t find_free_point(const composer *self, const joined_control *control, uint32_t count,
                                const part_state *v, const mrt_vector *vector)
{
    for (uint32_t k = 0; k < count; ++k) {
        const part_state *other = &self->state[control[k].slot];
        if (control[k].contact == 0 && other->part.layer == v->part.layer &&
            memcmp(&other->last_pull.vector[control[k].vector].start, &vector->start,
                   sizeof vector->start) == 0)
            return k;
    }
    return COMPOSER_NO_CONTROL;
}

/* The controls of all parts. */
typedef struct holds {
    joined_control control[MRT_MAX_VECTORS];
    uint32_t count;
    uint32_t of[COMPOSER_PARTS_MAX]
               [MRT_MAX_VECTORS]; /* control of each vector, by slot of the part */
} holds;

/* Lists the controls of all parts, in the order of the parts. */
static void list_holds(composer *self, holds *out)
{
    out->count = 0;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        uint32_t slot = self->order[i];
        const part_state *v = &self->state[slot];
        uint32_t others = out->count; /* excludes its own: a part may hold a contact twice */
        for (uint32_t j = 0; v->has_pull && j < v->last_pull.count; ++j) {
            uint32_t contact = v->last_pull.vector[j].contact;
            uint32_t at = COMPOSER_NO_CONTROL;
            out->of[slot][j] = COMPOSER_NO_CONTROL;
            if (!owns(self, v, contact))
                continue;
            if (contact > 0)
                at = find_contact(out->control, others, contact);
            else
                at = find_free_point(self, out->control, others, v, &v->last_pull.vector[j]);
            if (at == COMPOSER_NO_CONTROL && out->count == MRT_MAX_VECTORS) {
                self->counts.left_out += 1;
                continue;
            }
            if (at == COMPOSER_NO_CONTROL) {
                at = out->count++;
                out->control[at] = (joined_control){.contact = contact,
                                                    .slot = slot,
                                                    .vector = j,
                                                    .rest = vec3_of(v->last_pull.vector[j].start),
                                                    .is_pointer = v->part.is_pointer};
            }
            out->control[at].is_pointer &= v->part.is_pointer;
            out->of[slot][j] = at;
        }
    }
}

static bool are_held(const composer *self, const holds *h)
{
    if (h->count != self->control_count)
        return false;
    for (uint32_t k = 0; k < h->count; ++k) {
        const joined_control *a = &h->control[k], *b = &self->control[k];
        if (a->contact != b->contact)
            return false;
        if (a->contact == 0 && (a->slot != b->slot || a->vector != b->vector))
            return false;
    }
    return true;
}

/* Returns the radius of the joint solve: that of the lowest part that sets one. A pointer sets it
 * only if no other part pulls. 0: none. */
static float joined_radius_mm(const composer *self)
{
    float of_pointer = 0.0f;
    bool is_alone = true;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const part_state *v = &self->state[self->order[i]];
        if (!v->has_pull)
            continue;
        is_alone &= v->part.is_pointer || v->last_pull.count == 0;
        if (v->last_pull.radius_mm > 0.0f && !v->part.is_pointer)
            return v->last_pull.radius_mm;
        of_pointer = v->last_pull.radius_mm > 0.0f ? v->last_pull.radius_mm : of_pointer;
    }
    return is_alone ? of_pointer : 0.0f;
}

/* Returns the pull of the lowest part that is not a pointer. NULL: no such part. */
static const mrt_pull *joined_solver_pull(const composer *self)
{
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const part_state *v = &self->state[self->order[i]];
        if (v->has_pull && !v->part.is_pointer)
            return &v->last_pull;
    }
    return NULL;
}

/* Returns whether the part grips the face again. Its current offset then stays in the shape. */
static bool is_regripped(const part_state *v)
{
    return v->is_joined && v->is_present && !v->part.is_pointer &&
           (v->joined.anchor != v->last_pull.anchor || v->joined.count != v->last_pull.count ||
            v->joined.solve != v->last_pull.solve ||
            fabsf(v->joined.stretch_most - v->last_pull.stretch_most) > 0.0f ||
            fabsf(v->joined.radius_mm - v->last_pull.radius_mm) > 0.0f);
}

/* ---- the engagement ---- */

static void aim(composer *self, bool (*accepts)(const part_state *v), const float *dof)
{
    error err = {""};
    double end[MRT_MAX_VECTORS * 3];
    uint8_t rides[MRT_MAX_VECTORS];
    blend_ends(self, accepts, end, rides);
    face_ride(self->face, end, rides, dof);
    memcpy(self->aimed, end, (size_t)self->control_count * 3 * sizeof *end);
    self->counts.solves += 1;
    if (face_aim(self->face, end, dof, &err) < 0) {
        self->counts.held_pulls += 1;
        note_problem(self, err.text);
        return;
    }
    self->stale = true;
}

/* Shows the face with only the pulls of the parts that `keep` accepts. Bones do not move. */
static void show_only(composer *self, bool (*keep)(const part_state *v))
{
    if (!self->engaged)
        return;
    aim(self, keep, face_metered(self->face)->driven);
    show(self);
}

/* Returns the position of a rest-face point in the shown shape. The point keeps its offset from the
 * vertex that is nearest to it at rest. */
static vec3 position_now(const composer *self, vec3 at_rest)
{
    const points *rest = face_rest(self->face), *shown = face_shown(self->face);
    double from[3], to[3];
    size_t nearest = 0;
    double least = INFINITY;
    for (size_t i = 0; i < rest->count; ++i) {
        points_at(from, rest, i);
        vec3 away = vec3_sub((vec3){from[0], from[1], from[2]}, at_rest);
        double distance = vec3_dot(away, away);
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    points_at(from, rest, nearest);
    points_at(to, shown, nearest);
    vec3 moved = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    return vec3_add(at_rest, moved);
}

/* Returns the position at which an engagement grips the control. For a contact or a point under a
 * pointer it is its position in the shown shape. For other free points it is the start that the
 * mapping gave. */
static vec3 start_of(const composer *self, const joined_control *c)
{
    if (c->contact > 0)
        return face_contact_now(self->face, c->contact);
    if (self->state[c->slot].part.is_pointer)
        return position_now(self, c->rest);
    return vec3_of(self->state[c->slot].last_pull.vector[c->vector].start);
}

/* ---- pointers grip the current shape of the face ---- */

static const joined_control *held_before(const composer *self, const joined_control *c)
{
    if (!self->state[c->slot].was_present)
        return NULL;
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const joined_control *old = &self->control[k];
        bool is_same = old->contact == c->contact &&
                       (c->contact > 0 || memcmp(&old->rest, &c->rest, sizeof c->rest) == 0);
        if (is_same && old->is_pointer == c->is_pointer)
            return old;
    }
    return NULL;
}

/* Finds the controls that pointers begin to grip in this step, and their positions in mm. The old
 * engagement is still shown then. out_is_new: true for those controls. */
static void find_grip_positions(composer *self, const holds *h, double *out_position,
                                bool *out_is_new)
{
    show(self);
    for (uint32_t k = 0; k < h->count; ++k) {
        const joined_control *c = &h->control[k];
        out_is_new[k] = c->is_pointer && !held_before(self, c);
        if (!out_is_new[k])
            continue;
        vec3 position = start_of(self, c);
        out_position[3 * k] = position.x;
        out_position[3 * k + 1] = position.y;
        out_position[3 * k + 2] = position.z;
    }
}

static void keep_held(const composer *self, holds *h)
{
    for (uint32_t k = 0; k < h->count; ++k) {
        joined_control *c = &h->control[k];
        const joined_control *old = c->is_pointer ? held_before(self, c) : NULL;
        if (old)
            c->held = old->held;
    }
}

/* Called after the new engagement. Stores how far the other parts had moved the controls of
 * pointers from the base. */
static void hold_positions(composer *self, const double *position, const bool *is_new_grip)
{
    double way[MRT_MAX_VECTORS * 3] = {0};
    bool any = false;
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const vec3 *start = &self->control[k].start;
        const double still[3] = {start->x, start->y, start->z};
        memcpy(way + 3 * k, is_new_grip[k] ? position + 3 * k : still, sizeof still);
        any |= is_new_grip[k];
    }
    if (any)
        face_unride(self->face, way, face_metered(self->face)->driven);
    for (uint32_t k = 0; k < self->control_count; ++k) {
        joined_control *c = &self->control[k];
        if (!is_new_grip[k])
            continue;
        c->held = (vec3){way[3 * k], way[3 * k + 1], way[3 * k + 2]};
        if (c->contact == 0)
            c->held = vec3_sub((vec3){position[3 * k], position[3 * k + 1], position[3 * k + 2]},
                               c->start);
    }
}

/* The base now contains the offsets that pointers started from. */
static void forget_held(composer *self)
{
    for (uint32_t k = 0; k < self->control_count; ++k)
        self->control[k].held = (vec3){0, 0, 0};
}

/* ---- the engagement's controls ---- */

/* Where all points of the mappings are on hair, hats or other parts that cannot be pulled, each
 * grips the nearest skin that can, at a distance from the others: a performance must move the face.
 */
static void move_to_skin(const composer *self, holds *h, double apart_mm)
{
    vec3 taken[MRT_MAX_VECTORS];
    uint32_t count = 0;
    for (uint32_t k = 0; k < h->count; ++k)
        if (h->control[k].contact > 0 || self->state[h->control[k].slot].part.is_pointer ||
            face_can_grip(self->face, h->control[k].start))
            return;
    for (uint32_t k = 0; k < h->count; ++k)
        if (face_movable_near(self->face, h->control[k].start, taken, count, apart_mm,
                              &taken[count])) {
            h->control[k].start = taken[count];
            count += 1;
        }
}

static void engage(composer *self, holds *h)
{
    error err = {""};
    face_control grip[MRT_MAX_VECTORS];
    float radius_mm = joined_radius_mm(self);
    csrbf_settings settings = settings_of(self, radius_mm, joined_solver_pull(self));
    for (uint32_t k = 0; k < h->count; ++k)
        h->control[k].start = start_of(self, &h->control[k]);
    move_to_skin(self, h, 0.2 * settings.radius);
    for (uint32_t k = 0; k < h->count; ++k)
        grip[k] = (face_control){h->control[k].start, h->control[k].contact};
    if (face_engage(self->face, &settings, grip, h->count, &err) < 0) {
        self->counts.held_pulls += 1;
        note_problem(self, err.text);
        self->engaged = false;
        return;
    }
    memcpy(self->control, h->control, h->count * sizeof *h->control);
    self->control_count = h->count;
    self->engaged_radius_mm = radius_mm;
    self->engaged = true;
    self->counts.engagements += 1;
}

/* Ends an engagement. Bakes into the shape only the pulls of the parts that `stays` accepts. */
static void settle(composer *self, bool (*stays)(const part_state *v))
{
    bool all_stay = true;
    for (uint32_t i = 0; i < self->joined_count; ++i) {
        const part_state *v = &self->state[self->joined_order[i]];
        all_stay &= !v->is_joined || stays(v);
    }
    show(self); /* the base is the shape of this step, not of the last drawn frame */
    if (!all_stay)
        show_only(self, stays);
    if (accepts_any_joined(self, stays))
        forget_held(self);
}

/* Records the pulls of this step as those that hold the face. */
static void join(composer *self, const holds *h)
{
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->state[slot].is_joined = false;
    self->joined_count = 0;
    for (uint32_t i = 0; i < self->order_count && self->engaged; ++i) {
        uint32_t slot = self->order[i];
        part_state *v = &self->state[slot];
        if (!v->has_pull)
            continue;
        v->is_joined = true;
        v->joined = v->last_pull;
        v->share = share_of(v);
        v->weight = v->part.weight;
        memcpy(v->control, h->of[slot], sizeof v->control);
        self->joined_order[self->joined_count++] = slot;
    }
}

static bool has_any_pull(const composer *self)
{
    for (uint32_t i = 0; i < self->order_count; ++i)
        if (self->state[self->order[i]].has_pull)
            return true;
    return false;
}

/* Returns the face to its base when no part pulls. */
static void rest(composer *self)
{
    static const float still[MRT_MAX_DOFS] = {0};
    if (!self->engaged || self->joined_count == 0)
        return;
    face_set_least_weights(self->face, NULL);
    aim(self, accepts_none, still);
    forget_held(self);
    self->joined_count = 0;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->state[slot].is_joined = false;
}

static bool has_committed(const part_state *v)
{
    return v->is_present && v->was_present && v->part.pull->commit != v->commit;
}

/* Called after a commit. A part that is not anchored has no pull until its next anchored pull. */
static void forget_committed(part_state *v)
{
    if (has_committed(v) && v->part.pull->mode != MRT_ANCHORED)
        v->has_pull = false;
}

/* Bakes the pulls of the parts that commit into the base. Returns true if there was one; all other
 * parts must then join again. */
static bool commit(composer *self)
{
    bool is_wanted = false;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        bool now = has_committed(&self->state[self->order[i]]);
        self->counts.commits += now;
        is_wanted |= now;
    }
    if (!is_wanted)
        return false;
    settle(self, has_committed);
    face_commit(self->face);
    face_show(
        self->face); /* the shape must depend on the saved state alone, as after composer_load */
    self->engaged = false;
    for (uint32_t i = 0; i < self->order_count; ++i)
        forget_committed(&self->state[self->order[i]]);
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->state[slot].is_joined = false;
    return true;
}

static void join_parts(composer *self)
{
    holds h;
    if (!has_any_pull(self)) {
        rest(self);
        return;
    }
    bool is_new = !self->engaged || fabsf(joined_radius_mm(self) - self->engaged_radius_mm) > 0.0f;
    for (uint32_t i = 0; i < self->order_count; ++i)
        is_new |= is_regripped(&self->state[self->order[i]]);
    list_holds(self, &h);
    is_new |= !are_held(self, &h);
    if (is_new) {
        double position[MRT_MAX_VECTORS * 3];
        bool is_new_grip[MRT_MAX_VECTORS] = {false};
        uint64_t before = self->counts.engagements;
        find_grip_positions(self, &h, position, is_new_grip);
        settle(self, is_regripped);
        keep_held(self, &h);
        engage(self, &h);
        if (self->counts.engagements != before)
            hold_positions(self, position, is_new_grip);
    }
    join(self, &h);
    if (!self->engaged)
        return;
    float dof[MRT_MAX_DOFS];
    blend_dofs(self, NULL, dof);
    for (uint32_t d = 0; self->control_count == 0 && d < MRT_MAX_DOFS; ++d)
        dof[d] = isnan(dof[d]) ? 0.0f : dof[d]; /* no vector is left to derive the jaw from */
    request_shapes(self);
    aim(self, NULL, dof);
}

/* Limit of the guard: maximum distance of a control vector from the face, in sizes of the face. */
static const double reach_in_faces = 10.0;

/* ---- create and destroy ---- */

static mrt_result create_face(composer *self, const face_file *file, error *err)
{
    binding b = {0};
    mrt_result result;
    if (file->bound && file->rig)
        result = binding_copy(&b, file->bound, file->rig->contact_count, err);
    else
        result = binding_create(&b, file->rig, &file->mesh, &file->topology, err);
    if (result >= 0)
        result = face_create_shaped(&self->face, file->rig, &file->mesh, &b, MRT_MAX_VECTORS, err);
    if (result >= 0)
        face_set_shapes(self->face, file->rig ? file->rig->shapes : 0.0);
    if (result < 0 || !file->rig)
        return result;
    result = rig_copy(&self->rig, file->rig, err);
    return result < 0 ? result : rig_poses_complete(&self->rig, 0, self->face, &self->solver, err);
}

static mrt_result create_shading(composer *self, const mesh *m, error *err)
{
    const points_order *order = face_order(self->face);
    const points *rest = face_rest(self->face);
    const float *const at[3] = {rest->x, rest->y, rest->z};
    size_t corners = (size_t)m->triangle_count * 3;
    uint32_t *triangle = malloc(corners * sizeof *triangle + 1);
    uint32_t *smooth = malloc(m->vertex_count * sizeof *smooth + 1);
    if (!triangle || !smooth) {
        free(triangle);
        free(smooth);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the normals of the face");
    }
    for (size_t i = 0; i < corners; ++i)
        triangle[i] = order->slot_of_file[m->triangle[i]];
    for (uint32_t v = 0; m->smooth && v < m->vertex_count; ++v)
        smooth[order->slot_of_file[v]] = order->slot_of_file[m->smooth[v]];
    mrt_result result = shading_create(&self->shading, at, rest->count, triangle, m->triangle_count,
                                       m->smooth ? smooth : NULL, err);
    free(triangle);
    free(smooth);
    return result;
}

double composer_radius_of(const face_file *file)
{
    float low[3], high[3];
    if (file->rig && file->rig->solver.radius > 0)
        return file->rig->solver.radius;
    mesh_focus(&file->mesh, low, high);
    double size = 0;
    for (int axis = 0; axis < 3; ++axis)
        size = fmax(size, to_double(high[axis]) - to_double(low[axis]));
    double height = to_double(high[1]) - to_double(low[1]);
    return 0.25 * (height > 0 ? height : fmax(size, 1.0));
}

/* Computes the size of the face and the default radius of pulls. */
static void measure_face(composer *self, const face_file *file, const csrbf_settings *solver)
{
    float low[3], high[3];
    mesh_focus(&file->mesh, low, high);
    self->mapped.about.low = (mrt_vec3){low[0], low[1], low[2]};
    self->mapped.about.high = (mrt_vec3){high[0], high[1], high[2]};
    double size = 0;
    for (int axis = 0; axis < 3; ++axis)
        size = fmax(size, to_double(high[axis]) - to_double(low[axis]));
    self->centre = (vec3){0.5 * (to_double(low[0]) + to_double(high[0])),
                          0.5 * (to_double(low[1]) + to_double(high[1])),
                          0.5 * (to_double(low[2]) + to_double(high[2]))};
    self->reach_mm = reach_in_faces * fmax(size, 1.0);
    self->solver = *solver;
    if (!(self->solver.radius > 0) && file->rig)
        self->solver = file->rig->solver;
    self->solver.radius = self->solver.radius > 0 ? self->solver.radius : composer_radius_of(file);
}

/* Fills in the contacts and degrees of freedom that mappings may use. */
static void describe_face(composer *self)
{
    const bones *b = face_bones(self->face);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        self->dof[i] = (mrt_dof){b->dof[i].name, b->dof[i].unit, b->dof[i].min, b->dof[i].max};
    self->mapped.about.contacts = face_contacts(self->face, &self->mapped.about.contact_count);
    self->mapped.about.dofs = self->dof;
    self->mapped.about.dof_count = b->dof_count;
}

/* ---- poses for mappings ---- */

/* Names of poses that other programs use, such as "eyeBlinkLeft" and "viseme_PP". */
enum { KNOWN_POSES = ARKIT_SHAPES + FACE_VISEMES };
static void known_pose(char out[32], uint32_t i)
{
    if (i < ARKIT_SHAPES)
        (void)snprintf(out, 32, "%c%s", tolower((unsigned char)arkit_name[i][0]),
                       arkit_name[i] + 1);
    else
        (void)snprintf(out, 32, "viseme_%s", face_viseme_name[i - ARKIT_SHAPES]);
}

static bool rig_has_pose(const rig *r, const char *name)
{
    for (uint32_t i = 0; i < r->pose_count; ++i)
        if (arkit_is_same_name(r->pose[i].name, name))
            return true;
    return false;
}

static void describe_rig_pose(mrt_vec3 *pull, float *dof, const rig_pose *from,
                              const mrt_face *about)
{
    for (uint32_t k = 0; k < from->pull_count + from->follow_count; ++k) {
        const vec3 mm = from->pull_mm[k];
        pull[from->pull_contact[k]] = (mrt_vec3){(float)mm.x, (float)mm.y, (float)mm.z};
    }
    for (uint32_t k = 0; k < from->dof_count; ++k)
        for (uint32_t d = 0; d < about->dof_count; ++d)
            if (strcmp(about->dofs[d].name, from->dof_name[k]) == 0)
                dof[d] = (float)from->dof_value[k];
}

/* Adds the effect of the head's own shapes of that name on contacts and bones. Returns false if the
 * head has no such shape. */
static bool describe_shape(mrt_vec3 *pull, float *dof, const char *name, const composer *self,
                           float *offset)
{
    const mrt_face *about = &self->mapped.about;
    float part[FACE_SHAPES_MAX];
    if (!face_shape_parts(self->face, name, part))
        return false;
    for (uint32_t s = 0; s < face_shape_count(self->face); ++s) {
        if (!(part[s] > 0.0f))
            continue;
        const float *of_bones = face_shape_dofs(self->face, s);
        face_shape_offset(self->face, s, offset);
        for (uint32_t c = 0; c < about->contact_count; ++c) {
            const float *mm = offset + (size_t)3 * self->rig.contact[c].vertex;
            pull[c].x += part[s] * mm[0];
            pull[c].y += part[s] * mm[1];
            pull[c].z += part[s] * mm[2];
        }
        for (uint32_t d = 0; d < about->dof_count; ++d)
            dof[d] += part[s] * of_bones[d];
    }
    return true;
}

/* Lists the poses of the rig, with a value for every contact and degree of freedom. Adds the poses
 * with known names that only the head's own shapes have. */
static mrt_result describe_poses(composer *self, uint32_t vertex_count, error *err)
{
    const mrt_face *about = &self->mapped.about;
    const size_t room = self->rig.pose_count + (size_t)KNOWN_POSES;
    mrt_rig_pose *pose = arrays_add(&self->poses, room, sizeof *pose);
    mrt_vec3 *pulls = arrays_add(&self->poses, room * about->contact_count, sizeof *pulls);
    float *dofs = arrays_add(&self->poses, room * about->dof_count, sizeof *dofs);
    char(*names)[32] = arrays_add(&self->poses, KNOWN_POSES, sizeof *names);
    float *offset = calloc((size_t)3 * vertex_count + 1, sizeof *offset);
    size_t count = 0;
    if (self->poses.failed || !offset) {
        free(offset);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the poses of the rig");
    }
    for (; count < self->rig.pose_count; ++count) {
        const rig_pose *from = &self->rig.pose[count];
        mrt_vec3 *pull = pulls + count * about->contact_count;
        float *dof = dofs + count * about->dof_count;
        pose[count] = (mrt_rig_pose){from->name, pull, dof, (uint32_t)from->part};
        describe_rig_pose(pull, dof, from, about);
    }
    for (uint32_t i = 0; i < KNOWN_POSES && self->rig.contact_count > 0; ++i) {
        mrt_vec3 *pull = pulls + count * about->contact_count;
        float *dof = dofs + count * about->dof_count;
        known_pose(names[i], i);
        if (rig_has_pose(&self->rig, names[i]) ||
            !describe_shape(pull, dof, names[i], self, offset))
            continue;
        const uint32_t part =
            i < ARKIT_SHAPES ? (uint32_t)rig_poses_dof_part(names[i]) : MRT_POSE_MOUTH;
        pose[count++] = (mrt_rig_pose){names[i], pull, dof, part};
    }
    free(offset);
    self->mapped.pose = pose;
    self->mapped.pose_count = (uint32_t)count;
    return MRT_OK;
}

mrt_result composer_create(composer **out, const face_file *file, const csrbf_settings *solver,
                           error *err)
{
    *out = NULL;
    composer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the face");
    self->counts.min_determinant = 1.0;
    measure_face(self, file, solver);
    mrt_result result = create_face(self, file, err);
    if (result >= 0)
        result = create_shading(self, &file->mesh, err);
    if (result >= 0) {
        describe_face(self);
        result = describe_poses(self, file->mesh.vertex_count, err);
    }
    if (result < 0) {
        composer_destroy(self);
        return result;
    }
    composer_draw(self);
    *out = self;
    return MRT_OK;
}

void composer_destroy(composer *self)
{
    if (!self)
        return;
    face_destroy(self->face);
    arrays_free(&self->poses);
    rig_destroy(&self->rig);
    shading_destroy(self->shading);
    free(self);
}

void composer_reset(composer *self)
{
    face_reset(self->face);
    memset(self->state, 0, sizeof self->state);
    self->order_count = self->joined_count = self->control_count = 0;
    self->engaged = self->stale = false;
}

/* ---- unanchored ---- */

static void copy_ends(double *out, const mrt_pull *pull)
{
    for (uint32_t i = 0; i < pull->count; ++i) {
        mrt_vec3 p = pull->vector[i].end;
        out[3 * i] = to_double(p.x);
        out[3 * i + 1] = to_double(p.y);
        out[3 * i + 2] = to_double(p.z);
    }
}

/* Computes where the drag of this step begins. If the last drag is still behind its ends, it
 * continues from the tips. Otherwise it begins at the starts of the pull. */
static void drag_from(const part_state *v, double *out_from)
{
    const mrt_pull *pull = v->part.pull;
    for (uint32_t i = 0; i < pull->count; ++i) {
        mrt_vec3 p = pull->vector[i].start;
        out_from[3 * i] = to_double(p.x);
        out_from[3 * i + 1] = to_double(p.y);
        out_from[3 * i + 2] = to_double(p.z);
    }
    if (v->is_dragging && v->tip_count == pull->count)
        memcpy(out_from, v->tip, (size_t)pull->count * 3 * sizeof *out_from);
}

/* Scales the step by the part's weight and gain. */
static void shorten(const part_state *v, const double *from, double *to)
{
    double share = v->part.weight * v->part.gain;
    for (size_t i = 0; fabs(share - 1.0) > 0.0 && i < (size_t)v->part.pull->count * 3; ++i)
        to[i] = from[i] + share * (to[i] - from[i]);
}

/* Limits tips that are behind the hand to twice the speed of the hand. Otherwise the shape would
 * jump when the obstacle that held them back disappears. */
static void limit_catch_up(const part_state *v, const double *from, double *to)
{
    const mrt_pull *pull = v->part.pull;
    for (uint32_t i = 0; v->is_dragging && i < pull->count; ++i) {
        vec3 start = vec3_of(pull->vector[i].start), end = vec3_of(pull->vector[i].end);
        const double *at = from + (size_t)3 * i;
        double *goal = to + (size_t)3 * i;
        vec3 way = {goal[0] - at[0], goal[1] - at[1], goal[2] - at[2]};
        double most = 2.0 * vec3_length(vec3_sub(end, start)), length = vec3_length(way);
        double part = length > most ? most / length : 1.0;
        for (int axis = 0; axis < 3 && part < 1.0; ++axis)
            goal[axis] = at[axis] + part * (goal[axis] - at[axis]);
    }
}

/* Returns whether a tip has not reached the hand. */
static bool is_behind(const part_state *v, const double *to)
{
    return memcmp(v->tip, to, (size_t)v->tip_count * 3 * sizeof *to) != 0;
}

static bool drives_bones(const composer *self, const mrt_pull *pull)
{
    for (uint32_t i = 0; i < self->mapped.about.dof_count; ++i)
        if (!isnan(pull->dof[i]))
            return true;
    return false;
}

static void drag_along_way(composer *self, part_state *v, const csrbf_settings *settings,
                           double *to)
{
    const mrt_pull *pull = v->part.pull;
    error err = {""};
    shape_step step = {.min_determinant = 1.0};
    double from[MRT_MAX_VECTORS * 3], next[MRT_MAX_VECTORS * 3];
    float dof[MRT_MAX_DOFS];
    drag_from(v, from);
    shorten(v, from, to);
    memcpy(next, to, (size_t)pull->count * 3 * sizeof *next);
    limit_catch_up(v, from, next);
    blend_dofs(self, NULL, dof);
    self->counts.solves += 1;
    mrt_result result =
        face_drag(self->face, settings, from, next, pull->count, dof, v->tip, &step, &err);
    v->tip_count = pull->count;
    v->is_dragging = result >= 0 && is_behind(v, to);
    self->counts.held_pulls += result < 0;
    if (result < 0)
        note_problem(self, err.text);
    self->counts.limited_steps += step.limited;
    self->counts.folded_steps += step.substeps > 0 && !(step.min_determinant > 0.0);
    self->counts.substeps += step.substeps;
    self->counts.min_determinant = fmin(self->counts.min_determinant, step.min_determinant);
}

/* A drag changes the shape itself, so this removes the pulls of the anchored parts until the drag
 * is done. */
static void remove_anchored(composer *self)
{
    show(self);
    if (has_joined_part(self) && self->is_mixed)
        show_only(self, accepts_none);
    self->engaged = false;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->state[slot].is_joined = false;
}

static void drag_unanchored(composer *self, part_state *v, double dt_s)
{
    const mrt_pull *pull = v->part.pull;
    remove_anchored(self);
    csrbf_settings settings = composer_solver_of(self, pull);
    double to[MRT_MAX_VECTORS * 3];
    copy_ends(to, pull);
    bool near = !pull->gate || face_is_near(self->face, to, pull->count, settings.radius);
    /* The first sample near the shape only sets the start of the tips. */
    bool may_move = near && v->was_near && pull->count > 0;
    if (pull->count == 0)
        may_move = drives_bones(self, pull);
    v->was_near = near;
    if (may_move)
        drag_along_way(self, v, &settings, to);
    else
        v->is_dragging = false;
    if (pull->leak_per_s > 0.0f)
        face_leak(self->face, to_double(pull->leak_per_s), dt_s);
}

/* Moves the base by the share `part` towards the rest shape. The pulls of the other parts are
 * unchanged. */
static void restore(composer *self, double part)
{
    show(self);
    if (has_joined_part(self))
        show_only(self, accepts_none);
    self->engaged = false;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->state[slot].is_joined = false;
    face_restore(self->face, part);
}

/* ---- the step ---- */

static void set_parts(composer *self, const composer_part *part, uint32_t count)
{
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->state[slot].is_present = false;
    self->order_count = 0;
    for (uint32_t i = 0; i < count && self->order_count < COMPOSER_PARTS_MAX; ++i) {
        if (part[i].slot >= COMPOSER_PARTS_MAX)
            continue;
        part_state *v = &self->state[part[i].slot];
        v->is_present = true;
        v->part = part[i];
        self->order[self->order_count++] = part[i].slot;
    }
}

/* Reads the current pulls of the parts. Returns true if any of them changed. */
static bool update_pulls(composer *self)
{
    bool is_new = false;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot) {
        part_state *v = &self->state[slot];
        is_new |= v->is_present != v->was_present;
        if (!v->is_present) {
            if (!v->is_joined)
                v->has_pull = false;
            continue;
        }
        const mrt_pull *pull = v->part.pull;
        is_new |= pull->mode == MRT_ANCHORED || fabs(v->weight - v->part.weight) > 0.0;
        if (pull->mode == MRT_ANCHORED)
            v->last_pull = *pull;
        v->has_pull = pull->mode == MRT_ANCHORED || (pull->mode == MRT_IDLE && v->has_pull);
        if (pull->mode != MRT_UNANCHORED)
            v->was_near = false;
        if (pull->mode == MRT_ANCHORED)
            v->is_dragging = false;
    }
    return is_new;
}

static void add_pulled(mrt_pull *out, const part_state *v)
{
    const mrt_pull *pull = v->part.pull;
    float share = (float)(v->part.weight * v->part.gain);
    for (uint32_t i = 0; i < pull->count && out->count < MRT_MAX_VECTORS; ++i) {
        mrt_vector *to = &out->vector[out->count++];
        *to = pull->vector[i];
        to->end.x = to->start.x + share * (to->end.x - to->start.x);
        to->end.y = to->start.y + share * (to->end.y - to->start.y);
        to->end.z = to->start.z + share * (to->end.z - to->start.z);
    }
}

static void note_pulled(composer *self)
{
    const part_state *first = &self->state[self->order[0]];
    bool is_one = self->order_count == 1 && !(fabs(first->part.weight - 1.0) > 0.0) &&
                  !(fabs(first->part.gain - 1.0) > 0.0);
    if (is_one) {
        self->pulled = *first->part.pull;
        return;
    }
    self->pulled.count = 0;
    self->pulled.mode = self->engaged ? MRT_ANCHORED : MRT_UNANCHORED;
    for (uint32_t i = 0; i < self->order_count; ++i)
        add_pulled(&self->pulled, &self->state[self->order[i]]);
    blend_dofs(self, NULL, self->pulled.dof);
}

static void end_step(composer *self)
{
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot) {
        part_state *v = &self->state[slot];
        v->was_present = v->is_present;
        if (v->is_present) {
            v->commit = v->part.pull->commit;
            v->weight = v->part.weight;
        } else {
            v->has_pull = v->was_near = v->is_dragging = false;
        }
        v->part.pull = NULL;
        v->part.owns = NULL;
        v->part.shapes = NULL;
    }
}

static bool is_kneading(const part_state *v)
{
    return v->part.pull->mode == MRT_UNANCHORED && v->part.is_fresh;
}

void composer_move(composer *self, const composer_part *part, uint32_t count, double dt_s)
{
    set_parts(self, part, count);
    bool is_new = commit(self);
    is_new |= update_pulls(self);
    bool is_kneaded = false, is_held = false;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const part_state *v = &self->state[self->order[i]];
        is_kneaded |= is_kneading(v);
        is_held |= v->has_pull;
    }
    self->is_mixed = is_kneaded && is_held;
    for (uint32_t i = 0; i < self->order_count; ++i)
        if (is_kneading(&self->state[self->order[i]]))
            drag_unanchored(self, &self->state[self->order[i]], dt_s);
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const part_state *v = &self->state[self->order[i]];
        if (!(v->part.restore > 0.0))
            continue;
        restore(self, v->part.restore);
        is_kneaded = true;
    }
    if (is_held ? is_new || is_kneaded : is_new && !is_kneaded)
        join_parts(self);
    note_pulled(self);
    blend_dofs(self, is_not_life, self->watched);
    end_step(self);
}

void composer_swing_begin(composer *self, int64_t time_ns)
{
    face_swing_begin(self->face, time_ns);
}

void composer_swing(composer *self, int64_t time_ns)
{
    self->stale |= face_swing(self->face, time_ns);
}

void composer_shift_time(composer *self, int64_t by_ns)
{
    face_shift_time(self->face, by_ns);
}

bool composer_is_near(const composer *self, const mrt_pull *pull)
{
    double end[MRT_MAX_VECTORS * 3];
    if (!pull->gate || pull->count == 0)
        return false;
    copy_ends(end, pull);
    return face_is_near(self->face, end, pull->count, composer_solver_of(self, pull).radius);
}

void composer_draw(composer *self)
{
    show(self);
    const shading_shape now = face_shading(self->face);
    shading_update(self->shading, &now);
}

/* ---- getters ---- */

const mapped_face *composer_mapped(const composer *self)
{
    return &self->mapped;
}

const mrt_face *composer_about(const composer *self)
{
    return &self->mapped.about;
}

const rig *composer_rig(const composer *self)
{
    return face_bones(self->face)->rig ? &self->rig : NULL;
}

double composer_reach_mm(const composer *self, vec3 *out_centre)
{
    *out_centre = self->centre;
    return self->reach_mm;
}

face *composer_face(composer *self)
{
    return self->face;
}

const mrt_pull *composer_pull(const composer *self)
{
    return &self->pulled;
}

const float *composer_watched(const composer *self)
{
    return self->watched;
}

uint32_t composer_targets(const composer *self, composer_target out[MRT_MAX_VECTORS])
{
    double way[MRT_MAX_VECTORS * 3];
    float dof[MRT_MAX_DOFS] = {0};
    uint32_t count = self->engaged ? self->control_count : 0;
    memcpy(way, self->aimed, (size_t)count * 3 * sizeof *way);
    bones_unlimit(dof, face_bones(self->face), face_metered(self->face)->driven);
    face_unride(self->face, way, dof);
    for (uint32_t k = 0; k < count; ++k) {
        const double *end = self->aimed + 3 * k;
        out[k] = (composer_target){.contact = self->control[k].contact,
                                   .start = self->control[k].start,
                                   .end = {end[0], end[1], end[2]},
                                   .way = {way[3 * k], way[3 * k + 1], way[3 * k + 2]}};
    }
    return count;
}

csrbf_settings composer_solver(const composer *self)
{
    return self->solver;
}

csrbf_settings composer_solver_of(const composer *self, const mrt_pull *pull)
{
    return settings_of(self, pull->radius_mm, pull);
}

const shading *composer_shading(const composer *self)
{
    return self->shading;
}

bool composer_is_anchored(const composer *self)
{
    return self->engaged;
}

composer_counts *composer_get_counts(composer *self)
{
    return &self->counts;
}

/* The state of a composer as bytes: the pulls that hold the face. The list of current parts is not
 * stored, because every step sets it. */

enum { STORE_VERSION = 3, STORE_WITH_POINTERS = 4 };
enum { IS_ADDITIVE = 1, IS_POINTER = 2 };

static void write_pull(bytes_out *out, const mrt_pull *pull)
{
    bytes_write(out, pull, offsetof(mrt_pull, vector));
    bytes_write(out, pull->vector, pull->count * sizeof *pull->vector);
    bytes_write(out, pull->dof, sizeof pull->dof);
}

static bool is_point(mrt_vec3 p)
{
    return isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
}

static void read_pull(bytes_in *in, const composer *self, mrt_pull *out)
{
    *out = (mrt_pull){0};
    bytes_read(in, out, offsetof(mrt_pull, vector));
    if (out->count > MRT_MAX_VECTORS || out->mode > MRT_UNANCHORED || !isfinite(out->radius_mm) ||
        !isfinite(out->stretch_most)) {
        in->failed = true;
        out->count = 0;
    }
    bytes_read(in, out->vector, out->count * sizeof *out->vector);
    bytes_read(in, out->dof, sizeof out->dof);
    for (uint32_t i = 0; i < out->count; ++i)
        in->failed |= !is_point(out->vector[i].start) || !is_point(out->vector[i].end) ||
                      out->vector[i].contact > self->mapped.about.contact_count;
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        in->failed |= isinf(out->dof[i]);
}

static void write_state(bytes_out *out, const part_state *v)
{
    bytes_write_u32(out, v->part.layer);
    bytes_write_u32(out, (v->part.is_additive ? IS_ADDITIVE : 0) |
                             (v->part.is_pointer ? IS_POINTER : 0));
    bytes_write_u32(out, v->commit);
    bytes_write_u32(out, v->has_pull);
    if (v->has_pull)
        write_pull(out, &v->last_pull);
    bytes_write_u32(out, v->is_joined);
    bytes_write_f64(out, v->weight);
    if (v->is_joined) {
        write_pull(out, &v->joined);
        bytes_write_f64(out, v->share);
        bytes_write(out, v->control, v->joined.count * sizeof *v->control);
    }
    bytes_write_u32(out, v->was_near);
    bytes_write_u32(out, v->is_dragging);
    bytes_write_u32(out, v->is_dragging ? v->tip_count : 0);
    if (v->is_dragging)
        bytes_write(out, v->tip, (size_t)v->tip_count * 3 * sizeof *v->tip);
}

static void read_state(bytes_in *in, const composer *self, part_state *out)
{
    out->was_present = true;
    out->part.layer = bytes_read_u32(in);
    uint32_t flags = bytes_read_u32(in);
    out->part.is_additive = (flags & IS_ADDITIVE) != 0;
    out->part.is_pointer = (flags & IS_POINTER) != 0;
    out->commit = bytes_read_u32(in);
    out->has_pull = bytes_read_u32(in) != 0;
    if (out->has_pull)
        read_pull(in, self, &out->last_pull);
    out->is_joined = bytes_read_u32(in) != 0;
    out->weight = bytes_read_f64(in);
    if (out->is_joined) {
        read_pull(in, self, &out->joined);
        out->share = bytes_read_f64(in);
        bytes_read(in, out->control, out->joined.count * sizeof *out->control);
        for (uint32_t i = 0; i < out->joined.count; ++i)
            in->failed |=
                out->control[i] != COMPOSER_NO_CONTROL && out->control[i] >= self->control_count;
    }
    out->was_near = bytes_read_u32(in) != 0;
    out->is_dragging = bytes_read_u32(in) != 0;
    out->tip_count = bytes_read_u32(in);
    if (out->tip_count > MRT_MAX_VECTORS)
        in->failed = true;
    else
        for (uint32_t i = 0; i < 3 * out->tip_count; ++i)
            out->tip[i] = bytes_read_f64(in);
}

/* Returns whether the state has pointers. Without pointers it is written as STORE_VERSION, which
 * older versions can read. */
static bool has_pointers(const composer *self)
{
    bool any = false;
    for (uint32_t k = 0; k < self->control_count; ++k)
        any |= self->control[k].is_pointer ||
               vec3_dot(self->control[k].held, self->control[k].held) > 0.0;
    return any;
}

static void write_pointers(bytes_out *out, const composer *self)
{
    for (uint32_t k = 0; k < self->control_count; ++k) {
        bytes_write_u32(out, self->control[k].is_pointer);
        bytes_write_vec3(out, self->control[k].rest);
        bytes_write_vec3(out, self->control[k].held);
    }
}

static void read_pointers(bytes_in *in, composer *self)
{
    for (uint32_t k = 0; k < self->control_count; ++k) {
        self->control[k].is_pointer = bytes_read_u32(in) != 0;
        self->control[k].rest = bytes_read_vec3(in);
        self->control[k].held = bytes_read_vec3(in);
    }
}

static void write_controls(bytes_out *out, const composer *self)
{
    bytes_write_u32(out, self->engaged);
    bytes_write_f64(out, (double)self->engaged_radius_mm);
    bytes_write_u32(out, self->control_count);
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const joined_control *c = &self->control[k];
        bytes_write_u32(out, c->contact);
        bytes_write_u32(out, c->slot);
        bytes_write_u32(out, c->vector);
        bytes_write_vec3(out, c->start);
    }
    bytes_write_u32(out, self->joined_count);
    bytes_write(out, self->joined_order, self->joined_count * sizeof *self->joined_order);
}

static void read_controls(bytes_in *in, composer *self)
{
    self->engaged = bytes_read_u32(in) != 0;
    double radius_mm = bytes_read_f64(in);
    in->failed |= fabs(radius_mm) > (double)FLT_MAX;
    self->engaged_radius_mm = in->failed ? 0.0f : (float)radius_mm;
    self->control_count = bytes_read_u32(in);
    if (self->control_count > MRT_MAX_VECTORS) {
        in->failed = true;
        self->control_count = 0;
    }
    for (uint32_t k = 0; k < self->control_count; ++k) {
        joined_control *c = &self->control[k];
        memset(self->aimed + 3 * k, 0,
               3 * sizeof *self->aimed); /* computed again by the next step */
        c->contact = bytes_read_u32(in);
        c->slot = bytes_read_u32(in);
        c->vector = bytes_read_u32(in);
        c->start = bytes_read_vec3(in);
        in->failed |= c->contact > self->mapped.about.contact_count ||
                      c->slot >= COMPOSER_PARTS_MAX || c->vector >= MRT_MAX_VECTORS;
    }
    self->joined_count = bytes_read_u32(in);
    if (self->joined_count > COMPOSER_PARTS_MAX) {
        in->failed = true;
        self->joined_count = 0;
    }
    bytes_read(in, self->joined_order, self->joined_count * sizeof *self->joined_order);
    for (uint32_t i = 0; i < self->joined_count; ++i)
        in->failed |= self->joined_order[i] >= COMPOSER_PARTS_MAX;
}

size_t composer_save(composer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    uint32_t state_count = 0;
    bytes_write_u32(&out, has_pointers(self) ? STORE_WITH_POINTERS : STORE_VERSION);
    write_controls(&out, self);
    if (has_pointers(self))
        write_pointers(&out, self);
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        state_count += self->state[slot].was_present || self->state[slot].is_joined;
    bytes_write_u32(&out, state_count);
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot) {
        const part_state *v = &self->state[slot];
        if (!v->was_present && !v->is_joined)
            continue;
        bytes_write_u32(&out, slot);
        bytes_write_u32(&out, v->was_present);
        write_state(&out, v);
    }
    size_t face_size = face_save(self->face, NULL, 0);
    bytes_write_u32(&out, (uint32_t)face_size);
    if (out.data && out.size <= out.capacity && face_size <= out.capacity - out.size)
        face_save(self->face, out.data + out.size, face_size);
    return out.size + face_size;
}

static mrt_result load(composer *self, bytes_in *in, error *err)
{
    uint32_t version = bytes_read_u32(in);
    in->failed |= version != STORE_VERSION && version != STORE_WITH_POINTERS;
    read_controls(in, self);
    if (version == STORE_WITH_POINTERS)
        read_pointers(in, self);
    uint32_t state_count = bytes_read_u32(in);
    for (uint32_t i = 0; i < state_count && !in->failed; ++i) {
        uint32_t slot = bytes_read_u32(in);
        bool was_present = bytes_read_u32(in) != 0;
        if (slot >= COMPOSER_PARTS_MAX) {
            in->failed = true;
            break;
        }
        read_state(in, self, &self->state[slot]);
        self->state[slot].was_present = was_present;
    }
    size_t size = bytes_read_u32(in);
    if (in->failed || size != (size_t)(in->end - in->at))
        return error_set(err, MRT_ERR_FORMAT, "the stored state of the face is damaged");
    mrt_result result = face_load(self->face, in->at, size, err);
    if (result >= 0 && self->engaged && face_control_count(self->face) != self->control_count)
        result = error_set(err, MRT_ERR_FORMAT, "the stored state of the face is damaged");
    return result;
}

mrt_result composer_load(composer *self, const void *bytes, size_t size, error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    composer_reset(self);
    mrt_result result = load(self, &in, err);
    if (result < 0)
        composer_reset(self);
    return result;
}
