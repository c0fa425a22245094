#include "window/mapping_panel_inside.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void mapping_presets_read(mapping_panel *self)
{
    free(self->presets);
    self->presets = NULL;
    self->preset_count =
        self->type ? presets_list(studio_settings(self->studio), self->type, &self->presets) : 0;
    self->preset_edition = mapping_steps_preset_edition(self->steps);
}

static void use(mapping_panel *self, const instance *mapping, const char *name)
{
    error note = {""};
    char words[EDIT_TEXT];
    const char *text = presets_kept(studio_settings(self->studio), mapping->type, name);
    if (!text)
        return;
    presets_values(mapping->type, text, self->values, &note);
    (void)snprintf(words, sizeof words, "preset '%s'", name);
    mapping_panel_set(self, self->values, words);
    (void)snprintf(self->preset, sizeof self->preset, "%s", name);
    if (note.text[0])
        news_list_add(studio_news(self->studio), MRT_LOG_WARNING, "mapping", note.text);
}

static void save(mapping_panel *self)
{
    char clean[PRESET_NAME];
    if (!presets_clean_name(clean, self->preset_name))
        return;
    mapping_steps_save_preset(self->steps, clean);
    (void)snprintf(self->preset, sizeof self->preset, "%s", clean);
    self->is_naming = false;
}

/* What is set now is the preset that was used last, and no more. */
static bool is_still(const mapping_panel *self, const instance *mapping)
{
    char now[PRESET_TEXT];
    const char *text =
        self->preset[0] ? presets_kept(studio_settings(self->studio), mapping->type, self->preset)
                        : NULL;
    if (!text)
        return true;
    presets_text(mapping, now, sizeof now);
    return strcmp(now, text) == 0;
}

static void draw_naming(mapping_panel *self, ui *on)
{
    if (!self->was_naming)
        ui_input_take_keys(on);
    self->was_naming = true;
    ui_width(on, -132.0f);
    (void)ui_input(on, "##preset name", "name of the preset", self->preset_name,
                   sizeof self->preset_name);
    const bool is_entered = ui_input_is_entered(on);
    ui_same_line(on);
    ui_width(on, 58.0f);
    char clean[PRESET_NAME];
    const bool is_name = presets_clean_name(clean, self->preset_name);
    ui_disabled_begin(on, !is_name);
    if (ui_button(on, "Save", UI_ACCENT) || (is_entered && is_name))
        save(self);
    ui_disabled_end(on);
    ui_same_line(on);
    ui_width(on, 66.0f);
    if (ui_button(on, "Cancel##preset", UI_QUIET))
        self->is_naming = false;
}

static void draw_list(mapping_panel *self, ui *on, const instance *mapping)
{
    const char *items[MAPPING_CHOICES_MAX];
    char shown[PRESET_NAME + 16];
    uint32_t count = 0, chosen = UINT32_MAX;
    for (; count < self->preset_count && count < MAPPING_CHOICES_MAX - 1; ++count) {
        items[count] = self->presets[count];
        if (strcmp(self->presets[count], self->preset) == 0)
            chosen = count;
    }
    bool is_changed = chosen != UINT32_MAX && !is_still(self, mapping);
    if (is_changed) {
        (void)snprintf(shown, sizeof shown, "%s (changed)", self->preset);
        items[count] = shown;
    } else if (chosen == UINT32_MAX) {
        items[count] = count > 0 ? "choose\xe2\x80\xa6" : "none saved";
    }
    uint32_t at = is_changed || chosen == UINT32_MAX ? count : chosen;
    ui_width(on, 0.0f);
    if (ui_choice(on, "Preset", 66.0f, items, at == count ? count + 1 : count, &at) &&
        at < self->preset_count)
        use(self, mapping, self->presets[at]);
    ui_hint(on, "Values of all parameters under a name, kept for this mapping.");
}

void mapping_presets_draw(mapping_panel *self, ui *on, instance *mapping)
{
    if (self->preset_edition != mapping_steps_preset_edition(self->steps))
        mapping_presets_read(self);
    if (self->is_naming) {
        draw_naming(self, on);
        return;
    }
    draw_list(self, on, mapping);
    ui_text(on, UI_STYLE_DIM, "");
    ui_at(on, 66.0f);
    if (ui_button(on, "Save as\xe2\x80\xa6", UI_PLAIN)) {
        self->is_naming = true;
        self->was_naming = false;
        (void)snprintf(self->preset_name, sizeof self->preset_name, "%s", self->preset);
    }
    if (!self->preset[0] ||
        !presets_kept(studio_settings(self->studio), mapping->type, self->preset))
        return;
    ui_same_line(on);
    if (ui_button(on, "Delete", UI_QUIET))
        mapping_steps_delete_preset(self->steps, self->preset);
    ui_hint(on, "Deletes the preset; what is set now stays. Undo brings it back.");
}
