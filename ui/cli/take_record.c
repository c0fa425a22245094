/* Subcommands that make new takes from an existing one. */
#include "base/cancel.h"
#include "base/clock.h"
#include "base/text.h"
#include "hand/calibration_file.h"
#include "stage/mapping/plugins.h"
#include "stage/perform/patch_file.h"
#include "stage/sound/sound.h"
#include "stage/record/recorder.h"
#include "stage/record/overdub.h"
#include "cli/take.h"
#include "show/edit_store.h"
#include "cli/terminal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- take record: perform over a take that plays ---- */

typedef struct performing { /* created in this order, destroyed in reverse */
    take_call *call;
    log_queue *log;
    plugin_list plugins;
    take take;
    face_file face;
    char *face_path;
    plugin_spec spec[PERFORM_INPUTS_MAX];
    perform_inputs inputs;
    perform_hands hands;
    char *calibration[2];
    plugin_spec map;
    perform_mapping mapping;
    patch patch; /* of --patch */
    edit own;    /* parts of the face that the new layer moves */
    overdub *overdub;
    sound *sound; /* sound of the take, played during the performance; NULL: none */
    player_report report;
    bool is_waiting_told; /* reported that the disk is not writable now */
} performing;

/* ---- inputs and mapping ---- */

/* Opens the mapping of --map. */
static mrt_result open_mapping(take_call *call, plugin_spec *spec, perform_mapping *out,
                               const perform_mapping_settings *with, error *err)
{
    const char *text = call->text[TAKE_MAP];
    if (!plugin_spec_read(spec, text) || spec->address[0])
        return take_misused(call, err, "--map \"%s\" is not PLUGIN[,key=value]", text);
    return perform_mapping_open(out, spec, with, err);
}

static mrt_result open_inputs(performing *self, error *err)
{
    take_call *call = self->call;
    for (uint32_t i = 0; i < call->input_count; ++i)
        if (!plugin_spec_read(&self->spec[i], call->input[i]))
            return take_misused(call, err, "--input \"%s\" is not PLUGIN[:ADDRESS][,key=value]",
                                call->input[i]);
    return perform_inputs_open(&self->inputs, self->spec, call->input_count, &self->plugins,
                               self->log, call->text[TAKE_REALTIME] ? CLOCK_REAL : CLOCK_VIRTUAL,
                               err);
}

static mrt_result choose_hands(performing *self, error *err)
{
    mrt_result result = perform_hands_choose(&self->hands, self->call->calibration,
                                             self->call->calibration_count, &self->inputs, err);
    for (int side = 0; side < 2 && result >= 0; ++side)
        if (self->hands.path[side])
            result = perform_hands_text(self->calibration, self->hands.path[side], err);
    return result;
}

/* ---- settings of the overdub ---- */

static mrt_result read_count(take_call *call, take_option option, double most, uint32_t *out,
                             error *err)
{
    double number = *out;
    mrt_result result = take_number(call, option, 1.0, most, &number, err);
    *out = (uint32_t)number;
    if (result >= 0 && (double)*out < number)
        return take_misused(call, err, "--%s \"%s\" is not a whole number",
                            take_option_name(option), call->text[option]);
    return result;
}

static mrt_result read_times(performing *self, overdub_plan *out, error *err)
{
    take_call *call = self->call;
    double fade_s = 0.25, preroll_s = 0.0, count_in_s = 0.0;
    out->speed = 1.0;
    out->passes = 1;
    mrt_result result = take_time(call, TAKE_IN, &self->take, &out->in_ns, err);
    if (result >= 0)
        result = take_time(call, TAKE_OUT, &self->take, &out->out_ns, err);
    if (result >= 0)
        result = take_number(call, TAKE_FADE, 0.0, 60.0, &fade_s, err);
    if (result >= 0)
        result = take_number(call, TAKE_PREROLL, 0.0, 600.0, &preroll_s, err);
    if (result >= 0)
        result = take_number(call, TAKE_COUNT_IN, 0.0, 600.0, &count_in_s, err);
    if (result >= 0)
        result = read_count(call, TAKE_PASSES, 99.0, &out->passes, err);
    if (result >= 0)
        result = take_number(call, TAKE_SPEED, TRANSPORT_SPEED_MIN, TRANSPORT_SPEED_MAX,
                             &out->speed, err);
    bool is_ranged = call->text[TAKE_IN] || call->text[TAKE_OUT];
    out->fade_ns = is_ranged ? (int64_t)(fade_s * 1e9) : 0;
    out->preroll_ns = (int64_t)(preroll_s * 1e9);
    out->count_in_ns = (int64_t)(count_in_s * 1e9);
    return result;
}

