/* marotte perform: hands, or a table of curves, perform a face without a window. */
#include "base/cancel.h"
#include "base/clock.h"
#include "base/file.h"
#include "base/program.h"
#include "cli/command.h"
#include "cli/exports.h"
#include "io/curves.h"
#include "io/mesh_file.h"
#include "cli/perform_session.h"
#include "cli/recording.h"
#include "stage/mapping/taught.h"
#include "stage/perform/patch_file.h"
#include "stage/sound/sound.h"
#include "stage/playback/kept_solver.h"
#include "show/edit_store.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the command line ---- */

typedef struct perform_options {
    char *face;       /* owned path */
    mesh_frame frame; /* frame of a mesh file without a rig: --unit, --up, --forward */
    plugin_spec input[PERFORM_INPUTS_MAX];
    const char *input_text[PERFORM_INPUTS_MAX]; /* as typed */
    uint32_t input_count;
    plugin_spec map;
    const char *output[PERFORM_OUTPUTS_MAX]; /* receivers of the face; then the performance is in
                                                real time */
    uint32_t output_count;
    const char *curves; /* table to perform instead of hands; NULL: none */
    exports_file exports[EXPORTS_MAX];
    uint32_t export_count;
    video_look look; /* look of the videos among the exports */
    double fps, seconds, tolerance_mm, hand_length_mm;
    const char *calibration[PERFORM_CALIBRATIONS_MAX]; /* paths, or one "none" */
    uint32_t calibration_count, rezero_pedal;
    uint32_t max_targets;
    bool is_bare;    /* glTF exports contain only the mesh */
    bool is_by_part; /* exports_settings */
    double export_mm_per_unit;
    const char *patch;        /* path; NULL: none */
    const char *life;         /* parameters of life_input.h; NULL: off */
    const char *record;       /* path of the show; NULL: not recorded */
    const char *scene, *shot; /* slate of the take; "" if not given */
    bool has_sound;           /* record the microphone */
    isolate_which isolation;
    bool watches_plugins, is_realtime, is_json, is_verbose;
} perform_options;

static void finish_options(perform_options *options)
{
    for (uint32_t i = 0; i < options->input_count; ++i)
        plugin_spec_finish(&options->input[i]);
    plugin_spec_finish(&options->map);
    free(options->face);
}

static int read_name(void *to, const command *self, const char *name, const char *text)
{
    *(const char **)to = text;
    if (strlen(text) < TAKE_NAME)
        return COMMAND_DONE;
    return command_usage(self, "--%s is longer than %d bytes", name, TAKE_NAME - 1);
}

static int add_export(void *to, const command *self, const char *name, const char *path)
{
    perform_options *out = to;
    if (out->export_count == EXPORTS_MAX)
        return command_usage(self, "--export is given more than %d times", EXPORTS_MAX);
    exports_file file = {path, exports_format_of(path)};
    if (file.format == EXPORTS_NONE)
        return command_usage(self, "--%s %s: the name must end in %s", name, path, exports_names);
    out->exports[out->export_count++] = file;
    return COMMAND_DONE;
}

static int add_input(void *to, const command *self, const char *name, const char *text)
{
    perform_options *out = to;
    if (out->input_count == PERFORM_INPUTS_MAX)
        return command_usage(self, "--input is given more than %d times", PERFORM_INPUTS_MAX);
    out->input_text[out->input_count] = text;
    return command_read_spec(&out->input[out->input_count++], self, name, text);
}

static int add_output(void *to, const command *self, const char *name, const char *text)
{
    perform_options *out = to;
    (void)name;
    if (out->output_count == PERFORM_OUTPUTS_MAX)
        return command_usage(self, "--output is given more than %d times", PERFORM_OUTPUTS_MAX);
    out->output[out->output_count++] = text;
    return COMMAND_DONE;
}

static int set_map(void *to, const command *self, const char *name, const char *text)
{
    plugin_spec *map = to;
    if (map->plugin)
        return command_usage(self, "--map is given twice");
    if (!plugin_spec_read(map, text) || map->address[0])
        return command_usage(self, "--%s \"%s\" is not PLUGIN[,key=value]", name, text);
    return COMMAND_DONE;
}

static int add_calibration(void *to, const command *self, const char *name, const char *path)
{
    perform_options *out = to;
    (void)name;
    if (out->calibration_count == PERFORM_CALIBRATIONS_MAX)
        return command_usage(self, "--calibration is given more than %d times: one per hand",
                             PERFORM_CALIBRATIONS_MAX);
    out->calibration[out->calibration_count++] = path;
    return COMMAND_DONE;
}

static int read_isolation(void *to, const command *self, const char *name, const char *text)
{
    static const char *const names[] = {
        [ISOLATE_FOREIGN] = "auto", [ISOLATE_ALL] = "on", [ISOLATE_NONE] = "off"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        if (strcmp(names[i], text) != 0)
            continue;
        *(isolate_which *)to = (isolate_which)i;
        return COMMAND_DONE;
    }
    return command_usage(self, "--%s \"%s\" is not auto, on or off", name, text);
}

/* "on", "off", or parameters. */
static int read_life(void *to, const command *self, const char *name, const char *text)
{
    (void)self, (void)name;
    *(const char **)to = strcmp(text, "off") == 0 ? NULL : strcmp(text, "on") == 0 ? "" : text;
    return COMMAND_DONE;
}

#define AT(member) .offset = offsetof(perform_options, member)
static const command_option option_table[] = {
    {"face", COMMAND_READ, AT(face), .read = command_read_face},
    {"unit", COMMAND_READ, AT(frame.mm_per_unit), .read = command_read_unit},
    {"up", COMMAND_READ, AT(frame.up), .read = command_read_axis},
    {"forward", COMMAND_READ, AT(frame.forward), .read = command_read_axis},
    {"input", COMMAND_READ, .read = add_input},
    {"map", COMMAND_READ, AT(map), .read = set_map},
    {"output", COMMAND_READ, .read = add_output},
    {"curves", COMMAND_TEXT, AT(curves)},
    {"export", COMMAND_READ, .read = add_export},
    {"fps", COMMAND_NUMBER, AT(fps), .least = 1, .most = 1000},
    {"seconds", COMMAND_NUMBER, AT(seconds), .least = 0.001, .most = 1e6},
    {"size", COMMAND_READ, AT(look), .read = command_read_look},
    {"view", COMMAND_READ, AT(look), .read = command_read_look},
    {"mirror", COMMAND_FLAG, AT(look.is_mirrored)},
    {"background", COMMAND_READ, AT(look), .read = command_read_look},
    {"look", COMMAND_READ, AT(look), .read = command_read_look},
    {"tolerance", COMMAND_NUMBER, AT(tolerance_mm), .least = 1e-6, .most = 1e3},
    {"max-targets", COMMAND_WHOLE, AT(max_targets), .least = 1, .most = 10000},
    {"bare", COMMAND_FLAG, AT(is_bare)},
    {"export-unit", COMMAND_READ, AT(export_mm_per_unit), .read = command_read_unit},
    {"by-part", COMMAND_FLAG, AT(is_by_part)},
    {"hand-length", COMMAND_NUMBER, AT(hand_length_mm), .least = 50, .most = 400},
    {"calibration", COMMAND_READ, .read = add_calibration},
    {"rezero-pedal", COMMAND_WHOLE, AT(rezero_pedal), .least = 1, .most = MRT_MAX_PEDALS},
    {"patch", COMMAND_TEXT, AT(patch)},
    {"life", COMMAND_READ, AT(life), .read = read_life},
    {"record", COMMAND_TEXT, AT(record)},
    {"scene", COMMAND_READ, AT(scene), .read = read_name},
    {"shot", COMMAND_READ, AT(shot), .read = read_name},
    {"sound", COMMAND_FLAG, AT(has_sound)},
    {"isolate", COMMAND_READ, AT(isolation), .read = read_isolation},
    {"watch-plugins", COMMAND_FLAG, AT(watches_plugins)},
    {"realtime", COMMAND_FLAG, AT(is_realtime)},
    {"json", COMMAND_FLAG, AT(is_json)},
    {"verbose", COMMAND_FLAG, AT(is_verbose)},
    {.name = NULL},
};

