#include "stage/record/overdub.h"
#include "base/clock.h"
#include "show/edit.h"
#include "show/own.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* of one pass: add a layer, add its clip, fade the clip, mute the layer */
enum { EDITS_OF_PASS = 9 };

/* ---- plan ---- */

/* Returns the layer of a punch-in. NULL: none. */
static const take_layer *punched_layer(const overdub_plan *plan, const take *t)
{
    for (uint32_t i = 0; i < t->layer_count; ++i)
        if (plan->into_layer && t->layer[i].id == plan->into_layer)
            return &t->layer[i];
    return NULL;
}

mrt_result overdub_plan_check(const overdub_plan *s, const take *t, error *err)
{
    bool is_ranged = s->out_ns > 0;
    if (s->in_ns < 0 || (is_ranged && s->out_ns <= s->in_ns))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the in point must come before the out point: in %.3f s, out %.3f s",
                         (double)s->in_ns / 1e9, (double)s->out_ns / 1e9);
    if (s->in_ns > t->duration_ns)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the in point lies after the end of the take (%.3f s)",
                         (double)t->duration_ns / 1e9);
    if (s->passes < 1 || s->passes > OVERDUB_PASSES_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u passes: the range is 1 to %d", s->passes,
                         OVERDUB_PASSES_MAX);
    if (s->passes > 1 && !is_ranged)
        return error_set(err, MRT_ERR_ARGUMENT, "more than one pass needs an in and an out point");
    if (s->into_layer && !is_ranged)
        return error_set(err, MRT_ERR_ARGUMENT, "a punch-in needs an in and an out point");
    if (s->fade_ns < 0 || (is_ranged && 2 * s->fade_ns > s->out_ns - s->in_ns))
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the fades are longer than the span between in and out");
    if (!(s->speed >= TRANSPORT_SPEED_MIN && s->speed <= TRANSPORT_SPEED_MAX))
        return error_set(err, MRT_ERR_ARGUMENT, "speed %g: the range is %g to %g", s->speed,
                         TRANSPORT_SPEED_MIN, TRANSPORT_SPEED_MAX);
    if (s->into_layer && !punched_layer(s, t))
        return error_set(err, MRT_ERR_ARGUMENT, "the take has no layer %u", s->into_layer);
    return MRT_OK;
}

static mrt_result check_owned(const mrt_face *about, const take_layer *own, error *err)
{
    bool any = own->own_count == 0;
    for (uint32_t i = 0; i < about->contact_count && !any; ++i)
        any = own_layer_owns(own, about->contacts[i].name);
    for (uint32_t i = 0; i < about->dof_count && !any; ++i)
        any = own_layer_owns(own, about->dofs[i].name);
    if (any)
        return MRT_OK;
    return error_set(err, MRT_ERR_ARGUMENT,
                     "the layer would move nothing: this face has no contact or degree of "
                     "freedom \"%s\"",
                     own->own[0]);
}

mrt_result overdub_plan_own(const overdub_plan *plan, const take *t, const composer *shown,
                            uint8_t **out, bool *out_is_additive, error *err)
{
    const take_layer planned = {.own_count = plan->own_count, .own = plan->own};
    const take_layer *punched = punched_layer(plan, t), *own = punched ? punched : &planned;
    const mrt_face *about = composer_about(shown);
    *out_is_additive = punched && punched->is_additive;
    *out = calloc((size_t)about->contact_count + about->dof_count + 1, 1);
    if (!*out)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the overdub");
    sequencer_mark_owned(shown, own, *out);
    return check_owned(about, own, err);
}

void overdub_run_init(overdub_run *out, const overdub_plan *plan, const take *t)
{
    memset(out, 0, sizeof *out);
    out->plan = *plan;
    snprintf(out->scene, sizeof out->scene, "%s", t->scene);
    snprintf(out->shot, sizeof out->shot, "%s", t->shot);
    out->take = t->id;
    out->duration_ns = t->duration_ns;
    out->start_ns = plan->in_ns > plan->preroll_ns ? plan->in_ns - plan->preroll_ns : 0;
    out->at_ns = out->start_ns;
    out->played_ns = INT64_MIN;
}

/* ---- run ---- */

