#include "window/app/arrangement.h"
#include "window/app/action.h"
#include "window/gui/theme.h"

#include "base/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define TIMELINE_LEAST 120.0f
#define TIMELINE_MOST  2000.0f
#define DOCK_LEAST     300.0f
#define DOCK_MOST      560.0f
#define FACE_LEAST     160.0f
#define FACE_BETWEEN   360.0f /* at least, between two docks */
#define DOCK_HIGH      300.0f /* at least, above a timeline */
#define STRIP_LEAST    900.0f /* what the timeline's transport needs */
#define FLOAT_WIDTH    DOCK_LEAST
#define FLOAT_HEIGHT   200.0f
#define FAR            20000.0 /* no screen is larger */

static const char *const place_name[PLACES] = {
    [PLACE_HIDDEN] = "hidden",
    [PLACE_LEFT] = "left",
    [PLACE_RIGHT] = "right",
    [PLACE_FLOATING] = "float",
};

/* "devices" of "panel_devices" */
static const char *name_of(app_panel of)
{
    return action_of((action)(ACTION_PANEL_DEVICES + (int)of))->name + strlen("panel_");
}

static bool is_dock(panel_place at)
{
    return at == PLACE_LEFT || at == PLACE_RIGHT;
}

/* ---- the layouts as they are at first ---- */

void arrangement_init(arrangement *self, app_layout of)
{
    static const app_panel left_of_rig[] = {APP_MAPPING, APP_HAND, APP_POSES};
    static const app_panel first[LAYOUTS] = {
        [LAYOUT_PERFORM] = APP_DEVICES, [LAYOUT_EDIT] = APP_MAPPING, [LAYOUT_RIG] = APP_RIG};
    *self = (arrangement){.current = first[of],
                          .front = {[PLACE_LEFT] = APP_MAPPING, [PLACE_RIGHT] = first[of]},
                          .timeline_height = of == LAYOUT_EDIT ? 300.0f : 220.0f,
                          .has_timeline = of != LAYOUT_RIG};
    self->width[PLACE_LEFT] = self->width[PLACE_RIGHT] = THEME_DOCK_WIDTH;
    for (uint32_t i = 0; i < APP_PANELS; ++i)
        self->panel[i] = (panel_spot){.place = PLACE_RIGHT, .order = i};
    for (size_t i = 0; of == LAYOUT_RIG && i < sizeof left_of_rig / sizeof left_of_rig[0]; ++i)
        self->panel[left_of_rig[i]].place = PLACE_LEFT;
}

/* ---- changes ---- */

uint32_t arrangement_panels(const arrangement *self, panel_place at, app_panel out[APP_PANELS])
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < APP_PANELS; ++i) {
        uint32_t to = count;
        if (self->panel[i].place != at)
            continue;
        for (; to > 0 && self->panel[out[to - 1]].order > self->panel[i].order; --to)
            out[to] = out[to - 1];
        out[to] = (app_panel)i;
        count += 1;
    }
    return count;
}

/* before: a panel of that place; APP_PANELS, or any other: last. */
static void put(arrangement *self, app_panel of, panel_place to, app_panel before)
{
    app_panel there[APP_PANELS];
    const uint32_t count = arrangement_panels(self, to, there);
    uint32_t order = 0;
    self->panel[of].order = count; /* last */
    for (uint32_t i = 0; i < count; ++i) {
        if (there[i] == before)
            self->panel[of].order = order++;
        if (there[i] != of)
            self->panel[there[i]].order = order++;
    }
    self->panel[of].place = to;
}

/* A dock that lost the panel of its open tab opens its first. */
static void choose_fronts(arrangement *self)
{
    app_panel there[APP_PANELS];
    for (panel_place at = PLACE_LEFT; at <= PLACE_RIGHT; ++at)
        if (self->panel[self->front[at]].place != at && arrangement_panels(self, at, there) > 0)
            self->front[at] = there[0];
}

void arrangement_show(arrangement *self, app_panel of)
{
    const panel_place at = self->panel[of].place;
    if (at == PLACE_HIDDEN || at == PLACE_FLOATING)
        put(self, of, at == PLACE_HIDDEN ? PLACE_RIGHT : PLACE_FLOATING, APP_PANELS);
    self->front[self->panel[of].place] = of;
    self->current = of;
}

void arrangement_move(arrangement *self, app_panel of, panel_place to, app_panel before)
{
    if (of == before)
        return;
    put(self, of, to, before);
    if (to != PLACE_HIDDEN)
        arrangement_show(self, of);
    choose_fronts(self);
}

/* ---- text ---- */

