#include "stage/isolate.h"
#include "stage/mapping/isolate_state.h"
#include "stage/plugins.h"
#include "stage/seam.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int64_t deadline_default_ns = 3 * NS_PER_MS;
static const int64_t virtual_deadline_ns = 5 * NS_PER_S;
static const int64_t main_patience_ns = 5 * NS_PER_S;
/* A child that waits for its turn is not to blame: so long, and so often. */
static const int64_t hang_ns = 250 * NS_PER_MS;
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

/* ---- failing: from here on the keeper has all but the fallback ---- */

static void fail(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held, const char *reason)
{
    static const mrt_frame nothing = {0};
    isolate_fallback_begin(&self->fallback, frame ? frame : &nothing, held);
    (void)snprintf(self->reason, sizeof self->reason, "%s", reason);
    self->is_late = false;
    atomic_store(&self->phase, ISOLATE_FAILED);
    isolate_keeper_wake(self);
}

static mrt_pull idle_pull(void)
{
    mrt_pull out = {0};
    for (int i = 0; i < MRT_MAX_DOFS; ++i)
        out.dof[i] = NAN;
    return out;
}

static void fail_late(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held)
{
    char reason[64];
    (void)snprintf(reason, sizeof reason, "did not answer within %g ms",
                   (double)self->deadline_ns * 1e-6);
    fail(self, frame, held, reason);
}

/* ---- asking ---- */

static bool is_running(const mrt_plugin *self)
{
    return atomic_load(&self->phase) == ISOLATE_RUNNING;
}

/* An answer that a frame did not wait for is there by time_ns; false: it has failed. */
static bool settle(mrt_plugin *self, int64_t time_ns)
{
    if (!self->is_late)
        return true;
    if (isolate_link_wait_until_ns(&self->link, time_ns) != MRT_OK)
        return false;
    self->is_late = false;
    return true;
}

/* A request other than process; result: the child's. */
static mrt_result ask(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    mrt_pull idle = idle_pull();
    if (!is_running(self))
        return MRT_ERR_UNSUPPORTED;
    int64_t until_ns = clock_now_ns() + patience_ns;
    self->has_saved = false;
    mrt_result result = settle(self, until_ns) ? MRT_OK : MRT_TIMEOUT;
    if (result == MRT_OK) {
        isolate_link_ask(&self->link, kind);
        result = isolate_link_wait_until_ns(&self->link, until_ns);
    }
    isolate_link_drain(&self->link, self->host);
    if (result == MRT_OK)
        return self->link.block->result;
    const mrt_pull *held = self->has_held ? &self->held : &idle;
    fail(self, NULL, held, result == MRT_ERR_IO ? "ended" : "did not answer");
    return MRT_ERR_IO;
}

/* ---- process ---- */

static int64_t used_since_asked_ns(const mrt_plugin *self)
{
    return isolate_link_cpu_ns(&self->link) - self->asked_cpu_ns;
}

/* It has not answered in time: whether the mapping is to blame, or a machine that had no turn for
 * its process. */
