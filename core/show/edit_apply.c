/* Applies edits to a take, and checks the invariants of takes. */
#include "show/edit_layers.h"
#include "show/own.h"
#include "base/timecode.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- invariants of every take ---- */

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
        return error_set(err, MRT_ERR_ARGUMENT,
                         "clip %u: it is days away from the take; move it closer", clip->id);
    if (clip->end_ns <= clip->start_ns)
        return bad_clip(layer, clip, "expected an end after its start", err);
    if (clip->from_ns < 0 || clip->to_ns <= clip->from_ns ||
        clip->to_ns - clip->from_ns > EDIT_TIME_MAX_NS || clip->performance < 1)
        return bad_clip(layer, clip, "expected a performance and a span of its recording", err);
    if (!clip->warp || !edit_is_warp(clip->warp, clip->warp_count, EDIT_CLIP_MAX_NS))
        return bad_clip(layer, clip,
                        "expected a curve that ascends, at 1/1000 to 1000 times the recorded speed",
                        err);
    if (take_warp_to_source(clip, clip->start_ns) < 0 ||
        take_warp_to_source(clip, clip->end_ns) > clip->to_ns - clip->from_ns)
        return bad_clip(layer, clip, "it shows more than was recorded; trim it", err);
    if (clip->fade_in_ns < 0 || clip->fade_out_ns < 0 ||
        clip->fade_in_ns > clip->end_ns - clip->start_ns ||
        clip->fade_out_ns > clip->end_ns - clip->start_ns - clip->fade_in_ns)
        return bad_clip(layer, clip, "its fades are longer than it is; shorten them", err);
    if (!is_within(clip->gain, 0.0, 10.0) || !is_within(clip->smooth_s, 0.0, 10.0))
        return bad_clip(layer, clip, "expected a gain of 0 to 10 and 0 to 10 s of smoothing", err);
    if (clip->colour >= TAKE_COLOURS)
        return bad_clip(layer, clip, "expected a known colour", err);
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
                         "%s would overlap clips %u and %u at %s s; only two clips may overlap: "
                         "trim or move one",
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
        layer->offset_ns < -EDIT_TIME_MAX_NS || layer->offset_ns > EDIT_TIME_MAX_NS ||
        layer->colour >= TAKE_COLOURS)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "layer %u: expected a name, a gain of 0 to 10, an offset of days at most "
                         "and a known colour",
                         layer->id);
    for (uint32_t i = 0; i < layer->own_count; ++i)
        if (!memchr(layer->own[i], '\0', TAKE_NAME) || !own_is_pattern(layer->own[i]))
            return error_set(err, MRT_ERR_ARGUMENT,
                             "%s: pattern %u is invalid; expected one such as \"mouth.*\"",
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
                             "id %u: two layers or clips use it, or it is invalid", id[i]);
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
                             "marker %u: expected a text, sorted by time, at most days away", i);
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
         t->audio.offset_ns > EDIT_CLIP_MAX_NS || t->audio.in_ns < 0 || t->audio.out_ns < 0))
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

/* ---- takes, markers, sound ---- */

/* ---- the take itself ---- */

static mrt_result set_fps(take *t, const edit *e, error *err)
{
    timecode_rate before, after;
    mrt_result result = timecode_rate_of(&after, e->fps, err);
    if (result < 0)
        return result;
    if (t->fps > 0.0 && timecode_rate_of(&before, t->fps, NULL) >= 0)
        t->timecode_frame =
            timecode_nearest_frame(after, timecode_time_ns(before, t->timecode_frame));
    t->fps = timecode_fps(after);
    t->is_drop_frame = t->is_drop_frame && timecode_can_drop(after);
    return MRT_OK;
}

static mrt_result set_timecode(take *t, const edit *e, error *err)
{
    timecode_rate rate;
    if (t->fps <= 0.0 || timecode_rate_of(&rate, t->fps, NULL) < 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "time code: the take has no frame rate; set it first");
    if (e->is_drop && !timecode_can_drop(rate))
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "$.drop: %.6g frames a second has no drop-frame time code; only 29.97 and 59.94 do",
            t->fps);
    t->timecode_frame = e->frame;
    t->is_drop_frame = e->is_drop;
    return MRT_OK;
}

static mrt_result apply_take(take *t, const edit *e, error *err)
{
    switch (e->kind) {
    case EDIT_TAKE_SLATE:
        memcpy(t->scene, e->scene, sizeof t->scene);
        memcpy(t->shot, e->shot, sizeof t->shot);
        t->number = e->number;
        return MRT_OK;
    case EDIT_TAKE_RENAME:
        memcpy(t->name, e->name, sizeof t->name);
        return MRT_OK;
    case EDIT_TAKE_NOTE:
        memcpy(t->note, e->note, sizeof t->note);
        return MRT_OK;
    case EDIT_TAKE_RATE:
        t->rating = e->rating;
        return MRT_OK;
    case EDIT_TAKE_FPS:
        return set_fps(t, e, err);
    case EDIT_TAKE_TIMECODE:
        return set_timecode(t, e, err);
    default: /* delete, restore */
        t->is_deleted = e->kind == EDIT_TAKE_DELETE;
        return MRT_OK;
    }
}

/* ---- markers, sorted by time; an added or moved marker follows others of the same instant ---- */

static void lay_marker(take *t, take_marker marker)
{
    uint32_t index = t->marker_count++;
    for (; index > 0 && t->marker[index - 1].at_ns > marker.at_ns; --index)
        t->marker[index] = t->marker[index - 1];
    t->marker[index] = marker;
}

