#include "window/studio_state.h"

#include "base/clock.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Before the frame thread has published anything. */
static const live_view nothing_yet;

/* ---- saying things ---- */

mrt_result studio_said(studio *self, mrt_result result, const error *err)
{
    if (result < 0)
        news_list_add(self->news, MRT_LOG_ERROR, "stage", err->text);
    return result;
}

void studio_say(studio *self, int32_t level, const char *format, ...)
{
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    news_list_add(self->news, level, "stage", text);
}

/* ---- life ---- */

static mrt_result make_parts(studio *self, const studio_options *options, error *err)
{
    char note[1024];
    mrt_result result =
        settings_open(&self->settings, options->settings_path, note, sizeof note, err);
    if (result < 0)
        return result;
    self->log = log_queue_create();
    self->news = news_list_create();
    self->exports = studio_export_create();
    self->inputs = self->log ? studio_inputs_create(&self->plugins, self->log) : NULL;
    if (!self->log || !self->news || !self->exports || !self->inputs)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    if (note[0])
        studio_say(self, MRT_LOG_WARNING, "%s", note);
    if (options->note && options->note[0])
        studio_say(self, MRT_LOG_WARNING, "%s", options->note);
    studio_looks_read(self);
    return MRT_OK;
}

mrt_result studio_create(studio **out, const studio_options *options, error *err)
{
    *out = NULL;
    studio *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the stage");
    self->view = &nothing_yet;
    self->choice.marker = -1;
    self->sound = options->sound;
    mrt_result result = make_parts(self, options, err);
    if (result >= 0)
        result = studio_open_first(self, options, err);
    if (result < 0) {
        studio_destroy(self);
        return result;
    }
    self->keeps_settings = true;
    self->takes_are_stale = true;
    studio_update(self, 0.0);
    *out = self;
    return MRT_OK;
}

/* Whoever is left to hear it sees it in a terminal: the window is gone. */
static void end_live(studio *self)
{
    error err = {0};
    if (self->live && live_stop(self->live, &err) < 0)
        fprintf(stderr, "marotte: %s\n", err.text);
    self->live = NULL;
    self->view = &nothing_yet;
}

void studio_destroy(studio *self)
{
    if (!self)
        return;
    if (self->keeps_settings)
        studio_keep_settings_now(self);
    studio_inputs_destroy(self->inputs);
    studio_export_destroy(self->exports);
    studio_record_finish_over(self);
    studio_drop_take(self);
    end_live(self);
    studio_close_show(self, self->show);
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

/* None joins a take that is being recorded: it comes when that has ended. */
static void take_inputs(studio *self)
{
    studio_input_opened one;
    live_status_of(self->live, &self->status);
    while (!self->status.is_recording && studio_inputs_take(self->inputs, &one)) {
        mrt_result result = MRT_ERR_IO;
        if (one.input)
            result = live_add_input(self->live, one.input, one.text, &one.err);
        self->input_trouble = result < 0 ? one.err : (error){""};
        (void)studio_said(self, result, &one.err);
    }
}

static void hear_exports(studio *self)
{
    mrt_result result;
    char text[2048];
    while (studio_export_ended(self->exports, &result, text, sizeof text)) {
        self->exports_failed += result < 0;
        studio_say(self, result < 0 ? MRT_LOG_ERROR : MRT_LOG_INFO, "%s", text);
    }
}

uint32_t studio_exports_failed(const studio *self)
{
    return self->exports_failed;
}

void studio_update(studio *self, double dt_s)
{
    const live_view *newest = NULL;
    take_inputs(self);
    live_update(self->live);
    (void)live_look(self->live, &newest);
    if (newest)
        self->view = newest;
    live_status_of(self->live, &self->status);
    studio_record_update(self);
    hear_exports(self);
    studio_takes_update(self, dt_s);
    news_list_update(self->news, self->log, dt_s);
    if (self->keeps_settings)
        studio_keep_settings(self, dt_s);
}

/* ---- inputs ---- */

mrt_result studio_open_input(studio *self, const char *text)
{
    char *spec;
    self->input_trouble = (error){""};
    mrt_result result =
        plugin_list_choose_spec(&self->plugins, text, MRT_INPUT, &spec, &self->input_trouble);
    const char *const one = spec;
    if (result >= 0)
        result = studio_inputs_open(self->inputs, &one, 1, false, &self->input_trouble);
    free(spec);
    return studio_said(self, result, &self->input_trouble);
}

uint32_t studio_openings(studio *self, studio_opening out[STUDIO_OPENINGS_MAX])
{
    return studio_inputs_going(self->inputs, out);
}

void studio_give_up_opening(studio *self, uint64_t id)
{
    studio_inputs_give_up(self->inputs, id);
}

const char *studio_opening_trouble(const studio *self)
{
    return self->input_trouble.text;
}

/* ---- what there is ---- */

const plugin_list *studio_plugins(studio *self)
{
    return &self->plugins;
}

log_queue *studio_log(studio *self)
{
    return self->log;
}

live *studio_live(studio *self)
{
    return self->live;
}

const live_view *studio_view(const studio *self)
{
    return self->view;
}

const live_status *studio_status(const studio *self)
{
    return &self->status;
}

const face_file *studio_face(const studio *self)
{
    return self->face;
}

const char *studio_face_path(const studio *self)
{
    return self->face_path;
}

show *studio_show(studio *self)
{
    return self->show;
}

settings *studio_settings(studio *self)
{
    return self->settings;
}

news_list *studio_news(studio *self)
{
    return self->news;
}

studio_choice *studio_chosen(studio *self)
{
    return &self->choice;
}

viewport *studio_viewport(studio *self)
{
    return self->viewport;
}

void studio_set_viewport(studio *self, viewport *v)
{
    self->viewport = v;
}

void studio_note_figures(studio *self, const studio_figures *figures)
{
    self->figures = *figures;
}

const studio_figures *studio_figures_of(const studio *self)
{
    return &self->figures;
}

void studio_set_unsaved(studio *self, const studio_unsaved *unsaved)
{
    self->has_unsaved = unsaved != NULL;
    if (unsaved)
        self->unsaved = *unsaved;
}

const studio_unsaved *studio_unsaved_now(const studio *self)
{
    return self->has_unsaved ? &self->unsaved : NULL;
}

mrt_result studio_export_take(studio *self, const export_wish *wish)
{
    error err = {0};
    if (!self->chosen || !self->show)
        return studio_said(
            self, error_set(&err, MRT_ERR_ARGUMENT, "choose the take that is to be exported"),
            &err);
    const mrt_result result = studio_export_begin(self->exports, show_path(self->show),
                                                  self->chosen, self->face_path, wish, &err);
    if (result >= 0)
        studio_say(self, MRT_LOG_INFO, "exporting %s", wish->file);
    return studio_said(self, result, &err);
}

uint32_t studio_exports_going(const studio *self)
{
    return studio_export_count(self->exports);
}

export_going studio_export_now(const studio *self, uint32_t index)
{
    return studio_export_at(self->exports, index);
}

void studio_cancel_export(studio *self, uint32_t index)
{
    studio_export_cancel(self->exports, index);
}
