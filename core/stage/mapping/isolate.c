#include "stage/mapping/isolate.h"
#include "base/clock.h"
#include "base/trace.h"
#include "stage/mapping/guard.h"
#include "stage/mapping/isolate_output.h"
#include "stage/mapping/isolate_process.h"
#include "stage/mapping/isolate_report.h"
#include "stage/mapping/plugins.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

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

/* Who has what: while RUNNING the thread that calls the plugin has all of it; from FAILED on the
 * supervisor has all of it, until READY, when the caller may take it back, or LOST. */
enum { ISOLATE_RUNNING = 1, ISOLATE_FAILED, ISOLATE_READY, ISOLATE_LOST };

struct mrt_plugin {
    const mrt_host *host;
    const mrt_plugin_type *inner;
    const char *library;
    bool is_virtual, can_resume, writes_reports;
    int64_t deadline_ns;
    uint32_t param_count;

    _Atomic uint32_t phase;
    _Atomic uint32_t failed_count, restarted_count, late_count;
    _Atomic int32_t pid;

    isolate_process link;
    guard guard;
    bool is_to_reset; /* before the next request */
    uint32_t owed;    /* the request that the child still owes an answer to; 0: none */
    bool has_saved;   /* the block's bytes are the answer to saved_kind */
    uint32_t saved_kind;
    int32_t late_score;
    bool is_late_told;
    uint32_t held_frames; /* in a row, for one late answer */
    bool is_announced;    /* the layer knows that it comes back */
    int64_t asked_ns, asked_cpu_ns;
    double params[ISOLATE_PARAMS_MAX]; /* of the last frame */
    isolate_memory memory;
    char reason[160];       /* why it has failed; "ended": as the process did */
    char first_reason[160]; /* of the first failure; written before failed_count says so */

    unsigned char *resume; /* MRT_RESUME, and the pull held then; ISOLATE_BYTES of room */
    uint32_t resume_size;  /* 0: none */
    mrt_pull resume_pull;
    bool has_asked_resume;
    int64_t resume_asked_ns;

    bool is_forgotten; /* the caller's: reset was called while the child was away */

    pthread_mutex_t busy; /* held by [main] functions, and by the supervisor while it recovers */
    const mrt_face *face; /* under busy; NULL: not active */
    const mrt_rig_pose *poses; /* under busy: of that face, or of the one that is activated next */
    uint32_t pose_count;
    unsigned char *state; /* under busy: MRT_STATE as loaded last; ISOLATE_BYTES of room */
    size_t state_size;    /* 0: none */

    /* the supervisor's */
    pthread_t supervisor;
    int wake_fd;
    pthread_mutex_t start_mutex;
    pthread_cond_t start_cond;
    int start; /* 0: not yet, 1: it runs, -1: failed */
    error start_error;
    _Atomic bool is_stopping;
    bool has_failed_before;
    int64_t failed_ns;
};

struct isolate {
    isolate_outer outer; /* first: types are found by it */
    isolate_settings settings;
};

static const isolate *isolate_of(const mrt_plugin_type *type)
{
    return (const isolate *)(const void *)type;
}

/* ---- the supervisor: the thread that starts a process, sees it end, and starts another ---- */

static const int64_t start_patience_ns = 5 * NS_PER_S;
static const int64_t end_patience_ns = NS_PER_S / 5;
static const int64_t again_ns = 60 * NS_PER_S;
enum { DEATH_MS = 20 };

static void say(const mrt_plugin *self, int32_t level, const char *text)
{
    self->host->log(self->host, level, text);
}

/* ---- a child is started ---- */

static mrt_result ask_with(isolate_process *link, uint32_t kind, const void *bytes, size_t size)
{
    if (size > ISOLATE_BYTES)
        return MRT_ERR_ARGUMENT;
    memcpy(link->block->bytes, bytes, size);
    link->block->size = (uint32_t)size;
    return isolate_process_call(link, kind, start_patience_ns);
}

/* The plugin's words, or how its process went. */
static mrt_result explain_start(mrt_plugin *self, error *err)
{
    error how = {""};
    bool died = isolate_process_has_ended(&self->link, 0);
    (void)error_set(err, MRT_ERR_UNSUPPORTED, "its process gave no answer");
    bool has_words = isolate_process_why(&self->link, err);
    isolate_process_end(&self->link, &how);
    if (died && !has_words)
        *err = how;
    isolate_process_finish(&self->link);
    return MRT_ERR_UNSUPPORTED;
}

