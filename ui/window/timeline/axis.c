#include "window/timeline/axis.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define AIR  0.02 /* margin on both sides, share of the width */
#define PAGE 0.08 /* position of the playhead on a new page, share of the width */
#define SEEN 0.1  /* minimum visible part, share of the width */

static double within(double value, double low, double high)
{
    return value < low ? low : value > high ? high : value;
}

static int64_t rounded(double ns)
{
    return (int64_t)floor(ns + 0.5);
}

static void set_scale(timeline_axis *self, double ns_per_point)
{
    double width = (double)self->width;
    self->ns_per_point =
        within(ns_per_point, TIMELINE_SPAN_MIN_NS / width, TIMELINE_SPAN_MAX_NS / width);
}

void timeline_axis_fit(timeline_axis *self, int64_t from_ns, int64_t to_ns)
{
    double span_ns = to_ns > from_ns ? (double)(to_ns - from_ns) : 1e9;
    set_scale(self, span_ns / ((1.0 - 2.0 * AIR) * (double)self->width));
    double spare_ns = self->ns_per_point * (double)self->width - span_ns;
    double left_ns = within(self->ns_per_point * (double)self->width * AIR, 0.0, spare_ns);
    self->from_ns = from_ns - rounded(left_ns);
}

void timeline_axis_set_extent(timeline_axis *self, float x, float width)
{
    self->x = x;
    self->width = width > 1.0f ? width : 1.0f;
    set_scale(self, self->ns_per_point);
}

float timeline_axis_x(const timeline_axis *self, int64_t at_ns)
{
    return self->x + timeline_axis_points(self, at_ns - self->from_ns);
}

int64_t timeline_axis_ns(const timeline_axis *self, float x)
{
    return self->from_ns + rounded((double)(x - self->x) * self->ns_per_point);
}

int64_t timeline_axis_until_ns(const timeline_axis *self)
{
    return timeline_axis_ns(self, self->x + self->width);
}

int64_t timeline_axis_span_ns(const timeline_axis *self, float points)
{
    return rounded((double)points * self->ns_per_point);
}

float timeline_axis_points(const timeline_axis *self, int64_t span_ns)
{
    return (float)((double)span_ns / self->ns_per_point);
}

void timeline_axis_zoom(timeline_axis *self, float x, double factor)
{
    int64_t about_ns = timeline_axis_ns(self, x);
    set_scale(self, self->ns_per_point / factor);
    self->from_ns = about_ns - rounded((double)(x - self->x) * self->ns_per_point);
}

void timeline_axis_pan(timeline_axis *self, float points)
{
    self->from_ns -= rounded((double)points * self->ns_per_point);
}

void timeline_axis_hold(timeline_axis *self, int64_t low_ns, int64_t high_ns)
{
    double span_ns = self->ns_per_point * (double)self->width;
    int64_t least_ns = low_ns - rounded((1.0 - SEEN) * span_ns);
    int64_t most_ns = high_ns - rounded(SEEN * span_ns);
    if (most_ns < low_ns - rounded(AIR * span_ns))
        most_ns = low_ns - rounded(AIR * span_ns);
    if (self->from_ns > most_ns)
        self->from_ns = most_ns;
    if (self->from_ns < least_ns)
        self->from_ns = least_ns;
}

bool timeline_axis_follow(timeline_axis *self, int64_t at_ns)
{
    float x = timeline_axis_x(self, at_ns);
    if (x >= self->x && x <= self->x + self->width)
        return false;
    self->from_ns = at_ns - rounded(PAGE * (double)self->width * self->ns_per_point);
    return true;
}

/* ---- ticks ---- */

#define MINOR_POINTS 7.0
#define LABEL_POINTS 120.0f /* maximum width of a label */
static const int64_t second_ns = 1000000000;

timeline_code timeline_code_of(const take *t)
{
    timeline_code code = {.rate = {30, 1, false}};
    if (!t)
        return code;
    code.first_frame = t->timecode_frame;
    if (t->fps > 0.0 && timecode_rate_of(&code.rate, t->fps, NULL) >= 0)
        code.rate.is_drop = t->is_drop_frame && timecode_can_drop(code.rate);
    return code;
}

void timeline_code_write(char out[TIMECODE_TEXT], const timeline_code *code, int64_t at_ns)
{
    timecode_write(out, code->rate, code->first_frame + timecode_frame(code->rate, at_ns));
}

/* ---- steps of labels and smaller ticks, as a count of one unit ---- */

typedef struct step {
    int64_t count, minor;
} step;

/* Returns the smallest step that is at least `least` wide, or the last step. */
static step choose(const step *steps, size_t count, double unit_points, double least)
{
    size_t i = 0;
    while (i + 1 < count && (double)steps[i].count * unit_points < least)
        i += 1;
    step chosen = steps[i];
    if ((double)chosen.minor * unit_points < MINOR_POINTS)
        chosen.minor = chosen.count;
    return chosen;
}

