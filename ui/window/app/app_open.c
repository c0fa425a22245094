#include "window/app/app_shared.h"
#include "window/app/open_recent.h"
#include "base/installed.h"
#include "window/gui/theme.h"
#include "window/app/presets.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/text.h"
#include "show/pack.h"
#include "show/sound_file.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- what is kept between runs: how things are shown, what was open, what performed ---- */

#define WRITE_EVERY_S 4.0

/* The switches of the looks: the action of each, and the key of the settings that keeps it; NULL:
 * it is not kept. So the output window stays closed at a start: a person switches a projector on.
 */
static const struct look_switch {
    action of; /* ACTION_NONE: another widget does */
    size_t offset;
    const char *key;
    bool initial;
} switches[] = {
    {ACTION_SHOW_HANDS, offsetof(app_looks, shows_hands), "looks.hands", true},
    {ACTION_SHOW_VECTORS, offsetof(app_looks, shows_vectors), "looks.vectors", false},
    {ACTION_SHOW_SUPPORTS, offsetof(app_looks, shows_supports), "looks.supports", false},
    {ACTION_SHOW_CONTACTS, offsetof(app_looks, shows_contacts), "looks.contacts", false},
    {ACTION_SHOW_JAW, offsetof(app_looks, shows_jaw), "looks.jaw", false},
    {ACTION_SHOW_CARD, offsetof(app_looks, shows_card), "looks.card", false},
    {ACTION_VIEW_MIRROR, offsetof(app_looks, is_mirrored), "looks.mirrored", true},
    {ACTION_VIEW_TURNTABLE, offsetof(app_looks, is_turning), "looks.turning", false},
    {ACTION_FACE_ONLY, offsetof(app_looks, is_face_only), "looks.face_only", false},
    {ACTION_TIMELINE, offsetof(app_looks, layouts.now.has_timeline), NULL, true},
    {ACTION_SNAP, offsetof(app_looks, is_snapping), "looks.snap", true},
    {ACTION_RIPPLE, offsetof(app_looks, is_rippling), "looks.ripple", false},
    {ACTION_OUTPUT, offsetof(app_looks, has_output), NULL, false},
    {ACTION_OUTPUT_MIRROR, offsetof(app_looks, is_output_mirrored), "looks.output_mirrored", false},
    {ACTION_HELP, offsetof(app_looks, is_helping), NULL, false},
    {ACTION_NONE, offsetof(app_looks, theme.is_light), "looks.light", false},
    {ACTION_NONE, offsetof(app_looks, theme.is_colour_safe), "looks.colour_safe", false},
};
enum { SWITCHES = sizeof switches / sizeof switches[0] };

static const struct look_number {
    const char *key;
    size_t offset;
    double initial, least, most;
} numbers[] = {
    {"looks.takes_width", offsetof(app_looks, takes_width), 0.0, 0.0, 2000.0},
    {"looks.text_size", offsetof(app_looks, text_size), 1.0, 0.8, 2.0},
};
enum { NUMBERS = sizeof numbers / sizeof numbers[0] };

static bool *switch_at(app_looks *looks, const struct look_switch *one)
{
    return (bool *)(void *)((char *)looks + one->offset);
}

static float *number_at(app_looks *looks, const struct look_number *one)
{
    return (float *)(void *)((char *)looks + one->offset);
}

bool *app_look_switch(app *self, action of)
{
    for (uint32_t i = 0; i < SWITCHES; ++i)
        if (of != ACTION_NONE && switches[i].of == of)
            return switch_at(&self->looks, &switches[i]);
    return NULL;
}

void app_looks_read(app *self)
{
    const settings *from = self->settings;
    app_looks *looks = &self->looks;
    for (uint32_t i = 0; i < SWITCHES; ++i)
        if (switches[i].key)
            *switch_at(looks, &switches[i]) =
                settings_number(from, switches[i].key, switches[i].initial) != 0.0;
    for (uint32_t i = 0; i < NUMBERS; ++i) {
        const double kept = settings_number(from, numbers[i].key, numbers[i].initial);
        *number_at(looks, &numbers[i]) =
            (float)(kept >= numbers[i].least && kept <= numbers[i].most ? kept
                                                                        : numbers[i].initial);
    }
    kept_layouts_read(&looks->layouts, from, NULL);
    key_map_read(&looks->keys, from);
}

app_looks *app_looks_of(app *self)
{
    return &self->looks;
}

