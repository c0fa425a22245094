#include "window/timeline/timeline.h"

#include "base/clock.h"

#include <math.h>
#include <string.h>

#define START_POINTS 3.0f /* movement that starts a drag */
#define SNAP_POINTS  8.0f
#define NOTCH        1.25 /* zoom factor per notch of the wheel */
#define FLAG_POINTS  60.0f
#define SCROLL_SHARE 0.12f /* scroll per frame, share of the distance beyond the edge */

/* ---- position of the pointer ---- */

static float screen_x(const ui_canvas *canvas)
{
    return canvas->where.x + canvas->x;
}

int64_t timeline_sound_ns(const panel *self)
{
    const take *t = app_take(self->app);
    const show_audio *about = &self->result->about;
    const bool is_known = t && t->audio.audio && self->result->audio == t->audio.audio;
    return is_known && about->rate_hz > 0
               ? (int64_t)((double)about->frame_count * 1e9 / (double)about->rate_hz)
               : 0;
}

static timeline_hit hit_now(const panel *self, const ui_canvas *canvas)
{
    timeline_under under = {.rows = &self->rows,
                            .axis = &self->axis,
                            .take = timeline_take(self),
                            .flag_width = FLAG_POINTS,
                            .sound_ns = timeline_sound_ns(self)};
    (void)timeline_range(self, &under.in_ns, &under.out_ns);
    return timeline_hit_at(&under, screen_x(canvas), canvas->where.y + canvas->y);
}

static int64_t pointed_ns(const panel *self, const ui_canvas *canvas)
{
    return timeline_axis_ns(&self->axis, screen_x(canvas));
}

static timeline_snap snap_now(const panel *self, bool is_free)
{
    timeline_snap snap = {.take = app_take(self->app),
                          .code = timeline_code_now(self),
                          .head_ns = timeline_head_ns(self),
                          .without_clip = self->drag.clip,
                          .without_marker = -1};
    (void)timeline_range(self, &snap.in_ns, &snap.out_ns);
    if (self->drag.kind == TIMELINE_DRAG_MARKER)
        snap.without_marker = (int32_t)self->drag.marker;
    const live_click click = app_click(self->app);
    snap.is_beat = click.when != LIVE_CLICK_OFF;
    snap.beat_ns = snap.is_beat ? (int64_t)(60e9 / click.bpm) : NS_PER_S;
    if (app_looks_of(self->app)->is_snapping && !is_free)
        snap.reach_ns = timeline_axis_span_ns(&self->axis, SNAP_POINTS);
    return snap;
}

/* ---- the wheel ---- */

static void turn_wheel(panel *self, const ui_canvas *canvas)
{
    if (!canvas->is_hovered || (canvas->wheel_x == 0.0f && canvas->wheel_y == 0.0f))
        return;
    if (screen_x(canvas) < self->axis.x) {
        self->scroll -= canvas->wheel_y * 30.0f;
        return;
    }
    self->is_fit = false;
    if (canvas->modifiers & UI_SHIFT)
        timeline_axis_pan(&self->axis, 60.0f * (canvas->wheel_y + canvas->wheel_x));
    else {
        timeline_axis_zoom(&self->axis, screen_x(canvas), pow(NOTCH, (double)canvas->wheel_y));
        timeline_axis_pan(&self->axis, 60.0f * canvas->wheel_x);
    }
}

/* ---- pressing ---- */

static void choose(panel *self, timeline_hit hit)
{
    app_choice *choice = app_chosen(self->app);
    choice->layer = hit.layer;
    choice->clip = hit.clip;
    choice->marker = hit.part == TIMELINE_MARKER ? hit.marker : -1;
    choice->is_take = false;
}

static void scrub(panel *self, int64_t at_ns)
{
    const take *t = app_take(self->app);
    int64_t most_ns = t ? t->duration_ns : 0;
    at_ns = at_ns < 0 ? 0 : at_ns > most_ns ? most_ns : at_ns;
    if (at_ns != timeline_head_ns(self))
        app_seek(self->app, at_ns);
}

