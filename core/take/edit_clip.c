#include "take/edit_parts.h"

#include <math.h>
#include <stdlib.h>

/* ---- add, move: clips that get a place ---- */

static int64_t within_layer(int64_t shown_ns, const take_layer *layer)
{
    return shown_ns == EDIT_UNSAID ? EDIT_UNSAID : shown_ns - layer->offset_ns;
}

static mrt_result lay_and_grow(take *t, take_layer *layer, take_clip clip, error *err)
{
    edit_grow(t, layer, &clip);
    return edit_lay(layer, clip, err);
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

static mrt_result nothing_said(const edit *e, const char *what, error *err)
{
    return error_set(err, MRT_ERR_ARGUMENT, "clip %u: expected %s, or both", e->clip, what);
}

static mrt_result move_clip(take *t, edit_spot spot, const edit *e, error *err)
{
    if (e->start_ns == EDIT_UNSAID && e->layer == 0)
        return nothing_said(e, "start_ns or layer", err);
    take_layer *layer = spot.layer;
    mrt_result result = e->layer ? edit_find_layer(&layer, t, e->layer, err) : MRT_OK;
    if (result < 0)
        return result;
    int64_t shown_ns =
        e->start_ns == EDIT_UNSAID ? spot.clip->start_ns + spot.layer->offset_ns : e->start_ns;
    take_clip clip = edit_lift(spot);
    edit_shift(&clip, shown_ns - layer->offset_ns - clip.start_ns);
    return lay_and_grow(t, layer, clip, err);
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
        return nothing_said(e, "start_ns or end_ns", err);
    int64_t start_ns = within_layer(e->start_ns, spot.layer);
    int64_t end_ns = within_layer(e->end_ns, spot.layer);
    start_ns = start_ns == EDIT_UNSAID ? spot.clip->start_ns : start_ns;
    end_ns = end_ns == EDIT_UNSAID ? spot.clip->end_ns : end_ns;
    mrt_result result = check_reach(spot, start_ns, end_ns, err);
    if (result < 0)
        return result;
    take_clip clip = edit_lift(spot);
    clip.start_ns = start_ns;
    clip.end_ns = end_ns;
    edit_fit_fades(&clip);
    return lay_and_grow(t, spot.layer, clip, err);
}

/* Two halves within one cross-fade would be three clips at an instant. */
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
        return error_set(err, MRT_ERR_ARGUMENT, "%s: it cross-fades all along: nowhere to split it",
                         edit_clip_words(layer, clip).text);
    return error_set(err, MRT_ERR_ARGUMENT,
                     "%s: it cannot be split at %s s; outside of its cross-fades is %s",
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
    return edit_lay(spot.layer, after, err);
}

/* ---- time within a clip ---- */

static int64_t scaled(int64_t time_ns, int64_t about_ns, double speed)
{
    return about_ns + (int64_t)floor((double)(time_ns - about_ns) / speed + 0.5);
}

/* A warp of one point runs at speed 1; a second point says so. */
static mrt_result say_speed(take_clip *clip, error *err)
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

/* Rounding may put an end one ns beyond the recording. */
static void keep_to_recording(take_clip *clip)
{
    if (take_warp_to_source(clip, clip->start_ns) < 0)
        clip->start_ns = edit_earliest_ns(clip);
    if (take_warp_to_source(clip, clip->end_ns) > clip->to_ns - clip->from_ns)
        clip->end_ns = edit_latest_ns(clip);
}

static mrt_result set_speed(take *t, edit_spot spot, const edit *e, error *err)
{
    mrt_result result = say_speed(spot.clip, err);
    if (result < 0)
        return result;
    take_clip clip = edit_lift(spot);
    int64_t about_ns = e->at_ns == EDIT_UNSAID ? clip.start_ns : e->at_ns - spot.layer->offset_ns;
    for (uint32_t i = 0; i < clip.warp_count; ++i)
        clip.warp[i].at_ns = scaled(clip.warp[i].at_ns, about_ns, e->speed);
    clip.start_ns = scaled(clip.start_ns, about_ns, e->speed);
    clip.end_ns = scaled(clip.end_ns, about_ns, e->speed);
    if (!edit_is_warp(clip.warp, clip.warp_count, EDIT_CLIP_MAX_NS) ||
        clip.end_ns <= clip.start_ns) {
        edit_clip_finish(&clip);
        return error_set(
            err, MRT_ERR_ARGUMENT,
            "clip %u: %g times its speed leaves 1/1000 to 1000 times as fast as it was "
            "recorded, or nothing of it; choose a speed nearer to 1",
            e->clip, e->speed);
    }
    keep_to_recording(&clip);
    edit_fit_fades(&clip);
    return lay_and_grow(t, spot.layer, clip, err);
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
                     "%s: that curve shows %s of a recording of 0 .. %s s; let it stay within, or "
                     "trim the clip",
                     edit_clip_words(spot.layer, spot.clip).text,
                     edit_span_words(first_ns, last_ns).text, edit_seconds(length_ns).text);
}

/* ---- how loud ---- */

static mrt_result set_fades(edit_spot spot, const edit *e, error *err)
{
    if (e->fade_in_ns == EDIT_UNSAID && e->fade_out_ns == EDIT_UNSAID)
        return nothing_said(e, "fade_in_ns or fade_out_ns", err);
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

mrt_result edit_apply_clip(take *t, const edit *e, error *err)
{
    if (e->kind == EDIT_CLIP_ADD)
        return add_clip(t, e, err);
    edit_spot spot;
    mrt_result result = edit_find_clip(&spot, t, e->clip, err);
    if (result < 0)
        return result;
    switch (e->kind) {
    case EDIT_CLIP_REMOVE: {
        take_clip clip = edit_lift(spot);
        edit_clip_finish(&clip);
        return MRT_OK;
    }
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
    default:
        spot.clip->performance = e->performance;
        return MRT_OK;
    }
}
