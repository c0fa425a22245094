#include "window/help.h"
#include "window/gui/theme.h"
#include "window/panels/mapping.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define LINE_LEAST 20.0f
#define LINE_MOST  25.0f
#define KEY_WIDTH  104.0f
#define COLUMN     290.0f

/* ---- another key ---- */

/* What is pressed in this frame; key 0: nothing. */
static key_chord pressed(const ui *on)
{
    const uint32_t modifiers = ui_modifiers(on);
    for (uint32_t key = 1; key < UI_KEY_SHIFT; ++key)
        if (ui_pressed(on, key, modifiers))
            return key == '?' ? (key_chord){'/', UI_SHIFT} : (key_chord){key, modifiers};
    return (key_chord){0};
}

static void wait_for_key(help *self, action of)
{
    *self = (help){.waiting = of};
    if (of != ACTION_NONE)
        (void)snprintf(self->says, sizeof self->says,
                       "%.60s: press the new key. Backspace: no key. Esc: cancel.",
                       action_of(of)->title);
}

static void offer(help *self, key_map *keys, key_chord chord)
{
    char words[KEY_WORDS];
    const action of = self->waiting, holder = key_map_action(keys, chord);
    const char *refusal = key_map_refusal(chord);
    const bool is_again =
        chord.key == self->offered.key && chord.modifiers == self->offered.modifiers;
    key_chord_words(chord, words);
    if (refusal) {
        (void)snprintf(self->says, sizeof self->says, "%s: %s.", words, refusal);
    } else if (holder != ACTION_NONE && holder != of && !is_again) {
        self->offered = chord;
        (void)snprintf(self->says, sizeof self->says,
                       "%s is used by \"%.60s\". Again: reassign. Esc: cancel.", words,
                       action_of(holder)->title);
    } else {
        key_map_set(keys, of, chord);
        wait_for_key(self, ACTION_NONE);
        (void)snprintf(self->says, sizeof self->says, "%s: %.60s", words, action_of(of)->title);
    }
}

bool help_takes_keys(help *self, app *of, ui *on)
{
    app_looks *looks = app_looks_of(of);
    if (!looks->is_helping)
        *self = (help){0};
    if (self->waiting == ACTION_NONE)
        return false;
    const key_chord chord = pressed(on);
    if (chord.key == UI_KEY_ESCAPE) {
        wait_for_key(self, ACTION_NONE);
    } else if (chord.key == UI_KEY_BACKSPACE && chord.modifiers == 0) {
        key_map_set(&looks->keys, self->waiting, (key_chord){0});
        wait_for_key(self, ACTION_NONE);
    } else if (chord.key != UI_KEY_NONE) {
        offer(self, &looks->keys, chord);
    }
    return true;
}

/* ---- columns ---- */

typedef struct sheet { /* what is written, in columns */
    ui *on;            /* NULL: it is only measured */
    const ui_canvas *canvas;
    const app_looks *looks;
    float x, y, top, bottom;
    float column, row;
    uint32_t columns;        /* that were begun */
    action waiting, hovered; /* hovered: ACTION_NONE: none */
} sheet;

static void next_column(sheet *s)
{
    s->x += s->column;
    s->y = s->top;
    s->columns += 1;
}

/* A title stays with its first lines. */
static void put_title(sheet *s, const char *title)
{
    if (s->y > s->top) {
        s->y += 0.5f * s->row;
        if (s->y + 3.0f * s->row > s->bottom)
            next_column(s);
    }
    if (s->on)
        ui_draw_text(s->on, s->x, s->y, UI_STYLE_TITLE, THEME_ACCENT, s->column - 16.0f, title);
    s->y += s->row + 2.0f;
}

/* of: what a click changes the key of; ACTION_NONE: nothing. */
static void put_line(sheet *s, action of, const char *keys, const char *words)
{
    if (s->y + s->row > s->bottom)
        next_column(s);
    if (s->on) {
        const ui_rectangle box = {s->x - 6.0f, s->y - 2.0f, s->column - 8.0f, s->row - 1.0f};
        const float x = s->canvas->where.x + s->canvas->x, y = s->canvas->where.y + s->canvas->y;
        const bool is_over = of != ACTION_NONE && s->canvas->is_hovered && x >= box.x &&
                             x < box.x + box.width && y >= box.y && y < box.y + box.height;
        const bool waits = of != ACTION_NONE && s->waiting == of;
        if (is_over)
            s->hovered = of;
        if (is_over || waits)
            ui_draw_box(s->on, box, waits ? THEME_HOVER : THEME_RAISED, 4.0f);
        ui_draw_text(s->on, s->x, s->y, UI_STYLE_STRONG, waits ? THEME_ACCENT : THEME_TEXT,
                     KEY_WIDTH - 8.0f, waits ? "\u2026" : keys);
        ui_draw_text(s->on, s->x + KEY_WIDTH, s->y, UI_STYLE_BODY, THEME_DIM,
                     s->column - KEY_WIDTH - 16.0f, words);
    }
    s->y += s->row;
}

/* ---- what is in it ---- */

