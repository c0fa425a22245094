#include "stage/live/live_stage.h"
#include "base/clock.h"
#include "base/memory.h"
#include "show/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* [main] A take on the stage: show it, play it, overdub it. */

/* Memory limit of the checkpoints for scrubbing. It is enough for two minutes of an unanchored
 * mapping on the puppet, or for hours of an anchored one. */
static const size_t scrub_bytes = (size_t)64 << 20;

static bool may_move(const live *self)
{
    return self->is_shown && !self->is_over;
}

/* ---- last position of each take ---- */

static void remember_position(live *self)
{
    if (!self->timeline)
        return;
    int64_t at_ns = live_position(self).at_ns;
    uint32_t i = 0;
    while (i < self->position_count && self->position[i].take != self->timeline->take)
        i += 1;
    if (i == LIVE_POSITIONS) {
        memmove(&self->position[0], &self->position[1],
                (LIVE_POSITIONS - 1) * sizeof self->position[0]);
        i -= 1;
    }
    if (i >= self->position_count)
        self->position_count = i + 1;
    self->position[i].take = self->timeline->take;
    self->position[i].at_ns = at_ns;
}

static int64_t position_of(const live *self, int64_t take_id)
{
    for (uint32_t i = 0; i < self->position_count; ++i)
        if (self->position[i].take == take_id)
            return self->position[i].at_ns;
    return 0;
}

/* ---- create and destroy ---- */

static void timeline_destroy(live_timeline *t)
{
    if (!t)
        return;
    live_timeline_stop(t);
    sequencer_destroy(t->sequencer);
    show_close(t->show);
    free(t);
    memory_give_back();
}

static mrt_result timeline_create(live *self, const take *t, int64_t at_ns, live_timeline **out,
                                  error *err)
{
    *out = NULL;
    live_timeline *made = calloc(1, sizeof *made);
    if (!made)
        return error_set(err, MRT_ERR_MEMORY, "no memory for a take");
    made->take = t->id;
    transport whole;
    transport_init(&whole, t->duration_ns);
    mrt_result result = show_open(&made->show, show_path(self->show), SHOW_READ, err);
    const sequencer_settings settings = {.show = made->show,
                                         .plugins = self->settings.plugins,
                                         .log = self->settings.log,
                                         .face = &self->scene->ready,
                                         .solver = &self->scene->solver,
                                         .checkpoint_bytes = scrub_bytes};
    if (result >= 0)
        result = sequencer_create(&made->sequencer, &settings, t, err);
    if (result >= 0)
        result = sequencer_seek(made->sequencer, live_time_shown_at(&whole, at_ns), err);
    if (result >= 0)
        result = live_timeline_start(made, player_wake(self->stage.loop), err);
    if (result < 0) {
        timeline_destroy(made);
        return result;
    }
    *out = made;
    return MRT_OK;
}

/* ---- the face of a take ---- */

static int64_t first_performance(const take *t)
{
    int64_t found = 0;
    for (uint32_t i = 0; i < t->layer_count; ++i)
        for (uint32_t j = 0; j < t->layer[i].clip_count && found == 0; ++j)
            if (own_layer_is_active(t, i))
                found = t->layer[i].clip[j].performance;
    return found;
}

static bool has_contacts_in_common(const live *self, const char *rig_json)
{
    const mrt_face *about = composer_about(self->scene->performer->composer);
    char quoted[80];
    for (uint32_t i = 0; i < about->contact_count && rig_json; ++i) {
        snprintf(quoted, sizeof quoted, "\"%.70s\"", about->contacts[i].name);
        if (strstr(rig_json, quoted))
            return true;
    }
    return false;
}

