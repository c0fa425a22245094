#include "window/panels/calibrate.h"
#include "window/panels/calibrate_guide.h"
#include "window/gui/hand_figure.h"
#include "window/gui/theme.h"
#include "window/gui/ui.h"

#include "base/clock.h"
#include "hand/calibration_folder.h"
#include "hand/guide.h"
#include "hand/sensor.h"
#include "stage/input/glove_channels.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the dialog ---- */

enum { COLUMNS = 2, PER_FRAME = 512 };
static const float width = 720.0f, bar_height = 17.0f, news_height = 44.0f, figure_size = 132.0f;
static const double degrees_per_rad = 57.29577951308232;
static const char *const side_word[2] = {"left", "right"};
static const char dialog[] = "calibrate";

struct calibrate_panel {
    app *app;
    input *glove; /* NULL: closed */
    uint32_t index;
    calibrate_guide guide;
    hand_skeleton *skeleton[2]; /* for the drawn poses, by side */
    bool is_asked, is_away;
    bool gives_up; /* the user closed the dialog, which now asks whether to discard the poses */
    char name[CALIBRATION_NAME], length[16];
    error trouble;
    char *kept;
    uint32_t kept_side;
    bool has_kept;
};

calibrate_panel *calibrate_panel_create(app *of)
{
    calibrate_panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->app = of;
    for (uint32_t side = 0; side < 2; ++side)
        self->skeleton[side] = hand_skeleton_create(side, HAND_LENGTH_MM);
    if (self->skeleton[0] && self->skeleton[1])
        return self;
    calibrate_panel_destroy(self);
    return NULL;
}

static void leave(calibrate_panel *self)
{
    if (!self->glove)
        return;
    live_tap(app_live(self->app), UINT32_MAX);
    calibrate_guide_end(&self->guide);
    self->glove = NULL;
}

void calibrate_panel_destroy(calibrate_panel *self)
{
    if (!self)
        return;
    leave(self);
    for (uint32_t side = 0; side < 2; ++side)
        hand_skeleton_destroy(self->skeleton[side]);
    free(self->kept);
    free(self);
}

bool calibrate_panel_open(calibrate_panel *self, uint32_t index, uint32_t side, error *out_why)
{
    leave(self);
    input *glove = live_input(app_live(self->app), index);
    uint32_t count;
    const mrt_channel *channels = input_channels(glove, &count);
    if (calibrate_guide_begin(&self->guide, channels, count, side, input_name(glove), out_why) < 0)
        return false;
    self->glove = glove;
    self->index = index;
    self->is_asked = true;
    self->is_away = self->gives_up = false;
    self->trouble = (error){""};
    (void)snprintf(self->name, sizeof self->name, "%s hand", side_word[side]);
    live_tap(app_live(self->app), index);
    return true;
}

const char *calibrate_panel_pop_saved(calibrate_panel *self, uint32_t *out_side)
{
    if (!self->has_kept)
        return NULL;
    self->has_kept = false;
    *out_side = self->kept_side;
    return self->kept;
}

/* Finds the glove in the list of inputs again. Its index changes when other inputs are opened or
 * closed. Returns false if the glove was closed. */
static bool is_still_there(calibrate_panel *self)
{
    live *stage = app_live(self->app);
    for (uint32_t i = 0; i < live_input_count(stage); ++i) {
        if (live_input(stage, i) != self->glove)
            continue;
        if (i != self->index)
            live_tap(stage, i);
        self->index = i;
        return true;
    }
    return false;
}

static bool has_other_channels(const calibrate_panel *self)
{
    uint32_t count;
    error why = {""};
    glove_channels now;
    const mrt_channel *channels = input_channels(self->glove, &count);
    return glove_channels_find(&now, channels, count, self->guide.glove.side, "", &why) < 0 ||
           memcmp(now.channel_of, self->guide.glove.channel_of, sizeof now.channel_of) != 0;
}

void calibrate_panel_update(calibrate_panel *self)
{
    mrt_sample sample;
    if (!self->glove)
        return;
    if (!is_still_there(self)) {
        leave(self);
        return;
    }
    self->is_away = input_state_of(self->glove) != INPUT_RUNNING;
    if (has_other_channels(self)) {
        (void)error_set(&self->trouble, MRT_ERR_UNSUPPORTED,
                        "The sensors of the input changed during the calibration. Close this "
                        "dialog and start again.");
        return;
    }
    app_want_frame(self->app, 0.0);
    for (int i = 0; i < PER_FRAME && live_pop_tapped(app_live(self->app), &sample); ++i)
        calibrate_guide_sample(&self->guide, &sample);
}

