/* The rig panel: regions, contacts and the check of the rig. */
#include "window/rig/panel.h"
#include "window/gui/theme.h"

#include "base/file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the brush: ink and size ---- */

enum { INK_ITEMS = RIG_BONES_MAX + 8, ITEM_TEXT = 64 };
static const ui_range radius_range = {1.0, 80.0, "mm", 0, false, 12.0};
static const ui_range strength_range = {5.0, 100.0, "%", 0, true, 100.0};
static const double radius_step = 1.15;
static const char *const falloff_items[] = {"soft", "hard"};

/* List of inks: bones first, then mobility. */
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
    add_ink(list, RIG_INK_REGION, 0, "the selected region");
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

static void draw_ink(panel *self, ui *on, const rig *r)
{
    static const char eraser_hint[] = "Choose what the brush paints. Hold Shift to erase.";
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
    if (is_of_bone(ink->ink)) {
        if (ui_check(on, "Rigid: cannot be pulled", &is_rigid))
            ink->ink = is_rigid ? RIG_INK_RIGID : RIG_INK_RIDES;
        ui_hint(on, "The painted skin moves only with its bone, like teeth and eyes.");
    }
    if (ink->ink == RIG_INK_REGION &&
        (self->region == RIG_NONE || !rig_edit_can_paint(r, self->region)))
        ui_text_wrapped(
            on, UI_STYLE_WARNING,
            self->region == RIG_NONE
                ? "Select a region in the list."
                : "This region is not a vertex list. Press \"Make paintable\" to paint it.");
}

static void take_keys(panel *self, const ui *on)
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

static void draw_brush(panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    rig_painting *painting = &self->painting;
    if (ui_button(on, painting->is_on ? "Painting##brush" : "Paint##brush",
                  painting->is_on ? UI_ACCENT : UI_PLAIN)) {
        painting->is_on = !painting->is_on;
        rig_panel_end_stroke(self);
        self->shown.is_tint_new = self->shown.is_shape_new = true;
    }
    ui_hint(on, "Paint on the neutral face. The performance continues in the background.");
    ui_same_line(on);
    ui_at(on, 104.0f);
    (void)ui_check(on, "Both sides##brush", &self->is_even);
    ui_hint(on, "Paint both sides of the face symmetrically.");
    if (painting->is_on)
        take_keys(self, on);
    draw_ink(self, on, r);
    (void)ui_slider(on, "Radius", RIG_PANEL_LABEL, &radius_range, &painting->shape.radius_mm);
    ui_hint(on, "Set the radius of the brush ([ and ]).");
    double strength = 100.0 * painting->ink.strength;
    if (ui_slider(on, "Strength", RIG_PANEL_LABEL, &strength_range, &strength))
        painting->ink.strength = strength / 100.0;
    ui_hint(on, "Set how much one stroke adds.");
    uint32_t falloff = (uint32_t)painting->shape.falloff;
    if (ui_choice(on, "Edge", RIG_PANEL_LABEL, falloff_items, 2, &falloff))
        painting->shape.falloff = (brush_falloff)falloff;
    ui_hint(on, "Choose whether a stroke fades towards the rim of the brush.");
}

/* ---- regions: list and selected region ---- */

enum { WORDS = 400, BONE_ITEMS = RIG_BONES_MAX + 1 };
static const float chip_width = 8.0f, size_width = 62.0f;
static const float list_least = 150.0f; /* height in points */
static const float below_list = 235.0f,
                   below_list_chosen = 405.0f; /* height of the widgets below the list */

typedef enum region_kind { KIND_RIDES = 0, KIND_RIGID, KIND_MOBILITY } region_kind;
static const char *const kind_items[] = {"moves with the bone", "rigid on the bone",
                                         "mobility only"};

/* ---- the list ---- */

static void write_share(char *out, size_t capacity, const char *what, double share)
{
    if (share < 1.0)
        (void)snprintf(out, capacity, "%s %.0f %%", what, 100.0 * share);
    else
        (void)snprintf(out, capacity, "%s", what);
}

/* Writes the effect of a region: "jaw, rigid", "skull 50 %, mobile", "immobile". */
static void describe_region(const rig *r, const rig_region *region, char *out, size_t capacity)
{
    char rides[96] = "", mobile[32] = "";
    const char *bone = region->bone == RIG_NONE ? "" : r->bone[region->bone].name;
    if (region->is_rigid)
        (void)snprintf(rides, sizeof rides, "%s, rigid", bone);
    else if (!isnan(region->weight))
        write_share(rides, sizeof rides, bone, region->weight);
    if (!isnan(region->mobility) && region->mobility > 0.0)
        write_share(mobile, sizeof mobile, "mobile", region->mobility);
    else if (!isnan(region->mobility))
        (void)snprintf(mobile, sizeof mobile, "immobile");
    (void)snprintf(out, capacity, "%s%s%s", rides, rides[0] && mobile[0] ? ", " : "", mobile);
}

static bool is_alike(double a, double b)
{
    return a == b || (isnan(a) && isnan(b));
}

/* Counts the unnamed regions before this one that have the same effect. */
static uint32_t count_same_effect(const rig *r, uint32_t index)
{
    const rig_region *region = &r->region[index];
    uint32_t count = 0;
    for (uint32_t i = 0; i < index; ++i) {
        const rig_region *other = &r->region[i];
        count += !other->name && other->bone == region->bone &&
                 other->is_rigid == region->is_rigid && is_alike(other->weight, region->weight) &&
                 is_alike(other->mobility, region->mobility);
    }
    return count;
}

static void label_of(const rig *r, uint32_t index, char *out, size_t capacity)
{
    char words[140];
    const rig_region *region = &r->region[index];
    const uint32_t before = region->name ? 0 : count_same_effect(r, index);
    describe_region(r, region, words, sizeof words);
    if (before)
        (void)snprintf(out, capacity, "%s (%u)##region%u", words, before + 1, index);
    else
        (void)snprintf(out, capacity, "%s##region%u", region->name ? region->name : words, index);
}

