#include "window/calibrate_panel_guide.h"

#include "hand/calibration_folder.h"
#include "hand/calibration_keep.h"
#include "hand/sensor.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static const float worth_telling = 0.1f; /* rad per rad */

mrt_result calibrate_guide_begin(calibrate_guide *out, const mrt_channel *channel, uint32_t count,
                                 uint32_t side, const char *name, error *err)
{
    *out = (calibrate_guide){.guide = NULL};
    mrt_result result = glove_channels_find(&out->glove, channel, count, side, name, err);
    if (result < 0)
        return result;
    guide_settings settings = guide_settings_usual(out->glove.side, out->glove.sensors);
    out->guide = guide_create(&settings);
    return out->guide ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the guide");
}

static void forget_result(calibrate_guide *self)
{
    calibration_file_finish(self->result);
    free(self->result);
    self->result = NULL;
}

void calibrate_guide_end(calibrate_guide *self)
{
    forget_result(self);
    guide_destroy(self->guide);
    *self = (calibrate_guide){.guide = NULL};
}

__attribute__((format(printf, 3, 4))) static void say(calibrate_guide *self, calibrate_tone tone,
                                                      const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(self->news, sizeof self->news, format, arguments);
    va_end(arguments);
    self->tone = tone;
}

static void conclude(calibrate_guide *self)
{
    error err = {""};
    self->result = calloc(1, sizeof *self->result);
    mrt_result result = self->result ? guide_result(self->guide, self->result, &err)
                                     : error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0) {
        guide_judge(&self->judgement, self->guide, self->result);
        return;
    }
    say(self, CALIBRATE_REFUSED, "%s", err.text);
    free(self->result);
    self->result = NULL;
}

static void follow(calibrate_guide *self, guide_news news, guide_step step)
{
    const char *reason = guide_reason(self->guide);
    switch (news) {
    case GUIDE_NOTHING:
        return;
    case GUIDE_TAKEN:
        say(self, CALIBRATE_TOOK, "Taken: %s%s%s", guide_step_name[step], reason[0] ? "; " : "",
            reason);
        break;
    case GUIDE_SKIPPED:
        say(self, CALIBRATE_SAYS, "Left out: %s", guide_step_name[step]);
        break;
    case GUIDE_REFUSED:
    case GUIDE_TIMED_OUT:
        say(self, CALIBRATE_REFUSED, "Not taken: %s", reason);
        return;
    }
    if (guide_current(self->guide) == GUIDE_STEPS)
        conclude(self);
}

void calibrate_guide_sample(calibrate_guide *self, const mrt_sample *sample)
{
    glove_channels_read(&self->glove, sample, self->raw);
    self->has_sample = true;
    guide_step step = guide_current(self->guide);
    follow(self, guide_sample(self->guide, self->raw, sample->time_ns), step);
}

void calibrate_guide_take(calibrate_guide *self)
{
    guide_step step = guide_current(self->guide);
    follow(self, guide_next(self->guide), step);
}

void calibrate_guide_skip(calibrate_guide *self)
{
    guide_step step = guide_current(self->guide);
    follow(self, guide_skip(self->guide), step);
}

void calibrate_guide_back(calibrate_guide *self)
{
    forget_result(self);
    guide_repeat(self->guide);
    say(self, CALIBRATE_SAYS, "Again: %s", guide_step_name[guide_current(self->guide)]);
}

void calibrate_guide_again(calibrate_guide *self, guide_step step)
{
    forget_result(self);
    guide_again(self->guide, step);
    say(self, CALIBRATE_SAYS, "Again: %s. Skip leaves it as it was.", guide_step_name[step]);
}

/* ---- what came out ---- */

static void tell_cross_talk(float share, int from, int to, calibrate_finding *out)
{
    out->is_warning = false;
    (void)snprintf(out->text, sizeof out->text, "%s moves along with %s: %.0f %%",
                   sensor_table[to].label, sensor_table[from].label, 100.0 * (double)share);
}

uint32_t calibrate_guide_findings(const calibrate_guide *self, calibrate_finding *out,
                                  uint32_t capacity)
{
    uint32_t count = 0;
    for (uint32_t i = 0; self->result && i < self->judgement.flaw_count && count < capacity; ++i) {
        out[count].is_warning = true;
        guide_flaw_text(&self->judgement.flaw[i], out[count].text, sizeof out[count].text);
        count += 1;
    }
    for (int i = 0; self->result && i < MRT_ANGLES; ++i) {
        const calibration_sensor *sensor = &self->result->sensor[i];
        if (sensor->table.count == 0)
            continue;
        for (int k = 0; k < MRT_ANGLES; ++k)
            if (fabsf(sensor->cross_talk[k]) >= worth_telling && count < capacity)
                tell_cross_talk(sensor->cross_talk[k], i, k, &out[count++]);
    }
    return count;
}

mrt_result calibrate_guide_keep(calibrate_guide *self, const char *name, double hand_length_mm,
                                char **out_path, error *err)
{
    *out_path = NULL;
    if (!self->result)
        return error_set(err, MRT_ERR_ARGUMENT, "the calibration is not complete yet");
    calibration_file *old = calloc(1, sizeof *old);
    if (!old)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = calibration_folder_place(out_path, name, err);
    if (result >= 0)
        result = calibration_keep_old(old, *out_path, err);
    bool is_other =
        result >= 0 && calibration_file_sensor_count(old) > 0 && old->side != self->result->side;
    if (is_other) {
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "\"%s\" is the name of a calibration of the other hand: choose another",
                           name);
        calibration_file_finish(old);
    }
    if (result >= 0) {
        calibration_keep_sign(self->result, old, name, hand_length_mm);
        result = calibration_keep_write(self->result, old, *out_path, err);
        calibration_file_finish(old);
    }
    free(old);
    if (result < 0) {
        free(*out_path);
        *out_path = NULL;
    }
    return result;
}
