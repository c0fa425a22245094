/* The journal of the last half hour: how much each input moved, drawn with the recorded takes while
 * no take is selected. */
#include "window/timeline/timeline.h"

#include "base/clock.h"
#include "base/hash.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SEEN_SHARE  16.0f /* lane height per share of a range moved in a bin */
#define SHORTEST_NS 200000000LL
#define NOW_NS      300000000LL /* an end this close to now counts as now */

typedef struct input_lane {
    bool is_known, has_last;
    uint64_t of;
    int64_t bin; /* newest bin; earlier bins are complete */
    uint32_t count;
    float last[MRT_MAX_CHANNELS];
    float moved[JOURNAL_BINS];
} input_lane;

struct timeline_journal {
    input_lane lanes[JOURNAL_LANES];
};

timeline_journal *timeline_journal_create(void)
{
    return calloc(1, sizeof(timeline_journal));
}

void timeline_journal_destroy(timeline_journal *self)
{
    free(self);
}

/* ---- writing ---- */

/* Advances to a bin. Skipped bins have no movement. */
static void go_on(input_lane *l, int64_t bin)
{
    if (!l->is_known || bin - l->bin >= JOURNAL_BINS) {
        memset(l->moved, 0, sizeof l->moved);
        l->bin = bin;
        l->is_known = true;
    }
    while (l->bin < bin) {
        l->bin += 1;
        l->moved[l->bin % JOURNAL_BINS] = 0.0f;
    }
}

static float movement(const input_lane *l, const mrt_sample *sample, const mrt_channel *channel)
{
    float sum = 0.0f;
    uint32_t counted = 0;
    for (uint32_t i = 0; i < l->count; ++i) {
        float range = channel[i].max - channel[i].min;
        if (!(range > 0.0f) || !isfinite(sample->value[i]) || !isfinite(l->last[i]))
            continue;
        sum += fabsf(sample->value[i] - l->last[i]) / range;
        counted += 1;
    }
    return counted ? sum / (float)counted : 0.0f;
}

static const input_lane *find(const timeline_journal *self, uint64_t of)
{
    for (uint32_t i = 0; i < JOURNAL_LANES; ++i)
        if (self->lanes[i].is_known && self->lanes[i].of == of)
            return &self->lanes[i];
    return NULL;
}

static input_lane *begin_lane(timeline_journal *self, uint64_t of)
{
    input_lane *out = &self->lanes[0];
    for (uint32_t i = 1; i < JOURNAL_LANES && out->is_known; ++i)
        if (!self->lanes[i].is_known || self->lanes[i].bin < out->bin)
            out = &self->lanes[i];
    out->is_known = out->has_last = false;
    out->of = of;
    return out;
}

void timeline_journal_note(timeline_journal *self, uint64_t of, int64_t now_ns,
                           const mrt_sample *sample, const mrt_channel *channel)
{
    if (now_ns < 0)
        return;
    const input_lane *known = find(self, of);
    input_lane *l = known ? &self->lanes[known - self->lanes] : begin_lane(self, of);
    go_on(l, now_ns / JOURNAL_BIN_NS);
    uint32_t count = sample->count < MRT_MAX_CHANNELS ? sample->count : MRT_MAX_CHANNELS;
    if (l->has_last && l->count == count)
        l->moved[l->bin % JOURNAL_BINS] += movement(l, sample, channel);
    memcpy(l->last, sample->value, count * sizeof *l->last);
    l->count = count;
    l->has_last = true;
}

/* ---- reading ---- */

float timeline_journal_read(const timeline_journal *self, uint64_t of, int64_t from_ns,
                            int64_t to_ns)
{
    const input_lane *l = find(self, of);
    int64_t from = from_ns / JOURNAL_BIN_NS, to = (to_ns - 1) / JOURNAL_BIN_NS;
    float most = 0.0f;
    if (!l || to_ns <= 0)
        return 0.0f;
    if (from <= l->bin - JOURNAL_BINS)
        from = l->bin - JOURNAL_BINS + 1;
    if (to > l->bin)
        to = l->bin;
    for (int64_t bin = from < 0 ? 0 : from; bin <= to; ++bin)
        most = fmaxf(most, l->moved[bin % JOURNAL_BINS]);
    return sqrtf(fminf(most * SEEN_SHARE, 1.0f));
}

/* ---- memory ---- */