/* Checks that each .mp4 can be made with this look. */
static int check_look(const perform_options *out, const command *self)
{
    error err;
    for (uint32_t i = 0; i < out->export_count; ++i)
        if (out->exports[i].format == EXPORTS_MP4 &&
            video_look_check_mp4(&out->look, out->exports[i].path, &err) < 0)
            return command_usage(self, "%s", err.text);
    return COMMAND_DONE;
}

/* Returns COMMAND_DONE, or reports the mistake and returns COMMAND_USAGE. */
static int read_options(perform_options *out, int argc, char **argv)
{
    *out = (perform_options){.scene = "", .shot = "", .look = video_look_default()};
    const command *self = &command_perform;
    int code = command_options(out, self, option_table, argc, argv);
    if (code == COMMAND_DONE && !out->face)
        code = command_usage(self, "--face is missing");
    if (code == COMMAND_DONE && out->curves &&
        (out->input_count > 0 || out->map.plugin || out->record || out->is_realtime ||
         out->output_count > 0 || out->life))
        code = command_usage(self, "--curves cannot be combined with --input, --map, --record, "
                                   "--realtime, --output or --life");
    const bool is_life_alone = out->life && out->input_count == 0;
    if (code == COMMAND_DONE && out->input_count == 0 && !out->curves && !out->life)
        code = command_usage(self, "--input is missing");
    if (code == COMMAND_DONE && !out->map.plugin && !out->curves && !is_life_alone)
        code = command_usage(self, "--map is missing");
    if (code == COMMAND_DONE && is_life_alone && !(out->seconds > 0.0))
        code = command_usage(self, "--life without --input has no end: add --seconds N");
    if (code == COMMAND_DONE && !out->curves && !(out->fps > 0.0))
        out->fps = 30.0;
    if (code == COMMAND_DONE && out->record && (out->frame.up || out->frame.forward))
        code =
            command_usage(self, "a show cannot store --up and --forward. Draft a rig and perform "
                                "with it: marotte rig new MESH --up AXIS --forward AXIS");
    if (code == COMMAND_DONE && out->has_sound && !out->record)
        code = command_usage(self, "--sound needs --record SHOW");
    if (code == COMMAND_DONE)
        code = check_look(out, self);
    if (code != COMMAND_DONE)
        finish_options(out);
    return code;
}

/* ---- a performance ---- */

typedef struct take_recording { /* --record; zeroed: not recorded */
    show *show;
    recorder *recorder;
    sound *sound;         /* microphone; NULL: none */
    char sound_told[256]; /* the last warning that was printed */
    char *calibration[2];
    int64_t take;
    bool is_waiting_told; /* reported that the disk is not writable now */
} take_recording;

/* All parts of a performance, created in this order and destroyed in reverse. */
typedef struct performance {
    const perform_options *options;
    log_queue *log;
    plugin_list plugins;
    face_file face;
    perform_inputs inputs;
    const char *input_text[PERFORM_INPUTS_MAX];
    double duration_s; /* of the whole performance; 0: unknown */
    perform_hands hands;
    perform_mapping mapping;
    patch patch;
    performer *performer;
    stage_frame frame;
    perform_outputs outputs;
    uint32_t mark_count; /* number of presses so far */
    recording recording;
    take_recording record;
    exports_video videos;
    player_report report;
    progress progress;
} performance;

/* ---- the microphone: what it records becomes the sound of the take. If it is missing or fails,
 * the performance continues ---- */

static const int64_t patience_ns = 3 * NS_PER_S;

/* Arms the microphone. */
static mrt_result start_sound(take_recording *self, error *err)
{
    const sound_settings settings = {.show = self->show};
    mrt_result result = sound_create(&self->sound, &settings, err);
    return result < 0 ? result : sound_arm(self->sound, recorder_writer(self->recorder), 0, err);
}

static void warn(take_recording *self, const char *text)
{
    if (!text[0] || strcmp(self->sound_told, text) == 0)
        return;
    snprintf(self->sound_told, sizeof self->sound_told, "%s", text);
    fprintf(stderr, "warning: %s; the hands are still recorded\n", text);
}

static void update_sound(take_recording *self)
{
    sound_in_status status;
    if (!self->sound)
        return;
    sound_update(self->sound);
    sound_in_read_status(self->sound, &status);
    warn(self, status.device.text);
    warn(self, status.record.text);
}

/* Stops the microphone, and waits until the writer has all of its sound. */
static void stop_sound(take_recording *self)
{
    if (!self->sound)
        return;
    int64_t until_ns = clock_now_ns() + patience_ns;
    sound_disarm(self->sound);
    while (sound_is_armed(self->sound) && clock_now_ns() < until_ns) {
        sound_update(self->sound);
        clock_sleep_until_ns(clock_now_ns() + 10 * NS_PER_MS);
    }
}

/* Attaches the recorded sound to the take. The writer has been flushed or stopped. */
static mrt_result attach_sound(take_recording *self, facts *told, error *err)
{
    sound_in_status status;
    show_audio audio;
    if (!self->sound)
        return MRT_OK;
    sound_in_read_status(self->sound, &status);
    if (status.record.audio == 0) {
        facts_text(told, "sound", "sound", "none");
        return MRT_OK;
    }
    mrt_result result = show_audio_info(self->show, status.record.audio, &audio, err);
    if (result >= 0)
        result = edit_store_attach_audio(self->show, self->take, &audio, clock_utc_ms, err);
    if (result < 0)
        return result;
    facts_text(told, "sound", "sound", audio.name);
    facts_number(told, "sound_s", "  length", (double)audio.frame_count / (double)audio.rate_hz, 2,
                 "s");
    facts_number(told, "sound_drift_ppm", "  drift", status.record.drift_ppm, 1,
                 "ppm of its clock, compared with that of the samples");
    if (status.record.gap_count)
        facts_warning(told, "sound_gaps", "gaps in the sound", status.record.gap_count, 0, "");
    return MRT_OK;
}

/* ---- recording into a show ---- */

/* Opens the show that already exists, for its settings. Returns NULL if nothing is recorded, or if
 * the show is new or unreadable; start_recording reports that. */
static show *open_earlier_show(const perform_options *options)
{
    show *out = NULL;
    error ignored = {""};
    if (options->record && access(options->record, F_OK) == 0 &&
        show_open(&out, options->record, SHOW_READ, &ignored) < 0)
        return NULL;
    return out;
}

/* Returns the solver settings of the show that is recorded into, so that the take later shows the
 * same face. */
static csrbf_settings choose_solver(const performance *self)
{
    show *earlier = open_earlier_show(self->options);
    const csrbf_settings out = kept_solver_for(earlier, &self->face, self->log);
    show_close(earlier);
    return out;
}

static mrt_result open_show(take_recording *out, const char *path, error *err)
{
    const bool is_there = access(path, F_OK) == 0;
    mrt_result result = is_there ? MRT_OK : file_make_parent(path, err);
    if (result >= 0)
        result = is_there ? show_open(&out->show, path, SHOW_RECORD, err)
                          : show_create(&out->show, path, err);
    if (result < 0 || show_is_writable(out->show))
        return result;
    return error_set(err, MRT_ERR_IO, "%s", show_notice(out->show));
}

