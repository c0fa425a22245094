#include "calibrate_guide.h"

#include "base/cancel.h"
#include "base/clock.h"
#include "calibrate_screen.h"
#include "hand/guide.h"
#include "keys.h"
#include "stage/glove_channels.h"
#include "stage/input.h"
#include "stage/mapping/plugins.h"

#include <stdlib.h>
#include <string.h>

static const int64_t IDLE_NS = 4 * NS_PER_MS, DRAW_NS = 66 * NS_PER_MS;

typedef struct guiding {
    const calibrate_guide_options *options;
    log_queue *log;
    plugin_list plugins;
    instance_clock clock;
    input *input;
    glove_channels glove;
    guide *guide;
    calibrate_screen screen;
    bool is_saved, is_quit;
    float raw[MRT_ANGLES];
    int64_t heard_ns, drawn_ns; /* host clock: of the last sample, of the last drawing */
} guiding;

/* ---- the glove ---- */

static mrt_result open_glove(guiding *self, error *err)
{
    const plugin_spec *spec = self->options->input;
    const mrt_plugin_type *type;
    mrt_result result = plugin_list_load(&self->plugins, err);
    if (result >= 0)
        result = plugin_list_choose(&self->plugins, spec->plugin, MRT_INPUT, &type, err);
    if (result < 0)
        return result;
    const mrt_input *functions = plugin_interface(type, MRT_INPUT);
    self->clock = functions->flags & MRT_INPUT_RECORDED ? CLOCK_VIRTUAL : CLOCK_REAL;
    result = input_create_stoppable(&self->input, type, spec->address, spec->params, self->clock,
                                    self->log, cancel_flag(), err);
    if (result < 0)
        return result;
    uint32_t count;
    const mrt_channel *channel = input_channels(self->input, &count);
    return glove_channels_find(&self->glove, channel, count, self->options->side,
                               input_name(self->input), err);
}

static void print_log(guiding *self)
{
    static const char *const levels[] = {"debug", "note", "warning", "error"};
    log_record record;
    while (self->log && log_pop(self->log, &record)) {
        if (record.level <= MRT_LOG_DEBUG || record.level > MRT_LOG_ERROR)
            continue;
        if (self->screen.is_terminal)
            calibrate_screen_news(&self->screen, "%s: %s", record.source, record.text);
        else
            fprintf(stderr, "%s: %s: %s\n", levels[record.level], record.source, record.text);
    }
}

/* ---- the guide ---- */

static mrt_result judge(const guiding *self, guide_judgement *out, error *err)
{
    calibration_file *made = calloc(1, sizeof *made);
    if (!made)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a calibration");
    mrt_result result = guide_result(self->guide, made, err);
    if (result >= 0)
        guide_judge(out, self->guide, made);
    free(made);
    return result;
}

/* All poses are there: a person decides by this whether to save it. */
static mrt_result say_judgement(guiding *self, error *err)
{
    guide_judgement judgement;
    char words[96], first[200] = "";
    mrt_result result = judge(self, &judgement, err);
    if (result < 0)
        return result;
    guide_judgement_text(&judgement, words, sizeof words);
    if (judgement.flaw_count > 0)
        guide_flaw_text(&judgement.flaw[0], first, sizeof first);
    calibrate_screen_news(&self->screen, "%s%s%s", words, first[0] ? " " : "", first);
    return MRT_OK;
}

/* At the end the pose that the judgement names, else the last one. */
static mrt_result repeat(guiding *self, error *err)
{
    guide_judgement judgement = {.flaw_count = 0};
    mrt_result result = MRT_OK;
    if (guide_current(self->guide) == GUIDE_STEPS)
        result = judge(self, &judgement, err);
    if (result >= 0 && judgement.flaw_count > 0)
        guide_again(self->guide, judgement.flaw[0].step);
    else if (result >= 0)
        guide_repeat(self->guide);
    if (result < 0)
        return result;
    calibrate_screen_news(&self->screen, "again: %s", guide_step_name[guide_current(self->guide)]);
    calibrate_screen_step(&self->screen, self->guide);
    return MRT_OK;
}

static mrt_result follow_news(guiding *self, guide_news news, guide_step step, error *err)
{
    const char *reason = guide_reason(self->guide);
    switch (news) {
    case GUIDE_NOTHING:
        return MRT_OK;
    case GUIDE_TAKEN:
        calibrate_screen_news(&self->screen, "taken: %s%s%s", guide_step_name[step],
                              reason[0] ? "; " : "", reason);
        break;
    case GUIDE_SKIPPED:
        calibrate_screen_news(&self->screen, "skipped: %s", guide_step_name[step]);
        break;
    case GUIDE_REFUSED:
        calibrate_screen_news(&self->screen, "not taken: %s", reason);
        return MRT_OK;
    case GUIDE_TIMED_OUT:
        return error_set(err, MRT_ERR_IO, "%s", reason);
    }
    calibrate_screen_step(&self->screen, self->guide);
    return guide_current(self->guide) == GUIDE_STEPS ? say_judgement(self, err) : MRT_OK;
}

static mrt_result follow_keys(guiding *self, error *err)
{
    mrt_result result = MRT_OK;
    for (char key = keys_next(); key && result >= 0; key = keys_next()) {
        guide_step step = guide_current(self->guide);
        if (key == '\n' && step == GUIDE_STEPS) {
            self->is_saved = true;
        } else if (key == '\n' && self->screen.is_away) {
            calibrate_screen_news(&self->screen, "not taken: the glove is away");
        } else if (key == '\n') {
            result = follow_news(self, guide_next(self->guide), step, err);
        } else if (key == 's') {
            result = follow_news(self, guide_skip(self->guide), step, err);
        } else if (key == 'r') {
            result = repeat(self, err);
        } else if (key == 'q') {
            self->is_quit = true;
        }
    }
    return result;
}

