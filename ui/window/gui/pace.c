#include "window/gui/pace.h"
#include "base/clock.h"

static const int64_t look_every_ns = NS_PER_S / 2;

/* Dear ImGui shows what an event leads to up to three frames later: a menu is measured, then
 * placed, then shown. */
enum { SETTLES_EVENT = 4, SETTLES_CHANGE = 1 };

const char *const pace_reason_names[PACE_REASONS] = {
    [PACE_NOT_DUE] = "none",      [PACE_EVENT] = "event", [PACE_SIGNAL] = "signal",
    [PACE_SETTLING] = "settling", [PACE_ASKED] = "asked", [PACE_LOOK] = "look"};

static void settle(pace *self, uint32_t frames)
{
    if (self->settles < frames)
        self->settles = frames;
}

void pace_init(pace *self)
{
    *self = (pace){.asked_ns = INT64_MAX};
    wake_init(&self->signal);
}

void pace_ask(pace *self, int64_t at_ns)
{
    if (at_ns < self->asked_ns)
        self->asked_ns = at_ns;
}

void pace_note_change(pace *self)
{
    if (self->why != PACE_SETTLING) /* else numbers that change each time never come to rest */
        settle(self, SETTLES_CHANGE);
}

pace_reason pace_due(const pace *self, int64_t now_ns, bool has_event)
{
    if (has_event)
        return PACE_EVENT;
    if (wake_seen(&self->signal) != self->seen)
        return PACE_SIGNAL;
    if (self->settles > 0 || self->began_ns == 0)
        return PACE_SETTLING;
    if (now_ns >= self->asked_ns)
        return PACE_ASKED;
    return now_ns >= self->began_ns + look_every_ns ? PACE_LOOK : PACE_NOT_DUE;
}

int64_t pace_until_ns(const pace *self)
{
    const int64_t look_ns = self->began_ns + look_every_ns;
    return self->asked_ns < look_ns ? self->asked_ns : look_ns;
}

bool pace_begin(pace *self, pace_reason why, bool has_rested, int64_t now_ns)
{
    static const int64_t late_ns = 50 * NS_PER_MS;
    const bool is_late =
        why == PACE_EVENT && has_rested && self->began_ns > 0 && now_ns - self->began_ns > late_ns;
    self->has_rested = has_rested;
    self->why = why;
    self->seen = wake_seen(&self->signal);
    self->began_ns = now_ns;
    self->asked_ns = INT64_MAX;
    self->settles -= self->settles > 0;
    if (why == PACE_EVENT)
        settle(self, SETTLES_EVENT);
    self->count[why] += 1;
    return is_late;
}
