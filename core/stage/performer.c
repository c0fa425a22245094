#include "stage/performer.h"
#include "base/clock.h"
#include "mesh/normals.h"
#include "stage/plugins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The guard: no control vector leads further from the face than this many times its size. */
static const double reach_in_faces = 10.0;
static const double dt_max_s = 0.1;

struct performer {
    instance *mapping;
    const mrt_mapping *functions;
    face *face;
    mrt_face about; /* the face as the mapping sees it */
    mrt_dof dof[MRT_MAX_DOFS];
    csrbf_settings solver; /* with the default radius filled in */
    double reach_mm;
    vec3 centre;

    hands *hands;
    mrt_frame frame;
    mrt_pull pull; /* what the mapping fills; it sees its own last values */
    mrt_pull good; /* the last that passed the guard */
    bool has_time;

    uint32_t *triangle; /* of the face, in the engine's order */
    uint32_t triangle_count;
    float *normal; /* 3 streams of padded_count */

    bool engaged; /* anchored: the face is engaged for `anchor` */
    bool stale;   /* anchored: what is shown is older than the last sample */
    uint32_t anchor, commit, control_count;
    float engaged_radius_mm;
    bool was_near, is_dragging;
    double tip[MRT_MAX_VECTORS * 3]; /* unanchored: where the tips really are */
    uint32_t tip_count;
    performer_counts counts;
};

static double to_double(float v)
{
    return (double)v;
}

static mrt_result create_surface(performer *self, const face_file *file, error *err)
{
    const mesh *m = &file->mesh;
    mrt_result result =
        face_create(&self->face, file->rig, m, &file->topology, MRT_MAX_VECTORS, err);
    if (result < 0)
        return result;
    const points_order *order = face_order(self->face);
    self->triangle_count = m->triangle_count;
    self->triangle = malloc((size_t)m->triangle_count * 3 * sizeof *self->triangle + 1);
    self->normal = calloc((size_t)face_rest(self->face)->padded_count * 3, sizeof *self->normal);
    if (!self->triangle || !self->normal)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the surface");
    for (size_t i = 0; i < (size_t)m->triangle_count * 3; ++i)
        self->triangle[i] = order->slot_of_file[m->triangle[i]];
    return MRT_OK;
}

/* How large the face is, and the radius of a pull that names none. */
static void measure_face(performer *self, const face_file *file, const csrbf_settings *solver)
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
    if (!(self->solver.radius > 0)) {
        double height = to_double(high[1]) - to_double(low[1]);
        self->solver.radius = 0.25 * (height > 0 ? height : fmax(size, 1.0));
    }
}

/* What the mapping may pull and drive. */
static void describe_face(performer *self)
{
    const bones *b = face_bones(self->face);
    for (uint32_t i = 0; i < b->dof_count; ++i)
        self->dof[i] = (mrt_dof){b->dof[i].name, b->dof[i].unit, b->dof[i].min, b->dof[i].max};
    self->about.contacts = face_contacts(self->face, &self->about.contact_count);
    self->about.dofs = self->dof;
    self->about.dof_count = b->dof_count;
}

mrt_result performer_create(performer **out, const face_file *file, instance *mapping,
                            const performer_settings *settings, error *err)
{
    *out = NULL;
    performer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the performer");
    hands_settings of_hands = {.rezero_pedal = settings->rezero_pedal};
    for (int side = 0; side < 2; ++side)
        of_hands.length_mm[side] = settings->hand_length_mm > 0 ? settings->hand_length_mm
                                                                : settings->side_length_mm[side];
    self->counts.min_determinant = 1.0;
    measure_face(self, file, &settings->solver);
    mrt_result result = create_surface(self, file, err);
    if (result >= 0)
        result = hands_create(&self->hands, &of_hands, err);
    if (result < 0)
        goto fail;
    describe_face(self);
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        self->pull.dof[i] = NAN;
    self->good = self->pull;
    self->functions = plugin_interface(mapping->type, MRT_MAPPING);
    error why = {""};
    instance_listen(mapping, &why, NULL);
    result = self->functions->activate(mapping->self, &self->about);
    instance_listen_end(mapping);
    if (result < 0) {
        error_set(err, result, "mapping %s cannot be used on this face%s%s", mapping->type->id,
                  why.text[0] ? ": " : "", why.text);
        goto fail;
    }
    self->mapping = mapping;
    self->functions->reset(mapping->self);
    performer_draw(self);
    *out = self;
    return MRT_OK;
fail:
    performer_destroy(self);
    return result;
}

void performer_destroy(performer *self)
{
    if (!self)
        return;
    if (self->mapping)
        self->functions->deactivate(self->mapping->self);
    hands_destroy(self->hands);
    face_destroy(self->face);
    free(self->triangle);
    free(self->normal);
    free(self);
}

/* ---- steps 4 and 5: the mapping and the guard ---- */

static bool is_within_reach(const performer *self, mrt_vec3 p)
{
    vec3 from_centre =
        vec3_sub((vec3){to_double(p.x), to_double(p.y), to_double(p.z)}, self->centre);
    return vec3_length(from_centre) <= self->reach_mm; /* false for what is not finite */
}

