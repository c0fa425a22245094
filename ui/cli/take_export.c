/* marotte take export and marotte take log. */
#include "base/cancel.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/exports.h"
#include "hand/sensor.h"
#include "cli/recording.h"
#include "cli/take.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- take export: frames at an exact frame rate, and sound ---- */

/* ---- the look of videos ---- */

static mrt_result read_look(take_call *call, video_look *out, error *err)
{
    static const take_option options[] = {TAKE_SIZE, TAKE_VIEW, TAKE_BACKGROUND, TAKE_LOOK};
    *out = video_look_default();
    out->is_mirrored = call->text[TAKE_MIRROR] != NULL;
    for (size_t i = 0; i < sizeof options / sizeof options[0]; ++i) {
        const char *name = take_option_name(options[i]), *text = call->text[options[i]];
        const char *possible = text ? video_look_read(out, name, text) : NULL;
        if (possible)
            return take_misused(call, err, "--%s \"%s\" is not %s", name, text, possible);
    }
    error why;
    for (uint32_t i = 0; i < call->export_count; ++i)
        if (call->exports[i].format == EXPORTS_MP4 &&
            video_look_check_mp4(out, call->exports[i].path, &why) < 0)
            return take_misused(call, err, "%s", why.text);
    return MRT_OK;
}

/* ---- frames ---- */

typedef struct frame_sinks { /* destinations of each frame */
    recording measured;
    exports_video *videos;
    char *sound; /* sound of the videos; owned */
    uint64_t frame_count;
} frame_sinks;

static mrt_result keep_frame(void *data, const stage_frame *f, error *err)
{
    frame_sinks *self = data;
    self->frame_count += 1;
    mrt_result result = exports_video_add(self->videos, f->performer->composer, err);
    return result < 0 ? result : recording_add(&self->measured, f->performer, 0, err);
}

static void label_first(clip_start *out, const show *from, const take *t, const take_frames *frames)
{
    *out = (clip_start){.frame = take_label_frame(t, frames->rate, frames->first),
                        .rate_num = frames->rate.num,
                        .rate_den = frames->rate.den,
                        .take = t->id};
    const char *path = show_path(from), *slash = strrchr(path, '/');
    (void)snprintf(out->show, sizeof out->show, "%.*s", (int)sizeof out->show - 1,
                   slash ? slash + 1 : path);
    (void)snprintf(out->slate, sizeof out->slate, "%.*s", (int)sizeof out->slate - 1,
                   take_slate_text(t->scene, t->shot, t->number).text);
    char text[TIMECODE_TEXT];
    timecode_write(text, frames->rate, out->frame);
    (void)snprintf(out->timecode, sizeof out->timecode, "%s", text);
}

static void report_frames(take_call *call, const take_stage *stage, const clip_start *start,
                          const take_frames *frames, const recording *measured)
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
    recording_report_surface(measured, told);
}

static mrt_result read_settings(take_call *call, exports_settings *out, error *err)
{
    double targets = 0.0;
    mrt_result result = take_number(call, TAKE_TOLERANCE, 1e-6, 1e3, &out->tolerance_mm, err);
    if (result >= 0)
        result = take_number(call, TAKE_MAX_TARGETS, 1, 10000, &targets, err);
    out->max_targets = (uint32_t)targets;
    out->is_bare = call->text[TAKE_BARE] != NULL;
    out->is_by_part = call->text[TAKE_BY_PART] != NULL;
    const char *unit = call->text[TAKE_UNIT];
    if (result >= 0 && unit && !mesh_unit_parse(&out->mm_per_unit, unit))
        return take_misused(call, err, "--unit \"%s\" is not mm, cm, m or a number of mm", unit);
    return result;
}