/* Started, and the plugin created. On failure nothing is left. */
static mrt_result start(mrt_plugin *self, error *err)
{
    mrt_result result = isolate_process_start(&self->link, self->library, self->inner->id, err);
    if (result < 0)
        return result;
    result = isolate_process_call(&self->link, ISOLATE_CREATE, start_patience_ns);
    if (result < 0)
        return explain_start(self, err);
    isolate_process_drain(&self->link, self->host);
    if (isolate_is_table_of(self->link.block, self->inner)) {
        atomic_store(&self->pid, (int32_t)self->link.pid);
        TRACE(TRACE_MAPPING, "%s: process %d started", self->inner->id, (int)self->link.pid);
        return MRT_OK;
    }
    isolate_process_end(&self->link, NULL);
    isolate_process_finish(&self->link);
    return error_set(err, MRT_ERR_FORMAT, "its library has changed: its parameters are others");
}

/* The face and its poses into the block. Returns the size, which must be below ISOLATE_BYTES. */
static size_t put_mapped(mrt_plugin *self, const mrt_face *face)
{
    isolate_block *block = self->link.block;
    size_t size =
        isolate_mapped_put(block->bytes, ISOLATE_BYTES, face, self->poses, self->pose_count);
    block->size = size < ISOLATE_BYTES ? (uint32_t)size : 0;
    return size;
}

/* As the one that has failed was a second ago at most. */
static mrt_result bring_up(mrt_plugin *self)
{
    isolate_process *link = &self->link;
    error why = {""};
    mrt_result result = start(self, &why);
    if (result < 0) {
        say(self, MRT_LOG_WARNING, why.text);
        return result;
    }
    if (self->state_size > 0)
        result = ask_with(link, ISOLATE_STATE_LOAD, self->state, self->state_size);
    if (result >= 0) {
        (void)put_mapped(self, self->face); /* it fitted when it was activated */
        result = isolate_process_call(link, ISOLATE_ACTIVATE, start_patience_ns);
    }
    if (result >= 0)
        result = isolate_process_call(link, ISOLATE_RESET, start_patience_ns);
    if (result >= 0 && self->resume_size > 0 &&
        ask_with(link, ISOLATE_RESUME_LOAD, self->resume, self->resume_size) < 0) {
        self->resume_size = 0;
        result = isolate_process_call(link, ISOLATE_RESET, start_patience_ns);
    }
    isolate_process_drain(link, self->host);
    return result;
}

/* ---- a child has failed ---- */

static void end_child(mrt_plugin *self, error *out_how)
{
    atomic_store(&self->pid, 0);
    isolate_process_end(&self->link, out_how);
    if (self->link.block)
        isolate_process_drain(&self->link, self->host);
    isolate_process_finish(&self->link);
}

static void write_report(mrt_plugin *self, const char *reason)
{
    char folder[PATH_MAX];
    error err = {""}, text = {""};
    if (!self->writes_reports || !self->face)
        return;
    const isolate_report report = {.type = self->inner,
                                   .library = self->library,
                                   .reason = reason,
                                   .face = self->face,
                                   .params = self->params,
                                   .memory = &self->memory};
    mrt_result result = isolate_report_write(&report, folder, sizeof folder, &err);
    if (result < 0)
        (void)error_set(&text, result, "no report was written: %s", err.text);
    else
        (void)error_set(&text, MRT_OK, "what it saw last is kept in %s", folder);
    say(self, result < 0 ? MRT_LOG_WARNING : MRT_LOG_INFO, text.text);
}

/* Why it has failed, in words; the process is gone. */
static void explain_end(mrt_plugin *self, error *out_reason)
{
    error how = {""};
    bool died = isolate_process_has_ended(&self->link, DEATH_MS);
    end_child(self, &how);
    if (died && how.text[0])
        *out_reason = how;
    else
        (void)error_set(out_reason, MRT_ERR_IO, "%s", self->reason);
}