static void begin(overdub_run *self, int64_t clock_ns)
{
    const overdub_plan *s = &self->plan;
    self->state = OVERDUB_RUNS;
    self->rolling_ns = clock_ns + s->count_in_ns;
    transport_init(&self->transport, self->duration_ns);
    self->transport.stops_at_end = false;
    transport_seek(&self->transport, self->rolling_ns, self->start_ns);
    if (!transport_set_speed(&self->transport, self->rolling_ns, s->speed))
        return;
    if (s->passes > 1 &&
        !transport_set_loop(&self->transport, self->rolling_ns, self->start_ns, s->out_ns))
        return;
    transport_play(&self->transport, self->rolling_ns);
}

void overdub_run_slate(const overdub_run *self, recorder *into)
{
    const writer_slate slate = {.scene = self->scene,
                                .shot = self->shot,
                                .over = self->take,
                                .over_at_ns = self->plan.in_ns};
    recorder_take_next(into, &slate, 0);
}

static mrt_result end_take(overdub_run *self, recorder *into, error *err)
{
    overdub_pass *p = &self->pass[self->pass_now];
    bool is_begun = recorder_take_is_open(into);
    mrt_result result = recorder_take_end(into, err);
    p->raw_take = is_begun ? recorder_take(into) : 0;
    return result;
}

static mrt_result end_pass(overdub_run *self, recorder *into, error *err)
{
    mrt_result result = end_take(self, into, err);
    if (self->pass_now + 1 >= self->plan.passes) {
        self->state = OVERDUB_OVER;
        return result;
    }
    self->pass_now += 1;
    overdub_run_slate(self, into);
    return result;
}

static mrt_result go_to(overdub_run *self, recorder *into, int64_t clock_ns, error *err)
{
    if (self->state == OVERDUB_WAITS)
        begin(self, clock_ns);
    if (clock_ns < self->rolling_ns || self->state == OVERDUB_OVER)
        return MRT_OK;
    transport_position position = transport_at(&self->transport, clock_ns);
    mrt_result result = MRT_OK;
    bool is_past_out =
        self->plan.passes == 1 && self->plan.out_ns > 0 && position.at_ns >= self->plan.out_ns;
    while (result >= 0 && self->pass_now < position.pass && self->state != OVERDUB_OVER)
        result = end_pass(self, into, err);
    if (is_past_out && result >= 0)
        result = end_pass(self, into, err);
    if (result >= 0 && self->state != OVERDUB_OVER)
        self->at_ns = position.at_ns;
    return result;
}

mrt_result overdub_run_end(overdub_run *self, recorder *into, error *err)
{
    if (self->state == OVERDUB_OVER)
        return MRT_OK;
    self->state = OVERDUB_OVER;
    return end_take(self, into, err);
}

bool overdub_run_is_recording(const overdub_run *self)
{
    return self->state == OVERDUB_RUNS && self->at_ns >= self->plan.in_ns;
}

uint32_t overdub_run_pass(const overdub_run *self)
{
    return self->pass_now;
}

/* Weight of the live layer, with the same fades as take_at. */
static double weight_of(const overdub_run *self)
{
    const overdub_plan *s = &self->plan;
    if (self->at_ns < s->in_ns || self->state == OVERDUB_OVER)
        return 0.0;
    double weight = 1.0;
    if (s->fade_ns > 0 && self->at_ns < s->in_ns + s->fade_ns)
        weight = (double)(self->at_ns - s->in_ns) / (double)s->fade_ns;
    if (s->fade_ns > 0 && s->out_ns > 0 && self->at_ns > s->out_ns - s->fade_ns)
        weight *= 1.0 - (double)(self->at_ns - (s->out_ns - s->fade_ns)) / (double)s->fade_ns;
    return weight < 0.0 ? 0.0 : weight;
}

static void note_step(overdub_run *self, const recorder *into, const sample_step *s)
{
    const int64_t clock_ns = s->time_ns;
    int64_t show_ns = recorder_show_ns(into, clock_ns);
    if (self->performance_from_ns == 0)
        self->performance_from_ns = show_ns;
    overdub_pass *p = &self->pass[self->pass_now];
    if (!overdub_run_is_recording(self) || clock_ns < self->rolling_ns)
        return;
    if (p->sample_count == 0) {
        p->performance = recorder_performance(into);
        p->from_ns = self->performance_from_ns;
        p->first_ns = show_ns;
        p->start_ns = self->at_ns;
    }
    p->last_ns = show_ns;
    p->end_ns = self->at_ns;
    p->sample_count += 1;
    for (uint32_t i = 0; i < s->count; ++i) {
        const channel_route *route = s->of[i].route;
        for (int k = 0; k < TAKE_OWN_PARTS; ++k)
            p->has_own[k] |= take_own_part_of[k].part == TAKE_LIFE ? life_is_route(route)
                                                                   : palette_is_route(route);
        p->has_others |=
            route->table.count > 0 && route->table.channel[0].semantic < (uint32_t)POINTER_SEMANTIC;
    }
}

