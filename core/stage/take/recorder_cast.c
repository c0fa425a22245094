/* Who performs, and as what it is recorded: tracks that go on when others perform, and those that
 * begin. */
#include "stage/mapping/identity.h"
#include "stage/take/recorder_state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what is performed ---- */

static mrt_result describe_performance(const recorder *self, recorder_cast *cast,
                                       const recorder_settings *of, error *err)
{
    take_performance *p = &cast->performance;
    instance *mapping = of->mapping ? of->mapping : layer_mapping(cast->layer);
    mrt_result result = identity_of_face(p, of->face, of->face_path, of->unit_mm, err);
    if (result < 0)
        return result;
    p->mapping = identity_of_plugin(self->settings.plugins, mapping->type);
    if (!p->mapping)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    p->hand_length_mm = of->hand_length_mm;
    p->rezero_pedal = of->rezero_pedal;
    p->track_count = cast->input_count;
    memcpy(p->track, cast->track, sizeof p->track);
    identity_of_params(p, mapping);
    return MRT_OK;
}

static void describe_channels(take_track *out, const mrt_channel *channel, uint32_t count)
{
    out->channel_count = count;
    for (uint32_t i = 0; i < count; ++i) {
        take_channel *c = &out->channel[i];
        snprintf(c->name, sizeof c->name, "%s", channel[i].name);
        snprintf(c->unit, sizeof c->unit, "%s", channel[i].unit);
        c->semantic = channel[i].semantic;
        c->hand = channel[i].hand;
        c->min = channel[i].min;
        c->max = channel[i].max;
    }
}

mrt_result recorder_cast_add_track(recorder *self, recorder_cast *cast, uint32_t i,
                                   uint32_t version, error *err)
{
    take_track track = {0};
    uint32_t count;
    const mrt_channel *channel = input_channels_of(cast->inputs[i], version, &count);
    describe_channels(&track, channel, count);
    track.input = strdup(cast->input_text[i]);
    track.device = strdup(input_name(cast->inputs[i]));
    track.plugin = identity_of_plugin(self->settings.plugins, input_plugin(cast->inputs[i]));
    mrt_result result = MRT_OK;
    if (!track.input || !track.device || !track.plugin)
        result = error_set(err, MRT_ERR_MEMORY, "no memory to record");
    for (int side = 0; side < 2 && result >= 0; ++side) {
        if (!cast->calibration[side])
            continue;
        track.calibration[side] = strdup(cast->calibration[side]);
        if (!track.calibration[side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory to record");
    }
    if (result >= 0)
        result = writer_add_track(self->writer, &track, err);
    cast->track[i] = track.id;
    cast->version[i] = version;
    take_track_finish(&track);
    return result;
}

/* ---- casts ---- */

void recorder_cast_destroy(recorder_cast *cast)
{
    if (!cast)
        return;
    free(cast->calibration[MRT_LEFT]);
    free(cast->calibration[MRT_RIGHT]);
    take_performance_finish(&cast->performance);
    free(cast);
}

static bool is_same_text(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

/* An input has a track already, which goes on: which one by then, share_tracks says. [main], while
 * the frame thread may change `now`'s tracks. */
static bool keeps_track(const recorder_cast *now, const recorder_cast *cast, uint32_t i)
{
    bool is_calibrated_alike = is_same_text(now->calibration[0], cast->calibration[0]) &&
                               is_same_text(now->calibration[1], cast->calibration[1]);
    for (uint32_t j = 0; j < now->input_count && is_calibrated_alike; ++j)
        if (now->inputs[j] == cast->inputs[i])
            return true;
    return false;
}

mrt_result recorder_prepare(recorder *self, const recorder_settings *of, recorder_cast **out,
                            error *err)
{
    *out = NULL;
    if (of->input_count > RECORDER_INPUTS_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u inputs: %d can be recorded", of->input_count,
                         RECORDER_INPUTS_MAX);
    recorder_cast *cast = calloc(1, sizeof *cast);
    if (!cast)
        return error_set(err, MRT_ERR_MEMORY, "no memory to record");
    cast->input_count = of->input_count;
    cast->layer = of->layer;
    cast->performer = of->performer;
    mrt_result result = MRT_OK;
    for (int side = 0; side < 2 && result >= 0; ++side) {
        if (!of->calibration[side])
            continue;
        cast->calibration[side] = strdup(of->calibration[side]);
        if (!cast->calibration[side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory to record");
    }
    for (uint32_t i = 0; i < of->input_count && result >= 0; ++i) {
        cast->inputs[i] = of->inputs[i];
        cast->input_text[i] = of->input_text[i];
        cast->is_kept[i] = self->cast && keeps_track(self->cast, cast, i);
        if (!cast->is_kept[i])
            result = recorder_cast_add_track(self, cast, i, 0, err);
    }
    if (result >= 0)
        result = describe_performance(self, cast, of, err);
    if (result < 0) {
        recorder_dismiss(self, cast);
        return result;
    }
    *out = cast;
    return MRT_OK;
}

/* Both casts have the tracks that they share; which versions they have by now is the old one's to
 * tell. */
static void share_tracks(recorder_cast *old, recorder_cast *cast)
{
    for (uint32_t j = 0; j < old->input_count; ++j) {
        old->is_kept[j] = false;
        for (uint32_t i = 0; i < cast->input_count; ++i) {
            if (!cast->is_kept[i] || cast->inputs[i] != old->inputs[j])
                continue;
            old->is_kept[j] = true;
            cast->track[i] = cast->performance.track[i] = old->track[j];
            cast->version[i] = old->version[j];
        }
    }
    memset(cast->is_kept, 0, sizeof cast->is_kept);
}

void recorder_leave(recorder *self)
{
    if (self->watched)
        layer_watch_params(self->watched, NULL, NULL);
    self->watched = NULL;
}

recorder_cast *recorder_change(recorder *self, recorder_cast *cast)
{
    recorder_cast *old = self->cast;
    share_tracks(old, cast);
    recorder_leave(self);
    self->cast = cast;
    self->is_to_begin = true;
    return old;
}

void recorder_dismiss(recorder *self, recorder_cast *cast)
{
    error ignored = {""};
    for (uint32_t i = 0; cast && i < cast->input_count; ++i)
        if (!cast->is_kept[i] && cast->track[i] != 0 &&
            writer_end_track(self->writer, cast->track[i], &ignored) < 0)
            recorder_note_problem(self, &ignored);
    recorder_cast_destroy(cast);
}
