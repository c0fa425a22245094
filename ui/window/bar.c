/* The bar at the top: what is open, what is being recorded and where one is, how fast it goes. */
#include "window/desk_state.h"

#include "base/clock.h"

#include <stdio.h>
#include <string.h>

#define ICON 34.0f
#define GAP  14.0f

static const int64_t KEEP_NS = 30 * NS_PER_S;

typedef struct pen { /* along the bar */
    desk *desk;
    ui *on;
    ui_canvas canvas;
    ui_rectangle where;
    char hint[512];
} pen;

/* ---- pressing ---- */

static bool is_over(const pen *p, ui_rectangle box)
{
    const float x = p->canvas.where.x + p->canvas.x, y = p->canvas.where.y + p->canvas.y;
    return p->canvas.is_hovered && x >= box.x && x < box.x + box.width && y >= box.y &&
           y < box.y + box.height;
}

static bool is_pressed(const pen *p, ui_rectangle box)
{
    return p->canvas.is_pressed && p->canvas.button == 0 && is_over(p, box);
}

static void hint_action(pen *p, action of)
{
    char keys[ACTION_KEYS];
    const char *why = "";
    const bool can = studio_can(p->desk->studio, of, &why);
    action_keys(of, keys);
    (void)snprintf(p->hint, sizeof p->hint, "%s  (%s)\n%s%s%s", action_of(of)->title, keys,
                   action_of(of)->help, can ? "" : "\nNot now: ", can ? "" : why);
}

typedef void paint_sign(ui *on, float x, float y, uint32_t ink);

static void put_sign(pen *p, ui_rectangle box, action of, paint_sign *sign, bool is_on)
{
    const bool can = studio_can(p->desk->studio, of, NULL);
    const bool is_hovered = is_over(p, box);
    if (is_hovered || is_on)
        ui_draw_box(p->on, box, is_hovered && can ? THEME_HOVER : THEME_RAISED, 5.0f);
    sign(p->on, box.x + 0.5f * box.width, box.y + 0.5f * box.height,
         !can    ? 0x5a5f66ffu
         : is_on ? THEME_ACCENT
                 : THEME_TEXT);
    if (is_hovered)
        hint_action(p, of);
    if (is_pressed(p, box))
        studio_do(p->desk->studio, of);
}

/* A word that is pressed, its right end at `right`; returns its left end. */
static float put_word(pen *p, float right, action of, const char *word, bool is_on)
{
    const float width = ui_text_width(p->on, UI_STYLE_BODY, word) + 20.0f;
    const float height = ui_text_height(p->on, UI_STYLE_BODY);
    const ui_rectangle box = {right - width, p->where.y + 0.5f * (p->where.height - 30.0f), width,
                              30.0f};
    if (is_on || is_over(p, box))
        ui_draw_box(p->on, box, is_over(p, box) ? THEME_HOVER : THEME_RAISED, 5.0f);
    ui_draw_text(p->on, box.x + 10.0f, box.y + 0.5f * (box.height - height), UI_STYLE_BODY,
                 is_on ? THEME_ACCENT : THEME_TEXT, 0.0f, word);
    if (is_over(p, box))
        hint_action(p, of);
    if (is_pressed(p, box))
        studio_do(p->desk->studio, of);
    return box.x;
}

/* ---- left: what is open ---- */

/* "night" of "/home/a/night.marotte"; "puppet" of "puppet.rig.json". */
static void name_of(const char *path, char *out, size_t capacity)
{
    const char *slash = strrchr(path, '/');
    (void)snprintf(out, capacity, "%s", slash ? slash + 1 : path);
    static const char *const endings[] = {".marotte", ".rig.json"};
    for (size_t i = 0; i < 2; ++i) {
        const size_t length = strlen(out), ending = strlen(endings[i]);
        if (length > ending && strcmp(out + length - ending, endings[i]) == 0)
            out[length - ending] = '\0';
    }
}

static void put_name(pen *p, float y, float width, ui_style style, uint32_t ink, const char *name,
                     const char *path, desk_open_kind kind)
{
    const ui_rectangle box = {p->where.x + 6.0f, y - 2.0f, width, 21.0f};
    if (is_over(p, box)) {
        ui_draw_box(p->on, box, THEME_RAISED, 4.0f);
        ui_set_cursor(p->on, UI_CURSOR_HAND);
        (void)snprintf(p->hint, sizeof p->hint, "%.440s\nOpen another %s  (Ctrl+O)", path,
                       kind == DESK_OPENS_SHOW ? "show" : "face");
    }
    ui_draw_text(p->on, box.x + 6.0f, y, style, ink, width - 12.0f, name);
    if (is_pressed(p, box))
        desk_open_ask(p->desk, kind);
}

