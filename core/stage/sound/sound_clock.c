#include "stage/sound/sound_clock.h"

#include <math.h>

/* Standard deviation of the rate before any measurement, and of its change in one second. */
static const double stretch_sigma = 200e-6, wander_sigma = 0.5e-6;
/* Initial value and limits of the error of the reported times. */
static const double jitter_first_ns = 1e6, jitter_least_ns = 50e3, jitter_most_ns = 20e6;
/* A block is an outlier if it is off by more than odd_sigmas and by more than odd_ns. Its error is
 * limited to this. ODD_BLOCKS consecutive outliers on the same side are a jump. */
static const double odd_sigmas = 4.0, odd_ns = 2e6;
enum { WARM_BLOCKS = 16, ODD_BLOCKS = 12, SETTLED_BLOCKS = 64 };
static const double settled_ns = 0.3e6;
static const double stretch_max = 5e-3;
static const int64_t sane_max_ns = (int64_t)1 << 61;

void sound_clock_init(sound_clock *self, double rate_hz)
{
    *self = (sound_clock){.nominal_ns = 1e9 / rate_hz,
                          .rate = stretch_sigma * stretch_sigma,
                          .jitter = jitter_first_ns * jitter_first_ns};
}

/* Limits a reported time, which may be any value. */
static int64_t sane(int64_t time_ns)
{
    return time_ns > sane_max_ns ? sane_max_ns : time_ns < -sane_max_ns ? -sane_max_ns : time_ns;
}

void sound_clock_break(sound_clock *self, int64_t frame, int64_t time_ns)
{
    self->base_ns = sane(time_ns);
    self->time_ns = 0.0;
    self->frame = frame;
    self->when = self->jitter;
    self->both = 0.0;
    self->odd_count = 0;
    self->count = 1;
}

static void predict(sound_clock *self, int64_t frame)
{
    double span_ns = (double)(frame - self->frame) * self->nominal_ns;
    double wander = wander_sigma * wander_sigma * span_ns / 1e9;
    self->time_ns += span_ns * (1.0 + self->stretch);
    self->when += span_ns * (2.0 * self->both + span_ns * (self->rate + wander / 3.0));
    self->both += span_ns * (self->rate + wander / 2.0);
    self->rate += wander;
    self->frame = frame;
}

static void correct(sound_clock *self, double off_ns)
{
    double total = self->when + self->jitter;
    double gain_when = self->when / total, gain_rate = self->both / total;
    self->time_ns += gain_when * off_ns;
    self->stretch += gain_rate * off_ns;
    self->stretch = fmax(-stretch_max, fmin(stretch_max, self->stretch));
    self->rate -= gain_rate * self->both;
    self->both -= gain_rate * self->when;
    self->when -= gain_when * self->when;
}

static void learn_jitter(sound_clock *self, double off_ns)
{
    double part = self->count < 100 ? 0.05 : 0.005;
    self->jitter += part * (off_ns * off_ns - self->jitter);
    self->jitter = fmax(jitter_least_ns * jitter_least_ns,
                        fmin(jitter_most_ns * jitter_most_ns, self->jitter));
}

/* Counts consecutive outliers. Returns 1 if they are a jump. */
static int is_jump(sound_clock *self, double off_ns, double limit_ns)
{
    int32_t side = off_ns > limit_ns ? 1 : off_ns < -limit_ns ? -1 : 0;
    self->odd_count = side != 0 && side == self->odd_side ? self->odd_count + 1 : side != 0;
    self->odd_side = side;
    return self->odd_count >= ODD_BLOCKS;
}

/* Restarts the filter after a jump. A large rate error may come from the jump itself, so it is
 * reset. */
static void restart(sound_clock *self, int64_t frame, int64_t time_ns)
{
    self->rate = stretch_sigma * stretch_sigma;
    if (fabs(self->stretch) > 5.0 * stretch_sigma)
        self->stretch = 0.0;
    self->jitter = jitter_first_ns * jitter_first_ns;
    sound_clock_break(self, frame, time_ns);
    self->jump_count += 1;
}

int sound_clock_block(sound_clock *self, int64_t frame, int64_t time_ns)
{
    if (self->count == 0) {
        sound_clock_break(self, frame, time_ns);
        return 0;
    }
    predict(self, frame);
    double off_ns = (double)(sane(time_ns) - self->base_ns) - self->time_ns;
    double limit_ns = fmax(odd_ns, odd_sigmas * sqrt(self->when + self->jitter));
    self->count += 1;
    if (is_jump(self, off_ns, limit_ns)) {
        restart(self, frame, time_ns);
        return 1;
    }
    if (self->count <= WARM_BLOCKS)
        limit_ns = jitter_most_ns;
    off_ns = fmax(-limit_ns, fmin(limit_ns, off_ns));
    learn_jitter(self, off_ns);
    correct(self, off_ns);
    return 0;
}

int64_t sound_clock_time_ns(const sound_clock *self, int64_t frame)
{
    double ns =
        self->time_ns + (double)(frame - self->frame) * self->nominal_ns * (1.0 + self->stretch);
    return self->base_ns + (int64_t)floor(ns + 0.5);
}

bool sound_clock_is_settled(const sound_clock *self)
{
    return self->count >= SETTLED_BLOCKS ||
           (self->count > 0 && self->when < settled_ns * settled_ns);
}

double sound_clock_drift_ppm(const sound_clock *self)
{
    return self->rate < stretch_sigma * stretch_sigma / 4.0 ? -self->stretch * 1e6 : 0.0;
}
