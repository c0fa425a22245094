#include "show/step_rule.h"

#include "base/clock.h"

#include <marotte/plugin.h>

/* With a longer interval an input has no rhythm: a pedal, or a device that was disconnected. */
static const int64_t period_max_ns = 100 * NS_PER_MS;

uint32_t step_measures(uint32_t semantic, uint32_t hand)
{
    const bool is_angle = semantic >= MRT_CH_ANGLE && semantic < MRT_CH_ANGLE + MRT_ANGLES;
    const bool is_wrist = semantic >= MRT_CH_WRIST && semantic < MRT_CH_PEDAL;
    return hand <= MRT_RIGHT && (is_angle || is_wrist) ? 1u << (2 * hand + (is_wrist ? 1u : 0u))
                                                       : 0;
}

bool step_may_pair(const step_rhythm *a, const step_rhythm *b)
{
    return a->measures && b->measures && !(a->measures & b->measures);
}

int64_t step_shorter_period_ns(const step_rhythm *a, const step_rhythm *b)
{
    return a->period_ns < b->period_ns ? a->period_ns : b->period_ns;
}

int64_t step_window_ns(const step_rhythm *a, const step_rhythm *b)
{
    int64_t period_ns = step_shorter_period_ns(a, b);
    bool were_together = a->last_step > 0 && a->last_step == b->last_step;
    return were_together ? period_ns / 4 * 3 : period_ns / 2;
}

void step_rhythm_record(step_rhythm *self, int64_t time_ns, uint64_t number)
{
    int64_t since_ns = time_ns - self->last_ns;
    if (self->last_step == 0 || since_ns <= 0 || since_ns > period_max_ns)
        self->period_ns = 0;
    else
        self->period_ns =
            self->period_ns == 0 ? since_ns : self->period_ns + (since_ns - self->period_ns) / 8;
    self->last_ns = time_ns;
    self->last_step = number;
}

step_choice step_choice_of(const step_rhythm *first, int64_t first_ns)
{
    return (step_choice){first, first_ns, first_ns, first->measures};
}

bool step_choice_pairs(step_choice *self, const step_rhythm *other, int64_t time_ns)
{
    if (!step_may_pair(other, self->first) || (other->measures & self->measures) ||
        time_ns - self->first_ns > step_window_ns(other, self->first))
        return false;
    self->measures |= other->measures;
    self->until_ns = time_ns > self->until_ns ? time_ns : self->until_ns;
    return true;
}

bool step_choice_covers(const step_choice *self, const step_rhythm *other, int64_t time_ns)
{
    return other->measures == 0 && time_ns <= self->until_ns;
}