/* Scrolls to the selected row once. Call it after drawing that row. */
static void follow_chosen(panel *self, ui *on)
{
    if (self->is_to_follow)
        ui_scroll_to_row(on);
    self->is_to_follow = false;
}

static void draw_chip(ui *on, uint32_t colour, uint32_t index)
{
    char id[32];
    ui_canvas canvas;
    (void)snprintf(id, sizeof id, "chip%u", index);
    ui_canvas_begin(on, id, chip_width, ui_row_height(on), &canvas);
    ui_rectangle box = canvas.where;
    box.y += 5.0f;
    box.height -= 10.0f;
    ui_draw_box(on, box, colour, 2.0f);
    ui_canvas_end(on);
}

void rig_panel_write_right(ui *on, const char *words)
{
    ui_same_line(on);
    ui_at(on, RIG_PANEL_RIGHT - ui_text_width(on, UI_STYLE_DIM, words));
    ui_text(on, UI_STYLE_DIM, words);
}

static void draw_size(const panel *self, ui *on, uint32_t index)
{
    const rig_work *work = rig_model_work(self->model);
    char text[32] = "\xe2\x80\xa6";
    if (rig_model_is_laid(self->model) && work->region_size && index < work->rig.region_count)
        (void)snprintf(text, sizeof text, "%u", work->region_size[index]);
    rig_panel_write_right(on, text);
    ui_hint(on, "Number of vertices of the region.");
}

/* Of a list with `count` rows: what is left above the widgets below it, at most all rows. */
static float list_height(const ui *on, uint32_t count, float below, float least)
{
    const float left = ui_available_height(on) - below;
    const float all = (float)count * (ui_row_height(on) + 4.0f);
    return fmaxf(fminf(left, all), least);
}

static void draw_region_list(panel *self, ui *on, const rig *r)
{
    const float below = self->region == RIG_NONE ? below_list : below_list_chosen;
    ui_scroll_begin(on, "regions", 0.0f, list_height(on, r->region_count, below, list_least));
    for (uint32_t i = 0; i < r->region_count; ++i) {
        char label[180];
        label_of(r, i, label, sizeof label);
        draw_chip(on, rig_tint_chip(r, r->region[i].bone), i);
        ui_same_line(on);
        ui_width(on, -size_width);
        if (ui_row(on, label, i == self->region) != UI_ROW_NONE)
            rig_panel_choose(self, RIG_TAB_REGIONS, i == self->region ? RIG_NONE : i);
        if (i == self->region)
            follow_chosen(self, on);
        draw_size(self, on, i);
    }
    ui_scroll_end(on);
}

/* ---- changes ---- */

static void add(panel *self)
{
    rig *r = rig_panel_begin(self);
    uint32_t index = RIG_NONE;
    rig_edit_region_values says = {0, false, 1.0, (double)NAN};
    if (!r)
        return;
    mrt_result result = rig_edit_add_region(r, NULL, &says, &index, &self->err);
    if (rig_panel_finish(self, result, "add a region"))
        rig_panel_choose(self, RIG_TAB_REGIONS, index);
}

static void remove_region(panel *self, uint32_t index)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_remove_region(r, index, &self->err),
                               "remove a region");
}

static void move(panel *self, uint32_t index, uint32_t to)
{
    rig *r = rig_panel_begin(self);
    if (r &&
        rig_panel_finish(self, rig_edit_move_region(r, index, to, &self->err), "move a region"))
        self->region = to;
}

/* Converts the selector of a region to a vertex list. */
static void make_paint(panel *self, uint32_t index)
{
    rig *r = rig_panel_begin(self);
    const mesh *m = rig_model_mesh(self->model);
    float *share = self->shown.share;
    if (!r || !share)
        return;
    uint8_t *value = (uint8_t *)self->shown.scratch;
    mrt_result result = bind_select(share, &r->region[index].select, m,
                                    rig_model_topology(self->model), &self->err);
    for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v)
        value[v] = (uint8_t)(share[v] * 255.0f + 0.5f);
    if (result >= 0)
        result = rig_edit_paint(r, index, value, m->vertex_count, &self->err);
    (void)rig_panel_finish(self, result, "make a region paintable");
}

static void set_says(panel *self, const rig_edit_region_values *says, const char *words)
{
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_set_region(r, self->region, says, &self->err), words);
}

/* ---- the selected item ---- */

static void draw_region_name(panel *self, ui *on, const rig_region *region)
{
    if (!rig_panel_draw_name(self, on, "no name", &self->region_name, self->region,
                             region->name ? region->name : ""))
        return;
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self, rig_edit_name_region(r, self->region, self->region_name.text, &self->err),
            "name a region");
}

static void draw_buttons(panel *self, ui *on, const rig *r)
{
    uint32_t index = self->region;
    ui_disabled_begin(on, index == 0);
    if (ui_button(on, "Up", UI_PLAIN))
        move(self, index, index - 1);
    ui_disabled_end(on);
    ui_same_line(on);
    ui_disabled_begin(on, index + 1 >= r->region_count);
    if (ui_button(on, "Down", UI_PLAIN))
        move(self, index, index + 1);
    ui_disabled_end(on);
    ui_hint(on,
            "Move the region in the list. Where two regions have the same vertex, the later one "
            "in the list wins, and a rigid one always.");
    ui_same_line(on);
    if (ui_button(on, "Remove", UI_PLAIN))
        remove_region(self, index);
    ui_same_line(on);
    ui_disabled_begin(on, rig_edit_can_paint(r, index));
    if (ui_button(on, "Make paintable", UI_PLAIN))
        make_paint(self, index);
    ui_disabled_end(on);
    ui_hint(on, "Convert the region to a vertex list that the brush can change.");
}

