#include "stage/player.h"
#include "base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In real time, how long to sleep when nothing comes and no frame is due: how late `stop` is seen.
 */
static const int64_t idle_span_ns = 50 * NS_PER_MS;

/* A longer silence in a record is damage, not a pause: it would be hours of frames. */
static const int64_t gap_max_ns = 3600 * NS_PER_S;

typedef struct player_loop playing;
struct player_loop {
    const player_stage *stage;
    bool is_over; /* the stage says so */
    input *inputs[PLAYER_INPUTS_MAX];
    uint32_t input_count;
    player_settings settings;
    player_events events;
    player_report report;
    channel_route route[PLAYER_INPUTS_MAX];
    uint32_t route_version[PLAYER_INPUTS_MAX];
    wake signal; /* of the inputs' threads */
    bool started;
    int64_t begin_ns; /* real time: when the performance was begun, with or without samples */
    int64_t start_ns, last_ns;
    int64_t work_ns;           /* since the last drawn frame */
    int64_t shown_ns;          /* samples come behind it */
    int64_t drawn_ns, draw_ns; /* goes on: when it was drawn last, and how long that took */
    bool is_wanted;            /* goes on: to be drawn as soon as no sample waits */
};

static int64_t frame_time_ns(const playing *self, uint32_t index)
{
    return self->start_ns + (int64_t)llround((double)index * 1e9 / self->settings.fps);
}

static mrt_result draw_frame(playing *self, error *err)
{
    int64_t before = clock_now_ns();
    int64_t time_ns = frame_time_ns(self, self->report.frame_count);
    mrt_result result = self->stage->draw(self->stage->self, time_ns, err);
    if (result < 0)
        return result;
    self->is_over |= result == MRT_END;
    int64_t work_ns = self->work_ns + clock_now_ns() - before;
    self->work_ns = 0;
    uint32_t index = self->report.frame_count++;
    return self->events.frame(self->events.data, index, (double)index / self->settings.fps, work_ns,
                              err);
}

/* Frames that are late are left out: the next one is the first that is not due yet, however often
 * it is drawn before because it is wanted. */
static mrt_result draw_newest(playing *self, int64_t now_ns, error *err)
{
    double behind_s = (double)(now_ns - self->start_ns) / 1e9;
    uint32_t due = (uint32_t)fmax(floor(behind_s * self->settings.fps), 0.0);
    self->report.frame_count = due;
    self->is_wanted = false;
    mrt_result result = draw_frame(self, err);
    self->drawn_ns = clock_now_ns();
    self->draw_ns = self->drawn_ns - now_ns;
    return result;
}

/* Draws the frames whose time is before time_ns: a frame shows every sample up to its own time. */
static mrt_result draw_before(playing *self, int64_t time_ns, error *err)
{
    mrt_result result = MRT_OK;
    while (result >= 0 && !self->is_over && frame_time_ns(self, self->report.frame_count) < time_ns)
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
    return self->settings.stop && atomic_load(self->settings.stop);
}

static bool is_past_end(const playing *self, int64_t time_ns)
{
    double seconds = self->settings.seconds;
    if (!self->started && self->settings.clock == CLOCK_VIRTUAL)
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
        channel_route_calibrate(&self->route[i], side, self->settings.calibration[side]);
    self->route_version[i] = version;
}

/* Samples are performed in an order of their own, which is kept as their times: each is later than
 * the one before, if by a nanosecond. What is recorded can so be performed again in that order. */
static mrt_sample in_order(const playing *self, const mrt_sample *sample)
{
    mrt_sample out = *sample;
    if (self->report.sample_count > 0 && out.time_ns <= self->last_ns)
        out.time_ns = self->last_ns + 1;
    if (out.time_ns <= self->shown_ns)
        out.time_ns = self->shown_ns + 1;
    return out;
}

static mrt_result perform(playing *self, uint32_t from, const mrt_sample *sample, error *err)
{
    const player_events *events = &self->events;
    int64_t before = clock_now_ns();
    if (events->sample)
        events->sample(events->data, from, sample);
    mrt_result result = self->stage->sample(self->stage->self, &self->route[from], sample, err);
    if (result >= 0 && events->performed)
        events->performed(events->data, from, sample);
    self->work_ns += clock_now_ns() - before;
    return result;
}

static mrt_result check_gap(const playing *self, int from, const mrt_sample *came, error *err)
{
    if (self->settings.clock != CLOCK_VIRTUAL || self->report.sample_count == 0 ||
        came->time_ns - self->last_ns <= gap_max_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: a gap of %.0f s after sample %ju: set start or end, or split the record",
                     input_name(self->inputs[from]), (double)(came->time_ns - self->last_ns) / 1e9,
                     (uintmax_t)self->report.sample_count);
}

static mrt_result play_sample(playing *self, int from, const mrt_sample *came, error *err)
{
    if (!self->started) {
        self->started = true;
        self->start_ns = came->time_ns;
    }
    mrt_result result = check_gap(self, from, came, err);
    if (result < 0)
        return result;
    mrt_sample sample = in_order(self, came);
    if (!self->settings.goes_on)
        result = draw_before(self, sample.time_ns, err);
    if (result < 0 || self->is_over)
        return result;
    result = perform(self, (uint32_t)from, &sample, err);
    if (result < 0)
        return result;
    self->report.sample_count += 1;
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
        int64_t due = frame_time_ns(self, self->report.frame_count);
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
            self->report.went_count += incident.kind == INPUT_WENT;
            self->report.came_count += incident.kind == INPUT_CAME;
            self->report.away_s += (double)incident.away_ns / 1e9;
            if (self->events.incident)
                self->events.incident(self->events.data, self->inputs[i], &incident,
                                      (double)(incident.time_ns - from_ns) / 1e9);
        }
}

