#include "base/program.h"
#include "base/clock.h"
#include "base/installed.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- finding a program ---- */

static bool is_program(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && S_ISREG(status.st_mode) && access(path, X_OK) == 0;
}

bool program_on_path(char out[PATH_MAX], const char *name)
{
    const char *at = getenv("PATH");
    if (strchr(name, '/'))
        return snprintf(out, PATH_MAX, "%s", name) < PATH_MAX && is_program(out);
    while (at && *at) {
        const int length = (int)strcspn(at, ":");
        const int written =
            snprintf(out, PATH_MAX, "%.*s%s%s", length, at, length ? "/" : "", name);
        if (written > 0 && written < PATH_MAX && is_program(out))
            return true;
        at += length;
        at += *at == ':';
    }
    return false;
}

/* Looks beside the running program, and at the top of the build folder that contains it. */
static bool is_near(char out[PATH_MAX], const char *name)
{
    static const char build[] = "CMakeCache.txt"; /* at the top of a build folder */
    char program[PATH_MAX];
    char *slash = installed_program(program) ? strrchr(program, '/') : NULL;
    for (bool is_beside = true; slash; is_beside = false) {
        *slash = '\0';
        const int length = snprintf(out, PATH_MAX, "%s/%s", program, build);
        const bool is_searched = is_beside || (length < PATH_MAX && access(out, F_OK) == 0);
        if (is_searched && snprintf(out, PATH_MAX, "%s/%s", program, name) < PATH_MAX &&
            is_program(out))
            return true;
        slash = strrchr(program, '/');
    }
    return false;
}

mrt_result program_find(char out[PATH_MAX], const char *name, const char *variable,
                        const char *purpose, error *err)
{
    const char *chosen = getenv(variable);
    if (chosen && *chosen) {
        const char *here = strchr(chosen, '/') ? "" : "./"; /* else a shell searches $PATH */
        int length = snprintf(out, PATH_MAX, "%s%s", here, chosen);
        if (length > 0 && length < PATH_MAX && is_program(out))
            return MRT_OK;
        return error_set(err, MRT_ERR_IO, "%s names \"%s\", which cannot be run", variable, chosen);
    }
    if (is_near(out, name))
        return MRT_OK;
    return error_set(err, MRT_ERR_IO,
                     "%s is not beside the program: %s. Install it there, or name it in %s", name,
                     purpose, variable);
}

/* ---- pipes and waiting ---- */

mrt_result program_pipe(int out_end[2], error *err)
{
    if (syscall(SYS_pipe2, out_end, O_CLOEXEC) == 0)
        return MRT_OK;
    return error_set(err, MRT_ERR_IO, "no pipe: %s", strerror(errno));
}

char *program_argument(const char *word)
{
    union {
        const char *word;
        char *argument;
    } cast = {.word = word};
    return cast.argument;
}

/* Waits until the process has ended, or until the time is over. */
static void sleep_beside(int pidfd, int64_t left_ns)
{
    static const int64_t step_ns = 5 * NS_PER_MS;
    struct pollfd end = {.fd = pidfd, .events = POLLIN};
    if (pidfd >= 0)
        (void)poll(&end, 1, (int)(left_ns / NS_PER_MS) + 1);
    else
        clock_sleep_until_ns(clock_now_ns() + (left_ns < step_ns ? left_ns : step_ns));
}

void program_limit(int resource, rlim_t soft, rlim_t hard)
{
    const struct rlimit both = {soft, hard};
    bool is_memory = resource == RLIMIT_AS || resource == RLIMIT_DATA;
    if (!PROGRAM_IS_SANITIZED || !is_memory)
        (void)setrlimit(resource, &both);
}

bool program_ends_within(pid_t pid, int *out_status, int64_t patience_ns)
{
    const int64_t until_ns = clock_now_ns() + patience_ns;
    const int pidfd = (int)syscall(SYS_pidfd_open, pid, 0u); /* not inherited */
    bool has_ended = false;
    *out_status = 0;
    for (int64_t left_ns = patience_ns; !has_ended; left_ns = until_ns - clock_now_ns()) {
        const pid_t ended = waitpid(pid, out_status, WNOHANG);
        has_ended = ended == pid || (ended < 0 && errno != EINTR);
        if (has_ended || left_ns <= 0)
            break;
        if (ended == 0)
            sleep_beside(pidfd, left_ns);
    }
    if (pidfd >= 0)
        close(pidfd);
    return has_ended;
}

