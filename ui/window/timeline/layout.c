#include "window/timeline/layout.h"

#define GRAB   5.0f  /* grab distance on both sides of a handle */
#define EDGE   7.0f  /* grab distance of a clip edge, inside the clip */
#define CORNER 11.0f /* grab distance around the end of a fade, at the top of a clip */
#define GROW   1.4f  /* maximum growth of rows if there is space */

/* ---- layout ---- */

static void put(timeline_rows *out, timeline_row_kind kind, uint32_t index, float height)
{
    if (out->count >= TIMELINE_ROWS_MAX)
        return;
    out->row[out->count++] = (timeline_row){kind, index, out->full_height, height};
    out->full_height += height;
}

static float lay_rows(timeline_rows *out, const take *t, uint32_t comp_count, float growth)
{
    out->count = 0;
    out->full_height = 0.0f;
    for (uint32_t i = t->layer_count; i-- > 0;)
        put(out, TIMELINE_LAYER, i, TIMELINE_LAYER_HEIGHT * growth);
    if (t->audio.audio)
        put(out, TIMELINE_SOUND, 0, TIMELINE_SOUND_HEIGHT * growth);
    for (uint32_t i = 0; i < comp_count; ++i)
        put(out, TIMELINE_COMP, i, TIMELINE_COMP_HEIGHT);
    return out->full_height;
}

void timeline_rows_lay(timeline_rows *out, const take *t, uint32_t comp_count, float x, float y,
                       float width, float height, float scroll)
{
    *out = (timeline_rows){.x = x, .y = y, .width = width, .height = height};
    out->lanes_y = y + TIMELINE_RULER_HEIGHT;
    float room = height - TIMELINE_RULER_HEIGHT;
    if (!t)
        return;
    float needed = lay_rows(out, t, comp_count, 1.0f);
    float growth = needed > 0.0f ? room / needed : 1.0f;
    if (growth > 1.0f)
        (void)lay_rows(out, t, comp_count, growth < GROW ? growth : GROW);
    float most = out->full_height > room ? out->full_height - room : 0.0f;
    out->scroll = scroll < 0.0f ? 0.0f : scroll > most ? most : scroll;
    for (uint32_t i = 0; i < out->count; ++i)
        out->row[i].y += out->lanes_y - out->scroll;
}

ui_rectangle timeline_switch_box(const timeline_rows *rows, const timeline_row *row, uint32_t index)
{
    return (ui_rectangle){rows->x + 8.0f + (float)index * (TIMELINE_SWITCH_SIZE + 4.0f),
                          row->y + row->height - TIMELINE_SWITCH_SIZE - 4.0f, TIMELINE_SWITCH_SIZE,
                          TIMELINE_SWITCH_SIZE};
}

ui_rectangle timeline_gain_box(const timeline_rows *rows, const timeline_row *row)
{
    float x = rows->x + 8.0f + (float)TIMELINE_SWITCHES * (TIMELINE_SWITCH_SIZE + 4.0f);
    if (row->kind == TIMELINE_SOUND)
        x = rows->x + 8.0f;
    return (ui_rectangle){x, row->y + row->height - TIMELINE_SWITCH_SIZE - 4.0f,
                          rows->x + TIMELINE_HEAD_WIDTH - 8.0f - x, TIMELINE_SWITCH_SIZE};
}

ui_rectangle timeline_clip_box(const timeline_row *row, const timeline_axis *axis,
                               const take_layer *layer, const take_clip *clip)
{
    float x0 = timeline_axis_x(axis, clip->start_ns + layer->offset_ns);
    float x1 = timeline_axis_x(axis, clip->end_ns + layer->offset_ns);
    return (ui_rectangle){x0, row->y + 2.0f, x1 - x0, row->height - 4.0f};
}