static bool is_rating(action of)
{
    return of >= ACTION_RATE_0 && of <= ACTION_RATE_5;
}

static bool has_own_ratings(const key_map *keys)
{
    bool is_own = false;
    for (uint32_t i = ACTION_RATE_0; i <= ACTION_RATE_5; ++i)
        is_own |= keys->of[i].is_own;
    return is_own;
}

static void put_actions(sheet *s, action_group group)
{
    const key_map *keys = &s->looks->keys;
    const bool as_one = !has_own_ratings(keys);
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        const action of = (action)i;
        const action_entry *entry = action_of(of);
        char words[KEY_WORDS];
        if (entry->group != group || (as_one && is_rating(of) && of != ACTION_RATE_0))
            continue;
        key_map_words(keys, of, words);
        if (as_one && is_rating(of))
            put_line(s, ACTION_NONE, "0 .. 5", "Stars of the selected take");
        else
            put_line(s, of, words[0] ? words : "\u2013", entry->title);
    }
}

static const char *const mouse_lines[][2] = {
    {"Drag", "Pull the face"},
    {"Drag, Shift", "Pull and hold"},
    {"Wheel", "Zoom"},
    {"Ctrl+drag", "Shape like clay"},
    {"Double click", "Reset the contact"},
    {"Right drag", "Rotate the view"},
    {"Middle drag", "Pan the view"},
    {"Alt+wheel", "Radius of the pull"},
};
static const char *const timeline_lines[][2] = {
    {"Wheel", "Zoom; with Shift: scroll"},         {"Drag a clip", "Move; drag an end to trim"},
    {"Ctrl+drag", "Drag an end: stretch"},         {"Swipe", "Take below: comp it"},
    {"Ctrl+drag", "Take below: shift it"},         {"Drag on top", "Above the time: range"},
    {"Double click", "Clip, layer, marker, take"}, {"Right click", "More commands"},
};
enum {
    MOUSE_LINES = sizeof mouse_lines / sizeof mouse_lines[0],
    TIMELINE_LINES = sizeof timeline_lines / sizeof timeline_lines[0]
};

static void put_pedals(sheet *s, app *of)
{
    const instance *mapping = live_mapping(app_live(of));
    const uint32_t rezero = (uint32_t)settings_number(app_settings(of), APP_REZERO_PEDAL, 0.0);
    put_title(s, "Pedals now");
    for (uint32_t pedal = 1; pedal <= MRT_MAX_PEDALS; ++pedal) {
        char name[16], words[200] = "";
        if (mapping) {
            const mrt_plugin_type *type = isolate_inner(mapping->type);
            double values[256];
            for (uint32_t i = 0; i < type->param_count && i < 256; ++i)
                values[i] = mapping->wanted[i];
            if (type->param_count <= 256)
                pedal_table_words(type, values, pedal, words, sizeof words);
        }
        const size_t length = strlen(words);
        if (rezero == pedal)
            (void)snprintf(words + length, sizeof words - length, "%sRe-zero", length ? ", " : "");
        (void)snprintf(name, sizeof name, "Pedal %u", pedal);
        put_line(s, ACTION_NONE, name, words[0] ? words : "nothing");
    }
}

static void put_all(sheet *s, app *of)
{
    for (uint32_t group = 0; group < ACTION_GROUPS; ++group) {
        put_title(s, action_group_name[group]);
        put_actions(s, (action_group)group);
    }
    put_title(s, "Mouse on the face");
    for (uint32_t i = 0; i < MOUSE_LINES; ++i)
        put_line(s, ACTION_NONE, mouse_lines[i][0], mouse_lines[i][1]);
    put_title(s, "Mouse on the timeline");
    for (uint32_t i = 0; i < TIMELINE_LINES; ++i)
        put_line(s, ACTION_NONE, timeline_lines[i][0], timeline_lines[i][1]);
    put_pedals(s, of);
}

/* Height at which this number of columns holds all lines. */
static float height_of(const app_looks *looks, app *of, uint32_t across, float row, float room)
{
    for (float height = room;; height += 2.0f * row) {
        sheet s = {.looks = looks, .bottom = height, .column = COLUMN, .row = row, .columns = 1};
        put_all(&s, of);
        if (s.columns <= across)
            return height;
    }
}

/* ---- what suits the person ---- */

static const char *const size_names[] = {"Text  80 %", "Text  90 %", "Text 100 %", "Text 110 %",
                                         "Text 125 %", "Text 150 %", "Text 175 %", "Text 200 %"};
static const float sizes[] = {0.8f, 0.9f, 1.0f, 1.1f, 1.25f, 1.5f, 1.75f, 2.0f};
enum { SIZES = sizeof sizes / sizeof sizes[0] };

static void draw_size(ui *on, app_looks *looks, float zoom)
{
    uint32_t size = 2;
    for (uint32_t i = 0; i < SIZES; ++i)
        if (fabsf(sizes[i] - looks->text_size) < 0.01f)
            size = i;
    ui_width(on, 116.0f);
    if (ui_choice(on, "##text_size", 0.0f, size_names, SIZES, &size))
        looks->text_size = sizes[size];
    ui_hint(on, zoom + 0.01f < looks->text_size
                    ? "Scale of the whole window. Enlarge the window to use a larger scale."
                    : "Scale of the whole window.");
}