mrt_result overdub_run_play_to(overdub_run *self, sequencer *of, recorder *into, int64_t clock_ns,
                               error *err)
{
    if (clock_ns < self->played_ns)
        clock_ns = self->played_ns;
    self->played_ns = clock_ns;
    mrt_result result = go_to(self, into, clock_ns, err);
    if (result < 0 || self->state == OVERDUB_OVER || clock_ns < self->rolling_ns)
        return result;
    return sequencer_play_to(of, self->at_ns, err);
}

mrt_result overdub_run_step(overdub_run *self, sequencer *of, recorder *into, stage_frame *f,
                            error *err)
{
    mrt_result result = overdub_run_play_to(self, of, into, f->step.time_ns, err);
    if (self->state == OVERDUB_OVER)
        return result < 0 ? result : MRT_END;
    note_step(self, into, &f->step);
    sequencer_perform_over(of, f, weight_of(self));
    return result;
}

/* ---- passes ---- */

/* Returns whether a pass reached the out point. At that time the next sample lies after it. */
static bool is_whole(const overdub_run *self, const overdub_pass *p)
{
    return self->plan.out_ns > 0 && self->plan.out_ns - p->end_ns < NS_PER_S / 10;
}

/* Returns the last complete pass. If none is complete, the last pass that has samples. */
static const overdub_pass *heard_pass(const overdub_run *self)
{
    const overdub_pass *heard = NULL;
    for (uint32_t i = 0; i <= self->pass_now; ++i)
        if (self->pass[i].sample_count > 0 && (!heard || is_whole(self, &self->pass[i])))
            heard = &self->pass[i];
    return heard;
}

/* ---- edits ---- */

typedef struct making {
    const overdub_run *run;
    const char *name;
    take after; /* the take after the edits so far */
    edit *edits;
    uint32_t count;
} making;

static mrt_result add(making *self, edit *e, error *err)
{
    mrt_result result = edit_apply(&self->after, e, err);
    if (result < 0)
        edit_finish(e);
    else
        self->edits[self->count++] = *e;
    return result;
}

/* Sets the clip of a pass: its span on the timeline, limited to in..out and to the recorded
 * samples, and its span of the performance. */
static mrt_result frame_clip(const overdub_run *self, const overdub_pass *p, edit *e, error *err)
{
    const overdub_plan *s = &self->plan;
    double source_per_ns = 1.0 / s->speed;
    int64_t start_ns = s->in_ns > p->start_ns ? s->in_ns : p->start_ns;
    if (p->start_ns - s->in_ns < NS_PER_S / 10) /* the first sample arrives a little after in */
        start_ns = s->in_ns;
    int64_t end_ns = is_whole(self, p) ? s->out_ns : p->end_ns + 1;
    int64_t source_ns = p->first_ns - p->from_ns +
                        (int64_t)llround((double)(start_ns - p->start_ns) * source_per_ns);
    if (source_ns < 0) {
        start_ns += (int64_t)llround((double)-source_ns * s->speed);
        source_ns = 0;
    }
    int64_t length_ns = (int64_t)llround((double)(end_ns - start_ns) * source_per_ns);
    e->performance = p->performance;
    e->from_ns = p->from_ns;
    e->to_ns = p->from_ns + source_ns + length_ns + 1;
    e->start_ns = e->in_ns = start_ns;
    e->end_ns = e->out_ns = end_ns;
    e->source_ns = source_ns;
    if (!(fabs(s->speed - 1.0) > 0.0))
        return MRT_OK;
    e->warp = malloc(2 * sizeof *e->warp);
    if (!e->warp)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the edit");
    e->warp[0] = (take_warp_point){start_ns, source_ns};
    e->warp[1] = (take_warp_point){end_ns, source_ns + length_ns};
    e->warp_count = 2;
    e->source_ns = EDIT_UNSAID;
    return MRT_OK;
}

/* A pass that was ended early may be shorter than the planned fades. */
static int64_t fade_that_fits(const overdub_run *self, int64_t length_ns)
{
    return self->plan.fade_ns < length_ns / 2 ? self->plan.fade_ns : length_ns / 2;
}

