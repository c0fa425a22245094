#include "perform_record.h"
#include "base/file.h"
#include "base/text.h"
#include "stage/mapping/taught.h"
#include "stage/take/kept_solver.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static mrt_result no_memory(error *err)
{
    return error_set(err, MRT_ERR_MEMORY, "no memory to record");
}

/* As on the command line: "log:demo.csv,end=8". */
static char *spec_text(const plugin_spec *spec)
{
    size_t size = strlen(spec->plugin) + strlen(spec->address) + strlen(spec->params) + 3;
    char *out = malloc(size);
    if (out)
        snprintf(out, size, "%s%s%s%s%s", spec->plugin, spec->address[0] ? ":" : "", spec->address,
                 spec->params[0] ? "," : "", spec->params);
    return out;
}

static mrt_result open_show(perform_record *out, const char *path, error *err)
{
    bool is_there = access(path, F_OK) == 0;
    mrt_result result = is_there ? show_open(&out->show, path, SHOW_RECORD, err)
                                 : show_create(&out->show, path, err);
    if (result < 0 || show_is_writable(out->show))
        return result;
    return error_set(err, MRT_ERR_IO, "%s", show_notice(out->show));
}

static mrt_result describe(perform_record *out, const perform_options *options,
                           const perform_record_of *of, error *err)
{
    for (uint32_t i = 0; i < options->input_count; ++i) {
        out->input_text[i] = spec_text(&options->input[i]);
        if (!out->input_text[i])
            return no_memory(err);
    }
    for (int side = 0; side < 2; ++side) {
        if (!of->hands->path[side])
            continue;
        mrt_result result = perform_hands_text(&out->calibration[side], of->hands->path[side], err);
        if (result < 0)
            return result;
    }
    return MRT_OK;
}

static double unit_mm(mesh_unit unit)
{
    return unit == MESH_UNIT_M ? 1000.0 : unit == MESH_UNIT_CM ? 10.0 : unit == MESH_UNIT_MM;
}

csrbf_settings perform_record_solver(const perform_options *options, const face_file *on,
                                     log_queue *log)
{
    show *there = NULL;
    error ignored = {""};
    if (options->record && access(options->record, F_OK) == 0 &&
        show_open(&there, options->record, SHOW_READ, &ignored) < 0)
        there = NULL;
    const csrbf_settings out = kept_solver_for(there, on, log);
    show_close(there);
    return out;
}

mrt_result perform_record_start(perform_record *out, const perform_options *options,
                                const perform_record_of *of, error *err)
{
    *out = (perform_record){0};
    if (!options->record)
        return MRT_OK;
    mrt_result result = describe(out, options, of, err);
    if (result >= 0)
        result = open_show(out, options->record, err);
    if (result < 0)
        return result;
    out->performer = of->performer;
    out->log = of->log;
    taught_recall(out->show, layer_mapping(performer_layer(of->performer)), of->log);
    const char *texts[PERFORM_INPUTS_MAX];
    for (uint32_t i = 0; i < options->input_count; ++i)
        texts[i] = out->input_text[i];
    recorder_settings settings = {
        .show = out->show,
        .plugins = of->plugins,
        .log = of->log,
        .clock = of->clock,
        .inputs = of->inputs,
        .input_text = texts,
        .input_count = of->input_count,
        .calibration = {out->calibration[MRT_LEFT], out->calibration[MRT_RIGHT]},
        .layer = performer_layer(of->performer),
        .performer = of->performer,
        .face_path = options->face,
        .face = of->face,
        .unit_mm = unit_mm(options->unit),
        .hand_length_mm = options->hand_length_mm,
        .rezero_pedal = options->rezero_pedal,
    };
    result = recorder_start(&out->recorder, &settings, err);
    if (result < 0)
        return result;
    const writer_slate slate = {options->scene, options->shot, 0};
    recorder_take_next(out->recorder, &slate);
    if (!options->has_sound)
        return MRT_OK;
    if (of->clock == CLOCK_VIRTUAL)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "--sound: recordings are played faster than anybody speaks: --realtime");
    return perform_sound_start(&out->sound, out->show, recorder_writer(out->recorder), err);
}

void perform_record_watch(perform_record *self)
{
    if (!self->recorder)
        return;
    perform_sound_update(&self->sound);
    perform_record_watch_writer(recorder_writer(self->recorder), &self->is_waiting_told);
}

void perform_record_watch_writer(writer *of, bool *is_told)
{
    char text[512];
    writer_status status = writer_status_of(of);
    bool is_well = status.state == WRITER_OK && !status.is_missing;
    if (is_well == !*is_told)
        return;
    *is_told = !is_well;
    writer_message(of, text, sizeof text);
    fprintf(stderr, "%s: %s\n", is_well ? "note" : "warning",
            is_well ? "recording goes on: what was held in memory is written" : text);
}

mrt_result perform_record_end(perform_record *self, facts *told, error *err)
{
    char name[32];
    if (!self->recorder)
        return MRT_OK;
    perform_sound_stop(&self->sound);
    mrt_result result = recorder_take_end(self->recorder, err);
    self->take = recorder_take(self->recorder);
    if (result >= 0 && recorder_problem(self->recorder)[0])
        result = error_set(err, MRT_ERR_IO, "%s", recorder_problem(self->recorder));
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    if (result >= 0)
        result = perform_sound_attach(&self->sound, self->take, told, err);
    taught_keep_now(self->show, layer_mapping(performer_layer(self->performer)), self->log);
    writer_status status = writer_status_of(recorder_writer(self->recorder));
    error later = {""};
    mrt_result stopped = recorder_stop(self->recorder, &later);
    self->recorder = NULL;
    if (stopped < 0) /* it says more than what failed before it */
        result = error_set(err, stopped, "%s", later.text);
    if (result < 0)
        return result;
    snprintf(name, sizeof name, "%jd", (intmax_t)self->take);
    facts_text(told, "show", "show", show_path(self->show));
    facts_text(told, "take", "take", name);
    facts_number(told, "samples_recorded", "samples recorded", (double)status.committed_count, 0,
                 "");
    if (status.lost_count)
        facts_number(told, "samples_not_recorded", "not recorded", (double)status.lost_count, 0,
                     "samples");
    return MRT_OK;
}

void perform_record_rescue(show *of)
{
    char path[4096];
    error err = {""};
    const mrt_result result = of ? show_rescue_beside(of, path, sizeof path, &err) : MRT_END;
    if (result < 0)
        fprintf(stderr, "error: %s: was deleted, moved or replaced, and is lost: %s\n",
                show_path(of), err.text);
    else if (result != MRT_END)
        fprintf(stderr, "warning: %s: was deleted, moved or replaced: all of it is in %s\n",
                show_path(of), path);
}

void perform_record_finish(perform_record *self)
{
    error ignored = {""};
    perform_sound_finish(&self->sound);
    if (self->recorder && recorder_stop(self->recorder, &ignored) < 0)
        fprintf(stderr, "warning: %s\n", ignored.text);
    perform_record_rescue(self->show);
    show_close(self->show);
    for (int i = 0; i < PERFORM_INPUTS_MAX; ++i)
        free(self->input_text[i]);
    free(self->calibration[MRT_LEFT]);
    free(self->calibration[MRT_RIGHT]);
    *self = (perform_record){0};
}
