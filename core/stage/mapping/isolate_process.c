#include "stage/mapping/isolate_process.h"
#include "base/clock.h"
#include "base/program.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/memfd.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

static const int64_t spin_ns = 5000, slice_ns = 20 * NS_PER_MS;

static mrt_result find_program(char out[PATH_MAX], error *err)
{
    return program_find(out, "marotte-pluginhost", "MAROTTE_PLUGINHOST",
                        "isolated plugins run in it (or use --isolate off)", err);
}

/* ---- start and end ---- */

static mrt_result make_block(isolate_process *out, int *out_fd, error *err)
{
    int fd = (int)syscall(SYS_memfd_create, "marotte-mapping", MFD_CLOEXEC);
    if (fd < 0)
        return error_set(err, MRT_ERR_IO, "cannot create shared memory: %s", strerror(errno));
    void *at = MAP_FAILED;
    if (ftruncate(fd, (off_t)sizeof(isolate_block)) == 0)
        at = mmap(NULL, sizeof(isolate_block), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (at == MAP_FAILED) {
        int code = errno;
        close(fd);
        return error_set(err, MRT_ERR_MEMORY, "cannot create shared memory: %s", strerror(code));
    }
    out->block = at;
    out->block->version = ISOLATE_VERSION;
    out->block->program_pid = getpid();
    *out_fd = fd;
    return MRT_OK;
}

mrt_result isolate_process_start(isolate_process *out, const char *library, const char *type_id,
                                 error *err)
{
    char program[PATH_MAX];
    int fd = -1;
    *out = (isolate_process){.pidfd = -1};
    mrt_result result = find_program(program, err);
    if (result >= 0)
        result = make_block(out, &fd, err);
    if (result < 0)
        return result;
    char *words[] = {program, program_argument(library), program_argument(type_id), NULL};
    const program_start how = {.program = program,
                               .words = words,
                               .in = -1,
                               .out = STDERR_FILENO,
                               .err = STDERR_FILENO,
                               .passed = fd,
                               .passed_as = ISOLATE_FD,
                               .signals = PROGRAM_USUAL_SIGNALS};
    int failed = program_spawn(&out->pid, &how);
    close(fd);
    if (failed) {
        out->pid = 0;
        isolate_process_finish(out);
        return error_set(err, MRT_ERR_IO, "cannot run %s: %s", program, strerror(failed));
    }
    out->pidfd = (int)syscall(SYS_pidfd_open, out->pid, 0u);
    if (out->pidfd >= 0)
        (void)fcntl(out->pidfd, F_SETFD, FD_CLOEXEC);
    if (clock_getcpuclockid(out->pid, &out->cpu) != 0)
        out->cpu = CLOCK_REALTIME;
    return MRT_OK;
}

static void describe_end(int status, error *out)
{
    if (WIFSIGNALED(status))
        error_set(out, MRT_ERR_IO, "was ended by signal %d (%s)", WTERMSIG(status),
                  strsignal(WTERMSIG(status)));
    else
        error_set(out, MRT_ERR_IO, "ended its process with code %d", WEXITSTATUS(status));
}

void isolate_process_end(isolate_process *self, error *out_how)
{
    int status;
    if (self->pid == 0)
        return;
    (void)kill(self->pid, SIGKILL);
    if (program_wait(self->pid, &status, NS_PER_S) && out_how)
        describe_end(status, out_how);
    self->pid = 0;
    self->cpu = CLOCK_REALTIME;
    if (self->pidfd >= 0)
        close(self->pidfd);
    self->pidfd = -1;
}

void isolate_process_finish(isolate_process *self)
{
    if (self->block)
        munmap(self->block, sizeof *self->block);
    *self = (isolate_process){.pidfd = -1};
}

void isolate_process_mark_dead(isolate_process *self)
{
    atomic_store(&self->block->is_dead, 1);
    isolate_wake(&self->block->answered);
}

/* ---- requests ---- */

void isolate_process_send(isolate_process *self, uint32_t kind)
{
    isolate_block *block = self->block;
    block->kind = kind;
    atomic_fetch_add(&block->asked, 1);
    if (atomic_load(&block->child_waits))
        isolate_wake(&block->asked);
}

static bool has_answered(const isolate_block *block)
{
    return atomic_load(&block->answered) == atomic_load(&block->asked);
}

mrt_result isolate_process_wait_until_ns(isolate_process *self, int64_t time_ns)
{
    isolate_block *block = self->block;
    int64_t spun_ns = clock_now_ns() + spin_ns;
    while (!has_answered(block) && clock_now_ns() < spun_ns)
        ;
    atomic_store(&block->program_waits, 1);
    while (!has_answered(block) && !atomic_load(&block->is_dead) && clock_now_ns() < time_ns) {
        uint32_t seen = atomic_load(&block->answered);
        if (seen != atomic_load(&block->asked))
            isolate_sleep_until_ns(&block->answered, seen, time_ns);
    }
    atomic_store(&block->program_waits, 0);
    if (has_answered(block))
        return MRT_OK;
    return atomic_load(&block->is_dead) ? MRT_ERR_IO : MRT_TIMEOUT;
}

bool isolate_process_has_ended(const isolate_process *self, int timeout_ms)
{
    struct pollfd end = {.fd = self->pidfd, .events = POLLIN};
    return self->pidfd >= 0 && poll(&end, 1, timeout_ms) > 0;
}

mrt_result isolate_process_call(isolate_process *self, uint32_t kind, int64_t patience_ns)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    mrt_result result = MRT_TIMEOUT;
    isolate_process_send(self, kind);
    while (result == MRT_TIMEOUT && clock_now_ns() < until_ns) {
        result = isolate_process_wait_until_ns(self, clock_now_ns() + slice_ns);
        if (result == MRT_TIMEOUT && isolate_process_has_ended(self, 0))
            isolate_process_mark_dead(self);
    }
    return result == MRT_OK ? self->block->result : MRT_ERR_IO;
}

int64_t isolate_process_cpu_ns(const isolate_process *self)
{
    struct timespec used;
    if (self->cpu == CLOCK_REALTIME || clock_gettime(self->cpu, &used) != 0)
        return 0;
    return (int64_t)used.tv_sec * NS_PER_S + used.tv_nsec;
}

void isolate_process_drain(isolate_process *self, const mrt_host *to)
{
    if (!self->block)
        return;
    uint32_t count = atomic_load(&self->block->log_count);
    if (count - self->log_seen > ISOLATE_LOGS)
        self->log_seen = count - ISOLATE_LOGS;
    for (; self->log_seen != count; ++self->log_seen) {
        isolate_log line = self->block->log[self->log_seen % ISOLATE_LOGS];
        line.text[sizeof line.text - 1] = '\0';
        if (line.level >= MRT_LOG_DEBUG && line.level <= MRT_LOG_ERROR)
            to->log(to, line.level, line.text);
    }
}

bool isolate_process_last_error(const isolate_process *self, error *out)
{
    uint32_t count = atomic_load(&self->block->log_count);
    uint32_t kept = count < ISOLATE_LOGS ? count : ISOLATE_LOGS;
    for (uint32_t back = 1; back <= kept; ++back) {
        isolate_log line = self->block->log[(count - back) % ISOLATE_LOGS];
        line.text[sizeof line.text - 1] = '\0';
        if (line.level != MRT_LOG_ERROR)
            continue;
        (void)error_set(out, MRT_ERR_IO, "%s", line.text);
        return true;
    }
    return false;
}
