#include "window/app/app_shared.h"
#include "window/app/open_recent.h"

#include "base/installed.h"
#include "base/clock.h"
#include "base/file.h"
#include "stage/perform/patch_file.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Before the frame thread has published anything. */
static const live_view nothing_yet;

/* ---- saying things ---- */

mrt_result app_report(app *self, mrt_result result, const error *err)
{
    if (result < 0)
        news_list_add(self->news, MRT_LOG_ERROR, "stage", err->text);
    return result;
}

void app_say(app *self, int32_t level, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    news_list_add(self->news, level, "stage", text);
}

/* ---- the patch ---- */

static bool patch_path(const app *self, char *out, size_t capacity)
{
    const char *folder = settings_folder(self->settings);
    int length = snprintf(out, capacity, "%spatch.json", folder);
    return folder[0] && length > 0 && (size_t)length < capacity;
}

/* Reads the patch that was saved when the program ended. */
static void read_patch(app *self)
{
    char path[PATH_MAX];
    error err = {""};
    if (!self->saving.is_on || !patch_path(self, path, sizeof path) || access(path, R_OK) != 0)
        return;
    (void)app_report(self, patch_file_read(&self->patching.patch, path, &err), &err);
    self->patching.waits = self->patching.patch.count > 0;
}

static void keep_patch(app *self)
{
    char path[PATH_MAX], *text = NULL;
    error err = {""};
    if (!self->saving.is_on || !patch_path(self, path, sizeof path))
        return;
    patch before;
    mrt_result result = access(path, F_OK) == 0 ? patch_file_read(&before, path, &err) : MRT_OK;
    if (result < 0)
        error_prefix(&err, "the patch is not saved over this file; move it away");
    else
        result = patch_file_write(&text, &self->patching.patch, &err);
    if (result >= 0)
        result = file_write(path, text, strlen(text), &err);
    free(text);
    (void)app_report(self, result, &err);
}

const patch *app_patch(const app *self)
{
    return &self->patching.patch;
}

void app_set_patch(app *self, const patch *p)
{
    self->patching.patch = *p;
    self->patching.waits = true;
    keep_patch(self);
}

app_patch_aim *app_patch_aimed(app *self)
{
    return &self->patching.aim;
}

bool app_press(app *self, patch_action of)
{
    static const action does[PATCH_ACTIONS] = {
        [PATCH_RECORD] = ACTION_RECORD, [PATCH_STOP] = ACTION_RECORD, [PATCH_MARK] = ACTION_MARK};
    live_status_of(self->live, &self->status); /* another press may have been in this frame */
    const bool is_going = self->status.is_recording || self->recording.counts_in;
    const bool is_wanted = of == PATCH_MARK || (of == PATCH_STOP) == is_going;
    if (is_wanted)
        app_do(self, does[of]);
    return is_wanted;
}

static void run_pressed_actions(app *self)
{
    for (int i = 0; i < PATCH_ACTIONS; ++i) {
        const bool is_new = self->status.patch_pressed[i] > self->patching.pressed[i];
        self->patching.pressed[i] = self->status.patch_pressed[i];
        if (is_new)
            (void)app_press(self, (patch_action)i);
    }
}

static void update_patch(app *self)
{
    error err = {""};
    run_pressed_actions(self);
    if (!self->patching.waits || self->status.is_recording)
        return;
    mrt_result result = live_set_patch(self->live, &self->patching.patch, &err);
    if (result == MRT_HOLD)
        return;
    self->patching.waits = false;
    (void)app_report(self, result, &err);
}

/* ---- remote control ---- */

static const char remote_key[] = "remote.place";

app_remote_status app_remote_now(const app *self)
{
    return remote_status_of(self->remote);
}

void app_set_remote(app *self, const char *address)
{
    error err = {""};
    if (app_report(self, remote_listen(self->remote, address, &err), &err) >= 0 &&
        remote_is_local(address))
        settings_set_text(self->settings, remote_key, address[0] ? address : NULL);
}

void app_renew_remote_code(app *self)
{
    remote_renew_code(self->remote);
}

