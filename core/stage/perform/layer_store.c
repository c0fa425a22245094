#include "stage/perform/layer_state.h"
#include "base/bytes.h"

#include <math.h>
#include <string.h>

enum { STORE_VERSION = 1, STORE_WITH_CUT = 2, STORE_WITH_POINTER = 3 };
enum { STORE_OTHER = 2, STORE_HOMING = 2 }; /* more than 1, that it is waiting, is fading */

/* What the hands and the mapping take goes behind its own size. */
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
    return self->resume->save(self->mapping->self, bytes, capacity);
}

/* Those behind the ones in use too, up to the last that is not all zero: the mapping sees them. */
static uint32_t vectors_to_keep(const mrt_pull *pull)
{
    static const mrt_vector nothing = {{0, 0, 0}, {0, 0, 0}, 0};
    uint32_t count = MRT_MAX_VECTORS;
    while (count > pull->count && memcmp(&pull->vector[count - 1], &nothing, sizeof nothing) == 0)
        count -= 1;
    return count;
}

static void put_pull(bytes_out *out, const mrt_pull *pull)
{
    uint32_t count = vectors_to_keep(pull);
    bytes_put(out, pull, offsetof(mrt_pull, vector));
    bytes_put_u32(out, count);
    bytes_put(out, pull->vector, count * sizeof *pull->vector);
    bytes_put(out, pull->dof, sizeof pull->dof);
}

static void take_pull(bytes_in *in, const layer *self, mrt_pull *out)
{
    bytes_take(in, out, offsetof(mrt_pull, vector));
    uint32_t count = bytes_take_u32(in);
    if (count > MRT_MAX_VECTORS || count < out->count)
        in->failed = true;
    else
        bytes_take(in, out->vector, count * sizeof *out->vector);
    bytes_take(in, out->dof, sizeof out->dof);
    in->failed = in->failed || guard_fault(&self->guard, out) != NULL;
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

/* Most layers never had one: they are kept as ever. */
static bool has_cut(const layer *self)
{
    const cut *c = &self->cut;
    return c->is_waiting || c->is_fading || c->side != 0 || c->anchor_shift != 0;
}

static void put_cut(bytes_out *out, const cut *c)
{
    bytes_put_u32(out, c->is_other ? STORE_OTHER : c->is_waiting);
    bytes_put_u32(out, c->is_homing ? STORE_HOMING : c->is_fading);
    bytes_put_u32(out, c->is_leaving);
    bytes_put_f64(out, c->fade_s);
    bytes_put_u32(out, c->side);
    bytes_put_u32(out, c->anchor_shift);
    put_pull(out, &c->leaving);
    if (c->is_other)
        bytes_put(out, c->posed, sizeof c->posed);
}

static void take_cut(bytes_in *in, layer *self)
{
    cut *c = &self->cut;
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

static uint32_t version_of(const layer *self)
{
    if (self->pointer.is_known)
        return STORE_WITH_POINTER;
    return has_cut(self) ? STORE_WITH_CUT : STORE_VERSION;
}

size_t layer_save(layer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    const mrt_plugin_type *type = self->mapping->type;
    if (!self->resume || save_mapping(self, NULL, 0) == 0)
        return 0;
    uint32_t version = version_of(self);
    bytes_put_u32(&out, version);
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
    put_pull(&out, &self->good);
    put_pull(&out, &self->pull);
    if (version >= STORE_WITH_CUT)
        put_cut(&out, &self->cut);
    if (version >= STORE_WITH_POINTER) {
        bytes_put_u32(&out, self->resets);
        put_sized(&out, save_pointer, &self->pointer);
    }
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

static mrt_result load(layer *self, bytes_in *in, error *err)
{
    if (!self->resume)
        return error_set(err, MRT_ERR_UNSUPPORTED, "mapping %s cannot be resumed",
                         self->mapping->type->id);
    uint32_t version = bytes_take_u32(in);
    in->failed |= version < STORE_VERSION || version > STORE_WITH_POINTER;
    take_params(in, self);
    self->has_time = bytes_take_u32(in) != 0;
    bytes_take(in, &self->frame.time_ns, sizeof self->frame.time_ns);
    take_frame(in, &self->frame);
    take_pull(in, self, &self->good);
    take_pull(in, self, &self->pull);
    if (version >= STORE_WITH_CUT && !in->failed)
        take_cut(in, self);
    if (version >= STORE_WITH_POINTER && !in->failed)
        take_pointer(in, self);
    size_t size = 0;
    const unsigned char *bytes = take_sized(in, &size);
    in->failed |= !bytes || !hands_load(self->hands, bytes, size);
    bytes = take_sized(in, &size);
    if (in->failed || in->at != in->end)
        return error_set(err, MRT_ERR_FORMAT, "the stored state of mapping %s is damaged",
                         self->mapping->type->id);
    if (self->resume->load(self->mapping->self, bytes, size) < 0)
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