/* A layer of a palette or of life stays one. */
static take_part part_of_layer(const making *self, uint32_t id)
{
    take_part part = TAKE_WHOLE;
    for (uint32_t i = 0; i < self->after.layer_count; ++i) {
        const take_layer *l = &self->after.layer[i];
        for (int k = 0; k < TAKE_OWN_PARTS; ++k)
            if (l->id == id && l->clip_count > 0 && l->clip[0].part == take_own_part_of[k].part)
                part = take_own_part_of[k].part;
    }
    return part;
}

static mrt_result punch(making *self, const overdub_pass *p, error *err)
{
    edit e;
    edit_init(&e, EDIT_PUNCH);
    mrt_result result = frame_clip(self->run, p, &e, err);
    e.layer = self->run->plan.into_layer;
    e.part = (uint32_t)part_of_layer(self, e.layer);
    e.fade_ns = fade_that_fits(self->run, e.out_ns - e.in_ns);
    return result < 0 ? result : add(self, &e, err);
}

static const take_layer *top_layer(const making *self)
{
    return self->after.layer_count > 0 ? &self->after.layer[self->after.layer_count - 1] : NULL;
}

static mrt_result mute(making *self, uint32_t id, error *err)
{
    edit e;
    edit_init(&e, EDIT_LAYER_MUTE);
    e.layer = id;
    e.is_muted = true;
    return add(self, &e, err);
}

static mrt_result copy_own(edit *e, const overdub_plan *plan, error *err)
{
    if (plan->own_count == 0)
        return MRT_OK;
    e->own = calloc(plan->own_count, sizeof *e->own);
    if (!e->own)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the edit");
    memcpy(e->own, plan->own, plan->own_count * sizeof *e->own);
    e->own_count = plan->own_count;
    return MRT_OK;
}

static mrt_result add_layer(making *self, const char *name, uint32_t number, uint32_t *out_id,
                            error *err)
{
    const overdub_plan *plan = &self->run->plan;
    edit e;
    edit_init(&e, EDIT_LAYER_ADD);
    snprintf(e.name, sizeof e.name, "%.50s", name);
    if (plan->passes > 1)
        snprintf(e.name, sizeof e.name, "%.50s %u", name, number);
    e.place = UINT32_MAX;
    mrt_result result = copy_own(&e, plan, err);
    if (result >= 0)
        result = add(self, &e, err);
    const take_layer *top = result >= 0 ? top_layer(self) : NULL;
    *out_id = top ? top->id : 0;
    return result;
}

static mrt_result fade_clip(making *self, int64_t length_ns, error *err)
{
    const overdub_plan *plan = &self->run->plan;
    const take_layer *top = top_layer(self);
    if (!top || plan->fade_ns <= 0 || top->clip_count == 0)
        return MRT_OK;
    int64_t fade_ns = fade_that_fits(self->run, length_ns);
    edit fade;
    edit_init(&fade, EDIT_CLIP_FADE);
    fade.clip = top->clip[0].id;
    fade.fade_in_ns = plan->in_ns > 0 ? fade_ns : EDIT_UNSAID;
    fade.fade_out_ns = plan->out_ns > 0 ? fade_ns : EDIT_UNSAID;
    if (fade.fade_in_ns == EDIT_UNSAID && fade.fade_out_ns == EDIT_UNSAID)
        return MRT_OK;
    return add(self, &fade, err);
}

static mrt_result add_clip(making *self, const overdub_pass *p, uint32_t id, take_part part,
                           error *err)
{
    edit e;
    edit_init(&e, EDIT_CLIP_ADD);
    mrt_result result = frame_clip(self->run, p, &e, err);
    e.layer = id;
    e.part = (uint32_t)part;
    int64_t length_ns = e.end_ns - e.start_ns;
    if (result >= 0)
        result = add(self, &e, err);
    return result < 0 ? result : fade_clip(self, length_ns, err);
}

static mrt_result add_part(making *self, const overdub_pass *p, const char *name, take_part part,
                           bool is_heard, uint32_t *out_id, error *err)
{
    const uint32_t number = (uint32_t)(p - self->run->pass) + 1;
    mrt_result result = add_layer(self, name, number, out_id, err);
    if (result >= 0)
        result = add_clip(self, p, *out_id, part, err);
    edit e;
    edit_init(&e, EDIT_LAYER_ADDITIVE);
    e.layer = *out_id;
    e.is_additive = true;
    if (result >= 0 && part >= TAKE_PALETTE)
        result = add(self, &e, err);
    return result >= 0 && !is_heard ? mute(self, *out_id, err) : result;
}

