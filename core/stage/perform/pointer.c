#include "stage/perform/pointer.h"
#include "base/bytes.h"
#include "base/clock.h"
#include "stage/mapping/guard.h"

#include <math.h>
#include <string.h>

enum { STORE_VERSION = 1 };

static double to_double(float v)
{
    return (double)v;
}

static mrt_vec3 narrow(vec3 v)
{
    return (mrt_vec3){(float)v.x, (float)v.y, (float)v.z};
}

const mrt_channel *pointer_channels(uint32_t *out_count)
{
    static const mrt_channel channel[POINTER_CHANNELS] = {
        {"rest x", "mm", POINTER_SEMANTIC + POINTER_REST_X, MRT_NO_HAND, 0.0f, 0.0f},
        {"rest y", "mm", POINTER_SEMANTIC + POINTER_REST_Y, MRT_NO_HAND, 0.0f, 0.0f},
        {"rest z", "mm", POINTER_SEMANTIC + POINTER_REST_Z, MRT_NO_HAND, 0.0f, 0.0f},
        {"at x", "mm", POINTER_SEMANTIC + POINTER_AT_X, MRT_NO_HAND, 0.0f, 0.0f},
        {"at y", "mm", POINTER_SEMANTIC + POINTER_AT_Y, MRT_NO_HAND, 0.0f, 0.0f},
        {"at z", "mm", POINTER_SEMANTIC + POINTER_AT_Z, MRT_NO_HAND, 0.0f, 0.0f},
        {"grip", "", POINTER_SEMANTIC + POINTER_GRIP, MRT_NO_HAND, 0.0f, 0.0f},
        {"stays", "", POINTER_SEMANTIC + POINTER_STAYS, MRT_NO_HAND, 0.0f, 0.0f},
        {"radius", "mm", POINTER_SEMANTIC + POINTER_RADIUS, MRT_NO_HAND, 0.0f, 0.0f},
    };
    *out_count = POINTER_CHANNELS;
    return channel;
}

void pointer_reset(pointer *self)
{
    *self = (pointer){.pull = guard_idle(), .places = guard_idle()};
}

void pointer_restore_base(pointer *self)
{
    self->restores = true;
    self->restores_s = -1.0;
}

/* ---- reading a sample ---- */

typedef struct pointer_sample {
    pointer_grip grip;
    bool stays;
    vec3 rest, at;
    float radius_mm;
} pointer_sample;

static bool read_sample(const channel_route *route, const mrt_sample *sample, pointer_sample *out)
{
    float value[POINTER_CHANNELS] = {0};
    bool has_pointer = false;
    for (uint32_t i = 0; i < route->table.count && i < sample->count; ++i) {
        uint32_t semantic = route->table.channel[i].semantic, channel = semantic - POINTER_SEMANTIC;
        if (channel >= POINTER_CHANNELS || semantic < POINTER_SEMANTIC)
            continue;
        value[channel] = sample->value[i];
        has_pointer = true;
    }
    float grip = value[POINTER_GRIP];
    out->grip = grip > 0.0f && grip <= (float)POINTER_NEUTRAL ? (pointer_grip)grip : POINTER_AWAY;
    out->stays = value[POINTER_STAYS] >= 0.5f;
    out->radius_mm = fmaxf(value[POINTER_RADIUS], 0.0f);
    out->rest = (vec3){to_double(value[POINTER_REST_X]), to_double(value[POINTER_REST_Y]),
                       to_double(value[POINTER_REST_Z])};
    out->at = (vec3){to_double(value[POINTER_AT_X]), to_double(value[POINTER_AT_Y]),
                     to_double(value[POINTER_AT_Z])};
    return has_pointer;
}

/* ---- offsets ---- */

static bool is_same_place(vec3 a, vec3 b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static pointer_offset *find_offset(pointer *self, uint32_t contact, vec3 rest)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        pointer_offset *o = &self->offset[i];
        if (o->contact == contact && (contact > 0 || is_same_place(o->rest, rest)))
            return o;
    }
    return NULL;
}

static void remove_offset(pointer *self, uint32_t at)
{
    self->count -= 1;
    memmove(&self->offset[at], &self->offset[at + 1], (self->count - at) * sizeof *self->offset);
}

static void ease_back(pointer_offset *o)
{
    o->eases = true;
    o->from = o->offset;
    o->eased_s = 0.0;
}

static uint32_t find_contact(const mrt_face *about, vec3 rest)
{
    mrt_vec3 at = narrow(rest);
    for (uint32_t i = 0; i < about->contact_count; ++i)
        if (memcmp(&about->contacts[i].rest, &at, sizeof at) == 0)
            return i + 1;
    return 0;
}

/* Adds an offset. If the array is full, drops the oldest one. */
static pointer_offset *add_offset(pointer *self, uint32_t contact, vec3 rest)
{
    if (self->count == POINTER_KEPT_MAX + 1)
        remove_offset(self, 0);
    pointer_offset *o = &self->offset[self->count++];
    *o = (pointer_offset){.contact = contact, .rest = rest};
    return o;
}

