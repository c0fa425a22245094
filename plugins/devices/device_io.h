/* plugins/devices/device_io.h - what every input that waits for a device does: say a sentence, tell
 * the time, by the device's clock too, wait for bytes, read what the system tells, call the sensors
 * of a hand by their names. Shared by input plugins. */
#ifndef MAROTTE_DEVICES_DEVICE_IO_H
#define MAROTTE_DEVICES_DEVICE_IO_H
#include <marotte/plugin.h>

#include <pthread.h>

/* What the angles of a hand are called, in sensor order: "thumb.roll" ... "wrist.yaw". */
extern const char *const device_sensor_name[MRT_ANGLES];

/* One line for the person, cut at 511 bytes. Any thread. */
__attribute__((format(printf, 3, 4))) void device_say(const mrt_host *host, int32_t level,
                                                      const char *format, ...);

/* The system's monotonic clock, for threads that the host has not made: those may not ask the host
 * for the time. */
int64_t device_clock_ns(void);
/* The host's clock less that one. [main] [input] */
int64_t device_clock_host_offset_ns(const mrt_host *host);
/* The deadline of a read by that clock; a second from now at most, also for a host whose clock
 * waits for this input. [input] */
int64_t device_deadline_ns(const mrt_host *host, int64_t deadline_ns);
/* The host's time for a sample that was measured at time_ns: never in the future, never before
 * *last_ns, which it becomes. [main] [input] */
int64_t device_sample_ns(const mrt_host *host, int64_t time_ns, int64_t *last_ns);

static inline int64_t device_sooner_ns(int64_t a_ns, int64_t b_ns)
{
    return a_ns < b_ns ? a_ns : b_ns;
}

/* Waits until the descriptor has something to read (or is gone), or span_ns have passed, never
 * longer: 1, 0, or -1 and errno. A span below 0 is 0. A signal ends it early with 0. */
int device_wait(int descriptor, int64_t span_ns);

/* The beginning of a small file, as of /sys and /proc: how many bytes; 0: there is none. */
size_t device_read_file(const char *path, void *out, size_t capacity);
/* Its first line without its end, 0-ended; control characters, which a device may well have in its
 * name, are blanks, and none of these is at the end. "" if there is none. */
void device_read_line(const char *path, char *out, size_t capacity);

/* A condition whose waits are by device_clock_ns. Any thread. */
void device_condition_init(pthread_cond_t *out);
/* As pthread_cond_timedwait. False: it is until_ns. */
bool device_condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns);

/* ---- from a device's own clock to the host's: the time at which a sample was measured, though
 * samples arrive late and in bunches. The offset is the smallest lateness seen lately, followed
 * slowly, so that it is neither moved by one late arrival nor lost when the two clocks drift apart.
 * Leaves out units and wrap-around: the caller's. Pure functions on one struct ---- */

/* Times of other clocks are cut to +- this, 73 years: sums and differences of two fit 64 bits. */
static const int64_t DEVICE_TIME_MAX_NS = INT64_C(1) << 61;

static inline int64_t device_time_ns(int64_t time_ns)
{
    if (time_ns > DEVICE_TIME_MAX_NS)
        return DEVICE_TIME_MAX_NS;
    return time_ns < -DEVICE_TIME_MAX_NS ? -DEVICE_TIME_MAX_NS : time_ns;
}

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
 * by more than a second against the host's) starts the map anew. device_ns may be any number. */
int64_t clock_map_to_host(clock_map *map, int64_t device_ns, int64_t arrival_ns);

#endif
