#include "stage/perform/patch_bay.h"
#include "base/bytes.h"
#include "mesh/arkit.h"
#include "stage/mapping/instance.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NOTE = 2048, MOVES_MAX = 4096 };

typedef enum move_kind { MOVE_CONTACT, MOVE_DOF, MOVE_SHAPE } move_kind;

/* Effect of a connection on one contact, degree of freedom or shape, per unit of its value. */
typedef struct patch_move {
    uint32_t connection;
    move_kind kind;
    uint32_t index;
    bool is_follow; /* at a contact that the pose does not name: always added, whatever the mode */
    float way[3];   /* mm for a contact; otherwise only way[0]: rad or mm for a degree of freedom */
} patch_move;

struct patch_plan {
    patch of;
    patch_range range[PATCH_CONNECTIONS_MAX];
    patch_move *move; /* ordered by connection */
    uint32_t move_count,
        shape_count; /* shape_count: shapes of the face, 0 if no connection moves one */
    bool is_pose[PATCH_CONNECTIONS_MAX]; /* moves a pose of the rig, so it holds all contacts */
    uint32_t sum;                        /* hash of the patch, which identifies its state */
    const mrt_face *about;
    char note[NOTE];
};

/* ---- a patch prepared for a face ---- */

static void note(patch_plan *self, uint32_t connection, const char *format, ...)
{
    size_t used = strlen(self->note);
    char words[200];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    (void)snprintf(self->note + used, sizeof self->note - used, "patch, connection %u: %s\n",
                   connection + 1, words);
}

static mrt_result add_move(patch_plan *self, uint32_t connection, move_kind kind, uint32_t index,
                           const double way[3])
{
    if (self->move_count == MOVES_MAX)
        return MRT_ERR_UNSUPPORTED;
    patch_move *to = &self->move[self->move_count++];
    *to = (patch_move){.connection = connection, .kind = kind, .index = index};
    for (int axis = 0; axis < 3; ++axis)
        to->way[axis] = (float)way[axis];
    return MRT_OK;
}

/* Returns whether a name matches. One '*' in the pattern matches "l" (side 1) or "r" (side -1).
 * Without '*' the side is 0. */
static bool is_named(const char *pattern, const char *name, int *out_side)
{
    const char *star = strchr(pattern, '*');
    *out_side = 0;
    if (!star)
        return strcmp(pattern, name) == 0;
    size_t before = (size_t)(star - pattern);
    if (strlen(name) != strlen(pattern) || strncmp(name, pattern, before) != 0 ||
        (name[before] != 'l' && name[before] != 'r') || strcmp(name + before + 1, star + 1) != 0)
        return false;
    *out_side = name[before] == 'l' ? 1 : -1;
    return true;
}

static void plan_dof(patch_plan *self, uint32_t i, const mrt_face *about)
{
    static const double whole[3] = {1.0, 0.0, 0.0};
    const patch_connection *c = &self->of.connection[i];
    uint32_t before = self->move_count;
    for (uint32_t d = 0; d < about->dof_count && d < MRT_MAX_DOFS; ++d) {
        int side;
        if (!is_named(c->target, about->dofs[d].name, &side) ||
            add_move(self, i, MOVE_DOF, d, whole) < 0)
            continue;
        self->range[i] = (patch_range){(double)about->dofs[d].min, (double)about->dofs[d].max, 0.0};
    }
    if (self->move_count == before)
        note(self, i, "the face has no degree of freedom \"%s\"", c->target);
}

/* Returns the scale from a head of 240 mm height to this one, so that patches fit heads of any
 * size. */
static double scale_of(const mrt_face *about)
{
    double height = (double)about->high.y - (double)about->low.y;
    return height > 0.0 ? height / 240.0 : 1.0;
}

static void plan_contact(patch_plan *self, uint32_t i, const mrt_face *about)
{
    static const double usual_mm = 10.0;
    const patch_connection *c = &self->of.connection[i];
    double scale = scale_of(about);
    uint32_t before = self->move_count;
    for (uint32_t k = 0; k < about->contact_count; ++k) {
        int side;
        if (!is_named(c->target, about->contacts[k].name, &side))
            continue;
        double out = side == 0 ? 1.0 : (double)side;
        const double way[3] = {scale * out * (double)c->way[0], scale * (double)c->way[1],
                               scale * (double)c->way[2]};
        (void)add_move(self, i, MOVE_CONTACT, k, way);
    }
    self->range[i] = (patch_range){-usual_mm, usual_mm, 0.0};
    if (self->move_count == before)
        note(self, i, "the face has no contact \"%s\"", c->target);
}