static take_marker lift_marker(take *t, uint32_t index)
{
    take_marker marker = t->marker[index];
    uint32_t after = --t->marker_count - index;
    memmove(&t->marker[index], &t->marker[index + 1], after * sizeof marker);
    return marker;
}

static mrt_result add_marker(take *t, const edit *e, error *err)
{
    take_marker marker = {.at_ns = e->at_ns};
    memcpy(marker.text, e->text, sizeof marker.text);
    mrt_result result = edit_reserve((void **)&t->marker, sizeof *t->marker, t->marker_count,
                                     EDIT_MARKERS_MAX, "markers", err);
    if (result >= 0)
        lay_marker(t, marker);
    return result;
}

static mrt_result apply_marker(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_MARKER_ADD)
        return add_marker(t, e, err);
    if (e->marker >= t->marker_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "marker %u: the take has %u markers, counted from 0 by time", e->marker,
                         t->marker_count);
    if (e->kind == EDIT_MARKER_RENAME) {
        memcpy(t->marker[e->marker].text, e->text, sizeof t->marker->text);
        return MRT_OK;
    }
    take_marker marker = lift_marker(t, e->marker);
    if (e->kind == EDIT_MARKER_MOVE) {
        marker.at_ns = e->at_ns;
        lay_marker(t, marker);
    }
    return MRT_OK;
}

/* ---- audio ---- */

/* Trims the audio; the remaining part keeps its position. */
static mrt_result trim_audio(take_audio *audio, const edit *e, error *err)
{
    int64_t in_ns = audio->in_ns, out_ns = audio->out_ns;
    if (e->start_ns != EDIT_UNSAID)
        in_ns = e->start_ns > audio->offset_ns ? e->start_ns - audio->offset_ns : 0;
    if (e->end_ns != EDIT_UNSAID)
        out_ns = e->end_ns - audio->offset_ns;
    if (in_ns >= out_ns && (out_ns != 0 || e->end_ns != EDIT_UNSAID))
        return error_set(err, MRT_ERR_ARGUMENT, "audio: the edit would remove all of it");
    audio->in_ns = in_ns;
    audio->out_ns = out_ns;
    return MRT_OK;
}

static mrt_result apply_audio(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_AUDIO_ATTACH) {
        t->audio = (take_audio){.audio = e->audio,
                                .offset_ns = e->offset_ns == EDIT_UNSAID ? 0 : e->offset_ns,
                                .gain = e->gain};
        return MRT_OK;
    }
    if (t->audio.audio == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "audio: the take has none; attach one first");
    if (e->kind == EDIT_AUDIO_OFFSET)
        t->audio.offset_ns = e->offset_ns;
    else if (e->kind == EDIT_AUDIO_TRIM)
        return trim_audio(&t->audio, e, err);
    else if (e->kind == EDIT_AUDIO_GAIN)
        t->audio.gain = e->gain;
    else
        t->audio = (take_audio){0};
    return MRT_OK;
}

/* ---- layers ---- */

static mrt_result check_name(const edit *e, error *err)
{
    if (e->name[0] != '\0')
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "$.name: a layer needs a name, such as \"mouth\"");
}

static mrt_result set_own(take_layer *layer, const edit *e, error *err)
{
    char(*own)[TAKE_NAME] = e->own_count ? calloc(e->own_count, sizeof *own) : NULL;
    if (e->own_count && !own)
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory", edit_layer_words(layer).text);
    for (uint32_t i = 0; i < e->own_count; ++i)
        memcpy(own[i], e->own[i], sizeof own[i]);
    free(layer->own);
    layer->own = own;
    layer->own_count = e->own_count;
    return MRT_OK;
}

static void move_layer(take *t, uint32_t from, uint32_t to)
{
    take_layer layer = t->layer[from];
    for (; from < to; ++from)
        t->layer[from] = t->layer[from + 1];
    for (; from > to; --from)
        t->layer[from] = t->layer[from - 1];
    t->layer[to] = layer;
}

static mrt_result add_layer(take *t, const edit *e, error *err)
{
    mrt_result result = check_name(e, err);
    if (result >= 0)
        result = edit_reserve((void **)&t->layer, sizeof *t->layer, t->layer_count, EDIT_LAYERS_MAX,
                              "layers", err);
    if (result < 0)
        return result;
    uint32_t top = t->layer_count++;
    t->layer[top] = (take_layer){.id = ++t->id_count, .gain = 1.0};
    memcpy(t->layer[top].name, e->name, sizeof t->layer[top].name);
    result = set_own(&t->layer[top], e, err);
    if (e->place < top)
        move_layer(t, top, e->place);
    return result;
}

static void remove_layer(take *t, uint32_t index)
{
    move_layer(t, index, t->layer_count - 1);
    take_layer *layer = &t->layer[--t->layer_count];
    for (uint32_t i = 0; i < layer->clip_count; ++i)
        edit_clip_finish(&layer->clip[i]);
    free(layer->clip);
    free(layer->own);
}

static mrt_result order_layer(take *t, take_layer *layer, const edit *e, error *err)
{
    if (e->place >= t->layer_count)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "$.place: expected 0 (the bottom) to %u (the top), found %u",
                         t->layer_count - 1, e->place);
    move_layer(t, (uint32_t)(layer - t->layer), e->place);
    return MRT_OK;
}