void arrangement_write(const arrangement *self, char out[ARRANGEMENT_TEXT])
{
    app_panel there[APP_PANELS];
    size_t length = (size_t)snprintf(out, ARRANGEMENT_TEXT, "%s %.0f current %s",
                                     self->has_timeline ? "timeline" : "no_timeline",
                                     (double)self->timeline_height, name_of(self->current));
    for (panel_place at = PLACE_HIDDEN; at < PLACES && length < ARRANGEMENT_TEXT; ++at) {
        const uint32_t count = arrangement_panels(self, at, there);
        if (at != PLACE_FLOATING)
            length +=
                (size_t)snprintf(out + length, ARRANGEMENT_TEXT - length, " %s", place_name[at]);
        if (is_dock(at) && length < ARRANGEMENT_TEXT)
            length += (size_t)snprintf(out + length, ARRANGEMENT_TEXT - length, " %.0f",
                                       (double)self->width[at]);
        for (uint32_t i = 0; i < count && length < ARRANGEMENT_TEXT; ++i) {
            const ui_rectangle box = self->panel[there[i]].floated;
            if (at == PLACE_FLOATING)
                length +=
                    (size_t)snprintf(out + length, ARRANGEMENT_TEXT - length,
                                     " float %.0f %.0f %.0f %.0f %s", (double)box.x, (double)box.y,
                                     (double)box.width, (double)box.height, name_of(there[i]));
            else
                length += (size_t)snprintf(out + length, ARRANGEMENT_TEXT - length, " %s%s",
                                           name_of(there[i]),
                                           is_dock(at) && self->front[at] == there[i] ? "*" : "");
        }
    }
}

typedef struct reader {
    arrangement *into;
    panel_place place; /* of the panels that follow */
    float *number[4];  /* that the next numbers go to */
    double most;
    uint32_t numbers, numbers_read;
    ui_rectangle floated;
    bool has_floated, is_current;
    bool is_read[APP_PANELS];
    uint32_t count;
} reader;

static void expect_number(reader *self, float *one, double most)
{
    self->number[0] = one;
    self->numbers = 1;
    self->numbers_read = 0;
    self->most = most;
}

static void expect_rectangle(reader *self)
{
    self->floated = (ui_rectangle){0};
    self->number[0] = &self->floated.x;
    self->number[1] = &self->floated.y;
    self->number[2] = &self->floated.width;
    self->number[3] = &self->floated.height;
    self->numbers = 4;
    self->numbers_read = 0;
    self->most = FAR;
}

static bool read_place(reader *self, text_view word)
{
    for (panel_place at = PLACE_HIDDEN; at < PLACES; ++at) {
        if (!text_equals(word, place_name[at]))
            continue;
        self->place = at;
        self->numbers = 0;
        if (is_dock(at))
            expect_number(self, &self->into->width[at], (double)DOCK_MOST);
        else if (at == PLACE_FLOATING)
            expect_rectangle(self);
        return true;
    }
    const bool has_timeline = text_equals(word, "timeline");
    if (has_timeline || text_equals(word, "no_timeline")) {
        self->into->has_timeline = has_timeline;
        expect_number(self, &self->into->timeline_height, (double)TIMELINE_MOST);
        return true;
    }
    self->is_current |= text_equals(word, "current");
    return text_equals(word, "current");
}

static bool read_number(reader *self, text_view word)
{
    double value = 0.0;
    if (!text_double(word, &value))
        return false;
    if (self->numbers_read < self->numbers && value >= 0.0 && value <= self->most)
        *self->number[self->numbers_read] = (float)value;
    self->numbers_read += 1;
    return true;
}

static void read_panel(reader *self, text_view word)
{
    arrangement *into = self->into;
    const bool is_front = word.end > word.at && word.end[-1] == '*';
    word.end -= is_front;
    for (uint32_t i = 0; i < APP_PANELS; ++i) {
        if (!text_equals(word, name_of((app_panel)i)))
            continue;
        if (self->is_current)
            into->current = (app_panel)i;
        else if (!self->is_read[i]) {
            into->panel[i].place = self->place;
            into->panel[i].order = self->count++;
            if (self->place == PLACE_FLOATING)
                into->panel[i].floated = self->floated;
            if (is_front)
                into->front[self->place] = (app_panel)i;
            self->is_read[i] = true;
        }
    }
    self->is_current = false;
}

