#include "stage/perform/scheduler.h"
#include "base/clock.h"

#include <string.h>

/* Further apart they have no rhythm: a pedal, a device that was away. */
static const int64_t period_max_ns = 100 * NS_PER_MS;

void scheduler_init(scheduler *out, scheduler_rule rule)
{
    memset(out, 0, sizeof *out);
    out->rule = rule;
    out->last_ns = out->shown_ns = INT64_MIN;
}

/* ---- who gives samples ---- */

static uint32_t measured_by(const channel_route *route)
{
    uint32_t out = 0;
    for (uint32_t i = 0; i < route->count; ++i) {
        uint32_t semantic = route->semantic[i], side = route->hand[i];
        bool is_angle = semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES;
        bool is_wrist = semantic >= MRT_CH_WRIST && semantic < MRT_CH_PEDAL;
        if (side <= MRT_RIGHT && (is_angle || is_wrist))
            out |= 1u << (2 * side + (is_wrist ? 1u : 0u));
    }
    return out;
}

static void route_version(scheduler *self, scheduler_entry *e, uint32_t version)
{
    uint32_t count;
    if (!e->source.channels)
        return;
    const mrt_channel *channels = e->source.channels(e->source.self, version, &count);
    channel_route_init(&e->route, channels, count);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        channel_route_calibrate(&e->route, side, self->calibration[side]);
    e->version = version;
    e->measures = measured_by(&e->route);
}

void scheduler_add(scheduler *self, const sample_source *source, const channel_route *route)
{
    if (self->count == STEP_SAMPLES_MAX)
        return;
    scheduler_entry *e = &self->entry[self->count++];
    *e = (scheduler_entry){.source = *source};
    if (route)
        e->route = *route;
    route_version(self, e, 0);
}

void scheduler_remove(scheduler *self, uint32_t index)
{
    if (index >= self->count)
        return;
    self->count -= 1;
    memmove(&self->entry[index], &self->entry[index + 1],
            (self->count - index) * sizeof *self->entry);
    self->is_waiting = false;
}

void scheduler_calibrate(scheduler *self, uint32_t side, const hand_calibration *calibration)
{
    self->calibration[side] = calibration;
    for (uint32_t i = 0; i < self->count; ++i)
        route_version(self, &self->entry[i], self->entry[i].version);
}

/* ---- what is there ---- */

typedef struct waiting_sample {
    bool is_there, is_over, is_chosen;
    uint32_t version;
    mrt_sample sample;
} waiting_sample;

/* The earliest, of several the first; -1: none. */
static mrt_result look(const scheduler *self, waiting_sample *out, int *out_first, error *err)
{
    *out_first = -1;
    for (uint32_t i = 0; i < self->count; ++i) {
        const sample_source *from = &self->entry[i].source;
        waiting_sample *w = &out[i];
        mrt_result result = from->peek(from->self, &w->sample, &w->version, err);
        if (result < 0)
            return result;
        w->is_there = result == MRT_OK;
        w->is_over = result == MRT_END;
        w->is_chosen = false;
        if (w->is_there && (*out_first < 0 || w->sample.time_ns < out[*out_first].sample.time_ns))
            *out_first = (int)i;
    }
    return MRT_OK;
}

/* ---- what goes together ---- */

/* Different hands, or of one hand what only the other measures. */
static bool may_pair(const scheduler_entry *a, const scheduler_entry *b)
{
    return a->measures && b->measures && !(a->measures & b->measures);
}

static int64_t shorter_period_ns(const scheduler_entry *a, const scheduler_entry *b)
{
    return a->period_ns < b->period_ns ? a->period_ns : b->period_ns;
}

/* How far apart two samples of one step may be. */
static int64_t window_ns(const scheduler_entry *a, const scheduler_entry *b)
{
    int64_t period_ns = shorter_period_ns(a, b);
    bool were_together = a->last_step > 0 && a->last_step == b->last_step;
    return were_together ? period_ns / 4 * 3 : period_ns / 2;
}

/* The sample of `e`, which is not there, ought to come soon enough to go with the first one. */
static bool is_expected(const scheduler_entry *e, const scheduler_entry *first, int64_t first_ns)
{
    return may_pair(e, first) && e->period_ns > 0 && first->period_ns > 0 && !e->is_missed &&
           e->last_ns + e->period_ns - first_ns <= window_ns(e, first);
}

/* True: until waits_until_ns something may come that goes with the first sample. */
static bool is_to_wait(scheduler *self, const waiting_sample *w, uint32_t first, int64_t now_ns)
{
    int64_t most_ns = 0;
    const scheduler_entry *of = &self->entry[first];
    for (uint32_t i = 0; i < self->count; ++i) {
        const scheduler_entry *e = &self->entry[i];
        if (w[i].is_there || w[i].is_over || !is_expected(e, of, w[first].sample.time_ns))
            continue;
        int64_t period_ns = shorter_period_ns(e, of);
        most_ns = period_ns > most_ns ? period_ns : most_ns;
    }
    if (most_ns == 0)
        return false;
    if (!self->is_waiting || self->waits_with != first ||
        self->waits_sequence != w[first].sample.sequence) {
        self->is_waiting = true;
        self->waits_with = first;
        self->waits_sequence = w[first].sample.sequence;
        self->waits_until_ns = now_ns + most_ns;
    }
    if (now_ns < self->waits_until_ns)
        return true;
    for (uint32_t i = 0; i < self->count; ++i)
        self->entry[i].is_missed |= !w[i].is_there && may_pair(&self->entry[i], of);
    return false;
}

