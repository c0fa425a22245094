#include "window/panels/hand_lights.h"

#include <math.h>
#include <string.h>

static const double span_s = 0.25; /* window of the change */
static const double step_s =
    0.02; /* between two moments; HAND_LIGHTS_MOMENTS of them cover span_s */
static const double rise_s = 0.05, fall_s = 0.4;
static const float least =
    0.16f; /* minimum; 1 is the full movement of a line, smaller changes are tremor */
static const float lit_from = 0.45f; /* fully lit from this strength */
static const float backwards = 0.5f; /* weight of a movement in the opposite direction */
static const float dominance = 0.7f; /* share of the strongest line; weaker lines stay dark */

void hand_lights_begin(hand_lights *self)
{
    memset(self, 0, sizeof *self);
}

static void remember(hand_lights *self, const mrt_hand *hand)
{
    if (self->count > 0 && self->time_s - self->last_s < step_s)
        return;
    struct hand_moment *at = &self->moment[self->next];
    self->last_s = at->time_s = self->time_s;
    for (int i = 0; i < MRT_ANGLES; ++i)
        at->angle_rad[i] = isfinite(hand->angle[i]) ? hand->angle[i] : 0.0f;
    self->next = (self->next + 1) % HAND_LIGHTS_MOMENTS;
    if (self->count < HAND_LIGHTS_MOMENTS)
        self->count += 1;
}

/* Returns the oldest moment within span_s, or NULL. */
static const struct hand_moment *moment_before(const hand_lights *self)
{
    const struct hand_moment *out = NULL;
    for (uint32_t i = 0; i < self->count; ++i) {
        const struct hand_moment *at = &self->moment[i];
        if (self->time_s - at->time_s <= span_s && (!out || at->time_s < out->time_s))
            out = at;
    }
    return out;
}

/* Returns the strength of a line. If a line has two exclusive movements, such as nod and turn, the
 * stronger one counts. */
static float strength_of(const mrt_card_line *line, const mrt_hand *hand,
                         const struct hand_moment *before)
{
    float sum = 0.0f, most = 0.0f;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        const float change =
            isfinite(hand->angle[i]) ? hand->angle[i] - before->angle_rad[i] : 0.0f;
        const float part = line->per_rad[i] * change;
        sum += part;
        if (fabsf(part) > fabsf(most))
            most = part;
    }
    const float way = fabsf(most) > fabsf(sum) ? most : sum;
    return way < 0.0f ? -backwards * way : way;
}

void hand_lights_update(hand_lights *self, const mrt_card_line *line, uint32_t count,
                        const mrt_hand *hand, double dt_s)
{
    float strength[HAND_LIGHTS_MAX] = {0.0f}, strongest = 0.0f;
    const double dt = dt_s > 0.0 ? dt_s : 0.0;
    self->time_s += dt;
    if (count > HAND_LIGHTS_MAX)
        count = HAND_LIGHTS_MAX;
    if (hand->present)
        remember(self, hand);
    else
        self->count = 0;
    const struct hand_moment *before = moment_before(self);
    for (uint32_t i = 0; i < count && before; ++i) {
        strength[i] = strength_of(&line[i], hand, before);
        strongest = fmaxf(strongest, strength[i]);
    }
    for (uint32_t i = 0; i < HAND_LIGHTS_MAX; ++i) {
        const bool counts = strength[i] >= least && strength[i] >= dominance * strongest;
        const float goal =
            counts ? fminf((strength[i] - least) / (lit_from - least) + 0.25f, 1.0f) : 0.0f;
        const double time_s = goal > self->level[i] ? rise_s : fall_s;
        self->level[i] += (goal - self->level[i]) * (float)(1.0 - exp(-2.0 * dt / time_s));
    }
}