/* Opens or creates the show. The take begins with the first sample. Does nothing without
 * --record. */
static mrt_result start_recording(performance *self, error *err)
{
    const perform_options *options = self->options;
    take_recording *out = &self->record;
    mrt_result result = MRT_OK;
    if (!options->record)
        return MRT_OK;
    for (int side = 0; side < 2 && result >= 0; ++side)
        if (self->hands.path[side])
            result = perform_hands_text(out->calibration, self->hands.path[side], err);
    if (result >= 0)
        result = open_show(out, options->record, err);
    if (result < 0)
        return result;
    taught_restore(out->show, self->performer->voice[0].layer->mapping, self->log);
    const recorder_settings settings = {
        .show = out->show,
        .plugins = &self->plugins,
        .log = self->log,
        .clock = self->inputs.clock,
        .inputs = self->inputs.input,
        .input_text = self->input_text,
        .input_count = self->inputs.count,
        .calibration = {out->calibration[MRT_LEFT], out->calibration[MRT_RIGHT]},
        .layer = self->performer->voice[0].layer,
        .performer = self->performer,
        .face_path = options->face,
        .face = &self->face,
        .unit_mm = options->frame.mm_per_unit,
        .hand_length_mm = options->hand_length_mm,
        .rezero_pedal = options->rezero_pedal,
        .patch = options->patch ? &self->patch : NULL,
    };
    result = recorder_start(&out->recorder, &settings, err);
    if (result < 0)
        return result;
    const writer_slate slate = {.scene = options->scene, .shot = options->shot};
    recorder_take_next(out->recorder, &slate, 0);
    if (!options->has_sound)
        return MRT_OK;
    if (self->inputs.clock == CLOCK_VIRTUAL)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "--sound needs --realtime: recordings play faster than real time");
    return start_sound(out, err);
}

/* Reports problems of the recording: the disk is full, the file was deleted. Called repeatedly. */
static void watch_recording(take_recording *self)
{
    if (!self->recorder)
        return;
    update_sound(self);
    perform_record_watch_writer(recorder_writer(self->recorder), &self->is_waiting_told);
}

/* Ends the take, and waits until everything is written. */
static mrt_result end_recording(performance *of, facts *told, error *err)
{
    take_recording *self = &of->record;
    char name[32];
    if (!self->recorder)
        return MRT_OK;
    stop_sound(self);
    mrt_result result = recorder_take_end(self->recorder, err);
    self->take = recorder_take(self->recorder);
    if (result >= 0 && recorder_problem(self->recorder)[0])
        result = error_set(err, MRT_ERR_IO, "%s", recorder_problem(self->recorder));
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    if (result >= 0)
        result = attach_sound(self, told, err);
    if (result >= 0 && self->take)
        result = edit_store_add_marks(self->show, self->take, clock_utc_ms, err);
    taught_keep_now(self->show, of->performer->voice[0].layer->mapping, of->log);
    writer_status status = writer_status_of(recorder_writer(self->recorder));
    error later = {""};
    mrt_result stopped = recorder_stop(self->recorder, &later);
    self->recorder = NULL;
    if (stopped < 0) /* this error explains more than the earlier one */
        result = error_set(err, stopped, "%s", later.text);
    if (result < 0)
        return result;
    snprintf(name, sizeof name, "%jd", (intmax_t)self->take);
    facts_text(told, "show", "show", show_path(self->show));
    facts_text(told, "take", "take", name);
    facts_number(told, "samples_recorded", "samples recorded", (double)status.committed_count, 0,
                 "");
    if (status.lost_count)
        facts_warning(told, "samples_not_recorded", "not recorded", (double)status.lost_count, 0,
                      "samples");
    return MRT_OK;
}

static mrt_result finish_recording(take_recording *self, mrt_result so_far, error *err)
{
    error ignored = {""};
    sound_destroy(self->sound);
    if (self->recorder && recorder_stop(self->recorder, &ignored) < 0)
        fprintf(stderr, "warning: %s\n", ignored.text);
    const mrt_result result = perform_record_rescue(self->show, so_far, err);
    show_close(self->show);
    free(self->calibration[MRT_LEFT]);
    free(self->calibration[MRT_RIGHT]);
    return result;
}

/* ---- preparation ---- */

/* Uses the scene of the show that is recorded into, unless another look was chosen. */
static mrt_result open_look(performance *self, error *err)
{
    if (self->options->export_count == 0)
        return MRT_OK;
    show *earlier = open_earlier_show(self->options);
    mrt_result result = video_look_open(&self->videos.look, earlier, self->log, err);
    show_close(earlier);
    return result;
}

static mrt_result open_videos(performance *self, error *err)
{
    video_settings settings = {.mesh = &self->face.mesh,
                               .pace = self->inputs.clock == CLOCK_REAL ? VIDEO_LIVE
                                                                        : VIDEO_EVERY_FRAME,
                               .timecode = ""};
    mrt_result result = timecode_rate_of(&settings.rate, self->options->fps, err);
    return result < 0 ? result : exports_video_open(&self->videos, &settings, err);
}

/* Life ends with the hands. */
static mrt_result open_life(performance *self, error *err)
{
    const perform_options *options = self->options;
    memcpy(self->input_text, options->input_text, sizeof self->input_text);
    if (!options->life)
        return MRT_OK;
    self->input_text[self->inputs.count % PERFORM_INPUTS_MAX] = "life";
    return perform_inputs_add_life(&self->inputs, options->life,
                                   perform_inputs_duration_s(&self->inputs),
                                   composer_mapped(self->performer->composer), self->log, err);
}

