/* What is opened: at the start, and when somebody asks. */
#include "window/studio_state.h"

#include "place.h"

#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

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
    char path[STUDIO_PATH], day[24];
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

static void keep_show_path(studio *self)
{
    char *real = self->show ? realpath(show_path(self->show), NULL) : NULL;
    if (real)
        settings_set_text(self->settings, "last.show", real);
    free(real);
    if (self->show && show_notice(self->show)[0])
        studio_say(self, MRT_LOG_WARNING, "%s", show_notice(self->show));
}

/* Whoever named a show wants that one; the last one may have gone. Without any the stage performs
 * and records nothing. */
static mrt_result open_first_show(studio *self, const char *path, error *err)
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
        (void)studio_said(self, MRT_ERR_IO, &why);
    if (!self->show && make_show(&self->show, &why) < 0)
        (void)studio_said(self, MRT_ERR_IO, &why);
    keep_show_path(self);
    return MRT_OK;
}

static void perform_as_show_says(studio *self)
{
    error err = {0};
    const bool had_own = studio_solver(self) != NULL;
    studio_solver_read(self);
    if (had_own || studio_solver(self))
        (void)studio_said(self, live_set_solver(self->live, studio_solver(self), &err), &err);
}

mrt_result studio_open_show(studio *self, const char *path)
{
    error err = {0};
    show *opened = NULL;
    mrt_result result = open_or_make(&opened, path, &err);
    if (result < 0)
        return studio_said(self, result, &err);
    studio_record_finish_over(self);
    studio_drop_take(self);
    studio_forget_steps(self, NULL);
    self->awaited = 0;
    result = live_set_show(self->live, opened, &err);
    if (result < 0) { /* back to the one before */
        error again = {0};
        (void)studio_said(self, result, &err);
        (void)studio_said(self, live_set_show(self->live, self->show, &again), &again);
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
    studio_say(self, MRT_LOG_INFO, "%s is open", path);
    studio_close_show(self, before);
    return MRT_OK;
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
    mrt_result result = *out ? face_file_read(*out, path, MESH_UNIT_AUTO, FACE_FILE_USABLE, err)
                             : error_set(err, MRT_ERR_MEMORY, "no memory for the face");
    if (result >= 0)
        return MRT_OK;
    free(*out);
    *out = NULL;
    return result;
}

/* The notes of a face are for its maker; the panel lists them. Here their number is enough. */
static void tell_face(studio *self)
{
    uint32_t lines = 0;
    for (const char *c = self->face->note; c && *c; ++c)
        lines += *c == '\n';
    if (lines == 1)
        studio_say(self, MRT_LOG_INFO, "%.*s", (int)strcspn(self->face->note, "\n"),
                   self->face->note);
    else if (lines > 1)
        studio_say(self, MRT_LOG_INFO, "the face has %u notes: see the rig panel", lines);
}

/* The stage goes over to the face, which is the studio's whatever comes back. */
static mrt_result put_face(studio *self, face_file *made, const char *path)
{
    error err = {0};
    char *name = strdup(path);
    mrt_result result = name ? live_set_face(self->live, made, path, 0.0, &err)
                             : error_set(&err, MRT_ERR_MEMORY, "no memory for the face");
    if (result < 0) {
        free(name);
        free_face(made);
        return studio_said(self, result, &err);
    }
    free_face(self->face);
    free(self->face_path);
    self->face = made;
    self->face_path = name;
    settings_set_text(self->settings, "last.face", path);
    return MRT_OK;
}

mrt_result studio_open_face(studio *self, const char *given)
{
    error err = {0};
    face_file *made = NULL;
    char *found = place_face(given), *path = found ? realpath(found, NULL) : NULL;
    mrt_result result = read_face(&made, path ? path : given, &err);
    if (result < 0)
        (void)studio_said(self, result, &err);
    else
        result = put_face(self, made, path ? path : given);
    if (result >= 0)
        tell_face(self);
    free(found);
    free(path);
    return result;
}

mrt_result studio_change_face(studio *self, face_file *made)
{
    face_file *own = malloc(sizeof *own);
    error err = {0};
    if (!own) {
        face_file_destroy(made);
        return studio_said(self, error_set(&err, MRT_ERR_MEMORY, "no memory for the face"), &err);
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
    char path[3][STUDIO_PATH]; /* to be tried, the best first; "": none */
    bool must_be_first;        /* it was asked for */
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
        char *found = place_face(self->path[i]), *real = found ? realpath(found, NULL) : NULL;
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
static void face_of_show(show *s, char out[STUDIO_PATH])
{
    int64_t *ids = NULL;
    size_t count = 0;
    show_performance newest;
    error err = {0};
    out[0] = '\0';
    if (!s || show_performance_ids(s, &ids, &count, &err) < 0)
        return;
    if (count && show_performance_read(s, ids[count - 1], &newest, &err) >= 0) {
        const char *path = newest.performance.rig;
        if (path && path[0] == '/' && strlen(path) < STUDIO_PATH && exists(path))
            (void)snprintf(out, STUDIO_PATH, "%s", path);
        show_performance_finish(&newest);
    }
    free(ids);
}

static void choose_faces(studio *self, const studio_options *options, face_reading *out)
{
    const char *last = settings_text(self->settings, "last.face", "");
    out->must_be_first = options->face_path != NULL;
    if (options->face_path) {
        (void)snprintf(out->path[0], STUDIO_PATH, "%s", options->face_path);
        return;
    }
    face_of_show(self->show, out->path[0]);
    if (exists(last))
        (void)snprintf(out->path[1], STUDIO_PATH, "%s", last);
    (void)snprintf(out->path[2], STUDIO_PATH, "%s", DEFAULT_FACE);
}

/* ---- the stage ---- */

/* A face that the mapping does not fit is there all the same: why it does not, and which do. */
static mrt_result open_at_rest(studio *self, live_settings *with, const error *why)
{
    char names[400];
    error err = {0};
    with->mapping = "";
    mrt_result result = live_start(&self->live, with, &err);
    if (result < 0)
        return result;
    live_list_fitting(self->live, names, sizeof names);
    studio_say(self, MRT_LOG_ERROR, "%s. At rest; these fit it: %s", why->text,
               names[0] ? names : "none that there is");
    return MRT_OK;
}

static mrt_result start_live(studio *self, const char *mapping, error *err)
{
    const char *last = settings_text(self->settings, "last.mapping", DEFAULT_MAPPING);
    live_settings with = {.plugins = &self->plugins,
                          .log = self->log,
                          .show = self->show,
                          .face = self->face,
                          .face_path = self->face_path,
                          .mapping = mapping ? mapping : last,
                          .sound = self->sound,
                          .solver = studio_solver(self),
                          .fps = 60.0};
    error ignored = {0};
    mrt_result result = live_start(&self->live, &with, err);
    if (result >= 0)
        return result;
    if (mapping && live_check_mapping(&with, mapping, &ignored) < 0)
        return result;
    if (!mapping && strcmp(last, DEFAULT_MAPPING) != 0) {
        /* What was kept may name a plugin that is gone: the stage opens all the same. */
        (void)studio_said(self, result, err);
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
    char *input[STUDIO_INPUTS_MAX];
    uint32_t input_count;
} chosen;

static void chosen_finish(chosen *self)
{
    free(self->mapping);
    for (uint32_t i = 0; i < self->input_count; ++i)
        free(self->input[i]);
}

/* Before the folders are looked through: a library that the person names hides others of its id. */
static mrt_result choose(studio *self, const studio_options *options, chosen *out, error *err)
{
    *out = (chosen){NULL, {NULL}, 0};
    for (uint32_t i = 0; i < options->input_count && out->input_count < STUDIO_INPUTS_MAX; ++i) {
        error why = {0};
        char **one = &out->input[out->input_count];
        if (plugin_list_choose_spec(&self->plugins, options->inputs[i], MRT_INPUT, one, &why) >= 0)
            out->input_count += 1;
        else
            (void)studio_said(self, MRT_ERR_ARGUMENT, &why);
    }
    if (!options->mapping)
        return MRT_OK;
    return plugin_list_choose_spec(&self->plugins, options->mapping, MRT_MAPPING, &out->mapping,
                                   err);
}

static void start_inputs(studio *self, const studio_options *options, const chosen *named)
{
    const char *kept[STUDIO_INPUTS_MAX];
    uint32_t count = 0;
    error err = {0};
    if (options->inputs) {
        for (; count < named->input_count; ++count)
            kept[count] = named->input[count];
        if (count)
            (void)studio_said(self, studio_inputs_open(self->inputs, kept, count, false, &err),
                              &err);
        return;
    }
    for (uint32_t i = 0; i < STUDIO_INPUTS_MAX; ++i) {
        char key[24];
        (void)snprintf(key, sizeof key, "inputs.%u", i);
        kept[count] = settings_text(self->settings, key, NULL);
        count += kept[count] != NULL;
    }
    (void)studio_said(self, studio_inputs_open(self->inputs, kept, count, true, &err), &err);
}

static mrt_result load_face_and_plugins(studio *self, const studio_options *options, error *err)
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
        (void)studio_said(self, MRT_ERR_IO, &reading.first_err);
    return MRT_OK;
}

mrt_result studio_open_first(studio *self, const studio_options *options, error *err)
{
    chosen named = {NULL, {NULL}, 0};
    mrt_result result = open_first_show(self, options->show_path, err);
    if (result >= 0) {
        studio_solver_read(self);
        result = choose(self, options, &named, err);
    }
    if (result >= 0)
        result = load_face_and_plugins(self, options, err);
    if (result >= 0)
        result = start_live(self, named.mapping, err);
    if (result < 0)
        goto done;
    for (uint32_t i = 0; i < self->plugins.refusal_count; ++i)
        studio_say(self, MRT_LOG_INFO, "%s is not loaded: %s", self->plugins.refusal[i].path,
                   self->plugins.refusal[i].reason);
    settings_set_text(self->settings, "last.face", self->face_path);
    tell_face(self);
    start_inputs(self, options, &named);
done:
    chosen_finish(&named);
    return result;
}
