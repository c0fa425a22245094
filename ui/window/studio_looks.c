/* What is kept between runs: how things are shown, what was open, and what performed. */
#include "window/studio_state.h"

#include "window/presets.h"
#include "window/theme.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define WRITE_EVERY_S 4.0

typedef struct look_switch {
    const char *key;
    size_t offset;
    bool initial;
} look_switch;

/* The output is not opened by itself: a projector is switched on by a person. */
static const look_switch switches[] = {
    {"looks.hands", offsetof(studio_looks, shows_hands), true},
    {"looks.vectors", offsetof(studio_looks, shows_vectors), false},
    {"looks.supports", offsetof(studio_looks, shows_supports), false},
    {"looks.contacts", offsetof(studio_looks, shows_contacts), false},
    {"looks.jaw", offsetof(studio_looks, shows_jaw), false},
    {"looks.mirrored", offsetof(studio_looks, is_mirrored), true},
    {"looks.turning", offsetof(studio_looks, is_turning), false},
    {"looks.face_only", offsetof(studio_looks, is_face_only), false},
    {"looks.timeline", offsetof(studio_looks, has_timeline), true},
    {"looks.output_mirrored", offsetof(studio_looks, is_output_mirrored), false},
};
enum { SWITCHES = sizeof switches / sizeof switches[0] };

static bool *switch_at(studio_looks *looks, const look_switch *one)
{
    return (bool *)(void *)((char *)looks + one->offset);
}

static float length_of(const settings *from, const char *key, double otherwise, double most)
{
    const double kept = settings_number(from, key, otherwise);
    return (float)(kept >= 60.0 && kept <= most ? kept : otherwise);
}

void studio_looks_read(studio *self)
{
    const settings *from = self->settings;
    studio_looks *looks = &self->looks;
    for (uint32_t i = 0; i < SWITCHES; ++i)
        *switch_at(looks, &switches[i]) =
            settings_number(from, switches[i].key, switches[i].initial) != 0.0;
    const double kept = settings_number(from, "looks.panel", STUDIO_DEVICES);
    if (kept >= 0.0 && kept < STUDIO_PANELS)
        looks->panel = (studio_panel)kept;
    looks->timeline_height = length_of(from, "looks.timeline_height", 220.0, 2000.0);
    looks->dock_width = length_of(from, "looks.dock_width", (double)THEME_DOCK_WIDTH, 1200.0);
    self->looks_kept = *looks;
}

studio_looks *studio_looks_of(studio *self)
{
    return &self->looks;
}

static void keep_looks(studio *self)
{
    settings *to = self->settings;
    studio_looks *looks = &self->looks;
    for (uint32_t i = 0; i < SWITCHES; ++i)
        settings_set_number(to, switches[i].key, *switch_at(looks, &switches[i]) ? 1.0 : 0.0);
    settings_set_number(to, "looks.panel", (double)looks->panel);
    settings_set_number(to, "looks.timeline_height", (double)looks->timeline_height);
    settings_set_number(to, "looks.dock_width", (double)looks->dock_width);
    self->looks_kept = *looks;
}

static void keep_mapping(studio *self)
{
    char values[PRESET_TEXT], text[PRESET_TEXT + 64];
    const instance *mapping = live_mapping(self->live);
    if (!mapping) {
        settings_set_text(self->settings, "last.mapping", "");
        return;
    }
    const mrt_plugin_type *type = isolate_inner(mapping->type);
    presets_text(mapping, values, sizeof values);
    (void)snprintf(text, sizeof text, "%s%s%s", type->id, values[0] ? "," : "", values);
    settings_set_text(self->settings, "last.mapping", text);
}

/* Those that a plugin of the list gives: not what the program itself moves. */
static bool can_be_opened_again(studio *self, const char *text)
{
    char name[128];
    const mrt_plugin_type *type;
    error ignored;
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":,"), text);
    return plugin_list_find(&self->plugins, name, MRT_INPUT, &type, &ignored) >= 0;
}

static void keep_inputs(studio *self)
{
    uint32_t kept = 0;
    char key[24];
    for (uint32_t i = 0; i < live_input_count(self->live) && kept < STUDIO_INPUTS_MAX; ++i) {
        const char *text = live_input_text(self->live, i);
        if (!can_be_opened_again(self, text))
            continue;
        (void)snprintf(key, sizeof key, "inputs.%u", kept++);
        settings_set_text(self->settings, key, text);
    }
    for (; kept < STUDIO_INPUTS_MAX; ++kept) {
        (void)snprintf(key, sizeof key, "inputs.%u", kept);
        settings_set_text(self->settings, key, NULL);
    }
}

void studio_keep_settings_now(studio *self)
{
    error err = {0};
    keep_looks(self);
    if (self->live) {
        keep_mapping(self);
        if (studio_inputs_are_done(self->inputs))
            keep_inputs(self);
    }
    const mrt_result result = settings_write(self->settings, &err);
    if (result < 0 && !self->settings_failed)
        (void)studio_said(self, result, &err);
    self->settings_failed = result < 0;
}

void studio_keep_settings(studio *self, double dt_s)
{
    self->settings_wait_s += dt_s;
    if (self->settings_wait_s < WRITE_EVERY_S)
        return;
    self->settings_wait_s = 0.0;
    studio_keep_settings_now(self);
}
