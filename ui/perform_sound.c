#include "perform_sound.h"
#include "base/clock.h"
#include "exports.h"
#include "take/edit_store.h"

#include <stdio.h>
#include <string.h>

static const int64_t patience_ns = 3 * NS_PER_S;

mrt_result perform_sound_start(perform_sound *out, show *s, writer *w, error *err)
{
    *out = (perform_sound){.show = s};
    const sound_settings settings = {.show = s};
    mrt_result result = sound_create(&out->sound, &settings, err);
    return result < 0 ? result : sound_arm(out->sound, w, 0, err);
}

static void say(perform_sound *self, const char *text)
{
    if (!text[0] || strcmp(self->told, text) == 0)
        return;
    snprintf(self->told, sizeof self->told, "%s", text);
    fprintf(stderr, "warning: %s; the hands are recorded all the same\n", text);
}

void perform_sound_update(perform_sound *self)
{
    sound_in_status status;
    if (!self->sound)
        return;
    sound_update(self->sound);
    sound_in_look(self->sound, &status);
    say(self, status.device.text);
    say(self, status.record.text);
}

void perform_sound_stop(perform_sound *self)
{
    if (!self->sound)
        return;
    int64_t until_ns = clock_now_ns() + patience_ns;
    sound_disarm(self->sound);
    while (sound_is_armed(self->sound) && clock_now_ns() < until_ns) {
        sound_update(self->sound);
        clock_sleep_until_ns(clock_now_ns() + 10 * NS_PER_MS);
    }
}

mrt_result perform_sound_attach(perform_sound *self, int64_t take_id, facts *told, error *err)
{
    sound_in_status status;
    show_audio audio;
    if (!self->sound)
        return MRT_OK;
    sound_in_look(self->sound, &status);
    if (status.record.audio == 0) {
        facts_text(told, "sound", "sound", "none came");
        return MRT_OK;
    }
    mrt_result result = show_audio_info(self->show, status.record.audio, &audio, err);
    if (result >= 0)
        result = edit_store_attach_audio(self->show, take_id, &audio, clock_utc_ms, err);
    if (result < 0)
        return result;
    facts_text(told, "sound", "sound", audio.name);
    facts_number(told, "sound_s", "  length", (double)audio.frame_count / (double)audio.rate_hz, 2,
                 "s");
    facts_number(told, "sound_drift_ppm", "  drift", status.record.drift_ppm, 1,
                 "ppm of its clock against the samples'");
    if (status.record.gap_count)
        facts_number(told, "sound_gaps", "  gaps", status.record.gap_count, 0, "");
    return MRT_OK;
}

mrt_result perform_sound_write(perform_sound *self, int64_t take_id, double length_s,
                               const char *beside, char **out_path, progress *shown, error *err)
{
    take t = {0};
    *out_path = NULL;
    if (!self->sound)
        return MRT_OK;
    mrt_result result = edit_store_take(&t, self->show, take_id, err);
    if (result >= 0 && t.audio.audio != 0)
        result = exports_video_sound(out_path, self->show, &t, 0, (int64_t)(length_s * 1e9), beside,
                                     shown, err);
    take_finish(&t);
    return result;
}

void perform_sound_finish(perform_sound *self)
{
    sound_destroy(self->sound);
    *self = (perform_sound){0};
}