static mrt_result open_videos(take_call *call, frame_sinks *into, const take_stage *stage,
                              const take_frames *frames, const clip_start *start, error *err)
{
    const char *mp4 = exports_video_mp4(into->videos);
    mrt_result result = MRT_OK;
    bool is_share = call->text[TAKE_FRAMES] != NULL; /* AAC cannot be joined without a gap */
    if (mp4 && stage->take.audio.audio != 0 && !is_share)
        result = exports_video_sound(
            &into->sound, call->show, &stage->take, timecode_time_ns(frames->rate, frames->first),
            timecode_time_ns(frames->rate, frames->first + frames->count), mp4, &call->shown, err);
    const video_settings settings = {.mesh = &stage->face.mesh,
                                     .pace = VIDEO_EVERY_FRAME,
                                     .rate = frames->rate,
                                     .timecode = start->timecode,
                                     .sound = into->sound,
                                     .cancel = cancel_flag()};
    return result < 0 ? result : exports_video_open(into->videos, &settings, err);
}

static mrt_result play_frames(take_call *call, take_stage *stage, const take_frames *frames,
                              frame_sinks *into, error *err)
{
    clip_start start;
    label_first(&start, call->show, &stage->take, frames);
    mrt_result result = open_videos(call, into, stage, frames, &start, err);
    if (result >= 0)
        result = take_stage_play(stage, call, frames, keep_frame, into, err);
    if (result < 0)
        return result;
    if (into->measured.clip)
        clip_set_start(into->measured.clip, &start);
    report_frames(call, stage, &start, frames, &into->measured);
    return exports_video_finish(into->videos, call->told, err);
}

/* Describes a performance: its mapping with the parameters at its beginning, its face, its hands.
 * Returns the number of bytes written. */
static size_t describe_performance(char *out, size_t capacity, take_call *call, take_stage *stage,
                                   int64_t id)
{
    show_performance of;
    error ignored;
    size_t used = 0;
    if (show_performance_read(call->show, id, &of, &ignored) < 0)
        return 0; /* damage is reported elsewhere */
    const take_performance *p = &of.performance;
    const mrt_plugin_type *type = NULL;
    char mapping[128];
    (void)snprintf(mapping, sizeof mapping, "%.*s", (int)strcspn(p->mapping, " "), p->mapping);
    if (plugin_list_find(&stage->plugins, mapping, MRT_MAPPING, &type, &ignored) >= 0) {
        double value[TAKE_PARAMS_MAX] = {0};
        for (uint32_t i = 0; i < type->param_count && i < TAKE_PARAMS_MAX; ++i) {
            value[i] = type->params[i].initial;
            for (uint32_t k = 0; k < p->param_count; ++k)
                if (p->param[k].id == type->params[i].id)
                    value[i] = p->param[k].value;
        }
        exports_describe_params(out, capacity, type, value);
        used = strlen(out);
    }
    for (uint32_t i = 0; i < p->track_count && used + 1 < capacity; ++i) {
        show_track from;
        if (show_track_read(call->show, p->track[i], &from, &ignored) < 0)
            continue;
        used += (size_t)snprintf(out + used, capacity - used, "; %s", from.track.device);
        show_track_finish(&from);
    }
    if (used < capacity)
        used += (size_t)snprintf(out + used, capacity - used,
                                 "; on %s; marotte " MAROTTE_VERSION "\n", p->rig);
    show_performance_finish(&of);
    return used < capacity ? used : capacity - 1;
}

/* Writes how to repeat the sheet: the command, and the sources of the take. */
static void describe_making(char *out, size_t capacity, take_call *call, take_stage *stage)
{
    const take *t = &stage->take;
    int64_t told = 0;
    command_line_text(out, capacity - 1);
    size_t used = strlen(out);
    out[used++] = '\n';
    out[used] = '\0';
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count; ++k) {
            int64_t id = t->layer[i].clip[k].performance;
            if (id != told && used + 1 < capacity)
                used += describe_performance(out + used, capacity - used, call, stage, id);
            told = id;
        }
}

