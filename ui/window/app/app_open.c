#include "window/app/app_shared.h"
#include "base/installed.h"
#include "window/gui/theme.h"
#include "window/app/presets.h"

#include "base/clock.h"
#include "base/file.h"
#include "stage/perform/patch_file.h"
#include "base/text.h"
#include "stage/take/kept_solver.h"
#include "take/pack.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* ---- what is kept between runs: how things are shown, what was open, what performed ---- */

#define WRITE_EVERY_S 4.0

typedef struct look_switch {
    const char *key;
    size_t offset;
    bool initial;
} look_switch;

/* The output is not opened by itself: a projector is switched on by a person. */
static const look_switch switches[] = {
    {"looks.hands", offsetof(app_looks, shows_hands), true},
    {"looks.vectors", offsetof(app_looks, shows_vectors), false},
    {"looks.supports", offsetof(app_looks, shows_supports), false},
    {"looks.contacts", offsetof(app_looks, shows_contacts), false},
    {"looks.jaw", offsetof(app_looks, shows_jaw), false},
    {"looks.mirrored", offsetof(app_looks, is_mirrored), true},
    {"looks.turning", offsetof(app_looks, is_turning), false},
    {"looks.face_only", offsetof(app_looks, is_face_only), false},
    {"looks.timeline", offsetof(app_looks, has_timeline), true},
    {"looks.output_mirrored", offsetof(app_looks, is_output_mirrored), false},
    {"looks.light", offsetof(app_looks, theme.is_light), false},
    {"looks.colour_safe", offsetof(app_looks, theme.is_colour_safe), false},
};
enum { SWITCHES = sizeof switches / sizeof switches[0] };

static bool *switch_at(app_looks *looks, const look_switch *one)
{
    return (bool *)(void *)((char *)looks + one->offset);
}

static float length_of(const settings *from, const char *key, double otherwise, double most)
{
    const double kept = settings_number(from, key, otherwise);
    return (float)(kept >= 60.0 && kept <= most ? kept : otherwise);
}

static void app_looks_read(app *self)
{
    const settings *from = self->settings;
    app_looks *looks = &self->looks;
    for (uint32_t i = 0; i < SWITCHES; ++i)
        *switch_at(looks, &switches[i]) =
            settings_number(from, switches[i].key, switches[i].initial) != 0.0;
    const double kept = settings_number(from, "looks.panel", APP_DEVICES);
    if (kept >= 0.0 && kept < APP_PANELS)
        looks->panel = (app_panel)kept;
    looks->timeline_height = length_of(from, "looks.timeline_height", 220.0, 2000.0);
    looks->dock_width = length_of(from, "looks.dock_width", (double)THEME_DOCK_WIDTH, 1200.0);
    const double text_size = settings_number(from, "looks.text_size", 1.0);
    looks->text_size = text_size >= 0.8 && text_size <= 2.0 ? (float)text_size : 1.0f;
    key_map_read(&looks->keys, from);
    self->looks_kept = *looks;
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
        settings_set_number(to, switches[i].key, *switch_at(looks, &switches[i]) ? 1.0 : 0.0);
    settings_set_number(to, "looks.panel", (double)looks->panel);
    settings_set_number(to, "looks.timeline_height", (double)looks->timeline_height);
    settings_set_number(to, "looks.dock_width", (double)looks->dock_width);
    key_map_keep(&looks->keys, to);
    settings_set_number(to, "looks.text_size", (double)looks->text_size);
    self->looks_kept = *looks;
}

/* What performs, for live_set_mapping; "": none. */
static void mapping_text(const app *self, char *out, size_t capacity)
{
    char values[PRESET_TEXT];
    const instance *mapping = live_mapping(self->live);
    out[0] = '\0';
    if (!mapping)
        return;
    presets_text(mapping, values, sizeof values);
    (void)snprintf(out, capacity, "%s%s%s", isolate_inner(mapping->type)->id, values[0] ? "," : "",
                   values);
}

static void keep_mapping(app *self)
{
    char text[PRESET_TEXT + 64];
    mapping_text(self, text, sizeof text);
    settings_set_text(self->settings, "last.mapping", text[0] ? text : self->resting);
}

