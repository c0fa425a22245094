#define _GNU_SOURCE /* syscall, ppoll */
#include "virtual_clock.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#define HERE __attribute__((visibility("default")))

static const int64_t ns_per_s = 1000000000, ns_per_ms = 1000000;
/* What a write takes: who asks again whenever he has an answer gets on, however quick the answer.
 */
static const int64_t write_ns = 100000;

/* Whose clock this thread lives by; no device: the system's. */
static _Thread_local struct {
    const virtual_device *device;
    bool is_within; /* one of the device's functions */
    int64_t now_ns;
    uint64_t wait_count;
    int64_t late_most_ns;
    uint32_t random;
} virtual;

static bool waits_virtually(void)
{
    return virtual.device && !virtual.is_within;
}

/* Goes on to what the device does next, at most to until_ns. */
static void go_on(int64_t until_ns)
{
    int64_t due_ns = virtual.device->due_ns(virtual.device->data);
    int64_t next_ns = due_ns < until_ns ? due_ns : until_ns;
    if (next_ns > virtual.now_ns)
        virtual.now_ns = next_ns;
    if (due_ns > virtual.now_ns)
        return;
    virtual.is_within = true;
    virtual.device->run(virtual.device->data, virtual.now_ns);
    virtual.is_within = false;
}

static void pass_until(int64_t until_ns)
{
    while (virtual.now_ns < until_ns)
        go_on(until_ns);
}

/* What a wait that is over takes still. */
static void be_late(void)
{
    if (virtual.late_most_ns == 0)
        return;
    virtual.random = virtual.random * 1664525u + 1013904223u;
    pass_until(virtual.now_ns + virtual.late_most_ns / 65536 * (virtual.random >> 16));
}

static void wait_until(int64_t until_ns)
{
    virtual.wait_count += 1;
    pass_until(until_ns);
    be_late();
}

static int64_t never_due(void *data)
{
    (void)data;
    return INT64_MAX;
}

static void run_nothing(void *data, int64_t now_ns)
{
    (void)data;
    (void)now_ns;
}

static void hear_nothing(void *data, int64_t now_ns, int file, size_t size)
{
    (void)data;
    (void)now_ns;
    (void)file;
    (void)size;
}

static const virtual_device nothing = {never_due, run_nothing, hear_nothing, NULL};

static int64_t ns_of(const struct timespec *time)
{
    return (int64_t)time->tv_sec * ns_per_s + time->tv_nsec;
}

HERE void virtual_clock_take(const virtual_device *device, int64_t start_ns)
{
    virtual.device = device ? device : &nothing;
    virtual.is_within = false;
    virtual.now_ns = start_ns;
    virtual.wait_count = 0;
    virtual.late_most_ns = 0;
    virtual.random = 1;
}

HERE void virtual_clock_give_back(void)
{
    virtual.device = NULL;
}

HERE void virtual_clock_be_late(int64_t most_ns)
{
    virtual.late_most_ns = most_ns;
}

HERE uint64_t virtual_clock_wait_count(void)
{
    return virtual.wait_count;
}

/* ---- in place of the system's ---- */

HERE int clock_gettime(clockid_t clock, struct timespec *out)
{
    if (!virtual.device || clock != CLOCK_MONOTONIC)
        return (int)syscall(SYS_clock_gettime, clock, out);
    *out =
        (struct timespec){(time_t)(virtual.now_ns / ns_per_s), (long)(virtual.now_ns % ns_per_s)};
    return 0;
}

HERE int clock_nanosleep(clockid_t clock, int flags, const struct timespec *time,
                         struct timespec *out_left)
{
    if (!waits_virtually() || clock != CLOCK_MONOTONIC)
        return syscall(SYS_clock_nanosleep, clock, flags, time, out_left) == 0 ? 0 : errno;
    wait_until(flags & TIMER_ABSTIME ? ns_of(time) : virtual.now_ns + ns_of(time));
    return 0;
}

HERE int nanosleep(const struct timespec *time, struct timespec *out_left)
{
    if (!waits_virtually())
        return (int)syscall(SYS_nanosleep, time, out_left);
    wait_until(virtual.now_ns + ns_of(time));
    return 0;
}

/* By the system's clock. NULL: without an end. */
static int look(struct pollfd *files, nfds_t count, const struct timespec *timeout,
                const sigset_t *mask)
{
    struct timespec left = timeout ? *timeout : (struct timespec){0, 0};
    enum { MASK_BYTES = 8 };
    return (int)syscall(SYS_ppoll, files, count, timeout ? &left : NULL, mask, MASK_BYTES);
}

HERE int ppoll(struct pollfd *files, nfds_t count, const struct timespec *timeout,
               const sigset_t *mask)
{
    const struct timespec none = {0, 0};
    if (!waits_virtually())
        return look(files, count, timeout, mask);
    const int64_t until_ns = timeout ? virtual.now_ns + ns_of(timeout) : INT64_MAX;
    virtual.wait_count += 1;
    int ready = look(files, count, &none, mask);
    if (ready != 0 || virtual.now_ns >= until_ns)
        return ready;
    while (ready == 0 && virtual.now_ns < until_ns) {
        go_on(until_ns);
        ready = look(files, count, &none, mask);
    }
    be_late();
    return look(files, count, &none, mask);
}

HERE int poll(struct pollfd *files, nfds_t count, int timeout_ms)
{
    const struct timespec timeout = {timeout_ms / 1000, timeout_ms % 1000 * ns_per_ms};
    return ppoll(files, count, timeout_ms < 0 ? NULL : &timeout, NULL);
}

HERE ssize_t write(int file, const void *bytes, size_t size)
{
    ssize_t written = syscall(SYS_write, file, bytes, size);
    if (written > 0 && waits_virtually()) {
        virtual.is_within = true;
        virtual.device->written(virtual.device->data, virtual.now_ns, file, (size_t)written);
        virtual.is_within = false;
        pass_until(virtual.now_ns + write_ns);
    }
    return written;
}