bool program_wait(pid_t pid, int *out_status, int64_t patience_ns)
{
    const bool has_ended = program_ends_within(pid, out_status, patience_ns);
    if (!has_ended && kill(pid, SIGKILL) == 0)
        (void)program_ends_within(pid, out_status, NS_PER_S);
    return has_ended;
}

/* ---- quoting for a shell ---- */

typedef struct words {
    char *out;
    size_t used, capacity; /* used may exceed capacity */
} words;

static void append(words *to, const char *text)
{
    for (; *text; ++text, ++to->used)
        if (to->used + 1 < to->capacity)
            to->out[to->used] = *text;
}

static void append_letter(words *to, unsigned char letter, bool is_escaped)
{
    char text[8];
    if (is_escaped && (letter < 32 || letter >= 127))
        (void)snprintf(text, sizeof text, "\\%03o", letter);
    else if (is_escaped && (letter == '\'' || letter == '\\'))
        (void)snprintf(text, sizeof text, "\\%c", letter);
    else if (letter == '\'')
        (void)snprintf(text, sizeof text, "'\\''");
    else
        (void)snprintf(text, sizeof text, "%c", letter);
    append(to, text);
}

void program_quote(char *out, size_t capacity, const char *word)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "/._-+:,@%";
    words to = {.out = out, .capacity = capacity};
    const size_t length = strlen(word);
    const bool is_plain = length > 0 && strspn(word, plain) == length;
    const bool is_escaped = !text_is_printable(text_view_of(word, length));
    if (capacity == 0)
        return;
    append(&to, is_plain ? "" : is_escaped ? "$'" : "'");
    for (const char *c = word; *c; ++c)
        append_letter(&to, (unsigned char)*c, is_escaped);
    append(&to, is_plain ? "" : "'");
    out[to.used < capacity ? to.used : 0] = '\0';
}

/* ---- starting a program ---- */

extern char **environ;

static int set_streams(posix_spawn_file_actions_t *actions, const program_start *how)
{
    const int from[3] = {how->in, how->out, how->err};
    int failed = 0;
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO && !failed; ++fd)
        failed = from[fd] >= 0
                     ? posix_spawn_file_actions_adddup2(actions, from[fd], fd)
                     : posix_spawn_file_actions_addopen(
                           actions, fd, "/dev/null", fd == STDIN_FILENO ? O_RDONLY : O_WRONLY, 0);
    if (!failed && how->passed_as > 0)
        failed = posix_spawn_file_actions_adddup2(actions, how->passed, how->passed_as);
    return failed;
}

static int set_signals(posix_spawnattr_t *attributes, program_signals signals)
{
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    sigaddset(&usual, SIGINT);
    sigaddset(&usual, SIGTERM);
    if (signals == PROGRAM_SHARES_SIGNALS)
        return 0;
    int failed = posix_spawnattr_setpgroup(attributes, 0);
    if (failed || signals == PROGRAM_OWN_GROUP)
        return failed ? failed : posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETPGROUP);
    failed = posix_spawnattr_setsigmask(attributes, &none);
    if (!failed)
        failed = posix_spawnattr_setsigdefault(attributes, &usual);
    return failed ? failed
                  : posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGMASK |
                                                             POSIX_SPAWN_SETSIGDEF |
                                                             POSIX_SPAWN_SETPGROUP);
}

int program_spawn(pid_t *out, const program_start *how)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    int failed = posix_spawn_file_actions_init(&actions);
    if (failed)
        return failed;
    failed = posix_spawnattr_init(&attributes);
    if (!failed) {
        failed = set_streams(&actions, how);
        if (!failed)
            failed = set_signals(&attributes, how->signals);
        if (!failed)
            failed = posix_spawnp(out, how->program, &actions, &attributes, how->words,
                                  how->environment ? how->environment : environ);
        (void)posix_spawnattr_destroy(&attributes);
    }
    (void)posix_spawn_file_actions_destroy(&actions);
    return failed;
}