static mrt_result check_face(live *self, const take *t, error *err)
{
    show_performance of;
    int64_t id = first_performance(t);
    self->note[0] = '\0';
    if (id == 0)
        return MRT_OK; /* the take has no audible layer: any face can show it */
    mrt_result result = show_performance_read(self->show, id, &of, err);
    if (result < 0)
        return result;
    const take_performance *then = &of.performance, *now = &self->scene->face;
    bool is_same_mesh = strcmp(then->mesh_hash, now->mesh_hash) == 0;
    if (!is_same_mesh && !has_contacts_in_common(self, then->rig_json))
        result = error_set(err, MRT_ERR_UNSUPPORTED,
                           "take %lld was performed on another face. Open %.300s to see it.",
                           (long long)t->id, then->rig);
    else if (!is_same_mesh || strcmp(then->rig_hash, now->rig_hash) != 0)
        snprintf(self->note, sizeof self->note,
                 "%.300s has changed since take %lld was recorded. The take is shown on the "
                 "current face.\n",
                 then->rig, (long long)t->id);
    show_performance_finish(&of);
    return result;
}

/* ---- show a take ---- */

typedef struct showing {
    live *live;
    live_timeline *timeline, *old;
    const take *take;
} showing;

/* Publishes the transport of [main] to the frame thread. */
static void live_take_tell_transport(live *self)
{
    live_stage *stage = &self->stage;
    stage->motion[slot_back(&stage->motion_slot)] = self->transport;
    slot_publish(&stage->motion_slot);
    if (stage->loop)
        wake_signal(player_wake(stage->loop));
}

static void fade_over(live_stage *stage)
{
    live_board_ease(&stage->scene->board, clock_now_ns());
    stage->is_dirty = true;
}

/* Exchanges the take and its transport together, so that no take is shown at the position of
 * another. */
static mrt_result put_timeline(live_stage *stage, void *data, error *err)
{
    (void)err;
    showing *s = data;
    live_take_tell_transport(s->live);
    s->old = stage->timeline;
    if (stage->mode == LIVE_PERFORMS || !s->old || s->old->take != s->timeline->take)
        fade_over(stage);
    stage->timeline = s->timeline;
    stage->mode = LIVE_SHOWS;
    stage->hold_until_ns = 0;
    stage->has_pending_seek = stage->is_dirty = true;
    return MRT_OK;
}

static mrt_result change_take(live_stage *stage, void *data, error *err)
{
    (void)err;
    const showing *s = data;
    if (stage->mode == LIVE_PERFORMS)
        fade_over(stage);
    stage->mode = LIVE_SHOWS;
    (void)live_timeline_move(stage->timeline, LIVE_TIMELINE_RELEASE);
    stage->hold_until_ns = 0;
    stage->has_pending_seek = stage->is_dirty = true;
    live_take_tell_transport(s->live);
    return MRT_OK;
}

static mrt_result move_timeline(live_stage *stage, void *data, error *err)
{
    (void)err;
    (void)live_timeline_move(stage->timeline, *(const live_timeline_event *)data);
    return MRT_OK;
}

/* Moves ownership of the shown take's sequencer to [main], until a command returns it. */
static void live_take_hold(live *self)
{
    error ignored = {""};
    live_timeline_event event = LIVE_TIMELINE_HOLD;
    (void)!live_run_command(self, move_timeline, &event, &ignored);
    while (atomic_load(&self->timeline->state) != LIVE_TIMELINE_HELD)
        clock_sleep_until_ns(clock_now_ns() + NS_PER_MS);
}

static void live_take_release(live *self)
{
    error ignored = {""};
    live_timeline_event event = LIVE_TIMELINE_RELEASE;
    (void)!live_run_command(self, move_timeline, &event, &ignored);
}

static mrt_result show_hands(live_stage *stage, void *data, error *err)
{
    (void)data, (void)err;
    if (stage->mode != LIVE_PERFORMS)
        fade_over(stage);
    stage->mode = LIVE_PERFORMS;
    stage->hold_until_ns = 0;
    live_time_update_sound(stage, clock_now_ns());
    return MRT_OK;
}

static mrt_result drop_timeline(live_stage *stage, void *data, error *err)
{
    showing *s = data;
    mrt_result result = show_hands(stage, NULL, err);
    s->old = stage->timeline;
    stage->timeline = NULL;
    return result;
}