static region_kind kind_of(const rig_edit_region_values *says)
{
    return says->is_rigid ? KIND_RIGID : isnan(says->weight) ? KIND_MOBILITY : KIND_RIDES;
}

static void change_kind(panel *self, const rig_edit_region_values *says, region_kind kind)
{
    rig_edit_region_values next = {says->bone, kind == KIND_RIGID, (double)NAN, (double)NAN};
    if (kind != KIND_MOBILITY && next.bone == RIG_NONE)
        next.bone = 0;
    if (kind == KIND_RIDES)
        next.weight = 1.0;
    if (kind == KIND_MOBILITY)
        next.mobility = isnan(says->mobility) ? 1.0 : says->mobility;
    set_says(self, &next, "change the effect of a region");
}

static void draw_region_bone(panel *self, ui *on, const rig *r, const rig_edit_region_values *says)
{
    const char *items[BONE_ITEMS];
    uint32_t index = says->bone == RIG_NONE ? 0 : says->bone, kind = (uint32_t)kind_of(says);
    for (uint32_t i = 0; i < r->bone_count; ++i)
        items[i] = r->bone[i].name;
    if (kind != KIND_MOBILITY &&
        ui_choice(on, "Bone", RIG_PANEL_LABEL, items, r->bone_count, &index)) {
        rig_edit_region_values next = *says;
        next.bone = index;
        set_says(self, &next, "change the bone of a region");
        return;
    }
    if (ui_choice(on, "Effect", RIG_PANEL_LABEL, kind_items, 3, &kind))
        change_kind(self, says, (region_kind)kind);
}

/* Draws a slider that makes an undo step when released. Returns true while it is held. */
static bool draw_share(ui *on, const char *label, double *value)
{
    static const ui_range range = {0.0, 100.0, "%", 0, false, 100.0};
    double percent = 100.0 * *value;
    if (ui_slider(on, label, RIG_PANEL_LABEL, &range, &percent))
        *value = percent / 100.0;
    return ui_slider_is_held(on);
}

static bool has_same_attributes(const rig_edit_region_values *a, const rig_region *b)
{
    bool same_weight = !(a->weight < b->weight) && !(a->weight > b->weight);
    bool same_mobility = !(a->mobility < b->mobility) && !(a->mobility > b->mobility);
    return same_weight && same_mobility && isnan(a->mobility) == isnan(b->mobility);
}

static void draw_shares(panel *self, ui *on, const rig_region *region)
{
    rig_edit_region_values *says = &self->says;
    bool is_held = false;
    if (!isnan(says->weight))
        is_held = draw_share(on, "Weight", &says->weight) || is_held;
    if (says->is_rigid)
        return;
    bool has_mobility = !isnan(says->mobility);
    if (!isnan(says->weight) && ui_check(on, "and mobility", &has_mobility))
        says->mobility = has_mobility ? 1.0 : (double)NAN;
    if (!isnan(says->mobility))
        is_held = draw_share(on, "Mobility", &says->mobility) || is_held;
    self->is_says_held = is_held;
    if (is_held || has_same_attributes(says, region))
        return;
    rig_edit_region_values next = *says;
    set_says(self, &next, "change the weight of a region");
}

static void draw_chosen_region(panel *self, ui *on, const rig *r)
{
    char words[WORDS];
    const rig_region *region = &r->region[self->region];
    rig_edit_region_values says = {region->bone, region->is_rigid, region->weight,
                                   region->mobility};
    uint64_t number = rig_model_number(self->model);
    if (!self->is_says_held)
        self->says = says;
    draw_region_name(self, on, region);
    rig_edit_describe(&region->select, words, sizeof words);
    ui_text_wrapped(on, UI_STYLE_DIM, words);
    draw_region_bone(self, on, r, &says);
    if (number == rig_model_number(self->model))
        draw_shares(self, on, region);
    if (number == rig_model_number(self->model))
        draw_buttons(self, on, r);
}

/* ---- */

static void draw_regions(panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    draw_region_list(self, on, r);
    const bool is_added = ui_button(on, "Add a region", UI_PLAIN);
    ui_hint(on, "Add an empty region to paint. It overrides the regions above it in the list.");
    if (is_added) {
        add(self);
        return;
    }
    if (self->region != RIG_NONE && self->region < rig_model_rig(self->model)->region_count)
        draw_chosen_region(self, on, rig_model_rig(self->model));
    ui_rule(on);
    draw_brush(self, on);
}

/* ---- contacts: list and selected contact ---- */

static const float vertex_width = 62.0f;
static const float contact_list_least = 130.0f, below_contact_list = 175.0f; /* height in points */

static void draw_contact_list(panel *self, ui *on, const rig *r)
{
    ui_scroll_begin(on, "contacts", 0.0f,
                    list_height(on, r->contact_count, below_contact_list, contact_list_least));
    for (uint32_t i = 0; i < r->contact_count; ++i) {
        char label[160], vertex[32];
        (void)snprintf(label, sizeof label, "%s##contact%u", r->contact[i].name, i);
        (void)snprintf(vertex, sizeof vertex, "%u", r->contact[i].vertex);
        ui_width(on, -vertex_width);
        if (ui_row(on, label, i == self->contact) != UI_ROW_NONE)
            rig_panel_choose(self, RIG_TAB_CONTACTS, i == self->contact ? RIG_NONE : i);
        if (i == self->contact)
            follow_chosen(self, on);
        rig_panel_write_right(on, vertex);
    }
    if (r->contact_count == 0)
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No contacts yet. Mappings need contacts to pull the face.");
    ui_scroll_end(on);
}

/* ---- the selected item ---- */

