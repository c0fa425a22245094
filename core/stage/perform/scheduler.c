#include "stage/perform/scheduler.h"
#include "base/clock.h"

#include <string.h>

void scheduler_init(scheduler *out, scheduler_rule rule, scheduler_entry *entry,
                    channel_route *route, uint32_t capacity)
{
    *out = (scheduler){.rule = rule, .entry = entry, .route = route, .capacity = capacity};
    out->last_ns = out->shown_ns = INT64_MIN;
}

/* ---- sources ---- */

static uint32_t measured_by(const channel_route *route)
{
    uint32_t out = 0;
    for (uint32_t i = 0; i < route->table.count; ++i)
        out |= step_measures(route->table.channel[i].semantic, route->table.channel[i].hand);
    return out;
}

static void route_version(scheduler *self, uint32_t index, uint32_t version)
{
    uint32_t count;
    scheduler_entry *e = &self->entry[index];
    if (!e->source.channels)
        return;
    channel_route *route = &self->route[index];
    const mrt_channel *channels = e->source.channels(e->source.self, version, &count);
    channel_route_init(route, channels, count);
    channel_route_call(route, e->source.name);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        channel_route_calibrate(route, side, self->calibration[side]);
    e->route = route;
    e->version = version;
    e->rhythm.measures = measured_by(route);
}

void scheduler_add(scheduler *self, const sample_source *source, const channel_route *route)
{
    uint32_t of_voice = 0;
    for (uint32_t i = 0; i < self->count; ++i)
        of_voice += self->entry[i].source.voice == source->voice;
    if (self->count == self->capacity || of_voice == STEP_SAMPLES_MAX)
        return;
    self->entry[self->count] = (scheduler_entry){.source = *source, .route = route};
    self->count += 1;
    route_version(self, self->count - 1, 0);
}

void scheduler_remove(scheduler *self, uint32_t index)
{
    if (index >= self->count)
        return;
    self->count -= 1;
    memmove(&self->entry[index], &self->entry[index + 1],
            (self->count - index) * sizeof *self->entry);
    for (uint32_t i = index; i < self->count; ++i)
        route_version(self, i, self->entry[i].version);
    self->is_waiting = false;
}

void scheduler_clear(scheduler *self)
{
    self->count = 0;
    self->is_waiting = false;
}

void scheduler_calibrate(scheduler *self, uint32_t side, const hand_calibration *calibration)
{
    self->calibration[side] = calibration;
    for (uint32_t i = 0; i < self->count; ++i)
        route_version(self, i, self->entry[i].version);
}

/* ---- available samples ---- */

static bool is_before(const scheduler_entry *a, const scheduler_entry *b)
{
    if (a->due_ns != b->due_ns)
        return a->due_ns < b->due_ns;
    return a->source.voice == b->source.voice && a->sample.time_ns < b->sample.time_ns;
}

static mrt_result query_source(scheduler_entry *e, error *err)
{
    const sample_source *from = &e->source;
    mrt_result result = from->peek(from->self, &e->sample, &e->next_version, err);
    if (result < 0)
        return result;
    e->is_there = result == MRT_OK;
    e->is_over = result == MRT_END;
    e->is_chosen = false;
    if (!e->is_there)
        return MRT_OK;
    e->due_ns = from->due_ns ? from->due_ns(from->clock, e->sample.time_ns) : e->sample.time_ns;
    if (e->due_ns == INT64_MAX) {
        e->is_there = false;
        e->is_over = true;
    }
    return MRT_OK;
}

/* Queries all sources and finds the earliest sample; of equal ones the first. NULL: none. */
static mrt_result query_sources(scheduler *self, scheduler_entry **out_first, error *err)
{
    *out_first = NULL;
    for (uint32_t i = 0; i < self->count; ++i) {
        scheduler_entry *e = &self->entry[i];
        mrt_result result = query_source(e, err);
        if (result < 0)
            return result;
        if (e->is_there && (!*out_first || is_before(e, *out_first)))
            *out_first = e;
    }
    return MRT_OK;
}

/* ---- choosing the samples of a step ---- */

static bool may_pair(const scheduler_entry *a, const scheduler_entry *b)
{
    return a->source.voice == b->source.voice && step_may_pair(&a->rhythm, &b->rhythm);
}

/* Returns whether the next sample of `e`, which has none now, should arrive in time to join the
 * first one. */
static bool is_expected(const scheduler_entry *e, const scheduler_entry *first, int64_t first_ns)
{
    const step_rhythm *r = &e->rhythm;
    return may_pair(e, first) && r->period_ns > 0 && first->rhythm.period_ns > 0 && !e->is_missed &&
           r->last_ns + r->period_ns - first_ns <= step_window_ns(r, &first->rhythm);
}