static uint32_t nominal(timecode_rate rate)
{
    uint32_t frames = rate.den ? (rate.num + rate.den - 1) / rate.den : 0;
    return frames ? frames : 1;
}

/* ---- labels as frames ---- */

/* Returns the frame labelled with a whole second. If drop-frame skips this label, returns the next
 * frame. */
static int64_t frame_of_second(timecode_rate rate, int64_t seconds)
{
    int64_t frame = seconds * nominal(rate);
    if (!rate.is_drop)
        return frame;
    bool is_before = seconds < 0;
    int64_t at = is_before ? -seconds : seconds, minutes = at / 60;
    int64_t dropped = nominal(rate) / 15;
    int64_t out = at * nominal(rate) - dropped * (minutes - minutes / 10);
    if (at % 60 == 0 && minutes % 10 != 0)
        out += dropped;
    return is_before ? -out : out;
}

static int64_t floor_to(int64_t value, int64_t unit)
{
    int64_t rest = value % unit;
    return value - (rest < 0 ? rest + unit : rest);
}

static bool put(timeline_tick *out, uint32_t *count, int64_t at_ns, bool is_major)
{
    if (*count >= TIMELINE_TICKS_MAX)
        return false;
    out[*count] = (timeline_tick){.at_ns = at_ns, .is_major = is_major};
    *count += 1;
    return true;
}

static int64_t time_of_label(const timeline_code *code, int64_t frame)
{
    return timecode_time_ns(code->rate, frame - code->first_frame);
}

/* Returns a second safely before a time, because labels and clock differ by a factor of 1.001. */
static int64_t second_before(const timeline_code *code, int64_t at_ns)
{
    int64_t second = at_ns / second_ns + code->first_frame / nominal(code->rate);
    return second - 2 - (second > 0 ? second : -second) / 500;
}

static uint32_t tick_seconds(timeline_tick *out, const timeline_axis *axis,
                             const timeline_code *code, step by)
{
    int64_t from_ns = axis->from_ns - timeline_axis_span_ns(axis, LABEL_POINTS);
    int64_t until_ns = timeline_axis_until_ns(axis);
    uint32_t count = 0;
    for (int64_t second = floor_to(second_before(code, from_ns), by.minor);; second += by.minor) {
        int64_t frame = frame_of_second(code->rate, second);
        int64_t at_ns = time_of_label(code, frame);
        bool is_major = second % by.count == 0;
        if (at_ns < from_ns)
            continue;
        if (at_ns > until_ns || !put(out, &count, at_ns, is_major))
            return count;
        if (is_major)
            timecode_write(out[count - 1].label, code->rate, frame);
    }
}

/* Computes ticks second by second, so that whole seconds have a label at each rate. If drop-frame
 * skips frames, the first existing frame has the label. */
static uint32_t tick_frames(timeline_tick *out, const timeline_axis *axis,
                            const timeline_code *code, step by)
{
    int64_t from_ns = axis->from_ns - timeline_axis_span_ns(axis, LABEL_POINTS);
    int64_t until_ns = timeline_axis_until_ns(axis);
    uint32_t count = 0;
    for (int64_t second = second_before(code, from_ns);; ++second) {
        int64_t start = frame_of_second(code->rate, second);
        int64_t end = frame_of_second(code->rate, second + 1);
        int64_t lacking = nominal(code->rate) - (end - start);
        for (int64_t label = 0; label < nominal(code->rate); label += by.minor) {
            int64_t frame = start + label - lacking, at_ns = time_of_label(code, frame);
            if (label < lacking || at_ns < from_ns)
                continue;
            bool is_first = label == lacking && by.count == nominal(code->rate);
            bool is_major = label % by.count == 0 && label + by.count <= nominal(code->rate);
            if (at_ns > until_ns || !put(out, &count, at_ns, is_major || is_first))
                return count;
            if (is_major || is_first)
                timecode_write(out[count - 1].label, code->rate, frame);
        }
    }
}

/* Returns the smallest step in frames that divides a second, or 10, and is wide enough. count 0:
 * none. */
static step choose_frames(timecode_rate rate, double frame_points, double least)
{
    int64_t second = nominal(rate);
    step out = {0, 1};
    for (int64_t count = 1; count <= second && !out.count; ++count)
        if ((second % count == 0 || count == 10) && (double)count * frame_points >= least)
            out.count = count;
    while (out.minor < out.count &&
           (out.count % out.minor != 0 || (double)out.minor * frame_points < MINOR_POINTS))
        out.minor += 1;
    return out.minor < second || second == 1 ? out : (step){0, 1};
}