static mrt_result start_remote(app *self, const char *wanted, error *err)
{
    const char *address = wanted ? wanted : settings_text(self->settings, remote_key, "");
    error ignored;
    if (!wanted && !remote_is_local(address)) {
        news_list_add(self->news, MRT_LOG_WARNING, "remote",
                      "remote control: off. For safety it is not switched on automatically where "
                      "the network can reach it: use --remote, or the panel Devices");
        return MRT_OK;
    }
    const mrt_result result = remote_listen(self->remote, address, wanted ? err : &ignored);
    return wanted ? result : MRT_OK;
}

/* ---- the picture for other programs ---- */

enum { PICTURE_LEAST = 64, PICTURE_MOST = 4096, FPS_MOST = 120 };

static uint32_t number_within(double value, uint32_t least, uint32_t most, uint32_t otherwise)
{
    return value >= least && value <= most ? (uint32_t)value : otherwise;
}

static void take_picture(app *self, const app_picture *wanted)
{
    const uint64_t edition = self->picture.edition + 1;
    self->picture = *wanted;
    self->picture.edition = edition;
    self->picture.width = number_within(wanted->width, PICTURE_LEAST, PICTURE_MOST, 1280) & ~1u;
    self->picture.height = number_within(wanted->height, PICTURE_LEAST, PICTURE_MOST, 720) & ~1u;
    self->picture.fps = number_within(wanted->fps, 1, FPS_MOST, 30);
}

void app_set_picture(app *self, const app_picture *wanted)
{
    take_picture(self, wanted);
    settings_set_text(self->settings, "picture.background", self->picture.background);
    settings_set_text(self->settings, "picture.targets", self->picture.targets);
    settings_set_number(self->settings, "picture.on_top", self->picture.is_on_top);
    settings_set_number(self->settings, "picture.window", self->picture.is_window);
    settings_set_number(self->settings, "picture.width", self->picture.width);
    settings_set_number(self->settings, "picture.height", self->picture.height);
    settings_set_number(self->settings, "picture.fps", self->picture.fps);
}

static void read_picture(app *self, const app_picture *given)
{
    const settings *from = self->settings;
    app_picture kept = {
        .is_on_top = settings_number(from, "picture.on_top", 0.0) > 0.5,
        .is_window = settings_number(from, "picture.window", 0.0) > 0.5,
        .width = number_within(settings_number(from, "picture.width", 0.0), 0, PICTURE_MOST, 0),
        .height = number_within(settings_number(from, "picture.height", 0.0), 0, PICTURE_MOST, 0),
        .fps = number_within(settings_number(from, "picture.fps", 0.0), 0, FPS_MOST, 0)};
    (void)snprintf(kept.background, sizeof kept.background, "%s",
                   settings_text(from, "picture.background", ""));
    (void)snprintf(kept.targets, sizeof kept.targets, "%s",
                   settings_text(from, "picture.targets", ""));
    take_picture(self, given ? given : &kept); /* options of the command line are not saved */
}

const app_picture *app_picture_now(const app *self)
{
    return &self->picture;
}

void app_note_picture(app *self, const char *says, uint32_t streams)
{
    self->stream_count = streams;
    if (says[0] && strcmp(says, self->picture_says) != 0)
        news_list_add(self->news, MRT_LOG_WARNING, "stream", says);
    (void)snprintf(self->picture_says, sizeof self->picture_says, "%s", says);
}

const char *app_picture_says(const app *self, uint32_t *out_streams)
{
    *out_streams = self->stream_count;
    return self->picture_says;
}

/* ---- outputs ---- */

static void keep_outputs(app *self)
{
    outputs *of = live_outputs(self->live);
    const char *kept[OUTPUTS_MAX];
    const uint32_t count = outputs_count(of);
    for (uint32_t i = 0; i < count; ++i) {
        output_status now;
        outputs_status(of, i, &now);
        kept[i] = now.text;
    }
    settings_set_list(self->settings, "outputs", kept, count, OUTPUTS_MAX);
}

/* Opens the outputs of the last run whose plugins are loaded. */
static void open_outputs(app *self)
{
    const char *kept[OUTPUTS_MAX];
    const uint32_t count = settings_list(self->settings, "outputs", kept, OUTPUTS_MAX);
    for (uint32_t i = 0; i < count; ++i) {
        error err = {""};
        (void)app_report(self, outputs_add(live_outputs(self->live), kept[i], &err), &err);
    }
}