static void keep_looks(app *self)
{
    settings *to = self->settings;
    app_looks *looks = &self->looks;
    for (uint32_t i = 0; i < SWITCHES; ++i)
        if (switches[i].key)
            settings_set_number(to, switches[i].key, *switch_at(looks, &switches[i]) ? 1.0 : 0.0);
    for (uint32_t i = 0; i < NUMBERS; ++i)
        settings_set_number(to, numbers[i].key, (double)*number_at(looks, &numbers[i]));
    kept_layouts_write(&looks->layouts, to);
    key_map_keep(&looks->keys, to);
}

static void keep_mapping(app *self)
{
    char text[PRESET_MAPPING];
    presets_mapping_text(live_mapping(self->live), text, sizeof text);
    settings_set_text(self->settings, "last.mapping", text[0] ? text : self->resting);
}

/* Whether a plugin of the list gives this input: the program's own (feed.h) are not kept. */
static bool can_be_opened_again(app *self, const char *text)
{
    char name[128];
    const mrt_plugin_type *type;
    error ignored;
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":,"), text);
    return plugin_list_find(&self->plugins, name, MRT_INPUT, &type, &ignored) >= 0;
}

static void keep_inputs(app *self)
{
    const char *kept[INPUT_OPENER_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < live_input_count(self->live) && count < INPUT_OPENER_MAX; ++i)
        if (can_be_opened_again(self, live_input_text(self->live, i)))
            kept[count++] = live_input_text(self->live, i);
    settings_set_list(self->settings, "inputs", kept, count, INPUT_OPENER_MAX);
}

static void note_settings(app *self)
{
    keep_looks(self);
    if (self->live) {
        keep_mapping(self);
        app_keep_range(self);
        if (input_opener_are_done(self->inputs))
            keep_inputs(self);
    }
}

/* An error goes to stderr, as the window is gone. */
void app_keep_settings_last(app *self)
{
    error err = {0};
    note_settings(self);
    if (settings_write_last(self->settings, &err) < 0 && !self->saving.has_failed)
        fprintf(stderr, "marotte: %s\n", err.text);
}

/* Once a frame; writes the settings every WRITE_EVERY_S. */
void app_keep_settings(app *self, double dt_s)
{
    self->saving.wait_s += dt_s;
    if (self->saving.wait_s < WRITE_EVERY_S)
        return;
    error err = {0};
    self->saving.wait_s = 0.0;
    note_settings(self);
    const mrt_result result = settings_write(self->settings, &err);
    if (result < 0 && !self->saving.has_failed)
        (void)app_report(self, result, &err);
    self->saving.has_failed = result < 0;
}

/* ---- how the surface is solved: kept with the show ---- */

/* What the show says of it. */
static void read_solver(app *self)
{
    error err = {0};
    if (kept_solver_read(&self->solver, self->show, &err) < 0)
        app_say(self, MRT_LOG_WARNING, "%s", err.text);
}

kept_scenery *app_scenery(const app *self)
{
    return self->scenery;
}

const csrbf_settings *app_solver(const app *self)
{
    return self->solver.is_kept ? &self->solver.as : NULL;
}

mrt_result app_set_solver(app *self, const csrbf_settings *solver, error *err)
{
    mrt_result result = live_set_solver(self->live, solver, err);
    if (result < 0)
        return result;
    self->solver.is_kept = solver != NULL;
    if (solver)
        self->solver.as = *solver;
    if (!self->show || !show_is_writable(self->show))
        return MRT_OK;
    return kept_solver_write(self->show, &self->solver, err);
}

/* ---- what is opened: at the start, and when somebody asks ---- */

#define DEFAULT_MAPPING "one_hand"
#define DEFAULT_FACE    "puppet"

static bool exists(const char *path)
{
    return access(path, F_OK) == 0;
}

/* ---- shows ---- */

static mrt_result open_or_make(show **out, const char *path, error *err)
{
    return exists(path) ? show_open(out, path, SHOW_RECORD, err) : show_create(out, path, err);
}

/* Writes a path in the folder for shows, named by today's date; number 2: "2026-11-28-2.marotte".
 * Creates the folder. */
static mrt_result today_path(char *out, size_t capacity, uint32_t number, error *err)
{
    char day[24], name[48];
    struct tm now;
    const time_t seconds = time(NULL);
    if (!localtime_r(&seconds, &now) || strftime(day, sizeof day, "%Y-%m-%d", &now) == 0)
        (void)snprintf(day, sizeof day, "show");
    if (number > 1)
        (void)snprintf(name, sizeof name, "%s-%u.marotte", day, number);
    else
        (void)snprintf(name, sizeof name, "%s.marotte", day);
    const mrt_result result = file_home_path(out, capacity, FILE_HOME_DOCUMENTS, name, err);
    return result < 0 ? result : file_make_parent(out, err);
}

