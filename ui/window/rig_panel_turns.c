/* How a ball turns: the ways in which it does, each with its name, axis and limits, and tried on
 * the face. */
#include "base/angle.h"
#include "window/rig_panel_inside.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WORDS = 160, WAYS = 6, OWN_WAY = WAYS };
static const double degree = ANGLE_PI / 180.0;
static const char unit[] = "\xc2\xb0";

/* What a positive angle does, as mappings expect it (rigs/README.md). */
static const struct {
    const char *words, *name;
    vec3 axis;
} ways[WAYS] = {{"to the subject's left", "yaw", {0, 1, 0}},
                {"to the subject's right", "turn", {0, -1, 0}},
                {"up", "pitch", {-1, 0, 0}},
                {"down", "close", {1, 0, 0}},
                {"rolls, its left side up", "roll", {0, 0, 1}},
                {"rolls, its left side down", "tilt", {0, 0, -1}}};
static const ui_range part_range = {-1.0, 1.0, "", 3, false, 0.0};

static bool is_same(vec3 a, vec3 b)
{
    return !(vec3_length(vec3_sub(a, b)) > 1e-9);
}

static uint32_t way_of(vec3 axis)
{
    for (uint32_t i = 0; i < WAYS; ++i)
        if (is_same(axis, ways[i].axis))
            return i;
    return OWN_WAY;
}

/* ---- changes ---- */

static void set_turn(rig_panel *self, const rig_turn *to, const char *words)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r)
        (void)rig_panel_finish(
            self, rig_edit_set_turn(r, self->parting.bone, self->parting.turn, to, &err), &err,
            words);
}

static void remove_turn(rig_panel *self)
{
    error err = {""};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self,
                              rig_edit_remove_turn(r, self->parting.bone, self->parting.turn, &err),
                              &err, "take out a turn"))
        rig_panel_choose_turn(self, RIG_NONE);
}

static bool has_turn(const rig_bone *ball, const char *name)
{
    for (uint32_t i = 0; i < ball->turn_count; ++i)
        if (strcmp(ball->turn[i].name, name) == 0)
            return true;
    return false;
}

static bool has_axis(const rig_bone *ball, vec3 axis)
{
    for (uint32_t i = 0; i < ball->turn_count; ++i)
        if (is_same(ball->turn[i].axis, axis) || is_same(ball->turn[i].axis, vec3_scale(axis, -1)))
            return true;
    return false;
}

/* The first way that it does not turn yet. */
static void add_turn(rig_panel *self, const rig_bone *ball)
{
    error err = {""};
    char name[RIG_PANEL_NAME];
    uint32_t way = 0, index = RIG_NONE;
    while (way < WAYS - 1 && has_axis(ball, ways[way].axis))
        way += 1;
    (void)snprintf(name, sizeof name, "%s", ways[way].name);
    for (uint32_t number = 2; has_turn(ball, name); ++number)
        (void)snprintf(name, sizeof name, "%s %u", ways[way].name, number);
    const rig_turn made = {name, ways[way].axis, -15.0 * degree, 15.0 * degree};
    rig *r = rig_panel_begin(self);
    if (r && rig_panel_finish(self, rig_edit_add_turn(r, self->parting.bone, &made, &index, &err),
                              &err, "add a turn"))
        rig_panel_choose_turn(self, index);
}

/* ---- one of them ---- */

static bool draw_angle(ui *on, const char *label, double low_deg, double high_deg, double usual_deg,
                       double *value_rad)
{
    const ui_range range = {low_deg, high_deg, unit, 0, false, usual_deg};
    double value_deg = *value_rad / degree;
    if (ui_slider(on, label, RIG_PANEL_LABEL, &range, &value_deg))
        *value_rad = value_deg * degree;
    return ui_slider_is_held(on);
}

/* True while a slider is held. */
static bool draw_own_axis(ui *on, vec3 *axis)
{
    bool is_held = false;
    double *const part[3] = {&axis->x, &axis->y, &axis->z};
    static const char *const label[3] = {"Across##axis", "Up##axis", "Forward##axis"};
    for (int i = 0; i < 3; ++i) {
        (void)ui_slider(on, label[i], RIG_PANEL_LABEL, &part_range, part[i]);
        is_held = ui_slider_is_held(on) || is_held;
    }
    ui_hint(on, "Along its axis, which it turns about as a right hand's fingers do about the "
                "thumb.");
    return is_held;
}

