#include "window/timeline_state.h"

#define FLAG_MOST 110.0f

/* ---- ticks ---- */

static void paint_ticks(panel *self, ui *on)
{
    static const float label_height = 16.0f;
    timeline_tick tick[TIMELINE_TICKS_MAX];
    timeline_code code = timeline_code_now(self);
    uint32_t count = timeline_ticks(tick, &self->axis, &code, 104.0f);
    float top = self->rows.y + TIMELINE_RANGE_HEIGHT, bottom = self->rows.lanes_y;
    float end = self->axis.x + self->axis.width;
    for (uint32_t i = 0; i < count; ++i) {
        float x = timeline_axis_x(&self->axis, tick[i].at_ns);
        float length = tick[i].is_major ? bottom - top - 2.0f : 4.0f;
        if (x >= self->axis.x)
            ui_draw_line(on, x, bottom - length, x, bottom,
                         tick[i].is_major ? 0x4a5058ffu : THEME_RULE, 1.0f);
        if (tick[i].is_major &&
            x + 5.0f + ui_text_width(on, UI_STYLE_NUMBER, tick[i].label) < end &&
            x >= self->axis.x - 4.0f)
            ui_draw_text(on, x + 5.0f, bottom - label_height - 4.0f, UI_STYLE_NUMBER, THEME_DIM,
                         0.0f, tick[i].label);
    }
}

/* ---- range ---- */

static void paint_handle(ui *on, float x, float y, float height, float towards, uint32_t colour)
{
    const float flag[6] = {x, y, x + towards * 7.0f, y, x, y + 8.0f};
    ui_draw_line(on, x, y, x, y + height, colour, 1.5f);
    ui_draw_triangle(on, flag, colour);
}

static void paint_range(panel *self, ui *on)
{
    int64_t in_ns, out_ns;
    if (!timeline_range(self, &in_ns, &out_ns))
        return;
    const transport *move = live_transport(studio_live(self->studio));
    uint32_t colour = move && move->is_looping ? THEME_ACCENT : THEME_DIM;
    float x0 = timeline_axis_x(&self->axis, in_ns), x1 = timeline_axis_x(&self->axis, out_ns);
    ui_rectangle band = {x0, self->rows.y, x1 - x0, TIMELINE_RANGE_HEIGHT};
    ui_draw_box(on, band, TIMELINE_RANGE_COLOUR, 0.0f);
    paint_handle(on, x0, self->rows.y, TIMELINE_RANGE_HEIGHT, 1.0f, colour);
    paint_handle(on, x1, self->rows.y, TIMELINE_RANGE_HEIGHT, -1.0f, colour);
}

/* ---- markers ---- */

static void paint_marker(panel *self, ui *on, const take *t, uint32_t index, float room)
{
    const take_marker *marker = &t->marker[index];
    float x = timeline_axis_x(&self->axis, marker->at_ns), y = self->rows.y;
    bool is_chosen = studio_chosen(self->studio)->marker == (int32_t)index;
    uint32_t colour = is_chosen ? THEME_ACCENT : 0x9fb58affu;
    const float flag[6] = {x, y + 3.0f, x + 8.0f, y + 7.0f, x, y + 11.0f};
    ui_draw_line(on, x, y + 3.0f, x, self->rows.y + self->rows.height,
                 is_chosen ? 0xd9a44166u : 0x9fb58a38u, 1.0f);
    ui_draw_triangle(on, flag, colour);
    float width = room < FLAG_MOST ? room : FLAG_MOST;
    if (marker->text[0] && width > 34.0f)
        ui_draw_text(on, x + 11.0f, y, UI_STYLE_BODY, is_chosen ? THEME_ACCENT : THEME_DIM,
                     width - 14.0f, marker->text);
}

static void paint_markers(panel *self, ui *on, const take *t)
{
    float end = self->axis.x + self->axis.width;
    for (uint32_t i = 0; i < t->marker_count; ++i) {
        float x = timeline_axis_x(&self->axis, t->marker[i].at_ns);
        float next =
            i + 1 < t->marker_count ? timeline_axis_x(&self->axis, t->marker[i + 1].at_ns) : end;
        if (x > end)
            return;
        if (x >= self->axis.x - FLAG_MOST)
            paint_marker(self, on, t, i, (next < end ? next : end) - x);
    }
}

/* ---- */

void timeline_paint_ruler(panel *self, ui *on)
{
    const take *t = timeline_take(self);
    ui_rectangle all = {self->rows.x, self->rows.y, self->rows.width, TIMELINE_RULER_HEIGHT};
    ui_rectangle time = {self->axis.x, self->rows.y, self->axis.width, self->rows.height};
    ui_draw_box(on, all, THEME_BAR, 0.0f);
    ui_draw_line(on, all.x, self->rows.lanes_y, all.x + all.width, self->rows.lanes_y, THEME_RULE,
                 1.0f);
    ui_clip_begin(on, time);
    paint_ticks(self, on);
    paint_range(self, on);
    if (t)
        paint_markers(self, on, t);
    ui_clip_end(on);
}

void timeline_paint_head(panel *self, ui *on)
{
    float x = timeline_axis_x(&self->axis, timeline_head_ns(self));
    float y = self->rows.y + TIMELINE_RANGE_HEIGHT;
    ui_rectangle time = {self->axis.x - 7.0f, self->rows.y, self->axis.width + 14.0f,
                         self->rows.height};
    if (x < self->axis.x - 1.0f || x > self->axis.x + self->axis.width + 1.0f)
        return;
    const float cap[6] = {x - 6.0f, y, x + 6.0f, y, x, y + 9.0f};
    ui_clip_begin(on, time);
    ui_draw_line(on, x, y, x, self->rows.y + self->rows.height, TIMELINE_HEAD_COLOUR, 1.5f);
    ui_draw_triangle(on, cap, TIMELINE_HEAD_COLOUR);
    ui_clip_end(on);
}
