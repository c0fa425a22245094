#include "stage/live/live_stage.h"
#include "base/clock.h"
#include "show/edit_store.h"

#include <stdio.h>
#include <stdlib.h>

/* [main] Recording while a writable show is open, takes, and sound. */

/* ---- sound: playback of a take's sound, and recording of the microphone ---- */

/* Maximum time to finish a sound recording when the program ends. */
static const int64_t patience_ns = 3 * NS_PER_S;

static mrt_result hand_over(live_stage *stage, void *data, error *err)
{
    (void)err;
    stage->sound = data;
    return MRT_OK;
}

mrt_result live_sound_need(live *self, error *err)
{
    if (self->sound)
        return MRT_OK;
    if (!self->show)
        return error_set(err, MRT_ERR_ARGUMENT, "sound: open a show first");
    const sound_settings settings = {
        .show = self->show, .log = self->settings.log, .backend = self->settings.sound};
    mrt_result result = sound_create(&self->sound, &settings, err);
    return result < 0 ? result : live_run_command(self, hand_over, self->sound, err);
}

void live_sound_drop(live *self)
{
    error ignored = {""};
    if (!self->sound)
        return;
    (void)!live_run_command(self, hand_over, NULL, &ignored);
    sound_destroy(self->sound);
    self->sound = NULL;
    self->wants_sound = false;
    self->attach_take = self->edited_take = 0;
}

/* ---- the click ---- */

static mrt_result apply_click(live_stage *stage, void *data, error *err)
{
    (void)err;
    stage->click = *(const live_click *)data;
    live_time_update_sound(stage, clock_now_ns());
    return MRT_OK;
}

mrt_result live_set_click(live *self, const live_click *click, error *err)
{
    mrt_result result = MRT_OK;
    const bool is_right = click->bpm >= LIVE_CLICK_BPM_MIN && click->bpm <= LIVE_CLICK_BPM_MAX &&
                          click->bar >= 1 && click->bar <= LIVE_CLICK_BAR_MAX;
    if (click->when != LIVE_CLICK_OFF && !is_right)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "click: %g beats per minute, %u beats per bar; the ranges are %d to %d and 1 to %d",
            click->bpm, click->bar, LIVE_CLICK_BPM_MIN, LIVE_CLICK_BPM_MAX, LIVE_CLICK_BAR_MAX);
    self->click = *click;
    if (click->when != LIVE_CLICK_OFF && self->show)
        result = live_sound_need(self, err);
    if (result >= 0 && click->when != LIVE_CLICK_OFF && self->sound)
        sound_want_beats(self->sound);
    return result < 0 ? result : live_run_command(self, apply_click, &self->click, err);
}

mrt_result live_arm_sound(live *self, uint32_t channel_count, error *err)
{
    if (!self->recorder)
        return error_set(err, MRT_ERR_ARGUMENT, "sound: cannot record: %s", self->why_not);
    mrt_result result = live_sound_need(self, err);
    if (result >= 0 && !sound_is_armed(self->sound))
        result = sound_arm(self->sound, recorder_writer(self->recorder), channel_count, err);
    if (result < 0)
        return result;
    self->wants_sound = true;
    self->sound_channels = channel_count;
    return MRT_OK;
}

void live_disarm_sound(live *self)
{
    self->wants_sound = false;
    if (self->sound && !(self->status.is_recording && !self->is_over))
        sound_disarm(self->sound);
}

/* ---- attach recorded sound to its take ---- */

static void attach(live *self)
{
    sound_in_status status;
    show_audio audio;
    error err = {""};
    int64_t take_id = self->attach_take;
    self->attach_take = 0;
    sound_in_read_status(self->sound, &status);
    if (status.record.audio == 0)
        return; /* no sound was recorded: the status has the reason */
    mrt_result result = writer_flush(recorder_writer(self->recorder), &err);
    if (result >= 0)
        result = show_audio_info(self->show, status.record.audio, &audio, &err);
    if (result >= 0)
        result = edit_store_attach_audio(self->show, take_id, &audio, clock_utc_ms, &err);
    if (result < 0)
        log_pushf(self->settings.log, MRT_LOG_ERROR, "sound",
                  "cannot attach the sound to its take: %.200s", err.text);
    else
        self->edited_take = take_id;
}

