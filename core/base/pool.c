#include "base/pool.h"

#include "base/clock.h"
#include "base/cpu.h"
#include "base/os.h"

#include <fenv.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { SPIN_NS = 60000, SPINS_PER_LOOK = 32, SPINS_BEFORE_YIELD = 256, USUAL_MAX = 4 };

/* The gate describes the current work: its number (upper half), whether workers may still enter,
 * and how many are inside. Workers read `work` and `environment` only inside. */
#define GATE_OPEN   (UINT64_C(1) << 31)
#define GATE_ENDING (UINT64_C(1) << 30)
#define GATE_INSIDE (GATE_ENDING - 1)
#define GATE_NUMBER 32

/* The only global state besides constants: the process has one pool. */
static struct {
    pthread_once_t once;
    pthread_mutex_t holding; /* guards holder_count, and starting and ending */
    uint32_t holder_count;

    _Atomic double worth_ns;
    _Atomic bool is_taken; /* set while work is shared, or workers start or end */
    uint32_t worker_count; /* used by that thread, like all members up to `next` */
    pthread_t worker[POOL_THREADS_MAX - 1];
    int caller_cpu; /* workers do not run on this CPU */
    const pool_work *work;
    fenv_t environment;

    _Atomic uint32_t next; /* next part to run */
    _Atomic uint64_t gate;
    _Atomic uint64_t shared_count;

    _Atomic uint32_t asleep_count, wake_count; /* workers sleep while wake_count is unchanged */
} pool = {.once = PTHREAD_ONCE_INIT,
          .worth_ns = POOL_WORTH_NS,
          .holding = PTHREAD_MUTEX_INITIALIZER,
          .caller_cpu = CPU_UNKNOWN};

/* ---- number of threads ---- */

static uint32_t usual_count(void)
{
    uint32_t cpus = cpu_count();
    return cpus < USUAL_MAX ? cpus : USUAL_MAX;
}

mrt_result pool_choose(uint32_t *out, const char *word, error *err)
{
    *out = usual_count();
    if (!word || word[0] == '\0')
        return MRT_OK;
    size_t digits = strspn(word, "0123456789");
    unsigned long count = digits > 0 && digits <= 2 ? strtoul(word, NULL, 10) : 0;
    if (word[digits] != '\0' || count < 1 || count > POOL_THREADS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "MAROTTE_THREADS=%.40s: expected a number of threads from 1 to %d, or "
                         "nothing for the usual number (%u here)",
                         word, (int)POOL_THREADS_MAX, *out);
    *out = (uint32_t)count;
    return MRT_OK;
}

uint32_t pool_threads(void)
{
    uint32_t count;
    return pool_choose(&count, getenv("MAROTTE_THREADS"), NULL) < 0 ? usual_count() : count;
}

mrt_result pool_check(error *err)
{
    uint32_t count;
    return pool_choose(&count, getenv("MAROTTE_THREADS"), err);
}

/* ---- workers ---- */

static uint64_t number_of(uint64_t gate)
{
    return gate >> GATE_NUMBER;
}

static void pause_briefly(void)
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/* Runs parts until none are left, `grain` at a time. */
static void run_parts(const pool_work *work)
{
    for (;;) {
        uint32_t first = atomic_load_explicit(&pool.next, memory_order_relaxed);
        uint32_t left, taken;
        do {
            left = work->part_count - first;
            taken = left < work->grain ? left : work->grain;
        } while (taken > 0 && !atomic_compare_exchange_weak_explicit(
                                  &pool.next, &first, first + taken, memory_order_relaxed,
                                  memory_order_relaxed));
        if (taken == 0)
            return;
        work->run(work->data, first, first + taken);
    }
}

/* Returns false if the work that `gate` describes is over. */
static bool enter(uint64_t gate)
{
    uint64_t number = number_of(gate);
    while ((gate & GATE_OPEN) && number_of(gate) == number)
        if (atomic_compare_exchange_weak(&pool.gate, &gate, gate + 1))
            return true;
    return false;
}

static void leave(void)
{
    atomic_fetch_sub(&pool.gate, 1);
}

/* Sequentially consistent on both sides: either this thread sees the next gate, or wake_workers
 * sees that it sleeps. */
static void sleep_while(uint64_t number)
{
    atomic_fetch_add(&pool.asleep_count, 1);
    uint32_t count = atomic_load(&pool.wake_count);
    while (number_of(atomic_load(&pool.gate)) == number) {
        os_wait_word(&pool.wake_count, count, INT64_MAX);
        count = atomic_load(&pool.wake_count);
    }
    atomic_fetch_sub(&pool.asleep_count, 1);
}

/* Waits for a gate with a later number than `number`, and returns it. */
static uint64_t wait_after(uint64_t number)
{
    int64_t end_ns = clock_now_ns() + SPIN_NS;
    uint64_t gate = atomic_load(&pool.gate);
    while (number_of(gate) == number) {
        for (int i = 0; i < SPINS_PER_LOOK && number_of(gate) == number; ++i) {
            pause_briefly();
            gate = atomic_load_explicit(&pool.gate, memory_order_acquire);
        }
        if (number_of(gate) == number && clock_now_ns() > end_ns) {
            sleep_while(number);
            gate = atomic_load(&pool.gate);
        }
    }
    return gate;
}