static void put_names(pen *p, float width)
{
    studio *of = p->desk->studio;
    char name[256], words[320];
    const float line = 21.0f, top = p->where.y + 0.5f * (p->where.height - 2.0f * line) + 2.0f;
    show *s = studio_show(of);
    if (s)
        name_of(show_path(s), name, sizeof name);
    (void)snprintf(words, sizeof words, "%s%s", s ? name : "No show: nothing is recorded",
                   s && !show_is_writable(s) ? " (read only)" : "");
    put_name(p, top, width, UI_STYLE_STRONG, s && show_is_writable(s) ? THEME_TEXT : THEME_WARNING,
             words, s ? show_path(s) : "No show is open.", DESK_OPENS_SHOW);
    name_of(studio_face_path(of), name, sizeof name);
    (void)snprintf(words, sizeof words, "%s%s", name, studio_unsaved_now(of) ? " \u2022" : "");
    put_name(p, top + line, width, UI_STYLE_BODY, THEME_DIM, words, studio_face_path(of),
             DESK_OPENS_FACE);
}

/* ---- middle: recording and where one is ---- */

static void sign_record(ui *on, float x, float y, uint32_t ink)
{
    ui_draw_ring(on, x, y, 11.0f, ink == THEME_ACCENT ? THEME_RECORD : THEME_DIM, 1.5f);
    ui_draw_disc(on, x, y, 7.5f, ink == THEME_TEXT || ink == THEME_ACCENT ? THEME_RECORD : ink);
}

static void sign_recording(ui *on, float x, float y, uint32_t ink)
{
    (void)ink;
    ui_draw_ring(on, x, y, 11.0f, THEME_RECORD, 1.5f);
    ui_draw_box(on, (ui_rectangle){x - 5.0f, y - 5.0f, 10.0f, 10.0f}, THEME_RECORD, 1.5f);
}

static void sign_play(ui *on, float x, float y, uint32_t ink)
{
    const float corner[6] = {x - 5.0f, y - 8.0f, x + 9.0f, y, x - 5.0f, y + 8.0f};
    ui_draw_triangle(on, corner, ink);
}

static void sign_pause(ui *on, float x, float y, uint32_t ink)
{
    ui_draw_box(on, (ui_rectangle){x - 7.0f, y - 8.0f, 5.0f, 16.0f}, ink, 0.0f);
    ui_draw_box(on, (ui_rectangle){x + 2.0f, y - 8.0f, 5.0f, 16.0f}, ink, 0.0f);
}

static void sign_stop(ui *on, float x, float y, uint32_t ink)
{
    ui_draw_box(on, (ui_rectangle){x - 7.0f, y - 7.0f, 14.0f, 14.0f}, ink, 1.5f);
}

static void sign_start(ui *on, float x, float y, uint32_t ink)
{
    const float corner[6] = {x + 7.0f, y - 7.0f, x - 4.0f, y, x + 7.0f, y + 7.0f};
    ui_draw_triangle(on, corner, ink);
    ui_draw_box(on, (ui_rectangle){x - 7.0f, y - 7.0f, 2.5f, 14.0f}, ink, 0.0f);
}

static void sign_loop(ui *on, float x, float y, uint32_t ink)
{
    const float head[6] = {x + 1.0f, y - 10.0f, x + 7.0f, y - 6.0f, x + 1.0f, y - 2.0f};
    ui_draw_frame(on, (ui_rectangle){x - 9.0f, y - 6.0f, 18.0f, 12.0f}, ink, 6.0f, 1.8f);
    ui_draw_triangle(on, head, ink);
}

/* "0:04.2", "1:02:03.4" */
static void write_time(char *out, size_t capacity, int64_t at_ns)
{
    const int64_t tenths = (at_ns < 0 ? 0 : at_ns) / 100000000;
    const long long s = (long long)(tenths / 10), tenth = (long long)(tenths % 10);
    if (s >= 3600)
        (void)snprintf(out, capacity, "%lld:%02lld:%02lld.%lld", s / 3600, s / 60 % 60, s % 60,
                       tenth);
    else
        (void)snprintf(out, capacity, "%lld:%02lld.%lld", s / 60, s % 60, tenth);
}

typedef struct state_words {
    char large[64], small[200];
    uint32_t ink;
} state_words;

static const char *title_of(studio *of, int64_t id)
{
    const studio_take_line *line;
    const uint32_t count = studio_takes(of, &line);
    for (uint32_t i = 0; i < count; ++i)
        if (line[i].id == id)
            return line[i].title;
    return "";
}

