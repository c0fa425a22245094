#include "window/gui/ui_queue.h"

#include <math.h>
#include <string.h>

void ui_queue_init(ui_queue *self)
{
    self->first = self->count = 0;
}

static ui_event *at(ui_queue *self, uint32_t index)
{
    return &self->event[(self->first + index) % UI_QUEUE_EVENTS];
}

static bool is_sound(const ui_event *event)
{
    switch (event->kind) {
    case UI_EVENT_MOVE:
    case UI_EVENT_WHEEL:
        return isfinite(event->x) && isfinite(event->y);
    case UI_EVENT_BUTTON:
        return event->code < UI_BUTTONS;
    case UI_EVENT_KEY:
        return event->code > UI_KEY_NONE && event->code < UI_KEY_COUNT;
    case UI_EVENT_TEXT:
        return event->code >= ' ' && event->code <= 0x10ffff && event->code != 0x7f;
    case UI_EVENT_FOCUS:
        return true;
    case UI_EVENT_NONE:
        break;
    }
    return false;
}

void ui_queue_push(ui_queue *self, const ui_event *event)
{
    if (!is_sound(event))
        return;
    ui_event *last = self->count ? at(self, self->count - 1) : NULL;
    if (last && last->kind == UI_EVENT_MOVE && event->kind == UI_EVENT_MOVE) {
        *last = *event;
        return;
    }
    if (self->count == UI_QUEUE_EVENTS) {
        ui_queue_init(self);
        *at(self, self->count++) = (ui_event){.kind = UI_EVENT_FOCUS};
    }
    *at(self, self->count++) = *event;
}

bool ui_queue_is_empty(const ui_queue *self)
{
    return self->count == 0;
}

/* What was handed over in this frame. */
typedef struct taken {
    bool key[UI_KEY_COUNT], button[UI_BUTTONS];
    bool any_move, any_key, any_button, any_text, any_editing_key, any_wheel, any_focus_key;
} taken;

static bool is_modifier(uint32_t key)
{
    return key == UI_KEY_SHIFT || key == UI_KEY_CONTROL || key == UI_KEY_ALT;
}

/* Keys that change text that is typed: their order among the letters matters. */
static bool is_editing(uint32_t key)
{
    return key > UI_KEY_ESCAPE - 1 && !is_modifier(key);
}

/* Keys of the focus: the next one is for what the last one chose. */
static bool is_focus_key(const ui_event *event)
{
    return event->is_down && (event->code == UI_KEY_TAB || event->code == UI_KEY_ENTER ||
                              event->code == UI_KEY_ESCAPE || event->code == ' ' ||
                              (event->code >= UI_KEY_LEFT && event->code <= UI_KEY_DOWN));
}

/* A key that does nothing but write what comes as UI_EVENT_TEXT. */
static bool only_writes(const ui_frame_input *input, uint32_t key)
{
    return input->is_typing && !is_editing(key) && key != UI_KEY_CONTROL && key != UI_KEY_ALT &&
           !input->key[UI_KEY_CONTROL] && !input->key[UI_KEY_ALT];
}

/* Whether the event has to wait for the next frame. */
static bool waits(const taken *t, const ui_frame_input *input, const ui_event *event)
{
    switch (event->kind) {
    case UI_EVENT_MOVE:
        return t->any_button || t->any_wheel;
    case UI_EVENT_BUTTON:
        /* A drag reaches its last position before the release. */
        return t->button[event->code] || (t->any_move && !event->is_down);
    case UI_EVENT_KEY:
        if (only_writes(input, event->code))
            return t->any_editing_key || t->any_button;
        if (is_modifier(event->code))
            return t->any_key || t->any_button || t->any_wheel || t->any_text;
        return t->key[event->code] || (t->any_text && is_editing(event->code)) ||
               (t->any_focus_key && is_focus_key(event));
    case UI_EVENT_TEXT:
        return t->any_editing_key || input->text_count == UI_QUEUE_TEXT;
    case UI_EVENT_FOCUS:
        return t->any_key || t->any_button;
    case UI_EVENT_WHEEL:
    case UI_EVENT_NONE:
        break;
    }
    return false;
}

static void take_key(taken *t, ui_frame_input *input, const ui_event *event)
{
    input->pressed[event->code] = event->is_down && !input->key[event->code];
    input->key[event->code] = event->is_down;
    t->key[event->code] = true;
    t->any_key |= !is_modifier(event->code);
    t->any_editing_key |= is_editing(event->code);
    t->any_focus_key |= is_focus_key(event);
}

static void take(taken *t, ui_frame_input *input, const ui_event *event)
{
    switch (event->kind) {
    case UI_EVENT_MOVE:
        input->x = event->x;
        input->y = event->y;
        input->has_pointer = t->any_move = true;
        break;
    case UI_EVENT_BUTTON:
        input->button[event->code] = event->is_down;
        t->button[event->code] = t->any_button = true;
        break;
    case UI_EVENT_WHEEL:
        input->wheel_x += event->x;
        input->wheel_y += event->y;
        t->any_wheel = true;
        break;
    case UI_EVENT_KEY:
        take_key(t, input, event);
        break;
    case UI_EVENT_TEXT:
        input->text[input->text_count++] = event->code;
        t->any_text = true;
        break;
    case UI_EVENT_FOCUS:
        if (!event->is_down) {
            memset(input->key, 0, sizeof input->key);
            memset(input->button, 0, sizeof input->button);
        }
        t->any_key = t->any_button = true;
        break;
    case UI_EVENT_NONE:
        break;
    }
}

void ui_queue_pass(ui_frame_input *input)
{
    memset(input->pressed, 0, sizeof input->pressed);
    input->wheel_x = input->wheel_y = 0.0f;
    input->text_count = 0;
}

void ui_queue_take(ui_queue *self, ui_frame_input *input)
{
    taken t = {0};
    ui_queue_pass(input);
    while (self->count && !waits(&t, input, at(self, 0))) {
        take(&t, input, at(self, 0));
        self->first = (self->first + 1) % UI_QUEUE_EVENTS;
        self->count -= 1;
    }
}

uint32_t ui_frame_modifiers(const ui_frame_input *input)
{
    return (input->key[UI_KEY_SHIFT] ? (uint32_t)UI_SHIFT : 0u) |
           (input->key[UI_KEY_CONTROL] ? (uint32_t)UI_CONTROL : 0u) |
           (input->key[UI_KEY_ALT] ? (uint32_t)UI_ALT : 0u);
}
