/* The transport strip: timecode, transport buttons, recording settings and undo. */
#include "window/timeline/record_menu.h"
#include "window/timeline/timeline.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define ICON_WIDTH  30.0f
#define ICON_HEIGHT 30.0f
#define GAP         12.0f

typedef struct pen { /* drawing position along the strip */
    panel *self;
    ui *on;
    const ui_canvas *canvas;
    float x, y, end, undo; /* undo: x of the undo buttons */
    ui_rectangle record;   /* the record button: its menu is opened there */
    const char *hint;
    char words[400]; /* text of the hint */
} pen;

/* ---- buttons ---- */

static void set_hint(pen *p, const char *title, const char *help, const char *keys,
                     const char *why_not)
{
    (void)snprintf(p->words, sizeof p->words, "%s%s%s%s\n%s%s%s", title, keys[0] ? "  (" : "", keys,
                   keys[0] ? ")" : "", help, why_not[0] ? "\nNot now: " : "", why_not);
    p->hint = p->words;
}

typedef struct button {
    ui_rectangle box;
    uint32_t ink;
    bool is_pressed;
} button;

static button place_button(pen *p, const char *label, float width, bool is_on, bool can)
{
    button out = {.box = {p->x, p->y, width, ICON_HEIGHT}};
    bool is_hovered = ui_canvas_is_over(p->canvas, out.box);
    if (is_on)
        ui_draw_box(p->on, out.box, THEME_RAISED, 4.0f);
    else if (is_hovered && can)
        ui_draw_box(p->on, out.box, THEME_HOVER, 4.0f);
    out.ink = !can ? THEME_OFF : is_on ? THEME_ACCENT : THEME_TEXT;
    out.is_pressed = ui_canvas_button(p->on, p->canvas, label, out.box, can);
    p->x += width + 2.0f;
    return out;
}

/* Draws the sign of a button. x, y: centre of the button. */
typedef void paint_sign(ui *on, float x, float y, uint32_t ink);

static void sign_play(ui *on, float x, float y, uint32_t ink)
{
    const float corner[6] = {x - 5.0f, y - 7.0f, x + 8.0f, y, x - 5.0f, y + 7.0f};
    ui_draw_triangle(on, corner, ink);
}

static void sign_pause(ui *on, float x, float y, uint32_t ink)
{
    ui_draw_box(on, (ui_rectangle){x - 6.0f, y - 7.0f, 4.0f, 14.0f}, ink, 0.0f);
    ui_draw_box(on, (ui_rectangle){x + 2.0f, y - 7.0f, 4.0f, 14.0f}, ink, 0.0f);
}

static void sign_stop(ui *on, float x, float y, uint32_t ink)
{
    ui_draw_box(on, (ui_rectangle){x - 6.0f, y - 6.0f, 12.0f, 12.0f}, ink, 1.5f);
}

static void sign_record(ui *on, float x, float y, uint32_t ink)
{
    ui_draw_disc(on, x, y, 7.0f, ink == THEME_TEXT || ink == THEME_ACCENT ? THEME_RECORD : ink);
}

static void sign_frame_back(ui *on, float x, float y, uint32_t ink)
{
    const float corner[6] = {x + 5.0f, y - 5.0f, x - 3.0f, y, x + 5.0f, y + 5.0f};
    ui_draw_triangle(on, corner, ink);
    ui_draw_box(on, (ui_rectangle){x - 6.0f, y - 5.0f, 2.0f, 10.0f}, ink, 0.0f);
}

static void sign_frame_on(ui *on, float x, float y, uint32_t ink)
{
    const float corner[6] = {x - 5.0f, y - 5.0f, x + 3.0f, y, x - 5.0f, y + 5.0f};
    ui_draw_triangle(on, corner, ink);
    ui_draw_box(on, (ui_rectangle){x + 4.0f, y - 5.0f, 2.0f, 10.0f}, ink, 0.0f);
}

static void sign_loop(ui *on, float x, float y, uint32_t ink)
{
    const float head[6] = {x + 1.0f, y - 9.0f, x + 6.0f, y - 5.0f, x + 1.0f, y - 1.0f};
    ui_draw_frame(on, (ui_rectangle){x - 8.0f, y - 5.0f, 16.0f, 11.0f}, ink, 5.0f, 1.6f);
    ui_draw_triangle(on, head, ink);
}

