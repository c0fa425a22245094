/* [main] A take that is performed over. */
#include "base/clock.h"
#include "stage/live/live_state.h"
#include "take/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct beginning {
    recorder_cast *cast;
    overdub_run *run;
    uint8_t *owned;
    const take_layer *own;
    bool is_additive;
    uint64_t overs;
} beginning;

/* [frame] The take stands at the start. What was performed before does not count: so the layer's
 * samples alone say what is seen. */
static mrt_result begin_over(live_stage *stage, void *data, error *err)
{
    beginning *b = data;
    sequencer *s = stage->timeline->sequencer;
    layer *of = performer_layer(stage->scene->performer);
    const sequencer_live performs = {of, b->owned, b->is_additive};
    layer_begin_anew(of);
    sequencer_set_live(s, &performs);
    sequencer_weigh_live(s, 0.0);
    b->cast = recorder_change(stage->recorder, b->cast);
    overdub_run_slate(b->run, stage->recorder);
    stage->over = b->run;
    stage->owned = b->owned;
    stage->over_ns = 0;
    stage->mode = LIVE_OVERDUBS;
    stage->is_held = stage->is_awaited = stage->has_come = false;
    b->overs = ++stage->now.overs;
    stage->hold_until_ns = 0;
    return live_frame_tick(stage, err);
}

static mrt_result fetch_over(live_stage *stage, void *data, error *err)
{
    (void)err;
    beginning *b = data;
    b->run = stage->over;
    b->owned = stage->owned;
    stage->over = NULL;
    stage->owned = NULL;
    return MRT_OK;
}

static mrt_result moves_something(live *self, const take_layer *own, error *err)
{
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    bool any = own->own_count == 0;
    for (uint32_t i = 0; i < about->contact_count && !any; ++i)
        any = own_layer_owns(own, about->contacts[i].name);
    for (uint32_t i = 0; i < about->dof_count && !any; ++i)
        any = own_layer_owns(own, about->dofs[i].name);
    if (any)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "the layer would move nothing: no contact or degree of freedom of this face "
                     "is named \"%s\"",
                     own->own[0]);
}

void live_over_forget(live *self)
{
    error ignored = {""};
    beginning b = {0};
    (void)!live_ask(self, fetch_over, &b, &ignored);
    if (b.run)
        free(b.run->plan.own);
    free(b.run);
    free(b.owned);
}

static mrt_result plan_over(const live *self, const live_over *over, overdub_plan *out, error *err)
{
    *out = (overdub_plan){.own_count = over->own_count,
                          .into_layer = over->into_layer,
                          .in_ns = over->in_ns,
                          .out_ns = over->out_ns,
                          .fade_ns = over->fade_ns,
                          .count_in_ns = over->count_in_ns,
                          .preroll_ns = over->preroll_ns,
                          .passes = over->passes,
                          .speed = self->transport.speed};
    snprintf(out->name, sizeof out->name, "%s", over->name);
    if (over->passes == 0)
        out->passes = over->out_ns > 0 ? OVERDUB_PASSES_MAX : 1;
    out->own = calloc((size_t)over->own_count + 1, sizeof *out->own);
    if (!out->own)
        return error_set(err, MRT_ERR_MEMORY, "no memory to perform over a take");
    if (over->own_count > 0)
        memcpy(out->own, over->own, over->own_count * sizeof *out->own);
    mrt_result result = overdub_plan_check(out, &self->shown, err);
    if (result < 0)
        free(out->own);
    return result;
}

static mrt_result prepare_over(live *self, const overdub_plan *plan, beginning *b, error *err)
{
    const take_layer *punched = overdub_punched(plan, &self->shown);
    const mrt_face *about = composer_about(performer_composer(self->scene->performer));
    self->own = (take_layer){.own_count = plan->own_count, .own = plan->own};
    b->own = punched ? punched : &self->own;
    b->is_additive = punched && punched->is_additive;
    b->run = calloc(1, sizeof *b->run);
    b->owned = calloc((size_t)about->contact_count + about->dof_count + 1, 1);
    if (!b->run || !b->owned)
        return error_set(err, MRT_ERR_MEMORY, "no memory to perform over a take");
    overdub_run_init(b->run, plan, &self->shown);
    mrt_result result = moves_something(self, b->own, err);
    const recorder_settings as = live_cast_settings(self, false);
    return result < 0 ? result : recorder_prepare(self->recorder, &as, &b->cast, err);
}

