/* cyberglove/glove_rate.h - the rate of a glove that nobody told: the straight line under all of
 * the first arrivals, because arrivals are late and never early. Bunched ones are as good as
 * others. Pure functions on one struct; no allocation. */
#ifndef MAROTTE_CYBERGLOVE_RATE_H
#define MAROTTE_CYBERGLOVE_RATE_H
#include <stdbool.h>
#include <stdint.h>

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

#endif
