/* The timeline panel: takes at the left, the transport at the top, ruler and lanes. */
#include "window/timeline/timeline.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BIN_POINTS  1.5f /* width of a bin of a curve */
#define NARROW      1100.0f
#define NARROW_LIST 200.0f
#define LIST_LEAST  150.0f
#define LIST_MOST   0.5f /* share of the timeline */
#define EDGE        7.0f

/* ---- other takes below the selected take ---- */

/* Returns the slot of a shifted take, or TIMELINE_COMPS_MAX if it is not shifted. */
static uint32_t find(const panel *self, int64_t of, int64_t id)
{
    uint32_t i = 0;
    while (i < TIMELINE_COMPS_MAX && (self->slid[i].of != of || self->slid[i].take != id))
        i += 1;
    return i;
}

static void lay(panel *self, const timeline_slid *so)
{
    uint32_t slot = find(self, so->of, so->take);
    if (slot == TIMELINE_COMPS_MAX) {
        slot = self->slid_next;
        self->slid_next = (self->slid_next + 1) % TIMELINE_COMPS_MAX;
    }
    self->slid[slot] = *so;
}

/* Returns the default shift of an overdub: the time at which the take itself shows the same
 * performance. */
static int64_t performed_later_ns(const take *t, const take *other)
{
    const take_clip *raw = other->layer[0].clip_count ? &other->layer[0].clip[0] : NULL;
    for (uint32_t i = 0; raw && t && i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            const take_clip *clip = &t->layer[i].clip[k];
            const int64_t at_ns = clip->start_ns + t->layer[i].offset_ns;
            const int64_t show_ns = clip->from_ns + take_warp_to_source(clip, clip->start_ns);
            const int64_t raw_ns = raw->from_ns + take_warp_to_source(raw, raw->start_ns);
            if (clip->performance != raw->performance || show_ns >= raw->to_ns ||
                raw_ns >= clip->from_ns + take_warp_to_source(clip, clip->end_ns))
                continue; /* one live performance can span several takes */
            return at_ns - (show_ns - raw_ns) - raw->start_ns - other->layer[0].offset_ns;
        }
    return 0;
}

int64_t timeline_comp_later_ns(const panel *self, uint32_t index)
{
    const take *other = &self->comps->take[index];
    const uint32_t found = find(self, self->comps->of, other->id);
    return found < TIMELINE_COMPS_MAX ? self->slid[found].later_ns
                                      : performed_later_ns(app_take(self->app), other);
}

void timeline_comp_slide(panel *self, uint32_t index, int64_t later_ns)
{
    lay(self, &(timeline_slid){self->comps->of, self->comps->take[index].id, later_ns});
}

take_layer timeline_comp_lane(const panel *self, uint32_t index)
{
    take_layer out = self->comps->take[index].layer[0];
    out.offset_ns += timeline_comp_later_ns(self, index);
    return out;
}

/* ---- undo ---- */

static mrt_result set(void *owner, const void *value)
{
    panel *self = owner;
    const timeline_slid *wanted = value;
    /* Shows the change in its take. app_choose_take reports a take that no longer exists. */
    const mrt_result result =
        app_take_id(self->app) == wanted->of ? MRT_OK : app_choose_take(self->app, wanted->of);
    if (result < 0)
        return result;
    self->has_comps = true;
    lay(self, wanted);
    return MRT_OK;
}

void timeline_slide_note(panel *self, uint32_t index, int64_t before_ns)
{
    const take *other = &self->comps->take[index];
    const int64_t after_ns = timeline_comp_later_ns(self, index);
    if (after_ns == before_ns)
        return;
    const timeline_slid before = {self->comps->of, other->id, before_ns},
                        after = {self->comps->of, other->id, after_ns};
    undo_change made = {.owner = self, .set = set};
    (void)snprintf(made.words, sizeof made.words, "shift take %u to %+.2f s", other->number,
                   1e-9 * (double)after_ns);
    app_add_copied_change(self->app, &made, &before, &after, sizeof after);
}

/* ---- show of the takes ---- */

static void forget_slides(panel *self)
{
    app_forget_changes(self->app, self);
    free(self->slid_show);
    self->slid_show = NULL;
}