/* Returns the pressed comp lane; UINT32_MAX: none, or it no longer exists. */
static uint32_t pressed_comp(const panel *self)
{
    const uint32_t row = (uint32_t)self->pressed.row;
    if (!self->comps || self->pressed.row < 0 || row >= self->rows.count ||
        self->rows.row[row].index >= self->comps->count)
        return UINT32_MAX;
    return self->rows.row[row].index;
}

static void press_comp(panel *self, const ui_canvas *canvas)
{
    const uint32_t comp = pressed_comp(self);
    self->gesture = GESTURE_SWIPE;
    if (comp == UINT32_MAX || !(canvas->modifiers & UI_CONTROL))
        return;
    self->gesture = GESTURE_SLIDE;
    self->slid_from_ns = timeline_comp_later_ns(self, comp);
}

static void press_left(panel *self, const ui_canvas *canvas, timeline_hit hit)
{
    self->gesture = GESTURE_PRESSED;
    switch (hit.part) {
    case TIMELINE_NOWHERE:
        self->gesture = GESTURE_NONE;
        break;
    case TIMELINE_LANE:
        choose(self, hit);
        self->gesture = GESTURE_SCRUB;
        scrub(self, pointed_ns(self, canvas));
        break;
    case TIMELINE_SCRUB:
        self->gesture = GESTURE_SCRUB;
        scrub(self, pointed_ns(self, canvas));
        break;
    case TIMELINE_RANGE_IN:
    case TIMELINE_RANGE_OUT:
        self->gesture = GESTURE_RANGE;
        break;
    case TIMELINE_COMP_BODY:
        press_comp(self, canvas);
        break;
    case TIMELINE_RANGE:
        break;
    default:
        choose(self, hit);
        break;
    }
}

static void press(panel *self, const ui_canvas *canvas)
{
    timeline_hit hit = hit_now(self, canvas);
    self->pressed = hit;
    self->pressed_ns = self->span_from_ns = self->span_to_ns = pointed_ns(self, canvas);
    self->gesture = GESTURE_NONE;
    if (hit.part == TIMELINE_RANGE_IN || hit.part == TIMELINE_RANGE_OUT)
        (void)timeline_range(self, &self->span_from_ns, &self->span_to_ns);
    if (canvas->button == 0)
        press_left(self, canvas, hit);
    if (canvas->button == 2)
        self->gesture = GESTURE_PAN;
    if (canvas->button != 1)
        return;
    self->menu = hit;
    self->menu_ns = self->pressed_ns;
    if (hit.layer || hit.part == TIMELINE_MARKER)
        choose(self, hit);
}

/* ---- dragging ---- */

static void begin(panel *self, const ui_canvas *canvas)
{
    const take *t = app_take(self->app);
    float x = canvas->x - canvas->start_x, y = canvas->y - canvas->start_y;
    if (!t || (fabsf(x) < START_POINTS && fabsf(y) < 2.0f * START_POINTS))
        return;
    self->gesture = GESTURE_NONE;
    if (self->pressed.part == TIMELINE_RANGE) {
        self->gesture = GESTURE_RANGE;
        return;
    }
    timeline_drag_kind kind =
        timeline_drag_kind_of(self->pressed.part, (canvas->modifiers & UI_CONTROL) != 0);
    if (kind == TIMELINE_DRAG_NONE)
        return;
    timeline_drag_begin(&self->drag, kind, t, self->pressed, self->pressed_ns,
                        timeline_sound_ns(self));
    self->drag.is_ripple = app_looks_of(self->app)->is_rippling;
    self->edition = app_take_edition(self->app);
    self->gesture = GESTURE_EDIT;
}

static uint32_t layer_under(const panel *self, const ui_canvas *canvas)
{
    float y = canvas->where.y + canvas->y;
    const take *t = app_take(self->app);
    for (uint32_t i = 0; i < self->rows.count; ++i) {
        const timeline_row *row = &self->rows.row[i];
        if (row->kind == TIMELINE_LAYER && y >= row->y && y < row->y + row->height &&
            row->index < t->layer_count)
            return t->layer[row->index].id;
    }
    return 0;
}

