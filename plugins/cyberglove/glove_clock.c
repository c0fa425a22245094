#include "glove_clock.h"

/* ---- the rate ---- */

/* Time spans of the line. A shorter one is less precise than the arrivals; a longer one follows a
 * drifting clock too slowly. */
static const int64_t least_ns = 60000000, enough_ns = 2000000000, silence_ns = 4000000000;
enum { LEAST_RECORDS = 4, ENOUGH_RECORDS = 16 };

/* Returns true if the last corner is on or above the line from the previous corner to the new
 * one. */
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
        (arrival_ns < self->last_ns || arrival_ns - self->last_ns > silence_ns || lost > 1000))
        *self = (glove_rate){.count = 0};
    if (self->count == 0)
        self->first_ns = arrival_ns;
    self->count += self->count > 0 ? 1 + lost : 1;
    self->last_ns = arrival_ns;
    double index = self->count - 1.0, ns = (double)(arrival_ns - self->first_ns);
    add_corner(self, index, ns);
    if (self->count < LEAST_RECORDS || arrival_ns - self->first_ns < least_ns)
        return false;
    /* Of all lines below the arrivals, the one over the middle has the smallest total lateness. */
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

/* ---- the clock ---- */

/* 1/115200 s = 78125/9 ns */
static const int64_t tick_numerator_ns = 78125, tick_denominator = 9;
static const int64_t check_ns = 1000000000;
static const double window_ns = 128e6;
static const double gap_ns = 1e9;
static const double period_least_ns = 1e6, period_most_ns = 3e9;
/* A stamp that is ahead of all earlier ones by more than this is a transmission error, unless later
 * stamps confirm it. */
static const int64_t ahead_ns = 3000000;
enum { ODD_MAX = 3, MISFIT_MAX = 2 };
/* Memory of the loop, in windows: the initial value if the rate was set; the maximum, which is also
 * the initial value if the rate was measured. */
enum { MEMORY_TOLD = 4, MEMORY_MOST = 8 };

void glove_clock_init(glove_clock *self, glove_timing timing, int64_t period_ns)
{
    *self = (glove_clock){.timing = timing, .pace = {.period_ns = (double)period_ns}};
    clock_map_reset(&self->map);
}

void glove_clock_restart(glove_clock *self)
{
    int64_t last_ns = self->last_ns;
    bool distrusts = self->distrusts_stamps;
    glove_clock_init(self, self->timing, (int64_t)self->pace.period_ns);
    self->distrusts_stamps = distrusts;
    self->last_ns = last_ns;
}

/* ---- by rate ---- */

