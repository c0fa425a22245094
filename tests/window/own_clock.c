/* own_clock.c - a clock of a test's own, instead of the machine's: time passes only while everybody
 * waits, and then at once, to when the first of them wants to go on. So it does not matter how busy
 * the machine is, and waiting takes no time. Linked in front of base/clock.h, of what waits by it,
 * and of threads (marotte_own_clock in CMakeLists.txt), for tests whose devices and plugins run in
 * their own process. The engine's pool, whose threads only help, has the machine's time.
 *
 * Whoever is stopped by something else (a file, a pipe, a process) counts as busy: the clock waits
 * for it. While all of the process sleeps for such a reason, time goes on as the machine's does. */
#include "base/clock.h"
#include "stage/input/wake.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

typedef struct waiter {
    struct waiter *next;
    pthread_cond_t wakes; /* it alone */
    const void *on;       /* a wake, a condition, a thread; NULL: nothing but time */
    int64_t until_ns;     /* INT64_MAX: no time ends it */
    bool is_awake;
} waiter;

typedef struct thread {
    struct thread *next;
    pthread_t id;
    void *(*run)(void *data);
    void *data;
    bool has_ended;
} thread;

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static _Atomic int64_t now_ns;
static uint32_t busy_count = 1;
static uint64_t change_count; /* whoever waits, and whoever is woken, is one */
static waiter *waiting;
static thread *threads;
static _Thread_local bool is_of_pool, makes_pool;

/* The linker's --wrap puts these in front of the program's own.
 * NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming) */
int64_t __real_clock_now_ns(void);
void __real_wake_signal(wake *self);
int __real_pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex);
int __real_pthread_cond_signal(pthread_cond_t *condition);
int __real_pthread_create(pthread_t *out, const pthread_attr_t *how, void *(*run)(void *),
                          void *data);
int __real_pthread_join(pthread_t id, void **out);
void __real_pool_hold(void);

int64_t __wrap_clock_now_ns(void);
void __wrap_clock_sleep_until_ns(int64_t time_ns);
void __wrap_wake_signal(wake *self);
void __wrap_wake_wait_until_ns(wake *self, uint32_t seen, int64_t time_ns);
bool __wrap_condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns);
int __wrap_pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex);
int __wrap_pthread_cond_signal(pthread_cond_t *condition);
int __wrap_pthread_cond_broadcast(pthread_cond_t *condition);
int __wrap_pthread_create(pthread_t *out, const pthread_attr_t *how, void *(*run)(void *),
                          void *data);
int __wrap_pthread_join(pthread_t id, void **out);
void __wrap_pool_hold(void);

/* ---- who waits; all with the lock ---- */

static void wake_up(waiter **at)
{
    waiter *of = *at;
    *at = of->next;
    of->is_awake = true;
    change_count += 1;
    busy_count += 1; /* from now on, not only when it runs */
    (void)__real_pthread_cond_signal(&of->wakes);
}

static void wake_all(const void *on)
{
    for (waiter **at = &waiting; *at;)
        if ((*at)->on == on)
            wake_up(at);
        else
            at = &(*at)->next;
}

static void wake_one(const void *on)
{
    waiter **oldest = NULL; /* the last of the list */
    for (waiter **at = &waiting; *at; at = &(*at)->next)
        if ((*at)->on == on)
            oldest = at;
    if (oldest)
        wake_up(oldest);
}

/* When the first of those who wait goes on. */
static int64_t next_ns(void)
{
    int64_t first_ns = INT64_MAX;
    for (const waiter *w = waiting; w; w = w->next)
        first_ns = w->until_ns < first_ns ? w->until_ns : first_ns;
    return first_ns;
}

/* To then. */
static void pass(void)
{
    const int64_t first_ns = next_ns();
    if (first_ns == INT64_MAX)
        return;
    if (first_ns > now_ns)
        now_ns = first_ns;
    for (waiter **at = &waiting; *at;)
        if ((*at)->until_ns <= now_ns)
            wake_up(at);
        else
            at = &(*at)->next;
}