/* The sample of `from` that was peeked. */
static mrt_result take_sample(playing *self, int from, const mrt_sample *sample, uint32_t version,
                              error *err)
{
    if (version != self->route_version[from])
        route_input(self, (uint32_t)from, version);
    input_take(self->inputs[from]);
    return play_sample(self, from, sample, err);
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
            result = take_sample(self, from, &sample, version, err);
        } else if (over || self->settings.clock == CLOCK_VIRTUAL ||
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

/* ---- a stage that goes on ---- */

static int64_t next_frame_ns(const playing *self)
{
    return frame_time_ns(self, self->report.frame_count);
}

/* While samples wait, drawing gets a quarter of the time: what is slow to draw is drawn seldom, and
 * every sample is performed in time. */
static bool may_be_drawn(const playing *self, bool has_samples, int64_t now_ns)
{
    return !has_samples || now_ns - self->drawn_ns >= 3 * self->draw_ns;
}

/* With no sample waiting the stage is drawn when it is wanted, else when it is due. */
static mrt_result go_on(playing *self, error *err)
{
    mrt_sample sample;
    uint32_t seen = wake_seen(&self->signal), version = 0;
    if (self->events.turn)
        self->is_wanted |= self->events.turn(self->events.data);
    int from = earliest(self, &sample, &version);
    tell_incidents(self);
    mrt_result result = MRT_OK;
    if (from >= 0)
        result = take_sample(self, from, &sample, version, err);
    int64_t now_ns = clock_now_ns();
    bool is_time = now_ns >= next_frame_ns(self) || (from < 0 && self->is_wanted);
    if (result >= 0 && is_time && may_be_drawn(self, from >= 0, now_ns))
        return draw_newest(self, now_ns, err);
    if (from < 0 && result >= 0)
        wake_wait_until_ns(&self->signal, seen, next_frame_ns(self));
    return result;
}

mrt_result player_go_on(player_loop *self, error *err)
{
    mrt_result result = MRT_OK;
    self->begin_ns = self->start_ns = clock_now_ns();
    self->started = true;
    while (result >= 0 && !is_stopped(self))
        result = go_on(self, err);
    return result;
}

wake *player_wake(player_loop *self)
{
    return &self->signal;
}

void player_add_input(player_loop *self, input *in)
{
    if (self->input_count == PLAYER_INPUTS_MAX)
        return;
    self->inputs[self->input_count++] = in;
    route_input(self, self->input_count - 1, 0);
}

void player_remove_input(player_loop *self, uint32_t index)
{
    if (index >= self->input_count)
        return;
    self->input_count -= 1;
    for (uint32_t i = index; i < self->input_count; ++i) {
        self->inputs[i] = self->inputs[i + 1];
        self->route[i] = self->route[i + 1];
        self->route_version[i] = self->route_version[i + 1];
    }
}

input *player_input(player_loop *self, uint32_t index)
{
    return self->inputs[index];
}

void player_calibrate(player_loop *self, uint32_t side, const hand_calibration *calibration)
{
    self->settings.calibration[side] = calibration;
    for (uint32_t i = 0; i < self->input_count; ++i)
        route_input(self, i, self->route_version[i]);
}

mrt_result player_give(player_loop *self, uint32_t index, const mrt_sample *sample, error *err)
{
    return play_sample(self, (int)index, sample, err);
}

void player_show_until(player_loop *self, int64_t time_ns)
{
    if (time_ns > self->shown_ns)
        self->shown_ns = time_ns;
}

static mrt_result check_fps(const player_settings *settings, error *err)
{
    if (settings->fps > 0 && settings->fps <= 1000)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%g frames a second, 0 to 1000 are possible",
                     settings->fps);
}

mrt_result player_create(player_loop **out, const player_stage *stage,
                         const player_settings *settings, const player_events *events, error *err)
{
    *out = NULL;
    mrt_result result = check_fps(settings, err);
    if (result < 0)
        return result;
    player_loop *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to perform");
    self->stage = stage;
    self->settings = *settings;
    self->settings.goes_on = true;
    self->shown_ns = INT64_MIN;
    self->events = *events;
    wake_init(&self->signal);
    *out = self;
    return MRT_OK;
}

void player_destroy(player_loop *self)
{
    free(self);
}

/* ---- one that ends with its inputs ---- */

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
    mrt_result result = check_fps(settings, err);
    if (result < 0)
        return result;
    playing self = {.stage = stage,
                    .input_count = input_count,
                    .settings = *settings,
                    .events = *events,
                    .shown_ns = INT64_MIN};
    memcpy(self.inputs, inputs, input_count * sizeof(input *));
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
        self.report.input_failed |= input_state_of(inputs[i]) == INPUT_FAILED;
        self.report.dropped += input_dropped(inputs[i]);
        self.report.refused += input_refused(inputs[i]);
    }
    if (self.started)
        self.report.duration_s = (double)(self.last_ns - self.start_ns) / 1e9;
    *out_report = self.report;
    return result;
}
