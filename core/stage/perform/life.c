#include "stage/perform/life.h"
#include "base/angle.h"
#include "base/bytes.h"
#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STORE_VERSION = 1 };
static const double dt_most_s = 0.1; /* as of a frame */
static const double degree = ANGLE_PI / 180.0;
static const double ease_s = 0.4; /* time in which a strength goes from 0 to 1 */

/* ---- channels ---- */

const mrt_channel *life_channels(void)
{
    static const mrt_channel channels[LIFE_CHANNELS] = {
        [LIFE_BLINK] = {"blink", "", LIFE_SEMANTIC, MRT_NO_HAND, 0.0f, 1.0f},
        [LIFE_GAZE] = {"gaze", "", LIFE_SEMANTIC, MRT_NO_HAND, 0.0f, 1.0f},
        [LIFE_BREATH] = {"breath", "", LIFE_SEMANTIC, MRT_NO_HAND, 0.0f, 1.0f},
        [LIFE_LEAN] = {"lean", "", LIFE_SEMANTIC, MRT_NO_HAND, 0.0f, 1.0f},
        [LIFE_SEED] = {"seed", "", LIFE_SEMANTIC, MRT_NO_HAND, 0.0f, (float)LIFE_SEED_MOST},
        [LIFE_LIDS] = {"lids", "", LIFE_SEMANTIC, MRT_NO_HAND, -1.0f, 1.0f},
        [LIFE_EYES_YAW] = {"eyes yaw", "rad", LIFE_SEMANTIC, MRT_NO_HAND, -3.2f, 3.2f},
        [LIFE_EYES_PITCH] = {"eyes pitch", "rad", LIFE_SEMANTIC, MRT_NO_HAND, -3.2f, 3.2f},
        [LIFE_TURN] = {"turn", "rad", LIFE_SEMANTIC, MRT_NO_HAND, -3.2f, 3.2f}};
    return channels;
}

bool life_is_route(const channel_route *route)
{
    return route->table.count >= LIFE_CHANNELS && route->table.channel[0].semantic == LIFE_SEMANTIC;
}

/* ---- what the face offers ---- */

/* Order of life_body.pose: blinks, then looks. [left, right] each. */
enum { POSE_BLINK = 0, POSE_UP = 2, POSE_DOWN = 4, POSE_IN = 6, POSE_OUT = 8 };
static const char *const pose_name[LIFE_POSES] = {
    [POSE_BLINK] = "eyeBlinkLeft",   "eyeBlinkRight",
    [POSE_UP] = "eyeLookUpLeft",     "eyeLookUpRight",
    [POSE_DOWN] = "eyeLookDownLeft", "eyeLookDownRight",
    [POSE_IN] = "eyeLookInLeft",     "eyeLookInRight",
    [POSE_OUT] = "eyeLookOutLeft",   "eyeLookOutRight"};
static const double pose_look_deg = 30.0; /* turn of an eye in a pose of strength 1 */

static uint32_t find_dof(const mrt_face *about, const char *name)
{
    for (uint32_t d = 0; d < about->dof_count && d < MRT_MAX_DOFS; ++d)
        if (strcmp(about->dofs[d].name, name) == 0 && strcmp(about->dofs[d].unit, "rad") == 0)
            return d;
    return LIFE_NO_DOF;
}

static uint32_t find_pose(const mapped_face *mapped, const char *name)
{
    for (uint32_t i = 0; i < mapped->pose_count; ++i)
        if (strcmp(mapped->pose[i].name, name) == 0)
            return i;
    return LIFE_NO_DOF;
}

/* A lid closes as far as the blink of the rig closes it, or else to its limit. */
static float closed_at(const mapped_face *mapped, uint32_t dof, uint32_t blink)
{
    const float at = blink == LIFE_NO_DOF ? 0.0f : mapped->pose[blink].dofs[dof];
    return at > 0.0f ? at : fmaxf(mapped->about.dofs[dof].max, 0.0f);
}

