#include "window/script.h"
#include "window/app/key_map.h"
#include "window/gui/ui.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- random input ---- */

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

static void push(ui *on, ui_event event)
{
    ui_push(on, &event);
}

static void push_move(ui *on, float x, float y)
{
    push(on, (ui_event){.kind = UI_EVENT_MOVE, .x = x, .y = y});
}

static void push_button(ui *on, uint32_t button, bool is_down)
{
    push(on, (ui_event){.kind = UI_EVENT_BUTTON, .code = button, .is_down = is_down});
}

static void push_key(ui *on, uint32_t key, bool is_down)
{
    push(on, (ui_event){.kind = UI_EVENT_KEY, .code = key, .is_down = is_down});
}

static void press_and_release(ui *on, uint32_t key)
{
    push_key(on, key, true);
    push_key(on, key, false);
}

static void go_anywhere(script_random *self, float width, float height)
{
    self->x = (float)draw(self, 4096) / 4096.0f * width;
    self->y = (float)draw(self, 4096) / 4096.0f * height;
}

static void click_anywhere(script_random *self, ui *on)
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
    press_and_release(on, key);
    if (hold)
        push_key(on, hold, false);
}

static void type(script_random *self, ui *on)
{
    const uint32_t length = 1 + draw(self, 6);
    for (uint32_t i = 0; i < length; ++i)
        push(on, (ui_event){.kind = UI_EVENT_TEXT, .code = 'a' + draw(self, 26)});
}

static void turn_wheel(script_random *self, ui *on)
{
    const float notch = draw(self, 2) ? 1.0f : -1.0f;
    push_move(on, self->x, self->y);
    push(on, (ui_event){.kind = UI_EVENT_WHEEL, .y = notch});
}

/* Whether to close a dialog after some seconds, because it blocks everything else. */
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
        press_and_release(on, UI_KEY_ESCAPE);
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
        click_anywhere(self, on);
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
    self->steps = 0;
    push(on, (ui_event){.kind = UI_EVENT_FOCUS, .is_down = false});
}

/* ---- a script ---- */

enum { NUMBERS_MAX = 5, SIZE_CAP = 1 << 20, PATIENCE_FRAMES = 300 };

typedef enum command_kind {
    COMMAND_MOVE = 0,
    COMMAND_DOWN,
    COMMAND_UP,
    COMMAND_CLICK,
    COMMAND_DRAG,
    COMMAND_WHEEL,
    COMMAND_KEY,
    COMMAND_HOLD,
    COMMAND_RELEASE,
    COMMAND_TYPE,
    COMMAND_DO,
    COMMAND_PRESS,
    COMMAND_WAIT,
    COMMAND_FRAMES,
    COMMAND_PICTURE,
    COMMAND_CALM,
    COMMAND_MEMORY,
    COMMAND_RANDOM,
    COMMAND_KINDS
} command_kind;

typedef enum rest_kind { REST_NONE = 0, REST_BUTTON, REST_TEXT } rest_kind;

static const struct {
    const char *name;
    uint32_t numbers;
    rest_kind rest;
    const char *help;
} kinds[COMMAND_KINDS] = {
    [COMMAND_MOVE] = {"move", 2, REST_NONE, "move X Y              move the pointer, in points"},
    [COMMAND_DOWN] = {"down", 0, REST_BUTTON, "down [BUTTON]         left, right or middle"},
    [COMMAND_UP] = {"up", 0, REST_BUTTON, "up [BUTTON]"},
    [COMMAND_CLICK] = {"click", 2, REST_BUTTON, "click X Y [BUTTON]"},
    [COMMAND_DRAG] = {"drag", 5, REST_BUTTON,
                      "drag X Y X Y STEPS [BUTTON]   one step in each frame"},
    [COMMAND_WHEEL] = {"wheel", 1, REST_NONE, "wheel NOTCHES         up is positive"},
    [COMMAND_KEY] = {"key", 0, REST_TEXT, "key NAME              R, Ctrl+Shift+Z, Space, F11, ?"},
    [COMMAND_HOLD] = {"hold", 0, REST_TEXT,
                      "hold KEY              until it is released: Shift, Ctrl"},
    [COMMAND_RELEASE] = {"release", 0, REST_TEXT, "release KEY"},
    [COMMAND_TYPE] = {"type", 0, REST_TEXT, "type TEXT             into the focused field"},
    [COMMAND_DO] = {"do", 0, REST_TEXT, "do ACTION             record, keep, play, view_side ..."},
    [COMMAND_PRESS] = {"press", 0, REST_TEXT, "press WORDS           click this text"},
    [COMMAND_WAIT] = {"wait", 1, REST_NONE, "wait SECONDS          of real time"},
    [COMMAND_FRAMES] = {"frames", 1, REST_NONE, "frames N              wait for N frames"},
    [COMMAND_PICTURE] = {"picture", 0, REST_TEXT, "picture FILE.png      of the window"},
    [COMMAND_CALM] = {"calm", 0, REST_NONE,
                      "calm                  stop everything and return to the live hands"},
    [COMMAND_MEMORY] = {"memory", 0, REST_TEXT, "memory WORDS          print the memory in use"},
    [COMMAND_RANDOM] = {"random", 2, REST_NONE,
                        "random SEED SECONDS   clicks, drags, keys; never ends the program"},
};

