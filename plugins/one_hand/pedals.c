#include "pedals.h"

static const double long_ago_s = 60.0;
static const double single_hold_s = 0.3;     /* one pedal for both: longer than a tap */
static const double intensity_time_s = 0.06; /* a foot's step becomes a way */
static const double intensity_most = 1.5;

void pedals_reset(pedals *self)
{
    *self = (pedals){.intensity = 1.0};
    for (int i = 0; i < PEDAL_COUNT; ++i)
        self->pedal[i].since_press_s = long_ago_s;
}

static bool has_pedal(const mrt_frame *frame, int set)
{
    int number = (int)frame->params[set];
    return number >= 1 && number <= MRT_MAX_PEDALS;
}

/* 0 up .. 1 down; 0 without a pedal. */
static double position(const mrt_frame *frame, int set)
{
    if (!has_pedal(frame, set))
        return 0.0;
    double value = (double)frame->pedal[(int)frame->params[set] - 1];
    return value > 0.0 ? (value < 1.0 ? value : 1.0) : 0.0;
}

/* True in the frame of the press. A pedal that was half down stays what it was. */
static bool step_pedal(pedal *p, double position, double dt_s)
{
    bool was_down = p->is_down;
    p->is_down = position > (was_down ? 0.4 : 0.6);
    p->since_press_s += dt_s;
    if (p->since_press_s > long_ago_s)
        p->since_press_s = long_ago_s;
    return p->is_down && !was_down;
}

static void step_intensity(pedals *self, const mrt_frame *frame, double dt_s)
{
    bool has = has_pedal(frame, SET_INTENSITY_PEDAL);
    double wanted = has ? intensity_most * position(frame, SET_INTENSITY_PEDAL) : 1.0;
    if (has && !self->has_intensity && dt_s <= 0.0)
        self->intensity = wanted; /* how it is found in the first frame */
    self->has_intensity = has;
    self->intensity += dt_s / (dt_s + intensity_time_s) * (wanted - self->intensity);
}

/* A pedal's press with what came before it; the time of the press before is in since_s. */
typedef struct press {
    bool is_now;
    double since_s;
} press;

static void step_anchor(pedals *self, press anchor, double tap_s, pedals_events *out)
{
    if (!anchor.is_now)
        return;
    out->revert = self->can_revert && anchor.since_s <= tap_s;
    out->anchor = !out->revert;
    self->can_revert = out->anchor;
}

static void step_hold(pedals *self, press hold, double tap_s)
{
    if (!hold.is_now)
        return;
    self->is_latched = !self->is_latched && !self->is_hold_spent && hold.since_s <= tap_s;
    self->is_hold_spent = false;
}

static void step_layer(pedals *self, press layer, double tap_s, pedals_events *out)
{
    if (!layer.is_now)
        return;
    out->lock_layer = !self->is_layer_spent && layer.since_s <= tap_s;
    self->is_layer_spent = out->lock_layer;
}

/* Both go down within a tap's time, in either order. */
static bool is_chord(const pedals *self, press anchor, press hold, double tap_s)
{
    const pedal *p = self->pedal;
    return (anchor.is_now || hold.is_now) && p[PEDAL_ANCHOR].is_down && p[PEDAL_HOLD].is_down &&
           p[PEDAL_ANCHOR].since_press_s <= tap_s && p[PEDAL_HOLD].since_press_s <= tap_s;
}

static void use_buttons(const mrt_frame *frame, pedals_events *out)
{
    const double *params = frame->params;
    out->lock_layer = out->lock_layer || params[SET_NEXT_LAYER] > 0.5;
    out->to_neutral = out->to_neutral || params[SET_TO_NEUTRAL] > 0.5;
    out->revert = !out->to_neutral && (out->revert || params[SET_REVERT] > 0.5);
    out->anchor = !out->to_neutral && !out->revert && (out->anchor || params[SET_ANCHOR] > 0.5);
}

pedals_events pedals_step(pedals *self, const mrt_frame *frame, double dt_s)
{
    static const int sets[PEDAL_COUNT] = {SET_ANCHOR_PEDAL, SET_HOLD_PEDAL, SET_LAYER_PEDAL};
    const double *params = frame->params;
    double tap_s = params[SET_DOUBLE_TAP];
    bool is_single = has_pedal(frame, SET_HOLD_PEDAL) &&
                     (int)params[SET_ANCHOR_PEDAL] == (int)params[SET_HOLD_PEDAL];
    press presses[PEDAL_COUNT];
    pedals_events out = {0};
    for (int i = 0; i < PEDAL_COUNT; ++i) {
        pedal *p = &self->pedal[i];
        presses[i].is_now = step_pedal(p, position(frame, sets[i]), dt_s);
        presses[i].since_s = p->since_press_s;
        if (presses[i].is_now)
            p->since_press_s = 0.0;
    }
    step_intensity(self, frame, dt_s);
    step_anchor(self, presses[PEDAL_ANCHOR], tap_s, &out);
    step_layer(self, presses[PEDAL_LAYER], tap_s, &out);
    const pedal *hold = &self->pedal[PEDAL_HOLD];
    if (is_single) {
        out.hold = hold->is_down && hold->since_press_s > single_hold_s;
    } else {
        step_hold(self, presses[PEDAL_HOLD], tap_s);
        if (is_chord(self, presses[PEDAL_ANCHOR], presses[PEDAL_HOLD], tap_s)) {
            out.to_neutral = true;
            self->is_hold_spent = true;
            self->is_latched = self->can_revert = false;
        }
        out.hold = self->is_latched || (hold->is_down && !self->is_hold_spent);
    }
    out.hold = out.hold || params[SET_HOLD] > 0.5;
    out.other_layer = self->pedal[PEDAL_LAYER].is_down && !self->is_layer_spent;
    use_buttons(frame, &out);
    return out;
}
