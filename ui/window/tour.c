#include "window/tour.h"
#include "window/app/exporter.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char begun_key[] = "tour.begun"; /* of the settings */
static const double praise_s = 1.2;           /* for which a done step says so */

bool tour_is_new(app *of)
{
    return settings_number(app_settings(of), begun_key, 0.0) < 0.5;
}

static void enter(tour *self, app *of, tour_step step)
{
    self->step = step;
    self->done_s = 0.0;
    self->has_recorded = false;
    self->take = 0;
    if (step == TOUR_TRIM)
        app_looks_of(of)->layouts.now.has_timeline = true; /* the clips are there */
}

void tour_begin(tour *self, app *of)
{
    *self = (tour){.pull_count = app_pull_count(of)};
    enter(self, of, TOUR_PULL);
    settings_set_number(app_settings(of), begun_key, 1.0);
}

void tour_end(tour *self)
{
    self->step = TOUR_OFF;
}

offers_when tour_offers(const tour *self)
{
    if (self->step == TOUR_OFF || self->step == TOUR_DONE)
        return OFFERS_WHEN_EMPTY;
    if (self->done_s > 0.0)
        return OFFERS_NEVER;
    return self->step == TOUR_DEMO       ? OFFERS_DEMO
           : self->step == TOUR_OWN_HAND ? OFFERS_OWN_HAND
                                         : OFFERS_NEVER;
}

/* ---- whether a step is done ---- */

typedef enum whose_hand { HAND_OF_DEMO = 0, HAND_OF_PERSON } whose_hand;

static bool performs(app *of, whose_hand who)
{
    const live *stage = app_live(of);
    char demo[APP_DEMO_TEXT];
    const bool has_demo = app_demo_hand(demo);
    for (uint32_t i = 0; i < live_input_count(stage); ++i) {
        const bool is_demo = has_demo && strcmp(live_input_text(stage, i), demo) == 0;
        if (!live_input_is_own(stage, i) && is_demo == (who == HAND_OF_DEMO))
            return true;
    }
    return who == HAND_OF_PERSON && app_has_hand_keys(of);
}

static bool is_recorded(tour *self, app *of)
{
    const bool is_recording = app_status(of)->is_recording;
    self->has_recorded |= is_recording;
    return self->has_recorded && !is_recording;
}

/* The clips of the chosen take are as many as before, and shorter. */
static bool is_trimmed(tour *self, app *of)
{
    const take *t = app_take(of);
    uint32_t count = 0;
    int64_t sum_ns = 0;
    for (uint32_t l = 0; t && l < t->layer_count; ++l)
        for (uint32_t c = 0; c < t->layer[l].clip_count; ++c, ++count)
            sum_ns += t->layer[l].clip[c].end_ns - t->layer[l].clip[c].start_ns;
    const bool is_shorter =
        t && app_take_id(of) == self->take && count == self->clip_count && sum_ns < self->clips_ns;
    self->take = t ? app_take_id(of) : 0;
    self->clip_count = count;
    self->clips_ns = sum_ns;
    return is_shorter;
}

static bool is_done(tour *self, app *of)
{
    char demo[APP_DEMO_TEXT];
    switch (self->step) {
    case TOUR_PULL:
        return app_pull_count(of) != self->pull_count;
    case TOUR_DEMO:
        return performs(of, HAND_OF_DEMO) || !app_demo_hand(demo); /* it may not be installed */
    case TOUR_OWN_HAND:
        return performs(of, HAND_OF_PERSON);
    case TOUR_RECORD:
        return is_recorded(self, of);
    case TOUR_TRIM:
        return is_trimmed(self, of);
    case TOUR_EXPORT:
        return exporter_count(app_exporter(of)) > 0;
    default:
        return false;
    }
}

void tour_update(tour *self, app *of, double dt_s)
{
    if (self->step == TOUR_OFF || self->step == TOUR_DONE)
        return;
    if (self->done_s <= 0.0 && !is_done(self, of))
        return;
    self->done_s += dt_s > 0.0 ? dt_s : 1e-3;
    if (self->done_s >= praise_s)
        enter(self, of, (tour_step)(self->step + 1));
    app_want_frame(of, 0.0);
}

/* ---- the card ---- */

static const float margin = 4.0f;

/* A face has the middle of its picture, so that much is free beside it. */
static float width_beside(ui_rectangle over)
{
    return fminf(196.0f, 0.33f * over.width - 2.0f * margin);
}

