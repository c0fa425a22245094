/* window/script_keys.h - keys by their names: "R", "Ctrl+Shift+Z", "Space", "F11", "?". Pure. */
#ifndef MAROTTE_UI_WINDOW_SCRIPT_KEYS_H
#define MAROTTE_UI_WINDOW_SCRIPT_KEYS_H
#include <stdbool.h>
#include <stdint.h>

bool script_key_of(const char *name, uint32_t *out_key, uint32_t *out_modifiers);

#endif
