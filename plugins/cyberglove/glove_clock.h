/* cyberglove/glove_clock.h - when a record was measured, on the host's clock: by the glove's own
 * time stamps where it gives them (devices/device_io.h), else by its steady rate: bunched arrivals
 * are spread, and the earliest of late show when. Pure functions on one struct; no allocation. */
#ifndef MAROTTE_CYBERGLOVE_CLOCK_H
#define MAROTTE_CYBERGLOVE_CLOCK_H
#include "device_io.h"
#include "glove_parse.h"

#include <stdbool.h>
#include <stdint.h>

/* The rate of a glove that nobody told: the straight line under all of the first arrivals, because
 * arrivals are late and never early; bunched ones are as good as others. */

enum { GLOVE_RATE_CORNERS = 32 };

typedef struct glove_rate {
    int64_t first_ns, last_ns; /* arrivals */
    uint32_t count;            /* records, with those that were lost */
    uint32_t corner_count;
    struct {
        double index, ns;         /* ns: since first_ns */
    } corner[GLOVE_RATE_CORNERS]; /* of the lower hull of arrivals over records */
} glove_rate;

/* Begins with a zeroed struct. False: too little is known yet. *out_period_ns and *out_due_ns: of
 * the line, at this record; never after the arrival. */
bool glove_rate_add(glove_rate *self, uint32_t lost, int64_t arrival_ns, double *out_period_ns,
                    double *out_due_ns);
/* Whether the line has become as good as it need be. */
bool glove_rate_is_known(const glove_rate *self);

typedef enum glove_timing {
    GLOVE_BY_ARRIVAL = 0, /* each record was asked for: it is of when it came */
    GLOVE_BY_RATE,
    GLOVE_BY_STAMP
} glove_timing;

/* Times by a steady rate: a phase-locked loop on the least lateness of each window. */
typedef struct glove_pace {
    double period_ns; /* 0: not known yet */
    double next_ns;   /* when the next record is due */
    int64_t window_start_ns;
    double least_late_ns, early_ns;
    uint32_t sample_count, window_count, memory;
    glove_rate rate; /* while the period is not known */
} glove_pace;

typedef struct glove_clock {
    glove_timing timing;
    clock_map map;
    glove_pace pace;
    bool has_stamp, distrusts_stamps; /* distrusts: stamps did not go with time, the rate is used */
    uint32_t last_ticks, odd_count, misfit_count;
    int64_t device_ticks;          /* unwrapped */
    int64_t check_ticks, check_ns; /* where the window of that check began */
    int64_t last_ns;
} glove_clock;

/* period_ns: what the glove was set to, 0 if that is not known. */
void glove_clock_init(glove_clock *self, glove_timing timing, int64_t period_ns);
/* After an interruption: what comes next is not measured against what came before. */
void glove_clock_restart(glove_clock *self);
/* Never after the arrival, never before what was returned last. */
int64_t glove_clock_time(glove_clock *self, const glove_record *record, int64_t arrival_ns);

#endif
