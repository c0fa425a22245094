/* plugins/osc/osc_clock.h - the clock by which packets are stamped, and how the host's stands to
 * it: threads that the host has not made may not ask the host for the time. Any thread. */
#ifndef MAROTTE_OSC_CLOCK_H
#define MAROTTE_OSC_CLOCK_H
#include <marotte/plugin.h>

int64_t osc_clock_ns(void); /* monotonic */
/* The host's clock less ours. [main] [input] */
int64_t osc_clock_host_offset_ns(const mrt_host *host);

#endif
