/* Loose parts: the bones with a spring. Each part is a mass at its tip. A spring pulls it to the
 * place where the bone would carry it without a swing, the air slows it, and its weight pulls it
 * down where its parent tilts. The step is the implicit midpoint rule, which is stable for every
 * frequency and damping, in equal substeps of at most 1/240 s. The mass moves in the plane of the
 * turns of its bone, so its place is a swing of these turns: an angle each. */
#include "face/frame/frame.h"

#include <math.h>
#include <string.h>

static const double substep_most_s = 1.0 / 240.0;
static const double step_most_s = 0.1;      /* a longer gap passes as this span */
static const double gravity_mm_s2 = 9810.0; /* down is -y */
/* A parent that is faster than this was placed elsewhere. It carries its loose parts along. */
static const double turn_most_rad_s = 30.0;
static const double limits_most = 3.0;     /* of the mass: in limits of its turns */
static const double leverage_least = 0.05; /* sine: a turn about the axis of the part is no swing */
static const double still_mm = 1e-3, still_mm_s = 1e-2; /* a smaller swing is none */

static double clamped(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static const rig_bone *bone_of(const face *f, const face_spring *s)
{
    return &f->rig->bone[s->bone];
}

/* ---- degrees of freedom ---- */

void face_add_swing(const face *f, float *out, const float *dof)
{
    memmove(out, dof, f->bones.dof_count * sizeof *out);
    for (uint32_t i = 0; i < f->springs.count; ++i) {
        const face_spring *s = &f->springs.of[i];
        for (uint32_t k = 0; k < s->turn_count; ++k) {
            const rig_turn *turn = &bone_of(f, s)->turn[s->turn[k]];
            float *to = &out[f->bones.first_dof[s->bone] + s->turn[k]];
            double driven = isnan(*to) ? 0.0 : (double)*to;
            if (s->swing_rad[k] != 0.0)
                *to = (float)(clamped(driven, turn->min_rad, turn->max_rad) +
                              f->springs.share * s->swing_rad[k]);
        }
    }
}

void face_pose_bones(const face *f, rigid *out, const float *dof)
{
    float posed[MRT_MAX_DOFS];
    face_add_swing(f, posed, dof);
    bones_pose(out, &f->bones, posed);
}

/* ---- creation ---- */

/* Returns the distance of the tip from the nearest point about which a bone below it turns. */
static double reach_of(const face *f, const face_spring *s)
{
    const vec3 tip = bone_of(f, s)->spring.tip;
    double reach_mm = vec3_length(vec3_sub(tip, bone_of(f, s)->centre));
    uint32_t at = bone_of(f, s)->parent;
    while (at != RIG_NONE && f->rig->bone[at].kind == BONE_FIXED)
        at = f->rig->bone[at].parent;
    if (at == RIG_NONE)
        return reach_mm;
    return fmax(reach_mm, vec3_length(vec3_sub(tip, f->field[at].pivot)));
}

/* Chooses the first two turns that move the tip. */
static void choose_turns(const face *f, face_spring *s)
{
    const rig_bone *bone = bone_of(f, s);
    const vec3 arm = vec3_sub(bone->spring.tip, bone->centre);
    for (uint32_t i = 0; i < bone->turn_count && s->turn_count < FACE_SWINGS; ++i) {
        const vec3 way = vec3_cross(bone->turn[i].axis, arm);
        if (vec3_length(way) > leverage_least * vec3_length(arm))
            s->turn[s->turn_count++] = i;
    }
}

void face_springs_create(face *f)
{
    for (uint32_t i = 0; f->rig && i < f->bone_count; ++i) {
        const uint32_t bone = f->bones.order[i], parent = f->rig->bone[bone].parent;
        f->springs.swings[bone] = parent != RIG_NONE && f->springs.swings[parent];
        if (!(f->rig->bone[bone].spring.frequency_hz > 0.0))
            continue;
        face_spring *s = &f->springs.of[f->springs.count++];
        *s = (face_spring){.bone = bone};
        choose_turns(f, s);
        s->reach_mm = reach_of(f, s);
        f->springs.swings[bone] = true;
    }
    face_set_springs(f, f->rig ? f->rig->springs : 0.0);
}

void face_springs_rest(face *f)
{
    f->springs.has_time = f->springs.has_before = false;
    for (uint32_t i = 0; i < f->springs.count; ++i) {
        face_spring *s = &f->springs.of[i];
        s->has_place = false;
        s->velocity = (vec3){0, 0, 0};
        memset(s->swing_rad, 0, sizeof s->swing_rad);
    }
}

void face_set_springs(face *f, double share)
{
    f->springs.share = clamped(share, 0.0, 1.0);
}

void face_shift_time(face *f, int64_t by_ns)
{
    f->springs.time_ns = (int64_t)((uint64_t)f->springs.time_ns + (uint64_t)by_ns);
    f->springs.before_ns = (int64_t)((uint64_t)f->springs.before_ns + (uint64_t)by_ns);
}

bool face_has_springs(const face *f)
{
    return f->springs.count > 0 && f->springs.share > 0.0;
}

void face_copy_swing(face *f, const face *from)
{
    const double share = f->springs.share;
    f->springs = from->springs;
    f->springs.share = share;
}

/* ---- one part ---- */

/* The place of a part without its swing, and where its turns move the tip from there. */
typedef struct place {
    vec3 tip;
    vec3 way[FACE_SWINGS]; /* mm per rad */
} place;

/* pose: of the bones, in which this one has no swing. dof: limited. */
static place place_of(const face *f, const face_spring *s, const rigid *pose, const float *dof)
{
    const rig_bone *bone = bone_of(f, s);
    const rigid still = rigid_identity();
    const rigid *parent = bone->parent != RIG_NONE ? &pose[bone->parent] : &still;
    const vec3 centre = rigid_apply(parent, bone->centre);
    place out = {.tip = rigid_apply(&pose[s->bone], bone->spring.tip)};
    rigid outer = *parent;
    for (uint32_t i = 0, k = 0; i < bone->turn_count && k < s->turn_count; ++i) {
        const double angle_rad = (double)dof[f->bones.first_dof[s->bone] + i];
        if (s->turn[k] == i) {
            const vec3 axis = rigid_rotate(&outer, bone->turn[i].axis);
            out.way[k++] = vec3_cross(axis, vec3_sub(out.tip, centre));
        }
        const rigid turn = rigid_turn(bone->centre, bone->turn[i].axis, angle_rad);
        outer = rigid_compose(&outer, &turn);
    }
    return out;
}

/* Splits an offset of the tip into angles, by least squares. */
static void split(double out_rad[FACE_SWINGS], const face_spring *s, const vec3 *way, vec3 offset)
{
    const double aa = vec3_dot(way[0], way[0]), a = vec3_dot(way[0], offset);
    out_rad[0] = s->turn_count > 0 && aa > 0.0 ? a / aa : 0.0;
    out_rad[1] = 0.0;
    if (s->turn_count < 2)
        return;
    const double ab = vec3_dot(way[0], way[1]), bb = vec3_dot(way[1], way[1]);
    const double b = vec3_dot(way[1], offset), det = aa * bb - ab * ab;
    if (!(det > 1e-3 * aa * bb))
        return; /* both turn the same way */
    out_rad[0] = (a * bb - b * ab) / det;
    out_rad[1] = (b * aa - a * ab) / det;
}

static vec3 join(const face_spring *s, const vec3 *way, const double rad[FACE_SWINGS])
{
    vec3 out = {0, 0, 0};
    for (uint32_t k = 0; k < s->turn_count; ++k)
        out = vec3_add(out, vec3_scale(way[k], rad[k]));
    return out;
}

/* Returns the angle that is shown for a swing of the mass: the same if it is small, and ever less
 * of it towards the limit, which no swing reaches. So a part never stops with a jolt. */
static double eased(double rad, double limit_rad)
{
    const double part = limit_rad > 0.0 ? rad / limit_rad : 0.0;
    return limit_rad > 0.0 ? rad / sqrt(1.0 + part * part) : 0.0;
}

/* Keeps the mass on the arc of its bone, and bounds its swing and its speed. tip: the place without
 * a swing, which moves by `carried` mm/s. */
static void constrain(const face *f, face_spring *s, const vec3 *way, vec3 tip, vec3 carried,
                      const float *driven)
{
    double rad[FACE_SWINGS], rad_s[FACE_SWINGS];
    const double angular_hz = 2.0 * ANGLE_PI * bone_of(f, s)->spring.frequency_hz;
    split(rad, s, way, vec3_sub(s->position, tip));
    split(rad_s, s, way, vec3_sub(s->velocity, carried));
    for (uint32_t k = 0; k < s->turn_count; ++k) {
        const rig_turn *turn = &bone_of(f, s)->turn[s->turn[k]];
        const double at = (double)driven[f->bones.first_dof[s->bone] + s->turn[k]];
        const double low = fmin(turn->min_rad - at, 0.0), high = fmax(turn->max_rad - at, 0.0);
        const double most_rad_s = angular_hz * limits_most * (high - low);
        rad_s[k] = clamped(rad_s[k], -most_rad_s, most_rad_s);
        if (rad[k] <= limits_most * low)
            rad_s[k] = fmax(rad_s[k], 0.0);
        if (rad[k] >= limits_most * high)
            rad_s[k] = fmin(rad_s[k], 0.0);
        rad[k] = clamped(rad[k], limits_most * low, limits_most * high);
        s->swing_rad[k] = eased(rad[k], rad[k] < 0.0 ? -low : high);
    }
    s->position = vec3_add(tip, join(s, way, rad));
    s->velocity = vec3_add(carried, join(s, way, rad_s));
}

/* Moves the mass out of the collision shapes of other bones. Where it lies in one at rest, it goes
 * no deeper. */
static bool push_out(const face *f, face_spring *s, const rigid *pose)
{
    const rig_spring *spring = &bone_of(f, s)->spring;
    bool is_pushed = false;
    for (uint32_t i = 0; i < f->rig->proxy_count; ++i) {
        const rig_proxy *solid = &f->rig->proxy[i];
        if (solid->kind != PROXY_ELLIPSOID || f->springs.swings[solid->bone])
            continue;
        const rigid back = rigid_inverse(&pose[solid->bone]);
        const vec3 radii = {solid->radii.x + spring->radius_mm, solid->radii.y + spring->radius_mm,
                            solid->radii.z + spring->radius_mm};
        const vec3 rest = vec3_sub(spring->tip, solid->centre),
                   at = vec3_sub(rigid_apply(&back, s->position), solid->centre);
        const vec3 unit_rest = {rest.x / radii.x, rest.y / radii.y, rest.z / radii.z},
                   unit = {at.x / radii.x, at.y / radii.y, at.z / radii.z};
        const double floor = fmin(vec3_length(unit_rest), 1.0), depth = vec3_length(unit);
        if (!(depth < floor) || !(depth > 0.0))
            continue;
        const vec3 out = vec3_scale(at, floor / depth - 1.0);
        const vec3 push = rigid_rotate(&pose[solid->bone], out);
        const vec3 normal = vec3_normalised(push, (vec3){0, 1, 0});
        s->position = vec3_add(s->position, push);
        s->velocity =
            vec3_sub(s->velocity, vec3_scale(normal, fmin(vec3_dot(s->velocity, normal), 0.0)));
        is_pushed = true;
    }
    return is_pushed;
}

/* Returns the acceleration by the weight: at rest the mesh has the shape that its weight gave it,
 * so only a tilt of the parent counts. */
static vec3 weight_of(const face *f, const face_spring *s, const rigid *pose)
{
    const uint32_t parent = bone_of(f, s)->parent;
    const vec3 down = {0.0, -1.0, 0.0};
    if (parent == RIG_NONE)
        return (vec3){0, 0, 0};
    const vec3 tilt = vec3_sub(down, rigid_rotate(&pose[parent], down));
    return vec3_scale(tilt, gravity_mm_s2 * bone_of(f, s)->spring.gravity);
}

/* Moves the mass for dt_s > 0, while its place without a swing goes from the last one to `to`. */
static void swing(const face *f, face_spring *s, const place *to, const rigid *pose,
                  const float *driven, double dt_s)
{
    const rig_spring *spring = &bone_of(f, s)->spring;
    const uint32_t count = (uint32_t)ceil(dt_s / substep_most_s);
    const double h = dt_s / count, angular_hz = 2.0 * ANGLE_PI * spring->frequency_hz;
    const double pull = h * angular_hz * angular_hz, loss = spring->damping * angular_hz * h,
                 hold = 1.0 + loss + 0.25 * h * pull;
    const vec3 way = vec3_sub(to->tip, s->tip), carried = vec3_scale(way, 1.0 / dt_s),
               weight = vec3_scale(weight_of(f, s, pose), h);
    const vec3 led = vec3_scale(way, (1.0 - spring->inertia) / count);
    vec3 turns[FACE_SWINGS];
    for (uint32_t i = 0; i < count; ++i) {
        const double middle = (i + 0.5) / count, end = (i + 1.0) / count;
        const vec3 goal = vec3_add(s->tip, vec3_scale(way, middle)),
                   tip = i + 1 < count ? vec3_add(s->tip, vec3_scale(way, end)) : to->tip;
        vec3 next = vec3_scale(s->velocity, 2.0 - hold);
        s->position = vec3_add(s->position, led);
        next = vec3_add(next, vec3_scale(vec3_sub(goal, s->position), pull));
        next = vec3_scale(vec3_add(next, weight), 1.0 / hold);
        s->position = vec3_add(s->position, vec3_scale(vec3_add(s->velocity, next), 0.5 * h));
        s->velocity = next;
        for (uint32_t k = 0; k < s->turn_count; ++k)
            turns[k] = vec3_add(vec3_scale(s->way[k], 1.0 - end), vec3_scale(to->way[k], end));
        constrain(f, s, turns, tip, carried, driven);
    }
    if (push_out(f, s, pose))
        constrain(f, s, to->way, to->tip, carried, driven);
}

static bool is_still(const face_spring *s, const place *to)
{
    return memcmp(&s->tip, &to->tip, sizeof s->tip) == 0 &&
           vec3_length(vec3_sub(s->position, to->tip)) < still_mm &&
           vec3_length(s->velocity) < still_mm_s;
}

/* Steps one part. dof: driven, limited. */
static void step(const face *f, face_spring *s, const rigid *pose, const float *dof, double dt_s)
{
    const place to = place_of(f, s, pose, dof);
    const double way_mm = vec3_length(vec3_sub(to.tip, s->tip));
    if (s->has_place && !(dt_s > 0.0))
        return;
    if (!s->has_place) {
        s->position = to.tip;
        s->velocity = (vec3){0, 0, 0};
    } else if (way_mm > turn_most_rad_s * dt_s * s->reach_mm) {
        double rad[FACE_SWINGS];
        split(rad, s, s->way, vec3_sub(s->position, s->tip));
        s->position = vec3_add(to.tip, join(s, to.way, rad));
        s->velocity = (vec3){0, 0, 0};
    } else {
        swing(f, s, &to, pose, dof, dt_s);
    }
    s->has_place = true;
    if (is_still(s, &to)) {
        s->position = to.tip;
        s->velocity = (vec3){0, 0, 0};
        memset(s->swing_rad, 0, sizeof s->swing_rad);
    }
    s->tip = to.tip;
    memcpy(s->way, to.way, sizeof s->way);
}

/* ---- the face ---- */

/* Turns the pulls that a bone carries along with it. */
static void carry_controls(face *f, uint32_t bone, const rigid *before, const rigid *after)
{
    const face_field *field = &f->field[bone];
    const rigid back = rigid_inverse(before);
    for (uint32_t i = 0; i < field->control_count; ++i) {
        double *row = f->weight + (size_t)3 * (field->first_column + i);
        const vec3 still = rigid_rotate(&back, vec3_row(row, 0));
        vec3_set_row(row, 0, rigid_rotate(after, still));
    }
}

/* Poses the bones that swing. Returns false if none has moved. */
static bool pose_parts(face *f)
{
    rigid pose[RIG_BONES_MAX];
    bool is_moved = false;
    face_pose_bones(f, pose, f->dof);
    for (uint32_t b = 0; b < f->bone_count; ++b)
        is_moved |= f->springs.swings[b] && memcmp(&pose[b], &f->pose[b], sizeof *pose) != 0;
    for (uint32_t b = 0; b < f->bone_count && is_moved; ++b) {
        if (!f->springs.swings[b])
            continue;
        if (f->control_count > 0)
            carry_controls(f, b, &f->pose[b], &pose[b]);
        f->pose[b] = pose[b];
        face_weigh_bone(f, f->weight, b, pose);
    }
    if (is_moved && f->shapes.count > 0)
        face_shapes_weigh(f, f->weight, f->pose);
    f->is_given &= !is_moved;
    return is_moved;
}

void face_swing_begin(face *f, int64_t time_ns)
{
    face_springs *all = &f->springs;
    if (!all->has_before || all->time_ns != time_ns)
        return;
    memcpy(all->of, all->before, all->count * sizeof *all->of);
    all->has_time = all->had_time;
    all->time_ns = all->before_ns;
    all->has_before = false;
}

static void keep_before(face_springs *all)
{
    memcpy(all->before, all->of, all->count * sizeof *all->of);
    all->had_time = all->has_time;
    all->before_ns = all->time_ns;
    all->has_before = true;
}

bool face_swing(face *f, int64_t time_ns)
{
    face_springs *all = &f->springs;
    float limited[MRT_MAX_DOFS];
    if (all->count == 0 || !(all->share > 0.0))
        return false;
    const int64_t since_ns = (int64_t)((uint64_t)time_ns - (uint64_t)all->time_ns);
    const double dt_s = all->has_time ? clamped((double)since_ns * 1e-9, 0.0, step_most_s) : 0.0;
    if (!all->has_time || since_ns > 0) {
        keep_before(all);
        all->time_ns = time_ns;
    }
    all->has_time = true;
    bones_limit(limited, &f->bones, f->dof);
    for (uint32_t i = 0; i < all->count; ++i) {
        face_spring *s = &all->of[i];
        double swing_rad[FACE_SWINGS];
        rigid pose[RIG_BONES_MAX];
        memcpy(swing_rad, s->swing_rad, sizeof swing_rad);
        memset(s->swing_rad, 0, sizeof s->swing_rad); /* the pose without its own swing */
        face_pose_bones(f, pose, f->dof);
        memcpy(s->swing_rad, swing_rad, sizeof swing_rad);
        step(f, s, pose, limited, dt_s);
    }
    const bool is_moved = pose_parts(f);
    face_note_dofs(f, f->dof);
    return is_moved;
}

bool face_dof_swings(const face *f, uint32_t dof)
{
    for (uint32_t i = 0; i < f->springs.count; ++i) {
        const face_spring *s = &f->springs.of[i];
        for (uint32_t k = 0; k < s->turn_count; ++k)
            if (f->bones.first_dof[s->bone] + s->turn[k] == dof)
                return true;
    }
    return false;
}

/* ---- stored state ---- */

static void write_parts(bytes_out *out, const face_spring *of, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        const face_spring *s = &of[i];
        bytes_write_u32(out, s->has_place);
        bytes_write_vec3(out, s->tip);
        bytes_write_vec3(out, s->position);
        bytes_write_vec3(out, s->velocity);
        for (uint32_t k = 0; k < FACE_SWINGS; ++k) {
            bytes_write_vec3(out, s->way[k]);
            bytes_write_f64(out, s->swing_rad[k]);
        }
    }
}