static mrt_result export_frames(take_call *call, take_stage *stage, const take_frames *frames,
                                exports_video *videos, error *err)
{
    frame_sinks into = {.videos = videos};
    const take_name slate =
        take_slate_text(stage->take.scene, stage->take.shot, stage->take.number);
    char title[sizeof slate.text + 8];
    (void)snprintf(title, sizeof title, "take %s", slate.text);
    char making[4096];
    describe_making(making, sizeof making, call, stage);
    exports_settings settings = {.title = stage->take.name[0] ? stage->take.name : title,
                                 .made_from = making,
                                 .look = &videos->look};
    mrt_result result = read_settings(call, &settings, err);
    if (result >= 0)
        result = recording_create(&into.measured, &stage->face, timecode_fps(frames->rate),
                                  recording_use_of(call->exports, call->export_count), err);
    if (result >= 0)
        result = play_frames(call, stage, frames, &into, err);
    if (result >= 0)
        result = exports_write(call->exports, call->export_count, into.measured.clip, &settings,
                               &call->shown, call->told, err);
    exports_video_sound_remove(into.sound);
    recording_destroy(&into.measured);
    return result;
}

/* ---- sound ---- */

static mrt_result export_sound(take_call *call, const take *t, const take_frames *frames,
                               const char *path, error *err)
{
    sound_file_report report;
    if (t->audio.audio == 0)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "take %lld has no sound: marotte take audio attach SHOW TAKE FILE",
                         (long long)t->id);
    const sound_file_export what = {
        .take = t,
        .from_ns = timecode_time_ns(frames->rate, frames->first),
        .to_ns = timecode_time_ns(frames->rate, frames->first + frames->count)};
    mrt_result result = exports_sound(path, call->show, &what, &report, &call->shown, err);
    if (result < 0)
        return result;
    facts_file(call->told, path, "");
    facts_number(call->told, "sound_rate_hz", "sound", report.rate_hz, 0, "Hz");
    facts_number(call->told, "sound_frames", "sound frames", (double)report.frame_count, 0, "");
    if (report.cut_count)
        facts_number(call->told, "sound_cut", "too loud", (double)report.cut_count, 0, "samples");
    return MRT_OK;
}

/* --wav: returns the name of the first export, with .wav. */
static char *wav_path(const take_call *call)
{
    if (call->wav)
        return strdup(call->wav);
    if (!call->text[TAKE_WAV] || call->export_count == 0)
        return NULL;
    const char *path = call->exports[0].path;
    size_t stem = strlen(path);
    if (call->exports[0].format == EXPORTS_FOLDER)
        while (stem > 0 && path[stem - 1] == '/')
            --stem;
    else
        stem = (size_t)(strrchr(path, '.') - path);
    char *out = malloc(stem + 5);
    if (out)
        (void)snprintf(out, stem + 5, "%.*s.wav", (int)stem, path);
    return out;
}

/* A take that moves nothing can still have sound. */
static mrt_result export_all(take_call *call, take_stage *stage, exports_video *videos,
                             const char *wav, error *err)
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
        result = video_look_open(&videos->look, call->show, stage->log, err);
    if (result >= 0)
        result = exports_check_face(call->exports, call->export_count, &stage->face.mesh, err);
    if (result >= 0)
        result = take_frames_of(&frames, call, &stage->take, err);
    if (result >= 0)
        result = exports_check_room(call->exports, call->export_count, &stage->face.mesh,
                                    frames.count, err);
    if (result >= 0 && wav && stage->take.audio.audio == 0)
        result = error_set(err, MRT_ERR_ARGUMENT, "take %lld has no sound to export",
                           (long long)stage->take.id);
    cancel_on_signals(CANCEL_WAITS, NULL); /* then incomplete files are removed */
    if (result >= 0)
        result = export_frames(call, stage, &frames, videos, err);
    if (result >= 0 && wav)
        result = export_sound(call, &stage->take, &frames, wav, err);
    return result;
}

mrt_result take_export_run(take_call *call, error *err)
{
    take_stage stage = {0};
    video_look look;
    exports_video videos;
    if (call->export_count == 0 && !call->wav)
        return take_misused(call, err, "--export FILE is missing");
    bool is_all = call->text[TAKE_ALL] != NULL;
    if (is_all != (call->word_count == 1))
        return take_misused(call, err, "give a TAKE, or --all");
    if (call->text[TAKE_JOBS] && !is_all)
        return take_misused(call, err, "--jobs needs --all. Use --frames for parts of one take");
    if (is_all)
        return take_export_all(call, err);
    mrt_result result = read_look(call, &look, err);
    if (result < 0)
        return result;
    char *wav = wav_path(call);
    const exports_file sound = {wav, EXPORTS_NONE};
    result = exports_prepare(&videos, call->exports, call->export_count, &look, err);
    if (result >= 0 && wav)
        result = exports_check(&sound, 1, err);
    if (result >= 0)
        result = export_all(call, &stage, &videos, wav, err);
    exports_video_close(&videos);
    take_stage_finish(&stage);
    free(wav);
    return result;
}