static void sign_arrow(ui *on, float x, float y, float towards, uint32_t ink)
{
    float line[14];
    for (int i = 0; i < 7; ++i) {
        float angle = 3.14159f * ((float)i / 6.0f * 0.9f - 0.05f);
        line[2 * i] = x + towards * 6.0f * cosf(angle);
        line[2 * i + 1] = y + 3.0f - 6.0f * sinf(angle);
    }
    float tip = x - towards * 6.5f;
    const float head[6] = {tip - 4.0f, y + 1.0f, tip + 4.0f, y + 1.0f, tip, y + 7.0f};
    ui_draw_lines(on, line, 7, ink, 1.8f);
    ui_draw_triangle(on, head, ink);
}

static void sign_undo(ui *on, float x, float y, uint32_t ink)
{
    sign_arrow(on, x, y, 1.0f, ink);
}

static void sign_redo(ui *on, float x, float y, uint32_t ink)
{
    sign_arrow(on, x, y, -1.0f, ink);
}

static void action_hint(pen *p, action of, const char *why_not)
{
    const action_entry *entry = action_of(of);
    char keys[KEY_WORDS];
    key_map_words(&app_looks_of(p->self->app)->keys, of, keys);
    const char *step = of == ACTION_UNDO   ? app_undo_words(p->self->app)
                       : of == ACTION_REDO ? app_redo_words(p->self->app)
                                           : "";
    set_hint(p, entry->title, step[0] ? step : entry->help, keys, why_not);
}

/* Sets the hint of an action button and runs the action on a click. */
static void end_action(pen *p, action of, const button *b, bool can, const char *why_not)
{
    if (ui_canvas_is_over(p->canvas, b->box))
        action_hint(p, of, can || !why_not ? "" : why_not);
    if (b->is_pressed)
        app_do(p->self->app, of);
    if (of == ACTION_RECORD)
        p->record = b->box;
}

static void put_action(pen *p, action of, paint_sign *sign, bool is_on)
{
    const char *why_not = "";
    bool can = app_can(p->self->app, of, &why_not);
    button b = place_button(p, action_of(of)->title, ICON_WIDTH, is_on, can);
    sign(p->on, b.box.x + 0.5f * b.box.width, b.box.y + 0.5f * b.box.height, b.ink);
    end_action(p, of, &b, can, why_not);
}

/* Draws a word as a button. */
static button put_word(pen *p, const char *label, const char *word, bool can)
{
    float width = ui_text_width(p->on, UI_STYLE_BODY, word);
    button b = place_button(p, label, width + 14.0f, false, can);
    float y = b.box.y + 0.5f * (ICON_HEIGHT - ui_text_height(p->on, UI_STYLE_BODY));
    ui_draw_text(p->on, b.box.x + 7.0f, y, UI_STYLE_BODY, can ? b.ink : THEME_DIM, 0.0f, word);
    return b;
}

static void put_action_word(pen *p, action of, const char *word)
{
    const char *why_not = "";
    bool can = app_can(p->self->app, of, &why_not);
    button b = put_word(p, action_of(of)->title, word, can);
    end_action(p, of, &b, can, why_not);
}

/* Draws the button only if there is space. The key works in any case. */
static void put_word_with_room(pen *p, action of, const char *word)
{
    if (p->x + ui_text_width(p->on, UI_STYLE_BODY, word) + 16.0f < p->undo)
        put_action_word(p, of, word);
}

/* ---- contents of the strip ---- */