/* Resets the shifts when the show changes, because take ids are valid in one show only. */
static void follow_show(panel *self, const char *show_path)
{
    if (self->slid_show && strcmp(self->slid_show, show_path) == 0)
        return;
    forget_slides(self);
    self->slid_show = strdup(show_path);
    memset(self->slid, 0, sizeof self->slid);
}

/* ---- which parts of the face a layer moves ---- */

static bool has_pattern(const take_layer *lane, const char *pattern)
{
    for (uint32_t i = 0; i < lane->own_count; ++i)
        if (strcmp(lane->own[i], pattern) == 0)
            return true;
    return false;
}

static bool has_region(const take_layer *lane, const own_part *part)
{
    for (uint32_t i = 0; i < part->pattern_count; ++i)
        if (!has_pattern(lane, part->pattern[i]))
            return false;
    return part->pattern_count > 0;
}

uint32_t timeline_own_regions(const take_layer *lane)
{
    uint32_t out = 0;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region)
        if (has_region(lane, own_part_of((own_region)region)))
            out |= 1u << region;
    return out;
}

bool timeline_is_of_regions(const char *pattern, uint32_t regions)
{
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        const own_part *part = own_part_of((own_region)region);
        for (uint32_t i = 0; regions & 1u << region && i < part->pattern_count; ++i)
            if (strcmp(part->pattern[i], pattern) == 0)
                return true;
    }
    return false;
}

static void append(char *out, size_t capacity, const char *word)
{
    size_t used = strlen(out);
    (void)snprintf(out + used, capacity - used, "%s%s", used ? ", " : "", word);
}

void timeline_own_words(const take_layer *lane, char *out, size_t capacity)
{
    uint32_t regions = timeline_own_regions(lane);
    out[0] = '\0';
    if (lane->own_count == 0)
        append(out, capacity, "everything");
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region)
        if (regions & 1u << region)
            append(out, capacity, own_part_of((own_region)region)->name);
    for (uint32_t i = 0; i < lane->own_count; ++i)
        if (!timeline_is_of_regions(lane->own[i], regions))
            append(out, capacity, lane->own[i]);
}

/* ---- functions shared by the files ---- */

const take *timeline_take(const panel *self)
{
    const take *t = app_take(self->app);
    return t && self->gesture == GESTURE_EDIT ? timeline_drag_shown(&self->drag, t) : t;
}

timeline_code timeline_code_now(const panel *self)
{
    return timeline_code_of(app_take(self->app));
}

int64_t timeline_head_ns(const panel *self)
{
    return app_is_take_shown(self->app) ? live_position(app_live(self->app)).at_ns : 0;
}

timeline_target timeline_snapped(const panel *self)
{
    if (self->gesture == GESTURE_EDIT)
        return self->drag.snapped;
    return self->gesture == GESTURE_RANGE ? self->range_snapped
                                          : (timeline_target){.kind = TIMELINE_TARGET_NONE};
}

void timeline_span_now(const panel *self, int64_t *out_from_ns, int64_t *out_to_ns)
{
    const bool is_turned = self->span_from_ns > self->span_to_ns;
    *out_from_ns = is_turned ? self->span_to_ns : self->span_from_ns;
    *out_to_ns = is_turned ? self->span_from_ns : self->span_to_ns;
}

bool timeline_range(const panel *self, int64_t *out_in_ns, int64_t *out_out_ns)
{
    const transport *move =
        app_is_take_shown(self->app) ? live_transport(app_live(self->app)) : NULL;
    *out_in_ns = move ? move->loop_in_ns : 0;
    *out_out_ns = move ? move->loop_out_ns : 0;
    if (self->gesture == GESTURE_RANGE)
        timeline_span_now(self, out_in_ns, out_out_ns);
    return *out_in_ns < *out_out_ns;
}

void timeline_fit(panel *self)
{
    const take *t = app_take(self->app);
    timeline_axis_fit(&self->axis, 0, t && t->duration_ns > 0 ? t->duration_ns : NS_PER_S);
    self->is_fit = true;
}

void timeline_report(panel *self, const error *err)
{
    if (err->text[0])
        news_list_add(app_news(self->app), MRT_LOG_WARNING, "timeline", err->text);
}