static mrt_result prepare(performance *self, error *err)
{
    const perform_options *options = self->options;
    mrt_result result = exports_prepare(&self->videos, options->exports, options->export_count,
                                        &options->look, err);
    if (result < 0)
        return result;
    self->log = log_queue_create();
    if (!self->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    result = plugin_list_load(&self->plugins, err);
    if (result >= 0)
        result = face_file_read(&self->face, options->face, &options->frame, FACE_FILE_USABLE, err);
    if (result >= 0)
        result = exports_check_face(options->exports, options->export_count, &self->face.mesh, err);
    if (result < 0)
        return result;
    news_print_notes(self->face.note);
    const bool is_real = options->is_realtime || options->output_count > 0;
    result =
        perform_inputs_open(&self->inputs, options->input, options->input_count, &self->plugins,
                            self->log, is_real ? CLOCK_REAL : CLOCK_VIRTUAL, err);
    const perform_mapping_settings apart = {&self->plugins, self->log, self->inputs.clock,
                                            options->isolation};
    if (result >= 0)
        result = perform_mapping_open(&self->mapping, &options->map, &apart, err);
    if (result >= 0)
        result = perform_hands_choose(&self->hands, options->calibration,
                                      options->calibration_count, &self->inputs, err);
    if (result >= 0 && options->patch)
        result = patch_file_find(&self->patch, options->patch, err);
    performer_settings settings = {
        .solver = choose_solver(self),
        .hand_length_mm = options->hand_length_mm,
        .side_length_mm = {self->hands.length_mm[0], self->hands.length_mm[1]},
        .rezero_pedal = options->rezero_pedal,
        .patch = options->patch ? &self->patch : NULL};
    if (result >= 0)
        result = performer_create(&self->performer, &self->face, &self->mapping.instance, &settings,
                                  err);
    if (result >= 0)
        perform_patch_report(self->performer->voice[0].layer);
    if (result >= 0)
        result = open_life(self, err);
    if (result >= 0 && options->watches_plugins)
        result = perform_mapping_watch(&self->mapping, self->performer, self->log, err);
    if (result >= 0)
        result = perform_outputs_open(&self->outputs, options->output, options->output_count,
                                      &apart, self->performer->composer, &self->face, err);
    if (result >= 0)
        result = recording_create(&self->recording, &self->face, options->fps,
                                  recording_use_of(options->exports, options->export_count), err);
    if (result >= 0)
        result = open_look(self, err);
    if (result >= 0)
        result = open_videos(self, err);
    return result < 0 ? result : start_recording(self, err);
}

static mrt_result finish(performance *self, mrt_result so_far, error *err)
{
    exports_video_close(&self->videos);
    perform_outputs_close(&self->outputs);
    const mrt_result result = finish_recording(&self->record, so_far, err);
    recording_destroy(&self->recording);
    performer_destroy(self->performer);
    perform_mapping_close(&self->mapping);
    perform_hands_finish(&self->hands);
    perform_inputs_close(&self->inputs);
    face_file_destroy(&self->face);
    plugin_list_destroy(&self->plugins);
    news_print(self->log);
    log_queue_destroy(self->log);
    return result;
}

/* Checks the pulls of the plugin. On stage an invalid pull is replaced by the last valid one; an
 * offline performance fails. */
static mrt_result check_pulls(const performance *self, error *err)
{
    const composer_counts *counts = self->performer->counts;
    if (counts->bad_pulls == 0 || self->inputs.clock == CLOCK_REAL)
        return perform_mapping_check(&self->mapping, err);
    return error_set(err, MRT_ERR_FORMAT, "%s (sample %ju)", counts->first_problem.text,
                     (uintmax_t)counts->samples);
}

static mrt_result on_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    (void)index;
    performance *self = data;
    news_print(self->log);
    watch_recording(&self->record);
    uint32_t rezeroed = perform_hands_keys(self->performer, cancel_flag(), &self->progress);
    for (uint32_t side = MRT_LEFT; side <= MRT_RIGHT && self->record.recorder; ++side)
        if (rezeroed & (1u << side))
            recorder_rezero(self->record.recorder, side);
    progress_show_time(&self->progress, time_s, self->duration_s);
    mrt_result result = check_pulls(self, err);
    if (result >= 0)
        result = exports_video_add(&self->videos, self->performer->composer, err);
    if (result < 0)
        return result;
    return recording_add(&self->recording, self->performer, work_ns, err);
}

/* Performs the actions that a patch triggers. --record decides about recording. */
static void apply_patch_actions(performance *self, int64_t time_ns)
{
    const patch_bay *bay = &self->performer->voice[0].layer->bay;
    if (bay->pressed[PATCH_STOP] > 0)
        atomic_store(cancel_flag(), true);
    if (bay->pressed[PATCH_MARK] == self->mark_count)
        return;
    self->mark_count = bay->pressed[PATCH_MARK];
    error err = {""};
    if (self->record.recorder &&
        writer_mark(recorder_writer(self->record.recorder), time_ns, "mark", &err) < 0)
        log_push(self->log, MRT_LOG_WARNING, "patch", err.text);
}

/* The sinks of the frame. */
static mrt_result record_step(void *data, stage_frame *f, error *err)
{
    (void)err;
    performance *self = data;
    life_watch(&f->step, &self->performer->voice[0].layer->life.body,
               composer_watched(self->performer->composer));
    perform_mapping_step(&self->mapping, self->performer, self->record.recorder);
    if (self->record.recorder)
        recorder_step(self->record.recorder, &f->step);
    return MRT_OK;
}

static void note_step(void *data, const stage_frame *f)
{
    performance *self = data;
    if (self->record.recorder)
        recorder_performed(self->record.recorder, &f->step);
    perform_outputs_step(&self->outputs, self->performer, f->step.time_ns);
    apply_patch_actions(self, f->step.time_ns);
}

static mrt_result publish_face(void *data, const stage_frame *f, error *err)
{
    (void)f, (void)err;
    performance *self = data;
    perform_outputs_frame(&self->outputs, self->performer);
    return MRT_OK;
}

static void on_incident(void *data, const input *from, const input_incident *what, double time_s)
{
    performance *self = data;
    progress_end(&self->progress);
    news_print(self->log);
    perform_inputs_incident(&self->inputs, self->record.recorder, from, what, time_s);
}

static mrt_result perform(performance *self, error *err)
{
    player_settings settings = {
        .fps = self->options->fps,
        .seconds = self->options->seconds,
        .clock = self->inputs.clock,
        .stop = cancel_flag(),
        .calibration = {perform_hands_calibration(&self->hands, MRT_LEFT),
                        perform_hands_calibration(&self->hands, MRT_RIGHT)}};
    player_events events = {.frame = on_frame, .incident = on_incident, .data = self};
    self->frame = (stage_frame){.performer = self->performer,
                                .self = self,
                                .record = record_step,
                                .performed = note_step,
                                .publish = publish_face};
    if (self->inputs.clock == CLOCK_REAL && keys_begin())
        fprintf(stderr, "note: keys: z makes the current pose the neutral pose, q ends\n");
    const double recorded_s = perform_inputs_duration_s(&self->inputs);
    self->duration_s = self->options->seconds;
    if (recorded_s > 0.0 && (self->duration_s <= 0.0 || recorded_s < self->duration_s))
        self->duration_s = recorded_s;
    progress_start(&self->progress, "performing");
    mrt_result result = player_run_stage(&self->frame, self->inputs.input, self->inputs.count,
                                         &settings, &events, &self->report, err);
    keys_end();
    progress_end(&self->progress);
    news_print(self->log);
    if (result >= 0)
        result = check_pulls(self, err);
    if (result >= 0 && self->report.sample_count == 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: the input has no samples",
                           input_name(self->inputs.input[0]));
    return result;
}

static void report_pulls(const performance *self, facts *told)
{
    const composer_counts *counts = self->performer->counts;
    if (counts->limited_steps)
        facts_number(told, "limited_steps", "limited steps", (double)counts->limited_steps, 0,
                     "samples in which the hand was faster than the surface can follow");
    if (counts->held_pulls)
        facts_warning(told, "held_pulls", "held pulls", (double)counts->held_pulls, 0,
                      counts->first_problem.text);
    if (counts->bad_pulls)
        facts_warning(told, "bad_pulls", "bad pulls", (double)counts->bad_pulls, 0,
                      counts->first_problem.text);
}

static void report_devices(const performance *self, facts *told)
{
    const player_report *report = &self->report;
    if (report->went_count == 0)
        return;
    facts_warning(told, "went_away", "went away", report->went_count, 0, "times");
    facts_number(told, "came_back", "came back", report->returned_count, 0, "times");
    facts_number(told, "away_s", "away", report->away_s, 2, "s, of those that came back");
    for (uint32_t i = 0; i < self->inputs.count; ++i)
        if (input_state_of(self->inputs.input[i]) == INPUT_LOST)
            facts_warning_list(told, "still_away", "still away", input_name(self->inputs.input[i]));
}

/* Writes the title of the picture: "moai.rig.json: log demo_hand.csv + cyberglove, anchored". */
static void name_performance(const performance *self, char *out, size_t capacity)
{
    const char *slash = strrchr(self->options->face, '/');
    int used = snprintf(out, capacity, "%s: ", slash ? slash + 1 : self->options->face);
    for (uint32_t i = 0; i < self->inputs.count && used >= 0 && (size_t)used < capacity; ++i)
        used += snprintf(out + used, capacity - (size_t)used, "%s%s", i ? " + " : "",
                         input_name(self->inputs.input[i]));
    if (used >= 0 && (size_t)used < capacity)
        (void)snprintf(out + used, capacity - (size_t)used, ", %s",
                       plugin_short_name(self->mapping.instance.type));
}

