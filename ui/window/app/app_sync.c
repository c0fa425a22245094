/* "Sync of mouth and sound": measured on a thread of its own, which opens show and face again. */
#include "window/app/app_shared.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct sync_job {
    char *show_path, *face_path;
    mesh_frame frame;
    const plugin_list *plugins;
    log_queue *log; /* its own */
    take of;        /* a copy */
    uint64_t edition;
    int64_t from_ns, to_ns;
    pthread_t thread;
    bool has_thread; /* it has not been joined */
    _Atomic bool is_given_up, has_ended;
    _Atomic uint32_t thousandths;
    sync_curves curves; /* once it has ended, as the rest */
    app_sync_found found;
    mrt_result result;
    error err;
} sync_job;

static bool goes_on(void *data, double part)
{
    sync_job *self = data;
    atomic_store(&self->thousandths, (uint32_t)(part * 1000.0));
    return !atomic_load(&self->is_given_up);
}

static mrt_result measure_on(sync_job *self, show *from, const face_file *on)
{
    sequencer *played = NULL;
    const sequencer_settings with = {
        .show = from, .plugins = self->plugins, .log = self->log, .face = on};
    mrt_result result = sequencer_create(&played, &with, &self->of, &self->err);
    const sync_source source = {.show = from,
                                .plugins = self->plugins,
                                .log = self->log,
                                .sequencer = played,
                                .take = &self->of,
                                .from_ns = self->from_ns,
                                .to_ns = self->to_ns,
                                .goes_on = goes_on,
                                .data = self};
    if (result >= 0)
        result = sync_read(&self->curves, &source, &self->err);
    sequencer_destroy(played);
    return result;
}

static mrt_result measure(sync_job *self)
{
    show *from = NULL;
    face_file worn;
    mrt_result result = show_open(&from, self->show_path, SHOW_READ, &self->err);
    if (result < 0)
        return result;
    result = face_file_read(&worn, self->face_path, &self->frame, FACE_FILE_USABLE, &self->err);
    if (result >= 0) {
        result = measure_on(self, from, &worn);
        face_file_destroy(&worn);
    }
    show_close(from);
    if (result == MRT_OK)
        sync_find(&self->found.offset, self->curves.mouth, self->curves.voice, self->curves.count);
    return result;
}

static void *run(void *data)
{
    sync_job *self = data;
    self->result = measure(self);
    atomic_store(&self->has_ended, true);
    return NULL;
}

static void join(sync_job *self)
{
    if (self->has_thread)
        (void)pthread_join(self->thread, NULL);
    self->has_thread = false;
}

static void sync_job_free(sync_job *self)
{
    join(self);
    sync_curves_finish(&self->curves);
    take_finish(&self->of);
    log_queue_destroy(self->log);
    free(self->show_path);
    free(self->face_path);
    free(self);
}

