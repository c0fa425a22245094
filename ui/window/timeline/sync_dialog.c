/* The dialog "Sync of mouth and sound": both curves around the playhead, the offset, its scale. */
#include "window/timeline/timeline.h"

#include <math.h>
#include <stdio.h>

#define DIALOG_WIDTH  560.0f
#define CURVES_HEIGHT 130.0f
#define SCALE_HEIGHT  56.0f
#define MOUTH_COLOUR  THEME_ACCENT
#define VOICE_COLOUR  THEME_LEFT
#define VOICE_FILL    0x6fb3d950u
#define BAND_COLOUR   0x7fc48a50u

static const int64_t shown_ns = 3000000000; /* span of the curves */
static const double scale_ms = 200.0;       /* end of the scale, both ways */

static void measure(panel *self)
{
    int64_t from_ns, to_ns;
    const take *t = app_take(self->app);
    if (!t)
        return;
    if (!timeline_range(self, &from_ns, &to_ns)) {
        const int64_t last_ns = t->duration_ns > SYNC_SPAN_NS ? t->duration_ns - SYNC_SPAN_NS : 0;
        from_ns = timeline_head_ns(self) - SYNC_SPAN_NS / 2;
        from_ns = from_ns < 0 ? 0 : from_ns > last_ns ? last_ns : from_ns;
        to_ns = t->duration_ns;
    }
    (void)!app_sync_begin(self->app, from_ns, to_ns); /* the dialog shows why it failed */
}

void timeline_ask_sync(panel *self, ui *on)
{
    measure(self);
    ui_dialog_open(on, "timeline_sync");
}

static float greatest(const float *curve, uint32_t count)
{
    float most = 1e-3f;
    for (uint32_t i = 0; i < count; ++i)
        most = fmaxf(most, curve[i]);
    return most;
}

/* The mouth is drawn where it is now: moved_ns later than it was measured. */
static void draw_curves(panel *self, ui *on, const app_sync_found *found)
{
    const sync_curves *of = found->curves;
    const int64_t step_ns = INT64_C(1000000000) / SYNC_RATE;
    const int64_t most = shown_ns / step_ns, shift = found->moved_ns / step_ns;
    const int64_t head = (timeline_head_ns(self) - of->from_ns) / step_ns;
    const int64_t count = of->count < most ? of->count : most, last = of->count - count;
    const int64_t first = head - count / 2 < 0      ? 0
                          : head - count / 2 > last ? last
                                                    : head - count / 2;
    const float mouth_by = 1.0f / greatest(of->mouth, of->count);
    const float voice_by = 1.0f / greatest(of->voice, of->count);
    ui_canvas canvas;
    uint32_t drawn = 0;
    ui_canvas_begin(on, "curves", ui_available_width(on), CURVES_HEIGHT, &canvas);
    const ui_rectangle at = canvas.where;
    const float floor_y = at.y + at.height - 4.0f, height = at.height - 8.0f;
    ui_draw_box(on, at, THEME_WELL, 4.0f);
    for (int64_t i = 0; i < count; ++i) {
        const int64_t k = first + i - shift;
        self->column_x[i] = at.x + at.width * (float)i / (float)(count - 1);
        self->column_low[i] = floor_y;
        self->column_high[i] = floor_y - height * voice_by * of->voice[first + i];
        if (k < 0 || k >= of->count)
            continue;
        self->column_line[2 * drawn] = self->column_x[i];
        self->column_line[2 * drawn + 1] = floor_y - height * mouth_by * of->mouth[k];
        drawn += 1;
    }
    ui_draw_area(on, self->column_x, self->column_high, self->column_low, (uint32_t)count,
                 VOICE_FILL);
    for (int64_t i = 1; i < count; ++i)
        ui_draw_line(on, self->column_x[i - 1], self->column_high[i - 1], self->column_x[i],
                     self->column_high[i], VOICE_COLOUR, 1.0f);
    ui_draw_lines(on, self->column_line, drawn, MOUTH_COLOUR, 2.0f);
    if (head >= first && head < first + count)
        ui_draw_line(on, self->column_x[head - first], at.y, self->column_x[head - first],
                     at.y + at.height, TIMELINE_HEAD_COLOUR, 1.0f);
    ui_canvas_end(on);
    ui_label(on, "mouth", 60.0f, MOUTH_COLOUR, "Mouth");
    ui_same_line(on);
    ui_label(on, "voice", 60.0f, VOICE_COLOUR, "Voice");
    ui_next_line(on);
}

static float scale_x(ui_rectangle at, double late_ms)
{
    const double share = fmin(1.0, fmax(-1.0, late_ms / scale_ms));
    return at.x + 0.5f * at.width + (0.5f * at.width - 8.0f) * (float)share;
}

