#include "window/timeline/drag.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SHORTEST_NS 1000000LL /* shortest clip that a drag can make */
#define GAIN_POINTS 120.0     /* for a change of the gain from 0 to 1 */
#define GAIN_MOST   4.0

/* ---- dragged items ---- */

const take_layer *timeline_layer(const take *t, uint32_t id)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].id == id)
            return &t->layer[i];
    return NULL;
}

const take_clip *timeline_clip(const take *t, uint32_t id, const take_layer **out_layer)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id == id) {
                *out_layer = &t->layer[i];
                return &t->layer[i].clip[k];
            }
    *out_layer = NULL;
    return NULL;
}

static int64_t within(int64_t value, int64_t low, int64_t high)
{
    return value < low ? low : value > high ? high : value;
}

timeline_drag_kind timeline_drag_kind_of(timeline_part part, bool is_retiming)
{
    static const timeline_drag_kind kinds[TIMELINE_PARTS] = {
        [TIMELINE_CLIP] = TIMELINE_DRAG_MOVE,
        [TIMELINE_CLIP_START] = TIMELINE_DRAG_START,
        [TIMELINE_CLIP_END] = TIMELINE_DRAG_END,
        [TIMELINE_FADE_IN] = TIMELINE_DRAG_FADE_IN,
        [TIMELINE_FADE_OUT] = TIMELINE_DRAG_FADE_OUT,
        [TIMELINE_MARKER] = TIMELINE_DRAG_MARKER,
        [TIMELINE_SOUND_BODY] = TIMELINE_DRAG_SOUND,
        [TIMELINE_SOUND_START] = TIMELINE_DRAG_SOUND_START,
        [TIMELINE_SOUND_END] = TIMELINE_DRAG_SOUND_END,
        [TIMELINE_GAIN] = TIMELINE_DRAG_GAIN,
        [TIMELINE_NAME] = TIMELINE_DRAG_ORDER,
    };
    if (is_retiming && part == TIMELINE_CLIP_START)
        return TIMELINE_DRAG_SPEED_START;
    if (is_retiming && part == TIMELINE_CLIP_END)
        return TIMELINE_DRAG_SPEED_END;
    return kinds[part];
}

void timeline_drag_begin(timeline_drag *out, timeline_drag_kind kind, const take *t,
                         timeline_hit hit, int64_t at_ns, int64_t sound_ns)
{
    *out = (timeline_drag){.kind = kind,
                           .layer = hit.layer,
                           .clip = hit.clip,
                           .marker = hit.marker < 0 ? 0 : (uint32_t)hit.marker,
                           .grabbed_ns = at_ns,
                           .sound_ns = sound_ns};
    const take_layer *layer = timeline_layer(t, hit.layer);
    out->initial = layer ? layer->gain : t->audio.gain;
}

/* ---- edits: each function fills an edit; EDIT_NONE: no change ---- */

static void move(edit *out, timeline_drag *self, const take *t, const timeline_snap *snap,
                 int64_t at_ns, uint32_t onto_layer)
{
    const take_layer *layer;
    const take_clip *clip = timeline_clip(t, self->clip, &layer);
    if (!clip)
        return;
    int64_t start_ns = clip->start_ns + layer->offset_ns;
    int64_t wanted_ns = timeline_snap_span(snap, start_ns + at_ns - self->grabbed_ns,
                                           clip->end_ns - clip->start_ns, &self->snapped);
    bool is_other = onto_layer && onto_layer != layer->id;
    if (wanted_ns == start_ns && !is_other)
        return;
    edit_init(out, EDIT_CLIP_MOVE);
    out->clip = self->clip;
    out->start_ns = wanted_ns;
    out->layer = is_other ? onto_layer : 0;
}

static int64_t earliest_ns(const take_clip *clip)
{
    return take_warp_to_timeline(clip, 0);
}

static int64_t latest_ns(const take_clip *clip)
{
    int64_t length_ns = clip->to_ns - clip->from_ns;
    int64_t at_ns = take_warp_to_timeline(clip, length_ns);
    return take_warp_to_source(clip, at_ns) > length_ns ? at_ns - 1 : at_ns;
}

static int64_t dragged_edge(timeline_drag *self, const timeline_snap *snap, int64_t edge_ns,
                            int64_t at_ns)
{
    return timeline_snap_to(snap, edge_ns + at_ns - self->grabbed_ns, &self->snapped);
}

