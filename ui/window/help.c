/* `?`: every action with its key, and what the pedals do now, over the stage. */
#include "window/desk_state.h"
#include "window/mapping_panel_pedal_table.h"

#include <stdio.h>
#include <string.h>

#define LINE       22.0f
#define KEY_WIDTH  104.0f
#define COLUMN     290.0f
#define REZERO_KEY "hands.rezero_pedal"

typedef struct sheet { /* what is written, in columns */
    ui *on;
    float x, y, top, bottom;
    float column, row;
} sheet;

static void next_column(sheet *s)
{
    s->x += s->column;
    s->y = s->top;
}

/* A title stays with its first lines. */
static void put_title(sheet *s, const char *title)
{
    if (s->y > s->top) {
        s->y += 0.5f * s->row;
        if (s->y + 3.0f * s->row > s->bottom)
            next_column(s);
    }
    ui_draw_text(s->on, s->x, s->y, UI_STYLE_TITLE, THEME_ACCENT, s->column - 16.0f, title);
    s->y += s->row + 2.0f;
}

static void put_line(sheet *s, const char *keys, const char *words)
{
    if (s->y + s->row > s->bottom)
        next_column(s);
    ui_draw_text(s->on, s->x, s->y, UI_STYLE_STRONG, THEME_TEXT, KEY_WIDTH - 8.0f, keys);
    ui_draw_text(s->on, s->x + KEY_WIDTH, s->y, UI_STYLE_BODY, THEME_DIM,
                 s->column - KEY_WIDTH - 16.0f, words);
    s->y += s->row;
}

/* ---- what is in it ---- */

static bool is_rating(action of)
{
    return of >= ACTION_RATE_0 && of <= ACTION_RATE_5;
}

static uint32_t put_actions(sheet *s, action_group group)
{
    uint32_t lines = 0;
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        const action_entry *entry = action_of((action)i);
        char keys[ACTION_KEYS];
        if (entry->group != group || (is_rating(entry->id) && entry->id != ACTION_RATE_0))
            continue;
        action_keys(entry->id, keys);
        lines += 1;
        if (s && is_rating(entry->id))
            put_line(s, "0 .. 5", "Stars of the chosen take");
        else if (s)
            put_line(s, keys, entry->title);
    }
    return lines;
}

static const char *const mouse_lines[][2] = {
    {"Drag", "Pulls the face"},
    {"Drag, Shift", "Pulls it, and it stays so"},
    {"Wheel", "Nearer, farther"},
    {"Ctrl+drag", "Kneads, as clay"},
    {"Double click", "Contact back to rest"},
    {"Right drag", "Turns the view"},
    {"Middle drag", "Moves the view"},
    {"Alt+wheel", "How far a pull reaches"},
};
static const char *const timeline_lines[][2] = {
    {"Wheel", "Closer, wider; Shift: along"},      {"Drag a clip", "Moves it; its ends trim it"},
    {"Alt+drag", "An end: stretches the clip"},    {"Swipe", "A take below: into this one"},
    {"Alt+drag", "A take below: shifts it"},       {"Drag on top", "A range, above the time"},
    {"Double click", "Clip, layer, marker, take"}, {"Right click", "What else can be done"},
};
enum {
    MOUSE_LINES = sizeof mouse_lines / sizeof mouse_lines[0],
    TIMELINE_LINES = sizeof timeline_lines / sizeof timeline_lines[0]
};

static void put_pedals(sheet *s, studio *of)
{
    const instance *mapping = live_mapping(studio_live(of));
    const uint32_t rezero = (uint32_t)settings_number(studio_settings(of), REZERO_KEY, 0.0);
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
        put_line(s, name, words[0] ? words : "nothing");
    }
}

static void put_all(sheet *s, studio *of)
{
    for (uint32_t group = 0; group < ACTION_GROUPS; ++group) {
        put_title(s, action_group_name[group]);
        (void)put_actions(s, (action_group)group);
    }
    const uint32_t others = MOUSE_LINES + TIMELINE_LINES + MRT_MAX_PEDALS + 6;
    if (s->y + 3.0f + (float)others * s->row > s->bottom && s->y > s->top)
        next_column(s);
    put_title(s, "Mouse on the face");
    for (uint32_t i = 0; i < MOUSE_LINES; ++i)
        put_line(s, mouse_lines[i][0], mouse_lines[i][1]);
    put_title(s, "Mouse on the timeline");
    for (uint32_t i = 0; i < TIMELINE_LINES; ++i)
        put_line(s, timeline_lines[i][0], timeline_lines[i][1]);
    put_pedals(s, of);
}

/* So many lines in all, titles and gaps counted generously. */
static float lines_in_all(void)
{
    float lines =
        (float)(MOUSE_LINES + TIMELINE_LINES + MRT_MAX_PEDALS) + 3.5f * (ACTION_GROUPS + 4);
    for (uint32_t group = 0; group < ACTION_GROUPS; ++group)
        lines += (float)put_actions(NULL, (action_group)group);
    return lines;
}

void help_draw(desk *self, ui_rectangle where)
{
    ui *on = self->ui;
    ui_canvas canvas;
    const float margin = where.width > 1400.0f ? 80.0f : 32.0f, head = 50.0f;
    const ui_rectangle inner = {where.x + margin, where.y + margin, where.width - 2.0f * margin,
                                where.height - 2.0f * margin};
    const float across = inner.width >= 4.0f * COLUMN   ? 4.0f
                         : inner.width >= 3.0f * COLUMN ? 3.0f
                                                        : 2.0f;
    const float room = inner.height - head;
    float row = room * across / lines_in_all();
    row = row > 25.0f ? 25.0f : row < 18.0f ? 18.0f : row;
    sheet s = {.on = on,
               .x = inner.x,
               .y = inner.y + head,
               .top = inner.y + head,
               .bottom = inner.y + inner.height,
               .column = inner.width / across,
               .row = row};
    ui_panel_begin(on, "help", where, UI_GROUND_NONE);
    ui_canvas_begin(on, "help", 0.0f, 0.0f, &canvas);
    ui_draw_box(on, where, THEME_STAGE, 0.0f);
    ui_draw_text(on, inner.x, inner.y, UI_STYLE_LARGE, THEME_TEXT, 0.0f, "Keys");
    const char *end = "?  or  Esc  closes this";
    ui_draw_text(on, inner.x + inner.width - ui_text_width(on, UI_STYLE_BODY, end), inner.y + 12.0f,
                 UI_STYLE_BODY, THEME_DIM, 0.0f, end);
    put_all(&s, self->studio);
    ui_canvas_end(on);
    ui_panel_end(on);
    if (canvas.is_pressed)
        studio_looks_of(self->studio)->is_helping = false;
}