static state_words state_of(studio *of)
{
    const live_status *status = studio_status(of);
    const live_view *view = studio_view(of);
    const char *shown = title_of(of, live_shown_take(studio_live(of)));
    state_words out = {.large = "Live", .ink = THEME_TEXT};
    if (view->mode == LIVE_OVERDUBS) {
        write_time(out.large, sizeof out.large, view->at_ns);
        (void)snprintf(out.small, sizeof out.small, "%s take %.150s",
                       view->is_recording_over ? "Recording over" : "Going to record over", shown);
        out.ink = view->is_recording_over ? THEME_RECORD : THEME_TEXT;
    } else if (status->is_recording) {
        write_time(out.large, sizeof out.large, status->recorded_ns);
        (void)snprintf(out.small, sizeof out.small, "Recording take %.150s",
                       title_of(of, status->take));
        out.ink = THEME_RECORD;
    } else if (view->mode == LIVE_SHOWS && studio_looks_of(of)->has_timeline) {
        (void)snprintf(out.large, sizeof out.large, "Take %.50s", shown); /* time is below */
        (void)snprintf(out.small, sizeof out.small, "L: back to the live hands");
    } else if (view->mode == LIVE_SHOWS) {
        write_time(out.large, sizeof out.large, live_place(studio_live(of)).at_ns);
        (void)snprintf(out.small, sizeof out.small, "Take %.150s", shown);
    } else if (!status->can_record) {
        (void)snprintf(out.small, sizeof out.small, "Nothing is recorded");
    } else {
        const int back_s = status->journal_ns < KEEP_NS ? (int)(status->journal_ns / NS_PER_S)
                                                        : (int)(KEEP_NS / NS_PER_S);
        (void)snprintf(out.small, sizeof out.small, "K keeps the last %d s", back_s);
    }
    if (status->problem[0]) {
        (void)snprintf(out.small, sizeof out.small, "%.199s", status->problem);
        out.ink = status->is_recording ? THEME_RECORD : THEME_WARNING;
    }
    return out;
}

static float put_state(pen *p, float x)
{
    const state_words words = state_of(p->desk->studio);
    const float large = ui_text_height(p->on, UI_STYLE_LARGE), width = 132.0f;
    const float own = ui_text_width(p->on, UI_STYLE_LARGE, words.large);
    const float most = 0.24f * p->where.width;
    const float wide = own > most ? most : own > width ? own : width;
    const bool is_warning = words.ink == THEME_WARNING;
    ui_draw_text(p->on, x, p->where.y + 0.5f * (p->where.height - large), UI_STYLE_LARGE,
                 is_warning ? THEME_TEXT : words.ink, wide + 1.0f, words.large);
    x += wide + GAP;
    const float height = ui_text_height(p->on, UI_STYLE_BODY), room = 190.0f;
    const ui_rectangle box = {x, p->where.y, room, p->where.height};
    ui_draw_text(p->on, x, p->where.y + 0.5f * (p->where.height - height), UI_STYLE_BODY,
                 is_warning ? THEME_WARNING : THEME_DIM, room, words.small);
    if (is_over(p, box))
        (void)snprintf(p->hint, sizeof p->hint, "%s", words.small);
    return x + room;
}

static void put_middle(pen *p, float x)
{
    studio *of = p->desk->studio;
    live *stage = studio_live(of);
    const bool is_recording = studio_status(of)->is_recording;
    const transport *move = live_transport(stage);
    const bool is_playing = studio_view(of)->mode != LIVE_PERFORMS && move->is_playing &&
                            !live_place(stage).has_stopped;
    const float y = p->where.y + 0.5f * (p->where.height - ICON);
    put_sign(p, (ui_rectangle){x, y, ICON, ICON}, ACTION_RECORD,
             is_recording ? sign_recording : sign_record, is_recording);
    x = put_state(p, x + ICON + GAP);
    if (studio_looks_of(of)->has_timeline || p->where.width < 1100.0f)
        return;
    const struct {
        action of;
        paint_sign *sign;
        bool is_on;
    } signs[] = {{ACTION_TO_START, sign_start, false},
                 {ACTION_PLAY, is_playing ? sign_pause : sign_play, is_playing},
                 {ACTION_STOP, sign_stop, false},
                 {ACTION_LOOP, sign_loop, move->is_looping}};
    x += GAP;
    for (size_t i = 0; i < sizeof signs / sizeof signs[0]; ++i) {
        put_sign(p, (ui_rectangle){x, y, ICON, ICON}, signs[i].of, signs[i].sign, signs[i].is_on);
        x += ICON + 2.0f;
    }
}

/* ---- right: how fast, the output, help ---- */