static mrt_result set_offset(take *t, take_layer *layer, const edit *e)
{
    layer->offset_ns = e->offset_ns;
    if (layer->clip_count)
        edit_grow(t, layer, &layer->clip[layer->clip_count - 1]);
    return MRT_OK;
}

static mrt_result rename_layer(take_layer *layer, const edit *e, error *err)
{
    mrt_result result = check_name(e, err);
    if (result >= 0)
        memcpy(layer->name, e->name, sizeof layer->name);
    return result;
}

static mrt_result apply_layer(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_LAYER_ADD)
        return add_layer(t, e, err);
    take_layer *layer;
    mrt_result result = edit_find_layer(&layer, t, e->layer, err);
    if (result < 0)
        return result;
    switch (e->kind) {
    case EDIT_LAYER_REMOVE:
        remove_layer(t, (uint32_t)(layer - t->layer));
        return MRT_OK;
    case EDIT_LAYER_RENAME:
        return rename_layer(layer, e, err);
    case EDIT_LAYER_ORDER:
        return order_layer(t, layer, e, err);
    case EDIT_LAYER_MUTE:
        layer->is_muted = e->is_muted;
        return MRT_OK;
    case EDIT_LAYER_SOLO:
        layer->is_solo = e->is_solo;
        return MRT_OK;
    case EDIT_LAYER_ADDITIVE:
        layer->is_additive = e->is_additive;
        return MRT_OK;
    case EDIT_LAYER_GAIN:
        layer->gain = e->gain;
        return MRT_OK;
    case EDIT_LAYER_COLOUR:
        layer->colour = e->colour;
        return MRT_OK;
    case EDIT_LAYER_OFFSET:
        return set_offset(t, layer, e);
    default:
        return set_own(layer, e, err);
    }
}

/* ---- clips ---- */

/* ---- ripple: later clips, markers and sound move with an edit ---- */

static mrt_result check_audio_ripple(const take *t, const edit *e, int64_t from_ns, error *err)
{
    const take_audio *audio = &t->audio;
    const bool has_ended = audio->out_ns > 0 && audio->offset_ns + audio->out_ns <= from_ns;
    if (audio->audio == 0 || audio->offset_ns >= from_ns || has_ended)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s with ripple: the take's audio begins before %s s and would lose sync; "
                     "switch ripple off, or detach the audio",
                     edit_name(e->kind), edit_seconds(from_ns).text);
}

static void grow_over_layers(take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (t->layer[i].clip_count)
            edit_grow(t, &t->layer[i], &t->layer[i].clip[t->layer[i].clip_count - 1]);
}

/* Moves what begins at from_ns or later by by_ns, except one clip. Markers in a span that is closed
 * go to its start. Times are those of the take. */
static mrt_result ripple(take *t, const edit *e, int64_t from_ns, int64_t by_ns, error *err)
{
    const int64_t before_ns = t->duration_ns;
    mrt_result result = by_ns == 0 ? MRT_OK : check_audio_ripple(t, e, from_ns, err);
    if (result < 0 || by_ns == 0)
        return result;
    for (uint32_t i = 0; i < t->layer_count; ++i) {
        take_layer *layer = &t->layer[i];
        for (uint32_t k = 0; k < layer->clip_count; ++k)
            if (layer->clip[k].id != e->clip &&
                layer->clip[k].start_ns + layer->offset_ns >= from_ns)
                edit_shift(&layer->clip[k], by_ns);
    }
    for (uint32_t i = 0; i < t->marker_count; ++i) {
        int64_t *at_ns = &t->marker[i].at_ns;
        if (*at_ns >= from_ns)
            *at_ns += by_ns;
        else if (*at_ns > from_ns + by_ns)
            *at_ns = from_ns + by_ns;
    }
    if (t->audio.audio && t->audio.offset_ns >= from_ns)
        t->audio.offset_ns += by_ns;
    t->duration_ns = before_ns + by_ns;
    grow_over_layers(t);
    if (t->duration_ns <= 0) /* nothing is left: an empty take keeps its length */
        t->duration_ns = before_ns;
    return MRT_OK;
}

/* ---- add, move: position a clip ---- */

static int64_t within_layer(int64_t shown_ns, const take_layer *layer)
{
    return shown_ns == EDIT_UNSAID ? EDIT_UNSAID : shown_ns - layer->offset_ns;
}

static mrt_result lay_and_grow(take *t, take_layer *layer, take_clip clip, error *err)
{
    edit_grow(t, layer, &clip);
    return edit_insert_clip(layer, clip, err);
}

static mrt_result add_clip(take *t, const edit *e, error *err)
{
    take_layer *layer;
    take_clip clip;
    mrt_result result = edit_find_layer(&layer, t, e->layer, err);
    if (result >= 0)
        result = edit_material(&clip, t, layer, e, within_layer(e->start_ns, layer),
                               within_layer(e->end_ns, layer), err);
    return result < 0 ? result : lay_and_grow(t, layer, clip, err);
}

static mrt_result missing_value(const edit *e, const char *what, error *err)
{
    return error_set(err, MRT_ERR_ARGUMENT, "clip %u: expected %s, or both", e->clip, what);
}

