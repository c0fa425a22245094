#include "attach.h"

#include "curve.h"

#include <math.h>
#include <string.h>

void attach_reset(attach *self)
{
    memset(self, 0, sizeof *self);
}

void attach_change(attach *self, double duration_s)
{
    self->has_changed = true;
    self->duration_s = duration_s;
}

static void shorten(double v[3], double most)
{
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (length <= most)
        return;
    for (int axis = 0; axis < 3; ++axis)
        v[axis] *= most / length;
}

void attach_keep(attach *self, double most_mm, const double *low, const double *high)
{
    self->offset = self->shown;
    for (int landmark = 0; landmark < LANDMARK_COUNT; ++landmark)
        shorten(self->offset.value + 3 * landmark, most_mm);
    double *dof = self->offset.value + POSE_DOFS;
    for (int i = 0; i < DOF_COUNT; ++i)
        dof[i] = curve_clamp(dof[i], low[i], high[i]);
}

void attach_forget(attach *self, double duration_s)
{
    memset(&self->offset, 0, sizeof self->offset);
    memset(&self->held, 0, sizeof self->held);
    attach_change(self, duration_s);
}

/* A layer that stops following, or is stopped by one reason more, stays where it is seen. */
static void take_holds(attach *self, const unsigned held_by[LAYER_COUNT], double reattach_s)
{
    bool is_stopped[LAYER_COUNT];
    bool is_other = false;
    for (int layer = 0; layer < LAYER_COUNT; ++layer) {
        unsigned added = held_by[layer] & ~self->held_by[layer];
        bool follows = self->held_by[layer] == 0;
        is_stopped[layer] = (added & (HELD_BY_PEDAL | HELD_BY_ABSENCE)) || (added && follows);
        is_other = is_other || held_by[layer] != self->held_by[layer];
        self->held_by[layer] = held_by[layer];
    }
    for (int i = 0; i < POSE_COUNT; ++i)
        if (is_stopped[pose_layer(i)])
            self->held.value[i] = self->shown.value[i];
    if (is_other && !self->has_changed)
        attach_change(self, reattach_s);
}

void attach_step(attach *self, const pose *target, const unsigned held_by[LAYER_COUNT],
                 double reattach_s, double dt_s)
{
    take_holds(self, held_by, reattach_s);
    self->time_s = self->has_changed ? 0.0 : self->time_s + dt_s;
    double left =
        self->time_s < self->duration_s ? 1.0 - curve_ease(self->time_s / self->duration_s) : 0.0;
    for (int i = 0; i < POSE_COUNT; ++i) {
        double goal = self->held_by[pose_layer(i)] ? self->held.value[i]
                                                   : target->value[i] + self->offset.value[i];
        if (self->has_changed)
            self->rest.value[i] = self->shown.value[i] - goal;
        self->shown.value[i] = left > 0.0 ? goal + left * self->rest.value[i] : goal;
    }
    self->has_changed = false;
}
