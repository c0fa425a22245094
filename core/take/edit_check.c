#include "take/edit.h"

#include "take/edit_parts.h"
#include "take/timecode.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SPEED_MAX = 1000 }; /* and 1 / SPEED_MAX */

bool edit_is_warp(const take_warp_point *warp, uint32_t count, int64_t limit_ns)
{
    for (uint32_t i = 0; i < count; ++i) {
        const take_warp_point *p = &warp[i];
        if (p->at_ns < -limit_ns || p->at_ns > limit_ns || p->source_ns < -limit_ns ||
            p->source_ns > limit_ns)
            return false;
        if (i == 0)
            continue;
        int64_t at_ns = p->at_ns - p[-1].at_ns, source_ns = p->source_ns - p[-1].source_ns;
        if (at_ns <= 0 || source_ns <= 0 || source_ns > at_ns * SPEED_MAX ||
            at_ns > source_ns * SPEED_MAX)
            return false;
    }
    return count >= 1 && count <= EDIT_WARP_MAX;
}

static bool is_within(double value, double low, double high)
{
    return value >= low && value <= high; /* false for NaN */
}

/* ---- one clip ---- */

static mrt_result bad_clip(const take_layer *layer, const take_clip *clip, const char *why,
                           error *err)
{
    return error_set(err, MRT_ERR_ARGUMENT, "%s: %s", edit_clip_words(layer, clip).text, why);
}

static mrt_result check_clip(const take_layer *layer, const take_clip *clip, error *err)
{
    if (clip->start_ns < -EDIT_CLIP_MAX_NS || clip->end_ns > EDIT_CLIP_MAX_NS ||
        clip->start_ns > EDIT_CLIP_MAX_NS || clip->end_ns < -EDIT_CLIP_MAX_NS)
        return error_set(err, MRT_ERR_ARGUMENT, "clip %u: it is days away from the take; move it",
                         clip->id);
    if (clip->end_ns <= clip->start_ns)
        return bad_clip(layer, clip, "expected an end after its start", err);
    if (clip->from_ns < 0 || clip->to_ns <= clip->from_ns ||
        clip->to_ns - clip->from_ns > EDIT_TIME_MAX_NS || clip->performance < 1)
        return bad_clip(layer, clip, "expected a performance and a span of its recording", err);
    if (!clip->warp || !edit_is_warp(clip->warp, clip->warp_count, EDIT_CLIP_MAX_NS))
        return bad_clip(layer, clip,
                        "expected a curve that ascends, from 1/1000 to 1000 times as fast", err);
    if (take_warp_to_source(clip, clip->start_ns) < 0 ||
        take_warp_to_source(clip, clip->end_ns) > clip->to_ns - clip->from_ns)
        return bad_clip(layer, clip, "it shows more than was recorded; trim it", err);
    if (clip->fade_in_ns < 0 || clip->fade_out_ns < 0 ||
        clip->fade_in_ns > clip->end_ns - clip->start_ns ||
        clip->fade_out_ns > clip->end_ns - clip->start_ns - clip->fade_in_ns)
        return bad_clip(layer, clip, "its fades are longer than it is; shorten them", err);
    if (!is_within(clip->gain, 0.0, 10.0) || !is_within(clip->smooth_s, 0.0, 10.0))
        return bad_clip(layer, clip, "expected a gain of 0 to 10 and 0 to 10 s of smoothing", err);
    return MRT_OK;
}

/* ---- the clips of a layer ---- */

static mrt_result check_order(const take_layer *layer, uint32_t i, error *err)
{
    const take_clip *clip = &layer->clip[i];
    if (i >= 1 && (clip->start_ns < clip[-1].start_ns || clip->end_ns < clip[-1].end_ns))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s would lie within clip %u (%s); trim one of them, or punch it in",
                         edit_clip_words(layer, clip).text, clip[-1].id,
                         edit_span_words(clip[-1].start_ns + layer->offset_ns,
                                         clip[-1].end_ns + layer->offset_ns)
                             .text);
    if (i >= 2 && clip->start_ns < clip[-2].end_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s would overlap clips %u and %u at once, at %s s; two may overlap: trim "
                         "or move one",
                         edit_clip_words(layer, clip).text, clip[-2].id, clip[-1].id,
                         edit_seconds(clip->start_ns + layer->offset_ns).text);
    return MRT_OK;
}

