/* base/pool.h - a few threads that take a share of a large piece of work, one pool in a process.
 * Work is cut into parts that depend on no other, so the number of threads changes no bit of a
 * result; sums across parts are not for here. The calling thread works too. Workers spin for a
 * moment after a piece, as another often follows, and then sleep; they are woken on another CPU
 * than the caller's. Work that is not worth it, a second caller while the pool is busy, a piece
 * within a piece, and a forked child: the caller works alone. Where threads cannot be had there are
 * fewer, or none. Workers compute in the caller's floating-point environment. [any] */
#ifndef MAROTTE_BASE_POOL_H
#define MAROTTE_BASE_POOL_H
#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

enum { POOL_THREADS_MAX = 16 };

/* ---- how many threads, the caller's included ---- */

/* word: as in MAROTTE_THREADS; NULL and "": one for each CPU that may be used, at most 4. */
CHECKED mrt_result pool_choose(uint32_t *out, const char *word, error *err);
/* What MAROTTE_THREADS asks for; as if it were unset where pool_check refuses it at start. */
uint32_t pool_threads(void);
CHECKED mrt_result pool_check(error *err);

/* ---- the workers ---- */

/* Whoever may have large work holds the pool, from load on: the first starts the workers, as many
 * as pool_threads says then; the last to release it ends them. Not from within a piece of work. */
void pool_hold(void);
void pool_release(void);

/* A piece of work: parts 0 .. part_count - 1. */
typedef struct pool_work {
    void (*run)(void *data, uint32_t first, uint32_t end); /* on several threads at once */
    void *data;
    uint32_t part_count, grain; /* at most `grain` parts are given at a time; >= 1 */
    double cost_ns;             /* estimated, of all of it on one thread */
} pool_work;

/* Less than this is not shared: waking a sleeping worker takes 25 to 60 us. */
#define POOL_WORTH_NS 150e3
/* Another limit, for measurements and tests; INFINITY: nothing is shared. */
void pool_share_from(double cost_ns);

/* Returns when all parts are done. Allocates nothing. */
void pool_run(const pool_work *work);

typedef struct pool_state {
    uint32_t worker_count, asleep_count;
    uint64_t shared_count; /* pieces that were offered to workers, since the process began */
} pool_state;
pool_state pool_state_now(void);

#endif
