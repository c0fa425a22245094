#include "window/app/key_map.h"
#include "window/gui/ui_types.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- names ---- */

typedef struct named {
    const char *name;
    uint32_t key;
} named;

static const named key_names[] = {
    /* the first of a key is the one that is shown */
    {"Space", ' '},
    {"Esc", UI_KEY_ESCAPE},
    {"Escape", UI_KEY_ESCAPE},
    {"Enter", UI_KEY_ENTER},
    {"Tab", UI_KEY_TAB},
    {"Backspace", UI_KEY_BACKSPACE},
    {"Del", UI_KEY_DELETE},
    {"Delete", UI_KEY_DELETE},
    {"Ins", UI_KEY_INSERT},
    {"Insert", UI_KEY_INSERT},
    {"Left", UI_KEY_LEFT},
    {"Right", UI_KEY_RIGHT},
    {"Up", UI_KEY_UP},
    {"Down", UI_KEY_DOWN},
    {"Page up", UI_KEY_PAGE_UP},
    {"PageUp", UI_KEY_PAGE_UP},
    {"Page down", UI_KEY_PAGE_DOWN},
    {"PageDown", UI_KEY_PAGE_DOWN},
    {"Home", UI_KEY_HOME},
    {"End", UI_KEY_END},
    {"Shift", UI_KEY_SHIFT},
    {"Ctrl", UI_KEY_CONTROL},
    {"Alt", UI_KEY_ALT},
};
enum { KEY_NAMES = sizeof key_names / sizeof key_names[0] };

static const named modifier_names[] = {
    {"Shift+", UI_SHIFT}, {"Ctrl+", UI_CONTROL}, {"Alt+", UI_ALT}};

static void write_key(char *out, size_t capacity, uint32_t key)
{
    for (size_t i = 0; i < KEY_NAMES; ++i)
        if (key_names[i].key == key) {
            (void)snprintf(out, capacity, "%s", key_names[i].name);
            return;
        }
    if (key >= UI_KEY_F1 && key <= UI_KEY_F12)
        (void)snprintf(out, capacity, "F%u", key - UI_KEY_F1 + 1);
    else
        (void)snprintf(out, capacity, "%c", (int)key);
}

void key_chord_words(key_chord chord, char out[KEY_WORDS])
{
    char key[16] = "";
    const bool is_question = chord.key == '/' && chord.modifiers == UI_SHIFT;
    out[0] = '\0';
    if (chord.key == UI_KEY_NONE)
        return;
    write_key(key, sizeof key, chord.key);
    (void)snprintf(out, KEY_WORDS, "%s%s%s%s", chord.modifiers & UI_CONTROL ? "Ctrl+" : "",
                   chord.modifiers & UI_ALT ? "Alt+" : "",
                   chord.modifiers & UI_SHIFT && !is_question ? "Shift+" : "",
                   is_question ? "?" : key);
}

static bool is_function_key(const char *name, uint32_t *out_key)
{
    char *end;
    if ((name[0] != 'F' && name[0] != 'f') || name[1] < '0' || name[1] > '9')
        return false;
    const long number = strtol(name + 1, &end, 10);
    if (*end || number < 1 || number > 12)
        return false;
    *out_key = UI_KEY_F1 + (uint32_t)number - 1;
    return true;
}

bool key_chord_parse(key_chord *out, const char *name)
{
    *out = (key_chord){0};
    for (size_t i = 0; i < 3; ++i) {
        const size_t length = strlen(modifier_names[i].name);
        if (strncasecmp(name, modifier_names[i].name, length) != 0 || !name[length])
            continue;
        out->modifiers |= modifier_names[i].key;
        name += length;
        i = (size_t)-1; /* in any order */
    }
    for (size_t i = 0; i < KEY_NAMES; ++i)
        if (strcasecmp(name, key_names[i].name) == 0) {
            out->key = key_names[i].key;
            return true;
        }
    if (is_function_key(name, &out->key))
        return true;
    if (name[0] <= ' ' || name[0] > '~' || name[1])
        return false;
    if (name[0] == '?')
        *out = (key_chord){'/', out->modifiers | UI_SHIFT};
    else
        out->key =
            name[0] >= 'a' && name[0] <= 'z' ? (uint32_t)(name[0] - 'a' + 'A') : (uint32_t)name[0];
    return true;
}

