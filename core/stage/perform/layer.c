#include "stage/perform/layer_state.h"
#include "base/clock.h"
#include "stage/plugins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double dt_max_s = 0.1;

void layer_reset(layer *self)
{
    self->frame = (mrt_frame){0};
    self->pull = (mrt_pull){0};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        self->pull.dof[i] = NAN;
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
    if (room->last_params && room->stored_params)
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

/* The first pull of the new one says how it comes. While it is idle the shape stays as it is. */
static void begin_fade(layer *self)
{
    cut *c = &self->cut;
    const mrt_pull *new = &self->good;
    if (new->mode == MRT_IDLE)
        return;
    bool stays = holds_elsewhere(&c->leaving, new);
    bool kneads_on = c->leaving.mode == MRT_UNANCHORED && new->mode == MRT_UNANCHORED;
    c->is_waiting = false;
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

/* Before a sample. */
static void go_on_fading(layer *self)
{
    cut *c = &self->cut;
    if (!c->is_fading)
        return;
    c->fade_s += self->frame.dt_s;
    c->is_fading = c->fade_s < LAYER_FADE_S;
}

static void show_good(layer *self)
{
    cut *c = &self->cut;
    if (c->is_waiting)
        begin_fade(self);
    if (c->anchor_shift == 0)
        return;
    c->shown = self->good;
    c->shown.anchor += c->anchor_shift;
}

/* ---- steps 4 and 5: the mapping and the guard ---- */

static void tell_params(layer *self, const mrt_sample *sample)
{
    const mrt_plugin_type *type = self->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = self->mapping->params[i];
        if (memcmp(&value, &self->room->last_params[i], sizeof value) == 0)
            continue;
        self->room->last_params[i] = value;
        if (self->on_param)
            self->on_param(self->on_param_data, sample, type->params[i].id, value);
    }
}

/* Fills self->good with what the mapping wants now, if it makes sense. */
static void run_mapping(layer *self, const mrt_sample *sample)
{
    instance_latch(self->mapping);
    tell_params(self, sample);
    self->frame.params = self->mapping->params;
    if (self->seam && !layer_is_fading(self) &&
        self->seam->take_turn(self->mapping->self, &self->pull))
        layer_cut(self);
    mrt_result result = self->functions->process(self->mapping->self, &self->frame, &self->pull);
    if (result == MRT_HOLD) {
        self->pull = self->good;
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
    self->pull = self->good; /* "on entry: what it held last" stays sane */
}

static void read_pointer(layer *self, const channel_route *route, const mrt_sample *sample)
{
    mrt_sample in_time = *sample;
    in_time.time_ns = self->frame.time_ns;
    pointer_grip before = self->pointer.grip;
    (void)pointer_read(&self->pointer, self->about, route, &in_time);
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
    self->functions->reset(self->mapping->self);
}

void layer_sample(layer *self, const channel_route *route, const mrt_sample *sample, bool near)
{
    int64_t time_ns = sample->time_ns;
    if (self->has_time && time_ns < self->frame.time_ns)
        time_ns = self->frame.time_ns;
    uint64_t since_ns = (uint64_t)time_ns - (uint64_t)self->frame.time_ns; /* records may lie */
    double dt_s = self->has_time ? (double)since_ns / (double)NS_PER_S : 0.0;
    self->frame.dt_s = fmin(dt_s, dt_max_s);
    self->frame.time_ns = time_ns;
    self->frame.near = near;
    self->has_time = true;
    self->counts.samples += 1;
    hands_read(self->hands, route, sample, &self->frame);
    go_on_fading(self);
    read_pointer(self, route, sample);
    begin_anew(self);
    run_mapping(self, sample);
}

const mrt_pull *layer_pull(const layer *self)
{
    return self->cut.anchor_shift ? &self->cut.shown : &self->good;
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
