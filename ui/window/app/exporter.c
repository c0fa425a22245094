#include "window/app/exporter.h"

#include "base/clock.h"
#include "base/program.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    JOBS_MAX = 99,
    RUNNING_MAX = 2,
    LINE = 1024,
    NICENESS = 10 /* low priority, so that the performance comes first */
};

extern char **environ;

/* For an export to clear up after itself. */
static const int64_t goodbye_patience_ns = 5 * NS_PER_S;

enum { ARGUMENTS = 24 };
typedef struct call {
    char program[PATH_MAX], show[PATH_MAX], face[PATH_MAX];
    char take[24], fps[32], in[40], out[40];
    export_request request;
    const char *argument[ARGUMENTS]; /* point into this struct, which does not move */
} call;

typedef struct job {
    call *call;    /* NULL: free */
    pid_t pid;     /* 0: it waits */
    int stderr_fd; /* what it says on stderr */
    export_progress going;
    char line[LINE], last[LINE]; /* being read; the last that was no progress */
    size_t length;
} job;

struct exporter {
    job job[JOBS_MAX];
    uint32_t order[JOBS_MAX], count; /* those that go on, the oldest first */
};

exporter *exporter_create(void)
{
    return calloc(1, sizeof(exporter));
}

void exporter_destroy(exporter *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < JOBS_MAX; ++i) {
        int status;
        free(self->job[i].call);
        if (self->job[i].pid == 0)
            continue;
        (void)kill(self->job[i].pid, SIGTERM);
        (void)program_wait(self->job[i].pid, &status, goodbye_patience_ns);
        close(self->job[i].stderr_fd);
    }
    free(self);
}

uint32_t exporter_count(const exporter *self)
{
    return self->count;
}

export_progress exporter_at(const exporter *self, uint32_t index)
{
    assert(index < self->count);
    return self->job[self->order[index]].going;
}

void exporter_cancel(exporter *self, uint32_t index)
{
    assert(index < self->count);
    job *one = &self->job[self->order[index]];
    one->going.is_cancelled = one->pid == 0 || kill(one->pid, SIGTERM) == 0;
}

/* ---- the child ---- */

static void make_call(call *out, const char *show_path, int64_t take, const char *face_path,
                      const export_request *request)
{
    const char **at = out->argument;
    out->request = *request;
    (void)snprintf(out->show, sizeof out->show, "%s", show_path);
    (void)snprintf(out->face, sizeof out->face, "%s", face_path ? face_path : "");
    (void)snprintf(out->take, sizeof out->take, "%lld", (long long)take);
    (void)snprintf(out->fps, sizeof out->fps, "%.6g", request->fps);
    (void)snprintf(out->in, sizeof out->in, "%.9f", 1e-9 * (double)request->in_ns);
    (void)snprintf(out->out, sizeof out->out, "%.9f", 1e-9 * (double)request->out_ns);
    *at++ = out->program;
    *at++ = "take";
    *at++ = "export";
    *at++ = out->show;
    *at++ = out->take;
    *at++ = "--export";
    *at++ = out->request.file;
    if (face_path) {
        *at++ = "--face";
        *at++ = out->face;
    }
    if (request->fps > 0.0) {
        *at++ = "--fps";
        *at++ = out->fps;
    }
    if (request->in_ns < request->out_ns) {
        *at++ = "--in";
        *at++ = out->in;
        *at++ = "--out";
        *at++ = out->out;
    }
    const char *const look[][2] = {{"--size", out->request.size},
                                   {"--view", out->request.view},
                                   {"--background", out->request.background}};
    for (size_t i = 0; i < sizeof look / sizeof look[0]; ++i)
        if (look[i][1][0]) {
            *at++ = look[i][0];
            *at++ = look[i][1];
        }
    *at = NULL;
}

/* The environment with MAROTTE_PROGRESS=lines (terminal.c); NULL: no memory. free it. */
static char **environment_with_progress(void)
{
    static char wanted[] = "MAROTTE_PROGRESS=lines";
    size_t count = 0, kept = 0;
    while (environ[count])
        count += 1;
    char **out = malloc((count + 2) * sizeof *out);
    for (size_t i = 0; out && i < count; ++i)
        if (strncmp(environ[i], wanted, strcspn(wanted, "=") + 1) != 0)
            out[kept++] = environ[i];
    if (!out)
        return NULL;
    out[kept] = wanted;
    out[kept + 1] = NULL;
    return out;
}

static int spawn(pid_t *out_pid, const call *what, int stderr_fd)
{
    union { /* posix_spawn does not write to its arguments: they are only declared so */
        const char *const *texts;
        char *const *arguments;
    } cast = {.texts = what->argument};
    char **environment = environment_with_progress();
    const program_start how = {.program = what->program,
                               .words = cast.arguments,
                               .in = -1,
                               .out = -1,
                               .err = stderr_fd,
                               .environment = environment};
    const int failed = environment ? program_spawn(out_pid, &how) : ENOMEM;
    free(environment);
    if (!failed)
        (void)setpriority(PRIO_PROCESS, (id_t)*out_pid, NICENESS);
    return failed;
}