double timeline_clip_speed(const take_clip *clip)
{
    int64_t source_ns =
        take_warp_to_source(clip, clip->end_ns) - take_warp_to_source(clip, clip->start_ns);
    return (double)source_ns / (double)(clip->end_ns - clip->start_ns);
}

void timeline_edit(panel *self, edit *e)
{
    (void)!app_edit(self->app, e); /* the function reports its own errors */
    edit_finish(e);
}

/* ---- requests ---- */

static uint32_t lanes_of(const take_layer *of)
{
    uint32_t out = 0;
    for (uint32_t region = 0; region < OWN_REGION_COUNT && of->own_count > 0; ++region)
        if (timeline_moves(of, (own_region)region))
            out |= 1u << region;
    return out ? out : 1u << (ACTIVITY_LANES - 1);
}

/* Requests slightly more than the visible span, with bins at constant times, so that pans show no
 * gaps. */
static void request_clip(panel *self, const take_layer *of, const take_clip *clip, uint32_t owner,
                         uint32_t lanes)
{
    int64_t spare_ns = timeline_axis_span_ns(&self->axis, 0.25f * self->axis.width);
    int64_t from_ns = self->axis.from_ns - of->offset_ns - spare_ns;
    int64_t to_ns = timeline_axis_until_ns(&self->axis) - of->offset_ns + spare_ns;
    from_ns = from_ns < clip->start_ns ? clip->start_ns : from_ns;
    to_ns = to_ns > clip->end_ns ? clip->end_ns : to_ns;
    if (to_ns <= from_ns)
        return;
    timeline_strip strip = {.owner = owner,
                            .clip = clip->id,
                            .performance = clip->performance,
                            .part = clip->part,
                            .from_ns = clip->from_ns + take_warp_to_source(clip, from_ns),
                            .to_ns = clip->from_ns + take_warp_to_source(clip, to_ns),
                            .lanes = lanes};
    double across = (double)(to_ns - from_ns) / self->axis.ns_per_point;
    strip.bin_count = 1 + (uint32_t)(across / (double)BIN_POINTS);
    if (strip.to_ns > strip.from_ns)
        (void)timeline_request_add(&self->request, &strip);
}

static void request_layer(panel *self, const take_layer *of, uint32_t owner)
{
    uint32_t lanes = lanes_of(of);
    int64_t until_ns = timeline_axis_until_ns(&self->axis);
    for (uint32_t i = timeline_first_clip(of, self->axis.from_ns); i < of->clip_count; ++i) {
        if (of->clip[i].start_ns + of->offset_ns > until_ns)
            return;
        request_clip(self, of, &of->clip[i], owner, lanes);
    }
}

static void request_sound(panel *self, const take *t)
{
    const timeline_result *result = self->result;
    double rate = result->about.rate_hz > 0 ? result->about.rate_hz : 48000.0;
    double ns_per_frame = 1e9 / rate;
    self->request.audio = t->audio.audio;
    if (!t->audio.audio)
        return;
    int64_t from_ns = self->axis.from_ns - t->audio.offset_ns;
    int64_t to_ns = timeline_axis_until_ns(&self->axis) - t->audio.offset_ns;
    int64_t from = (int64_t)((double)from_ns / ns_per_frame) - 1;
    int64_t to = (int64_t)((double)to_ns / ns_per_frame) + 2;
    if (result->audio == t->audio.audio && to > result->about.frame_count)
        to = result->about.frame_count;
    self->request.audio_from = from < 0 ? 0 : from;
    self->request.audio_to = to;
    uint32_t pairs = (uint32_t)self->axis.width;
    self->request.audio_pairs = pairs > WAVEFORM_PAIRS_MAX ? WAVEFORM_PAIRS_MAX : pairs;
}

static void request_comps(panel *self, const take *t)
{
    const app_take_line *line;
    if (!self->has_comps)
        return;
    self->request.comps_of = t->id;
    self->request.comps_edition = 1 + app_takes(self->app, &line);
    memcpy(self->request.scene, t->scene, sizeof self->request.scene);
    memcpy(self->request.shot, t->shot, sizeof self->request.shot);
    for (uint32_t i = 0; self->comps && i < self->comps->count; ++i)
        if (self->comps->take[i].layer_count > 0) {
            const take_layer lane = timeline_comp_lane(self, i);
            request_layer(self, &lane, 1 + i);
        }
}