static mrt_result read_layer(performing *self, overdub_settings *out, error *err)
{
    take_call *call = self->call;
    edit_init(&self->own, EDIT_LAYER_OWN);
    mrt_result result =
        read_count(call, TAKE_REZERO_PEDAL, MRT_MAX_PEDALS, &out->recorder.rezero_pedal, err);
    if (result >= 0 && call->text[TAKE_LAYER])
        result = take_find_layer(call, &self->take, &out->plan.into_layer, err);
    if (result >= 0 && call->text[TAKE_OWN])
        result = take_read_own(call, call->text[TAKE_OWN], &self->own, err);
    if (result >= 0 && call->text[TAKE_LAYER] && call->text[TAKE_OWN])
        result = take_misused(call, err, "--layer and --own cannot be combined");
    out->plan.own = self->own.own;
    out->plan.own_count = self->own.own_count;
    snprintf(out->plan.name, sizeof out->plan.name, "%s",
             call->text[TAKE_NAME_OPTION] ? call->text[TAKE_NAME_OPTION] : "");
    return result;
}

static mrt_result prepare(performing *self, error *err)
{
    take_call *call = self->call;
    overdub_settings settings = {.recorder = {.show = call->show}};
    if (call->input_count == 0)
        return take_misused(call, err, "--input is missing");
    mrt_result result = take_need(call, TAKE_MAP, err);
    if (result < 0)
        return result;
    self->log = log_queue_create();
    if (!self->log)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    result = plugin_list_load(&self->plugins, err);
    if (result >= 0)
        result = take_read(call, call->word[1], &self->take, err);
    if (result >= 0)
        result = read_times(self, &settings.plan, err);
    if (result >= 0)
        result = read_layer(self, &settings, err);
    if (result >= 0)
        result = take_face_read(&self->face, &self->face_path, call, &self->take,
                                call->text[TAKE_FACE], err);
    if (result >= 0)
        result = open_inputs(self, err);
    const perform_mapping_settings with = {&self->plugins, self->log, self->inputs.clock,
                                           ISOLATE_FOREIGN};
    if (result >= 0)
        result = open_mapping(call, &self->map, &self->mapping, &with, err);
    if (result >= 0)
        result = choose_hands(self, err);
    if (result < 0)
        return result;
    settings.take = self->take.id;
    settings.recorder.plugins = &self->plugins;
    settings.recorder.log = self->log;
    settings.recorder.face = &self->face;
    settings.recorder.face_path = self->face_path;
    settings.recorder.clock = self->inputs.clock;
    settings.recorder.inputs = self->inputs.input;
    settings.recorder.input_text = call->input;
    settings.recorder.input_count = self->inputs.count;
    for (int side = 0; side < 2; ++side) {
        settings.recorder.calibration[side] = self->calibration[side];
        settings.side_length_mm[side] = self->hands.length_mm[side];
    }
    settings.recorder.mapping = &self->mapping.instance;
    if (call->text[TAKE_PATCH]) {
        result = patch_file_find(&self->patch, call->text[TAKE_PATCH], err);
        settings.recorder.patch = &self->patch;
    }
    return result < 0 ? result : overdub_create(&self->overdub, &settings, err);
}

static mrt_result finish(performing *self, mrt_result so_far, error *err)
{
    sound_destroy(self->sound);
    overdub_destroy(self->overdub);
    const mrt_result result = perform_record_rescue(self->call->show, so_far, err);
    edit_finish(&self->own);
    perform_mapping_close(&self->mapping);
    plugin_spec_finish(&self->map);
    free(self->calibration[0]);
    free(self->calibration[1]);
    perform_hands_finish(&self->hands);
    perform_inputs_close(&self->inputs);
    for (int i = 0; i < PERFORM_INPUTS_MAX; ++i)
        plugin_spec_finish(&self->spec[i]);
    face_file_destroy(&self->face);
    free(self->face_path);
    take_finish(&self->take);
    plugin_list_destroy(&self->plugins);
    if (self->log)
        news_print(self->log);
    log_queue_destroy(self->log);
    return result;
}

