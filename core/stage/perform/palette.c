#include "stage/perform/palette.h"
#include "base/bytes.h"
#include "base/clock.h"

#include <math.h>
#include <string.h>

enum { STORE_VERSION = 2, STORE_WITHOUT_SHARES = 1 };
static const double dt_most_s = 0.1; /* as of a frame */

void palette_init(palette *out, const mapped_face *mapped)
{
    const uint32_t count = mapped->pose_count;
    *out = (palette){.mapped = mapped,
                     .count = count < PALETTE_POSES_MAX ? count : (uint32_t)PALETTE_POSES_MAX};
    palette_reset(out);
}

void palette_reset(palette *self)
{
    self->is_known = false;
    self->time_ns = 0;
    self->dt_s = 0.0;
    self->jaw = self->lips = 1.0;
    self->pull = guard_idle();
    memset(self->pose, 0, sizeof self->pose);
}

/* ---- samples ---- */

bool palette_is_route(const channel_route *route)
{
    return route->table.count > 0 && route->table.channel[0].semantic == PALETTE_SEMANTIC;
}

/* Looks from `first` on, because the channels have the order of the poses. Returns `count` if there
 * is no such pose. */
static uint32_t find_pose(const palette *self, const char *name, uint32_t first)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        const uint32_t at = (first + i) % self->count;
        if (strncmp(self->mapped->pose[at].name, name, CHANNEL_NAME - 1) == 0)
            return at;
    }
    return self->count;
}

static double within(double value, double most)
{
    return fmin(fmax(value, 0.0), most);
}

static void read_sample(palette *self, const channel_route *route, const mrt_sample *sample)
{
    const channel_table *table = &route->table;
    const double fade_s = within((double)sample->value[0], PALETTE_FADE_MOST_S);
    uint32_t at = 0;
    for (uint32_t c = 1; c < table->count && c < sample->count; ++c) {
        const uint32_t semantic = table->channel[c].semantic;
        if (semantic == PALETTE_JAW || semantic == PALETTE_LIPS) {
            double *share = semantic == PALETTE_JAW ? &self->jaw : &self->lips;
            *share = within((double)sample->value[c], PALETTE_SHARE_MOST);
            continue;
        }
        const uint32_t found = find_pose(self, table->channel[c].name, at);
        if (found == self->count)
            continue;
        at = (found + 1) % self->count;
        palette_pose *pose = &self->pose[found];
        const double wanted = within((double)sample->value[c], 1.0);
        if (wanted >= pose->wanted && wanted <= pose->wanted)
            continue;
        *pose = (palette_pose){
            .wanted = wanted, .from = pose->strength, .strength = pose->strength, .fade_s = fade_s};
    }
}

/* ---- strengths and pull ---- */

static void ease(palette_pose *pose, double passed_s)
{
    pose->since_s = fmin(pose->since_s + passed_s, pose->fade_s);
    const double share = pose->fade_s > 0.0 ? pose->since_s / pose->fade_s : 1.0;
    const double eased = share * share * (3.0 - 2.0 * share);
    pose->strength = share < 1.0 ? pose->from + (pose->wanted - pose->from) * eased : pose->wanted;
}

static bool is_of_jaw(const char *dof)
{
    return strncmp(dof, "jaw.", 4) == 0;
}

/* Adds a pose to `offset`, one vector for each contact, and to the degrees of freedom. */
static void add_pose(const palette *self, uint32_t which, vec3 *offset, double *dof)
{
    const mrt_face *about = &self->mapped->about;
    const mrt_rig_pose *pose = &self->mapped->pose[which];
    const double strength = self->pose[which].strength;
    for (uint32_t k = 0; k < about->contact_count && k < MRT_MAX_VECTORS; ++k) {
        const mrt_vec3 p = pose->pulls[k];
        offset[k] = vec3_add(offset[k], vec3_scale((vec3){(double)p.x, (double)p.y, (double)p.z},
                                                   strength * self->lips));
    }
    for (uint32_t d = 0; d < about->dof_count && d < MRT_MAX_DOFS; ++d)
        dof[d] +=
            strength * (is_of_jaw(about->dofs[d].name) ? self->jaw : 1.0) * (double)pose->dofs[d];
}