/* Today's show. */
static mrt_result make_show(show **out, error *err)
{
    char path[APP_PATH];
    const mrt_result result = today_path(path, sizeof path, 1, err);
    return result < 0 ? result : open_or_make(out, path, err);
}

/* After a show has been opened: keeps its path, and reports its notices. */
static void begin_show(app *self)
{
    error err = {0};
    char *real = self->show ? realpath(show_path(self->show), NULL) : NULL;
    if (self->show && show_is_writable(self->show))
        (void)app_report(self, edit_store_add_recovered_marks(self->show, clock_utc_ms, &err),
                         &err);
    if (real)
        settings_set_text(self->settings, "last.show", real);
    kept_layouts_write(&self->looks.layouts, self->settings); /* of the show before */
    kept_layouts_read(&self->looks.layouts, self->settings, real);
    free(real);
    if (self->show && show_notice(self->show)[0])
        app_say(self, MRT_LOG_WARNING, "%s", show_notice(self->show));
    if (self->show && !show_is_writable(self->show))
        app_say(self, MRT_LOG_INFO, "use Save as to record into a copy");
}

/* A show named by the user must open. Otherwise opens the last show, or creates one. Without a show
 * the stage performs but does not record. */
static mrt_result open_first_show(app *self, const char *path, error *err)
{
    const char *last = settings_text(self->settings, "last.show", NULL);
    error why = {0};
    if (path) {
        mrt_result result = open_or_make(&self->show, path, err);
        if (result >= 0)
            begin_show(self);
        return result;
    }
    if (last && exists(last) && show_open(&self->show, last, SHOW_RECORD, &why) < 0)
        (void)app_report(self, MRT_ERR_IO, &why);
    if (!self->show && make_show(&self->show, &why) < 0)
        (void)app_report(self, MRT_ERR_IO, &why);
    begin_show(self);
    return MRT_OK;
}

static void perform_as_show_says(app *self)
{
    error err = {0};
    const bool had_own = app_solver(self) != NULL;
    read_solver(self);
    kept_scenery_read(self->scenery);
    kept_life_read(self->life);
    if (had_own || app_solver(self))
        (void)app_report(self, live_set_solver(self->live, app_solver(self), &err), &err);
}

mrt_result app_open_show(app *self, const char *path)
{
    error err = {0};
    show *opened = NULL;
    if (self->show && show_is_writable(self->show) && show_is_file(self->show, path)) {
        app_say(self, MRT_LOG_INFO, "%s is already open", path);
        return MRT_OK;
    }
    mrt_result result = open_or_make(&opened, path, &err);
    if (result < 0)
        return app_report(self, result, &err);
    app_drop_audio(self);
    app_drop_speech(self);
    app_drop_sync(self);
    app_record_finish_over(self);
    app_drop_take(self);
    app_forget_takes(self);
    self->awaited.take = 0;
    result = live_set_show(self->live, opened, &err);
    if (result < 0) { /* back to the one before */
        error again = {0};
        (void)app_report(self, result, &err);
        (void)app_report(self, live_set_show(self->live, self->show, &again), &again);
        show_close(opened);
        self->takes.are_stale = true;
        return result;
    }
    show *before = self->show;
    self->show = opened;
    self->takes.are_stale = true;
    self->recording.was_recording = false;
    begin_show(self);
    perform_as_show_says(self);
    self->recording.had_problem = false;
    app_say(self, MRT_LOG_INFO, "%s is open", path);
    (void)app_close_show(self, before); /* the log reports the result */
    return MRT_OK;
}

mrt_result app_new_show(app *self)
{
    char path[APP_PATH];
    error err = {0};
    for (uint32_t number = 1;; ++number) {
        const mrt_result result = today_path(path, sizeof path, number, &err);
        if (result < 0)
            return app_report(self, result, &err);
        if (!exists(path))
            return app_open_show(self, path);
    }
}

/* ---- under another name ---- */

/* Copies the show and the faces that are packed beside it, on a thread of its own. */
typedef struct show_copier {
    char *from, *to;
    pthread_t thread;
    atomic_bool has_ended;
    mrt_result result; /* once it has ended, as the error */
    error err;
} show_copier;

static mrt_result copy_faces(show *of, const char *to, error *err)
{
    int64_t *id = NULL;
    size_t count = 0;
    mrt_result result = show_performance_ids(of, &id, &count, err);
    for (size_t i = 0; i < count && result >= 0; ++i) {
        show_performance one = {0};
        result = show_performance_read(of, id[i], &one, err);
        if (result >= 0)
            result = pack_copy(show_path(of), to, &one.performance, err);
        show_performance_finish(&one);
    }
    free(id);
    return result < 0 ? result : MRT_OK;
}