/* The texts of all outputs, one a line. NULL: no memory. */
static char *list_outputs(app *self, size_t *out_size)
{
    outputs *of = live_outputs(self->live);
    char *list = NULL;
    FILE *stream = open_memstream(&list, out_size);
    output_status now;
    for (uint32_t i = 0; stream && i < outputs_count(of); ++i) {
        outputs_status(of, i, &now);
        (void)fprintf(stream, "%s\n", now.text);
    }
    return stream && fclose(stream) == 0 ? list : NULL;
}

static bool has_line(const char *list, const char *line, size_t length)
{
    for (const char *end; (end = strchr(list, '\n')) != NULL; list = end + 1)
        if ((size_t)(end - list) == length && memcmp(list, line, length) == 0)
            return true;
    return false;
}

/* Closes the outputs that the list lacks, and opens those that only it has. */
static mrt_result set_outputs(void *owner, const void *value)
{
    app *self = owner;
    const char *wanted = value;
    outputs *of = live_outputs(self->live);
    mrt_result result = MRT_OK;
    size_t size = 0;
    char *had = list_outputs(self, &size);
    error err = {""};
    if (!had)
        return app_report(self, error_set(&err, MRT_ERR_MEMORY, "no memory for the outputs"), &err);
    for (uint32_t i = outputs_count(of); i-- > 0;) {
        output_status now;
        outputs_status(of, i, &now);
        if (!has_line(wanted, now.text, strlen(now.text)))
            outputs_remove(of, i);
    }
    for (const char *end; (end = strchr(wanted, '\n')) != NULL; wanted = end + 1) {
        char *text = has_line(had, wanted, (size_t)(end - wanted))
                         ? NULL
                         : strndup(wanted, (size_t)(end - wanted));
        if (text && app_report(self, outputs_add(of, text, &err), &err) < 0)
            result = MRT_ERR_IO;
        free(text);
    }
    free(had);
    keep_outputs(self);
    return result;
}

/* Takes `before`, which list_outputs made. */
static void note_outputs(app *self, const char *what, const char *text, char *before, size_t size)
{
    size_t size_after = 0;
    undo_change made = {.owner = self, .set = set_outputs, .before = before};
    made.after = list_outputs(self, &size_after);
    made.bytes = size + size_after;
    (void)snprintf(made.words, sizeof made.words, "%s output %.120s", what, text);
    if (made.before && made.after) {
        undo_list_add(self->undo.list, &made);
        return;
    }
    free(made.before);
    free(made.after);
}

mrt_result app_add_output(app *self, const char *text)
{
    char *spec;
    size_t size = 0;
    self->output_trouble = (error){""};
    mrt_result result = plugin_list_choose_spec(&self->plugins, text, MRT_FACE_OUTPUT, &spec,
                                                &self->output_trouble);
    char *before = list_outputs(self, &size);
    if (result >= 0)
        result = outputs_add(live_outputs(self->live), spec, &self->output_trouble);
    if (result >= 0) {
        keep_outputs(self);
        note_outputs(self, "add", spec, before, size);
    } else
        free(before);
    free(spec);
    return app_report(self, result, &self->output_trouble);
}

void app_remove_output(app *self, uint32_t index)
{
    outputs *of = live_outputs(self->live);
    output_status now;
    size_t size = 0;
    char *before = list_outputs(self, &size);
    outputs_status(of, index, &now);
    char *text = strdup(now.text);
    outputs_remove(of, index);
    keep_outputs(self);
    note_outputs(self, "remove", text ? text : "", before, size);
    free(text);
}

const char *app_output_trouble(const app *self)
{
    return self->output_trouble.text;
}

/* ---- life ---- */

