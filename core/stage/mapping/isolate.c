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
/* A frame waits for its deadline, then keeps the last pose. A child hangs if it has owed an answer
 * for hang_ns and HANG_FRAMES frames. On a busy machine it may have had no processor time (less
 * than turn_ns); then the limit is hang_without_turn_ns. */
static const int64_t hang_ns = NS_PER_S, turn_ns = 50 * NS_PER_MS;
static const int64_t hang_without_turn_ns = 3 * NS_PER_S;
enum { HANG_FRAMES = 8 };
/* A take needs its initial state, so a frame may wait this long for it. */
static const int64_t save_patience_ns = 100 * NS_PER_MS;
/* Scores of late answers: a warning is logged when the score reaches LATE_MAX. */
enum { LATE_COST = 8, LATE_MAX = 64 };
/* Number of held frames up to which a late answer waits for a crossfade. After it, the answer is
 * used directly. */
enum { HELD_MAX = 64 };
/* Interval between saved states of the child. */
static const int64_t resume_span_ns = NS_PER_S;

/* Ownership of the struct: in RUNNING the thread that calls the plugin owns it. From FAILED on the
 * supervisor owns it, until READY (the caller may take it back) or LOST. */
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
    bool is_to_reset; /* send a reset before the next request */
    uint32_t owed;    /* request without an answer so far; 0: none */
    bool has_saved;   /* `bytes` of the block is the answer to saved_kind */
    uint32_t saved_kind;
    int32_t late_score;
    bool is_late_logged;
    uint32_t held_frames; /* consecutive frames without an answer to one request */
    bool is_announced;    /* the layer knows that the answer returns after a pause */
    int64_t asked_ns, asked_cpu_ns;
    double params[ISOLATE_PARAMS_MAX]; /* values of the last frame */
    isolate_memory memory;
    char reason[160];       /* reason of the failure; "ended": see the exit status */
    char first_reason[160]; /* of the first failure; written before failed_count is increased */

    /* MRT_RESUME state, ISOLATE_BYTES of room; resume_pull is the pull at that time */
    unsigned char *resume;
    uint32_t resume_size; /* 0: none */
    mrt_pull resume_pull;
    bool has_asked_resume;
    int64_t resume_asked_ns;

    bool has_missed_reset; /* owned by the caller: reset was called while the child was not running
                            */

    pthread_mutex_t busy;      /* held by [main] functions, and by the supervisor during recovery */
    const mrt_face *face;      /* guarded by busy; NULL: not active */
    const mrt_rig_pose *poses; /* guarded by busy; of the active face or of the next one */
    uint32_t pose_count;
    unsigned char *state; /* guarded by busy: last loaded MRT_STATE, ISOLATE_BYTES of room */
    size_t state_size;    /* 0: none */

    /* owned by the supervisor */
    pthread_t supervisor;
    int wake_fd;
    pthread_mutex_t start_mutex;
    pthread_cond_t start_cond;
    int start; /* 0: not started, 1: running, -1: failed */
    error start_error;
    _Atomic bool is_stopping;
    bool has_failed_before;
    int64_t failed_ns;
};

struct isolate {
    isolate_outer outer; /* must be first: the type is cast to isolate */
    isolate_settings settings;
};

static const isolate *isolate_of(const mrt_plugin_type *type)
{
    return (const isolate *)(const void *)type;
}

/* ---- supervisor: the thread that starts a process, detects its end, and starts another one
 * ---- */

static const int64_t start_patience_ns = 5 * NS_PER_S;
static const int64_t end_patience_ns = NS_PER_S / 5;
static const int64_t again_ns = 60 * NS_PER_S;
enum { DEATH_MS = 20 };

static void log_text(const mrt_plugin *self, int32_t level, const char *text)
{
    self->host->log(self->host, level, text);
}

/* ---- start a child ---- */

static mrt_result call_with(isolate_process *link, uint32_t kind, const void *bytes, size_t size)
{
    if (size > ISOLATE_BYTES)
        return MRT_ERR_ARGUMENT;
    memcpy(link->block->bytes, bytes, size);
    link->block->size = (uint32_t)size;
    return isolate_process_call(link, kind, start_patience_ns);
}

/* Sets the error to the text of the plugin, or to the exit status of its process. */
static mrt_result explain_start(mrt_plugin *self, error *err)
{
    error how = {""};
    bool died = isolate_process_has_ended(&self->link, 0);
    (void)error_set(err, MRT_ERR_UNSUPPORTED, "its process did not answer");
    bool has_words = isolate_process_last_error(&self->link, err);
    isolate_process_end(&self->link, &how);
    if (died && !has_words)
        *err = how;
    isolate_process_finish(&self->link);
    return MRT_ERR_UNSUPPORTED;
}

