#include "stage/perform/layer.h"
#include "base/bytes.h"
#include "base/clock.h"
#include "stage/mapping/isolate.h"
#include "stage/mapping/plugins.h"
#include "stage/mapping/taught.h"
#include "stage/mapping/guard.h"
#include "stage/perform/frame_inputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct layer_room {
    double *last_params;   /* of the sample before */
    double *stored_params; /* while a state is loaded */
    double *patched_params;
    unsigned char
        *taught; /* TAUGHT_BYTES_MAX, while the mapping is reset; NULL: it learns nothing */
};

/* The cross-fade from the last pull to the first ones of a mapping that takes over. */
typedef struct crossfade {
    bool is_waiting; /* for the first pull of the new mapping */
    bool is_other;   /* while waiting: another mapping, not a newer build of the same */
    bool is_fading;
    bool is_leaving; /* while fading: `leaving` is seen */
    bool is_homing;  /* while fading: to rest; the new mapping begins after that (go_home) */
    double fade_s;
    uint32_t side;
    uint32_t anchor_shift;     /* added to the mapping's anchors */
    float posed[MRT_MAX_DOFS]; /* is_other: the degrees of freedom at the switch */
    mrt_pull leaving;
    mrt_pull shown; /* what layer_pull gives instead of `good` while anchor_shift or is_homing */
} crossfade;

/* The target of homing: no control vectors, and the bones that `leaving` drove at rest. */
static mrt_pull layer_home(const mrt_pull *leaving);

struct layer {
    instance *mapping;
    const mrt_mapping *functions;
    const mrt_resume *resume;         /* NULL: it has none */
    const isolate_takeover *takeover; /* NULL: it runs here */
    answers *answers;                 /* NULL: neither written down nor given again */
    const mrt_face *about;
    guard guard;
    layer_settings settings;
    hands *hands;
    frame_inputs inputs;
    patch_bay bay;
    pointer pointer;
    bool resets;          /* the mapping is to be reset as soon as its state is known */
    uint32_t reset_waits; /* steps, for what it was taught */
    mrt_frame frame;
    mrt_pull pull; /* what the mapping fills; it sees its own last values */
    mrt_pull good; /* the last that passed the guard */
    crossfade crossfade;
    bool has_time;
    layer_room *room;
    layer_on_param *on_param;
    void *on_param_data;
    layer_counts counts;
};

static const double dt_max_s = 0.1;
static const uint32_t reset_waits_most = 100;

static void let_bones_go(mrt_pull *pull)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
}

static bool is_answered(const layer *self)
{
    return self->answers && self->answers->is_given;
}

void layer_set_answers(layer *self, answers *of)
{
    self->answers = of;
}

/* Asks the mapping for what it was taught, which a reset gives back to it. False: no answer yet, as
 * an isolated mapping may be late. */
static bool keep_taught(layer *self)
{
    error ignored = {""};
    unsigned char *bytes = self->room->taught;
    if (!self->settings.keeps_taught || !bytes)
        return true;
    if (is_answered(self)) {
        const answers_step *then = answers_find(self->answers, self->frame.time_ns);
        return then && then->is_taught;
    }
    size_t size = taught_save(self->mapping, bytes, TAUGHT_BYTES_MAX);
    bool is_taught = size > 0 && taught_load(self->mapping, bytes, size, &ignored) >= 0;
    if (self->answers)
        self->answers->is_taught = is_taught;
    return is_taught;
}

void layer_begin_anew(layer *self)
{
    (void)keep_taught(self);
    layer_reset(self);
}

void layer_reset(layer *self)
{
    self->frame = (mrt_frame){0};
    self->pull = (mrt_pull){0};
    let_bones_go(&self->pull);
    self->good = self->pull;
    self->crossfade = (crossfade){.side = 0};
    self->has_time = false;
    self->resets = false;
    hands_reset(self->hands);
    frame_inputs_reset(&self->inputs);
    patch_bay_reset(&self->bay);
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
    room->patched_params = calloc(count, sizeof *room->patched_params);
    bool learns = plugin_interface(mapping->type, MRT_STATE) != NULL;
    if (learns)
        room->taught = malloc(TAUGHT_BYTES_MAX);
    if (room->last_params && room->stored_params && room->patched_params &&
        (room->taught || !learns))
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
    free(room->patched_params);
    free(room->taught);
    free(room);
}

