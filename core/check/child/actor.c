#include "check/child/actor.h"

#include "base/hash.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/wire.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- valid pulls ---- */

typedef struct pull_limits {
    const mrt_face *face;
    const double *centre; /* mm, three numbers */
    double reach_mm;
} pull_limits;

static bool is_finite(mrt_vec3 p)
{
    return isfinite(p.x) && isfinite(p.y) && isfinite(p.z);
}

static double from_centre_mm(mrt_vec3 p, const double *centre)
{
    double x = (double)p.x - centre[0], y = (double)p.y - centre[1], z = (double)p.z - centre[2];
    return sqrt(x * x + y * y + z * z);
}

static bool judge_point(mrt_vec3 p, const char *what, uint32_t i, const pull_limits *limits,
                        const char *where)
{
    if (!is_finite(p)) {
        tell_failed(RULE_MAPPING_FINITE, "%s: the %s of vector %u is (%g, %g, %g)", where, what, i,
                    (double)p.x, (double)p.y, (double)p.z);
        return false;
    }
    double far_mm = from_centre_mm(p, limits->centre);
    if (far_mm <= limits->reach_mm)
        return true;
    tell_failed(RULE_MAPPING_REACH,
                "%s: the %s of vector %u is %.4g mm from the face's centre. The guard limits "
                "that to %.4g mm",
                where, what, i, far_mm, limits->reach_mm);
    return false;
}

static bool judge_vectors(const mrt_pull *pull, const pull_limits *limits, const char *where)
{
    for (uint32_t i = 0; i < pull->count; ++i) {
        const mrt_vector *v = &pull->vector[i];
        if (!judge_point(v->start, "start", i, limits, where) ||
            !judge_point(v->end, "end", i, limits, where))
            return false;
        if (v->contact > limits->face->contact_count) {
            tell_failed(RULE_MAPPING_CONTACT,
                        "%s: vector %u pulls contact %u, but the face has %u: use 1 to %u, or 0",
                        where, i, v->contact, limits->face->contact_count,
                        limits->face->contact_count);
            return false;
        }
    }
    return true;
}

static bool judge_scalars(const mrt_pull *pull, const char *where)
{
    bool is_good = true;
    if (!isfinite(pull->radius_mm) || pull->radius_mm < 0.0f) {
        tell_failed(RULE_MAPPING_RADIUS, "%s: radius_mm is %g", where, (double)pull->radius_mm);
        is_good = false;
    }
    if (!isfinite(pull->leak_per_s) || pull->leak_per_s < 0.0f) {
        tell_failed(RULE_MAPPING_LEAK, "%s: leak_per_s is %g", where, (double)pull->leak_per_s);
        is_good = false;
    }
    if (pull->gate > 1) {
        tell_failed(RULE_MAPPING_GATE, "%s: gate is %u", where, pull->gate);
        is_good = false;
    }
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        if (isinf(pull->dof[i])) {
            tell_failed(RULE_MAPPING_FINITE, "%s: dof[%d] is infinite", where, i);
            is_good = false;
        }
    return is_good;
}

/* Returns false if the pull breaks a rule, which is reported. where: "frame 12 of a random
 * walk". */
static bool pull_judge(const mrt_pull *pull, const pull_limits *limits, const char *where)
{
    if (pull->mode > MRT_UNANCHORED) {
        tell_failed(RULE_MAPPING_MODE, "%s: mode is %u", where, pull->mode);
        return false;
    }
    if (pull->count > MRT_MAX_VECTORS) {
        tell_failed(RULE_MAPPING_COUNT, "%s: count is %u, at most %d", where, pull->count,
                    MRT_MAX_VECTORS);
        return false;
    }
    bool is_good = judge_scalars(pull, where);
    return judge_vectors(pull, limits, where) && is_good;
}

/* ---- consecutive pulls ---- */

