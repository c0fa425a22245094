#include "stage/player.h"
#include "base/clock.h"

#include <math.h>

/* In real time, how long to sleep when nothing comes and no frame is due: how late `stop` is seen.
 */
static const int64_t idle_span_ns = 50 * NS_PER_MS;

/* A longer silence in a record is damage, not a pause: it would be hours of frames. */
static const int64_t gap_max_ns = 3600 * NS_PER_S;

typedef struct playing {
    const player_stage *stage;
    bool is_over; /* the stage says so */
    input *const *inputs;
    uint32_t input_count;
    const player_settings *settings;
    const player_events *events;
    player_report *report;
    channel_route route[PLAYER_INPUTS_MAX];
    uint32_t route_version[PLAYER_INPUTS_MAX];
    wake signal; /* of the inputs' threads */
    bool started;
    int64_t begin_ns; /* real time: when the performance was begun, with or without samples */
    int64_t start_ns, last_ns;
    int64_t work_ns; /* since the last drawn frame */
} playing;

static int64_t frame_time_ns(const playing *self, uint32_t index)
{
    return self->start_ns + (int64_t)llround((double)index * 1e9 / self->settings->fps);
}

static mrt_result draw_frame(playing *self, error *err)
{
    int64_t before = clock_now_ns();
    int64_t time_ns = frame_time_ns(self, self->report->frame_count);
    mrt_result result = self->stage->draw(self->stage->self, time_ns, err);
    if (result < 0)
        return result;
    self->is_over |= result == MRT_END;
    int64_t work_ns = self->work_ns + clock_now_ns() - before;
    self->work_ns = 0;
    uint32_t index = self->report->frame_count++;
    return self->events->frame(self->events->data, index, (double)index / self->settings->fps,
                               work_ns, err);
}

/* Draws the frames whose time is before time_ns: a frame shows every sample up to its own time. */
static mrt_result draw_before(playing *self, int64_t time_ns, error *err)
{
    mrt_result result = MRT_OK;
    while (result >= 0 && !self->is_over &&
           frame_time_ns(self, self->report->frame_count) < time_ns)
        result = draw_frame(self, err);
    return result;
}

/* The input with the earliest sample, or -1. */
static int earliest(const playing *self, mrt_sample *out, uint32_t *out_version)
{
    int found = -1;
    for (uint32_t i = 0; i < self->input_count; ++i) {
        mrt_sample sample;
        if (!input_peek(self->inputs[i], &sample))
            continue;
        if (found < 0 || sample.time_ns < out->time_ns) {
            *out = sample;
            *out_version = input_version(self->inputs[i]);
            found = (int)i;
        }
    }
    return found;
}

static bool are_over(const playing *self)
{
    for (uint32_t i = 0; i < self->input_count; ++i) {
        input_state state = input_state_of(self->inputs[i]);
        if (state == INPUT_RUNNING || state == INPUT_LOST)
            return false;
    }
    return true;
}

static bool is_stopped(const playing *self)
{
    return self->settings->stop && atomic_load(self->settings->stop);
}

static bool is_past_end(const playing *self, int64_t time_ns)
{
    double seconds = self->settings->seconds;
    if (!self->started && self->settings->clock == CLOCK_VIRTUAL)
        return false;
    int64_t from_ns = self->started ? self->start_ns : self->begin_ns;
    return seconds > 0 && (double)(time_ns - from_ns) >= seconds * 1e9;
}

static void route_input(playing *self, uint32_t i, uint32_t version)
{
    uint32_t count;
    const mrt_channel *channels = input_channels_of(self->inputs[i], version, &count);
    channel_route_init(&self->route[i], channels, count);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        channel_route_calibrate(&self->route[i], side, self->settings->calibration[side]);
    self->route_version[i] = version;
}

/* Samples are performed in an order of their own, which is kept as their times: each is later than
 * the one before, if by a nanosecond. What is recorded can so be performed again in that order. */
static mrt_sample in_order(const playing *self, const mrt_sample *sample)
{
    mrt_sample out = *sample;
    if (self->report->sample_count > 0 && out.time_ns <= self->last_ns)
        out.time_ns = self->last_ns + 1;
    return out;
}

static mrt_result perform(playing *self, uint32_t from, const mrt_sample *sample, error *err)
{
    const player_events *events = self->events;
    int64_t before = clock_now_ns();
    if (events->sample)
        events->sample(events->data, from, sample);
    mrt_result result = self->stage->sample(self->stage->self, &self->route[from], sample, err);
    if (result >= 0 && events->performed)
        events->performed(events->data, from, sample);
    self->work_ns += clock_now_ns() - before;
    return result;
}

static mrt_result play_sample(playing *self, int from, const mrt_sample *came, error *err)
{
    if (!self->started) {
        self->started = true;
        self->start_ns = came->time_ns;
    }
    if (self->settings->clock == CLOCK_VIRTUAL && self->report->sample_count > 0 &&
        came->time_ns - self->last_ns > gap_max_ns)
        return error_set(
            err, MRT_ERR_FORMAT,
            "%s: a gap of %.0f s after sample %ju: set start or end, or split the record",
            input_name(self->inputs[from]), (double)(came->time_ns - self->last_ns) / 1e9,
            (uintmax_t)self->report->sample_count);
    mrt_sample sample = in_order(self, came);
    mrt_result result = draw_before(self, sample.time_ns, err);
    if (result < 0 || self->is_over)
        return result;
    result = perform(self, (uint32_t)from, &sample, err);
    if (result < 0)
        return result;
    self->report->sample_count += 1;
    self->last_ns = sample.time_ns;
    return MRT_OK;
}

