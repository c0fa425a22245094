#include "window/engine_panel_plot.h"

#include "window/engine_panel_words.h"
#include "window/theme.h"

#include <math.h>
#include <stdio.h>

static const float text_height = 15.0f;

static float height_of(const ui_rectangle *at, double ms, double top_ms)
{
    return at->y + at->height * (1.0f - (float)fmin(fmax(ms / top_ms, 0.0), 1.0));
}

static void draw_level(ui *on, const ui_rectangle *at, double ms, double top_ms, uint32_t colour)
{
    float y = height_of(at, ms, top_ms);
    ui_draw_line(on, at->x, y, at->x + at->width, y, colour, 1.0f);
}

static void draw_frames(ui *on, const ui_rectangle *at, const live_status *status, double top_ms,
                        double period_ms)
{
    float wide = at->width / (float)LIVE_HISTORY;
    uint32_t count = status->frame_count < LIVE_HISTORY ? status->frame_count : LIVE_HISTORY;
    for (uint32_t i = 0; i < count; ++i) {
        double ms = (double)status->frame_ms[i];
        float y = height_of(at, ms, top_ms);
        ui_rectangle bar = {at->x + wide * (float)(LIVE_HISTORY - count + i), y, fmaxf(wide, 0.75f),
                            at->y + at->height - y};
        ui_draw_box(on, bar, ms > period_ms ? THEME_BAD : THEME_GOOD, 0.0f);
    }
}

static void draw_legend(ui *on, const ui_rectangle *at, const live_status *status, double period_ms)
{
    static const char *const label[3] = {"p50", "p99", "of"};
    const double ms[3] = {status->frame_p50_ms, status->frame_p99_ms, period_ms};
    const uint32_t colour[3] = {THEME_TEXT, THEME_ACCENT, THEME_DIM};
    float x = at->x;
    for (int i = 0; i < 3; ++i) {
        char value[ENGINE_MS], words[ENGINE_MS + 8];
        engine_ms(value, ms[i]);
        (void)snprintf(words, sizeof words, "%s %s", label[i], value);
        ui_draw_text(on, x, at->y, UI_STYLE_BODY, colour[i], 0.0f, words);
        x += ui_text_width(on, UI_STYLE_BODY, words) + 14.0f;
    }
}

/* The period stands at four fifths of the height, unless frames need more than that. */
void engine_plot_draw(ui *on, const live_status *status, double period_ms, float height)
{
    ui_canvas at;
    double top_ms = fmax(1.25 * period_ms, 1.1 * status->frame_p99_ms);
    ui_canvas_begin(on, "frames", 0.0f, height + text_height + 6.0f, &at);
    const ui_rectangle plot = {at.where.x, at.where.y, at.where.width, height};
    const ui_rectangle legend = {at.where.x, at.where.y + height + 4.0f, at.where.width,
                                 text_height};
    ui_draw_box(on, plot, THEME_WELL, 2.0f);
    draw_frames(on, &plot, status, top_ms, period_ms);
    draw_level(on, &plot, period_ms, top_ms, THEME_DIM);
    draw_level(on, &plot, status->frame_p99_ms, top_ms, THEME_ACCENT);
    draw_level(on, &plot, status->frame_p50_ms, top_ms, THEME_TEXT);
    draw_legend(on, &legend, status, period_ms);
    ui_canvas_end(on);
}
