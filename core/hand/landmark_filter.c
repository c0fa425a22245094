#include "hand/landmark_filter.h"

#include "base/angle.h"
#include "hand/ease.h"
#include "hand/sensor.h"

#include <math.h>

/* Found by a random search over recordings of gloves, bare hands and a camera, with 0 and 2 mm of
 * noise on each landmark: first for little noise at rest, then for little delay. */
static const double REST_CUTOFF_HZ = 0.6;
static const double MOVING_TIME_CONSTANT_S = 0.010;
static const double DEVIATION_TIME_CONSTANT_S = 0.1;
static const double NOISE_TIME_CONSTANT_S = 2.0;
/* Mean squares of the deviations, 1 for white noise: at the first the cutoff begins to rise, at the
 * second it is the cutoff of a moving hand. */
static const double RISE_FROM = 2.2, RISE_TO = 5.0;
/* Lower limit of the noise: a still hand before a real camera has 1.4 degrees, not all of it
 * white. */
static const double LEAST_NOISE_RAD = 0.85 * ANGLE_PI / 180.0;
/* Initial noise, and the number of measurements that it counts as. */
static const double FIRST_NOISE_RAD = 3.0 * ANGLE_PI / 180.0;
enum { FIRST_NOISE_WEIGHT = 3 };

/* A finger has only three or four joints, so its mean includes that of the hand, with the weight of
 * this many joints. */
enum { HAND_WEIGHT = 5 };

enum { FINGERS = 5, GROUPS = FINGERS + 1 }; /* palm and wrist are the last group */

static double share_of(double dt_s, double time_constant_s)
{
    return dt_s / (time_constant_s + dt_s);
}

void landmark_filter_reset(landmark_filter *filter)
{
    *filter = (landmark_filter){.count = 0};
}

/* Measures the distance of the previous sample from the line through its two neighbours. White
 * noise of variance s has the mean square s (1 + f^2 + (1 - f)^2), a uniform motion 0. */
static double noise_seen(const landmark_channel *of, double x, double dt_s, double last_dt_s)
{
    const double f = last_dt_s / (last_dt_s + dt_s);
    const double before = (double)of->measured[1];
    const double beside = (double)of->measured[0] - (before + f * (x - before));
    return beside * beside / (1.0 + f * f + (1.0 - f) * (1.0 - f));
}

static int group_of(int sensor)
{
    const int finger = sensor_table[sensor].finger;
    return finger < 0 ? FINGERS : finger;
}

/* hand_read repeats an angle that is not visible, such as the spread of a bent finger. A repeated
 * value is not used for noise or motion, unless all values of its finger are repeated. */
static void find_repeated(const landmark_filter *self, const float *x, bool *out_is_repeated)
{
    bool has_news[GROUPS] = {false};
    for (int i = 0; i < MRT_ANGLES; ++i) {
        out_is_repeated[i] = x[i] == self->channel[i].measured[0];
        has_news[group_of(i)] |= !out_is_repeated[i];
    }
    for (int i = 0; i < MRT_ANGLES; ++i)
        out_is_repeated[i] &= has_news[group_of(i)];
}

/* Updates the noise and the deviation of all channels. out_motion: GROUPS values: the mean square
 * of the deviations of a group and, weighted, of the hand; 1 at rest. */
static void measure(landmark_filter *self, const float *x, double dt_s, double *out_motion)
{
    bool is_repeated[MRT_ANGLES];
    find_repeated(self, x, is_repeated);
    const double follow = share_of(dt_s, DEVIATION_TIME_CONSTANT_S);
    /* Variance of an exponential average of white noise of variance 1. */
    const double white = follow / (2.0 - follow);
    const double learn = fmax(share_of(dt_s, NOISE_TIME_CONSTANT_S),
                              1.0 / ((double)self->count + FIRST_NOISE_WEIGHT - 1.0));
    double sum[GROUPS] = {0.0}, all = 0.0;
    int size[GROUPS] = {0}, count = 0;
    for (int i = 0; i < MRT_ANGLES; ++i) {
        landmark_channel *c = &self->channel[i];
        if (is_repeated[i])
            continue;
        double variance = (double)c->variance, deviation = (double)c->deviation;
        if (self->count >= 2)
            variance += learn * (noise_seen(c, (double)x[i], dt_s, self->last_dt_s) - variance);
        const double noise_rad = sqrt(variance + LEAST_NOISE_RAD * LEAST_NOISE_RAD);
        deviation += follow * (((double)x[i] - (double)c->value) / noise_rad - deviation);
        c->variance = (float)variance;
        c->deviation = (float)deviation;
        sum[group_of(i)] += deviation * deviation / white;
        c->measured[1] = c->measured[0];
        c->measured[0] = x[i];
        size[group_of(i)] += 1;
        all += deviation * deviation / white;
        ++count;
    }
    all /= count; /* each group has at least one value that counts */
    for (int g = 0; g < GROUPS; ++g)
        out_motion[g] = (sum[g] + HAND_WEIGHT * all) / (size[g] + HAND_WEIGHT);
}

static void step(landmark_filter *self, float *x, double dt_s)
{
    double motion[GROUPS];
    measure(self, x, dt_s, motion);
    /* Averages the first samples, so that a hand at rest converges quickly. */
    const double rest = fmax(share_of(dt_s, 1.0 / (2.0 * ANGLE_PI * REST_CUTOFF_HZ)),
                             1.0 / ((double)self->count + 1.0));
    const double moving = fmax(share_of(dt_s, MOVING_TIME_CONSTANT_S), rest);
    for (int i = 0; i < MRT_ANGLES; ++i) {
        landmark_channel *c = &self->channel[i];
        const double risen = (motion[group_of(i)] - RISE_FROM) / (RISE_TO - RISE_FROM);
        const double share = rest + (moving - rest) * fmin(fmax(risen, 0.0), 1.0);
        const double value = (double)c->value;
        c->value = (float)(value + share * ((double)x[i] - value));
        x[i] = c->value;
    }
    self->last_dt_s = dt_s;
}

static void start(landmark_filter *self, const float *x)
{
    landmark_filter_reset(self);
    for (int i = 0; i < MRT_ANGLES; ++i)
        self->channel[i] =
            (landmark_channel){.value = x[i],
                               .variance = (float)(FIRST_NOISE_RAD * FIRST_NOISE_RAD),
                               .measured = {x[i], x[i]}};
}

void landmark_filter_apply(landmark_filter *filter, float *angle_rad, int64_t time_ns)
{
    for (int i = 0; i < MRT_ANGLES; ++i)
        if (!isfinite(angle_rad[i]))
            angle_rad[i] = filter->channel[i].measured[0];
    if (filter->count > 0 && time_ns == filter->last_ns) {
        for (int i = 0; i < MRT_ANGLES; ++i)
            angle_rad[i] = filter->channel[i].value;
        return;
    }
    if (filter->count == 0 || hand_is_gap(filter->last_ns, time_ns))
        start(filter, angle_rad);
    else
        step(filter, angle_rad, (double)(time_ns - filter->last_ns) * 1e-9);
    filter->last_ns = time_ns;
    filter->count += filter->count < LANDMARK_FILTER_SETTLED;
}
