#include "check/process.h"
#include "base/clock.h"
#include "base/program.h"
#include "check/cases.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { PROCESSES_MAX = 64, PADDING_MAX = 8192, LISTEN_MS = 200 };

mrt_result check_program_find(char out[PATH_MAX], error *err)
{
    return program_find(out, "marotte-plugincheck", "MAROTTE_PLUGINCHECK", MAROTTE_BUILD_DIR,
                        "it examines plugins", err);
}

/* ---- starting ---- */

/* posix_spawn does not write to what it is given: it is only declared so. */
static char *argument(const char *word)
{
    union {
        const char *word;
        char *argument;
    } cast = {.word = word};
    return cast.argument;
}

/* The environment with a variable more that shifts what lies behind it; NULL: no memory. */
static char **padded_environment(uint32_t padding, char *variable)
{
    size_t count = 0;
    while (environ[count])
        count += 1;
    char **out = calloc(count + 2, sizeof *out);
    if (!out)
        return NULL;
    memcpy(out, environ, count * sizeof *out);
    (void)snprintf(variable, PADDING_MAX, "MAROTTE_PADDING=%0*d",
                   (int)(padding % (PADDING_MAX - 32)), 0);
    out[count] = variable;
    return out;
}

static int spawn(check_process *out, const check_words *words, int told_fd)
{
    char type[16], seed[24], variable[PADDING_MAX];
    posix_spawn_file_actions_t actions;
    (void)snprintf(type, sizeof type, "%" PRIu32, words->type);
    (void)snprintf(seed, sizeof seed, "%" PRIu64, words->seed & INT64_MAX);
    char *arguments[] = {argument(words->program),
                         argument(words->library),
                         argument(words->case_name),
                         type,
                         seed,
                         argument(words->input_address ? words->input_address : "-"),
                         argument(words->output_address ? words->output_address : "-"),
                         NULL};
    char **environment = padded_environment(words->padding, variable);
    if (!environment)
        return ENOMEM;
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed) {
        free(environment);
        return failed;
    }
    failed = posix_spawn_file_actions_adddup2(&actions, told_fd, WIRE_FD);
    for (int fd = 0; fd < 3 && !failed; ++fd)
        failed = posix_spawn_file_actions_addopen(&actions, fd, "/dev/null",
                                                  fd == 0 ? O_RDONLY : O_WRONLY, 0);
    if (!failed)
        failed = posix_spawn(&out->pid, words->program, &actions, NULL, arguments, environment);
    (void)posix_spawn_file_actions_destroy(&actions);
    free(environment);
    return failed;
}

mrt_result check_process_start(check_process *out, const check_words *words, error *err)
{
    int end[2];
    *out = (check_process){.fd = -1};
    mrt_result result = program_pipe(end, err);
    if (result < 0)
        return result;
    int failed = spawn(out, words, end[1]);
    close(end[1]);
    if (failed) {
        close(end[0]);
        out->pid = 0;
        return error_set(err, MRT_ERR_IO, "%s cannot be run: %s", words->program, strerror(failed));
    }
    out->fd = end[0];
    out->deadline_ns = clock_now_ns() + CASE_LIMIT_S * NS_PER_S;
    return MRT_OK;
}

/* ---- listening ---- */

static void take_line(check_process *self, char *line, check_on_line *on_line, void *data)
{
    char *name = line[0] && line[1] == ' ' ? line + 2 : NULL;
    char *blank = name ? strchr(name, ' ') : NULL;
    if (!blank)
        return;
    *blank = '\0';
    if (line[0] == WIRE_END)
        self->has_ended = true;
    else
        on_line(data, line[0], name, blank + 1);
}

static void take_lines(check_process *self, check_on_line *on_line, void *data)
{
    char *newline;
    self->line[self->used] = '\0';
    while ((newline = memchr(self->line, '\n', self->used))) {
        size_t length = (size_t)(newline - self->line) + 1;
        *newline = '\0';
        take_line(self, self->line, on_line, data);
        memmove(self->line, self->line + length, self->used - length);
        self->used -= length;
    }
    if (self->used == WIRE_LINE)
        self->used = 0; /* no line of ours */
}

static void reap(check_process *self)
{
    (void)program_wait(self->pid, &self->status, NS_PER_S);
    close(self->fd);
    self->fd = -1;
    self->pid = 0;
}

static void read_some(check_process *self, check_on_line *on_line, void *data)
{
    ssize_t got = read(self->fd, self->line + self->used, WIRE_LINE - self->used);
    if (got < 0 && (errno == EINTR || errno == EAGAIN))
        return;
    if (got <= 0) {
        (void)kill(self->pid, SIGKILL); /* it closed its end: nothing more is to be heard */
        reap(self);
        return;
    }
    self->used += (size_t)got;
    take_lines(self, on_line, data);
}

/* What a process started may hold the pipe open: its own end counts. */
static void end_late(check_process *self)
{
    if (self->pid == 0 || clock_now_ns() < self->deadline_ns)
        return;
    self->was_late = true;
    (void)kill(self->pid, SIGKILL);
    reap(self);
}

bool check_process_listen(check_process *running, uint32_t count, check_on_line *on_line,
                          void *const *data)
{
    struct pollfd waiting[PROCESSES_MAX];
    uint32_t of[PROCESSES_MAX];
    nfds_t waiting_count = 0;
    for (uint32_t i = 0; i < count && waiting_count < PROCESSES_MAX; ++i) {
        if (running[i].pid == 0)
            continue;
        of[waiting_count] = i;
        waiting[waiting_count++] = (struct pollfd){.fd = running[i].fd, .events = POLLIN};
    }
    if (waiting_count == 0)
        return false;
    int ready = poll(waiting, waiting_count, LISTEN_MS);
    for (nfds_t i = 0; i < waiting_count; ++i) {
        if (ready > 0 && waiting[i].revents)
            read_some(&running[of[i]], on_line, data[of[i]]);
        end_late(&running[of[i]]);
    }
    return true;
}

void check_process_finish(check_process *self)
{
    if (self->pid == 0)
        return;
    (void)kill(self->pid, SIGKILL);
    reap(self);
}
