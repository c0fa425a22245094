/* The context menus and dialogs of the timeline. */
#include "window/timeline/timeline.h"
#include "stage/voice/voice_mouth.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DIALOG_WIDTH 380.0f
#define LABEL_WIDTH  110.0f

static void do_edit(panel *self, edit_kind kind, uint32_t lane)
{
    edit e;
    edit_init(&e, kind);
    e.layer = lane;
    timeline_edit(self, &e);
}

/* ---- menus ---- */

/* Chooses the colour of a clip, or of a layer if clip is 0. */
static void put_colours(panel *self, ui *on, edit_kind kind, uint32_t lane, uint32_t clip,
                        uint32_t colour)
{
    const char *names[TAKE_COLOURS];
    uint32_t chips[TAKE_COLOURS];
    edit e;
    for (uint32_t i = 0; i < TAKE_COLOURS; ++i) {
        names[i] = timeline_colours[i].name;
        chips[i] = timeline_colours[i].curve;
    }
    edit_init(&e, kind);
    e.layer = lane;
    e.clip = clip;
    e.colour = colour;
    if (ui_menu_colours(on, "Colour", names, chips, TAKE_COLOURS, &e.colour))
        timeline_edit(self, &e);
}

static void clip_menu(panel *self, ui *on, const take *t)
{
    const take_layer *lane;
    const take_clip *clip = timeline_clip(t, self->menu.clip, &lane);
    char keys[KEY_WORDS];
    if (!clip)
        return;
    key_map_words(&app_looks_of(self->app)->keys, ACTION_SPLIT, keys);
    if (ui_menu_item(on, "Split at playhead", keys, app_can(self->app, ACTION_SPLIT, NULL)))
        app_do(self->app, ACTION_SPLIT);
    if (ui_menu_item(on, clip->is_muted ? "Unmute" : "Mute", "", true)) {
        edit e;
        edit_init(&e, EDIT_CLIP_MUTE);
        e.clip = clip->id;
        e.is_muted = !clip->is_muted;
        timeline_edit(self, &e);
    } else if (ui_menu_item(on, "Speed, gain, fades \u2026", "", true))
        timeline_ask_clip(self, on, clip->id);
    const take_clip *kept = timeline_clip(app_take(self->app), self->menu.clip, &lane);
    if (kept)
        put_colours(self, on, EDIT_CLIP_COLOUR, 0, kept->id, kept->colour);
    key_map_words(&app_looks_of(self->app)->keys, ACTION_REMOVE, keys);
    const bool ripples = app_looks_of(self->app)->is_rippling;
    if (ui_menu_item(on, ripples ? "Remove and close gap" : "Remove", keys, true)) {
        edit e;
        edit_init(&e, EDIT_CLIP_REMOVE);
        e.clip = self->menu.clip;
        e.is_ripple = ripples;
        timeline_edit(self, &e);
    }
}

static void move_layer(panel *self, const take_layer *lane, uint32_t layer_index)
{
    edit e;
    edit_init(&e, EDIT_LAYER_ORDER);
    e.layer = lane->id;
    e.place = layer_index;
    timeline_edit(self, &e);
}

static void layer_menu(panel *self, ui *on, const take *t)
{
    const take_layer *lane = timeline_layer(t, self->menu.layer);
    if (!lane)
        return;
    uint32_t layer_index = (uint32_t)(lane - t->layer);
    put_colours(self, on, EDIT_LAYER_COLOUR, lane->id, 0, lane->colour);
    t = app_take(self->app); /* the edit has made another one */
    lane = timeline_layer(t, self->menu.layer);
    if (!lane)
        return;
    if (ui_menu_item(on, "Name and parts \u2026", "", true))
        timeline_ask_layer(self, on, lane->id);
    else if (ui_menu_item(on, "Move up", "", layer_index + 1 < t->layer_count))
        move_layer(self, lane, layer_index + 1);
    else if (ui_menu_item(on, "Move down", "", layer_index > 0))
        move_layer(self, lane, layer_index - 1);
    else if (ui_menu_item(on, "Remove", "", true))
        do_edit(self, EDIT_LAYER_REMOVE, lane->id);
}

