/* stage/input/wake.h - lets one thread sleep until another thread signals it. Signalling never
 * waits and takes no lock, so it is allowed in input threads and signal handlers. A signal at any
 * time after wake_seen ends the wait. Linux: a futex. */
#ifndef MAROTTE_STAGE_WAKE_H
#define MAROTTE_STAGE_WAKE_H
#include <stdatomic.h>
#include <stdint.h>

typedef struct wake {
    _Atomic uint32_t generation; /* +1 with each signal */
    _Atomic uint32_t waiting;    /* 1 while the waiting thread may be asleep */
} wake;

void wake_init(wake *self);
/* [any, signal handlers too] */
void wake_signal(wake *self);
/* [waiting thread] Call before checking for work. */
uint32_t wake_seen(const wake *self);
/* [waiting thread] Sleeps until a signal after `seen`, or until time_ns of the monotonic clock. */
void wake_wait_until_ns(wake *self, uint32_t seen, int64_t time_ns);

#endif
