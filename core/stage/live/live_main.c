#include "stage/live/live.h"
#include "base/clock.h"
#include "stage/live/live_stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How long [main] sleeps at a time while the frame thread is busy. */
static const int64_t patience_ns = 50 * NS_PER_MS;

static void run_command(live *self, live_command *of)
{
    of->result = of->run(&self->stage, of->data, of->err);
}

mrt_result live_ask(live *self, live_command_run *run, void *data, error *err)
{
    live_command command = {.run = run, .data = data, .err = err};
    if (!self->has_thread) {
        run_command(self, &command);
        return command.result;
    }
    atomic_store(&self->command, &command);
    wake_signal(player_wake(self->stage.loop));
    for (;;) {
        uint32_t seen = wake_seen(&self->answered);
        if (!atomic_load(&self->command))
            return command.result;
        wake_wait_until_ns(&self->answered, seen, clock_now_ns() + patience_ns);
    }
}

void live_run_command(live *self)
{
    live_command *waiting = atomic_load(&self->command);
    if (!waiting)
        return;
    run_command(self, waiting);
    atomic_store(&self->command, NULL); /* it is [main]'s again */
    wake_signal(&self->answered);
}

/* A finger that was let go is followed for so long. */
static const int64_t spring_ns = 350 * NS_PER_MS;
static const int64_t measure_span_ns = 250 * NS_PER_MS;

/* ---- made ---- */

static void init(live *self, const live_settings *settings)
{
    live_stage *stage = &self->stage;
    self->settings = *settings;
    self->show = settings->show;
    self->rate = (timecode_rate){.num = 30, .den = 1};
    wake_init(&self->answered);
    atomic_init(&self->command, NULL);
    atomic_init(&self->stop, false);
    transport_init(&self->transport, 0);
    slot_init(&stage->motion_slot);
    slot_init(&stage->pulse_slot);
    stage->log = settings->log;
    stage->min_determinant = 1.0;
    stage->motion[0] = stage->motion[1] = stage->motion[2] = self->transport;
}

static mrt_result open_pointer(live *self, error *err)
{
    feed_settings settings = {.id = "org.marotte.pointer", .name = "Mouse on the face"};
    settings.channels = pointer_channels(&settings.channel_count);
    mrt_result result = feed_create(&self->pointer_feed, &settings, err);
    if (result >= 0)
        result = input_create(&self->pointer, feed_type(self->pointer_feed), "", "", CLOCK_REAL,
                              self->settings.log, err);
    if (result < 0)
        return result;
    input_set_wake(self->pointer, player_wake(self->stage.loop));
    player_add_input(self->stage.loop, self->pointer);
    self->stage.input_count = 1;
    return MRT_OK;
}

static mrt_result set_stage(live *self, error *err)
{
    const live_settings *s = &self->settings;
    live_own_solver(self, s->solver);
    mrt_result result = live_mapping_create(&self->role, s->mapping, s->plugins, s->log, err);
    if (result >= 0)
        taught_recall(self->show, &self->role->instance, s->log);
    if (result >= 0)
        result = live_scene_create(self, s->face, s->face_path, s->unit_mm, self->role,
                                   &self->scene, err);
    if (result < 0)
        return result;
    self->stage.scene = self->scene;
    self->stage.role = self->role;
    outputs_show(self->outputs, self->scene->outgoing);
    live_frame_publish(&self->stage);
    live_frame_pulse(&self->stage);
    live_cast_watch(self);
    return MRT_OK;
}

