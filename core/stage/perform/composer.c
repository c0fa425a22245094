#include "stage/perform/composer_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The guard: no control vector leads further from the face than this many times its size. */
static const double reach_in_faces = 10.0;

static double to_double(float v)
{
    return (double)v;
}

/* ---- made and unmade ---- */

static mrt_result create_face(composer *self, const face_file *file, error *err)
{
    binding copy;
    if (!file->bound || !file->rig)
        return face_create(&self->face, file->rig, &file->mesh, &file->topology, MRT_MAX_VECTORS,
                           err);
    mrt_result result = binding_copy(&copy, file->bound, file->rig->contact_count, err);
    return result < 0 ? result
                      : face_create_bound(&self->face, file->rig, &file->mesh, &copy,
                                          MRT_MAX_VECTORS, err);
}

static mrt_result create_shading(composer *self, const mesh *m, error *err)
{
    const points_order *order = face_order(self->face);
    const points *rest = face_rest(self->face);
    const float *const at[3] = {rest->x, rest->y, rest->z};
    size_t corners = (size_t)m->triangle_count * 3;
    uint32_t *triangle = malloc(corners * sizeof *triangle + 1);
    if (!triangle)
        return error_set(err, MRT_ERR_MEMORY, "no memory for its normals");
    for (size_t i = 0; i < corners; ++i)
        triangle[i] = order->slot_of_file[m->triangle[i]];
    mrt_result result =
        shading_create(&self->shading, at, rest->count, triangle, m->triangle_count, err);
    free(triangle);
    return result;
}

double composer_radius_of(const face_file *file)
{
    float low[3], high[3];
    if (file->rig && file->rig->solver.radius > 0)
        return file->rig->solver.radius;
    mesh_bounds(&file->mesh, low, high);
    double size = 0;
    for (int axis = 0; axis < 3; ++axis)
        size = fmax(size, to_double(high[axis]) - to_double(low[axis]));
    double height = to_double(high[1]) - to_double(low[1]);
    return 0.25 * (height > 0 ? height : fmax(size, 1.0));
}