static void draw_contact_name(panel *self, ui *on, const rig *r)
{
    rig_naming *naming = &self->placing.name;
    if (!rig_panel_draw_name(self, on, "name", naming, self->contact,
                             r->contact[self->contact].name))
        return;
    rig *changed = rig_panel_begin(self);
    if (changed)
        (void)rig_panel_finish(
            self, rig_edit_name_contact(changed, self->contact, naming->text, &self->err),
            "name a contact");
}

static void draw_contact_bone(panel *self, ui *on, const rig *r)
{
    const char *items[BONE_ITEMS] = {"from its vertex"};
    uint32_t bone = r->contact[self->contact].bone, index = bone == RIG_NONE ? 0 : bone + 1;
    for (uint32_t i = 0; i < r->bone_count; ++i)
        items[i + 1] = r->bone[i].name;
    if (!ui_choice(on, "Bone", RIG_PANEL_LABEL, items, r->bone_count + 1, &index))
        return;
    rig *changed = rig_panel_begin(self);
    bone = index == 0 ? RIG_NONE : index - 1;
    if (changed)
        (void)rig_panel_finish(self,
                               rig_edit_set_contact_bone(changed, self->contact, bone, &self->err),
                               "change the bone of a contact");
}

static void mirror(panel *self)
{
    rig *changed = rig_panel_begin(self);
    if (!changed)
        return;
    uint32_t image =
        brush_mirror_of(rig_model_brush(self->model), changed->contact[self->contact].vertex);
    mrt_result result = image == UINT32_MAX
                            ? error_set(&self->err, MRT_ERR_ARGUMENT,
                                        "the mesh has no mirrored vertex for this contact")
                            : rig_edit_mirror_contact(changed, self->contact, image, &self->err);
    (void)rig_panel_finish(self, result, "mirror a contact");
}

static void remove_contact(panel *self)
{
    rig *changed = rig_panel_begin(self);
    if (changed &&
        rig_panel_finish(self, rig_edit_remove_contact(changed, self->contact, &self->err),
                         "remove a contact"))
        self->contact = RIG_NONE;
}

static void draw_chosen_contact(panel *self, ui *on, const rig *r)
{
    const rig_contact *contact = &r->contact[self->contact];
    uint64_t number = rig_model_number(self->model);
    draw_contact_name(self, on, r);
    if (number != rig_model_number(self->model))
        return;
    draw_contact_bone(self, on, r);
    if (number != rig_model_number(self->model))
        return;
    ui_fact(on, "Mirror", RIG_PANEL_LABEL, UI_STYLE_BODY,
            contact->mirror == RIG_NONE ? "none" : r->contact[contact->mirror].name);
    if (ui_button(on, "Mirror it", UI_PLAIN))
        mirror(self);
    ui_hint(on, "Move the contact of the other side to the mirrored position, or add it.");
    ui_same_line(on);
    if (ui_button(on, "Remove", UI_PLAIN) && number == rig_model_number(self->model))
        remove_contact(self);
}

static void draw_contacts(panel *self, ui *on)
{
    rig_placing *placing = &self->placing;
    draw_contact_list(self, on, rig_model_rig(self->model));
    if (ui_button(on, placing->is_adding ? "Click on the face##add" : "Add a contact##add",
                  placing->is_adding ? UI_ACCENT : UI_PLAIN))
        placing->is_adding = !placing->is_adding;
    ui_same_line(on);
    ui_at(on, 168.0f);
    (void)ui_check(on, "Both sides##contacts", &self->is_even);
    if (self->contact != RIG_NONE)
        draw_chosen_contact(self, on, rig_model_rig(self->model));
    else
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "Click a dot on the face to select it. Drag it to move it.");
}

/* ---- check: findings, with a click to select their item ---- */

enum { TITLE = 200 };

static void title_of(const rig *r, const rig_finding *finding, uint32_t number, char *out,
                     size_t capacity)
{
    uint32_t index;
    switch (rig_edit_kind_at(r, finding->path, &index)) {
    case RIG_EDIT_REGION:
        if (r->region[index].name)
            (void)snprintf(out, capacity, "Region %s##finding%u", r->region[index].name, number);
        else
            (void)snprintf(out, capacity, "Region %u##finding%u", index + 1, number);
        break;
    case RIG_EDIT_CONTACT:
        (void)snprintf(out, capacity, "Contact %s##finding%u", r->contact[index].name, number);
        break;
    case RIG_EDIT_BONE:
        (void)snprintf(out, capacity, "Bone %s##finding%u", r->bone[index].name, number);
        break;
    case RIG_EDIT_OTHER:
        (void)snprintf(out, capacity, "%.100s##finding%u",
                       strcmp(finding->path, "$") == 0        ? "The rig"
                       : strncmp(finding->path, "$.", 2) == 0 ? finding->path + 2
                                                              : finding->path,
                       number);
        break;
    }
}

static void go_to(panel *self, const rig *r, const rig_finding *finding)
{
    uint32_t index;
    rig_edit_kind kind = rig_edit_kind_at(r, finding->path, &index);
    if (kind == RIG_EDIT_REGION)
        rig_panel_choose(self, RIG_TAB_REGIONS, index);
    if (kind == RIG_EDIT_CONTACT)
        rig_panel_choose(self, RIG_TAB_CONTACTS, index);
    if (kind == RIG_EDIT_BONE && r->bone[index].kind == BONE_JAW)
        rig_panel_choose(self, RIG_TAB_JAW, index);
    self->shown.is_shape_new = true;
}