static const rig_pose *find_pose(const rig *r, const char *name, patch_kind kind)
{
    for (uint32_t i = 0; r && i < r->pose_count; ++i)
        if (strcmp(r->pose[i].name, name) == 0)
            return &r->pose[i];
    for (uint32_t i = 0; r && kind == PATCH_SHAPE && i < r->pose_count; ++i)
        if (arkit_is_same_name(r->pose[i].name, name))
            return &r->pose[i];
    return NULL;
}

static void add_dofs(patch_plan *self, uint32_t i, const float *dof, double part, uint32_t count)
{
    for (uint32_t d = 0; d < count && d < MRT_MAX_DOFS; ++d) {
        const double way[3] = {part * (double)dof[d], 0.0, 0.0};
        if (fabs(way[0]) > 0.0)
            (void)add_move(self, i, MOVE_DOF, d, way);
    }
}

/* Returns false if the head has no shape of that name. */
static bool plan_shape(patch_plan *self, uint32_t i, const mrt_face *about, const face *own)
{
    const char *target = self->of.connection[i].target;
    uint32_t before = self->move_count, count = own ? face_shape_count(own) : 0;
    float part[FACE_SHAPES_MAX];
    if (count == 0 || !face_shape_parts(own, target, part))
        return false;
    for (uint32_t s = 0; s < count; ++s) {
        const double way[3] = {(double)part[s], 0.0, 0.0};
        if (!(way[0] > 0.0))
            continue;
        (void)add_move(self, i, MOVE_SHAPE, s, way);
        add_dofs(self, i, face_shape_dofs(own, s), way[0], about->dof_count);
        self->shape_count = count;
    }
    return self->move_count > before;
}

static void plan_pose(patch_plan *self, uint32_t i, const mrt_face *about, const rig *r)
{
    const patch_connection *c = &self->of.connection[i];
    const rig_pose *pose = find_pose(r, c->target, c->kind);
    self->is_pose[i] = pose != NULL;
    for (uint32_t k = 0; pose && k < pose->pull_count + pose->follow_count; ++k) {
        const double way[3] = {pose->pull_mm[k].x, pose->pull_mm[k].y, pose->pull_mm[k].z};
        if (add_move(self, i, MOVE_CONTACT, pose->pull_contact[k], way) >= 0)
            self->move[self->move_count - 1].is_follow = k >= pose->pull_count;
    }
    for (uint32_t k = 0; pose && k < pose->dof_count; ++k)
        for (uint32_t d = 0; d < about->dof_count && d < MRT_MAX_DOFS; ++d) {
            const double way[3] = {pose->dof_value[k], 0.0, 0.0};
            if (strcmp(about->dofs[d].name, pose->dof_name[k]) == 0)
                (void)add_move(self, i, MOVE_DOF, d, way);
        }
    if (!pose)
        note(self, i, "the %s \"%s\"",
             c->kind == PATCH_POSE ? "rig has no pose" : "head has no shape and the rig no pose",
             c->target);
}

static uint32_t add_to_sum(uint32_t sum, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; ++i)
        sum = (sum ^ at[i]) * 16777619u;
    return sum;
}