static void add_note(live *self, const sequencer *from)
{
    size_t used = strlen(self->note);
    snprintf(self->note + used, sizeof self->note - used, "%s", sequencer_note(from));
}

static void load_sound(live *self, const take *t)
{
    error err = {""};
    if (t->audio.audio == 0 && !self->sound)
        return;
    if (live_sound_need(self, &err) < 0 || sound_load(self->sound, &t->audio, &err) < 0)
        log_pushf(self->settings.log, MRT_LOG_WARNING, "sound",
                  "%.200s. The take is played without sound.", err.text);
}

static void take_rate(live *self, const take *t)
{
    error ignored = {""};
    self->rate = (timecode_rate){.num = 30, .den = 1};
    if (t->fps > 0.0 && timecode_rate_of(&self->rate, t->fps, &ignored) < 0)
        self->rate = (timecode_rate){.num = 30, .den = 1};
}

static mrt_result show_another(live *self, const take *t, error *err)
{
    int64_t at_ns = position_of(self, t->id);
    showing s = {.live = self, .take = t};
    if (at_ns > t->duration_ns)
        at_ns = t->duration_ns;
    mrt_result result = timeline_create(self, t, at_ns, &s.timeline, err);
    if (result < 0)
        return result;
    add_note(self, s.timeline->sequencer);
    transport_init(&self->transport, t->duration_ns);
    transport_seek(&self->transport, clock_now_ns(), at_ns);
    result = live_run_command(self, put_timeline, &s, err);
    self->timeline = s.timeline;
    timeline_destroy(s.old);
    return result;
}

static void fit_transport(live *self, int64_t duration_ns)
{
    int64_t now_ns = clock_now_ns();
    transport_position position = transport_at(&self->transport, now_ns);
    self->transport.end_ns = duration_ns;
    if (position.at_ns > duration_ns)
        transport_seek(&self->transport, now_ns, duration_ns);
}

static mrt_result show_again(live *self, const take *t, error *err)
{
    showing s = {.live = self, .take = t};
    fit_transport(self, t->duration_ns);
    live_take_hold(self);
    mrt_result result = sequencer_set_take(self->timeline->sequencer, t, err);
    add_note(self, self->timeline->sequencer);
    if (result >= 0)
        return live_run_command(self, change_take, &s, err);
    live_take_release(self);
    return result;
}

mrt_result live_show_take(live *self, const take *t, error *err)
{
    error ignored = {""};
    if (!self->show)
        return error_set(err, MRT_ERR_ARGUMENT, "open a show first");
    if (self->is_over)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "the take is being overdubbed: end the overdub first");
    if (self->recorder) /* the take may use samples that are not written yet */
        (void)!writer_flush(recorder_writer(self->recorder), &ignored);
    mrt_result result = check_face(self, t, err);
    if (result < 0)
        return result;
    bool is_same = self->timeline && self->timeline->take == t->id;
    if (!is_same)
        remember_position(self);
    result = is_same ? show_again(self, t, err) : show_another(self, t, err);
    if (result < 0)
        return result;
    self->is_shown = true;
    take_rate(self, t);
    take_finish(&self->shown);
    result = take_copy(&self->shown, t, err);
    load_sound(self, t);
    return result;
}

mrt_result live_preview_take(live *self, const take *t, error *err)
{
    showing s = {.live = self, .take = t};
    if (!may_move(self) || self->timeline->take != t->id)
        return error_set(err, MRT_ERR_ARGUMENT, "the take is not on the stage");
    if (atomic_load(&self->timeline->state) == LIVE_TIMELINE_AWAY)
        return MRT_HOLD;
    fit_transport(self, t->duration_ns);
    live_take_hold(self);
    mrt_result result = sequencer_preview_take(self->timeline->sequencer, t, err);
    if (result < 0) {
        live_take_release(self);
        return result;
    }
    load_sound(self, t);
    return live_run_command(self, change_take, &s, err);
}

void live_show_hands(live *self)
{
    error ignored = {""};
    if (self->is_over && live_record_end(self, &ignored) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "recorder", ignored.text);
    if (!self->is_shown)
        return;
    live_pause(self);
    remember_position(self);
    self->is_shown = false;
    (void)!live_run_command(self, show_hands, NULL, &ignored);
}

