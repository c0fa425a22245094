/* plugins/devices/device_io.h - helpers of inputs that wait for a device: logging, clocks, waiting
 * for bytes, reading small system files, names of the sensors of a hand. Shared by input
 * plugins. */
#ifndef MAROTTE_DEVICES_DEVICE_IO_H
#define MAROTTE_DEVICES_DEVICE_IO_H
#include <marotte/plugin.h>

#include <pthread.h>

/* Names of a hand's angles, in sensor order: "thumb.roll" ... "wrist.yaw". */
extern const char *const device_sensor_name[MRT_ANGLES];

/* Logs one line for the user, truncated at 511 bytes. Any thread. */
__attribute__((format(printf, 3, 4))) void device_log(const mrt_host *host, int32_t level,
                                                      const char *format, ...);

/* Returns the system's monotonic clock. For threads not created by the host, because those cannot
 * ask the host for the time. */
int64_t device_clock_ns(void);
/* Returns the host's clock minus device_clock_ns. [main] [input] */
int64_t device_clock_host_offset_ns(const mrt_host *host);
/* Converts the deadline of a read to device_clock_ns. At most one second ahead, also for a host
 * whose clock waits for this input. [input] */
int64_t device_deadline_ns(const mrt_host *host, int64_t deadline_ns);
/* Returns the host's time of a sample measured at time_ns: never in the future, never before
 * *last_ns. Sets *last_ns to it. [main] [input] */
int64_t device_sample_ns(const mrt_host *host, int64_t time_ns, int64_t *last_ns);

static inline int64_t device_earlier_ns(int64_t a_ns, int64_t b_ns)
{
    return a_ns < b_ns ? a_ns : b_ns;
}

/* Waits at most span_ns until the descriptor is readable or closed. Returns 1, 0 at the end of the
 * time, or -1 and errno. A negative span counts as 0. A signal ends the wait early with 0. */
int device_wait(int descriptor, int64_t span_ns);

/* Reads the beginning of a small file, such as in /sys and /proc. Returns the number of bytes; 0 if
 * it cannot be read. */
size_t device_read_file(const char *path, void *out, size_t capacity);
/* Reads the first line of such a file, 0-ended. Control characters, which a device's name can
 * contain, become blanks; trailing ones are removed. "" if it cannot be read. */
void device_read_line(const char *path, char *out, size_t capacity);

/* Initialises a condition variable that uses device_clock_ns. Any thread. */
void device_condition_init(pthread_cond_t *out);
/* Like pthread_cond_timedwait. Returns false at until_ns. */
bool device_condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns);

/* ---- from a device's clock to the host's: the time at which a sample was measured, although
 * samples arrive late and in bunches. The offset is the smallest recent lateness, followed slowly.
 * So one late arrival does not move it, and it follows the drift of the two clocks. Leaves out
 * units and wrap-around, which the caller handles. Pure functions on one struct ---- */

/* Times of other clocks are limited to +- this value, 73 years, so that sums and differences of two
 * fit 64 bits. */
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
    int64_t offset_ns;                   /* host - device, current value */
    int64_t least_ns[CLOCK_MAP_WINDOWS]; /* smallest host - device of each window */
    int64_t window_start_ns;             /* host clock */
    uint32_t window;
    int64_t last_device_ns, last_host_ns;
} clock_map;

void clock_map_reset(clock_map *map);
/* Returns the host time of a measurement at device_ns that arrived at arrival_ns: never after the
 * arrival, never before the last returned time. If the device's clock jumps (backwards, or by more
 * than a second against the host's), the map restarts. device_ns can be any number. */
int64_t clock_map_to_host(clock_map *map, int64_t device_ns, int64_t arrival_ns);

#endif