/* Those that a plugin of the list gives: not what the program itself moves. */
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
    uint32_t kept = 0;
    char key[24];
    for (uint32_t i = 0; i < live_input_count(self->live) && kept < INPUT_OPENER_MAX; ++i) {
        const char *text = live_input_text(self->live, i);
        if (!can_be_opened_again(self, text))
            continue;
        (void)snprintf(key, sizeof key, "inputs.%u", kept++);
        settings_set_text(self->settings, key, text);
    }
    for (; kept < INPUT_OPENER_MAX; ++kept) {
        (void)snprintf(key, sizeof key, "inputs.%u", kept);
        settings_set_text(self->settings, key, NULL);
    }
}

static void app_keep_settings_now(app *self)
{
    error err = {0};
    keep_looks(self);
    if (self->live) {
        keep_mapping(self);
        app_keep_range(self);
        if (input_opener_are_done(self->inputs))
            keep_inputs(self);
    }
    const mrt_result result = settings_write(self->settings, &err);
    if (result < 0 && !self->settings_failed)
        (void)app_report(self, result, &err);
    self->settings_failed = result < 0;
}

/* Into the settings, and those to the disk some times a minute. */
static void app_keep_settings(app *self, double dt_s)
{
    self->settings_wait_s += dt_s;
    if (self->settings_wait_s < WRITE_EVERY_S)
        return;
    self->settings_wait_s = 0.0;
    app_keep_settings_now(self);
}

/* ---- how the surface is solved: kept with the show ---- */

/* What the show says of it. */
static void app_solver_read(app *self)
{
    kept_solver kept;
    error err = {0};
    if (kept_solver_read(&kept, self->show, &err) < 0)
        app_say(self, MRT_LOG_WARNING, "%s", err.text);
    self->has_solver = kept.is_kept;
    self->solver = kept.as;
}

static mrt_result keep(app *self, error *err)
{
    const kept_solver kept = {self->has_solver, self->solver};
    if (!self->show || !show_is_writable(self->show))
        return MRT_OK;
    return kept_solver_write(self->show, &kept, err);
}

kept_scenery *app_scenery(const app *self)
{
    return self->scenery;
}

const csrbf_settings *app_solver(const app *self)
{
    return self->has_solver ? &self->solver : NULL;
}