void live_take_drop(live *self)
{
    error ignored = {""};
    showing s = {0};
    live_show_hands(self);
    (void)!live_run_command(self, drop_timeline, &s, &ignored);
    self->timeline = NULL;
    timeline_destroy(s.old);
    take_finish(&self->shown);
    self->note[0] = '\0';
}

int64_t live_shown_take(const live *self)
{
    return self->is_shown ? self->timeline->take : 0;
}

const char *live_take_note(const live *self)
{
    return self->note;
}

/* ---- the transport ---- */

const transport *live_transport(const live *self)
{
    return &self->transport;
}

transport_position live_position(const live *self)
{
    if (!self->is_over)
        return transport_at(&self->transport, clock_now_ns());
    const live_view *seen = &self->scene->board.view[slot_front(&self->scene->board.slot)];
    return (transport_position){.at_ns = seen->at_ns, .pass = seen->pass};
}

void live_play(live *self)
{
    if (!may_move(self))
        return;
    /* Lead time, so that the sound starts with the first sample of the take. */
    int64_t lead_ns = self->sound && self->shown.audio.audio ? sound_lead_ns(self->sound) : 0;
    transport_play(&self->transport, clock_now_ns() + lead_ns);
    live_take_tell_transport(self);
}

void live_pause(live *self)
{
    if (!may_move(self))
        return;
    transport_pause(&self->transport, clock_now_ns());
    live_take_tell_transport(self);
}

void live_seek(live *self, int64_t at_ns)
{
    if (!may_move(self))
        return;
    transport_seek(&self->transport, clock_now_ns(), at_ns);
    live_take_tell_transport(self);
}

void live_set_speed(live *self, double speed)
{
    if (!may_move(self) || !transport_set_speed(&self->transport, clock_now_ns(), speed))
        return;
    live_take_tell_transport(self);
}

void live_set_loop(live *self, int64_t in_ns, int64_t out_ns)
{
    if (!may_move(self))
        return;
    if (in_ns >= out_ns || !transport_set_loop(&self->transport, clock_now_ns(), in_ns, out_ns))
        transport_end_loop(&self->transport, clock_now_ns());
    live_take_tell_transport(self);
}

void live_step_frames(live *self, int64_t frames)
{
    if (!may_move(self))
        return;
    transport_step_frames(&self->transport, clock_now_ns(), self->rate, frames);
    live_take_tell_transport(self);
}

/* ---- overdub ---- */

typedef struct beginning {
    recorder_cast *cast;
    overdub_run *run;
    uint8_t *owned;
    bool is_additive;
    uint64_t overdub_count;
} beginning;

/* [frame] The take is at the start of the overdub. Discards the layer's earlier state, so that the
 * recorded samples alone determine what it shows. */