static void begin_waiting(waiter *of, const void *on, int64_t until_ns)
{
    *of = (waiter){.next = waiting, .on = on, .until_ns = until_ns};
    (void)pthread_cond_init(&of->wakes, NULL);
    waiting = of;
    change_count += 1;
    busy_count -= 1;
    if (busy_count == 0)
        pass();
}

static void wait_on(waiter *of)
{
    while (!of->is_awake)
        (void)__real_pthread_cond_wait(&of->wakes, &lock);
    (void)pthread_cond_destroy(&of->wakes);
}

static void wait_for(const void *on, int64_t until_ns)
{
    waiter self;
    begin_waiting(&self, on, until_ns);
    wait_on(&self);
}

/* ---- those who sleep for another reason ---- */

/* Or would if it could, or it waits for a disk. The line: "12 (name) S ...". */
static bool is_running(int tasks, const char *task)
{
    char path[32], text[512];
    (void)snprintf(path, sizeof path, "%s/stat", task);
    const int file = openat(tasks, path, O_RDONLY | O_CLOEXEC);
    const ssize_t size = file >= 0 ? read(file, text, sizeof text - 1) : 0;
    if (file >= 0)
        (void)close(file);
    text[size > 0 ? size : 0] = '\0';
    const char *name_end = strrchr(text, ')');
    return name_end && strchr("RD", name_end[2]);
}

/* Allocates nothing, which a test may count. */
static bool all_sleep(const char *but)
{
    enum { NAME_AT = 19 }; /* of what getdents64 writes: its length is before it, at 16 */
    char list[4096];
    bool out = true;
    const int tasks = open("/proc/self/task", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (long size; out && (size = syscall(SYS_getdents64, tasks, list, sizeof list)) > 0;)
        for (long at = 0; out && at < size;) {
            const char *name = list + at + NAME_AT;
            uint16_t length;
            memcpy(&length, list + at + 16, sizeof length);
            out = name[0] == '.' || strcmp(name, but) == 0 || !is_running(tasks, name);
            at += length;
        }
    if (tasks >= 0)
        (void)close(tasks);
    return out && tasks >= 0;
}

/* A thread that lets time pass while all sleep, no faster than it does. */
static void *watch(void *unused)
{
    (void)unused;
    static const struct timespec moment = {.tv_nsec = 2 * NS_PER_MS};
    char self[16];
    (void)snprintf(self, sizeof self, "%ld", syscall(SYS_gettid));
    uint64_t seen_count = 0;
    int64_t since_ns = __real_clock_now_ns();
    for (;;) {
        (void)nanosleep(&moment, NULL);
        const int64_t real_ns = __real_clock_now_ns();
        (void)pthread_mutex_lock(&lock);
        const bool has_stood = change_count == seen_count;
        const bool is_due = has_stood && next_ns() - now_ns <= real_ns - since_ns;
        seen_count = change_count;
        (void)pthread_mutex_unlock(&lock);
        if (!has_stood)
            since_ns = real_ns;
        if (!is_due)
            continue;
        const bool sleeps = all_sleep(self);
        (void)pthread_mutex_lock(&lock);
        if (sleeps && change_count == seen_count)
            pass();
        (void)pthread_mutex_unlock(&lock);
        since_ns = real_ns;
    }
    return NULL;
}

static void begin(void)
{
    pthread_t id;
    now_ns = __real_clock_now_ns();
    if (__real_pthread_create(&id, NULL, watch, NULL) != 0)
        abort();
    (void)pthread_detach(id);
}

/* ---- the clock ---- */

int64_t __wrap_clock_now_ns(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    (void)pthread_once(&once, begin);
    return is_of_pool ? __real_clock_now_ns() : now_ns;
}

void __wrap_clock_sleep_until_ns(int64_t time_ns)
{
    (void)pthread_mutex_lock(&lock);
    if (time_ns > __wrap_clock_now_ns())
        wait_for(NULL, time_ns);
    (void)pthread_mutex_unlock(&lock);
}

void __wrap_wake_signal(wake *self)
{
    __real_wake_signal(self);
    (void)pthread_mutex_lock(&lock);
    wake_all(self);
    (void)pthread_mutex_unlock(&lock);
}

void __wrap_wake_wait_until_ns(wake *self, uint32_t seen, int64_t time_ns)
{
    (void)pthread_mutex_lock(&lock);
    while (wake_seen(self) == seen && __wrap_clock_now_ns() < time_ns)
        wait_for(self, time_ns);
    (void)pthread_mutex_unlock(&lock);
}

/* ---- conditions ---- */

bool __wrap_condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns)
{
    waiter self;
    (void)pthread_mutex_lock(&lock);
    const bool waits = until_ns > __wrap_clock_now_ns();
    if (waits)
        begin_waiting(&self, condition, until_ns);
    (void)pthread_mutex_unlock(mutex);
    if (waits)
        wait_on(&self);
    const bool is_time = now_ns >= until_ns;
    (void)pthread_mutex_unlock(&lock);
    (void)pthread_mutex_lock(mutex);
    return !is_time;
}

