#include "glove_rate.h"

/* A line through less is worse than arrivals, a line through more follows a drifting clock too
 * slowly. */
static const int64_t least_ns = 60000000, enough_ns = 2000000000, gap_ns = 4000000000;
enum { LEAST_RECORDS = 4, ENOUGH_RECORDS = 16 };

/* Whether the last corner lies on or above the line from the one before it to the new one. */
static bool is_above(const glove_rate *self, double index, double ns)
{
    uint32_t last = self->corner_count - 1;
    double run = self->corner[last].index - self->corner[last - 1].index;
    double rise_ns = self->corner[last].ns - self->corner[last - 1].ns;
    double whole_run = index - self->corner[last - 1].index;
    double whole_rise_ns = ns - self->corner[last - 1].ns;
    return rise_ns * whole_run >= whole_rise_ns * run;
}

static void add_corner(glove_rate *self, double index, double ns)
{
    while (self->corner_count > 1 && is_above(self, index, ns))
        self->corner_count -= 1;
    if (self->corner_count == GLOVE_RATE_CORNERS)
        self->corner_count -= 1;
    self->corner[self->corner_count].index = index;
    self->corner[self->corner_count].ns = ns;
    self->corner_count += 1;
}

bool glove_rate_add(glove_rate *self, uint32_t lost, int64_t arrival_ns, double *out_period_ns,
                    double *out_due_ns)
{
    if (self->count > 0 &&
        (arrival_ns < self->last_ns || arrival_ns - self->last_ns > gap_ns || lost > 1000))
        *self = (glove_rate){.count = 0};
    if (self->count == 0)
        self->first_ns = arrival_ns;
    self->count += self->count > 0 ? 1 + lost : 1;
    self->last_ns = arrival_ns;
    double index = self->count - 1.0, ns = (double)(arrival_ns - self->first_ns);
    add_corner(self, index, ns);
    if (self->count < LEAST_RECORDS || arrival_ns - self->first_ns < least_ns)
        return false;
    /* Of all lines under the arrivals the one over the middle has the least lateness in all. */
    uint32_t to = 1;
    while (to + 1 < self->corner_count && self->corner[to].index < index / 2)
        to += 1;
    double run = self->corner[to].index - self->corner[to - 1].index;
    *out_period_ns = (self->corner[to].ns - self->corner[to - 1].ns) / run;
    double due_ns = self->corner[to].ns + (index - self->corner[to].index) * *out_period_ns;
    *out_due_ns = (double)self->first_ns + (due_ns < ns ? due_ns : ns);
    return *out_period_ns > 0;
}

bool glove_rate_is_known(const glove_rate *self)
{
    return self->count >= ENOUGH_RECORDS && self->last_ns - self->first_ns >= enough_ns;
}