mrt_result live_start(live **out, const live_settings *settings, error *err)
{
    *out = NULL;
    live *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    init(self, settings);
    mrt_result result = live_frame_start(self, err);
    self->tap = tap_create();
    if (result >= 0 && !self->tap)
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the samples of an input");
    if (result >= 0)
        result = open_pointer(self, err);
    const outputs_settings sent = {.plugins = settings->plugins, .log = settings->log};
    if (result >= 0)
        result = outputs_create(&self->outputs, &sent, err);
    self->stage.outputs = self->outputs;
    if (result >= 0)
        result = set_stage(self, err);
    error why = {""};
    if (result >= 0 && live_record_start(self, &why) < 0)
        log_push(settings->log, MRT_LOG_ERROR, "recorder", why.text);
    if (result >= 0)
        result = live_frame_run(self, err);
    if (result >= 0)
        result = input_start(self->pointer, err);
    if (result < 0) {
        error ignored = {""};
        (void)!live_stop(self, &ignored);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static void destroy_cast(live *self)
{
    if (self->coming)
        live_mapping_deactivate(live_mapping_now(self->coming));
    live_mapping_destroy(self->coming);
    live_scene_destroy(self->scene);
    live_scene_destroy(self->old_scene);
    live_mapping_destroy(self->role);
}

static void destroy_inputs(live *self)
{
    for (uint32_t i = 0; i < self->entry_count; ++i) {
        input_destroy(self->entry[i].input);
        free(self->entry[i].text);
        free(self->entry[i].heard);
    }
    input_destroy(self->pointer);
    feed_destroy(self->pointer_feed);
    tap_destroy(self->tap);
    for (int side = 0; side < 2; ++side) {
        free(self->calibration_path[side]);
        free(self->calibration_text[side]);
        free(self->calibration[side]);
    }
}

mrt_result live_stop(live *self, error *err)
{
    if (!self)
        return MRT_OK;
    if (self->scene && self->timeline)
        live_show_hands(self);
    mrt_result result = live_record_stop(self, err);
    live_frame_stop(self);
    if (self->scene)
        live_take_drop(self);
    live_take_finish(self);
    live_sound_drop(self);
    outputs_destroy(self->outputs);
    destroy_cast(self);
    destroy_inputs(self);
    player_destroy(self->stage.loop);
    free(self);
    return result;
}

outputs *live_outputs(live *self)
{
    return self->outputs;
}

/* ---- seen ---- */

bool live_look(live *self, const live_view **out)
{
    bool is_new = live_board_look(&self->scene->board, out);
    live_scene_destroy(self->old_scene);
    self->old_scene = NULL;
    return is_new;
}

/* ---- how it does ---- */

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static void percentiles(const float *of, uint32_t count, double *out_p50, double *out_p99)
{
    float sorted[LIVE_LAGS];
    if (count == 0)
        return;
    memcpy(sorted, of, count * sizeof *sorted);
    qsort(sorted, count, sizeof *sorted, by_size);
    if (out_p50)
        *out_p50 = (double)sorted[count / 2];
    *out_p99 = (double)sorted[(uint32_t)((double)(count - 1) * 0.99)];
}

static uint32_t filled(uint32_t count, uint32_t capacity)
{
    return count < capacity ? count : capacity;
}

static void measure(live *self, const live_pulse *pulse)
{
    live_status *status = &self->status;
    int64_t now_ns = clock_now_ns();
    if (now_ns - self->measured_ns < measure_span_ns)
        return;
    self->measured_ns = now_ns;
    uint32_t frames = filled(pulse->frame_count, LIVE_HISTORY);
    percentiles(pulse->frame_ms, frames, &status->frame_p50_ms, &status->frame_p99_ms);
    for (int i = 0; i < LIVE_PHASES; ++i)
        percentiles(pulse->phase_ms[i], frames, &status->phase_p50_ms[i], &status->phase_p99_ms[i]);
    percentiles(pulse->lag_ms, filled(pulse->lag_count, LIVE_LAGS), NULL, &status->lag_p99_ms);
}

static void unroll_frames(live_status *status, const live_pulse *pulse)
{
    uint32_t count = filled(pulse->frame_count, LIVE_HISTORY);
    uint32_t first = pulse->frame_count - count;
    for (uint32_t i = 0; i < count; ++i)
        status->frame_ms[i] = pulse->frame_ms[(first + i) % LIVE_HISTORY];
    status->frame_count = count;
}

void live_status_of(live *self, live_status *out)
{
    live_stage *stage = &self->stage;
    live_status *status = &self->status;
    (void)slot_take(&stage->pulse_slot);
    const live_pulse *pulse = &stage->pulse[slot_front(&stage->pulse_slot)];
    live_record_update(self);
    status->sample_count = pulse->sample_count;
    status->counts = pulse->counts;
    status->rezeros = pulse->rezeros;
    status->patch_speaks = pulse->patch_speaks;
    memcpy(status->patch_pressed, pulse->patch_pressed, sizeof status->patch_pressed);
    status->kept_bytes = pulse->kept_bytes;
    status->code = pulse->code;
    if (pulse->take > 0)
        status->take = pulse->take;
    measure(self, pulse);
    unroll_frames(status, pulse);
    status->isolated = live_mapping_isolated(self->role);
    const reload_counts reloads =
        self->role->reload ? reload_counted(self->role->reload) : (reload_counts){0};
    status->reload_taken = reloads.taken;
    status->reload_refused = reloads.refused;
    status->is_sound_armed = self->wants_sound;
    if (self->sound) {
        sound_play_look(self->sound, &status->playing);
        sound_in_look(self->sound, &status->listening);
    }
    *out = *status;
}

/* ---- the pointer ---- */

static void give(live *self, feed_activity activity)
{
    feed_give(self->pointer_feed, self->pointed, activity);
}

static void point(live *self, pointer_grip grip)
{
    self->pointed[POINTER_GRIP] = (float)grip;
    bool is_held = grip == POINTER_PULLS || grip == POINTER_KNEADS;
    bool was_held = self->is_pointing;
    self->is_pointing = is_held;
    if (is_held) {
        self->rests_at_ns = 0;
        self->moves = true;
    } else if (was_held || grip != POINTER_AWAY) {
        self->rests_at_ns = clock_now_ns() + spring_ns;
        self->moves = true;
    }
    give(self, self->moves || self->patch_moves ? FEED_MOVES : FEED_RESTS);
}

void live_point(live *self, pointer_grip grip, const float rest[3], const float at[3], bool stays,
                double radius_mm)
{
    float *to = self->pointed;
    bool is_away = grip == POINTER_AWAY && to[POINTER_GRIP] <= 0.0f;
    if (is_away)
        return; /* it hovers: nothing to perform */
    if (grip != POINTER_AWAY) {
        memcpy(to + POINTER_REST_X, rest, 3 * sizeof *rest);
        memcpy(to + POINTER_AT_X, at, 3 * sizeof *at);
        to[POINTER_RADIUS] = (float)fmax(radius_mm, 0.0);
        to[POINTER_STAYS] = stays ? 1.0f : 0.0f;
    }
    point(self, grip);
}

void live_neutral(live *self)
{
    point(self, POINTER_AWAY); /* twice in a row it is asked twice */
    point(self, POINTER_NEUTRAL);
}

void live_pointer_eases(live *self)
{
    point(self, POINTER_AWAY);
    self->rests_at_ns = clock_now_ns() + spring_ns;
    self->moves = true;
    give(self, FEED_MOVES);
}

static void let_pointer_rest(live *self)
{
    if (!self->moves || self->rests_at_ns == 0 || clock_now_ns() < self->rests_at_ns)
        return;
    self->moves = false;
    self->rests_at_ns = 0;
    if (!self->is_pointing)
        self->pointed[POINTER_GRIP] = POINTER_AWAY;
    give(self, self->patch_moves ? FEED_MOVES : FEED_RESTS);
}

/* A fader gives samples while it moves; what it has set going comes to its end by the pointer's. */
static void let_patch_come(live *self)
{
    bool is_moving = self->stage.pulse[slot_front(&self->stage.pulse_slot)].is_patch_moving;
    if (is_moving == self->patch_moves)
        return;
    self->patch_moves = is_moving;
    if (!self->moves)
        give(self, is_moving ? FEED_MOVES : FEED_RESTS);
}

/* ---- with every frame of the window ---- */

void live_update(live *self)
{
    (void)slot_take(&self->stage.pulse_slot);
    let_pointer_rest(self);
    let_patch_come(self);
    live_over_update(self);
    live_cast_update(self);
    live_sound_update(self);
}
