/* The thread that starts a mapping's process, sees it end, and starts another. */
#include "stage/mapping/isolate_state.h"

#include <stdio.h>
#include <errno.h>
#include <limits.h>
#include <poll.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

static const int64_t start_patience_ns = 5 * NS_PER_S;
static const int64_t goodbye_patience_ns = NS_PER_S / 5;
static const int64_t slice_ns = 20 * NS_PER_MS;
static const int64_t again_ns = 60 * NS_PER_S;
enum { DEATH_MS = 20 };

static void say(const mrt_plugin *self, int32_t level, const char *text)
{
    self->host->log(self->host, level, text);
}

static bool has_ended(const isolate_link *link, int timeout_ms)
{
    struct pollfd end = {.fd = link->pidfd, .events = POLLIN};
    return link->pidfd >= 0 && poll(&end, 1, timeout_ms) > 0;
}

/* ---- a child is started ---- */

/* As ask of the calling thread, but notices the child's end by itself. */
static mrt_result ask(isolate_link *link, uint32_t kind, int64_t patience_ns)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    mrt_result result = MRT_TIMEOUT;
    isolate_link_ask(link, kind);
    while (result == MRT_TIMEOUT && clock_now_ns() < until_ns) {
        result = isolate_link_wait_until_ns(link, clock_now_ns() + slice_ns);
        if (result == MRT_TIMEOUT && has_ended(link, 0))
            isolate_link_tell_dead(link);
    }
    return result == MRT_OK ? link->block->result : MRT_ERR_IO;
}

static mrt_result ask_with(isolate_link *link, uint32_t kind, const void *bytes, size_t size)
{
    if (size > ISOLATE_BYTES)
        return MRT_ERR_ARGUMENT;
    memcpy(link->block->bytes, bytes, size);
    link->block->size = (uint32_t)size;
    return ask(link, kind, start_patience_ns);
}

static bool is_same_table(const mrt_plugin *self, const isolate_block *block)
{
    return block->param_count == self->inner->param_count &&
           block->param_sum == isolate_param_sum(self->inner);
}

/* The plugin's words, or how its process went. */
static mrt_result explain_start(mrt_plugin *self, error *err)
{
    error how = {""};
    bool died = has_ended(&self->link, 0);
    (void)error_set(err, MRT_ERR_UNSUPPORTED, "its process gave no answer");
    bool has_words = isolate_link_why(&self->link, err);
    isolate_link_end(&self->link, &how);
    if (died && !has_words)
        *err = how;
    isolate_link_finish(&self->link);
    return MRT_ERR_UNSUPPORTED;
}

/* Started, and the plugin created. On failure nothing is left. */
static mrt_result start(mrt_plugin *self, error *err)
{
    mrt_result result = isolate_link_start(&self->link, self->library, self->inner->id, err);
    if (result < 0)
        return result;
    result = ask(&self->link, ISOLATE_CREATE, start_patience_ns);
    if (result < 0)
        return explain_start(self, err);
    isolate_link_drain(&self->link, self->host);
    if (is_same_table(self, self->link.block)) {
        atomic_store(&self->pid, (int32_t)self->link.pid);
        return MRT_OK;
    }
    isolate_link_end(&self->link, NULL);
    isolate_link_finish(&self->link);
    return error_set(err, MRT_ERR_FORMAT, "its library has changed: its parameters are others");
}

/* As the one that has failed was a second ago at most. */
static mrt_result bring_up(mrt_plugin *self)
{
    isolate_link *link = &self->link;
    error why = {""};
    mrt_result result = start(self, &why);
    if (result < 0) {
        say(self, MRT_LOG_WARNING, why.text);
        return result;
    }
    if (self->state)
        result = ask_with(link, ISOLATE_STATE_LOAD, self->state, self->state_size);
    if (result >= 0) {
        size_t size = isolate_face_put(link->block->bytes, ISOLATE_BYTES, self->face);
        link->block->size = (uint32_t)size;
        result = ask(link, ISOLATE_ACTIVATE, start_patience_ns);
    }
    if (result >= 0)
        result = ask(link, ISOLATE_RESET, start_patience_ns);
    if (result >= 0 && self->resume_size > 0 &&
        ask_with(link, ISOLATE_RESUME_LOAD, self->resume, self->resume_size) < 0) {
        self->resume_size = 0;
        result = ask(link, ISOLATE_RESET, start_patience_ns);
    }
    isolate_link_drain(link, self->host);
    return result;
}