static void drag_edit(panel *self, const ui_canvas *canvas)
{
    const take *t = app_take(self->app);
    self->is_free = (canvas->modifiers & UI_SHIFT) != 0;
    timeline_snap snap = snap_now(self, self->is_free);
    if (!t || self->edition != app_take_edition(self->app)) {
        timeline_drag_finish(&self->drag);
        self->gesture = GESTURE_NONE;
        return;
    }
    const uint32_t before = self->drag.edition;
    timeline_drag_to(&self->drag, t, &snap, pointed_ns(self, canvas), layer_under(self, canvas),
                     canvas->x - canvas->start_x);
    if (self->drag.edition != before && timeline_drag_moves_face(&self->drag))
        app_preview_take(self->app, self->drag.made.kind == EDIT_NONE ? NULL : &self->drag.preview);
}

/* Drags one end of the range: span_to. The other end stays. */
static void drag_range(panel *self, const ui_canvas *canvas)
{
    self->is_free = (canvas->modifiers & UI_SHIFT) != 0;
    timeline_snap snap = snap_now(self, self->is_free);
    const take *t = app_take(self->app);
    int64_t most_ns = t ? t->duration_ns : 0;
    snap.in_ns = snap.out_ns = 0; /* the range does not snap to itself */
    int64_t at_ns = timeline_snap_to(&snap, pointed_ns(self, canvas), &self->range_snapped);
    at_ns = at_ns < 0 ? 0 : at_ns > most_ns ? most_ns : at_ns;
    if (self->pressed.part == TIMELINE_RANGE_IN)
        self->span_from_ns = at_ns;
    else
        self->span_to_ns = at_ns;
}

/* Scrolls while the pointer drags beyond an edge. */
static void scroll_page(panel *self, const ui_canvas *canvas)
{
    float x = screen_x(canvas), end = self->axis.x + self->axis.width;
    bool is_gain = self->gesture == GESTURE_EDIT && (self->drag.kind == TIMELINE_DRAG_GAIN ||
                                                     self->drag.kind == TIMELINE_DRAG_ORDER);
    if (self->gesture == GESTURE_PAN || self->gesture == GESTURE_PRESSED || is_gain)
        return;
    float beyond = x < self->axis.x ? x - self->axis.x : x > end ? x - end : 0.0f;
    if (beyond != 0.0f)
        self->is_fit = false;
    timeline_axis_pan(&self->axis, -SCROLL_SHARE * beyond);
}

/* Slides a comp lane without snapping to frames, because it is aligned by ear and eye. */
static void slide_comp(panel *self, const ui_canvas *canvas)
{
    const uint32_t comp = pressed_comp(self);
    if (comp != UINT32_MAX)
        timeline_comp_slide(self, comp,
                            self->slid_from_ns + pointed_ns(self, canvas) - self->pressed_ns);
}

static void follow(panel *self, const ui_canvas *canvas)
{
    if (self->gesture == GESTURE_PRESSED)
        begin(self, canvas);
    switch (self->gesture) {
    case GESTURE_EDIT:
        drag_edit(self, canvas);
        break;
    case GESTURE_SCRUB:
        scrub(self, pointed_ns(self, canvas));
        break;
    case GESTURE_RANGE:
        drag_range(self, canvas);
        break;
    case GESTURE_SWIPE:
        self->span_to_ns = pointed_ns(self, canvas);
        break;
    case GESTURE_SLIDE:
        slide_comp(self, canvas);
        break;
    case GESTURE_PAN:
        self->is_fit = false;
        timeline_axis_pan(&self->axis, canvas->moved_x);
        self->scroll -= canvas->moved_y;
        break;
    default:
        return;
    }
    scroll_page(self, canvas);
}

/* ---- release ---- */

static void flip(panel *self, edit_kind kind, bool is_muted, bool is_solo, bool is_additive)
{
    edit e;
    edit_init(&e, kind);
    e.layer = self->pressed.layer;
    e.is_muted = is_muted;
    e.is_solo = is_solo;
    e.is_additive = is_additive;
    timeline_edit(self, &e);
}

