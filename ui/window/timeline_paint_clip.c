#include "window/timeline_state.h"

#include <math.h>
#include <stdio.h>

#define AFAR_NS 400e6 /* of a bin */
#define BASE    3.0f  /* of a curve, above the lower edge */
#define HIGHEST 0.86f /* of a curve, as a share of the clip */

typedef struct look {
    uint32_t ground, curve, fill;
} look;

static look look_of(const take_clip *clip, bool is_heard)
{
    if (clip->is_muted || !is_heard)
        return (look){TIMELINE_MUTED_CLIP, TIMELINE_MUTED_CURVE, TIMELINE_MUTED_FILL};
    return (look){TIMELINE_CLIP_COLOUR, TIMELINE_CURVE_COLOUR, TIMELINE_CURVE_FILL};
}

/* ---- the curve ---- */

/* Small movements are seen, large ones fit: a whole face that speaks is at 0.05 to 0.25. */
static float height_of(float value)
{
    return 1.0f - expf(-7.0f * value);
}

static float place(const panel *self, const take_layer *lane, const take_clip *clip,
                   int64_t show_ns)
{
    int64_t at_ns = take_warp_to_timeline(clip, show_ns - clip->from_ns);
    return timeline_axis_x(&self->axis, at_ns + lane->offset_ns);
}

/* From afar a line would only be noise: how far it goes always is brighter. */
static void flush(panel *self, ui *on, uint32_t count, look as, bool is_afar)
{
    if (count < 2)
        return;
    ui_draw_area(on, self->column_x, self->column_low, self->column_high, count, as.fill);
    if (is_afar)
        ui_draw_area(on, self->column_x, self->column_low, self->column_least, count, as.fill);
    else
        ui_draw_lines(on, self->column_line, count, as.curve, 1.0f);
}

static void paint_curve(panel *self, ui *on, timeline_box box, const take_layer *lane,
                        const take_clip *clip, const timeline_strip *strip, look as)
{
    const activity_bin *bin = self->seen->bin + strip->first_bin;
    float low = box.y + box.height - BASE, high = (box.height - BASE) * HIGHEST;
    double step_ns = (double)(strip->to_ns - strip->from_ns) / strip->bin_count;
    float gain = (float)(clip->gain * lane->gain);
    uint32_t count = 0;
    for (uint32_t i = 0; i < strip->bin_count && count < TIMELINE_COLUMNS_MAX; ++i) {
        if (bin[i].least > bin[i].greatest) {
            flush(self, on, count, as, step_ns > AFAR_NS);
            count = 0;
            continue;
        }
        int64_t show_ns = strip->from_ns + (int64_t)((i + 0.5) * step_ns);
        float x = place(self, lane, clip, show_ns);
        float y = low - high * height_of(bin[i].greatest * gain);
        self->column_x[count] = x;
        self->column_low[count] = low;
        self->column_high[count] = y;
        self->column_least[count] = low - high * height_of(bin[i].least * gain);
        self->column_line[2 * count] = x;
        self->column_line[2 * count + 1] = y;
        count += 1;
    }
    flush(self, on, count, as, step_ns > AFAR_NS);
}

/* ---- fades: what they take away is dark ---- */

static void paint_fades(panel *self, ui *on, timeline_box box, const take_clip *clip)
{
    float in = (float)((double)clip->fade_in_ns / self->axis.ns_per_point);
    float out = (float)((double)clip->fade_out_ns / self->axis.ns_per_point);
    float right = box.x + box.width, bottom = box.y + box.height;
    if (in > 0.5f) {
        const float corner[6] = {box.x, box.y, box.x + in, box.y, box.x, bottom};
        ui_draw_triangle(on, corner, TIMELINE_SHADE);
        ui_draw_line(on, box.x, bottom, box.x + in, box.y, THEME_TEXT, 1.0f);
    }
    if (out > 0.5f) {
        const float corner[6] = {right - out, box.y, right, box.y, right, bottom};
        ui_draw_triangle(on, corner, TIMELINE_SHADE);
        ui_draw_line(on, right - out, box.y, right, bottom, THEME_TEXT, 1.0f);
    }
}

static void paint_handles(panel *self, ui *on, timeline_box box, const take_clip *clip)
{
    float in = (float)((double)clip->fade_in_ns / self->axis.ns_per_point);
    float out = (float)((double)clip->fade_out_ns / self->axis.ns_per_point);
    if (box.width < 44.0f)
        return;
    ui_draw_disc(on, box.x + (in > 4.0f ? in : 4.0f), box.y + 4.0f, 3.0f, THEME_TEXT);
    ui_draw_disc(on, box.x + box.width - (out > 4.0f ? out : 4.0f), box.y + 4.0f, 3.0f, THEME_TEXT);
}

/* ---- words: only what is not as it was recorded ---- */

