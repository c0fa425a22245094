#include "clutch.h"

const char *const clutch_start_labels[] = {"At once", "On trigger", NULL};
const char *const clutch_pedal_labels[] = {"None",    "Pedal 1", "Pedal 2",
                                           "Pedal 3", "Pedal 4", NULL};
const char *const clutch_release_labels[] = {"Hold", "Spring back", NULL};

void clutch_reset(clutch *self)
{
    *self = (clutch){0};
}

/* True in the frame in which the pedal goes down. */
static bool is_pressed(const clutch *self, const mrt_frame *frame, double pedal)
{
    int number = (int)pedal - 1;
    if (number < 0 || number >= MRT_MAX_PEDALS)
        return false;
    return frame->pedal[number] > 0.5f && !self->was_down[number];
}

clutch_events clutch_step(clutch *self, const mrt_frame *frame, const double *params)
{
    clutch_events events = {
        .engage =
            params[CLUTCH_ENGAGE] > 0.5 || is_pressed(self, frame, params[CLUTCH_ENGAGE_PEDAL]),
        .release =
            params[CLUTCH_RELEASE] > 0.5 || is_pressed(self, frame, params[CLUTCH_RELEASE_PEDAL]),
        .commit =
            params[CLUTCH_COMMIT] > 0.5 || is_pressed(self, frame, params[CLUTCH_COMMIT_PEDAL]),
    };
    if (!self->has_started && params[CLUTCH_START] < 0.5)
        events.engage = true;
    self->has_started = true;
    for (int i = 0; i < MRT_MAX_PEDALS; ++i)
        self->was_down[i] = frame->pedal[i] > 0.5f;
    return events;
}

bool clutch_springs_back(const double *params)
{
    return params[CLUTCH_ON_RELEASE] > 0.5;
}

float clutch_release_rate(const double *params)
{
    return (float)(3.0 / params[CLUTCH_RELEASE_TIME]);
}
