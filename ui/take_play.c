/* A take is played into outputs, in its own time. */
#include "base/cancel.h"
#include "base/clock.h"
#include "perform_session.h"
#include "take.h"
#include "take_stage.h"
#include "terminal.h"

#include <stdio.h>

static const int64_t ahead_ns = 200 * NS_PER_MS;     /* before its first instant is due */
static const int64_t slice_ns = 100 * NS_PER_MS;     /* after which a signal is answered */
static const int64_t least_apart_ns = 4 * NS_PER_MS; /* of the take: two that are shown */
/* Later than this it is left out, unless for so long none was shown. */
static const int64_t late_ns = 10 * NS_PER_MS, pause_ns = 50 * NS_PER_MS;

typedef struct playing {
    take_call *call;
    take_stage stage;
    perform_outputs outputs;
    int64_t in_ns, out_ns, begun_ns; /* begun: of the host's clock, when in_ns is due */
    int64_t shown_at_ns;             /* of the take */
} playing;

static mrt_result take_range(playing *self, error *err)
{
    const take *t = &self->stage.take;
    self->out_ns = t->duration_ns;
    mrt_result result = take_time(self->call, TAKE_IN, t, &self->in_ns, err);
    if (result >= 0)
        result = take_time(self->call, TAKE_OUT, t, &self->out_ns, err);
    if (result >= 0 &&
        (self->in_ns < 0 || self->in_ns >= self->out_ns || self->out_ns > t->duration_ns))
        result = error_set(err, MRT_ERR_ARGUMENT,
                           "%.9g .. %.9g s is no range of take %lld, which lasts %.9g s",
                           (double)self->in_ns / 1e9, (double)self->out_ns / 1e9, (long long)t->id,
                           (double)t->duration_ns / 1e9);
    return result;
}

static mrt_result open_outputs(playing *self, error *err)
{
    const perform_mapping_settings with = {&self->stage.plugins, self->stage.log, CLOCK_REAL,
                                           ISOLATE_FOREIGN};
    performer *p = sequencer_performer(self->stage.sequencer);
    return perform_outputs_open(&self->outputs, self->call->output, self->call->output_count, &with,
                                performer_composer(p), &self->stage.face, err);
}

/* A machine that is too slow for all of them leaves instants out; the others keep their time. */
static bool is_wanted(const playing *self, int64_t at_ns)
{
    int64_t late_by_ns = clock_now_ns() - (self->begun_ns + (at_ns - self->in_ns));
    return at_ns - self->shown_at_ns >= least_apart_ns &&
           (late_by_ns < late_ns || at_ns - self->shown_at_ns >= pause_ns);
}

/* The instant that the sequencer stands at is shown when it is due: it is found before that. */
static void show_when_due(playing *self, int64_t at_ns)
{
    char text[32];
    performer *p = sequencer_performer(self->stage.sequencer);
    performer_draw(p);
    int64_t due_ns = self->begun_ns + (at_ns - self->in_ns), now_ns = clock_now_ns();
    for (; now_ns < due_ns && !cancel_is_asked(); now_ns = clock_now_ns())
        clock_sleep_until_ns(due_ns - now_ns > slice_ns ? now_ns + slice_ns : due_ns);
    perform_outputs_show(&self->outputs, p, due_ns, at_ns);
    self->shown_at_ns = at_ns;
    (void)snprintf(text, sizeof text, "%.1f s", (double)at_ns / 1e9);
    progress_show(&self->call->shown,
                  (double)(at_ns - self->in_ns) / (double)(self->out_ns - self->in_ns), text);
    news_print(self->stage.log);
}

static mrt_result play(playing *self, error *err)
{
    sequencer *s = self->stage.sequencer;
    mrt_result result = sequencer_seek(s, self->in_ns, err);
    self->begun_ns = clock_now_ns() + ahead_ns;
    self->shown_at_ns = self->in_ns - pause_ns;
    while (result >= 0 && result != MRT_END && !cancel_is_asked()) {
        int64_t at_ns = sequencer_now_ns(s) > self->in_ns ? sequencer_now_ns(s) : self->in_ns;
        if (at_ns > self->out_ns)
            break;
        if (is_wanted(self, at_ns))
            show_when_due(self, at_ns);
        result = sequencer_step(s, err);
        if (result >= 0 && sequencer_check(s, err) < 0)
            result = MRT_ERR_FORMAT;
    }
    /* The receivers keep the last face. */
    if (result == MRT_END && !cancel_is_asked() && sequencer_now_ns(s) > self->shown_at_ns)
        show_when_due(self, sequencer_now_ns(s));
    return result;
}

mrt_result take_play_run(take_call *call, error *err)
{
    playing self = {.call = call};
    mrt_result result = take_need(call, TAKE_OUTPUT, err);
    if (result >= 0)
        result = take_stage_open(&self.stage, call, call->word[1], call->text[TAKE_FACE], err);
    if (result >= 0)
        result = take_range(&self, err);
    if (result >= 0)
        result = open_outputs(&self, err);
    if (result >= 0) {
        progress_start(&call->shown, "playing");
        result = play(&self, err);
        progress_end(&call->shown);
        take_stage_tell(&self.stage);
        perform_outputs_report(self.outputs.outputs, call->told);
    }
    perform_outputs_close(&self.outputs);
    take_stage_finish(&self.stage);
    return result < 0 ? result : MRT_OK;
}