static mrt_result judge_late(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *held)
{
    bool has_had_time = used_since_asked_ns(self) >= self->deadline_ns * 3 / 4;
    bool hangs = clock_now_ns() - self->asked_ns >= hang_ns;
    if (!self->is_late)
        self->late_score += LATE_COST;
    self->is_late = true;
    self->held_frames += 1;
    atomic_fetch_add(&self->late_count, 1);
    if (self->is_virtual || has_had_time || hangs || self->late_score >= LATE_MAX)
        fail_late(self, frame, held);
    return MRT_HOLD;
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
        fail(self, frame, pull, reason);
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

/* The answer to an earlier frame; true: the child is free for this one. */
static bool take_late_answer(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    if (!self->is_late)
        return true;
    mrt_result waited = isolate_link_wait_until_ns(&self->link, 0);
    if (waited == MRT_OK && self->held_frames > 1 && self->held_frames < HELD_MAX &&
        !self->has_turn) {
        self->held_frames += 1; /* the layer is between two pulls: it would jump now */
        return false;
    }
    if (waited == MRT_OK) {
        self->is_late = false;
        (void)take_answer(self, frame, pull);
        return is_running(self);
    }
    if (waited == MRT_ERR_IO)
        fail(self, frame, pull, "ended");
    else
        (void)judge_late(self, frame, pull);
    return false;
}

static mrt_result forward(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    isolate_block *block = self->link.block;
    mrt_pull entry = *pull; /* what is held should it fail */
    if (!take_late_answer(self, frame, pull)) {
        *pull = entry;
        return MRT_HOLD;
    }
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
    self->has_saved = false;
    self->asked_cpu_ns = isolate_link_cpu_ns(&self->link);
    self->asked_ns = clock_now_ns();
    isolate_link_ask(&self->link, ISOLATE_PROCESS);
    mrt_result waited = isolate_link_wait_until_ns(&self->link, self->asked_ns + self->deadline_ns);
    if (waited == MRT_TIMEOUT)
        return judge_late(self, frame, &entry);
    if (waited < 0) {
        fail(self, frame, &entry, "ended");
        return MRT_HOLD;
    }
    self->late_score -= self->late_score > 0;
    self->held_frames = 0;
    self->has_turn = false;
    return take_answer(self, frame, pull);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    if (!is_running(self)) {
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
    return is_running(self) && self->is_late && self->held_frames > 1 &&
           atomic_load(&block->answered) == atomic_load(&block->asked);
}

static bool take_turn(mrt_plugin *self, mrt_pull *pull)
{
    if (atomic_load(&self->phase) != ISOLATE_READY)
        return self->has_turn = comes_back(self);
    bool is_forgotten = self->is_forgotten;
    self->is_late = self->has_turn = self->has_saved = false;
    self->is_forgotten = self->has_asked_resume = false;
    self->late_score = 0;
    self->held_frames = 0;
    self->held = !is_forgotten && self->resume_size > 0 ? self->resume_pull : *pull;
    atomic_store(&self->phase, ISOLATE_RUNNING);
    if (is_forgotten && ask(self, ISOLATE_RESET, self->deadline_ns) < 0)
        return false;
    if (!is_forgotten && self->resume_size > 0)
        *pull = self->resume_pull; /* what it held in the state that it goes on from */
    return true;
}

static void reset(mrt_plugin *self)
{
    static const mrt_frame nothing = {0};
    mrt_pull idle = idle_pull();
    if (!is_running(self)) {
        self->is_forgotten = true;
        isolate_fallback_begin(&self->fallback, &nothing, &idle);
        return;
    }
    self->resume_size = 0;
    self->has_held = self->has_asked_resume = false;
    self->memory.count = 0;
    (void)ask(self, ISOLATE_RESET, self->is_virtual ? virtual_deadline_ns : hang_ns);
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
    size_t bytes = is_running(self) ? isolate_face_put(self->link.block->bytes, ISOLATE_BYTES, face)
                                    : ISOLATE_BYTES;
    if (bytes < ISOLATE_BYTES) {
        self->link.block->size = (uint32_t)bytes;
        result = ask(self, ISOLATE_ACTIVATE, main_patience_ns);
    } else {
        self->host->log(self->host, MRT_LOG_ERROR,
                        is_running(self) ? "the face has too many contacts for a process of its own"
                                         : "its process has failed: start it anew");
    }
    self->face = result < 0 ? NULL : face;
    pthread_mutex_unlock(&self->busy);
    return result;
}

static void deactivate(mrt_plugin *self)
{
    pthread_mutex_lock(&self->busy);
    self->face = NULL;
    if (is_running(self))
        (void)ask(self, ISOLATE_DEACTIVATE, main_patience_ns);
    pthread_mutex_unlock(&self->busy);
}

static size_t save_bytes(mrt_plugin *self, uint32_t kind, int64_t patience_ns, void *out,
                         size_t capacity)
{
    bool is_there = self->has_saved && self->saved_kind == kind && is_running(self);
    if (!is_there && ask(self, kind, patience_ns) < 0)
        return 0;
    size_t size = self->link.block->size;
    if (size > ISOLATE_BYTES)
        return 0;
    self->has_saved = true;
    self->saved_kind = kind;
    if (out)
        memcpy(out, self->link.block->bytes, size < capacity ? size : capacity);
    return size;
}

static mrt_result load_bytes(mrt_plugin *self, uint32_t kind, int64_t patience_ns,
                             const void *bytes, size_t size)
{
    if (!is_running(self) || size > ISOLATE_BYTES || !settle(self, clock_now_ns() + patience_ns))
        return MRT_ERR_UNSUPPORTED;
    memcpy(self->link.block->bytes, bytes, size);
    self->link.block->size = (uint32_t)size;
    return ask(self, kind, patience_ns);
}

static size_t state_save(mrt_plugin *self, void *out, size_t capacity)
{
    pthread_mutex_lock(&self->busy);
    size_t size = save_bytes(self, ISOLATE_STATE_SAVE, main_patience_ns, out, capacity);
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

static int64_t frame_patience_ns(const mrt_plugin *self)
{
    return self->is_virtual ? virtual_deadline_ns : hang_ns;
}

static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)
{
    return save_bytes(self, ISOLATE_RESUME_SAVE, frame_patience_ns(self), out, capacity);
}

static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)
{
    if (!is_running(self))
        return MRT_ERR_UNSUPPORTED;
    self->resume_size = 0;
    self->has_held = self->has_asked_resume = false;
    return load_bytes(self, ISOLATE_RESUME_LOAD, frame_patience_ns(self), bytes, size);
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
                            .is_away = !is_running(self)};
}

const char *isolate_first_reason(const mrt_plugin *self)
{
    return atomic_load(&self->failed_count) > 0 ? self->first_reason : "";
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