static void write_within(char out[TIMECODE_TEXT], int64_t ns, int64_t step_ns)
{
    int digits = step_ns >= 1000000 ? 0 : step_ns >= 100000 ? 1 : step_ns >= 10000 ? 2 : 3;
    (void)snprintf(out, TIMECODE_TEXT, "+%.*f ms", digits, (double)ns / 1e6);
}

static uint32_t tick_within(timeline_tick *out, const timeline_axis *axis,
                            const timeline_code *code, step by)
{
    int64_t from_ns = axis->from_ns - timeline_axis_span_ns(axis, LABEL_POINTS);
    int64_t until_ns = timeline_axis_until_ns(axis);
    int64_t frame = timecode_frame(code->rate, from_ns);
    uint32_t count = 0;
    for (;; ++frame) {
        int64_t start_ns = timecode_time_ns(code->rate, frame);
        int64_t end_ns = timecode_time_ns(code->rate, frame + 1);
        if (start_ns > until_ns)
            return count;
        int64_t within_ns = from_ns > start_ns ? floor_to(from_ns - start_ns, by.minor) : 0;
        for (; start_ns + within_ns + (within_ns ? by.minor / 2 : 0) < end_ns &&
               start_ns + within_ns <= until_ns;
             within_ns += by.minor) {
            /* skip a label that would overlap the label of the next frame */
            bool is_major = within_ns % by.count == 0 &&
                            (within_ns == 0 || start_ns + within_ns + by.count <= end_ns);
            if (!put(out, &count, start_ns + within_ns, is_major))
                return count;
            if (within_ns == 0)
                timecode_write(out[count - 1].label, code->rate, frame + code->first_frame);
            else if (is_major)
                write_within(out[count - 1].label, within_ns, by.count);
        }
    }
}

uint32_t timeline_ticks(timeline_tick out[TIMELINE_TICKS_MAX], const timeline_axis *axis,
                        const timeline_code *code, float label_width)
{
    static const step seconds[] = {
        {1, 1},      {2, 1},       {5, 1},        {10, 2},       {15, 5},       {30, 5},
        {60, 10},    {120, 30},    {300, 60},     {600, 120},    {900, 300},    {1800, 300},
        {3600, 600}, {7200, 1800}, {10800, 3600}, {21600, 3600}, {43200, 7200}, {86400, 14400}};
    static const step within[] = {
        {1000, 200},           {2000, 500},           {5000, 1000},         {10000, 2000},
        {20000, 5000},         {50000, 10000},        {100000, 20000},      {200000, 50000},
        {500000, 100000},      {1000000, 200000},     {2000000, 500000},    {5000000, 1000000},
        {10000000, 2000000},   {20000000, 5000000},   {50000000, 10000000}, {100000000, 20000000},
        {200000000, 50000000}, {500000000, 100000000}};
    double least = (double)label_width, ns_per_point = axis->ns_per_point;
    double frame_points = (double)second_ns * code->rate.den / code->rate.num / ns_per_point;
    if (frame_points >= 2.0 * least) {
        step by = choose(within, sizeof within / sizeof within[0], 1.0 / ns_per_point, least);
        return tick_within(out, axis, code, by);
    }
    step by = choose_frames(code->rate, frame_points, least);
    if (by.count)
        return tick_frames(out, axis, code, by);
    by = choose(seconds, sizeof seconds / sizeof seconds[0], (double)second_ns / ns_per_point,
                least);
    return tick_seconds(out, axis, code, by);
}

/* ---- snapping ---- */

typedef struct nearest {
    int64_t at_ns, away_ns;
    timeline_target to; /* kind TIMELINE_TARGET_NONE: none found */
} nearest;

static void consider(nearest *n, timeline_target_kind kind, int64_t to_ns, uint32_t index)
{
    int64_t away_ns = to_ns > n->at_ns ? to_ns - n->at_ns : n->at_ns - to_ns;
    if (away_ns > n->away_ns || (n->to.kind != TIMELINE_TARGET_NONE && away_ns == n->away_ns))
        return;
    n->away_ns = away_ns;
    n->to = (timeline_target){kind, to_ns, index};
}

#define BEATS_APART 6 /* of the snap distance: beats that are closer would catch every drag */

static void consider_beat(nearest *n, const timeline_snap *snap)
{
    if (snap->beat_ns < BEATS_APART * snap->reach_ns || snap->beat_ns <= 0)
        return;
    const int64_t half_ns = snap->beat_ns / 2;
    const int64_t shifted_ns = n->at_ns + half_ns;
    const int64_t count = shifted_ns / snap->beat_ns - (shifted_ns % snap->beat_ns < 0);
    consider(n, snap->is_beat ? TIMELINE_TARGET_BEAT : TIMELINE_TARGET_SECOND,
             count * snap->beat_ns, 0);
}

