#include "window/studio_export.h"

#include "base/program.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { JOBS_MAX = 4, SAID_MAX_BYTES = 1024 };

extern char **environ;

typedef struct job {
    pid_t pid; /* 0: free */
    int said;  /* what it says on stderr */
    char file[EXPORT_FILE], text[SAID_MAX_BYTES];
    size_t length;
} job;

struct studio_export {
    job job[JOBS_MAX];
};

studio_export *studio_export_create(void)
{
    return calloc(1, sizeof(studio_export));
}

static void wait_for(pid_t pid, int *out_status)
{
    pid_t ended;
    do
        ended = waitpid(pid, out_status, 0);
    while (ended < 0 && errno == EINTR);
}

void studio_export_destroy(studio_export *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < JOBS_MAX; ++i) {
        int status;
        if (self->job[i].pid == 0)
            continue;
        (void)kill(self->job[i].pid, SIGTERM);
        wait_for(self->job[i].pid, &status);
        close(self->job[i].said);
    }
    free(self);
}

uint32_t studio_export_count(const studio_export *self)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < JOBS_MAX; ++i)
        count += self->job[i].pid != 0;
    return count;
}

/* ---- the child ---- */

enum { ARGUMENTS = 18 };
typedef struct call {
    char program[PATH_MAX];
    char take[24], fps[32], in[40], out[40];
    const char *argument[ARGUMENTS];
} call;

static void make_call(call *out, const char *show_path, int64_t take, const char *face_path,
                      const export_wish *wish)
{
    const char **at = out->argument;
    (void)snprintf(out->take, sizeof out->take, "%lld", (long long)take);
    (void)snprintf(out->fps, sizeof out->fps, "%.6g", wish->fps);
    (void)snprintf(out->in, sizeof out->in, "%.9f", 1e-9 * (double)wish->in_ns);
    (void)snprintf(out->out, sizeof out->out, "%.9f", 1e-9 * (double)wish->out_ns);
    *at++ = out->program;
    *at++ = "take";
    *at++ = "export";
    *at++ = show_path;
    *at++ = out->take;
    *at++ = "--export";
    *at++ = wish->file;
    if (face_path) {
        *at++ = "--face";
        *at++ = face_path;
    }
    if (wish->fps > 0.0) {
        *at++ = "--fps";
        *at++ = out->fps;
    }
    if (wish->in_ns < wish->out_ns) {
        *at++ = "--in";
        *at++ = out->in;
        *at++ = "--out";
        *at++ = out->out;
    }
    *at = NULL;
}

static int spawn(pid_t *out_pid, const call *what, int said)
{
    posix_spawn_file_actions_t actions;
    union { /* posix_spawn does not write to its arguments: they are only declared so */
        const char *const *texts;
        char *const *arguments;
    } cast = {.texts = what->argument};
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawn_file_actions_adddup2(&actions, said, STDERR_FILENO);
    if (!failed)
        failed = posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (!failed)
        failed =
            posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    if (!failed)
        failed = posix_spawn(out_pid, what->program, &actions, NULL, cast.arguments, environ);
    (void)posix_spawn_file_actions_destroy(&actions);
    return failed;
}

static mrt_result begin_job(job *self, const call *what, error *err)
{
    int end[2];
    if (pipe(end) != 0)
        return error_set(err, MRT_ERR_IO, "nothing can be exported now: %s", strerror(errno));
    (void)fcntl(end[0], F_SETFD, FD_CLOEXEC);
    (void)fcntl(end[1], F_SETFD, FD_CLOEXEC);
    (void)fcntl(end[0], F_SETFL, O_NONBLOCK);
    const int failed = spawn(&self->pid, what, end[1]);
    close(end[1]);
    self->said = end[0];
    if (!failed)
        return MRT_OK;
    close(end[0]);
    self->pid = 0;
    return error_set(err, MRT_ERR_IO, "%s cannot be run: %s", what->program, strerror(failed));
}

mrt_result studio_export_begin(studio_export *self, const char *show_path, int64_t take,
                               const char *face_path, const export_wish *wish, error *err)
{
    job *free_job = NULL;
    call what;
    for (uint32_t i = 0; i < JOBS_MAX && !free_job; ++i)
        if (self->job[i].pid == 0)
            free_job = &self->job[i];
    if (!free_job)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%d exports are going on: wait until one has ended", JOBS_MAX);
    if (!wish->file[0] || wish->file[0] == '-')
        return error_set(err, MRT_ERR_ARGUMENT, "name the file that is to be written: NAME.glb");
    mrt_result result = program_find(what.program, "marotte", "MAROTTE", MAROTTE_BUILD_DIR,
                                     "it writes takes to files", err);
    if (result < 0)
        return result;
    make_call(&what, show_path, take, face_path, wish);
    *free_job = (job){.length = 0};
    (void)snprintf(free_job->file, sizeof free_job->file, "%s", wish->file);
    return begin_job(free_job, &what, err);
}

/* ---- its end ---- */

/* The last it said; what is older gives way. */
static void listen(job *self)
{
    char piece[256];
    ssize_t got;
    while ((got = read(self->said, piece, sizeof piece)) > 0) {
        const size_t size = (size_t)got, room = sizeof self->text - 1;
        const size_t over = self->length + size > room ? self->length + size - room : 0;
        memmove(self->text, self->text + over, self->length - over);
        memcpy(self->text + self->length - over, piece, size);
        self->length += size - over;
        self->text[self->length] = '\0';
    }
}

static const char *last_line(char *text)
{
    size_t length = strlen(text);
    while (length && (text[length - 1] == '\n' || text[length - 1] == '\r'))
        text[--length] = '\0';
    const char *line = strrchr(text, '\n');
    return line ? line + 1 : text;
}

bool studio_export_ended(studio_export *self, mrt_result *out_result, char *out_text,
                         size_t capacity)
{
    for (uint32_t i = 0; i < JOBS_MAX; ++i) {
        job *one = &self->job[i];
        int status = 0;
        if (one->pid == 0)
            continue;
        listen(one);
        if (waitpid(one->pid, &status, WNOHANG) != one->pid)
            continue;
        listen(one);
        close(one->said);
        one->pid = 0;
        const bool is_good = WIFEXITED(status) && WEXITSTATUS(status) == 0;
        const char *why = last_line(one->text);
        *out_result = is_good ? MRT_OK : MRT_ERR_IO;
        if (is_good)
            (void)snprintf(out_text, capacity, "exported %s", one->file);
        else if (why[0])
            (void)snprintf(out_text, capacity, "%s was not exported: %s", one->file, why);
        else
            (void)snprintf(out_text, capacity, "%s was not exported: the exporter %s", one->file,
                           WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "failed");
        return true;
    }
    return false;
}