static void recover(mrt_plugin *self)
{
    error reason = {""}, text = {""};
    int64_t now_ns = clock_now_ns();
    bool is_again = self->has_failed_before && now_ns - self->failed_ns < again_ns;
    explain_end(self, &reason);
    if (atomic_load(&self->failed_count) == 0)
        snprintf(self->first_reason, sizeof self->first_reason, "%.150s", reason.text);
    atomic_fetch_add(&self->failed_count, 1);
    self->has_failed_before = true;
    self->failed_ns = now_ns;
    TRACE(TRACE_MAPPING, "%s: %s", self->inner->id, reason.text);
    (void)error_set(&text, MRT_OK, "%s: the face is held%s", reason.text,
                    is_again ? "; it has failed twice within a minute: choose a mapping" : "");
    say(self, MRT_LOG_WARNING, text.text);
    write_report(self, reason.text);
    self->memory.count = 0;
    bool is_up = !is_again && self->face && bring_up(self) >= 0;
    if (!is_up)
        end_child(self, NULL);
    atomic_store(&self->phase, is_up ? ISOLATE_READY : ISOLATE_LOST);
    if (is_up) { /* who sees it counted may have it */
        atomic_fetch_add(&self->restarted_count, 1);
        say(self, MRT_LOG_INFO, "runs again in a new process");
    } else if (!is_again && self->face) {
        say(self, MRT_LOG_WARNING, "could not be started again: the face stays held");
    }
}

/* ---- the thread ---- */

static void supervisor_wake(mrt_plugin *self)
{
    const uint64_t one = 1;
    ssize_t written = write(self->wake_fd, &one, sizeof one);
    (void)written; /* full: it is awake already */
}

static void clear_wake(const mrt_plugin *self)
{
    uint64_t count;
    ssize_t got = read(self->wake_fd, &count, sizeof count);
    (void)got;
}

static void keep(mrt_plugin *self)
{
    bool is_told = false;
    while (!atomic_load(&self->is_stopping)) {
        struct pollfd on[2] = {{.fd = self->wake_fd, .events = POLLIN},
                               {.fd = is_told ? -1 : self->link.pidfd, .events = POLLIN}};
        if (poll(on, 2, -1) < 0 && errno != EINTR)
            return;
        if (on[1].revents) {
            isolate_process_tell_dead(&self->link);
            is_told = true;
        }
        if (on[0].revents)
            clear_wake(self);
        if (atomic_load(&self->phase) != ISOLATE_FAILED || atomic_load(&self->is_stopping))
            continue;
        pthread_mutex_lock(&self->busy);
        recover(self);
        pthread_mutex_unlock(&self->busy);
        is_told = false;
    }
}

static void ask_to_end(mrt_plugin *self)
{
    uint32_t phase = atomic_load(&self->phase);
    bool answers = phase == ISOLATE_RUNNING || phase == ISOLATE_READY;
    if (answers && self->link.block && !self->owed && !isolate_process_has_ended(&self->link, 0))
        (void)isolate_process_call(&self->link, ISOLATE_DESTROY, end_patience_ns);
    end_child(self, NULL);
}

static void *supervisor_main(void *data)
{
    mrt_plugin *self = data;
    mrt_result result = start(self, &self->start_error);
    pthread_mutex_lock(&self->start_mutex);
    self->start = result < 0 ? -1 : 1;
    if (result >= 0)
        atomic_store(&self->phase, ISOLATE_RUNNING);
    pthread_cond_signal(&self->start_cond);
    pthread_mutex_unlock(&self->start_mutex);
    if (result < 0)
        return NULL;
    keep(self);
    ask_to_end(self);
    return NULL;
}

static mrt_result supervisor_start(mrt_plugin *self)
{
    self->link.pidfd = -1;
    self->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (self->wake_fd < 0)
        return MRT_ERR_IO;
    pthread_mutex_init(&self->busy, NULL);
    pthread_mutex_init(&self->start_mutex, NULL);
    pthread_cond_init(&self->start_cond, NULL);
    bool is_up = pthread_create(&self->supervisor, NULL, supervisor_main, self) == 0;
    pthread_mutex_lock(&self->start_mutex);
    while (is_up && self->start == 0)
        pthread_cond_wait(&self->start_cond, &self->start_mutex);
    pthread_mutex_unlock(&self->start_mutex);
    if (is_up && self->start > 0)
        return MRT_OK;
    if (is_up)
        pthread_join(self->supervisor, NULL);
    say(self, MRT_LOG_ERROR, self->start_error.text); /* from the thread that is listened to */
    close(self->wake_fd);
    pthread_cond_destroy(&self->start_cond);
    pthread_mutex_destroy(&self->start_mutex);
    pthread_mutex_destroy(&self->busy);
    return MRT_ERR_UNSUPPORTED;
}

