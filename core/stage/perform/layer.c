#include "stage/perform/layer.h"
#include "base/bytes.h"
#include "stage/mapping/plugins.h"
#include "stage/mapping/taught.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Returns the target of HOME: no control vectors, and the bones that `leaving` drove are at rest.
 */
static mrt_pull layer_home(const mrt_pull *leaving);

static const uint32_t reset_waits_most = 100;

static void release_bones(mrt_pull *pull)
{
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        pull->dof[i] = NAN;
}

bool layer_is_answered(const layer *self)
{
    return self->answers && self->answers->is_given;
}

/* Saves the taught values of the mapping and loads them again, so that they survive the next reset.
 * Returns false if an isolated mapping has not answered yet. */
static bool keep_taught(layer *self)
{
    error ignored = {""};
    unsigned char *bytes = self->room->taught;
    if (!self->settings.keeps_taught || !bytes)
        return true;
    if (layer_is_answered(self)) {
        const answers_step *then = answers_find(self->answers, self->frame.time_ns);
        return then && then->is_taught;
    }
    size_t size = taught_save(self->mapping, bytes, TAUGHT_BYTES_MAX);
    bool is_taught = size > 0 && taught_load(self->mapping, bytes, size, &ignored) >= 0;
    if (self->answers)
        self->answers->is_taught = is_taught;
    return is_taught;
}

void layer_reset_keep_taught(layer *self)
{
    (void)keep_taught(self);
    layer_reset(self);
}

