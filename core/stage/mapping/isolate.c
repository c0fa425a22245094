#include "stage/mapping/isolate.h"
#include "stage/mapping/isolate_state.h"
#include "stage/mapping/plugins.h"
#include "stage/seam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t deadline_default_ns = 3 * NS_PER_MS;
static const int64_t virtual_deadline_ns = 5 * NS_PER_S;
static const int64_t main_patience_ns = 5 * NS_PER_S;
/* A frame waits for its deadline, and holds; a child hangs when it has owed an answer for this
 * long, in this many frames. On a busy machine it may not have had a turn in that time: then
 * longer. */
static const int64_t hang_ns = NS_PER_S, turn_ns = 50 * NS_PER_MS;
static const int64_t hang_without_turn_ns = 3 * NS_PER_S;
enum { HANG_FRAMES = 8 };
/* What a take begins with must not be missing: a frame rather waits this long. */
static const int64_t save_patience_ns = 100 * NS_PER_MS;
/* One that is late again and again is told of. */
enum { LATE_COST = 8, LATE_MAX = 64 };
/* One that was held for more than a frame comes back with a turn; without one after so many. */
enum { HELD_MAX = 64 };
/* How often the child's state is asked for. */
static const int64_t resume_span_ns = NS_PER_S;

struct isolate {
    mrt_plugin_type type; /* first: types are found by it */
    const mrt_plugin_type *inner;
    char *library;
    isolate_settings settings;
    mrt_interface interfaces[5];
};

static const isolate *isolate_of(const mrt_plugin_type *type)
{
    return (const isolate *)(const void *)type;
}

/* ---- process ---- */

static void fail_late(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held)
{
    char reason[64];
    (void)snprintf(reason, sizeof reason, "did not answer for %.1f s",
                   (double)(clock_now_ns() - self->asked_ns) * 1e-9);
    isolate_call_fail(self, frame, held, reason);
}

/* The mapping is to blame, not a machine that had no turn for its process or for this one. */
static bool hangs(const mrt_plugin *self)
{
    int64_t owed_ns = clock_now_ns() - self->asked_ns;
    bool has_had_turns = isolate_link_cpu_ns(&self->link) - self->asked_cpu_ns >= turn_ns;
    return self->held_frames >= HANG_FRAMES &&
           owed_ns >= (has_had_turns ? hang_ns : hang_without_turn_ns);
}

static void count_late(mrt_plugin *self)
{
    self->held_frames += 1;
    atomic_fetch_add(&self->late_count, 1);
    if (self->held_frames > 1)
        return;
    self->late_score += LATE_COST;
    if (self->late_score < LATE_MAX || self->is_late_told)
        return;
    self->is_late_told = true;
    self->host->log(self->host, MRT_LOG_WARNING,
                    "answers late again and again, and the face is held meanwhile: it computes for "
                    "too long, or the machine is busy");
}

static void count_in_time(mrt_plugin *self)
{
    self->held_frames = 0;
    self->late_score -= self->late_score > 0;
    self->is_late_told = self->is_late_told && self->late_score > 0;
}

static void hold_late(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held)
{
    count_late(self);
    if (self->is_virtual || hangs(self))
        fail_late(self, frame, held);
}

static mrt_result take_answer(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    const isolate_block *block = self->link.block;
    mrt_pull answer = block->pull;
    mrt_result result = block->result;
    char reason[160];
    const char *fault = result == MRT_OK ? guard_fault(&self->guard, &answer) : NULL;
    isolate_link_drain(&self->link, self->host);
    if (fault || (result != MRT_OK && result != MRT_HOLD)) {
        if (fault)
            (void)snprintf(reason, sizeof reason, "gave %s", fault);
        else
            (void)snprintf(reason, sizeof reason, "returned %d", (int)result);
        isolate_call_fail(self, frame, pull, reason);
        return MRT_HOLD;
    }
    if (result == MRT_OK)
        *pull = answer;
    uint32_t size = block->size;
    if (block->with_resume && size > 0 && size <= ISOLATE_BYTES) {
        memcpy(self->resume, block->bytes, size);
        self->resume_size = size;
        self->resume_pull = *pull;
    }
    self->held = *pull;
    self->has_held = true;
    return result;
}

/* The answer to an earlier request; true: the child is free for this frame. out_late: of that
 * answer. */