static void supervisor_stop(mrt_plugin *self)
{
    atomic_store(&self->is_stopping, true);
    supervisor_wake(self);
    pthread_join(self->supervisor, NULL);
    close(self->wake_fd);
    pthread_cond_destroy(&self->start_cond);
    pthread_mutex_destroy(&self->start_mutex);
    pthread_mutex_destroy(&self->busy);
}

/* ---- what is asked of the process ---- */

static bool runs(const mrt_plugin *self)
{
    return atomic_load(&self->phase) == ISOLATE_RUNNING;
}

/* From here on the supervisor has all of it, and the face is held. */
static void fail(mrt_plugin *self, const char *reason)
{
    (void)snprintf(self->reason, sizeof self->reason, "%s", reason);
    self->owed = 0;
    atomic_store(&self->phase, ISOLATE_FAILED);
    supervisor_wake(self);
}

/* The block is the child's until it has answered. MRT_TIMEOUT: it owes that; MRT_ERR_IO: it ended.
 */
static mrt_result put_request(mrt_plugin *self, uint32_t kind, int64_t until_ns)
{
    self->has_saved = false;
    self->owed = kind;
    self->asked_cpu_ns = isolate_process_cpu_ns(&self->link);
    self->asked_ns = clock_now_ns();
    isolate_process_ask(&self->link, kind);
    mrt_result result = isolate_process_wait_until_ns(&self->link, until_ns);
    if (result == MRT_OK)
        self->owed = 0;
    return result;
}

/* As put_request: the block is free, and a reset that was put off is done. An answer owed is
 * dropped. */
static mrt_result settle(mrt_plugin *self, int64_t until_ns)
{
    mrt_result result = self->owed ? isolate_process_wait_until_ns(&self->link, until_ns) : MRT_OK;
    if (result == MRT_OK)
        self->owed = 0;
    if (result != MRT_OK || !self->is_to_reset)
        return result;
    self->is_to_reset = false;
    return put_request(self, ISOLATE_RESET, until_ns);
}

/* Both. */
static mrt_result put_settled(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    mrt_result result = settle(self, until_ns);
    if (result == MRT_OK)
        result = put_request(self, kind, until_ns);
    isolate_process_drain(&self->link, self->host);
    return result;
}

/* Both, and no answer is a failure; the result is the child's. Not for process. */
static mrt_result ask_child(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    if (!runs(self))
        return MRT_ERR_UNSUPPORTED;
    mrt_result result = put_settled(self, kind, patience_ns);
    if (result == MRT_OK)
        return self->link.block->result;
    fail(self, result == MRT_ERR_IO ? "ended" : "did not answer");
    return MRT_ERR_IO;
}

/* ---- process ---- */

static void fail_late(mrt_plugin *self)
{
    char reason[64];
    (void)snprintf(reason, sizeof reason, "did not answer for %.1f s",
                   (double)(clock_now_ns() - self->asked_ns) * 1e-9);
    fail(self, reason);
}

/* The mapping is to blame, not a machine that had no turn for its process or for this one. */
static bool hangs(const mrt_plugin *self)
{
    int64_t owed_ns = clock_now_ns() - self->asked_ns;
    bool has_had_turns = isolate_process_cpu_ns(&self->link) - self->asked_cpu_ns >= turn_ns;
    return self->held_frames >= HANG_FRAMES &&
           owed_ns >= (has_had_turns ? hang_ns : hang_without_turn_ns);
}

