#include "stage/perform/layer_state.h"
#include "base/clock.h"
#include "stage/mapping/plugins.h"
#include "stage/take/taught.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double dt_max_s = 0.1;

static void let_bones_go(mrt_pull *pull)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
}

/* What it was taught by now is what a reset returns to. */
static void keep_taught(layer *self)
{
    error ignored = {""};
    unsigned char *bytes = self->room->taught;
    if (!self->settings.keeps_taught || !bytes)
        return;
    size_t size = taught_save(self->mapping, bytes, TAUGHT_BYTES_MAX);
    if (size > 0 && taught_load(self->mapping, bytes, size, &ignored) < 0)
        return;
}

void layer_begin_anew(layer *self)
{
    keep_taught(self);
    layer_reset(self);
}

void layer_reset(layer *self)
{
    self->frame = (mrt_frame){0};
    self->pull = (mrt_pull){0};
    let_bones_go(&self->pull);
    self->good = self->pull;
    self->cut = (cut){.side = 0};
    self->has_time = false;
    self->resets = false;
    hands_reset(self->hands);
    pointer_reset(&self->pointer);
    self->functions->reset(self->mapping->self);
}

layer_room *layer_room_create(const instance *mapping)
{
    size_t count = (size_t)mapping->type->param_count + 1;
    layer_room *room = calloc(1, sizeof *room);
    if (!room)
        return NULL;
    room->last_params = calloc(count, sizeof *room->last_params);
    room->stored_params = calloc(count, sizeof *room->stored_params);
    bool learns = plugin_interface(mapping->type, MRT_STATE) != NULL;
    if (learns)
        room->taught = malloc(TAUGHT_BYTES_MAX);
    if (room->last_params && room->stored_params && (room->taught || !learns))
        return room;
    layer_room_destroy(room);
    return NULL;
}

void layer_room_destroy(layer_room *room)
{
    if (!room)
        return;
    free(room->last_params);
    free(room->stored_params);
    free(room->taught);
    free(room);
}

static void use_mapping(layer *self, instance *mapping)
{
    self->mapping = mapping;
    self->functions = plugin_interface(mapping->type, MRT_MAPPING);
    self->resume = plugin_interface(mapping->type, MRT_RESUME);
    self->seam = plugin_interface(mapping->type, STAGE_SEAM);
}

static mrt_result activate(layer *self, error *err)
{
    error why = {""};
    instance *mapping = self->mapping;
    instance_listen(mapping, &why, NULL);
    mrt_result result = self->functions->activate(mapping->self, self->about);
    instance_listen_end(mapping);
    if (result < 0)
        error_set(err, result, "mapping %s cannot be used on this face%s%s", mapping->type->id,
                  why.text[0] ? ": " : "", why.text);
    return result;
}

mrt_result layer_create(layer **out, instance *mapping, const mrt_face *about,
                        const layer_settings *settings, error *err)
{
    *out = NULL;
    layer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a layer");
    self->about = about;
    self->settings = *settings;
    self->guard = (guard){.contact_count = about->contact_count,
                          .centre = settings->centre,
                          .reach_mm = settings->reach_mm};
    mrt_result result = MRT_OK;
    self->room = layer_room_create(mapping);
    if (!self->room)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a layer");
    if (result >= 0)
        result = hands_create(&self->hands, &settings->hands, err);
    if (result < 0)
        goto fail;
    use_mapping(self, mapping);
    result = activate(self, err);
    if (result < 0) {
        self->mapping = NULL; /* nothing to deactivate */
        goto fail;
    }
    layer_reset(self);
    instance_latch(mapping);
    memcpy(self->room->last_params, mapping->params,
           mapping->type->param_count * sizeof *self->room->last_params);
    *out = self;
    return MRT_OK;
fail:
    layer_destroy(self);
    return result;
}

void layer_destroy(layer *self)
{
    if (!self)
        return;
    if (self->mapping)
        self->functions->deactivate(self->mapping->self);
    hands_destroy(self->hands);
    layer_room_destroy(self->room);
    free(self);
}

/* ---- from one who pulls to another ---- */

void layer_cut(layer *self)
{
    if (!self->cut.is_waiting) /* else what was pulled before still leaves */
        self->cut.leaving = *layer_pull(self);
    if (self->cut.is_homing) /* the one before did not come to pull */
        self->good = self->cut.leaving;
    self->cut.is_homing = false;
    self->cut.is_waiting = true;
}

instance *layer_switch(layer *self, instance *mapping, layer_room *room)
{
    instance *old = self->mapping;
    layer_cut(self);
    use_mapping(self, mapping);
    layer_room_destroy(self->room);
    self->room = room;
    return old;
}

instance *layer_replace(layer *self, instance *mapping, layer_room *room, const float *posed)
{
    instance *old = layer_switch(self, mapping, room);
    self->cut.is_other = true;
    memcpy(self->cut.posed, posed, sizeof self->cut.posed);
    let_bones_go(&self->pull); /* the new one may say nothing of what the old one drove */
    return old;
}