static mrt_result check_layer(const take_layer *layer, error *err)
{
    if (layer->clip_count > EDIT_CLIPS_MAX || layer->own_count > EDIT_OWN_MAX)
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "layer %u: it has %u clips and %u patterns; at most %d and %d are possible", layer->id,
            layer->clip_count, layer->own_count, EDIT_CLIPS_MAX, EDIT_OWN_MAX);
    if (!memchr(layer->name, '\0', sizeof layer->name) || !is_within(layer->gain, 0.0, 10.0) ||
        layer->offset_ns < -EDIT_TIME_MAX_NS || layer->offset_ns > EDIT_TIME_MAX_NS)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "layer %u: expected a name, a gain of 0 to 10 and an offset of days at "
                         "most",
                         layer->id);
    for (uint32_t i = 0; i < layer->own_count; ++i)
        if (!memchr(layer->own[i], '\0', TAKE_NAME) || !own_is_pattern(layer->own[i]))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s: pattern %u is none; expected one such as \"mouth.*\"",
                             edit_layer_words(layer).text, i);
    mrt_result result = MRT_OK;
    for (uint32_t i = 0; result >= 0 && i < layer->clip_count; ++i) {
        result = check_clip(layer, &layer->clip[i], err);
        if (result >= 0)
            result = check_order(layer, i, err);
    }
    return result;
}

/* ---- the take ---- */

static int compare_ids(const void *a, const void *b)
{
    uint32_t first = *(const uint32_t *)a, second = *(const uint32_t *)b;
    return (first > second) - (first < second);
}

static mrt_result check_sorted_ids(const uint32_t *id, size_t count, error *err)
{
    for (size_t i = 0; i < count; ++i)
        if (id[i] == 0 || id[i] == UINT32_MAX || (i > 0 && id[i] == id[i - 1]))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "id %u: two layers or clips have it, or it is no id", id[i]);
    return MRT_OK;
}

static mrt_result check_ids(const take *t, error *err)
{
    size_t count = 0, room = t->layer_count;
    for (uint32_t i = 0; i < t->layer_count; ++i)
        room += t->layer[i].clip_count;
    uint32_t *id = calloc(room + 1, sizeof *id);
    if (!id)
        return error_set(err, MRT_ERR_MEMORY, "take %lld: no memory to check it", (long long)t->id);
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        id[count++] = t->layer[i].id;
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            id[count++] = t->layer[i].clip[k].id;
    }
    qsort(id, count, sizeof *id, compare_ids);
    mrt_result result = check_sorted_ids(id, count, err);
    free(id);
    return result;
}

static mrt_result check_markers(const take *t, error *err)
{
    for (uint32_t i = 0; i < t->marker_count; ++i) {
        const take_marker *marker = &t->marker[i];
        if (marker->at_ns < -EDIT_CLIP_MAX_NS || marker->at_ns > EDIT_CLIP_MAX_NS ||
            (i > 0 && marker->at_ns < marker[-1].at_ns) ||
            !memchr(marker->text, '\0', sizeof marker->text))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "marker %u: expected a text, in order of time, days away at most", i);
    }
    return MRT_OK;
}

static bool ends(const char *text, size_t size)
{
    return memchr(text, '\0', size) != NULL;
}

static mrt_result check_numbers(const take *t, error *err)
{
    if (t->duration_ns < 0 || t->duration_ns > EDIT_CLIP_MAX_NS)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld: it would last %s s; expected 0 to %s s",
                         (long long)t->id, edit_seconds(t->duration_ns).text,
                         edit_seconds(EDIT_CLIP_MAX_NS).text);
    bool has_rate = t->fps == 0.0 || is_within(t->fps, TIMECODE_FPS_MIN, TIMECODE_FPS_MAX);
    bool has_texts = ends(t->name, sizeof t->name) && ends(t->scene, sizeof t->scene) &&
                     ends(t->shot, sizeof t->shot) && ends(t->note, sizeof t->note);
    if (t->rating > 5 || !has_rate || !has_texts || t->timecode_frame < -INT64_C(1000000000000) ||
        t->timecode_frame > INT64_C(1000000000000))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld: expected texts, 0 to 5 stars, %g to %g frames a second and a "
                         "time code of days at most",
                         (long long)t->id, TIMECODE_FPS_MIN, TIMECODE_FPS_MAX);
    if (t->audio.audio &&
        (!is_within(t->audio.gain, 0.0, 10.0) || t->audio.offset_ns < -EDIT_CLIP_MAX_NS ||
         t->audio.offset_ns > EDIT_CLIP_MAX_NS))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "audio %lld: expected a gain of 0 to 10 and an offset of days at most",
                         (long long)t->audio.audio);
    if (t->layer_count > EDIT_LAYERS_MAX || t->marker_count > EDIT_MARKERS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld: it has %u layers and %u markers; at most %d and %d are "
                         "possible",
                         (long long)t->id, t->layer_count, t->marker_count, EDIT_LAYERS_MAX,
                         EDIT_MARKERS_MAX);
    return MRT_OK;
}

mrt_result edit_check(const take *t, error *err)
{
    mrt_result result = check_numbers(t, err);
    if (result >= 0)
        result = check_markers(t, err);
    for (uint32_t i = 0; result >= 0 && i < t->layer_count; ++i)
        result = check_layer(&t->layer[i], err);
    return result < 0 ? result : check_ids(t, err);
}