/* ---- during the performance ---- */

/* If the sound cannot be played, the performance continues without it. */
static void start_sound(performing *self)
{
    error err = {""};
    const take_audio *audio = &overdub_take(self->overdub)->audio;
    const sound_settings settings = {.show = self->call->show, .log = self->log};
    if (self->inputs.clock == CLOCK_VIRTUAL || audio->audio == 0)
        return;
    if (sound_create(&self->sound, &settings, &err) < 0 || sound_load(self->sound, audio, &err) < 0)
        fprintf(stderr, "warning: %s; the take plays without sound\n", err.text);
}

static void move_sound(performing *self)
{
    const transport *t = overdub_transport(self->overdub);
    if (!self->sound)
        return;
    sound_update(self->sound);
    if (!t)
        return;
    sound_motion motion = sound_motion_of(t, clock_now_ns());
    sound_move(self->sound, &motion);
}

/* Offline, a failed mapping ends the performance. On stage the face is held. */
static mrt_result check_mappings(const performing *self, error *err)
{
    mrt_result result = perform_mapping_check(&self->mapping, err);
    if (result >= 0 && self->inputs.clock == CLOCK_VIRTUAL)
        result = overdub_check(self->overdub, err);
    return result;
}

static mrt_result on_frame(void *data, uint32_t index, double time_s, int64_t work_ns, error *err)
{
    performing *self = data;
    char text[64];
    (void)index, (void)time_s, (void)work_ns;
    news_print(self->log);
    move_sound(self);
    perform_record_watch_writer(recorder_writer(overdub_recorder(self->overdub)),
                                &self->is_waiting_told);
    for (char key = keys_next(); key; key = keys_next())
        if (key == 'q')
            cancel_request();
    snprintf(text, sizeof text, "%s %.1f s",
             overdub_is_recording(self->overdub) ? "recording" : "ready",
             (double)overdub_at_ns(self->overdub) / 1e9);
    progress_show(&self->call->shown, -1.0, text);
    return check_mappings(self, err);
}

static void on_incident(void *data, const input *from, const input_incident *what, double time_s)
{
    performing *self = data;
    progress_end(&self->call->shown);
    perform_inputs_incident(&self->inputs, overdub_recorder(self->overdub), from, what, time_s);
}

static mrt_result perform(performing *self, error *err)
{
    player_settings playing = {.fps = 30.0,
                               .clock = self->inputs.clock,
                               .stop = cancel_flag(),
                               .calibration = {perform_hands_calibration(&self->hands, MRT_LEFT),
                                               perform_hands_calibration(&self->hands, MRT_RIGHT)}};
    player_events events = {.frame = on_frame, .incident = on_incident, .data = self};
    cancel_on_signals(CANCEL_WAITS, NULL);
    start_sound(self);
    if (self->inputs.clock == CLOCK_REAL && keys_begin())
        fprintf(stderr, "note: keys: q ends\n");
    progress_start(&self->call->shown, "performing");
    mrt_result result = player_run_stage(overdub_frame(self->overdub), self->inputs.input,
                                         self->inputs.count, &playing, &events, &self->report, err);
    keys_end();
    progress_end(&self->call->shown);
    news_print(self->log);
    return result < 0 ? result : check_mappings(self, err);
}

static void tell(performing *self, const overdub_made *made)
{
    facts *told = self->call->told;
    char text[64];
    perform_mapping_report(&self->mapping, told);
    facts_number(told, "samples", "samples performed", (double)self->report.sample_count, 0, "");
    snprintf(text, sizeof text, "%u", made->last_layer);
    facts_text(told, "layer", "layer", text);
    facts_number(told, "layers", "passes kept", made->layer_count, 0, "");
    facts_number(told, "in_s", "from", (double)made->from_ns / 1e9, 3, "s");
    facts_number(told, "out_s", "to", (double)made->to_ns / 1e9, 3, "s");
    snprintf(text, sizeof text, "%lld", (long long)made->raw_take);
    facts_text(told, "raw_take", "own take", text);
    facts_number(told, "edits", "edits", made->edit_count, 0, "(undo all: take undo --steps)");
}

