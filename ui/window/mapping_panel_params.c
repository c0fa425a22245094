#include "window/mapping_panel_inside.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const float label_least = 84.0f, label_most = 146.0f;

bool mapping_param_is_shown(const mrt_param *p)
{
    return !(p->flags & MRT_PARAM_HIDDEN) && learn_finger_of(p) == LEARN_NONE;
}

bool mapping_param_is_changed(const instance *mapping, uint32_t index)
{
    const mrt_param *p = &mapping->type->params[index];
    double value = instance_value(mapping, index);
    return !(p->flags & MRT_PARAM_TRIGGER) && !(value >= p->initial && value <= p->initial);
}

/* ---- one parameter ---- */

static uint32_t digits_of(const mrt_param *p)
{
    double span = p->max - p->min;
    return span >= 200.0 ? 0 : span >= 20.0 ? 1 : span >= 1.0 ? 2 : 3;
}

static uint32_t label_count(const mrt_param *p)
{
    uint32_t count = 0;
    while (p->labels[count])
        count += 1;
    return count;
}

static void draw_labels(mapping_panel *self, ui *on, instance *mapping, uint32_t index,
                        const char *label)
{
    const mrt_param *p = &mapping->type->params[index];
    double before = instance_value(mapping, index);
    uint32_t chosen = (uint32_t)(before - p->min);
    if (!ui_choice(on, label, self->label_width, p->labels, label_count(p), &chosen))
        return;
    instance_set_value(mapping, index, p->min + (double)chosen);
    mapping_steps_note(self->steps, index, before);
}

/* A drag is one step, from where it began. */
static void draw_slider(mapping_panel *self, ui *on, instance *mapping, uint32_t index,
                        const char *label)
{
    const mrt_param *p = &mapping->type->params[index];
    const ui_range range = {.min = p->min,
                            .max = p->max,
                            .unit = p->unit,
                            .digits = digits_of(p),
                            .is_whole = (p->flags & MRT_PARAM_STEPPED) != 0,
                            .initial = p->initial};
    double before = instance_value(mapping, index), value = before;
    bool has_changed = ui_slider(on, label, self->label_width, &range, &value);
    bool is_held = ui_slider_is_held(on), was_held = self->is_held && self->held == index;
    if (has_changed)
        instance_set_value(mapping, index, value);
    if (is_held && !was_held) {
        self->is_held = true;
        self->held = index;
        self->held_before = before;
    } else if (!is_held && was_held) {
        self->is_held = false;
        mapping_steps_note(self->steps, index, self->held_before);
    } else if (has_changed && !is_held) {
        mapping_steps_note(self->steps, index, before);
    }
}

void mapping_param_draw(mapping_panel *self, ui *on, instance *mapping, uint32_t index,
                        const char *name)
{
    const mrt_param *p = &mapping->type->params[index];
    char label[96];
    (void)snprintf(label, sizeof label, "%.70s%s###%u", name,
                   mapping_param_is_changed(mapping, index) ? " \xe2\x80\xa2" : "", p->id);
    if (p->flags & MRT_PARAM_TRIGGER) {
        if (ui_button(on, label, UI_PLAIN))
            instance_trigger(mapping, index);
    } else if (p->labels) {
        draw_labels(self, on, mapping, index, label);
    } else {
        draw_slider(self, on, mapping, index, label);
    }
    ui_hint(on, p->help);
}

/* ---- all of them, by group ---- */

/* As wide as the group's longest name needs. */
static void measure_labels(mapping_panel *self, const ui *on, const instance *mapping,
                           const char *group)
{
    float widest = label_least;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if (mapping_param_is_shown(p) && !(p->flags & MRT_PARAM_TRIGGER) &&
            (!group || strcmp(p->group, group) == 0))
            widest = fmaxf(widest, ui_text_width(on, UI_STYLE_BODY, p->name) + 20.0f);
    }
    self->label_width = fminf(widest, label_most);
}

static bool contains(const char *text, const char *part)
{
    for (; *text; ++text) {
        size_t i = 0;
        while (part[i] && tolower((unsigned char)text[i]) == tolower((unsigned char)part[i]))
            i += 1;
        if (!part[i])
            return true;
    }
    return !*part;
}