static mrt_result move_clip(take *t, edit_spot spot, const edit *e, error *err)
{
    if (e->start_ns == EDIT_UNSAID && e->layer == 0)
        return missing_value(e, "start_ns or layer", err);
    take_layer *layer = spot.layer;
    mrt_result result = e->layer ? edit_find_layer(&layer, t, e->layer, err) : MRT_OK;
    if (result < 0)
        return result;
    int64_t shown_ns =
        e->start_ns == EDIT_UNSAID ? spot.clip->start_ns + spot.layer->offset_ns : e->start_ns;
    const int64_t before_ns = spot.clip->start_ns + spot.layer->offset_ns;
    take_clip clip = edit_remove_clip(spot);
    edit_shift(&clip, shown_ns - layer->offset_ns - clip.start_ns);
    if (e->is_ripple)
        result = ripple(t, e, before_ns, shown_ns - before_ns, err);
    if (result < 0) {
        edit_clip_finish(&clip);
        return result;
    }
    return lay_and_grow(t, layer, clip, err);
}

static mrt_result remove_clip(take *t, edit_spot spot, const edit *e, error *err)
{
    const int64_t end_ns = spot.clip->end_ns + spot.layer->offset_ns;
    take_clip clip = edit_remove_clip(spot);
    const int64_t length_ns = clip.end_ns - clip.start_ns;
    edit_clip_finish(&clip);
    return e->is_ripple ? ripple(t, e, end_ns, -length_ns, err) : MRT_OK;
}

/* Inserts a clip whose ends were changed. With ripple it starts where it did. */
static mrt_result lay_changed(take *t, take_layer *layer, take_clip clip, const edit *e,
                              int64_t start_ns, int64_t end_ns, error *err)
{
    mrt_result result = MRT_OK;
    if (e->is_ripple) {
        edit_shift(&clip, start_ns - clip.start_ns);
        result = ripple(t, e, end_ns + layer->offset_ns, clip.end_ns - end_ns, err);
    }
    if (result >= 0)
        return lay_and_grow(t, layer, clip, err);
    edit_clip_finish(&clip);
    return result;
}

/* ---- trim, split ---- */

static mrt_result check_reach(edit_spot spot, int64_t start_ns, int64_t end_ns, error *err)
{
    const take_clip *clip = spot.clip;
    int64_t low_ns = edit_earliest_ns(clip), high_ns = edit_latest_ns(clip);
    bool starts = start_ns == clip->start_ns || start_ns >= low_ns;
    bool ends = end_ns == clip->end_ns || end_ns <= high_ns;
    if (starts && ends && start_ns < end_ns)
        return MRT_OK;
    int64_t offset_ns = spot.layer->offset_ns;
    return error_set(err, MRT_ERR_ARGUMENT, "%s: it cannot be trimmed to %s; its recording is %s",
                     edit_clip_words(spot.layer, clip).text,
                     edit_span_words(start_ns + offset_ns, end_ns + offset_ns).text,
                     edit_span_words(low_ns + offset_ns, high_ns + offset_ns).text);
}

static mrt_result trim_clip(take *t, edit_spot spot, const edit *e, error *err)
{
    if (e->start_ns == EDIT_UNSAID && e->end_ns == EDIT_UNSAID)
        return missing_value(e, "start_ns or end_ns", err);
    int64_t start_ns = within_layer(e->start_ns, spot.layer);
    int64_t end_ns = within_layer(e->end_ns, spot.layer);
    start_ns = start_ns == EDIT_UNSAID ? spot.clip->start_ns : start_ns;
    end_ns = end_ns == EDIT_UNSAID ? spot.clip->end_ns : end_ns;
    mrt_result result = check_reach(spot, start_ns, end_ns, err);
    if (result < 0)
        return result;
    take_clip clip = edit_remove_clip(spot);
    const int64_t old_start_ns = clip.start_ns, old_end_ns = clip.end_ns;
    clip.start_ns = start_ns;
    clip.end_ns = end_ns;
    edit_fit_fades(&clip);
    return lay_changed(t, spot.layer, clip, e, old_start_ns, old_end_ns, err);
}

/* Refuses a split within a cross-fade: three clips would overlap at an instant. */
static mrt_result check_split(edit_spot spot, int64_t at_ns, error *err)
{
    const take_layer *layer = spot.layer;
    const take_clip *clip = spot.clip;
    int64_t low_ns = clip->start_ns + 1, high_ns = clip->end_ns - 1;
    if (spot.index > 0 && clip[-1].end_ns > low_ns)
        low_ns = clip[-1].end_ns;
    if (spot.index + 1 < layer->clip_count && clip[1].start_ns < high_ns)
        high_ns = clip[1].start_ns;
    if (at_ns >= low_ns && at_ns <= high_ns)
        return MRT_OK;
    if (low_ns > high_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: it is cross-faded over its whole length and cannot be split",
                         edit_clip_words(layer, clip).text);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: it cannot be split at %s s; split it outside its cross-fades, in %s",
                     edit_clip_words(layer, clip).text, edit_seconds(at_ns + layer->offset_ns).text,
                     edit_span_words(low_ns + layer->offset_ns, high_ns + layer->offset_ns).text);
}

static mrt_result split_clip(take *t, edit_spot spot, const edit *e, error *err)
{
    int64_t at_ns = within_layer(e->at_ns, spot.layer);
    take_clip after;
    mrt_result result = check_split(spot, at_ns, err);
    if (result >= 0)
        result = edit_clip_copy(&after, spot.clip, ++t->id_count, err);
    if (result < 0)
        return result;
    after.start_ns = at_ns;
    after.fade_in_ns = 0;
    spot.clip->end_ns = at_ns;
    spot.clip->fade_out_ns = 0;
    edit_fit_fades(spot.clip);
    edit_fit_fades(&after);
    return edit_insert_clip(spot.layer, after, err);
}

/* ---- time within a clip ---- */