static void draw_finding(panel *self, ui *on, const rig *r, const rig_finding *finding,
                         uint32_t number)
{
    static const ui_style style[] = {
        [RIG_NOTE] = UI_STYLE_DIM, [RIG_WARNING] = UI_STYLE_WARNING, [RIG_ERROR] = UI_STYLE_BAD};
    char title[TITLE];
    title_of(r, finding, number, title, sizeof title);
    if (title[0] >= 'a' && title[0] <= 'z')
        title[0] = (char)(title[0] - 'a' + 'A');
    if (ui_row(on, title, false) != UI_ROW_NONE)
        go_to(self, r, finding);
    ui_text_wrapped(on, style[finding->severity], finding->text);
    ui_space(on, 4.0f);
}

static void draw_confirm(panel *self, ui *on)
{
    char line[512];
    if (!self->confirm || !ui_section(on, "Guessed by the draft", true))
        return;
    for (const char *at = self->confirm; *at;) {
        size_t length = strcspn(at, "\n");
        (void)snprintf(line, sizeof line, "%.*s", (int)length, at);
        ui_text_wrapped(on, UI_STYLE_BODY, line);
        ui_space(on, 4.0f);
        at += length + (at[length] == '\n');
    }
}

static void draw_summary(const rig_work *work, const rig *r, bool is_laid, ui *on)
{
    uint32_t errors = rig_findings_count(&work->findings, RIG_ERROR);
    uint32_t warnings = rig_findings_count(&work->findings, RIG_WARNING);
    uint32_t notes = work->findings.count - errors - warnings;
    char text[128];
    if (!is_laid) {
        ui_text(on, UI_STYLE_DIM, "Checking the last change \xe2\x80\xa6");
        return;
    }
    if (errors > 0)
        (void)snprintf(text, sizeof text,
                       "%u error%s to fix. The stage still uses the previous rig.", errors,
                       errors == 1 ? "" : "s");
    else if (r->contact_count == 0)
        (void)snprintf(text, sizeof text,
                       "No face was found in the mesh. Perform it as clay, or add contacts.");
    else if (warnings > 0)
        (void)snprintf(text, sizeof text, "Ready, %u warning%s.", warnings,
                       warnings == 1 ? "" : "s");
    else if (notes > 0)
        (void)snprintf(text, sizeof text, "Ready, %u note%s.", notes, notes == 1 ? "" : "s");
    else
        (void)snprintf(text, sizeof text, "Ready, no problems found.");
    ui_text_wrapped(on, errors ? UI_STYLE_BAD : warnings ? UI_STYLE_WARNING : UI_STYLE_GOOD, text);
}

static void cut_mouth(panel *self)
{
    error err = {""};
    rig_panel_report(self, rig_model_cut_mouth(self->model, &err) < 0 ? err.text : "");
}

/* Asks the same question as the empty stage. */
static void draw_mouth_question(panel *self, ui *on)
{
    if (!rig_model_asks_mouth(self->model))
        return;
    const bool is_cutting = rig_model_is_drafting(self->model);
    ui_text_wrapped(on, UI_STYLE_BODY, is_cutting ? "Cutting the mouth..." : APP_MOUTH_QUESTION);
    ui_disabled_begin(on, is_cutting);
    if (ui_button(on, "Cut the mouth", UI_ACCENT))
        cut_mouth(self);
    ui_hint(on, APP_MOUTH_CUT_HINT);
    ui_same_line(on);
    if (ui_button(on, "Perform as clay", UI_PLAIN))
        rig_model_leave_clay(self->model);
    ui_hint(on, APP_MOUTH_CLAY_HINT);
    ui_disabled_end(on);
    ui_space(on, 6.0f);
}

static void draw_check(panel *self, ui *on)
{
    const rig_work *work = rig_model_work(self->model);
    const rig *r = rig_model_rig(self->model);
    if (!work) {
        ui_text(on, UI_STYLE_DIM, "Checking the rig \xe2\x80\xa6");
        return;
    }
    const rig_findings *found = &work->findings;
    const uint32_t told =
        rig_findings_count(found, RIG_ERROR) + rig_findings_count(found, RIG_WARNING);
    ui_space(on, 4.0f);
    draw_summary(work, r, rig_model_is_laid(self->model), on);
    ui_space(on, 4.0f);
    draw_mouth_question(self, on);
    for (uint32_t i = 0; i < found->count; ++i)
        if (found->item[i].severity != RIG_NOTE)
            draw_finding(self, on, r, &found->item[i], i);
    draw_confirm(self, on);
    /* Notes are folded while the lines of a draft must be checked. */
    if (found->count == told || !ui_section(on, "Notes", !self->confirm))
        return;
    for (uint32_t i = 0; i < found->count; ++i)
        if (found->item[i].severity == RIG_NOTE)
            draw_finding(self, on, r, &found->item[i], i);
}

/* ---- the panel ---- */

static const double look_after_s =
    1.5; /* delay before the search for unsaved changes while the panel is hidden */

/* ---- messages ---- */

void rig_panel_report(panel *self, const char *trouble)
{
    (void)snprintf(self->trouble, sizeof self->trouble, "%s", trouble);
    if (trouble[0])
        news_list_add(app_news(self->of), MRT_LOG_ERROR, "rig", trouble);
}

static void tell(panel *self, const char *text)
{
    news_list_add(app_news(self->of), MRT_LOG_INFO, "rig", text);
}

/* ---- changes ---- */

/* The value is the number of a state of the rig. */
static mrt_result set(void *owner, const void *value)
{
    panel *self = owner;
    rig_panel_end_stroke(self);
    self->jawing.is_changing = self->is_says_held = self->parting.is_held = false;
    if (!self->model || !rig_model_go(self->model, *(const uint64_t *)value))
        rig_panel_report(self, "This change of the rig is no longer in the undo history.");
    self->shown.is_tint_new = self->shown.is_shape_new = true;
    app_notes_of(self->of)->is_rig_pending = true;
    return MRT_OK;
}