static void marker_menu(panel *self, ui *on)
{
    if (ui_menu_item(on, "Name \u2026", "", true))
        timeline_ask_marker(self, on, self->menu.marker);
    if (!ui_menu_item(on, "Remove", "", true))
        return;
    edit e;
    edit_init(&e, EDIT_MARKER_REMOVE);
    e.marker = (uint32_t)self->menu.marker;
    timeline_edit(self, &e);
    app_chosen(self->app)->marker = -1;
}

static void cut_range(panel *self, edit_kind kind, bool is_ripple)
{
    edit e;
    edit_init(&e, kind);
    (void)timeline_range(self, &e.in_ns, &e.out_ns);
    e.is_ripple = is_ripple;
    timeline_edit(self, &e);
}

static void ruler_menu(panel *self, ui *on)
{
    int64_t in_ns, out_ns;
    bool has_range = timeline_range(self, &in_ns, &out_ns);
    if (ui_menu_item(on, "Marker here \u2026", "", true))
        timeline_ask_marker(self, on, -1);
    if (ui_menu_item(on, "Remove range", "", has_range))
        app_set_range(self->app, 0, 0);
    if (ui_menu_item(on, "Crop to range", "", has_range))
        cut_range(self, EDIT_RANGE_KEEP, false);
    if (ui_menu_item(on, "Cut range and close gap", "", has_range))
        cut_range(self, EDIT_RANGE_CUT, true);
    if (ui_menu_item(on, "Clear range and leave gap", "", has_range))
        cut_range(self, EDIT_RANGE_CUT, false);
    if (ui_menu_item(on, "Insert a gap of that length", "", has_range)) {
        edit e;
        edit_init(&e, EDIT_RANGE_INSERT);
        e.at_ns = in_ns;
        e.length_ns = out_ns - in_ns;
        timeline_edit(self, &e);
    }
}

static void keep_span(panel *self, int64_t in_ns, int64_t out_ns)
{
    edit e;
    edit_init(&e, EDIT_RANGE_KEEP);
    e.in_ns = in_ns;
    e.out_ns = out_ns;
    timeline_edit(self, &e);
}

static void lane_menu(panel *self, ui *on, const take *t)
{
    if (ui_menu_item(on, "Add a layer \u2026", "", t->layer_count < EDIT_LAYERS_MAX))
        timeline_ask_layer(self, on, 0);
    const bool is_within = self->menu_ns > 0 && self->menu_ns < t->duration_ns;
    if (ui_menu_item(on, "Trim start to here", "", is_within))
        keep_span(self, self->menu_ns, t->duration_ns);
    if (ui_menu_item(on, "Trim end to here", "", is_within))
        keep_span(self, 0, self->menu_ns);
    char keys[KEY_WORDS];
    key_map_words(&app_looks_of(self->app)->keys, ACTION_TIMELINE_FIT, keys);
    if (ui_menu_item(on, "Zoom to the whole take", keys, true))
        timeline_fit(self);
}

static void ask_mouth(panel *self, ui *on)
{
    if (self->jaw_lips[0] <= 0.0 && self->jaw_lips[1] <= 0.0)
        self->jaw_lips[0] = self->jaw_lips[1] = 100.0;
    ui_dialog_open(on, "timeline_mouth");
    self->is_asked_first = true;
}