static int64_t scaled(int64_t time_ns, int64_t about_ns, double speed)
{
    return about_ns + (int64_t)floor((double)(time_ns - about_ns) / speed + 0.5);
}

/* Adds a second point to a warp of one point, which runs at speed 1, so that its speed can be
 * changed. */
static mrt_result add_second_point(take_clip *clip, error *err)
{
    if (clip->warp_count > 1)
        return MRT_OK;
    mrt_result result = edit_reserve((void **)&clip->warp, sizeof *clip->warp, clip->warp_count,
                                     EDIT_WARP_MAX, "points of a warp", err);
    if (result < 0)
        return result;
    int64_t length_ns = clip->end_ns - clip->start_ns;
    clip->warp[1] =
        (take_warp_point){clip->warp[0].at_ns + length_ns, clip->warp[0].source_ns + length_ns};
    clip->warp_count = 2;
    return MRT_OK;
}

/* Moves an end back into the recording, since rounding may exceed it by one ns. */
static void keep_to_recording(take_clip *clip)
{
    if (take_warp_to_source(clip, clip->start_ns) < 0)
        clip->start_ns = edit_earliest_ns(clip);
    if (take_warp_to_source(clip, clip->end_ns) > clip->to_ns - clip->from_ns)
        clip->end_ns = edit_latest_ns(clip);
}

static mrt_result set_speed(take *t, edit_spot spot, const edit *e, error *err)
{
    mrt_result result = add_second_point(spot.clip, err);
    if (result < 0)
        return result;
    take_clip clip = edit_remove_clip(spot);
    const int64_t old_start_ns = clip.start_ns, old_end_ns = clip.end_ns;
    int64_t about_ns = e->at_ns == EDIT_UNSAID ? clip.start_ns : e->at_ns - spot.layer->offset_ns;
    for (uint32_t i = 0; i < clip.warp_count; ++i)
        clip.warp[i].at_ns = scaled(clip.warp[i].at_ns, about_ns, e->speed);
    clip.start_ns = scaled(clip.start_ns, about_ns, e->speed);
    clip.end_ns = scaled(clip.end_ns, about_ns, e->speed);
    if (!edit_is_warp(clip.warp, clip.warp_count, EDIT_CLIP_MAX_NS) ||
        clip.end_ns <= clip.start_ns) {
        edit_clip_finish(&clip);
        return error_set(err, MRT_ERR_ARGUMENT,
                         "clip %u: %g times its speed is outside 1/1000 to 1000 times the recorded "
                         "speed, or leaves nothing of it; choose a speed nearer to 1",
                         e->clip, e->speed);
    }
    keep_to_recording(&clip);
    edit_fit_fades(&clip);
    return lay_changed(t, spot.layer, clip, e, old_start_ns, old_end_ns, err);
}

static mrt_result set_curve(edit_spot spot, const edit *e, error *err)
{
    take_warp_point *warp = calloc(e->warp_count, sizeof *warp);
    if (!warp)
        return error_set(err, MRT_ERR_MEMORY, "clip %u: no memory for its curve", e->clip);
    for (uint32_t i = 0; i < e->warp_count; ++i)
        warp[i] = (take_warp_point){e->warp[i].at_ns - spot.layer->offset_ns, e->warp[i].source_ns};
    free(spot.clip->warp);
    spot.clip->warp = warp;
    spot.clip->warp_count = e->warp_count;
    int64_t first_ns = take_warp_to_source(spot.clip, spot.clip->start_ns);
    int64_t last_ns = take_warp_to_source(spot.clip, spot.clip->end_ns);
    int64_t length_ns = spot.clip->to_ns - spot.clip->from_ns;
    if (first_ns >= 0 && last_ns <= length_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: that curve shows %s of a recording of 0 .. %s s; keep it within the "
                     "recording, or trim the clip",
                     edit_clip_words(spot.layer, spot.clip).text,
                     edit_span_words(first_ns, last_ns).text, edit_seconds(length_ns).text);
}

/* ---- gains and fades ---- */

static mrt_result set_fades(edit_spot spot, const edit *e, error *err)
{
    if (e->fade_in_ns == EDIT_UNSAID && e->fade_out_ns == EDIT_UNSAID)
        return missing_value(e, "fade_in_ns or fade_out_ns", err);
    take_clip *clip = spot.clip;
    int64_t in_ns = e->fade_in_ns == EDIT_UNSAID ? clip->fade_in_ns : e->fade_in_ns;
    int64_t out_ns = e->fade_out_ns == EDIT_UNSAID ? clip->fade_out_ns : e->fade_out_ns;
    if (in_ns + out_ns > clip->end_ns - clip->start_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s: fades of %s s and %s s are longer than its %s s; shorten them",
                         edit_clip_words(spot.layer, clip).text, edit_seconds(in_ns).text,
                         edit_seconds(out_ns).text,
                         edit_seconds(clip->end_ns - clip->start_ns).text);
    clip->fade_in_ns = in_ns;
    clip->fade_out_ns = out_ns;
    return MRT_OK;
}