/* Says what is wrong with a pull; NULL: nothing. */
static const char *pull_fault(const performer *self, const mrt_pull *pull)
{
    if (pull->mode > MRT_UNANCHORED)
        return "an unknown mode";
    if (pull->count > MRT_MAX_VECTORS)
        return "more vectors than are allowed";
    if (!isfinite(pull->radius_mm) || pull->radius_mm < 0.0f)
        return "a radius that is not a length";
    if (!isfinite(pull->leak_per_s) || pull->leak_per_s < 0.0f)
        return "a leak that is not a rate";
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        if (!is_within_reach(self, v->start) || !is_within_reach(self, v->end))
            return "a control vector that is not finite or leads out of reach";
        if (v->contact > self->about.contact_count)
            return "a contact that the face does not have";
    }
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        if (isinf(pull->dof[i]))
            return "an infinite degree of freedom";
    return NULL;
}

static void note_problem(performer *self, const char *text)
{
    if (!self->counts.first_problem.text[0])
        error_set(&self->counts.first_problem, MRT_ERR_FORMAT, "%s", text);
}

/* Fills self->good with what the mapping wants now, if it makes sense. */
static void run_mapping(performer *self)
{
    instance_latch(self->mapping);
    self->frame.params = self->mapping->params;
    mrt_result result = self->functions->process(self->mapping->self, &self->frame, &self->pull);
    if (result == MRT_HOLD) {
        self->pull = self->good;
        return;
    }
    const char *fault = result < 0 ? "an error" : pull_fault(self, &self->pull);
    if (!fault) {
        self->good = self->pull;
        return;
    }
    self->counts.bad_pulls += 1;
    if (!self->counts.first_problem.text[0])
        error_set(&self->counts.first_problem, MRT_ERR_FORMAT, "mapping %s gave %s",
                  self->mapping->type->id, fault);
    self->pull = self->good; /* "on entry: what it held last" stays sane */
}

/* ---- step 7 ---- */

static void show_anchored(performer *self)
{
    if (self->stale)
        face_show(self->face);
    self->stale = false;
}

static csrbf_settings settings_of(const performer *self, const mrt_pull *pull)
{
    csrbf_settings settings = self->solver;
    if (pull->radius_mm > 0.0f)
        settings.radius = to_double(pull->radius_mm);
    return settings;
}

static void copy_ends(double *out, const mrt_pull *pull, bool ends)
{
    for (uint32_t i = 0; i < pull->count; ++i) {
        mrt_vec3 p = ends ? pull->vector[i].end : pull->vector[i].start;
        out[3 * i] = to_double(p.x);
        out[3 * i + 1] = to_double(p.y);
        out[3 * i + 2] = to_double(p.z);
    }
}

/* A contact is taken where it is now, wherever the mapping says that it rests. */
static vec3 start_of(const performer *self, const mrt_vector *v)
{
    if (v->contact == 0)
        return (vec3){to_double(v->start.x), to_double(v->start.y), to_double(v->start.z)};
    return face_contact_now(self->face, v->contact);
}

static void engage(performer *self, const mrt_pull *pull)
{
    error err = {""};
    face_control control[MRT_MAX_VECTORS];
    csrbf_settings settings = settings_of(self, pull);
    show_anchored(self); /* the base is the shape of this sample, not of the last drawn frame */
    for (uint32_t i = 0; i < pull->count; ++i)
        control[i] = (face_control){start_of(self, &pull->vector[i]), pull->vector[i].contact};
    if (face_engage(self->face, &settings, control, pull->count, &err) < 0) {
        self->counts.held_pulls += 1;
        note_problem(self, err.text);
        self->engaged = false;
        return;
    }
    self->engaged = true;
    self->anchor = pull->anchor;
    self->control_count = pull->count;
    self->engaged_radius_mm = pull->radius_mm;
    self->counts.engagements += 1;
}

/* Step 6: where every control is to land, and the bones' poses. */
static void aim(performer *self, const mrt_pull *pull)
{
    error err = {""};
    double end[MRT_MAX_VECTORS * 3];
    uint8_t rides[MRT_MAX_VECTORS];
    copy_ends(end, pull, true);
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        rides[i] = v->contact != 0;
        if (!rides[i])
            continue;
        end[3 * i] -= to_double(v->start.x);
        end[3 * i + 1] -= to_double(v->start.y);
        end[3 * i + 2] -= to_double(v->start.z);
    }
    face_ride(self->face, end, rides, pull->dof);
    if (face_aim(self->face, end, pull->dof, &err) < 0) {
        self->counts.held_pulls += 1;
        note_problem(self, err.text);
        return;
    }
    self->stale = true;
}

static void move_anchored(performer *self, const mrt_pull *pull)
{
    self->is_dragging = false;
    bool is_new = !self->engaged || pull->anchor != self->anchor ||
                  pull->count != self->control_count ||
                  fabsf(pull->radius_mm - self->engaged_radius_mm) > 0.0f;
    if (is_new)
        engage(self, pull);
    if (self->engaged)
        aim(self, pull);
}