/* Buttons stand beside each other. */
static void draw_group(mapping_panel *self, ui *on, instance *mapping, const char *group,
                       const char *find)
{
    bool is_after_button = false;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if (!mapping_param_is_shown(p) || strcmp(p->group, group) != 0 || !contains(p->name, find))
            continue;
        bool is_button = (p->flags & MRT_PARAM_TRIGGER) != 0;
        if (is_button && is_after_button) {
            ui_same_line(on);
            if (ui_available_width(on) < ui_text_width(on, UI_STYLE_BODY, p->name) + 24.0f)
                ui_space(on, 0.0f);
        }
        mapping_param_draw(self, on, mapping, i, p->name);
        is_after_button = is_button;
    }
}

static uint32_t changed_in(const instance *mapping, const char *group)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < mapping->type->param_count; ++i)
        count += strcmp(mapping->type->params[i].group, group) == 0 &&
                 mapping_param_is_shown(&mapping->type->params[i]) &&
                 mapping_param_is_changed(mapping, i);
    return count;
}

static bool finds_in(const instance *mapping, const char *group, const char *find)
{
    for (uint32_t i = 0; i < mapping->type->param_count; ++i) {
        const mrt_param *p = &mapping->type->params[i];
        if (mapping_param_is_shown(p) && strcmp(p->group, group) == 0 && contains(p->name, find))
            return true;
    }
    return false;
}

static void draw_found(mapping_panel *self, ui *on, instance *mapping)
{
    bool has_found = false;
    for (uint32_t i = 0; i < self->group_count; ++i) {
        bool is_of_group = contains(self->group[i], self->find);
        const char *find = is_of_group ? "" : self->find;
        if (!finds_in(mapping, self->group[i], find))
            continue;
        has_found = true;
        measure_labels(self, on, mapping, self->group[i]);
        ui_text(on, UI_STYLE_TITLE, self->group[i]);
        draw_group(self, on, mapping, self->group[i], find);
    }
    if (!has_found)
        ui_text(on, UI_STYLE_DIM, "No parameter is called like that.");
}

static void draw_groups(mapping_panel *self, ui *on, instance *mapping)
{
    char title[128];
    bool is_small = mapping->type->param_count <= 16;
    for (uint32_t i = 0; i < self->group_count; ++i) {
        uint32_t changed = changed_in(mapping, self->group[i]);
        if (changed > 0)
            (void)snprintf(title, sizeof title, "%.80s \xe2\x80\xa2 %u###%u", self->group[i],
                           changed, i);
        else
            (void)snprintf(title, sizeof title, "%.80s###%u", self->group[i], i);
        if (!ui_section(on, title, is_small || i == 0))
            continue;
        measure_labels(self, on, mapping, self->group[i]);
        ui_id_begin(on, self->group[i]);
        draw_group(self, on, mapping, self->group[i], "");
        ui_id_end(on);
    }
}

void mapping_params_draw(mapping_panel *self, ui *on, instance *mapping)
{
    if (mapping->type->param_count == 0) {
        ui_text(on, UI_STYLE_DIM, "It has no parameters.");
        return;
    }
    ui_width(on, -92.0f);
    (void)ui_input(on, "##find", "Find a parameter", self->find, sizeof self->find);
    ui_same_line(on);
    ui_width(on, 84.0f);
    if (ui_button(on, "Reset all", UI_PLAIN)) {
        for (uint32_t i = 0; i < mapping->type->param_count; ++i)
            self->values[i] = learn_finger_of(&mapping->type->params[i]) == LEARN_NONE
                                  ? mapping->type->params[i].initial
                                  : instance_value(mapping, i);
        mapping_panel_set(self, self->values, "all parameters reset");
    }
    ui_hint(on, "Every parameter as it is at first; links of fingers stay. A double click on one "
                "resets that one.");
    if (self->find[0])
        draw_found(self, on, mapping);
    else
        draw_groups(self, on, mapping);
}
