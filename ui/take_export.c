/* Takes out of the program: frames at a true frame rate, sound, and the sum of all vertices. */
#include "base/file.h"
#include "recording.h"
#include "take/sound_file.h"
#include "take_play.h"
#include "take_stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- frames ---- */

static mrt_result keep_frame(void *data, take_stage *from, error *err)
{
    return recording_add(data, sequencer_composer(from->sequencer), 0, err);
}

static void label_first(clip_start *out, const take *t, const take_frames *frames)
{
    *out = (clip_start){.frame = take_label_frame(t, frames->rate, frames->first),
                        .rate_num = frames->rate.num,
                        .rate_den = frames->rate.den};
    char text[TIMECODE_TEXT];
    timecode_write(text, frames->rate, out->frame);
    (void)snprintf(out->timecode, sizeof out->timecode, "%s", text);
}

static void tell_frames(take_call *call, const take_stage *stage, const clip_start *start,
                        const take_frames *frames, const recording *kept)
{
    facts *told = call->told;
    char rate[32];
    (void)snprintf(rate, sizeof rate, "%u/%u", start->rate_num, start->rate_den);
    facts_text(told, "take", "take",
               take_slate_text(stage->take.scene, stage->take.shot, stage->take.number).text);
    facts_text(told, "face", "face", stage->face_path);
    facts_number(told, "vertices", "vertices", stage->face.mesh.vertex_count, 0, "");
    facts_number(told, "samples", "samples performed",
                 (double)sequencer_sample_count(stage->sequencer), 0, "");
    facts_number(told, "frames", "frames", (double)frames->count, 0, "");
    facts_text(told, "rate", "frame rate", rate);
    facts_text(told, "timecode", "first frame", start->timecode);
    facts_number(told, "range_of_motion_mm", "range of motion", kept->furthest_mm, 2, "mm");
}

static mrt_result export_frames(take_call *call, take_stage *stage, const take_frames *frames,
                                error *err)
{
    recording kept;
    clip_start start;
    const take_name slate =
        take_slate_text(stage->take.scene, stage->take.shot, stage->take.number);
    char title[sizeof slate.text + 8];
    (void)snprintf(title, sizeof title, "take %s", slate.text);
    exports_settings settings = {.title = stage->take.name[0] ? stage->take.name : title};
    double targets = 0.0;
    mrt_result result = take_number(call, TAKE_TOLERANCE, 1e-6, 1e3, &settings.tolerance_mm, err);
    if (result >= 0)
        result = take_number(call, TAKE_MAX_TARGETS, 1, 10000, &targets, err);
    settings.max_targets = (uint32_t)targets;
    if (result < 0)
        return result;
    result = recording_create(&kept, &stage->face.mesh, timecode_fps(frames->rate), NULL, err);
    if (result < 0)
        return result;
    result = take_stage_play(stage, call, frames, keep_frame, &kept, err);
    if (result >= 0) {
        label_first(&start, &stage->take, frames);
        clip_set_start(kept.clip, &start);
        tell_frames(call, stage, &start, frames, &kept);
        result = exports_write(call->exports, call->export_count, kept.clip, &settings,
                               &call->shown, call->told, err);
    }
    recording_destroy(&kept);
    return result;
}

/* ---- sound ---- */

static bool show_part(void *data, double part)
{
    progress_show(data, part, "");
    return true;
}

static mrt_result export_sound(take_call *call, const take *t, const take_frames *frames,
                               const char *path, error *err)
{
    sound_file_report report;
    if (t->audio.audio == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld has no sound: marotte take audio attach SHOW TAKE FILE",
                         (long long)t->id);
    const sound_file_watch watch = {show_part, &call->shown};
    const sound_file_export what = {
        .take = t,
        .from_ns = timecode_time_ns(frames->rate, frames->first),
        .to_ns = timecode_time_ns(frames->rate, frames->first + frames->count)};
    progress_start(&call->shown, "sound");
    mrt_result result = sound_file_write(&report, call->show, &what, path, &watch, err);
    progress_end(&call->shown);
    if (result < 0)
        return result;
    facts_list(call->told, "files", "wrote", path);
    facts_number(call->told, "sound_rate_hz", "sound", report.rate_hz, 0, "Hz");
    facts_number(call->told, "sound_frames", "sound frames", (double)report.frame_count, 0, "");
    if (report.cut_count)
        facts_number(call->told, "sound_cut", "too loud", (double)report.cut_count, 0, "samples");
    if (report.damaged_count)
        fprintf(stderr, "warning: %lld pieces of the sound are damaged: they are silent\n",
                (long long)report.damaged_count);
    return MRT_OK;
}

/* --wav: beside the first export, of its name. */
static char *wav_path(const take_call *call)
{
    if (call->wav)
        return strdup(call->wav);
    if (!call->text[TAKE_WAV] || call->export_count == 0)
        return NULL;
    const char *path = call->exports[0].path, *dot = strrchr(path, '.');
    size_t stem = (size_t)(dot - path);
    char *out = malloc(stem + 5);
    if (out)
        (void)snprintf(out, stem + 5, "%.*s.wav", (int)stem, path);
    return out;
}

/* Of a take that moves nothing there is still its sound. */
static mrt_result export_all(take_call *call, take_stage *stage, const char *wav, error *err)
{
    take_frames frames;
    mrt_result result;
    if (call->export_count == 0) {
        result = take_read(call, call->word[1], &stage->take, err);
        if (result >= 0)
            result = take_frames_of(&frames, call, &stage->take, err);
        return result < 0 ? result : export_sound(call, &stage->take, &frames, wav, err);
    }
    result = take_stage_open(stage, call, call->word[1], call->text[TAKE_FACE], err);
    if (result >= 0)
        result = take_frames_of(&frames, call, &stage->take, err);
    if (result >= 0 && wav && stage->take.audio.audio == 0)
        result = error_set(err, MRT_ERR_ARGUMENT, "take %lld has no sound to export",
                           (long long)stage->take.id);
    if (result >= 0)
        result = export_frames(call, stage, &frames, err);
    if (result >= 0 && wav)
        result = export_sound(call, &stage->take, &frames, wav, err);
    return result;
}

mrt_result take_export_run(take_call *call, error *err)
{
    take_stage stage = {0};
    if (call->export_count == 0 && !call->wav)
        return take_misused(call, err, "--export FILE is missing");
    char *wav = wav_path(call);
    const exports_file sound = {wav, EXPORTS_NONE};
    mrt_result result = exports_check(call->exports, call->export_count, err);
    if (result >= 0 && wav)
        result = exports_check(&sound, 1, err);
    if (result >= 0)
        result = export_all(call, &stage, wav, err);
    take_stage_finish(&stage);
    free(wav);
    return result;
}