/* Called before an offset is added. If too many keep an offset, the oldest of them eases back. */
static void make_room(pointer *self)
{
    uint32_t staying = 0;
    pointer_offset *oldest = NULL;
    for (uint32_t i = 0; i < self->count; ++i) {
        pointer_offset *o = &self->offset[i];
        if (o->eases)
            continue;
        staying += 1;
        if (!oldest)
            oldest = o;
    }
    if (oldest && staying >= POINTER_KEPT_MAX)
        ease_back(oldest);
}

/* ---- grips ---- */

/* Bakes the current offsets of all points of the skin into the base. */
static void commit_places(pointer *self)
{
    for (uint32_t i = self->count; i-- > 0;)
        if (self->offset[i].contact == 0)
            remove_offset(self, i);
    self->places.commit += 1;
    self->commits = true;
}

static bool has_places(const pointer *self)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->offset[i].contact == 0)
            return true;
    return false;
}

static void begin_grip(pointer *self, const mrt_face *about, const pointer_sample *now)
{
    self->held_rest = now->rest;
    self->held_at = self->at = now->at;
    self->held = find_contact(about, now->rest);
    if (self->count == 0 || now->grip == POINTER_KNEADS)
        self->radius_mm = now->radius_mm;
    if (now->grip == POINTER_KNEADS) {
        if (has_places(self))
            commit_places(self);
        return;
    }
    pointer_offset *o = find_offset(self, self->held, now->rest);
    if (!o) {
        make_room(self);
        o = add_offset(self, self->held, now->rest);
    }
    o->eases = false;
    o->from = o->offset;
}

static void drag(pointer *self)
{
    pointer_offset *o = find_offset(self, self->held, self->held_rest);
    if (o)
        o->offset = vec3_add(o->from, vec3_sub(self->at, self->held_at));
}

static void release(pointer *self, bool stays)
{
    pointer_offset *o = find_offset(self, self->held, self->held_rest);
    if (self->grip != POINTER_PULLS || !o)
        return;
    if (!stays)
        ease_back(o);
    else if (self->held == 0)
        commit_places(self);
}

static void release_all(pointer *self)
{
    for (uint32_t i = 0; i < self->count; ++i)
        if (!self->offset[i].eases)
            ease_back(&self->offset[i]);
}

static bool is_held(pointer_grip grip)
{
    return grip == POINTER_PULLS || grip == POINTER_KNEADS;
}

static void apply_sample(pointer *self, const mrt_face *about, const pointer_sample *now)
{
    bool is_new_grip = now->grip != self->grip || !is_same_place(now->rest, self->held_rest);
    if (is_held(self->grip) && is_new_grip)
        release(self, self->stays);
    if (is_held(now->grip) && is_new_grip)
        begin_grip(self, about, now);
    if (now->grip >= POINTER_RELEASE_ALL && now->grip != self->grip)
        release_all(self);
    if (now->grip == POINTER_NEUTRAL && self->grip != POINTER_NEUTRAL) {
        self->restores = true;
        self->restores_s = 0.0;
    }
    self->grip = now->grip;
    self->stays = now->stays;
    self->at = now->at;
    if (self->grip == POINTER_PULLS)
        drag(self);
}

/* ---- easing ---- */

static double remaining_share(double passed_s)
{
    double s = fmin(passed_s / POINTER_SPRING_S, 1.0);
    return 1.0 - s * s * (3.0 - 2.0 * s);
}

static void ease(pointer *self, double dt_s)
{
    for (uint32_t i = self->count; i-- > 0;) {
        pointer_offset *o = &self->offset[i];
        if (!o->eases)
            continue;
        o->eased_s += dt_s;
        o->offset = vec3_scale(o->from, remaining_share(o->eased_s));
        if (o->eased_s >= POINTER_SPRING_S)
            remove_offset(self, i);
    }
    if (!self->restores)
        return;
    if (self->restores_s < 0.0) {
        self->restores_s = 0.0;
        return;
    }
    double left = remaining_share(self->restores_s);
    self->restores_s += dt_s;
    self->restore = left > 0.0 ? 1.0 - remaining_share(self->restores_s) / left : 1.0;
    self->restores = self->restores_s < POINTER_SPRING_S;
}

/* ---- pulls ---- */

static void add_vector(mrt_pull *to, const mrt_face *about, const pointer_offset *o)
{
    vec3 start = o->rest;
    if (o->contact > 0) {
        const mrt_vec3 *rest = &about->contacts[o->contact - 1].rest;
        start = (vec3){to_double(rest->x), to_double(rest->y), to_double(rest->z)};
    }
    to->mode = MRT_ANCHORED;
    to->vector[to->count++] = (mrt_vector){
        .start = narrow(start), .end = narrow(vec3_add(start, o->offset)), .contact = o->contact};
}

