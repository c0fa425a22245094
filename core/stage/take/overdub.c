#include "stage/overdub.h"
#include "base/clock.h"
#include "stage/overdub_run.h"
#include "take/edit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct overdub {
    overdub_settings settings;
    take take;
    sequencer *sequencer;
    layer *layer;
    recorder *recorder;
    uint8_t *owned;
    overdub_run run;
};

/* ---- made and unmade ---- */

static overdub_plan plan_of(const overdub_settings *s)
{
    overdub_plan out = {.own = s->own,
                        .own_count = s->own_count,
                        .into_layer = s->into_layer,
                        .in_ns = s->in_ns,
                        .out_ns = s->out_ns,
                        .fade_ns = s->fade_ns,
                        .count_in_ns = s->count_in_ns,
                        .preroll_ns = s->preroll_ns,
                        .passes = s->passes,
                        .speed = s->speed};
    memcpy(out.name, s->name, sizeof out.name);
    return out;
}

static bool moves_something(const overdub *self, const mrt_face *about)
{
    for (uint32_t i = 0; i <= about->contact_count + about->dof_count; ++i)
        if (self->owned[i])
            return true;
    return false;
}

/* The layer that performs, over the take's own. */
static mrt_result create_live(overdub *self, error *err)
{
    const overdub_settings *s = &self->settings;
    composer *shown = sequencer_composer(self->sequencer);
    layer_settings guard = {.hands.rezero_pedal = s->rezero_pedal, .keeps_taught = true};
    for (int side = 0; side < 2; ++side)
        guard.hands.length_mm[side] =
            s->hand_length_mm > 0 ? s->hand_length_mm : s->side_length_mm[side];
    guard.reach_mm = composer_reach_mm(shown, &guard.centre);
    mrt_result result = layer_create(&self->layer, s->mapping, composer_about(shown), &guard, err);
    if (result < 0)
        return result;
    const mrt_face *about = composer_about(shown);
    self->owned = calloc((size_t)about->contact_count + about->dof_count + 1, 1);
    if (!self->owned)
        return error_set(err, MRT_ERR_MEMORY, "no memory to perform over a take");
    const take_layer *over = overdub_punched(&self->run.plan, &self->take);
    take_layer own = {.own_count = s->own_count, .own = s->own};
    sequencer_mark_owned(shown, over ? over : &own, self->owned);
    if (!moves_something(self, about))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the layer would move nothing: no contact or degree of freedom of this "
                         "face is named \"%s\"",
                         (over ? over->own : s->own)[0]);
    sequencer_live live = {self->layer, self->owned, over ? over->is_additive : false};
    sequencer_set_live(self->sequencer, &live);
    sequencer_weigh_live(self->sequencer, 0.0);
    return MRT_OK;
}

static mrt_result create_recorder(overdub *self, error *err)
{
    const overdub_settings *s = &self->settings;
    recorder_settings settings = {
        .show = s->show,
        .plugins = s->plugins,
        .log = s->log,
        .clock = s->clock,
        .inputs = s->inputs,
        .input_text = s->input_text,
        .input_count = s->input_count,
        .calibration = {s->calibration[MRT_LEFT], s->calibration[MRT_RIGHT]},
        .layer = self->layer,
        .face_path = s->face_path,
        .face = s->face,
        .unit_mm = s->unit_mm,
        .hand_length_mm = s->hand_length_mm,
        .rezero_pedal = s->rezero_pedal,
        .state_bytes = SOURCE_STATE_MIN,
    };
    mrt_result result = recorder_start(&self->recorder, &settings, err);
    if (result < 0)
        return result;
    overdub_run_slate(&self->run, self->recorder);
    return MRT_OK;
}

static mrt_result create(overdub *self, error *err)
{
    const overdub_settings *s = &self->settings;
    mrt_result result = edit_store_take(&self->take, s->show, s->take, err);
    const overdub_plan plan = plan_of(s);
    if (result >= 0)
        result = overdub_plan_check(&plan, &self->take, err);
    if (result < 0)
        return result;
    overdub_run_init(&self->run, &plan, &self->take);
    sequencer_settings playing = {
        .show = s->show, .plugins = s->plugins, .log = s->log, .face = s->face};
    result = sequencer_create(&self->sequencer, &playing, &self->take, err);
    if (result >= 0)
        result = sequencer_seek(self->sequencer, self->run.start_ns, err);
    if (result >= 0) {
        taught_recall(s->show, s->mapping, s->log);
        result = create_live(self, err);
    }
    if (result >= 0)
        result = create_recorder(self, err);
    return result;
}