/* ---- the map ---- */

static bool are_equal(key_chord a, key_chord b)
{
    return a.key == b.key && a.modifiers == b.modifiers;
}

static key_chord brought(action of)
{
    return (key_chord){action_of(of)->key, action_of(of)->modifiers};
}

key_chord key_map_of(const key_map *self, action of)
{
    return self->of[of].is_own ? self->of[of].chord : brought(of);
}

void key_map_words(const key_map *self, action of, char out[KEY_WORDS])
{
    key_chord_words(key_map_of(self, of), out);
}

void key_map_after(const key_map *self, action of, char out[KEY_WORDS + 4])
{
    char words[KEY_WORDS];
    key_map_words(self, of, words);
    (void)snprintf(out, KEY_WORDS + 4, words[0] ? " (%s)" : "", words);
}

action key_map_action(const key_map *self, key_chord chord)
{
    for (uint32_t i = 1; i < ACTION_COUNT && chord.key != UI_KEY_NONE; ++i)
        if (are_equal(key_map_of(self, (action)i), chord))
            return (action)i;
    return ACTION_NONE;
}

const char *key_map_refusal(key_chord chord)
{
    if (chord.key == UI_KEY_ESCAPE)
        return "Esc closes and cancels";
    if (chord.key == UI_KEY_ENTER)
        return "Enter confirms";
    if (chord.key == UI_KEY_TAB && (chord.modifiers & ~(uint32_t)UI_SHIFT) == 0)
        return "Tab goes round the controls";
    if (chord.key == UI_KEY_NONE || chord.key >= UI_KEY_SHIFT)
        return "press a key together with Shift, Ctrl or Alt";
    return NULL;
}

static void give(key_map *self, action to, key_chord chord)
{
    self->of[to].is_own = !are_equal(chord, brought(to));
    self->of[to].chord = chord;
}

void key_map_set(key_map *self, action of, key_chord chord)
{
    const action holder = key_map_action(self, chord);
    if (holder != ACTION_NONE && holder != of)
        give(self, holder, (key_chord){0});
    give(self, of, chord);
}

/* ---- kept ---- */

static void settings_key(char out[96], action of)
{
    (void)snprintf(out, 96, "keys.%s", action_of(of)->name);
}

static action own_of(const key_map *self, key_chord chord)
{
    for (uint32_t i = 1; i < ACTION_COUNT; ++i)
        if (self->of[i].is_own && are_equal(self->of[i].chord, chord))
            return (action)i;
    return ACTION_NONE;
}

void key_map_read(key_map *out, const settings *from)
{
    memset(out, 0, sizeof *out);
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        char key[96];
        key_chord chord = {0};
        settings_key(key, (action)i);
        const char *kept = settings_text(from, key, NULL);
        if (!kept || (kept[0] && (!key_chord_parse(&chord, kept) || key_map_refusal(chord) ||
                                  own_of(out, chord) != ACTION_NONE)))
            continue;
        give(out, (action)i, chord);
    }
    for (uint32_t i = 1; i < ACTION_COUNT; ++i)
        if (!out->of[i].is_own && brought((action)i).key != UI_KEY_NONE &&
            own_of(out, brought((action)i)) != ACTION_NONE)
            give(out, (action)i, (key_chord){0});
}

void key_map_keep(const key_map *self, settings *to)
{
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        char key[96], words[KEY_WORDS];
        settings_key(key, (action)i);
        key_chord_words(self->of[i].chord, words);
        settings_set_text(to, key, self->of[i].is_own ? words : NULL);
    }
}
