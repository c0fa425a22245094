#include "take/edit_parts.h"
#include "take/timecode.h"

#include <stdio.h>
#include <string.h>

/* ---- which range, which layers ---- */

static mrt_result check_range(const take *t, const edit *e, error *err)
{
    if (e->in_ns >= 0 && e->in_ns < e->out_ns && e->out_ns <= t->duration_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%s %s: expected a range within the take's 0 .. %s s",
                     edit_name(e->kind), edit_span_words(e->in_ns, e->out_ns).text,
                     edit_seconds(t->duration_ns).text);
}

static mrt_result check_layers(take *t, const edit *e, error *err)
{
    take_layer *layer;
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < e->layer_count; ++i)
        result = edit_find_layer(&layer, t, e->layers[i], err);
    return result;
}

static bool concerns(const edit *e, const take_layer *layer)
{
    for (uint32_t i = 0; i < e->layer_count; ++i)
        if (e->layers[i] == layer->id)
            return true;
    return e->layer_count == 0;
}

/* A sound that plays on cannot be cut; what comes later than the cut can move with the rest. */
static mrt_result check_audio(const take *t, const edit *e, int64_t out_ns, error *err)
{
    if (e->layer_count > 0 || t->audio.audio == 0 || t->audio.offset_ns >= out_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: the take's audio begins before %s s and would run out of step; name the "
                     "layers to leave it as it is, or detach it, or leave a gap",
                     edit_name(e->kind), edit_seconds(out_ns).text);
}

/* ---- keep ---- */

/* A clip whose neighbour is gone does not fade where it cross-faded. */
static void remove_outside(take_layer *layer, int64_t in_ns, int64_t out_ns)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < layer->clip_count; ++i) {
        take_clip *clip = &layer->clip[i];
        if (clip->end_ns > in_ns && clip->start_ns < out_ns) {
            layer->clip[kept++] = *clip;
            continue;
        }
        if (clip->end_ns <= in_ns && i + 1 < layer->clip_count && clip[1].start_ns < clip->end_ns)
            clip[1].fade_in_ns = 0;
        if (clip->start_ns >= out_ns && kept > 0 && layer->clip[kept - 1].end_ns > clip->start_ns)
            layer->clip[kept - 1].fade_out_ns = 0;
        edit_clip_finish(clip);
    }
    layer->clip_count = kept;
}

static void keep_markers(take *t, int64_t in_ns, int64_t out_ns)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < t->marker_count; ++i) {
        if (t->marker[i].at_ns < in_ns || t->marker[i].at_ns > out_ns)
            continue;
        take_marker marker = t->marker[i];
        marker.at_ns -= in_ns;
        t->marker[kept++] = marker;
    }
    t->marker_count = kept;
}

/* Clips that reach over the ends stay whole: within the range nothing changes, not even weights. */
static mrt_result keep(take *t, const edit *e, error *err)
{
    mrt_result result = check_range(t, e, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        take_layer *layer = &t->layer[i];
        remove_outside(layer, e->in_ns - layer->offset_ns, e->out_ns - layer->offset_ns);
        for (uint32_t k = 0; k < layer->clip_count; ++k)
            edit_shift(&layer->clip[k], -e->in_ns);
    }
    keep_markers(t, e->in_ns, e->out_ns);
    timecode_rate rate;
    if (t->fps > 0.0 && timecode_rate_of(&rate, t->fps, NULL) >= 0)
        t->timecode_frame += timecode_nearest_frame(rate, e->in_ns);
    if (t->audio.audio)
        t->audio.offset_ns -= e->in_ns;
    t->start_ns += e->in_ns;
    t->duration_ns = e->out_ns - e->in_ns;
    return MRT_OK;
}

/* ---- cut, insert ---- */

/* All that is not in layers, from out_ns on. */
static void move_rest(take *t, int64_t in_ns, int64_t out_ns, int64_t later_ns)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < t->marker_count; ++i) {
        if (t->marker[i].at_ns >= in_ns && t->marker[i].at_ns < out_ns)
            continue;
        take_marker marker = t->marker[i];
        marker.at_ns += marker.at_ns >= out_ns ? later_ns : 0;
        t->marker[kept++] = marker;
    }
    t->marker_count = kept;
    if (t->audio.audio && t->audio.offset_ns >= out_ns)
        t->audio.offset_ns += later_ns;
    t->duration_ns += later_ns;
}

static mrt_result cut_layers(take *t, const edit *e, int64_t in_ns, int64_t out_ns,
                             int64_t later_ns, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < t->layer_count; ++i) {
        take_layer *layer = &t->layer[i];
        if (concerns(e, layer))
            result = edit_cut(t, layer, in_ns - layer->offset_ns, out_ns - layer->offset_ns,
                              later_ns, err);
    }
    return result;
}

static mrt_result cut(take *t, const edit *e, error *err)
{
    int64_t later_ns = e->is_ripple ? e->in_ns - e->out_ns : 0;
    mrt_result result = check_range(t, e, err);
    if (result >= 0)
        result = check_layers(t, e, err);
    if (result >= 0 && e->is_ripple)
        result = check_audio(t, e, e->out_ns, err);
    if (result >= 0)
        result = cut_layers(t, e, e->in_ns, e->out_ns, later_ns, err);
    if (result >= 0 && e->is_ripple && e->layer_count == 0)
        move_rest(t, e->in_ns, e->out_ns, later_ns);
    return result;
}

static void grow_over_layers(take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].clip_count)
            edit_grow(t, &t->layer[i], &t->layer[i].clip[t->layer[i].clip_count - 1]);
}

static mrt_result insert(take *t, const edit *e, error *err)
{
    if (e->at_ns < 0 || e->at_ns > t->duration_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "range.insert at %s s: expected a time within the take's 0 .. %s s",
                         edit_seconds(e->at_ns).text, edit_seconds(t->duration_ns).text);
    mrt_result result = check_layers(t, e, err);
    if (result >= 0)
        result = check_audio(t, e, e->at_ns, err);
    if (result >= 0)
        result = cut_layers(t, e, e->at_ns, e->at_ns, e->length_ns, err);
    if (result < 0)
        return result;
    if (e->layer_count == 0)
        move_rest(t, e->at_ns, e->at_ns, e->length_ns);
    else
        grow_over_layers(t);
    return MRT_OK;
}

mrt_result edit_apply_range(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_RANGE_KEEP)
        return keep(t, e, err);
    return e->kind == EDIT_RANGE_CUT ? cut(t, e, err) : insert(t, e, err);
}