static void *serve(void *unused)
{
    (void)unused;
    uint64_t gate = atomic_load(&pool.gate);
    while (!(gate & GATE_ENDING)) {
        if (enter(gate)) {
            (void)fesetenv(&pool.environment);
            run_parts(pool.work);
            leave();
        }
        gate = wait_after(number_of(gate));
    }
    return NULL;
}

/* Does not lock or wait, because the frame thread calls it. */
static void wake_workers(void)
{
    if (atomic_load(&pool.asleep_count) == 0)
        return;
    int cpu = cpu_now();
    if (cpu != pool.caller_cpu)
        cpu_keep_off(pool.worker, pool.worker_count, cpu);
    pool.caller_cpu = cpu;
    atomic_fetch_add(&pool.wake_count, 1);
    os_wake_word(&pool.wake_count);
}

/* ---- starting and ending ---- */

static bool try_claim(void)
{
    return !atomic_exchange_explicit(&pool.is_taken, true, memory_order_acquire);
}

static void release(void)
{
    atomic_store_explicit(&pool.is_taken, false, memory_order_release);
}

static void claim(void)
{
    while (!try_claim())
        sched_yield();
}

static void before_fork(void)
{
    pthread_mutex_lock(&pool.holding);
}

static void after_fork(void)
{
    pthread_mutex_unlock(&pool.holding);
}

/* The child process has no workers, and no thread that shares work. */
static void in_child(void)
{
    pool.holding = (pthread_mutex_t)PTHREAD_MUTEX_INITIALIZER;
    pool.worker_count = 0;
    atomic_store(&pool.asleep_count, 0);
    atomic_store(&pool.gate, number_of(atomic_load(&pool.gate)) << GATE_NUMBER);
    atomic_store(&pool.is_taken, false);
}

static void watch_forks(void)
{
    os_on_fork(before_fork, after_fork, in_child);
}

/* Starts as many as possible. */
static void start_workers(uint32_t wanted)
{
    while (pool.worker_count < wanted &&
           os_start_thread(&pool.worker[pool.worker_count], serve, NULL) == 0)
        ++pool.worker_count;
    pool.caller_cpu = CPU_UNKNOWN;
}

static void end_workers(void)
{
    uint64_t number = number_of(atomic_load(&pool.gate)) + 1;
    atomic_store(&pool.gate, number << GATE_NUMBER | GATE_ENDING);
    wake_workers();
    for (uint32_t i = 0; i < pool.worker_count; ++i)
        pthread_join(pool.worker[i], NULL);
    pool.worker_count = 0;
    atomic_store(&pool.gate, number << GATE_NUMBER);
}

void pool_hold(void)
{
    pthread_once(&pool.once, watch_forks);
    pthread_mutex_lock(&pool.holding);
    if (pool.holder_count++ == 0) {
        claim();
        start_workers(pool_threads() - 1);
        release();
    }
    pthread_mutex_unlock(&pool.holding);
}

void pool_release(void)
{
    pthread_mutex_lock(&pool.holding);
    if (--pool.holder_count == 0) {
        claim();
        end_workers();
        release();
    }
    pthread_mutex_unlock(&pool.holding);
}

/* ---- work ---- */

/* Lets no more workers enter, and waits until all have left. */
static void close_gate(void)
{
    uint64_t gate = atomic_fetch_and(&pool.gate, ~GATE_OPEN);
    for (uint32_t spins = 1; gate & GATE_INSIDE; ++spins) {
        if (spins % SPINS_BEFORE_YIELD == 0)
            sched_yield();
        else
            pause_briefly();
        gate = atomic_load(&pool.gate);
    }
}

static void share(const pool_work *work)
{
    uint64_t number = number_of(atomic_load(&pool.gate)) + 1;
    pool.work = work;
    (void)fegetenv(&pool.environment);
    atomic_store_explicit(&pool.next, 0, memory_order_relaxed);
    atomic_store(&pool.gate, number << GATE_NUMBER | GATE_OPEN);
    wake_workers();
    run_parts(work);
    close_gate();
    atomic_fetch_add_explicit(&pool.shared_count, 1, memory_order_relaxed);
}

void pool_share_from(double cost_ns)
{
    atomic_store_explicit(&pool.worth_ns, cost_ns, memory_order_relaxed);
}

static bool is_worth_it(const pool_work *work)
{
    return work->part_count > work->grain &&
           work->cost_ns >= atomic_load_explicit(&pool.worth_ns, memory_order_relaxed);
}

void pool_run(const pool_work *work)
{
    if (!is_worth_it(work) || !try_claim()) {
        if (work->part_count > 0)
            work->run(work->data, 0, work->part_count);
        return;
    }
    if (pool.worker_count > 0)
        share(work);
    else
        work->run(work->data, 0, work->part_count);
    release();
}

pool_state pool_state_now(void)
{
    pthread_mutex_lock(&pool.holding);
    claim();
    pool_state now = {.worker_count = pool.worker_count,
                      .asleep_count = atomic_load(&pool.asleep_count),
                      .shared_count = atomic_load(&pool.shared_count)};
    release();
    pthread_mutex_unlock(&pool.holding);
    return now;
}