/* A limit of the clip has moved the edge away from the target. */
static void unsnap(timeline_drag *self, int64_t at_ns)
{
    if (self->snapped.at_ns != at_ns)
        self->snapped = (timeline_target){.kind = TIMELINE_TARGET_NONE};
}

static void trim(edit *out, timeline_drag *self, const take *t, const timeline_snap *snap,
                 int64_t at_ns)
{
    const take_layer *layer;
    const take_clip *clip = timeline_clip(t, self->clip, &layer);
    if (!clip)
        return;
    bool is_start = self->kind == TIMELINE_DRAG_START;
    int64_t offset_ns = layer->offset_ns;
    int64_t edge_ns = (is_start ? clip->start_ns : clip->end_ns) + offset_ns;
    int64_t low_ns = is_start ? earliest_ns(clip) : clip->start_ns + SHORTEST_NS;
    int64_t high_ns = is_start ? clip->end_ns - SHORTEST_NS : latest_ns(clip);
    if (low_ns > high_ns)
        return;
    int64_t wanted_ns =
        within(dragged_edge(self, snap, edge_ns, at_ns), low_ns + offset_ns, high_ns + offset_ns);
    unsnap(self, wanted_ns);
    if (wanted_ns == edge_ns)
        return;
    edit_init(out, EDIT_CLIP_TRIM);
    out->clip = self->clip;
    if (is_start)
        out->start_ns = wanted_ns;
    else
        out->end_ns = wanted_ns;
}

static void retime(edit *out, timeline_drag *self, const take *t, const timeline_snap *snap,
                   int64_t at_ns)
{
    const take_layer *layer;
    const take_clip *clip = timeline_clip(t, self->clip, &layer);
    if (!clip)
        return;
    bool is_start = self->kind == TIMELINE_DRAG_SPEED_START;
    int64_t offset_ns = layer->offset_ns, length_ns = clip->end_ns - clip->start_ns;
    int64_t edge_ns = (is_start ? clip->start_ns : clip->end_ns) + offset_ns;
    int64_t stays_ns = (is_start ? clip->end_ns : clip->start_ns) + offset_ns;
    int64_t wanted_ns = dragged_edge(self, snap, edge_ns, at_ns);
    int64_t wanted_length_ns = is_start ? stays_ns - wanted_ns : wanted_ns - stays_ns;
    wanted_length_ns = within(wanted_length_ns, length_ns / 100 + SHORTEST_NS, length_ns * 100);
    unsnap(self, is_start ? stays_ns - wanted_length_ns : stays_ns + wanted_length_ns);
    if (wanted_length_ns == length_ns)
        return;
    edit_init(out, EDIT_CLIP_SPEED);
    out->clip = self->clip;
    out->speed = (double)length_ns / (double)wanted_length_ns;
    out->at_ns = stays_ns;
}

static void fade(edit *out, timeline_drag *self, const take *t, const timeline_snap *snap,
                 int64_t at_ns)
{
    const take_layer *layer;
    const take_clip *clip = timeline_clip(t, self->clip, &layer);
    if (!clip)
        return;
    bool is_in = self->kind == TIMELINE_DRAG_FADE_IN;
    int64_t offset_ns = layer->offset_ns, length_ns = clip->end_ns - clip->start_ns;
    int64_t fade_ns = is_in ? clip->fade_in_ns : clip->fade_out_ns;
    int64_t other_ns = is_in ? clip->fade_out_ns : clip->fade_in_ns;
    int64_t foot_ns = (is_in ? clip->start_ns : clip->end_ns) + offset_ns;
    int64_t top_ns = dragged_edge(self, snap, is_in ? foot_ns + fade_ns : foot_ns - fade_ns, at_ns);
    int64_t wanted_ns =
        within(is_in ? top_ns - foot_ns : foot_ns - top_ns, 0, length_ns - other_ns);
    unsnap(self, is_in ? foot_ns + wanted_ns : foot_ns - wanted_ns);
    if (wanted_ns == fade_ns)
        return;
    edit_init(out, EDIT_CLIP_FADE);
    out->clip = self->clip;
    if (is_in)
        out->fade_in_ns = wanted_ns;
    else
        out->fade_out_ns = wanted_ns;
}