life_body life_body_of(const mapped_face *mapped)
{
    static const char *const side_name[2] = {"l", "r"}, *const lid_name[2] = {"upper", "lower"};
    const mrt_face *about = &mapped->about;
    life_body out;
    char name[32];
    for (uint32_t i = 0; i < LIFE_POSES; ++i)
        out.pose[i] = find_pose(mapped, pose_name[i]);
    for (int side = 0; side < 2; ++side) {
        for (int lid = 0; lid < 2; ++lid) {
            (void)snprintf(name, sizeof name, "lid_%s.%s.close", lid_name[lid], side_name[side]);
            const uint32_t dof = out.lid[side][lid] = find_dof(about, name);
            out.closed[side][lid] =
                dof == LIFE_NO_DOF ? 0.0f : closed_at(mapped, dof, out.pose[POSE_BLINK + side]);
        }
        (void)snprintf(name, sizeof name, "eye.%s.yaw", side_name[side]);
        out.eye_yaw[side] = find_dof(about, name);
        (void)snprintf(name, sizeof name, "eye.%s.pitch", side_name[side]);
        out.eye_pitch[side] = find_dof(about, name);
        if (out.lid[side][0] != LIFE_NO_DOF)
            out.pose[POSE_BLINK + side] = LIFE_NO_DOF;
        if (out.eye_pitch[side] != LIFE_NO_DOF)
            out.pose[POSE_UP + side] = out.pose[POSE_DOWN + side] = LIFE_NO_DOF;
        if (out.eye_yaw[side] != LIFE_NO_DOF)
            out.pose[POSE_IN + side] = out.pose[POSE_OUT + side] = LIFE_NO_DOF;
    }
    out.turn = find_dof(about, "skull.turn");
    out.nod = find_dof(about, "skull.nod");
    out.tilt = find_dof(about, "skull.tilt");
    return out;
}

const char *life_missing(const life_body *body, life_kind kind)
{
    bool has_lids = false, has_eyes = false;
    for (int side = 0; side < 2; ++side) {
        has_lids |=
            body->lid[side][0] != LIFE_NO_DOF || body->pose[POSE_BLINK + side] != LIFE_NO_DOF;
        has_eyes |=
            body->eye_yaw[side] != LIFE_NO_DOF || body->pose[POSE_OUT + side] != LIFE_NO_DOF;
    }
    if (kind == LIFE_BLINK && !has_lids)
        return "This face has no lids, so it cannot blink.";
    if (kind == LIFE_GAZE && !has_eyes)
        return "The eyes of this face cannot turn, so it cannot look around.";
    if (kind == LIFE_BREATH && body->nod == LIFE_NO_DOF)
        return "The head of this face cannot nod, so it cannot breathe.";
    if (kind == LIFE_LEAN && body->turn == LIFE_NO_DOF)
        return "The head of this face cannot turn, so it cannot lean into a turn.";
    return NULL;
}

/* ---- random numbers: PCG, 32 bits ---- */

static double random_share(life *self)
{
    const uint32_t was = self->random;
    self->random = was * UINT32_C(747796405) + UINT32_C(2891336453);
    const uint32_t word = ((was >> ((was >> 28) + 4)) ^ was) * UINT32_C(277803737);
    return (double)(((word >> 22) ^ word) >> 8) / 16777216.0;
}

static double random_within(life *self, double least, double most)
{
    return least + (most - least) * random_share(self);
}

static double random_sign(life *self)
{
    return random_share(self) < 0.5 ? -1.0 : 1.0;
}

static double limit(double value, double least, double most)
{
    return fmin(fmax(value, least), most);
}

static double smooth(double share)
{
    const double s = limit(share, 0.0, 1.0);
    return s * s * (3.0 - 2.0 * s);
}

/* ---- what the hand does ---- */

static void watch(life_watch_state *of, double value, double least, double dt_s)
{
    static const double follow_s = 0.5;
    of->slow += (value - of->slow) * fmin(dt_s / follow_s, 1.0);
    of->quiet_s = fabs(value - of->slow) > least ? 0.0 : fmin(of->quiet_s + dt_s, 60.0);
}

/* ---- blinks ---- */

/* Skewed towards short intervals, with a long tail. The strength shortens it. */
static double blink_interval_s(life *self)
{
    const double share = random_share(self);
    return (0.9 + 7.4 * share * share) * (1.46 - 0.24 * self->wanted[LIFE_BLINK]);
}