/* The sentence of the step, with the keys of the person. */
static void sentence_of(const tour *self, app *of, char *out, size_t capacity)
{
    const key_map *keys = &app_looks_of(of)->keys;
    char after[KEY_WORDS + 4] = "";
    switch (self->step) {
    case TOUR_PULL:
        (void)snprintf(out, capacity, "Drag the mouth with the mouse.");
        break;
    case TOUR_DEMO:
        (void)snprintf(out, capacity, "Click \"Try a demo hand\" to see a hand perform.");
        break;
    case TOUR_OWN_HAND:
        (void)snprintf(out, capacity,
                       "Use your own hand: a camera, the keyboard, or a glove in Devices.");
        break;
    case TOUR_RECORD:
        if (!app_has_hand_keys(of)) /* the keyboard is no hand, so its keys are free */
            key_map_after(keys, ACTION_RECORD, after);
        (void)snprintf(out, capacity,
                       app_status(of)->is_recording
                           ? "Click the red square at the top%s to stop."
                           : "Click the red circle at the top%s to record.",
                       after);
        break;
    case TOUR_TRIM:
        (void)snprintf(out, capacity,
                       app_take_id(of) ? "Drag an end of the clip below to trim it."
                                       : "Click the take in the list below.");
        break;
    case TOUR_EXPORT:
        key_map_after(keys, ACTION_EXPORT, after);
        (void)snprintf(out, capacity, "Right-click the take in the list, and export it%s.", after);
        break;
    default:
        key_map_after(keys, ACTION_TOUR, after);
        (void)snprintf(out, capacity, "That is all. The action Tour%s starts it again.", after);
        break;
    }
}

/* A thin bar of six parts: the steps that are done are filled. */
static void draw_progress(const tour *self, ui *on)
{
    const float gap = 3.0f, wide = (ui_available_width(on) - 5.0f * gap) / (float)TOUR_STEPS;
    ui_canvas at;
    ui_canvas_begin(on, "progress", 0.0f, 4.0f, &at);
    for (int i = TOUR_PULL; i <= TOUR_EXPORT; ++i) {
        const bool is_past = i < (int)self->step || (i == (int)self->step && self->done_s > 0.0);
        const ui_rectangle part = {at.where.x + (float)(i - TOUR_PULL) * (wide + gap), at.where.y,
                                   wide, 4.0f};
        ui_draw_box(on, part, is_past ? THEME_ACCENT : THEME_WELL, 2.0f);
    }
    ui_canvas_end(on);
}

/* Steps of the face and of the bar have their card above, those of the offers and of the timeline
 * below. Where the offers are in the way, it lies at the right; so do both beside the camera. */
static ui_rectangle place_of(const tour *self, const tour_room *room, float width, float height)
{
    const ui_rectangle over = room->face;
    const bool is_high = self->step == TOUR_PULL || self->step == TOUR_RECORD;
    const float bottom = over.y + over.height - height - margin;
    const float above_offers = bottom - room->offers_height;
    const bool is_right = room->has_camera || above_offers < over.y + margin;
    const float low = is_right && !room->has_camera ? bottom : above_offers;
    const float y = is_high && !is_right ? over.y + margin : low;
    return (ui_rectangle){is_right ? over.x + over.width - width - margin : over.x + margin,
                          fmaxf(y, over.y + margin), width, height};
}

void tour_draw(tour *self, app *of, ui *on, const tour_room *room)
{
    char words[160], title[32];
    if (self->step == TOUR_OFF)
        return;
    sentence_of(self, of, words, sizeof words);
    const float width = width_beside(room->face), inside = width - 2.0f * THEME_PADDING;
    const float lines = ceilf(1.15f * ui_text_width(on, UI_STYLE_BODY, words) / inside);
    const float line = ui_text_height(on, UI_STYLE_BODY) + 4.0f;
    const float text = lines * line + 6.0f;
    const float height = 2.0f * THEME_PADDING + 14.0f + line + text + 8.0f + ui_row_height(on);
    const bool is_over = self->step == TOUR_DONE;
    ui_panel_begin(on, "tour", place_of(self, room, width, height), UI_GROUND_PANEL);
    draw_progress(self, on);
    (void)snprintf(title, sizeof title, "Tour, %d of %d", (int)self->step, (int)TOUR_STEPS);
    if (self->done_s > 0.0)
        ui_text(on, UI_STYLE_GOOD, "Done");
    else
        ui_text(on, UI_STYLE_DIM, is_over ? "Tour" : title);
    ui_scroll_begin(on, "sentence", 0.0f, text);
    ui_text_wrapped(on, UI_STYLE_BODY, words);
    ui_scroll_end(on);
    if (!is_over && self->done_s <= 0.0) {
        if (ui_button(on, "Skip step", UI_QUIET))
            enter(self, of, (tour_step)(self->step + 1));
        ui_hint(on, "Go to the next step of the tour.");
        ui_same_line(on);
    }
    if (ui_button(on, is_over ? "Close" : "End", UI_QUIET))
        tour_end(self);
    ui_hint(on, "End the tour (Esc). It does not come again by itself.");
    ui_panel_end(on);
}
