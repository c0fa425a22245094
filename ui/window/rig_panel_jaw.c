/* The jaw: its axis and limits, and what it does to the face when it is tried. */
#include "base/angle.h"
#include "window/rig_panel_inside.h"

#include <stdio.h>
#include <string.h>

static const double degree = ANGLE_PI / 180.0;
static const ui_range close_range = {-20.0, 0.0, "\xc2\xb0", 0, false, 0.0};
static const ui_range open_range = {5.0, 60.0, "\xc2\xb0", 0, false, 32.0};
static const ui_range lateral_range = {0.0, 30.0, "mm", 1, false, 10.0};
static const ui_range forward_range = {0.0, 30.0, "mm", 1, false, 8.0};
static const ui_range slide_range = {0.0, 30.0, "mm", 1, false, 12.0};

/* True while it is held or was changed in this frame. */
static bool draw_number(ui *on, const char *label, const ui_range *range, double *value)
{
    bool has_changed = ui_slider(on, label, RIG_PANEL_LABEL, range, value);
    return has_changed || ui_slider_is_held(on);
}

static void draw_limits(rig_panel *self, ui *on)
{
    rig_jawing *jawing = &self->jawing;
    double open_deg = jawing->jaw.open_max_rad / degree;
    double close_deg = jawing->jaw.open_min_rad / degree;
    bool was_changing = jawing->is_changing, is_held = false;
    ui_text(on, UI_STYLE_TITLE, "Limits");
    if (draw_number(on, "Opens", &open_range, &open_deg)) {
        jawing->jaw.open_max_rad = open_deg * degree;
        is_held = true;
    }
    if (draw_number(on, "Closes", &close_range, &close_deg)) {
        jawing->jaw.open_min_rad = close_deg * degree;
        is_held = true;
    }
    ui_hint(on, "Tighter than the mesh has it: where that has a mouth that stands open a little.");
    is_held = draw_number(on, "Aside", &lateral_range, &jawing->jaw.lateral_mm) || is_held;
    is_held = draw_number(on, "Forward", &forward_range, &jawing->jaw.forward_mm) || is_held;
    is_held = draw_number(on, "Slides", &slide_range, &jawing->jaw.slide_mm) || is_held;
    ui_hint(on, "How far its joints go forward and down as it opens.");
    if (jawing->held != RIG_HANDLES)
        return;
    jawing->is_changing = is_held;
    if (was_changing && !is_held)
        rig_panel_put_jaw(self);
}

static void draw_place(ui *on, const char *label, vec3 at)
{
    char text[64];
    (void)snprintf(text, sizeof text, "%.1f  %.1f  %.1f mm", at.x, at.y, at.z);
    ui_fact(on, label, RIG_PANEL_LABEL, UI_STYLE_NUMBER, text);
}

static void draw_axis(rig_panel *self, ui *on)
{
    rig_edit_jaw *jaw = &self->jawing.jaw;
    bool has_incisor = jaw->has_incisor;
    ui_text(on, UI_STYLE_TITLE, "Axis");
    ui_text_wrapped(on, UI_STYLE_DIM,
                    "Drag the balls on the face: the two joints before the ears, and the edge of "
                    "the lower front teeth.");
    draw_place(on, "Left", jaw->left);
    draw_place(on, "Right", jaw->right);
    if (jaw->has_incisor)
        draw_place(on, "Teeth", jaw->incisor);
    (void)ui_check(on, "Both sides##jaw", &self->is_even);
    if (!ui_check(on, "The teeth are placed by hand", &has_incisor))
        return;
    if (has_incisor) {
        const rig_work *work = rig_model_work(self->model);
        jaw->incisor = work && work->face ? face_bones(work->face)->incisor : jaw->incisor;
    }
    jaw->has_incisor = has_incisor;
    rig_panel_put_jaw(self);
}

static void draw_try(rig_panel *self, ui *on)
{
    rig_jawing *jawing = &self->jawing;
    ui_range open = {jawing->jaw.open_min_rad / degree,
                     jawing->jaw.open_max_rad / degree,
                     "\xc2\xb0",
                     0,
                     false,
                     0.0};
    ui_range aside = {-jawing->jaw.lateral_mm, jawing->jaw.lateral_mm, "mm", 1, false, 0.0};
    ui_range forward = {0.0, jawing->jaw.forward_mm, "mm", 1, false, 0.0};
    char text[64];
    bool is_new = false;
    ui_text(on, UI_STYLE_TITLE, "Try");
    is_new = ui_slider(on, "Open##try", RIG_PANEL_LABEL, &open, &jawing->open_deg) || is_new;
    if (aside.max > 0.0)
        is_new = ui_slider(on, "Aside##try", RIG_PANEL_LABEL, &aside, &jawing->aside_mm) || is_new;
    if (forward.max > 0.0)
        is_new =
            ui_slider(on, "Forward##try", RIG_PANEL_LABEL, &forward, &jawing->forward_mm) || is_new;
    (void)snprintf(text, sizeof text, "%.0f mm", jawing->gap_mm);
    ui_fact(on, "Teeth go", RIG_PANEL_LABEL, UI_STYLE_NUMBER, text);
    if (ui_button(on, "Close##try", UI_PLAIN)) {
        jawing->open_deg = jawing->aside_mm = jawing->forward_mm = 0.0;
        is_new = true;
    }
    if (is_new)
        self->shown.is_shape_new = true;
}

void rig_panel_draw_jaw(rig_panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    uint32_t jaw = rig_panel_jaw(r);
    if (jaw == RIG_NONE) {
        ui_text_wrapped(on, UI_STYLE_DIM, "This rig has no jaw: no bone of it has a hinge.");
        return;
    }
    if (!self->jawing.is_changing)
        rig_edit_jaw_of(&self->jawing.jaw, r, jaw);
    draw_try(self, on);
    ui_rule(on);
    draw_limits(self, on);
    ui_rule(on);
    draw_axis(self, on);
}