static bool is_same_point(mrt_vec3 a, mrt_vec3 b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Both are anchored: starts must not change while `anchor` does not change. */
static void pull_judge_anchor(const mrt_pull *before, const mrt_pull *now, const char *where)
{
    if (now->anchor != before->anchor)
        return;
    if (now->count != before->count)
        tell_failed(RULE_MAPPING_ANCHOR,
                    "%s: %u anchored vectors became %u, but anchor is still %u", where,
                    before->count, now->count, now->anchor);
    for (uint32_t i = 0; i < now->count && i < before->count; ++i)
        if (!is_same_point(now->vector[i].start, before->vector[i].start) ||
            now->vector[i].contact != before->vector[i].contact) {
            tell_failed(RULE_MAPPING_ANCHOR,
                        "%s: the start of vector %u (or its contact) changed, but anchor is "
                        "still %u",
                        where, i, now->anchor);
            return;
        }
}

static mrt_vec3 way_of(const mrt_vector *v)
{
    return (mrt_vec3){v->end.x - v->start.x, v->end.y - v->start.y, v->end.z - v->start.z};
}

static double distance_mm(mrt_vec3 a, mrt_vec3 b)
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y;
    double z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

/* Returns the jump of a vector: the least distance of its displacement from 0, or from that of the
 * same point in the last hold. */
static double jump_mm(const mrt_pull *before, const mrt_vector *v)
{
    mrt_vec3 way = way_of(v);
    double least = distance_mm(way, (mrt_vec3){0, 0, 0});
    for (uint32_t k = 0; before && k < before->count; ++k)
        if (before->vector[k].contact == v->contact &&
            is_same_point(before->vector[k].start, v->start))
            least = fmin(least, distance_mm(way, way_of(&before->vector[k])));
    return least;
}

/* now: first pull of a new hold; before: last pull of the previous one, or NULL. */
static void pull_judge_hold(const mrt_pull *before, const mrt_pull *now, double max_jump_mm,
                            const char *where)
{
    for (uint32_t i = 0; i < now->count; ++i) {
        double mm = jump_mm(before, &now->vector[i]);
        if (mm <= max_jump_mm)
            continue;
        tell_failed(RULE_MAPPING_JUMP,
                    "%s: a new hold begins %.3g mm away from the current place of the face "
                    "(vector %u)",
                    where, mm, i);
        return;
    }
}

/* ---- comparison ---- */

/* All NaNs are equal: not driven. */
static float plain(float dof)
{
    return isnan(dof) ? NAN : dof;
}

static uint64_t pull_sum(const mrt_pull *pull)
{
    uint64_t sum = HASH_START;
    uint32_t count = pull->count < MRT_MAX_VECTORS ? pull->count : MRT_MAX_VECTORS;
    sum = hash_bytes(sum, pull, offsetof(mrt_pull, vector));
    sum = hash_bytes(sum, pull->vector, count * sizeof *pull->vector);
    for (int i = 0; i < MRT_MAX_DOFS; ++i) {
        float dof = plain(pull->dof[i]);
        sum = hash_bytes(sum, &dof, sizeof dof);
    }
    return sum;
}

static void say_points(char *out, size_t capacity, const char *what, uint32_t i, mrt_vec3 a,
                       mrt_vec3 b)
{
    (void)snprintf(out, capacity, "vector %u %s at (%.9g, %.9g, %.9g) and (%.9g, %.9g, %.9g)", i,
                   what, (double)a.x, (double)a.y, (double)a.z, (double)b.x, (double)b.y,
                   (double)b.z);
}

/* Writes the difference: "vector 3 ends at (1, 2, 3) and (1, 2, 4)"; "": equal to the bit. */
static void pull_difference(const mrt_pull *a, const mrt_pull *b, char *out, size_t capacity)
{
    out[0] = '\0';
    if (pull_sum(a) == pull_sum(b))
        return;
    if (a->mode != b->mode || a->count != b->count) {
        (void)snprintf(out, capacity, "mode %u of %u vectors and mode %u of %u", a->mode, a->count,
                       b->mode, b->count);
        return;
    }
    if (a->anchor != b->anchor || a->commit != b->commit || a->gate != b->gate) {
        (void)snprintf(out, capacity, "anchor, commit, gate %u, %u, %u and %u, %u, %u", a->anchor,
                       a->commit, a->gate, b->anchor, b->commit, b->gate);
        return;
    }
    for (uint32_t i = 0; i < a->count && i < MRT_MAX_VECTORS; ++i) {
        const mrt_vector *v = &a->vector[i], *w = &b->vector[i];
        if (!is_same_point(v->start, w->start))
            say_points(out, capacity, "starts", i, v->start, w->start);
        else if (!is_same_point(v->end, w->end))
            say_points(out, capacity, "ends", i, v->end, w->end);
        else if (v->contact != w->contact)
            (void)snprintf(out, capacity, "vector %u pulls contact %u and %u", i, v->contact,
                           w->contact);
        if (out[0])
            return;
    }
    for (int i = 0; i < MRT_MAX_DOFS; ++i) {
        float x = plain(a->dof[i]), y = plain(b->dof[i]);
        if (memcmp(&x, &y, sizeof x) == 0)
            continue;
        (void)snprintf(out, capacity, "dof[%d] is %.9g and %.9g", i, (double)x, (double)y);
        return;
    }
    (void)snprintf(out, capacity, "radius, leak %.9g, %.9g and %.9g, %.9g", (double)a->radius_mm,
                   (double)a->leak_per_s, (double)b->radius_mm, (double)b->leak_per_s);
}

/* ---- a running mapping ---- */

enum { CANARY = 0xa5 };

/* ---- forbidden calls on the frame thread ---- */

void actor_frame_enter(void)
{
    watch_frame_enter();
    (void)trap_set(TRAP_ALL);
}

void actor_frame_leave(const char *function)
{
    static const check_rule rules[TRAP_KINDS] = {[TRAP_ALLOCATION] = RULE_FRAME_ALLOCATION,
                                                 [TRAP_LOCK] = RULE_FRAME_LOCK,
                                                 [TRAP_FILE] = RULE_FRAME_FILE,
                                                 [TRAP_NETWORK] = RULE_FRAME_NETWORK,
                                                 [TRAP_CLOCK] = RULE_FRAME_CLOCK,
                                                 [TRAP_SLEEP] = RULE_FRAME_SLEEP,
                                                 [TRAP_PROCESS] = RULE_FRAME_PROCESS,
                                                 [TRAP_HOST] = RULE_FRAME_HOST};
    char caught[320];
    (void)trap_set(0);
    watch_frame_leave();
    for (int kind = 0; kind < TRAP_KINDS; ++kind)
        if (trap_caught((trap_kind)kind, caught, sizeof caught))
            tell_failed(rules[kind], "%s called %s", function, caught);
}

/* ---- creation and activation ---- */

static uint64_t sum_poses(face_poses poses, const mrt_face *face)
{
    uint64_t sum = hash_bytes(HASH_START, poses.pose, poses.count * sizeof *poses.pose);
    for (uint32_t i = 0; i < poses.count; ++i) {
        const mrt_rig_pose *p = &poses.pose[i];
        sum = hash_bytes(sum, p->name, strlen(p->name));
        sum = hash_bytes(sum, p->pulls, face->contact_count * sizeof *p->pulls);
        sum = hash_bytes(sum, p->dofs, face->dof_count * sizeof *p->dofs);
    }
    return sum;
}

static void set_poses(actor *self, const mrt_face *face)
{
    char doing[WIRE_TEXT];
    const check_rule blamed = tell_blamed();
    self->poses_sum = sum_poses(self->poses, face);
    (void)snprintf(doing, sizeof doing, "%s", tell_what());
    tell_doing(RULE_RIG_POSES_SET, "set() with %u poses", self->poses.count);
    watch_next();
    self->rig_poses->set(self->self, face, self->poses.pose, self->poses.count);
    tell_doing(blamed, "%s", doing);
}

static bool activate(actor *self, const mrt_face *face, face_poses poses, bool *out_refused)
{
    mrt_face copy = *face;
    uint32_t errors_before = self->host.error_count;
    self->face = face;
    self->poses = poses;
    self->reach_mm = faces_reach_mm(face, self->centre);
    if (self->rig_poses)
        set_poses(self, face);
    watch_next();
    mrt_result result = self->functions->activate(self->self, face);
    if (memcmp(&copy, face, sizeof copy) != 0)
        tell_failed(RULE_MAPPING_CONST, "activate() wrote to the face");
    *out_refused = result < 0;
    if (result >= 0)
        return true;
    if (self->host.error_count == errors_before)
        tell_failed(RULE_RUN_EXPLAINED, "activate() returned %d, but logged no error", result);
    return false;
}

bool actor_open_posed(actor *out, const mrt_plugin_type *type, const mrt_face *face,
                      face_poses poses, bool *out_refused)
{
    *out_refused = false;
    *out = (actor){.type = type,
                   .functions = types_interface(type, MRT_MAPPING),
                   .rig_poses = types_interface(type, MRT_RIG_POSES)};
    memset(out->room.before, CANARY, sizeof out->room.before);
    memset(out->room.after, CANARY, sizeof out->room.after);
    host_init(&out->host, HOST_REAL, 0);
    watch_next();
    out->self = type->create(&out->host.plugin);
    if (!out->self) {
        tell_failed(RULE_LIFE_CREATE, "create() returned NULL");
        return false;
    }
    if (!activate(out, face, poses, out_refused)) {
        watch_next();
        type->destroy(out->self);
        out->self = NULL;
        return false;
    }
    actor_reset(out);
    return true;
}

bool actor_open(actor *out, const mrt_plugin_type *type, const mrt_face *face, bool *out_refused)
{
    return actor_open_posed(out, type, face, faces_poses(face), out_refused);
}

void actor_close(actor *self)
{
    if (!self->self)
        return;
    actor_deactivate(self);
    watch_next();
    self->type->destroy(self->self);
    self->self = NULL;
}

void actor_deactivate(actor *self)
{
    if (!self->face)
        return;
    if (self->rig_poses && sum_poses(self->poses, self->face) != self->poses_sum)
        tell_failed(RULE_MAPPING_CONST, "%s: it wrote to the poses of the rig", tell_what());
    watch_next();
    self->functions->deactivate(self->self);
    self->face = NULL;
}

bool actor_move(actor *self, const mrt_face *face, bool *out_refused)
{
    actor_deactivate(self);
    return actor_activate(self, face, faces_poses(face), out_refused);
}

bool actor_activate(actor *self, const mrt_face *face, face_poses poses, bool *out_refused)
{
    *out_refused = false;
    if (!activate(self, face, poses, out_refused)) {
        self->face = NULL;
        return false;
    }
    actor_reset(self);
    return true;
}

void actor_reset(actor *self)
{
    self->frame = (mrt_frame){0};
    memset(&self->room.pull, 0, sizeof self->room.pull);
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        self->room.pull.dof[i] = NAN;
    self->good = self->room.pull;
    self->has_anchored = false;
    self->frame_count = 0;
    actor_frame_enter();
    self->functions->reset(self->self);
    actor_frame_leave("reset()");
}

/* ---- a frame ---- */

static int64_t thread_cpu_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static bool is_intact(const unsigned char *canary)
{
    for (int i = 0; i < ACTOR_CANARIES; ++i)
        if (canary[i] != CANARY)
            return false;
    return true;
}

static float channel_values[MRT_MAX_INPUTS][MRT_MAX_CHANNELS]; /* values before the frame */

static void copy_values(const mrt_frame *frame, float out[MRT_MAX_INPUTS][MRT_MAX_CHANNELS])
{
    for (uint32_t i = 0; i < frame->input_count; ++i)
        memcpy(out[i], frame->inputs[i].value, frame->inputs[i].count * sizeof **out);
}

static void judge_writes(actor *self, const mrt_frame *frame, const double *params,
                         const char *where)
{
    size_t params_size = self->type->param_count * sizeof *params;
    for (uint32_t i = 0; i < frame->input_count; ++i)
        if (memcmp(channel_values[i], frame->inputs[i].value,
                   frame->inputs[i].count * sizeof **channel_values) != 0)
            tell_failed(RULE_MAPPING_CONST, "%s: process() wrote to the channels of %s", where,
                        frame->inputs[i].name);
    if (memcmp(frame, &self->frame, sizeof *frame) != 0)
        tell_failed(RULE_MAPPING_CONST, "%s: process() wrote to the frame", where);
    if (params_size > 0 && memcmp(params, frame->params, params_size) != 0)
        tell_failed(RULE_MAPPING_CONST, "%s: process() wrote to the parameters", where);
    if (!is_intact(self->room.before) || !is_intact(self->room.after)) {
        tell_failed(RULE_MAPPING_OVERRUN, "%s: process() wrote %s the pull", where,
                    is_intact(self->room.before) ? "behind" : "before");
        memset(self->room.before, CANARY, sizeof self->room.before);
        memset(self->room.after, CANARY, sizeof self->room.after);
    }
}

static void judge_course(actor *self, const char *where)
{
    const mrt_pull *now = &self->room.pull;
    if (now->mode != MRT_ANCHORED) {
        bool takes_hold = now->mode == MRT_UNANCHORED && now->count > 0 &&
                          (self->good.mode != MRT_UNANCHORED || self->good.count == 0);
        if (takes_hold && self->max_jump_mm > 0)
            pull_judge_hold(NULL, now, self->max_jump_mm, where);
        return;
    }
    const mrt_pull *before = self->has_anchored ? &self->anchored : NULL;
    if (before)
        pull_judge_anchor(before, now, where);
    if (self->max_jump_mm > 0 && (!before || before->anchor != now->anchor))
        pull_judge_hold(before, now, self->max_jump_mm, where);
    self->anchored = *now;
    self->has_anchored = true;
}

static void judge_result(actor *self, const char *where)
{
    char words[300];
    if (self->result == MRT_OK || self->result == MRT_HOLD)
        return;
    tell_failed(RULE_MAPPING_RESULT, "%s: process() returned %d%s", where, self->result,
                host_words(&self->host, words));
    if (self->result < 0 && self->host.error_count == 0)
        tell_failed(RULE_RUN_EXPLAINED, "%s: process() returned %d, but logged no error", where,
                    self->result);
}

void actor_step(actor *self)
{
    static double params[TYPES_PARAMS_MAX];
    char where[160];
    mrt_frame frame;
    size_t params_size = self->type->param_count * sizeof *params;
    memcpy(&frame, &self->frame, sizeof frame); /* a copy, including the padding between fields */
    if (params_size > 0)
        memcpy(params, frame.params, params_size);
    copy_values(&frame, channel_values);
    int64_t began_ns = self->is_measured ? thread_cpu_ns() : 0;
    actor_frame_enter();
    self->result = self->functions->process(self->self, &self->frame, &self->room.pull);
    (void)trap_set(0);
    self->cpu_ns = self->is_measured ? thread_cpu_ns() - began_ns : 0;
    actor_frame_leave("process()");

    (void)snprintf(where, sizeof where, "frame %u of %.120s", self->frame_count, tell_what());
    self->frame_count += 1;
    judge_writes(self, &frame, params, where);
    memcpy(&self->frame, &frame, sizeof frame);
    judge_result(self, where);
    if (self->result == MRT_HOLD && memcmp(&self->room.pull, &self->good, sizeof self->good) != 0)
        tell_failed(RULE_MAPPING_HOLD, "%s: process() wrote to the pull, but returned MRT_HOLD",
                    where);
    const pull_limits limits = {self->face, self->centre, self->reach_mm};
    if (self->result != MRT_OK || !pull_judge(&self->room.pull, &limits, where)) {
        self->room.pull = self->good;
        return;
    }
    judge_course(self, where);
    self->good = self->room.pull;
}

uint64_t actor_sum(const actor *self)
{
    return pull_sum(&self->good);
}

/* Writes the first difference for a message; "": none. */
static void actor_difference(const actor *a, const actor *b, char *out, size_t capacity)
{
    pull_difference(&a->good, &b->good, out, capacity);
}

/* ---- playing a part of a stream ---- */

bool play_open(actor *out, stream *out_hands, const examination *e, stream_kind kind, uint64_t seed)
{
    bool is_refused;
    tell_doing(RULE_COUNT, "activate() on %s", faces_name(FACE_USUAL));
    if (!actor_open(out, e->type, faces_of(FACE_USUAL), &is_refused))
        return false;
    tell_doing(RULE_COUNT, "%s", stream_name(kind));
    return stream_begin(out_hands, kind, seed, e->type);
}

void play_frames(actor *mapping, stream *hands, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i) {
        stream_next(hands, &mapping->frame);
        actor_step(mapping);
    }
}

