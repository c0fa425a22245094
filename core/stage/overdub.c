#include "stage/overdub.h"
#include "base/clock.h"
#include "take/edit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PASSES_MAX = 99 };

typedef struct pass { /* what was performed in one */
    int64_t performance, raw_take;
    int64_t from_ns;           /* show time: the performance's start */
    int64_t first_ns, last_ns; /* show time: of its samples within in..out */
    int64_t start_ns, end_ns;  /* of the timeline: the same */
    uint64_t sample_count;
} pass;

struct overdub {
    overdub_settings settings;
    take take;
    sequencer *sequencer;
    layer *layer;
    recorder *recorder;
    uint8_t *owned;
    transport transport;
    bool has_begun, is_over;
    int64_t rolling_ns; /* clock: when the count-in ends */
    int64_t start_ns;   /* of the timeline: in, less the pre-roll */
    int64_t at_ns;
    uint32_t pass_now;
    int64_t performance_from_ns; /* show time of the first sample */
    pass pass[PASSES_MAX];
};

/* ---- made and unmade ---- */

static mrt_result check(const overdub_settings *s, const take *t, error *err)
{
    bool is_ranged = s->out_ns > 0;
    if (s->in_ns < 0 || (is_ranged && s->out_ns <= s->in_ns))
        return error_set(err, MRT_ERR_ARGUMENT, "in and out: %.3f .. %.3f s is no range",
                         (double)s->in_ns / 1e9, (double)s->out_ns / 1e9);
    if (s->in_ns > t->duration_ns)
        return error_set(err, MRT_ERR_ARGUMENT, "in: the take is %.3f s long",
                         (double)t->duration_ns / 1e9);
    if (s->passes < 1 || s->passes > PASSES_MAX)
        return error_set(err, MRT_ERR_ARGUMENT, "%u passes: 1 to %d are possible", s->passes,
                         PASSES_MAX);
    if (s->passes > 1 && !is_ranged)
        return error_set(err, MRT_ERR_ARGUMENT, "more than one pass needs an in and an out");
    if (s->into_layer && !is_ranged)
        return error_set(err, MRT_ERR_ARGUMENT, "a punch needs an in and an out");
    if (s->fade_ns < 0 || (is_ranged && 2 * s->fade_ns > s->out_ns - s->in_ns))
        return error_set(err, MRT_ERR_ARGUMENT, "the fades do not fit between in and out");
    if (!(s->speed >= TRANSPORT_SPEED_MIN && s->speed <= TRANSPORT_SPEED_MAX))
        return error_set(err, MRT_ERR_ARGUMENT, "speed %g: %g to %g are possible", s->speed,
                         TRANSPORT_SPEED_MIN, TRANSPORT_SPEED_MAX);
    for (uint32_t i = 0; i < t->layer_count && s->into_layer; ++i)
        if (t->layer[i].id == s->into_layer)
            return MRT_OK;
    return s->into_layer
               ? error_set(err, MRT_ERR_ARGUMENT, "the take has no layer %u", s->into_layer)
               : MRT_OK;
}

static const take_layer *punched(const overdub *self)
{
    for (uint32_t i = 0; i < self->take.layer_count; ++i)
        if (self->settings.into_layer && self->take.layer[i].id == self->settings.into_layer)
            return &self->take.layer[i];
    return NULL;
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
    layer_settings guard = {.hands.rezero_pedal = s->rezero_pedal};
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
    const take_layer *over = punched(self);
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
    };
    mrt_result result = recorder_start(&self->recorder, &settings, err);
    if (result < 0)
        return result;
    const writer_slate slate = {self->take.scene, self->take.shot, 0};
    recorder_take_next(self->recorder, &slate);
    return MRT_OK;
}