static void put_time(pen *p)
{
    const live_status *status = app_status(p->self->app);
    /* During a live recording the clock shows its time, not the selected take. */
    const bool is_live = status->is_recording && app_view(p->self->app)->mode == LIVE_PERFORMS;
    const take *t = is_live ? NULL : app_take(p->self->app);
    timeline_code code = timeline_code_of(t);
    char words[TIMECODE_TEXT];
    uint32_t ink = status->is_recording ? THEME_RECORD : t ? THEME_TEXT : THEME_DIM;
    int64_t at_ns = t ? timeline_head_ns(p->self) : status->recorded_ns;
    timeline_code_write(words, &code, t || status->is_recording ? at_ns : 0);
    timecode_rate rate;
    int64_t frame;
    if (!t && app_outside_code(p->self->app, &rate, &frame))
        timecode_write(words, rate, frame);
    else if (!t && !status->is_recording)
        words[0] = '\0'; /* the bar above already shows that the hands are live */
    float height = ui_text_height(p->on, UI_STYLE_LARGE);
    ui_draw_text(p->on, p->x, p->y + 0.5f * (ICON_HEIGHT - height), UI_STYLE_LARGE, ink, 0.0f,
                 words);
    float width = ui_text_width(p->on, UI_STYLE_LARGE, "00:00:00:00");
    float other = ui_text_width(p->on, UI_STYLE_LARGE, words);
    p->x += (other > width ? other : width) + GAP;
}

/* Draws the speed. In a narrow window it is drawn only if it is not 1, because keys can also change
 * it. */
static void put_speed(pen *p, double speed)
{
    char words[24];
    float words_width = ui_text_width(p->on, UI_STYLE_BODY, "Keep 30 sMark") + 40.0f;
    float width = ui_text_width(p->on, UI_STYLE_NUMBER, "0.25\u00d7");
    bool has_room = p->x + width + 70.0f + words_width < p->undo;
    if (!has_room && speed == 1.0)
        return;
    (void)snprintf(words, sizeof words, "%.3g\u00d7", speed);
    float own = ui_text_width(p->on, UI_STYLE_NUMBER, words);
    if (has_room)
        put_action_word(p, ACTION_SLOWER, "\u2212");
    ui_draw_text(p->on, p->x + 0.5f * (width - own), p->y + 7.0f, UI_STYLE_NUMBER,
                 app_take(p->self->app) ? THEME_TEXT : THEME_DIM, 0.0f, words);
    p->x += width + 2.0f;
    if (has_room)
        put_action_word(p, ACTION_FASTER, "+");
    p->x += GAP - 4.0f;
}

/* Draws the lead-in and click settings if there is space. */
static void put_lead_in(pen *p)
{
    const app_lead_in lead = app_lead_in_of(p->self->app);
    const live_click click = app_click(p->self->app);
    const bool clicks = click.when != LIVE_CLICK_OFF;
    char words[80] = "";
    if (lead.count_in_s > 0.0 && lead.preroll_s > 0.0)
        (void)snprintf(words, sizeof words, "%g s + %g s lead-in", lead.count_in_s, lead.preroll_s);
    else if (lead.count_in_s > 0.0)
        (void)snprintf(words, sizeof words, "Count-in %g s", lead.count_in_s);
    else if (lead.preroll_s > 0.0)
        (void)snprintf(words, sizeof words, "Pre-roll %g s", lead.preroll_s);
    const size_t used = strlen(words);
    if (clicks)
        (void)snprintf(words + used, sizeof words - used, "%sclick %.4g", used ? ", " : "",
                       click.bpm);
    const float width = ui_text_width(p->on, UI_STYLE_BODY, words);
    if (!words[0] || p->x + width + 16.0f >= p->undo)
        return;
    ui_draw_text(p->on, p->x + 7.0f, p->y + 6.0f, UI_STYLE_BODY, THEME_DIM, 0.0f, words);
    p->x += width + 14.0f;
}

static void put_transport(pen *p)
{
    const live *stage = app_live(p->self->app);
    const transport *move = live_transport(stage);
    bool is_playing = move && move->is_playing && !live_position(stage).has_stopped;
    bool is_recording = app_status(p->self->app)->is_recording;
    put_action(p, ACTION_RECORD, sign_record, is_recording);
    put_action(p, ACTION_PLAY, is_playing ? sign_pause : sign_play, is_playing);
    put_action(p, ACTION_STOP, sign_stop, false);
    put_action(p, ACTION_FRAME_BACK, sign_frame_back, false);
    put_action(p, ACTION_FRAME_FORWARD, sign_frame_on, false);
    put_action(p, ACTION_LOOP, sign_loop, move && move->is_looping);
    p->x += GAP - 6.0f;
    put_speed(p, move ? move->speed : 1.0);
    put_word_with_room(p, ACTION_KEEP, "Keep 30 s");
    put_word_with_room(p, ACTION_MARK, "Mark");
    put_lead_in(p);
}

