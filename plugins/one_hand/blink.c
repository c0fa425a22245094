#include "blink.h"

#include "curve.h"

static const double speed_time_s = 0.015; /* smoothing of the finger's speed */
static const double arrived = 1e-5; /* of the droop: then lids are exactly where they should be */
static const double gap_s = 0.1;    /* the longest dt_s there is: who knows how long it was */

void blink_reset(blink *self)
{
    *self = (blink){0};
}

void blink_forget_hand(blink *self)
{
    self->has_bend = false;
}

bool blink_is_struck(blink *self, double bend_deg, double dt_s, const double *params)
{
    if (!self->has_bend || dt_s >= gap_s) {
        self->has_bend = true;
        self->is_spent = false;
        self->bend_deg = self->stroke_from_deg = bend_deg;
        self->speed_deg_s = 0.0;
        return false;
    }
    if (!(dt_s > 0.0))
        return false;
    double speed = (bend_deg - self->bend_deg) / dt_s, least = params[SET_BLINK_SPEED];
    double before_deg = self->bend_deg;
    self->bend_deg = bend_deg;
    self->speed_deg_s += dt_s / (dt_s + speed_time_s) * (speed - self->speed_deg_s);
    if (self->speed_deg_s < 0.5 * least) { /* the stroke begins where it becomes fast */
        self->stroke_from_deg = speed < 0.5 * least ? bend_deg : before_deg;
        self->is_spent = false;
        return false;
    }
    bool is_struck = !self->is_spent && self->speed_deg_s > least &&
                     bend_deg - self->stroke_from_deg >= params[SET_BLINK_STROKE];
    self->is_spent = self->is_spent || is_struck;
    return is_struck;
}

void blink_start(blink *self)
{
    if (self->phase == BLINK_CLOSING)
        return;
    self->phase = BLINK_CLOSING;
    self->time_s = 0.0;
    self->from = self->closure;
}

/* The rest of a step that ends a phase counts for the next one: no frame rate changes a blink. */
static void move_lids(blink *self, double dt_s, const double *params)
{
    double close_s = 0.001 * params[SET_BLINK_CLOSE], open_s = 0.001 * params[SET_BLINK_OPEN];
    self->time_s += dt_s;
    if (self->phase == BLINK_CLOSING && self->time_s >= close_s) {
        self->phase = BLINK_OPENING;
        self->time_s -= close_s;
    }
    if (self->phase == BLINK_OPENING && self->time_s >= open_s)
        self->phase = BLINK_NONE;
    if (self->phase == BLINK_CLOSING)
        self->closure = self->from + (1.0 - self->from) * curve_ease(self->time_s / close_s);
    else if (self->phase == BLINK_OPENING)
        self->closure = 1.0 - curve_ease(self->time_s / open_s);
    else
        self->closure = 0.0;
}

void blink_step(blink *self, double droop, double dt_s, const double *params)
{
    if (self->phase != BLINK_NONE) {
        move_lids(self, dt_s, params);
        return;
    }
    double time_s = params[SET_DROOP_TIME];
    double part = time_s > 0.0 ? dt_s / (dt_s + time_s) : 1.0;
    self->droop += part * (droop - self->droop);
    double left = droop - self->droop;
    if (left > -arrived && left < arrived)
        self->droop = droop;
}