static void request(panel *self)
{
    const take *t = timeline_take(self);
    const app_take_line *line;
    show *from = app_show(self->app);
    follow_show(self, from ? show_path(from) : "");
    timeline_worker_set_show(self->worker, from ? show_path(from) : NULL, app_face_path(self->app));
    timeline_request_clear(&self->request);
    for (uint32_t i = 0; t && i < t->layer_count; ++i)
        request_layer(self, &t->layer[i], 0);
    if (t) {
        request_sound(self, t);
        request_comps(self, t);
    } else
        self->request.spans_edition = 1 + 2 * (uint64_t)app_takes(self->app, &line) +
                                      (app_status(self->app)->is_recording ? 1 : 0);
    timeline_worker_request(self->worker, &self->request);
}

static void look(panel *self)
{
    const take *t = app_take(self->app);
    self->result = timeline_worker_result(self->worker);
    self->comps = timeline_worker_comps(self->worker);
    if (!t || !self->has_comps || (self->comps && self->comps->of != t->id))
        self->comps = NULL;
}

/* ---- axis follows the playhead ---- */

static void follow_take(panel *self)
{
    const take *t = app_take(self->app);
    int64_t duration_ns = t ? t->duration_ns : 0;
    bool is_other = (t ? t->id : 0) != self->fitted_take;
    if (is_other)
        self->gesture = GESTURE_NONE;
    const bool is_resized = self->axis.width < self->fitted_width ||
                            self->axis.width > self->fitted_width ||
                            duration_ns != self->fitted_duration_ns;
    if (is_other || (self->is_fit && is_resized) ||
        app_take_request(self->app, ACTION_TIMELINE_FIT))
        timeline_fit(self);
    self->fitted_take = t ? t->id : 0;
    self->fitted_duration_ns = duration_ns;
    self->fitted_width = self->axis.width;
}

static void follow_head(panel *self)
{
    const transport *move = live_transport(app_live(self->app));
    int64_t head_ns = timeline_head_ns(self);
    bool moves = move && move->is_playing;
    if (self->gesture == GESTURE_NONE && self->is_following &&
        (moves || head_ns != self->last_head_ns) && timeline_axis_follow(&self->axis, head_ns))
        self->is_fit = false;
    self->last_head_ns = head_ns;
}

/* ---- drawing ---- */

/* Returns what the current drag does. "": nothing is told. */
static const char *drag_words(const panel *self)
{
    switch (self->gesture) {
    case GESTURE_SWIPE:
        return "Copies what is swiped into the take. With Ctrl: shift the other take.";
    case GESTURE_SLIDE:
        return "Shifts the other take in time.";
    case GESTURE_EDIT:
        break;
    default:
        return "";
    }
    switch (self->drag.kind) {
    case TIMELINE_DRAG_START:
    case TIMELINE_DRAG_END:
        return "Trims. With Ctrl: stretch.";
    case TIMELINE_DRAG_SPEED_START:
    case TIMELINE_DRAG_SPEED_END:
        return "Stretches.";
    default:
        return "";
    }
}

/* Whether times of the current drag snap to targets. The sound is aligned by ear. */
static bool drag_snaps(const panel *self)
{
    if (self->gesture == GESTURE_RANGE)
        return true;
    if (self->gesture != GESTURE_EDIT)
        return false;
    switch (self->drag.kind) {
    case TIMELINE_DRAG_MOVE:
    case TIMELINE_DRAG_START:
    case TIMELINE_DRAG_END:
    case TIMELINE_DRAG_SPEED_START:
    case TIMELINE_DRAG_SPEED_END:
    case TIMELINE_DRAG_FADE_IN:
    case TIMELINE_DRAG_FADE_OUT:
    case TIMELINE_DRAG_MARKER:
        return true;
    default:
        return false;
    }
}

