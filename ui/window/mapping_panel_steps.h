/* window/mapping_panel_steps.h - what was changed at the mapping, step by step, for undo and redo:
 * values of parameters, presets, or another mapping altogether. [main] */
#ifndef MAROTTE_UI_WINDOW_MAPPING_PANEL_STEPS_H
#define MAROTTE_UI_WINDOW_MAPPING_PANEL_STEPS_H
#include "window/studio.h"

typedef struct mapping_steps mapping_steps;
mapping_steps *mapping_steps_create(studio *of); /* NULL: no memory */
void mapping_steps_destroy(mapping_steps *self); /* its steps are forgotten; NULL is fine */

/* Sets the parameters of the mapping that performs to these values (param_count, by index) and
 * makes a step of those that differ. `words`: "gain 0.8". */
void mapping_steps_set(mapping_steps *self, const double *values, const char *words);
/* One parameter that has its new value already (it was dragged); `before`: what it was. */
void mapping_steps_note(mapping_steps *self, uint32_t index, double before);
/* Another mapping, by name ("": none). What is wrong with it is said in the news. */
void mapping_steps_choose(mapping_steps *self, const char *name);

/* A preset of the mapping that performs is kept (its values as they are now), or deleted. `name` is
 * clean (presets.h). */
void mapping_steps_save_preset(mapping_steps *self, const char *name);
void mapping_steps_delete_preset(mapping_steps *self, const char *name);
/* Counts what was kept and deleted, also by undo and redo. */
uint32_t mapping_steps_preset_edition(const mapping_steps *self);

/* "one_hand,gain=0.8": what performs now, for live_set_mapping; "" none. */
void mapping_steps_text(studio *of, char *out, size_t capacity);

#endif
