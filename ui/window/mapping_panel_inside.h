/* window/mapping_panel_inside.h - what the files of the mapping panel share. No other file includes
 * it. [main] */
#ifndef MAROTTE_UI_WINDOW_MAPPING_PANEL_INSIDE_H
#define MAROTTE_UI_WINDOW_MAPPING_PANEL_INSIDE_H
#include "window/learn.h"
#include "window/mapping_panel_steps.h"
#include "window/presets.h"
#include "window/ui.h"

enum { MAPPING_GROUPS_MAX = 64, MAPPING_CHOICES_MAX = 128 };

typedef struct mapping_panel {
    studio *studio;
    mapping_steps *steps;
    uint32_t tab;
    char find[64]; /* a part of a parameter's name */

    /* Of the mapping that performs, made anew when its type changes. */
    const mrt_plugin_type *type; /* may be gone when another face is on the stage */
    char type_id[128];           /* "": none */
    const char *group[MAPPING_GROUPS_MAX];
    uint32_t group_count;
    float label_width;
    double *values; /* a scratch, param_count */
    bool is_held;   /* a slider is dragged: */
    uint32_t held;  /* which parameter */
    double held_before;

    char preset[PRESET_NAME]; /* name of the one that was used or saved last; "" */
    char preset_name[PRESET_NAME];
    bool is_naming, was_naming;
    char **presets;                        /* their names; one block */
    uint32_t preset_count, preset_edition; /* edition: of the steps when they were read */

    bool is_learning, was_drawn, had_contacts; /* contacts were shown before it began */
    learn learn;
    char learnt[160]; /* what was linked last, or why not */
} mapping_panel;

/* Whether a parameter is drawn among the others: neither hidden nor a link. */
bool mapping_param_is_shown(const mrt_param *p);
bool mapping_param_is_changed(const instance *mapping, uint32_t index);
/* mapping_panel_params.c */
void mapping_params_draw(mapping_panel *self, ui *on, instance *mapping);
/* One parameter as its widget; a change of it is a step. */
void mapping_param_draw(mapping_panel *self, ui *on, instance *mapping, uint32_t index,
                        const char *name);
/* mapping_panel_pedals.c */
void mapping_pedals_draw(mapping_panel *self, ui *on, instance *mapping);
/* mapping_panel_learn.c */
void mapping_learn_draw(mapping_panel *self, ui *on, instance *mapping);
void mapping_learn_update(mapping_panel *self, instance *mapping, double dt_s);
void mapping_learn_end(mapping_panel *self);
/* mapping_panel_presets.c */
void mapping_presets_read(mapping_panel *self);
void mapping_presets_draw(mapping_panel *self, ui *on, instance *mapping);
/* Every value, as one step. */
void mapping_panel_set(mapping_panel *self, const double *values, const char *words);

#endif
