/* base/clock.h - the monotonic clock for samples and frame times, and the calendar time. [any] */
#ifndef MAROTTE_BASE_CLOCK_H
#define MAROTTE_BASE_CLOCK_H
#include <stdint.h>

#define NS_PER_S  1000000000LL
#define NS_PER_MS 1000000LL

int64_t clock_now_ns(void);
int64_t clock_utc_ms(void); /* calendar time, for the dates of edits, not for samples */
void clock_sleep_until_ns(int64_t time_ns);

#endif
