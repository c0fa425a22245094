/* The devices panel: what performs, how it is doing, and what could be opened. */
#include "window/devices_panel_inside.h"
#include "window/panels.h"
#include "window/theme.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const pedal_items[MRT_MAX_PEDALS + 1] = {"no pedal", "pedal 1", "pedal 2",
                                                            "pedal 3", "pedal 4"};
static const char *const calibration_key[2] = {"hands.calibration.left", "hands.calibration.right"};
static const char rezero_key[] = "hands.rezero_pedal";

struct panel {
    devices_panel of;
};

/* ---- what is done ---- */

void devices_panel_say(devices_panel *self, const char *text)
{
    (void)snprintf(self->trouble, sizeof self->trouble, "%s", text);
    if (text[0])
        news_list_add(studio_news(self->studio), MRT_LOG_ERROR, "devices", text);
}

void devices_panel_add(devices_panel *self, const char *text)
{
    self->trouble[0] = '\0';
    (void)!studio_open_input(self->studio, text); /* says itself why it failed */
}

static void remove_input(devices_panel *self, uint32_t index)
{
    error err = {""};
    mrt_result result = live_remove_input(studio_live(self->studio), index, &err);
    devices_panel_say(self, result < 0 ? err.text : "");
}

void devices_panel_calibrate(devices_panel *self, uint32_t side, const char *path)
{
    error err = {""};
    if (live_calibrate(studio_live(self->studio), side, path[0] ? path : NULL, &err) < 0) {
        devices_panel_say(self, err.text);
        return;
    }
    devices_panel_say(self, "");
    settings_set_text(studio_settings(self->studio), calibration_key[side], path);
}

/* ---- kept between runs ---- */

static void use_settings(devices_panel *self)
{
    const settings *kept = studio_settings(self->studio);
    live *stage = studio_live(self->studio);
    double pedal = settings_number(kept, rezero_key, 0.0);
    if (pedal >= 1.0 && pedal <= MRT_MAX_PEDALS)
        live_set_rezero_pedal(stage, (uint32_t)pedal);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT; ++side) {
        const char *path = settings_text(kept, calibration_key[side], NULL);
        const char *used = live_calibration(stage, side);
        if (!path || (used && strcmp(used, path) == 0))
            continue;
        char copy[DEVICES_PATH];
        (void)snprintf(copy, sizeof copy, "%s", path);
        error err = {""};
        if (live_calibrate(stage, side, copy[0] ? copy : NULL, &err) < 0)
            news_list_add(studio_news(self->studio), MRT_LOG_WARNING, "devices", err.text);
    }
}

/* ---- re-zero ---- */

/* Which of the two was last. */
static void follow_rezeros(devices_panel *self)
{
    const rezero_counts *now = &studio_status(self->studio)->rezeros;
    if (now->refused != self->rezeros.refused)
        self->was_refused = true;
    if (now->done != self->rezeros.done)
        self->was_refused = false;
    self->rezeros = *now;
}