static void begin_blink(life *self, bool is_double)
{
    self->blink_s = 0.0;
    self->closing_s = 0.078 * random_within(self, 0.92, 1.08);
    self->closed_s = random_within(self, 0.020, 0.045);
    self->opening_s = random_within(self, 0.17, 0.26);
    self->is_double = is_double;
}

double life_closure(const life *self)
{
    const double since_s = self->blink_s;
    if (since_s < 0.0)
        return 0.0;
    if (since_s < self->closing_s)
        return smooth(since_s / self->closing_s);
    const double opened_s = since_s - self->closing_s - self->closed_s;
    if (opened_s <= 0.0)
        return 1.0;
    const double share = limit(opened_s / self->opening_s, 0.0, 1.0);
    return 1.0 - smooth(share * (1.6 - 0.6 * share)); /* fast at first, then slower */
}

static bool may_blink(const life *self)
{
    return self->wanted[LIFE_BLINK] > 0.0 && self->blink_s < 0.0 &&
           self->lids.quiet_s >= LIFE_LIDS_QUIET_S;
}

static void blink(life *self, double dt_s)
{
    if (self->blink_s >= 0.0) {
        self->blink_s += dt_s;
        if (self->blink_s < self->closing_s + self->closed_s + self->opening_s)
            return;
        self->blink_s = -1.0;
        const bool again = !self->is_double && random_share(self) < 0.12;
        self->is_double = again;
        self->next_blink_s = again ? random_within(self, 0.08, 0.2) : blink_interval_s(self);
        return;
    }
    self->next_blink_s -= dt_s;
    if (!may_blink(self)) {
        self->next_blink_s = fmax(self->next_blink_s, 0.0);
        return;
    }
    if (self->next_blink_s <= 0.0)
        begin_blink(self, self->is_double);
}

/* ---- gaze ---- */

/* A large shift of the gaze often comes with a blink. */
static void blink_with_gaze(life *self, double shift)
{
    static const double large = 9.0 * ANGLE_PI / 180.0, least_apart_s = 0.8;
    if (shift > large && random_share(self) < 0.4 && may_blink(self) &&
        self->next_blink_s > least_apart_s)
        begin_blink(self, true);
}

static void look(life *self, double yaw, double pitch, double fixation_s)
{
    const double strength = self->amount[LIFE_GAZE];
    memcpy(self->gaze_from, self->gaze, sizeof self->gaze_from);
    self->gaze_to[0] = strength * yaw * degree;
    self->gaze_to[1] = strength * pitch * degree;
    const double by[2] = {self->gaze_to[0] - self->gaze[0], self->gaze_to[1] - self->gaze[1]};
    const double shift = sqrt(by[0] * by[0] + by[1] * by[1]);
    self->saccade_s = 0.0;
    self->saccade_took_s = 0.021 + 0.0022 * shift / degree;
    self->fixation_s = self->saccade_took_s + fixation_s;
    blink_with_gaze(self, shift);
}

/* Mostly at the camera, with small corrections; sometimes beside it, seldom far aside. */
static void choose_gaze(life *self)
{
    static const double aside = 4.0 * ANGLE_PI / 180.0;
    const bool is_aside = fabs(self->gaze[0]) > aside || fabs(self->gaze[1]) > aside;
    const bool is_held = fabs(self->yaw.slow) > aside || fabs(self->pitch.slow) > aside;
    const double share = random_share(self);
    if (is_held || share < (is_aside ? 0.7 : 0.55))
        look(self, random_within(self, -1.8, 1.8), random_within(self, -1.0, 1.0),
             random_within(self, 0.5, 2.0));
    else if (share < 0.86)
        look(self, random_within(self, -8.0, 8.0), random_within(self, -4.0, 3.0),
             random_within(self, 0.4, 1.3));
    else
        look(self, random_sign(self) * random_within(self, 12.0, 20.0),
             random_within(self, -7.0, 6.0), random_within(self, 0.3, 0.9));
}

static void go_home(life *self, double dt_s)
{
    static const double home_s = 0.2;
    for (int axis = 0; axis < 2; ++axis) {
        self->gaze[axis] -= self->gaze[axis] * fmin(dt_s / home_s, 1.0);
        if (fabs(self->gaze[axis]) < 1e-4)
            self->gaze[axis] = 0.0;
        self->gaze_from[axis] = self->gaze_to[axis] = self->gaze[axis];
    }
    self->saccade_s = self->saccade_took_s;
    self->fixation_s = 0.4;
}