mrt_result app_set_solver(app *self, const csrbf_settings *solver, error *err)
{
    mrt_result result = live_set_solver(self->live, solver, err);
    if (result < 0)
        return result;
    self->has_solver = solver != NULL;
    if (solver)
        self->solver = *solver;
    return keep(self, err);
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

/* The one of today, in the folder for documents. */
static mrt_result make_show(show **out, error *err)
{
    const char *documents = getenv("XDG_DOCUMENTS_DIR"), *home = getenv("HOME");
    const char *above = documents && documents[0] == '/' ? documents : home;
    char path[APP_PATH], day[24];
    struct tm now;
    const time_t seconds = time(NULL);
    if (!above || above[0] != '/')
        return error_set(err, MRT_ERR_IO,
                         "there is no folder for shows: name one, marotte NAME.marotte");
    (void)snprintf(path, sizeof path, "%.*s/marotte", (int)sizeof path - 64, above);
    if (mkdir(path, 0755) != 0 && errno != EEXIST)
        return error_set(err, MRT_ERR_IO, "%s: the folder for shows could not be made: %s", path,
                         strerror(errno));
    if (!localtime_r(&seconds, &now) || strftime(day, sizeof day, "%Y-%m-%d", &now) == 0)
        (void)snprintf(day, sizeof day, "show");
    const size_t length = strlen(path);
    (void)snprintf(path + length, sizeof path - length, "/%s.marotte", day);
    return open_or_make(out, path, err);
}

static void keep_show_path(app *self)
{
    char *real = self->show ? realpath(show_path(self->show), NULL) : NULL;
    if (real)
        settings_set_text(self->settings, "last.show", real);
    free(real);
    if (self->show && show_notice(self->show)[0])
        app_say(self, MRT_LOG_WARNING, "%s", show_notice(self->show));
}

/* Whoever named a show wants that one; the last one may have gone. Without any the stage performs
 * and records nothing. */
static mrt_result open_first_show(app *self, const char *path, error *err)
{
    const char *last = settings_text(self->settings, "last.show", NULL);
    error why = {0};
    if (path) {
        mrt_result result = open_or_make(&self->show, path, err);
        if (result >= 0)
            keep_show_path(self);
        return result;
    }
    if (last && exists(last) && show_open(&self->show, last, SHOW_RECORD, &why) < 0)
        (void)app_report(self, MRT_ERR_IO, &why);
    if (!self->show && make_show(&self->show, &why) < 0)
        (void)app_report(self, MRT_ERR_IO, &why);
    keep_show_path(self);
    return MRT_OK;
}

static void perform_as_show_says(app *self)
{
    error err = {0};
    const bool had_own = app_solver(self) != NULL;
    app_solver_read(self);
    kept_scenery_read(self->scenery);
    if (had_own || app_solver(self))
        (void)app_report(self, live_set_solver(self->live, app_solver(self), &err), &err);
}

mrt_result app_open_show(app *self, const char *path)
{
    error err = {0};
    show *opened = NULL;
    if (self->show && show_is_writable(self->show) && show_is_file(self->show, path)) {
        app_say(self, MRT_LOG_INFO, "%s is open already", path);
        return MRT_OK;
    }
    mrt_result result = open_or_make(&opened, path, &err);
    if (result < 0)
        return app_report(self, result, &err);
    app_record_finish_over(self);
    app_drop_take(self);
    app_forget_steps(self, NULL);
    self->awaited = 0;
    result = live_set_show(self->live, opened, &err);
    if (result < 0) { /* back to the one before */
        error again = {0};
        (void)app_report(self, result, &err);
        (void)app_report(self, live_set_show(self->live, self->show, &again), &again);
        show_close(opened);
        self->takes_are_stale = true;
        return result;
    }
    show *before = self->show;
    self->show = opened;
    self->takes_are_stale = true;
    self->was_recording = false;
    keep_show_path(self);
    perform_as_show_says(self);
    self->had_problem = false;
    app_say(self, MRT_LOG_INFO, "%s is open", path);
    app_close_show(self, before);
    return MRT_OK;
}

/* ---- under another name ---- */

mrt_result app_save_show_as(app *self, const char *path, error *err)
{
    if (!self->show)
        return error_set(err, MRT_ERR_ARGUMENT, "no show is open");
    if (self->status.is_recording || self->awaited)
        return error_set(err, MRT_ERR_ARGUMENT, "a take is being recorded: end it first");
    if (self->copier)
        return error_set(err, MRT_ERR_ARGUMENT, "the show is being saved already");
    return show_copier_begin(&self->copier, show_path(self->show), path, err);
}

/* The take that is chosen is the same one in the copy. One that has begun meanwhile is recorded to
 * its end first. */
static void follow_copy(app *self)
{
    error err = {0};
    char path[APP_PATH];
    if (!self->copier || self->status.is_recording || self->awaited)
        return;
    mrt_result result = show_copier_look(self->copier, &err);
    if (result == MRT_END)
        return;
    (void)snprintf(path, sizeof path, "%s", show_copier_path(self->copier));
    show_copier_destroy(self->copier);
    self->copier = NULL;
    const int64_t chosen = self->chosen;
    if (app_report(self, result, &err) >= 0)
        result = app_open_show(self, path);
    if (result >= 0 && chosen)
        app_reported(app_select_take(self, chosen));
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

static mrt_result read_face(face_file **out, const char *path, error *err)
{
    *out = calloc(1, sizeof **out);
    mrt_result result = *out ? face_file_read(*out, path, NULL, FACE_FILE_USABLE, err)
                             : error_set(err, MRT_ERR_MEMORY, "no memory for the face");
    if (result >= 0)
        return MRT_OK;
    free(*out);
    *out = NULL;
    return result;
}

/* The notes of a face are for its maker; the panel lists them. Here their number is enough. */
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

/* Why the face rests, and which mappings there are for it. */
static void rest(app *self, const face_file *made, const char *mapping, const error *why)
{
    char names[400];
    (void)snprintf(self->resting, sizeof self->resting, "%s", mapping);
    live_list_fitting(self->live, names, sizeof names);
    app_say(self, made->rig ? MRT_LOG_ERROR : MRT_LOG_INFO, "%s. At rest; these fit it: %s",
            made->rig ? why->text : "This face has no rig yet",
            names[0] ? names : "none that there is");
}

/* Another face is there, or another rig: what rested performs again where it fits, unless somebody
 * has chosen another since. */
static void perform_again(app *self)
{
    error ignored = {0};
    if (self->resting[0] &&
        (live_mapping(self->live) || live_set_mapping(self->live, self->resting, &ignored) >= 0))
        self->resting[0] = '\0';
}

/* A face that the mapping does not fit is opened at rest, as at the start. */
static mrt_result set_face_or_rest(app *self, const face_file *made, const char *path, error *err)
{
    char mapping[PRESET_TEXT + 64];
    error again = {0};
    mrt_result result = live_set_face(self->live, made, path, 0.0, err);
    mapping_text(self, mapping, sizeof mapping);
    if (result >= 0 || !mapping[0] || live_set_mapping(self->live, "", &again) < 0)
        return result;
    if (live_set_face(self->live, made, path, 0.0, &again) >= 0) {
        rest(self, made, mapping, err);
        return MRT_OK;
    }
    app_reported(live_set_mapping(self->live, mapping, &again)); /* it was not the mapping */
    return result;
}

/* The stage goes over to the face, which is the application's whatever comes back. */
static mrt_result put_face(app *self, face_file *made, const char *path)
{
    error err = {0};
    char *name = strdup(path);
    mrt_result result = name ? set_face_or_rest(self, made, path, &err)
                             : error_set(&err, MRT_ERR_MEMORY, "no memory for the face");
    if (result < 0) {
        free(name);
        free_face(made);
        return app_report(self, result, &err);
    }
    free_face(self->face);
    free(self->face_path);
    self->face = made;
    self->face_path = name;
    settings_set_text(self->settings, "last.face", path);
    perform_again(self);
    return MRT_OK;
}

mrt_result app_open_face(app *self, const char *given)
{
    error err = {0};
    face_file *made = NULL;
    char *found = installed_face(given), *path = found ? realpath(found, NULL) : NULL;
    mrt_result result = read_face(&made, path ? path : given, &err);
    if (result < 0)
        (void)app_report(self, result, &err);
    else
        result = put_face(self, made, path ? path : given);
    if (result >= 0) {
        pulls_forget(self->pulls);
        tell_face(self);
    }
    free(found);
    free(path);
    return result;
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
    char *path = strdup(self->face_path);
    mrt_result result = put_face(self, own, path ? path : "");
    free(path);
    return result;
}

/* ---- the first face, read beside the plugins ---- */

typedef struct face_reading {
    char path[3][APP_PATH]; /* to be tried, the best first; "": none */
    bool must_be_first;     /* it was asked for */
    face_file *face;
    char *face_path;
    mrt_result result;
    error err, first_err;
} face_reading;

static void *read_first_face(void *data)
{
    face_reading *self = data;
    self->result = error_set(&self->err, MRT_ERR_IO, "no face was found: name one with --face");
    for (int i = 0; i < 3 && self->result < 0; ++i) {
        if (!self->path[i][0])
            continue;
        char *found = installed_face(self->path[i]), *real = found ? realpath(found, NULL) : NULL;
        self->result = read_face(&self->face, real ? real : self->path[i], &self->err);
        if (self->result >= 0)
            self->face_path = strdup(real ? real : self->path[i]);
        else if (!self->first_err.text[0])
            self->first_err = self->err;
        free(found);
        free(real);
        if (self->must_be_first)
            break;
    }
    return NULL;
}

/* What the newest performance was performed on. */
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
        if (result < 0) /* what came with it is not to be trusted: nor is where it once was */
            app_say(self, MRT_LOG_ERROR, "%s", err.text);
        else if (path && (result == MRT_OK || path[0] == '/') && strlen(path) < APP_PATH &&
                 exists(path))
            (void)snprintf(out, APP_PATH, "%s", path);
        show_performance_finish(&newest);
    }
    free(ids);
}