/* ---- take log: the samples of a track as a log table (plugins/log/README.md) ---- */

static const char *const wrist_name[7] = {"x", "y", "z", "qx", "qy", "qz", "qw"};

/* ---- the track and its span ---- */

typedef struct log_span {
    int64_t track, from_ns, to_ns;
} log_span;

/* Adds the tracks behind a clip to the list, each with the span that is shown. */
static mrt_result add_performance(take_call *call, const take_clip *c, log_span *list,
                                  uint32_t *count, error *err)
{
    show_performance of;
    mrt_result result = show_performance_read(call->show, c->performance, &of, err);
    for (uint32_t i = 0; result >= 0 && i < of.performance.track_count; ++i) {
        uint32_t k = 0;
        while (k < *count && list[k].track != of.performance.track[i])
            ++k;
        if (k == *count && k < TAKE_TRACKS_MAX * 8)
            list[(*count)++] = (log_span){of.performance.track[i], c->from_ns, c->to_ns};
        else if (k < *count && c->from_ns < list[k].from_ns)
            list[k].from_ns = c->from_ns;
        if (k < *count && c->to_ns > list[k].to_ns)
            list[k].to_ns = c->to_ns;
    }
    if (result >= 0)
        show_performance_finish(&of);
    return result;
}

static mrt_result choose(take_call *call, const take *t, log_span *out, error *err)
{
    log_span list[TAKE_TRACKS_MAX * 8];
    uint32_t count = 0;
    double wanted = 0.0;
    mrt_result result = take_number(call, TAKE_TRACK, 1, 1e15, &wanted, err);
    for (uint32_t i = 0; i < t->layer_count && result >= 0; ++i)
        for (uint32_t k = 0; k < t->layer[i].clip_count && result >= 0; ++k)
            result = add_performance(call, &t->layer[i].clip[k], list, &count, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < count; ++i)
        if (list[i].track == (int64_t)wanted || (count == 1 && !call->text[TAKE_TRACK])) {
            *out = list[i];
            return MRT_OK;
        }
    if (count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld is empty: it has no track",
                         (long long)t->id);
    if (!call->text[TAKE_TRACK])
        return take_misused(call, err, "take %lld has %u tracks. Choose one with --track N",
                            (long long)t->id, count);
    return error_set(err, MRT_ERR_ARGUMENT, "take %lld has no track %lld (marotte take show)",
                     (long long)t->id, (long long)wanted);
}

/* ---- the table ---- */

/* Returns whether a log can have a column with this name. */
static bool is_column(const char *name)
{
    return name[0] != '\0' && strlen(name) < 40 &&
           text_is_printable(text_view_of(name, strlen(name))) && !strpbrk(name, ",\"#") &&
           name[0] != ' ' && name[strlen(name) - 1] != ' ';
}

static void write_column(FILE *stream, const take_channel *c, uint32_t i)
{
    const char *side = c->hand == MRT_LEFT ? "left" : "right";
    if (c->semantic >= MRT_CH_PEDAL && c->semantic < MRT_CH_PEDAL + MRT_MAX_PEDALS)
        fprintf(stream, ",pedal.%u", c->semantic - MRT_CH_PEDAL + 1);
    else if (c->hand <= MRT_RIGHT && c->semantic >= MRT_CH_ANGLE &&
             c->semantic < MRT_CH_ANGLE + MRT_ANGLES)
        fprintf(stream, ",%s.%s", side, sensor_table[c->semantic - MRT_CH_ANGLE].name);
    else if (c->hand <= MRT_RIGHT && c->semantic >= MRT_CH_WRIST && c->semantic < MRT_CH_WRIST + 7)
        fprintf(stream, ",%s.wrist.%s", side, wrist_name[c->semantic - MRT_CH_WRIST]);
    else if (is_column(c->name))
        fprintf(stream, ",%s", c->name);
    else
        fprintf(stream, ",channel.%u", i + 1);
}