bool play_same(actor *a, stream *a_hands, actor *b, stream *b_hands, uint32_t count,
               check_rule rule, const char *text)
{
    char what[400];
    for (uint32_t i = 0; i < count; ++i) {
        play_frames(a, a_hands, 1);
        play_frames(b, b_hands, 1);
        actor_difference(a, b, what, sizeof what);
        if (a->result != b->result)
            tell_failed(rule, "%s: frame %u: process() returns %d and %d", text, i, a->result,
                        b->result);
        else if (what[0])
            tell_failed(rule, "%s: frame %u: %s", text, i, what);
        else
            continue;
        return false;
    }
    return true;
}

void play_judged(void)
{
    static const check_rule rules[] = {
        RULE_MAPPING_RESULT,  RULE_MAPPING_MODE,   RULE_MAPPING_COUNT,    RULE_MAPPING_FINITE,
        RULE_MAPPING_REACH,   RULE_MAPPING_RADIUS, RULE_MAPPING_LEAK,     RULE_MAPPING_GATE,
        RULE_MAPPING_CONTACT, RULE_MAPPING_CONST,  RULE_MAPPING_OVERRUN,  RULE_MAPPING_HOLD,
        RULE_MAPPING_ANCHOR,  RULE_FRAME_HOST,     RULE_FRAME_ALLOCATION, RULE_FRAME_LOCK,
        RULE_FRAME_FILE,      RULE_FRAME_NETWORK,  RULE_FRAME_CLOCK,      RULE_FRAME_SLEEP,
        RULE_FRAME_PROCESS};
    for (size_t i = 0; i < sizeof rules / sizeof *rules; ++i)
        tell_ok(rules[i], "%s", "");
}