static void move_gaze(life *self, double dt_s)
{
    if (!(self->wanted[LIFE_GAZE] > 0.0) ||
        fmin(self->yaw.quiet_s, self->pitch.quiet_s) < LIFE_EYES_QUIET_S) {
        go_home(self, dt_s);
        return;
    }
    self->fixation_s -= dt_s;
    if (self->fixation_s <= 0.0)
        choose_gaze(self);
    self->saccade_s = fmin(self->saccade_s + dt_s, self->saccade_took_s);
    const double share =
        self->saccade_took_s > 0.0 ? smooth(self->saccade_s / self->saccade_took_s) : 1.0;
    for (int axis = 0; axis < 2; ++axis)
        self->gaze[axis] =
            self->gaze_from[axis] + (self->gaze_to[axis] - self->gaze_from[axis]) * share;
}

/* ---- breath, lean ---- */

static void breathe(life *self, double dt_s)
{
    static const double rate_hz = 14.0 / 60.0, drift_cycle_s = 1131.0;
    self->breath += self->breath_hz * dt_s;
    if (self->breath >= 1.0) {
        self->breath -= 1.0;
        self->breath_hz = rate_hz * random_within(self, 0.9, 1.1);
    }
    self->drift_s += dt_s;
    if (self->drift_s >= drift_cycle_s) /* a multiple of the periods of drift_of */
        self->drift_s -= drift_cycle_s;
}

/* -0.5 (out) .. 0.5 (in): in faster than out, then a rest. */
static double breath_wave(const life *self)
{
    static const double in = 0.4, out = 0.5;
    return self->breath < in ? smooth(self->breath / in) - 0.5
                             : 0.5 - smooth((self->breath - in) / out);
}

/* A slow movement without a visible period, -1..1. */
static double drift_of(const life *self, double first_s, double second_s)
{
    const double turns = 2.0 * ANGLE_PI * self->drift_s;
    return 0.6 * angle_sine_of(turns / first_s) + 0.4 * angle_sine_of(turns / second_s);
}

/* Follows the turn of the head with a critically damped spring, exactly for a constant target. */
static void follow_turn(life *self, double target, double dt_s)
{
    static const double per_s = 14.0, step_s = 0.01;
    while (dt_s > 0.0) {
        const double h = fmin(dt_s, step_s);
        self->turn_per_s +=
            h * (per_s * per_s * (target - self->turn) - 2.0 * per_s * self->turn_per_s);
        self->turn += h * self->turn_per_s;
        dt_s -= h;
    }
}

/* rad/s, without slow trembling */
static double lean_speed(const life *self)
{
    static const double least = 5.0 * ANGLE_PI / 180.0, most = 120.0 * ANGLE_PI / 180.0;
    const double speed = fmin(fmax(fabs(self->turn_per_s) - least, 0.0), most);
    return self->turn_per_s < 0.0 ? -speed : speed;
}

/* ---- the pull ---- */

static void add_dof(mrt_pull *to, uint32_t dof, double value)
{
    if (dof == LIFE_NO_DOF || !(fabs(value) > 0.0))
        return;
    const double before = isnan(to->dof[dof]) ? 0.0 : (double)to->dof[dof];
    to->dof[dof] = (float)(before + value);
    to->mode = MRT_ANCHORED;
}

/* Adds a pose with a strength. Its contacts stay in the pull at strength 0, so that the face is not
 * gripped again at each blink. */
static void add_pose(life *self, uint32_t which, double strength, vec3 *offset, bool *is_moved)
{
    const mrt_face *about = &self->mapped->about;
    if (self->body.pose[which] == LIFE_NO_DOF)
        return;
    const mrt_rig_pose *pose = &self->mapped->pose[self->body.pose[which]];
    for (uint32_t k = 0; k < about->contact_count && k < MRT_MAX_VECTORS; ++k) {
        const mrt_vec3 p = pose->pulls[k];
        const vec3 by = {(double)p.x, (double)p.y, (double)p.z};
        is_moved[k] |= vec3_length(by) > 0.0;
        offset[k] = vec3_add(offset[k], vec3_scale(by, strength));
    }
    for (uint32_t d = 0; d < about->dof_count && d < MRT_MAX_DOFS; ++d)
        add_dof(&self->pull, d, strength * (double)pose->dofs[d]);
}