static mrt_result make_parts(app *self, const app_options *options, error *err)
{
    char note[1024];
    mrt_result result =
        settings_open(&self->settings, options->settings_path, note, sizeof note, err);
    if (result < 0)
        return result;
    self->log = log_queue_create();
    self->news = news_list_create();
    self->exports = exporter_create();
    self->poses = pose_palette_create(self, self->settings);
    self->life = kept_life_create(self, options->lives);
    self->remote = remote_create(self);
    self->scenery = kept_scenery_create(self);
    self->inputs = self->log ? input_opener_create(&self->plugins, self->log) : NULL;
    if (!self->log || !self->news || !self->exports || !self->inputs || !self->poses ||
        !self->remote || !self->scenery || !self->life)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    if (note[0])
        app_say(self, MRT_LOG_WARNING, "%s", note);
    if (options->note && options->note[0])
        app_say(self, MRT_LOG_WARNING, "%s", options->note);
    app_looks_read(self);
    read_picture(self, options->picture);
    return MRT_OK;
}

mrt_result app_create(app **out, const app_options *options, error *err)
{
    *out = NULL;
    app *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    self->undo.list = undo_list_create();
    if (!self->undo.list) {
        free(self);
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    }
    self->view = &nothing_yet;
    self->takes.choice.marker = -1;
    self->sound = options->sound;
    self->changed = options->changed;
    mrt_result result = make_parts(self, options, err);
    if (result >= 0)
        result = app_open_first(self, options, err);
    if (result >= 0)
        result = start_remote(self, options->remote, err);
    if (result < 0) {
        (void)app_destroy(self);
        return result;
    }
    self->saving.is_on = true;
    self->takes.are_stale = true;
    read_patch(self);
    open_outputs(self);
    const live_click click = app_click(self);
    app_set_click(self, &click);
    app_update(self, 0.0);
    *out = self;
    return MRT_OK;
}

/* An error goes to stderr, as the window is gone. */
static mrt_result end_live(app *self)
{
    error err = {0};
    const mrt_result result = self->live ? live_stop(self->live, &err) : MRT_OK;
    if (result < 0)
        fprintf(stderr, "marotte: %s\n", err.text);
    self->live = NULL;
    self->view = &nothing_yet;
    return result;
}

mrt_result app_destroy(app *self)
{
    if (!self)
        return MRT_OK;
    if (self->saving.is_on)
        app_keep_settings_last(self);
    remote_destroy(self->remote);
    input_opener_destroy(self->inputs);
    app_drop_copy(self);
    app_drop_audio(self);
    app_drop_speech(self);
    app_drop_sync(self);
    exporter_destroy(self->exports);
    app_record_finish_over(self);
    app_drop_take(self);
    app_forget_pulls(self);
    kept_scenery_destroy(self->scenery);
    mrt_result result = end_live(self);
    pose_palette_destroy(self->poses);
    kept_life_destroy(self->life);
    if (app_close_show(self, self->show) < 0)
        result = MRT_ERR_IO;
    face_file_destroy(self->face);
    free(self->face);
    free(self->face_path);
    free(self->takes.line);
    free(self->takes.key);
    undo_list_destroy(self->undo.list);
    settings_close(self->settings);
    news_list_destroy(self->news);
    log_queue_destroy(self->log);
    plugin_list_destroy(&self->plugins);
    free(self);
    return result;
}

/* ---- each frame ---- */

/* Disarms the sound if no microphone was found, which the log reports. A microphone that was lost
 * during use stays armed. */
static void follow_sound(app *self)
{
    const sound_device_status *device = &self->status.listening.device;
    if (self->status.is_sound_armed && device->state == SOUND_DEVICE_AWAY &&
        device->lost_count == 0)
        live_disarm_sound(self->live);
}

/* Inputs that were opened join the stage, but not before the end of a take that is being recorded.
 */
static void take_inputs(app *self)
{
    input_opened one;
    live_status_of(self->live, &self->status);
    while (!self->status.is_recording && input_opener_take(self->inputs, &one)) {
        mrt_result result = MRT_ERR_IO;
        if (one.input)
            result = live_add_input(self->live, one.input, one.text, &one.err);
        self->input_trouble = result < 0 ? one.err : (error){""};
        if (result < 0)
            open_recent_remove(self->settings, one.text);
        (void)app_report(self, result, &one.err);
    }
}

static void report_exports(app *self)
{
    mrt_result result;
    char text[2048];
    while (exporter_ended(self->exports, &result, text, sizeof text)) {
        self->exports_failed += result < 0;
        app_say(self, result < 0 ? MRT_LOG_ERROR : MRT_LOG_INFO, "%s", text);
    }
}

