/* The regions of a rig: the list, and what the chosen one says. */
#include "window/rig_panel_inside.h"
#include "window/rig_tint.h"
#include "window/theme.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WORDS = 400, BONE_ITEMS = RIG_BONES_MAX + 1 };
static const float chip_width = 8.0f, size_width = 62.0f, size_end = 292.0f;
static const float list_least = 150.0f, list_most = 420.0f;         /* points high */
static const float below_list = 235.0f, below_list_chosen = 405.0f; /* what comes below it */

typedef enum region_kind { KIND_RIDES = 0, KIND_RIGID, KIND_MOBILITY } region_kind;
static const char *const kind_items[] = {"rides on it", "rigid on it", "only mobility"};

/* ---- the list ---- */

static void say_share(char *out, size_t capacity, const char *what, double share)
{
    if (share < 1.0)
        (void)snprintf(out, capacity, "%s %.0f %%", what, 100.0 * share);
    else
        (void)snprintf(out, capacity, "%s", what);
}

/* What it says: "jaw, rigid", "skull 50 %, mobile", "immobile". */
static void say_region(const rig *r, const rig_region *region, char *out, size_t capacity)
{
    char rides[96] = "", mobile[32] = "";
    const char *bone = region->bone == RIG_NONE ? "" : r->bone[region->bone].name;
    if (region->is_rigid)
        (void)snprintf(rides, sizeof rides, "%s, rigid", bone);
    else if (!isnan(region->weight))
        say_share(rides, sizeof rides, bone, region->weight);
    if (!isnan(region->mobility) && region->mobility > 0.0)
        say_share(mobile, sizeof mobile, "mobile", region->mobility);
    else if (!isnan(region->mobility))
        (void)snprintf(mobile, sizeof mobile, "immobile");
    (void)snprintf(out, capacity, "%s%s%s", rides, rides[0] && mobile[0] ? ", " : "", mobile);
}

static void label_of(const rig *r, uint32_t index, char *out, size_t capacity)
{
    char words[140];
    const rig_region *region = &r->region[index];
    say_region(r, region, words, sizeof words);
    (void)snprintf(out, capacity, "%s##region%u", region->name ? region->name : words, index);
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

static void draw_size(const rig_panel *self, ui *on, uint32_t index)
{
    const rig_work *work = rig_model_work(self->model);
    char text[32] = "\xe2\x80\xa6";
    if (rig_model_is_laid(self->model) && work->region_size && index < work->rig.region_count)
        (void)snprintf(text, sizeof text, "%u", work->region_size[index]);
    ui_same_line(on);
    ui_at(on, size_end - ui_text_width(on, UI_STYLE_DIM, text));
    ui_text(on, UI_STYLE_DIM, text);
    ui_hint(on, "How many vertices it has.");
}

static float list_height(const rig_panel *self, const ui *on)
{
    float below = self->region == RIG_NONE ? below_list : below_list_chosen;
    float left = ui_available_height(on) - below;
    return left < list_least ? list_least : left > list_most ? list_most : left;
}

static void draw_list(rig_panel *self, ui *on, const rig *r)
{
    ui_scroll_begin(on, "regions", 0.0f, list_height(self, on));
    for (uint32_t i = 0; i < r->region_count; ++i) {
        char label[160];
        label_of(r, i, label, sizeof label);
        draw_chip(on, rig_tint_chip(r, r->region[i].bone), i);
        ui_same_line(on);
        ui_width(on, -size_width);
        if (ui_row(on, label, i == self->region) != UI_ROW_NONE)
            rig_panel_choose(self, RIG_TAB_REGIONS, i == self->region ? RIG_NONE : i);
        draw_size(self, on, i);
    }
    ui_scroll_end(on);
}

/* ---- changes ---- */

static void add(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    uint32_t index = RIG_NONE;
    rig_edit_says says = {0, false, 1.0, (double)NAN};
    if (!r)
        return;
    mrt_result result = rig_edit_add_region(r, NULL, &says, &index, &err);
    if (rig_panel_finish(self, result, &err, "add a region"))
        rig_panel_choose(self, RIG_TAB_REGIONS, index);
}

static void take_out(rig_panel *self, uint32_t index)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_remove_region(r, index, &err), &err,
                               "take out a region");
}

static void move(rig_panel *self, uint32_t index, uint32_t to)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r &&
        rig_panel_finish(self, rig_edit_move_region(r, index, to, &err), &err, "move a region"))
        self->region = to;
}

/* What its selector gives becomes its own vertices. */
static void make_paint(rig_panel *self, uint32_t index)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    const mesh *m = rig_model_mesh(self->model);
    float *share = self->shown.share;
    if (!r || !share)
        return;
    uint8_t *value = (uint8_t *)self->shown.scratch;
    mrt_result result =
        bind_select(share, &r->region[index].select, m, rig_model_topology(self->model), &err);
    for (uint32_t v = 0; result >= 0 && v < m->vertex_count; ++v)
        value[v] = (uint8_t)(share[v] * 255.0f + 0.5f);
    if (result >= 0)
        result = rig_edit_paint(r, index, value, m->vertex_count, &err);
    (void)rig_panel_finish(self, result, &err, "give a region its vertices one by one");
}