static bool take_late_answer(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull,
                             mrt_result *out_late)
{
    *out_late = MRT_HOLD;
    if (!self->owed)
        return true;
    bool is_wanted = self->owed == ISOLATE_PROCESS && !self->is_to_reset;
    mrt_result waited = isolate_link_wait_until_ns(&self->link, 0);
    if (waited == MRT_OK && is_wanted && self->held_frames > 1 && self->held_frames < HELD_MAX &&
        !self->has_turn) {
        self->held_frames += 1; /* the layer is between two pulls: it would jump now */
        return false;
    }
    if (waited == MRT_OK) {
        self->owed = 0;
        self->held_frames = 0;
        self->has_turn = false;
        if (is_wanted)
            *out_late = take_answer(self, frame, pull);
        return isolate_call_runs(self);
    }
    if (waited == MRT_ERR_IO)
        isolate_call_fail(self, frame, pull, "ended");
    else
        hold_late(self, frame, pull);
    return false;
}

static void put_frame(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *pull)
{
    isolate_block *block = self->link.block;
    block->frame = *frame;
    block->pull = *pull;
    memcpy(block->params, self->params, self->param_count * sizeof *block->params);
    bool is_due = !self->has_asked_resume || frame->time_ns < self->resume_asked_ns ||
                  frame->time_ns - self->resume_asked_ns >= resume_span_ns;
    block->with_resume = self->can_resume && is_due;
    if (block->with_resume) {
        self->has_asked_resume = true;
        self->resume_asked_ns = frame->time_ns;
    }
}

static mrt_result forward(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    mrt_pull entry = *pull; /* what is held should it fail */
    mrt_result late;
    int64_t until_ns = clock_now_ns() + self->deadline_ns;
    if (!take_late_answer(self, frame, pull, &late)) {
        *pull = entry;
        return MRT_HOLD;
    }
    mrt_result waited = isolate_call_settle(self, until_ns);
    if (waited == MRT_OK) {
        put_frame(self, frame, pull);
        waited = isolate_call_put(self, ISOLATE_PROCESS, until_ns);
    }
    if (waited == MRT_TIMEOUT) {
        hold_late(self, frame, &entry);
        return late; /* one that is always late is seen too */
    }
    if (waited < 0) {
        isolate_call_fail(self, frame, &entry, "ended");
        return MRT_HOLD;
    }
    count_in_time(self);
    return take_answer(self, frame, pull);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    if (!isolate_call_runs(self)) {
        isolate_fallback_process(&self->fallback, frame, pull);
        return MRT_OK;
    }
    isolate_memory_add(&self->memory, frame);
    memcpy(self->params, frame->params, self->param_count * sizeof *self->params);
    return forward(self, frame, pull);
}

/* It was held for some frames, and now comes back: the face is not to catch up in one. */
static bool comes_back(const mrt_plugin *self)
{
    const isolate_block *block = self->link.block;
    return isolate_call_runs(self) && self->owed == ISOLATE_PROCESS && self->held_frames > 1 &&
           atomic_load(&block->answered) == atomic_load(&block->asked);
}

static bool take_turn(mrt_plugin *self, mrt_pull *pull)
{
    if (atomic_load(&self->phase) != ISOLATE_READY)
        return self->has_turn = comes_back(self);
    bool is_forgotten = self->is_forgotten;
    self->has_turn = self->has_saved = self->is_late_told = false;
    self->is_forgotten = self->has_asked_resume = false;
    self->is_to_reset = is_forgotten;
    self->owed = 0;
    self->late_score = 0;
    self->held_frames = 0;
    self->held = !is_forgotten && self->resume_size > 0 ? self->resume_pull : *pull;
    atomic_store(&self->phase, ISOLATE_RUNNING);
    if (!is_forgotten && self->resume_size > 0)
        *pull = self->resume_pull; /* what it held in the state that it goes on from */
    return true;
}

static void reset(mrt_plugin *self)
{
    static const mrt_frame nothing = {0};
    mrt_pull idle = isolate_call_idle();
    if (!isolate_call_runs(self)) {
        self->is_forgotten = true;
        isolate_fallback_begin(&self->fallback, &nothing, &idle);
        return;
    }
    self->resume_size = 0;
    self->has_held = self->has_asked_resume = false;
    self->memory.count = 0;
    self->is_to_reset = true; /* before the next frame, within its deadline */
}

/* ---- [main] ---- */