uint32_t app_exports_failed(const app *self)
{
    return self->exports_failed;
}

/* ---- which frames are wanted ---- */

void app_want_frame(app *self, double in_s)
{
    self->wanted_s = fmin(self->wanted_s, in_s);
}

double app_wanted_s(const app *self)
{
    return self->wanted_s;
}

static bool is_playing(const app *self)
{
    return self->view->mode != LIVE_PERFORMS && live_transport(self->live)->is_playing &&
           !live_position(self->live).has_stopped;
}

/* Requests frames for activities of the application. Panels request their own. */
static void want_frames(app *self)
{
    static const double each_s = 0.0, clock_s = 0.05, meter_s = 0.06, work_s = 0.1;
    input_opening opening[INPUT_OPENINGS_MAX];
    if (is_playing(self) || self->view->mode == LIVE_OVERDUBS || app_leads_in_s(self) > 0.0 ||
        self->chase.is_on || self->patching.waits || remote_status_of(self->remote).is_listening)
        app_want_frame(self, each_s);
    if (self->status.is_recording || self->awaited.take)
        app_want_frame(self, clock_s);
    if (self->status.is_sound_armed)
        app_want_frame(self, meter_s);
    if (input_opener_going(self->inputs, opening) > 0 || exporter_count(self->exports) > 0 ||
        self->copier || self->audio.import || kept_scenery_is_reading(self->scenery) ||
        live_is_busy(self->live))
        app_want_frame(self, work_s);
}

void app_update(app *self, double dt_s)
{
    const live_view *newest = NULL;
    self->wanted_s = HUGE_VAL;
    take_inputs(self);
    live_set_life(self->live, kept_life_now(self->life));
    live_update(self->live);
    (void)live_read_view(self->live, &newest);
    if (newest)
        self->view = newest;
    live_status_of(self->live, &self->status);
    follow_sound(self);
    app_record_update(self);
    update_patch(self);
    remote_update(self->remote, dt_s);
    pose_palette_update(self->poses);
    report_exports(self);
    app_undo_update(self);
    kept_scenery_update(self->scenery);
    app_takes_update(self, dt_s);
    app_follow_copy(self);
    app_follow_audio(self);
    app_follow_speech(self);
    app_follow_sync(self);
    app_chase(self);
    news_list_update(self->news, self->log, dt_s);
    if (self->saving.is_on)
        app_keep_settings(self, dt_s);
    want_frames(self);
}

/* ---- inputs ---- */

mrt_result app_open_input(app *self, const char *text)
{
    char *spec;
    self->input_trouble = (error){""};
    mrt_result result =
        plugin_list_choose_spec(&self->plugins, text, MRT_INPUT, &spec, &self->input_trouble);
    const char *const one = spec;
    if (result >= 0)
        result = input_opener_open(self->inputs, &one, 1, false, &self->input_trouble);
    free(spec);
    return app_report(self, result, &self->input_trouble);
}

bool app_demo_hand(char out[APP_DEMO_TEXT])
{
    static const char recording[] =
        "demo_hand.csv"; /* a name: the settings keep it over an upgrade */
    char path[INSTALLED_LENGTH];
    (void)snprintf(out, APP_DEMO_TEXT, "log:%s,loop=1", recording);
    return installed_data(path, recording);
}

uint32_t app_openings(app *self, input_opening out[INPUT_OPENINGS_MAX])
{
    return input_opener_going(self->inputs, out);
}

void app_give_up_opening(app *self, uint64_t id)
{
    input_opener_give_up(self->inputs, id);
}

const char *app_opening_trouble(const app *self)
{
    return self->input_trouble.text;
}

/* ---- parts of the application ---- */

const plugin_list *app_plugins(app *self)
{
    return &self->plugins;
}

log_queue *app_log(app *self)
{
    return self->log;
}

live *app_live(app *self)
{
    return self->live;
}

const live_view *app_view(const app *self)
{
    return self->view;
}

const live_status *app_status(const app *self)
{
    return &self->status;
}

const face_file *app_face(const app *self)
{
    return self->face;
}

const char *app_face_path(const app *self)
{
    return self->face_path;
}