static mrt_result create(overdub *self, error *err)
{
    const overdub_settings *s = &self->settings;
    mrt_result result = edit_store_take(&self->take, s->show, s->take, err);
    if (result >= 0)
        result = check(s, &self->take, err);
    if (result < 0)
        return result;
    sequencer_settings playing = {
        .show = s->show, .plugins = s->plugins, .log = s->log, .face = s->face};
    result = sequencer_create(&self->sequencer, &playing, &self->take, err);
    self->start_ns = s->in_ns > s->preroll_ns ? s->in_ns - s->preroll_ns : 0;
    self->at_ns = self->start_ns;
    if (result >= 0)
        result = sequencer_seek(self->sequencer, self->start_ns, err);
    if (result >= 0)
        result = create_live(self, err);
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

static void begin(overdub *self, int64_t clock_ns)
{
    const overdub_settings *s = &self->settings;
    self->has_begun = true;
    self->rolling_ns = clock_ns + s->count_in_ns;
    transport_init(&self->transport, self->take.duration_ns);
    self->transport.stops_at_end = false;
    transport_seek(&self->transport, self->rolling_ns, self->start_ns);
    if (!transport_set_speed(&self->transport, self->rolling_ns, s->speed))
        return;
    if (s->passes > 1 &&
        !transport_set_loop(&self->transport, self->rolling_ns, self->start_ns, s->out_ns))
        return;
    transport_play(&self->transport, self->rolling_ns);
}

/* What was performed in the pass that ends is a take by itself. */
static mrt_result end_pass(overdub *self, error *err)
{
    self->pass[self->pass_now].raw_take = recorder_take(self->recorder);
    mrt_result result = recorder_take_end(self->recorder, err);
    if (result >= 0 && self->pass[self->pass_now].raw_take == 0)
        self->pass[self->pass_now].raw_take = recorder_take(self->recorder);
    if (self->pass_now + 1 >= self->settings.passes) {
        self->is_over = true;
        return result;
    }
    self->pass_now += 1;
    const writer_slate slate = {self->take.scene, self->take.shot, 0};
    recorder_take_next(self->recorder, &slate);
    return result;
}

/* The take as it is at a time of the clock. */
static mrt_result go_to(overdub *self, int64_t clock_ns, error *err)
{
    if (!self->has_begun)
        begin(self, clock_ns);
    if (clock_ns < self->rolling_ns || self->is_over)
        return MRT_OK;
    transport_place place = transport_at(&self->transport, clock_ns);
    mrt_result result = MRT_OK;
    bool is_past_out = self->settings.passes == 1 && self->settings.out_ns > 0 &&
                       place.at_ns >= self->settings.out_ns;
    while (result >= 0 && self->pass_now < place.pass && !self->is_over)
        result = end_pass(self, err);
    if (is_past_out && result >= 0)
        result = end_pass(self, err);
    if (result < 0 || self->is_over)
        return result;
    self->at_ns = place.at_ns;
    return sequencer_play_to(self->sequencer, place.at_ns, err);
}

bool overdub_is_recording(const overdub *self)
{
    return self->has_begun && !self->is_over && self->at_ns >= self->settings.in_ns;
}

/* As the clip will be shown afterwards: take_at. */
static double weight_now(const overdub *self)
{
    const overdub_settings *s = &self->settings;
    if (self->at_ns < s->in_ns || self->is_over)
        return 0.0;
    double weight = 1.0;
    if (s->fade_ns > 0 && self->at_ns < s->in_ns + s->fade_ns)
        weight = (double)(self->at_ns - s->in_ns) / (double)s->fade_ns;
    if (s->fade_ns > 0 && s->out_ns > 0 && self->at_ns > s->out_ns - s->fade_ns)
        weight *= 1.0 - (double)(self->at_ns - (s->out_ns - s->fade_ns)) / (double)s->fade_ns;
    return weight < 0.0 ? 0.0 : weight;
}

static void note_sample(overdub *self, int64_t clock_ns)
{
    int64_t show_ns = writer_show_ns(recorder_writer(self->recorder), clock_ns);
    if (self->performance_from_ns == 0)
        self->performance_from_ns = show_ns;
    pass *p = &self->pass[self->pass_now];
    if (!overdub_is_recording(self) || clock_ns < self->rolling_ns)
        return;
    if (p->sample_count == 0) {
        p->performance = recorder_performance(self->recorder);
        p->from_ns = self->performance_from_ns;
        p->first_ns = show_ns;
        p->start_ns = self->at_ns;
    }
    p->last_ns = show_ns;
    p->end_ns = self->at_ns;
    p->sample_count += 1;
}

static mrt_result on_sample(void *of, const channel_route *route, const mrt_sample *sample,
                            error *err)
{
    overdub *self = of;
    mrt_result result = go_to(self, sample->time_ns, err);
    if (result < 0 || self->is_over)
        return result;
    note_sample(self, sample->time_ns);
    sequencer_weigh_live(self->sequencer, weight_now(self));
    sequencer_live_sample(self->sequencer, route, sample);
    return MRT_OK;
}

static mrt_result on_draw(void *of, int64_t time_ns, error *err)
{
    overdub *self = of;
    mrt_result result = go_to(self, time_ns, err);
    composer_draw(sequencer_composer(self->sequencer));
    return result >= 0 && self->is_over ? MRT_END : result;
}

player_stage overdub_stage(overdub *self)
{
    return (player_stage){self, on_sample, on_draw};
}

/* ---- it becomes a part of the take ---- */

static int64_t utc_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / NS_PER_MS;
}