/* Returns whether the input `log` reads angles in this unit. */
static bool is_log_unit(const char *unit)
{
    return strcmp(unit, "count") == 0 || strcmp(unit, MRT_UNIT_LANDMARKS) == 0;
}

/* A channel that is known only by its name has a range instead of a unit. */
static void write_unit(FILE *stream, const take_channel *c)
{
    if (c->semantic >= MRT_CH_ANGLE && c->semantic < MRT_CH_ANGLE + MRT_ANGLES)
        fprintf(stream, ",%s", is_log_unit(c->unit) ? c->unit : "rad");
    else if (c->semantic == MRT_CH_OTHER && c->min < c->max)
        fprintf(stream, ",%.9g..%.9g", (double)c->min, (double)c->max);
    else
        fputc(',', stream);
}

static void write_head(FILE *stream, const show_track *of)
{
    fputs("# a track of a marotte take, as it was measured\ntime_ns", stream);
    for (uint32_t i = 0; i < of->track.channel_count; ++i)
        write_column(stream, &of->track.channel[i], i);
    fputs("\nunit", stream);
    for (uint32_t i = 0; i < of->track.channel_count; ++i)
        write_unit(stream, &of->track.channel[i]);
    fputc('\n', stream);
}

static mrt_result write_samples(FILE *stream, show_reader *reader, const log_span *span,
                                uint64_t *out_count, error *err)
{
    mrt_sample sample;
    mrt_result result;
    while ((result = show_reader_next(reader, &sample, err)) != MRT_END) {
        if (result == MRT_ERR_FORMAT) {
            fprintf(stderr, "warning: %s\n", err->text);
            continue;
        }
        if (result < 0)
            return result;
        fprintf(stream, "%lld", (long long)(sample.time_ns - span->from_ns));
        for (uint32_t i = 0; i < sample.count; ++i)
            fprintf(stream, ",%.9g", (double)sample.value[i]);
        fputc('\n', stream);
        *out_count += 1;
    }
    return MRT_OK;
}

static mrt_result write_table(take_call *call, const log_span *span, const char *path, error *err)
{
    show_track of;
    show_reader *reader = NULL;
    file_writer file;
    uint64_t count = 0;
    mrt_result result = show_track_read(call->show, span->track, &of, err);
    if (result < 0)
        return result;
    result = show_reader_open(&reader, call->show, span->track, span->from_ns, span->to_ns, err);
    if (result >= 0)
        result = file_writer_open(&file, path, err);
    if (result >= 0) {
        write_head(file.stream, &of);
        result = write_samples(file.stream, reader, span, &count, err);
        if (result >= 0)
            result = file_writer_commit(&file, err);
        else
            file_writer_abandon(&file);
    }
    show_reader_close(reader);
    if (result >= 0) {
        facts_number(call->told, "track", "track", (double)span->track, 0, "");
        facts_text(call->told, "device", "device", of.track.device);
        facts_number(call->told, "channels", "channels", of.track.channel_count, 0, "");
        facts_number(call->told, "samples", "samples", (double)count, 0, "");
        facts_file(call->told, path, "");
    }
    show_track_finish(&of);
    return result;
}

mrt_result take_log_run(take_call *call, error *err)
{
    take t;
    log_span span = {0, 0, 0};
    mrt_result result = take_need(call, TAKE_OUT, err);
    if (result >= 0)
        result = take_read(call, call->word[1], &t, err);
    if (result < 0)
        return result;
    const exports_file table = {call->text[TAKE_OUT], EXPORTS_NONE};
    result = exports_check(&table, 1, err);
    if (result >= 0)
        result = choose(call, &t, &span, err);
    if (result >= 0)
        result = write_table(call, &span, call->text[TAKE_OUT], err);
    take_finish(&t);
    return result;
}