uint32_t timeline_first_clip(const take_layer *layer, int64_t from_ns)
{
    uint32_t low = 0, high = layer->clip_count; /* ends have the same order as starts */
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (layer->clip[middle].end_ns + layer->offset_ns <= from_ns)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* ---- hit test ---- */

static bool is_near(float a, float b, float reach)
{
    return a - b <= reach && b - a <= reach;
}

static timeline_hit hit_of(timeline_part part)
{
    return (timeline_hit){.part = part, .row = -1, .marker = -1};
}

static int32_t marker_at(const timeline_under *under, float x)
{
    for (uint32_t i = under->take ? under->take->marker_count : 0; i-- > 0;) {
        float at = timeline_axis_x(under->axis, under->take->marker[i].at_ns);
        if (x >= at - 3.0f && x <= at + under->flag_width)
            return (int32_t)i;
    }
    return -1;
}

static timeline_hit hit_ruler(const timeline_under *under, float x, float y)
{
    const timeline_axis *axis = under->axis;
    if (x < axis->x)
        return hit_of(TIMELINE_NOWHERE);
    if (y >= under->rows->y + TIMELINE_RANGE_HEIGHT)
        return hit_of(TIMELINE_SCRUB);
    if (under->in_ns < under->out_ns) {
        float in = timeline_axis_x(axis, under->in_ns), out = timeline_axis_x(axis, under->out_ns);
        if (is_near(x, in, GRAB) && (out - in > 2.0f * GRAB || x < in + 0.5f * (out - in)))
            return hit_of(TIMELINE_RANGE_IN);
        if (is_near(x, out, GRAB))
            return hit_of(TIMELINE_RANGE_OUT);
    }
    timeline_hit hit = hit_of(TIMELINE_RANGE);
    hit.marker = marker_at(under, x);
    if (hit.marker >= 0)
        hit.part = TIMELINE_MARKER;
    return hit;
}

static timeline_part part_of_clip(const timeline_axis *axis, const take_clip *clip,
                                  ui_rectangle box, float x, float y)
{
    float from = x - box.x, until = box.x + box.width - x;
    float edge = box.width < 4.0f * EDGE ? box.width / 4.0f : EDGE;
    float in = timeline_axis_points(axis, clip->fade_in_ns);
    float out = timeline_axis_points(axis, clip->fade_out_ns);
    bool is_top = y < box.y + CORNER && box.width >= 4.0f * CORNER;
    if (is_top && is_near(from, in, CORNER) && (in > 0.0f || from < CORNER))
        return TIMELINE_FADE_IN;
    if (is_top && is_near(until, out, CORNER) && (out > 0.0f || until < CORNER))
        return TIMELINE_FADE_OUT;
    if (from < edge)
        return TIMELINE_CLIP_START;
    if (until <= edge)
        return TIMELINE_CLIP_END;
    return TIMELINE_CLIP;
}

/* Finds the clip under the pointer. In a crossfade, the nearer end wins. */
static timeline_hit hit_clips(const timeline_under *under, timeline_hit hit, float x, float y)
{
    const timeline_row *row = &under->rows->row[hit.row];
    const take_layer *layer = &under->take->layer[row->index];
    hit.part = TIMELINE_LANE;
    hit.layer = layer->id;
    int64_t at_ns = timeline_axis_ns(under->axis, x);
    for (uint32_t i = timeline_first_clip(layer, at_ns - 1); i < layer->clip_count; ++i) {
        const take_clip *clip = &layer->clip[i];
        ui_rectangle box = timeline_clip_box(row, under->axis, layer, clip);
        if (box.x > x)
            break;
        if (!ui_rectangle_has(box, x, y))
            continue;
        timeline_part part = part_of_clip(under->axis, clip, box, x, y);
        if (hit.clip && part == TIMELINE_CLIP && hit.part != TIMELINE_CLIP)
            continue;
        hit.part = part;
        hit.clip = clip->id;
    }
    return hit;
}

static timeline_hit hit_head(const timeline_under *under, timeline_hit hit, float x, float y)
{
    static const timeline_part part[TIMELINE_SWITCHES] = {TIMELINE_MUTE, TIMELINE_SOLO,
                                                          TIMELINE_ADDITIVE, TIMELINE_ARM};
    const timeline_row *row = &under->rows->row[hit.row];
    hit.part = TIMELINE_NAME;
    if (row->kind == TIMELINE_COMP)
        return hit;
    if (row->kind == TIMELINE_LAYER)
        hit.layer = under->take->layer[row->index].id;
    if (ui_rectangle_has(timeline_gain_box(under->rows, row), x, y))
        hit.part = TIMELINE_GAIN;
    for (uint32_t i = 0; row->kind == TIMELINE_LAYER && i < TIMELINE_SWITCHES; ++i)
        if (ui_rectangle_has(timeline_switch_box(under->rows, row, i), x, y))
            hit.part = part[i];
    return hit;
}

int64_t timeline_sound_start_ns(const take_audio *audio)
{
    return audio->offset_ns + audio->in_ns;
}

int64_t timeline_sound_end_ns(const take_audio *audio, int64_t sound_ns)
{
    const bool is_trimmed = audio->out_ns > 0 && audio->out_ns < sound_ns;
    return audio->offset_ns + (is_trimmed ? audio->out_ns : sound_ns);
}

static timeline_part part_of_sound(const timeline_under *under, float x)
{
    const take_audio *audio = &under->take->audio;
    const float in = timeline_axis_x(under->axis, timeline_sound_start_ns(audio));
    const float out = timeline_axis_x(under->axis, timeline_sound_end_ns(audio, under->sound_ns));
    const float edge = out - in < 4.0f * EDGE ? 0.25f * (out - in) : EDGE;
    if (under->sound_ns > 0 && is_near(x, in, edge))
        return TIMELINE_SOUND_START;
    if (under->sound_ns > 0 && is_near(x, out, edge))
        return TIMELINE_SOUND_END;
    return TIMELINE_SOUND_BODY;
}

timeline_hit timeline_hit_at(const timeline_under *under, float x, float y)
{
    const timeline_rows *rows = under->rows;
    timeline_hit hit = hit_of(TIMELINE_NOWHERE);
    if (x < rows->x || x >= rows->x + rows->width || y < rows->y || y >= rows->y + rows->height)
        return hit;
    if (y < rows->lanes_y)
        return hit_ruler(under, x, y);
    for (uint32_t i = 0; i < rows->count && under->take; ++i) {
        const timeline_row *row = &rows->row[i];
        if (y < row->y || y >= row->y + row->height)
            continue;
        hit.row = (int32_t)i;
        if (x < under->axis->x)
            return hit_head(under, hit, x, y);
        if (row->kind == TIMELINE_LAYER)
            return hit_clips(under, hit, x, y);
        hit.part = row->kind == TIMELINE_SOUND ? part_of_sound(under, x) : TIMELINE_COMP_BODY;
        return hit;
    }
    hit.part = x >= under->axis->x ? TIMELINE_LANE : TIMELINE_NOWHERE;
    return hit;
}
