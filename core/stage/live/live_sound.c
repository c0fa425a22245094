/* [main] Sound: that of the take that is shown is heard, and the microphone's becomes a take's. */
#include "base/clock.h"
#include "stage/live/live_state.h"
#include "take/edit_store.h"

/* How long the end of a recording may take when the program ends. */
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
        return error_set(err, MRT_ERR_ARGUMENT, "sound: no show is open");
    const sound_settings settings = {
        .show = self->show, .log = self->settings.log, .backend = self->settings.sound};
    mrt_result result = sound_create(&self->sound, &settings, err);
    return result < 0 ? result : live_ask(self, hand_over, self->sound, err);
}

void live_sound_drop(live *self)
{
    error ignored = {""};
    if (!self->sound)
        return;
    (void)!live_ask(self, hand_over, NULL, &ignored);
    sound_destroy(self->sound);
    self->sound = NULL;
    self->wants_sound = false;
    self->attach_take = self->edited_take = 0;
}

mrt_result live_arm_sound(live *self, uint32_t channel_count, error *err)
{
    if (!self->recorder)
        return error_set(err, MRT_ERR_ARGUMENT, "sound: nothing is recorded: %s", self->why_not);
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

/* ---- it becomes the take's ---- */

static void attach(live *self)
{
    sound_in_status status;
    show_audio audio;
    error err = {""};
    int64_t take_id = self->attach_take;
    self->attach_take = 0;
    sound_in_look(self->sound, &status);
    if (status.record.audio == 0)
        return; /* none came: the status says why */
    mrt_result result = writer_flush(recorder_writer(self->recorder), &err);
    if (result >= 0)
        result = show_audio_info(self->show, status.record.audio, &audio, &err);
    if (result >= 0)
        result = edit_store_attach_audio(self->show, take_id, &audio, clock_utc_ms, &err);
    if (result < 0)
        log_pushf(self->settings.log, MRT_LOG_ERROR, "sound", "not attached to its take: %.200s",
                  err.text);
    else
        self->edited_take = take_id;
}

/* The recording ends, and is the take's once all of it is written. */
void live_sound_take_ended(live *self, int64_t take_id)
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

void live_sound_stop(live *self)
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