/* It reaches to the out: the next sample would have come behind it. */
static bool is_whole(const overdub *self, const pass *p)
{
    return self->settings.out_ns > 0 && self->settings.out_ns - p->end_ns < NS_PER_S / 10;
}

/* The last one that was performed to its end; when there is none, the last that was begun. */
static const pass *heard_pass(const overdub *self)
{
    const pass *heard = NULL;
    for (uint32_t i = 0; i <= self->pass_now; ++i)
        if (self->pass[i].sample_count > 0 && (!heard || is_whole(self, &self->pass[i])))
            heard = &self->pass[i];
    return heard;
}

/* The timeline's in..out, as far as there are samples, and what of the performance it shows. */
static void frame_clip(const overdub *self, const pass *p, edit *e, take_warp_point warp[2])
{
    const overdub_settings *s = &self->settings;
    double source_per_ns = 1.0 / s->speed;
    int64_t start_ns = s->in_ns > p->start_ns ? s->in_ns : p->start_ns;
    if (p->start_ns - s->in_ns < NS_PER_S / 10) /* the first sample comes a little after in */
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
    if (fabs(s->speed - 1.0) > 0.0) {
        warp[0] = (take_warp_point){start_ns, source_ns};
        warp[1] = (take_warp_point){end_ns, source_ns + length_ns};
        e->warp = warp;
        e->warp_count = 2;
        e->source_ns = EDIT_UNSAID;
    }
}

/* What was ended early may be shorter than the fades that were asked for. */
static int64_t fade_that_fits(const overdub *self, int64_t length_ns)
{
    return self->settings.fade_ns < length_ns / 2 ? self->settings.fade_ns : length_ns / 2;
}

static mrt_result punch(const overdub *self, history *h, const pass *p, error *err)
{
    edit e;
    take_warp_point warp[2];
    edit_init(&e, EDIT_PUNCH);
    frame_clip(self, p, &e, warp);
    e.layer = self->settings.into_layer;
    e.fade_ns = fade_that_fits(self, e.out_ns - e.in_ns);
    return history_do(h, &e, err);
}

static const take_layer *top_layer(const history *h)
{
    const take *t = history_take(h);
    return t->layer_count > 0 ? &t->layer[t->layer_count - 1] : NULL;
}

static mrt_result mute(history *h, uint32_t id, error *err)
{
    edit e;
    edit_init(&e, EDIT_LAYER_MUTE);
    e.layer = id;
    e.is_muted = true;
    return history_do(h, &e, err);
}

