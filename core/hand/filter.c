#include "hand/filter.h"

#include "base/angle.h"
#include "hand/ease.h"

#include <math.h>
#include <string.h>

static const double DEGREES_PER_RADIAN = 180.0 / ANGLE_PI;

/* Casiez 2012, equations 2 and 3: alpha = 1 / (1 + tau / Te), tau = 1 / (2 pi fc). */
static double smoothing_factor(double cutoff_hz, double dt_s)
{
    return 1.0 / (1.0 + 1.0 / (2.0 * ANGLE_PI * cutoff_hz * dt_s));
}

float filter_step(filter_state *state, const filter_settings *settings, float x, double dt_s)
{
    if (!isfinite(x)) {
        state->running = false;
        return state->value;
    }
    if (!state->running || !(dt_s > 0.0)) {
        *state = (filter_state){.value = x, .running = true};
        return x;
    }
    double value = (double)state->value, derivative = (double)state->derivative;
    double slope = ((double)x - value) / dt_s;
    derivative +=
        smoothing_factor((double)settings->derivative_cutoff_hz, dt_s) * (slope - derivative);
    double cutoff_hz = (double)settings->min_cutoff_hz + (double)settings->beta * fabs(derivative);
    value += smoothing_factor(cutoff_hz, dt_s) * ((double)x - value);
    state->value = (float)value;
    state->derivative = (float)derivative;
    return state->value;
}

/* research: 9.6 ms of lag and 0.17 degrees of rest noise for the jaw at 4 Hz. */
void hand_filter_init(hand_filter *filter)
{
    memset(filter, 0, sizeof *filter);
    filter->jaw = (filter_settings){2.0f, 0.1f, 2.0f};
    filter->finger = (filter_settings){2.0f, 0.05f, 2.0f};
    filter->wrist = (filter_settings){1.0f, 0.05f, 1.0f};
}

void hand_filter_reset(hand_filter *filter)
{
    memset(filter->state, 0, sizeof filter->state);
    filter->running = false;
}

/* Returns the settings of a sensor's group, in sensor order: thumb (0..3) and the three spreads;
 * arch, pitch and yaw (19..21); the others. */
static const filter_settings *settings_of(const hand_filter *filter, int sensor)
{
    if (sensor < 4 || sensor == 10 || sensor == 14 || sensor == 18)
        return &filter->jaw;
    return sensor >= 19 ? &filter->wrist : &filter->finger;
}

static filter_settings per_radian(const filter_settings *per_degree)
{
    filter_settings out = *per_degree;
    out.beta = (float)((double)per_degree->beta * DEGREES_PER_RADIAN);
    return out;
}

void hand_filter_apply(hand_filter *filter, float *angle_rad, int64_t time_ns)
{
    if (filter->running && hand_is_gap(filter->last_ns, time_ns))
        hand_filter_reset(filter);
    bool repeated = filter->running && time_ns == filter->last_ns;
    double dt_s = filter->running ? (double)(time_ns - filter->last_ns) * 1e-9 : 0.0;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        filter_settings settings = per_radian(settings_of(filter, i));
        angle_rad[i] = repeated ? filter->state[i].value
                                : filter_step(&filter->state[i], &settings, angle_rad[i], dt_s);
    }
    filter->last_ns = time_ns;
    filter->running = true;
}