static void *copy(void *data)
{
    show_copier *self = data;
    show *of = NULL;
    mrt_result result = show_open(&of, self->from, SHOW_READ, &self->err);
    if (result >= 0)
        result = show_rescue(of, self->to, &self->err);
    if (result >= 0) {
        result = copy_faces(of, self->to, &self->err);
        if (result < 0)
            (void)unlink(self->to);
    }
    show_close(of);
    self->result = result;
    atomic_store(&self->has_ended, true);
    return NULL;
}

static void free_copier(show_copier *self)
{
    if (!self)
        return;
    free(self->from);
    free(self->to);
    free(self);
}

void app_drop_copy(app *self)
{
    if (self->copier)
        (void)pthread_join(self->copier->thread, NULL);
    free_copier(self->copier);
    self->copier = NULL;
}

/* Of what is committed now. */
mrt_result app_save_show_as(app *self, const char *path, error *err)
{
    if (!self->show)
        return error_set(err, MRT_ERR_ARGUMENT, "no show is open");
    if (self->status.is_recording || self->awaited.take)
        return error_set(err, MRT_ERR_ARGUMENT, "a take is being recorded: stop it first");
    if (self->copier)
        return error_set(err, MRT_ERR_ARGUMENT, "the show is already being saved");
    if (exists(path))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "%s already exists. A show is never overwritten: choose another name",
                         path);
    show_copier *copier = calloc(1, sizeof *copier);
    if (copier) {
        copier->from = strdup(show_path(self->show));
        copier->to = strdup(path);
    }
    if (copier && copier->from && copier->to &&
        pthread_create(&copier->thread, NULL, copy, copier) == 0) {
        self->copier = copier;
        return MRT_OK;
    }
    free_copier(copier);
    return error_set(err, MRT_ERR_MEMORY, "no memory to copy the show");
}

/* Opens the copy once it is complete, with the same take chosen. A recording that goes on is
 * finished before. */
void app_follow_copy(app *self)
{
    char path[APP_PATH];
    show_copier *copier = self->copier;
    if (!copier || self->status.is_recording || self->awaited.take ||
        !atomic_load(&copier->has_ended))
        return;
    (void)snprintf(path, sizeof path, "%s", copier->to);
    const int64_t chosen = self->takes.chosen;
    mrt_result result = app_report(self, copier->result, &copier->err);
    app_drop_copy(self);
    const kept_layouts layouts = self->looks.layouts;
    if (result >= 0)
        result = app_open_show(self, path);
    if (result >= 0)
        kept_layouts_copy(&self->looks.layouts, self->settings, &layouts);
    if (result >= 0 && chosen)
        app_reported(app_select_take(self, chosen));
}

/* ---- sound from a file ---- */

/* Reads the sound of a file into the open show, on a thread of its own. */
typedef struct audio_import {
    show *into; /* its own */
    char *path;
    pthread_t thread;
    _Atomic bool is_given_up, has_ended;
    _Atomic uint32_t thousandths;
    int64_t audio; /* once it has ended, as the result and the error */
    mrt_result result;
    error err;
} audio_import;

static bool goes_on(void *data, double part)
{
    audio_import *self = data;
    atomic_store(&self->thousandths, (uint32_t)(part * 1000.0));
    return !atomic_load(&self->is_given_up);
}

static void *import(void *data)
{
    audio_import *self = data;
    const sound_file_watch watch = {goes_on, self};
    self->result = sound_file_import(&self->audio, self->into, self->path, &watch, &self->err);
    atomic_store(&self->has_ended, true);
    return NULL;
}

static void audio_import_free(audio_import *self)
{
    show_close(self->into);
    free(self->path);
    free(self);
}

