/* base/program.h - programs that marotte starts: finding them, pipes, start and end, and quoting
 * for a shell. [main], or any thread that may block. */
#ifndef MAROTTE_BASE_PROGRAM_H
#define MAROTTE_BASE_PROGRAM_H
#include "base/error.h"

#include <limits.h>
#include <sys/resource.h>
#include <sys/types.h>

/* Built with an address or thread sanitizer, which has its own heap. */
#ifndef __has_feature
#define __has_feature(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) ||                               \
    __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PROGRAM_IS_SANITIZED 1
#else
#define PROGRAM_IS_SANITIZED 0
#endif

/* Finds the program `name`: in the environment variable `variable`, else beside the running
 * program. If the running program is somewhere in a build folder of CMake, also at the top of that
 * folder. purpose: text for the error, "it examines plugins". */
CHECKED mrt_result program_find(char out[PATH_MAX], const char *name, const char *variable,
                                const char *purpose, error *err);

/* Finds the program `name` in $PATH. A name with a '/' is itself the path. */
bool program_on_path(char out[PATH_MAX], const char *name);

/* Creates a pipe. A program that another thread starts at the same time inherits neither end. */
CHECKED mrt_result program_pipe(int out_end[2], error *err);

/* Limits this process with setrlimit. Does not limit memory (RLIMIT_AS, RLIMIT_DATA) under a
 * sanitizer, which reserves terabytes of addresses. */
void program_limit(int resource, rlim_t soft, rlim_t hard);

/* Converts a word to an argument of posix_spawn, which does not write to it although its
 * declaration allows that. */
char *program_argument(const char *word);

/* How a program is started: its standard input, output and error (-1: /dev/null), and whether it
 * receives Ctrl-C and inherits ignored or blocked signals. */
typedef enum program_signals {
    PROGRAM_SHARES_SIGNALS = 0,
    PROGRAM_OWN_GROUP,    /* Ctrl-C in the terminal does not reach it */
    PROGRAM_USUAL_SIGNALS /* the same, with default signals as if a shell had started it */
} program_signals;
typedef struct program_start {
    const char *program; /* without a '/', searched in $PATH */
    char *const *words;  /* arguments of posix_spawn, the program first, NULL at the end */
    int in, out, err;
    int passed, passed_as; /* one more descriptor, and its number in the child; 0: none */
    program_signals signals;
    char *const *environment; /* NULL: environment of this process */
} program_start;
/* Returns 0, or an errno value. */
CHECKED int program_spawn(pid_t *out, const program_start *how);

/* Waits for the end of the child, at most for patience_ns. Returns true if it has ended, with
 * out_status; false if it still runs. */
bool program_ends_within(pid_t pid, int *out_status, int64_t patience_ns);

/* Waits for the end of the child, at most for patience_ns, then kills it. Returns false if it did
 * not end by itself in time. out_status is 0 if even killing did not end it soon, for example
 * because of a hanging disk: the caller never waits forever. */
bool program_wait(pid_t pid, int *out_status, int64_t patience_ns);

/* Quotes a word for a shell: plain, 'quoted', or $'with escapes' if it is not printable. Writes ""
 * if it does not fit. */
void program_quote(char *out, size_t capacity, const char *word);

#endif