static void move_marker(edit *out, timeline_drag *self, const take *t, const timeline_snap *snap,
                        int64_t at_ns)
{
    if (self->marker >= t->marker_count)
        return;
    int64_t marked_ns = t->marker[self->marker].at_ns;
    int64_t wanted_ns = within(dragged_edge(self, snap, marked_ns, at_ns), 0, t->duration_ns);
    unsnap(self, wanted_ns);
    if (wanted_ns == marked_ns)
        return;
    edit_init(out, EDIT_MARKER_MOVE);
    out->marker = self->marker;
    out->at_ns = wanted_ns;
}

/* Moves the sound without snapping to frames, because it is aligned by ear and waveform. */
static void move_sound(edit *out, const timeline_drag *self, const take *t, int64_t at_ns)
{
    if (!t->audio.audio || at_ns == self->grabbed_ns)
        return;
    edit_init(out, EDIT_AUDIO_OFFSET);
    out->offset_ns =
        within(t->audio.offset_ns + at_ns - self->grabbed_ns, -EDIT_TIME_MAX_NS, EDIT_TIME_MAX_NS);
}

static void trim_sound(edit *out, const timeline_drag *self, const take *t, int64_t at_ns)
{
    const take_audio *audio = &t->audio;
    const bool is_start = self->kind == TIMELINE_DRAG_SOUND_START;
    const int64_t start_ns = timeline_sound_start_ns(audio);
    const int64_t end_ns = timeline_sound_end_ns(audio, self->sound_ns);
    const int64_t edge_ns = is_start ? start_ns : end_ns;
    const int64_t low_ns = is_start ? audio->offset_ns : start_ns + SHORTEST_NS;
    const int64_t high_ns = is_start ? end_ns - SHORTEST_NS : audio->offset_ns + self->sound_ns;
    if (!audio->audio || self->sound_ns == 0 || low_ns > high_ns)
        return;
    const int64_t wanted_ns = within(edge_ns + at_ns - self->grabbed_ns, low_ns, high_ns);
    if (wanted_ns == edge_ns)
        return;
    edit_init(out, EDIT_AUDIO_TRIM);
    if (is_start)
        out->start_ns = wanted_ns;
    else
        out->end_ns = wanted_ns;
}

static void set_gain(edit *out, const timeline_drag *self, float points)
{
    double gain = self->initial + (double)points / GAIN_POINTS;
    gain = gain < 0.0 ? 0.0 : gain > GAIN_MOST ? GAIN_MOST : gain;
    gain = floor(gain * 100.0 + 0.5) / 100.0;
    if (fabs(gain - 1.0) < 0.025)
        gain = 1.0;
    if (gain == self->initial)
        return;
    edit_init(out, self->layer ? EDIT_LAYER_GAIN : EDIT_AUDIO_GAIN);
    out->layer = self->layer;
    out->gain = gain;
}

static void order(edit *out, const timeline_drag *self, const take *t, uint32_t onto_layer)
{
    const take_layer *onto = timeline_layer(t, onto_layer);
    if (!onto || onto_layer == self->layer)
        return;
    edit_init(out, EDIT_LAYER_ORDER);
    out->layer = self->layer;
    out->place = (uint32_t)(onto - t->layer);
}

static void make(edit *out, timeline_drag *self, const take *t, const timeline_snap *snap,
                 int64_t at_ns, uint32_t onto_layer, float points)
{
    *out = (edit){0};
    self->snapped = (timeline_target){.kind = TIMELINE_TARGET_NONE};
    switch (self->kind) {
    case TIMELINE_DRAG_MOVE:
        move(out, self, t, snap, at_ns, onto_layer);
        break;
    case TIMELINE_DRAG_START:
    case TIMELINE_DRAG_END:
        trim(out, self, t, snap, at_ns);
        break;
    case TIMELINE_DRAG_SPEED_START:
    case TIMELINE_DRAG_SPEED_END:
        retime(out, self, t, snap, at_ns);
        break;
    case TIMELINE_DRAG_FADE_IN:
    case TIMELINE_DRAG_FADE_OUT:
        fade(out, self, t, snap, at_ns);
        break;
    case TIMELINE_DRAG_MARKER:
        move_marker(out, self, t, snap, at_ns);
        break;
    case TIMELINE_DRAG_SOUND:
        move_sound(out, self, t, at_ns);
        break;
    case TIMELINE_DRAG_SOUND_START:
    case TIMELINE_DRAG_SOUND_END:
        trim_sound(out, self, t, at_ns);
        break;
    case TIMELINE_DRAG_GAIN:
        set_gain(out, self, points);
        break;
    case TIMELINE_DRAG_ORDER:
        order(out, self, t, onto_layer);
        break;
    case TIMELINE_DRAG_NONE:
        break;
    }
}

