/* The state of a composer as bytes. Who speaks is told again by the next step; what they hold the
 * face with is kept. */
#include "base/bytes.h"
#include "stage/perform/composer_state.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STORE_VERSION = 3, STORE_WITH_FINGERS = 4 };
enum { IS_ADDITIVE = 1, IS_FINGER = 2 };

static void put_pull(bytes_out *out, const mrt_pull *pull)
{
    bytes_put(out, pull, offsetof(mrt_pull, vector));
    bytes_put(out, pull->vector, pull->count * sizeof *pull->vector);
    bytes_put(out, pull->dof, sizeof pull->dof);
}

static bool is_point(mrt_vec3 p)
{
    return isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
}

static void take_pull(bytes_in *in, const composer *self, mrt_pull *out)
{
    *out = (mrt_pull){0};
    bytes_take(in, out, offsetof(mrt_pull, vector));
    if (out->count > MRT_MAX_VECTORS || out->mode > MRT_UNANCHORED || !isfinite(out->radius_mm) ||
        !isfinite(out->stretch_most)) {
        in->failed = true;
        out->count = 0;
    }
    bytes_take(in, out->vector, out->count * sizeof *out->vector);
    bytes_take(in, out->dof, sizeof out->dof);
    for (uint32_t i = 0; i < out->count; ++i)
        in->failed |= !is_point(out->vector[i].start) || !is_point(out->vector[i].end) ||
                      out->vector[i].contact > self->about.contact_count;
    for (uint32_t i = 0; i < MRT_MAX_DOFS; ++i)
        in->failed |= isinf(out->dof[i]);
}

static void put_voice(bytes_out *out, const voice *v)
{
    bytes_put_u32(out, v->part.layer);
    bytes_put_u32(out,
                  (v->part.is_additive ? IS_ADDITIVE : 0) | (v->part.is_finger ? IS_FINGER : 0));
    bytes_put_u32(out, v->commit);
    bytes_put_u32(out, v->has_said);
    if (v->has_said)
        put_pull(out, &v->said);
    bytes_put_u32(out, v->is_joined);
    bytes_put_f64(out, v->weight);
    if (v->is_joined) {
        put_pull(out, &v->joined);
        bytes_put_f64(out, v->share);
        bytes_put(out, v->control, v->joined.count * sizeof *v->control);
    }
    bytes_put_u32(out, v->was_near);
    bytes_put_u32(out, v->is_dragging);
    bytes_put_u32(out, v->is_dragging ? v->tip_count : 0);
    if (v->is_dragging)
        bytes_put(out, v->tip, (size_t)v->tip_count * 3 * sizeof *v->tip);
}

static void take_voice(bytes_in *in, const composer *self, voice *out)
{
    out->was_present = true;
    out->part.layer = bytes_take_u32(in);
    uint32_t manner = bytes_take_u32(in);
    out->part.is_additive = (manner & IS_ADDITIVE) != 0;
    out->part.is_finger = (manner & IS_FINGER) != 0;
    out->commit = bytes_take_u32(in);
    out->has_said = bytes_take_u32(in) != 0;
    if (out->has_said)
        take_pull(in, self, &out->said);
    out->is_joined = bytes_take_u32(in) != 0;
    out->weight = bytes_take_f64(in);
    if (out->is_joined) {
        take_pull(in, self, &out->joined);
        out->share = bytes_take_f64(in);
        bytes_take(in, out->control, out->joined.count * sizeof *out->control);
        for (uint32_t i = 0; i < out->joined.count; ++i)
            in->failed |=
                out->control[i] != COMPOSER_NO_CONTROL && out->control[i] >= self->control_count;
    }
    out->was_near = bytes_take_u32(in) != 0;
    out->is_dragging = bytes_take_u32(in) != 0;
    out->tip_count = bytes_take_u32(in);
    if (out->tip_count > MRT_MAX_VECTORS)
        in->failed = true;
    else
        for (uint32_t i = 0; i < 3 * out->tip_count; ++i)
            out->tip[i] = bytes_take_f64(in);
}

/* Most faces never felt one: they are kept as ever. */
static bool has_fingers(const composer *self)
{
    bool any = false;
    for (uint32_t k = 0; k < self->control_count; ++k)
        any |= self->control[k].is_finger ||
               vec3_dot(self->control[k].held, self->control[k].held) > 0.0;
    return any;
}

static void put_fingers(bytes_out *out, const composer *self)
{
    for (uint32_t k = 0; k < self->control_count; ++k) {
        bytes_put_u32(out, self->control[k].is_finger);
        bytes_put_vec3(out, self->control[k].rest);
        bytes_put_vec3(out, self->control[k].held);
    }
}

