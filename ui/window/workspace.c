#include "window/workspace.h"
#include "window/app/pose_palette.h"
#include "window/camera_card.h"
#include "window/dialogs.h"
#include "window/docks.h"
#include "window/gui/theme.h"
#include "window/help.h"
#include "window/menus.h"
#include "window/offers.h"
#include "window/panels/hand.h"
#include "window/streams.h"
#include "window/timeline/record_menu.h"
#include "window/tour.h"
#include "window/viewport/viewport.h"
#include "window/viewport/virtual_hand.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/percentile.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { FIGURES_KEPT = 240 };

typedef struct figures {
    double value[FIGURES_KEPT]; /* a ring */
    uint32_t count;             /* of all that were added */
} figures;

struct workspace {
    app *app;
    window *window;
    ui *ui;
    viewport *viewport;
    streams *streams;
    camera_card *camera;
    uint64_t output_edition; /* of app_picture, as the output was opened */
    docks *docks;
    ui_screen screen;

    dialogs dialogs;
    offers offers;
    tour tour;
    help help;
    menus menus;
    ui_rectangle face_at; /* in the last frame */

    int32_t news_level; /* of the line that is shown */
    char news[1200];
    double news_left_s; /* < 0: until it is clicked, or something is said after a while */
    double news_age_s;
    uint64_t news_shown; /* of news_list_total */

    double held_s; /* of the key that repeats */
    uint32_t held_key;

    char title[600];
    figures panels_ms, interval_ms, draw_ms, latency_ms;
    uint64_t frame_count, drawn_count, face_shown;
    uint64_t output_shown; /* of viewport_output_drawn, in the second window */
    uint32_t output_width, output_height;
    bool output_is_mirrored;
    double figures_wait_s, first_face_s;
    int64_t began_ns; /* the last drawn frame */
};

/* ---- how long things took lately, and how long most of them take ---- */

static void figures_add(figures *self, double value)
{
    self->value[self->count++ % FIGURES_KEPT] = value;
    if (self->count == 2 * FIGURES_KEPT) /* the ring starts where it was */
        self->count = FIGURES_KEPT;
}

/* Of the last FIGURES_KEPT; 0 when there are none. */
static void figures_look(const figures *self, double *out_p50, double *out_p99)
{
    double sorted[FIGURES_KEPT];
    const uint32_t count = self->count < FIGURES_KEPT ? self->count : FIGURES_KEPT;
    memcpy(sorted, self->value, count * sizeof sorted[0]);
    *out_p50 = percentile(sorted, count, 0.5);
    *out_p99 = percentile(sorted, count, 0.99);
}

/* Keys: each action by its own, but while something is typed or the keyboard is a hand. */

#define REPEAT_AFTER_S 0.40
#define REPEAT_EVERY_S 0.07

/* What goes on while its key is held. */
static bool repeats(action of)
{
    return of == ACTION_FRAME_BACK || of == ACTION_FRAME_FORWARD || of == ACTION_SECOND_BACK ||
           of == ACTION_SECOND_FORWARD;
}

/* A hand needs the letters, not these. */
static bool is_beside_hand(key_chord chord)
{
    return (chord.modifiers & (UI_CONTROL | UI_ALT)) != 0 ||
           (chord.key >= UI_KEY_F1 && chord.key <= UI_KEY_F12);
}

static bool is_held_again(workspace *self, action of, key_chord chord)
{
    if (!repeats(of) || self->held_key != chord.key || !ui_is_down(self->ui, chord.key))
        return false;
    self->held_s += self->screen.dt_s; /* frames go on while a key is held */
    if (self->held_s < REPEAT_AFTER_S)
        return false;
    self->held_s -= REPEAT_EVERY_S;
    return true;
}

static bool is_wanted(workspace *self, action of, key_chord chord)
{
    if (ui_pressed(self->ui, chord.key, chord.modifiers)) {
        self->held_key = chord.key;
        self->held_s = 0.0;
        return true;
    }
    return is_held_again(self, of, chord);
}

static void escape(workspace *self)
{
    app_looks *looks = app_looks_of(self->app);
    if (app_has_hand_keys(self->app))
        app_do(self->app, ACTION_HAND_KEYS);
    else if (looks->is_helping)
        looks->is_helping = false;
    else if (self->tour.step != TOUR_OFF && !ui_has_dialog(self->ui))
        tour_end(&self->tour);
    else if (looks->is_face_only)
        looks->is_face_only = false;
}

/* The brush of the rig panel has these while it is on, the panel Hand has Space while it waits. */
static bool is_of_panel(workspace *self, key_chord chord)
{
    const app_looks *looks = app_looks_of(self->app);
    return chord.modifiers == 0 &&
           ((looks->is_painting && (chord.key == '[' || chord.key == ']')) ||
            (looks->is_answering && chord.key == ' '));
}

/* A key that was learnt for a pose has no other meaning. */
static bool is_of_pose(workspace *self, key_chord chord)
{
    return chord.modifiers == 0 && pose_palette_has_key(app_poses(self->app), chord.key);
}