static mrt_result activate(mrt_plugin *self, const mrt_face *face)
{
    pthread_mutex_lock(&self->busy);
    double size = fmax(fmax((double)face->high.x - (double)face->low.x,
                            (double)face->high.y - (double)face->low.y),
                       fmax((double)face->high.z - (double)face->low.z, 1.0));
    self->guard = (guard){.contact_count = face->contact_count,
                          .centre = vec3_scale((vec3){(double)face->low.x + (double)face->high.x,
                                                      (double)face->low.y + (double)face->high.y,
                                                      (double)face->low.z + (double)face->high.z},
                                               0.5),
                          .reach_mm = 10.0 * size};
    mrt_result result = MRT_ERR_UNSUPPORTED;
    bool is_free = isolate_call_runs(self) &&
                   isolate_call_settle(self, clock_now_ns() + main_patience_ns) == MRT_OK;
    size_t bytes =
        is_free ? isolate_face_put(self->link.block->bytes, ISOLATE_BYTES, face) : ISOLATE_BYTES;
    if (bytes < ISOLATE_BYTES) {
        self->link.block->size = (uint32_t)bytes;
        result = isolate_call_ask(self, ISOLATE_ACTIVATE, main_patience_ns);
    } else {
        self->host->log(self->host, MRT_LOG_ERROR,
                        is_free ? "the face has too many contacts for a process of its own"
                                : "its process does not answer: start it anew");
    }
    self->face = result < 0 ? NULL : face;
    pthread_mutex_unlock(&self->busy);
    return result;
}

static void deactivate(mrt_plugin *self)
{
    pthread_mutex_lock(&self->busy);
    self->face = NULL;
    if (isolate_call_runs(self))
        (void)isolate_call_ask(self, ISOLATE_DEACTIVATE, main_patience_ns);
    pthread_mutex_unlock(&self->busy);
}

/* What it has answered to a request that saves. */
static size_t saved_bytes(mrt_plugin *self, uint32_t kind, void *out, size_t capacity)
{
    size_t size = self->link.block->size;
    if (size > ISOLATE_BYTES)
        return 0;
    self->has_saved = true;
    self->saved_kind = kind;
    if (out)
        memcpy(out, self->link.block->bytes, size < capacity ? size : capacity);
    return size;
}

static bool has_saved(const mrt_plugin *self, uint32_t kind)
{
    return self->has_saved && self->saved_kind == kind && isolate_call_runs(self);
}

static mrt_result load_bytes(mrt_plugin *self, uint32_t kind, int64_t patience_ns,
                             const void *bytes, size_t size)
{
    if (!isolate_call_runs(self) || size > ISOLATE_BYTES ||
        isolate_call_settle(self, clock_now_ns() + patience_ns) != MRT_OK)
        return MRT_ERR_UNSUPPORTED;
    self->has_saved = false;
    memcpy(self->link.block->bytes, bytes, size);
    self->link.block->size = (uint32_t)size;
    return isolate_call_ask(self, kind, patience_ns);
}

static size_t state_save(mrt_plugin *self, void *out, size_t capacity)
{
    pthread_mutex_lock(&self->busy);
    bool is_there = has_saved(self, ISOLATE_STATE_SAVE) ||
                    isolate_call_ask(self, ISOLATE_STATE_SAVE, main_patience_ns) >= 0;
    size_t size = is_there ? saved_bytes(self, ISOLATE_STATE_SAVE, out, capacity) : 0;
    pthread_mutex_unlock(&self->busy);
    return size;
}

static mrt_result state_load(mrt_plugin *self, const void *bytes, size_t size)
{
    pthread_mutex_lock(&self->busy);
    mrt_result result = load_bytes(self, ISOLATE_STATE_LOAD, main_patience_ns, bytes, size);
    if (result >= 0) { /* a new process gets it too */
        free(self->state);
        self->state = malloc(size + 1);
        self->state_size = self->state ? size : 0;
        if (self->state)
            memcpy(self->state, bytes, size);
    }
    pthread_mutex_unlock(&self->busy);
    return result;
}

/* ---- [frame]: the state between two frames ---- */

/* 0 too when it is late now: that is no failure. */
static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)
{
    bool is_there = has_saved(self, ISOLATE_RESUME_SAVE);
    if (!is_there && self->is_virtual)
        is_there = isolate_call_ask(self, ISOLATE_RESUME_SAVE, virtual_deadline_ns) >= 0;
    else if (!is_there && isolate_call_runs(self))
        is_there = isolate_call_settled(self, ISOLATE_RESUME_SAVE, save_patience_ns) == MRT_OK &&
                   self->link.block->result >= 0;
    return is_there ? saved_bytes(self, ISOLATE_RESUME_SAVE, out, capacity) : 0;
}

static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)
{
    if (!isolate_call_runs(self))
        return MRT_ERR_UNSUPPORTED;
    self->resume_size = 0;
    self->has_held = self->has_asked_resume = false;
    return load_bytes(self, ISOLATE_RESUME_LOAD, self->is_virtual ? virtual_deadline_ns : hang_ns,
                      bytes, size);
}