double app_face_unit_mm(const app *self)
{
    return self->face_unit_mm;
}

show *app_show(app *self)
{
    return self->show;
}

settings *app_settings(app *self)
{
    return self->settings;
}

news_list *app_news(app *self)
{
    return self->news;
}

app_choice *app_chosen(app *self)
{
    return &self->takes.choice;
}

struct pose_palette *app_poses(app *self)
{
    return self->poses;
}

struct kept_life *app_life(app *self)
{
    return self->life;
}

void app_ask(app *self, app_call of)
{
    self->is_called[of] = true;
}

bool app_take_call(app *self, app_call of)
{
    const bool was_asked = self->is_called[of];
    self->is_called[of] = false;
    return was_asked;
}

app_notes *app_notes_of(app *self)
{
    return &self->notes;
}

struct viewport *app_viewport(app *self)
{
    return self->viewport;
}

void app_set_viewport(app *self, struct viewport *v)
{
    self->viewport = v;
}

void app_set_unsaved(app *self, const app_unsaved *unsaved)
{
    self->has_unsaved = unsaved != NULL;
    if (unsaved)
        self->unsaved = *unsaved;
}

const app_unsaved *app_unsaved_now(const app *self)
{
    return self->has_unsaved ? &self->unsaved : NULL;
}

mrt_result app_export_take(app *self, int64_t id, const export_request *request)
{
    error err = {0};
    if (!id || !self->show)
        return app_report(self, error_set(&err, MRT_ERR_ARGUMENT, "select the take to export"),
                          &err);
    const mrt_result result =
        exporter_begin(self->exports, show_path(self->show), id, self->face_path, request, &err);
    if (result >= 0)
        app_say(self, MRT_LOG_INFO, "exporting %s", request->file);
    return app_report(self, result, &err);
}

exporter *app_exporter(const app *self)
{
    return self->exports;
}

/* ---- pulls that stay on the live face, as undo steps: a pull with Shift, clay, releasing them
 * ---- */

/* Returns the current pulls, which the caller frees. NULL: an error, which is reported. */
static app_pulled *save_pulled(app *self)
{
    error err = {0};
    void *bytes = NULL;
    size_t size = 0;
    mrt_result result = live_save_pulled(self->live, &bytes, &size, &err);
    app_pulled *out = result >= 0 ? malloc(sizeof *out + size) : NULL;
    if (result >= 0 && !out)
        result = error_set(&err, MRT_ERR_MEMORY, "no memory for undo");
    if (out) {
        *out = (app_pulled){.size = size, .is_held = self->pulls.is_held};
        memcpy(out->bytes, bytes, size);
    }
    free(bytes);
    app_reported(app_report(self, result, &err));
    return out;
}

static mrt_result set_pulled(void *owner, const void *value)
{
    app *self = owner;
    const app_pulled *to = value;
    error err = {0};
    if (!to)
        return MRT_ERR_MEMORY; /* reported when it could not be saved */
    mrt_result result = live_load_pulled(self->live, to->bytes, to->size, &err);
    if (result >= 0)
        self->pulls.is_held = to->is_held;
    return app_report(self, result, &err);
}

void app_save_pulled(app *self, undo_change *of)
{
    if (of->set == set_pulled)
        of->after = save_pulled(self);
}

static void begin_pull(app *self)
{
    free(self->pulls.begun);
    self->pulls.begun = save_pulled(self);
}

/* The value after is saved when it is needed, by undo: saving waits for the frame thread. */
static void end_pull(app *self, const char *words)
{
    app_pulled *before = self->pulls.begun;
    self->pulls.begun = NULL;
    if (!before)
        return;
    undo_change made = {.owner = self,
                        .set = set_pulled,
                        .before = before,
                        .bytes = 2 * (sizeof *before + before->size)};
    (void)snprintf(made.words, sizeof made.words, "%s", words);
    undo_list_add(self->undo.list, &made);
}

static void clear_pulls(app *self)
{
    if (self->pulls.is_held)
        begin_pull(self);
    live_neutral(self->live);
    if (self->pulls.is_held)
        end_pull(self, "release all held pulls");
    self->pulls.is_held = false;
}