/* As it was measured: the instant of the last sample of the step. */
static int64_t choose_measured(const scheduler *self, waiting_sample *w, uint32_t first)
{
    const scheduler_entry *of = &self->entry[first];
    int64_t first_ns = w[first].sample.time_ns, until_ns = first_ns;
    uint32_t measures = of->measures;
    w[first].is_chosen = true;
    for (uint32_t i = 0; i < self->count; ++i) {
        const scheduler_entry *e = &self->entry[i];
        if (!w[i].is_there || w[i].is_chosen || !may_pair(e, of) || (e->measures & measures) ||
            w[i].sample.time_ns - first_ns > window_ns(e, of))
            continue;
        measures |= e->measures;
        w[i].is_chosen = true;
        until_ns = w[i].sample.time_ns > until_ns ? w[i].sample.time_ns : until_ns;
    }
    for (uint32_t i = 0; i < self->count; ++i)
        if (w[i].is_there && self->entry[i].measures == 0 && w[i].sample.time_ns <= until_ns)
            w[i].is_chosen = true;
    return until_ns;
}

static int64_t choose_recorded(const scheduler *self, waiting_sample *w, uint32_t first)
{
    int64_t time_ns = w[first].sample.time_ns;
    for (uint32_t i = 0; i < self->count; ++i)
        w[i].is_chosen = w[i].is_there && w[i].sample.time_ns == time_ns;
    return time_ns;
}

static void set_time(sample_step *s, int64_t time_ns)
{
    s->time_ns = time_ns;
    for (uint32_t i = 0; i < s->count; ++i)
        s->of[i].sample.time_ns = time_ns;
}

static int64_t in_order(const scheduler *self, int64_t time_ns)
{
    if (self->step_count > 0 && time_ns <= self->last_ns)
        time_ns = self->last_ns + 1;
    return time_ns <= self->shown_ns ? self->shown_ns + 1 : time_ns;
}

mrt_result scheduler_next(scheduler *self, int64_t now_ns, sample_step *out, int64_t *out_until_ns,
                          error *err)
{
    waiting_sample w[STEP_SAMPLES_MAX];
    int first;
    bool is_over = true;
    *out_until_ns = INT64_MAX;
    out->count = 0;
    mrt_result result = look(self, w, &first, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < self->count; ++i)
        is_over &= w[i].is_over;
    if (first < 0)
        return is_over ? MRT_END : MRT_TIMEOUT;
    if (self->rule == SCHEDULE_LIVE && is_to_wait(self, w, (uint32_t)first, now_ns)) {
        *out_until_ns = self->waits_until_ns;
        return MRT_TIMEOUT;
    }
    int64_t time_ns = self->rule == SCHEDULE_RECORDED ? choose_recorded(self, w, (uint32_t)first)
                                                      : choose_measured(self, w, (uint32_t)first);
    for (uint32_t i = 0; i < self->count; ++i) {
        scheduler_entry *e = &self->entry[i];
        if (!w[i].is_chosen)
            continue;
        if (w[i].version != e->version)
            route_version(self, e, w[i].version);
        out->of[out->count++] =
            (step_sample){.input = i, .route = &e->route, .sample = w[i].sample};
    }
    out->time_ns = time_ns;
    return MRT_OK;
}

/* ---- performed ---- */

static void keep_rhythm(scheduler_entry *e, int64_t time_ns, bool is_first)
{
    int64_t since_ns = time_ns - e->last_ns;
    if (is_first || since_ns <= 0 || since_ns > period_max_ns)
        e->period_ns = 0;
    else
        e->period_ns = e->period_ns == 0 ? since_ns : e->period_ns + (since_ns - e->period_ns) / 8;
    e->last_ns = time_ns;
    e->is_missed = false;
}

void scheduler_insert(scheduler *self, sample_step *s)
{
    if (self->rule != SCHEDULE_RECORDED)
        set_time(s, in_order(self, s->time_ns));
    self->step_count += 1;
    self->sample_count += s->count;
    self->last_ns = s->time_ns;
}

void scheduler_take(scheduler *self, sample_step *s)
{
    uint64_t number = self->step_count + 1;
    for (uint32_t i = 0; i < s->count; ++i) {
        scheduler_entry *e = &self->entry[s->of[i].input];
        keep_rhythm(e, s->of[i].sample.time_ns, e->last_step == 0);
        e->last_step = number;
        e->source.take(e->source.self);
    }
    scheduler_insert(self, s);
}
