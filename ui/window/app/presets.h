/* window/app/presets.h - the values of a mapping's parameters under a name, kept in the settings:
 * those that differ from their initial value, as "key=value,...". Names are one level of a settings
 * key: a '.' in them becomes '-'. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_PRESETS_H
#define MAROTTE_UI_WINDOW_APP_PRESETS_H
#include "stage/mapping/instance.h"
#include "window/app/settings.h"

enum { PRESET_NAME = 48, PRESET_TEXT = 8192, PRESET_KEY = 256 };

/* What the name becomes; false: it is none (empty, control characters, too long). */
bool presets_clean_name(char out[PRESET_NAME], const char *name);
/* Names of this mapping's, to be freed as one block; returns their number. */
uint32_t presets_list(const settings *of, const mrt_plugin_type *type, char ***out);
/* Of the settings: what is kept there is its text. */
void presets_key(char out[PRESET_KEY], const mrt_plugin_type *type, const char *name);
/* Its text; NULL: there is none. Until the settings change. */
const char *presets_kept(const settings *of, const mrt_plugin_type *type, const char *name);

/* The changed values, "push=5,ease=0.2"; cut at a value's end where it does not fit. */
void presets_text(const instance *mapping, char *out, size_t capacity);
/* The values that a text stands for, param_count of them: what it does not name is initial. What it
 * names and the type does not have is in the note (""): a preset of another version is used as far
 * as it goes. */
void presets_values(const mrt_plugin_type *type, const char *text, double *out_values,
                    error *out_note);

#endif
