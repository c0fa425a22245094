#include "window/front_keys.h"

#include "window/ui.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

typedef struct pair {
    int theirs;
    uint32_t ours;
} pair;

static const pair pairs[] = {
    {GLFW_KEY_ESCAPE, UI_KEY_ESCAPE},
    {GLFW_KEY_ENTER, UI_KEY_ENTER},
    {GLFW_KEY_KP_ENTER, UI_KEY_ENTER},
    {GLFW_KEY_TAB, UI_KEY_TAB},
    {GLFW_KEY_BACKSPACE, UI_KEY_BACKSPACE},
    {GLFW_KEY_DELETE, UI_KEY_DELETE},
    {GLFW_KEY_INSERT, UI_KEY_INSERT},
    {GLFW_KEY_LEFT, UI_KEY_LEFT},
    {GLFW_KEY_RIGHT, UI_KEY_RIGHT},
    {GLFW_KEY_UP, UI_KEY_UP},
    {GLFW_KEY_DOWN, UI_KEY_DOWN},
    {GLFW_KEY_PAGE_UP, UI_KEY_PAGE_UP},
    {GLFW_KEY_PAGE_DOWN, UI_KEY_PAGE_DOWN},
    {GLFW_KEY_HOME, UI_KEY_HOME},
    {GLFW_KEY_END, UI_KEY_END},
    {GLFW_KEY_LEFT_SHIFT, UI_KEY_SHIFT},
    {GLFW_KEY_RIGHT_SHIFT, UI_KEY_SHIFT},
    {GLFW_KEY_LEFT_CONTROL, UI_KEY_CONTROL},
    {GLFW_KEY_RIGHT_CONTROL, UI_KEY_CONTROL},
    {GLFW_KEY_LEFT_ALT, UI_KEY_ALT},
    {GLFW_KEY_KP_ADD, '='},
    {GLFW_KEY_KP_SUBTRACT, '-'},
    {GLFW_KEY_KP_DECIMAL, '.'},
    {GLFW_KEY_KP_DIVIDE, '/'},
};

static uint32_t from_table(int key)
{
    for (uint32_t i = 0; i < sizeof pairs / sizeof pairs[0]; ++i)
        if (pairs[i].theirs == key)
            return pairs[i].ours;
    return UI_KEY_NONE;
}

/* Digits are where they are on every keyboard; on some they are written with Shift. */
uint32_t front_key_of(int key, int scancode)
{
    const uint32_t named = from_table(key);
    if (named != UI_KEY_NONE)
        return named;
    if (key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12)
        return UI_KEY_F1 + (uint32_t)(key - GLFW_KEY_F1);
    if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
        return '0' + (uint32_t)(key - GLFW_KEY_KP_0);
    if (key < GLFW_KEY_SPACE || key > GLFW_KEY_GRAVE_ACCENT)
        return UI_KEY_NONE;
    const char *name = glfwGetKeyName(key, scancode);
    const bool is_digit = key >= GLFW_KEY_0 && key <= GLFW_KEY_9;
    if (is_digit || !name || name[0] <= ' ' || name[0] > '~' || name[1] != '\0')
        return (uint32_t)key;
    return name[0] >= 'a' && name[0] <= 'z' ? (uint32_t)(name[0] - 'a' + 'A') : (uint32_t)name[0];
}