static void workspace_dispatch_keys(workspace *self)
{
    const bool is_hand = app_has_hand_keys(self->app);
    pose_palette_read_keys(app_poses(self->app), self->ui, is_hand ? virtual_hand_has_key : NULL);
    if (help_takes_keys(&self->help, self->app, self->ui))
        return;
    if (ui_pressed(self->ui, UI_KEY_ESCAPE, 0)) {
        escape(self);
        return;
    }
    for (uint32_t i = 1; i < ACTION_COUNT; ++i) {
        const key_chord chord = key_map_of(&app_looks_of(self->app)->keys, (action)i);
        if (chord.key == UI_KEY_NONE || (is_hand && !is_beside_hand(chord)) ||
            is_of_panel(self, chord) || is_of_pose(self, chord))
            continue;
        if (is_wanted(self, (action)i, chord))
            app_do(self->app, (action)i);
    }
}

/* The newest news over the face, for a while; an error until it is clicked. */

#define SHOWN_S   6.0
#define ERROR_S   3.0 /* at least, whatever comes after it */
#define WARNING_S 12.0

/* What plugins have to tell that is no trouble is in the log. */
static bool is_for_everybody(const news_item *item)
{
    return item->level >= MRT_LOG_WARNING || strcmp(item->source, "stage") == 0;
}

/* A calmer line does not push an error away that nobody can have read yet; later it does: what is
 * said then is of something that went well. */
static bool gives_way(const workspace *self, const news_item *to)
{
    return self->news[0] == '\0' || self->news_level < MRT_LOG_ERROR ||
           to->level >= MRT_LOG_ERROR || self->news_age_s > ERROR_S;
}

/* What is said in one frame is one: of that the most serious is shown, the newest of several. */
static const news_item *most_serious_of_new(workspace *self)
{
    const news_list *list = app_news(self->app);
    const news_item *best = NULL;
    for (uint32_t i = news_list_first_after(list, self->news_shown); i < news_list_count(list);
         ++i) {
        const news_item *item = news_list_at(list, i);
        if (is_for_everybody(item) && (!best || item->level >= best->level))
            best = item;
    }
    self->news_shown = news_list_total(list);
    return best;
}

/* A plugin says what it did, not who it is: "troubled" of "org.example.troubled". */
static const char *speaker_of(const news_item *item)
{
    const char *dot = strrchr(item->source, '.');
    return dot ? dot + 1 : "";
}

static void workspace_update_news(workspace *self, double dt_s)
{
    const news_item *item = most_serious_of_new(self);
    self->news_age_s += dt_s;
    if (self->news_left_s > 0.0) {
        self->news_left_s -= dt_s;
        if (self->news_left_s <= 0.0)
            self->news[0] = '\0';
    }
    if (!item || !gives_way(self, item))
        return;
    const char *speaker = speaker_of(item);
    (void)snprintf(self->news, sizeof self->news, "%s%s%s", speaker, speaker[0] ? ": " : "",
                   item->text);
    self->news_level = item->level;
    self->news_age_s = 0.0;
    self->news_left_s = item->level >= MRT_LOG_ERROR     ? -1.0
                        : item->level >= MRT_LOG_WARNING ? WARNING_S
                                                         : SHOWN_S;
}

/* Where a text that is too long for one line is broken: at its last blank that fits. */
static size_t first_line(const ui *on, ui_style style, const char *text, float width)
{
    char part[sizeof((workspace *)NULL)->news];
    size_t fits = 0;
    if (ui_text_width(on, style, text) <= width)
        return strlen(text);
    for (const char *c = strchr(text, ' '); c; c = strchr(c + 1, ' ')) {
        (void)snprintf(part, sizeof part, "%.*s", (int)(c - text), text);
        if (ui_text_width(on, style, part) > width)
            break;
        fits = (size_t)(c - text);
    }
    return fits ? fits : strlen(text);
}

static void workspace_draw_news(workspace *self, ui_rectangle over)
{
    char first[sizeof self->news];
    if (!self->news[0])
        return;
    ui *on = self->ui;
    const ui_style style = self->news_level >= MRT_LOG_ERROR     ? UI_STYLE_BAD
                           : self->news_level >= MRT_LOG_WARNING ? UI_STYLE_WARNING
                                                                 : UI_STYLE_BODY;
    const bool stays = self->news_left_s < 0.0;
    const float padding = 12.0f, line = 20.0f, cross = stays ? 24.0f : 0.0f;
    float width = ui_text_width(on, style, self->news) + 2.0f * padding + cross;
    if (width > over.width - 24.0f)
        width = over.width - 24.0f;
    const float room = width - 2.0f * padding - cross + 1.0f;
    const size_t break_at = first_line(on, style, self->news, room);
    const char *rest = self->news + break_at + (self->news[break_at] == ' ');
    const float height = rest[0] ? 32.0f + line : 32.0f;
    (void)snprintf(first, sizeof first, "%.*s", (int)break_at, self->news);
    const ui_rectangle box = {over.x + 12.0f, over.y + over.height - height - 12.0f, width, height};
    ui_canvas canvas;
    ui_panel_begin(on, "news", box, UI_GROUND_NONE);
    ui_canvas_begin(on, "line", 0.0f, 0.0f, &canvas);
    ui_draw_box(on, box, THEME_PANEL, 5.0f);
    const uint32_t colour = style == UI_STYLE_BAD       ? THEME_BAD
                            : style == UI_STYLE_WARNING ? THEME_WARNING
                                                        : THEME_TEXT;
    const float y = box.y + 0.5f * (32.0f - ui_text_height(on, UI_STYLE_BODY));
    ui_draw_text(on, box.x + padding, y, UI_STYLE_BODY, colour, room, first);
    if (rest[0])
        ui_draw_text(on, box.x + padding, y + line, UI_STYLE_BODY, colour, room, rest);
    if (stays) {
        const float x = box.x + width - padding - 5.0f, middle = box.y + 0.5f * height;
        ui_draw_line(on, x - 4.0f, middle - 4.0f, x + 4.0f, middle + 4.0f, THEME_DIM, 1.5f);
        ui_draw_line(on, x - 4.0f, middle + 4.0f, x + 4.0f, middle - 4.0f, THEME_DIM, 1.5f);
    }
    if (canvas.is_hovered)
        ui_set_cursor(on, UI_CURSOR_HAND);
    if (canvas.is_pressed)
        self->news[0] = '\0';
    ui_canvas_end(on);
    ui_hint(on, self->news); /* the line may have been cut */
    ui_panel_end(on);
}