/* ---- preview ---- */

/* Copies the take and applies the edit. Returns false if the edit is not possible. */
static bool try_edit(take *out, const take *t, const edit *e, error *err)
{
    if (take_copy(out, t, err) < 0)
        return false;
    if (edit_apply(out, e, err) >= 0)
        return true;
    take_finish(out);
    return false;
}

/* Compares the arguments that drags set. */
static bool is_same_edit(const edit *a, const edit *b)
{
    return a->kind == b->kind && a->clip == b->clip && a->layer == b->layer &&
           a->marker == b->marker && a->place == b->place && a->start_ns == b->start_ns &&
           a->end_ns == b->end_ns && a->at_ns == b->at_ns && a->offset_ns == b->offset_ns &&
           a->fade_in_ns == b->fade_in_ns && a->fade_out_ns == b->fade_out_ns &&
           !(a->gain < b->gain || a->gain > b->gain) &&
           !(a->speed < b->speed || a->speed > b->speed);
}

void timeline_drag_to(timeline_drag *self, const take *t, const timeline_snap *snap, int64_t at_ns,
                      uint32_t onto_layer, float points)
{
    edit wanted;
    take preview;
    make(&wanted, self, t, snap, at_ns, onto_layer, points);
    wanted.is_ripple = wanted.kind != EDIT_NONE && timeline_drag_ripples(self);
    self->why.text[0] = '\0';
    if (is_same_edit(&wanted, &self->made))
        return;
    if (wanted.kind == EDIT_NONE) {
        take_finish(&self->preview);
        self->made = wanted;
        self->edition += 1;
        return;
    }
    if (!try_edit(&preview, t, &wanted, &self->why)) {
        self->snapped = (timeline_target){.kind = TIMELINE_TARGET_NONE};
        return;
    }
    take_finish(&self->preview);
    self->preview = preview;
    self->made = wanted;
    self->edition += 1;
}

bool timeline_drag_ripples(const timeline_drag *self)
{
    return self->is_ripple &&
           (self->kind == TIMELINE_DRAG_MOVE || self->kind == TIMELINE_DRAG_START ||
            self->kind == TIMELINE_DRAG_END || self->kind == TIMELINE_DRAG_SPEED_START ||
            self->kind == TIMELINE_DRAG_SPEED_END);
}

bool timeline_drag_moves_face(const timeline_drag *self)
{
    switch (self->kind) {
    case TIMELINE_DRAG_NONE:
    case TIMELINE_DRAG_MARKER:
    case TIMELINE_DRAG_SOUND:
    case TIMELINE_DRAG_SOUND_START:
    case TIMELINE_DRAG_SOUND_END:
        return false;
    case TIMELINE_DRAG_GAIN:
        return self->layer != 0;
    default:
        return true;
    }
}

const take *timeline_drag_shown(const timeline_drag *self, const take *t)
{
    return self->made.kind == EDIT_NONE ? t : &self->preview;
}

void timeline_drag_finish(timeline_drag *self)
{
    take_finish(&self->preview);
    edit_finish(&self->made);
    *self = (timeline_drag){.kind = TIMELINE_DRAG_NONE};
}

/* ---- comping ---- */

#define FADE_NS          100000000LL /* fade of a punched-in span; shorter for a short span */
#define COMP_SHORTEST_NS 20000000LL  /* shortest span that can be swiped */

bool timeline_moves(const take_layer *layer, own_region region)
{
    const own_part *part = own_part_of(region);
    for (uint32_t i = 0; i < layer->own_count; ++i)
        for (uint32_t k = 0; k < part->pattern_count; ++k)
            if (own_patterns_overlap(layer->own[i], part->pattern[k]))
                return true;
    return layer->own_count == 0;
}

static const take_clip *clip_at(const take_layer *layer, int64_t at_ns)
{
    take_voice voice[2];
    uint32_t count = take_at(voice, layer, at_ns - layer->offset_ns);
    if (count == 0)
        return NULL;
    return count == 2 && voice[1].weight > voice[0].weight ? voice[1].clip : voice[0].clip;
}

typedef struct origin { /* source of a comped region */
    const take_layer *layer;
    const take_clip *clip;
} origin;

/* Returns the topmost audible layer that moves the region at this time. OWN_REGION_COUNT: the
 * lowest audible layer. */