typedef struct command {
    command_kind kind;
    uint32_t line, button, key, modifiers;
    double number[NUMBERS_MAX];
    char *text;
    action act;
} command;

struct script {
    char *path;
    command *command;
    uint32_t count, at;
    /* of the command that is being done */
    uint32_t step;
    int64_t until_ns;
    script_random random;
};

/* ---- reading ---- */

static bool button_named(const char *name, uint32_t *out)
{
    static const char *const names[] = {"left", "right", "middle"};
    for (uint32_t i = 0; i < 3; ++i)
        if (strcmp(name, names[i]) == 0) {
            *out = i;
            return true;
        }
    return false;
}

static mrt_result wrong(const script *self, uint32_t line, const char *what, const char *expected,
                        error *err)
{
    return error_set(err, MRT_ERR_FORMAT, "%s:%u: %s: expected %s", self->path, line, what,
                     expected);
}

static bool is_of_a_key(command_kind kind)
{
    return kind == COMMAND_KEY || kind == COMMAND_HOLD || kind == COMMAND_RELEASE;
}

/* What stands behind the numbers: a button, or text. */
static mrt_result read_rest(const script *self, command *out, text_view rest, error *err)
{
    const char *help = kinds[out->kind].help;
    char word[600];
    rest = text_trim(rest);
    text_copy(word, sizeof word, rest);
    const rest_kind wanted = kinds[out->kind].rest;
    if (wanted == REST_BUTTON && word[0] && !button_named(word, &out->button))
        return wrong(self, out->line, word, "left, right or middle", err);
    if ((wanted == REST_NONE && word[0]) || (wanted == REST_TEXT && !word[0]))
        return wrong(self, out->line, kinds[out->kind].name, help, err);
    if (wanted != REST_TEXT)
        return MRT_OK;
    out->text = strndup(rest.at, (size_t)(rest.end - rest.at));
    if (!out->text)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", self->path);
    key_chord chord = {0};
    if (is_of_a_key(out->kind) && !key_chord_parse(&chord, out->text))
        return wrong(self, out->line, word, "a key: R, Ctrl+Shift+Z, Space, F11, ?", err);
    out->key = chord.key;
    out->modifiers = chord.modifiers;
    if (out->kind == COMMAND_DO)
        out->act = action_named(out->text);
    if (out->kind == COMMAND_DO && out->act == ACTION_NONE)
        return wrong(self, out->line, word, "the name of an action: record, keep, play", err);
    return MRT_OK;
}

static mrt_result read_line(const script *self, command *out, text_view line, error *err)
{
    text_view word;
    char shown[64];
    if (!text_next_word(&line, &word))
        return MRT_END;
    for (out->kind = 0; out->kind < COMMAND_KINDS; ++out->kind)
        if (text_equals(word, kinds[out->kind].name))
            break;
    text_copy(shown, sizeof shown, word);
    if (out->kind == COMMAND_KINDS)
        return wrong(self, out->line, shown, "a command: move, click, drag, key, do, wait", err);
    for (uint32_t i = 0; i < kinds[out->kind].numbers; ++i)
        if (!text_next_word(&line, &word) || !text_double(word, &out->number[i]))
            return wrong(self, out->line, shown, kinds[out->kind].help, err);
    return read_rest(self, out, line, err);
}

