/* cyberglove/glove_clock.h - the measurement time of a record on the host's clock. It comes from
 * the glove's time stamps if it sends them (devices/device_io.h), else from its steady rate, so
 * that bunched arrivals are spread. Pure functions on one struct; no allocation. */
#ifndef MAROTTE_CYBERGLOVE_CLOCK_H
#define MAROTTE_CYBERGLOVE_CLOCK_H
#include "device_io.h"
#include "glove_parse.h"

#include <stdbool.h>
#include <stdint.h>

/* Estimate of an unknown rate: the straight line below all of the first arrivals, because arrivals
 * are late and never early. Bunched arrivals are as good as others. */

enum { GLOVE_RATE_CORNERS = 32 };

typedef struct glove_rate {
    int64_t first_ns, last_ns; /* arrivals */
    uint32_t count;            /* records, including lost ones */
    uint32_t corner_count;
    struct {
        double index, ns;         /* ns: since first_ns */
    } corner[GLOVE_RATE_CORNERS]; /* corners of the lower hull of arrivals over records */
} glove_rate;

/* Adds an arrival; begins with a zeroed struct. Returns false until enough is known. *out_period_ns
 * and *out_due_ns: period and due time of the line at this record, never after the arrival. */
bool glove_rate_add(glove_rate *self, uint32_t lost, int64_t arrival_ns, double *out_period_ns,
                    double *out_due_ns);
/* Returns true when the line is accurate enough. */
bool glove_rate_is_known(const glove_rate *self);

typedef enum glove_timing {
    GLOVE_BY_ARRIVAL = 0, /* polled records: time of arrival */
    GLOVE_BY_RATE,
    GLOVE_BY_STAMP
} glove_timing;

/* Times from a steady rate: a phase-locked loop on the smallest lateness of each window. */
typedef struct glove_pace {
    double period_ns; /* 0: unknown */
    double next_ns;   /* due time of the next record */
    int64_t window_start_ns;
    double least_late_ns, early_ns;
    uint32_t sample_count, window_count, memory;
    glove_rate rate; /* used while the period is unknown */
} glove_pace;

typedef struct glove_clock {
    glove_timing timing;
    clock_map map;
    glove_pace pace;
    bool has_stamp, distrusts_stamps; /* distrusts: stamps did not match the host's clock, so the
                                         rate is used */
    uint32_t last_ticks, odd_count, misfit_count;
    int64_t device_ticks;          /* unwrapped */
    int64_t check_ticks, check_ns; /* start of the window of that check */
    int64_t last_ns;
} glove_clock;

/* period_ns: the period set in the glove, 0 if unknown. */
void glove_clock_init(glove_clock *self, glove_timing timing, int64_t period_ns);
/* Call after an interruption: later records are not compared with earlier ones. */
void glove_clock_restart(glove_clock *self);
/* Returns the time of the record: never after its arrival, never before the last returned time. */
int64_t glove_clock_time(glove_clock *self, const glove_record *record, int64_t arrival_ns);

#endif