static mrt_result add_layer(const overdub *self, history *h, uint32_t number, uint32_t *out_id,
                            error *err)
{
    const overdub_settings *s = &self->settings;
    edit e;
    edit_init(&e, EDIT_LAYER_ADD);
    snprintf(e.name, sizeof e.name, "%.50s", s->name[0] ? s->name : s->mapping->type->name);
    if (s->passes > 1)
        snprintf(e.name, sizeof e.name, "%.50s %u", s->name[0] ? s->name : s->mapping->type->name,
                 number);
    e.place = UINT32_MAX;
    e.own = s->own;
    e.own_count = s->own_count;
    mrt_result result = history_do(h, &e, err);
    const take_layer *top = result >= 0 ? top_layer(h) : NULL;
    *out_id = top ? top->id : 0;
    return result;
}

static mrt_result add_clip(const overdub *self, history *h, const pass *p, uint32_t id, error *err)
{
    edit e;
    take_warp_point warp[2];
    edit_init(&e, EDIT_CLIP_ADD);
    frame_clip(self, p, &e, warp);
    e.layer = id;
    mrt_result result = history_do(h, &e, err);
    const take_layer *top = result >= 0 ? top_layer(h) : NULL;
    if (!top || self->settings.fade_ns <= 0 || top->clip_count == 0)
        return result;
    int64_t fade_ns = fade_that_fits(self, e.end_ns - e.start_ns);
    edit fade;
    edit_init(&fade, EDIT_CLIP_FADE);
    fade.clip = top->clip[0].id;
    fade.fade_in_ns = self->settings.in_ns > 0 ? fade_ns : EDIT_UNSAID;
    fade.fade_out_ns = self->settings.out_ns > 0 ? fade_ns : EDIT_UNSAID;
    if (fade.fade_in_ns == EDIT_UNSAID && fade.fade_out_ns == EDIT_UNSAID)
        return result;
    return history_do(h, &fade, err);
}

static mrt_result add_pass(const overdub *self, history *h, const pass *p, bool is_heard,
                           uint32_t *out_id, error *err)
{
    uint32_t number = (uint32_t)(p - self->pass) + 1;
    mrt_result result = add_layer(self, h, number, out_id, err);
    if (result >= 0)
        result = add_clip(self, h, p, *out_id, err);
    return result >= 0 && !is_heard ? mute(h, *out_id, err) : result;
}

static mrt_result make_edits(const overdub *self, history *h, overdub_result *out, error *err)
{
    const pass *heard = heard_pass(self);
    mrt_result result = MRT_OK;
    if (!heard)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "nothing was performed between in and out%s: the take is as it was",
                         self->pass[0].raw_take ? "; what came before is a take by itself" : "");
    for (uint32_t i = 0; i <= self->pass_now && result >= 0; ++i) {
        const pass *p = &self->pass[i];
        uint32_t id = self->settings.into_layer;
        if (p->sample_count == 0 || (id && p > heard))
            continue;
        result = id ? punch(self, h, p, err) : add_pass(self, h, p, p == heard, &id, err);
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

mrt_result overdub_finish(overdub *self, overdub_result *out, error *err)
{
    *out = (overdub_result){0};
    mrt_result result = MRT_OK;
    if (!self->is_over) {
        result = recorder_take_end(self->recorder, err);
        self->pass[self->pass_now].raw_take = recorder_take(self->recorder);
    }
    if (result >= 0 && recorder_problem(self->recorder)[0])
        result = error_set(err, MRT_ERR_IO, "%s", recorder_problem(self->recorder));
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    if (result < 0)
        return result;
    edit_store *store = NULL;
    history *h = NULL;
    result = edit_store_open(&store, self->settings.show, self->settings.take, utc_ms, err);
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

layer *overdub_layer(overdub *self)
{
    return self->layer;
}

int64_t overdub_at_ns(const overdub *self)
{
    return self->at_ns;
}

const transport *overdub_transport(const overdub *self)
{
    return self->has_begun && !self->is_over ? &self->transport : NULL;
}

const take *overdub_take(const overdub *self)
{
    return &self->take;
}

const char *overdub_note(const overdub *self)
{
    return sequencer_note(self->sequencer);
}