bool timeline_keep_span(int64_t *io_from_ns, int64_t *io_to_ns, int64_t now_ns, int64_t reach_ns)
{
    int64_t from_ns = *io_from_ns < *io_to_ns ? *io_from_ns : *io_to_ns;
    int64_t to_ns = *io_from_ns < *io_to_ns ? *io_to_ns : *io_from_ns;
    *io_from_ns = from_ns < now_ns - reach_ns ? now_ns - reach_ns : from_ns;
    *io_to_ns = to_ns > now_ns - NOW_NS ? now_ns : to_ns;
    return *io_to_ns - *io_from_ns >= SHORTEST_NS;
}

/* ---- drawing ---- */

#define SPAN_LEAST_NS (10 * NS_PER_S)
#define SPAN_MOST_NS  (1800 * NS_PER_S)
#define LANE_MOST     56.0f
#define TAKES_HEIGHT  22.0f

typedef struct strip { /* area of the journal on the screen */
    float x, y, width, height, lanes_y;
    int64_t now_ns, from_ns; /* monotonic clock */
} strip;

static float x_of(const strip *s, int64_t at_ns)
{
    return s->x +
           s->width * (float)((double)(at_ns - s->from_ns) / (double)(s->now_ns - s->from_ns));
}

static int64_t ns_of(const strip *s, float x)
{
    return s->from_ns +
           (int64_t)((double)(x - s->x) / (double)s->width * (double)(s->now_ns - s->from_ns));
}

static int64_t utc_ns(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * NS_PER_S + now.tv_nsec;
}

/* ---- ruler ---- */

static int64_t step_of(const strip *s)
{
    static const int64_t steps_s[] = {1, 2, 5, 10, 15, 30, 60, 120, 300, 600};
    double point_ns = (double)(s->now_ns - s->from_ns) / (double)s->width;
    size_t i = 0;
    while (i + 1 < sizeof steps_s / sizeof steps_s[0] &&
           (double)(steps_s[i] * NS_PER_S) / point_ns < 70.0)
        i += 1;
    return steps_s[i] * NS_PER_S;
}

static void paint_ruler(ui *on, const strip *s)
{
    int64_t step_ns = step_of(s);
    for (int64_t ago_ns = 0; ago_ns <= s->now_ns - s->from_ns; ago_ns += step_ns) {
        char words[24];
        int64_t ago_s = ago_ns / NS_PER_S;
        float x = x_of(s, s->now_ns - ago_ns);
        if (ago_s == 0)
            (void)snprintf(words, sizeof words, "now");
        else if (ago_s < 60)
            (void)snprintf(words, sizeof words, "\u2212%d s", (int)ago_s);
        else
            (void)snprintf(words, sizeof words, "\u2212%d:%02d", (int)(ago_s / 60),
                           (int)(ago_s % 60));
        float width = ui_text_width(on, UI_STYLE_NUMBER, words);
        if (x - width - 6.0f < s->x)
            break;
        ui_draw_line(on, x, s->lanes_y - 6.0f, x, s->lanes_y, THEME_RULE, 1.0f);
        ui_draw_text(on, x - width - 4.0f, s->lanes_y - 20.0f, UI_STYLE_NUMBER, THEME_DIM, 0.0f,
                     words);
    }
}

/* ---- takes ---- */

static const app_take_line *line_of(panel *self, int64_t id)
{
    const app_take_line *line;
    uint32_t count = app_takes(self->app, &line);
    for (uint32_t i = count; i-- > 0;)
        if (line[i].id == id)
            return &line[i];
    return NULL;
}

static void paint_take(panel *self, ui *on, const strip *s, const timeline_span *span,
                       int64_t ahead_ns)
{
    const app_take_line *line = line_of(self, span->take);
    int64_t end_ns = line && line->is_recording ? s->now_ns : span->end_ns - ahead_ns;
    float x0 = x_of(s, span->start_ns - ahead_ns), x1 = x_of(s, end_ns);
    if (x1 < s->x || !line || line->is_deleted)
        return;
    x0 = x0 < s->x ? s->x : x0;
    uint32_t colour = line->is_recording ? 0x6b2f2dffu : THEME_RAISED;
    ui_rectangle box = {x0, s->y + 2.0f, x1 - x0 < 2.0f ? 2.0f : x1 - x0, TAKES_HEIGHT - 4.0f};
    ui_draw_box(on, box, colour, 3.0f);
    if (box.width > 30.0f)
        ui_draw_text(on, x0 + 6.0f, s->y + 3.0f, UI_STYLE_BODY, THEME_TEXT, box.width - 10.0f,
                     line->title);
}

static void paint_takes(panel *self, ui *on, const strip *s)
{
    int64_t ahead_ns = utc_ns() - s->now_ns;
    for (uint32_t i = self->result->span_count; i-- > 0;)
        paint_take(self, on, s, &self->result->span[i], ahead_ns);
}

/* ---- marks ---- */

#define MARK_COLOUR 0x9fb58affu