/* ---- a child has failed ---- */

static void end_child(mrt_plugin *self, error *out_how)
{
    atomic_store(&self->pid, 0);
    isolate_link_end(&self->link, out_how);
    if (self->link.block)
        isolate_link_drain(&self->link, self->host);
    isolate_link_finish(&self->link);
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
static void bury(mrt_plugin *self, error *out_reason)
{
    error how = {""};
    bool died = has_ended(&self->link, DEATH_MS);
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
    bury(self, &reason);
    if (atomic_load(&self->failed_count) == 0)
        snprintf(self->first_reason, sizeof self->first_reason, "%.150s", reason.text);
    atomic_fetch_add(&self->failed_count, 1);
    self->has_failed_before = true;
    self->failed_ns = now_ns;
    (void)error_set(&text, MRT_OK, "%s: the face is held, and a simple mapping goes on%s",
                    reason.text,
                    is_again ? "; it has failed twice within a minute, so that one stays" : "");
    say(self, MRT_LOG_WARNING, text.text);
    write_report(self, reason.text);
    self->memory.count = 0;
    bool is_up = !is_again && self->face && bring_up(self) >= 0;
    if (is_up) {
        atomic_fetch_add(&self->restarted_count, 1);
        say(self, MRT_LOG_INFO, "runs again in a new process");
    } else {
        end_child(self, NULL);
        if (!is_again && self->face)
            say(self, MRT_LOG_WARNING, "could not be started again: the simple mapping stays");
    }
    atomic_store(&self->phase, is_up ? ISOLATE_READY : ISOLATE_LOST);
}

/* ---- the thread ---- */

void isolate_keeper_wake(mrt_plugin *self)
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
            isolate_link_tell_dead(&self->link);
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

static void say_goodbye(mrt_plugin *self)
{
    uint32_t phase = atomic_load(&self->phase);
    bool answers = phase == ISOLATE_RUNNING || phase == ISOLATE_READY;
    if (answers && self->link.block && !self->owed && !has_ended(&self->link, 0))
        (void)ask(&self->link, ISOLATE_DESTROY, goodbye_patience_ns);
    end_child(self, NULL);
}

static void *keeper_main(void *data)
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
    say_goodbye(self);
    return NULL;
}

mrt_result isolate_keeper_start(mrt_plugin *self)
{
    self->link.pidfd = -1;
    self->wake_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (self->wake_fd < 0)
        return MRT_ERR_IO;
    pthread_mutex_init(&self->busy, NULL);
    pthread_mutex_init(&self->start_mutex, NULL);
    pthread_cond_init(&self->start_cond, NULL);
    bool is_up = pthread_create(&self->keeper, NULL, keeper_main, self) == 0;
    pthread_mutex_lock(&self->start_mutex);
    while (is_up && self->start == 0)
        pthread_cond_wait(&self->start_cond, &self->start_mutex);
    pthread_mutex_unlock(&self->start_mutex);
    if (is_up && self->start > 0)
        return MRT_OK;
    if (is_up)
        pthread_join(self->keeper, NULL);
    say(self, MRT_LOG_ERROR, self->start_error.text); /* from the thread that is listened to */
    close(self->wake_fd);
    pthread_cond_destroy(&self->start_cond);
    pthread_mutex_destroy(&self->start_mutex);
    pthread_mutex_destroy(&self->busy);
    return MRT_ERR_UNSUPPORTED;
}

void isolate_keeper_stop(mrt_plugin *self)
{
    atomic_store(&self->is_stopping, true);
    isolate_keeper_wake(self);
    pthread_join(self->keeper, NULL);
    close(self->wake_fd);
    pthread_cond_destroy(&self->start_cond);
    pthread_mutex_destroy(&self->start_mutex);
    pthread_mutex_destroy(&self->busy);
}