static mrt_result audio_import_begin(audio_import **out, show *into, const char *path, error *err)
{
    *out = NULL;
    audio_import *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to read %s", path);
    self->path = strdup(path);
    mrt_result result = show_join(&self->into, into, err);
    if (result >= 0 && (!self->path || pthread_create(&self->thread, NULL, import, self) != 0))
        result = error_set(err, MRT_ERR_MEMORY, "no memory to read %s", path);
    if (result < 0) {
        audio_import_free(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

mrt_result app_attach_voice(app *self, const char *path)
{
    error err = {0};
    mrt_result result = MRT_OK;
    if (!app_take(self) || !show_is_writable(self->show))
        result = error_set(&err, MRT_ERR_ARGUMENT,
                           "select the take that the voice belongs to, then open it again");
    else if (self->audio.import)
        result = error_set(&err, MRT_ERR_ARGUMENT,
                           "another voice is being read: wait until it is finished");
    if (result >= 0)
        result = audio_import_begin(&self->audio.import, self->show, path, &err);
    self->audio.take = self->takes.chosen;
    return app_report(self, result, &err);
}

double app_voice_part(const app *self)
{
    return self->audio.import ? 1e-3 * (double)atomic_load(&self->audio.import->thousandths) : -1.0;
}

/* Cancels a running import, and removes it from the show. */
void app_drop_audio(app *self)
{
    audio_import *job = self->audio.import;
    if (!job)
        return;
    atomic_store(&job->is_given_up, true);
    (void)pthread_join(job->thread, NULL);
    audio_import_free(job);
    self->audio.import = NULL;
}

/* Does not disturb recording or playback. */
void app_follow_audio(app *self)
{
    edit e;
    if (!self->audio.import || self->status.is_recording || self->recording.over_take ||
        self->awaited.take || !atomic_load(&self->audio.import->has_ended))
        return;
    edit_init(&e, EDIT_AUDIO_ATTACH);
    e.audio = self->audio.import->audio;
    const mrt_result result =
        app_report(self, self->audio.import->result, &self->audio.import->err);
    if (result < 0)
        open_recent_remove(self->settings, self->audio.import->path);
    app_drop_audio(self);
    if (result < 0)
        return;
    if (self->takes.chosen != self->audio.take && app_pick_take(self, self->audio.take) < 0)
        return;
    app_reported(app_edit(self, &e));
    edit_finish(&e);
}

void app_set_rig_saver(app *self, const app_rig_saver *saver)
{
    self->rig_saver = saver ? *saver : (app_rig_saver){.owner = NULL};
}

const char *app_rig_path(const app *self)
{
    return self->rig_saver.path ? self->rig_saver.path(self->rig_saver.owner) : NULL;
}

mrt_result app_save_rig_as(app *self, const char *path, error *err)
{
    if (!app_rig_path(self))
        return error_set(err, MRT_ERR_ARGUMENT, "the face has no rig to save");
    return self->rig_saver.save_as(self->rig_saver.owner, path, err);
}

/* ---- faces ---- */

static void free_face(face_file *made)
{
    face_file_destroy(made);
    free(made);
}

static mrt_result read_face(face_file **out, const char *path, const mesh_frame *frame, error *err)
{
    *out = calloc(1, sizeof **out);
    mrt_result result = *out ? face_file_read(*out, path, frame, FACE_FILE_USABLE, err)
                             : error_set(err, MRT_ERR_MEMORY, "no memory for the face");
    if (result >= 0)
        return MRT_OK;
    free(*out);
    *out = NULL;
    return result;
}

/* An installed face of that name, else the path as given; to be freed. NULL: no memory. */
static char *path_of_face(const char *given)
{
    char *found = installed_path(INSTALLED_FACE, given),
         *real = found ? realpath(found, NULL) : NULL;
    free(found);
    return real ? real : strdup(given);
}

/* Copies the path of a face that a show or the settings keep, if it is still there; else "". */
static void find_kept_face(char out[APP_PATH], const char *path)
{
    char *found = path[0] ? installed_kept_face(path) : NULL;
    const bool is_usable = found && strlen(found) < APP_PATH && exists(found);
    (void)snprintf(out, APP_PATH, "%s", is_usable ? found : "");
    free(found);
}

/* Tells a single note; of several only how many, as the rig panel lists them. */
static void tell_face(app *self)
{
    uint32_t lines = 0;
    for (const char *c = self->face->note; c && *c; ++c)
        lines += *c == '\n';
    if (lines == 1)
        app_say(self, MRT_LOG_INFO, "%.*s", (int)strcspn(self->face->note, "\n"), self->face->note);
    else if (lines > 1)
        app_say(self, MRT_LOG_INFO, "the face has %u notes: see the rig panel", lines);
}

/* Remembers the mapping that does not fit the face, and reports the reason and the mappings that
 * fit. */
static void rest(app *self, const face_file *made, const char *mapping, const error *why)
{
    char names[400];
    (void)snprintf(self->resting, sizeof self->resting, "%s", mapping);
    live_list_fitting(self->live, names, sizeof names);
    app_say(self, made->rig ? MRT_LOG_ERROR : MRT_LOG_INFO,
            "%s. The face stays neutral. Mappings that fit it: %s",
            made->rig ? why->text : "This face has no rig yet", names[0] ? names : "none");
}

/* After a change of the face or its rig: the mapping that did not fit before is tried again, unless
 * another has been chosen. */
static void perform_again(app *self)
{
    error ignored = {0};
    if (self->resting[0] &&
        (live_mapping(self->live) || live_set_mapping(self->live, self->resting, &ignored) >= 0))
        self->resting[0] = '\0';
}

void app_ask_draft(app *self)
{
    app_ask(self, APP_CALL_DRAFT);
    if (!self->resting[0]) /* no mapping is waiting for a rig: the draft gets the default one */
        (void)snprintf(self->resting, sizeof self->resting, "%s", DEFAULT_MAPPING);
}

/* Where the mapping does not fit the face, the face is shown without one, at rest. */
static mrt_result set_face_or_rest(app *self, const face_file *made, const char *path, error *err)
{
    char mapping[PRESET_MAPPING];
    error again = {0};
    mrt_result result = live_set_face(self->live, made, path, self->face_unit_mm, err);
    presets_mapping_text(live_mapping(self->live), mapping, sizeof mapping);
    if (result >= 0 || !mapping[0] || live_set_mapping(self->live, "", &again) < 0)
        return result;
    if (live_set_face(self->live, made, path, self->face_unit_mm, &again) >= 0) {
        rest(self, made, mapping, err);
        return MRT_OK;
    }
    app_reported(live_set_mapping(self->live, mapping, &again)); /* it was not the mapping */
    return result;
}

/* Puts the face on the stage. Takes `made` over, also on an error. */
static mrt_result put_face(app *self, face_file *made, const char *path, double unit_mm)
{
    error err = {0};
    const double before_mm = self->face_unit_mm;
    self->face_unit_mm = made->rig ? 0.0 : unit_mm;
    char *name = strdup(path);
    mrt_result result = name ? set_face_or_rest(self, made, path, &err)
                             : error_set(&err, MRT_ERR_MEMORY, "no memory for the face");
    if (result < 0) {
        self->face_unit_mm = before_mm;
        free(name);
        free_face(made);
        return app_report(self, result, &err);
    }
    free_face(self->face);
    free(self->face_path); /* may be `path` */
    self->face = made;
    self->face_path = name;
    settings_set_text(self->settings, "last.face", name);
    perform_again(self);
    return MRT_OK;
}

/* frame NULL: as the file says, or its shape. */
static mrt_result open_face(app *self, const char *path, const mesh_frame *frame)
{
    error err = {0};
    face_file *made = NULL;
    const mrt_result result = read_face(&made, path, frame, &err);
    return result < 0 ? app_report(self, result, &err)
                      : put_face(self, made, path, frame ? frame->mm_per_unit : 0.0);
}

mrt_result app_open_face(app *self, const char *given)
{
    char *path = path_of_face(given);
    const mrt_result result = open_face(self, path ? path : given, NULL);
    free(path);
    if (result >= 0) {
        app_forget_pulls(self);
        tell_face(self);
    }
    return result;
}

mrt_result app_set_face_frame(app *self, const mesh_frame *frame)
{
    return open_face(self, self->face_path, frame);
}

mrt_result app_change_face(app *self, face_file *made)
{
    face_file *own = malloc(sizeof *own);
    error err = {0};
    if (!own) {
        face_file_destroy(made);
        return app_report(self, error_set(&err, MRT_ERR_MEMORY, "no memory for the face"), &err);
    }
    *own = *made;
    *made = (face_file){0};
    return put_face(self, own, self->face_path, self->face_unit_mm);
}

/* ---- the first face, read beside the window and the plugins ---- */

/* Reads a face and binds its rig, so that the stage need not. The stage reports a rig that cannot
 * be bound. */
static mrt_result read_bound_face(face_file **out, const char *path, error *err)
{
    error ignored;
    mrt_result result = read_face(out, path, NULL, err);
    if (result < 0 || !(*out)->rig)
        return result;
    face_file *made = *out;
    made->bound = calloc(1, sizeof *made->bound);
    if (made->bound &&
        binding_create(made->bound, made->rig, &made->mesh, &made->topology, &ignored) < 0) {
        free(made->bound);
        made->bound = NULL;
    }
    return result;
}

struct app_face_ahead {
    char *path;
    pthread_t thread;
    bool is_running;
    face_file *face;
    mrt_result result;
    error err;
};

static void *read_ahead(void *data)
{
    app_face_ahead *self = data;
    self->result = read_bound_face(&self->face, self->path, &self->err);
    return NULL;
}

app_face_ahead *app_face_ahead_start(const char *face_path, const settings *kept)
{
    char last[APP_PATH];
    find_kept_face(last, settings_text(kept, "last.face", ""));
    const char *path = face_path ? face_path : last[0] ? last : DEFAULT_FACE;
    app_face_ahead *self = calloc(1, sizeof *self);
    if (!self)
        return NULL;
    self->path = path_of_face(path);
    self->is_running = self->path && pthread_create(&self->thread, NULL, read_ahead, self) == 0;
    if (self->is_running)
        return self;
    app_face_ahead_destroy(self);
    return NULL;
}

static void join_ahead(app_face_ahead *self)
{
    if (self->is_running)
        (void)pthread_join(self->thread, NULL);
    self->is_running = false;
}

void app_face_ahead_destroy(app_face_ahead *self)
{
    if (!self)
        return;
    join_ahead(self);
    free_face(self->face);
    free(self->path);
    free(self);
}

/* The face at `path`, from the one that was begun ahead if it is that. */
static mrt_result take_face_at(face_file **out, const char *path, app_face_ahead *ahead, error *err)
{
    if (!ahead || strcmp(ahead->path, path) != 0)
        return read_bound_face(out, path, err);
    join_ahead(ahead);
    *err = ahead->err;
    *out = ahead->face;
    ahead->face = NULL;
    return ahead->result;
}

typedef struct face_reading {
    char path[3][APP_PATH]; /* to be tried, the best first; "": none */
    bool must_be_first;     /* it was asked for */
    app_face_ahead *ahead;  /* NULL: none */
    face_file *face;
    char *face_path;
    mrt_result result;
    error err, first_err;
} face_reading;

static void *read_first_face(void *data)
{
    face_reading *self = data;
    self->result = error_set(&self->err, MRT_ERR_IO, "no face was found: choose one with --face");
    for (int i = 0; i < 3; ++i) {
        if (!self->path[i][0])
            continue;
        char *path = path_of_face(self->path[i]);
        self->result = path ? take_face_at(&self->face, path, self->ahead, &self->err)
                            : error_set(&self->err, MRT_ERR_MEMORY, "no memory for the face");
        if (self->result >= 0) {
            self->face_path = path;
            return NULL;
        }
        free(path);
        if (!self->first_err.text[0])
            self->first_err = self->err;
        if (self->must_be_first)
            break;
    }
    return NULL;
}

/* Writes the face of the newest performance of the show; "": none. */
static void face_of_show(app *self, show *s, char out[APP_PATH])
{
    int64_t *ids = NULL;
    size_t count = 0;
    show_performance newest;
    error err = {0};
    out[0] = '\0';
    if (!s || show_performance_ids(s, &ids, &count, &err) < 0)
        return;
    if (count && show_performance_read(s, ids[count - 1], &newest, &err) >= 0) {
        char packed[PATH_MAX];
        const char *path = newest.performance.rig;
        mrt_result result = pack_find(packed, show_path(s), &newest.performance, &err);
        path = result == MRT_OK ? packed : path;
        if (result < 0) /* a pack that does not verify: do not use the recorded path either */
            app_say(self, MRT_LOG_ERROR, "%s", err.text);
        else if (path && (result == MRT_OK || path[0] == '/'))
            find_kept_face(out, path);
        show_performance_finish(&newest);
    }
    free(ids);
}

static void choose_faces(app *self, const app_options *options, face_reading *out)
{
    out->must_be_first = options->face_path != NULL;
    if (options->face_path) {
        (void)snprintf(out->path[0], APP_PATH, "%s", options->face_path);
        return;
    }
    face_of_show(self, self->show, out->path[0]);
    find_kept_face(out->path[1], settings_text(self->settings, "last.face", ""));
    (void)snprintf(out->path[2], APP_PATH, "%s", DEFAULT_FACE);
}

/* ---- the stage ---- */

/* The stage without a mapping, as the wanted one does not fit the face. */
static mrt_result open_at_rest(app *self, live_settings *with, const error *why)
{
    error err = {0};
    const char *mapping = with->mapping;
    with->mapping = "";
    mrt_result result = live_start(&self->live, with, &err);
    if (result >= 0)
        rest(self, self->face, mapping, why);
    return result;
}

static mrt_result start_live(app *self, const char *mapping, error *err)
{
    const char *last = settings_text(self->settings, "last.mapping", DEFAULT_MAPPING);
    live_settings with = {.plugins = &self->plugins,
                          .log = self->log,
                          .show = self->show,
                          .face = self->face,
                          .face_path = self->face_path,
                          .mapping = mapping ? mapping : last,
                          .sound = self->sound,
                          .solver = app_solver(self),
                          .keeps_clay =
                              settings_number(self->settings, "stage.keeps_clay", 0.0) > 0.5,
                          .fps = 60.0,
                          .changed = self->changed};
    error ignored = {0};
    mrt_result result = live_start(&self->live, &with, err);
    if (result >= 0)
        return result;
    const bool is_known = live_check_mapping(&with, with.mapping, &ignored) >= 0;
    if (mapping && !is_known)
        return result;
    if (!is_known) {
        /* The settings name a mapping whose plugin is gone: the usual one instead. */
        (void)app_report(self, result, err);
        with.mapping = DEFAULT_MAPPING;
        result = live_start(&self->live, &with, err);
    }
    if (result >= 0)
        return result;
    return open_at_rest(self, &with, err) < 0 ? result : MRT_OK;
}

/* Plugins named on the command line, after their libraries were loaded: see
 * plugin_list_choose_spec. */
typedef struct chosen {
    char *mapping; /* NULL: none was named */
    char *input[INPUT_OPENER_MAX];
    uint32_t input_count;
} chosen;

static void chosen_finish(chosen *self)
{
    free(self->mapping);
    for (uint32_t i = 0; i < self->input_count; ++i)
        free(self->input[i]);
}

/* Called before the folders are searched: a library named here takes precedence over others with
 * its id. */
static mrt_result choose(app *self, const app_options *options, chosen *out, error *err)
{
    *out = (chosen){NULL, {NULL}, 0};
    for (uint32_t i = 0; i < options->input_count && out->input_count < INPUT_OPENER_MAX; ++i) {
        error why = {0};
        char **one = &out->input[out->input_count];
        if (plugin_list_choose_spec(&self->plugins, options->inputs[i], MRT_INPUT, one, &why) >= 0)
            out->input_count += 1;
        else
            (void)app_report(self, MRT_ERR_ARGUMENT, &why);
    }
    if (!options->mapping)
        return MRT_OK;
    return plugin_list_choose_spec(&self->plugins, options->mapping, MRT_MAPPING, &out->mapping,
                                   err);
}

static void start_inputs(app *self, const app_options *options, const chosen *named)
{
    const char *kept[INPUT_OPENER_MAX];
    uint32_t count = 0;
    error err = {0};
    if (options->inputs) {
        for (; count < named->input_count; ++count)
            kept[count] = named->input[count];
        if (count)
            (void)app_report(self, input_opener_open(self->inputs, kept, count, false, &err), &err);
        return;
    }
    count = settings_list(self->settings, "inputs", kept, INPUT_OPENER_MAX);
    (void)app_report(self, input_opener_open(self->inputs, kept, count, true, &err), &err);
}

static mrt_result load_face_and_plugins(app *self, const app_options *options, error *err)
{
    face_reading reading = {.ahead = options->ahead};
    pthread_t thread;
    choose_faces(self, options, &reading);
    const bool is_beside = pthread_create(&thread, NULL, read_first_face, &reading) == 0;
    mrt_result result = plugin_list_load(&self->plugins, err);
    if (is_beside)
        (void)pthread_join(thread, NULL);
    else
        (void)read_first_face(&reading);
    self->face = reading.face;
    self->face_path = reading.face_path;
    if (result < 0)
        return result;
    if (reading.result < 0 || !self->face_path)
        return error_set(err, reading.result < 0 ? reading.result : MRT_ERR_MEMORY, "%s",
                         reading.first_err.text[0] ? reading.first_err.text : reading.err.text);
    if (reading.first_err.text[0])
        (void)app_report(self, MRT_ERR_IO, &reading.first_err);
    return MRT_OK;
}

/* The show, the face and what else is there at the start. */
mrt_result app_open_first(app *self, const app_options *options, error *err)
{
    chosen named = {NULL, {NULL}, 0};
    mrt_result result = open_first_show(self, options->show_path, err);
    if (result >= 0) {
        read_solver(self);
        kept_scenery_read(self->scenery);
        kept_life_read(self->life);
        result = choose(self, options, &named, err);
    }
    if (result >= 0)
        result = load_face_and_plugins(self, options, err);
    if (result >= 0)
        result = start_live(self, named.mapping, err);
    if (result < 0)
        goto done;
    for (uint32_t i = 0; i < self->plugins.refusal_count; ++i)
        app_say(self, MRT_LOG_INFO, "%s is not loaded: %s", self->plugins.refusal[i].path,
                self->plugins.refusal[i].reason);
    settings_set_text(self->settings, "last.face", self->face_path);
    tell_face(self);
    start_inputs(self, options, &named);
done:
    chosen_finish(&named);
    return result;
}