static void paint_marks(panel *self, ui *on, const strip *s)
{
    const int64_t *at_ns;
    const uint32_t count = app_marks_of(self->app, &at_ns);
    const float width = ui_text_width(on, UI_STYLE_BODY, "mark");
    for (uint32_t i = 0; i < count; ++i) {
        const float x = x_of(s, at_ns[i]);
        const float next = i + 1 < count ? x_of(s, at_ns[i + 1]) : s->x + s->width;
        const float y = s->lanes_y + 3.0f, flag[6] = {x, y, x + 8.0f, y + 4.0f, x, y + 8.0f};
        if (x < s->x)
            continue;
        ui_draw_line(on, x, y, x, s->y + s->height, 0x9fb58a60u, 1.0f);
        ui_draw_triangle(on, flag, MARK_COLOUR);
        if (next - x > width + 14.0f)
            ui_draw_text(on, x + 11.0f, y - 4.0f, UI_STYLE_BODY, THEME_DIM, 0.0f, "mark");
        else if (i + 1 == count) /* the newest is too close to now */
            ui_draw_text(on, x - width - 4.0f, y - 4.0f, UI_STYLE_BODY, THEME_DIM, 0.0f, "mark");
    }
}

/* ---- lanes ---- */

/* Returns an id for an input. The text identifies the device, and the pointer distinguishes two
 * equal texts. */
uint64_t timeline_journal_input(live *stage, uint32_t index)
{
    const char *text = live_input_text(stage, index);
    return hash_bytes((uint64_t)(uintptr_t)live_input(stage, index), text, text ? strlen(text) : 0);
}

/* Draws whole columns of whole bins, so that the past does not change its shape. */
static void paint_movement(panel *self, ui *on, const strip *s, uint32_t lane, float y,
                           float height)
{
    double point_ns = (double)(s->now_ns - s->from_ns) / (double)s->width;
    int64_t bins = (int64_t)(2.0 * point_ns / (double)JOURNAL_BIN_NS);
    int64_t step_ns = (bins < 1 ? 1 : bins) * JOURNAL_BIN_NS;
    uint32_t count = 0;
    const uint64_t of = timeline_journal_input(app_live(self->app), lane);
    for (int64_t at_ns = s->from_ns / step_ns * step_ns;
         at_ns <= s->now_ns && count < TIMELINE_COLUMNS_MAX; at_ns += step_ns) {
        float most = timeline_journal_read(self->journal, of, at_ns, at_ns + step_ns);
        float x = x_of(s, at_ns + step_ns / 2);
        self->column_x[count] = x < s->x + s->width ? x : s->x + s->width;
        self->column_low[count] = y + height - 2.0f;
        self->column_high[count] = y + height - 2.0f - (height - 5.0f) * most;
        self->column_line[2 * count] = self->column_x[count];
        self->column_line[2 * count + 1] = self->column_high[count];
        count += 1;
    }
    if (count < 2)
        return;
    ui_draw_area(on, self->column_x, self->column_low, self->column_high, count,
                 (TIMELINE_CURVE_COLOUR & ~0xffu) | TIMELINE_FILL_ALPHA);
    ui_draw_lines(on, self->column_line, count, TIMELINE_CURVE_COLOUR, 1.0f);
}

static void paint_lanes(panel *self, ui *on, const strip *s)
{
    live *stage = app_live(self->app);
    uint32_t inputs = live_input_count(stage), shown = 0;
    float room = s->y + s->height - s->lanes_y;
    uint32_t count = inputs < JOURNAL_LANES ? inputs : JOURNAL_LANES;
    float height = count ? room / (float)count : room;
    height = height > LANE_MOST ? LANE_MOST : height;
    for (uint32_t i = 0; i < count; ++i, ++shown) {
        float y = s->lanes_y + height * (float)i;
        ui_draw_box(on, (ui_rectangle){s->x, y, s->width, height - 1.0f}, THEME_WELL, 0.0f);
        ui_draw_text(on, self->rows.x + 10.0f, y + 0.5f * (height - 17.0f), UI_STYLE_BODY,
                     THEME_TEXT, TIMELINE_HEAD_WIDTH - 20.0f, input_name(live_input(stage, i)));
        ui_clip_begin(on, (ui_rectangle){s->x, y, s->width, height});
        paint_movement(self, on, s, i, y, height);
        ui_clip_end(on);
    }
}

/* ---- swipe to keep ---- */

static void keep_swiped(panel *self, const strip *s)
{
    int64_t from_ns = self->span_from_ns, to_ns = self->span_to_ns;
    if (timeline_keep_span(&from_ns, &to_ns, s->now_ns, app_status(self->app)->journal_ns))
        app_keep(self->app, from_ns, to_ns);
}

