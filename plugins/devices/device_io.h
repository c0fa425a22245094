/* plugins/devices/device_io.h - what every input that waits for a device does: say a sentence, tell
 * the time, wait for bytes. Shared by input plugins. */
#ifndef MAROTTE_DEVICES_DEVICE_IO_H
#define MAROTTE_DEVICES_DEVICE_IO_H
#include <marotte/plugin.h>

/* One line for the person, cut at 511 bytes. Any thread. */
__attribute__((format(printf, 3, 4))) void device_say(const mrt_host *host, int32_t level,
                                                      const char *format, ...);

/* The system's monotonic clock, for threads that the host has not made: those may not ask the host
 * for the time. */
int64_t device_clock_ns(void);
/* The host's clock less that one. [main] [input] */
int64_t device_clock_host_offset_ns(const mrt_host *host);

/* Waits until the descriptor has something to read (or is gone), or span_ns have passed, never
 * longer: 1, 0, or -1 and errno. A span below 0 is 0. A signal ends it early with 0. */
int device_wait(int descriptor, int64_t span_ns);

#endif