/* All that the take performs with is opened, and it stands at the start. */
static mrt_result stand_at_start(live *self, const beginning *b, error *err)
{
    sequencer *s = self->timeline->sequencer;
    const overdub_plan *plan = &b->run->plan;
    int64_t to_ns = plan->out_ns > 0 ? plan->out_ns : INT64_MAX;
    mrt_result result = sequencer_seek(s, b->run->start_ns, err);
    if (result >= 0)
        result = sequencer_prepare(s, b->run->start_ns, to_ns, err);
    if (result >= 0)
        sequencer_mark_owned(sequencer_composer(s), b->own, b->owned);
    return result;
}

mrt_result live_record_over(live *self, const live_over *over, error *err)
{
    overdub_plan plan;
    beginning b = {0};
    if (!self->is_shown)
        return error_set(err, MRT_ERR_ARGUMENT, "no take is shown that could be performed over");
    if (!self->recorder)
        return error_set(err, MRT_ERR_ARGUMENT, "nothing is recorded: %s", self->why_not);
    mrt_result result = live_check_free(self, "another recording", err);
    if (result < 0)
        return result;
    live_pause(self);
    live_over_forget(self);
    self->is_over_done = false;
    result = plan_over(self, over, &plan, err);
    if (result < 0)
        return result;
    result = prepare_over(self, &plan, &b, err);
    if (result >= 0) {
        live_take_hold(self);
        result = stand_at_start(self, &b, err);
        if (result >= 0)
            result = live_ask(self, begin_over, &b, err);
        else
            live_take_release(self);
    }
    recorder_dismiss(self->recorder, b.cast);
    if (result < 0 && (!b.run || self->stage.over != b.run)) {
        free(plan.own);
        free(b.run);
        free(b.owned);
        return result;
    }
    self->is_over = self->status.is_recording = true;
    self->overs = b.overs;
    self->take_begun_ns = clock_now_ns();
    return result;
}

/* It stands where it was ended; hands perform as before. */
static void after_over(live *self)
{
    error err = {""};
    if (live_cast_anew(self, &err) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "recorder", err.text);
    const live_view *seen = &self->scene->board.view[slot_front(&self->scene->board.slot)];
    transport_seek(&self->transport, clock_now_ns(), seen->at_ns);
    live_take_tell_transport(self);
}

bool live_take_over(live *self, edit **out_edits, uint32_t *out_count, error *err)
{
    beginning b = {0};
    overdub_made made;
    *out_edits = NULL;
    *out_count = 0;
    if (!self->is_over_done)
        return false;
    self->is_over_done = false;
    if (!self->recorder || self->shown.id == 0) {
        live_over_forget(self);
        (void)error_set(err, MRT_ERR_ARGUMENT,
                        "what was performed over the take is a take by itself");
        return false;
    }
    after_over(self);
    mrt_result result = live_ask(self, fetch_over, &b, err);
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    const instance *mapping = live_mapping(self);
    if (result >= 0)
        result = overdub_run_edits(b.run, &self->shown, mapping ? mapping->type->name : "Pointer",
                                   out_edits, out_count, &made, err);
    if (b.run)
        free(b.run->plan.own);
    free(b.run);
    free(b.owned);
    return result >= 0;
}

void live_over_update(live *self)
{
    const live_pulse *pulse = &self->stage.pulse[slot_front(&self->stage.pulse_slot)];
    if (!self->is_over || pulse->mode == LIVE_OVERDUBS || pulse->overs != self->overs)
        return;
    self->is_over = self->status.is_recording = false;
    self->is_over_done = true;
    self->take_ended_ns = clock_now_ns();
}