/* Real time, nothing to play since `seen`: draws what is due, or sleeps until there is something.
 */
static mrt_result idle(playing *self, uint32_t seen, error *err)
{
    int64_t now = clock_now_ns();
    int64_t until = now + idle_span_ns;
    if (self->started) {
        int64_t due = frame_time_ns(self, self->report->frame_count);
        if (due < now)
            return draw_before(self, now, err);
        if (due < until)
            until = due + 1;
    }
    wake_wait_until_ns(&self->signal, seen, until);
    return MRT_OK;
}

static void tell_incidents(playing *self)
{
    input_incident incident;
    for (uint32_t i = 0; i < self->input_count; ++i)
        while (input_take_incident(self->inputs[i], &incident)) {
            int64_t from_ns = self->started ? self->start_ns : self->begin_ns;
            self->report->went_count += incident.kind == INPUT_WENT;
            self->report->came_count += incident.kind == INPUT_CAME;
            self->report->away_s += (double)incident.away_ns / 1e9;
            if (self->events->incident)
                self->events->incident(self->events->data, self->inputs[i], &incident,
                                       (double)(incident.time_ns - from_ns) / 1e9);
        }
}

static mrt_result play(playing *self, error *err)
{
    mrt_result result = MRT_OK;
    while (result >= 0 && !is_stopped(self) && !self->is_over) {
        mrt_sample sample;
        uint32_t seen = wake_seen(&self->signal);
        bool over = are_over(self); /* asked first: what came before the end is still in a ring */
        uint32_t version = 0;
        int from = earliest(self, &sample, &version);
        tell_incidents(self);
        if (from >= 0) {
            if (is_past_end(self, sample.time_ns))
                break;
            if (version != self->route_version[from])
                route_input(self, (uint32_t)from, version);
            input_take(self->inputs[from]);
            result = play_sample(self, from, &sample, err);
        } else if (over || self->settings->clock == CLOCK_VIRTUAL ||
                   is_past_end(self, clock_now_ns())) {
            break;
        } else {
            result = idle(self, seen, err);
        }
    }
    /* The last samples are shown too. */
    if (result >= 0 && self->started)
        result = draw_before(self, self->last_ns + 1, err);
    return result;
}

static mrt_result sample_performer(void *self, const channel_route *route, const mrt_sample *sample,
                                   error *err)
{
    (void)err;
    performer_sample(self, route, sample);
    return MRT_OK;
}

static mrt_result draw_performer(void *self, int64_t time_ns, error *err)
{
    (void)time_ns;
    (void)err;
    performer_draw(self);
    return MRT_OK;
}

player_stage player_stage_of(performer *p)
{
    return (player_stage){p, sample_performer, draw_performer};
}

mrt_result player_run(performer *p, input *const *inputs, uint32_t input_count,
                      const player_settings *settings, const player_events *events,
                      player_report *out_report, error *err)
{
    const player_stage stage = player_stage_of(p);
    return player_run_stage(&stage, inputs, input_count, settings, events, out_report, err);
}

mrt_result player_run_stage(const player_stage *stage, input *const *inputs, uint32_t input_count,
                            const player_settings *settings, const player_events *events,
                            player_report *out_report, error *err)
{
    *out_report = (player_report){0};
    if (input_count == 0 || input_count > PLAYER_INPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u inputs were given, 1 to %d are possible",
                         input_count, PLAYER_INPUTS_MAX);
    if (!(settings->fps > 0) || !(settings->fps <= 1000))
        return error_set(err, MRT_ERR_ARGUMENT, "%g frames a second, 0 to 1000 are possible",
                         settings->fps);
    playing self = {.stage = stage,
                    .inputs = inputs,
                    .input_count = input_count,
                    .settings = settings,
                    .events = events,
                    .report = out_report};
    mrt_result result = MRT_OK;
    wake_init(&self.signal);
    self.begin_ns = settings->clock == CLOCK_REAL ? clock_now_ns() : 0;
    for (uint32_t i = 0; i < input_count && result >= 0; ++i) {
        route_input(&self, i, 0);
        input_set_wake(inputs[i], &self.signal);
        result = input_start(inputs[i], err);
    }
    if (result >= 0)
        result = play(&self, err);
    for (uint32_t i = 0; i < input_count; ++i) {
        input_stop(inputs[i]);
        input_set_wake(inputs[i], NULL);
        out_report->dropped += input_dropped(inputs[i]);
        out_report->refused += input_refused(inputs[i]);
        out_report->input_failed |= input_state_of(inputs[i]) == INPUT_FAILED;
    }
    if (self.started)
        out_report->duration_s = (double)(self.last_ns - self.start_ns) / 1e9;
    return result;
}