static void write_vector(mrt_vector *out, mrt_vec3 rest, vec3 offset, uint32_t contact)
{
    *out = (mrt_vector){.start = rest, .contact = contact + 1};
    out->end = (mrt_vec3){(float)((double)rest.x + offset.x), (float)((double)rest.y + offset.y),
                          (float)((double)rest.z + offset.z)};
}

/* Lists the contacts that are moved, then the others. */
static void order_contacts(palette *self, const vec3 *offset, uint32_t *out)
{
    const uint32_t count = self->mapped->about.contact_count;
    self->contact_count = count < MRT_MAX_VECTORS ? count : (uint32_t)MRT_MAX_VECTORS;
    uint32_t at = 0;
    for (int is_rest = 0; is_rest < 2; ++is_rest) {
        for (uint32_t k = 0; k < self->contact_count; ++k)
            if ((vec3_length(offset[k]) > 0.0) == (is_rest == 0))
                out[at++] = k;
        self->moved_count = is_rest ? self->moved_count : at;
    }
}

static void pull(palette *self, const guard *reach)
{
    const mrt_face *about = &self->mapped->about;
    vec3 offset[MRT_MAX_VECTORS] = {{0}};
    double dof[MRT_MAX_DOFS] = {0};
    bool has_strength = false;
    self->pull = guard_idle();
    for (uint32_t i = 0; i < self->count; ++i) {
        if (!(self->pose[i].strength > 0.0))
            continue;
        has_strength = true;
        add_pose(self, i, offset, dof);
    }
    if (!has_strength)
        return;
    uint32_t contact[MRT_MAX_VECTORS] = {0};
    order_contacts(self, offset, contact);
    self->pull.mode = MRT_ANCHORED;
    self->pull.count = self->contact_count;
    for (uint32_t d = 0; d < about->dof_count && d < MRT_MAX_DOFS; ++d)
        self->pull.dof[d] = (float)dof[d];
    double share = 1.0;
    do {
        for (uint32_t k = 0; k < self->pull.count; ++k)
            write_vector(&self->pull.vector[k], about->contacts[contact[k]].rest,
                         vec3_scale(offset[contact[k]], share), contact[k]);
        share *= 0.5;
    } while (guard_fault(reach, &self->pull) && share > 1e-3);
    if (guard_fault(reach, &self->pull))
        self->pull = guard_idle();
}

bool palette_read(palette *self, const guard *reach, const sample_step *s)
{
    bool has_palette = false;
    for (uint32_t i = 0; i < s->count; ++i)
        has_palette |= palette_is_route(s->of[i].route);
    if (!has_palette)
        return false;
    const int64_t passed_ns = s->time_ns - self->time_ns;
    const double passed_s =
        self->is_known && passed_ns > 0 ? (double)passed_ns / (double)NS_PER_S : 0.0;
    self->is_known = true;
    self->time_ns = s->time_ns;
    self->dt_s = fmin(passed_s, dt_most_s);
    for (uint32_t i = 0; i < self->count; ++i)
        ease(&self->pose[i], passed_s);
    for (uint32_t i = 0; i < s->count; ++i)
        if (palette_is_route(s->of[i].route))
            read_sample(self, s->of[i].route, &s->of[i].sample);
    pull(self, reach);
    return true;
}

void palette_hold_rest(palette *self, bool is_held)
{
    const uint32_t dof_count = self->mapped->about.dof_count;
    if (self->pull.mode == MRT_IDLE)
        return;
    self->pull.count = is_held ? self->contact_count : self->moved_count;
    for (uint32_t d = 0; d < dof_count && d < MRT_MAX_DOFS; ++d) {
        float *dof = &self->pull.dof[d];
        if (isnan(*dof) || !(fabsf(*dof) > 0.0f))
            *dof = is_held ? 0.0f : NAN;
    }
}

bool palette_is_settled(const palette *self)
{
    bool is_settled = true;
    for (uint32_t i = 0; i < self->count; ++i)
        is_settled &= self->pose[i].since_s >= self->pose[i].fade_s;
    return is_settled;
}

