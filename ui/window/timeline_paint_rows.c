#include "window/timeline_state.h"

#include <math.h>
#include <stdio.h>

/* ---- heads ---- */

static void paint_switch(ui *on, timeline_box box, const char *letter, bool is_on, uint32_t colour)
{
    ui_rectangle where = {box.x, box.y, box.width, box.height};
    float width = ui_text_width(on, UI_STYLE_BODY, letter);
    ui_draw_box(on, where, is_on ? colour : THEME_RAISED, 4.0f);
    ui_draw_text(on, box.x + 0.5f * (box.width - width), box.y, UI_STYLE_BODY,
                 is_on ? THEME_STAGE : THEME_DIM, 0.0f, letter);
}

static void paint_gain(panel *self, ui *on, const timeline_row *row, double gain)
{
    timeline_box box = timeline_gain_box(&self->rows, row);
    char words[24];
    (void)snprintf(words, sizeof words, "%.0f %%", gain * 100.0);
    float width = ui_text_width(on, UI_STYLE_NUMBER, words);
    float share = (float)(gain / 2.0), y = box.y + box.height - 2.0f;
    share = share > 1.0f ? 1.0f : share;
    ui_draw_box(on, (ui_rectangle){box.x, box.y, box.width, box.height}, THEME_WELL, 4.0f);
    ui_draw_box(on, (ui_rectangle){box.x, y, box.width * share, 2.0f},
                gain == 1.0 ? 0x4a5058ffu : THEME_ACCENT, 1.0f);
    ui_draw_text(on, box.x + box.width - width - 5.0f, box.y, UI_STYLE_NUMBER,
                 gain == 1.0 ? THEME_DIM : THEME_TEXT, 0.0f, words);
}

static void paint_layer_head(panel *self, ui *on, const timeline_row *row, const take_layer *lane)
{
    const studio_choice *choice = studio_chosen(self->studio);
    char own[160];
    timeline_own_words(lane, own, sizeof own);
    float x = self->rows.x + 8.0f, width = TIMELINE_HEAD_WIDTH - 16.0f;
    float name = ui_text_width(on, UI_STYLE_STRONG, lane->name);
    float most = 0.62f * width;
    name = name < most ? name : most;
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
    const show_audio *about = &self->seen->about;
    bool is_known = self->seen->audio == t->audio.audio && about->name[0];
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
        timeline_paint_clip(self, on, timeline_clip_box(row, &self->axis, lane, clip), lane, clip,
                            owner, is_heard);
    }
}

static void paint_swipe(panel *self, ui *on, const timeline_row *row)
{
    if (self->gesture != GESTURE_SWIPE || row->kind != TIMELINE_COMP || self->pressed.row < 0 ||
        &self->rows.row[self->pressed.row] != row)
        return;
    int64_t from_ns = self->span_from_ns, to_ns = self->span_to_ns;
    float x0 = timeline_axis_x(&self->axis, from_ns < to_ns ? from_ns : to_ns);
    float x1 = timeline_axis_x(&self->axis, from_ns < to_ns ? to_ns : from_ns);
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
        paint_clips(self, on, row, lane, 0, own_layer_is_heard(t, row->index));
        timeline_paint_overlaps(self, on, row, lane);
    } else if (row->kind == TIMELINE_SOUND)
        timeline_paint_wave(self, on, row, t);
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
    const studio_choice *choice = studio_chosen(self->studio);
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

/* What is beyond the take's end is not played. */
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

static void paint_snap(panel *self, ui *on)
{
    if (self->gesture != GESTURE_EDIT || self->drag.snapped_ns == INT64_MIN)
        return;
    float x = timeline_axis_x(&self->axis, self->drag.snapped_ns);
    ui_draw_line(on, x, self->rows.lanes_y, x, self->rows.y + self->rows.height, THEME_ACCENT,
                 1.0f);
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
    paint_snap(self, on);
    ui_clip_end(on);
}