/* Adds the performance so far to the take, however it ended. */
static mrt_result keep(performing *self, mrt_result performed, error *err)
{
    overdub_made made;
    error later = {""};
    mrt_result result = overdub_finish(self->overdub, &made, &later);
    self->call->is_told = result >= 0;
    if (result >= 0)
        tell(self, &made);
    if (performed < 0)
        return performed;
    if (result < 0)
        return error_set(err, result, "%s", later.text);
    return self->report.input_failed
               ? error_set(err, MRT_ERR_IO, "an input failed; everything before that is kept")
               : MRT_OK;
}

mrt_result take_record_run(take_call *call, error *err)
{
    performing self = {.call = call};
    mrt_result result = prepare(&self, err);
    if (result >= 0)
        result = keep(&self, perform(&self, err), err);
    return finish(&self, result, err);
}

/* ---- take remap: performs the tracks of a take again with another mapping, calibration, filter or
 * face ---- */

enum { PERFORMANCES_MAX = 256 };

typedef struct remap {
    take_call *call;
    take old;
    show_take made; /* row of the old take */
    log_queue *log;
    plugin_list plugins;
    plugin_spec map;         /* of --map */
    perform_mapping mapping; /* in this process or in a separate one */
    face_file face;          /* of --face */
    char *calibration[2];
    char *patch;           /* of --patch; NULL: none */
    double hand_length_mm; /* 0: unchanged */
    take_again filter;     /* settings of the filter */
    int64_t then[PERFORMANCES_MAX], now[PERFORMANCES_MAX];
    uint32_t count;
    show_edits edits;
    char **json; /* edits of the new take: those of the old one, then others */
    size_t json_count;
    show_span *span;
    size_t span_count;
} remap;

/* ---- the changed settings ---- */

/* Reads "min_cutoff=1,beta=0.02". */
static mrt_result read_filter(remap *self, error *err)
{
    const char *text = self->call->text[TAKE_FILTER];
    text_view rest = text_view_of(text, text ? strlen(text) : 0), field, key;
    while (text && text_next_field(&rest, ',', &field)) {
        double value = -1.0;
        bool has_key = text_next_field(&field, '=', &key);
        bool is_number = has_key && text_double(text_trim(field), &value);
        if (is_number && text_equals(key, "min_cutoff") && value >= 0.001 && value <= 1000.0) {
            self->filter.min_cutoff_hz = value;
        } else if (is_number && text_equals(key, "beta") && value >= 0.0 && value <= 100.0) {
            self->filter.has_beta = true;
            self->filter.beta = value;
        } else {
            return take_misused(self->call, err,
                                "--filter \"%s\" is not min_cutoff=HZ (0.001 to 1000), beta=N (0 "
                                "to 100), or both with a comma",
                                text);
        }
    }
    return MRT_OK;
}

static mrt_result read_patch(remap *self, error *err)
{
    const char *path = self->call->text[TAKE_PATCH];
    if (!path || strcmp(path, "none") == 0)
        return MRT_OK;
    patch *p = malloc(sizeof *p);
    if (!p)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a patch");
    mrt_result result = patch_file_find(p, path, err);
    if (result >= 0)
        result = patch_file_write(&self->patch, p, err);
    free(p);
    return result;
}

static mrt_result read_requested(remap *self, error *err)
{
    const take_call *call = self->call;
    if (!call->text[TAKE_MAP] && !call->text[TAKE_PATCH] && !call->text[TAKE_FACE] &&
        !call->text[TAKE_FILTER] && !call->text[TAKE_HAND_LENGTH] && call->calibration_count == 0)
        return take_misused(self->call, err,
                            "nothing to change: give --map, --patch, --face, --calibration, "
                            "--hand-length or --filter");
    mrt_result result = read_filter(self, err);
    if (result >= 0)
        result = take_number(self->call, TAKE_HAND_LENGTH, 50, 400, &self->hand_length_mm, err);
    if (result >= 0)
        result = plugin_list_load(&self->plugins, err);
    const perform_mapping_settings with = {&self->plugins, self->log, CLOCK_VIRTUAL,
                                           ISOLATE_FOREIGN};
    if (result >= 0 && call->text[TAKE_MAP])
        result = open_mapping(self->call, &self->map, &self->mapping, &with, err);
    if (result >= 0)
        result = read_patch(self, err);
    for (uint32_t i = 0; i < call->calibration_count && result >= 0; ++i)
        result = perform_hands_text(self->calibration, call->calibration[i], err);
    if (result >= 0 && call->text[TAKE_FACE])
        result = face_file_read(&self->face, call->text[TAKE_FACE], NULL, FACE_FILE_USABLE, err);
    return result;
}

