/* window/app/key_map.h - which key does what: the table of action.h with what the person changed,
 * kept in the settings. Menus, tooltips, the help and the keys themselves all read it. Pure, but
 * for the settings. */
#ifndef MAROTTE_UI_WINDOW_APP_KEY_MAP_H
#define MAROTTE_UI_WINDOW_APP_KEY_MAP_H
#include "window/app/action.h"
#include "window/app/settings.h"

typedef struct key_chord {
    uint32_t key, modifiers; /* ui.h; key 0: none */
} key_chord;
typedef struct key_map { /* zeroed: as the program brings them */
    struct {
        bool is_own;
        key_chord chord;
    } of[ACTION_COUNT];
} key_map;

key_chord key_map_of(const key_map *self, action of);
enum { KEY_WORDS = 40 };
void key_map_words(const key_map *self, action of, char out[KEY_WORDS]); /* "Ctrl+Z", "?"; "" */
/* After what a sentence names: " (F4)"; "" */
void key_map_after(const key_map *self, action of, char out[KEY_WORDS + 4]);
/* The action of the chord; ACTION_NONE: none. */
action key_map_action(const key_map *self, key_chord chord);
/* Why nothing can be done by that chord; NULL: it can. */
const char *key_map_refusal(key_chord chord);
/* Assigns the chord to `of`, and removes it from any other action. */
void key_map_set(key_map *self, action of, key_chord chord);

/* Reads keys from settings. They override the defaults; invalid entries are ignored. */
void key_map_read(key_map *out, const settings *from);
void key_map_keep(const key_map *self, settings *to);

void key_chord_words(key_chord chord, char out[KEY_WORDS]);
/* "R", "Ctrl+Shift+Z", "Space", "F11", "?": in any case and order. */
bool key_chord_parse(key_chord *out, const char *name);

#endif
