/* The brush: what it paints, how large it is. */
#include "window/rig_panel_inside.h"

#include <stdio.h>
#include <string.h>

enum { INK_ITEMS = RIG_BONES_MAX + 8, ITEM_TEXT = 64 };
static const ui_range radius_range = {1.0, 80.0, "mm", 0, false, 12.0};
static const ui_range strength_range = {5.0, 100.0, "%", 0, true, 100.0};
static const double radius_step = 1.15;
static const char *const falloff_items[] = {"soft", "hard"};

/* The list of inks: bones first, then what is said of mobility. */
typedef struct ink_list {
    char text[INK_ITEMS][ITEM_TEXT];
    const char *item[INK_ITEMS];
    rig_stroke_ink ink[INK_ITEMS];
    uint32_t count;
} ink_list;

static void add_ink(ink_list *list, rig_ink ink, uint32_t bone, const char *text)
{
    uint32_t i = list->count++;
    (void)snprintf(list->text[i], ITEM_TEXT, "%s", text);
    list->item[i] = list->text[i];
    list->ink[i] = (rig_stroke_ink){.ink = ink, .bone = bone};
}

static void list_inks(ink_list *list, const rig *r)
{
    list->count = 0;
    for (uint32_t i = 0; i < r->bone_count; ++i)
        add_ink(list, RIG_INK_RIDES, i, r->bone[i].name);
    add_ink(list, RIG_INK_FREE, 0, "mobile");
    add_ink(list, RIG_INK_STILL, 0, "immobile");
    add_ink(list, RIG_INK_REGION, 0, "the chosen region");
    add_ink(list, RIG_INK_ERASER, 0, "eraser");
}

static bool is_of_bone(rig_ink ink)
{
    return ink == RIG_INK_RIDES || ink == RIG_INK_RIGID;
}

static uint32_t index_of(const ink_list *list, const rig_stroke_ink *ink)
{
    for (uint32_t i = 0; i < list->count; ++i) {
        bool both = is_of_bone(list->ink[i].ink) && is_of_bone(ink->ink);
        if (both ? list->ink[i].bone == ink->bone : list->ink[i].ink == ink->ink)
            return i;
    }
    return 0;
}

static void choose_ink(rig_stroke_ink *ink, const rig_stroke_ink *chosen)
{
    bool stays_rigid = ink->ink == RIG_INK_RIGID && chosen->ink == RIG_INK_RIDES;
    ink->ink = stays_rigid ? RIG_INK_RIGID : chosen->ink;
    ink->bone = chosen->bone;
}

static void draw_ink(rig_panel *self, ui *on, const rig *r)
{
    static const char eraser_hint[] = "Shift while painting is the eraser too.";
    ink_list list;
    rig_stroke_ink *ink = &self->painting.ink;
    list_inks(&list, r);
    uint32_t index = index_of(&list, ink);
    if (ui_choice(on, "Paints", RIG_PANEL_LABEL, list.item, list.count, &index)) {
        choose_ink(ink, &list.ink[index]);
        self->shown.is_tint_new = true;
    }
    ui_hint(on, eraser_hint);
    bool is_rigid = ink->ink == RIG_INK_RIGID;
    if (is_of_bone(ink->ink) && ui_check(on, "Rigid: cannot be pulled", &is_rigid))
        ink->ink = is_rigid ? RIG_INK_RIGID : RIG_INK_RIDES;
    if (ink->ink == RIG_INK_REGION &&
        (self->region == RIG_NONE || !rig_edit_can_paint(r, self->region)))
        ui_text_wrapped(
            on, UI_STYLE_WARNING,
            self->region == RIG_NONE
                ? "Choose a region in the list."
                : "This region is not given vertex by vertex: \"To paint\" makes it so.");
}

static void take_keys(rig_panel *self, const ui *on)
{
    double *radius = &self->painting.shape.radius_mm;
    if (ui_pressed(on, '[', 0))
        *radius /= radius_step;
    if (ui_pressed(on, ']', 0))
        *radius *= radius_step;
    if (*radius < radius_range.min)
        *radius = radius_range.min;
    if (*radius > radius_range.max)
        *radius = radius_range.max;
}

void rig_panel_draw_brush(rig_panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    rig_painting *painting = &self->painting;
    if (ui_button(on, painting->is_on ? "Painting##brush" : "Paint##brush",
                  painting->is_on ? UI_ACCENT : UI_PLAIN)) {
        painting->is_on = !painting->is_on;
        rig_panel_end_stroke(self);
        self->shown.is_tint_new = self->shown.is_shape_new = true;
    }
    ui_hint(on,
            "The brush on the face, which is shown at rest. The performance goes on meanwhile.");
    ui_same_line(on);
    ui_at(on, 104.0f);
    (void)ui_check(on, "Both sides##brush", &self->is_even);
    if (painting->is_on)
        take_keys(self, on);
    draw_ink(self, on, r);
    (void)ui_slider(on, "Radius", RIG_PANEL_LABEL, &radius_range, &painting->shape.radius_mm);
    ui_hint(on, "[ and ]");
    double strength = 100.0 * painting->ink.strength;
    if (ui_slider(on, "Strength", RIG_PANEL_LABEL, &strength_range, &strength))
        painting->ink.strength = strength / 100.0;
    uint32_t falloff = (uint32_t)painting->shape.falloff;
    if (ui_choice(on, "Edge", RIG_PANEL_LABEL, falloff_items, 2, &falloff))
        painting->shape.falloff = (brush_falloff)falloff;
}