static void add_poses(life *self, double closure, double yaw, double pitch)
{
    const mrt_face *about = &self->mapped->about;
    const double most = pose_look_deg * degree;
    vec3 offset[MRT_MAX_VECTORS] = {{0}};
    bool is_moved[MRT_MAX_VECTORS] = {false};
    for (uint32_t side = 0; side < 2; ++side) {
        const double out = side == 0 ? yaw : -yaw;
        add_pose(self, POSE_BLINK + side, closure, offset, is_moved);
        add_pose(self, POSE_UP + side, limit(pitch / most, 0.0, 1.0), offset, is_moved);
        add_pose(self, POSE_DOWN + side, limit(-pitch / most, 0.0, 1.0), offset, is_moved);
        add_pose(self, POSE_OUT + side, limit(out / most, 0.0, 1.0), offset, is_moved);
        add_pose(self, POSE_IN + side, limit(-out / most, 0.0, 1.0), offset, is_moved);
    }
    for (uint32_t k = 0; k < about->contact_count && k < MRT_MAX_VECTORS; ++k) {
        if (!is_moved[k])
            continue;
        const mrt_vec3 rest = about->contacts[k].rest;
        mrt_vector *v = &self->pull.vector[self->pull.count++];
        *v = (mrt_vector){.start = rest, .contact = k + 1};
        v->end =
            (mrt_vec3){(float)((double)rest.x + offset[k].x), (float)((double)rest.y + offset[k].y),
                       (float)((double)rest.z + offset[k].z)};
        self->pull.mode = MRT_ANCHORED;
    }
}

static void pull(life *self, const guard *reach)
{
    const life_body *body = &self->body;
    /* A lid that the hand has closed in part, or raised, is closed by the rest. */
    const double closure = life_closure(self) * (1.0 - self->seen_lids);
    const double breath = self->amount[LIFE_BREATH], lean = self->amount[LIFE_LEAN];
    const double speed = lean * lean_speed(self);
    const double nod =
        breath * degree * (0.3 * drift_of(self, 13.0, 5.8) - 1.5 * breath_wave(self)) +
        0.035 * fabs(speed);
    const double turn = breath * degree * 0.55 * drift_of(self, 11.31, 6.5);
    const double tilt = breath * degree * 0.45 * drift_of(self, 7.54, 17.4) - 0.05 * speed;
    const double is_free = limit(self->yaw.quiet_s, 0.0, 1.0);
    /* Eyes stay on what they look at while the head breathes, and lead its turns. A blink lowers
     * them a little. */
    const double yaw = self->gaze[0] + is_free * (0.12 * speed - turn);
    const double pitch = self->gaze[1] + is_free * (nod - 1.2 * degree * closure);
    self->pull = guard_idle();
    for (int side = 0; side < 2; ++side) {
        for (int lid = 0; lid < 2; ++lid)
            add_dof(&self->pull, body->lid[side][lid], closure * (double)body->closed[side][lid]);
        add_dof(&self->pull, body->eye_yaw[side], yaw);
        add_dof(&self->pull, body->eye_pitch[side], pitch);
    }
    add_dof(&self->pull, body->nod, nod);
    add_dof(&self->pull, body->turn, turn);
    add_dof(&self->pull, body->tilt, tilt);
    add_poses(self, closure, yaw, pitch);
    if (guard_fault(reach, &self->pull))
        self->pull = guard_idle();
}

/* ---- steps ---- */

void life_init(life *out, const mapped_face *mapped)
{
    *out = (life){.mapped = mapped, .body = life_body_of(mapped)};
    life_reset(out);
}

/* Begins with the random numbers of a seed. */
static void sow(life *self, uint32_t seed)
{
    self->seed = seed;
    self->random = seed * UINT32_C(2654435761) + 1;
    for (int i = 0; i < 4; ++i)
        (void)random_share(self);
    self->next_blink_s = random_within(self, 0.6, 3.0);
    self->fixation_s = random_within(self, 0.3, 1.2);
}

