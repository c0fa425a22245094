/* stage/input/wake.h - lets one thread sleep until any of several others has something for it.
 * Signalling never waits and takes no lock, so it is fit for input threads and for signal handlers;
 * a signal given at any moment after wake_seen ends the wait. Linux: a futex. */
#ifndef MAROTTE_STAGE_WAKE_H
#define MAROTTE_STAGE_WAKE_H
#include <stdatomic.h>
#include <stdint.h>

typedef struct wake {
    _Atomic uint32_t generation; /* +1 with each signal */
    _Atomic uint32_t waiting;    /* 1 while the waiter may be asleep */
} wake;

void wake_init(wake *self);
/* [any, signal handlers too] */
void wake_signal(wake *self);
/* [the waiter] Before it looks whether there is work. */
uint32_t wake_seen(const wake *self);
/* [the waiter] Sleeps until a signal later than `seen` or until the monotonic clock's time_ns. */
void wake_wait_until_ns(wake *self, uint32_t seen, int64_t time_ns);

#endif