static void use_mapping(layer *self, instance *mapping)
{
    self->mapping = mapping;
    self->functions = plugin_interface(mapping->type, MRT_MAPPING);
    self->resume = plugin_interface(mapping->type, MRT_RESUME);
    self->takeover = plugin_interface(mapping->type, ISOLATE_TAKEOVER);
}

mrt_result layer_create(layer **out, instance *mapping, const mapped_face *mapped,
                        const layer_settings *settings, error *err)
{
    *out = NULL;
    layer *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a layer");
    self->about = &mapped->about;
    self->settings = *settings;
    self->guard = (guard){.contact_count = mapped->about.contact_count,
                          .centre = settings->centre,
                          .reach_mm = settings->reach_mm};
    patch_bay_init(&self->bay, &self->guard);
    mrt_result result = MRT_OK;
    self->room = layer_room_create(mapping);
    if (!self->room)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a layer");
    if (result >= 0)
        result = hands_create(&self->hands, &settings->hands, err);
    if (result < 0)
        goto fail;
    use_mapping(self, mapping);
    result = instance_activate(mapping, mapped, err);
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
    patch_bay_finish(&self->bay);
    layer_room_destroy(self->room);
    free(self);
}

/* ---- cross-fade between mappings ---- */

void layer_crossfade(layer *self)
{
    if (!self->crossfade.is_waiting) /* else what was pulled before still leaves */
        self->crossfade.leaving = *layer_pull(self);
    if (self->crossfade.is_homing) /* the one before did not come to pull */
        self->good = self->crossfade.leaving;
    self->crossfade.is_homing = false;
    self->crossfade.is_waiting = true;
}

instance *layer_switch(layer *self, instance *mapping, layer_room **room)
{
    instance *old = self->mapping;
    layer_crossfade(self);
    use_mapping(self, mapping);
    layer_room *had = self->room;
    self->room = *room;
    *room = had;
    return old;
}

instance *layer_replace(layer *self, instance *mapping, layer_room **room, const float *posed)
{
    instance *old = layer_switch(self, mapping, room);
    self->crossfade.is_other = true;
    memcpy(self->crossfade.posed, posed, sizeof self->crossfade.posed);
    let_bones_go(
        &self->pull); /* `pull` is in and out: do not hand the old mapping's bones to the new one */
    return old;
}

bool layer_is_fading(const layer *self)
{
    return self->crossfade.is_fading;
}

double layer_weight(const layer *self)
{
    return self->crossfade.is_fading ? fmin(self->crossfade.fade_s / LAYER_FADE_S, 1.0) : 1.0;
}

const mrt_pull *layer_leaving(const layer *self)
{
    return self->crossfade.is_fading && self->crossfade.is_leaving ? &self->crossfade.leaving
                                                                   : NULL;
}

uint32_t layer_side(const layer *self)
{
    return self->crossfade.side;
}

/* Two anchored pulls whose free points differ cannot be blended: a new engagement is needed. */
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

/* A bone that only the old mapping drove would stay as it left it. */
static bool leaves_bones(const layer *self, const mrt_pull *leaving, const mrt_pull *new)
{
    for (uint32_t i = 0; i < self->about->dof_count; ++i)
        if (!isnan(leaving->dof[i]) && isnan(new->dof[i]))
            return true;
    return false;
}

/* A jaw that vectors moved and that the new mapping drives fades from where it was at the switch.
 */
static void leave_posed(crossfade *c, const mrt_pull *new)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        if (isnan(c->leaving.dof[i]) && !isnan(new->dof[i]))
            c->leaving.dof[i] = c->posed[i];
}

static mrt_pull layer_home(const mrt_pull *leaving)
{
    mrt_pull out = {.mode = MRT_ANCHORED, .commit = leaving->commit};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        out.dof[i] = isnan(leaving->dof[i]) ? NAN : 0.0f;
    return out;
}

/* The old pull fades to rest; then the new mapping engages there (begin_at_home). */
static void go_home(layer *self)
{
    crossfade *c = &self->crossfade;
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
    crossfade *c = &self->crossfade;
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
    crossfade *c = &self->crossfade;
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
    crossfade *c = &self->crossfade;
    if (!c->is_fading)
        return;
    c->fade_s += self->frame.dt_s;
    c->is_fading = c->fade_s < LAYER_FADE_S;
    if (!c->is_fading && c->is_homing)
        begin_at_home(self);
}

static void show_good(layer *self)
{
    crossfade *c = &self->crossfade;
    if (c->is_waiting)
        begin_fade(self);
    if (c->is_homing || c->anchor_shift == 0)
        return;
    c->shown = self->good;
    c->shown.anchor += c->anchor_shift;
}