/* Where this step's drag begins: at the tips as they really are when the mapping goes on from its
 * last ends, else where the mapping says. */
static void drag_from(performer *self, const mrt_pull *pull, double *out_from)
{
    copy_ends(out_from, pull, false);
    if (self->is_dragging && self->tip_count == pull->count)
        memcpy(out_from, self->tip, (size_t)pull->count * 3 * sizeof *out_from);
}

static bool drives_bones(const performer *self, const mrt_pull *pull)
{
    for (uint32_t i = 0; i < self->about.dof_count; ++i)
        if (!isnan(pull->dof[i]))
            return true;
    return false;
}

static void move_unanchored(performer *self, const mrt_pull *pull)
{
    show_anchored(self);
    self->engaged = false;
    csrbf_settings settings = settings_of(self, pull);
    double from[MRT_MAX_VECTORS * 3], to[MRT_MAX_VECTORS * 3];
    copy_ends(to, pull, true);
    bool near = !pull->gate || face_is_near(self->face, to, pull->count, settings.radius);
    /* The first sample near the shape only says where the tips are. */
    bool may_move = near && self->was_near && pull->count > 0;
    if (pull->count == 0)
        may_move = drives_bones(self, pull);
    self->was_near = near;
    if (!may_move) {
        self->is_dragging = false;
    } else {
        error err = {""};
        shape_step step = {.min_determinant = 1.0};
        drag_from(self, pull, from);
        mrt_result result = face_drag(self->face, &settings, from, to, pull->count, pull->dof,
                                      self->tip, &step, &err);
        self->tip_count = pull->count;
        self->is_dragging = result >= 0 && step.limited;
        self->counts.held_pulls += result < 0;
        if (result < 0)
            note_problem(self, err.text);
        self->counts.limited_steps += step.limited;
        self->counts.folded_steps += step.substeps > 0 && !(step.min_determinant > 0.0);
        self->counts.substeps += step.substeps;
        self->counts.min_determinant = fmin(self->counts.min_determinant, step.min_determinant);
    }
    if (pull->leak_per_s > 0.0f)
        face_leak(self->face, to_double(pull->leak_per_s), self->frame.dt_s);
}

static void move_shape(performer *self)
{
    const mrt_pull *pull = &self->good;
    if (pull->commit != self->commit) {
        show_anchored(self);
        face_commit(self->face);
        self->commit = pull->commit;
        self->engaged = false;
        self->counts.commits += 1;
    }
    if (pull->mode != MRT_UNANCHORED)
        self->was_near = false;
    if (pull->mode == MRT_ANCHORED)
        move_anchored(self, pull);
    else if (pull->mode == MRT_UNANCHORED)
        move_unanchored(self, pull);
}

/* For the mapping's next frame. Asked of shapes that do not depend on when frames are drawn: the
 * base while engaged, and what unanchored samples left. */
static bool is_near(const performer *self)
{
    const mrt_pull *pull = &self->good;
    if (!pull->gate || pull->count == 0)
        return false;
    double end[MRT_MAX_VECTORS * 3];
    copy_ends(end, pull, true);
    return face_is_near(self->face, end, pull->count, settings_of(self, pull).radius);
}

void performer_sample(performer *self, const channel_route *route, const mrt_sample *sample)
{
    int64_t time_ns = sample->time_ns;
    if (self->has_time && time_ns < self->frame.time_ns)
        time_ns = self->frame.time_ns;
    double dt_s = self->has_time ? (double)(time_ns - self->frame.time_ns) / (double)NS_PER_S : 0.0;
    self->frame.dt_s = fmin(dt_s, dt_max_s);
    self->frame.time_ns = time_ns;
    self->has_time = true;
    self->counts.samples += 1;
    hands_read(self->hands, route, sample, &self->frame);
    run_mapping(self);
    move_shape(self);
    self->frame.near = is_near(self);
}

mrt_result performer_rezero(performer *self, uint32_t side, error *why)
{
    return hands_rezero(self->hands, side, self->frame.time_ns, why);
}

const rezero_counts *performer_rezeros(const performer *self)
{
    return hands_rezeros(self->hands);
}

void performer_draw(performer *self)
{
    show_anchored(self);
    const points *p = face_shown(self->face);
    size_t stride = p->padded_count;
    normals_smooth(self->normal, self->normal + stride, self->normal + 2 * stride, p->x, p->y, p->z,
                   p->count, self->triangle, self->triangle_count);
}

face *performer_face(performer *self)
{
    return self->face;
}

csrbf_settings performer_solver(const performer *self)
{
    return self->solver;
}

const float *performer_normal(const performer *self, uint32_t axis)
{
    return self->normal + (size_t)axis * face_shown(self->face)->padded_count;
}

const mrt_pull *performer_pull(const performer *self)
{
    return &self->good;
}

bool performer_is_anchored(const performer *self)
{
    return self->engaged;
}

const performer_counts *performer_counted(const performer *self)
{
    return &self->counts;
}
