#include "window/devices_panel_inside.h"
#include "window/devices_panel_words.h"
#include "window/theme.h"

#include "stage/glove_channels.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float label_width = 104.0f, strip_height = 30.0f;
static const char *const side_name[2] = {"Left hand", "Right hand"};
static const uint32_t light_colour[] = {[DEVICES_OVER] = THEME_DIM,
                                        [DEVICES_WELL] = THEME_GOOD,
                                        [DEVICES_WAITS] = THEME_WARNING,
                                        [DEVICES_FAILED] = THEME_BAD};
static const ui_style light_style[] = {[DEVICES_OVER] = UI_STYLE_DIM,
                                       [DEVICES_WELL] = UI_STYLE_DIM,
                                       [DEVICES_WAITS] = UI_STYLE_WARNING,
                                       [DEVICES_FAILED] = UI_STYLE_BAD};

/* ---- head ---- */

/* False: the button at its end was pressed. */
static bool draw_head(ui *on, const char *name, devices_light light, const char *button,
                      const char *hint)
{
    ui_canvas at;
    const float remove = 74.0f;
    ui_canvas_begin(on, "head", ui_available_width(on) - remove, ui_row_height(on), &at);
    float middle = at.where.y + 0.5f * at.where.height;
    ui_draw_disc(on, at.where.x + 6.0f, middle, 4.5f, light_colour[light]);
    ui_draw_text(on, at.where.x + 18.0f, middle - 0.5f * ui_text_height(on, UI_STYLE_STRONG),
                 UI_STYLE_STRONG, THEME_TEXT, at.where.width - 22.0f, name);
    ui_canvas_end(on);
    ui_hint(on, name);
    ui_same_line(on);
    ui_width(on, -0.001f);
    bool stays = !ui_button(on, button, UI_QUIET);
    ui_hint(on, hint);
    return stays;
}

static void draw_state(ui *on, const health_report *health, devices_light light, const char *state,
                       const char *why)
{
    char rate[32];
    ui_text(on, light_style[light], state);
    if (light == DEVICES_WELL && health->rate_hz > 0.0) {
        (void)snprintf(rate, sizeof rate, "%.0f Hz", health->rate_hz);
        ui_same_line(on);
        ui_at(on, label_width + 60.0f);
        ui_text(on, UI_STYLE_BODY, rate);
    }
    if (why[0])
        ui_text_wrapped(on, UI_STYLE_DIM, why);
}

/* ---- bars of all channels ---- */

static float share_of(const mrt_channel *channel, float value)
{
    float span = channel->max - channel->min;
    float share = span > 0.0f ? (value - channel->min) / span : 0.0f;
    return isfinite(share) ? fminf(fmaxf(share, 0.0f), 1.0f) : 0.0f;
}

static uint32_t colour_of(const mrt_channel *channel)
{
    if (channel->hand == MRT_LEFT)
        return THEME_LEFT;
    return channel->hand == MRT_RIGHT ? THEME_RIGHT : THEME_ACCENT;
}

static void draw_channel(ui *on, const ui_canvas *at, const mrt_channel *channel, float value,
                         uint32_t index, float wide)
{
    float high = at->where.height * share_of(channel, value);
    float x = at->where.x + wide * (float)index;
    ui_rectangle well = {x, at->where.y, wide - 2.0f, at->where.height};
    ui_rectangle bar = {x, at->where.y + at->where.height - high, wide - 2.0f, high};
    ui_draw_box(on, well, THEME_WELL, 1.0f);
    ui_draw_box(on, bar, colour_of(channel), 1.0f);
}

/* sample NULL: none yet. */
static void draw_strip(ui *on, const mrt_channel *channels, uint32_t count,
                       const mrt_sample *sample)
{
    ui_canvas at;
    char hint[128];
    ui_canvas_begin(on, "strip", 0.0f, strip_height, &at);
    float wide = fminf(at.where.width / (float)(count ? count : 1), 40.0f);
    uint32_t known = !sample ? 0 : sample->count < count ? sample->count : count;
    for (uint32_t i = 0; i < count; ++i)
        draw_channel(on, &at, &channels[i], i < known ? sample->value[i] : channels[i].min, i,
                     wide);
    uint32_t pointed = at.x >= 0.0f ? (uint32_t)(at.x / wide) : count;
    ui_canvas_end(on);
    if (!at.is_hovered || pointed >= known)
        return;
    (void)snprintf(hint, sizeof hint, "%.60s: %.4g %.16s", channels[pointed].name,
                   (double)sample->value[pointed], channels[pointed].unit);
    ui_hint(on, hint);
}

/* ---- calibration ---- */

enum { CALIBRATIONS_MAX = 64 };

