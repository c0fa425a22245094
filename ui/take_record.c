/* marotte take record: somebody performs over a take that plays. */
#include "base/cancel.h"
#include "base/clock.h"
#include "keys.h"
#include "news.h"
#include "perform_hands.h"
#include "perform_mapping.h"
#include "perform_record.h"
#include "stage/input/spec.h"
#include "stage/take/overdub.h"
#include "stage/sound/sound.h"
#include "take_change.h"
#include "take_play.h"
#include "take_stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct performing { /* made in this order, destroyed in reverse */
    take_call *call;
    log_queue *log;
    plugin_list plugins;
    take take;
    face_file face;
    char *face_path;
    instance_clock clock;
    plugin_spec spec[PERFORM_INPUTS_MAX];
    uint32_t spec_count;
    input *inputs[PERFORM_INPUTS_MAX];
    uint32_t input_count;
    perform_hands hands;
    char *calibration[2];
    plugin_spec map;
    perform_mapping mapping;
    edit own; /* what the new layer moves */
    overdub *overdub;
    sound *sound; /* of the take, heard while it is performed over; NULL: none */
    player_report report;
    bool is_waiting_told; /* that the disk does not take it now */
} performing;

/* ---- who performs ---- */

static mrt_result open_inputs(performing *self, error *err)
{
    take_call *call = self->call;
    const mrt_plugin_type *types[PERFORM_INPUTS_MAX];
    self->clock = call->text[TAKE_REALTIME] ? CLOCK_REAL : CLOCK_VIRTUAL;
    for (uint32_t i = 0; i < call->input_count; ++i) {
        if (!spec_read(&self->spec[self->spec_count++], call->input[i]))
            return take_misused(call, err, "--input \"%s\" is not PLUGIN[:ADDRESS][,key=value]",
                                call->input[i]);
        mrt_result result =
            plugin_list_choose(&self->plugins, self->spec[i].plugin, MRT_INPUT, &types[i], err);
        if (result < 0)
            return result;
        const mrt_input *functions = plugin_interface(types[i], MRT_INPUT);
        if (!(functions->flags & MRT_INPUT_RECORDED))
            self->clock = CLOCK_REAL;
    }
    for (uint32_t i = 0; i < call->input_count; ++i) {
        mrt_result result = input_create(&self->inputs[i], types[i], self->spec[i].address,
                                         self->spec[i].params, self->clock, self->log, err);
        if (result < 0)
            return result;
        self->input_count += 1;
    }
    return MRT_OK;
}

static mrt_result open_mapping(performing *self, error *err)
{
    take_call *call = self->call;
    const perform_mapping_settings apart = {&self->plugins, self->log, self->clock,
                                            PERFORM_ISOLATE_AUTO};
    if (!spec_read(&self->map, call->text[TAKE_MAP]) || self->map.address[0])
        return take_misused(call, err, "--map \"%s\" is not PLUGIN[,key=value]",
                            call->text[TAKE_MAP]);
    return perform_mapping_open(&self->mapping, &self->map, &apart, err);
}

static mrt_result choose_hands(performing *self, error *err)
{
    perform_options options = {.calibration_count = self->call->calibration_count};
    for (uint32_t i = 0; i < options.calibration_count; ++i)
        options.calibration[i] = self->call->calibration[i];
    mrt_result result =
        perform_hands_choose(&self->hands, &options, self->inputs, self->input_count, err);
    for (int side = 0; side < 2 && result >= 0; ++side)
        if (self->hands.path[side])
            result = perform_hands_text(&self->calibration[side], self->hands.path[side], err);
    return result;
}

/* ---- what is made of it ---- */

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

static mrt_result read_times(performing *self, overdub_settings *out, error *err)
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

static mrt_result read_place(performing *self, overdub_settings *out, error *err)
{
    take_call *call = self->call;
    edit_init(&self->own, EDIT_LAYER_OWN);
    mrt_result result =
        read_count(call, TAKE_REZERO_PEDAL, MRT_MAX_PEDALS, &out->rezero_pedal, err);
    if (result >= 0 && call->text[TAKE_LAYER])
        result = take_find_layer(call, &self->take, &out->into_layer, err);
    if (result >= 0 && call->text[TAKE_OWN])
        result = take_read_own(call, call->text[TAKE_OWN], &self->own, err);
    if (result >= 0 && call->text[TAKE_LAYER] && call->text[TAKE_OWN])
        result = take_misused(call, err, "--layer has what it moves already: no --own");
    out->own = self->own.own;
    out->own_count = self->own.own_count;
    snprintf(out->name, sizeof out->name, "%s",
             call->text[TAKE_NAME_OPTION] ? call->text[TAKE_NAME_OPTION] : "");
    return result;
}

