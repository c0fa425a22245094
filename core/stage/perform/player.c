#include "stage/perform/player.h"
#include "base/clock.h"
#include "stage/perform/scheduler.h"

#include <math.h>
#include <stdlib.h>

/* Longest sleep in real time without samples and frames; limits the delay until `stop` takes
 * effect. */
static const int64_t idle_span_ns = 50 * NS_PER_MS;

/* A longer gap in a recording counts as damage: it would be drawn as hours of frames. */
static const int64_t gap_max_ns = 3600 * NS_PER_S;

struct player_loop {
    stage_frame *frame;
    bool is_endless; /* player_run_live: does not end with the inputs, skips late frames */
    bool is_over;    /* a drawn frame returned MRT_END */
    input *inputs[PLAYER_INPUTS_MAX];
    uint32_t input_count;
    player_settings settings;
    player_events events;
    player_report report;
    scheduler scheduler;
    scheduler_entry entry[PLAYER_INPUTS_MAX];
    channel_route route[PLAYER_INPUTS_MAX];
    wake signal; /* set by the threads of the inputs */
    bool started;
    int64_t begin_ns; /* real time: start of the performance, even without samples */
    int64_t start_ns;
    int64_t work_ns;           /* spent on steps since the last drawn frame */
    int64_t drawn_ns, draw_ns; /* player_run_live: end and duration of the last drawing */
    bool is_wanted;            /* player_run_live: draw as soon as no sample waits */
};

static int64_t frame_time_ns(const player_loop *self, uint32_t index)
{
    return self->start_ns + (int64_t)llround((double)index * 1e9 / self->settings.fps);
}

static mrt_result draw_frame(player_loop *self, error *err)
{
    int64_t before = clock_now_ns();
    int64_t time_ns = frame_time_ns(self, self->report.frame_count);
    mrt_result result = self->events.draw ? self->events.draw(self->events.data, time_ns, err)
                                          : frame_draw(self->frame, time_ns, err);
    if (result < 0)
        return result;
    self->is_over |= result == MRT_END;
    int64_t work_ns = self->work_ns + clock_now_ns() - before;
    self->work_ns = 0;
    uint32_t index = self->report.frame_count++;
    if (!self->events.frame)
        return MRT_OK;
    return self->events.frame(self->events.data, index, (double)index / self->settings.fps, work_ns,
                              err);
}

/* Skips late frames: the next frame number is the first that is not due yet. `between` may request
 * several drawings of one frame number. */
static mrt_result draw_newest(player_loop *self, int64_t now_ns, error *err)
{
    double behind_s = (double)(now_ns - self->start_ns) / 1e9;
    uint32_t due = (uint32_t)fmax(floor(behind_s * self->settings.fps), 0.0);
    if (frame_time_ns(self, due + 1) <=
        now_ns) /* exact; the rounded value can be one frame short */
        due += 1;
    self->report.frame_count = due;
    self->is_wanted = false;
    mrt_result result = draw_frame(self, err);
    self->drawn_ns = clock_now_ns();
    self->draw_ns = self->drawn_ns - now_ns;
    return result;
}

/* Draws all frames before time_ns. A frame shows every sample up to its own time. */
static mrt_result draw_before(player_loop *self, int64_t time_ns, error *err)
{
    mrt_result result = MRT_OK;
    while (result >= 0 && !self->is_over && frame_time_ns(self, self->report.frame_count) < time_ns)
        result = draw_frame(self, err);
    return result;
}

static bool is_stopped(const player_loop *self)
{
    return self->settings.stop && atomic_load(self->settings.stop);
}

static bool is_past_end(const player_loop *self, int64_t time_ns)
{
    double seconds = self->settings.seconds;
    if (!self->started && self->settings.clock == CLOCK_VIRTUAL)
        return false;
    int64_t from_ns = self->started ? self->start_ns : self->begin_ns;
    return seconds > 0 && (double)(time_ns - from_ns) >= seconds * 1e9;
}

