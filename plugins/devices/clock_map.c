#include "clock_map.h"

/* Long enough to meet an arrival that was not late, short enough to follow two crystals: 50 ppm in
 * 8 s are 0.4 ms. */
static const int64_t window_ns = 1000000000;
/* How fast the offset follows an estimate that grew: 0.2 ms a second, more than crystals drift. */
static const int64_t rise_per_s_ns = 200000;
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
    int64_t late_ns = arrival_ns - device_ns;
    int64_t step_ns = device_ns - map->last_device_ns;
    int64_t off_ns = late_ns - map->offset_ns;
    if (!map->running || step_ns < 0 || off_ns < -jump_ns || off_ns > jump_ns)
        start(map, device_ns, arrival_ns);
    remember(map, late_ns, arrival_ns);
    int64_t wanted_ns = least(map);
    /* An earlier arrival than ever is the truth at once; a later estimate is crept up to. */
    int64_t rise_ns = (device_ns - map->last_device_ns) / 1000 * rise_per_s_ns / 1000000;
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
