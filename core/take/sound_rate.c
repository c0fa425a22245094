#include "take/sound_rate.h"
#include "base/angle.h"

#include <math.h>
#include <stdlib.h>

/* The kernel reaches over so many zero crossings to each side and is tabled so finely between two;
 * values between are linear, an error of 1e-7. */
enum { CROSSINGS = 48, STEPS = 1024, CHANNELS_MAX = 64 };
static const double kaiser_beta = 9.0;
/* Of the lower Nyquist frequency: half of what is passed there. */
static const double cutoff = 0.95;

struct sound_rate {
    uint64_t from_hz, to_hz;
    uint32_t channel_count;
    double scale;  /* crossings per frame at from_hz */
    int64_t reach; /* frames at from_hz */
    float table[CROSSINGS * STEPS + 2];
};

/* Modified Bessel function of order 0, by its series. */
static double bessel(double x)
{
    double sum = 1.0, term = 1.0;
    for (int k = 1; k < 60; ++k) {
        term *= (x / (2.0 * k)) * (x / (2.0 * k));
        sum += term;
    }
    return sum;
}

static double kernel(double crossings)
{
    double x = crossings / CROSSINGS;
    if (x >= 1.0)
        return 0.0;
    double turn = ANGLE_PI * crossings;
    double sinc = crossings == 0.0 ? 1.0 : angle_turn_of(turn).sin / turn;
    return sinc * bessel(kaiser_beta * sqrt(1.0 - x * x)) / bessel(kaiser_beta);
}

mrt_result sound_rate_create(sound_rate **out, uint32_t from_hz, uint32_t to_hz,
                             uint32_t channel_count, error *err)
{
    *out = NULL;
    if (from_hz == 0 || to_hz == 0 || channel_count == 0 || channel_count > CHANNELS_MAX ||
        to_hz / from_hz >= 1000 || from_hz / to_hz >= 1000)
        return error_set(err, MRT_ERR_ARGUMENT,
                         "from %u Hz to %u Hz, %u channels: cannot be resampled", from_hz, to_hz,
                         channel_count);
    sound_rate *self = calloc(1, sizeof *self);
    if (!self)
        return error_set(err, MRT_ERR_MEMORY, "no memory to resample");
    self->from_hz = from_hz;
    self->to_hz = to_hz;
    self->channel_count = channel_count;
    self->scale = cutoff * (to_hz < from_hz ? (double)to_hz / (double)from_hz : 1.0);
    self->reach = (int64_t)ceil(CROSSINGS / self->scale);
    for (int i = 0; i <= CROSSINGS * STEPS; ++i)
        self->table[i] = (float)kernel((double)i / STEPS);
    *out = self;
    return MRT_OK;
}

void sound_rate_destroy(sound_rate *self)
{
    free(self);
}

/* Frame `n` at to_hz lies this far behind this frame at from_hz. */
static int64_t place(const sound_rate *self, int64_t n, double *out_part)
{
    int64_t from = (int64_t)self->from_hz, to = (int64_t)self->to_hz;
    int64_t whole = n / to * from, rest = n % to * from;
    *out_part = (double)(rest % to) / (double)to;
    return whole + rest / to;
}

void sound_rate_needs(const sound_rate *self, int64_t first, size_t count, int64_t *out_first,
                      size_t *out_count)
{
    double part;
    int64_t low = place(self, first, &part) - self->reach;
    int64_t high = place(self, first + (int64_t)(count ? count - 1 : 0), &part) + self->reach + 1;
    *out_first = low;
    *out_count = (size_t)(high - low + 1);
}

static double weight_of(const sound_rate *self, double away)
{
    double at = fabs(away) * self->scale * STEPS;
    if (at >= (double)CROSSINGS * STEPS)
        return 0.0;
    int32_t i = (int32_t)at;
    double low = (double)self->table[i], high = (double)self->table[i + 1];
    return self->scale * (low + (high - low) * (at - (double)i));
}

void sound_rate_convert(const sound_rate *self, float *out, int64_t first, size_t count,
                        const float *in)
{
    int64_t in_first;
    size_t in_count;
    sound_rate_needs(self, first, count, &in_first, &in_count);
    for (size_t i = 0; i < count; ++i) {
        double part, sum[CHANNELS_MAX] = {0};
        int64_t centre = place(self, first + (int64_t)i, &part);
        for (int64_t k = -self->reach; k <= self->reach + 1; ++k) {
            double weight = weight_of(self, (double)k - part);
            const float *frame = in + (size_t)(centre + k - in_first) * self->channel_count;
            for (uint32_t c = 0; c < self->channel_count; ++c)
                sum[c] += weight * (double)frame[c];
        }
        for (uint32_t c = 0; c < self->channel_count; ++c)
            out[i * self->channel_count + c] = (float)sum[c];
    }
}
