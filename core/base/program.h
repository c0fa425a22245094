/* base/program.h - programs that marotte starts beside itself: where they lie, pipes to them, their
 * end, and words of theirs as a shell reads them. Leaves out starting them. [main], or any thread
 * that may block. */
#ifndef MAROTTE_BASE_PROGRAM_H
#define MAROTTE_BASE_PROGRAM_H
#include "base/error.h"

#include <limits.h>
#include <sys/types.h>

/* The program `name`: where the environment's `variable` says, else beside the running program,
 * else in build_dir, for a running program that lies there itself: one that is installed does not
 * look where it was built. purpose, for the error: "it examines plugins". */
CHECKED mrt_result program_find(char out[PATH_MAX], const char *name, const char *variable,
                                const char *build_dir, const char *purpose, error *err);

/* A pipe, of which a program that another thread starts at this moment inherits neither end. */
CHECKED mrt_result program_pipe(int out_end[2], error *err);

/* The word as an argument of posix_spawn, which does not write to what it is given: it is only
 * declared so. */
char *program_argument(const char *word);

/* Waits for the child's end for at most so long; then it is killed. False: it has not ended of its
 * own will in time, and out_status is 0 if not even then (a disk that hangs holds it): nobody waits
 * for ever. */
bool program_wait(pid_t pid, int *out_status, int64_t patience_ns);

/* The word as a shell reads it back: plain, 'quoted', or $'with escapes' where it is not printable.
 * What does not fit becomes "". */
void program_quote(char *out, size_t capacity, const char *word);

#endif