static mrt_result begin_over(live_stage *stage, void *data, error *err)
{
    beginning *b = data;
    sequencer *s = stage->timeline->sequencer;
    layer *of = stage->scene->performer->voice[0].layer;
    layer_reset_keep_taught(of);
    sequencer_set_live(s, of, b->owned, b->is_additive);
    b->cast = recorder_change(stage->recorder, b->cast);
    overdub_run_slate(b->run, stage->recorder);
    stage->over = b->run;
    stage->owned = b->owned;
    stage->mode = LIVE_OVERDUBS;
    (void)live_timeline_move(stage->timeline, LIVE_TIMELINE_RELEASE);
    b->overdub_count = ++stage->now.overdub_count;
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

/* Discards an overdub whose edits were not fetched. */
static void live_over_forget(live *self)
{
    error ignored = {""};
    beginning b = {0};
    (void)!live_run_command(self, fetch_over, &b, &ignored);
    if (b.run)
        free(b.run->plan.own);
    free(b.run);
    free(b.owned);
}

static mrt_result plan_over(const live *self, const overdub_plan *over, overdub_plan *out,
                            error *err)
{
    *out = *over;
    out->speed = self->transport.speed;
    if (over->passes == 0)
        out->passes = over->out_ns > 0 ? OVERDUB_PASSES_MAX : 1;
    out->own = calloc((size_t)over->own_count + 1, sizeof *out->own);
    if (!out->own)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the overdub");
    if (over->own_count > 0)
        memcpy(out->own, over->own, over->own_count * sizeof *out->own);
    mrt_result result = overdub_plan_check(out, &self->shown, err);
    if (result < 0)
        free(out->own);
    return result;
}

static mrt_result prepare_over(live *self, const overdub_plan *plan, beginning *b, error *err)
{
    b->run = calloc(1, sizeof *b->run);
    if (!b->run)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the overdub");
    overdub_run_init(b->run, plan, &self->shown);
    /* same contacts as the take's */
    const composer *shown = self->scene->performer->composer;
    mrt_result result =
        overdub_plan_own(plan, &self->shown, shown, &b->owned, &b->is_additive, err);
    const recorder_settings as = live_cast_settings(self, false);
    return result < 0 ? result : recorder_prepare(self->recorder, &as, &b->cast, err);
}

/* Opens everything that the take needs during the overdub, and moves it to the start. */
static mrt_result stand_at_start(live *self, const beginning *b, error *err)
{
    sequencer *s = self->timeline->sequencer;
    const overdub_plan *plan = &b->run->plan;
    int64_t to_ns = plan->out_ns > 0 ? plan->out_ns : self->shown.duration_ns;
    mrt_result result = sequencer_seek(s, b->run->start_ns, err);
    return result < 0 ? result : sequencer_prepare(s, b->run->start_ns, to_ns, err);
}

mrt_result live_overdub_start(live *self, const overdub_plan *over, error *err)
{
    overdub_plan plan;
    beginning b = {0};
    if (!self->is_shown)
        return error_set(err, MRT_ERR_ARGUMENT, "an overdub needs a take: show one first");
    if (!self->recorder)
        return error_set(err, MRT_ERR_ARGUMENT, "cannot record: %s", self->why_not);
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
            result = live_run_command(self, begin_over, &b, err);
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
    self->overdub_count = b.overdub_count;
    self->take_begun_ns = clock_now_ns();
    live_palette_repeat(self);
    return result;
}

/* Keeps the position at which the overdub ended. The hands perform as before. */
static void after_over(live *self)
{
    error err = {""};
    if (live_cast_restart(self, &err) < 0)
        log_push(self->settings.log, MRT_LOG_ERROR, "recorder", err.text);
    const live_view *seen = &self->scene->board.view[slot_front(&self->scene->board.slot)];
    transport_seek(&self->transport, clock_now_ns(), seen->at_ns);
    live_take_tell_transport(self);
}

bool live_overdub_edits(live *self, edit **out_edits, uint32_t *out_count, error *err)
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
                        "the overdub cannot become a layer: it is saved as a separate take");
        return false;
    }
    after_over(self);
    mrt_result result = live_run_command(self, fetch_over, &b, err);
    if (result >= 0)
        result = writer_flush(recorder_writer(self->recorder), err);
    const instance *mapping = live_mapping(self);
    if (result >= 0)
        result = overdub_run_edits(b.run, &self->shown, mapping ? mapping->type->name : "Pointer",
                                   out_edits, &made, err);
    if (result >= 0)
        *out_count = made.edit_count;
    if (b.run)
        free(b.run->plan.own);
    free(b.run);
    free(b.owned);
    return result >= 0;
}

void live_over_update(live *self)
{
    const live_pulse *pulse = &self->stage.pulse[slot_front(&self->stage.pulse_slot)];
    if (!self->is_over || pulse->mode == LIVE_OVERDUBS ||
        pulse->overdub_count != self->overdub_count)
        return;
    self->is_over = self->status.is_recording = false;
    self->is_over_done = true;
    self->take_ended_ns = clock_now_ns();
}

void live_take_finish(live *self)
{
    live_over_forget(self);
    take_finish(&self->shown);
}