/* Poses that were played, and life, become layers of their own, above the rest of the pass. */
static mrt_result add_pass(making *self, const overdub_pass *p, bool is_heard, uint32_t *out_id,
                           error *err)
{
    const overdub_plan *plan = &self->run->plan;
    const char *name = plan->name[0] ? plan->name : self->name;
    mrt_result result = MRT_OK;
    uint32_t own_count = 0, own_id = 0;
    for (int k = 0; k < TAKE_OWN_PARTS; ++k)
        own_count += p->has_own[k];
    const bool has_hands = p->has_others || own_count == 0;
    if (has_hands)
        result =
            add_part(self, p, name, own_count > 0 ? TAKE_HANDS : TAKE_WHOLE, is_heard, out_id, err);
    for (int k = 0; k < TAKE_OWN_PARTS && result >= 0; ++k) {
        const take_own_part *own = &take_own_part_of[k];
        const bool has_name = !has_hands && own_count == 1 && plan->name[0];
        if (p->has_own[k])
            result =
                add_part(self, p, has_name ? name : own->layer, own->part, is_heard, &own_id, err);
    }
    *out_id = has_hands ? *out_id : own_id;
    return result;
}

static mrt_result make(making *self, overdub_made *out, error *err)
{
    const overdub_run *run = self->run;
    const overdub_pass *heard = heard_pass(run);
    mrt_result result = MRT_OK;
    if (!heard)
        return error_set(
            err, MRT_ERR_ARGUMENT, "no sample arrived between in and out%s. The take is unchanged.",
            run->pass[0].raw_take ? " (the samples before it are saved as a separate take)" : "");
    for (uint32_t i = 0; i <= run->pass_now && result >= 0; ++i) {
        const overdub_pass *p = &run->pass[i];
        uint32_t id = run->plan.into_layer;
        if (p->sample_count == 0 || (id && p > heard))
            continue;
        result = id ? punch(self, p, err) : add_pass(self, p, p == heard, &id, err);
        out->layer_count += 1;
        if (p == heard) {
            out->last_layer = id;
            out->raw_take = p->raw_take;
            out->from_ns = p->start_ns;
            out->to_ns = p->end_ns;
        }
    }
    return result;
}

static void overdub_edits_destroy(edit *edits, uint32_t count)
{
    for (uint32_t i = 0; edits && i < count; ++i)
        edit_finish(&edits[i]);
    free(edits);
}

mrt_result overdub_run_edits(const overdub_run *self, const take *before, const char *name,
                             edit **out, overdub_made *out_made, error *err)
{
    making m = {.run = self, .name = name};
    *out = NULL;
    *out_made = (overdub_made){0};
    m.edits = calloc((size_t)(self->pass_now + 1) * EDITS_OF_PASS, sizeof *m.edits);
    if (!m.edits)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the edits");
    mrt_result result = take_copy(&m.after, before, err);
    if (result >= 0)
        result = make(&m, out_made, err);
    take_finish(&m.after);
    if (result < 0) {
        overdub_edits_destroy(m.edits, m.count);
        return result;
    }
    *out = m.edits;
    out_made->edit_count = m.count;
    return MRT_OK;
}

struct overdub {
    overdub_settings settings;
    take take;
    sequencer *sequencer;
    layer *layer;
    recorder *recorder;
    uint8_t *owned;
    overdub_run run;
    stage_frame frame;
};

/* ---- create and destroy ---- */

/* Creates the layer that performs over the layers of the take. */
static mrt_result create_live(overdub *self, error *err)
{
    const overdub_settings *s = &self->settings;
    performer *shown = sequencer_performer(self->sequencer);
    const performer_settings as = {
        .hand_length_mm = s->recorder.hand_length_mm,
        .side_length_mm = {s->side_length_mm[MRT_LEFT], s->side_length_mm[MRT_RIGHT]},
        .rezero_pedal = s->recorder.rezero_pedal,
        .patch = s->recorder.patch};
    mrt_result result = performer_make_layer(shown, s->recorder.mapping, &as, &self->layer, err);
    if (result < 0)
        return result;
    bool is_additive;
    result = overdub_plan_own(&self->run.plan, &self->take, shown->composer, &self->owned,
                              &is_additive, err);
    if (result < 0)
        return result;
    sequencer_set_live(self->sequencer, self->layer, self->owned, is_additive);
    return MRT_OK;
}