/* ---- phases 4 and 5: the mapping and the guard ---- */

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

/* Gives the mapping, whose pull is in and out, the last one that was used. */
static void give_back_good(layer *self)
{
    self->pull = self->good;
    if (self->crossfade.is_waiting) /* `good` is the old mapping's, or of before the reset */
        let_bones_go(&self->pull);
}

static mrt_result ask_mapping(layer *self)
{
    if (is_answered(self))
        return answers_take(self->answers, self->frame.time_ns, &self->pull);
    if (self->takeover && !layer_is_fading(self) &&
        self->takeover->take_over(self->mapping->self, &self->pull))
        layer_crossfade(self);
    mrt_result result = self->functions->process(self->mapping->self, &self->frame, &self->pull);
    if (self->answers)
        answers_add(self->answers, self->frame.time_ns, result, &self->pull);
    return result;
}

/* Runs process(). Leaves self->good as it was on MRT_HOLD, on an error and on a faulty pull. */
static void run_mapping(layer *self, int64_t time_ns)
{
    instance_latch(self->mapping);
    tell_params(self, time_ns);
    patch_bay_step(&self->bay, &self->frame, self->mapping->type, self->mapping->params,
                   &self->good);
    self->frame.params = self->mapping->params;
    if (self->bay.plan) {
        patch_bay_params(&self->bay, self->mapping->params, self->room->patched_params);
        self->frame.params = self->room->patched_params;
    }
    mrt_result result = ask_mapping(self);
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
    give_back_good(self); /* plugin.h: "on entry: what it held last" */
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
    if (!keep_taught(self) && self->takeover && self->reset_waits++ < reset_waits_most)
        return;
    self->resets = false;
    self->reset_waits = 0;
    layer_crossfade(self);
    let_bones_go(&self->pull);
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
    frame_inputs_read(&self->inputs, s, time_ns);
    self->frame.inputs = self->inputs.shown;
    self->frame.input_count = self->inputs.count;
    go_on_fading(self);
    read_pointer(self, s);
    begin_anew(self);
    run_mapping(self, s->time_ns);
}