static mrt_result prepare(performing *self, error *err)
{
    take_call *call = self->call;
    overdub_settings settings = {.show = call->show};
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
        result = read_times(self, &settings, err);
    if (result >= 0)
        result = read_place(self, &settings, err);
    if (result >= 0)
        result = take_face_read(&self->face, &self->face_path, call, &self->take,
                                call->text[TAKE_FACE], err);
    if (result >= 0)
        result = open_inputs(self, err);
    if (result >= 0)
        result = open_mapping(self, err);
    if (result >= 0)
        result = choose_hands(self, err);
    if (result < 0)
        return result;
    settings.take = self->take.id;
    settings.plugins = &self->plugins;
    settings.log = self->log;
    settings.face = &self->face;
    settings.face_path = self->face_path;
    settings.clock = self->clock;
    settings.inputs = self->inputs;
    settings.input_text = call->input;
    settings.input_count = self->input_count;
    for (int side = 0; side < 2; ++side) {
        settings.calibration[side] = self->calibration[side];
        settings.side_length_mm[side] = self->hands.length_mm[side];
    }
    settings.mapping = &self->mapping.instance;
    return overdub_create(&self->overdub, &settings, err);
}

static void finish(performing *self)
{
    sound_destroy(self->sound);
    overdub_destroy(self->overdub);
    perform_record_rescue(self->call->show);
    edit_finish(&self->own);
    perform_mapping_close(&self->mapping);
    spec_finish(&self->map);
    free(self->calibration[0]);
    free(self->calibration[1]);
    perform_hands_finish(&self->hands);
    for (uint32_t i = 0; i < self->input_count; ++i)
        input_destroy(self->inputs[i]);
    for (uint32_t i = 0; i < self->spec_count; ++i)
        spec_finish(&self->spec[i]);
    face_file_destroy(&self->face);
    free(self->face_path);
    take_finish(&self->take);
    plugin_list_destroy(&self->plugins);
    if (self->log)
        news_print(self->log);
    log_queue_destroy(self->log);
}

/* ---- while it goes on ---- */

/* A sound that cannot be heard stops nothing. */
static void start_sound(performing *self)
{
    error err = {""};
    const take_audio *audio = &overdub_take(self->overdub)->audio;
    const sound_settings settings = {.show = self->call->show, .log = self->log};
    if (self->clock == CLOCK_VIRTUAL || audio->audio == 0)
        return;
    if (sound_create(&self->sound, &settings, &err) < 0 || sound_load(self->sound, audio, &err) < 0)
        fprintf(stderr, "warning: %s; it is performed in silence\n", err.text);
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

/* Offline a mapping that has failed ends it; on a stage the face is held. */
static mrt_result check_mappings(const performing *self, error *err)
{
    mrt_result result = perform_mapping_check(&self->mapping, err);
    if (result >= 0 && self->clock == CLOCK_VIRTUAL)
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
            cancel_ask();
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
    for (uint32_t i = 0; i < self->input_count; ++i)
        if (self->inputs[i] == from)
            recorder_incident(overdub_recorder(self->overdub), i, what);
    if (what->kind == INPUT_WENT)
        fprintf(stderr, "note: %s went away at %.1f s; the pose is held\n", input_name(from),
                time_s);
    else
        fprintf(stderr, "note: %s came back after %.1f s\n", input_name(from),
                (double)what->away_ns / 1e9);
}

static mrt_result perform(performing *self, error *err)
{
    player_settings playing = {.fps = 30.0,
                               .clock = self->clock,
                               .stop = cancel_flag(),
                               .calibration = {perform_hands_calibration(&self->hands, MRT_LEFT),
                                               perform_hands_calibration(&self->hands, MRT_RIGHT)}};
    player_events events = {.frame = on_frame, .incident = on_incident, .data = self};
    player_stage stage = overdub_stage(self->overdub);
    cancel_on_signals(CANCEL_WAITS, NULL);
    start_sound(self);
    if (self->clock == CLOCK_REAL && keys_begin())
        fprintf(stderr, "note: keys: q ends\n");
    progress_start(&self->call->shown, "performing");
    mrt_result result = player_run_stage(&stage, self->inputs, self->input_count, &playing, &events,
                                         &self->report, err);
    keys_end();
    progress_end(&self->call->shown);
    news_print(self->log);
    return result < 0 ? result : check_mappings(self, err);
}

static void tell(performing *self, const overdub_result *made)
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
    facts_text(told, "raw_take", "by itself", text);
    facts_number(told, "edits", "edits", made->edit_count, 0, "(undo --steps: all of it)");
}

/* However it ended: what was performed until then becomes a part of the take. */
static mrt_result keep(performing *self, mrt_result performed, error *err)
{
    overdub_result made;
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
               ? error_set(err, MRT_ERR_IO, "an input failed; what came before is kept")
               : MRT_OK;
}

mrt_result take_record_run(take_call *call, error *err)
{
    performing self = {.call = call};
    mrt_result result = prepare(&self, err);
    if (result >= 0)
        result = keep(&self, perform(&self, err), err);
    finish(&self);
    return result;
}