static double speed_of(const take_clip *clip)
{
    int64_t source_ns =
        take_warp_to_source(clip, clip->end_ns) - take_warp_to_source(clip, clip->start_ns);
    return (double)source_ns / (double)(clip->end_ns - clip->start_ns);
}

static void write_words(char *out, size_t capacity, const take_clip *clip)
{
    double speed = speed_of(clip);
    int used = 0;
    out[0] = '\0';
    if (clip->is_muted)
        used += snprintf(out, capacity, "muted  ");
    if (clip->warp_count > 1 && fabs(speed - 1.0) > 0.004)
        used += snprintf(out + used, capacity - (size_t)used, "%.*f\u00d7  ", speed < 10.0 ? 2 : 0,
                         speed);
    if (clip->gain != 1.0)
        used += snprintf(out + used, capacity - (size_t)used, "%.0f %%  ", clip->gain * 100.0);
    if (clip->smooth_s > 0.0)
        (void)snprintf(out + used, capacity - (size_t)used, "smooth %.0f ms",
                       clip->smooth_s * 1000.0);
}

static void paint_words(panel *self, ui *on, timeline_box box, const take_clip *clip)
{
    char words[96];
    float x = box.x < self->axis.x ? self->axis.x : box.x;
    float right = box.x + box.width, end = self->axis.x + self->axis.width;
    float fade = box.x + (float)((double)clip->fade_in_ns / self->axis.ns_per_point);
    x = fade > x && clip->fade_in_ns > 0 ? fade : x;
    float width = (right < end ? right : end) - x - 18.0f;
    write_words(words, sizeof words, clip);
    if (words[0] && ui_text_width(on, UI_STYLE_BODY, words) < width)
        ui_draw_text(on, x + 10.0f, box.y + 3.0f, UI_STYLE_BODY, THEME_TEXT, width, words);
}

/* ---- all of it ---- */

static timeline_box seen_part(const panel *self, timeline_box box)
{
    float left = self->axis.x - 20.0f, right = self->axis.x + self->axis.width + 20.0f;
    float x0 = box.x < left ? left : box.x;
    float x1 = box.x + box.width > right ? right : box.x + box.width;
    return (timeline_box){x0, box.y, x1 - x0, box.height};
}

void timeline_paint_clip(panel *self, ui *on, timeline_box box, const take_layer *lane,
                         const take_clip *clip, uint32_t owner, bool is_heard)
{
    const studio_choice *choice = studio_chosen(self->studio);
    bool is_chosen = owner == 0 && choice->clip == clip->id;
    look as = look_of(clip, is_heard);
    timeline_box part = seen_part(self, box);
    if (part.width <= 0.0f)
        return;
    ui_rectangle where = {part.x, part.y, part.width < 1.0f ? 1.0f : part.width, part.height};
    ui_draw_box(on, where, as.ground, 3.0f);
    const timeline_strip *strip = timeline_seen_strip(self->seen, owner, clip->id);
    ui_clip_begin(on, where);
    if (strip && strip->performance == clip->performance)
        paint_curve(self, on, box, lane, clip, strip, as);
    paint_fades(self, on, box, clip);
    ui_clip_end(on);
    if (owner)
        return;
    paint_words(self, on, box, clip);
    ui_draw_frame(on, where, is_chosen ? THEME_ACCENT : THEME_RULE, 3.0f, is_chosen ? 1.5f : 1.0f);
    if (is_chosen)
        paint_handles(self, on, box, clip);
}

/* Where two clips share an instant: both slopes. */
void timeline_paint_overlaps(panel *self, ui *on, const timeline_row *row, const take_layer *lane)
{
    uint32_t first = timeline_first_clip(lane, self->axis.from_ns);
    int64_t until_ns = timeline_axis_until_ns(&self->axis);
    for (uint32_t i = first > 0 ? first : 1; i < lane->clip_count; ++i) {
        const take_clip *before = &lane->clip[i - 1], *after = &lane->clip[i];
        if (after->start_ns + lane->offset_ns > until_ns)
            return;
        if (after->start_ns >= before->end_ns || before->is_muted || after->is_muted)
            continue;
        float x0 = timeline_axis_x(&self->axis, after->start_ns + lane->offset_ns);
        float x1 = timeline_axis_x(&self->axis, before->end_ns + lane->offset_ns);
        float top = row->y + 3.0f, bottom = row->y + row->height - 3.0f;
        ui_rectangle where = {x0, top, x1 - x0, bottom - top};
        ui_draw_box(on, where, 0x0d0f1166u, 0.0f);
        ui_draw_line(on, x0, top, x1, bottom, THEME_TEXT, 1.0f);
        ui_draw_line(on, x0, bottom, x1, top, THEME_TEXT, 1.0f);
    }
}