/* Returns the width of the undo buttons at the right end. */
static float undo_width(const pen *p)
{
    return 2.0f * (ICON_WIDTH + 2.0f) + ui_text_width(p->on, UI_STYLE_BODY, "History") + 16.0f;
}

static void put_undo(pen *p)
{
    put_action(p, ACTION_UNDO, sign_undo, false);
    put_action(p, ACTION_REDO, sign_redo, false);
    const history *edits = app_history(p->self->app);
    button b = put_word(p, "History", "History", edits && history_last(edits) > 0);
    if (b.is_pressed)
        ui_dialog_open(p->on, "timeline_history");
    if (ui_canvas_is_over(p->canvas, b.box))
        set_hint(p, "History", "List all edits of this take. Click one to go to that state.", "",
                 "");
}

static void put_undo_words(pen *p, float end)
{
    const char *words = app_undo_words(p->self->app);
    float width = ui_text_width(p->on, UI_STYLE_BODY, words), room = end - p->x - 16.0f;
    if (room < 90.0f || !words[0])
        return;
    width = width < room ? width : room;
    ui_draw_text(p->on, end - width - 4.0f, p->y + 6.0f, UI_STYLE_BODY, THEME_DIM, width + 1.0f,
                 words);
}

void timeline_strip_draw(panel *self, ui *on, ui_rectangle where)
{
    ui_canvas canvas;
    ui_panel_begin(on, "timeline_strip", where, UI_GROUND_NONE);
    ui_canvas_begin(on, "strip", 0.0f, 0.0f, &canvas);
    ui_draw_box(on, where, THEME_PANEL, 0.0f);
    pen p = {.self = self,
             .on = on,
             .canvas = &canvas,
             .x = where.x + 12.0f,
             .y = where.y + 0.5f * (where.height - ICON_HEIGHT),
             .end = where.x + where.width - 10.0f,
             .hint = ""};
    p.undo = p.end - undo_width(&p);
    put_time(&p);
    put_transport(&p);
    p.x += GAP - 4.0f;
    put_undo_words(&p, p.undo);
    p.x = p.undo;
    put_undo(&p);
    ui_canvas_end(on);
    ui_hint(on, p.hint);
    if (canvas.is_pressed && canvas.button == 1 && ui_canvas_is_over(&canvas, p.record))
        record_menu_open(on, p.record.x, where.y);
    record_menu_draw(self->app, on);
    ui_panel_end(on);
}

/* ---- the list of edits ---- */

static void put_edit(panel *self, ui *on, const history *edits, int64_t n)
{
    char label[EDIT_TEXT + 40];
    const char *words = n == 0 ? "original recording" : history_words(edits, n);
    bool is_now = n == history_head(edits);
    (void)snprintf(label, sizeof label, "%s%s##%lld", words[0] ? words : "edit",
                   n > history_head(edits) ? "   (undone)" : "", (long long)n);
    if (ui_row(on, label, is_now) != UI_ROW_NONE && !is_now)
        (void)!app_history_go(self->app, n);
    if (is_now && self->is_asked_first)
        ui_scroll_to_end(on);
}

void timeline_history_dialog(panel *self, ui *on)
{
    enum { SHOWN = 400 };
    if (!ui_dialog_begin(on, "timeline_history", "Edits of this take", 460.0f))
        return;
    const history *edits = app_history(self->app);
    ui_scroll_begin(on, "edits", 0.0f, 300.0f);
    int64_t last = edits ? history_last(edits) : -1;
    for (int64_t n = last; n >= 0 && n > last - SHOWN; --n) {
        put_edit(self, on, edits, n);
        edits = app_history(self->app);
        if (!edits)
            break;
    }
    ui_scroll_end(on);
    ui_space(on, 8.0f);
    if (ui_button(on, "Close", UI_PLAIN))
        ui_dialog_close(on);
    ui_dialog_end(on);
}
