/* The mapping panel: which mapping performs, its parameters and presets, pedals, learn mode. */
#include "window/mapping_panel_inside.h"
#include "window/panels.h"

#include "stage/device_list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TAB_PARAMETERS = 0, TAB_PEDALS, TAB_LEARN, TABS };
static const char *const tabs[TABS] = {"Parameters", "Pedals", "Learn"};

struct panel {
    mapping_panel of;
};

void mapping_panel_set(mapping_panel *self, const double *values, const char *words)
{
    char all[EDIT_TEXT];
    (void)snprintf(all, sizeof all, "%.50s: %.100s", self->type ? self->type->name : "", words);
    mapping_steps_set(self->steps, values, all);
}

/* ---- of the mapping that performs ---- */

static void find_groups(mapping_panel *self)
{
    self->group_count = 0;
    for (uint32_t i = 0; self->type && i < self->type->param_count; ++i) {
        const mrt_param *p = &self->type->params[i];
        bool is_known = !mapping_param_is_shown(p);
        for (uint32_t k = 0; k < self->group_count && !is_known; ++k)
            is_known = strcmp(self->group[k], p->group) == 0;
        if (!is_known && self->group_count < MAPPING_GROUPS_MAX)
            self->group[self->group_count++] = p->group;
    }
}

/* Another mapping performs, or another version of it. Returns it only if there is room to think. */
static instance *follow_mapping(mapping_panel *self)
{
    instance *mapping = live_mapping(studio_live(self->studio));
    const mrt_plugin_type *type = mapping ? mapping->type : NULL;
    if (type != self->type) {
        self->type = type;
        self->is_held = false;
        free(self->values);
        self->values = type ? calloc((size_t)type->param_count + 1, sizeof(double)) : NULL;
        if (type && strcmp(type->id, self->type_id) != 0) { /* not another version of it */
            (void)snprintf(self->type_id, sizeof self->type_id, "%s", type->id);
            self->preset[0] = self->find[0] = '\0';
            self->is_naming = false;
        }
        find_groups(self);
        mapping_presets_read(self);
    }
    return self->values ? mapping : NULL;
}

/* ---- choice ---- */

static void draw_choice(mapping_panel *self, ui *on)
{
    const plugin_list *plugins = studio_plugins(self->studio);
    const char *items[MAPPING_CHOICES_MAX] = {"none: the mouse alone"};
    const mrt_plugin_type *types[MAPPING_CHOICES_MAX] = {NULL};
    uint32_t count = 1, chosen = 0;
    for (uint32_t i = 0; i < plugins->entry_count && count < MAPPING_CHOICES_MAX; ++i) {
        const mrt_plugin_type *type = plugins->entry[i].type;
        if (!plugin_interface(type, MRT_MAPPING))
            continue;
        if (self->type && strcmp(type->id, self->type->id) == 0)
            chosen = count;
        items[count] = type->name;
        types[count++] = type;
    }
    if (!ui_choice(on, "Mapping", 66.0f, items, count, &chosen))
        return;
    mapping_steps_choose(self->steps, types[chosen] ? types[chosen]->id : "");
}

/* ---- a process of its own, another version ---- */

static void draw_isolation(ui *on, const instance *mapping, const isolate_counts *counts)
{
    char words[400];
    const char *why = isolate_first_reason(mapping->self);
    if (counts->failed == 0) {
        ui_text(on, UI_STYLE_DIM, "Runs apart, in a process of its own.");
        return;
    }
    (void)snprintf(words, sizeof words, "Runs apart; %s: %.300s.",
                   counts->restarted > 1    ? "was restarted several times"
                   : counts->restarted == 1 ? "was restarted once"
                                            : "has failed",
                   why[0] ? why : "it failed");
    ui_text_wrapped(on, UI_STYLE_WARNING, words);
    if (counts->is_away)
        ui_text_wrapped(on, UI_STYLE_WARNING, "The face is held. Choose it again, or another one.");
}

static void draw_state(mapping_panel *self, ui *on, const instance *mapping)
{
    const live_status *status = studio_status(self->studio);
    char words[160];
    if (isolate_inner(mapping->type) != mapping->type)
        draw_isolation(on, mapping, &status->isolated);
    if (status->reload_taken > 0) {
        char times[24] = "once";
        if (status->reload_taken > 1)
            (void)snprintf(times, sizeof times, "%u times", status->reload_taken);
        (void)snprintf(words, sizeof words, "Rebuilt while it performed: taken over %s.", times);
        ui_text_wrapped(on, UI_STYLE_DIM, words);
    }
    if (status->reload_refused > 0) {
        const bool is_one = status->reload_refused == 1;
        (void)snprintf(words, sizeof words, "%u new version%s refused: the log says why.",
                       status->reload_refused, is_one ? " was" : "s were");
        ui_text_wrapped(on, UI_STYLE_WARNING, words);
    }
}

/* ---- the panel ---- */

static void draw_mapping(mapping_panel *self, ui *on, instance *mapping)
{
    ui_text_wrapped(on, UI_STYLE_DIM, mapping->type->about);
    draw_state(self, on, mapping);
    ui_space(on, 4.0f);
    mapping_presets_draw(self, on, mapping);
    ui_space(on, 2.0f);
    (void)ui_tabs(on, "tabs", tabs, TABS, &self->tab);
    ui_scroll_begin(on, tabs[self->tab], 0.0f, 0.0f);
    ui_space(on, 4.0f);
    if (self->tab == TAB_PARAMETERS)
        mapping_params_draw(self, on, mapping);
    else if (self->tab == TAB_PEDALS)
        mapping_pedals_draw(self, on, mapping);
    else
        mapping_learn_draw(self, on, mapping);
    ui_scroll_end(on);
}

static void draw(panel *self_, ui *on, ui_rectangle where)
{
    mapping_panel *self = &self_->of;
    instance *mapping = follow_mapping(self);
    ui_panel_begin(on, "mapping", where, UI_GROUND_PANEL);
    draw_choice(self, on);
    mapping = follow_mapping(self);
    if (mapping)
        draw_mapping(self, on, mapping);
    else
        ui_text_wrapped(on, UI_STYLE_DIM,
                        "No mapping performs. The mouse pulls the face; hands do nothing.");
    self->was_drawn = mapping && self->tab == TAB_LEARN;
    ui_panel_end(on);
}

static void update(panel *self_, double dt_s)
{
    mapping_panel *self = &self_->of;
    mapping_learn_update(self, follow_mapping(self), dt_s);
    self->was_drawn = false;
}

static void destroy(panel *self)
{
    if (!self)
        return;
    mapping_learn_end(&self->of);
    mapping_steps_destroy(self->of.steps);
    free(self->of.values);
    free(self->of.presets);
    free(self);
}

static panel *create(studio *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->of.studio = of;
    self->of.steps = mapping_steps_create(of);
    if (self->of.steps)
        return self;
    free(self);
    return NULL;
}

const panel_type panel_mapping = {create, destroy, draw, update};