/* How large the face is, and the radius of a pull that names none. */
static void measure_face(composer *self, const face_file *file, const csrbf_settings *solver)
{
    float low[3], high[3];
    mesh_bounds(&file->mesh, low, high);
    self->about.low = (mrt_vec3){low[0], low[1], low[2]};
    self->about.high = (mrt_vec3){high[0], high[1], high[2]};
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

/* What mappings may pull and drive. */
static void describe_face(composer *self)
{
    const bones *b = face_bones(self->face);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        self->dof[i] = (mrt_dof){b->dof[i].name, b->dof[i].unit, b->dof[i].min, b->dof[i].max};
    self->about.contacts = face_contacts(self->face, &self->about.contact_count);
    self->about.dofs = self->dof;
    self->about.dof_count = b->dof_count;
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
    if (result < 0) {
        composer_destroy(self);
        return result;
    }
    describe_face(self);
    composer_draw(self);
    *out = self;
    return MRT_OK;
}

void composer_destroy(composer *self)
{
    if (!self)
        return;
    face_destroy(self->face);
    shading_destroy(self->shading);
    free(self);
}

void composer_reset(composer *self)
{
    face_reset(self->face);
    memset(self->voice, 0, sizeof self->voice);
    self->order_count = self->joined_count = self->control_count = 0;
    self->engaged = self->stale = false;
}

/* ---- shared by both ways to move ---- */

void composer_note_problem(composer *self, const char *text)
{
    if (!self->counts.first_problem.text[0])
        error_set(&self->counts.first_problem, MRT_ERR_FORMAT, "%s", text);
}

void composer_show(composer *self)
{
    if (self->stale)
        face_show(self->face);
    self->stale = false;
}

csrbf_settings composer_settings(const composer *self, float radius_mm, const mrt_pull *how)
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

/* Where this step's drag begins: at the tips as they really are when the mapping goes on from its
 * last ends, else where the mapping says. */
static void drag_from(const voice *v, double *out_from)
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

/* A weight below 1 goes only a part of the way. */
static void shorten(const voice *v, const double *from, double *to)
{
    double share = v->part.weight * v->part.gain;
    for (size_t i = 0; fabs(share - 1.0) > 0.0 && i < (size_t)v->part.pull->count * 3; ++i)
        to[i] = from[i] + share * (to[i] - from[i]);
}

/* Tips that have fallen behind the hand come after it at most at twice its speed: what held them
 * back may be gone at once, and the shape must not jump. */
static void come_after(const voice *v, const double *from, double *to)
{
    const mrt_pull *pull = v->part.pull;
    for (uint32_t i = 0; v->is_dragging && i < pull->count; ++i) {
        vec3 start = composer_vec3(pull->vector[i].start), end = composer_vec3(pull->vector[i].end);
        const double *at = from + (size_t)3 * i;
        double *goal = to + (size_t)3 * i;
        vec3 way = {goal[0] - at[0], goal[1] - at[1], goal[2] - at[2]};
        double most = 2.0 * vec3_length(vec3_sub(end, start)), length = vec3_length(way);
        double part = length > most ? most / length : 1.0;
        for (int axis = 0; axis < 3 && part < 1.0; ++axis)
            goal[axis] = at[axis] + part * (goal[axis] - at[axis]);
    }
}

/* Some tip is not where the hand is. */
static bool is_behind(const voice *v, const double *to)
{
    return memcmp(v->tip, to, (size_t)v->tip_count * 3 * sizeof *to) != 0;
}

static bool drives_bones(const composer *self, const mrt_pull *pull)
{
    for (uint32_t i = 0; i < self->about.dof_count; ++i)
        if (!isnan(pull->dof[i]))
            return true;
    return false;
}

static void drag_along_way(composer *self, voice *v, const csrbf_settings *settings, double *to)
{
    const mrt_pull *pull = v->part.pull;
    error err = {""};
    shape_step step = {.min_determinant = 1.0};
    double from[MRT_MAX_VECTORS * 3], next[MRT_MAX_VECTORS * 3];
    float dof[MRT_MAX_DOFS];
    drag_from(v, from);
    shorten(v, from, to);
    memcpy(next, to, (size_t)pull->count * 3 * sizeof *next);
    come_after(v, from, next);
    composer_blend_dofs(self, dof);
    self->counts.solves += 1;
    mrt_result result =
        face_drag(self->face, settings, from, next, pull->count, dof, v->tip, &step, &err);
    v->tip_count = pull->count;
    v->is_dragging = result >= 0 && is_behind(v, to);
    self->counts.held_pulls += result < 0;
    if (result < 0)
        composer_note_problem(self, err.text);
    self->counts.limited_steps += step.limited;
    self->counts.folded_steps += step.substeps > 0 && !(step.min_determinant > 0.0);
    self->counts.substeps += step.substeps;
    self->counts.min_determinant = fmin(self->counts.min_determinant, step.min_determinant);
}

static bool is_nobody(const voice *v)
{
    (void)v;
    return false;
}

/* The shape itself is kneaded: what anchored voices add to it is taken off for that long. */
static void bare_shape(composer *self)
{
    composer_show(self);
    if (composer_is_anybody_joined(self) && self->is_mixed)
        composer_let_go_but(self, is_nobody);
    self->engaged = false;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->voice[slot].is_joined = false;
}

static void knead(composer *self, voice *v, double dt_s)
{
    const mrt_pull *pull = v->part.pull;
    bare_shape(self);
    csrbf_settings settings = composer_settings(self, pull->radius_mm, pull);
    double to[MRT_MAX_VECTORS * 3];
    copy_ends(to, pull);
    bool near = !pull->gate || face_is_near(self->face, to, pull->count, settings.radius);
    /* The first sample near the shape only says where the tips are. */
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

/* The base goes on its way back to the rest shape; what the others pull stays. */
static void restore(composer *self, double part)
{
    composer_show(self);
    if (composer_is_anybody_joined(self))
        composer_let_go_but(self, is_nobody);
    self->engaged = false;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->voice[slot].is_joined = false;
    face_restore(self->face, part);
}

/* ---- the step ---- */

static void hear(composer *self, const composer_part *part, uint32_t count)
{
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        self->voice[slot].is_present = false;
    self->order_count = 0;
    for (uint32_t i = 0; i < count && self->order_count < COMPOSER_PARTS_MAX; ++i) {
        if (part[i].slot >= COMPOSER_PARTS_MAX)
            continue;
        voice *v = &self->voice[part[i].slot];
        v->is_present = true;
        v->part = part[i];
        self->order[self->order_count++] = part[i].slot;
    }
}

/* What the voices say now; true: something of it is new. */
static bool listen(composer *self)
{
    bool is_new = false;
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot) {
        voice *v = &self->voice[slot];
        is_new |= v->is_present != v->was_present;
        if (!v->is_present) {
            if (!v->is_joined)
                v->has_said = false;
            continue;
        }
        const mrt_pull *pull = v->part.pull;
        is_new |= pull->mode == MRT_ANCHORED || fabs(v->weight - v->part.weight) > 0.0;
        if (pull->mode == MRT_ANCHORED)
            v->said = *pull;
        v->has_said = pull->mode == MRT_ANCHORED || (pull->mode == MRT_IDLE && v->has_said);
        if (pull->mode != MRT_UNANCHORED)
            v->was_near = false;
        if (pull->mode == MRT_ANCHORED)
            v->is_dragging = false;
    }
    return is_new;
}

static void add_pulled(mrt_pull *out, const voice *v)
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
    const voice *first = &self->voice[self->order[0]];
    bool is_one = self->order_count == 1 && !(fabs(first->part.weight - 1.0) > 0.0) &&
                  !(fabs(first->part.gain - 1.0) > 0.0);
    if (is_one) {
        self->pulled = *first->part.pull;
        return;
    }
    self->pulled.count = 0;
    self->pulled.mode = self->engaged ? MRT_ANCHORED : MRT_UNANCHORED;
    for (uint32_t i = 0; i < self->order_count; ++i)
        add_pulled(&self->pulled, &self->voice[self->order[i]]);
    composer_blend_dofs(self, self->pulled.dof);
}