static void pull(pointer *self, const mrt_face *about, vec3 kneads_from)
{
    mrt_pull *places = &self->places;
    self->pull.mode = places->mode = MRT_IDLE;
    self->pull.count = places->count = 0;
    places->radius_mm = self->pull.radius_mm = self->radius_mm;
    for (uint32_t i = 0; i < self->count; ++i) {
        const pointer_offset *o = &self->offset[i];
        if (o->contact <= about->contact_count)
            add_vector(o->contact > 0 ? &self->pull : places, about, o);
    }
    if (self->grip != POINTER_KNEADS)
        return;
    places->mode = MRT_UNANCHORED;
    places->count = 1;
    places->vector[0] = (mrt_vector){.start = narrow(kneads_from), .end = narrow(self->at)};
}

bool pointer_read(pointer *self, const mrt_face *about, const sample_step *s, int64_t time_ns)
{
    pointer_sample now = {0};
    bool has_pointer = false;
    for (uint32_t i = 0; i < s->count && !has_pointer; ++i)
        has_pointer = read_sample(s->of[i].route, &s->of[i].sample, &now);
    self->is_fresh = has_pointer;
    self->commits = false;
    self->restore = 0.0;
    if (!has_pointer && !self->is_known && !self->restores)
        return false;
    int64_t passed_ns = time_ns - self->time_ns;
    double dt_s = self->is_known && passed_ns > 0 ? (double)passed_ns / (double)NS_PER_S : 0.0;
    self->is_known = true;
    self->time_ns = time_ns;
    ease(self, dt_s);
    vec3 from = self->at;
    pointer_grip before = self->grip;
    if (has_pointer)
        apply_sample(self, about, &now);
    bool begins = self->grip != before;
    pull(self, about, begins ? self->at : from);
    return has_pointer;
}

/* ---- save and load ---- */

static void write_pull(bytes_out *out, const mrt_pull *p)
{
    bytes_write(out, p, offsetof(mrt_pull, vector));
    bytes_write(out, p->vector, p->count * sizeof *p->vector);
}

static void read_pull(bytes_in *in, mrt_pull *out)
{
    *out = guard_idle();
    bytes_read(in, out, offsetof(mrt_pull, vector));
    if (out->count > POINTER_KEPT_MAX + 1 || out->mode > MRT_UNANCHORED) {
        in->failed = true;
        out->count = 0;
    }
    bytes_read(in, out->vector, out->count * sizeof *out->vector);
}

size_t pointer_save(const pointer *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    bytes_write_u32(&out, STORE_VERSION);
    bytes_write_u32(&out, self->is_known);
    bytes_write(&out, &self->time_ns, sizeof self->time_ns);
    bytes_write_u32(&out, (uint32_t)self->grip);
    bytes_write_u32(&out, self->stays);
    bytes_write_f64(&out, to_double(self->radius_mm));
    bytes_write_vec3(&out, self->held_rest);
    bytes_write_vec3(&out, self->held_at);
    bytes_write_vec3(&out, self->at);
    bytes_write_u32(&out, self->held);
    bytes_write_u32(&out, self->restores);
    bytes_write_f64(&out, self->restores_s);
    bytes_write_u32(&out, self->count);
    for (uint32_t i = 0; i < self->count; ++i) {
        const pointer_offset *o = &self->offset[i];
        bytes_write_u32(&out, o->contact);
        bytes_write_vec3(&out, o->rest);
        bytes_write_vec3(&out, o->offset);
        bytes_write_vec3(&out, o->from);
        bytes_write_u32(&out, o->eases);
        bytes_write_f64(&out, o->eased_s);
    }
    write_pull(&out, &self->pull);
    write_pull(&out, &self->places);
    return out.size;
}

bool pointer_load(pointer *self, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    pointer_reset(self);
    in.failed |= bytes_read_u32(&in) != STORE_VERSION;
    self->is_known = bytes_read_u32(&in) != 0;
    bytes_read(&in, &self->time_ns, sizeof self->time_ns);
    uint32_t grip = bytes_read_u32(&in);
    in.failed |= grip > POINTER_NEUTRAL;
    self->grip = (pointer_grip)grip;
    self->stays = bytes_read_u32(&in) != 0;
    self->radius_mm = (float)bytes_read_f64(&in);
    self->held_rest = bytes_read_vec3(&in);
    self->held_at = bytes_read_vec3(&in);
    self->at = bytes_read_vec3(&in);
    self->held = bytes_read_u32(&in);
    self->restores = bytes_read_u32(&in) != 0;
    self->restores_s = bytes_read_f64(&in);
    uint32_t count = bytes_read_u32(&in);
    in.failed |= count > POINTER_KEPT_MAX + 1;
    for (uint32_t i = 0; i < count && !in.failed; ++i) {
        pointer_offset *o = &self->offset[self->count++];
        o->contact = bytes_read_u32(&in);
        o->rest = bytes_read_vec3(&in);
        o->offset = bytes_read_vec3(&in);
        o->from = bytes_read_vec3(&in);
        o->eases = bytes_read_u32(&in) != 0;
        o->eased_s = bytes_read_f64(&in);
    }
    read_pull(&in, &self->pull);
    read_pull(&in, &self->places);
    if (!in.failed && in.at == in.end)
        return true;
    pointer_reset(self);
    return false;
}

void pointer_shift_time(pointer *self, int64_t by_ns)
{
    self->time_ns = (int64_t)((uint64_t)self->time_ns + (uint64_t)by_ns);
}