/* ---- the performances ---- */

static mrt_result describe(remap *self, take_performance *p, error *err)
{
    mrt_result result = MRT_OK;
    p->again.of = p->id;
    const instance *mapping = &self->mapping.instance;
    if (mapping->type) {
        free(p->mapping);
        p->mapping = recorder_plugin_identity(&self->plugins, mapping->type);
        if (!p->mapping)
            return error_set(err, MRT_ERR_MEMORY, "no memory for a performance");
        recorder_param_values(p, mapping);
        p->again.ignores_params = true;
    }
    if (self->face.mesh.vertex_count > 0)
        result = recorder_face_identity(p, &self->face, self->call->text[TAKE_FACE], 0.0, err);
    for (int side = 0; side < 2 && result >= 0; ++side) {
        if (!self->calibration[side])
            continue;
        free(p->again.calibration[side]);
        p->again.calibration[side] = strdup(self->calibration[side]);
        if (!p->again.calibration[side])
            result = error_set(err, MRT_ERR_MEMORY, "no memory for a performance");
    }
    if (self->call->text[TAKE_PATCH]) {
        free(p->patch);
        p->patch = self->patch ? strdup(self->patch) : NULL;
        if (self->patch && !p->patch)
            return error_set(err, MRT_ERR_MEMORY, "no memory for a performance");
    }
    if (self->hand_length_mm > 0.0)
        p->hand_length_mm = self->hand_length_mm;
    if (self->filter.min_cutoff_hz > 0.0)
        p->again.min_cutoff_hz = self->filter.min_cutoff_hz;
    if (self->filter.has_beta) {
        p->again.has_beta = true;
        p->again.beta = self->filter.beta;
    }
    return result;
}

static mrt_result perform_again(remap *self, int64_t performance, error *err)
{
    show_performance of;
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->then[i] == performance)
            return MRT_OK;
    if (self->count == PERFORMANCES_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED, "take %lld has more than %d performances",
                         (long long)self->old.id, PERFORMANCES_MAX);
    mrt_result result = show_performance_read(self->call->show, performance, &of, err);
    if (result < 0)
        return result;
    result = describe(self, &of.performance, err);
    if (result >= 0)
        result = show_performance_create(self->call->show, &of.performance, err);
    if (result >= 0) {
        self->then[self->count] = performance;
        self->now[self->count++] = of.performance.id;
    }
    show_performance_finish(&of);
    return result;
}

/* ---- the new take ---- */

/* The edits of the old take define its clips, so they are copied. Slate, deletion and restoring are
 * not: the new take has its own. */
static bool is_copied(const char *json)
{
    edit e;
    error ignored = {""};
    if (edit_parse(&e, json, strlen(json), &ignored) < 0)
        return true;
    bool is_own =
        e.kind == EDIT_TAKE_SLATE || e.kind == EDIT_TAKE_DELETE || e.kind == EDIT_TAKE_RESTORE;
    edit_finish(&e);
    return !is_own;
}

static mrt_result perform_clip(remap *self, const take_clip *c, error *err)
{
    edit e;
    mrt_result result = perform_again(self, c->performance, err);
    if (result < 0)
        return result;
    edit_init(&e, EDIT_CLIP_PERFORM);
    e.clip = c->id;
    for (uint32_t i = 0; i < self->count; ++i)
        if (self->then[i] == c->performance)
            e.performance = self->now[i];
    result = edit_write(&self->json[self->json_count], &e, err);
    self->json_count += result >= 0;
    self->span[self->span_count++] =
        (show_span){.performance = e.performance, .from_ns = c->from_ns, .to_ns = c->to_ns};
    return result;
}

