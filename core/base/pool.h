/* base/pool.h - worker threads that share a large piece of work; one pool per process. The work is
 * cut into independent parts, so the number of threads does not change a bit of the result; sums
 * across parts do not belong here. The calling thread works too. After work the workers spin for a
 * moment, because more often follows, and then sleep. They are woken on another CPU than the
 * caller's.
 * The caller works alone if the work is too small, if the pool is busy, within other work, and in a
 * forked child. If threads cannot be created, there are fewer or none. Workers use the caller's
 * floating-point environment. [any] */
#ifndef MAROTTE_BASE_POOL_H
#define MAROTTE_BASE_POOL_H
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

enum { POOL_THREADS_MAX = 16 };

/* ---- number of threads, including the caller's ---- */

/* word: as in MAROTTE_THREADS; NULL and "": one for each available CPU, at most 4. */
CHECKED mrt_result pool_choose(uint32_t *out, const char *word, error *err);
/* Returns the number of MAROTTE_THREADS, or the default if it is invalid; pool_check reports that
 * at start. */
uint32_t pool_threads(void);
CHECKED mrt_result pool_check(error *err);

/* ---- the workers ---- */

/* Code with large work holds the pool from its loading on. The first holder starts pool_threads
 * workers, the last one to release ends them. Do not call them within a piece of work. */
void pool_hold(void);
void pool_release(void);

/* A piece of work with the parts 0 .. part_count - 1. */
typedef struct pool_work {
    void (*run)(void *data, uint32_t first, uint32_t end); /* on several threads in parallel */
    void *data;
    uint32_t part_count, grain; /* at most `grain` parts are passed at a time; >= 1 */
    double cost_ns;             /* estimate for the whole work on one thread */
} pool_work;

/* Minimum cost of shared work: waking a sleeping worker takes 25 to 60 us. */
#define POOL_WORTH_NS 150e3
/* Sets another minimum, for measurements and tests; INFINITY: never share. */
void pool_share_from(double cost_ns);

/* Runs the work, and returns when all parts are done. Does not allocate. */
void pool_run(const pool_work *work);

typedef struct pool_state {
    uint32_t worker_count, asleep_count;
    uint64_t shared_count; /* pieces of work that were offered to workers, since the start of the
                              process */
} pool_state;
pool_state pool_state_now(void);

#endif