void life_reset(life *self)
{
    const double quiet_s = LIFE_LIDS_QUIET_S;
    *self = (life){.mapped = self->mapped,
                   .body = self->body,
                   .pull = guard_idle(),
                   .lids = {0.0, quiet_s},
                   .yaw = {0.0, quiet_s},
                   .pitch = {0.0, quiet_s},
                   .blink_s = -1.0,
                   .breath = 0.9, /* the rest after a breath: amount 0 and wave -0.5 */
                   .breath_hz = 14.0 / 60.0};
    sow(self, 0);
}

static void read_tick(life *self, const mrt_sample *sample, double dt_s)
{
    const float *value = sample->value;
    const double lids = limit((double)value[LIFE_LIDS], -1.0, 1.0);
    const uint32_t seed = (uint32_t)limit((double)value[LIFE_SEED], 0.0, LIFE_SEED_MOST);
    const double turn = (double)value[LIFE_TURN];
    if (!self->is_known) {
        self->lids.slow = lids;
        self->yaw.slow = (double)value[LIFE_EYES_YAW];
        self->pitch.slow = (double)value[LIFE_EYES_PITCH];
        self->turn = turn;
    }
    if (!self->is_known || seed != self->seed)
        sow(self, seed);
    for (int i = 0; i < LIFE_KINDS; ++i) {
        self->wanted[i] = limit((double)value[i], 0.0, 1.0);
        const double by = limit(self->wanted[i] - self->amount[i], -dt_s / ease_s, dt_s / ease_s);
        self->amount[i] += by;
    }
    watch(&self->lids, lids, 0.04, dt_s);
    if (lids > 0.15)
        self->lids.quiet_s = 0.0;
    watch(&self->yaw, (double)value[LIFE_EYES_YAW], 0.03, dt_s);
    watch(&self->pitch, (double)value[LIFE_EYES_PITCH], 0.03, dt_s);
    self->seen_lids = lids;
    follow_turn(self, turn, dt_s);
    move_gaze(self, dt_s);
    blink(self, dt_s);
    breathe(self, dt_s);
}

bool life_read(life *self, const guard *reach, const sample_step *s)
{
    const mrt_sample *tick = NULL;
    for (uint32_t i = 0; i < s->count; ++i)
        if (life_is_route(s->of[i].route) && s->of[i].sample.count >= LIFE_CHANNELS)
            tick = &s->of[i].sample;
    if (!tick)
        return false;
    const int64_t passed_ns = s->time_ns - self->time_ns;
    const double dt_s =
        self->is_known && passed_ns > 0 ? (double)passed_ns / (double)NS_PER_S : 0.0;
    read_tick(self, tick, fmin(dt_s, dt_most_s));
    self->is_known = true;
    self->time_ns = s->time_ns;
    pull(self, reach);
    return true;
}

/* ---- what the rest of the performance does ---- */

static double dof_at(const float *dof, uint32_t at)
{
    return at == LIFE_NO_DOF || isnan(dof[at]) ? 0.0 : (double)dof[at];
}

/* Rounded, because it is recorded: what no eye sees costs no bytes. */
static float rounded(double value)
{
    static const double steps = 512.0;
    return (float)(floor(value * steps + 0.5) / steps);
}

void life_watch(sample_step *s, const life_body *body, const float *dof)
{
    for (uint32_t i = 0; i < s->count; ++i) {
        mrt_sample *to = &s->of[i].sample;
        if (!life_is_route(s->of[i].route) || to->count < LIFE_CHANNELS)
            continue;
        double lids = 0.0;
        for (int side = 0; side < 2; ++side) {
            const double closed = (double)body->closed[side][0];
            const double at = dof_at(dof, body->lid[side][0]);
            const double share = closed > 0.0 ? at / closed : 0.0;
            lids = fabs(share) > fabs(lids) ? share : lids;
        }
        to->value[LIFE_LIDS] = rounded(limit(lids, -1.0, 1.0));
        to->value[LIFE_EYES_YAW] = rounded(dof_at(dof, body->eye_yaw[0]));
        to->value[LIFE_EYES_PITCH] = rounded(dof_at(dof, body->eye_pitch[0]));
        to->value[LIFE_TURN] = rounded(dof_at(dof, body->turn));
    }
}

