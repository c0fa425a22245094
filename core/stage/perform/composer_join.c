/* The anchored pulls of all voices in one solve. */
#include "stage/perform/composer_state.h"

#include <math.h>
#include <string.h>

static bool owns(const composer *self, const voice *v, uint32_t contact)
{
    if (!v->part.owns)
        return true;
    uint32_t free_points = self->about.contact_count + self->about.dof_count;
    return v->part.owns[contact > 0 ? contact - 1 : free_points] != 0;
}

/* ---- who holds where ---- */

static uint32_t find_contact(const joined_control *control, uint32_t count, uint32_t contact)
{
    for (uint32_t k = 0; k < count; ++k)
        if (control[k].contact == contact)
            return k;
    return COMPOSER_NO_CONTROL;
}

/* Two parts of one layer that hold the same free point, as while one takes over from the other,
 * hold it together. */
static uint32_t find_free_point(const composer *self, const joined_control *control, uint32_t count,
                                const voice *v, const mrt_vector *vector)
{
    for (uint32_t k = 0; k < count; ++k) {
        const voice *other = &self->voice[control[k].slot];
        if (control[k].contact == 0 && other->part.layer == v->part.layer &&
            memcmp(&other->said.vector[control[k].vector].start, &vector->start,
                   sizeof vector->start) == 0)
            return k;
    }
    return COMPOSER_NO_CONTROL;
}

/* Who holds which control. */
typedef struct holds {
    joined_control control[MRT_MAX_VECTORS];
    uint32_t count;
    uint32_t of[COMPOSER_PARTS_MAX][MRT_MAX_VECTORS]; /* the control of each vector, by slot */
} holds;

/* The controls of all voices, in their order. */
static void list_holds(composer *self, holds *out)
{
    out->count = 0;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        uint32_t slot = self->order[i];
        const voice *v = &self->voice[slot];
        uint32_t others = out->count; /* a voice may hold one contact twice */
        for (uint32_t j = 0; v->has_said && j < v->said.count; ++j) {
            uint32_t contact = v->said.vector[j].contact;
            uint32_t at = COMPOSER_NO_CONTROL;
            out->of[slot][j] = COMPOSER_NO_CONTROL;
            if (!owns(self, v, contact))
                continue;
            if (contact > 0)
                at = find_contact(out->control, others, contact);
            else
                at = find_free_point(self, out->control, others, v, &v->said.vector[j]);
            if (at == COMPOSER_NO_CONTROL && out->count == MRT_MAX_VECTORS) {
                self->counts.left_out += 1;
                continue;
            }
            if (at == COMPOSER_NO_CONTROL) {
                at = out->count++;
                out->control[at] = (joined_control){.contact = contact,
                                                    .slot = slot,
                                                    .vector = j,
                                                    .rest = composer_vec3(v->said.vector[j].start),
                                                    .is_finger = v->part.is_finger};
            }
            out->control[at].is_finger &= v->part.is_finger;
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

/* The radius of one solve for all: of the lowest voice that names one; a finger names it when it is
 * alone. */
static float joined_radius_mm(const composer *self)
{
    float of_finger = 0.0f;
    bool is_alone = true;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const voice *v = &self->voice[self->order[i]];
        if (!v->has_said)
            continue;
        is_alone &= v->part.is_finger || v->said.count == 0;
        if (v->said.radius_mm > 0.0f && !v->part.is_finger)
            return v->said.radius_mm;
        of_finger = v->said.radius_mm > 0.0f ? v->said.radius_mm : of_finger;
    }
    return is_alone ? of_finger : 0.0f;
}

/* Of the lowest voice that is no finger; NULL: there is none. */
static const mrt_pull *joined_manner(const composer *self)
{
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const voice *v = &self->voice[self->order[i]];
        if (v->has_said && !v->part.is_finger)
            return &v->said;
    }
    return NULL;
}

/* It takes hold anew: what it has added so far stays in the shape. */
static bool is_anew(const voice *v)
{
    return v->is_joined && v->is_present && !v->part.is_finger &&
           (v->joined.anchor != v->said.anchor || v->joined.count != v->said.count ||
            v->joined.solve != v->said.solve ||
            fabsf(v->joined.stretch_most - v->said.stretch_most) > 0.0f ||
            fabsf(v->joined.radius_mm - v->said.radius_mm) > 0.0f);
}

/* ---- the engagement ---- */