static void draw_rezero(devices_panel *self, ui *on)
{
    uint32_t pedal = (uint32_t)settings_number(studio_settings(self->studio), rezero_key, 0.0);
    if (ui_button(on, "Re-zero", UI_PLAIN))
        studio_do(self->studio, ACTION_REZERO);
    ui_hint(on, "Z. The pose that the hands hold now becomes their neutral one. Hold still.");
    ui_same_line(on);
    ui_at(on, 92.0f);
    if (ui_choice(on, "also by", 58.0f, pedal_items, MRT_MAX_PEDALS + 1, &pedal)) {
        settings_set_number(studio_settings(self->studio), rezero_key, (double)pedal);
        live_set_rezero_pedal(studio_live(self->studio), pedal);
    }
    ui_hint(on, "A press of this pedal re-zeroes too; mappings do not see that pedal then.");
    if (self->was_refused && self->rezeros.refusal.text[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, self->rezeros.refusal.text);
}

/* ---- the panel ---- */

/* What was opened beside the window, or closed: what is plugged in is looked at anew. */
static void follow_inputs(devices_panel *self)
{
    const uint32_t count = live_input_count(studio_live(self->studio));
    if (count != self->input_count && self->search)
        devices_search_again(self->search);
    self->input_count = count;
}

static void draw_inputs(devices_panel *self, ui *on)
{
    live *stage = studio_live(self->studio);
    uint32_t removed = UINT32_MAX;
    char id[32];
    for (uint32_t i = 0; i < live_input_count(stage); ++i) {
        (void)snprintf(id, sizeof id, "input %u", i);
        ui_id_begin(on, id);
        if (!devices_card_draw(self, on, i))
            removed = i;
        ui_id_end(on);
        ui_space(on, 2.0f);
        ui_rule(on);
        ui_space(on, 2.0f);
    }
    for (uint32_t i = 0; i < self->opening_count; ++i) {
        (void)snprintf(id, sizeof id, "opening %u", i);
        ui_id_begin(on, id);
        if (!devices_card_draw_opening(on, &self->opening[i]))
            studio_give_up_opening(self->studio, self->opening[i].id);
        ui_id_end(on);
        ui_space(on, 2.0f);
        ui_rule(on);
        ui_space(on, 2.0f);
    }
    if (live_input_count(stage) == 0 && self->opening_count == 0) {
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No hand yet. Drag the face with the mouse, or open something below.");
        ui_space(on, 4.0f);
    }
    if (removed != UINT32_MAX)
        remove_input(self, removed);
}

static void draw_trouble(const devices_panel *self, ui *on)
{
    const char *words = self->trouble[0] ? self->trouble : studio_opening_trouble(self->studio);
    if (!words[0])
        return;
    ui_space(on, 4.0f);
    ui_text_wrapped(on, UI_STYLE_BAD, words);
}

static void draw(panel *self_, ui *on, ui_rectangle where)
{
    devices_panel *self = &self_->of;
    static const device_list no_devices = {.count = 0};
    static const calibration_list no_calibrations = {.count = 0};
    self->seen = (devices_seen){false, &no_devices, &no_calibrations, ""};
    if (self->search) {
        devices_search_want(self->search);
        self->seen = devices_search_look(self->search);
    }
    self->opening_count = studio_openings(self->studio, self->opening);
    ui_panel_begin(on, "devices", where, UI_GROUND_PANEL);
    ui_scroll_begin(on, "scroll", 0.0f, 0.0f);
    draw_inputs(self, on);
    draw_rezero(self, on);
    draw_trouble(self, on);
    ui_space(on, 6.0f);
    ui_rule(on);
    devices_open_draw(self, on);
    ui_scroll_end(on);
    calibrate_panel_draw(self->calibrate, on);
    ui_panel_end(on);
}

static void update(panel *self_, double dt_s)
{
    devices_panel *self = &self_->of;
    uint32_t side;
    (void)dt_s;
    follow_rezeros(self);
    follow_inputs(self);
    calibrate_panel_update(self->calibrate);
    const char *kept = calibrate_panel_take_kept(self->calibrate, &side);
    if (!kept)
        return;
    devices_panel_calibrate(self, side, kept);
    if (self->search)
        devices_search_again(self->search);
}

static void destroy(panel *self)
{
    if (!self)
        return;
    devices_search_destroy(self->of.search);
    calibrate_panel_destroy(self->of.calibrate);
    free(self);
}

static panel *create(studio *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of.studio = of;
    self->of.repeats = true;
    self->of.calibrate = calibrate_panel_create(of);
    self->of.search = devices_search_create(studio_plugins(of), studio_log(of));
    if (!self->of.calibrate) {
        destroy(self);
        return NULL;
    }
    use_settings(&self->of);
    self->of.rezeros = studio_status(of)->rezeros;
    return self;
}

const panel_type panel_devices = {create, destroy, draw, update};