/* Starts the process and creates the plugin. On failure it frees everything. */
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
    return error_set(err, MRT_ERR_FORMAT, "its library has changed: the parameters are different");
}

/* Writes the face and its poses into the block. Returns the size, which must be less than
 * ISOLATE_BYTES. */
static size_t write_mapped(mrt_plugin *self, const mrt_face *face)
{
    isolate_block *block = self->link.block;
    size_t size =
        isolate_mapped_write(block->bytes, ISOLATE_BYTES, face, self->poses, self->pose_count);
    block->size = size < ISOLATE_BYTES ? (uint32_t)size : 0;
    return size;
}

/* Starts a child with the state of the failed one, which is at most one second old. */
static mrt_result bring_up(mrt_plugin *self)
{
    isolate_process *link = &self->link;
    error why = {""};
    mrt_result result = start(self, &why);
    if (result < 0) {
        log_text(self, MRT_LOG_WARNING, why.text);
        return result;
    }
    if (self->state_size > 0)
        result = call_with(link, ISOLATE_STATE_LOAD, self->state, self->state_size);
    if (result >= 0) {
        (void)write_mapped(self, self->face); /* its size was checked by activate */
        result = isolate_process_call(link, ISOLATE_ACTIVATE, start_patience_ns);
    }
    if (result >= 0)
        result = isolate_process_call(link, ISOLATE_RESET, start_patience_ns);
    if (result >= 0 && self->resume_size > 0 &&
        call_with(link, ISOLATE_RESUME_LOAD, self->resume, self->resume_size) < 0) {
        self->resume_size = 0;
        result = isolate_process_call(link, ISOLATE_RESET, start_patience_ns);
    }
    isolate_process_drain(link, self->host);
    return result;
}

/* ---- failure of a child ---- */

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
        (void)error_set(&text, result, "cannot write a report: %s", err.text);
    else
        (void)error_set(&text, MRT_OK, "its last inputs are saved in %s", folder);
    log_text(self, result < 0 ? MRT_LOG_WARNING : MRT_LOG_INFO, text.text);
}

/* Ends the process and describes why it failed. */
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
    (void)error_set(&text, MRT_OK, "%s. The face keeps its last pose%s", reason.text,
                    is_again ? ". It has failed twice within a minute: choose another mapping"
                             : "");
    log_text(self, MRT_LOG_WARNING, text.text);
    write_report(self, reason.text);
    self->memory.count = 0;
    bool is_up = !is_again && self->face && bring_up(self) >= 0;
    if (!is_up)
        end_child(self, NULL);
    atomic_store(&self->phase, is_up ? ISOLATE_READY : ISOLATE_LOST);
    if (is_up) { /* the count comes last, because the caller may own it then */
        atomic_fetch_add(&self->restarted_count, 1);
        log_text(self, MRT_LOG_INFO, "runs again in a new process");
    } else if (!is_again && self->face) {
        log_text(self, MRT_LOG_WARNING, "cannot be restarted: the face keeps its last pose");
    }
}

/* ---- supervisor thread ---- */

static void supervisor_wake(mrt_plugin *self)
{
    const uint64_t one = 1;
    ssize_t written = write(self->wake_fd, &one, sizeof one);
    (void)written; /* if the counter is full, the supervisor is already awake */
}

static void clear_wake(const mrt_plugin *self)
{
    uint64_t count;
    ssize_t got = read(self->wake_fd, &count, sizeof count);
    (void)got;
}

static void supervise(mrt_plugin *self)
{
    bool is_marked_dead = false;
    while (!atomic_load(&self->is_stopping)) {
        struct pollfd on[2] = {{.fd = self->wake_fd, .events = POLLIN},
                               {.fd = is_marked_dead ? -1 : self->link.pidfd, .events = POLLIN}};
        if (poll(on, 2, -1) < 0 && errno != EINTR)
            return;
        if (on[1].revents) {
            isolate_process_mark_dead(&self->link);
            is_marked_dead = true;
        }
        if (on[0].revents)
            clear_wake(self);
        if (atomic_load(&self->phase) != ISOLATE_FAILED || atomic_load(&self->is_stopping))
            continue;
        pthread_mutex_lock(&self->busy);
        recover(self);
        pthread_mutex_unlock(&self->busy);
        is_marked_dead = false;
    }
}

static void request_end(mrt_plugin *self)
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
    supervise(self);
    request_end(self);
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
    log_text(self, MRT_LOG_ERROR,
             self->start_error.text); /* logged on the thread that captures the log */
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

/* ---- requests ---- */

static bool runs(const mrt_plugin *self)
{
    return atomic_load(&self->phase) == ISOLATE_RUNNING;
}

