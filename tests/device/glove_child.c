#include "glove_child.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { OPTIONS_MAX = 64, READY_MS = 60000, EXIT_NO_TERMINAL = 77 };

mrt_result glove_child_prepare(glove_child *out, error *err)
{
    *out = (glove_child){0};
    snprintf(out->folder, sizeof out->folder, "/tmp/marotte-glove-XXXXXX");
    if (!mkdtemp(out->folder)) {
        out->folder[0] = 0;
        return error_set(err, MRT_ERR_IO, "no folder in /tmp: %s", strerror(errno));
    }
    snprintf(out->link, sizeof out->link, "%s/glove", out->folder);
    snprintf(out->truth, sizeof out->truth, "%s/truth.csv", out->folder);
    snprintf(out->address, sizeof out->address, "serial:%s", out->link);
    return MRT_OK;
}

/* No other child may hold the pipe's end: this one would not see it close. */
static mrt_result make_pipe(int *out_ends, error *err)
{
    if (pipe(out_ends) != 0)
        return error_set(err, MRT_ERR_IO, "no pipe: %s", strerror(errno));
    for (int i = 0; i < 2; ++i)
        (void)fcntl(out_ends[i], F_SETFD, FD_CLOEXEC);
    return MRT_OK;
}

static int spawn(glove_child *child, const char *program, char **arguments, const int *in,
                 const int *out)
{
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    int problem = posix_spawn(&child->pid, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return problem;
}

static mrt_result spawn_with_pipes(glove_child *child, const char *program, char **arguments,
                                   error *err)
{
    int in[2], out[2];
    mrt_result result = make_pipe(in, err);
    if (result < 0)
        return result;
    result = make_pipe(out, err);
    if (result < 0) {
        close(in[0]);
        close(in[1]);
        return result;
    }
    int problem = spawn(child, program, arguments, in, out);
    close(in[0]);
    close(out[1]);
    child->to = in[1];
    child->from = out[0];
    if (problem == 0)
        return MRT_OK;
    child->pid = 0;
    close(child->to);
    close(child->from);
    return error_set(err, MRT_ERR_IO, "%s: %s", program, strerror(problem));
}

mrt_result glove_child_wait_ready(glove_child *child, error *err)
{
    char byte = 0;
    while (byte != '\n') {
        struct pollfd file = {.fd = child->from, .events = POLLIN};
        int ready = poll(&file, 1, READY_MS);
        if (ready < 0 && errno == EINTR)
            continue;
        if (ready <= 0 || read(child->from, &byte, 1) != 1)
            return error_set(err, MRT_ERR_IO, "the emulator does not say that it is ready");
    }
    return MRT_OK;
}

mrt_result glove_child_start(glove_child *out, const char *program, const char *const *options,
                             error *err)
{
    mrt_result result = glove_child_prepare(out, err);
    if (result < 0)
        return result;
    const char *fixed[] = {program, "--control", "--link", out->link, "--truth", out->truth};
    char *arguments[OPTIONS_MAX] = {NULL};
    size_t count = 0;
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; ++i)
        arguments[count++] = strdup(fixed[i]);
    for (; *options && count + 1 < OPTIONS_MAX; ++options)
        arguments[count++] = strdup(*options);
    result = spawn_with_pipes(out, program, arguments, err);
    while (count > 0)
        free(arguments[--count]);
    if (result >= 0)
        result = glove_child_wait_ready(out, err);
    if (result < 0 && out->pid > 0) {
        int status;
        close(out->to);
        close(out->from);
        if (waitpid(out->pid, &status, 0) > 0 && WIFEXITED(status) &&
            WEXITSTATUS(status) == EXIT_NO_TERMINAL)
            result = MRT_ERR_UNSUPPORTED;
        out->pid = 0;
    }
    if (result < 0)
        glove_child_finish(out);
    return result;
}

void glove_child_say(glove_child *child, const char *word)
{
    char line[64];
    int size = snprintf(line, sizeof line, "%s\n", word);
    if (write(child->to, line, (size_t)size) != size)
        perror("the emulator does not listen");
}

bool glove_child_stop(glove_child *child)
{
    if (child->pid == 0)
        return true;
    int status = -1;
    close(child->to);
    while (waitpid(child->pid, &status, 0) < 0 && errno == EINTR)
        continue;
    close(child->from);
    child->pid = 0;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void glove_child_finish(glove_child *child)
{
    (void)glove_child_stop(child);
    if (child->folder[0]) {
        (void)unlink(child->truth);
        (void)unlink(child->link);
        (void)rmdir(child->folder);
    }
    *child = (glove_child){0};
}