static mrt_result apply_clip(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_CLIP_ADD)
        return add_clip(t, e, err);
    edit_spot spot;
    mrt_result result = edit_find_clip(&spot, t, e->clip, err);
    if (result < 0)
        return result;
    switch (e->kind) {
    case EDIT_CLIP_REMOVE:
        return remove_clip(t, spot, e, err);
    case EDIT_CLIP_TRIM:
        return trim_clip(t, spot, e, err);
    case EDIT_CLIP_SPLIT:
        return split_clip(t, spot, e, err);
    case EDIT_CLIP_MOVE:
        return move_clip(t, spot, e, err);
    case EDIT_CLIP_SPEED:
        return set_speed(t, spot, e, err);
    case EDIT_CLIP_CURVE:
        return set_curve(spot, e, err);
    case EDIT_CLIP_SMOOTH:
        spot.clip->smooth_s = e->smooth_s;
        return MRT_OK;
    case EDIT_CLIP_GAIN:
        spot.clip->gain = e->gain;
        return MRT_OK;
    case EDIT_CLIP_FADE:
        return set_fades(spot, e, err);
    case EDIT_CLIP_MUTE:
        spot.clip->is_muted = e->is_muted;
        return MRT_OK;
    case EDIT_CLIP_COLOUR:
        spot.clip->colour = e->colour;
        return MRT_OK;
    default:
        spot.clip->performance = e->performance;
        return MRT_OK;
    }
}

/* ---- ranges of the timeline ---- */

/* ---- the range and the layers ---- */

static mrt_result check_range(const take *t, const edit *e, error *err)
{
    if (e->in_ns >= 0 && e->in_ns < e->out_ns && e->out_ns <= t->duration_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%s %s: expected a range within the take's 0 .. %s s",
                     edit_name(e->kind), edit_span_words(e->in_ns, e->out_ns).text,
                     edit_seconds(t->duration_ns).text);
}

static mrt_result check_named_layers(take *t, const edit *e, error *err)
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

/* Refuses a cut before which the audio has started, because audio cannot be cut. Audio that starts
 * after the cut moves with the later clips. */
static mrt_result check_audio(const take *t, const edit *e, int64_t out_ns, error *err)
{
    if (e->layer_count > 0 || t->audio.audio == 0 || t->audio.offset_ns >= out_ns)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: the take's audio begins before %s s and would lose sync; name layers to "
                     "keep the audio unchanged, or detach it, or leave a gap",
                     edit_name(e->kind), edit_seconds(out_ns).text);
}

/* ---- keep ---- */

/* Removes clips outside the range. A clip whose neighbour was removed loses the fade where it was
 * cross-faded. */
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

/* Keeps a range. Clips that cross its ends stay whole, so nothing within the range changes, not
 * even weights. */
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

/* Moves markers and audio from out_ns on. */
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
        result = check_named_layers(t, e, err);
    if (result >= 0 && e->is_ripple)
        result = check_audio(t, e, e->out_ns, err);
    if (result >= 0)
        result = cut_layers(t, e, e->in_ns, e->out_ns, later_ns, err);
    if (result >= 0 && e->is_ripple && e->layer_count == 0)
        move_rest(t, e->in_ns, e->out_ns, later_ns);
    return result;
}

static mrt_result insert(take *t, const edit *e, error *err)
{
    if (e->at_ns < 0 || e->at_ns > t->duration_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "range.insert at %s s: expected a time within the take's 0 .. %s s",
                         edit_seconds(e->at_ns).text, edit_seconds(t->duration_ns).text);
    mrt_result result = check_named_layers(t, e, err);
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

static mrt_result apply_range(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_RANGE_KEEP)
        return keep(t, e, err);
    return e->kind == EDIT_RANGE_CUT ? cut(t, e, err) : insert(t, e, err);
}

/* ---- punch-in and comp ---- */

typedef struct punch_span { /* times of the layer */
    int64_t in_ns, out_ns, fade_ns;
} punch_span;

static mrt_result check_span(const edit *e, error *err)
{
    if (e->in_ns >= e->out_ns)
        return error_set(err, MRT_ERR_ARGUMENT, "%s %s: expected an end after the start",
                         edit_name(e->kind), edit_span_words(e->in_ns, e->out_ns).text);
    if (e->fade_ns <= (e->out_ns - e->in_ns) / 2)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s %s: two cross-fades of %s s do not fit into it; use at most %s s",
                     edit_name(e->kind), edit_span_words(e->in_ns, e->out_ns).text,
                     edit_seconds(e->fade_ns).text, edit_seconds((e->out_ns - e->in_ns) / 2).text);
}

/* ---- valid ends of the span ---- */

typedef struct soft_span { /* a span in which the weights of a clip change */
    int64_t from_ns, until_ns;
} soft_span;

static bool cross_fade(const take_clip *first, const take_clip *second)
{
    return !first->is_muted && !second->is_muted && second->start_ns < first->end_ns;
}

/* Finds the cross-fade or fade that contains an instant, without its ends. */
static bool find_soft_span(soft_span *out, const take_layer *layer, int64_t at_ns)
{
    for (uint32_t i = 0; i < layer->clip_count; ++i) {
        const take_clip *clip = &layer->clip[i];
        bool crosses_before = i > 0 && cross_fade(clip - 1, clip);
        bool crosses_after = i + 1 < layer->clip_count && cross_fade(clip, clip + 1);
        int64_t fade_in_ns = crosses_before ? 0 : clip->fade_in_ns;
        int64_t fade_out_ns = crosses_after ? clip->end_ns - clip[1].start_ns : clip->fade_out_ns;
        const soft_span span[2] = {{clip->start_ns, clip->start_ns + fade_in_ns},
                                   {clip->end_ns - fade_out_ns, clip->end_ns}};
        for (int k = 0; k < 2 && !clip->is_muted; ++k)
            if (span[k].from_ns < at_ns && at_ns < span[k].until_ns) {
                *out = span[k];
                return true;
            }
    }
    return false;
}

