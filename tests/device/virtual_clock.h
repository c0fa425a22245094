/* device/virtual_clock.h - a clock that only a test moves, and a device beside it that lives by it.
 * To the thread that took it, and the plugins that this thread calls, the system tells the virtual
 * time (clock_gettime of CLOCK_MONOTONIC) and waits by it (nanosleep, clock_nanosleep, poll,
 * ppoll): a wait takes no time, the clock goes on to whatever happens next. Each run is the same,
 * however busy the machine. What is computed takes no time at all, what is written a moment. Other
 * threads and processes know nothing of it. A library of its own, found before the system's. */
#ifndef MAROTTE_TESTS_DEVICE_VIRTUAL_CLOCK_H
#define MAROTTE_TESTS_DEVICE_VIRTUAL_CLOCK_H
#include <stddef.h>
#include <stdint.h>

/* The device. While its functions are called the thread sees the virtual time still, but waits as
 * long as others do. */
typedef struct virtual_device {
    int64_t (*due_ns)(void *data); /* when it does something next, unasked; INT64_MAX: never */
    void (*run)(void *data, int64_t now_ns); /* does what is due */
    /* The program has written so many bytes to a file, which may be the device's. */
    void (*written)(void *data, int64_t now_ns, int file, size_t size);
    void *data;
} virtual_device;

/* From now on this thread lives by it, at `start_ns`; `device` must live until it is given back.
 * NULL: nothing happens but what the thread does itself, as where it writes into pipes. */
void virtual_clock_take(const virtual_device *device, int64_t start_ns);
void virtual_clock_give_back(void); /* also where nobody has it */
/* As on a busy machine: from now on each wait ends up to so much later than it should, each time
 * another. */
void virtual_clock_be_late(int64_t most_ns);
/* How often the thread has asked the system to wait since it took the clock: a program that spins
 * asks without end. */
uint64_t virtual_clock_wait_count(void);

#endif
