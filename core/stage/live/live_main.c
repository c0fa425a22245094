#include "stage/live/live.h"
#include "base/clock.h"
#include "stage/live/live_stage.h"

#include <stdlib.h>
#include <string.h>

static const int64_t measure_span_ns = 250 * NS_PER_MS;

/* ---- create and destroy ---- */

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
    stage->changed = settings->changed;
    stage->min_determinant = 1.0;
    stage->motion[0] = stage->motion[1] = stage->motion[2] = self->transport;
}

mrt_result live_start(live **out, const live_settings *settings, error *err)
{
    *out = NULL;
    live *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    init(self, settings);
    mrt_result result = live_frame_start(self, err);
    if (result >= 0)
        result = live_pointer_open(self, err);
    const outputs_settings sent = {.plugins = settings->plugins, .log = settings->log};
    if (result >= 0)
        result = outputs_create(&self->outputs, &sent, err);
    self->stage.outputs = self->outputs;
    if (result >= 0)
        result = live_cast_start(self, err);
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
    live_cast_finish(self);
    live_inputs_finish(self);
    live_palette_finish(self);
    player_destroy(self->stage.loop);
    free(self);
    return result;
}

outputs *live_outputs(live *self)
{
    return self->outputs;
}

/* ---- newest view ---- */

bool live_read_view(live *self, const live_view **out)
{
    bool is_new = live_board_look(&self->scene->board, out);
    live_scene_destroy(self->old_scene);
    self->old_scene = NULL;
    return is_new;
}

/* ---- status ---- */

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
    (void)slot_receive(&stage->pulse_slot);
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
        self->role->reload ? reload_get_counts(self->role->reload) : (reload_counts){0};
    status->reload_taken = reloads.taken;
    status->reload_refused = reloads.refused;
    status->is_sound_armed = self->wants_sound;
    if (self->sound) {
        sound_play_read_status(self->sound, &status->playing);
        sound_in_read_status(self->sound, &status->listening);
    }
    *out = *status;
}

/* ---- change the face or the show ---- */

static mrt_result set_scene(live *self, const face_file *file, const char *path, double unit_mm,
                            error *err)
{
    live_take_drop(self);
    return live_cast_set_scene(self, file, path, unit_mm, err);
}

mrt_result live_set_face(live *self, const face_file *file, const char *path, double unit_mm,
                         error *err)
{
    mrt_result result = live_check_free(self, path ? path : "the face", err);
    return result < 0 ? result : set_scene(self, file, path, unit_mm, err);
}

/* A shown take stays on the stage, solved with the new solver. */
mrt_result live_set_solver(live *self, const csrbf_settings *solver, error *err)
{
    const live_scene *now = self->scene;
    const csrbf_settings before = self->own_solver;
    const bool had_own = self->has_own_solver;
    take shown = {0};
    bool is_shown = self->is_shown;
    mrt_result result = live_check_free(self, "the engine", err);
    if (result >= 0 && is_shown)
        result = take_copy(&shown, &self->shown, err);
    if (result >= 0) {
        live_own_solver(self, solver);
        result = set_scene(self, now->file, now->path, now->unit_mm, err);
        if (result < 0)
            live_own_solver(self, had_own ? &before : NULL);
    }
    if (result >= 0 && is_shown)
        result = live_show_take(self, &shown, err);
    take_finish(&shown);
    return result;
}

mrt_result live_set_show(live *self, show *s, error *err)
{
    live_take_drop(self);
    self->position_count = 0;
    self->is_over_done = false;
    mrt_result result = live_record_stop(self, err);
    if (result < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "recorder", err->text);
    live_sound_drop(self);
    self->show = s;
    self->status.take = 0;
    self->take_begun_ns = self->take_ended_ns = 0;
    if (s && live_cast_follow_show(self, err) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "stage", err->text);
    result = live_record_start(self, err);
    return result < 0 ? result : live_set_click(self, &self->click, err);
}

/* ---- update ---- */

void live_update(live *self)
{
    (void)slot_receive(&self->stage.pulse_slot);
    live_over_update(self);
    live_cast_update(self);
    live_inputs_update(self);
    live_palette_update(self);
    live_life_update(self);
    live_sound_update(self);
}

bool live_is_busy(const live *self)
{
    return self->coming || self->attach_take || self->is_over || self->is_over_done ||
           live_palette_is_moving(self);
}