static void click(panel *self, const ui_canvas *canvas)
{
    const take *t = app_take(self->app);
    const take_layer *lane = t ? timeline_layer(t, self->pressed.layer) : NULL;
    app_choice *choice = app_chosen(self->app);
    timeline_hit hit = hit_now(self, canvas);
    if (!lane || hit.part != self->pressed.part || hit.layer != self->pressed.layer)
        return;
    if (hit.part == TIMELINE_MUTE)
        flip(self, EDIT_LAYER_MUTE, !lane->is_muted, false, false);
    else if (hit.part == TIMELINE_SOLO)
        flip(self, EDIT_LAYER_SOLO, false, !lane->is_solo, false);
    else if (hit.part == TIMELINE_ADDITIVE)
        flip(self, EDIT_LAYER_ADDITIVE, false, false, !lane->is_additive);
    else if (hit.part == TIMELINE_ARM)
        choice->armed = choice->armed == lane->id ? 0 : lane->id;
}

static void end_edit(panel *self)
{
    edit made = self->drag.made;
    error why = self->drag.why;
    self->drag.made = (edit){0};
    timeline_drag_finish(&self->drag);
    if (made.kind != EDIT_NONE) {
        timeline_edit(self, &made);
        return;
    }
    app_preview_take(self->app, NULL);
    if (why.text[0])
        timeline_report(self, &why);
}

static void end_range(panel *self)
{
    int64_t in_ns, out_ns;
    timeline_span_now(self, &in_ns, &out_ns);
    if (in_ns < out_ns)
        app_set_range(self->app, in_ns < 0 ? 0 : in_ns, out_ns);
}

static void end_swipe(panel *self)
{
    const take *t = app_take(self->app);
    const uint32_t comp = pressed_comp(self);
    error err = {""};
    if (!t || comp == UINT32_MAX)
        return;
    int64_t in_ns, out_ns;
    timeline_span_now(self, &in_ns, &out_ns);
    edit made[TIMELINE_DRAG_EDITS];
    const edit *list[TIMELINE_DRAG_EDITS];
    uint32_t count =
        timeline_comp_edits(made, t, &self->comps->take[comp], timeline_comp_later_ns(self, comp),
                            self->regions, &in_ns, &out_ns, &err);
    for (uint32_t i = 0; i < count; ++i)
        list[i] = &made[i];
    if (count)
        (void)!app_edit_all(self->app, list, count); /* the function reports its own errors */
    else
        timeline_report(self, &err);
    for (uint32_t i = 0; i < count; ++i)
        edit_finish(&made[i]);
}

static void release(panel *self, const ui_canvas *canvas)
{
    timeline_gesture gesture = self->gesture;
    if (gesture == GESTURE_PRESSED)
        click(self, canvas);
    if (gesture == GESTURE_RANGE)
        end_range(self);
    self->gesture = GESTURE_NONE;
    if (gesture == GESTURE_EDIT)
        end_edit(self);
    if (gesture == GESTURE_SWIPE)
        end_swipe(self);
    if (gesture == GESTURE_SLIDE && pressed_comp(self) != UINT32_MAX)
        timeline_slide_note(self, pressed_comp(self), self->slid_from_ns);
}

/* ---- double clicks ---- */

static void split(panel *self, timeline_hit hit, int64_t at_ns)
{
    timeline_snap snap = snap_now(self, false);
    edit e;
    edit_init(&e, EDIT_CLIP_SPLIT);
    e.clip = hit.clip;
    e.at_ns = timeline_snap_to(&snap, at_ns, NULL);
    timeline_edit(self, &e);
}

static void reset_gain(panel *self, timeline_hit hit)
{
    edit e;
    edit_init(&e, hit.layer ? EDIT_LAYER_GAIN : EDIT_AUDIO_GAIN);
    e.layer = hit.layer;
    timeline_edit(self, &e);
}

static void lay_back(panel *self, uint32_t comp)
{
    const int64_t before_ns = timeline_comp_later_ns(self, comp);
    timeline_comp_slide(self, comp, 0);
    timeline_slide_note(self, comp, before_ns);
}