static mrt_result read_all(script *self, text_view text, error *err)
{
    text_view line;
    mrt_result result = MRT_OK;
    for (uint32_t number = 1; result >= 0 && text_next_line(&text, &line); ++number) {
        command *grown = realloc(self->command, (self->count + 1) * sizeof *grown);
        if (!grown)
            return error_set(err, MRT_ERR_MEMORY, "%s: no memory", self->path);
        self->command = grown;
        command *one = &self->command[self->count];
        *one = (command){.line = number};
        line = text_trim(line);
        if (line.at == line.end || *line.at == '#')
            continue;
        self->count += 1;
        result = read_line(self, one, line, err);
    }
    return result < 0 ? result : MRT_OK;
}

mrt_result script_read(script **out, const char *path, error *err)
{
    file_bytes bytes;
    *out = NULL;
    mrt_result result = file_read(&bytes, path, SIZE_CAP, err);
    if (result < 0)
        return result;
    script *self = calloc(1, sizeof *self);
    if (self)
        self->path = strdup(path);
    result = self && self->path ? read_all(self, text_view_of(bytes.data, bytes.size), err)
                                : error_set(err, MRT_ERR_MEMORY, "%s: no memory", path);
    file_bytes_finish(&bytes);
    if (result < 0) {
        script_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void script_destroy(script *self)
{
    if (!self)
        return;
    for (uint32_t i = 0; i < self->count; ++i)
        free(self->command[i].text);
    free(self->command);
    free(self->path);
    free(self);
}

const char *script_help(void)
{
    static char text[2000]; /* the same each time */
    size_t length = 0;
    for (uint32_t i = 0; i < COMMAND_KINDS; ++i)
        length += (size_t)snprintf(text + length, sizeof text - length, "  %s\n", kinds[i].help);
    return text;
}

/* ---- doing ---- */

static void push_modifiers(ui *on, uint32_t modifiers, bool is_down)
{
    static const uint32_t keys[][2] = {
        {UI_SHIFT, UI_KEY_SHIFT}, {UI_CONTROL, UI_KEY_CONTROL}, {UI_ALT, UI_KEY_ALT}};
    for (size_t i = 0; i < 3; ++i)
        if (modifiers & keys[i][0])
            push_key(on, keys[i][1], is_down);
}

/* Pushes UTF-8 text. Skips invalid bytes. */
static void push_text(ui *on, const char *text)
{
    const unsigned char *at = (const unsigned char *)text;
    while (*at) {
        const uint32_t more = *at < 0x80 ? 0 : *at < 0xe0 ? 1 : *at < 0xf0 ? 2 : 3;
        uint32_t point = more == 0 ? *at : *at & (0x3fu >> more);
        ++at;
        for (uint32_t i = 0; i < more && (*at & 0xc0) == 0x80; ++i)
            point = point << 6 | (*at++ & 0x3fu);
        push(on, (ui_event){.kind = UI_EVENT_TEXT, .code = point});
    }
}

static void click(ui *on, double x, double y, uint32_t button)
{
    push_move(on, (float)x, (float)y);
    push_button(on, button, true);
    push_button(on, button, false);
}

static mrt_result do_drag(script *self, const command *c, const script_stage *on)
{
    const double steps = c->number[4] < 1.0 ? 1.0 : c->number[4];
    const double share = (double)self->step / steps;
    push_move(on->ui, (float)(c->number[0] + share * (c->number[2] - c->number[0])),
              (float)(c->number[1] + share * (c->number[3] - c->number[1])));
    if (self->step == 0)
        push_button(on->ui, c->button, true);
    if ((double)self->step >= steps)
        push_button(on->ui, c->button, false);
    return (double)self->step++ >= steps ? MRT_END : MRT_OK;
}

/* It may take a while until it is written there. */
static mrt_result do_press(script *self, const command *c, const script_stage *on, error *err)
{
    const ui_word *words;
    const uint32_t count = ui_words(on->ui, &words);
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(words[i].text, c->text) == 0) {
            click(on->ui, (double)(words[i].where.x + 0.5f * words[i].where.width),
                  (double)(words[i].where.y + 0.5f * words[i].where.height), 0);
            return MRT_END;
        }
    if (self->step++ < PATIENCE_FRAMES)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%s:%u: \"%s\" is not shown in the window", self->path,
                     c->line, c->text);
}