const mrt_pull *layer_pull(const layer *self)
{
    const crossfade *c = &self->crossfade;
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

bool layer_set_pointer(layer *self, const void *bytes, size_t size)
{
    const pointer before = self->pointer;
    if (pointer_load(&self->pointer, bytes, size) &&
        !guard_fault(&self->guard, &self->pointer.pull) &&
        !guard_fault(&self->guard, &self->pointer.places)) {
        self->pointer.time_ns = before.time_ns;
        return true;
    }
    self->pointer = before;
    return false;
}

hands *layer_hands(layer *self)
{
    return self->hands;
}

const patch_bay *layer_bay(const layer *self)
{
    return &self->bay;
}

bool layer_set_patch(layer *self, patch_plan *plan, patch_plan **out_old)
{
    return patch_bay_set(&self->bay, plan, out_old);
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
    frame_inputs_shift_time(&self->inputs, by_ns);
    pointer_shift_time(&self->pointer, by_ns);
    shift(&self->frame.time_ns, by_ns);
    for (int side = 0; side < 2; ++side)
        shift(&self->frame.hand[side].time_ns, by_ns);
}

enum { STORE_VERSION = 1, STORE_WITH_CUT = 2, STORE_WITH_POINTER = 3, STORE_WITH_INPUTS = 4 };
enum {
    STORE_OTHER = 2,
    STORE_HOMING = 2
}; /* values of the stored is_waiting and is_fading beyond true */

/* A nested state, preceded by its size. */
static void put_sized(bytes_out *out, size_t (*save)(void *of, void *bytes, size_t capacity),
                      void *of)
{
    size_t size = save(of, NULL, 0);
    bytes_put_u32(out, (uint32_t)size);
    if (out->data && out->size <= out->capacity && size <= out->capacity - out->size)
        save(of, out->data + out->size, size);
    out->size += size;
}

static size_t save_hands(void *of, void *bytes, size_t capacity)
{
    return hands_save(of, bytes, capacity);
}

static size_t save_mapping(void *of, void *bytes, size_t capacity)
{
    layer *self = of;
    return is_answered(self) ? 0 : self->resume->save(self->mapping->self, bytes, capacity);
}

static void take_pull(bytes_in *in, const layer *self, mrt_pull *out)
{
    uint32_t kept = answers_take_pull(in, out);
    in->failed = in->failed || kept < out->count || guard_fault(&self->guard, out) != NULL;
}

static const unsigned char *take_sized(bytes_in *in, size_t *out_size)
{
    *out_size = bytes_take_u32(in);
    const unsigned char *at = in->at;
    if (in->failed || *out_size > (size_t)(in->end - in->at)) {
        in->failed = true;
        return NULL;
    }
    in->at += *out_size;
    return at;
}

static void put_crossfade(bytes_out *out, const crossfade *c)
{
    bytes_put_u32(out, c->is_other ? STORE_OTHER : c->is_waiting);
    bytes_put_u32(out, c->is_homing ? STORE_HOMING : c->is_fading);
    bytes_put_u32(out, c->is_leaving);
    bytes_put_f64(out, c->fade_s);
    bytes_put_u32(out, c->side);
    bytes_put_u32(out, c->anchor_shift);
    answers_put_pull(out, &c->leaving);
    if (c->is_other)
        bytes_put(out, c->posed, sizeof c->posed);
}

static void take_crossfade(bytes_in *in, layer *self)
{
    crossfade *c = &self->crossfade;
    uint32_t waiting = bytes_take_u32(in);
    c->is_waiting = waiting != 0;
    c->is_other = waiting == STORE_OTHER;
    uint32_t fading = bytes_take_u32(in);
    c->is_fading = fading != 0;
    c->is_homing = fading == STORE_HOMING;
    c->is_leaving = bytes_take_u32(in) != 0;
    c->fade_s = bytes_take_f64(in);
    c->side = bytes_take_u32(in);
    c->anchor_shift = bytes_take_u32(in);
    take_pull(in, self, &c->leaving);
    if (c->is_other)
        bytes_take(in, c->posed, sizeof c->posed);
    for (uint32_t i = 0; c->is_other && i < MRT_MAX_DOFS; ++i)
        in->failed |= !isfinite(c->posed[i]);
    c->shown = c->is_homing ? layer_home(&c->leaving) : self->good;
    c->shown.anchor += c->anchor_shift;
    in->failed = in->failed || c->side > 1 || !(c->fade_s >= 0.0);
}

static size_t save_pointer(void *of, void *bytes, size_t capacity)
{
    return pointer_save(of, bytes, capacity);
}

static size_t save_inputs(void *of, void *bytes, size_t capacity)
{
    return frame_inputs_save(of, bytes, capacity);
}

static size_t save_bay(void *of, void *bytes, size_t capacity)
{
    return patch_bay_save(of, bytes, capacity);
}

size_t layer_save(layer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    const mrt_plugin_type *type = self->mapping->type;
    if (!is_answered(self) && (!self->resume || save_mapping(self, NULL, 0) == 0))
        return 0;
    bytes_put_u32(&out, STORE_WITH_INPUTS);
    bytes_put_u32(&out, type->param_count);
    for (uint32_t i = 0; i < type->param_count; ++i) {
        bytes_put_u32(&out, type->params[i].id);
        bytes_put_f64(&out, self->room->last_params[i]);
    }
    bytes_put_u32(&out, self->has_time);
    bytes_put(&out, &self->frame.time_ns, sizeof self->frame.time_ns);
    bytes_put(&out, self->frame.pedal, sizeof self->frame.pedal);
    for (int side = 0; side < 2; ++side) {
        const mrt_hand *hand = &self->frame.hand[side];
        bytes_put_u32(&out, hand->present);
        bytes_put(&out, &hand->time_ns, sizeof hand->time_ns);
        bytes_put(&out, hand->angle, sizeof hand->angle);
        bytes_put(&out, hand->joint, sizeof hand->joint);
        bytes_put(&out, hand->palm, sizeof hand->palm);
    }
    answers_put_pull(&out, &self->good);
    answers_put_pull(&out, &self->pull);
    put_crossfade(&out, &self->crossfade);
    bytes_put_u32(&out, self->resets);
    put_sized(&out, save_pointer, &self->pointer);
    put_sized(&out, save_inputs, &self->inputs);
    put_sized(&out, save_bay, &self->bay);
    put_sized(&out, save_hands, self->hands);
    put_sized(&out, save_mapping, self);
    return out.size;
}

static void take_params(bytes_in *in, layer *self)
{
    const mrt_plugin_type *type = self->mapping->type;
    in->failed |= bytes_take_u32(in) != type->param_count;
    for (uint32_t i = 0; i < type->param_count && !in->failed; ++i) {
        in->failed |= bytes_take_u32(in) != type->params[i].id;
        double value = bytes_take_f64(in);
        in->failed |= !(value >= type->params[i].min && value <= type->params[i].max);
        self->room->stored_params[i] = value;
    }
}

static void use_stored_params(layer *self)
{
    const mrt_plugin_type *type = self->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = self->room->stored_params[i];
        bool is_button = type->params[i].flags & MRT_PARAM_TRIGGER; /* it was let go since */
        self->room->last_params[i] = value;
        self->mapping->params[i] = value;
        atomic_store(&self->mapping->wanted[i], is_button ? type->params[i].initial : value);
    }
}