static void choose_faces(app *self, const app_options *options, face_reading *out)
{
    const char *last = settings_text(self->settings, "last.face", "");
    out->must_be_first = options->face_path != NULL;
    if (options->face_path) {
        (void)snprintf(out->path[0], APP_PATH, "%s", options->face_path);
        return;
    }
    face_of_show(self, self->show, out->path[0]);
    if (exists(last))
        (void)snprintf(out->path[1], APP_PATH, "%s", last);
    (void)snprintf(out->path[2], APP_PATH, "%s", DEFAULT_FACE);
}

/* ---- the stage ---- */

/* A face that the mapping does not fit is there all the same: why it does not, and which do. */
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
                          .fps = 60.0};
    error ignored = {0};
    mrt_result result = live_start(&self->live, &with, err);
    if (result >= 0)
        return result;
    const bool is_known = live_check_mapping(&with, with.mapping, &ignored) >= 0;
    if (mapping && !is_known)
        return result;
    if (!is_known) {
        /* What was kept may name a plugin that is gone: the stage opens all the same. */
        (void)app_report(self, result, err);
        with.mapping = DEFAULT_MAPPING;
        result = live_start(&self->live, &with, err);
    }
    if (result >= 0)
        return result;
    return open_at_rest(self, &with, err) < 0 ? result : MRT_OK;
}