static uint32_t sum_of(const patch *p)
{
    uint32_t sum = add_to_sum(2166136261u, &p->count, sizeof p->count);
    for (uint32_t i = 0; i < p->count; ++i) {
        const patch_connection *c = &p->connection[i];
        const unsigned char flags[4] = {(unsigned char)c->kind, c->adds, c->picks_up, c->is_muted};
        sum = add_to_sum(sum, c->input, strlen(c->input) + 1);
        sum = add_to_sum(sum, c->channel, strlen(c->channel) + 1);
        sum = add_to_sum(sum, c->target, strlen(c->target) + 1);
        sum = add_to_sum(sum, c->way, sizeof c->way);
        for (int k = 0; k < 2; ++k) {
            const double in = isnan(c->in[k]) ? 0.0 : c->in[k]; /* NaN has many bit patterns */
            const double out = isnan(c->out[k]) ? 0.0 : c->out[k];
            sum = add_to_sum(sum, &in, sizeof in);
            sum = add_to_sum(sum, &out, sizeof out);
        }
        sum = add_to_sum(sum, &c->bend, sizeof c->bend);
        sum = add_to_sum(sum, &c->ease, sizeof c->ease);
        sum = add_to_sum(sum, &c->smooth_s, sizeof c->smooth_s);
        sum = add_to_sum(sum, flags, sizeof flags);
    }
    return sum;
}

static void plan_connection(patch_plan *self, uint32_t i, const mrt_face *about, const rig *r,
                            const face *own)
{
    patch_kind kind = self->of.connection[i].kind;
    self->range[i] = (patch_range){kind == PATCH_POSE ? -1.0 : 0.0, 1.0, 0.0};
    if (kind == PATCH_DOF)
        plan_dof(self, i, about);
    else if (kind == PATCH_CONTACT)
        plan_contact(self, i, about);
    else if (kind == PATCH_POSE || kind == PATCH_SHAPE) {
        const bool has_pose = find_pose(r, self->of.connection[i].target, PATCH_POSE) != NULL;
        if ((kind == PATCH_POSE && has_pose) || !plan_shape(self, i, about, own))
            plan_pose(self, i, about, r);
    }
}

