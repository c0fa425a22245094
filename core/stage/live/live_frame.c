/* The frame thread: samples are performed and recorded, the newest face is published. */
#include "base/clock.h"
#include "stage/live/live_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const int64_t meter_span_ns = 250 * NS_PER_MS;
/* Between two faces of which nobody takes the first: many inputs do not fill the thread. */
static const int64_t least_apart_ns = 4 * NS_PER_MS;

static double ms_since(int64_t *from_ns)
{
    int64_t now_ns = clock_now_ns();
    double out = (double)(now_ns - *from_ns) / (double)NS_PER_MS;
    *from_ns = now_ns;
    return out;
}

/* ---- steps ---- */

static mrt_result on_stage_step(void *data, const sample_step *s, error *err)
{
    live *self = data;
    live_stage *stage = &self->stage;
    int64_t at_ns = clock_now_ns();
    mrt_result result = MRT_OK;
    stage->is_dirty = true;
    if (stage->mode == LIVE_OVERDUBS) {
        result = live_time_step(stage, s, err);
        stage->step_ms[LIVE_STEP_MAP] += ms_since(&at_ns);
        return result;
    }
    performer_map(stage->scene->performer, s);
    stage->step_ms[LIVE_STEP_MAP] += ms_since(&at_ns);
    performer_constrain(stage->scene->performer);
    stage->step_ms[LIVE_STEP_CONSTRAIN] += ms_since(&at_ns);
    return result;
}

static void hear(live_sample_board *board, const mrt_sample *sample)
{
    if (!board)
        return;
    board->sample[slot_back(&board->slot)] = *sample;
    slot_publish(&board->slot);
}

static void follow_reload(live_stage *stage)
{
    reload *r = stage->reload;
    if (r && reload_step(r, performer_layer(stage->scene->performer)) && stage->recorder)
        recorder_change_mapping(stage->recorder, reload_identity(r));
}

static void on_step(void *data, const sample_step *s)
{
    live *self = data;
    live_stage *stage = &self->stage;
    follow_reload(stage);
    if (stage->recorder)
        recorder_step(stage->recorder, s);
    for (uint32_t i = 0; i < s->count; ++i) {
        const step_sample *of = &s->of[i];
        if (of->input == 0)
            stage->pointed = of->sample;
        else
            tap_offer(self->tap, of->input - 1, &of->sample);
        hear(stage->heard[of->input], &of->sample);
    }
}

static void on_performed(void *data, const sample_step *s)
{
    live *self = data;
    live_stage *stage = &self->stage;
    live_pulse *now = &stage->now;
    if (stage->recorder)
        recorder_performed(stage->recorder, s);
    double lag_ms = (double)(clock_now_ns() - s->time_ns) / (double)NS_PER_MS;
    now->lag_ms[now->lag_count++ % LIVE_LAGS] = (float)lag_ms;
    now->sample_count += s->count;
    now->last_ns = stage->sample_ns = s->time_ns;
}

static void on_incident(void *data, const input *from, const input_incident *what, double time_s)
{
    (void)time_s;
    live *self = data;
    live_stage *stage = &self->stage;
    for (uint32_t i = 0; stage->recorder && i < stage->input_count; ++i)
        if (player_input(stage->loop, i) == from)
            recorder_incident(stage->recorder, i, what);
    if (what->kind == INPUT_WENT)
        log_pushf(stage->log, MRT_LOG_WARNING, input_name(from), "%s; the pose is held",
                  what->text[0] ? what->text : "the device went away");
    else
        log_pushf(stage->log, MRT_LOG_INFO, input_name(from), "is back after %.1f s",
                  (double)what->away_ns / 1e9);
}

mrt_result live_frame_tick(live_stage *stage, error *err)
{
    mrt_sample sample = stage->pointed;
    sample.time_ns = clock_now_ns();
    sample.count = POINTER_CHANNELS;
    return player_give(stage->loop, 0, &sample, err);
}

/* ---- faces ---- */

static void meter(live_stage *stage, const face *f, int64_t now_ns)
{
    if (now_ns - stage->metered_ns < meter_span_ns)
        return;
    stage->metered_ns = now_ns;
    const face_surface judged = face_judge(f);
    stage->min_determinant = judged.min_determinant;
    stage->skin = judged.skin;
    stage->penetration_mm = face_penetration_mm(f);
}

static void describe_face(live_stage *stage, live_view *view, composer *of)
{
    const face *f = composer_face(of);
    /* A take's face is the same, but goes when another take is shown: the view outlives it. */
    view->about = composer_about(performer_composer(stage->scene->performer));
    view->contact_count = view->about->contact_count < LIVE_CONTACTS_MAX
                              ? view->about->contact_count
                              : LIVE_CONTACTS_MAX;
    for (uint32_t i = 0; i < view->contact_count; ++i)
        view->contact[i] = face_contact_now(f, i + 1);
    view->meter = *face_metered(f);
    bones_pose(view->bone, face_bones(f), view->meter.dof);
    view->pull = *composer_pull(of);
    view->is_anchored = composer_is_anchored(of);
    view->solver = composer_solver(of);
    view->min_determinant = stage->min_determinant;
    view->penetration_mm = stage->penetration_mm;
    view->skin = stage->skin;
}

