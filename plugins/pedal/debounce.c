#include "debounce.h"

void debounce_reset(debounce *self)
{
    *self = (debounce){0};
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i)
        self->quiet_until_ns[i] = INT64_MIN;
}

int64_t debounce_due_ns(const debounce *self)
{
    int64_t due_ns = INT64_MAX;
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i)
        if (self->raw[i] != self->shown[i] && self->quiet_until_ns[i] < due_ns)
            due_ns = self->quiet_until_ns[i];
    return due_ns;
}

bool debounce_settle(debounce *self, int64_t time_ns, int64_t window_ns)
{
    bool changed = false;
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i) {
        if (self->raw[i] == self->shown[i] || time_ns < self->quiet_until_ns[i])
            continue;
        self->shown[i] = self->raw[i];
        self->quiet_until_ns[i] = time_ns + window_ns;
        changed = true;
    }
    return changed;
}

bool debounce_take(debounce *self, const float value[DEBOUNCE_SWITCHES], uint32_t analogue,
                   int64_t time_ns, int64_t window_ns)
{
    bool changed = false;
    for (int i = 0; i < DEBOUNCE_SWITCHES; ++i) {
        self->raw[i] = value[i];
        if (!(analogue >> i & 1u) || self->shown[i] == value[i])
            continue;
        self->shown[i] = value[i];
        changed = true;
    }
    return debounce_settle(self, time_ns, window_ns) || changed;
}