static void note_change(panel *self, uint64_t number, const char *words)
{
    const rig *of = rig_model_rig(self->model);
    const uint64_t before = number - 1;
    undo_change made = {.owner = self, .set = set, .bytes = of ? of->copied_bytes : 0};
    (void)snprintf(made.words, sizeof made.words, "rig: %s", words);
    app_clear_pulls(self->of);
    app_add_copied_change(self->of, &made, &before, &number, sizeof number);
    app_notes_of(self->of)->is_rig_pending = true;
    self->shown.is_tint_new = self->shown.is_shape_new = true;
}

rig *rig_panel_begin(panel *self)
{
    self->err.text[0] = '\0';
    rig *out = rig_model_begin(self->model, &self->err);
    if (!out)
        rig_panel_report(self, self->err.text);
    return out;
}

bool rig_panel_finish(panel *self, mrt_result result, const char *words)
{
    rig_panel_report(self, result < 0 ? self->err.text : "");
    if (result < 0) {
        rig_model_abandon(self->model);
        return false;
    }
    note_change(self, rig_model_commit(self->model), words);
    return true;
}

bool rig_panel_draw_name(const panel *self, ui *on, const char *hint, rig_naming *naming,
                         uint32_t of, const char *name)
{
    const uint32_t number = (uint32_t)rig_model_number(self->model);
    if (naming->of != of || naming->number != number) {
        (void)snprintf(naming->text, sizeof naming->text, "%s", name);
        naming->of = of;
        naming->number = number;
    }
    ui_width(on, -1.0f);
    if (!ui_input(on, "name", hint, naming->text, sizeof naming->text))
        return false;
    naming->of = RIG_NONE;
    return strcmp(naming->text, name) != 0;
}

void rig_panel_choose(panel *self, rig_tab tab, uint32_t index)
{
    self->tab = tab;
    self->is_to_follow = true;
    if (tab == RIG_TAB_REGIONS)
        self->region = index;
    if (tab == RIG_TAB_CONTACTS)
        self->contact = index;
    self->is_says_held = false;
    self->shown.is_tint_new = true;
}

/* ---- current face ---- */

static void forget_face(panel *self)
{
    rig_panel_end_stroke(self);
    app_forget_changes(self->of, self);
    app_set_unsaved(self->of, NULL);
    self->was_unsaved = false;
    rig_model_destroy(self->model);
    self->model = NULL;
    rig_panel_shown_finish(&self->shown);
    free(self->confirm);
    self->confirm = NULL;
    self->region = self->contact = RIG_NONE;
    self->is_draft_wanted = false;
    self->placing = (rig_placing){.name.of = RIG_NONE};
    self->jawing = (rig_jawing){.held = RIG_HANDLES};
    self->mouthing = (rig_mouthing){.is_held = false};
    rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
    self->painting.is_on = false;
    self->trouble[0] = '\0';
}

static bool is_same_face(const panel *self, const face_file *file)
{
    const char *path = app_face_path(self->of);
    return file && self->stage_path && path && file->rig == self->stage_rig &&
           file->mesh.position == self->stage_position && strcmp(path, self->stage_path) == 0;
}

static void note_face(panel *self)
{
    const face_file *file = app_face(self->of);
    const char *path = app_face_path(self->of);
    free(self->stage_path);
    self->stage_rig = file ? file->rig : NULL;
    self->stage_rig_is_file = path && strcmp(file_extension_of(path).text, "json") == 0;
    self->stage_position = file ? file->mesh.position : NULL;
    self->stage_path = strdup(path ? path : "");
}

static void follow_face(panel *self, double dt_s)
{
    const face_file *file = app_face(self->of);
    self->known_s += dt_s;
    if (is_same_face(self, file))
        return;
    if (self->adopts && self->model && file &&
        file->mesh.vertex_count == rig_model_mesh(self->model)->vertex_count)
        note_face(self);
    else {
        forget_face(self);
        note_face(self);
        self->known_s = 0.0;
    }
    self->adopts = false;
}

/* Opens the model late, so that it does not delay the first drawn face. */
static void open_model(panel *self)
{
    error err = {""};
    const face_file *file = app_face(self->of);
    if (self->model || !file ||
        !(self->is_shown || self->is_draft_wanted || self->known_s > look_after_s))
        return;
    if (rig_model_create(&self->model, file, app_face_path(self->of),
                         settings_folder(app_settings(self->of)), &err) < 0) {
        if (!self->trouble[0])
            rig_panel_report(self, err.text);
        return;
    }
    self->shown.is_tint_new = self->shown.is_shape_new = true;
    if (rig_model_has_recovered(self->model))
        tell(self, "Unsaved changes of this rig can be restored in the Rig panel (F4).");
}

/* ---- the stage ---- */

static void give_to_stage(panel *self)
{
    if (app_status(self->of)->is_recording)
        return; /* later, because the face must not change during a take */
    face_file *file = rig_model_pop_face(self->model);
    if (!file)
        return;
    if (app_change_face(self->of, file) < 0)
        self->trouble[0] = '\0'; /* the application has reported the error */
    free(file);
    note_face(self);
}

/* ---- the file ---- */

/* Opens the saved rig as the face, so that the show refers to it. */
static void open_saved(panel *self, const char *path)
{
    char copy[RIG_PANEL_PATH];
    (void)snprintf(copy, sizeof copy, "%s", path);
    self->adopts = app_open_face(self->of, copy) >= 0;
}

static mrt_result save(void *owner, error *err)
{
    panel *self = owner;
    rig_panel_end_stroke(self);
    mrt_result result = rig_model_save(self->model, err);
    if (result < 0)
        return result;
    const char *path = rig_model_path(self->model);
    char text[RIG_PANEL_TROUBLE];
    (void)snprintf(text, sizeof text, "Saved %.400s", path);
    tell(self, text);
    self->trouble[0] = '\0';
    if (!self->stage_rig_is_file)
        open_saved(self, path);
    return result;
}