/* ---- the poses ---- */

static void draw_steps(const calibrate_panel *self, ui *on)
{
    ui_canvas at;
    guide_step now = guide_current(self->guide.guide);
    const float gap = 22.0f, radius = 5.0f;
    char words[64];
    ui_canvas_begin(on, "steps", 0.0f, 20.0f, &at);
    float y = at.where.y + 10.0f;
    int count, number = guide_number(self->guide.guide, &count), column = 0;
    for (int step = 0; step < GUIDE_STEPS; ++step) {
        if (!guide_is_requested(self->guide.guide, (guide_step)step))
            continue;
        float x = at.where.x + 8.0f + gap * (float)column++;
        if (step == (int)now)
            ui_draw_ring(on, x, y, radius + 1.0f, THEME_ACCENT, 2.0f);
        else if (guide_has(self->guide.guide, (guide_step)step))
            ui_draw_disc(on, x, y, radius, THEME_GOOD);
        else
            ui_draw_ring(on, x, y, radius - 1.0f, THEME_DIM, 1.0f);
    }
    if (now < GUIDE_STEPS) {
        (void)snprintf(words, sizeof words, "pose %d of %d", number, count);
        ui_draw_text(on, at.where.x + gap * (float)count + 8.0f, at.where.y + 2.0f, UI_STYLE_DIM,
                     THEME_DIM, 0.0f, words);
    }
    ui_canvas_end(on);
}

static float share_of(const glove_channels *glove, float raw)
{
    float span = glove->high - glove->low;
    float share = span > 0.0f ? (raw - glove->low) / span : 0.0f;
    return fminf(fmaxf(share, 0.0f), 1.0f);
}

static void draw_bar(const calibrate_guide *of, ui *on, int sensor, ui_rectangle at,
                     const float range[2])
{
    const float label = 194.0f, number = 34.0f;
    char words[24];
    ui_rectangle bar = {at.x + label, at.y + 4.0f, at.width - label - number - 6.0f, 9.0f};
    float low = share_of(&of->glove, range[0]), high = share_of(&of->glove, range[1]);
    float now = share_of(&of->glove, of->raw[sensor]);
    ui_draw_text(on, at.x, at.y, UI_STYLE_DIM, THEME_DIM, label - 6.0f, sensor_table[sensor].label);
    ui_draw_box(on, bar, THEME_WELL, 2.0f);
    ui_draw_box(
        on, (ui_rectangle){bar.x + low * bar.width, bar.y, (high - low) * bar.width, bar.height},
        THEME_HOVER, 2.0f);
    if (!of->has_sample)
        return;
    ui_draw_box(
        on, (ui_rectangle){bar.x + now * (bar.width - 3.0f), bar.y - 1.0f, 3.0f, bar.height + 2.0f},
        THEME_ACCENT, 1.0f);
    const double shown = of->glove.input[0] ? degrees_per_rad : 1.0;
    (void)snprintf(words, sizeof words, "%.0f", shown * (double)of->raw[sensor]);
    ui_draw_text(on, at.x + at.width - ui_text_width(on, UI_STYLE_BODY, words), at.y, UI_STYLE_BODY,
                 THEME_TEXT, 0.0f, words);
}

static void draw_bars(const calibrate_panel *self, ui *on)
{
    float low[MRT_ANGLES], high[MRT_ANGLES];
    int order[MRT_ANGLES], count = 0;
    ui_canvas at;
    guide_range(self->guide.guide, low, high);
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (self->guide.glove.sensors >> i & 1u)
            order[count++] = i;
    int rows = (count + COLUMNS - 1) / COLUMNS;
    ui_canvas_begin(on, "bars", 0.0f, bar_height * (float)rows, &at);
    const float gap = 24.0f, wide = (at.where.width - gap) / COLUMNS;
    for (int i = 0; i < count; ++i) {
        const float range[2] = {low[order[i]], high[order[i]]};
        ui_rectangle box = {at.where.x + (float)(i / rows) * (wide + gap),
                            at.where.y + bar_height * (float)(i % rows), wide, bar_height};
        draw_bar(&self->guide, on, order[i], box, range);
    }
    ui_canvas_end(on);
}