/* Checks that the span does not end within a fade. The layer must not change outside the span, so a
 * fade cannot be cut. */
static mrt_result check_hard(const take_layer *layer, const edit *e, int64_t at_ns, error *err)
{
    soft_span span;
    if (!find_soft_span(&span, layer, at_ns))
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT, "%s: %s s is within a fade of %s; choose %s s or %s s",
                     edit_name(e->kind), edit_seconds(at_ns + layer->offset_ns).text,
                     edit_layer_words(layer).text,
                     edit_seconds(span.from_ns + layer->offset_ns).text,
                     edit_seconds(span.until_ns + layer->offset_ns).text);
}

/* ---- extending existing clips over the fades, as far as their recordings reach ---- */

/* Extends a clip over the start. A fade that is longer than the cross-fade was set by the user, and
 * is kept. */
static bool reach_over_start(take_layer *layer, const punch_span *span)
{
    for (uint32_t i = layer->clip_count; i-- > 0;) {
        take_clip *clip = &layer->clip[i];
        if (clip->is_muted || clip->end_ns != span->in_ns)
            continue;
        if (clip->fade_out_ns > span->fade_ns)
            return false;
        int64_t latest_ns = edit_latest_ns(clip), end_ns = span->in_ns + span->fade_ns;
        if (latest_ns > clip->end_ns)
            clip->end_ns = latest_ns < end_ns ? latest_ns : end_ns;
        clip->fade_out_ns = 0;
        return true;
    }
    return false;
}

static bool reach_over_end(take_layer *layer, const punch_span *span)
{
    for (uint32_t i = 0; i < layer->clip_count; ++i) {
        take_clip *clip = &layer->clip[i];
        if (clip->is_muted || clip->start_ns != span->out_ns)
            continue;
        if (clip->fade_in_ns > span->fade_ns)
            return false;
        int64_t earliest_ns = edit_earliest_ns(clip), start_ns = span->out_ns - span->fade_ns;
        if (earliest_ns < clip->start_ns)
            clip->start_ns = earliest_ns > start_ns ? earliest_ns : start_ns;
        clip->fade_in_ns = 0;
        return true;
    }
    return false;
}

static mrt_result punch_layer(take *t, take_layer *layer, const edit *e, error *err)
{
    punch_span span = {e->in_ns - layer->offset_ns, e->out_ns - layer->offset_ns, e->fade_ns};
    take_clip clip;
    mrt_result result = check_hard(layer, e, span.in_ns, err);
    if (result >= 0)
        result = check_hard(layer, e, span.out_ns, err);
    if (result >= 0)
        result = edit_material(&clip, t, layer, e, span.in_ns, span.out_ns, err);
    if (result < 0)
        return result;
    result = edit_cut(t, layer, span.in_ns, span.out_ns, 0, err);
    if (result < 0) {
        edit_clip_finish(&clip);
        return result;
    }
    clip.fade_in_ns = reach_over_start(layer, &span) ? 0 : span.fade_ns;
    clip.fade_out_ns = reach_over_end(layer, &span) ? 0 : span.fade_ns;
    edit_grow(t, layer, &clip);
    return edit_insert_clip(layer, clip, err);
}

/* ---- comp: a layer for each part of the face ---- */

typedef struct part { /* a part of the face; its patterns are valid as long as the edit */
    char name[TAKE_NAME];
    uint32_t pattern_count;
    char pattern[EDIT_OWN_MAX][TAKE_NAME];
} part;

static void part_of_region(part *out, own_region region)
{
    const own_part *own = own_part_of(region);
    *out = (part){.pattern_count = own->pattern_count};
    (void)snprintf(out->name, sizeof out->name, "%s", own->name);
    for (uint32_t i = 0; i < own->pattern_count; ++i)
        (void)snprintf(out->pattern[i], sizeof out->pattern[i], "%s", own->pattern[i]);
}

static void part_of_patterns(part *out, const edit *e)
{
    *out = (part){.pattern_count = e->own_count};
    memcpy(out->name, e->name[0] ? e->name : e->own[0], sizeof out->name);
    memcpy(out->pattern, e->own, e->own_count * sizeof *e->own);
}

static bool is_layer_of(const take_layer *layer, const part *p)
{
    if (layer->own_count != p->pattern_count || layer->is_additive)
        return false;
    for (uint32_t i = 0; i < p->pattern_count; ++i)
        if (strcmp(layer->own[i], p->pattern[i]) != 0)
            return false;
    return true;
}

static bool meets(const take_layer *layer, const part *p)
{
    for (uint32_t i = 0; i < layer->own_count; ++i)
        for (uint32_t k = 0; k < p->pattern_count; ++k)
            if (own_patterns_overlap(layer->own[i], p->pattern[k]))
                return true;
    return layer->own_count == 0;
}

/* Finds the layer of exactly that part, unless a later layer may replace it. */
static take_layer *find_comp_layer(take *t, const part *p)
{
    for (uint32_t i = t->layer_count; i-- > 0;) {
        if (is_layer_of(&t->layer[i], p))
            return &t->layer[i];
        if (meets(&t->layer[i], p))
            return NULL;
    }
    return NULL;
}

static mrt_result add_comp_layer(take_layer **out, take *t, part *p, error *err)
{
    edit add;
    edit_init(&add, EDIT_LAYER_ADD);
    memcpy(add.name, p->name, sizeof add.name);
    add.own = p->pattern;
    add.own_count = p->pattern_count;
    mrt_result result = apply_layer(t, &add, err);
    *out = result < 0 ? NULL : &t->layer[t->layer_count - 1];
    return result;
}