/* "Snaps to the playhead  (Shift: do not snap)" */
static void write_snap(const panel *self, char out[192])
{
    char target[128], keys[KEY_WORDS];
    const timeline_target to = timeline_snapped(self);
    out[0] = '\0';
    if (!drag_snaps(self))
        return;
    timeline_target_words(target, &to, app_take(self->app));
    key_map_words(&app_looks_of(self->app)->keys, ACTION_SNAP, keys);
    if (!app_looks_of(self->app)->is_snapping)
        (void)snprintf(out, 192, "Snap is off%s%s%s", keys[0] ? "  (" : "", keys,
                       keys[0] ? ": on)" : "");
    else if (self->is_free)
        (void)snprintf(out, 192, "Does not snap while Shift is held");
    else
        (void)snprintf(out, 192, "%s%sShift: do not snap", target, target[0] ? "  " : "");
}

/* Draws the status line of a drag: why it is refused, or else what it does, what follows it and
 * what it snaps to. */
static void paint_drag_status(panel *self, ui *on)
{
    const bool is_refused = self->gesture == GESTURE_EDIT && self->drag.why.text[0];
    char snaps[192], words[400];
    const char *does = drag_words(self);
    const bool ripples = self->gesture == GESTURE_EDIT && timeline_drag_ripples(&self->drag);
    write_snap(self, snaps);
    if (is_refused)
        (void)snprintf(words, sizeof words, "%.399s", self->drag.why.text);
    else
        (void)snprintf(words, sizeof words, "%s%s%s%s%s", snaps, snaps[0] && does[0] ? "  " : "",
                       does, ripples ? "  " : "", ripples ? "Ripple: what follows moves too." : "");
    if (!words[0])
        return;
    float width = ui_text_width(on, UI_STYLE_BODY, words), room = self->axis.width - 24.0f;
    width = width < room ? width : room;
    float y = self->rows.y + self->rows.height - 28.0f;
    ui_draw_box(on, (ui_rectangle){self->axis.x + 6.0f, y, width + 14.0f, 22.0f}, THEME_BAR, 4.0f);
    ui_draw_text(on, self->axis.x + 13.0f, y + 2.0f, UI_STYLE_BODY,
                 is_refused ? THEME_WARNING : THEME_TEXT, width + 1.0f, words);
}

static void draw_take(panel *self, ui *on, const ui_canvas *canvas)
{
    const take *t = timeline_take(self);
    timeline_rows_lay(&self->rows, t, self->comps ? self->comps->count : 0, canvas->where.x,
                      canvas->where.y, canvas->where.width, canvas->where.height, self->scroll);
    self->scroll = self->rows.scroll;
    timeline_mouse(self, on, canvas);
    const int64_t head_ns = timeline_head_ns(self);
    const bool is_over = app_view(self->app)->mode == LIVE_OVERDUBS;
    timeline_axis_hold(&self->axis, 0,
                       is_over && head_ns > t->duration_ns ? head_ns : t->duration_ns);
    if (!app_view(self->app)->is_recording_over)
        self->over_from_ns = -1;
    else if (self->over_from_ns < 0 || head_ns < self->over_from_ns)
        self->over_from_ns = head_ns;
    t = timeline_take(self);
    timeline_rows_lay(&self->rows, t, self->comps ? self->comps->count : 0, canvas->where.x,
                      canvas->where.y, canvas->where.width, canvas->where.height, self->scroll);
    timeline_paint_ruler(self, on);
    timeline_paint_corner(self, on, canvas);
    timeline_paint_rows(self, on);
    timeline_paint_over(self, on);
    timeline_paint_head(self, on);
    timeline_paint_snap(self, on);
    paint_drag_status(self, on);
}