static void draw_news(const calibrate_panel *self, ui *on)
{
    static const ui_style style[] = {[CALIBRATE_SAYS] = UI_STYLE_DIM,
                                     [CALIBRATE_TOOK] = UI_STYLE_GOOD,
                                     [CALIBRATE_REFUSED] = UI_STYLE_WARNING};
    ui_scroll_begin(on, "news", 0.0f, news_height);
    if (self->trouble.text[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble.text);
    else
        ui_text_wrapped(on, style[self->guide.tone], self->guide.news);
    ui_scroll_end(on);
}

/* The height is fixed, so that the buttons do not move between poses. */
static void draw_words(const calibrate_panel *self, ui *on)
{
    guide_step step = guide_current(self->guide.guide);
    const char *waits = self->is_away ? "waiting for the hand: no samples arrive"
                                      : guide_wait_text[guide_waiting(self->guide.guide)];
    char name[64];
    (void)snprintf(name, sizeof name, "%s", guide_step_name[step]);
    if (name[0] >= 'a' && name[0] <= 'z')
        name[0] = (char)(name[0] - 'a' + 'A');
    ui_text(on, UI_STYLE_TITLE, name);
    ui_scroll_begin(on, "words", 0.0f, 60.0f);
    ui_text_wrapped(on, UI_STYLE_BODY, guide_instruction(self->guide.guide));
    ui_scroll_end(on);
    ui_text(on, self->is_away ? UI_STYLE_WARNING : UI_STYLE_STRONG, waits);
}

static void draw_pose_buttons(calibrate_panel *self, ui *on)
{
    ui_disabled_begin(on, self->is_away || self->trouble.text[0]);
    if (ui_button(on, "Record now", UI_ACCENT))
        calibrate_guide_advance(&self->guide, guide_next);
    ui_hint(on, "Record this pose without waiting for a still hand (Enter).");
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Back", UI_PLAIN))
        calibrate_guide_back(&self->guide);
    ui_hint(on, "Repeat the previous pose.");
    ui_same_line(on);
    if (ui_button(on, "Skip", UI_PLAIN))
        calibrate_guide_advance(&self->guide, guide_skip);
    ui_hint(on, "Skip this pose and use the default values for its sensors.");
    ui_same_line(on);
    ui_at(on, width - 36.0f - 80.0f);
    ui_width(on, 80.0f);
    if (ui_button(on, "Cancel", UI_QUIET))
        ui_dialog_close(on);
    if (!self->is_away && !self->trouble.text[0] && ui_pressed(on, UI_KEY_ENTER, 0))
        calibrate_guide_advance(&self->guide, guide_next);
}

/* Draws the pose from the user's point of view. */
static void draw_figure(const calibrate_panel *self, ui *on)
{
    float angle_rad[MRT_ANGLES];
    ui_canvas at;
    guide_pose(guide_current(self->guide.guide), angle_rad);
    ui_canvas_begin(on, "figure", figure_size, figure_size, &at);
    hand_figure_draw(on, at.where, self->skeleton[self->guide.glove.side], angle_rad,
                     1e-9 * (double)clock_now_ns(),
                     self->guide.glove.side == MRT_LEFT ? THEME_LEFT : THEME_RIGHT);
    ui_canvas_end(on);
}

static void draw_poses(calibrate_panel *self, ui *on)
{
    draw_steps(self, on);
    ui_space(on, 4.0f);
    ui_scroll_begin(on, "pose", -figure_size - 8.0f, figure_size);
    draw_words(self, on);
    ui_scroll_end(on);
    ui_same_line(on);
    draw_figure(self, on);
    ui_space(on, 6.0f);
    draw_bars(self, on);
    ui_space(on, 6.0f);
    draw_news(self, on);
    draw_pose_buttons(self, on);
}

/* ---- result ---- */

static void draw_summary(const calibration_file *file, ui *on)
{
    int measured = 0, shipped = 0, worst = -1;
    char words[160];
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const calibration_sensor *sensor = &file->sensor[i];
        if (sensor->table.count == 0)
            continue;
        measured += sensor->source == CALIBRATION_MEASURED;
        shipped += sensor->source == CALIBRATION_SHIPPED || sensor->source == CALIBRATION_ZEROED;
        if (sensor->has_residual &&
            (worst < 0 || sensor->residual_rad > file->sensor[worst].residual_rad))
            worst = i;
    }
    (void)snprintf(words, sizeof words, "%d measured, %d %s", measured, shipped,
                   file->input[0] ? "the others not calibrated" : "with the default gain");
    ui_fact(on, "Sensors", 130.0f, UI_STYLE_BODY, words);
    if (worst < 0)
        return;
    (void)snprintf(words, sizeof words, "%.1f deg, %s",
                   (double)file->sensor[worst].residual_rad * degrees_per_rad,
                   sensor_table[worst].label);
    ui_fact(on, "Worst residual", 130.0f, UI_STYLE_BODY, words);
}