/* ---- lines that are always printed ---- */

static void print_motion(const recording *of, facts *told)
{
    char text[64];
    const bool is_still = of->furthest_mm < 0.05;
    (void)snprintf(text, sizeof text, "%.1f mm at most", of->furthest_mm);
    facts_headline(told, "moved",
                   is_still ? "nothing: no hand touched skin that can be pulled. Try --map "
                              "one_hand, or look at the rig with marotte rig show"
                            : text);
}

static void print_nothing_written(const perform_options *options, facts *told)
{
    if (options->export_count == 0 && !options->record && options->output_count == 0)
        facts_headline(told, "wrote",
                       "nothing: add --export out/NAME.glb, or --record SHOW.marotte");
}

static void print_show(const performance *self, facts *told)
{
    char text[8192], quoted[4096];
    if (!self->options->record)
        return;
    const char *path = show_path(self->record.show);
    program_quote(quoted, sizeof quoted, path);
    (void)snprintf(text, sizeof text, "%.3000s, take %jd - open it in the stage: marotte %s", path,
                   (intmax_t)self->record.take, quoted);
    facts_headline(told, "wrote", text);
}

static void print_performance(const performance *self, facts *told)
{
    char title[256], text[320];
    name_performance(self, title, sizeof title);
    (void)snprintf(text, sizeof text, "%s: %.1f s, %u frames", title, self->report.duration_s,
                   self->report.frame_count);
    facts_headline(told, "performed", text);
    print_motion(&self->recording, told);
    print_show(self, told);
    print_nothing_written(self->options, told);
}

static void report_performance(performance *self, facts *told)
{
    const composer_counts *counts = self->performer->counts;
    const player_report *report = &self->report;
    print_performance(self, told);
    facts_text(told, "face", "face", self->options->face);
    facts_number(told, "vertices", "vertices", self->face.mesh.vertex_count, 0, "");
    facts_number(told, "triangles", "triangles", self->face.mesh.triangle_count, 0, "");
    for (uint32_t i = 0; i < self->inputs.count; ++i)
        facts_list(told, "inputs", "input", input_name(self->inputs.input[i]));
    perform_hands_report(&self->hands, self->performer, told);
    facts_text(told, "mapping", "mapping", self->mapping.instance.type->id);
    perform_mapping_report(&self->mapping, told);
    facts_number(told, "samples", "samples read", (double)report->sample_count, 0, "");
    facts_number(told, "steps", "steps", (double)counts->steps, 0, "");
    facts_number(told, "solves", "solves", (double)counts->solves, 0, "");
    if (report->dropped + report->refused)
        facts_warning(told, "samples_lost", "samples lost", report->dropped + report->refused, 0,
                      "");
    report_devices(self, told);
    facts_number(told, "duration_s", "duration", report->duration_s, 2, "s");
    facts_number(told, "frames", "frames", report->frame_count, 0, "");
    facts_number(told, "fps", "frame rate", self->options->fps, 2, "per second");
    facts_number(told, "frame_median_ms", "median frame", recording_median_ms(&self->recording), 3,
                 "ms");
    facts_number(told, "frame_worst_ms", "worst frame", recording_worst_ms(&self->recording), 3,
                 "ms");
    facts_number(told, "engagements", "engagements", (double)counts->engagements, 0, "");
    facts_number(told, "commits", "commits", (double)counts->commits, 0, "");
    facts_number(told, "substeps", "substeps", (double)counts->substeps, 0, "");
    recording_report_surface(&self->recording, told);
    report_pulls(self, told);
    perform_outputs_report(self->outputs.outputs, told);
}

/* Reports the constraints of the rig. */
static void report_constraints(performance *self, facts *told)
{
    const recording *kept = &self->recording;
    if (!self->face.rig)
        return;
    facts_number(told, "penetration_mm", "penetration", kept->penetration_mm, 3, "mm");
    facts_number(told, "inexact_frames", "projected frames", kept->inexact_frames, 0,
                 "in which skin slid over the skull");
}

/* Writes the information that is needed to repeat the performance. */
static void describe_making(const performance *self, char *out, size_t capacity)
{
    const instance *mapping =
        self->mapping.current ? self->mapping.current : &self->mapping.instance;
    const performer *p = self->performer;
    const csrbf_settings solver = composer_solver_of(p->composer, layer_pull(p->voice[0].layer));
    command_line_text(out, capacity - 1);
    size_t used = strlen(out);
    out[used++] = '\n';
    exports_describe_params(out + used, capacity - used, mapping->type, mapping->params);
    used += strlen(out + used);
    (void)snprintf(out + used, capacity - used,
                   "; kernel %s, radius %g mm, polynomial %s; marotte " MAROTTE_VERSION "\n",
                   csrbf_kernel_name(solver.kernel), round(10.0 * solver.radius) / 10.0,
                   csrbf_polynomial_name(solver.polynomial));
}

static mrt_result write_exports(performance *self, facts *told, error *err)
{
    char title[256], making[4096];
    name_performance(self, title, sizeof title);
    describe_making(self, making, sizeof making);
    exports_settings settings = {.tolerance_mm = self->options->tolerance_mm,
                                 .max_targets = self->options->max_targets,
                                 .is_bare = self->options->is_bare,
                                 .mm_per_unit = self->options->export_mm_per_unit,
                                 .is_by_part = self->options->is_by_part,
                                 .title = title,
                                 .made_from = making,
                                 .look = &self->videos.look};
    return exports_write(self->options->exports, self->options->export_count, self->recording.clip,
                         &settings, &self->progress, told, err);
}

/* Adds the sound of the first recording that has one to the .mp4. Skips a damaged sound, with a
 * warning. */
static mrt_result add_sound_of_input(performance *self, const char *mp4, double length_s,
                                     error *err)
{
    input_sound found;
    char *wav = NULL;
    error why = {""};
    uint32_t i = 0;
    while (i < self->inputs.count && !input_find_sound(self->inputs.input[i], &found))
        i += 1;
    if (i == self->inputs.count)
        return MRT_OK;
    if (exports_video_sound_file(&wav, found.path, found.start_s, length_s, mp4, &why) < 0) {
        fprintf(stderr, "warning: the video has no sound: %s\n", why.text);
        return MRT_OK;
    }
    const mrt_result result = exports_video_add_sound(&self->videos, wav, err);
    exports_video_sound_remove(wav);
    return result;
}

/* Adds sound to the .mp4: that of the microphone, else that of a recording. */
static mrt_result add_sound(performance *self, error *err)
{
    char *wav = NULL;
    take t = {0};
    show *from = self->record.show;
    const char *mp4 = exports_video_mp4(&self->videos);
    double length_s = (double)self->report.frame_count / self->options->fps;
    if (!mp4)
        return MRT_OK;
    if (!self->record.sound)
        return add_sound_of_input(self, mp4, length_s, err);
    mrt_result result = edit_store_take(&t, from, self->record.take, err);
    if (result >= 0 && t.audio.audio != 0)
        result = exports_video_sound(&wav, from, &t, 0, (int64_t)(length_s * 1e9), mp4,
                                     &self->progress, err);
    take_finish(&t);
    if (result >= 0 && wav)
        result = exports_video_add_sound(&self->videos, wav, err);
    exports_video_sound_remove(wav);
    return result;
}