static void count_late(mrt_plugin *self)
{
    self->held_frames += 1;
    atomic_fetch_add(&self->late_count, 1);
    TRACE(TRACE_MAPPING, "%s: late, %u frames held", self->inner->id, self->held_frames);
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

static void hold_late(mrt_plugin *self)
{
    count_late(self);
    if (self->is_virtual || hangs(self))
        fail_late(self);
}

static mrt_result take_answer(mrt_plugin *self, mrt_pull *pull)
{
    const isolate_block *block = self->link.block;
    mrt_pull answer = block->pull;
    mrt_result result = block->result;
    char reason[160];
    const char *fault = result == MRT_OK ? guard_fault(&self->guard, &answer) : NULL;
    isolate_process_drain(&self->link, self->host);
    if (fault || (result != MRT_OK && result != MRT_HOLD)) {
        if (fault)
            (void)snprintf(reason, sizeof reason, "gave %s", fault);
        else
            (void)snprintf(reason, sizeof reason, "returned %d", (int)result);
        fail(self, reason);
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
    return result;
}

/* The answer to an earlier request; true: the child is free for this frame. out_late: of that
 * answer. */
static bool take_late_answer(mrt_plugin *self, mrt_pull *pull, mrt_result *out_late)
{
    *out_late = MRT_HOLD;
    if (!self->owed)
        return true;
    bool is_wanted = self->owed == ISOLATE_PROCESS && !self->is_to_reset;
    mrt_result waited = isolate_process_wait_until_ns(&self->link, 0);
    if (waited == MRT_OK && is_wanted && self->held_frames > 1 && self->held_frames < HELD_MAX &&
        !self->is_announced) {
        self->held_frames += 1; /* the layer is between two pulls: it would jump now */
        return false;
    }
    if (waited == MRT_OK) {
        self->owed = 0;
        self->held_frames = 0;
        self->is_announced = false;
        if (is_wanted)
            *out_late = take_answer(self, pull);
        return runs(self);
    }
    if (waited == MRT_ERR_IO)
        fail(self, "ended");
    else
        hold_late(self);
    return false;
}

static void put_frame(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *pull)
{
    isolate_block *block = self->link.block;
    block->frame = *frame;
    block->pull = *pull;
    memcpy(block->params, self->params, self->param_count * sizeof *block->params);
    isolate_inputs_put(block, frame);
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
    if (!take_late_answer(self, pull, &late)) {
        *pull = entry;
        return MRT_HOLD;
    }
    mrt_result waited = settle(self, until_ns);
    if (waited == MRT_OK) {
        put_frame(self, frame, pull);
        waited = put_request(self, ISOLATE_PROCESS, until_ns);
    }
    if (waited == MRT_TIMEOUT) {
        hold_late(self);
        return late; /* one that is always late is seen too */
    }
    if (waited < 0) {
        fail(self, "ended");
        return MRT_HOLD;
    }
    count_in_time(self);
    return take_answer(self, pull);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    if (!runs(self))
        return MRT_HOLD;
    isolate_memory_add(&self->memory, frame);
    memcpy(self->params, frame->params, self->param_count * sizeof *self->params);
    return forward(self, frame, pull);
}

/* It was held for some frames, and now comes back: the face is not to catch up in one. */
static bool comes_back(const mrt_plugin *self)
{
    if (!runs(self) || self->owed != ISOLATE_PROCESS || self->held_frames <= 1)
        return false; /* while it does not run the block is the supervisor's */
    const isolate_block *block = self->link.block;
    return atomic_load(&block->answered) == atomic_load(&block->asked);
}

static bool take_over(mrt_plugin *self, mrt_pull *pull)
{
    if (atomic_load(&self->phase) != ISOLATE_READY)
        return self->is_announced = comes_back(self);
    bool is_forgotten = self->is_forgotten;
    self->is_announced = self->has_saved = self->is_late_told = false;
    self->is_forgotten = self->has_asked_resume = false;
    self->is_to_reset = is_forgotten;
    self->owed = 0;
    self->late_score = 0;
    self->held_frames = 0;
    atomic_store(&self->phase, ISOLATE_RUNNING);
    if (!is_forgotten && self->resume_size > 0)
        *pull = self->resume_pull; /* what it held in the state that it goes on from */
    return true;
}

static void reset(mrt_plugin *self)
{
    if (!runs(self)) {
        self->is_forgotten = true;
        return;
    }
    self->resume_size = 0;
    self->has_asked_resume = false;
    self->memory.count = 0;
    self->is_to_reset = true; /* before the next frame, within its deadline */
}

/* ---- [main] ---- */

static void set_poses(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses,
                      uint32_t count)
{
    (void)face; /* activate, which follows, has it too */
    pthread_mutex_lock(&self->busy);
    self->poses = poses;
    self->pose_count = count;
    pthread_mutex_unlock(&self->busy);
}

static void forget_face(mrt_plugin *self)
{
    self->face = NULL;
    self->poses = NULL;
    self->pose_count = 0;
}

static const char *why_not_active(bool is_free, const mrt_face *face)
{
    if (!is_free)
        return "its process does not answer: start it anew";
    if (isolate_face_put(NULL, 0, face) >= ISOLATE_BYTES)
        return "the face has too many contacts for a process of its own";
    return "the rig has too many poses for a process of its own";
}

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
    bool is_free = runs(self) && settle(self, clock_now_ns() + main_patience_ns) == MRT_OK;
    if (is_free && put_mapped(self, face) < ISOLATE_BYTES)
        result = ask_child(self, ISOLATE_ACTIVATE, main_patience_ns);
    else
        say(self, MRT_LOG_ERROR, why_not_active(is_free, face));
    if (result < 0)
        forget_face(self);
    else
        self->face = face;
    pthread_mutex_unlock(&self->busy);
    return result;
}

static void deactivate(mrt_plugin *self)
{
    pthread_mutex_lock(&self->busy);
    forget_face(self);
    if (runs(self))
        (void)ask_child(self, ISOLATE_DEACTIVATE, main_patience_ns);
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
    return self->has_saved && self->saved_kind == kind && runs(self);
}

static mrt_result load_bytes(mrt_plugin *self, uint32_t kind, int64_t patience_ns,
                             const void *bytes, size_t size)
{
    if (!runs(self) || size > ISOLATE_BYTES || settle(self, clock_now_ns() + patience_ns) != MRT_OK)
        return MRT_ERR_UNSUPPORTED;
    self->has_saved = false;
    memcpy(self->link.block->bytes, bytes, size);
    self->link.block->size = (uint32_t)size;
    return ask_child(self, kind, patience_ns);
}

/* ---- [frame]: what is kept between two frames ---- */

/* 0 too when it is late now: that is no failure. */
static size_t save_between(mrt_plugin *self, uint32_t kind, void *out, size_t capacity)
{
    bool is_there = has_saved(self, kind);
    if (!is_there && self->is_virtual)
        is_there = ask_child(self, kind, virtual_deadline_ns) >= 0;
    else if (!is_there && runs(self))
        is_there =
            put_settled(self, kind, save_patience_ns) == MRT_OK && self->link.block->result >= 0;
    return is_there ? saved_bytes(self, kind, out, capacity) : 0;
}

static size_t state_save(mrt_plugin *self, void *out, size_t capacity)
{
    return save_between(self, ISOLATE_STATE_SAVE, out, capacity);
}

static mrt_result state_load(mrt_plugin *self, const void *bytes, size_t size)
{
    if (size > ISOLATE_BYTES || pthread_mutex_trylock(&self->busy) != 0)
        return MRT_ERR_UNSUPPORTED; /* it is away, and comes back as it was */
    mrt_result result = load_bytes(self, ISOLATE_STATE_LOAD,
                                   self->is_virtual ? virtual_deadline_ns : hang_ns, bytes, size);
    if (result >= 0) { /* a new process gets it too */
        memcpy(self->state, bytes, size);
        self->state_size = size;
    }
    pthread_mutex_unlock(&self->busy);
    return result;
}

static size_t resume_save(mrt_plugin *self, void *out, size_t capacity)
{
    return save_between(self, ISOLATE_RESUME_SAVE, out, capacity);
}

static mrt_result resume_load(mrt_plugin *self, const void *bytes, size_t size)
{
    if (!runs(self))
        return MRT_ERR_UNSUPPORTED;
    self->resume_size = 0;
    self->has_asked_resume = false;
    return load_bytes(self, ISOLATE_RESUME_LOAD, self->is_virtual ? virtual_deadline_ns : hang_ns,
                      bytes, size);
}

/* ---- made and unmade ---- */

static mrt_plugin *create(const mrt_host *host)
{
    const instance *made = host->data; /* this host is always ours */
    const isolate *of = isolate_of(made->type);
    mrt_plugin *self = calloc(1, sizeof *self);
    unsigned char *resume = malloc(ISOLATE_BYTES), *state = malloc(ISOLATE_BYTES);
    if (!self || !resume || !state) {
        free(self);
        free(resume);
        free(state);
        return NULL;
    }
    self->host = host;
    self->inner = of->outer.inner;
    self->library = of->outer.library;
    self->writes_reports = of->settings.writes_reports;
    self->is_virtual = of->settings.clock == CLOCK_VIRTUAL;
    self->deadline_ns = self->is_virtual               ? virtual_deadline_ns
                        : of->settings.deadline_ns > 0 ? of->settings.deadline_ns
                                                       : deadline_default_ns;
    self->param_count = of->outer.inner->param_count;
    self->can_resume = plugin_interface(of->outer.inner, MRT_RESUME) != NULL;
    self->resume = resume;
    self->state = state;
    if (supervisor_start(self) >= 0)
        return self;
    free(resume);
    free(state);
    free(self);
    return NULL;
}

static void destroy(mrt_plugin *self)
{
    if (!self)
        return;
    supervisor_stop(self);
    free(self->resume);
    free(self->state);
    free(self);
}

isolate_counts isolate_counted(const mrt_plugin *self)
{
    return (isolate_counts){.failed = atomic_load(&self->failed_count),
                            .restarted = atomic_load(&self->restarted_count),
                            .late = atomic_load(&self->late_count),
                            .is_away = !runs(self)};
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
        clock_now_ns() + main_patience_ns; /* it is away before its supervisor knows why */
    while (!runs(self) && atomic_load(&self->failed_count) == 0 && clock_now_ns() < until_ns)
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
    if (runs(self) && atomic_load(&self->failed_count) == 0)
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
    return isolate_of(outer)->outer.inner;
}

static const mrt_mapping mapping = {activate, deactivate, reset, process};
static const mrt_rig_poses rig_poses = {set_poses};
static const mrt_state state = {state_save, state_load};
static const mrt_resume resume = {resume_save, resume_load};
static const isolate_takeover takeover = {take_over, inner_of};

const mrt_plugin_type *isolate_inner(const mrt_plugin_type *type)
{
    const isolate_takeover *s = plugin_interface(type, ISOLATE_TAKEOVER);
    return s ? s->inner(type) : type;
}

bool isolate_is_wanted(isolate_which which, const char *library)
{
    if (!library || !library[0] || which == ISOLATE_NONE)
        return false;
    return which == ISOLATE_ALL || !plugin_is_shipped(library);
}

/* A type like the inner one, but for its interfaces and how it is made, which follow. */
static mrt_result wrap(isolate **out, const mrt_plugin_type *inner, const char *library, error *err)
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
    self->outer.inner = inner;
    self->outer.library = path;
    self->outer.type = *inner;
    self->outer.type.interfaces = self->outer.interfaces;
    *out = self;
    return MRT_OK;
}