static void aim(composer *self, bool (*counts)(const voice *v), const float *dof)
{
    error err = {""};
    double end[MRT_MAX_VECTORS * 3];
    uint8_t rides[MRT_MAX_VECTORS];
    composer_blend_ends(self, counts, end, rides);
    face_ride(self->face, end, rides, dof);
    self->counts.solves += 1;
    if (face_aim(self->face, end, dof, &err) < 0) {
        self->counts.held_pulls += 1;
        composer_note_problem(self, err.text);
        return;
    }
    self->stale = true;
}

/* Everybody pulls what has been added, or as `keep` says; the bones stay where they are. */
void composer_let_go_but(composer *self, bool (*keep)(const voice *v))
{
    if (!self->engaged)
        return;
    aim(self, keep, face_metered(self->face)->dof);
    composer_show(self);
}

static bool nobody(const voice *v)
{
    (void)v;
    return false;
}

/* Where a place of the rest face is in the shape shown: beside the vertex that is nearest at rest.
 */
static vec3 place_now(const composer *self, vec3 at_rest)
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

/* A contact is taken where it is now, wherever the mapping says that it rests; so is a place that a
 * finger holds. */
static vec3 start_of(const composer *self, const joined_control *c)
{
    if (c->contact > 0)
        return face_contact_now(self->face, c->contact);
    if (self->voice[c->slot].part.is_finger)
        return place_now(self, c->rest);
    return composer_vec3(self->voice[c->slot].said.vector[c->vector].start);
}

/* ---- fingers take hold of the face as it is ---- */

static const joined_control *held_before(const composer *self, const joined_control *c)
{
    if (!self->voice[c->slot].was_present)
        return NULL;
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const joined_control *old = &self->control[k];
        bool is_same = old->contact == c->contact &&
                       (c->contact > 0 || memcmp(&old->rest, &c->rest, sizeof c->rest) == 0);
        if (is_same && old->is_finger == c->is_finger)
            return old;
    }
    return NULL;
}

/* Before the others let go: where the places are, mm, that fingers take hold of now. */
static void find_places(composer *self, const holds *h, double *out_place, bool *out_comes)
{
    composer_show(self);
    for (uint32_t k = 0; k < h->count; ++k) {
        const joined_control *c = &h->control[k];
        out_comes[k] = c->is_finger && !held_before(self, c);
        if (!out_comes[k])
            continue;
        vec3 place = start_of(self, c);
        out_place[3 * k] = place.x;
        out_place[3 * k + 1] = place.y;
        out_place[3 * k + 2] = place.z;
    }
}

static void keep_held(const composer *self, holds *h)
{
    for (uint32_t k = 0; k < h->count; ++k) {
        joined_control *c = &h->control[k];
        const joined_control *old = c->is_finger ? held_before(self, c) : NULL;
        if (old)
            c->held = old->held;
    }
}

/* Engaged anew: how far from the base the others had those places. */
static void hold_places(composer *self, const double *place, const bool *comes)
{
    double way[MRT_MAX_VECTORS * 3] = {0};
    bool any = false;
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const vec3 *start = &self->control[k].start;
        const double still[3] = {start->x, start->y, start->z};
        memcpy(way + 3 * k, comes[k] ? place + 3 * k : still, sizeof still);
        any |= comes[k];
    }
    if (any)
        face_unride(self->face, way, face_metered(self->face)->dof);
    for (uint32_t k = 0; k < self->control_count; ++k) {
        joined_control *c = &self->control[k];
        if (!comes[k])
            continue;
        c->held = (vec3){way[3 * k], way[3 * k + 1], way[3 * k + 2]};
        if (c->contact == 0)
            c->held = vec3_sub((vec3){place[3 * k], place[3 * k + 1], place[3 * k + 2]}, c->start);
    }
}

/* What they were held at is in the base now. */
static void forget_held(composer *self)
{
    for (uint32_t k = 0; k < self->control_count; ++k)
        self->control[k].held = (vec3){0, 0, 0};
}

/* ---- the engagement's controls ---- */

