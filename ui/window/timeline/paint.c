/* Draws a take: the corner left of the ruler, the ruler, and a row for each layer, for the sound
 * and for each take to comp from. */
#include "window/timeline/timeline.h"

#include <math.h>
#include <stdio.h>

#define HEIGHT 18.0f

/* Dark enough for the curve and the words on it, and apart from the accent, which is what is
 * chosen.
 */
const timeline_colour timeline_colours[TAKE_COLOURS] = {
    [TAKE_COLOUR_NONE] = {"No colour", 0x2c3a41ffu, TIMELINE_CURVE_COLOUR},
    [TAKE_COLOUR_RED] = {"Red", 0x4a2f31ffu, 0xd98a88ffu},
    [TAKE_COLOUR_ORANGE] = {"Orange", 0x4a3628ffu, 0xdb9c70ffu},
    [TAKE_COLOUR_YELLOW] = {"Yellow", 0x42402affu, 0xc9c074ffu},
    [TAKE_COLOUR_GREEN] = {"Green", 0x2d4232ffu, 0x86bf8effu},
    [TAKE_COLOUR_TEAL] = {"Teal", 0x24423fffu, 0x6fc2b6ffu},
    [TAKE_COLOUR_BLUE] = {"Blue", 0x2b3b56ffu, 0x84a9e4ffu},
    [TAKE_COLOUR_VIOLET] = {"Violet", 0x3c3152ffu, 0xb099dfffu},
};

typedef struct switch_row { /* position in a row of switches in the corner */
    ui *on;
    const ui_canvas *canvas;
    float x, y;
} switch_row;

/* Draws a switch as a small word. Returns true if it was clicked. */
static bool put_word(switch_row *p, const char *word, float width, bool is_on, bool is_bright,
                     bool *out_over)
{
    float text = ui_text_width(p->on, UI_STYLE_BODY, word);
    ui_rectangle box = {p->x, p->y, width > 0.0f ? width : text + 12.0f, HEIGHT};
    *out_over = ui_canvas_is_over(p->canvas, box);
    uint32_t ground = is_on && is_bright ? THEME_ACCENT : is_on ? THEME_RAISED : THEME_BAR;
    uint32_t ink = is_on && is_bright ? THEME_STAGE : is_on ? THEME_TEXT : THEME_DIM;
    if (!is_on && *out_over)
        ground = THEME_HOVER;
    ui_draw_box(p->on, box, ground, 4.0f);
    ui_draw_text(p->on, box.x + 0.5f * (box.width - text), box.y, UI_STYLE_BODY, ink, 0.0f, word);
    p->x += box.width + 3.0f;
    return *out_over && p->canvas->is_pressed && p->canvas->button == 0;
}

static void put_switch(panel *self, switch_row *p, const char *word, const char *help, bool *value)
{
    bool is_over;
    if (put_word(p, word, 0.0f, *value, false, &is_over))
        *value = !*value;
    if (is_over)
        self->hint = help;
}

/* Draws the switch of an action, bright while what follows ripples. */
static void put_action(panel *self, switch_row *p, action of, bool is_on, bool is_bright)
{
    bool is_over;
    if (put_word(p, action_of(of)->title, 0.0f, is_on, is_bright, &is_over))
        app_do(self->app, of);
    if (!is_over)
        return;
    char keys[KEY_WORDS];
    key_map_words(&app_looks_of(self->app)->keys, of, keys);
    (void)snprintf(self->hint_words, sizeof self->hint_words, "%s%s%s%s\n%s", action_of(of)->title,
                   keys[0] ? "  (" : "", keys, keys[0] ? ")" : "", action_of(of)->help);
    self->hint = self->hint_words;
}

static void put_regions(panel *self, switch_row *p)
{
    static const char *const letter[OWN_REGION_COUNT] = {"M", "J", "B", "L", "E", "C", "N", "H"};
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        bool is_on = (self->regions & 1u << region) != 0, is_over;
        if (put_word(p, letter[region], 18.0f, is_on, true, &is_over) &&
            self->regions != 1u << region)
            self->regions ^= 1u << region;
        if (is_over)
            self->hint = own_part_of((own_region)region)->name;
    }
}

