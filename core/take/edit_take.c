#include "take/edit_parts.h"
#include "take/timecode.h"

#include <string.h>

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
        return error_set(err, MRT_ERR_ARGUMENT,
                         "$.drop: at %.6g frames a second there is no drop-frame time code; only "
                         "29.97 and 59.94 have it",
                         t->fps);
    t->timecode_frame = e->frame;
    t->is_drop_frame = e->is_drop;
    return MRT_OK;
}

mrt_result edit_apply_take(take *t, const edit *e, error *err)
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

/* ---- markers: in order of time; one that is added or moved comes after others of its instant ----
 */

static void lay_marker(take *t, take_marker marker)
{
    uint32_t place = t->marker_count++;
    for (; place > 0 && t->marker[place - 1].at_ns > marker.at_ns; --place)
        t->marker[place] = t->marker[place - 1];
    t->marker[place] = marker;
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

mrt_result edit_apply_marker(take *t, const edit *e, error *err)
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

mrt_result edit_apply_audio(take *t, const edit *e, error *err)
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
    else if (e->kind == EDIT_AUDIO_GAIN)
        t->audio.gain = e->gain;
    else
        t->audio = (take_audio){0};
    return MRT_OK;
}