/* Hands the struct over to the supervisor. The face keeps its last pose. */
static void fail(mrt_plugin *self, const char *reason)
{
    (void)snprintf(self->reason, sizeof self->reason, "%s", reason);
    self->owed = 0;
    atomic_store(&self->phase, ISOLATE_FAILED);
    supervisor_wake(self);
}

/* Sends a request and waits. The child owns the block until its answer. MRT_TIMEOUT: the answer is
 * still owed; MRT_ERR_IO: the process has ended. */
static mrt_result send_request(mrt_plugin *self, uint32_t kind, int64_t until_ns)
{
    self->has_saved = false;
    self->owed = kind;
    self->asked_cpu_ns = isolate_process_cpu_ns(&self->link);
    self->asked_ns = clock_now_ns();
    isolate_process_send(&self->link, kind);
    mrt_result result = isolate_process_wait_until_ns(&self->link, until_ns);
    if (result == MRT_OK)
        self->owed = 0;
    return result;
}

/* Waits for an owed answer, discards it, and sends a delayed reset. Returns like send_request. */
static mrt_result settle(mrt_plugin *self, int64_t until_ns)
{
    mrt_result result = self->owed ? isolate_process_wait_until_ns(&self->link, until_ns) : MRT_OK;
    if (result == MRT_OK)
        self->owed = 0;
    if (result != MRT_OK || !self->is_to_reset)
        return result;
    self->is_to_reset = false;
    return send_request(self, ISOLATE_RESET, until_ns);
}

/* Settles, then sends a request. */
static mrt_result send_settled(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    mrt_result result = settle(self, until_ns);
    if (result == MRT_OK)
        result = send_request(self, kind, until_ns);
    isolate_process_drain(&self->link, self->host);
    return result;
}

/* Settles, sends a request and returns the result of the child. A missing answer is a failure. Not
 * for process. */
static mrt_result call_child(mrt_plugin *self, uint32_t kind, int64_t patience_ns)
{
    if (!runs(self))
        return MRT_ERR_UNSUPPORTED;
    mrt_result result = send_settled(self, kind, patience_ns);
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

/* Returns whether the mapping itself hangs. A computer without processor time for it is not a
 * hang. */
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
    if (self->late_score < LATE_MAX || self->is_late_logged)
        return;
    self->is_late_logged = true;
    self->host->log(
        self->host, MRT_LOG_WARNING,
        "often answers late, and the face keeps its last pose until then: it computes for "
        "too long, or the computer is busy");
}

static void count_in_time(mrt_plugin *self)
{
    self->held_frames = 0;
    self->late_score -= self->late_score > 0;
    self->is_late_logged = self->is_late_logged && self->late_score > 0;
}

static void hold_late(mrt_plugin *self)
{
    count_late(self);
    if (self->is_virtual || hangs(self))
        fail_late(self);
}

static mrt_result read_answer(mrt_plugin *self, mrt_pull *pull)
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

/* Reads the answer to an earlier request. True: the child is free for this frame. out_late: the
 * result of that answer. */
static bool read_late_answer(mrt_plugin *self, mrt_pull *pull, mrt_result *out_late)
{
    *out_late = MRT_HOLD;
    if (!self->owed)
        return true;
    bool is_wanted = self->owed == ISOLATE_PROCESS && !self->is_to_reset;
    mrt_result waited = isolate_process_wait_until_ns(&self->link, 0);
    if (waited == MRT_OK && is_wanted && self->held_frames > 1 && self->held_frames < HELD_MAX &&
        !self->is_announced) {
        /* the layer is crossfading, so the answer would make the face jump now */
        self->held_frames += 1;
        return false;
    }
    if (waited == MRT_OK) {
        self->owed = 0;
        self->held_frames = 0;
        self->is_announced = false;
        if (is_wanted)
            *out_late = read_answer(self, pull);
        return runs(self);
    }
    if (waited == MRT_ERR_IO)
        fail(self, "ended");
    else
        hold_late(self);
    return false;
}

static void write_frame(mrt_plugin *self, const mrt_frame *frame, const mrt_pull *pull)
{
    isolate_block *block = self->link.block;
    block->frame = *frame;
    block->pull = *pull;
    memcpy(block->params, self->params, self->param_count * sizeof *block->params);
    isolate_inputs_write(block, frame);
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
    mrt_pull entry = *pull; /* last pose, for a failure */
    mrt_result late;
    int64_t until_ns = clock_now_ns() + self->deadline_ns;
    if (!read_late_answer(self, pull, &late)) {
        *pull = entry;
        return MRT_HOLD;
    }
    mrt_result waited = settle(self, until_ns);
    if (waited == MRT_OK) {
        write_frame(self, frame, pull);
        waited = send_request(self, ISOLATE_PROCESS, until_ns);
    }
    if (waited == MRT_TIMEOUT) {
        hold_late(self);
        return late; /* an answer that is always one frame late is used too */
    }
    if (waited < 0) {
        fail(self, "ended");
        return MRT_HOLD;
    }
    count_in_time(self);
    return read_answer(self, pull);
}