static void draw_lanes(panel *self, ui *on, ui_rectangle where)
{
    ui_canvas canvas;
    ui_panel_begin(on, "timeline_lanes", where, UI_GROUND_NONE);
    ui_canvas_begin(on, "lanes", 0.0f, 0.0f, &canvas);
    ui_draw_box(on, where, THEME_PANEL, 0.0f);
    timeline_axis_set_extent(&self->axis, where.x + TIMELINE_HEAD_WIDTH,
                             where.width - TIMELINE_HEAD_WIDTH);
    follow_take(self);
    self->hint = "";
    /* During a live recording the timeline shows it, not the selected take. */
    const bool is_live =
        app_status(self->app)->is_recording && app_view(self->app)->mode == LIVE_PERFORMS;
    if (app_take(self->app) && !is_live) {
        if (self->gesture == GESTURE_KEEP)
            self->gesture = GESTURE_NONE;
        follow_head(self);
        draw_take(self, on, &canvas);
    } else {
        timeline_rows_lay(&self->rows, NULL, 0, where.x, where.y, where.width, where.height, 0.0f);
        timeline_paint_journal(self, on, &canvas);
    }
    ui_canvas_end(on);
    timeline_menu(self, on);
    ui_hint(on, self->hint);
    ui_panel_end(on);
    timeline_dialogs(self, on);
    timeline_takes_dialog(self, on);
    timeline_history_dialog(self, on);
}

/* ---- the panel ---- */

static void destroy(panel *self)
{
    if (!self)
        return;
    forget_slides(self);
    timeline_worker_destroy(self->worker);
    timeline_journal_destroy(self->journal);
    timeline_takes_finish(&self->takes);
    timeline_drag_finish(&self->drag);
    free(self);
}

static panel *create(app *of)
{
    panel *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    *self = (panel){.app = of,
                    .is_following = true,
                    .regions = 1u << OWN_MOUTH,
                    .journal_span_ns = 60 * NS_PER_S,
                    .fitted_take = -1,
                    .over_from_ns = -1,
                    .axis = {.width = 1.0f, .ns_per_point = 1e7}};
    self->worker = timeline_worker_create(app_plugins(of));
    self->journal = timeline_journal_create();
    if (self->worker && self->journal) {
        self->result = timeline_worker_result(self->worker);
        return self;
    }
    destroy(self);
    return NULL;
}

static void update(panel *self, double dt_s)
{
    live *stage = app_live(self->app);
    int64_t now_ns = clock_now_ns();
    uint32_t count = live_input_count(stage);
    timeline_takes_update(self, dt_s);
    for (uint32_t i = 0; i < count && i < JOURNAL_LANES; ++i) {
        mrt_sample sample;
        uint32_t channel_count;
        const mrt_channel *channel = input_channels(live_input(stage, i), &channel_count);
        if (!live_input_sample(stage, i, &sample) || !channel)
            continue;
        if (sample.count > channel_count)
            sample.count = channel_count;
        timeline_journal_note(self->journal, timeline_journal_input(stage, i), now_ns, &sample,
                              channel);
    }
}

/* Returns the width of the list of takes. */
static float width_of_list(const panel *self, float room)
{
    const float wished = app_looks_of(self->app)->takes_width, most = LIST_MOST * room;
    const float list = wished > 0.0f ? wished : room < NARROW ? NARROW_LIST : TIMELINE_LIST_WIDTH;
    return list < LIST_LEAST ? LIST_LEAST : list > most ? most : list;
}

static void draw(panel *self, ui *on, ui_rectangle where)
{
    const float list = width_of_list(self, where.width);
    float x = where.x + list + 1.0f, width = where.width - list - 1.0f;
    float y = where.y + TIMELINE_STRIP_HEIGHT;
    look(self);
    timeline_takes_draw(self, on, (ui_rectangle){where.x, where.y, list, where.height});
    timeline_strip_draw(self, on, (ui_rectangle){x, where.y, width, TIMELINE_STRIP_HEIGHT - 1.0f});
    draw_lanes(self, on, (ui_rectangle){x, y, width, where.height - TIMELINE_STRIP_HEIGHT});
    const float moved =
        ui_drag_edge(on, "timeline_edge",
                     (ui_rectangle){where.x + list - 0.5f * EDGE, where.y, EDGE, where.height},
                     UI_CURSOR_ACROSS);
    if (moved > 0.0f || moved < 0.0f)
        app_looks_of(self->app)->takes_width = fmaxf(list + moved, LIST_LEAST);
    request(self);
    if (timeline_worker_is_busy(self->worker))
        ui_want_frame(on, 0.08);
}

const panel_type panel_timeline = {create, destroy, draw, update};