static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void draw_calibration(devices_panel *self, ui *on, uint32_t index, uint32_t side)
{
    const char *items[CALIBRATIONS_MAX + 2] = {"as shipped"};
    const char *paths[CALIBRATIONS_MAX + 2] = {""};
    const char *used = live_calibration(studio_live(self->studio), side);
    uint32_t count = 1, chosen = used ? UINT32_MAX : 0;
    for (uint32_t i = 0; i < self->seen.calibrations->count && count <= CALIBRATIONS_MAX; ++i) {
        const calibration_entry *entry = &self->seen.calibrations->entry[i];
        if (entry->side != side)
            continue;
        if (used && strcmp(used, entry->path) == 0)
            chosen = count;
        items[count] = entry->label;
        paths[count++] = entry->path;
    }
    if (chosen == UINT32_MAX) { /* of another folder */
        chosen = count;
        items[count] = base_name(used);
        paths[count++] = used;
    }
    if (ui_choice(on, side_name[side], label_width, items, count, &chosen))
        devices_panel_calibrate(self, side, paths[chosen]);
    ui_hint(on, "Whose calibration this hand's sensors are read with.");
    ui_id_begin(on, side_name[side]);
    ui_text(on, UI_STYLE_DIM, "");
    ui_at(on, label_width);
    if (ui_button(on, "Calibrate\xe2\x80\xa6", UI_PLAIN)) {
        error why = {""};
        if (!calibrate_panel_open(self->calibrate, index, side, &why))
            devices_panel_say(self, why.text);
    }
    ui_hint(on, "Ten poses, a minute and a half.");
    ui_id_end(on);
}

/* ---- what is folded away ---- */

static void draw_details(ui *on, const health_report *health, const mrt_channel *channels,
                         uint32_t count)
{
    devices_fact fact[DEVICES_FACTS_MAX];
    char names[DEVICES_WORDS];
    uint32_t facts = devices_words_facts(health, fact);
    for (uint32_t i = 0; i < facts; ++i) {
        ui_fact(on, fact[i].label, label_width, fact[i].is_odd ? UI_STYLE_WARNING : UI_STYLE_BODY,
                fact[i].value);
        ui_hint(on, fact[i].help);
    }
    if (devices_words_saturated(health, channels, count, names) > 0) {
        ui_text(on, UI_STYLE_WARNING, "At an end of their range:");
        ui_text_wrapped(on, UI_STYLE_DIM, names);
    }
}

static void set_value(devices_panel *self, input *of, uint32_t index, double value)
{
    char key[128], text[64];
    error err = {""};
    instance_key(input_plugin(of), index, key, sizeof key);
    (void)snprintf(text, sizeof text, "%.9g", value);
    if (input_set(of, key, text, &err) < 0)
        devices_panel_say(self, err.text);
}

static uint32_t label_count(const mrt_param *p)
{
    uint32_t count = 0;
    while (p->labels && p->labels[count])
        count += 1;
    return count;
}

static void draw_param(devices_panel *self, ui *on, input *of, uint32_t index)
{
    const mrt_param *p = &input_plugin(of)->params[index];
    double value = input_value(of, index);
    if (p->flags & MRT_PARAM_TRIGGER) {
        if (ui_button(on, p->name, UI_PLAIN))
            set_value(self, of, index, 1.0);
    } else if (p->labels) {
        uint32_t chosen = (uint32_t)(value - p->min);
        if (ui_choice(on, p->name, label_width, p->labels, label_count(p), &chosen))
            set_value(self, of, index, p->min + (double)chosen);
    } else {
        ui_range range = {p->min,
                          p->max,
                          p->unit,
                          p->max - p->min < 20.0 ? 2u : 0u,
                          (p->flags & MRT_PARAM_STEPPED) != 0,
                          p->initial};
        if (ui_slider(on, p->name, label_width, &range, &value))
            set_value(self, of, index, value);
    }
    ui_hint(on, p->help);
}

static bool has_params(const mrt_plugin_type *type)
{
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (!(type->params[i].flags & MRT_PARAM_HIDDEN))
            return true;
    return false;
}

static void draw_params(devices_panel *self, ui *on, input *of)
{
    const mrt_plugin_type *type = input_plugin(of);
    for (uint32_t i = 0; i < type->param_count; ++i)
        if (!(type->params[i].flags & MRT_PARAM_HIDDEN))
            draw_param(self, on, of, i);
}

/* What the program itself gives (the keyboard as a hand) is silent whenever nothing moves it. */
static bool is_made(const devices_panel *self, const input *of)
{
    return !plugin_list_path_of(studio_plugins(self->studio), input_plugin(of));
}

bool devices_card_draw(devices_panel *self, ui *on, uint32_t index)
{
    live *stage = studio_live(self->studio);
    input *of = live_input(stage, index);
    uint32_t count;
    const mrt_channel *channels = input_channels(of, &count);
    health_report health;
    mrt_sample sample;
    char state[DEVICES_WORDS], why[DEVICES_WORDS];
    input_health(of, &health);
    devices_light light = devices_words_state(&health, state, why);
    if (is_made(self, of) && light == DEVICES_WAITS) {
        light = DEVICES_WELL;
        (void)snprintf(state, sizeof state, "at rest");
    }
    bool stays = draw_head(on, is_made(self, of) ? input_plugin(of)->name : input_name(of), light,
                           "Remove", "Closes this input. What it has performed stays recorded.");
    draw_state(on, &health, light, state, why);
    bool has_sample = live_input_sample(stage, index, &sample);
    draw_strip(on, channels, count, has_sample ? &sample : NULL);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side)
        if (glove_channels_has(channels, count, side))
            draw_calibration(self, on, index, side);
    if (ui_section(on, "Details", false))
        draw_details(on, &health, channels, count);
    if (has_params(input_plugin(of)) && ui_section(on, "Settings", false))
        draw_params(self, on, of);
    return stays;
}

bool devices_card_draw_opening(ui *on, const studio_opening *one)
{
    bool stays = draw_head(on, one->name, DEVICES_OVER, "Cancel", "Does not open it after all.");
    ui_text(on, UI_STYLE_DIM,
            one->is_open ? "open: joins when the take has ended" : "opening\u2026");
    return stays;
}