static mrt_result check_gap(const player_loop *self, const sample_step *next, error *err)
{
    const scheduler *of = &self->scheduler;
    if (self->settings.clock != CLOCK_VIRTUAL || of->step_count == 0 ||
        next->time_ns - of->last_ns <= gap_max_ns)
        return MRT_OK;
    return error_set(
        err, MRT_ERR_FORMAT,
        "%s: a gap of %.0f s after sample %ju. Set start or end, or split the recording",
        input_name(self->inputs[next->of[0].input]), (double)(next->time_ns - of->last_ns) / 1e9,
        (uintmax_t)of->sample_count);
}

/* Performs the step in frame->step. Frames that are due before it are drawn first. */
static mrt_result play_step(player_loop *self, error *err)
{
    const sample_step *s = &self->frame->step;
    mrt_result result = check_gap(self, s, err);
    if (!self->started)
        self->start_ns = s->time_ns;
    self->started = true;
    if (result >= 0 && !self->is_endless)
        result = draw_before(self, s->time_ns, err);
    if (result < 0 || self->is_over)
        return result;
    int64_t before = clock_now_ns();
    result = frame_step(self->frame, err);
    self->work_ns += clock_now_ns() - before;
    self->report.sample_count += result >= 0 ? s->count : 0;
    self->report.step_count += result >= 0;
    return result;
}

/* Called in real time when no step is ready. Draws the frames that are due, or sleeps until a
 * sample arrives, at most until until_ns. */