/* ---- save and load ---- */

/* Hash of the names of the poses, in their order. */
static uint32_t sum_of_names(const palette *self)
{
    uint32_t sum = 2166136261u;
    for (uint32_t i = 0; i < self->count; ++i)
        for (const char *at = self->mapped->pose[i].name;; ++at) {
            sum = (sum ^ (unsigned char)*at) * 16777619u;
            if (!*at)
                break;
        }
    return sum;
}

static bool is_at_rest(const palette_pose *pose)
{
    return !(pose->wanted > 0.0) && !(pose->strength > 0.0);
}

size_t palette_save(const palette *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    uint32_t count = 0;
    for (uint32_t i = 0; i < self->count; ++i)
        count += !is_at_rest(&self->pose[i]);
    bytes_write_u32(&out, STORE_VERSION);
    bytes_write_u32(&out, sum_of_names(self));
    bytes_write_u32(&out, self->is_known);
    bytes_write(&out, &self->time_ns, sizeof self->time_ns);
    bytes_write_f64(&out, self->dt_s);
    bytes_write_f64(&out, self->jaw);
    bytes_write_f64(&out, self->lips);
    bytes_write_u32(&out, count);
    for (uint32_t i = 0; i < self->count; ++i) {
        const palette_pose *pose = &self->pose[i];
        if (is_at_rest(pose))
            continue;
        bytes_write_u32(&out, i);
        bytes_write_f64(&out, pose->wanted);
        bytes_write_f64(&out, pose->from);
        bytes_write_f64(&out, pose->strength);
        bytes_write_f64(&out, pose->since_s);
        bytes_write_f64(&out, pose->fade_s);
    }
    return out.size;
}

static bool is_share(double value)
{
    return value >= 0.0 && value <= 1.0;
}

static void read_pose(bytes_in *in, palette *self)
{
    const uint32_t at = bytes_read_u32(in);
    palette_pose pose;
    pose.wanted = bytes_read_f64(in);
    pose.from = bytes_read_f64(in);
    pose.strength = bytes_read_f64(in);
    pose.since_s = bytes_read_f64(in);
    pose.fade_s = bytes_read_f64(in);
    in->failed = in->failed || at >= self->count || !is_share(pose.wanted) ||
                 !is_share(pose.from) || !is_share(pose.strength) || !(pose.since_s >= 0.0) ||
                 !(pose.fade_s <= PALETTE_FADE_MOST_S) || !(pose.since_s <= pose.fade_s);
    if (!in->failed)
        self->pose[at] = pose;
}

bool palette_load(palette *self, const guard *reach, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    palette_reset(self);
    const uint32_t version = bytes_read_u32(&in);
    in.failed |= version != STORE_VERSION && version != STORE_WITHOUT_SHARES;
    in.failed |= bytes_read_u32(&in) != sum_of_names(self);
    self->is_known = bytes_read_u32(&in) != 0;
    bytes_read(&in, &self->time_ns, sizeof self->time_ns);
    self->dt_s = bytes_read_f64(&in);
    self->jaw = version == STORE_WITHOUT_SHARES ? 1.0 : bytes_read_f64(&in);
    self->lips = version == STORE_WITHOUT_SHARES ? 1.0 : bytes_read_f64(&in);
    in.failed |= !is_share(self->jaw / PALETTE_SHARE_MOST);
    in.failed |= !is_share(self->lips / PALETTE_SHARE_MOST);
    const uint32_t count = bytes_read_u32(&in);
    in.failed |= count > self->count || !(self->dt_s >= 0.0 && self->dt_s <= dt_most_s);
    for (uint32_t i = 0; i < count && !in.failed; ++i)
        read_pose(&in, self);
    if (!in.failed && in.at == in.end) {
        pull(self, reach);
        return true;
    }
    palette_reset(self);
    return false;
}

void palette_shift_time(palette *self, int64_t by_ns)
{
    self->time_ns = (int64_t)((uint64_t)self->time_ns + (uint64_t)by_ns);
}
