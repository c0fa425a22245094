#include "window/script_random.h"

static uint32_t draw(script_random *self, uint32_t below)
{
    self->state ^= self->state << 13; /* Marsaglia's xorshift64 */
    self->state ^= self->state >> 7;
    self->state ^= self->state << 17;
    return (uint32_t)(self->state >> 33) % below;
}

void script_random_begin(script_random *self, uint64_t seed)
{
    *self = (script_random){.state = seed * 0x9e3779b97f4a7c15u + 0x1234567u};
    if (self->state == 0)
        self->state = 1;
    (void)draw(self, 1);
}

static void push_move(ui *on, float x, float y)
{
    const ui_event event = {.kind = UI_EVENT_MOVE, .x = x, .y = y};
    ui_push(on, &event);
}

static void push_button(ui *on, uint32_t button, bool is_down)
{
    const ui_event event = {.kind = UI_EVENT_BUTTON, .code = button, .is_down = is_down};
    ui_push(on, &event);
}

static void push_key(ui *on, uint32_t key, bool is_down)
{
    const ui_event event = {.kind = UI_EVENT_KEY, .code = key, .is_down = is_down};
    ui_push(on, &event);
}

static void go_anywhere(script_random *self, float width, float height)
{
    self->x = (float)draw(self, 4096) / 4096.0f * width;
    self->y = (float)draw(self, 4096) / 4096.0f * height;
}

static void click(script_random *self, ui *on)
{
    const uint32_t button = draw(self, 8) == 0 ? 1 + draw(self, 2) : 0;
    push_move(on, self->x, self->y);
    for (uint32_t i = 0; i < (draw(self, 6) == 0 ? 2u : 1u); ++i) {
        push_button(on, button, true);
        push_button(on, button, false);
    }
}

static void begin_drag(script_random *self, ui *on, float width, float height)
{
    self->button = draw(self, 6) == 0 ? 1 + draw(self, 2) : 0;
    self->steps = 2 + draw(self, 30);
    push_move(on, self->x, self->y);
    push_button(on, self->button, true);
    self->to_x = self->x + ((float)draw(self, 2000) / 1000.0f - 1.0f) * 0.3f * width;
    self->to_y = self->y + ((float)draw(self, 2000) / 1000.0f - 1.0f) * 0.3f * height;
}

static void go_on_dragging(script_random *self, ui *on)
{
    const float share = 1.0f / (float)self->steps;
    self->x += share * (self->to_x - self->x);
    self->y += share * (self->to_y - self->y);
    push_move(on, self->x, self->y);
    self->steps -= 1;
    if (self->steps == 0)
        push_button(on, self->button, false);
}

static uint32_t any_key(script_random *self)
{
    static const uint32_t others[] = {
        UI_KEY_ESCAPE,    UI_KEY_ESCAPE, UI_KEY_ENTER, UI_KEY_TAB,
        UI_KEY_BACKSPACE, UI_KEY_DELETE, UI_KEY_LEFT,  UI_KEY_RIGHT,
        UI_KEY_UP,        UI_KEY_DOWN,   UI_KEY_HOME,  UI_KEY_END,
        UI_KEY_PAGE_UP,   ' ',           ' ',          UI_KEY_PAGE_DOWN};
    static const char printable[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789[],.-=/";
    switch (draw(self, 4)) {
    case 0:
        return others[draw(self, sizeof others / sizeof others[0])];
    case 1:
        return UI_KEY_F1 + draw(self, 12);
    default:
        return (uint32_t)printable[draw(self, sizeof printable - 1)];
    }
}

static void press_key(script_random *self, ui *on)
{
    static const uint32_t holds[] = {0, 0, 0, 0, UI_KEY_SHIFT, UI_KEY_CONTROL, UI_KEY_ALT};
    const uint32_t hold = holds[draw(self, sizeof holds / sizeof holds[0])];
    const uint32_t key = any_key(self);
    if (hold == UI_KEY_CONTROL && (key == 'Q' || key == 'S'))
        return;
    if (hold)
        push_key(on, hold, true);
    push_key(on, key, true);
    push_key(on, key, false);
    if (hold)
        push_key(on, hold, false);
}

static void type(script_random *self, ui *on)
{
    const uint32_t length = 1 + draw(self, 6);
    for (uint32_t i = 0; i < length; ++i) {
        const ui_event event = {.kind = UI_EVENT_TEXT, .code = 'a' + draw(self, 26)};
        ui_push(on, &event);
    }
}

static void turn_wheel(script_random *self, ui *on)
{
    const ui_event event = {.kind = UI_EVENT_WHEEL, .y = draw(self, 2) ? 1.0f : -1.0f};
    push_move(on, self->x, self->y);
    ui_push(on, &event);
}

/* Whoever has been asked for some seconds gives up some time: behind a question nothing else can be
 * reached. */
static bool gives_up(script_random *self)
{
    enum { PATIENCE_STEPS = 40, ONE_IN = 3 };
    return self->asked_count > PATIENCE_STEPS && draw(self, ONE_IN) == 0;
}

void script_random_step(script_random *self, ui *on, float width, float height)
{
    self->asked_count = ui_has_dialog(on) ? self->asked_count + 1 : 0;
    if (self->steps) {
        go_on_dragging(self, on);
        return;
    }
    if (gives_up(self)) {
        push_key(on, UI_KEY_ESCAPE, true);
        push_key(on, UI_KEY_ESCAPE, false);
        return;
    }
    if (draw(self, 3) == 0) /* people look, too */
        return;
    go_anywhere(self, width, height);
    switch (draw(self, 10)) {
    case 0:
    case 1:
        push_move(on, self->x, self->y);
        break;
    case 2:
    case 3:
    case 4:
        click(self, on);
        break;
    case 5:
    case 6:
        begin_drag(self, on, width, height);
        break;
    case 7:
        turn_wheel(self, on);
        break;
    case 8:
        press_key(self, on);
        break;
    default:
        if (draw(self, 3) == 0)
            type(self, on);
        else
            press_key(self, on);
        break;
    }
}

void script_random_end(script_random *self, ui *on)
{
    const ui_event event = {.kind = UI_EVENT_FOCUS, .is_down = false};
    self->steps = 0;
    ui_push(on, &event);
}