static origin find_origin(const take *from, own_region region, int64_t at_ns)
{
    for (uint32_t n = 0; n < from->layer_count; ++n) {
        bool is_all = region == OWN_REGION_COUNT;
        uint32_t index = is_all ? n : from->layer_count - 1 - n;
        const take_layer *layer = &from->layer[index];
        const take_clip *clip = clip_at(layer, at_ns);
        if (clip && own_layer_is_active(from, index) && (is_all || timeline_moves(layer, region)))
            return (origin){layer, clip};
    }
    return (origin){NULL, NULL};
}

/* Copies the retiming curve of the origin to the timeline of the target take. */
static mrt_result give_warp(edit *e, origin of, int64_t later_ns, error *err)
{
    int64_t by_ns = of.layer->offset_ns + later_ns;
    if (of.clip->warp_count == 1) {
        e->source_ns = take_warp_to_source(of.clip, e->in_ns - by_ns);
        return MRT_OK;
    }
    e->warp = calloc(of.clip->warp_count, sizeof *e->warp);
    if (!e->warp)
        return error_set(err, MRT_ERR_MEMORY, "comp: no memory for a curve");
    e->warp_count = of.clip->warp_count;
    for (uint32_t i = 0; i < e->warp_count; ++i)
        e->warp[i] = (take_warp_point){of.clip->warp[i].at_ns + by_ns, of.clip->warp[i].source_ns};
    return MRT_OK;
}

static mrt_result fill(edit *e, origin of, int64_t later_ns, int64_t in_ns, int64_t out_ns,
                       error *err)
{
    e->performance = of.clip->performance;
    e->from_ns = of.clip->from_ns;
    e->to_ns = of.clip->to_ns;
    e->in_ns = in_ns;
    e->out_ns = out_ns;
    e->fade_ns = (out_ns - in_ns) / 4 < FADE_NS ? (out_ns - in_ns) / 4 : FADE_NS;
    return give_warp(e, of, later_ns, err);
}

/* Clamps in..out to the span that the origins of all regions cover. */
static bool clamp_span(const take *from, int64_t later_ns, uint32_t regions, int64_t *in_ns,
                       int64_t *out_ns)
{
    int64_t middle_ns = *in_ns + (*out_ns - *in_ns) / 2 - later_ns;
    bool has_some = false;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        own_region of = regions == TIMELINE_ALL_REGIONS ? OWN_REGION_COUNT : (own_region)region;
        origin o = find_origin(from, of, middle_ns);
        if (!(regions & 1u << region) || !o.clip)
            continue;
        has_some = true;
        int64_t by_ns = o.layer->offset_ns + later_ns;
        if (*in_ns < o.clip->start_ns + by_ns)
            *in_ns = o.clip->start_ns + by_ns;
        if (*out_ns > o.clip->end_ns + by_ns)
            *out_ns = o.clip->end_ns + by_ns;
    }
    return has_some;
}

static uint32_t give_up(edit *out, uint32_t count)
{
    for (uint32_t i = 0; i < count; ++i)
        edit_finish(&out[i]);
    return 0;
}

uint32_t timeline_comp_edits(edit out[TIMELINE_DRAG_EDITS], const take *t, const take *from,
                             int64_t later_ns, uint32_t regions, int64_t *in_ns, int64_t *out_ns,
                             error *err)
{
    bool is_all = regions == TIMELINE_ALL_REGIONS;
    if (!clamp_span(from, later_ns, regions, in_ns, out_ns) ||
        *out_ns - *in_ns < COMP_SHORTEST_NS) {
        (void)error_set(err, MRT_ERR_ARGUMENT,
                        "this take has no movement of these parts in the swiped span; swipe where "
                        "its lane shows a curve");
        return 0;
    }
    int64_t middle_ns = *in_ns + (*out_ns - *in_ns) / 2 - later_ns;
    uint32_t count = 0;
    for (uint32_t region = 0; region < OWN_REGION_COUNT; ++region) {
        if (!(regions & 1u << region) || (is_all && count))
            continue;
        origin o = find_origin(from, is_all ? OWN_REGION_COUNT : (own_region)region, middle_ns);
        if (!o.clip)
            continue;
        edit *e = &out[count++];
        edit_init(e, is_all ? EDIT_PUNCH : EDIT_COMP);
        e->layer = is_all && t->layer_count ? t->layer[0].id : 0;
        e->regions = is_all ? 0 : 1u << region;
        if (fill(e, o, later_ns, *in_ns, *out_ns, err) < 0)
            return give_up(out, count);
    }
    return count;
}