/* The bar at the top: what is open, what is being recorded and where one is, how fast it goes. */

#define ICON   34.0f
#define MENU_X 6.0f
#define GAP    14.0f

static const int64_t KEEP_NS = 30 * NS_PER_S;

typedef struct pen { /* along the bar */
    workspace *workspace;
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

static bool is_pressed(const pen *p, const char *label, ui_rectangle box)
{
    return ui_canvas_button(p->on, &p->canvas, label, box, true);
}

static void words_of_key(const pen *p, action of, char out[KEY_WORDS])
{
    key_map_words(&app_looks_of(p->workspace->app)->keys, of, out);
}

static void hint_action(pen *p, action of)
{
    char keys[KEY_WORDS];
    const char *why = "";
    const bool can = app_can(p->workspace->app, of, &why);
    words_of_key(p, of, keys);
    (void)snprintf(p->hint, sizeof p->hint, "%s%s%s%s\n%s%s%s", action_of(of)->title,
                   keys[0] ? "  (" : "", keys, keys[0] ? ")" : "", action_of(of)->help,
                   can ? "" : "\nNot now: ", can ? "" : why);
}

typedef void paint_sign(ui *on, float x, float y, uint32_t ink);

static void put_sign(pen *p, ui_rectangle box, action of, paint_sign *sign, bool is_on)
{
    const bool can = app_can(p->workspace->app, of, NULL);
    const bool is_hovered = is_over(p, box);
    if (is_hovered || is_on)
        ui_draw_box(p->on, box, is_hovered && can ? THEME_HOVER : THEME_RAISED, 5.0f);
    sign(p->on, box.x + 0.5f * box.width, box.y + 0.5f * box.height,
         !can    ? THEME_OFF
         : is_on ? THEME_ACCENT
                 : THEME_TEXT);
    if (is_hovered)
        hint_action(p, of);
    if (is_pressed(p, action_of(of)->title, box))
        app_do(p->workspace->app, of);
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
    if (is_pressed(p, action_of(of)->title, box))
        app_do(p->workspace->app, of);
    return box.x;
}

/* ---- left: what is open ---- */

/* "night" of "/home/a/night.marotte"; "puppet" of "puppet.rig.json". */
static void name_of(const char *path, char *out, size_t capacity)
{
    (void)snprintf(out, capacity, "%s", file_name_of(path));
    static const char *const endings[] = {".marotte", ".rig.json"};
    for (size_t i = 0; i < 2; ++i) {
        const size_t length = strlen(out), ending = strlen(endings[i]);
        if (length > ending && strcmp(out + length - ending, endings[i]) == 0)
            out[length - ending] = '\0';
    }
}

static void put_name(pen *p, float x, float y, float width, ui_style style, uint32_t ink,
                     const char *name, const char *path, open_kind kind)
{
    const ui_rectangle box = {x, y - 2.0f, width, 21.0f};
    if (is_over(p, box)) {
        ui_draw_box(p->on, box, THEME_RAISED, 4.0f);
        ui_set_cursor(p->on, UI_CURSOR_HAND);
        char keys[KEY_WORDS];
        words_of_key(p, ACTION_OPEN, keys);
        (void)snprintf(p->hint, sizeof p->hint, "%.420s\nOpen another %s%s%s%s", path,
                       kind == OPEN_SHOW ? "show" : "face", keys[0] ? "  (" : "", keys,
                       keys[0] ? ")" : "");
    }
    ui_draw_text(p->on, box.x + 6.0f, y, style, ink, width - 12.0f, name);
    if (is_pressed(p, kind == OPEN_SHOW ? "Open another show" : "Open another face", box))
        dialogs_ask_open(&p->workspace->dialogs, kind);
}

static void put_names(pen *p, float x, float width)
{
    app *of = p->workspace->app;
    char name[256], words[320];
    const float line = 21.0f, top = p->where.y + 0.5f * (p->where.height - 2.0f * line) + 2.0f;
    show *s = app_show(of);
    if (s)
        name_of(show_path(s), name, sizeof name);
    (void)snprintf(words, sizeof words, "%s%s", s ? name : "No show. Recording is off",
                   s && !show_is_writable(s) ? " (read only)" : "");
    put_name(p, x, top, width, UI_STYLE_STRONG,
             s && show_is_writable(s) ? THEME_TEXT : THEME_WARNING, words,
             s ? show_path(s) : "No show is open.", OPEN_SHOW);
    name_of(app_face_path(of), name, sizeof name);
    (void)snprintf(words, sizeof words, "%s%s", name, app_unsaved_now(of) ? " \u2022" : "");
    put_name(p, x, top + line, width, UI_STYLE_BODY, THEME_DIM, words, app_face_path(of),
             OPEN_FACE);
}

/* ---- middle: recording and where one is ---- */

static void sign_menu(ui *on, float x, float y, uint32_t ink)
{
    for (int i = -1; i <= 1; ++i)
        ui_draw_box(on, (ui_rectangle){x - 8.0f, y + 6.0f * (float)i - 1.0f, 16.0f, 2.0f}, ink,
                    1.0f);
}

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

static const app_take_line *line_of(app *of, int64_t id)
{
    static const app_take_line none;
    const app_take_line *line;
    const uint32_t count = app_takes(of, &line);
    for (uint32_t i = 0; i < count; ++i)
        if (line[i].id == id)
            return &line[i];
    return &none;
}

static state_words state_of(app *of)
{
    const live_status *status = app_status(of);
    const live_view *view = app_view(of);
    const app_take_line *line = line_of(of, live_shown_take(app_live(of)));
    const char *shown = line->title;
    char keys[KEY_WORDS];
    state_words out = {.large = "Live", .ink = THEME_TEXT};
    const double leads_in_s = app_leads_in_s(of);
    if (leads_in_s > 0.0) {
        (void)snprintf(out.large, sizeof out.large, "%.0f", ceil(leads_in_s));
        key_map_words(&app_looks_of(of)->keys, ACTION_RECORD, keys);
        if (view->mode == LIVE_OVERDUBS)
            (void)snprintf(out.small, sizeof out.small, "About to record over take %.150s", shown);
        else
            (void)snprintf(out.small, sizeof out.small, "Press %s to cancel the count-in",
                           keys[0] ? keys : action_of(ACTION_RECORD)->title);
        out.ink = THEME_RECORD;
    } else if (view->mode == LIVE_OVERDUBS) {
        write_time(out.large, sizeof out.large, view->at_ns);
        (void)snprintf(out.small, sizeof out.small, "%s take %.150s",
                       view->is_recording_over ? "Recording over" : "About to record over", shown);
        out.ink = view->is_recording_over ? THEME_RECORD : THEME_TEXT;
    } else if (status->is_recording) {
        write_time(out.large, sizeof out.large, status->recorded_ns);
        (void)snprintf(out.small, sizeof out.small, "Recording take %.150s",
                       line_of(of, status->take)->title);
        out.ink = THEME_RECORD;
    } else if (view->mode == LIVE_SHOWS && app_looks_of(of)->layouts.now.has_timeline) {
        (void)snprintf(out.large, sizeof out.large, "Take %.50s", shown); /* time is below */
        key_map_words(&app_looks_of(of)->keys, ACTION_LIVE, keys);
        (void)snprintf(out.small, sizeof out.small, "%s%s. Back to the live hands",
                       line->is_deleted ? "Deleted. " : "",
                       keys[0] ? keys : action_of(ACTION_LIVE)->title);
    } else if (view->mode == LIVE_SHOWS) {
        write_time(out.large, sizeof out.large, live_position(app_live(of)).at_ns);
        (void)snprintf(out.small, sizeof out.small, "Take %.150s", shown);
    } else if (!status->can_record) {
        (void)snprintf(out.small, sizeof out.small, "Nothing is recorded");
    } else {
        const int back_s = status->journal_ns < KEEP_NS ? (int)(status->journal_ns / NS_PER_S)
                                                        : (int)(KEEP_NS / NS_PER_S);
        key_map_words(&app_looks_of(of)->keys, ACTION_KEEP, keys);
        (void)snprintf(out.small, sizeof out.small, "%s keeps the last %d s",
                       keys[0] ? keys : "Keep", back_s);
    }
    if (status->problem[0]) {
        (void)snprintf(out.small, sizeof out.small, "%.199s", status->problem);
        out.ink = status->is_recording ? THEME_RECORD : THEME_WARNING;
    }
    return out;
}

static float put_state(pen *p, float x)
{
    const state_words words = state_of(p->workspace->app);
    const float large = ui_text_height(p->on, UI_STYLE_LARGE), width = 132.0f;
    const float own = ui_text_width(p->on, UI_STYLE_LARGE, words.large);
    const float most = 0.24f * p->where.width;
    const float wide = own > most ? most : own > width ? own : width;
    const bool is_warning = words.ink == THEME_WARNING;
    ui_draw_text(p->on, x, p->where.y + 0.5f * (p->where.height - large), UI_STYLE_LARGE,
                 is_warning ? THEME_TEXT : words.ink, wide + 1.0f, words.large);
    x += wide + GAP;
    const float height = ui_text_height(p->on, UI_STYLE_BODY);
    const float own_small = ui_text_width(p->on, UI_STYLE_BODY, words.small) + 2.0f;
    const float room = fmaxf(190.0f, fminf(own_small, 0.26f * p->where.width));
    const ui_rectangle box = {x, p->where.y, room, p->where.height};
    ui_draw_text(p->on, x, p->where.y + 0.5f * (p->where.height - height), UI_STYLE_BODY,
                 is_warning ? THEME_WARNING : THEME_DIM, room, words.small);
    if (is_over(p, box))
        (void)snprintf(p->hint, sizeof p->hint, "%s", words.small);
    return x + room;
}

static ui_rectangle record_box(const pen *p, float x)
{
    return (ui_rectangle){x, p->where.y + 0.5f * (p->where.height - ICON), ICON, ICON};
}

/* Returns its right end. */
static float put_middle(pen *p, float x)
{
    app *of = p->workspace->app;
    live *stage = app_live(of);
    const bool is_recording = app_status(of)->is_recording;
    const transport *move = live_transport(stage);
    const bool is_playing = app_view(of)->mode != LIVE_PERFORMS && move->is_playing &&
                            !live_position(stage).has_stopped;
    const float y = p->where.y + 0.5f * (p->where.height - ICON);
    put_sign(p, record_box(p, x), ACTION_RECORD, is_recording ? sign_recording : sign_record,
             is_recording);
    x = put_state(p, x + ICON + GAP);
    if (app_looks_of(of)->layouts.now.has_timeline || p->where.width < 1100.0f)
        return x;
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
    return x;
}

/* ---- right: how fast, the output, help ---- */

/* How far the oldest export is; a click tells of all. Returns its left end. */
static float put_exports(pen *p, float right)
{
    app *of = p->workspace->app;
    const exporter *exports = app_exporter(of);
    const uint32_t count = exporter_count(exports);
    char words[64], part[32] = "";
    if (count == 0)
        return right;
    const export_progress first = exporter_at(exports, 0);
    if (first.done >= 0.0)
        (void)snprintf(part, sizeof part, "%s %.0f %%", count > 1 ? "," : "", 100.0 * first.done);
    if (count > 1)
        (void)snprintf(words, sizeof words, "Exporting %u takes%s", count, part);
    else
        (void)snprintf(words, sizeof words, "Exporting%s", part);
    const float widest = ui_text_width(p->on, UI_STYLE_NUMBER, "Exporting 99 takes, 100 %") + 20.0f;
    const ui_rectangle box = {right - widest, p->where.y + 0.5f * (p->where.height - 30.0f), widest,
                              30.0f};
    const float y = box.y + 0.5f * (box.height - ui_text_height(p->on, UI_STYLE_NUMBER));
    ui_draw_box(p->on, box, is_over(p, box) ? THEME_HOVER : THEME_RAISED, 5.0f);
    ui_draw_text(p->on, box.x + 10.0f, y, UI_STYLE_NUMBER, THEME_ACCENT, 0.0f, words);
    if (is_over(p, box))
        (void)snprintf(p->hint, sizeof p->hint, "%.440s\nHow far it is, and to cancel it",
                       first.file);
    if (is_pressed(p, "Exporting", box))
        export_page_ask_going(&p->workspace->dialogs.exports);
    return box.x;
}

/* How much of a voice is read. Returns its left end. */
static float put_audio_import(pen *p, float right)
{
    const double part = app_voice_part(p->workspace->app);
    char words[40];
    if (part < 0.0)
        return right;
    (void)snprintf(words, sizeof words, "Reading the voice %.0f %%", 100.0 * part);
    const float width = ui_text_width(p->on, UI_STYLE_NUMBER, "Reading the voice 100 %") + 24.0f;
    const float height = ui_text_height(p->on, UI_STYLE_NUMBER);
    ui_draw_text(p->on, right - width + 12.0f, p->where.y + 0.5f * (p->where.height - height),
                 UI_STYLE_NUMBER, THEME_ACCENT, 0.0f, words);
    return right - width;
}

/* left: where the middle ends. */
static void put_right(pen *p, float left)
{
    app *of = p->workspace->app;
    const app_figures *fast = &app_notes_of(of)->figures;
    char words[80];
    float x = p->where.x + p->where.width - 10.0f;
    x = put_word(p, x, ACTION_HELP, "?", app_looks_of(of)->is_helping) - 4.0f;
    x = put_word(p, x, ACTION_OUTPUT, "Output", app_looks_of(of)->has_output) - 4.0f;
    x = put_word(p, x, ACTION_SOUND_ARM, "Mic", app_status(of)->is_sound_armed) - 4.0f;
    x = put_exports(p, x) - 8.0f;
    x = put_audio_import(p, x);
    if (p->where.width < 1000.0f)
        return;
    if (fast->latency_p50_ms > 0.0)
        (void)snprintf(words, sizeof words, "%.0f ms hand to face", fast->latency_p50_ms);
    else if (fast->draw_p50_ms > 0.0)
        (void)snprintf(words, sizeof words, "%.0f ms a frame", fast->draw_p50_ms);
    else
        return;
    const float width = ui_text_width(p->on, UI_STYLE_NUMBER, words);
    if (x - width < left + 16.0f)
        return;
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

static void bar_draw(workspace *self, ui_rectangle where)
{
    pen p = {.workspace = self, .on = self->ui, .where = where};
    ui_panel_begin(self->ui, "bar", where, UI_GROUND_NONE);
    ui_canvas_begin(self->ui, "bar", 0.0f, 0.0f, &p.canvas);
    ui_draw_box(self->ui, where, THEME_BAR, 0.0f);
    ui_draw_box(self->ui, (ui_rectangle){where.x, where.y + where.height - 1.0f, where.width, 1.0f},
                THEME_RULE, 0.0f);
    const ui_rectangle menu = {where.x + MENU_X, where.y + 0.5f * (where.height - ICON), ICON,
                               ICON};
    const float names = where.width * 0.2f < 260.0f ? where.width * 0.2f : 260.0f;
    const float left = menu.x + menu.width, middle = left + names + GAP;
    put_sign(&p, menu, ACTION_MENU, sign_menu, false);
    put_names(&p, left, names);
    put_right(&p, put_middle(&p, middle));
    ui_canvas_end(self->ui);
    ui_hint(self->ui, p.hint);
    if (p.canvas.is_pressed && p.canvas.button == 1 && is_over(&p, record_box(&p, middle)))
        record_menu_open(self->ui, middle, where.y + where.height);
    record_menu_draw(self->app, self->ui);
    ui_panel_end(self->ui);
}

/* With the panels away: what is being recorded, over the face. */
static void bar_draw_alone(workspace *self, ui_rectangle over)
{
    const live_status *status = app_status(self->app);
    if (!status->is_recording)
        return;
    const state_words words = state_of(self->app);
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

/* ---- the workspace ---- */

#define FIGURES_EVERY_S 0.5

/* ---- life ---- */

static mrt_result create_parts(workspace *self, error *err)
{
    mrt_result result = ui_create(&self->ui, err);
    if (result < 0)
        return result;
    dialogs_init(&self->dialogs, self->app, self->ui);
    menus_init(&self->menus, self->app, self->ui, &self->dialogs);
    self->viewport = viewport_create(self->app, err);
    if (!self->viewport)
        return MRT_ERR_UNSUPPORTED;
    app_set_viewport(self->app, self->viewport);
    self->streams = streams_create(self->app, self->viewport);
    if (!self->streams)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    self->docks = docks_create(self->app);
    self->camera = camera_card_create(self->app);
    return self->docks && self->camera ? MRT_OK
                                       : error_set(err, MRT_ERR_MEMORY, "no memory for the panels");
}

mrt_result workspace_create(workspace **out, app *of, window *on, error *err)
{
    *out = NULL;
    workspace *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the workspace");
    self->app = of;
    self->window = on;
    mrt_result result = create_parts(self, err);
    if (result < 0) {
        workspace_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void workspace_destroy(workspace *self)
{
    if (!self)
        return;
    docks_destroy(self->docks);
    camera_card_destroy(self->camera);
    app_set_viewport(self->app, NULL);
    viewport_destroy(self->viewport);
    streams_destroy(self->streams);
    window_close_output(self->window);
    ui_destroy(self->ui);
    dialogs_finish(&self->dialogs);
    free(self);
}

ui *workspace_ui(workspace *self)
{
    return self->ui;
}

ui_rectangle workspace_face(const workspace *self)
{
    return self->face_at;
}

float workspace_scale(const workspace *self)
{
    return self->screen.scale > 0.0f ? self->screen.scale : 1.0f;
}

/* ---- where things are ---- */

typedef struct workspace_layout {
    arrangement_rectangles at; /* with the face only: nothing else */
    ui_rectangle stage;        /* the face with the cards beside it */
    ui_rectangle card;         /* of the hand, at the left of the face; width 0: none */
    bool has_panels;
} workspace_layout;

static workspace_layout lay_out(const workspace *self)
{
    const app_looks *looks = app_looks_of(self->app);
    const float width = self->screen.width, height = self->screen.height;
    workspace_layout out = {.has_panels = !looks->is_face_only};
    if (out.has_panels)
        arrangement_lay_out(&looks->layouts.now, width, height, &out.at);
    else
        out.at.face = (ui_rectangle){0.0f, 0.0f, width, height};
    out.stage = out.card = out.at.face;
    out.card.width = hand_panel_card_width(docks_panel(self->docks, APP_HAND), self->ui, out.stage);
    const float camera = out.has_panels ? camera_card_width(self->camera, out.stage) : 0.0f;
    const float beside = out.card.width > camera ? out.card.width : camera;
    out.at.face.x += beside;
    out.at.face.width -= beside;
    return out;
}

/* ---- parts ---- */

/* Before a recording the performer looks at the face. */
static void draw_lead_in(workspace *self, ui_rectangle over)
{
    const double left_s = app_leads_in_s(self->app);
    char words[16];
    if (left_s <= 0.0)
        return;
    (void)snprintf(words, sizeof words, "%.0f", ceil(left_s));
    const float width = ui_text_width(self->ui, UI_STYLE_LARGE, words) + 40.0f,
                height = ui_text_height(self->ui, UI_STYLE_LARGE) + 16.0f;
    const ui_rectangle box = {over.x + 0.5f * (over.width - width), over.y + 14.0f, width, height};
    ui_panel_begin(self->ui, "lead_in", box, UI_GROUND_NONE);
    ui_draw_box(self->ui, box, THEME_RECORD, 8.0f);
    ui_draw_text(self->ui, box.x + 20.0f, box.y + 8.0f, UI_STYLE_LARGE, THEME_STAGE, 0.0f, words);
    ui_panel_end(self->ui);
}

/* What helps a person to begin, at the left edge of the face. */
static void draw_cards(workspace *self, ui_rectangle stage, ui_rectangle above_news)
{
    const bool has_camera = camera_card_draw(self->camera, self->ui, stage);
    self->offers.has_camera = has_camera;
    self->offers.when = tour_offers(&self->tour);
    const float offered = offers_draw(&self->offers, self->app, self->ui, above_news);
    const tour_room room = {above_news, offered, has_camera};
    tour_draw(&self->tour, self->app, self->ui, &room);
}

static void draw_panels(workspace *self, const workspace_layout *on)
{
    const ui_rectangle room = on->at.face;
    if (on->has_panels) {
        docks_draw(self->docks, self->ui, &on->at);
        bar_draw(self, on->at.bar);
    } else
        bar_draw_alone(self, room);
    ui_rectangle above_news = room;
    above_news.height -= self->news[0] ? 68.0f : 0.0f;
    draw_lead_in(self, room);
    if (on->card.width > 0.0f)
        hand_panel_draw_card(docks_panel(self->docks, APP_HAND), self->ui, on->card);
    if (on->has_panels) {
        draw_cards(self, on->stage, above_news);
        docks_draw_over(self->docks, self->ui, &on->at);
    }
    workspace_draw_news(self, room);
    if (app_looks_of(self->app)->is_helping)
        help_draw(&self->help, self->app, self->ui,
                  (ui_rectangle){0.0f, 0.0f, self->screen.width, self->screen.height},
                  self->screen.scale / window_scale(self->window));
    dialogs_draw(&self->dialogs);
    menus_draw(&self->menus, MENU_X, on->at.bar.height);
    tour_update(&self->tour, self->app, self->screen.dt_s);
    record_menu_tempo(self->app, self->ui);
}

static void take_requests(workspace *self)
{
    if (app_take_request(self->app, ACTION_OPEN))
        dialogs_ask_open(&self->dialogs, OPEN_ANY);
    if (app_take_request(self->app, ACTION_TOUR))
        tour_begin(&self->tour, self->app);
    if (app_take_call(self->app, APP_CALL_RECORDING))
        dialogs_ask_open(&self->dialogs, OPEN_HANDS);
    if (app_take_call(self->app, APP_CALL_PICTURE))
        dialogs_ask_open(&self->dialogs, OPEN_PICTURE);
    for (const char *path; (path = window_take_drop(self->window)) != NULL;)
        dialogs_drop(&self->dialogs, path);
    if (app_take_request(self->app, ACTION_SAVE_AS))
        dialogs_ask_save_as(&self->dialogs);
    if (app_take_request(self->app, ACTION_EXPORT))
        export_page_ask(&self->dialogs.exports);
    if (app_wants_to_quit(self->app))
        dialogs_quit(&self->dialogs);
}

/* ---- the second window ---- */

/* Whether it shows something else than what is to be shown; from now on it does not. */
static bool is_output_new(workspace *self, uint32_t width, uint32_t height)
{
    const uint64_t drawn = viewport_output_drawn(self->viewport, VIEWPORT_WINDOW);
    const bool is_mirrored = app_looks_of(self->app)->is_output_mirrored;
    const bool is_new = drawn != self->output_shown || width != self->output_width ||
                        height != self->output_height || is_mirrored != self->output_is_mirrored;
    self->output_shown = drawn;
    self->output_width = width;
    self->output_height = height;
    self->output_is_mirrored = is_mirrored;
    return is_new;
}

static void show_output(workspace *self)
{
    app_looks *looks = app_looks_of(self->app);
    uint32_t width = 0, height = 0;
    error err = {0};
    if (!looks->has_output) {
        window_close_output(self->window);
        return;
    }
    const app_picture *picture = app_picture_now(self->app);
    const window_output_look look = {strcmp(picture->background, "transparent") == 0,
                                     picture->is_on_top, picture->is_window};
    if (picture->edition != self->output_edition)
        window_close_output(self->window);
    self->output_edition = picture->edition;
    if (!window_has_output(self->window))
        self->output_width = 0; /* nothing is shown in a window that is opened now */
    if (!window_has_output(self->window) && window_open_output(self->window, &look, &err) < 0) {
        news_list_add(app_news(self->app), MRT_LOG_ERROR, "output", err.text);
        looks->has_output = false;
        return;
    }
    window_output_size(self->window, &width, &height);
    const uint32_t texture =
        width && height ? viewport_output(self->viewport, VIEWPORT_WINDOW, width, height) : 0;
    if (texture)
        window_show_output(self->window, texture, looks->is_output_mirrored,
                           is_output_new(self, width, height));
    looks->has_output = window_has_output(self->window); /* the person may have closed it */
}

/* ---- figures ---- */

static double ms_between(int64_t from_ns, int64_t to_ns)
{
    return 1e-6 * (double)(to_ns - from_ns);
}

static int64_t cpu_now_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* Since the program was started, as the system knows it. */
static double running_s(void)
{
    char text[1024];
    unsigned long long ticks = 0;
    struct timespec now;
    FILE *file = fopen("/proc/self/stat", "r");
    const size_t length = file ? fread(text, 1, sizeof text - 1, file) : 0;
    if (file)
        (void)fclose(file);
    text[length] = '\0';
    const char *at = strrchr(text, ')'); /* the name may have blanks; "starttime" is field 22 */
    for (int field = 2; at && field < 22; ++field)
        at = strchr(at + 1, ' ');
    if (!at || clock_gettime(CLOCK_BOOTTIME, &now) != 0)
        return 0.0;
    ticks = strtoull(at, NULL, 10);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec -
           (double)ticks / (double)sysconf(_SC_CLK_TCK);
}

static void note_face(workspace *self)
{
    const live_view *view = app_view(self->app);
    if (view->number == 0 || view->number == self->face_shown)
        return;
    if (self->face_shown == 0) {
        self->first_face_s = running_s();
        memory_started();
    } else if (!view->hand[MRT_LEFT].present && !view->hand[MRT_RIGHT].present)
        self->latency_ms.count = 0;
    else if (view->sample_ns > 0 && view->mode != LIVE_SHOWS)
        figures_add(&self->latency_ms, ms_between(view->sample_ns, clock_now_ns()));
    self->face_shown = view->number;
}

/* "night, puppet \u2022" */
static void tell_title(workspace *self)
{
    char title[600];
    show *s = app_show(self->app);
    (void)snprintf(title, sizeof title, "%.200s, %.200s%s - marotte",
                   s ? file_name_of(show_path(s)) : "no show",
                   file_name_of(app_face_path(self->app)),
                   app_unsaved_now(self->app) ? " \xe2\x80\xa2" : "");
    if (strcmp(title, self->title) == 0)
        return;
    (void)snprintf(self->title, sizeof self->title, "%s", title);
    window_set_title(self->window, title);
}

static void keep_size(const workspace *self)
{
    settings *kept = app_settings(self->app);
    const bool is_maximised = window_is_maximised(self->window);
    const double scale = (double)window_scale(self->window);
    settings_set_number(kept, "window.maximised", is_maximised ? 1.0 : 0.0);
    if (is_maximised) /* the size is the one to come back to */
        return;
    settings_set_number(kept, "window.width", floor((double)window_width_px(self->window) / scale));
    settings_set_number(kept, "window.height",
                        floor((double)window_height_px(self->window) / scale));
}

static void look_at_figures(const workspace *self, app_figures *out)
{
    figures_look(&self->panels_ms, &out->panels_p50_ms, &out->panels_p99_ms);
    figures_look(&self->interval_ms, &out->interval_p50_ms, &out->interval_p99_ms);
    figures_look(&self->draw_ms, &out->draw_p50_ms, &out->draw_p99_ms);
    figures_look(&self->latency_ms, &out->latency_p50_ms, &out->latency_p99_ms);
}

static void tell_figures(workspace *self)
{
    self->figures_wait_s -= self->screen.dt_s;
    if (self->figures_wait_s > 0.0)
        return;
    self->figures_wait_s = FIGURES_EVERY_S;
    look_at_figures(self, &app_notes_of(self->app)->figures);
    tell_title(self);
    keep_size(self);
}

void workspace_counted(const workspace *self, workspace_counts *out)
{
    *out = (workspace_counts){.frame_count = self->frame_count,
                              .drawn_count = self->drawn_count,
                              .face_count = viewport_drawn(self->viewport),
                              .first_face_s = self->first_face_s};
    look_at_figures(self, &out->fast);
}

/* ---- a frame ---- */

static void draw(workspace *self)
{
    const workspace_layout on = lay_out(self);
    self->face_at = on.at.face;
    const int64_t began_ns = cpu_now_ns();
    docks_update(self->docks, self->screen.dt_s);
    camera_card_update(self->camera, self->screen.dt_s);
    const int64_t updated_ns = cpu_now_ns();
    viewport_draw(self->viewport, self->ui, on.at.face, self->screen.scale);
    const int64_t face_ns = cpu_now_ns();
    draw_panels(self, &on);
    if (self->frame_count > 1)
        figures_add(&self->panels_ms,
                    ms_between(began_ns, updated_ns) + ms_between(face_ns, cpu_now_ns()));
}

/* Requests frames for everything that changes without an event and without a new face. */
static void want_frames(workspace *self)
{
    double in_s = fmin(ui_wanted_s(self->ui), app_wanted_s(self->app));
    if (ui_is_holding(self->ui) || app_looks_of(self->app)->is_turning)
        in_s = 0.0;
    if (self->news_left_s > 0.0)
        in_s = fmin(in_s, self->news_left_s);
    window_want_frame(self->window, in_s);
}

bool workspace_frame(workspace *self)
{
    window_gamepad pad;
    const app_looks *looks = app_looks_of(self->app);
    window_set_zoom(self->window, looks->text_size);
    ui_set_theme(self->ui, looks->theme);
    if (!window_begin(self->window, self->ui, &self->screen))
        app_do(self->app, ACTION_QUIT);
    const int64_t began_ns = clock_now_ns();
    ui_begin(self->ui, &self->screen);
    app_update(self->app, self->screen.dt_s);
    window_stay_awake(self->window,
                      app_remote_now(self->app).is_listening || streams_are_on(self->streams));
    workspace_dispatch_keys(self);
    take_requests(self);
    workspace_update_news(self, self->screen.dt_s);
    const bool has_pad = window_read_gamepad(self->window, &pad);
    viewport_update(self->viewport, self->ui, has_pad ? &pad : NULL, self->screen.dt_s);
    draw(self);
    ui_end(self->ui);
    note_face(self);
    /* The first frames create shared resources; frames that are not drawn are not counted. */
    const bool is_drawn = ui_is_new(self->ui) || ui_is_hidden(self->ui);
    if (self->frame_count > 1 && is_drawn)
        figures_add(&self->draw_ms, ms_between(began_ns, clock_now_ns()));
    if (self->frame_count > 1 && is_drawn && !window_pace(self->window)->has_rested)
        figures_add(&self->interval_ms, ms_between(self->began_ns, began_ns));
    self->drawn_count += ui_is_new(self->ui);
    self->began_ns = began_ns;
    window_end(self->window, self->ui);
    float ground[4];
    const bool has_ground = streams_ground(app_picture_now(self->app)->background, ground);
    viewport_set_ground(self->viewport, has_ground ? ground : NULL);
    show_output(self);
    streams_update(self->streams, self->screen.dt_s);
    tell_figures(self);
    want_frames(self);
    self->frame_count += 1;
    return !self->dialogs.is_over;
}