static mrt_result do_time(script *self, const command *c, const script_stage *on)
{
    const bool is_random = c->kind == COMMAND_RANDOM;
    const int64_t now_ns = clock_now_ns();
    if (self->step++ == 0) {
        self->until_ns = now_ns + (int64_t)(1e9 * c->number[is_random ? 1 : 0]);
        if (is_random)
            script_random_begin(&self->random, (uint64_t)c->number[0]);
    }
    if (now_ns >= self->until_ns) {
        if (is_random)
            script_random_end(&self->random, on->ui);
        return MRT_END;
    }
    if (is_random)
        script_random_step(&self->random, on->ui, on->screen.width, on->screen.height);
    return MRT_OK;
}

/* A recording ends first: some frames later the rest is allowed. */
static mrt_result do_calm(script *self, const script_stage *on)
{
    enum { SETTLED_STEP = 10 };
    const app_looks *looks = app_looks_of(on->app);
    const live_status *status = app_status(on->app);
    const uint32_t step = self->step++;
    if (step == 0 && status->is_recording)
        app_do(on->app, ACTION_RECORD);
    if (step < SETTLED_STEP)
        return MRT_OK;
    if (status->is_sound_armed)
        app_do(on->app, ACTION_SOUND_ARM);
    if (looks->has_output)
        app_do(on->app, ACTION_OUTPUT);
    while (looks->heat != APP_HEAT_NONE)
        app_do(on->app, ACTION_HEAT_NEXT);
    app_do(on->app, ACTION_PANEL_DEVICES);
    app_do(on->app, ACTION_LIVE);
    return MRT_END;
}

/* For tests: to where errors go, so that the facts of --json stay alone. */
static void tell_memory(const command *c, const script_stage *on)
{
    fprintf(stderr,
            "memory %s: %.1f MB, of it to scrub from %.1f MB and to undo %.1f MB; asked for and "
            "not freed %.1f MB\n",
            c->text, (double)memory_resident() / 1e6, (double)app_status(on->app)->kept_bytes / 1e6,
            (double)app_undo_bytes(on->app) / 1e6, (double)memory_in_use() / 1e6);
}

/* MRT_END: this command is done. */
static mrt_result do_one(script *self, const command *c, const script_stage *on, error *err)
{
    mrt_result result;
    switch (c->kind) {
    case COMMAND_MOVE:
        push_move(on->ui, (float)c->number[0], (float)c->number[1]);
        return MRT_END;
    case COMMAND_DOWN:
    case COMMAND_UP:
        push_button(on->ui, c->button, c->kind == COMMAND_DOWN);
        return MRT_END;
    case COMMAND_CLICK:
        click(on->ui, c->number[0], c->number[1], c->button);
        return MRT_END;
    case COMMAND_DRAG:
        return do_drag(self, c, on);
    case COMMAND_WHEEL:
        push(on->ui, (ui_event){.kind = UI_EVENT_WHEEL, .y = (float)c->number[0]});
        return MRT_END;
    case COMMAND_KEY:
        push_modifiers(on->ui, c->modifiers, true);
        press_and_release(on->ui, c->key);
        push_modifiers(on->ui, c->modifiers, false);
        return MRT_END;
    case COMMAND_HOLD:
    case COMMAND_RELEASE:
        push_key(on->ui, c->key, c->kind == COMMAND_HOLD);
        return MRT_END;
    case COMMAND_TYPE:
        push_text(on->ui, c->text);
        return MRT_END;
    case COMMAND_DO:
        app_do(on->app, c->act);
        return MRT_END;
    case COMMAND_PRESS:
        return do_press(self, c, on, err);
    case COMMAND_WAIT:
    case COMMAND_RANDOM:
        return do_time(self, c, on);
    case COMMAND_FRAMES:
        return (double)self->step++ >= c->number[0] ? MRT_END : MRT_OK;
    case COMMAND_PICTURE:
        result = window_picture(on->window, c->text, err);
        return result < 0 ? result : MRT_END;
    case COMMAND_CALM:
        return do_calm(self, on);
    case COMMAND_MEMORY:
        tell_memory(c, on);
        return MRT_END;
    case COMMAND_KINDS:
        break;
    }
    return MRT_END;
}

mrt_result script_step(script *self, const script_stage *on, error *err)
{
    if (self->at == self->count)
        return MRT_END;
    const command *c = &self->command[self->at];
    if (!ui_is_idle(on->ui) && c->kind != COMMAND_RANDOM)
        return MRT_OK;
    if (!ui_is_idle(on->ui) && clock_now_ns() < self->until_ns)
        return MRT_OK;
    mrt_result result = do_one(self, c, on, err);
    if (result != MRT_END)
        return result;
    self->at += 1;
    self->step = 0;
    return MRT_OK;
}