static mrt_result gather(remap *self, error *err)
{
    show_span *spans;
    size_t clip_count = 0, old_count;
    show *s = self->call->show;
    for (uint32_t i = 0; i < self->old.layer_count; ++i)
        clip_count += self->old.layer[i].clip_count;
    if (clip_count == 0)
        return error_set(err, MRT_ERR_ARGUMENT, "take %lld is empty: it has no performance",
                         (long long)self->old.id);
    mrt_result result = show_edits_of(s, &self->made, &self->edits, err);
    if (result >= 0)
        result = show_take_spans(s, self->old.id, &spans, &old_count, err);
    if (result < 0)
        return result;
    self->json = calloc(self->edits.count + clip_count, sizeof *self->json);
    self->span = calloc(old_count + clip_count, sizeof *self->span);
    if (!self->json || !self->span) {
        free(spans);
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    }
    memcpy(self->span, spans, old_count * sizeof *spans);
    self->span_count = old_count;
    free(spans);
    for (size_t i = 0; i < self->edits.count; ++i) {
        show_edit *of = &self->edits.edit[i];
        if (of->n > self->edits.head || !is_copied(of->json))
            continue;
        self->json[self->json_count++] = of->json;
        of->json = NULL;
    }
    for (uint32_t i = 0; i < self->old.layer_count && result >= 0; ++i)
        for (uint32_t k = 0; k < self->old.layer[i].clip_count && result >= 0; ++k)
            result = perform_clip(self, &self->old.layer[i].clip[k], err);
    return result;
}

static mrt_result make_take(remap *self, int64_t *out_id, error *err)
{
    const take_call *call = self->call;
    char origin[96];
    const instance *mapping = &self->mapping.instance;
    (void)snprintf(origin, sizeof origin, "take %lld through %.60s", (long long)self->old.id,
                   mapping->type ? mapping->type->id : "its own mapping, anew");
    const show_new_take made = {
        .created_ns = clock_utc_ms() * 1000000,
        .start_ns = self->made.start_ns,
        .end_ns = self->made.end_ns,
        .scene = call->text[TAKE_SCENE] ? call->text[TAKE_SCENE] : self->old.scene,
        .shot = call->text[TAKE_SHOT] ? call->text[TAKE_SHOT] : self->old.shot,
        .origin = origin,
        .spans = self->span,
        .span_count = self->span_count,
        .base_edits = (const char *const *)self->json,
        .base_edit_count = self->json_count,
        .utc_ms = clock_utc_ms()};
    return show_take_create(call->show, &made, out_id, err);
}

static void finish_remap(remap *self)
{
    for (size_t i = 0; i < self->json_count; ++i)
        free(self->json[i]);
    free(self->json);
    free(self->span);
    show_edits_finish(&self->edits);
    free(self->calibration[0]);
    free(self->calibration[1]);
    free(self->patch);
    face_file_destroy(&self->face);
    perform_mapping_close(&self->mapping);
    plugin_spec_finish(&self->map);
    plugin_list_destroy(&self->plugins);
    if (self->log)
        news_print(self->log);
    log_queue_destroy(self->log);
    take_finish(&self->old);
}

static mrt_result report_remap(remap *self, int64_t id, error *err)
{
    take now;
    char a[24], b[24];
    take_call *call = self->call;
    mrt_result result = edit_store_take(&now, call->show, id, err);
    if (result < 0)
        return result;
    facts_text(call->told, "take", "take", take_slate_text(now.scene, now.shot, now.number).text);
    facts_number(call->told, "take_id", "take id", (double)id, 0, "");
    facts_text(call->told, "origin", "origin", now.origin);
    facts_number(call->told, "performances", "performed again", self->count, 0, "");
    take_finish(&now);
    (void)snprintf(a, sizeof a, "%lld", (long long)self->old.id);
    (void)snprintf(b, sizeof b, "%lld", (long long)id);
    call->text[TAKE_FACE] = NULL; /* each take on its own face */
    error why = {""};
    if (take_diff_report(call, a, b, &why) < 0)
        fprintf(stderr, "note: the two takes are not compared: %s\n", why.text);
    return MRT_OK;
}

mrt_result take_remap_run(take_call *call, error *err)
{
    int64_t id = 0;
    remap *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory");
    self->call = call;
    self->log = log_queue_create();
    mrt_result result =
        self->log ? read_requested(self, err) : error_set(err, MRT_ERR_MEMORY, "no memory");
    if (result >= 0)
        result = take_read(call, call->word[1], &self->old, err);
    if (result >= 0)
        result = show_take_read(call->show, self->old.id, &self->made, err);
    if (result >= 0)
        result = gather(self, err);
    if (result >= 0)
        result = make_take(self, &id, err);
    if (result >= 0)
        result = report_remap(self, id, err);
    finish_remap(self);
    free(self);
    return result;
}