static void engage(composer *self, holds *h)
{
    error err = {""};
    face_control grip[MRT_MAX_VECTORS];
    float radius_mm = joined_radius_mm(self);
    csrbf_settings settings = composer_settings(self, radius_mm, joined_manner(self));
    for (uint32_t k = 0; k < h->count; ++k) {
        h->control[k].start = start_of(self, &h->control[k]);
        grip[k] = (face_control){h->control[k].start, h->control[k].contact};
    }
    if (face_engage(self->face, &settings, grip, h->count, &err) < 0) {
        self->counts.held_pulls += 1;
        composer_note_problem(self, err.text);
        self->engaged = false;
        return;
    }
    memcpy(self->control, h->control, h->count * sizeof *h->control);
    self->control_count = h->count;
    self->engaged_radius_mm = radius_mm;
    self->engaged = true;
    self->counts.engagements += 1;
}

bool composer_is_anybody_joined(const composer *self)
{
    for (uint32_t i = 0; i < self->joined_count; ++i)
        if (self->voice[self->joined_order[i]].is_joined)
            return true;
    return false;
}

/* Of what the voices pull only what some of them leave stays in the shape. */
static void settle(composer *self, bool (*stays)(const voice *v))
{
    bool all_stay = true;
    for (uint32_t i = 0; i < self->joined_count; ++i) {
        const voice *v = &self->voice[self->joined_order[i]];
        all_stay &= !v->is_joined || stays(v);
    }
    composer_show(self); /* the base is the shape of this step, not of the last drawn frame */
    if (!all_stay)
        composer_let_go_but(self, stays);
    if (composer_counts_anybody(self, stays))
        forget_held(self);
}

/* The voices hold the face with what they say now. */
static void join(composer *self, const holds *h)
{
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->voice[slot].is_joined = false;
    self->joined_count = 0;
    for (uint32_t i = 0; i < self->order_count && self->engaged; ++i) {
        uint32_t slot = self->order[i];
        voice *v = &self->voice[slot];
        if (!v->has_said)
            continue;
        v->is_joined = true;
        v->joined = v->said;
        v->share = composer_share(v);
        v->weight = v->part.weight;
        memcpy(v->control, h->of[slot], sizeof v->control);
        self->joined_order[self->joined_count++] = slot;
    }
}

static bool is_anybody_speaking(const composer *self)
{
    for (uint32_t i = 0; i < self->order_count; ++i)
        if (self->voice[self->order[i]].has_said)
            return true;
    return false;
}

/* Whoever was there has gone: the face goes back to its base. */
static void rest(composer *self)
{
    static const float still[MRT_MAX_DOFS] = {0};
    if (!self->engaged || self->joined_count == 0)
        return;
    aim(self, nobody, still);
    forget_held(self);
    self->joined_count = 0;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->voice[slot].is_joined = false;
}

static bool has_committed(const voice *v)
{
    return v->is_present && v->was_present && v->part.pull->commit != v->commit;
}

/* What it pulled is in the base now; it begins anew with its next anchored pull. */
static void forget_said(voice *v)
{
    if (has_committed(v) && v->part.pull->mode != MRT_ANCHORED)
        v->has_said = false;
}

bool composer_commit(composer *self)
{
    bool is_wanted = false;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        bool now = has_committed(&self->voice[self->order[i]]);
        self->counts.commits += now;
        is_wanted |= now;
    }
    if (!is_wanted)
        return false;
    settle(self, has_committed);
    face_commit(self->face);
    face_show(self->face); /* of what is kept alone, as after composer_load */
    self->engaged = false;
    for (uint32_t i = 0; i < self->order_count; ++i)
        forget_said(&self->voice[self->order[i]]);
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->voice[slot].is_joined = false;
    return true;
}

void composer_join(composer *self)
{
    holds h;
    if (!is_anybody_speaking(self)) {
        rest(self);
        return;
    }
    bool is_new = !self->engaged || fabsf(joined_radius_mm(self) - self->engaged_radius_mm) > 0.0f;
    for (uint32_t i = 0; i < self->order_count; ++i)
        is_new |= is_anew(&self->voice[self->order[i]]);
    list_holds(self, &h);
    is_new |= !are_held(self, &h);
    if (is_new) {
        double place[MRT_MAX_VECTORS * 3];
        bool comes[MRT_MAX_VECTORS] = {false};
        uint64_t before = self->counts.engagements;
        find_places(self, &h, place, comes);
        settle(self, is_anew);
        keep_held(self, &h);
        engage(self, &h);
        if (self->counts.engagements != before)
            hold_places(self, place, comes);
    }
    join(self, &h);
    if (!self->engaged)
        return;
    float dof[MRT_MAX_DOFS];
    composer_blend_dofs(self, dof);
    aim(self, NULL, dof);
}