static mrt_result comp_part(take *t, part *p, const edit *e, error *err)
{
    take_layer *layer = find_comp_layer(t, p);
    mrt_result result = layer ? MRT_OK : add_comp_layer(&layer, t, p, err);
    return result < 0 ? result : punch_layer(t, layer, e, err);
}

static mrt_result comp(take *t, const edit *e, error *err)
{
    if ((e->regions != 0) == (e->own_count != 0))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "comp: expected either regions, such as [\"mouth\"], or own, such as "
                         "[\"jaw.*\"]");
    part p;
    if (e->own_count) {
        part_of_patterns(&p, e);
        return comp_part(t, &p, e, err);
    }
    mrt_result result = MRT_OK;
    for (uint32_t region = 0; result >= 0 && region < OWN_REGION_COUNT; ++region) {
        if (!(e->regions & 1u << region))
            continue;
        part_of_region(&p, (own_region)region);
        result = comp_part(t, &p, e, err);
    }
    return result;
}

static mrt_result apply_punch(take *t, const edit *e, error *err)
{
    take_layer *layer;
    mrt_result result = check_span(e, err);
    if (result < 0)
        return result;
    if (e->kind == EDIT_COMP)
        return comp(t, e, err);
    result = edit_find_layer(&layer, t, e->layer, err);
    return result < 0 ? result : punch_layer(t, layer, e, err);
}

/* ---- the mouth of a voice ---- */

static void remove_clips(take_layer *layer)
{
    for (uint32_t i = 0; i < layer->clip_count; ++i)
        edit_clip_finish(&layer->clip[i]);
    layer->clip_count = 0;
}

static mrt_result add_lowest_layer(take_layer **out, take *t, const edit *e, error *err)
{
    edit add;
    edit_init(&add, EDIT_LAYER_ADD);
    memcpy(add.name, e->name, sizeof add.name);
    add.place = 0;
    mrt_result result = apply_layer(t, &add, err);
    if (result < 0)
        return result;
    for (uint32_t i = 1; i < t->layer_count; ++i)
        t->layer[i].is_additive = true;
    *out = &t->layer[0];
    return MRT_OK;
}

static mrt_result apply_mouth(take *t, const edit *e, error *err)
{
    take_layer *layer = NULL;
    mrt_result result =
        e->layer ? edit_find_layer(&layer, t, e->layer, err) : add_lowest_layer(&layer, t, e, err);
    if (result < 0)
        return result;
    remove_clips(layer);
    edit of;
    edit_init(&of, EDIT_CLIP_ADD);
    of.part = TAKE_PALETTE;
    of.performance = e->performance;
    of.from_ns = e->from_ns;
    of.to_ns = e->to_ns;
    take_clip clip;
    result = edit_material(&clip, t, layer, &of, within_layer(e->start_ns, layer),
                           within_layer(e->end_ns, layer), err);
    return result < 0 ? result : lay_and_grow(t, layer, clip, err);
}

/* ---- every operation ---- */

static mrt_result apply_by_kind(take *t, const edit *e, error *err)
{
    if (e->kind <= EDIT_TAKE_RESTORE)
        return apply_take(t, e, err);
    if (e->kind <= EDIT_MARKER_REMOVE)
        return apply_marker(t, e, err);
    if (e->kind <= EDIT_LAYER_OWN)
        return apply_layer(t, e, err);
    if (e->kind <= EDIT_CLIP_PERFORM)
        return apply_clip(t, e, err);
    if (e->kind <= EDIT_RANGE_INSERT)
        return apply_range(t, e, err);
    if (e->kind == EDIT_MOUTH)
        return apply_mouth(t, e, err);
    return e->kind <= EDIT_COMP ? apply_punch(t, e, err) : apply_audio(t, e, err);
}

mrt_result edit_apply_onto(take *t, const edit *e, error *err)
{
    mrt_result result = edit_check_arguments(e, err);
    if (result < 0)
        return result;
    edit_count_ids(t);
    result = apply_by_kind(t, e, err);
    return result < 0 ? result : edit_check(t, err);
}

mrt_result edit_apply(take *t, const edit *e, error *err)
{
    take changed;
    mrt_result result = take_copy(&changed, t, err);
    if (result < 0)
        return result;
    result = edit_apply_onto(&changed, e, err);
    if (result < 0) {
        take_finish(&changed);
        return result;
    }
    take_finish(t);
    *t = changed;
    return MRT_OK;
}

/* ---- references to recordings ---- */

static const take_clip *find_clip(const take *t, uint32_t id)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k)
            if (t->layer[i].clip[k].id == id)
                return &t->layer[i].clip[k];
    return NULL;
}

bool edit_refers(edit_reference *out, const edit *e, const take *before)
{
    *out = (edit_reference){.performance = e->performance};
    if (e->kind == EDIT_CLIP_PERFORM) {
        const take_clip *clip = find_clip(before, e->clip);
        out->from_ns = clip ? clip->from_ns : 0;
        out->to_ns = clip ? clip->to_ns : 0;
        return clip != NULL;
    }
    edit full = edit_with_defaults(e, before);
    out->from_ns = full.from_ns;
    out->to_ns = full.to_ns;
    return e->kind == EDIT_CLIP_ADD || e->kind == EDIT_PUNCH || e->kind == EDIT_COMP ||
           e->kind == EDIT_MOUTH;
}