/* Ends the sound recording. It is attached to the take after all of it is written. */
static void live_sound_take_ended(live *self, int64_t take_id)
{
    if (!self->sound || !sound_is_armed(self->sound) || take_id == 0)
        return;
    self->attach_take = take_id;
    sound_disarm(self->sound);
}

void live_sound_update(live *self)
{
    error err = {""};
    if (!self->sound)
        return;
    sound_update(self->sound);
    if (sound_is_armed(self->sound))
        return;
    if (self->attach_take)
        attach(self);
    if (self->wants_sound && self->recorder &&
        live_arm_sound(self, self->sound_channels, &err) < 0) {
        log_push(self->settings.log, MRT_LOG_ERROR, "sound", err.text);
        self->wants_sound = false;
    }
}

/* Stops the sound and attaches the recording to its take. */
static void live_sound_stop(live *self)
{
    int64_t until_ns = clock_now_ns() + patience_ns;
    self->wants_sound = false;
    if (!self->sound)
        return;
    sound_disarm(self->sound);
    while (sound_is_armed(self->sound) && clock_now_ns() < until_ns) {
        sound_update(self->sound);
        clock_sleep_until_ns(clock_now_ns() + 5 * NS_PER_MS);
    }
    live_sound_update(self);
}

int64_t live_take_edited(live *self)
{
    int64_t out = self->edited_take;
    self->edited_take = 0;
    return out;
}

/* ---- show ---- */

static void set_why_not(live *self, const char *text)
{
    snprintf(self->why_not, sizeof self->why_not, "%.255s", text);
}

static mrt_result attach_recorder(live_stage *stage, void *data, error *err)
{
    stage->recorder = data;
    return live_frame_tick(stage, err);
}

static mrt_result detach_recorder(live_stage *stage, void *data, error *err)
{
    (void)data, (void)err;
    if (stage->recorder)
        recorder_unwatch(stage->recorder);
    stage->recorder = NULL;
    return MRT_OK;
}

mrt_result live_record_start(live *self, error *err)
{
    set_why_not(self, "");
    if (!self->show) {
        set_why_not(self, "open or create a show to record");
        return MRT_OK;
    }
    if (!show_is_writable(self->show)) {
        set_why_not(self, show_notice(self->show));
        return MRT_OK;
    }
    const recorder_settings settings = live_cast_settings(self, true);
    mrt_result result = recorder_start(&self->recorder, &settings, err);
    if (result < 0) {
        set_why_not(self, err->text);
        return result;
    }
    self->session_ns = clock_now_ns();
    return live_run_command(self, attach_recorder, self->recorder, err);
}

mrt_result live_record_stop(live *self, error *err)
{
    error ignored = {""};
    mrt_result result = MRT_OK;
    if (!self->recorder)
        return MRT_OK;
    if (self->status.is_recording)
        result = live_record_end(self, err);
    live_sound_stop(self);
    live_cast_keep_taught(self);
    (void)!live_run_command(self, detach_recorder, NULL, &ignored);
    mrt_result stopped = recorder_stop(self->recorder, result < 0 ? &ignored : err);
    self->recorder = NULL;
    return result < 0 ? result : stopped;
}

/* ---- takes ---- */

static mrt_result check_recorder(const live *self, error *err)
{
    return self->recorder ? MRT_OK
                          : error_set(err, MRT_ERR_ARGUMENT, "cannot record: %s",
                                      self->why_not[0] ? self->why_not : "open a show first");
}

static const writer_slate no_slate; /* default slate */

typedef struct taking {
    const writer_slate *slate;
    int64_t from_ns, to_ns; /* span to save */
    const char *text;
    int64_t take, time_ns;
} taking;

static mrt_result begin_take(live_stage *stage, void *data, error *err)
{
    taking *t = data;
    recorder_take_next(stage->recorder, t->slate, stage->count_ns);
    mrt_result result = live_frame_tick(stage, err);
    t->take = recorder_take(stage->recorder);
    t->time_ns = stage->now.last_ns;
    if (!stage->count_ns || stage->count_ns > t->time_ns || result < 0)
        stage->count_ns = result < 0 ? 0 : t->time_ns;
    t->time_ns = stage->count_ns;
    live_time_update_sound(stage, clock_now_ns());
    live_frame_pulse(stage);
    return result;
}

static mrt_result count_in(live_stage *stage, void *data, error *err)
{
    (void)err;
    stage->count_ns = *(const int64_t *)data;
    live_time_update_sound(stage, clock_now_ns());
    return MRT_OK;
}