/* Returns true while a sample may still arrive that joins the first one, at most until
 * waits_until_ns. */
static bool must_wait(scheduler *self, const scheduler_entry *first, int64_t now_ns)
{
    int64_t most_ns = 0;
    uint32_t index = (uint32_t)(first - self->entry);
    for (uint32_t i = 0; i < self->count; ++i) {
        const scheduler_entry *e = &self->entry[i];
        if (e->is_there || e->is_over || !is_expected(e, first, first->sample.time_ns))
            continue;
        int64_t period_ns = step_shorter_period_ns(&e->rhythm, &first->rhythm);
        most_ns = period_ns > most_ns ? period_ns : most_ns;
    }
    if (most_ns == 0)
        return false;
    if (!self->is_waiting || self->waits_with != index ||
        self->waits_sequence != first->sample.sequence) {
        self->is_waiting = true;
        self->waits_with = index;
        self->waits_sequence = first->sample.sequence;
        self->waits_until_ns = now_ns + most_ns;
    }
    if (now_ns < self->waits_until_ns)
        return true;
    for (uint32_t i = 0; i < self->count; ++i)
        self->entry[i].is_missed |= !self->entry[i].is_there && may_pair(&self->entry[i], first);
    return false;
}

/* Chooses the samples by the times at which they were measured. Returns the time of the last sample
 * of the step. */
static int64_t choose_measured(scheduler *self, scheduler_entry *first)
{
    step_choice choice = step_choice_of(&first->rhythm, first->sample.time_ns);
    for (uint32_t i = 0; i < self->count; ++i) {
        scheduler_entry *e = &self->entry[i];
        e->is_chosen = e == first || (e->is_there && e->source.voice == first->source.voice &&
                                      step_choice_pairs(&choice, &e->rhythm, e->sample.time_ns));
    }
    for (uint32_t i = 0; i < self->count; ++i) {
        scheduler_entry *e = &self->entry[i];
        e->is_chosen |= e->is_there && e->source.voice == first->source.voice &&
                        step_choice_covers(&choice, &e->rhythm, e->sample.time_ns);
    }
    return choice.until_ns;
}

static int64_t choose_recorded(scheduler *self, const scheduler_entry *first)
{
    int64_t time_ns = first->sample.time_ns;
    for (uint32_t i = 0; i < self->count; ++i) {
        scheduler_entry *e = &self->entry[i];
        e->is_chosen =
            e->is_there && e->sample.time_ns == time_ns && e->source.voice == first->source.voice;
    }
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
    scheduler_entry *first;
    bool is_over = true;
    *out_until_ns = INT64_MAX;
    out->count = 0;
    mrt_result result = query_sources(self, &first, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < self->count; ++i)
        is_over &= self->entry[i].is_over;
    if (!first)
        return is_over ? MRT_END : MRT_TIMEOUT;
    if (self->rule == SCHEDULE_LIVE && must_wait(self, first, now_ns)) {
        *out_until_ns = self->waits_until_ns;
        return MRT_TIMEOUT;
    }
    out->time_ns = self->rule == SCHEDULE_RECORDED ? choose_recorded(self, first)
                                                   : in_order(self, choose_measured(self, first));
    out->voice = first->source.voice;
    out->due_ns = first->due_ns;
    for (uint32_t i = 0; i < self->count; ++i) {
        scheduler_entry *e = &self->entry[i];
        if (!e->is_chosen)
            continue;
        if (e->next_version != e->version)
            route_version(self, i, e->next_version);
        out->of[out->count++] = (step_sample){.input = i, .route = e->route, .sample = e->sample};
    }
    return MRT_OK;
}

/* ---- consuming a step ---- */

void scheduler_insert(scheduler *self, sample_step *s)
{
    set_time(s, self->rule == SCHEDULE_RECORDED ? s->time_ns : in_order(self, s->time_ns));
    if (self->rule != SCHEDULE_RECORDED)
        s->due_ns = s->time_ns; /* a replay of the step is due at its recorded time */
    self->step_count += 1;
    self->sample_count += s->count;
    self->last_ns = s->time_ns;
}

void scheduler_consume(scheduler *self, sample_step *s)
{
    uint64_t number = self->step_count + 1;
    for (uint32_t i = 0; i < s->count; ++i) {
        scheduler_entry *e = &self->entry[s->of[i].input];
        step_rhythm_record(&e->rhythm, s->of[i].sample.time_ns, number);
        e->is_missed = false;
        e->source.take(e->source.self);
    }
    scheduler_insert(self, s);
}