void app_forget_pulls(app *self)
{
    app_forget_pulled(self);
    free(self->pulls.begun);
    self->pulls.begun = NULL;
    self->pulls.is_held = false;
}

bool app_is_held(const app *self)
{
    return self->pulls.is_held;
}

uint32_t app_pull_count(const app *self)
{
    return self->pulls.count;
}

void app_begin_pull(app *self)
{
    self->pulls.count += 1;
    begin_pull(self);
}

void app_hold(app *self, const char *words)
{
    end_pull(self, words);
    self->pulls.is_held = true;
}

void app_clear_pulls(app *self)
{
    if (self->pulls.is_held)
        clear_pulls(self);
}

/* ---- actions: whether each is possible now, and its function ---- */

static const char *why_no_record(const app *self)
{
    if (self->status.is_recording || self->status.can_record)
        return NULL;
    return self->status.why_not[0] ? self->status.why_not : "recording is not possible now";
}

static const char *why_no_keep(const app *self)
{
    const char *why = why_no_record(self);
    if (why)
        return why;
    return self->status.journal_ns > 0 ? NULL : "nothing was performed yet";
}

static const char *why_no_transport(const app *self, action of)
{
    if (self->status.is_recording)
        return "a take is being recorded: stop it first";
    if (of == ACTION_TAKE_BEFORE || of == ACTION_TAKE_NEXT)
        return self->takes.line_count ? NULL : "there is no take yet";
    if (!self->takes.history)
        return "no take is selected";
    if (of == ACTION_STOP && self->view->mode == LIVE_PERFORMS)
        return "no take is on the stage";
    return NULL;
}

static const char *why_not_moved(const app *self, action of)
{
    const arrangement *at = &self->looks.layouts.now;
    const panel_place place = at->panel[at->current].place;
    if (of == ACTION_PANEL_LEFT && place == PLACE_LEFT)
        return "the panel is in the left dock";
    if (of == ACTION_PANEL_RIGHT && place == PLACE_RIGHT)
        return "the panel is in the right dock";
    if (of == ACTION_PANEL_FLOAT && place == PLACE_FLOATING)
        return "the panel floats";
    return of == ACTION_PANEL_HIDE && place == PLACE_HIDDEN ? "the panel is hidden" : NULL;
}

/* NULL: it can be done. */
static const char *why_not(app *self, action of)
{
    switch (of) {
    case ACTION_RECORD:
        return why_no_record(self);
    case ACTION_KEEP:
        return why_no_keep(self);
    case ACTION_MARK:
        return live_shown_take(self->live) ? app_edit_why_not(self, of) : why_no_record(self);
    case ACTION_LIVE:
        return self->view->mode == LIVE_PERFORMS && !self->takes.chosen
                   ? "the live hands are on the stage"
                   : NULL;
    case ACTION_SOUND_ARM:
        return self->status.is_recording ? "a take is being recorded: stop it first" : NULL;
    case ACTION_UNDO:
        return app_undo_why_not(self);
    case ACTION_REDO:
        return app_can_redo(self) ? NULL : "nothing to redo";
    case ACTION_EXPORT:
        return self->takes.line_count ? NULL : "there is no take yet";
    case ACTION_NONE:
    case ACTION_COUNT:
        return "";
    default:
        break;
    }
    if (of >= ACTION_PANEL_LEFT && of <= ACTION_PANEL_HIDE)
        return why_not_moved(self, of);
    const action_group group = action_of(of)->group;
    if (group == ACTION_TRANSPORT)
        return why_no_transport(self, of);
    return group == ACTION_EDIT ? app_edit_why_not(self, of) : NULL;
}

bool app_can(app *self, action of, const char **out_why_not)
{
    const char *why = why_not(self, of);
    if (out_why_not)
        *out_why_not = why ? why : "";
    return why == NULL;
}

/* ---- doing ---- */

static void arm_sound(app *self)
{
    error err = {0};
    if (self->status.is_sound_armed)
        live_disarm_sound(self->live);
    else
        (void)app_report(self, live_arm_sound(self->live, 1, &err), &err);
}

#define KEEP_NS        (30 * NS_PER_S)
#define NEUTRAL_FADE_S 0.25 /* as the stage's own */