/* ---- made and unmade ---- */

static mrt_plugin *create(const mrt_host *host)
{
    const instance *made = host->data; /* this host is always ours */
    const isolate *of = isolate_of(made->type);
    mrt_plugin *self = calloc(1, sizeof *self);
    unsigned char *resume = malloc(ISOLATE_BYTES);
    if (!self || !resume) {
        free(self);
        free(resume);
        return NULL;
    }
    self->host = host;
    self->inner = of->inner;
    self->library = of->library;
    self->writes_reports = of->settings.writes_reports;
    self->is_virtual = of->settings.clock == CLOCK_VIRTUAL;
    self->deadline_ns = self->is_virtual               ? virtual_deadline_ns
                        : of->settings.deadline_ns > 0 ? of->settings.deadline_ns
                                                       : deadline_default_ns;
    self->param_count = of->inner->param_count;
    self->can_resume = plugin_interface(of->inner, MRT_RESUME) != NULL;
    self->resume = resume;
    if (isolate_keeper_start(self) >= 0)
        return self;
    free(resume);
    free(self);
    return NULL;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    isolate_keeper_stop(self);
    free(self->resume);
    free(self->state);
    free(self);
}

isolate_counts isolate_counted(const mrt_plugin *self)
{
    return (isolate_counts){.failed = atomic_load(&self->failed_count),
                            .restarted = atomic_load(&self->restarted_count),
                            .late = atomic_load(&self->late_count),
                            .is_away = !isolate_call_runs(self)};
}

const char *isolate_first_reason(const mrt_plugin *self)
{
    return atomic_load(&self->failed_count) > 0 ? self->first_reason : "";
}

mrt_result isolate_check(const instance *of, error *err)
{
    const mrt_plugin *self = of->self;
    if (!self || isolate_inner(of->type) == of->type)
        return MRT_OK;
    int64_t until_ns =
        clock_now_ns() + main_patience_ns; /* it is away before its keeper knows why */
    while (!isolate_call_runs(self) && atomic_load(&self->failed_count) == 0 &&
           clock_now_ns() < until_ns)
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    if (isolate_call_runs(self) && atomic_load(&self->failed_count) == 0)
        return MRT_OK;
    const char *why = isolate_first_reason(self);
    return error_set(err, MRT_ERR_FORMAT, "mapping %s %s", of->type->id,
                     why[0] ? why : "failed in its process");
}

int32_t isolate_pid(const mrt_plugin *self)
{
    return atomic_load(&self->pid);
}

/* ---- the type ---- */

static const mrt_plugin_type *inner_of(const mrt_plugin_type *outer)
{
    return isolate_of(outer)->inner;
}

static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_state state = {state_save, state_load};
static const mrt_resume resume = {resume_save, resume_load};
static const stage_seam seam = {take_turn, inner_of};

const mrt_plugin_type *isolate_inner(const mrt_plugin_type *type)
{
    const stage_seam *s = plugin_interface(type, STAGE_SEAM);
    return s ? s->inner(type) : type;
}

mrt_result isolate_create(isolate **out, const mrt_plugin_type *inner, const char *library,
                          const isolate_settings *settings, error *err)
{
    *out = NULL;
    if (inner->param_count > ISOLATE_PARAMS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s has too many parameters", inner->id);
    isolate *self = calloc(1, sizeof *self);
    char *path = strdup(library);
    if (!self || !path) {
        free(self);
        free(path);
        return error_set(err, MRT_ERR_MEMORY, "no memory to isolate %s", inner->id);
    }
    self->inner = inner;
    self->library = path;
    self->settings = *settings;
    mrt_interface *next = self->interfaces;
    *next++ = (mrt_interface){MRT_MAPPING, &mapping};
    *next++ = (mrt_interface){STAGE_SEAM, &seam};
    if (plugin_interface(inner, MRT_STATE))
        *next++ = (mrt_interface){MRT_STATE, &state};
    if (plugin_interface(inner, MRT_RESUME))
        *next++ = (mrt_interface){MRT_RESUME, &resume};
    self->type = *inner;
    self->type.interfaces = self->interfaces;
    self->type.create = create;
    self->type.destroy = destroy;
    *out = self;
    return MRT_OK;
}

void isolate_destroy(isolate *self)
{
    if (!self)
        return;
    free(self->library);
    free(self);
}

const mrt_plugin_type *isolate_type(const isolate *self)
{
    return &self->type;
}