bool layer_is_between(const layer *self)
{
    return self->cut.is_waiting || self->cut.is_fading;
}

bool layer_is_fading(const layer *self)
{
    return self->cut.is_fading;
}

double layer_weight(const layer *self)
{
    return self->cut.is_fading ? fmin(self->cut.fade_s / LAYER_FADE_S, 1.0) : 1.0;
}

const mrt_pull *layer_leaving(const layer *self)
{
    return self->cut.is_fading && self->cut.is_leaving ? &self->cut.leaving : NULL;
}

uint32_t layer_side(const layer *self)
{
    return self->cut.side;
}

/* Free points are taken hold of elsewhere: the two pulls cannot be laid over each other. */
static bool holds_elsewhere(const mrt_pull *a, const mrt_pull *b)
{
    if (a->mode != MRT_ANCHORED || b->mode != MRT_ANCHORED)
        return false;
    bool has_free = false;
    for (uint32_t i = 0; i < b->count; ++i)
        has_free |= b->vector[i].contact == 0;
    for (uint32_t i = 0; i < a->count; ++i)
        has_free |= a->vector[i].contact == 0;
    if (!has_free)
        return false;
    for (uint32_t i = 0; i < a->count && a->count == b->count; ++i)
        if (memcmp(&a->vector[i].start, &b->vector[i].start, sizeof a->vector[i].start) != 0 ||
            a->vector[i].contact != b->vector[i].contact)
            return true;
    return a->count != b->count;
}

static bool drives_bones(const mrt_pull *pull)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        if (!isnan(pull->dof[i]))
            return true;
    return false;
}

/* Of a bone that the old one drove the new one says nothing: it would stay as it is for good. */
static bool leaves_bones(const layer *self, const mrt_pull *leaving, const mrt_pull *new)
{
    for (uint32_t i = 0; i < self->about->dof_count; ++i)
        if (!isnan(leaving->dof[i]) && isnan(new->dof[i]))
            return true;
    return false;
}

/* What vectors have done to a jaw that is driven from now on is eased from there. */
static void leave_posed(cut *c, const mrt_pull *new)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        if (isnan(c->leaving.dof[i]) && !isnan(new->dof[i]))
            c->leaving.dof[i] = c->posed[i];
}

mrt_pull layer_home(const mrt_pull *leaving)
{
    mrt_pull out = {.mode = MRT_ANCHORED, .commit = leaving->commit};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        out.dof[i] = isnan(leaving->dof[i]) ? NAN : 0.0f;
    return out;
}

/* What was pulled eases to rest; then the new one takes hold of that (begin_at_home). */
static void go_home(layer *self)
{
    cut *c = &self->cut;
    c->shown = layer_home(&c->leaving);
    c->is_waiting = c->is_other = false;
    c->is_fading = c->is_leaving = c->is_homing = true;
    c->fade_s = self->frame.dt_s;
    c->side = 1 - c->side;
    c->anchor_shift = 0;
}

/* The first pull of the new one says how it comes. While it is idle the shape stays as it is. */
static void begin_fade(layer *self)
{
    cut *c = &self->cut;
    const mrt_pull *new = &self->good;
    if (new->mode == MRT_IDLE)
        return;
    if (c->is_other && leaves_bones(self, &c->leaving, new)) {
        go_home(self);
        return;
    }
    if (c->is_other)
        leave_posed(c, new);
    bool stays = holds_elsewhere(&c->leaving, new);
    bool kneads_on = c->leaving.mode == MRT_UNANCHORED && new->mode == MRT_UNANCHORED;
    c->is_waiting = c->is_other = false;
    c->is_fading = true;
    c->fade_s = self->frame.dt_s;
    c->is_leaving = !stays && !kneads_on;
    if (c->is_leaving) {
        c->side = 1 - c->side;
        c->anchor_shift = 0;
        return;
    }
    if (stays) { /* the skin; bones do not */
        c->leaving.count = 0;
        c->is_leaving = drives_bones(&c->leaving);
    }
    if (stays && new->anchor + c->anchor_shift == c->leaving.anchor) {
        c->anchor_shift += 1;
    }
}

static void begin_at_home(layer *self)
{
    cut *c = &self->cut;
    c->is_homing = false;
    c->is_waiting = true;
    c->leaving = c->shown;
    let_bones_go(&c->leaving);
    let_bones_go(&self->pull);
    self->good = c->leaving;
    self->functions->reset(self->mapping->self);
}

/* Before a sample. */
static void go_on_fading(layer *self)
{
    cut *c = &self->cut;
    if (!c->is_fading)
        return;
    c->fade_s += self->frame.dt_s;
    c->is_fading = c->fade_s < LAYER_FADE_S;
    if (!c->is_fading && c->is_homing)
        begin_at_home(self);
}

