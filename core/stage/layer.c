#include "stage/layer.h"
#include "base/bytes.h"
#include "base/clock.h"
#include "stage/plugins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double dt_max_s = 0.1;
enum { STORE_VERSION = 1 };

struct layer {
    instance *mapping;
    const mrt_mapping *functions;
    const mrt_resume *resume; /* NULL: it has none */
    const mrt_face *about;
    layer_settings settings;
    hands *hands;
    mrt_frame frame;
    mrt_pull pull; /* what the mapping fills; it sees its own last values */
    mrt_pull good; /* the last that passed the guard */
    bool has_time;
    double *last_params;   /* of the sample before */
    double *stored_params; /* while a state is loaded */
    layer_on_param *on_param;
    void *on_param_data;
    layer_counts counts;
};

static double to_double(float v)
{
    return (double)v;
}

void layer_reset(layer *self)
{
    self->frame = (mrt_frame){0};
    self->pull = (mrt_pull){0};
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        self->pull.dof[i] = NAN;
    self->good = self->pull;
    self->has_time = false;
    hands_reset(self->hands);
    self->functions->reset(self->mapping->self);
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
    self->functions = plugin_interface(mapping->type, MRT_MAPPING);
    self->resume = plugin_interface(mapping->type, MRT_RESUME);
    self->about = about;
    self->settings = *settings;
    mrt_result result = MRT_OK;
    self->last_params = calloc((size_t)mapping->type->param_count + 1, sizeof *self->last_params);
    self->stored_params =
        calloc((size_t)mapping->type->param_count + 1, sizeof *self->stored_params);
    if (!self->last_params || !self->stored_params)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for a layer");
    if (result >= 0)
        result = hands_create(&self->hands, &settings->hands, err);
    if (result < 0)
        goto fail;
    self->mapping = mapping;
    result = activate(self, err);
    if (result < 0) {
        self->mapping = NULL; /* nothing to deactivate */
        goto fail;
    }
    layer_reset(self);
    instance_latch(mapping);
    memcpy(self->last_params, mapping->params,
           mapping->type->param_count * sizeof *self->last_params);
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
    free(self->last_params);
    free(self->stored_params);
    free(self);
}

/* ---- steps 4 and 5: the mapping and the guard ---- */

static bool is_within_reach(const layer *self, mrt_vec3 p)
{
    vec3 from_centre =
        vec3_sub((vec3){to_double(p.x), to_double(p.y), to_double(p.z)}, self->settings.centre);
    return vec3_length(from_centre) <= self->settings.reach_mm; /* false for what is not finite */
}

/* Says what is wrong with a pull; NULL: nothing. */
static const char *pull_fault(const layer *self, const mrt_pull *pull)
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
        if (v->contact > self->about->contact_count)
            return "a contact that the face does not have";
    }
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        if (isinf(pull->dof[i]))
            return "an infinite degree of freedom";
    return NULL;
}

static void tell_params(layer *self, const mrt_sample *sample)
{
    const mrt_plugin_type *type = self->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = self->mapping->params[i];
        if (memcmp(&value, &self->last_params[i], sizeof value) == 0)
            continue;
        self->last_params[i] = value;
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
    run_mapping(self, sample);
}

const mrt_pull *layer_pull(const layer *self)
{
    return &self->good;
}

const mrt_frame *layer_frame(const layer *self)
{
    return &self->frame;
}

instance *layer_mapping(layer *self)
{
    return self->mapping;
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

/* ---- kept ---- */

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
    in->failed = in->failed || pull_fault(self, out) != NULL;
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

size_t layer_save(layer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    const mrt_plugin_type *type = self->mapping->type;
    if (!self->resume || save_mapping(self, NULL, 0) == 0)
        return 0;
    bytes_put_u32(&out, STORE_VERSION);
    bytes_put_u32(&out, type->param_count);
    for (uint32_t i = 0; i < type->param_count; ++i) {
        bytes_put_u32(&out, type->params[i].id);
        bytes_put_f64(&out, self->last_params[i]);
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
        self->stored_params[i] = value;
    }
}

static void use_stored_params(layer *self)
{
    const mrt_plugin_type *type = self->mapping->type;
    for (uint32_t i = 0; i < type->param_count; ++i) {
        double value = self->stored_params[i];
        bool is_button = type->params[i].flags & MRT_PARAM_TRIGGER; /* it was let go since */
        self->last_params[i] = value;
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

static mrt_result load(layer *self, bytes_in *in, error *err)
{
    if (!self->resume)
        return error_set(err, MRT_ERR_UNSUPPORTED, "mapping %s cannot be resumed",
                         self->mapping->type->id);
    in->failed |= bytes_take_u32(in) != STORE_VERSION;
    take_params(in, self);
    self->has_time = bytes_take_u32(in) != 0;
    bytes_take(in, &self->frame.time_ns, sizeof self->frame.time_ns);
    take_frame(in, &self->frame);
    take_pull(in, self, &self->good);
    take_pull(in, self, &self->pull);
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

static void shift(int64_t *time_ns, int64_t by_ns)
{
    *time_ns = (int64_t)((uint64_t)*time_ns + (uint64_t)by_ns);
}

void layer_shift_time(layer *self, int64_t by_ns)
{
    hands_shift_time(self->hands, by_ns);
    shift(&self->frame.time_ns, by_ns);
    for (int side = 0; side < 2; ++side)
        shift(&self->frame.hand[side].time_ns, by_ns);
}