static bool has_own_keys(const key_map *keys)
{
    for (uint32_t i = 1; i < ACTION_COUNT; ++i)
        if (keys->of[i].is_own)
            return true;
    return false;
}

static void draw_head(help *self, app_looks *looks, ui *on, ui_rectangle where, float zoom)
{
    ui_panel_begin(on, "help_head", where, UI_GROUND_NONE);
    draw_size(on, looks, zoom);
    ui_same_line(on);
    (void)ui_check(on, "Light", &looks->theme.is_light);
    ui_hint(on, "Use dark text on light panels, for a bright room.");
    ui_same_line(on);
    (void)ui_check(on, "Colour-safe", &looks->theme.is_colour_safe);
    ui_hint(on, "Use colours that can be distinguished without red, green or blue.");
    if (has_own_keys(&looks->keys)) {
        ui_same_line(on);
        if (ui_button(on, "Reset keys", UI_PLAIN)) {
            memset(&looks->keys, 0, sizeof looks->keys);
            wait_for_key(self, ACTION_NONE);
        }
        ui_hint(on, "Reset all keys to their defaults.");
    }
    if (zoom + 0.01f < looks->text_size) {
        char words[48];
        (void)snprintf(words, sizeof words, "Limited to %.0f %% here", 100.0 * (double)zoom);
        ui_same_line(on);
        ui_text(on, UI_STYLE_WARNING, words);
    }
    ui_panel_end(on);
}

/* ---- the page ---- */

static void draw_keys(help *self, app *of, ui *on, ui_rectangle where)
{
    const app_looks *looks = app_looks_of(of);
    ui_canvas canvas;
    const float across = fminf(fmaxf(floorf(where.width / COLUMN), 1.0f), 4.0f);
    float row = LINE_MOST, height = where.height;
    do {
        height = height_of(looks, of, (uint32_t)across, row, where.height);
        row -= 1.0f;
    } while (height > where.height && row >= LINE_LEAST);
    ui_panel_begin(on, "help_keys", where, UI_GROUND_NONE);
    ui_scroll_begin(on, "keys", 0.0f, 0.0f);
    ui_canvas_begin(on, "help", where.width - 12.0f, height, &canvas);
    sheet s = {.on = on,
               .canvas = &canvas,
               .looks = looks,
               .x = canvas.where.x + 6.0f,
               .y = canvas.where.y,
               .top = canvas.where.y,
               .bottom = canvas.where.y + height,
               .column = (where.width - 12.0f) / across,
               .row = row + 1.0f,
               .waiting = self->waiting};
    put_all(&s, of);
    ui_canvas_end(on);
    ui_scroll_end(on);
    ui_panel_end(on);
    if (s.hovered != ACTION_NONE)
        ui_set_cursor(on, UI_CURSOR_HAND);
    if (canvas.is_pressed && s.hovered != ACTION_NONE)
        wait_for_key(self, s.hovered);
    else if (canvas.is_pressed && self->waiting != ACTION_NONE)
        wait_for_key(self, ACTION_NONE);
    else if (canvas.is_pressed)
        app_looks_of(of)->is_helping = false;
}

void help_draw(help *self, app *of, ui *on, ui_rectangle where, float zoom)
{
    const float margin = where.width > 1400.0f ? 80.0f : where.width > 1000.0f ? 32.0f : 16.0f;
    const ui_rectangle inner = {where.x + margin, where.y + margin, where.width - 2.0f * margin,
                                where.height - 2.0f * margin};
    const float head = 84.0f;
    char end[96], keys[KEY_WORDS];
    key_map_words(&app_looks_of(of)->keys, ACTION_HELP, keys);
    if (self->says[0])
        (void)snprintf(end, sizeof end, "%s", "");
    else
        (void)snprintf(end, sizeof end, "Click a line to change its key. %s%sEsc closes this.",
                       keys, keys[0] ? " or " : "");
    const char *says = self->says[0] ? self->says : end;
    const float left = inner.x + 96.0f, room = inner.width - 96.0f;
    const float width = fminf(ui_text_width(on, UI_STYLE_BODY, says), room);
    ui_focus_covers(on);
    ui_panel_begin(on, "help", where, UI_GROUND_NONE);
    ui_draw_box(on, where, THEME_STAGE, 0.0f);
    ui_draw_text(on, inner.x, inner.y, UI_STYLE_LARGE, THEME_TEXT, 0.0f, "Keys");
    ui_draw_text(on, fmaxf(inner.x + inner.width - width, left), inner.y + 12.0f, UI_STYLE_BODY,
                 self->says[0] ? THEME_ACCENT : THEME_DIM, room, says);
    ui_panel_end(on);
    draw_head(self, app_looks_of(of), on,
              (ui_rectangle){inner.x, inner.y + 44.0f, inner.width, 34.0f}, zoom);
    draw_keys(self, of, on,
              (ui_rectangle){inner.x, inner.y + head, inner.width, inner.height - head});
}