static void sound_menu(panel *self, ui *on, const take_audio *audio)
{
    edit e;
    if (ui_menu_item(on, "Mouth from this voice \u2026", "", audio->audio != 0))
        ask_mouth(self, on);
    if (ui_menu_item(on, "Sync of mouth and sound \u2026", "", audio->audio != 0))
        timeline_ask_sync(self, on);
    if (ui_menu_item(on, "Align with the take start", "", true)) {
        edit_init(&e, EDIT_AUDIO_OFFSET);
        e.offset_ns = 0;
        timeline_edit(self, &e);
    }
    const int64_t sound_ns = timeline_sound_ns(self);
    const int64_t head_ns = live_position(app_live(self->app)).at_ns;
    edit_init(&e, EDIT_AUDIO_TRIM);
    if (ui_menu_item(on, "Trim start to playhead", "", true)) {
        e.start_ns = head_ns;
        timeline_edit(self, &e);
    }
    if (ui_menu_item(on, "Trim end to playhead", "", true)) {
        e.end_ns = head_ns;
        timeline_edit(self, &e);
    }
    if (ui_menu_item(on, "Restore the whole sound", "",
                     (audio->in_ns > 0 || audio->out_ns > 0) && sound_ns > 0)) {
        e.start_ns = audio->offset_ns;
        e.end_ns = audio->offset_ns + sound_ns;
        timeline_edit(self, &e);
    }
    if (ui_menu_item(on, "Gain 100 %", "", audio->gain != 1.0)) {
        edit_init(&e, EDIT_AUDIO_GAIN);
        timeline_edit(self, &e);
    }
    if (ui_menu_item(on, "Remove sound", "", true))
        do_edit(self, EDIT_AUDIO_DETACH, 0);
}

static bool is_ruler(timeline_part part)
{
    return part == TIMELINE_RANGE || part == TIMELINE_RANGE_IN || part == TIMELINE_RANGE_OUT ||
           part == TIMELINE_SCRUB;
}

void timeline_menu(panel *self, ui *on)
{
    const take *t = app_take(self->app);
    bool is_sound = self->menu.row >= 0 && (uint32_t)self->menu.row < self->rows.count &&
                    self->rows.row[self->menu.row].kind == TIMELINE_SOUND;
    if (!t || !ui_menu_begin(on, "timeline_menu"))
        return;
    if (self->menu.clip)
        clip_menu(self, on, t);
    else if (self->menu.part == TIMELINE_MARKER)
        marker_menu(self, on);
    else if (is_ruler(self->menu.part))
        ruler_menu(self, on);
    else if (is_sound)
        sound_menu(self, on, &t->audio);
    else if (self->menu.layer && self->menu.part != TIMELINE_LANE)
        layer_menu(self, on, t);
    else
        lane_menu(self, on, t);
    ui_menu_end(on);
}

/* ---- dialog of a layer ---- */

void timeline_ask_layer(panel *self, ui *on, uint32_t id)
{
    const take *t = app_take(self->app);
    const take_layer *lane = t ? timeline_layer(t, id) : NULL;
    self->asked_layer = id;
    (void)snprintf(self->text, sizeof self->text, "%s", lane ? lane->name : "");
    self->asked_regions = lane ? timeline_own_regions(lane) : 0;
    self->is_everything = !lane || lane->own_count == 0;
    ui_dialog_open(on, "timeline_layer");
}

/* Collects the patterns of a layer and keeps patterns that belong to no region. */
static uint32_t gather_own(char (*out)[TAKE_NAME], const take_layer *lane, uint32_t regions)
{
    uint32_t count = 0, before = lane ? timeline_own_regions(lane) : 0;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        const own_part *part = own_part_of((own_region)region);
        for (uint32_t i = 0; regions & 1u << region && i < part->pattern_count; ++i)
            (void)snprintf(out[count++], TAKE_NAME, "%s", part->pattern[i]);
    }
    for (uint32_t i = 0; lane && i < lane->own_count && count < EDIT_OWN_MAX; ++i)
        if (!timeline_is_of_regions(lane->own[i], before))
            (void)snprintf(out[count++], TAKE_NAME, "%s", lane->own[i]);
    return count;
}

static bool is_same_own(const take_layer *lane, char (*own)[TAKE_NAME], uint32_t count)
{
    bool same = lane->own_count == count;
    for (uint32_t i = 0; same && i < count; ++i)
        same = strcmp(lane->own[i], own[i]) == 0;
    return same;
}