static const float worth_telling = 0.1f; /* cross-talk of one sensor in another, rad per rad */

/* Lists flaws first, then cross-talk: one line for each sensor above the threshold. */
static void draw_findings(const calibrate_panel *self, ui *on)
{
    const guide_judgement *judgement = &self->guide.judgement;
    char words[200];
    uint32_t count = judgement->flaw_count;
    ui_scroll_begin(on, "findings", 0.0f, 132.0f);
    for (uint32_t i = 0; i < judgement->flaw_count; ++i) {
        guide_flaw_text(&judgement->flaw[i], words, sizeof words);
        ui_text_wrapped(on, UI_STYLE_WARNING, words);
    }
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const calibration_sensor *sensor = &self->guide.result->sensor[i];
        for (int k = 0; k < MRT_ANGLES && sensor->table.count > 0; ++k) {
            if (!(fabsf(sensor->cross_talk[k]) >= worth_telling))
                continue;
            (void)snprintf(words, sizeof words, "%s changes when %s moves: %.0f %%",
                           sensor_table[k].label, sensor_table[i].label,
                           100.0 * (double)sensor->cross_talk[k]);
            ui_text_wrapped(on, UI_STYLE_DIM, words);
            count += 1;
        }
    }
    if (count == 0)
        ui_text(on, UI_STYLE_GOOD,
                self->guide.glove.input[0]
                    ? "Every joint matches the poses."
                    : "Every sensor is repeatable and independent of the others.");
    ui_scroll_end(on);
}

static void keep(calibrate_panel *self, ui *on)
{
    char *path = NULL;
    double length_mm = strtod(self->length, NULL);
    bool has_length = length_mm >= HAND_LENGTH_MIN_MM && length_mm <= HAND_LENGTH_MAX_MM;
    if (self->length[0] && !has_length) {
        (void)error_set(
            &self->trouble, MRT_ERR_ARGUMENT,
            "Enter a hand length between %d and %d mm, from the wrist to the middle fingertip.",
            HAND_LENGTH_MIN_MM, HAND_LENGTH_MAX_MM);
        return;
    }
    if (calibrate_guide_keep(&self->guide, self->name, has_length ? length_mm : 0.0, &path,
                             &self->trouble) < 0)
        return;
    free(self->kept);
    self->kept = path;
    self->kept_side = self->guide.glove.side;
    self->has_kept = true;
    leave(self);
    ui_dialog_close(on);
}

static void draw_verdict(const guide_judgement *judgement, ui *on)
{
    char words[96];
    bool is_good = judgement->flaw_count == 0 && judgement->left_out == 0;
    guide_judgement_text(judgement, words, sizeof words);
    ui_text(on, is_good ? UI_STYLE_GOOD : UI_STYLE_WARNING, words);
}

/* Offers to repeat the pose that improves the result most. The repeat is the default button only if
 * the result is wrong, not if it is merely loose. */
