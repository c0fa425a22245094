#include "stage/input/wake.h"
#include "base/clock.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

_Static_assert(sizeof(_Atomic uint32_t) == sizeof(uint32_t), "a futex is a plain 32-bit word");

void wake_init(wake *self)
{
    atomic_init(&self->generation, 0);
    atomic_init(&self->waiting, 0);
}

/* Sequentially consistent on both sides: either the waiting thread sees the new generation, or the
 * signalling thread sees that it waits. */
void wake_signal(wake *self)
{
    atomic_fetch_add(&self->generation, 1);
    if (atomic_load(&self->waiting))
        syscall(SYS_futex, &self->generation, FUTEX_WAKE_PRIVATE, 1, NULL, NULL, 0);
}

uint32_t wake_seen(const wake *self)
{
    return atomic_load(&self->generation);
}

void wake_wait_until_ns(wake *self, uint32_t seen, int64_t time_ns)
{
    if (time_ns <= 0)
        return;
    struct timespec until = {.tv_sec = (time_t)(time_ns / NS_PER_S),
                             .tv_nsec = (long)(time_ns % NS_PER_S)};
    atomic_store(&self->waiting, 1);
    while (atomic_load(&self->generation) == seen && clock_now_ns() < time_ns)
        syscall(SYS_futex, &self->generation, FUTEX_WAIT_BITSET_PRIVATE, seen, &until, NULL,
                FUTEX_BITSET_MATCH_ANY);
    atomic_store(&self->waiting, 0);
}