void layer_reset(layer *self)
{
    self->frame = (mrt_frame){0};
    self->good = self->pull = guard_idle();
    self->crossfade = (crossfade){.state = CROSSFADE_NONE};
    self->has_time = false;
    self->resets = false;
    hands_reset(self->hands);
    frame_inputs_reset(&self->inputs);
    patch_bay_reset(&self->bay);
    pointer_reset(&self->pointer);
    palette_reset(&self->palette);
    life_reset(&self->life);
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
    palette_init(&self->palette, mapped);
    life_init(&self->life, mapped);
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

static bool is_waiting(const crossfade *c)
{
    return c->state == CROSSFADE_WAITS || c->state == CROSSFADE_WAITS_OTHER;
}

bool layer_is_fading(const layer *self)
{
    return self->crossfade.state >= CROSSFADE_IN;
}

double layer_weight(const layer *self)
{
    return layer_is_fading(self) ? fmin(self->crossfade.fade_s / LAYER_FADE_S, 1.0) : 1.0;
}

const mrt_pull *layer_leaving(const layer *self)
{
    return self->crossfade.state >= CROSSFADE_OVER ? &self->crossfade.leaving : NULL;
}

const mrt_pull *layer_pull(const layer *self)
{
    const crossfade *c = &self->crossfade;
    return c->state == CROSSFADE_HOME || c->anchor_shift ? &c->shown : &self->good;
}

/* All transitions (layer.h has the diagram). */
static void enter(layer *self, crossfade_state to)
{
    crossfade *c = &self->crossfade;
    crossfade_state from = c->state;
    c->state = to;
    switch (to) {
    case CROSSFADE_NONE:
        break;
    case CROSSFADE_WAITS:
        if (from == CROSSFADE_HOME) { /* the new mapping starts at rest */
            c->leaving = c->shown;
            release_bones(&c->leaving);
            release_bones(&self->pull);
            self->good = c->leaving;
            (void)keep_taught(self);
            self->functions->reset(self->mapping->self);
        }
        break;
    case CROSSFADE_WAITS_OTHER: /* `pull` is input and output: the new mapping must not get the
                                   bones of the old one */
        release_bones(&self->pull);
        break;
    case CROSSFADE_IN:
    case CROSSFADE_OVER:
    case CROSSFADE_HOME:
        c->fade_s = self->frame.dt_s;
        break;
    }
}

void layer_crossfade(layer *self)
{
    if (is_waiting(&self->crossfade)) /* the pull before that still fades out */
        return;
    self->crossfade.leaving = *layer_pull(self);
    enter(self, CROSSFADE_WAITS);
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

instance *layer_replace(layer *self, instance *mapping, layer_room **room, const float *posed,
                        bool keeps_clay)
{
    instance *old = layer_switch(self, mapping, room);
    if (!keeps_clay)
        pointer_restore_base(&self->pointer);
    memcpy(self->crossfade.posed, posed, sizeof self->crossfade.posed);
    enter(self, CROSSFADE_WAITS_OTHER);
    return old;
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

/* Returns whether only the old mapping drives some bone. That bone would keep its last pose. */
static bool leaves_bones(const layer *self, const mrt_pull *leaving, const mrt_pull *new)
{
    for (uint32_t i = 0; i < self->about->dof_count; ++i)
        if (!isnan(leaving->dof[i]) && isnan(new->dof[i]))
            return true;
    return false;
}

/* A bone that the old mapping moved only by vectors, and that the new mapping drives, fades from
 * its pose at the switch. */
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

/* Gives the new pull its own slot beside that of `leaving`. */
static void change_side(crossfade *c)
{
    c->side = 1 - c->side;
    c->anchor_shift = 0;
}

/* Where the base also returns to rest, the skin is baked into it, and bones fade. */
static void go_home(layer *self)
{
    crossfade *c = &self->crossfade;
    if (self->pointer.restores)
        c->leaving.count = 0;
    c->shown = layer_home(&c->leaving);
    change_side(c);
    enter(self, CROSSFADE_HOME);
}

/* Chooses the transition by the first pull of the new mapping. While that pull is idle, the shape
 * is kept after a reset, and eases to rest after another mapping. */
static void begin_fade(layer *self)
{
    crossfade *c = &self->crossfade;
    const mrt_pull *new = &self->good;
    bool is_other = c->state == CROSSFADE_WAITS_OTHER;
    if (is_other && (new->mode == MRT_IDLE || leaves_bones(self, &c->leaving, new))) {
        go_home(self);
        return;
    }
    if (new->mode == MRT_IDLE)
        return;
    if (is_other)
        leave_posed(c, new);
    bool continues_drag = c->leaving.mode == MRT_UNANCHORED && new->mode == MRT_UNANCHORED;
    if (holds_elsewhere(&c->leaving, new)) { /* the skin is baked into the shape; bones fade */
        c->leaving.count = 0;
        enter(self, drives_bones(&c->leaving) ? CROSSFADE_OVER : CROSSFADE_IN);
        if (new->anchor + c->anchor_shift == c->leaving.anchor)
            c->anchor_shift += 1;
    } else if (continues_drag) {
        enter(self, CROSSFADE_IN);
    } else {
        change_side(c);
        enter(self, CROSSFADE_OVER);
    }
}

void layer_use_pull(layer *self)
{
    crossfade *c = &self->crossfade;
    self->good = self->pull;
    if (is_waiting(c))
        begin_fade(self);
    if (c->state == CROSSFADE_HOME || c->anchor_shift == 0)
        return;
    c->shown = self->good;
    c->shown.anchor += c->anchor_shift;
}

void layer_keep_good(layer *self)
{
    self->pull = self->good;
    if (is_waiting(&self->crossfade)) /* `good` is from the old mapping, or from before the reset */
        release_bones(&self->pull);
}

static bool has_hand(const layer *self)
{
    return self->frame.hand[MRT_LEFT].present || self->frame.hand[MRT_RIGHT].present;
}

void layer_remove_hands(layer *self, const mrt_channel *channels, uint32_t count, bool keeps_clay)
{
    const bool had_hand = has_hand(self);
    for (uint32_t i = 0; i < count; ++i)
        if (channel_is_angle(&channels[i]))
            self->frame.hand[channels[i].hand].present = false;
    if (!had_hand || has_hand(self))
        return;
    if (!keeps_clay)
        pointer_restore_base(&self->pointer);
    layer_crossfade(self);
    go_home(self);
}

static void advance_fade(layer *self)
{
    crossfade *c = &self->crossfade;
    if (!layer_is_fading(self))
        return;
    c->fade_s += self->frame.dt_s;
    if (c->fade_s >= LAYER_FADE_S)
        enter(self, c->state == CROSSFADE_HOME ? CROSSFADE_WAITS : CROSSFADE_NONE);
}

static void reset_if_requested(layer *self)
{
    if (!self->resets || layer_is_fading(self))
        return;
    if (!keep_taught(self) && self->takeover && self->reset_waits++ < reset_waits_most)
        return;
    self->resets = false;
    self->reset_waits = 0;
    layer_crossfade(self);
    release_bones(&self->pull);
    self->functions->reset(self->mapping->self);
}

void layer_advance(layer *self)
{
    advance_fade(self);
    reset_if_requested(self);
}

/* ---- save and load ---- */

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

static void shift(int64_t *time_ns, int64_t by_ns)
{
    *time_ns = (int64_t)((uint64_t)*time_ns + (uint64_t)by_ns);
}

void layer_shift_time(layer *self, int64_t by_ns)
{
    hands_shift_time(self->hands, by_ns);
    frame_inputs_shift_time(&self->inputs, by_ns);
    pointer_shift_time(&self->pointer, by_ns);
    palette_shift_time(&self->palette, by_ns);
    life_shift_time(&self->life, by_ns);
    shift(&self->frame.time_ns, by_ns);
    for (int side = 0; side < 2; ++side)
        shift(&self->frame.hand[side].time_ns, by_ns);
}

enum {
    STORE_VERSION = 1,
    STORE_WITH_CUT = 2,
    STORE_WITH_POINTER = 3,
    STORE_WITH_INPUTS = 4,
    STORE_WITH_PALETTE = 5, /* only where a palette was played */
    STORE_WITH_LIFE = 6     /* only where the face lived */
};
enum { STORE_OTHER = 2, STORE_HOMING = 2 }; /* the stored words for waiting and fading, beyond 1 */

/* Appends the size of a nested state and reserves space for it. Returns NULL if the buffer is too
 * small. */
static void *add_nested(bytes_out *out, size_t size)
{
    bytes_write_u32(out, (uint32_t)size);
    bool fits = out->data && out->size <= out->capacity && size <= out->capacity - out->size;
    void *at = fits ? out->data + out->size : NULL;
    out->size += size;
    return at;
}

/* save(of, bytes, capacity) returns the size of the state. */
#define WRITE_NESTED(out, save, of)                                                                \
    do {                                                                                           \
        size_t nested_size = save(of, NULL, 0);                                                    \
        void *nested_at = add_nested(out, nested_size);                                            \
        if (nested_at)                                                                             \
            save(of, nested_at, nested_size);                                                      \
    } while (0)

static size_t save_mapping(const layer *self, void *bytes, size_t capacity)
{
    return layer_is_answered(self) ? 0 : self->resume->save(self->mapping->self, bytes, capacity);
}

static void read_pull(bytes_in *in, const layer *self, mrt_pull *out)
{
    uint32_t kept = answers_read_pull(in, out);
    in->failed = in->failed || kept < out->count || guard_fault(&self->guard, out) != NULL;
}

static const unsigned char *read_sized(bytes_in *in, size_t *out_size)
{
    *out_size = bytes_read_u32(in);
    const unsigned char *at = in->at;
    if (in->failed || *out_size > (size_t)(in->end - in->at)) {
        in->failed = true;
        return NULL;
    }
    in->at += *out_size;
    return at;
}

static void write_crossfade(bytes_out *out, const crossfade *c)
{
    bytes_write_u32(out, c->state == CROSSFADE_WAITS_OTHER ? STORE_OTHER : is_waiting(c));
    bytes_write_u32(out, c->state == CROSSFADE_HOME ? STORE_HOMING : c->state >= CROSSFADE_IN);
    bytes_write_u32(out, c->state >= CROSSFADE_OVER);
    bytes_write_f64(out, c->fade_s);
    bytes_write_u32(out, c->side);
    bytes_write_u32(out, c->anchor_shift);
    answers_write_pull(out, &c->leaving);
    if (c->state == CROSSFADE_WAITS_OTHER)
        bytes_write(out, c->posed, sizeof c->posed);
}

/* Reads the state, which is stored as three words: waiting, fading and leaving. */
static crossfade_state stored_state(bytes_in *in)
{
    uint32_t waiting = bytes_read_u32(in), fading = bytes_read_u32(in);
    bool is_leaving = bytes_read_u32(in) != 0;
    if (waiting != 0)
        return waiting == STORE_OTHER ? CROSSFADE_WAITS_OTHER : CROSSFADE_WAITS;
    if (fading == 0)
        return CROSSFADE_NONE;
    if (fading == STORE_HOMING)
        return CROSSFADE_HOME;
    return is_leaving ? CROSSFADE_OVER : CROSSFADE_IN;
}

static void read_crossfade(bytes_in *in, layer *self)
{
    crossfade *c = &self->crossfade;
    c->state = stored_state(in);
    c->fade_s = bytes_read_f64(in);
    c->side = bytes_read_u32(in);
    c->anchor_shift = bytes_read_u32(in);
    read_pull(in, self, &c->leaving);
    bool is_other = c->state == CROSSFADE_WAITS_OTHER;
    if (is_other)
        bytes_read(in, c->posed, sizeof c->posed);
    for (uint32_t i = 0; is_other && i < MRT_MAX_DOFS; ++i)
        in->failed |= !isfinite(c->posed[i]);
    c->shown = c->state == CROSSFADE_HOME ? layer_home(&c->leaving) : self->good;
    c->shown.anchor += c->anchor_shift;
    in->failed = in->failed || c->side > 1 || !(c->fade_s >= 0.0);
}

size_t layer_save(layer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    const mrt_plugin_type *type = self->mapping->type;
    if (!layer_is_answered(self) && (!self->resume || save_mapping(self, NULL, 0) == 0))
        return 0;
    const uint32_t version = self->life.is_known      ? STORE_WITH_LIFE
                             : self->palette.is_known ? STORE_WITH_PALETTE
                                                      : STORE_WITH_INPUTS;
    bytes_write_u32(&out, version);
    bytes_write_u32(&out, type->param_count);
    for (uint32_t i = 0; i < type->param_count; ++i) {
        bytes_write_u32(&out, type->params[i].id);
        bytes_write_f64(&out, self->room->last_params[i]);
    }
    bytes_write_u32(&out, self->has_time);
    bytes_write(&out, &self->frame.time_ns, sizeof self->frame.time_ns);
    bytes_write(&out, self->frame.pedal, sizeof self->frame.pedal);
    for (int side = 0; side < 2; ++side) {
        const mrt_hand *hand = &self->frame.hand[side];
        bytes_write_u32(&out, hand->present);
        bytes_write(&out, &hand->time_ns, sizeof hand->time_ns);
        bytes_write(&out, hand->angle, sizeof hand->angle);
        bytes_write(&out, hand->joint, sizeof hand->joint);
        bytes_write(&out, hand->palm, sizeof hand->palm);
    }
    answers_write_pull(&out, &self->good);
    answers_write_pull(&out, &self->pull);
    write_crossfade(&out, &self->crossfade);
    bytes_write_u32(&out, self->resets);
    WRITE_NESTED(&out, pointer_save, &self->pointer);
    WRITE_NESTED(&out, frame_inputs_save, &self->inputs);
    WRITE_NESTED(&out, patch_bay_save, &self->bay);
    if (version >= STORE_WITH_PALETTE)
        WRITE_NESTED(&out, palette_save, &self->palette);
    if (version >= STORE_WITH_LIFE)
        WRITE_NESTED(&out, life_save, &self->life);
    WRITE_NESTED(&out, hands_save, self->hands);
    WRITE_NESTED(&out, save_mapping, self);
    return out.size;
}

static void read_params(bytes_in *in, layer *self)
{
    const mrt_plugin_type *type = self->mapping->type;
    in->failed |= bytes_read_u32(in) != type->param_count;
    for (uint32_t i = 0; i < type->param_count && !in->failed; ++i) {
        in->failed |= bytes_read_u32(in) != type->params[i].id;
        double value = bytes_read_f64(in);
        in->failed |= !(value >= type->params[i].min && value <= type->params[i].max);
        self->room->stored_params[i] = value;
    }
}

static void use_stored_params(layer *self)
{
    const mrt_plugin_type *type = self->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = self->room->stored_params[i];
        bool is_button =
            type->params[i].flags & MRT_PARAM_TRIGGER; /* a button is released by then */
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

static void read_frame(bytes_in *in, mrt_frame *frame)
{
    bytes_read(in, frame->pedal, sizeof frame->pedal);
    in->failed |= !are_finite(frame->pedal, MRT_MAX_PEDALS);
    for (int side = 0; side < 2; ++side) {
        mrt_hand *hand = &frame->hand[side];
        hand->present = bytes_read_u32(in) != 0;
        bytes_read(in, &hand->time_ns, sizeof hand->time_ns);
        bytes_read(in, hand->angle, sizeof hand->angle);
        bytes_read(in, hand->joint, sizeof hand->joint);
        bytes_read(in, hand->palm, sizeof hand->palm);
        in->failed |= !are_finite(hand->angle, MRT_ANGLES) ||
                      !points_are_finite(hand->joint, MRT_JOINTS) ||
                      !points_are_finite(hand->palm, MRT_PALM);
    }
}

static void read_pointer(bytes_in *in, layer *self)
{
    size_t size = 0;
    self->resets = bytes_read_u32(in) != 0;
    const unsigned char *bytes = read_sized(in, &size);
    in->failed |= !bytes || !pointer_load(&self->pointer, bytes, size) ||
                  guard_fault(&self->guard, &self->pointer.pull) ||
                  guard_fault(&self->guard, &self->pointer.places);
}

static void read_inputs_and_bay(bytes_in *in, layer *self)
{
    size_t size = 0;
    const unsigned char *bytes = read_sized(in, &size);
    in->failed |= !bytes || !frame_inputs_load(&self->inputs, bytes, size);
    bytes = read_sized(in, &size);
    in->failed |= !bytes || !patch_bay_load(&self->bay, bytes, size);
}

static mrt_result load(layer *self, bytes_in *in, error *err)
{
    if (!self->resume && !layer_is_answered(self))
        return error_set(err, MRT_ERR_UNSUPPORTED, "mapping %s cannot be resumed",
                         self->mapping->type->id);
    uint32_t version = bytes_read_u32(in);
    in->failed |= version < STORE_VERSION || version > STORE_WITH_LIFE;
    read_params(in, self);
    self->has_time = bytes_read_u32(in) != 0;
    bytes_read(in, &self->frame.time_ns, sizeof self->frame.time_ns);
    read_frame(in, &self->frame);
    read_pull(in, self, &self->good);
    read_pull(in, self, &self->pull);
    if (version >= STORE_WITH_CUT && !in->failed)
        read_crossfade(in, self);
    if (version >= STORE_WITH_POINTER && !in->failed)
        read_pointer(in, self);
    if (version >= STORE_WITH_INPUTS && !in->failed)
        read_inputs_and_bay(in, self);
    else if (self->bay.plan)
        in->failed = true; /* the state is from a version without patches */
    size_t size = 0;
    const unsigned char *bytes;
    if (version >= STORE_WITH_PALETTE && !in->failed) {
        bytes = read_sized(in, &size);
        in->failed |= !bytes || !palette_load(&self->palette, &self->guard, bytes, size);
    }
    if (version >= STORE_WITH_LIFE && !in->failed) {
        bytes = read_sized(in, &size);
        in->failed |= !bytes || !life_load(&self->life, &self->guard, bytes, size);
    }
    bytes = read_sized(in, &size);
    in->failed |= !bytes || !hands_load(self->hands, bytes, size);
    bytes = read_sized(in, &size);
    if (in->failed || in->at != in->end)
        return error_set(err, MRT_ERR_FORMAT, "the stored state of mapping %s is damaged",
                         self->mapping->type->id);
    if (!layer_is_answered(self) && self->resume->load(self->mapping->self, bytes, size) < 0)
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