static void take_fingers(bytes_in *in, composer *self)
{
    for (uint32_t k = 0; k < self->control_count; ++k) {
        self->control[k].is_finger = bytes_take_u32(in) != 0;
        self->control[k].rest = bytes_take_vec3(in);
        self->control[k].held = bytes_take_vec3(in);
    }
}

static void put_controls(bytes_out *out, const composer *self)
{
    bytes_put_u32(out, self->engaged);
    bytes_put_f64(out, (double)self->engaged_radius_mm);
    bytes_put_u32(out, self->control_count);
    for (uint32_t k = 0; k < self->control_count; ++k) {
        const joined_control *c = &self->control[k];
        bytes_put_u32(out, c->contact);
        bytes_put_u32(out, c->slot);
        bytes_put_u32(out, c->vector);
        bytes_put_vec3(out, c->start);
    }
    bytes_put_u32(out, self->joined_count);
    bytes_put(out, self->joined_order, self->joined_count * sizeof *self->joined_order);
}

static void take_controls(bytes_in *in, composer *self)
{
    self->engaged = bytes_take_u32(in) != 0;
    double radius_mm = bytes_take_f64(in);
    in->failed |= fabs(radius_mm) > (double)FLT_MAX;
    self->engaged_radius_mm = in->failed ? 0.0f : (float)radius_mm;
    self->control_count = bytes_take_u32(in);
    if (self->control_count > MRT_MAX_VECTORS) {
        in->failed = true;
        self->control_count = 0;
    }
    for (uint32_t k = 0; k < self->control_count; ++k) {
        joined_control *c = &self->control[k];
        c->contact = bytes_take_u32(in);
        c->slot = bytes_take_u32(in);
        c->vector = bytes_take_u32(in);
        c->start = bytes_take_vec3(in);
        in->failed |= c->contact > self->about.contact_count || c->slot >= COMPOSER_PARTS_MAX ||
                      c->vector >= MRT_MAX_VECTORS;
    }
    self->joined_count = bytes_take_u32(in);
    if (self->joined_count > COMPOSER_PARTS_MAX) {
        in->failed = true;
        self->joined_count = 0;
    }
    bytes_take(in, self->joined_order, self->joined_count * sizeof *self->joined_order);
    for (uint32_t i = 0; i < self->joined_count; ++i)
        in->failed |= self->joined_order[i] >= COMPOSER_PARTS_MAX;
}

size_t composer_save(composer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    uint32_t voice_count = 0;
    bytes_put_u32(&out, has_fingers(self) ? STORE_WITH_FINGERS : STORE_VERSION);
    put_controls(&out, self);
    if (has_fingers(self))
        put_fingers(&out, self);
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot)
        voice_count += self->voice[slot].was_present || self->voice[slot].is_joined;
    bytes_put_u32(&out, voice_count);
    for (uint32_t slot = 0; slot < COMPOSER_PARTS_MAX; ++slot) {
        const voice *v = &self->voice[slot];
        if (!v->was_present && !v->is_joined)
            continue;
        bytes_put_u32(&out, slot);
        bytes_put_u32(&out, v->was_present);
        put_voice(&out, v);
    }
    size_t face_size = face_save(self->face, NULL, 0);
    bytes_put_u32(&out, (uint32_t)face_size);
    if (out.data && out.size <= out.capacity && face_size <= out.capacity - out.size)
        face_save(self->face, out.data + out.size, face_size);
    return out.size + face_size;
}

static mrt_result load(composer *self, bytes_in *in, error *err)
{
    uint32_t version = bytes_take_u32(in);
    in->failed |= version != STORE_VERSION && version != STORE_WITH_FINGERS;
    take_controls(in, self);
    if (version == STORE_WITH_FINGERS)
        take_fingers(in, self);
    uint32_t voice_count = bytes_take_u32(in);
    for (uint32_t i = 0; i < voice_count && !in->failed; ++i) {
        uint32_t slot = bytes_take_u32(in);
        bool was_present = bytes_take_u32(in) != 0;
        if (slot >= COMPOSER_PARTS_MAX) {
            in->failed = true;
            break;
        }
        take_voice(in, self, &self->voice[slot]);
        self->voice[slot].was_present = was_present;
    }
    size_t size = bytes_take_u32(in);
    if (in->failed || size != (size_t)(in->end - in->at))
        return error_set(err, MRT_ERR_FORMAT, "the stored state of the face is damaged");
    mrt_result result = face_load(self->face, in->at, size, err);
    if (result >= 0 && self->engaged && face_control_count(self->face) != self->control_count)
        result = error_set(err, MRT_ERR_FORMAT, "the stored state of the face is damaged");
    return result;
}

mrt_result composer_load(composer *self, const void *bytes, size_t size, error *err)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    composer_reset(self);
    mrt_result result = load(self, &in, err);
    if (result < 0)
        composer_reset(self);
    return result;
}