static void answer_layer(panel *self)
{
    const take *t = app_take(self->app);
    const take_layer *lane = t ? timeline_layer(t, self->asked_layer) : NULL;
    char own[EDIT_OWN_MAX][TAKE_NAME] = {{0}};
    uint32_t own_count = self->is_everything ? 0 : gather_own(own, lane, self->asked_regions);
    edit rename, parts;
    const edit *list[2];
    uint32_t count = 0;
    edit_init(&rename, lane ? EDIT_LAYER_RENAME : EDIT_LAYER_ADD);
    edit_init(&parts, EDIT_LAYER_OWN);
    rename.layer = parts.layer = self->asked_layer;
    (void)snprintf(rename.name, sizeof rename.name, "%.63s", self->text);
    parts.own = own;
    parts.own_count = own_count;
    if (!lane) {
        rename.own = own;
        rename.own_count = own_count;
    }
    if (!lane || strcmp(lane->name, rename.name) != 0)
        list[count++] = &rename;
    if (lane && !is_same_own(lane, own, own_count))
        list[count++] = &parts;
    if (t && count)
        (void)!app_edit_all(self->app, list, count);
}

static bool end_dialog(ui *on, const char *yes, bool can)
{
    bool is_done = false;
    ui_space(on, 8.0f);
    ui_disabled_begin(on, !can);
    if (ui_button(on, yes, UI_ACCENT) || (can && ui_pressed(on, UI_KEY_ENTER, 0)))
        is_done = true;
    ui_disabled_end(on);
    ui_same_line(on);
    if (ui_button(on, "Cancel", UI_QUIET) || is_done)
        ui_dialog_close(on);
    return is_done;
}

static void layer_dialog(panel *self, ui *on)
{
    if (!ui_dialog_begin(on, "timeline_layer", self->asked_layer ? "Layer" : "New layer",
                         DIALOG_WIDTH))
        return;
    ui_text(on, UI_STYLE_DIM, "Name");
    ui_width(on, -1.0f);
    (void)ui_input(on, "##name", "mouth", self->text, TAKE_NAME);
    ui_space(on, 4.0f);
    ui_text(on, UI_STYLE_DIM, "Moves");
    (void)ui_check(on, "everything", &self->is_everything);
    ui_disabled_begin(on, self->is_everything);
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        bool has = self->is_everything || (self->asked_regions & 1u << region) != 0;
        if (region % 4 != 0)
            ui_at(on, (float)(region % 4) * 88.0f);
        if (ui_check(on, own_part_of((own_region)region)->name, &has))
            self->asked_regions ^= 1u << region;
    }
    ui_disabled_end(on);
    bool can = self->text[0] && (self->is_everything || self->asked_regions || self->asked_layer);
    if (end_dialog(on, self->asked_layer ? "Change" : "Add", can))
        answer_layer(self);
    ui_dialog_end(on);
}

/* ---- dialog of a clip ---- */

void timeline_ask_clip(panel *self, ui *on, uint32_t id)
{
    const take *t = app_take(self->app);
    const take_layer *lane;
    const take_clip *clip = t ? timeline_clip(t, id, &lane) : NULL;
    if (!clip)
        return;
    self->asked_clip = id;
    self->number[0] = floor(timeline_clip_speed(clip) * 1000.0 + 0.5) / 1000.0;
    self->number[1] = clip->gain * 100.0;
    self->number[2] = clip->smooth_s * 1000.0;
    self->number[3] = (double)clip->fade_in_ns * 1e-6;
    self->number[4] = (double)clip->fade_out_ns * 1e-6;
    memcpy(self->previewed, self->number, sizeof self->previewed);
    self->clip_why.text[0] = '\0';
    ui_dialog_open(on, "timeline_clip");
}

static int64_t ns_of_ms(double ms)
{
    return (int64_t)floor(ms * 1e6 + 0.5);
}

enum { CLIP_EDITS = 4 };

