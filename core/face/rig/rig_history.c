#include "face/rig_history.h"

#include <stdlib.h>

struct rig_history {
    rig state[RIG_HISTORY_MAX]; /* state n is at n % RIG_HISTORY_MAX */
    uint64_t first, now, last;  /* kept: first..last */
};

static rig *state_of(rig_history *self, uint64_t number)
{
    return &self->state[number % RIG_HISTORY_MAX];
}

mrt_result rig_history_create(rig_history **out, rig *first, error *err)
{
    *out = calloc(1, sizeof **out);
    if (!*out) {
        rig_destroy(first);
        return error_set(err, MRT_ERR_MEMORY, "no memory to edit the rig");
    }
    (*out)->state[0] = *first;
    *first = (rig){0};
    return MRT_OK;
}

void rig_history_destroy(rig_history *self)
{
    for (uint64_t i = 0; self && i < RIG_HISTORY_MAX; ++i)
        rig_destroy(&self->state[i]);
    free(self);
}

const rig *rig_history_now(const rig_history *self)
{
    return &self->state[self->now % RIG_HISTORY_MAX];
}

uint64_t rig_history_number(const rig_history *self)
{
    return self->now;
}

void rig_history_push(rig_history *self, rig *changed)
{
    for (uint64_t undone = self->now + 1; undone <= self->last; ++undone)
        rig_destroy(state_of(self, undone));
    self->now += 1;
    self->last = self->now;
    rig_destroy(state_of(self, self->now)); /* the oldest, when all places are taken */
    if (self->last - self->first >= RIG_HISTORY_MAX)
        self->first = self->last - RIG_HISTORY_MAX + 1;
    *state_of(self, self->now) = *changed;
    *changed = (rig){0};
}

bool rig_history_go(rig_history *self, uint64_t number)
{
    if (number < self->first || number > self->last)
        return false;
    self->now = number;
    return true;
}