/* How far the oldest export is; a click tells of all. Returns its left end. */
static float put_exports(pen *p, float right)
{
    studio *of = p->desk->studio;
    const uint32_t count = studio_exports_going(of);
    char words[64], part[32] = "";
    if (count == 0)
        return right;
    const export_going first = studio_export_now(of, 0);
    if (first.done >= 0.0)
        (void)snprintf(part, sizeof part, " %.0f %%", 100.0 * first.done);
    if (count > 1)
        (void)snprintf(words, sizeof words, "Exporting %u%s", count, part);
    else
        (void)snprintf(words, sizeof words, "Exporting%s", part);
    const float widest = ui_text_width(p->on, UI_STYLE_NUMBER, "Exporting 4 100 %") + 20.0f;
    const ui_rectangle box = {right - widest, p->where.y + 0.5f * (p->where.height - 30.0f), widest,
                              30.0f};
    const float y = box.y + 0.5f * (box.height - ui_text_height(p->on, UI_STYLE_NUMBER));
    ui_draw_box(p->on, box, is_over(p, box) ? THEME_HOVER : THEME_RAISED, 5.0f);
    ui_draw_text(p->on, box.x + 10.0f, y, UI_STYLE_NUMBER, THEME_ACCENT, 0.0f, words);
    if (is_over(p, box))
        (void)snprintf(p->hint, sizeof p->hint, "%.440s\nHow far it is, and to cancel it",
                       first.file);
    if (is_pressed(p, box))
        desk_exports_ask(p->desk);
    return box.x;
}

static void put_right(pen *p)
{
    studio *of = p->desk->studio;
    const studio_figures *fast = studio_figures_of(of);
    char words[80];
    float x = p->where.x + p->where.width - 10.0f;
    x = put_word(p, x, ACTION_HELP, "?", studio_looks_of(of)->is_helping) - 4.0f;
    x = put_word(p, x, ACTION_OUTPUT, "Output", studio_looks_of(of)->has_output) - 4.0f;
    x = put_word(p, x, ACTION_SOUND_ARM, "Mic", studio_status(of)->is_sound_armed) - 4.0f;
    x = put_exports(p, x) - 8.0f;
    if (p->where.width < 1000.0f)
        return;
    if (fast->latency_p50_ms > 0.0)
        (void)snprintf(words, sizeof words, "%.0f ms hand to face", fast->latency_p50_ms);
    else if (fast->draw_p50_ms > 0.0)
        (void)snprintf(words, sizeof words, "%.0f ms a frame", fast->draw_p50_ms);
    else
        return;
    const float width = ui_text_width(p->on, UI_STYLE_NUMBER, words);
    const float y = p->where.y + 0.5f * (p->where.height - ui_text_height(p->on, UI_STYLE_NUMBER));
    const ui_rectangle box = {x - width, p->where.y, width, p->where.height};
    ui_draw_text(p->on, x - width, y, UI_STYLE_NUMBER, THEME_DIM, 0.0f, words);
    if (is_over(p, box))
        (void)snprintf(p->hint, sizeof p->hint,
                       "Hand to face: %.1f ms, at most %.1f ms\nA frame: %.1f ms, at most %.1f ms\n"
                       "Panels: %.2f ms of it",
                       fast->latency_p50_ms, fast->latency_p99_ms, fast->draw_p50_ms,
                       fast->draw_p99_ms, fast->panels_p50_ms);
}

void bar_draw(desk *self, ui_rectangle where)
{
    pen p = {.desk = self, .on = self->ui, .where = where};
    ui_panel_begin(self->ui, "bar", where, UI_GROUND_NONE);
    ui_canvas_begin(self->ui, "bar", 0.0f, 0.0f, &p.canvas);
    ui_draw_box(self->ui, where, THEME_BAR, 0.0f);
    ui_draw_box(self->ui, (ui_rectangle){where.x, where.y + where.height - 1.0f, where.width, 1.0f},
                THEME_RULE, 0.0f);
    const float names = where.width * 0.2f < 260.0f ? where.width * 0.2f : 260.0f;
    put_names(&p, names);
    put_middle(&p, where.x + names + 30.0f);
    put_right(&p);
    ui_canvas_end(self->ui);
    ui_hint(self->ui, p.hint);
    ui_panel_end(self->ui);
}

void bar_draw_alone(desk *self, ui_rectangle over)
{
    const live_status *status = studio_status(self->studio);
    if (!status->is_recording)
        return;
    const state_words words = state_of(self->studio);
    const float width = ui_text_width(self->ui, UI_STYLE_LARGE, words.large) + 66.0f;
    const ui_rectangle box = {over.x + 16.0f, over.y + 14.0f, width, 52.0f};
    ui_panel_begin(self->ui, "recording", box, UI_GROUND_NONE);
    ui_draw_box(self->ui, box, THEME_BAR, 8.0f);
    ui_draw_disc(self->ui, box.x + 26.0f, box.y + 26.0f, 9.0f, words.ink);
    ui_draw_text(self->ui, box.x + 48.0f,
                 box.y + 0.5f * (box.height - ui_text_height(self->ui, UI_STYLE_LARGE)),
                 UI_STYLE_LARGE, words.ink, 0.0f, words.large);
    ui_panel_end(self->ui);
}