mrt_result overdub_create(overdub **out, const overdub_settings *settings, error *err)
{
    *out = NULL;
    overdub *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to perform over a take");
    self->settings = *settings;
    mrt_result result = create(self, err);
    if (result < 0) {
        overdub_destroy(self);
        return result;
    }
    *out = self;
    return MRT_OK;
}

void overdub_destroy(overdub *self)
{
    error ignored = {""};
    if (!self)
        return;
    if (self->recorder && recorder_stop(self->recorder, &ignored) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "recorder", ignored.text);
    sequencer_destroy(self->sequencer);
    layer_destroy(self->layer);
    take_finish(&self->take);
    free(self->owned);
    free(self);
}

/* ---- time goes on ---- */

/* The take as it is at a time of the clock. */
static mrt_result go_to(overdub *self, int64_t clock_ns, error *err)
{
    overdub_run *run = &self->run;
    mrt_result result = overdub_run_go_to(run, self->recorder, clock_ns, err);
    if (result < 0 || run->is_over || clock_ns < run->rolling_ns)
        return result;
    return sequencer_play_to(self->sequencer, run->at_ns, err);
}

bool overdub_is_recording(const overdub *self)
{
    return overdub_run_is_recording(&self->run);
}

static mrt_result on_step(void *of, const sample_step *s, error *err)
{
    overdub *self = of;
    mrt_result result = go_to(self, s->time_ns, err);
    if (result < 0 || self->run.is_over)
        return result;
    overdub_run_note(&self->run, self->recorder, s->time_ns);
    sequencer_weigh_live(self->sequencer, overdub_run_weight(&self->run));
    sequencer_live_step(self->sequencer, s);
    return MRT_OK;
}

static mrt_result on_draw(void *of, int64_t time_ns, error *err)
{
    overdub *self = of;
    mrt_result result = go_to(self, time_ns, err);
    composer_draw(sequencer_composer(self->sequencer));
    return result >= 0 && self->run.is_over ? MRT_END : result;
}

player_stage overdub_stage(overdub *self)
{
    return (player_stage){self, on_step, on_draw};
}

/* ---- it becomes a part of the take ---- */

static mrt_result make_edits(const overdub *self, history *h, overdub_result *out, error *err)
{
    edit *edits;
    uint32_t count;
    overdub_made made;
    mrt_result result =
        overdub_run_edits(&self->run, history_take(h), self->settings.mapping->type->name, &edits,
                          &count, &made, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < count && result >= 0; ++i)
        result = history_do(h, &edits[i], err);
    overdub_edits_destroy(edits, count);
    out->layer_count = made.layer_count;
    out->last_layer = made.last_layer;
    out->raw_take = made.raw_take;
    out->from_ns = made.from_ns;
    out->to_ns = made.to_ns;
    return result;
}

mrt_result overdub_finish(overdub *self, overdub_result *out, error *err)
{
    *out = (overdub_result){0};
    mrt_result result = overdub_run_end(&self->run, self->recorder, err);
    if (result >= 0 && recorder_problem(self->recorder)[0])
        result = error_set(err, MRT_ERR_IO, "%s", recorder_problem(self->recorder));
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    if (result < 0)
        return result;
    taught_keep_now(self->settings.show, layer_mapping(self->layer), self->settings.log);
    edit_store *store = NULL;
    history *h = NULL;
    result = edit_store_open(&store, self->settings.show, self->settings.take, clock_utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(store);
    result = history_open(&h, edit_store_bare(store), &list, err);
    int64_t head = result >= 0 ? history_head(h) : 0;
    if (result >= 0)
        result = make_edits(self, h, out, err);
    out->edit_count = h ? (uint32_t)(history_head(h) - head) : 0;
    history_close(h);
    edit_store_close(store);
    return result;
}

/* ---- what others see ---- */

composer *overdub_composer(overdub *self)
{
    return sequencer_composer(self->sequencer);
}

recorder *overdub_recorder(overdub *self)
{
    return self->recorder;
}

int64_t overdub_at_ns(const overdub *self)
{
    return self->run.at_ns;
}

const transport *overdub_transport(const overdub *self)
{
    return self->run.has_begun && !self->run.is_over ? &self->run.transport : NULL;
}

mrt_result overdub_check(const overdub *self, error *err)
{
    return sequencer_check(self->sequencer, err);
}

const take *overdub_take(const overdub *self)
{
    return &self->take;
}