/* ---- --curves: instead of hands, a table (io/curves.h) performs row by row: one that --export
 * FILE.csv wrote, edited or not, or one of another program ---- */

/* Columns of the table; CURVE_TABLE_NONE: no such column. */
typedef struct curve_columns {
    uint32_t dof[MRT_MAX_DOFS];
    uint32_t *contact;                  /* 3 for each contact */
    uint32_t point[MRT_MAX_VECTORS][6]; /* of free points: start and end */
    uint32_t anchor, commit, radius, kernel, polynomial, stretch_most;
    uint32_t used_count;
} curve_columns;

typedef struct curve_performance {
    const perform_options *options;
    curve_table table;
    curve_columns at;
    face_file face;
    composer *composer;
    csrbf_settings solver;
    recording recording;
    exports_video videos;
    progress progress;
    double fps;
} curve_performance;

/* ---- columns ---- */

static mrt_result find_column(curve_performance *self, uint32_t *out, const char *name, error *err)
{
    const curve_table *t = &self->table;
    *out = curve_table_find(t, name);
    if (*out == CURVE_TABLE_NONE)
        return MRT_OK;
    self->at.used_count += 1;
    if (t->bad_row[*out] > 0)
        return error_set(err, MRT_ERR_FORMAT, "%s:%u: %s is not a number", self->options->curves,
                         t->line[t->bad_row[*out] - 1], name);
    return MRT_OK;
}

static mrt_result find_vector(curve_performance *self, uint32_t out[3], const char *name,
                              error *err)
{
    mrt_result result = MRT_OK;
    for (int axis = 0; axis < 3 && result >= 0; ++axis) {
        char column[160];
        (void)snprintf(column, sizeof column, "%s.%c", name, "xyz"[axis]);
        result = find_column(self, &out[axis], column, err);
    }
    return result;
}

static mrt_result find_points(curve_performance *self, error *err)
{
    mrt_result result = MRT_OK;
    for (uint32_t k = 0; k < MRT_MAX_VECTORS && result >= 0; ++k) {
        char start[32], end[32];
        (void)snprintf(start, sizeof start, "control%u.start", k + 1);
        (void)snprintf(end, sizeof end, "control%u.end", k + 1);
        result = find_vector(self, self->at.point[k], start, err);
        if (result >= 0)
            result = find_vector(self, self->at.point[k] + 3, end, err);
    }
    return result;
}

static mrt_result find_columns(curve_performance *self, error *err)
{
    const mrt_face *about = composer_about(self->composer);
    curve_columns *at = &self->at;
    mrt_result result = MRT_OK;
    at->contact = calloc((size_t)about->contact_count * 3 + 1, sizeof *at->contact);
    if (!at->contact)
        return error_set(err, MRT_ERR_MEMORY, "no memory for %u contacts", about->contact_count);
    for (uint32_t i = 0; i < about->dof_count && result >= 0; ++i)
        result = find_column(self, &at->dof[i], about->dofs[i].name, err);
    for (uint32_t i = 0; i < about->contact_count && result >= 0; ++i)
        result = find_vector(self, at->contact + 3 * i, about->contacts[i].name, err);
    if (result >= 0)
        result = find_points(self, err);
    const struct {
        uint32_t *column;
        const char *name;
    } solver[] = {
        {&at->anchor, "solver.anchor"},         {&at->commit, "solver.commit"},
        {&at->radius, "solver.radius"},         {&at->kernel, "solver.kernel"},
        {&at->polynomial, "solver.polynomial"}, {&at->stretch_most, "solver.stretch_most"}};
    uint32_t found = at->used_count;
    for (size_t i = 0; i < sizeof solver / sizeof *solver && result >= 0; ++i)
        result = find_column(self, solver[i].column, solver[i].name, err);
    if (result >= 0 && found == 0)
        result = error_set(err, MRT_ERR_FORMAT,
                           "%s: no column fits %s. A column is named after a degree of freedom, a "
                           "contact or a free point, for example \"%s\"",
                           self->options->curves, self->options->face,
                           about->dof_count > 0 ? about->dofs[0].name : "control1.start.x");
    return result;
}

/* Returns whether the column only labels the row, or only reports how much the pulls moved the
 * shapes of the mesh file. */
static bool is_label_only(const curve_performance *self, const char *column)
{
    static const char *const labels[] = {"frame", "timecode", "time_s", "shape"};
    const face *f = composer_face(self->composer);
    bool is = false;
    for (size_t i = 0; i < sizeof labels / sizeof *labels; ++i)
        is = is || strcmp(column, labels[i]) == 0;
    for (uint32_t i = 0; i < face_shape_count(f); ++i)
        is = is || strncmp(column, face_shape_name(f, i), strlen(face_shape_name(f, i))) == 0;
    return is;
}

/* Reports columns that nothing uses: a misspelt name, or a column for another face. */
static void note_unused(const curve_performance *self)
{
    uint32_t told_only = 0, unused = self->table.column_count - self->at.used_count;
    for (uint32_t i = 0; i < self->table.column_count; ++i)
        told_only += is_label_only(self, self->table.name[i]);
    if (unused > told_only)
        fprintf(stderr, "note: %u columns of %s do not match anything in this face\n",
                unused - told_only, self->options->curves);
}

/* ---- values of a row ---- */

/* Returns NaN if the cell is empty or the column is missing. */
static double cell(const curve_performance *self, uint32_t row, uint32_t column)
{
    if (column == CURVE_TABLE_NONE)
        return (double)NAN;
    return self->table.value[(size_t)row * self->table.column_count + column];
}

static double cell_or(const curve_performance *self, uint32_t row, uint32_t column,
                      double otherwise)
{
    double value = cell(self, row, column);
    return isnan(value) ? otherwise : value;
}

/* Returns false if all three cells are empty. */
static bool read_vector(const curve_performance *self, uint32_t row, const uint32_t column[3],
                        mrt_vec3 *out)
{
    double x = cell(self, row, column[0]), y = cell(self, row, column[1]),
           z = cell(self, row, column[2]);
    *out = (mrt_vec3){isnan(x) ? 0.0f : (float)x, isnan(y) ? 0.0f : (float)y,
                      isnan(z) ? 0.0f : (float)z};
    return !isnan(x) || !isnan(y) || !isnan(z);
}

static void add_vector(mrt_pull *out, uint32_t contact, mrt_vec3 start, mrt_vec3 end)
{
    if (out->count < MRT_MAX_VECTORS)
        out->vector[out->count++] = (mrt_vector){start, end, contact};
}

static void read_pulls(const curve_performance *self, uint32_t row, mrt_pull *out)
{
    const mrt_face *about = composer_about(self->composer);
    mrt_vec3 start, way;
    for (uint32_t i = 0; i < about->contact_count; ++i) {
        if (!read_vector(self, row, self->at.contact + 3 * i, &way))
            continue;
        start = about->contacts[i].rest;
        add_vector(out, i + 1, start,
                   (mrt_vec3){start.x + way.x, start.y + way.y, start.z + way.z});
    }
    for (uint32_t k = 0; k < MRT_MAX_VECTORS; ++k)
        if (read_vector(self, row, self->at.point[k], &start) &&
            read_vector(self, row, self->at.point[k] + 3, &way))
            add_vector(out, 0, start, way);
}

/* The table has the values after softening near the limits, so the softening is inverted here. */
static void read_dofs(const curve_performance *self, uint32_t row, float *out)
{
    const mrt_face *about = composer_about(self->composer);
    float posed[MRT_MAX_DOFS] = {0};
    for (uint32_t i = 0; i < about->dof_count; ++i)
        posed[i] = (float)cell_or(self, row, self->at.dof[i], 0.0);
    memcpy(out, posed, sizeof posed);
    bones_unlimit(out, face_bones(composer_face(self->composer)), posed);
}

