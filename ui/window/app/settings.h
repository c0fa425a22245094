/* window/app/settings.h - what is kept between runs: a small JSON file in the user's configuration
 * folder ($XDG_CONFIG_HOME/marotte/window.json). Several stages may share the file: each writes
 * only the keys that it changed into what the file holds by then, under a lock, beside it and
 * renamed. Unknown keys are kept. A file with a newer "version" is read and never written. [main]
 */
#ifndef MAROTTE_UI_WINDOW_APP_SETTINGS_H
#define MAROTTE_UI_WINDOW_APP_SETTINGS_H
#include "base/error.h"

typedef struct settings settings;

/* path NULL: the default file of the user; "": no file. A damaged default file is renamed to
 * window.json.damaged (or -2, -3, never over another file), and out_note reports it (or ""). A
 * named file that is not a settings file of marotte is an error and is never changed: a text, JSON
 * of another program, a folder, a broken link. */
CHECKED mrt_result settings_open(settings **out, const char *path, char *out_note, size_t capacity,
                                 error *err);
/* Writes what has changed. MRT_END: another program writes there; the changes wait for the next
 * call. A file that is no longer one of settings is treated as by settings_open. */
CHECKED mrt_result settings_write(settings *self, error *err);
CHECKED mrt_result settings_write_last(settings *self, error *err); /* waits up to 5 s for others */
void settings_close(settings *self); /* NULL is fine; does not write */

/* Folder of the file, with a final '/', for other data that is kept between runs (an unsaved rig);
 * "": do not write anything. */
const char *settings_folder(const settings *self);

/* Keys are paths: "looks.timeline_height", "mapping.one_hand.preset.soft". */
double settings_number(const settings *self, const char *key, double otherwise);
const char *settings_text(const settings *self, const char *key,
                          const char *otherwise); /* until
                                                     changed */
void settings_set_number(settings *self, const char *key, double value);
void settings_set_text(settings *self, const char *key, const char *value); /* NULL: removes it */
/* Texts in their order, as "outputs.0", "outputs.1" ...: `most` at most. Those that are read are
 * valid until the settings change; those that are set may be texts of the settings. */
uint32_t settings_list(const settings *self, const char *key, const char **out, uint32_t most);
void settings_set_list(settings *self, const char *key, const char *const *texts, uint32_t count,
                       uint32_t most);
/* The keys one level below `key`; the list and its texts are the caller's to free as one block. */
uint32_t settings_keys(const settings *self, const char *key, char ***out);

#endif
