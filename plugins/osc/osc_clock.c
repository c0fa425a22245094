#include "osc_clock.h"

#include <time.h>

int64_t osc_clock_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

/* Of a few tries the one that was interrupted least. */
int64_t osc_clock_host_offset_ns(const mrt_host *host)
{
    int64_t offset_ns = 0, least_ns = INT64_MAX;
    for (int i = 0; i < 5; ++i) {
        int64_t before_ns = osc_clock_ns();
        int64_t host_ns = host->now_ns(host);
        int64_t took_ns = osc_clock_ns() - before_ns;
        if (took_ns < least_ns) {
            least_ns = took_ns;
            offset_ns = host_ns - before_ns - took_ns / 2;
        }
    }
    return offset_ns;
}