static mrt_result create_recorder(overdub *self, error *err)
{
    recorder_settings settings = self->settings.recorder;
    settings.layer = self->layer;
    settings.state_bytes = REPLAY_STATE_MIN;
    mrt_result result = recorder_start(&self->recorder, &settings, err);
    if (result < 0)
        return result;
    overdub_run_slate(&self->run, self->recorder);
    return MRT_OK;
}

static mrt_result create(overdub *self, error *err)
{
    const overdub_settings *s = &self->settings;
    mrt_result result = edit_store_take(&self->take, s->recorder.show, s->take, err);
    if (result >= 0)
        result = overdub_plan_check(&s->plan, &self->take, err);
    if (result < 0)
        return result;
    overdub_run_init(&self->run, &s->plan, &self->take);
    sequencer_settings playing = {.show = s->recorder.show,
                                  .plugins = s->recorder.plugins,
                                  .log = s->recorder.log,
                                  .face = s->recorder.face};
    result = sequencer_create(&self->sequencer, &playing, &self->take, err);
    if (result >= 0)
        result = sequencer_seek(self->sequencer, self->run.start_ns, err);
    if (result >= 0) {
        taught_restore(s->recorder.show, s->recorder.mapping, s->recorder.log);
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
        return error_set(err, MRT_ERR_MEMORY, "no memory for the overdub");
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
        log_push(self->settings.recorder.log, MRT_LOG_ERROR, "recorder", ignored.text);
    layer_destroy(self->layer); /* the sequencer owns its face */
    sequencer_destroy(self->sequencer);
    take_finish(&self->take);
    free(self->owned);
    free(self);
}

/* ---- player stage ---- */

bool overdub_is_recording(const overdub *self)
{
    return overdub_run_is_recording(&self->run);
}

static mrt_result record(void *of, stage_frame *f, error *err)
{
    overdub *self = of;
    recorder_step(self->recorder, &f->step);
    return overdub_run_step(&self->run, self->sequencer, self->recorder, f, err);
}

static mrt_result show_at(void *of, stage_frame *f, int64_t time_ns, error *err)
{
    overdub *self = of;
    mrt_result result =
        overdub_run_play_to(&self->run, self->sequencer, self->recorder, time_ns, err);
    f->performer = sequencer_performer(self->sequencer);
    return result >= 0 && self->run.state == OVERDUB_OVER ? MRT_END : result;
}

stage_frame *overdub_frame(overdub *self)
{
    self->frame = (stage_frame){.self = self, .record = record, .show = show_at};
    return &self->frame;
}

/* ---- edits of the take ---- */

static mrt_result make_edits(const overdub *self, history *h, overdub_made *out, error *err)
{
    edit *edits;
    mrt_result result = overdub_run_edits(
        &self->run, history_take(h), self->settings.recorder.mapping->type->name, &edits, out, err);
    if (result < 0)
        return result;
    for (uint32_t i = 0; i < out->edit_count && result >= 0; ++i)
        result = history_do(h, &edits[i], err);
    overdub_edits_destroy(edits, out->edit_count);
    return result;
}

mrt_result overdub_finish(overdub *self, overdub_made *out, error *err)
{
    *out = (overdub_made){0};
    mrt_result result = overdub_run_end(&self->run, self->recorder, err);
    if (result >= 0 && recorder_problem(self->recorder)[0])
        result = error_set(err, MRT_ERR_IO, "%s", recorder_problem(self->recorder));
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    if (result < 0)
        return result;
    taught_keep_now(self->settings.recorder.show, self->layer->mapping,
                    self->settings.recorder.log);
    edit_store *store = NULL;
    history *h = NULL;
    result = edit_store_open(&store, self->settings.recorder.show, self->settings.take,
                             clock_utc_ms, err);
    if (result < 0)
        return result;
    history_store list = edit_store_list(store);
    result = history_open(&h, edit_store_bare(store), &list, err);
    if (result >= 0)
        result = make_edits(self, h, out, err);
    history_close(h);
    edit_store_close(store);
    return result;
}

/* ---- state ---- */

performer *overdub_performer(overdub *self)
{
    return sequencer_performer(self->sequencer);
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
    return self->run.state == OVERDUB_RUNS ? &self->run.transport : NULL;
}

mrt_result overdub_check(const overdub *self, error *err)
{
    return sequencer_check(self->sequencer, err);
}

const take *overdub_take(const overdub *self)
{
    return &self->take;
}