static void leave(void *owner)
{
    panel *self = owner;
    rig_model_leave(self->model);
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static void save_as_asked(panel *self)
{
    error err = {""};
    if (save(self, &err) < 0)
        rig_panel_report(self, err.text);
}

static void update_unsaved(panel *self)
{
    bool is_unsaved = !rig_model_is_saved(self->model);
    if (is_unsaved == self->was_unsaved)
        return;
    app_unsaved unsaved = {.owner = self, .save = save, .leave = leave};
    (void)snprintf(unsaved.words, sizeof unsaved.words, "the rig %.100s",
                   file_name(rig_model_path(self->model)));
    app_set_unsaved(self->of, is_unsaved ? &unsaved : NULL);
    self->was_unsaved = is_unsaved;
}

static const char *path_to_save(void *owner)
{
    const panel *self = owner;
    return self->model && rig_model_rig(self->model) ? rig_model_path(self->model) : NULL;
}

/* Saves unsaved changes to the new file and opens that file on the stage. */
static mrt_result save_elsewhere(void *owner, const char *path, error *err)
{
    panel *self = owner;
    char text[RIG_PANEL_TROUBLE];
    rig_panel_end_stroke(self);
    if (app_status(self->of)->is_recording)
        return error_set(err, MRT_ERR_ARGUMENT, "a take is being recorded: stop it first");
    mrt_result result = rig_model_save_as(self->model, path, err);
    if (result < 0)
        return result;
    (void)snprintf(text, sizeof text, "Saved %.400s", path);
    tell(self, text);
    self->trouble[0] = '\0';
    update_unsaved(self);
    open_saved(self, path);
    return result;
}

/* ---- each frame ---- */

static void keep_choices(panel *self)
{
    const rig *r = rig_model_rig(self->model);
    if (!r || self->region >= r->region_count)
        self->region = RIG_NONE;
    if (!r || self->contact >= r->contact_count)
        self->contact = RIG_NONE;
    if (!r || self->painting.ink.bone >= r->bone_count)
        self->painting.ink.bone = 0;
    rig_panel_keep_part(self);
}

static void begin_draft(panel *self)
{
    error err = {""};
    rig_panel_report(self, rig_model_draft(self->model, &err) < 0 ? err.text : "");
}

static void take_draft(panel *self)
{
    rig_model_drafted made = {.result = MRT_OK};
    if (!rig_model_pop_draft(self->model, &made))
        return;
    rig_panel_report(self, made.result < 0 ? made.err.text : "");
    if (made.result < 0) {
        if (!self->is_shown)
            news_list_add(app_news(self->of), MRT_LOG_ERROR, "rig", made.err.text);
        return;
    }
    free(self->confirm);
    self->confirm = made.confirm;
    note_change(self, made.number, made.has_cut ? "cut the mouth" : "draft");
    rig_panel_choose(self, RIG_TAB_CHECK, 0);
    if (!self->is_shown) {
        char text[128], keys[KEY_WORDS + 4];
        key_map_after(&app_looks_of(self->of)->keys, ACTION_PANEL_RIG, keys);
        const bool is_unsure = self->confirm && strstr(self->confirm, "(unsure)");
        (void)snprintf(
            text, sizeof text,
            is_unsure ? "A rig was drafted, but its face is unsure. See where it is in Rig%s, then "
                        "save it (Ctrl+S)."
                      : "A rig was drafted. Check it in Rig%s, and save it (Ctrl+S).",
            keys);
        tell(self, text);
    }
}

/* Returns whether the viewport shows the edited mesh. A cut or restored mouth reaches the stage
 * with a delay. */
static bool is_on_stage(const panel *self, const face_file *before)
{
    const face_file *file = app_face(self->of);
    return file && file == before &&
           file->mesh.vertex_count == rig_model_mesh(self->model)->vertex_count;
}

static void answer_mouth(panel *self, app_mouth answer)
{
    if (answer == APP_MOUTH_CUT)
        cut_mouth(self);
    else if (answer == APP_MOUTH_CLAY)
        rig_model_leave_clay(self->model);
}

static void update(panel *self, double dt_s)
{
    const face_file *before = app_face(self->of);
    viewport *view = app_viewport(self->of);
    app_notes *notes = app_notes_of(self->of);
    follow_face(self, dt_s);
    self->is_draft_wanted |= app_take_call(self->of, APP_CALL_DRAFT);
    open_model(self);
    if (self->model) {
        if (self->is_draft_wanted && !rig_model_rig(self->model))
            begin_draft(self);
        self->is_draft_wanted = false;
        answer_mouth(self, notes->mouth_answer);
        notes->mouth_answer = APP_MOUTH_UNANSWERED;
        take_draft(self);
        if (app_take_request(self->of, ACTION_SAVE))
            save_as_asked(self);
        if (self->is_shown)
            rig_model_request_binding(self->model);
        if (rig_model_update(self->model, dt_s))
            self->shown.is_tint_new = self->shown.is_shape_new = true;
        give_to_stage(self);
        notes->is_rig_pending = rig_model_is_pending(self->model);
        update_unsaved(self);
        keep_choices(self);
        if (rig_model_is_busy(self->model))
            app_want_frame(self->of, 0.02);
    }
    notes->is_drafting = self->model && rig_model_is_drafting(self->model);
    notes->is_mouth_asked = self->model && rig_model_asks_mouth(self->model);
    if (view && self->model && self->is_shown && is_on_stage(self, before))
        rig_panel_face(self, view);
    else if (view)
        rig_panel_release(self, view);
    self->is_shown = false;
}

/* ---- drawing ---- */

static void draw_head(panel *self, ui *on)
{
    char text[128];
    if (!rig_model_rig(self->model)) {
        ui_text(on, UI_STYLE_TITLE, file_name(app_face_path(self->of)));
        return;
    }
    bool is_saved = rig_model_is_saved(self->model);
    (void)snprintf(text, sizeof text, "%.80s%s", file_name(rig_model_path(self->model)),
                   is_saved ? "" : " \xe2\x97\x8f");
    ui_text(on, UI_STYLE_TITLE, text);
    if (!is_saved)
        ui_hint(on, "The rig has unsaved changes.");
    ui_same_line(on);
    ui_at(on, 252.0f);
    ui_disabled_begin(on, is_saved);
    if (ui_button(on, "Save##rig", is_saved ? UI_PLAIN : UI_ACCENT))
        save_as_asked(self);
    ui_disabled_end(on);
    char keys[KEY_WORDS];
    key_map_words(&app_looks_of(self->of)->keys, ACTION_SAVE, keys);
    ui_hint(on, keys);
}

static void draw_kept(panel *self, ui *on)
{
    uint64_t number;
    error err = {""};
    if (!rig_model_has_recovered(self->model))
        return;
    ui_text_wrapped(on, UI_STYLE_WARNING, "Unsaved changes of the last session were found.");
    if (ui_button(on, "Restore", UI_ACCENT)) {
        mrt_result result = rig_model_restore_recovered(self->model, &number, &err);
        rig_panel_report(self, result < 0 ? err.text : "");
        if (result >= 0)
            note_change(self, number, "restore unsaved changes");
    }
    ui_same_line(on);
    if (ui_button(on, "Discard", UI_QUIET))
        rig_model_discard_recovered(self->model);
    ui_rule(on);
}

static void draw_without_rig(panel *self, ui *on)
{
    char label[128], path[1024];
    const char *beside = rig_model_beside(self->model);
    ui_text_wrapped(on, UI_STYLE_BODY,
                    "This mesh has no rig. You can pull all of it, like clay. A rig adds a skull, "
                    "a jaw and contacts.");
    ui_space(on, 6.0f);
    if (beside) {
        (void)snprintf(label, sizeof label, "Open %.60s", file_name(beside));
        (void)snprintf(path, sizeof path, "%s", beside);
        if (ui_button(on, label, UI_ACCENT) && app_open_face(self->of, path) >= 0)
            return;
        ui_same_line(on);
    }
    ui_disabled_begin(on, rig_model_is_drafting(self->model));
    if (ui_button(on, "Draft a rig", beside ? UI_PLAIN : UI_ACCENT))
        begin_draft(self);
    ui_disabled_end(on);
    ui_hint(
        on,
        "Draft a first rig from the shape, parts and skeleton of the mesh. Check it afterwards.");
    if (rig_model_is_drafting(self->model))
        ui_text(on, UI_STYLE_DIM, "Searching for the face...");
}

static void check_title(const panel *self, char *out, size_t capacity)
{
    const rig_work *work = rig_model_work(self->model);
    uint32_t errors = work ? rig_findings_count(&work->findings, RIG_ERROR) : 0;
    uint32_t count = errors + (work ? rig_findings_count(&work->findings, RIG_WARNING) : 0);
    if (count > 0)
        (void)snprintf(out, capacity, "Check %u", count);
    else
        (void)snprintf(out, capacity, "Check");
}

static void draw_tabs(panel *self, ui *on)
{
    static void (*const draw_tab[RIG_TABS])(panel *, ui *) = {
        draw_regions, draw_contacts, rig_panel_draw_jaw, rig_panel_draw_parts, draw_check};
    char check[32];
    uint32_t before = self->tab;
    check_title(self, check, sizeof check);
    const char *const names[RIG_TABS] = {"Regions", "Contacts", "Jaw", "Parts", check};
    (void)ui_tabs(on, "tabs", names, RIG_TABS, &self->tab);
    if (self->tab != before)
        self->shown.is_tint_new = self->shown.is_shape_new = true;
    if (self->trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble);
    ui_space(on, 6.0f);
    ui_scroll_begin(on, names[self->tab] == check ? "check" : names[self->tab], 0.0f, 0.0f);
    draw_tab[self->tab](self, on);
    ui_scroll_end(on);
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    self->is_shown = true;
    ui_panel_begin(on, "rig", where, UI_GROUND_PANEL);
    if (!self->model) {
        ui_text_wrapped(on, UI_STYLE_DIM, self->trouble[0] ? self->trouble : "No face is open.");
    } else {
        draw_head(self, on);
        draw_kept(self, on);
        if (rig_model_rig(self->model))
            draw_tabs(self, on);
        else
            draw_without_rig(self, on);
    }
    if (self->model && !rig_model_rig(self->model) && self->trouble[0])
        ui_text_wrapped(on, UI_STYLE_BAD, self->trouble);
    ui_panel_end(on);
}

/* ---- create and destroy ---- */

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of = of;
    self->region = self->contact = self->region_name.of = RIG_NONE;
    self->placing.name.of = RIG_NONE;
    self->jawing.held = RIG_HANDLES;
    rig_panel_choose_part(self, RIG_NONE, RIG_NONE, RIG_NONE);
    self->is_even = true;
    self->painting.shape = (brush_shape){.radius_mm = 12.0, .sides = BRUSH_BOTH_SIDES};
    self->painting.ink = (rig_stroke_ink){.ink = RIG_INK_RIDES, .strength = 1.0};
    self->shown.is_released = true;
    app_set_rig_saver(of, &(app_rig_saver){self, path_to_save, save_elsewhere});
    return self;
}

static void destroy(panel *self)
{
    if (!self)
        return;
    forget_face(self);
    app_set_rig_saver(self->of, NULL);
    free(self->stage_path);
    free(self);
}

const panel_type panel_rig = {create, destroy, draw, update};
