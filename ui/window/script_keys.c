#include "window/script_keys.h"

#include "window/ui.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct named {
    const char *name;
    uint32_t key;
} named;

static const named keys[] = {
    {"Space", ' '},
    {"Esc", UI_KEY_ESCAPE},
    {"Escape", UI_KEY_ESCAPE},
    {"Enter", UI_KEY_ENTER},
    {"Tab", UI_KEY_TAB},
    {"Backspace", UI_KEY_BACKSPACE},
    {"Delete", UI_KEY_DELETE},
    {"Del", UI_KEY_DELETE},
    {"Insert", UI_KEY_INSERT},
    {"Left", UI_KEY_LEFT},
    {"Right", UI_KEY_RIGHT},
    {"Up", UI_KEY_UP},
    {"Down", UI_KEY_DOWN},
    {"PageUp", UI_KEY_PAGE_UP},
    {"PageDown", UI_KEY_PAGE_DOWN},
    {"Home", UI_KEY_HOME},
    {"End", UI_KEY_END},
    {"Shift", UI_KEY_SHIFT},
    {"Ctrl", UI_KEY_CONTROL},
    {"Alt", UI_KEY_ALT},
};

static const named modifiers[] = {{"Shift+", UI_SHIFT}, {"Ctrl+", UI_CONTROL}, {"Alt+", UI_ALT}};

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

bool script_key_of(const char *name, uint32_t *out_key, uint32_t *out_modifiers)
{
    *out_modifiers = 0;
    for (size_t i = 0; i < 3; ++i) {
        const size_t length = strlen(modifiers[i].name);
        if (strncasecmp(name, modifiers[i].name, length) != 0 || !name[length])
            continue;
        *out_modifiers |= modifiers[i].key;
        name += length;
        i = (size_t)-1; /* in any order */
    }
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; ++i)
        if (strcasecmp(name, keys[i].name) == 0) {
            *out_key = keys[i].key;
            return true;
        }
    if (is_function_key(name, out_key))
        return true;
    if (name[0] <= ' ' || name[0] > '~' || name[1])
        return false;
    if (name[0] == '?') {
        *out_key = '/';
        *out_modifiers |= UI_SHIFT;
        return true;
    }
    *out_key =
        name[0] >= 'a' && name[0] <= 'z' ? (uint32_t)(name[0] - 'a' + 'A') : (uint32_t)name[0];
    return true;
}