void face_springs_write(bytes_out *out, const face *f)
{
    const face_springs *all = &f->springs;
    if (all->count == 0)
        return;
    bytes_write_u32(out, all->count);
    bytes_write_u32(out, all->has_time);
    bytes_write(out, &all->time_ns, sizeof all->time_ns);
    write_parts(out, all->of, all->count);
    bytes_write_u32(out, all->has_before);
    bytes_write_u32(out, all->had_time);
    bytes_write(out, &all->before_ns, sizeof all->before_ns);
    if (all->has_before)
        write_parts(out, all->before, all->count);
}

static bool is_near(vec3 at, double most)
{
    return fabs(at.x) <= most && fabs(at.y) <= most && fabs(at.z) <= most;
}

static void read_parts(bytes_in *in, face_spring *of, uint32_t count)
{
    const double reach = (double)POINTS_REACH;
    for (uint32_t i = 0; i < count && !in->failed; ++i) {
        face_spring *s = &of[i];
        s->has_place = bytes_read_u32(in) != 0;
        s->tip = bytes_read_vec3(in);
        s->position = bytes_read_vec3(in);
        s->velocity = bytes_read_vec3(in);
        in->failed |= !is_near(s->tip, reach) || !is_near(s->position, reach) ||
                      !is_near(s->velocity, 1e3 * reach);
        for (uint32_t k = 0; k < FACE_SWINGS; ++k) {
            s->way[k] = bytes_read_vec3(in);
            s->swing_rad[k] = bytes_read_f64(in);
            in->failed |= !is_near(s->way[k], reach) || !(fabs(s->swing_rad[k]) <= ANGLE_PI);
        }
    }
}

void face_springs_read(bytes_in *in, face *f)
{
    face_springs *all = &f->springs;
    if (all->count == 0)
        return;
    in->failed |= bytes_read_u32(in) != all->count;
    all->has_time = bytes_read_u32(in) != 0;
    bytes_read(in, &all->time_ns, sizeof all->time_ns);
    read_parts(in, all->of, all->count);
    all->has_before = bytes_read_u32(in) != 0;
    all->had_time = bytes_read_u32(in) != 0;
    bytes_read(in, &all->before_ns, sizeof all->before_ns);
    memcpy(all->before, all->of, all->count * sizeof *all->of); /* which bones and turns */
    if (all->has_before)
        read_parts(in, all->before, all->count);
    if (in->failed)
        face_springs_rest(f);
}