/* Writes the name of the take. If less than a frame is visible, writes the timecode of the left
 * end, because the labels of the ruler then lack it. */
static void put_name(panel *self, switch_row *p, const take *t)
{
    timeline_code code = timeline_code_now(self);
    char words[TIMECODE_TEXT];
    double frame_ns = 1e9 * code.rate.den / code.rate.num;
    bool is_within = frame_ns >= 0.5 * self->axis.ns_per_point * (double)self->axis.width;
    timeline_code_write(words, &code, self->axis.from_ns);
    if (is_within)
        ui_draw_text(p->on, p->x + 6.0f, p->y, UI_STYLE_NUMBER, THEME_DIM, 0.0f, words);
    else
        ui_draw_text(p->on, p->x + 6.0f, p->y, UI_STYLE_BODY, THEME_DIM,
                     TIMELINE_HEAD_WIDTH - 20.0f, t->name[0] ? t->name : "");
}

void timeline_paint_corner(panel *self, ui *on, const ui_canvas *canvas)
{
    switch_row p = {.on = on, .canvas = canvas, .x = self->rows.x + 4.0f, .y = self->rows.y + 2.0f};
    const app_looks *looks = app_looks_of(self->app);
    put_action(self, &p, ACTION_SNAP, looks->is_snapping, false);
    put_action(self, &p, ACTION_RIPPLE, looks->is_rippling, true);
    put_switch(self, &p, "Follow", "Scroll the timeline with the playhead.", &self->is_following);
    put_switch(self, &p, "Takes",
               "Show other takes of the same slate below. Swipe their best passes into this take.",
               &self->has_comps);
    p.x = self->rows.x + 4.0f;
    p.y += HEIGHT + 2.0f;
    if (self->has_comps)
        put_regions(self, &p);
    else
        put_name(self, &p, app_take(self->app));
}

/* ---- the ruler ---- */

#define FLAG_MOST 110.0f

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
    const transport *move = live_transport(app_live(self->app));
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
    bool is_chosen = app_chosen(self->app)->marker == (int32_t)index;
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