static bool are_finite(const float *value, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (!isfinite(value[i]))
            return false;
    return true;
}

static bool points_are_finite(const mrt_vec3 *point, size_t count)
{
    for (size_t i = 0; i < count; ++i)
        if (!isfinite(point[i].x) || !isfinite(point[i].y) || !isfinite(point[i].z))
            return false;
    return true;
}

static void take_frame(bytes_in *in, mrt_frame *frame)
{
    bytes_take(in, frame->pedal, sizeof frame->pedal);
    in->failed |= !are_finite(frame->pedal, MRT_MAX_PEDALS);
    for (int side = 0; side < 2; ++side) {
        mrt_hand *hand = &frame->hand[side];
        hand->present = bytes_take_u32(in) != 0;
        bytes_take(in, &hand->time_ns, sizeof hand->time_ns);
        bytes_take(in, hand->angle, sizeof hand->angle);
        bytes_take(in, hand->joint, sizeof hand->joint);
        bytes_take(in, hand->palm, sizeof hand->palm);
        in->failed |= !are_finite(hand->angle, MRT_ANGLES) ||
                      !points_are_finite(hand->joint, MRT_JOINTS) ||
                      !points_are_finite(hand->palm, MRT_PALM);
    }
}

static void take_pointer(bytes_in *in, layer *self)
{
    size_t size = 0;
    self->resets = bytes_take_u32(in) != 0;
    const unsigned char *bytes = take_sized(in, &size);
    in->failed |= !bytes || !pointer_load(&self->pointer, bytes, size) ||
                  guard_fault(&self->guard, &self->pointer.pull) ||
                  guard_fault(&self->guard, &self->pointer.places);
}

static void take_inputs_and_bay(bytes_in *in, layer *self)
{
    size_t size = 0;
    const unsigned char *bytes = take_sized(in, &size);
    in->failed |= !bytes || !frame_inputs_load(&self->inputs, bytes, size);
    bytes = take_sized(in, &size);
    in->failed |= !bytes || !patch_bay_load(&self->bay, bytes, size);
}

static mrt_result load(layer *self, bytes_in *in, error *err)
{
    if (!self->resume && !is_answered(self))
        return error_set(err, MRT_ERR_UNSUPPORTED, "mapping %s cannot be resumed",
                         self->mapping->type->id);
    uint32_t version = bytes_take_u32(in);
    in->failed |= version < STORE_VERSION || version > STORE_WITH_INPUTS;
    take_params(in, self);
    self->has_time = bytes_take_u32(in) != 0;
    bytes_take(in, &self->frame.time_ns, sizeof self->frame.time_ns);
    take_frame(in, &self->frame);
    take_pull(in, self, &self->good);
    take_pull(in, self, &self->pull);
    if (version >= STORE_WITH_CUT && !in->failed)
        take_crossfade(in, self);
    if (version >= STORE_WITH_POINTER && !in->failed)
        take_pointer(in, self);
    if (version >= STORE_WITH_INPUTS && !in->failed)
        take_inputs_and_bay(in, self);
    else if (self->bay.plan)
        in->failed = true; /* it was performed without a patch */
    size_t size = 0;
    const unsigned char *bytes = take_sized(in, &size);
    in->failed |= !bytes || !hands_load(self->hands, bytes, size);
    bytes = take_sized(in, &size);
    if (in->failed || in->at != in->end)
        return error_set(err, MRT_ERR_FORMAT, "the stored state of mapping %s is damaged",
                         self->mapping->type->id);
    if (!is_answered(self) && self->resume->load(self->mapping->self, bytes, size) < 0)
        return error_set(err, MRT_ERR_FORMAT, "mapping %s refuses its stored state",
                         self->mapping->type->id);
    use_stored_params(self);
    return MRT_OK;
}

mrt_result layer_load(layer *self, const void *bytes, size_t size, error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    layer_reset(self);
    mrt_result result = load(self, &in, err);
    if (result < 0)
        layer_reset(self);
    return result;
}