static mrt_result begin_job(job *self, error *err)
{
    int end[2];
    mrt_result result = program_pipe(end, err);
    if (result < 0)
        return result;
    (void)fcntl(end[0], F_SETFL, O_NONBLOCK);
    const int failed = spawn(&self->pid, self->call, end[1]);
    close(end[1]);
    self->stderr_fd = end[0];
    if (!failed) {
        self->going.is_waiting = false;
        return MRT_OK;
    }
    close(end[0]);
    self->pid = 0;
    return error_set(err, MRT_ERR_IO, "cannot run %s: %s", self->call->program, strerror(failed));
}

static uint32_t running(const exporter *self)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < self->count; ++i)
        count += self->job[self->order[i]].pid != 0;
    return count;
}

mrt_result exporter_begin(exporter *self, const char *show_path, int64_t take,
                          const char *face_path, const export_request *request, error *err)
{
    uint32_t at = 0;
    while (at < JOBS_MAX && self->job[at].call)
        at += 1;
    if (at == JOBS_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%d exports are running: wait until one has ended", JOBS_MAX);
    if (!request->file[0] || request->file[0] == '-')
        return error_set(err, MRT_ERR_ARGUMENT, "enter the name of a file: NAME.glb");
    job *one = &self->job[at];
    call *what = calloc(1, sizeof *what);
    if (!what)
        return error_set(err, MRT_ERR_MEMORY, "no memory for an export");
    *one = (job){.call = what, .going = {.done = -1.0, .is_waiting = true}};
    (void)snprintf(one->going.file, sizeof one->going.file, "%s", request->file);
    make_call(what, show_path, take, face_path, request);
    mrt_result result =
        program_find(what->program, "marotte", "MAROTTE", "it is exporting takes", err);
    if (result >= 0 && running(self) < RUNNING_MAX)
        result = begin_job(one, err);
    if (result >= 0) {
        self->order[self->count++] = at;
        return result;
    }
    free(what);
    one->call = NULL;
    return result;
}

/* ---- what it says ---- */

static void parse_line(job *self)
{
    export_progress *going = &self->going;
    double done;
    char doing[sizeof going->doing];
    self->line[self->length] = '\0';
    self->length = 0;
    if (sscanf(self->line, "progress %lf %31s", &done, doing) == 2) {
        going->done = done;
        memcpy(going->doing, doing, sizeof doing);
    } else if (self->line[0]) {
        memcpy(self->last, self->line, sizeof self->last);
    }
}

/* Reads the output of a job. The end of a line that is too long is dropped. */
static void listen(job *self)
{
    char piece[256];
    ssize_t got;
    while ((got = read(self->stderr_fd, piece, sizeof piece)) > 0)
        for (ssize_t i = 0; i < got; ++i)
            if (piece[i] == '\n')
                parse_line(self);
            else if (self->length < sizeof self->line - 1)
                self->line[self->length++] = piece[i];
}

/* The reason, without the name of the program in front of it. */
static const char *reason_of(const job *self)
{
    static const char speaker[] = "marotte take export: ";
    const size_t length = sizeof speaker - 1;
    return strncmp(self->last, speaker, length) == 0 ? self->last + length : self->last;
}

/* ---- its end ---- */

static mrt_result tell_end(const job *self, int status, char *out_text, size_t capacity)
{
    const char *file = self->going.file, *why = reason_of(self);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        (void)snprintf(out_text, capacity, "exported %s", file);
        return MRT_OK;
    }
    if (self->going.is_cancelled) {
        (void)snprintf(out_text, capacity, "the export of %s was cancelled", file);
        return MRT_OK;
    }
    if (why[0])
        (void)snprintf(out_text, capacity, "%s was not exported: %s", file, why);
    else
        (void)snprintf(out_text, capacity, "%s was not exported: the exporter %s", file,
                       WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "failed");
    return MRT_ERR_IO;
}

/* Polls a job, and starts a waiting one when there is a free place. If it cannot start, the reason
 * becomes its last line. */
static bool has_ended(job *self, bool has_room, int *out_status)
{
    error err = {0};
    *out_status = 1 << 8; /* as if it had ended so */
    if (self->pid != 0) {
        listen(self);
        if (waitpid(self->pid, out_status, WNOHANG) != self->pid)
            return false;
        listen(self);
        parse_line(self);
        close(self->stderr_fd);
        return true;
    }
    if (self->going.is_cancelled)
        return true;
    if (!has_room || begin_job(self, &err) >= 0)
        return false;
    (void)snprintf(self->last, sizeof self->last, "%s", err.text);
    return true;
}

bool exporter_ended(exporter *self, mrt_result *out_result, char *out_text, size_t capacity)
{
    for (uint32_t i = 0; i < self->count; ++i) {
        job *one = &self->job[self->order[i]];
        int status;
        if (!has_ended(one, running(self) < RUNNING_MAX, &status))
            continue;
        *out_result = tell_end(one, status, out_text, capacity);
        free(one->call);
        one->call = NULL;
        one->pid = 0;
        self->count -= 1;
        memmove(&self->order[i], &self->order[i + 1], (self->count - i) * sizeof *self->order);
        return true;
    }
    return false;
}
