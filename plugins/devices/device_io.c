#include "device_io.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const int64_t ns_per_s = 1000000000;

const char *const device_sensor_name[MRT_ANGLES] = {
    "thumb.roll", "thumb.mpj",  "thumb.ij",    "thumb.abd",  "index.mpj",  "index.pij",
    "index.dij",  "middle.mpj", "middle.pij",  "middle.dij", "middle.abd", "ring.mpj",
    "ring.pij",   "ring.dij",   "ring.abd",    "little.mpj", "little.pij", "little.dij",
    "little.abd", "palm.arch",  "wrist.pitch", "wrist.yaw"};

void device_log(const mrt_host *host, int32_t level, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    host->log(host, level, text);
}

int64_t device_clock_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * ns_per_s + now.tv_nsec;
}

/* Uses the least interrupted of a few attempts. */
int64_t device_clock_host_offset_ns(const mrt_host *host)
{
    int64_t offset_ns = 0, least_ns = INT64_MAX;
    for (int i = 0; i < 5; ++i) {
        int64_t before_ns = device_clock_ns();
        int64_t host_ns = host->now_ns(host);
        int64_t took_ns = device_clock_ns() - before_ns;
        if (took_ns < least_ns) {
            least_ns = took_ns;
            offset_ns = host_ns - before_ns - took_ns / 2;
        }
    }
    return offset_ns;
}

int64_t device_deadline_ns(const mrt_host *host, int64_t deadline_ns)
{
    int64_t left_ns = deadline_ns - host->now_ns(host);
    return device_clock_ns() + (left_ns < 0 ? 0 : left_ns < ns_per_s ? left_ns : ns_per_s);
}

int64_t device_sample_ns(const mrt_host *host, int64_t time_ns, int64_t *last_ns)
{
    int64_t now_ns = host->now_ns(host);
    time_ns = time_ns < now_ns ? time_ns : now_ns;
    return *last_ns = time_ns > *last_ns ? time_ns : *last_ns;
}

static struct timespec timespec_of(int64_t time_ns)
{
    return (struct timespec){(time_t)(time_ns / ns_per_s), (long)(time_ns % ns_per_s)};
}

int device_wait(int descriptor, int64_t span_ns)
{
    struct pollfd wanted = {descriptor, POLLIN, 0};
    const struct timespec span = timespec_of(span_ns > 0 ? span_ns : 0);
    int ready = ppoll(&wanted, 1, &span, NULL);
    return ready >= 0 ? ready : errno == EINTR ? 0 : -1;
}

size_t device_read_file(const char *path, void *out, size_t capacity)
{
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0)
        return 0;
    size_t used = 0;
    while (used < capacity) {
        ssize_t got = read(file, (char *)out + used, capacity - used);
        if (got <= 0)
            break;
        used += (size_t)got;
    }
    close(file);
    return used;
}

void device_read_line(const char *path, char *out, size_t capacity)
{
    size_t used = device_read_file(path, out, capacity - 1);
    out[used] = '\0';
    out[strcspn(out, "\r\n")] = '\0';
    for (char *c = out; *c; ++c)
        if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = ' ';
    for (size_t end = strlen(out); end > 0 && out[end - 1] == ' '; --end)
        out[end - 1] = '\0';
}

void device_condition_init(pthread_cond_t *out)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_cond_init(out, &attributes);
    pthread_condattr_destroy(&attributes);
}

bool device_condition_wait(pthread_cond_t *condition, pthread_mutex_t *mutex, int64_t until_ns)
{
    const struct timespec until = timespec_of(until_ns);
    return pthread_cond_timedwait(condition, mutex, &until) == 0;
}

/* ---- mapping a device's clock ---- */

/* Long enough to include an arrival without delay, and short enough to follow two crystals: 50 ppm
 * in 8 s are 0.4 ms. */
static const int64_t window_ns = 1000000000;
/* The offset rises by at most 1 ns per this time: 0.2 ms per second, more than crystals drift. */
static const int64_t rise_span_ns = 5000;
static const int64_t jump_ns = 1000000000;

void clock_map_reset(clock_map *map)
{
    *map = (clock_map){0};
}

static void start(clock_map *map, int64_t device_ns, int64_t arrival_ns)
{
    int64_t last_host_ns = map->last_host_ns;
    *map = (clock_map){.running = true,
                       .offset_ns = arrival_ns - device_ns,
                       .window_start_ns = arrival_ns,
                       .last_device_ns = device_ns,
                       .last_host_ns = last_host_ns};
    for (int i = 0; i < CLOCK_MAP_WINDOWS; ++i)
        map->least_ns[i] = INT64_MAX;
    map->least_ns[0] = map->offset_ns;
}

static void remember(clock_map *map, int64_t late_ns, int64_t arrival_ns)
{
    if (arrival_ns - map->window_start_ns >= window_ns) {
        map->window = (map->window + 1) % CLOCK_MAP_WINDOWS;
        map->least_ns[map->window] = INT64_MAX;
        map->window_start_ns = arrival_ns;
    }
    if (late_ns < map->least_ns[map->window])
        map->least_ns[map->window] = late_ns;
}

static int64_t least(const clock_map *map)
{
    int64_t found = INT64_MAX;
    for (int i = 0; i < CLOCK_MAP_WINDOWS; ++i)
        if (map->least_ns[i] < found)
            found = map->least_ns[i];
    return found;
}

int64_t clock_map_to_host(clock_map *map, int64_t device_ns, int64_t arrival_ns)
{
    device_ns = device_time_ns(device_ns);
    int64_t late_ns = arrival_ns - device_ns;
    int64_t step_ns = device_ns - map->last_device_ns;
    int64_t off_ns = late_ns - map->offset_ns;
    if (!map->running || step_ns < 0 || off_ns < -jump_ns || off_ns > jump_ns)
        start(map, device_ns, arrival_ns);
    remember(map, late_ns, arrival_ns);
    int64_t wanted_ns = least(map);
    /* An arrival earlier than all before sets the offset immediately; a later estimate is
     * approached slowly. */
    int64_t rise_ns = (device_ns - map->last_device_ns) / rise_span_ns;
    if (wanted_ns > map->offset_ns + rise_ns)
        wanted_ns = map->offset_ns + rise_ns;
    map->offset_ns = wanted_ns;
    map->last_device_ns = device_ns;
    int64_t host_ns = device_ns + map->offset_ns;
    if (host_ns > arrival_ns)
        host_ns = arrival_ns;
    if (host_ns < map->last_host_ns)
        host_ns = map->last_host_ns;
    map->last_host_ns = host_ns;
    return host_ns;
}
