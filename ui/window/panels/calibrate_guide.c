#include "window/panels/calibrate_guide.h"

#include "hand/calibration_folder.h"

#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

mrt_result calibrate_guide_begin(calibrate_guide *out, const mrt_channel *channel, uint32_t count,
                                 uint32_t side, const char *name, error *err)
{
    *out = (calibrate_guide){.guide = NULL};
    mrt_result result = glove_channels_find(&out->glove, channel, count, side, name, err);
    if (result < 0)
        return result;
    const glove_channels *glove = &out->glove;
    guide_settings how = glove->input[0]
                             ? guide_settings_bare(glove->side, glove->sensors, glove->input)
                             : guide_settings_default(glove->side, glove->sensors);
    out->guide = guide_create(&how);
    return out->guide ? MRT_OK : error_set(err, MRT_ERR_MEMORY, "no memory for the guide");
}

static void forget_result(calibrate_guide *self)
{
    calibration_file_finish(self->result);
    free(self->result);
    self->result = NULL;
}

/* Accepts zeroed memory. */
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
        say(self, CALIBRATE_TOOK, "Recorded: %s%s%s", guide_step_name[step], reason[0] ? "; " : "",
            reason);
        break;
    case GUIDE_SKIPPED:
        say(self, CALIBRATE_SAYS, "Skipped: %s", guide_step_name[step]);
        break;
    case GUIDE_REFUSED:
    case GUIDE_TIMED_OUT:
        say(self, CALIBRATE_REFUSED, "Not recorded: %s", reason);
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

/* what: guide_next, which records the current pose, or guide_skip. */
void calibrate_guide_advance(calibrate_guide *self, guide_news (*what)(guide *))
{
    guide_step step = guide_current(self->guide);
    follow(self, what(self->guide), step);
}

void calibrate_guide_back(calibrate_guide *self)
{
    forget_result(self);
    guide_repeat(self->guide);
    say(self, CALIBRATE_SAYS, "Repeat: %s", guide_step_name[guide_current(self->guide)]);
}

/* Repeats one pose, then shows a new result. */
void calibrate_guide_again(calibrate_guide *self, guide_step step)
{
    forget_result(self);
    guide_again(self->guide, step);
    say(self, CALIBRATE_SAYS, "Repeat: %s. Skip keeps the earlier recording.",
        guide_step_name[step]);
}

/* Saves the calibration in the user's folder. The caller frees *out_path. hand_length_mm 0:
 * unknown. */
mrt_result calibrate_guide_keep(calibrate_guide *self, const char *name, double hand_length_mm,
                                char **out_path, error *err)
{
    *out_path = NULL;
    if (!self->result)
        return error_set(err, MRT_ERR_ARGUMENT, "the calibration is not complete yet");
    calibration_file *old = calloc(1, sizeof *old);
    if (!old)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = calibration_folder_place(out_path, name, self->result->input, err);
    if (result >= 0)
        result = calibration_keep_old(old, *out_path, err);
    if (result >= 0)
        result = calibration_keep_fits(self->result, old, *out_path, err);
    if (result >= 0) {
        calibration_keep_sign(self->result, old, name, hand_length_mm);
        result = calibration_keep_write(self->result, old, *out_path, err);
    }
    calibration_file_finish(old);
    free(old);
    if (result < 0) {
        free(*out_path);
        *out_path = NULL;
    }
    return result;
}

/* ---- the calibration that is used ---- */

static const char *const calibration_key[2] = {"hands.calibration.left", "hands.calibration.right"};

mrt_result calibrate_use(app *of, uint32_t side, const char *path, error *err)
{
    mrt_result result = live_calibrate(app_live(of), side, path[0] ? path : NULL, err);
    if (result >= 0)
        settings_set_text(app_settings(of), calibration_key[side], path);
    return result;
}

void calibrate_use_kept(app *of)
{
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        const char *path = settings_text(app_settings(of), calibration_key[side], NULL);
        const char *used = live_calibration(app_live(of), side);
        if (!path || (used && strcmp(used, path) == 0))
            continue;
        char copy[PATH_MAX];
        (void)snprintf(copy, sizeof copy, "%s", path);
        error err = {""};
        if (live_calibrate(app_live(of), side, copy[0] ? copy : NULL, &err) < 0)
            news_list_add(app_news(of), MRT_LOG_WARNING, "devices", err.text);
    }
}