/* Makes the edits that give the clip the values of the dialog; only those that change it. */
static uint32_t make_clip_edits(const panel *self, edit out[CLIP_EDITS])
{
    const take *t = app_take(self->app);
    const take_layer *lane;
    const take_clip *clip = t ? timeline_clip(t, self->asked_clip, &lane) : NULL;
    uint32_t count = 0;
    if (!clip)
        return 0;
    const double speed = timeline_clip_speed(clip), gain = self->number[1] * 0.01;
    const double smooth_s = self->number[2] * 0.001;
    const int64_t in_ns = ns_of_ms(self->number[3]), out_ns = ns_of_ms(self->number[4]);
    if (fabs(self->number[0] - speed) > 0.0006) {
        edit_init(&out[count], EDIT_CLIP_SPEED);
        out[count].is_ripple = app_looks_of(self->app)->is_rippling;
        out[count++].speed = self->number[0] / speed;
    }
    if (fabs(gain - clip->gain) > 1e-4) {
        edit_init(&out[count], EDIT_CLIP_GAIN);
        out[count++].gain = gain;
    }
    if (fabs(smooth_s - clip->smooth_s) > 1e-6) {
        edit_init(&out[count], EDIT_CLIP_SMOOTH);
        out[count++].smooth_s = smooth_s;
    }
    if (in_ns != clip->fade_in_ns || out_ns != clip->fade_out_ns) {
        edit_init(&out[count], EDIT_CLIP_FADE);
        out[count].fade_in_ns = in_ns;
        out[count++].fade_out_ns = out_ns;
    }
    for (uint32_t i = 0; i < count; ++i)
        out[i].clip = self->asked_clip;
    return count;
}

static void answer_clip(panel *self)
{
    edit made[CLIP_EDITS];
    const edit *list[CLIP_EDITS];
    const uint32_t count = make_clip_edits(self, made);
    for (uint32_t i = 0; i < count; ++i)
        list[i] = &made[i];
    if (count && app_edit_all(self->app, list, count) >= 0)
        self->has_clip_preview = false;
}

/* Shows the values of the dialog on the stage. If they are not possible, the last possible ones
 * stay there. */
static void preview_clip(panel *self)
{
    edit made[CLIP_EDITS];
    const uint32_t count = make_clip_edits(self, made);
    take copy = {0};
    self->clip_why.text[0] = '\0';
    memcpy(self->previewed, self->number, sizeof self->previewed);
    if (count == 0) {
        app_preview_take(self->app, NULL);
        return;
    }
    mrt_result result = take_copy(&copy, app_take(self->app), &self->clip_why);
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = edit_apply_onto(&copy, &made[i], &self->clip_why);
    if (result >= 0) {
        app_preview_take(self->app, &copy);
        self->has_clip_preview = true;
    }
    take_finish(&copy);
}

static void clip_dialog(panel *self, ui *on)
{
    static const char *const label[5] = {"Speed", "Gain", "Smoothing", "Fade in", "Fade out"};
    static const ui_range range[5] = {{0.1, 4.0, "\u00d7", 3, false, 1.0},
                                      {0.0, 300.0, "%", 0, true, 100.0},
                                      {0.0, 500.0, "ms", 0, true, 0.0},
                                      {0.0, 5000.0, "ms", 0, true, 0.0},
                                      {0.0, 5000.0, "ms", 0, true, 0.0}};
    if (!ui_dialog_begin(on, "timeline_clip", "Clip", DIALOG_WIDTH)) {
        if (self->has_clip_preview)
            app_preview_take(self->app, NULL);
        self->has_clip_preview = false;
        return;
    }
    for (uint32_t i = 0; i < 5; ++i) {
        ui_width(on, -1.0f);
        (void)ui_slider(on, label[i], LABEL_WIDTH, &range[i], &self->number[i]);
    }
    if (memcmp(self->previewed, self->number, sizeof self->previewed) != 0)
        preview_clip(self);
    if (self->clip_why.text[0])
        ui_text_wrapped(on, UI_STYLE_WARNING, self->clip_why.text);
    if (end_dialog(on, "Change", !self->clip_why.text[0]))
        answer_clip(self);
    ui_dialog_end(on);
}

/* ---- dialog of a marker ---- */