mrt_result patch_plan_create(patch_plan **out, const patch *p, const mrt_face *about, const rig *r,
                             const face *own, error *err)
{
    *out = NULL;
    mrt_result result = patch_check(p, err);
    if (result < 0)
        return result;
    patch_plan *self = calloc(1, sizeof *self);
    if (!self || !(self->move = calloc(MOVES_MAX, sizeof *self->move))) {
        free(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a patch");
    }
    self->of = *p;
    self->sum = sum_of(p);
    self->about = about;
    for (uint32_t i = 0; i < p->count; ++i)
        plan_connection(self, i, about, r, own);
    *out = self;
    return MRT_OK;
}

void patch_plan_destroy(patch_plan *self)
{
    if (!self)
        return;
    free(self->move);
    free(self);
}

const char *patch_plan_note(const patch_plan *self)
{
    return self->note;
}

/* ---- the active patch ---- */

static void forget_pull(mrt_pull *pull, float *shapes)
{
    *pull = guard_idle();
    for (uint32_t i = 0; i < FACE_SHAPES_MAX; ++i)
        shapes[i] = NAN;
}

void patch_bay_reset(patch_bay *self)
{
    memset(self->course, 0, sizeof self->course);
    memset(self->may_pull, 0, sizeof self->may_pull);
    memset(self->speaks, 0, sizeof self->speaks);
    memset(self->presses, 0, sizeof self->presses);
    for (int k = 0; k < PATCH_PULLS; ++k) {
        forget_pull(&self->pull[k], self->shape[k]);
        forget_pull(&self->leaving[k], self->leaving_shape[k]);
    }
    self->shape_count = self->plan ? self->plan->shape_count : 0;
    self->is_fading = false;
    self->side = 0;
    self->fade_s = 0.0;
}

void patch_bay_init(patch_bay *out, const guard *as)
{
    *out = (patch_bay){.guard = *as};
    patch_bay_reset(out);
}

void patch_bay_finish(patch_bay *self)
{
    patch_plan_destroy(self->plan);
    self->plan = NULL;
}

/* Starts the fade-out of the current pull. */
static void begin_fade(patch_bay *self)
{
    for (int k = 0; k < PATCH_PULLS; ++k) {
        self->leaving[k] = self->pull[k];
        memcpy(self->leaving_shape[k], self->shape[k], sizeof self->shape[k]);
        forget_pull(&self->pull[k], self->shape[k]);
    }
    self->is_fading = true;
    self->side = 1 - self->side;
    self->fade_s = 0.0;
}

/* Keeps the state of connections that the old plan also has. */
static void carry_courses_over(patch_bay *self, const patch_plan *plan)
{
    patch_course kept[PATCH_CONNECTIONS_MAX];
    memset(kept, 0, sizeof kept);
    for (uint32_t i = 0; plan && self->plan && i < plan->of.count; ++i)
        for (uint32_t k = 0; k < self->plan->of.count; ++k)
            if (patch_connection_equal(&plan->of.connection[i], &self->plan->of.connection[k]))
                kept[i] = self->course[k];
    memcpy(self->course, kept, sizeof kept);
}

bool patch_bay_set(patch_bay *self, patch_plan *plan, patch_plan **out_old)
{
    *out_old = NULL;
    if (self->is_fading)
        return false;
    carry_courses_over(self, plan);
    memset(self->may_pull, 0, sizeof self->may_pull);
    memset(self->speaks, 0, sizeof self->speaks);
    memset(self->presses, 0, sizeof self->presses);
    if (self->pull[PATCH_INSTEAD].mode != MRT_IDLE || self->pull[PATCH_ADDED].mode != MRT_IDLE)
        begin_fade(self);
    *out_old = self->plan;
    self->plan = plan;
    if (plan && plan->shape_count > 0)
        self->shape_count = plan->shape_count;
    self->mapping = NULL;
    return true;
}

/* ---- parameters ---- */

/* Returns UINT32_MAX if there is no such parameter. */
static uint32_t find_param(const mrt_plugin_type *mapping, const char *name)
{
    for (uint32_t k = 0; k < mapping->param_count; ++k) {
        char key[2 * PATCH_NAME];
        instance_key(mapping, k, key, sizeof key);
        if (strcmp(key, name) == 0)
            return k;
    }
    return UINT32_MAX;
}

static void find_params(patch_bay *self, const mrt_plugin_type *mapping)
{
    self->mapping = mapping;
    for (uint32_t i = 0; i < self->plan->of.count; ++i) {
        const patch_connection *c = &self->plan->of.connection[i];
        self->param[i] = c->kind == PATCH_PARAM ? find_param(mapping, c->target) : UINT32_MAX;
    }
}

void patch_plan_check_params(patch_plan *self, const mrt_plugin_type *mapping)
{
    for (uint32_t i = 0; i < self->of.count; ++i) {
        const patch_connection *c = &self->of.connection[i];
        if (c->kind == PATCH_PARAM && find_param(mapping, c->target) == UINT32_MAX)
            note(self, i, "the mapping has no parameter \"%s\"", c->target);
    }
}

static patch_range range_of(const patch_bay *self, uint32_t i)
{
    if (self->plan->of.connection[i].kind != PATCH_PARAM)
        return self->plan->range[i];
    const mrt_param *p = &self->mapping->params[self->param[i]];
    return (patch_range){p->min, p->max, p->initial};
}

static bool is_trigger(const patch_bay *self, uint32_t i)
{
    const patch_connection *c = &self->plan->of.connection[i];
    if (c->kind == PATCH_ACTION)
        return true;
    return c->kind == PATCH_PARAM && self->param[i] != UINT32_MAX &&
           (self->mapping->params[self->param[i]].flags & MRT_PARAM_TRIGGER);
}

void patch_bay_params(const patch_bay *self, const double *own, double *out)
{
    uint32_t count = self->mapping ? self->mapping->param_count : 0;
    memcpy(out, own, count * sizeof *out);
    for (uint32_t i = 0; self->plan && i < self->plan->of.count; ++i) {
        const patch_connection *c = &self->plan->of.connection[i];
        uint32_t k = self->param[i];
        if (c->kind != PATCH_PARAM || k >= count)
            continue;
        const mrt_param *p = &self->mapping->params[k];
        if (self->presses[i])
            out[k] = p->max;
        if (is_trigger(self, i) || !self->may_pull[i])
            continue;
        double value = c->adds ? out[k] + self->course[i].value : self->course[i].value;
        value = fmin(fmax(value, p->min), p->max);
        out[k] = (p->flags & MRT_PARAM_STEPPED) ? floor(value + 0.5) : value;
    }
}

/* ---- a step ---- */

/* The value of the target without this connection. */
static double under_of(const patch_bay *self, uint32_t i, const double *own, const mrt_pull *below)
{
    const patch_connection *c = &self->plan->of.connection[i];
    if (c->adds)
        return 0.0;
    if (c->kind == PATCH_PARAM)
        return own[self->param[i]];
    for (uint32_t m = 0; c->kind == PATCH_DOF && m < self->plan->move_count; ++m) {
        const patch_move *move = &self->plan->move[m];
        if (move->connection == i && move->kind == MOVE_DOF && !isnan(below->dof[move->index]))
            return (double)below->dof[move->index];
    }
    return 0.0;
}

static void press(patch_bay *self, uint32_t i, const mrt_channel *channel, double raw)
{
    static const patch_range whole = {0.0, 1.0, 0.0};
    patch_connection plain = self->plan->of.connection[i];
    plain.out[0] = 0.0;
    plain.out[1] = 1.0;
    double share = patch_wanted(&plain, channel, raw, &whole);
    self->presses[i] = patch_course_press(&self->course[i], share);
    if (!self->presses[i] || plain.kind != PATCH_ACTION)
        return;
    for (int action = 0; action < PATCH_ACTIONS; ++action)
        if (strcmp(plain.target, patch_action_names[action]) == 0)
            self->pressed[action] += 1;
}

static void update_connection(patch_bay *self, uint32_t i, const mrt_frame *frame,
                              const double *own, const mrt_pull *below)
{
    const patch_connection *c = &self->plan->of.connection[i];
    mrt_channel channel;
    double raw;
    self->presses[i] = false;
    if (c->is_muted || (c->kind == PATCH_PARAM && self->param[i] == UINT32_MAX) ||
        !patch_read_channel(c, frame, &channel, &raw))
        return; /* the last value is kept */
    if (is_trigger(self, i)) {
        press(self, i, &channel, raw);
        return;
    }
    const patch_range range = range_of(self, i);
    double wanted = patch_wanted(c, &channel, raw, &range);
    self->may_pull[i] = patch_course_step(&self->course[i], c, wanted,
                                          under_of(self, i, own, below), &range, frame->dt_s);
}

static bool is_pulling(const patch_bay *self, uint32_t i)
{
    patch_kind kind = self->plan->of.connection[i].kind;
    return self->may_pull[i] && kind != PATCH_PARAM && kind != PATCH_ACTION;
}

/* Starts a fade if the set of active connections changed, unless a fade is running. */
static void fade_on_change(patch_bay *self)
{
    bool is_other = false;
    for (uint32_t i = 0; i < self->plan->of.count; ++i)
        is_other |= is_pulling(self, i) != self->speaks[i];
    if (!is_other || self->is_fading)
        return;
    begin_fade(self);
    for (uint32_t i = 0; i < self->plan->of.count; ++i)
        self->speaks[i] = is_pulling(self, i);
}

static mrt_vector *vector_of(mrt_pull *pull, const mrt_face *about, uint32_t contact)
{
    for (uint32_t i = 0; i < pull->count; ++i)
        if (pull->vector[i].contact == contact + 1)
            return &pull->vector[i];
    if (pull->count == MRT_MAX_VECTORS)
        return NULL;
    mrt_vector *out = &pull->vector[pull->count++];
    mrt_vec3 rest = about->contacts[contact].rest;
    *out = (mrt_vector){.start = rest, .end = rest, .contact = contact + 1};
    return out;
}

static void add_to_pull(mrt_pull *pull, float *shapes, const mrt_face *about,
                        const patch_move *move, double value)
{
    pull->mode = MRT_ANCHORED;
    if (move->kind != MOVE_CONTACT) {
        float *one = move->kind == MOVE_DOF ? &pull->dof[move->index] : &shapes[move->index];
        *one = (isnan(*one) ? 0.0f : *one) + (float)(value * (double)move->way[0]);
        return;
    }
    mrt_vector *v = vector_of(pull, about, move->index);
    if (!v)
        return;
    v->end.x += (float)(value * (double)move->way[0]);
    v->end.y += (float)(value * (double)move->way[1]);
    v->end.z += (float)(value * (double)move->way[2]);
}

/* Makes a pose look the same beside any other pull. Contacts that the pose leaves at rest are held,
 * but the pulls of others still move them. is_alone: the mapping pulls no vectors, so degrees of
 * freedom without a value are held at rest too. */
static void hold_still(mrt_pull *pull, const mrt_face *about, bool is_alone)
{
    pull->mode = MRT_ANCHORED;
    for (uint32_t k = 0; about->contact_count <= MRT_MAX_VECTORS && k < about->contact_count; ++k)
        (void)vector_of(pull, about, k);
    for (uint32_t d = 0; is_alone && d < about->dof_count && d < MRT_MAX_DOFS; ++d)
        pull->dof[d] = isnan(pull->dof[d]) ? 0.0f : pull->dof[d];
}

static void pull(patch_bay *self, const mrt_pull *below)
{
    const patch_plan *plan = self->plan;
    bool has_pose = false, is_posed = false;
    for (int k = 0; k < PATCH_PULLS; ++k)
        forget_pull(&self->pull[k], self->shape[k]);
    for (uint32_t m = 0; m < plan->move_count; ++m) {
        const patch_move *move = &plan->move[m];
        uint32_t i = move->connection;
        int which = plan->of.connection[i].adds || move->is_follow ? PATCH_ADDED : PATCH_INSTEAD;
        if (self->speaks[i])
            add_to_pull(&self->pull[which], self->shape[which], plan->about, move,
                        self->course[i].value);
    }
    for (uint32_t i = 0; i < plan->of.count; ++i) {
        const bool is_pose = self->speaks[i] && plan->is_pose[i];
        has_pose |= is_pose;
        is_posed |= is_pose && fabs(self->course[i].value) > 0.0;
    }
    if (has_pose)
        hold_still(&self->pull[PATCH_ADDED], plan->about,
                   is_posed && (below->mode == MRT_IDLE || below->count == 0));
    for (int k = 0; k < PATCH_PULLS; ++k)
        if (guard_fault(&self->guard, &self->pull[k])) /* invalid, for example out of reach */
            forget_pull(&self->pull[k], self->shape[k]);
}

void patch_bay_step(patch_bay *self, const mrt_frame *frame, const mrt_plugin_type *mapping,
                    const double *own, const mrt_pull *below)
{
    if (self->is_fading) {
        self->fade_s += frame->dt_s;
        self->is_fading = self->fade_s < PATCH_FADE_S;
        for (int k = 0; k < PATCH_PULLS && !self->is_fading; ++k)
            forget_pull(&self->leaving[k], self->leaving_shape[k]);
    }
    if (!self->plan)
        return;
    if (self->mapping != mapping)
        find_params(self, mapping);
    for (uint32_t i = 0; i < self->plan->of.count; ++i)
        update_connection(self, i, frame, own, below);
    fade_on_change(self);
    pull(self, below);
}

double patch_bay_weight(const patch_bay *self)
{
    return self->is_fading ? fmin(self->fade_s / PATCH_FADE_S, 1.0) : 1.0;
}

bool patch_bay_is_settled(const patch_bay *self)
{
    bool is_settled = !self->is_fading;
    for (uint32_t i = 0; self->plan && i < self->plan->of.count; ++i) {
        const patch_course *c = &self->course[i];
        is_settled &= !c->is_heard || fabs(c->wanted - c->value) <= 1e-4 * (1.0 + fabs(c->wanted));
    }
    return is_settled;
}

/* ---- save and load ---- */

enum { STORE_VERSION = 1 };
enum { IS_HEARD = 1, IS_CAUGHT = 2, WAS_DOWN = 4, MAY_SPEAK = 8, SPEAKS = 16, FLAGS = 32 };

static void write_pull(bytes_out *out, const mrt_pull *p)
{
    bytes_write(out, p, offsetof(mrt_pull, vector));
    bytes_write(out, p->vector, p->count * sizeof *p->vector);
    bytes_write(out, p->dof, sizeof p->dof);
}

static void read_pull(bytes_in *in, const guard *of, mrt_pull *out)
{
    *out = guard_idle();
    bytes_read(in, out, offsetof(mrt_pull, vector));
    if (out->count > MRT_MAX_VECTORS || out->mode > MRT_ANCHORED) {
        in->failed = true;
        *out = guard_idle();
        return;
    }
    bytes_read(in, out->vector, out->count * sizeof *out->vector);
    bytes_read(in, out->dof, sizeof out->dof);
    in->failed |= guard_fault(of, out) != NULL;
}

size_t patch_bay_save(const patch_bay *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    uint32_t count = self->plan ? self->plan->of.count : 0;
    bytes_write_u32(&out, STORE_VERSION);
    bytes_write_u32(&out, self->plan ? self->plan->sum : 0);
    bytes_write_u32(&out, count);
    for (uint32_t i = 0; i < count; ++i) {
        const patch_course *c = &self->course[i];
        bytes_write_u32(&out, (c->is_heard ? IS_HEARD : 0u) | (c->is_picked_up ? IS_CAUGHT : 0u) |
                                  (c->was_down ? WAS_DOWN : 0u) |
                                  (self->may_pull[i] ? MAY_SPEAK : 0u) |
                                  (self->speaks[i] ? SPEAKS : 0u));
        bytes_write_f64(&out, c->wanted);
        bytes_write_f64(&out, c->value);
        bytes_write_f64(&out, c->under);
    }
    bytes_write_u32(&out, self->is_fading);
    bytes_write_u32(&out, self->side);
    bytes_write_f64(&out, self->fade_s);
    for (int k = 0; k < PATCH_PULLS; ++k) {
        write_pull(&out, &self->pull[k]);
        write_pull(&out, &self->leaving[k]);
    }
    if (self->shape_count > 0) /* the state of patches without shapes ends here */
        bytes_write_u32(&out, self->shape_count);
    for (int k = 0; k < PATCH_PULLS; ++k) {
        bytes_write(&out, self->shape[k], self->shape_count * sizeof(float));
        bytes_write(&out, self->leaving_shape[k], self->shape_count * sizeof(float));
    }
    return out.size;
}

static void read_course(bytes_in *in, patch_bay *self, uint32_t i)
{
    patch_course *c = &self->course[i];
    uint32_t flags = bytes_read_u32(in);
    in->failed |= flags >= FLAGS;
    c->is_heard = (flags & IS_HEARD) != 0;
    c->is_picked_up = (flags & IS_CAUGHT) != 0;
    c->was_down = (flags & WAS_DOWN) != 0;
    self->may_pull[i] = (flags & MAY_SPEAK) != 0;
    self->speaks[i] = (flags & SPEAKS) != 0;
    c->wanted = bytes_read_f64(in);
    c->value = bytes_read_f64(in);
    c->under = bytes_read_f64(in);
}

static void read_shapes(bytes_in *in, patch_bay *self)
{
    uint32_t count = bytes_read_u32(in);
    in->failed |= count == 0 || count > FACE_SHAPES_MAX;
    for (int k = 0; k < 2 * PATCH_PULLS && !in->failed; ++k) {
        float *shapes = k % 2 ? self->leaving_shape[k / 2] : self->shape[k / 2];
        bytes_read(in, shapes, count * sizeof *shapes);
        for (uint32_t i = 0; i < count; ++i)
            in->failed |= isinf(shapes[i]);
    }
    self->shape_count = in->failed ? 0 : count;
}

bool patch_bay_load(patch_bay *self, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    uint32_t count = self->plan ? self->plan->of.count : 0;
    patch_bay_reset(self);
    in.failed |= bytes_read_u32(&in) != STORE_VERSION;
    in.failed |= bytes_read_u32(&in) != (self->plan ? self->plan->sum : 0);
    in.failed |= bytes_read_u32(&in) != count;
    for (uint32_t i = 0; i < count && !in.failed; ++i)
        read_course(&in, self, i);
    self->is_fading = bytes_read_u32(&in) != 0;
    self->side = bytes_read_u32(&in);
    self->fade_s = bytes_read_f64(&in);
    in.failed |= self->side > 1 || !(self->fade_s >= 0.0);
    for (int k = 0; k < PATCH_PULLS && !in.failed; ++k) {
        read_pull(&in, &self->guard, &self->pull[k]);
        read_pull(&in, &self->guard, &self->leaving[k]);
    }
    if (!in.failed && in.at != in.end)
        read_shapes(&in, self);
    if (!in.failed && in.at == in.end)
        return true;
    patch_bay_reset(self);
    return false;
}