void arrangement_read(arrangement *self, app_layout of, const char *text)
{
    text_view rest = text_view_of(text, strlen(text)), word;
    reader r = {.into = self, .place = PLACE_RIGHT};
    arrangement_init(self, of);
    while (text_next_word(&rest, &word))
        if (!read_place(&r, word) && !read_number(&r, word))
            read_panel(&r, word);
    for (uint32_t i = 0; i < APP_PANELS; ++i) /* those that are new come last */
        if (!r.is_read[i])
            self->panel[i].order = r.count++;
    choose_fronts(self);
}

/* ---- on a screen ---- */

static float clamped(float value, float least, float most)
{
    if (most < least)
        most = least;
    return value < least ? least : value > most ? most : value;
}

float arrangement_dock_width(float width)
{
    return clamped(width, DOCK_LEAST, DOCK_MOST);
}

static void add_panels(const arrangement *self, panel_place from, arrangement_dock *to)
{
    to->count += arrangement_panels(self, from, to->panel + to->count);
}

static void lay_docks(const arrangement *self, float width, arrangement_rectangles *out)
{
    const float most = clamped(0.45f * width, 0.0f, DOCK_MOST);
    out->left.front = self->front[PLACE_LEFT];
    out->right.front = self->front[PLACE_RIGHT];
    add_panels(self, PLACE_RIGHT, &out->right);
    const uint32_t right_count = out->right.count;
    app_panel left[APP_PANELS];
    const uint32_t left_count = arrangement_panels(self, PLACE_LEFT, left);
    const float left_width = clamped(self->width[PLACE_LEFT], DOCK_LEAST, most);
    const float right_width = clamped(self->width[PLACE_RIGHT], DOCK_LEAST, most);
    const bool fits = right_count == 0 || left_width + right_width + FACE_BETWEEN <= width;
    if (left_count > 0 && fits) {
        add_panels(self, PLACE_LEFT, &out->left);
        out->left.where.width = left_width;
    } else if (left_count > 0) {
        add_panels(self, PLACE_LEFT, &out->right);
        if (self->panel[self->current].place == PLACE_LEFT)
            out->right.front = self->current;
    }
    if (right_count > 0)
        out->right.where.width = right_width;
}

/* Whole below the bar. */
static ui_rectangle on_screen(ui_rectangle box, float width, float height, float bar)
{
    ui_rectangle out = {.width = clamped(box.width, FLOAT_WIDTH, width),
                        .height = clamped(box.height, FLOAT_HEIGHT, height - bar)};
    out.x = clamped(box.x, 0.0f, width - out.width);
    out.y = clamped(box.y, bar, height - out.height);
    return out;
}

static void lay_floating(const arrangement *self, float width, float height,
                         arrangement_rectangles *out)
{
    app_panel there[APP_PANELS];
    out->floating_count = arrangement_panels(self, PLACE_FLOATING, there);
    for (uint32_t i = 0; i < out->floating_count; ++i) {
        const ui_rectangle *floated = &self->panel[there[i]].floated;
        /* the first time: over the face, each lower than the one before */
        const ui_rectangle first = {out->face.x + 24.0f * (float)(i + 1),
                                    out->face.y + 24.0f * (float)(i + 1), THEME_DOCK_WIDTH,
                                    0.6f * out->face.height};
        out->floating[i].panel = there[i];
        out->floating[i].where =
            on_screen(floated->width > 0.0f ? *floated : first, width, height, out->bar.height);
    }
}

void arrangement_lay_out(const arrangement *self, float width, float height,
                         arrangement_rectangles *out)
{
    *out = (arrangement_rectangles){.bar = {0.0f, 0.0f, width, THEME_BAR_HEIGHT}};
    const float bar = THEME_BAR_HEIGHT, below = height - bar;
    lay_docks(self, width, out);
    const float left = out->left.where.width, right = out->right.where.width;
    /* The docks are as high as the window; in a narrow one the timeline goes below them. */
    const bool is_narrow = width - left - right < STRIP_LEAST && left + right > 0.0f;
    const float rest = is_narrow ? DOCK_HIGH : FACE_LEAST;
    const float timeline =
        self->has_timeline ? clamped(self->timeline_height, TIMELINE_LEAST, below - rest) : 0.0f;
    const float dock_height = is_narrow ? below - timeline : below;
    out->left.where = (ui_rectangle){0.0f, bar, left, dock_height};
    out->right.where = (ui_rectangle){width - right, bar, right, dock_height};
    out->face = (ui_rectangle){left, bar, width - left - right, below - timeline};
    if (self->has_timeline)
        out->timeline = (ui_rectangle){is_narrow ? 0.0f : left, height - timeline,
                                       is_narrow ? width : width - left - right, timeline};
    lay_floating(self, width, height, out);
}