/* What the command line names, once its libraries are loaded: see plugin_list_choose_spec. */
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

/* Before the folders are looked through: a library that the person names hides others of its id. */
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
    for (uint32_t i = 0; i < INPUT_OPENER_MAX; ++i) {
        char key[24];
        (void)snprintf(key, sizeof key, "inputs.%u", i);
        kept[count] = settings_text(self->settings, key, NULL);
        count += kept[count] != NULL;
    }
    (void)app_report(self, input_opener_open(self->inputs, kept, count, true, &err), &err);
}

static mrt_result load_face_and_plugins(app *self, const app_options *options, error *err)
{
    face_reading reading = {.face = NULL};
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
static mrt_result app_open_first(app *self, const app_options *options, error *err)
{
    chosen named = {NULL, {NULL}, 0};
    mrt_result result = open_first_show(self, options->show_path, err);
    if (result >= 0) {
        app_solver_read(self);
        kept_scenery_read(self->scenery);
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

static void open_outputs(app *self);

/* ---- the patch ---- */

static bool patch_path(const app *self, char *out, size_t capacity)
{
    const char *folder = settings_folder(self->settings);
    int length = snprintf(out, capacity, "%spatch.json", folder);
    return folder[0] && length > 0 && (size_t)length < capacity;
}

/* As it was when the program ended. */
static void app_patch_read(app *self)
{
    char path[PATH_MAX];
    error err = {""};
    if (!self->keeps_settings || !patch_path(self, path, sizeof path) || access(path, R_OK) != 0)
        return;
    (void)app_report(self, patch_file_read(&self->patch, path, &err), &err);
    self->patch_waits = self->patch.count > 0;
}

static void app_patch_keep(app *self)
{
    char path[PATH_MAX], *text = NULL;
    error err = {""};
    if (!self->keeps_settings || !patch_path(self, path, sizeof path))
        return;
    mrt_result result = patch_file_write(&text, &self->patch, &err);
    if (result >= 0)
        result = file_write(path, text, strlen(text), &err);
    free(text);
    (void)app_report(self, result, &err);
}

const patch *app_patch(const app *self)
{
    return &self->patch;
}

void app_set_patch(app *self, const patch *p)
{
    self->patch = *p;
    self->patch_waits = true;
    app_patch_keep(self);
}

app_patch_aim *app_patch_aimed(app *self)
{
    return &self->patch_aim;
}

bool app_press(app *self, patch_action of)
{
    static const action does[PATCH_ACTIONS] = {
        [PATCH_RECORD] = ACTION_RECORD, [PATCH_STOP] = ACTION_RECORD, [PATCH_MARK] = ACTION_MARK};
    live_status_of(self->live, &self->status); /* another press may have been in this frame */
    const bool is_going = self->status.is_recording || self->counts_in;
    const bool is_wanted = of == PATCH_MARK || (of == PATCH_STOP) == is_going;
    if (is_wanted)
        app_do(self, does[of]);
    return is_wanted;
}

static void obey_presses(app *self)
{
    for (int i = 0; i < PATCH_ACTIONS; ++i) {
        const bool is_new = self->status.patch_pressed[i] > self->patch_pressed[i];
        self->patch_pressed[i] = self->status.patch_pressed[i];
        if (is_new)
            (void)app_press(self, (patch_action)i);
    }
}

static void app_patch_update(app *self)
{
    error err = {""};
    obey_presses(self);
    if (!self->patch_waits || self->status.is_recording)
        return;
    patch whole = self->patch;
    expressions_connect(self->expressions, &whole);
    mrt_result result = live_set_patch(self->live, &whole, &err);
    if (result == MRT_HOLD)
        return;
    self->patch_waits = false;
    (void)app_report(self, result, &err);
}

/* ---- from afar ---- */

static const char remote_key[] = "remote.place";

struct expressions *app_expressions(app *self)
{
    return self->expressions;
}

void app_ask_preset(app *self, const char *name)
{
    (void)snprintf(self->preset_asked, sizeof self->preset_asked, "%s", name);
}

bool app_take_preset(app *self, char *out, size_t capacity)
{
    (void)snprintf(out, capacity, "%s", self->preset_asked);
    self->preset_asked[0] = '\0';
    return out[0] != '\0';
}

void app_ask_camera(app *self)
{
    self->camera_asked = true;
}

bool app_take_camera(app *self)
{
    const bool was_asked = self->camera_asked;
    self->camera_asked = false;
    return was_asked;
}

void app_ask_draft(app *self)
{
    self->draft_asked = true;
    if (!self->resting[0]) /* none has performed: what a new stage performs with */
        (void)snprintf(self->resting, sizeof self->resting, "%s", DEFAULT_MAPPING);
}

bool app_take_draft(app *self)
{
    const bool was_asked = self->draft_asked;
    self->draft_asked = false;
    return was_asked;
}

void app_note_drafting(app *self, bool is_drafting)
{
    self->is_drafting = is_drafting;
}

bool app_is_drafting(const app *self)
{
    return self->is_drafting;
}

void app_ask_picture(app *self)
{
    self->picture_asked = true;
}

bool app_take_picture(app *self)
{
    const bool was_asked = self->picture_asked;
    self->picture_asked = false;
    return was_asked;
}

app_remote_status app_remote_now(const app *self)
{
    return remote_status_of(self->remote);
}

void app_set_remote(app *self, const char *place)
{
    error err = {""};
    if (app_report(self, remote_listen(self->remote, place, &err), &err) >= 0)
        settings_set_text(self->settings, remote_key, place[0] ? place : NULL);
}

static mrt_result start_remote(app *self, const char *wanted, error *err)
{
    const char *place = wanted ? wanted : settings_text(self->settings, remote_key, "");
    error ignored;
    const mrt_result result = remote_listen(self->remote, place, wanted ? err : &ignored);
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
    take_picture(self, given ? given : &kept); /* what a command line says is not kept */
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
    self->expressions = expressions_create(self);
    self->remote = remote_create(self);
    self->pulls = pulls_create(self);
    self->scenery = kept_scenery_create(self);
    self->inputs = self->log ? input_opener_create(&self->plugins, self->log) : NULL;
    if (!self->log || !self->news || !self->exports || !self->inputs || !self->expressions ||
        !self->remote || !self->pulls || !self->scenery)
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
    self->view = &nothing_yet;
    self->choice.marker = -1;
    self->sound = options->sound;
    mrt_result result = make_parts(self, options, err);
    if (result >= 0)
        result = app_open_first(self, options, err);
    if (result >= 0)
        result = start_remote(self, options->remote, err);
    if (result < 0) {
        app_destroy(self);
        return result;
    }
    self->keeps_settings = true;
    self->takes_are_stale = true;
    app_patch_read(self);
    open_outputs(self);
    app_update(self, 0.0);
    *out = self;
    return MRT_OK;
}

/* Whoever is left to hear it sees it in a terminal: the window is gone. */
static void end_live(app *self)
{
    error err = {0};
    if (self->live && live_stop(self->live, &err) < 0)
        fprintf(stderr, "marotte: %s\n", err.text);
    self->live = NULL;
    self->view = &nothing_yet;
}

void app_destroy(app *self)
{
    if (!self)
        return;
    if (self->keeps_settings)
        app_keep_settings_now(self);
    remote_destroy(self->remote);
    input_opener_destroy(self->inputs);
    show_copier_destroy(self->copier);
    exporter_destroy(self->exports);
    app_record_finish_over(self);
    app_drop_take(self);
    pulls_destroy(self->pulls);
    kept_scenery_destroy(self->scenery);
    end_live(self);
    expressions_destroy(self->expressions);
    app_close_show(self, self->show);
    face_file_destroy(self->face);
    free(self->face);
    free(self->face_path);
    free(self->line);
    free(self->key);
    settings_close(self->settings);
    news_list_destroy(self->news);
    log_queue_destroy(self->log);
    plugin_list_destroy(&self->plugins);
    free(self);
}

/* ---- each frame ---- */

/* There is no microphone, which the log has said: it is not armed. One that was there and went is
 * waited for. */
static void follow_sound(app *self)
{
    const sound_device_status *device = &self->status.listening.device;
    if (self->status.is_sound_armed && device->state == SOUND_DEVICE_AWAY &&
        device->lost_count == 0)
        live_disarm_sound(self->live);
}

/* None joins a take that is being recorded: it comes when that has ended. */
static void take_inputs(app *self)
{
    input_opened one;
    live_status_of(self->live, &self->status);
    while (!self->status.is_recording && input_opener_take(self->inputs, &one)) {
        mrt_result result = MRT_ERR_IO;
        if (one.input)
            result = live_add_input(self->live, one.input, one.text, &one.err);
        self->input_trouble = result < 0 ? one.err : (error){""};
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

void app_update(app *self, double dt_s)
{
    const live_view *newest = NULL;
    take_inputs(self);
    live_update(self->live);
    (void)live_look(self->live, &newest);
    if (newest)
        self->view = newest;
    live_status_of(self->live, &self->status);
    follow_sound(self);
    app_record_update(self);
    self->patch_waits |= expressions_update(self->expressions, dt_s);
    app_patch_update(self);
    remote_update(self->remote, dt_s);
    report_exports(self);
    app_undo_update(self);
    kept_scenery_update(self->scenery);
    app_takes_update(self, dt_s);
    follow_copy(self);
    news_list_update(self->news, self->log, dt_s);
    if (self->keeps_settings)
        app_keep_settings(self, dt_s);
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

/* ---- outputs ---- */

static void keep_outputs(app *self)
{
    outputs *of = live_outputs(self->live);
    char key[24];
    for (uint32_t i = 0; i < OUTPUTS_MAX; ++i) {
        output_status now = {.text = NULL};
        if (i < outputs_count(of))
            outputs_status(of, i, &now);
        (void)snprintf(key, sizeof key, "outputs.%u", i);
        settings_set_text(self->settings, key, now.text);
    }
}

/* As they were when the program ended: what they name is looked up among what is loaded. */
static void open_outputs(app *self)
{
    char key[24];
    for (uint32_t i = 0; i < OUTPUTS_MAX; ++i) {
        error err = {""};
        (void)snprintf(key, sizeof key, "outputs.%u", i);
        const char *text = settings_text(self->settings, key, NULL);
        if (text)
            (void)app_report(self, outputs_add(live_outputs(self->live), text, &err), &err);
    }
}

mrt_result app_add_output(app *self, const char *text)
{
    char *spec;
    self->output_trouble = (error){""};
    mrt_result result = plugin_list_choose_spec(&self->plugins, text, MRT_FACE_OUTPUT, &spec,
                                                &self->output_trouble);
    if (result >= 0)
        result = outputs_add(live_outputs(self->live), spec, &self->output_trouble);
    free(spec);
    if (result >= 0)
        keep_outputs(self);
    return app_report(self, result, &self->output_trouble);
}

void app_remove_output(app *self, uint32_t index)
{
    outputs_remove(live_outputs(self->live), index);
    keep_outputs(self);
}

const char *app_output_trouble(const app *self)
{
    return self->output_trouble.text;
}

/* ---- what there is ---- */

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
    return &self->choice;
}

struct viewport *app_viewport(app *self)
{
    return self->viewport;
}

void app_set_viewport(app *self, struct viewport *v)
{
    self->viewport = v;
}

void app_note_figures(app *self, const app_figures *figures)
{
    self->figures = *figures;
}

const app_figures *app_figures_of(const app *self)
{
    return &self->figures;
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

mrt_result app_export_take(app *self, const export_request *request)
{
    error err = {0};
    if (!self->chosen || !self->show)
        return app_report(
            self, error_set(&err, MRT_ERR_ARGUMENT, "choose the take that is to be exported"),
            &err);
    const mrt_result result = exporter_begin(self->exports, show_path(self->show), self->chosen,
                                             self->face_path, request, &err);
    if (result >= 0)
        app_say(self, MRT_LOG_INFO, "exporting %s", request->file);
    return app_report(self, result, &err);
}

uint32_t app_exports_going(const app *self)
{
    return exporter_count(self->exports);
}

export_progress app_export_now(const app *self, uint32_t index)
{
    return exporter_at(self->exports, index);
}

void app_cancel_export(app *self, uint32_t index)
{
    exporter_cancel(self->exports, index);
}

/* ---- actions: whether each can be done now, and who does it ---- */

static const char *why_no_record(const app *self)
{
    if (self->status.is_recording || self->status.can_record)
        return NULL;
    return self->status.why_not[0] ? self->status.why_not : "nothing can be recorded now";
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
        return "a take is being recorded: end it first";
    if (of == ACTION_TAKE_BEFORE || of == ACTION_TAKE_NEXT)
        return self->line_count ? NULL : "there is no take yet";
    if (!self->history)
        return "no take is chosen";
    if (of == ACTION_STOP && self->view->mode == LIVE_PERFORMS)
        return "no take is on the stage";
    return NULL;
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
        return self->view->mode == LIVE_PERFORMS && !self->chosen
                   ? "the live hands are on the stage"
                   : NULL;
    case ACTION_SOUND_ARM:
        return self->status.is_recording ? "a take is being recorded: end it first" : NULL;
    case ACTION_UNDO:
        return app_undo_why_not(self);
    case ACTION_REDO:
        return app_can_redo(self) ? NULL : "there is nothing to do again";
    case ACTION_EXPORT:
        return self->chosen ? NULL : "no take is chosen";
    case ACTION_NONE:
    case ACTION_COUNT:
        return "";
    default:
        break;
    }
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
        expressions_release(self->expressions, NEUTRAL_FADE_S);
        pulls_clear(self->pulls);
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
    default:
        break;
    }
}

/* The switch of the looks that an action is; NULL: it is none. */
static bool *switch_of(app_looks *looks, action of)
{
    switch (of) {
    case ACTION_VIEW_MIRROR:
        return &looks->is_mirrored;
    case ACTION_VIEW_TURNTABLE:
        return &looks->is_turning;
    case ACTION_SHOW_HANDS:
        return &looks->shows_hands;
    case ACTION_SHOW_VECTORS:
        return &looks->shows_vectors;
    case ACTION_SHOW_SUPPORTS:
        return &looks->shows_supports;
    case ACTION_SHOW_CONTACTS:
        return &looks->shows_contacts;
    case ACTION_SHOW_JAW:
        return &looks->shows_jaw;
    case ACTION_OUTPUT:
        return &looks->has_output;
    case ACTION_OUTPUT_MIRROR:
        return &looks->is_output_mirrored;
    case ACTION_FACE_ONLY:
        return &looks->is_face_only;
    case ACTION_TIMELINE:
        return &looks->has_timeline;
    case ACTION_HELP:
        return &looks->is_helping;
    default:
        return NULL;
    }
}

static void do_look(app *self, action of)
{
    app_looks *looks = &self->looks;
    bool *value = switch_of(looks, of);
    if (value) {
        *value = !*value;
        if (of == ACTION_TIMELINE && *value)
            looks->is_face_only = false;
    } else if (of == ACTION_HEAT_NEXT) {
        looks->heat = (app_heat)((looks->heat + 1) % APP_HEATS);
    } else if (of >= ACTION_PANEL_DEVICES && of < ACTION_PANEL_DEVICES + (int)APP_PANELS) {
        looks->panel = (app_panel)(of - ACTION_PANEL_DEVICES);
        looks->is_face_only = false;
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
        app_reported(app_duplicate_take(self, self->chosen));
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

bool app_is_held(const app *self)
{
    return pulls_is_held(self->pulls);
}

void app_begin_pull(app *self)
{
    self->has_pulled = true;
    pulls_begin(self->pulls);
}

bool app_has_pulled(const app *self)
{
    return self->has_pulled;
}

void app_hold(app *self, const char *words)
{
    pulls_did(self->pulls, words);
}

void app_clear_pulls(app *self)
{
    if (pulls_is_held(self->pulls))
        pulls_clear(self->pulls);
}

void app_note_rig_pending(app *self, bool is_pending)
{
    self->is_rig_pending = is_pending;
}

bool app_is_rig_pending(const app *self)
{
    return self->is_rig_pending;
}

bool app_has_hand_keys(const app *self)
{
    return self->has_hand_keys;
}