static nearest find(const timeline_snap *snap, int64_t at_ns)
{
    const take *t = snap->take;
    nearest n = {.at_ns = at_ns, .away_ns = snap->reach_ns};
    if (snap->reach_ns <= 0)
        return n;
    if (snap->head_ns != INT64_MIN)
        consider(&n, TIMELINE_TARGET_HEAD, snap->head_ns, 0);
    if (snap->in_ns < snap->out_ns) {
        consider(&n, TIMELINE_TARGET_RANGE, snap->in_ns, 0);
        consider(&n, TIMELINE_TARGET_RANGE, snap->out_ns, 0);
    }
    for (uint32_t i = 0; t && i < t->marker_count; ++i)
        if ((int32_t)i != snap->without_marker)
            consider(&n, TIMELINE_TARGET_MARKER, t->marker[i].at_ns, i);
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            const take_clip *clip = &t->layer[i].clip[k];
            if (clip->id == snap->without_clip)
                continue;
            consider(&n, TIMELINE_TARGET_CLIP_START, clip->start_ns + t->layer[i].offset_ns, i);
            consider(&n, TIMELINE_TARGET_CLIP_END, clip->end_ns + t->layer[i].offset_ns, i);
        }
    consider(&n, TIMELINE_TARGET_TAKE_START, 0, 0);
    if (t)
        consider(&n, TIMELINE_TARGET_TAKE_END, t->duration_ns, 0);
    if (n.to.kind == TIMELINE_TARGET_NONE)
        consider_beat(&n, snap);
    return n;
}

/* Snaps to the nearest frame. */
static int64_t on_grid(const timeline_snap *snap, int64_t at_ns, timeline_target *out_to)
{
    timecode_rate rate = snap->code.rate;
    if (snap->reach_ns <= 0)
        return at_ns;
    const int64_t frame_ns = timecode_time_ns(rate, timecode_nearest_frame(rate, at_ns));
    if (out_to)
        *out_to = (timeline_target){.kind = TIMELINE_TARGET_FRAME, .at_ns = frame_ns};
    return frame_ns;
}

int64_t timeline_snap_to(const timeline_snap *snap, int64_t at_ns, timeline_target *out_to)
{
    nearest n = find(snap, at_ns);
    if (out_to)
        *out_to = n.to;
    return n.to.kind != TIMELINE_TARGET_NONE ? n.to.at_ns : on_grid(snap, at_ns, out_to);
}

int64_t timeline_snap_span(const timeline_snap *snap, int64_t start_ns, int64_t length_ns,
                           timeline_target *out_to)
{
    nearest start = find(snap, start_ns), end = find(snap, start_ns + length_ns);
    const bool has_start = start.to.kind != TIMELINE_TARGET_NONE;
    const bool has_end = end.to.kind != TIMELINE_TARGET_NONE;
    if (out_to)
        *out_to = (timeline_target){.kind = TIMELINE_TARGET_NONE};
    if (!has_start && !has_end)
        return on_grid(snap, start_ns, out_to);
    bool by_end = has_end && (!has_start || end.away_ns < start.away_ns);
    if (out_to)
        *out_to = by_end ? end.to : start.to;
    return by_end ? end.to.at_ns - length_ns : start.to.at_ns;
}

void timeline_target_words(char out[128], const timeline_target *target, const take *t)
{
    static const char *const to[] = {
        [TIMELINE_TARGET_FRAME] = "frames",
        [TIMELINE_TARGET_SECOND] = "a full second",
        [TIMELINE_TARGET_BEAT] = "a beat",
        [TIMELINE_TARGET_TAKE_START] = "the start of the take",
        [TIMELINE_TARGET_TAKE_END] = "the end of the take",
        [TIMELINE_TARGET_RANGE] = "the range",
        [TIMELINE_TARGET_CLIP_START] = "the start of a clip of",
        [TIMELINE_TARGET_CLIP_END] = "the end of a clip of",
        [TIMELINE_TARGET_MARKER] = "a marker",
        [TIMELINE_TARGET_HEAD] = "the playhead",
    };
    const bool is_clip =
        target->kind == TIMELINE_TARGET_CLIP_START || target->kind == TIMELINE_TARGET_CLIP_END;
    out[0] = '\0';
    if (target->kind == TIMELINE_TARGET_MARKER && target->index < t->marker_count &&
        t->marker[target->index].text[0])
        (void)snprintf(out, 128, "Snaps to marker '%.60s'", t->marker[target->index].text);
    else if (is_clip && target->index < t->layer_count)
        (void)snprintf(out, 128, "Snaps to %s '%.60s'", to[target->kind],
                       t->layer[target->index].name);
    else if (target->kind != TIMELINE_TARGET_NONE)
        (void)snprintf(out, 128, "Snaps to %s", to[target->kind]);
}