static void describe_stage(live_stage *stage, live_view *view)
{
    const mrt_frame *frame = layer_frame(performer_layer(stage->scene->performer));
    const transport *motion = live_time_motion(stage);
    memcpy(view->hand, frame->hand, sizeof view->hand);
    memcpy(view->pedal, frame->pedal, sizeof view->pedal);
    view->mode = stage->mode;
    view->sample_ns = stage->sample_ns;
    if (stage->mode == LIVE_PERFORMS || !stage->timeline)
        return;
    int64_t at_ns = sequencer_now_ns(stage->timeline->sequencer);
    bool is_at_end = at_ns == live_time_shown_at(motion, motion->end_ns);
    view->at_ns = at_ns <= 0 ? 0 : is_at_end ? motion->end_ns : at_ns;
    view->is_playing = motion->is_playing;
    if (stage->mode == LIVE_OVERDUBS) {
        view->is_recording_over = overdub_run_is_recording(stage->over);
        view->pass = overdub_run_pass(stage->over);
        view->is_playing = true;
    }
}

static void note_frame(live_stage *stage)
{
    live_pulse *now = &stage->now;
    uint32_t at = now->frame_count++ % LIVE_HISTORY;
    double sum = 0.0;
    for (int i = 0; i < LIVE_STEPS; ++i) {
        now->step_ms[i][at] = (float)stage->step_ms[i];
        sum += stage->step_ms[i];
        stage->step_ms[i] = 0.0;
    }
    now->frame_ms[at] = (float)sum;
}

void live_frame_publish(live_stage *stage)
{
    int64_t at_ns = clock_now_ns(), now_ns = at_ns;
    composer *shown = live_time_shown(stage, now_ns);
    if (!shown)
        return;
    stage->is_dirty = false;
    composer_draw(shown);
    stage->step_ms[LIVE_STEP_DEFORM] += ms_since(&at_ns);
    live_board *board = &stage->scene->board;
    live_view *view = live_board_fill(board, shown, now_ns);
    meter(stage, composer_face(shown), now_ns);
    describe_face(stage, view, shown);
    describe_stage(stage, view);
    view->published_ns = stage->published_ns = clock_now_ns();
    live_board_publish(board);
    stage->step_ms[LIVE_STEP_PUBLISH] += ms_since(&at_ns);
    note_frame(stage);
}

void live_frame_pulse(live_stage *stage)
{
    const performer *p = stage->scene->performer;
    live_pulse *now = &stage->now;
    now->counts = *performer_counted(p);
    now->rezeros = *performer_rezeros(p);
    now->mode = stage->mode;
    if (!stage->timeline || live_time_is_here(stage))
        now->kept_bytes = stage->timeline ? sequencer_kept_bytes(stage->timeline->sequencer) : 0;
    now->is_taking = stage->recorder && recorder_is_taking(stage->recorder);
    now->take = stage->recorder ? recorder_take(stage->recorder) : 0;
    stage->pulse[slot_back(&stage->pulse_slot)] = *now;
    slot_publish(&stage->pulse_slot);
}

static bool is_moving(const live_stage *stage)
{
    bool is_timed = stage->mode != LIVE_PERFORMS && live_time_motion(stage)->is_playing;
    return is_timed || stage->mode == LIVE_OVERDUBS || live_board_is_easing(&stage->scene->board);
}

static mrt_result on_draw(void *data, int64_t time_ns, error *err)
{
    (void)time_ns, (void)err;
    live *self = data;
    live_stage *stage = &self->stage;
    if (stage->is_dirty || is_moving(stage))
        live_frame_publish(stage);
    live_time_send(stage, clock_now_ns());
    live_frame_pulse(stage);
    return MRT_OK;
}

static mrt_result on_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)data, (void)index, (void)time_s, (void)work_ns, (void)err;
    return MRT_OK;
}

/* ---- between samples ---- */

static bool on_turn(void *data)
{
    live *self = data;
    live_stage *stage = &self->stage;
    live_obey(self);
    if (slot_take(&stage->motion_slot))
        stage->is_sought = stage->is_dirty = true;
    /* The newest is replaced before it is taken too, so that what is taken is new. */
    int64_t now_ns = clock_now_ns();
    return live_time_may_show(stage, now_ns) && stage->is_dirty &&
           (live_board_is_taken(&stage->scene->board) ||
            now_ns - stage->published_ns >= least_apart_ns);
}

static void *run(void *data)
{
    live *self = data;
    error err = {""};
    while (!atomic_load(&self->stop))
        if (player_go_on(self->stage.loop, &err) < 0)
            log_push(self->stage.log, MRT_LOG_ERROR, "stage", err.text);
    return NULL;
}

mrt_result live_frame_start(live *self, error *err)
{
    self->callbacks = (player_stage){self, on_stage_step, on_draw};
    self->playing = (player_settings){.fps = self->settings.fps > 0.0 ? self->settings.fps : 60.0,
                                      .stop = &self->stop};
    self->events = (player_events){.frame = on_frame,
                                   .step = on_step,
                                   .performed = on_performed,
                                   .incident = on_incident,
                                   .turn = on_turn,
                                   .data = self};
    return player_create(&self->stage.loop, &self->callbacks, &self->playing, &self->events, err);
}

void live_frame_stop(live *self)
{
    if (self->has_thread) {
        atomic_store(&self->stop, true);
        wake_signal(player_wake(self->stage.loop));
        pthread_join(self->thread, NULL);
    }
    self->has_thread = false;
}

mrt_result live_frame_run(live *self, error *err)
{
    if (pthread_create(&self->thread, NULL, run, self) != 0)
        return error_set(err, MRT_ERR_MEMORY, "no thread to perform on");
    self->has_thread = true;
    return MRT_OK;
}