static void double_click(panel *self, ui *on, const ui_canvas *canvas)
{
    timeline_hit hit = hit_now(self, canvas);
    self->gesture = GESTURE_NONE;
    self->menu_ns = pointed_ns(self, canvas);
    if (hit.part == TIMELINE_RANGE || hit.part == TIMELINE_SCRUB)
        timeline_ask_marker(self, on, -1);
    else if (hit.part == TIMELINE_MARKER)
        timeline_ask_marker(self, on, hit.marker);
    else if (hit.part == TIMELINE_NAME && hit.layer)
        timeline_ask_layer(self, on, hit.layer);
    else if (hit.part == TIMELINE_GAIN)
        reset_gain(self, hit);
    else if (hit.part == TIMELINE_COMP_BODY && pressed_comp(self) != UINT32_MAX)
        lay_back(self, pressed_comp(self));
    else if (hit.clip && canvas->modifiers & UI_CONTROL)
        split(self, hit, self->menu_ns);
    else if (hit.clip)
        timeline_ask_clip(self, on, hit.clip);
}

/* ---- cursor and hints ---- */

#define TRIM_HINT       "Drag to trim the clip. Hold Ctrl to stretch it."
#define TRIM_SOUND_HINT "Drag to trim the sound."

static const struct {
    ui_cursor cursor;
    const char *hint; /* NULL: none */
} looks[TIMELINE_PARTS] = {
    [TIMELINE_MUTE] = {UI_CURSOR_HAND, "Mute the layer."},
    [TIMELINE_SOLO] = {UI_CURSOR_HAND, "Solo: play only the layers that are set to solo."},
    [TIMELINE_ADDITIVE] = {UI_CURSOR_HAND,
                           "Add this layer to the layers below. If off, its clips replace them."},
    [TIMELINE_ARM] = {UI_CURSOR_HAND, "Arm: record overdubs into this layer."},
    [TIMELINE_GAIN] = {UI_CURSOR_ACROSS,
                       "Drag to set the gain. Double-click to reset it to 100 %."},
    [TIMELINE_COMP_BODY] = {UI_CURSOR_CROSS,
                            "Swipe a span to copy the selected parts into the take. Hold Ctrl to "
                            "shift this other take in time. Double-click to reset the shift."},
    [TIMELINE_CLIP_START] = {UI_CURSOR_ACROSS, TRIM_HINT},
    [TIMELINE_CLIP_END] = {UI_CURSOR_ACROSS, TRIM_HINT},
    [TIMELINE_SOUND_START] = {UI_CURSOR_ACROSS, TRIM_SOUND_HINT},
    [TIMELINE_SOUND_END] = {UI_CURSOR_ACROSS, TRIM_SOUND_HINT},
    [TIMELINE_MARKER] = {UI_CURSOR_ACROSS, "Drag to move the marker. Double-click to name it."},
    [TIMELINE_RANGE_IN] = {UI_CURSOR_ACROSS, NULL},
    [TIMELINE_RANGE_OUT] = {UI_CURSOR_ACROSS, NULL},
    [TIMELINE_FADE_IN] = {UI_CURSOR_ACROSS, NULL},
    [TIMELINE_FADE_OUT] = {UI_CURSOR_ACROSS, NULL},
};

static ui_cursor cursor_of(const panel *self, timeline_hit hit)
{
    const timeline_part part = self->gesture == GESTURE_NONE ? hit.part : self->pressed.part;
    const bool is_body = part == TIMELINE_CLIP || part == TIMELINE_SOUND_BODY;
    if (self->gesture == GESTURE_PAN || (self->gesture == GESTURE_EDIT && is_body))
        return UI_CURSOR_MOVE;
    return looks[part].cursor;
}

void timeline_mouse(panel *self, ui *on, const ui_canvas *canvas)
{
    turn_wheel(self, canvas);
    if (self->gesture != GESTURE_NONE && ui_is_down(on, UI_KEY_ESCAPE)) {
        timeline_drag_finish(&self->drag);
        app_preview_take(self->app, NULL);
        self->gesture = GESTURE_NONE;
    }
    if (canvas->is_pressed)
        press(self, canvas);
    if (canvas->is_dragging || canvas->is_released)
        follow(self, canvas);
    if (canvas->is_released)
        release(self, canvas);
    if (canvas->is_double_clicked)
        double_click(self, on, canvas);
    timeline_hit hit = hit_now(self, canvas);
    self->hint = looks[hit.part].hint;
    if (!self->hint || self->gesture != GESTURE_NONE || !canvas->is_hovered)
        self->hint = "";
    if (canvas->is_hovered || self->gesture != GESTURE_NONE)
        ui_set_cursor(on, cursor_of(self, hit));
}
