/* window/app/presets.h - a mapping under a name, kept in the settings: the values of its parameters
 * that differ from their initial ones, and what it was taught, as "key=value,...,taught:BYTES" in
 * hexadecimal. Names are one level of a settings key: a '.' in them becomes '-'. [main] */
#ifndef MAROTTE_UI_WINDOW_APP_PRESETS_H
#define MAROTTE_UI_WINDOW_APP_PRESETS_H
#include "stage/mapping/instance.h"
#include "window/app/settings.h"

enum {
    PRESET_NAME = 48,
    PRESET_TEXT = 8192,                 /* of values */
    PRESET_MAPPING = PRESET_TEXT + 256, /* with the mapping's id before them */
    PRESET_KEY = 256,
    PRESET_TAUGHT_MAX = 32 << 10 /* bytes: the settings are one small file */
};

/* What the name becomes; false: it is none (empty, control characters, too long). */
bool presets_clean_name(char out[PRESET_NAME], const char *name);
/* Names of this mapping's, to be freed as one block; returns their number. */
uint32_t presets_list(const settings *of, const mrt_plugin_type *type, char ***out);
/* Key of the preset in the settings. Its value is the text of the preset. */
void presets_key(char out[PRESET_KEY], const mrt_plugin_type *type, const char *name);
/* Text of the preset; NULL: none. Valid until the settings change. */
const char *presets_kept(const settings *of, const mrt_plugin_type *type, const char *name);

/* The changed values, "push=5,ease=0.2"; cut at a value's end where it does not fit. */
void presets_text(const instance *mapping, char *out, size_t capacity);
/* "org.marotte.one_hand,push=5": for live_set_mapping; "" of NULL. */
void presets_mapping_text(const instance *mapping, char *out, size_t capacity);
/* The text of a whole preset. taught: of the mapping; size 0: it cannot be taught. To be freed;
 * NULL: no memory. */
char *presets_make(const instance *mapping, const void *taught, size_t size);
/* Whether a preset's values are those of `values`, as presets_text writes them. */
bool presets_has_values(const char *text, const char *values);
/* Returns the learned data in a text, to be freed; NULL with size 0: none. Error: the data is
 * damaged. */
CHECKED mrt_result presets_taught(const char *text, unsigned char **out, size_t *out_size,
                                  error *err);
/* Reads param_count values from a text. Missing ones are initial values. Names that the type does
 * not have are listed in the note (or ""), so a preset of another version can be used partly. */
void presets_values(const mrt_plugin_type *type, const char *text, double *out_values,
                    error *out_note);

#endif