void timeline_ask_marker(panel *self, ui *on, int32_t marker)
{
    const take *t = app_take(self->app);
    bool is_there = t && marker >= 0 && (uint32_t)marker < t->marker_count;
    self->asked_marker = is_there ? marker : -1;
    (void)snprintf(self->text, sizeof self->text, "%s", is_there ? t->marker[marker].text : "");
    self->is_asked_first = true;
    ui_dialog_open(on, "timeline_marker");
}

static void answer_marker(panel *self)
{
    const take *t = app_take(self->app);
    edit e;
    if (!t)
        return;
    edit_init(&e, self->asked_marker < 0 ? EDIT_MARKER_ADD : EDIT_MARKER_RENAME);
    e.marker = self->asked_marker < 0 ? 0 : (uint32_t)self->asked_marker;
    e.at_ns = self->menu_ns < 0                ? 0
              : self->menu_ns > t->duration_ns ? t->duration_ns
                                               : self->menu_ns;
    if (e.kind == EDIT_MARKER_RENAME)
        e.at_ns = EDIT_UNSAID;
    (void)snprintf(e.text, sizeof e.text, "%.95s", self->text);
    timeline_edit(self, &e);
}

static void marker_dialog(panel *self, ui *on)
{
    if (!ui_dialog_begin(on, "timeline_marker", self->asked_marker < 0 ? "New marker" : "Marker",
                         DIALOG_WIDTH))
        return;
    if (self->is_asked_first)
        ui_input_take_keys(on);
    self->is_asked_first = false;
    ui_width(on, -1.0f);
    (void)ui_input(on, "##text", "name of the marker", self->text, 96);
    bool is_entered = ui_input_is_entered(on);
    if (end_dialog(on, self->asked_marker < 0 ? "Add" : "Name", true) || is_entered) {
        answer_marker(self);
        ui_dialog_close(on);
    }
    ui_dialog_end(on);
}

/* ---- dialog of a mouth from the voice ---- */

static void mouth_dialog(panel *self, ui *on)
{
    static const char *const label[2] = {"Jaw", "Lips"};
    static const ui_range range = {0.0, 100.0 * VOICE_MOUTH_AXIS_MOST, "%", 0, true, 100.0};
    if (!ui_dialog_begin(on, "timeline_mouth", "Mouth from this voice", DIALOG_WIDTH))
        return;
    const double part = app_speech_part(self->app);
    ui_disabled_begin(on, part >= 0.0);
    ui_text(on, UI_STYLE_DIM, "Words that are said, if you know them");
    ui_width(on, -1.0f);
    if (self->is_asked_first)
        ui_input_take_keys(on);
    self->is_asked_first = false;
    (void)ui_input_lines(on, "##words", self->spoken, sizeof self->spoken, 84.0f);
    for (uint32_t i = 0; i < 2; ++i) {
        ui_width(on, -1.0f);
        (void)ui_slider(on, label[i], LABEL_WIDTH, &range, &self->jaw_lips[i]);
    }
    ui_disabled_end(on);
    ui_space(on, 8.0f);
    if (part >= 0.0) {
        char words[48];
        (void)snprintf(words, sizeof words, "Listening to the voice, %.0f %%", 100.0 * part);
        ui_text(on, UI_STYLE_DIM, words);
        if (ui_button(on, "Cancel", UI_QUIET))
            app_speech_cancel(self->app);
    } else {
        if (app_speech_result(self->app)[0])
            ui_text_wrapped(on, UI_STYLE_DIM, app_speech_result(self->app));
        if (ui_button(on, "Move the mouth", UI_ACCENT)) {
            const app_speech_wish wish = {self->spoken, 0.01 * self->jaw_lips[0],
                                          0.01 * self->jaw_lips[1]};
            (void)!app_speech_begin(self->app, &wish); /* the dialog shows why it failed */
        }
        ui_same_line(on);
        if (ui_button(on, "Close", UI_QUIET))
            ui_dialog_close(on);
    }
    ui_dialog_end(on);
}

void timeline_dialogs(panel *self, ui *on)
{
    mouth_dialog(self, on);
    timeline_sync_dialog(self, on);
    layer_dialog(self, on);
    clip_dialog(self, on);
    marker_dialog(self, on);
}