static void leave(composer *self)
{
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot) {
        voice *v = &self->voice[slot];
        v->was_present = v->is_present;
        if (v->is_present) {
            v->commit = v->part.pull->commit;
            v->weight = v->part.weight;
        } else {
            v->has_said = v->was_near = v->is_dragging = false;
        }
        v->part.pull = NULL;
        v->part.owns = NULL;
    }
}

static bool is_kneading(const voice *v)
{
    return v->part.pull->mode == MRT_UNANCHORED && v->part.is_fresh;
}

void composer_move(composer *self, const composer_part *part, uint32_t count, double dt_s)
{
    hear(self, part, count);
    bool is_new = composer_commit(self);
    is_new |= listen(self);
    bool is_kneaded = false, is_held = false;
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const voice *v = &self->voice[self->order[i]];
        is_kneaded |= is_kneading(v);
        is_held |= v->has_said;
    }
    self->is_mixed = is_kneaded && is_held;
    for (uint32_t i = 0; i < self->order_count; ++i)
        if (is_kneading(&self->voice[self->order[i]]))
            knead(self, &self->voice[self->order[i]], dt_s);
    for (uint32_t i = 0; i < self->order_count; ++i) {
        const voice *v = &self->voice[self->order[i]];
        if (!(v->part.restore > 0.0))
            continue;
        restore(self, v->part.restore);
        is_kneaded = true;
    }
    if (is_held ? is_new || is_kneaded : is_new && !is_kneaded)
        composer_join(self);
    note_pulled(self);
    leave(self);
}

bool composer_is_near(const composer *self, const mrt_pull *pull)
{
    double end[MRT_MAX_VECTORS * 3];
    if (!pull->gate || pull->count == 0)
        return false;
    copy_ends(end, pull);
    return face_is_near(self->face, end, pull->count,
                        composer_settings(self, pull->radius_mm, pull).radius);
}

void composer_draw(composer *self)
{
    composer_show(self);
    const shading_shape now = face_shading(self->face);
    shading_update(self->shading, &now);
}

/* ---- what others see ---- */

const mrt_face *composer_about(const composer *self)
{
    return &self->about;
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

csrbf_settings composer_solver(const composer *self)
{
    return self->solver;
}

const shading *composer_shading(const composer *self)
{
    return self->shading;
}

bool composer_is_anchored(const composer *self)
{
    return self->engaged;
}

const composer_counts *composer_counted(const composer *self)
{
    return &self->counts;
}