static mrt_result follow_sample(guiding *self, const mrt_sample *sample, error *err)
{
    if (input_version(self->input) != 0)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "%s: has other sensors than at the beginning: begin again",
                         input_name(self->input));
    glove_channels_read(&self->glove, sample, self->raw);
    guide_step step = guide_current(self->guide);
    return follow_news(self, guide_sample(self->guide, self->raw, sample->time_ns), step, err);
}

static void follow_incidents(guiding *self)
{
    input_incident incident;
    while (input_take_incident(self->input, &incident)) {
        self->screen.is_away = incident.kind == INPUT_WENT;
        if (incident.kind == INPUT_WENT)
            calibrate_screen_news(&self->screen, "the glove is away: waiting for it%s%s",
                                  incident.text[0] ? ": " : "", incident.text);
        else
            calibrate_screen_news(&self->screen, "the glove is back");
    }
}

/* Nothing came. Scripts do not wait for ever; people do, for a glove that was pulled out. */
static mrt_result follow_silence(guiding *self, int64_t now_ns, error *err)
{
    double timeout_s = self->options->timeout_s;
    double silent_s = (double)(now_ns - self->heard_ns) / 1e9;
    if (timeout_s > 0 && silent_s > timeout_s)
        return error_set(err, MRT_ERR_IO, "%s: gave no sample for %.0f s", input_name(self->input),
                         timeout_s);
    clock_sleep_until_ns(now_ns + IDLE_NS);
    return MRT_OK;
}

static bool is_over(const guiding *self)
{
    input_state state = input_state_of(self->input);
    return state == INPUT_ENDED || state == INPUT_FAILED;
}

static mrt_result say_over(const guiding *self, error *err)
{
    guide_step step = guide_current(self->guide);
    const char *name = input_name(self->input);
    if (input_state_of(self->input) == INPUT_FAILED)
        return error_set(err, MRT_ERR_IO, "%s: the input failed in step %d of %d, %s", name,
                         (int)step + 1, GUIDE_STEPS, guide_step_name[step]);
    return error_set(err, MRT_ERR_FORMAT,
                     "%s: is over in step %d of %d, %s: that pose does not come, or is not held "
                     "still for 0.7 s",
                     name, (int)step + 1, GUIDE_STEPS, guide_step_name[step]);
}

/* Done: by itself in a script, by Enter where a person may want to repeat. */
static bool is_done(const guiding *self)
{
    bool waits = self->screen.has_keys && self->clock == CLOCK_REAL;
    return guide_current(self->guide) == GUIDE_STEPS && (self->is_saved || !waits);
}

static mrt_result follow_glove(guiding *self, error *err)
{
    mrt_sample sample;
    int64_t now_ns = clock_now_ns();
    mrt_result result = MRT_OK;
    bool over = is_over(self); /* asked first: what came before the end is still in a ring */
    bool has_sample = input_peek(self->input, &sample);
    follow_incidents(self);
    if (has_sample) {
        input_take(self->input);
        self->heard_ns = now_ns;
        result = follow_sample(self, &sample, err);
    } else if (over || self->clock == CLOCK_VIRTUAL) {
        return say_over(self, err);
    } else {
        result = follow_silence(self, now_ns, err);
    }
    if (now_ns - self->drawn_ns >= DRAW_NS) {
        self->drawn_ns = now_ns;
        print_log(self);
        calibrate_screen_draw(&self->screen, self->guide, self->raw);
    }
    return result;
}

static mrt_result guide_person(guiding *self, error *err)
{
    self->heard_ns = clock_now_ns();
    calibrate_screen_step(&self->screen, self->guide);
    mrt_result result = input_start(self->input, err);
    while (result >= 0 && !is_done(self)) {
        result = follow_keys(self, err);
        if (result >= 0 && (self->is_quit || cancel_is_asked()))
            result = error_set(err, MRT_ERR_ARGUMENT, "given up; nothing is written");
        if (result >= 0 && !is_done(self))
            result = follow_glove(self, err);
    }
    calibrate_screen_draw(&self->screen, self->guide, self->raw);
    calibrate_screen_end(&self->screen);
    return result;
}

static mrt_result prepare(guiding *self, error *err)
{
    self->log = log_queue_create();
    if (!self->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    mrt_result result = open_glove(self, err);
    if (result < 0)
        return result;
    guide_settings settings = guide_settings_usual(self->glove.side, self->glove.sensors);
    settings.timeout_s = self->options->timeout_s;
    self->guide = guide_create(&settings);
    if (!self->guide)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the guide");
    FILE *screen = self->options->screen;
    calibrate_screen_begin(&self->screen, screen, keys_begin(), self->glove.sensors);
    return MRT_OK;
}

mrt_result calibrate_guide_run(calibration_file *out, guide_judgement *out_judgement,
                               const calibrate_guide_options *options, error *err)
{
    guiding self = {.options = options};
    cancel_on_signals(CANCEL_WAITS, NULL);
    mrt_result result = prepare(&self, err);
    if (result >= 0)
        result = guide_person(&self, err);
    if (result >= 0)
        result = guide_result(self.guide, out, err);
    if (result >= 0)
        guide_judge(out_judgement, self.guide, out);
    keys_end();
    guide_destroy(self.guide);
    input_destroy(self.input);
    plugin_list_destroy(&self.plugins);
    print_log(&self);
    log_queue_destroy(self.log);
    return result;
}