static mrt_result begin(sync_job **out, app *from, int64_t from_ns, int64_t to_ns, error *err)
{
    sync_job *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to measure the mouth");
    self->show_path = strdup(show_path(from->show));
    self->face_path = strdup(from->face_path);
    self->frame.mm_per_unit = from->face_unit_mm;
    self->plugins = &from->plugins;
    self->log = log_queue_create();
    self->edition = app_take_edition(from);
    self->from_ns = from_ns;
    self->to_ns = to_ns;
    self->found.curves = &self->curves;
    mrt_result result = self->show_path && self->face_path && self->log
                            ? take_copy(&self->of, app_take(from), err)
                            : error_set(err, MRT_ERR_MEMORY, "no memory to measure the mouth");
    if (result >= 0) {
        self->has_thread = pthread_create(&self->thread, NULL, run, self) == 0;
        if (!self->has_thread)
            result = error_set(err, MRT_ERR_MEMORY, "no thread to measure the mouth");
    }
    if (result < 0) {
        sync_job_free(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

static bool is_running(const app *self)
{
    return self->sync.job && self->sync.job->has_thread;
}

mrt_result app_sync_begin(app *self, int64_t from_ns, int64_t to_ns)
{
    error err = {0};
    mrt_result result = MRT_OK;
    if (is_running(self))
        result = error_set(&err, MRT_ERR_ARGUMENT,
                           "another mouth is being measured: wait until it is finished");
    else if (!app_take(self) || !self->face_path)
        result = error_set(&err, MRT_ERR_ARGUMENT, "select a take and open a face first");
    else {
        app_drop_sync(self);
        result = begin(&self->sync.job, self, from_ns, to_ns, &err);
    }
    if (result < 0)
        (void)snprintf(self->sync.result, sizeof self->sync.result, "%.500s", err.text);
    return result;
}

double app_sync_part(const app *self)
{
    return is_running(self) ? 1e-3 * (double)atomic_load(&self->sync.job->thousandths) : -1.0;
}

void app_sync_cancel(app *self)
{
    if (is_running(self))
        atomic_store(&self->sync.job->is_given_up, true);
}

const char *app_sync_result(const app *self)
{
    return self->sync.result;
}

const app_sync_found *app_sync_of(const app *self)
{
    return self->sync.job && !self->sync.job->has_thread ? &self->sync.job->found : NULL;
}

void app_drop_sync(app *self)
{
    app_sync_cancel(self);
    if (self->sync.job)
        sync_job_free(self->sync.job);
    self->sync = (app_sync){.job = NULL};
}

mrt_result app_sync_move(app *self)
{
    edit made[EDIT_LAYERS_MAX];
    const edit *list[EDIT_LAYERS_MAX];
    sync_job *job = self->sync.job;
    error err = {0};
    char words[EDIT_TEXT];
    if (!app_sync_of(self) || !job->found.offset.is_clear || job->found.moved_ns != 0)
        return error_set(&err, MRT_ERR_ARGUMENT, "no offset has been found");
    const int64_t late_ns = job->found.offset.late_ns;
    const uint32_t count = sync_edits(made, EDIT_LAYERS_MAX, app_take(self), late_ns);
    for (uint32_t i = 0; i < count && i < EDIT_LAYERS_MAX; ++i)
        list[i] = &made[i];
    (void)snprintf(words, sizeof words, "move the mouth by %+.0f ms", -1e-6 * (double)late_ns);
    mrt_result result = MRT_OK;
    if (count == 0 || count > EDIT_LAYERS_MAX)
        result = app_report(self,
                            error_set(&err, MRT_ERR_ARGUMENT,
                                      "The mouth was not moved: %s layers of the take own the jaw",
                                      count == 0 ? "no" : "too many"),
                            &err);
    else
        result = app_edit_all_as(self, list, count, words);
    if (result < 0)
        return result;
    job->found.moved_ns = -late_ns;
    job->edition = app_take_edition(self);
    (void)snprintf(self->sync.result, sizeof self->sync.result,
                   "The mouth was moved by %+.0f ms. Undo moves it back", -1e-6 * (double)late_ns);
    return MRT_OK;
}

/* Returns whether the take is still the one that was measured. */
static bool is_current(const app *self, const sync_job *job)
{
    return app_take(self) && app_take(self)->id == job->of.id &&
           app_take_edition(self) == job->edition;
}

static void put_line(app *self, const char *line)
{
    sync_job_free(self->sync.job);
    self->sync.job = NULL;
    (void)snprintf(self->sync.result, sizeof self->sync.result, "%.500s", line);
}

void app_follow_sync(app *self)
{
    sync_job *job = self->sync.job;
    if (!job)
        return;
    const bool is_still_that = is_current(self, job);
    if (job->has_thread) {
        if (!is_still_that)
            app_sync_cancel(self);
        if (!atomic_load(&job->has_ended))
            return;
        join(job);
        (void)snprintf(self->sync.result, sizeof self->sync.result, "%s",
                       sync_describe(&job->found.offset).text);
    }
    if (!is_still_that)
        put_line(self, "The take has changed since. Measure it again");
    else if (job->result == MRT_END || atomic_load(&job->is_given_up))
        put_line(self, "Cancelled. The take is unchanged");
    else if (job->result < 0) {
        const error why = job->err;
        put_line(self, why.text);
    }
}
