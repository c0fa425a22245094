/* [frame] The timeline: a take that stands, is played, scrubbed, performed over. */
#include "base/clock.h"
#include "stage/live/live_state.h"

#include <stdlib.h>

/* So long a drawn instant waits for samples that are on the way. */
static const int64_t wait_ns = 15 * NS_PER_MS;

static const transport still = {.speed = 1.0};

const transport *live_time_motion(const live_stage *stage)
{
    if (stage->mode == LIVE_OVERDUBS)
        return &stage->over->transport;
    return stage->timeline ? &stage->motion[slot_front(&stage->motion_slot)] : &still;
}

static void tell_sound(live_stage *stage, int64_t now_ns)
{
    if (!stage->sound)
        return;
    sound_motion motion = sound_motion_of(live_time_motion(stage), now_ns);
    sound_move(stage->sound, &motion);
}

static void tell_error(live_stage *stage, const error *err)
{
    log_push(stage->log, MRT_LOG_ERROR, "take", err->text);
}

int64_t live_time_shown_at(const transport *motion, int64_t at_ns)
{
    return at_ns >= motion->end_ns && motion->end_ns > 0 ? motion->end_ns - 1 : at_ns;
}

/* ---- the take's own thread ---- */

static void *bring(void *data)
{
    live_timeline *self = data;
    while (!atomic_load(&self->stop)) {
        uint32_t seen = wake_seen(&self->work);
        if (!atomic_load(&self->is_away)) {
            if (!atomic_load(&self->stop))
                wake_wait_until_ns(&self->work, seen, clock_now_ns() + NS_PER_S);
            continue;
        }
        self->failed.text[0] = '\0';
        mrt_result result = self->is_sought
                                ? sequencer_seek(self->sequencer, self->to_ns, &self->failed)
                                : sequencer_play_to(self->sequencer, self->to_ns, &self->failed);
        if (result >= 0)
            self->failed.text[0] = '\0';
        atomic_store(&self->is_away, false);
        wake_signal(self->done);
    }
    return NULL;
}

mrt_result live_timeline_start(live_timeline *self, wake *done, error *err)
{
    wake_init(&self->work);
    self->done = done;
    atomic_init(&self->stop, false);
    atomic_init(&self->is_away, false);
    if (pthread_create(&self->thread, NULL, bring, self) != 0)
        return error_set(err, MRT_ERR_MEMORY, "no thread to play a take on");
    self->has_thread = true;
    return MRT_OK;
}

void live_timeline_stop(live_timeline *self)
{
    if (!self->has_thread)
        return;
    atomic_store(&self->stop, true);
    wake_signal(&self->work);
    pthread_join(self->thread, NULL);
    self->has_thread = false;
}

bool live_time_is_here(const live_stage *stage)
{
    return stage->timeline && !stage->is_held && !atomic_load(&stage->timeline->is_away);
}

/* What its thread was sent for has been done. */
static void receive(live_stage *stage)
{
    if (!stage->is_awaited || !live_time_is_here(stage))
        return;
    stage->is_awaited = false;
    stage->has_come = stage->is_dirty = true;
    if (stage->timeline->failed.text[0])
        tell_error(stage, &stage->timeline->failed);
}

bool live_time_may_show(live_stage *stage, int64_t now_ns)
{
    receive(stage);
    return stage->mode != LIVE_SHOWS || !stage->timeline ||
           (now_ns >= stage->hold_until_ns && live_time_is_here(stage) &&
            (stage->has_come || !stage->is_sought));
}

/* However often it was sought: only the newest instant is gone to. */
void live_time_send(live_stage *stage, int64_t now_ns)
{
    receive(stage);
    if (stage->mode != LIVE_SHOWS || !live_time_is_here(stage) || now_ns < stage->hold_until_ns)
        return;
    live_timeline *to = stage->timeline;
    const transport *motion = live_time_motion(stage);
    int64_t at_ns = live_time_shown_at(motion, transport_at(motion, now_ns).at_ns);
    if (!stage->is_sought && at_ns == sequencer_now_ns(to->sequencer))
        return;
    to->to_ns = at_ns;
    to->is_sought = stage->is_sought;
    stage->is_sought = false;
    stage->is_awaited = true;
    atomic_store(&to->is_away, true);
    wake_signal(&to->work);
}

/* ---- over the take ---- */

/* The last face of it stays until the take is shown with what was made of it. */
static void end_over(live_stage *stage, int64_t now_ns)
{
    static const sequencer_live nobody = {NULL, NULL, false};
    sequencer_set_live(stage->timeline->sequencer, &nobody);
    stage->mode = LIVE_SHOWS;
    stage->hold_until_ns = now_ns + LIVE_HOLD_NS;
    stage->is_sought = true;
}

void live_time_end_over(live_stage *stage, int64_t now_ns, error *err)
{
    error why = {""};
    if (overdub_run_end(stage->over, stage->recorder, &why) < 0) {
        tell_error(stage, &why);
        (void)error_set(err, MRT_ERR_IO, "%s", why.text);
    }
    end_over(stage, now_ns);
}

/* Samples are measured a little before they come: what was shown does not go back for them. */
static mrt_result go_over(live_stage *stage, int64_t clock_ns, error *err)
{
    overdub_run *run = stage->over;
    if (clock_ns < stage->over_ns)
        clock_ns = stage->over_ns;
    stage->over_ns = clock_ns;
    mrt_result result = overdub_run_go_to(run, stage->recorder, clock_ns, err);
    if (result < 0 || run->is_over || clock_ns < run->rolling_ns)
        return result;
    return sequencer_play_to(stage->timeline->sequencer, run->at_ns, err);
}

mrt_result live_time_step(live_stage *stage, const sample_step *performed, error *err)
{
    overdub_run *run = stage->over;
    sequencer *s = stage->timeline->sequencer;
    mrt_result result = go_over(stage, performed->time_ns, err);
    if (result < 0)
        tell_error(stage, err);
    if (run->is_over) {
        end_over(stage, performed->time_ns);
        performer_step(stage->scene->performer, performed);
        return MRT_OK;
    }
    overdub_run_note(run, stage->recorder, performed->time_ns);
    sequencer_weigh_live(s, overdub_run_weight(run));
    sequencer_live_step(s, performed);
    return MRT_OK;
}

static composer *shown_over(live_stage *stage, int64_t now_ns)
{
    error err = {""};
    if (go_over(stage, now_ns - wait_ns, &err) < 0)
        tell_error(stage, &err);
    player_show_until(stage->loop, stage->over_ns);
    if (stage->over->is_over)
        end_over(stage, now_ns);
    return sequencer_composer(stage->timeline->sequencer);
}

composer *live_time_shown(live_stage *stage, int64_t now_ns)
{
    if (stage->mode == LIVE_PERFORMS || !stage->timeline)
        return performer_composer(stage->scene->performer);
    tell_sound(stage, now_ns);
    if (stage->mode == LIVE_OVERDUBS)
        return shown_over(stage, now_ns);
    if (!live_time_may_show(stage, now_ns))
        return NULL;
    stage->has_come = false;
    return sequencer_composer(stage->timeline->sequencer);
}