void timeline_paint_over(panel *self, ui *on)
{
    const float from = timeline_axis_x(&self->axis, self->over_from_ns);
    const float to = timeline_axis_x(&self->axis, timeline_head_ns(self));
    const ui_rectangle time = {self->axis.x, self->rows.lanes_y, self->axis.width,
                               self->rows.y + self->rows.height - self->rows.lanes_y};
    if (self->over_from_ns < 0 || to <= from)
        return;
    ui_clip_begin(on, time);
    ui_draw_box(on, (ui_rectangle){from, time.y, to - from, time.height}, TIMELINE_OVER_COLOUR,
                0.0f);
    ui_draw_box(on, (ui_rectangle){from, time.y, to - from, 3.0f}, THEME_RECORD, 0.0f);
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

/* ---- the sound ---- */

/* Compresses the amplitude, so that quiet sound is visible. */
static float swing(float value)
{
    float size = sqrtf(fminf(fabsf(value), 1.0f));
    return value < 0.0f ? -size : size;
}

static int64_t frame_ns(const show_audio *about, int64_t frame)
{
    return (int64_t)((double)frame * 1e9 / about->rate_hz);
}

/* Returns the rectangle of the untrimmed part of the sound. */
static ui_rectangle body_of(const panel *self, const timeline_row *row, const take *t)
{
    const show_audio *about = &self->result->about;
    const int64_t sound_ns = frame_ns(about, about->frame_count);
    float x0 = timeline_axis_x(&self->axis, timeline_sound_start_ns(&t->audio));
    float x1 = timeline_axis_x(&self->axis, timeline_sound_end_ns(&t->audio, sound_ns));
    float left = self->axis.x - 20.0f, right = self->axis.x + self->axis.width + 20.0f;
    x0 = x0 < left ? left : x0;
    x1 = x1 > right ? right : x1;
    return (ui_rectangle){x0, row->y + 2.0f, x1 > x0 ? x1 - x0 : 0.0f, row->height - 4.0f};
}

static void paint_wave(panel *self, ui *on, const timeline_row *row, const take *t)
{
    const timeline_result *result = self->result;
    if (result->audio != t->audio.audio || result->about.rate_hz == 0)
        return;
    const ui_rectangle body = body_of(self, row, t);
    if (body.width > 0.0f)
        ui_draw_box(on, body, 0x272631ffu, 3.0f);
    if (!result->has_wave)
        return;
    float middle = row->y + 0.5f * row->height, half = 0.5f * row->height - 5.0f;
    float gain = (float)t->audio.gain;
    uint32_t count = 0;
    for (size_t i = 0; i < result->wave.count && count < TIMELINE_COLUMNS_MAX; ++i) {
        int64_t frame = result->wave.first_frame + (int64_t)i * result->wave.frames_per_pair;
        float low = middle - half * swing(result->wave.pair[i].least * gain);
        float high = middle - half * swing(result->wave.pair[i].greatest * gain);
        if (low - high < 1.0f) {
            low = 0.5f * (low + high) + 0.5f;
            high = low - 1.0f;
        }
        self->column_x[count] =
            timeline_axis_x(&self->axis, t->audio.offset_ns + frame_ns(&result->about, frame));
        self->column_low[count] = low;
        self->column_high[count] = high;
        count += 1;
    }
    if (count < 2)
        return;
    ui_draw_area(on, self->column_x, self->column_low, self->column_high, count,
                 TIMELINE_WAVE_TRIMMED);
    ui_clip_begin(on, body);
    ui_draw_area(on, self->column_x, self->column_low, self->column_high, count,
                 TIMELINE_WAVE_COLOUR);
    ui_clip_end(on);
}

/* ---- clips ---- */

#define AFAR_NS 400e6 /* length of a bin above which the curve is drawn as an area */
#define BASE    3.0f  /* distance of a curve from the lower edge */
#define HIGHEST 0.86f /* maximum height of a curve, share of the clip */

typedef struct look {
    uint32_t ground, curve, fill;
} look;

static look look_of(const take_layer *lane, const take_clip *clip, bool is_heard)
{
    const timeline_colour *of = &timeline_colours[clip->colour ? clip->colour : lane->colour];
    if (clip->is_muted || !is_heard)
        return (look){TIMELINE_MUTED_CLIP, TIMELINE_MUTED_CURVE, TIMELINE_MUTED_FILL};
    return (look){of->ground, of->curve, (of->curve & ~0xffu) | TIMELINE_FILL_ALPHA};
}

/* ---- the curve ---- */

/* Compresses the movement, so that small movements are visible and large ones fit. A speaking face
 * is at 0.05 to 0.25. */
static float height_of(float value)
{
    return 1.0f - expf(-7.0f * value);
}

static float clip_x(const panel *self, const take_layer *lane, const take_clip *clip,
                    int64_t show_ns)
{
    int64_t at_ns = take_warp_to_timeline(clip, show_ns - clip->from_ns);
    return timeline_axis_x(&self->axis, at_ns + lane->offset_ns);
}

/* Draws a curve. When zoomed out, a line would be noise, so the minimum of each column is drawn
 * brighter instead. */
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

static void paint_curve(panel *self, ui *on, ui_rectangle box, const take_layer *lane,
                        const take_clip *clip, const timeline_strip *strip, look as)
{
    const activity_bin *bin = self->result->bin + strip->first_bin;
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
        float x = clip_x(self, lane, clip, show_ns);
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

/* ---- fades: the faded part is dark ---- */

static void paint_fades(panel *self, ui *on, ui_rectangle box, const take_clip *clip)
{
    float in = timeline_axis_points(&self->axis, clip->fade_in_ns);
    float out = timeline_axis_points(&self->axis, clip->fade_out_ns);
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

static void paint_handles(panel *self, ui *on, ui_rectangle box, const take_clip *clip)
{
    float in = timeline_axis_points(&self->axis, clip->fade_in_ns);
    float out = timeline_axis_points(&self->axis, clip->fade_out_ns);
    if (box.width < 44.0f)
        return;
    ui_draw_disc(on, box.x + (in > 4.0f ? in : 4.0f), box.y + 4.0f, 3.0f, THEME_TEXT);
    ui_draw_disc(on, box.x + box.width - (out > 4.0f ? out : 4.0f), box.y + 4.0f, 3.0f, THEME_TEXT);
}

/* ---- text: only values that differ from the recording ---- */

static void write_words(char *out, size_t capacity, const take_clip *clip)
{
    double speed = timeline_clip_speed(clip);
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

static void paint_words(panel *self, ui *on, ui_rectangle box, const take_clip *clip)
{
    char words[96];
    float x = box.x < self->axis.x ? self->axis.x : box.x;
    float right = box.x + box.width, end = self->axis.x + self->axis.width;
    float fade = box.x + timeline_axis_points(&self->axis, clip->fade_in_ns);
    x = fade > x && clip->fade_in_ns > 0 ? fade : x;
    float width = (right < end ? right : end) - x - 18.0f;
    write_words(words, sizeof words, clip);
    if (words[0] && ui_text_width(on, UI_STYLE_BODY, words) < width)
        ui_draw_text(on, x + 10.0f, box.y + 3.0f, UI_STYLE_BODY, THEME_TEXT, width, words);
}

/* ---- whole clips ---- */

static ui_rectangle visible_part(const panel *self, ui_rectangle box)
{
    float left = self->axis.x - 20.0f, right = self->axis.x + self->axis.width + 20.0f;
    float x0 = box.x < left ? left : box.x;
    float x1 = box.x + box.width > right ? right : box.x + box.width;
    return (ui_rectangle){x0, box.y, x1 - x0, box.height};
}

static void paint_clip(panel *self, ui *on, ui_rectangle box, const take_layer *lane,
                       const take_clip *clip, uint32_t owner, bool is_heard)
{
    const app_choice *choice = app_chosen(self->app);
    bool is_chosen = owner == 0 && choice->clip == clip->id;
    look as = look_of(lane, clip, is_heard);
    ui_rectangle where = visible_part(self, box);
    if (where.width <= 0.0f)
        return;
    where.width = where.width < 1.0f ? 1.0f : where.width;
    ui_draw_box(on, where, as.ground, 3.0f);
    const timeline_strip *strip = timeline_result_strip(self->result, owner, clip->id);
    ui_clip_begin(on, where);
    if (strip && strip->performance == clip->performance && strip->part == clip->part)
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

/* Draws both slopes where two clips overlap. */
static void paint_overlaps(panel *self, ui *on, const timeline_row *row, const take_layer *lane)
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

/* ---- heads ---- */

static void paint_switch(ui *on, ui_rectangle box, const char *letter, bool is_on, uint32_t colour)
{
    float width = ui_text_width(on, UI_STYLE_BODY, letter);
    ui_draw_box(on, box, is_on ? colour : THEME_RAISED, 4.0f);
    ui_draw_text(on, box.x + 0.5f * (box.width - width), box.y, UI_STYLE_BODY,
                 is_on ? THEME_STAGE : THEME_DIM, 0.0f, letter);
}

static void paint_gain(panel *self, ui *on, const timeline_row *row, double gain)
{
    ui_rectangle box = timeline_gain_box(&self->rows, row);
    char words[24];
    (void)snprintf(words, sizeof words, "%.0f %%", gain * 100.0);
    float width = ui_text_width(on, UI_STYLE_NUMBER, words);
    float share = (float)(gain / 2.0), y = box.y + box.height - 2.0f;
    share = share > 1.0f ? 1.0f : share;
    ui_draw_box(on, box, THEME_WELL, 4.0f);
    ui_draw_box(on, (ui_rectangle){box.x, y, box.width * share, 2.0f},
                gain == 1.0 ? 0x4a5058ffu : THEME_ACCENT, 1.0f);
    ui_draw_text(on, box.x + box.width - width - 5.0f, box.y, UI_STYLE_NUMBER,
                 gain == 1.0 ? THEME_DIM : THEME_TEXT, 0.0f, words);
}

static void paint_layer_head(panel *self, ui *on, const timeline_row *row, const take_layer *lane)
{
    const app_choice *choice = app_chosen(self->app);
    char own[160];
    timeline_own_words(lane, own, sizeof own);
    float x = self->rows.x + 8.0f, width = TIMELINE_HEAD_WIDTH - 16.0f;
    float name = ui_text_width(on, UI_STYLE_STRONG, lane->name);
    float most = 0.62f * width;
    name = name < most ? name : most;
    if (lane->colour)
        ui_draw_box(on, (ui_rectangle){self->rows.x, row->y, 3.0f, row->height},
                    timeline_colours[lane->colour].curve, 0.0f);
    ui_draw_text(on, x, row->y + 4.0f, UI_STYLE_STRONG,
                 lane->is_muted              ? THEME_DIM
                 : choice->layer == lane->id ? THEME_ACCENT
                                             : THEME_TEXT,
                 name + 1.0f, lane->name);
    ui_draw_text(on, x + name + 8.0f, row->y + 4.0f, UI_STYLE_BODY, THEME_DIM, width - name - 8.0f,
                 own);
    paint_switch(on, timeline_switch_box(&self->rows, row, 0), "M", lane->is_muted, THEME_DIM);
    paint_switch(on, timeline_switch_box(&self->rows, row, 1), "S", lane->is_solo, THEME_ACCENT);
    paint_switch(on, timeline_switch_box(&self->rows, row, 2), "+", lane->is_additive, THEME_GOOD);
    paint_switch(on, timeline_switch_box(&self->rows, row, 3), "\u25cf", choice->armed == lane->id,
                 THEME_RECORD);
    paint_gain(self, on, row, lane->gain);
}

static void paint_sound_head(panel *self, ui *on, const timeline_row *row, const take *t)
{
    const show_audio *about = &self->result->about;
    bool is_known = self->result->audio == t->audio.audio && about->name[0];
    ui_draw_text(on, self->rows.x + 8.0f, row->y + 3.0f, UI_STYLE_BODY, THEME_TEXT,
                 TIMELINE_HEAD_WIDTH - 16.0f, is_known ? about->name : "Sound");
    paint_gain(self, on, row, t->audio.gain);
}

static void paint_comp_head(panel *self, ui *on, const timeline_row *row)
{
    const take *t = &self->comps->take[row->index];
    char words[200], stars[24] = "";
    for (uint32_t i = 0, used = 0; i < t->rating && i < 5; ++i)
        used += (uint32_t)snprintf(stars + used, sizeof stars - used, "\u2605");
    const double later_s = 1e-9 * (double)timeline_comp_later_ns(self, row->index);
    if (fabs(later_s) >= 0.0005)
        (void)snprintf(words, sizeof words, "%u  %+.2f s  %s", t->number, later_s, t->name);
    else
        (void)snprintf(words, sizeof words, "%u  %s", t->number, t->name);
    float width = ui_text_width(on, UI_STYLE_BODY, stars);
    float right = self->rows.x + TIMELINE_HEAD_WIDTH - 8.0f;
    ui_draw_text(on, self->rows.x + 20.0f, row->y + 3.0f, UI_STYLE_BODY, THEME_DIM,
                 right - width - 6.0f - self->rows.x - 20.0f, words);
    ui_draw_text(on, right - width, row->y + 3.0f, UI_STYLE_BODY, THEME_ACCENT, 0.0f, stars);
}

/* ---- lanes ---- */

static void paint_clips(panel *self, ui *on, const timeline_row *row, const take_layer *lane,
                        uint32_t owner, bool is_heard)
{
    int64_t until_ns = timeline_axis_until_ns(&self->axis);
    for (uint32_t i = timeline_first_clip(lane, self->axis.from_ns); i < lane->clip_count; ++i) {
        const take_clip *clip = &lane->clip[i];
        if (clip->start_ns + lane->offset_ns > until_ns)
            return;
        paint_clip(self, on, timeline_clip_box(row, &self->axis, lane, clip), lane, clip, owner,
                   is_heard);
    }
}

static void paint_swipe(panel *self, ui *on, const timeline_row *row)
{
    if (self->gesture != GESTURE_SWIPE || row->kind != TIMELINE_COMP || self->pressed.row < 0 ||
        &self->rows.row[self->pressed.row] != row)
        return;
    int64_t from_ns, to_ns;
    timeline_span_now(self, &from_ns, &to_ns);
    float x0 = timeline_axis_x(&self->axis, from_ns), x1 = timeline_axis_x(&self->axis, to_ns);
    ui_rectangle where = {x0, row->y + 1.0f, x1 - x0, row->height - 2.0f};
    ui_draw_box(on, where, 0xd9a44155u, 3.0f);
    ui_draw_frame(on, where, THEME_ACCENT, 3.0f, 1.5f);
}

static void paint_lane(panel *self, ui *on, const timeline_row *row, const take *t)
{
    ui_rectangle where = {self->axis.x, row->y, self->axis.width, row->height};
    ui_draw_box(on, where, THEME_WELL, 0.0f);
    ui_clip_begin(on, where);
    if (row->kind == TIMELINE_LAYER) {
        const take_layer *lane = &t->layer[row->index];
        paint_clips(self, on, row, lane, 0, own_layer_is_active(t, row->index));
        paint_overlaps(self, on, row, lane);
    } else if (row->kind == TIMELINE_SOUND)
        paint_wave(self, on, row, t);
    else {
        if (self->comps->take[row->index].layer_count > 0) {
            const take_layer lane = timeline_comp_lane(self, row->index);
            paint_clips(self, on, row, &lane, 1 + row->index, true);
        }
        paint_swipe(self, on, row);
    }
    ui_clip_end(on);
}

static void paint_row(panel *self, ui *on, const timeline_row *row, const take *t)
{
    const app_choice *choice = app_chosen(self->app);
    ui_rectangle head = {self->rows.x, row->y, TIMELINE_HEAD_WIDTH, row->height};
    bool is_chosen = row->kind == TIMELINE_LAYER && choice->layer == t->layer[row->index].id;
    float y = row->y + row->height;
    ui_draw_box(on, head, is_chosen ? 0x24282dffu : THEME_PANEL, 0.0f);
    ui_clip_begin(on, head);
    if (row->kind == TIMELINE_LAYER)
        paint_layer_head(self, on, row, &t->layer[row->index]);
    else if (row->kind == TIMELINE_SOUND)
        paint_sound_head(self, on, row, t);
    else
        paint_comp_head(self, on, row);
    ui_clip_end(on);
    paint_lane(self, on, row, t);
    ui_draw_line(on, self->rows.x, y - 0.5f, self->rows.x + self->rows.width, y - 0.5f, THEME_STAGE,
                 1.0f);
}

/* Shades the area after the end of the take, which is not played. */
static void paint_end(panel *self, ui *on, const take *t)
{
    float end = self->axis.x + self->axis.width;
    float x0 = timeline_axis_x(&self->axis, 0), x1 = timeline_axis_x(&self->axis, t->duration_ns);
    float height = self->rows.y + self->rows.height - self->rows.lanes_y;
    if (x0 > self->axis.x)
        ui_draw_box(on, (ui_rectangle){self->axis.x, self->rows.lanes_y, x0 - self->axis.x, height},
                    0x10111370u, 0.0f);
    if (x1 < end)
        ui_draw_box(on, (ui_rectangle){x1, self->rows.lanes_y, end - x1, height}, 0x10111370u,
                    0.0f);
}

/* Draws what the drag has snapped to, over ruler and lanes. A frame is too near to need a line. */
void timeline_paint_snap(panel *self, ui *on)
{
    const timeline_target to = timeline_snapped(self);
    const ui_rectangle time = {self->axis.x, self->rows.y, self->axis.width, self->rows.height};
    if (to.kind <= TIMELINE_TARGET_FRAME)
        return;
    float x = timeline_axis_x(&self->axis, to.at_ns);
    ui_clip_begin(on, time);
    ui_draw_line(on, x, self->rows.y, x, self->rows.y + self->rows.height, THEME_ACCENT, 2.0f);
    ui_clip_end(on);
}

void timeline_paint_rows(panel *self, ui *on)
{
    const take *t = timeline_take(self);
    ui_rectangle all = {self->rows.x, self->rows.lanes_y, self->rows.width,
                        self->rows.y + self->rows.height - self->rows.lanes_y};
    if (!t)
        return;
    ui_clip_begin(on, all);
    for (uint32_t i = 0; i < self->rows.count; ++i)
        if (self->rows.row[i].y < all.y + all.height &&
            self->rows.row[i].y + self->rows.row[i].height > all.y)
            paint_row(self, on, &self->rows.row[i], t);
    paint_end(self, on, t);
    ui_clip_end(on);
}
