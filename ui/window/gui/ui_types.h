/* window/gui/ui_types.h - what the user interface and its helpers hand to each other: keys, events,
 * rectangles, words. Lengths are in points. */
#ifndef MAROTTE_UI_WINDOW_GUI_UI_TYPES_H
#define MAROTTE_UI_WINDOW_GUI_UI_TYPES_H
#include <stdbool.h>
#include <stdint.h>

typedef enum ui_key { /* printable keys are their upper-case ASCII: 'A', '1', '/' , ' ' */
                      UI_KEY_NONE = 0,
                      UI_KEY_ESCAPE = 256,
                      UI_KEY_ENTER,
                      UI_KEY_TAB,
                      UI_KEY_BACKSPACE,
                      UI_KEY_DELETE,
                      UI_KEY_INSERT,
                      UI_KEY_LEFT,
                      UI_KEY_RIGHT,
                      UI_KEY_UP,
                      UI_KEY_DOWN,
                      UI_KEY_PAGE_UP,
                      UI_KEY_PAGE_DOWN,
                      UI_KEY_HOME,
                      UI_KEY_END,
                      UI_KEY_F1, /* .. F12 */
                      UI_KEY_F12 = UI_KEY_F1 + 11,
                      UI_KEY_SHIFT, /* the modifiers as keys: both sides */
                      UI_KEY_CONTROL,
                      UI_KEY_ALT,
                      UI_KEY_COUNT
} ui_key;
enum { UI_SHIFT = 1, UI_CONTROL = 2, UI_ALT = 4 }; /* modifiers, bits */

typedef enum ui_event_kind {
    UI_EVENT_NONE = 0,
    UI_EVENT_MOVE,   /* x, y: of the pointer, points from the top left */
    UI_EVENT_BUTTON, /* code 0 left, 1 right, 2 middle; is_down */
    UI_EVENT_WHEEL,  /* x, y: notches, up is positive */
    UI_EVENT_KEY,    /* code: ui_key; is_down */
    UI_EVENT_TEXT,   /* code: a Unicode code point that was typed */
    UI_EVENT_FOCUS   /* is_down: the window has it; all keys and buttons go up when it loses it */
} ui_event_kind;
typedef struct ui_event {
    ui_event_kind kind;
    float x, y;
    uint32_t code;
    bool is_down;
} ui_event;

typedef struct ui_rectangle {
    float x, y, width, height;
} ui_rectangle;

static inline bool ui_rectangle_has(ui_rectangle r, float x, float y)
{
    return x >= r.x && x < r.x + r.width && y >= r.y && y < r.y + r.height;
}

static inline bool ui_rectangles_meet(ui_rectangle a, ui_rectangle b)
{
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height &&
           b.y < a.y + a.height;
}

static inline bool ui_rectangle_is_within(ui_rectangle inner, ui_rectangle outer)
{
    return inner.x >= outer.x && inner.y >= outer.y &&
           inner.x + inner.width <= outer.x + outer.width &&
           inner.y + inner.height <= outer.y + outer.height;
}

/* A word that was drawn: tests look for overlapping and cut text. */
typedef struct ui_word {
    ui_rectangle where; /* of the ink */
    ui_rectangle clip;
    uint32_t colour, ground; /* ground: of the panel, box or widget below, 0 unknown */
    bool is_cut;             /* by an ellipsis */
    const char *text;        /* until the next ui_begin */
} ui_word;

/* A widget that was drawn: tests look for what says too little. */
typedef struct ui_control {
    char label[96]; /* the label as passed, "Name##id"; for a text field its id */
    bool has_hint;
} ui_control;

#endif
