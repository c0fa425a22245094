#include "window/mapping_panel_inside.h"
#include "window/mapping_panel_pedal_table.h"
#include "window/theme.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float label_width = 118.0f;

static void draw_pedal(mapping_panel *self, ui *on, const instance *mapping, uint32_t pedal)
{
    char words[256], id[16];
    ui_canvas at;
    float down = studio_view(self->studio)->pedal[pedal - 1];
    uint32_t rezero =
        (uint32_t)settings_number(studio_settings(self->studio), "hands.rezero_pedal", 0.0);
    if (rezero == pedal)
        (void)snprintf(words, sizeof words, "Re-zero");
    else
        pedal_table_words(mapping->type, self->values, pedal, words, sizeof words);
    (void)snprintf(id, sizeof id, "%u", pedal);
    ui_canvas_begin(on, id, 0.0f, 26.0f, &at);
    float middle = at.where.y + 13.0f, share = fminf(fmaxf(down, 0.0f), 1.0f);
    const ui_rectangle well = {at.where.x + 26.0f, middle - 4.0f, 56.0f, 8.0f};
    ui_draw_text(on, at.where.x + 6.0f, middle - 8.0f, UI_STYLE_STRONG, THEME_TEXT, 0.0f, id);
    ui_draw_box(on, well, THEME_WELL, 2.0f);
    if (share > 0.0f)
        ui_draw_box(on, (ui_rectangle){well.x, well.y, well.width * share, well.height},
                    THEME_ACCENT, 2.0f);
    ui_draw_text(on, at.where.x + 96.0f, middle - 8.0f, UI_STYLE_BODY,
                 words[0] ? THEME_TEXT : THEME_DIM, at.where.width - 98.0f,
                 words[0] ? words : "does nothing");
    ui_canvas_end(on);
    if (words[0])
        ui_hint(on, words);
}

void mapping_pedals_draw(mapping_panel *self, ui *on, instance *mapping)
{
    char meaning[PEDAL_MEANING];
    uint32_t count = 0;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        self->values[i] = instance_value(mapping, i);
    for (uint32_t pedal = 1; pedal <= MRT_MAX_PEDALS; ++pedal)
        draw_pedal(self, on, mapping, pedal);
    ui_space(on, 4.0f);
    ui_rule(on);
    ui_space(on, 4.0f);
    self->label_width = label_width;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        if (!pedal_table_meaning(&mapping->type->params[i], meaning))
            continue;
        mapping_param_draw(self, on, mapping, i, meaning);
        count += 1;
    }
    if (count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM, "This mapping uses no pedals.");
    ui_space(on, 4.0f);
    ui_text_wrapped(on, UI_STYLE_DIM,
                    "The pedal that re-zeroes the hands is chosen at Devices (F2).");
}