static double clamp(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static void pace_start(glove_pace *pace, int64_t arrival_ns)
{
    *pace = (glove_pace){.period_ns = pace->period_ns,
                         .memory = MEMORY_TOLD,
                         .next_ns = (double)arrival_ns,
                         .window_start_ns = arrival_ns,
                         .least_late_ns = gap_ns};
}

static void pace_turn_window(glove_pace *pace, int64_t arrival_ns)
{
    if ((double)(arrival_ns - pace->window_start_ns) < window_ns || pace->window_count < 4)
        return;
    /* Gains that make the loop equal to a straight line fitted to `memory` windows. */
    double k = pace->memory;
    double phase_gain = 2 * (2 * k + 1) / ((k + 1) * (k + 2));
    double period_gain = 6 / ((k + 1) * (k + 2));
    double off_ns = pace->early_ns + pace->least_late_ns;
    pace->next_ns += phase_gain * pace->least_late_ns;
    pace->period_ns = clamp(pace->period_ns + period_gain * off_ns / (double)pace->window_count,
                            period_least_ns, period_most_ns);
    pace->memory += pace->memory < MEMORY_MOST;
    pace->window_start_ns = arrival_ns;
    pace->window_count = 0;
    pace->least_late_ns = gap_ns;
    pace->early_ns = 0;
}

/* Times for an unknown rate: from the line below the first arrivals, then from the loop once the
 * line is accurate. */
static int64_t pace_learn(glove_pace *pace, uint32_t lost, int64_t arrival_ns)
{
    double period_ns, due_ns;
    if (!glove_rate_add(&pace->rate, lost, arrival_ns, &period_ns, &due_ns))
        return arrival_ns;
    if (glove_rate_is_known(&pace->rate)) {
        pace->period_ns = clamp(period_ns, period_least_ns, period_most_ns);
        pace->next_ns = due_ns + pace->period_ns;
        pace->window_start_ns = arrival_ns;
        pace->memory = MEMORY_MOST;
    }
    return (int64_t)due_ns;
}

static int64_t pace_time(glove_pace *pace, uint32_t lost, int64_t arrival_ns)
{
    if (pace->sample_count == 0)
        pace_start(pace, arrival_ns);
    pace->sample_count += pace->sample_count < UINT32_MAX;
    if (pace->period_ns <= 0)
        return pace_learn(pace, lost, arrival_ns);
    double due_ns = pace->next_ns + (double)lost * pace->period_ns;
    double late_ns = (double)arrival_ns - due_ns;
    if (late_ns > gap_ns || late_ns < -gap_ns) {
        pace_start(pace, arrival_ns);
        pace->sample_count = 1;
        due_ns = (double)arrival_ns;
        late_ns = 0;
    }
    if (late_ns < 0) {
        pace->early_ns += late_ns;
        due_ns = (double)arrival_ns;
        late_ns = 0;
    }
    if (late_ns < pace->least_late_ns)
        pace->least_late_ns = late_ns;
    pace->window_count += 1;
    pace->next_ns = due_ns + pace->period_ns;
    pace_turn_window(pace, arrival_ns);
    return (int64_t)due_ns;
}

/* ---- by stamp ---- */

static int64_t ns_of_ticks(int64_t ticks)
{
    return ticks / tick_denominator * tick_numerator_ns +
           ticks % tick_denominator * tick_numerator_ns / tick_denominator;
}

/* Compares the glove's clock with the host's every second. The glove's must have advanced at least
 * half as far, because arrivals may be late. A doubt is checked over two seconds, so that a
 * computer that stalls is not mistaken for it. */
static void check_stamps(glove_clock *self, int64_t arrival_ns)
{
    bool is_in_doubt = self->misfit_count > 0 && !self->distrusts_stamps;
    if (arrival_ns - self->check_ns < (is_in_doubt ? 2 * check_ns : check_ns))
        return;
    int64_t device_ns = ns_of_ticks(self->device_ticks - self->check_ticks);
    int64_t host_ns = arrival_ns - self->check_ns;
    bool fits = device_ns > host_ns / 2 && device_ns < host_ns * 3 / 2;
    self->misfit_count = fits ? 0 : self->misfit_count + 1;
    self->distrusts_stamps = self->misfit_count >= MISFIT_MAX;
    if (!fits && !self->distrusts_stamps)
        return;
    self->check_ticks = self->device_ticks;
    self->check_ns = arrival_ns;
}

/* Detects a damaged stamp. It runs backwards, or is further ahead than the records allow, at a time
 * that the glove's clock cannot have reached. One such stamp would mislead the map for seconds. */
static bool is_odd(const glove_clock *self, int32_t step_ticks, uint32_t lost, int64_t arrival_ns)
{
    if (step_ticks <= 0)
        return true;
    double step_ns = (double)ns_of_ticks(step_ticks);
    if (self->pace.period_ns <= 0 || step_ns < self->pace.period_ns * ((double)lost + 1.5))
        return false;
    int64_t late_ns = arrival_ns - ns_of_ticks(self->device_ticks + step_ticks);
    return late_ns < self->map.offset_ns - ahead_ns;
}

static void stamps_start(glove_clock *self, uint32_t ticks, int64_t arrival_ns)
{
    self->has_stamp = true;
    self->last_ticks = ticks;
    self->device_ticks = ticks;
    self->check_ticks = ticks;
    self->check_ns = arrival_ns;
}

/* by_rate_ns: used if the stamp is damaged or may be. */
static int64_t stamp_time(glove_clock *self, const glove_record *record, int64_t by_rate_ns,
                          int64_t arrival_ns)
{
    if (!self->has_stamp)
        stamps_start(self, record->ticks, arrival_ns);
    uint32_t step = record->ticks - self->last_ticks;
    int32_t step_ticks = step > INT32_MAX ? -1 : (int32_t)step;
    check_stamps(self, arrival_ns);
    if (self->map.running && is_odd(self, step_ticks, record->lost, arrival_ns) &&
        self->odd_count < ODD_MAX) {
        self->odd_count += 1;
        return by_rate_ns;
    }
    if (step_ticks < 0)
        stamps_start(self, record->ticks, arrival_ns);
    else
        self->device_ticks += step_ticks;
    self->last_ticks = record->ticks;
    self->odd_count = 0;
    return clock_map_to_host(&self->map, ns_of_ticks(self->device_ticks), arrival_ns);
}

int64_t glove_clock_time(glove_clock *self, const glove_record *record, int64_t arrival_ns)
{
    int64_t time_ns = arrival_ns;
    if (self->timing != GLOVE_BY_ARRIVAL)
        time_ns = pace_time(&self->pace, record->lost, arrival_ns);
    if (self->timing == GLOVE_BY_STAMP && !self->distrusts_stamps)
        time_ns = stamp_time(self, record, time_ns, arrival_ns);
    if (time_ns > arrival_ns)
        time_ns = arrival_ns;
    if (time_ns < self->last_ns)
        time_ns = self->last_ns;
    self->last_ns = time_ns;
    return time_ns;
}
