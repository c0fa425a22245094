#include "stage/input/wake.h"
#include "base/clock.h"
#include "base/os.h"

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
        os_wake_word(&self->generation);
}

uint32_t wake_seen(const wake *self)
{
    return atomic_load(&self->generation);
}

void wake_wait_until_ns(wake *self, uint32_t seen, int64_t time_ns)
{
    if (time_ns <= 0)
        return;
    atomic_store(&self->waiting, 1);
    while (atomic_load(&self->generation) == seen && clock_now_ns() < time_ns)
        os_wait_word(&self->generation, seen, time_ns);
    atomic_store(&self->waiting, 0);
}