static mrt_result process(mrt_plugin *self, const mrt_frame *frame, mrt_pull *pull)
{
    if (!runs(self))
        return MRT_HOLD;
    isolate_memory_add(&self->memory, frame);
    memcpy(self->params, frame->params, self->param_count * sizeof *self->params);
    return forward(self, frame, pull);
}

/* Returns whether an answer has arrived after several frames. The face must not jump to it in one
 * frame. */
static bool comes_back(const mrt_plugin *self)
{
    if (!runs(self) || self->owed != ISOLATE_PROCESS || self->held_frames <= 1)
        return false; /* the supervisor owns the block */
    const isolate_block *block = self->link.block;
    return atomic_load(&block->answered) == atomic_load(&block->asked);
}

static bool take_over(mrt_plugin *self, mrt_pull *pull)
{
    if (atomic_load(&self->phase) != ISOLATE_READY)
        return self->is_announced = comes_back(self);
    bool has_missed_reset = self->has_missed_reset;
    self->is_announced = self->has_saved = self->is_late_logged = false;
    self->has_missed_reset = self->has_asked_resume = false;
    self->is_to_reset = has_missed_reset;
    self->owed = 0;
    self->late_score = 0;
    self->held_frames = 0;
    atomic_store(&self->phase, ISOLATE_RUNNING);
    if (!has_missed_reset && self->resume_size > 0)
        *pull = self->resume_pull; /* the pull that belongs to the restored state */
    return true;
}

static void reset(mrt_plugin *self)
{
    if (!runs(self)) {
        self->has_missed_reset = true;
        return;
    }
    self->resume_size = 0;
    self->has_asked_resume = false;
    self->memory.count = 0;
    self->is_to_reset = true; /* sent before the next frame, within its deadline */
}

/* ---- [main] ---- */

static void set_poses(mrt_plugin *self, const mrt_face *face, const mrt_rig_pose *poses,
                      uint32_t count)
{
    (void)face; /* activate, which follows, receives it too */
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
        return "its process does not answer: choose the mapping again";
    if (isolate_face_write(NULL, 0, face) >= ISOLATE_BYTES)
        return "the face has too many contacts for an isolated mapping";
    return "the rig has too many poses for an isolated mapping";
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
    if (is_free && write_mapped(self, face) < ISOLATE_BYTES)
        result = call_child(self, ISOLATE_ACTIVATE, main_patience_ns);
    else
        log_text(self, MRT_LOG_ERROR, why_not_active(is_free, face));
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
        (void)call_child(self, ISOLATE_DEACTIVATE, main_patience_ns);
    pthread_mutex_unlock(&self->busy);
}

/* Copies the answer to a save request. */
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
    return call_child(self, kind, patience_ns);
}

/* ---- [frame]: states between two frames ---- */

/* Returns 0 if the answer is late, which is not a failure here. */
static size_t save_between(mrt_plugin *self, uint32_t kind, void *out, size_t capacity)
{
    bool is_there = has_saved(self, kind);
    if (!is_there && self->is_virtual)
        is_there = call_child(self, kind, virtual_deadline_ns) >= 0;
    else if (!is_there && runs(self))
        is_there =
            send_settled(self, kind, save_patience_ns) == MRT_OK && self->link.block->result >= 0;
    return is_there ? saved_bytes(self, kind, out, capacity) : 0;
}

static size_t state_save(mrt_plugin *self, void *out, size_t capacity)
{
    return save_between(self, ISOLATE_STATE_SAVE, out, capacity);
}

static mrt_result state_load(mrt_plugin *self, const void *bytes, size_t size)
{
    if (size > ISOLATE_BYTES || pthread_mutex_trylock(&self->busy) != 0)
        return MRT_ERR_UNSUPPORTED; /* the process is being restored */
    mrt_result result = load_bytes(self, ISOLATE_STATE_LOAD,
                                   self->is_virtual ? virtual_deadline_ns : hang_ns, bytes, size);
    if (result >= 0) { /* also for a new process */
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

/* ---- create and destroy ---- */

static mrt_plugin *create(const mrt_host *host)
{
    const instance *made = host->data; /* the host is always one of the program */
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
    /* the process stops before the supervisor knows the reason */
    int64_t until_ns = clock_now_ns() + main_patience_ns;
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

/* Copies the inner type. The caller then sets the interfaces, create and destroy. */
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