/* side: where the text lies from x: -1: to its right, 0: centred, 1: to its left. */
static void put_number(ui *on, float x, float y, float side, const char *text)
{
    const float width = ui_text_width(on, UI_STYLE_DIM, text);
    ui_draw_text(on, x - 0.5f * (side + 1.0f) * width, y, UI_STYLE_DIM, THEME_DIM, 0.0f, text);
}

static void draw_scale(ui *on, const app_sync_found *found)
{
    const double late_ms = 1e-6 * (double)(found->offset.late_ns + found->moved_ns);
    const double early_edge = -1e-6 * (double)SYNC_EARLY_NS,
                 late_edge = 1e-6 * (double)SYNC_LATE_NS;
    char text[32];
    ui_canvas canvas;
    ui_canvas_begin(on, "scale", ui_available_width(on), SCALE_HEIGHT, &canvas);
    const ui_rectangle at = canvas.where;
    const float y = at.y + 20.0f, under = y + 12.0f;
    const float early_x = scale_x(at, early_edge), late_x = scale_x(at, late_edge);
    ui_draw_box(on, (ui_rectangle){early_x, y - 8.0f, late_x - early_x, 16.0f}, BAND_COLOUR, 3.0f);
    ui_draw_line(on, scale_x(at, -scale_ms), y, scale_x(at, scale_ms), y, THEME_DIM, 1.0f);
    ui_draw_line(on, scale_x(at, 0.0), y - 8.0f, scale_x(at, 0.0), y + 8.0f, THEME_DIM, 1.0f);
    (void)snprintf(text, sizeof text, "%.0f early", scale_ms);
    put_number(on, scale_x(at, -scale_ms), under, -1.0f, text);
    (void)snprintf(text, sizeof text, "%.0f", -early_edge);
    put_number(on, early_x, under, 0.0f, text);
    put_number(on, scale_x(at, 0.0), under, 0.0f, "0 ms");
    (void)snprintf(text, sizeof text, "%.0f", late_edge);
    put_number(on, late_x, under, 0.0f, text);
    (void)snprintf(text, sizeof text, "%.0f late", scale_ms);
    put_number(on, scale_x(at, scale_ms), under, 1.0f, text);
    if (found->offset.is_clear) {
        const float x = scale_x(at, late_ms);
        const float mark[6] = {x - 7.0f, y - 18.0f, x + 7.0f, y - 18.0f, x, y - 4.0f};
        ui_draw_triangle(on, mark, MOUTH_COLOUR);
        ui_draw_line(on, x, y - 6.0f, x, y + 8.0f, MOUTH_COLOUR, 2.0f);
    }
    ui_canvas_end(on);
}

static void draw_found(panel *self, ui *on, const app_sync_found *found)
{
    char words[96];
    draw_curves(self, on, found);
    ui_space(on, 8.0f);
    ui_text_wrapped(on, UI_STYLE_STRONG, app_sync_result(self->app));
    (void)snprintf(words, sizeof words,
                   "People do not notice what is in the green band. %.1f s were compared.",
                   (double)found->curves->count / SYNC_RATE);
    if (found->offset.is_clear)
        draw_scale(on, found);
    ui_text_wrapped(
        on, UI_STYLE_DIM,
        found->offset.is_clear
            ? words
            : "Choose a range on the timeline in which the mouth speaks with the sound.");
    ui_space(on, 8.0f);
}

static void draw_buttons(panel *self, ui *on, const app_sync_found *found)
{
    char label[64];
    const double by_ms = found ? -1e-6 * (double)found->offset.late_ns : 0.0;
    if (found && found->offset.is_clear && found->moved_ns == 0 && fabs(by_ms) >= 0.5) {
        (void)snprintf(label, sizeof label, "Move the mouth by %+.0f ms", by_ms);
        if (ui_button(on, label, UI_ACCENT))
            (void)!app_sync_move(self->app); /* the news tell why it failed */
        ui_same_line(on);
    } else if (!found || found->moved_ns != 0) {
        if (ui_button(on, "Measure again", UI_PLAIN))
            measure(self);
        ui_same_line(on);
    }
    if (ui_button(on, "Close", UI_QUIET))
        ui_dialog_close(on);
}

void timeline_sync_dialog(panel *self, ui *on)
{
    if (!ui_dialog_begin(on, "timeline_sync", "Sync of mouth and sound", DIALOG_WIDTH))
        return;
    const double part = app_sync_part(self->app);
    const app_sync_found *found = app_sync_of(self->app);
    if (part >= 0.0) {
        char words[64];
        (void)snprintf(words, sizeof words, "Comparing mouth and voice, %.0f %%", 100.0 * part);
        ui_text(on, UI_STYLE_DIM, words);
        if (ui_button(on, "Cancel", UI_QUIET))
            app_sync_cancel(self->app);
        ui_want_frame(on, 0.05);
    } else {
        if (found)
            draw_found(self, on, found);
        else
            ui_text_wrapped(on, UI_STYLE_BODY, app_sync_result(self->app));
        draw_buttons(self, on, found);
    }
    ui_dialog_end(on);
}