static mrt_result idle(player_loop *self, uint32_t seen, int64_t until_ns, error *err)
{
    int64_t now = clock_now_ns();
    int64_t until = until_ns < now + idle_span_ns ? until_ns : now + idle_span_ns;
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

static void report_incidents(player_loop *self)
{
    input_incident incident;
    for (uint32_t i = 0; i < self->input_count; ++i)
        while (input_pop_incident(self->inputs[i], &incident)) {
            int64_t from_ns = self->started ? self->start_ns : self->begin_ns;
            self->report.went_count += incident.kind == INPUT_WAS_LOST;
            self->report.returned_count += incident.kind == INPUT_IS_BACK;
            self->report.away_s += (double)incident.away_ns / 1e9;
            if (self->events.incident)
                self->events.incident(self->events.data, self->inputs[i], &incident,
                                      (double)(incident.time_ns - from_ns) / 1e9);
        }
}

static mrt_result play(player_loop *self, error *err)
{
    mrt_result result = MRT_OK;
    while (result >= 0 && !is_stopped(self) && !self->is_over) {
        sample_step *next = &self->frame->step;
        int64_t until_ns;
        uint32_t seen = wake_seen(&self->signal);
        mrt_result found = scheduler_next(&self->scheduler, clock_now_ns(), next, &until_ns, err);
        report_incidents(self);
        if (found == MRT_OK) {
            if (is_past_end(self, next->time_ns))
                break;
            result = play_step(self, err);
        } else if (found != MRT_TIMEOUT || is_past_end(self, clock_now_ns())) {
            result = found < 0 ? found : MRT_OK;
            break;
        } else {
            result = idle(self, seen, until_ns, err);
        }
    }
    /* The last samples need a frame too. */
    if (result >= 0 && self->started)
        result = draw_before(self, self->scheduler.last_ns + 1, err);
    return result;
}

/* ---- with or without inputs ---- */

static int64_t next_frame_ns(const player_loop *self)
{
    return frame_time_ns(self, self->report.frame_count);
}

/* Limits drawing to a quarter of the time while samples wait. A face that is slow to draw is drawn
 * less often, but every sample is performed in time. */
static bool may_be_drawn(const player_loop *self, bool has_samples, int64_t now_ns)
{
    return !has_samples || now_ns - self->drawn_ns >= 3 * self->draw_ns;
}

/* Performs a step if one is ready. Draws at the frame rate, or when `between` requested it and no
 * step waits. */
static mrt_result perform_or_draw(player_loop *self, error *err)
{
    int64_t until_ns;
    uint32_t seen = wake_seen(&self->signal);
    if (self->events.between)
        self->is_wanted |= self->events.between(self->events.data);
    mrt_result result =
        scheduler_next(&self->scheduler, clock_now_ns(), &self->frame->step, &until_ns, err);
    bool has_step = result == MRT_OK;
    report_incidents(self);
    if (has_step)
        result = play_step(self, err);
    int64_t now_ns = clock_now_ns();
    bool is_time = now_ns >= next_frame_ns(self) || (!has_step && self->is_wanted);
    if (result >= 0 && is_time && may_be_drawn(self, has_step, now_ns))
        return draw_newest(self, now_ns, err);
    int64_t frame_ns = next_frame_ns(self);
    if (!has_step && result >= 0)
        wake_wait_until_ns(&self->signal, seen, frame_ns < until_ns ? frame_ns : until_ns);
    return result;
}

mrt_result player_run_live(player_loop *self, error *err)
{
    mrt_result result = MRT_OK;
    self->begin_ns = self->start_ns = clock_now_ns();
    self->started = true;
    while (result >= 0 && !is_stopped(self))
        result = perform_or_draw(self, err);
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
    const sample_source source = input_source(in);
    self->inputs[self->input_count++] = in;
    scheduler_add(&self->scheduler, &source, NULL);
}

void player_remove_input(player_loop *self, uint32_t index)
{
    if (index >= self->input_count)
        return;
    self->input_count -= 1;
    for (uint32_t i = index; i < self->input_count; ++i)
        self->inputs[i] = self->inputs[i + 1];
    scheduler_remove(&self->scheduler, index);
}

input *player_input(player_loop *self, uint32_t index)
{
    return self->inputs[index];
}

void player_calibrate(player_loop *self, uint32_t side, const hand_calibration *calibration)
{
    scheduler_calibrate(&self->scheduler, side, calibration);
}

mrt_result player_perform_sample(player_loop *self, uint32_t index, const mrt_sample *sample,
                                 error *err)
{
    stage_frame *f = self->frame;
    f->step = sample_step_of(self->scheduler.entry[index].route, sample);
    f->step.of[0].input = index;
    scheduler_insert(&self->scheduler, &f->step);
    f->sources = NULL; /* the step comes from no source */
    mrt_result result = play_step(self, err);
    f->sources = &self->scheduler;
    return result;
}

void player_show_until(player_loop *self, int64_t time_ns)
{
    if (time_ns > self->scheduler.shown_ns)
        self->scheduler.shown_ns = time_ns;
}

static void init(player_loop *self, stage_frame *f, const player_settings *settings,
                 const player_events *events)
{
    *self = (player_loop){.frame = f, .settings = *settings, .events = *events};
    f->sources = &self->scheduler;
    scheduler_init(&self->scheduler,
                   settings->clock == CLOCK_VIRTUAL ? SCHEDULE_MEASURED : SCHEDULE_LIVE,
                   self->entry, self->route, PLAYER_INPUTS_MAX);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        scheduler_calibrate(&self->scheduler, side, settings->calibration[side]);
    wake_init(&self->signal);
}

static mrt_result check_fps(const player_settings *settings, error *err)
{
    if (settings->fps > 0 && settings->fps <= 1000)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%g frames per second: must be above 0 and at most 1000", settings->fps);
}

mrt_result player_create(player_loop **out, stage_frame *f, const player_settings *settings,
                         const player_events *events, error *err)
{
    *out = NULL;
    mrt_result result = check_fps(settings, err);
    if (result < 0)
        return result;
    player_loop *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to perform");
    init(self, f, settings, events);
    self->is_endless = true;
    *out = self;
    return MRT_OK;
}

void player_destroy(player_loop *self)
{
    free(self);
}

/* ---- until the inputs end ---- */

mrt_result player_run_stage(stage_frame *f, input *const *inputs, uint32_t input_count,
                            const player_settings *settings, const player_events *events,
                            player_report *out_report, error *err)
{
    *out_report = (player_report){0};
    if (input_count == 0 || input_count > PLAYER_INPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u inputs: 1 to %d are allowed", input_count,
                         PLAYER_INPUTS_MAX);
    mrt_result result = check_fps(settings, err);
    if (result < 0)
        return result;
    player_loop self;
    init(&self, f, settings, events);
    self.begin_ns = settings->clock == CLOCK_REAL ? clock_now_ns() : 0;
    for (uint32_t i = 0; i < input_count && result >= 0; ++i) {
        player_add_input(&self, inputs[i]);
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
        self.report.duration_s = (double)(self.scheduler.last_ns - self.start_ns) / 1e9;
    *out_report = self.report;
    f->sources = NULL;
    return result;
}
