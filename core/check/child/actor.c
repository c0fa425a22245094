#include "check/child/actor.h"
#include "check/child/pull.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/child/types.h"
#include "check/child/watch.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CANARY = 0xa5 };

/* ---- what may not be done on the frame thread ---- */

void actor_frame_enter(void)
{
    watch_frame_enter();
    trap_enter(TRAP_ALL);
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
    trap_leave();
    watch_frame_leave();
    for (int kind = 0; kind < TRAP_KINDS; ++kind)
        if (trap_caught((trap_kind)kind, caught, sizeof caught))
            tell_failed(rules[kind], "%s called %s", function, caught);
}

/* ---- made and activated ---- */

static bool activate(actor *self, const mrt_face *face, bool *out_refused)
{
    mrt_face copy = *face;
    uint32_t errors_before = self->host.error_count;
    self->face = face;
    self->reach_mm = faces_reach_mm(face, self->centre);
    watch_next();
    mrt_result result = self->functions->activate(self->self, face);
    if (memcmp(&copy, face, sizeof copy) != 0)
        tell_failed(RULE_MAPPING_CONST, "activate() wrote to the face");
    *out_refused = result < 0;
    if (result >= 0)
        return true;
    if (self->host.error_count == errors_before)
        tell_failed(RULE_RUN_EXPLAINED, "activate() returned %d, and logged no error", result);
    return false;
}

bool actor_open(actor *out, const mrt_plugin_type *type, const mrt_face *face, bool *out_refused)
{
    *out_refused = false;
    *out = (actor){.type = type, .functions = types_interface(type, MRT_MAPPING)};
    memset(out->room.before, CANARY, sizeof out->room.before);
    memset(out->room.after, CANARY, sizeof out->room.after);
    host_init(&out->host, HOST_REAL, 0);
    watch_next();
    out->self = type->create(&out->host.plugin);
    if (!out->self) {
        tell_failed(RULE_LIFE_CREATE, "create() returned NULL");
        return false;
    }
    if (!activate(out, face, out_refused)) {
        watch_next();
        type->destroy(out->self);
        out->self = NULL;
        return false;
    }
    actor_reset(out);
    return true;
}

void actor_close(actor *self)
{
    if (!self->self)
        return;
    watch_next();
    if (self->face)
        self->functions->deactivate(self->self);
    watch_next();
    self->type->destroy(self->self);
    self->self = NULL;
}

bool actor_move(actor *self, const mrt_face *face, bool *out_refused)
{
    *out_refused = false;
    watch_next();
    if (self->face)
        self->functions->deactivate(self->self);
    if (!activate(self, face, out_refused)) {
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

static void judge_writes(actor *self, const mrt_frame *frame, const double *params,
                         const char *where)
{
    size_t params_size = self->type->param_count * sizeof *params;
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
        tell_failed(RULE_RUN_EXPLAINED, "%s: process() returned %d, and logged no error", where,
                    self->result);
}

void actor_step(actor *self)
{
    static double params[TYPES_PARAMS_MAX];
    char where[160];
    mrt_frame frame;
    size_t params_size = self->type->param_count * sizeof *params;
    memcpy(&frame, &self->frame, sizeof frame); /* with what lies between its fields */
    if (params_size > 0)
        memcpy(params, frame.params, params_size);
    int64_t began_ns = self->is_measured ? thread_cpu_ns() : 0;
    actor_frame_enter();
    self->result = self->functions->process(self->self, &self->frame, &self->room.pull);
    trap_leave();
    self->cpu_ns = self->is_measured ? thread_cpu_ns() - began_ns : 0;
    actor_frame_leave("process()");

    (void)snprintf(where, sizeof where, "frame %u of %.120s", self->frame_count, tell_what());
    self->frame_count += 1;
    judge_writes(self, &frame, params, where);
    memcpy(&self->frame, &frame, sizeof frame);
    judge_result(self, where);
    if (self->result == MRT_HOLD && memcmp(&self->room.pull, &self->good, sizeof self->good) != 0)
        tell_failed(RULE_MAPPING_HOLD, "%s: process() wrote to the pull and returned MRT_HOLD",
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

void actor_difference(const actor *a, const actor *b, char *out, size_t capacity)
{
    pull_difference(&a->good, &b->good, out, capacity);
}