int __wrap_pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex)
{
    (void)__wrap_condition_wait(condition, mutex, INT64_MAX);
    return 0;
}

int __wrap_pthread_cond_signal(pthread_cond_t *condition)
{
    (void)pthread_mutex_lock(&lock);
    wake_one(condition);
    (void)pthread_mutex_unlock(&lock);
    return 0;
}

int __wrap_pthread_cond_broadcast(pthread_cond_t *condition)
{
    (void)pthread_mutex_lock(&lock);
    wake_all(condition);
    (void)pthread_mutex_unlock(&lock);
    return 0;
}

/* ---- threads ---- */

static thread **thread_of(pthread_t id)
{
    for (thread **at = &threads; *at; at = &(*at)->next)
        if (pthread_equal((*at)->id, id))
            return at;
    return NULL;
}

static void *run_thread(void *data)
{
    thread *self = data;
    void *result = self->run(self->data);
    (void)pthread_mutex_lock(&lock);
    self->has_ended = true;
    wake_all(self);
    busy_count -= 1;
    if (busy_count == 0)
        pass();
    (void)pthread_mutex_unlock(&lock);
    return result;
}

static void *run_of_pool(void *data)
{
    thread *self = data;
    is_of_pool = true;
    return self->run(self->data);
}

int __wrap_pthread_create(pthread_t *out, const pthread_attr_t *how, void *(*run)(void *),
                          void *data)
{
    thread *made = calloc(1, sizeof *made);
    if (!made)
        abort();
    *made = (thread){.run = run, .data = data, .has_ended = makes_pool};
    (void)pthread_mutex_lock(&lock);
    const int failed = __real_pthread_create(out, how, makes_pool ? run_of_pool : run_thread, made);
    thread **old = failed ? NULL : thread_of(*out); /* of one that ended and was let go of */
    if (failed) {
        free(made);
    } else if (old) {
        thread *gone = *old;
        *old = gone->next;
        free(gone);
    }
    if (!failed) {
        made->id = *out;
        made->next = threads;
        threads = made;
        busy_count += !makes_pool;
    }
    (void)pthread_mutex_unlock(&lock);
    return failed;
}

int __wrap_pthread_join(pthread_t id, void **out)
{
    (void)pthread_mutex_lock(&lock);
    thread **at = thread_of(id);
    thread *of = at ? *at : NULL;
    while (of && !of->has_ended)
        wait_for(of, INT64_MAX);
    (void)pthread_mutex_unlock(&lock);
    const int failed = __real_pthread_join(id, out);
    (void)pthread_mutex_lock(&lock);
    at = failed ? NULL : thread_of(id);
    if (at) {
        *at = of->next;
        free(of);
    }
    (void)pthread_mutex_unlock(&lock);
    return failed;
}

void __wrap_pool_hold(void)
{
    makes_pool = true;
    __real_pool_hold();
    makes_pool = false;
}
/* NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming) */
