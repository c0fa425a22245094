/* base/program.h - programs that marotte starts beside itself: where they lie, pipes to them, their
 * start and end, and words of theirs as a shell reads them. [main], or any thread that may block.
 */
#ifndef MAROTTE_BASE_PROGRAM_H
#define MAROTTE_BASE_PROGRAM_H
#include "base/error.h"

#include <limits.h>
#include <sys/resource.h>
#include <sys/types.h>

/* Built with a sanitizer of addresses or threads, which has a heap of its own. */
#ifndef __has_feature
#define __has_feature(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) ||                               \
    __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PROGRAM_IS_SANITIZED 1
#else
#define PROGRAM_IS_SANITIZED 0
#endif

/* The program `name`: where the environment's `variable` says, else beside the running program,
 * else in build_dir, for a running program that lies there itself: one that is installed does not
 * look where it was built. purpose, for the error: "it examines plugins". */
CHECKED mrt_result program_find(char out[PATH_MAX], const char *name, const char *variable,
                                const char *build_dir, const char *purpose, error *err);

/* A pipe, of which a program that another thread starts at this moment inherits neither end. */
CHECKED mrt_result program_pipe(int out_end[2], error *err);

/* Of this process, from now on: setrlimit. Of memory (RLIMIT_AS, RLIMIT_DATA) nothing under a
 * sanitizer, which reserves terabytes of addresses. */
void program_limit(int resource, rlim_t soft, rlim_t hard);

/* The word as an argument of posix_spawn, which does not write to what it is given: it is only
 * declared so. */
char *program_argument(const char *word);

/* How a program is started: what becomes its standard input, output and error (-1: /dev/null), and
 * whether Ctrl-C and signals that are ignored or blocked here reach it. */
typedef enum program_signals {
    PROGRAM_SHARES_SIGNALS = 0,
    PROGRAM_OWN_GROUP,    /* Ctrl-C in the terminal is not for it */
    PROGRAM_USUAL_SIGNALS /* the same, and it has signals as if it were started from a shell */
} program_signals;
typedef struct program_start {
    const char *program; /* without a '/' one of $PATH */
    char *const *words;  /* as for posix_spawn, the program first, NULL at the end */
    int in, out, err;
    int passed, passed_as; /* one more descriptor, and its number there; 0: none */
    program_signals signals;
    char *const *environment; /* NULL: that of this process */
} program_start;
/* 0, or the number of the error. */
CHECKED int program_spawn(pid_t *out, const program_start *how);

/* Waits for the child's end for at most so long. True: it has ended, with out_status; false: it
 * still runs. */
bool program_ends_within(pid_t pid, int *out_status, int64_t patience_ns);

/* Waits for the child's end for at most so long; then it is killed. False: it has not ended of its
 * own will in time, and out_status is 0 if not even then (a disk that hangs holds it): nobody waits
 * for ever. */
bool program_wait(pid_t pid, int *out_status, int64_t patience_ns);

/* The word as a shell reads it back: plain, 'quoted', or $'with escapes' where it is not printable.
 * What does not fit becomes "". */
void program_quote(char *out, size_t capacity, const char *word);

#endif