static void draw_result_buttons(calibrate_panel *self, ui *on)
{
    const guide_judgement *judgement = &self->guide.judgement;
    const guide_flaw *first = judgement->flaw_count > 0 ? &judgement->flaw[0] : NULL;
    bool is_wrong = first && guide_flaw_is_wrong(first);
    char again[48];
    guide_step step = first ? first->step : GUIDE_STEPS;
    if (step < GUIDE_STEPS) {
        (void)snprintf(again, sizeof again, "Repeat: %s", guide_step_name[step]);
        if (ui_button(on, again, is_wrong ? UI_ACCENT : UI_PLAIN)) {
            calibrate_guide_again(&self->guide, step);
            return;
        }
        ui_hint(on, "Repeat only this pose and keep the others.");
        ui_same_line(on);
    }
    if (ui_button(on, "Save and use", is_wrong ? UI_PLAIN : UI_ACCENT))
        keep(self, on);
    ui_same_line(on);
    if (ui_button(on, "Back", UI_PLAIN))
        calibrate_guide_back(&self->guide);
    ui_hint(on, "Repeat the last pose.");
    ui_same_line(on);
    ui_at(on, width - 36.0f - 80.0f);
    ui_width(on, 80.0f);
    if (ui_button(on, "Cancel", UI_QUIET))
        ui_dialog_close(on);
}

static void draw_result(calibrate_panel *self, ui *on)
{
    draw_verdict(&self->guide.judgement, on);
    ui_space(on, 4.0f);
    draw_summary(self->guide.result, on);
    ui_space(on, 4.0f);
    draw_findings(self, on);
    ui_space(on, 4.0f);
    ui_label(on, "name", 122.0f, THEME_DIM, "Name");
    ui_width(on, 300.0f);
    (void)ui_input(on, "##name", "name of the performer", self->name, sizeof self->name);
    ui_label(on, "length", 122.0f, THEME_DIM, "Hand length, mm");
    ui_width(on, 300.0f);
    (void)ui_input(on, "##length", "wrist to middle fingertip, if known", self->length,
                   sizeof self->length);
    ui_space(on, 4.0f);
    ui_scroll_begin(on, "trouble", 0.0f, 40.0f);
    ui_text_wrapped(on, UI_STYLE_BAD, self->trouble.text);
    ui_scroll_end(on);
    draw_result_buttons(self, on);
}

static void draw_without_result(calibrate_panel *self, ui *on)
{
    draw_news(self, on);
    if (ui_button(on, "Back", UI_PLAIN))
        calibrate_guide_back(&self->guide);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_QUIET))
        ui_dialog_close(on);
}

/* Poses take time to record. If at least this many are recorded, closing the dialog asks for
 * confirmation. */

enum { ASKED_FROM = 3 };

static uint32_t taken(const calibrate_panel *self)
{
    uint32_t count = 0;
    for (int step = 0; step < GUIDE_STEPS; ++step)
        count += guide_has(self->guide.guide, (guide_step)step);
    return count;
}

/* Escape returns to the calibration. */
static void draw_giving_up(calibrate_panel *self, ui *on)
{
    char words[80];
    (void)snprintf(words, sizeof words, "%u poses were recorded. They are not saved yet.",
                   taken(self));
    ui_text_wrapped(on, UI_STYLE_BODY, words);
    ui_space(on, 8.0f);
    if (ui_button(on, "Continue", UI_ACCENT) || ui_pressed(on, UI_KEY_ENTER, 0))
        self->gives_up = false;
    ui_same_line(on);
    if (ui_button(on, "Discard poses", UI_PLAIN)) {
        leave(self);
        ui_dialog_close(on);
    }
}

/* Handles the close of the dialog by Escape or Cancel. */
static void was_closed(calibrate_panel *self)
{
    if (!self->gives_up && taken(self) < ASKED_FROM) {
        leave(self);
        return;
    }
    self->gives_up = !self->gives_up;
    self->is_asked = true;
}

void calibrate_panel_draw(calibrate_panel *self, ui *on)
{
    char title[160];
    bool was_asked = self->is_asked;
    if (!self->glove)
        return;
    if (was_asked)
        ui_dialog_open(on, dialog);
    self->is_asked = false;
    (void)snprintf(title, sizeof title, "Calibrate the %s hand: %.90s",
                   side_word[self->guide.glove.side], input_name(self->glove));
    if (!ui_dialog_begin(on, dialog, title, width)) {
        if (!was_asked)
            was_closed(self);
        return;
    }
    if (self->gives_up)
        draw_giving_up(self, on);
    else if (self->guide.result)
        draw_result(self, on);
    else if (guide_current(self->guide.guide) < GUIDE_STEPS)
        draw_poses(self, on);
    else
        draw_without_result(self, on);
    ui_dialog_end(on);
}