static void do_performance(app *self, action of)
{
    switch (of) {
    case ACTION_RECORD:
        app_record_toggle(self);
        break;
    case ACTION_KEEP:
        app_keep(self, clock_now_ns() - KEEP_NS, clock_now_ns());
        break;
    case ACTION_MARK:
        app_mark(self);
        break;
    case ACTION_NEUTRAL:
        pose_palette_release_all(self->poses, NEUTRAL_FADE_S);
        clear_pulls(self);
        break;
    case ACTION_REZERO:
        live_rezero(self->live);
        break;
    case ACTION_LIVE:
        if (!live_shown_take(self->live))
            app_reported(app_choose_take(self, 0));
        else
            live_show_hands(self->live);
        break;
    case ACTION_HAND_KEYS:
        self->has_hand_keys = !self->has_hand_keys;
        break;
    case ACTION_LIFE:
        kept_life_toggle(self->life);
        break;
    default:
        break;
    }
}

static void arrange(app *self, action of)
{
    static const panel_place place[] = {PLACE_LEFT, PLACE_RIGHT, PLACE_FLOATING, PLACE_HIDDEN};
    kept_layouts *layouts = &self->looks.layouts;
    self->looks.is_face_only = false;
    if (of <= ACTION_PANEL_HIDE)
        arrangement_move(&layouts->now, layouts->now.current, place[of - ACTION_PANEL_LEFT],
                         APP_PANELS);
    else if (of <= ACTION_LAYOUT_RIG)
        kept_layouts_switch(layouts, self->settings, (app_layout)(of - ACTION_LAYOUT_PERFORM));
    else if (of == ACTION_LAYOUT_RESET)
        kept_layouts_reset(layouts);
    else
        kept_layouts_use_for_new(layouts, self->settings);
}

static void do_look(app *self, action of)
{
    app_looks *looks = &self->looks;
    bool *value = app_look_switch(self, of);
    if (value) {
        *value = !*value;
        if (of == ACTION_TIMELINE && *value)
            looks->is_face_only = false;
    } else if (of == ACTION_HEAT_NEXT) {
        looks->heat = (app_heat)((looks->heat + 1) % APP_HEATS);
    } else if (of >= ACTION_PANEL_DEVICES && of < ACTION_PANEL_DEVICES + (int)APP_PANELS) {
        arrangement_show(&looks->layouts.now, (app_panel)(of - ACTION_PANEL_DEVICES));
        looks->is_face_only = false;
    } else if (of >= ACTION_PANEL_LEFT && of <= ACTION_LAYOUT_KEEP) {
        arrange(self, of);
    } else if (of == ACTION_NEW) {
        app_reported(app_new_show(self));
    } else if (of == ACTION_QUIT) {
        self->wants_to_quit = true;
    } else {
        self->asked[of] = true;
    }
}

void app_do(app *self, action of)
{
    const char *why = "";
    if (!app_can(self, of, &why)) {
        if (why[0])
            app_say(self, MRT_LOG_INFO, "%s: %s", action_of(of)->title, why);
        return;
    }
    if (of == ACTION_UNDO)
        app_reported(app_undo(self));
    else if (of == ACTION_REDO)
        app_reported(app_redo(self));
    else if (of == ACTION_SOUND_ARM)
        arm_sound(self);
    else if (of == ACTION_EXPORT)
        self->asked[of] = true;
    else if (of == ACTION_DUPLICATE)
        app_reported(app_duplicate_take(self, self->takes.chosen));
    else if (action_of(of)->group == ACTION_PERFORMANCE)
        do_performance(self, of);
    else if (action_of(of)->group == ACTION_TRANSPORT)
        app_play_do(self, of);
    else if (action_of(of)->group == ACTION_EDIT)
        app_edit_do(self, of);
    else
        do_look(self, of);
}

bool app_take_request(app *self, action of)
{
    const bool was_asked = self->asked[of];
    self->asked[of] = false;
    return was_asked;
}

bool app_wants_to_quit(const app *self)
{
    return self->wants_to_quit;
}

void app_stay(app *self)
{
    self->wants_to_quit = false;
}

bool app_has_hand_keys(const app *self)
{
    return self->has_hand_keys;
}