/* ---- save and load ---- */

static void write_watch(bytes_out *out, const life_watch_state *of)
{
    bytes_write_f64(out, of->slow);
    bytes_write_f64(out, of->quiet_s);
}

static void read_watch(bytes_in *in, life_watch_state *of)
{
    of->slow = bytes_read_f64(in);
    of->quiet_s = bytes_read_f64(in);
    in->failed |= !(of->quiet_s >= 0.0) || fabs(of->slow) > 1e3;
}

/* The numbers of the state that have no other type, for both directions. */
enum { NUMBERS = 20 };
static void list_numbers(life *self, double *out[NUMBERS])
{
    double *const all[NUMBERS] = {
        &self->seen_lids,      &self->blink_s,      &self->closing_s,    &self->closed_s,
        &self->opening_s,      &self->next_blink_s, &self->gaze_from[0], &self->gaze_from[1],
        &self->gaze_to[0],     &self->gaze_to[1],   &self->gaze[0],      &self->gaze[1],
        &self->saccade_s,      &self->fixation_s,   &self->breath,       &self->breath_hz,
        &self->saccade_took_s, &self->drift_s,      &self->turn,         &self->turn_per_s};
    memcpy(out, all, sizeof all);
}

size_t life_save(const life *self, void *bytes, size_t capacity)
{
    bytes_out out = {.data = bytes, .capacity = bytes ? capacity : 0};
    life copy = *self;
    double *number[NUMBERS];
    list_numbers(&copy, number);
    bytes_write_u32(&out, STORE_VERSION);
    bytes_write_u32(&out, self->is_known);
    bytes_write(&out, &self->time_ns, sizeof self->time_ns);
    bytes_write_u32(&out, self->seed);
    bytes_write_u32(&out, self->random);
    bytes_write_u32(&out, self->is_double);
    for (int i = 0; i < LIFE_KINDS; ++i) {
        bytes_write_f64(&out, self->wanted[i]);
        bytes_write_f64(&out, self->amount[i]);
    }
    write_watch(&out, &self->lids);
    write_watch(&out, &self->yaw);
    write_watch(&out, &self->pitch);
    for (int i = 0; i < NUMBERS; ++i)
        bytes_write_f64(&out, *number[i]);
    return out.size;
}

static bool is_share(double value)
{
    return value >= 0.0 && value <= 1.0;
}

static void read_state(bytes_in *in, life *self)
{
    double *number[NUMBERS];
    list_numbers(self, number);
    self->is_known = bytes_read_u32(in) != 0;
    bytes_read(in, &self->time_ns, sizeof self->time_ns);
    self->seed = bytes_read_u32(in);
    self->random = bytes_read_u32(in);
    self->is_double = bytes_read_u32(in) != 0;
    for (int i = 0; i < LIFE_KINDS; ++i) {
        self->wanted[i] = bytes_read_f64(in);
        self->amount[i] = bytes_read_f64(in);
        in->failed |= !is_share(self->wanted[i]) || !is_share(self->amount[i]);
    }
    read_watch(in, &self->lids);
    read_watch(in, &self->yaw);
    read_watch(in, &self->pitch);
    for (int i = 0; i < NUMBERS; ++i) {
        *number[i] = bytes_read_f64(in);
        in->failed |= fabs(*number[i]) > 1e4;
    }
    in->failed |= fabs(self->seen_lids) > 1.0 || !is_share(self->breath) ||
                  !(self->closing_s >= 0.0) || !(self->opening_s >= 0.0) ||
                  !(self->breath_hz > 0.0) || !(self->saccade_took_s >= 0.0);
}

bool life_load(life *self, const guard *reach, const void *bytes, size_t size)
{
    bytes_in in = {.at = bytes, .end = (const unsigned char *)bytes + size};
    life_reset(self);
    in.failed |= bytes_read_u32(&in) != STORE_VERSION;
    read_state(&in, self);
    if (!in.failed && in.at == in.end) {
        if (self->is_known)
            pull(self, reach);
        return true;
    }
    life_reset(self);
    return false;
}

void life_shift_time(life *self, int64_t by_ns)
{
    self->time_ns = (int64_t)((uint64_t)self->time_ns + (uint64_t)by_ns);
}