static void show_good(layer *self)
{
    cut *c = &self->cut;
    if (c->is_waiting)
        begin_fade(self);
    if (c->is_homing || c->anchor_shift == 0)
        return;
    c->shown = self->good;
    c->shown.anchor += c->anchor_shift;
}

/* ---- steps 4 and 5: the mapping and the guard ---- */

static void tell_params(layer *self, int64_t time_ns)
{
    const mrt_plugin_type *type = self->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = self->mapping->params[i];
        if (memcmp(&value, &self->room->last_params[i], sizeof value) == 0)
            continue;
        self->room->last_params[i] = value;
        if (self->on_param)
            self->on_param(self->on_param_data, time_ns, type->params[i].id, value);
    }
}

/* What the mapping sees as its own last pull. */
static void give_back_good(layer *self)
{
    self->pull = self->good;
    if (self->cut.is_waiting) /* still another's, or of before it was to begin anew */
        let_bones_go(&self->pull);
}

/* Fills self->good with what the mapping wants now, if it makes sense. */
static void run_mapping(layer *self, int64_t time_ns)
{
    instance_latch(self->mapping);
    tell_params(self, time_ns);
    self->frame.params = self->mapping->params;
    if (self->seam && !layer_is_fading(self) &&
        self->seam->take_turn(self->mapping->self, &self->pull))
        layer_cut(self);
    mrt_result result = self->functions->process(self->mapping->self, &self->frame, &self->pull);
    if (result == MRT_HOLD) {
        give_back_good(self);
        return;
    }
    const char *fault = result < 0 ? "an error" : guard_fault(&self->guard, &self->pull);
    if (!fault) {
        self->good = self->pull;
        show_good(self);
        return;
    }
    self->counts.bad_pulls += 1;
    if (!self->counts.first_problem.text[0])
        error_set(&self->counts.first_problem, MRT_ERR_FORMAT, "mapping %s gave %s",
                  self->mapping->type->id, fault);
    give_back_good(self); /* "on entry: what it held last" stays sane */
}

static void read_pointer(layer *self, const sample_step *s)
{
    pointer_grip before = self->pointer.grip;
    (void)pointer_read(&self->pointer, self->about, s, self->frame.time_ns);
    self->resets |= self->pointer.grip == POINTER_NEUTRAL && before != POINTER_NEUTRAL;
    const char *fault = guard_fault(&self->guard, &self->pointer.pull);
    if (!fault)
        fault = guard_fault(&self->guard, &self->pointer.places);
    if (!fault)
        return;
    self->counts.bad_pulls += 1;
    if (!self->counts.first_problem.text[0])
        error_set(&self->counts.first_problem, MRT_ERR_FORMAT, "the pointer gave %s", fault);
    pointer_reset(&self->pointer);
}

static void begin_anew(layer *self)
{
    if (!self->resets || layer_is_fading(self))
        return;
    self->resets = false;
    layer_cut(self);
    let_bones_go(&self->pull);
    keep_taught(self);
    self->functions->reset(self->mapping->self);
}

void layer_step(layer *self, const sample_step *s, bool near)
{
    int64_t time_ns = s->time_ns;
    if (self->has_time && time_ns < self->frame.time_ns)
        time_ns = self->frame.time_ns;
    uint64_t since_ns = (uint64_t)time_ns - (uint64_t)self->frame.time_ns; /* records may lie */
    double dt_s = self->has_time ? (double)since_ns / (double)NS_PER_S : 0.0;
    self->frame.dt_s = fmin(dt_s, dt_max_s);
    self->frame.time_ns = time_ns;
    self->frame.near = near;
    self->has_time = true;
    self->counts.samples += s->count;
    self->counts.steps += 1;
    hands_read(self->hands, s, &self->frame);
    go_on_fading(self);
    read_pointer(self, s);
    begin_anew(self);
    run_mapping(self, s->time_ns);
}

const mrt_pull *layer_pull(const layer *self)
{
    const cut *c = &self->cut;
    return c->is_homing || c->anchor_shift ? &c->shown : &self->good;
}

const mrt_frame *layer_frame(const layer *self)
{
    return &self->frame;
}

instance *layer_mapping(layer *self)
{
    return self->mapping;
}

const pointer *layer_pointer(const layer *self)
{
    return &self->pointer;
}

hands *layer_hands(layer *self)
{
    return self->hands;
}

void layer_watch_params(layer *self, layer_on_param *on_param, void *data)
{
    self->on_param = on_param;
    self->on_param_data = data;
}

const layer_counts *layer_counted(const layer *self)
{
    return &self->counts;
}

static void shift(int64_t *time_ns, int64_t by_ns)
{
    *time_ns = (int64_t)((uint64_t)*time_ns + (uint64_t)by_ns);
}

void layer_shift_time(layer *self, int64_t by_ns)
{
    hands_shift_time(self->hands, by_ns);
    pointer_shift_time(&self->pointer, by_ns);
    shift(&self->frame.time_ns, by_ns);
    for (int side = 0; side < 2; ++side)
        shift(&self->frame.hand[side].time_ns, by_ns);
}