void live_count_in(live *self, int64_t begin_ns)
{
    error ignored = {""};
    (void)!live_run_command(self, count_in, &begin_ns, &ignored);
}

mrt_result live_record(live *self, const writer_slate *slate, error *err)
{
    taking t = {.slate = slate ? slate : &no_slate};
    mrt_result result = check_recorder(self, err);
    if (result >= 0)
        result = live_check_free(self, "a take", err);
    if (result >= 0)
        result = live_run_command(self, begin_take, &t, err);
    if (result < 0)
        return result;
    self->status.is_recording = true;
    self->status.take = t.take;
    self->take_begun_ns = t.time_ns;
    return MRT_OK;
}

static mrt_result end_take(live_stage *stage, void *data, error *err)
{
    taking *t = data;
    mrt_result result = live_frame_tick(stage, err);
    t->time_ns = stage->now.last_ns;
    if (stage->mode == LIVE_OVERDUBS) {
        live_time_end_over(stage, t->time_ns, err);
        t->take = recorder_take(stage->recorder);
        return result;
    }
    if (result >= 0)
        result = recorder_take_end(stage->recorder, err);
    t->take = recorder_take(stage->recorder);
    stage->count_ns = 0;
    live_time_update_sound(stage, clock_now_ns());
    live_frame_pulse(stage);
    return result;
}

mrt_result live_record_end(live *self, error *err)
{
    taking t = {0};
    if (!self->status.is_recording)
        return error_set(err, MRT_ERR_ARGUMENT, "start a recording first");
    mrt_result result = live_run_command(self, end_take, &t, err);
    self->status.is_recording = false;
    self->take_ended_ns = t.time_ns;
    if (self->is_over) {
        self->is_over = false;
        self->is_over_done = true;
        return result;
    }
    live_sound_take_ended(self, t.take);
    return result;
}

static mrt_result keep(live_stage *stage, void *data, error *err)
{
    taking *t = data;
    mrt_result result = live_frame_tick(stage, err);
    if (result >= 0)
        result = recorder_keep(stage->recorder, t->from_ns, t->to_ns, t->slate, &t->take, err);
    return result;
}

mrt_result live_keep(live *self, int64_t from_ns, int64_t to_ns, const writer_slate *slate,
                     int64_t *out_take, error *err)
{
    taking t = {.slate = slate ? slate : &no_slate, .from_ns = from_ns, .to_ns = to_ns};
    *out_take = 0;
    mrt_result result = check_recorder(self, err);
    if (result >= 0)
        result = live_run_command(self, keep, &t, err);
    *out_take = t.take;
    return result;
}

static mrt_result mark(live_stage *stage, void *data, error *err)
{
    const taking *t = data;
    return writer_mark(recorder_writer(stage->recorder), clock_now_ns(), t->text, err);
}

mrt_result live_mark(live *self, const char *text, error *err)
{
    taking t = {.text = text};
    mrt_result result = check_recorder(self, err);
    return result < 0 ? result : live_run_command(self, mark, &t, err);
}

/* ---- status ---- */

void live_record_update(live *self)
{
    live_status *status = &self->status;
    status->can_record = self->recorder != NULL;
    snprintf(status->why_not, sizeof status->why_not, "%s", self->why_not);
    status->problem[0] = '\0';
    status->writer = (writer_status){0};
    int64_t now_ns = clock_now_ns();
    int64_t until_ns = status->is_recording ? now_ns : self->take_ended_ns;
    status->recorded_ns = self->take_begun_ns > 0 ? until_ns - self->take_begun_ns : 0;
    status->journal_ns = 0;
    if (!self->recorder)
        return;
    double journal_s = self->settings.journal_s > 0.0 ? self->settings.journal_s : 1800.0;
    int64_t journal_ns = (int64_t)(journal_s * 1e9);
    int64_t session_ns = now_ns - self->session_ns;
    status->journal_ns = session_ns < journal_ns ? session_ns : journal_ns;
    status->writer = writer_status_of(recorder_writer(self->recorder));
    writer_message(recorder_writer(self->recorder), status->problem, sizeof status->problem);
    if (!status->problem[0])
        (void)snprintf(status->problem, sizeof status->problem, "%s",
                       recorder_problem(self->recorder));
}
