/* The transport: what its actions do to the take that is shown. */
#include "window/studio_state.h"

#include "base/clock.h"

static const double speeds[] = {0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0};
enum { SPEEDS = sizeof speeds / sizeof speeds[0] };

/* The chosen take on the stage; false: it could not be. */
static bool show_it(studio *self)
{
    if (live_shown_take(self->live) == self->chosen && self->view->mode != LIVE_PERFORMS)
        return true;
    return studio_show_chosen(self) >= 0;
}

void studio_seek(studio *self, int64_t at_ns)
{
    if (self->history && !self->status.is_recording && show_it(self))
        live_seek(self->live, at_ns);
}

void studio_set_range(studio *self, int64_t in_ns, int64_t out_ns)
{
    if (self->history && !self->status.is_recording && show_it(self))
        live_set_loop(self->live, in_ns, out_ns);
}

static void play_or_pause(studio *self)
{
    if (!show_it(self))
        return;
    const transport_place place = live_place(self->live);
    if (live_transport(self->live)->is_playing && !place.has_stopped) {
        live_pause(self->live);
        return;
    }
    self->played_from_ns = place.has_stopped ? 0 : place.at_ns;
    live_play(self->live);
}

static void stop(studio *self)
{
    live_pause(self->live);
    live_seek(self->live, self->played_from_ns);
}

static int64_t end_of(const studio *self)
{
    const take *t = studio_take(self);
    return t ? t->duration_ns : 0;
}

static void seek_by(studio *self, int64_t by_ns)
{
    int64_t to_ns = live_place(self->live).at_ns + by_ns;
    const int64_t end_ns = end_of(self);
    if (to_ns < 0)
        to_ns = 0;
    live_seek(self->live, to_ns < end_ns ? to_ns : end_ns);
}

static void toggle_loop(studio *self)
{
    const transport *t = live_transport(self->live);
    if (t->is_looping)
        live_set_loop(self->live, 0, 0);
    else if (t->loop_in_ns < t->loop_out_ns)
        live_set_loop(self->live, t->loop_in_ns, t->loop_out_ns);
    else
        live_set_loop(self->live, 0, end_of(self));
}

static void set_range(studio *self, bool is_end)
{
    const transport *t = live_transport(self->live);
    const int64_t at_ns = live_place(self->live).at_ns, end_ns = end_of(self);
    int64_t in_ns = t->loop_in_ns < t->loop_out_ns ? t->loop_in_ns : 0;
    int64_t out_ns = t->loop_in_ns < t->loop_out_ns ? t->loop_out_ns : end_ns;
    if (is_end) {
        out_ns = at_ns;
        in_ns = in_ns < out_ns ? in_ns : 0;
    } else {
        in_ns = at_ns;
        out_ns = in_ns < out_ns ? out_ns : end_ns;
    }
    if (in_ns < out_ns)
        live_set_loop(self->live, in_ns, out_ns);
    else
        studio_say(self, MRT_LOG_INFO, "a range needs some time between its ends");
}

static void change_speed(studio *self, bool is_faster)
{
    const double now = live_transport(self->live)->speed;
    double next = now;
    for (uint32_t i = 0; i < SPEEDS; ++i) {
        const double one = speeds[is_faster ? i : SPEEDS - 1 - i];
        if (is_faster ? one > now + 1e-6 : one < now - 1e-6) {
            next = one;
            break;
        }
    }
    live_set_speed(self->live, next);
}

/* The one before or after the chosen one that is not deleted. */
static void choose_beside(studio *self, bool is_next)
{
    const uint32_t count = self->line_count;
    uint32_t at = count;
    for (uint32_t i = 0; i < count; ++i)
        if (self->line[i].id == self->chosen)
            at = i;
    for (uint32_t step = 1; step <= count; ++step) {
        if (!is_next && step > at)
            return;
        const uint32_t i = !is_next ? at - step : at == count ? count - step : at + step;
        if (i >= count)
            return;
        if (self->line[i].is_deleted || self->line[i].is_recording)
            continue;
        studio_heard(studio_choose_take(self, self->line[i].id));
        return;
    }
}

void studio_play_do(studio *self, action of)
{
    switch (of) {
    case ACTION_TAKE_BEFORE:
        choose_beside(self, false);
        return;
    case ACTION_TAKE_NEXT:
        choose_beside(self, true);
        return;
    case ACTION_PLAY:
        play_or_pause(self);
        return;
    case ACTION_STOP:
        stop(self);
        return;
    default:
        break;
    }
    if (!show_it(self))
        return;
    switch (of) {
    case ACTION_TO_START:
        live_seek(self->live, 0);
        break;
    case ACTION_TO_END:
        live_seek(self->live, end_of(self));
        break;
    case ACTION_FRAME_BACK:
    case ACTION_FRAME_FORWARD:
        live_step_frames(self->live, of == ACTION_FRAME_BACK ? -1 : 1);
        break;
    case ACTION_SECOND_BACK:
    case ACTION_SECOND_FORWARD:
        seek_by(self, of == ACTION_SECOND_BACK ? -NS_PER_S : NS_PER_S);
        break;
    case ACTION_LOOP:
        toggle_loop(self);
        break;
    case ACTION_LOOP_IN:
    case ACTION_LOOP_OUT:
        set_range(self, of == ACTION_LOOP_OUT);
        break;
    case ACTION_SLOWER:
    case ACTION_FASTER:
        change_speed(self, of == ACTION_FASTER);
        break;
    default:
        break;
    }
}
