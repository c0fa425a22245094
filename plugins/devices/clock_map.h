/* plugins/devices/clock_map.h - from a device's own clock to the host's: the time at which a sample
 * was measured, though samples arrive late and in bunches. The offset is the smallest lateness seen
 * lately, followed slowly, so that it is neither moved by one late arrival nor lost when the two
 * clocks drift apart. Leaves out units and wrap-around: the caller's. Pure functions on one struct;
 * no allocation. Shared by input plugins. */
#ifndef MAROTTE_DEVICES_CLOCK_MAP_H
#define MAROTTE_DEVICES_CLOCK_MAP_H
#include <stdbool.h>
#include <stdint.h>

enum { CLOCK_MAP_WINDOWS = 8 };
typedef struct clock_map {
    bool running;
    int64_t offset_ns;                   /* host - device, as used now */
    int64_t least_ns[CLOCK_MAP_WINDOWS]; /* smallest host - device of each window */
    int64_t window_start_ns;             /* host clock */
    uint32_t window;
    int64_t last_device_ns, last_host_ns;
} clock_map;

void clock_map_reset(clock_map *map);
/* Host time of what the device measured at device_ns and the host received at arrival_ns: never
 * after the arrival, never before what was returned last. A device clock that jumps (backwards, or
 * by more than a second against the host's) starts the map anew. */
int64_t clock_map_to_host(clock_map *map, int64_t device_ns, int64_t arrival_ns);

#endif