static void read_pull(const curve_performance *self, uint32_t row, mrt_pull *out)
{
    *out = (mrt_pull){.mode = MRT_ANCHORED};
    read_dofs(self, row, out->dof);
    read_pulls(self, row, out);
    out->anchor = (uint32_t)cell_or(self, row, self->at.anchor, 0.0);
    out->commit = (uint32_t)cell_or(self, row, self->at.commit, 0.0);
    out->radius_mm = (float)cell_or(self, row, self->at.radius, 0.0);
    out->stretch_most = (float)cell_or(self, row, self->at.stretch_most, 0.0);
    if (cell_or(self, row, self->at.polynomial, 0.0) == CSRBF_LINEAR)
        out->solve = MRT_SOLVE_LINEAR;
}

/* Returns the solver settings of the first row that has them. Each row has its own radius. */
static csrbf_settings solver_of(const curve_performance *self)
{
    csrbf_settings out = {0};
    uint32_t kernel = curve_table_find(&self->table, "solver.kernel"),
             polynomial = curve_table_find(&self->table, "solver.polynomial");
    if (self->face.rig)
        out = self->face.rig->solver;
    for (uint32_t row = self->table.row_count; row-- > 0;) {
        double is = cell(self, row, kernel), with = cell(self, row, polynomial);
        if (is >= CSRBF_WENDLAND_C2 && is <= CSRBF_WENDLAND_C6)
            out.kernel = (csrbf_kernel)is;
        if (with >= CSRBF_NONE && with <= CSRBF_WINDOWED && with != CSRBF_LINEAR)
            out.polynomial = (csrbf_polynomial)with;
    }
    return out;
}

/* ---- performing ---- */

/* Computes the frame rate from the column time_s, unless --fps is given. */
static mrt_result find_rate(curve_performance *self, error *err)
{
    const curve_table *t = &self->table;
    uint32_t time = curve_table_find(t, "time_s");
    double span_s = cell(self, t->row_count - 1, time) - cell(self, 0, time);
    timecode_rate rate;
    self->fps = self->options->fps > 0.0 ? self->options->fps : 30.0;
    if (self->options->fps > 0.0 || time == CURVE_TABLE_NONE || t->row_count < 2)
        return MRT_OK;
    for (uint32_t row = 1; row < t->row_count; ++row)
        if (!(cell(self, row, time) > cell(self, row - 1, time)))
            return error_set(err, MRT_ERR_FORMAT, "%s:%u: time_s does not increase",
                             self->options->curves, t->line[row]);
    mrt_result result = timecode_rate_of(&rate, (t->row_count - 1) / span_s, err);
    if (result < 0) {
        error_prefix(err, self->options->curves);
        return result;
    }
    self->fps = timecode_fps(rate);
    return MRT_OK;
}

/* Continues the time code of the table. */
static void label_clip(curve_performance *self)
{
    timecode_rate rate;
    error ignored;
    clip_start start = {.frame = 0};
    if (!self->recording.clip || timecode_rate_of(&rate, self->fps, &ignored) < 0)
        return;
    rate.is_drop = strchr(self->table.timecode, ';') != NULL;
    if (timecode_parse(&start.frame, rate, self->table.timecode, &ignored) < 0)
        return;
    start.rate_num = rate.num;
    start.rate_den = rate.den;
    timecode_write(start.timecode, rate, start.frame);
    clip_set_start(self->recording.clip, &start);
}

static mrt_result prepare_curves(curve_performance *self, error *err)
{
    const perform_options *o = self->options;
    mrt_result result = exports_prepare(&self->videos, o->exports, o->export_count, &o->look, err);
    if (result >= 0)
        result = video_look_open(&self->videos.look, NULL, NULL, err);
    if (result >= 0)
        result = curve_table_read(&self->table, o->curves, err);
    if (result >= 0)
        result = face_file_read(&self->face, o->face, &o->frame, FACE_FILE_USABLE, err);
    if (result >= 0)
        result = exports_check_face(o->exports, o->export_count, &self->face.mesh, err);
    if (result < 0)
        return result;
    self->solver = solver_of(self);
    result = composer_create(&self->composer, &self->face, &self->solver, err);
    if (result >= 0)
        result = find_columns(self, err);
    if (result >= 0)
        result = find_rate(self, err);
    if (result >= 0)
        result = recording_create(&self->recording, &self->face, self->fps,
                                  recording_use_of(o->exports, o->export_count), err);
    video_settings settings = {.mesh = &self->face.mesh, .pace = VIDEO_EVERY_FRAME, .timecode = ""};
    if (result >= 0)
        result = timecode_rate_of(&settings.rate, self->fps, err);
    return result < 0 ? result : exports_video_open(&self->videos, &settings, err);
}

/* A table of a performance has the swing of loose parts. They must not swing again. */
static void hold_swung(curve_performance *self)
{
    face *f = composer_face(self->composer);
    for (uint32_t i = 0; i < composer_about(self->composer)->dof_count; ++i)
        if (self->at.dof[i] != CURVE_TABLE_NONE && face_dof_swings(f, i))
            face_set_springs(f, 0.0);
}

static mrt_result perform_rows(curve_performance *self, error *err)
{
    mrt_result result = MRT_OK;
    hold_swung(self);
    progress_start(&self->progress, "performing");
    for (uint32_t row = 0; row < self->table.row_count && result >= 0; ++row) {
        mrt_pull pull;
        read_pull(self, row, &pull);
        const composer_part part = {.weight = 1.0, .gain = 1.0, .is_fresh = true, .pull = &pull};
        composer_move(self->composer, &part, 1, 1.0 / self->fps);
        composer_swing(self->composer, (int64_t)(row / self->fps * (double)NS_PER_S));
        composer_draw(self->composer);
        result = exports_video_add(&self->videos, self->composer, err);
        if (result >= 0)
            result = recording_add_face(&self->recording, self->composer, 0, err);
        if (cancel_is_requested())
            break;
        progress_show_time(&self->progress, row / self->fps, self->table.row_count / self->fps);
    }
    progress_end(&self->progress);
    const composer_counts *counts = composer_get_counts(self->composer);
    if (result >= 0 && counts->held_pulls > 0)
        result = error_set(err, MRT_ERR_FORMAT, "%s: %s", self->options->curves,
                           counts->first_problem.text);
    return result;
}

/* Reports rows whose shape cannot be computed from the numbers alone. */
static void note_others(const curve_performance *self)
{
    if (self->table.other_shapes > 0)
        fprintf(stderr,
                "note: %u rows of %s come from clay or from a committed shape. They are performed "
                "on the face at rest\n",
                self->table.other_shapes, self->options->curves);
}

static mrt_result perform_curves(const perform_options *options, facts *told, error *err)
{
    curve_performance self = {.options = options};
    const exports_settings settings = {.tolerance_mm = options->tolerance_mm,
                                       .max_targets = options->max_targets,
                                       .is_bare = options->is_bare,
                                       .title = options->curves,
                                       .made_from = "",
                                       .look = &self.videos.look};
    mrt_result result = prepare_curves(&self, err);
    if (result >= 0) {
        note_unused(&self);
        note_others(&self);
        result = perform_rows(&self, err);
    }
    if (result >= 0) {
        char text[320];
        (void)snprintf(text, sizeof text, "%.120s: %.120s, %u frames", file_name_of(options->face),
                       options->curves, self.recording.frame_count);
        facts_headline(told, "performed", text);
        print_motion(&self.recording, told);
        print_nothing_written(options, told);
        facts_text(told, "face", "face", options->face);
        facts_text(told, "curves", "curves", options->curves);
        facts_number(told, "columns", "columns used", self.at.used_count, 0, "");
        facts_number(told, "frames", "frames", self.recording.frame_count, 0, "");
        facts_number(told, "fps", "frame rate", self.fps, 2, "per second");
        recording_report_surface(&self.recording, told);
        label_clip(&self);
        result = exports_video_finish(&self.videos, told, err);
    }
    if (result >= 0)
        result = exports_write(options->exports, options->export_count, self.recording.clip,
                               &settings, &self.progress, told, err);
    exports_video_close(&self.videos);
    recording_destroy(&self.recording);
    composer_destroy(self.composer);
    face_file_destroy(&self.face);
    free(self.at.contact);
    curve_table_finish(&self.table);
    return result;
}