static void draw_try(rig_panel *self, ui *on, const rig_turn *turn)
{
    double *tried_rad = &self->parting.tried_rad[self->parting.turn];
    const double before_rad = *tried_rad;
    *tried_rad = fmin(fmax(*tried_rad, turn->min_rad), turn->max_rad);
    (void)draw_angle(on, "Try", turn->min_rad / degree, turn->max_rad / degree, 0.0, tried_rad);
    ui_hint(on, "On the face, not in the rig. A double click: as the mesh is.");
    if (fabs(*tried_rad - before_rad) > 0.0)
        self->shown.is_shape_new = true;
}

static bool is_changed(const rig_turn *a, const rig_turn *b)
{
    return !is_same(a->axis, b->axis) || fabs(a->min_rad - b->min_rad) > 1e-9 ||
           fabs(a->max_rad - b->max_rad) > 1e-9;
}

/* The way that is chosen, or its own. True: a slider is held. */
static bool draw_axis(rig_panel *self, ui *on, rig_turn *now)
{
    rig_parting *parting = &self->parting;
    const char *items[WAYS + 1];
    for (uint32_t i = 0; i < WAYS; ++i)
        items[i] = ways[i].words;
    items[OWN_WAY] = "about an axis of its own";
    uint32_t way = parting->has_own_axis ? OWN_WAY : way_of(now->axis);
    if (ui_choice(on, "Turns", RIG_PANEL_LABEL, items, WAYS + 1, &way)) {
        parting->has_own_axis = way == OWN_WAY;
        if (way < WAYS)
            now->axis = ways[way].axis;
    }
    ui_hint(on, "What a positive angle does. Mappings look for \"yaw\" to the left, \"pitch\" up, "
                "\"close\" where a lid closes.");
    return way == OWN_WAY && draw_own_axis(on, &now->axis);
}

static void draw_turn(rig_panel *self, ui *on, const rig_bone *ball)
{
    rig_parting *parting = &self->parting;
    const rig_turn *turn = &ball->turn[parting->turn];
    const uint64_t number = rig_model_number(self->model);
    rig_turn *now = &parting->turn_now;
    if (!parting->is_turn_held)
        *now = *turn;
    now->name = turn->name;
    ui_id_begin(on, "turn");
    if (rig_panel_draw_name(self, on, &parting->turn_name,
                            parting->bone * RIG_TURNS_MAX + parting->turn, turn->name)) {
        rig_turn named = *turn;
        named.name = parting->turn_name.text;
        set_turn(self, &named, "name a turn");
    }
    if (number == rig_model_number(self->model)) {
        bool is_held = draw_axis(self, on, now);
        is_held = draw_angle(on, "Least", -180.0, 0.0, 0.0, &now->min_rad) || is_held;
        is_held = draw_angle(on, "Most", 0.0, 180.0, 0.0, &now->max_rad) || is_held;
        parting->is_turn_held = is_held;
        draw_try(self, on, now);
        if (!is_held && is_changed(now, turn))
            set_turn(self, now, "change a turn");
    }
    ui_disabled_begin(on, ball->turn_count == 1);
    if (number == rig_model_number(self->model) && ui_button(on, "Take out the turn", UI_PLAIN))
        remove_turn(self);
    ui_disabled_end(on);
    ui_id_end(on);
}

/* ---- all ---- */

void rig_panel_choose_turn(rig_panel *self, uint32_t turn)
{
    rig_parting *parting = &self->parting;
    parting->turn = turn;
    parting->is_turn_held = parting->has_own_axis = false;
    parting->turn_name.of = RIG_NONE;
    memset(parting->tried_rad, 0, sizeof parting->tried_rad);
    self->shown.is_shape_new = true;
}

void rig_panel_draw_turns(rig_panel *self, ui *on, uint32_t bone)
{
    const uint64_t number = rig_model_number(self->model);
    const rig_bone *ball = &rig_model_rig(self->model)->bone[bone];
    rig_parting *parting = &self->parting;
    if (parting->turn != RIG_NONE && parting->turn >= ball->turn_count)
        rig_panel_choose_turn(self, RIG_NONE);
    for (uint32_t i = 0; i < ball->turn_count; ++i) {
        char label[WORDS];
        const rig_turn *turn = &ball->turn[i];
        (void)snprintf(label, sizeof label, "%.60s, %.4g%s to %.4g%s##turn%u", turn->name,
                       turn->min_rad / degree, unit, turn->max_rad / degree, unit, i);
        if (ui_row(on, label, i == parting->turn) != UI_ROW_NONE)
            rig_panel_choose_turn(self, i == parting->turn ? RIG_NONE : i);
    }
    if (parting->turn != RIG_NONE)
        draw_turn(self, on, ball);
    if (number != rig_model_number(self->model) || ball->turn_count >= RIG_TURNS_MAX)
        return;
    if (ui_button(on, "Add a turn", UI_PLAIN))
        add_turn(self, ball);
    ui_hint(on, "Another way in which it moves; the first of the list is applied last.");
}