static void set_says(rig_panel *self, const rig_edit_says *says, const char *words)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_set_region(r, self->region, says, &err), &err, words);
}

/* ---- the chosen one ---- */

static void draw_name(rig_panel *self, ui *on, const rig_region *region)
{
    error err = {""};
    uint32_t number = (uint32_t)rig_model_number(self->model);
    if (self->region_name_of != self->region || self->region_name_number != number) {
        (void)snprintf(self->region_name, sizeof self->region_name, "%s",
                       region->name ? region->name : "");
        self->region_name_of = self->region;
        self->region_name_number = number;
    }
    ui_width(on, -1.0f);
    if (!ui_input(on, "region name", "no name", self->region_name, sizeof self->region_name))
        return;
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(self, rig_edit_name_region(r, self->region, self->region_name, &err),
                               &err, "name a region");
    self->region_name_of = RIG_NONE;
}

static void draw_buttons(rig_panel *self, ui *on, const rig *r)
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
            "Where two regions speak of a vertex, the lower one wins; rigid ones win over all.");
    ui_same_line(on);
    if (ui_button(on, "Take out", UI_PLAIN))
        take_out(self, index);
    ui_same_line(on);
    ui_disabled_begin(on, rig_edit_can_paint(r, index));
    if (ui_button(on, "To paint", UI_PLAIN))
        make_paint(self, index);
    ui_disabled_end(on);
    ui_hint(on, "Its vertices are kept one by one from now on, so that the brush can change them.");
}

static region_kind kind_of(const rig_edit_says *says)
{
    return says->is_rigid ? KIND_RIGID : isnan(says->weight) ? KIND_MOBILITY : KIND_RIDES;
}

static void change_kind(rig_panel *self, const rig_edit_says *says, region_kind kind)
{
    rig_edit_says next = {says->bone, kind == KIND_RIGID, (double)NAN, (double)NAN};
    if (kind != KIND_MOBILITY && next.bone == RIG_NONE)
        next.bone = 0;
    if (kind == KIND_RIDES)
        next.weight = 1.0;
    if (kind == KIND_MOBILITY)
        next.mobility = isnan(says->mobility) ? 1.0 : says->mobility;
    set_says(self, &next, "change what a region says");
}

static void draw_bone(rig_panel *self, ui *on, const rig *r, const rig_edit_says *says)
{
    const char *items[BONE_ITEMS];
    uint32_t index = says->bone == RIG_NONE ? 0 : says->bone, kind = (uint32_t)kind_of(says);
    for (uint32_t i = 0; i < r->bone_count; ++i)
        items[i] = r->bone[i].name;
    if (kind != KIND_MOBILITY &&
        ui_choice(on, "Bone", RIG_PANEL_LABEL, items, r->bone_count, &index)) {
        rig_edit_says next = *says;
        next.bone = index;
        set_says(self, &next, "change a region's bone");
        return;
    }
    if (ui_choice(on, "Says", RIG_PANEL_LABEL, kind_items, 3, &kind))
        change_kind(self, says, (region_kind)kind);
}

/* A slider that is a step of undo once it is let go. True: it is held. */
static bool draw_share(ui *on, const char *label, double *value)
{
    static const ui_range range = {0.0, 100.0, "%", 0, false, 100.0};
    double percent = 100.0 * *value;
    if (ui_slider(on, label, RIG_PANEL_LABEL, &range, &percent))
        *value = percent / 100.0;
    return ui_slider_is_held(on);
}

static bool is_said_alike(const rig_edit_says *a, const rig_region *b)
{
    bool same_weight = !(a->weight < b->weight) && !(a->weight > b->weight);
    bool same_mobility = !(a->mobility < b->mobility) && !(a->mobility > b->mobility);
    return same_weight && same_mobility && isnan(a->mobility) == isnan(b->mobility);
}

static void draw_shares(rig_panel *self, ui *on, const rig_region *region)
{
    rig_edit_says *says = &self->says;
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
    if (is_held || is_said_alike(says, region))
        return;
    rig_edit_says next = *says;
    set_says(self, &next, "change a region's share");
}

static void draw_chosen(rig_panel *self, ui *on, const rig *r)
{
    char words[WORDS];
    const rig_region *region = &r->region[self->region];
    rig_edit_says says = {region->bone, region->is_rigid, region->weight, region->mobility};
    uint64_t number = rig_model_number(self->model);
    if (!self->is_says_held)
        self->says = says;
    draw_name(self, on, region);
    rig_edit_describe(&region->select, words, sizeof words);
    ui_text_wrapped(on, UI_STYLE_DIM, words);
    draw_bone(self, on, r, &says);
    if (number == rig_model_number(self->model))
        draw_shares(self, on, region);
    if (number == rig_model_number(self->model))
        draw_buttons(self, on, r);
}

/* ---- */

void rig_panel_draw_regions(rig_panel *self, ui *on)
{
    const rig *r = rig_model_rig(self->model);
    draw_list(self, on, r);
    if (ui_button(on, "Add a region", UI_PLAIN)) {
        add(self);
        return;
    }
    if (self->region != RIG_NONE && self->region < rig_model_rig(self->model)->region_count)
        draw_chosen(self, on, rig_model_rig(self->model));
    ui_rule(on);
    rig_panel_draw_brush(self, on);
}