static int run_curves(perform_options *options, facts *told)
{
    error err = {""};
    mrt_result result = perform_curves(options, told, &err);
    finish_options(options);
    return command_end(&command_perform, told, result, &err);
}

/* ---- the command ---- */

static int run(int argc, char **argv)
{
    perform_options options;
    int code = read_options(&options, argc, argv);
    if (code != COMMAND_DONE)
        return code;
    performance self = {.options = &options};
    error err = {""};
    cancel_on_signals(CANCEL_WAITS, NULL);
    facts *told = facts_create(options.is_json      ? FACTS_JSON
                               : options.is_verbose ? FACTS_LINES
                                                    : FACTS_BRIEF);
    mrt_result result = told ? MRT_OK : error_set(&err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0 && options.curves)
        return run_curves(&options, told);
    if (result >= 0)
        result = prepare(&self, &err);
    if (result >= 0)
        result = perform(&self, &err);
    if (result >= 0)
        result = end_recording(&self, told, &err);
    if (result >= 0) {
        report_performance(&self, told);
        report_constraints(&self, told);
    }
    if (result >= 0)
        result = exports_video_finish(&self.videos, told, &err);
    if (result >= 0)
        result = add_sound(&self, &err);
    if (result >= 0)
        result = write_exports(&self, told, &err);
    if (result >= 0 && self.report.input_failed)
        result = error_set(&err, MRT_ERR_IO, "%s: the input failed; the performance ends there",
                           input_name(self.inputs.input[0]));
    result = finish(&self, result, &err);
    finish_options(&options);
    return command_end(&command_perform, told, result, &err);
}

const command command_perform = {
    .name = "perform",
    .summary = "perform a face without a window, from recordings or devices",
    .help =
        "marotte perform --face FACE --input PLUGIN[:ADDRESS][,key=value]...\n"
        "                --map PLUGIN[,key=value]...\n"
        "                [--record SHOW.marotte [--scene NAME] [--shot NAME] [--sound]]\n"
        "                [--export FILE]... [--fps N] [--seconds N] [--realtime]\n"
        "                [--verbose] [--json]\n"
        "\n"
        "Hands move a face. Recordings are performed as fast as possible, devices in real time.\n"
        "Prints four lines: the performance, the face's motion, the files, warnings.\n"
        "\n"
        "The face:\n"
        "  --face FACE        NAME.rig.json, a head (.glb .gltf .vrm .obj .ply .off ...), or the\n"
        "                     name of a rig that comes with marotte: puppet, moai\n"
        "  --unit mm|cm|m|MM  the unit of the head's coordinates, or its length in mm (detected)\n"
        "  --up AXIS          the up axis of the head: x, y, z, -x, -y, -z (detected)\n"
        "  --forward AXIS     the axis along which the face looks (detected)\n"
        "\n"
        "The performance:\n"
        "  --input SPEC       an input plugin, its address and parameters; up to 8 times:\n"
        "                     log:demo,speed=2\n"
        "  --map SPEC         a mapping plugin and its parameters: anchored,radius=30,gain=0.8\n"
        "  --curves FILE.csv  instead of --input and --map: a table as --export FILE.csv writes,\n"
        "                     a row for each frame, columns by name (jaw.open)\n"
        "  --patch FILE       let channels move the face too: a file, or faders, gamepad, phone,\n"
        "                     phone_face, voice\n"
        "  --life on|SPEC     blink, look around, breathe and lean: blink=0.5,gaze=0.5,seed=7\n"
        "                     Alone, it needs --seconds, but no --input\n"
        "  --calibration FILE the calibration of a hand, once per hand (marotte calibrate), or\n"
        "                     none for the shipped defaults (the newest in the user's folder)\n"
        "  --hand-length MM   wrist to middle fingertip (calibrated, else 190)\n"
        "  --rezero-pedal N   pedal 1 to 4: a press makes the current pose the neutral pose. In\n"
        "                     real time the key z does the same, and q ends\n"
        "  --realtime         play recordings in real time\n"
        "  --seconds N        stop after N seconds of the performance\n"
        "  --isolate auto|on|off   run the mapping in its own process, where a crash does no harm\n"
        "                     (auto: mappings that did not come with marotte)\n"
        "  --watch-plugins    reload the mapping when its library is rebuilt\n"
        "  --output SPEC      send the face to another program, in real time; up to 8 times:\n"
        "                     PLUGIN[:ADDRESS][,key=value]..., such as vmc:192.168.1.20:39540\n"
        "\n"
        "Files (missing folders are created):\n"
        "  --record SHOW      record the hands as a take of this show (created if it is missing);\n"
        "                     --scene and --shot set its slate\n"
        "  --sound            also record the microphone\n"
        "  --export FILE      up to 16 times; the formats are below\n"
        "  --fps N            frames per second of the exports, 1 to 1000 (30)\n"
        "  --tolerance MM     greatest error in glTF (0.01 % of the height, clay 0.1 %)\n"
        "  --max-targets N    limit the morph targets without a name\n"
        "  --bare             glTF: only the mesh. Otherwise the export of a .glb, .gltf or .vrm\n"
        "                     keeps the whole file and adds the performance\n"
        "  --export-unit mm|cm|m|MM   the unit of .pc2 .mdd .usda (mm) and .bvh (cm)\n"
        "  --by-part          .pc2 and .mdd: a file for each part of the mesh, NAME.1.PART.pc2\n"
        "\n"
        "Pictures and videos:\n"
        "  --size WxH         in pixels (1280x720, a contact sheet 1920x960)\n"
        "  --view front|side|three-quarter|1..6   the camera; 1..6: a camera view of the show\n"
        "  --mirror           swap left and right\n"
        "  --look studio|theatre|daylight|SHOW.marotte   the lights and the wall (studio, or the\n"
        "                     scene of the show that is recorded)\n"
        "  --background #RRGGBB|transparent|FILE.png|FILE.jpg   replace the wall; transparent\n"
        "                     is for pictures, not for .mp4\n"
        "\n"
        "Output:\n"
        "  --verbose          print all facts: times, folds, stretch, targets\n"
        "  --json             print all facts as JSON\n"
        "\n"
        "Plugins and their parameters: marotte plugin list --params\n"
        "\n"
        "Formats, by the end of the name:\n",
    .more_help = EXPORTS_HELP,
    .examples =
        "perform --face puppet --input log:demo --map one_hand --export out/puppet.glb\n"
        "perform --face moai --input log:demo_hand.csv,end=8 --map anchored --export out/moai.png\n"
        "perform --face puppet --input log:demo --map one_hand --record show.marotte\n"
        "perform --face puppet --life on --seconds 5 --export out/alive.glb\n"
        "perform --face puppet --curves curves.csv --export out/again.glb\n",
    .run = run,
    .options = option_table,
};