static void paint_span(panel *self, ui *on, const strip *s)
{
    char words[32];
    int64_t from_ns, to_ns;
    timeline_span_now(self, &from_ns, &to_ns);
    float x0 = x_of(s, from_ns), x1 = x_of(s, to_ns);
    x1 = x1 > s->x + s->width ? s->x + s->width : x1;
    ui_rectangle box = {x0, s->lanes_y, x1 - x0, s->y + s->height - s->lanes_y};
    ui_draw_box(on, box, 0xd9a44133u, 0.0f);
    ui_draw_frame(on, box, THEME_ACCENT, 0.0f, 1.5f);
    (void)snprintf(words, sizeof words, "keep %.1f s", (double)(to_ns - from_ns) * 1e-9);
    float width = ui_text_width(on, UI_STYLE_STRONG, words);
    if (box.width > width + 12.0f)
        ui_draw_text(on, x0 + 6.0f, s->lanes_y + 3.0f, UI_STYLE_STRONG, THEME_ACCENT, 0.0f, words);
}

static void handle_pointer(panel *self, ui *on, const ui_canvas *canvas, const strip *s)
{
    float x = canvas->where.x + canvas->x;
    if (canvas->is_hovered && canvas->wheel_y != 0.0f) {
        double factor = canvas->wheel_y > 0.0f ? 0.8 : 1.25;
        double span_ns = (double)self->journal_span_ns * factor;
        self->journal_span_ns = span_ns < (double)SPAN_LEAST_NS  ? SPAN_LEAST_NS
                                : span_ns > (double)SPAN_MOST_NS ? SPAN_MOST_NS
                                                                 : (int64_t)span_ns;
    }
    if (canvas->is_pressed && canvas->button == 0 && x >= s->x) {
        self->gesture = GESTURE_KEEP;
        self->span_from_ns = self->span_to_ns = ns_of(s, x);
    }
    if (self->gesture != GESTURE_KEEP)
        return;
    if (ui_is_down(on, UI_KEY_ESCAPE))
        self->gesture = GESTURE_NONE;
    self->span_to_ns = ns_of(s, x < s->x ? s->x : x);
    if (!canvas->is_released)
        return;
    self->gesture = GESTURE_NONE;
    keep_swiped(self, s);
}

/* Returns the right end of the journal. It follows each new face. While nothing moves it advances
 * once a second, so that it does not force a redraw of the window in each frame. */
static int64_t journal_now(panel *self)
{
    static const int64_t step_ns = NS_PER_S;
    const int64_t now_ns = clock_now_ns();
    const uint64_t number = app_view(self->app)->number;
    if (number != self->journal_face || now_ns - self->journal_now_ns >= step_ns)
        self->journal_now_ns = now_ns;
    self->journal_face = number;
    return self->journal_now_ns;
}

void timeline_paint_journal(panel *self, ui *on, const ui_canvas *canvas)
{
    const live_status *status = app_status(self->app);
    int64_t now_ns = journal_now(self);
    strip s = {.x = self->axis.x,
               .y = self->rows.y,
               .width = self->axis.width,
               .height = self->rows.height,
               .lanes_y = self->rows.y + TIMELINE_RULER_HEIGHT,
               .now_ns = now_ns,
               .from_ns = now_ns - self->journal_span_ns};
    handle_pointer(self, on, canvas, &s);
    s.from_ns = now_ns - self->journal_span_ns;
    ui_draw_box(on, (ui_rectangle){self->rows.x, s.y, self->rows.width, TIMELINE_RULER_HEIGHT},
                THEME_BAR, 0.0f);
    ui_draw_text(on, self->rows.x + 10.0f, s.y + 4.0f, UI_STYLE_STRONG, THEME_TEXT,
                 TIMELINE_HEAD_WIDTH - 20.0f, "Always recorded");
    ui_draw_text(on, self->rows.x + 10.0f, s.y + 21.0f, UI_STYLE_BODY, THEME_DIM,
                 TIMELINE_HEAD_WIDTH - 20.0f,
                 status->can_record ? "swipe to keep a span" : "not recording: see the log");
    ui_clip_begin(on, (ui_rectangle){s.x, s.y, s.width, s.height});
    paint_takes(self, on, &s);
    paint_ruler(on, &s);
    ui_clip_end(on);
    paint_lanes(self, on, &s);
    ui_clip_begin(on, (ui_rectangle){s.x, s.y, s.width, s.height});
    paint_marks(self, on, &s);
    ui_clip_end(on);
    if (self->gesture == GESTURE_KEEP)
        paint_span(self, on, &s);
}