mrt_result isolate_create_mapping(isolate **out, const mrt_plugin_type *inner, const char *library,
                                  const isolate_settings *settings, error *err)
{
    mrt_result result = wrap(out, inner, library, err);
    if (result < 0)
        return result;
    isolate *self = *out;
    mrt_interface *next = self->outer.interfaces;
    *next++ = (mrt_interface){MRT_MAPPING, &mapping};
    *next++ = (mrt_interface){ISOLATE_TAKEOVER, &takeover};
    if (plugin_interface(inner, MRT_RIG_POSES))
        *next++ = (mrt_interface){MRT_RIG_POSES, &rig_poses};
    if (plugin_interface(inner, MRT_STATE))
        *next++ = (mrt_interface){MRT_STATE, &state};
    if (plugin_interface(inner, MRT_RESUME))
        *next++ = (mrt_interface){MRT_RESUME, &resume};
    self->settings = *settings;
    self->outer.type.create = create;
    self->outer.type.destroy = destroy;
    return MRT_OK;
}

mrt_result isolate_create_output(isolate **out, const mrt_plugin_type *inner, const char *library,
                                 error *err)
{
    mrt_result result = wrap(out, inner, library, err);
    if (result < 0)
        return result;
    isolate *self = *out;
    self->outer.interfaces[0] = (mrt_interface){MRT_FACE_OUTPUT, &isolate_output_functions};
    self->outer.type.create = isolate_output_make;
    self->outer.type.destroy = isolate_output_unmake;
    return MRT_OK;
}

void isolate_destroy(isolate *self)
{
    if (!self)
        return;
    free(self->outer.library);
    free(self);
}

const mrt_plugin_type *isolate_type(const isolate *self)
{
    return &self->outer.type;
}
